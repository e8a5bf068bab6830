/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Sides of gaps, cut into pieces as the definition cuts them (lutgen/support/tiles.py): the runtime takes
 * fewer and longer ones, which lose a little more of the gap. */

#define EXACT_STILL 1e-4 /* rad: a strip whose contacts go as far along their rims is not cut */

/* Into how many pieces the strip of an edge is cut. */
static int exact_pieces(smap_many_work_t *w, uint16_t e)
{
  double turn;
  const int pieces = (int)smap_pieces(w, e, &turn);
  return pieces > 1 ? pieces : turn > EXACT_STILL;
}

/* The walls of the side of the strip of an edge from p to q, over all corners that the definition has. */
static void exact_side(smap_many_work_t *w, smap_many_pose_t *o, uint16_t e, smap_side_t *side,
                       const double p[3], const double q[3])
{
  const uint16_t i = w->vertex[e], j = w->vertex[w->next[e]];
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[w->twin[e]]].at;
  const int pieces = exact_pieces(w, e);
  smap_aim_t at[3];
  double last[3], here[3], there[3];
  int k;
  smap_on_arc(w, i, j, from, to, 0.5, &at[1]);
  smap_place(w, e, &at[1], here);
  smap_cross(p, q, there);
  side->inwards = smap_dot(there, here) > 0.0;
  at[2] = *from;
  smap_copy(p, last);
  for (k = 0; k < pieces && w->left; k++) {
    at[0] = at[2];
    at[2] = *to;
    smap_on_arc(w, i, j, from, to, (k + 0.5) / pieces, &at[1]);
    if (k + 1 < pieces) {
      smap_on_arc(w, i, j, from, to, (k + 1.0) / pieces, &at[2]);
    }
    smap_corner_of(w, i, j, at, here);
    smap_corner_of(w, j, i, at, there);
    smap_mix(here, there, w->low[e], here);
    smap_add_piece(w, o, side, last, here, i);
    smap_copy(here, last);
  }
  smap_add_piece(w, o, side, last, q, i);
}
