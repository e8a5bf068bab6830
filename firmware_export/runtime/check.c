/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- check: is the map in flash what was exported, and can no number of it lead astray? ------------ */

/* CRC-32 (IEEE 802.3) as flash has the bytes now: nothing that the compiler knows of them counts. */
static uint32_t smap_crc(smap_bytes_t bytes, uint32_t count)
{
  const volatile SMAP_FLASH uint8_t *const now = bytes;
  uint32_t crc = 0xFFFFFFFFu, i;
  for (i = 0; i < count; i++) {
    uint8_t bit;
    crc ^= now[i];
    for (bit = 0; bit < 8; bit++) {
      crc = crc >> 1 ^ (crc & 1u ? 0xEDB88320u : 0u);
    }
  }
  return ~crc;
}

#if SMAP_FLOATS
/* The numbers of every axis: finite, the upper end above the lower one. */
static int smap_check_axes(const smap_t *map)
{
  uint8_t i;
  for (i = 0; i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++) {
    const smap_bytes_t axis = smap_axis(map, i);
    const float low = smap_f32(axis + SMAP_AXIS_MIN), high = smap_f32(axis + SMAP_AXIS_MAX);
    const float slack = smap_f32(axis + SMAP_AXIS_SLACK);
    if (!smap_is_within(low, 1e6f) || !smap_is_within(high, 1e6f) || !smap_is_within(slack, 1e6f) ||
        !smap_is_positive(high - low)) {
      return 0;
    }
  }
  return 1;
}

/* The singles from a place on: each finite. */
SMAP_INLINE int smap_check_singles(smap_bytes_t at, uint32_t count)
{
  uint32_t i;
  for (i = 0; i < count; i++) {
    if (!smap_is_finite(smap_f32(at + 4 * i))) {
      return 0;
    }
  }
  return 1;
}
#endif

#if SMAP_POINTS || SMAP_MANY
/* The tables of positions: indices of joints, entries and axes, and sizes, up to `limit`. */
static int smap_check_positions(const smap_t *map, smap_bytes_t limit)
{
  const smap_bytes_t body = smap_body(map);
  uint32_t sum = 0, fixed, i;
  uint16_t terms;
  int shared;
  smap_places_t at;
  if (limit - body < SMAP_IN_MANY) {
    return 0;
  }
#if SMAP_SERIES
  if (body[SMAP_IN_FLAGS] & SMAP_BY_SERIES) {
    return smap_check_singles(body + SMAP_IN_LOWEST, 3) && smap_check_series(map, limit);
  }
#endif
  terms = smap_u16(body + SMAP_IN_TERMS);
  fixed = 1u + 2u * body[SMAP_IN_ANGLES] + body[SMAP_IN_TRAVELS];
  if (fixed + body[SMAP_IN_PRODUCTS] > SMAP_MAX_ENTRIES ||
      3u * SMAP_BLOB(map)[SMAP_AT_CONTACTS] + 3u * body[SMAP_IN_AXES] > SMAP_MAX_COORDINATES ||
      3u + 3u * SMAP_BLOB(map)[SMAP_AT_CONTACTS] + 3u * body[SMAP_IN_AXES] > 255u ||
      (body[SMAP_IN_FLAGS] & ~(SMAP_MANY ? SMAP_SHARED : 0)) > 15) {
    return 0;
  }
  at = smap_places(map);
  shared = SMAP_MANY && (body[SMAP_IN_FLAGS] & SMAP_SHARED);
  if (at.end != limit || !smap_check_singles(body + SMAP_IN_LOWEST, 3) ||
      !smap_check_singles(at.weights, (uint32_t)((shared ? at.codes : at.joints) - at.weights) / 4u)) {
    return 0;
  }
  for (i = 0; shared && i < (uint32_t)(at.joints - at.codes); i++) { /* of terms, then of contacts */
    if ((at.codes[i] & (i < terms ? 127u : 255u)) >= body[SMAP_IN_ORDER]) {
      return 0;
    }
  }
  for (i = 0; i < (uint32_t)(at.products - at.joints); i++) {
    if (at.joints[i] >= SMAP_BLOB(map)[SMAP_AT_PARAMS]) {
      return 0;
    }
  }
  for (i = 0; i < 2u * body[SMAP_IN_PRODUCTS]; i++) { /* a product of what is known before it */
    if (at.products[i] >= fixed + i / 2u) {
      return 0;
    }
  }
  for (i = 0; at.axis_of + i < at.counts; i++) {
    if (at.axis_of[i] != SMAP_NO_AXIS && at.axis_of[i] >= body[SMAP_IN_AXES]) {
      return 0;
    }
  }
  for (i = 0; i < at.coordinates; i++) {
    sum += at.counts[i];
  }
  for (i = 0; i < terms; i++) {
    if (at.entries[i] >= fixed + body[SMAP_IN_PRODUCTS]) {
      return 0;
    }
  }
  return sum == terms;
}
#endif

/* The codec's own part of a map that ends at `limit`. */
static int smap_check_body(const smap_t *map, smap_bytes_t limit)
{
  switch (SMAP_BLOB(map)[SMAP_AT_CODEC]) {
#if SMAP_POINTS
  case SMAP_CODEC_POINTS:
    return SMAP_BLOB(map)[SMAP_AT_CONTACTS] == 3 && smap_check_positions(map, limit);
#endif
#if SMAP_TABLES
  case SMAP_CODEC_TABLES:
    return smap_check_tables(map, limit);
#endif
#if SMAP_GRID
  case SMAP_CODEC_GRID:
    return smap_check_grid(map, limit);
#endif
#if SMAP_MANY
#if SMAP_MANY_RAILS
  case SMAP_CODEC_RAILS:
#else
  case SMAP_CODEC_SEARCH:
#endif
    return smap_check_positions(map, limit) && smap_check_many(map);
#endif
  default:
    return 0;
  }
}

static int8_t smap_run_check(const smap_t *map)
{
  const smap_bytes_t blob = SMAP_BLOB(map);
  int good = map->size >= SMAP_AT_AXES && smap_u32(blob + SMAP_AT_BYTES) == map->size &&
             smap_crc(blob + 4, map->size - 4u) == smap_u32(blob) &&
             blob[SMAP_AT_VERSION] == SMAP_VERSION && blob[SMAP_AT_PARAMS] <= SMAP_MAX_PARAMS &&
             SMAP_AT_AXES + (uint32_t)SMAP_AXIS_BYTES * blob[SMAP_AT_PARAMS] < map->size;
#if SMAP_FLOATS
  good = good && smap_check_axes(map) && smap_check_singles(blob + SMAP_AT_LIMIT, 3) &&
         smap_is_positive(smap_f32(blob + SMAP_AT_STEP));
#endif
  return good && smap_check_body(map, blob + map->size) ? SMAP_OK : SMAP_CORRUPT;
}

