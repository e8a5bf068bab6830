/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- rolling from one facet onto the next ------------------------------------------------------------ */
/* Rolling over two contacts from one facet onto the next.
 *
 * While the robot rolls gravity turns in the body by the least rotation from one normal to the next,
 * and the com rises by a length that is linear in gravity: one small map per arc tells it for all
 * balances.
 */
#define SMAP_STEP 5.0f /* steps of a roll per rad, as in the exact definition */

/* Add the vector `v` turned by the least rotation from a to b, `about` = a x b, times `scale`. */
static void smap_add_turned(const float about[3], float along, const float v[3], float scale,
                            float out[3])
{
  float once[3], twice[3];
  uint8_t k;
  smap_cross(about, v, once);
  smap_cross(about, once, twice);
  along = 1.0f / (1.0f + along);
  for (k = 0; k < 3; k++) {
    out[k] += scale * (v[k] + once[k] + twice[k] * along);
  }
}

/* One step of a roll: the turn from a to b, and half of it back. */
typedef struct {
  const smap_aim_t *a, *b;
  smap_aim_t middle;
  float about[3], back[3], half[3], along, half_along, ratio;
} smap_step_t;

static void smap_begin_step(smap_step_t *o, const smap_aim_t *a, const smap_aim_t *b)
{
  float sum[3], sine2, size;
  uint8_t k;
  o->a = a;
  o->b = b;
  smap_cross(a->n, b->n, o->about);
  sine2 = smap_dot(o->about, o->about);
  o->along = smap_dot(a->n, b->n);
  o->half_along = smap_root(0.5f + 0.5f * o->along);
  size = 0.5f / o->half_along;
  for (k = 0; k < 3; k++) {
    sum[k] = a->n[k] + b->n[k];
    o->back[k] = -o->about[k];
    o->half[k] = o->back[k] * size; /* half x a = -about / |a + b| */
  }
  smap_aim(&o->middle, sum);
  o->ratio = 1.0f + sine2 * (1.0f / 6.0f) + sine2 * sine2 * (3.0f / 40.0f); /* angle / sine */
}

/* Add to the rise that of a step over a contact: by Simpson, gravity turning along. */
static void smap_rise_step(const smap_many_work_t *w, const smap_step_t *o, uint8_t contact,
                           float (*turn)[3], float rise[3])
{
  float p[3], lever[3], pull[3];
  uint8_t n;
  smap_touch(w, contact, o->a, p);
  smap_cross(o->about, p, pull);
  smap_touch(w, contact, o->b, p);
  smap_cross(o->about, p, lever);
  smap_add_turned(o->back, o->along, lever, 1.0f, pull);
  smap_touch(w, contact, &o->middle, p);
  smap_cross(o->about, p, lever);
  smap_add_turned(o->half, o->half_along, lever, 4.0f, pull);
  for (n = 0; n < 3; n++) {
    rise[n] -= o->ratio * (1.0f / 6.0f) *
               (turn[0][n] * pull[0] + turn[1][n] * pull[1] + turn[2][n] * pull[2]);
  }
}

/* Append a step to a map. */
static void smap_turn_step(const smap_step_t *o, smap_roll_t *roll)
{
  float v[3], sum[3];
  uint8_t k, n;
  for (n = 0; n < 3; n++) {
    for (k = 0; k < 3; k++) {
      v[k] = roll->turn[k][n];
      sum[k] = 0.0f;
    }
    smap_add_turned(o->about, o->along, v, 1.0f, sum);
    for (k = 0; k < 3; k++) {
      roll->turn[k][n] = sum[k];
    }
  }
  roll->angle += o->ratio * smap_root(smap_dot(o->about, o->about));
}

static float smap_chord(const smap_aim_t *a, const smap_aim_t *b)
{
  float d[3], size2;
  smap_minus(a->n, b->n, d);
  size2 = smap_dot(d, d);
  return smap_root(size2 < 4.0f ? size2 : 4.0f); /* no number: as far as can be */
}

/* The map of a roll over an edge onto the facet beyond. */
static void smap_find_roll(const smap_many_work_t *w, uint8_t e, smap_roll_t *o)
{
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[w->twin[e]]].at;
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  const float chord = smap_chord(from, to);
  smap_aim_t here = *from, there;
  smap_step_t step;
  uint8_t k, steps;
  memset(o, 0, sizeof *o);
  o->turn[0][0] = o->turn[1][1] = o->turn[2][2] = 1.0f;
  steps = (uint8_t)(1.0f + SMAP_STEP * chord * (1.0f + chord * chord * (1.0f / 24.0f)));
  for (k = 1; k <= steps; k++) {
    if (k == steps) {
      there = *to;
    } else {
      smap_on_arc(w, i, j, from, to, (float)k / (float)steps, &there);
    }
    smap_begin_step(&step, &here, &there);
    smap_rise_step(w, &step, i, o->turn, o->rise);
    smap_rise_step(w, &step, j, o->turn, o->other);
    smap_turn_step(&step, o);
    here = there;
  }
}

/* The roll back, over the other contact: the inverse of a map is its transpose. */
static void smap_reverse(smap_roll_t *o)
{
  float rise[3], other[3], t;
  uint8_t k, n;
  for (k = 0; k < 3; k++) {
    rise[k] = -smap_dot(o->turn[k], o->other);
    other[k] = -smap_dot(o->turn[k], o->rise);
  }
  for (k = 0; k < 3; k++) {
    o->rise[k] = rise[k];
    o->other[k] = other[k];
    for (n = 0; n < k; n++) {
      t = o->turn[k][n];
      o->turn[k][n] = o->turn[n][k];
      o->turn[n][k] = t;
    }
  }
}

/* Find the roll over an edge onto the facet beyond; each arc's is found once. */
static void smap_roll(smap_many_work_t *w, uint8_t e, smap_roll_t *o)
{
  const uint8_t back = w->twin[e];
  uint8_t k;
  if (w->roll_of[back] != SMAP_NONE) {
    *o = w->roll[w->roll_of[back]];
    smap_reverse(o);
    return;
  }
  if (w->roll_of[e] == SMAP_NONE) {
    k = w->rolls < SMAP_MANY_ARCS ? w->rolls++ : (uint8_t)(SMAP_MANY_ARCS - 1u);
    smap_find_roll(w, e, &w->roll[k]);
    if (k + 1u < SMAP_MANY_ARCS) {
      w->roll_of[e] = k;
    }
    *o = w->roll[k];
    return;
  }
  *o = w->roll[w->roll_of[e]];
}
