/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Answers of an export for tools/golden.py: MAP, COUNT and STEPS are given by the command line.
 * Reads parameters and gravity as floats, writes answers in floats to stdout, in integers to stderr. */
#include <stdio.h>

#define SAID(s) ((s) == SMAP_OK ? 0 : (s) == SMAP_ROCKS ? 1 : (s) == SMAP_TIPS ? 2 : 3)

int main(void)
{
  float x[COUNT + 3], *g = x + COUNT;
  while (fread(x, sizeof x, 1, stdin) == 1) {
    int16_t q[] = {STEPS 0};
    int16_t down[] = {(int16_t)(16e3f * g[0]), (int16_t)(16e3f * g[1]), (int16_t)(16e3f * g[2])};
    smap_reading_t f = {0};
    smap_reading_i_t i = {0};
    int said = SAID(smap_read(&MAP, x, g, &f));
    printf("%d %a %a %a\n", said, f.sdg, f.tip_angle, f.height);
    said = SAID(smap_read_i(&MAP, q, down, &i));
    fprintf(stderr, "%d %u %d %u\n", said, i.sdg, i.tip, i.height);
  }
  return 0;
}
