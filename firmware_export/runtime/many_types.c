/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- many contacts: what their parts share ----------------------------------------------------------- */
/* Robots with more than three contacts, or with round ones: what the parts many_*.c share.
 *
 * A posture becomes a complex of support facets joined by arcs, over which the robot rolls on two
 * contacts.  An edge of the complex belongs to a facet and begins at one of its contacts; its twin
 * is the same arc seen from the facet beyond, or it itself where nothing is.  Counter-clockwise, seen from
 * outside.
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
#ifndef SMAP_MANY_SHOWN
#define SMAP_MANY_SHOWN 24
#endif
#ifndef SMAP_MANY_WALLS
#define SMAP_MANY_WALLS 200
#endif
#ifndef SMAP_MANY_LINKS
#define SMAP_MANY_LINKS 200
#endif
#ifndef SMAP_MANY_EDGES
#define SMAP_MANY_EDGES (3 * SMAP_MANY_FACETS)
#endif
#ifndef SMAP_MANY_SIDES
#define SMAP_MANY_SIDES (4 * SMAP_MANY_SHOWN)
#endif
#ifndef SMAP_MANY_WORK /* the most work that a pose may take: see SMAP_COST_... */
#define SMAP_MANY_WORK 0x7FFFFFFFu
#endif
#ifndef SMAP_MANY_SOUGHT /* and of it that on gaps */
#define SMAP_MANY_SOUGHT 0xFFFFu
#endif
#ifndef SMAP_MANY_GAPS
#define SMAP_MANY_GAPS 1 /* 0: the robot was not seen to rock from rest to rest, and no gap is looked for */
#endif
#define SMAP_MANY_ROLLS (SMAP_MANY_LINKS / 5) /* that are kept */
#define SMAP_NONE 255u
#define SMAP_WALLED (SMAP_MANY_EDGES < SMAP_MANY_WALLS ? SMAP_MANY_EDGES : SMAP_MANY_WALLS) /* edges with a wall */

enum { SMAP_REFUSED = 0, SMAP_STAGE = 1, SMAP_REST = 2 };

/* The most that a pose may have of each, of the work on it and of that on gaps.  What a pose needs beyond
 * that it has not: gaps that find no more room, or are not found in time, are given up, which makes the
 * region smaller; without room or time for anything else the pose fails. */
typedef struct {
  uint8_t facets, edges, shown, walls, links, sides;
  uint16_t sought;
  uint32_t work;
} smap_room_t;

typedef struct {
  uint8_t contacts, rails;
  uint8_t first[SMAP_MANY_RAILS + 1];
  uint8_t named[SMAP_MANY_CONTACTS]; /* the recipe's number of each contact */
  float axis[2];
  float size, steepest, least_height, rest_width, tolerance, rock_angle, band, guard;
#if SMAP_SERIES || defined(SMAP_CONTROL)
  float off, turned; /* parts of the size, of R also for each rad: what series alter, see many_held.c */
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

static inline uint8_t smap_rails_of(const smap_many_t *map)
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

/* A side of a strip: its walls from `wall` to before `end`, and from `point` on one more point.  Of a side that
 * bulges inwards one wall is enough, of any other all count. */
typedef struct {
  uint8_t wall, end, point, inwards, inner;
} smap_side_t;

/* An edge of a shown facet, whose wall has its number: of its strip the wall at the far end, the first
 * of the two sides, and the facet there, or SMAP_NONE. */
typedef struct {
  uint8_t back, side, to;
} smap_rim_t;

/* A part of the boundary.  Where it is bent inwards at its end, the end may be what is nearest. */
typedef struct {
  uint8_t wall, start, stop, bent;
} smap_segment_t;

/* What both forms of a pose begin with: which wall is where. */
typedef struct {
  uint8_t shown, walls, points, segments, sides, alive;
  uint8_t kind[SMAP_MANY_SHOWN], island[SMAP_MANY_SHOWN], edge[SMAP_MANY_SHOWN + 1];
  uint8_t begin[SMAP_MANY_EDGES]; /* a segment on an edge, or of the side of its strip */
  uint8_t first[SMAP_MANY_SHOWN], last[SMAP_MANY_SHOWN]; /* of an island's segments, and beyond */
  uint8_t convex[SMAP_MANY_SHOWN]; /* whether the facet's island is: no end of a segment is bent */
  uint8_t alone[SMAP_MANY_SHOWN];  /* whether it has no strip: its edges are its island's boundary */
  smap_rim_t rim[SMAP_MANY_EDGES];
  uint8_t over[SMAP_MANY_WALLS][2];
  smap_segment_t segment[SMAP_MANY_LINKS];
  smap_side_t side[SMAP_MANY_SIDES];
} smap_layout_t;

static inline int smap_is_alone(const smap_layout_t *at, uint8_t facet)
{
  return !SMAP_MANY_GAPS || at->alone[facet];
}

static inline int smap_is_convex(const smap_layout_t *at, uint8_t facet)
{
  return !SMAP_MANY_GAPS || at->convex[facet];
}

/* Where a search of an island's boundary begins that an edge may be nearest of. */
static inline uint8_t smap_begin_at(const smap_layout_t *at, uint8_t island, uint8_t edge)
{
  const uint8_t begin = at->begin[edge];
  return begin >= at->first[island] && begin < at->last[island] ? begin : at->first[island];
}

/* A gap while it is looked at: gravity at both ends of its segment where the roll has come to, and
 * how much higher the com is there. */
typedef struct {
  float g[2][3], rise[2];
  float low, high;   /* of the segment, that are left */
  float before, after; /* of the segment, that holds without rolling on and adjoins it */
  float turned;      /* rad, so far */
  float spare;       /* length of the parts that another one may be of: given up, or not looked into */
  uint8_t home;      /* the facet on which the other way ends: the one that it balances from */
  uint8_t line;      /* the edge over which it came, see SMAP_ONE_LINE */
} smap_held_t;

/* A rest that the robot has come to, over its edge `came`: the edge that is looked at, and which part of the
 * segment before comes here.  On the first rest edges that lead to no other are looked at first: often nothing is
 * left to go on with. */
typedef struct {
  smap_held_t held;
  float span[2];
  uint8_t came, at, turn;
} smap_visit_t;

/* Two unit vectors across a normal. */
typedef struct {
  float t[3], b[3];
} smap_across_t;

/* A vector, as a row of the map of a roll. */
typedef float smap_row_t[3];

#define SMAP_WAYS (SMAP_MANY_RAILS > 2 ? 4 : 3) /* rests that it comes to in a row, as far as is looked into */

/* What gaps are looked for with: the rests come to, and of two steps of a roll the normal at the start, a frame on
 * it, and where a contact touches at the start, between both, and at the end. */
typedef struct {
  smap_visit_t visit[SMAP_WAYS];
  smap_row_t normal;
  smap_across_t turned;
  smap_row_t place[3];
} smap_bench_t;

/* A contact on a facet's plane: its place along and across. */
typedef struct {
  float a, b;
#if !SMAP_MANY_RAILS
  uint8_t contact;
#endif
} smap_spot_t;

#define SMAP_BENCH ((SMAP_WAYS + 1) * 6) /* vectors that take no less room than smap_bench_t */
#define SMAP_ROWS (SMAP_MANY_GAPS * SMAP_BENCH) /* none where no gap is looked for */

typedef char smap_holds_a_roll[SMAP_MANY_ROLLS > 0 ? 1 : -1];
typedef char smap_holds_a_spot[sizeof(smap_spot_t) <= sizeof(smap_row_t) ? 1 : -1];
typedef char smap_holds_the_bench[sizeof(smap_bench_t) <= SMAP_BENCH * sizeof(smap_row_t) ? 1 : -1];

/* Gaps are looked for before there are walls: the bench is where those will be, and rolls where there will be points,
 * before them spots of a facet. */
typedef struct {
  smap_layout_t at;
  float guard, hair, slack;
  float plane[SMAP_MANY_SHOWN][3]; /* n / h */
  float centre[SMAP_MANY_SHOWN][3];
  float height[SMAP_MANY_SHOWN];
  float wall[SMAP_MANY_WALLS > SMAP_ROWS ? SMAP_MANY_WALLS : SMAP_ROWS][3];
  float point[SMAP_MANY_LINKS > SMAP_MANY_CONTACTS ? SMAP_MANY_LINKS : SMAP_MANY_CONTACTS][3];
} smap_many_pose_t;

/* A plane's direction: its outward unit normal, and in the rails' frame sine and cosine of pitch. */
typedef struct {
  float n[3], s, c;
} smap_aim_t;

/* What a roll over an arc does, from the lesser of its two edges on.  Its rows: three that turn gravity
 * before to gravity after; rise of the com = rise . gravity before; its angle (rad). */
enum { SMAP_RISE = 3, SMAP_ANGLE = 4, SMAP_ROLL = 5 };

typedef struct {
  smap_aim_t at;
  float h, centre[3];
  uint8_t kind, shown, first;
} smap_facet_t;

/* What a part of the work costs, in 32 instructions that it may take on a Cortex-M4F; what depends on how
 * planes are found is with these.  What many postures took, with a margin, is all that a pose may take, so
 * that none can take long. */
#define SMAP_EACH (unsigned)smap_contacts_of(w->map)
#define SMAP_COST_CORNER 3u                       /* a corner of a facet's polygon, and */
#define SMAP_COST_SIDE (3u + 3u * SMAP_EACH / 4u) /* one of its sides, if it is wide */
#define SMAP_COST_GAP 69u                         /* an arc between rests, but for */
#define SMAP_COST_WAY 19u                         /* going on from a rest that the robot comes to */
#define SMAP_COST_SHOW 8u                         /* a facet that is shown, but for */
#define SMAP_COST_OUTLINE 6u                      /* one of its edges */
#define SMAP_COST_LOOP 7u                         /* a loop of the boundary, but for its edges */

/* What is only needed while a pose is made. */
typedef struct {
  const smap_many_t *map;
  uint32_t left; /* of the work; 0 where the pose has failed */
  uint8_t facets, edges;
  uint8_t full; /* whether there was no room for a wall, a point or a side */
  float posture; /* its size, once it is asked for: see smap_posture_size */
#ifdef SMAP_HOST
  uint32_t sought; /* what gaps took */
#endif
  float p[SMAP_MANY_CONTACTS][3], r[SMAP_MANY_CONTACTS];
#if SMAP_MANY_RAILS
  uint8_t rail[SMAP_MANY_CONTACTS];
#endif
#if SMAP_MANY_RAILS > 2
  uint8_t mate[SMAP_MANY_CONTACTS]; /* the same wheel on the next rail towards the middle, or SMAP_NONE */
#endif
#if SMAP_MANY_AXLES
  float (*axle)[3]; /* of discs; zero for points and spheres */
#endif
  smap_facet_t facet[SMAP_MANY_FACETS];
  uint8_t vertex[SMAP_MANY_EDGES], twin[SMAP_MANY_EDGES], next[SMAP_MANY_EDGES];
  uint8_t onward[SMAP_MANY_EDGES]; /* the next edge of the outline of what short arcs join */
  uint8_t strips[SMAP_MANY_CONTACTS]; /* at a contact */
  uint8_t owner[SMAP_MANY_EDGES], wall_of[SMAP_MANY_EDGES], point_of[SMAP_MANY_EDGES];
  uint8_t side_of[SMAP_MANY_EDGES];
  uint8_t seen[SMAP_MANY_EDGES]; /* the island whose boundary it may be of, or SMAP_NONE */
  smap_row_t *roll;    /* where the pose's points will be; before there is any, spots */
  smap_bench_t *bench; /* where its walls will be */
  uint8_t roll_of[SMAP_MANY_EDGES], rolls; /* of an arc, if it is known, by its lesser edge */
  float low[SMAP_MANY_EDGES]; /* SMAP_SHORT, SMAP_OPEN, or from which part of the edge on it holds */
  float corner[SMAP_MANY_EDGES][3]; /* where the contact touches at which it begins */
} smap_many_work_t;

#define SMAP_SHORT (-1.0f)
#define SMAP_OPEN 2.0f

#ifndef SMAP_VERSION /* smap.h's parts have them */
#define SMAP_APART
#define SMAP_THRICE
static inline float smap_dot(const float a[3], const float b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void smap_cross(const float a[3], const float b[3], float out[3])
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}
#endif

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

/* Take some of the work that is left; if there is not as much the pose fails, and then there is none. */
static inline int smap_may(smap_many_work_t *w, uint32_t cost)
{
  if (w->left <= cost) {
    w->left = 0;
    return 0;
  }
  w->left -= cost;
  return 1;
}

/* Whether it is 0 to 1, by its bits: a negative number's are the largest. */
static int smap_is_gap(const smap_many_work_t *w, uint8_t e)
{
  uint32_t bits;
  memcpy(&bits, &w->low[e], sizeof bits);
  return SMAP_MANY_GAPS && bits <= 0x3F800000u;
}

/* Begin a facet of some corners; returns its first edge, or SMAP_NONE where there is no room. */
static uint8_t smap_enter(smap_many_work_t *w, const smap_aim_t *at, float h, uint8_t corners)
{
  const uint8_t facet = w->facets, first = w->edges;
  smap_facet_t *f;
  uint8_t e, last;
  if (facet >= SMAP_MOST(w->map, facets, SMAP_MANY_FACETS) ||
      first + corners > SMAP_MOST(w->map, edges, SMAP_MANY_EDGES)) {
    w->left = 0;
    return SMAP_NONE;
  }
  last = (uint8_t)(first + corners);
  f = &w->facet[facet];
  f->at = *at;
  f->h = h;
  f->first = first;
  f->shown = SMAP_NONE;
  for (e = first; e < last; e++) {
    w->twin[e] = e;
    w->owner[e] = facet;
    w->next[e] = (uint8_t)(e + 1 < last ? e + 1 : first);
  }
  w->edges = last;
  w->facets = (uint8_t)(facet + 1u);
  return first;
}
