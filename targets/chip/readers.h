/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* What the two files of the comparison share: peer.c has floats, peer_i.c none. */
#ifndef READERS_H
#define READERS_H

#include <stdint.h>

#define APART __attribute__((noinline))

typedef struct {
  float u, v;        /* on the chart, -LIMIT to LIMIT */
  float x, y;        /* the same in nodes */
  uint16_t place[2]; /* the same, 0 to 65534 */
} point_t;

/* Where results go: a conversion would cost more than a read on a core without floats. */
extern volatile int32_t answer_i;
extern int16_t gravity_q[3];

void ours_table_i(const point_t *p);
void ours_read_i(const point_t *p);

#endif
