/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- facets of any contacts -------------------------------------------------------------------------- */
/* Facets of any contacts: points, spheres, and discs whose axes are not parallel.
 *
 * Three contacts have one plane below them; it is a facet if no other contact is below it.  What
 * touches it within rounding makes up its corners.  An arc joins two facets that share two contacts,
 * where nothing is below the planes between them.  A facet or an arc that is not found makes the
 * region smaller and never larger.
 */
#define SMAP_TOUCHES 1e-6f /* of the size: nearer to a plane a contact touches it */
#define SMAP_NOISY 3e-6f   /* of the size: nearer to a plane a contact is not below it */
#define SMAP_NEWTON 8

/* Where a contact touches a plane. */
static void smap_touch(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at, float out[3])
{
  const float *axle = w->axle[i];
  const float along = smap_dot(axle, at->n);
  float r = w->r[i], flat = 1.0f - along * along;
  uint8_t k;
  if (axle[0] != 0.0f || axle[1] != 0.0f || axle[2] != 0.0f) {
    r = r / smap_root(flat > 1e-6f ? flat : 1e-6f);
  }
  SMAP_UNROLL
  for (k = 0; k < 3; k++) {
    out[k] = w->p[i][k] + r * (at->n[k] - along * axle[k]);
  }
}

/* The direction of a vector. */
static void smap_aim(smap_aim_t *o, const float v[3])
{
  const float size = 1.0f / smap_root(smap_dot(v, v));
  uint8_t k;
  o->s = o->c = 0.0f;
  SMAP_UNROLL
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
  for (round = 0; round < 2; round++) {
    smap_touch(w, i, out, p);
    smap_touch(w, j, out, q);
    smap_minus(p, q, v);
    higher = smap_dot(v, out->n);
    SMAP_UNROLL
    for (k = 0; k < 3; k++) {
      v[k] -= higher * out->n[k];
    }
    size = smap_dot(v, v);
    if (!(size > 0.0f)) {
      return;
    }
    SMAP_UNROLL
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

/* Whether two contacts touch at the same places all the way. */
static int smap_is_still(const smap_many_work_t *w, uint8_t i, uint8_t j)
{
  return w->r[i] == 0.0f && w->r[j] == 0.0f;
}

/* Where the tangents of a rim at two directions meet. */
static void smap_tangents(const smap_many_work_t *w, uint8_t i, const smap_aim_t *a,
                          const smap_aim_t *b, float out[3])
{
  float p[3], q[3], arm[3], size2;
  smap_touch(w, i, a, p);
  smap_touch(w, i, b, q);
  smap_mix(p, q, 0.5f, out);
  smap_minus(out, w->p[i], arm);
  size2 = smap_dot(arm, arm);
  smap_mix(w->p[i], out, size2 > 0.0f ? w->r[i] * w->r[i] / size2 : 0.0f, out);
}

/* The same a part of the way from the rim of i to j's. */
static void smap_meet(const smap_many_work_t *w, uint8_t i, uint8_t j, float part, const smap_aim_t *a,
                      const smap_aim_t *b, float out[3])
{
  float p[3], q[3];
  smap_tangents(w, i, a, b, p);
  smap_tangents(w, j, a, b, q);
  smap_mix(p, q, part, out);
}

/* The plane below three contacts, which faces down; 0 where there is none. */
static int smap_common(const smap_many_work_t *w, const uint8_t three[3], smap_aim_t *at, float *h)
{
  float p[3][3], a[3], b[3], v[3], size2, change, before[3] = {0.0f, 0.0f, 0.0f};
  const float least = 1e-6f * w->map->size * w->map->size;
  uint8_t round, k;
  SMAP_UNROLL
  for (k = 0; k < 3; k++) {
    smap_copy(w->p[three[k]], p[k]);
  }
  for (round = 0; round < SMAP_NEWTON; round++) {
    smap_minus(p[1], p[0], a);
    smap_minus(p[2], p[0], b);
    smap_cross(a, b, v);
    size2 = smap_dot(v, v);
    if (!(size2 > least * least)) {
      return 0;
    }
    if (round == 0 ? v[2] > 0.0f : smap_dot(v, at->n) < 0.0f) {
      v[0] = -v[0];
      v[1] = -v[1];
      v[2] = -v[2];
    }
    smap_aim(at, v);
    SMAP_UNROLL
    for (k = 0; k < 3; k++) {
      smap_touch(w, three[k], at, p[k]);
    }
    smap_minus(at->n, before, a);
    smap_copy(at->n, before);
    change = smap_dot(a, a);
    *h = smap_dot(p[0], at->n);
    if (round > 0 && change < 1e-9f) {
      return 1;
    }
  }
  return 0;
}

/* How far a contact extends along a plane's normal. */
static float smap_extent(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
  float p[3];
  smap_touch(w, i, at, p);
  return smap_dot(p, at->n);
}

static uint8_t smap_corners_near(const smap_many_work_t *w, const smap_aim_t *at, float top,
                                 uint8_t *contact);

/* Enter the facet of three contacts, if it is one and new. */
static void smap_try(smap_many_work_t *w, const uint8_t three[3])
{
  const float size = w->map->size;
  uint8_t contact[SMAP_MANY_CONTACTS], n, k, f, e;
  smap_aim_t at;
  float h, d[3];
  if (!smap_common(w, three, &at, &h) || !(-at.n[2] > w->map->steepest) ||
      !(h > w->map->least_height)) {
    return;
  }
  for (k = 0; k < w->map->contacts; k++) {
    if (smap_extent(w, k, &at) > h + SMAP_NOISY * size) {
      return;
    }
  }
  n = smap_corners_near(w, &at, h - SMAP_TOUCHES * size, contact);
  for (f = 0; f < w->facets; f++) {
    smap_minus(w->facet[f].at.n, at.n, d);
    if (smap_dot(d, d) < 1e-8f) {
      return;
    }
  }
  if (n >= 3 && smap_enter(w, &at, h, n)) {
    e = w->facet[w->facets - 1].first;
    for (k = 0; k < n; k++) {
      w->vertex[e + k] = contact[k];
      smap_touch(w, contact[k], &at, w->corner[e + k]);
    }
  }
}

/* Whether nothing is below the planes on the contacts of an edge, on the way to its twin. */
static int smap_is_clear(const smap_many_work_t *w, uint8_t e, uint8_t back)
{
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[back]].at;
  uint8_t part, k;
  for (part = 1; part < 4; part++) {
    smap_aim_t at;
    float h;
    smap_on_arc(w, i, j, from, to, 0.25f * (float)part, &at);
    h = smap_extent(w, i, &at) + 2.0f * SMAP_NOISY * w->map->size;
    for (k = 0; k < w->map->contacts; k++) {
      if (smap_extent(w, k, &at) > h) {
        return 0;
      }
    }
  }
  return 1;
}

/* Find the arc over an edge: of the facets that share its contacts the next one on its outside. */
static void smap_find_twin(smap_many_work_t *w, uint8_t e)
{
  const uint8_t next = w->next[e];
  const float *n = w->facet[w->owner[e]].at.n;
  float along[3], out[3], d[3], least = 4.0f;
  uint8_t k, best = SMAP_NONE;
  smap_minus(w->corner[next], w->corner[e], along);
  smap_cross(along, n, out);
  for (k = (uint8_t)(e + 1u); k < w->edges; k++) {
    if (w->vertex[k] == w->vertex[next] && w->vertex[w->next[k]] == w->vertex[e] &&
        w->twin[k] == SMAP_NONE && w->owner[k] != w->owner[e]) {
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
static void smap_find_facets(smap_many_work_t *w, const smap_many_place_t *place)
{
  const uint8_t count = w->map->contacts;
  uint8_t i, j, k, e;
  w->axle = place->axle;
  for (i = 0; i < count; i++) {
    smap_copy(place->contact[i].p, w->p[i]);
    w->r[i] = place->contact[i].radius;
  }
  for (i = 0; i + 2 < count; i++) {
    for (j = (uint8_t)(i + 1u); j + 1 < count; j++) {
      for (k = (uint8_t)(j + 1u); k < count; k++) {
        const uint8_t three[3] = {i, j, k};
        smap_try(w, three);
      }
    }
  }
  for (e = 0; e < w->edges; e++) {
    if (w->twin[e] == SMAP_NONE) {
      smap_find_twin(w, e);
    }
  }
}
