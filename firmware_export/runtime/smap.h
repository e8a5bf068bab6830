/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* smap: does a robot that changes its shape stand, and how far is it from tipping over?
 *
 * A robot's posture changes with its joints, gravity with every sample of an accelerometer.  So a read
 * has two phases, and the one that is asked often is the cheap one:
 *
 *     #include "crawler.h"                             the export of a robot called `crawler`
 *
 *     static crawler_pose_t pose;                      kept between calls; all zero reads unsafe
 *
 *     void joints_moved(const float *joints)           rad or length, in the order of crawler.h
 *     {
 *       (void)smap_pose(&crawler, joints, &pose.pose, sizeof pose, SMAP_FLOAT | SMAP_INTEGER);
 *     }
 *
 *     int about_to_tip(const int16_t up[3])            raw counts of an accelerometer
 *     {
 *       int16_t gravity[3];
 *       smap_reading_i_t reading;
 *       smap_gravity_from_up_i(up, gravity);
 *       return !smap_is_safe(smap_at_i(&pose.pose, gravity, &reading)) || reading.tip < 2856;   5 deg
 *     }
 *
 * Frames and signs: body frame, x forward, y left, z up.  `gravity` points down and may have any length
 * above 0; an accelerometer at rest reads the opposite, see smap_gravity_from_up.  While the robot
 * accelerates it reads gravity and inertia together, and that is what tips the robot.
 *
 * Units: rad, and the length unit of the map (NAME.h says which).  Integers: parameters from 0 at an
 * axis's lower end to 32767 at its upper one; the sine of the tip angle in 1/32767; lengths in steps
 * that NAME.h defines.
 *
 * Safe side: smap_is_safe(status) holds for SMAP_OK and SMAP_ROCKS, the two answers of a robot that does
 * not tip over.  With any other status tip_angle is negative and sdg is NAN, whatever bits went in.
 * tip_angle is never above the truth: a guard, printed in NAME.h, is subtracted.  A look-up table for
 * more than three contacts tells angles up to 30 deg, and is tested, not proved: NAME.h says on how many
 * points.
 *
 * Cost: C99, no heap, no globals, no recursion, every loop bounded; stdint.h and string.h only.  NAME.h
 * has instructions and bytes.  An export is NAME.c: the runtime, whose functions are all static, and the
 * tables, so any number of exports live in one program and none can read another's. */
#ifndef SMAP_H
#define SMAP_H

#include <limits.h>
#include <stdint.h>
#include <string.h>

#if CHAR_BIT != 8 || !defined(UINT8_MAX)
#error "exports of lutgen need bytes of 8 bits and uint8_t"
#endif

#define SMAP_VERSION 3

typedef struct smap smap_t; /* a map: constant, in flash */

typedef struct {
  float sdg;       /* stability factor |SD_g|, in the map's length unit; NAN: not held, or tips */
  float tip_angle; /* rad until the robot tips, less the map's guard; negative: it tips */
  float height;    /* |OC|, height of the centre of mass over its support; NAN as for sdg */
  uint8_t over[2]; /* the two contacts over which it would tip, in the recipe's order; 255: none */
} smap_reading_t;

typedef struct {
  uint16_t sdg;    /* in steps of NAME_SDG_STEP; 65535: not held, or tips */
  int16_t tip;     /* sine of the tip angle less the guard, in 1/32767; negative: it tips */
  uint16_t height; /* in steps of NAME_HEIGHT_STEP; 65535 as for sdg */
  uint8_t over[2]; /* as in smap_reading_t */
} smap_reading_i_t;

/* In order of badness. */
typedef enum {
  SMAP_OK = 0,        /* stands on a rest */
  SMAP_ROCKS = 1,     /* between rests: it rocks, but does not tip over */
  SMAP_TIPS = 2,      /* tips, or is so near that the map cannot exclude it */
  SMAP_OFF_CHART = 3, /* the map holds no such direction: taken as unsafe */
  SMAP_OFF_RANGE = 4, /* a parameter is beyond its axis by more than a sensor's tolerance */
  SMAP_CORRUPT = 5,   /* the map in flash is not what was exported */
  SMAP_INVALID = 6    /* NaN, infinity, no gravity, no pose, too little memory for one */
} smap_status_t;

/* Returns whether the robot stands or rocks, and so does not tip over. */
static inline int smap_is_safe(smap_status_t status)
{
  return status <= SMAP_ROCKS;
}

enum { SMAP_FLOAT = 1, SMAP_INTEGER = 2 }; /* forms of a pose: what may be asked of it */

/* The head of every pose: the first member of NAME_pose_t and NAME_pose_i_t. */
typedef struct {
  const smap_t *map; /* 0: never made, reads unsafe */
  int8_t status;     /* of making it; what reads answer unless it is SMAP_OK */
  uint8_t forms;
  uint16_t spare;
} smap_pose_t;

/* ---- how a map is reached: each export brings its own functions ------------------------------- */
typedef struct {
  int8_t (*pose)(const smap_t *, const float *, smap_pose_t *, uint16_t, uint8_t);
  int8_t (*pose_q)(const smap_t *, const int16_t *, smap_pose_t *, uint16_t, uint8_t);
  int8_t (*at)(const smap_pose_t *, const float *, smap_reading_t *);
  int8_t (*at_i)(const smap_pose_t *, const int16_t *, smap_reading_i_t *);
  int8_t (*read)(const smap_t *, const float *, const float *, smap_reading_t *);
  int8_t (*read_i)(const smap_t *, const int16_t *, const int16_t *, smap_reading_i_t *);
  int8_t (*check)(const smap_t *);
} smap_runtime_t;

struct smap {
  const smap_runtime_t *run; /* the functions of this export */
  const void *blob;          /* its descriptor and tables: offsets, no pointers */
  uint32_t size;             /* bytes of it */
};

/* ---- once a posture --------------------------------------------------------------------------- */

/* Compute a posture into `pose`: the member of a NAME_pose_t for both forms, of a NAME_pose_i_t for
 * SMAP_INTEGER alone; `bytes` is the size of the whole.  SMAP_OK, or SMAP_TIPS where the robot stands
 * nowhere in this posture, SMAP_OFF_RANGE, SMAP_INVALID: then every direction reads unsafe. */
static inline smap_status_t smap_pose(const smap_t *map, const float *params, smap_pose_t *pose,
                                      uint16_t bytes, uint8_t forms)
{
  return (smap_status_t)map->run->pose(map, params, pose, bytes, forms);
}

/* The same with every parameter as a whole number: 0 is an axis's lower end, 32767 its upper end. */
static inline smap_status_t smap_pose_q(const smap_t *map, const int16_t *params_q, smap_pose_t *pose,
                                        uint16_t bytes, uint8_t forms)
{
  return (smap_status_t)map->run->pose_q(map, params_q, pose, bytes, forms);
}

/* ---- for every sample of gravity -------------------------------------------------------------- */

/* Write what is no reading, by bits: chips without floats do so, too. */
static inline int8_t smap_deny(smap_reading_t *out, int8_t status)
{
  const uint32_t nan_bits = 0x7FC00000u, minus_pi_bits = 0xC0490FDBu;
  memcpy(&out->sdg, &nan_bits, sizeof nan_bits);
  memcpy(&out->height, &nan_bits, sizeof nan_bits);
  memcpy(&out->tip_angle, &minus_pi_bits, sizeof minus_pi_bits);
  out->over[0] = out->over[1] = 255;
  return status;
}

static inline int8_t smap_deny_i(smap_reading_i_t *out, int8_t status)
{
  out->sdg = out->height = 65535;
  out->tip = -32767;
  out->over[0] = out->over[1] = 255;
  return status;
}

/* Read a pose under a direction of gravity, in floats. */
static inline smap_status_t smap_at(const smap_pose_t *pose, const float gravity[3], smap_reading_t *out)
{
  return (smap_status_t)(pose->map != 0 ? pose->map->run->at(pose, gravity, out) : smap_deny(out, SMAP_INVALID));
}

/* The same without any float: raw counts of an accelerometer, turned to point down. */
static inline smap_status_t smap_at_i(const smap_pose_t *pose, const int16_t gravity[3],
                                      smap_reading_i_t *out)
{
  return (smap_status_t)(pose->map != 0 ? pose->map->run->at_i(pose, gravity, out) : smap_deny_i(out, SMAP_INVALID));
}

/* Read a pose under n directions: n readings, and the worst status of all; SMAP_INVALID of none. */
static inline smap_status_t smap_at_n(const smap_pose_t *pose, const float (*gravity)[3], uint16_t n,
                                      smap_reading_t *out)
{
  smap_status_t worst = n != 0 ? SMAP_OK : SMAP_INVALID;
  uint16_t i;
  for (i = 0; i < n; i++) {
    const smap_status_t status = smap_at(pose, gravity[i], &out[i]);
    worst = status > worst ? status : worst;
  }
  return worst;
}

/* ---- both phases at once ---------------------------------------------------------------------- */
static inline smap_status_t smap_read(const smap_t *map, const float *params, const float gravity[3],
                                      smap_reading_t *out)
{
  return (smap_status_t)map->run->read(map, params, gravity, out);
}

static inline smap_status_t smap_read_i(const smap_t *map, const int16_t *params_q,
                                        const int16_t gravity_q[3], smap_reading_i_t *out)
{
  return (smap_status_t)map->run->read_i(map, params_q, gravity_q, out);
}

/* ---- the rest --------------------------------------------------------------------------------- */

/* Verify a map as it lies in flash: CRC-32 of descriptor and tables, of which every index and size was in bounds.
 * SMAP_OK, or SMAP_CORRUPT: then do not read it.  For the start of a program and for idle times. */
static inline smap_status_t smap_check(const smap_t *map)
{
  return (smap_status_t)map->run->check(map);
}

/* Turn what an accelerometer reads (at rest: up) into the direction of gravity. */
static inline void smap_gravity_from_up(const float up[3], float gravity[3])
{
  gravity[0] = -up[0];
  gravity[1] = -up[1];
  gravity[2] = -up[2];
}

static inline void smap_gravity_from_up_i(const int16_t up[3], int16_t gravity[3])
{
  uint8_t i;
  for (i = 0; i < 3; i++) { /* -32768 has no opposite */
    gravity[i] = up[i] > -32768 ? (int16_t)-up[i] : 32767;
  }
}

/* The highest speed (m/s) from which a dead stop does not tip the robot, whatever stops it: the root of
 * 2 g height (1 - cos tip_angle) / (1 + 2 sin slope / sin tip_angle), a little less.  `height` (m): the
 * com's above the ground, as in the reading; `slope` (rad): the ground's, or the steepest that there is.
 * On a bump take asin(bump / least distance of two contacts) off tip_angle.  0 with `gaps` (NAME_GAPS): a
 * reading does not tell how little lifts a robot over a gap. */
static inline float smap_stop_speed(const smap_reading_t *reading, float height, float slope, int gaps)
{
  const float tip = reading->tip_angle < 1.5f ? reading->tip_angle : 1.5f;
  const float level = 9.806f * height * tip * tip * (1.0f - tip * tip * (1.0f / 12.0f));
  const float sine = tip * (1.0f - tip * tip * (1.0f / 6.0f));
  const float square = level * sine / (sine + 2.0f * slope);
  float root = 0.5f * (1.0f + square);
  uint8_t i;
  if (gaps || !(tip > 0.0f) || !(slope >= 0.0f) || !(square > 0.0f && square < 1e6f)) {
    return 0.0f;
  }
  for (i = 0; i < 16; i++) { /* Newton's steps come from above, so what is divided is below */
    root = 0.5f * (root + square / root);
  }
  return square / root;
}

/* A parameter x as smap_pose_q takes it, for the macros of NAME.h.  Below the lower end steps go on
 * below 0; beyond the upper end there are none, and the answer is SMAP_OFF_RANGE. */
static inline int16_t smap_steps(float x, float low, float high, float scale)
{
  const float steps = (x - low) * scale;
  if (x >= low && x <= high) {
    return (int16_t)(steps + 0.5f);
  }
  return (int16_t)(x < low && steps > -32766.0f ? steps - 0.99f : -32768.0f);
}

#endif
