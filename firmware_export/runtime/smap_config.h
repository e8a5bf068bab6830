/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* smap: what the runtime is built with, beside its codecs: their switches stand with their structs in
 * smap.h.  An export brings its own copy, which sets all of them to just what it needs. */
#ifndef SMAP_CONFIG_H
#define SMAP_CONFIG_H

/* With -O2 an export's own file sets SMAP_SHARED to 0 and names its map (SMAP_ONLY, SMAP_ONLY_FILE): smap.c
 * then takes the tables in, and the compiler makes constants of all that is known of them. */
#ifndef SMAP_SHARED
#define SMAP_SHARED 1 /* 0 where the runtime is built for one map alone, and faster */
#endif
#ifndef SMAP_SPHERE
#define SMAP_SPHERE 1 /* charts of six faces */
#endif
#ifndef SMAP_MAX_PARAMS
#define SMAP_MAX_PARAMS 8 /* most geometry parameters of any map */
#endif
#ifndef SMAP_MAX_CONTACTS
#define SMAP_MAX_CONTACTS 32 /* codec `contacts`: most contacts of any map */
#endif
#ifndef SMAP_MAX_HINGES
#define SMAP_MAX_HINGES 32 /* codec `contacts`: most different disc axes of any map */
#endif
#ifndef SMAP_MAX_ENTRIES
#define SMAP_MAX_ENTRIES 64 /* codec `contacts`: most modes and products of any map, and one */
#endif
#ifndef SMAP_HARDWARE_ROOT
#define SMAP_HARDWARE_ROOT 1 /* 0: never use the processor's square root */
#endif
#ifndef SMAP_FLASH
#define SMAP_FLASH /* type qualifier of tables; __flash or __memx with avr-gcc */
#endif

#endif
