/* Walls of the region, and the segments of its boundary.
 *
 *   A wall is a plane through the com, kept as its unit normal, which points into the region.  The
 *   boundary is a closed way along sides of rests and sides of strips:
 *
 *         rest A   |  strip  |   rest B
 *       -----------+         +-----------     where the robot is not caught beyond a part of an
 *                  |  low    |                edge there is a pocket between A and B.
 *                  +---------+
 *
 *   A segment lies on a wall, between two points, kept as unit vectors.
 */
#define SMAP_TANGENT 0.2f /* rad between the tangents that stand for a rim */
#define SMAP_LOST 2e-4f   /* of the size: what the exact definition's tangents lose */
#define SMAP_PIECES 12.0f
#define SMAP_ALIKE 3e-3f  /* rad: tangents nearer than this are one */

static uint8_t smap_add_wall(smap_many_work_t *w, smap_many_pose_t *o, const float n[3], uint8_t i,
                             uint8_t j)
{
  const float size2 = smap_dot(n, n);
  float scale;
  if (o->walls >= SMAP_MANY_WALLS || !(size2 > 0.0f)) {
    w->failed = 1;
    return 0;
  }
  scale = 1.0f / smap_root(size2);
  o->wall[o->walls][0] = n[0] * scale;
  o->wall[o->walls][1] = n[1] * scale;
  o->wall[o->walls][2] = n[2] * scale;
  o->over[o->walls][0] = i;
  o->over[o->walls][1] = j;
  return o->walls++;
}

/* What the two contacts of a strip sweep at a part of the segment between them: a disc's rim. */
typedef struct {
  float x, y, z, r, inner; /* inner: sign of y towards the middle of the strip */
  uint8_t i, edge, back;
} smap_rim_t;

/* The wall that touches a rim at a pitch. */
static uint8_t smap_tangent(smap_many_work_t *w, smap_many_pose_t *o, const smap_rim_t *rim, float s,
                            float c)
{
  const float level = rim->x * s - rim->z * c + rim->r;
  const float n[3] = {-rim->inner * rim->y * s, rim->inner * level, rim->inner * rim->y * c};
  return smap_add_wall(w, o, n, rim->i, rim->i);
}

static void smap_rim_point(const smap_rim_t *rim, float s, float c, float out[3])
{
  out[0] = rim->x + rim->r * s;
  out[1] = rim->y;
  out[2] = rim->z - rim->r * c;
}

/* The rim of an edge at the part where it begins to hold. */
static void smap_rim(const smap_many_work_t *w, uint8_t e, smap_rim_t *out)
{
  const uint8_t i = w->vertex[e], j = w->vertex[smap_next(e)];
  const float part = w->low[e], yi = w->y[w->rail[i]], yj = w->y[w->rail[j]];
  out->x = w->x[i] + part * (w->x[j] - w->x[i]);
  out->z = w->z[i] + part * (w->z[j] - w->z[i]);
  out->r = w->r[i] + part * (w->r[j] - w->r[i]);
  out->y = yi + part * (yj - yi);
  out->inner = yj > yi ? 1.0f : -1.0f;
  out->i = i;
  out->edge = e;
  out->back = w->twin[e];
}

/* How many pieces the exact definition cuts the strip of an edge into. */
static float smap_pieces(const smap_many_work_t *w, uint8_t e)
{
  const smap_facet_t *f = &w->facet[e / 3u], *g = &w->facet[w->twin[e] / 3u];
  const float ds = f->s - g->s, dc = f->c - g->c, lost = SMAP_LOST * w->map->size;
  const float ri = w->r[w->vertex[e]], rj = w->r[w->vertex[smap_next(e)]];
  const float most = (ri > rj ? ri : rj) * (ds * ds + dc * dc) * 0.125f;
  float n;
  if (most <= lost) {
    return 1.0f;
  }
  n = 1.0f + (float)(int32_t)smap_root(most / lost);
  return n < SMAP_PIECES ? n : SMAP_PIECES;
}

/* A wall across the way to the middle of an edge, where a strip has no width. */
static uint8_t smap_cap(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e, const float p[3])
{
  float q[3], n[3], part;
  uint8_t k;
  smap_end(w, e, q);
  part = smap_dot(q, p) / smap_dot(p, p);
  for (k = 0; k < 3; k++) {
    n[k] = q[k] - part * p[k];
  }
  return smap_add_wall(w, o, n, w->vertex[e], w->vertex[e]);
}

/* The tangents that stand for the rim of a strip's side; the pitch of each. */
typedef struct {
  smap_pitch_t from, to;
  float pieces;
  uint8_t i, j, count;
} smap_tangents_t;

static void smap_plan_tangents(const smap_many_work_t *w, uint8_t e, smap_tangents_t *o)
{
  const smap_facet_t *f = &w->facet[e / 3u], *g = &w->facet[w->twin[e] / 3u];
  const float ds = f->s - g->s, dc = f->c - g->c, turn = smap_root(ds * ds + dc * dc);
  o->i = w->vertex[e];
  o->j = w->vertex[smap_next(e)];
  smap_aim(&o->from, f->s, f->c, f->t);
  smap_aim(&o->to, g->s, g->c, g->t);
  o->count = 1;
  if (turn > SMAP_ALIKE) {
    float turns = (float)(int32_t)(turn * (1.0f / SMAP_TANGENT)) + 1.0f;
    o->pieces = smap_pieces(w, e);
    turns = turns > o->pieces ? o->pieces : turns;
    o->count = (uint8_t)(turns + 1.0f);
  }
}

static void smap_tangent_pitch(const smap_many_work_t *w, const smap_tangents_t *o, uint8_t k,
                               smap_pitch_t *out)
{
  if (k == 0) {
    *out = o->from;
  } else if (k + 1 == o->count) {
    *out = o->to;
  } else {
    const float turns = (float)(o->count - 1);
    const float part = (float)(int32_t)((float)k * o->pieces / turns + 0.5f) / o->pieces;
    smap_on_arc(w, o->i, o->j, &o->from, &o->to, part, out);
  }
}

/* Make the walls of the side of a strip at the beginning of an edge. */
static void smap_add_side(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const smap_facet_t *f = &w->facet[e / 3u], *g = &w->facet[w->twin[e] / 3u];
  smap_side_t *side = &o->side[o->sides];
  float p[3], q[3], n[3], apart = 0.0f, ds = f->s - g->s, dc = f->c - g->c;
  smap_rim_t rim;
  uint8_t k;
  if (o->sides >= SMAP_MANY_SIDES) {
    w->failed = 1;
    return;
  }
  w->side_of[e] = o->sides++;
  smap_rim(w, e, &rim);
  side->wall = o->walls;
  side->inner = 0;
  side->inwards = rim.y * rim.inner < 0.0f;
  smap_rim_point(&rim, f->s, f->c, p);
  smap_rim_point(&rim, g->s, g->c, q);
  for (k = 0; k < 3; k++) {
    apart += (p[k] - q[k]) * (p[k] - q[k]);
  }
  if (w->rail[w->vertex[e]] == w->rail[w->vertex[smap_next(e)]] ||
      apart < 1e-10f * w->map->size * w->map->size) {
    smap_cap(w, o, e, p);
  } else if (!side->inwards) {
    if (ds * ds + dc * dc > SMAP_ALIKE * SMAP_ALIKE) {
      smap_cross(p, q, n);
      if (n[1] * rim.inner < 0.0f) {
        n[0] = -n[0];
        n[1] = -n[1];
        n[2] = -n[2];
      }
      smap_add_wall(w, o, n, rim.i, rim.i);
    } else {
      smap_tangent(w, o, &rim, f->s, f->c);
    }
  } else {
    smap_tangents_t plan;
    smap_pitch_t at;
    smap_plan_tangents(w, e, &plan);
    for (k = 0; k < plan.count; k++) {
      smap_tangent_pitch(w, &plan, k, &at);
      smap_tangent(w, o, &rim, at.s, at.c);
    }
  }
  side->count = (uint8_t)(o->walls - side->wall);
}

static uint8_t smap_add_point(smap_many_work_t *w, smap_many_pose_t *o, const float p[3])
{
  const float scale = 1.0f / smap_root(smap_dot(p, p));
  uint8_t k;
  if (o->points >= SMAP_MANY_POINTS) {
    w->failed = 1;
    return 0;
  }
  for (k = 0; k < 3; k++) {
    o->point[o->points][k] = p[k] * scale;
  }
  return o->points++;
}

/* Append a part of the boundary, along a wall from where the last one ended to q.  At the beginning
 * of a loop that is p. */
static void smap_push(smap_many_work_t *w, smap_many_pose_t *o, uint8_t island, uint8_t wall,
                      const float p[3], const float q[3])
{
  smap_segment_t *segment = &o->segment[o->segments];
  if (w->failed || o->segments >= SMAP_MANY_LINKS) {
    w->failed = 1;
    return;
  }
  if (w->last == SMAP_NONE) {
    w->last = smap_add_point(w, o, p);
  }
  segment->wall = wall;
  segment->island = island;
  segment->start = w->last;
  segment->stop = w->last = smap_add_point(w, o, q);
  o->segments++;
}

/* Append the side of a strip from facet f to facet g, seen from edge e. */
static void smap_push_side(smap_many_work_t *w, smap_many_pose_t *o, uint8_t island, uint8_t e)
{
  const smap_facet_t *f = &w->facet[e / 3u], *g = &w->facet[w->twin[e] / 3u];
  const smap_side_t *side = &o->side[w->side_of[e]];
  float p[3], q[3];
  smap_pitch_t here, there;
  smap_tangents_t plan;
  smap_rim_t rim;
  uint8_t k;
  smap_rim(w, e, &rim);
  smap_rim_point(&rim, f->s, f->c, p);
  smap_plan_tangents(w, e, &plan);
  here = plan.from;
  for (k = 0; k < side->count; k++) {
    if (k + 1 == side->count) {
      smap_rim_point(&rim, g->s, g->c, q);
    } else {
      /* Where two tangents meet. */
      float scale;
      smap_tangent_pitch(w, &plan, (uint8_t)(k + 1u), &there);
      scale = 1.0f / (1.0f + here.s * there.s + here.c * there.c);
      smap_rim_point(&rim, scale * (here.s + there.s), scale * (here.c + there.c), q);
      here = there;
    }
    smap_push(w, o, island, (uint8_t)(side->wall + k), p, q);
    p[0] = q[0];
    p[1] = q[1];
    p[2] = q[2];
  }
}

static int smap_is_gap(const smap_many_work_t *w, uint8_t e)
{
  return w->low[e] >= 0.0f && w->low[e] <= 1.0f;
}

/* Follow the boundary from an edge on until it closes; `emit` 0 only tells whether it is one. */
static int smap_loop(smap_many_work_t *w, smap_many_pose_t *o, uint8_t start, int emit)
{
  uint8_t e = start, left = SMAP_MANY_EDGES;
  int real = 0;
  float p[3], q[3], middle[3];
  do {
    const uint8_t island = o->island[w->facet[e / 3u].group];
    if (!emit) {
      w->seen[e] = 1;
    }
    smap_corner(w, e, p);
    smap_end(w, e, q);
    if (!smap_is_gap(w, e)) {
      real = 1;
      if (emit && w->wall_of[e] != SMAP_NONE) {
        smap_push(w, o, island, w->wall_of[e], p, q);
      }
      e = smap_onward(w, e);
    } else {
      const uint8_t back = w->twin[e];
      if (w->low[e] > 0.0f) {
        real = 1;
        if (emit && w->wall_of[e] != SMAP_NONE) {
          smap_mix(p, q, w->low[e], middle);
          smap_push(w, o, island, w->wall_of[e], p, middle);
        }
      } else if (w->rail[w->vertex[e]] == 0 || w->rail[w->vertex[e]] + 1 == w->map->rails) {
        real = 1;
      }
      if (emit && (w->low[e] > 0.0f || w->rail[w->vertex[e]] != w->rail[w->vertex[smap_next(e)]])) {
        smap_push_side(w, o, island, e);
      }
      if (w->low[e] > 0.0f && emit && w->wall_of[back] != SMAP_NONE) {
        smap_corner(w, back, q);
        smap_end(w, back, p);
        smap_mix(p, q, w->low[e], middle);
        smap_push(w, o, island, w->wall_of[back], middle, p);
      }
      e = smap_onward(w, back);
    }
    left--;
  } while (e != start && left > 0 && !w->failed);
  if (!emit && !real) {
    /* All the way round an inner contact the strips hold: no boundary. */
    left = SMAP_MANY_EDGES;
    e = start;
    do {
      o->side[w->side_of[e]].inner = 1;
      e = smap_onward(w, w->twin[e]);
      left--;
    } while (e != start && left > 0);
  }
  return real;
}

/* List the segments of all loops. */
static void smap_find_boundary(smap_many_work_t *w, smap_many_pose_t *o)
{
  uint8_t e, round, n;
  for (e = 0; e < 3u * w->facets; e++) {
    w->seen[e] = w->wall_of[e] == SMAP_NONE || w->facet[e / 3u].kind != SMAP_REST;
  }
  for (round = 0; round < 2; round++) {
    for (e = 0; e < 3u * w->facets && !w->failed; e++) {
      n = e;
      if (round == 0) {
        if (w->low[e] == SMAP_SHORT || smap_is_gap(w, e)) {
          continue;
        }
        n = smap_onward(w, e);
      }
      if (w->low[n] == SMAP_SHORT || w->seen[n] || w->facet[n / 3u].kind != SMAP_REST) {
        continue;
      }
      if (smap_loop(w, o, n, 0)) {
        w->last = SMAP_NONE;
        smap_loop(w, o, n, 1);
      }
    }
  }
}
