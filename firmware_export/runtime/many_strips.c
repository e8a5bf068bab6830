/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- strips: the sides of gaps ----------------------------------------------------------------------- */
/* A strip is swept by the part of a segment between two contacts that holds.  Where its side is part of a
 * circle it is cut along tangents if it bulges into the strip, along its chord if it bulges outwards. */
#if SMAP_MANY_RAILS
#define SMAP_PIECE 0.2f /* rad: longest piece of a side */
#else
#define SMAP_PIECE 0.07f
#endif
#define SMAP_STRAIGHT 1e-7f /* of the size, squared: a side as short as this is straight */
#define SMAP_BEHIND 1e-6f   /* a sine: as far on the hither side of a wall by rounding */

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
  count = smap_is_cut(w, e) ? 1.0f : count;
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
  if (o->at.sides >= SMAP_MOST(w->map, sides, SMAP_MANY_SIDES)) {
    w->full = 1;
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
#if !SMAP_MANY_RAILS
  if (!smap_are_alike(w, i, j) && smap_dot(d, d) > SMAP_STRAIGHT * w->map->size * w->map->size) {
    smap_trace(w, o, e, side, q);
    return;
  }
#endif
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

/* Whether a strip lies beyond an edge of it, as seen from the com, at its far end too: a com that is next to none
 * above its facets may see that end on the hither side. */
static int smap_is_beyond(const smap_many_work_t *w, const smap_many_pose_t *o, uint8_t e)
{
  const smap_side_t *side = &o->at.side[w->side_of[e]], *other = &o->at.side[w->side_of[w->twin[e]]];
  const float *wall;
  if (w->wall_of[e] == SMAP_NONE) {
    return 1;
  }
  wall = o->wall[w->wall_of[e]];
  return smap_dot(wall, o->point[side->point + side->count]) < SMAP_BEHIND &&
         smap_dot(wall, o->point[other->point]) < SMAP_BEHIND;
}

/* Make both sides of the strip of an edge; 0 where it must not be one, or finds no room. */
static int smap_add_sides(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const uint8_t back = w->twin[e], walls = o->at.walls, points = o->at.points, sides = o->at.sides;
  int done;
  smap_add_side(w, o, e);
  smap_add_side(w, o, back);
  done = !w->full && w->left && smap_is_beyond(w, o, e) && smap_is_beyond(w, o, back);
#if !SMAP_MANY_RAILS
  done = done && smap_has_ends(w, o, e) && smap_has_ends(w, o, back);
#endif
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
    const uint8_t a = o->at.island[from], b = o->at.island[to];
    if (smap_add_sides(w, o, e)) {
      o->at.alone[from] = o->at.alone[to] = 0;
      for (k = 0; k < o->at.shown; k++) {
        o->at.island[k] = o->at.island[k] == b ? a : o->at.island[k];
      }
    }
  }
  for (k = 0; k < o->at.edge[o->at.shown] && w->left; k++) {
    e = o->at.rim[k].side;
    o->at.rim[k].side = SMAP_NONE;
    if (smap_is_gap(w, e) && w->wall_of[w->twin[e]] != SMAP_NONE) {
      o->at.rim[k].side = w->side_of[w->twin[e] < e ? w->twin[e] : e];
      o->at.rim[k].back = w->wall_of[w->twin[e]];
      o->at.rim[k].to = w->facet[w->owner[w->twin[e]]].shown;
    }
  }
}
