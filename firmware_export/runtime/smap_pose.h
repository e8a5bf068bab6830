/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
#include "smap_reading_i.h"
/* ---- poses of many contacts: memory, and the functions behind smap.h ----------------------------------
 * The map adds to positions: eleven singles (the level axis of all discs, size, steepest, least height, rest
 * width, tolerance, rock chord, guard, off, turned: see smap_limits_t), tracks u8, the first contact of each track and
 * behind the last u8, the recipe's number of each contact u8, the room of a pose u8[5].  Without tracks the byte behind
 * the last tells how many axles swing: see smap_swing.h. */

typedef struct {
  smap_pose_t head;
  smap_layout_t at;
  smap_region_t region;
  union { /* scratch, free once the integer form is built */
    smap_work_t work;
    smap_region_i_t whole;
  } rest;
} smap_pose_memory_t;

typedef struct {
  smap_pose_t head;
  smap_layout_t at;
  smap_region_i_t whole;
} smap_pose_memory_i_t;

static void smap_limits(const smap_t *map, smap_limits_t *m)
{
  const smap_bytes_t body = smap_body(map) + SMAP_IN_MANY;
  m->placed = m->contacts = SMAP_BLOB(map)[SMAP_AT_CONTACTS];
  m->tracks = body[SMAP_SINGLES];
  m->first = body + SMAP_SINGLES + 1;
  m->named = m->first + m->tracks + 1;
  m->room = m->named + m->contacts;
  m->contacts = (uint8_t)(m->contacts - (SMAP_PIVOTS > 0 ? 2u * m->first[0] : 0u));
  m->axis[0] = smap_f32(body);
  m->axis[1] = smap_f32(body + 4);
  m->size = smap_f32(body + 8);
  m->steepest = smap_f32(body + 12);
  m->least_height = smap_f32(body + 16);
  m->rest_width = smap_f32(body + 20);
  m->tolerance = smap_f32(body + 24);
  m->rock_chord = smap_f32(body + 28);
  m->guard = smap_f32(body + 32);
  m->off = smap_f32(body + 36);
  m->turned = smap_f32(body + 40);
}

/* Put the contacts where the parameters have them. */
SMAP_APART static int8_t smap_place(const smap_t *map, const float *params, smap_work_t *work)
{
  const uint8_t flags = smap_body(map)[SMAP_IN_FLAGS];
  float q[SMAP_MAX_PARAMS];
  const int8_t status = smap_range(map, params, q);
  smap_places_t at;
  uint8_t i;
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  at = smap_places(map);
  smap_positions(map, q, work->p[0]);
  for (i = 0; i < at.contacts; i++) {
    work->r[i] = flags & SMAP_ROUND ? smap_f32(at.radii + 4 * i) : 0.0f;
    if (SMAP_DISCS > 0) {
      work->axle_of[i] = smap_body(map)[SMAP_IN_AXES] != 0 ? at.axis_of[i] : (uint8_t)SMAP_NO_AXIS;
    }
  }
  work->axles = SMAP_DISCS > 0 ? smap_body(map)[SMAP_IN_AXES] : (uint8_t)0;
  return SMAP_OK;
}

/* Turn a region from the frame of the axis into the body's. */
static void smap_turn_region(const smap_limits_t *m, const smap_layout_t *at, smap_region_t *o)
{
  smap_turn(o->plane, at->rests, -m->axis[0], m->axis[1]);
  smap_turn(o->centre, at->rests, -m->axis[0], m->axis[1]);
  smap_turn(o->wall, (uint8_t)(at->first[at->rests] + 2u * at->gaps), -m->axis[0], m->axis[1]);
  smap_turn(o->place, at->places, -m->axis[0], m->axis[1]);
}

/* Make the region of contacts that are placed, in the frame of the axis; SMAP_TIPS where no direction stands. */
static int8_t smap_make_region(const smap_limits_t *m, smap_layout_t *at, smap_region_t *o, smap_work_t *work)
{
  work->map = m;
  work->at = at;
  work->region = o;
  work->full = work->facets = 0;
  o->guard = m->guard;
  at->rests = at->gaps = at->arcs = at->nearly = at->first[0] = 0;
  smap_find_rests(work);
  at->rests = smap_close(work) ? at->rests : (uint8_t)0;
  return at->rests != 0 ? (int8_t)SMAP_OK : (int8_t)SMAP_TIPS;
}

static int8_t smap_run_at(const smap_pose_t *pose, const float *gravity, smap_reading_t *out)
{
  const smap_pose_memory_t *const many = (const smap_pose_memory_t *)pose;
  float d[3];
  int8_t status = pose->forms & SMAP_FLOAT ? pose->status : (int8_t)SMAP_INVALID;
  if (status == SMAP_OK) {
    status = smap_direction(pose->map, gravity, d);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, status);
  }
  status = smap_read_region(&many->at, &many->region, d, out);
  return smap_judge(pose->map, out, status);
}

static int8_t smap_run_at_i(const smap_pose_t *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  const smap_pose_memory_t *const both = (const smap_pose_memory_t *)pose;
  const smap_pose_memory_i_t *const alone = (const smap_pose_memory_i_t *)pose;
  const smap_region_i_t *const whole = pose->forms & SMAP_FLOAT ? &both->rest.whole : &alone->whole;
  const uint8_t channels = SMAP_BLOB(pose->map)[SMAP_AT_CHANNELS];
  int32_t g[3];
  uint32_t length;
  int8_t status = pose->forms & SMAP_INTEGER ? pose->status : (int8_t)SMAP_INVALID;
  if (status == SMAP_OK) {
    status = smap_direction_i(pose->map, gravity, g, &length);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny_i(out, status);
  }
  status = smap_read_region_i(&both->at, whole, g, length, out);
  out->sdg = channels & SMAP_SDG ? out->sdg : (uint16_t)65535u;
  out->height = channels & SMAP_HEIGHT ? out->height : (uint16_t)65535u;
  return status;
}

/* Make a pose with floats; the work on it is done in its own memory. */
static int8_t smap_pose_floats(const smap_t *map, const float *params, smap_pose_t *pose, uint16_t bytes, uint8_t forms)
{
  smap_pose_memory_t *const many = (smap_pose_memory_t *)pose;
  smap_limits_t m;
  if (!smap_begin(map, pose, bytes, forms, SMAP_FLOAT | SMAP_INTEGER, sizeof *many)) {
    return SMAP_INVALID;
  }
  smap_limits(map, &m);
  pose->status = smap_place(map, params, &many->rest.work);
  if (pose->status == SMAP_OK) {
    pose->status = smap_make_region(&m, &many->at, &many->region, &many->rest.work);
  }
  if (SMAP_IS_TURNED(&m) && pose->status == SMAP_OK) {
    smap_turn_region(&m, &many->at, &many->region);
  }
  if ((forms & SMAP_INTEGER) && pose->status == SMAP_OK) {
    smap_make_i(&many->at, &many->region, smap_f32(SMAP_BLOB(map) + SMAP_AT_STEP), &many->rest.whole);
  }
  return pose->status;
}

/* Make one of integers alone, with all work on the stack: apart, so that one with floats needs none of that. */
SMAP_APART static int8_t smap_pose_whole(const smap_t *map, const float *params, smap_pose_t *pose, uint16_t bytes,
                                         uint8_t forms)
{
  smap_pose_memory_i_t *const alone = (smap_pose_memory_i_t *)pose;
  smap_pose_memory_t both;
  if (!smap_begin(map, pose, bytes, forms, SMAP_FLOAT | SMAP_INTEGER, sizeof *alone)) {
    return SMAP_INVALID;
  }
  pose->status = smap_pose_floats(map, params, &both.head, sizeof both, SMAP_FLOAT | SMAP_INTEGER);
  alone->at = both.at;
  alone->whole = both.rest.whole;
  return pose->status;
}

static int8_t smap_run_pose(const smap_t *map, const float *params, smap_pose_t *pose, uint16_t bytes, uint8_t forms)
{
  return forms & SMAP_FLOAT ? smap_pose_floats(map, params, pose, bytes, forms)
                            : smap_pose_whole(map, params, pose, bytes, forms);
}

static int8_t smap_run_pose_q(const smap_t *map, const int16_t *params_q, smap_pose_t *pose, uint16_t bytes,
                              uint8_t forms)
{
  float params[SMAP_MAX_PARAMS];
  smap_from_steps(map, params_q, params);
  return smap_run_pose(map, params, pose, bytes, forms);
}

static int8_t smap_run_read(const smap_t *map, const float *params, const float *gravity, smap_reading_t *out)
{
  smap_pose_memory_t pose;
  const int8_t status = smap_pose_floats(map, params, &pose.head, sizeof pose, SMAP_FLOAT);
  return status != SMAP_OK ? smap_deny(out, status) : smap_run_at(&pose.head, gravity, out);
}

static int8_t smap_run_read_i(const smap_t *map, const int16_t *params_q, const int16_t *gravity_q,
                              smap_reading_i_t *out)
{
  smap_pose_memory_t pose;
  float params[SMAP_MAX_PARAMS];
  int8_t status;
  smap_from_steps(map, params_q, params);
  status = smap_pose_floats(map, params, &pose.head, sizeof pose, SMAP_FLOAT | SMAP_INTEGER);
  return status != SMAP_OK ? smap_deny_i(out, status) : smap_run_at_i(&pose.head, gravity_q, out);
}

/* Numbers that no loop or index may be led astray by. */
static int smap_check_many(const smap_t *map)
{
  const smap_bytes_t body = smap_body(map) + SMAP_IN_MANY;
  const uint16_t bytes = smap_u16(smap_body(map) + SMAP_IN_MANY_BYTES);
  const uint8_t contacts = SMAP_BLOB(map)[SMAP_AT_CONTACTS];
  const uint8_t tracks = bytes > SMAP_SINGLES ? body[SMAP_SINGLES] : SMAP_NONE;
  const smap_bytes_t first = body + SMAP_SINGLES + 1;
  const uint8_t axles = tracks == 0 ? first[0] : (uint8_t)0;
  uint8_t i;
  if (contacts > SMAP_MAX_CONTACTS || contacts < 3 + 2 * axles ||
      contacts < 4 * axles || tracks > SMAP_TRACKS ||
      (tracks > 1) != (SMAP_TRACKS > 1) || axles > SMAP_PIVOTS ||
      bytes != SMAP_SINGLES + 2u + tracks + contacts + SMAP_ROOMS || first[0] != axles ||
      (SMAP_DISCS > 0 && smap_body(map)[SMAP_IN_AXES] > SMAP_DISCS) ||
      (tracks != 0 && first[tracks] != contacts)) {
    return 0;
  }
  for (i = 0; i < tracks; i++) {
    if (first[i] >= first[i + 1]) {
      return 0;
    }
  }
  return smap_check_singles(body, SMAP_SINGLES / 4, 4, 1e6f) && smap_check_singles(body, 2, 4, 1.001f) &&
         smap_is_positive(smap_f32(body + 8)) && smap_is_within(smap_f32(body + 32), 0.5f);
}

static int smap_check_own(const smap_t *map, smap_bytes_t limit)
{
  return smap_check_axes(map) && smap_check_positions(map, limit) && smap_check_many(map);
}

static const smap_runtime_t smap_run = {smap_run_pose, smap_run_pose_q, smap_run_at,   smap_run_at_i,
                                        smap_run_read, smap_run_read_i, smap_run_check};
