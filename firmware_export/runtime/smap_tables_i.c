/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- tables_i: the same without floats ----------------------------------------------------------------- */
#define SMAP_CODEC SMAP_CODEC_TABLES
#define SMAP_INLINE SMAP_FOLDED
#define SMAP_UNROLL SMAP_SOME
#include "smap_query.h"
#include "smap_three.h"
#include "smap_lookup.h"

typedef smap_three_pose_i_t smap_pose_memory_t;
typedef smap_three_pose_i_t smap_pose_memory_i_t;

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
  uint32_t most = 32767, shift, length = 1;
  uint8_t i;
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    most |= (uint32_t)(v[i] ^ -(v[i] < 0));
  }
  shift = 17u - SMAP_ZEROS(most);
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

static int8_t smap_run_at_i(const smap_pose_t *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  return smap_three_at_i(pose, &((const smap_three_pose_i_t *)pose)->whole, gravity, out);
}

static int8_t smap_run_pose_q(const smap_t *map, const int16_t *params_q, smap_pose_t *pose, uint16_t bytes,
                              uint8_t forms)
{
  smap_three_pose_i_t *const made = (smap_three_pose_i_t *)pose;
  uint16_t place[SMAP_MAX_PARAMS];
  if (!smap_begin(map, pose, bytes, forms, SMAP_INTEGER, sizeof *made)) {
    return SMAP_INVALID;
  }
  place[0] = 0; /* of a robot of fixed shape nothing else is */
  made->head.status = smap_table_places(map, params_q, place);
  if (made->head.status == SMAP_OK) {
    smap_table_make(map, place, &made->whole);
  }
  return made->head.status;
}

static int8_t smap_run_read_i(const smap_t *map, const int16_t *params_q, const int16_t *gravity_q,
                              smap_reading_i_t *out)
{
  uint16_t place[SMAP_MAX_PARAMS];
  smap_three_i_t made;
  int32_t g[3];
  uint32_t length;
  int8_t status;
  place[0] = 0;
  status = smap_table_places(map, params_q, place);
  if (status == SMAP_OK) {
    status = smap_direction_i(map, gravity_q, g, &length);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny_i(out, status);
  }
  smap_table_make(map, place, &made);
  return smap_three_read_i(map, smap_three_order(map), &made, g, length, out);
}

static int smap_check_own(const smap_t *map, smap_bytes_t limit)
{
  return smap_check_tables(map, limit);
}

static const smap_runtime_t smap_run = {smap_no_pose, smap_run_pose_q, smap_no_at,    smap_run_at_i,
                                        smap_no_read, smap_run_read_i, smap_run_check};
