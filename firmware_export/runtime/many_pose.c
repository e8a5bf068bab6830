/* A pose: what `at` needs of a posture. */

/* Enter what short arcs join with edge `start` as one facet: its walls, in the order of its edges. */
static void smap_show(smap_many_work_t *w, smap_many_pose_t *o, uint8_t start)
{
  smap_facet_t *f = &w->facet[start / 3u];
  const float *middle = w->centre[start / 3u];
  uint8_t e = start, left = SMAP_MANY_EDGES, at = o->shown;
  float p[3], q[3], n[3], level, inverse;
  if (o->shown >= SMAP_MANY_SHOWN) {
    w->failed = 1;
    return;
  }
  inverse = 1.0f / f->h;
  o->plane[at][0] = f->s * inverse;
  o->plane[at][1] = f->t * inverse;
  o->plane[at][2] = -f->c * inverse;
  o->height[at] = f->h / f->norm;
  level = f->h - f->t * middle[1];
  o->centre[at][0] = middle[0] * f->c + level * f->s;
  o->centre[at][1] = middle[1];
  o->centre[at][2] = middle[0] * f->s - level * f->c;
  o->kind[at] = f->kind;
  o->island[at] = at;
  do {
    w->facet[e / 3u].group = at;
    smap_corner(w, e, p);
    smap_end(w, e, q);
    smap_cross(p, q, n);
    w->wall_of[e] = SMAP_NONE;
    if (smap_dot(n, n) > 1e-10f * smap_dot(p, p) * smap_dot(p, p)) {
      w->wall_of[e] = smap_add_wall(w, o, n, w->vertex[e], w->vertex[smap_next(e)]);
    }
    e = smap_onward(w, e);
    left--;
  } while (e != start && left > 0 && !w->failed);
  o->shown++;
}

/* Give the islands that held gaps join one number. */
static void smap_join_islands(smap_many_work_t *w, smap_many_pose_t *o)
{
  uint8_t e, k;
  for (e = 0; e < 3u * w->facets; e++) {
    if (smap_is_gap(w, e)) {
      const uint8_t a = o->island[w->facet[e / 3u].group];
      const uint8_t b = o->island[w->facet[w->twin[e] / 3u].group];
      for (k = 0; k < o->shown; k++) {
        o->island[k] = o->island[k] == b ? a : o->island[k];
      }
    }
  }
}

/* List the walls of each shown facet with what is beyond them. */
static void smap_list_edges(smap_many_work_t *w, smap_many_pose_t *o, const uint8_t *start)
{
  uint8_t f, e, left, n = 0;
  for (f = 0; f < o->shown; f++) {
    o->edge[f] = n;
    e = start[f];
    left = SMAP_MANY_EDGES;
    do {
      if (w->wall_of[e] != SMAP_NONE) {
        o->edge_wall[n] = w->wall_of[e];
        o->edge_side[n] = SMAP_NONE;
        if (smap_is_gap(w, e)) {
          const uint8_t back = w->twin[e] < e ? w->twin[e] : e;
          o->edge_side[n] = w->side_of[back];
        }
        n++;
      }
      e = smap_onward(w, e);
      left--;
    } while (e != start[f] && left > 0);
  }
  o->edge[f] = n;
}

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

/* Make the pose of a posture; 0 where that fails, and then it reads unsafe. */
static int smap_many_pose(const smap_many_t *m, const smap_many_place_t *place, smap_many_pose_t *o,
                          smap_many_work_t *w)
{
  uint8_t start[SMAP_MANY_SHOWN], e;
  o->shown = o->walls = o->points = o->segments = o->sides = o->alive = 0;
  o->guard = m->guard;
  o->slack = 5e-4f * m->size;
  w->map = m;
  w->facets = w->failed = 0;
  smap_find_facets(w, place);
  if (w->failed) {
    return 0;
  }
  smap_classify(w);
  smap_mark_short(w);
  smap_find_gaps(w);
  for (e = 0; e < 3u * w->facets && !w->failed; e++) {
    w->side_of[e] = SMAP_NONE;
    if (w->facet[e / 3u].group == SMAP_NONE && w->low[e] != SMAP_SHORT && o->shown < SMAP_MANY_SHOWN) {
      start[o->shown] = e;
      smap_show(w, o, e);
    }
  }
  smap_join_islands(w, o);
  for (e = 0; e < 3u * w->facets && !w->failed; e++) {
    if (smap_is_gap(w, e) && w->twin[e] > e) {
      smap_add_side(w, o, e);
      smap_add_side(w, o, w->twin[e]);
    }
  }
  if (!w->failed) {
    smap_find_boundary(w, o);
    smap_list_edges(w, o, start);
  }
  if (w->failed) {
    o->shown = 0;
    return 0;
  }
  if (m->axis[0] != 0.0f) {
    smap_turn_back(m, o->plane, o->shown);
    smap_turn_back(m, o->centre, o->shown);
    smap_turn_back(m, o->wall, o->walls);
    smap_turn_back(m, o->point, o->points);
  }
  o->alive = 1;
  return 1;
}
