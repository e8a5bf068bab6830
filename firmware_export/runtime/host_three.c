/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The codecs for three contact points on the machine of the exporter; see host.h. */
#include <float.h>

#if defined(__FAST_MATH__) || FLT_EVAL_METHOD == 1 || FLT_EVAL_METHOD == 2
#error "singles must round to singles, as on the targets: no fast math, and SSE on x86"
#endif

#define SMAP_HOST
#define SMAP_HOST_NAME(what) smap_three_host_##what
#define SMAP_FLASH
#define SMAP_FLOATS 1
#define SMAP_INTEGERS 1
#define SMAP_HARDWARE_ROOT 1
#define SMAP_POINTS 1
#define SMAP_TABLES 1
#define SMAP_GRID 0
#define SMAP_MANY 0
#define SMAP_SERIES 1
#define SMAP_CONTROL 1
#define SMAP_MAX_PARAMS 64
#define SMAP_MAX_ENTRIES 255
#define SMAP_MAX_COORDINATES 255

#include "smap.h"
#include "smap_control.h"

#include "head.c"
#include "arithmetic.c"
#include "blob.c"
#include "range.c"
#include "positions.c"
#include "series.c"
#include "chart.c"
#include "three.c"
#include "tables.c"
#include "three_entry.c"
#include "steps.c"
#include "check.c"
#include "end.c"
#include "control_head.c"
#include "control_types.c"
#include "control_three.c"
#include "control_target.c"
#include "control_watch.c"
#include "control_way.c"
#include "control_step.c"
#include "control_end.c"
#include "host.h"
#include "host_control.h"
#include "host_positions.h"

/* What this was built from: the digest of the files beside it. */
const char *smap_sources(void);
const char *smap_sources(void)
{
  return SMAP_SOURCES;
}
