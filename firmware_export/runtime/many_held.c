/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- held: what a rest catches of a robot that rolls onto it ----------------------------------------- */
/* Over which part of the segment between two contacts the robot is held that rocks from there.
 *
 * The robot rolls from a balance over the part w of the segment; on the rest that it comes to it is
 * held by an edge from a to b where
 *
 *     S >= 0   and   R + T - N >= 0,   T^2 = S^2 + N^2,
 *
 * with S how far gravity lies inside the edge, N how far the com is above it along gravity's
 * part across it, and R how much higher the com is than where it was let go.  All three are linear
 * in w, so the edge lets go between the roots of a quadratic.
 */
#define SMAP_ONE_LINE 3e-3f /* rad: over an arc as short the line that the robot came over stays what it was */
#define SMAP_SPARE 1e-3f /* of the segment: so much longer than all others one part must be */
#define SMAP_CAUGHT 4e-7f /* of the size: what rounding may alter of S and N */
#define SMAP_RAISED 2e-7f /* of the size: of R, by the rounding of normals, */
#define SMAP_FURTHER_ON 1e-7f /* and for each roll after the first */
#define SMAP_INSIDE 3e-4f /* of the size: further inside a side no rim is a corner */
#define SMAP_TURNED 1e-6f /* of the size, for each rad: of R */

/* Another part, of some length, may hold too. */
static void smap_spare(smap_held_t *o, float length)
{
  o->spare += length > 0.0f ? length + SMAP_SPARE : 0.0f;
}

/* Let go between a and b; of two parts that are left that is kept which is the longer with what adjoins it. */
static void smap_forbid(smap_held_t *o, float a, float b)
{
  if (b <= o->low || a >= o->high || a >= b) {
    return;
  }
  if (a - o->low + o->before < o->high - b + o->after) {
    smap_spare(o, a - o->low);
    o->low = b;
    o->before = 0.0f;
  } else {
    smap_spare(o, o->high - b);
    o->high = a;
    o->after = 0.0f;
  }
}

/* How much of [a, b] is left of the segment. */
static float smap_left_of(const smap_held_t *o, const float span[2])
{
  return (span[1] < o->high ? span[1] : o->high) - (span[0] > o->low ? span[0] : o->low);
}

/* Widen what is let go by the part of [a, b] that is left of the segment. */
static void smap_widen(const smap_held_t *o, float span[2], float a, float b)
{
  if (a < o->high && b > o->low) {
    span[0] = a < span[0] ? a : span[0];
    span[1] = b > span[1] ? b : span[1];
  }
}

/* Widen the part that is let go by what does not hold of a (1 - w)^2 + 2 b (1 - w) w + c w^2 >= 0, where it need
 * hold only while n0 (1 - w) + n1 w > 0.  What it comes from is convex, so that what lets go is one interval:
 * all, where both ends do.  Kept by its values at both ends it has its digits where it is next to nothing. */
static void smap_lost_energy(const smap_held_t *o, float a, float b, float c, float n0, float n1, float span[2])
{
  const float low = o->low, high = o->high, from = 1.0f - low, to = 1.0f - high;
  const int below = from * (from * a + 2.0f * low * b) + low * low * c < 0.0f && from * n0 + low * n1 > 0.0f;
  const int above = to * (to * a + 2.0f * high * b) + high * high * c < 0.0f && to * n0 + high * n1 > 0.0f;
  float d, t, u, v;
  if (!below && !above && (!(a - b > b - c) || (from * (b - a) + low * (c - b)) *
                                                   (to * (b - a) + high * (c - b)) >= 0.0f)) {
    return;
  }
  d = b * b - a * c;
  if (!below && !above && !(d > 0.0f)) {
    return;
  }
  if ((below && above) || !(d > 0.0f)) {
    smap_widen(o, span, -1.0f, 2.0f);
    return;
  }
  t = -(b + (b < 0.0f ? -smap_root(d) : smap_root(d))); /* w / (1 - w) is t / c and a / t */
  u = t + c != 0.0f ? t / (t + c) : 2.0f;
  v = t + a != 0.0f ? a / (t + a) : 2.0f;
  if (u > v) {
    t = u;
    u = v;
    v = t;
  }
  if (below) {
    smap_widen(o, span, -1.0f, v > low && v < high ? v : u > low && u < high ? u : 2.0f);
  } else if (above) {
    smap_widen(o, span, u > low && u < high ? u : v > low && v < high ? v : -1.0f, 2.0f);
  } else {
    smap_widen(o, span, u, v);
  }
}

/* Widen one part that is let go by another; what is between them is let go too, though it may hold. */
static void smap_let_both_go(smap_held_t *o, const float more[2], float span[2])
{
  if (span[0] < span[1] && more[0] < more[1]) {
    smap_spare(o, (span[0] > more[0] ? span[0] : more[0]) - (span[1] < more[1] ? span[1] : more[1]));
  }
  smap_widen(o, span, more[0], more[1]);
}

/* Over which part of the segment the robot goes on over an edge from a to b; 0 for none. */
static int smap_lost(const smap_many_work_t *w, const float a[3], const float b[3],
                     smap_held_t *o, float span[2])
{
  const float square = w->map->size * w->map->size, slack = (SMAP_CAUGHT + SMAP_OFF(w->map)) * square;
  const float lost = (SMAP_RAISED + SMAP_OFF(w->map) +
                      (SMAP_TURNED + SMAP_OFF_TURNED(w->map)) * o->turned) * square;
  float along[3], wall[3], s[2], n[2], r[2], more[2] = {3.0f, -3.0f}, size2, inverse, end;
  smap_minus(b, a, along);
  size2 = smap_dot(along, along);
  if (!(size2 > 1e-10f * square)) {
    return 0;
  }
  inverse = 1.0f / smap_root(size2);
  smap_cross(a, along, wall);
  s[0] = smap_dot(wall, o->g[0]) * inverse - slack;
  s[1] = smap_dot(wall, o->g[1]) * inverse - slack;
  span[0] = 3.0f;
  span[1] = -3.0f;
  if (s[0] < 0.0f && s[1] < 0.0f) {
    smap_widen(o, span, -1.0f, 2.0f);
    return 1;
  }
  if (s[0] < 0.0f || s[1] < 0.0f) {
    end = s[0] / (s[0] - s[1]);
    smap_widen(o, span, s[0] < 0.0f ? -1.0f : end, s[0] < 0.0f ? end : 2.0f);
  }
  smap_mix(a, b, -smap_dot(a, along) * inverse * inverse, wall); /* the com's foot on the edge's line */
  n[0] = smap_dot(wall, o->g[0]) + slack;
  n[1] = smap_dot(wall, o->g[1]) + slack;
  r[0] = o->rise[0] - lost;
  r[1] = o->rise[1] - lost;
  smap_lost_energy(o, s[0] * s[0] + (n[0] + n[0] - r[0]) * r[0],
                   s[0] * s[1] + n[0] * r[1] + (n[1] - r[1]) * r[0],
                   s[1] * s[1] + (n[1] + n[1] - r[1]) * r[1], n[0] - r[0], n[1] - r[1], more);
  smap_let_both_go(o, more, span);
  return span[0] < span[1] && span[0] < o->high && span[1] > o->low;
}

/* What is beyond an edge. */
static inline uint8_t smap_kind_beyond(const smap_many_work_t *w, uint8_t e)
{
  return w->twin[e] == e ? (uint8_t)SMAP_REFUSED : w->facet[w->owner[w->twin[e]]].kind;
}

/* Whether the facet beyond an edge is near enough for the robot to be caught there: a chord is no longer than its arc. */
static inline int smap_is_near(const smap_many_work_t *w, const smap_held_t *o, uint8_t e)
{
  return smap_chord(&w->facet[w->owner[e]].at, &w->facet[w->owner[w->twin[e]]].at) + o->turned <= w->map->rock_angle;
}

/* Whether a place is within a distance (squared) of the line from a along a direction. */
static int smap_is_on_line(const float p[3], const float a[3], const float along[3], float band2)
{
  float arm[3], c[3];
  smap_minus(p, a, arm);
  smap_cross(arm, along, c);
  return smap_dot(c, c) < band2 * smap_dot(along, along);
}

#if SMAP_MANY_RAILS > 2
/* Whether a contact is a corner of a facet, or of one that a short arc joins with it. */
static int smap_is_corner(const smap_many_work_t *w, uint8_t facet, uint8_t contact)
{
  const uint8_t first = w->facet[facet].first;
  uint8_t k, n;
  for (k = 0; k < 3; k++) {
    const uint8_t e = (uint8_t)(first + k), back = w->low[e] == SMAP_SHORT ? w->twin[e] : e;
    const uint8_t other = w->facet[w->owner[back]].first;
    for (n = 0; n < 3; n++) {
      if (w->vertex[other + n] == contact) {
        return 1;
      }
    }
  }
  return 0;
}

/* The mate of the contact at an end of an edge if it is on the facet's plane and along the edge, or SMAP_NONE:
 * what is on one axle is one corner of a facet as rounding has it, and the definition knows the side between both. */
static uint8_t smap_mate_along(const smap_many_work_t *w, uint8_t e, uint8_t end)
{
  const uint8_t mate = w->mate[w->vertex[end]], other = w->vertex[end == e ? w->next[e] : e];
  float along[3], ahead;
  if (mate >= SMAP_MANY_CONTACTS || mate == other) {
    return SMAP_NONE;
  }
  smap_minus(smap_end(w, e), smap_corner(w, e), along);
  ahead = (w->p[mate][1] - smap_corner(w, end)[1]) * along[1];
  if ((end == e ? ahead : -ahead) <= 0.0f || along[1] * along[1] < 0.5f * smap_dot(along, along) ||
      !smap_touches(w, mate, &w->facet[w->owner[e]])) {
    return SMAP_NONE;
  }
  return mate;
}

/* Widen the part over which the robot goes on over an edge by that over the side to a mate, which is no corner itself
 * and not inside the edge, and tell whether there is any. */
SMAP_APART static int smap_lost_to_mate(const smap_many_work_t *w, uint8_t e, uint8_t end, int lost,
                                        smap_held_t *o, float span[2])
{
  const uint8_t mate = w->mate[w->vertex[end]], facet = w->owner[e];
  const smap_facet_t *f = &w->facet[facet];
  const float *p = smap_corner(w, end), inside = SMAP_INSIDE * w->map->size * f->h;
  float along[3], wall[3], spot[3], more[2] = {0.0f, 0.0f};
  if (mate >= SMAP_MANY_CONTACTS) {
    return lost;
  }
  smap_touch(w, mate, &f->at, spot);
  smap_minus(smap_end(w, e), smap_corner(w, e), along);
  smap_cross(smap_corner(w, e), along, wall);
  if (smap_dot(wall, spot) > inside * smap_root(smap_dot(along, along)) || smap_is_corner(w, facet, mate) ||
      !smap_lost(w, end == e ? p : spot, end == e ? spot : p, o, more)) {
    return lost;
  }
  if (lost) {
    smap_let_both_go(o, more, span);
  } else {
    span[0] = more[0];
    span[1] = more[1];
  }
  return 1;
}
#endif

/* Whether the robot goes on over an edge, which is not the way back over the line on which it came, and
 * over which part.  A long edge that runs the other way is the way on: over a facet that is a sliver, though
 * it be a rest with the contacts near its plane. */
static int smap_leaves(smap_many_work_t *w, uint8_t e, smap_held_t *o, float span[2])
{
  const float band2 = w->map->band > 0.0f ? w->map->band * w->map->band : 0.0f;
  const float *p = smap_corner(w, e), *q = smap_end(w, e), *a = smap_corner(w, o->line);
  float along[3], edge[3];
  int lost = smap_lost(w, p, q, o, span);
#if SMAP_MANY_RAILS > 2
  if (smap_mate_along(w, e, e) != SMAP_NONE && smap_may(w, SMAP_COST_MATE)) {
    lost = smap_lost_to_mate(w, e, e, lost, o, span);
  }
  if (smap_mate_along(w, e, w->next[e]) != SMAP_NONE && smap_may(w, SMAP_COST_MATE)) {
    lost = smap_lost_to_mate(w, e, w->next[e], lost, o, span);
  }
#endif
  if (!lost) {
    return 0;
  }
  smap_minus(smap_end(w, o->line), a, along);
  smap_minus(q, p, edge);
  if (smap_dot(edge, along) <= 0.0f && smap_dot(edge, edge) > band2) {
    return 1;
  }
  return !(smap_is_on_line(p, a, along, band2) && smap_is_on_line(q, a, along, band2));
}

/* Whether a facet is the one that it balances from, but for noise, `turned` rad from there: the other way
 * may end on that. */
static int smap_is_home(const smap_many_work_t *w, const smap_held_t *o, uint8_t facet, float turned)
{
  const float apart = smap_chord(&w->facet[facet].at, &w->facet[o->home].at);
  return apart < 1.01e-2f && (apart < 1e-4f || turned + 1e-5f > apart + 1e-2f);
}

/* Turn a gap along the roll over edge e. */
static void smap_carry(const smap_many_work_t *w, smap_row_t *roll, uint8_t e,
                       const smap_held_t *from, smap_held_t *to)
{
  const float lost = SMAP_FURTHER_ON * w->map->size * w->map->size;
  uint8_t end;
  *to = *from;
  for (end = 0; end < 2; end++) {
    to->rise[end] += smap_roll_over(w, roll, e, from->g[end], to->g[end]) - lost;
  }
  to->turned += roll[SMAP_ANGLE][0];
  to->spare = 0.0f;
  to->line = roll[SMAP_ANGLE][0] > SMAP_ONE_LINE ? w->twin[e] : from->line;
}

/* Let a gap roll on over edge e onto the rest there, for a part of the segment; 0 where it must not. */
static int smap_roll_on(const smap_many_work_t *w, smap_row_t *roll, uint8_t e, const smap_held_t *o, const float span[2],
                        smap_held_t *next)
{
  const uint8_t back = w->twin[e];
  const float turned = o->turned + roll[SMAP_ANGLE][0];
  next->spare = 0.0f;
  if (turned > w->map->rock_angle) {
    return 0;
  }
  if (smap_is_home(w, o, w->owner[back], turned)) { /* where it may, or may go on */
    smap_spare(next, smap_left_of(o, span));
    return 0;
  }
  smap_carry(w, roll, e, o, next);
  if (span[0] > o->low) {
    next->low = span[0];
    next->before += span[0] - o->low;
  }
  if (span[1] < o->high) {
    next->high = span[1];
    next->after += o->high - span[1];
  }
  return 1;
}

/* Let go of a part of the segment but for what was `held` further on. */
static void smap_take_over(const smap_held_t *next, int held, const float span[2], smap_held_t *o)
{
  smap_spare(o, next->spare);
  if (held) {
    smap_forbid(o, span[0], next->low > o->low ? next->low : span[0]);
    smap_forbid(o, next->high < o->high ? next->high : span[1], span[1]);
  } else {
    smap_forbid(o, span[0], span[1]);
  }
}

enum { SMAP_TO_NONE = 0, SMAP_TO_RESTS = 1, SMAP_TO_ALL = 2 }; /* which edges are looked at in a turn */

/* Go on to the next edge of a rest; 0 where it has been round. */
static inline int smap_look_on(const smap_many_work_t *w, smap_visit_t *v)
{
  v->at = w->onward[v->at];
  if (v->at != v->came) {
    return 1;
  }
  return v->turn++ == SMAP_TO_NONE;
}

/* Whether an edge is looked at in this turn, and the robot goes on over it. */
static inline int smap_is_left(smap_many_work_t *w, smap_visit_t *v, float span[2])
{
  if (v->at == v->came || (v->turn != SMAP_TO_ALL &&
                           (v->turn == SMAP_TO_RESTS) != (smap_kind_beyond(w, v->at) == SMAP_REST))) {
    return 0;
  }
  return smap_leaves(w, v->at, &v->held, span);
}

/* Go on over the edge that is looked at, by its roll, to the next visit; 0 where the robot must not. */
SMAP_APART static uint8_t smap_come(const smap_many_work_t *w, smap_row_t *roll, smap_visit_t *v, const float span[2])
{
  smap_visit_t *next = v + 1;
  next->came = next->at = w->twin[v->at];
  next->turn = SMAP_TO_ALL;
  next->span[0] = span[0];
  next->span[1] = span[1];
  if (smap_roll_on(w, roll, v->at, &v->held, span, &next->held)) {
    return 1;
  }
  smap_take_over(&next->held, 0, span, &v->held);
  return 0;
}

/* Keep what is held of a robot that comes to a rest over its edge `came`, there or on rests further on: the first
 * visit's. */
static void smap_hold_rest(smap_many_work_t *w, uint8_t came)
{
  smap_visit_t *const visit = w->bench->visit;
  uint8_t at = 0;
  float span[2] = {0.0f, 0.0f};
  visit->came = visit->at = came;
  visit->turn = SMAP_TO_NONE;
  while (smap_may(w, SMAP_COST_VISIT)) {
    smap_visit_t *const v = &visit[at];
    const int held = v->held.low < v->held.high;
    if (!held || !smap_look_on(w, v)) {
      if (at == 0) {
        break;
      }
      at--;
      smap_take_over(&v->held, held, v->span, &visit[at].held);
    } else if (smap_is_left(w, v, span)) {
      const uint8_t beyond = smap_kind_beyond(w, v->at);
      const int caught = beyond != SMAP_REFUSED && smap_is_near(w, &v->held, v->at);
      if (!caught || at >= SMAP_WAYS - 1 || beyond != SMAP_REST) {
        /* It is not looked into further on: what may catch the robot the exact definition may keep. */
        smap_spare(&v->held, caught ? smap_left_of(&v->held, span) : 0.0f);
        smap_forbid(&v->held, span[0], span[1]);
      } else if (smap_may(w, SMAP_COST_WAY)) {
        at = (uint8_t)(at + smap_come(w, smap_roll(w, v->at), v, span));
      }
    }
  }
}
