/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- chart: is this a direction, and one that the map holds? ------------------------------------- */

#if SMAP_FLOATS
/* Write what is no reading. */
SMAP_INLINE int8_t smap_deny(smap_reading_t *out, float tip_angle, int8_t status)
{
  out->sdg = out->height = smap_from_bits(0x7FC00000u);
  out->tip_angle = tip_angle;
  out->over[0] = out->over[1] = 255;
  return status;
}

/* Scale a direction: downward component 1 on a cone, longest component 1 on a sphere. */
SMAP_INLINE int8_t smap_direction(const smap_t *map, const float gravity[3], float d[3])
{
  const smap_bytes_t blob = SMAP_BLOB(map);
  const int cone = blob[SMAP_AT_FACES] == 1;
  /* Turned by its bit: of a minus compilers make two, one for each dividend. */
  float depth = smap_from_bits(smap_bits(gravity[2]) ^ 0x80000000u);
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
  if (SMAP_RARELY(!smap_is_positive(depth))) {
    uint32_t any = 0;
    for (i = 0; i < 3; i++) {
      any |= smap_bits(gravity[i]) << 1;
      if (!smap_is_finite(gravity[i])) {
        return SMAP_INVALID;
      }
    }
    return any != 0 ? (int8_t)SMAP_OFF_CHART : (int8_t)SMAP_INVALID;
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
#endif

#if SMAP_INTEGERS
SMAP_INLINE int8_t smap_deny_i(smap_reading_i_t *out, int8_t status)
{
  out->sdg = out->height = 65535;
  out->tip = -32767;
  out->over[0] = out->over[1] = 255;
  return status;
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
#if defined(__GNUC__) && !defined(__AVR__)
  shift = (uint32_t)__builtin_clz((unsigned)longest) - 16u;
#else
  for (shift = 0; longest << shift < 32768u; shift++) { /* at most 15 times */
  }
#endif
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
#endif

/* What a pointer's alignment is: on an AVR less than its size. */
typedef struct {
  char before;
  const smap_t *map;
} smap_aligned_t;
#define SMAP_ALIGNMENT (sizeof(smap_aligned_t) - sizeof(const smap_t *))

/* Prepare the caller's memory for a pose; 0 where it is too small, not aligned, or of no known form. */
static int smap_begin(const smap_t *map, void *pose, uint16_t bytes, uint8_t forms, uint32_t needed)
{
  smap_head_t *const head = (smap_head_t *)pose;
  const uint8_t known = (SMAP_FLOATS ? SMAP_FLOAT : 0) | (SMAP_INTEGERS ? SMAP_INTEGER : 0);
  if (bytes >= sizeof map) {
    memset(pose, 0, sizeof map);
  }
  if (bytes < needed || forms == 0 || (forms & ~known) != 0 || (uintptr_t)pose % SMAP_ALIGNMENT != 0) {
    return 0;
  }
  head->map = map;
  head->forms = forms;
  return 1;
}

