/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Proofs by trying everything.  The parts themselves are taken in, so their own functions are asked.
 * Prints one line for each proof: its name, how many were tried, and how often it failed. */
#include <math.h>
#include <stdio.h>

#include "of_three.c"

#ifndef STEP
#define STEP 1u /* a test that only looks for a fault tries fewer */
#endif

static void report(const char *name, uint64_t tried, uint64_t wrong)
{
  printf("%s %llu %llu\n", name, (unsigned long long)tried, (unsigned long long)wrong);
  fflush(stdout); /* a fault may end the program */
}

static inline float float_of(uint32_t bits)
{
  float x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* All bit patterns of a float: what the guards let pass, and what of a parameter and of a direction is
 * kept.  The map: one axis from -1 to 2 with a sensor tolerance of 0.01, a cone of 60 deg. */
static void try_guards(void)
{
  static const float limits[] = {1.0f, 1.7320508f};
  static uint8_t blob[64];
  const float axis[3] = {-1.0f, 2.0f, 0.01f};
  const smap_t map = {&smap_run, blob, sizeof blob};
  uint64_t wrong = 0, off_axis = 0, off_chart = 0, tried = 0;
  uint32_t block, i;
  blob[SMAP_AT_PARAMS] = blob[SMAP_AT_FACES] = 1;
  memcpy(blob + SMAP_AT_AXES, axis, sizeof axis);
  memcpy(blob + SMAP_AT_LIMIT, &limits[1], 4);
  for (block = 0; block < 65536; block += STEP) {
    for (i = 0; i < 65536; i++) {
      const uint32_t bits = block << 16 | i;
      const float x = float_of(bits);
      const unsigned finite_bits = (bits >> 23 & 255u) != 255u;
      float q[SMAP_MAX_PARAMS], d[3], gravity[3] = {0.0f, 0.0f, -1.0f};
      wrong += (unsigned)smap_is_finite(x) != finite_bits;
      wrong += (unsigned)smap_is_positive(x) != (unsigned)(finite_bits && x > 0.0f);
      wrong += (unsigned)smap_is_within(x, limits[0]) != (unsigned)(x >= -1.0f && x <= 1.0f);
      off_axis += (unsigned)(smap_range(&map, &x, q) == SMAP_OK && !(q[0] >= -1.0101f && q[0] <= 2.0101f));
      gravity[0] = x;
      off_chart += (unsigned)(smap_direction(&map, gravity, d) == SMAP_OK &&
                              !(d[0] >= -limits[1] && d[0] <= limits[1]));
    }
    tried += 65536;
  }
  report("guards", tried, wrong);
  report("range", tried, off_axis);
  report("direction", tried, off_chart);
}

/* Square roots: every denormal, and every mantissa under exponents even and odd, least and most.
 * The exponent enters only by its parity and by half of it, which is added at the end. */
static void try_root(void)
{
  static const uint32_t exponents[] = {0, 1, 2, 126, 127, 128, 253, 254};
  uint64_t wrong = 0, tried = 0;
  uint32_t e, mantissa;
  for (e = 0; e < sizeof exponents / sizeof *exponents; e++) {
    for (mantissa = 0; mantissa < 0x800000u; mantissa += STEP) {
      const uint32_t bits = exponents[e] << 23 | mantissa;
      float x, mine, true_root;
      memcpy(&x, &bits, sizeof x);
      /* what the annotation of the loop over denormals assumes */
      wrong += x > 0.0f && exponents[e] == 0 && mantissa == 0;
      mine = smap_root(x);
      true_root = sqrtf(x);
      wrong += memcmp(&mine, &true_root, sizeof mine) != 0;
      tried++;
    }
  }
  report("root", tried, wrong);
}

static unsigned wrong_whole(uint32_t x, uint32_t root)
{
  return (unsigned)(smap_whole_root(x) != root) |
         ((unsigned)(x >= 0x10000000u) & (unsigned)(smap_length_root(x) != root));
}

/* Whole square roots by division: at both ends of every root, and now and then between.  Of lengths from
 * 2^28 on as well. */
static void try_whole_root(void)
{
  const uint64_t most = (uint64_t)3 << 30; /* what the runtime asks for at most */
  uint64_t wrong = 0, tried = 0, x;
  uint32_t result;
  for (result = 0; (uint64_t)(result + 2) * result <= most; result += STEP) {
    const uint32_t low = result * result;
    wrong += wrong_whole(low, result) + wrong_whole(low + 2 * result, result);
    tried += 2;
  }
  for (x = 0; x <= most; x += 61 * STEP) {
    const uint64_t found = smap_whole_root((uint32_t)x);
    wrong += found * found > x || (found + 1) * (found + 1) <= x || wrong_whole((uint32_t)x, (uint32_t)found);
    tried++;
  }
  report("whole_root", tried, wrong);
}

/* Is a sine or cosine further off than the proofs of exports assume (proofs/prove/rounding.py)? */
static unsigned wrong_waves(float x, int near)
{
  float s, c;
  const double off = near ? SINE_NEAR : SINE;
  if (near) {
    smap_sine_cosine_near(x, &s, &c);
  } else {
    smap_sine_cosine(x, &s, &c);
  }
  return (unsigned)!(fabs((double)s - sin((double)x)) <= off && fabs((double)c - cos((double)x)) <= off);
}

/* Of both signs, from 2^-12 to a limit every float, below it some: there x x is 0 beside 1. */
static void try_waves(const char *name, float limit, int near)
{
  const uint32_t small = (127u - 12u) << 23, last = smap_bits(limit);
  uint64_t wrong = 0, tried = 0;
  uint32_t bits;
  for (bits = 0; bits <= last; bits += bits < small ? 4099u : STEP) {
    wrong += wrong_waves(float_of(bits), near) + wrong_waves(-float_of(bits), near);
    tried += 2;
  }
  report(name, tried, wrong);
}

/* Arcsines: the same up to 1, and beyond it what 1 gives. */
static void try_arcsine(void)
{
  const uint32_t small = (127u - 12u) << 23, last = smap_bits(1.001f);
  uint64_t wrong = 0, tried = 0;
  uint32_t bits;
  for (bits = 0; bits <= last; bits += bits < small ? 4099u : STEP) {
    const float x = float_of(bits);
    const double truth = asin(x < 1.0f ? (double)x : 1.0);
    wrong += (unsigned)!(fabs((double)smap_asin(x) - truth) <= ARCSINE);
    wrong += (unsigned)!(fabs((double)smap_asin(-x) + truth) <= ARCSINE);
    tried += 2;
  }
  report("arcsine", tried, wrong);
}

int main(void)
{
  try_guards();
  try_root();
  try_whole_root();
  try_waves("waves_near", NEAREST, 1);
  try_waves("waves", FURTHEST, 0);
  try_arcsine();
  return 0;
}
