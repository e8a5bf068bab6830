/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Frama-C Eva starts at `prove`: every bit pattern as a query, through every entry. */
#include "@NAME@.c"
#include "eva_any.h"

static volatile int16_t any_count;
static @NAME@_pose_t pose; /* all zero: what was never made is read, too */

void prove(void)
{
  float params[@PARAMS@ + 1], gravity[3];
  int16_t params_q[@PARAMS@ + 1], gravity_q[3];
  smap_reading_t reading;
  smap_reading_i_t reading_i;
  int i;
  /*@ loop unroll 16; */
  for (i = 0; i < @PARAMS@; i++) {
    params[i] = any_number();
    params_q[i] = any_count;
  }
  /*@ loop unroll 3; */
  for (i = 0; i < 3; i++) {
    gravity[i] = any_number();
    gravity_q[i] = any_count;
  }
  if (any_count) {
    (void)smap_pose(&@NAME@, params, &pose.pose, sizeof pose, @FORMS@);
  } else {
    (void)smap_pose_q(&@NAME@, params_q, &pose.pose, sizeof pose, @FORMS@);
  }
  (void)smap_at(&pose.pose, gravity, &reading);
  (void)smap_at_i(&pose.pose, gravity_q, &reading_i);
#if !@MANY@ /* these make a pose in memory of their own: Eva does not see that all that is read of it was written */
  (void)smap_read(&@NAME@, params, gravity, &reading);
  (void)smap_read_i(&@NAME@, params_q, gravity_q, &reading_i);
#endif
}
