/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- rolling from one facet onto the next ------------------------------------------------------------ */
/* Rolling over two contacts from one facet onto the next.
 *
 * While the robot rolls gravity turns in the body by the least rotation from one normal to the next,
 * and the com rises by a length that is linear in gravity: one small map per arc tells it for all
 * balances, there and back.  Turned along is a frame on the normal: what its two vectors across the
 * normal become tells what becomes of every vector.
 */
#define SMAP_PAIRS 2.5f /* pairs of steps of a roll per rad, as in the exact definition, */
#define SMAP_UNEVEN 1.5f /* and more from this ratio of a disc's paces along its rim on, */
#define SMAP_MOST_UNEVEN 16.0f /* up to so many times */

static float smap_chord(const smap_aim_t *a, const smap_aim_t *b)
{
  float d[3], size2;
  smap_minus(a->n, b->n, d);
  size2 = smap_dot(d, d);
  return smap_root(size2 < 4.0f ? size2 : 4.0f); /* no number: as far as can be */
}

static float smap_angle(const smap_aim_t *a, const smap_aim_t *b)
{
  return 2.0f * smap_asin(0.5f * smap_chord(a, b));
}

/* The same of a step of a roll, at most 0.4 rad, to 1e-6 rad. */
static float smap_small_angle(const smap_aim_t *a, const smap_aim_t *b)
{
  const float chord = smap_chord(a, b), z = chord * chord;
  return chord + chord * z * (1.0f / 24.0f + z * (3.0f / 640.0f));
}

/* Two unit vectors across a normal. */
typedef struct {
  float t[3], b[3];
} smap_across_t;

/* Two of them, of any direction. */
static void smap_begin_across(const float n[3], smap_across_t *o)
{
  const uint8_t k = n[0] * n[0] < 0.5f ? 0 : 1; /* an axis that is not along the normal */
  const float far = 1.0f / smap_root(1.0f - n[k] * n[k]);
  float axis[3] = {0.0f, 0.0f, 0.0f};
  axis[k] = far;
  smap_cross(n, axis, o->t);
  smap_cross(n, o->t, o->b);
}

/* Turn them by the least rotation from normal a to normal n, and by a small angle about n. */
static void smap_turn_across(const float a[3], const float n[3], float spin, smap_across_t *o)
{
  const float part = -smap_dot(n, o->t) / (1.0f + smap_dot(a, n)), left = 1.0f - 0.5f * spin * spin;
  float t[3], b[3];
  uint8_t k;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    t[k] = o->t[k] + part * (a[k] + n[k]);
  }
  smap_cross(n, t, b);
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o->t[k] = left * t[k] + spin * b[k];
    o->b[k] = left * b[k] - spin * t[k];
  }
}

/* Add p u + q v + r x of three places, as the frame on normal n sees it. */
static void smap_add_seen(const smap_across_t *o, const float n[3], const float (*place)[3], float p,
                          float q, float r, float sum[3])
{
  float v[3];
  uint8_t k;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    v[k] = p * place[0][k] + q * place[1][k] + r * place[2][k];
  }
  sum[0] += smap_dot(o->t, v);
  sum[1] += smap_dot(n, v);
  sum[2] += smap_dot(o->b, v);
}

/* Roll two steps, from normal a over b to c, over a contact that touches at three places.
 *
 * The com's height over the contact is g . p; the ground's own changes by -g . dp: together the
 * integral of p . dg, both as parabolas through three values.  Where the arc is bent gravity turns
 * about the normal by the solid angle between the arc and its chords (Archimedes). */
static float smap_roll_pair(const float (*place)[3], const smap_aim_t *a, const smap_aim_t *b,
                            const smap_aim_t *c, smap_across_t *o, float sum[3])
{
  float side[3], spin, steps;
  smap_cross(b->n, c->n, side);
  spin = smap_dot(a->n, side) * (1.0f / 3.0f) /
         (1.0f + smap_dot(a->n, b->n) + smap_dot(b->n, c->n) + smap_dot(c->n, a->n));
  smap_add_seen(o, a->n, place, -0.5f, -2.0f / 3.0f, 1.0f / 6.0f, sum);
  smap_turn_across(a->n, b->n, spin, o);
  smap_add_seen(o, b->n, place, 2.0f / 3.0f, 0.0f, -2.0f / 3.0f, sum);
  smap_turn_across(b->n, c->n, spin, o);
  smap_add_seen(o, c->n, place, -1.0f / 6.0f, 2.0f / 3.0f, 0.5f, sum);
  steps = smap_small_angle(a, b) + smap_small_angle(b, c);
  return steps + (steps - smap_small_angle(a, c)) * (1.0f / 3.0f);
}

/* Fill in what a roll does from its frames at both ends and its rise as they see it. */
static void smap_end_roll(const float a[3], const smap_across_t *from, const float b[3],
                          const smap_across_t *to, const float sum[3], smap_row_t *o)
{
  uint8_t k, n;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o[SMAP_RISE][k] = sum[0] * from->t[k] + sum[1] * a[k] + sum[2] * from->b[k];
    SMAP_THRICE
    for (n = 0; n < 3; n++) {
      o[k][n] = to->t[k] * from->t[n] + b[k] * a[n] + to->b[k] * from->b[n];
    }
  }
}

/* How far a contact goes along its rim, as a chord over the radius, 0 to 2: on a wheel that lies nearly
 * flat many times as much as the plane turns. */
static float smap_rim_chord(const float p[3], const float q[3], float radius)
{
  float d[3], chord;
  if (!(radius > 0.0f)) {
    return 0.0f;
  }
  smap_minus(p, q, d);
  chord = smap_root(smap_dot(d, d)) / radius;
  return chord < 2.0f ? chord : 2.0f; /* no number: as far as can be */
}

/* By how many times the pace of a contact along its rim changes between three planes: a disc's pace is
 * that of the plane over the sine between the plane's normal and its axle. */
static float smap_unevenness(const smap_many_work_t *w, uint8_t i, const smap_aim_t *from,
                             const smap_aim_t *half, const smap_aim_t *to)
{
  const float a = smap_sine2_to_axle(w, i, from), b = smap_sine2_to_axle(w, i, half);
  const float c = smap_sine2_to_axle(w, i, to);
  float most = a > b ? a : b, least = a < b ? a : b;
  most = c > most ? c : most;
  least = c < least ? c : least;
  if (most <= SMAP_UNEVEN * SMAP_UNEVEN * least) {
    return 1.0f;
  }
  most = smap_root(most / (least > 1e-6f ? least : 1e-6f));
  return most < SMAP_MOST_UNEVEN ? most : SMAP_MOST_UNEVEN;
}

/* The map of a roll over an edge onto the facet beyond. */
SMAP_APART static void smap_find_roll(smap_many_work_t *w, uint8_t e, smap_row_t *o)
{
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]], back = w->twin[e];
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[back]].at;
  smap_aim_t here = *from, half, there;
  smap_across_t first, last;
  float sum[3] = {0.0f, 0.0f, 0.0f}, place[3][3];
  uint8_t k, pairs;
  smap_begin_across(from->n, &first);
  last = first;
  o[SMAP_ANGLE][0] = smap_angle(from, to);
  smap_copy(smap_corner(w, e), place[0]);
  if (smap_is_still(w, i, j)) {
    /* Over two places that stay: one step, of any length. */
    smap_copy(smap_end(w, back), place[1]);
    smap_copy(place[1], place[2]);
    smap_add_seen(&last, from->n, (const float(*)[3])place, -1.0f, 0.0f, 0.0f, sum);
    smap_turn_across(from->n, to->n, 0.0f, &last);
    smap_add_seen(&last, to->n, (const float(*)[3])place, 0.0f, 0.0f, 1.0f, sum);
  } else {
    const float own = smap_rim_chord(smap_corner(w, e), smap_end(w, back), w->r[i]);
    const float other = smap_rim_chord(smap_end(w, e), smap_corner(w, back), w->r[j]);
    const float angle = o[SMAP_ANGLE][0], beyond = (own > other ? own : other) - angle;
    uint8_t over = i;
    float uneven, second;
    smap_on_arc(w, i, j, from, to, 0.5f, &half);
    uneven = smap_unevenness(w, i, from, &half, to);
    second = smap_unevenness(w, j, from, &half, to);
    uneven = (uneven > second ? uneven : second) * SMAP_PAIRS * (beyond > angle ? beyond : angle);
    pairs = (uint8_t)(uneven < 199.0f ? 1.0f + uneven : 200.0f);
    if (own * w->r[i] > other * w->r[j]) {
      /* Both tell how far the com rises; the other one's contact goes a shorter way. */
      over = j;
      smap_copy(smap_end(w, e), place[0]);
    }
    o[SMAP_ANGLE][0] = 0.0f;
    for (k = 1; k <= pairs && smap_may(w, SMAP_COST_PAIR); k++) {
      if (pairs > 1) {
        smap_on_arc(w, i, j, from, to, ((float)k - 0.5f) / (float)pairs, &half);
      }
      there = *to;
      if (k < pairs) {
        smap_on_arc(w, i, j, from, to, (float)k / (float)pairs, &there);
      }
      smap_touch(w, over, &half, place[1]);
      smap_touch(w, over, &there, place[2]);
      o[SMAP_ANGLE][0] += smap_roll_pair((const float(*)[3])place, &here, &half, &there, &last, sum);
      smap_copy(place[2], place[0]);
      here = there;
    }
  }
  smap_end_roll(from->n, &first, to->n, &last, sum, o);
}

/* The roll over an edge onto the facet beyond; each arc's is found once, and is good until the next
 * one is asked for.  It is that over the lesser of the arc's two edges. */
static smap_row_t *smap_roll(smap_many_work_t *w, uint8_t e)
{
  uint8_t k;
  if (w->twin[e] < e) {
    e = w->twin[e];
  }
  k = w->roll_of[e];
  if (k == SMAP_NONE) {
    k = w->rolls;
    if (k + 1 < SMAP_MOST(w->map, links, SMAP_MANY_LINKS) / SMAP_ROLL) {
      w->roll_of[e] = w->rolls++;
    }
    if (smap_may(w, SMAP_COST_ROLL)) {
      smap_find_roll(w, e, w->roll + SMAP_ROLL * k);
    } else {
      memset(w->roll + SMAP_ROLL * k, 0, sizeof(smap_row_t) * SMAP_ROLL);
    }
  }
  return w->roll + SMAP_ROLL * k;
}

/* Turn gravity along a roll over edge e, or back over it, and return by how much the com rises. */
static float smap_roll_over(const smap_many_work_t *w, smap_row_t *o, uint8_t e,
                            const float g[3], float out[3])
{
  uint8_t k;
  if (w->twin[e] > e) {
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      out[k] = smap_dot(o[k], g);
    }
    return smap_dot(o[SMAP_RISE], g);
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    out[k] = o[0][k] * g[0] + o[1][k] * g[1] + o[2][k] * g[2];
  }
  return -smap_dot(o[SMAP_RISE], out);
}
