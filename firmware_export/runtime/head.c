/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- head: what the compiler must keep to, and how it is told ---------------------------------- */

#if SMAP_VERSION != 2
#error "smap.c and smap.h are of different versions: use the files of one export together"
#endif

/* Every operation rounds once, and NaN is NaN: the errors in NAME.h were measured so.  Where a compiler
 * can be told inside the source it is; where it cannot, flags that change answers are refused. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "compile exports of lutgen without -ffast-math: answers would change, and NaN would be safe"
#endif
#elif defined(__GNUC__)
#pragma GCC push_options
#pragma GCC optimize("no-fast-math", "fp-contract=off")
#elif defined(__FAST_MATH__)
#error "compile exports of lutgen without -ffast-math: answers would change, and NaN would be safe"
#else
#pragma STDC FP_CONTRACT OFF
#endif
#if defined(__FLT_EVAL_METHOD__) && (__FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2) && !defined(SMAP_WIDE_FLOATS)
#error "singles must round to singles: on x86 compile with -msse2 -mfpmath=sse"
#endif

/* Unless code is to be small, loops of a known number of turns become straight code, and functions part
 * of their callers: the tables of an export are known, so most of what they say becomes constants.  Of
 * many contacts next to nothing is known but their positions (SMAP_FOLD), and a sanitizer's checks, copied
 * into every turn, take a compiler minutes: there functions stay what they are. */
#if defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__) && defined(__OPTIMIZE__) && \
    !defined(SMAP_HOST) && !defined(__AVR__) && !defined(__SANITIZE_ADDRESS__)
#define SMAP_MAY_GROW 1
#else
#define SMAP_MAY_GROW 0
#endif
#if SMAP_MAY_GROW && !SMAP_MANY
#define SMAP_INLINE static inline __attribute__((__always_inline__))
#ifdef __clang__
#define SMAP_UNROLL /* decides well by itself, and would warn of what it declines */
#else
/* Of a loop whose turns it does not know, gcc makes as many copies as are named here. */
#define SMAP_UNROLL _Pragma("GCC unroll 16")
#endif
#define SMAP_RARELY(condition) __builtin_expect((condition), 0)
#elif defined(__GNUC__)
#define SMAP_INLINE static __attribute__((__unused__))
#define SMAP_UNROLL
#define SMAP_RARELY(condition) (condition)
#else
#define SMAP_INLINE static inline
#define SMAP_UNROLL
#define SMAP_RARELY(condition) (condition)
#endif
#if SMAP_MAY_GROW && !defined(__clang__)
#define SMAP_FOLDED static inline __attribute__((__always_inline__))
#define SMAP_FOLD _Pragma("GCC unroll 64")
#else
#define SMAP_FOLDED SMAP_INLINE
#define SMAP_FOLD SMAP_UNROLL
#endif

/* Three coordinates become straight code in any case. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#define SMAP_THRICE _Pragma("GCC unroll 3")
#else
#define SMAP_THRICE
#endif

/* Stays a function, so that its calls can be counted (the bound of a pose rests on it). */
#if defined(__GNUC__)
#define SMAP_APART __attribute__((__noinline__))
#else
#define SMAP_APART
#endif

#if defined(__AVR__) && defined(__GNUC__) && __GNUC__ < 8
/* avr-gcc 5 fails ("in get_use_type") where it improves loops over what lies in flash. */
#pragma GCC optimize("no-ivopts")
#endif

#define SMAP_PI 3.14159265f
#define SMAP_LARGEST 3.402823466e+38f
#define SMAP_NAN smap_from_bits(0x7FC00000u)

