/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- rests: support polygons and their width --------------------------------------------------------- */
/* Which facets are rests: the support polygon of each, its centroid and whether it is wide enough.
 *
 * All contacts within the tolerance of a facet's plane make up its polygon.
 */
#define SMAP_BELOW 2e-5f        /* of the size: a facet has no contact as far below it */
#define SMAP_TURN_SHORT 4e-5f   /* rad: arcs as short as this join what is one facet */
#define SMAP_TURN_ROUNDED 2e-6f /* rad: the same for a robot that may not rock */

/* List the contacts that reach as far as `top` along a plane's normal, sorted by b; none where one
 * reaches beyond `most`. */
static uint8_t smap_list_spots(const smap_many_work_t *w, const smap_aim_t *aim, float top,
                               float most, smap_spot_t *spot)
{
  const smap_aim_t plane = *aim; /* no store to a spot can alter it */
  const uint8_t contacts = smap_contacts_of(w->map);
  float along[3], across[3];
  uint8_t i, at, count = 0;
  smap_frame(&plane, along, across);
  for (i = 0; i < contacts; i++) {
    const float reach = smap_extent(w, i, &plane);
    smap_spot_t here;
    if (reach > most) {
      return 0;
    }
    if (!(reach >= top)) {
      continue;
    }
    smap_find_spot(w, i, &plane, along, across, &here);
    for (at = count++; at > 0 && (spot[at - 1].b > here.b ||
                                  (spot[at - 1].b == here.b && spot[at - 1].a < here.a)); at--) {
      spot[at] = spot[at - 1];
    }
    spot[at] = here;
  }
  return count;
}

static inline float smap_bend_of(const smap_spot_t *o, const smap_spot_t *p, const smap_spot_t *q)
{
  return (p->a - o->a) * (q->b - o->b) - (p->b - o->b) * (q->a - o->a);
}

/* The corners of the polygon of spots, counter-clockwise in (a, b). */
static uint8_t smap_polygon(smap_many_work_t *w, const smap_spot_t *spot, uint8_t count, uint8_t *corner)
{
  uint8_t n = 0, k, i, least = 1;
  if (count == 3) {
    const float bend = smap_bend_of(&spot[0], &spot[1], &spot[2]);
    corner[0] = 0;
    corner[1] = bend > 0.0f ? 1 : 2;
    corner[2] = bend > 0.0f ? 2 : 1;
    return bend != 0.0f ? 3 : 2;
  }
  if (!smap_may(w, 2u * SMAP_COST_CORNER * count)) {
    return 0;
  }
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

static inline float smap_apart2(const smap_spot_t *p, const smap_spot_t *q)
{
  return (q->a - p->a) * (q->a - p->a) + (q->b - p->b) * (q->b - p->b);
}

/* Whether a polygon is at least `width` wide in every direction. */
static int smap_wide(smap_many_work_t *w, const smap_spot_t *spot, const uint8_t *corner, uint8_t n,
                     float width)
{
  uint8_t side, j;
  if (n == 3) {
    const smap_spot_t *a = &spot[corner[0]], *b = &spot[corner[1]], *c = &spot[corner[2]];
    const float area = smap_bend_of(a, b, c), wanted = area / width, most = wanted * wanted;
    return area > 0.0f && smap_apart2(a, b) <= most && smap_apart2(b, c) <= most &&
           smap_apart2(c, a) <= most;
  }
  for (side = 0; side < n && smap_may(w, SMAP_COST_SIDE); side++) {
    const uint8_t next = (uint8_t)(side + 1 < n ? side + 1 : 0);
    const smap_spot_t *o = &spot[corner[side]], *q = &spot[corner[next]];
    const float da = q->a - o->a, db = q->b - o->b, wanted = width * width * (da * da + db * db);
    for (j = (uint8_t)(next + 1u < n ? next + 1u : 0); j != side; j = (uint8_t)(j + 1u < n ? j + 1u : 0)) {
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

static void smap_classify(smap_many_work_t *w)
{
  smap_spot_t spot[SMAP_MANY_CONTACTS];
  uint8_t corner[2 * SMAP_MANY_CONTACTS + 1], f, k;
  for (f = 0; f < w->facets && smap_may(w, SMAP_COST_KIND); f++) {
    smap_facet_t *facet = &w->facet[f];
    const uint8_t count = smap_list_spots(w, &facet->at, facet->h - w->map->tolerance,
                                          facet->h + SMAP_BELOW * w->map->size, spot);
    const uint8_t n = smap_polygon(w, spot, count, corner);
    facet->kind = count ? SMAP_STAGE : SMAP_REFUSED;
    if (count == 0) {
      continue;
    }
    if (n < 3 || !smap_centroid(spot, corner, n, facet, facet->centre)) {
      SMAP_THRICE
      for (k = 0; k < 3; k++) {
        const uint8_t e = facet->first;
        facet->centre[k] = (w->corner[e][k] + w->corner[e + 1][k] + w->corner[e + 2][k]) * (1.0f / 3.0f);
      }
    } else if (w->map->rock_angle >= 3.1415f || smap_wide(w, spot, corner, n, w->map->rest_width)) {
      facet->kind = SMAP_REST;
    }
  }
}

/* Mark the arcs between rests that are one but for rounding. */
static void smap_mark_short(smap_many_work_t *w)
{
  const float turn = w->map->rock_angle < SMAP_TURN_SHORT ? SMAP_TURN_ROUNDED : SMAP_TURN_SHORT;
  uint8_t e;
  for (e = 0; e < w->edges; e++) {
    const uint8_t back = w->twin[e];
    w->roll_of[e] = SMAP_NONE;
    if (back == SMAP_NONE || back > e) {
      w->low[e] = SMAP_OPEN;
    } else {
      const smap_facet_t *f = &w->facet[w->owner[e]], *g = &w->facet[w->owner[back]];
      float d[3];
      smap_minus(f->at.n, g->at.n, d);
      w->low[e] = w->low[back] = f->kind == SMAP_REST && g->kind == SMAP_REST &&
                                         smap_dot(d, d) < turn * turn
                                     ? SMAP_SHORT
                                     : SMAP_OPEN;
    }
  }
}

/* Find the outlines of what short arcs join: no short arc is gone over twice. */
static void smap_find_outlines(smap_many_work_t *w)
{
  uint8_t e, left = SMAP_MOST(w->map, edges, SMAP_MANY_EDGES);
  for (e = 0; e < w->edges; e++) {
    uint8_t at = w->next[e];
    for (; w->low[e] != SMAP_SHORT && w->low[at] == SMAP_SHORT && left > 0; left--) {
      at = w->next[w->twin[at]];
    }
    w->onward[e] = at;
  }
}
