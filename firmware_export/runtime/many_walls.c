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
 *   A segment lies on a wall, between two points, kept as unit vectors.
 */

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
  if (o->at.walls >= SMAP_MOST(w->map, walls, SMAP_MANY_WALLS) ||
      !smap_scale(n, o->wall[o->at.walls])) {
    w->full = 1;
    return 0;
  }
  o->at.over[o->at.walls][0] = w->map->named[i];
  o->at.over[o->at.walls][1] = w->map->named[j];
  return o->at.walls++;
}

static uint8_t smap_add_point(smap_many_work_t *w, smap_many_pose_t *o, const float p[3])
{
  if (o->at.points >= SMAP_MOST(w->map, links, SMAP_MANY_LINKS) ||
      !smap_scale(p, o->point[o->at.points])) {
    w->full = 1;
    return 0;
  }
  return o->at.points++;
}

/* Append a part of the boundary. */
static void smap_push(smap_many_work_t *w, smap_many_pose_t *o, uint8_t wall, uint8_t start,
                      uint8_t stop)
{
  smap_segment_t *segment;
  if (!w->left || o->at.segments >= SMAP_MOST(w->map, links, SMAP_MANY_LINKS)) {
    w->left = 0;
    return;
  }
  segment = &o->at.segment[o->at.segments];
  segment->wall = wall;
  segment->start = start;
  segment->stop = stop;
  segment->bent = 0;
  o->at.segments++;
}

/* Append the boundary from edge e on, over a gap if it has one, and return the edge there. */
static uint8_t smap_follow(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const uint8_t back = w->twin[e], wall = w->wall_of[e], beyond = w->wall_of[back];
  const smap_side_t *side;
  uint8_t k, end, point;
  if (wall < SMAP_WALLED) {
    o->at.begin[wall] = o->at.segments;
  }
  if (!smap_is_gap(w, e)) {
    if (wall < SMAP_WALLED) {
      smap_push(w, o, wall, w->point_of[e], w->point_of[w->onward[e]]);
    }
    return w->onward[e];
  }
  side = &o->at.side[w->side_of[e]];
  end = side->end;
  point = side->point;
  if (wall < SMAP_WALLED && w->low[e] > 0.0f) {
    smap_push(w, o, wall, w->point_of[e], point);
  }
  for (k = side->wall; k < end && point + 1 < o->at.points && w->left; k++, point++) {
    smap_push(w, o, k, point, (uint8_t)(point + 1u));
  }
  if (w->low[e] > 0.0f && beyond < SMAP_WALLED) {
    smap_push(w, o, beyond, point, w->point_of[w->onward[back]]);
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

/* Mark where a loop's segments, from `first` on, are bent inwards at their ends, and tell whether any is. */
static int smap_mark_bent(smap_many_pose_t *o, uint8_t first)
{
  const uint8_t end = o->at.segments;
  uint8_t k, before = (uint8_t)(end - 1u);
  int any = 0;
  for (k = first; k < end; before = k++) {
    smap_segment_t *s = &o->at.segment[before];
    s->bent = smap_dot(o->wall[s->wall], o->point[o->at.segment[k].stop]) < 1e-4f;
    any = any || s->bent;
  }
  return any;
}

/* Append the loop of an island's boundary from an edge on.  Without a gap it is convex: nothing of it is
 * bent. */
static void smap_loop(smap_many_work_t *w, smap_many_pose_t *o, uint8_t start, uint8_t island)
{
  const uint8_t first = o->at.segments;
  uint8_t e = start;
  int gaps = 0;
  do {
    w->seen[e] = SMAP_NONE;
    gaps = gaps || smap_is_gap(w, e);
    e = smap_follow(w, o, e);
  } while (e != start && smap_may(w, SMAP_COST_OUTLINE));
  if (gaps && w->left && o->at.segments > first && smap_mark_bent(o, first)) {
    o->at.convex[island] = 0;
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
SMAP_APART static void smap_find_boundary(smap_many_work_t *w, smap_many_pose_t *o)
{
  uint8_t e, k;
  for (e = 0; e < w->edges; e++) {
    const smap_facet_t *f = &w->facet[w->owner[e]];
    const uint8_t shown = f->shown;
    w->seen[e] = f->kind != SMAP_REST || shown >= SMAP_MANY_SHOWN || w->low[e] == SMAP_SHORT ? (uint8_t)SMAP_NONE
                                                                                           : o->at.island[shown];
  }
  for (k = 0; k < o->at.shown; k++) {
    o->at.first[k] = o->at.segments;
    o->at.convex[k] = 1;
    for (e = o->at.island[k] == k ? 0 : w->edges; e < w->edges; e++) {
      if (w->seen[e] == k && smap_may(w, SMAP_COST_LOOP)) {
        smap_bound(w, o, e, k);
      }
    }
    o->at.last[k] = o->at.segments;
  }
  for (k = 0; k < o->at.shown; k++) {
    o->at.convex[k] = o->at.convex[o->at.island[k]];
  }
}
