/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measured_bsdf - a measurement as a file of the RGL format, which pbrt-v4 and Mitsuba 3 read as "measured". */
#ifndef MEASURED_BSDF_H
#define MEASURED_BSDF_H

#include "data_readers/measurement.h"
#include <stdatomic.h>

/* measured_bsdf_write - writes linear sRGB at 48 theta_i and 96 x 96 half vectors; of a sample that turns, at 33 phi_i, 12
 * theta_i and 32 x 32. The measurement is a table, or scattered entries of
 * a sample that turns [measured.h]; half of the density of nodes follows what is measured where wi and wo are 20 degrees from h.
 * *error becomes the L1 distance of the file to the measured entries, weighted by solid angle and cosines, divided by their
 * norm. Written beside `path`, renamed when complete. STATUS_IO, STATUS_NO_MEMORY, STATUS_NO_DATA (all is 0). */
MUST_CHECK enum status measured_bsdf_write(const char *path, const struct measurement *measurement, enum bins bins,
					   const char *description, int threads, double *error, struct error *why);

#endif
