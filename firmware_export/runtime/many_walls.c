/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- walls and the boundary of the region ------------------------------------------------------------ */
/* A wall is a plane through the com, kept as its unit normal, which points into its cone.  A part of the boundary is
 * an arc on a wall, kept as its middle and its direction there. */

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

/* Give what short arcs join with edge `start` one number as a rest, and make its walls, in the order of its edges. */
SMAP_APART static void smap_add_rest(smap_many_work_t *w, smap_many_pose_t *o, uint8_t start)
{
  const smap_facet_t *f = &w->facet[w->owner[start]];
  const uint8_t at = o->at.rests;
  const float size2 = w->map->size * w->map->size, least = 1e-14f * size2 * size2;
  uint8_t e = start, n = o->at.edge[at], k, left = w->edges;
  float along[3], wall[3];
  if (at >= SMAP_MOST(w->map, rests, SMAP_MANY_RESTS)) {
    w->full = 1;
    return;
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o->plane[at][k] = f->at.n[k] / f->h;
    o->centre[at][k] = f->centre[k];
  }
  o->height[at] = f->h;
  o->at.alone[at] = 1;
  do {
    w->facet[w->owner[e]].rest = at;
    smap_minus(smap_end(w, e), smap_corner(w, e), along);
    smap_cross(smap_corner(w, e), along, wall);
    if (smap_dot(wall, wall) > least) {
      if (n >= SMAP_MOST(w->map, corners, SMAP_MANY_CORNERS) || !smap_scale(wall, o->wall[n])) {
        w->full = 1;
        return;
      }
      o->at.over[n][0] = w->map->named[w->vertex[e]];
      o->at.over[n][1] = w->map->named[w->vertex[w->next[e]]];
      w->wall_of[e] = n++;
    }
    e = w->onward[e];
  } while (e != start && --left > 0);
  w->full = e != start ? 1 : w->full;
  o->at.edge[at + 1] = n;
  o->at.rests = (uint8_t)(at + 1u);
}

/* Add a part of the boundary, from place p to q on a wall. */
static void smap_add_arc(smap_many_work_t *w, smap_many_pose_t *o, uint8_t wall, const float p[3], const float q[3])
{
  const uint8_t at = o->at.arcs;
  float a[3], b[3], sine2, cosine, sine;
  uint8_t k;
  if (at >= SMAP_MOST(w->map, arcs, SMAP_MANY_ARCS) || !smap_scale(p, a) || !smap_scale(q, b)) {
    w->full = 1;
    return;
  }
  smap_minus(b, a, o->along[at]);
  sine2 = 0.25f * smap_dot(o->along[at], o->along[at]); /* of half of it */
  sine = smap_root(sine2);
  cosine = smap_root(1.0f - (sine2 < 1.0f ? sine2 : 1.0f));
  smap_mix(a, b, 0.5f, a);
  if (!smap_scale(a, b)) {
    w->full = 1;
    return;
  }
  smap_cross(o->wall[wall], b, a);
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o->along[at][k] = a[k] * cosine;
    o->amid[at][k] = b[k] * sine;
  }
  o->at.arc[at] = wall;
  o->at.arcs = (uint8_t)(at + 1u);
}
