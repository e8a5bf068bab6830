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

#ifdef __arm__
  .syntax unified
  .text
  .balign 4
/* The timer's interrupt: 5 instructions, which the reader of the counts takes off again. */
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
  .global thousand
  .thumb_func
thousand:
  .rept 999
  nop
  .endr
  bx lr
#elif !defined(__AVR__)
  .section .note.GNU-stack, "", @progbits
#endif
