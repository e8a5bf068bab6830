/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* smap: reads the stability map of a variable-geometry robot from flash.
 *
 * C99, no heap, no globals, no recursion, every loop bounded; stdint.h and string.h only.
 * Frames and signs: body frame x forward, y left, z up; `gravity` points down and may have any
 * length above 0.  An accelerometer at rest reads the opposite: see smap_gravity_from_up.
 */
#ifndef SMAP_H
#define SMAP_H

#include <stdint.h>

#include "smap_config.h"

#define SMAP_VERSION 1

#ifdef __cplusplus
extern "C" {
#endif

typedef struct smap smap_t; /* a map: constant, in flash */

typedef struct {
  float sdg;       /* stability factor |SD_g|, in the map's length unit; NAN: not held, or tips */
  float tip_angle; /* rad until the robot tips, less the map's guard; negative: it tips */
  float height;    /* |OC|, height of the centre of mass over its support; NAN as for sdg */
} smap_reading_t;

typedef struct {
  uint16_t sdg;    /* in steps of NAME_SDG_STEP; 65535: not held, or tips */
  int16_t tip;     /* sine of the tip angle less the guard, in 1/32767; negative: it tips */
  uint16_t height; /* in steps of NAME_HEIGHT_STEP; 65535 as for sdg */
} smap_reading_i_t;

typedef enum {
  SMAP_OK = 0,        /* stands */
  SMAP_CLAMPED = 1,   /* stands in the nearest posture of the map; the real one lies outside */
  SMAP_TIPS = 2,      /* tips, or is so near that the map cannot exclude it */
  SMAP_OFF_CHART = 3, /* the map holds no such direction: taken as unsafe */
  SMAP_INVALID = -1   /* NaN, infinity or no gravity at all: taken as unsafe */
} smap_status_t;

/* Read a map.  `params`: one value for each geometry parameter, rad or length, in the map's order.
 * Unless the status is SMAP_OK or SMAP_CLAMPED the reading is unsafe: tip_angle < 0, sdg NAN. */
smap_status_t smap_read(const smap_t *map, const float *params, const float gravity[3],
                        smap_reading_t *out);

/* The same without any float, for maps of the codec `grid`.  `params_q`: 0 is an axis's lower end,
 * 32767 its upper end, below 0 is clamped.  `gravity_q`: any length above 0, such as raw counts. */
smap_status_t smap_read_i(const smap_t *map, const int16_t *params_q, const int16_t gravity_q[3],
                          smap_reading_i_t *out);

/* Turn what an accelerometer reads (at rest: up) into the gravity direction.  While the robot
 * accelerates that is gravity and inertia together, which is what tips it. */
void smap_gravity_from_up(const float up[3], float gravity[3]);

/* ---- internal: descriptors, written by the exporter -------------------------------------- */
#ifdef SMAP_INTERNAL

typedef struct {
  float min, max;     /* ends of the axis: rad or length */
  float inverse_span; /* 1 / (max - min) */
} smap_axis_t;

/* Each codec has switches, which smap_config.h may set first, and a struct. */
enum { SMAP_CODEC_CONTACTS = 1, SMAP_CODEC_GRID = 2, SMAP_CODEC_POLY = 3 };
enum { SMAP_SDG = 1, SMAP_TIP_ANGLE = 2, SMAP_HEIGHT = 4 }; /* bits of `channels` */

/* contacts: positions relative to the centre of mass as sums of weighted products of 1-D tables */
#ifndef SMAP_CONTACTS
#define SMAP_CONTACTS 1 /* codec `contacts`: 1 to build it */
#endif
#ifndef SMAP_CONTACTS_MANY
#define SMAP_CONTACTS_MANY 1 /* ... with more than three contacts, or with round ones */
#endif
#ifndef SMAP_MODES
#define SMAP_MODES 0 /* ... bits of its modes: 8, 16, or 0 to read either */
#endif
#ifndef SMAP_PRODUCTS
#define SMAP_PRODUCTS 1 /* ... with joints that move joints: products of modes */
#endif
typedef struct {
  const SMAP_FLASH uint8_t *shape; /* per parameter: number of modes, nodes of each */
  const SMAP_FLASH int8_t *codes8; /* modes, one after the other; one of the two is 0 */
  const SMAP_FLASH int16_t *codes16;
  const SMAP_FLASH uint8_t *products; /* pairs of entries */
  const SMAP_FLASH uint8_t *entries;  /* per term: coordinates to go on (2 bits), entry (6 bits) */
  const SMAP_FLASH int16_t *weights;  /* per term, in `length` */
  const SMAP_FLASH int16_t *radii;    /* per contact, in `length`; 0: points only */
  const SMAP_FLASH uint8_t *hinges;   /* per contact: its axis, or SMAP_NO_HINGE for spheres */
  float length;                       /* unit of the weights */
  float unit;                         /* value of one code */
  float steepest;                     /* a facet is accepted if -n_z is greater */
  float lowest;                       /* and if the com is higher above it */
  float rest_width;                   /* it stands still on a facet that is as wide everywhere */
  float tolerance;                    /* lengths that differ by less are equal */
  uint8_t contacts, axes, product_count;
  uint16_t terms;
} smap_contacts_t;
#define SMAP_NO_HINGE 255

/* BEGIN grid (owned by the grid codec) */
#ifndef SMAP_GRID
#define SMAP_GRID 1 /* codec `grid`, read with floats by smap_read */
#endif
#ifndef SMAP_GRID_INTEGER
#define SMAP_GRID_INTEGER 1 /* codec `grid`, read without floats by smap_read_i */
#endif
#ifndef SMAP_GRID_CHUNKS
#define SMAP_GRID_CHUNKS 0 /* ... 1 where objects must be small: large tables are then in chunks */
#endif
#define SMAP_CHUNK_BITS 13 /* a chunk has 2^13 codes, the last one of a table fewer */
#if SMAP_GRID_CHUNKS
#define SMAP_CUT 128u /* in `width`: `codes8` or `codes16` is the list of the table's chunks */
#ifdef SMAP_FAR
/* avr-gcc puts what has an address space into the low flash, where this much would push out of reach
 * what plain reads must find there.  So a chunk is a plain object among the code, and its alias says
 * how it is read; avr-gcc would warn that the alias has no value of its own. */
#pragma GCC diagnostic ignored "-Wuninitialized"
#define SMAP_CHUNK(type, name, count) \
  static const SMAP_FAR type name[count] __attribute__((__alias__(#name "_data"))); \
  static const type name##_data[count] \
      __attribute__((__section__(".text.smap_far"), __aligned__(2)))
#else
#define SMAP_FAR SMAP_FLASH
#define SMAP_CHUNK(type, name, count) static const SMAP_FLASH type name[count]
#endif
typedef const SMAP_FAR uint8_t *smap_chunk8_t;
typedef const SMAP_FAR uint16_t *smap_chunk16_t;
typedef void smap_codes8_t; /* codes or, where the table is cut, chunks */
typedef void smap_codes16_t;
#else
#define SMAP_CUT 0u
typedef uint8_t smap_codes8_t;
typedef uint16_t smap_codes16_t;
#endif
typedef struct {
  const SMAP_FLASH smap_codes8_t *codes8; /* nodes, C order; one of the two is 0 */
  const SMAP_FLASH smap_codes16_t *codes16;
  const SMAP_FLASH uint16_t *axes; /* innermost first: coordinate, nodes, first knot */
  uint32_t face_stride;            /* codes of one face; 0: all faces are alike */
  float offset[2], step;           /* value = offset + step * code */
  uint32_t zero[2]; /* without floats: the code of 0 in 1/65536 of the codes' range; for the
                       height its value at code 0 */
  uint16_t gain;    /* and the output of one such unit, times 2^shift */
  uint8_t shift, dims, width; /* axes, codes of a node (and SMAP_CUT) */
} smap_grid_part_t;
typedef struct {
  const SMAP_FLASH smap_grid_part_t *parts; /* tip margin, then sdg, then height if held */
  const SMAP_FLASH uint16_t *knots;         /* 0 to 65534 over the axis */
  float half;                               /* 32767 / chart_limit */
  uint32_t limit;                           /* chart_limit, times 2^13 and 32768/32767 */
  uint16_t guard;                           /* in 1/32767, for smap_read_i */
} smap_grid_t;
/* END grid */

/* BEGIN poly (owned by the poly codec) */
/* poly: the three contacts relative to the centre of mass as Chebyshev polynomials */
#ifndef SMAP_POLY
#define SMAP_POLY 1 /* codec `poly` */
#endif
typedef struct {
  const SMAP_FLASH uint8_t *shape; /* per contact: degree in each parameter, number of terms */
  const SMAP_FLASH int16_t *codes; /* per term: x, y, z */
  float unit;                      /* length of one code */
  uint8_t params;
} smap_poly_t;
/* END poly */

struct smap {
  uint8_t codec, params, channels, faces; /* faces: 1 (cone) or 6 (sphere) */
  float chart_limit;                      /* largest |u| and |v| on a face */
  float guard;                            /* rad, subtracted from tip_angle */
  const SMAP_FLASH smap_axis_t *axes;     /* one per parameter */
  const SMAP_FLASH void *body;            /* smap_contacts_t, smap_grid_t or smap_poly_t */
};

#endif /* SMAP_INTERNAL */

#ifdef __cplusplus
}
#endif
#endif
