/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- steps: parameters as whole numbers, for maps that compute in floats -------------------------- */
#if SMAP_FLOATS

SMAP_INLINE void smap_from_steps(const smap_t *map, const int16_t *params_q, float *params)
{
  const uint8_t count = SMAP_BLOB(map)[SMAP_AT_PARAMS];
  uint8_t i;
  SMAP_UNROLL
  for (i = 0; i < count; i++) {
    const smap_bytes_t axis = smap_axis(map, i);
    const float low = smap_f32(axis + SMAP_AXIS_MIN), high = smap_f32(axis + SMAP_AXIS_MAX);
    params[i] = params_q[i] == 32767 ? high : low + (high - low) * ((float)params_q[i] * (1.0f / 32767.0f));
  }
}

static int8_t smap_run_pose_q(const smap_t *map, const int16_t *params_q, void *pose, uint16_t bytes,
                              uint8_t forms)
{
  float params[SMAP_MAX_PARAMS];
  smap_from_steps(map, params_q, params);
  return smap_run_pose(map, params, pose, bytes, forms);
}

static int8_t smap_run_read_i(const smap_t *map, const int16_t *params_q, const int16_t *gravity_q,
                              smap_reading_i_t *out)
{
#if SMAP_INTEGERS
  smap_pose_memory_i_t pose;
  const int8_t status = smap_run_pose_q(map, params_q, &pose, sizeof pose, SMAP_INTEGER);
  return status != SMAP_OK ? smap_deny_i(out, status) : smap_run_at_i(&pose, gravity_q, out);
#else
  out->sdg = out->height = 65535;
  out->tip = -32767;
  out->over[0] = out->over[1] = 255;
  (void)map;
  (void)params_q;
  (void)gravity_q;
  return SMAP_INVALID;
#endif
}
#endif

