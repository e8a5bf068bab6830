/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- roll: a plane rolls over contacts of any kind --------------------------------------------------- */
/* A plane that touches three contacts is a fixed point of Newton's method, which takes the plane through the places
 * where they touch the plane before. */
#define SMAP_TOUCHES 3e-6f  /* of the size: nearer to a plane a contact touches it */
#define SMAP_NOISY 2e-6f    /* of the size: by as much it may be below; */
#define SMAP_NOISIER 1e-5f  /* by this where of two each is below the plane of the other */
#define SMAP_PARALLEL 1e-4f /* rad: planes on three contacts of a facet that differ by less are one */
#define SMAP_NEWTON 8       /* rounds, of which */
#define SMAP_SETTLED 1e-6f  /* the last changes a normal's square by less */
#define SMAP_ROLL_TRIES 6   /* contacts that a roll may come to before the first that touches is found */
#define SMAP_STEPS_MOST 8   /* of half a radian, while a plane rolls over what is round */
#define SMAP_STEP_COT 1.8304877f /* cotangent, cosine and sine of a step */
#define SMAP_STEP_COS 0.87758256f
#define SMAP_STEP_SIN 0.47942554f
#define SMAP_HIGHEST 0.3f   /* cosine: facets that face up as much are not looked for */

typedef struct {
  float n[3];
  uint8_t count, first, id[SMAP_MAX_SIDES]; /* first: its first corner as a rest, or SMAP_NONE */
} smap_facet_t;

/* Where all contacts touch the plane that is looked at, and that of the facet over whose edges it rolls. */
typedef struct {
  smap_work_t *w;
  uint8_t facets, all; /* all: facets that face up lead on, too */
  float there[SMAP_MAX_CONTACTS][3], here[SMAP_MAX_CONTACTS][3];
  smap_facet_t facet[SMAP_MAX_FACETS];
} smap_search_t;

/* Find where all contacts touch a plane, and which of them, but for three, is furthest below it; SMAP_NONE: none. */
static uint8_t smap_survey(smap_search_t *s, const float n[3], uint8_t i, uint8_t j, uint8_t k, float noise)
{
  float most = noise * SMAP_SIZE(s->w), level, reach[SMAP_DISCS > 0 ? SMAP_DISCS : 1][3];
  uint8_t l, worst = SMAP_NONE;
  for (l = 0; l < s->w->axles; l++) {
    smap_reach(SMAP_AXLES(s->w)[l], n, reach[l]);
  }
  smap_touch(s->w, i, n, s->there[i]);
  level = smap_dot(s->there[i], n);
  for (l = 0; l < SMAP_CONTACTS(s->w); l++) {
    float below;
    smap_plus(s->w->p[l], s->w->r[l], smap_is_disc(s->w, l) ? reach[s->w->axle_of[l]] : n, s->there[l]);
    below = smap_dot(s->there[l], n) - level;
    if (l != i && l != j && l != k && below > most) {
      most = below;
      worst = l;
    }
  }
  return worst;
}

/* Turn n until the plane touches i and j, and k, too, or, where k is none, is at a right angle to d; 0 where that
 * fails. */
static int smap_settle(const smap_work_t *w, uint8_t i, uint8_t j, uint8_t k, const float d[3], float n[3])
{
  const uint8_t other = k != SMAP_NONE ? k : j;
  const int alike = !smap_is_disc(w, i) && !smap_is_disc(w, j) && !smap_is_disc(w, other) && w->r[i] == w->r[j] &&
                    w->r[i] == w->r[other]; /* the plane is as their centres' */
  uint8_t left;
  for (left = SMAP_NEWTON; left > 0; left--) {
    float a[3], b[3], c[3], m[3];
    smap_touch(w, i, n, a);
    smap_touch(w, j, n, b);
    smap_minus(b, a, b);
    if (k != SMAP_NONE) {
      smap_touch(w, k, n, c);
      smap_minus(c, a, c);
    }
    smap_cross(b, k != SMAP_NONE ? c : d, m);
    if (!smap_unit(m)) {
      return 0;
    }
    if (smap_dot(m, n) < 0.0f) {
      m[0] = -m[0];
      m[1] = -m[1];
      m[2] = -m[2];
    }
    smap_minus(m, n, a);
    memcpy(n, m, sizeof m);
    if (alike || !(smap_dot(a, a) > SMAP_SETTLED)) { /* the next step would be of its square */
      return 1;
    }
  }
  return 0;
}

/* The contact that a plane with normal n comes to first if none moves, on i and turned towards t, but for those that
 * are marked, and the cotangent of the angle. */
static uint8_t smap_first(const smap_search_t *s, uint8_t i, uint8_t j, const float n[3], const float t[3],
                          const uint8_t *skip, float *cotangent)
{
  const float size = SMAP_SIZE(s->w), touches = SMAP_TOUCHES * size;
  uint8_t l, to = SMAP_NONE;
  *cotangent = -SMAP_LARGEST;
  for (l = 0; l < SMAP_CONTACTS(s->w); l++) {
    float b[3], lever, low;
    if (l == i || l == j || skip[l]) {
      continue;
    }
    smap_minus(s->there[l], s->there[i], b);
    lever = smap_dot(t, b);
    low = -smap_dot(n, b);
    if (low < touches) {
      if (lever < 1e-3f * size) {
        continue;
      }
      low = 1e-3f * touches;
    }
    if (lever > *cotangent * low) {
      *cotangent = lever / low;
      to = l;
    }
  }
  return to;
}

/* Tells whether nothing is ahead of a plane with normal n on i and j that it may touch before it faces up; 0 where a
 * turn by a right angle and a little more does not do that.  A round contact goes on as those do on which it rolls,
 * but for its own radius and what is between theirs. */
static int smap_is_last(const smap_search_t *s, uint8_t i, uint8_t j, const float n[3], const float t[3])
{
  const float *const r = s->w->r;
  const float least = r[i] < r[j] ? r[i] : r[j];
  uint8_t l;
  if (0.95f * t[2] - 0.3f * n[2] < 0.0f) {
    return 0;
  }
  for (l = 0; l < SMAP_CONTACTS(s->w); l++) {
    const float reach = r[l] + (r[l] > least ? 3.0f * (r[l] - least) : 0.0f);
    float b[3];
    smap_minus(s->there[l], s->there[i], b);
    if (l != i && l != j && 0.95f * smap_dot(t, b) - 0.3f * smap_dot(n, b) + reach > 0.0f) {
      return 0;
    }
  }
  return 1;
}

/* Turn the plane n towards t by a step, on i and j, which move as it turns: `start` is what comes of it.  0 where it
 * faces up too far, or none is found. */
static int smap_turn_on(const smap_work_t *w, uint8_t i, uint8_t j, const float n[3], const float t[3], float limit,
                     float start[3])
{
  float across[3];
  uint8_t k;
  for (k = 0; k < 3; k++) {
    start[k] = n[k] * SMAP_STEP_COS + t[k] * SMAP_STEP_SIN;
    across[k] = t[k] * SMAP_STEP_COS - n[k] * SMAP_STEP_SIN;
  }
  return start[2] <= limit && smap_settle(w, i, j, SMAP_NONE, across, start);
}

/* Tilt the plane n, whose places are there, towards t, rolling on i and j, until another contact touches; of i alone, j
 * none, at a right angle to d.  Returns that contact, or SMAP_NONE. */
static uint8_t smap_tilt(smap_search_t *s, uint8_t i, uint8_t j, const float d[3], const float toward[3], float n[3])
{
  const smap_work_t *const w = s->w;
  const float limit = s->all ? 2.0f : SMAP_HIGHEST;
  const int round = j != SMAP_NONE && (w->r[i] > 0.0f || w->r[j] > 0.0f);
  float t[3] = {toward[0], toward[1], toward[2]}, start[3], c;
  uint8_t skip[SMAP_MAX_CONTACTS] = {0}, left, to, tries;
  if (round && !s->all && smap_is_last(s, i, j, n, t)) {
    return SMAP_NONE;
  }
  for (left = SMAP_STEPS_MOST; left > 0; left--) {
    to = smap_first(s, i, j, n, t, skip, &c);
    if (to == SMAP_NONE) {
      return SMAP_NONE;
    }
    if (!round || c > SMAP_STEP_COT) {
      smap_plus(t, c < 1e4f ? c : 1e4f, n, start);
      (void)smap_unit(start);
    } else {
      if (!smap_turn_on(w, i, j, n, t, limit, start)) {
        return SMAP_NONE;
      }
      to = smap_survey(s, start, i, j, SMAP_NONE, SMAP_NOISY);
      if (to == SMAP_NONE) {
        memcpy(n, start, sizeof start);
        smap_minus(s->there[j], s->there[i], start);
        smap_cross(n, start, t);
        if (!smap_unit(t)) {
          return SMAP_NONE;
        }
        continue;
      }
    }
    if (start[2] > limit) {
      return SMAP_NONE; /* no rest is so far up */
    }
    for (tries = SMAP_ROLL_TRIES; tries > 0; tries--) {
      float m[3] = {start[0], start[1], start[2]};
      const uint8_t second = j == SMAP_NONE ? to : j, third = j == SMAP_NONE ? j : to;
      uint8_t worst;
      if (!smap_settle(w, i, second, third, d, m)) { /* it all but touches where another does */
        skip[to] = 1;
        (void)smap_survey(s, n, i, j, SMAP_NONE, SMAP_NOISY);
        break;
      }
      worst = smap_survey(s, m, i, j, to, tries > 2 ? SMAP_NOISY : SMAP_NOISIER);
      if (worst == SMAP_NONE) {
        memcpy(n, m, sizeof m);
        return smap_dot(n, t) > -SMAP_PARALLEL ? to : (uint8_t)SMAP_NONE;
      }
      to = worst;
    }
    if (tries == 0) {
      return SMAP_NONE;
    }
  }
  return SMAP_NONE;
}
