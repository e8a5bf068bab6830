/* SPDX-License-Identifier: MIT
 * Copyright (c) The lutgen authors */
/* |SD_g| of many postures in many directions, written as one would: for every direction the facet
 * whose plane the ray pierces first, its walls, a square root and a division.  The arrays are
 * those of references.py. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void stability_factor(const double *facets, size_t most_facets, const double *walls,
                      size_t most_walls, const int64_t *first, const int64_t *counts,
                      size_t postures, const double *directions, size_t count, float *out)
{
    for (size_t m = 0; m < postures; m++) {
        const double *facet = facets + 9 * most_facets * m;
        const double *wall = walls + 3 * most_walls * m;
        const int64_t *start = first + (most_facets + 1) * m;
        const int64_t held = counts[m];
        for (size_t i = 0; i < count; i++) {
            const double *g = directions + 3 * i;
            double nearest = 0.0;
            int64_t best = -1;
            for (int64_t k = 0; k < held; k++) {
                const double rate = dot(facet + 9 * k, g);
                if (rate > nearest) {
                    nearest = rate;
                    best = k;
                }
            }
            float value = NAN;
            if (best >= 0) {
                int stands = 1;
                for (int64_t e = start[best]; e < start[best + 1]; e++)
                    stands &= dot(wall + 3 * e, g) >= 0.0;
                if (stands) {
                    const double along = dot(facet + 9 * best + 3, g);
                    const double aside = dot(facet + 9 * best + 6, g);
                    value = sqrtf((float)(along * along + aside * aside)) / (float)nearest;
                }
            }
            out[count * m + i] = value;
        }
    }
}

/* Tip angle, static stability margin and energy stability margin of a convex robot, written as one
 * would: for every direction all tip-over axes, each with its start, its stop and the inward unit
 * normal of its plane.  `out` holds the three, one after the other. */
void three_metrics(const double *axes, size_t held, const double *directions, size_t count,
                   double *out)
{
    for (size_t i = 0; i < count; i++) {
        const double *g = directions + 3 * i;
        double sine = 1.0, margin = INFINITY, energy = INFINITY;
        for (size_t b = 0; b < held; b++) {
            const double *start = axes + 9 * b, *stop = start + 3, *plane = start + 6;
            const double edge[3] = {stop[0] - start[0], stop[1] - start[1], stop[2] - start[2]};
            const double length = sqrt(dot(edge, edge));
            const double aside[3] = {edge[1] * g[2] - edge[2] * g[1], edge[2] * g[0] - edge[0] * g[2],
                                     edge[0] * g[1] - edge[1] * g[0]};
            const double across = sqrt(dot(aside, aside));
            const double part = dot(start, edge) / (length * length);
            const double arm[3] = {part * edge[0] - start[0], part * edge[1] - start[1],
                                   part * edge[2] - start[2]};
            const double inside = dot(plane, g);
            const double radius = sqrt(dot(arm, arm));
            const double away = inside * radius * length / across;
            const double rise = radius * across / length + dot(arm, g);
            sine = fmin(sine, inside);
            margin = fmin(margin, away);
            energy = fmin(energy, copysign(rise, inside));
        }
        out[i] = asin(sine);
        out[count + i] = margin;
        out[2 * count + i] = energy;
    }
}
