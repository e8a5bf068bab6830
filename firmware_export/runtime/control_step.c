/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- control: a cycle -------------------------------------------------------------------------------------- */
#define SMAP_SHORTEST 0.0625f /* of a step: no shorter one is tried */
/* What a step becomes after one that was held, and after one that was gone: a box that is little larger than
 * what was certified is most often certified too, one that is twice as large is not. */
#define SMAP_SHORTER 0.6f
#define SMAP_LONGER 1.15f

/* The last command, or the posture where there was none: always on the axes. */
static void smap_keep_command(const smap_control_t *control, const smap_state_memory_t *state, const float *posture,
                      float *command)
{
  const int had = state->control == control && (state->has & SMAP_HAS_COMMAND);
  uint8_t i;
  for (i = 0; i < smap_joints(control); i++) {
    command[i] = smap_on_axis(control, i, had ? state->command[i] : posture[i]);
  }
}

/* What is said where nothing is known. */
static int8_t smap_blind(smap_state_memory_t *state, int8_t status, smap_cycle_t *cycle)
{
  cycle->slope[0] = cycle->slope[1] = cycle->slope[2] = 0.0f;
  cycle->tip = cycle->least = -SMAP_PI;
  cycle->left = 0.0f;
  cycle->move = SMAP_BLIND;
  cycle->alarm = state->level = 3;
  state->calm = 0;
  state->has &= (uint8_t)~(SMAP_HAS_HERE | SMAP_HAS_SWEPT);
  return status;
}

/* Whether a way may be gone: it keeps the margin, or is no worse than staying, or stands all along and ends no
 * nearer to tipping than it began; where staying tips, also one that ends further from it. */
static uint8_t smap_judge_way(const smap_control_t *control, const smap_way_t *way, float stay)
{
  if (way->least > -SMAP_PI &&
      (way->least >= smap_setting(control, SMAP_POLICY_MARGIN) || way->least >= stay ||
       (way->least >= 0.0f && way->end >= stay))) {
    return way->least >= 0.0f ? SMAP_MOVES : SMAP_ESCAPES;
  }
  return !(stay >= 0.0f) && way->end > stay ? SMAP_ESCAPES : SMAP_HELD;
}

/* Which joints move next: after a step that was held one that is not where it should be, all of them after the
 * last; none alone that has arrived.  1 where all have had their turn. */
static int smap_take_turns(const smap_control_t *control, smap_state_memory_t *state, const float *posture,
                           const float *target, int held)
{
  uint8_t i = state->only;
  if (!held && (i == SMAP_ALL || smap_absolute(target[i] - posture[i]) > smap_joint(control, i, SMAP_JOINT_NEAR))) {
    return 0;
  }
  for (i = held ? (uint8_t)(i + 1u) : 0; held && i < smap_joints(control); i++) {
    if (smap_absolute(target[i] - posture[i]) > smap_joint(control, i, SMAP_JOINT_NEAR)) {
      state->only = i;
      return 0;
    }
  }
  state->only = SMAP_ALL;
  return 1;
}

/* From a posture that is seen to a command: what is wanted, the way there, the verdict.  `cycle->least` is the
 * tip angle of staying. */
static void smap_decide(const smap_control_t *control, smap_state_memory_t *state, const smap_sample_t *sample,
                        const float *target, const float ahead[3], float *command, smap_cycle_t *cycle)
{
  const float stay = cycle->least;
  const uint8_t made = cycle->poses;
  smap_way_t way;
  uint8_t tries, i;
  int there = 0;
  cycle->move = SMAP_HELD;
  for (tries = 0; tries < (SMAP_MANY ? 1 : 2) && cycle->move == SMAP_HELD; tries++) {
    there = smap_toward(control, sample->posture, target, state->part, state->only, command);
    way.least = way.end = stay;
    cycle->poses = (uint8_t)(cycle->poses +
                             smap_find_way(control, state, sample->posture, command, ahead, made, &way));
    cycle->move = smap_judge_way(control, &way, stay);
    if (cycle->move != SMAP_HELD) {
      state->part *= SMAP_LONGER;
      (void)smap_take_turns(control, state, command, target, 0);
    } else if (smap_take_turns(control, state, sample->posture, target, 1)) {
      state->part *= SMAP_SHORTER;
    }
    state->part = smap_between(state->part, SMAP_SHORTEST, 1.0f);
  }
  cycle->least = way.least;
  if (cycle->move == SMAP_HELD) {
    cycle->least = cycle->tip;
    state->has &= (uint8_t)~SMAP_HAS_SWEPT; /* a smaller box may do */
  } else if (there && cycle->move == SMAP_MOVES) {
    cycle->move = SMAP_RESTS; /* near enough: a smaller step would be felt by the gyroscope, and answered */
  }
  for (i = 0; i < smap_joints(control) && (cycle->move == SMAP_HELD || cycle->move == SMAP_RESTS); i++) {
    command[i] = smap_on_axis(control, i, sample->posture[i]);
  }
}

static int8_t smap_run_step(const smap_control_t *control, void *memory, const smap_sample_t *sample,
                            float *command, smap_cycle_t *cycle)
{
  smap_state_memory_t *const state = (smap_state_memory_t *)memory;
  float g[3], ahead[3], still[3], target[SMAP_MAX_PARAMS], rate, now;
  uint8_t i, seen;
  cycle->poses = cycle->spare = 0;
  state->since = (uint8_t)(state->since < 255 ? state->since + 1 : 255);
  smap_keep_command(control, state, sample->posture, command);
  if (smap_run_sane(control, memory, sample) != SMAP_OK) {
    return smap_blind(state, SMAP_INVALID, cycle);
  }
  for (i = 0; i < 3; i++) {
    g[i] = -state->up[i];
    still[i] = sample->own[i] - sample->up[i];
  }
  if ((sample->own[0] == 0.0f && sample->own[1] == 0.0f && sample->own[2] == 0.0f) || !smap_to_unit(still)) {
    memcpy(still, g, sizeof g);
  }
  smap_ahead(control, g, sample->rate, ahead);
  seen = smap_is_seen(control, state, sample->posture);
  if (seen == SMAP_UNSEEN) {
    cycle->poses = 1;
    (void)smap_look(control, state, sample->posture);
    if (!(state->has & SMAP_HAS_HERE)) {
      return smap_blind(state, state->here.head.status, cycle);
    }
  }
  smap_slope_under(&state->here, still, cycle->slope);
  if (seen != SMAP_WAITS) { /* of a posture that has no pose yet the slope is that of the last */
    memcpy(state->slope, cycle->slope, sizeof state->slope);
    smap_slope_ahead(control, state, still, sample->rate, cycle->poses, state->slope);
  }
  if (smap_run_target(control, state->slope, sample->desired, target) != SMAP_OK) {
    return smap_blind(state, SMAP_INVALID, cycle);
  }
  now = smap_tip_of(&state->here, g);
  cycle->least = smap_tip_of(&state->here, ahead);
  cycle->tip = smap_lesser(now, cycle->least);
  smap_decide(control, state, sample, target, ahead, command, cycle);
  memcpy(state->command, command, sizeof(float) * smap_joints(control));
  state->has |= SMAP_HAS_COMMAND;
  rate = smap_rate_of(sample->rate);
  cycle->left = cycle->tip > 0.0f ? smap_lesser(SMAP_LONG, cycle->tip / (rate + 1e-6f)) : 0.0f;
  cycle->alarm = smap_run_alarm(control, memory, now, rate);
  return SMAP_OK;
}

