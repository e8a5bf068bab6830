/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* How a program on a target writes a character and reads a counter that goes up. */
#ifndef COUNTER_H
#define COUNTER_H

#include <stdint.h>

/* Not inlined, so that reading a counter twice costs the same whatever lies between. */
#ifndef APART
#define APART __attribute__((noinline))
#endif

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
#elif defined(__wasm__)
#define main run /* without a C library main is nothing special */
int run(void);
char text[64]; /* for the runner */
uint32_t length;
static void put(char c)
{
  if (length < sizeof text) {
    text[length++] = c;
  }
}
static void begin(void)
{
  length = 0;
}
static void finish(void)
{
}
#define restart()
#define now() 0u
#else
#include <stdio.h>
void thousand(void); /* takes 1,000 instructions and the call */
static void put(char c)
{
  (void)putchar(c);
}
static void finish(void)
{
}
#if defined(__arm__)
#define SYSTICK ((volatile uint32_t *)0xE000E010u)
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
static void begin(void)
{
}
APART static uint32_t now(void)
{
  uint32_t count;
  __asm__ volatile(".option push\n.option arch, +zicsr\ncsrr %0, minstret\n.option pop"
                   : "=r"(count));
  return count;
}
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

#endif
