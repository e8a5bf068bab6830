/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- poly: three contacts as Chebyshev polynomials of the parameters ------------------------------
 * The body: 0 length of one code f32; 7 order u8; per parameter middle and 2 / span of what it may be, f32
 * each; per contact its highest degree in each parameter and its number of terms u8; per term x, y, z i16. */

/* The terms of one contact, in codes; returns the codes of the next contact. */
static smap_bytes_t smap_poly_point(smap_bytes_t shape, smap_bytes_t codes, uint8_t params,
                                    const float *s, float point[3])
{
  /* Per parameter T_n and T_(n-1) of the present term, with T_-1 = T_1. */
  float value[SMAP_MAX_PARAMS], before[SMAP_MAX_PARAMS];
  uint32_t degrees = 0; /* n of each parameter, 4 bits: the exporter keeps to 8 parameters */
  uint8_t j, term, most = 0, total = 0;
  for (j = 0; j < params; j++) {
    value[j] = 1.0f;
    before[j] = s[j];
    most = shape[j] > most ? shape[j] : most;
  }
  point[0] = point[1] = point[2] = 0.0f;
  for (term = 0; term < shape[params]; term++) {
    float weight = 1.0f;
    for (j = 0; j < params; j++) {
      weight *= value[j];
    }
    for (j = 0; j < 3; j++, codes += 2) {
      point[j] += weight * (float)(int16_t)smap_u16(codes);
    }
    for (j = 0; j < params; j++) { /* count on, the first parameter fastest */
      const uint8_t degree = (uint8_t)(degrees >> 4 * j & 15u);
      if (degree < shape[j] && total < most) {
        const float next = 2.0f * s[j] * value[j] - before[j];
        before[j] = value[j];
        value[j] = next;
        degrees += (uint32_t)1 << 4 * j;
        total++;
        break;
      }
      total = (uint8_t)(total - degree);
      degrees -= (uint32_t)degree << 4 * j;
      value[j] = 1.0f;
      before[j] = s[j];
    }
  }
  return codes;
}

static void smap_poly_points(const smap_t *map, const float *q, float p[9])
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  const float unit = smap_f32(body);
  smap_bytes_t shape = body + 8 + 8 * params, codes = shape + 3 * (params + 1);
  float s[SMAP_MAX_PARAMS];
  uint8_t i;
  for (i = 0; i < params; i++) {
    s[i] = (q[i] - smap_f32(body + 8 + 8 * i)) * smap_f32(body + 12 + 8 * i);
  }
  for (i = 0; i < 9; i = (uint8_t)(i + 3)) {
    codes = smap_poly_point(shape, codes, params, s, &p[i]);
    shape += params + 1;
  }
  for (i = 0; i < 9; i++) {
    p[i] *= unit;
  }
}

/* Sizes: what the terms take is what is there. */
static int smap_check_poly(const smap_t *map, smap_bytes_t limit)
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  const smap_bytes_t shape = body + 8 + 8 * params;
  uint32_t terms = 0;
  uint8_t i, j;
  if (params > 8 || limit - body < 8 + 8 * params + 3 * (params + 1) ||
      !smap_is_finite(smap_f32(body))) {
    return 0;
  }
  for (i = 0; i < 2 * params; i++) {
    if (!smap_is_finite(smap_f32(body + 8 + 4 * i))) {
      return 0;
    }
  }
  for (i = 0; i < 3; i++) {
    for (j = 0; j < params; j++) {
      if (shape[i * (params + 1) + j] > 15) {
        return 0;
      }
    }
    terms += shape[i * (params + 1) + params];
  }
  return limit - (shape + 3 * (params + 1)) == (int32_t)(6u * terms);
}

