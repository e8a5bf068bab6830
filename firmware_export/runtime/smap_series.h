/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- series: where the contacts are, of a robot that is given by code -----------------------------
 * With SMAP_BY_SERIES the coordinates are Chebyshev series of up to three parameters, each axis of
 * which may be cut into pieces.  Then positions have no tables, and behind what is for many contacts stands
 *
 *   0 unit f32, length of one code    4 terms u16    6 products u8
 *   per parameter its pieces u8 and highest degree u8; per parameter and piece begin f32, 2 / length f32;
 *   per group u8 the parameters (bits) by which its pieces go: SMAP_COMMON, if it is there, then contacts;
 *   per group and piece, the last parameter fastest: its first term u16, terms of x, y and z u8;
 *   products u8[2 products]; entry of each term u8; code of each term i16, with SMAP_WIDE i24
 *
 * With s from -1 to 1 over a piece, entries are 1, then T_1(s), T_2(s) .. of each parameter, then the
 * products of two. */
enum {
  SMAP_SERIES_AXES = 3, /* parameters at most */
  SMAP_SERIES_TERMS = 4,
  SMAP_SERIES_PRODUCTS = 6,
  SMAP_SERIES_HEAD = 7,
  SMAP_KNOT_BYTES = 8,
  SMAP_ROW_BYTES = 5
};

typedef struct {
  smap_bytes_t axes, knots, masks, rows, products, entries, codes;
} smap_series_t;

/* The groups of three coordinates. */
SMAP_INLINE uint8_t smap_series_groups(const smap_t *map)
{
  return (uint8_t)(SMAP_BLOB(map)[SMAP_AT_CONTACTS] + (smap_body(map)[SMAP_IN_FLAGS] & SMAP_COMMON ? 1 : 0));
}

/* The pieces of a group, and in `row` the one that the posture is in. */
SMAP_INLINE uint16_t smap_series_pieces(smap_bytes_t axes, uint8_t params, uint8_t mask,
                                        const uint8_t *cell, uint16_t *row)
{
  uint16_t all = 1;
  uint8_t j;
  *row = 0;
  for (j = 0; j < params; j++) {
    if (mask >> j & 1u) {
      *row = (uint16_t)(*row * axes[2 * j] + cell[j]);
      all = (uint16_t)(all * axes[2 * j]);
    }
  }
  return all;
}

SMAP_INLINE smap_series_t smap_series_begin(const smap_t *map)
{
  const smap_bytes_t body = smap_body(map) + SMAP_IN_MANY + smap_u16(smap_body(map) + SMAP_IN_MANY_BYTES);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS], groups = smap_series_groups(map);
  const uint8_t none[SMAP_SERIES_AXES] = {0, 0, 0};
  smap_series_t at;
  uint16_t row;
  uint8_t i;
  at.axes = body + SMAP_SERIES_HEAD;
  at.knots = at.masks = at.axes + 2 * params;
  for (i = 0; i < params; i++) {
    at.masks += SMAP_KNOT_BYTES * at.axes[2 * i];
  }
  at.rows = at.products = at.masks + groups;
  for (i = 0; i < groups; i++) {
    at.products += SMAP_ROW_BYTES * smap_series_pieces(at.axes, params, at.masks[i], none, &row);
  }
  at.entries = at.products + 2 * body[SMAP_SERIES_PRODUCTS];
  at.codes = at.entries + smap_u16(body + SMAP_SERIES_TERMS);
  return at;
}

/* The piece of each parameter, and the entries. */
SMAP_INLINE void smap_series_entries(const smap_t *map, const smap_series_t *at, const float *q,
                                     uint8_t cell[SMAP_SERIES_AXES], float entry[SMAP_MAX_ENTRIES])
{
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  smap_bytes_t knots = at->knots, pair;
  uint8_t count = 1, j, n;
  entry[0] = 1.0f;
  for (j = 0; j < params; j++) {
    const uint8_t pieces = at->axes[2 * j], degree = at->axes[2 * j + 1];
    float s, before = 1.0f, value;
    for (n = 1; n < pieces && q[j] >= smap_f32(knots + SMAP_KNOT_BYTES * n); n++) {
    }
    cell[j] = (uint8_t)(n - 1);
    s = value = (q[j] - smap_f32(knots + SMAP_KNOT_BYTES * cell[j])) *
                    smap_f32(knots + SMAP_KNOT_BYTES * cell[j] + 4) - 1.0f;
    /*@ admit \is_finite(s) && -1.01 <= s <= 1.01; */
    for (n = 0; n < degree; n++) {
      const float next = 2.0f * s * value - before;
      entry[count++] = value;
      before = value;
      value = next;
    }
    knots += SMAP_KNOT_BYTES * pieces;
  }
  for (pair = at->products; pair < at->entries; pair += 2) {
    entry[count++] = entry[pair[0]] * entry[pair[1]];
  }
}

/* A code, in units. */
SMAP_INLINE float smap_series_code(smap_bytes_t codes, int wide, uint16_t term)
{
  if (wide) {
    const smap_bytes_t at = codes + 3 * (uint32_t)term;
    const int32_t code = (int32_t)((uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16);
    return (float)(code >= 8388608 ? code - 16777216 : code);
  }
  return (float)(int16_t)smap_u16(codes + 2 * (uint32_t)term);
}

/* Contacts relative to the centre of mass, p[3 * contact]. */
SMAP_PLAIN void smap_series_positions(const smap_t *map, const float *q, float *p)
{
  const smap_series_t at = smap_series_begin(map);
  const uint8_t groups = smap_series_groups(map), params = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  const uint8_t flags = smap_body(map)[SMAP_IN_FLAGS], first = flags & SMAP_COMMON ? 1 : 0;
  const float unit = smap_f32(at.axes - SMAP_SERIES_HEAD);
  float entry[SMAP_MAX_ENTRIES], common[3] = {0.0f, 0.0f, 0.0f};
  uint8_t cell[SMAP_SERIES_AXES] = {0, 0, 0}, i, c, k;
  smap_bytes_t rows = at.rows;
  smap_series_entries(map, &at, q, cell, entry);
  for (i = 0; i < groups; i++) {
    uint16_t row, term;
    const uint16_t all = smap_series_pieces(at.axes, params, at.masks[i], cell, &row);
    const smap_bytes_t from = rows + SMAP_ROW_BYTES * row;
    term = smap_u16(from);
    for (c = 0; c < 3; c++) {
      float sum = 0.0f;
      for (k = 0; k < from[2 + c]; k++, term++) {
        sum += smap_series_code(at.codes, flags & SMAP_WIDE, term) * entry[at.entries[term]];
      }
      if (i < first) {
        common[c] = sum;
      } else {
        p[3 * (i - first) + c] = (sum + common[c]) * unit;
      }
    }
    rows += SMAP_ROW_BYTES * all;
  }
}

/* How many rows the groups have together; 0 where a mask is wrong, or they are more than `most`. */
static uint32_t smap_check_series_rows(smap_bytes_t axes, uint8_t params, smap_bytes_t masks,
                                       uint8_t groups, uint32_t most)
{
  uint32_t rows = 0;
  uint8_t i, j;
  for (i = 0; i < groups; i++) {
    uint32_t all = 1;
    for (j = 0; j < params; j++) {
      all *= masks[i] >> j & 1u ? axes[2 * j] : 1u;
    }
    rows += all;
    if (masks[i] >> params != 0 || all > 65535u || rows > most) {
      return 0;
    }
  }
  return rows;
}

/* Sizes, up to `limit`: nothing is read before it is known to be there. */
SMAP_PLAIN int smap_check_series(const smap_t *map, smap_bytes_t limit)
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS], contacts = SMAP_BLOB(map)[SMAP_AT_CONTACTS];
  const uint8_t groups = smap_series_groups(map), flags = body[SMAP_IN_FLAGS];
  const uint32_t bytes = (uint32_t)(limit - body), many = smap_u16(body + SMAP_IN_MANY_BYTES);
  uint32_t need = SMAP_IN_MANY + many + SMAP_SERIES_HEAD + 2u * params, fixed = 1, knots = 0, terms, rows, i;
  smap_bytes_t head, axes, row;
  smap_series_t at;
  if ((flags & ~(SMAP_COMMON | SMAP_WIDE)) != SMAP_BY_SERIES || smap_u32(body) != 0 ||
      smap_u16(body + SMAP_IN_TERMS) != 0 || params > SMAP_SERIES_AXES || need > bytes ||
      contacts < 3 || 3u * contacts > SMAP_MAX_COORDINATES) {
    return 0;
  }
  head = body + SMAP_IN_MANY + many;
  axes = head + SMAP_SERIES_HEAD;
  terms = smap_u16(head + SMAP_SERIES_TERMS);
  for (i = 0; i < params; i++) {
    knots += axes[2 * i];
    fixed += axes[2 * i + 1];
    if (axes[2 * i] == 0) {
      return 0;
    }
  }
  need += SMAP_KNOT_BYTES * knots + groups;
  if (need > bytes || fixed + head[SMAP_SERIES_PRODUCTS] > SMAP_MAX_ENTRIES ||
      !smap_check_singles(head, 1, 4, SMAP_LARGEST) ||
      !smap_check_singles(axes + 2u * params, 2u * knots, 4, SMAP_LARGEST)) {
    return 0;
  }
  rows = smap_check_series_rows(axes, params, body + need - groups, groups, bytes / SMAP_ROW_BYTES);
  if (rows == 0 || need + SMAP_ROW_BYTES * rows > bytes) {
    return 0;
  }
  need += SMAP_ROW_BYTES * rows + 2u * head[SMAP_SERIES_PRODUCTS] + (flags & SMAP_WIDE ? 4u : 3u) * terms;
  if (need != bytes) {
    return 0;
  }
  at = smap_series_begin(map);
  for (row = at.rows; row < at.products; row += SMAP_ROW_BYTES) {
    if ((uint32_t)smap_u16(row) + row[2] + row[3] + row[4] > terms) {
      return 0;
    }
  }
  return smap_check_entries(at.products, head[SMAP_SERIES_PRODUCTS], fixed, at.entries, terms);
}
