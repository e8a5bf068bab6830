/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* What the runtime needs of string.h: WebAssembly has instructions for it. */
#include <stddef.h>
#define memcpy __builtin_memcpy
#define memset __builtin_memset
