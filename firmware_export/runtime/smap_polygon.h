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
    float d[3];
    smap_minus(p[k], p[0], d);
    if (smap_dot(d, d) > most) {
      most = smap_dot(d, d);
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

/* Find the centroid of a triangle; 0 where it is not as wide as a rest: it is least wide across its longest side. */
static int smap_measure_triangle(const smap_work_t *w, float (*p)[3], float centre[3])
{
  const float width = w->map->rest_width;
  float a[3], b[3], in[3], longest, other, third;
  uint8_t k;
  smap_minus(p[1], p[0], a);
  smap_minus(p[2], p[0], b);
  smap_cross(b, a, in);
  longest = smap_dot(a, a);
  other = smap_dot(b, b);
  third = longest + other - 2.0f * smap_dot(a, b); /* to the last digits where it is the longest */
  longest = other > longest ? other : longest;
  longest = third > longest ? third : longest;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    centre[k] = p[0][k] + (a[k] + b[k]) * (1.0f / 3.0f);
  }
  other = smap_dot(in, in);
  return other > 0.0f && other >= width * width * longest;
}

/* Find the area centroid of a polygon; 0 where it is not as wide as a rest in every direction. */
static int smap_measure(const smap_work_t *w, const float n[3], float (*p)[3], uint8_t count, float centre[3])
{
  const float width = w->map->rest_width;
  float area = 0.0f;
  uint8_t i, j, k;
  centre[0] = centre[1] = centre[2] = 0.0f;
  for (i = 0; i < count; i++) {
    const uint8_t next = i + 1 < count ? (uint8_t)(i + 1) : 0;
    float u[3], in[3], from, most = 0.0f;
    smap_minus(p[next], p[i], u);
    smap_cross(u, n, in);
    from = smap_dot(p[i], in);
    for (j = 0; j < count; j++) {
      if (j != i && j != next) {
        const float far = smap_dot(p[j], in) - from;
        most = far > most ? far : most;
      }
    }
    if (!(most > 0.0f && most * most >= width * width * smap_dot(u, u))) {
      return 0;
    }
    if (i > 0 && next != 0) { /* a fan from corner 0 */
      float a[3], b[3], part;
      smap_minus(p[i], p[0], a);
      smap_minus(p[next], p[0], b);
      smap_cross(b, a, in);
      part = smap_dot(in, n);
      area += part;
      SMAP_THRICE
      for (k = 0; k < 3; k++) {
        centre[k] += part * (a[k] + b[k]);
      }
    }
  }
  area = 1.0f / (3.0f * area);
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    centre[k] = p[0][k] + centre[k] * area;
  }
  return 1;
}
