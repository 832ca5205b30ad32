/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scattered entries: the kernel, the objective and the metrics against sums of the scalar reference. */
#include "check.h"
#include "fit/error/metrics.h"
#include "fit/error/objective.h"
#include "make_scattered.h"

struct reference {
	double error[WEIGHT_COUNT], rms_cosine, rms_cube_root, log_error;
	size_t n;
};

/* Everything from definitions: exact model values, plain sums. */
static struct reference brute_force(const struct scattered *s, const struct cook_torrance *model, double max_theta)
{
	double up[WEIGHT_COUNT] = {0}, down[WEIGHT_COUNT] = {0}, square = 0, root = 0, log_sum = 0;
	struct reference r = {.n = 0};

	for (size_t e = 0; e < s->n; e++) {
		const double cc = s->wi[e].z * s->wo[e].z, limit = cos(max_theta * M_PI / 180);
		double f[3];

		if (s->wi[e].z < limit || s->wo[e].z < limit)
			continue;
		cook_torrance_f(model, s->wi[e], s->wo[e], f);
		for (int c = 0; c < 3; c++) {
			const double m = (double)s->value[c][e], d = fabs(m - f[c]);
			const double w[] = {1, cc, cc * (double)s->solid_angle[e]};

			for (int a = 0; a < WEIGHT_COUNT; a++) {
				up[a] += w[a] * d;
				down[a] += w[a] * m;
			}
			square += cc * d * cc * d;
			root += pow(cbrt(cc * m) - cbrt(cc * f[c]), 2);
			log_sum += fabs(log((cc * m + 1e-3) / (cc * f[c] + 1e-3)));
			r.n++;
		}
	}
	for (int a = 0; a < WEIGHT_COUNT; a++)
		r.error[a] = up[a] / down[a];
	r.rms_cosine = sqrt(square / (double)r.n);
	r.rms_cube_root = sqrt(root / (double)r.n);
	r.log_error = log_sum / (double)r.n;
	return r;
}

struct setting {
	const char *ndf;
	double sigma_x, sigma_y, angle, gamma, n;
	enum gaf gaf;
	enum weight weight;
	double max_theta;
};

static const struct setting settings[] = {
	{"std", 0.3, 0.1, 20, 2.5, 1.5, GAF_UNCORRELATED, WEIGHT_NONE, 90},
	{"std", 0.02, 0.02, 0, 1.506, 12, GAF_CORRELATED, WEIGHT_COSINE, 75},
	{"ggx", 0.05, 0.4, -70, 2, 1.3, GAF_CORRELATED, WEIGHT_SOLID_ANGLE, 90},
	{"beckmann", 0.34, 0.1, 90, INFINITY, 3.1, GAF_V_GROOVE, WEIGHT_NONE, 90},
	{"hyper-cauchy", 0.5, 0.3, 45, 6, 1.8, GAF_UNCORRELATED, WEIGHT_NONE, 90},
	{"t-family", 0.2, 0.25, 5, 3, 1.05, GAF_CORRELATED, WEIGHT_COSINE, 90},
	{"gtr", 0.2, 0.2, 0, 1.4, 1.5, GAF_UNCORRELATED, WEIGHT_NONE, 90},
	{"low", 0.1, 0.1, 0, 1.2, 1.5, GAF_UNCORRELATED, WEIGHT_NONE, 90},
};

/* E at given kd and ks by a kernel, with or without the short way of few samples. */
static double kernel_error(const struct kernel *kernel, const struct sample_set *set, const struct cook_torrance *model,
			   const struct fit_options *o, enum masking_density density, bool exact)
{
	const struct shape shape = shape_of(model);
	struct linear linear = {.error = 0};
	struct objective objective;

	assert_int_equal(objective_init(&objective, set, o, model->ndf.class, 1, density), STATUS_OK);
	objective.kernel = kernel;
	assert_true(objective.is_exact == (density == MASKING_FINE));
	objective.is_exact = exact;
	for (int c = 0; c < MERL_CHANNELS; c++) {
		linear.coefficient[c][0] = model->kd[c] / M_PI;
		linear.coefficient[c][1] = model->ks[c];
	}
	const double error = objective_error(&objective, &shape, &linear);

	objective_free(&objective);
	return error;
}

static void check_setting(const struct setting *s)
{
	struct fit_options o = fit_options_default();
	struct cook_torrance truth = make_model(s->ndf, s->sigma_x, s->gamma, s->n), model;
	struct measurement measurement;
	struct geometry geometry;
	struct sample_set set;
	struct fit_metrics metrics;
	static struct metrics_row row[MERL_ROWS];
	double difference = 0, measured = 0;
	char label[64];

	o.criterion = (struct criterion){s->gaf, s->weight, BINS_NODE, s->max_theta, false};
	o.threads = 2;
	assert_int_equal(ndf_init(&truth.ndf, ndf_find(s->ndf), s->sigma_x, s->sigma_y, s->gamma), STATUS_OK);
	assert_int_equal(ndf_turn(&truth.ndf, s->angle), STATUS_OK);
	truth.gaf = s->gaf;
	model = truth;
	/* Not the model that the values are of: a difference of rounding errors would be no test. */
	for (int c = 0; c < 3; c++) {
		model.kd[c] = 0.7 * truth.kd[c];
		model.ks[c] = (double)(float)(1.2 * truth.ks[c]);
	}
	measurement = make_scattered(&truth, 5000, 0.2, 7);
	const struct reference want = brute_force(measurement.scattered, &model, s->max_theta);

	assert_int_equal(geometry_init(&geometry, 0, &o), STATUS_OK);
	assert_int_equal(metrics_compute(&geometry, &measurement, &model, 2, &metrics), STATUS_OK);
	assert_int_equal(metrics.samples, want.n);
	for (int w = 0; w < WEIGHT_COUNT; w++) {
		snprintf(label, sizeof label, "%s error %s", s->ndf, weight_name((enum weight)w));
		check_rel(metrics.error[w], want.error[w], 1e-12, label);
	}
	check_rel(metrics.rms_cosine, want.rms_cosine, 1e-12, "rms_cosine");
	check_rel(metrics.rms_cube_root, want.rms_cube_root, 2e-6, "rms_cube_root");
	check_rel(metrics.log_error, want.log_error, 1e-12, "log_error");
	assert_int_equal(metrics_rows(&geometry, &measurement, &model, 2, row), STATUS_OK);
	for (int r = 0; r < MERL_ROWS; r++) {
		difference += row[r].difference;
		measured += row[r].measured;
	}
	check_rel(difference / measured, want.error[s->weight], 1e-12, "rows");

	assert_int_equal(sample_set_init(&set, &geometry, &measurement, 2), STATUS_OK);
	assert_int_equal(set.n_entries, want.n);
	const double exact = kernel_error(kernel_pick(), &set, &model, &o, MASKING_FINE, true);
	const double fine = kernel_error(kernel_pick(), &set, &model, &o, MASKING_FINE, false);
	const double coarse = kernel_error(kernel_pick(), &set, &model, &o, MASKING_COARSE, false);

	snprintf(label, sizeof label, "%s %g", s->ndf, s->sigma_x);
	check_rel(exact, want.error[s->weight], 5e-8, label);
	check_rel(fine, want.error[s->weight], 3e-7, label);
	check_rel(coarse, want.error[s->weight], 4e-5, label);
	assert_true(kernel_error(&kernel_plain, &set, &model, &o, MASKING_FINE, false) == fine);
	if (getenv("SHOW"))
		print_message("%s exact %.2g fine %.2g coarse %.2g\n", label, exact / want.error[s->weight] - 1,
			      fine / want.error[s->weight] - 1, coarse / want.error[s->weight] - 1);
	sample_set_free(&set);
	geometry_free(&geometry);
	measurement_free(&measurement);
}

static void kernel_and_metrics_match_the_reference(void **state)
{
	(void)state;
	for (size_t n = 0; n < sizeof settings / sizeof *settings; n++)
		check_setting(&settings[n]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(kernel_and_metrics_match_the_reference),
	};

	return cmocka_run_group_tests_name("scattered", tests, NULL, NULL);
}
