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

#if SMAP_FLOATS
/* The point of a table, in units, at places from 0 to 65536 of the parameters. */
SMAP_INLINE void smap_table_point(const smap_table_t *table, int wide, const float *place, float p[3])
{
  const uint8_t axes = table->axes[0], corners = (uint8_t)(1u << axes);
  float part[SMAP_TABLE_AXES];
  uint32_t cell[SMAP_TABLE_AXES];
  uint8_t corner, k, c;
  SMAP_UNROLL
  for (k = 0; k < axes; k++) {
    const float last = (float)(table->axes[2 + 2 * k] - 1), x = place[table->axes[1 + 2 * k]] * last;
    const uint32_t whole = (uint32_t)(int32_t)x;
    cell[k] = whole < (uint32_t)last ? whole : (uint32_t)last - 1u;
    part[k] = x - (float)cell[k];
  }
  p[0] = p[1] = p[2] = 0.0f;
  SMAP_UNROLL
  for (corner = 0; corner < corners; corner++) {
    float weight = 1.0f;
    uint32_t at = 0;
    SMAP_UNROLL
    for (k = 0; k < axes; k++) {
      const int up = corner >> k & 1;
      at = at * table->axes[2 + 2 * k] + cell[k] + (uint32_t)up;
      weight *= up ? part[k] : 1.0f - part[k];
    }
    SMAP_UNROLL
    for (c = 0; c < 3; c++) {
      const float value = (float)smap_table_code(table->codes, wide, 3 * at + c) * weight;
      p[c] = corner == 0 ? value : p[c] + value;
    }
  }
}

SMAP_INLINE void smap_table_points(const smap_t *map, const float *q, float p[9])
{
  const smap_bytes_t body = smap_body(map);
  float place[SMAP_MAX_PARAMS];
  smap_table_t table[3];
  uint8_t i;
  place[0] = 0.0f; /* of a robot of fixed shape nothing else is */
  (void)smap_table_begin(map, table);
  SMAP_UNROLL
  for (i = 0; i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++) {
    const smap_bytes_t axis = body + 8 + SMAP_PLACE_BYTES * i;
    const float x = (q[i] - smap_f32(axis)) * smap_f32(axis + 4);
    place[i] = x < 0.0f ? 0.0f : x > 1.0f ? 1.0f : x;
  }
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    smap_table_point(&table[i], body[4] != 0, place, &p[3 * i]);
  }
  SMAP_UNROLL
  for (i = 0; i < 9; i++) {
    p[i] *= smap_f32(body);
  }
}
#else
/* The same without floats, of places from 0 to 65535. */
SMAP_INLINE void smap_table_point_i(const smap_table_t *table, int wide, const uint16_t *place,
                                    int32_t p[3])
{
  const uint8_t axes = table->axes[0], corners = (uint8_t)(1u << axes);
  uint32_t part[SMAP_TABLE_AXES], cell[SMAP_TABLE_AXES];
  uint8_t corner, k, c;
  SMAP_UNROLL
  for (k = 0; k < axes; k++) {
    const uint32_t x = (uint32_t)place[table->axes[1 + 2 * k]] * (table->axes[2 + 2 * k] - 1u);
    cell[k] = x >> 16;
    part[k] = x >> 2 & 16383u;
  }
  if (axes == 1) { /* one product for each number */
    SMAP_UNROLL
    for (c = 0; c < 3; c++) {
      const int32_t low = smap_table_code(table->codes, wide, 3 * cell[0] + c);
      const int32_t high = smap_table_code(table->codes, wide, 3 * cell[0] + 3u + c);
      p[c] = low + (((high - low) * (int32_t)part[0]) >> 14);
    }
    return;
  }
  p[0] = p[1] = p[2] = 0;
  SMAP_UNROLL
  for (corner = 0; corner < corners; corner++) {
    uint32_t weight = 16384u, at = 0;
    SMAP_UNROLL
    for (k = 0; k < axes; k++) {
      const int up = corner >> k & 1;
      at = at * table->axes[2 + 2 * k] + cell[k] + (uint32_t)up;
      weight = weight * (up ? part[k] : 16384u - part[k]) >> 14;
    }
    SMAP_UNROLL
    for (c = 0; c < 3; c++) {
      p[c] += (smap_table_code(table->codes, wide, 3 * at + c) * (int32_t)weight) >> 14;
    }
  }
}

/* Places of the parameters: first u16, and for one step u16 / 2^14. */
SMAP_INLINE int8_t smap_table_places(const smap_t *map, const int16_t *params_q, uint16_t *place)
{
  int16_t q[SMAP_MAX_PARAMS];
  const int8_t status = smap_range_q(map, params_q, q);
  uint8_t i;
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  SMAP_UNROLL
  for (i = 0; i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++) {
    const smap_bytes_t axis = smap_body(map) + 8 + SMAP_PLACE_BYTES * i;
    const int32_t x =
        (int32_t)smap_u16(axis + 8) + ((int32_t)smap_u16(axis + 10) * q[i] + 8192) / 16384;
    place[i] = (uint16_t)(x < 0 ? 0 : x > 65535 ? 65535 : x);
  }
  return SMAP_OK;
}

/* Make a vector's length 16383; its parts stay in 30 bits. */
SMAP_INLINE void smap_table_unit(const int32_t v[3], int16_t out[3])
{
  int32_t part[3];
  uint32_t most = 32767, shift = 0, length = 1;
  uint8_t i;
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    most |= (uint32_t)(v[i] ^ -(v[i] < 0));
  }
#if defined(__GNUC__) && !defined(__AVR__)
  shift = 17u - (uint32_t)__builtin_clz((unsigned)most);
#else
  for (; most >> shift > 32767u; shift++) {
  }
#endif
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    part[i] = v[i] >> shift;
    /*@ admit -32768 <= part[i] <= 32767; */
    length += (uint32_t)(part[i] * part[i]);
  }
  length = smap_whole_root(length);
  /*@ admit length > 0; */
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    out[i] = (int16_t)(part[i] * 16383 / (int32_t)length);
    /*@ admit -16383 <= out[i] <= 16383; */
  }
}

SMAP_INLINE void smap_table_make(const smap_t *map, const uint16_t *place, smap_three_i_t *out)
{
  const int wide = smap_body(map)[4] != 0;
  smap_table_t table[3];
  int32_t p[9], edge[3], normal[3] = {0, 0, 0}, high;
  uint8_t i;
  (void)smap_table_begin(map, table);
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    smap_table_point_i(&table[i], wide, place, &p[3 * i]);
    /*@ admit -16400 <= p[3 * i] <= 16400 && -16400 <= p[3 * i + 1] <= 16400; */
    /*@ admit -16400 <= p[3 * i + 2] <= 16400; */
  }
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    const int32_t *const a = &p[3 * i], *const b = i == 2 ? p : &p[3 * i + 3];
    edge[0] = a[1] * b[2] - a[2] * b[1];
    edge[1] = a[2] * b[0] - a[0] * b[2];
    edge[2] = a[0] * b[1] - a[1] * b[0];
    normal[0] += edge[0];
    normal[1] += edge[1];
    normal[2] += edge[2];
    smap_table_unit(edge, &out->wall[3 * i]);
  }
  smap_table_unit(normal, out->normal);
  high = (out->normal[0] * p[0] + out->normal[1] * p[1] + out->normal[2] * p[2]) >> 14;
  out->height = (uint16_t)(high > 0 ? high : 0);
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    out->centroid[i] = (int16_t)((p[i] + p[i + 3] + p[i + 6]) / 3);
  }
}
#endif

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
#if SMAP_FLOATS
  for (i = 0; i < params; i++) { /* so that no place is infinite or no number */
    const smap_bytes_t place = body + 8 + SMAP_PLACE_BYTES * i;
    if (!smap_is_within(smap_f32(place), 1e12f) || !smap_is_within(smap_f32(place + 4), 1e12f)) {
      return 0;
    }
  }
#endif
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

