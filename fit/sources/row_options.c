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

static void put_one(FILE *file, const char *name, const char *value)
{
	if (*value)
		fprintf(file, " --%s %s", name, value);
}

static void put_roughness(FILE *file, char *const *row)
{
	if (!*row[RESULT_SIGMA_X]) {
		put_one(file, "sigma", row[RESULT_SIGMA]);
		return;
	}
	fprintf(file, " --sigma %s,%s", row[RESULT_SIGMA_X], row[RESULT_SIGMA_Y]);
	put_one(file, "angle", row[RESULT_ANGLE]);
}

/* What a model has of more terms than two. */
static void put_terms(FILE *file, char *const *row)
{
	put_factors(file, "f0", &row[RESULT_F0_R]);
	put_factors(file, "f82", &row[RESULT_F82_R]);
	put_factors(file, "f90", &row[RESULT_F90_R]);
	put_factors(file, "kg", &row[RESULT_KG_R]);
	if (*row[RESULT_KG_R])
		put_one(file, "exponent", row[RESULT_EXPONENT]);
	if (!*row[RESULT_SIGMA2])
		return;
	put_factors(file, "ks2", &row[RESULT_KS2_R]);
	put_one(file, "sigma2", row[RESULT_SIGMA2]);
	if (ndf_has_gamma(ndf_find(row[RESULT_NDF])))
		put_one(file, "gamma2", row[RESULT_GAMMA2]);
}

/* Whose sigma and gamma in the row are those of the options. */
static bool is_described(char *const *row)
{
	static const char *const ndf[] = {"std", "ggx", "beckmann"};
	bool known = false;
	for (size_t i = 0; i < sizeof ndf / sizeof *ndf; i++)
		known |= !strcmp(row[RESULT_NDF], ndf[i]);
	return known && !result_failed(row) && *row[RESULT_KS_R];
}

char *row_options(char *const *row)
{
	struct text_stream stream;
	double k;
	if (!is_described(row) || !text_stream_open(&stream))
		return NULL;
	fprintf(stream.file, "--ndf %s --gaf %s --fresnel %s", row[RESULT_NDF], row[RESULT_GAF], row[RESULT_FRESNEL]);
	put_roughness(stream.file, row);
	if (strcmp(row[RESULT_LAMBDA], lambda_form_name(LAMBDA_EXACT)) != 0)
		fprintf(stream.file, " --lambda %s", row[RESULT_LAMBDA]);
	if (ndf_has_gamma(ndf_find(row[RESULT_NDF])))
		put_one(stream.file, "gamma", row[RESULT_GAMMA]);
	put_one(stream.file, "ior", row[RESULT_IOR]);
	if (result_param(row[RESULT_PARAMS], "k", &k))
		fprintf(stream.file, " --k %.17g", k);
	put_factors(stream.file, "kd", &row[RESULT_KD_R]);
	put_factors(stream.file, "ks", &row[RESULT_KS_R]);
	put_terms(stream.file, row);
	return text_stream_close(&stream);
}
