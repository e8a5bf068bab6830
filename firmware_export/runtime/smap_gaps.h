/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
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
 * twisted, or there is no room.  Its places: on one side that on e and the other, then on the other side. */
static int smap_add_gap(smap_work_t *w, uint8_t e)
{
  const uint8_t k = w->at->gaps;
  const float least = SMAP_LEANS * w->map->size;
  float(*const place)[3] = w->region->place + w->at->places;
  smap_gap_t *const gap = &w->at->gap[k];
  uint8_t side;
  if (SMAP_IS_FULL(w, SMAP_OF_GAPS, k, SMAP_MAX_GAPS)) {
    return 0;
  }
  gap->a = e;
  gap->b = w->twin[e];
  gap->side = (uint8_t)(w->at->first[w->at->rests] + 2u * k);
  gap->place = w->at->places;
  for (side = 0; side < 2; side++) {
    const float *const from = place[side ? 3 : 0], *const to = place[side ? 2 : 1];
    float *const wall = w->region->wall[gap->side + side];
    float along[3];
    smap_minus(from, to, along);
    smap_cross(from, along, wall);
    if (!smap_unit(wall) || !(smap_dot(wall, place[side ? 0 : 2]) > least) ||
        !(smap_dot(wall, place[side ? 1 : 3]) > least)) {
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

/* Find what holds of the edge e between two rests. */
SMAP_APART static void smap_find_gap(smap_work_t *w, uint8_t e)
{
  smap_layout_t *const at = w->at;
  const uint8_t back = w->twin[e], end = smap_after(w, e), rear = smap_after(w, back);
  const float *const from = w->normal[w->rest[e]], *const to = w->normal[w->rest[back]];
  float(*const place)[3] = w->region->place;
  const float *const corner[4] = {place[e], place[end], place[rear], place[back]};
  const float square = w->map->size * w->map->size;
  float half[2][3], span[2] = {0.0f, 1.0f}, d[3], turned2;
  smap_landing_t l;
  int side, slit, one = w->joined[e];
  smap_minus(from, to, d);
  turned2 = smap_dot(d, d);
  if (!one && !(turned2 <= w->map->rock_chord * w->map->rock_chord)) {
    return;
  }
  smap_minus(corner[0], corner[2], half[0]);
  smap_minus(corner[1], corner[3], half[1]);
  slit = smap_dot(half[0], half[0]) + smap_dot(half[1], half[1]) < SMAP_SLIT * SMAP_SLIT * square;
  if (SMAP_IS_FULL(w, SMAP_OF_GAPS, (at->places - at->first[at->rests]) / 4u, SMAP_MAX_GAPS) ||
      at->places - at->first[at->rests] + 4u > SMAP_MOST_PLACES) {
    return;
  }
  if (!one) {
    l.doubt = (SMAP_ROUND_OFF + w->map->off + w->map->turned * smap_root(turned2)) * square;
    smap_find_half(w, e, d, half);
    smap_roll(from, to, corner, half, corner + 2, &l);
    if (!smap_land(w, back, &l, span)) {
      return;
    }
    smap_roll(to, from, corner + 2, half, corner, &l);
    if (!smap_land(w, e, &l, span)) {
      return;
    }
    for (side = 0; side < 2 && !slit; side++) {
      if (!smap_bring_in(corner, half, (uint8_t)side, SMAP_LEANS * w->map->size, span)) {
        return;
      }
    }
    span[0] = span[0] > 0.0f ? span[0] + SMAP_SPARE : 0.0f;
    span[1] = span[1] < 1.0f ? span[1] - SMAP_SPARE : 1.0f;
    if (!(span[0] < span[1])) {
      return;
    }
  }
  for (side = 0; side < 2; side++) {
    smap_mix(corner[0], corner[1], span[side], place[at->places + 2 * side]);
    smap_mix(corner[2], corner[3], span[side], place[at->places + 2 * side + 1]);
  }
  if (!slit && !smap_add_gap(w, e) && !one) {
    return;
  }
  at->nearly = one ? 1 : at->nearly;
  smap_join(w, w->rest[e], w->rest[back]);
  w->upto[e] = span[0] > 0.0f ? at->places : (uint8_t)SMAP_NONE;
  w->onward[back] = span[0] > 0.0f ? (uint8_t)(at->places + 1u) : (uint8_t)SMAP_NONE;
  w->onward[e] = span[1] < 1.0f ? (uint8_t)(at->places + 2u) : (uint8_t)SMAP_NONE;
  w->upto[back] = span[1] < 1.0f ? (uint8_t)(at->places + 3u) : (uint8_t)SMAP_NONE;
  at->places = (uint8_t)(at->places + 4u);
}
