/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The runtime on the machine of the exporter: many queries at a time, of blobs in memory.  Compiled once for
 * each family, SMAP_FAMILY, whose functions get its name.  No part of an export. */
#define SMAP_HOST
#define SMAP_MAX_PARAMS 64
#define SMAP_MAX_ENTRIES 255
#define SMAP_MAX_COORDINATES 255
#define SMAP_SERIES 1
#define SMAP_TURNS 1
#define SMAP_CONTROL 1
#define SMAP_MAX_CONTACTS 62
#define SMAP_RAILS 62
#define SMAP_DISCS 62
#define SMAP_PIVOTS 20
#define SMAP_MAX_RESTS 60
#define SMAP_MAX_CORNERS 154
#define SMAP_MAX_GAPS 50
#define SMAP_MAX_ARCS 254
#define SMAP_MAX_FACETS 250
#define SMAP_MAX_SIDES 20

#define SMAP_TEXT(file) #file
#define SMAP_FILE(family) SMAP_TEXT(smap_##family.c)
#define SMAP_FILE_OF(family) SMAP_FILE(family)
#define SMAP_NAME(family, what) smap_##family##_host_##what
#define SMAP_NAME_OF(family, what) SMAP_NAME(family, what)
#define SMAP_HOST_NAME(what) SMAP_NAME_OF(SMAP_FAMILY, what)

#include "smap.h"
#include "smap_control.h"

#include SMAP_FILE_OF(SMAP_FAMILY)

/* How many rows are as the first of them; the WebAssembly has no library. */
static int64_t smap_host_alike(const void *rows, uint32_t bytes, int64_t count)
{
  const uint8_t *const first = (const uint8_t *)rows;
  int64_t i = bytes;
  while (i < count * bytes && first[i] == first[i - bytes]) {
    i++;
  }
  return bytes != 0 ? i / bytes : count;
}

/* One posture under many directions, which a program does that keeps its pose; returns the status of smap_pose. */
int8_t SMAP_HOST_NAME(at)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                          const float *gravity, int8_t *status, smap_reading_t *reading)
{
  const smap_t map = {&smap_run, blob, size};
  smap_pose_memory_t pose;
  const int8_t made = (int8_t)smap_pose(&map, params, &pose.head, sizeof pose, SMAP_FLOAT);
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] = (int8_t)smap_at(&pose.head, gravity + i * 3, reading + i);
  }
  return made;
}

int8_t SMAP_HOST_NAME(at_i)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                            const int16_t *gravity, int8_t *status, smap_reading_i_t *reading)
{
  const smap_t map = {&smap_run, blob, size};
  smap_pose_memory_i_t pose;
  const int8_t made = (int8_t)smap_pose(&map, params, &pose.head, sizeof pose, SMAP_INTEGER);
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] = (int8_t)smap_at_i(&pose.head, gravity + i * 3, reading + i);
  }
  return made;
}

/* `params`: as many numbers as the map has parameters for each query; `gravity`: three.  Queries of one posture come
 * one behind the other, and its pose, which costs more than a reading of it, is made once. */
void SMAP_HOST_NAME(read)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                          const float *gravity, int8_t *status, smap_reading_t *reading)
{
  const uint8_t width = blob[SMAP_AT_PARAMS];
  int64_t i, alike;
  for (i = 0; i < count; i += alike) {
    alike = smap_host_alike(params + i * width, width * (uint32_t)sizeof *params, count - i);
    (void)SMAP_HOST_NAME(at)(blob, size, alike, params + i * width, gravity + i * 3, status + i, reading + i);
  }
}

void SMAP_HOST_NAME(read_i)(const uint8_t *blob, uint32_t size, int64_t count, const int16_t *params,
                            const int16_t *gravity, int8_t *status, smap_reading_i_t *reading)
{
  const smap_t map = {&smap_run, blob, size};
  const uint8_t width = blob[SMAP_AT_PARAMS];
  smap_pose_memory_i_t pose;
  int64_t i, alike = 0;
  for (i = 0; i < count; i++, alike--) {
    if (alike == 0) {
      alike = smap_host_alike(params + i * width, width * (uint32_t)sizeof *params, count - i);
      (void)smap_run_pose_q(&map, params + i * width, &pose.head, sizeof pose, SMAP_INTEGER);
    }
    status[i] = (int8_t)smap_at_i(&pose.head, gravity + i * 3, reading + i);
  }
}

int8_t SMAP_HOST_NAME(check)(const uint8_t *blob, uint32_t size)
{
  const smap_t map = {&smap_run, blob, size};
  return (int8_t)smap_check(&map);
}

/* Returns the digest of the files from which this was built. */
const char *SMAP_HOST_NAME(sources)(void)
{
  return SMAP_SOURCES;
}

#ifdef SMAP_STEERED_BY
#include SMAP_STEERED_BY
#include "smap_host_control.h"
#endif
#ifdef SMAP_NO_AXIS /* contacts follow from joints */
/* `place`: x, y, z of every contact for each row of parameters. */
void SMAP_HOST_NAME(positions)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                               float *place)
{
  const smap_t map = {&smap_run, blob, size};
  const int32_t width = 3 * blob[SMAP_AT_CONTACTS];
  float p[SMAP_MAX_COORDINATES];
  int64_t i;
  for (i = 0; i < count; i++) {
    smap_positions(&map, params + i * blob[SMAP_AT_PARAMS], p);
    memcpy(place + i * width, p, sizeof(float) * (uint32_t)width);
  }
}
#endif
#ifdef SMAP_DRAWN_BY
#include SMAP_DRAWN_BY
#endif
