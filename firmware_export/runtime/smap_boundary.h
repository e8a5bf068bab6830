/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
#include "smap_gaps.h"
/* ---- boundary: the arcs around the rests and gaps of a posture --------------------------------------- */

/* Add the boundary of a rest: of each edge all but what holds of it. */
static void smap_bound_rest(smap_work_t *w, uint8_t r)
{
  const uint8_t behind = w->at->first[r + 1];
  uint8_t e;
  w->at->own[r] = w->at->arcs;
  for (e = w->at->first[r]; e < behind; e++) {
    const uint8_t end = w->next[e], i = w->contact[e], j = w->contact[end];
    if (w->upto[e] != SMAP_NONE) {
      smap_add_arc(w, e, e, w->upto[e], i, j);
    }
    if (w->onward[e] != SMAP_NONE) {
      smap_add_arc(w, e, w->onward[e], end, i, j);
    }
    if (w->upto[e] != end) {
      w->at->own[r] = SMAP_NONE;
    }
  }
}

/* Scale places and the walls of all corners to length 1.  That of a dot, whose direction is rounding's, lies where it
 * bounds nothing. */
static void smap_unit_all(smap_work_t *w)
{
  const float least = SMAP_DOT * SMAP_SIZE(w) * SMAP_SIZE(w);
  const uint8_t places = w->at->places, corners = w->at->first[w->at->rests];
  smap_region_t *const o = w->region;
  uint8_t e;
  for (e = 0; e < places; e++) {
    (void)smap_unit(o->place[e]);
  }
  for (e = 0; e < corners; e++) {
    float *const wall = o->wall[e];
    if (!(smap_dot(wall, wall) > least * least && smap_unit(wall))) {
      memcpy(wall, w->normal[w->rest[e]], sizeof w->normal[0]);
    }
  }
}

/* Find the gaps and the boundary of the rests that were added; 0 where there is no room for it. */
SMAP_APART static int smap_close(smap_work_t *w)
{
  smap_layout_t *const at = w->at;
  const uint8_t corners = at->first[at->rests];
  uint8_t e, i, r, k;
  at->places = corners;
  for (e = 0; e < corners; e++) {
    if (w->twin[e] != SMAP_NONE && w->twin[e] > e) {
      smap_find_gap(w, e);
    }
  }
  smap_unit_all(w);
  for (i = 0; i < at->rests; i++) {
    if (w->island[i] != i) {
      at->from[i] = at->from[w->island[i]];
      at->till[i] = at->till[w->island[i]];
      continue;
    }
    at->from[i] = at->arcs;
    for (r = i; r < at->rests; r++) {
      if (w->island[r] == i) {
        smap_bound_rest(w, r);
      }
    }
    for (k = 0; k < at->gaps; k++) {
      const smap_gap_t *const gap = &at->gap[k];
      const uint8_t p = gap->place, a = w->contact[gap->a], b = w->contact[gap->b];
      if (w->island[w->rest[gap->a]] == i) {
        smap_add_arc(w, gap->side, p, (uint8_t)(p + 1u), a, a);
        smap_add_arc(w, (uint8_t)(gap->side + 1u), (uint8_t)(p + 3u), (uint8_t)(p + 2u), b, b);
      }
    }
    at->till[i] = at->arcs;
  }
  for (r = 0; SMAP_PIVOTS > 0 && w->map->first[0] > 0 && at->rests > 1 && r < at->rests; r++) {
    at->nearly = SMAP_OVERLAP;
    at->own[r] = SMAP_NONE;
    at->from[r] = 0;
    at->till[r] = at->arcs;
  }
  return !w->full;
}
