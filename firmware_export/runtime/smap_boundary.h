/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- boundary: the arcs around the rests and gaps of a posture --------------------------------------- */

/* Add the boundary of a rest: of each edge all but what holds of it. */
static void smap_bound_rest(smap_work_t *w, uint8_t r)
{
  uint8_t e;
  w->at->own[r] = w->at->arcs;
  for (e = w->at->first[r]; e < w->at->first[r + 1]; e++) {
    const uint8_t end = smap_after(w, e), i = w->contact[e], j = w->contact[end];
    const float *const a = w->corner[e], *const b = w->corner[end], low = w->low[e];
    float place[3];
    if (low > 1.0f) {
      smap_add_arc(w, e, a, b, i, j);
      continue;
    }
    w->at->own[r] = SMAP_NONE;
    if (low > 0.0f) {
      smap_mix(a, b, low, place);
      smap_add_arc(w, e, a, place, i, j);
    }
    if (w->low[w->twin[e]] > 0.0f) {
      smap_mix(b, a, w->low[w->twin[e]], place);
      smap_add_arc(w, e, place, b, i, j);
    }
  }
}

/* Add the side of a gap that begins at a part of its edge e, and ends at that of its edge b. */
static void smap_bound_side(smap_work_t *w, uint8_t wall, uint8_t e, uint8_t b, float part)
{
  const uint8_t end = smap_after(w, e), rear = smap_after(w, b);
  float p[3], q[3];
  smap_mix(w->corner[e], w->corner[end], part, p);
  smap_mix(w->corner[rear], w->corner[b], part, q);
  smap_add_arc(w, wall, p, q, w->contact[e], w->contact[e]);
}

/* Scale the walls of all corners to length 1.  That of a dot, whose direction is rounding's, lies where it bounds nothing. */
static void smap_unit_walls(smap_work_t *w)
{
  const float least = SMAP_DOT * w->map->size * w->map->size;
  uint8_t e;
  for (e = 0; e < w->at->first[w->at->rests]; e++) {
    float *const wall = w->region->wall[e];
    if (!(smap_dot(wall, wall) > least * least && smap_unit(wall))) {
      memcpy(wall, w->normal[w->rest[e]], sizeof w->normal[0]);
    }
  }
}

/* Find the gaps and the boundary of the rests that were added; 0 where there is no room for it. */
static int smap_close(smap_work_t *w)
{
  smap_layout_t *const at = w->at;
  const uint8_t corners = at->first[at->rests];
  uint8_t e, i, r, k;
  for (e = 0; e < corners; e++) {
    if (w->twin[e] != SMAP_NONE && w->twin[e] > e) {
      smap_find_gap(w, e);
    }
  }
  smap_unit_walls(w);
  for (i = 0; i < at->rests; i++) {
    const uint8_t from = at->arcs;
    if (w->island[i] != i) {
      continue;
    }
    for (r = i; r < at->rests; r++) {
      if (w->island[r] == i) {
        smap_bound_rest(w, r);
      }
    }
    for (k = 0; k < at->gaps; k++) {
      if (w->island[w->rest[at->gap[k].a]] == i && at->gap[k].left >= SMAP_MAX_CORNERS) {
        const smap_gap_t *const gap = &at->gap[k];
        smap_bound_side(w, gap->left, gap->a, gap->b, w->low[gap->a]);
        smap_bound_side(w, gap->right, gap->b, gap->a, w->low[gap->b]);
      }
    }
    for (r = i; r < at->rests; r++) {
      if (w->island[r] == i) {
        at->from[r] = from;
        at->till[r] = at->arcs;
      }
    }
  }
  for (r = 0; SMAP_PIVOTS > 0 && w->map->first[0] > 0 && at->rests > 1 && r < at->rests; r++) {
    at->nearly = SMAP_OVERLAP;
    at->own[r] = SMAP_NONE;
    at->from[r] = 0;
    at->till[r] = at->arcs;
  }
  return !w->full;
}
