/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/environment.h"
#include "fit/render/colour.h"
#include <math.h>
#include <stdlib.h>

/* So that nothing overflows a float, made 2^20 times as bright. */
#define RADIANCE_MAX 1e30

/* A point on a map, in texels from its upper left corner. */
struct point {
	double x, y;
};

static struct point point_of(const struct image *map, struct vec3 to)
{
	const double u = 0.5 + atan2(to.x, -to.z) / (2 * M_PI);
	const double v = acos(fmax(-1, fmin(to.y, 1))) / M_PI;
	return (struct point){u * map->width, v * map->height};
}

static struct vec3 direction_at(double cos_up, double longitude)
{
	const double sine = sqrt(fmax(0, (1 - cos_up) * (1 + cos_up)));
	return (struct vec3){sine * sin(longitude), cos_up, -sine * cos(longitude)};
}

/* Solid angle of a texel in row y. */
static double texel_measure(const struct image *map, int y)
{
	return 2 * M_PI / map->width * 2 * sin(M_PI * (y + 0.5) / map->height) * sin(M_PI * 0.5 / map->height);
}

/* Row or column beside the edge: rows end at the poles, columns go round. */
static const float *texel(const struct image *map, int x, int y)
{
	const int row = y < 0 ? 0 : y < map->height ? y : map->height - 1;
	return image_at(map, (x + map->width) % map->width, row);
}

static void interpolate(const struct image *map, struct point at, double rgb[3])
{
	const int x = (int)floor(at.x - 0.5), y = (int)floor(at.y - 0.5);
	const double right = at.x - 0.5 - x, down = at.y - 0.5 - y;
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int i = 0; i < 4; i++) {
		const double weight = (i & 1 ? right : 1 - right) * (i & 2 ? down : 1 - down);
		const float *value = texel(map, x + (i & 1), y + (i >> 1));
		for (int c = 0; c < 3; c++)
			rgb[c] += weight * (double)value[c];
	}
}

static double luminance(const float *rgb)
{
	return colour_luminance((const double[]){(double)rgb[0], (double)rgb[1], (double)rgb[2]});
}

/* Mean over a texel of the luminance that is interpolated in it. */
static double texel_luminance(const struct image *map, int x, int y)
{
	static const double share[] = {0.125, 0.75, 0.125};
	double sum = 0;
	for (int dy = -1; dy <= 1; dy++)
		for (int dx = -1; dx <= 1; dx++)
			sum += share[dx + 1] * share[dy + 1] * luminance(texel(map, x + dx, y + dy));
	return sum;
}

/* Turns the sums cdf[0 .. n] into shares of the last, which becomes exactly 1; where that is 0, into even ones. */
static void normalise(double *cdf, int n)
{
	const double total = cdf[n];
	for (int i = 0; i <= n; i++)
		cdf[i] = total > 0 ? cdf[i] / total : (double)i / n;
	cdf[n] = 1;
}

/* Returns whether there is any light. */
static bool fill_cdfs(struct environment *e)
{
	const struct image *map = &e->map;
	e->row_cdf[0] = 0;
	for (int y = 0; y < map->height; y++) {
		double *cdf = e->cell_cdf + (size_t)y * (size_t)(map->width + 1);
		cdf[0] = 0;
		for (int x = 0; x < map->width; x++)
			cdf[x + 1] = cdf[x] + texel_luminance(map, x, y);
		e->row_cdf[y + 1] = e->row_cdf[y] + cdf[map->width] * texel_measure(map, y);
		normalise(cdf, map->width);
	}
	const double total = e->row_cdf[map->height];
	normalise(e->row_cdf, map->height);
	return total > 0 && isfinite(total);
}

static enum status check_map(const struct image *map, struct error *why)
{
	if (map->width != 2 * map->height)
		return error_set(why, STATUS_FORMAT,
				 "expected a map of latitude and longitude, twice as wide as high, found %d x %d",
				 map->width, map->height);
	for (int y = 0; y < map->height; y++)
		for (int x = 0; x < map->width; x++)
			for (int c = 0; c < 3; c++) {
				const double value = (double)image_at(map, x, y)[c];
				if (!(value >= 0 && value <= RADIANCE_MAX))
					return error_set(why, STATUS_FORMAT,
							 "expected radiances from 0 to %g, found %g in column %d of "
							 "row %d",
							 RADIANCE_MAX, value, x + 1, y + 1);
			}
	return STATUS_OK;
}

enum status environment_from_map(struct environment *e, struct image *map, struct error *why)
{
	enum status status = check_map(map, why);
	if (status != STATUS_OK)
		return status;
	const size_t rows = (size_t)map->height, columns = (size_t)map->width;
	struct environment made = {.map = *map,
				   .row_cdf = malloc((rows + 1) * sizeof(double)),
				   .cell_cdf = malloc(rows * (columns + 1) * sizeof(double))};
	if (!made.row_cdf || !made.cell_cdf)
		status = error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	else if (!fill_cdfs(&made))
		status = error_set(why, STATUS_FORMAT, "expected some light, found none");
	if (status != STATUS_OK) {
		free(made.row_cdf);
		free(made.cell_cdf);
		return status;
	}
	*map = (struct image){0};
	*e = made;
	return STATUS_OK;
}

void environment_from_lights(struct environment *e, const struct light *light, int n)
{
	*e = (struct environment){.n_lights = n};
	for (int i = 0; i < n; i++)
		e->light[i] = light[i];
}

void environment_free(struct environment *e)
{
	image_free(&e->map);
	free(e->row_cdf);
	free(e->cell_cdf);
	*e = (struct environment){0};
}

void environment_scale(struct environment *e, double factor)
{
	const size_t n = 3 * (size_t)e->map.width * (size_t)e->map.height;
	for (size_t i = 0; i < n; i++)
		e->map.rgb[i] = (float)(factor * (double)e->map.rgb[i]);
	for (int i = 0; i < e->n_lights; i++)
		for (int c = 0; c < 3; c++)
			e->light[i].irradiance[c] *= factor;
}

/* The cell of u in cdf[0 .. n], which is not empty, and how far into it u lies, [0, 1). */
static int find_cell(const double *cdf, int n, double u, double *within)
{
	int low = 0, high = n;
	while (high - low > 1) {
		const int middle = (low + high) / 2;
		if (cdf[middle] <= u)
			low = middle;
		else
			high = middle;
	}
	*within = (u - cdf[low]) / (cdf[high] - cdf[low]);
	return low;
}

static int clamp_index(double at, int n)
{
	return at < n ? (int)at : n - 1;
}

struct arriving environment_at(const struct environment *e, struct vec3 to)
{
	const struct point at = point_of(&e->map, to);
	const int x = clamp_index(at.x, e->map.width), y = clamp_index(at.y, e->map.height);
	const double *cdf = e->cell_cdf + (size_t)y * (size_t)(e->map.width + 1);
	struct arriving light = {.pdf = (e->row_cdf[y + 1] - e->row_cdf[y]) * (cdf[x + 1] - cdf[x]) /
					texel_measure(&e->map, y)};
	interpolate(&e->map, at, light.rgb);
	return light;
}

struct vec3 environment_sample(const struct environment *e, double u1, double u2)
{
	const struct image *map = &e->map;
	double down, right;
	const int y = find_cell(e->row_cdf, map->height, u1, &down);
	const int x = find_cell(e->cell_cdf + (size_t)y * (size_t)(map->width + 1), map->width, u2, &right);
	const double top = cos(M_PI * y / map->height), bottom = cos(M_PI * (y + 1) / map->height);
	return direction_at(top + down * (bottom - top), 2 * M_PI * ((x + right) / map->width - 0.5));
}
