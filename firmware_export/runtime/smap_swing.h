/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- swing: rests on which an axle stands that swings about a pivot ----------------------------------- */
/* The first two contacts are those of the first axle, and so on.  Behind the contacts stand two points of each: the pivot,
 * whose axis is the line about which it swings, and the com of the rest of the robot.  The axle carries the rest where its line meets the plane through both of its contacts across
 * the ground.  So the polygon of a facet's contacts is cut where the rest would turn over a line from there to a contact,
 * and the axle over one of its own.  Where rounding may tell, less stands. */
#define SMAP_UNSURE 5e-6f  /* of the size: what is as near to the tolerance may be within it, or not */
#define SMAP_DEPTH 0.05f   /* of the height of the rest's com: a pivot counts as at least as far below it */
#define SMAP_ALONG 0.1001f /* least sine between an axle's line and the plane across it */
#define SMAP_UPON 1e-3f    /* of the size: with a pivot as near to a contact nothing stands, */
#define SMAP_LEVEL 1e-4f   /* sine: nor with one as level with both, and beside them */
#define SMAP_SWUNG (2 * SMAP_MAX_CONTACTS + 4)

/* A polygon: its corners, the walls through the com and the edge from each to the next, and contacts near them. */
typedef struct {
  struct {
    float p[3], wall[3];
    uint8_t id;
  } at[SMAP_SWUNG];
  uint8_t count;
} smap_swung_t;

/* An axle: the first of its contacts, and where they touch; the rest's com; where it carries; a line along its own, as long
 * as the size. */
typedef struct {
  uint8_t own;
  const float *load;
  float ends[2][3], pivot[3], line[3];
} smap_axle_t;

/* Find where the axle carries whose first contact is i; 0 where it does not. */
static int smap_find_pivot(const smap_work_t *w, uint8_t i, const float n[3], smap_axle_t *axle)
{
  const uint8_t at = (uint8_t)(w->map->contacts + i);
  const float *const line = w->axle[smap_is_disc(w, at) ? w->axle_of[at] : 0], size = w->map->size;
  float d[3], across[3], slope;
  uint8_t k;
  axle->own = i;
  axle->load = w->p[at + 1];
  smap_touch(w, i, n, axle->ends[0]);
  smap_touch(w, (uint8_t)(i + 1), n, axle->ends[1]);
  smap_minus(axle->ends[1], axle->ends[0], d);
  smap_cross(d, n, across);
  slope = smap_dot(d, d) > SMAP_UPON * SMAP_UPON * size * size && smap_unit(across) ? smap_dot(line, across) : 0.0f;
  smap_minus(axle->ends[0], w->p[at], d);
  for (k = 0; k < 3; k++) {
    axle->pivot[k] = w->p[at][k] + smap_dot(d, across) / slope * line[k];
    axle->line[k] = size * line[k];
  }
  return smap_absolute(slope) > SMAP_ALONG;
}

/* Cut a polygon along a line, seen from the com: what is left of it from a to b stays. */
static void smap_cut(smap_swung_t *o, const float a[3], const float b[3])
{
  const smap_swung_t old = *o;
  float wall[3];
  uint8_t k;
  smap_cross(b, a, wall);
  o->count = 0;
  for (k = 0; k < old.count && o->count + 2 <= SMAP_SWUNG; k++) {
    const uint8_t next = k + 1 < old.count ? (uint8_t)(k + 1) : (uint8_t)0;
    const float in = smap_dot(wall, old.at[k].p), beyond = smap_dot(wall, old.at[next].p), part = in / (in - beyond);
    if (in >= 0.0f) {
      o->at[o->count++] = old.at[k];
    }
    if ((in >= 0.0f) != (beyond >= 0.0f)) {
      o->at[o->count] = old.at[k];
      smap_mix(old.at[k].p, old.at[next].p, part, o->at[o->count].p);
      memcpy(o->at[o->count].wall, in >= 0.0f ? wall : old.at[k].wall, sizeof wall);
      o->at[o->count++].id = old.at[part < 0.5f ? k : next].id;
    }
  }
}

/* Cut it along the sides of the outline of the pivot and other contacts from `level` on, as the com of the rest sees them. */
static void smap_cut_rest(const smap_work_t *w, smap_swung_t *o, const float n[3], const smap_axle_t *axle,
                          const float *extent, float level)
{
  const float depth = level - smap_dot(axle->load, n);
  const uint8_t last = w->map->contacts;
  float p[SMAP_MAX_CONTACTS][3], a[3], b[3];
  uint8_t id[SMAP_MAX_CONTACTS], count = 0, k, l;
  for (k = 0; k <= last; k++) { /* the pivot comes last */
    float low, rise;
    if (k == axle->own || k == axle->own + 1 || (k < last && !(extent[k] >= level))) {
      continue;
    }
    smap_touch(w, k, n, a);
    smap_minus(k < last ? a : axle->pivot, axle->load, a);
    low = smap_dot(a, n);
    rise = k == last && low < SMAP_DEPTH * depth ? SMAP_DEPTH * depth - low : 0.0f;
    for (l = 0; l < 3; l++) {
      p[count][l] = (a[l] + rise * n[l]) * (depth / (low + rise));
    }
    id[count++] = k;
  }
  count = smap_outline(n, p, id, count);
  o->count = count > 2 && depth > 0.0f ? o->count : 0;
  for (k = 0; k < count; k++) {
    l = k + 1 < count ? (uint8_t)(k + 1) : (uint8_t)0;
    if (id[k] < last && id[l] < last) { /* over two contacts the whole robot turns */
      smap_touch(w, id[k], n, a);
      smap_touch(w, id[l], n, b);
    }
    smap_cut(o, id[k] < last && id[l] < last ? a : p[k], id[k] < last && id[l] < last ? b : p[l]);
  }
}

/* Cut it where the axle turns over one of its contacts. */
static void smap_cut_axle(smap_swung_t *o, const float n[3], const smap_axle_t *axle, uint8_t side)
{
  float near[3], far[3], wall[3], above, square;
  int level, back;
  smap_minus(axle->ends[side], axle->pivot, near);
  smap_minus(axle->ends[1 - side], axle->pivot, far);
  smap_cross(axle->line, near, wall);
  above = smap_dot(near, n);
  square = smap_dot(near, near);
  level = above * above <= SMAP_LEVEL * SMAP_LEVEL * square;
  back = smap_dot(wall, far) < 0.0f;
  if (!(square > SMAP_UPON * SMAP_UPON * smap_dot(axle->line, axle->line)) || (level && !(smap_dot(near, far) < 0.0f))) {
    o->count = 0;
  } else if (above > 0.0f && !level) { /* else it hangs */
    smap_cut(o, back ? axle->line : near, back ? near : axle->line);
  }
}

/* Add the rest on a plane so high that touches an axle, if it is one; 0 where it touches none.  `extent`: of each contact
 * along n. */
SMAP_APART static int smap_add_swung(smap_work_t *w, const float n[3], float height, const float *extent)
{
  const smap_limits_t *const m = w->map;
  const float level = height - m->tolerance + SMAP_UNSURE * m->size;
  float p[SMAP_SWUNG][3], wall[SMAP_SWUNG][3], d[3];
  uint8_t id[SMAP_SWUNG], own = SMAP_NONE, count = 0, k, l;
  smap_axle_t axle;
  smap_swung_t o;
  int one = 1;
  for (k = 0; k < 2 * m->first[0]; k = (uint8_t)(k + 2)) {
    const float i = extent[k], j = extent[k + 1];
    if ((i > j ? i : j) >= level - 2.0f * SMAP_UNSURE * m->size) {
      one = own == SMAP_NONE && (i < j ? i : j) >= level; /* not two axles, nor one side alone */
      own = k;
    }
  }
  if (own == SMAP_NONE || !one || !smap_find_pivot(w, own, n, &axle)) {
    return own != SMAP_NONE;
  }
  for (k = 0; k < m->contacts; k++) {
    if (extent[k] >= level) {
      smap_touch(w, k, n, p[count]);
      for (l = 0; l < 3; l++) {
        p[count][l] += (height - extent[k]) * n[l];
      }
      id[count++] = k;
    }
  }
  o.count = smap_outline(n, p, id, count);
  for (k = 0; k < o.count; k++) {
    memcpy(o.at[k].p, p[k], sizeof *p);
    smap_cross(p[k + 1 < o.count ? k + 1 : 0], p[k], o.at[k].wall);
    o.at[k].id = id[k];
  }
  smap_cut_rest(w, &o, n, &axle, extent, level);
  smap_cut_axle(&o, n, &axle, 0);
  smap_cut_axle(&o, n, &axle, 1);
  for (k = 0, count = 0; k < o.count; k++) { /* but for dots */
    smap_minus(o.at[k + 1 < o.count ? k + 1 : 0].p, o.at[k].p, d);
    if (smap_dot(d, d) > SMAP_DOT * SMAP_DOT * m->size * m->size) {
      memcpy(p[count], o.at[k].p, sizeof *p);
      memcpy(wall[count], o.at[k].wall, sizeof *wall);
      id[count++] = o.at[k].id;
    }
  }
  k = smap_add_rest(w, n, p, id, count, extent, 1);
  if (k != SMAP_NONE) {
    memcpy(w->region->wall[k], wall, count * sizeof *wall);
  }
  return 1;
}
