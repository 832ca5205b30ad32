/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What looks wrong with a measurement: each kind of fault in a table of a model, and none in a sound one. */
#include "check.h"
#include "fit/error/model_samples.h"
#include "fit/error/model_table.h"
#include "fit/error/suspects.h"
#include "fit/search/fit.h"
#include "make_scattered.h"
#include "sampled_albedo.h"
#include "src/energy.h"

static const double degree = M_PI / 180;

/* Two sound tables: a plastic, whose red albedo is about 0.32, and a metal. */
static struct measurement plastic, metal;

/* The model's table, each value times 1 + noise * uniform(-1, 1). */
static struct measurement noisy_table(const struct cook_torrance *model, int n_phi_d, enum bins bins, double noise)
{
	struct measurement table;
	unsigned seed = 1;

	assert_int_equal(model_table(model, bins, n_phi_d, 90, 1, &table), STATUS_OK);
	for (size_t at = 0; at < measurement_count(&table) && noise > 0; at++)
		for (int c = 0; c < MERL_CHANNELS; c++)
			table.value[c][at] *= (float)(1 + noise * (2 * random_unit(&seed) - 1));
	return table;
}

static int make_tables(void **state)
{
	struct cook_torrance model = make_model("ggx", 0.1, 2, 1.5);

	(void)state;
	model.fresnel = FRESNEL_NONE; /* quicker */
	model.ks[0] = model.ks[1] = model.ks[2] = 0.05;
	plastic = noisy_table(&model, 180, BINS_NODE, 0.1);
	memset(model.kd, 0, sizeof model.kd);
	model.ks[0] = model.ks[1] = model.ks[2] = 0.6;
	metal = noisy_table(&model, 180, BINS_NODE, 0.1);
	return 0;
}

static int free_tables(void **state)
{
	(void)state;
	measurement_free(&plastic);
	measurement_free(&metal);
	return 0;
}

static struct measurement copy_of(const struct measurement *from)
{
	struct measurement copy;

	assert_int_equal(measurement_reserve(&copy, from->n_phi_d), STATUS_OK);
	memcpy(copy.value[0], from->value[0], MERL_CHANNELS * measurement_count(from) * sizeof *from->value[0]);
	return copy;
}

/* A fault of one entry: its values, its indices and the cosines of its directions. */
typedef void fault(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o);

static void damage(struct measurement *measurement, fault *do_it)
{
	const struct entries entries = entries_make(BINS_NODE, measurement->n_phi_d);
	size_t at = 0;

	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++) {
			const struct halfdiff_trig *h = &entries.theta[i], *d = &entries.theta[j];

			for (int k = 0; k < measurement->n_phi_d; k++, at++) {
				const double level = h->cos_h * d->cos_d;
				const double swing = h->sin_h * d->sin_d * entries.phi[k].cos_phi;
				float *value[MERL_CHANNELS] = {&measurement->value[0][at], &measurement->value[1][at],
							       &measurement->value[2][at]};

				if (!isnan(*value[0]))
					do_it(value, i, j, k, level - swing, level + swing);
			}
		}
}

static struct suspects look_at(const struct measurement *measurement, struct criterion criterion)
{
	struct suspects suspects;

	assert_int_equal(suspects_find(measurement, &criterion, &suspects), STATUS_OK);
	return suspects;
}

static const struct criterion node = {.bins = BINS_NODE, .max_theta = 90};

static void check_words(const struct suspects *suspects, const char *words, const char *label)
{
	char text[SUSPECTS_WORDS];

	if (strcmp(suspects_words(suspects, text), words) != 0)
		fail_msg("%s: got '%s', expected '%s'", label, text, words);
}

static struct suspects check_fault(const struct measurement *sound, fault *do_it, const char *words, const char *label)
{
	struct measurement damaged = copy_of(sound);

	damage(&damaged, do_it);
	const struct suspects suspects = look_at(&damaged, node);

	check_words(&suspects, words, label);
	measurement_free(&damaged);
	return suspects;
}

static void set(float *value[MERL_CHANNELS], double factor)
{
	for (int c = 0; c < MERL_CHANNELS; c++)
		*value[c] *= (float)factor;
}

static void sound_tables_are_not_suspected(void **state)
{
	struct cook_torrance model = make_model("ggx", 0.3, 2, 1.5);
	const struct criterion centre = {.bins = BINS_CENTRE, .max_theta = 90};
	struct measurement noisy = noisy_table(&model, 360, BINS_CENTRE, 0.5);
	struct suspects s = look_at(&noisy, centre);

	(void)state;
	check_words(&s, "", "noise of 50 %, 360 entries of phi_d");
	measurement_free(&noisy);
	memset(model.ks, 0, sizeof model.ks);
	struct measurement diffuse = noisy_table(&model, 180, BINS_NODE, 0);

	s = look_at(&diffuse, node);
	check_words(&s, "", "a constant table");
	measurement_free(&diffuse);
	s = look_at(&plastic, node);
	check_words(&s, "", "plastic");
	assert_true(isnan(s.ends_at));
	s = look_at(&metal, node);
	check_words(&s, "", "metal");
}

/* The albedo of a diffuse table is its kd, at all three angles; of the plastic that and a little gloss. */
static void albedo_is_the_integral_of_the_data(void **state)
{
	struct cook_torrance model = make_model("ggx", 0.3, 2, 1.5);

	(void)state;
	memset(model.ks, 0, sizeof model.ks);
	for (int bins = 0; bins < BINS_COUNT; bins++) {
		struct measurement diffuse = noisy_table(&model, bins ? 360 : 180, (enum bins)bins, 0);
		struct suspects s = look_at(&diffuse, (struct criterion){.bins = (enum bins)bins, .max_theta = 90});

		for (int a = 0; a < SUSPECTS_ALBEDOS; a++) {
			for (int c = 0; c < MERL_CHANNELS; c++)
				check_rel(s.albedo[a][c], model.kd[c] * s.measured[a], 2e-3,
					  "albedo of a diffuse table");
			check_between(s.measured[a], 0.99, 1, "share of the hemisphere");
		}
		measurement_free(&diffuse);
	}
}

static void end_at_80(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k;
	if (fmin(cos_i, cos_o) < cos(80 * degree))
		set(value, 0);
}

static void mask_beyond_80(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k;
	if (fmin(cos_i, cos_o) < cos(80 * degree))
		set(value, NAN);
}

static void dig_a_hole(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)cos_i, (void)cos_o;
	if (i >= 30 && i < 45 && j >= 20 && j < 50 && k >= 40 && k < 90)
		set(value, 0);
}

static void holes_are_found(void **state)
{
	(void)state;
	const struct suspects s = check_fault(&plastic, end_at_80, "zeros+wedge", "zeros beyond 80 degrees");

	check_abs(s.ends_at, 80, 0, "the wedge's end");
	check_between(s.zero_share, 0.1, 0.3, "share of zeros");
	check_between(s.measured[0], 1, 1, "zeros count as measured");
	check_fault(&metal, end_at_80, "zeros+wedge", "zeros beyond 80 degrees of a metal");
	check_fault(&plastic, dig_a_hole, "zeros", "a block of zeros");
	/* What is masked is no fault, but told. */
	check_abs(check_fault(&plastic, mask_beyond_80, "", "masked beyond 80 degrees").ends_at, 80, 0, "the end");
}

/* Zeros that the options leave out are no suspects, and the fit is that of the table with them masked. */
static void zeros_can_be_left_out(void **state)
{
	struct measurement zeros = copy_of(&plastic), masked = copy_of(&plastic);
	struct fit_options options = fit_options_default();
	struct fit_context *context;
	struct fit_result result[2], other;
	struct fit_metrics metrics;
	struct error error;

	(void)state;
	damage(&zeros, end_at_80);
	damage(&masked, mask_beyond_80);
	struct suspects s = look_at(&zeros, (struct criterion){.max_theta = 80});

	check_words(&s, "", "max_theta 80");
	s = look_at(&zeros, (struct criterion){.max_theta = 90, .zero_is_missing = true});
	check_words(&s, "", "zero_is_missing");
	check_between(s.measured[0], 0.9, 0.98, "zeros count as missing");
	options.n_ndf = 1;
	options.threads = 1;
	options.specular = false; /* that is quick */
	for (int run = 0; run < 2; run++) {
		options.criterion.zero_is_missing = run == 0;
		assert_int_equal(fit_context_new(&context, 180, &options), STATUS_OK);
		assert_int_equal(fit_run(context, run ? &masked : &zeros, &options, &result[run], &error), STATUS_OK);
		options.criterion.zero_is_missing = run != 0;
		assert_int_equal(fit_run(context, &zeros, &options, &other, &error), STATUS_DOMAIN);
		fit_context_free(context);
	}
	options.criterion.zero_is_missing = false;
	assert_true(result[0].error == result[1].error && result[0].metrics.samples == result[1].metrics.samples);
	assert_int_equal(fit_eval(&zeros, &result[0].model, &options, &metrics, &error), STATUS_OK);
	assert_true(metrics.samples > result[0].metrics.samples && metrics.error[0] > result[0].error);
	measurement_free(&zeros);
	measurement_free(&masked);
}

/* Of scattered entries too, in the fit and in the metrics. */
static void zeros_among_scattered_entries_can_be_left_out(void **state)
{
	const struct cook_torrance model = make_model("ggx", 0.3, 2, 1.5);
	struct measurement scattered = make_scattered(&model, 900, 0, 7);
	struct fit_options options = fit_options_default();
	struct fit_context *context;
	struct fit_result result;
	struct fit_metrics metrics;
	struct error error;

	(void)state;
	for (size_t n = 0; n < 300; n++)
		for (int c = 0; c < MERL_CHANNELS; c++)
			scattered.scattered->value[c][3 * n] = 0;
	options.n_ndf = 1;
	options.specular = false;
	for (int missing = 0; missing < 2; missing++) {
		const size_t entries = MERL_CHANNELS * (missing ? 600 : 900);

		options.criterion.zero_is_missing = missing;
		assert_int_equal(fit_context_new(&context, 0, &options), STATUS_OK);
		assert_int_equal(fit_run(context, &scattered, &options, &result, &error), STATUS_OK);
		fit_context_free(context);
		assert_int_equal(result.metrics.samples, entries);
		assert_int_equal(fit_eval(&scattered, &model, &options, &metrics, &error), STATUS_OK);
		assert_int_equal(metrics.samples, entries);
		assert_true(missing ? metrics.error[0] < 1e-6 : metrics.error[0] > 0.1);
	}
	const struct suspects s = look_at(&scattered, node);

	check_words(&s, "", "scattered entries");
	check_between(s.albedo[0][0], 0.05, 0.7, "an albedo of what is there");
	measurement_free(&scattered);
}

static void times_1500(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k, (void)cos_i, (void)cos_o;
	set(value, 1500);
}

static void through_1500(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k, (void)cos_i, (void)cos_o;
	set(value, 1 / 1500.0);
}

static void times_pi(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k, (void)cos_i, (void)cos_o;
	set(value, M_PI * 1.1);
}

static void check_explained(const struct suspects *s, const char *part)
{
	char text[SUSPECTS_TEXT];

	if (!strstr(suspects_explain(s, text), part))
		fail_msg("'%s' is not in '%s'", part, text);
}

static void other_units_are_found(void **state)
{
	(void)state;
	struct suspects s = check_fault(&plastic, times_1500, "bright", "1500 times too bright");

	check_explained(&s, "scale factors");
	s = check_fault(&plastic, times_pi, "bright", "a reflectance factor");
	check_explained(&s, "reflectance factor");
	check_explained(&s, "--unbounded");
	s = check_fault(&plastic, through_1500, "dark", "1500 times too dark");
	check_explained(&s, "scale factors");
}

static void times_cos_i(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k, (void)cos_o;
	set(value, cos_i);
}

static void times_cos_o(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k, (void)cos_i;
	set(value, cos_o);
}

static void times_both(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k;
	set(value, cos_i * cos_o);
}

static void lopsided(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k;
	set(value, cos_i < cos_o ? 1.6 : 1);
}

static void cosines_and_asymmetry_are_found(void **state)
{
	(void)state;
	assert_int_equal(check_fault(&plastic, times_cos_i, "cosine", "times cos theta_i").cosine, 1);
	assert_int_equal(check_fault(&metal, times_cos_i, "cosine", "a metal times cos theta_i").cosine, 1);
	assert_int_equal(check_fault(&plastic, times_cos_o, "cosine", "times cos theta_o").cosine, 2);
	assert_int_equal(check_fault(&plastic, times_both, "cosine", "times both").cosine, 3);
	check_between(check_fault(&plastic, lopsided, "asymmetric", "lopsided").asymmetry, 0.2, 0.25, "asymmetry");
	/* With a whole turn the exchange itself is measured. */
	const struct cook_torrance model = make_model("ggx", 0.1, 2, 1.5);
	struct measurement whole = noisy_table(&model, 360, BINS_NODE, 0.1);

	check_fault(&whole, times_cos_i, "cosine", "a whole turn times cos theta_i");
	check_fault(&whole, lopsided, "asymmetric", "a whole turn, lopsided");
	measurement_free(&whole);
}

/* As a file in which the three values of an entry stand together is read. */
static void alternating_channels_are_found(void **state)
{
	static const double scale[MERL_CHANNELS] = {1, 1.15, 1.66};
	struct measurement mixed = copy_of(&plastic);
	const size_t count = measurement_count(&mixed);

	(void)state;
	for (size_t at = 0; at < count; at++) {
		bool missing = false;

		for (size_t c = 0; c < MERL_CHANNELS; c++) {
			const size_t number = c * count + at, from = number % MERL_CHANNELS;
			const float value = plastic.value[from][number / MERL_CHANNELS];

			mixed.value[c][at] = (float)((double)value / scale[from] * scale[c]);
			missing |= isnan(value);
		}
		for (int c = 0; c < MERL_CHANNELS && missing; c++)
			mixed.value[c][at] = NAN;
	}
	const struct suspects s = look_at(&mixed, node);

	check_words(&s, "interleaved", "interleaved channels");
	measurement_free(&mixed);
}

static void add_spikes(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)cos_i, (void)cos_o;
	if (i % 10 == 5 && j % 10 == 5 && k % 30 == 7)
		set(value, 20);
}

static void clip(float *value[MERL_CHANNELS], int i, int j, int k, double cos_i, double cos_o)
{
	(void)i, (void)j, (void)k, (void)cos_i, (void)cos_o;
	for (int c = 0; c < MERL_CHANNELS; c++)
		*value[c] = fminf(*value[c], 2);
}

static void spikes_and_clipping_are_found(void **state)
{
	(void)state;
	const struct suspects s = check_fault(&plastic, add_spikes, "spikes", "spikes");

	check_between((double)s.n_spikes, 200, 486, "spikes");
	check_fault(&metal, add_spikes, "spikes", "spikes in a metal");
	check_fault(&plastic, clip, "clipped", "clipped at 2 per sr");
	check_fault(&metal, clip, "clipped", "a metal clipped at 2 per sr");
}

/* Against the model's own, by quadrature; where the sample turns by normals that are drawn, over the azimuths. */
static double albedo_of_lobe(const struct cook_torrance *model, double theta_i)
{
	enum { AZIMUTHS = 8, NORMALS = 4000 };
	double sum = 0;

	if (model->ndf.sigma_x == model->ndf.sigma_y) {
		assert_int_equal(energy_lobe(model, cos(theta_i), &sum), STATUS_OK);
		return sum;
	}
	for (int n = 0; n < AZIMUTHS; n++)
		sum += sampled_albedo(model, theta_i * 180 / M_PI, 360.0 * n / AZIMUTHS, NORMALS);
	return sum / AZIMUTHS;
}

static void albedos_of_samples_are_the_model_s(void **state)
{
	static const double theta_i[SUSPECTS_ALBEDOS] = {0, M_PI / 6, M_PI / 3};
	static const double sigma_y[] = {0.3, 0.15};
	struct measurement m;

	(void)state;
	for (int turns = 0; turns < 2; turns++) {
		struct cook_torrance model = make_model("ggx", 0.3, 2, 1.5);
		double factor = 1;

		assert_int_equal(ndf_init(&model.ndf, ndf_find("ggx"), 0.3, sigma_y[turns], 2), STATUS_OK);
		assert_int_equal(model_samples(&model, 2, &m), STATUS_OK);
		const struct suspects s = look_at(&m, node);

		check_words(&s, "", "samples");
		check_abs(s.ends_at, turns ? 80 : 85, 1e-6, "ends_at");
		for (int a = 0; a < SUSPECTS_ALBEDOS; a++) {
			const double lobe = albedo_of_lobe(&model, theta_i[a]);

			check_between(s.measured[a], 0.99, 1, "measured");
			for (int c = 0; c < 3; c++)
				check_rel(s.albedo[a][c], model.kd[c] + model.ks[c] * lobe, turns ? 0.1 : 0.05,
					  "albedo");
			factor = fmax(factor, 1.2 / s.albedo[a][0]);
		}
		/* In other units the same samples are bright, or dark. */
		for (size_t e = 0; e < m.scattered->n; e++)
			for (int c = 0; c < 3; c++)
				m.scattered->value[c][e] *= (float)factor;
		const struct suspects bright = look_at(&m, node);
		check_words(&bright, "bright", "samples times a factor");
		for (size_t e = 0; e < m.scattered->n; e++)
			for (int c = 0; c < 3; c++)
				m.scattered->value[c][e] *= (float)(1e-3 / factor);
		const struct suspects dark = look_at(&m, node);
		check_words(&dark, "dark", "samples times a thousandth");
		measurement_free(&m);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sound_tables_are_not_suspected),
		cmocka_unit_test(albedo_is_the_integral_of_the_data),
		cmocka_unit_test(holes_are_found),
		cmocka_unit_test(zeros_can_be_left_out),
		cmocka_unit_test(albedos_of_samples_are_the_model_s),
		cmocka_unit_test(zeros_among_scattered_entries_can_be_left_out),
		cmocka_unit_test(other_units_are_found),
		cmocka_unit_test(cosines_and_asymmetry_are_found),
		cmocka_unit_test(alternating_channels_are_found),
		cmocka_unit_test(spikes_and_clipping_are_found),
	};

	return cmocka_run_group_tests(tests, make_tables, free_tables);
}
