/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- grid: multilinear tables over the parameters and the chart ------------------------------------
 * The body: 0 units of an axis for one of u or v f32; 4 chart limit u32, times 2^13 and 32768/32767;
 * 8 where the knots are u32; 12 tables u8.  From 16 per parameter: where its axis begins f32, 1 / its
 * length f32, the same in steps: place = first u16 + (step x u16 >> 14).  Then per table SMAP_PART_BYTES:
 * the tip margin mu = sine of the tip angle x |(u, v, 1)|, the two components of D_g - s, the height.
 * Then axes (coordinate, nodes, first knot or SMAP_EVEN: u16 each, innermost first), knots (0 to 65534),
 * codes.  Knots that are evenly spaced are not held. */
enum {
  SMAP_PART_CODES = 0,  /* u32, from the body on */
  SMAP_PART_AXES = 4,   /* u32 */
  SMAP_PART_STRIDE = 8, /* u32, codes of one face; 0: all faces are alike */
  SMAP_PART_OFFSET = 12, /* 2 f32: value = offset + step x code */
  SMAP_PART_STEP = 20,
  SMAP_PART_ZERO = 24, /* 2 u32: the code of 0 in 1/65536 of the range; the height's value at code 0 */
  SMAP_PART_GAIN = 32, /* u16: the output of one such unit, times 2^shift */
  SMAP_PART_SHIFT = 34,
  SMAP_PART_DIMS = 35,
  SMAP_PART_WIDTH = 36, /* codes of a node */
  SMAP_PART_WIDE = 37,  /* 1: codes of 16 bits */
  SMAP_PART_BYTES = 38
};
#define SMAP_EVEN 65535u
#define SMAP_CELLS 1.52592e-5f /* a hair less than 1/65534: no place is beyond the last cell */
#define SMAP_GRID_U 254 /* coordinates above every parameter's number */
#define SMAP_GRID_AXES (SMAP_MAX_PARAMS + 2)

/* A pose: the places of the parameters on their axes, 0 to 65534, without floats 0 to 65535. */
typedef struct {
  smap_head_t head;
  uint16_t place[SMAP_MAX_PARAMS + (SMAP_MAX_PARAMS & 1)];
} smap_grid_pose_i_t;
typedef struct {
  smap_head_t head;
#if SMAP_FLOATS
  float place[SMAP_MAX_PARAMS];
#else
  uint16_t place[SMAP_MAX_PARAMS + (SMAP_MAX_PARAMS & 1)];
#endif
} smap_grid_pose_t;
typedef smap_grid_pose_t smap_pose_memory_t;
typedef smap_grid_pose_i_t smap_pose_memory_i_t;

SMAP_INLINE smap_bytes_t smap_part(smap_bytes_t body, uint8_t params, uint8_t part)
{
  return body + 16 + 12 * params + SMAP_PART_BYTES * part;
}

/* The first knot of the cell of a place on an axis; a knot is in the cell that it begins. */
SMAP_INLINE uint16_t smap_cell(smap_bytes_t knots, uint16_t nodes, uint32_t x)
{
  uint16_t lower = 0, left;
  SMAP_UNROLL
  for (left = (uint16_t)(nodes - 1u); left > 1; left = (uint16_t)((left + 1u) >> 1)) {
    const uint16_t middle = (uint16_t)(lower + (left >> 1));
    lower = x >= smap_u16(knots + 2 * middle) ? middle : lower;
  }
  return lower;
}

/* Where a component of the first corner of a cell is. */
SMAP_INLINE smap_bytes_t smap_corner_of(smap_bytes_t body, smap_bytes_t part, uint32_t at)
{
  return body + smap_u32(part + SMAP_PART_CODES) + (part[SMAP_PART_WIDE] ? 2 * at : at);
}

SMAP_INLINE uint16_t smap_code(smap_bytes_t at, uint8_t wide)
{
  return wide ? smap_u16(at) : *at;
}

/* The face of a direction, its normal axis and the two others: of equal components the lower face. */
SMAP_INLINE uint8_t smap_face(const smap_t *map, const int32_t along[3], uint8_t axes[3])
{
  uint8_t face = 0, i;
  int32_t most = -along[2];
  axes[0] = 2;
  if (SMAP_BLOB(map)[SMAP_AT_FACES] == 6) {
    for (i = 1; i < 6; i++) {
      const uint8_t axis = i == 5 ? 2 : (uint8_t)((i - 1) >> 1);
      const int32_t toward = i & 1 ? along[axis] : -along[axis];
      if (toward > most) {
        most = toward;
        face = i;
        axes[0] = axis;
      }
    }
  }
  axes[1] = axes[0] == 0;
  axes[2] = axes[0] == 2 ? 1 : 2;
  return face;
}

#if SMAP_FLOATS
/* Where a query is on the axes of a table: first corner, the way to the next ones, the place between. */
typedef struct {
  uint32_t at, jump[SMAP_GRID_AXES];
  float frac[SMAP_GRID_AXES];
} smap_grid_cell_t;

/* `place`: of the parameters, 0 to 65534; then u and v. */
SMAP_INLINE void smap_grid_cell(smap_bytes_t body, smap_bytes_t part, const float *place,
                                uint8_t params, uint8_t face, smap_grid_cell_t *cell)
{
  const float half = smap_f32(body);
  const smap_bytes_t knots = body + smap_u32(body + 8);
  smap_bytes_t axis = body + smap_u32(part + SMAP_PART_AXES);
  uint32_t stride = part[SMAP_PART_WIDTH], back = 0;
  uint8_t i;
  cell->at = face * smap_u32(part + SMAP_PART_STRIDE);
  SMAP_UNROLL
  for (i = 0; i < part[SMAP_PART_DIMS]; i++, axis += 6) {
    const uint16_t coordinate = smap_u16(axis), nodes = smap_u16(axis + 2), first = smap_u16(axis + 4);
    const int chart = coordinate >= SMAP_GRID_U;
    const float at = place[chart ? params + coordinate - SMAP_GRID_U : coordinate];
    float x = chart ? at * half + 32767.0f : at; /* of the rim beyond 0 or 65534 by a rounding */
    uint32_t lower;
    if (first == SMAP_EVEN) {
      x *= (float)(nodes - 1) * SMAP_CELLS;
      lower = (uint32_t)(int32_t)x;
      cell->frac[i] = x - (float)(int32_t)lower;
    } else {
      const smap_bytes_t own = knots + 2 * first;
      float low, high;
      lower = smap_cell(own, nodes, (uint32_t)(int32_t)x);
      low = smap_u16(own + 2 * lower);
      high = smap_u16(own + 2 * lower + 2);
      cell->frac[i] = (x - low) / (high - low);
    }
    cell->at += lower * stride;
    cell->jump[i] = stride - back;
    back += stride;
    stride *= nodes;
  }
}

SMAP_INLINE float smap_grid_value(smap_bytes_t body, smap_bytes_t part, const smap_grid_cell_t *cell,
                                  uint8_t component)
{
  const uint8_t wide = part[SMAP_PART_WIDE];
  const uint16_t corners = (uint16_t)(1u << part[SMAP_PART_DIMS]);
  float below[SMAP_GRID_AXES], value = 0.0f;
  smap_bytes_t at = smap_corner_of(body, part, cell->at + component);
  uint16_t corner;
  SMAP_UNROLL
  for (corner = 0; corner < corners; corner++) {
    uint8_t level;
    value = smap_code(at, wide);
    SMAP_UNROLL
    for (level = 0; corner >> level & 1u; level++) {
      value = below[level] + (value - below[level]) * cell->frac[level];
    }
    if (level == part[SMAP_PART_DIMS]) {
      break;
    }
    below[level] = value;
    at += wide ? 2 * cell->jump[level] : cell->jump[level];
  }
  return smap_f32(part + SMAP_PART_OFFSET + 4 * component) + smap_f32(part + SMAP_PART_STEP) * value;
}

/* Places of the parameters; the tables reach as far as parameters may be beyond their axes. */
SMAP_INLINE int8_t smap_grid_places(const smap_t *map, const float *params, float *place)
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t count = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  const int8_t status = smap_range(map, params, place);
  uint8_t i;
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  SMAP_UNROLL
  for (i = 0; i < count; i++) {
    const float x = (place[i] - smap_f32(body + 16 + 12 * i)) * smap_f32(body + 20 + 12 * i);
    place[i] = x < 0.0f ? 0.0f : x > 65534.0f ? 65534.0f : x;
  }
  return SMAP_OK;
}

/* Read the tables at places of the parameters; `place` has room for u and v. */
SMAP_INLINE int8_t smap_grid_read(const smap_t *map, float *place, const float d[3],
                                  smap_reading_t *out)
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS], channels = SMAP_BLOB(map)[SMAP_AT_CHANNELS];
  smap_grid_cell_t cell;
  smap_bytes_t part = smap_part(body, params, 0);
  int32_t along[3];
  uint8_t axes[3], face, i;
  float slant = 1.0f, mu;
  for (i = 0; i < 3; i++) { /* bits of floats are in the order of their sizes */
    along[i] = (int32_t)(smap_bits(d[i]) & 0x7FFFFFFFu);
    along[i] = smap_bits(d[i]) >> 31 ? -along[i] : along[i];
  }
  face = smap_face(map, along, axes);
  for (i = 0; i < 2; i++) {
    const float at = d[axes[i + 1]];
    slant += at * at;
    place[params + i] = at;
  }
  out->over[0] = out->over[1] = 255;
  smap_grid_cell(body, part, place, params, face, &cell);
  mu = smap_grid_value(body, part, &cell, 0);
  out->tip_angle = smap_asin(mu / smap_root(slant)) - smap_f32(SMAP_BLOB(map) + SMAP_AT_GUARD);
  out->sdg = out->height = 0.0f;
  if (channels & SMAP_SDG) {
    float ahead, aside;
    part += SMAP_PART_BYTES;
    smap_grid_cell(body, part, place, params, face, &cell);
    ahead = smap_grid_value(body, part, &cell, 0);
    aside = smap_grid_value(body, part, &cell, 1);
    out->sdg = smap_root(ahead * ahead + aside * aside);
  }
  if (channels & SMAP_HEIGHT) {
    part += SMAP_PART_BYTES;
    smap_grid_cell(body, part, place, params, face, &cell);
    out->height = smap_grid_value(body, part, &cell, 0);
  }
  return smap_judge(map, out, SMAP_OK);
}

static int8_t smap_run_pose(const smap_t *map, const float *params, void *pose, uint16_t bytes,
                            uint8_t forms)
{
  smap_grid_pose_t *const made = (smap_grid_pose_t *)pose;
  if (!smap_begin(map, pose, bytes, forms, sizeof *made)) {
    return SMAP_INVALID;
  }
  made->head.status = smap_grid_places(map, params, made->place);
  return made->head.status;
}

static int8_t smap_run_at(const void *pose, const float *gravity, smap_reading_t *out)
{
  const smap_grid_pose_t *const made = (const smap_grid_pose_t *)pose;
  float place[SMAP_GRID_AXES], d[3];
  int8_t status = made->head.status;
  if (status == SMAP_OK) {
    status = smap_direction(made->head.map, gravity, d);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  memcpy(place, made->place, sizeof made->place);
  return smap_grid_read(made->head.map, place, d, out);
}

static int8_t smap_run_read(const smap_t *map, const float *params, const float *gravity,
                            smap_reading_t *out)
{
  float place[SMAP_GRID_AXES], d[3];
  int8_t status = smap_grid_places(map, params, place);
  if (status == SMAP_OK) {
    status = smap_direction(map, gravity, d);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  return smap_grid_read(map, place, d, out);
}
#endif

