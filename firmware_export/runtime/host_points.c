/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Three contact points without floats on the machine of the exporter; see host.h. */
#define SMAP_HOST
#define SMAP_HOST_NAME(what) smap_points_host_##what
#define SMAP_FLASH
#define SMAP_FLOATS 0
#define SMAP_INTEGERS 1
#define SMAP_HARDWARE_ROOT 1
#define SMAP_POINTS 0
#define SMAP_TABLES 1
#define SMAP_GRID 0
#define SMAP_MANY 0
#define SMAP_MAX_PARAMS 64
#define SMAP_MAX_ENTRIES 255
#define SMAP_MAX_COORDINATES 255

#include "smap.h"

#include "head.c"
#include "arithmetic.c"
#include "blob.c"
#include "range.c"
#include "chart.c"
#include "three.c"
#include "tables.c"
#include "three_entry.c"
#include "check.c"
#include "end.c"
#include "host.h"
