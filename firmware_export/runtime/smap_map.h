/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
#include "smap_core.h"

/* ---- map: the descriptor and its tables, byte by byte ----------------------------------------------
 * Little-endian numbers at offsets; no pointers and no padding, so alignment and address spaces do not
 * matter.  What an export knows of its own blob becomes constants where the compiler optimises. */
enum {
  SMAP_CODEC_POINTS = 1,
  SMAP_CODEC_TABLES = 3,
  SMAP_CODEC_GRID,
  SMAP_CODEC_RAILS,
  SMAP_CODEC_SEARCH
};
enum { SMAP_SDG = 1, SMAP_TIP_ANGLE = 2, SMAP_HEIGHT = 4 }; /* bits of `channels` */
enum {
  SMAP_AT_CRC = 0,       /* u32 of all that follows */
  SMAP_AT_BYTES = 4,     /* u32 of everything */
  SMAP_AT_VERSION = 8,   /* u8, as the next five */
  SMAP_AT_CODEC = 9,
  SMAP_AT_PARAMS = 10,
  SMAP_AT_CHANNELS = 11,
  SMAP_AT_FACES = 12,
  SMAP_AT_CONTACTS = 13,
  SMAP_AT_LIMIT = 16,    /* f32, of the chart, a hair wide */
  SMAP_AT_GUARD = 20,    /* f32, rad */
  SMAP_AT_STEP = 24,     /* f32, of lengths as integers */
  SMAP_AT_GUARD_I = 28,  /* u16, 1/32767 */
  SMAP_AT_LIMIT_I = 30,  /* u16, 1/4096, a hair wide */
  SMAP_AT_AXES = 32,     /* and then the codec's own part */
  /* An axis has two ends, and is read beyond them by the sensor tolerance, which also stands in
   * steps.  A negative one (65535 steps) says that the joint turns all the way round. */
  SMAP_AXIS_MIN = 0,
  SMAP_AXIS_MAX = 4,
  SMAP_AXIS_SLACK = 8,
  SMAP_AXIS_SLACK_I = 12,
  SMAP_AXIS_BYTES = 14
};

/* avr-gcc reads constants from flash only where they have an address space of their own, which
 * needs C with GNU extensions; else they are copied to RAM.  Other targets have them in flash.
 * SMAP_ADDRESS: what a descriptor says of its blob; the functions of an export know their own. */
#if defined(__AVR__) && defined(__FLASH) && !defined(__STRICT_ANSI__)
#define SMAP_FLASH __flash /* needs -std=gnu99 or later */
#define SMAP_ADDRESS(blob) 0
#else
#define SMAP_FLASH
#define SMAP_ADDRESS(blob) (blob)
#endif
typedef const SMAP_FLASH uint8_t *smap_bytes_t;

/* An export's own tables stand at the end of its file, and its arrays are as large as its map says; a host has more.
 * SMAP_KNOWN: the exporter has looked at every index and size of them, and their CRC says that they are the same. */
#ifdef SMAP_HOST
#define SMAP_BLOB(map) ((smap_bytes_t)(map)->blob)
#define SMAP_KNOWN 0
#define SMAP_ROOM(room, most) ((room) < (most) ? (room) : (most))
#define SMAP_GIVEN(read, known) (read)
#else
extern const SMAP_FLASH uint8_t SMAP_OWN_BLOB[SMAP_OWN_BYTES];
#define SMAP_BLOB(map) ((void)(map), (smap_bytes_t)SMAP_OWN_BLOB)
#define SMAP_KNOWN 1
#define SMAP_ROOM(room, most) (most)
#define SMAP_GIVEN(read, known) ((void)sizeof(read), (known))
#endif

SMAP_ALWAYS uint16_t smap_u16(smap_bytes_t at)
{
  return (uint16_t)(at[0] | at[1] << 8);
}

SMAP_ALWAYS uint32_t smap_u32(smap_bytes_t at)
{
  return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

SMAP_ALWAYS float smap_f32(smap_bytes_t at)
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

/* Prepare the caller's memory for a pose of some of the `known` forms; 0 where it is too small. */
static int smap_begin(const smap_t *map, smap_pose_t *pose, uint16_t bytes, uint8_t forms, uint8_t known,
                      uint32_t needed)
{
  if (bytes >= sizeof map) {
    memset(pose, 0, sizeof map);
  }
  if (bytes < needed || forms == 0 || (forms & ~known) != 0) {
    return 0;
  }
  pose->map = map;
  pose->forms = forms;
  return 1;
}

/* ---- check: is the map in flash what was exported, and can no number of it lead astray? ------------ */

/* CRC-32 (IEEE 802.3) as flash has the bytes now: nothing that the compiler knows of them counts. */
static uint32_t smap_crc(smap_bytes_t bytes, uint32_t count)
{
  const volatile SMAP_FLASH uint8_t *const now = bytes;
  uint32_t crc = 0xFFFFFFFFu, i;
  for (i = 0; i < count; i++) {
    uint8_t bit;
    crc ^= now[i];
    for (bit = 0; bit < 8; bit++) {
      crc = crc >> 1 ^ (crc & 1u ? 0xEDB88320u : 0u);
    }
  }
  return ~crc;
}

/* Checks the head that all maps have. */
static int smap_check_head(const smap_t *map)
{
  const smap_bytes_t blob = SMAP_BLOB(map);
  return map->size >= SMAP_AT_AXES && smap_u32(blob + SMAP_AT_BYTES) == map->size &&
         smap_crc(blob + 4, map->size - 4u) == smap_u32(blob) && blob[SMAP_AT_VERSION] == SMAP_VERSION &&
         blob[SMAP_AT_CODEC] == SMAP_CODEC && blob[SMAP_AT_PARAMS] <= SMAP_MAX_PARAMS &&
         SMAP_AT_AXES + (uint32_t)SMAP_AXIS_BYTES * blob[SMAP_AT_PARAMS] < map->size;
}

/* Tells whether singles, so many bytes apart, are within a limit. */
SMAP_PLAIN int smap_check_singles(smap_bytes_t at, uint32_t count, uint8_t apart, float limit)
{
  for (; count > 0; count--, at += apart) {
    if (!smap_is_within(smap_f32(at), limit)) {
      return 0;
    }
  }
  return 1;
}

/* Tells whether bytes are below a number. */
SMAP_PLAIN int smap_check_below(smap_bytes_t at, uint32_t count, uint32_t limit)
{
  for (; count > 0; count--, at++) {
    if (*at >= limit) {
      return 0;
    }
  }
  return 1;
}

/* The singles of a map that is read with floats: finite, upper ends above lower ones. */
SMAP_PLAIN int smap_check_axes(const smap_t *map)
{
  uint8_t i;
  for (i = 0; i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++) {
    const smap_bytes_t axis = smap_axis(map, i);
    if (!smap_check_singles(axis, 3, 4, 1e6f) || (!SMAP_TURNS && smap_f32(axis + SMAP_AXIS_SLACK) < 0.0f) ||
        !smap_is_positive(smap_f32(axis + SMAP_AXIS_MAX) - smap_f32(axis + SMAP_AXIS_MIN))) {
      return 0;
    }
  }
  return smap_check_singles(SMAP_BLOB(map) + SMAP_AT_LIMIT, 3, 4, SMAP_LARGEST) &&
         smap_is_positive(smap_f32(SMAP_BLOB(map) + SMAP_AT_STEP));
}

/* The rest of a map, up to `limit`: each family has its own. */
static int smap_check_own(const smap_t *map, smap_bytes_t limit);

static int8_t smap_run_check(const smap_t *map)
{
  return smap_check_head(map) && (SMAP_KNOWN || smap_check_own(map, SMAP_BLOB(map) + map->size)) ? SMAP_OK
                                                                                                : SMAP_CORRUPT;
}
