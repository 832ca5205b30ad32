/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits a measurement in memory; shows the progress, and stops after so many evaluations as the argument says.
 * Build: cc fit_table.c $(pkg-config --cflags --libs stdfit) */
#include <stdfit/stdfit.h>
#include <stdio.h>
#include <stdlib.h>

static volatile int stop;

static void show(void *limit, const struct stdfit_step *step)
{
	fprintf(stderr, "%s: %ld evaluations, error %.4f\n", step->stage, step->evaluations, step->error);
	if (step->evaluations >= *(const long *)limit)
		__atomic_store_n(&stop, 1, __ATOMIC_RELAXED); /* other threads of the fit read it */
}

/* What a measurement would give: sigma 0.25, n 1.5. */
static enum stdfit_status measure(stdfit_measurement **measurement)
{
	struct stdfit_model truth = stdfit_model_default();
	stdfit_ndf *ggx;
	enum stdfit_status status = stdfit_ndf_new(&ggx, "ggx", 0.25, 0.25, 0, NULL, NULL);

	if (status != STDFIT_OK)
		return status;
	truth.kd[0] = 0.3;
	truth.kd[1] = 0.2;
	truth.kd[2] = 0.1;
	status = stdfit_measurement_from_model(measurement, &truth, ggx, NULL, 180, NULL);
	stdfit_ndf_free(ggx);
	return status;
}

int main(int argc, char **argv)
{
	long limit = argc > 1 ? strtol(argv[1], NULL, 10) : 1000000;
	struct stdfit_options options = stdfit_options_default();
	stdfit_measurement *measurement = NULL;
	stdfit_context *context = NULL;
	struct stdfit_result result;
	struct stdfit_error error = {""};

	options.ndfs = "ggx";
	options.trace = show;
	options.trace_data = &limit;
	options.cancel = &stop;
	enum stdfit_status status = measure(&measurement);

	if (status == STDFIT_OK)
		status = stdfit_context_new(&context, 180, &options, &error);
	if (status == STDFIT_OK)
		status = stdfit_fit(context, measurement, &options, 1, &result, &error);
	if (status == STDFIT_OK) {
		printf("sigma %.4f, n %.4f\n", result.sigma, result.model.n);
		stdfit_result_clear(&result);
	} else {
		printf("%s\n", error.text);
	}
	stdfit_measurement_free(measurement);
	stdfit_context_free(context);
	return status == STDFIT_OK ? 0 : 1;
}
