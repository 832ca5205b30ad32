/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/ssim.h"
#include <math.h>

enum { RADIUS = 5 };

struct moments {
	double w, x, y, xx, yy, xy;
};

static void add_pixel(struct moments *m, double w, double x, double y)
{
	m->w += w;
	m->x += w * x;
	m->y += w * y;
	m->xx += w * x * x;
	m->yy += w * y * y;
	m->xy += w * x * y;
}

static double ssim_of(const struct moments *m)
{
	const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
	const double x = m->x / m->w, y = m->y / m->w;
	const double sxx = m->xx / m->w - x * x, syy = m->yy / m->w - y * y, sxy = m->xy / m->w - x * y;
	return (2.0 * x * y + c1) * (2.0 * sxy + c2) / ((x * x + y * y + c1) * (sxx + syy + c2));
}

double ssim(const double *x, const double *y, const bool *inside, int width, int height)
{
	double weight[RADIUS + 1], sum = 0.0;
	size_t n = 0;
	for (int d = 0; d <= RADIUS; d++)
		weight[d] = exp(-d * d / (2.0 * 1.5 * 1.5));
	for (int row = 0; row < height; row++)
		for (int column = 0; column < width; column++) {
			struct moments m = {0};
			if (!inside[row * width + column])
				continue;
			for (int dy = -RADIUS; dy <= RADIUS; dy++)
				for (int dx = -RADIUS; dx <= RADIUS; dx++) {
					const int r = row + dy, c = column + dx;
					if (r < 0 || r >= height || c < 0 || c >= width)
						continue;
					const double w = weight[dx < 0 ? -dx : dx] * weight[dy < 0 ? -dy : dy];
					add_pixel(&m, w, x[r * width + c], y[r * width + c]);
				}
			sum += ssim_of(&m);
			n++;
		}
	return n ? sum / (double)n : (double)NAN;
}
