/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- blob: the descriptor and its tables, byte by byte ------------------------------------------
 * Little-endian numbers at offsets; no pointers and no padding, so alignment and address spaces do not
 * matter.  What an export knows of its own blob becomes constants where the compiler optimises.
 *
 *   0 crc   u32 of all that follows      8 version  u8     16 chart limit f32, a hair wide
 *   4 bytes u32 of everything            9 codec    u8     20 guard       f32, rad
 *                                       10 params   u8     24 step        f32, of lengths as integers
 *                                       11 channels u8     28 guard       u16, 1/32767
 *                                       12 faces    u8     30 chart limit u16, 1/4096, a hair wide
 *                                       13 contacts u8     32 axes, then the codec's own part
 */
enum {
  SMAP_CODEC_POINTS = 1,
  SMAP_CODEC_TABLES = 3,
  SMAP_CODEC_GRID,
  SMAP_CODEC_RAILS,
  SMAP_CODEC_SEARCH
};
enum { SMAP_SDG = 1, SMAP_TIP_ANGLE = 2, SMAP_HEIGHT = 4 }; /* bits of `channels` */
enum {
  SMAP_AT_CRC = 0,
  SMAP_AT_BYTES = 4,
  SMAP_AT_VERSION = 8,
  SMAP_AT_CODEC = 9,
  SMAP_AT_PARAMS = 10,
  SMAP_AT_CHANNELS = 11,
  SMAP_AT_FACES = 12,
  SMAP_AT_CONTACTS = 13,
  SMAP_AT_LIMIT = 16,
  SMAP_AT_GUARD = 20,
  SMAP_AT_STEP = 24,
  SMAP_AT_GUARD_I = 28,
  SMAP_AT_LIMIT_I = 30,
  SMAP_AT_AXES = 32,
  /* Of each axis: its ends, and how far beyond them it is still read (negative: it turns all the way
   * round); the same in steps (65535). */
  SMAP_AXIS_MIN = 0,
  SMAP_AXIS_MAX = 4,
  SMAP_AXIS_SLACK = 8,
  SMAP_AXIS_SLACK_I = 12,
  SMAP_AXIS_BYTES = 14
};

#ifdef SMAP_HOST
#define SMAP_BLOB(map) ((const uint8_t *)(map)->blob)
#else
#define SMAP_BLOB(map) ((void)(map), smap_blob)
#endif
typedef const SMAP_FLASH uint8_t *smap_bytes_t;

SMAP_INLINE uint16_t smap_u16(smap_bytes_t at)
{
  return (uint16_t)(at[0] | at[1] << 8);
}

SMAP_INLINE uint32_t smap_u32(smap_bytes_t at)
{
  return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

SMAP_INLINE float smap_f32(smap_bytes_t at)
{
  return smap_from_bits(smap_u32(at));
}

SMAP_INLINE smap_bytes_t smap_axis(const smap_t *map, uint8_t i)
{
  return SMAP_BLOB(map) + SMAP_AT_AXES + i * SMAP_AXIS_BYTES;
}

/* The codec's own part. */
SMAP_INLINE smap_bytes_t smap_body(const smap_t *map)
{
  return smap_axis(map, SMAP_BLOB(map)[SMAP_AT_PARAMS]);
}

/* What every pose begins with.  `status` is what reads answer unless it is SMAP_OK. */
typedef struct {
  const smap_t *map;
  int8_t status;
  uint8_t forms;
  uint16_t spare;
} smap_head_t;

