/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* smap_control: from accelerometer and joints to a command that does not tip the robot.
 *
 *     #include "crawler.h"                             the export of a robot called `crawler`, with a policy
 *
 *     static crawler_state_t state;                    kept between cycles; all zero holds and alarms
 *
 *     void begin(void) { (void)smap_start(&crawler_control, &state, sizeof state); }
 *
 *     void every_cycle(const float *joints, const float *wanted, const float up[3], const float rate[3])
 *     {
 *       float command[CRAWLER_PARAMS];
 *       smap_cycle_t cycle;
 *       smap_sample_t sample = {joints, wanted, {up[0], up[1], up[2]}, {rate[0], rate[1], rate[2]}, {0, 0, 0}};
 *       (void)smap_step(&crawler_control, &state, &sample, command, &cycle);
 *       drive_joints(command);                         always within axes and rates; cycle.alarm: 0 to 3
 *     }
 *
 * One cycle: gravity is turned ahead by the gyroscope for as long as commands take to act; the slope of the
 * ground follows from the posture and the accelerometer, and is turned ahead by what the gyroscope feels beside the
 * robot's own lean; the policy's table names the best posture for that slope; the command goes there by no more
 * than the joints can do in a cycle, and only where *every* posture between now and the command is certified to
 * stand by the map, or staying is worse.  The map decides, never the table: a wrong table may cost margin, not
 * safety.
 *
 * Frames: body frame, x forward, y left, z up.  The ground's frame has z along its normal, and is
 * turned against the body by the least rotation.  `up` is what the accelerometer reads, at rest up; gravity
 * points down.  Units: m/s^2, rad, rad/s, s, joints in rad or the map's length unit.
 *
 * Cost: C99, no heap, no statics, no recursion, every loop bounded; the state is the caller's.  A cycle makes
 * at most as many poses as the header of the export says.  All functions are the export's own, as in smap.h. */
#ifndef SMAP_CONTROL_H
#define SMAP_CONTROL_H

#include "smap.h"

#define SMAP_CONTROL_VERSION 1
#define SMAP_GRAVITY 9.80665f

typedef struct smap_control smap_control_t; /* a map and its policy: constant, in flash */

/* The inputs of a cycle, all of one moment. */
typedef struct {
  const float *posture; /* joints as measured */
  const float *desired; /* joints that the driver asks for; 0: what the policy says, wherever that is */
  float up[3];          /* accelerometer, m/s^2; at rest up */
  float rate[3];        /* gyroscope, rad/s; zeros where there is none */
  float own[3];         /* the body's own acceleration where it is known, m/s^2, as part of `up` */
} smap_sample_t;

typedef enum {
  SMAP_MOVES = 0,   /* every posture on the way is certified */
  SMAP_RESTS = 1,   /* the posture is where it should be */
  SMAP_HELD = 2,    /* the way is not certified: the command is the posture; next one joint after another is tried
                       alone, then a step of 0.6 the size; steps that are gone grow by 1.15 */
  SMAP_ESCAPES = 3, /* staying tips: the way is not certified, and ends further from tipping */
  SMAP_BLIND = 4    /* nothing is known (NaN, damaged map, implausible sensor): the last command is kept */
} smap_move_t;

/* The outputs of a cycle beside its command. */
typedef struct {
  float slope[3]; /* gravity in the ground's frame, unit, as it is now; zeros where nothing is known */
  float tip;      /* tip angle of the posture, the lesser of now and of gravity turned ahead, rad; of directions
                     that the map does not hold, from below */
  float least;    /* certified least tip angle from the posture to the command, rad; tip where it rests */
  float left;     /* s until it tips at the present rate of turning, at most 1000 */
  uint8_t alarm;  /* 0 to 3: rises at once, falls late */
  uint8_t move;   /* smap_move_t */
  uint8_t poses;  /* that were made */
  uint8_t spare;
} smap_cycle_t;

/* ---- how a policy is reached: each export brings its own functions ---------------------------- */
typedef struct {
  int8_t (*start)(const smap_control_t *, void *, uint16_t);
  int8_t (*ground)(const smap_control_t *, void *, const float *, const float *, float *);
  int8_t (*target)(const smap_control_t *, const float *, const float *, float *);
  int8_t (*transit)(const smap_control_t *, void *, const float *, const float *, const float *, float *);
  int8_t (*step)(const smap_control_t *, void *, const smap_sample_t *, float *, smap_cycle_t *);
  int8_t (*budget)(const smap_pose_t *, const float *, const float *, uint8_t, float *);
  uint8_t (*alarm)(const smap_control_t *, void *, float, float);
  int8_t (*sane)(const smap_control_t *, void *, const smap_sample_t *);
  int8_t (*check)(const smap_control_t *);
} smap_control_runtime_t;

struct smap_control {
  const smap_control_runtime_t *run; /* the functions of this export */
  const smap_t *map;
  const void *policy; /* settings, then the table */
  uint32_t size;      /* bytes of it */
};

/* Check map and policy, and prepare a state: NAME_state_t of NAME.h, `bytes` its size.  SMAP_OK, SMAP_CORRUPT
 * or SMAP_INVALID: then every cycle holds and alarms. */
static inline smap_status_t smap_start(const smap_control_t *control, void *state, uint16_t bytes)
{
  return (smap_status_t)control->run->start(control, state, bytes);
}

/* One cycle of control.  `command` has room for every joint, and is always within the axes.  SMAP_OK, or
 * why nothing is known (SMAP_BLIND). */
static inline smap_status_t smap_step(const smap_control_t *control, void *state,
                                      const smap_sample_t *sample, float *command, smap_cycle_t *cycle)
{
  return (smap_status_t)control->run->step(control, state, sample, command, cycle);
}

/* ---- the pieces of a cycle, for those who want them one by one -------------------------------- */

/* The slope on which the robot stands: gravity in the ground's frame, the key of the policy.  It does not move
 * with the robot. */
static inline smap_status_t smap_ground(const smap_control_t *control, void *state, const float *posture,
                                        const float up[3], float slope[3])
{
  return (smap_status_t)control->run->ground(control, state, posture, up, slope);
}

/* The posture for a slope, within the policy's range around `desired` (0: anywhere) and within the axes. */
static inline smap_status_t smap_target(const smap_control_t *control, const float slope[3],
                                        const float *desired, float *target)
{
  return (smap_status_t)control->run->target(control, slope, desired, target);
}

/* The least tip angle of all postures that any joints' speeds may make of the way between two, from below;
 * `gravity` in the body frame at `from`.  Negative: it may tip on the way. */
static inline smap_status_t smap_transit(const smap_control_t *control, void *state, const float *from,
                                         const float *to, const float gravity[3], float *least)
{
  return (smap_status_t)control->run->transit(control, state, from, to, gravity, least);
}

/* The largest acceleration of the robot along `direction` (any length > 0, body frame) before it tips, m/s^2:
 * never too much.  `pose` is of smap_pose with SMAP_FLOAT; `reads` more make it more exact, 4 are
 * plenty.  Braking: backward; turning to the left: to the left. */
static inline smap_status_t smap_budget(const smap_control_t *control, const smap_pose_t *pose,
                                        const float gravity[3], const float direction[3], uint8_t reads,
                                        float *acceleration)
{
  return (smap_status_t)control->run->budget(pose, gravity, direction, reads, acceleration);
}

/* The alarm's level, 0 to 3, after a tip angle (rad) and a rate of turning (rad/s): rises at once, falls late. */
static inline uint8_t smap_alarm(const smap_control_t *control, void *state, float tip, float rate)
{
  return control->run->alarm(control, state, tip, rate);
}

/* Returns SMAP_OK if a sample is plausible, else SMAP_INVALID.  Finite; `up` of a plausible length, turning no
 * further than the gyroscope says and accelerations can explain, not stuck while the robot turns. */
static inline smap_status_t smap_sane(const smap_control_t *control, void *state,
                                      const smap_sample_t *sample)
{
  return (smap_status_t)control->run->sane(control, state, sample);
}

/* Verify map and policy as they lie in flash, and that the policy is the map's: SMAP_OK or SMAP_CORRUPT.  For
 * idle times; smap_start does so. */
static inline smap_status_t smap_control_check(const smap_control_t *control)
{
  return (smap_status_t)control->run->check(control);
}

#endif
