/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Sides of gaps, cut into pieces as the definition cuts them (lutgen/support/tiles.py): the runtime takes
 * fewer and longer ones, which lose a little more of the gap. */

/* Into how many pieces the strip of an edge is cut. */
static int exact_pieces(smap_many_work_t *w, uint16_t e)
{
  const uint16_t back = w->twin[e];
  const double size = smap_posture_size(w), most_lost = SMAP_LOST * size;
  double furthest = 0.0, d[3], r, pieces;
  r = w->r[w->vertex[e]];
  if (r > 0.0) {
    smap_minus(smap_corner(w, e), smap_end(w, back), d);
    furthest = smap_dot(d, d) / (8.0 * r);
  }
  r = w->r[w->vertex[w->next[e]]];
  if (r > 0.0) {
    smap_minus(smap_end(w, e), smap_corner(w, back), d);
    furthest = smap_dot(d, d) / (8.0 * r) > furthest ? smap_dot(d, d) / (8.0 * r) : furthest;
  }
  if (furthest <= most_lost) {
    return furthest > 1e-9 * size;
  }
  pieces = smap_root(furthest / most_lost);
  return pieces < 11.0 ? 1 + (int)pieces : 12;
}

/* The walls of the side of a strip at the beginning of an edge, over all corners that the definition has. */
static void exact_side(smap_many_work_t *w, smap_many_pose_t *o, uint16_t e, smap_side_t *side)
{
  const uint16_t i = w->vertex[e], j = w->vertex[w->next[e]], back = w->twin[e];
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[back]].at;
  const int pieces = exact_pieces(w, e);
  smap_aim_t at[3];
  double last[3], p[3], q[3];
  int k;
  at[2] = *from;
  smap_mix(smap_corner(w, e), smap_end(w, e), w->low[e], last);
  for (k = 0; k < pieces && w->left; k++) {
    at[0] = at[2];
    at[2] = *to;
    smap_on_arc(w, i, j, from, to, (k + 0.5) / pieces, &at[1]);
    if (k + 1 < pieces) {
      smap_on_arc(w, i, j, from, to, (k + 1.0) / pieces, &at[2]);
    }
    smap_corner_of(w, i, j, at, p);
    smap_corner_of(w, j, i, at, q);
    smap_mix(p, q, w->low[e], p);
    smap_add_piece(w, o, side, last, p, i);
    smap_copy(p, last);
  }
  smap_mix(smap_end(w, back), smap_corner(w, back), w->low[e], p);
  smap_add_piece(w, o, side, last, p, i);
}
