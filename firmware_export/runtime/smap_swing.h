/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- swing: rests on which an axle stands that swings about a pivot ----------------------------------- */
/* The first two contacts are those of the first axle, and so on.  Behind the contacts stand two points of each: the
 * pivot, whose axis is the line about which it swings, and the axle's com, whose radius is its share of the mass.  The
 * axle carries the rest of the robot where its line meets the plane through both of its contacts across the
 * ground.  So the polygon of a facet's contacts is cut where the rest would turn over a line from there to a contact,
 * and the axle over one of its own.  Where rounding may tell, less stands. */
#define SMAP_UNSURE 5e-6f  /* of the size: what is as near to the tolerance may be within it, or not */
#define SMAP_DEPTH 0.05f   /* of the height of the rest's com: a pivot counts as at least as far below it */
#define SMAP_ALONG 0.1001f /* least sine between an axle's line and the plane across it */
#define SMAP_UPON 1e-3f    /* of the size: with a pivot as near to a contact nothing stands, */
#define SMAP_LEVEL 1e-4f   /* sine: nor with one as level with both, and beside them */
#define SMAP_PULLED 20.0f  /* where the rest pulls the axle's com up it counts at most so many times as far off */
#define SMAP_SWUNG (2 * SMAP_MAX_CONTACTS + 4)

/* A polygon: its corners, the walls through the com and the edge from each to the next, and contacts near them. */
typedef struct {
  struct {
    float p[3], wall[3];
    uint8_t id;
  } at[SMAP_SWUNG];
  uint8_t count;
} smap_swung_t;

/* An axle: the first of its contacts, and where they touch; where it carries; its line; its com, and where that counts
 * when it is pulled up; the com of the rest, with what pulls; the shares of both. */
typedef struct {
  uint8_t own;
  const float *line;
  float ends[2][3], load[3][3], rest[3], mass, share; /* load: pivot, com, where it is pulled */
} smap_axle_t;

/* Find where the axle carries whose first contact is i; 0 where it does not. */
static int smap_find_pivot(const smap_work_t *w, uint8_t i, const float n[3], smap_axle_t *axle)
{
  const uint8_t at = (uint8_t)(SMAP_CONTACTS(w) + i);
  float *const pivot = axle->load[0], *const com = axle->load[1];
  float d[3], across[3], slope, part, apart, rise, further;
  uint8_t k;
  axle->own = i;
  axle->line = SMAP_AXLES(w)[smap_is_disc(w, at) ? w->axle_of[at] : 0];
  axle->mass = w->r[at + 1];
  smap_touch(w, i, n, axle->ends[0]);
  smap_touch(w, (uint8_t)(i + 1), n, axle->ends[1]);
  smap_minus(axle->ends[1], axle->ends[0], d);
  apart = smap_root(smap_dot(d, d));
  smap_cross(d, n, across);
  slope = apart > SMAP_UPON * SMAP_SIZE(w) && smap_unit(across) ? smap_dot(axle->line, across) : 0.0f;
  smap_minus(axle->ends[0], w->p[at], d);
  part = smap_dot(d, across) / slope;
  smap_plus(w->p[at], part, axle->line, pivot);
  memcpy(com, axle->mass > 0.0f ? w->p[at + 1] : pivot, sizeof d);
  smap_minus(com, pivot, d);
  rise = -smap_dot(d, n);
  further = (0.5f * apart - smap_dot(axle->ends[0], n) + smap_dot(com, n)) / rise; /* as if it lay at 45 deg */
  further = rise > 0.0f && further < SMAP_PULLED ? (further > 0.0f ? further : 0.0f) : SMAP_PULLED;
  part = axle->mass * further / (1.0f + further);
  axle->share = 1.0f - axle->mass + part;
  smap_plus(com, further, d, axle->load[2]);
  for (k = 0; k < 3; k++) {
    axle->rest[k] = (part * pivot[k] - axle->mass * com[k]) / axle->share;
  }
  return smap_absolute(slope) > SMAP_ALONG;
}

/* Cut a polygon along a wall. */
static void smap_cut(smap_swung_t *o, const float wall[3])
{
  const smap_swung_t old = *o;
  uint8_t k;
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
      memcpy(o->at[o->count].wall, in >= 0.0f ? wall : old.at[k].wall, sizeof old.at[k].wall);
      o->at[o->count++].id = old.at[part < 0.5f ? k : next].id;
    }
  }
}

/* Cut it along the sides of the outline of the pivot and other contacts from `level` on, as the com of the rest sees
 * them. */
static void smap_cut_rest(const smap_work_t *w, smap_swung_t *o, const float n[3], const smap_axle_t *axle,
                          const float *extent, float level)
{
  const float depth = level - smap_dot(axle->rest, n), least = w->map->least_height / axle->share;
  float p[SMAP_MAX_CONTACTS][3], arm[SMAP_MAX_CONTACTS][3], lever[3], side[3], wall[3], own[3];
  uint8_t id[SMAP_MAX_CONTACTS], count = 0, last, k, l;
  for (k = 0; k <= SMAP_CONTACTS(w); k++) { /* the pivot comes last */
    const int pivot = k == SMAP_CONTACTS(w);
    float low, rise;
    if (k == axle->own || k == axle->own + 1 || (!pivot && !(extent[k] >= level))) {
      continue;
    }
    smap_touch(w, k, n, wall);
    smap_minus(pivot ? axle->load[0] : wall, axle->rest, arm[count]);
    low = smap_dot(arm[count], n);
    rise = pivot && low < SMAP_DEPTH * depth ? SMAP_DEPTH * depth - low : 0.0f;
    smap_plus(arm[count], rise, n, arm[count]);
    for (l = 0; l < 3; l++) {
      p[count][l] = arm[count][l] * (depth / (low + rise));
    }
    id[count] = count;
    count++;
  }
  last = (uint8_t)(count - 1u);
  count = smap_outline(n, p, id, count);
  o->count = count > 2 && depth > 0.0f ? o->count : 0;
  smap_minus(axle->load[1], axle->load[0], lever);
  for (k = 0; k < count; k++) {
    const uint8_t i = id[k], j = id[k + 1 < count ? k + 1 : 0];
    smap_cross(arm[j], arm[i], wall);
    smap_minus(arm[i], arm[j], side);
    if (smap_dot(wall, wall) <= least * least * smap_dot(side, side)) {
      o->count = 0; /* the line is too near the com: see _lowest in contacts/many.py */
    }
    smap_cut(o, wall);
    if (axle->mass > 0.0f && (i == last || j == last)) { /* its weight turns the rest but about the line */
      smap_plus(side, -smap_dot(side, axle->line), axle->line, side);
      smap_cross(side, lever, own);
      for (l = 0; l < 3; l++) {
        wall[l] = axle->share * wall[l] + axle->mass * own[l];
      }
      smap_cut(o, wall);
    }
  }
}

/* Cut it where a load on the axle turns it over one of its contacts. */
static void smap_cut_axle(smap_swung_t *o, const float n[3], float size, const smap_axle_t *axle, uint8_t side,
                          const float load[3])
{
  float near[3], far[3], wall[3], above, square;
  uint8_t k;
  int level;
  smap_minus(axle->ends[side], load, near);
  smap_minus(axle->ends[1 - side], load, far);
  above = smap_dot(near, n);
  square = smap_dot(near, near);
  level = above * above <= SMAP_LEVEL * SMAP_LEVEL * square;
  if (!(square > SMAP_UPON * SMAP_UPON * size * size) || (level && !(smap_dot(near, far) < 0.0f))) {
    o->count = 0;
  } else if (above > 0.0f && !level) { /* else it hangs */
    smap_cross(axle->line, near, wall);
    size = smap_dot(wall, far) < 0.0f ? -size : size; /* walls are squares of lengths */
    for (k = 0; k < 3; k++) {
      wall[k] *= size;
    }
    smap_cut(o, wall);
  }
}

/* Add the rest on a plane so high that touches an axle, if it is one; 0 where it touches none.  `extent`: of each
 * contact along n. */
SMAP_APART static int smap_add_swung(smap_work_t *w, const float n[3], float height, const float *extent)
{
  const smap_limits_t *const m = w->map;
  const float unsure = SMAP_UNSURE * m->size, least = m->off > 0.0f ? 2.0f * unsure : 0.0f;
  /* What is on the plane in the middle of a box is on it in all of it: see stands_alike in control/limits.py. */
  const float level = height - (m->tolerance > least ? m->tolerance : least) + unsure;
  float p[SMAP_SWUNG][3], wall[SMAP_SWUNG][3];
  uint8_t id[SMAP_SWUNG], own = SMAP_NONE, count = 0, k;
  smap_axle_t axle;
  smap_swung_t o;
  int one = 1;
  for (k = 0; k < 2 * m->first[0]; k = (uint8_t)(k + 2)) {
    const float i = extent[k], j = extent[k + 1];
    if ((i > j ? i : j) >= level - 2.0f * (unsure + m->off * m->size)) {
      one = own == SMAP_NONE && (i < j ? i : j) >= level; /* not two axles, nor one side alone */
      own = k;
    }
  }
  if (own == SMAP_NONE || !one || !smap_find_pivot(w, own, n, &axle)) {
    return own != SMAP_NONE;
  }
  for (k = 0; k < SMAP_CONTACTS(w); k++) {
    if (extent[k] >= level) {
      smap_touch(w, k, n, p[count]);
      smap_plus(p[count], height - extent[k], n, p[count]);
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
  for (k = 0; k < (axle.mass > 0.0f ? 6 : 2); k++) {
    smap_cut_axle(&o, n, m->size, &axle, k & 1, axle.load[k / 2]);
  }
  for (k = 0, count = 0; k < o.count; k++) { /* but for dots */
    if (smap_apart2(o.at[k + 1 < o.count ? k + 1 : 0].p, o.at[k].p) > SMAP_DOT * SMAP_DOT * m->size * m->size) {
      memcpy(p[count], o.at[k].p, sizeof *p);
      memcpy(wall[count], o.at[k].wall, sizeof *wall);
      id[count++] = o.at[k].id;
    }
  }
  k = smap_add_rest(w, n, p, id, count, 0);
  if (k != SMAP_NONE) {
    memcpy(w->region->wall[k], wall, count * sizeof *wall);
  }
  return 1;
}
