/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit fit and eval of scattered samples with axes, as a user has them: a CSV in, a result table out. */
#include "data_readers/measurement_read.h"
#include "make_scattered.h"
#include "run_program.h"

static struct cook_torrance truth;

static void write_samples(const char *path, size_t n)
{
	struct measurement measurement = make_scattered(&truth, n, 0.05, 7);
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	fprintf(file, "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b\n");
	for (size_t e = 0; e < n; e++) {
		const struct scattered *s = measurement.scattered;

		fprintf(file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.9g,%.9g,%.9g\n", s->wi[e].x, s->wi[e].y,
			s->wi[e].z, s->wo[e].x, s->wo[e].y, s->wo[e].z, (double)s->value[0][e], (double)s->value[1][e],
			(double)s->value[2][e]);
	}
	assert_int_equal(fclose(file), 0);
	measurement_free(&measurement);
}

static int set_up(void **state)
{
	truth = make_model("ggx", 0.2, 2, 1.5);
	if (ndf_init(&truth.ndf, ndf_find("ggx"), 0.3, 0.1, NAN) != STATUS_OK ||
	    ndf_turn(&truth.ndf, 20) != STATUS_OK || enter_directory(state))
		return -1;
	write_samples("brushed.csv", 1500);
	return 0;
}

static void rows_have_axes(void **state)
{
	(void)state;
	stdfit("fit brushed.csv --anisotropic --ndf ggx -q -o fits.csv");
	expect_code(0);
	struct csv_table table = read_table("fits.csv");
	char *const *row = table.row[0];

	assert_int_equal(table.n_rows, 1);
	const double sigma_x = result_number(row, RESULT_SIGMA_X), sigma_y = result_number(row, RESULT_SIGMA_Y);
	const double error = result_number(row, RESULT_ERROR);

	check_rel(sigma_x, 0.3, 0.05, "sigma_x");
	check_rel(sigma_y, 0.1, 0.05, "sigma_y");
	check_rel(result_number(row, RESULT_SIGMA), sqrt(sigma_x * sigma_y), 1e-12, "sigma");
	check_abs(result_number(row, RESULT_ANGLE), 20, 1, "angle");
	assert_true(error < result_number(row, RESULT_ERROR_ISOTROPIC));
	assert_non_null(strstr(row[RESULT_OPTIONS], "sigma=free anisotropic=yes angle=free"));
	/* Its largest albedo lies between what the terms allow. */
	check_between(result_number(row, RESULT_ALBEDO_G), 0.12, 0.75, "albedo");
	assert_string_equal(row[RESULT_ENERGY], "ok");
	/* The model of the row is the one that was fitted. */
	stdfit("eval brushed.csv --from fits.csv --json");
	expect_code(0);
	char part[64];
	snprintf(part, sizeof part, "\"error_none\": %.12g", error);
	part[strlen(part) - 2] = '\0';
	expect_out(part);
	csv_table_free(&table);
	/* And a row that is there is not fitted again. */
	char *before = slurp("fits.csv");
	stdfit("fit brushed.csv --anisotropic --ndf ggx -q -o fits.csv --resume");
	expect_code(0);
	char *after = slurp("fits.csv");
	assert_string_equal(before, after);
	free(before);
	free(after);
}

static void a_readable_table_has_axes(void **state)
{
	(void)state;
	stdfit("fit brushed.csv --anisotropic --ndf ggx --sigma 0.3,0.1 --angle 20 -q --table");
	expect_code(0);
	expect_out("  (sigma_x 0.3, sigma_y 0.1, angle 20)\n");
	stdfit("fit brushed.csv --ndf ggx --sigma 0.3 -q --table");
	expect_code(0);
	assert_null(strstr(last.out, "sigma_x"));
}

static void an_isotropic_row_has_none(void **state)
{
	(void)state;
	stdfit("fit brushed.csv --no-specular -q -o plain.csv");
	expect_code(0);
	struct csv_table table = read_table("plain.csv");

	for (int c = RESULT_SIGMA_X; c <= RESULT_ERROR_ISOTROPIC; c++)
		assert_string_equal(table.row[0][c], "");
	csv_table_free(&table);
}

static void eval_takes_axes(void **state)
{
	(void)state;
	stdfit("eval brushed.csv --ndf ggx --sigma 0.3,0.1 --angle 20 --ks 0.42,0.63,0.77 --kd 0.31,0.12,0.047 --json");
	expect_code(0);
	/* 5 % of noise on what is the model itself. */
	expect_out("\"error_none\": 0.0");
	stdfit("eval brushed.csv --ndf ggx --sigma 0.3,0.1 --angle -70 --ks 0.42,0.63,0.77 --kd 0.31,0.12,0.047 "
	       "--json");
	expect_code(0);
	assert_null(strstr(last.out, "\"error_none\": 0.0"));
}

/* Measured and model: one picture with the right axes, from samples and from the interpolant of an RGL file. */
static void spheres_of_samples_turn(void **state)
{
	(void)state;
#define TURNED "--ndf ggx --sigma 0.4,0.15 --kd 0.3,0.1,0.05 --ks 0.5 "
#define SPHERE " --size 24 --samples 8 --json --angle "
	stdfit("synth turned.csv " TURNED "--angle 25");
	stdfit("export --format bsdf-rgb -o turned.bsdf --accuracy 12 -q " TURNED "--angle 25");
	expect_code(0);
	for (int i = 0; i < 2; i++) {
		const char *const command[] = {"render turned.csv " TURNED SPHERE, "render turned.bsdf " TURNED SPHERE};
		double delta_e[2];

		for (int wrong = 0; wrong < 2; wrong++) {
			char arguments[160];

			snprintf(arguments, sizeof arguments, "%s %d", command[i], wrong ? -25 : 25);
			stdfit(arguments);
			expect_code(0);
			const char *at = strstr(last.out, "\"delta_e\": ");
			assert_non_null(at);
			delta_e[wrong] = strtod(at + 11, NULL);
		}
		check_between(delta_e[0], 0, 0.6, command[i]);
		assert_true(delta_e[1] > 2 * delta_e[0]);
	}
}

static void what_has_no_axes_is_refused(void **state)
{
	(void)state;
	stdfit("fit brushed.csv --anisotropic --ndf gtr");
	expect_error(2, "gtr has one roughness: it cannot be anisotropic");
	stdfit("fit brushed.csv --anisotropic --sigma 0.2");
	expect_error(2, "--sigma with --anisotropic takes SX,SY");
	stdfit("fit brushed.csv --sigma 0.2,0.3");
	expect_error(2, "--sigma SX,SY needs --anisotropic");
	stdfit("fit brushed.csv --angle 10");
	expect_error(2, "--angle needs --anisotropic");
	stdfit("fit brushed.csv --anisotropic --sigma 0.2,");
	expect_error(2, "bad value '0.2,' for --sigma");
	stdfit("eval brushed.csv --ndf ggx --sigma 0.2 --angle 10 --ks 1");
	expect_error(2, "--angle needs --sigma SX,SY");
	stdfit("eval brushed.csv --ndf gtr --sigma 0.2,0.1 --gamma 2 --ks 1");
	expect_error(2, "gtr takes one sigma, the same in all directions");
	stdfit("synth flat.binary --ndf ggx --sigma 0.3 --ks 0.5");
	expect_code(0);
	stdfit("fit flat.binary --anisotropic --ndf ggx -q");
	expect_error(1, "a table over theta_h, theta_d and phi_d is isotropic");
	stdfit("synth axes.binary --ndf ggx --sigma 0.2,0.1 --ks 1");
	expect_error(2, "a MERL file is isotropic: expected OUT.csv with --sigma SX,SY");
	stdfit("synth axes.csv --ndf ggx --sigma 0.2,0.1 --ks 1 --phi 360");
	expect_error(2, "--phi means nothing for a CSV");
	stdfit("synth axes.csv --ndf ggx --sigma 0.2,0.1 --ks 1 --bins centre");
	expect_error(2, "--bins means nothing for a CSV");
	stdfit("eval flat.binary --ndf ggx --sigma 0.2,0.1 --ks 1");
	expect_error(1, "a table over theta_h, theta_d and phi_d is isotropic");
}

static struct measurement read_samples(const char *path)
{
	struct measurement measurement;
	struct error error;

	if (measurement_read(path, NULL, &measurement, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	assert_non_null(measurement.scattered);
	return measurement;
}

/* GGX of sigma .3 along azimuth 30 degrees, .1 across, seen from the normal along one of these: D G1 / (4 cos_o). */
static double along_an_axis(double sigma, struct vec3 wo)
{
	const double theta_o = acos(wo.z), tangent = tan(theta_o / 2) / sigma, cosine = cos(theta_o / 2);
	const double D = 1 / (M_PI * 0.3 * 0.1 * pow(cosine, 4) * pow(1 + tangent * tangent, 2));
	const double G1 = 2 / (1 + sqrt(1 + pow(sigma * tan(theta_o), 2)));

	return D * G1 / (4 * wo.z);
}

static void synth_writes_samples_with_axes(void **state)
{
	(void)state;
	int n_along = 0, n_across = 0;

	stdfit("synth axes.csv --ndf ggx --sigma 0.3,0.1 --angle 30 --ks 1 --fresnel none");
	expect_code(0);
	struct measurement m = read_samples("axes.csv");
	const struct scattered *s = m.scattered;

	assert_int_equal(s->symmetry, SYMMETRY_ANISOTROPIC);
	for (size_t e = 0; e < s->n; e++) {
		const double azimuth = atan2(s->wo[e].y, s->wo[e].x) * 180 / M_PI;
		const bool along = fabs(azimuth - 30) < 1e-6, across = fabs(azimuth - 120) < 1e-6;

		if (s->wi[e].z < 1 || !(along || across))
			continue;
		check_rel((double)s->value[1][e], along_an_axis(along ? 0.3 : 0.1, s->wo[e]), 1e-6, "along an axis");
		n_along += along;
		n_across += across;
	}
	assert_true(n_along > 10 && n_across > 10);
	measurement_free(&m);
}

/* The integral of cos_i cos_o over both hemispheres is pi^2. */
static void synth_knows_its_solid_angles(void **state)
{
	static const char *const sigma[] = {"0.3", "0.3,0.2"};

	(void)state;
	for (int a = 0; a < 2; a++) {
		char command[128];
		double sum = 0;

		snprintf(command, sizeof command, "synth white.csv --kd 1 --ks 1e-3 --sigma %s --gamma 2", sigma[a]);
		stdfit(command);
		expect_code(0);
		struct measurement m = read_samples("white.csv");
		const struct scattered *s = m.scattered;

		assert_int_equal(s->symmetry, a ? SYMMETRY_ANISOTROPIC : SYMMETRY_ISOTROPIC);
		for (size_t e = 0; e < s->n; e++)
			sum += (double)s->solid_angle[e] * s->wi[e].z * s->wo[e].z;
		check_rel(sum, M_PI * M_PI, 0.005, "the integral of both cosines");
		measurement_free(&m);
	}
}

static void a_fit_finds_what_synth_wrote(void **state)
{
	(void)state;
	stdfit("synth noisy.csv --sigma 0.3,0.1 --angle 20 --gamma 2.5 --kd 0.3,0.1,0.05 --ks 0.5 --noise 0.05");
	expect_code(0);
	stdfit("fit noisy.csv --anisotropic --ndf std -q -o found.csv");
	expect_code(0);
	struct csv_table table = read_table("found.csv");
	char *const *row = table.row[0];

	check_rel(result_number(row, RESULT_SIGMA_X), 0.3, 0.02, "sigma_x");
	check_rel(result_number(row, RESULT_SIGMA_Y), 0.1, 0.02, "sigma_y");
	check_rel(result_number(row, RESULT_ANGLE), 20, 0.02, "angle");
	check_rel(result_number(row, RESULT_GAMMA), 2.5, 0.02, "gamma");
	check_rel(result_number(row, RESULT_IOR), 1.5, 0.02, "n");
	check_rel(result_number(row, RESULT_KD_G), 0.1, 0.02, "kd_g");
	check_rel(result_number(row, RESULT_KS_B), 0.5, 0.02, "ks_b");
	csv_table_free(&table);
	/* Without noise an isotropic model is its own fit. */
	stdfit("synth plain.csv --sigma 0.2 --ndf ggx --kd 0.3 --ks 0.5");
	expect_code(0);
	stdfit("eval plain.csv --sigma 0.2 --ndf ggx --kd 0.3 --ks 0.5 --json");
	expect_out("e-08, \"error_cosine\":");
}

/* GGX has nothing for facets that lean. */
static void facets_that_lean_are_found(void **state)
{
	struct cook_torrance level = truth;

	(void)state;
	assert_int_equal(ndf_init(&truth.ndf, ndf_find("ellipsoid"), 0.3, 0.1, NAN), STATUS_OK);
	assert_int_equal(ndf_turn(&truth.ndf, 20), STATUS_OK);
	assert_int_equal(ndf_tilt(&truth.ndf, 0.15, -0.05), STATUS_OK);
	write_samples("leaning.csv", 1500);
	truth = level;
	stdfit("fit leaning.csv --anisotropic --ndf ggx,ellipsoid -q -o leaning.fits.csv");
	expect_code(0);
	struct csv_table table = read_table("leaning.fits.csv");
	char *const *ellipsoid = table.row[0], *const *ggx = table.row[1];
	double tilt_x, tilt_y;

	assert_string_equal(ellipsoid[RESULT_NDF], "ellipsoid");
	assert_true(result_param(ellipsoid[RESULT_PARAMS], "tilt_x", &tilt_x));
	assert_true(result_param(ellipsoid[RESULT_PARAMS], "tilt_y", &tilt_y));
	check_abs(tilt_x, 0.15, 0.005, "tilt_x");
	check_abs(tilt_y, -0.05, 0.005, "tilt_y");
	check_rel(result_number(ellipsoid, RESULT_SIGMA_X), 0.3, 0.05, "sigma_x");
	check_rel(result_number(ellipsoid, RESULT_SIGMA_Y), 0.1, 0.05, "sigma_y");
	check_abs(result_number(ellipsoid, RESULT_ANGLE), 20, 1, "angle");
	const double error = result_number(ellipsoid, RESULT_ERROR);

	assert_true(error < 0.5 * result_number(ggx, RESULT_ERROR));
	/* 5 % of noise: the mean of |g|. */
	check_between(error, 0.03, 0.045, "E");
	assert_true(result_number(ellipsoid, RESULT_ERROR_ISOTROPIC) == result_number(ggx, RESULT_ERROR_ISOTROPIC));
	assert_string_equal(ggx[RESULT_PARAMS], "");
	csv_table_free(&table);
	/* The model of the row is the one that was fitted. */
	stdfit("eval leaning.csv --from leaning.fits.csv --ndf ellipsoid --json");
	expect_code(0);
	check_rel(strtod(strstr(last.out, "\"error_none\": ") + 14, NULL), error, 1e-12, "E of the row");
	stdfit("ndf --from leaning.fits.csv --row 1 --theta 10");
	expect_out("tilt_x=0.1");
}

/* Where facets are level, the tilt is none, and E not above GGX's. */
static void level_facets_stay_level(void **state)
{
	(void)state;
	stdfit("fit brushed.csv --anisotropic --ndf ggx,ellipsoid -q -o level.fits.csv");
	expect_code(0);
	struct csv_table table = read_table("level.fits.csv");
	char *const *ellipsoid = table.row[0], *const *ggx = table.row[1];
	double tilt_x, tilt_y;

	assert_true(result_param(ellipsoid[RESULT_PARAMS], "tilt_x", &tilt_x));
	assert_true(result_param(ellipsoid[RESULT_PARAMS], "tilt_y", &tilt_y));
	check_abs(hypot(tilt_x, tilt_y), 0, 0.005, "tilt");
	assert_true(result_number(ellipsoid, RESULT_ERROR) <= result_number(ggx, RESULT_ERROR));
	csv_table_free(&table);
	/* Without axes it is GGX. */
	stdfit("fit brushed.csv --ndf ggx,ellipsoid -q -o round.fits.csv");
	expect_code(0);
	table = read_table("round.fits.csv");
	for (enum result_column c = RESULT_ERROR; c <= RESULT_LOG_ERROR; c++)
		assert_string_equal(table.row[0][c], table.row[1][c]);
	csv_table_free(&table);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_have_axes),
		cmocka_unit_test(a_readable_table_has_axes),
		cmocka_unit_test(an_isotropic_row_has_none),
		cmocka_unit_test(eval_takes_axes),
		cmocka_unit_test(synth_writes_samples_with_axes),
		cmocka_unit_test(synth_knows_its_solid_angles),
		cmocka_unit_test(a_fit_finds_what_synth_wrote),
		cmocka_unit_test(spheres_of_samples_turn),
		cmocka_unit_test(what_has_no_axes_is_refused),
	};

	const struct CMUnitTest long_tests[] = {
		cmocka_unit_test(facets_that_lean_are_found),
		cmocka_unit_test(level_facets_stay_level),
	};
	const int failed = cmocka_run_group_tests_name("anisotropic", tests, set_up, NULL);

	if (failed || case_step(2) > 1) {
		(void)leave_directory(NULL);
		return failed;
	}
	return cmocka_run_group_tests_name("anisotropic_long", long_tests, NULL, leave_directory);
}
