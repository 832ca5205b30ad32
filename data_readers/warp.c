/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/warp.h"
#include <math.h>
#include <stdlib.h>

/* Where a value stands between the nodes of an axis. */
struct between {
	size_t low; /* and low + 1, unless fraction is 0 */
	double fraction;
};

static struct between on_axis(const struct warp_axis *axis, double value)
{
	size_t low = 0, high = axis->n - 1;

	if (high == 0 || !(value > (double)axis->value[0]))
		return (struct between){0, 0};
	if (value >= (double)axis->value[high])
		return (struct between){high, 0};
	while (high - low > 1) {
		const size_t middle = (low + high) / 2;

		if ((double)axis->value[middle] <= value)
			low = middle;
		else
			high = middle;
	}
	const double a = (double)axis->value[low], b = (double)axis->value[high];

	return (struct between){low, (value - a) / (b - a)};
}

/* The slices that a value of the parameters lies between. */
struct blend {
	int n;
	size_t slice[1 << WARP_PARAMS];
	double weight[1 << WARP_PARAMS];
};

static struct blend blend_of(const struct grid *grid, const double param[WARP_PARAMS])
{
	const struct between first = on_axis(&grid->param[0], param[0]), second = on_axis(&grid->param[1], param[1]);
	struct blend blend = {.n = 0};

	for (size_t a = 0; a < 2; a++)
		for (size_t b = 0; b < 2; b++) {
			const double weight =
				(a ? first.fraction : 1 - first.fraction) * (b ? second.fraction : 1 - second.fraction);

			if (weight == 0)
				continue;
			blend.slice[blend.n] = (first.low + a) * grid->param[1].n + second.low + b;
			blend.weight[blend.n++] = weight;
		}
	return blend;
}

static double blended(const struct blend *blend, const float *value, size_t stride, size_t at)
{
	double sum = 0;

	for (int n = 0; n < blend->n; n++)
		sum += blend->weight[n] * (double)value[blend->slice[n] * stride + at];
	return sum;
}

/* The cell of n nodes over [0, 1] that t is in, and where in it. */
static struct between in_cell(size_t n, double t)
{
	const double at = fmin(fmax(t, 0), 1) * (double)(n - 1);
	const size_t cell = at < (double)(n - 1) ? (size_t)at : n - 2;

	return (struct between){cell, at - (double)cell};
}

static double mix(double a, double b, double t)
{
	return (1 - t) * a + t * b;
}

/* The value at column `column` of nodes, on the line at y. */
static double on_line(const struct blend *blend, const float *value, size_t stride, size_t width, struct between y,
		      size_t column)
{
	const double low = blended(blend, value, stride, y.low * width + column);

	return y.fraction == 0 ? low
			       : mix(low, blended(blend, value, stride, (y.low + 1) * width + column), y.fraction);
}

double grid_at(const struct grid *grid, struct square_point p, const double param[WARP_PARAMS])
{
	const struct blend blend = blend_of(grid, param);
	const struct between x = in_cell(grid->width, p.x), y = in_cell(grid->height, p.y);

	return mix(on_line(&blend, grid->value, grid->stride, grid->width, y, x.low),
		   on_line(&blend, grid->value, grid->stride, grid->width, y, x.low + 1), x.fraction);
}

/* The integral of a linear function from 0 to t in [0, 1], a at 0 and b at 1; and its inverse: the t of an area. */
static double area_to(double a, double b, double t)
{
	return t * (a + 0.5 * t * (b - a));
}

static double area_inverse(double a, double b, double area)
{
	const double root = sqrt(fmax(0, a * a + 2 * (b - a) * area));
	const double t = area > 0 ? 2 * area / (a + root) : 0; /* without the cancellation of (root - a)/(b - a) */

	return fmin(fmax(t, 0), 1);
}

static enum status sum_slice(struct warp *warp, size_t slice, struct error *why)
{
	const struct grid *grid = &warp->density;
	const size_t width = grid->width, height = grid->height, size = width * height;
	const float *value = grid->value + slice * grid->stride;
	float *row = warp->row + slice * size, *column = warp->column + slice * height;
	double total = 0, before = 0;

	for (size_t y = 0; y < height; y++) {
		double sum = 0;

		for (size_t x = 0; x < width; x++) {
			const double here = (double)value[y * width + x];

			if (here < 0)
				return error_set(why, STATUS_FORMAT, "a density is negative");
			if (x > 0)
				sum += 0.5 * ((double)value[y * width + x - 1] + here);
			row[y * width + x] = (float)sum;
		}
		total += y > 0 ? 0.5 * (before + sum) : 0;
		before = sum;
		column[y] = (float)total;
	}
	if (!(total > 0 && isfinite(total)))
		return error_set(why, STATUS_FORMAT, "a density is zero everywhere");
	warp->scale[slice] = (float)(1 / total);
	for (size_t at = 0; at < size; at++)
		row[at] = (float)((double)row[at] / total);
	for (size_t y = 0; y < height; y++)
		column[y] = (float)((double)column[y] / total);
	return STATUS_OK;
}

enum status warp_init(struct warp *warp, const struct grid *density, struct error *why)
{
	const size_t slices = density->param[0].n * density->param[1].n;
	const size_t size = density->width * density->height;
	enum status status = STATUS_OK;

	*warp = (struct warp){.density = *density};
	warp->row = malloc(slices * size * sizeof *warp->row);
	warp->column = malloc(slices * density->height * sizeof *warp->column);
	warp->scale = malloc(slices * sizeof *warp->scale);
	if (!warp->row || !warp->column || !warp->scale)
		status = error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	for (size_t slice = 0; slice < slices && status == STATUS_OK; slice++)
		status = sum_slice(warp, slice, why);
	if (status != STATUS_OK)
		warp_free(warp);
	return status;
}

void warp_free(struct warp *warp)
{
	free(warp->row);
	free(warp->column);
	free(warp->scale);
	*warp = (struct warp){.row = NULL};
}

/* Each slice counts by its own total: densities are blended after they have been normalised. */
static struct blend normalised(const struct warp *warp, const struct blend *blend)
{
	struct blend scaled = *blend;

	for (int n = 0; n < blend->n; n++)
		scaled.weight[n] *= (double)warp->scale[blend->slice[n]];
	return scaled;
}

struct square_point warp_invert(const struct warp *warp, struct square_point p, const double param[WARP_PARAMS])
{
	const struct grid *grid = &warp->density;
	const size_t width = grid->width, size = width * grid->height;
	const struct blend blend = blend_of(grid, param), density = normalised(warp, &blend);
	const struct between x = in_cell(width, p.x), y = in_cell(grid->height, p.y);
	const double left = on_line(&density, grid->value, grid->stride, width, y, x.low);
	const double right = on_line(&density, grid->value, grid->stride, width, y, x.low + 1);
	const double low = blended(&blend, warp->row, size, y.low * width + width - 1);
	const double high = blended(&blend, warp->row, size, (y.low + 1) * width + width - 1);
	const double line = mix(low, high, y.fraction);
	const double along = on_line(&blend, warp->row, size, width, y, x.low) + area_to(left, right, x.fraction);

	return (struct square_point){line > 0 ? along / line : 0, blended(&blend, warp->column, grid->height, y.low) +
									  area_to(low, high, y.fraction)};
}

/* struct rising - a rising function of a column (or a row) of nodes. */
struct rising {
	const struct blend *blend;
	const float *value;
	size_t stride, width;
	bool rows; /* of row ends; else of the nodes along the line y */
	struct between y;
};

static double rising_at(const struct rising *f, size_t node)
{
	return f->rows ? blended(f->blend, f->value, f->stride, node)
		       : on_line(f->blend, f->value, f->stride, f->width, f->y, node);
}

/* The last node but one whose value is at most `value`. */
static size_t find_cell(const struct rising *f, size_t n, double value)
{
	size_t low = 0, high = n - 1;

	while (high - low > 1) {
		const size_t middle = (low + high) / 2;

		if (rising_at(f, middle) <= value)
			low = middle;
		else
			high = middle;
	}
	return low;
}

struct square_point warp_sample(const struct warp *warp, struct square_point u, const double param[WARP_PARAMS],
				double *pdf)
{
	const struct grid *grid = &warp->density;
	const size_t width = grid->width, height = grid->height, size = width * height;
	const struct blend blend = blend_of(grid, param), density = normalised(warp, &blend);
	struct rising f = {&blend, warp->column, height, width, true, {0, 0}};
	struct between x, y;

	y.low = find_cell(&f, height, u.y);
	const double low = blended(&blend, warp->row, size, y.low * width + width - 1);
	const double high = blended(&blend, warp->row, size, (y.low + 1) * width + width - 1);
	y.fraction = area_inverse(low, high, u.y - rising_at(&f, y.low));

	const double along = u.x * mix(low, high, y.fraction);
	f = (struct rising){&blend, warp->row, size, width, false, y};
	x.low = find_cell(&f, width, along);
	const double left = on_line(&density, grid->value, grid->stride, width, y, x.low);
	const double right = on_line(&density, grid->value, grid->stride, width, y, x.low + 1);
	x.fraction = area_inverse(left, right, along - rising_at(&f, x.low));

	const double cells_x = (double)(width - 1), cells_y = (double)(height - 1);
	*pdf = mix(left, right, x.fraction) * cells_x * cells_y;
	return (struct square_point){((double)x.low + x.fraction) / cells_x, ((double)y.low + y.fraction) / cells_y};
}
