/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
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
