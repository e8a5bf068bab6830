/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- search: points, balls and discs of any axes ------------------------------------------------------ */
#define SMAP_INLINE SMAP_SMALL
#define SMAP_UNROLL
#define SMAP_CODEC SMAP_CODEC_SEARCH
#define SMAP_TRACKS 1
#define SMAP_STEERED_BY "smap_control_region.c"
#define SMAP_DRAWN_BY "smap_host_region.h"
#include "smap_joints.h"
#include "smap_boundary.h"

#define SMAP_FLAT 1e-6f   /* of a disc that lies flatter, the square of the sine to its axle */
#define SMAP_FACE 0.173658f  /* the sine of 10 deg: nearer to a plane's normal a carrying wheel's axle may not be, */
#define SMAP_FLATTEST 1e-2f  /* nor than this, whatever `upright` says: its rim touches where rounding likes */

SMAP_INLINE int smap_is_disc(const smap_work_t *w, uint8_t i)
{
  return SMAP_DISCS > 0 && w->axle_of[i] != SMAP_NO_AXIS;
}

/* Find where a disc of radius 1 about the origin touches the plane with normal n. */
static void smap_reach(const float axle[3], const float n[3], float out[3])
{
  const float cosine = smap_dot(axle, n), flat = 1.0f - cosine * cosine;
  const float size = 1.0f / smap_root(flat > SMAP_FLAT ? flat : SMAP_FLAT);
  const float x = size * (n[0] - cosine * axle[0]), y = size * (n[1] - cosine * axle[1]);
  const float z = size * (n[2] - cosine * axle[2]);
  out[0] = x;
  out[1] = y;
  out[2] = z;
}

static void smap_touch(const smap_work_t *w, uint8_t i, const float n[3], float out[3])
{
  float reach[3];
  if (smap_is_disc(w, i)) {
    smap_reach(SMAP_AXLES(w)[w->axle_of[i]], n, reach);
  }
  smap_plus(w->p[i], w->r[i], smap_is_disc(w, i) ? reach : n, out);
}

/* Tells whether a contact is a wheel that lies on its face, on which no robot stands. */
static int smap_is_flat(const smap_work_t *w, uint8_t i, const float n[3])
{
  const float steepest = w->map->steepest > SMAP_FLATTEST ? w->map->steepest : SMAP_FLATTEST;
  const float face = SMAP_FACE + w->map->turned, least = steepest < face ? steepest : face;
  float across[3];
  if (!smap_is_disc(w, i)) {
    return 0;
  }
  smap_cross(SMAP_AXLES(w)[w->axle_of[i]], n, across);
  return !(smap_dot(across, across) > least * least);
}

#include "smap_roll.h"
#include "smap_swing.h"

/* Facets are found by rolling a plane over the edges of those that are known.  A facet that is not found makes the
 * region smaller and never larger. */
#define SMAP_SLIVER 4e-5f   /* rad: less steep, what a contact adds that all but touches is part of the facet */
#define SMAP_BESIDE 2e-3f   /* of the size: as far inside a side a contact may bear before one of its ends does, */
#define SMAP_HARDLY 1e-5f   /* and less than this does not matter, */
#define SMAP_AT_END 1e-4f   /* nor what is nearer to an end of the side */
#define SMAP_UPWARD 0.05f   /* cosine: of facets that face down as little those beyond are not looked for */

/* Leave out the corners that all but touch a plane where what they add is a facet of its own, over whose arc the robot
 * rolls first: of round contacts that may be a thousandth of the size. */
static uint8_t smap_cut_slivers(const smap_search_t *s, const float n[3], float (*p)[3], uint8_t *id, uint8_t count)
{
  const float size = SMAP_SIZE(s->w);
  uint8_t k, kept = 0;
  for (k = 0; k < count; k++) {
    const uint8_t last = kept > 0 ? (uint8_t)(kept - 1u) : (uint8_t)(count - 1u);
    const uint8_t next = k + 1u < count ? (uint8_t)(k + 1u) : (uint8_t)0;
    float along[3], d[3], in[3], size2, part, width, under;
    smap_minus(p[next], p[last], along);
    smap_minus(p[k], p[last], d);
    smap_cross(along, n, in);
    size2 = smap_dot(along, along);
    part = smap_dot(along, d) / size2;
    width = -smap_dot(in, d) / smap_root(size2);
    under = (1.0f - part) * smap_dot(p[last], n) + part * smap_dot(p[next], n) - smap_dot(p[k], n);
    if (!(width > SMAP_SLIVER * size) || under <= SMAP_SLIVER * width) {
      if (kept < k) {
        memcpy(p[kept], p[k], sizeof p[k]);
      }
      id[kept++] = id[k];
    }
  }
  return kept;
}

/* Make corners of all of those behind the first `count` that lie just inside a side, and return how many corners there
 * are then: while a wheel rolls it rises less than a ball, and of what is alike rounding decides which touches, so
 * that the robot may never stand on the whole side, but on one part of it and then on the other. */
static uint8_t smap_indent(const smap_search_t *s, const float n[3], float (*p)[3], uint8_t *id, uint8_t count,
                           uint8_t all)
{
  const float size = SMAP_SIZE(s->w);
  uint8_t k, at, last;
  for (k = count; k < all; k++) {
    const float here[3] = {p[k][0], p[k][1], p[k][2]};
    const uint8_t own = id[k];
    for (at = 0; at < count; at++) {
      float u[3], d[3], in[3], length, ahead, inside;
      smap_minus(p[at + 1 < count ? at + 1 : 0], p[at], u);
      smap_minus(here, p[at], d);
      smap_cross(u, n, in);
      length = smap_root(smap_dot(u, u));
      ahead = smap_dot(u, d);
      ahead = ahead < length * length - ahead ? ahead : length * length - ahead;
      inside = smap_dot(in, d);
      if (ahead > SMAP_AT_END * size * length && inside > SMAP_HARDLY * size * length &&
          inside < SMAP_BESIDE * size * length) {
        break;
      }
    }
    if (at < count) {
      for (last = k; last > at + 1u; last--) { /* what is between keeps its order */
        memcpy(p[last], p[last - 1], sizeof here);
        id[last] = id[last - 1];
      }
      memcpy(p[last], here, sizeof here);
      id[last] = own;
      count++;
    }
  }
  return count;
}

/* How many of some contacts are corners of a facet. */
static uint8_t smap_common(const smap_facet_t *f, const uint8_t *id, uint8_t count)
{
  uint8_t k, l, common = 0;
  for (k = 0; k < f->count; k++) {
    for (l = 0; l < count; l++) {
      common = (uint8_t)(common + (f->id[k] == id[l]));
    }
  }
  return common;
}

/* The facet on the plane with normal n on three contacts, whose places are there: known, new, or SMAP_NONE.  All that
 * touches the plane is part of it, unless a facet has most of that already: then both are one rest. */
SMAP_APART static uint8_t smap_facet_on(smap_search_t *s, const float n[3], const uint8_t three[3])
{
  smap_work_t *const w = s->w;
  const float top = smap_dot(s->there[three[0]], n) - SMAP_TOUCHES * SMAP_SIZE(w);
  smap_facet_t *const f = &s->facet[s->facets];
  float p[SMAP_MAX_CONTACTS][3], extent[SMAP_MAX_CONTACTS];
  uint8_t id[SMAP_MAX_CONTACTS], count = 0, near = 0, k, flat = 0, alone = 0;
  for (k = 0; k < SMAP_CONTACTS(w); k++) {
    extent[k] = smap_dot(s->there[k], n);
    if (extent[k] >= top) {
      id[count++] = k;
      flat |= (uint8_t)smap_is_flat(w, k, n);
    }
  }
  for (k = 0; k < s->facets; k++) {
    if (smap_apart2(s->facet[k].n, n) < SMAP_PARALLEL * SMAP_PARALLEL) {
      if (smap_common(&s->facet[k], three, 3) > 2) {
        return k;
      }
      alone |= smap_common(&s->facet[k], id, count) > 2;
    }
  }
  if (SMAP_IS_FULL(w, SMAP_OF_FACETS, s->facets, SMAP_MAX_FACETS)) {
    return SMAP_NONE;
  }
  if (alone) {
    memcpy(id, three, 3 * sizeof *id);
    count = 3;
  }
  for (k = 0; k < count; k++) {
    memcpy(p[k], s->there[id[k]], sizeof p[k]);
  }
  k = count;
  count = smap_outline(n, p, id, count);
  count = count > 2 ? smap_indent(s, n, p, id, count, k) : count;
  if (count > 3) {
    count = smap_cut_slivers(s, n, p, id, count);
  }
  if (count < 3 || count > SMAP_MAX_SIDES) {
    return SMAP_NONE;
  }
  for (k = 0; k < SMAP_CONTACTS(w); k++) {
    near = (uint8_t)(near + (extent[k] >= smap_dot(p[0], n) - w->map->tolerance));
  }
  memcpy(f->n, n, sizeof f->n);
  memcpy(f->id, id, count);
  f->count = count;
  f->first = flat || (SMAP_PIVOTS > 0 && smap_add_swung(w, n, smap_dot(p[0], n), extent))
                 ? (uint8_t)SMAP_NONE /* nor does the robot rock over an edge of what swings */
                 : smap_add_rest(w, n, p, id, count, near);
  return s->facets++;
}

/* The facet to which a plane with normal n, whose places are there, rolls over i and j: see
 * smap_facet_on. */
static uint8_t smap_roll_on(smap_search_t *s, const float n[3], uint8_t i, uint8_t j)
{
  float m[3] = {n[0], n[1], n[2]}, b[3], t[3];
  uint8_t three[3] = {i, j, SMAP_NONE};
  smap_minus(s->there[j], s->there[i], b);
  smap_cross(n, b, t);
  three[2] = smap_unit(t) ? smap_tilt(s, i, j, b, t, m) : (uint8_t)SMAP_NONE;
  return three[2] != SMAP_NONE ? smap_facet_on(s, m, three) : (uint8_t)SMAP_NONE;
}

/* Find a first facet: lower a level plane, tilt it towards the middle of all contacts onto a second one, and over both
 * to one side or the other. */
static void smap_begin_search(smap_search_t *s)
{
  const uint8_t contacts = SMAP_CONTACTS(s->w);
  float n[3] = {0.0f, 0.0f, -1.0f}, across[3], b[3] = {0.0f, 0.0f, 0.0f}, t[3];
  uint8_t i = 0, j, k, l, way;
  (void)smap_survey(s, n, 0, SMAP_NONE, SMAP_NONE, SMAP_NOISY);
  for (k = 0; k < contacts; k++) {
    i = s->there[k][2] < s->there[i][2] ? k : i;
    for (l = 0; l < 2; l++) {
      b[l] += s->there[k][l];
    }
  }
  t[0] = b[0] - (float)contacts * s->there[i][0];
  t[1] = b[1] - (float)contacts * s->there[i][1];
  t[2] = 0.0f;
  if (!smap_unit(t)) {
    t[0] = 1.0f;
  }
  smap_cross(n, t, across);
  j = smap_tilt(s, i, SMAP_NONE, across, t, n);
  /* A rest on three has the edge between both, and leads to what is beyond it. */
  for (way = 0; way < 2 && j != SMAP_NONE && !(s->facets > 0 && s->facet[0].first != SMAP_NONE &&
                                                   s->facet[0].count == 3); way++) {
    (void)smap_survey(s, n, i, j, SMAP_NONE, SMAP_NOISY);
    (void)smap_roll_on(s, n, way ? j : i, way ? i : j);
  }
}

/* Add the rests of a posture. */
SMAP_APART static void smap_find_rests(smap_work_t *w)
{
  smap_search_t s;
  uint8_t f, e, k, low = 0, balls = 0, rims = 0;
  for (k = 0; k < SMAP_CONTACTS(w); k++) {
    rims |= (uint8_t)smap_is_disc(w, k);
    balls |= (uint8_t)(w->r[k] > 0.0f && !smap_is_disc(w, k));
  }
  s.w = w;
  s.facets = 0;
  s.all = 1;
  smap_begin_search(&s);
  for (f = 0; f < s.facets; f++) {
    const smap_facet_t *const at = &s.facet[f];
    low |= -at->n[2] > SMAP_UPWARD;
    s.all = !(w->map->steepest > 0.0f && low) || (balls && rims); /* else facets that face down lead to each other */
    if (!(-at->n[2] > SMAP_UPWARD) && !s.all) {
      continue;
    }
    (void)smap_survey(&s, at->n, at->id[0], SMAP_NONE, SMAP_NONE, SMAP_NOISY);
    memcpy(s.here, s.there, sizeof s.here);
    for (e = 0; e < at->count; e++) {
      const uint8_t i = at->id[e], j = at->id[e + 1 < at->count ? e + 1 : 0];
      uint8_t to, first;
      if (at->first != SMAP_NONE && w->twin[at->first + e] != SMAP_NONE) {
        continue; /* the facet beyond was there before */
      }
      memcpy(s.there, s.here, sizeof s.there);
      to = smap_roll_on(&s, at->n, i, j);
      if (to == SMAP_NONE || to == f) {
        continue;
      }
      first = s.facet[to].first;
      for (k = 0; at->first != SMAP_NONE && first != SMAP_NONE && k < s.facet[to].count; k++) {
        if (w->twin[first + k] == SMAP_NONE) {
          smap_pair(w, (uint8_t)(at->first + e), (uint8_t)(first + k));
        }
      }
    }
  }
  w->facets = s.facets;
}

#include "smap_pose.h"
