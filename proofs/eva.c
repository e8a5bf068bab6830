/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Frama-C Eva starts at `prove`: every bit pattern as a query, once through the table. */
#include "@NAME@.h"

static volatile uint32_t any_bits;
static volatile int16_t any_count;

#if @INTEGER@
typedef int16_t number_t;
typedef smap_reading_i_t answer_t;
#define READ smap_read_i
static number_t any_number(void) { return any_count; }
#else
typedef float number_t;
typedef smap_reading_t answer_t;
#define READ smap_read
static number_t any_number(void)
{
  union {
    uint32_t bits;
    float value;
  } number;
  number.bits = any_bits;
  return number.value;
}
#endif

void prove(void)
{
  number_t params[@PARAMS@], gravity[3];
  answer_t answer;
  int i;
  /*@ loop unroll 16; */
  for (i = 0; i < @PARAMS@; i++) {
    params[i] = any_number();
  }
  /*@ loop unroll 3; */
  for (i = 0; i < 3; i++) {
    gravity[i] = any_number();
  }
  (void)READ(&@NAME@, params, gravity, &answer);
}
