/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- control: the way to a command ---------------------------------------------------------------------- */

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

#if SMAP_MANY
/* Whether the pose that is there will do: a posture that is near needs none (SMAP_STAYS), nor one that is to wait
 * for its turn, since a cycle makes one pose.  One that is near does not turn the body either. */
static uint8_t smap_is_seen(const smap_control_t *control, smap_state_memory_t *state, const float *posture)
{
  uint8_t i, near = (state->has & SMAP_HAS_HERE) != 0;
  for (i = 0; i < smap_joints(control); i++) {
    near = near && smap_absolute(posture[i] - state->at[i]) <= smap_joint(control, i, SMAP_JOINT_NEAR);
  }
  if (near) {
    state->lean[0] = state->lean[1] = state->lean[2] = 0.0f;
    state->since = 0;
    return SMAP_STAYS;
  }
  return (state->has & SMAP_HAS_HERE) && state->later && SMAP_POLICY(control)[SMAP_POLICY_POSES] < 2 ? SMAP_WAITS
                                                                                                     : SMAP_UNSEEN;
}

/* Whether two postures are in the box whose pose is there. */
static int smap_is_swept(const smap_control_t *control, const smap_state_memory_t *state, const float *posture,
                         const float *to)
{
  uint8_t i, within = (state->has & SMAP_HAS_SWEPT) != 0;
  for (i = 0; i < smap_joints(control); i++) {
    within = within && smap_absolute(posture[i] - state->mid[i]) <= state->half[i] &&
             smap_absolute(to[i] - state->mid[i]) <= state->half[i];
  }
  return within;
}

/* The way to a command.  Where this cycle has made its pose and the box of the last one will not do, the last
 * command stands as long as its box holds it, and else the posture: `to` is then that.  Returns the
 * poses that were made. */
static uint8_t smap_find_way(const smap_control_t *control, smap_state_memory_t *state, const float *posture,
                             float *to, const float g[3], uint8_t made, smap_way_t *way)
{
  uint8_t more = 0, i;
  if (!smap_is_swept(control, state, posture, to)) {
    if (made && SMAP_POLICY(control)[SMAP_POLICY_POSES] < 2) {
      const int same = (state->has & SMAP_HAS_COMMAND) != 0 && smap_is_swept(control, state, posture, state->command);
      state->later = 1;
      if (same) { /* as near as a step is */
        (void)smap_toward(control, posture, state->command, 1.0f, SMAP_ALL, to);
      } else {
        for (i = 0; i < smap_joints(control); i++) { /* it may be off its axis by the slack of a sensor */
          to[i] = smap_on_axis(control, i, posture[i]);
        }
      }
      if (!same) {
        return 0;
      }
    } else {
      smap_sweep(control, state, posture, to, smap_lowest(&state->here, g));
      state->has |= SMAP_HAS_SWEPT;
      state->later = 0;
      more = 1;
    }
  }
  smap_swept_at(control, &state->swept, g, way);
  return more;
}
#else
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
#endif

/* The way between any two postures. */
static int8_t smap_run_transit(const smap_control_t *control, void *memory, const float *from, const float *to,
                               const float *gravity, float *least)
{
  smap_state_memory_t *const state = (smap_state_memory_t *)memory;
  float end[SMAP_MAX_PARAMS], g[3] = {gravity[0], gravity[1], gravity[2]};
  smap_way_t way;
  *least = -SMAP_PI;
  if (state->control != control || !smap_to_unit(g) || !smap_are_finite(from, smap_joints(control)) ||
      !smap_are_finite(to, smap_joints(control))) {
    return SMAP_INVALID;
  }
  (void)smap_look(control, state, from);
  if (!(state->has & SMAP_HAS_HERE)) {
    return SMAP_OFF_RANGE;
  }
  state->has &= (uint8_t)~SMAP_HAS_SWEPT;
  memcpy(end, to, sizeof(float) * smap_joints(control));
  way.least = way.end = smap_tip_of(&state->here, g);
  (void)smap_find_way(control, state, from, end, g, 0, &way);
  state->has &= (uint8_t)~SMAP_HAS_SWEPT;
  if (way.least > -SMAP_PI) {
    *least = way.least;
  }
  return *least >= 0.0f ? (int8_t)SMAP_OK : (int8_t)SMAP_TIPS;
}

