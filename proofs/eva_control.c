/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Frama-C Eva starts at `prove`: cycles of on-board control, every bit pattern as a sample. */
#include "@NAME@.c"
#include "eva_any.h"

static @NAME@_state_t state;

void prove(void)
{
  float posture[@PARAMS@], desired[@PARAMS@], command[@PARAMS@], least, slope[3], up[3];
  smap_sample_t sample;
  smap_cycle_t cycle;
  int i, n;
  (void)smap_start(&@NAME@_control, &state, sizeof state);
  /*@ loop unroll 3; */
  for (n = 0; n < 3; n++) {
    /*@ loop unroll 16; */
    for (i = 0; i < @PARAMS@; i++) {
      posture[i] = any_number();
      desired[i] = any_number();
    }
    /*@ loop unroll 4; */
    for (i = 0; i < 3; i++) {
      sample.up[i] = any_number();
      sample.rate[i] = any_number();
      sample.own[i] = any_number();
      up[i] = any_number();
    }
    sample.posture = posture;
    sample.desired = any_bits ? desired : 0;
    (void)smap_step(&@NAME@_control, &state, &sample, command, &cycle);
  }
  (void)smap_transit(&@NAME@_control, &state, posture, desired, up, &least);
  (void)smap_ground(&@NAME@_control, &state, posture, up, slope);
}
