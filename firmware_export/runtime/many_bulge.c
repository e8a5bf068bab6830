/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- sides of strips on rails: along a circle -------------------------------------------------------- */
/* On parallel axles the side of a strip is part of a circle: it is cut along tangents if it bulges into the strip,
 * along its chord if it bulges outwards. */
#define SMAP_PIECE 0.2f /* rad: longest piece of a side */

/* A corner of the side of the strip of an edge, from plane a to plane b: at the pitch of `middle`, where its rim's
 * tangent at the further of both ends comes to; 0 where it does not.  Of wheels that lean middle is not halfway along
 * the rim. */
static int smap_meet(const smap_many_work_t *w, uint8_t e, const float middle[3], const smap_aim_t *a,
                     const smap_aim_t *b, float out[3])
{
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  const float r = w->r[i] + w->low[e] * (w->r[j] - w->r[i]);
  const float before = a->s * middle[0] - a->c * middle[2], after = b->s * middle[0] - b->c * middle[2];
  const float least = before < after ? before : after, grown = r / (least > 0.0f ? least : 1.0f);
  smap_mix(w->p[i], w->p[j], w->low[e], out);
  out[0] += grown * middle[0];
  out[2] += grown * middle[2];
  return least > 0.0f;
}

/* A side from p to q bulges into the strip: corners on tangents, as many as it takes. */
static void smap_bulge(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e, smap_side_t *side,
                       const float p[3], const float q[3])
{
  const smap_aim_t *from = &w->facet[w->owner[e]].at, *to = &w->facet[w->owner[w->twin[e]]].at;
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  float count, turn, before = 0.0f, after, middle[3], last[3], a[3];
  const float pieces = smap_pieces(w, e, &turn);
  const float longest = turn * (1.0f / SMAP_PIECE);
  smap_aim_t here = *from, there;
  uint8_t k;
  count = pieces;
  if (longest < pieces) {
    count = 1.0f + (float)(int32_t)longest;
  }
  count = smap_is_cut(w, e) ? 1.0f : count;
  smap_copy(p, last);
  for (k = 1; (float)k <= count && smap_may(w, SMAP_COST_PIECE); k++) {
    after = 1.0f;
    there = *to;
    if ((float)(k + 1) <= count) {
      after = (float)(int32_t)((float)k * pieces / count + 0.5f) / pieces;
      smap_on_arc(w, i, j, from, to, after, &there);
    }
    smap_mix(from->n, to->n, 0.5f * (before + after), middle);
    if (!smap_meet(w, e, middle, &here, &there, a)) {
      w->full = 1;
    }
    smap_add_piece(w, o, side, last, a, i);
    before = after;
    smap_copy(a, last);
    here = there;
  }
  smap_add_piece(w, o, side, last, q, i);
}

/* Whether the side of the strip of an edge, from p to q, bulges into the strip. */
static uint8_t smap_bulges(const smap_many_work_t *w, uint8_t e, const float p[3], const float q[3])
{
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
  float middle[3], chord[3];
  smap_aim_t half;
  smap_on_arc(w, i, j, &w->facet[w->owner[e]].at, &w->facet[w->owner[w->twin[e]]].at, 0.5f, &half);
  smap_place(w, e, &half, middle);
  smap_cross(p, q, chord);
  return smap_dot(chord, middle) > 0.0f;
}

/* A side along a circle, or its chord where it bulges outwards. */
static void smap_curve(smap_many_work_t *w, smap_many_pose_t *o, uint8_t e, smap_side_t *side, const float p[3],
                      const float q[3])
{
  side->inwards = smap_bulges(w, e, p, q);
  if (side->inwards) {
    smap_bulge(w, o, e, side, p, q);
  } else {
    smap_add_piece(w, o, side, p, q, w->vertex[e]);
  }
}
