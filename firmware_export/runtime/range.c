/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- range: parameters within their axes, or beyond them by no more than a sensor's slack -------- */

#if SMAP_FLOATS
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

/* Check parameters and write them to q: as they are, beyond an axis by no more than its slack. */
SMAP_INLINE int8_t smap_range(const smap_t *map, const float *params, float *q)
{
  const uint8_t count = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  uint8_t i;
  if (SMAP_RARELY(smap_fuses())) {
    return SMAP_INVALID;
  }
#if SMAP_MAX_PARAMS == 1
  q[0] = 0.0f; /* a map without parameters: some compilers then miss it */
#endif
  SMAP_UNROLL
  for (i = 0; i < count; i++) {
    const smap_bytes_t axis = smap_axis(map, i);
    const float low = smap_f32(axis + SMAP_AXIS_MIN), high = smap_f32(axis + SMAP_AXIS_MAX);
    float x = params[i];
    if (SMAP_RARELY(smap_bits(x - low) > smap_bits(high - low))) { /* or below: the sign's bit */
      const float slack = smap_f32(axis + SMAP_AXIS_SLACK);
      if (!smap_is_finite(x)) {
        return SMAP_INVALID;
      }
      if (slack < 0.0f ? !smap_unwind(&x, low, high)
                       : !smap_is_within(x < low ? low - x : x > high ? x - high : 0.0f, slack)) {
        return SMAP_OFF_RANGE;
      }
    }
    /*@ admit \is_finite(x) && -1e7 <= x <= 1e7; */
    q[i] = x;
  }
  return SMAP_OK;
}
#endif

#if SMAP_INTEGERS && !SMAP_FLOATS
/* The same of steps, 0 to 32767 between the ends. */
SMAP_INLINE int8_t smap_range_q(const smap_t *map, const int16_t *params_q, int16_t *q)
{
  const uint8_t count = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  uint8_t i;
#if SMAP_MAX_PARAMS == 1
  q[0] = 0;
#endif
  SMAP_UNROLL
  for (i = 0; i < count; i++) {
    const uint16_t slack = smap_u16(smap_axis(map, i) + SMAP_AXIS_SLACK_I);
    int32_t x = params_q[i];
    if (SMAP_RARELY(x < 0)) {
      if (slack == 65535u) {
        x = x < -32767 ? 0 : x + 32767;
      } else if (-x > (int32_t)slack) {
        return SMAP_OFF_RANGE;
      }
    }
    q[i] = (int16_t)x;
  }
  return SMAP_OK;
}
#endif

