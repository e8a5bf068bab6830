/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* How much room the postures (m, k) take, in rows of smap_room_t's order: facets, edges, shown, walls,
 * links, sides, work on gaps, and all work; a posture that failed has 0 for work.  Returns how many failed. */
int SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, int64_t count, const float *params, uint32_t *room);
int SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, int64_t count, const float *params, uint32_t *room)
{
  const smap_t map = {&smap_run, blob, size};
  const uint8_t dims = SMAP_BLOB(&map)[SMAP_AT_PARAMS];
  smap_many_t numbers;
  int failed = 0;
  int64_t i;
  smap_many_numbers(&map, &numbers);
  for (i = 0; i < count; i++, params += dims, room += 8) {
    smap_many_pose_t pose;
    smap_many_work_t work;
    memset(&pose, 0, sizeof pose);
    memset(&work, 0, sizeof work);
    failed += smap_many_of(&map, params, &pose, &work) != SMAP_OK;
    room[0] = work.facets;
    room[1] = work.edges;
    room[2] = pose.at.shown;
    room[3] = pose.at.walls;
    room[4] = pose.at.segments > pose.at.points ? pose.at.segments : pose.at.points;
    if (room[4] < SMAP_ROLL * (work.rolls + 1u)) { /* rolls are kept where points will be, and one more */
      room[4] = SMAP_ROLL * (work.rolls + 1u);
    }
    room[5] = pose.at.sides;
    room[6] = work.sought;
    room[7] = work.left == 0 ? 0 : numbers.room.work - work.left;
  }
  return failed;
}
