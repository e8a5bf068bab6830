/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* memcpy and memset for WebAssembly without a C library. */
#include "string.h"

void *memcpy(void *to, const void *from, size_t size)
{
  unsigned char *out = (unsigned char *)to;
  const unsigned char *in = (const unsigned char *)from;
  while (size--) {
    *out++ = *in++;
  }
  return to;
}

void *memset(void *to, int value, size_t size)
{
  unsigned char *out = (unsigned char *)to;
  while (size--) {
    *out++ = (unsigned char)value;
  }
  return to;
}
