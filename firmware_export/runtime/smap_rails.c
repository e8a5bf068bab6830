/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- rails: discs and points on parallel axes --------------------------------------------------------- */
#define SMAP_INLINE SMAP_SMALL
#define SMAP_UNROLL
#define SMAP_CODEC SMAP_CODEC_RAILS
#define SMAP_TRACKS SMAP_RAILS
#undef SMAP_DISCS
#define SMAP_DISCS 0 /* whose axes differ */
#define SMAP_STEERED_BY "smap_control_region.c"
#define SMAP_DRAWN_BY "smap_host_region.h"
#include "smap_joints.h"
#include "smap_boundary.h"
#include "smap_hull.h"

#define SMAP_TURNED 2.0f   /* times what a facet is bent at a track that turns walls may be off */
#define SMAP_BEFORE 0.96f  /* of the cosine of the steepest pitch: before any rest the history begins, */
#define SMAP_EARLIER 0.85f /* and looks for bends from here */
#define SMAP_BELOW 2e-5f   /* of the size: a facet has no contact as far below it */

/* How many contacts are on the plane that a contact touches, within the map's tolerance, or
 * SMAP_NONE where one is below it; `length`: of the plane's normal. */
static uint8_t smap_near(const smap_work_t *w, uint8_t i, const float plane[3], float length)
{
  const float s = plane[0], t = plane[1], c = plane[2];
  const float height = smap_level(w, i, s, c) + w->p[i][1] * t;
  float least = 0.0f;
  uint8_t near = 0, j;
  for (j = 0; j < SMAP_CONTACTS(w); j++) {
    const float above = height - smap_level(w, j, s, c) - w->p[j][1] * t;
    if (above <= w->map->tolerance * length) {
      near++;
      least = above < least ? above : least;
    }
  }
  return least >= -SMAP_BELOW * SMAP_SIZE(w) * length ? near : (uint8_t)SMAP_NONE;
}

/* Add the facet of the tracks list[0..last], if it is a rest.  `side` is its edge on the last track between the disc
 * that was there and the one that is now, and was that on the first track of the facet before it. */
static void smap_enter(smap_work_t *w, smap_hull_t *h, const uint8_t *list, uint8_t last, const float plane[3],
                       uint8_t *side)
{
  const float s = plane[0], c = plane[2];
  const float length = smap_root(1.0f + plane[1] * plane[1]), size = 1.0f / length;
  const float n[3] = {s * size, plane[1] * size, -c * size};
  float p[2 * SMAP_TRACKS][3];
  uint8_t id[2 * SMAP_TRACKS], track[2 * SMAP_TRACKS], count = 0, turns, j, k, before = *side, first;
  *side = SMAP_NONE;
  for (j = 0; j <= last; j++) { /* the way that was on the hull */
    k = list[j];
    if (h->was[k]) {
      id[count] = h->old[k];
      track[count++] = k;
    }
  }
  turns = count;
  for (j = (uint8_t)(last + 1u); j-- > 0;) { /* then back the way that is now */
    k = list[j];
    if (h->on[k] && !(h->was[k] && h->disc[k] == h->old[k] && (j == last || j == 0))) {
      id[count] = h->disc[k];
      track[count++] = k;
    }
  }
  for (j = 0; j < count; j++) {
    smap_touch_at(w, id[j], s, c, p[j]);
  }
  first = smap_add_rest(w, n, p, id, count, smap_near(w, id[0], plane, length));
  if (first != SMAP_NONE) {
    for (j = 0; j + 1 < turns; j++) {
      if (h->pend[track[j]] != SMAP_NONE) {
        smap_pair(w, h->pend[track[j]], (uint8_t)(first + j));
      }
    }
    if (track[count - 1] == track[0] && before != SMAP_NONE) {
      smap_pair(w, before, (uint8_t)(first + count - 1));
    }
    if (turns < count && track[turns] == track[turns - 1]) {
      *side = (uint8_t)(first + turns - 1);
    }
  }
  for (j = 0; j < last; j++) {
    h->pend[list[j]] = SMAP_NONE;
  }
  for (j = turns; first != SMAP_NONE && j <= count; j++) {
    const uint8_t end = j < count ? j : 0;
    if (track[end] != track[j - 1]) {
      h->pend[track[end]] = (uint8_t)(first + j - 1);
    }
  }
}

/* Add the facets at a pitch: of neighbours on the hull those on one line. */
static void smap_add_facets(smap_work_t *w, smap_hull_t *h, float s, float c)
{
  float level[SMAP_TRACKS + 1], y[SMAP_TRACKS + 1], plane[3] = {s, 0.0f, c};
  uint8_t list[SMAP_TRACKS + 1], n = 0, from, to, k, side = SMAP_NONE;
  for (k = 0; k < SMAP_TRACKS_OF(w); k++) {
    if (h->was[k] || h->on[k]) {
      level[n] = smap_level(w, h->old[k], s, c);
      y[n] = w->p[h->old[k]][1];
      list[n++] = k;
    }
  }
  for (from = 0; from + 1 < n; from = to) {
    const float first = (level[from + 1] - level[from]) / (y[from] - y[from + 1]);
    uint8_t any = h->bent[list[from]] | h->bent[list[from + 1]];
    for (to = (uint8_t)(from + 1); to + 1 < n; to++) {
      const float slope = (level[to + 1] - level[to]) / (y[to] - y[to + 1]);
      const float more = smap_absolute(slope - first);
      if (more > SMAP_UNITE) {
        if (h->was[list[to]] && h->on[list[to]]) {
          break;
        }
        w->region->guard += SMAP_TURNED * more; /* what turns at this pitch is of the facet, and all but on its plane */
      }
      any |= h->bent[list[to + 1]];
    }
    if (any || to > from + 1) {
      plane[1] = (level[to] - level[from]) / (y[from] - y[to]);
      smap_enter(w, h, list + from, (uint8_t)(to - from), plane, &side);
    } else {
      side = SMAP_NONE;
    }
  }
}

/* Put the contacts into the frame of the axis; find the disc of each track before any rest.  Returns the
 * sine of that pitch. */
static float smap_lay_out(smap_work_t *w, smap_hull_t *h)
{
  const smap_limits_t *const m = w->map;
  const float c = SMAP_BEFORE * m->steepest, s = -smap_root(1.0f - c * c);
  const float d = SMAP_EARLIER * m->steepest, early = -smap_root(1.0f - d * d);
  uint8_t k, i;
  if (SMAP_IS_TURNED(m)) {
    smap_turn(w->p, SMAP_CONTACTS(w), m->axis[0], m->axis[1]);
  }
  for (k = 0; k < SMAP_TRACKS_OF(w); k++) {
    const uint8_t first = SMAP_FIRST(w)[k], end = SMAP_FIRST(w)[k + 1];
    float most = -SMAP_LARGEST;
    h->disc[k] = first; /* of places that are no numbers, too */
    for (i = first; i < end; i++) {
      float level;
      w->p[i][1] = w->p[first][1];
      level = smap_level(w, i, s, c);
      if (level > most) {
        most = level;
        h->disc[k] = i;
      }
    }
    h->on[k] = 1;
    h->changed[k] = 0;
    h->pend[k] = SMAP_NONE;
    smap_next_bend(w, h, k, early);
  }
  smap_lay_hull(w, h, s, c);
  return s;
}

/* Add the rests of a posture. */
SMAP_APART static void smap_find_rests(smap_work_t *w)
{
  const uint8_t tracks = SMAP_TRACKS_OF(w);
  const float end = smap_root(1.0f - w->map->steepest * w->map->steepest);
  smap_hull_t h;
  float c, before = smap_lay_out(w, &h);
  uint8_t left, k;
  for (left = 255; left > 0; left--) {
    float s = SMAP_NEVER;
    for (k = 0; k < tracks; k++) {
      s = h.bend[k] < s ? h.bend[k] : s;
    }
    for (k = 1; k + 1 < tracks; k++) {
      const float turn = smap_turn_of(w, &h, k, h.changed[k] ? before + SMAP_ABOVE : before);
      s = turn < s ? turn : s;
    }
    if (s > end) {
      return;
    }
    c = smap_root(1.0f - s * s);
    before = s;
    if (smap_change(w, &h, s, c)) {
      smap_add_facets(w, &h, s, c);
    } else {
      before += SMAP_UNITE * c; /* rounding alone lets a track turn here */
    }
  }
  w->full = 1;
}

#include "smap_pose.h"
