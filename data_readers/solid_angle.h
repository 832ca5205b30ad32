/* SPDX-License-Identifier: GPL-3.0-or-later */
/* solid_angle - what part of the two hemispheres an entry stands for.
 *
 * Where a file has no grid, the domain of the entries is cut into cells, one for each direction pair: of the angles in
 * which the entries differ, the one with the largest extent is cut half way between two neighbours near the middle, and
 * so on in both halves. On a grid these are the cells of the trapezoidal rule; elsewhere they are much like Voronoi
 * cells, but take O(n log n). The angles are theta_i, theta_o and the size of the difference of the azimuths, and of a
 * sample that is not isotropic also the azimuth of wi. An outermost cell reaches as far beyond its entry as towards the
 * next one, but not out of the hemisphere; an angle in which no entries differ, as the azimuth in a single plane,
 * counts in full. Entries that are within 0.006 degrees of each other in each angle share their cell. */
#ifndef SOLID_ANGLE_H
#define SOLID_ANGLE_H

#include "data_readers/measurement.h"

/* solid_angle_estimate - sets solid_angle of all entries, sr^2. The sum is at most that of the two hemispheres, 4 pi^2.
 * STATUS_NO_MEMORY. */
MUST_CHECK enum status solid_angle_estimate(struct scattered *scattered);

/* solid_angle_edges - edge[0 .. n] of the cells of a grid's values, which rise: half way between them, and beyond the
 * first and the last as far as on the other side, but within low .. high; these are the edges of a single one. */
void solid_angle_edges(const double *value, size_t n, double low, double high, double *edge);

#endif
