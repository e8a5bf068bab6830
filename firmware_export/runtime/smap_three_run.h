/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- three contact points, found with floats: the entries --------------------------------------------- */

typedef smap_three_pose_t smap_pose_memory_t;
typedef smap_three_pose_i_t smap_pose_memory_i_t;

/* Make the posture of parameters within their axes; 0 where the robot stands nowhere.  Each family has its own. */
SMAP_INLINE int smap_three_at(const smap_t *map, const float *q, smap_three_t *out);

SMAP_INLINE int8_t smap_three_of(const smap_t *map, const float *params, smap_three_t *out)
{
  float q[SMAP_MAX_PARAMS];
  const int8_t status = smap_range(map, params, q);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  return smap_three_at(map, q, out) ? SMAP_OK : SMAP_TIPS;
}

static int8_t smap_run_read(const smap_t *map, const float *params, const float *gravity,
                            smap_reading_t *out)
{
  smap_three_t three;
  float d[3];
  int8_t status = smap_three_of(map, params, &three);
  if (status == SMAP_OK) {
    status = smap_direction(map, gravity, d);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, status);
  }
  return smap_three_read(map, smap_three_order(map), &three, d, out);
}

static int8_t smap_run_at(const smap_pose_t *pose, const float *gravity, smap_reading_t *out)
{
  const smap_three_pose_t *const three = (const smap_three_pose_t *)pose;
  const smap_t *const map = three->head.map;
  float d[3];
  int8_t status = three->head.forms & SMAP_FLOAT ? three->head.status : (int8_t)SMAP_INVALID;
  if (status == SMAP_OK) {
    status = smap_direction(map, gravity, d);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, status);
  }
  return smap_three_read(map, smap_three_order(map), &three->real, d, out);
}

static int8_t smap_run_at_i(const smap_pose_t *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  const int both = pose->forms & SMAP_FLOAT;
  return smap_three_at_i(pose, both ? &((const smap_three_pose_t *)pose)->whole
                                    : &((const smap_three_pose_i_t *)pose)->whole, gravity, out);
}

static int8_t smap_run_pose(const smap_t *map, const float *params, smap_pose_t *pose, uint16_t bytes,
                            uint8_t forms)
{
  smap_three_t alone;
  smap_three_t *real = &alone;
  smap_three_i_t *whole = &((smap_three_pose_i_t *)pose)->whole;
  const uint16_t needed = forms & SMAP_FLOAT ? sizeof(smap_three_pose_t) : sizeof(smap_three_pose_i_t);
  if (!smap_begin(map, pose, bytes, forms, SMAP_FLOAT | SMAP_INTEGER, needed)) {
    return SMAP_INVALID;
  }
  if (forms & SMAP_FLOAT) {
    real = &((smap_three_pose_t *)pose)->real;
    whole = &((smap_three_pose_t *)pose)->whole;
  }
  pose->status = smap_three_of(map, params, real);
  if ((forms & SMAP_INTEGER) && pose->status == SMAP_OK) {
    smap_three_whole(real, smap_f32(SMAP_BLOB(map) + SMAP_AT_STEP), whole);
  }
  return pose->status;
}

static int8_t smap_run_pose_q(const smap_t *map, const int16_t *params_q, smap_pose_t *pose, uint16_t bytes,
                              uint8_t forms)
{
  float params[SMAP_MAX_PARAMS];
  smap_from_steps(map, params_q, params);
  return smap_run_pose(map, params, pose, bytes, forms);
}

static int8_t smap_run_read_i(const smap_t *map, const int16_t *params_q, const int16_t *gravity_q,
                              smap_reading_i_t *out)
{
  smap_pose_memory_i_t pose;
  const int8_t status = smap_run_pose_q(map, params_q, &pose.head, sizeof pose, SMAP_INTEGER);
  return status != SMAP_OK ? smap_deny_i(out, status) : smap_run_at_i(&pose.head, gravity_q, out);
}
