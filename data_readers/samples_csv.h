/* SPDX-License-Identifier: GPL-3.0-or-later */
/* samples_csv - samples as CSV: a line that names the columns, then a row per sample.
 *
 * Columns, in any order: theta_i, phi_i, theta_o, phi_o in degrees, or with _rad behind the name in radians; or wi_x,
 * wi_y, wi_z, wo_x, wo_y, wo_z. Without both azimuths the samples lie in the plane of incidence: theta_o is then
 * signed, positive on the side of the mirror direction. Without phi_i alone that is 0. Then r, g, b (linear sRGB), or
 * value (gray), or wavelengths such as 550nm or 550, rising; and, if wanted, solid_angle (sr^2). Incident_angle and
 * Measure_angle, as goniometers write, mean theta_i and theta_o in degrees, and a reflectance factor if nothing else is
 * said. Fields are separated by what the line of names has: commas, semicolons, else blanks and tabs. An empty field
 * means that nothing was measured.
 *
 * Lines that begin with # are comments. Among these, "# quantity: NAME" (quantity.h) and "# symmetry: isotropic",
 * "plane" or "anisotropic" before the line of names are understood. */
#ifndef SAMPLES_CSV_H
#define SAMPLES_CSV_H

#include "data_readers/text_format.h"

extern const struct text_format samples_csv;

/* samples_csv_write - writes entries, or the valid ones above the horizon of a table, with theta and phi in degrees, r,
 * g, b or, where the measurement is gray, value, and solid_angle. Written beside `path`, renamed when complete, see
 * atomic_file.h. *n becomes the number of rows. STATUS_NO_DATA: there is none; STATUS_IO, STATUS_NO_MEMORY. */
MUST_CHECK enum status samples_csv_write(const char *path, const struct measurement *measurement, enum bins bins,
					 size_t *n, struct error *error);

#endif
