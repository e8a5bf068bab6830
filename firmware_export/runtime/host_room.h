/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* How much room the posture of some parameters takes: facets, edges, shown, walls, segments,
 * points, sides, and work by kind; 0 where it failed for want of room, or otherwise. */
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
