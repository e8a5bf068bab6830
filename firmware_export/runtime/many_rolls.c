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

/* The chord between two normals. */
static float smap_apart(const float a[3], const float b[3])
{
  float d[3], size2;
  smap_minus(a, b, d);
  size2 = smap_dot(d, d);
  return smap_root(size2 < 4.0f ? size2 : 4.0f); /* no number: as far as can be */
}

static float smap_chord(const smap_aim_t *a, const smap_aim_t *b)
{
  return smap_apart(a->n, b->n);
}

static float smap_angle(const smap_aim_t *a, const smap_aim_t *b)
{
  return 2.0f * smap_asin(0.5f * smap_chord(a, b));
}

/* The same of a step of a roll, at most 0.4 rad, to 1e-6 rad. */
static float smap_small_angle(const float a[3], const float b[3])
{
  const float chord = smap_apart(a, b), z = chord * chord;
  return chord + chord * z * (1.0f / 24.0f + z * (3.0f / 640.0f));
}

/* Two vectors across a normal, of any direction. */
static void smap_begin_across(const float n[3], float t[3], float b[3])
{
  const uint8_t k = n[0] * n[0] < 0.5f ? 0 : 1; /* an axis that is not along the normal */
  const float far = 1.0f / smap_root(1.0f - n[k] * n[k]);
  float axis[3] = {0.0f, 0.0f, 0.0f};
  axis[k] = far;
  smap_cross(n, axis, t);
  smap_cross(n, t, b);
}

/* Turn them by the least rotation from normal a to normal n, and by a small angle about n. */
static void smap_turn_across(const float a[3], const float n[3], float spin, smap_across_t *o)
{
  const float part = -smap_dot(n, o->t) / (1.0f + smap_dot(a, n)), left = 1.0f - 0.5f * spin * spin;
  uint8_t k;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o->t[k] += part * (a[k] + n[k]);
  }
  smap_cross(n, o->t, o->b);
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    const float t = o->t[k], b = o->b[k];
    o->t[k] = left * t + spin * b;
    o->b[k] = left * b - spin * t;
  }
}

/* Add p, q and r times the three places, as the frame on normal n sees it. */
static void smap_add_seen(const smap_bench_t *o, const float n[3], float p, float q, float r, float sum[3])
{
  float v[3];
  uint8_t k;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    v[k] = p * o->place[0][k] + q * o->place[1][k] + r * o->place[2][k];
  }
  sum[0] += smap_dot(o->turned.t, v);
  sum[1] += smap_dot(n, v);
  sum[2] += smap_dot(o->turned.b, v);
}

/* Roll two steps, from the bench's normal over b to c, over a contact that touches at its three places.
 *
 * The com's height over the contact is g . p; the ground's own changes by -g . dp: together the
 * integral of p . dg, both as parabolas through three values.  Places are from where the roll begins: what is left out
 * by that, with which a rise that is a hundredth of it would lose its digits, is that place . (g after - g before).
 * Where the arc is bent gravity turns about the normal by the solid angle between the arc and its chords (Archimedes). */
static float smap_roll_pair(smap_bench_t *o, const float b[3], const float c[3], float sum[3])
{
  const float *const a = o->normal;
  float side[3], spin, steps;
  smap_cross(b, c, side);
  spin = smap_dot(a, side) * (1.0f / 3.0f) / (1.0f + smap_dot(a, b) + smap_dot(b, c) + smap_dot(c, a));
  smap_add_seen(o, a, -0.5f, -2.0f / 3.0f, 1.0f / 6.0f, sum);
  smap_turn_across(a, b, spin, &o->turned);
  smap_add_seen(o, b, 2.0f / 3.0f, 0.0f, -2.0f / 3.0f, sum);
  smap_turn_across(b, c, spin, &o->turned);
  smap_add_seen(o, c, -1.0f / 6.0f, 2.0f / 3.0f, 0.5f, sum);
  steps = smap_small_angle(a, b) + smap_small_angle(b, c);
  steps += (steps - smap_small_angle(a, c)) * (1.0f / 3.0f);
  smap_copy(c, o->normal);
  smap_copy(o->place[2], o->place[0]);
  return steps;
}

/* Fill in what a roll does from its frame at its start, on normal a, which its first two rows hold, and that at the
 * end, on normal b, where it begins, and its rise but for that as they see it. */
static void smap_end_roll(const float a[3], const float b[3], const float origin[3], smap_bench_t *bench, smap_row_t *o)
{
  const smap_across_t *to = &bench->turned;
  float *const from_t = bench->place[0], *const from_b = bench->place[1]; /* places are no longer needed */
  float sum[3] = {o[SMAP_RISE][0], o[SMAP_RISE][1], o[SMAP_RISE][2]};
  uint8_t k, n;
  smap_copy(o[0], from_t);
  smap_copy(o[1], from_b);
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    sum[0] += origin[k] * (to->t[k] - from_t[k]);
    sum[1] += origin[k] * (b[k] - a[k]);
    sum[2] += origin[k] * (to->b[k] - from_b[k]);
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o[SMAP_RISE][k] = sum[0] * from_t[k] + sum[1] * a[k] + sum[2] * from_b[k];
    SMAP_THRICE
    for (n = 0; n < 3; n++) {
      o[k][n] = to->t[k] * from_t[n] + b[k] * a[n] + to->b[k] * from_b[n];
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
  const smap_aim_t *const from = &w->facet[w->owner[e]].at, *const to = &w->facet[w->owner[back]].at;
  smap_bench_t *const bench = w->bench;
  const float *origin = smap_corner(w, e);
  smap_aim_t half, there;
  uint8_t k, pairs = 200;
  smap_begin_across(from->n, o[0], o[1]);
  smap_copy(o[0], bench->turned.t);
  smap_copy(o[1], bench->turned.b);
  smap_copy(from->n, bench->normal);
  o[SMAP_RISE][0] = o[SMAP_RISE][1] = o[SMAP_RISE][2] = 0.0f;
  o[SMAP_ANGLE][0] = smap_angle(from, to);
  if (smap_is_still(w, i, j)) {
    /* Over two places that stay: one step, of any length. */
    smap_turn_across(from->n, to->n, 0.0f, &bench->turned);
  } else {
    const float own = smap_rim_chord(smap_corner(w, e), smap_end(w, back), w->r[i]);
    const float other = smap_rim_chord(smap_end(w, e), smap_corner(w, back), w->r[j]);
    const float angle = o[SMAP_ANGLE][0], beyond = (own > other ? own : other) - angle;
    uint8_t over = i;
    float uneven, second;
    smap_on_arc(w, i, j, from, to, 0.5f, &half);
    uneven = smap_unevenness(w, i, from, &half, to);
    second = SMAP_MANY_RAILS && w->r[i] > 0.0f ? uneven : smap_unevenness(w, j, from, &half, to);
    uneven = (uneven > second ? uneven : second) * SMAP_PAIRS * (beyond > angle ? beyond : angle);
    if (uneven >= 0.0f && uneven < 199.0f) {
      pairs = (uint8_t)(1.0f + uneven);
    }
    if (own * w->r[i] > other * w->r[j]) {
      /* Both tell how far the com rises; the other one's contact goes a shorter way. */
      over = j;
      origin = smap_end(w, e);
    }
    o[SMAP_ANGLE][0] = bench->place[0][0] = bench->place[0][1] = bench->place[0][2] = 0.0f;
    for (k = 1; k <= pairs && smap_may(w, SMAP_COST_PAIR); k++) {
      if (pairs > 1) {
        smap_on_arc(w, i, j, from, to, ((float)k - 0.5f) / (float)pairs, &half);
      }
      there = *to;
      if (k < pairs) {
        smap_on_arc(w, i, j, from, to, (float)k / (float)pairs, &there);
      }
      smap_touch(w, over, &half, bench->place[1]);
      smap_touch(w, over, &there, bench->place[2]);
      smap_minus(bench->place[1], origin, bench->place[1]);
      smap_minus(bench->place[2], origin, bench->place[2]);
      o[SMAP_ANGLE][0] += smap_roll_pair(bench, half.n, there.n, o[SMAP_RISE]);
    }
  }
  smap_end_roll(from->n, to->n, origin, bench, o);
}

/* A roll for which no work is left: the pose fails, or its gap is given up. */
SMAP_APART static void smap_no_roll(smap_row_t *o)
{
  memset(o, 0, sizeof(smap_row_t) * SMAP_ROLL);
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
  if (k >= SMAP_MANY_ROLLS) { /* it is not kept */
    k = w->rolls;
    if (k + 1 < SMAP_MOST(w->map, links, SMAP_MANY_LINKS) / SMAP_ROLL) {
      w->roll_of[e] = k;
      w->rolls = (uint8_t)(k + 1u);
    }
    if (smap_may(w, SMAP_COST_ROLL)) {
      smap_find_roll(w, e, w->roll + SMAP_ROLL * k);
    } else {
      smap_no_roll(w->roll + SMAP_ROLL * k);
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
