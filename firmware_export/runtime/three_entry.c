/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- entries: robots on three points ---------------------------------------------------------- */

typedef smap_three_pose_t smap_pose_memory_t;
typedef smap_three_pose_i_t smap_pose_memory_i_t;

/* The order of the three points, see smap_three_over: every codec's own part has it in its eighth byte. */
SMAP_INLINE uint8_t smap_three_order(const smap_t *map)
{
  return smap_body(map)[7];
}

#if SMAP_FLOATS
/* Make the posture of checked parameters. */
SMAP_INLINE int8_t smap_three_of(const smap_t *map, const float *params, smap_three_t *out)
{
  float q[SMAP_MAX_PARAMS];
  const int8_t status = smap_range(map, params, q);
  int stands = 0;
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  switch (SMAP_BLOB(map)[SMAP_AT_CODEC]) {
#if SMAP_POINTS
  case SMAP_CODEC_POINTS: {
    const smap_bytes_t body = smap_body(map);
    float p[SMAP_MAX_COORDINATES];
    smap_positions(map, q, p);
    stands = smap_three_make(p, smap_three_order(map) & SMAP_EITHER_WAY, smap_f32(body + SMAP_IN_LOWEST),
                             smap_f32(body + SMAP_IN_STEEPEST), smap_f32(body + SMAP_IN_REST_WIDTH),
                             out);
    break;
  }
#endif
#if SMAP_TABLES
  case SMAP_CODEC_TABLES: {
    float p[9];
    smap_table_points(map, q, p);
    stands = smap_three_make(p, 0, 0.0f, -2.0f, 0.0f, out);
    break;
  }
#endif
  default:
    break;
  }
  return stands ? SMAP_OK : SMAP_TIPS;
}

static int8_t smap_run_read(const smap_t *map, const float *params, const float *gravity,
                            smap_reading_t *out)
{
  smap_three_t three;
  float d[3];
  int8_t status = smap_three_of(map, params, &three);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  status = smap_direction(map, gravity, d);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  return smap_three_read(map, smap_three_order(map), &three, d, out);
}

static int8_t smap_run_at(const void *pose, const float *gravity, smap_reading_t *out)
{
  const smap_three_pose_t *const three = (const smap_three_pose_t *)pose;
  const smap_t *const map = three->head.map;
  float d[3];
  int8_t status = three->head.forms & SMAP_FLOAT ? three->head.status : (int8_t)SMAP_INVALID;
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  status = smap_direction(map, gravity, d);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  return smap_three_read(map, smap_three_order(map), &three->real, d, out);
}
#endif

#if SMAP_INTEGERS
/* The integer form of a pose. */
SMAP_INLINE smap_three_i_t *smap_three_form_i(void *pose, uint8_t forms)
{
  return forms & SMAP_FLOAT ? &((smap_three_pose_t *)pose)->whole : &((smap_three_pose_i_t *)pose)->whole;
}

static int8_t smap_run_at_i(const void *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  const smap_head_t *const head = (const smap_head_t *)pose;
  int32_t g[3];
  uint32_t length;
  int8_t status = head->forms & SMAP_INTEGER ? head->status : (int8_t)SMAP_INVALID;
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny_i(out, status);
  }
  status = smap_direction_i(head->map, gravity, g, &length);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny_i(out, status);
  }
  return smap_three_read_i(head->map, smap_three_order(head->map),
                           head->forms & SMAP_FLOAT ? &((const smap_three_pose_t *)pose)->whole
                                                    : &((const smap_three_pose_i_t *)pose)->whole,
                           g, length, out);
}
#endif

#if SMAP_FLOATS
static int8_t smap_run_pose(const smap_t *map, const float *params, void *pose, uint16_t bytes,
                            uint8_t forms)
{
  smap_head_t *const head = (smap_head_t *)pose;
  smap_three_t alone;
  smap_three_t *real = &alone;
  if (!smap_begin(map, pose, bytes, forms, forms & SMAP_FLOAT ? sizeof(smap_three_pose_t)
                                                            : sizeof(smap_three_pose_i_t))) {
    return SMAP_INVALID;
  }
  if (forms & SMAP_FLOAT) {
    real = &((smap_three_pose_t *)pose)->real;
  }
  head->status = smap_three_of(map, params, real);
#if SMAP_INTEGERS
  if ((forms & SMAP_INTEGER) && head->status == SMAP_OK) {
    smap_three_whole(real, smap_f32(SMAP_BLOB(map) + SMAP_AT_STEP), smap_three_form_i(pose, forms));
  }
#endif
  return head->status;
}
#endif

#if !SMAP_FLOATS
static int8_t smap_run_pose_q(const smap_t *map, const int16_t *params_q, void *pose, uint16_t bytes,
                              uint8_t forms)
{
  smap_three_pose_i_t *const made = (smap_three_pose_i_t *)pose;
  uint16_t place[SMAP_MAX_PARAMS];
  if (!smap_begin(map, pose, bytes, forms, sizeof *made)) {
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
#endif

