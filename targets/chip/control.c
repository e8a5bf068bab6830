/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The program that runs on a target: cycles of on-board control over a slope that wanders, each from the
 * posture that the last one commanded; prints a hash of all commands and what is said beside them, and
 * how long each cycle took.  case.h is written by targets/control.py, which drives the host alike. */
#include "case.h"
#include "counter.h"
#include <string.h>

static STATE state;
static uint32_t seed = 1;

/* From -1 to below 1: whole numbers make it, so that it is the same anywhere. */
static float noise(void)
{
  seed = seed * 1664525u + 1013904223u;
  return (float)(int16_t)(uint16_t)(seed >> 16) * (1.0f / 32768.0f);
}

static uint32_t mix_floats(uint32_t hash, const float *number, uint8_t count)
{
  while (count--) {
    hash = mix(hash, number++, 4);
  }
  return hash;
}

static float kept(float x, float low, float high)
{
  return x < low ? low : x > high ? high : x;
}

int main(void)
{
  static const float low[PARAMS] = LOW, high[PARAMS] = HIGH;
  float posture[PARAMS], command[PARAMS], tilt[2] = {0.0f, 0.0f};
  uint32_t hash = 2166136261u, row;
  uint8_t i;
  begin();
  put_known();
  hash = mix_status(hash, smap_start(&CONTROL, &state, sizeof state));
  for (i = 0; i < PARAMS; i++) {
    posture[i] = 0.5f * (low[i] + high[i]);
  }
  for (row = 0; row < CYCLES; row++) {
    smap_sample_t sample;
    smap_cycle_t cycle;
    smap_status_t status;
    uint32_t start = 0, stop = 0, none = 0;
    memset(&sample, 0, sizeof sample);
    for (i = 0; i < 2; i++) {
      tilt[i] = kept(tilt[i] + 0.0625f * noise(), -0.75f, 0.75f);
      sample.up[i] = tilt[i] * 8.0f;
      sample.rate[i] = 0.25f * noise();
    }
    sample.up[2] = 8.0f;
    if (row % 32u == 31u) { /* elsewhere at once, as after a push */
      for (i = 0; i < PARAMS; i++) {
        posture[i] = kept(posture[i] + 0.25f * noise() * (high[i] - low[i]), low[i], high[i]);
      }
    }
    if (row % 50u == 49u) { /* a sensor that reads nothing */
      sample.up[2] = 0.0f;
    }
    sample.posture = posture;
    restart();
    start = now();
    stop = now();
    none = stop - start;
    __asm__ volatile("" : : "r"(&sample) : "memory");
    start = now();
    status = smap_step(&CONTROL, &state, &sample, command, &cycle);
    stop = now();
    __asm__ volatile("" : : "r"(command) : "memory");
    hash = mix_floats(mix_status(hash, status), command, PARAMS);
    hash = mix_floats(hash, (const float *)&cycle, 6);
    hash = mix(mix(hash, &cycle.alarm, 1), &cycle.move, 1);
    hash = mix(mix(hash, &cycle.poses, 1), &cycle.spare, 1);
    memcpy(posture, command, sizeof posture);
    if (stop - start > none) {
      put_hex('c', stop - start - none);
    }
  }
  put_hex('h', hash);
  put_hex('s', sizeof state);
  put_hex('e', CYCLES);
  finish();
  return 0;
}
