/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
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
