/* One direction of gravity against a pose, float. */

/* The sine of the angle between g and a point of the boundary; 1 from a right angle on. */
static float smap_point_sine(const float p[3], const float g[3])
{
  float c[3];
  if (!(smap_dot(p, g) > 0.0f)) {
    return 1.0f;
  }
  smap_cross(p, g, c);
  return smap_root(smap_dot(c, c));
}

/* The distance (sine) of g from the boundary of an island, and the wall of its nearest segment. */
static float smap_boundary(const smap_many_pose_t *o, uint8_t island, const float g[3], uint8_t *which)
{
  float least = 1.0f;
  uint8_t i;
  for (i = 0; i < o->segments; i++) {
    const smap_segment_t *s = &o->segment[i];
    const float *n = o->wall[s->wall];
    const float v = smap_dot(n, g);
    float away = v < 0.0f ? -v : v, c[3];
    if (s->island != island || away >= least) {
      continue;
    }
    /* Beyond an end the point there is nearest. */
    smap_cross(g, n, c);
    if (smap_dot(o->point[s->start], c) < 0.0f) {
      away = smap_point_sine(o->point[s->start], g);
    } else if (smap_dot(o->point[s->stop], c) > 0.0f) {
      away = smap_point_sine(o->point[s->stop], g);
    }
    if (away < least) {
      least = away;
      *which = s->wall;
    }
  }
  return least;
}

/* Whether a direction lies on the inner side of a strip's side. */
static int smap_within(const smap_many_pose_t *o, uint8_t side, const float g[3])
{
  const smap_side_t *s = &o->side[side];
  const float slack = s->inner ? -o->slack : 0.0f;
  uint8_t k;
  for (k = 0; k < s->count; k++) {
    const int in = smap_dot(o->wall[s->wall + k], g) > slack;
    if (in != !s->inwards) {
      return in;
    }
  }
  return !s->inwards;
}

/* 0 outside the region, SMAP_OK or SMAP_ROCKS + 1 inside. */
static int smap_verdict(const smap_many_pose_t *o, uint8_t f, const float g[3])
{
  int beyond = 0, rolls = 0, held = 0;
  uint8_t e;
  for (e = o->edge[f]; e < o->edge[f + 1]; e++) {
    if (smap_dot(o->wall[o->edge_wall[e]], g) < o->guard) {
      const uint8_t side = o->edge_side[e];
      if (side == SMAP_NONE) {
        beyond = 1;
      } else {
        rolls = 1;
        held |= smap_within(o, side, g) && smap_within(o, (uint8_t)(side + 1u), g);
      }
    }
  }
  if (held) {
    return SMAP_ROCKS;
  }
  return beyond || rolls || o->kind[f] != SMAP_REST ? SMAP_TIPS : SMAP_OK;
}

static smap_status_t smap_many_at(const smap_many_pose_t *o, const float gravity[3], smap_reading_t *out)
{
  const float size = 1.0f / smap_root(smap_dot(gravity, gravity));
  const float g[3] = {gravity[0] * size, gravity[1] * size, gravity[2] * size};
  float rate = 0.0f, tip;
  uint8_t i, best = SMAP_NONE, which = 0;
  int status;
  out->sdg = out->height = SMAP_NAN;
  out->tip_angle = -1.5707964f;
  out->over[0] = out->over[1] = SMAP_NONE;
  for (i = 0; i < o->shown; i++) {
    const float v = smap_dot(o->plane[i], g);
    if (v > rate) {
      rate = v;
      best = i;
    }
  }
  if (!o->alive || best == SMAP_NONE) {
    return SMAP_TIPS;
  }
  status = smap_verdict(o, best, g);
  tip = smap_boundary(o, o->island[best], g, &which) - o->guard;
  if (tip < 1.0f) {
    out->over[0] = o->over[which][0];
    out->over[1] = o->over[which][1];
  }
  if (status == SMAP_TIPS || !(tip >= 0.0f)) {
    out->tip_angle = tip < 0.0f ? smap_asin(tip > -1.0f ? tip : -1.0f) : -1e-30f;
    return SMAP_TIPS;
  }
  out->tip_angle = tip < 1.0f ? smap_asin(tip) : 3.1415925f;
  out->height = o->height[best];
  {
    float d[3], reach = 1.0f / rate;
    for (i = 0; i < 3; i++) {
      d[i] = reach * g[i] - o->centre[best][i];
    }
    out->sdg = smap_root(smap_dot(d, d));
  }
  return (smap_status_t)status;
}
