/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/version.h"
#include <gsl/gsl_version.h>
#include <nlopt.h>
#include <stdio.h>
#include <xxhash.h>

void version_print(void)
{
	int major, minor, bugfix;
	nlopt_version(&major, &minor, &bugfix);
	const unsigned xxh = XXH_versionNumber();
	printf("stdfit %s (%s %s; nlopt %d.%d.%d, GSL %s, xxhash %u.%u.%u)\n", STDFIT_VERSION,
#ifdef __clang__
	       "clang", __clang_version__,
#else
	       "gcc", __VERSION__,
#endif
	       major, minor, bugfix, gsl_version, xxh / 10000, xxh / 100 % 100, xxh % 100);
}
