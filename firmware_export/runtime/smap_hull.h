/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- hull: the tracks that carry at a pitch, and their discs ------------------------------------- */
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
#define SMAP_RECESS 3e-7f  /* of the size: inner tracks count as this much lower */
#define SMAP_ABOVE 1e-6f   /* of the size: no further is a track above a chord by rounding */
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
  const float *const p = w->p[i], r = w->r[i], x = p[0] + r * s, z = p[2] - r * c;
  out[1] = p[1];
  out[0] = x;
  out[2] = z;
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
  const uint8_t i = h->disc[k], end = SMAP_FIRST(w)[k + 1];
  const float least = 1e-12f * SMAP_SIZE(w) * SMAP_SIZE(w);
  float bend = SMAP_NEVER;
  uint8_t onto = i, j;
  for (j = SMAP_FIRST(w)[k]; j < end; j++) {
    const float s = smap_rises(w->p[j][0] - w->p[i][0], w->p[j][2] - w->p[i][2],
                               w->r[j] - w->r[i], s0, least);
    if (s < bend) {
      bend = s;
      onto = j;
    }
  }
  h->bend[k] = bend;
  h->onto[k] = onto;
}

/* Where the inner track k leaves the hull, or enters it. */
static float smap_turn_of(const smap_work_t *w, const smap_hull_t *h, uint8_t k, float s0)
{
  const float size = SMAP_SIZE(w), sign = h->on[k] ? -1.0f : 1.0f;
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
  if (tracks < 3) {
    return; /* two always are */
  }
  for (k = 0; k < tracks; k++) {
    const uint8_t i = h->disc[k];
    const float recess = k > 0 && k + 1 < tracks ? SMAP_RECESS * SMAP_SIZE(w) : 0.0f;
    const float high = smap_level(w, i, s, c) - recess;
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

/* Let all that changes at a pitch change: bends, and which tracks are on the hull.  Returns
 * whether any has. */
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
