/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- grid: a tree that tells whether the robot stands, multilinear tables of lengths -----------------
 * The body: 0 units of an axis for one of u or v f32; 4 chart limit u32, times 2^13 and 32768/32767;
 * 8 where the knots are u32; 12 tables u8.  From 16 per parameter: where its axis
 * begins f32, 1 / its length f32, the same in steps: place = first u16 + (step x u16 >> 14).  Then the place of
 * v = 0 u16 and the rates ahead of it and behind it i16, in 1/8192, bits of a directory u8, 0; per face where its
 * tree is u32 and its bytes u16; and per table SMAP_PART_BYTES: the two components of D_g - s, the height.
 * Then axes (coordinate, nodes, first knot or SMAP_EVEN: u16 each, innermost first), knots (0 to 65534),
 * trees, codes.  Knots that are evenly spaced are not held. */
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
#define SMAP_TREE_AXES (SMAP_GRID_AXES <= 4 ? 4 : SMAP_GRID_AXES <= 8 ? 8 : 16) /* a power of two */
#define SMAP_TREE_BEHIND 16 /* bytes that are held behind a tree, as what is no tree may be read further */

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

SMAP_INLINE smap_bytes_t smap_fold(smap_bytes_t body, uint8_t params)
{
  return body + 16 + 12 * params;
}

SMAP_INLINE smap_bytes_t smap_part(const smap_t *map, uint8_t part)
{
  const smap_bytes_t blob = SMAP_BLOB(map);
  return smap_fold(smap_body(map), blob[SMAP_AT_PARAMS]) + 8 + 6 * blob[SMAP_AT_FACES] + SMAP_PART_BYTES * part;
}

/* What a leaf says of a place in it: a half-space, of 12 bits its limit, then 7 of a coefficient for each axis. */
SMAP_INLINE int smap_leaf(smap_bytes_t leaf, uint8_t dims, const uint16_t x[SMAP_TREE_AXES])
{
  int32_t sum = (2048 - (int32_t)(smap_u16(leaf) & 4095u)) * 2016 * dims;
  uint8_t bits = 12, k;
  SMAP_UNROLL
  for (k = 0; k < dims; k++) {
    const uint16_t word = (uint16_t)(smap_u16(leaf + (bits >> 3)) >> (bits & 7u));
    sum += ((int32_t)((word & 127u) ^ 64u) - 64) * (int32_t)x[k];
    bits = (uint8_t)(bits + 7u);
  }
  return sum > 0;
}

/* Does a place lie where the tree of a face says that the robot stands?  It begins with a directory: for each cell
 * of u and v, of so many bits each, u16: what it is (2 bits: 0 tips, 1 stands, 2 a leaf, 3 a node) and where it
 * is in the tree (14 bits).  A node halves its box along an axis:
 * axis (4 bits), what its halves are (2 bits each, the lower first: 0 tips, 1 stands, 2 a leaf, 3 a node), if
 * both are nodes the bytes of the lower one u8, or 255 and u16, then the halves, lower first but a leaf before a node.
 * `x`: places of 65536 in the box, of its dims axes, the rest 0; doubled with every half that is gone into. */
static int smap_tree(const smap_t *map, uint8_t face, uint16_t x[SMAP_TREE_AXES])
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t dims = (uint8_t)(SMAP_BLOB(map)[SMAP_AT_PARAMS] + 2u), leaf = (uint8_t)((7u * dims + 19u) >> 3);
  const smap_bytes_t own = smap_fold(body, (uint8_t)(dims - 2u)) + 8 + 6 * face;
  const smap_bytes_t tree = body + smap_u32(own);
  const uint16_t bytes = smap_u16(own + 4);
  const uint8_t bits = smap_fold(body, (uint8_t)(dims - 2u))[6];
  const uint32_t u = (uint32_t)x[dims - 2u] << bits, v = (uint32_t)x[dims - 1u] << bits;
  const uint32_t entry = smap_u16(tree + 2u * ((u >> 16) << bits | v >> 16));
  uint32_t at = entry & 16383u;
  uint8_t mine = (uint8_t)(entry >> 14);
  x[dims - 2u] = (uint16_t)u;
  x[dims - 1u] = (uint16_t)v;
  while (mine == 3 && at < bytes) { /* every turn goes on, by a byte at least */
    const smap_bytes_t node = tree + at;
    const uint8_t head = node[0], axis = head & (SMAP_TREE_AXES - 1u);
    const uint16_t place = x[axis];
    const uint32_t above = 0u - (place >> 15u); /* all bits, or none */
    x[axis] = (uint16_t)(place << 1);
    if (head >= 0xF0) { /* two nodes */
      uint32_t skip = node[1];
      at += 2;
      if (SMAP_RARELY(skip == 255)) {
        skip = smap_u16(node + 2);
        at += 2;
      }
      at += skip & above;
    } else {
      const uint8_t lower = head >> 4 & 3u, upper = head >> 6;
      mine = above ? upper : lower;
      at++;
      at += (mine == 3 ? lower + upper == 5 : above && lower == 2) ? leaf : 0u;
    }
  }
  return mine == 2 ? at < bytes && smap_leaf(tree + at, dims, x) : mine == 1;
}

/* The places of u and v on the trees' axes, from those in 1/32768 of the chart's limit. */
SMAP_INLINE void smap_fold_uv(smap_bytes_t fold, int32_t u, int32_t v, uint16_t x[2])
{
  const int32_t rate = (int16_t)smap_u16(fold + (v < 0 ? 4 : 2));
  x[0] = (uint16_t)(32768 + u);
  x[1] = (uint16_t)((uint32_t)smap_u16(fold) + (uint32_t)(v * rate >> 13));
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

/* `place`: of the parameters, 0 to 65534; then u and v from the middle, -32767 to 32767. */
SMAP_INLINE void smap_grid_cell(smap_bytes_t body, smap_bytes_t part, const float *place,
                                uint8_t params, uint8_t face, smap_grid_cell_t *cell)
{
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
    float x = chart ? at + 32767.0f : at; /* of the rim beyond 0 or 65534 by a rounding */
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

/* Read the trees and tables at places of the parameters; `place` has room for u and v. */
SMAP_INLINE int8_t smap_grid_read(const smap_t *map, float *place, const float d[3],
                                  smap_reading_t *out)
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS], channels = SMAP_BLOB(map)[SMAP_AT_CHANNELS];
  const float half = smap_f32(body);
  uint16_t x[SMAP_TREE_AXES] = {0};
  int32_t along[3];
  uint8_t axes[3], face, i;
  for (i = 0; i < 3; i++) { /* bits of floats are in the order of their sizes */
    along[i] = (int32_t)(smap_bits(d[i]) & 0x7FFFFFFFu);
    along[i] = smap_bits(d[i]) >> 31 ? -along[i] : along[i];
  }
  face = smap_face(map, along, axes);
  SMAP_UNROLL
  for (i = 0; i < params; i++) {
    x[i] = (uint16_t)(int32_t)place[i];
  }
  for (i = 0; i < 2; i++) {
    place[params + i] = d[axes[i + 1]] * half; /* at most 32767.05 */
  }
  smap_fold_uv(smap_fold(body, params), (int32_t)place[params], (int32_t)place[params + 1], x + params);
  out->over[0] = out->over[1] = 255;
  out->sdg = out->height = 0.0f;
  out->tip_angle = smap_tree(map, face, x) ? 0.0f : -SMAP_PI;
  if (SMAP_LENGTHS && (channels & (SMAP_SDG | SMAP_HEIGHT))) {
    smap_bytes_t part = smap_part(map, 0);
    smap_grid_cell_t cell;
    if (channels & SMAP_SDG) {
      float ahead, aside;
      smap_grid_cell(body, part, place, params, face, &cell);
      ahead = smap_grid_value(body, part, &cell, 0);
      aside = smap_grid_value(body, part, &cell, 1);
      out->sdg = smap_root(ahead * ahead + aside * aside);
      part += SMAP_PART_BYTES;
    }
    if (channels & SMAP_HEIGHT) {
      smap_grid_cell(body, part, place, params, face, &cell);
      out->height = smap_grid_value(body, part, &cell, 0);
    }
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

