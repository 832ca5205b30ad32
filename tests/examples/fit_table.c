/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits a table in memory; shows the progress, and stops after so many evaluations as the argument says.
 * Build: cc fit_table.c $(pkg-config --cflags --libs stdfit) */
#include <stdfit/stdfit.h>
#include <stdio.h>
#include <stdlib.h>

static atomic_bool stop;

static void show(void *limit, const struct fit_trace *point)
{
	fprintf(stderr, "%s: %ld evaluations, error %.4f\n", point->stage, point->evaluations, point->error);
	stop = point->evaluations >= *(const long *)limit;
}

/* What a measurement would give: sigma 0.25, n 1.5. */
static void measure(struct measurement *table, struct cook_torrance *model)
{
	for (int at = 0; at < 90 * 90 * 180; at++) {
		struct vec3 wi, wo;
		double f[3];

		halfdiff_to_dirs(bins_angles(BINS_NODE, at / 180 / 90, at / 180 % 90, at % 180), &wi, &wo);
		cook_torrance_f(model, wi, wo, f);
		for (int c = 0; c < MERL_CHANNELS; c++)
			table->value[c][at] = (float)f[c];
	}
}

int main(int argc, char **argv)
{
	long limit = argc > 1 ? strtol(argv[1], NULL, 10) : 1000000;
	struct cook_torrance truth = {.fresnel = FRESNEL_DIELECTRIC, .n = 1.5, .kd = {0.3, 0.2, 0.1}, .ks = {1, 1, 1}};
	struct fit_options options = fit_options_default();
	struct fit_context *context;
	struct fit_result result;
	struct measurement table;

	options.ndf[0] = ndf_find("ggx");
	options.n_ndf = 1;
	options.trace = show;
	options.trace_data = &limit;
	options.cancel = &stop;
	if (ndf_init(&truth.ndf, options.ndf[0], 0.25, 0.25, 0) || measurement_alloc(&table, 180) ||
	    fit_context_new(&context, table.n_phi_d, &options))
		return 1;
	measure(&table, &truth);
	const enum status status = fit_run(context, &table, &options, &result, NULL);
	if (status == STATUS_OK)
		printf("sigma %.4f, n %.4f\n", result.model.ndf.sigma_x, result.model.n);
	else
		printf("%s\n", status_str(status));
	measurement_free(&table);
	fit_context_free(context);
	return status == STATUS_OK ? 0 : 1;
}
