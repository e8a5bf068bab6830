/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- reading many contacts without float ------------------------------------------------------------- */
/* One direction of gravity against a pose, without float: raw counts of an accelerometer.
 *
 * Walls, planes and points are int16, 32767 for 1; products with gravity are summed in int32, which
 * they never leave, since both are at most 32768 sqrt(3) and 32767 long.
 */
#define SMAP_MANY_AT_I 1
#define SMAP_ONE_I 32767
#define SMAP_ROUNDED_I 9e-5f /* sine that rounding may alter */

typedef struct {
  uint8_t shift;     /* of D: see smap_many_make_i */
  uint16_t mantissa; /* of D */
  int16_t guard, hair, slack;
  uint16_t height[SMAP_MANY_SHOWN];
  int16_t plane[SMAP_MANY_SHOWN][3];
  int16_t centre[SMAP_MANY_SHOWN][3]; /* in two steps of sdg */
  int16_t wall[SMAP_MANY_WALLS][3];
  int16_t point[SMAP_MANY_LINKS][3];
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
  if (!o->at.alive || !o->at.shown) {
    return;
  }
  for (k = 0; k < o->at.shown; k++) {
    least = k == 0 || o->height[k] < least ? o->height[k] : least;
    i->height[k] = smap_steps_i(o->height[k] / height_step, 65534.0f);
  }
  for (k = 0; k < o->at.shown; k++) {
    smap_scale_i(o->centre[k], 0.5f / sdg_step, i->centre[k]);
  }
  smap_units_i(o->plane, o->at.shown, (float)SMAP_ONE_I * least, i->plane); /* n / h: the greatest is 1 */
  smap_units_i(o->wall, o->at.walls, (float)SMAP_ONE_I, i->wall);
  smap_units_i(o->point, o->at.points, (float)SMAP_ONE_I, i->point);
  /* D = g 32767 least / (2 sdg_step) / (plane . g) = g (mantissa 2^16 / (plane . g >> shift)) / 2^15 */
  factor = (float)SMAP_ONE_I * least * 0.5f / sdg_step;
  k = (uint8_t)(smap_bits(factor) >> 23);
  i->shift = (uint8_t)(k > 143 && k < 173 ? k - 143 : 0); /* so that it is less than 2^17 */
  factor = smap_from_bits(smap_bits(factor) - ((uint32_t)i->shift << 23)) * 0.5f;
  i->mantissa = smap_steps_i(factor, 65535.0f);
  i->guard = (int16_t)((o->guard + SMAP_ROUNDED_I) * (float)SMAP_ONE_I + 1.0f);
  i->hair = (int16_t)((o->hair + SMAP_ROUNDED_I) * (float)SMAP_ONE_I + 1.0f);
  i->slack = (int16_t)(o->slack * (float)SMAP_ONE_I);
}

static inline int32_t smap_dot_i(const int16_t a[3], const int32_t b[3])
{
  /* Summed without sign: only walls of a damaged map can be too long, and they may wrap. */
  return (int32_t)((uint32_t)(a[0] * b[0]) + (uint32_t)(a[1] * b[1]) + (uint32_t)(a[2] * b[2]));
}

/* How large a number is; of the least, which only a damaged map has, not. */
static inline int32_t smap_size_i(int32_t x)
{
  return x < 0 ? (int32_t)(0u - (uint32_t)x) : x;
}

static inline void smap_cross_i(const int32_t g[3], const int16_t n[3], int32_t out[3])
{
  const int32_t x = n[0], y = n[1], z = n[2];
  out[0] = g[1] * z - g[2] * y;
  out[1] = g[2] * x - g[0] * z;
  out[2] = g[0] * y - g[1] * x;
}

/* How many bits a number has. */
static inline uint8_t smap_bits_i(uint32_t x)
{
#ifdef __GNUC__
  return (uint8_t)(x ? 8 * (int)sizeof(unsigned long) - __builtin_clzl(x) : 0);
#else
  uint8_t bits = 0;
  for (; x != 0; x >>= 1) {
    bits++;
  }
  return bits;
#endif
}

/* The length of a vector of int32, to 2^-14 of it. */
static int32_t smap_length_i(const int32_t c[3])
{
  const uint32_t x = (uint32_t)(c[0] < 0 ? -c[0] : c[0]), y = (uint32_t)(c[1] < 0 ? -c[1] : c[1]);
  const uint32_t z = (uint32_t)(c[2] < 0 ? -c[2] : c[2]);
  const int shift = (int)smap_bits_i(x | y | z) - 14;
  uint32_t sum, half = 0;
  if (shift < -13) {
    return 0;
  }
  if (shift >= 0) {
    const uint32_t a = x >> shift, b = y >> shift, d = z >> shift;
    sum = a * a + b * b + d * d;
  } else {
    const uint32_t a = x << -shift, b = y << -shift, d = z << -shift;
    sum = a * a + b * b + d * d;
  }
  while (sum < 0x10000000u) {
    sum <<= 2;
    half++;
  }
  while (sum >= 0x40000000u) {
    sum >>= 2;
    half--;
  }
  sum = smap_whole_root(sum);
  {
    const int by = shift - (int)half;
    return (int32_t)(by < 0 ? sum >> -by : sum > (0x7FFFFFFFu >> by) ? 0x7FFFFFFFu : sum << by);
  }
}

/* Whether a vector of less than 2^31 is surely longer than `least`, which is at least 0. */
static inline int smap_is_far_i(const int32_t c[3], int32_t least)
{
  const int32_t x = c[0] >> 16, y = c[1] >> 16, z = c[2] >> 16, far = (least >> 16) + 3;
  /* Rounding takes at most 1 of each. */
  return (uint32_t)(x * x) + (uint32_t)(y * y) + (uint32_t)(z * z) >= (uint32_t)(far * far);
}

/* As smap_nearest; the distance is 32767 |g| times the sine, rounded down. */
static int32_t smap_nearest_i(const smap_layout_t *at, const smap_many_pose_i_t *o, uint8_t facet,
                              const int32_t g[3], int32_t floor, int32_t least, uint8_t *which)
{
  const uint8_t island = at->island[facet];
  const smap_segment_t *const middle = at->segment + smap_begin_at(at, island, *which);
  const smap_segment_t *s = middle, *end = at->segment + at->last[island];
  const int32_t h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  const int bulges = smap_is_convex(at, facet), inside = floor >= 0;
  const int32_t beyond = least >> 9, rounded = least >> 14; /* SMAP_BEYOND, and SMAP_ROUNDED_I */
  uint8_t part;
  for (part = 0; part < 2; part++, s = at->segment + at->first[island], end = middle) {
    for (; s < end; s++) {
      const int16_t *n = o->wall[s->wall], *p;
      const int32_t ahead = smap_dot_i(n, h);
      int32_t away = smap_size_i(ahead), c[3];
      if (away >= least || (ahead < -rounded ? inside && !s->bent : !inside && ahead >= beyond)) {
        continue;
      }
      p = o->point[s->stop];
      smap_cross_i(h, n, c);
      c[0] >>= 16;
      c[1] >>= 16;
      c[2] >>= 16;
      if (smap_dot_i(p, c) > 0) {
        if ((inside && !s->bent) || smap_dot_i(p, h) <= 0) {
          continue;
        }
        smap_cross_i(h, p, c);
        if (smap_is_far_i(c, least)) {
          continue;
        }
        away = smap_length_i(c);
      } else if (smap_dot_i(o->point[s->start], c) < 0) {
        continue;
      } else if (bulges && ahead < 0) { /* of what is convex no other place is as near */
        *which = s->wall;
        return away;
      }
      if (away < least) {
        least = away;
        *which = s->wall;
        if (away <= floor) {
          return away;
        }
      }
    }
  }
  return least;
}

/* As smap_boundary. */
SMAP_APART static int32_t smap_boundary_i(const smap_layout_t *at, const smap_many_pose_i_t *o,
                                          uint8_t facet, const int32_t g[3], int32_t floor,
                                          int32_t least, uint8_t *which)
{
  const uint8_t island = at->island[facet];
  if (floor >= 0 && smap_is_convex(at, facet)) {
    uint8_t k;
    for (k = at->first[island]; k < at->last[island]; k++) {
      const int32_t v = smap_dot_i(o->wall[at->segment[k].wall], g);
      if (v < least) {
        least = v;
        *which = at->segment[k].wall;
      }
    }
    return least;
  }
  return smap_nearest_i(at, o, facet, g, floor, least, which);
}

SMAP_APART static int smap_within_i(const smap_layout_t *at, const smap_many_pose_i_t *o, uint8_t side,
                                    const int32_t g[3], int32_t slack)
{
  const smap_side_t *s = &at->side[side];
  const uint8_t end = s->end;
  uint8_t k;
  slack = s->inner ? -slack : 0;
  for (k = s->wall; k < end; k++) {
    const int in = smap_dot_i(o->wall[k], g) > slack;
    if (in != !s->inwards) {
      return in;
    }
  }
  return !s->inwards;
}

/* As smap_first_beyond. */
static inline uint8_t smap_first_beyond_i(const smap_layout_t *at, const smap_many_pose_i_t *o,
                                          uint8_t f, const int32_t g[3], int32_t hair,
                                          int32_t *least, uint8_t *which)
{
  const uint8_t end = at->edge[f + 1];
  const int32_t h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  const int16_t(*n)[3] = o->wall + at->edge[f];
  int32_t low = *least;
  uint8_t e;
  for (e = at->edge[f]; e < end; e++, n++) {
    const int32_t in = smap_dot_i(*n, h);
    if (in < low) {
      if (in < hair) {
        break;
      }
      low = in;
      *which = e;
    }
  }
  *least = low;
  return e;
}

/* As smap_on_facet. */
static inline int smap_on_facet_i(const smap_layout_t *at, const smap_many_pose_i_t *o, uint8_t f,
                                  int32_t least, int32_t length)
{
  return at->kind[f] != SMAP_REST ? SMAP_TIPS : least < o->guard * length ? SMAP_ROCKS : SMAP_OK;
}

/* As smap_step_beyond. */
SMAP_APART static int smap_step_beyond_i(const smap_layout_t *at, const smap_many_pose_i_t *o,
                                         uint8_t *f, uint8_t *e, const int32_t g[3], int32_t length)
{
  const int32_t hair = o->hair * length, slack = o->slack * length;
  int32_t least = SMAP_ONE_I * (length - 1);
  uint8_t k, to = SMAP_NONE, which;
  for (k = *e; k < at->edge[*f + 1]; k++) {
    const smap_rim_t *rim = &at->rim[k];
    const uint8_t side = rim->side;
    if (side + 1 >= SMAP_MANY_SIDES || smap_dot_i(o->wall[k], g) >= hair) {
      continue;
    }
    if (smap_dot_i(o->wall[rim->back], g) >= hair) {
      to = rim->to;
    } else if (smap_within_i(at, o, side, g, slack) &&
               smap_within_i(at, o, (uint8_t)(side + 1u), g, slack)) {
      return SMAP_ROCKS;
    }
  }
  if (to >= SMAP_MANY_SHOWN) {
    return SMAP_TIPS;
  }
  *f = to;
  *e = smap_first_beyond_i(at, o, to, g, hair, &least, &which);
  return *e == at->edge[to + 1] ? smap_on_facet_i(at, o, to, least, length) : SMAP_FURTHER;
}

/* As smap_beyond. */
static int smap_beyond_i(const smap_layout_t *at, const smap_many_pose_i_t *o, uint8_t f, uint8_t e,
                         const int32_t g[3], int32_t length)
{
  int status = SMAP_FURTHER;
  uint8_t left;
  for (left = 4; left > 0 && status == SMAP_FURTHER; left--) {
    status = smap_step_beyond_i(at, o, &f, &e, g, length);
  }
  return status == SMAP_FURTHER ? SMAP_TIPS : status;
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
  const int32_t size = (int32_t)length, all = SMAP_ONE_I * (size - 1);
  const uint8_t shown = at->alive ? at->shown : 0;
  const int32_t h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  int32_t rate = 0, least = all;
  uint8_t i, best = SMAP_NONE, edge, nearest = 0, which;
  int status, inside;
  out->sdg = out->height = 65535u;
  out->tip = -SMAP_ONE_I;
  out->over[0] = out->over[1] = SMAP_NONE;
  SMAP_THRICE
  for (i = 0; i < shown; i++) {
    const int32_t v = smap_dot_i(o->plane[i], h);
    if (v > rate) {
      rate = v;
      best = i;
    }
  }
  if (best == SMAP_NONE) {
    return SMAP_TIPS;
  }
  edge = smap_first_beyond_i(at, o, best, g, o->hair * size, &least, &nearest);
  inside = edge >= at->edge[best + 1];
  which = edge < at->edge[best + 1] ? edge : nearest;
  status = inside                    ? smap_on_facet_i(at, o, best, least, size)
           : smap_is_alone(at, best) ? SMAP_TIPS
                                     : smap_beyond_i(at, o, best, edge, g, size);
  if (status == SMAP_TIPS || !smap_is_alone(at, best)) {
    least = smap_boundary_i(at, o, best, g, status == SMAP_TIPS ? -1 : inside ? least : 0, all, &which);
  }
  if (least < all) {
    out->over[0] = at->over[which][0];
    out->over[1] = at->over[which][1];
  }
  least = (status == SMAP_TIPS ? -(least / (size - 1)) : least / (size + 1)) - o->guard;
  if (least < 0) {
    out->tip = (int16_t)(least > -SMAP_ONE_I ? least : -SMAP_ONE_I);
    return SMAP_TIPS;
  }
  out->tip = (int16_t)least;
  out->height = o->height[best];
  out->sdg = smap_sdg_i(o, best, g, rate);
  return (smap_status_t)status;
}
