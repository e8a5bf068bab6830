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
#include "smap_region.h"
#include "smap_landing.h"
#include "smap_gaps.h"
#include "smap_boundary.h"

/* Rests of discs and points on parallel axes: the history of a hull over pitch.
 *
 *   Contacts at one y are a track, from the left to the right; its level at a pitch is L = max (x s - z c + r),
 *   with sine s and cosine c of the pitch.  Two tracks carry where they are neighbours on the upper hull of (y, L):
 *       L ^     o-------o          As the pitch grows a track goes on to another disc (a bend), or leaves the hull, or
 *         |    /         `-o       enters it.  At each such event all that is on one line there makes up a facet:
 *         |   o   x (off)  |       its corners are the discs that were on the hull, and those that are now.
 *         +---------------------> right
 * A facet's plane is s x + t y - c z = h |(s, t, -c)|, with the slope t of that line. */
#define SMAP_UNITE 2e-5f   /* rad: changes that are nearer are one facet's */
#define SMAP_TURNED 2.0f   /* times what a facet is bent at a track that turns walls may be off */
#define SMAP_RECESS 3e-7f  /* of the size: inner tracks count as this much lower */
#define SMAP_ABOVE 1e-6f   /* of the size: no further is a track above a chord by rounding */
#define SMAP_BEFORE 0.96f  /* of the cosine of the steepest pitch: before any rest the history begins, */
#define SMAP_EARLIER 0.85f /* and looks for bends from here */
#define SMAP_NEVER 2.0f

/* `was` and `old` are from before the pitch that is looked at.  pend: the edge from a track to the next one on the
 * hull, of the rest that both left last. */
typedef struct {
  float bend[SMAP_TRACKS];
  uint8_t disc[SMAP_TRACKS], onto[SMAP_TRACKS], on[SMAP_TRACKS], was[SMAP_TRACKS], old[SMAP_TRACKS];
  uint8_t bent[SMAP_TRACKS], changed[SMAP_TRACKS], pend[SMAP_TRACKS];
} smap_hull_t;

SMAP_INLINE float smap_level(const smap_work_t *w, uint8_t i, float s, float c)
{
  return w->p[i][0] * s - w->p[i][2] * c + w->r[i];
}

/* Where a contact touches a plane of a pitch. */
SMAP_INLINE void smap_touch_at(const smap_work_t *w, uint8_t i, float s, float c, float out[3])
{
  out[0] = w->p[i][0] + w->r[i] * s;
  out[1] = w->p[i][1];
  out[2] = w->p[i][2] - w->r[i] * c;
}

static void smap_touch(const smap_work_t *w, uint8_t i, const float n[3], float out[3])
{
  const float size = 1.0f / smap_root(n[0] * n[0] + n[2] * n[2]);
  smap_touch_at(w, i, n[0] * size, -n[2] * size, out);
}

/* The sine at which x s - z c + q, with c = root(1 - s^2), rises through zero behind s0. */
static float smap_rises(float x, float z, float q, float s0, float least)
{
  const float d2 = x * x + z * z, w2 = d2 - q * q;
  float w, s;
  if (!(w2 > least)) {
    return SMAP_NEVER;
  }
  w = smap_root(w2);
  if (!(w * x + q * z > 0.0f)) {
    return SMAP_NEVER;
  }
  s = (w * z - q * x) / d2;
  return s > s0 ? s : SMAP_NEVER;
}

/* Find the next disc of a track behind the pitch of sine s0. */
static void smap_next_bend(const smap_work_t *w, smap_hull_t *h, uint8_t k, float s0)
{
  const uint8_t i = h->disc[k], end = w->map->first[k + 1];
  const float least = 1e-12f * w->map->size * w->map->size;
  uint8_t j;
  h->bend[k] = SMAP_NEVER;
  for (j = w->map->first[k]; j < end; j++) {
    const float s = smap_rises(w->p[j][0] - w->p[i][0], w->p[j][2] - w->p[i][2], w->r[j] - w->r[i], s0, least);
    if (s < h->bend[k]) {
      h->bend[k] = s;
      h->onto[k] = j;
    }
  }
}

/* Where the inner track k leaves the hull, or enters it. */
static float smap_turn_of(const smap_work_t *w, const smap_hull_t *h, uint8_t k, float s0)
{
  const float size = w->map->size, sign = h->on[k] ? -1.0f : 1.0f;
  uint8_t a = k, b = k, d = h->disc[k];
  const float *p = w->p[d], *pa, *pb;
  float part, rest, x, z, q;
  while (!h->on[--a]) { /* the first and the last always are */
  }
  while (!h->on[++b]) {
  }
  a = h->disc[a];
  b = h->disc[b];
  pa = w->p[a];
  pb = w->p[b];
  part = (p[1] - pb[1]) / (pa[1] - pb[1]);
  rest = 1.0f - part;
  x = sign * (p[0] - part * pa[0] - rest * pb[0]);
  z = sign * (p[2] - part * pa[2] - rest * pb[2]);
  q = sign * (w->r[d] - part * w->r[a] - rest * w->r[b] - SMAP_RECESS * size);
  if (x * s0 - z * smap_root(1.0f - s0 * s0) + q > SMAP_ABOVE * size) {
    return s0;
  }
  return smap_rises(x, z, q, s0, 1e-12f * size * size);
}

/* Find which tracks are on the upper hull of the levels at a pitch. */
static void smap_lay_hull(const smap_work_t *w, smap_hull_t *h, float s, float c)
{
  const uint8_t tracks = SMAP_TRACKS_OF(w);
  float level[SMAP_TRACKS], y[SMAP_TRACKS];
  uint8_t list[SMAP_TRACKS], n = 0, k;
  for (k = 0; tracks > 2 && k < tracks; k++) { /* two always are */
    const uint8_t i = h->disc[k];
    const float high = smap_level(w, i, s, c) - (k > 0 && k + 1 < tracks ? SMAP_RECESS * w->map->size : 0.0f);
    while (n > 1 && (level[n - 1] - level[n - 2]) * (y[n - 1] - w->p[i][1]) <=
                        (high - level[n - 1]) * (y[n - 2] - y[n - 1])) {
      n--;
    }
    level[n] = high;
    y[n] = w->p[i][1];
    list[n++] = k;
    h->on[k] = 0;
  }
  while (n > 0) {
    h->on[list[--n]] = 1;
  }
}

/* Add the facet of the tracks list[0..last], if it is a rest.  `side` is its edge on the last track between the disc
 * that was there and the one that is now, and was that on the first track of the facet before it. */
static void smap_enter(smap_work_t *w, smap_hull_t *h, const uint8_t *list, uint8_t last, const float plane[3],
                       uint8_t *side)
{
  const float s = plane[0], c = plane[2], size = 1.0f / smap_root(1.0f + plane[1] * plane[1]);
  const float n[3] = {s * size, plane[1] * size, -c * size};
  float p[2 * SMAP_TRACKS][3], extent[SMAP_MAX_CONTACTS];
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
  for (j = 0; j < SMAP_CONTACTS(w); j++) {
    extent[j] = (smap_level(w, j, s, c) + w->p[j][1] * plane[1]) * size;
  }
  first = smap_add_rest(w, n, p, id, count, extent, 0);
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

/* Let all that changes at a pitch change: bends, and which tracks are on the hull.  Returns whether any has. */
static int smap_change(const smap_work_t *w, smap_hull_t *h, float s, float c)
{
  const uint8_t tracks = SMAP_TRACKS_OF(w);
  const float later = s + 1.5f * SMAP_UNITE * c;
  uint8_t k, left, any = 0;
  memcpy(h->was, h->on, sizeof h->was);
  memcpy(h->old, h->disc, sizeof h->old);
  for (k = 0; k < tracks; k++) {
    h->bent[k] = 0;
    for (left = SMAP_MAX_CONTACTS; left > 0 && h->bend[k] <= s + SMAP_UNITE * c; left--) {
      h->disc[k] = h->onto[k];
      h->bent[k] = any = 1;
      smap_next_bend(w, h, k, h->bend[k]);
    }
  }
  smap_lay_hull(w, h, later, smap_root(1.0f - later * later));
  for (k = 1; k + 1 < tracks; k++) {
    h->changed[k] = h->on[k] != h->was[k];
    any |= h->changed[k];
  }
  return any;
}

/* The slope of the line through two of some tracks. */
SMAP_INLINE float smap_slope(const smap_work_t *w, const smap_hull_t *h, const uint8_t *list, const float *level,
                             uint8_t a, uint8_t b)
{
  return (level[b] - level[a]) / (w->p[h->old[list[a]]][1] - w->p[h->old[list[b]]][1]);
}

/* Add the facets at a pitch: of neighbours on the hull those on one line. */
static void smap_add_facets(smap_work_t *w, smap_hull_t *h, float s, float c)
{
  float level[SMAP_TRACKS + 1], plane[3] = {s, 0.0f, c};
  uint8_t list[SMAP_TRACKS + 1], n = 0, from, to, k, side = SMAP_NONE;
  for (k = 0; k < SMAP_TRACKS_OF(w); k++) {
    if (h->was[k] || h->on[k]) {
      level[n] = smap_level(w, h->old[k], s, c);
      list[n++] = k;
    }
  }
  for (from = 0; from + 1 < n; from = to) {
    const float first = smap_slope(w, h, list, level, from, (uint8_t)(from + 1));
    uint8_t any = h->bent[list[from]] | h->bent[list[from + 1]];
    for (to = (uint8_t)(from + 1); to + 1 < n; to++) {
      const float more = smap_absolute(smap_slope(w, h, list, level, to, (uint8_t)(to + 1)) - first);
      if (more > SMAP_UNITE) {
        if (h->was[list[to]] && h->on[list[to]]) {
          break;
        }
        w->region->guard += SMAP_TURNED * more; /* what turns at this pitch is of the facet, and all but on its plane */
      }
      any |= h->bent[list[to + 1]];
    }
    if (any || to > from + 1) {
      plane[1] = smap_slope(w, h, list, level, from, to);
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
  for (k = 0; k < SMAP_TRACKS_OF(w); k++) {
    const uint8_t first = m->first[k];
    float most = -SMAP_LARGEST;
    h->disc[k] = first; /* of places that are no numbers, too */
    for (i = first; i < m->first[k + 1]; i++) {
      const float x = w->p[i][0], y = w->p[i][1];
      float level;
      w->p[i][0] = x * m->axis[1] - y * m->axis[0];
      w->p[i][1] = i == first ? x * m->axis[0] + y * m->axis[1] : w->p[first][1];
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

#include "smap_reading.h"
#include "smap_reading_i.h"
#include "smap_pose.h"
