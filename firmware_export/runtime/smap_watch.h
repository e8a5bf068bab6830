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
  const int8_t status =
      smap_run_pose(SMAP_CONTROLLED(control), posture, &state->here.head, sizeof state->here, SMAP_FLOAT);
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

/* ---- control: is the sample plausible, and how near is tipping over? ----------------------------------- */
#define SMAP_FAR_TURN 0.7f  /* rad: gravity is turned ahead by no more */
#define SMAP_FASTEST 35.0f  /* rad/s: no gyroscope shows more */
#define SMAP_STUCK_TURN 0.1f /* rad: a robot that has turned so far reads another `up` */
enum { SMAP_CALM = 10, SMAP_STUCK = 10 }; /* cycles */

static float smap_rate_of(const float rate[3])
{
  return smap_root(smap_dot(rate, rate));
}

/* Judges a sample against the one before it; remembers it. */
static int8_t smap_run_sane(const smap_control_t *control, void *memory, const smap_sample_t *sample)
{
  smap_state_memory_t *const state = (smap_state_memory_t *)memory;
  const float cycle = smap_setting(control, SMAP_POLICY_CYCLE);
  const uint8_t had = state->has & SMAP_HAS_SAMPLE;
  float up[3] = {sample->up[0], sample->up[1], sample->up[2]}, size, turn, rate;
  int8_t status = SMAP_OK;
  state->has &= (uint8_t)~SMAP_HAS_SAMPLE;
  if (state->control != control || !smap_are_finite(up, 3) || !smap_are_finite(sample->rate, 3) ||
      !smap_are_finite(sample->own, 3) || !smap_are_finite(sample->posture, smap_joints(control)) ||
      !(smap_absolute(up[0]) < 100.0f && smap_absolute(up[1]) < 100.0f && smap_absolute(up[2]) < 100.0f)) {
    return SMAP_INVALID;
  }
  size = smap_root(smap_dot(up, up));
  rate = smap_absolute(sample->rate[0]) + smap_absolute(sample->rate[1]) + smap_absolute(sample->rate[2]);
  if (!(size > 0.3f * SMAP_GRAVITY && size < 3.0f * SMAP_GRAVITY) || !(rate < SMAP_FASTEST) ||
      !smap_to_unit(up)) {
    return SMAP_INVALID;
  }
  turn = cycle * rate;
  if (had) {
    const float swerve = smap_setting(control, SMAP_POLICY_SWERVE) + turn;
    size = smap_apart2(up, state->up);
    if (size > swerve * swerve) {
      status = SMAP_INVALID;
    }
    state->stuck = (uint8_t)(size > 0.0f ? 0 : state->stuck < 255 ? state->stuck + 1 : 255);
    state->turned = size > 0.0f ? 0.0f : smap_lesser(state->turned + turn, SMAP_LONG);
    if (state->stuck >= SMAP_STUCK && state->turned > SMAP_STUCK_TURN) {
      status = SMAP_INVALID;
    }
  }
  memcpy(state->up, up, sizeof up);
  state->has |= SMAP_HAS_SAMPLE;
  return status;
}

/* Gravity as it will be after the policy's latency, by the gyroscope: unit in, unit out. */
static void smap_ahead(const smap_control_t *control, const float g[3], const float rate[3], float ahead[3])
{
  const float size = smap_rate_of(rate);
  float time = smap_setting(control, SMAP_POLICY_LATENCY);
  if (time * size > SMAP_FAR_TURN) {
    time = SMAP_FAR_TURN / size;
  }
  smap_cross(g, rate, ahead); /* the body turns, and gravity against it */
  smap_plus(g, time, ahead, ahead);
  (void)smap_to_unit(ahead);
}

/* Turn the slope under gravity g ahead by the policy's latency, by what the gyroscope feels beside the robot's own
 * lean: where the ground has not turned, the slope stays however the joints move the body.  `made`: whether the pose
 * is of this cycle.  No rate is no gyroscope, and on no plane nothing is known of lean: there it stays that of now. */
static void smap_slope_ahead(const smap_control_t *control, smap_state_memory_t *state, const float g[3],
                             const float rate[3], int made, float slope[3])
{
  const uint8_t had = state->has & SMAP_HAS_NORMAL;
  float up[3], before[3], ground[3], ahead[3];
  uint8_t i;
  if (made) {
    state->has &= (uint8_t)~SMAP_HAS_NORMAL;
    if (!smap_upright(&state->here, g, up) || !smap_are_finite(up, 3)) {
      return;
    }
    if (had) { /* gravity as the body would have felt it then, on this ground */
      const float per = 1.0f / ((float)state->since * smap_setting(control, SMAP_POLICY_CYCLE));
      smap_lean(state->normal, slope, -1.0f, before);
      smap_cross(g, before, state->lean);
      for (i = 0; i < 3; i++) {
        state->lean[i] *= per;
      }
    }
    memcpy(state->normal, up, sizeof up);
    state->since = 0;
    state->has |= SMAP_HAS_NORMAL;
  }
  if (!had || !(smap_rate_of(rate) > 0.0f) || !smap_are_finite(state->lean, 3)) {
    return;
  }
  smap_minus(rate, state->lean, ground);
  smap_ahead(control, g, ground, ahead);
  smap_slope_under(&state->here, ahead, slope);
}

/* The level: of the policy's three thresholds, how many the tip angle that is left after the latency is below. */
static uint8_t smap_run_alarm(const smap_control_t *control, void *memory, float tip, float rate)
{
  smap_state_memory_t *const state = (smap_state_memory_t *)memory;
  const float left = tip - smap_absolute(rate) * smap_setting(control, SMAP_POLICY_LATENCY);
  uint8_t level = 0, i;
  for (i = 0; i < 3; i++) {
    level = (uint8_t)(level + !(left > smap_setting(control, (uint8_t)(SMAP_POLICY_LEVELS + 4 * i))));
  }
  if (level >= state->level) {
    state->level = level;
    state->calm = 0;
  } else if (left > 1.2f * smap_setting(control, (uint8_t)(SMAP_POLICY_LEVELS + 4 * (state->level - 1)))) {
    state->calm++;
    if (state->calm >= SMAP_CALM) {
      state->level--;
      state->calm = 0;
    }
  } else {
    state->calm = 0;
  }
  return state->level;
}

/* A step of all joints or of one towards a target: none further than it goes in a cycle, nor off its axis.
 * 1 where all are there. */
static int smap_toward(const smap_control_t *control, const float *posture, const float *target, float part,
                       uint8_t only, float *to)
{
  uint8_t i;
  int there = 1;
  for (i = 0; i < smap_joints(control); i++) {
    const float rate = only == SMAP_ALL || only == i ? part * smap_joint(control, i, SMAP_JOINT_RATE) : 0.0f;
    to[i] = smap_on_axis(control, i, smap_between(target[i], posture[i] - rate, posture[i] + rate));
    there = there && smap_absolute(target[i] - posture[i]) <= smap_joint(control, i, SMAP_JOINT_NEAR);
  }
  return there;
}

enum { SMAP_UNSEEN, SMAP_WAITS, SMAP_STAYS };
