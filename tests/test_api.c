/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The public interface: what a stranger may get wrong ends with a status and a text, and normal use gives what the
 * internals give. */
#include "check.h"
#include "fit/stdfit.h"
#include "make_scattered.h"
#include "make_table.h"
#include "src/ndf.h"
#include "src/vndf.h"
#include <limits.h>
#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

static struct stdfit_error error;

static void expect(enum stdfit_status got, enum stdfit_status want, const char *part)
{
	if (got != want || !strstr(error.text, part))
		fail_msg("status %d, text '%s': expected %d, '%s'", (int)got, error.text, (int)want, part);
	error.text[0] = '\0';
}

static stdfit_ndf *new_ndf(const char *name, double sigma, double gamma)
{
	stdfit_ndf *ndf = NULL;

	expect(stdfit_ndf_new(&ndf, name, sigma, sigma, gamma, NULL, &error), STDFIT_OK, "");
	return ndf;
}

static stdfit_measurement *new_measurement(int n_phi_d)
{
	stdfit_ndf *ndf = new_ndf("ggx", 0.25, 0);
	struct stdfit_model model = stdfit_model_default();
	stdfit_measurement *measurement = NULL;

	model.kd[0] = model.kd[1] = model.kd[2] = 0.2;
	expect(stdfit_measurement_from_model(&measurement, &model, ndf, NULL, n_phi_d, &error), STDFIT_OK, "");
	stdfit_ndf_free(ndf);
	return measurement;
}

static struct stdfit_options ggx_options(void)
{
	struct stdfit_options options = stdfit_options_default();

	options.ndfs = "ggx";
	options.threads = 1;
	return options;
}

/* Fits with the first options on a context made for the second. */
static enum stdfit_status fit_with(const struct stdfit_options *options, const struct stdfit_options *made_for,
				   int n_measured, int n_context)
{
	stdfit_measurement *measurement = new_measurement(n_measured);
	stdfit_context *context = NULL;
	struct stdfit_result result = {0};

	expect(stdfit_context_new(&context, n_context, made_for, &error), STDFIT_OK, "");
	const enum stdfit_status status = stdfit_fit(context, measurement, options, 1, &result, &error);

	assert_null(status == STDFIT_OK ? NULL : result.distribution);
	stdfit_result_clear(&result);
	stdfit_context_free(context);
	stdfit_measurement_free(measurement);
	return status;
}

static void a_context_refuses_what_it_was_not_made_for(void **state)
{
	struct stdfit_options options = ggx_options(), other = ggx_options();

	(void)state;
	expect(fit_with(&options, &options, 180, 360), STDFIT_DOMAIN, "360 phi_d: this one has 180");
	expect(fit_with(&options, &options, 360, 180), STDFIT_DOMAIN, "180 phi_d: this one has 360");
	other.gaf = "v-groove";
	other.weight = "cosine";
	expect(fit_with(&options, &other, 180, 180), STDFIT_DOMAIN, "v-groove, weight cosine");
	other = options;
	other.zero_is_missing = 1;
	expect(fit_with(&options, &other, 180, 180), STDFIT_DOMAIN, "zero_is_missing 1: the options say");
}

static void options_out_of_range_are_refused(void **state)
{
	const struct stdfit_options good = ggx_options();
	struct {
		struct stdfit_options options;
		const char *text;
	} wrong[18];
	int n = 0;

	(void)state;
#define WRONG(field, value, words)                                                                                     \
	wrong[n].options = good;                                                                                       \
	wrong[n].options.field = value;                                                                                \
	wrong[n++].text = words
	WRONG(threads, 0, "threads");
	WRONG(threads, -1, "threads");
	WRONG(ndfs, "", "there is none called ''");
	WRONG(ndfs, "ggx,", "there is none called ''");
	WRONG(ndfs, "phong", "'phong'");
	WRONG(max_theta, -5, "max_theta");
	WRONG(max_theta, NAN, "max_theta");
	WRONG(starts, -1, "starts");
	WRONG(blend, 2, "blend");
	WRONG(sigma, 1e9, "sigma");
	WRONG(n, 0, "ior");
	WRONG(gamma, -1, "gamma");
	WRONG(time_s, NAN, "time_s");
	WRONG(algorithm, "magic", "'magic'");
	WRONG(weight, "lead", "'lead'");
	WRONG(gaf, "none", "'none'");
	WRONG(lambda, "inexact", "'inexact'");
	wrong[n].options = good;
	wrong[n].options.diffuse = wrong[n].options.specular = 0;
	wrong[n++].text = "nothing to fit";
	assert_int_equal(n, 18);
	for (int i = 0; i < n; i++) {
		stdfit_context *context;

		expect(fit_with(&wrong[i].options, &good, 180, 180), STDFIT_DOMAIN, wrong[i].text);
		expect(stdfit_context_new(&context, 180, &wrong[i].options, &error), STDFIT_DOMAIN, wrong[i].text);
		assert_null(context);
	}
}

static void null_and_nonsense_are_refused(void **state)
{
	const struct stdfit_options options = ggx_options();
	const double up[3] = {0, 0, 1}, long_one[3] = {0, 0, 2}, down[3] = {0, 0, -1}, u[2] = {0.5, 1};
	const struct stdfit_model model = stdfit_model_default();
	stdfit_ndf *ndf = new_ndf("std", 0.3, 1.8), *other = ndf, *skew = NULL;
	double value[3];
	struct stdfit_metrics metrics;
	stdfit_context *context;
	stdfit_measurement *measurement;

	(void)state;
	expect(stdfit_ndf_new(NULL, "std", 1, 1, 2, NULL, &error), STDFIT_DOMAIN, "NULL");
	expect(stdfit_ndf_new(&other, NULL, 1, 1, 2, NULL, &error), STDFIT_DOMAIN, "(NULL)");
	assert_null(other);
	expect(stdfit_ndf_new(&other, "std", 1, 1, 1.5, NULL, &error), STDFIT_DOMAIN, "gamma 1.5");
	expect(stdfit_ndf_new(&other, "a\nb\x1b", 1, 1, 2, NULL, &error), STDFIT_DOMAIN, "a\\x0ab\\x1b");
	expect(stdfit_fresnel("\n", 1, 1, 0, value, &error), STDFIT_DOMAIN, "'\\x0a'");
	value[1] = INFINITY;
	expect(stdfit_ndf_weight(ndf, NULL, up, 1, up, value + 1, value, &error), STDFIT_DOMAIN, "found inf");
	expect(stdfit_ndf_new(&other, "std", 0, 1, 2, NULL, &error), STDFIT_DOMAIN, "expected sigma in");
	expect(stdfit_ndf_new(&other, "gtr", 1, 2, 2, NULL, &error), STDFIT_DOMAIN, "gtr is isotropic");
	expect(stdfit_ndf_new(&other, "ggx", 1, 1, 2, "rational", &error), STDFIT_UNSUPPORTED, "rational");
	expect(stdfit_ndf_new_piecewise(&other, 2, NULL, up, NULL, &error), STDFIT_DOMAIN, "theta");
	expect(stdfit_ndf_new_piecewise(&other, 2, up, up, NULL, &error), STDFIT_DOMAIN, "increasing from 0 to pi/2");
	expect(stdfit_ndf_new_ellipsoid(&other, NULL, &error), STDFIT_DOMAIN, "A is NULL");
	expect(stdfit_ndf_evaluate(NULL, STDFIT_D, 1, up, value, &error), STDFIT_DOMAIN, "NULL");
	expect(stdfit_ndf_evaluate(ndf, STDFIT_D, 1, NULL, value, &error), STDFIT_DOMAIN, "NULL");
	expect(stdfit_ndf_evaluate(ndf, STDFIT_D, 1, long_one, value, &error), STDFIT_DOMAIN, "unit vector");
	expect(stdfit_ndf_evaluate(ndf, (enum stdfit_ndf_quantity)7, 1, up, value, &error), STDFIT_DOMAIN, "found 7");
	expect(stdfit_ndf_sample(ndf, 1, u, value, &error), STDFIT_DOMAIN, "found 1");
	expect(stdfit_ndf_pdf_visible(ndf, down, 1, up, value, &error), STDFIT_DOMAIN, "horizon");
	expect(stdfit_ndf_moment(ndf, 0, 2, value, &error), STDFIT_DOMAIN, "order 2 does not exist");
	expect(stdfit_model_evaluate(NULL, ndf, 1, up, up, value, &error), STDFIT_DOMAIN, "model is NULL");
	expect(stdfit_model_albedo(&model, ndf, NAN, value, &error), STDFIT_DOMAIN, "cos_i");
	expect(stdfit_ndf_new(&skew, "ggx", 0.1, 0.3, 2, NULL, &error), STDFIT_OK, "");
	expect(stdfit_model_albedo(&model, skew, 0.5, value, &error), STDFIT_DOMAIN, "isotropic");
	expect(stdfit_fresnel("metal", 1, 1, 0, value, &error), STDFIT_DOMAIN, "'metal'");
	expect(stdfit_measurement_read(&measurement, NULL, &error), STDFIT_DOMAIN, "path");
	expect(stdfit_measurement_read(&measurement, "no-such-file", &error), STDFIT_IO, "no-such-file");
	assert_null(measurement);
	expect(stdfit_measurement_from_values(&measurement, 90, up, &error), STDFIT_DOMAIN, "found 90");
	expect(stdfit_measurement_values(NULL, value, &error), STDFIT_DOMAIN, "NULL");
	expect(stdfit_context_new(&context, 180, NULL, &error), STDFIT_DOMAIN, "options is NULL");
	expect(stdfit_context_new(&context, 90, &options, &error), STDFIT_DOMAIN, "found 90");
	expect(stdfit_fit(NULL, NULL, &options, 1, NULL, &error), STDFIT_DOMAIN, "context is NULL");
	expect(stdfit_estimate(NULL, NULL, &options, value, &error), STDFIT_DOMAIN, "context is NULL");
	expect(stdfit_compare(NULL, &model, ndf, &options, &metrics, &error), STDFIT_DOMAIN, "measurement");
	stdfit_ndf_free(NULL);
	stdfit_measurement_free(NULL);
	stdfit_context_free(NULL);
	stdfit_result_clear(NULL);
	assert_string_equal(stdfit_status_text(99), "unknown status");
	assert_int_equal(stdfit_measurement_n_phi_d(NULL), 0);
	stdfit_ndf_free(skew);
	stdfit_ndf_free(ndf);
}

static void values_are_those_of_the_internals(void **state)
{
	const double m[6] = {0.6, 0, 0.8, 0, 0.28, 0.96}, u[2] = {0.3, 0.7};
	stdfit_ndf *ndf = NULL;
	struct ndf inner;
	double value[2], normal[3];

	(void)state;
	expect(stdfit_ndf_new(&ndf, "std", 0.2, 0.4, 1.8, NULL, &error), STDFIT_OK, "");
	assert_int_equal(ndf_init(&inner, ndf_find("std"), 0.2, 0.4, 1.8), STATUS_OK);
	for (int q = STDFIT_D; q <= STDFIT_PDF; q++) {
		double (*const of[])(const struct ndf *, struct vec3) = {ndf_D, ndf_lambda, ndf_G1, ndf_pdf};

		expect(stdfit_ndf_evaluate(ndf, (enum stdfit_ndf_quantity)q, 2, m, value, &error), STDFIT_OK, "");
		for (int i = 0; i < 2; i++)
			check_rel(value[i], of[q](&inner, (struct vec3){m[3 * i], m[3 * i + 1], m[3 * i + 2]}), 0,
				  "value");
	}
	expect(stdfit_ndf_sample_visible(ndf, m, 1, u, normal, &error), STDFIT_OK, "");
	const struct vec3 want = vndf_sample(&inner, (struct vec3){0.6, 0, 0.8}, 0.3, 0.7);

	assert_true(normal[0] == want.x && normal[1] == want.y && normal[2] == want.z);
	stdfit_ndf_free(ndf);
}

static void angles_and_directions_are_inverse(void **state)
{
	const double angles[6] = {0.3, 0.5, 1, 0, 1.2, 0}, wrong[3] = {0.3, NAN, 1};
	double wi[6], wo[6], back[6];

	(void)state;
	expect(stdfit_angles_to_directions(2, angles, wi, wo, &error), STDFIT_OK, "");
	expect(stdfit_angles_from_directions(2, wi, wo, back, &error), STDFIT_OK, "");
	for (int i = 0; i < 3; i++)
		assert_true(fabs(back[i] - angles[i]) < 1e-14);
	assert_true(fabs(back[3]) < 1e-14 && fabs(back[4] - angles[4]) < 1e-14);
	expect(stdfit_angles_to_directions(1, wrong, wi, wo, &error), STDFIT_DOMAIN, "[0, pi/2]");
	expect(stdfit_angles_to_directions(1, NULL, wi, wo, &error), STDFIT_DOMAIN, "NULL");
	expect(stdfit_angles_from_directions(1, wi, wrong, back, &error), STDFIT_DOMAIN, "wo number 0");
	expect(stdfit_angles_from_directions(1, wi, wo, NULL, &error), STDFIT_DOMAIN, "angles is NULL");
}

/* A matrix without skew is GGX in every function; with it only what needs a level surface is refused. */
static void an_ellipsoid_does_what_others_do(void **state)
{
	const double level[9] = {0, 0.2, 0, 0.6, 0, 0, 0, 0, -2}, askew[9] = {0.3, 0, 0, 0, 0.1, 0, 0.1, -0.2, 1};
	const double theta[3] = {0, 0.5, M_PI / 2}, Dx[3] = {2, 1, 0}, Dy[3] = {2, 0.3, 0.1};
	const double w[6] = {0.48, 0.36, 0.8, -0.6, 0, 0.8}, u[4] = {0.2, 0.7, 0.9, 0.1}, steep[3] = {-0.8, 0.6, 0};
	struct stdfit_model model = stdfit_model_default();
	stdfit_ndf *ellipsoid, *ggx, *tilted, *table;
	stdfit_measurement *measurement;
	double a[6], b[6], value;

	(void)state;
	expect(stdfit_ndf_new_ellipsoid(&ellipsoid, level, &error), STDFIT_OK, "");
	expect(stdfit_ndf_new_ellipsoid(&tilted, askew, &error), STDFIT_OK, "");
	expect(stdfit_ndf_new_piecewise(&table, 3, theta, Dx, Dy, &error), STDFIT_OK, "");
	expect(stdfit_ndf_new(&ggx, "ggx", 0.3, 0.1, 0, NULL, &error), STDFIT_OK, "");
	for (enum stdfit_ndf_quantity q = STDFIT_D; q <= STDFIT_PDF; q++) {
		expect(stdfit_ndf_evaluate(ellipsoid, q, 2, w, a, &error), STDFIT_OK, "");
		expect(stdfit_ndf_evaluate(ggx, q, 2, w, b, &error), STDFIT_OK, "");
		check_rel(a[0], b[0], 1e-14, "quantity");
		check_rel(a[1], b[1], 1e-14, "quantity");
		expect(stdfit_ndf_evaluate(tilted, q, 2, w, a, &error), STDFIT_OK, "");
		assert_true(a[0] >= 0 && a[0] != b[0]);
	}
	model.kd[0] = 0.2;
	expect(stdfit_model_evaluate(&model, ellipsoid, 1, w, w + 3, a, &error), STDFIT_OK, "");
	expect(stdfit_model_evaluate(&model, ggx, 1, w, w + 3, b, &error), STDFIT_OK, "");
	check_rel(a[0], b[0], 1e-14, "model");
	expect(stdfit_ndf_sample(ellipsoid, 2, u, a, &error), STDFIT_OK, "");
	expect(stdfit_ndf_sample(ggx, 2, u, b, &error), STDFIT_OK, "");
	check_abs(a[4], b[4], 1e-14, "normal");
	expect(stdfit_ndf_sample_visible(tilted, w, 2, u, a, &error), STDFIT_OK, "");
	expect(stdfit_ndf_pdf_visible(tilted, w, 2, a, b, &error), STDFIT_OK, "");
	expect(stdfit_ndf_weight(tilted, "correlated", w, 2, a, b, b + 2, &error), STDFIT_OK, "");
	assert_true(b[0] > 0 && b[1] > 0 && b[2] >= 0 && b[2] <= 1 && b[3] >= 0 && b[3] <= 1);
	expect(stdfit_dielectric_evaluate(tilted, NULL, 1.5, 1, w, w + 3, a, &error), STDFIT_UNSUPPORTED, "lean");
	expect(stdfit_ndf_furnace(tilted, NULL, &value, &error), STDFIT_DOMAIN, "isotropic");
	/* Two tables, too. */
	expect(stdfit_model_evaluate(&model, table, 1, w, w + 3, a, &error), STDFIT_OK, "");
	expect(stdfit_ndf_P2(table, 0.3, 0.2, &value, &error), STDFIT_OK, "");
	assert_true(a[0] > 0.2 / M_PI && value > 0);
	expect(stdfit_ndf_furnace(table, NULL, &value, &error), STDFIT_DOMAIN, "this pl is not");
	expect(stdfit_ndf_moment(table, 0, 2, &value, &error), STDFIT_UNSUPPORTED, "no moments");
	expect(stdfit_ndf_evaluate(table, STDFIT_D, 1, steep, a, &error), STDFIT_OK, "");
	expect(stdfit_measurement_from_model(&measurement, &model, table, NULL, 180, &error), STDFIT_DOMAIN,
	       "isotropic");
	assert_null(measurement);
	stdfit_ndf_free(ellipsoid);
	stdfit_ndf_free(tilted);
	stdfit_ndf_free(table);
	stdfit_ndf_free(ggx);
}

static void energy_and_kurtosis_have_their_known_values(void **state)
{
	stdfit_ndf *ndf = new_ndf("std", 1e-3, 5), *skew = NULL;
	struct stdfit_model model = stdfit_model_default();
	double value, albedo[3], theta_i = -1;

	(void)state;
	expect(stdfit_ndf_excess_kurtosis(ndf, &value, &error), STDFIT_OK, "");
	check_rel(value, 1.5, 1e-14, "3/(gamma - 3)");
	expect(stdfit_ndf_furnace(ndf, NULL, &value, &error), STDFIT_OK, "");
	assert_true(value > 0.99 && value <= 1 + 1e-5); /* nearly a mirror */
	model.fresnel = "none";
	model.kd[0] = 0.5;
	expect(stdfit_model_albedo_max(&model, ndf, albedo, &theta_i, &error), STDFIT_OK, "");
	assert_true(fabs(albedo[0] - 1.5) < 1e-3 && fabs(albedo[1] - 1) < 1e-3);
	assert_true(theta_i >= 0 && theta_i <= M_PI / 2);
	expect(stdfit_ndf_new(&skew, "ggx", 0.1, 0.3, 2, NULL, &error), STDFIT_OK, "");
	stdfit_ndf *const gaussian = new_ndf("beckmann", 0.5, 0);

	/* the greatest even order; it neither overflows nor takes seconds */
	expect(stdfit_ndf_moment(gaussian, 0, INT_MAX - 1, &value, &error), STDFIT_OK, "");
	assert_true(isinf(value));
	stdfit_ndf_free(gaussian);
	expect(stdfit_ndf_excess_kurtosis(skew, &value, &error), STDFIT_DOMAIN, "no kurtosis");
	expect(stdfit_ndf_excess_kurtosis(ndf, NULL, &error), STDFIT_DOMAIN, "NULL");
	expect(stdfit_ndf_furnace(skew, NULL, &value, &error), STDFIT_DOMAIN, "isotropic");
	expect(stdfit_ndf_furnace(ndf, "none", &value, &error), STDFIT_DOMAIN, "'none'");
	expect(stdfit_model_albedo_max(&model, skew, albedo, &theta_i, &error), STDFIT_DOMAIN, "isotropic");
	expect(stdfit_model_albedo_max(&model, ndf, albedo, NULL, &error), STDFIT_DOMAIN, "NULL");
	stdfit_ndf_free(skew);
	stdfit_ndf_free(ndf);
}

static void step_counted(void *data, const struct stdfit_step *step)
{
	assert_string_equal(step->ndf, "ggx");
	++*(int *)data;
}

static void *a_fit_recovers_its_parameters(void *data)
{
	struct stdfit_options options = ggx_options();
	stdfit_measurement *measurement = new_measurement(180);
	stdfit_context *context = NULL;
	struct stdfit_result result;
	struct stdfit_metrics metrics;
	int steps = 0;

	options.threads = *(const int *)data;
	options.trace = step_counted;
	options.trace_data = &steps;
	expect(stdfit_context_new(&context, 180, &options, &error), STDFIT_OK, "");
	expect(stdfit_fit(context, measurement, &options, 1, &result, &error), STDFIT_OK, "");
	check_rel(result.sigma, 0.25, 1e-3, "sigma");
	check_rel(result.model.n, 1.5, 1e-3, "n");
	assert_string_equal(result.ndf, "ggx");
	assert_true(isnan(result.gamma) && steps > 0);
	expect(stdfit_compare(measurement, &result.model, result.distribution, &options, &metrics, &error), STDFIT_OK,
	       "");
	assert_true(metrics.error[0] == result.error);
	stdfit_result_clear(&result);
	stdfit_context_free(context);
	stdfit_measurement_free(measurement);
	return NULL;
}

/* 256 kB are the figure that the header states. */
/* ThreadSanitizer's own frames are larger than those of the fit. */
#ifdef __has_feature
#if __has_feature(thread_sanitizer)
#define SMALL_STACK (1024 * 1024)
#endif
#endif
#ifndef SMALL_STACK
#define SMALL_STACK (256 * 1024)
#endif

static void a_fit_on_a_small_stack_recovers_its_parameters(void **state)
{
	(void)state;
	for (int threads = 1; threads <= 2; threads++) {
		pthread_attr_t attributes;
		pthread_t thread;

		assert_int_equal(pthread_attr_init(&attributes), 0);
		assert_int_equal(pthread_attr_setstacksize(&attributes, SMALL_STACK), 0);
		assert_int_equal(pthread_create(&thread, &attributes, a_fit_recovers_its_parameters, &threads), 0);
		assert_int_equal(pthread_join(thread, NULL), 0);
		pthread_attr_destroy(&attributes);
	}
}

static void a_child_can_fit_on_one_thread(void **state)
{
	struct stdfit_options options = ggx_options();
	int status = -1;

	(void)state;
	options.threads = 2; /* so that the parent has a team of threads */
	expect(fit_with(&options, &options, 180, 180), STDFIT_OK, "");
	options.threads = 1;
	const pid_t child = fork();

	if (child == 0) {
		alarm(60);
		_exit(fit_with(&options, &options, 180, 180) == STDFIT_OK ? 0 : 1);
	}
	assert_true(child > 0 && waitpid(child, &status, 0) == child);
	assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* n noisy samples of a model, as a caller of the library has them. */
static void make_arrays(const struct cook_torrance *truth, size_t n, double wi[], double wo[], double values[])
{
	struct measurement made = make_scattered(truth, n, 0.02, 5);

	for (size_t i = 0; i < n; i++) {
		memcpy(wi + 3 * i, &made.scattered->wi[i], 3 * sizeof *wi);
		memcpy(wo + 3 * i, &made.scattered->wo[i], 3 * sizeof *wo);
		for (size_t c = 0; c < 3; c++)
			values[3 * i + c] = (double)made.scattered->value[c][i];
	}
	measurement_free(&made);
}

/* Samples that lie anywhere, of a brushed surface. */
static void samples_are_fitted_with_axes(void **state)
{
	struct cook_torrance truth = make_model("ggx", 0.3, 2, 1.5);
	struct stdfit_options options = stdfit_options_default();
	stdfit_measurement *measurement;
	stdfit_context *context;
	struct stdfit_result result;
	enum { N = 1500 };
	static double wi[3 * N], wo[3 * N], values[3 * N];

	(void)state;
	assert_int_equal(ndf_init(&truth.ndf, ndf_find("ggx"), 0.3, 0.15, 2), STATUS_OK);
	make_arrays(&truth, N, wi, wo, values);
	assert_int_equal(stdfit_measurement_from_samples(&measurement, N, wi, wo, values, NULL, &error), STDFIT_OK);
	assert_int_equal(stdfit_measurement_n_phi_d(measurement), 0);
	options.ndfs = "ggx";
	options.anisotropic = 1;
	assert_int_equal(stdfit_context_new(&context, 0, &options, &error), STDFIT_OK);
	assert_int_equal(stdfit_fit(context, measurement, &options, 1, &result, &error), STDFIT_OK);
	check_rel(result.sigma_x, 0.3, 0.02, "sigma_x");
	check_rel(result.sigma_y, 0.15, 0.02, "sigma_y");
	check_abs(result.angle, 0, 1, "angle");
	assert_true(result.error < result.error_isotropic);
	stdfit_result_clear(&result);
	stdfit_context_free(context);
	stdfit_measurement_free(measurement);
	wi[5] = 2;
	expect(stdfit_measurement_from_samples(&measurement, N, wi, wo, values, NULL, &error), STDFIT_DOMAIN,
	       "wi number 1 is no unit vector");
	assert_null(measurement);
	wi[0] = wi[1] = 0;
	wi[2] = -1;
	expect(stdfit_measurement_from_samples(&measurement, 1, wi, wo, values, NULL, &error), STDFIT_NO_DATA,
	       "horizon");
	expect(stdfit_measurement_from_samples(&measurement, 0, wi, wo, values, NULL, &error), STDFIT_DOMAIN,
	       "at least 1");
	expect(stdfit_measurement_from_samples(&measurement, 1, NULL, wo, values, NULL, &error), STDFIT_DOMAIN, "NULL");
}

/* A model of many terms, and the same as the internals have it. */
static struct cook_torrance rich_model(bool f82, struct stdfit_model *model)
{
	struct cook_torrance inner = make_model("ggx", 0.2, 2, 1.5);

	*model = stdfit_model_default();
	for (int c = 0; c < 3; c++) {
		if (f82) {
			model->f0[c] = inner.reflectance[c][0] = 0.7 - 0.2 * c;
			model->f82[c] = inner.reflectance[c][1] = 0.5 + 0.1 * c;
			model->f90[c] = inner.reflectance[c][2] = 0.9;
			inner.ks[c] = 1;
		} else {
			model->kg[c] = inner.kg[c] = 0.3 - 0.1 * c;
			model->ks2[c] = inner.ks_second[c] = 0.2;
		}
		model->kd[c] = inner.kd[c];
		model->ks[c] = inner.ks[c];
	}
	if (f82) {
		inner.fresnel = FRESNEL_F82;
		model->fresnel = "f82";
	}
	inner.grazing = model->exponent = 4;
	model->sigma2 = 0.6;
	if (ndf_init(&inner.second, inner.ndf.class, 0.6, 0.6, 2) != STATUS_OK)
		abort();
	return inner;
}

static void richer_models_are_those_of_the_internals(void **state)
{
	const double wi[3] = {0.6, 0, 0.8}, wo[3] = {0, 0.96, 0.28};
	stdfit_ndf *ndf = new_ndf("ggx", 0.2, 0);
	struct stdfit_model model;
	double got[3], want[3];

	(void)state;
	for (int f82 = 0; f82 < 2; f82++) {
		const struct cook_torrance inner = rich_model(f82, &model);

		cook_torrance_f(&inner, (struct vec3){0.6, 0, 0.8}, (struct vec3){0, 0.96, 0.28}, want);
		expect(stdfit_model_evaluate(&model, ndf, 1, wi, wo, got, &error), STDFIT_OK, "");
		for (int c = 0; c < 3; c++)
			assert_true(got[c] == want[c] && want[c] > 0);
	}
	model.f82[1] = 1.5;
	expect(stdfit_model_evaluate(&model, ndf, 1, wi, wo, got, &error), STDFIT_DOMAIN, "f82");
	rich_model(false, &model);
	model.sigma2 = 0;
	expect(stdfit_model_evaluate(&model, ndf, 1, wi, wo, got, &error), STDFIT_DOMAIN, "sigma2");
	rich_model(false, &model);
	model.exponent = 0;
	expect(stdfit_model_evaluate(&model, ndf, 1, wi, wo, got, &error), STDFIT_DOMAIN, "exponent");
	stdfit_ndf_free(ndf);
}

/* What a fit hands over has the error that it says. */
static void richer_models_are_fitted(void **state)
{
	enum { N = 200 };
	static double wi[3 * N], wo[3 * N], values[3 * N];

	(void)state;
	for (int f82 = 0; f82 < 2; f82++) {
		struct stdfit_model model;
		const struct cook_torrance truth = rich_model(f82, &model);
		struct stdfit_options options = ggx_options();
		stdfit_measurement *measurement;
		stdfit_context *context;
		struct stdfit_result result;
		struct stdfit_metrics metrics;

		make_arrays(&truth, N, wi, wo, values);
		options.fresnel = f82 ? "f82" : NULL;
		options.lobes = f82 ? 1 : 2;
		options.n = f82 ? NAN : 1.5;
		expect(stdfit_measurement_from_samples(&measurement, N, wi, wo, values, NULL, &error), STDFIT_OK, "");
		expect(stdfit_context_new(&context, 0, &options, &error), STDFIT_OK, "");
		expect(stdfit_fit(context, measurement, &options, 1, &result, &error), STDFIT_OK, "");
		check_between(result.error, 0.005, f82 ? 0.02 : 0.2, "E");
		assert_true(f82 ? result.model.f0[0] > 0.5 : result.model.ks2[0] > 0);
		expect(stdfit_compare(measurement, &result.model, result.distribution, &options, &metrics, &error),
		       STDFIT_OK, "");
		check_rel(metrics.error[0], result.error, 1e-12, "E of the model handed over");
		stdfit_result_clear(&result);
		stdfit_context_free(context);
		stdfit_measurement_free(measurement);
	}
	struct stdfit_options options = ggx_options();
	stdfit_context *context;

	options.lobes = 3;
	expect(stdfit_context_new(&context, 0, &options, &error), STDFIT_DOMAIN, "lobes");
	options.lobes = 1;
	options.exponent = 0.5;
	expect(stdfit_context_new(&context, 0, &options, &error), STDFIT_DOMAIN, "exponent");
}

static void the_flag_cancels(void **state)
{
	struct stdfit_options options = ggx_options();
	volatile int cancel = 1;

	(void)state;
	options.cancel = &cancel;
	expect(fit_with(&options, &options, 180, 180), STDFIT_INTERRUPTED, "interrupted");
}

static void an_algorithm_goes_by_its_name(void **state)
{
	struct stdfit_options options = ggx_options();

	(void)state;
	options.algorithm = "sbplx";
	options.time_s = 0.2;
	expect(fit_with(&options, &options, 180, 180), STDFIT_OK, "");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_context_refuses_what_it_was_not_made_for),
		cmocka_unit_test(options_out_of_range_are_refused),
		cmocka_unit_test(null_and_nonsense_are_refused),
		cmocka_unit_test(values_are_those_of_the_internals),
		cmocka_unit_test(angles_and_directions_are_inverse),
		cmocka_unit_test(an_ellipsoid_does_what_others_do),
		cmocka_unit_test(energy_and_kurtosis_have_their_known_values),
		cmocka_unit_test(a_fit_on_a_small_stack_recovers_its_parameters),
		cmocka_unit_test(a_child_can_fit_on_one_thread),
		cmocka_unit_test(samples_are_fitted_with_axes),
		cmocka_unit_test(richer_models_are_those_of_the_internals),
		cmocka_unit_test(richer_models_are_fitted),
		cmocka_unit_test(the_flag_cancels),
		cmocka_unit_test(an_algorithm_goes_by_its_name),
	};

	return cmocka_run_group_tests_name("api", tests, NULL, NULL);
}
