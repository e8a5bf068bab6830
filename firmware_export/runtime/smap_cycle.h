/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
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

/* ---- control: a cycle -------------------------------------------------------------------------------------- */
#define SMAP_SHORTEST 0.0625f /* of a step: no shorter one is tried */
/* Factors of the next step after one that was refused, and after one that was gone: a box a little larger than
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

/* Writes the answer of a cycle that knows nothing. */
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

/* Tells whether a way may be gone: it keeps the margin, or is no worse than staying, or stands all along and ends no
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

/* Chooses the joints that move next: after a step that was refused one that is not where it should be, all after the
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
  for (tries = 0; tries < SMAP_TRIES && cycle->move == SMAP_HELD; tries++) {
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

/* ---- control: budgets, checks, and the functions of this export ------------------------------------- */
/* The largest acceleration along a direction.  Gravity and inertia together are turned against it by as much
 * as was read, and read again: the tip angle changes by no more than the angle of turning.  Of many contacts
 * the boundary is gone through for where the way meets it, which counts as a read, and read there; turned by
 * little at a time only where that does not stand. */
static int8_t smap_run_budget(const smap_pose_t *pose, const float *gravity, const float *direction, uint8_t reads,
                              float *acceleration)
{
  float f[3], to[3], sum = 0.0f;
  uint8_t n;
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
    if (SMAP_JUMPS && n == 0 && reads > 2) {
      if (smap_jump(pose, f, to, &sum)) {
        break;
      }
      reads = (uint8_t)(reads - 2);
    }
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
    smap_plus(f, -t, to, f);
  }
  *acceleration = SMAP_GRAVITY * 0.9999f * sum;
  return status;
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
      smap_crc(policy + settings, table) != smap_u32(policy + SMAP_POLICY_CRC_TABLE) ||
      !smap_check_singles(policy + SMAP_POLICY_JOINTS, (settings - SMAP_POLICY_JOINTS) / 4u, 4, 1e6f)) {
    return SMAP_CORRUPT;
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
  if (bytes < sizeof *state) {
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
    smap_run_start,  smap_run_ground, smap_run_target, smap_run_transit,      smap_run_step,
    smap_run_budget, smap_run_alarm,  smap_run_sane,   smap_run_control_check};
