/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- grid_i: the same without floats --------------------------------------------------------------------------- */
#if SMAP_INTEGERS

typedef struct {
  uint32_t at, jump[SMAP_GRID_AXES];
  uint16_t frac[SMAP_GRID_AXES]; /* 0 to 16384 */
} smap_grid_cell_i_t;

/* `place`: of the parameters, then of u and v, each 0 to 65534. */
SMAP_INLINE void smap_grid_cell_i(smap_bytes_t body, smap_bytes_t part, const uint16_t *place,
                                  uint8_t params, uint8_t face, smap_grid_cell_i_t *cell)
{
  const smap_bytes_t knots = body + smap_u32(body + 8);
  smap_bytes_t axis = body + smap_u32(part + SMAP_PART_AXES);
  uint32_t stride = part[SMAP_PART_WIDTH], back = 0;
  uint8_t i;
  cell->at = face * smap_u32(part + SMAP_PART_STRIDE);
  SMAP_UNROLL
  for (i = 0; i < part[SMAP_PART_DIMS]; i++, axis += 6) {
    const uint16_t coordinate = smap_u16(axis), nodes = smap_u16(axis + 2);
    const smap_bytes_t own = knots + 2 * smap_u16(axis + 4);
    const uint16_t x =
        place[coordinate >= SMAP_GRID_U ? params + coordinate - SMAP_GRID_U : coordinate];
    const uint16_t lower = smap_cell(own, nodes, x);
    const uint16_t low = smap_u16(own + 2 * lower), high = smap_u16(own + 2 * lower + 2);
    cell->frac[i] = (uint16_t)(((uint32_t)(x - low) << 14) / (uint32_t)(high - low));
    cell->at += lower * stride;
    cell->jump[i] = stride - back;
    back += stride;
    stride *= nodes;
  }
}

/* The value between two, rounded down; at a node one of the weights is 0 and the node comes out. */
SMAP_INLINE uint32_t smap_between(uint32_t low, uint32_t high, uint32_t frac)
{
  return (low * (16384u - frac) + high * frac) >> 14;
}

/* The value of a cell in 1/65536 of the codes' range, rounded down. */
SMAP_INLINE uint32_t smap_grid_value_i(smap_bytes_t body, smap_bytes_t part,
                                       const smap_grid_cell_i_t *cell, uint8_t component)
{
  const smap_bytes_t codes = body + smap_u32(part + SMAP_PART_CODES);
  const uint16_t corners = (uint16_t)(1u << part[SMAP_PART_DIMS]);
  uint16_t below[SMAP_GRID_AXES];
  uint32_t at = cell->at + component, value = 0;
  uint16_t corner;
  SMAP_UNROLL
  for (corner = 0; corner < corners; corner++) {
    uint8_t level;
    value = (uint32_t)smap_code(codes, part[SMAP_PART_WIDE], at) << (part[SMAP_PART_WIDE] ? 0 : 8);
    SMAP_UNROLL
    for (level = 0; corner >> level & 1u; level++) {
      value = smap_between(below[level], value, cell->frac[level]);
    }
    if (level == part[SMAP_PART_DIMS]) {
      break;
    }
    below[level] = (uint16_t)value;
    at += cell->jump[level];
  }
  return value;
}

/* Places of u and v, and the cosine of the slant in 1/16384, rounded so that the sine is too small. */
SMAP_INLINE int8_t smap_grid_uv(const smap_t *map, const int16_t gravity[3], uint16_t uv[2],
                                uint8_t *face, uint32_t *cosine)
{
  const uint32_t limit = smap_u32(smap_body(map) + 4);
  int32_t g[3];
  uint32_t length, deep, size;
  uint8_t axes[3], i;
  const int8_t status = smap_direction_i(map, gravity, g, &length);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  *face = smap_face(map, g, axes);
  size = (uint32_t)(g[axes[0]] < 0 ? -g[axes[0]] : g[axes[0]]);
  deep = size * limit >> 13;
  if (deep == 0) {
    return SMAP_OFF_CHART;
  }
  *cosine = (size << 14) / length;
  for (i = 0; i < 2; i++) {
    const int32_t at = g[axes[i + 1]];
    uint32_t away = (uint32_t)(at < 0 ? -at : at);
    if (away > deep + 1u) {
      return SMAP_OFF_CHART;
    }
    away = ((away > deep ? deep : away) << 15) / deep;
    away = away > 32767u ? 32767u : away;
    uv[i] = (uint16_t)(at < 0 ? 32767u - away : 32767u + away);
  }
  return SMAP_OK;
}

/* Read the tables at places of the parameters; `place` has room for u and v. */
static int8_t smap_grid_read_i(const smap_t *map, uint16_t *place, const int16_t gravity[3],
                               smap_reading_i_t *out)
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS], channels = SMAP_BLOB(map)[SMAP_AT_CHANNELS];
  smap_bytes_t part = smap_part(body, params, 0);
  smap_grid_cell_i_t cell;
  uint32_t cosine, value, zero = smap_u32(part + SMAP_PART_ZERO);
  uint8_t face;
  int tips;
  const int8_t status = smap_grid_uv(map, gravity, place + params, &face, &cosine);
  (void)smap_deny_i(out, status);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  smap_grid_cell_i(body, part, place, params, face, &cell);
  value = smap_grid_value_i(body, part, &cell, 0);
  tips = value < zero;
  value = tips ? zero - value : value - zero;
  value = (value * cosine >> 14) * smap_u16(part + SMAP_PART_GAIN) >> part[SMAP_PART_SHIFT];
  value = value > 32767u ? 32767u : value;
  out->tip = (int16_t)(tips ? -1 - (int32_t)(value > 32000u ? 32000u : value)
                            : (int32_t)value - (int32_t)smap_u16(SMAP_BLOB(map) + SMAP_AT_GUARD_I));
  if (out->tip < 0) {
    return SMAP_TIPS;
  }
  if (channels & SMAP_SDG) {
    int32_t along, aside;
    part += SMAP_PART_BYTES;
    zero = smap_u32(part + SMAP_PART_ZERO);
    smap_grid_cell_i(body, part, place, params, face, &cell);
    along = (int32_t)(smap_grid_value_i(body, part, &cell, 0) - zero) / 2;
    zero = smap_u32(part + SMAP_PART_ZERO + 4);
    aside = (int32_t)(smap_grid_value_i(body, part, &cell, 1) - zero) / 2;
    out->sdg = (uint16_t)smap_whole_root((uint32_t)along * (uint32_t)along +
                                         (uint32_t)aside * (uint32_t)aside);
  }
  if (channels & SMAP_HEIGHT) {
    part += SMAP_PART_BYTES;
    smap_grid_cell_i(body, part, place, params, face, &cell);
    value = smap_grid_value_i(body, part, &cell, 0) * smap_u16(part + SMAP_PART_GAIN);
    out->height = (uint16_t)(smap_u32(part + SMAP_PART_ZERO) + (value >> part[SMAP_PART_SHIFT]));
  }
  return SMAP_OK;
}

SMAP_INLINE int8_t smap_grid_places_i(const smap_t *map, const int16_t *params_q, uint16_t *place)
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
    place[i] = (uint16_t)(x < 0 ? 0 : x > 65534 ? 65534 : x);
  }
  return SMAP_OK;
}

static int8_t smap_run_pose_q(const smap_t *map, const int16_t *params_q, void *pose, uint16_t bytes,
                              uint8_t forms)
{
  smap_grid_pose_i_t *const made = (smap_grid_pose_i_t *)pose;
  if (!smap_begin(map, pose, bytes, forms, sizeof *made)) {
    return SMAP_INVALID;
  }
  made->head.status = smap_grid_places_i(map, params_q, made->place);
  return made->head.status;
}

static int8_t smap_run_at_i(const void *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  const smap_grid_pose_i_t *const made = (const smap_grid_pose_i_t *)pose;
  uint16_t place[SMAP_GRID_AXES];
  if (SMAP_RARELY(made->head.status != SMAP_OK)) {
    return smap_deny_i(out, made->head.status);
  }
  memcpy(place, made->place, sizeof(uint16_t) * SMAP_MAX_PARAMS);
  return smap_grid_read_i(made->head.map, place, gravity, out);
}

static int8_t smap_run_read_i(const smap_t *map, const int16_t *params_q, const int16_t *gravity_q,
                              smap_reading_i_t *out)
{
  uint16_t place[SMAP_GRID_AXES];
  const int8_t status = smap_grid_places_i(map, params_q, place);
  return SMAP_RARELY(status != SMAP_OK) ? smap_deny_i(out, status)
                                        : smap_grid_read_i(map, place, gravity_q, out);
}
#endif

