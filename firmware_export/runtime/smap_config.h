/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* smap: what depends on the target and not on the map.  The same in every export. */
#ifndef SMAP_CONFIG_H
#define SMAP_CONFIG_H

#ifndef SMAP_HARDWARE_ROOT
#define SMAP_HARDWARE_ROOT 1 /* 0: never use the processor's square root */
#endif
/* avr-gcc reads constants from flash only where they have an address space of their own, which
 * needs C with GNU extensions; else they are copied to RAM.  Other targets have them in flash.
 * SMAP_ADDRESS: what a descriptor says of its blob; the functions of an export know their own. */
#ifndef SMAP_FLASH
#if defined(__AVR__) && defined(__FLASH) && !defined(__STRICT_ANSI__)
#define SMAP_FLASH __flash /* needs -std=gnu99 or later */
#define SMAP_ADDRESS(blob) 0
#else
#define SMAP_FLASH
#endif
#endif
#ifndef SMAP_ADDRESS
#define SMAP_ADDRESS(blob) (blob)
#endif

#endif
