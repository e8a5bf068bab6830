/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
#include "smap_map.h"

/* ---- query: parameters and directions that a map holds, and readings that say nothing ------------- */

/* Bring a joint that turns all the way round onto its axis; 0 where it has turned too often to tell.  A
 * turn is 6.28125, of so few digits that its multiples are exact, and the rest. */
SMAP_INLINE int smap_unwind(float *x, float low, float high)
{
  const float away = (*x - low) * 0.159154943f;
  float whole;
  if (!smap_is_within(away, 1000.0f)) {
    return 0;
  }
  /*@ admit \is_finite(away) && -1000.0 <= away <= 1000.0; */
  whole = (float)(int32_t)away;
  whole -= away < whole ? 1.0f : 0.0f;
  *x = (*x - whole * 6.28125f) - whole * 1.93530718e-3f;
  /* After many turns `away` is rounded: next to the seam it may be one turn off. */
  if (*x > high) {
    *x = (*x - 6.28125f) - 1.93530718e-3f;
  } else if (*x < low) {
    *x = (*x + 6.28125f) + 1.93530718e-3f;
  }
  *x = *x < low ? low : *x > high ? high : *x;
  return 1;
}

/* Check parameters and write them to q: as they are, beyond an axis by no more than the sensor
 * tolerance. */
SMAP_INLINE int8_t smap_range(const smap_t *map, const float *params, float *q)
{
  const uint8_t count = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  uint8_t i;
  if (SMAP_MAY_FUSE && SMAP_RARELY(smap_fuses())) {
    return SMAP_INVALID;
  }
  q[0] = 0.0f; /* a map without parameters: some compilers then miss it */
  SMAP_UNROLL
  for (i = 0; i < count; i++) {
    const smap_bytes_t axis = smap_axis(map, i);
    const float low = smap_f32(axis + SMAP_AXIS_MIN), high = smap_f32(axis + SMAP_AXIS_MAX);
    float x = params[i];
    if (SMAP_RARELY(smap_bits(x - low) > smap_bits(high - low))) { /* or below: the sign's bit */
      const float tolerance = smap_f32(axis + SMAP_AXIS_SLACK);
      if (!smap_is_finite(x)) {
        return SMAP_INVALID;
      }
      if (SMAP_TURNS && tolerance < 0.0f
              ? !smap_unwind(&x, low, high)
              : !smap_is_within(x < low ? low - x : x > high ? x - high : 0.0f, tolerance)) {
        return SMAP_OFF_RANGE;
      }
    }
    /*@ admit \is_finite(x) && -1e7 <= x <= 1e7; */
    q[i] = x;
  }
  return SMAP_OK;
}
/* The same of steps, 0 to 32767 between the ends. */
SMAP_INLINE int8_t smap_range_q(const smap_t *map, const int16_t *params_q, int16_t *q)
{
  const uint8_t count = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  uint8_t i;
  q[0] = 0;
  SMAP_UNROLL
  for (i = 0; i < count; i++) {
    const uint16_t tolerance = smap_u16(smap_axis(map, i) + SMAP_AXIS_SLACK_I);
    int32_t x = params_q[i];
    if (SMAP_RARELY(x < 0)) {
      if (tolerance == 65535u) {
        x = x < -32767 ? 0 : x + 32767;
      } else if (-x > (int32_t)tolerance) {
        return SMAP_OFF_RANGE;
      }
    }
    q[i] = (int16_t)x;
  }
  return SMAP_OK;
}

/* Parameters as whole numbers, for maps that compute in floats. */
SMAP_INLINE void smap_from_steps(const smap_t *map, const int16_t *params_q, float *params)
{
  const uint8_t count = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  uint8_t i;
  SMAP_UNROLL
  for (i = 0; i < count; i++) {
    const smap_bytes_t axis = smap_axis(map, i);
    const float low = smap_f32(axis + SMAP_AXIS_MIN), high = smap_f32(axis + SMAP_AXIS_MAX);
    params[i] = params_q[i] == 32767 ? high : low + (high - low) * ((float)params_q[i] * (1.0f / 32767.0f));
  }
}

#define SMAP_SHORT_BITS 0x21800000u /* bits of 2^-60 */

/* Scale a direction: downward component 1 on a cone, longest component 1 on a sphere.  Denormal numbers
 * count as 0, as on processors that flush them; where that matters a direction is made longer first. */
SMAP_INLINE int8_t smap_direction(const smap_t *map, const float *gravity, float d[3])
{
  const smap_bytes_t blob = SMAP_BLOB(map);
  const int cone = blob[SMAP_AT_FACES] == 1;
  /* Turned by its bit: of a minus compilers make two, one for each dividend. */
  float depth = smap_from_bits(smap_bits(gravity[2]) ^ 0x80000000u), longer[3];
  uint8_t i;
  if (!cone) {
    SMAP_THRICE
    for (i = 0; i < 3; i++) {
      const float size = smap_absolute(gravity[i]);
      if (!smap_is_finite(size)) {
        return SMAP_INVALID;
      }
      depth = size > depth ? size : depth;
    }
  }
  if (SMAP_RARELY(smap_bits(depth) - SMAP_SHORT_BITS >= 0x7F800000u - SMAP_SHORT_BITS)) {
    uint32_t any = 0;
    for (i = 0; i < 3; i++) {
      const uint32_t exponent = smap_bits(gravity[i]) & 0x7F800000u;
      any |= exponent;
      if (!smap_is_finite(gravity[i])) {
        return SMAP_INVALID;
      }
      longer[i] = exponent != 0 ? gravity[i] * 1.8446744e19f : 0.0f;
    }
    if (smap_bits(depth) - 0x00800000u >= 0x7F000000u || !smap_is_finite(longer[0] + longer[1])) {
      return any != 0 ? (int8_t)SMAP_OFF_CHART : (int8_t)SMAP_INVALID;
    }
    depth *= 1.8446744e19f;
    gravity = longer;
  }
  SMAP_THRICE
  for (i = 0; i < 3; i++) {
    d[i] = cone && i == 2 ? -1.0f : gravity[i] / depth;
    if (cone && SMAP_RARELY(i < 2 && !smap_is_within(d[i], smap_f32(blob + SMAP_AT_LIMIT)))) {
      return smap_is_finite(gravity[0]) && smap_is_finite(gravity[1]) ? (int8_t)SMAP_OFF_CHART : (int8_t)SMAP_INVALID;
    }
  }
  return SMAP_OK;
}

/* Finish a reading whose tip angle, sdg and height are set: the verdict, by bits. */
SMAP_INLINE int8_t smap_judge(const smap_t *map, smap_reading_t *out, int8_t good)
{
  const uint8_t channels = SMAP_BLOB(map)[SMAP_AT_CHANNELS];
  const uint32_t bits = smap_bits(out->tip_angle);
  const int stands = bits <= 0x40490FDBu; /* from 0 to pi, and no NaN */
  if (!stands && bits - 0x80000001u > 0x40490FDBu) {
    out->tip_angle = -SMAP_PI;
  }
  if (!stands || !(channels & SMAP_SDG)) {
    out->sdg = smap_from_bits(0x7FC00000u);
  }
  if (!stands || !(channels & SMAP_HEIGHT)) {
    out->height = smap_from_bits(0x7FC00000u);
  }
  return stands ? good : (int8_t)SMAP_TIPS;
}

/* Scale raw counts so that the longest component is from 16384 to 32768, and return the square of the
 * length; 0 where there is none. */
SMAP_INLINE uint32_t smap_scale_counts(const int16_t gravity[3], int32_t g[3])
{
  uint32_t longest = 0, shift, sum = 0;
  uint8_t i;
  SMAP_THRICE
  for (i = 0; i < 3; i++) {
    g[i] = gravity[i];
    longest |= (uint32_t)(g[i] ^ -(g[i] < 0)); /* of a negative number one less: -16384 may become -32768 */
  }
  longest = longest << 1 | 1u; /* at most 65535 */
  shift = SMAP_ZEROS(longest) - 16u;
  /*@ admit 0 <= shift <= 15; */
  SMAP_THRICE
  for (i = 0; i < 3; i++) {
    g[i] *= (int32_t)1 << shift;
    /*@ admit -32768 <= g[i] <= 32768; */
    sum += (uint32_t)(g[i] * g[i]);
  }
  return sum;
}

/* The same of a direction that the map holds; `length` is rounded up. */
SMAP_INLINE int8_t smap_direction_i(const smap_t *map, const int16_t gravity[3], int32_t g[3],
                                    uint32_t *length)
{
  const smap_bytes_t blob = SMAP_BLOB(map);
  const uint32_t sum = smap_scale_counts(gravity, g);
  if (blob[SMAP_AT_FACES] == 1) {
    /* Beyond the rim on either side is above twice the reach, or has no sign and wraps. */
    const uint32_t reach = (uint32_t)-g[2] * smap_u16(blob + SMAP_AT_LIMIT_I);
    if (g[2] >= 0 || (uint32_t)g[0] * 4096u + reach > 2u * reach ||
        (uint32_t)g[1] * 4096u + reach > 2u * reach) {
      return sum == 0 ? (int8_t)SMAP_INVALID : (int8_t)SMAP_OFF_CHART;
    }
  } else if (sum == 0) {
    return SMAP_INVALID;
  }
  *length = smap_length_root(sum) + 1u;
  /*@ admit 16385 <= *length <= 56757; */
  return SMAP_OK;
}

/* ---- what an export without floats says to those who ask in floats ------------------------------- */
SMAP_PLAIN int8_t smap_no_pose(const smap_t *map, const float *params, smap_pose_t *pose, uint16_t bytes,
                               uint8_t forms)
{
  (void)params;
  (void)smap_begin(map, pose, bytes, forms, 0, 0);
  return SMAP_INVALID;
}

SMAP_PLAIN int8_t smap_no_read(const smap_t *map, const float *params, const float *gravity,
                               smap_reading_t *out)
{
  (void)map;
  (void)params;
  (void)gravity;
  return smap_deny(out, SMAP_INVALID);
}

SMAP_PLAIN int8_t smap_no_at(const smap_pose_t *pose, const float *gravity, smap_reading_t *out)
{
  return smap_no_read(pose->map, gravity, gravity, out);
}
