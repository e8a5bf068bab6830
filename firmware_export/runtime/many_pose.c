/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- poses of many contacts -------------------------------------------------------------------------- */
/* A pose: what `at` needs of a posture. */

/* Add what is boundary of the edge of a rest: all but what holds of it. */
static void smap_bound(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e)
{
  const float *const p = smap_corner(w, e), *const q = smap_end(w, e);
  const uint8_t wall = w->wall_of[e];
#if SMAP_MANY_GAPS
  const uint8_t back = w->twin[e];
  float r[3];
  if (smap_is_gap(w, e)) {
    if (smap_is_slit(w, e) && back < e) {
      return; /* it is that of the other rest */
    }
    if (w->low[e] > 0.0f) {
      smap_mix(p, q, w->low[e], r);
      smap_add_arc(w, o, wall, p, r);
    }
    if (w->low[back] > 0.0f) {
      smap_mix(q, p, w->low[back], r);
      smap_add_arc(w, o, wall, r, q);
    }
    return;
  }
#endif
  smap_add_arc(w, o, wall, p, q);
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
  memset(&o->at, 0, sizeof o->at);
  o->guard = m->guard;
  w->map = m;
  w->facets = w->edges = w->full = 0;
  smap_find_facets(w);
  smap_classify(w);
  smap_find_outlines(w);
  memset(w->wall_of, (int)SMAP_NONE, sizeof w->wall_of);
  for (e = 0; e < w->edges && !w->full; e++) {
    if (w->facet[w->owner[e]].rest == SMAP_FOUND && w->low[e] != SMAP_SHORT) {
      smap_add_rest(w, o, e);
    }
  }
#if SMAP_MANY_GAPS
  for (e = 0; e < w->edges && !w->full; e++) {
    if (w->twin[e] > e && w->wall_of[e] != SMAP_NONE && w->wall_of[w->twin[e]] != SMAP_NONE) {
      smap_find_gap(w, o, e);
    }
  }
#endif
  for (e = 0; e < w->edges && !w->full; e++) {
    if (w->wall_of[e] != SMAP_NONE) {
      smap_bound(w, o, e);
    }
  }
  if (w->full) {
    return 0;
  }
#if SMAP_MANY_RAILS
  if (m->axis[1] != 1.0f) {
    smap_turn_back(m, o->plane, o->at.rests);
    smap_turn_back(m, o->centre, o->at.rests);
    smap_turn_back(m, o->wall, o->at.edge[o->at.rests]);
    smap_turn_back(m, o->wall + SMAP_MANY_CORNERS, (uint8_t)(2u * o->at.gaps));
    smap_turn_back(m, o->amid, o->at.arcs);
    smap_turn_back(m, o->along, o->at.arcs);
  }
#endif
  o->at.alive = 1;
  return 1;
}
