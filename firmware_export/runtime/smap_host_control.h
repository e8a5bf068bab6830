/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* On-board control on the machine of the exporter: a policy in memory, many robots at a time; see smap_host.c.
 * Postures, desired postures and commands: as many numbers for each as the map has parameters. */

typedef struct {
  smap_control_t control;
  smap_t map;
} smap_host_control_t;

/* Bytes of what `control` makes, and of a state. */
void SMAP_HOST_NAME(control_sizes)(uint32_t sizes[2])
{
  sizes[0] = sizeof(smap_host_control_t);
  sizes[1] = sizeof(smap_state_memory_t);
}

/* Put map and policy together, and check both. */
int8_t SMAP_HOST_NAME(control)(void *memory, const uint8_t *blob, uint32_t size, const uint8_t *policy,
                               uint32_t bytes)
{
  smap_host_control_t *const both = (smap_host_control_t *)memory;
  const smap_t map = {&smap_run, blob, size};
  const smap_control_t control = {&smap_control_run, &both->map, policy, bytes};
  memcpy(&both->map, &map, sizeof map);
  memcpy(&both->control, &control, sizeof control);
  return (int8_t)smap_control_check(&both->control);
}

int8_t SMAP_HOST_NAME(start)(const void *memory, int64_t count, uint8_t *states)
{
  const smap_host_control_t *const both = (const smap_host_control_t *)memory;
  int8_t status = SMAP_OK;
  int64_t i;
  for (i = 0; i < count && status == SMAP_OK; i++) {
    status = (int8_t)both->control.run->start(&both->control, states + i * (int64_t)sizeof(smap_state_memory_t),
                                              65535);
  }
  return status;
}

/* A cycle of each robot.  `desired` may be 0; `sensors`: up, rate, own of each, nine numbers. */
void SMAP_HOST_NAME(step)(const void *memory, int64_t count, uint8_t *states, const float *posture,
                          const float *desired, const float *sensors, float *command, smap_cycle_t *cycle,
                          int8_t *status)
{
  const smap_host_control_t *const both = (const smap_host_control_t *)memory;
  const int64_t width = smap_joints(&both->control);
  int64_t i;
  for (i = 0; i < count; i++) {
    smap_sample_t sample;
    sample.posture = posture + i * width;
    sample.desired = desired != 0 ? desired + i * width : 0;
    memcpy(sample.up, sensors + 9 * i, sizeof sample.up);
    memcpy(sample.rate, sensors + 9 * i + 3, sizeof sample.rate);
    memcpy(sample.own, sensors + 9 * i + 6, sizeof sample.own);
    status[i] = (int8_t)smap_step(&both->control, states + i * (int64_t)sizeof(smap_state_memory_t), &sample,
                                  command + i * width, cycle + i);
  }
}

void SMAP_HOST_NAME(ground)(const void *memory, int64_t count, uint8_t *state, const float *posture,
                            const float *up, float *slope, int8_t *status)
{
  const smap_host_control_t *const both = (const smap_host_control_t *)memory;
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] = (int8_t)smap_ground(&both->control, state, posture + i * smap_joints(&both->control),
                                    up + 3 * i, slope + 3 * i);
  }
}

void SMAP_HOST_NAME(target)(const void *memory, int64_t count, const float *slope, const float *desired,
                            float *target)
{
  const smap_host_control_t *const both = (const smap_host_control_t *)memory;
  const int64_t width = smap_joints(&both->control);
  int64_t i;
  for (i = 0; i < count; i++) {
    (void)smap_target(&both->control, slope + 3 * i, desired != 0 ? desired + i * width : 0, target + i * width);
  }
}

void SMAP_HOST_NAME(transit)(const void *memory, int64_t count, uint8_t *state, const float *from,
                             const float *to, const float *gravity, float *least)
{
  const smap_host_control_t *const both = (const smap_host_control_t *)memory;
  const int64_t width = smap_joints(&both->control);
  int64_t i;
  for (i = 0; i < count; i++) {
    (void)smap_transit(&both->control, state, from + i * width, to + i * width, gravity + 3 * i, least + i);
  }
}

/* The budget of each posture under a direction of gravity and one of acceleration. */
void SMAP_HOST_NAME(budget)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                            const float *gravity, const float *direction, uint8_t reads, float *acceleration,
                            int8_t *status)
{
  const smap_t map = {&smap_run, blob, size};
  smap_pose_memory_t pose;
  int64_t i;
  for (i = 0; i < count; i++) {
    (void)smap_pose(&map, params + i * blob[SMAP_AT_PARAMS], &pose.head, sizeof pose, SMAP_FLOAT);
    status[i] = smap_run_budget(&pose.head, gravity + 3 * i, direction + 3 * i, reads, acceleration + i);
  }
}
