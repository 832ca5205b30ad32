/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench - how near the error kernel comes to the memory it reads, and what a fit costs.
 * usage: bench [OUT.csv]. Everything is measured side by side in one run; medians, and ratios of medians. */
#include "fit/error/objective.h"
#include "fit/search/fit.h"
#include "fit/search/search.h"
#include "make_table.h"
#include <stdio.h>
#include <stdlib.h>

enum { REPEATS = 41, FITS = 5 };

static FILE *csv;

static void put(const char *what, const char *model, int threads, const char *quantity, double value)
{
	printf("%-34s %-9s %d thread%s  %-28s %10.4g\n", what, model, threads, threads > 1 ? "s" : " ", quantity,
	       value);
	if (csv)
		fprintf(csv, "%s,%s,%d,%s,%.6g\n", what, model, threads, quantity, value);
}

static int by_value(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static double median(double *values, int n)
{
	qsort(values, (size_t)n, sizeof *values, by_value);
	return values[n / 2];
}

/* A plain sum over `bytes` of floats, in four chains so that no addition waits for another: what reading costs. */
static float stream(const float *data, size_t bytes)
{
	const size_t n = bytes / sizeof *data / 4;
	float a = 0, b = 0, c = 0, d = 0;

#pragma omp simd reduction(+ : a, b, c, d)
	for (size_t i = 0; i < n; i++) {
		a += data[i];
		b += data[n + i];
		c += data[2 * n + i];
		d += data[3 * n + i];
	}
	return a + b + c + d;
}

static size_t value_bytes(const struct sample_set *t)
{
	return (size_t)(t->n_blocks + t->n_pair_blocks) * MERL_CHANNELS * KERNEL_BLOCK * sizeof(float);
}

/* Sums every byte that the model and a pass touch, block by block, in as many threads. */
static float stream_all(const struct sample_set *t, const float *s, bool geometry, int threads)
{
	const size_t slots = (size_t)t->n_blocks * KERNEL_BLOCK, step = KERNEL_BLOCK * 16;
	const size_t values = value_bytes(t) / sizeof(float), value_step = values / (slots / step + 1) + 1;
	float sum = 0;

#pragma omp parallel for num_threads(threads) schedule(static) reduction(+ : sum)
	for (size_t at = 0; at < slots; at += step) {
		const size_t n = slots - at < step ? slots - at : step, v = at / step * value_step;

		sum += stream(t->w + at, n * 4) + stream(s + at, n * 4);
		if (v < values)
			sum += stream(t->value + v, 4 * (values - v < value_step ? values - v : value_step));
		if (geometry)
			sum += stream((const float *)t->q_i + at, n * 4) + stream((const float *)t->q_o + at, n * 4) +
			       stream(t->geometric_factor + at, n * 4) + stream((const float *)t->row + at / 2, n * 2);
	}
	return sum;
}

/* One pass, with or without the model before it. */
static double pass_all(const struct objective *o, const struct kernel_g1 *g1, bool model, double tau, int threads)
{
	const struct sample_set *t = o->table;
	const struct kernel_evaluation evaluation = {{0.1, 0.4}, tau, 1e-3};
	double sum = 0;

#pragma omp parallel for num_threads(threads) schedule(static) reduction(+ : sum)
	for (int b = 0; b < t->n_blocks; b++) {
		const size_t at = (size_t)b * KERNEL_BLOCK;
		const struct kernel_samples slots = sample_set_block(t, b);
		const float *const term[] = {t->w + at, o->term[1] + at};
		struct kernel_sums sums;

		if (model)
			o->kernel->lobe(KERNEL_SEPARABLE, g1, o->row[1], &slots, o->term[1] + at);
		for (int c = 0; c < MERL_CHANNELS; c++) {
			o->kernel->pass(2, b < t->n_pair_blocks ? 2 : 1, sample_set_value(t, b, c), term, &evaluation,
					&sums);
			sum += sums.error;
		}
	}
	return sum;
}

/* Keeps results alive. */
static volatile double sink;

static void bench_kernel(const struct sample_set *table, const struct fit_options *options, const char *ndf,
			 int threads)
{
	const struct shape shape = {.sigma = 0.2, .gamma = 1.7, .ior = 1.5};
	double t_stream[REPEATS], t_pass[REPEATS], t_curved[REPEATS], t_stream_geo[REPEATS], t_model[REPEATS];
	struct objective o;

	if (objective_init(&o, table, options, ndf_find(ndf), 1, MASKING_COARSE) != STATUS_OK ||
	    objective_lobe(&o, &shape) != STATUS_OK)
		return;
	const struct kernel_g1 g1 = masking_kernel(&o.lobe[0].masking);

	for (int r = 0; r < REPEATS; r++) {
		double t = search_clock();

		sink = (double)stream_all(table, o.term[1], false, threads);
		t_stream[r] = search_clock() - t, t = search_clock();
		sink = pass_all(&o, &g1, false, 0, threads);
		t_pass[r] = search_clock() - t, t = search_clock();
		sink = pass_all(&o, &g1, false, 0.1, threads);
		t_curved[r] = search_clock() - t, t = search_clock();
		sink = (double)stream_all(table, o.term[1], true, threads);
		t_stream_geo[r] = search_clock() - t, t = search_clock();
		sink = pass_all(&o, &g1, true, 0, threads);
		t_model[r] = search_clock() - t;
	}
	const double base = median(t_stream, REPEATS), base_geo = median(t_stream_geo, REPEATS);

	put("kernel on the full table", ndf, threads, "stream of a pass, ms", 1e3 * base);
	put("kernel on the full table", ndf, threads, "pass / stream", median(t_pass, REPEATS) / base);
	put("kernel on the full table", ndf, threads, "pass with curvature / stream", median(t_curved, REPEATS) / base);
	put("kernel on the full table", ndf, threads, "stream with geometry, ms", 1e3 * base_geo);
	put("kernel on the full table", ndf, threads, "model and pass / stream", median(t_model, REPEATS) / base_geo);
	objective_free(&o);
}

/* Median seconds of a fit of all three NDFs, the table in memory. */
static double fit_time(const struct measurement *measurement, const struct fit_options *options, long *evaluations,
		       long *passes)
{
	struct fit_context *context;
	struct fit_result results[3];
	double seconds[FITS];

	if (fit_context_new(&context, measurement->n_phi_d, options) != STATUS_OK)
		return NAN;
	for (int r = 0; r < FITS; r++) {
		const double t = search_clock();

		if (fit_run(context, measurement, options, results, NULL) != STATUS_OK)
			return NAN;
		seconds[r] = search_clock() - t;
	}
	fit_context_free(context);
	*evaluations = *passes = 0;
	for (int n = 0; n < options->n_ndf; n++) {
		*evaluations += results[n].evaluations;
		*passes += results[n].passes;
	}
	return median(seconds, FITS);
}

/* Seconds a material when two are fitted side by side, a thread each. */
static double batch_time(const struct measurement *measurement, const struct fit_options *options)
{
	enum { MATERIALS = 6 };
	struct fit_context *context;
	const double t = search_clock();

	if (fit_context_new(&context, measurement->n_phi_d, options) != STATUS_OK)
		return NAN;
#pragma omp parallel for num_threads(2) schedule(dynamic)
	for (int n = 0; n < MATERIALS; n++) {
		struct fit_result results[3];

		if (fit_run(context, measurement, options, results, NULL) != STATUS_OK)
			abort();
	}
	fit_context_free(context);
	return (search_clock() - t) / MATERIALS;
}

static void bench_fits(const struct measurement *measurement, const struct measurement *large)
{
	struct fit_options o = fit_options_default();
	long evaluations = 0, passes = 0;

	o.threads = 1;
	const double one = fit_time(measurement, &o, &evaluations, &passes);

	put("fit of three NDFs", "all", 1, "seconds", one);
	put("fit of three NDFs", "all", 1, "shapes evaluated", (double)evaluations);
	put("fit of three NDFs", "all", 1, "passes over the full table", (double)passes);
	put("batch, one material a thread", "all", 2, "materials a second", 1 / batch_time(measurement, &o));
	o.threads = 2;
	const double two = fit_time(measurement, &o, &evaluations, &passes);

	put("fit of three NDFs", "all", 2, "one thread / two threads", one / two);
	put("fit of three NDFs, 360 table", "all", 2, "time / 180 table",
	    fit_time(large, &o, &evaluations, &passes) / two);
	o.criterion.max_theta = 60;
	put("fit of three NDFs, max theta 60", "all", 2, "time / whole table",
	    fit_time(measurement, &o, &evaluations, &passes) / two);
	o.criterion.max_theta = 90;
	o.diffuse = false;
	put("fit of three NDFs, no diffuse", "all", 2, "time / whole model",
	    fit_time(measurement, &o, &evaluations, &passes) / two);
	o.diffuse = true;
	o.gray = true;
	put("fit of three NDFs, gray", "all", 2, "time / whole model",
	    fit_time(measurement, &o, &evaluations, &passes) / two);
	o.gray = false;
	o.n_ndf = 2;
	o.ndf[0] = ndf_find("ggx");
	o.ndf[1] = ndf_find("beckmann");
	put("fit of GGX and Beckmann", "two", 2, "time / three NDFs",
	    fit_time(measurement, &o, &evaluations, &passes) / two);
}

int main(int argc, char **argv)
{
	const struct cook_torrance truth = make_model("std", 0.17, 1.63, 1.6);
	struct measurement measurement = make_table(&truth, 180, BINS_NODE, 0.2),
			   large = make_table(&truth, 360, BINS_NODE, 0.2);
	struct fit_options options = fit_options_default();
	struct geometry geometry;
	struct sample_set table;

	csv = argc > 1 ? fopen(argv[1], "w") : NULL;
	if (csv)
		fprintf(csv, "what,model,threads,quantity,value\n");
	options.threads = 1;
	if (geometry_init(&geometry, 180, &options) != STATUS_OK ||
	    sample_set_init(&table, &geometry, &measurement, 1) != STATUS_OK)
		return 1;
	printf("kernel %s, %zu entries, %.1f MB a pass, medians of %d\n", kernel_pick()->name, table.n_entries,
	       1e-6 * (double)(value_bytes(&table) + (size_t)table.n_blocks * KERNEL_BLOCK * 8), REPEATS);
	for (int threads = 1; threads <= 2; threads++) {
		bench_kernel(&table, &options, "ggx", threads);
		bench_kernel(&table, &options, "std", threads);
	}
	sample_set_free(&table);
	geometry_free(&geometry);
	bench_fits(&measurement, &large);
	measurement_free(&measurement);
	measurement_free(&large);
	if (csv && fclose(csv) != 0) {
		fprintf(stderr, "bench: cannot write '%s'\n", argv[1]);
		return 1;
	}
	return 0;
}
