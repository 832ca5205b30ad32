/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of scattered samples: what lies between them, beside them, and their pictures. */
#include "data_readers/measurement_read.h"
#include "data_readers/samples_csv.h"
#include "resampled.h"
#include "rgl_file.h"
#include "run_program.h"

static void what_lies_between_is_interpolated(void **state)
{
	(void)state;
	const struct cook_torrance model = smooth_model();
	struct measurement samples = scatter(&model, 20000, 75, false);
	struct resampled result;
	struct measurement table = resampled(&samples, 180, GAPS_MASKED, 2, &result);
	struct measurement alone = resampled(&samples, 180, GAPS_MASKED, 1, NULL);
	double sum = 0;
	size_t n = 0, outside = 0;
	check_same(&table, &alone);
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < 180; k++) {
				const size_t e = measurement_at(180, i, j, k);
				struct vec3 wi, wo;
				double f[3];
				halfdiff_trig_dirs(bins_trig(BINS_NODE, i, j, k), &wi, &wo);
				if (isnan(table.value[0][e])) {
					/* What was measured has no holes. */
					if (fmin(wi.z, wo.z) > cos(72 * M_PI / 180) && i > 15)
						fail_msg("masked: %d, %d, %d", i, j, k);
					outside += wi.z > 1e-9 && wo.z > 1e-9 ? 1 : 0;
					continue;
				}
				assert_true(fmin(wi.z, wo.z) > cos(76.1 * M_PI / 180));
				cook_torrance_f(&model, wi, wo, f);
				sum += fabs((double)table.value[1][e] / f[1] - 1);
				n++;
			}
	assert_int_equal(n, result.n_measured);
	assert_int_equal(outside, result.n_outside);
	check_between(sum / (double)n, 0, 0.03, "the mean relative error");
	measurement_free(&alone);
	measurement_free(&table);
	measurement_free(&samples);
}

static void samples_in_a_plane_tell_nothing_beside_it(void **state)
{
	(void)state;
	const struct cook_torrance model = smooth_model();
	struct measurement samples = scatter(&model, 2000, 80, true);
	struct measurement table = resampled(&samples, 180, GAPS_MASKED, 2, NULL);
	struct measurement filled = resampled(&samples, 180, GAPS_FILLED, 2, NULL);
	for (int i = 40; i < 60; i++)
		for (int j = 40; j < 60; j++)
			for (int k = 0; k < 180; k++) {
				const size_t e = measurement_at(180, i, j, k);
				struct vec3 wi, wo;
				if (k == 0 && i + j < 90)
					assert_true(!isnan(table.value[0][e]));
				if (k >= 45 && k <= 135)
					assert_true(isnan(table.value[0][e]));
				halfdiff_trig_dirs(bins_trig(BINS_NODE, i, j, k), &wi, &wo);
				assert_int_equal(!isnan(filled.value[0][e]), wi.z > 1e-9 && wo.z > 1e-9);
			}
	measurement_free(&filled);
	measurement_free(&table);
	measurement_free(&samples);
}

static void filled_tables_are_tables(void **state)
{
	(void)state;
	const struct cook_torrance model = smooth_model();
	struct measurement samples = scatter(&model, 10, 80, false);
	samples.file_size = 7;
	samples.file_hash = 8;
	assert_int_equal(measurement_fill(&samples, BINS_CENTRE, 1), STATUS_OK);
	assert_null(samples.scattered);
	assert_int_equal(samples.file_size, 7);
	assert_int_equal(samples.file_hash, 8);
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++) {
			struct vec3 wi, wo;
			halfdiff_trig_dirs(bins_trig(BINS_CENTRE, i, j, 20), &wi, &wo);
			assert_int_equal(wi.z > 1e-9 && wo.z > 1e-9,
					 !isnan(samples.value[0][measurement_at(180, i, j, 20)]));
		}
	measurement_free(&samples);
}

/* Smooth and reciprocal, with a part that depends on the azimuth and vanishes in the mean over it. */
static double brushed(struct vec3 wi, struct vec3 wo, int channel)
{
	const struct vec3 h = vec3_unit(vec3_add(wi, wo));
	return 0.3 + 0.1 * channel + 0.3 * h.z * h.z + 0.4 * (h.x * h.x - h.y * h.y);
}

static double plain(struct vec3 wi, struct vec3 wo, int channel)
{
	const struct vec3 h = vec3_unit(vec3_add(wi, wo));
	return 0.3 + 0.1 * channel + 0.3 * h.z * h.z;
}

/* Between its nodes a file that has an interpolant gives that, with the mean of turns if it is not isotropic. */
static void rgl_files_are_evaluated_by_their_interpolant(void **state)
{
	(void)state;
	const double theta_last = 1.3;
	const struct rgl_spec specs[] = {{1, 9, 33, 3, 0, 0, theta_last, false, true, plain},
					 {33, 9, 17, 3, -M_PI, M_PI, theta_last, false, true, brushed}};
	for (int n = 0; n < 2; n++) {
		struct rgl_bytes file = rgl_make(&specs[n]);
		FILE *stream = fopen("x.bsdf", "wb");
		struct measurement samples;
		struct resampled result;
		double sum = 0;
		size_t valid = 0;
		assert_non_null(stream);
		assert_int_equal(fwrite(file.bytes, 1, file.size, stream), file.size);
		assert_int_equal(fclose(stream), 0);
		assert_int_equal(measurement_read("x.bsdf", NULL, &samples, NULL), STATUS_OK);
		struct measurement table = resampled(&samples, 180, GAPS_MASKED, 2, &result);
		for (int i = 0; i < MERL_THETA_H; i++)
			for (int j = 0; j < MERL_THETA_D; j++)
				for (int k = 0; k < 180; k++) {
					const size_t e = measurement_at(180, i, j, k);
					struct vec3 wi, wo;
					halfdiff_trig_dirs(bins_trig(BINS_NODE, i, j, k), &wi, &wo);
					const double higher = fmax(wi.z, wo.z), lower = fmin(wi.z, wo.z);
					/* One of the two was a wi. */
					if (higher < cos(theta_last + 0.02))
						assert_true(isnan(table.value[1][e]));
					if (higher < cos(theta_last - 0.02) || lower < 0.05)
						continue;
					sum += fabs((double)table.value[1][e] / plain(wi, wo, 1) - 1);
					valid++;
				}
		check_between(sum / (double)valid, 0, n ? 0.03 : 0.01, "the mean relative error");
		measurement_free(&table);
		measurement_free(&samples);
		free(file.bytes);
	}
}

static void render_shows_samples_as_their_model(void **state)
{
	(void)state;
	const struct cook_torrance model = smooth_model();
	struct measurement samples = scatter(&model, 4000, 85, false);
	struct error error;
	size_t n;
	for (size_t e = 0; e < samples.scattered->n; e++)
		samples.scattered->solid_angle[e] = 1e-3f;
	assert_int_equal(samples_csv_write("paint.csv", &samples, BINS_NODE, &n, &error), STATUS_OK);
	measurement_free(&samples);
	stdfit("render paint.csv " MODEL " --size 24 --samples 8 --json -q");
	expect_code(0);
	const char *at = strstr(last.out, "\"delta_e\": ");
	assert_non_null(at);
	check_between(strtod(at + 11, NULL), 0, 1.5, "delta E of the samples and their model");
	expect_out("\"material\": \"paint\"");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_lies_between_is_interpolated),
		cmocka_unit_test(samples_in_a_plane_tell_nothing_beside_it),
		cmocka_unit_test(filled_tables_are_tables),
		cmocka_unit_test(rgl_files_are_evaluated_by_their_interpolant),
		cmocka_unit_test(render_shows_samples_as_their_model),
	};
	return cmocka_run_group_tests(tests, enter_directory, leave_directory);
}
