/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Radiance pictures: a line "#?...", lines of header, an empty line, a line "-Y height +X width", then per row pixels of
 * three mantissas and a common exponent, flat, or run-length encoded in one of two ways. */
#include "fit/render/image_decode.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Pixels that a byte of a file can stand for, at most: see image_decode_hdr(). */
#define PIXELS_PER_BYTE 16.0

struct reader {
	const unsigned char *bytes;
	size_t size, at;
};

bool image_is_hdr(const unsigned char *bytes, size_t size)
{
	return size > 2 && bytes[0] == '#' && bytes[1] == '?';
}

/* The next line, terminated, cut to fit. False at the end of the file. */
static bool next_line(struct reader *r, char *line, size_t room)
{
	size_t length = 0;
	while (r->at < r->size && r->bytes[r->at] != '\n') {
		if (length + 1 < room && r->bytes[r->at] != '\r')
			line[length++] = (char)r->bytes[r->at];
		r->at++;
	}
	line[length] = '\0';
	return r->at < r->size && ++r->at;
}

/* Header and resolution. *exposure: what the pixels have been multiplied by. */
static enum status read_header(struct reader *r, long *width, long *height, double *exposure, struct error *why)
{
	char line[128];
	bool rgbe = false, ended = false;
	*exposure = 1;
	while (!ended && next_line(r, line, sizeof line)) {
		ended = !*line;
		if (!strncmp(line, "FORMAT=", 7)) {
			rgbe = !strcmp(line + 7, "32-bit_rle_rgbe");
			if (!rgbe)
				return error_set(why, STATUS_FORMAT,
						 "expected FORMAT=32-bit_rle_rgbe, found another format");
		} else if (!strncmp(line, "EXPOSURE=", 9)) {
			*exposure *= strtod(line + 9, NULL);
		}
	}
	if (!ended || !rgbe)
		return error_set(why, STATUS_FORMAT, "expected a header with FORMAT=32-bit_rle_rgbe and an empty line");
	if (!(*exposure > 0) || isinf(*exposure))
		return error_set(why, STATUS_FORMAT, "expected an EXPOSURE above 0");
	if (!next_line(r, line, sizeof line) || sscanf(line, "-Y %9ld +X %9ld", height, width) != 2)
		return error_set(why, STATUS_FORMAT, "expected a line '-Y height +X width' behind the header");
	return STATUS_OK;
}

static bool take(struct reader *r, unsigned char *to, size_t n)
{
	if (r->size - r->at < n)
		return false;
	memcpy(to, r->bytes + r->at, n);
	r->at += n;
	return true;
}

/* A row whose four components are encoded one after the other: runs (above 128) and literal parts. */
static bool read_planes(struct reader *r, unsigned char (*pixel)[4], int width)
{
	for (int c = 0; c < 4; c++)
		for (int x = 0; x < width;) {
			unsigned char count, value = 0;
			if (!take(r, &count, 1) || !count)
				return false;
			const bool run = count > 128;
			const int n = run ? count - 128 : count;
			if (n > width - x || (run && !take(r, &value, 1)))
				return false;
			for (int i = 0; i < n; i++, x++) {
				if (!run && !take(r, &value, 1))
					return false;
				pixel[x][c] = value;
			}
		}
	return true;
}

/* A row of pixels; one of mantissas 1, 1, 1 repeats the one before it, several such in a row make a larger number. */
static bool read_pixels(struct reader *r, unsigned char (*pixel)[4], int width)
{
	int shift = 0;
	for (int x = 0; x < width;) {
		unsigned char p[4];
		if (!take(r, p, 4))
			return false;
		if (p[0] != 1 || p[1] != 1 || p[2] != 1) {
			memcpy(pixel[x++], p, 4);
			shift = 0;
			continue;
		}
		const long n = shift < 24 ? (long)p[3] << shift : width + 1L;
		if (x == 0 || n > width - x)
			return false;
		for (long i = 0; i < n; i++, x++)
			memcpy(pixel[x], pixel[x - 1], 4);
		shift += 8;
	}
	return true;
}

static bool read_row(struct reader *r, unsigned char (*pixel)[4], int width)
{
	const unsigned char *p = r->bytes + r->at;
	if (width >= 8 && width <= 0x7fff && r->size - r->at >= 4 && p[0] == 2 && p[1] == 2 && p[2] < 128) {
		if ((p[2] << 8 | p[3]) != width)
			return false;
		r->at += 4;
		return read_planes(r, pixel, width);
	}
	return read_pixels(r, pixel, width);
}

/* The middle of the step that a mantissa stands for, as Radiance itself reads it. */
static void decode_pixel(const unsigned char p[4], double exposure, float rgb[3])
{
	const double unit = p[3] ? ldexp(1, p[3] - (128 + 8)) / exposure : 0;
	for (int c = 0; c < 3; c++)
		rgb[c] = (float)((p[c] + 0.5) * unit);
}

enum status image_decode_hdr(const unsigned char *bytes, size_t size, struct image *image, struct error *why)
{
	struct reader r = {bytes, size, 0};
	long width = 0, height = 0;
	double exposure = 0;
	*image = (struct image){0};
	enum status status = read_header(&r, &width, &height, &exposure, why);
	if (status == STATUS_OK)
		status = image_alloc_for(image, (double)width, (double)height, why);
	/* Four planes of runs of 127 pixels, two bytes each, are as dense as any writer of today packs them. A header that claims
	 * more would cost gigabytes. */
	if (status == STATUS_OK && (double)width * (double)height > PIXELS_PER_BYTE * (double)(size - r.at))
		status = error_set(why, STATUS_FORMAT, "the header says %ld x %ld pixels, more than %zu bytes can hold",
				   width, height, size - r.at);
	if (status != STATUS_OK) {
		image_free(image);
		return status;
	}
	unsigned char(*pixel)[4] = malloc((size_t)image->width * sizeof *pixel);
	if (!pixel)
		status = error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	for (int y = 0; y < image->height && status == STATUS_OK; y++) {
		if (!read_row(&r, pixel, image->width))
			status = error_set(why, STATUS_FORMAT, "row %d of %d is broken or cut short", y + 1,
					   image->height);
		for (int x = 0; x < image->width && status == STATUS_OK; x++)
			decode_pixel(pixel[x], exposure, image_at(image, x, y));
	}
	free(pixel);
	if (status != STATUS_OK)
		image_free(image);
	return status;
}
