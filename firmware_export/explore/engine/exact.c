/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The runtime's code for many contacts in double precision: what the page calls exact.
 *
 * tools/explorer.py compiles this with the parts many_*.c turned into doubles, their tolerances those
 * of the exact definition instead of those that single precision needs.  It is asked with positions,
 * which the page computes from the links; no table comes between. */
#include <stddef.h>
#include <stdint.h>

#include "string.h"

#define SMAP_MANY_CONTACTS 62
#define SMAP_MANY_RAILS 0
#define SMAP_MANY_FACETS 400
#define SMAP_MANY_SHOWN 300
#define SMAP_MANY_EDGES 1600
#define SMAP_MANY_SIDES 800
#define SMAP_MANY_WALLS 4000
#define SMAP_MANY_LINKS 4000
#define SMAP_NAN __builtin_nan("")

typedef struct {
  double sdg, tip_angle, height;
  uint16_t over[2];
} smap_reading_t;
typedef enum { SMAP_OK = 0, SMAP_TIPS = 2, SMAP_ROCKS = 4 } smap_status_t;

static double smap_root(double x)
{
  return __builtin_sqrt(x);
}

static double smap_absolute(double x)
{
  return x < 0.0 ? -x : x;
}

/* asin(x), rad, as lutgen/channels/angles.py has it: to 1.3 units in the last place. */
static double smap_asin(double x)
{
  static const double part[13] = {
      0.02875785136742157,  -0.014851887071247209, 0.017400879442694025, 0.005457506718640357,
      0.01032281435018578,  0.011479177415184906,  0.013971212973552933, 0.017352392720869973,
      0.02237217294214989,  0.030381944138531247,  0.04464285714635543,  0.07499999999998433,
      0.16666666666666669};
  const double half_pi = 1.5707963267948966, rest_of_half_pi = 6.123233995736766e-17;
  const double size = x < 0.0 ? -x : x;
  const int steep = size > 0.5;
  double z = size * size, s = size, p = part[0], lost, angle;
  int k;
  if (steep) {
    z = size < 1.0 ? 0.5 - 0.5 * size : 0.0;
    s = smap_root(z);
  }
  for (k = 1; k < 13; k++) {
    p = p * z + part[k];
  }
  lost = (z - s * s) / (s > 0.0 ? 2.0 * s : 1e-300);
  if (steep) {
    const double rest = half_pi - 2.0 * s;
    angle = rest - (2.0 * (p * z * s + lost) - ((half_pi - rest) - 2.0 * s + rest_of_half_pi));
  } else {
    angle = s + p * z * s;
  }
  return x < 0.0 ? -angle : angle;
}

#include "many_types.c"
#include "many_planes.c"
#include "many_rests.c"
#include "many_search.c"
/* Whether the definition follows the roll over an edge from its other side: from the facet with the
 * lesser pitch on. */
static int exact_backwards(const smap_many_work_t *w, uint16_t e)
{
  const double here = w->facet[w->owner[e]].at.n[0], there = w->facet[w->owner[w->twin[e]]].at.n[0];
  return there < here;
}
#include "many_rolls.c"
#include "many_held.c"
#include "many_gaps.c"
static void exact_side(smap_many_work_t *w, smap_many_pose_t *o, uint16_t e, smap_side_t *side,
                       const double p[3], const double q[3]);
#include "many_walls.c"
#include "many_pieces.c"
#include "many_trace.c"
#include "many_strips.c"
#include "sides.c"
#include "many_pose.c"
#include "many_at.c"

/* What is asked and answered.  A contact: centre relative to the com, radius, axis of a disc or 0.
 * Numbers: size, steepest, least height, rest width, tolerance, rock angle, band. */
enum { CONTACT = 7, NUMBERS = 7, ANSWER = 6, FACET = 8, EDGE = 11 };
double exact_contact[CONTACT * SMAP_MANY_CONTACTS];
double exact_number[NUMBERS];
double exact_gravity[3];
double exact_answer[ANSWER];
double exact_facets[FACET * SMAP_MANY_SHOWN];
double exact_edges[EDGE * SMAP_MANY_EDGES];
static smap_many_t robot;
static double axles[SMAP_MANY_CONTACTS][3];
static smap_many_pose_t pose;
static smap_many_work_t work;

/* Make the pose of the contacts; 1 where that was possible. */
int exact_pose(int contacts);
int exact_pose(int contacts)
{
  int i;
  memset(&robot, 0, sizeof robot);
  robot.contacts = (uint16_t)contacts;
  robot.axis[1] = 1.0;
  robot.size = exact_number[0];
  robot.steepest = exact_number[1];
  robot.least_height = exact_number[2];
  robot.rest_width = exact_number[3];
  robot.tolerance = exact_number[4];
  robot.rock_angle = exact_number[5];
  robot.band = exact_number[6];
  robot.room.facets = SMAP_MANY_FACETS;
  robot.room.edges = SMAP_MANY_EDGES;
  robot.room.shown = SMAP_MANY_SHOWN;
  robot.room.walls = SMAP_MANY_WALLS;
  robot.room.links = SMAP_MANY_LINKS;
  robot.room.sides = SMAP_MANY_SIDES;
  robot.room.sought = SMAP_MANY_WORK;
  robot.room.work = SMAP_MANY_WORK;
  work.axle = axles;
  for (i = 0; i < contacts; i++) {
    const double *from = exact_contact + CONTACT * i;
    smap_copy(from, work.p[i]);
    work.r[i] = from[3];
    smap_copy(from + 4, axles[i]);
    robot.named[i] = (uint8_t)i;
  }
  return smap_many_pose(&robot, &pose, &work);
}

/* The angle between a direction and a segment of the boundary. */
static double segment_angle(const smap_segment_t *s, const double g[3])
{
  const double *n = pose.wall[s->wall], *start = pose.point[s->start], *stop = pose.point[s->stop];
  double c[3], d[3], near, other;
  smap_cross(n, start, c);
  smap_cross(stop, n, d);
  if (smap_dot(c, g) >= 0.0 && smap_dot(d, g) >= 0.0) {
    const double sine = smap_dot(n, g);
    return smap_asin(sine < 0.0 ? -sine : sine);
  }
  smap_minus(g, start, c);
  smap_minus(g, stop, d);
  near = smap_dot(c, c);
  other = smap_dot(d, d);
  near = 0.5 * smap_root(other < near ? other : near);
  return 2.0 * smap_asin(near < 1.0 ? near : 1.0);
}

/* Whether the region is one convex cone, as the definition asks before it measures. */
static int is_convex(void)
{
  uint16_t k;
  for (k = 0; k < pose.at.shown; k++) {
    if (pose.at.kind[k] != SMAP_REST || pose.at.island[k] != pose.at.island[0] ||
        !pose.at.convex[pose.at.island[0]]) {
      return 0;
    }
  }
  return pose.at.sides == 0;
}

/* The tip angle of the definition (lutgen/channels/angles.py), which of a convex region measures to the
 * planes of all axes, outside too; the runtime measures to segments.  `which`: the nearest wall. */
static double tip_of(const double g[3], int standing, int *which)
{
  const int convex = is_convex();
  double least = convex ? 2.0 : 3.141592653589793;
  int rests = 0, k;
  for (k = 0; k < pose.at.shown; k++) {
    rests += pose.at.kind[k] == SMAP_REST;
  }
  *which = -1;
  if (!pose.at.alive || rests == 0) {
    return -3.141592653589793;
  }
  if (pose.at.segments == 0) {
    return standing ? 3.141592653589793 : -3.141592653589793;
  }
  for (k = 0; k < pose.at.segments; k++) {
    const smap_segment_t *s = &pose.at.segment[k];
    const double away = convex ? smap_dot(pose.wall[s->wall], g) : segment_angle(s, g);
    if (away < least) {
      least = away;
      *which = s->wall;
    }
  }
  if (convex) {
    least = smap_asin(least);
    return standing ? (least > 0.0 ? least : 0.0) : (least < -1e-30 ? least : -1e-30);
  }
  return standing ? least : -(least > 1e-30 ? least : 1e-30);
}

/* Read the pose under exact_gravity, a unit vector: status, sdg, tip angle, height, the two contacts. */
void exact_read(void);
void exact_read(void)
{
  smap_reading_t reading;
  int which;
  exact_answer[0] = (double)smap_many_at(&pose, exact_gravity, &reading);
  exact_answer[1] = reading.sdg;
  exact_answer[2] = tip_of(exact_gravity, exact_answer[0] != SMAP_TIPS, &which);
  exact_answer[3] = reading.height;
  exact_answer[4] = which < 0 ? SMAP_NONE : pose.at.over[which][0];
  exact_answer[5] = which < 0 ? SMAP_NONE : pose.at.over[which][1];
}

/* List the facets that count: kind, n / h, centre, height; return how many. */
int exact_list_facets(void);
int exact_list_facets(void)
{
  int f, k;
  for (f = 0; f < pose.at.shown; f++) {
    double *to = exact_facets + FACET * f;
    to[0] = pose.at.kind[f];
    to[7] = pose.height[f];
    for (k = 0; k < 3; k++) {
      to[1 + k] = pose.plane[f][k];
      to[4 + k] = pose.centre[f][k];
    }
  }
  return pose.at.shown;
}

/* List the edges of those facets: facet, kind, both ends, from which part on it holds (below 0: joined
 * with the facet beyond; above 1: the robot tips over it), both contacts; return how many. */
int exact_list_edges(void);
int exact_list_edges(void)
{
  int e, k, count = 0;
  for (e = 0; e < work.edges && pose.at.alive; e++) {
    const smap_facet_t *f = &work.facet[work.owner[e]];
    double *to = exact_edges + EDGE * count;
    if (f->kind == SMAP_REFUSED || f->shown == SMAP_NONE) {
      continue;
    }
    to[0] = f->shown;
    to[1] = f->kind;
    for (k = 0; k < 3; k++) {
      to[2 + k] = smap_corner(&work, (uint16_t)e)[k];
      to[5 + k] = smap_end(&work, (uint16_t)e)[k];
    }
    to[8] = work.low[e];
    to[9] = work.vertex[e];
    to[10] = work.vertex[work.next[e]];
    count++;
  }
  return count;
}

/* List the segments of the boundary: both ends as unit vectors, both contacts; return how many. */
double exact_segments[8 * SMAP_MANY_LINKS];
int exact_list_segments(void);
int exact_list_segments(void)
{
  int s, k;
  for (s = 0; s < pose.at.segments && pose.at.alive; s++) {
    const smap_segment_t *from = &pose.at.segment[s];
    double *to = exact_segments + 8 * s;
    for (k = 0; k < 3; k++) {
      to[k] = pose.point[from->start][k];
      to[3 + k] = pose.point[from->stop][k];
    }
    to[6] = pose.at.over[from->wall][0];
    to[7] = pose.at.over[from->wall][1];
  }
  return pose.at.alive ? pose.at.segments : 0;
}
