/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* ---- planes on any contacts: points, spheres, and discs whose axes are not parallel ------------------- */
#define SMAP_FLAT 1e-6f     /* of a disc that lies flatter, the square of the sine to its axle */
#define SMAP_FACE 0.173658f /* the sine of 10 deg: nearer to a plane's normal a carrying wheel's axle may not be, */
#define SMAP_FLATTEST 1e-2f /* nor than this, whatever `upright` says: its rim touches where rounding likes */

/* Whether a contact is a disc, with an axle, and no point or ball. */
static inline int smap_is_disc(const smap_many_work_t *w, uint8_t i)
{
#if SMAP_MANY_AXLES
  return w->axle[i][1] != 0.0f || w->axle[i][0] != 0.0f || w->axle[i][2] != 0.0f;
#else
  (void)w;
  (void)i;
  return 0;
#endif
}

/* Whether two contacts are points or balls of one size. */
static inline int smap_are_alike(const smap_many_work_t *w, uint8_t i, uint8_t j)
{
  return w->r[i] == w->r[j] && !smap_is_disc(w, i) && !smap_is_disc(w, j);
}

/* The cosine between a disc's axle and a plane's normal. */
static inline float smap_along_axle(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
#if SMAP_MANY_AXLES
  return smap_dot(w->axle[i], at->n);
#else
  (void)w;
  (void)i;
  (void)at;
  return 0.0f;
#endif
}

/* Where a contact touches a plane. */
static void smap_touch(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at, float out[3])
{
  float r = w->r[i];
  uint8_t k;
#if SMAP_MANY_AXLES
  if (smap_is_disc(w, i)) {
    const float along = smap_along_axle(w, i, at), flat = 1.0f - along * along;
    r = r / smap_root(flat > SMAP_FLAT ? flat : SMAP_FLAT);
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      out[k] = w->p[i][k] + r * (at->n[k] - along * w->axle[i][k]);
    }
    return;
  }
#endif
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    out[k] = w->p[i][k] + r * at->n[k];
  }
}

/* The direction of a vector. */
static void smap_aim(smap_aim_t *o, const float v[3])
{
  const float size = 1.0f / smap_root(smap_dot(v, v));
  uint8_t k;
  o->s = o->c = 0.0f;
  SMAP_THRICE
  for (k = 0; k < 3; k++) {
    o->n[k] = v[k] * size;
  }
}

/* The plane on the contacts i and j at a fraction of the way between two others. */
static void smap_on_arc(const smap_many_work_t *w, uint8_t i, uint8_t j, const smap_aim_t *from,
                        const smap_aim_t *to, float part, smap_aim_t *out)
{
  float v[3], p[3], q[3], size, higher;
  uint8_t round, k;
  smap_mix(from->n, to->n, part, v);
  smap_aim(out, v);
  /* Of balls of one size each goes on as far as the other: the first plane is right. */
  for (round = smap_are_alike(w, i, j) ? 2 : 0; round < 2; round++) {
    smap_touch(w, i, out, p);
    smap_touch(w, j, out, q);
    smap_minus(p, q, v);
    higher = smap_dot(v, out->n);
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      v[k] -= higher * out->n[k];
    }
    size = smap_dot(v, v);
    if (!(size > 0.0f)) {
      return;
    }
    SMAP_THRICE
    for (k = 0; k < 3; k++) {
      v[k] = out->n[k] - v[k] * (higher / size);
    }
    smap_aim(out, v);
  }
}

/* The directions along and across on a plane. */
static void smap_frame(const smap_aim_t *aim, float along[3], float across[3])
{
  const float *n = aim->n, size = 1.0f / smap_root(n[0] * n[0] + n[2] * n[2]);
  along[0] = -n[2] * size;
  along[1] = 0.0f;
  along[2] = n[0] * size;
  smap_cross(along, n, across);
}

/* Where a contact touches a plane, along and across. */
static void smap_find_spot(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at,
                           const float along[3], const float across[3], smap_spot_t *o)
{
  float p[3];
  smap_touch(w, i, at, p);
  o->a = p[0] * along[0] + p[2] * along[2];
  o->b = smap_dot(p, across);
  o->contact = i;
}

#if SMAP_MANY_AXLES
/* The square of a small sine between two unit vectors, to the last digit. */
SMAP_APART static float smap_small_sine2(const float a[3], const float b[3])
{
  float across[3];
  smap_cross(a, b, across);
  return smap_dot(across, across);
}
#endif

/* The square of the sine between a plane's normal and a disc's axle; 1 of others. */
static inline float smap_sine2_to_axle(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
#if SMAP_MANY_AXLES
  const float along = smap_along_axle(w, i, at), flat = 1.0f - along * along;
  return flat > SMAP_FLAT ? flat : smap_small_sine2(w->axle[i], at->n);
#else
  (void)w;
  (void)i;
  (void)at;
  return 1.0f;
#endif
}

/* Whether a contact is a wheel that lies on its face: nobody stands on that.  Of level axles `upright` says so
 * itself. */
static int smap_is_flat(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
  const float steepest = w->map->steepest > SMAP_FLATTEST ? w->map->steepest : SMAP_FLATTEST;
  const float face = SMAP_FACE + SMAP_OFF_TURNED(w->map), least = steepest < face ? steepest : face;
  return smap_is_disc(w, i) && !(smap_sine2_to_axle(w, i, at) > least * least);
}

/* How far a contact extends along a plane's normal. */
static inline float smap_extent(const smap_many_work_t *w, uint8_t i, const smap_aim_t *at)
{
  return smap_dot(w->p[i], at->n) + (smap_is_disc(w, i) ? w->r[i] * smap_root(smap_sine2_to_axle(w, i, at)) : w->r[i]);
}
