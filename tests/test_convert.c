/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measurements as tables and as CSV of samples: the functions, and stdfit convert. */
#include "data_readers/measurement_read.h"
#include "data_readers/merl.h"
#include "data_readers/rgl.h"
#include "data_readers/samples_csv.h"
#include "fit/cli/files.h"
#include "resampled.h"
#include "run_program.h"

/* Tables */

static void a_table_stays_itself(void **state)
{
	(void)state;
	const struct cook_torrance model = smooth_model();
	struct measurement half = make_sparse_table(&model, 180, BINS_NODE, 0.1, 7);
	struct resampled result;
	struct measurement same = resampled(&half, 180, GAPS_MASKED, 1, &result);
	check_same(&same, &half);
	assert_false(result.symmetrised);
	struct measurement whole = resampled(&half, 360, GAPS_MASKED, 1, NULL);
	struct measurement back = resampled(&whole, 180, GAPS_MASKED, 1, &result);
	assert_true(result.symmetrised);
	check_same(&back, &half);
	measurement_free(&same);
	measurement_free(&whole);
	measurement_free(&back);
	measurement_free(&half);
}

static void both_orders_have_their_mean(void **state)
{
	(void)state;
	struct measurement whole;
	assert_int_equal(measurement_alloc(&whole, 360), STATUS_OK);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		whole.value[c][measurement_at(360, 3, 4, 5)] = 1;
		whole.value[c][measurement_at(360, 3, 4, 185)] = 4;
		whole.value[c][measurement_at(360, 3, 4, 186)] = 7;
	}
	struct measurement half = resampled(&whole, 180, GAPS_MASKED, 1, NULL);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		check_abs((double)half.value[c][measurement_at(180, 3, 4, 5)], 2.5, 0, "the mean of both");
		check_abs((double)half.value[c][measurement_at(180, 3, 4, 6)], 7, 0, "the one that is there");
		assert_true(isnan(half.value[c][measurement_at(180, 3, 4, 7)]));
	}
	measurement_free(&half);
	measurement_free(&whole);
}

static void a_table_has_two_values_of_phi(void **state)
{
	(void)state;
	const struct cook_torrance model = smooth_model();
	struct measurement half = make_sparse_table(&model, 180, BINS_NODE, 0, 90), table;
	assert_int_equal(measurement_resample(&half, BINS_NODE, 90, GAPS_MASKED, 1, &table, NULL), STATUS_DOMAIN);
	measurement_free(&half);
}

/* Samples */

static void samples_of_a_table_come_back(void **state)
{
	(void)state;
	enum { STEP = 45 };
	const struct cook_torrance model = smooth_model();
	struct measurement table = make_sparse_table(&model, 180, BINS_NODE, 0, STEP), samples;
	struct error error;
	size_t n, at = 0;
	assert_int_equal(samples_csv_write("come-back.csv", &table, BINS_NODE, &n, &error), STATUS_OK);
	assert_int_equal(measurement_read("come-back.csv", NULL, &samples, &error), STATUS_OK);
	assert_int_equal(samples.scattered->n, n);
	struct measurement again = resampled(&samples, 180, GAPS_MASKED, 2, NULL);
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < 180; k += STEP) {
				const size_t e = measurement_at(180, i, j, k);
				struct vec3 wi, wo;
				halfdiff_trig_dirs(bins_trig(BINS_NODE, i, j, k), &wi, &wo);
				if (isnan(table.value[0][e]) || fmin(wi.z, wo.z) < 2e-6)
					continue;
				check_abs((double)samples.scattered->value[1][at++], (double)table.value[1][e], 0,
					  "a sample");
				/* i = 0 or j = 0 is one direction for all k. */
				check_rel((double)again.value[1][e], (double)table.value[1][e], 1e-5, "an entry");
			}
	assert_int_equal(at, n);
	measurement_free(&again);
	measurement_free(&samples);
	measurement_free(&table);
}

static void a_merl_file_takes_no_samples(void **state)
{
	(void)state;
	const struct cook_torrance model = smooth_model();
	struct measurement samples = scatter(&model, 10, 80, false);
	struct error error;
	assert_int_equal(merl_write("none.binary", &samples, &error), STATUS_UNSUPPORTED);
	assert_true(access("none.binary", F_OK) != 0);
	measurement_free(&samples);
}

/* The program */

/* Samples of the model in three formats, a few thousand each. */
static void make_files(void)
{
	const struct cook_torrance model = smooth_model();
	struct measurement samples = scatter(&model, 300, 85, false);
	struct error error;
	size_t n;
	for (size_t e = 0; e < samples.scattered->n; e++)
		samples.scattered->solid_angle[e] = 1e-3f;
	assert_int_equal(samples_csv_write("paint.csv", &samples, BINS_NODE, &n, &error), STATUS_OK);
	measurement_free(&samples);
	write_text("gray.dat", "#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n"
			       "0.1 0.2 0.3 1\n0.1 0.3 0.3 2\n1.5 1.5 0 3\n0.3 0.3 0.3 -1\n");
	write_text("blue.brdf",
		   "5\n400 500 520 540 700\n0.1 0 0.2 3 0 0 1 0 0\n0.1 0 0.3 3 1 1 1 1 1\n0.1 0 0.3 3 0 0 0 0 0\n");
}

static void convert_writes_samples_and_tables(void **state)
{
	(void)state;
	make_files();
	stdfit("convert paint.csv paint.binary");
	expect_code(0);
	expect_part(last.err, "entries of the table; lost: interpolated; ", __LINE__);
	expect_part(last.err, " outside what was measured are -1; the mean of both orders of wi and wo", __LINE__);
	assert_int_equal(count_lines(last.err), 1);
	stdfit("info paint.binary --table");
	expect_out("format               merl\n");
	stdfit("convert paint.binary again.csv -q");
	expect_code(0);
	assert_string_equal(last.err, "");
	stdfit("convert gray.dat gray.csv");
	expect_part(last.err, "2 samples; lost: left out: 1 negative; 1 at or below the horizon\n", __LINE__);
	stdfit("convert blue.brdf blue.csv");
	expect_part(last.err,
		    "2 samples; lost: 1 out of gamut, their negative part set to 0; 5 wavelengths became linear sRGB; "
		    "left out: 1 not measured\n",
		    __LINE__);
	stdfit("convert --gamut mask blue.brdf blue.csv");
	expect_part(last.err,
		    "1 sample; lost: 5 wavelengths became linear sRGB; left out: 1 not measured; 1 out of gamut\n",
		    __LINE__);
	stdfit("convert --quantity reflectance_factor gray.dat factor.csv -q");
	shell("tail -n 1 factor.csv | cut -d, -f5");
	assert_string_equal(last.out, "0.636619747\n");
}

static double told_error(void)
{
	const char *words = "interpolated, with an error of ", *at = strstr(last.err, words);

	if (!at)
		fail_msg("no error in %s", last.err);
	return strtod(at + strlen(words), NULL);
}

/* A table as an RGL file: the error is the L1 distance that its definition gives, and small. */
static void tables_become_rgl_files(void **state)
{
	(void)state;
	struct measurement table, file;
	struct error error;
	double difference = 0, norm = 0;

	stdfit("synth smooth.binary " MODEL);
	stdfit("convert smooth.binary smooth.bsdf");
	expect_code(0);
	expect_part(last.err, "1111430 samples; lost: interpolated, with an error of ", __LINE__);
	const double told = told_error();
	assert_int_equal(measurement_read("smooth.binary", NULL, &table, &error), STATUS_OK);
	assert_int_equal(measurement_read("smooth.bsdf", NULL, &file, &error), STATUS_OK);
	assert_int_equal(file.scattered->symmetry, SYMMETRY_ISOTROPIC);
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < 180; k += 3) {
				const size_t at = measurement_at(180, i, j, k);
				double f[3];
				struct vec3 wi, wo;

				halfdiff_trig_dirs(bins_trig(BINS_NODE, i, j, k), &wi, &wo);
				if (isnan(table.value[0][at]) || !rgl_f(file.rgl, wi, wo, f))
					continue;
				for (int c = 0; c < 3; c++) {
					const double w = cell_measure(i, j) * wi.z * wo.z;

					difference += w * fabs(f[c] - (double)table.value[c][at]);
					norm += w * (double)table.value[c][at];
				}
			}
	check_rel(told, 100 * difference / norm, 0.06, "the error that is told");
	check_between(told, 0.01, 0.6, "the error");
	measurement_free(&table);
	measurement_free(&file);
	/* And back, it is nearly the model again. */
	stdfit("convert smooth.bsdf again.binary -q");
	stdfit("eval again.binary " MODEL " --json");
	expect_out("\"error_solid_angle\": 0.00");
}

static void turned_samples_become_rgl_files(void **state)
{
	(void)state;
	stdfit("synth turned.csv --ndf ggx --sigma 0.5,0.25 --angle 25 --kd 0.3 --ks 0.5");
	stdfit("convert turned.csv turned.bsdf");
	expect_code(0);
	check_between(told_error(), 0.5, 8, "the error");
	stdfit("fit turned.bsdf --anisotropic --ndf ggx -q -o turned-fits.csv");
	expect_code(0);
	struct csv_table fits = read_table("turned-fits.csv");
	/* What lies between samples 15 and 20 degrees apart is smoothed. */
	check_rel(result_number(fits.row[0], RESULT_SIGMA_X), 0.5, 0.1, "sigma_x");
	check_rel(result_number(fits.row[0], RESULT_SIGMA_Y), 0.25, 0.2, "sigma_y");
	check_abs(result_number(fits.row[0], RESULT_ANGLE), 25, 3, "angle");
	csv_table_free(&fits);
}

static void info_tells_what_is_in_a_file(void **state)
{
	(void)state;
	make_files();
	stdfit("info gray.dat blue.brdf --table");
	expect_code(0);
	expect_out("theta_h              \n");
	expect_out("valid                2\n");
	expect_out("max_b                2\n");
	expect_out("format               alta\n");
	expect_out("symmetry             isotropic\n");
	expect_out("channels             1\n");
	expect_out("left_out             1 negative; 1 at or below the horizon\n");
	expect_out("suspects             out of gamut, set to 0: 1\n");
	expect_out("channels             5\n");
	expect_out("left_out             1 not measured\n");
	stdfit("info --gamut mask blue.brdf --table");
	expect_out("left_out             1 not measured; 1 out of gamut\n");
}

static void a_directory_has_the_known_files(void **state)
{
	(void)state;
	make_files();
	shell("mkdir -p mixed; cp gray.dat blue.brdf mixed; cp paint.csv mixed/paint.CSV; cd mixed; echo a,b "
	      ">table.csv; "
	      "echo hello >notes.txt; echo hello >notes.dat; echo analytic >shader.brdf");
	atomic_bool cancel = false;
	struct files files;
	char *const path[] = {"mixed"};
	assert_int_equal(files_collect(&files, path, 1, false, &cancel), 0);
	assert_int_equal(files.n, 3);
	static const char *const names[] = {"blue", "gray", "paint"};
	for (size_t i = 0; i < 3; i++) {
		char *material = result_material(files.path[i]);
		assert_string_equal(material, names[i]);
		free(material);
	}
	files_free(&files);
	shell("mkdir -p other; cp mixed/notes* other");
	stdfit("render other " MODEL " -q");
	expect_error(1, "'other': no measurement of a known format in this directory");
	stdfit("info mixed/notes.dat");
	expect_error(1, "'mixed/notes.dat': ");
	stdfit("info mixed/notes.txt");
	expect_error(1, "'mixed/notes.txt': its format is not known: expected MERL table");
}

/* Writes samples of an STD lobe with 5 % noise as CSV: one value each, r, g and b, or a spectrum. */
static void write_noisy(const char *path, const char *columns, int n_values)
{
	const struct cook_torrance model = make_model("std", 0.2, 2.5, 1.5);
	struct measurement m = scatter(&model, 6000, 80, false);
	FILE *file = fopen(path, "w");
	unsigned seed = 11;
	assert_non_null(file);
	fprintf(file, "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,%s\n", columns);
	for (size_t e = 0; e < m.scattered->n; e++) {
		const struct vec3 i = m.scattered->wi[e], o = m.scattered->wo[e];
		fprintf(file, "%.15g,%.15g,%.15g,%.15g,%.15g,%.15g", i.x, i.y, i.z, o.x, o.y, o.z);
		for (int v = 0; v < n_values; v++) {
			const int channel = n_values == 1 ? 1 : n_values == 3 ? v : (n_values - 1 - v) * 3 / n_values;
			fprintf(file, ",%.9g",
				(double)m.scattered->value[channel][e] * (1 + 0.05 * (2 * random_unit(&seed) - 1)));
		}
		fputc('\n', file);
	}
	assert_int_equal(fclose(file), 0);
	measurement_free(&m);
}

static void noisy_samples_give_their_parameters_back(void **state)
{
	(void)state;
	static const struct {
		const char *path, *columns;
		int n_values;
	} files[] = {{"noisy/gray.csv", "value", 1},
		     {"noisy/rgb.csv", "r,g,b", 3},
		     {"noisy/spectrum.csv", "420nm,460nm,500nm,540nm,580nm,620nm,660nm", 7}};
	shell("mkdir noisy");
	for (int i = 0; i < 3; i++)
		write_noisy(files[i].path, files[i].columns, files[i].n_values);
	stdfit("noisy -q -o noisy.csv");
	expect_code(0);
	struct csv_table table = read_table("noisy.csv");
	assert_int_equal(table.n_rows, 9);
	for (size_t i = 0; i < table.n_rows; i++) {
		char *const *row = table.row[i];
		if (strcmp(row[RESULT_NDF], "std") != 0)
			continue;
		check_rel(result_number(row, RESULT_SIGMA), 0.2, 0.02, row[RESULT_MATERIAL]);
		check_rel(result_number(row, RESULT_GAMMA), 2.5, 0.06, row[RESULT_MATERIAL]);
		check_rel(result_number(row, RESULT_IOR), 1.5, 0.03, row[RESULT_MATERIAL]);
		if (!strcmp(row[RESULT_MATERIAL], "rgb"))
			check_rel(result_number(row, RESULT_KD_R), 0.31, 0.01, "kd_r");
		if (!strcmp(row[RESULT_MATERIAL], "gray"))
			check_rel(result_number(row, RESULT_KD_R), 0.12, 0.01, "kd of the one channel");
	}
	csv_table_free(&table);
	/* The tables of a batch with several formats are joined, resumed and compared as others are. */
	stdfit("noisy -q --shard 1/2 -o one.csv");
	stdfit("noisy -q --shard 2/2 -o two.csv");
	stdfit("merge one.csv two.csv noisy -o joined.csv");
	expect_code(0);
	char *joined = without_seconds("joined.csv"), *whole = without_seconds("noisy.csv");
	assert_string_equal(joined, whole);
	free(joined);
	free(whole);
	stdfit("compare noisy.csv");
	expect_code(0);
	expect_out("\nspectrum,");
	stdfit("compare noisy/gray.csv --ndf ggx,beckmann"); /* samples, no table of results */
	expect_code(0);
	expect_out("\ngray,");
	stdfit("noisy/gray.csv -q --resume -o noisy.csv --quantity brdf_cos");
	shell("grep -c 'quantity=brdf_cos' noisy.csv");
	assert_string_equal(last.out, "3\n");
}

/* Of a mirror on a goniometer nearly all is dark: a few entries, one above all, decide what the lobe is. */
static void one_bright_entry_is_not_lost(void **state)
{
	(void)state;
	unsigned seed = 3;
	FILE *file = fopen("mirror.csv", "w");
	assert_non_null(file);
	fputs("theta_i,phi_i,theta_o,phi_o,value\n", file);
	for (int n = 0; n < 8 * 9 * 10; n++)
		fprintf(file, "%d,0,%d,%d,%.6g\n", 10 + n / 90 * 10, 5 + n / 10 % 9 * 10, n % 10 * 20,
			0.004 + 0.001 * random_unit(&seed));
	fputs("80,0,79,180,600\n70,0,68.9,180,16\n60,0,59.3,180,8\n50,0,50.2,180,8\n40,0,41.4,180,.3\n", file);
	assert_int_equal(fclose(file), 0);
	stdfit("mirror.csv -q --ndf ggx -o mirror-fits.csv");
	expect_code(0);
	struct csv_table fits = read_table("mirror-fits.csv");
	/* Lambert alone has 1. */
	check_between(result_number(fits.row[0], RESULT_ERROR), 0, 0.025, "E");
	check_between(result_number(fits.row[0], RESULT_SIGMA), 0.003, 0.008, "sigma");
	csv_table_free(&fits);
}

static void wrong_usage_is_refused(void **state)
{
	(void)state;
	make_files();
	stdfit("convert gray.dat");
	expect_error(2, "expected IN and OUT, found 1 names");
	stdfit("convert gray.dat a.csv b.csv");
	expect_error(2, "expected IN and OUT, found 3 names");
	stdfit("convert gray.dat a.txt");
	expect_error(2, "expected OUT.csv, OUT.binary or OUT.bsdf");
	stdfit("convert paint.csv ./paint.csv");
	expect_error(2, "OUT names a file that is to be read");
	stdfit("convert gray.dat a.csv --phi 360");
	expect_error(2, "--phi means nothing but for a MERL file");
	stdfit("convert none.dat a.csv");
	expect_error(1, "cannot read 'none.dat': No such file");
	stdfit("convert gray.dat nowhere/a.csv");
	expect_error(1, "cannot write 'nowhere/a.csv'");
	stdfit("info gray.dat --quantity radiance");
	expect_error(2, "expected one of file, brdf, brdf_cos, reflectance_factor");
	stdfit("info gray.dat --gamut x");
	expect_error(2, "expected one of clip, mask");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_table_stays_itself),
		cmocka_unit_test(both_orders_have_their_mean),
		cmocka_unit_test(a_table_has_two_values_of_phi),
		cmocka_unit_test(samples_of_a_table_come_back),
		cmocka_unit_test(a_merl_file_takes_no_samples),
		cmocka_unit_test(convert_writes_samples_and_tables),
		cmocka_unit_test(tables_become_rgl_files),
		cmocka_unit_test(turned_samples_become_rgl_files),
		cmocka_unit_test(info_tells_what_is_in_a_file),
		cmocka_unit_test(a_directory_has_the_known_files),
		cmocka_unit_test(noisy_samples_give_their_parameters_back),
		cmocka_unit_test(one_bright_entry_is_not_lost),
		cmocka_unit_test(wrong_usage_is_refused),
	};
	return cmocka_run_group_tests(tests, enter_directory, leave_directory);
}
