/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The codec for many contacts on the machine of the exporter; see host.h. */
#define SMAP_HOST
#define SMAP_HOST_NAME(what) smap_many_host_##what
#define SMAP_FLASH
#define SMAP_FLOATS 1
#define SMAP_INTEGERS 1
#define SMAP_HARDWARE_ROOT 1
#define SMAP_POINTS 0
#define SMAP_POLY 0
#define SMAP_TABLES 0
#define SMAP_GRID 0
#define SMAP_MANY 1
#define SMAP_SERIES 1
#define SMAP_MAX_PARAMS 64
#define SMAP_MAX_ENTRIES 255
#define SMAP_MAX_COORDINATES 255
#define SMAP_MANY_CONTACTS 62
#define SMAP_MANY_RAILS 62
#define SMAP_MANY_FACETS 80
#define SMAP_MANY_SHOWN 60
#define SMAP_MANY_EDGES 250
#define SMAP_MANY_SIDES 250
#define SMAP_MANY_WALLS 254
#define SMAP_MANY_LINKS 254

#include "smap.h"

#include "head.c"
#include "arithmetic.c"
#include "blob.c"
#include "range.c"
#include "positions.c"
#include "series.c"
#include "chart.c"
#include "many_types.c"
#include "many_rails.c"
#include "many_rests.c"
#include "many_rolls.c"
#include "many_held.c"
#include "many_gaps.c"
#include "many_walls.c"
#include "many_pose.c"
#include "many_at.c"
#include "many_at_i.c"
#include "many_entry.c"
#include "steps.c"
#include "check.c"
#include "end.c"
#include "host.h"
#include "host_positions.h"

/* How much room the posture of some parameters takes: facets, edges, shown, walls,
 * segments, points, sides, and work by kind; 0 where
 * it failed for want of room, or otherwise. */
int SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, const float *params, int32_t room[14]);
int SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, const float *params, int32_t room[14])
{
  const smap_t map = {&smap_run, blob, size};
  smap_many_pose_t pose;
  smap_many_work_t work;
  const int8_t status = smap_many_of(&map, params, &pose, &work);
  room[0] = work.facets;
  room[1] = work.edges;
  room[2] = pose.at.shown;
  room[3] = pose.at.walls;
  room[4] = pose.at.segments;
  room[5] = pose.at.points;
  room[6] = pose.at.sides;
  room[7] = SMAP_MANY_EVENTS - work.left.events;
  room[8] = SMAP_MANY_CORNERS - work.left.corners;
  room[9] = SMAP_MANY_OUTLINES - work.left.outlines;
  room[10] = SMAP_MANY_GAPS - work.left.gaps;
  room[11] = SMAP_MANY_VISITS - work.left.visits;
  room[12] = SMAP_MANY_WAYS - work.left.ways;
  room[13] = SMAP_MANY_ROLLINGS - work.left.rollings;
  return status == SMAP_OK;
}
