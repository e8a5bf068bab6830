/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- rails: robots on many contacts ------------------------------------------------------------------- */
#define SMAP_INLINE SMAP_PLAIN
#define SMAP_UNROLL
#define SMAP_STEERED_BY "smap_control_region.c"
#define SMAP_DRAWN_BY "smap_host_region.h"
#ifndef SMAP_MANY_RAILS
#define SMAP_MANY_RAILS 62
#endif
#include "smap_joints.h"
#include "smap_region.h"

/* ---- facets of discs and points on parallel axes ----------------------------------------------------- */
/* Facets of discs and points on parallel axes: the history of a hull over pitch.
 *
 *   Contacts at one y are a rail; its level at a pitch is L = max (x s - z c + r).  Two rails carry
 *   the robot where they are neighbours on the upper hull of the points (y, L):
 *
 *       L ^     o-------o          As the pitch grows a rail goes on to another disc (a bend), or
 *         |    /         `-o       leaves the hull, or enters it.  Each such event is a facet, and
 *         |   o   x (off)  |       between two of them that have a pair of rails in common there
 *         +---------------------> y is an arc.
 *
 * With u = tan(pitch / 2) an event is the root of a quadratic.  Whether it is past is told by its
 * roots and never by its value, so that what ends at a root has ended there; rails that are on the
 * wrong side of the hull change at once.  A facet's plane is s x + t y - c z = h |(s, t, -c)|, with
 * sine s and cosine c of its pitch and its slope t.
 */
#define SMAP_NEVER 2.0f
#define SMAP_RECESS 3e-7f /* of the size: inner rails count as this much higher */
#define SMAP_ON 4e-6f     /* of tan(pitch / 2): this far apart are changes of one rail */
#define SMAP_FAR 1e30f
#define SMAP_IS_NONE(first) ((first) > SMAP_MANY_EDGES - 3) /* no facet's first of three edges: SMAP_NONE is none */
#define SMAP_EVENTS 250 /* of one history, at most */
#define SMAP_BEFORE 0.9f /* of the cosine of the steepest pitch: before any facet the history begins */

typedef struct {
  float bend[SMAP_MANY_RAILS], changed[SMAP_MANY_RAILS];
  uint8_t disc[SMAP_MANY_RAILS], onto[SMAP_MANY_RAILS], on[SMAP_MANY_RAILS];
  uint8_t own[SMAP_MANY_RAILS]; /* the edge at which the arc to the next rail began */
  float turn[SMAP_MANY_RAILS];  /* where an inner rail leaves the hull or enters it, once it is looked for */
} smap_hull_t;

#define SMAP_ROUNDED 3e-6f /* what rounding does to a place (u) */

/* The first place from u on where x s - z c + q is above zero. */
static float smap_crossing(float x, float z, float q, float u)
{
  const float rest = x * x + z * z - q * q;
  float s, t, grows, sinks;
  int above;
  if (!(rest > 0.0f)) {
    return q > 0.0f ? u : SMAP_NEVER;
  }
  s = smap_root(rest);
  t = q + z;
  if (x < 0.0f || (x == 0.0f && z < 0.0f)) {
    s = s - x;
    sinks = (q - z) / s;
    grows = t != 0.0f ? s / t : SMAP_FAR;
  } else {
    s = -(s + x);
    grows = (q - z) / s;
    sinks = t != 0.0f ? s / t : SMAP_FAR;
  }
  above = grows <= sinks ? grows <= u && u < sinks : u >= grows || u < sinks;
  if (above) {
    return u;
  }
  return u < grows && grows <= 1.0f ? grows : SMAP_NEVER;
}

/* Where rail k goes on from its disc, and onto which. */
static void smap_next_bend(const smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u)
{
  const uint8_t i = o->disc[k];
  uint8_t j;
  o->bend[k] = SMAP_NEVER;
  o->onto[k] = i;
  for (j = w->map->first[k]; j < w->map->first[k + 1]; j++) {
    const float x = w->p[j][0] - w->p[i][0], z = w->p[j][2] - w->p[i][2], q = w->r[j] - w->r[i];
    float at;
    if (j == i || (x < 0.0f && q == 0.0f)) { /* of one size: it has been left behind */
      continue;
    }
    /* One that sinks is above by rounding alone: wheels of one size in a row would take turns. */
    at = x * (1.0f - u * u) + 2.0f * z * u < 0.0f ? u + SMAP_ROUNDED : u;
    at = smap_crossing(x, z, q, at);
    if (at < o->bend[k]) {
      o->bend[k] = at;
      o->onto[k] = j;
    } else if (at == o->bend[k] && at < SMAP_NEVER) {
      /* Touched at once: the one further along carries on. */
      const uint8_t b = o->onto[k];
      const float ahead = (w->p[j][0] - w->p[b][0]) * (1.0f - at * at);
      if (ahead + (w->p[j][2] - w->p[b][2]) * 2.0f * at > 0.0f) {
        o->onto[k] = j;
      }
    }
  }
}

/* The rail on the hull before rail k, or SMAP_NONE for the first, which is always on it. */
static uint8_t smap_before(const smap_hull_t *o, uint8_t k)
{
  if (k == 0) {
    return SMAP_NONE;
  }
  for (k--; k > 0 && !o->on[k]; k--) {
  }
  return k;
}

/* The one after it, or SMAP_NONE for the last, which is always on it. */
static uint8_t smap_after(const smap_hull_t *o, uint8_t rails, uint8_t k)
{
  if (k + 1 >= rails) {
    return SMAP_NONE;
  }
  for (k++; k + 1 < rails && !o->on[k]; k++) {
  }
  return k;
}

/* Where the inner rail k leaves the hull, or enters it. */
static float smap_turns(const smap_many_work_t *w, const smap_hull_t *o, uint8_t k, float u)
{
  const uint8_t a = smap_before(o, k), b = smap_after(o, smap_rails_of(w->map), k);
  const uint8_t i = o->disc[k], l = o->disc[a], r = o->disc[b];
  const float *p = w->p[i], *pl = w->p[l], *pr = w->p[r];
  const float part = (p[1] - pr[1]) / (pl[1] - pr[1]), rest = 1.0f - part;
  const float x = p[0] - part * pl[0] - rest * pr[0];
  const float z = p[2] - part * pl[2] - rest * pr[2];
  const float q = w->r[i] - part * w->r[l] - rest * w->r[r] - SMAP_RECESS * w->map->size;
  return o->on[k] ? smap_crossing(-x, -z, -q, u) : smap_crossing(x, z, q, u);
}

/* Find which rails are on the hull at the first pitch u: what is below its neighbours' chord goes. */
static void smap_begin_hull(const smap_many_work_t *w, smap_hull_t *o, float u)
{
  uint8_t left, k;
  for (left = smap_rails_of(w->map); left > 0; left--) {
    for (k = 1; k + 1 < smap_rails_of(w->map); k++) {
      if (o->on[k] && smap_turns(w, o, k, u) == u) {
        o->on[k] = 0;
      }
    }
  }
}

/* Rail k has changed: so have the turns of the rails from its neighbour on one side to that on the other. */
static void smap_forget(const smap_many_work_t *w, smap_hull_t *o, uint8_t k)
{
  const uint8_t rails = smap_rails_of(w->map), b = smap_after(o, rails, k);
  uint8_t a = smap_before(o, k);
  for (a = a == SMAP_NONE ? 0 : a; a < rails && (b == SMAP_NONE || a <= b); a++) {
    o->turn[a] = -SMAP_NEVER;
  }
}

/* Where the inner rail k turns next from u on, looked for if it is not known. */
static float smap_next_turn(const smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u)
{
  if (o->turn[k] == -SMAP_NEVER) {
    o->turn[k] = smap_turns(w, o, k, u);
    if (o->turn[k] == o->changed[k]) {
      /* What has just changed may be wrong by rounding: look a little further on. */
      o->turn[k] = smap_turns(w, o, k, u + SMAP_ON);
    }
  }
  return o->turn[k];
}

static inline float smap_level(const smap_many_work_t *w, uint8_t i, float s, float c)
{
  return w->p[i][0] * s - w->p[i][2] * c + w->r[i];
}

/* Put the contacts into the frame of the axis; find each rail's disc at the first pitch u. */
static void smap_lay_out(smap_many_work_t *w, smap_hull_t *o, float u)
{
  const smap_many_t *m = w->map;
  const float scale = 1.0f / (1.0f + u * u), s = 2.0f * u * scale, c = (1.0f - u * u) * scale;
  uint8_t k, i;
  for (k = 0; k < smap_rails_of(m); k++) {
    const uint8_t first = m->first[k];
    uint8_t best = first;
    for (i = first; i < m->first[k + 1]; i++) {
      const float x = w->p[i][0], y = w->p[i][1];
      w->p[i][0] = x * m->axis[1] - y * m->axis[0];
      w->p[i][1] = i == first ? x * m->axis[0] + y * m->axis[1] : w->p[first][1];
      w->rail[i] = k;
      if (smap_level(w, i, s, c) > smap_level(w, best, s, c)) {
        best = i;
      }
    }
    o->disc[k] = best;
    o->on[k] = 1;
    o->changed[k] = o->turn[k] = -SMAP_NEVER;
    o->own[k] = SMAP_NONE;
    smap_next_bend(w, o, k, u);
  }
  smap_begin_hull(w, o, u);
}

/* Where a contact touches a plane. */
static inline void smap_touch(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at, float out[3])
{
  out[0] = w->p[i][0] + w->r[i] * at->s;
  out[1] = w->p[i][1];
  out[2] = w->p[i][2] - w->r[i] * at->c;
}

/* The directions along and across on a plane. */
static void smap_frame(const smap_aim_t *aim, float along[3], float across[3])
{
  along[0] = aim->c;
  along[1] = 0.0f;
  along[2] = aim->s;
  across[0] = -aim->n[1] * aim->s;
  across[1] = aim->n[0] * aim->s - aim->n[2] * aim->c;
  across[2] = aim->n[1] * aim->c;
}

/* How far a contact extends along a plane's normal. */
static inline float smap_extent(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
  /* The first product is 1 / |(s, t, -c)|. */
  return smap_level(w, i, at->s, at->c) * (at->n[0] * at->s - at->n[2] * at->c) +
         w->p[i][1] * at->n[1];
}

/* Where a contact touches a plane, along and across. */
static inline void smap_find_spot(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at,
                                  const float along[3], const float across[3], smap_spot_t *o)
{
  const float *p = w->p[i];
  o->a = p[0] * along[0] + p[2] * along[2];
  o->b = p[1] * across[1] - at->n[1] * smap_level(w, i, at->s, at->c);
}

/* The direction with a pitch and a slope; returns the length of (s, t, -c). */
static inline float smap_slope(smap_aim_t *o, float s, float c, float t)
{
  const float norm = smap_root(1.0f + t * t), size = 1.0f / norm;
  o->s = s;
  o->c = c;
  o->n[0] = s * size;
  o->n[1] = t * size;
  o->n[2] = -c * size;
  return norm;
}

#if SMAP_MANY_GAPS
/* The direction of a vector. */
static void smap_aim(smap_aim_t *o, const float v[3])
{
  const float size = 1.0f / smap_root(v[0] * v[0] + v[2] * v[2]);
  (void)smap_slope(o, v[0] * size, -v[2] * size, v[1] * size);
}
#endif

/* Enter the facet of three contacts, whose slope is that of a and b; its first edge, or none. */
static uint8_t smap_triangle(smap_many_work_t *w, float s, float c, const uint8_t three[3], uint8_t a,
                             uint8_t b)
{
  float ya, la, t, h, norm;
  smap_aim_t at;
  uint8_t e, k;
  if (!(c > w->map->steepest)) {
    return SMAP_NONE;
  }
  ya = w->p[a][1];
  la = smap_level(w, a, s, c);
  t = (la - smap_level(w, b, s, c)) / (w->p[b][1] - ya);
  h = la + t * ya;
  norm = smap_slope(&at, s, c, t);
  if (!(c > w->map->steepest * norm && h > w->map->least_height * norm)) {
    return SMAP_NONE;
  }
  e = smap_enter(w, &at, h / norm, 3);
  if (SMAP_IS_NONE(e)) {
    return SMAP_NONE;
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    w->vertex[e + k] = three[k];
    smap_touch(w, three[k], &at, w->corner[e + k]);
  }
  return e;
}

static void smap_join(smap_many_work_t *w, uint8_t e, uint8_t facet, uint8_t side)
{
  if (e < SMAP_MANY_EDGES && !SMAP_IS_NONE(facet)) {
    w->twin[e] = (uint8_t)(facet + side);
    w->twin[facet + side] = e;
  }
}

static uint8_t smap_edge(uint8_t facet, uint8_t side)
{
  return SMAP_IS_NONE(facet) ? (uint8_t)SMAP_NONE : (uint8_t)(facet + side);
}

/* Rail k goes on to another disc: a facet with each neighbour. */
static void smap_bend(smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u, float s, float c)
{
  const uint8_t a = smap_before(o, k), b = smap_after(o, smap_rails_of(w->map), k);
  const uint8_t d = o->disc[k], e = o->onto[k];
  uint8_t f = SMAP_NONE, g = SMAP_NONE;
  o->disc[k] = e;
  smap_next_bend(w, o, k, u);
  if (!o->on[k]) {
    return;
  }
  if (a != SMAP_NONE) {
    const uint8_t three[3] = {o->disc[a], d, e};
    f = smap_triangle(w, s, c, three, three[0], d);
    smap_join(w, o->own[a], f, 0);
    o->own[a] = smap_edge(f, 2);
  }
  if (b != SMAP_NONE) {
    const uint8_t three[3] = {o->disc[b], e, d};
    g = smap_triangle(w, s, c, three, d, three[0]);
    smap_join(w, o->own[k], g, 2);
    o->own[k] = smap_edge(g, 0);
  }
  if (!SMAP_IS_NONE(f)) {
    smap_join(w, (uint8_t)(f + 1u), g, 1);
  }
}

/* The inner rail k leaves the hull or enters it: a facet with both neighbours. */
static void smap_swap(smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u, float s, float c)
{
  const uint8_t a = smap_before(o, k), b = smap_after(o, smap_rails_of(w->map), k);
  const uint8_t i = o->disc[a], j = o->disc[b], d = o->disc[k], on = o->on[k];
  const uint8_t three[3] = {i, on ? d : j, on ? j : d};
  const uint8_t f = smap_triangle(w, s, c, three, i, j);
  smap_join(w, o->own[a], f, 0);
  if (on) {
    smap_join(w, o->own[k], f, 1);
    o->own[k] = SMAP_NONE;
  } else {
    o->own[k] = smap_edge(f, 1);
  }
  o->own[a] = smap_edge(f, 2);
  o->on[k] = !o->on[k];
  o->changed[k] = u;
}

/* Fill the complex of one posture. */
SMAP_APART static void smap_find_facets(smap_many_work_t *w)
{
  smap_hull_t o;
  const float steepest = w->map->steepest > 0.0f ? SMAP_BEFORE * w->map->steepest : 0.0f;
  float u = -smap_root((1.0f - steepest) / (1.0f + steepest)), first;
  uint8_t left;
  smap_lay_out(w, &o, u);
  for (left = SMAP_EVENTS; left > 0; left--) {
    uint8_t k, bends = 0, turns = SMAP_NONE; /* which rail comes first */
    float scale, s, c;
    first = SMAP_NEVER;
    for (k = 0; k < smap_rails_of(w->map); k++) {
      if (o.bend[k] < first) {
        first = o.bend[k];
        bends = k;
      }
    }
    for (k = 1; k + 1 < smap_rails_of(w->map); k++) {
      const float at = smap_next_turn(w, &o, k, u);
      if (at < first || (at == first && turns == SMAP_NONE && k < bends)) {
        first = at;
        turns = k;
      }
    }
    if (first > 1.0f) {
      return;
    }
    scale = 1.0f / (1.0f + first * first);
    s = 2.0f * first * scale;
    c = (1.0f - first * first) * scale;
    if (first > 0.0f && c <= w->map->steepest) {
      return; /* steeper and steeper */
    }
    if (turns == SMAP_NONE) {
      smap_bend(w, &o, bends, first, s, c);
    } else {
      smap_swap(w, &o, turns, first, s, c);
      bends = turns;
    }
    smap_forget(w, &o, bends);
    u = first;
  }
  w->full = 1;
}

/* ---- rests: support polygons and their width --------------------------------------------------------- */
/* Which facets are rests: the support polygon of each, its centroid and whether it is wide enough.
 *
 * All contacts within the tolerance of a facet's plane make up its polygon.
 */
#define SMAP_BELOW 2e-5f        /* of the size: a facet has no contact as far below it */
#define SMAP_TURN_SHORT 1.9e-4f /* rad: rests that a shorter arc joins are one; of 2e-4, less rounding */

/* List the contacts that reach as far as `top` along a plane's normal; none where one reaches beyond `most`. */
static uint8_t smap_list_near(const smap_many_work_t *w, const smap_aim_t *aim, float top, float most,
                              uint8_t *contact)
{
  const smap_aim_t plane = *aim; /* no store can alter it */
  const uint8_t contacts = smap_contacts_of(w->map);
  uint8_t i, count = 0;
  for (i = 0; i < contacts; i++) {
    const float reach = smap_extent(w, i, &plane);
    if (reach > most) {
      return 0;
    }
    if (reach >= top) {
      contact[count++] = i;
    }
  }
  return count;
}

/* Find where contacts touch a plane, sorted by b. */
static void smap_find_spots(const smap_many_work_t *w, const smap_aim_t *aim, const uint8_t *contact, uint8_t count,
                            smap_spot_t *spot)
{
  float along[3], across[3];
  uint8_t k, at;
  smap_frame(aim, along, across);
  for (k = 0; k < count; k++) {
    smap_spot_t here;
    smap_find_spot(w, contact[k], aim, along, across, &here);
    for (at = k; at > 0 && (spot[at - 1].b > here.b ||
                            (spot[at - 1].b == here.b && spot[at - 1].a < here.a)); at--) {
      spot[at] = spot[at - 1];
    }
    spot[at] = here;
  }
}

static inline float smap_bend_of(const smap_spot_t *o, const smap_spot_t *p, const smap_spot_t *q)
{
  return (p->a - o->a) * (q->b - o->b) - (p->b - o->b) * (q->a - o->a);
}

/* The corners of the polygon of spots, counter-clockwise in (a, b). */
static uint8_t smap_polygon(const smap_spot_t *spot, uint8_t count, uint8_t *corner)
{
  uint8_t n = 0, k, i, least = 1;
  for (k = 0; k < 2u * count; k++) {
    i = k < count ? k : (uint8_t)(2u * count - 1u - k);
    if (k == count) {
      least = n;
      continue;
    }
    while (n > least && !(smap_bend_of(&spot[corner[n - 2]], &spot[corner[n - 1]], &spot[i]) > 0.0f)) {
      n--;
    }
    corner[n++] = i;
  }
  return (uint8_t)(n > 0 ? n - 1u : 0u);
}

/* Whether a polygon is at least `width` wide in every direction. */
static int smap_wide(const smap_spot_t *spot, const uint8_t *corner, uint8_t n, float width)
{
  uint8_t side, j;
  for (side = 0; side < n; side++) {
    const uint8_t next = (uint8_t)(side + 1 < n ? side + 1 : 0);
    const smap_spot_t *o = &spot[corner[side]], *q = &spot[corner[next]];
    const float da = q->a - o->a, db = q->b - o->b, wanted = width * width * (da * da + db * db);
    for (j = (uint8_t)(next + 1 < n ? next + 1 : 0); j != side; j = (uint8_t)(j + 1 < n ? j + 1 : 0)) {
      const float out = smap_bend_of(o, q, &spot[corner[j]]);
      if (out > 0.0f && out * out >= wanted) {
        break;
      }
    }
    if (j == side) {
      return 0;
    }
  }
  return 1;
}

/* The area centroid of a polygon, or 0 where it has no area. */
static int smap_centroid(const smap_spot_t *spot, const uint8_t *corner, uint8_t n,
                         const smap_facet_t *f, float out[3])
{
  const smap_spot_t *o = &spot[corner[0]];
  float all = 0.0f, a = 0.0f, b = 0.0f, along[3], across[3];
  uint8_t i;
  for (i = 1; i + 1 < n; i++) {
    const smap_spot_t *p = &spot[corner[i]], *q = &spot[corner[i + 1]];
    const float part = smap_bend_of(o, p, q);
    all += part;
    a += part * (p->a + q->a - 2.0f * o->a);
    b += part * (p->b + q->b - 2.0f * o->b);
  }
  if (!(all > 0.0f)) {
    return 0;
  }
  all = 1.0f / (3.0f * all);
  a = o->a + a * all;
  b = o->b + b * all;
  smap_frame(&f->at, along, across);
  SMAP_THRICE
  for (i = 0; i < 3; i++) {
    out[i] = f->h * f->at.n[i] + a * along[i] + b * across[i];
  }
  return 1;
}

/* The square of twice the area of a triangle, and that of its longest side. */
static inline float smap_area2(const float (*corner)[3], float *longest)
{
  float a[3], b[3], other, third;
  smap_minus(corner[1], corner[0], a);
  smap_minus(corner[2], corner[0], b);
  *longest = smap_dot(a, a);
  other = smap_dot(b, b);
  third = *longest + other - 2.0f * smap_dot(a, b); /* to the last digits where it is the longest */
  *longest = other > *longest ? other : *longest;
  *longest = third > *longest ? third : *longest;
  other = a[1] * b[2] - a[2] * b[1];
  third = a[2] * b[0] - a[0] * b[2];
  a[2] = a[0] * b[1] - a[1] * b[0];
  return other * other + third * third + a[2] * a[2];
}

/* Whether a triangle is at least `width` wide: it is least wide across its longest side. */
static int smap_is_broad(const float (*corner)[3], float width)
{
  float longest;
  const float area2 = smap_area2(corner, &longest);
  return area2 > 0.0f && area2 >= width * width * longest;
}

/* Whether a facet that three contacts are near, as most are, has just these for corners. */
static inline int smap_is_triangle(const smap_many_work_t *w, const smap_facet_t *facet, uint8_t count)
{
  return count == 3 && w->next[facet->first + 2u] == facet->first;
}

/* Tell which facets are rests, and find their centroids. */
SMAP_APART static void smap_classify(smap_many_work_t *w)
{
  const float width = w->map->rest_width;
  uint8_t f;
  for (f = 0; f < w->facets; f++) {
    smap_spot_t spot[SMAP_MANY_CONTACTS];
    uint8_t corner[2 * SMAP_MANY_CONTACTS + 1] = {0}, k;
    smap_facet_t *facet = &w->facet[f];
    const float(*const at)[3] = (const float(*)[3])w->corner + facet->first;
    const uint8_t count = smap_list_near(w, &facet->at, facet->h - w->map->tolerance,
                                         facet->h + SMAP_BELOW * w->map->size, corner);
    int wide = 0;
    if (smap_is_triangle(w, facet, count)) {
      wide = smap_is_broad(at, width);
      SMAP_THRICE
      for (k = 0; k < 3; k++) {
        facet->centre[k] = (at[0][k] + at[1][k] + at[2][k]) * (1.0f / 3.0f);
      }
    } else if (count != 0) {
      uint8_t n;
      smap_find_spots(w, &facet->at, corner, count, spot);
      n = smap_polygon(spot, count, corner);
      wide = n >= 3 && smap_centroid(spot, corner, n, facet, facet->centre) && smap_wide(spot, corner, n, width);
    }
    facet->rest = wide ? (uint8_t)SMAP_FOUND : (uint8_t)SMAP_NONE;
  }
}

static inline int smap_is_rest(const smap_many_work_t *w, uint8_t e)
{
  return w->facet[w->owner[e]].rest != SMAP_NONE;
}

/* Mark the arcs between rests that are one, and find the outlines of what they join: no short arc is gone over
 * twice. */
static void smap_find_outlines(smap_many_work_t *w)
{
  uint8_t e, left = SMAP_MOST(w->map, edges, SMAP_MANY_EDGES);
  for (e = 0; e < w->edges; e++) {
    const uint8_t back = w->twin[e];
    w->low[e] = SMAP_OPEN;
    if (back < e && smap_is_rest(w, e) && smap_is_rest(w, back)) {
      float d[3];
      smap_minus(w->facet[w->owner[e]].at.n, w->facet[w->owner[back]].at.n, d);
      if (smap_dot(d, d) < SMAP_TURN_SHORT * SMAP_TURN_SHORT) {
        w->low[e] = w->low[back] = SMAP_SHORT;
      }
    }
  }
  for (e = 0; e < w->edges; e++) {
    uint8_t at = w->next[e];
    for (; w->low[e] != SMAP_SHORT && w->low[at] == SMAP_SHORT && left > 0; left--) {
      at = w->next[w->twin[at]];
    }
    w->onward[e] = at;
  }
}

/* ---- walls and the boundary of the region ------------------------------------------------------------ */
/* A wall is a plane through the com, kept as its unit normal, which points into its cone.  A part of the boundary is
 * an arc on a wall, kept as its middle and its direction there. */

/* Scale a vector to length 1; 0 where it has no direction, or is no number. */
static int smap_scale(const float v[3], float out[3])
{
  const float size2 = smap_dot(v, v);
  float scale;
  if (!(size2 > 1e-34f && size2 < 1e34f)) {
    return 0;
  }
  scale = 1.0f / smap_root(size2);
  out[0] = v[0] * scale;
  out[1] = v[1] * scale;
  out[2] = v[2] * scale;
  return 1;
}

/* Give what short arcs join with edge `start` one number as a rest, and make its walls, in the order of its edges. */
SMAP_APART static void smap_add_rest(smap_many_work_t *w, smap_many_pose_t *o, uint8_t start)
{
  const smap_facet_t *f = &w->facet[w->owner[start]];
  const uint8_t at = o->at.rests;
  const float size2 = w->map->size * w->map->size, least = 1e-14f * size2 * size2;
  uint8_t e = start, n = o->at.edge[at], k, left = w->edges;
  float along[3], wall[3];
  if (at >= SMAP_MOST(w->map, rests, SMAP_MANY_RESTS)) {
    w->full = 1;
    return;
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o->plane[at][k] = f->at.n[k] / f->h;
    o->centre[at][k] = f->centre[k];
  }
  o->height[at] = f->h;
  o->at.alone[at] = 1;
  do {
    w->facet[w->owner[e]].rest = at;
    smap_minus(smap_end(w, e), smap_corner(w, e), along);
    smap_cross(smap_corner(w, e), along, wall);
    if (smap_dot(wall, wall) > least) {
      if (n >= SMAP_MOST(w->map, corners, SMAP_MANY_CORNERS) || !smap_scale(wall, o->wall[n])) {
        w->full = 1;
        return;
      }
      o->at.over[n][0] = w->map->named[w->vertex[e]];
      o->at.over[n][1] = w->map->named[w->vertex[w->next[e]]];
      w->wall_of[e] = n++;
    }
    e = w->onward[e];
  } while (e != start && --left > 0);
  w->full = e != start ? 1 : w->full;
  o->at.edge[at + 1] = n;
  o->at.rests = (uint8_t)(at + 1u);
}

/* Add a part of the boundary, from place p to q on a wall. */
static void smap_add_arc(smap_many_work_t *w, smap_many_pose_t *o, uint8_t wall, const float p[3], const float q[3])
{
  const uint8_t at = o->at.arcs;
  float a[3], b[3], sine2, cosine, sine;
  uint8_t k;
  if (at >= SMAP_MOST(w->map, arcs, SMAP_MANY_ARCS) || !smap_scale(p, a) || !smap_scale(q, b)) {
    w->full = 1;
    return;
  }
  smap_minus(b, a, o->along[at]);
  sine2 = 0.25f * smap_dot(o->along[at], o->along[at]); /* of half of it */
  sine = smap_root(sine2);
  cosine = smap_root(1.0f - (sine2 < 1.0f ? sine2 : 1.0f));
  smap_mix(a, b, 0.5f, a);
  if (!smap_scale(a, b)) {
    w->full = 1;
    return;
  }
  smap_cross(o->wall[wall], b, a);
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o->along[at][k] = a[k] * cosine;
    o->amid[at][k] = b[k] * sine;
  }
  o->at.arc[at] = wall;
  o->at.arcs = (uint8_t)(at + 1u);
}

#if SMAP_MANY_GAPS
/* ---- gaps: where the robot rocks from one rest to the next ------------------------------------------- */
/* A balance on the contacts i and j at an edge of two rests is a part w of the way from i to j.  Let go there the
 * robot rolls to the one rest or the other, and lands: it stays if what its com has sunk by does not lift it over
 * another edge of that rest.  The gap is of the w from which it stays, whichever way it rolls.
 *
 *   On landing gravity lies S inside an edge, the com is N above the edge's line, and has sunk by E, all linear
 *   in w.  The robot stays where S^2 >= E (2 N + E); as no geometric mean is above an arithmetic one, where
 *   S >= (c E + (2 N + E) / c) / 2 for any c: what lets go of it is then one end of the way.
 */
#define SMAP_ROUND_OFF 1e-6f /* of the size squared: what rounding may alter of S, N and E, */
#define SMAP_SUNK 1.01f    /* and of E, of which half-way values stand for a whole arc */
#define SMAP_SPARE 1e-4f   /* of the way, by which a limit is on the safe side */
#define SMAP_STEP_IN 1.1f  /* times what brings the side of a gap in */
#define SMAP_HALVES 8      /* rounds of Newton's method, and one */
#define SMAP_SLIT 1e-5f    /* of the size: between edges that are nearer there is nothing */
#define SMAP_LEANS 1e-6f   /* of the size: the ends of a gap are as far inside its sides */

/* Gravity on arrival, and by how much the com has sunk, for w = 0 and 1. */
typedef struct {
  float g[2][3], sunk[2];
} smap_landing_t;

/* By how much the least rotation from unit vector a to b turns g. */
static void smap_turn(const float a[3], const float b[3], const float g[3], float out[3])
{
  const float part = 1.0f / (1.0f + smap_dot(a, b));
  float axis[3], across[3];
  uint8_t k;
  smap_cross(a, b, axis);
  smap_cross(axis, g, across);
  smap_cross(axis, across, out);
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    out[k] = across[k] + part * out[k];
  }
}

/* By how much the com sinks over a contact at p, then m, at last q, while gravity turns by half and whole: the integral
 * of -p . dg, both as parabolas.  Places are from p on, lest a small rise loses its digits. */
static float smap_sinks(const float p[3], const float m[3], const float q[3], const float half[3], const float whole[3])
{
  float sunk = -smap_dot(p, whole);
  uint8_t k;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    const float end = q[k] - p[k];
    sunk += half[k] * end * (2.0f / 3.0f) - whole[k] * (end * 0.5f + (m[k] - p[k]) * (2.0f / 3.0f));
  }
  return sunk;
}

/* Roll from one rest to the other, `way` 1 for the way back, by its three normals, the corners of the gap and where
 * both contacts are half-way.  The sunk height is the greater of those that the two contacts give. */
static void smap_roll(const float *const n[3], const float *const corner[4], const float half[2][3], uint8_t way,
                      smap_landing_t *l)
{
  const float *const from[2] = {corner[way ? 3 : 0], corner[way ? 2 : 1]};
  const float *const to[2] = {corner[way ? 0 : 3], corner[way ? 1 : 2]};
  uint8_t k, i;
  for (k = 0; k < 2; k++) {
    float part[3], whole[3], other;
    smap_turn(n[0], n[1], from[k], part);
    smap_turn(n[0], n[2], from[k], whole);
    l->sunk[k] = smap_sinks(from[0], half[0], to[0], part, whole);
    other = smap_sinks(from[1], half[1], to[1], part, whole);
    l->sunk[k] = SMAP_SUNK * (other > l->sunk[k] ? other : l->sunk[k]);
    SMAP_THRICE
    for (i = 0; i < 3; i++) {
      l->g[k][i] = from[k][i] + whole[i];
    }
  }
}

/* Cut the part `span` of the way down to what one edge holds; 0 where nothing is left.  `doubt`: length squared by
 * which S, N and E may be off. */
static int smap_hold(const float a[3], const float b[3], const smap_landing_t *l, float doubt, float span[2])
{
  float along[3], wall[3], foot[3], s[2], y[2], e[2], inverse, c, t = 0.5f, begin = 0.0f, last = 0.0f;
  uint8_t k, pass;
  smap_minus(b, a, along);
  inverse = smap_dot(along, along);
  if (!(inverse > 0.0f)) {
    return 1;
  }
  inverse = 1.0f / smap_root(inverse);
  smap_cross(a, along, wall);
  smap_mix(a, b, -smap_dot(a, along) * inverse * inverse, foot); /* the com's on the edge's line */
  for (k = 0; k < 2; k++) {
    e[k] = l->sunk[k] > -0.5f * doubt ? l->sunk[k] + doubt : 0.5f * doubt;
    s[k] = smap_dot(wall, l->g[k]) * inverse - doubt;
    y[k] = 2.0f * (smap_dot(foot, l->g[k]) + doubt) + e[k];
    y[k] = y[k] > 0.01f * doubt ? y[k] : 0.01f * doubt; /* the com is below: as soon as it is inside it stays */
  }
  for (pass = 0; pass < 2; pass++) { /* c of where it lets go is the best */
    c = smap_root((y[0] + t * (y[1] - y[0])) / (e[0] + t * (e[1] - e[0])));
    begin = s[0] - 0.5f * (c * e[0] + y[0] / c);
    last = s[1] - 0.5f * (c * e[1] + y[1] / c);
    if ((begin < 0.0f) == (last < 0.0f)) {
      break;
    }
    t = begin / (begin - last);
  }
  if (!(begin >= 0.0f || last >= 0.0f)) {
    return 0;
  }
  if (!(begin >= 0.0f) && !(t <= span[0])) {
    span[0] = t;
  }
  if (!(last >= 0.0f) && !(t >= span[1])) {
    span[1] = t;
  }
  return span[0] < span[1];
}

/* Cut `span` down to what the rest holds that the robot comes to over its edge `came`; 0 where nothing is left.  What
 * short arcs join with that lies on a plane of its own. */
static int smap_land(const smap_many_work_t *w, uint8_t came, const smap_landing_t *l, float turned, float span[2])
{
  const float square = w->map->size * w->map->size;
  const float doubt = SMAP_ROUND_OFF + SMAP_OFF(w->map) + SMAP_OFF_TURNED(w->map) * turned;
  const float *n = w->facet[w->owner[came]].at.n;
  uint8_t e, left = w->edges;
  for (e = w->onward[came]; e != came && left > 0; e = w->onward[e], left--) {
    float d[3] = {0.0f, 0.0f, 0.0f};
    if (w->owner[e] != w->owner[came]) {
      smap_minus(w->facet[w->owner[e]].at.n, n, d);
    }
    if (!smap_hold(smap_corner(w, e), smap_end(w, e), l, (doubt + smap_root(smap_dot(d, d))) * square, span)) {
      return 0;
    }
  }
  return left > 0;
}

/* How far beyond the wall through the com and the side of a gap at w a place is. */
static float smap_beyond(const float *const corner[4], float w, const float place[3])
{
  float p[3], q[3], n[3];
  smap_mix(corner[0], corner[1], w, p);
  smap_mix(corner[3], corner[2], w, q);
  smap_minus(q, p, q); /* of places next to each other p x q would lose its digits */
  smap_cross(p, q, n);
  return smap_dot(n, place);
}

/* Bring one side of a gap in until the half-way place of the curve that it stands for is not inside; 0 where there is
 * none. */
static int smap_bring_in(const float *const corner[4], const float half[2][3], uint8_t side, float span[2])
{
  const float w = span[side], other = span[1 - side];
  float place[3], f, h;
  smap_mix(half[0], half[1], w, place);
  f = smap_beyond(corner, w, place);
  h = smap_beyond(corner, other, place);
  if (side) {
    f = -f;
    h = -h;
  }
  if (!(f > 0.0f)) {
    return f <= 0.0f;
  }
  span[side] = w + (other - w) * SMAP_STEP_IN * f / (f - h);
  return h < 0.0f;
}

/* Add the cone of a gap: between both edges, and the sides at both ends of its span; 0 where it is twisted, or there is
 * no room. */
static int smap_add_quad(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e, const float *const corner[4],
                         const float span[2])
{
  const uint8_t k = o->at.gaps, back = w->twin[e], over[2] = {w->vertex[e], w->vertex[w->next[e]]};
  float place[2][2][3];
  uint8_t side;
  if (k >= SMAP_MOST(w->map, gaps, SMAP_MANY_GAPS)) {
    return 0;
  }
  for (side = 0; side < 2; side++) {
    smap_mix(corner[0], corner[1], span[side], place[side][0]);
    smap_mix(corner[3], corner[2], span[side], place[side][1]);
  }
  for (side = 0; side < 2; side++) {
    const uint8_t at = (uint8_t)(SMAP_MANY_CORNERS + 2u * k + side);
    float along[3], n[3];
    smap_minus(place[side][1 - side], place[side][side], along);
    smap_cross(place[side][side], along, n);
    if (!smap_scale(n, o->wall[at]) || !(smap_dot(o->wall[at], place[1 - side][0]) > SMAP_LEANS * w->map->size) ||
        !(smap_dot(o->wall[at], place[1 - side][1]) > SMAP_LEANS * w->map->size)) {
      return 0;
    }
    o->at.over[at][0] = o->at.over[at][1] = w->map->named[over[side]];
  }
  for (side = 0; side < 2; side++) {
    smap_add_arc(w, o, (uint8_t)(SMAP_MANY_CORNERS + 2u * k + side), place[side][side], place[side][1 - side]);
  }
  o->at.gap[k].a = w->wall_of[e];
  o->at.gap[k].b = w->wall_of[back];
  o->at.gaps = (uint8_t)(k + 1u);
  return 1;
}

/* Whether an edge is the same line on both of its rests: what holds of it has no width. */
static int smap_is_slit(const smap_many_work_t *w, uint8_t e)
{
  const uint8_t back = w->twin[e];
  float a[3], b[3];
  smap_minus(smap_corner(w, e), smap_end(w, back), a);
  smap_minus(smap_end(w, e), smap_corner(w, back), b);
  return smap_dot(a, a) + smap_dot(b, b) < SMAP_SLIT * SMAP_SLIT * w->map->size * w->map->size;
}

/* Find the mean of two normals, and where the contacts i and j touch the plane half-way between them.  Newton's method
 * takes the plane through the places where they touch the plane before. */
static void smap_find_half(const smap_many_work_t *w, uint8_t i, uint8_t j, const float from[3], const float to[3],
                           float mean[3], float place[2][3])
{
  smap_aim_t at;
  float v[3], d[3], n[3], change = 1.0f, along;
  uint8_t k, left;
  smap_mix(from, to, 0.5f, v);
  smap_minus(from, to, d);
  smap_aim(&at, v);
  smap_copy(at.n, mean);
  along = smap_dot(d, mean); /* none but for rounding, which of a short way is much */
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    d[k] -= along * mean[k];
  }
  for (left = SMAP_HALVES; left > 0; left--) {
    smap_touch(w, i, &at, place[0]);
    smap_touch(w, j, &at, place[1]);
    if (!(change > 1e-12f)) {
      return;
    }
    smap_minus(place[1], place[0], v);
    smap_cross(v, d, n);
    if (!smap_scale(n, n)) {
      return;
    }
    along = smap_dot(n, at.n) < 0.0f ? -1.0f : 1.0f;
    change = 0.0f;
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      n[k] *= along;
      change += (n[k] - at.n[k]) * (n[k] - at.n[k]);
    }
    smap_aim(&at, n);
  }
}

/* Find what holds of an edge between two rests. */
SMAP_APART static void smap_find_gap(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const uint8_t back = w->twin[e], i = w->vertex[e], j = w->vertex[w->next[e]];
  const smap_aim_t *const from = &w->facet[w->owner[e]].at, *const to = &w->facet[w->owner[back]].at;
  const float *const corner[4] = {smap_corner(w, e), smap_end(w, e), smap_corner(w, back), smap_end(w, back)};
  float half[2][3], span[2] = {0.0f, 1.0f}, mean[3], turned;
  uint8_t way, left;
  smap_minus(from->n, to->n, half[0]);
  turned = smap_root(smap_dot(half[0], half[0]));
  if (!(turned <= w->map->rock_chord)) {
    return;
  }
  smap_find_half(w, i, j, from->n, to->n, mean, half);
  for (way = 0; way < 2; way++) {
    const float *const n[3] = {way ? to->n : from->n, mean, way ? from->n : to->n};
    smap_landing_t l;
    smap_roll(n, corner, (const float(*)[3])half, way, &l);
    if (!smap_land(w, way ? e : back, &l, turned, span)) {
      return;
    }
  }
  for (left = smap_is_slit(w, e) ? 0 : 2; left > 0; left--) {
    if (!smap_bring_in(corner, (const float(*)[3])half, 0, span) ||
        !smap_bring_in(corner, (const float(*)[3])half, 1, span)) {
      return;
    }
  }
  span[0] = span[0] > 0.0f ? span[0] + SMAP_SPARE : 0.0f;
  span[1] = span[1] < 1.0f ? span[1] - SMAP_SPARE : 1.0f;
  if (span[0] < span[1] && (smap_is_slit(w, e) || smap_add_quad(w, o, e, corner, span))) {
    w->low[e] = span[0];
    w->low[back] = 1.0f - span[1];
    o->at.alone[w->facet[w->owner[e]].rest] = o->at.alone[w->facet[w->owner[back]].rest] = 0;
  }
}
#endif

/* ---- poses of many contacts -------------------------------------------------------------------------- */
/* A pose: what `at` needs of a posture. */

/* Add what is boundary of the edge of a rest: all but what holds of it. */
static void smap_bound(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const float *const p = smap_corner(w, e), *const q = smap_end(w, e);
  const uint8_t wall = w->wall_of[e];
#if SMAP_MANY_GAPS
  const uint8_t back = w->twin[e];
  float r[3];
  if (smap_is_gap(w, e)) {
    if (smap_is_slit(w, e) && back < e) {
      return; /* it is that of the other rest */
    }
    if (w->low[e] > 0.0f) {
      smap_mix(p, q, w->low[e], r);
      smap_add_arc(w, o, wall, p, r);
    }
    if (w->low[back] > 0.0f) {
      smap_mix(q, p, w->low[back], r);
      smap_add_arc(w, o, wall, r, q);
    }
    return;
  }
#endif
  smap_add_arc(w, o, wall, p, q);
}

#if SMAP_MANY_RAILS
/* Turn what was found in the rails' frame into the body's. */
static void smap_turn_back(const smap_many_t *m, float (*v)[3], uint8_t n)
{
  uint8_t k;
  for (k = 0; k < n; k++) {
    const float x = v[k][0], y = v[k][1];
    v[k][0] = x * m->axis[1] + y * m->axis[0];
    v[k][1] = y * m->axis[1] - x * m->axis[0];
  }
}
#endif

/* Make the pose of a posture whose contacts are where `w` has them; 0 where that fails, and then it reads unsafe. */
static int smap_many_pose(const smap_many_t *m, smap_many_pose_t *o, smap_many_work_t *w)
{
  uint8_t e;
  memset(&o->at, 0, sizeof o->at);
  o->guard = m->guard;
  w->map = m;
  w->facets = w->edges = w->full = 0;
  smap_find_facets(w);
  smap_classify(w);
  smap_find_outlines(w);
  memset(w->wall_of, (int)SMAP_NONE, sizeof w->wall_of);
  for (e = 0; e < w->edges && !w->full; e++) {
    if (w->facet[w->owner[e]].rest == SMAP_FOUND && w->low[e] != SMAP_SHORT) {
      smap_add_rest(w, o, e);
    }
  }
#if SMAP_MANY_GAPS
  for (e = 0; e < w->edges && !w->full; e++) {
    if (w->twin[e] > e && w->wall_of[e] != SMAP_NONE && w->wall_of[w->twin[e]] != SMAP_NONE) {
      smap_find_gap(w, o, e);
    }
  }
#endif
  for (e = 0; e < w->edges && !w->full; e++) {
    if (w->wall_of[e] != SMAP_NONE) {
      smap_bound(w, o, e);
    }
  }
  if (w->full) {
    return 0;
  }
#if SMAP_MANY_RAILS
  if (m->axis[1] != 1.0f) {
    smap_turn_back(m, o->plane, o->at.rests);
    smap_turn_back(m, o->centre, o->at.rests);
    smap_turn_back(m, o->wall, o->at.edge[o->at.rests]);
    smap_turn_back(m, o->wall + SMAP_MANY_CORNERS, (uint8_t)(2u * o->at.gaps));
    smap_turn_back(m, o->amid, o->at.arcs);
    smap_turn_back(m, o->along, o->at.arcs);
  }
#endif
  o->at.alive = 1;
  return 1;
}

/* ---- reading many contacts --------------------------------------------------------------------------- */
/* One direction of gravity against a pose, float. */

#define SMAP_SINE 1e-6f /* what rounding may alter of one, which near a right angle alters its angle by much more */
#define SMAP_EDGE 1e-5f /* a sine: as far beyond an edge of a rest the boundary tells */

/* The rest that a direction pierces first, and where: 1 / distance along it. */
static uint8_t smap_pierced(const smap_many_pose_t *o, const float g[3], float *rate)
{
  const uint8_t rests = o->at.rests;
  uint8_t i, best = SMAP_NONE;
  *rate = 0.0f;
  for (i = 0; i < rests; i++) {
    const float v = smap_dot(o->plane[i], g);
    if (v > *rate) {
      *rate = v;
      best = i;
    }
  }
  return best;
}

/* How far inside (sine) the edges of a rest a direction is, and which of them is nearest. */
static float smap_inside(const smap_many_pose_t *o, uint8_t rest, const float g[3], uint8_t *which)
{
  const uint8_t end = o->at.edge[rest + 1];
  float least = 1.0f;
  uint8_t e;
  *which = o->at.edge[rest];
  for (e = *which; e < end; e++) {
    const float in = smap_dot(o->wall[e], g);
    if (!(in >= least)) {
      least = in;
      *which = e;
    }
  }
  return least;
}

/* Whether a direction that is in no rest is in a gap. */
static int smap_is_in_gap(const smap_many_pose_t *o, const float g[3])
{
  const uint8_t gaps = SMAP_MANY_GAPS ? o->at.gaps : 0;
  uint8_t k;
  for (k = 0; k < gaps; k++) {
    const float(*const side)[3] = o->wall + SMAP_MANY_CORNERS + 2 * k;
    if (smap_dot(o->wall[o->at.gap[k].a], g) <= 0.0f && smap_dot(o->wall[o->at.gap[k].b], g) <= 0.0f &&
        smap_dot(side[0], g) >= 0.0f && smap_dot(side[1], g) >= 0.0f) {
      return 1;
    }
  }
  return 0;
}

/* The distance (sine) of a direction from the boundary, 1 where that is further than a right angle, and from which wall
 * of it. */
static float smap_nearest(const smap_many_pose_t *o, const float g[3], uint8_t *which)
{
  const uint8_t arcs = o->at.arcs;
  float least = 1.0f;
  uint8_t k;
  for (k = 0; k < arcs; k++) {
    const float *const m = o->amid[k], *const t = o->along[k];
    float away = smap_dot(o->wall[o->at.arc[k]], g), aside, ahead;
    away *= away;
    if (!(away < least)) {
      continue;
    }
    aside = smap_absolute(smap_dot(t, g));
    ahead = smap_dot(m, g);
    if (ahead < 0.0f && ahead * smap_dot(t, t) + aside * smap_dot(m, m) < 0.0f) {
      continue; /* even the nearer end is behind */
    }
    away += aside > ahead ? (aside - ahead) * (aside - ahead) : 0.0f;
    if (away < least) {
      least = away;
      *which = o->at.arc[k];
    }
  }
  return smap_root(least);
}

/* The angle of a sine of at least the guard, less the guard as an angle. */
static inline float smap_less(float sine, float guard)
{
  const float angle = smap_asin(sine - SMAP_SINE) - guard * (1.0f + 0.2f * guard * guard);
  return angle > 0.0f ? angle : 0.0f;
}

static smap_status_t smap_many_at(const smap_many_pose_t *o, const float gravity[3], smap_reading_t *out)
{
  const float size = 1.0f / smap_root(smap_dot(gravity, gravity));
  const float g[3] = {gravity[0] * size, gravity[1] * size, gravity[2] * size};
  float rate, tip, d[3];
  uint8_t i, best, which;
  smap_status_t status;
  out->sdg = out->height = SMAP_NAN;
  out->tip_angle = -3.1415927f;
  out->over[0] = out->over[1] = SMAP_NONE;
  best = smap_pierced(o, g, &rate);
  if (!o->at.alive || best == SMAP_NONE) {
    return SMAP_TIPS;
  }
  tip = smap_inside(o, best, g, &which);
  for (i = 0; !(tip >= -SMAP_EDGE) && i < o->at.rests; i++) { /* planes that are all but one may be in any order */
    uint8_t near;
    const float in = smap_inside(o, i, g, &near);
    if (in >= 0.0f) {
      tip = in;
      best = i;
      which = near;
      rate = smap_dot(o->plane[i], g);
    }
  }
  status = tip >= o->guard                                  ? SMAP_OK
           : tip >= -SMAP_EDGE || smap_is_in_gap(o, g) ? SMAP_ROCKS
                                                            : SMAP_TIPS;
  if (o->at.rests > 1 && !(tip >= 0.0f && o->at.alone[best])) {
    tip = smap_nearest(o, g, &which);
    tip = status == SMAP_TIPS ? -tip : tip;
  }
  if (tip < 1.0f) {
    out->over[0] = o->at.over[which][0];
    out->over[1] = o->at.over[which][1];
  }
  if (status == SMAP_TIPS || !(tip >= o->guard)) {
    tip -= o->guard;
    out->tip_angle = tip > -1.0f ? smap_asin(tip) : -3.1415927f;
    return SMAP_TIPS;
  }
  out->tip_angle = o->at.arcs ? smap_less(tip, o->guard) : 3.1415925f;
  out->height = o->height[best];
  rate = 1.0f / rate;
  SMAP_THRICE
  for (i = 0; i < 3; i++) {
    d[i] = rate * g[i] - o->centre[best][i];
  }
  out->sdg = smap_root(smap_dot(d, d));
  return status;
}

/* ---- reading many contacts without float ------------------------------------------------------------- */
/* One direction of gravity against a pose, without float: raw counts of an accelerometer.
 *
 * Walls, planes and arcs are int16, 32767 for 1; products with gravity are summed in int32, which
 * they never leave, since both are at most 32768 sqrt(3) and 32767 long.
 */
#define SMAP_MANY_AT_I 1
#define SMAP_ONE_I 32767
#define SMAP_ROUNDED_I 1.6e-4f /* sine that rounding may alter: of walls, and to a step of 1 / 16384 twice */

typedef struct {
  uint8_t shift;     /* of D: see smap_many_make_i */
  uint16_t mantissa; /* of D */
  int16_t guard;
  uint16_t height[SMAP_MANY_RESTS];
  int16_t plane[SMAP_MANY_RESTS][3];
  int16_t centre[SMAP_MANY_RESTS][3]; /* in two steps of sdg */
  int16_t wall[SMAP_WALLS][3];
  int16_t amid[SMAP_MANY_ARCS][3], along[SMAP_MANY_ARCS][3];
} smap_many_pose_i_t;

/* The nearest whole number of what is less than 2^22: the last digits of a sum whose last is worth 1. */
static inline int16_t smap_whole_i(float x)
{
  return (int16_t)(int32_t)(smap_bits(x + 12582912.0f) - 0x4B400000u);
}

/* The same of what may be beyond int16: that becomes the last one. */
static void smap_scale_i(const float from[3], float scale, int16_t to[3])
{
  uint8_t k;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    const float x = from[k] * scale;
    to[k] = smap_whole_i(x < 32767.0f ? x > -32767.0f ? x : -32767.0f : 32767.0f);
  }
}

/* The same of vectors of which no component is beyond 1 / scale, times 32767. */
static inline void smap_units_i(const float (*from)[3], uint8_t n, float scale, int16_t (*to)[3])
{
  uint8_t i, k;
  for (i = 0; i < n; i++) {
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      to[i][k] = smap_whole_i(from[i][k] * scale);
    }
  }
}

/* The same from 0 to `most`, which is at most 65535. */
static inline uint16_t smap_steps_i(float x, float most)
{
  return (uint16_t)smap_whole_i(x < most ? x : most);
}

/* Make the integer form of a pose. */
static void smap_many_make_i(const smap_many_pose_t *o, float sdg_step, float height_step,
                             smap_many_pose_i_t *i)
{
  float least = 0.0f, factor;
  uint8_t k;
  if (!o->at.alive || !o->at.rests) {
    return;
  }
  for (k = 0; k < o->at.rests; k++) {
    least = k == 0 || o->height[k] < least ? o->height[k] : least;
    i->height[k] = smap_steps_i(o->height[k] / height_step, 65534.0f);
  }
  for (k = 0; k < o->at.rests; k++) {
    smap_scale_i(o->centre[k], 0.5f / sdg_step, i->centre[k]);
  }
  smap_units_i(o->plane, o->at.rests, (float)SMAP_ONE_I * least, i->plane); /* n / h: the greatest is 1 */
  smap_units_i(o->wall, o->at.edge[o->at.rests], (float)SMAP_ONE_I, i->wall);
  smap_units_i(o->wall + SMAP_MANY_CORNERS, (uint8_t)(2u * o->at.gaps), (float)SMAP_ONE_I, i->wall + SMAP_MANY_CORNERS);
  smap_units_i(o->amid, o->at.arcs, (float)SMAP_ONE_I, i->amid);
  smap_units_i(o->along, o->at.arcs, (float)SMAP_ONE_I, i->along);
  /* D = g 32767 least / (2 sdg_step) / (plane . g) = g (mantissa 2^16 / (plane . g >> shift)) / 2^15 */
  factor = (float)SMAP_ONE_I * least * 0.5f / sdg_step;
  k = (uint8_t)(smap_bits(factor) >> 23);
  i->shift = (uint8_t)(k > 143 && k < 173 ? k - 143 : 0); /* so that it is less than 2^17 */
  factor = smap_from_bits(smap_bits(factor) - ((uint32_t)i->shift << 23)) * 0.5f;
  i->mantissa = smap_steps_i(factor, 65535.0f);
  i->guard = (int16_t)((o->guard + SMAP_ROUNDED_I) * (float)SMAP_ONE_I + 1.0f);
}

static inline int32_t smap_dot_i(const int16_t a[3], const int32_t b[3])
{
  /* Summed without sign: only walls of a damaged map can be too long, and they may wrap. */
  return (int32_t)((uint32_t)(a[0] * b[0]) + (uint32_t)(a[1] * b[1]) + (uint32_t)(a[2] * b[2]));
}

static inline int32_t smap_square_i(const int16_t a[3])
{
  const int32_t b[3] = {a[0], a[1], a[2]};
  return smap_dot_i(a, b);
}

/* As smap_inside; 32767 |g| times the sine. */
static int32_t smap_inside_i(const smap_layout_t *at, const smap_many_pose_i_t *o, uint8_t rest, const int32_t g[3],
                             int32_t least, uint8_t *which)
{
  const uint8_t end = at->edge[rest + 1];
  const int32_t h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  uint8_t e;
  *which = at->edge[rest];
  for (e = *which; e < end; e++) {
    const int32_t in = smap_dot_i(o->wall[e], h);
    if (in < least) {
      least = in;
      *which = e;
    }
  }
  return least;
}

/* As smap_is_in_gap. */
static int smap_is_in_gap_i(const smap_layout_t *at, const smap_many_pose_i_t *o, const int32_t g[3])
{
  const uint8_t gaps = SMAP_MANY_GAPS ? at->gaps : 0;
  uint8_t k;
  for (k = 0; k < gaps; k++) {
    const int16_t(*const side)[3] = o->wall + SMAP_MANY_CORNERS + 2 * k;
    if (smap_dot_i(o->wall[at->gap[k].a], g) <= 0 && smap_dot_i(o->wall[at->gap[k].b], g) <= 0 &&
        smap_dot_i(side[0], g) >= 0 && smap_dot_i(side[1], g) >= 0) {
      return 1;
    }
  }
  return 0;
}

/* As smap_nearest; |g| times the sine, rounded down.  In doubt about an arc that is so short that it has no digits
 * that what stands is nearer, and what tips further. */
static int32_t smap_nearest_i(const smap_layout_t *at, const smap_many_pose_i_t *o, const int32_t g[3], uint32_t length,
                              int stands, uint8_t *which)
{
  const int32_t doubt = stands ? -4 : 4;
  const uint8_t arcs = at->arcs;
  const int32_t h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  uint32_t least = (length - 1u) * (length - 1u);
  uint8_t k;
  for (k = 0; k < arcs; k++) {
    const int16_t *const m = o->amid[k], *const t = o->along[k];
    const int32_t away = smap_dot_i(o->wall[at->arc[k]], h) >> 15;
    uint32_t square = (uint32_t)away * (uint32_t)away;
    int32_t aside, ahead;
    if (square >= least) {
      continue;
    }
    aside = smap_dot_i(t, h) >> 15;
    aside = aside < 0 ? -aside : aside;
    ahead = smap_dot_i(m, h) >> 15;
    if (ahead < doubt && ahead * (smap_square_i(t) >> 15) + aside * (smap_square_i(m) >> 15) < doubt * SMAP_ONE_I) {
      continue;
    }
    square += aside > ahead ? (uint32_t)(aside - ahead) * (uint32_t)(aside - ahead) : 0u;
    if (square < least) {
      least = square;
      *which = at->arc[k];
    }
  }
  return (int32_t)smap_whole_root(least);
}

/* |D - s| in steps.  A contact is at most 32767 two-steps away and the longest of g is 16384 or more, so the
 * factor is at most 2^16 for 2. */
SMAP_APART static uint16_t smap_sdg_i(const smap_many_pose_i_t *o, uint8_t f, const int32_t g[3], int32_t rate)
{
  const uint8_t shift = o->shift;
  const uint32_t deep = (uint32_t)rate >> shift, factor = deep ? ((uint32_t)o->mantissa << 16) / deep : 65536u;
  uint32_t sum = 0;
  uint8_t k;
  if (SMAP_RARELY(factor > 65535u)) {
    return 65534;
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    const int32_t d = (g[k] * (int32_t)factor >> 15) - o->centre[f][k];
    if (SMAP_RARELY(d > 32767 || d < -32767)) {
      return 65534;
    }
    sum += (uint32_t)(d * d);
  }
  sum = 2u * smap_whole_root(sum);
  return (uint16_t)(sum < 65534u ? sum : 65534u);
}

/* Read a pose under a direction whose longest component is 16384 to 32768; `length` is that of it,
 * rounded up. */
static smap_status_t smap_many_at_i(const smap_layout_t *at, const smap_many_pose_i_t *o,
                                    const int32_t g[3], uint32_t length, smap_reading_i_t *out)
{
  const int32_t size = (int32_t)length, all = SMAP_ONE_I * (size - 1), edge = -2 * size;
  const uint8_t rests = at->alive ? at->rests : 0;
  const int32_t h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  int32_t rate = 0, tip;
  uint8_t i, best = SMAP_NONE, which;
  smap_status_t status;
  out->sdg = out->height = 65535u;
  out->tip = -SMAP_ONE_I;
  out->over[0] = out->over[1] = SMAP_NONE;
  SMAP_THRICE
  for (i = 0; i < rests; i++) {
    const int32_t v = smap_dot_i(o->plane[i], h);
    if (v > rate) {
      rate = v;
      best = i;
    }
  }
  if (best == SMAP_NONE) {
    return SMAP_TIPS;
  }
  tip = smap_inside_i(at, o, best, h, all, &which);
  for (i = 0; tip < edge && i < rests; i++) {
    uint8_t near;
    const int32_t in = smap_inside_i(at, o, i, h, all, &near);
    if (in >= 0) {
      tip = in;
      best = i;
      which = near;
      rate = smap_dot_i(o->plane[i], h);
    }
  }
  status = tip >= o->guard * size                    ? SMAP_OK
           : tip >= edge || smap_is_in_gap_i(at, o, h) ? SMAP_ROCKS
                                                       : SMAP_TIPS;
  if (rests > 1 && !(tip >= 0 && at->alone[best])) {
    tip = smap_nearest_i(at, o, h, length, status != SMAP_TIPS, &which);
    tip = (status == SMAP_TIPS ? -tip - 1 : tip) * SMAP_ONE_I;
  }
  if (tip < all) {
    out->over[0] = at->over[which][0];
    out->over[1] = at->over[which][1];
  }
  tip = (tip < 0 ? tip / (size - 1) : tip / (size + 1)) - o->guard;
  if (tip < 0 || status == SMAP_TIPS) {
    tip = tip < 0 ? tip : -1;
    out->tip = (int16_t)(tip > -SMAP_ONE_I ? tip : -SMAP_ONE_I);
    return SMAP_TIPS;
  }
  out->tip = (int16_t)tip;
  out->height = o->height[best];
  out->sdg = smap_sdg_i(o, best, g, rate);
  return status;
}

/* ---- entries: robots on many contacts -----------------------------------------------------------
 * What the map adds to positions: nine singles (the level axis of all discs, size, steepest, least height,
 * rest width, tolerance, rock chord, guard: see smap_many_t), rails u8, the first contact of each rail and
 * behind the last u8, the recipe's number of each contact u8, the room of a pose (see smap_room_t) u8[6]; with
 * SMAP_BY_SERIES two singles more, off and turned. */
enum { SMAP_MANY_SINGLES = 36, SMAP_MANY_ROOM = 6 };

typedef struct {
  smap_pose_t head;
  smap_many_pose_t real;
  union { /* the work is done when the integer form is made */
    smap_many_work_t work;
    smap_many_pose_i_t whole;
  } rest;
} smap_pose_memory_t;

typedef struct {
  smap_pose_t head;
  smap_layout_t at;
  smap_many_pose_i_t whole;
} smap_pose_memory_i_t;

SMAP_INLINE smap_bytes_t smap_many_body(const smap_t *map)
{
  return smap_body(map) + SMAP_IN_MANY;
}

/* The room that a map tells. */
SMAP_INLINE smap_room_t smap_room_in(smap_bytes_t at)
{
  smap_room_t room;
  room.facets = at[0];
  room.edges = at[1];
  room.rests = at[2];
  room.corners = at[3];
  room.gaps = at[4];
  room.arcs = at[5];
  return room;
}

SMAP_INLINE void smap_many_numbers(const smap_t *map, smap_many_t *out)
{
  smap_bytes_t body = smap_many_body(map);
  uint8_t i;
  out->contacts = SMAP_BLOB(map)[SMAP_AT_CONTACTS];
  out->rails = body[SMAP_MANY_SINGLES];
  for (i = 0; i <= out->rails; i++) {
    out->first[i] = body[SMAP_MANY_SINGLES + 1 + i];
  }
  for (i = 0; i < out->contacts; i++) {
    out->named[i] = body[SMAP_MANY_SINGLES + 2 + out->rails + i];
  }
  out->axis[0] = smap_f32(body);
  out->axis[1] = smap_f32(body + 4);
  out->size = smap_f32(body + 8);
  out->steepest = smap_f32(body + 12);
  out->least_height = smap_f32(body + 16);
  out->rest_width = smap_f32(body + 20);
  out->tolerance = smap_f32(body + 24);
  out->rock_chord = smap_f32(body + 28);
  out->guard = smap_f32(body + 32);
#if SMAP_SERIES || defined(SMAP_CONTROL)
  out->off = out->turned = 0.0f;
#endif
#if SMAP_SERIES || !SMAP_MANY_KNOWN
  body += SMAP_MANY_SINGLES + 2 + out->rails + out->contacts;
#endif
#if !SMAP_MANY_KNOWN
  out->room = smap_room_in(body);
#endif
#if SMAP_SERIES
  body += SMAP_MANY_ROOM;
  if (smap_body(map)[SMAP_IN_FLAGS] & SMAP_BY_SERIES) {
    out->off = smap_f32(body);
    out->turned = smap_f32(body + 4);
  }
#endif
}

/* The radius of a contact. */
SMAP_INLINE float smap_radius(const smap_t *map, const smap_places_t *at, uint8_t contact)
{
  const uint8_t flags = smap_body(map)[SMAP_IN_FLAGS];
  if (!(flags & SMAP_ROUND)) {
    return 0.0f;
  }
  return smap_f32(flags & SMAP_SHARED ? at->weights + 4 * at->radii[contact] : at->radii + 4 * contact);
}

/* Put the contacts where checked parameters have them. */
SMAP_APART static int8_t smap_many_place(const smap_t *map, const float *params, smap_many_work_t *work)
{
  float q[SMAP_MAX_PARAMS], p[SMAP_MAX_COORDINATES];
  const int8_t status = smap_range(map, params, q);
  smap_places_t at;
  uint8_t i;
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  at = smap_places(map);
  smap_positions(map, q, p);
  for (i = 0; i < at.contacts; i++) {
    memcpy(work->p[i], &p[3 * i], sizeof work->p[i]);
    work->r[i] = smap_radius(map, &at, i);
#if SMAP_MANY_AXLES
    memset(work->axle[i], 0, sizeof work->axle[i]);
    if (smap_body(map)[SMAP_IN_AXES] != 0 && at.axis_of[i] != SMAP_NO_AXIS) {
      memcpy(work->axle[i], &p[3 * (at.contacts + at.axis_of[i])], sizeof work->axle[i]);
    }
#endif
  }
  return SMAP_OK;
}

/* Make the pose of checked parameters. */
static int8_t smap_many_of(const smap_t *map, const float *params, smap_many_pose_t *pose,
                           smap_many_work_t *work)
{
  smap_many_t numbers;
  int8_t status;
#if SMAP_MANY_AXLES
  float axle[SMAP_MANY_CONTACTS][3];
  work->axle = axle;
#endif
  status = smap_many_place(map, params, work);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  smap_many_numbers(map, &numbers);
  status = smap_many_pose(&numbers, pose, work) ? SMAP_OK : SMAP_TIPS;
  work->map = 0;
#if SMAP_MANY_AXLES
  work->axle = 0;
#endif
  return status;
}

/* Read a pose under a scaled direction. */
static int8_t smap_many_read(const smap_t *map, const smap_many_pose_t *pose, const float d[3],
                             smap_reading_t *out)
{
  const int8_t status = (int8_t)smap_many_at(pose, d, out);
  if (status != SMAP_OK && status != SMAP_ROCKS) {
    const float tip = out->tip_angle;
    out->tip_angle = tip < 0.0f ? tip : -SMAP_PI;
  }
  return smap_judge(map, out, status);
}

static int8_t smap_run_read(const smap_t *map, const float *params, const float *gravity,
                            smap_reading_t *out)
{
  smap_many_pose_t pose;
  smap_many_work_t work;
  float d[3];
  int8_t status = smap_many_of(map, params, &pose, &work);
  if (status == SMAP_OK) {
    status = smap_direction(map, gravity, d);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  return smap_many_read(map, &pose, d, out);
}

static int8_t smap_run_at(const smap_pose_t *pose, const float *gravity, smap_reading_t *out)
{
  const smap_pose_memory_t *const many = (const smap_pose_memory_t *)pose;
  float d[3];
  int8_t status = many->head.forms & SMAP_FLOAT ? many->head.status : (int8_t)SMAP_INVALID;
  if (status == SMAP_OK) {
    status = smap_direction(many->head.map, gravity, d);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  return smap_many_read(many->head.map, &many->real, d, out);
}

static int8_t smap_run_at_i(const smap_pose_t *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  const smap_pose_memory_t *const both = (const smap_pose_memory_t *)pose;
  const smap_pose_memory_i_t *const alone = (const smap_pose_memory_i_t *)pose;
  const int whole = (pose->forms & SMAP_FLOAT) == 0;
  const uint8_t channels = SMAP_BLOB(pose->map)[SMAP_AT_CHANNELS];
  int32_t g[3];
  uint32_t length;
  int8_t status = pose->forms & SMAP_INTEGER ? pose->status : (int8_t)SMAP_INVALID;
  if (status == SMAP_OK) {
    status = smap_direction_i(pose->map, gravity, g, &length);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny_i(out, status);
  }
  status = (int8_t)smap_many_at_i(whole ? &alone->at : &both->real.at,
                                  whole ? &alone->whole : &both->rest.whole, g, length, out);
  if (status != SMAP_OK && status != SMAP_ROCKS) {
    out->tip = out->tip < 0 ? out->tip : (int16_t)-1;
  }
  if (out->tip < 0 || !(channels & SMAP_SDG)) {
    out->sdg = 65535;
  }
  if (out->tip < 0 || !(channels & SMAP_HEIGHT)) {
    out->height = 65535;
  }
  return out->tip < 0 ? (int8_t)SMAP_TIPS : status;
}

/* Make a pose with floats; the work on it is done in its own memory. */
static int8_t smap_pose_floats(const smap_t *map, const float *params, smap_pose_memory_t *pose, uint16_t bytes,
                               uint8_t forms)
{
  if (!smap_begin(map, &pose->head, bytes, forms, SMAP_FLOAT | SMAP_INTEGER, sizeof *pose)) {
    return SMAP_INVALID;
  }
  pose->head.status = smap_many_of(map, params, &pose->real, &pose->rest.work);
  return pose->head.status;
}

/* Make one of integers alone, with all work on the stack: apart, so that one with floats needs none of that. */
SMAP_APART static int8_t smap_pose_whole(const smap_t *map, const float *params, smap_pose_memory_i_t *pose,
                                         uint16_t bytes, uint8_t forms)
{
  smap_many_pose_t real;
  smap_many_work_t work;
  if (!smap_begin(map, &pose->head, bytes, forms, SMAP_FLOAT | SMAP_INTEGER, sizeof *pose)) {
    return SMAP_INVALID;
  }
  pose->head.status = smap_many_of(map, params, &real, &work);
  if (pose->head.status == SMAP_OK) {
    const float step = smap_f32(SMAP_BLOB(map) + SMAP_AT_STEP);
    pose->at = real.at;
    smap_many_make_i(&real, step, step, &pose->whole);
  }
  return pose->head.status;
}

static int8_t smap_run_pose(const smap_t *map, const float *params, smap_pose_t *pose, uint16_t bytes,
                            uint8_t forms)
{
  smap_pose_memory_t *const many = (smap_pose_memory_t *)pose;
  int8_t status;
  if (!(forms & SMAP_FLOAT)) {
    return smap_pose_whole(map, params, (smap_pose_memory_i_t *)pose, bytes, forms);
  }
  status = smap_pose_floats(map, params, many, bytes, forms);
  if ((forms & SMAP_INTEGER) && status == SMAP_OK) {
    const float step = smap_f32(SMAP_BLOB(map) + SMAP_AT_STEP);
    smap_many_make_i(&many->real, step, step, &many->rest.whole);
  }
  return status;
}

/* Whether a map's room is that of an export, or of any robot not beyond what there is. */
static int smap_is_room(uint32_t found, uint32_t most)
{
  return SMAP_MANY_KNOWN ? found == most : found <= most;
}

static int smap_check_room(const smap_room_t *room)
{
  return smap_is_room(room->facets, SMAP_MANY_FACETS) && smap_is_room(room->edges, SMAP_MANY_EDGES) &&
         smap_is_room(room->rests, SMAP_MANY_RESTS) && smap_is_room(room->corners, SMAP_MANY_CORNERS) &&
         smap_is_room(room->gaps, SMAP_MANY_GAPS) && smap_is_room(room->arcs, SMAP_MANY_ARCS);
}

/* Numbers that no loop or index may be led astray by. */
static int smap_check_many(const smap_t *map)
{
  const smap_bytes_t body = smap_many_body(map);
  const uint16_t bytes = smap_u16(smap_body(map) + SMAP_IN_MANY_BYTES);
  const uint8_t contacts = SMAP_BLOB(map)[SMAP_AT_CONTACTS];
  const uint8_t rails = bytes > SMAP_MANY_SINGLES ? body[SMAP_MANY_SINGLES] : SMAP_NONE;
  const smap_bytes_t first = body + SMAP_MANY_SINGLES + 1;
  smap_bytes_t after;
  smap_room_t room;
  uint16_t more = SMAP_MANY_ROOM;
  uint8_t i;
#if SMAP_SERIES
  if (smap_body(map)[SMAP_IN_FLAGS] & SMAP_BY_SERIES) {
    more = SMAP_MANY_ROOM + 8;
  }
#endif
  if (contacts > SMAP_MANY_CONTACTS || contacts < 3 || rails > SMAP_MANY_RAILS ||
      (SMAP_MANY_KNOWN && (contacts != SMAP_MANY_CONTACTS || rails != SMAP_MANY_RAILS)) ||
      (rails == 0) != (SMAP_MANY_RAILS == 0) ||
      bytes != SMAP_MANY_SINGLES + 2u + rails + contacts + more ||
      first[0] != 0 || (rails != 0 && first[rails] != contacts)) {
    return 0;
  }
  for (i = 0; i < rails; i++) {
    if (first[i] >= first[i + 1]) {
      return 0;
    }
  }
  for (i = 0; i < SMAP_MANY_SINGLES; i = (uint8_t)(i + 4)) {
    if (!smap_is_within(smap_f32(body + i), 1e6f)) {
      return 0;
    }
  }
  after = body + SMAP_MANY_SINGLES + 2 + rails + contacts;
  room = smap_room_in(after);
#if SMAP_SERIES
  if (more > SMAP_MANY_ROOM && !(smap_is_within(smap_f32(after + SMAP_MANY_ROOM), 1e6f) &&
                                 smap_is_within(smap_f32(after + SMAP_MANY_ROOM + 4), 1e6f))) {
    return 0;
  }
#endif
  return smap_check_room(&room) && smap_is_within(smap_f32(body), 1.001f) &&
         smap_is_within(smap_f32(body + 4), 1.001f) && smap_is_positive(smap_f32(body + 8)) &&
         smap_is_within(smap_f32(body + 32), 0.5f);
}

static int8_t smap_run_pose_q(const smap_t *map, const int16_t *params_q, smap_pose_t *pose, uint16_t bytes,
                              uint8_t forms)
{
  float params[SMAP_MAX_PARAMS];
  smap_from_steps(map, params_q, params);
  return smap_run_pose(map, params, pose, bytes, forms);
}

static int8_t smap_run_read_i(const smap_t *map, const int16_t *params_q, const int16_t *gravity_q,
                              smap_reading_i_t *out)
{
  smap_pose_memory_i_t pose;
  const int8_t status = smap_run_pose_q(map, params_q, &pose.head, sizeof pose, SMAP_INTEGER);
  return status != SMAP_OK ? smap_deny_i(out, status) : smap_run_at_i(&pose.head, gravity_q, out);
}

static int8_t smap_run_check(const smap_t *map)
{
  return smap_check_head(map, SMAP_CODEC_RAILS) && smap_check_axes(map) &&
                 smap_check_positions(map, SMAP_BLOB(map) + map->size) && smap_check_many(map)
             ? SMAP_OK
             : SMAP_CORRUPT;
}

static const smap_runtime_t smap_run = {smap_run_pose, smap_run_pose_q, smap_run_at,   smap_run_at_i,
                                        smap_run_read, smap_run_read_i, smap_run_check};
