/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- three contact points: one facet, and the standing region is their cone --------------------- */

/* A posture for floats.  Edge i is the cross product of points i and i + 1, `scale` what makes of it the
 * unit normal, inward, of the plane through both and the centre of mass; p . plane = det on the facet. */
typedef struct {
  float edge[9], scale[3], plane[3], det, centroid[3], height;
} smap_three_t;

/* The same for integers: walls and the facet's unit normal in 1/16383, lengths in steps. */
typedef struct {
  int16_t wall[9], normal[3], centroid[3];
  uint16_t height;
} smap_three_i_t;

typedef struct {
  smap_pose_t head;
  smap_three_t real;
  smap_three_i_t whole;
} smap_three_pose_t;

typedef struct {
  smap_pose_t head;
  smap_three_i_t whole;
} smap_three_pose_i_t;

/* The contacts of an edge.  `order`: the recipe's number of each of the three points in two bits, the first
 * in the lowest; 128 where they run either way round. */
#define SMAP_EITHER_WAY 128
SMAP_INLINE void smap_three_over(uint8_t order, uint8_t edge, uint8_t over[2])
{
  over[0] = (uint8_t)(order >> 2 * edge & 3);
  over[1] = (uint8_t)(edge == 2 ? order & 3 : order >> (2 * edge + 2) & 3);
}

/* Tell whether a triangle is at least so wide: it is least wide across its longest side.  `size`: twice
 * its area. */
SMAP_INLINE int smap_is_wide(const float p[9], float size, float width)
{
  float longest = 0.0f;
  uint8_t i;
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    const float *const from = &p[3 * i], *const to = i == 2 ? p : &p[3 * i + 3];
    const float length = smap_apart2(to, from);
    longest = length > longest ? length : longest;
  }
  return size * size >= width * width * longest;
}

/* Make the posture of three points p; 0 where the robot stands nowhere: the centre of mass is too low
 * over them, they are too steep, or too narrow to stand still on.  They run counter-clockwise, seen from
 * below, or, where the map's `order` says so, either way. */
SMAP_INLINE int smap_three_make(const float p[9], int either, float lowest, float steepest,
                                float rest_width, smap_three_t *out)
{
  float size, sign = 1.0f;
  uint8_t i;
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    smap_cross(&p[3 * i], i == 2 ? p : &p[3 * i + 3], &out->edge[3 * i]);
  }
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    out->plane[i] = out->edge[i] + out->edge[i + 3] + out->edge[i + 6];
    out->centroid[i] = (p[i] + p[i + 3] + p[i + 6]) * 0.333333333f;
  }
  out->det = smap_dot(out->edge, &p[6]);
  size = smap_root(smap_dot(out->plane, out->plane));
  if (either && out->det < 0.0f) {
    sign = -1.0f;
  }
  out->height = sign * out->det / size;
  if (SMAP_RARELY(!(out->height > lowest)) ||
      (steepest > -1.0f && SMAP_RARELY(!(-sign * out->plane[2] > steepest * size))) ||
      (rest_width > 0.0f && !smap_is_wide(p, size, rest_width))) {
    return 0;
  }
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    out->scale[i] = sign / smap_root(smap_dot(&out->edge[3 * i], &out->edge[3 * i]));
  }
  return 1;
}

/* Read a posture under a scaled direction. */
SMAP_INLINE int8_t smap_three_read(const smap_t *map, uint8_t order, const smap_three_t *three,
                                   const float d[3], smap_reading_t *out)
{
  float least = smap_dot(three->edge, d) * three->scale[0], reach, away[3];
  uint8_t i;
  smap_three_over(order, 0, out->over);
  SMAP_UNROLL
  for (i = 1; i < 3; i++) {
    const float along = smap_dot(&three->edge[3 * i], d) * three->scale[i];
    if (along < least) {
      least = along;
      smap_three_over(order, i, out->over);
    }
  }
  out->tip_angle = smap_asin(least / smap_root(smap_dot(d, d))) -
                   smap_f32(SMAP_BLOB(map) + SMAP_AT_GUARD);
  out->height = three->height;
  reach = three->det / smap_dot(three->plane, d);
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    away[i] = three->centroid[i] - reach * d[i];
  }
  out->sdg = smap_root(smap_dot(away, away));
  return smap_judge(map, out, SMAP_OK);
}

/* Make the integer form out of the other. */
SMAP_INLINE void smap_three_whole(const smap_three_t *real, float step, smap_three_i_t *out)
{
  int16_t high;
  uint8_t i;
  for (i = 0; i < 9; i++) {
    out->wall[i] = smap_to_whole(real->edge[i] * real->scale[i / 3] * 16383.0f, 16384.0f);
  }
  for (i = 0; i < 3; i++) {
    out->normal[i] = smap_to_whole(real->plane[i] * (real->height / real->det) * 16383.0f, 16384.0f);
    out->centroid[i] = smap_to_whole(real->centroid[i] / step, 32767.0f);
  }
  high = smap_to_whole(real->height / step, 32767.0f);
  out->height = (uint16_t)(high > 0 ? high : 0);
}

/* Read the integer form under a scaled direction and its length, rounded up. */
SMAP_INLINE int8_t smap_three_read_i(const smap_t *map, uint8_t order, const smap_three_i_t *three,
                                     const int32_t g[3], uint32_t length, smap_reading_i_t *out)
{
  const int32_t guard = smap_u16(SMAP_BLOB(map) + SMAP_AT_GUARD_I);
  const uint8_t channels = SMAP_BLOB(map)[SMAP_AT_CHANNELS];
  int32_t least = 0, tip, deep;
  uint8_t i;
  SMAP_UNROLL
  for (i = 0; i < 3; i++) {
    const int16_t *const wall = &three->wall[3 * i];
    const int32_t along = wall[0] * g[0] + wall[1] * g[1] + wall[2] * g[2];
    if (i == 0 || along < least) {
      least = along;
      smap_three_over(order, i, out->over);
    }
  }
  out->sdg = out->height = 65535;
  /*@ admit -1073741824 <= least <= 1073741823; */
  tip = 2 * least / (int32_t)length - guard; /* a wall is at most 16384 long, and the length rounded up */
  if (least < 0 || tip < 0) {
    out->tip = (int16_t)(tip < -32767 ? -32767 : tip < 0 ? tip : -1);
    return SMAP_TIPS;
  }
  out->tip = (int16_t)tip;
  if (channels & SMAP_HEIGHT) {
    out->height = three->height;
  }
  deep = (three->normal[0] * g[0] + three->normal[1] * g[1] + three->normal[2] * g[2]) >> 14;
  if ((channels & SMAP_SDG) && deep > 0) {
    uint32_t sum = 0;
    SMAP_UNROLL
    for (i = 0; i < 3; i++) {
      int32_t away = g[i] * (int32_t)three->height / deep - three->centroid[i];
      away = away > 32767 ? 32767 : away < -32767 ? -32767 : away;
      sum += (uint32_t)(away * away);
    }
    sum = smap_whole_root(sum);
    out->sdg = (uint16_t)(sum < 65535u ? sum : 65535u);
  }
  return SMAP_OK;
}

/* The order of the three points, see smap_three_over: every codec's own part has it in its eighth byte. */
SMAP_INLINE uint8_t smap_three_order(const smap_t *map)
{
  return smap_body(map)[7];
}

/* Read the integer form of a pose. */
SMAP_INLINE int8_t smap_three_at_i(const smap_pose_t *pose, const smap_three_i_t *whole,
                                   const int16_t *gravity, smap_reading_i_t *out)
{
  int32_t g[3];
  uint32_t length;
  int8_t status = pose->forms & SMAP_INTEGER ? pose->status : (int8_t)SMAP_INVALID;
  if (status == SMAP_OK) {
    status = smap_direction_i(pose->map, gravity, g, &length);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny_i(out, status);
  }
  return smap_three_read_i(pose->map, smap_three_order(pose->map), whole, g, length, out);
}
