/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- reading many contacts --------------------------------------------------------------------------- */
/* One direction of gravity against a pose, float. */

#define SMAP_SINE 1e-6f /* what rounding may alter of one, which near a right angle alters its angle by much more */
#define SMAP_EDGE 1e-5f /* a sine: as far beyond an edge of a rest the boundary tells */

/* The rest that a direction pierces first, and where: 1 / distance along it. */
static uint8_t smap_pierced(const smap_many_pose_t *o, const float g[3], float *rate)
{
  const uint8_t rests = o->at.rests;
  uint8_t i, best = SMAP_NONE;
  *rate = 0.0f;
  for (i = 0; i < rests; i++) {
    const float v = smap_dot(o->plane[i], g);
    if (v > *rate) {
      *rate = v;
      best = i;
    }
  }
  return best;
}

/* How far inside (sine) the edges of a rest a direction is, and which of them is nearest. */
static float smap_inside(const smap_many_pose_t *o, uint8_t rest, const float g[3], uint8_t *which)
{
  const uint8_t end = o->at.edge[rest + 1];
  float least = 1.0f;
  uint8_t e;
  *which = o->at.edge[rest];
  for (e = *which; e < end; e++) {
    const float in = smap_dot(o->wall[e], g);
    if (!(in >= least)) {
      least = in;
      *which = e;
    }
  }
  return least;
}

/* Whether a direction that is in no rest is in a gap. */
static int smap_is_in_gap(const smap_many_pose_t *o, const float g[3])
{
  const uint8_t gaps = SMAP_MANY_GAPS ? o->at.gaps : 0;
  uint8_t k;
  for (k = 0; k < gaps; k++) {
    const float(*const side)[3] = o->wall + SMAP_MANY_CORNERS + 2 * k;
    if (smap_dot(o->wall[o->at.gap[k].a], g) <= 0.0f && smap_dot(o->wall[o->at.gap[k].b], g) <= 0.0f &&
        smap_dot(side[0], g) >= 0.0f && smap_dot(side[1], g) >= 0.0f) {
      return 1;
    }
  }
  return 0;
}

/* The distance (sine) of a direction from the boundary, 1 where that is further than a right angle, and from which wall
 * of it. */
static float smap_nearest(const smap_many_pose_t *o, const float g[3], uint8_t *which)
{
  const uint8_t arcs = o->at.arcs;
  float least = 1.0f;
  uint8_t k;
  for (k = 0; k < arcs; k++) {
    const float *const m = o->amid[k], *const t = o->along[k];
    float away = smap_dot(o->wall[o->at.arc[k]], g), aside, ahead;
    away *= away;
    if (!(away < least)) {
      continue;
    }
    aside = smap_absolute(smap_dot(t, g));
    ahead = smap_dot(m, g);
    if (ahead < 0.0f && ahead * smap_dot(t, t) + aside * smap_dot(m, m) < 0.0f) {
      continue; /* even the nearer end is behind */
    }
    away += aside > ahead ? (aside - ahead) * (aside - ahead) : 0.0f;
    if (away < least) {
      least = away;
      *which = o->at.arc[k];
    }
  }
  return smap_root(least);
}

/* The angle of a sine of at least the guard, less the guard as an angle. */
static inline float smap_less(float sine, float guard)
{
  const float angle = smap_asin(sine - SMAP_SINE) - guard * (1.0f + 0.2f * guard * guard);
  return angle > 0.0f ? angle : 0.0f;
}

static smap_status_t smap_many_at(const smap_many_pose_t *o, const float gravity[3], smap_reading_t *out)
{
  const float size = 1.0f / smap_root(smap_dot(gravity, gravity));
  const float g[3] = {gravity[0] * size, gravity[1] * size, gravity[2] * size};
  float rate, tip, d[3];
  uint8_t i, best, which;
  smap_status_t status;
  out->sdg = out->height = SMAP_NAN;
  out->tip_angle = -3.1415927f;
  out->over[0] = out->over[1] = SMAP_NONE;
  best = smap_pierced(o, g, &rate);
  if (!o->at.alive || best == SMAP_NONE) {
    return SMAP_TIPS;
  }
  tip = smap_inside(o, best, g, &which);
  for (i = 0; !(tip >= -SMAP_EDGE) && i < o->at.rests; i++) { /* planes that are all but one may be in any order */
    uint8_t near;
    const float in = smap_inside(o, i, g, &near);
    if (in >= 0.0f) {
      tip = in;
      best = i;
      which = near;
      rate = smap_dot(o->plane[i], g);
    }
  }
  status = tip >= o->guard                                  ? SMAP_OK
           : tip >= -SMAP_EDGE || smap_is_in_gap(o, g) ? SMAP_ROCKS
                                                            : SMAP_TIPS;
  if (o->at.rests > 1 && !(tip >= 0.0f && o->at.alone[best])) {
    tip = smap_nearest(o, g, &which);
    tip = status == SMAP_TIPS ? -tip : tip;
  }
  if (tip < 1.0f) {
    out->over[0] = o->at.over[which][0];
    out->over[1] = o->at.over[which][1];
  }
  if (status == SMAP_TIPS || !(tip >= o->guard)) {
    tip -= o->guard;
    out->tip_angle = tip > -1.0f ? smap_asin(tip) : -3.1415927f;
    return SMAP_TIPS;
  }
  out->tip_angle = o->at.arcs ? smap_less(tip, o->guard) : 3.1415925f;
  out->height = o->height[best];
  rate = 1.0f / rate;
  SMAP_THRICE
  for (i = 0; i < 3; i++) {
    d[i] = rate * g[i] - o->centre[best][i];
  }
  out->sdg = smap_root(smap_dot(d, d));
  return status;
}
