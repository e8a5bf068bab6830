/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- control: three contact points: one plane, and a way by its corners ----------------------------- */
typedef struct {
  uint8_t none;
} smap_swept_t;

enum { SMAP_TRIES = 2, SMAP_JUMPS = 0 };

#include "smap_state.h"

/* The upward normal of the plane on which a pose stands; 0 where it stands on none. */
static int smap_upright(const smap_pose_memory_t *pose, const float g[3], float up[3])
{
  const float share = -pose->real.height / pose->real.det;
  uint8_t i;
  (void)g;
  for (i = 0; i < 3; i++) {
    up[i] = pose->real.plane[i] * share;
  }
  return pose->head.status == SMAP_OK;
}

/* The way between two postures, under a slope in the ground's frame: all postures of their box.  Along each
 * joint a sine's angle bends by no more than `bend`, so between the corners it is no more than
 * change^2 x bend / 8 below them, one joint after another.  `now`: the tip angle of the first corner. */
static void smap_pass(const smap_control_t *control, const float *from, const float *to,
                      const float slope[3], float now, smap_way_t *way)
{
  const smap_t *const map = SMAP_CONTROLLED(control);
  const uint8_t count = smap_joints(control);
  float bow = 0.0f;
  uint8_t corner, i;
  way->least = way->end = now;
  for (i = 0; i < count; i++) {
    const float change = to[i] - from[i];
    bow += change * change * smap_joint(control, i, SMAP_JOINT_BEND);
  }
  for (corner = 1; corner < 1u << count && way->least >= -SMAP_PI; corner++) {
    smap_pose_memory_t pose;
    float at[SMAP_MAX_PARAMS], up[3], g[3];
    for (i = 0; i < count; i++) {
      at[i] = corner >> i & 1u ? to[i] : from[i];
    }
    way->end = -SMAP_PI;
    if (smap_run_pose(map, at, &pose.head, sizeof pose, SMAP_FLOAT) == SMAP_OK && smap_upright(&pose, slope, up)) {
      smap_lean(up, slope, -1.0f, g);
      way->end = smap_tip_of(&pose, g);
    }
    way->least = smap_lesser(way->least, way->end);
  }
  way->least -= 0.125f * bow;
}

/* Most joints of a policy on three points: that many corners are looked at. */
enum { SMAP_MOST_JOINTS = 4 };

#include "smap_watch.h"

static uint8_t smap_is_seen(const smap_control_t *control, smap_state_memory_t *state, const float *posture)
{
  (void)control;
  (void)state;
  (void)posture;
  return SMAP_UNSEEN;
}

static uint8_t smap_find_way(const smap_control_t *control, smap_state_memory_t *state, const float *posture,
                             float *to, const float g[3], uint8_t made, smap_way_t *way)
{
  float slope[3];
  (void)made;
  smap_slope_under(&state->here, g, slope);
  smap_pass(control, posture, to, slope, way->least, way);
  return (uint8_t)((1u << smap_joints(control)) - 1u);
}

static int smap_jump(const smap_pose_t *pose, const float f[3], const float to[3], float *sum)
{
  (void)pose;
  (void)f;
  (void)to;
  (void)sum;
  return 0;
}

#include "smap_cycle.h"
