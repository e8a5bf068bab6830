/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- boundary: the arcs around the rests and gaps of a posture --------------------------------------- */

/* The direction of a part of the way from one place to another. */
static void smap_way_to(const float p[3], const float q[3], float part, float out[3])
{
  smap_mix(p, q, part, out);
  (void)smap_unit(out);
}

/* Add what is boundary of the edge e of a rest, from direction a to b: all but what holds of it. */
static void smap_bound(smap_work_t *w, uint8_t e, const float a[3], const float b[3])
{
  const uint8_t end = smap_after(w, e), i = w->contact[e], j = w->contact[end];
  float r[3];
  if (w->low[e] > 1.0f) {
    smap_add_arc(w, e, a, b, i, j);
    return;
  }
  if (w->low[e] > 0.0f) {
    smap_way_to(w->corner[e], w->corner[end], w->low[e], r);
    smap_add_arc(w, e, a, r, i, j);
  }
  if (w->low[w->twin[e]] > 0.0f) {
    smap_way_to(w->corner[end], w->corner[e], w->low[w->twin[e]], r);
    smap_add_arc(w, e, r, b, i, j);
  }
}

/* Add the boundary of a rest. */
static void smap_bound_rest(smap_work_t *w, uint8_t r)
{
  const uint8_t first = w->at->first[r], end = w->at->first[r + 1];
  float a[3], b[3];
  uint8_t e;
  w->at->own[r] = w->at->arcs;
  memcpy(a, w->corner[first], sizeof a);
  (void)smap_unit(a);
  for (e = first; e < end; e++) {
    const uint8_t next = e + 1 < end ? (uint8_t)(e + 1) : first;
    memcpy(b, w->corner[next], sizeof b);
    (void)smap_unit(b);
    if (!(w->low[e] > 1.0f)) {
      w->at->own[r] = SMAP_NONE;
    }
    smap_bound(w, e, a, b);
    memcpy(a, b, sizeof a);
  }
}

/* Add both sides of a gap to the boundary. */
static void smap_bound_sides(smap_work_t *w, const smap_gap_t *gap)
{
  const uint8_t a = gap->a, b = gap->b, end = smap_after(w, a), rear = smap_after(w, b);
  const float low = w->low[a], high = w->low[b];
  float p[3], q[3];
  smap_way_to(w->corner[a], w->corner[end], low, p);
  smap_way_to(w->corner[rear], w->corner[b], low, q);
  smap_add_arc(w, gap->left, p, q, w->contact[a], w->contact[a]);
  smap_way_to(w->corner[end], w->corner[a], high, p);
  smap_way_to(w->corner[b], w->corner[rear], high, q);
  smap_add_arc(w, gap->right, q, p, w->contact[end], w->contact[end]);
}

/* Scale the walls of all corners to length 1.  Rounding tells how the wall of a dot lies: it gets the next one. */
static void smap_unit_walls(smap_work_t *w)
{
  const float least = SMAP_DOT * w->map->size * w->map->size;
  float(*const wall)[3] = w->region->wall;
  uint8_t r, e;
  for (r = 0; r < w->at->rests; r++) {
    const uint8_t first = w->at->first[r], end = w->at->first[r + 1];
    uint8_t next = SMAP_NONE, dots = 0; /* next: the first wall of all, and then the one behind e */
    for (e = end; e-- > first;) {
      if (smap_dot(wall[e], wall[e]) > least * least && smap_unit(wall[e])) {
        next = e;
      } else {
        memset(wall[e], 0, sizeof wall[e]);
        dots = 1;
      }
    }
    w->full |= (uint8_t)(next == SMAP_NONE);
    for (e = end; dots && next != SMAP_NONE && e-- > first;) {
      if (smap_dot(wall[e], wall[e]) > 0.0f) {
        next = e;
      } else {
        memcpy(wall[e], wall[next], sizeof wall[e]);
      }
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
        smap_bound_sides(w, &at->gap[k]);
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
