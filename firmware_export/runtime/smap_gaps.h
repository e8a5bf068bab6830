/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- gaps: where the robot rocks from one rest to the next ------------------------------------------- */
/* A balance on the contacts i and j at an edge of two rests is a part w of the way from i to j.  Let go there the
 * robot rolls to the one rest or the other, and lands: it stays if what its com has sunk by does not lift it over
 * another edge of that rest.  The gap is of the w from which it stays, whichever way it rolls.
 *
 *   On landing gravity lies S inside an edge, the com is N above the edge's line, and has sunk by E, all linear
 *   in w.  The robot stays where S^2 >= E (2 N + E); as no geometric mean is above an arithmetic one, where
 *   S >= (c E + (2 N + E) / c) / 2 for any c: what lets go of it is then one end of the way. */
#define SMAP_ROUND_OFF 1e-6f /* of the size squared: what rounding may alter of S, N and E, */
#define SMAP_SUNK 1.003f     /* and of E, of which a half-way place stands for a whole arc */
#define SMAP_SPARE 1e-4f     /* of the way, by which a limit is on the safe side */
#define SMAP_STEP_IN 1.1f    /* times what brings the side of a gap in */
#define SMAP_SLIT 1e-5f      /* of the size: between edges that are nearer there is nothing */
#define SMAP_LEANS 1e-6f     /* of the size: the ends of a gap are as far inside its sides, and no place is inside by less */
#define SMAP_DOT 2e-6f       /* of the size: an edge that is shorter holds and bounds nothing of its own */
#define SMAP_HALVES 2        /* rounds of Newton's method for the plane half-way over an arc */

/* Gravity on arrival, and by how much the com has sunk, for w = 0 and 1. */
typedef struct {
  float g[2][3], sunk[2], doubt; /* doubt: length squared by which S, N and E may be off */
} smap_landing_t;

/* Find the plane that both contacts of an edge touch half-way between two normals, d apart, and where.  Newton's method
 * takes the plane through the places where they touch the plane before. */
static void smap_find_half(const smap_work_t *w, uint8_t e, const float d[3], float n[3], float (*half)[3])
{
  const uint8_t i = w->contact[e], j = w->contact[smap_after(w, e)];
  const float *const from = w->normal[w->rest[e]];
  float v[3];
  uint8_t left;
  for (left = 0; left < 3; left++) {
    n[left] = from[left] - 0.5f * d[left];
  }
  (void)smap_unit(n);
  for (left = SMAP_HALVES; left > 0; left--) {
    smap_touch(w, i, n, half[0]);
    smap_touch(w, j, n, half[1]);
    smap_minus(half[0], half[1], v);
    smap_cross(v, d, n);
    (void)smap_unit(n);
  }
}

/* The least rotation from unit vector a to b: its axis times the sine, and 1 / (1 + cosine). */
typedef struct {
  float axis[3], share;
} smap_turn_t;

static void smap_find_turn(const float a[3], const float b[3], smap_turn_t *turn)
{
  smap_cross(a, b, turn->axis);
  turn->share = 1.0f / (1.0f + smap_dot(a, b));
}

/* By how much a rotation, or with sign -1 the one back, turns g. */
static void smap_turn(const smap_turn_t *turn, float sign, const float g[3], float out[3])
{
  float across[3];
  uint8_t k;
  smap_cross(turn->axis, g, across);
  smap_cross(turn->axis, across, out);
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    out[k] = sign * across[k] + turn->share * out[k];
  }
}

/* Roll from one rest to another: gravity turns half-way and the rest of the way, back where sign is -1, and the com
 * sinks by the integral of -p . dg over a contact that is at p, then m, at last at q: both as parabolas. */
static void smap_roll(const smap_turn_t *first, const smap_turn_t *second, float sign, const float *const *p,
                      float (*m)[3], const float *const *q, smap_landing_t *l)
{
  uint8_t k, w;
  SMAP_TWICE
  for (w = 0; w < 2; w++) {
    float half[3], amid[3], more[3], sunk = 0.0f;
    smap_turn(first, sign, p[w], half);
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      amid[k] = p[w][k] + half[k];
    }
    smap_turn(second, sign, amid, more);
    SMAP_THRICE
    for (k = 0; k < 3; k++) { /* from p on, lest a small rise loses its digits */
      const float via = m[w][k] - p[w][k], to = q[w][k] - p[w][k], end = half[k] + more[k];
      sunk += (2.0f / 3.0f) * (half[k] * to - end * via) - end * (p[w][k] + 0.5f * to);
      l->g[w][k] = p[w][k] + end;
    }
    l->sunk[w] = SMAP_SUNK * sunk + l->doubt;
    l->sunk[w] = l->sunk[w] > 0.5f * l->doubt ? l->sunk[w] : 0.5f * l->doubt;
  }
}

/* Cut the part `span` of the way down to what one edge of a rest holds; 0 where nothing is left.  S is times the length
 * of the edge, N and E times its square. */
static int smap_hold(const smap_work_t *w, uint8_t e, const smap_landing_t *l, float span[2])
{
  const float *const a = w->corner[e];
  float u[3], in[2], y[2], spare[2], au, uu, size, t = 0.5f, begin = 0.0f, last = 0.0f;
  uint8_t k, pass;
  smap_minus(w->corner[smap_after(w, e)], a, u);
  uu = smap_dot(u, u);
  if (!(uu > SMAP_DOT * SMAP_DOT * w->map->size * w->map->size)) {
    return 1;
  }
  au = smap_dot(a, u);
  size = smap_root(uu);
  SMAP_TWICE
  for (k = 0; k < 2; k++) {
    const float above = uu * (smap_dot(a, l->g[k]) + l->doubt) - au * smap_dot(u, l->g[k]), sunk = uu * l->sunk[k];
    in[k] = smap_dot(w->region->wall[e], l->g[k]) - size * l->doubt;
    spare[k] = size * in[k] - (above + sunk > 0.0f ? above + sunk : 0.0f);
    y[k] = 2.0f * above + sunk;
    y[k] = y[k] > 0.01f * uu * l->doubt ? y[k] : 0.01f * uu * l->doubt; /* below the edge as soon as it is inside it stays */
  }
  if (spare[0] >= 0.0f && spare[1] >= 0.0f) { /* as c = 1 says already */
    return 1;
  }
  for (pass = 0; pass < 2; pass++) { /* c of where it lets go is the best */
    const float c = 0.5f * smap_root((y[0] + t * (y[1] - y[0])) / (l->sunk[0] + t * (l->sunk[1] - l->sunk[0])));
    const float d = 0.25f / c;
    begin = in[0] - c * l->sunk[0] - d * y[0];
    last = in[1] - c * l->sunk[1] - d * y[1];
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

/* The edge behind e on the outline of the rests that are one with its own. */
static uint8_t smap_onward(const smap_work_t *w, uint8_t e)
{
  uint8_t left = SMAP_MAX_CORNERS;
  for (e = smap_after(w, e); left > 0 && w->joined[e]; left--) {
    e = smap_after(w, w->twin[e]);
  }
  return e;
}

/* Cut `span` down to what the rest holds that the robot comes to over its edge `came`; 0 where nothing is left. */
static int smap_land(const smap_work_t *w, uint8_t came, smap_landing_t *l, float span[2])
{
  const float doubt = l->doubt;
  uint8_t left = SMAP_MAX_CORNERS, e;
  for (e = smap_onward(w, came); e != came && left > 0; e = smap_onward(w, e), left--) {
    /* Rests that are one have planes of their own. */
    l->doubt = w->rest[e] == w->rest[came] ? doubt : doubt + SMAP_JOINED * w->map->size * w->map->size;
    if (!smap_hold(w, e, l, span)) {
      return 0;
    }
  }
  l->doubt = doubt;
  return left > 0;
}

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

/* Bring one side of a gap in, by the rule of Illinois, until the half-way place of its curve is not inside; 0 where that
 * does not happen.  The curve is that of one balance on the way over the arc. */
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
 * twisted, or there is no room. */
static int smap_add_gap(smap_work_t *w, uint8_t e, const float *const corner[4], const float span[2])
{
  const uint8_t k = w->at->gaps;
  const float least = SMAP_LEANS * w->map->size;
  smap_gap_t *const gap = &w->at->gap[k];
  float place[2][2][3];
  uint8_t side;
  if (SMAP_IS_FULL(w, SMAP_OF_GAPS, k, SMAP_MAX_GAPS)) {
    return 0;
  }
  gap->a = e;
  gap->b = w->twin[e];
  gap->left = (uint8_t)(SMAP_MAX_CORNERS + 2u * k);
  gap->right = (uint8_t)(gap->left + 1u);
  for (side = 0; side < 2; side++) {
    smap_mix(corner[0], corner[1], span[side], place[side][0]);
    smap_mix(corner[2], corner[3], span[side], place[side][1]);
  }
  for (side = 0; side < 2; side++) {
    float *const wall = w->region->wall[gap->left + side];
    float along[3];
    smap_minus(place[side][side], place[side][1 - side], along);
    smap_cross(place[side][side], along, wall);
    if (!smap_unit(wall) || !(smap_dot(wall, place[1 - side][0]) > least) ||
        !(smap_dot(wall, place[1 - side][1]) > least)) {
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
  const uint8_t back = w->twin[e], end = smap_after(w, e), rear = smap_after(w, back);
  const float *const from = w->normal[w->rest[e]], *const to = w->normal[w->rest[back]];
  const float *const corner[4] = {w->corner[e], w->corner[end], w->corner[rear], w->corner[back]};
  const float square = w->map->size * w->map->size;
  float half[2][3], amid[3], span[2] = {0.0f, 1.0f}, d[3], turned2;
  smap_turn_t turn[2];
  smap_landing_t l;
  uint8_t side;
  int slit, one = w->joined[e];
  smap_minus(from, to, d);
  turned2 = smap_dot(d, d);
  if (!one && !(turned2 <= w->map->rock_chord * w->map->rock_chord)) {
    return;
  }
  smap_minus(corner[0], corner[2], half[0]);
  smap_minus(corner[1], corner[3], half[1]);
  slit = smap_dot(half[0], half[0]) + smap_dot(half[1], half[1]) < SMAP_SLIT * SMAP_SLIT * square;
  if (!one) {
    l.doubt = (SMAP_ROUND_OFF + w->map->off + w->map->turned * smap_root(turned2)) * square;
    smap_find_half(w, e, d, amid, half);
    smap_find_turn(from, amid, &turn[0]);
    smap_find_turn(amid, to, &turn[1]);
    smap_roll(&turn[0], &turn[1], 1.0f, corner, half, corner + 2, &l);
    if (!smap_land(w, back, &l, span)) {
      return;
    }
    smap_roll(&turn[1], &turn[0], -1.0f, corner + 2, half, corner, &l);
    if (!smap_land(w, e, &l, span)) {
      return;
    }
    for (side = 0; side < 2 && !slit; side++) {
      if (!smap_bring_in(corner, half, side, SMAP_LEANS * w->map->size, span)) {
        return;
      }
    }
    span[0] = span[0] > 0.0f ? span[0] + SMAP_SPARE : 0.0f;
    span[1] = span[1] < 1.0f ? span[1] - SMAP_SPARE : 1.0f;
    if (!(span[0] < span[1]) || !(slit || smap_add_gap(w, e, corner, span))) {
      return;
    }
  } else if (!slit && !SMAP_IS_FULL(w, SMAP_OF_GAPS, w->at->gaps, SMAP_MAX_GAPS)) {
    /* The strip between them has no sides of its own, but the walls beside e. */
    smap_gap_t *const gap = &w->at->gap[w->at->gaps++];
    gap->a = e;
    gap->b = back;
    gap->left = end;
    gap->right = (uint8_t)(e > w->at->first[w->rest[e]] ? e - 1u : w->at->first[w->rest[e] + 1] - 1u);
  }
  w->at->nearly = one ? 1 : w->at->nearly;
  smap_join(w, w->rest[e], w->rest[back]);
  w->low[e] = span[0];
  w->low[back] = 1.0f - span[1];
}

/* The direction of a part of the way from one place to another. */
static void smap_way_to(const float p[3], const float q[3], float part, float out[3])
{
  smap_mix(p, q, part, out);
  (void)smap_unit(out);
}

/* Add what is boundary of the edge e of a rest, from direction a to b: all but what holds of it. */
static void smap_bound(smap_work_t *w, uint8_t e, const float a[3], const float b[3])
{
  const uint8_t end = smap_after(w, e), i = w->contact[e], j = w->contact[end];
  float r[3];
  if (w->low[e] > 1.0f) {
    smap_add_arc(w, e, a, b, i, j);
    return;
  }
  if (w->low[e] > 0.0f) {
    smap_way_to(w->corner[e], w->corner[end], w->low[e], r);
    smap_add_arc(w, e, a, r, i, j);
  }
  if (w->low[w->twin[e]] > 0.0f) {
    smap_way_to(w->corner[end], w->corner[e], w->low[w->twin[e]], r);
    smap_add_arc(w, e, r, b, i, j);
  }
}

/* Add the boundary of a rest. */
static void smap_bound_rest(smap_work_t *w, uint8_t r)
{
  const uint8_t first = w->at->first[r], end = w->at->first[r + 1];
  float a[3], b[3];
  uint8_t e;
  w->at->own[r] = w->at->arcs;
  memcpy(a, w->corner[first], sizeof a);
  (void)smap_unit(a);
  for (e = first; e < end; e++) {
    const uint8_t next = e + 1 < end ? (uint8_t)(e + 1) : first;
    memcpy(b, w->corner[next], sizeof b);
    (void)smap_unit(b);
    if (!(w->low[e] > 1.0f)) {
      w->at->own[r] = SMAP_NONE;
    }
    smap_bound(w, e, a, b);
    memcpy(a, b, sizeof a);
  }
}

/* Add both sides of a gap to the boundary. */
static void smap_bound_sides(smap_work_t *w, const smap_gap_t *gap)
{
  const uint8_t a = gap->a, b = gap->b, end = smap_after(w, a), rear = smap_after(w, b);
  const float low = w->low[a], high = w->low[b];
  float p[3], q[3];
  smap_way_to(w->corner[a], w->corner[end], low, p);
  smap_way_to(w->corner[rear], w->corner[b], low, q);
  smap_add_arc(w, gap->left, p, q, w->contact[a], w->contact[a]);
  smap_way_to(w->corner[end], w->corner[a], high, p);
  smap_way_to(w->corner[b], w->corner[rear], high, q);
  smap_add_arc(w, gap->right, q, p, w->contact[end], w->contact[end]);
}

/* Scale the walls of all corners to length 1.  Rounding tells how the wall of a dot lies: it gets the next one. */
static void smap_unit_walls(smap_work_t *w)
{
  const float least = SMAP_DOT * w->map->size * w->map->size;
  float(*const wall)[3] = w->region->wall;
  uint8_t r, e;
  for (r = 0; r < w->at->rests; r++) {
    const uint8_t first = w->at->first[r], end = w->at->first[r + 1];
    uint8_t next = SMAP_NONE, dots = 0; /* next: the first wall of all, and then the one behind e */
    for (e = end; e-- > first;) {
      if (smap_dot(wall[e], wall[e]) > least * least && smap_unit(wall[e])) {
        next = e;
      } else {
        memset(wall[e], 0, sizeof wall[e]);
        dots = 1;
      }
    }
    w->full |= (uint8_t)(next == SMAP_NONE);
    for (e = end; dots && next != SMAP_NONE && e-- > first;) {
      if (smap_dot(wall[e], wall[e]) > 0.0f) {
        next = e;
      } else {
        memcpy(wall[e], wall[next], sizeof wall[e]);
      }
    }
  }
}

/* Find the gaps and the boundary of the rests that were added; 0 where there is no room for it. */
static int smap_close(smap_work_t *w)
{
  smap_layout_t *const at = w->at;
  const uint8_t corners = at->first[at->rests];
  uint8_t e, i, r, k;
  for (e = 0; e < corners; e++) {
    if (w->twin[e] != SMAP_NONE && w->twin[e] > e) {
      smap_find_gap(w, e);
    }
  }
  smap_unit_walls(w);
  for (i = 0; i < at->rests; i++) {
    const uint8_t from = at->arcs;
    if (w->island[i] != i) {
      continue;
    }
    for (r = i; r < at->rests; r++) {
      if (w->island[r] == i) {
        smap_bound_rest(w, r);
      }
    }
    for (k = 0; k < at->gaps; k++) {
      if (w->island[w->rest[at->gap[k].a]] == i && at->gap[k].left >= SMAP_MAX_CORNERS) {
        smap_bound_sides(w, &at->gap[k]);
      }
    }
    for (r = i; r < at->rests; r++) {
      if (w->island[r] == i) {
        at->from[r] = from;
        at->till[r] = at->arcs;
      }
    }
  }
  return !w->full;
}
