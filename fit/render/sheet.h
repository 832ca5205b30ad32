/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheet - spheres side by side in one picture: a row a material, a column for the measured table and each model. */
#ifndef SHEET_H
#define SHEET_H

#include "fit/render/picture_error.h"

struct sheet {
	struct image image; /* linear; owned */
	int size;           /* of a sphere */
	int scale;          /* pixels a dot of the labels */
	int columns, rows;
	bool differences; /* below each row of spheres stands one of their differences from the first of the row */
};

/* SHEET_DELTA_E - the difference at which the false colours end. */
#define SHEET_DELTA_E 10.0

/* sheet_init - an empty sheet. STATUS_DOMAIN where it would be larger than a picture can be; STATUS_NO_MEMORY. */
MUST_CHECK enum status sheet_init(struct sheet *sheet, int size, int columns, int rows, bool differences);
void sheet_free(struct sheet *sheet);
/* sheet_end - cuts off what is below the first n rows. */
void sheet_end(struct sheet *sheet, int n);
/* sheet_error_label - the label of a sphere that differs so much from the measured one: CIEDE2000 and, where there is room for
 * it, SSIM. */
void sheet_error_label(const struct sheet *sheet, const struct picture_error *error, char *label, size_t size);

/* sheet_title - writes what a column shows at its top. */
void sheet_title(struct sheet *sheet, int column, const char *title);
/* sheet_sphere - draws a sphere, with a label above it. */
void sheet_sphere(struct sheet *sheet, int column, int row, const struct sphere *sphere, const char *label);
/* sheet_difference - draws below a sphere how far it is from `from`, CIEDE2000 in false colours. */
void sheet_difference(struct sheet *sheet, int column, int row, const struct sphere *sphere, const struct sphere *from);
/* sheet_legend - draws below the first sphere of a row what the false colours mean; nothing where spheres are smaller
 * than SHEET_LEGEND_SIZE, which leaves no room for it. */
enum { SHEET_LEGEND_SIZE = 64 };
void sheet_legend(struct sheet *sheet, int row);

#endif
