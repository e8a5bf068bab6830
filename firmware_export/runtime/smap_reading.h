/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- reading a region: one direction of gravity, in floats and in whole numbers ------------------------ */
#define SMAP_SINE 1e-6f  /* what rounding may alter of one, which near a right angle alters its angle by much more */
#define SMAP_BEHIND 1e-5f /* a sine: an arc that is seen from as far behind is not what is nearest */

/* The rest that a direction pierces first. */
static uint8_t smap_pierced(const smap_layout_t *at, const smap_region_t *o, const float g[3])
{
  float rate = 0.0f; /* 1 / distance along it */
  uint8_t i, best = SMAP_NONE;
  for (i = 0; i < at->rests; i++) {
    const float v = smap_dot(o->plane[i], g);
    if (v > rate) {
      rate = v;
      best = i;
    }
  }
  return best;
}

/* How far inside (sine) the edges of a rest a direction is, and which of them is nearest. */
static float smap_inside(const smap_layout_t *at, const smap_region_t *o, uint8_t rest, const float g[3],
                         uint8_t *which)
{
  const uint8_t end = at->first[rest + 1];
  float least = 1.0f;
  uint8_t e = at->first[rest], nearest = e;
  for (; e < end; e++) {
    const float in = smap_dot(o->wall[e], g);
    if (!(in >= least)) {
      least = in;
      nearest = e;
    }
  }
  *which = nearest;
  return least;
}

/* Tells whether a direction that is in no rest is in a gap. */
static int smap_is_in_gap(const smap_layout_t *at, const smap_region_t *o, const float g[3])
{
  uint8_t k;
  for (k = 0; k < at->gaps; k++) {
    const smap_gap_t *const gap = &at->gap[k];
    if (smap_dot(o->wall[gap->a], g) <= 0.0f && smap_dot(o->wall[gap->b], g) <= 0.0f &&
        smap_dot(o->wall[gap->side], g) >= 0.0f && smap_dot(o->wall[gap->side + 1], g) >= 0.0f) {
      return 1;
    }
  }
  return 0;
}

/* How far (sine) a direction is beyond the nearer end of an arc, along its wall; 0 between them.  LARGEST behind it. */
SMAP_INLINE float smap_beyond(const smap_region_t *o, const smap_arc_t *arc, const float g[3])
{
  const float *const from = o->place[arc->from], *const to = o->place[arc->to];
  float along[3], before, after;
  smap_cross(g, o->wall[arc->wall], along);
  before = smap_dot(from, along);
  after = smap_dot(to, along);
  if (before > 0.0f && smap_dot(from, g) > 0.0f) {
    return before;
  }
  if (after < 0.0f && smap_dot(to, g) > 0.0f) {
    return -after;
  }
  return before > 0.0f || after < 0.0f ? SMAP_LARGEST : 0.0f;
}

/* The distance (sine) of a direction from arcs, 1 where that is further than a right angle, and which is nearest.
 * `side`: 1 where the direction is in the region, and -1. */
static float smap_nearest(const smap_layout_t *at, const smap_region_t *o, const float g[3],
                          const uint8_t ends[2], float side, const smap_arc_t **which)
{
  const smap_arc_t *arc = at->arc + ends[0], *const end = at->arc + ends[1];
  float least = 1.0f;
  for (; arc < end; arc++) {
    float away = side * smap_dot(o->wall[arc->wall], g), beyond;
    if (!(away >= -SMAP_BEHIND) && (SMAP_PIVOTS == 0 || at->nearly != SMAP_OVERLAP)) {
      continue;
    }
    away *= away;
    if (!(away < least)) {
      continue;
    }
    beyond = smap_beyond(o, arc, g);
    away += beyond * beyond;
    if (away < least) {
      least = away;
      *which = arc;
    }
  }
  return smap_root(least);
}

/* The angle of a sine of at least the guard, less the guard as an angle. */
SMAP_INLINE float smap_less(float sine, float guard)
{
  const float angle = smap_asin(sine < 1.0f ? sine - SMAP_SINE : 1.0f) - guard * (1.0f + 0.2f * guard * guard);
  return angle > 0.0f ? angle : 0.0f;
}

/* Read a region under a direction of any length. */
static int8_t smap_read_region(const smap_layout_t *at, const smap_region_t *o, const float gravity[3],
                               smap_reading_t *out)
{
  const float size = 1.0f / smap_root(smap_dot(gravity, gravity));
  const float g[3] = {gravity[0] * size, gravity[1] * size, gravity[2] * size};
  const float guard = o->guard;
  float rate, tip, d[3];
  uint8_t i, which, rest, next = 0, best = smap_pierced(at, o, g);
  const smap_arc_t *arc = 0;
  int8_t status = SMAP_OK;
  if (best == SMAP_NONE) {
    return smap_deny(out, SMAP_TIPS);
  }
  i = best;
  do { /* planes that are all but one are in any order */
    rest = i;
    tip = smap_inside(at, o, rest, g, &which);
    i = next;
  } while (tip < 0.0f && at->nearly && next++ < at->rests);
  best = tip < 0.0f ? best : rest;
  if (tip >= 0.0f && at->own[best] != SMAP_NONE) {
    arc = at->arc + at->own[best] + (which - at->first[best]);
    /*@ admit \valid_read(arc); */
  } else {
    const int rocks = tip < 0.0f && smap_is_in_gap(at, o, g), tips = tip < 0.0f && !rocks;
    const uint8_t ends[2] = {rocks ? (uint8_t)0 : at->from[best],
                             rocks ? at->arcs : at->till[best]};
    status = tips ? SMAP_TIPS : tip >= guard ? SMAP_OK : SMAP_ROCKS;
    /* A direction that tips is measured to the island that it pierces.  A gap may belong to another island. */
    tip = smap_nearest(at, o, g, ends, tips ? -1.0f : 1.0f, &arc);
    tip = tips ? -tip : tip;
  }
  if (status == SMAP_TIPS || !(tip >= guard)) {
    tip -= guard;
    status = smap_deny(out, SMAP_TIPS);
    if (tip > -1.0f) {
      out->tip_angle = smap_asin(tip);
    }
  } else {
    out->tip_angle = at->arcs ? smap_less(tip, guard) : 3.1415925f;
    out->height = o->height[best];
    rate = 1.0f / smap_dot(o->plane[best], g);
    SMAP_THRICE
    for (i = 0; i < 3; i++) {
      d[i] = rate * g[i] - o->centre[best][i];
    }
    out->sdg = smap_root(smap_dot(d, d));
  }
  out->over[0] = arc != 0 ? arc->over[0] : (uint8_t)SMAP_NONE;
  out->over[1] = arc != 0 ? arc->over[1] : (uint8_t)SMAP_NONE;
  return status;
}
