/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* libFuzzer asks one export; what must hold of every answer is checked here, what must hold of every
 * access by the sanitizers. */
#include "@NAME@.c"

#include <stdio.h>
#include <stdlib.h>

#define DEMAND(claim)                                   \
  do {                                                  \
    if (!(claim)) {                                     \
      fprintf(stderr, "broken claim: %s\n", #claim);    \
      abort();                                          \
    }                                                   \
  } while (0)

#define PARAMS (@PARAMS@ > 0 ? @PARAMS@ : 1) /* an array has at least one */
#define QUERY (@PARAMS@ * 4 + 12)

static int is_status(smap_status_t status)
{
  return status <= SMAP_INVALID && status != SMAP_CORRUPT;
}

/* A status and its reading belong together. */
static void judge(smap_status_t status, const smap_reading_t *reading)
{
  DEMAND(is_status(status));
  if (smap_is_safe(status)) {
    DEMAND(reading->tip_angle >= 0.0f && reading->tip_angle < 3.1416f);
    DEMAND(!(reading->sdg < 0.0f) && !(reading->height < 0.0f));
  } else {
    DEMAND(reading->tip_angle < 0.0f);
    DEMAND(reading->sdg != reading->sdg && reading->height != reading->height);
  }
}

static void judge_i(smap_status_t status, const smap_reading_i_t *reading)
{
  DEMAND(is_status(status));
  if (smap_is_safe(status)) {
    DEMAND(reading->tip >= 0);
  } else {
    DEMAND(reading->tip < 0 && reading->sdg == 65535 && reading->height == 65535);
  }
}

static int is_same(const smap_reading_t *a, const smap_reading_t *b)
{
  return memcmp(&a->sdg, &b->sdg, 4) == 0 && memcmp(&a->tip_angle, &b->tip_angle, 4) == 0 &&
         memcmp(&a->height, &b->height, 4) == 0 && memcmp(a->over, b->over, 2) == 0;
}

static int is_same_i(const smap_reading_i_t *a, const smap_reading_i_t *b)
{
  return a->sdg == b->sdg && a->tip == b->tip && a->height == b->height &&
         memcmp(a->over, b->over, 2) == 0;
}

/* Ask in floats: both phases at once, a pose of each form, twice, many at a time, another length. */
static void ask(const float *params, const float *gravity)
{
  smap_reading_t first, second, both[2];
  smap_reading_i_t refused;
  float pair[2][3], other[3];
  @NAME@_pose_t *const pose = malloc(sizeof *pose);
  smap_status_t status, made;
  int i, can_double = 1;
  DEMAND(pose);
  memset(pose, 0, sizeof *pose);
  judge(smap_at(&pose->pose, gravity, &first), &first); /* a pose that was never made */
  memset(pose, 0xA5, sizeof *pose);
  status = smap_read(&@NAME@, params, gravity, &first);
  judge(status, &first);
  made = smap_pose(&@NAME@, params, &pose->pose, sizeof *pose, @FORMS@);
  DEMAND(@INTEGER@ ? made == SMAP_INVALID : is_status(made));
  DEMAND(smap_at(&pose->pose, gravity, &second) == status && is_same(&first, &second));
  /* A smaller memory than the header asks for. */
  DEMAND(smap_pose(&@NAME@, params, &pose->pose, sizeof(void *), @FORMS@) == SMAP_INVALID);
  judge(smap_at(&pose->pose, gravity, &second), &second);
  DEMAND(smap_at_i(&pose->pose, (const int16_t[3]){0, 0, -16384}, &refused) == SMAP_INVALID);
  (void)smap_pose(&@NAME@, params, &pose->pose, sizeof *pose, @FORMS@);
  for (i = 0; i < 3; i++) {
    const float x = gravity[i];
    pair[0][i] = pair[1][i] = x;
    other[i] = x * 2.0f;
    /* normal numbers before and after, or 0 */
    can_double = can_double && (x == 0.0f || (x > 1e-15f && x < 1e15f) || (x < -1e-15f && x > -1e15f));
  }
  DEMAND(smap_at_n(&pose->pose, (const float(*)[3])pair, 2, both) == status);
  DEMAND(is_same(&both[0], &first) && is_same(&both[1], &first));
  if (can_double) {
    DEMAND(smap_at(&pose->pose, other, &second) == status && is_same(&first, &second));
  }
  free(pose);
}

/* The same in whole numbers. */
static void ask_i(const int16_t *params, const int16_t *gravity)
{
  smap_reading_i_t first, second;
  @NAME@_pose_i_t *const pose = malloc(sizeof *pose);
  smap_status_t status;
  int16_t other[3];
  int i, can_double = 1;
  DEMAND(pose);
  memset(pose, 0, sizeof *pose);
  judge_i(smap_at_i(&pose->pose, gravity, &first), &first);
  memset(pose, 0xA5, sizeof *pose);
  status = smap_read_i(&@NAME@, params, gravity, &first);
  judge_i(status, &first);
  (void)smap_pose_q(&@NAME@, params, &pose->pose, sizeof *pose, SMAP_INTEGER);
  DEMAND(smap_at_i(&pose->pose, gravity, &second) == status && is_same_i(&first, &second));
  for (i = 0; i < 3; i++) {
    other[i] = (int16_t)(gravity[i] * 2);
    can_double = can_double && gravity[i] > -8192 && gravity[i] < 8192;
  }
  if (can_double) {
    DEMAND(smap_at_i(&pose->pose, other, &second) == status && is_same_i(&first, &second));
  }
  free(pose);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  float *params, *gravity;
  int16_t *params_q, *gravity_q;
  if (size < QUERY) {
    return 0;
  }
  /* On the heap and of just that size, so that a read beyond an end is seen. */
  params = malloc(@PARAMS@ * sizeof *params);
  gravity = malloc(3 * sizeof *gravity);
  params_q = malloc(@PARAMS@ * sizeof *params_q);
  gravity_q = malloc(3 * sizeof *gravity_q);
  DEMAND((params || @PARAMS@ == 0) && gravity && (params_q || @PARAMS@ == 0) && gravity_q);
  if (@PARAMS@ > 0) {
    memcpy(params, data, @PARAMS@ * sizeof *params);
    memcpy(params_q, data, @PARAMS@ * sizeof *params_q);
  }
  memcpy(gravity, data + @PARAMS@ * sizeof *params, 3 * sizeof *gravity);
  memcpy(gravity_q, data + size - 3 * sizeof *gravity_q, 3 * sizeof *gravity_q);
  ask(params, gravity);
  ask_i(params_q, gravity_q);
  free(params);
  free(gravity);
  free(params_q);
  free(gravity_q);
  return 0;
}
