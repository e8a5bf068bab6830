/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- strips: the sides of gaps ----------------------------------------------------------------------- */
/* A strip is swept by the part of a segment between two contacts that holds, and seen from the com its sides are
 * bent: see smap_curve. */
#define SMAP_STRAIGHT 1e-7f /* of the size, squared: a side as short as this is straight */
#define SMAP_BEHIND 1e-6f   /* a sine: as far on the hither side of a wall by rounding */

/* Make the walls of the side of a strip at the beginning of an edge, on the way to its twin. */
static void smap_add_side(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const uint8_t back = w->twin[e], i = w->vertex[e];
  smap_side_t *side;
  float p[3], q[3], d[3];
  if (o->at.sides >= SMAP_MOST(w->map, sides, SMAP_MANY_SIDES)) {
    w->full = 1;
    return;
  }
  side = &o->at.side[o->at.sides];
  w->side_of[e] = o->at.sides++;
  side->wall = side->end = o->at.walls;
  side->inner = side->inwards = 0;
  smap_mix(smap_corner(w, e), smap_end(w, e), w->low[e], p);
  smap_mix(smap_end(w, back), smap_corner(w, back), w->low[e], q);
  side->point = smap_add_point(w, o, p);
  smap_minus(q, p, d);
  if (!(smap_dot(d, d) > 1e-10f * w->map->size * w->map->size)) {
    /* No width: a wall across the way to the far end. */
    smap_minus(smap_end(w, e), p, d);
    smap_cross(p, d, q);
    smap_cross(q, p, d);
    (void)smap_add_wall(w, o, d, i, i);
    (void)smap_add_point(w, o, p);
    side->end = o->at.walls;
  } else if (smap_dot(d, d) > SMAP_STRAIGHT * w->map->size * w->map->size) {
    smap_curve(w, o, e, side, p, q);
  } else {
    smap_add_piece(w, o, side, p, q, i);
  }
}

/* Whether a strip lies beyond an edge of it, as seen from the com, at its far end too: a com that is next to none
 * above its facets may see that end on the hither side. */
static int smap_is_beyond(const smap_many_work_t *w, const smap_many_pose_t *o, uint8_t e)
{
  const smap_side_t *side = &o->at.side[w->side_of[e]], *other = &o->at.side[w->side_of[w->twin[e]]];
  const uint8_t wall = w->wall_of[e];
  return wall >= SMAP_WALLED || (smap_dot(o->wall[wall], o->point[smap_last_point(o, side)]) < SMAP_BEHIND &&
                                     smap_dot(o->wall[wall], o->point[other->point]) < SMAP_BEHIND);
}

/* Whether what holds at both ends of the strip is on the inner side of the side of an edge. */
static int smap_has_ends(const smap_many_work_t *w, const smap_many_pose_t *o, uint8_t e)
{
  const smap_side_t *side = &o->at.side[w->side_of[e]];
  const uint8_t wall = side->wall, end = side->end;
  return wall < end && smap_dot(o->wall[wall], smap_end(w, e)) >= 0.0f &&
         smap_dot(o->wall[end - 1u], smap_corner(w, w->twin[e])) >= 0.0f;
}

/* Make both sides of the strip of an edge; 0 where it must not be one, or finds no room. */
static int smap_add_sides(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const uint8_t back = w->twin[e], walls = o->at.walls, points = o->at.points, sides = o->at.sides;
  int done;
  smap_add_side(w, o, e);
  smap_add_side(w, o, back);
  done = !w->full && w->left && smap_is_beyond(w, o, e) && smap_is_beyond(w, o, back) &&
         smap_has_ends(w, o, e) && smap_has_ends(w, o, back);
  if (!done) {
    o->at.walls = walls;
    o->at.points = points;
    o->at.sides = sides;
    w->low[e] = w->low[back] = SMAP_OPEN;
    w->full = 0;
  }
  return done;
}

/* The first edge from e on that has a gap; each arc has one. */
static uint8_t smap_to_strip(const smap_many_work_t *w, uint8_t e)
{
  for (; e < w->edges && !(smap_is_gap(w, e) && w->twin[e] > e); e++) {
  }
  return e;
}

/* Make the strips of all gaps, and give the islands that they join one number. */
static void smap_add_strips(smap_many_work_t *w, smap_many_pose_t *o)
{
  uint8_t e, k;
  for (e = smap_to_strip(w, 0); e < w->edges && smap_may(w, SMAP_COST_STRIP);
       e = smap_to_strip(w, (uint8_t)(e + 1u))) {
    const uint8_t from = w->facet[w->owner[e]].shown, to = w->facet[w->owner[w->twin[e]]].shown;
    uint8_t a, b;
    if (from >= SMAP_MANY_SHOWN || to >= SMAP_MANY_SHOWN) { /* all rests are shown */
      w->left = 0;
      return;
    }
    a = o->at.island[from];
    b = o->at.island[to];
    if (smap_add_sides(w, o, e)) {
      o->at.alone[from] = o->at.alone[to] = 0;
      for (k = 0; k < o->at.shown; k++) {
        o->at.island[k] = o->at.island[k] == b ? a : o->at.island[k];
      }
    }
  }
  for (k = 0; k < o->at.edge[o->at.shown] && w->left; k++) {
    const uint8_t edge = o->at.rim[k].side, beyond = w->twin[edge], back = w->wall_of[beyond];
    o->at.rim[k].side = SMAP_NONE;
    if (smap_is_gap(w, edge) && back < SMAP_WALLED) {
      o->at.rim[k].side = w->side_of[beyond < edge ? beyond : edge];
      o->at.rim[k].back = back;
      o->at.rim[k].to = w->facet[w->owner[beyond]].shown;
    }
  }
}
