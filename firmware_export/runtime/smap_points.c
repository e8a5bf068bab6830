/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- points: robots on three contact points, which follow from the joints ----------------------------- */
#define SMAP_CODEC SMAP_CODEC_POINTS
#define SMAP_INLINE SMAP_FOLDED
#define SMAP_UNROLL SMAP_SOME
#define SMAP_STEERED_BY "smap_control_three.c"
#include "smap_joints.h"
#include "smap_three.h"
#include "smap_three_run.h"

SMAP_INLINE int smap_three_at(const smap_t *map, const float *q, smap_three_t *out)
{
  const smap_bytes_t body = smap_body(map);
  float p[SMAP_MAX_COORDINATES];
  smap_positions(map, q, p);
  return smap_three_make(p, smap_three_order(map) & SMAP_EITHER_WAY, smap_f32(body + SMAP_IN_LOWEST),
                         smap_f32(body + SMAP_IN_STEEPEST), smap_f32(body + SMAP_IN_REST_WIDTH), out);
}

static int smap_check_own(const smap_t *map, smap_bytes_t limit)
{
  return smap_check_axes(map) && SMAP_BLOB(map)[SMAP_AT_CONTACTS] == 3 && smap_check_positions(map, limit);
}

static const smap_runtime_t smap_run = {smap_run_pose, smap_run_pose_q, smap_run_at,   smap_run_at_i,
                                        smap_run_read, smap_run_read_i, smap_run_check};
