/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* Bilinear reads side by side: CMSIS-DSP's and ours, over one table.  peer.h is written by
 * targets/cmsis.py: the map, its table three times, and the queries. */
#include "noise.c"

#include "dsp/interpolation_functions.h"

#include "readers.h"

#include "counter.h"
#include "peer.h"

#define LAST ((float)(NODES - 1))
#define ONE_STEP ((NODES - 1) << 4) /* of a place, 0 to 65534, in 1/2^20 of a node */

static const arm_bilinear_interp_instance_f32 peer_f32 = {NODES, NODES, table_f32};
static arm_bilinear_interp_instance_q31 peer_q31 = {NODES, NODES, (q31_t *)(uintptr_t)table_q31};
static arm_bilinear_interp_instance_q15 peer_q15 = {NODES, NODES, (q15_t *)(uintptr_t)table_q15};

/* Where results go: a conversion would cost more than a read on a core without floats. */
static volatile float answer;
volatile int32_t answer_i;

/* ---- CMSIS: as it is, and with what a caller adds so that it takes what ours takes ------------ */
APART static void f32_bare(const point_t *p)
{
  answer = arm_bilinear_interp_f32(&peer_f32, p->x, p->y);
}

/* Its reads end before the last node, so the largest index is just below. */
static float kept(float x)
{
  x = (x + LIMIT) * (LAST / (2.0f * LIMIT));
  return !(x > 0.0f) ? 0.0f : x > LAST * 0.9999999f ? LAST * 0.9999999f : x;
}

APART static void f32_kept(const point_t *p)
{
  answer = arm_bilinear_interp_f32(&peer_f32, kept(p->u), kept(p->v));
}

APART static void q31_kept(const point_t *p)
{
  answer_i = arm_bilinear_interp_q31(&peer_q31, p->place[0] * ONE_STEP, p->place[1] * ONE_STEP);
}

APART static void q15_kept(const point_t *p)
{
  answer_i = arm_bilinear_interp_q15(&peer_q15, p->place[0] * ONE_STEP, p->place[1] * ONE_STEP);
}

/* ---- ours: the table alone, and all of smap_read ---------------------------------------------- */
/* What smap_read has seen to before it asks a table. */
static float held(float u)
{
  return !(u > -LIMIT) ? -LIMIT : u > LIMIT ? LIMIT : u;
}

APART static void ours_table(const point_t *p)
{
  const smap_bytes_t body = smap_body(&noise), part = smap_part(&noise, 0);
  const float half = smap_f32(body);
  float place[2];
  smap_grid_cell_t cell;
  place[0] = held(p->u) * half;
  place[1] = held(p->v) * half;
  smap_grid_cell(body, part, place, 0, 0, &cell);
  answer = smap_grid_value(body, part, &cell, 0);
}

static float gravity[3];
int16_t gravity_q[3];

APART static void ours_read(const point_t *p)
{
  static const float none[1];
  smap_reading_t reading;
  (void)p;
  answer_i = (int32_t)smap_read(&noise, none, gravity, &reading);
}

/* What every reader has in common with the others of its kind. */
APART static void empty(const point_t *p)
{
  answer = p->u;
}

APART static void empty_i(const point_t *p)
{
  answer_i = p->place[0];
}

typedef void (*reader_t)(const point_t *);
static reader_t const readers[] = {
    f32_bare, f32_kept, q31_kept, q15_kept, ours_read, ours_read_i, empty, empty_i,
    ours_table, ours_table_i,
};

static uint32_t bits(float value)
{
  uint32_t result;
  memcpy(&result, &value, sizeof result);
  return result;
}

static point_t point(float u, float v)
{
  point_t p;
  p.u = u;
  p.v = v;
  p.x = (u + LIMIT) * (LAST / (2.0f * LIMIT));
  p.y = (v + LIMIT) * (LAST / (2.0f * LIMIT));
  p.place[0] = p.place[1] = 0;
  return p;
}

int main(void)
{
  uint32_t i, k;
  begin();
  for (k = 0; k < sizeof readers / sizeof *readers; k++) {
    for (i = 0; i < POINTS; i++) {
      point_t p = point(points[i][0], points[i][1]);
      uint32_t start, none;
      p.place[0] = (uint16_t)(p.x * (65534.0f / LAST));
      p.place[1] = (uint16_t)(p.y * (65534.0f / LAST));
      gravity[0] = p.u;
      gravity[1] = p.v;
      gravity[2] = -1.0f;
      gravity_q[0] = (int16_t)(p.u * 8192.0f);
      gravity_q[1] = (int16_t)(p.v * 8192.0f);
      gravity_q[2] = -8192;
      restart();
      start = now();
      none = now() - start;
      start = now();
      readers[k](&p);
      put_hex('c', now() - start - none);
      put_hex('v', bits(answer));
    }
  }
  for (i = 0; i < PROBES; i++) {
    point_t p = point(probes[i] * LIMIT, 0.0f);
    p.x = (1.0f + probes[i]) * (0.5f * LAST); /* exact at the ends */
    f32_bare(&p);
    put_hex('p', bits(answer));
    f32_kept(&p);
    put_hex('p', bits(answer));
    answer = 0.0f;
    ours_table(&p);
    put_hex('p', bits(answer));
  }
  put_hex('e', POINTS);
  return 0;
}
