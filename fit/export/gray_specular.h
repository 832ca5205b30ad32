/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gray_specular - one ks for the three channels, kd of each channel as good as it can be beside it. Private to
 * fit/export/. */
#ifndef GRAY_SPECULAR_H
#define GRAY_SPECULAR_H

#include "fit/search/fit.h"

/* gray_specular - sets each ks to their mean, and each kd to what minimises E under the options' weight, bins and
 * max_theta: the weighted median of pi (m - ks lobe), within [0, 1 - ks]. STATUS_NO_MEMORY leaves *model as it was. */
MUST_CHECK enum status gray_specular(const struct measurement *measurement, const struct fit_options *fit,
				     struct cook_torrance *model);

#endif
