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

/* A corner of the outline on the rim of i at the normal of a piece from one to another: on the rim, or
 * where its tangents meet if it bulges into the strip. */
static void exact_corner(const smap_many_work_t *w, uint16_t i, uint16_t j, const smap_aim_t *begin,
                         const smap_aim_t *here, const smap_aim_t *end, double out[3])
{
  double before[3], after[3], chord[3], across[3], half, other, cosine;
  smap_touch(w, i, here, out);
  if (!(w->r[i] > 0.0)) {
    return;
  }
  smap_touch(w, i, begin, before);
  smap_touch(w, i, end, after);
  smap_cross(before, after, chord);
  smap_touch(w, j, here, across);
  if (smap_dot(chord, out) * smap_dot(chord, across) <= 0.0) {
    return;
  }
  smap_minus(out, before, chord);
  half = smap_dot(chord, chord);
  smap_minus(after, out, chord);
  other = smap_dot(chord, chord);
  half = smap_root(other > half ? other : half) / w->r[i];
  cosine = 1.0 - 0.5 * half * half;
  smap_mix(w->p[i], out, 1.0 / (cosine > 0.5 ? cosine : 0.5), out);
}

static void exact_side(smap_many_work_t *w, smap_many_pose_t *o, uint16_t e, smap_side_t *side)
{
  const uint16_t i = w->vertex[e], j = w->vertex[w->next[e]], back = w->twin[e];
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[back]].at;
  const int pieces = exact_pieces(w, e);
  smap_aim_t before = *from, here, after;
  double last[3], p[3], q[3];
  int k;
  smap_mix(smap_corner(w, e), smap_end(w, e), w->low[e], last);
  for (k = 0; k < pieces && w->left; k++) {
    smap_on_arc(w, i, j, from, to, (k + 0.5) / pieces, &here);
    after = *to;
    if (k + 1 < pieces) {
      smap_on_arc(w, i, j, from, to, (k + 1.0) / pieces, &after);
    }
    exact_corner(w, i, j, &before, &here, &after, p);
    exact_corner(w, j, i, &before, &here, &after, q);
    smap_mix(p, q, w->low[e], p);
    smap_add_piece(w, o, side, last, p, i);
    smap_copy(p, last);
    before = after;
  }
  smap_mix(smap_end(w, back), smap_corner(w, back), w->low[e], p);
  smap_add_piece(w, o, side, last, p, i);
}
