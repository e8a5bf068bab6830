/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* What Frama-C Eva knows nothing of: any bits, and a float of any bits. */
static volatile uint32_t any_bits;

static float any_number(void)
{
  union {
    uint32_t bits;
    float value;
  } number;
  number.bits = any_bits;
  return number.value;
}
