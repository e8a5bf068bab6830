/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- many contacts: what their parts share ----------------------------------------------------------- */
/* Robots with more than three contacts, or with round ones: what the parts many_*.c share.
 *
 * A posture becomes a complex of support facets joined by arcs, over which the robot rolls on two
 * contacts.  An edge of the complex belongs to a facet and begins at one of its contacts; its twin
 * is the same arc seen from the facet beyond, or it itself where nothing is.  Counter-clockwise, seen from
 * outside.
 *
 * A pose keeps where the robot stands: a list of convex cones, one for each rest and each gap between two rests,
 * with walls through the com, and the boundary, a list of arcs of great circles.
 */
#ifndef SMAP_MANY_CONTACTS
#define SMAP_MANY_CONTACTS 12
#endif
#ifndef SMAP_MANY_RAILS
#define SMAP_MANY_RAILS 4 /* 0: axes that are not parallel */
#endif
#ifndef SMAP_MANY_AXLES
#define SMAP_MANY_AXLES (!SMAP_MANY_RAILS) /* whether there are discs, whose axes are not parallel */
#endif
#ifndef SMAP_MANY_KNOWN
#define SMAP_MANY_KNOWN 0 /* 1: there are just as many contacts and rails */
#endif
#ifndef SMAP_MANY_FACETS
#define SMAP_MANY_FACETS 40
#endif
#ifndef SMAP_MANY_EDGES
#define SMAP_MANY_EDGES (3 * SMAP_MANY_FACETS)
#endif
#ifndef SMAP_MANY_RESTS
#define SMAP_MANY_RESTS 24
#endif
#ifndef SMAP_MANY_CORNERS
#define SMAP_MANY_CORNERS 100
#endif
#ifndef SMAP_MANY_GAPS
#define SMAP_MANY_GAPS 24 /* 0: the robot was not seen to rock from rest to rest, and no gap is looked for */
#endif
#ifndef SMAP_MANY_ARCS
#define SMAP_MANY_ARCS 150
#endif
#define SMAP_NONE 255u
#define SMAP_FOUND 254u
#define SMAP_WALLS (SMAP_MANY_CORNERS + 2 * SMAP_MANY_GAPS) /* behind those of rests come the sides of gaps */

/* The most that a pose may have of each: facets and edges of the complex, rests, their corners, gaps, and arcs
 * of the boundary.  Gaps that find no more room are given up, which makes the region smaller; without room for
 * anything else the pose fails. */
typedef struct {
  uint8_t facets, edges, rests, corners, gaps, arcs;
} smap_room_t;

typedef struct {
  uint8_t contacts, rails;
  uint8_t first[SMAP_MANY_RAILS + 1];
  uint8_t named[SMAP_MANY_CONTACTS]; /* the recipe's number of each contact */
  float axis[2];
  float size, steepest, least_height, rest_width, tolerance, rock_chord, guard;
#if SMAP_SERIES || defined(SMAP_CONTROL)
  float off, turned; /* parts of the size, of how far the com sinks also for each rad: what series alter */
#endif
#if !SMAP_MANY_KNOWN
  smap_room_t room;
#endif
} smap_many_t;

/* How many there are; an export has just as many as it has room for. */
static inline uint8_t smap_contacts_of(const smap_many_t *map)
{
  return SMAP_MANY_KNOWN ? SMAP_MANY_CONTACTS : map->contacts;
}

SMAP_INLINE uint8_t smap_rails_of(const smap_many_t *map)
{
  return SMAP_MANY_KNOWN ? SMAP_MANY_RAILS : map->rails;
}

/* An export has just the room that its arrays have; others have room for many, and a map tells its own. */
#if SMAP_MANY_KNOWN
#define SMAP_MOST(map, one, known) (known)
#else
#define SMAP_MOST(map, one, known) ((map)->room.one)
#endif

#if SMAP_SERIES || defined(SMAP_CONTROL)
#define SMAP_OFF(map) ((map)->off)
#define SMAP_OFF_TURNED(map) ((map)->turned)
#else
#define SMAP_OFF(map) 0.0f
#define SMAP_OFF_TURNED(map) 0.0f
#endif

/* The edges of two rests between which a gap is, by their walls. */
typedef struct {
  uint8_t a, b;
} smap_gap_t;

/* What both forms of a pose begin with: which wall is where. */
typedef struct {
  uint8_t rests, gaps, arcs, alive;
  uint8_t edge[SMAP_MANY_RESTS + 1]; /* the first wall of each */
  uint8_t alone[SMAP_MANY_RESTS];    /* whether no gap begins at it: its edges are the boundary next to it */
  uint8_t over[SMAP_WALLS][2];       /* contacts at the ends of a wall's edge */
  uint8_t arc[SMAP_MANY_ARCS];       /* on which wall it lies */
  smap_gap_t gap[SMAP_MANY_GAPS > 0 ? SMAP_MANY_GAPS : 1];
} smap_layout_t;

/* A pose.  `amid` is the middle of an arc times the sine of half of it; `along` is the direction of the arc
 * there times the cosine. */
typedef struct {
  smap_layout_t at;
  float guard;
  float plane[SMAP_MANY_RESTS][3]; /* n / h */
  float centre[SMAP_MANY_RESTS][3];
  float height[SMAP_MANY_RESTS];
  float wall[SMAP_WALLS][3];
  float amid[SMAP_MANY_ARCS][3], along[SMAP_MANY_ARCS][3];
} smap_many_pose_t;

/* A contact on a facet's plane: its place along and across. */
typedef struct {
  float a, b;
#if !SMAP_MANY_RAILS
  uint8_t contact;
#endif
} smap_spot_t;

/* A plane's direction: its outward unit normal, and in the rails' frame sine and cosine of pitch. */
typedef struct {
  float n[3], s, c;
} smap_aim_t;

typedef struct {
  smap_aim_t at;
  float h, centre[3];
  uint8_t rest; /* its number in the pose; SMAP_FOUND: it has none yet, SMAP_NONE: it is no rest */
  uint8_t first;
} smap_facet_t;

/* What is only needed while a pose is made. */
typedef struct {
  const smap_many_t *map;
  uint8_t facets, edges;
  uint8_t full; /* whether there was no room for what cannot be given up: the pose has failed */
  float p[SMAP_MANY_CONTACTS][3], r[SMAP_MANY_CONTACTS];
#if SMAP_MANY_RAILS
  uint8_t rail[SMAP_MANY_CONTACTS];
#endif
#if SMAP_MANY_AXLES
  float (*axle)[3]; /* of discs; zero for points and spheres */
#endif
  smap_facet_t facet[SMAP_MANY_FACETS];
  uint8_t vertex[SMAP_MANY_EDGES], twin[SMAP_MANY_EDGES], next[SMAP_MANY_EDGES];
  uint8_t onward[SMAP_MANY_EDGES]; /* the next edge of the outline of what short arcs join */
  uint8_t owner[SMAP_MANY_EDGES], wall_of[SMAP_MANY_EDGES];
  float low[SMAP_MANY_EDGES]; /* SMAP_SHORT, SMAP_OPEN, or from which part of the edge on it holds */
  float corner[SMAP_MANY_EDGES][3]; /* where the contact touches at which it begins */
} smap_many_work_t;

#define SMAP_SHORT (-1.0f)
#define SMAP_OPEN 2.0f

static inline void smap_minus(const float a[3], const float b[3], float out[3])
{
  out[0] = a[0] - b[0];
  out[1] = a[1] - b[1];
  out[2] = a[2] - b[2];
}

static inline void smap_mix(const float p[3], const float q[3], float part, float out[3])
{
  out[0] = p[0] + part * (q[0] - p[0]);
  out[1] = p[1] + part * (q[1] - p[1]);
  out[2] = p[2] + part * (q[2] - p[2]);
}

static inline void smap_copy(const float from[3], float to[3])
{
  to[0] = from[0];
  to[1] = from[1];
  to[2] = from[2];
}

static const float *smap_corner(const smap_many_work_t *w, uint8_t e)
{
  return w->corner[e];
}

static const float *smap_end(const smap_many_work_t *w, uint8_t e)
{
  return w->corner[w->next[e]];
}

/* Whether a part of an edge holds. */
static inline int smap_is_gap(const smap_many_work_t *w, uint8_t e)
{
  return SMAP_MANY_GAPS && w->low[e] >= 0.0f && w->low[e] <= 1.0f;
}

/* Begin a facet of some corners; returns its first edge, or SMAP_NONE where there is no room. */
static uint8_t smap_enter(smap_many_work_t *w, const smap_aim_t *at, float h, uint8_t corners)
{
  const uint8_t facet = w->facets, first = w->edges;
  smap_facet_t *f;
  uint8_t e, last;
  if (facet >= SMAP_MOST(w->map, facets, SMAP_MANY_FACETS) ||
      first + corners > SMAP_MOST(w->map, edges, SMAP_MANY_EDGES)) {
    w->full = 1;
    return SMAP_NONE;
  }
  last = (uint8_t)(first + corners);
  f = &w->facet[facet];
  f->at = *at;
  f->h = h;
  f->first = first;
  for (e = first; e < last; e++) {
    w->twin[e] = e;
    w->owner[e] = facet;
    w->next[e] = (uint8_t)(e + 1 < last ? e + 1 : first);
  }
  w->edges = last;
  w->facets = (uint8_t)(facet + 1u);
  return first;
}
