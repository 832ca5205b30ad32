/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The error kernel and the metrics against sums of the scalar reference over every entry. */
#include "check.h"
#include "fit/error/metrics.h"
#include "fit/error/objective.h"
#include "make_table.h"

static struct fit_options options_with(enum gaf gaf, enum weight weight, enum bins bins, double max_theta)
{
	struct fit_options o = fit_options_default();

	o.criterion.gaf = gaf;
	o.criterion.weight = weight;
	o.criterion.bins = bins;
	o.criterion.max_theta = max_theta;
	o.threads = 2;
	return o;
}

/* Masks some entries, whole and half pairs, as a damaged file would have them. */
static void damage(struct measurement *measurement)
{
	unsigned seed = 5;

	for (size_t e = 0; e < measurement_count(measurement); e++)
		if (random_unit(&seed) < 0.03)
			for (int c = 0; c < 3; c++)
				measurement->value[c][e] = NAN;
}

struct reference {
	double error[WEIGHT_COUNT], rms_cosine, rms_cube_root, log_error;
	size_t n;
};

/* The measure of a cell, by the closed form of its definition without the tricks of the program. */
static double plain_cell(int i, int j)
{
	const double deg = M_PI / 180;
	const double w_h = 2 * M_PI * (cos(i * i / 90.0 * deg) - cos((i + 1) * (i + 1) / 90.0 * deg));
	const double w_d = (pow(sin((j + 1) * deg), 2) - pow(sin(j * deg), 2)) / 2 * deg;

	return 4 * w_h * w_d;
}

/* Everything from definitions: exact model values, plain sums. */
static struct reference brute_force(const struct measurement *measurement, const struct cook_torrance *model,
				    const struct fit_options *o)
{
	double up[WEIGHT_COUNT] = {0}, down[WEIGHT_COUNT] = {0}, square = 0, root = 0, log_sum = 0;
	struct reference r = {.n = 0};
	size_t n_sum = 0;

#pragma omp parallel for reduction(+ : up, down, square, root, log_sum, n_sum) schedule(dynamic)
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < measurement->n_phi_d; k++) {
				const size_t at = measurement_at(measurement->n_phi_d, i, j, k);
				const double deg = 180 / M_PI;
				struct vec3 wi, wo;
				double f[3];

				halfdiff_trig_dirs(bins_trig(o->criterion.bins, i, j, k), &wi, &wo);
				if (wi.z <= 1e-9 || wo.z <= 1e-9 || isnan(measurement->value[0][at]) ||
				    acos(wi.z) * deg > o->criterion.max_theta + 1e-9 ||
				    acos(wo.z) * deg > o->criterion.max_theta + 1e-9)
					continue;
				cook_torrance_f(model, wi, wo, f);
				for (int c = 0; c < 3; c++) {
					const double m = (double)measurement->value[c][at], cc = wi.z * wo.z,
						     d = fabs(m - f[c]);
					const double w[] = {1, cc, cc * plain_cell(i, j)};

					for (int a = 0; a < WEIGHT_COUNT; a++) {
						up[a] += w[a] * d;
						down[a] += w[a] * m;
					}
					square += cc * d * cc * d;
					root += pow(cbrt(cc * m) - cbrt(cc * f[c]), 2);
					log_sum += fabs(log((cc * m + 1e-3) / (cc * f[c] + 1e-3)));
					n_sum++;
				}
			}
	for (int a = 0; a < WEIGHT_COUNT; a++)
		r.error[a] = up[a] / down[a];
	r.n = n_sum;
	r.rms_cosine = sqrt(square / (double)n_sum);
	r.rms_cube_root = sqrt(root / (double)n_sum);
	r.log_error = log_sum / (double)n_sum;
	return r;
}

/* E of given kd and ks by the kernel, pass by pass. */
static double kernel_error(const struct kernel *kernel, const struct geometry *geometry,
			   const struct measurement *measurement, const struct cook_torrance *model,
			   const struct fit_options *o, enum masking_density density)
{
	const struct shape shape = {.sigma = model->ndf.sigma_x, .gamma = model->ndf.gamma, .ior = model->n};
	struct objective objective;
	struct sample_set table;
	double error = 0, sum = 0;

	assert_int_equal(sample_set_init(&table, geometry, measurement, 2), STATUS_OK);
	assert_int_equal(objective_init(&objective, &table, o, model->ndf.class, 1, density), STATUS_OK);
	objective.kernel = kernel;
	assert_int_equal(objective_lobe(&objective, &shape), STATUS_OK);
	for (int c = 0; c < 3; c++) {
		for (int b = 0; b < table.n_blocks; b++) {
			const size_t at = (size_t)b * KERNEL_BLOCK;
			const struct kernel_evaluation look = {{model->kd[c] / M_PI, model->ks[c]}, 0.05, 1e-3};
			const float *const term[] = {table.w + at, objective.term[1] + at};
			struct kernel_sums sums;

			kernel->pass(2, b < table.n_pair_blocks ? 2 : 1, sample_set_value(&table, b, c), term, &look,
				     &sums);
			error += sums.error;
		}
		sum += table.sum[c];
	}
	objective_free(&objective);
	sample_set_free(&table);
	return error / sum;
}

struct setting {
	const char *ndf;
	double sigma, gamma, n;
	enum gaf gaf;
	enum weight weight;
	enum bins bins;
	int n_phi_d;
	double max_theta;
};

static const struct setting settings[] = {
	{"std", 0.21, 1.63, 1.47, GAF_UNCORRELATED, WEIGHT_NONE, BINS_NODE, 180, 90},
	{"std", 0.0113, 1.506, 12, GAF_CORRELATED, WEIGHT_COSINE, BINS_CENTRE, 180, 90},
	{"ggx", 0.0037, 2, 1.3, GAF_CORRELATED, WEIGHT_NONE, BINS_NODE, 180, 75},
	{"ggx", 0.6, 2, 2.4, GAF_V_GROOVE, WEIGHT_SOLID_ANGLE, BINS_NODE, 180, 90},
	{"beckmann", 0.34, INFINITY, 3.1, GAF_UNCORRELATED, WEIGHT_SOLID_ANGLE, BINS_CENTRE, 360, 80},
	{"beckmann", 0.11, INFINITY, 1.8, GAF_V_GROOVE, WEIGHT_NONE, BINS_NODE, 360, 60},
};

static void check_setting(const struct setting *s)
{
	const struct fit_options o = options_with(s->gaf, s->weight, s->bins, s->max_theta);
	struct cook_torrance truth = make_model(s->ndf, s->sigma, s->gamma, s->n), model;
	struct measurement measurement;
	struct geometry geometry;
	struct fit_metrics metrics;
	char label[64];

	truth.gaf = s->gaf;
	model = truth;
	/* Compared with another model than the table was made of: a difference of rounding errors would be no test.
	 * ks is a float, as the kernel takes it. */
	for (int c = 0; c < 3; c++) {
		model.kd[c] = 0.7 * truth.kd[c];
		model.ks[c] = (double)(float)(1.2 * truth.ks[c]);
	}
	measurement = make_table(&truth, s->n_phi_d, s->bins, 0.2);
	damage(&measurement);
	const struct reference want = brute_force(&measurement, &model, &o);

	assert_int_equal(geometry_init(&geometry, s->n_phi_d, &o), STATUS_OK);
	assert_int_equal(metrics_compute(&geometry, &measurement, &model, 2, &metrics), STATUS_OK);
	assert_int_equal(metrics.samples, want.n);
	for (int w = 0; w < WEIGHT_COUNT; w++) {
		snprintf(label, sizeof label, "%s error %s", s->ndf, weight_name((enum weight)w));
		check_rel(metrics.error[w], want.error[w], 1e-7, label);
	}
	check_rel(metrics.rms_cosine, want.rms_cosine, 1e-7, "rms_cosine");
	check_rel(metrics.rms_cube_root, want.rms_cube_root, 2e-6, "rms_cube_root");
	check_rel(metrics.log_error, want.log_error, 1e-7, "log_error");

	const double coarse = kernel_error(kernel_pick(), &geometry, &measurement, &model, &o, MASKING_COARSE);
	const double fine = kernel_error(kernel_pick(), &geometry, &measurement, &model, &o, MASKING_FINE);
	const double plain = kernel_error(&kernel_plain, &geometry, &measurement, &model, &o, MASKING_FINE);

	/* Two G1 of 4e-6 each, times the ratio of model to difference, which is 5 here. */
	check_rel(coarse, want.error[s->weight], 4e-5, "kernel, coarse G1");
	check_rel(fine, want.error[s->weight], 1e-7, "kernel, fine G1");
	assert_true(plain == fine);
	geometry_free(&geometry);
	measurement_free(&measurement);
}

static void kernel_and_metrics_match_the_reference(void **state)
{
	(void)state;
	for (size_t n = 0; n < sizeof settings / sizeof *settings; n += case_step(2))
		check_setting(&settings[n]);
}

static void entries_above_the_horizon(void **state)
{
	static const struct {
		enum bins bins;
		int n_phi_d;
		size_t count;
	} want[] = {{BINS_NODE, 180, 1111430}, {BINS_CENTRE, 180, 1096216}, {BINS_CENTRE, 360, 2 * 1096216}};

	(void)state;
	for (size_t n = 0; n < sizeof want / sizeof *want; n++) {
		const struct fit_options o = options_with(GAF_UNCORRELATED, WEIGHT_NONE, want[n].bins, 90);
		struct geometry geometry;
		size_t count = 0;
		int k[4];

		assert_int_equal(geometry_init(&geometry, want[n].n_phi_d, &o), STATUS_OK);
		for (int slot = 0; slot < geometry.n_samples; slot++)
			count += (size_t)geometry_members(&geometry, slot, k);
		assert_int_equal(count, want[n].count);
		geometry_free(&geometry);
	}
}

/* A table with fewer samples than are asked for stays itself. */
static void check_kept(const struct sample_set *table)
{
	struct sample_set same;

	assert_int_equal(sample_set_thin(&same, table, 12 * table->n_samples), STATUS_OK);
	assert_int_equal(same.n_samples, table->n_samples);
	for (int n = 0; n < table->n_blocks * KERNEL_BLOCK; n++)
		assert_true(same.w[n] == table->w[n]);
	sample_set_free(&same);
}

/* A sample of a table tells the error of the whole. */
static void thinned_tables_estimate_the_error(void **state)
{
	const struct fit_options o = options_with(GAF_UNCORRELATED, WEIGHT_NONE, BINS_NODE, 90);
	const struct cook_torrance truth = make_model("std", 0.05, 1.7, 1.6);
	const struct shape shapes[] = {{.sigma = 0.05, .gamma = 2, .ior = 1.6},
				       {.sigma = 0.2, .gamma = 2, .ior = 1.2},
				       {.sigma = 0.01, .gamma = 2, .ior = 20}};
	struct measurement measurement = make_table(&truth, 180, BINS_NODE, 0.3);
	struct geometry geometry;
	struct sample_set full, thin;
	struct objective on_full, on_thin;
	struct linear linear;

	(void)state;
	assert_int_equal(geometry_init(&geometry, 180, &o), STATUS_OK);
	assert_int_equal(sample_set_init(&full, &geometry, &measurement, 2), STATUS_OK);
	assert_int_equal(sample_set_thin(&thin, &full, 5000), STATUS_OK);
	check_between(thin.n_samples, 4900, 5100, "slots");
	check_kept(&thin);
	assert_int_equal(objective_init(&on_full, &full, &o, ndf_find("ggx"), 1, MASKING_COARSE), STATUS_OK);
	assert_int_equal(objective_init(&on_thin, &thin, &o, ndf_find("ggx"), 1, MASKING_COARSE), STATUS_OK);
	for (size_t n = 0; n < 3; n++) {
		const double whole = objective_eval(&on_full, &shapes[n], 1e-6, true, &linear);

		assert_true(linear.error - linear.lower_bound <= 3e-6);
		assert_true(linear.lower_bound <= linear.error);
		check_rel(objective_eval(&on_thin, &shapes[n], 1e-6, true, &linear), whole, 0.005, "thinned error");
	}
	objective_free(&on_full);
	objective_free(&on_thin);
	sample_set_free(&full);
	sample_set_free(&thin);
	geometry_free(&geometry);
	measurement_free(&measurement);
}

/* The coefficients of a model's own table, of all terms that the options have, at its own shape. */
static void check_solved(const struct cook_torrance *truth, const struct fit_options *o, const char *label)
{
	const struct shape shape = shape_of(truth);
	struct measurement measurement = make_sparse_table(truth, 180, BINS_NODE, 0, 6);
	struct cook_torrance found = *truth;
	struct geometry geometry;
	struct sample_set full;
	struct objective objective;
	struct linear linear;

	assert_int_equal(geometry_init(&geometry, 180, o), STATUS_OK);
	assert_int_equal(sample_set_init(&full, &geometry, &measurement, 2), STATUS_OK);
	assert_int_equal(objective_init(&objective, &full, o, truth->ndf.class, 1, MASKING_FINE), STATUS_OK);
	check_between(objective_eval(&objective, &shape, 1e-7, true, &linear), 0, 1e-6, label);
	assert_true(linear.lower_bound <= linear.error);
	linear_set_model(&linear, o, &found);
	for (int c = 0; c < 3; c++) {
		check_abs(found.kd[c], truth->kd[c], 1e-4, label);
		check_abs(found.ks[c], truth->ks[c], 1e-4, label);
		check_abs(found.kg[c], truth->kg[c], 1e-4, label);
		check_abs(found.ks_second[c], truth->ks_second[c], 1e-4, label);
		for (int i = 0; i < F82_PARTS && truth->fresnel == FRESNEL_F82; i++)
			check_abs(found.reflectance[c][i], truth->reflectance[c][i], 1e-3, label);
	}
	objective_free(&objective);
	sample_set_free(&full);
	geometry_free(&geometry);
	measurement_free(&measurement);
}

static void the_coefficients_of_every_term_come_back(void **state)
{
	const struct cook_torrance plain = make_model("std", 0.2, 2.5, 1.6);
	struct fit_options o = options_with(GAF_UNCORRELATED, WEIGHT_SOLID_ANGLE, BINS_NODE, 90);
	struct cook_torrance truth = plain;

	(void)state;
	for (int c = 0; c < 3; c++)
		truth.ks[c] = 0.6;
	o.gray_specular = true;
	check_solved(&truth, &o, "a coloured kd beside one ks");

	truth = plain;
	o.gray_specular = false;
	o.lobes = 2;
	o.grazing = true;
	truth.grazing = 3;
	assert_int_equal(ndf_init(&truth.second, truth.ndf.class, 0.04, 0.04, 1.8), STATUS_OK);
	for (int c = 0; c < 3; c++) {
		truth.kg[c] = 0.1 * (c + 1);
		truth.ks_second[c] = 0.3 / (c + 1);
	}
	check_solved(&truth, &o, "two lobes and a grazing term");

	truth = plain;
	o.lobes = 1;
	o.grazing = false;
	o.fresnel = truth.fresnel = FRESNEL_F82;
	for (int c = 0; c < 3; c++) {
		truth.ks[c] = 1;
		truth.reflectance[c][0] = 0.9 - 0.2 * c;
		truth.reflectance[c][1] = 0.8 - 0.1 * c;
		truth.reflectance[c][2] = 0.95;
	}
	check_solved(&truth, &o, "f82");
	o.grazing = true;
	truth.grazing = 5;
	check_solved(&truth, &o, "f82 and a grazing term that is not there");
	/* More than there are places for. */
	o.lobes = 2;
	assert_int_equal(term_list_of(&o).n, 0);
}

/* Of the table in this unit: E, kd and ks of a shape; how many values of the sample set are no normal floats. */
static struct linear solve_in_unit(const struct measurement *measurement, const struct geometry *geometry,
				   const struct fit_options *o, double unit, size_t *denormal)
{
	struct measurement scaled;
	struct sample_set table;
	struct objective objective;
	struct linear linear;

	assert_int_equal(measurement_reserve(&scaled, measurement->n_phi_d), STATUS_OK);
	for (size_t e = 0; e < MERL_CHANNELS * measurement_count(measurement); e++)
		scaled.value[0][e] = (float)((double)measurement->value[0][e] * unit);
	assert_int_equal(sample_set_init(&table, geometry, &scaled, 2), STATUS_OK);
	assert_int_equal(objective_init(&objective, &table, o, ndf_find("ggx"), 2, MASKING_FINE), STATUS_OK);
	objective_eval(&objective, &(struct shape){.sigma = 0.25, .gamma = 2, .ior = 1.4}, 1e-6, true, &linear);
	*denormal = 0;
	for (size_t v = 0; v < (size_t)(table.n_blocks + table.n_pair_blocks) * MERL_CHANNELS * KERNEL_BLOCK; v++)
		*denormal += table.value[v] != 0 && !isnormal(table.value[v]);
	objective_free(&objective);
	sample_set_free(&table);
	measurement_free(&scaled);
	return linear;
}

/* Values near the least normal float are fitted as in any other unit, and without arithmetic on denormal numbers, which is a
 * hundred times slower. */
static void faint_tables_are_fitted_in_a_unit_of_their_own(void **state)
{
	const struct cook_torrance model = make_model("ggx", 0.3, 2, 1.5);
	const struct fit_options o = options_with(GAF_UNCORRELATED, WEIGHT_SOLID_ANGLE, BINS_NODE, 60);
	struct measurement measurement = make_sparse_table(&model, 180, BINS_NODE, 0.1, 6);
	struct geometry geometry;
	size_t denormal;

	(void)state;
	assert_int_equal(geometry_init(&geometry, 180, &o), STATUS_OK);
	const struct linear want = solve_in_unit(&measurement, &geometry, &o, 1, &denormal);

	for (double unit = 0x1p-60; unit > 0x1p-122; unit *= 0x1p-60) {
		const struct linear got = solve_in_unit(&measurement, &geometry, &o, unit, &denormal);

		check_rel(got.error, want.error, 1e-4, "error");
		check_rel(got.lower_bound, want.lower_bound, 1e-4, "lower bound");
		for (int c = 0; c < MERL_CHANNELS; c++)
			check_rel(got.kd[c] / unit, want.kd[c], 1e-3, "kd");
		assert_int_equal(denormal, 0);
	}
	geometry_free(&geometry);
	measurement_free(&measurement);
}

static void nothing_to_fit_is_said(void **state)
{
	const struct fit_options o = options_with(GAF_UNCORRELATED, WEIGHT_NONE, BINS_NODE, 90);
	struct measurement measurement;
	struct geometry geometry;
	struct sample_set table;

	(void)state;
	assert_int_equal(geometry_init(&geometry, 180, &o), STATUS_OK);
	assert_int_equal(measurement_alloc(&measurement, 180), STATUS_OK);
	assert_int_equal(sample_set_init(&table, &geometry, &measurement, 1), STATUS_NO_DATA);
	for (int c = 0; c < 3; c++)
		memset(measurement.value[c], 0, measurement_count(&measurement) * sizeof *measurement.value[c]);
	assert_int_equal(sample_set_init(&table, &geometry, &measurement, 1), STATUS_NO_DATA);
	measurement_free(&measurement);
	geometry_free(&geometry);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(kernel_and_metrics_match_the_reference),
		cmocka_unit_test(entries_above_the_horizon),
		cmocka_unit_test(thinned_tables_estimate_the_error),
		cmocka_unit_test(the_coefficients_of_every_term_come_back),
		cmocka_unit_test(faint_tables_are_fitted_in_a_unit_of_their_own),
		cmocka_unit_test(nothing_to_fit_is_said),
	};

	return cmocka_run_group_tests_name("objective", tests, NULL, NULL);
}
