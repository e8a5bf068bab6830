/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* smap: the runtime.  Its promises are in smap.h, its tables in docs/reference/format.md. */
#define SMAP_INTERNAL
#include "smap.h"

#include <string.h>

#ifdef SMAP_ONLY
/* Built for one map: the compiler sees its tables, and its sizes and numbers become constants. */
#define SMAP_TABLES
#include SMAP_ONLY_FILE
#define MAP_OF(handle) ((void)(handle), (const SMAP_FLASH struct smap *)&SMAP_ONLY)
#else
#define MAP_OF(handle) ((const SMAP_FLASH struct smap *)(handle))
#endif

/* Unless code is to be small, loops of a known number of turns become straight code, and functions
 * part of their callers; for a map that is not known that would lengthen the code for little. */
#if defined(SMAP_ONLY) && defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define INLINE static inline __attribute__((__always_inline__))
#ifdef __clang__
#define UNROLL /* decides well by itself, and would warn of what it declines */
#else
#define UNROLL _Pragma("GCC unroll 256")
#endif
#else
#define INLINE static
#define UNROLL
#endif

#if defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define RARELY(condition) __builtin_expect((condition), 0)
#else
#define RARELY(condition) (condition)
#endif

#define PI 3.14159265f
#define LARGEST 3.402823466e+38f

typedef struct {
  float t[SMAP_MAX_PARAMS]; /* parameters over their axes, 0 to 1 */
  float d[3];               /* direction of gravity: 1 along the face's normal */
  float place[2];           /* on the face: u, v */
  uint8_t face;
} query_t;

#if SMAP_CONTACTS || SMAP_GRID || SMAP_POLY

INLINE float not_a_number(void)
{
  const uint32_t bits = 0x7FC00000u;
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* Square root of a finite x >= 0, correctly rounded. */
INLINE float root(float x)
{
  float result = x;
#if SMAP_HARDWARE_ROOT && defined(__ARM_FP) && (__ARM_FP & 4)
  __asm__("vsqrt.f32 %0, %1" : "=t"(result) : "t"(x));
#elif SMAP_HARDWARE_ROOT && defined(__aarch64__)
  __asm__("fsqrt %s0, %s1" : "=w"(result) : "w"(x));
#elif SMAP_HARDWARE_ROOT && defined(__riscv_flen)
  __asm__("fsqrt.s %0, %1" : "=f"(result) : "f"(x));
#elif SMAP_HARDWARE_ROOT && defined(__SSE__)
  __asm__("sqrtss %1, %0" : "=x"(result) : "x"(x));
#else
  /* Digit by digit: 24 binary digits and one to round by. */
  if (x > 0.0f) {
    uint32_t bits, mantissa, digits = 0, sum = 0, digit;
    int32_t exponent;
    memcpy(&bits, &x, sizeof bits);
    exponent = (int32_t)(bits >> 23);
    mantissa = bits & 0x7FFFFFu;
    if (exponent == 0) { /* denormal: at most 23 shifts */
      exponent = 1;
      while (mantissa < 0x800000u) {
        mantissa <<= 1;
        exponent--;
      }
    } else {
      mantissa |= 0x800000u;
    }
    exponent += 127; /* never negative, so that the shift below is defined */
    mantissa <<= 1 + (exponent & 1);
    for (digit = 0x1000000u; digit != 0; digit >>= 1) {
      const uint32_t trial = sum + digit;
      if (trial <= mantissa) {
        sum = trial + digit;
        mantissa -= trial;
        digits += digit;
      }
      mantissa <<= 1;
    }
    if (mantissa != 0) {
      digits += digits & 1u;
    }
    bits = (digits >> 1) + ((uint32_t)(exponent >> 1) << 23) - 0x800000u;
    memcpy(&result, &bits, sizeof result);
  }
#endif
  return result;
}

INLINE float absolute(float x)
{
#ifdef __GNUC__
  return __builtin_fabsf(x);
#else
  return x < 0.0f ? -x : x;
#endif
}

/* asin(x) in rad to 3e-7 (Cephes); arguments beyond 1 count as 1. */
INLINE float arcsine(float x)
{
  const float a = absolute(x);
  float z = x * x, s = x, y;
  if (a > 0.5f) {
    z = a < 1.0f ? 0.5f * (1.0f - a) : 0.0f;
    s = root(z);
  }
  y = 4.2163199048e-2f * z + 2.4181311049e-2f;
  y = (y * z + 4.5470025998e-2f) * z + 7.4953002686e-2f;
  y = s + s * z * (y * z + 1.6666752422e-1f);
  if (a > 0.5f) {
    y = 1.57079633f - (y + y);
    y = x < 0.0f ? -y : y;
  }
  return y;
}

INLINE uint32_t bits_of(float x)
{
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

INLINE int is_finite(float x)
{
  return bits_of(x) << 1 < 0xFF000000u;
}

/* Tell whether x is from 0 to 1; -0 is not, which does no harm. */
INLINE int up_to_one(float x)
{
  return bits_of(x) <= 0x3F800000u;
}

/* Tell whether x is above 0, and finite. */
INLINE int is_positive(float x)
{
  return bits_of(x) - 1u < 0x7F7FFFFFu;
}

/* Find the face of a direction and its place on it, on the face's rim where it lies off it by no
 * more than rounding; 0 where the chart does not hold it. */
INLINE int locate(const SMAP_FLASH struct smap *map, const float gravity[3], query_t *query)
{
  uint_fast8_t normal = 2, first = 0, second = 1, i;
  float depth = -gravity[2], toward = -1.0f;
  query->face = 0;
#if SMAP_SPHERE
  if (map->faces == 6) {
    uint_fast8_t face;
    for (face = 1; face < 6; face++) {
      const uint_fast8_t axis = face == 5 ? 2 : (uint_fast8_t)((face - 1) >> 1);
      const float along = (face & 1) ? gravity[axis] : -gravity[axis];
      if (along > depth) {
        depth = along;
        query->face = (uint8_t)face;
        toward = (face & 1) ? 1.0f : -1.0f;
        normal = axis;
      }
    }
    first = normal == 0;
    second = normal == 2 ? 1 : 2;
  }
#endif
  if (RARELY(!is_positive(depth))) {
    return 0;
  }
  query->d[normal] = toward;
  UNROLL
  for (i = 0; i < 2; i++) {
    const uint_fast8_t axis = i == 0 ? first : second;
    float place = gravity[axis] / depth;
    const float size = absolute(place);
    if (RARELY(!(size <= map->chart_limit))) {
      if (!(size <= map->chart_limit * 1.000001f)) {
        return 0;
      }
      place = place < 0.0f ? -map->chart_limit : map->chart_limit;
    }
    query->d[axis] = query->place[i] = place;
  }
  return 1;
}
#endif

/* ---- geometry ------------------------------------------------------------------------------- */
#if SMAP_CONTACTS || SMAP_POLY
INLINE float dot(const float a[3], const float b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

INLINE void cross(const float a[3], const float b[3], float out[3])
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}
#endif

#if SMAP_POLY || (SMAP_CONTACTS && !SMAP_CONTACTS_MANY)
/* Read three contact points: there is one facet, and the standing region is their cone. */
INLINE void read_three(const float p[9], float lowest, float steepest, float rest_width,
                       const float d[3], smap_reading_t *out)
{
  float edge[9], along[3], normal[3], pierced[3], det, size, steep;
  uint_fast8_t i;
  UNROLL
  for (i = 0; i < 3; i++) {
    float *const one = &edge[3 * i];
    cross(&p[3 * i], i == 2 ? p : &p[3 * i + 3], one);
    along[i] = dot(one, d) / root(dot(one, one));
  }
  UNROLL
  for (i = 0; i < 3; i++) {
    normal[i] = edge[i] + edge[i + 3] + edge[i + 6];
    pierced[i] = p[i] + p[i + 3] + p[i + 6];
  }
  det = dot(edge, &p[6]);
  steep = -normal[2];
  size = root(dot(normal, normal));
  out->height = det / size;
  if (RARELY(!(out->height > lowest))) { /* flat, or the corners run the other way round */
    out->height = -out->height;
    steep = -steep;
    UNROLL
    for (i = 0; i < 3; i++) {
      along[i] = -along[i];
    }
  }
  if (RARELY(!(out->height > lowest) || !(steep > steepest * size))) {
    return;
  }
  if (rest_width > 0.0f) { /* a triangle is least wide across its longest side */
    float longest = 0.0f;
    UNROLL
    for (i = 0; i < 3; i++) {
      const float *const from = &p[3 * i], *const to = i == 2 ? p : &p[3 * i + 3];
      const float x = to[0] - from[0], y = to[1] - from[1], z = to[2] - from[2];
      const float length = x * x + y * y + z * z;
      longest = length > longest ? length : longest;
    }
    if (RARELY(!(size * size >= rest_width * rest_width * longest))) {
      return;
    }
  }
  size = along[1] < along[0] ? along[1] : along[0];
  size = along[2] < size ? along[2] : size;
  out->tip_angle = arcsine(size / root(dot(d, d)));
  det /= dot(normal, d);
  UNROLL
  for (i = 0; i < 3; i++) {
    pierced[i] = det * d[i] - pierced[i] * 0.333333333f;
  }
  out->sdg = root(dot(pierced, pierced));
}
#endif

#if SMAP_CONTACTS
/* ---- codec `contacts` ------------------------------------------------------------------------
 * Tables give the contacts' positions; from there on everything is geometry, exact in gravity. */

typedef struct {
  const SMAP_FLASH smap_contacts_t *body;
  float p[3 * SMAP_MAX_CONTACTS]; /* centres, relative to the centre of mass */
#if SMAP_CONTACTS_MANY
  float hinge[3 * SMAP_MAX_HINGES]; /* unit axes of the discs */
  float rim[3 * SMAP_MAX_HINGES];   /* per axis the direction from a disc's centre to its contact */
  float down[3];                    /* the normal that the rims are for */
#endif
} posture_t;

#if SMAP_CONTACTS_MANY
static void subtract(const float a[3], const float b[3], float out[3])
{
  out[0] = a[0] - b[0];
  out[1] = a[1] - b[1];
  out[2] = a[2] - b[2];
}

/* Make a vector's length 1 and return what it was; a zero vector stays. */
static float normalise(float a[3])
{
  const float size = root(dot(a, a));
  if (size > 0.0f) {
    const float inverse = 1.0f / size;
    a[0] *= inverse;
    a[1] *= inverse;
    a[2] *= inverse;
  }
  return size;
}
#endif

/* Positions and axes of one posture: modes from their tables, products of modes, weighted sums. */
INLINE void assemble(posture_t *posture, uint_fast8_t params, const float *t)
{
  const SMAP_FLASH smap_contacts_t *body = posture->body;
  const float step = body->length * body->unit;
  float entry[SMAP_MAX_ENTRIES];
  uint_fast8_t count = 1, i, m;
  uint_fast16_t at = 0, coordinate = 0, term;
#if SMAP_CONTACTS_MANY
  const uint_fast16_t axes_from = (uint_fast16_t)(3 + 3 * body->contacts);
  float common[3] = {0.0f, 0.0f, 0.0f}; /* what all contacts share: the centre of mass moving */
#endif
  entry[0] = 1.0f / body->unit; /* entries are in codes */
  UNROLL
  for (i = 0; i < params; i++) {
    const uint_fast8_t modes = body->shape[2 * i];
    const uint_fast8_t last = (uint_fast8_t)(body->shape[2 * i + 1] - 1u); /* at least 1 */
    /* A rounding below the last node, so that the cell that begins there is never taken. */
    const float x = t[i] * ((float)last * 0.99999994f);
    uint_fast16_t cell = (uint_fast16_t)x;
    const float frac = x - (float)cell;
    cell = (uint_fast16_t)(cell + at);
    UNROLL
    for (m = 0; m < modes; m++) {
      float low, high;
#if SMAP_MODES == 8
      low = (float)body->codes8[cell];
      high = (float)body->codes8[cell + 1];
#elif SMAP_MODES == 16
      low = (float)body->codes16[cell];
      high = (float)body->codes16[cell + 1];
#else
      if (body->codes8) {
        low = (float)body->codes8[cell];
        high = (float)body->codes8[cell + 1];
      } else {
        low = (float)body->codes16[cell];
        high = (float)body->codes16[cell + 1];
      }
#endif
      entry[count++] = low + (high - low) * frac;
      cell = (uint_fast16_t)(cell + last + 1u);
      at = (uint_fast16_t)(at + last + 1u);
    }
  }
#if SMAP_PRODUCTS
  UNROLL
  for (i = 0; i < body->product_count; i++) {
    entry[count++] =
        entry[body->products[2 * i]] * entry[body->products[2 * i + 1]] * body->unit;
  }
#endif
  UNROLL
  for (i = 0; i < 3 * body->contacts; i++) {
    posture->p[i] = 0.0f;
  }
#if SMAP_CONTACTS_MANY
  for (i = 0; i < 3 * body->axes; i++) {
    posture->hinge[i] = 0.0f;
  }
#endif
  UNROLL
  for (term = 0; term < body->terms; term++) {
    const uint_fast8_t code = body->entries[term];
    const float value = (float)body->weights[term] * step * entry[code & 63u];
    coordinate = (uint_fast16_t)(coordinate + (code >> 6));
#if SMAP_CONTACTS_MANY
    if (coordinate < 3) {
      common[coordinate] += value;
    } else if (coordinate < axes_from) {
      posture->p[coordinate - 3] += value;
    } else {
      posture->hinge[coordinate - axes_from] += value;
    }
#else
    posture->p[coordinate] += value;
#endif
  }
#if SMAP_CONTACTS_MANY
  for (i = 0; i < body->contacts; i++) {
    for (m = 0; m < 3; m++) {
      posture->p[3 * i + m] += common[m];
    }
  }
  for (i = 0; i < body->axes; i++) {
    (void)normalise(&posture->hinge[3 * i]);
  }
#endif
}

#if !SMAP_CONTACTS_MANY
INLINE void contacts_read(const SMAP_FLASH smap_contacts_t *body, uint_fast8_t params,
                          const query_t *query, smap_reading_t *out)
{
  posture_t posture;
  posture.body = body;
  assemble(&posture, params, query->t);
  read_three(posture.p, body->lowest, body->steepest, body->rest_width, query->d, out);
}

#else /* SMAP_CONTACTS_MANY */

#define NONE 255
#define NEWTON_STEPS 8
#define WALK_STEPS 24

/* A support facet: unit outward normal, height, its corners counter-clockwise. */
typedef struct {
  float n[3];
  float height;
  uint8_t count;
  uint8_t corner[SMAP_MAX_CONTACTS];
} facet_t;

/* Look at planes with the unit normal n: from here on contact_point answers for them. */
static void aim(posture_t *posture, const float n[3])
{
  uint8_t i, k;
  memcpy(posture->down, n, sizeof posture->down);
  for (i = 0; i < posture->body->axes; i++) {
    float *const rim = &posture->rim[3 * i];
    const float *const hinge = &posture->hinge[3 * i];
    const float along = dot(n, hinge);
    for (k = 0; k < 3; k++) {
      rim[k] = n[k] - along * hinge[k];
    }
    if (normalise(rim) < 1e-4f) {
      rim[0] = rim[1] = rim[2] = 0.0f; /* lies on its face: touches in no single point */
    }
  }
}

/* The point of a contact that extends furthest along the normal. */
static void contact_point(const posture_t *posture, uint8_t i, float out[3])
{
  const SMAP_FLASH smap_contacts_t *body = posture->body;
  memcpy(out, &posture->p[3 * i], 3 * sizeof *out);
  if (body->radii) {
    const float radius = (float)body->radii[i] * body->length;
    const uint8_t hinge = body->hinges[i];
    const float *const to = hinge == SMAP_NO_HINGE ? posture->down : &posture->rim[3 * hinge];
    out[0] += radius * to[0];
    out[1] += radius * to[1];
    out[2] += radius * to[2];
  }
}

/* How far a contact extends along the normal. */
static float extent(const posture_t *posture, uint8_t i)
{
  float point[3];
  contact_point(posture, i, point);
  return dot(point, posture->down);
}

/* The contact that extends furthest along the normal. */
static uint8_t support(const posture_t *posture)
{
  uint8_t i, best = 0;
  float reach = -LARGEST;
  for (i = 0; i < posture->body->contacts; i++) {
    const float value = extent(posture, i);
    if (value > reach) {
      reach = value;
      best = i;
    }
  }
  return best;
}

/* Find height and corners of the facet with normal facet->n; 0 where it is none: three corners must
 * touch its plane, and the centre of mass must lie above it. */
static int outline(posture_t *posture, facet_t *facet)
{
  const float tolerance = posture->body->tolerance;
  const uint8_t total = posture->body->contacts;
  float here[3], furthest = -1.0f;
  uint32_t touching = 0;
  uint8_t first = 0, i, at;
  facet->count = 0;
  aim(posture, facet->n);
  facet->height = extent(posture, support(posture));
  if (!(facet->height > tolerance)) {
    return 0;
  }
  /* Start at the touching contact that is furthest from the centre of mass. */
  for (i = 0; i < total; i++) {
    if (extent(posture, i) >= facet->height - tolerance) {
      float size;
      contact_point(posture, i, here);
      size = dot(here, here);
      touching |= (uint32_t)1 << i;
      if (size > furthest) {
        furthest = size;
        first = i;
      }
    }
  }
  at = first;
  do { /* gift wrapping: at most `total` corners */
    uint8_t next = NONE;
    float step[3] = {0.0f, 0.0f, 0.0f}, length = 0.0f;
    contact_point(posture, at, here);
    for (i = 0; i < total; i++) {
      float point[3], other[3], turn, size;
      if (!(touching >> i & 1u)) {
        continue;
      }
      contact_point(posture, i, point);
      subtract(point, here, point);
      size = root(dot(point, point));
      if (size <= tolerance) {
        continue;
      }
      cross(step, point, other);
      turn = dot(other, facet->n);
      if (next == NONE || turn < -tolerance * length ||
          (turn <= tolerance * length && size > length && dot(step, point) > 0.0f)) {
        next = i;
        length = size;
        memcpy(step, point, sizeof step);
      }
    }
    if (next == NONE) {
      return 0;
    }
    facet->corner[facet->count++] = at;
    at = next;
  } while (at != first && facet->count < total);
  return facet->count >= 3 && at == first;
}

/* Roll a plane with the unit normal `normal` over the contacts a - b until the next one touches, to
 * the right of a - b seen along the normal; with b = NONE over a alone, about `axis`.  Writes the
 * new normal to `next` and returns the contact that was met, or NONE. */
static uint8_t roll(posture_t *posture, const float normal[3], uint8_t a, uint8_t b,
                    const float *axis, facet_t *next)
{
  float *const n = next->n;
  uint8_t step, found = NONE;
  memcpy(n, normal, sizeof next->n);
  for (step = 0; step < NEWTON_STEPS; step++) {
    float from[3], edge[3], outward[3], x = 1.0f, y = 0.0f, lowest = 1.99f, change;
    uint8_t i;
    aim(posture, n);
    contact_point(posture, a, from);
    if (b == NONE) {
      memcpy(edge, axis, sizeof edge);
    } else {
      contact_point(posture, b, edge);
      subtract(edge, from, edge);
    }
    (void)normalise(edge);
    change = dot(n, edge);
    for (i = 0; i < 3; i++) {
      n[i] -= change * edge[i];
    }
    (void)normalise(n);
    cross(edge, n, outward);
    aim(posture, n);
    found = NONE;
    for (i = 0; i < posture->body->contacts; i++) {
      float point[3], aside, above, turn;
      if (i == a || i == b) {
        continue;
      }
      contact_point(posture, i, point);
      subtract(point, from, point);
      aside = dot(point, outward);
      above = -dot(point, n);
      /* A measure that grows with the angle of turn: -1 .. 0 .. 2 for -90 .. 0 .. 180 deg. */
      if (above >= 0.0f) {
        turn = 1.0f - aside / ((aside < 0.0f ? -aside : aside) + above + 1e-30f);
      } else if (aside > 0.0f) {
        turn = aside / (aside - above) - 1.0f;
      } else {
        continue;
      }
      if (turn < lowest) {
        lowest = turn;
        found = i;
        x = aside;
        y = above;
      }
    }
    if (found == NONE) {
      return NONE;
    }
    for (i = 0; i < 3; i++) {
      n[i] = n[i] * x + outward[i] * y;
    }
    (void)normalise(n);
    if (step > 0 && y < 1e-6f * x && -y < 1e-6f * x) {
      break;
    }
  }
  return found;
}

/* Tell whether the robot stands still on a facet: it is accepted, and as wide as a rest is. */
static int is_rest(posture_t *posture, const facet_t *facet)
{
  float least = LARGEST;
  uint8_t i, k;
  if (!(-facet->n[2] > posture->body->steepest) || !(facet->height > posture->body->lowest)) {
    return 0;
  }
  aim(posture, facet->n);
  for (i = 0; i < facet->count; i++) {
    float from[3], along[3], inward[3], width = 0.0f;
    contact_point(posture, facet->corner[i], from);
    contact_point(posture, facet->corner[i + 1 == facet->count ? 0 : i + 1], along);
    subtract(along, from, along);
    cross(facet->n, along, inward);
    (void)normalise(inward);
    for (k = 0; k < facet->count; k++) {
      float point[3], away;
      contact_point(posture, facet->corner[k], point);
      subtract(point, from, point);
      away = dot(point, inward);
      away = away < 0.0f ? -away : away;
      width = away > width ? away : width;
    }
    least = width < least ? width : least;
  }
  return least >= posture->body->rest_width;
}

/* Find a facet to start from: lower a plane that is level under g onto the contacts, lean it over
 * the first one towards the com's ray until it touches a second, and over both onto a third. */
static int first_facet(posture_t *posture, const float g[3], facet_t *facet)
{
  float from[3], lean[3], axis[3], reach;
  uint8_t a, b, i;
  aim(posture, g);
  a = support(posture);
  reach = extent(posture, a);
  contact_point(posture, a, from);
  for (i = 0; i < 3; i++) {
    lean[i] = reach * g[i] - from[i];
  }
  if (dot(lean, lean) < posture->body->tolerance * posture->body->tolerance) {
    lean[0] = g[1] * g[1] + g[2] * g[2]; /* the first one lies on the ray: lean any way */
    lean[1] = -g[0] * g[1];
    lean[2] = -g[0] * g[2];
    if (lean[0] < 0.5f) {
      lean[0] = -g[1] * g[0];
      lean[1] = g[0] * g[0] + g[2] * g[2];
      lean[2] = -g[1] * g[2];
    }
  }
  cross(g, lean, axis);
  b = roll(posture, g, a, NONE, axis, facet);
  if (b == NONE) {
    return 0;
  }
  if (outline(posture, facet)) {
    return 1;
  }
  contact_point(posture, b, lean);
  contact_point(posture, a, from);
  cross(from, lean, axis);
  memcpy(lean, facet->n, sizeof lean);
  /* Over the edge, to the side on which g lies. */
  b = dot(axis, g) < 0.0f ? roll(posture, lean, a, b, 0, facet)
                          : roll(posture, lean, b, a, 0, facet);
  return b != NONE && outline(posture, facet);
}

/* The edge whose wall g lies nearest to or furthest outside of, its two contacts being a corner of the
 * facet and the next one; `sine` of how far inside. */
static uint8_t nearest_edge(posture_t *posture, const facet_t *facet, const float g[3], float *sine)
{
  float from[3], to[3], wall[3];
  uint8_t i, nearest = 0;
  *sine = LARGEST;
  aim(posture, facet->n);
  for (i = 0; i < facet->count; i++) {
    float inside;
    contact_point(posture, facet->corner[i], from);
    contact_point(posture, facet->corner[i + 1 == facet->count ? 0 : i + 1], to);
    cross(from, to, wall);
    inside = dot(wall, g) / root(dot(wall, wall));
    if (inside < *sine) {
      *sine = inside;
      nearest = i;
    }
  }
  return nearest;
}

/* |SD_g| on a facet: from the area centroid of its outline to the point that g pierces. */
static float stability_factor(posture_t *posture, const facet_t *facet, const float g[3])
{
  float base[3], before[3], sum[3] = {0.0f, 0.0f, 0.0f}, area = 0.0f, reach;
  uint8_t i, k;
  aim(posture, facet->n);
  contact_point(posture, facet->corner[0], base);
  contact_point(posture, facet->corner[1], before);
  subtract(before, base, before);
  for (i = 2; i < facet->count; i++) {
    float after[3], normal[3], part;
    contact_point(posture, facet->corner[i], after);
    subtract(after, base, after);
    cross(before, after, normal);
    part = dot(normal, facet->n);
    for (k = 0; k < 3; k++) {
      sum[k] += part * (before[k] + after[k]);
    }
    area += part;
    memcpy(before, after, sizeof before);
  }
  area = 0.333333333f / area;
  reach = facet->height / dot(facet->n, g);
  for (k = 0; k < 3; k++) {
    sum[k] = reach * g[k] - (base[k] + sum[k] * area);
  }
  return root(dot(sum, sum));
}

/* The standing region is the cones of the rests: in a gap between two of them the answer is tips,
 * whether the robot would be caught there or not. */
static void contacts_read(const SMAP_FLASH smap_contacts_t *body, uint8_t params,
                          const query_t *query, smap_reading_t *out)
{
  posture_t posture;
  facet_t facet, other;
  float g[3], sine;
  uint8_t step = 0, at;
  posture.body = body;
  assemble(&posture, params, query->t);
  memcpy(g, query->d, sizeof g);
  (void)normalise(g);
  if (!first_facet(&posture, g, &facet)) {
    return;
  }
  at = nearest_edge(&posture, &facet, g, &sine);
  while (sine < 0.0f) {
    const uint8_t a = facet.corner[at];
    const uint8_t b = facet.corner[at + 1 == facet.count ? 0 : at + 1];
    if (step == WALK_STEPS || roll(&posture, facet.n, a, b, 0, &other) == NONE ||
        !outline(&posture, &other)) {
      return;
    }
    at = nearest_edge(&posture, &other, g, &sine);
    if (sine < 0.0f && other.corner[at] == b) {
      return; /* in the gap between the two */
    }
    facet = other;
    step++;
  }
  if (!is_rest(&posture, &facet)) {
    return;
  }
  out->sdg = stability_factor(&posture, &facet, g);
  out->height = facet.height;
  out->tip_angle = arcsine(sine);
}
#endif /* SMAP_CONTACTS_MANY */
#endif

#if SMAP_GRID || SMAP_GRID_INTEGER
/* ---- codec `grid` -----------------------------------------------------------------------------
 * Multilinear tables over (parameters, v, u).  The axes of a table come innermost
 * first.  A corner of the cell is reached from the one before by one jump, and merged at once: no
 * weights, and at a node every difference is taken 0 or 1 times, so that the node comes out. */
#define GRID_AXES (SMAP_MAX_PARAMS + 2)
#define GRID_U 254u
#define GRID_V 255u
#if SMAP_GRID_CHUNKS
/* Where a code is: two short shifts, since a processor of 8 bits takes long for a long one. */
#define CHUNK(at) ((uint16_t)((at) >> 8) >> (SMAP_CHUNK_BITS - 8))
#define WITHIN(at) ((at) & (((uint16_t)1 << SMAP_CHUNK_BITS) - 1u))
#define CODE8(part, at) code8(part, at)
#define CODE16(part, at) code16(part, at)
#define WIDTH(part) ((part)->width & (SMAP_CUT - 1u))

static uint8_t code8(const SMAP_FLASH smap_grid_part_t *part, uint32_t at)
{
  if (part->width & SMAP_CUT) {
    return ((const SMAP_FLASH smap_chunk8_t *)part->codes8)[CHUNK(at)][WITHIN(at)];
  }
  return ((const SMAP_FLASH uint8_t *)part->codes8)[at];
}

static uint16_t code16(const SMAP_FLASH smap_grid_part_t *part, uint32_t at)
{
  if (part->width & SMAP_CUT) {
    return ((const SMAP_FLASH smap_chunk16_t *)part->codes16)[CHUNK(at)][WITHIN(at)];
  }
  return ((const SMAP_FLASH uint16_t *)part->codes16)[at];
}
#else
#define CODE8(part, at) (part)->codes8[at]
#define CODE16(part, at) (part)->codes16[at]
#define WIDTH(part) (part)->width
#endif

/* Find the first knot of the cell of a place on an axis; a knot is in the cell that it begins.
 * Each turn halves what is left, whatever the place. */
INLINE const SMAP_FLASH uint16_t *cell_of(const SMAP_FLASH uint16_t *knots, uint16_t nodes,
                                          uint32_t x)
{
  const SMAP_FLASH uint16_t *lower = knots;
  uint32_t left;
  UNROLL
  for (left = nodes - 1u; left > 1; left = (left + 1) >> 1) {
    if (x >= lower[left >> 1]) {
      lower += left >> 1;
    }
  }
  return lower;
}

#if SMAP_GRID
/* Find the cell that holds the query: the first corner, the way to the next ones, the place. */
INLINE uint32_t grid_cell(const SMAP_FLASH smap_grid_t *grid,
                          const SMAP_FLASH smap_grid_part_t *part, const query_t *query,
                          uint32_t jump[GRID_AXES], float frac[GRID_AXES])
{
  const SMAP_FLASH uint16_t *axis = part->axes;
  uint32_t at = query->face * part->face_stride, stride = WIDTH(part), back = 0;
  uint8_t i;
  UNROLL
  for (i = 0; i < part->dims; i++, axis += 3) {
    const SMAP_FLASH uint16_t *knots = grid->knots + axis[2];
    const SMAP_FLASH uint16_t *lower;
    float x;
    if (axis[0] >= GRID_U) {
      /* The exporter has seen to it that this is from 0 to 65534 on the whole face. */
      x = query->place[axis[0] == GRID_U ? 0 : 1] * grid->half + 32767.0f;
    } else {
      x = query->t[axis[0]] * 65534.0f;
    }
    lower = cell_of(knots, axis[1], (uint32_t)(int32_t)x);
    frac[i] = (x - (float)lower[0]) / (float)(lower[1] - lower[0]);
    at += (uint32_t)(lower - knots) * stride;
    jump[i] = stride - back;
    back += stride;
    stride *= axis[1];
  }
  return at;
}

INLINE float grid_value(const SMAP_FLASH smap_grid_part_t *part, uint32_t at,
                        const uint32_t jump[GRID_AXES], const float frac[GRID_AXES])
{
  const uint16_t corners = (uint16_t)(1u << part->dims);
  float below[GRID_AXES], value = 0.0f;
  uint16_t corner;
  UNROLL
  for (corner = 0; corner < corners; corner++) {
    value = part->codes8 ? (float)CODE8(part, at) : (float)CODE16(part, at);
    uint8_t level;
    UNROLL
    for (level = 0; corner >> level & 1u; level++) {
      value = below[level] + (value - below[level]) * frac[level];
    }
    if (level == part->dims) {
      break;
    }
    below[level] = value;
    at += jump[level];
  }
  return value;
}

INLINE void grid_read(const SMAP_FLASH smap_grid_t *grid, const query_t *query, uint8_t channels,
                      smap_reading_t *out)
{
  const SMAP_FLASH smap_grid_part_t *part = grid->parts;
  uint32_t jump[GRID_AXES];
  float frac[GRID_AXES];
  const float u = query->place[0], v = query->place[1];
  uint32_t at = grid_cell(grid, part, query, jump, frac);
  const float mu = part->offset[0] + part->step * grid_value(part, at, jump, frac);
  const float slant = root(1.0f + u * u + v * v);
  out->tip_angle = arcsine(mu / slant);
  if (channels & SMAP_SDG) {
    float along, aside;
    part++;
    at = grid_cell(grid, part, query, jump, frac);
    along = part->offset[0] + part->step * grid_value(part, at, jump, frac);
    aside = part->offset[1] + part->step * grid_value(part, at + 1u, jump, frac);
    out->sdg = root(along * along + aside * aside);
  }
  if (channels & SMAP_HEIGHT) {
    part++;
    at = grid_cell(grid, part, query, jump, frac);
    out->height = part->offset[0] + part->step * grid_value(part, at, jump, frac);
  }
}
#endif

#if SMAP_GRID_INTEGER
typedef struct {
  uint32_t at, jump[GRID_AXES];
  uint16_t frac[GRID_AXES]; /* 0 to 16384 */
} cell_t;

/* Square root, rounded down, of at most 3 * 2^30, which is the longest direction. */
INLINE uint32_t whole_root(uint32_t x)
{
#if defined(__ARM_FEATURE_IDIV) && defined(__ARM_FEATURE_CLZ) && !defined(__OPTIMIZE_SIZE__)
  /* From above, by Newton: off by up to 41 %, 6 %, 0.2 %, 1.6e-6, and at last by less than 1. */
  const uint32_t odd = x | 1u; /* so that nothing is divided by 0 */
  uint32_t result = (uint32_t)1 << ((33 - __builtin_clz(odd)) >> 1);
  uint8_t step;
  UNROLL
  for (step = 0; step < 4; step++) {
    result = (result + odd / result) >> 1;
  }
  return result - (result * result > x);
#else
  uint32_t result = 0, digit;
  for (digit = (uint32_t)1 << 30; digit != 0; digit >>= 2) {
    if (x >= result + digit) {
      x -= result + digit;
      result = (result >> 1) + digit;
    } else {
      result >>= 1;
    }
  }
  return result;
#endif
}

/* `place`: params, u, v, each 0 to 65534. */
INLINE void grid_cell_i(const SMAP_FLASH smap_grid_t *grid,
                        const SMAP_FLASH smap_grid_part_t *part, const uint16_t *place,
                        uint8_t params, uint8_t face, cell_t *cell)
{
  const SMAP_FLASH uint16_t *axis = part->axes;
  uint32_t stride = WIDTH(part), back = 0;
  uint8_t i;
  cell->at = face * part->face_stride;
  UNROLL
  for (i = 0; i < part->dims; i++, axis += 3) {
    const SMAP_FLASH uint16_t *knots = grid->knots + axis[2];
    const uint16_t x = place[axis[0] >= GRID_U ? params + axis[0] - GRID_U : axis[0]];
    const SMAP_FLASH uint16_t *lower = cell_of(knots, axis[1], x);
    cell->frac[i] = (uint16_t)(((uint32_t)(x - lower[0]) << 14) / (uint32_t)(lower[1] - lower[0]));
    cell->at += (uint32_t)(lower - knots) * stride;
    cell->jump[i] = stride - back;
    back += stride;
    stride *= axis[1];
  }
}

/* The value between two, rounded down; at a node one of the weights is 0 and the node comes out. */
INLINE uint32_t between(uint32_t low, uint32_t high, uint32_t frac)
{
  return (low * (16384u - frac) + high * frac) >> 14;
}

/* The value of a cell in 1/65536 of the codes' range, rounded down. */
INLINE uint32_t grid_value_i(const SMAP_FLASH smap_grid_part_t *part, const cell_t *cell,
                             uint8_t component)
{
  const uint16_t corners = (uint16_t)(1u << part->dims);
  uint16_t below[GRID_AXES];
  uint32_t at = cell->at + component, value = 0;
  uint16_t corner;
  UNROLL
  for (corner = 0; corner < corners; corner++) {
    value = part->codes8 ? (uint32_t)CODE8(part, at) << 8 : CODE16(part, at);
    uint8_t level;
    UNROLL
    for (level = 0; corner >> level & 1u; level++) {
      value = between(below[level], value, cell->frac[level]);
    }
    if (level == part->dims) {
      break;
    }
    below[level] = (uint16_t)value;
    at += cell->jump[level];
  }
  return value;
}

smap_status_t smap_read_i(const smap_t *handle, const int16_t *params_q,
                          const int16_t gravity_q[3], smap_reading_i_t *out)
{
  const SMAP_FLASH struct smap *map = MAP_OF(handle);
  const SMAP_FLASH smap_grid_t *grid = (const SMAP_FLASH smap_grid_t *)map->body;
  const SMAP_FLASH smap_grid_part_t *part;
  smap_status_t status = SMAP_OK;
  uint16_t place[GRID_AXES];
  uint32_t size[3], largest = 0, deep, cosine, value;
  uint8_t i, tips, face = 0, normal = 2;
  cell_t cell;
  out->sdg = 65535;
  out->height = 65535;
  out->tip = -32767;
  if (map->codec != SMAP_CODEC_GRID) {
    return SMAP_INVALID;
  }
  part = grid->parts;
  UNROLL
  for (i = 0; i < map->params; i++) {
    place[i] = (uint16_t)((uint16_t)params_q[i] * 2u);
    if (params_q[i] < 0) {
      place[i] = 0;
      status = SMAP_CLAMPED;
    }
  }
  UNROLL
  for (i = 0; i < 3; i++) {
    size[i] = (uint32_t)(gravity_q[i] < 0 ? -(int32_t)gravity_q[i] : gravity_q[i]);
    if (size[i] > largest) {
      largest = size[i];
    }
  }
  if (largest == 0) {
    return SMAP_INVALID;
  }
  for (; largest < 16384u; largest <<= 1) { /* at most 14 times */
    size[0] <<= 1;
    size[1] <<= 1;
    size[2] <<= 1;
  }
#if SMAP_SPHERE
  if (map->faces == 6) { /* of equal components the lower face, as in `locate` */
    uint32_t most = gravity_q[2] < 0 ? size[2] : 0;
    for (i = 1; i < 6; i++) {
      const uint8_t axis = i == 5 ? 2 : (uint8_t)((i - 1) >> 1);
      if (size[axis] > most && ((i & 1) != 0) == (gravity_q[axis] > 0)) {
        most = size[axis];
        face = i;
        normal = axis;
      }
    }
  } else
#endif
      if (gravity_q[2] >= 0) {
    return SMAP_OFF_CHART;
  }
  deep = size[normal] * grid->limit >> 13;
  if (deep == 0) {
    return SMAP_OFF_CHART;
  }
  UNROLL
  for (i = 0; i < 2; i++) {
    const uint8_t axis = i == 0 ? normal == 0 : normal == 2 ? 1 : 2;
    uint32_t away;
    if (size[axis] > deep) {
      if (size[axis] > deep + 1u) {
        return SMAP_OFF_CHART;
      }
      size[axis] = deep;
    }
    away = (size[axis] << 15) / deep;
    if (away > 32767u) {
      away = 32767;
    }
    place[map->params + i] = (uint16_t)(gravity_q[axis] < 0 ? 32767u - away : 32767u + away);
  }
  /* Rounded so that the sine is too small rather than too large. */
  cosine = (size[normal] << 14) /
           (whole_root(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]) + 1u);
  grid_cell_i(grid, part, place, map->params, face, &cell);
  value = grid_value_i(part, &cell, 0);
  tips = value < part->zero[0];
  value = tips ? part->zero[0] - value : value - part->zero[0];
  value = (value * cosine >> 14) * part->gain >> part->shift;
  if (value > 32767u) {
    value = 32767;
  }
  out->tip = (int16_t)(tips ? -1 - (int32_t)value : (int32_t)value - (int32_t)grid->guard);
  if (out->tip < 0) {
    return SMAP_TIPS;
  }
  if (map->channels & SMAP_SDG) {
    int32_t along, aside;
    part++;
    grid_cell_i(grid, part, place, map->params, face, &cell);
    along = ((int32_t)grid_value_i(part, &cell, 0) - (int32_t)part->zero[0]) / 2;
    aside = ((int32_t)grid_value_i(part, &cell, 1) - (int32_t)part->zero[1]) / 2;
    out->sdg = (uint16_t)whole_root((uint32_t)(along * along) + (uint32_t)(aside * aside));
  }
  if (map->channels & SMAP_HEIGHT) {
    part++;
    grid_cell_i(grid, part, place, map->params, face, &cell);
    out->height =
        (uint16_t)(part->zero[0] + (grid_value_i(part, &cell, 0) * part->gain >> part->shift));
  }
  return status;
}
#endif
#endif
#if SMAP_POLY
/* ---- codec `poly`: three contacts as Chebyshev polynomials of the parameters ----------------- */

/* Sum one contact's terms, in codes; return the codes of the next contact. */
static const SMAP_FLASH int16_t *poly_point(const SMAP_FLASH uint8_t *shape,
                                            const SMAP_FLASH int16_t *codes, uint8_t params,
                                            const float *t, float point[3])
{
  /* Per parameter T_n and T_(n-1) of the present term, with T_-1 = T_1. */
  float value[SMAP_MAX_PARAMS], before[SMAP_MAX_PARAMS];
  uint32_t degrees = 0; /* n of each parameter, 4 bits: the exporter keeps to 8 parameters */
  uint_fast8_t j, term, most = 0, total = 0;
  for (j = 0; j < params; j++) {
    value[j] = 1.0f;
    before[j] = t[j] + t[j] - 1.0f;
    if (shape[j] > most) {
      most = shape[j];
    }
  }
  point[0] = point[1] = point[2] = 0.0f;
  for (term = 0; term < shape[params]; term++) {
    float weight = 1.0f;
    for (j = 0; j < params; j++) {
      weight *= value[j];
    }
    for (j = 0; j < 3; j++) {
      point[j] += weight * (float)*codes++;
    }
    for (j = 0; j < params; j++) { /* count on, the first parameter fastest */
      const float s = t[j] + t[j] - 1.0f;
      const uint_fast8_t degree = (uint_fast8_t)(degrees >> 4 * j & 15u);
      if (degree < shape[j] && total < most) {
        const float next = 2.0f * s * value[j] - before[j];
        before[j] = value[j];
        value[j] = next;
        degrees += (uint32_t)1 << 4 * j;
        total++;
        break;
      }
      total = (uint_fast8_t)(total - degree);
      degrees -= (uint32_t)degree << 4 * j;
      value[j] = 1.0f;
      before[j] = s;
    }
  }
  return codes;
}

static void poly_read(const SMAP_FLASH smap_poly_t *body, const query_t *query, smap_reading_t *out)
{
  const SMAP_FLASH uint8_t *shape = body->shape;
  const SMAP_FLASH int16_t *codes = body->codes;
  float p[9];
  uint_fast8_t i;
  for (i = 0; i < 9; i += 3) {
    codes = poly_point(shape, codes, body->params, query->t, &p[i]);
    shape += body->params + 1;
  }
  for (i = 0; i < 9; i++) {
    p[i] *= body->unit;
  }
  /* The exporter has made sure that the facet is a rest in every posture: -n_z > -2. */
  read_three(p, 0.0f, -2.0f, 0.0f, query->d, out);
}
#endif

#if SMAP_CONTACTS || SMAP_GRID || SMAP_POLY
/* Tell whether there is a direction at all.  What is not finite never gets as far as a reading: it
 * is neither within the ends of an axis nor on a chart. */
static int usable(const float gravity[3])
{
  uint32_t any = 0;
  uint_fast8_t i;
  for (i = 0; i < 3; i++) {
    if (!is_finite(gravity[i])) {
      return 0;
    }
    any |= bits_of(gravity[i]) << 1;
  }
  return any != 0;
}

/* Answer what is no reading. */
INLINE smap_status_t refuse(smap_reading_t *out, float tip_angle, smap_status_t status)
{
  out->sdg = not_a_number();
  out->tip_angle = tip_angle;
  out->height = out->sdg;
  return status;
}

smap_status_t smap_read(const smap_t *handle, const float *params, const float gravity[3],
                        smap_reading_t *out)
{
  const SMAP_FLASH struct smap *map = MAP_OF(handle);
  smap_status_t status = SMAP_OK;
  smap_reading_t reading;
  query_t query;
  uint_fast8_t i;
#ifdef SMAP_ONLY
  query.t[0] = 0.0f; /* a map without parameters: some compilers then miss it */
#endif
  UNROLL
  for (i = 0; i < map->params; i++) {
    const SMAP_FLASH smap_axis_t *axis = &map->axes[i];
    float t = (params[i] - axis->min) * axis->inverse_span;
    if (RARELY(!up_to_one(t))) {
      if (!is_finite(params[i])) {
        return refuse(out, -PI, SMAP_INVALID);
      }
      if (t > 1.0f) {
        t = 1.0f;
        status = SMAP_CLAMPED;
      } else if (t < 0.0f) {
        t = 0.0f;
        status = SMAP_CLAMPED;
      }
    }
    query.t[i] = t;
  }
  if (RARELY(!locate(map, gravity, &query))) {
    return refuse(out, -PI, usable(gravity) ? SMAP_OFF_CHART : SMAP_INVALID);
  }
  reading.tip_angle = -PI;
  reading.sdg = reading.height = 0.0f;
  switch (map->codec) {
#if SMAP_CONTACTS
  case SMAP_CODEC_CONTACTS:
    contacts_read((const SMAP_FLASH smap_contacts_t *)map->body, map->params, &query, &reading);
    break;
#endif
#if SMAP_GRID
  case SMAP_CODEC_GRID:
    grid_read((const SMAP_FLASH smap_grid_t *)map->body, &query, map->channels, &reading);
    break;
#endif
#if SMAP_POLY
  case SMAP_CODEC_POLY:
    poly_read((const SMAP_FLASH smap_poly_t *)map->body, &query, &reading);
    break;
#endif
  default:
    return refuse(out, -PI, SMAP_INVALID);
  }
  reading.tip_angle -= map->guard;
  if (RARELY(!(reading.tip_angle >= 0.0f))) {
    return refuse(out, reading.tip_angle, SMAP_TIPS);
  }
  out->sdg = map->channels & SMAP_SDG ? reading.sdg : not_a_number();
  out->tip_angle = reading.tip_angle;
  out->height = map->channels & SMAP_HEIGHT ? reading.height : not_a_number();
  return status;
}
#endif

void smap_gravity_from_up(const float up[3], float gravity[3])
{
  gravity[0] = -up[0];
  gravity[1] = -up[1];
  gravity[2] = -up[2];
}
