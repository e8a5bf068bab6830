/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Where the contacts are, of codecs that compute that from the joints; see host.h. */

/* `place`: x, y, z of every contact for each row of parameters. */
void SMAP_HOST_NAME(positions)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                               float *place);
void SMAP_HOST_NAME(positions)(const uint8_t *blob, uint32_t size, int64_t count, const float *params,
                               float *place)
{
  const smap_t map = {&smap_run, blob, size};
  const int32_t width = 3 * blob[SMAP_AT_CONTACTS];
  float p[SMAP_MAX_COORDINATES];
  int64_t i;
  for (i = 0; i < count; i++) {
    smap_positions(&map, params + i * blob[SMAP_AT_PARAMS], p);
    memcpy(place + i * width, p, sizeof(float) * (size_t)width);
  }
}
