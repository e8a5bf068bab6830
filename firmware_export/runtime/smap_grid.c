/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- grid: codes over the parameters, face, v and u, one multilinear reading, no floats ---------------
 * The body: 0 chart limit u32, times 8193; 4 codes of a table u32; 8 tables u8; 9 blocks of a table u8; 10 left
 * is as right u8; 11 0; 12 the block of each face 6 u8, 255: the robot tips; 18 0 u16; 20 where the codes are
 * u32.  From 24 per parameter: the place of step 0 u16, places for a step u16, times 2^14, the parameter that
 * it is in the mirror image u8, whether that is turned over u8 (1; 2: and it comes round).  Per axis
 * (parameters, v, u) nodes u8, knots u8, one more where it comes round; the knots u16, places 0 to 65535; per
 * table a code u8 for each node of each block, u fastest.  Code 100 is a tip angle of 0, a step 1/300 of a sine; of lengths code 0 is 0. */
#define SMAP_CODEC SMAP_CODEC_GRID
#define SMAP_INLINE SMAP_FOLDED
#define SMAP_UNROLL SMAP_SOME
#include "smap_query.h"

enum { SMAP_GRID_HEAD = 24, SMAP_GRID_PLACE = 6, SMAP_GRID_AXES = SMAP_MAX_PARAMS + 2 };
enum { SMAP_GRID_STANDS = 100 * 128, SMAP_GRID_MOST = 16383 }; /* the sine of 30 deg */

/* A pose: the places of the parameters on their axes. */
typedef struct {
  smap_pose_t head;
  uint16_t place[SMAP_MAX_PARAMS + (SMAP_MAX_PARAMS & 1)];
} smap_grid_pose_t;
typedef smap_grid_pose_t smap_pose_memory_t;
typedef smap_grid_pose_t smap_pose_memory_i_t;

/* Where a query is: its first node, the way from each corner to the next, the place between. */
typedef struct {
  uint32_t at, jump[SMAP_GRID_AXES];
  int32_t frac[SMAP_GRID_AXES]; /* 0 to 16384 */
} smap_grid_cell_t;

/* The cell of places x; 0 where it is beyond the table. */
SMAP_INLINE int smap_grid_find(smap_bytes_t body, uint8_t params, const uint16_t *x, smap_grid_cell_t *cell)
{
  const uint8_t axes = (uint8_t)(params + 2u);
  const smap_bytes_t axis = body + SMAP_GRID_HEAD + SMAP_GRID_PLACE * params;
  smap_bytes_t knots = axis + 2 * axes;
  uint32_t stride = 1, back = 0, lower[SMAP_GRID_AXES];
  uint8_t i;
  SMAP_UNROLL
  for (i = 0; i < axes; i++) {
    const uint32_t last = axis[2 * i + 1] - 1u;
    uint32_t at = 0, low, high;
    if (x[i] < smap_u16(knots) || x[i] > smap_u16(knots + 2 * last)) {
      return 0;
    }
    while (at + 1 < last && x[i] >= smap_u16(knots + 2 * at + 2)) {
      at++;
    }
    low = smap_u16(knots + 2 * at);
    high = smap_u16(knots + 2 * at + 2);
    cell->frac[axes - 1 - i] = (int32_t)(((uint32_t)(x[i] - low) << 14) / (high - low));
    cell->at = cell->at * axis[2 * i] + at;
    lower[i] = at;
    knots += 2 * last + 2;
  }
  SMAP_UNROLL
  for (i = 0; i < axes; i++) { /* innermost first; behind the last node of an axis that comes round is its first */
    const uint32_t at = lower[axes - 1 - i], nodes = axis[2 * (axes - 1 - i)];
    const uint32_t step = at + 1 < nodes ? stride : 0u - at * stride;
    cell->jump[i] = step - back;
    back += step;
    stride *= nodes;
  }
  return 1;
}

/* The reading of one table, 128 for a code, rounded down. */
SMAP_INLINE int32_t smap_grid_value(smap_bytes_t codes, uint8_t axes, const smap_grid_cell_t *cell)
{
  int32_t below[SMAP_GRID_AXES], value = 0;
  uint32_t at = cell->at;
  uint16_t corner;
  SMAP_UNROLL
  for (corner = 0; corner < 1u << axes; corner++) {
    uint8_t level;
    value = codes[at] * 128;
    SMAP_UNROLL
    for (level = 0; corner >> level & 1u; level++) {
      /*@ admit 0 <= value <= 32640 && 0 <= below[level] <= 32640 && 0 <= cell->frac[level] <= 16384; */
      value = below[level] + (((value - below[level]) * cell->frac[level]) >> 14);
    }
    if (level == axes) {
      break;
    }
    below[level] = value;
    at += cell->jump[level];
  }
  return value;
}

/* The face of a direction, its normal axis and the two others: of equal components the lower face. */
SMAP_INLINE uint8_t smap_face(const smap_t *map, const int32_t along[3], uint8_t axes[3])
{
  uint8_t face = 0, i;
  int32_t most = -along[2];
  axes[0] = 2;
  for (i = 1; i < SMAP_BLOB(map)[SMAP_AT_FACES]; i++) {
    const uint8_t axis = i == 5 ? 2 : (uint8_t)((i - 1) >> 1);
    const int32_t toward = i & 1 ? along[axis] : -along[axis];
    if (toward > most) {
      most = toward;
      face = i;
      axes[0] = axis;
    }
  }
  axes[1] = axes[0] == 0;
  axes[2] = axes[0] == 2 ? 1 : 2;
  return face;
}

static int8_t smap_run_at_i(const smap_pose_t *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  const smap_grid_pose_t *const made = (const smap_grid_pose_t *)pose;
  const smap_t *const map = made->head.map;
  const smap_bytes_t body = smap_body(map);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS], channels = SMAP_BLOB(map)[SMAP_AT_CHANNELS];
  smap_bytes_t codes;
  smap_grid_cell_t cell;
  uint16_t x[SMAP_GRID_AXES];
  int32_t g[3], deep, value;
  uint32_t sum;
  uint8_t axes[3], face, i, left;
  if (SMAP_RARELY(made->head.status != SMAP_OK)) {
    return smap_deny_i(out, made->head.status);
  }
  sum = smap_scale_counts(gravity, g);
  left = body[10] && g[1] < 0;
  g[1] = left ? -g[1] : g[1];
  face = smap_face(map, g, axes);
  deep = face & 1u ? g[axes[0]] : -g[axes[0]]; /* of all faces but the lowest the odd ones are ahead */
  deep = deep > 0 ? (int32_t)((uint32_t)deep * smap_u32(body) >> 13) : 0;
  if (deep == 0) {
    return smap_deny_i(out, sum == 0 ? (int8_t)SMAP_INVALID : (int8_t)SMAP_OFF_CHART);
  }
  for (i = 0; i < 2; i++) {
    const uint32_t place = (uint32_t)(32768 + g[axes[2 - i]] * 32768 / deep);
    if (SMAP_RARELY(place > 65535u)) {
      return smap_deny_i(out, SMAP_OFF_CHART);
    }
    x[params + i] = (uint16_t)place;
  }
  SMAP_UNROLL
  for (i = 0; i < params; i++) {
    const smap_bytes_t own = body + SMAP_GRID_HEAD + SMAP_GRID_PLACE * i;
    const uint16_t place = made->place[left ? own[4] : i];
    x[i] = left && own[5] ? (uint16_t)(65534u + own[5] - place) : place;
  }
  cell.at = body[12 + face];
  if (cell.at == 255 || !smap_grid_find(body, params, x, &cell)) {
    return smap_deny_i(out, SMAP_TIPS);
  }
  codes = body + smap_u32(body + 20);
  value = smap_grid_value(codes, (uint8_t)(params + 2u), &cell) - SMAP_GRID_STANDS;
  if (value < 0) {
    return smap_deny_i(out, SMAP_TIPS);
  }
  value = (value * 27961) >> 15; /* 32767 / (300 x 128), rounded down */
  out->tip = (int16_t)(value < SMAP_GRID_MOST ? value : SMAP_GRID_MOST);
  out->sdg = out->height = 65535;
  out->over[0] = out->over[1] = 255;
  if (channels & SMAP_SDG) {
    codes += smap_u32(body + 4);
    out->sdg = (uint16_t)smap_grid_value(codes, (uint8_t)(params + 2u), &cell);
  }
  if (channels & SMAP_HEIGHT) {
    codes += smap_u32(body + 4);
    out->height = (uint16_t)smap_grid_value(codes, (uint8_t)(params + 2u), &cell);
  }
  return SMAP_OK;
}

static int8_t smap_run_pose_q(const smap_t *map, const int16_t *params_q, smap_pose_t *pose, uint16_t bytes,
                              uint8_t forms)
{
  smap_grid_pose_t *const made = (smap_grid_pose_t *)pose;
  int16_t q[SMAP_MAX_PARAMS];
  uint8_t i;
  if (!smap_begin(map, pose, bytes, forms, SMAP_INTEGER, sizeof *made)) {
    return SMAP_INVALID;
  }
  made->head.status = smap_range_q(map, params_q, q);
  for (i = 0; made->head.status == SMAP_OK && i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++) {
    const smap_bytes_t own = smap_body(map) + SMAP_GRID_HEAD + SMAP_GRID_PLACE * i;
    const int32_t way = (int32_t)smap_u16(own + 2) * q[i];
    const int32_t place = (int32_t)smap_u16(own) + (way < 0 ? -(-way >> 14) : way >> 14);
    made->place[i] = (uint16_t)(place < 0 ? 0 : place > 65535 ? 65535 : place);
  }
  return made->head.status;
}

static int8_t smap_run_read_i(const smap_t *map, const int16_t *params_q, const int16_t *gravity_q,
                              smap_reading_i_t *out)
{
  smap_grid_pose_t pose;
  const int8_t status = smap_run_pose_q(map, params_q, &pose.head, sizeof pose, SMAP_INTEGER);
  return status != SMAP_OK ? smap_deny_i(out, status) : smap_run_at_i(&pose.head, gravity_q, out);
}

/* Axes whose knots ascend, blocks and mirror images that exist, tables that end where the map ends. */
static int smap_check_own(const smap_t *map, smap_bytes_t limit)
{
  const smap_bytes_t blob = SMAP_BLOB(map), body = smap_body(map);
  const uint8_t params = blob[SMAP_AT_PARAMS], faces = blob[SMAP_AT_FACES], channels = blob[SMAP_AT_CHANNELS];
  const uint8_t tables = (uint8_t)(1u + (channels & SMAP_SDG ? 1u : 0u) + (channels & SMAP_HEIGHT ? 1u : 0u));
  const uint32_t room = (uint32_t)(limit - body);
  uint32_t at = SMAP_GRID_HEAD + (uint32_t)SMAP_GRID_PLACE * params, nodes, i, k;
  uint32_t knots = at + 2u * params + 4u;
  if (params > 13 || room < knots || (faces != 1 && faces != 6) || body[8] != tables || body[9] - 1u > 5u ||
      body[10] > 1 || smap_u32(body) >= (uint32_t)1 << 17) {
    return 0;
  }
  nodes = body[9];
  for (i = 0; i < faces; i++) {
    if (body[12 + i] >= nodes && body[12 + i] != 255) {
      return 0;
    }
  }
  for (i = 0; i < params; i++) {
    const smap_bytes_t own = body + SMAP_GRID_HEAD + SMAP_GRID_PLACE * i;
    if (own[4] >= params || own[5] > 2) {
      return 0;
    }
  }
  for (i = 0; i < params + 2u; i++, at += 2) {
    const uint32_t count = body[at + 1];
    if (body[at] < 2 || count - body[at] > 1u || room - knots < 2u * count || nodes > room / body[at]) {
      return 0;
    }
    for (k = 1; k < count; k++) {
      if (smap_u16(body + knots + 2u * k) <= smap_u16(body + knots + 2u * k - 2u)) {
        return 0;
      }
    }
    if (i < params && (smap_u16(body + knots) != 0 || smap_u16(body + knots + 2u * count - 2u) != 65535u)) {
      return 0;
    }
    nodes *= body[at];
    knots += 2u * count;
  }
  return smap_u32(body + 20) == knots && smap_u32(body + 4) == nodes && room - knots == nodes * tables;
}

static const smap_runtime_t smap_run = {smap_no_pose, smap_run_pose_q, smap_no_at,    smap_run_at_i,
                                        smap_no_read, smap_run_read_i, smap_run_check};
