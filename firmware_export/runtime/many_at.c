/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- reading many contacts --------------------------------------------------------------------------- */
/* One direction of gravity against a pose, float. */

#define SMAP_SINE 1e-6f   /* what rounding may alter of one, which near a right angle alters its angle by much more */
#define SMAP_BEYOND 2e-3f /* a sine beyond hair and slack: what tips is no further inside a wall */

/* No more than the cosine of an angle of up to a right one of this sine, and 5e-7 less for rounding. */
static inline float smap_low_cosine(float sine)
{
  const float square = sine * sine;
  return 0.9999995f - square * (0.5f + 0.5f * square);
}

/* The sine of the angle between g and a point of the boundary; 1 where its cosine is no more than `cosine`. */
static inline float smap_point_sine(const float p[3], const float g[3], float cosine)
{
  float c[3];
  if (!(smap_dot(p, g) > cosine)) {
    return 1.0f;
  }
  smap_cross(p, g, c);
  return smap_root(smap_dot(c, c));
}

/* The distance (sine) of g from the boundary of an island, and the wall of the nearest segment; that of
 * *which, an edge of a facet, comes first.  No place is nearer than `floor`, below 0 where g is not `inside`.
 * Seen from inside only walls in front can be nearest, or behind by rounding, next to a corner, and ends where
 * the boundary is bent; seen from outside only walls that are behind, or hardly in front.  No place on a wall is nearer than the wall. */
static float smap_nearest(const smap_many_pose_t *o, uint8_t facet, const float g[3], int inside,
                          float floor, uint8_t *which)
{
  const uint8_t island = o->at.island[facet];
  const smap_segment_t *const middle = o->at.segment + smap_begin_at(&o->at, island, *which);
  const smap_segment_t *s = middle, *end = o->at.segment + o->at.last[island];
  const float h[3] = {g[0], g[1], g[2]}; /* no store can alter it */
  const int bulges = smap_is_convex(&o->at, facet);
  float least = 1.0f, cosine = 0.0f;
  uint8_t part;
  for (part = 0; part < 2; part++, s = o->at.segment + o->at.first[island], end = middle) {
    for (; s < end; s++) {
      const float *n = o->wall[s->wall];
      const float ahead = smap_dot(n, h);
      float away = smap_absolute(ahead), c[3];
      if (away >= least || (inside ? ahead < -SMAP_SINE && !s->bent : ahead >= SMAP_BEYOND)) {
        continue;
      }
      smap_cross(h, n, c);
      if (smap_dot(o->point[s->stop], c) > 0.0f) {
        if (inside && !s->bent) {
          continue;
        }
        away = smap_point_sine(o->point[s->stop], h, cosine);
      } else if (smap_dot(o->point[s->start], c) < 0.0f) {
        continue;
      } else if (bulges && ahead < 0.0f) { /* of what is convex no other place is as near */
        *which = s->wall;
        return away;
      }
      if (away < least) {
        least = away;
        cosine = smap_low_cosine(away);
        *which = s->wall;
        if (away <= floor) {
          return away;
        }
      }
    }
  }
  return least;
}

/* The distance (sine) of g from the boundary of a facet's island; see smap_nearest. */
static float smap_boundary(const smap_many_pose_t *o, uint8_t facet, const float g[3], int inside,
                           float floor, uint8_t *which)
{
  const uint8_t island = o->at.island[facet];
  if (inside && smap_is_convex(&o->at, facet)) {
    float near = 1.0f;
    uint8_t k;
    for (k = o->at.first[island]; k < o->at.last[island]; k++) {
      const float v = smap_dot(o->wall[o->at.segment[k].wall], g);
      if (v < near) {
        near = v;
        *which = o->at.segment[k].wall;
      }
    }
    return near;
  }
  return smap_nearest(o, facet, g, inside, floor, which);
}

/* Whether a direction lies on the inner side of a strip's side. */
SMAP_APART static int smap_within(const smap_many_pose_t *o, uint8_t side, const float g[3])
{
  const smap_side_t *s = &o->at.side[side];
  const float slack = s->inner ? -o->slack : 0.0f;
  const uint8_t end = s->end;
  uint8_t k;
  for (k = s->wall; k < end; k++) {
    const int in = smap_dot(o->wall[k], g) > slack;
    if (in != !s->inwards) {
      return in;
    }
  }
  return !s->inwards;
}

/* The first edge of a facet that a direction lies beyond, or the one after its last; and the least
 * distance (sine) of it from an edge, and from which. */
static inline uint8_t smap_first_beyond(const smap_many_pose_t *o, uint8_t f, const float g[3],
                                        float *least, uint8_t *which)
{
  const uint8_t end = o->at.edge[f + 1];
  const float hair = o->hair;
  uint8_t e;
  *least = 1.0f;
  for (e = o->at.edge[f]; e < end; e++) {
    const float in = smap_dot(o->wall[e], g);
    if (!(in >= *least)) {
      if (!(in >= hair)) {
        break;
      }
      *least = in;
      *which = e;
    }
  }
  return e;
}

/* What a direction on a facet reads, `least` from the nearest edge.  The guard may be wide, for a com
 * in a ball: nearer to an edge than that the robot may rock. */
static inline int smap_on_facet(const smap_many_pose_t *o, uint8_t f, float least)
{
  return o->at.kind[f] != SMAP_REST ? SMAP_TIPS : least < o->guard ? SMAP_ROCKS : SMAP_OK;
}

#define SMAP_FURTHER 1 /* no status: what a direction reads is told by the facet that it has come to */

/* What a direction reads that lies beyond edge *e of facet *f: there is a strip, or, where planes are all but
 * one, it may lie on the facet at the far end, or beyond an edge of that. */
SMAP_APART static int smap_step_beyond(const smap_many_pose_t *o, uint8_t *f, uint8_t *e, const float g[3])
{
  uint8_t k, to = SMAP_NONE, which;
  float least;
  for (k = *e; k < o->at.edge[*f + 1]; k++) {
    const smap_rim_t *rim = &o->at.rim[k];
    const uint8_t side = rim->side;
    if (side + 1 >= SMAP_MANY_SIDES || smap_dot(o->wall[k], g) >= o->hair) { /* there is no strip, or within */
      continue;
    }
    if (smap_dot(o->wall[rim->back], g) >= o->hair) {
      to = rim->to;
    } else if (smap_within(o, side, g) && smap_within(o, (uint8_t)(side + 1u), g)) {
      return SMAP_ROCKS;
    }
  }
  if (to >= SMAP_MANY_SHOWN) {
    return SMAP_TIPS;
  }
  *f = to;
  *e = smap_first_beyond(o, to, g, &least, &which);
  return *e == o->at.edge[to + 1] ? smap_on_facet(o, to, least) : SMAP_FURTHER;
}

/* The same of a direction that pierces facet f first, and lies beyond its edge e. */
static int smap_beyond(const smap_many_pose_t *o, uint8_t f, uint8_t e, const float g[3])
{
  int status = SMAP_FURTHER;
  uint8_t left;
  for (left = 4; left > 0 && status == SMAP_FURTHER; left--) {
    status = smap_step_beyond(o, &f, &e, g);
  }
  return status == SMAP_FURTHER ? SMAP_TIPS : status;
}

/* The angle of a sine of at least the guard, less the guard as an angle. */
static inline float smap_less(float sine, float guard)
{
  const float angle = smap_asin(sine - SMAP_SINE) - guard * (1.0f + 0.2f * guard * guard);
  return sine < 1.0f ? angle > 0.0f ? angle : 0.0f : 3.1415925f;
}

static smap_status_t smap_many_at(const smap_many_pose_t *o, const float gravity[3], smap_reading_t *out)
{
  const float size = 1.0f / smap_root(smap_dot(gravity, gravity));
  const float g[3] = {gravity[0] * size, gravity[1] * size, gravity[2] * size};
  const uint8_t shown = o->at.shown;
  float rate = 0.0f, tip;
  uint8_t i, best = SMAP_NONE, edge, nearest = 0, which;
  int status, inside;
  out->sdg = out->height = SMAP_NAN;
  out->tip_angle = -3.1415927f;
  out->over[0] = out->over[1] = SMAP_NONE;
  SMAP_THRICE
  for (i = 0; i < shown; i++) {
    const float v = smap_dot(o->plane[i], g);
    if (v > rate) {
      rate = v;
      best = i;
    }
  }
  if (!o->at.alive || best == SMAP_NONE) {
    return SMAP_TIPS;
  }
  edge = smap_first_beyond(o, best, g, &tip, &nearest);
  inside = edge >= o->at.edge[best + 1];
  which = edge < o->at.edge[best + 1] ? edge : nearest;
  status = inside                        ? smap_on_facet(o, best, tip)
           : smap_is_alone(&o->at, best) ? SMAP_TIPS
                                         : smap_beyond(o, best, edge, g);
  if (status == SMAP_TIPS || !smap_is_alone(&o->at, best)) {
    const float floor = status == SMAP_TIPS ? -1.0f : inside ? tip : 0.0f;
    tip = smap_boundary(o, best, g, status != SMAP_TIPS, floor, &which);
  }
  if (tip < 1.0f) {
    out->over[0] = o->at.over[which][0];
    out->over[1] = o->at.over[which][1];
  }
  if (status == SMAP_TIPS || !(tip >= o->guard)) {
    tip = (status == SMAP_TIPS ? -tip : tip) - o->guard; /* outside the region is no further than this island */
    out->tip_angle = tip > -1.0f ? smap_asin(tip) : -3.1415927f;
    return SMAP_TIPS;
  }
  out->tip_angle = smap_less(tip, o->guard);
  out->height = o->height[best];
  {
    float d[3], reach = 1.0f / rate;
    SMAP_THRICE
    for (i = 0; i < 3; i++) {
      d[i] = reach * g[i] - o->centre[best][i];
    }
    out->sdg = smap_root(smap_dot(d, d));
  }
  return (smap_status_t)status;
}
