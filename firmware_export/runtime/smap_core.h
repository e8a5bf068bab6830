/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- core: what the compiler must keep to, and what stands in for the C library ------------------ */

/* Every operation rounds once, and NaN is NaN: the errors in NAME.h were measured so.  Where a compiler
 * can be told inside the source it is; where it cannot, flags that change answers are refused. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-fast-math", "fp-contract=off")
#define SMAP_MAY_FUSE 0
#elif defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "compile exports of lutgen without -ffast-math: answers would change, and NaN would be safe"
#else
#pragma STDC FP_CONTRACT OFF
#define SMAP_MAY_FUSE 1 /* clang does when it is told -ffp-contract=fast, whatever the pragma says */
#endif
#if defined(__FLT_EVAL_METHOD__) && (__FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2) && !defined(SMAP_WIDE_FLOATS)
#error "singles must round to singles: on x86 compile with -msse2 -mfpmath=sse"
#endif

#ifdef __GNUC__
#define SMAP_PLAIN static __attribute__((__unused__))
#define SMAP_SMALL static inline __attribute__((__unused__))
#define SMAP_ALWAYS static inline __attribute__((__always_inline__, __unused__))
#define SMAP_APART __attribute__((__noinline__))
#define SMAP_RARELY(condition) __builtin_expect((condition), 0)
#define SMAP_ABSOLUTE(x) __builtin_fabsf(x)
#define SMAP_ZEROS(x) ((uint8_t)(__builtin_clzl(x) + 32 - 8 * (int)sizeof(long))) /* leading bits that are 0 */
#else
#define SMAP_PLAIN static inline
#define SMAP_SMALL static inline
#define SMAP_ALWAYS static inline
#define SMAP_APART
#define SMAP_RARELY(condition) (condition)
#define SMAP_ABSOLUTE(x) ((x) < 0.0f ? -(x) : (x))
#define SMAP_ZEROS(x) smap_zeros(x)
#endif

/* Unless code is to be small, loops of a known number of turns become straight code, and functions part
 * of their callers: the tables of an export are known, so most of what they say becomes constants.  A
 * family says how much of this it wants, by SMAP_INLINE and SMAP_UNROLL.  A sanitizer's checks, copied into
 * every turn, take a compiler minutes; clang decides well by itself, and would warn of what it declines. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#define SMAP_COPIES(text) _Pragma(text)
#else
#define SMAP_COPIES(text)
#endif
#if defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && !defined(SMAP_HOST) && !defined(__AVR__) && \
    !defined(__SANITIZE_ADDRESS__)
#define SMAP_FOLDED SMAP_ALWAYS
#define SMAP_FOLD SMAP_COPIES("GCC unroll 64")
#define SMAP_SOME SMAP_COPIES("GCC unroll 16") /* of a loop whose turns gcc does not know it makes as many */
#else
#define SMAP_FOLDED SMAP_PLAIN
#define SMAP_FOLD
#define SMAP_SOME
#endif
#define SMAP_THRICE SMAP_COPIES("GCC unroll 3") /* three coordinates */
#define SMAP_TWICE SMAP_COPIES("GCC unroll 2")  /* two ends */

#if defined(__AVR__) && defined(__GNUC__) && __GNUC__ < 8
/* avr-gcc 5 fails ("in get_use_type") where it improves loops over what lies in flash. */
#pragma GCC optimize("no-ivopts")
#endif

#define SMAP_PI 3.14159265f
#define SMAP_LARGEST 3.402823466e+38f

SMAP_ALWAYS uint32_t smap_bits(float x)
{
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

SMAP_ALWAYS float smap_from_bits(uint32_t bits)
{
  float x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* These tell by bits, so that no compiler can take them for always true. */
SMAP_INLINE int smap_is_finite(float x)
{
  return smap_bits(x) << 1 < 0xFF000000u;
}

SMAP_INLINE int smap_is_positive(float x)
{
  return smap_bits(x) - 1u < 0x7F7FFFFFu;
}

/* Tell whether |x| is at most a positive limit; no NaN is. */
SMAP_INLINE int smap_is_within(float x, float limit)
{
  return (smap_bits(x) & 0x7FFFFFFFu) <= smap_bits(limit);
}

/* Tell whether products and sums are fused although the source forbids it: then nothing is answered rather
 * than something else. */
SMAP_INLINE int smap_fuses(void)
{
  const volatile float a = 1.00024414f, b = -1.00048828f; /* a a = 1.00048834; rounded it is -b */
  const float x = a;
  return x * x + b != 0.0f;
}

/* The processor's square root, unless SMAP_SOFT_ROOT is defined, or else digit by digit. */
#if !defined(SMAP_SOFT_ROOT) && defined(__ARM_FP) && (__ARM_FP & 4)
#define SMAP_ROOT(result, x) __asm__("vsqrt.f32 %0, %1" : "=t"(result) : "t"(x))
#elif !defined(SMAP_SOFT_ROOT) && defined(__aarch64__)
#define SMAP_ROOT(result, x) __asm__("fsqrt %s0, %s1" : "=w"(result) : "w"(x))
#elif !defined(SMAP_SOFT_ROOT) && defined(__riscv_flen)
#define SMAP_ROOT(result, x) __asm__("fsqrt.s %0, %1" : "=f"(result) : "f"(x))
#elif !defined(SMAP_SOFT_ROOT) && defined(__SSE__)
#define SMAP_ROOT(result, x) __asm__("sqrtss %1, %0" : "=x"(result) : "x"(x))
#else
#define SMAP_ROOT(result, x) result = smap_root_of(x)
#endif

/* Square root of a finite x >= 0, correctly rounded: 24 binary digits and one to round by. */
SMAP_PLAIN float smap_root_of(float x)
{
  float result = x;
  if (x > 0.0f) {
    uint32_t bits = smap_bits(x), mantissa = bits & 0x7FFFFFu, digits = 0, sum = 0, digit;
    int32_t exponent = (int32_t)(bits >> 23);
    if (exponent == 0) { /* denormal: at most 23 shifts */
      exponent = 1;
      /*@ admit mantissa > 0; */
      /*@ loop unroll 24; */
      while (mantissa < 0x800000u) {
        mantissa <<= 1;
        exponent--;
      }
    } else {
      mantissa |= 0x800000u;
    }
    exponent += 127; /* never negative, so that the shift below is defined */
    mantissa <<= 1 + (exponent & 1);
    /*@ loop unroll 26; */
    for (digit = 0x1000000u; digit != 0; digit >>= 1) {
      const uint32_t trial = sum + digit;
      if (trial <= mantissa) {
        sum = trial + digit;
        mantissa -= trial;
        digits += digit;
      }
      mantissa <<= 1;
    }
    if (mantissa != 0) {
      digits += digits & 1u;
    }
    result = smap_from_bits((digits >> 1) + ((uint32_t)(exponent >> 1) << 23) - 0x800000u);
  }
  return result;
}

SMAP_ALWAYS float smap_root(float x)
{
  float result;
  SMAP_ROOT(result, x);
  return result;
}

SMAP_ALWAYS float smap_absolute(float x)
{
  return SMAP_ABSOLUTE(x);
}

/* asin(x) in rad to 3e-7 (Cephes); arguments beyond 1 count as 1. */
SMAP_INLINE float smap_asin(float x)
{
  const float a = smap_absolute(x);
  float z = x * x, s = x, y;
  if (a > 0.5f) {
    z = a < 1.0f ? 0.5f * (1.0f - a) : 0.0f;
    s = smap_root(z);
  }
  y = 4.2163199048e-2f * z + 2.4181311049e-2f;
  y = (y * z + 4.5470025998e-2f) * z + 7.4953002686e-2f;
  y = s + s * z * (y * z + 1.6666752422e-1f);
  if (a > 0.5f) {
    y = 1.57079633f - (y + y);
    y = x < 0.0f ? -y : y;
  }
  return y;
}

/* Sine and cosine to 1.2e-7 of |x| up to 10,000 rad: what is left of quarter turns (their length in
 * three parts, the first two of so few digits that the products are exact), and two polynomials. */
SMAP_INLINE void smap_sine_cosine(float x, float *sine, float *cosine)
{
  const float turns = x * 0.63661977f;
  const int32_t n = (int32_t)(turns + (turns < 0.0f ? -0.5f : 0.5f));
  const float part = (float)n;
  const float y = ((x - part * 1.5703125f) - part * 4.83751297e-4f) - part * 7.54978995e-8f;
  const float z = y * y;
  const float a = y + y * z * (-1.6666655e-1f + z * (8.3321609e-3f - z * 1.9515296e-4f));
  const float b =
      1.0f - 0.5f * z + z * z * (4.1666646e-2f + z * (-1.3887316e-3f + z * 2.4433157e-5f));
  const float s = n & 1 ? b : a, c = n & 1 ? a : b;
  *sine = n & 2 ? -s : s;
  *cosine = (n + 1) & 2 ? -c : c;
}

/* The same of |x| up to 1.05 rad, without quarter turns. */
SMAP_INLINE void smap_sine_cosine_near(float x, float *sine, float *cosine)
{
  const float z = x * x;
  *sine = x + x * z * (-1.66665762e-1f + z * (8.32904341e-3f - z * 1.92274811e-4f));
  *cosine =
      1.0f - 0.5f * z + z * z * (4.16665546e-2f + z * (-1.38840651e-3f + z * 2.41561438e-5f));
}

SMAP_INLINE float smap_dot(const float a[3], const float b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

SMAP_INLINE void smap_cross(const float a[3], const float b[3], float out[3])
{
  /* Before any is stored, which might alter a or b: nothing is loaded twice. */
  const float x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2];
  const float z = a[0] * b[1] - a[1] * b[0];
  out[0] = x;
  out[1] = y;
  out[2] = z;
}

SMAP_INLINE void smap_minus(const float a[3], const float b[3], float out[3])
{
  out[0] = a[0] - b[0];
  out[1] = a[1] - b[1];
  out[2] = a[2] - b[2];
}

/* Go from p so many times v. */
SMAP_INLINE void smap_plus(const float p[3], float times, const float v[3], float out[3])
{
  out[0] = p[0] + times * v[0];
  out[1] = p[1] + times * v[1];
  out[2] = p[2] + times * v[2];
}

/* The square of a distance. */
SMAP_INLINE float smap_apart2(const float a[3], const float b[3])
{
  float d[3];
  smap_minus(a, b, d);
  return smap_dot(d, d);
}

/* The nearest whole number; 0 for what is beyond `most`, at most 32767, or no number. */
SMAP_INLINE int16_t smap_to_whole(float x, float most)
{
  if (x >= -most && x <= most) {
    const float away = x < 0.0f ? x - 0.5f : x + 0.5f;
    /*@ admit \is_finite(away) && -32767.5 <= away <= 32767.5; */
    return (int16_t)away;
  }
  return 0;
}
/* How many leading bits of x > 0 are 0. */
SMAP_PLAIN uint8_t smap_zeros(uint32_t x)
{
  uint8_t zeros = 0;
  for (; zeros < 31 && x << zeros < 0x80000000u; zeros++) {
  }
  return zeros;
}

#if defined(__ARM_FEATURE_IDIV) && defined(__ARM_FEATURE_CLZ) && !defined(__OPTIMIZE_SIZE__)
#define SMAP_ROOT_BY_DIVISION 1
#else
#define SMAP_ROOT_BY_DIVISION 0
#endif

/* Square root, rounded down, of at most 3 * 2^30, which is the longest direction. */
SMAP_INLINE uint32_t smap_whole_root(uint32_t x)
{
  uint32_t result = 0, digit;
  if (SMAP_ROOT_BY_DIVISION) {
    /* A line, then Newton: off by up to 6 %, 0.2 %, and at last by less than 1 (0.1, and rounding). */
    const uint32_t odd = x | 1u; /* so that there is a first digit */
    const int half = (33 - SMAP_ZEROS(odd)) >> 1;
    result = (((uint32_t)3 << half) + 5u * (odd >> half)) / 8u + 1u;
    result = (result + odd / result) >> 1;
    result = (result + odd / result) >> 1;
    return result - (result * result > x);
  }
  for (digit = (uint32_t)1 << 30; digit != 0; digit >>= 2) {
    if (x >= result + digit) {
      x -= result + digit;
      result = (result >> 1) + digit;
    } else {
      result >>= 1;
    }
  }
  /*@ admit result <= 65535; */
  return result;
}

/* The same of a scaled direction's, 2^28 to 3 * 2^30. */
SMAP_INLINE uint32_t smap_length_root(uint32_t x)
{
  /* A line, then Newton: off by up to 11 %, 0.6 %, and at last by less than 1. */
  uint32_t result = (x >> 16) + 13900u;
  if (!SMAP_ROOT_BY_DIVISION) {
    return smap_whole_root(x);
  }
  result = (result + x / result) >> 1;
  result = (result + x / result) >> 1;
  return result - (result * result > x);
}
