/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/image.h"

#ifdef HAVE_LIBPNG

#include "data_readers/atomic_file.h"
#include "data_readers/text_quote.h"
#include "fit/render/colour.h"
#include <math.h>
#include <png.h>
#include <stdlib.h>

bool image_has_png(void)
{
	return true;
}

static unsigned char *encode(const struct image *image)
{
	const size_t n = 3 * (size_t)image->width * (size_t)image->height;
	unsigned char *bytes = malloc(n);
	for (size_t i = 0; i < n && bytes; i++)
		bytes[i] = (unsigned char)lrint(255 * srgb_encode((double)image->rgb[i]));
	return bytes;
}

enum status image_write_png(const char *path, const struct image *image, struct error *error)
{
	struct atomic_file file;
	png_image png = {.version = PNG_IMAGE_VERSION,
			 .width = (png_uint_32)image->width,
			 .height = (png_uint_32)image->height,
			 .format = PNG_FORMAT_RGB};
	unsigned char *bytes = encode(image);
	if (!bytes)
		return error_set(error, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	enum status status = atomic_file_open(&file, path, error);
	if (status == STATUS_OK && png_image_write_to_stdio(&png, file.stream, 0, bytes, 0, NULL)) {
		status = atomic_file_commit(&file, error);
	} else if (status == STATUS_OK) {
		char name[TEXT_QUOTE_SIZE];
		text_quote(path, name, sizeof name);
		atomic_file_abort(&file);
		status = error_set(error, STATUS_IO, "cannot write '%s': libpng: %.60s", name, png.message);
	}
	free(bytes);
	return status;
}

#else

bool image_has_png(void)
{
	return false;
}

enum status image_write_png(const char *path, const struct image *image, struct error *error)
{
	(void)path;
	(void)image;
	return error_set(error, STATUS_UNSUPPORTED, "this build cannot write PNG: it was made without libpng");
}

#endif
