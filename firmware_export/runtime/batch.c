/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The runtime on the machine of the exporter: many queries at a time, of tables in memory.
 *
 * The certificate asks this, so that it speaks of the C that ships: smap.c is taken in as it is,
 * with all codecs.  No part of an export. */
#include <float.h>

#if defined(__FAST_MATH__) || FLT_EVAL_METHOD != 0
#error "singles must round to singles, as on the targets: no fast math, and SSE on x86"
#endif

#ifndef BATCH
#define BATCH(name) name##_many
#endif
#define SMAP_MAX_PARAMS 255 /* as many as `struct smap` can count */
#define smap_read BATCH(smap_read)
#define smap_read_i BATCH(smap_read_i)
#define smap_gravity_from_up BATCH(smap_gravity_from_up)
#include "smap.c"

/* `params`: map->params numbers for each query; `gravity`: three. */
void BATCH(batch)(const struct smap *map, int64_t count, const float *params, const float *gravity,
                  int8_t *status, smap_reading_t *reading);
void BATCH(batch)(const struct smap *map, int64_t count, const float *params, const float *gravity,
                  int8_t *status, smap_reading_t *reading)
{
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] =
        (int8_t)smap_read(map, params + i * map->params, gravity + i * 3, reading + i);
  }
}

#if SMAP_GRID_INTEGER
void BATCH(batch_i)(const struct smap *map, int64_t count, const int16_t *params,
                    const int16_t *gravity, int8_t *status, smap_reading_i_t *reading);
void BATCH(batch_i)(const struct smap *map, int64_t count, const int16_t *params,
                    const int16_t *gravity, int8_t *status, smap_reading_i_t *reading)
{
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] =
        (int8_t)smap_read_i(map, params + i * map->params, gravity + i * 3, reading + i);
  }
}

/* What this was built from: the digest of the files beside it. */
const char *smap_sources(void);
const char *smap_sources(void)
{
  return SMAP_SOURCES;
}
#endif
