/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- polygon: the outline of the contacts on a plane, its centroid and its width ---------------------- */

/* Order the places p of some contacts around a plane, counter-clockwise as corners are, those inside left out; 0
 * where rounding lets no outline close. */
static uint8_t smap_outline(const float n[3], float (*p)[3], uint8_t *id, uint8_t count)
{
  uint8_t first = 0, k, placed = 0, at;
  float most = -1.0f;
  for (k = 1; k < count; k++) { /* the furthest from any is a corner */
    const float far = smap_apart2(p[k], p[0]);
    if (far > most) {
      most = far;
      first = k;
    }
  }
  at = first;
  while (placed < count) {
    uint8_t next = SMAP_NONE, j;
    float in[3] = {0.0f, 0.0f, 0.0f}, d[3], size = 0.0f;
    for (j = 0; j < 3; j++) { /* corners that are found come first */
      const float x = p[placed][j];
      p[placed][j] = p[at][j];
      p[at][j] = x;
    }
    k = id[placed];
    id[placed] = id[at];
    id[at] = k;
    for (k = 0; k < count; k++) {
      float turn;
      if (k == placed || (k < placed && k > 0)) {
        continue;
      }
      smap_minus(p[k], p[placed], d);
      turn = next == SMAP_NONE ? -1.0f : smap_dot(d, in);
      if (turn < 0.0f || (turn <= 0.0f && smap_dot(d, d) > size)) {
        next = k;
        size = smap_dot(d, d);
        smap_cross(d, n, in);
      }
    }
    placed++;
    if (next == 0 || next == SMAP_NONE) {
      return next == 0 ? placed : 0;
    }
    at = next;
  }
  return 0;
}

/* Tells whether a polygon is as wide as a rest in every direction. */
static int smap_is_wide(const smap_work_t *w, const float n[3], float (*p)[3], uint8_t count)
{
  const float width = w->map->rest_width;
  uint8_t i, j;
  for (i = 0; i < count; i++) {
    const uint8_t next = i + 1 < count ? (uint8_t)(i + 1) : (uint8_t)0;
    float u[3], in[3], from, most = 0.0f;
    smap_minus(p[next], p[i], u);
    smap_cross(u, n, in);
    from = smap_dot(p[i], in);
    for (j = 0; j < count; j++) {
      const float far = smap_dot(p[j], in) - from;
      most = far > most ? far : most;
    }
    if (!(most > 0.0f && most * most >= width * width * smap_dot(u, u))) {
      return 0;
    }
  }
  return 1;
}

/* Find the area centroid of a polygon; 0 where it is not as wide as a rest in every direction. */
static int smap_measure(const smap_work_t *w, const float n[3], float (*p)[3], uint8_t count,
                        float centre[3])
{
  const float width = w->map->rest_width;
  float sum[3] = {0.0f, 0.0f, 0.0f}, area = 0.0f;
  uint8_t i, k;
  int wide = 0;
  for (i = 1; i + 1 < count; i++) { /* a fan of triangles from corner 0: one as wide is enough */
    float a[3], b[3], in[3], part, longest, other, third;
    smap_minus(p[i], p[0], a);
    smap_minus(p[i + 1], p[0], b);
    smap_cross(b, a, in);
    part = smap_dot(in, n);
    area += part;
    longest = smap_dot(a, a);
    other = smap_dot(b, b);
    third = longest + other - 2.0f * smap_dot(a, b); /* has all digits where it is the longest */
    longest = other > longest ? other : longest;
    longest = third > longest ? third : longest;
    wide |= part > 0.0f && part * part >= width * width * longest; /* across its longest side */
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      sum[k] += part * (a[k] + b[k]);
    }
  }
  if (!wide && (count == 3 || !smap_is_wide(w, n, p, count))) {
    return 0;
  }
  smap_plus(p[0], 1.0f / (3.0f * area), sum, centre);
  return 1;
}
