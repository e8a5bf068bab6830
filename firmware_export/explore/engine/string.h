/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* What smap.c needs of string.h, for WebAssembly without a C library: see memory.c. */
#ifndef STRING_H
#define STRING_H

#include <stddef.h>

void *memcpy(void *to, const void *from, size_t size);
void *memset(void *to, int value, size_t size);

#endif
