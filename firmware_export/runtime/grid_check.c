/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- grid_check: do its offsets and sizes stay in the blob? ---------------------------------------------- */

/* The axes of one table: knots that exist and ascend over the whole axis.  Returns the codes of a face, 0
 * where something is wrong. */
static uint32_t smap_check_axes_of(const smap_t *map, smap_bytes_t part, smap_bytes_t limit)
{
  const smap_bytes_t body = smap_body(map), knots = body + smap_u32(body + 8);
  const uint32_t room = (uint32_t)(limit - body);
  const uint32_t first = smap_u32(part + SMAP_PART_AXES);
  const uint8_t params = SMAP_BLOB(map)[SMAP_AT_PARAMS], dims = part[SMAP_PART_DIMS];
  uint32_t codes = part[SMAP_PART_WIDTH];
  uint8_t i;
  if (dims > params + 2 || dims > 15 || codes - 1u > 1u || first > room || room - first < 6u * dims) {
    return 0;
  }
  for (i = 0; i < dims; i++) {
    const smap_bytes_t axis = body + first + 6u * i;
    const uint16_t coordinate = smap_u16(axis), nodes = smap_u16(axis + 2), knot = smap_u16(axis + 4);
    const uint32_t from = smap_u32(body + 8) + 2u * knot;
    uint32_t k;
    if ((coordinate >= params && coordinate != SMAP_GRID_U && coordinate != SMAP_GRID_U + 1) ||
        nodes < 2 || nodes > 4096 || codes > room / nodes) {
      return 0;
    }
    if (knot != SMAP_EVEN &&
        (from > room || (room - from) / 2u < nodes || smap_u16(knots + 2 * knot) != 0 ||
         smap_u16(body + from + 2u * (nodes - 1u)) < 65534u)) {
      return 0;
    }
    for (k = 1; knot != SMAP_EVEN && k < nodes; k++) {
      if (smap_u16(body + from + 2u * k) <= smap_u16(body + from + 2u * k - 2u)) {
        return 0;
      }
    }
    codes *= nodes;
  }
  return codes;
}

static int smap_check_grid(const smap_t *map, smap_bytes_t limit)
{
  const smap_bytes_t blob = SMAP_BLOB(map), body = smap_body(map);
  const uint8_t params = blob[SMAP_AT_PARAMS], channels = blob[SMAP_AT_CHANNELS], faces = blob[SMAP_AT_FACES];
  const uint8_t lengths = (uint8_t)((channels & SMAP_SDG ? 1u : 0u) + (channels & SMAP_HEIGHT ? 1u : 0u));
  const uint8_t parts = SMAP_LENGTHS ? lengths : 0;
  const uint32_t room = (uint32_t)(limit - body);
  const uint32_t fixed = 24u + 12u * params + 6u * faces + SMAP_PART_BYTES * parts;
  uint8_t i, bits;
  if (faces - 1u > 5u || room < fixed || body[12] != lengths || lengths != parts ||
      smap_u32(body + 8) < fixed || smap_u32(body + 8) > room || smap_u32(body + 4) >= 1u << 17) {
    return 0;
  }
  bits = smap_fold(body, params)[6];
  if (bits > 6) {
    return 0;
  }
  for (i = 0; i < faces; i++) {
    const smap_bytes_t own = smap_fold(body, params) + 8 + 6 * i;
    const uint32_t at = smap_u32(own), bytes = smap_u16(own + 4);
    if (at > room || room - at < SMAP_TREE_BEHIND + bytes || bytes >> 1 >> bits >> bits == 0) {
      return 0;
    }
  }
#if SMAP_FLOATS
  /* Places of parameters and on the chart are numbers: finite less finite, times finite. */
  if (!smap_is_within(smap_f32(body), 32767.05f) ||
      !smap_is_within(smap_f32(body) * smap_f32(blob + SMAP_AT_LIMIT), 32767.05f)) {
    return 0;
  }
  for (i = 0; i < params; i++) {
    const smap_bytes_t place = body + 16 + 12 * i;
    if (!smap_is_within(smap_f32(place), 1e30f) || !smap_is_within(smap_f32(place + 4), 1e30f)) {
      return 0;
    }
  }
#endif
  for (i = 0; i < parts; i++) {
    const smap_bytes_t part = smap_part(map, i);
    const uint32_t codes = smap_check_axes_of(map, part, limit), stride = smap_u32(part + SMAP_PART_STRIDE);
    const uint32_t at = smap_u32(part + SMAP_PART_CODES), bytes = part[SMAP_PART_WIDE] ? 2u : 1u;
    const uint32_t held = stride != 0 ? faces : 1u;
    const int paired = i == 0 && (channels & SMAP_SDG);
    if (codes == 0 || (stride != 0 && stride != codes) || part[SMAP_PART_WIDE] > 1 || at > room ||
        part[SMAP_PART_SHIFT] > 31 || part[SMAP_PART_WIDTH] != (paired ? 2 : 1) ||
        codes > (room - at) / (bytes * held)) {
      return 0;
    }
  }
  return 1;
}

