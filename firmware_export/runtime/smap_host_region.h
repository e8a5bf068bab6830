/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The facets, edges and boundary of a posture's pose: what lutgen's page draws.  See smap_host.c. */

/* Write a vector; return what comes behind it. */
static float *smap_host_put(float *out, const float v[3])
{
  smap_copy(v, out);
  return out + 3;
}

/* `count`: rests, their edges, arcs of the boundary; none where the pose fails.  `out`: a rest as n / h, centre,
 * height; an edge as its rest, both ends, from which part on it holds (above 1: nowhere), both contacts; an arc as
 * both ends and both contacts. */
void SMAP_HOST_NAME(pose)(const uint8_t *blob, uint32_t size, const float *params, int32_t *count, float *out);
void SMAP_HOST_NAME(pose)(const uint8_t *blob, uint32_t size, const float *params, int32_t *count, float *out)
{
  const smap_t map = {&smap_run, blob, size};
  smap_many_t numbers;
  smap_many_pose_t pose;
  smap_many_work_t work;
  uint8_t i, k, end;
  count[0] = count[1] = count[2] = 0;
  if (smap_many_of(&map, params, &pose, &work) != SMAP_OK) {
    return;
  }
  smap_many_numbers(&map, &numbers);
#if SMAP_MANY_RAILS
  if (numbers.axis[1] != 1.0f) {
    smap_turn_back(&numbers, work.corner, work.edges);
  }
#endif
  for (i = 0; i < pose.at.rests; i++, count[0]++) {
    out = smap_host_put(smap_host_put(out, pose.plane[i]), pose.centre[i]);
    *out++ = pose.height[i];
  }
  for (i = 0; i < work.edges; i++) {
    if (work.wall_of[i] != SMAP_NONE) {
      *out++ = work.facet[work.owner[i]].rest;
      out = smap_host_put(smap_host_put(out, smap_corner(&work, i)), smap_end(&work, i));
      *out++ = work.low[i];
      *out++ = numbers.named[work.vertex[i]];
      *out++ = numbers.named[work.vertex[work.next[i]]];
      count[1]++;
    }
  }
  for (i = 0; i < pose.at.arcs; i++, count[2]++) {
    const float *const m = pose.amid[i], *const t = pose.along[i];
    const float wide = smap_root(smap_dot(m, m)), high = smap_root(smap_dot(t, t)); /* sine and cosine of half of it */
    for (end = 0; end < 2; end++) {
      for (k = 0; k < 3; k++) {
        const float middle = wide > 0.0f ? m[k] * (high / wide) : 0.0f;
        const float reach = high > 0.0f ? t[k] * (wide / high) : 0.0f;
        *out++ = end ? middle + reach : middle - reach;
      }
    }
    *out++ = pose.at.over[pose.at.arc[i]][0];
    *out++ = pose.at.over[pose.at.arc[i]][1];
  }
}

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
