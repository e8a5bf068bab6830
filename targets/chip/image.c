/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The program that runs on a target: asks the map what queries.bin holds, prints a hash of the
 * answers, and how long each of the counted calls took.  case.h is written by targets/image.py. */
#include "case.h"
#include "counter.h"

#if defined(__AVR__)
#define STORED const __flash
#else
#define STORED const
#endif

/* A query.  Both kinds of numbers where the map computes in floats and answers in integers. */
#define NUMBERS (PARAMS + 3)
typedef struct {
#if FLOATS
  float real[NUMBERS]; /* parameters, then gravity */
#endif
  int16_t whole[NUMBERS + (NUMBERS & 1)]; /* the same as whole numbers */
} query_t;

extern STORED uint8_t queries[(CHECKED + COUNTED) * sizeof(query_t)];

/* Where pointers need no alignment, at an odd address, which is as good as any there. */
static struct {
  char before;
  POSE pose;
} __attribute__((aligned(2))) memory;
#define kept memory.pose

static void fetch(uint32_t row, query_t *to)
{
  uint8_t i;
  for (i = 0; i < sizeof *to; i++) {
    ((uint8_t *)to)[i] = queries[row * sizeof *to + i];
  }
}

#if FLOATS
static uint32_t mix_reading(uint32_t hash, smap_status_t status, const smap_reading_t *reading)
{
  hash = mix(mix_status(hash, status), &reading->sdg, 4);
  hash = mix(mix(hash, &reading->tip_angle, 4), &reading->height, 4);
  return mix(mix(hash, &reading->over[0], 1), &reading->over[1], 1);
}
#endif

static uint32_t mix_whole(uint32_t hash, smap_status_t status, const smap_reading_i_t *reading)
{
  hash = mix(mix_status(hash, status), &reading->sdg, 2);
  hash = mix(mix(hash, &reading->tip, 2), &reading->height, 2);
  return mix(mix(hash, &reading->over[0], 1), &reading->over[1], 1);
}

/* All calls of the API under one query. */
static uint32_t checked(uint32_t hash, const query_t *query)
{
#if FLOATS
  const float *const down = query->real + PARAMS;
  float both[2][3];
  smap_reading_t reading, two[2];
  smap_status_t status;
  uint8_t i;
  status = smap_read(&MAP, query->real, down, &reading);
  hash = mix_reading(hash, status, &reading);
  hash = mix_status(hash, smap_pose(&MAP, query->real, &kept.pose, sizeof kept, FORMS));
  status = smap_at(&kept.pose, down, &reading);
  hash = mix_reading(hash, status, &reading);
  for (i = 0; i < 3; i++) {
    both[0][i] = down[i];
    both[1][i] = -down[i];
  }
  status = smap_at_n(&kept.pose, (const float(*)[3])both, 2, two);
  hash = mix_reading(hash, status, &two[1]);
#endif
#if INTEGERS
  {
    const int16_t *const down_i = query->whole + PARAMS;
    smap_reading_i_t reading_i;
    smap_status_t said;
#if FLOATS
    said = smap_at_i(&kept.pose, down_i, &reading_i);
    hash = mix_whole(hash, said, &reading_i);
    (void)smap_pose(&MAP, query->real, &kept.pose, sizeof kept, SMAP_INTEGER);
#else
    (void)smap_pose_q(&MAP, query->whole, &kept.pose, sizeof kept, SMAP_INTEGER);
#endif
    said = smap_at_i(&kept.pose, down_i, &reading_i);
    hash = mix_whole(hash, said, &reading_i);
    said = smap_read_i(&MAP, query->whole, down_i, &reading_i);
    hash = mix_whole(hash, said, &reading_i);
  }
#endif
  return hash;
}

#if COUNTS
/* Ticks from before a call to after it, less those of reading the counter.  What a reading needs is
 * made beforehand; the call itself is as a program has it. */
#define TIMED(prepare, call)                        \
  {                                                 \
    uint32_t start, stop, none;                     \
    prepare;                                        \
    restart();                                      \
    start = now();                                  \
    stop = now();                                   \
    none = stop - start;                            \
    __asm__ volatile("" : : "r"(query) : "memory"); \
    start = now();                                  \
    (void)(call);                                   \
    stop = now();                                   \
    __asm__ volatile("" : : "r"(out) : "memory");   \
    return stop - start - none;                     \
  }

#if FLOATS
static uint32_t timed_pose(const query_t *query, void *out)
TIMED((void)0, smap_pose(&MAP, query->real, &kept.pose, sizeof kept, SMAP_FLOAT))
static uint32_t timed_at(const query_t *query, smap_reading_t *out)
TIMED((void)smap_pose(&MAP, query->real, &kept.pose, sizeof kept, SMAP_FLOAT),
      smap_at(&kept.pose, query->real + PARAMS, out))
static uint32_t timed_read(const query_t *query, smap_reading_t *out)
TIMED((void)0, smap_read(&MAP, query->real, query->real + PARAMS, out))
#if INTEGERS
static uint32_t timed_both(const query_t *query, void *out)
TIMED((void)0, smap_pose(&MAP, query->real, &kept.pose, sizeof kept, FORMS))
static uint32_t timed_at_i(const query_t *query, smap_reading_i_t *out)
TIMED((void)smap_pose(&MAP, query->real, &kept.pose, sizeof kept, FORMS),
      smap_at_i(&kept.pose, query->whole + PARAMS, out))
#endif
#else
static uint32_t timed_pose(const query_t *query, void *out)
TIMED((void)0, smap_pose_q(&MAP, query->whole, &kept.pose, sizeof kept, SMAP_INTEGER))
static uint32_t timed_at_i(const query_t *query, smap_reading_i_t *out)
TIMED((void)smap_pose_q(&MAP, query->whole, &kept.pose, sizeof kept, SMAP_INTEGER),
      smap_at_i(&kept.pose, query->whole + PARAMS, out))
static uint32_t timed_read(const query_t *query, smap_reading_i_t *out)
TIMED((void)0, smap_read_i(&MAP, query->whole, query->whole + PARAMS, out))
#endif

/* Ticks of a call under one query; `kind` as targets/image.py has it. */
static uint32_t timed(char kind, uint32_t row)
{
  query_t query;
#if FLOATS
  smap_reading_t reading;
#endif
#if INTEGERS
  smap_reading_i_t reading_i;
#endif
  fetch(row, &query);
  switch (kind) {
#if FLOATS
  case 'a':
    return timed_at(&query, &reading);
  case 'r':
    return timed_read(&query, &reading);
#if INTEGERS
  case 'b':
    return timed_both(&query, &kept);
#endif
#else
  case 'r':
    return timed_read(&query, &reading_i);
#endif
#if INTEGERS
  case 'i':
    return timed_at_i(&query, &reading_i);
#endif
  default:
    return timed_pose(&query, &kept);
  }
}
#endif

int main(void)
{
  uint32_t hash = 2166136261u, row;
  begin();
  for (row = 0; row < CHECKED; row++) {
    query_t query;
    fetch(row, &query);
    hash = checked(hash, &query);
  }
  put_hex('h', hash);
  put_known();
#if COUNTS
  {
    static const char kinds[] = KINDS;
    uint8_t k;
    for (k = 0; kinds[k] != 0; k++) {
      uint32_t most = 0;
      for (row = CHECKED; row < CHECKED + COUNTED; row++) {
        const uint32_t ticks = timed(kinds[k], row);
        if (!LARGEST_ONLY) {
          put_hex(kinds[k], ticks);
        }
        most = ticks > most ? ticks : most;
      }
      if (LARGEST_ONLY) {
        put_hex(kinds[k], most);
      }
    }
  }
#endif
  put_hex('s', sizeof(POSE));
  put_hex('t', sizeof(POSE_I));
  put_hex('e', CHECKED + COUNTED);
  finish();
  return 0;
}
