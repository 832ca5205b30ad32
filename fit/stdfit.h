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
#include "cook_torrance.h"
#include "ellipsoid.h"
#include "energy.h"
#include "fresnel.h"
#include "halfdiff.h"
#include "lambda_form.h"
#include "ndf.h"
#include "ndf_slopes.h"
#include "pwl.h"
#include "smith.h"
#include "status.h"
#include "vec3.h"
#include "vndf.h"
/* data_readers: measured data */
#include "merl.h"
#include "samples.h"
/* fit */
#include "fit.h"

#ifdef __cplusplus
}
#endif

#endif
