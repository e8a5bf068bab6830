/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- region: where a robot of many contacts stands -------------------------------------------------- */
/* A posture stands on rests: facets of the hull of its contacts that are wide enough.  Over an edge that two
 * rests share the robot may rock: that is a gap.  A pose keeps both as convex cones with walls through the centre
 * of mass, and the boundary of them all as arcs of great circles.
 *
 * A corner of a rest has a number, and so have the edge from it to the next one, counter-clockwise seen from
 * the centre of mass, and the wall through that edge.  Behind the walls of all corners come the two sides of each gap,
 * and behind the corners the four places at which the held parts of edges begin and end. */
#define SMAP_NONE 255u
enum { SMAP_SINGLES = 44 }; /* bytes of a map's numbers of length and angle: see smap_pose.h */
#define SMAP_WALLS (SMAP_MAX_CORNERS + 2 * SMAP_MAX_GAPS)
/* Each has four places, with numbers of 8 bits. */
#define SMAP_HELD_EDGES (SMAP_MAX_GAPS < 25 ? SMAP_MAX_GAPS : 25)
#define SMAP_PLACES (SMAP_MAX_CORNERS + 4 * SMAP_HELD_EDGES)
#define SMAP_JOINED 2e-4f /* rad: rests that a shorter turn joins are one */
#define SMAP_OVERLAP 2u   /* where rests may, as those on which axles swing */
/* Bits of 2^-114 and 2^113: the squares of the least and the greatest length that has a direction. */
#define SMAP_SQUARE_LEAST 0x06800000u
#define SMAP_SQUARE_MOST 0x78000000u

/* The robot's numbers beside positions.  Lengths, but sines: steepest, guard; and parts of the size: off, by
 * which a roll ends elsewhere, also for each rad that it turns. */
typedef struct {
  smap_bytes_t first, named, room; /* of each track its first contact; of each contact the recipe's number; see below */
  uint8_t placed, contacts, tracks; /* placed: contacts, and the points of axles that swing */
  float axis[2], size, steepest, least_height, rest_width, tolerance, rock_chord, guard, off, turned;
} smap_limits_t;

/* The most that a pose may have of each.  What finds no more room is given up, which makes the region smaller; without
 * room for an arc the pose fails. */
enum { SMAP_OF_RESTS, SMAP_OF_CORNERS, SMAP_OF_GAPS, SMAP_OF_ARCS, SMAP_OF_FACETS, SMAP_ROOMS };

typedef struct {
  uint8_t a, b, side, place; /* walls of its edges; the first of two sides, and of its places */
} smap_gap_t;

typedef struct {
  uint8_t wall, from, to, over[2]; /* its wall and its places; the recipe's numbers of the contacts at its ends */
} smap_arc_t;

/* The head of both forms of a pose.  Arcs are in the order of islands: `from` and `till` are those of the island
 * that a rest belongs to, and `own` is the first of its own if all of its edges are boundary, else SMAP_NONE. */
typedef struct {
  uint8_t rests, gaps, arcs, places, nearly; /* nearly: there are rests whose planes are all but one, or SMAP_OVERLAP */
  uint8_t first[SMAP_MAX_RESTS + 1];     /* corner of each rest */
  uint8_t own[SMAP_MAX_RESTS], from[SMAP_MAX_RESTS], till[SMAP_MAX_RESTS];
  smap_gap_t gap[SMAP_MAX_GAPS];
  smap_arc_t arc[SMAP_MAX_ARCS];
} smap_layout_t;

/* The form for floats.  `plane` is n / h; walls and places are of length 1, but places only at the end. */
typedef struct {
  float guard; /* the sine that is taken off every distance */
  float plane[SMAP_MAX_RESTS][3], centre[SMAP_MAX_RESTS][3], height[SMAP_MAX_RESTS];
  float wall[SMAP_WALLS][3];
  float place[SMAP_PLACES][3];
} smap_region_t;

/* Memory that is only needed while a pose is made. */
typedef struct {
  const smap_limits_t *map;
  smap_layout_t *at;
  smap_region_t *region;
  /* Contacts, and behind them the axles of discs. */
  float p[SMAP_MAX_CONTACTS + (SMAP_DISCS > 0 ? SMAP_DISCS : 1)][3];
  float r[SMAP_MAX_CONTACTS];
  uint8_t axle_of[SMAP_DISCS > 0 ? SMAP_MAX_CONTACTS : 1], axles; /* SMAP_NO_AXIS for points and balls */
  float normal[SMAP_MAX_RESTS][3];
  uint8_t next[SMAP_MAX_CORNERS]; /* the corner behind on its rest */
  uint8_t upto[SMAP_MAX_CORNERS], onward[SMAP_MAX_CORNERS]; /* an edge is boundary up to one place, and from one on */
  uint8_t joined[SMAP_MAX_CORNERS]; /* whether the rests on both sides of an edge are one */
  uint8_t contact[SMAP_MAX_CORNERS], twin[SMAP_MAX_CORNERS], rest[SMAP_MAX_CORNERS], island[SMAP_MAX_RESTS];
  uint8_t facets; /* that were looked at */
  uint8_t full;   /* whether there was no room for an arc: the pose has failed */
} smap_work_t;

/* How many there are: of its own map a compiler knows it. */
#define SMAP_CONTACTS(w) SMAP_GIVEN((w)->map->contacts, SMAP_MAX_CONTACTS - 2 * SMAP_PIVOTS)
#define SMAP_AXLES(w) (&(w)->p[SMAP_GIVEN((w)->map->placed, SMAP_MAX_CONTACTS)])
#define SMAP_TRACKS_OF(w) SMAP_GIVEN((w)->map->tracks, SMAP_TRACKS)
#define SMAP_FIRST(w) SMAP_GIVEN((w)->map->first, smap_body(0) + SMAP_IN_MANY + SMAP_SINGLES + 1)
#define SMAP_NAMED(w) \
  SMAP_GIVEN((w)->map->named, SMAP_FIRST(w) + 1 + (SMAP_TRACKS > 1 ? SMAP_TRACKS : 0))
#define SMAP_IS_TURNED(m) /* whether the axis of all discs is not y */ \
  (SMAP_TRACKS > 1 && SMAP_GIVEN((m)->axis[1], smap_f32(smap_body(0) + SMAP_IN_MANY + 4)) != 1.0f)
#define SMAP_SIZE(w) SMAP_GIVEN((w)->map->size, smap_f32(smap_body(0) + SMAP_IN_MANY + 8))

/* A family tells where a contact touches the plane with a normal. */
static void smap_touch(const smap_work_t *w, uint8_t i, const float n[3], float out[3]);

/* Tells whether there are as many of something as a pose has room for. */
#define SMAP_IS_FULL(w, what, count, most) ((count) >= SMAP_ROOM((w)->map->room[what], most))

SMAP_INLINE void smap_mix(const float p[3], const float q[3], float part, float out[3])
{
  out[0] = p[0] + part * (q[0] - p[0]);
  out[1] = p[1] + part * (q[1] - p[1]);
  out[2] = p[2] + part * (q[2] - p[2]);
}

/* Turn vectors about z. */
static void smap_turn(float (*v)[3], uint8_t n, float sine, float cosine)
{
  uint8_t k;
  for (k = 0; k < n; k++) {
    const float x = v[k][0], y = v[k][1];
    v[k][0] = x * cosine - y * sine;
    v[k][1] = x * sine + y * cosine;
  }
}

/* Scale a vector to length 1; 0 where it has no direction, or is no number. */
static int smap_unit(float v[3])
{
  const float size2 = smap_dot(v, v);
  float scale;
  if (smap_bits(size2) - SMAP_SQUARE_LEAST > SMAP_SQUARE_MOST - SMAP_SQUARE_LEAST) {
    return 0;
  }
  scale = 1.0f / smap_root(size2);
  v[0] *= scale;
  v[1] *= scale;
  v[2] *= scale;
  return 1;
}

#include "smap_polygon.h"

/* Add the facet with normal n and these corners, if it is a rest: returns its first corner, else
 * SMAP_NONE.  `near`: how many contacts are on its plane, within the map's tolerance; SMAP_NONE: one
 * is below it. */
static uint8_t smap_add_rest(smap_work_t *w, const float n[3], float (*p)[3], const uint8_t *id,
                             uint8_t count, uint8_t near)
{
  const uint8_t r = w->at->rests, first = w->at->first[r];
  const float height = smap_dot(p[0], n);
  smap_region_t *const o = w->region;
  float q[SMAP_MAX_CONTACTS][3];
  uint8_t all[SMAP_MAX_CONTACTS], sides = count, i, k;
  if (!(height > w->map->least_height && -n[2] > w->map->steepest) ||
      count < 3 || near == SMAP_NONE ||
      SMAP_IS_FULL(w, SMAP_OF_RESTS, r, SMAP_MAX_RESTS) ||
      SMAP_IS_FULL(w, SMAP_OF_CORNERS, first + count - 1, SMAP_MAX_CORNERS)) {
    return SMAP_NONE;
  }
  if (near > count) { /* all of them make up the support polygon */
    sides = 0;
    for (i = 0; i < SMAP_CONTACTS(w); i++) {
      smap_touch(w, i, n, q[sides]);
      if (smap_dot(q[sides], n) >= height - w->map->tolerance) {
        all[sides++] = i;
      }
    }
    sides = smap_outline(n, q, all, sides);
  }
  if (sides < 3 || !smap_measure(w, n, near > count ? q : p, sides, o->centre[r])) {
    return SMAP_NONE;
  }
  for (i = 0; i < count; i++) {
    const uint8_t e = (uint8_t)(first + i);
    const uint8_t next = i + 1 < count ? (uint8_t)(i + 1) : (uint8_t)0;
    memcpy(o->place[e], p[i], sizeof p[i]);
    smap_cross(p[next], p[i], o->wall[e]); /* of length 1 only at the end */
    w->contact[e] = id[i];
    w->rest[e] = r;
    w->twin[e] = SMAP_NONE;
    w->joined[e] = 0;
    w->upto[e] = w->next[e] = (uint8_t)(first + next);
    w->onward[e] = SMAP_NONE;
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    w->normal[r][k] = n[k];
    o->plane[r][k] = n[k] / height;
  }
  o->height[r] = height;
  w->island[r] = r;
  w->at->rests = (uint8_t)(r + 1u);
  w->at->first[r + 1] = (uint8_t)(first + count);
  return first;
}

/* Edges a and b of two rests are the same arc, over which the robot rolls from one to the other, if they have the same
 * contacts. */
static void smap_pair(smap_work_t *w, uint8_t a, uint8_t b)
{
  if (w->contact[a] == w->contact[w->next[b]] && w->contact[b] == w->contact[w->next[a]]) {
    const float turned2 = smap_apart2(w->normal[w->rest[a]], w->normal[w->rest[b]]);
    w->joined[a] = w->joined[b] = turned2 <= SMAP_JOINED * SMAP_JOINED;
    w->twin[a] = b;
    w->twin[b] = a;
  }
}

/* Add the part of the boundary on a wall from one place to another, which is counter-clockwise seen from the com. */
static void smap_add_arc(smap_work_t *w, uint8_t wall, uint8_t from, uint8_t to, uint8_t i, uint8_t j)
{
  smap_layout_t *const at = w->at;
  const smap_bytes_t named = SMAP_NAMED(w);
  smap_arc_t *const arc = &at->arc[at->arcs];
  if (SMAP_IS_FULL(w, SMAP_OF_ARCS, at->arcs, SMAP_MAX_ARCS)) {
    w->full = 1;
    return;
  }
  /*@ admit wall < SMAP_WALLS && from < SMAP_PLACES && to < SMAP_PLACES; */
  at->arcs++;
  arc->wall = wall;
  arc->from = from;
  arc->to = to;
  arc->over[0] = named[i];
  arc->over[1] = named[j];
}
