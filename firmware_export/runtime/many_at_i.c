/* One direction of gravity against a pose, without float: raw counts of an accelerometer.
 *
 * Walls, planes and points are int16, 32767 for 1; products with gravity are summed in int32, which
 * they never leave, since both are at most 32768 sqrt(3) and 32767 long.
 */
#define SMAP_MANY_AT_I 1
#define SMAP_ONE_I 32767
#define SMAP_ROUNDED_I 9e-5f /* sine that rounding may alter */

typedef struct {
  uint8_t shown, segments, alive;
  int8_t shift;      /* of D: see smap_factor_i */
  uint16_t mantissa; /* of D */
  int16_t guard, slack;
  uint8_t kind[SMAP_MANY_SHOWN], island[SMAP_MANY_SHOWN], edge[SMAP_MANY_SHOWN + 1];
  uint8_t edge_wall[SMAP_MANY_EDGES], edge_side[SMAP_MANY_EDGES];
  uint8_t over[SMAP_MANY_WALLS][2];
  smap_segment_t segment[SMAP_MANY_LINKS];
  smap_side_t side[SMAP_MANY_SIDES];
  uint16_t height[SMAP_MANY_SHOWN];
  int16_t plane[SMAP_MANY_SHOWN][3];
  int16_t centre[SMAP_MANY_SHOWN][3]; /* in two steps of sdg */
  int16_t wall[SMAP_MANY_WALLS][3];
  int16_t point[SMAP_MANY_POINTS][3];
} smap_many_pose_i_t;

static int16_t smap_rounded_i(float x)
{
  return (int16_t)(x < -32767.0f ? -32767.0f : x > 32767.0f ? 32767.0f : x + (x < 0.0f ? -0.5f : 0.5f));
}

static void smap_scale_i(const float (*from)[3], uint8_t n, float scale, int16_t (*to)[3])
{
  uint8_t i, k;
  for (i = 0; i < n; i++) {
    for (k = 0; k < 3; k++) {
      to[i][k] = smap_rounded_i(from[i][k] * scale);
    }
  }
}

/* Make the integer form of a pose. */
static void smap_many_make_i(const smap_many_pose_t *o, float sdg_step, float height_step,
                             smap_many_pose_i_t *i)
{
  float least = 0.0f, factor;
  uint8_t k;
  i->alive = o->alive;
  i->shown = o->alive ? o->shown : 0;
  i->segments = o->segments;
  if (!i->shown) {
    return;
  }
  for (k = 0; k < o->shown; k++) {
    const float high = o->height[k] / height_step;
    least = k == 0 || o->height[k] < least ? o->height[k] : least;
    i->height[k] = (uint16_t)(high < 65534.0f ? high + 0.5f : 65534.0f);
  }
  for (k = 0; k < o->shown; k++) {
    /* n / h: the greatest is 1 */
    const float scale = (float)SMAP_ONE_I * least;
    smap_scale_i((const float(*)[3])&o->plane[k], 1, scale, &i->plane[k]);
  }
  smap_scale_i(o->centre, o->shown, 0.5f / sdg_step, i->centre);
  smap_scale_i(o->wall, o->walls, (float)SMAP_ONE_I, i->wall);
  smap_scale_i(o->point, o->points, (float)SMAP_ONE_I, i->point);
  /* D = g 32767 least / (2 sdg_step) / (plane . g) = g mantissa 2^shift / (plane . g) */
  factor = (float)SMAP_ONE_I * least * 0.5f / sdg_step;
  i->shift = 0;
  while (factor >= 65535.0f && i->shift < 40) {
    factor *= 0.5f;
    i->shift++;
  }
  while (factor < 32767.0f && i->shift > -40) {
    factor *= 2.0f;
    i->shift--;
  }
  i->mantissa = (uint16_t)(factor + 0.5f);
  i->guard = (int16_t)((o->guard + SMAP_ROUNDED_I) * (float)SMAP_ONE_I + 1.0f);
  i->slack = (int16_t)(o->slack * (float)SMAP_ONE_I);
  memcpy(i->kind, o->kind, sizeof i->kind);
  memcpy(i->island, o->island, sizeof i->island);
  memcpy(i->edge, o->edge, sizeof i->edge);
  memcpy(i->edge_wall, o->edge_wall, sizeof i->edge_wall);
  memcpy(i->edge_side, o->edge_side, sizeof i->edge_side);
  memcpy(i->over, o->over, sizeof i->over);
  memcpy(i->segment, o->segment, sizeof i->segment);
  memcpy(i->side, o->side, sizeof i->side);
}

static inline int32_t smap_dot_i(const int16_t a[3], const int16_t b[3])
{
  return (int32_t)a[0] * b[0] + (int32_t)a[1] * b[1] + (int32_t)a[2] * b[2];
}

static inline void smap_cross_i(const int16_t a[3], const int16_t b[3], int32_t out[3])
{
  out[0] = (int32_t)a[1] * b[2] - (int32_t)a[2] * b[1];
  out[1] = (int32_t)a[2] * b[0] - (int32_t)a[0] * b[2];
  out[2] = (int32_t)a[0] * b[1] - (int32_t)a[1] * b[0];
}

/* Square root, rounded down. */
static uint32_t smap_root_i(uint32_t x)
{
  uint32_t digit = 1ul << 30, sum = 0;
  while (digit > x) {
    digit >>= 2;
  }
  for (; digit != 0; digit >>= 2) {
    const uint32_t trial = sum + digit;
    sum >>= 1;
    if (x >= trial) {
      x -= trial;
      sum += digit;
    }
  }
  return sum;
}

/* The length of a vector of int32, rounded down to 15 digits. */
static int32_t smap_length_i(const int32_t c[3])
{
  uint32_t most = 0, sum = 0;
  uint8_t k, shift = 0;
  for (k = 0; k < 3; k++) {
    most |= (uint32_t)(c[k] < 0 ? -c[k] : c[k]);
  }
  while (most >= 0x8000u) {
    most >>= 1;
    shift++;
  }
  for (k = 0; k < 3; k++) {
    const int32_t v = (c[k] < 0 ? -c[k] : c[k]) >> shift;
    sum += (uint32_t)(v * v);
  }
  sum = smap_root_i(sum);
  return (int32_t)(sum << shift > 0x7FFFFFFFu ? 0x7FFFFFFFu : sum << shift);
}

/* Whether a point is on the side of a plane to which the vector c, of int32, points. */
static int32_t smap_ahead_i(const int16_t p[3], const int32_t c[3])
{
  return p[0] * (c[0] >> 16) + p[1] * (c[1] >> 16) + p[2] * (c[2] >> 16);
}

/* The least distance of g from a boundary, 32767 |g| times the sine, rounded down. */
static int32_t smap_boundary_i(const smap_many_pose_i_t *o, uint8_t island, const int16_t g[3],
                               int32_t least, uint8_t *which)
{
  const smap_segment_t *s = o->segment, *end = s + o->segments;
  for (; s < end; s++) {
    const int16_t *n = o->wall[s->wall], *p = 0;
    const int32_t v = smap_dot_i(n, g);
    int32_t away = v < 0 ? -v : v, c[3];
    if (away >= least || s->island != island) {
      continue;
    }
    smap_cross_i(g, n, c);
    if (smap_ahead_i(o->point[s->start], c) < 0) {
      p = o->point[s->start];
    } else if (smap_ahead_i(o->point[s->stop], c) > 0) {
      p = o->point[s->stop];
    }
    if (p) {
      if (smap_dot_i(p, g) <= 0) {
        continue;
      }
      smap_cross_i(p, g, c);
      away = smap_length_i(c);
    }
    if (away < least) {
      least = away;
      *which = s->wall;
    }
  }
  return least;
}

static int smap_within_i(const smap_many_pose_i_t *o, uint8_t side, const int16_t g[3], int32_t slack)
{
  const smap_side_t *s = &o->side[side];
  uint8_t k;
  slack = s->inner ? -slack : 0;
  for (k = 0; k < s->count; k++) {
    const int in = smap_dot_i(o->wall[s->wall + k], g) > slack;
    if (in != !s->inwards) {
      return in;
    }
  }
  return !s->inwards;
}

static int smap_verdict_i(const smap_many_pose_i_t *o, uint8_t f, const int16_t g[3], int32_t length)
{
  const int32_t guard = o->guard * length, slack = o->slack * length;
  int beyond = 0, held = 0;
  uint8_t e;
  for (e = o->edge[f]; e < o->edge[f + 1]; e++) {
    if (smap_dot_i(o->wall[o->edge_wall[e]], g) < guard) {
      const uint8_t side = o->edge_side[e];
      beyond = 1;
      held |= side != SMAP_NONE && smap_within_i(o, side, g, slack) &&
              smap_within_i(o, (uint8_t)(side + 1u), g, slack);
    }
  }
  return held ? SMAP_ROCKS : beyond || o->kind[f] != SMAP_REST ? SMAP_TIPS : SMAP_OK;
}

/* |D - s| in steps. */
static uint16_t smap_sdg_i(const smap_many_pose_i_t *o, uint8_t f, const int16_t g[3], int32_t rate)
{
  int32_t d[3];
  uint32_t factor;
  int8_t shift = (int8_t)(o->shift - 15);
  uint8_t k;
  while (rate >= 0x10000) {
    rate >>= 1;
    shift--;
  }
  while (rate < 0x8000) {
    rate <<= 1;
    shift++;
  }
  factor = ((uint32_t)o->mantissa << 15) / (uint32_t)rate; /* 2^14 to 2^16 */
  for (k = 0; k < 3; k++) {
    int32_t v = g[k] * (int32_t)(factor >> 1);
    const int8_t by = (int8_t)(shift + 1);
    if (by < 0) {
      v = by < -30 ? 0 : v >> -by;
    } else if (v > 0x3FFFFFFF >> by || v < -(0x3FFFFFFF >> by)) {
      return 65534;
    } else {
      v = (int32_t)((uint32_t)v << by);
    }
    d[k] = v - o->centre[f][k];
    if (d[k] > 0x8000 || d[k] < -0x8000) {
      return 65534;
    }
  }
  k = 0;
  {
    const int32_t length = smap_length_i(d);
    return (uint16_t)(length < 32767 ? 2 * length : 65534);
  }
}

static smap_status_t smap_many_at_i(const smap_many_pose_i_t *o, const int16_t gravity[3],
                                    smap_reading_i_t *out)
{
  int16_t g[3] = {gravity[0], gravity[1], gravity[2]};
  int32_t rate = 0, length, least, wide[3];
  uint32_t most = 0;
  uint8_t i, best = SMAP_NONE, which = 0;
  int status;
  out->sdg = out->height = 65535u;
  out->tip = -SMAP_ONE_I;
  out->over[0] = out->over[1] = SMAP_NONE;
  for (i = 0; i < 3; i++) {
    most |= (uint32_t)(g[i] < 0 ? -(g[i] + 1) : g[i]);
  }
  if (!o->alive || most == 0) {
    return SMAP_TIPS;
  }
  for (; most < 0x2000u; most <<= 1) {
    for (i = 0; i < 3; i++) {
      g[i] = (int16_t)(g[i] * 2);
    }
  }
  for (i = 0; i < o->shown; i++) {
    const int32_t v = smap_dot_i(o->plane[i], g);
    if (v > rate) {
      rate = v;
      best = i;
    }
  }
  if (best == SMAP_NONE) {
    return SMAP_TIPS;
  }
  wide[0] = g[0];
  wide[1] = g[1];
  wide[2] = g[2];
  length = smap_length_i(wide);
  status = smap_verdict_i(o, best, g, length);
  least = smap_boundary_i(o, o->island[best], g, SMAP_ONE_I * length, &which);
  if (least < SMAP_ONE_I * length) {
    out->over[0] = o->over[which][0];
    out->over[1] = o->over[which][1];
  }
  least = least / (length + 2) - o->guard;
  if (status == SMAP_TIPS || least < 0) {
    out->tip = (int16_t)(least < 0 ? least : -1);
    return SMAP_TIPS;
  }
  out->tip = (int16_t)least;
  out->height = o->height[best];
  out->sdg = smap_sdg_i(o, best, g, rate);
  return (smap_status_t)status;
}
