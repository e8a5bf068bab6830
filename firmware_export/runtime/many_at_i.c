/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- reading many contacts without float ------------------------------------------------------------- */
/* One direction of gravity against a pose, without float: raw counts of an accelerometer.
 *
 * Walls, planes and arcs are int16, 32767 for 1; products with gravity are summed in int32, which
 * they never leave, since both are at most 32768 sqrt(3) and 32767 long.
 */
#define SMAP_MANY_AT_I 1
#define SMAP_ONE_I 32767
#define SMAP_ROUNDED_I 1.6e-4f /* sine that rounding may alter: of walls, and to a step of 1 / 16384 twice */

typedef struct {
  uint8_t shift;     /* of D: see smap_many_make_i */
  uint16_t mantissa; /* of D */
  int16_t guard;
  uint16_t height[SMAP_MANY_RESTS];
  int16_t plane[SMAP_MANY_RESTS][3];
  int16_t centre[SMAP_MANY_RESTS][3]; /* in two steps of sdg */
  int16_t wall[SMAP_WALLS][3];
  int16_t amid[SMAP_MANY_ARCS][3], along[SMAP_MANY_ARCS][3];
} smap_many_pose_i_t;

/* The nearest whole number of what is less than 2^22: the last digits of a sum whose last is worth 1. */
static inline int16_t smap_whole_i(float x)
{
  return (int16_t)(int32_t)(smap_bits(x + 12582912.0f) - 0x4B400000u);
}

/* The same of what may be beyond int16: that becomes the last one. */
static void smap_scale_i(const float from[3], float scale, int16_t to[3])
{
  uint8_t k;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    const float x = from[k] * scale;
    to[k] = smap_whole_i(x < 32767.0f ? x > -32767.0f ? x : -32767.0f : 32767.0f);
  }
}

/* The same of vectors of which no component is beyond 1 / scale, times 32767. */
static inline void smap_units_i(const float (*from)[3], uint8_t n, float scale, int16_t (*to)[3])
{
  uint8_t i, k;
  for (i = 0; i < n; i++) {
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      to[i][k] = smap_whole_i(from[i][k] * scale);
    }
  }
}

/* The same from 0 to `most`, which is at most 65535. */
static inline uint16_t smap_steps_i(float x, float most)
{
  return (uint16_t)smap_whole_i(x < most ? x : most);
}

/* Make the integer form of a pose. */
static void smap_many_make_i(const smap_many_pose_t *o, float sdg_step, float height_step,
                             smap_many_pose_i_t *i)
{
  float least = 0.0f, factor;
  uint8_t k;
  if (!o->at.alive || !o->at.rests) {
    return;
  }
  for (k = 0; k < o->at.rests; k++) {
    least = k == 0 || o->height[k] < least ? o->height[k] : least;
    i->height[k] = smap_steps_i(o->height[k] / height_step, 65534.0f);
  }
  for (k = 0; k < o->at.rests; k++) {
    smap_scale_i(o->centre[k], 0.5f / sdg_step, i->centre[k]);
  }
  smap_units_i(o->plane, o->at.rests, (float)SMAP_ONE_I * least, i->plane); /* n / h: the greatest is 1 */
  smap_units_i(o->wall, o->at.edge[o->at.rests], (float)SMAP_ONE_I, i->wall);
  smap_units_i(o->wall + SMAP_MANY_CORNERS, (uint8_t)(2u * o->at.gaps), (float)SMAP_ONE_I, i->wall + SMAP_MANY_CORNERS);
  smap_units_i(o->amid, o->at.arcs, (float)SMAP_ONE_I, i->amid);
  smap_units_i(o->along, o->at.arcs, (float)SMAP_ONE_I, i->along);
  /* D = g 32767 least / (2 sdg_step) / (plane . g) = g (mantissa 2^16 / (plane . g >> shift)) / 2^15 */
  factor = (float)SMAP_ONE_I * least * 0.5f / sdg_step;
  k = (uint8_t)(smap_bits(factor) >> 23);
  i->shift = (uint8_t)(k > 143 && k < 173 ? k - 143 : 0); /* so that it is less than 2^17 */
  factor = smap_from_bits(smap_bits(factor) - ((uint32_t)i->shift << 23)) * 0.5f;
  i->mantissa = smap_steps_i(factor, 65535.0f);
  i->guard = (int16_t)((o->guard + SMAP_ROUNDED_I) * (float)SMAP_ONE_I + 1.0f);
}

static inline int32_t smap_dot_i(const int16_t a[3], const int32_t b[3])
{
  /* Summed without sign: only walls of a damaged map can be too long, and they may wrap. */
  return (int32_t)((uint32_t)(a[0] * b[0]) + (uint32_t)(a[1] * b[1]) + (uint32_t)(a[2] * b[2]));
}

static inline int32_t smap_square_i(const int16_t a[3])
{
  const int32_t b[3] = {a[0], a[1], a[2]};
  return smap_dot_i(a, b);
}

/* As smap_inside; 32767 |g| times the sine. */
static int32_t smap_inside_i(const smap_layout_t *at, const smap_many_pose_i_t *o, uint8_t rest, const int32_t g[3],
                             int32_t least, uint8_t *which)
{
  const uint8_t end = at->edge[rest + 1];
  const int32_t h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  uint8_t e;
  *which = at->edge[rest];
  for (e = *which; e < end; e++) {
    const int32_t in = smap_dot_i(o->wall[e], h);
    if (in < least) {
      least = in;
      *which = e;
    }
  }
  return least;
}

/* As smap_is_in_gap. */
static int smap_is_in_gap_i(const smap_layout_t *at, const smap_many_pose_i_t *o, const int32_t g[3])
{
  const uint8_t gaps = SMAP_MANY_GAPS ? at->gaps : 0;
  uint8_t k;
  for (k = 0; k < gaps; k++) {
    const int16_t(*const side)[3] = o->wall + SMAP_MANY_CORNERS + 2 * k;
    if (smap_dot_i(o->wall[at->gap[k].a], g) <= 0 && smap_dot_i(o->wall[at->gap[k].b], g) <= 0 &&
        smap_dot_i(side[0], g) >= 0 && smap_dot_i(side[1], g) >= 0) {
      return 1;
    }
  }
  return 0;
}

/* As smap_nearest; |g| times the sine, rounded down.  In doubt about an arc that is so short that it has no digits
 * that what stands is nearer, and what tips further. */
static int32_t smap_nearest_i(const smap_layout_t *at, const smap_many_pose_i_t *o, const int32_t g[3], uint32_t length,
                              int stands, uint8_t *which)
{
  const int32_t doubt = stands ? -4 : 4;
  const uint8_t arcs = at->arcs;
  const int32_t h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  uint32_t least = (length - 1u) * (length - 1u);
  uint8_t k;
  for (k = 0; k < arcs; k++) {
    const int16_t *const m = o->amid[k], *const t = o->along[k];
    const int32_t away = smap_dot_i(o->wall[at->arc[k]], h) >> 15;
    uint32_t square = (uint32_t)away * (uint32_t)away;
    int32_t aside, ahead;
    if (square >= least) {
      continue;
    }
    aside = smap_dot_i(t, h) >> 15;
    aside = aside < 0 ? -aside : aside;
    ahead = smap_dot_i(m, h) >> 15;
    if (ahead < doubt && ahead * (smap_square_i(t) >> 15) + aside * (smap_square_i(m) >> 15) < doubt * SMAP_ONE_I) {
      continue;
    }
    square += aside > ahead ? (uint32_t)(aside - ahead) * (uint32_t)(aside - ahead) : 0u;
    if (square < least) {
      least = square;
      *which = at->arc[k];
    }
  }
  return (int32_t)smap_whole_root(least);
}

/* |D - s| in steps.  A contact is at most 32767 two-steps away and the longest of g is 16384 or more, so the
 * factor is at most 2^16 for 2. */
SMAP_APART static uint16_t smap_sdg_i(const smap_many_pose_i_t *o, uint8_t f, const int32_t g[3], int32_t rate)
{
  const uint8_t shift = o->shift;
  const uint32_t deep = (uint32_t)rate >> shift, factor = deep ? ((uint32_t)o->mantissa << 16) / deep : 65536u;
  uint32_t sum = 0;
  uint8_t k;
  if (SMAP_RARELY(factor > 65535u)) {
    return 65534;
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    const int32_t d = (g[k] * (int32_t)factor >> 15) - o->centre[f][k];
    if (SMAP_RARELY(d > 32767 || d < -32767)) {
      return 65534;
    }
    sum += (uint32_t)(d * d);
  }
  sum = 2u * smap_whole_root(sum);
  return (uint16_t)(sum < 65534u ? sum : 65534u);
}

/* Read a pose under a direction whose longest component is 16384 to 32768; `length` is that of it,
 * rounded up. */
static smap_status_t smap_many_at_i(const smap_layout_t *at, const smap_many_pose_i_t *o,
                                    const int32_t g[3], uint32_t length, smap_reading_i_t *out)
{
  const int32_t size = (int32_t)length, all = SMAP_ONE_I * (size - 1), edge = -2 * size;
  const uint8_t rests = at->alive ? at->rests : 0;
  const int32_t h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  int32_t rate = 0, tip;
  uint8_t i, best = SMAP_NONE, which;
  smap_status_t status;
  out->sdg = out->height = 65535u;
  out->tip = -SMAP_ONE_I;
  out->over[0] = out->over[1] = SMAP_NONE;
  SMAP_THRICE
  for (i = 0; i < rests; i++) {
    const int32_t v = smap_dot_i(o->plane[i], h);
    if (v > rate) {
      rate = v;
      best = i;
    }
  }
  if (best == SMAP_NONE) {
    return SMAP_TIPS;
  }
  tip = smap_inside_i(at, o, best, h, all, &which);
  for (i = 0; tip < edge && i < rests; i++) {
    uint8_t near;
    const int32_t in = smap_inside_i(at, o, i, h, all, &near);
    if (in >= 0) {
      tip = in;
      best = i;
      which = near;
      rate = smap_dot_i(o->plane[i], h);
    }
  }
  status = tip >= o->guard * size                    ? SMAP_OK
           : tip >= edge || smap_is_in_gap_i(at, o, h) ? SMAP_ROCKS
                                                       : SMAP_TIPS;
  if (rests > 1 && !(tip >= 0 && at->alone[best])) {
    tip = smap_nearest_i(at, o, h, length, status != SMAP_TIPS, &which);
    tip = (status == SMAP_TIPS ? -tip - 1 : tip) * SMAP_ONE_I;
  }
  if (tip < all) {
    out->over[0] = at->over[which][0];
    out->over[1] = at->over[which][1];
  }
  tip = (tip < 0 ? tip / (size - 1) : tip / (size + 1)) - o->guard;
  if (tip < 0 || status == SMAP_TIPS) {
    tip = tip < 0 ? tip : -1;
    out->tip = (int16_t)(tip > -SMAP_ONE_I ? tip : -SMAP_ONE_I);
    return SMAP_TIPS;
  }
  out->tip = (int16_t)tip;
  out->height = o->height[best];
  out->sdg = smap_sdg_i(o, best, g, rate);
  return status;
}
