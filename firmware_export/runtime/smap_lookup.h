/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- tables: three contact points from tables over the parameters ------------------------------------
 * Only the points are looked up, so readings are exact in gravity.  The body: 0 length of one unit f32;
 * 4 codes of 16 bits u8; 7 order u8; 8 per parameter SMAP_PLACE_BYTES, see smap_place; then per point its
 * axes u8 and per axis parameter u8 and nodes u8, evenly spaced; then per point and node x, y, z, the last
 * axis fastest: i16, or i8 in 128 units. */
enum { SMAP_PLACE_BYTES = 12, SMAP_TABLE_AXES = 4 };

/* A point's table: its axes, and its codes. */
typedef struct {
  smap_bytes_t axes, codes;
} smap_table_t;

/* Where the axes of the points and their codes begin; returns the end of the last. */
SMAP_INLINE smap_bytes_t smap_table_begin(const smap_t *map, smap_table_t table[3])
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t bytes = body[4] ? 6 : 3;
  smap_bytes_t at = body + 8 + SMAP_PLACE_BYTES * SMAP_BLOB(map)[SMAP_AT_PARAMS];
  uint8_t i, k;
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    table[i].axes = at;
    at += 1 + 2 * at[0];
  }
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    uint32_t nodes = 1;
    table[i].codes = at;
    SMAP_UNROLL
    for (k = 0; k < table[i].axes[0]; k++) {
      nodes *= table[i].axes[2 + 2 * k];
    }
    at += bytes * nodes;
  }
  return at;
}

/* One code, in units. */
SMAP_INLINE int32_t smap_table_code(smap_bytes_t codes, int wide, uint32_t at)
{
  return wide ? (int16_t)smap_u16(codes + 2 * at) : (int8_t)codes[at] * 128;
}

/* Axes that exist, and tables that end where the map ends. */
static int smap_check_tables(const smap_t *map, smap_bytes_t limit)
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  smap_bytes_t at = body + 8 + SMAP_PLACE_BYTES * params;
  smap_table_t table[3];
  uint32_t total = 0, nodes;
  uint8_t i, k;
  if (limit - at < 0 || body[4] > 1 || !smap_is_finite(smap_f32(body))) {
    return 0;
  }
  for (i = 0; i < 3; i++) {
    nodes = 1;
    if (at >= limit || at[0] > SMAP_TABLE_AXES || limit - at < 1 + 2 * at[0]) {
      return 0;
    }
    for (k = 0; k < at[0]; k++) {
      if (at[1 + 2 * k] >= params || at[2 + 2 * k] < 2 || nodes > 65535u) {
        return 0;
      }
      nodes *= at[2 + 2 * k];
    }
    total += nodes;
    at += 1 + 2 * at[0];
  }
  if ((uint32_t)(limit - at) != total * (body[4] ? 6u : 3u)) {
    return 0;
  }
  for (nodes = 0; body[4] && nodes < 3u * total; nodes++) { /* products stay in 30 bits */
    if (((smap_u16(at + 2 * nodes) + 16384u) & 0x8000u) != 0u) {
      return 0;
    }
  }
  return smap_table_begin(map, table) == limit;
}
