/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PFM: "PF" or "Pf", width, height, a scale factor that is negative for little-endian, one white space, then float32
 * row by row from the bottom up. By hand: a header line and floats, less than calling a library takes. */
#include "data_readers/atomic_file.h"
#include "fit/render/image_decode.h"
#include <endian.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

bool image_is_pfm(const unsigned char *bytes, size_t size)
{
	return size > 2 && bytes[0] == 'P' && (bytes[1] == 'F' || bytes[1] == 'f') && strchr(" \t\r\n", bytes[2]);
}

/* The next word, terminated, and the one character behind it passed over. False: it is none that could be a number. */
static bool next_word(const unsigned char *bytes, size_t size, size_t *at, char word[32])
{
	size_t length = 0;
	while (*at < size && strchr(" \t\r\n", bytes[*at]) && bytes[*at])
		++*at;
	while (*at < size && bytes[*at] > ' ' && bytes[*at] < 0x7f) {
		if (length == 31)
			return false;
		word[length++] = (char)bytes[(*at)++];
	}
	word[length] = '\0';
	return length && ++*at <= size;
}

static bool next_number(const unsigned char *bytes, size_t size, size_t *at, double *number)
{
	char word[32], *end;
	if (!next_word(bytes, size, at, word))
		return false;
	*number = strtod(word, &end);
	return !*end && isfinite(*number);
}

static float float_at(const unsigned char *bytes, bool little)
{
	uint32_t bits;
	float value;
	memcpy(&bits, bytes, sizeof bits);
	bits = little ? le32toh(bits) : be32toh(bits);
	memcpy(&value, &bits, sizeof value);
	return value;
}

enum status image_decode_pfm(const unsigned char *bytes, size_t size, struct image *image, struct error *why)
{
	const size_t channels = bytes[1] == 'F' ? 3 : 1;
	size_t at = 2;
	double width, height, scale;
	*image = (struct image){0};
	if (!next_number(bytes, size, &at, &width) || !next_number(bytes, size, &at, &height) ||
	    !next_number(bytes, size, &at, &scale) || width != rint(width) || height != rint(height) || scale == 0)
		return error_set(why, STATUS_FORMAT, "expected width, height and scale behind '%.2s'",
				 (const char *)bytes);
	const double wanted = width * height * (double)channels * sizeof(float);
	if (width > 0 && height > 0 && wanted <= 0x1p40 && (double)(size - at) < wanted)
		return error_set(why, STATUS_FORMAT, "expected %.0f bytes of pixels, found %zu", wanted, size - at);
	const enum status status = image_alloc_for(image, width, height, why);
	if (status != STATUS_OK)
		return status;
	const size_t row = (size_t)image->width * channels * sizeof(float);
	for (int y = 0; y < image->height; y++)
		for (int x = 0; x < image->width; x++)
			for (size_t c = 0; c < 3; c++) {
				const size_t index = (size_t)x * channels + (channels == 3 ? c : 0);
				const unsigned char *from =
					bytes + at + row * (size_t)(image->height - 1 - y) + index * sizeof(float);
				image_at(image, x, y)[c] = float_at(from, scale < 0);
			}
	return STATUS_OK;
}

enum status image_write_pfm(const char *path, const struct image *image, struct error *error)
{
	struct atomic_file file;
	const enum status status = atomic_file_open(&file, path, error);
	if (status != STATUS_OK)
		return status;
	fprintf(file.stream, "PF\n%d %d\n-1.0\n", image->width, image->height);
	for (int y = image->height; y-- > 0;)
		for (int i = 0; i < 3 * image->width; i++) {
			uint32_t bits;
			memcpy(&bits, image_at(image, 0, y) + i, sizeof bits);
			bits = htole32(bits);
			fwrite(&bits, sizeof bits, 1, file.stream);
		}
	return atomic_file_commit(&file, error);
}
