/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- control: grids: no plane is known, and a way by what its joints alter at most ------------------ */

/* A grid holds no plane: the ground is taken to be the body's own. */
static int smap_upright(const smap_pose_memory_t *pose, const float g[3], float up[3])
{
  (void)g;
  up[0] = up[1] = 0.0f;
  up[2] = 1.0f;
  return pose->head.status == SMAP_OK;
}

/* The way between two postures under a direction: half way less what each joint alters at most, and how far
 * it turns the body. */
static void smap_pass(const smap_control_t *control, const float *from, const float *to,
                      const float slope[3], float now, smap_way_t *way)
{
  const uint8_t count = smap_joints(control);
  smap_pose_memory_t pose;
  float at[SMAP_MAX_PARAMS], less = 0.0f;
  uint8_t i;
  for (i = 0; i < count; i++) {
    const float half = 0.5f * smap_absolute(to[i] - from[i]);
    at[i] = from[i] + 0.5f * (to[i] - from[i]);
    less += half * (smap_joint(control, i, SMAP_JOINT_REACH) + 2.0f * smap_joint(control, i, SMAP_JOINT_LEAN));
  }
  way->end = now;
  way->least = -SMAP_PI;
  if (smap_pose_of(SMAP_CONTROLLED(control), at, &pose) == SMAP_OK) {
    way->end = smap_tip_of(&pose, slope);
    way->least = way->end - less;
  }
}

enum { SMAP_MOST_JOINTS = SMAP_MAX_PARAMS };

