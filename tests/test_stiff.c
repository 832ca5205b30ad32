/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits of hard tables, made in memory: each ends after a bounded number of evaluations, below every simpler model, and says what
 * it cannot know. Every twelfth phi_d stands for all of them. Some cases are left out unless the environment has
 * STDFIT_STABILITY=1: then random starts must find nothing better, either, and it takes minutes. */
#include "check.h"
#include "fit/search/fit.h"
#include "make_table.h"
#include "run_fit.h"

static bool thorough(void)
{
	const char *set = getenv("STDFIT_STABILITY");

	return set && *set == '1';
}

static struct measurement table_of(const struct cook_torrance *model)
{
	return make_sparse_table(model, 180, BINS_NODE, 0, 12);
}

static struct cook_torrance model_of(const char *ndf, double sigma, double gamma, double n, double kd, double ks)
{
	struct cook_torrance model = make_model(ndf, sigma, gamma, n);

	for (int c = 0; c < MERL_CHANNELS; c++) {
		model.kd[c] = kd * (1 - 0.2 * c);
		model.ks[c] = ks * (1 - 0.1 * c);
	}
	return model;
}

/* Changes every valid entry to what `change` makes of it. */
static void change_all(struct measurement *measurement, double (*change)(double value, double random))
{
	unsigned seed = 7;

	for (size_t at = 0; at < measurement_count(measurement); at++)
		for (int c = 0; c < MERL_CHANNELS; c++)
			measurement->value[c][at] =
				(float)change((double)measurement->value[c][at], random_unit(&seed));
}

static double noisy(double value, double random)
{
	return value * (1 + 0.52 * (2 * random - 1)); /* a standard deviation of 30 % */
}

static double spiky(double value, double random)
{
	return random < 1e-4 ? value * pow(10, 3 + 3e4 * random) : value;
}

static double one(double value, double random)
{
	(void)random;
	return isnan(value) ? value : 1 / M_PI;
}

static double nothing(double value, double random)
{
	(void)random;
	return isnan(value) ? value : 0;
}

static double next_float(double value, double random)
{
	return (double)(random < 0.5 ? nextafterf((float)value, INFINITY) : (float)value);
}

static void drop(struct measurement *measurement, size_t at)
{
	for (int c = 0; c < MERL_CHANNELS; c++)
		measurement->value[c][at] = NAN;
}

static struct measurement mirror(void)
{
	const struct cook_torrance m = model_of("std", 1e-4, 2.2, 1.5, 0.2, 0.8);

	return table_of(&m);
}

static struct measurement gaussian_mirror(void)
{
	const struct cook_torrance m = model_of("beckmann", 1e-4, INFINITY, 20, 0, 0.8);

	return table_of(&m);
}

static struct measurement long_tail(void)
{
	const struct cook_torrance m = model_of("std", 0.03, 1.51, 1.5, 0.2, 0.8);

	return table_of(&m);
}

static struct measurement faint_index(void)
{
	const struct cook_torrance m = model_of("ggx", 0.1, 2, 1.01, 0.05, 0.9);

	return table_of(&m);
}

static struct measurement high_index(void)
{
	const struct cook_torrance m = model_of("ggx", 0.2, 2, 70, 0, 0.7);

	return table_of(&m);
}

static struct measurement rough(void)
{
	const struct cook_torrance m = model_of("std", 3.5, 12, 2, 0.1, 1);

	return table_of(&m);
}

/* E falls along a narrow, curved way in sigma, gamma and n. */
static struct measurement curved_valley(void)
{
	const struct cook_torrance m = model_of("std", 0.19, 2.2, 1.006, 0.25, 0.25);

	return table_of(&m);
}

static struct measurement curved_valley_of_gamma(void)
{
	const struct cook_torrance m = model_of("std", 0.63, 10, 1.09, 0.05, 0.1);

	return table_of(&m);
}

static struct measurement almost_lambertian(void)
{
	const struct cook_torrance m = model_of("ggx", 0.3, 2, 1.5, 0.6, 1e-3);

	return table_of(&m);
}

static struct measurement faint_lobe(void)
{
	const struct cook_torrance m = model_of("ggx", 0.3, 2, 1.5, 0.6, 1e-6);

	return table_of(&m);
}

static struct measurement wide_range(void)
{
	const struct cook_torrance m = model_of("beckmann", 1e-3, INFINITY, 1.5, 1e-5, 1);

	return table_of(&m);
}

static struct measurement one_entry(void)
{
	const struct cook_torrance m = model_of("ggx", 0.3, 2, 1.5, 0.5, 0.5);
	struct measurement s = table_of(&m);

	change_all(&s, nothing);
	for (int c = 0; c < MERL_CHANNELS; c++)
		s.value[c][measurement_at(180, 30, 20, 12)] = 5;
	return s;
}

static struct measurement constant(void)
{
	const struct cook_torrance m = model_of("ggx", 0.3, 2, 1.5, 0.5, 0.5);
	struct measurement s = table_of(&m);

	change_all(&s, one);
	return s;
}

static struct measurement black_channel(void)
{
	struct cook_torrance m = model_of("ggx", 0.2, 2, 1.5, 0.4, 0.7);

	m.kd[1] = m.ks[1] = 0;
	return table_of(&m);
}

static struct measurement two_lobes(void)
{
	const struct cook_torrance wide = model_of("beckmann", 0.7, INFINITY, 1.5, 0.1, 0.8),
				   narrow = model_of("ggx", 3e-3, 2, 1.5, 0, 0.3);
	struct measurement a = table_of(&wide), b = table_of(&narrow);

	for (int c = 0; c < MERL_CHANNELS; c++)
		for (size_t at = 0; at < measurement_count(&a); at++)
			a.value[c][at] += b.value[c][at];
	measurement_free(&b);
	return a;
}

static struct measurement plain(void)
{
	const struct cook_torrance m = model_of("std", 0.15, 1.9, 1.6, 0.2, 0.6);

	return table_of(&m);
}

static struct measurement noise(void)
{
	struct measurement s = plain();

	change_all(&s, noisy);
	return s;
}

static struct measurement spikes(void)
{
	struct measurement s = plain();

	change_all(&s, spiky);
	return s;
}

static struct measurement holes(void)
{
	struct measurement s = plain();
	unsigned seed = 3;

	for (size_t at = 0; at < measurement_count(&s); at++)
		if (random_unit(&seed) < 0.2)
			drop(&s, at);
	return s;
}

static struct measurement blocks_missing(void)
{
	struct measurement s = plain();

	for (size_t at = 0; at < measurement_count(&s); at++)
		if (at / 180 % 90 / 10 % 3 == 1 && at / 180 / 90 / 10 % 2 == 1)
			drop(&s, at);
	return s;
}

/* All but Lambertian, under noise that is larger than its lobe. */
static struct measurement noisy_lambertian(void)
{
	const struct cook_torrance m = model_of("ggx", 0.3, 2, 1.5, 0.6, 1e-5);
	struct measurement s = table_of(&m);

	change_all(&s, noisy);
	return s;
}

enum {
	SHAPE = BOUND_SIGMA | BOUND_GAMMA | BOUND_IOR,
	KD = BOUND_KD_R | BOUND_KD_G | BOUND_KD_B,
	KS = BOUND_KS_R | BOUND_KS_G | BOUND_KS_B,
};

static const struct stiff {
	const char *what;
	struct measurement (*make)(void);
	double most; /* E of STD at most; where the table is STD's own, what rounding and the search's end leave */
	unsigned open, may_be_open; /* what has to be, and what may be, undetermined */
	bool only_thorough;
} cases[] = {
	/* Beside a peak of 1e7, no kd matters. */
	{"mirror", mirror, 1e-5, KD, 0, false},
	{"mirror without tail", gaussian_mirror, 1e-5, KD, 0, true},
	{"gamma 1.51", long_tail, 2e-5, 0, 0, false},
	{"n 1.01", faint_index, 1e-5, 0, 0, true},
	{"n 70", high_index, 1e-5, 0, 0, true},
	{"sigma 3.5", rough, 1e-5, 0, 0, true},
	{"curved valley, n 1.006", curved_valley, 1e-5, 0, 0, true},
	{"curved valley, gamma 10", curved_valley_of_gamma, 1e-5, 0, 0, true},
	{"almost Lambertian", almost_lambertian, 1e-6, 0, 0, true},
	{"noisy Lambertian", noisy_lambertian, 0.3, SHAPE | KS, 0, false},
	{"a lobe of weight 1e-6", faint_lobe, 1e-6, 0, 0, true},
	{"dynamic range of 1e9", wide_range, 1e-5, 0, KD, true},
	{"one entry", one_entry, 1, SHAPE | KS, 0, false},
	{"constant", constant, 1e-6, SHAPE | KS, 0, true},
	{"black channel", black_channel, 1e-5, 0, 0, true},
	{"two lobes", two_lobes, 0.9, 0, 0, true},
	{"noise", noise, 0.3, 0, 0, true},
	{"spikes", spikes, 0.9, 0, 0, false},
	{"holes", holes, 1e-5, 0, 0, true},
	{"blocks missing", blocks_missing, 1e-5, 0, 0, true},
};

/* kd and ks are certified to 1e-7 of the optimum for their shape. */
static const double rounding = 2e-7;

/* What another search may end below this one: 0.01 %, and, where E is near 0, what a last step of 1e-5 in the shape makes. */
static double search_end(double error)
{
	return 1e-4 * error + 2e-6;
}

static double error_with(const struct measurement *measurement, const struct fit_options *options)
{
	struct fit_result r;

	run_fit(measurement, options, &r);
	return r.error;
}

static void check_simpler(const struct stiff *stiff, const struct measurement *measurement, double error)
{
	struct fit_options simpler = options_for("std"), other = simpler;
	char label[96];

	simpler.specular = false;
	snprintf(label, sizeof label, "%s: Lambert alone", stiff->what);
	check_between(error - error_with(measurement, &simpler), -INFINITY, rounding, label);
	if (!thorough())
		return;
	simpler.specular = true;
	simpler.diffuse = false;
	snprintf(label, sizeof label, "%s: no diffuse term", stiff->what);
	check_between(error - error_with(measurement, &simpler), -INFINITY, search_end(error), label);
	other.starts = 50;
	snprintf(label, sizeof label, "%s: 50 random starts", stiff->what);
	check_between(error - error_with(measurement, &other), -INFINITY, search_end(error), label);
}

static void stiff_tables_end_at_their_minimum(void **state)
{
	(void)state;
	for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
		const struct stiff *stiff = &cases[n];
		const struct fit_options options = options_for("std"), three = fit_options_default();
		struct fit_result r;
		char label[96];

		if (stiff->only_thorough && !thorough())
			continue;
		struct measurement measurement = stiff->make();

		run_fit(&measurement, &options, &r);
		check_between(r.error, 0, stiff->most, stiff->what);
		check_between(r.lower_bound, 0, r.error + rounding, stiff->what);
		snprintf(label, sizeof label, "%s: shapes evaluated", stiff->what);
		check_between((double)r.evaluations, 1, 15000, label);
		if ((r.undetermined & stiff->open) != stiff->open ||
		    r.undetermined & ~(stiff->open | stiff->may_be_open))
			fail_msg("%s: undetermined 0x%x, expected 0x%x", stiff->what, r.undetermined, stiff->open);
		check_simpler(stiff, &measurement, r.error);
		if (thorough()) {
			struct fit_result all[3];
			run_fit(&measurement, &three, all);
			assert_true(all[0].error == r.error);
			assert_true(r.error <= all[1].error && r.error <= all[2].error);
			printf("%-22s E %-10.4g of GGX %-10.4g of Beckmann %-10.4g sigma %-9.5g gamma %-8.5g n %-8.5g "
			       "%ld shapes, %.1f s\n",
			       stiff->what, r.error, all[1].error, all[2].error, r.model.ndf.sigma_x, r.model.ndf.gamma,
			       r.model.n, r.evaluations, r.seconds);
			fflush(stdout);
		}
		measurement_free(&measurement);
	}
}

/* A painted metal: two lobes, one narrow and one wide, under noise of 15 %; of the entries near grazing a share `spiked` is 10 to
 * 100 times too large. */
static struct measurement painted(unsigned seed, double sigma, double n, double spiked)
{
	const struct cook_torrance wide = model_of("beckmann", sigma, INFINITY, n, 0.05, 0.1),
				   narrow = model_of("ggx", 0.3 * sigma, 2, 1.5, 0, 0.06);
	struct measurement a = table_of(&wide), b = table_of(&narrow);

	for (size_t at = 0; at < measurement_count(&a); at++) {
		const bool grazing = at / 180 % MERL_THETA_D >= 55;
		const double noise_of = 1 + 0.26 * (2 * random_unit(&seed) - 1), u = random_unit(&seed);
		const double spike = grazing && u < spiked ? pow(10, 1 + u / spiked) : 1;
		for (int c = 0; c < MERL_CHANNELS; c++)
			a.value[c][at] = (float)((double)(a.value[c][at] + b.value[c][at]) * noise_of * spike);
	}
	measurement_free(&b);
	return a;
}

/* Nor does a grid of n, each held fixed, nor do random starts find anything lower. */
static void no_n_and_no_start_ends_lower(void **state)
{
	static const double n_of[] = {1.2, 1.5, 2, 3, 4.5, 8, 12, 20, 50};
	static const struct {
		double sigma, n, max_theta, spiked;
		enum weight weight;
	} tables[] = {{0.05, 4.5, 60, 0, WEIGHT_NONE},
		      {0.12, 13, 61.5, 1e-3, WEIGHT_SOLID_ANGLE},
		      {0.3, 5, 62.5, 1e-2, WEIGHT_NONE},
		      {0.02, 1.45, 63, 3e-3, WEIGHT_SOLID_ANGLE}};

	(void)state;
	for (size_t t = 0; t < sizeof tables / sizeof *tables; t++) {
		struct measurement measurement =
			painted((unsigned)t + 1, tables[t].sigma, tables[t].n, tables[t].spiked);
		struct fit_options options = options_for("beckmann");
		char label[64];

		options.criterion.max_theta = tables[t].max_theta;
		options.criterion.weight = tables[t].weight;
		const double error = error_with(&measurement, &options);

		options.starts = 20;
		snprintf(label, sizeof label, "table %zu: random starts", t);
		check_between(error / error_with(&measurement, &options) - 1, 0, 1e-6, label);
		options.starts = 0;
		for (size_t i = 0; i < sizeof n_of / sizeof *n_of; i++) {
			options.ior = n_of[i];
			snprintf(label, sizeof label, "table %zu: n = %g", t, n_of[i]);
			check_between(error / error_with(&measurement, &options) - 1, -1, 1e-6, label);
		}
		measurement_free(&measurement);
	}
}

/* One value next to the largest float: no metric overflows. */
static void the_largest_value_overflows_no_metric(void **state)
{
	const struct fit_options options = fit_options_default();
	const struct cook_torrance model = model_of("ggx", 0.3, 2, 1.5, 0, 0);
	struct measurement measurement = one_entry();
	struct fit_metrics metrics;
	struct error error = {""};
	struct vec3 wi, wo;

	(void)state;
	for (int c = 0; c < MERL_CHANNELS; c++)
		measurement.value[c][measurement_at(180, 30, 20, 12)] = 3e38F;
	halfdiff_trig_dirs(bins_trig(BINS_NODE, 30, 20, 12), &wi, &wo);
	assert_int_equal(fit_eval(&measurement, &model, &options, &metrics, &error), STATUS_OK);
	const double share = MERL_CHANNELS / (double)metrics.samples, value = wi.z * wo.z * 3e38;

	check_rel(metrics.error[WEIGHT_COSINE], 1, 1e-12, "E of a black model");
	check_rel(metrics.rms_cosine, value * sqrt(share), 1e-6, "rms_cosine");
	check_rel(metrics.rms_cube_root, cbrt(value) * sqrt(share), 1e-6, "rms_cube_root");
	check_rel(metrics.log_error, log(value / 1e-3) * share, 1e-6, "log_error");
	measurement_free(&measurement);
}

static double faint(double value, double random)
{
	(void)random;
	return value * 0x1p-70;
}

/* A table times 2^-70 has the same E, by kd and ks that are as much smaller. */
static void the_unit_of_the_data_changes_nothing(void **state)
{
	struct fit_options options = options_for("ggx");
	struct measurement measurement = noise();
	struct fit_result r, same;

	(void)state;
	run_fit(&measurement, &options, &r);
	change_all(&measurement, faint);
	run_fit(&measurement, &options, &same);
	check_rel(same.error, r.error, 1e-6, "E of a faint table");
	check_rel(same.model.kd[0] * 0x1p70, r.model.kd[0], 1e-3, "its kd");
	check_rel(same.model.ks[0] * 0x1p70, r.model.ks[0], 1e-3, "its ks");
	options.specular = false;
	run_fit(&measurement, &options, &same);
	check_between(same.lower_bound, 0, same.error + rounding, "Lambert alone, certified");
	check_between(same.error, r.error, 0.999, "Lambert alone");
	measurement_free(&measurement);
}

/* Half of the values move to the next float. */
static void a_rounding_of_the_data_changes_nothing(void **state)
{
	const struct fit_options options = options_for("ggx");
	struct measurement measurement = noise();

	(void)state;
	const double before = error_with(&measurement, &options);

	change_all(&measurement, next_float);
	check_rel(error_with(&measurement, &options), before, 1e-6, "E after a rounding");
	measurement_free(&measurement);
}

static void only_what_is_free_is_named(void **state)
{
	struct fit_options options = options_for("ggx");
	struct measurement measurement = noisy_lambertian();
	struct fit_result r;

	(void)state;
	options.ior = 1.5;
	run_fit(&measurement, &options, &r);
	assert_int_equal(r.undetermined & SHAPE, BOUND_SIGMA);
	options.gray = true;
	options.sigma = 0.3;
	run_fit(&measurement, &options, &r);
	assert_int_equal(r.undetermined & (SHAPE | KD), 0);
	/* One ks, three names; where F is what it is, ks = 1 is a lobe that the data do not have. */
	assert_int_equal(r.undetermined & KS, 0);
	options.sigma = options.ior = NAN;
	run_fit(&measurement, &options, &r);
	assert_int_equal(r.undetermined, BOUND_SIGMA | BOUND_IOR | KS);
	options.specular = false;
	run_fit(&measurement, &options, &r);
	assert_int_equal(r.undetermined, 0);
	measurement_free(&measurement);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(stiff_tables_end_at_their_minimum),
		cmocka_unit_test(no_n_and_no_start_ends_lower),
		cmocka_unit_test(a_rounding_of_the_data_changes_nothing),
		cmocka_unit_test(the_largest_value_overflows_no_metric),
		cmocka_unit_test(the_unit_of_the_data_changes_nothing),
		cmocka_unit_test(only_what_is_free_is_named),
	};

	return cmocka_run_group_tests_name("stiff", tests, NULL, NULL);
}
