/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- walls and the boundary of the region ------------------------------------------------------------ */
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
 *   A segment lies on a wall, between two points, kept as unit vectors.  The side of a strip is a
 *   curve, cut into pieces that lose a little of the strip and add nothing to it: along tangents
 *   where it bulges into the strip, along its chord where it bulges outwards.
 */
#if SMAP_MANY_RAILS
#define SMAP_PIECE 0.2f  /* rad: longest piece of a side */
#else
#define SMAP_PIECE 0.07f  /* two rims that turn at different rates make no circle between them */
#endif
#if !SMAP_MANY_RAILS
#define SMAP_BENT 1e-4f /* a sine: what rounding may bend */
#endif
#define SMAP_LOST 2e-4f  /* of the size: what the exact definition's pieces lose */
#define SMAP_PIECES 12.0f
#define SMAP_STRAIGHT 1e-7f /* of the size, squared: a side as short as this is straight */

/* Scale a vector to length 1; 0 where it has no direction, or is no number. */
static int smap_scale(const float v[3], float out[3])
{
  const float size2 = smap_dot(v, v);
  float scale;
  if (!(size2 > 1e-34f && size2 < 1e34f)) {
    return 0;
  }
  scale = 1.0f / smap_root(size2);
  out[0] = v[0] * scale;
  out[1] = v[1] * scale;
  out[2] = v[2] * scale;
  return 1;
}

static uint8_t smap_add_wall(smap_many_work_t *w, smap_many_pose_t *o, const float n[3], uint8_t i,
                             uint8_t j)
{
  if (o->at.walls >= SMAP_MANY_WALLS || !smap_scale(n, o->wall[o->at.walls])) {
    w->left = 0;
    return 0;
  }
  o->at.over[o->at.walls][0] = w->map->named[i];
  o->at.over[o->at.walls][1] = w->map->named[j];
  return o->at.walls++;
}

static uint8_t smap_add_point(smap_many_work_t *w, smap_many_pose_t *o, const float p[3])
{
  if (o->at.points >= SMAP_MANY_LINKS || !smap_scale(p, o->point[o->at.points])) {
    w->left = 0;
    return 0;
  }
  return o->at.points++;
}

/* How many pieces the exact definition cuts the strip of an edge into; `turn` is by how much the
 * contacts go on along their rims (rad). */
static float smap_pieces(const smap_many_work_t *w, uint8_t e, float *turn)
{
  const uint8_t back = w->twin[e], contact[2] = {w->vertex[e], w->vertex[w->next[e]]};
  float most = 0.0f, d[3], n;
  uint8_t k;
  *turn = 0.0f;
  for (k = 0; k < 2; k++) {
    const float r = w->r[contact[k]];
    if (r > 0.0f) {
      float chord2;
      smap_minus(k ? smap_end(w, e) : smap_corner(w, e), k ? smap_corner(w, back) : smap_end(w, back),
                 d);
      chord2 = smap_dot(d, d) / r;
      most = chord2 > most ? chord2 : most;
      n = smap_root(chord2 / r);
      *turn = n > *turn ? n : *turn;
    }
  }
  most *= 0.125f / (SMAP_LOST * w->map->size);
  if (most <= 1.0f) {
    return 1.0f;
  }
  n = smap_root(most);
  return n < SMAP_PIECES - 1.0f ? 1.0f + (float)(int32_t)n : SMAP_PIECES;
}

/* Append a piece of a side: a wall from the last point to one more. */
static void smap_add_piece(smap_many_work_t *w, smap_many_pose_t *o, smap_side_t *side,
                           const float p[3], const float q[3], uint8_t i)
{
  float n[3];
  smap_cross(p, q, n);
  (void)smap_add_wall(w, o, n, i, i);
  (void)smap_add_point(w, o, q);
  side->count++;
}

/* A side from p to q bulges into the strip: corners on tangents, as many as it takes. */
static void smap_bulge(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e, smap_side_t *side,
                       const float p[3], const float q[3])
{
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[w->twin[e]]].at;
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  float count, turn, last[3], a[3];
  const float pieces = smap_pieces(w, e, &turn);
  smap_aim_t here = *from, there;
  uint8_t k;
  count = (float)(int32_t)(turn * (1.0f / SMAP_PIECE)) + 1.0f;
  count = count > pieces ? pieces : count;
  smap_copy(p, last);
  for (k = 1; (float)k <= count && smap_may(w, SMAP_COST_PIECE); k++) {
    if ((float)(k + 1) > count) {
      there = *to;
    } else {
      smap_on_arc(w, i, j, from, to, (float)(int32_t)((float)k * pieces / count + 0.5f) / pieces,
                  &there);
    }
    smap_meet(w, i, j, w->low[e], &here, &there, a);
    smap_add_piece(w, o, side, last, a, i);
    smap_copy(a, last);
    here = there;
  }
  smap_add_piece(w, o, side, last, q, i);
}

/* Make the walls of the side of a strip at the beginning of an edge, on the way to its twin. */
static void smap_add_side(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const uint8_t back = w->twin[e], i = w->vertex[e], j = w->vertex[w->next[e]];
  smap_side_t *side = &o->at.side[o->at.sides];
  float p[3], q[3], middle[3], chord[3], d[3];
  smap_aim_t half;
  if (o->at.sides >= SMAP_MANY_SIDES) {
    w->left = 0;
    return;
  }
  w->side_of[e] = o->at.sides++;
  side->wall = o->at.walls;
  side->inner = side->inwards = side->count = 0;
  smap_mix(smap_corner(w, e), smap_end(w, e), w->low[e], p);
  smap_mix(smap_end(w, back), smap_corner(w, back), w->low[e], q);
  side->point = smap_add_point(w, o, p);
  smap_minus(q, p, d);
  if (!(smap_dot(d, d) > 1e-10f * w->map->size * w->map->size)) {
    /* No width: a wall across the way to the far end. */
    const float *far = smap_end(w, e);
    smap_minus(far, p, d);
    smap_cross(p, d, middle);
    smap_cross(middle, p, d);
    (void)smap_add_wall(w, o, d, i, i);
    (void)smap_add_point(w, o, p);
    side->count = 1;
    return;
  }
  smap_on_arc(w, i, j, &w->facet[w->owner[e]].at, &w->facet[w->owner[back]].at, 0.5f, &half);
  smap_meet(w, i, j, w->low[e], &half, &half, middle);
  smap_cross(p, q, chord);
  side->inwards = smap_dot(chord, middle) > 0.0f;
  if (side->inwards && smap_dot(d, d) > SMAP_STRAIGHT * w->map->size * w->map->size) {
    smap_bulge(w, o, e, side, p, q);
  } else {
    smap_add_piece(w, o, side, p, q, i);
  }
}

#if !SMAP_MANY_RAILS
/* Whether the side at the beginning of an edge is bent one way only.  Two rims that turn at different rates,
 * one of them lying nearly flat, draw an S between them, and neither its tangents nor its chord keep to the
 * strip. */
static int smap_is_bent_once(const smap_many_work_t *w, const smap_many_pose_t *o, uint8_t e)
{
  const smap_side_t *side = &o->at.side[w->side_of[e]];
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[w->twin[e]]].at;
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  uint8_t k;
  if (side->inwards) {
    for (k = 0; k + 1u < side->count; k++) {
      if (smap_dot(o->wall[side->wall + k], o->point[side->point + k + 2u]) > SMAP_BENT) {
        return 0;
      }
    }
    return 1;
  }
  for (k = 1; k < 4; k = (uint8_t)(k + 2u)) {
    smap_aim_t at;
    float p[3], q[3];
    smap_on_arc(w, i, j, from, to, 0.25f * (float)k, &at);
    smap_touch(w, i, &at, p);
    smap_touch(w, j, &at, q);
    smap_mix(p, q, w->low[e], p);
    if (smap_dot(o->wall[side->wall], p) > SMAP_BENT * w->map->size) {
      return 0;
    }
  }
  return 1;
}
#endif

/* Make both sides of the strip of an edge; 0 where it must not be one. */
static int smap_add_sides(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const uint8_t back = w->twin[e];
#if SMAP_MANY_RAILS
  smap_add_side(w, o, e);
  smap_add_side(w, o, back);
#else
  const uint8_t walls = o->at.walls, points = o->at.points, sides = o->at.sides;
  smap_add_side(w, o, e);
  smap_add_side(w, o, back);
  if (w->left && !(smap_is_bent_once(w, o, e) && smap_is_bent_once(w, o, back))) {
    o->at.walls = walls;
    o->at.points = points;
    o->at.sides = sides;
    w->low[e] = w->low[back] = SMAP_OPEN;
    return 0;
  }
#endif
  return 1;
}

/* Append a part of the boundary. */
static void smap_push(smap_many_work_t *w, smap_many_pose_t *o, uint8_t wall, uint8_t start,
                      uint8_t stop)
{
  smap_segment_t *segment = &o->at.segment[o->at.segments];
  if (!w->left || o->at.segments >= SMAP_MANY_LINKS) {
    w->left = 0;
    return;
  }
  segment->wall = wall;
  segment->start = start;
  segment->stop = stop;
  segment->bent = 0;
  o->at.segments++;
}

/* Append the boundary from edge e on, over a gap if it has one, and return the edge there. */
static uint8_t smap_follow(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const uint8_t back = w->twin[e];
  const smap_side_t *side;
  uint8_t k;
  if (!smap_is_gap(w, e)) {
    if (w->wall_of[e] != SMAP_NONE) {
      o->at.begin[w->facet[w->owner[e]].shown] = o->at.segments;
      smap_push(w, o, w->wall_of[e], w->point_of[e], w->point_of[w->onward[e]]);
    }
    return w->onward[e];
  }
  side = &o->at.side[w->side_of[e]];
  if (w->low[e] > 0.0f && w->wall_of[e] != SMAP_NONE) {
    smap_push(w, o, w->wall_of[e], w->point_of[e], side->point);
  }
  for (k = 0; k < side->count && w->left; k++) {
    smap_push(w, o, (uint8_t)(side->wall + k), (uint8_t)(side->point + k),
              (uint8_t)(side->point + k + 1u));
  }
  if (w->low[e] > 0.0f && w->wall_of[back] != SMAP_NONE) {
    smap_push(w, o, w->wall_of[back], (uint8_t)(side->point + side->count),
              w->point_of[w->onward[back]]);
  }
  return w->onward[back];
}

/* Whether the strips round a contact hold all the way: then there is no boundary.  The places where a
 * ball touches are a patch, and no strip covers that. */
static int smap_is_inner(smap_many_work_t *w, smap_many_pose_t *o, uint8_t start)
{
  uint8_t e = start;
#if !SMAP_MANY_RAILS
  const uint8_t contact = w->vertex[start];
  if (w->r[contact] > 0.0f) {
#if SMAP_MANY_AXLES
    if (!(smap_dot(w->axle[contact], w->axle[contact]) > 0.0f))
#endif
    {
      return 0;
    }
  }
#endif
  do {
    if (w->low[e] != 0.0f) {
      return 0;
    }
    e = w->onward[w->twin[e]];
  } while (e != start && smap_may(w, SMAP_COST_OUTLINE));
  do {
    w->seen[e] = SMAP_NONE;
    o->at.side[w->side_of[e]].inner = 1;
    e = w->onward[w->twin[e]];
  } while (e != start && smap_may(w, SMAP_COST_OUTLINE));
  return 1;
}

/* Append the loop of an island's boundary from an edge on.  Without a gap it is convex: nothing of it is
 * bent. */
static void smap_loop(smap_many_work_t *w, smap_many_pose_t *o, uint8_t start,
                                 uint8_t island)
{
  const uint8_t first = o->at.segments;
  uint8_t e = start, k, gaps = 0;
  do {
    w->seen[e] = SMAP_NONE;
    gaps = gaps || smap_is_gap(w, e);
    e = smap_follow(w, o, e);
  } while (e != start && smap_may(w, SMAP_COST_OUTLINE));
  for (k = first; gaps && k < o->at.segments && w->left; k++) {
    const smap_segment_t *next = &o->at.segment[k + 1 < o->at.segments ? k + 1 : first];
    o->at.segment[k].bent = smap_dot(o->wall[o->at.segment[k].wall], o->point[next->stop]) < 1e-4f;
    o->at.convex[island] = o->at.convex[island] && !o->at.segment[k].bent;
  }
}

/* Append what of an island's boundary an edge is of, if it is of any. */
SMAP_APART static void smap_bound(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e, uint8_t island)
{
  if (!(smap_is_gap(w, e) && smap_is_inner(w, o, e))) {
    smap_loop(w, o, e, island);
  }
}

/* List the segments of all loops. */
static void smap_find_boundary(smap_many_work_t *w, smap_many_pose_t *o)
{
  uint8_t e, k;
  for (e = 0; e < w->edges; e++) {
    const smap_facet_t *f = &w->facet[w->owner[e]];
    w->seen[e] = f->kind != SMAP_REST || f->shown == SMAP_NONE || w->low[e] == SMAP_SHORT
                     ? (uint8_t)SMAP_NONE
                     : o->at.island[f->shown];
  }
  for (k = 0; k < o->at.shown; k++) {
    o->at.first[k] = o->at.segments;
    o->at.convex[k] = 1;
    for (e = 0; e < w->edges; e++) {
      if (w->seen[e] == k && smap_may(w, SMAP_COST_LOOP)) {
        smap_bound(w, o, e, k);
      }
    }
    o->at.last[k] = o->at.segments;
  }
  for (k = 0; k < o->at.shown; k++) {
    const uint8_t island = o->at.island[k];
    o->at.convex[k] = o->at.convex[island];
    if (o->at.begin[k] < o->at.first[island] || o->at.begin[k] >= o->at.last[island]) {
      o->at.begin[k] = o->at.first[island];
    }
  }
}
