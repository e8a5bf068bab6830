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
 * wrong side of the hull change at once.
 */
#define SMAP_NEVER 2.0f
#define SMAP_RECESS 1e-6f /* of the size: inner rails count as this much higher */
#define SMAP_FAR 1e30f

typedef struct {
  float bend[SMAP_MANY_RAILS], changed[SMAP_MANY_RAILS];
  uint8_t disc[SMAP_MANY_RAILS], onto[SMAP_MANY_RAILS], on[SMAP_MANY_RAILS];
  uint8_t own[SMAP_MANY_RAILS]; /* the edge at which the arc to the next rail began */
} smap_hull_t;

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
  o->onto[k] = SMAP_NONE;
  for (j = w->map->first[k]; j < w->map->first[k + 1]; j++) {
    float at;
    if (j == i) {
      continue;
    }
    at = smap_crossing(w->x[j] - w->x[i], w->z[j] - w->z[i], w->r[j] - w->r[i], u);
    if (at < o->bend[k]) {
      o->bend[k] = at;
      o->onto[k] = j;
    } else if (at == o->bend[k] && at < SMAP_NEVER) {
      /* Touched at once: the one further along carries on. */
      const uint8_t b = o->onto[k];
      const float ahead = (w->x[j] - w->x[b]) * (1.0f - at * at);
      if (ahead + (w->z[j] - w->z[b]) * 2.0f * at > 0.0f) {
        o->onto[k] = j;
      }
    }
  }
}

static uint8_t smap_before(const smap_hull_t *o, uint8_t k)
{
  while (k > 0) {
    k--;
    if (o->on[k]) {
      return k;
    }
  }
  return SMAP_NONE;
}

static uint8_t smap_after(const smap_hull_t *o, uint8_t rails, uint8_t k)
{
  for (k++; k < rails; k++) {
    if (o->on[k]) {
      return k;
    }
  }
  return SMAP_NONE;
}

/* Where the inner rail k leaves the hull, or enters it. */
static float smap_turns(const smap_many_work_t *w, const smap_hull_t *o, uint8_t k, float u)
{
  const uint8_t a = smap_before(o, k), b = smap_after(o, w->map->rails, k);
  const float part = (w->y[k] - w->y[b]) / (w->y[a] - w->y[b]), rest = 1.0f - part;
  const uint8_t i = o->disc[k], l = o->disc[a], r = o->disc[b];
  const float x = w->x[i] - part * w->x[l] - rest * w->x[r];
  const float z = w->z[i] - part * w->z[l] - rest * w->z[r];
  const float q = w->r[i] - part * w->r[l] - rest * w->r[r] - SMAP_RECESS * w->map->size;
  return o->on[k] ? smap_crossing(-x, -z, -q, u) : smap_crossing(x, z, q, u);
}

/* Put the contacts into the frame of the axis; find each rail's disc at a pitch of -90 deg. */
static void smap_lay_out(smap_many_work_t *w, const smap_many_place_t *place, smap_hull_t *o)
{
  const smap_many_t *m = w->map;
  uint8_t k, i;
  for (k = 0; k < m->rails; k++) {
    uint8_t best = m->first[k];
    for (i = m->first[k]; i < m->first[k + 1]; i++) {
      const float *p = place->contact[i].p;
      w->x[i] = p[0] * m->axis[1] - p[1] * m->axis[0];
      w->y[k] = p[0] * m->axis[0] + p[1] * m->axis[1];
      w->z[i] = p[2];
      w->r[i] = place->contact[i].radius;
      w->rail[i] = k;
      if (w->r[i] - w->x[i] > w->r[best] - w->x[best]) {
        best = i;
      }
    }
    o->disc[k] = best;
    o->on[k] = k == 0 || k + 1 == m->rails;
    o->changed[k] = -SMAP_NEVER;
    o->own[k] = SMAP_NONE;
    smap_next_bend(w, o, k, -1.0f);
  }
}

static float smap_level(const smap_many_work_t *w, uint8_t i, float s, float c)
{
  return w->x[i] * s - w->z[i] * c + w->r[i];
}

/* Enter the facet of three contacts, two of them on rails a and b; its first edge, or none. */
static uint8_t smap_triangle(smap_many_work_t *w, float s, float c, uint8_t i, uint8_t j, uint8_t k,
                             uint8_t a, uint8_t b)
{
  const uint8_t three[3] = {i, j, k}, e = (uint8_t)(3u * w->facets);
  const float ya = w->y[w->rail[a]], yb = w->y[w->rail[b]], la = smap_level(w, a, s, c);
  const float t = (la - smap_level(w, b, s, c)) / (yb - ya), h = la + t * ya;
  const float norm = smap_root(1.0f + t * t);
  smap_facet_t *f = &w->facet[w->facets];
  uint8_t n;
  if (!(c > w->map->steepest * norm && h > w->map->least_height * norm)) {
    return SMAP_NONE;
  }
  if (w->facets >= SMAP_MANY_FACETS) {
    w->failed = 1;
    return SMAP_NONE;
  }
  f->s = s;
  f->c = c;
  f->t = t;
  f->h = h;
  f->norm = norm;
  for (n = 0; n < 3; n++) {
    w->vertex[e + n] = three[n];
    w->twin[e + n] = SMAP_NONE;
  }
  w->facets++;
  return e;
}

static void smap_join(smap_many_work_t *w, uint8_t e, uint8_t facet, uint8_t side)
{
  if (e != SMAP_NONE && facet != SMAP_NONE) {
    w->twin[e] = (uint8_t)(facet + side);
    w->twin[facet + side] = e;
  }
}

static uint8_t smap_edge(uint8_t facet, uint8_t side)
{
  return facet == SMAP_NONE ? (uint8_t)SMAP_NONE : (uint8_t)(facet + side);
}

/* Rail k goes on to another disc: a facet with each neighbour. */
static void smap_bend(smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u, float s, float c)
{
  const uint8_t a = smap_before(o, k), b = smap_after(o, w->map->rails, k);
  const uint8_t d = o->disc[k], e = o->onto[k];
  uint8_t f = SMAP_NONE, g = SMAP_NONE;
  o->disc[k] = e;
  smap_next_bend(w, o, k, u);
  if (!o->on[k]) {
    return;
  }
  if (a != SMAP_NONE) {
    f = smap_triangle(w, s, c, o->disc[a], d, e, o->disc[a], d);
    smap_join(w, o->own[a], f, 0);
    o->own[a] = smap_edge(f, 2);
  }
  if (b != SMAP_NONE) {
    g = smap_triangle(w, s, c, o->disc[b], e, d, d, o->disc[b]);
    smap_join(w, o->own[k], g, 2);
    o->own[k] = smap_edge(g, 0);
  }
  if (f != SMAP_NONE) {
    smap_join(w, (uint8_t)(f + 1u), g, 1);
  }
}

/* The inner rail k leaves the hull or enters it: a facet with both neighbours. */
static void smap_swap(smap_many_work_t *w, smap_hull_t *o, uint8_t k, float u, float s, float c)
{
  const uint8_t a = smap_before(o, k), b = smap_after(o, w->map->rails, k);
  const uint8_t i = o->disc[a], j = o->disc[b], d = o->disc[k];
  uint8_t f;
  if (o->on[k]) {
    f = smap_triangle(w, s, c, i, d, j, i, j);
    smap_join(w, o->own[a], f, 0);
    smap_join(w, o->own[k], f, 1);
    o->own[k] = SMAP_NONE;
    o->own[a] = smap_edge(f, 2);
  } else {
    f = smap_triangle(w, s, c, i, j, d, i, j);
    smap_join(w, o->own[a], f, 0);
    o->own[k] = smap_edge(f, 1);
    o->own[a] = smap_edge(f, 2);
  }
  o->on[k] = !o->on[k];
  o->changed[k] = u;
}

/* Fill the complex of one posture. */
static void smap_find_facets(smap_many_work_t *w, const smap_many_place_t *place)
{
  smap_hull_t o;
  uint16_t left;
  uint8_t k, which;
  float u = -1.0f;
  smap_lay_out(w, place, &o);
  for (left = 8u * SMAP_MANY_FACETS; left > 0; left--) {
    float first = SMAP_NEVER, scale, s, c;
    int bends = 0;
    which = SMAP_NONE;
    for (k = 0; k < w->map->rails; k++) {
      if (o.bend[k] < first) {
        first = o.bend[k];
        which = k;
        bends = 1;
      }
      if (k > 0 && k + 1 < w->map->rails) {
        const float at = smap_turns(w, &o, k, u);
        if (at < first && at != o.changed[k]) {
          first = at;
          which = k;
          bends = 0;
        }
      }
    }
    if (which == SMAP_NONE || first > 1.0f) {
      return;
    }
    u = first;
    scale = 1.0f / (1.0f + u * u);
    s = 2.0f * u * scale;
    c = (1.0f - u * u) * scale;
    if (bends) {
      smap_bend(w, &o, which, u, s, c);
    } else {
      smap_swap(w, &o, which, u, s, c);
    }
  }
  w->failed = 1;
}
