/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* How much room the postures (m, k) take, in rows of smap_room_t's order: facets, edges, rests, corners, edges that
 * hold, arcs.  Returns how many failed. */
int SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, int64_t count, const float *params, uint32_t *room);
int SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, int64_t count, const float *params, uint32_t *room)
{
  const smap_t map = {&smap_run, blob, size};
  const uint8_t dims = SMAP_BLOB(&map)[SMAP_AT_PARAMS];
  int failed = 0;
  int64_t i;
  for (i = 0; i < count; i++, params += dims, room += 6) {
    smap_many_pose_t pose;
    smap_many_work_t work;
    uint8_t e;
    memset(&pose, 0, sizeof pose);
    memset(&work, 0, sizeof work);
    failed += smap_many_of(&map, params, &pose, &work) != SMAP_OK;
    room[0] = work.facets;
    room[1] = work.edges;
    room[2] = pose.at.rests;
    room[3] = pose.at.edge[pose.at.rests];
    room[4] = 0;
    for (e = 0; e < work.edges; e++) {
      room[4] += (uint32_t)(work.twin[e] > e && smap_is_gap(&work, e));
    }
    room[5] = pose.at.arcs;
  }
  return failed;
}
