/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Every single bit flipped in the blob of an export, and pairs of bits: smap_check must tell.  Prints how
 * many were tried of each, and after how many it passed. */
#include "@NAME@.c"

#include <stdio.h>

#define BITS (8u * (uint32_t)sizeof smap_blob)

int main(void)
{
  static uint8_t blob[sizeof smap_blob];
  const smap_t map = {&smap_run, blob, sizeof blob};
  unsigned long single = 0, pairs = 0, passed = 0, work = 0;
  uint32_t a, b, step;
  memcpy(blob, smap_blob, sizeof blob);
  if (smap_check(&map) != SMAP_OK) {
    printf("whole 0 1\n");
    return 1;
  }
  for (a = 0; a < BITS; a++) {
    blob[a / 8] ^= (uint8_t)(1u << a % 8);
    passed += smap_check(&map) == SMAP_OK;
    blob[a / 8] ^= (uint8_t)(1u << a % 8);
    single++;
    work += sizeof blob;
    if (work > 100000000u) { /* a large map: its first bits */
      break;
    }
  }
  printf("single %lu %lu\n", single, passed);
  passed = 0;
  /* All pairs of a small map, of a large one so many that it takes a second. */
  step = 1;
  while ((double)BITS * BITS / step * (double)sizeof blob > 5e8) {
    step += 2;
  }
  for (a = 0, b = 0; a < BITS; a++) {
    for (b = a + 1 + a % step; b < BITS; b += step) {
      blob[a / 8] ^= (uint8_t)(1u << a % 8);
      blob[b / 8] ^= (uint8_t)(1u << b % 8);
      passed += smap_check(&map) == SMAP_OK;
      blob[a / 8] ^= (uint8_t)(1u << a % 8);
      blob[b / 8] ^= (uint8_t)(1u << b % 8);
      pairs++;
    }
  }
  printf("pairs %lu %lu\n", pairs, passed);
  return 0;
}
