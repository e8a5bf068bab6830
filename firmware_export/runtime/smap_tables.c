/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- tables: robots on three contact points, which are looked up in floats -------------------------- */
#define SMAP_CODEC SMAP_CODEC_TABLES
#define SMAP_INLINE SMAP_FOLDED
#define SMAP_UNROLL SMAP_SOME
#define SMAP_STEERED_BY "smap_control_three.c"
#include "smap_query.h"
#include "smap_three.h"
#include "smap_lookup.h"
#include "smap_three_run.h"

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

SMAP_INLINE int smap_three_at(const smap_t *map, const float *q, smap_three_t *out)
{
  float p[9];
  smap_table_points(map, q, p);
  return smap_three_make(p, 0, 0.0f, -2.0f, 0.0f, out);
}

static int smap_check_own(const smap_t *map, smap_bytes_t limit)
{
  const smap_bytes_t place = smap_body(map) + 8;
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  return smap_check_axes(map) && smap_check_tables(map, limit) &&
         smap_check_singles(place, params, SMAP_PLACE_BYTES, 1e12f) &&
         smap_check_singles(place + 4, params, SMAP_PLACE_BYTES, 1e12f);
}

static const smap_runtime_t smap_run = {smap_run_pose, smap_run_pose_q, smap_run_at,   smap_run_at_i,
                                        smap_run_read, smap_run_read_i, smap_run_check};
