/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- poses of many contacts -------------------------------------------------------------------------- */
/* A pose: what `at` needs of a posture. */

/* The first edge from e on of a facet that is not shown yet. */
static uint8_t smap_to_show(const smap_many_work_t *w, uint8_t e)
{
  for (; e < w->edges; e++) {
    if (w->facet[w->owner[e]].shown == SMAP_NONE && w->low[e] != SMAP_SHORT &&
        w->facet[w->owner[e]].kind != SMAP_REFUSED) {
      break;
    }
  }
  return e;
}

#if SMAP_MANY_RAILS > 2
/* The inner rim of the wheel at an end of an edge if it is on the near half of the way to the other end, or SMAP_NONE. */
static inline uint8_t smap_inner_of(const smap_many_work_t *w, uint8_t end, uint8_t other)
{
  const uint8_t i = w->vertex[end], mate = w->mate[i];
  float part, whole;
  if (mate >= SMAP_MANY_CONTACTS) {
    return SMAP_NONE;
  }
  part = w->p[mate][1] - w->p[i][1];
  whole = w->p[w->vertex[other]][1] - w->p[i][1];
  return part * whole > 2.0f * part * part ? mate : (uint8_t)SMAP_NONE;
}

/* Move an end of an edge to an inner rim of its wheel where that is on the planes on both sides of the edge and within
 * it: over which of both rims the robot turns there is rounding. */
SMAP_APART static void smap_take_inner(const smap_many_work_t *w, uint8_t e, uint8_t mate, const float wall[3],
                                       float p[3])
{
  const smap_facet_t *f = &w->facet[w->owner[e]], *g = &w->facet[w->owner[w->twin[e]]];
  float spot[3];
  if (!smap_touches(w, mate, f) || !smap_touches(w, mate, g)) {
    return;
  }
  smap_touch(w, mate, &f->at, spot);
  if (smap_dot(wall, spot) > 0.0f) {
    smap_copy(spot, p);
  }
}
#endif

/* The wall of an edge, not scaled; returns the square of its length. */
static float smap_edge_wall(smap_many_work_t *w, uint8_t e, float wall[3])
{
  float along[3];
  smap_minus(smap_end(w, e), smap_corner(w, e), along);
  smap_cross(smap_corner(w, e), along, wall);
#if SMAP_MANY_RAILS > 2
  if (w->twin[e] != e && !smap_is_gap(w, e)) {
    const uint8_t near = smap_inner_of(w, e, w->next[e]), far = smap_inner_of(w, w->next[e], e);
    float p[3], q[3];
    smap_copy(smap_corner(w, e), p);
    smap_copy(smap_end(w, e), q);
    if (near < SMAP_MANY_CONTACTS && smap_may(w, SMAP_COST_INNER)) {
      smap_take_inner(w, e, near, wall, p);
    }
    if (far < SMAP_MANY_CONTACTS && smap_may(w, SMAP_COST_INNER)) {
      smap_take_inner(w, e, far, wall, q);
    }
    smap_minus(q, p, along);
    smap_cross(p, along, wall);
  }
#endif
  return smap_dot(wall, wall);
}

/* Enter what short arcs join with edge `start` as one facet: its walls, in the order of its edges. */
SMAP_APART static void smap_show(smap_many_work_t *w, smap_many_pose_t *o, uint8_t start)
{
  smap_facet_t *f = &w->facet[w->owner[start]];
  const uint8_t at = o->at.shown;
  const float size2 = w->map->size * w->map->size, least = 1e-14f * size2 * size2;
  uint8_t e = start, n = o->at.edge[at], k;
  float wall[3];
  if (at >= SMAP_MOST(w->map, shown, SMAP_MANY_SHOWN)) {
    w->left = 0;
    return;
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o->plane[at][k] = f->at.n[k] / f->h;
    o->centre[at][k] = f->centre[k];
  }
  o->height[at] = f->h;
  o->at.kind[at] = f->kind;
  o->at.island[at] = at;
  o->at.alone[at] = 1;
  do {
    w->facet[w->owner[e]].shown = at;
    w->wall_of[e] = SMAP_NONE;
    w->point_of[e] = smap_add_point(w, o, smap_corner(w, e));
    if (smap_edge_wall(w, e, wall) > least) {
      if (n >= SMAP_WALLED) { /* no edge is come to twice */
        w->left = 0;
        return;
      }
      (void)smap_add_wall(w, o, wall, w->vertex[e], w->vertex[w->next[e]]);
      w->wall_of[e] = n;
      o->at.begin[n] = 0;
      o->at.rim[n++].side = e; /* until the sides are known */
    }
    e = w->onward[e];
  } while (e != start && smap_may(w, SMAP_COST_OUTLINE));
  o->at.edge[at + 1] = n;
  o->at.shown = (uint8_t)(at + 1u);
}

#if SMAP_MANY_RAILS
/* Turn what was found in the rails' frame into the body's. */
static void smap_turn_back(const smap_many_t *m, float (*v)[3], uint8_t n)
{
  uint8_t k;
  for (k = 0; k < n; k++) {
    const float x = v[k][0], y = v[k][1];
    v[k][0] = x * m->axis[1] + y * m->axis[0];
    v[k][1] = y * m->axis[1] - x * m->axis[0];
  }
}
#endif

/* Make the pose of a posture whose contacts are where `w` has them; 0 where that fails, and then it reads unsafe. */
static int smap_many_pose(const smap_many_t *m, smap_many_pose_t *o, smap_many_work_t *w)
{
  uint8_t e;
  o->at.shown = o->at.walls = o->at.points = o->at.segments = o->at.sides = o->at.alive = o->at.edge[0] = 0;
  o->guard = m->guard;
  o->hair = 1e-4f;  /* a sine, no more than the guard: nearer to the wall of an edge both sides of it are looked at */
  o->slack = 5e-4f; /* a sine */
  w->map = m;
  w->roll = o->point;
  w->bench = (smap_bench_t *)o->wall;
  w->facets = w->edges = w->rolls = w->full = 0;
  w->posture = 0.0f;
  w->left = SMAP_MOST(m, work, SMAP_MANY_WORK);
  smap_find_facets(w);
  if (w->left) {
    smap_classify(w);
    smap_find_outlines(w, smap_mark_short(w));
#if SMAP_MANY_GAPS
    smap_find_gaps(w);
#endif
  }
  for (e = smap_to_show(w, 0); e < w->edges && smap_may(w, SMAP_COST_SHOW); e = smap_to_show(w, e)) {
    smap_show(w, o, e);
  }
  if (w->full) {
    w->left = 0;
  }
#if SMAP_MANY_GAPS
  if (w->left) {
    smap_add_strips(w, o);
  }
#endif
  if (w->left) {
    smap_find_boundary(w, o);
  }
  if (!w->left) {
    o->at.shown = 0;
    return 0;
  }
#if SMAP_MANY_RAILS
  if (m->axis[1] != 1.0f) {
    smap_turn_back(m, o->plane, o->at.shown);
    smap_turn_back(m, o->centre, o->at.shown);
    smap_turn_back(m, o->wall, o->at.walls);
    smap_turn_back(m, o->point, o->at.points);
  }
#endif
  o->at.alive = 1;
  return 1;
}
