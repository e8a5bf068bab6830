/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- sides of strips on any contacts: along any curve ------------------------------------------------ */
/* Where two wheels that touch at different paces carry, or a ball beside anything else, the side of what
 * they sweep is no circle, nor even bent one way only: its corners are traced, and drawn as a line that
 * bulges into the strip everywhere. */
#define SMAP_INDENT 2.5f /* of how far a piece is from its chord: how far the exact definition's corners may be */
#define SMAP_SAME 1e-12f /* the square of a sine: corners in one place */
#define SMAP_COST_CORNERS 54u /* a piece, and */
#define SMAP_COST_BACK 2u     /* one that is given up */

/* A corner that the exact definition has on the side of i, of a piece from one direction to another: where
 * i touches halfway, or beyond that where it bulges towards j. */
static void smap_corner_of(const smap_many_work_t *w, uint8_t i, uint8_t j, const smap_aim_t at[3],
                           float out[3])
{
  float before[3], after[3], d[3], chord[3], half, other;
  smap_touch(w, i, &at[1], out);
  if (!(w->r[i] > 0.0f)) {
    return;
  }
  smap_touch(w, i, &at[0], before);
  smap_touch(w, i, &at[2], after);
  smap_minus(after, before, d); /* of a short piece the cross product of its ends would lose digits */
  smap_cross(before, d, chord);
  smap_minus(out, before, d);
  half = smap_dot(d, d);
  other = smap_dot(chord, d);
  smap_touch(w, j, &at[1], before);
  if (!(other * smap_dot(chord, before) > 0.0f)) {
    return;
  }
  smap_minus(after, out, d);
  other = smap_dot(d, d);
  half = 1.0f - 0.5f * (other > half ? other : half) / (w->r[i] * w->r[i]);
  smap_mix(w->p[i], out, 1.0f / (half > 0.5f ? half : 0.5f), out);
}

/* A corner as far within the strip as any of the exact definition's, for a piece of the side. */
static void smap_indent(smap_many_work_t *w, uint8_t e, const smap_aim_t at[3], float out[3])
{
  float p[3], q[3], n[3], in = SMAP_LOST * smap_posture_size(w);
  uint8_t k;
  smap_place(w, e, &at[0], p);
  smap_place(w, e, &at[2], q);
  smap_place(w, e, &at[1], out);
  smap_mix(p, q, 0.5f, n);
  smap_minus(n, out, n);
  if (smap_dot(n, n) > in * in) {
    in = smap_root(smap_dot(n, n));
  }
  smap_minus(q, p, q);
  smap_cross(out, q, n);
  if (smap_scale(n, n)) {
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      out[k] += SMAP_INDENT * in * n[k];
    }
  }
}

/* Draw a side on to a corner that bulges into the strip at all corners: what is left of it on the way is
 * given up.  A corner in the same place as the last has no direction of its own. */
static void smap_draw(smap_many_work_t *w, smap_many_pose_t *o, smap_side_t *side, const float to[3],
                      uint8_t i)
{
  float corner[3], d[3];
  if (w->full || !smap_scale(to, corner)) {
    w->full = 1;
    return;
  }
  smap_minus(corner, o->point[o->at.points - 1], d);
  while (side->end > side->wall && (smap_dot(o->wall[side->end - 1], corner) > 0.0f || smap_dot(d, d) < SMAP_SAME) &&
         smap_may(w, SMAP_COST_BACK)) {
    o->at.walls = --side->end;
    o->at.points--;
    smap_minus(corner, o->point[o->at.points - 1], d);
  }
  if (!(smap_dot(d, d) < SMAP_SAME)) {
    smap_add_piece(w, o, side, o->point[o->at.points - 1], corner, i);
  }
}

/* A side to q along any curve.  Its corners are those that the exact definition has, or, where it is not
 * known how often that cuts the side, lie as far within the strip as those may; and of the side only that
 * counts which bulges into the strip. */
static void smap_curve(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e, smap_side_t *side, const float p[3],
                       const float q[3])
{
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[w->twin[e]]].at;
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  float turn, a[3], b[3];
  const float count = smap_pieces(w, e, &turn);
  const int known = turn > 0.0f && !smap_is_cut(w, e);
  smap_aim_t at[3];
  uint8_t k;
  (void)p; /* the pose's last point */
  at[2] = *from;
  for (k = 1; (float)k <= count && smap_may(w, SMAP_COST_CORNERS); k++) {
    at[0] = at[2];
    at[2] = *to;
    smap_on_arc(w, i, j, from, to, ((float)k - 0.5f) / count, &at[1]);
    if ((float)(k + 1) <= count) {
      smap_on_arc(w, i, j, from, to, (float)k / count, &at[2]);
    }
    if (known) {
      smap_corner_of(w, i, j, at, a);
      smap_corner_of(w, j, i, at, b);
      smap_mix(a, b, w->low[e], a);
    } else {
      smap_indent(w, e, at, a);
    }
    smap_draw(w, o, side, a, i);
  }
  smap_draw(w, o, side, q, i);
  side->inwards = 1;
  w->full = w->full || side->end == side->wall; /* seen from the com it has no width */
}
