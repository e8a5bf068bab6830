/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- search: robots on many contacts ------------------------------------------------------------------- */
#define SMAP_INLINE SMAP_PLAIN
#define SMAP_UNROLL
#define SMAP_STEERED_BY "smap_control_region.c"
#define SMAP_DRAWN_BY "smap_host_region.h"
#ifndef SMAP_MANY_RAILS
#define SMAP_MANY_RAILS 0
#endif
#include "smap_joints.h"
#include "smap_region.h"

/* ---- planes on any contacts: points, spheres, and discs whose axes are not parallel ------------------- */
#define SMAP_FLAT 1e-6f     /* of a disc that lies flatter, the square of the sine to its axle */
#define SMAP_FACE 0.173658f /* the sine of 10 deg: nearer to a plane's normal a carrying wheel's axle may not be, */
#define SMAP_FLATTEST 1e-2f /* nor than this, whatever `upright` says: its rim touches where rounding likes */

/* Whether a contact is a disc, with an axle, and no point or ball. */
static inline int smap_is_disc(const smap_many_work_t *w, uint8_t i)
{
#if SMAP_MANY_AXLES
  return w->axle[i][1] != 0.0f || w->axle[i][0] != 0.0f || w->axle[i][2] != 0.0f;
#else
  (void)w;
  (void)i;
  return 0;
#endif
}

/* Whether two contacts are points or balls of one size. */
static inline int smap_are_alike(const smap_many_work_t *w, uint8_t i, uint8_t j)
{
  return w->r[i] == w->r[j] && !smap_is_disc(w, i) && !smap_is_disc(w, j);
}

/* The cosine between a disc's axle and a plane's normal. */
static inline float smap_along_axle(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
#if SMAP_MANY_AXLES
  return smap_dot(w->axle[i], at->n);
#else
  (void)w;
  (void)i;
  (void)at;
  return 0.0f;
#endif
}

/* Where a contact touches a plane. */
static void smap_touch(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at, float out[3])
{
  float r = w->r[i];
  uint8_t k;
#if SMAP_MANY_AXLES
  if (smap_is_disc(w, i)) {
    const float along = smap_along_axle(w, i, at), flat = 1.0f - along * along;
    r = r / smap_root(flat > SMAP_FLAT ? flat : SMAP_FLAT);
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      out[k] = w->p[i][k] + r * (at->n[k] - along * w->axle[i][k]);
    }
    return;
  }
#endif
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    out[k] = w->p[i][k] + r * at->n[k];
  }
}

/* The direction of a vector. */
static void smap_aim(smap_aim_t *o, const float v[3])
{
  const float size = 1.0f / smap_root(smap_dot(v, v));
  uint8_t k;
  o->s = o->c = 0.0f;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o->n[k] = v[k] * size;
  }
}

/* The plane on the contacts i and j at a fraction of the way between two others. */
static void smap_on_arc(const smap_many_work_t *w, uint8_t i, uint8_t j, const smap_aim_t *from,
                        const smap_aim_t *to, float part, smap_aim_t *out)
{
  float v[3], p[3], q[3], size, higher;
  uint8_t round, k;
  smap_mix(from->n, to->n, part, v);
  smap_aim(out, v);
  /* Of balls of one size each goes on as far as the other: the first plane is right. */
  for (round = smap_are_alike(w, i, j) ? 2 : 0; round < 2; round++) {
    smap_touch(w, i, out, p);
    smap_touch(w, j, out, q);
    smap_minus(p, q, v);
    higher = smap_dot(v, out->n);
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      v[k] -= higher * out->n[k];
    }
    size = smap_dot(v, v);
    if (!(size > 0.0f)) {
      return;
    }
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      v[k] = out->n[k] - v[k] * (higher / size);
    }
    smap_aim(out, v);
  }
}

/* The directions along and across on a plane. */
static void smap_frame(const smap_aim_t *aim, float along[3], float across[3])
{
  const float *n = aim->n, size = 1.0f / smap_root(n[0] * n[0] + n[2] * n[2]);
  along[0] = -n[2] * size;
  along[1] = 0.0f;
  along[2] = n[0] * size;
  smap_cross(along, n, across);
}

/* Where a contact touches a plane, along and across. */
static void smap_find_spot(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at,
                           const float along[3], const float across[3], smap_spot_t *o)
{
  float p[3];
  smap_touch(w, i, at, p);
  o->a = p[0] * along[0] + p[2] * along[2];
  o->b = smap_dot(p, across);
  o->contact = i;
}

#if SMAP_MANY_AXLES
/* The square of a small sine between two unit vectors, to the last digit. */
SMAP_APART static float smap_small_sine2(const float a[3], const float b[3])
{
  float across[3];
  smap_cross(a, b, across);
  return smap_dot(across, across);
}
#endif

/* The square of the sine between a plane's normal and a disc's axle; 1 of others. */
static inline float smap_sine2_to_axle(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
#if SMAP_MANY_AXLES
  const float along = smap_along_axle(w, i, at), flat = 1.0f - along * along;
  return flat > SMAP_FLAT ? flat : smap_small_sine2(w->axle[i], at->n);
#else
  (void)w;
  (void)i;
  (void)at;
  return 1.0f;
#endif
}

/* Whether a contact is a wheel that lies on its face: nobody stands on that.  Of level axles `upright` says so
 * itself. */
static int smap_is_flat(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
  const float steepest = w->map->steepest > SMAP_FLATTEST ? w->map->steepest : SMAP_FLATTEST;
  const float face = SMAP_FACE + SMAP_OFF_TURNED(w->map), least = steepest < face ? steepest : face;
  return smap_is_disc(w, i) && !(smap_sine2_to_axle(w, i, at) > least * least);
}

/* How far a contact extends along a plane's normal. */
static inline float smap_extent(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
  return smap_dot(w->p[i], at->n) + (smap_is_disc(w, i) ? w->r[i] * smap_root(smap_sine2_to_axle(w, i, at)) : w->r[i]);
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

/* ---- facets of any contacts -------------------------------------------------------------------------- */
/* Facets of any contacts: points, spheres, and discs whose axes are not parallel.
 *
 * Three contacts have a plane below them, in a row two; it is a facet if no other contact is below it.  What
 * touches it within rounding makes up its corners.  An arc joins two facets that share two contacts,
 * where nothing is below the planes between them.  A facet or an arc that is not found makes the
 * region smaller and never larger.
 */
#define SMAP_TOUCHES 3e-6f /* of the size: nearer to a plane a contact touches it */
#define SMAP_NOISY 3e-6f   /* of the size: nearer to a plane a contact is not below it; no more than touches */
#define SMAP_NEWTON 8
#define SMAP_SLIVER 4e-5f  /* rad: less steep, what a contact adds that all but touches is part of the facet */
#define SMAP_BESIDE 2e-3f  /* of the size: as far inside a side a contact may bear before one of its ends does, */
#define SMAP_HARDLY 1e-5f  /* and less than this does not matter */
#define SMAP_AT_END 1e-4f  /* of the size: nearer to an end of a side what bears is part of that end */
#define SMAP_LEAN 1.5f     /* how steeply planes lean from which those on three contacts in a row are looked for */
#define SMAP_STEEP 0.8f /* the cosine of a plane of centres: of a less steep one no contact makes one that faces down */

/* Where the plane below three contacts is looked for: near that of their centres, seen from below or from above, or
 * leaning to either side of the longest way between two of them. */
enum { SMAP_FROM_BELOW = 0, SMAP_FROM_ABOVE = 1, SMAP_FROM_LEFT = 2, SMAP_FROM_RIGHT = 3 };

/* A plane that leans, to one side of the longest of the ways a, b and from a to b: steeply enough for any that faces
 * down. */
static void smap_leaning(const float a[3], const float b[3], uint8_t start, float v[3])
{
  const float *along = smap_dot(a, a) > smap_dot(b, b) ? a : b;
  float c[3], lean;
  smap_minus(b, a, c);
  along = smap_dot(c, c) > smap_dot(along, along) ? c : along;
  lean = smap_root(smap_dot(along, along)) * (start == SMAP_FROM_LEFT ? SMAP_LEAN : -SMAP_LEAN);
  v[0] = along[0] * along[2] + lean * along[1];
  v[1] = along[1] * along[2] - lean * along[0];
  v[2] = -along[0] * along[0] - along[1] * along[1];
}

/* Whether three centres are so nearly on one line that it is their radii that tell how planes on them lean. */
static inline int smap_is_thin(const smap_many_work_t *w, const uint8_t three[3], float apart2, float size2)
{
  const float r = w->r[three[0]], q = w->r[three[1]], s = w->r[three[2]];
  return size2 <= (r * r + q * q + s * s) * apart2;
}

/* The plane below three contacts, from a start on, from above where that is so steep that the plane may face down
 * for all that; 1 where they go round it counter-clockwise, seen from outside, -1 where clockwise, and 0 where there
 * is none.  Of the first start it tells from how many there may be more. */
static int smap_common(smap_many_work_t *w, const uint8_t three[3], uint8_t start, smap_aim_t *at, float *h,
                       uint8_t *starts)
{
  const float least = 1e-6f * w->map->size * w->map->size;
  const int alike = smap_are_alike(w, three[0], three[1]) && smap_are_alike(w, three[0], three[2]);
  float p[3][3], a[3], b[3], v[3], size2, change, before[3] = {0.0f, 0.0f, 0.0f};
  int turns = 1;
  uint8_t round, k;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    smap_copy(w->p[three[k]], p[k]);
  }
  for (round = 0; round < SMAP_NEWTON; round++) {
    smap_minus(p[1], p[0], a);
    smap_minus(p[2], p[0], b);
    if (round == 0 && start >= SMAP_FROM_LEFT) {
      smap_leaning(a, b, start, v);
    } else {
      smap_cross(a, b, v);
    }
    size2 = smap_dot(v, v);
    if (round == 0 && start == SMAP_FROM_BELOW) {
      *starts = alike ? 1 : smap_is_thin(w, three, smap_dot(a, a) + smap_dot(b, b), size2) ? 4 : 2;
    }
    if (!(size2 > least * least)) {
      return 0;
    }
    turns = (round == 0 ? (v[2] > 0.0f) != (start == SMAP_FROM_ABOVE) : smap_dot(v, at->n) < 0.0f) ? -1 : 1;
    if (turns < 0) {
      v[0] = -v[0];
      v[1] = -v[1];
      v[2] = -v[2];
    }
    smap_aim(at, v);
    if (round == 0 && start == SMAP_FROM_ABOVE && at->n[2] > SMAP_STEEP) {
      return 0;
    }
    if (alike) { /* as far above the plane of their centres */
      *h = smap_dot(p[0], at->n) + w->r[three[0]];
      return turns;
    }
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      smap_touch(w, three[k], at, p[k]);
    }
    smap_minus(at->n, before, a);
    smap_copy(at->n, before);
    change = smap_dot(a, a);
    *h = smap_dot(p[0], at->n);
    if (round > 0 && change < 1e-9f) {
      return turns;
    }
  }
  return 0;
}

/* Leave out the corners that all but touch a facet's plane where what they add is a facet of its own, over
 * whose arc the robot rolls first: of round contacts that may be a thousandth of the size. */
SMAP_APART static uint8_t smap_cut_slivers(const smap_many_work_t *w, const smap_aim_t *at, uint8_t *contact,
                                uint8_t corners)
{
  uint8_t k, kept = 0;
  for (k = 0; k < corners; k++) {
    const uint8_t before = contact[kept > 0 ? kept - 1u : corners - 1u], c = contact[k];
    const uint8_t after = contact[k + 1u < corners ? k + 1u : 0];
    float p[3], d[3], along[3], out[3], size2, width, part, under;
    smap_touch(w, before, at, p);
    smap_touch(w, after, at, along);
    smap_touch(w, c, at, d);
    smap_minus(along, p, along);
    smap_minus(d, p, d);
    smap_cross(along, at->n, out);
    size2 = smap_dot(along, along);
    part = smap_dot(along, d) / size2;
    width = smap_dot(out, d) / smap_root(size2);
    under = (1.0f - part) * smap_extent(w, before, at) + part * smap_extent(w, after, at) - smap_extent(w, c, at);
    if (!(width > SMAP_SLIVER * w->map->size) || under <= SMAP_SLIVER * width) {
      contact[kept++] = c;
    }
  }
  return kept;
}

static inline float smap_apart2(const smap_spot_t *p, const smap_spot_t *q)
{
  return (q->a - p->a) * (q->a - p->a) + (q->b - p->b) * (q->b - p->b);
}

/* Whether a spot lies inside a side of a polygon, and next to it. */
static int smap_is_beside(const smap_many_work_t *w, const smap_spot_t *a, const smap_spot_t *b, const smap_spot_t *o)
{
  const float bend = smap_bend_of(a, b, o), size2 = smap_apart2(a, b), part = size2 * w->map->size * w->map->size;
  const float ahead = (o->a - a->a) * (b->a - a->a) + (o->b - a->b) * (b->b - a->b);
  const float end = ahead < size2 - ahead ? ahead : size2 - ahead;
  return end > 0.0f && end * end > SMAP_AT_END * SMAP_AT_END * part && bend > 0.0f &&
         bend * bend < SMAP_BESIDE * SMAP_BESIDE * part &&
         bend * bend > SMAP_HARDLY * SMAP_HARDLY * part;
}

/* The side of a polygon that a spot lies just inside of, or one beyond the last. */
static uint8_t smap_side_beside(const smap_many_work_t *w, const smap_spot_t *spot, const smap_spot_t *o,
                                const uint8_t *corner, uint8_t corners)
{
  uint8_t at;
  for (at = 0; at < corners; at++) {
    if (smap_is_beside(w, &spot[corner[at]], &spot[corner[at + 1u < corners ? at + 1u : 0]], o)) {
      break;
    }
  }
  return at;
}

/* Make corners of all spots that lie just inside a side: while a wheel rolls it rises less than a ball, and of what
 * is alike rounding decides which touches, so that the robot may never stand on the whole side, but on one part of it
 * and then on the other. */
static uint8_t smap_indent_sides(const smap_many_work_t *w, const smap_spot_t *spot, uint8_t count, uint8_t *corner,
                                 uint8_t corners)
{
  uint8_t taken[SMAP_MANY_CONTACTS] = {0}, k, at, last;
  for (k = 0; k < corners; k++) {
    taken[corner[k]] = 1;
  }
  for (k = 0; k < count; k++) {
    at = taken[k] ? corners : smap_side_beside(w, spot, &spot[k], corner, corners);
    if (at < corners) {
      for (last = corners++; last > at + 1u; last--) {
        corner[last] = corner[last - 1u];
      }
      corner[last] = k;
    }
  }
  return corners;
}

/* The contacts at the corners of those that reach as far as `top`, counter-clockwise. */
static uint8_t smap_corners_near(smap_many_work_t *w, const smap_aim_t *at, float top,
                                            uint8_t *contact)
{
  smap_spot_t spot[SMAP_MANY_CONTACTS];
  uint8_t corner[2 * SMAP_MANY_CONTACTS + 1] = {0}, k;
  const uint8_t count = smap_list_near(w, at, top, 4.0f * w->map->size, corner);
  uint8_t n;
  smap_find_spots(w, at, corner, count, spot);
  n = smap_indent_sides(w, spot, count, corner, smap_polygon(spot, count, corner));
  for (k = 0; k < n; k++) {
    /* From outside (a, b) is left-handed. */
    contact[k] = spot[corner[n - 1u - k]].contact;
  }
  return smap_cut_slivers(w, at, contact, n);
}

/* One beyond the last edge of a facet. */
static inline uint8_t smap_last_of(const smap_many_work_t *w, uint8_t facet)
{
  return facet + 1u < w->facets ? w->facet[facet + 1].first : w->edges;
}

/* The facet that a plane has already, but for rounding, or SMAP_NONE: it has three of some contacts; and how many of
 * them.  Of a robot that stands nearly level two facets may be as good as parallel. */
static uint8_t smap_known(const smap_many_work_t *w, const smap_aim_t *at, const uint8_t *contact, uint8_t corners,
                          uint8_t *common)
{
  uint8_t marked[SMAP_MANY_CONTACTS] = {0}, f, k, e;
  float d[3];
  for (k = 0; k < corners; k++) {
    marked[contact[k]] = 1;
  }
  for (f = 0; f < w->facets; f++) {
    *common = 0;
    smap_minus(w->facet[f].at.n, at->n, d);
    if (smap_dot(d, d) >= 1e-8f) {
      continue;
    }
    for (e = w->facet[f].first; e < smap_last_of(w, f); e++) {
      *common = (uint8_t)(*common + marked[w->vertex[e]]);
    }
    if (*common > 2) {
      return f;
    }
  }
  return SMAP_NONE;
}

/* Take a facet out again; returns how far along a plane's normal all of its contacts reach, if not as far as `top`. */
static float smap_take_out(smap_many_work_t *w, uint8_t f, const smap_aim_t *at, float top)
{
  const uint8_t first = w->facet[f].first, corners = (uint8_t)(smap_last_of(w, f) - first);
  uint8_t e, k, to = 0;
  for (e = 0; e < w->edges; e++) {
    if (w->owner[e] == f) {
      const float reach = smap_extent(w, w->vertex[e], at);
      top = reach < top ? reach : top;
      continue;
    }
    w->vertex[to] = w->vertex[e];
    w->owner[to] = (uint8_t)(w->owner[e] - (e > first ? 1u : 0));
    w->next[to] = (uint8_t)(w->next[e] - (e - to));
    smap_copy(w->corner[e], w->corner[to++]);
  }
  w->edges = to;
  to = 0;
  for (k = 0; k < w->facets; k++) {
    if (w->facet[k].first != first) { /* the compiler shall not make it a call of memmove */
      w->facet[to] = w->facet[k];
      w->facet[to++].first = (uint8_t)(w->facet[k].first - (k > f ? corners : 0));
    }
  }
  w->facets = to;
  return top;
}

/* The corners of all that reaches as far as `top` along a plane's normal, or 0 where a facet has them already; and
 * which facet has three of them but not all, or SMAP_NONE. */
SMAP_APART static uint8_t smap_corners_new(smap_many_work_t *w, const smap_aim_t *at, float top, uint8_t *contact,
                                           uint8_t *known)
{
  const uint8_t corners = smap_corners_near(w, at, top, contact);
  uint8_t common;
  *known = smap_known(w, at, contact, corners, &common);
  return *known != SMAP_NONE && common == corners ? 0 : corners;
}

/* The same of all that touches a plane.  In noise a contact touches one plane and not the next: a facet that has three
 * of them but not all gives way to one of its own and these. */
static uint8_t smap_unite(smap_many_work_t *w, const smap_aim_t *at, float top, uint8_t *contact)
{
  uint8_t known, corners = smap_corners_new(w, at, top, contact, &known);
  while (corners > 0 && known != SMAP_NONE) { /* each time there is a facet less */
    top = smap_take_out(w, known, at, top);
    corners = smap_corners_new(w, at, top, contact, &known);
  }
  return corners;
}

/* Enter the facet on a plane that carries the robot, if it is new: on three contacts, counter-clockwise, or
 * on all that touch it if they are not `alone`. */
SMAP_APART static void smap_add_facet(smap_many_work_t *w, const smap_aim_t *at, float h,
                                      const uint8_t three[3], int alone)
{
  uint8_t contact[SMAP_MANY_CONTACTS], corners = 3, common, k, e;
  if (smap_known(w, at, three, 3, &common) != SMAP_NONE) {
    return;
  }
  memcpy(contact, three, 3 * sizeof *three);
  if (!alone) {
    corners = smap_unite(w, at, h - SMAP_TOUCHES * w->map->size, contact);
  }
  if (corners > 2) {
    e = smap_enter(w, at, h, corners);
    for (k = 0; e != SMAP_NONE && k < corners; k++) {
      w->vertex[e + k] = contact[k];
      smap_touch(w, contact[k], at, w->corner[e + k]);
    }
  }
}

/* Enter the facet of three contacts that is found from a start on, if it is one and new; returns, of the first start,
 * how many there are. */
static uint8_t smap_try(smap_many_work_t *w, const uint8_t three[3], uint8_t start)
{
  smap_aim_t at;
  int turns, alone = 1;
  uint8_t k, starts = 1;
  float h;
  turns = smap_common(w, three, start, &at, &h, &starts);
  if (turns == 0 || !(-at.n[2] > w->map->steepest) || !(h > w->map->least_height)) {
    return starts;
  }
  for (k = 0; k < smap_contacts_of(w->map); k++) {
    const float reach = smap_extent(w, k, &at);
    const int one = k == three[0] || k == three[1] || k == three[2];
    const int near = one || reach >= h - SMAP_TOUCHES * w->map->size;
    if (reach > h + SMAP_NOISY * w->map->size || (near && smap_is_flat(w, k, &at))) {
      return starts;
    }
    alone = alone && (one || !near);
  }
  {
    const uint8_t round[3] = {three[turns > 0 ? 2 : 1], three[0], three[turns > 0 ? 1 : 2]};
    smap_add_facet(w, &at, h, round, alone);
  }
  return starts;
}

/* Mark the contacts at the corners of a facet. */
static inline void smap_mark_corners(const smap_many_work_t *w, uint8_t facet, uint8_t *marked)
{
  uint8_t e;
  for (e = w->facet[facet].first; e < smap_last_of(w, facet); e++) {
    marked[w->vertex[e]] = 1;
  }
}

/* The contacts that may be below the planes on those of an edge, on the way to its twin: not those of a facet
 * at either end, of which the plane turns away if all three are points or balls of one size. */
static uint8_t smap_list_others(const smap_many_work_t *w, uint8_t e, uint8_t back, uint8_t *other)
{
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  const int alike = smap_are_alike(w, i, j);
  uint8_t marked[SMAP_MANY_CONTACTS] = {0}, k, count = 0;
  if (alike) {
    smap_mark_corners(w, w->owner[e], marked);
    smap_mark_corners(w, w->owner[back], marked);
  }
  for (k = 0; k < smap_contacts_of(w->map); k++) {
    if (!(marked[k] && w->r[k] == w->r[i] && !smap_is_disc(w, k))) {
      other[count++] = k;
    }
  }
  return count;
}

/* Whether none of some contacts is below the planes on those of an edge, on the way to its twin. */
SMAP_APART static int smap_are_clear(const smap_many_work_t *w, uint8_t e, uint8_t back, const uint8_t *other,
                                     uint8_t others)
{
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[back]].at;
  uint8_t part, k;
  for (part = 1; part < 4; part++) {
    smap_aim_t at;
    float h;
    smap_on_arc(w, i, j, from, to, 0.25f * (float)part, &at);
    h = smap_extent(w, i, &at) + 2.0f * SMAP_NOISY * w->map->size;
    for (k = 0; k < others; k++) {
      if (smap_extent(w, other[k], &at) > h) {
        return 0;
      }
    }
  }
  return 1;
}

/* Whether nothing is below the planes on the contacts of an edge, on the way to its twin. */
SMAP_APART static int smap_is_clear(smap_many_work_t *w, uint8_t e, uint8_t back)
{
  uint8_t other[SMAP_MANY_CONTACTS];
  const uint8_t others = smap_list_others(w, e, back, other);
  return others == 0 || smap_are_clear(w, e, back, other, others);
}

/* Find the arc over an edge: of the facets that share its contacts the next one on its outside. */
SMAP_APART static void smap_find_twin(smap_many_work_t *w, uint8_t e)
{
  const uint8_t next = w->next[e];
  const float *n = w->facet[w->owner[e]].at.n;
  float along[3], out[3], d[3], least = 4.0f;
  uint8_t k, best = SMAP_NONE;
  smap_minus(w->corner[next], w->corner[e], along);
  smap_cross(along, n, out);
  for (k = (uint8_t)(e + 1u); k < w->edges; k++) {
    if (w->vertex[k] == w->vertex[next] && w->vertex[w->next[k]] == w->vertex[e] &&
        w->twin[k] == k && w->owner[k] != w->owner[e]) {
      smap_minus(w->facet[w->owner[k]].at.n, n, d);
      if (smap_dot(d, out) > 0.0f && smap_dot(d, d) < least) {
        least = smap_dot(d, d);
        best = k;
      }
    }
  }
  if (best != SMAP_NONE && (least < 1e-6f || smap_is_clear(w, e, best))) {
    w->twin[e] = best;
    w->twin[best] = e;
  }
}

/* Fill the complex of one posture. */
SMAP_APART static void smap_find_facets(smap_many_work_t *w)
{
  const uint8_t count = smap_contacts_of(w->map);
  uint8_t i, j, k, e;
  for (i = 0; i + 2 < count; i++) {
    for (j = (uint8_t)(i + 1u); j + 1 < count; j++) {
      for (k = (uint8_t)(j + 1u); k < count; k++) {
        const uint8_t three[3] = {i, j, k};
        const uint8_t starts = smap_try(w, three, SMAP_FROM_BELOW);
        uint8_t start;
        for (start = SMAP_FROM_ABOVE; start < starts; start++) {
          (void)smap_try(w, three, start);
        }
      }
    }
  }
  for (e = 0; e < w->edges; e++) {
    if (w->twin[e] == e) {
      smap_find_twin(w, e);
    }
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
  return smap_check_head(map, SMAP_CODEC_SEARCH) && smap_check_axes(map) &&
                 smap_check_positions(map, SMAP_BLOB(map) + map->size) && smap_check_many(map)
             ? SMAP_OK
             : SMAP_CORRUPT;
}

static const smap_runtime_t smap_run = {smap_run_pose, smap_run_pose_q, smap_run_at,   smap_run_at_i,
                                        smap_run_read, smap_run_read_i, smap_run_check};
