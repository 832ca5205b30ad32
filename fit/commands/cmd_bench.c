/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit bench - error against run time: the default search beside others, on one material; or, with --forms, the forms
 * of Lambda beside each other. */
#include "data_readers/atomic_file.h"
#include "data_readers/measurement_read.h"
#include "fit/cli/messages.h"
#include "fit/cli/options.h"
#include "fit/cli/report.h"
#include "fit/commands/commands.h"
#include "fit/error/sample_set.h"
#include "fit/results/course.h"
#include "fit/results/result.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

/* The seconds after which the algorithms are compared. */
static const double checkpoint_s[] = {0.1, 0.3, 1, 3, 10};
enum { CHECKPOINTS = sizeof checkpoint_s / sizeof *checkpoint_s };

enum bench_column {
	BENCH_MATERIAL,
	BENCH_NDF,
	BENCH_ALGORITHM,
	BENCH_CHECKPOINT,
	BENCH_ERROR = BENCH_CHECKPOINT + CHECKPOINTS,
	BENCH_EVALUATIONS,
	BENCH_SECONDS,
	BENCH_COLUMNS
};

static const struct csv_column columns[BENCH_COLUMNS] = {
	[BENCH_MATERIAL] = {"material", false},
	[BENCH_NDF] = {"ndf", false},
	[BENCH_ALGORITHM] = {"algorithm", false},
	[BENCH_CHECKPOINT] = {"error_0.1s", true},
	{"error_0.3s", true},
	{"error_1s", true},
	{"error_3s", true},
	{"error_10s", true},
	[BENCH_ERROR] = {"error", true},
	[BENCH_EVALUATIONS] = {"evaluations", true},
	[BENCH_SECONDS] = {"seconds", true},
};

enum forms_column {
	FORMS_MATERIAL,
	FORMS_NDF,
	FORMS_LAMBDA,
	FORMS_ERROR,
	FORMS_ERROR_EXACT,
	FORMS_SIGMA,
	FORMS_GAMMA,
	FORMS_IOR,
	FORMS_EVALUATIONS,
	FORMS_SECONDS,
	FORMS_COLUMNS
};

static const struct csv_column forms_columns[FORMS_COLUMNS] = {
	[FORMS_MATERIAL] = {"material", false},
	[FORMS_NDF] = {"ndf", false},
	[FORMS_LAMBDA] = {"lambda", false},
	[FORMS_ERROR] = {"error", true},
	[FORMS_ERROR_EXACT] = {"error_exact", true},
	[FORMS_SIGMA] = {"sigma", true},
	[FORMS_GAMMA] = {"gamma", true},
	[FORMS_IOR] = {"ior", true},
	[FORMS_EVALUATIONS] = {"evaluations", true},
	[FORMS_SECONDS] = {"seconds", true},
};

struct bench {
	const struct options *options;
	const struct algorithm *algorithm[ALGORITHM_COUNT];
	int n_algorithms;
	char *material;
	struct measurement measurement;
	struct fit_context *context;
	/* The full table, to judge the shapes of thinned ones by. */
	struct geometry geometry;
	struct sample_set full;
	struct csv_table output;
	bool incomplete;          /* some form of Lambda could not be fitted */
	struct atomic_file trace; /* if the options want one */
	struct error error;
};

/* Runs one algorithm; the last point of its course is its result. */
static enum status run_one(struct bench *b, const struct algorithm *algorithm, struct course *course)
{
	struct fit_options fit = b->options->fit;
	struct fit_result result;
	fit.algorithm = algorithm;
	fit.trace = course_note;
	fit.trace_data = course;
	const enum status status = fit_run(b->context, &b->measurement, &fit, &result, &b->error);
	if (status != STATUS_OK)
		return status;
	const struct cook_torrance *m = &result.model;
	const struct fit_trace end = {.ndf = fit.ndf[0],
				      .stage = "end",
				      .sigma = m->ndf.sigma_x,
				      .gamma = m->ndf.gamma,
				      .ior = m->n,
				      .k = m->k,
				      .error = result.error,
				      .evaluations = result.evaluations};
	course_note(course, &end);
	return STATUS_OK;
}

static enum status add_row(struct bench *b, const struct algorithm *algorithm, const struct course *course)
{
	const struct fit_trace *end = &course->trace.point[course->trace.n - 1];
	double number[BENCH_COLUMNS] = {[BENCH_ERROR] = end->error,
					[BENCH_EVALUATIONS] = (double)end->evaluations,
					[BENCH_SECONDS] = end->seconds};
	char text[BENCH_COLUMNS][CSV_NUMBER_SIZE];
	const char *cell[BENCH_COLUMNS] = {b->material, ndf_name(end->ndf), algorithm_name(algorithm)};
	/* Empty where it is later than anybody was to go on. */
	for (int i = 0; i < CHECKPOINTS; i++)
		number[BENCH_CHECKPOINT + i] = checkpoint_s[i] <= b->options->fit.time_s
						       ? course_error_after(course, checkpoint_s[i])
						       : (double)NAN;
	for (int c = BENCH_CHECKPOINT; c < BENCH_COLUMNS; c++)
		cell[c] = csv_number(text[c], number[c]);
	if (csv_table_add(&b->output, cell) != STATUS_OK)
		return error_set(&b->error, STATUS_NO_MEMORY, "out of memory");
	return STATUS_OK;
}

/* Says on a terminal what is running. */
static void report_progress(const struct bench *b, int i, int n, const char *name)
{
	if (!b->options->quiet && isatty(STDERR_FILENO))
		fprintf(stderr, "\r%d of %d: %s\033[K", i + 1, n, name);
}

static void erase_progress(const struct bench *b)
{
	if (!b->options->quiet && isatty(STDERR_FILENO))
		fprintf(stderr, "\r\033[K");
}

static enum status run_algorithm(struct bench *b, const struct algorithm *algorithm)
{
	struct course course = course_begin();
	enum status status = run_one(b, algorithm, &course);
	if (status == STATUS_OK && course.trace.incomplete)
		status = error_set(&b->error, STATUS_NO_MEMORY, "out of memory");
	if (status == STATUS_OK)
		status = course_judge(&course, &b->full, &b->options->fit);
	if (status == STATUS_OK) {
		course_keep_best(&course, b->options->fit.time_s, b->options->fit.ndf[0]);
		status = add_row(b, algorithm, &course);
	}
	if (status == STATUS_OK && b->options->trace)
		trace_write(b->trace.stream, b->material, algorithm_name(algorithm), &course.trace);
	trace_free(&course.trace);
	return status;
}

static enum status read_file(struct bench *b)
{
	const struct options *options = b->options;
	const struct read_options reading = options_reading(options, options->fit.threads);
	enum status status = measurement_read(options->path[0], &reading, &b->measurement, &b->error);
	if (status != STATUS_OK)
		return status;
	b->material = result_material(options->path[0]);
	status = b->material ? fit_context_new(&b->context, b->measurement.n_phi_d, &options->fit) : STATUS_NO_MEMORY;
	return status != STATUS_OK ? error_set(&b->error, status, "%s", status_str(status)) : STATUS_OK;
}

static enum status prepare(struct bench *b)
{
	const struct options *options = b->options;
	const struct fit_options *fit = &options->fit;
	b->n_algorithms = options->n_algorithms;
	for (int i = 0; i < options->n_algorithms; i++)
		b->algorithm[i] = options->algorithm[i];
	for (int i = 0; i < ALGORITHM_COUNT && !options->n_algorithms; i++)
		b->algorithm[b->n_algorithms++] = algorithm_at(i);
	enum status status = read_file(b);
	if (status != STATUS_OK)
		return status;
	status = geometry_init(&b->geometry, b->measurement.n_phi_d, fit);
	if (status == STATUS_OK)
		status = sample_set_init(&b->full, &b->geometry, &b->measurement, fit->threads);
	if (status == STATUS_NO_DATA)
		return error_set(&b->error, status, "no entry to fit: expected some valid ones that are not all zero");
	return status != STATUS_OK ? error_set(&b->error, status, "%s", status_str(status)) : STATUS_OK;
}

static enum status run_all(struct bench *b)
{
	const char *trace = b->options->trace;
	enum status status = prepare(b);
	if (status == STATUS_OK && trace)
		status = atomic_file_open(&b->trace, trace, &b->error);
	if (status != STATUS_OK)
		return status;
	if (trace)
		csv_write_header(b->trace.stream, trace_columns, TRACE_COLUMNS);
	for (int i = 0; i < b->n_algorithms && status == STATUS_OK; i++) {
		report_progress(b, i, b->n_algorithms, algorithm_name(b->algorithm[i]));
		status = run_algorithm(b, b->algorithm[i]);
	}
	erase_progress(b);
	if (status == STATUS_OK && trace)
		status = atomic_file_commit(&b->trace, &b->error);
	return status;
}

/* E of the result's parameters with the exact Lambda. */
static enum status eval_exact(struct bench *b, const struct fit_result *result, double *error)
{
	const struct fit_options *fit = &b->options->fit;
	struct cook_torrance model = result->model;
	struct fit_metrics metrics;
	enum status status = ndf_set_lambda_form(&model.ndf, LAMBDA_EXACT);
	if (status != STATUS_OK)
		return error_set(&b->error, status, "%s", status_str(status));
	status = fit_eval(&b->measurement, &model, fit, &metrics, &b->error);
	if (status == STATUS_OK)
		*error = metrics.error[fit->criterion.weight];
	return status;
}

/* The row of a form; without a result its numbers stay empty. */
static enum status add_form(struct bench *b, enum lambda_form form, const struct fit_result *result)
{
	const struct fit_options *fit = &b->options->fit;
	double number[FORMS_COLUMNS];
	char text[FORMS_COLUMNS][CSV_NUMBER_SIZE];
	const char *cell[FORMS_COLUMNS] = {b->material, ndf_name(fit->ndf[0]), lambda_form_name(form)};
	for (int c = FORMS_ERROR; c < FORMS_COLUMNS; c++)
		number[c] = NAN;
	if (result) {
		const struct cook_torrance *m = &result->model;
		const enum status status = eval_exact(b, result, &number[FORMS_ERROR_EXACT]);
		if (status != STATUS_OK)
			return status;
		number[FORMS_ERROR] = result->error;
		number[FORMS_SIGMA] = m->ndf.sigma_x;
		number[FORMS_GAMMA] = m->ndf.gamma;
		number[FORMS_IOR] = m->fresnel == FRESNEL_NONE ? NAN : m->n;
		number[FORMS_EVALUATIONS] = (double)result->evaluations;
		number[FORMS_SECONDS] = result->seconds;
	}
	for (int c = FORMS_ERROR; c < FORMS_COLUMNS; c++)
		cell[c] = csv_number(text[c], number[c]);
	if (csv_table_add(&b->output, cell) != STATUS_OK)
		return error_set(&b->error, STATUS_NO_MEMORY, "out of memory");
	return STATUS_OK;
}

/* A form that is not defined at the gamma in question has an empty row: expected where that gamma was asked for, an
 * error, which stops no other form, where the search came to it. */
static enum status run_form(struct bench *b, enum lambda_form form)
{
	struct fit_options fit = b->options->fit;
	struct fit_result result;
	fit.lambda = form;
	if (!isnan(fit.gamma) && !lambda_form_takes(form, fit.gamma))
		return add_form(b, form, NULL);
	enum status status = fit_run(b->context, &b->measurement, &fit, &result, &b->error);
	if (status == STATUS_DOMAIN) {
		erase_progress(b);
		report_error("cannot fit %s with Lambda %s: %s", ndf_name(fit.ndf[0]), lambda_form_name(form),
			     b->error.text);
		b->incomplete = true;
		return add_form(b, form, NULL);
	}
	if (status != STATUS_OK)
		return status;
	status = add_form(b, form, &result);
	fit_result_free(&result);
	return status;
}

static enum status run_forms(struct bench *b)
{
	enum status status = read_file(b);
	for (int i = 0; i < LAMBDA_FORM_COUNT && status == STATUS_OK; i++) {
		report_progress(b, i, LAMBDA_FORM_COUNT, lambda_form_name((enum lambda_form)i));
		status = run_form(b, (enum lambda_form)i);
	}
	erase_progress(b);
	return status;
}

static void release(struct bench *b)
{
	atomic_file_abort(&b->trace);
	csv_table_free(&b->output);
	sample_set_free(&b->full);
	geometry_free(&b->geometry);
	fit_context_free(b->context);
	measurement_free(&b->measurement);
	free(b->material);
}

static bool has_forms(const struct ndf_class *class)
{
	struct ndf ndf;
	return !ndf_is_tabulated(class) && ndf_init(&ndf, class, 0.1, 0.1, 3) == STATUS_OK &&
	       ndf_set_lambda_form(&ndf, LAMBDA_RATIONAL) == STATUS_OK;
}

static int check(const struct options *options)
{
	static const char *const excluded[] = {"algorithm", "time", "trace", "lambda", "no-specular"};
	if (options->n_paths > 1)
		return options_usage(COMMAND_BENCH, "expected one FILE, found %d", options->n_paths);
	if (options->fit.n_ndf != 1)
		return options_usage(COMMAND_BENCH, "--ndf takes one name here");
	for (size_t i = 0; i < sizeof excluded / sizeof *excluded && options->forms; i++)
		if (options_given(options, excluded[i]))
			return options_usage(COMMAND_BENCH, "--forms and --%s exclude each other", excluded[i]);
	if (options->forms && options->fit.criterion.gaf == GAF_V_GROOVE)
		return options_usage(COMMAND_BENCH, "--forms means nothing with --gaf v-groove, which has no Lambda");
	if (options->forms && !has_forms(options->fit.ndf[0]))
		return options_usage(COMMAND_BENCH, "--forms means nothing for %s, which has the exact Lambda only",
				     ndf_name(options->fit.ndf[0]));
	return -1;
}

int cmd_bench(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	int code = options_parse(&options, COMMAND_BENCH, argc, argv, cancel);
	if (code < 0)
		code = check(&options);
	if (code >= 0)
		return code;
	struct bench b = {.options = &options,
			  .output = options.forms ? csv_table_make(forms_columns, FORMS_COLUMNS)
						  : csv_table_make(columns, BENCH_COLUMNS)};
	const enum status status = options.forms ? run_forms(&b) : run_all(&b);
	/* An interrupted bench shows what it came to. */
	if (status == STATUS_OK || *cancel)
		report_output(&b.output, options_show(&options), report_table);
	else
		report_error("%s", b.error.text);
	release(&b);
	if (*cancel)
		return EXIT_INTERRUPTED;
	return status != STATUS_OK || b.incomplete ? EXIT_FAILED : EXIT_DONE;
}
