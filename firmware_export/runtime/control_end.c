/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- control: budgets, checks, and the functions of this export ------------------------------------- */
#define SMAP_MOST_BUDGET 50.0f /* m/s^2: no robot accelerates more */

#if SMAP_MANY
#define SMAP_NEXT_TO 1e-3f /* a sine: a way that passes the end of an arc as near meets it */

/* How much of `to` can be taken off a direction f that stands until it meets the boundary, guard included; both unit. */
static float smap_to_boundary(const smap_many_pose_t *o, const float f[3], const float to[3])
{
  const float beside = o->guard + SMAP_NEXT_TO;
  float least = SMAP_MOST_BUDGET / SMAP_GRAVITY;
  uint8_t k, i;
  for (k = 0; k < o->at.arcs; k++) {
    const float *n = o->wall[o->at.arc[k]];
    const float ahead = smap_dot(n, f), side = ahead < 0.0f ? -1.0f : 1.0f;
    const float above = side * ahead - o->guard, down = side * smap_dot(n, to) + o->guard;
    float at[3], t;
    if (!(down > 1e-6f) || above < 0.0f || above >= least * down) {
      continue;
    }
    t = above / down;
    for (i = 0; i < 3; i++) {
      at[i] = f[i] - t * to[i];
    }
    if (smap_absolute(smap_dot(o->along[k], at)) - smap_dot(o->amid[k], at) <= beside * (1.0f + t)) {
      least = t;
    }
  }
  return least;
}

/* Whether a pose stands when so much of `to` is taken off a direction. */
static int smap_stands_at(const void *pose, const float f[3], const float to[3], float t)
{
  const float at[3] = {f[0] - t * to[0], f[1] - t * to[1], f[2] - t * to[2]};
  smap_reading_t reading;
  const int8_t status = smap_run_at(pose, at, &reading);
  return (status == SMAP_OK || status == SMAP_ROCKS) && reading.tip_angle >= 0.0f;
}
#endif

/* The largest acceleration along a direction.  Gravity and inertia together are turned against it by as much
 * as was read, and read again: the tip angle changes by no more than the angle of turning.  Of many contacts
 * the boundary is gone through for where the way meets it, which counts as a read, and read there; turned by
 * little at a time only where that does not stand. */
static int8_t smap_run_budget(const void *pose, const float *gravity, const float *direction, uint8_t reads,
                              float *acceleration)
{
  float f[3], to[3], sum = 0.0f;
  uint8_t n, i;
  int8_t status = SMAP_INVALID;
  *acceleration = 0.0f;
  memcpy(f, gravity, sizeof f);
  memcpy(to, direction, sizeof to);
  if (!smap_to_unit(f) || !smap_to_unit(to)) {
    return SMAP_INVALID;
  }
  for (n = 0; n < reads && n < 32; n++) {
    const float size = smap_root(smap_dot(f, f)), along = -smap_dot(f, to) / size;
    smap_reading_t reading;
    float t, s, below, across;
    const int8_t now = smap_run_at(pose, f, &reading);
    status = n == 0 ? now : status;
    if ((now != SMAP_OK && now != SMAP_ROCKS) || !(reading.tip_angle > 0.0f)) {
      break;
    }
#if SMAP_MANY
    if (n == 0 && reads > 2) {
      t = 0.9999f * smap_to_boundary(&((const smap_pose_memory_t *)pose)->real, f, to);
      if (smap_stands_at(pose, f, to, t)) {
        sum = t;
        break;
      }
      reads = (uint8_t)(reads - 2);
    }
#endif
    t = smap_lesser(reading.tip_angle, 1.0f) * 0.9999f;
    s = t - t * t * t * (1.0f / 6.0f);
    across = 1.0f - along * along;
    across = across > 0.0f ? smap_root(across) : 0.0f;
    below = across * smap_root(1.0f - s * s) - along * s;
    if (!(below > 0.0f)) { /* it can be turned all the way */
      sum = SMAP_MOST_BUDGET / SMAP_GRAVITY;
      break;
    }
    t = size * s / below;
    sum += t;
    if (!(sum < SMAP_MOST_BUDGET / SMAP_GRAVITY)) {
      sum = SMAP_MOST_BUDGET / SMAP_GRAVITY;
      break;
    }
    for (i = 0; i < 3; i++) {
      f[i] -= t * to[i];
    }
  }
  *acceleration = SMAP_GRAVITY * 0.9999f * sum;
  return status;
}

static float smap_run_turn(float acceleration, float radius)
{
  const float square = acceleration * radius;
  return square > 0.0f && square < 1e30f ? smap_root(square) : 0.0f;
}

static int8_t smap_run_control_check(const smap_control_t *control)
{
  const smap_t *const map = SMAP_CONTROLLED(control);
  const smap_bytes_t policy = SMAP_POLICY(control);
  uint32_t settings, table;
  uint8_t i;
  if (smap_run_check(map) != SMAP_OK || control->size < SMAP_POLICY_JOINTS) {
    return SMAP_CORRUPT;
  }
  settings = SMAP_POLICY_JOINTS + (uint32_t)SMAP_POLICY_JOINT * smap_joints(control);
  table = (uint32_t)policy[SMAP_POLICY_NODES] * policy[SMAP_POLICY_NODES] * smap_joints(control);
  if (policy[SMAP_POLICY_VERSION] != SMAP_CONTROL_VERSION || policy[SMAP_POLICY_NODES] < 2 ||
      policy[SMAP_POLICY_PARAMS] != smap_joints(control) || smap_joints(control) > SMAP_MOST_JOINTS ||
      control->size != settings + table || smap_u32(policy + SMAP_POLICY_MAP) != smap_u32(SMAP_BLOB(map)) ||
      smap_crc(policy + 8, settings - 8u) != smap_u32(policy) ||
      smap_crc(policy + settings, table) != smap_u32(policy + SMAP_POLICY_CRC_TABLE)) {
    return SMAP_CORRUPT;
  }
  for (i = 0; i < SMAP_POLICY_JOINT / 4 * smap_joints(control); i++) {
    if (!smap_is_within(smap_f32(policy + SMAP_POLICY_JOINTS + 4u * i), 1e6f)) {
      return SMAP_CORRUPT;
    }
  }
  for (i = SMAP_POLICY_LIMIT; i < SMAP_POLICY_JOINTS; i = (uint8_t)(i + 4)) {
    if (!smap_is_positive(smap_f32(policy + i))) {
      return SMAP_CORRUPT;
    }
  }
  return SMAP_OK;
}

static int8_t smap_run_start(const smap_control_t *control, void *memory, uint16_t bytes)
{
  smap_state_memory_t *const state = (smap_state_memory_t *)memory;
  int8_t status;
  if (bytes < sizeof *state || (uintptr_t)memory % SMAP_ALIGNMENT != 0) {
    if (bytes >= sizeof control) {
      memset(memory, 0, sizeof control);
    }
    return SMAP_INVALID;
  }
  memset(state, 0, sizeof *state);
  status = smap_run_control_check(control);
  if (status == SMAP_OK) {
    state->control = control;
    state->part = 1.0f;
    state->only = SMAP_ALL;
  }
  return status;
}

static const smap_control_runtime_t smap_control_run = {
    smap_run_start,  smap_run_ground, smap_run_target, smap_run_transit, smap_run_step,
    smap_run_budget, smap_run_turn,   smap_run_alarm,  smap_run_sane,    smap_run_control_check};

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif
