/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scattered_albedo - the directional albedo of scattered entries. Private to suspects.c. */
#ifndef SCATTERED_ALBEDO_H
#define SCATTERED_ALBEDO_H

#include "fit/error/suspects.h"

/* scattered_albedo - sets albedo, measured and ends_at of *suspects, for these theta_i. Where nothing was measured near a pair of
 * directions, it adds nothing. STATUS_NO_MEMORY. */
MUST_CHECK enum status scattered_albedo(const struct measurement *measurement, const double theta_i[SUSPECTS_ALBEDOS],
					struct suspects *suspects);

#endif
