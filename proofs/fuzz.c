/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* libFuzzer asks one export; what must hold of every answer is checked here, what must hold of every
 * access by the sanitizers. */
#define SMAP_INTERNAL
#include "@NAME@.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEMAND(claim)                                   \
  do {                                                  \
    if (!(claim)) {                                     \
      fprintf(stderr, "broken claim: %s\n", #claim);    \
      abort();                                          \
    }                                                   \
  } while (0)

#if @INTEGER@
typedef int16_t number_t;
typedef smap_reading_i_t answer_t;
#define READ smap_read_i
#define UNSAFE(answer) \
  ((answer).tip < 0 && (answer).sdg == 65535 && (answer).height == 65535)
#define SAFE(answer) ((answer).tip >= 0)
#define LOWER(i) 0
#define UPPER(i) 32767
#define TWICE(x) ((number_t)((x) * 2))
#define CAN_DOUBLE(x) ((x) > -16384 && (x) < 16384)
#else
typedef float number_t;
typedef smap_reading_t answer_t;
#define READ smap_read
#define UNSAFE(answer) \
  ((answer).tip_angle < 0.0f && (answer).sdg != (answer).sdg && (answer).height != (answer).height)
#define SAFE(answer) ((answer).tip_angle >= 0.0f && !((answer).sdg < 0.0f))
#define LOWER(i) (((const struct smap *)&@NAME@)->axes[i].min)
#define UPPER(i) (((const struct smap *)&@NAME@)->axes[i].max)
#define TWICE(x) ((x) * 2.0f)
/* normal numbers before and after, or 0 */
#define CAN_DOUBLE(x) \
  ((x) == 0.0f || ((x) > 1e-30f && (x) < 1e30f) || ((x) < -1e-30f && (x) > -1e30f))
#endif

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  number_t *params, *gravity;
  answer_t first, second;
  smap_status_t status, again;
  int i, outside = 0, can_double = 1;
  if (size < (@PARAMS@ + 3) * sizeof(number_t)) {
    return 0;
  }
  /* On the heap and of just that size, so that a read beyond an end is seen. */
  params = malloc(@PARAMS@ * sizeof *params);
  gravity = malloc(3 * sizeof *gravity);
  DEMAND(params && gravity);
  memcpy(params, data, @PARAMS@ * sizeof *params);
  memcpy(gravity, data + @PARAMS@ * sizeof *params, 3 * sizeof *gravity);
  memset(&first, 0xA5, sizeof first);
  memset(&second, 0x5A, sizeof second);
  status = READ(&@NAME@, params, gravity, &first);
  DEMAND(status == SMAP_OK || status == SMAP_CLAMPED || status == SMAP_TIPS ||
         status == SMAP_OFF_CHART || status == SMAP_INVALID);
  if (status == SMAP_OK || status == SMAP_CLAMPED) {
    DEMAND(SAFE(first));
  } else {
    DEMAND(UNSAFE(first));
  }
  /* asked twice */
  again = READ(&@NAME@, params, gravity, &second);
  DEMAND(again == status && memcmp(&first, &second, sizeof first) == 0);
  /* another length of gravity */
  for (i = 0; i < 3; i++) {
    can_double = can_double && CAN_DOUBLE(gravity[i]);
  }
  if (can_double) {
    for (i = 0; i < 3; i++) {
      gravity[i] = TWICE(gravity[i]);
    }
    again = READ(&@NAME@, params, gravity, &second);
    DEMAND(again == status && memcmp(&first, &second, sizeof first) == 0);
  }
  /* a parameter outside is its axis's end */
  for (i = 0; i < @PARAMS@; i++) {
    if (params[i] < LOWER(i)) {
      params[i] = LOWER(i);
      outside = 1;
    }
    if (params[i] > UPPER(i)) {
      params[i] = UPPER(i);
      outside = 1;
    }
  }
  if (outside && status != SMAP_INVALID) {
    DEMAND(status != SMAP_OK);
    again = READ(&@NAME@, params, gravity, &second);
    DEMAND(again == (status == SMAP_CLAMPED ? SMAP_OK : status));
    DEMAND(memcmp(&first, &second, sizeof first) == 0);
  }
  free(params);
  free(gravity);
  return 0;
}
