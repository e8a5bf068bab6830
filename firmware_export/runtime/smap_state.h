/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- state: what on-board control keeps between cycles ------------------------------------------- */
/* The policy, byte by byte, as smap_map.h has the map. */
enum {
  SMAP_POLICY_CRC = 0,       /* u32 of the settings: bytes 8 to the table */
  SMAP_POLICY_CRC_TABLE = 4, /* u32 */
  SMAP_POLICY_MAP = 8,       /* u32, the map's crc */
  SMAP_POLICY_VERSION = 12,  /* u8 */
  SMAP_POLICY_PARAMS = 13,   /* u8 */
  SMAP_POLICY_NODES = 14,    /* u8, of a side */
  SMAP_POLICY_POSES = 15,    /* u8, of a cycle */
  SMAP_POLICY_LIMIT = 16,    /* f32, largest |u| and |v| of the table */
  SMAP_POLICY_CYCLE = 20,    /* f32, s */
  SMAP_POLICY_LATENCY = 24,  /* f32, s */
  SMAP_POLICY_MARGIN = 28,   /* f32, rad, that is asked for */
  SMAP_POLICY_LEVELS = 32,   /* f32[3], rad, of the alarm */
  SMAP_POLICY_SWERVE = 44,   /* f32, rad, of `up` unexplained */
  SMAP_POLICY_JOINTS = 48,   /* eight singles each, then the table: codes u8 [u][v][parameter] */
  SMAP_POLICY_JOINT = 32, /* bytes of a parameter's singles */
  /* A parameter: value of code 0, of a step of codes; change in a cycle; range around what is desired;
   * change that needs no new pose; and what one unit of it alters at most: of many contacts how far (length) it
   * moves those that are its own beyond others, of a grid the tip angle; how far it moves the others, of three
   * points the tip angle's second derivative; how far it turns the body. */
  SMAP_JOINT_LOW = 0,
  SMAP_JOINT_CODE = 4,
  SMAP_JOINT_RATE = 8,
  SMAP_JOINT_DELTA = 12,
  SMAP_JOINT_NEAR = 16,
  SMAP_JOINT_REACH = 20,
  SMAP_JOINT_BEND = 24,
  SMAP_JOINT_LEAN = 28
};

#ifdef SMAP_HOST
#define SMAP_POLICY(control) ((smap_bytes_t)(control)->policy)
#else
extern const SMAP_FLASH uint8_t SMAP_OWN_POLICY[SMAP_OWN_POLICY_BYTES];
#define SMAP_POLICY(control) ((void)(control), (smap_bytes_t)SMAP_OWN_POLICY)
#endif
#define SMAP_CONTROLLED(control) ((control)->map)

#define SMAP_LONG 1000.0f /* s */
#define SMAP_MOST_BUDGET 50.0f /* m/s^2: no robot accelerates more */
enum { SMAP_ALL = 255 };

/* Flags of a state: the poses that are made, and whether there was a sample before. */
enum { SMAP_HAS_HERE = 1, SMAP_HAS_SWEPT = 2, SMAP_HAS_SAMPLE = 4, SMAP_HAS_COMMAND = 8, SMAP_HAS_NORMAL = 16 };

/* A state.  `here` is the pose of the posture `at`; `swept` holds for all within `half` of `mid`.  `normal`: of the
 * plane on which the robot stood `since` cycles ago; `lean`: how fast it has turned the body by its joints, rad/s;
 * `slope`: by which the table was asked last. */
typedef struct {
  const smap_control_t *control;
  float command[SMAP_MAX_PARAMS], at[SMAP_MAX_PARAMS], mid[SMAP_MAX_PARAMS], half[SMAP_MAX_PARAMS];
  float up[3], part, turned, normal[3], lean[3], slope[3];
  uint8_t has, level, later;
  uint8_t calm, stuck, only, since, spare; /* only: the joint that moves, or SMAP_ALL */
  smap_pose_memory_t here;
  smap_swept_t swept;
} smap_state_memory_t;

/* The numbers of a way: its certified least tip angle, and the tip angle at its end (of many contacts, half
 * way), rad. */
typedef struct {
  float least, end;
} smap_way_t;

static float smap_setting(const smap_control_t *control, uint8_t at)
{
  return smap_f32(SMAP_POLICY(control) + at);
}

static float smap_joint(const smap_control_t *control, uint8_t i, uint8_t what)
{
  return smap_f32(SMAP_POLICY(control) + SMAP_POLICY_JOINTS + (uint16_t)(SMAP_POLICY_JOINT * i) + what);
}

/* Number of joints; the map says so, and the policy that was checked. */
static uint8_t smap_joints(const smap_control_t *control)
{
  return SMAP_BLOB(SMAP_CONTROLLED(control))[SMAP_AT_PARAMS];
}

static float smap_lesser(float a, float b)
{
  return a < b ? a : b;
}

/* x between two ends; the lower one where it is no number. */
static float smap_between(float x, float low, float high)
{
  return x > low ? x < high ? x : high : low;
}

/* x within its joint's axis. */
static float smap_on_axis(const smap_control_t *control, uint8_t i, float x)
{
  const smap_bytes_t axis = smap_axis(SMAP_CONTROLLED(control), i);
  return smap_between(x, smap_f32(axis + SMAP_AXIS_MIN), smap_f32(axis + SMAP_AXIS_MAX));
}

static int smap_are_finite(const float *x, uint8_t count)
{
  uint8_t i;
  for (i = 0; i < count; i++) {
    if (!smap_is_finite(x[i])) {
      return 0;
    }
  }
  return 1;
}

/* Scale to length 1; 0 where there is none. */
static int smap_to_unit(float v[3])
{
  const float most = smap_lesser(3.0e38f, smap_absolute(v[0]) + smap_absolute(v[1]) + smap_absolute(v[2]));
  float scale;
  uint8_t i;
  if (!(most > 1e-30f) || !smap_are_finite(v, 3)) {
    return 0;
  }
  for (i = 0; i < 3; i++) {
    v[i] = v[i] / most;
  }
  scale = 1.0f / smap_root(smap_dot(v, v));
  for (i = 0; i < 3; i++) {
    v[i] *= scale;
  }
  return 1;
}

/* Turn a direction that the map does not hold to the rim of its chart.  Returns by how much at most, rad; 0
 * where it is on the chart. */
static float smap_to_chart(const smap_t *map, const float g[3], float on[3])
{
  const smap_bytes_t blob = SMAP_BLOB(map);
  const float limit = 0.9999f * smap_f32(blob + SMAP_AT_LIMIT), down = g[2] < -1e-3f ? -g[2] : 1e-3f;
  float square, chord;
  memcpy(on, g, sizeof(float) * 3);
  if (blob[SMAP_AT_FACES] != 1 || (smap_absolute(g[0]) < limit * down && smap_absolute(g[1]) < limit * down &&
                                   g[2] < -1e-3f)) {
    return 0.0f;
  }
  on[0] = smap_between(g[0], -limit * down, limit * down);
  on[1] = smap_between(g[1], -limit * down, limit * down);
  on[2] = -down;
  (void)smap_to_unit(on);
  square = 2.0f - 2.0f * smap_dot(on, g);
  chord = square > 0.0f ? smap_root(square) : 0.0f;
  /* An angle is no more than so much above its chord. */
  return square < 2.0f ? chord * (1.0f + 0.0625f * square) + 1e-3f : SMAP_PI;
}

/* The tip angle of a pose under a direction, unit; what is unsafe or unknown is below 0.  Off the chart from below: it
 * changes by no more than the direction turns. */
static float smap_tip_of(const smap_pose_memory_t *pose, const float g[3])
{
  smap_reading_t reading;
  float on[3];
  const float turned = smap_to_chart(pose->head.map, g, on);
  (void)smap_run_at(&pose->head, on, &reading);
  return smap_between(reading.tip_angle - turned, -SMAP_PI, SMAP_PI);
}

/* Turn a direction from the body's frame to that of a plane whose upward normal is `up` (sign 1), or back
 * (-1): the least rotation between it and the z axis.  Upside down there is none: by half a turn about x. */
static void smap_lean(const float up[3], const float in[3], float sign, float out[3])
{
  const float a = sign * up[1], b = -sign * up[0], square = up[0] * up[0] + up[1] * up[1];
  float share = 0.0f, first[3];
  if (up[2] < 0.0f && square < 1e-12f) {
    out[0] = in[0];
    out[1] = -in[1];
    out[2] = -in[2];
    return;
  }
  share = up[2] > -0.5f ? 1.0f / (1.0f + up[2]) : (1.0f - up[2]) / square;
  first[0] = b * in[2];
  first[1] = -a * in[2];
  first[2] = a * in[1] - b * in[0];
  out[0] = in[0] + first[0] + share * b * first[2];
  out[1] = in[1] + first[1] - share * a * first[2];
  out[2] = in[2] + first[2] + share * (a * first[1] - b * first[0]);
}
