/* Which facets are rests: the support polygon of each, its centroid and whether it is wide enough.
 *
 * All contacts within the tolerance of a facet's plane make up its polygon.  They lie on the rails,
 * so the polygon is the hull of one interval per rail: `a` along the pitch, y across.
 */
#define SMAP_MANY_CORNERS (2 * SMAP_MANY_RAILS)
#define SMAP_TURN_SHORT 1e-5f /* rad: arcs as short as this join what is one facet */

/* The interval of a rail's contacts near a facet's plane; 0 if there is none. */
static int smap_touching(const smap_many_work_t *w, const smap_facet_t *f, uint8_t k, float span[2])
{
  const smap_many_t *m = w->map;
  const float top = f->h - f->t * w->y[k] - m->tolerance * f->norm;
  int any = 0;
  uint8_t i;
  for (i = m->first[k]; i < m->first[k + 1]; i++) {
    if (smap_level(w, i, f->s, f->c) >= top) {
      const float a = w->x[i] * f->c + w->z[i] * f->s;
      span[0] = !any || a < span[0] ? a : span[0];
      span[1] = !any || a > span[1] ? a : span[1];
      any = 1;
    }
  }
  return any;
}

/* Drop what lies inside the last corners of a hull that goes on to (a, y). */
static uint8_t smap_wrap(float (*p)[2], uint8_t n, uint8_t least, float a, float y)
{
  while (n > least) {
    const float *q = p[n - 1], *o = p[n - 2];
    if ((q[0] - o[0]) * (y - q[1]) - (q[1] - o[1]) * (a - q[0]) > 0.0f) {
      break;
    }
    n--;
  }
  p[n][0] = a;
  p[n][1] = y;
  return (uint8_t)(n + 1u);
}

/* The corners (a, y) of a facet's polygon, counter-clockwise in these coordinates. */
static uint8_t smap_polygon(const smap_many_work_t *w, const smap_facet_t *f, float (*p)[2])
{
  float span[SMAP_MANY_RAILS][2];
  uint8_t touched[SMAP_MANY_RAILS], count = 0, n = 0, k, least;
  for (k = 0; k < w->map->rails; k++) {
    if (smap_touching(w, f, k, span[count])) {
      touched[count++] = k;
    }
  }
  for (k = 0; k < count; k++) {
    n = smap_wrap(p, n, 1, span[k][1], w->y[touched[k]]);
  }
  least = n;
  for (k = count; k > 0; k--) {
    if (k == count && !(span[k - 1][0] < span[k - 1][1])) {
      continue;
    }
    n = smap_wrap(p, n, least, span[k - 1][0], w->y[touched[k - 1]]);
  }
  if (count > 0 && !(span[0][0] < span[0][1])) {
    n--;
  }
  return n;
}

/* Whether a polygon is at least `width` wide in every direction; y counts `scale` times. */
static int smap_wide(float (*p)[2], uint8_t n, float scale, float width)
{
  uint8_t i, j;
  for (i = 0; i < n; i++) {
    const float *o = p[i], *q = p[i + 1 < n ? i + 1 : 0];
    const float da = q[0] - o[0], dy = (q[1] - o[1]) * scale;
    float most = 0.0f;
    for (j = 0; j < n; j++) {
      const float out = da * (p[j][1] - o[1]) * scale - dy * (p[j][0] - o[0]);
      most = out > most ? out : most;
    }
    if (!(most * most >= width * width * (da * da + dy * dy))) {
      return 0;
    }
  }
  return n >= 3;
}

/* The area centroid of a polygon, or 0 where it has no area. */
static int smap_centroid(float (*p)[2], uint8_t n, float out[2])
{
  float area = 0.0f, a = 0.0f, y = 0.0f;
  uint8_t i;
  for (i = 1; i + 1 < n; i++) {
    const float ua = p[i][0] - p[0][0], uy = p[i][1] - p[0][1];
    const float va = p[i + 1][0] - p[0][0], vy = p[i + 1][1] - p[0][1];
    const float part = ua * vy - uy * va;
    area += part;
    a += part * (ua + va);
    y += part * (uy + vy);
  }
  if (!(area > 0.0f)) {
    return 0;
  }
  area = 1.0f / (3.0f * area);
  out[0] = p[0][0] + a * area;
  out[1] = p[0][1] + y * area;
  return 1;
}

static void smap_classify(smap_many_work_t *w)
{
  float p[SMAP_MANY_CORNERS + 1][2];
  uint8_t f, k;
  for (f = 0; f < w->facets; f++) {
    smap_facet_t *facet = &w->facet[f];
    const uint8_t n = smap_polygon(w, facet, p);
    facet->kind = SMAP_STAGE;
    facet->group = SMAP_NONE;
    if (!smap_centroid(p, n, w->centre[f])) {
      w->centre[f][0] = w->centre[f][1] = 0.0f;
      for (k = 0; k < 3; k++) {
        const uint8_t i = w->vertex[3u * f + k];
        w->centre[f][0] += (w->x[i] * facet->c + w->z[i] * facet->s) * (1.0f / 3.0f);
        w->centre[f][1] += w->y[w->rail[i]] * (1.0f / 3.0f);
      }
    } else if (w->map->rock_angle >= 3.1415f ||
               smap_wide(p, n, facet->norm, w->map->rest_width)) {
      facet->kind = SMAP_REST;
    }
  }
}

/* Mark the arcs between rests that are one but for rounding. */
static void smap_mark_short(smap_many_work_t *w)
{
  uint8_t e;
  for (e = 0; e < 3u * w->facets; e++) {
    const uint8_t back = w->twin[e];
    w->low[e] = SMAP_OPEN;
    if (back != SMAP_NONE) {
      const smap_facet_t *f = &w->facet[e / 3u], *g = &w->facet[back / 3u];
      const float ds = f->s - g->s, dc = f->c - g->c, dt = f->t - g->t;
      if (f->kind == SMAP_REST && g->kind == SMAP_REST &&
          ds * ds + dc * dc + dt * dt < SMAP_TURN_SHORT * SMAP_TURN_SHORT) {
        w->low[e] = SMAP_SHORT;
      }
    }
  }
}
