/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The facets, edges and boundary of a posture's pose: what lutgen's page draws.  See host.h. */

/* Write a vector; return what comes behind it. */
static float *smap_host_put(float *out, const float v[3])
{
  smap_copy(v, out);
  return out + 3;
}

/* `count`: facets that count, their edges, segments of the boundary; none where the pose fails.  `out`:
 * a facet as kind, n / h, centre, height; an edge as its facet, that one's kind, both ends, from which part
 * on it holds (above 1: nowhere), both contacts; a segment as both ends and both contacts. */
void SMAP_HOST_NAME(pose)(const uint8_t *blob, uint32_t size, const float *params, int32_t *count, float *out);
void SMAP_HOST_NAME(pose)(const uint8_t *blob, uint32_t size, const float *params, int32_t *count, float *out)
{
  const smap_t map = {&smap_run, blob, size};
  smap_many_t numbers;
  smap_many_pose_t pose;
  smap_many_work_t work;
  uint8_t i;
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
  for (i = 0; i < pose.at.shown; i++, count[0]++) {
    *out++ = pose.at.kind[i];
    out = smap_host_put(smap_host_put(out, pose.plane[i]), pose.centre[i]);
    *out++ = pose.height[i];
  }
  for (i = 0; i < work.edges; i++) {
    const smap_facet_t *const f = &work.facet[work.owner[i]];
    if (f->kind != SMAP_REFUSED && f->shown != SMAP_NONE && work.low[i] != SMAP_SHORT) {
      *out++ = f->shown;
      *out++ = f->kind;
      out = smap_host_put(smap_host_put(out, smap_corner(&work, i)), smap_end(&work, i));
      *out++ = work.low[i];
      *out++ = numbers.named[work.vertex[i]];
      *out++ = numbers.named[work.vertex[work.next[i]]];
      count[1]++;
    }
  }
  for (i = 0; i < pose.at.segments; i++, count[2]++) {
    const smap_segment_t *const s = &pose.at.segment[i];
    out = smap_host_put(smap_host_put(out, pose.point[s->start]), pose.point[s->stop]);
    *out++ = pose.at.over[s->wall][0];
    *out++ = pose.at.over[s->wall][1];
  }
}
