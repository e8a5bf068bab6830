/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- control: the pose of the posture, the slope of the ground, and the posture for it ----------------- */

/* Gravity in the frame of the plane on which a pose stands.  Where it stands on none, that of the body. */
static void smap_slope_under(const smap_pose_memory_t *pose, const float g[3], float slope[3])
{
  float up[3];
  if (smap_upright(pose, g, up)) {
    smap_lean(up, g, 1.0f, slope);
  } else {
    memcpy(slope, g, sizeof(float) * 3);
  }
}

/* Where a slope is on one of the table's two axes: the node before it, and how far it is beyond that. */
static uint8_t smap_node(const smap_control_t *control, float along, float down, float *beyond)
{
  const uint8_t nodes = SMAP_POLICY(control)[SMAP_POLICY_NODES];
  const float limit = smap_setting(control, SMAP_POLICY_LIMIT), most = (float)(nodes - 1);
  const float reach = smap_between(along, -limit * down, limit * down);
  const float at = smap_between((reach / down + limit) * most / (2.0f * limit), 0.0f, most);
  uint8_t node = 0;
  while (node + 2 < nodes && at >= (float)(node + 1)) {
    node++;
  }
  *beyond = at - (float)node;
  return node;
}

/* The table between its nodes, within the range around what is desired, and on the axes. */
static int8_t smap_run_target(const smap_control_t *control, const float slope[3], const float *desired,
                              float *target)
{
  const uint8_t count = smap_joints(control), nodes = SMAP_POLICY(control)[SMAP_POLICY_NODES];
  const smap_bytes_t table =
      SMAP_POLICY(control) + SMAP_POLICY_JOINTS + (uint16_t)(SMAP_POLICY_JOINT * count);
  const float down = slope[2] < -1e-3f ? -slope[2] : 1e-3f;
  float u, v;
  const uint8_t row = smap_node(control, slope[0], down, &u);
  const uint8_t column = smap_node(control, slope[1], down, &v);
  const uint32_t next = (uint32_t)nodes * count, first = row * next + (uint32_t)column * count;
  uint8_t i;
  for (i = 0; i < count; i++) {
    const float a = table[first + i], b = table[first + count + i];
    const float c = table[first + next + i], d = table[first + next + count + i];
    const float low = a + (b - a) * v, high = c + (d - c) * v;
    const float code = low + (high - low) * u;
    float x = smap_joint(control, i, SMAP_JOINT_LOW) + code * smap_joint(control, i, SMAP_JOINT_CODE);
    if (desired != 0) {
      const float delta = smap_joint(control, i, SMAP_JOINT_DELTA);
      if (!smap_is_finite(desired[i])) {
        return SMAP_INVALID;
      }
      x = smap_between(x, desired[i] - delta, desired[i] + delta);
    }
    target[i] = smap_on_axis(control, i, x);
  }
  return SMAP_OK;
}

/* Make the state's pose of a posture, and return its status; the state tells whether it is one. */
static int8_t smap_look(const smap_control_t *control, smap_state_memory_t *state, const float *posture)
{
  const int8_t status = smap_pose_of(SMAP_CONTROLLED(control), posture, &state->here);
  memcpy(state->at, posture, sizeof(float) * smap_joints(control));
  state->has &= (uint8_t)~SMAP_HAS_HERE;
  if (status == SMAP_OK || status == SMAP_TIPS) {
    state->has |= SMAP_HAS_HERE;
  }
  return status;
}

/* The slope under a posture and an accelerometer; makes the state's pose of the posture. */
static int8_t smap_run_ground(const smap_control_t *control, void *memory, const float *posture,
                              const float *up, float *slope)
{
  smap_state_memory_t *const state = (smap_state_memory_t *)memory;
  float g[3] = {-up[0], -up[1], -up[2]};
  int8_t status;
  slope[0] = slope[1] = slope[2] = 0.0f;
  state->has &= (uint8_t)~SMAP_HAS_HERE;
  if (state->control != control || !smap_to_unit(g)) {
    return SMAP_INVALID;
  }
  status = smap_look(control, state, posture);
  if (state->has & SMAP_HAS_HERE) {
    smap_slope_under(&state->here, g, slope);
  }
  return status;
}

