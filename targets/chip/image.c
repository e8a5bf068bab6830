/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The program that runs on a target: asks the map what queries.bin holds, prints a hash of the
 * answers and how long each of the counted ones took.  case.h is written by targets/image.py. */
#include "case.h"
#include "counter.h"

#if INTEGER
typedef int16_t number_t;
typedef smap_reading_i_t answer_t;
#define READ smap_read_i
#else
typedef float number_t;
typedef smap_reading_t answer_t;
#define READ smap_read
#endif

#if defined(__AVR__)
#define STORED const __flash
#else
#define STORED const
#endif
#define ROW (PARAMS + 3)
#ifdef __wasm__
number_t queries[(CHECKED + COUNTED) * ROW]; /* the runner writes them */
#else
extern STORED number_t queries[(CHECKED + COUNTED) * ROW];
#endif

/* FNV-1a, 32 bits. */
static uint32_t mix(uint32_t hash, const void *data, uint8_t size)
{
  const uint8_t *byte = (const uint8_t *)data;
  while (size--) {
    hash = (hash ^ *byte++) * 16777619u;
  }
  return hash;
}

static void fetch(uint32_t row, number_t *to)
{
  uint8_t i;
  for (i = 0; i < ROW; i++) {
    to[i] = queries[row * ROW + i];
  }
}

/* Ticks from before the call to after it, less those of reading the counter. */
static uint32_t timed(uint32_t row)
{
  number_t query[ROW];
  answer_t answer;
  uint32_t start, stop, empty;
  fetch(row, query);
  restart();
  start = now();
  stop = now();
  empty = stop - start;
  __asm__ volatile("" : : "r"(query) : "memory");
  start = now();
  (void)READ(&MAP, query, query + PARAMS, &answer);
  stop = now();
  __asm__ volatile("" : : "r"(&answer) : "memory");
  return stop - start - empty;
}

int main(void)
{
  uint32_t hash = HASH_START, row;
  begin();
  for (row = 0; row < CHECKED; row++) {
    number_t query[ROW];
    answer_t answer;
    int8_t status;
    fetch(row, query);
    status = (int8_t)READ(&MAP, query, query + PARAMS, &answer);
    hash = mix(hash, &status, 1);
    hash = mix(hash, &answer, sizeof answer);
  }
  put_hex('h', hash);
#ifdef __AVR__
  { /* what the overflow's interrupt costs: a delay of known cycles, three overflows long */
    uint32_t start, empty;
    restart();
    start = now();
    empty = now() - start;
    start = now();
    __builtin_avr_delay_cycles(3ul << 16);
    put_hex('o', now() - start - empty - (3ul << 16));
  }
#elif !defined(__wasm__)
  { /* whether the counter counts instructions: a thousand of them */
    uint32_t start, empty;
    restart();
    start = now();
    empty = now() - start;
    start = now();
    thousand();
    put_hex('o', now() - start - empty);
  }
#endif
#if LARGEST_ONLY
  {
    uint32_t most = 0;
    for (row = CHECKED; row < CHECKED + COUNTED; row++) {
      const uint32_t ticks = timed(row);
      most = ticks > most ? ticks : most;
    }
    put_hex('c', most);
  }
#else
  for (row = CHECKED; row < CHECKED + COUNTED; row++) {
    put_hex('c', timed(row));
  }
#endif
  put_hex('e', CHECKED + COUNTED);
  finish();
  return 0;
}
