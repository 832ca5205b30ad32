/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/sheet.h"
#include "fit/render/colour.h"
#include "fit/render/font.h"
#include <math.h>
#include <stdio.h>

static const float ink[3] = {0.62F, 0.62F, 0.62F};

static int gap(const struct sheet *sheet)
{
	return 4 * sheet->scale;
}

/* A label and the space around it. */
static int label_height(const struct sheet *sheet)
{
	return (FONT_HEIGHT + 4) * sheet->scale;
}

static int row_height(const struct sheet *sheet)
{
	return label_height(sheet) + sheet->size + (sheet->differences ? sheet->size + gap(sheet) : 0) + gap(sheet);
}

enum status sheet_init(struct sheet *sheet, int size, int columns, int rows, bool differences)
{
	*sheet = (struct sheet){.size = size,
				.scale = size < 192 ? 1 : size / 128,
				.columns = columns,
				.rows = rows,
				.differences = differences};
	const long width = gap(sheet) + (long)columns * (size + gap(sheet)),
		   height = label_height(sheet) + (long)rows * row_height(sheet);
	if (width > IMAGE_SIZE_MAX || height > IMAGE_SIZE_MAX)
		return STATUS_DOMAIN;
	const enum status status = image_alloc(&sheet->image, (int)width, (int)height);
	if (status != STATUS_OK)
		return status;
	const float paper[3] = {0.012F, 0.012F, 0.0135F};
	for (size_t i = 0; i < 3 * (size_t)width * (size_t)height; i++)
		sheet->image.rgb[i] = paper[i % 3];
	return STATUS_OK;
}

void sheet_free(struct sheet *sheet)
{
	image_free(&sheet->image);
}

void sheet_end(struct sheet *sheet, int n)
{
	if (n >= sheet->rows)
		return;
	sheet->rows = n;
	sheet->image.height = label_height(sheet) + n * row_height(sheet);
}

/* Characters that a label or title has room for. */
static int label_length(const struct sheet *sheet)
{
	return sheet->size / (FONT_ADVANCE * sheet->scale);
}

void sheet_error_label(const struct sheet *sheet, const struct picture_error *error, char *label, size_t size)
{
	const int length = snprintf(label, size, "dE %.2f SSIM %.3f", error->delta_e, error->ssim);
	if (length > label_length(sheet))
		snprintf(label, size, "dE %.2f", error->delta_e);
}

/* The upper left corner of a cell's label; a sphere and a difference are below it. */
static int cell_x(const struct sheet *sheet, int column)
{
	return gap(sheet) + column * (sheet->size + gap(sheet));
}

static int sphere_y(const struct sheet *sheet, int row)
{
	return 2 * label_height(sheet) + row * row_height(sheet);
}

static int difference_y(const struct sheet *sheet, int row)
{
	return sphere_y(sheet, row) + sheet->size + gap(sheet);
}

/* Lays a colour over a pixel. At the rim it is clipped first: light as bright as a lamp would leave steps there. */
static void blend(float *pixel, const float rgb[3], float coverage)
{
	for (int c = 0; c < 3; c++) {
		const float top = coverage < 1 ? fminf(rgb[c], 1) : rgb[c];
		pixel[c] += coverage * (top - pixel[c]);
	}
}

static void draw_label(struct sheet *sheet, int column, int bottom, const char *label)
{
	font_draw(&sheet->image, cell_x(sheet, column), bottom - (FONT_HEIGHT + 1) * sheet->scale, sheet->scale,
		  sheet->size, label, ink);
}

void sheet_title(struct sheet *sheet, int column, const char *title)
{
	draw_label(sheet, column, label_height(sheet), title);
}

void sheet_sphere(struct sheet *sheet, int column, int row, const struct sphere *sphere, const char *label)
{
	const int left = cell_x(sheet, column), top = sphere_y(sheet, row);
	for (int y = 0; y < sheet->size; y++)
		for (int x = 0; x < sheet->size; x++)
			blend(image_at(&sheet->image, left + x, top + y), image_at(&sphere->light, x, y),
			      sphere->coverage[x + sheet->size * y]);
	draw_label(sheet, column, top, label);
}

static void false_colour_at(float *pixel, double delta_e, float coverage)
{
	double rgb[3];
	false_colour(delta_e / SHEET_DELTA_E, rgb);
	blend(pixel, (const float[]){(float)rgb[0], (float)rgb[1], (float)rgb[2]}, coverage);
}

void sheet_difference(struct sheet *sheet, int column, int row, const struct sphere *sphere, const struct sphere *from)
{
	const int left = cell_x(sheet, column), top = difference_y(sheet, row);
	for (int y = 0; y < sheet->size; y++)
		for (int x = 0; x < sheet->size; x++)
			false_colour_at(image_at(&sheet->image, left + x, top + y),
					picture_delta_e(image_at(&sphere->light, x, y), image_at(&from->light, x, y)),
					sphere->coverage[x + sheet->size * y]);
}

/* A bar from the largest difference down to 0, with numbers beside it. */
void sheet_legend(struct sheet *sheet, int row)
{
	enum { TICKS = 5 };
	if (sheet->size < SHEET_LEGEND_SIZE)
		return;
	const int scale = sheet->scale, line = FONT_HEIGHT * scale;
	const int left = cell_x(sheet, 0) + sheet->size / 3, width = sheet->size / 10;
	const int top = difference_y(sheet, row) + sheet->size / 8 + 3 * line / 2, height = sheet->size * 5 / 8;
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			false_colour_at(image_at(&sheet->image, left + x, top + y),
					SHEET_DELTA_E * (1 - (y + 0.5) / height), 1);
	for (int i = 0; i <= TICKS; i++) {
		char text[16];
		const int y = top + (int)lrint(height * (1 - (double)i / TICKS));
		snprintf(text, sizeof text, i < TICKS ? "%g" : "%g+", SHEET_DELTA_E * i / TICKS);
		font_draw(&sheet->image, left + width + 4 * scale, y - line / 2, scale, sheet->size / 2, text, ink);
	}
	font_draw(&sheet->image, left - 4 * FONT_ADVANCE * scale / 2, top - 5 * line / 2, scale, sheet->size,
		  "delta E 2000", ink);
}
