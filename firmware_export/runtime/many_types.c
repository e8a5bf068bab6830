/* Robots with more than three contacts, or with round ones: what the parts many_*.c share.
 *
 * SPDX-License-Identifier: MIT
 *
 * A posture becomes a complex of support facets (triangles of contacts) joined by arcs, over which
 * the robot rolls on two contacts.  Edge e of the complex is side e % 3 of facet e / 3 and begins
 * at its contact; its twin is the same arc seen from the facet beyond.  Counter-clockwise, seen
 * from outside.  The rails' frame: the common axis is y, and a facet's plane is
 * s x + t y - c z = h with sine s and cosine c of its pitch and its slope t.
 */
#ifndef SMAP_MANY_CONTACTS
#define SMAP_MANY_CONTACTS 12
#endif
#ifndef SMAP_MANY_RAILS
#define SMAP_MANY_RAILS 4
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
#ifndef SMAP_MANY_POINTS
#define SMAP_MANY_POINTS SMAP_MANY_LINKS
#endif
#define SMAP_MANY_EDGES (3 * SMAP_MANY_FACETS)
#define SMAP_MANY_SIDES (4 * SMAP_MANY_SHOWN)
#define SMAP_NONE 255u

enum { SMAP_STAGE = 1, SMAP_REST = 2 };

typedef struct {
  float p[3];
  float radius;
} smap_contact_t;

typedef struct {
  smap_contact_t contact[SMAP_MANY_CONTACTS];
} smap_many_place_t;

typedef struct {
  uint8_t contacts, rails;
  uint8_t first[SMAP_MANY_RAILS + 1];
  float axis[2];
  float size, steepest, least_height, rest_width, tolerance, rock_angle, band, guard;
} smap_many_t;

/* A side of a strip: `count` walls from `wall` on.  Of a side that bulges inwards one wall is
 * enough, of any other all count. */
typedef struct {
  uint8_t wall, count, inwards, inner;
} smap_side_t;

/* A part of the boundary. */
typedef struct {
  uint8_t wall, start, stop, island;
} smap_segment_t;

typedef struct {
  uint8_t shown, walls, points, segments, sides, alive;
  uint8_t kind[SMAP_MANY_SHOWN], island[SMAP_MANY_SHOWN], edge[SMAP_MANY_SHOWN + 1];
  uint8_t edge_wall[SMAP_MANY_EDGES], edge_side[SMAP_MANY_EDGES];
  smap_segment_t segment[SMAP_MANY_LINKS];
  uint8_t over[SMAP_MANY_WALLS][2];
  smap_side_t side[SMAP_MANY_SIDES];
  float guard, slack;
  float plane[SMAP_MANY_SHOWN][3]; /* n / h */
  float centre[SMAP_MANY_SHOWN][3];
  float height[SMAP_MANY_SHOWN];
  float wall[SMAP_MANY_WALLS][3];
  float point[SMAP_MANY_POINTS][3];
} smap_many_pose_t;

/* Facets of a posture while its pose is made. */
typedef struct {
  float s, c, t, h, norm; /* norm = |(s, t, -c)| */
  uint8_t kind, group;
} smap_facet_t;

typedef struct {
  const smap_many_t *map;
  uint8_t facets, failed;
  float x[SMAP_MANY_CONTACTS], z[SMAP_MANY_CONTACTS], r[SMAP_MANY_CONTACTS];
  uint8_t rail[SMAP_MANY_CONTACTS];
  float y[SMAP_MANY_RAILS];
  smap_facet_t facet[SMAP_MANY_FACETS];
  uint8_t vertex[SMAP_MANY_EDGES], twin[SMAP_MANY_EDGES];
  uint8_t wall_of[SMAP_MANY_EDGES], side_of[SMAP_MANY_EDGES];
  uint8_t seen[SMAP_MANY_EDGES];
  float low[SMAP_MANY_EDGES]; /* SMAP_SHORT, SMAP_OPEN, or from which part of the edge on it holds */
  float centre[SMAP_MANY_FACETS][2]; /* along and across */
  uint8_t last; /* point of the boundary */
} smap_many_work_t;

#define SMAP_SHORT (-1.0f)
#define SMAP_OPEN 2.0f

#ifndef SMAP_VERSION
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

static inline uint8_t smap_next(uint8_t e)
{
  return (uint8_t)(e % 3u == 2u ? e - 2u : e + 1u);
}

/* The next edge of the outline of what short arcs join. */
static uint8_t smap_onward(const smap_many_work_t *w, uint8_t e)
{
  uint8_t n;
  uint8_t left = SMAP_MANY_EDGES;
  for (n = smap_next(e); w->low[n] == SMAP_SHORT && left > 0; left--) {
    n = smap_next(w->twin[n]);
  }
  return n;
}

/* Where the contact at which an edge begins touches the plane of its facet. */
static void smap_corner(const smap_many_work_t *w, uint8_t e, float out[3])
{
  const smap_facet_t *f = &w->facet[e / 3u];
  const uint8_t i = w->vertex[e];
  out[0] = w->x[i] + w->r[i] * f->s;
  out[1] = w->y[w->rail[i]];
  out[2] = w->z[i] - w->r[i] * f->c;
}

/* The far end of an edge: where the next contact touches. */
static void smap_end(const smap_many_work_t *w, uint8_t e, float out[3])
{
  smap_corner(w, smap_next(e), out);
}

static void smap_mix(const float p[3], const float q[3], float part, float out[3])
{
  uint8_t k;
  for (k = 0; k < 3; k++) {
    out[k] = p[k] + part * (q[k] - p[k]);
  }
}
