/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Many contacts whose axes are not parallel, on the machine of the exporter; see host.h. */
#define SMAP_HOST
#define SMAP_HOST_NAME(what) smap_search_host_##what
#define SMAP_FLASH
#define SMAP_FLOATS 1
#define SMAP_INTEGERS 1
#define SMAP_HARDWARE_ROOT 1
#define SMAP_POINTS 0
#define SMAP_TABLES 0
#define SMAP_GRID 0
#define SMAP_MANY 1
#define SMAP_SERIES 1
#define SMAP_CONTROL 1
#define SMAP_MAX_PARAMS 64
#define SMAP_MAX_ENTRIES 255
#define SMAP_MAX_COORDINATES 255
#define SMAP_MANY_CONTACTS 62
#define SMAP_MANY_RAILS 0
#define SMAP_MANY_FACETS 80
#define SMAP_MANY_EDGES 250
#define SMAP_MANY_RESTS 60
#define SMAP_MANY_CORNERS 154
#define SMAP_MANY_GAPS 50
#define SMAP_MANY_ARCS 254

#include "smap.h"
#include "smap_control.h"

#include "head.c"
#include "arithmetic.c"
#include "blob.c"
#include "range.c"
#include "positions.c"
#include "series.c"
#include "chart.c"
#include "many_types.c"
#include "many_planes.c"
#include "many_rests.c"
#include "many_search.c"
#include "many_walls.c"
#include "many_gaps.c"
#include "many_pose.c"
#include "many_at.c"
#include "many_at_i.c"
#include "many_entry.c"
#include "steps.c"
#include "check.c"
#include "end.c"
#include "control_head.c"
#include "control_types.c"
#include "control_many.c"
#include "control_target.c"
#include "control_watch.c"
#include "control_way.c"
#include "control_step.c"
#include "control_end.c"
#include "host.h"
#include "host_control.h"
#include "host_pose.h"
#include "host_positions.h"
#include "host_room.h"
