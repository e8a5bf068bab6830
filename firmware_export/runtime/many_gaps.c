/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- gaps: where the robot rocks and is caught ------------------------------------------------------- */
/* Over which part of the segment between two rests the robot is caught, whichever way it rolls. */
#define SMAP_END 1e-4f      /* nearer to an end of a segment no balance is looked at */
#define SMAP_HAIR 5e-6f     /* parts of the segment that a limit of a gap is drawn in */

/* Let a gap be where the robot has rolled over edge e onto the facet beyond; it is 0 at p. */
static void smap_begin_gap(const smap_many_work_t *w, smap_row_t *roll, uint8_t e,
                           const float p[3], const float q[3], smap_held_t *o)
{
  o->home = w->owner[e];
  o->line = w->twin[e];
  o->rise[0] = smap_roll_over(w, roll, e, p, o->g[0]);
  o->rise[1] = smap_roll_over(w, roll, e, q, o->g[1]);
}

/* Over which part of an edge between two rests the robot is caught: of several the longest. */
static void smap_find_gap(smap_many_work_t *w, uint8_t e)
{
  const uint8_t back = w->twin[e];
  smap_held_t *const o = &w->bench->visit[0].held;
  smap_row_t *roll;
  float low, high;
  if (smap_chord(&w->facet[w->owner[e]].at, &w->facet[w->owner[back]].at) > w->map->rock_angle) {
    return;
  }
  roll = smap_roll(w, e);
  if (!(roll[SMAP_ANGLE][0] <= w->map->rock_angle)) {
    return;
  }
  o->low = SMAP_END;
  o->high = 1.0f - SMAP_END;
  o->before = o->after = o->spare = 0.0f;
  o->turned = roll[SMAP_ANGLE][0];
  smap_begin_gap(w, roll, e, smap_corner(w, e), smap_end(w, e), o);
  smap_hold_rest(w, back);
  if (!(o->low < o->high)) {
    return;
  }
  smap_begin_gap(w, smap_roll(w, e), back, smap_end(w, back), smap_corner(w, back), o);
  smap_hold_rest(w, e);
  low = o->low > SMAP_END ? o->low + SMAP_HAIR : 0.0f;
  high = o->high < 1.0f - SMAP_END ? o->high - SMAP_HAIR : 1.0f;
  if (high - low > o->spare) {
    w->low[e] = low;
    w->low[back] = 1.0f - high;
  }
}

/* The first edge from e on that lies between two rests; each arc has one. */
static uint8_t smap_between_rests(const smap_many_work_t *w, uint8_t e)
{
  for (; e < w->edges; e++) {
    const uint8_t back = w->twin[e];
    if (back > e && w->low[e] != SMAP_SHORT &&
        w->facet[w->owner[e]].kind == SMAP_REST && w->facet[w->owner[back]].kind == SMAP_REST) {
      break;
    }
  }
  return e;
}

/* Look for gaps as long as may be; what is not found in that time is none. */
static void smap_find_gaps(smap_many_work_t *w)
{
  const uint32_t all = w->left, most = SMAP_MOST(w->map, sought, SMAP_MANY_SOUGHT);
  const uint32_t part = all < most ? all : most;
  uint8_t e;
  if (!(w->map->rock_angle > 0.0f)) {
    return;
  }
  w->left = part;
  memset(w->strips, 0, sizeof w->strips);
  for (e = smap_between_rests(w, 0); e < w->edges && smap_may(w, SMAP_COST_GAP);
       e = smap_between_rests(w, (uint8_t)(e + 1u))) {
    if (w->map->rock_angle >= 3.1415f) {
      w->low[e] = w->low[w->twin[e]] = 0.0f;
    } else {
      smap_find_gap(w, e);
    }
    if (!w->left) {
      w->low[e] = w->low[w->twin[e]] = SMAP_OPEN;
    }
    if (smap_is_gap(w, e)) {
      w->strips[w->vertex[e]]++;
      w->strips[w->vertex[w->next[e]]]++;
    }
  }
#ifdef SMAP_HOST
  w->sought = part - w->left;
#endif
  w->left += all - part;
}
