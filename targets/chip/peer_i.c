/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Our reads of the table without floats: the map of integers, taken in as its own file takes it. */
#include "whole.c"

#include "readers.h"

/* The table alone. */
APART void ours_table_i(const point_t *p)
{
  const smap_bytes_t body = smap_body(&whole), part = smap_part(&whole, 0);
  smap_grid_cell_i_t cell;
  smap_grid_cell_i(body, part, p->place, 0, 0, &cell);
  answer_i = (int32_t)smap_grid_value_i(body, part, &cell, 0);
}

/* All of smap_read_i. */
APART void ours_read_i(const point_t *p)
{
  static const int16_t none[1];
  smap_reading_i_t reading;
  (void)p;
  answer_i = (int32_t)smap_read_i(&whole, none, gravity_q, &reading);
}
