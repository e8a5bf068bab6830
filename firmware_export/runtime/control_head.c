/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- control head: as smap.c, whose functions it uses -------------------------------------------- */

#if SMAP_CONTROL_VERSION != 1
#error "smap_control.c and smap_control.h are of different versions: use the files of one export together"
#endif
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC push_options
#pragma GCC optimize("no-fast-math", "fp-contract=off")
#endif

