/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/row_options.h"
#include "fit/cli/text_stream.h"
#include "fit/results/result.h"

#include <string.h>

static void put_factors(FILE *file, const char *name, char *const *factor)
{
	if (*factor[0])
		fprintf(file, " --%s %s,%s,%s", name, factor[0], factor[1], factor[2]);
}

/* Whose sigma and gamma in the row are those of the options. */
static bool is_described(char *const *row)
{
	static const char *const ndf[] = {"std", "ggx", "beckmann"};
	bool known = false;
	for (size_t i = 0; i < sizeof ndf / sizeof *ndf; i++)
		known |= !strcmp(row[RESULT_NDF], ndf[i]);
	return known && !result_failed(row) && *row[RESULT_KS_R] && !*row[RESULT_SIGMA_X];
}

char *row_options(char *const *row)
{
	struct text_stream stream;
	double k;
	if (!is_described(row) || !text_stream_open(&stream))
		return NULL;
	fprintf(stream.file, "--ndf %s --gaf %s --fresnel %s --sigma %s", row[RESULT_NDF], row[RESULT_GAF],
		row[RESULT_FRESNEL], row[RESULT_SIGMA]);
	if (strcmp(row[RESULT_LAMBDA], lambda_form_name(LAMBDA_EXACT)) != 0)
		fprintf(stream.file, " --lambda %s", row[RESULT_LAMBDA]);
	if (ndf_has_gamma(ndf_find(row[RESULT_NDF])))
		fprintf(stream.file, " --gamma %s", row[RESULT_GAMMA]);
	if (*row[RESULT_IOR])
		fprintf(stream.file, " --ior %s", row[RESULT_IOR]);
	if (result_param(row[RESULT_PARAMS], "k", &k))
		fprintf(stream.file, " --k %.17g", k);
	put_factors(stream.file, "kd", &row[RESULT_KD_R]);
	put_factors(stream.file, "ks", &row[RESULT_KS_R]);
	return text_stream_close(&stream);
}
