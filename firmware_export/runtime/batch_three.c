/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* The same for contacts that are three points, which smap.c reads by other code. */
#define SMAP_CONTACTS_MANY 0
#define SMAP_GRID 0
#define SMAP_GRID_INTEGER 0
#define SMAP_POLY 0
#define BATCH(name) name##_three
#include "batch.c"
