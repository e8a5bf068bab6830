/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The runtime on the machine of the exporter: many queries at a time, of blobs in memory.  Taken in behind
 * the parts of a family of codecs whose functions get its name.  No part of an export. */

#if SMAP_MANY
/* Whether a row of bytes is the one before it; the WebAssembly has no library. */
static int smap_host_again(const void *row, uint32_t bytes)
{
  const uint8_t *const here = (const uint8_t *)row;
  uint32_t i;
  for (i = 0; i < bytes; i++) {
    if (here[i] != (here - bytes)[i]) {
      return 0;
    }
  }
  return 1;
}
#endif

/* `params`: as many numbers as the map has parameters for each query; `gravity`: three. */
void SMAP_HOST_NAME(read)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                          const float *gravity, int8_t *status, smap_reading_t *reading);
void SMAP_HOST_NAME(read)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                          const float *gravity, int8_t *status, smap_reading_t *reading)
{
  const smap_t map = {&smap_run, blob, size};
  const uint8_t width = blob[SMAP_AT_PARAMS];
  int64_t i;
#if SMAP_MANY
  smap_pose_memory_t pose;
  int8_t made = SMAP_INVALID;
#endif
  for (i = 0; i < count; i++) {
    const float *const row = params + i * width;
#if SMAP_MANY
    /* smap_read is smap_pose and smap_at.  Queries of one posture come one behind the other, and its
     * pose, which costs ten times as much as a reading of it, is made once. */
    if (i == 0 || !smap_host_again(row, width * (uint32_t)sizeof *row)) {
      made = (int8_t)smap_pose(&map, row, &pose, sizeof pose, SMAP_FLOAT);
    }
    status[i] = made != SMAP_OK ? smap_deny(reading + i, -SMAP_PI, made)
                                : (int8_t)smap_at(&pose, gravity + i * 3, reading + i);
#else
    status[i] = (int8_t)smap_read(&map, row, gravity + i * 3, reading + i);
#endif
  }
}

void SMAP_HOST_NAME(read_i)(const uint8_t *blob, uint32_t size, int64_t count, const int16_t *params,
                            const int16_t *gravity, int8_t *status, smap_reading_i_t *reading);
void SMAP_HOST_NAME(read_i)(const uint8_t *blob, uint32_t size, int64_t count, const int16_t *params,
                            const int16_t *gravity, int8_t *status, smap_reading_i_t *reading)
{
  const smap_t map = {&smap_run, blob, size};
  const uint8_t width = blob[SMAP_AT_PARAMS];
  int64_t i;
#if SMAP_MANY
  smap_pose_memory_i_t pose;
  int8_t made = SMAP_INVALID;
#endif
  for (i = 0; i < count; i++) {
    const int16_t *const row = params + i * width;
#if SMAP_MANY
    if (i == 0 || !smap_host_again(row, width * (uint32_t)sizeof *row)) {
      made = smap_run_pose_q(&map, row, &pose, sizeof pose, SMAP_INTEGER);
    }
    status[i] = made != SMAP_OK ? smap_deny_i(reading + i, made)
                                : (int8_t)smap_at_i(&pose, gravity + i * 3, reading + i);
#else
    status[i] = (int8_t)smap_read_i(&map, row, gravity + i * 3, reading + i);
#endif
  }
}

/* Both forms of one posture under many directions: what a program does that keeps its pose. */
int8_t SMAP_HOST_NAME(at)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                          const float *gravity, int8_t *status, smap_reading_t *reading);
int8_t SMAP_HOST_NAME(at)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                          const float *gravity, int8_t *status, smap_reading_t *reading)
{
  const smap_t map = {&smap_run, blob, size};
  smap_pose_memory_t pose;
  const int8_t made = (int8_t)smap_pose(&map, params, &pose, sizeof pose, SMAP_FLOAT);
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] = (int8_t)smap_at(&pose, gravity + i * 3, reading + i);
  }
  return made;
}

int8_t SMAP_HOST_NAME(at_i)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                            const int16_t *gravity, int8_t *status, smap_reading_i_t *reading);
int8_t SMAP_HOST_NAME(at_i)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                            const int16_t *gravity, int8_t *status, smap_reading_i_t *reading)
{
  const smap_t map = {&smap_run, blob, size};
  smap_pose_memory_i_t pose;
  const int8_t made = (int8_t)smap_pose(&map, params, &pose, sizeof pose, SMAP_INTEGER);
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] = (int8_t)smap_at_i(&pose, gravity + i * 3, reading + i);
  }
  return made;
}

int8_t SMAP_HOST_NAME(check)(const uint8_t *blob, uint32_t size);
int8_t SMAP_HOST_NAME(check)(const uint8_t *blob, uint32_t size)
{
  const smap_t map = {&smap_run, blob, size};
  return (int8_t)smap_check(&map);
}
