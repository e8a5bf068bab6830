/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The facets, edges and boundary of a posture's pose: what lutgen's page draws.  See smap_host.c. */

/* Write a vector; return what comes behind it. */
static float *smap_host_put(float *out, const float v[3])
{
  memcpy(out, v, 3 * sizeof *v);
  return out + 3;
}

/* `count`: rests, their edges, arcs of the boundary; none where the pose fails.  `out`: a rest as n / h, centre,
 * height; an edge as its rest, both ends, from which part on it holds (above 1: nowhere), both contacts; an arc as
 * both ends and both contacts. */
void SMAP_HOST_NAME(pose)(const uint8_t *blob, uint32_t size, const float *params, int32_t *count, float *out);
void SMAP_HOST_NAME(pose)(const uint8_t *blob, uint32_t size, const float *params, int32_t *count, float *out)
{
  const smap_t map = {&smap_run, blob, size};
  smap_limits_t m;
  smap_pose_memory_t pose;
  smap_work_t *const w = &pose.rest.work;
  uint8_t i, k, end;
  count[0] = count[1] = count[2] = 0;
  if (smap_pose(&map, params, &pose.head, sizeof pose, SMAP_FLOAT) != SMAP_OK) {
    return;
  }
  smap_limits(&map, &m);
  if (smap_is_turned(&map)) {
    smap_turn_back(&m, w->corner, pose.at.first[pose.at.rests]);
  }
  for (i = 0; i < pose.at.rests; i++, count[0]++) {
    out = smap_host_put(smap_host_put(out, pose.region.plane[i]), pose.region.centre[i]);
    *out++ = pose.region.height[i];
  }
  for (i = 0; i < pose.at.first[pose.at.rests]; i++, count[1]++) {
    const uint8_t behind = i + 1 < pose.at.first[w->rest[i] + 1] ? (uint8_t)(i + 1) : pose.at.first[w->rest[i]];
    *out++ = w->rest[i];
    out = smap_host_put(smap_host_put(out, w->corner[i]), w->corner[behind]);
    *out++ = w->low[i];
    *out++ = m.named[w->contact[i]];
    *out++ = m.named[w->contact[behind]];
  }
  for (i = 0; i < pose.at.arcs; i++, count[2]++) {
    const float *const c = pose.region.side[2 * i], *const t = pose.region.side[2 * i + 1];
    const float wide = smap_root(smap_dot(c, c)), high = smap_root(smap_dot(t, t)); /* sine and cosine of half of it */
    for (end = 0; end < 2; end++) {
      for (k = 0; k < 3; k++) {
        const float middle = wide > 0.0f ? c[k] * (high / wide) : 0.0f;
        const float reach = high > 0.0f ? t[k] * (wide / high) : 0.0f;
        *out++ = end ? middle + reach : middle - reach;
      }
    }
    *out++ = pose.at.arc[i].over[0];
    *out++ = pose.at.arc[i].over[1];
  }
}

/* The most of each that the poses of postures (m, k) have, in the order of a pose's room. */
void SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, int64_t count, const float *params, uint8_t *most);
void SMAP_HOST_NAME(room)(const uint8_t *blob, uint32_t size, int64_t count, const float *params, uint8_t *most)
{
  const smap_t map = {&smap_run, blob, size};
  const uint8_t width = blob[SMAP_AT_PARAMS];
  smap_pose_memory_t pose;
  int64_t i;
  uint8_t k;
  memset(most, 0, SMAP_ROOMS);
  for (i = 0; i < count; i++) {
    if (smap_pose(&map, params + i * width, &pose.head, sizeof pose, SMAP_FLOAT) == SMAP_OK) {
      const uint8_t found[SMAP_ROOMS] = {pose.at.rests, pose.at.first[pose.at.rests], pose.at.gaps, pose.at.arcs,
                                         pose.rest.work.facets};
      for (k = 0; k < SMAP_ROOMS; k++) {
        most[k] = found[k] > most[k] ? found[k] : most[k];
      }
    }
  }
}
