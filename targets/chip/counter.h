/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* How a program on a target writes a character, hashes numbers, and reads a counter that goes up. */
#ifndef COUNTER_H
#define COUNTER_H

#include <stdint.h>

#if defined(__AVR__) || defined(__arm__)
#define COUNTS 1
#else
#define COUNTS 0
#endif
/* Not inlined, so that reading a counter twice costs the same whatever lies between. */
#define APART __attribute__((noinline))

#if defined(__AVR__)
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

static volatile uint16_t overflows;
ISR(TIMER1_OVF_vect)
{
  overflows++;
}

static void restart(void)
{
  cli();
  TCNT1 = 0;
  TIFR1 = 1 << TOV1;
  overflows = 0;
  sei();
}

static void put(char c)
{
  while (!(UCSR0A & (1 << UDRE0))) {
  }
  UDR0 = (uint8_t)c;
}

static void begin(void)
{
  UBRR0 = 0;
  UCSR0B = 1 << TXEN0;
  TCCR1A = 0;
  TCCR1B = 1 << CS10; /* cycles */
  TIMSK1 = 1 << TOIE1;
  sei();
}

APART static uint32_t now(void)
{
  uint16_t low, high;
  cli();
  low = TCNT1;
  high = overflows;
  if ((TIFR1 & (1 << TOV1)) && low < 0x8000u) {
    high++;
  }
  sei();
  return (uint32_t)high << 16 | low;
}

static void finish(void)
{
  while (!(UCSR0A & (1 << UDRE0))) {
  }
  cli();
  sleep_enable();
  sleep_cpu();
}
#else
#include <stdio.h>
static void put(char c)
{
  (void)putchar(c);
}
static void finish(void)
{
}
#ifdef __arm__
#define SYSTICK ((volatile uint32_t *)0xE000E010u)
void thousand(void);        /* takes 1,000 instructions and the call */
volatile uint32_t overflows; /* of the timer's 24 bits; its interrupt is in queries.S */
static void restart(void)
{
  SYSTICK[2] = 0;
  overflows = 0;
}
static void begin(void)
{
  SYSTICK[1] = 0xFFFFFFu;
  SYSTICK[0] = 7;
  restart();
}
APART static uint32_t now(void)
{
  return (overflows << 24) + (0xFFFFFFu - SYSTICK[2]);
}
#else
#define restart()
#define begin()
#define now() 0u
#endif
#endif

static void put_hex(char kind, uint32_t value)
{
  int8_t digit;
  put(kind);
  for (digit = 28; digit >= 0; digit -= 4) {
    put("0123456789abcdef"[value >> digit & 15u]);
  }
  put('\n');
}

/* What the counter says of a known length: a thousand instructions, or three overflows of cycles. */
static void put_known(void)
{
#if COUNTS
  uint32_t start, empty;
  restart();
  start = now();
  empty = now() - start;
  start = now();
#ifdef __AVR__
  __builtin_avr_delay_cycles(3ul << 16);
  put_hex('o', now() - start - empty - (3ul << 16));
#else
  thousand();
  put_hex('o', now() - start - empty);
#endif
#endif
}

/* FNV-1a, 32 bits, over a number's bytes, the lowest first on any target. */
static uint32_t mix(uint32_t hash, const void *number, uint8_t size)
{
  const uint8_t *byte = (const uint8_t *)number;
  uint8_t i;
  for (i = 0; i < size; i++) {
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    hash = (hash ^ byte[size - 1 - i]) * 16777619u;
#else
    hash = (hash ^ byte[i]) * 16777619u;
#endif
  }
  return hash;
}

static uint32_t mix_status(uint32_t hash, int status)
{
  const int8_t small = (int8_t)status;
  return mix(hash, &small, 1);
}

#endif
