/* SPDX-License-Identifier: GPL-3.0-or-later */
/* image - pictures of linear light: read from PFM and Radiance .hdr files, written as PFM and PNG. */
#ifndef IMAGE_H
#define IMAGE_H

#include "src/status.h"
#include <stdbool.h>
#include <stddef.h>

enum { IMAGE_SIZE_MAX = 32768 }; /* pixels along a side */

/* struct image - rgb[3 (x + width y) + c], row 0 on top; linear components, see colour.h. */
struct image {
	int width, height;
	float *rgb;
};

/* image_alloc - a black picture. STATUS_DOMAIN for a side below 1 or above IMAGE_SIZE_MAX, STATUS_NO_MEMORY; *image is
 * then cleared. */
MUST_CHECK enum status image_alloc(struct image *image, int width, int height);
/* image_free - releases the pixels and clears the struct; harmless on a zeroed one. */
void image_free(struct image *image);

static inline float *image_at(const struct image *image, int x, int y)
{
	return image->rgb + 3 * ((size_t)x + (size_t)image->width * (size_t)y);
}

/* image_read - reads a PFM ("PF" colour or "Pf" grey, of either byte order; its scale factor is left aside, only its
 * sign is read) or a Radiance picture (RGBE, run-length encoded or not, top to bottom; its EXPOSURE is divided out).
 * Which of them it is, the file's first bytes tell. Values are as in the file, NaN and negative ones of a PFM too.
 * Returns STATUS_IO; STATUS_FORMAT: it is neither, or broken, or cut short; STATUS_NO_MEMORY. *image is then cleared,
 * and `error` reads "cannot read 'path': ...". Never waits on a pipe or a device. */
MUST_CHECK enum status image_read(const char *path, struct image *image, struct error *error);

/* image_write_pfm - a colour PFM, little-endian, every float as it is.
 * image_write_png - 8 bits a channel, sRGB, values outside [0, 1] clipped, NaN as 0. STATUS_UNSUPPORTED in a build
 * without libpng. Both are written beside `path` and renamed, see atomic_file.h; STATUS_IO, STATUS_NO_MEMORY. */
MUST_CHECK enum status image_write_pfm(const char *path, const struct image *image, struct error *error);
MUST_CHECK enum status image_write_png(const char *path, const struct image *image, struct error *error);

/* image_has_png - whether this build can write PNG. */
bool image_has_png(void);

#endif
