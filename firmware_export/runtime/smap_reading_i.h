/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
#include "smap_reading.h"
/* ---- reading a region without float: raw counts of an accelerometer ------------------------------------ */
/* Walls, planes and arcs are int16, 32767 for 1; products with gravity are summed in int32, which they never leave,
 * since both are at most 32768 sqrt(3) and 32767 long. */
#define SMAP_ONE_I 32767
#define SMAP_ROUNDED_I 1.6e-4f /* sine that rounding may alter: of walls, and to a step of 1 / 16384 twice */
#define SMAP_BEHIND_I 4        /* of SMAP_ONE_I, as SMAP_BEHIND, and what is in doubt of short arcs */

typedef struct {
  uint8_t shift;     /* of D: see smap_make_i */
  uint16_t mantissa; /* of D */
  int16_t guard;
  int16_t wall[SMAP_WALLS][3];
  uint16_t height[SMAP_MAX_RESTS];
  int16_t plane[SMAP_MAX_RESTS][3];
  int16_t centre[SMAP_MAX_RESTS][3]; /* in two steps of sdg */
  int16_t place[SMAP_PLACES][3];
} smap_region_i_t;

/* The nearest whole number of what is less than 2^22: the last digits of a sum whose last is worth 1. */
SMAP_INLINE int16_t smap_whole_i(float x)
{
  return (int16_t)(int32_t)(smap_bits(x + 12582912.0f) - 0x4B400000u);
}

/* Vectors of which no component is beyond 1 / scale, times 32767. */
static void smap_scale_i(const float (*from)[3], uint16_t n, float scale, int16_t (*to)[3])
{
  uint16_t i;
  uint8_t k;
  for (i = 0; i < n; i++) {
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      to[i][k] = smap_whole_i(from[i][k] * scale);
    }
  }
}

/* The nearest whole number from 0 to `most`, which is at most 65535. */
SMAP_INLINE uint16_t smap_steps_i(float x, float most)
{
  return (uint16_t)smap_whole_i(x < most ? x : most);
}

/* Make the integer form of a region; `step` is that of lengths. */
static void smap_make_i(const smap_layout_t *at, const smap_region_t *o, float step, smap_region_i_t *i)
{
  const uint16_t walls = (uint16_t)(at->first[at->rests] + 2u * at->gaps);
  float least = SMAP_LARGEST, factor;
  uint8_t k;
  for (k = 0; k < at->rests; k++) {
    least = o->height[k] < least ? o->height[k] : least;
    i->height[k] = smap_steps_i(o->height[k] / step, 65534.0f);
  }
  smap_scale_i(o->centre, at->rests, 0.5f / step, i->centre); /* a contact is at most 16,000 steps away */
  smap_scale_i(o->plane, at->rests, (float)SMAP_ONE_I * least, i->plane); /* n / h: the greatest is 1 */
  /*@ admit walls >= 3; */
  smap_scale_i(o->wall, walls, (float)SMAP_ONE_I, i->wall);
  smap_scale_i(o->place, at->places, (float)SMAP_ONE_I, i->place);
  /* D = g 32767 least / (2 step) / (plane . g) = g (mantissa 2^16 / (plane . g >> shift)) / 2^15 */
  factor = (float)SMAP_ONE_I * least * 0.5f / step;
  k = (uint8_t)(smap_bits(factor) >> 23);
  i->shift = (uint8_t)(k > 143 && k < 173 ? k - 143 : 0); /* so that it is less than 2^17 */
  factor = smap_from_bits(smap_bits(factor) - ((uint32_t)i->shift << 23)) * 0.5f;
  i->mantissa = smap_steps_i(factor, 65535.0f);
  factor = (o->guard + SMAP_ROUNDED_I) * (float)SMAP_ONE_I + 0.5f; /* rounded up */
  i->guard = (int16_t)smap_steps_i(factor, 32767.0f); /* that of a damaged map may be more */
}

SMAP_INLINE int32_t smap_dot_i(const int16_t a[3], const int32_t b[3])
{
  /* Summed without sign: only walls of a damaged map can be too long, and they may wrap. */
  return (int32_t)((uint32_t)a[0] * (uint32_t)b[0] + (uint32_t)a[1] * (uint32_t)b[1] + (uint32_t)a[2] * (uint32_t)b[2]);
}

/* As smap_inside; 32767 |g| times the sine. */
static int32_t smap_inside_i(const smap_layout_t *at, const smap_region_i_t *o, uint8_t rest, const int32_t g[3],
                             int32_t least, uint8_t *which)
{
  const uint8_t end = at->first[rest + 1];
  uint8_t e = at->first[rest], nearest = e;
  for (; e < end; e++) {
    const int32_t in = smap_dot_i(o->wall[e], g);
    if (in < least) {
      least = in;
      nearest = e;
    }
  }
  *which = nearest;
  return least;
}

/* As smap_is_in_gap. */
static int smap_is_in_gap_i(const smap_layout_t *at, const smap_region_i_t *o, const int32_t g[3])
{
  uint8_t k;
  for (k = 0; k < at->gaps; k++) {
    const smap_gap_t *const gap = &at->gap[k];
    if (smap_dot_i(o->wall[gap->a], g) <= 0 && smap_dot_i(o->wall[gap->b], g) <= 0 &&
        smap_dot_i(o->wall[gap->side], g) >= 0 && smap_dot_i(o->wall[gap->side + 1], g) >= 0) {
      return 1;
    }
  }
  return 0;
}

/* As smap_beyond, and by a doubt more; |g| times the sine. */
SMAP_INLINE int32_t smap_beyond_i(const smap_region_i_t *o, const smap_arc_t *arc, const int32_t g[3], int32_t doubt)
{
  const int16_t *const m = o->wall[arc->wall], *const from = o->place[arc->from], *const to = o->place[arc->to];
  const int32_t along[3] = {(int32_t)((uint32_t)(g[1] * m[2]) - (uint32_t)(g[2] * m[1])) >> 15,
                            (int32_t)((uint32_t)(g[2] * m[0]) - (uint32_t)(g[0] * m[2])) >> 15,
                            (int32_t)((uint32_t)(g[0] * m[1]) - (uint32_t)(g[1] * m[0])) >> 15};
  const int32_t before = (smap_dot_i(from, along) >> 15) + doubt, after = (smap_dot_i(to, along) >> 15) - doubt;
  if (before > 0 && smap_dot_i(from, g) > 0) {
    return before;
  }
  if (after < 0 && smap_dot_i(to, g) > 0) {
    return -after;
  }
  return before > 0 || after < 0 ? 65535 : 0;
}

/* As smap_nearest; |g| times the sine, rounded down.  In doubt about an arc that is so short that it has no digits
 * that what stands is nearer, and what tips further. */
static int32_t smap_nearest_i(const smap_layout_t *at, const smap_region_i_t *o, const int32_t g[3], uint32_t length,
                              const uint8_t ends[2], int tips, const smap_arc_t **which)
{
  const int32_t doubt = tips ? SMAP_BEHIND_I : -SMAP_BEHIND_I;
  const smap_arc_t *arc = at->arc + ends[0], *const end = at->arc + ends[1];
  uint32_t least = (length - 1u) * (length - 1u);
  for (; arc < end; arc++) {
    const int32_t away = smap_dot_i(o->wall[arc->wall], g) >> 15;
    uint32_t square = (uint32_t)away * (uint32_t)away, beyond;
    if (((tips ? away : -away) > SMAP_BEHIND_I && (SMAP_PIVOTS == 0 || at->nearly != SMAP_OVERLAP)) ||
        square >= least) {
      continue;
    }
    beyond = (uint32_t)smap_beyond_i(o, arc, g, doubt);
    if (beyond * beyond < least - square) {
      least = square + beyond * beyond;
      *which = arc;
    }
  }
  return (int32_t)smap_whole_root(least);
}

/* |D - s| in steps.  A contact is at most 32767 two-steps away and the longest of g is 16384 or more, so the
 * factor is at most 2^16 for 2. */
SMAP_APART static uint16_t smap_sdg_i(const smap_region_i_t *o, uint8_t f, const int32_t g[3], int32_t rate)
{
  const uint8_t shift = o->shift;
  const uint32_t deep = (uint32_t)rate >> shift, factor = deep ? ((uint32_t)o->mantissa << 16) / deep : 65536u;
  uint32_t sum = 0;
  uint8_t k;
  if (factor > 65535u) {
    return 65534;
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    const int32_t d = (g[k] * (int32_t)factor >> 15) - o->centre[f][k];
    if (d > 32767 || d < -32767) {
      return 65534;
    }
    sum += (uint32_t)(d * d);
  }
  sum = 2u * smap_whole_root(sum);
  return (uint16_t)(sum < 65534u ? sum : 65534u);
}

/* Read a region under a direction whose longest component is 16384 to 32768; `length` is that of it, rounded up. */
static int8_t smap_read_region_i(const smap_layout_t *at, const smap_region_i_t *o, const int32_t gravity[3],
                                 uint32_t length, smap_reading_i_t *out)
{
  const int32_t size = (int32_t)length, all = SMAP_ONE_I * (size - 1);
  const int32_t g[3] = {gravity[0], gravity[1], gravity[2]}; /* no store can alter it */
  int32_t rate = 0, tip;
  uint8_t i, rest, next = 0, best = SMAP_NONE, which;
  const smap_arc_t *arc = 0;
  int8_t status = SMAP_OK;
  for (i = 0; i < at->rests; i++) {
    const int32_t v = smap_dot_i(o->plane[i], g);
    if (v > rate) {
      rate = v;
      best = i;
    }
  }
  if (best == SMAP_NONE) {
    return smap_deny_i(out, SMAP_TIPS);
  }
  i = best;
  do {
    rest = i;
    tip = smap_inside_i(at, o, rest, g, all, &which);
    i = next;
  } while (tip < 0 && at->nearly && next++ < at->rests);
  best = tip < 0 ? best : rest;
  if (tip >= 0 && at->own[best] != SMAP_NONE) {
    arc = tip < all ? at->arc + at->own[best] + (which - at->first[best]) : 0;
  } else {
    const int rocks = tip < 0 && smap_is_in_gap_i(at, o, g), tips = tip < 0 && !rocks;
    const uint8_t ends[2] = {rocks ? (uint8_t)0 : at->from[best],
                             rocks ? at->arcs : at->till[best]};
    status = tips ? SMAP_TIPS : tip >= o->guard * size ? SMAP_OK : SMAP_ROCKS;
    tip = smap_nearest_i(at, o, g, length, ends, tips, &arc);
    tip = (tips ? -tip - 1 : tip) * SMAP_ONE_I;
  }
  tip = (tip < 0 ? tip / (size - 1) : tip / (size + 1)) - o->guard;
  if (tip < 0 || status == SMAP_TIPS) {
    status = smap_deny_i(out, SMAP_TIPS);
    tip = tip < 0 ? tip : -1;
    out->tip = (int16_t)(tip > -SMAP_ONE_I ? tip : -SMAP_ONE_I);
  } else {
    out->tip = (int16_t)tip;
    out->height = o->height[best];
    out->sdg = smap_sdg_i(o, best, g, smap_dot_i(o->plane[best], g));
  }
  out->over[0] = arc != 0 ? arc->over[0] : (uint8_t)SMAP_NONE;
  out->over[1] = arc != 0 ? arc->over[1] : (uint8_t)SMAP_NONE;
  return status;
}
