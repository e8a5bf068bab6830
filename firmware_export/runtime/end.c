/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- end: the functions of this export --------------------------------------------------------------- */

#if !SMAP_FLOATS
/* Without floats only the entries with whole numbers are there. */
static int8_t smap_run_pose(const smap_t *map, const float *params, void *pose, uint16_t bytes,
                            uint8_t forms)
{
  (void)params;
  (void)forms;
  if (bytes >= sizeof map) {
    memset(pose, 0, sizeof map);
  }
  return SMAP_INVALID;
}

static int8_t smap_run_at(const void *pose, const float *gravity, smap_reading_t *out)
{
  const uint32_t nan_bits = 0x7FC00000u, minus_pi_bits = 0xC0490FDBu;
  (void)pose;
  (void)gravity;
  memcpy(&out->sdg, &nan_bits, sizeof nan_bits);
  memcpy(&out->height, &nan_bits, sizeof nan_bits);
  memcpy(&out->tip_angle, &minus_pi_bits, sizeof minus_pi_bits);
  out->over[0] = out->over[1] = 255;
  return SMAP_INVALID;
}

static int8_t smap_run_read(const smap_t *map, const float *params, const float *gravity,
                            smap_reading_t *out)
{
  (void)params;
  return smap_run_at(map, gravity, out);
}
#endif

#if !SMAP_INTEGERS
static int8_t smap_run_at_i(const void *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  (void)pose;
  (void)gravity;
  out->sdg = out->height = 65535;
  out->tip = -32767;
  out->over[0] = out->over[1] = 255;
  return SMAP_INVALID;
}
#endif

static const smap_runtime_t smap_run = {smap_run_pose, smap_run_pose_q, smap_run_at,   smap_run_at_i,
                                        smap_run_read, smap_run_read_i, smap_run_check};

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif
