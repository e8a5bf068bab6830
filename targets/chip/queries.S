/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The queries as they are in queries.bin: nothing that a compiler could round.
 * And a thousand instructions, to see whether a counter counts them. */
#ifdef __AVR__
  .section .progmem.data, "a", @progbits
#else
  .section .rodata, "a"
#endif
  .balign 4
  .global queries
queries:
  .incbin "queries.bin"

#ifndef __AVR__
  .text
  .balign 4
  .global thousand
#ifdef __arm__
  .syntax unified
  .thumb
#endif
/* The timer's interrupt: 5 instructions, which the reader of the counts takes off again. */
#ifdef __arm__
  .global arm_systick_isr
  .thumb_func
arm_systick_isr:
  ldr r0, =overflows
  ldr r1, [r0]
  adds r1, r1, #1
  str r1, [r0]
  bx lr
  .pool
  .balign 4
  .thumb_func
#endif
thousand:
  .rept 999
  nop
  .endr
#ifdef __arm__
  bx lr
#else
  ret
#endif
#endif
