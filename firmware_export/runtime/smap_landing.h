/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
#include "smap_region.h"
/* ---- landing: from where on an edge of two rests a robot that rolls stays on the rest it comes to ------ */
/* A balance on the contacts i and j at an edge of two rests is a part w of the way from i to j.  Let go there the
 * robot rolls to the one rest or the other, and lands: it stays if what its com has sunk by does not lift it over
 * another edge of that rest.
 *
 *   On landing gravity lies S inside an edge, the com is N above the edge's line, and has sunk by E, all linear
 *   in w.  The robot stays where S^2 >= E (2 N + E); as no geometric mean is above an arithmetic one, where
 *   S >= (c E + (2 N + E) / c) / 2 for any c: what lets go of it is then one end of the way. */
#define SMAP_ROUND_OFF 1e-6f /* of the size squared: what rounding may alter of S, N and E, */
#define SMAP_SUNK 1.01f      /* and of E, of which a half-way place stands for a whole arc */
#define SMAP_DOT 2e-6f       /* of the size: an edge that is shorter holds and bounds nothing of its own */

/* Gravity on arrival, and by how much the com has sunk, for w = 0 and 1. */
typedef struct {
  float g[2][3], sunk[2], doubt; /* doubt: length squared by which S, N and E may be off */
} smap_landing_t;

/* Find where both contacts of an edge touch the plane half-way between two normals, d apart. */
static void smap_find_half(const smap_work_t *w, uint8_t e, const float d[3], float (*half)[3])
{
  const uint8_t contact[2] = {w->contact[e], w->contact[w->next[e]]};
  float n[3], v[3];
  uint8_t left;
  smap_mix(w->normal[w->rest[e]], w->normal[w->rest[w->twin[e]]], 0.5f, n);
  for (left = 2; left > 0; left--) { /* one round of Newton's method: see smap_roll.h */
    (void)smap_unit(n);
    smap_touch(w, contact[0], n, half[0]);
    smap_touch(w, contact[1], n, half[1]);
    if (left == 1) {
      return;
    }
    smap_minus(half[0], half[1], v);
    smap_cross(v, d, n);
  }
}

/* Roll from a rest with one normal to that with another: gravity turns with the body, and the com sinks by the integral
 * of -p . dg over a contact that is at p, half-way at m, at last at q: both as parabolas. */
static void smap_roll(const float from[3], const float to[3], const float *const *p, float (*m)[3],
                      const float *const *q, smap_landing_t *l)
{
  const float more = 1.0f + smap_dot(from, to), share = 1.0f / more;
  const float half = smap_root(0.5f * share), half_share = half * half / (1.0f + more * half); /* of half the turn */
  float axis[3];
  uint8_t k, w;
  smap_cross(from, to, axis);
  SMAP_TWICE
  for (w = 0; w < 2; w++) {
    float across[3], end[3], g[3], sunk = 0.0f;
    smap_cross(axis, p[w], across);
    smap_cross(axis, across, end);
    SMAP_THRICE
    for (k = 0; k < 3; k++) { /* from p on, lest a small rise loses its digits */
      const float via = m[w][k] - p[w][k], by = q[w][k] - p[w][k];
      const float amid = half * across[k] + half_share * end[k];
      end[k] = across[k] + share * end[k];
      sunk += (2.0f / 3.0f) * (amid * by - end[k] * via) - end[k] * (p[w][k] + 0.5f * by);
      g[k] = p[w][k] + end[k];
    }
    memcpy(l->g[w], g, sizeof g);
    l->sunk[w] = SMAP_SUNK * sunk + l->doubt;
    l->sunk[w] = l->sunk[w] > 0.5f * l->doubt ? l->sunk[w] : 0.5f * l->doubt;
  }
}

/* Cut the part `span` of the way down to what one edge of a rest holds; 0 where nothing is left.  S is times the length
 * of the edge, N and E times its square. */
static int smap_hold(const smap_work_t *w, uint8_t e, const smap_landing_t *l, float span[2])
{
  const float *const a = w->region->place[e];
  float u[3], in[2], y[2], au, uu, size, t = 0.5f;
  uint8_t k, pass;
  int holds = 0;
  smap_minus(w->region->place[w->next[e]], a, u);
  uu = smap_dot(u, u);
  if (!(uu > SMAP_DOT * SMAP_DOT * SMAP_SIZE(w) * SMAP_SIZE(w))) {
    return 1;
  }
  au = smap_dot(a, u);
  size = smap_root(uu);
  SMAP_TWICE
  for (k = 0; k < 2; k++) {
    const float above = uu * (smap_dot(a, l->g[k]) + l->doubt) - au * smap_dot(u, l->g[k]), sunk = uu * l->sunk[k];
    in[k] = smap_dot(w->region->wall[e], l->g[k]) - size * l->doubt;
    y[k] = 2.0f * above + sunk;
    /* Below the edge, as soon as it is inside, it stays. */
    y[k] = y[k] > 0.01f * uu * l->doubt ? y[k] : 0.01f * uu * l->doubt;
  }
  for (pass = 0; pass < 2; pass++) { /* c of where it lets go is the best */
    const float e0 = l->sunk[0], e1 = l->sunk[1];
    const float c = 0.5f * smap_root((y[0] + t * (y[1] - y[0])) / (e0 + t * (e1 - e0)));
    const float d = 0.25f / c;
    const float first = in[0] - c * e0 - d * y[0], last = in[1] - c * e1 - d * y[1];
    holds = first >= 0.0f;
    if (holds == (last >= 0.0f)) {
      return holds;
    }
    t = first / (first - last);
  }
  if (holds && !(t >= span[1])) {
    span[1] = t;
  }
  if (!holds && !(t <= span[0])) {
    span[0] = t;
  }
  return span[0] < span[1];
}

/* The edge behind e on the outline of the rests that are one with its own. */
static uint8_t smap_onward(const smap_work_t *w, uint8_t e)
{
  uint8_t left = SMAP_MAX_CORNERS;
  for (e = w->next[e]; left > 0 && w->joined[e]; left--) {
    const uint8_t twin = w->twin[e];
    /*@ admit twin < SMAP_MAX_CORNERS; */
    e = w->next[twin];
  }
  return e;
}

/* Cut `span` down to what the rest holds that the robot comes to over its edge `came`; 0 where nothing is left. */
static int smap_land(const smap_work_t *w, uint8_t came, smap_landing_t *l, float span[2])
{
  const float doubt = l->doubt, more = doubt + SMAP_JOINED * SMAP_SIZE(w) * SMAP_SIZE(w);
  uint8_t left = SMAP_MAX_CORNERS, e;
  for (e = smap_onward(w, came); e != came && left > 0; e = smap_onward(w, e), left--) {
    /* Rests that are one have planes of their own. */
    l->doubt = w->rest[e] == w->rest[came] ? doubt : more;
    if (!smap_hold(w, e, l, span)) {
      return 0;
    }
  }
  l->doubt = doubt;
  return left > 0;
}
