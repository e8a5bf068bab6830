/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- facets of discs and points on parallel axes ----------------------------------------------------- */
/* Facets of discs and points on parallel axes: the history of a hull over pitch.
 *
 *   Contacts at one y are a rail; its level at a pitch is L = max (x s - z c + r).  Two rails carry
 *   the robot where they are neighbours on the upper hull of the points (y, L):
 *
 *       L ^     o-------o          As the pitch grows a rail goes on to another disc (a bend), or
 *         |    /         `-o       leaves the hull, or enters it.  Each such event is a facet, and
 *         |   o   x (off)  |       between two of them that have a pair of rails in common there
 *         +---------------------> y is an arc.
 *
 * With u = tan(pitch / 2) an event is the root of a quadratic.  Whether it is past is told by its
 * roots and never by its value, so that what ends at a root has ended there; rails that are on the
 * wrong side of the hull change at once.  A facet's plane is s x + t y - c z = h |(s, t, -c)|, with
 * sine s and cosine c of its pitch and its slope t.
 */
#define SMAP_NEVER 2.0f
#define SMAP_RECESS 3e-7f /* of the size: inner rails count as this much higher */
#define SMAP_ON 4e-6f     /* of tan(pitch / 2): this far apart are changes of one rail */
#define SMAP_FAR 1e30f
#define SMAP_IS_NONE(first) ((first) > SMAP_MANY_EDGES - 3) /* no facet's first of three edges: SMAP_NONE is none */
#define SMAP_EVENTS 250 /* of one history, at most */
#define SMAP_BEFORE 0.9f /* of the cosine of the steepest pitch: before any facet the history begins */

typedef struct {
  float bend[SMAP_MANY_RAILS], changed[SMAP_MANY_RAILS];
  uint8_t disc[SMAP_MANY_RAILS], onto[SMAP_MANY_RAILS], on[SMAP_MANY_RAILS];
  uint8_t own[SMAP_MANY_RAILS]; /* the edge at which the arc to the next rail began */
  float turn[SMAP_MANY_RAILS];  /* where an inner rail leaves the hull or enters it, once it is looked for */
} smap_hull_t;

#define SMAP_ROUNDED 3e-6f /* what rounding does to a place (u) */

/* The first place from u on where x s - z c + q is above zero. */
static float smap_crossing(float x, float z, float q, float u)
{
  const float rest = x * x + z * z - q * q;
  float s, t, grows, sinks;
  int above;
  if (!(rest > 0.0f)) {
    return q > 0.0f ? u : SMAP_NEVER;
  }
  s = smap_root(rest);
  t = q + z;
  if (x < 0.0f || (x == 0.0f && z < 0.0f)) {
    s = s - x;
    sinks = (q - z) / s;
    grows = t != 0.0f ? s / t : SMAP_FAR;
  } else {
    s = -(s + x);
    grows = (q - z) / s;
    sinks = t != 0.0f ? s / t : SMAP_FAR;
  }
  above = grows <= sinks ? grows <= u && u < sinks : u >= grows || u < sinks;
  if (above) {
    return u;
  }
  return u < grows && grows <= 1.0f ? grows : SMAP_NEVER;
}

/* Where rail k goes on from its disc, and onto which. */
static void smap_next_bend(const smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u)
{
  const uint8_t i = o->disc[k];
  uint8_t j;
  o->bend[k] = SMAP_NEVER;
  o->onto[k] = i;
  for (j = w->map->first[k]; j < w->map->first[k + 1]; j++) {
    const float x = w->p[j][0] - w->p[i][0], z = w->p[j][2] - w->p[i][2], q = w->r[j] - w->r[i];
    float at;
    if (j == i || (x < 0.0f && q == 0.0f)) { /* of one size: it has been left behind */
      continue;
    }
    /* One that sinks is above by rounding alone: wheels of one size in a row would take turns. */
    at = x * (1.0f - u * u) + 2.0f * z * u < 0.0f ? u + SMAP_ROUNDED : u;
    at = smap_crossing(x, z, q, at);
    if (at < o->bend[k]) {
      o->bend[k] = at;
      o->onto[k] = j;
    } else if (at == o->bend[k] && at < SMAP_NEVER) {
      /* Touched at once: the one further along carries on. */
      const uint8_t b = o->onto[k];
      const float ahead = (w->p[j][0] - w->p[b][0]) * (1.0f - at * at);
      if (ahead + (w->p[j][2] - w->p[b][2]) * 2.0f * at > 0.0f) {
        o->onto[k] = j;
      }
    }
  }
}

/* The rail on the hull before rail k, or SMAP_NONE for the first, which is always on it. */
static uint8_t smap_before(const smap_hull_t *o, uint8_t k)
{
  if (k == 0) {
    return SMAP_NONE;
  }
  for (k--; k > 0 && !o->on[k]; k--) {
  }
  return k;
}

/* The one after it, or SMAP_NONE for the last, which is always on it. */
static uint8_t smap_after(const smap_hull_t *o, uint8_t rails, uint8_t k)
{
  if (k + 1 >= rails) {
    return SMAP_NONE;
  }
  for (k++; k + 1 < rails && !o->on[k]; k++) {
  }
  return k;
}

/* Where the inner rail k leaves the hull, or enters it. */
static float smap_turns(const smap_many_work_t *w, const smap_hull_t *o, uint8_t k, float u)
{
  const uint8_t a = smap_before(o, k), b = smap_after(o, smap_rails_of(w->map), k);
  const uint8_t i = o->disc[k], l = o->disc[a], r = o->disc[b];
  const float *p = w->p[i], *pl = w->p[l], *pr = w->p[r];
  const float part = (p[1] - pr[1]) / (pl[1] - pr[1]), rest = 1.0f - part;
  const float x = p[0] - part * pl[0] - rest * pr[0];
  const float z = p[2] - part * pl[2] - rest * pr[2];
  const float q = w->r[i] - part * w->r[l] - rest * w->r[r] - SMAP_RECESS * w->map->size;
  return o->on[k] ? smap_crossing(-x, -z, -q, u) : smap_crossing(x, z, q, u);
}

/* Find which rails are on the hull at the first pitch u: what is below its neighbours' chord goes. */
static void smap_begin_hull(const smap_many_work_t *w, smap_hull_t *o, float u)
{
  uint8_t left, k;
  for (left = smap_rails_of(w->map); left > 0; left--) {
    for (k = 1; k + 1 < smap_rails_of(w->map); k++) {
      if (o->on[k] && smap_turns(w, o, k, u) == u) {
        o->on[k] = 0;
      }
    }
  }
}

/* Rail k has changed: so have the turns of the rails from its neighbour on one side to that on the other. */
static void smap_forget(const smap_many_work_t *w, smap_hull_t *o, uint8_t k)
{
  const uint8_t rails = smap_rails_of(w->map), b = smap_after(o, rails, k);
  uint8_t a = smap_before(o, k);
  for (a = a == SMAP_NONE ? 0 : a; a < rails && (b == SMAP_NONE || a <= b); a++) {
    o->turn[a] = -SMAP_NEVER;
  }
}

/* Where the inner rail k turns next from u on, looked for if it is not known. */
static float smap_next_turn(const smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u)
{
  if (o->turn[k] == -SMAP_NEVER) {
    o->turn[k] = smap_turns(w, o, k, u);
    if (o->turn[k] == o->changed[k]) {
      /* What has just changed may be wrong by rounding: look a little further on. */
      o->turn[k] = smap_turns(w, o, k, u + SMAP_ON);
    }
  }
  return o->turn[k];
}

static inline float smap_level(const smap_many_work_t *w, uint8_t i, float s, float c)
{
  return w->p[i][0] * s - w->p[i][2] * c + w->r[i];
}

/* Put the contacts into the frame of the axis; find each rail's disc at the first pitch u. */
static void smap_lay_out(smap_many_work_t *w, smap_hull_t *o, float u)
{
  const smap_many_t *m = w->map;
  const float scale = 1.0f / (1.0f + u * u), s = 2.0f * u * scale, c = (1.0f - u * u) * scale;
  uint8_t k, i;
  for (k = 0; k < smap_rails_of(m); k++) {
    const uint8_t first = m->first[k];
    uint8_t best = first;
    for (i = first; i < m->first[k + 1]; i++) {
      const float x = w->p[i][0], y = w->p[i][1];
      w->p[i][0] = x * m->axis[1] - y * m->axis[0];
      w->p[i][1] = i == first ? x * m->axis[0] + y * m->axis[1] : w->p[first][1];
      w->rail[i] = k;
      if (smap_level(w, i, s, c) > smap_level(w, best, s, c)) {
        best = i;
      }
    }
    o->disc[k] = best;
    o->on[k] = 1;
    o->changed[k] = o->turn[k] = -SMAP_NEVER;
    o->own[k] = SMAP_NONE;
    smap_next_bend(w, o, k, u);
  }
  smap_begin_hull(w, o, u);
}

/* Where a contact touches a plane. */
static inline void smap_touch(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at, float out[3])
{
  out[0] = w->p[i][0] + w->r[i] * at->s;
  out[1] = w->p[i][1];
  out[2] = w->p[i][2] - w->r[i] * at->c;
}

/* The directions along and across on a plane. */
static void smap_frame(const smap_aim_t *aim, float along[3], float across[3])
{
  along[0] = aim->c;
  along[1] = 0.0f;
  along[2] = aim->s;
  across[0] = -aim->n[1] * aim->s;
  across[1] = aim->n[0] * aim->s - aim->n[2] * aim->c;
  across[2] = aim->n[1] * aim->c;
}

/* How far a contact extends along a plane's normal. */
static inline float smap_extent(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
  /* The first product is 1 / |(s, t, -c)|. */
  return smap_level(w, i, at->s, at->c) * (at->n[0] * at->s - at->n[2] * at->c) +
         w->p[i][1] * at->n[1];
}

/* Where a contact touches a plane, along and across. */
static inline void smap_find_spot(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at,
                                  const float along[3], const float across[3], smap_spot_t *o)
{
  const float *p = w->p[i];
  o->a = p[0] * along[0] + p[2] * along[2];
  o->b = p[1] * across[1] - at->n[1] * smap_level(w, i, at->s, at->c);
}

/* The direction with a pitch and a slope; returns the length of (s, t, -c). */
static inline float smap_slope(smap_aim_t *o, float s, float c, float t)
{
  const float norm = smap_root(1.0f + t * t), size = 1.0f / norm;
  o->s = s;
  o->c = c;
  o->n[0] = s * size;
  o->n[1] = t * size;
  o->n[2] = -c * size;
  return norm;
}

#if SMAP_MANY_GAPS
/* The direction of a vector. */
static void smap_aim(smap_aim_t *o, const float v[3])
{
  const float size = 1.0f / smap_root(v[0] * v[0] + v[2] * v[2]);
  (void)smap_slope(o, v[0] * size, -v[2] * size, v[1] * size);
}
#endif

/* Enter the facet of three contacts, whose slope is that of a and b; its first edge, or none. */
static uint8_t smap_triangle(smap_many_work_t *w, float s, float c, const uint8_t three[3], uint8_t a,
                             uint8_t b)
{
  float ya, la, t, h, norm;
  smap_aim_t at;
  uint8_t e, k;
  if (!(c > w->map->steepest)) {
    return SMAP_NONE;
  }
  ya = w->p[a][1];
  la = smap_level(w, a, s, c);
  t = (la - smap_level(w, b, s, c)) / (w->p[b][1] - ya);
  h = la + t * ya;
  norm = smap_slope(&at, s, c, t);
  if (!(c > w->map->steepest * norm && h > w->map->least_height * norm)) {
    return SMAP_NONE;
  }
  e = smap_enter(w, &at, h / norm, 3);
  if (SMAP_IS_NONE(e)) {
    return SMAP_NONE;
  }
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    w->vertex[e + k] = three[k];
    smap_touch(w, three[k], &at, w->corner[e + k]);
  }
  return e;
}

static void smap_join(smap_many_work_t *w, uint8_t e, uint8_t facet, uint8_t side)
{
  if (e < SMAP_MANY_EDGES && !SMAP_IS_NONE(facet)) {
    w->twin[e] = (uint8_t)(facet + side);
    w->twin[facet + side] = e;
  }
}

static uint8_t smap_edge(uint8_t facet, uint8_t side)
{
  return SMAP_IS_NONE(facet) ? (uint8_t)SMAP_NONE : (uint8_t)(facet + side);
}

/* Rail k goes on to another disc: a facet with each neighbour. */
static void smap_bend(smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u, float s, float c)
{
  const uint8_t a = smap_before(o, k), b = smap_after(o, smap_rails_of(w->map), k);
  const uint8_t d = o->disc[k], e = o->onto[k];
  uint8_t f = SMAP_NONE, g = SMAP_NONE;
  o->disc[k] = e;
  smap_next_bend(w, o, k, u);
  if (!o->on[k]) {
    return;
  }
  if (a != SMAP_NONE) {
    const uint8_t three[3] = {o->disc[a], d, e};
    f = smap_triangle(w, s, c, three, three[0], d);
    smap_join(w, o->own[a], f, 0);
    o->own[a] = smap_edge(f, 2);
  }
  if (b != SMAP_NONE) {
    const uint8_t three[3] = {o->disc[b], e, d};
    g = smap_triangle(w, s, c, three, d, three[0]);
    smap_join(w, o->own[k], g, 2);
    o->own[k] = smap_edge(g, 0);
  }
  if (!SMAP_IS_NONE(f)) {
    smap_join(w, (uint8_t)(f + 1u), g, 1);
  }
}

/* The inner rail k leaves the hull or enters it: a facet with both neighbours. */
static void smap_swap(smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u, float s, float c)
{
  const uint8_t a = smap_before(o, k), b = smap_after(o, smap_rails_of(w->map), k);
  const uint8_t i = o->disc[a], j = o->disc[b], d = o->disc[k], on = o->on[k];
  const uint8_t three[3] = {i, on ? d : j, on ? j : d};
  const uint8_t f = smap_triangle(w, s, c, three, i, j);
  smap_join(w, o->own[a], f, 0);
  if (on) {
    smap_join(w, o->own[k], f, 1);
    o->own[k] = SMAP_NONE;
  } else {
    o->own[k] = smap_edge(f, 1);
  }
  o->own[a] = smap_edge(f, 2);
  o->on[k] = !o->on[k];
  o->changed[k] = u;
}

/* Fill the complex of one posture. */
SMAP_APART static void smap_find_facets(smap_many_work_t *w)
{
  smap_hull_t o;
  const float steepest = w->map->steepest > 0.0f ? SMAP_BEFORE * w->map->steepest : 0.0f;
  float u = -smap_root((1.0f - steepest) / (1.0f + steepest)), first;
  uint8_t left;
  smap_lay_out(w, &o, u);
  for (left = SMAP_EVENTS; left > 0; left--) {
    uint8_t k, bends = 0, turns = SMAP_NONE; /* which rail comes first */
    float scale, s, c;
    first = SMAP_NEVER;
    for (k = 0; k < smap_rails_of(w->map); k++) {
      if (o.bend[k] < first) {
        first = o.bend[k];
        bends = k;
      }
    }
    for (k = 1; k + 1 < smap_rails_of(w->map); k++) {
      const float at = smap_next_turn(w, &o, k, u);
      if (at < first || (at == first && turns == SMAP_NONE && k < bends)) {
        first = at;
        turns = k;
      }
    }
    if (first > 1.0f) {
      return;
    }
    scale = 1.0f / (1.0f + first * first);
    s = 2.0f * first * scale;
    c = (1.0f - first * first) * scale;
    if (first > 0.0f && c <= w->map->steepest) {
      return; /* steeper and steeper */
    }
    if (turns == SMAP_NONE) {
      smap_bend(w, &o, bends, first, s, c);
    } else {
      smap_swap(w, &o, turns, first, s, c);
      bends = turns;
    }
    smap_forget(w, &o, bends);
    u = first;
  }
  w->full = 1;
}
