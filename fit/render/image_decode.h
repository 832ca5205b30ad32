/* SPDX-License-Identifier: GPL-3.0-or-later */
/* image_decode - the two formats that image_read() knows, from bytes in memory. Private to data_readers/. */
#ifndef IMAGE_DECODE_H
#define IMAGE_DECODE_H

#include "fit/render/image.h"

/* Each: whether the bytes begin as such a file does. */
bool image_is_pfm(const unsigned char *bytes, size_t size);
bool image_is_hdr(const unsigned char *bytes, size_t size);

/* Each: the picture in the bytes. On STATUS_FORMAT and STATUS_NO_MEMORY `why` says what was expected and found, and
 * *image is cleared. */
MUST_CHECK enum status image_decode_pfm(const unsigned char *bytes, size_t size, struct image *image,
					struct error *why);
MUST_CHECK enum status image_decode_hdr(const unsigned char *bytes, size_t size, struct image *image,
					struct error *why);

/* image_alloc_for - room for a picture of this size, which a file says it has; at most 2^27 pixels of it. */
MUST_CHECK enum status image_alloc_for(struct image *image, double width, double height, struct error *why);

#endif
