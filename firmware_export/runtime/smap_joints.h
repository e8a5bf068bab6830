/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
#include "smap_query.h"

/* ---- joints: where the contacts are -----------------------------------------------------------------
 * Every coordinate is a sum of weighted products of sines and cosines of revolute joints and of travels
 * of prismatic ones: exact for any tree of joints.  Behind what is for many contacts the body
 * of the map has
 *
 *   weights f32[terms]; rates f32[angles] with SMAP_RATED; radii f32[contacts] with SMAP_ROUND;
 *   joint of each angle and travel u8; products u8[2 products]; axis of each contact u8 where there are axes;
 *   terms of each coordinate u8; entry of each term u8
 *
 * With SMAP_BY_SERIES they are something else, see below.
 * With SMAP_NEAR no angle is ever beyond 1.05 rad.  Entries: 0 is the number 1; then sine and cosine of each
 * angle, the travels, the products.
 * Coordinates: with SMAP_COMMON three that every contact has in common (the centre of mass moving),
 * then x, y, z of every contact relative to it, then x, y, z of every axis. */
enum { SMAP_COMMON = 1, SMAP_RATED = 2, SMAP_ROUND = 4, SMAP_NEAR = 8, SMAP_BY_SERIES = 16, SMAP_WIDE = 32 };
enum {
  SMAP_IN_ANGLES = 0,        /* u8, as the next three */
  SMAP_IN_TRAVELS = 1,
  SMAP_IN_PRODUCTS = 2,
  SMAP_IN_AXES = 3,
  SMAP_IN_TERMS = 4,         /* u16 */
  SMAP_IN_FLAGS = 6,         /* u8; 7 order u8, see smap_three.h */
  SMAP_IN_LOWEST = 8,        /* f32: a facet carries if the centre of mass is higher over it, */
  SMAP_IN_STEEPEST = 12,     /* f32: and if -n_z is greater */
  SMAP_IN_REST_WIDTH = 16,   /* f32 */
  SMAP_IN_MANY_BYTES = 20,   /* u16, of what is for many contacts, see smap_pose.h */
  SMAP_IN_MANY = 22
};
#define SMAP_NO_AXIS 255 /* of a point or a sphere */

/* Where each table of the body begins. */
typedef struct {
  smap_bytes_t weights, rates, radii, joints, products, axis_of, counts, entries, end;
  uint8_t contacts, coordinates;
} smap_places_t;

SMAP_FOLDED smap_places_t smap_places(const smap_t *map)
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t angles = body[SMAP_IN_ANGLES], flags = body[SMAP_IN_FLAGS];
  const uint16_t terms = smap_u16(body + SMAP_IN_TERMS);
  smap_places_t at;
  at.contacts = SMAP_BLOB(map)[SMAP_AT_CONTACTS];
  at.coordinates = (uint8_t)((flags & SMAP_COMMON ? 3 : 0) + 3 * at.contacts + 3 * body[SMAP_IN_AXES]);
  at.weights = body + SMAP_IN_MANY + smap_u16(body + SMAP_IN_MANY_BYTES);
  at.rates = at.weights + 4 * terms;
  at.radii = at.rates + (flags & SMAP_RATED ? 4 * angles : 0);
  at.joints = at.radii + (flags & SMAP_ROUND ? 4 * at.contacts : 0);
  at.products = at.joints + angles + body[SMAP_IN_TRAVELS];
  at.axis_of = at.products + 2 * body[SMAP_IN_PRODUCTS];
  at.counts = at.axis_of + (body[SMAP_IN_AXES] != 0 ? at.contacts : 0);
  at.entries = at.counts + at.coordinates;
  at.end = at.entries + terms;
  return at;
}

/* The entries of one posture. */
SMAP_FOLDED void smap_entries(const smap_t *map, const smap_places_t *at, const float *q,
                              float entry[SMAP_MAX_ENTRIES])
{
  const smap_bytes_t body = smap_body(map);
  const uint8_t angles = body[SMAP_IN_ANGLES], travels = body[SMAP_IN_TRAVELS];
  uint8_t count = 1, i;
  entry[0] = 1.0f;
  SMAP_FOLD
  for (i = 0; i < angles; i++, count = (uint8_t)(count + 2)) {
    float angle = q[at->joints[i]];
    if (body[SMAP_IN_FLAGS] & SMAP_RATED) {
      angle *= smap_f32(at->rates + 4 * i);
    }
    if (body[SMAP_IN_FLAGS] & SMAP_NEAR) {
      smap_sine_cosine_near(angle, &entry[count], &entry[count + 1]);
    } else {
      smap_sine_cosine(angle, &entry[count], &entry[count + 1]);
    }
  }
  SMAP_FOLD
  for (i = 0; i < travels; i++) {
    entry[count++] = q[at->joints[angles + i]];
  }
  SMAP_FOLD
  for (i = 0; i < body[SMAP_IN_PRODUCTS]; i++) {
    entry[count++] = entry[at->products[2 * i]] * entry[at->products[2 * i + 1]];
  }
}

/* Tells whether products are of entries before them, and terms of entries; `fixed` of these are no products. */
SMAP_PLAIN int smap_check_entries(smap_bytes_t products, uint32_t count, uint32_t fixed, smap_bytes_t entries,
                                  uint32_t terms)
{
  uint32_t i;
  for (i = 0; i < count; i++) {
    if (!smap_check_below(products + 2 * i, 2, fixed + i)) {
      return 0;
    }
  }
  return smap_check_below(entries, terms, fixed + count);
}

#include "smap_series.h"

/* Contacts relative to the centre of mass, p[3 * contact], and after them the unit axes of discs. */
SMAP_FOLDED void smap_positions(const smap_t *map, const float *q, float *p)
{
  const smap_places_t at = smap_places(map);
  const uint8_t shared = smap_body(map)[SMAP_IN_FLAGS] & SMAP_COMMON ? 3 : 0;
  float entry[SMAP_MAX_ENTRIES], common[3];
  uint16_t term = 0, i, k;
  if (SMAP_SERIES && (smap_body(map)[SMAP_IN_FLAGS] & SMAP_BY_SERIES)) {
    smap_series_positions(map, q, p);
    return;
  }
  smap_entries(map, &at, q, entry);
  SMAP_FOLD
  for (i = 0; i < at.coordinates; i++) {
    const uint8_t count = at.counts[i];
    float sum = 0.0f;
    SMAP_FOLD
    for (k = 0; k < count; k++, term++) {
      const float value = smap_f32(at.weights + 4 * term) * entry[at.entries[term]];
      sum = k == 0 ? value : sum + value;
    }
    *(i < shared ? &common[i] : &p[i - shared]) = sum;
  }
  if (shared) {
    SMAP_FOLD
    for (i = 0; i < 3 * at.contacts; i = (uint16_t)(i + 3)) {
      SMAP_FOLD
      for (k = 0; k < 3; k++) {
        p[i + k] += common[k];
      }
    }
  }
}

/* The tables of positions: indices of joints, entries and axes, and sizes, up to `limit`. */
static int smap_check_positions(const smap_t *map, smap_bytes_t limit)
{
  const smap_bytes_t body = smap_body(map);
  uint32_t sum = 0, fixed, i;
  uint16_t terms;
  smap_places_t at;
  if (limit - body < SMAP_IN_MANY) {
    return 0;
  }
  if (SMAP_SERIES && (body[SMAP_IN_FLAGS] & SMAP_BY_SERIES)) {
    return smap_check_singles(body + SMAP_IN_LOWEST, 3, 4, SMAP_LARGEST) && smap_check_series(map, limit);
  }
  terms = smap_u16(body + SMAP_IN_TERMS);
  fixed = 1u + 2u * body[SMAP_IN_ANGLES] + body[SMAP_IN_TRAVELS];
  if (fixed + body[SMAP_IN_PRODUCTS] > SMAP_MAX_ENTRIES ||
      3u * SMAP_BLOB(map)[SMAP_AT_CONTACTS] + 3u * body[SMAP_IN_AXES] > SMAP_MAX_COORDINATES ||
      3u + 3u * SMAP_BLOB(map)[SMAP_AT_CONTACTS] + 3u * body[SMAP_IN_AXES] > 255u ||
      body[SMAP_IN_FLAGS] > 15) {
    return 0;
  }
  at = smap_places(map);
  if (at.end != limit || !smap_check_singles(body + SMAP_IN_LOWEST, 3, 4, SMAP_LARGEST) ||
      !smap_check_singles(at.weights, (uint32_t)(at.joints - at.weights) / 4u, 4, SMAP_LARGEST) ||
      !smap_check_below(at.joints, (uint32_t)(at.products - at.joints), SMAP_BLOB(map)[SMAP_AT_PARAMS])) {
    return 0;
  }
  for (i = 0; at.axis_of + i < at.counts; i++) {
    if (at.axis_of[i] != SMAP_NO_AXIS && at.axis_of[i] >= body[SMAP_IN_AXES]) {
      return 0;
    }
  }
  for (i = 0; i < at.coordinates; i++) {
    sum += at.counts[i];
  }
  return sum == terms && smap_check_entries(at.products, body[SMAP_IN_PRODUCTS], fixed, at.entries, terms);
}
