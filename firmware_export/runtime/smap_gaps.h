/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
#include "smap_landing.h"
/* ---- gaps: where the robot rocks from one rest to the next ------------------------------------------- */
/* The gap of an edge is of the parts w of the way from which the robot stays, whichever way it rolls. */
#define SMAP_SPARE 1e-4f     /* of the way, by which a limit is on the safe side */
#define SMAP_STEP_IN 1.1f    /* times what brings the side of a gap in */
#define SMAP_SLIT 1e-5f      /* of the size: between edges that are nearer there is nothing */
#define SMAP_LEANS 1e-6f     /* of the size: ends of a gap, and all that is inside, are so far inside its sides */

/* How far inside the side of a gap at w, a wall through the com, a place is: a - b on one rest, c - d on the other. */
static float smap_within(const float *const corner[4], float w, const float place[3])
{
  float p[3], q[3], n[3];
  smap_mix(corner[0], corner[1], w, p);
  smap_mix(corner[2], corner[3], w, q);
  smap_minus(p, q, q); /* of places next to each other p x q would lose its digits */
  smap_cross(p, q, n);
  return smap_unit(n) ? smap_dot(n, place) : SMAP_LARGEST;
}

/* Bring one side of a gap in, by the rule of Illinois, until the half-way place of its curve is not inside; 0 where
 * that does not happen.  The curve is that of one balance on the way over the arc. */
static int smap_bring_in(const float *const corner[4], float (*half)[3], uint8_t side, float least, float span[2])
{
  const float sign = side ? -1.0f : 1.0f, other = span[1 - side];
  float place[3], now, then;
  uint8_t left;
  smap_mix(half[0], half[1], span[side], place);
  now = sign * smap_within(corner, span[side], place);
  then = now > 0.0f ? sign * smap_within(corner, other, place) : 0.0f;
  for (left = 3; now > 0.0f && left > 0; left--) {
    span[side] += (other - span[side]) * SMAP_STEP_IN * now / (now - then);
    now = sign * smap_within(corner, span[side], place);
    then *= 0.5f; /* as that end stays */
  }
  return now <= least && span[0] < span[1];
}

/* Add the cone of a gap: between both edges, and the sides at both ends of its span, which are boundary; 0 where it is
 * twisted.  Its places: on one side that on e and the other, then on the other side. */
static int smap_add_gap(smap_work_t *w, uint8_t e)
{
  const uint8_t k = w->at->gaps;
  const float least = SMAP_LEANS * SMAP_SIZE(w);
  float(*const place)[3] = w->region->place + w->at->places;
  smap_gap_t *const gap = &w->at->gap[k];
  uint8_t side;
  gap->a = e;
  gap->b = w->twin[e];
  gap->side = (uint8_t)(w->at->first[w->at->rests] + 2u * k);
  gap->place = w->at->places;
  for (side = 0; side < 2; side++) {
    const float *const from = place[3 * side], *const to = place[1 + side];
    const float *const other = place[2 - 2 * side];
    float *const wall = w->region->wall[gap->side + side];
    float along[3];
    smap_minus(from, to, along);
    smap_cross(from, along, wall);
    if (!smap_unit(wall) || !(smap_dot(wall, other) > least) ||
        !(smap_dot(wall, other + 3) > least)) {
      return 0;
    }
  }
  w->at->gaps = (uint8_t)(k + 1u);
  return 1;
}

/* Make one island of those of two rests: `island` is the least number of its rests. */
static void smap_join(smap_work_t *w, uint8_t a, uint8_t b)
{
  const uint8_t p = w->island[a], q = w->island[b], least = p < q ? p : q, most = p < q ? q : p;
  uint8_t r;
  for (r = 0; r < w->at->rests; r++) {
    w->island[r] = w->island[r] == most ? least : w->island[r];
  }
}

/* Find the part of the way over the edge e from which the robot stays, `d` between the normals of
 * its rests; 0: there is none.  `slit`: the edge does not move while the robot rolls. */
static int smap_find_span(smap_work_t *w, uint8_t e, const float d[3], const float *const *corner,
                          int slit, float span[2])
{
  const uint8_t back = w->twin[e];
  const float *const normal[2] = {w->normal[w->rest[e]], w->normal[w->rest[back]]};
  const float size = SMAP_SIZE(w), turned2 = smap_dot(d, d);
  float half[2][3];
  smap_landing_t l;
  uint8_t side;
  if (!(turned2 <= w->map->rock_chord * w->map->rock_chord)) {
    return 0;
  }
  l.doubt = (SMAP_ROUND_OFF + w->map->off + w->map->turned * smap_root(turned2)) * (size * size);
  smap_find_half(w, e, d, half);
  for (side = 0; side < 2; side++) { /* there, and back */
    smap_roll(normal[side], normal[1 - side], corner + 2 * side, half, corner + 2 - 2 * side, &l);
    if (!smap_land(w, side ? e : back, &l, span)) {
      return 0;
    }
  }
  for (side = 0; side < 2 && !slit; side++) {
    if (!smap_bring_in(corner, half, side, SMAP_LEANS * size, span)) {
      return 0;
    }
  }
  span[0] = span[0] > 0.0f ? span[0] + SMAP_SPARE : 0.0f;
  span[1] = span[1] < 1.0f ? span[1] - SMAP_SPARE : 1.0f;
  return span[0] < span[1];
}

/* Find what holds of the edge e between two rests. */
SMAP_APART static void smap_find_gap(smap_work_t *w, uint8_t e)
{
  smap_layout_t *const at = w->at;
  const uint8_t back = w->twin[e], p = at->places;
  float(*const place)[3] = w->region->place;
  const float *const corner[4] = {place[e], place[w->next[e]], place[w->next[back]], place[back]};
  const float least = SMAP_SLIT * SMAP_SLIT * SMAP_SIZE(w) * SMAP_SIZE(w);
  float span[2] = {0.0f, 1.0f}, d[3];
  uint8_t side;
  int slit, one = w->joined[e];
  slit = smap_apart2(corner[0], corner[2]) + smap_apart2(corner[1], corner[3]) < least;
  smap_minus(w->normal[w->rest[e]], w->normal[w->rest[back]], d);
  if (SMAP_IS_FULL(w, SMAP_OF_GAPS, (p - at->first[at->rests]) / 4u, SMAP_HELD_EDGES) ||
      (!one && !smap_find_span(w, e, d, corner, slit, span))) {
    return;
  }
  for (side = 0; side < 2; side++) {
    smap_mix(corner[0], corner[1], span[side], place[p + 2 * side]);
    smap_mix(corner[2], corner[3], span[side], place[p + 2 * side + 1]);
  }
  if (!slit && !smap_add_gap(w, e) && !one) {
    return;
  }
  at->nearly = one ? 1 : at->nearly;
  smap_join(w, w->rest[e], w->rest[back]);
  w->upto[e] = w->upto[back] = SMAP_NONE;
  if (span[0] > 0.0f) {
    w->upto[e] = p;
    w->onward[back] = (uint8_t)(p + 1u);
  }
  if (span[1] < 1.0f) {
    w->onward[e] = (uint8_t)(p + 2u);
    w->upto[back] = (uint8_t)(p + 3u);
  }
  at->places = (uint8_t)(p + 4u);
}
