/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes are a picture: Radiance HDR or PFM, as they begin. What is read has the pixels that it says. */
#include "fit/render/image.h"
#include "fuzz.h"

int fuzz_image(const uint8_t *data, size_t size)
{
	char path[FUZZ_PATH], message[1024];
	struct error error = {""};
	struct image image;
	const int fd = fuzz_file(data, size, path);
	const enum status status = image_read(path, &image, &error);

	close(fd);
	snprintf(message, sizeof message, "stdfit: %s\n", error.text);
	if (status != STATUS_OK) {
		PROMISE(is_message(message));
		return 0;
	}
	const size_t pixels = (size_t)image.width * (size_t)image.height;
	volatile float last = 0;

	PROMISE(image.width > 0 && image.height > 0);
	/* A claim of many pixels needs bytes for them. */
	PROMISE(pixels <= 64 * size + 64);
	for (size_t n = 0; n < 3 * pixels; n++)
		last = image.rgb[n];
	(void)last;
	image_free(&image);
	return 0;
}
