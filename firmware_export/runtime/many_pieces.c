/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- pieces: how the sides of strips are cut --------------------------------------------------------- */
/* A side of a strip is cut into pieces that lose a little of the strip and add nothing to it; how many of
 * them the exact definition has tells how much it loses itself. */
#define SMAP_LOST 2e-4f /* of the posture's size: what the exact definition's pieces lose */
#define SMAP_PIECES 12.0f
#define SMAP_DIGITS 1e-4f /* of a piece: what rounding may alter */

/* A posture's size, as the exact definition has it for its pieces: how far any contact reaches from the
 * recipe's first. */
static float smap_posture_size(smap_many_work_t *w)
{
  const uint8_t contacts = smap_contacts_of(w->map);
  float d[3], reach;
  uint8_t k, first = 0;
  if (w->posture > 0.0f) {
    return w->posture;
  }
  for (k = 1; k < contacts; k++) {
    first = w->map->named[k] == 0 ? k : first;
  }
  for (k = 0; k < contacts; k++) {
    smap_minus(w->p[k], w->p[first], d);
    reach = smap_root(smap_dot(d, d)) + w->r[k];
    w->posture = reach > w->posture ? reach : w->posture;
  }
  return w->posture;
}

/* How many pieces the exact definition cuts the strip of an edge into; `turn` is by how much the
 * contacts go on along their rims (rad), 0 where last digits decide on that number. */
static float smap_pieces(smap_many_work_t *w, uint8_t e, float *turn)
{
  const uint8_t back = w->twin[e], contact[2] = {w->vertex[e], w->vertex[w->next[e]]};
  const float lost = SMAP_LOST * smap_posture_size(w);
  float most = 0.0f, d[3], n;
  uint8_t k;
  *turn = 0.0f;
  for (k = 0; k < 2; k++) {
    const float r = w->r[contact[k]];
    if (r > 0.0f) {
      float chord2;
      smap_minus(k ? smap_end(w, e) : smap_corner(w, e), k ? smap_corner(w, back) : smap_end(w, back),
                 d);
      chord2 = smap_dot(d, d) / r;
      most = chord2 > most ? chord2 : most;
      n = smap_root(chord2 / r);
      *turn = n > *turn ? n : *turn;
    }
  }
  most *= 0.125f / lost;
  if (most <= 1.0f) {
    return 1.0f;
  }
  n = smap_root(most);
  if (!(n < SMAP_PIECES - 0.5f)) {
    return SMAP_PIECES;
  }
  /* from here on a number */
  if (smap_absolute(n - (float)(int32_t)(n + 0.5f)) < SMAP_DIGITS) {
    *turn = 0.0f; /* the last digits decide: of the pieces only both ends are known, as with one of them */
  }
  return n < SMAP_PIECES - 1.0f ? 1.0f + (float)(int32_t)n : SMAP_PIECES;
}

/* Where the side of the strip of an edge is on a plane. */
static void smap_place(const smap_many_work_t *w, uint8_t e, const smap_aim_t *at, float out[3])
{
  float p[3], q[3];
  smap_touch(w, w->vertex[e], at, p);
  smap_touch(w, w->vertex[w->next[e]], at, q);
  smap_mix(p, q, w->low[e], out);
}

/* The last point of a side, of those that there are. */
static inline uint8_t smap_last_point(const smap_many_pose_t *o, const smap_side_t *side)
{
  const uint8_t last = (uint8_t)(side->point + (side->end - side->wall));
  return last < o->at.points ? last : side->point;
}

/* Append a piece of a side: a wall from the last point to one more. */
static void smap_add_piece(smap_many_work_t *w, smap_many_pose_t *o, smap_side_t *side,
                           const float p[3], const float q[3], uint8_t i)
{
  float along[3], n[3];
  smap_minus(q, p, along); /* of a short piece p x q would lose the digits that make it go through p */
  smap_cross(p, along, n);
  (void)smap_add_wall(w, o, n, i, i);
  (void)smap_add_point(w, o, q);
  side->end = o->at.walls;
}

/* Whether another strip may cut that of an edge: they have a wheel in common, and more than two rails.  The
 * exact definition cuts the side there, and of its tangents only those at both ends are known. */
static inline int smap_is_cut(const smap_many_work_t *w, uint8_t e)
{
  const uint8_t i = w->vertex[e], j = w->vertex[w->next[e]];
#if SMAP_MANY_RAILS
  return smap_rails_of(w->map) != 2 && (w->strips[i] > 1 || w->strips[j] > 1);
#else
  return (w->strips[i] > 1 && smap_is_disc(w, i)) || (w->strips[j] > 1 && smap_is_disc(w, j));
#endif
}
