/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
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
