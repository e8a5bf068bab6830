/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- entries: robots on many contacts -----------------------------------------------------------
 * What the map adds to positions: nine singles (the level axis of all discs, size, steepest, least height,
 * rest width, tolerance, rock chord, guard: see smap_many_t), rails u8, the first contact of each rail and
 * behind the last u8, the recipe's number of each contact u8, the room of a pose (see smap_room_t) u8[6]; with
 * SMAP_BY_SERIES two singles more, off and turned. */
enum { SMAP_MANY_SINGLES = 36, SMAP_MANY_ROOM = 6 };

typedef struct {
  smap_head_t head;
  smap_many_pose_t real;
  union { /* the work is done when the integer form is made */
    smap_many_work_t work;
    smap_many_pose_i_t whole;
  } rest;
} smap_pose_memory_t;

typedef struct {
  smap_head_t head;
  smap_layout_t at;
  smap_many_pose_i_t whole;
} smap_pose_memory_i_t;

SMAP_INLINE smap_bytes_t smap_many_body(const smap_t *map)
{
  return smap_body(map) + SMAP_IN_MANY;
}

/* The room that a map tells. */
SMAP_INLINE smap_room_t smap_room_in(smap_bytes_t at)
{
  smap_room_t room;
  room.facets = at[0];
  room.edges = at[1];
  room.rests = at[2];
  room.corners = at[3];
  room.gaps = at[4];
  room.arcs = at[5];
  return room;
}

SMAP_INLINE void smap_many_numbers(const smap_t *map, smap_many_t *out)
{
  smap_bytes_t body = smap_many_body(map);
  uint8_t i;
  out->contacts = SMAP_BLOB(map)[SMAP_AT_CONTACTS];
  out->rails = body[SMAP_MANY_SINGLES];
  for (i = 0; i <= out->rails; i++) {
    out->first[i] = body[SMAP_MANY_SINGLES + 1 + i];
  }
  for (i = 0; i < out->contacts; i++) {
    out->named[i] = body[SMAP_MANY_SINGLES + 2 + out->rails + i];
  }
  out->axis[0] = smap_f32(body);
  out->axis[1] = smap_f32(body + 4);
  out->size = smap_f32(body + 8);
  out->steepest = smap_f32(body + 12);
  out->least_height = smap_f32(body + 16);
  out->rest_width = smap_f32(body + 20);
  out->tolerance = smap_f32(body + 24);
  out->rock_chord = smap_f32(body + 28);
  out->guard = smap_f32(body + 32);
#if SMAP_SERIES || defined(SMAP_CONTROL)
  out->off = out->turned = 0.0f;
#endif
#if SMAP_SERIES || !SMAP_MANY_KNOWN
  body += SMAP_MANY_SINGLES + 2 + out->rails + out->contacts;
#endif
#if !SMAP_MANY_KNOWN
  out->room = smap_room_in(body);
#endif
#if SMAP_SERIES
  body += SMAP_MANY_ROOM;
  if (smap_body(map)[SMAP_IN_FLAGS] & SMAP_BY_SERIES) {
    out->off = smap_f32(body);
    out->turned = smap_f32(body + 4);
  }
#endif
}

/* The radius of a contact. */
SMAP_INLINE float smap_radius(const smap_t *map, const smap_places_t *at, uint8_t contact)
{
  const uint8_t flags = smap_body(map)[SMAP_IN_FLAGS];
  if (!(flags & SMAP_ROUND)) {
    return 0.0f;
  }
  return smap_f32(flags & SMAP_SHARED ? at->weights + 4 * at->radii[contact] : at->radii + 4 * contact);
}

/* Put the contacts where checked parameters have them. */
SMAP_APART static int8_t smap_many_place(const smap_t *map, const float *params, smap_many_work_t *work)
{
  float q[SMAP_MAX_PARAMS], p[SMAP_MAX_COORDINATES];
  const int8_t status = smap_range(map, params, q);
  smap_places_t at;
  uint8_t i;
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  at = smap_places(map);
  smap_positions(map, q, p);
  for (i = 0; i < at.contacts; i++) {
    memcpy(work->p[i], &p[3 * i], sizeof work->p[i]);
    work->r[i] = smap_radius(map, &at, i);
#if SMAP_MANY_AXLES
    memset(work->axle[i], 0, sizeof work->axle[i]);
    if (smap_body(map)[SMAP_IN_AXES] != 0 && at.axis_of[i] != SMAP_NO_AXIS) {
      memcpy(work->axle[i], &p[3 * (at.contacts + at.axis_of[i])], sizeof work->axle[i]);
    }
#endif
  }
  return SMAP_OK;
}

/* Make the pose of checked parameters. */
static int8_t smap_many_of(const smap_t *map, const float *params, smap_many_pose_t *pose,
                           smap_many_work_t *work)
{
  smap_many_t numbers;
  int8_t status;
#if SMAP_MANY_AXLES
  float axle[SMAP_MANY_CONTACTS][3];
  work->axle = axle;
#endif
  status = smap_many_place(map, params, work);
  if (SMAP_RARELY(status != SMAP_OK)) {
    return status;
  }
  smap_many_numbers(map, &numbers);
  status = smap_many_pose(&numbers, pose, work) ? SMAP_OK : SMAP_TIPS;
  work->map = 0;
#if SMAP_MANY_AXLES
  work->axle = 0;
#endif
  return status;
}

/* Read a pose under a scaled direction. */
static int8_t smap_many_read(const smap_t *map, const smap_many_pose_t *pose, const float d[3],
                             smap_reading_t *out)
{
  const int8_t status = (int8_t)smap_many_at(pose, d, out);
  if (status != SMAP_OK && status != SMAP_ROCKS) {
    const float tip = out->tip_angle;
    out->tip_angle = tip < 0.0f ? tip : -SMAP_PI;
  }
  return smap_judge(map, out, status);
}

static int8_t smap_run_read(const smap_t *map, const float *params, const float *gravity,
                            smap_reading_t *out)
{
  smap_many_pose_t pose;
  smap_many_work_t work;
  float d[3];
  int8_t status = smap_many_of(map, params, &pose, &work);
  if (status == SMAP_OK) {
    status = smap_direction(map, gravity, d);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  return smap_many_read(map, &pose, d, out);
}

static int8_t smap_run_at(const void *pose, const float *gravity, smap_reading_t *out)
{
  const smap_pose_memory_t *const many = (const smap_pose_memory_t *)pose;
  float d[3];
  int8_t status = many->head.forms & SMAP_FLOAT ? many->head.status : (int8_t)SMAP_INVALID;
  if (status == SMAP_OK) {
    status = smap_direction(many->head.map, gravity, d);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny(out, -SMAP_PI, status);
  }
  return smap_many_read(many->head.map, &many->real, d, out);
}

static int8_t smap_run_at_i(const void *pose, const int16_t *gravity, smap_reading_i_t *out)
{
  const smap_head_t *const head = (const smap_head_t *)pose;
  const smap_pose_memory_t *const both = (const smap_pose_memory_t *)pose;
  const smap_pose_memory_i_t *const alone = (const smap_pose_memory_i_t *)pose;
  const int whole = (head->forms & SMAP_FLOAT) == 0;
  const uint8_t channels = SMAP_BLOB(head->map)[SMAP_AT_CHANNELS];
  int32_t g[3];
  uint32_t length;
  int8_t status = head->forms & SMAP_INTEGER ? head->status : (int8_t)SMAP_INVALID;
  if (status == SMAP_OK) {
    status = smap_direction_i(head->map, gravity, g, &length);
  }
  if (SMAP_RARELY(status != SMAP_OK)) {
    return smap_deny_i(out, status);
  }
  status = (int8_t)smap_many_at_i(whole ? &alone->at : &both->real.at,
                                  whole ? &alone->whole : &both->rest.whole, g, length, out);
  if (status != SMAP_OK && status != SMAP_ROCKS) {
    out->tip = out->tip < 0 ? out->tip : (int16_t)-1;
  }
  if (out->tip < 0 || !(channels & SMAP_SDG)) {
    out->sdg = 65535;
  }
  if (out->tip < 0 || !(channels & SMAP_HEIGHT)) {
    out->height = 65535;
  }
  return out->tip < 0 ? (int8_t)SMAP_TIPS : status;
}

/* Make a pose with floats; the work on it is done in its own memory. */
static int8_t smap_pose_floats(const smap_t *map, const float *params, smap_pose_memory_t *pose, uint16_t bytes,
                               uint8_t forms)
{
  if (!smap_begin(map, pose, bytes, forms, sizeof *pose)) {
    return SMAP_INVALID;
  }
  pose->head.status = smap_many_of(map, params, &pose->real, &pose->rest.work);
  return pose->head.status;
}

/* Make one of integers alone, with all work on the stack: apart, so that one with floats needs none of that. */
SMAP_APART static int8_t smap_pose_whole(const smap_t *map, const float *params, smap_pose_memory_i_t *pose,
                                         uint16_t bytes, uint8_t forms)
{
  smap_many_pose_t real;
  smap_many_work_t work;
  if (!smap_begin(map, pose, bytes, forms, sizeof *pose)) {
    return SMAP_INVALID;
  }
  pose->head.status = smap_many_of(map, params, &real, &work);
  if (pose->head.status == SMAP_OK) {
    const float step = smap_f32(SMAP_BLOB(map) + SMAP_AT_STEP);
    pose->at = real.at;
    smap_many_make_i(&real, step, step, &pose->whole);
  }
  return pose->head.status;
}

static int8_t smap_run_pose(const smap_t *map, const float *params, void *pose, uint16_t bytes,
                            uint8_t forms)
{
  smap_pose_memory_t *const many = (smap_pose_memory_t *)pose;
  int8_t status;
  if (!(forms & SMAP_FLOAT)) {
    return smap_pose_whole(map, params, (smap_pose_memory_i_t *)pose, bytes, forms);
  }
  status = smap_pose_floats(map, params, many, bytes, forms);
  if ((forms & SMAP_INTEGER) && status == SMAP_OK) {
    const float step = smap_f32(SMAP_BLOB(map) + SMAP_AT_STEP);
    smap_many_make_i(&many->real, step, step, &many->rest.whole);
  }
  return status;
}

/* Whether a map's room is that of an export, or of any robot not beyond what there is. */
static int smap_is_room(uint32_t found, uint32_t most)
{
  return SMAP_MANY_KNOWN ? found == most : found <= most;
}

static int smap_check_room(const smap_room_t *room)
{
  return smap_is_room(room->facets, SMAP_MANY_FACETS) && smap_is_room(room->edges, SMAP_MANY_EDGES) &&
         smap_is_room(room->rests, SMAP_MANY_RESTS) && smap_is_room(room->corners, SMAP_MANY_CORNERS) &&
         smap_is_room(room->gaps, SMAP_MANY_GAPS) && smap_is_room(room->arcs, SMAP_MANY_ARCS);
}

/* Numbers that no loop or index may be led astray by. */
static int smap_check_many(const smap_t *map)
{
  const smap_bytes_t body = smap_many_body(map);
  const uint16_t bytes = smap_u16(smap_body(map) + SMAP_IN_MANY_BYTES);
  const uint8_t contacts = SMAP_BLOB(map)[SMAP_AT_CONTACTS];
  const uint8_t rails = bytes > SMAP_MANY_SINGLES ? body[SMAP_MANY_SINGLES] : SMAP_NONE;
  const smap_bytes_t first = body + SMAP_MANY_SINGLES + 1;
  smap_bytes_t after;
  smap_room_t room;
  uint16_t more = SMAP_MANY_ROOM;
  uint8_t i;
#if SMAP_SERIES
  if (smap_body(map)[SMAP_IN_FLAGS] & SMAP_BY_SERIES) {
    more = SMAP_MANY_ROOM + 8;
  }
#endif
  if (contacts > SMAP_MANY_CONTACTS || contacts < 3 || rails > SMAP_MANY_RAILS ||
      (SMAP_MANY_KNOWN && (contacts != SMAP_MANY_CONTACTS || rails != SMAP_MANY_RAILS)) ||
      (rails == 0) != (SMAP_MANY_RAILS == 0) ||
      bytes != SMAP_MANY_SINGLES + 2u + rails + contacts + more ||
      first[0] != 0 || (rails != 0 && first[rails] != contacts)) {
    return 0;
  }
  for (i = 0; i < rails; i++) {
    if (first[i] >= first[i + 1]) {
      return 0;
    }
  }
  for (i = 0; i < SMAP_MANY_SINGLES; i = (uint8_t)(i + 4)) {
    if (!smap_is_within(smap_f32(body + i), 1e6f)) {
      return 0;
    }
  }
  after = body + SMAP_MANY_SINGLES + 2 + rails + contacts;
  room = smap_room_in(after);
#if SMAP_SERIES
  if (more > SMAP_MANY_ROOM && !(smap_is_within(smap_f32(after + SMAP_MANY_ROOM), 1e6f) &&
                                 smap_is_within(smap_f32(after + SMAP_MANY_ROOM + 4), 1e6f))) {
    return 0;
  }
#endif
  return smap_check_room(&room) && smap_is_within(smap_f32(body), 1.001f) &&
         smap_is_within(smap_f32(body + 4), 1.001f) && smap_is_positive(smap_f32(body + 8)) &&
         smap_is_within(smap_f32(body + 32), 0.5f);
}

