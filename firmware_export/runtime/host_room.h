/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* How much room the posture of some parameters takes: facets, edges, shown, walls, segments,
 * points, sides, and work; 0 where it failed for want of room, or otherwise. */
int SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, const float *params, int32_t room[8]);
int SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, const float *params, int32_t room[8])
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
  room[7] = work.left == 0 ? 0 : (int32_t)(SMAP_MANY_WORK - work.left);
  return status == SMAP_OK;
}
