/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit - the whole library: the headers below are what it offers to other programs, and all that it installs and
 * exports. From C++ include this one. */
#ifndef STDFIT_H
#define STDFIT_H

#ifdef __cplusplus
#include <atomic>
#include <cmath>
extern "C" {
#endif

/* src: mathematics */
#include "src/cook_torrance.h"
#include "src/ellipsoid.h"
#include "src/energy.h"
#include "src/fresnel.h"
#include "src/halfdiff.h"
#include "src/lambda_form.h"
#include "src/ndf.h"
#include "src/ndf_slopes.h"
#include "src/pwl.h"
#include "src/smith.h"
#include "src/status.h"
#include "src/vec3.h"
#include "src/vndf.h"
/* data_readers: measured data */
#include "data_readers/measurement.h"
#include "data_readers/merl.h"
/* fit */
#include "fit/search/fit.h"

#ifdef __cplusplus
}
#endif

#endif
