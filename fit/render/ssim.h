/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ssim - structural similarity of two pictures [Wang, Bovik, Sheikh and Simoncelli 2004]. */
#ifndef SSIM_H
#define SSIM_H

#include <stdbool.h>
#include <stddef.h>

/* ssim - the mean over the pixels where `inside` is true of
 *     (2 mx my + C1) (2 sxy + C2) / ((mx^2 + my^2 + C1) (sx^2 + sy^2 + C2))
 * with means, variances and covariance in a window of 11 x 11 pixels around each, weighted by a Gaussian of 1.5 pixels,
 * C1 = 0.01^2, C2 = 0.03^2, for values of which 1 is the largest. At the picture's edges the window is cut and its
 * weights are made to add up to 1 again.
 * Given:   x, y, inside: width * height values, row by row
 * Returns: at most 1, exactly 1 for equal pictures; NaN where no pixel is inside. */
double ssim(const double *x, const double *y, const bool *inside, int width, int height);

#endif
