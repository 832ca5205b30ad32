/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/image.h"
#include "data_readers/regular_file.h"
#include "data_readers/text_quote.h"
#include "fit/render/image_decode.h"
#include <stdlib.h>

enum status image_alloc(struct image *image, int width, int height)
{
	*image = (struct image){0};
	if (width < 1 || height < 1 || width > IMAGE_SIZE_MAX || height > IMAGE_SIZE_MAX)
		return STATUS_DOMAIN;
	float *rgb = calloc((size_t)width * (size_t)height, 3 * sizeof(float));
	if (!rgb)
		return STATUS_NO_MEMORY;
	*image = (struct image){width, height, rgb};
	return STATUS_OK;
}

void image_free(struct image *image)
{
	free(image->rgb);
	*image = (struct image){0};
}

enum status image_alloc_for(struct image *image, double width, double height, struct error *why)
{
	*image = (struct image){0};
	if (!(width >= 1 && height >= 1 && width <= IMAGE_SIZE_MAX && height <= IMAGE_SIZE_MAX &&
	      width * height <= 0x1p27))
		return error_set(why, STATUS_FORMAT,
				 "expected sides from 1 to %d and at most 2^27 pixels, found %g x %g", IMAGE_SIZE_MAX,
				 width, height);
	const enum status status = image_alloc(image, (int)width, (int)height);
	return status != STATUS_OK ? error_set(why, status, "%s", status_str(status)) : STATUS_OK;
}

enum status image_read(const char *path, struct image *image, struct error *error)
{
	static const char what[] = "a PFM or Radiance .hdr picture";
	unsigned char *bytes;
	size_t size;
	struct error why;
	*image = (struct image){0};
	enum status status = regular_file_read(path, what, (size_t)1 << 31, &bytes, &size, &why);
	if (status == STATUS_OK && image_is_pfm(bytes, size))
		status = image_decode_pfm(bytes, size, image, &why);
	else if (status == STATUS_OK && image_is_hdr(bytes, size))
		status = image_decode_hdr(bytes, size, image, &why);
	else if (status == STATUS_OK)
		status = error_set(&why, STATUS_FORMAT, "expected %s, found neither at its beginning", what);
	free(bytes);
	if (status == STATUS_OK)
		return STATUS_OK;
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	return error_set(error, status, "cannot read '%s': %.200s", name, why.text);
}
