/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The runtime on the machine of the exporter: many queries at a time, of blobs in memory.  Taken in behind
 * the parts of a family of codecs whose functions get its name.  No part of an export. */

/* `params`: as many numbers as the map has parameters for each query; `gravity`: three. */
void SMAP_HOST_NAME(read)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                          const float *gravity, int8_t *status, smap_reading_t *reading);
void SMAP_HOST_NAME(read)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                          const float *gravity, int8_t *status, smap_reading_t *reading)
{
  const smap_t map = {&smap_run, blob, size};
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] =
        (int8_t)smap_read(&map, params + i * blob[SMAP_AT_PARAMS], gravity + i * 3, reading + i);
  }
}

void SMAP_HOST_NAME(read_i)(const uint8_t *blob, uint32_t size, int64_t count, const int16_t *params,
                            const int16_t *gravity, int8_t *status, smap_reading_i_t *reading);
void SMAP_HOST_NAME(read_i)(const uint8_t *blob, uint32_t size, int64_t count, const int16_t *params,
                            const int16_t *gravity, int8_t *status, smap_reading_i_t *reading)
{
  const smap_t map = {&smap_run, blob, size};
  int64_t i;
  for (i = 0; i < count; i++) {
    status[i] =
        (int8_t)smap_read_i(&map, params + i * blob[SMAP_AT_PARAMS], gravity + i * 3, reading + i);
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
