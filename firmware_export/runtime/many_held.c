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
#define SMAP_RAISED 2e-7f /* of the size: of R, by the rounding of normals */
#define SMAP_TURNED 1e-6f /* of the size, for each rad: of R */

/* A gap while it is looked at: gravity at both ends of its segment where the roll has come to, and
 * how much higher the com is there. */
typedef struct {
  float g[2][3], rise[2];
  float low, high;   /* of the segment, that are left */
  float turned;      /* rad, so far */
  float spare;       /* length of the parts that another one may be of: given up, or not looked into */
  uint8_t home;      /* the facet on which the other way ends: the one that it balances from */
  uint8_t line;      /* the edge over which it came, see SMAP_ONE_LINE */
} smap_held_t;

/* Another part, of some length, may hold too. */
static void smap_spare(smap_held_t *o, float length)
{
  o->spare += length > 0.0f ? length + SMAP_SPARE : 0.0f;
}

/* Let go between a and b; of two parts that are left the longer is kept. */
static void smap_forbid(smap_held_t *o, float a, float b)
{
  if (b <= o->low || a >= o->high || a >= b) {
    return;
  }
  if (a - o->low < o->high - b) {
    smap_spare(o, a - o->low);
    o->low = b;
  } else {
    smap_spare(o, o->high - b);
    o->high = a;
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

/* Widen the part that is let go by what does not hold of q0 + q1 w + q2 w^2 >= 0, where it need hold
 * only while n0 + n1 w > 0.  What it comes from is convex, so that what lets go is one interval:
 * all, where both ends do. */
static void smap_lost_energy(const smap_held_t *o, const float q[3], float n0, float n1,
                             float span[2])
{
  const float at_low = q[0] + o->low * (q[1] + o->low * q[2]);
  const float at_high = q[0] + o->high * (q[1] + o->high * q[2]);
  const int below = at_low < 0.0f && n0 + o->low * n1 > 0.0f;
  const int above = at_high < 0.0f && n0 + o->high * n1 > 0.0f;
  float d, t, a, b;
  if (!below && !above && (q[2] <= 0.0f || (q[1] + 2.0f * q[2] * o->low) *
                                               (q[1] + 2.0f * q[2] * o->high) >= 0.0f)) {
    return;
  }
  d = q[1] * q[1] - 4.0f * q[2] * q[0];
  if (!below && !above && !(d > 0.0f)) {
    return;
  }
  if ((below && above) || !(d > 0.0f)) {
    smap_widen(o, span, -1.0f, 2.0f);
    return;
  }
  t = -0.5f * (q[1] + (q[1] < 0.0f ? -smap_root(d) : smap_root(d)));
  a = q[2] != 0.0f ? t / q[2] : 2.0f;
  b = t != 0.0f ? q[0] / t : 2.0f;
  if (a > b) {
    t = a;
    a = b;
    b = t;
  }
  if (below) {
    smap_widen(o, span, -1.0f, b > o->low && b < o->high ? b : a > o->low && a < o->high ? a : 2.0f);
  } else if (above) {
    smap_widen(o, span, a > o->low && a < o->high ? a : b > o->low && b < o->high ? b : -1.0f, 2.0f);
  } else {
    smap_widen(o, span, a, b);
  }
}

/* Over which part of the segment the robot goes on over an edge from a to b; 0 for none. */
static int smap_lost(const smap_many_work_t *w, const float a[3], const float b[3],
                     const smap_held_t *o, float span[2])
{
  const float square = w->map->size * w->map->size, slack = (SMAP_CAUGHT + SMAP_OFF(w->map)) * square;
  const float lost = (SMAP_RAISED + SMAP_OFF(w->map) +
                      (SMAP_TURNED + SMAP_OFF_TURNED(w->map)) * o->turned) * square;
  float along[3], wall[3], s, ds, n, dn, r, dr, q[3], size2, inverse;
  smap_minus(b, a, along);
  size2 = smap_dot(along, along);
  if (!(size2 > 1e-10f * square)) {
    return 0;
  }
  inverse = 1.0f / smap_root(size2);
  smap_cross(a, b, wall);
  s = smap_dot(wall, o->g[0]) * inverse - slack;
  ds = smap_dot(wall, o->g[1]) * inverse - slack - s;
  span[0] = 3.0f;
  span[1] = -3.0f;
  if (s < 0.0f || s + ds < 0.0f) {
    r = s < 0.0f && s + ds < 0.0f ? 0.0f : -s / ds;
    smap_widen(o, span, s < 0.0f ? -1.0f : r, s + ds < 0.0f ? 2.0f : r);
    if (s < 0.0f && s + ds < 0.0f) {
      return 1;
    }
  }
  smap_mix(a, b, -smap_dot(a, along) * inverse * inverse, wall); /* the com's foot on the edge's line */
  n = smap_dot(wall, o->g[0]) + slack;
  dn = smap_dot(wall, o->g[1]) + slack - n;
  r = o->rise[0] - lost;
  dr = o->rise[1] - o->rise[0];
  q[0] = s * s + (n + n - r) * r;
  q[1] = 2.0f * (s * ds + n * dr + r * (dn - dr));
  q[2] = ds * ds + (dn + dn - dr) * dr;
  smap_lost_energy(o, q, n - r, dn - dr, span);
  return span[0] < span[1] && span[0] < o->high && span[1] > o->low;
}

/* What is beyond an edge. */
static inline uint8_t smap_kind_beyond(const smap_many_work_t *w, uint8_t e)
{
  return w->twin[e] == SMAP_NONE ? (uint8_t)SMAP_REFUSED : w->facet[w->owner[w->twin[e]]].kind;
}

/* Let go of a part that is not looked into further on: the exact definition may keep it. */
static void smap_give_up(const smap_many_work_t *w, smap_held_t *o, uint8_t e, const float span[2])
{
  smap_spare(o, smap_kind_beyond(w, e) != SMAP_REFUSED ? smap_left_of(o, span) : 0.0f);
  smap_forbid(o, span[0], span[1]);
}

/* Whether a place is within a distance (squared) of the line from a along a direction. */
static int smap_beside(const float p[3], const float a[3], const float along[3], float band2)
{
  float arm[3], c[3];
  smap_minus(p, a, arm);
  smap_cross(arm, along, c);
  return smap_dot(c, c) < band2 * smap_dot(along, along);
}

/* Whether the robot goes on over an edge, which is not the way back over the line on which it came, and
 * over which part. */
static int smap_leaves(const smap_many_work_t *w, uint8_t e, const smap_held_t *o, float span[2])
{
  const float band2 = w->map->band > 0.0f ? w->map->band * w->map->band : 0.0f;
  const float *p = smap_corner(w, e), *q = smap_end(w, e), *a = smap_corner(w, o->line);
  float along[3];
  if (!smap_lost(w, p, q, o, span)) {
    return 0;
  }
  smap_minus(smap_end(w, o->line), a, along);
  return !(smap_beside(p, a, along, band2) && smap_beside(q, a, along, band2));
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
  uint8_t end;
  *to = *from;
  for (end = 0; end < 2; end++) {
    to->rise[end] += smap_roll_over(w, roll, e, from->g[end], to->g[end]);
  }
  to->turned += roll[SMAP_ANGLE][0];
  to->spare = 0.0f;
  to->line = roll[SMAP_ANGLE][0] > SMAP_ONE_LINE ? w->twin[e] : from->line;
}

/* Let a gap roll on over edge e onto the rest there, for a part of the segment; 0 where it must not. */
static int smap_roll_on(smap_many_work_t *w, uint8_t e, const smap_held_t *o, const float span[2],
                        smap_held_t *next)
{
  const uint8_t back = w->twin[e];
  smap_row_t *roll;
  float turned;
  next->spare = 0.0f;
  if (smap_chord(&w->facet[w->owner[e]].at, &w->facet[w->owner[back]].at) + o->turned > w->map->rock_angle) {
    return 0;
  }
  roll = smap_roll(w, e);
  turned = o->turned + roll[SMAP_ANGLE][0];
  if (turned > w->map->rock_angle) {
    return 0;
  }
  if (smap_is_home(w, o, w->owner[back], turned)) { /* where it may, or may go on */
    smap_spare(next, smap_left_of(o, span));
    return 0;
  }
  smap_carry(w, roll, e, o, next);
  next->low = span[0] > o->low ? span[0] : o->low;
  next->high = span[1] < o->high ? span[1] : o->high;
  return 1;
}

/* Keep what the rest holds that the robot has come to over its edge `came`; no further way is looked into. */
static int smap_hold_last(smap_many_work_t *w, uint8_t came, smap_held_t *o)
{
  float span[2];
  uint8_t at;
  for (at = w->onward[came]; at != came && o->low < o->high && smap_may(w, SMAP_COST_VISIT);
       at = w->onward[at]) {
    if (smap_leaves(w, at, o, span)) {
      smap_give_up(w, o, at, span);
    }
  }
  return o->low < o->high;
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

/* Go on over edge e onto the rest there, and let go of what that does not hold. */
SMAP_APART static void smap_go_on(smap_many_work_t *w, uint8_t e, const float span[2], smap_held_t *o)
{
  smap_held_t next;
  const int held = smap_roll_on(w, e, o, span, &next) && smap_hold_last(w, w->twin[e], &next);
  smap_take_over(&next, held, span, o);
}

/* As smap_hold_last, or one rest further on. */
static int smap_hold_next(smap_many_work_t *w, uint8_t came, smap_held_t *o)
{
  float span[2];
  uint8_t at;
  for (at = w->onward[came]; at != came && o->low < o->high && smap_may(w, SMAP_COST_VISIT);
       at = w->onward[at]) {
    if (!smap_leaves(w, at, o, span)) {
      continue;
    }
    if (smap_kind_beyond(w, at) != SMAP_REST) {
      smap_give_up(w, o, at, span);
    } else if (smap_may(w, SMAP_COST_WAY)) {
      smap_go_on(w, at, span, o);
    }
  }
  return o->low < o->high;
}

/* As smap_go_on, or one rest further on. */
SMAP_APART static void smap_go_further(smap_many_work_t *w, uint8_t e, const float span[2], smap_held_t *o)
{
  smap_held_t next;
  const int held = smap_roll_on(w, e, o, span, &next) && smap_hold_next(w, w->twin[e], &next);
  smap_take_over(&next, held, span, o);
}

/* As smap_hold_last, or up to two rests further on.  Edges that lead to none come first: often nothing is left
 * to go on with. */
static void smap_hold_rest(smap_many_work_t *w, uint8_t came, smap_held_t *o)
{
  float span[2];
  uint8_t e;
  for (e = w->onward[came]; e != came && o->low < o->high && smap_may(w, SMAP_COST_VISIT);
       e = w->onward[e]) {
    if (smap_kind_beyond(w, e) != SMAP_REST && smap_leaves(w, e, o, span)) {
      smap_give_up(w, o, e, span);
    }
  }
  for (e = w->onward[came]; e != came && o->low < o->high && smap_may(w, SMAP_COST_VISIT);
       e = w->onward[e]) {
    if (smap_kind_beyond(w, e) == SMAP_REST && smap_leaves(w, e, o, span) && smap_may(w, SMAP_COST_WAY)) {
      smap_go_further(w, e, span, o);
    }
  }
}
