/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The codec `grid`, read without floats, on the machine of the exporter; see host.h. */
#define SMAP_HOST
#define SMAP_HOST_NAME(what) smap_whole_host_##what
#define SMAP_FLASH
#define SMAP_FLOATS 0
#define SMAP_INTEGERS 1
#define SMAP_HARDWARE_ROOT 1
#define SMAP_POINTS 0
#define SMAP_TABLES 0
#define SMAP_GRID 1
#define SMAP_MANY 0
#define SMAP_MAX_PARAMS 8

#include "smap.h"

#include "head.c"
#include "arithmetic.c"
#include "blob.c"
#include "range.c"
#include "chart.c"
#include "grid.c"
#include "check.c"
#include "end.c"
#include "host.h"
