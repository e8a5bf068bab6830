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

/* One step of a roll over contact i: append it to the map. */
static void smap_roll_step(const smap_many_work_t *w, uint8_t i, const smap_aim_t *a,
                           const smap_aim_t *b, smap_roll_t *o)
{
  float about[3], back[3], half[3], p[3], lever[3], pull[3], sine2, along, size, ratio, v[3];
  smap_aim_t middle;
  uint8_t k, n;
  smap_cross(a->n, b->n, about);
  sine2 = smap_dot(about, about);
  along = smap_dot(a->n, b->n);
  for (k = 0; k < 3; k++) {
    half[k] = a->n[k] + b->n[k];
    back[k] = -about[k];
  }
  ratio = 1.0f + sine2 * (1.0f / 6.0f) + sine2 * sine2 * (3.0f / 40.0f); /* angle / sine */
  smap_touch(w, i, a, p);
  smap_cross(about, p, pull);
  smap_touch(w, i, b, p);
  smap_cross(about, p, lever);
  smap_add_turned(back, along, lever, 1.0f, pull);
  smap_aim(&middle, half);
  smap_touch(w, i, &middle, p);
  smap_cross(about, p, lever);
  size = 1.0f / smap_root(2.0f + 2.0f * along);
  for (k = 0; k < 3; k++) {
    back[k] *= size; /* half x a = -about / |a + b| */
  }
  smap_add_turned(back, smap_root(0.5f + 0.5f * along), lever, 4.0f, pull);
  for (n = 0; n < 3; n++) {
    o->rise[n] -= ratio * (1.0f / 6.0f) *
                  (o->turn[0][n] * pull[0] + o->turn[1][n] * pull[1] + o->turn[2][n] * pull[2]);
  }
  for (n = 0; n < 3; n++) {
    for (k = 0; k < 3; k++) {
      v[k] = o->turn[k][n];
      pull[k] = 0.0f;
    }
    smap_add_turned(about, along, v, 1.0f, pull);
    for (k = 0; k < 3; k++) {
      o->turn[k][n] = pull[k];
    }
  }
  o->angle += ratio * smap_root(sine2);
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
    smap_roll_step(w, i, &here, &there, o);
    here = there;
  }
}

/* The roll back: the inverse of a map is its transpose. */
static void smap_reverse(smap_roll_t *o)
{
  float rise[3], t;
  uint8_t k, n;
  for (k = 0; k < 3; k++) {
    rise[k] = -smap_dot(o->turn[k], o->rise);
  }
  for (k = 0; k < 3; k++) {
    o->rise[k] = rise[k];
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
