/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- control: many contacts: one pose that holds for every posture of a box -------------------------- */
/* All contacts of all postures of a box are within `off` of where they are in its middle: what each joint moves
 * all contacts, and the most that one moves its own beyond that.  A pose of the
 * middle whose limits are narrower by what that can alter is a pose of them all, as that of a robot given by
 * code whose contacts are known to `off` (contacts/many.py): rests are wider, gaps turn less and hold
 * more, and every wall is as much nearer as moving its contacts can turn it. */
#define SMAP_SWEPT_REST 40.0f /* a rest is at least so many times `off` wide, so that its plane turns little */
#define SMAP_SWEPT_LOW 0.5f   /* of the present plane's height: lower facets are given up */
#define SMAP_SWEPT_ROLLS 4.0f /* as contacts/many.py has it */
#define SMAP_CORNER 1e-4f     /* of the size: nearer to an edge a contact is one of its ends */
#define SMAP_DOUBT 4.0f       /* twice the turn over a contact that has a facet on either side */

/* A pose that holds for every posture of a box: see above. */
typedef struct {
  smap_layout_t at;
  smap_region_t region;
  float turned;  /* rad, by which gravity may turn in the box */
  float widened; /* a sine: how much wider than the map's its guard is */
  int8_t status;
} smap_swept_t;

enum { SMAP_TRIES = 1, SMAP_JUMPS = 1 };

#include "smap_state.h"

/* The rest that gravity pierces first in a pose, or SMAP_NONE. */
static uint8_t smap_below(const smap_pose_memory_t *pose, const float g[3])
{
  const int made = pose->head.status == SMAP_OK;
  return made ? smap_pierced(&pose->at, &pose->region, g) : (uint8_t)SMAP_NONE;
}

/* The upward normal of the plane on which a pose stands under a direction; 0 where it stands on none. */
static int smap_upright(const smap_pose_memory_t *pose, const float g[3], float up[3])
{
  const uint8_t facet = smap_below(pose, g);
  uint8_t i;
  for (i = 0; facet != SMAP_NONE && i < 3; i++) {
    up[i] = -pose->region.plane[facet][i] * pose->region.height[facet];
  }
  return facet != SMAP_NONE;
}

/* Narrow a map's limits for contacts that may be `off` from where they are, and planes of at least a
 * height.  A rest's plane turns by no more than `turn`, and a wheel touches it elsewhere, too.  Returns how far
 * any place at which the robot touches may be off. */
static float smap_narrow(smap_limits_t *m, float off, float radius, float lowest)
{
  const float rest = SMAP_SWEPT_REST * off, wide = m->rest_width > rest ? m->rest_width : rest;
  const float turn = wide > 0.0f ? 2.0f * off / wide : 0.0f;
  const float low = m->least_height > lowest ? m->least_height : lowest;
  off += radius * turn;
  m->steepest += m->steepest > -1.0f ? turn : 0.0f;
  m->least_height = low + off;
  m->rest_width = wide + 2.0f * off;
  m->tolerance = m->tolerance > SMAP_SWEPT_ROLLS * off ? m->tolerance - SMAP_SWEPT_ROLLS * off : 0.0f;
  m->rock_chord -= 2.0f * turn;
  m->off += SMAP_SWEPT_ROLLS * off / m->size;
  m->turned += 2.0f * turn;
  return off;
}

/* Where the corner e of a rest is: its place is of length 1. */
static void smap_corner(const smap_work_t *w, uint8_t e, float out[3])
{
  const float *const place = w->region->place[e], *const n = w->normal[w->rest[e]];
  const float from[3] = {0.0f, 0.0f, 0.0f};
  smap_mix(from, place, w->region->height[w->rest[e]] / smap_dot(n, place), out);
}

/* By how much (rad) the boundary of a rest may be nearer than its edges say, since a contact that hangs over it
 * carries elsewhere in the box.  Contacts are up to `off` from where they are.  The rest is then several
 * that meet at the contact, and the robot rocks over it: it is not caught where an edge is nearer than twice
 * that turn, nor on what is cut off if that is narrow. */
static float smap_doubt(const smap_work_t *w, uint8_t rest, float off)
{
  const float *const n = w->normal[rest], height = w->region->height[rest];
  const uint8_t start = w->at->first[rest];
  float most = 0.0f;
  uint8_t k;
  for (k = 0; k < SMAP_CONTACTS(w); k++) {
    float here = 0.0f, below, place[3];
    uint8_t e = start, left = SMAP_MAX_CORNERS;
    smap_touch(w, k, n, place);
    below = 2.0f * off - height + smap_dot(place, n);
    if (!(below > 0.0f)) {
      continue;
    }
    do {
      float along[3], arm[3], in[3], apart, lost, size;
      smap_corner(w, w->next[e], along);
      smap_corner(w, e, arm);
      smap_minus(along, arm, along);
      smap_minus(place, arm, arm);
      smap_cross(arm, along, in);
      size = smap_root(smap_dot(along, along));
      apart = size > 0.0f ? smap_dot(in, n) / size : 0.0f;
      if (!(apart > SMAP_CORNER * SMAP_SIZE(w))) {
        here = 0.0f; /* a corner, on an edge or outside: it cuts nothing off */
        break;
      }
      lost = SMAP_DOUBT * below / apart;
      apart /= height;
      lost = lost < apart ? lost : apart;
      here = lost > here ? lost : here;
      e = smap_onward(w, e);
    } while (e != start && --left > 0);
    here = left > 0 ? here : SMAP_PI; /* an outline that does not close: of none that is known */
    most = here > most ? here : most;
  }
  return most;
}

/* Make the pose of the box between two postures, and of what is near.  `lowest`: planes that count are no lower. */
static void smap_sweep(const smap_control_t *control, smap_state_memory_t *state, const float *from,
                       const float *to, float lowest)
{
  const smap_t *const map = SMAP_CONTROLLED(control);
  const uint8_t count = smap_joints(control);
  smap_swept_t *const swept = &state->swept;
  smap_limits_t limits;
  smap_work_t *const work = &state->here.rest.work;
  float off = 0.0f, own, most = 0.0f, radius = 0.0f, height = lowest;
  uint8_t i;
  swept->turned = 0.0f;
  for (i = 0; i < count; i++) {
    state->half[i] = 0.5f * smap_absolute(to[i] - from[i]) + smap_joint(control, i, SMAP_JOINT_NEAR);
    state->mid[i] = from[i] + 0.5f * (to[i] - from[i]);
    off += state->half[i] * smap_joint(control, i, SMAP_JOINT_BEND);
    own = smap_joint(control, i, SMAP_JOINT_REACH) * state->half[i];
    most = own > most ? own : most;
    swept->turned += 2.0f * state->half[i] * smap_joint(control, i, SMAP_JOINT_LEAN);
  }
  smap_limits(map, &limits);
  swept->status = smap_place(map, state->mid, work);
  for (i = 0; swept->status == SMAP_OK && i < limits.contacts; i++) {
    radius = work->r[i] > radius ? work->r[i] : radius;
  }
  own = off + most;
  off = smap_narrow(&limits, own, radius, lowest);
  if (swept->status == SMAP_OK) {
    swept->status = smap_make_region(&limits, &swept->at, &swept->region, work);
  }
  if (swept->status == SMAP_OK) {
    most = 0.0f;
    for (i = 0; i < swept->at.rests; i++) {
      const float doubt = smap_doubt(work, i, own);
      most = doubt > most ? doubt : most;
      height = i == 0 || swept->region.height[i] < height ? swept->region.height[i] : height;
    }
    swept->turned += most;
    /* A wall turns by no more than its contacts move, seen from the com over their line. */
    swept->widened = height > 2.0f * off ? off / (height - off) : 1.0f;
    if (SMAP_IS_TURNED(&limits)) {
      smap_turn_region(&limits, &swept->at, &swept->region);
    }
    swept->region.guard += swept->widened;
  }
}

/* Reads the pose of a box under a direction. */
static void smap_swept_at(const smap_control_t *control, const smap_swept_t *swept, const float g[3],
                          smap_way_t *way)
{
  smap_reading_t reading;
  float on[3], d[3];
  const float turned = smap_to_chart(SMAP_CONTROLLED(control), g, on);
  way->least = way->end = -SMAP_PI;
  if (swept->status == SMAP_OK && smap_direction(SMAP_CONTROLLED(control), on, d) == SMAP_OK) {
    (void)smap_read_region(&swept->at, &swept->region, d, &reading);
    way->least = smap_between(reading.tip_angle - swept->turned - turned, -SMAP_PI, SMAP_PI);
    way->end = reading.tip_angle - turned + swept->widened; /* a sine is less than its angle */
  }
}

/* The height of the plane on which a pose stands under a direction, less what may count as low; 0: none. */
static float smap_lowest(const smap_pose_memory_t *pose, const float g[3])
{
  const uint8_t facet = smap_below(pose, g);
  return facet != SMAP_NONE ? SMAP_SWEPT_LOW * pose->region.height[facet] : 0.0f;
}

enum { SMAP_MOST_JOINTS = SMAP_MAX_PARAMS };

#include "smap_watch.h"

/* Tells whether the pose that is there will do: a posture that is near needs none (SMAP_STAYS), nor one that is to wait
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

/* Tells whether two postures are in the box whose pose is there. */
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
        for (i = 0; i < smap_joints(control); i++) { /* it may be off its axis by the sensor's tolerance */
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

#define SMAP_NEXT_TO 1e-3f /* a sine: a way that passes the end of an arc as near meets it */

/* Finds how much of `to` can be taken off a direction f that stands until it meets the boundary; both unit. */
static float smap_to_boundary(const smap_pose_t *pose, const float f[3], const float to[3])
{
  const smap_pose_memory_t *const many = (const smap_pose_memory_t *)pose;
  const smap_region_t *const o = &many->region;
  const float guard = o->guard, beside = guard + SMAP_NEXT_TO;
  float least = SMAP_MOST_BUDGET / SMAP_GRAVITY;
  uint8_t k;
  for (k = 0; k < many->at.arcs; k++) {
    const float *n = o->wall[many->at.arc[k].wall];
    const float ahead = smap_dot(n, f), side = ahead < 0.0f ? -1.0f : 1.0f;
    const float above = side * ahead - guard, down = side * smap_dot(n, to) + guard;
    float at[3], t;
    if (!(down > 1e-6f) || above < 0.0f || above >= least * down) {
      continue;
    }
    t = above / down;
    smap_plus(f, -t, to, at);
    if (smap_beyond(o, &many->at.arc[k], at) <= beside * (1.0f + t)) {
      least = t;
    }
  }
  return least;
}

/* Tells whether a pose stands when so much of `to` is taken off a direction. */
static int smap_stands_at(const smap_pose_t *pose, const float f[3], const float to[3], float t)
{
  const float at[3] = {f[0] - t * to[0], f[1] - t * to[1], f[2] - t * to[2]};
  smap_reading_t reading;
  const int8_t status = smap_run_at(pose, at, &reading);
  return (status == SMAP_OK || status == SMAP_ROCKS) && reading.tip_angle >= 0.0f;
}

/* The largest part of `to` that can be taken off a direction that stands, where the boundary tells it; 0 where not. */
static int smap_jump(const smap_pose_t *pose, const float f[3], const float to[3], float *sum)
{
  *sum = 0.9999f * smap_to_boundary(pose, f, to);
  if (smap_stands_at(pose, f, to, *sum)) {
    return 1;
  }
  *sum = 0.0f;
  return 0;
}

#include "smap_cycle.h"
