/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* What is proved by trying everything.  smap.c itself is included, so it is its own functions,
 * compiled with all codecs, that are asked.  Prints one line for each proof: its name, what was
 * tried, and how often it failed. */
#include <math.h>
#include <stdio.h>

#include "smap.c"

#ifndef STEP
#define STEP 1u /* a test that only looks for a fault tries fewer */
#endif

static void report(const char *name, uint64_t tried, uint64_t wrong)
{
  printf("%s %llu %llu\n", name, (unsigned long long)tried, (unsigned long long)wrong);
  fflush(stdout); /* a fault may end the program */
}

/* Is one value between its neighbours, the node where the weight is 0 or all of it, and no less
 * than the bound that rounding down leaves? */
static unsigned wrong_between(uint32_t low, uint32_t high, uint32_t frac)
{
  const uint32_t value = between(low, high, frac);
  const uint32_t least = low < high ? low : high, most = low < high ? high : low;
  return (unsigned)(value < least) | (unsigned)(value > most) |
         ((unsigned)(frac == 0) & (unsigned)(value != low)) |
         ((unsigned)(frac == 16384) & (unsigned)(value != high));
}

/* All differences and all weights, with the lower of the two values at either end of its range. */
static void try_between(void)
{
  uint64_t wrong = 0, tried = 0;
  uint32_t size, frac;
  for (size = 0; size <= 65535; size += STEP) {
    const uint32_t base = 65535 - size;
    uint32_t here = 0;
    for (frac = 0; frac <= 16384; frac++) {
      here += wrong_between(0, size, frac) + wrong_between(size, 0, frac);
      here += wrong_between(base, 65535, frac) + wrong_between(65535, base, frac);
    }
    wrong += here;
    tried += 4 * 16385;
  }
  report("between", tried, wrong);
}

static float float_of(uint32_t bits)
{
  float x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* All bit patterns of a float: what the guards of smap_read and locate let pass. */
static void try_guards(void)
{
  static const float limits[] = {1.0f, 1.7320508f};
  struct smap cone;
  uint64_t wrong = 0, off_face = 0, tried = 0;
  uint32_t block, i, k;
  memset(&cone, 0, sizeof cone);
  cone.faces = 1;
  for (block = 0; block < 65536; block += STEP) {
    uint32_t here = 0, off = 0;
    for (i = 0; i < 65536; i++) {
      const uint32_t bits = block << 16 | i;
      const float x = float_of(bits);
      const unsigned finite_bits = (bits >> 23 & 255u) != 255u, is_number = x == x;
      here += (unsigned)is_finite(x) != finite_bits;
      here += (unsigned)is_positive(x) != (unsigned)(finite_bits && x > 0.0f);
      here += (unsigned)(up_to_one(x) && !(x >= 0.0f && x <= 1.0f));
      /* what is not let through at once, nor clamped, is -0 */
      here += is_number && !up_to_one(x) && !(x < 0.0f || x > 1.0f) && bits != 0x80000000u;
      for (k = 0; k < 2; k++) {
        const float gravity[3] = {x, 0.0f, -1.0f};
        query_t query;
        cone.chart_limit = limits[k];
        off += (uint32_t)(locate(&cone, gravity, &query) &&
                          !(query.place[0] >= -limits[k] && query.place[0] <= limits[k]));
      }
    }
    wrong += here;
    off_face += off;
    tried += 65536;
  }
  report("guards", tried, wrong);
  report("face", 2 * tried, off_face);
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
      mine = root(x);
      true_root = sqrtf(x);
      wrong += memcmp(&mine, &true_root, sizeof mine) != 0;
      tried++;
    }
  }
  report("root", tried, wrong);
}

/* Whole square roots by division: at both ends of every root, and now and then between. */
static void try_whole_root(void)
{
  const uint64_t most = (uint64_t)3 << 30; /* what the runtime asks for at most */
  uint64_t wrong = 0, tried = 0, x;
  uint32_t result;
  for (result = 0; (uint64_t)(result + 2) * result <= most; result += STEP) {
    const uint32_t low = result * result;
    wrong += (whole_root(low) != result) + (whole_root(low + 2 * result) != result);
    tried += 2;
  }
  for (x = 0; x <= most; x += 61 * STEP) {
    const uint64_t found = whole_root((uint32_t)x);
    wrong += found * found > x || (found + 1) * (found + 1) <= x;
    tried++;
  }
  report("whole_root", tried, wrong);
}

/* The search for a cell, on axes of 2 to 300 nodes, at every place: the cell that comes out has the
 * next node as its upper end, since the weight is that of the two. */
static void try_cell(void)
{
  static uint16_t knots[300];
  static const uint8_t codes[1] = {0};
  uint64_t wrong = 0, tried = 0;
  uint16_t nodes;
  for (nodes = 2; nodes <= 300; nodes = (uint16_t)(nodes + STEP)) {
    const uint16_t axes[3] = {0, nodes, 0};
    smap_grid_part_t part;
    smap_grid_t grid;
    uint32_t x, expected = 0, i;
    memset(&part, 0, sizeof part);
    memset(&grid, 0, sizeof grid);
    part.axes = axes;
    part.codes8 = codes;
    part.dims = part.width = 1;
    grid.knots = knots;
    for (i = 0; i < nodes; i++) {
      knots[i] = (uint16_t)(65534u * i / (nodes - 1u));
    }
    for (x = 0; x <= 65534; x++) {
      const uint16_t place = (uint16_t)x;
      uint32_t jump[GRID_AXES], width;
      float frac[GRID_AXES];
      query_t query;
      cell_t cell;
      memset(&query, 0, sizeof query);
      query.t[0] = (float)x / 65534.0f;
      while (expected + 2 < nodes && knots[expected + 1] <= x) {
        expected++;
      }
      width = (uint32_t)(knots[expected + 1] - knots[expected]);
      grid_cell_i(&grid, &part, &place, 1, 0, &cell);
      wrong += cell.at != expected || cell.jump[0] != 1 ||
               cell.frac[0] != ((x - knots[expected]) << 14) / width || cell.frac[0] > 16384;
      i = grid_cell(&grid, &part, &query, jump, frac);
      /* The float place may be one rounding beside a node. */
      wrong += i + 1 < expected || i > expected + 1 || !(frac[0] >= 0.0f && frac[0] <= 1.0f) ||
               fabsf((float)knots[i] + frac[0] * (float)(knots[i + 1] - knots[i]) - (float)x) > 0.1f;
      tried++;
    }
  }
  report("cell", tried, wrong);
}

int main(void)
{
  try_between();
  try_guards();
  try_root();
  try_cell();
  try_whole_root();
  return 0;
}
