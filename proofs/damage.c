/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* libFuzzer damages the blob of one export and mends its CRC: what smap_check lets pass must neither
 * lead a read astray nor keep it for ever, whatever it then says.  Compiled with SMAP_HOST, so that the
 * functions of the export read the blob that they are given. */
#include "@NAME@.c"

#include <stdlib.h>

#define QUERY (@PARAMS@ * 4 + 12)
#define EDIT 3 /* bytes of an edit: where (two), and what */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void seal(uint8_t *blob, uint32_t bytes)
{
  const uint32_t crc = smap_crc(blob + 4, bytes - 4);
  int i;
  for (i = 0; i < 4; i++) {
    blob[i] = (uint8_t)(crc >> 8 * i);
  }
}

static void ask(const smap_t *map, const uint8_t *query)
{
  float params[@PARAMS@ + 1], gravity[3];
  int16_t params_q[@PARAMS@ + 1], gravity_q[3];
  smap_reading_t reading;
  smap_reading_i_t reading_i;
  @NAME@_pose_t *const pose = malloc(sizeof *pose);
  memcpy(params, query, @PARAMS@ * 4);
  memcpy(params_q, query, @PARAMS@ * 2);
  memcpy(gravity, query + @PARAMS@ * 4, 12);
  memcpy(gravity_q, query + @PARAMS@ * 4 + 3, 6);
  memset(pose, 0, sizeof *pose);
  (void)smap_read(map, params, gravity, &reading);
  (void)smap_read_i(map, params_q, gravity_q, &reading_i);
  (void)smap_pose(map, params, &pose->pose, sizeof *pose, @FORMS@);
  (void)smap_at(&pose->pose, gravity, &reading);
  (void)smap_at_i(&pose->pose, gravity_q, &reading_i);
  (void)smap_pose_q(map, params_q, &pose->pose, sizeof *pose, SMAP_INTEGER);
  (void)smap_at_i(&pose->pose, gravity_q, &reading_i);
  free(pose);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  uint8_t *blob;
  smap_t map;
  size_t at;
  if (size < QUERY + 2) {
    return 0;
  }
  /* The first two bytes: how much of the end is cut off, mostly nothing. */
  map.run = &smap_run;
  map.size = SMAP_OWN_BYTES - (data[0] < 16 ? (uint32_t)(data[0] << 8 | data[1]) % SMAP_OWN_BYTES : 0u);
  blob = malloc(map.size > 4 ? map.size : 4);
  memcpy(blob, SMAP_OWN_BLOB, map.size);
  map.blob = blob;
  if (map.size > 8 && data[0] < 16) { /* it says its new size */
    for (at = 0; at < 4; at++) {
      blob[4 + at] = (uint8_t)(map.size >> 8 * at);
    }
  }
  for (at = 2; at + EDIT + QUERY <= size; at += EDIT) {
    const uint32_t where = (uint32_t)(data[at] << 8 | data[at + 1]) % map.size;
    blob[where] = data[at + 2];
  }
  if (map.size > 4) {
    seal(blob, map.size);
  }
  if (smap_check(&map) == SMAP_OK) {
    ask(&map, data + size - QUERY);
  }
  free(blob);
  return 0;
}
