/* Gaps: over which part of the segment between two contacts the robot rocks and is caught.
 *
 * While the robot rolls over two contacts gravity turns in the body, and the com rises by a length
 * that is linear in gravity: one small map per arc tells it for all balances.  On the rest that it
 * comes to, a balance at the part w of the segment is caught by an edge from a to b where
 *
 *     S >= 0   and   R + T - N >= 0,   T^2 = S^2 + N^2,
 *
 * with S how far gravity lies inside the edge, N how far the com is above it along gravity's
 * part across it, and R how much higher the com is than where it was let go.  All three are linear
 * in w, so the edge lets go between the roots of a quadratic.
 */
#define SMAP_STEP 5.0f      /* steps of a roll per rad, as in the exact definition */
#define SMAP_END 1e-4f      /* nearer to an end of a segment no balance is looked at */
#define SMAP_HAIR 2e-4f     /* parts of the segment that a limit of a gap is drawn in */
#define SMAP_CAUGHT 2e-6f   /* of the size: what rounding may alter of S, N and R */

typedef struct {
  float turn[3][3]; /* gravity before to gravity after */
  float rise[3];    /* rise of the com = rise . gravity before */
  float angle;
} smap_roll_t;

typedef struct {
  float s, c, n[3]; /* pitch, unit normal */
} smap_pitch_t;

static void smap_aim(smap_pitch_t *o, float s, float c, float t)
{
  const float size = 1.0f / smap_root(1.0f + t * t);
  o->s = s;
  o->c = c;
  o->n[0] = s * size;
  o->n[1] = t * size;
  o->n[2] = -c * size;
}

/* The plane on the contacts i and j at a fraction of the way between two others. */
static void smap_on_arc(const smap_many_work_t *w, uint8_t i, uint8_t j, const smap_pitch_t *from,
                        const smap_pitch_t *to, float part, smap_pitch_t *out)
{
  const float x = from->n[0] + part * (to->n[0] - from->n[0]);
  const float y = from->n[1] + part * (to->n[1] - from->n[1]);
  const float z = from->n[2] + part * (to->n[2] - from->n[2]);
  const float size = 1.0f / smap_root(x * x + z * z), s = x * size, c = -z * size;
  const float across = w->y[w->rail[j]] - w->y[w->rail[i]];
  if (w->rail[i] == w->rail[j]) {
    smap_aim(out, s, c, y * size);
  } else {
    smap_aim(out, s, c, (smap_level(w, i, s, c) - smap_level(w, j, s, c)) / across);
  }
}

static void smap_touch(const smap_many_work_t *w, uint8_t i, float s, float c, float out[3])
{
  out[0] = w->x[i] + w->r[i] * s;
  out[1] = w->y[w->rail[i]];
  out[2] = w->z[i] - w->r[i] * c;
}

/* Add the vector `v` turned by the least rotation from a to b, `about` = a x b, times `scale`. */
static void smap_add_turned(const float about[3], float along, const float v[3], float scale,
                            float out[3])
{
  float once[3], twice[3];
  uint8_t k;
  smap_cross(about, v, once);
  smap_cross(about, once, twice);
  along = 1.0f / (1.0f + along);
  for (k = 0; k < 3; k++) {
    out[k] += scale * (v[k] + once[k] + twice[k] * along);
  }
}

/* One step of a roll over contact i: append it to the map. */
static void smap_roll_step(const smap_many_work_t *w, uint8_t i, const smap_pitch_t *a,
                           const smap_pitch_t *b, smap_roll_t *o)
{
  float about[3], back[3], half[3], p[3], lever[3], pull[3], sine2, along, size, ratio, v[3];
  uint8_t k, n;
  smap_cross(a->n, b->n, about);
  sine2 = smap_dot(about, about);
  along = smap_dot(a->n, b->n);
  for (k = 0; k < 3; k++) {
    half[k] = a->n[k] + b->n[k];
    back[k] = -about[k];
  }
  size = 1.0f / smap_root(smap_dot(half, half));
  ratio = 1.0f + sine2 * (1.0f / 6.0f) + sine2 * sine2 * (3.0f / 40.0f); /* angle / sine */
  smap_touch(w, i, a->s, a->c, p);
  smap_cross(about, p, pull);
  smap_touch(w, i, b->s, b->c, p);
  smap_cross(about, p, lever);
  smap_add_turned(back, along, lever, 1.0f, pull);
  {
    const float flat = 1.0f / smap_root(half[0] * half[0] + half[2] * half[2]);
    float turn[3];
    for (k = 0; k < 3; k++) {
      turn[k] = back[k] * size; /* half x a = -about / |a + b| */
    }
    smap_touch(w, i, half[0] * flat, -half[2] * flat, p);
    smap_cross(about, p, lever);
    smap_add_turned(turn, smap_root(0.5f + 0.5f * along), lever, 4.0f, pull);
  }
  for (n = 0; n < 3; n++) {
    o->rise[n] -= ratio * (1.0f / 6.0f) *
                  (o->turn[0][n] * pull[0] + o->turn[1][n] * pull[1] + o->turn[2][n] * pull[2]);
  }
  for (n = 0; n < 3; n++) {
    for (k = 0; k < 3; k++) {
      v[k] = o->turn[k][n];
      pull[k] = 0.0f;
    }
    smap_add_turned(about, along, v, 1.0f, pull);
    for (k = 0; k < 3; k++) {
      o->turn[k][n] = pull[k];
    }
  }
  o->angle += ratio * smap_root(sine2);
}

/* Roll over an edge onto the facet beyond. */
static void smap_roll(const smap_many_work_t *w, uint8_t e, smap_roll_t *o)
{
  const smap_facet_t *f = &w->facet[e / 3u], *g = &w->facet[w->twin[e] / 3u];
  const uint8_t i = w->vertex[e], j = w->vertex[smap_next(e)];
  smap_pitch_t from, to, here, there;
  float chord = 0.0f, d;
  uint8_t k, n, steps;
  smap_aim(&from, f->s, f->c, f->t);
  smap_aim(&to, g->s, g->c, g->t);
  for (k = 0; k < 3; k++) {
    for (n = 0; n < 3; n++) {
      o->turn[k][n] = k == n ? 1.0f : 0.0f;
    }
    o->rise[k] = 0.0f;
    d = from.n[k] - to.n[k];
    chord += d * d;
  }
  o->angle = 0.0f;
  chord = smap_root(chord);
  steps = (uint8_t)(1.0f + SMAP_STEP * chord * (1.0f + chord * chord * (1.0f / 24.0f)));
  here = from;
  for (k = 1; k <= steps; k++) {
    if (k == steps) {
      there = to;
    } else {
      smap_on_arc(w, i, j, &from, &to, (float)k / (float)steps, &there);
    }
    smap_roll_step(w, i, &here, &there, o);
    here = there;
  }
}

/* Where the other way ends: on a facet, for a part of the segment, after a further turn. */
typedef struct {
  float part[2], turn;
  uint8_t facet;
} smap_end_t;

/* A gap while it is looked at: gravity at both ends of its segment where the roll has come to, and
 * how much higher the com is there. */
typedef struct {
  float g[2][3], rise[2];
  float low, high;   /* of the segment, that are left */
  float turned;      /* rad, so far */
  uint8_t split, ends;
  smap_end_t other[3]; /* of the other way */
} smap_held_t;

/* Let go between a and b. */
static void smap_forbid(smap_held_t *o, float a, float b)
{
  if (b <= o->low || a >= o->high || a >= b) {
    return;
  }
  if (a <= o->low) {
    o->low = b;
  } else if (b >= o->high) {
    o->high = a;
  } else {
    o->split = 1;
    if (b < 0.5f) {
      o->low = b;
    } else {
      o->high = a;
    }
  }
}

static void smap_widen(float span[2], float a, float b)
{
  span[0] = a < span[0] ? a : span[0];
  span[1] = b > span[1] ? b : span[1];
}

/* Widen the part that is let go by what does not hold of q0 + q1 w + q2 w^2 >= 0, where it need hold
 * only while n0 + n1 w > 0.  What it comes from is convex, so that what lets go is one interval:
 * all, where both ends do. */
static void smap_lost_energy(const smap_held_t *o, const float q[3], float n0, float n1,
                             float span[2])
{
  const float at_low = q[0] + o->low * (q[1] + o->low * q[2]);
  const float at_high = q[0] + o->high * (q[1] + o->high * q[2]);
  const int below = at_low < 0.0f && n0 + o->low * n1 > 0.0f;
  const int above = at_high < 0.0f && n0 + o->high * n1 > 0.0f;
  float d, t, a, b;
  if (!below && !above && (q[2] <= 0.0f || (q[1] + 2.0f * q[2] * o->low) *
                                               (q[1] + 2.0f * q[2] * o->high) >= 0.0f)) {
    return;
  }
  d = q[1] * q[1] - 4.0f * q[2] * q[0];
  if (!below && !above && !(d > 0.0f)) {
    return;
  }
  if ((below && above) || !(d > 0.0f)) {
    smap_widen(span, -1.0f, 2.0f);
    return;
  }
  t = -0.5f * (q[1] + (q[1] < 0.0f ? -smap_root(d) : smap_root(d)));
  a = q[2] != 0.0f ? t / q[2] : 2.0f;
  b = t != 0.0f ? q[0] / t : 2.0f;
  if (a > b) {
    t = a;
    a = b;
    b = t;
  }
  if (below) {
    smap_widen(span, -1.0f, b > o->low && b < o->high ? b : a > o->low && a < o->high ? a : 2.0f);
  } else if (above) {
    smap_widen(span, a > o->low && a < o->high ? a : b > o->low && b < o->high ? b : -1.0f, 2.0f);
  } else {
    smap_widen(span, a, b);
  }
}

/* Over which part of the segment the robot goes on over an edge from a to b; 0 for none. */
static int smap_lost(const smap_many_work_t *w, const float a[3], const float b[3],
                     const smap_held_t *o, float span[2])
{
  const float slack = SMAP_CAUGHT * w->map->size * w->map->size;
  float along[3], wall[3], s[2], n[2], r[2], q[3], size2, inverse;
  uint8_t k;
  span[0] = 3.0f;
  span[1] = -3.0f;
  for (k = 0; k < 3; k++) {
    along[k] = b[k] - a[k];
  }
  size2 = smap_dot(along, along);
  if (!(size2 > 1e-10f * w->map->size * w->map->size)) {
    return 0;
  }
  inverse = 1.0f / smap_root(size2);
  smap_cross(a, b, wall);
  for (k = 0; k < 2; k++) {
    const float *g = o->g[k];
    s[k] = smap_dot(wall, g) * inverse - slack;
    n[k] = smap_dot(a, g) - smap_dot(a, along) * smap_dot(along, g) * inverse * inverse + slack;
    r[k] = o->rise[k] - slack;
  }
  if (s[0] < 0.0f) {
    smap_widen(span, -1.0f, s[1] < 0.0f ? 2.0f : s[0] / (s[0] - s[1]));
  } else if (s[1] < 0.0f) {
    smap_widen(span, s[0] / (s[0] - s[1]), 2.0f);
  }
  {
    const float ds = s[1] - s[0], dn = n[1] - n[0], dr = r[1] - r[0];
    q[0] = s[0] * s[0] + 2.0f * n[0] * r[0] - r[0] * r[0];
    q[1] = 2.0f * (s[0] * ds + n[0] * dr + r[0] * dn - r[0] * dr);
    q[2] = ds * ds + 2.0f * dn * dr - dr * dr;
    smap_lost_energy(o, q, n[0] - r[0], dn - dr, span);
  }
  return span[0] < span[1] && span[0] < o->high && span[1] > o->low;
}

static float smap_beside(const float p[3], const float from[3], const float along[3], float size2)
{
  float arm[3], c[3];
  uint8_t k;
  for (k = 0; k < 3; k++) {
    arm[k] = p[k] - from[k];
  }
  smap_cross(arm, along, c);
  return smap_dot(c, c) / size2;
}

/* The line of an edge that the robot came over: its begin, its direction, its length squared. */
typedef struct {
  float from[3], along[3], size2;
} smap_line_t;

static void smap_line(const smap_many_work_t *w, uint8_t e, smap_line_t *o)
{
  uint8_t k;
  smap_corner(w, e, o->from);
  smap_end(w, e, o->along);
  for (k = 0; k < 3; k++) {
    o->along[k] -= o->from[k];
  }
  o->size2 = smap_dot(o->along, o->along);
}

/* The ends of an edge; 0 where it is the way back. */
static int smap_forth(const smap_many_work_t *w, const smap_line_t *line, uint8_t e, float p[3],
                      float q[3])
{
  const float band2 = w->map->band > 0.0f ? w->map->band * w->map->band : 0.0f;
  smap_corner(w, e, p);
  smap_end(w, e, q);
  return !(smap_beside(p, line->from, line->along, line->size2) < band2 &&
           smap_beside(q, line->from, line->along, line->size2) < band2);
}

/* Whether the way to a facet after `turn` more is refused: since the other way ends on the same one,
 * for part of the balances, or since both turn too far. */
static int smap_refused(const smap_many_work_t *w, const smap_held_t *o, uint8_t facet, float turn,
                        const float part[2])
{
  const smap_facet_t *f = &w->facet[facet];
  uint8_t k;
  for (k = 0; k < o->ends; k++) {
    const smap_end_t *e = &o->other[k];
    const smap_facet_t *g = &w->facet[e->facet];
    const float fi = 1.0f / f->norm, gi = 1.0f / g->norm, all = o->turned + turn + e->turn;
    const float dx = f->s * fi - g->s * gi, dy = f->t * fi - g->t * gi, dz = f->c * fi - g->c * gi;
    const float apart = smap_root(dx * dx + dy * dy + dz * dz);
    if (e->part[0] < part[1] && part[0] < e->part[1] &&
        (all > w->map->rock_angle ||
         (apart < 1.01e-2f && (apart < 1e-4f || all + 1e-5f > apart + 1e-2f)))) {
      return 1;
    }
  }
  return 0;
}

/* Turn a gap along a roll. */
static void smap_carry(const smap_roll_t *roll, const smap_held_t *from, smap_held_t *to)
{
  uint8_t end, k;
  *to = *from;
  for (end = 0; end < 2; end++) {
    to->rise[end] = from->rise[end] + smap_dot(roll->rise, from->g[end]);
    for (k = 0; k < 3; k++) {
      to->g[end][k] = smap_dot(roll->turn[k], from->g[end]);
    }
  }
}

/* Keep what is held where the robot goes on over edge e, in a part of the segment, onto a rest;
 * return how far that turns it, or -1. */
static float smap_hold_beyond(const smap_many_work_t *w, uint8_t e, const smap_held_t *o,
                              float part[2])
{
  const uint8_t back = w->twin[e];
  float p[3], q[3], span[2];
  uint8_t at, left = SMAP_MANY_EDGES;
  smap_line_t line;
  smap_roll_t roll;
  smap_held_t next;
  if (back == SMAP_NONE || w->facet[back / 3u].kind != SMAP_REST) {
    return -1.0f;
  }
  smap_roll(w, e, &roll);
  if (smap_refused(w, o, (uint8_t)(back / 3u), roll.angle, part)) {
    return -1.0f;
  }
  smap_carry(&roll, o, &next);
  next.low = part[0] > o->low ? part[0] : o->low;
  next.high = part[1] < o->high ? part[1] : o->high;
  next.split = 0;
  smap_line(w, back, &line);
  for (at = smap_onward(w, back); at != back && left > 0 && next.low < next.high; left--) {
    if (smap_forth(w, &line, at, p, q) && smap_lost(w, p, q, &next, span)) {
      smap_forbid(&next, span[0], span[1]);
    }
    at = smap_onward(w, at);
  }
  if (next.split || !(next.low < next.high)) {
    return -1.0f;
  }
  part[0] = next.low;
  part[1] = next.high;
  return roll.angle;
}

/* Keep what a rest holds that the robot has come to over its edge `came`, or one next to it; list
 * where it ends. */
static void smap_hold_rest(const smap_many_work_t *w, uint8_t came, smap_held_t *o, smap_end_t *end,
                           uint8_t *ends)
{
  float p[3], q[3], span[2];
  uint8_t e, left = SMAP_MANY_EDGES;
  smap_line_t line;
  smap_line(w, came, &line);
  for (e = smap_onward(w, came); e != came && left > 0 && o->low < o->high; left--) {
    if (smap_forth(w, &line, e, p, q) && smap_lost(w, p, q, o, span)) {
      smap_end_t *to = &end[*ends];
      to->turn = -1.0f;
      to->part[0] = span[0];
      to->part[1] = span[1];
      if (*ends < 3) {
        to->turn = smap_hold_beyond(w, e, o, to->part);
      }
      if (to->turn < 0.0f) {
        smap_forbid(o, span[0], span[1]);
      } else {
        smap_forbid(o, span[0], to->part[0] > o->low ? to->part[0] : span[0]);
        smap_forbid(o, to->part[1] < o->high ? to->part[1] : span[1], span[1]);
        to->facet = (uint8_t)(w->twin[e] / 3u);
        (*ends)++;
      }
    }
    e = smap_onward(w, e);
  }
}

static void smap_all_of(smap_end_t *end, uint8_t facet)
{
  end->part[0] = -1.0f;
  end->part[1] = 2.0f;
  end->turn = 0.0f;
  end->facet = facet;
}

/* Over which part of an edge between two rests the robot is caught. */
static void smap_find_gap(smap_many_work_t *w, uint8_t e)
{
  static const float trial[5] = {0.5f, 0.25f, 0.75f, 0.1f, 0.9f};
  const uint8_t back = w->twin[e];
  smap_end_t ends[4];
  smap_roll_t roll;
  smap_held_t o;
  float p[3], low, high;
  uint8_t k, n, end, count = 1;
  smap_roll(w, e, &roll);
  if (!(roll.angle <= w->map->rock_angle)) {
    return;
  }
  o.low = SMAP_END;
  o.high = 1.0f - SMAP_END;
  o.split = 0;
  o.turned = roll.angle;
  o.ends = 1;
  smap_all_of(&o.other[0], (uint8_t)(e / 3u));
  smap_all_of(&ends[0], (uint8_t)(back / 3u));
  for (end = 0; end < 2; end++) {
    smap_corner(w, end ? smap_next(e) : e, p);
    o.rise[end] = smap_dot(roll.rise, p);
    for (k = 0; k < 3; k++) {
      o.g[end][k] = smap_dot(roll.turn[k], p);
    }
  }
  smap_hold_rest(w, back, &o, ends, &count);
  memcpy(o.other, ends, sizeof o.other);
  o.ends = count;
  for (end = 0; end < 2; end++) {
    /* The other way round the map is the inverse, which is the transpose. */
    smap_corner(w, end ? back : smap_next(back), p);
    for (k = 0; k < 3; k++) {
      o.g[end][k] = 0.0f;
      for (n = 0; n < 3; n++) {
        o.g[end][k] += roll.turn[n][k] * p[n];
      }
    }
    o.rise[end] = -smap_dot(roll.rise, o.g[end]);
  }
  count = 0;
  smap_hold_rest(w, e, &o, ends, &count);
  low = o.low > SMAP_END ? o.low + SMAP_HAIR : 0.0f;
  high = o.high < 1.0f - SMAP_END ? o.high - SMAP_HAIR : 1.0f;
  for (k = 0; k < (o.split ? 1 : 5); k++) {
    if (low < trial[k] && trial[k] < high) {
      w->low[e] = low;
      w->low[back] = 1.0f - high;
      return;
    }
  }
}

static void smap_find_gaps(smap_many_work_t *w)
{
  uint8_t e;
  for (e = 0; e < 3u * w->facets; e++) {
    const uint8_t back = w->twin[e];
    if (back == SMAP_NONE || back < e || w->low[e] == SMAP_SHORT ||
        w->facet[e / 3u].kind != SMAP_REST || w->facet[back / 3u].kind != SMAP_REST) {
      continue;
    }
    if (w->map->rock_angle >= 3.1415f) {
      w->low[e] = w->low[back] = 0.0f;
    } else if (w->map->rock_angle > 0.0f) {
      smap_find_gap(w, e);
    }
  }
}
