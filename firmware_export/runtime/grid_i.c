/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- grid_i: the same without floats --------------------------------------------------------------------------- */
#if SMAP_INTEGERS

typedef struct {
  uint32_t at, jump[SMAP_GRID_AXES], frac[SMAP_GRID_AXES]; /* the last 0 to 16384 */
} smap_grid_cell_i_t;

/* `place`: of the parameters, then of u and v, each 0 to 65535. */
SMAP_INLINE void smap_grid_cell_i(smap_bytes_t body, smap_bytes_t part, const uint32_t *place,
                                  uint8_t params, uint8_t face, smap_grid_cell_i_t *cell)
{
  const smap_bytes_t knots = body + smap_u32(body + 8);
  smap_bytes_t axis = body + smap_u32(part + SMAP_PART_AXES);
  uint32_t stride = part[SMAP_PART_WIDTH], back = 0;
  uint8_t i;
  cell->at = face * smap_u32(part + SMAP_PART_STRIDE);
  SMAP_UNROLL
  for (i = 0; i < part[SMAP_PART_DIMS]; i++, axis += 6) {
    const uint16_t coordinate = smap_u16(axis), nodes = smap_u16(axis + 2), first = smap_u16(axis + 4);
    const uint32_t x =
        place[coordinate >= SMAP_GRID_U ? params + coordinate - SMAP_GRID_U : coordinate];
    uint32_t lower;
    if (first == SMAP_EVEN) {
      const uint32_t last = nodes - 1u, at = x * last; /* at most just before the end of the last cell */
      lower = at >> 16;
      cell->frac[i] = at >> 2 & 16383u;
    } else {
      const smap_bytes_t own = knots + 2 * first;
      const uint32_t span = x - (x >> 15); /* 0 to 65534, as knots are */
      uint32_t low, high;
      lower = smap_cell(own, nodes, span);
      low = smap_u16(own + 2 * lower);
      high = smap_u16(own + 2 * lower + 2);
      cell->frac[i] = ((span - low) << 14) / (high - low);
    }
    cell->at += lower * stride;
    cell->jump[i] = stride - back;
    back += stride;
    stride *= nodes;
  }
}

/* The value between two, in 1/2^finer of their unit, rounded down; at a node the node comes out. */
SMAP_INLINE uint32_t smap_between(uint32_t low, uint32_t high, uint32_t frac, uint8_t finer)
{
  const int32_t way = (int32_t)((high - low) * frac); /* of a healthy map 2^30 at most, either way */
  return (low << finer) + (uint32_t)(way >> (14 - finer));
}

/* The value of a cell in 1/65536 of the codes' range, rounded down. */
SMAP_INLINE uint32_t smap_grid_value_i(smap_bytes_t body, smap_bytes_t part,
                                       const smap_grid_cell_i_t *cell, uint8_t component)
{
  const uint8_t wide = part[SMAP_PART_WIDE];
  const uint16_t corners = (uint16_t)(1u << part[SMAP_PART_DIMS]);
  const uint8_t finer = wide ? 0 : 8;
  uint32_t below[SMAP_GRID_AXES];
  smap_bytes_t at = smap_corner_of(body, part, cell->at + component);
  uint32_t value = 0;
  uint16_t corner;
  SMAP_UNROLL
  for (corner = 0; corner < corners; corner++) {
    uint8_t level;
    value = smap_code(at, wide);
    SMAP_UNROLL
    for (level = 0; corner >> level & 1u; level++) {
      value = smap_between(below[level], value, cell->frac[level], level == 0 ? finer : 0);
    }
    if (level == part[SMAP_PART_DIMS]) {
      break;
    }
    below[level] = value;
    at += wide ? 2 * cell->jump[level] : cell->jump[level];
  }
  return part[SMAP_PART_DIMS] == 0 ? value << finer : value;
}

/* Places of u and v. */
SMAP_INLINE int8_t smap_grid_uv(const smap_t *map, const int16_t gravity[3], uint32_t uv[2], uint8_t *face)
{
  const uint32_t limit = smap_u32(smap_body(map) + 4);
  int32_t g[3], size, deep;
  uint8_t axes[3], i;
  const uint32_t sum = smap_scale_counts(gravity, g);
  *face = smap_face(map, g, axes);
  size = *face & 1u ? g[axes[0]] : -g[axes[0]]; /* of all faces but the lowest the odd ones are ahead */
  deep = size > 0 ? (int32_t)((uint32_t)size * limit >> 13) : 0;
  if (deep == 0) {
    return sum == 0 ? (int8_t)SMAP_INVALID : (int8_t)SMAP_OFF_CHART;
  }
  for (i = 0; i < 2; i++) {
    uv[i] = (uint32_t)(32768 + g[axes[i + 1]] * 32768 / deep);
    if (SMAP_RARELY(uv[i] > 65535u)) {
      return SMAP_OFF_CHART;
    }
  }
  return SMAP_OK;
}

/* Read the trees and tables at places of the parameters; `place` has room for u and v. */
SMAP_INLINE int8_t smap_grid_read_i(const smap_t *map, uint32_t *place, const int16_t gravity[3],
                                    smap_reading_i_t *out)
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS], channels = SMAP_BLOB(map)[SMAP_AT_CHANNELS];
  uint16_t x[SMAP_TREE_AXES] = {0};
  smap_bytes_t part = smap_part(map, 0);
  smap_grid_cell_i_t cell;
  uint32_t value;
  uint8_t face, i;
  const int8_t status = smap_grid_uv(map, gravity, place + params, &face);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny_i(out, status);
  }
  SMAP_UNROLL
  for (i = 0; i < params; i++) {
    x[i] = (uint16_t)place[i];
  }
  smap_fold_uv(smap_fold(body, params), (int32_t)place[params] - 32768, (int32_t)place[params + 1] - 32768,
               x + params);
  if (!smap_tree(map, face, x)) {
    return smap_deny_i(out, SMAP_TIPS);
  }
  out->tip = 0;
  out->sdg = out->height = 65535;
  out->over[0] = out->over[1] = 255;
  if (SMAP_LENGTHS && (channels & SMAP_SDG)) {
    int32_t along, aside;
    smap_grid_cell_i(body, part, place, params, face, &cell);
    value = smap_grid_value_i(body, part, &cell, 0);
    along = (int32_t)(value - smap_u32(part + SMAP_PART_ZERO)) / 2;
    value = smap_grid_value_i(body, part, &cell, 1);
    aside = (int32_t)(value - smap_u32(part + SMAP_PART_ZERO + 4)) / 2;
    out->sdg = (uint16_t)smap_whole_root((uint32_t)along * (uint32_t)along +
                                         (uint32_t)aside * (uint32_t)aside);
    part += SMAP_PART_BYTES;
  }
  if (SMAP_LENGTHS && (channels & SMAP_HEIGHT)) {
    smap_grid_cell_i(body, part, place, params, face, &cell);
    value = smap_grid_value_i(body, part, &cell, 0) * smap_u16(part + SMAP_PART_GAIN);
    out->height = (uint16_t)(smap_u32(part + SMAP_PART_ZERO) + (value >> part[SMAP_PART_SHIFT]));
  }
  return SMAP_OK;
}

SMAP_INLINE int8_t smap_grid_places_i(const smap_t *map, const int16_t *params_q, uint32_t *place)
{
  const smap_bytes_t body = smap_body(map);
  int16_t q[SMAP_MAX_PARAMS];
  const int8_t status = smap_range_q(map, params_q, q);
  uint8_t i;
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  SMAP_UNROLL
  for (i = 0; i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++) {
    const int32_t step = (int32_t)smap_u16(body + 26 + 12 * i) * q[i];
    const int32_t x = (int32_t)smap_u16(body + 24 + 12 * i) + (step < 0 ? -(-step >> 14) : step >> 14);
    place[i] = (uint32_t)(x < 0 ? 0 : x > 65535 ? 65535 : x);
  }
  return SMAP_OK;
}

static int8_t smap_run_pose_q(const smap_t *map, const int16_t *params_q, void *pose, uint16_t bytes,
                              uint8_t forms)
{
  smap_grid_pose_i_t *const made = (smap_grid_pose_i_t *)pose;
  uint32_t place[SMAP_GRID_AXES];
  uint8_t i;
  if (!smap_begin(map, pose, bytes, forms, sizeof *made)) {
    return SMAP_INVALID;
  }
  made->head.status = smap_grid_places_i(map, params_q, place);
  for (i = 0; made->head.status == SMAP_OK && i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++) {
    made->place[i] = (uint16_t)place[i];
  }
  return made->head.status;
}

static int8_t smap_run_at_i(const void *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  const smap_grid_pose_i_t *const made = (const smap_grid_pose_i_t *)pose;
  uint32_t place[SMAP_GRID_AXES];
  uint8_t i;
  if (SMAP_RARELY(made->head.status != SMAP_OK)) {
    return smap_deny_i(out, made->head.status);
  }
  SMAP_UNROLL
  for (i = 0; i < SMAP_BLOB(made->head.map)[SMAP_AT_PARAMS]; i++) {
    place[i] = made->place[i];
  }
  return smap_grid_read_i(made->head.map, place, gravity, out);
}

static int8_t smap_run_read_i(const smap_t *map, const int16_t *params_q, const int16_t *gravity_q,
                              smap_reading_i_t *out)
{
  uint32_t place[SMAP_GRID_AXES];
  const int8_t status = smap_grid_places_i(map, params_q, place);
  return SMAP_RARELY(status != SMAP_OK) ? smap_deny_i(out, status)
                                        : smap_grid_read_i(map, place, gravity_q, out);
}
#endif
