/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The facets, edges and boundary of a posture's pose: what lutgen's page draws.  See smap_host.c. */

/* Write a vector; return what comes behind it. */
static float *smap_host_put(float *out, const float v[3])
{
  memcpy(out, v, 3 * sizeof *v);
  return out + 3;
}

/* Write where the ray to a place meets a plane. */
static float *smap_host_corner(float *out, const float place[3], const float plane[3])
{
  const float v[3] = {0.0f, 0.0f, 0.0f};
  smap_mix(v, place, 1.0f / smap_dot(plane, place), out);
  return out + 3;
}

/* `count`: rests, their edges, arcs of the boundary; none where the pose fails.  `out`: a rest as n / h, centre,
 * height; an edge as its rest, both ends, from which part on it holds (above 1: nowhere), both contacts; an arc as
 * both ends and both contacts. */
void SMAP_HOST_NAME(pose)(const uint8_t *blob, uint32_t size, const float *params, int32_t *count, float *out)
{
  const smap_t map = {&smap_run, blob, size};
  smap_limits_t m;
  smap_pose_memory_t pose;
  const smap_region_t *const o = &pose.region;
  const smap_work_t *const w = &pose.rest.work;
  uint8_t i;
  count[0] = count[1] = count[2] = 0;
  if (smap_pose(&map, params, &pose.head, sizeof pose, SMAP_FLOAT) != SMAP_OK) {
    return;
  }
  smap_limits(&map, &m);
  for (i = 0; i < pose.at.rests; i++, count[0]++) {
    out = smap_host_put(smap_host_put(out, o->plane[i]), o->centre[i]);
    *out++ = o->height[i];
  }
  for (i = 0; i < pose.at.first[pose.at.rests]; i++, count[1]++) {
    const uint8_t r = w->rest[i], behind = i + 1 < pose.at.first[r + 1] ? (uint8_t)(i + 1) : pose.at.first[r];
    float a[3], end[3], along[3];
    *out++ = r;
    (void)smap_host_corner(a, o->place[i], o->plane[r]);
    out = smap_host_corner(smap_host_put(out, a), o->place[behind], o->plane[r]);
    smap_minus(out - 3, a, along);
    (void)smap_host_corner(end, o->place[w->upto[i] == SMAP_NONE ? i : w->upto[i]], o->plane[r]);
    smap_minus(end, a, end);
    *out++ = w->upto[i] == behind ? 2.0f : smap_dot(end, along) / smap_dot(along, along);
    *out++ = m.named[w->contact[i]];
    *out++ = m.named[w->contact[behind]];
  }
  for (i = 0; i < pose.at.arcs; i++, count[2]++) {
    out = smap_host_put(smap_host_put(out, o->place[pose.at.arc[i].from]), o->place[pose.at.arc[i].to]);
    *out++ = pose.at.arc[i].over[0];
    *out++ = pose.at.arc[i].over[1];
  }
}

/* The most of each that the poses of postures (m, k) have, in the order of a pose's room. */
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
      const uint8_t found[SMAP_ROOMS] = {pose.at.rests, pose.at.first[pose.at.rests],
                                         (uint8_t)((pose.at.places - pose.at.first[pose.at.rests]) / 4), pose.at.arcs,
                                         pose.rest.work.facets};
      for (k = 0; k < SMAP_ROOMS; k++) {
        most[k] = found[k] > most[k] ? found[k] : most[k];
      }
    }
  }
}
