/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit fit and eval of scattered samples with axes, as a user has them: a CSV in, a result table out. */
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
	expect_error(2, "--ndf gtr does not allow these parameters");
	stdfit("synth flat.binary --ndf ggx --sigma 0.3 --ks 0.5");
	expect_code(0);
	stdfit("fit flat.binary --anisotropic --ndf ggx -q");
	expect_error(1, "a table over theta_h, theta_d and phi_d is isotropic");
	stdfit("eval flat.binary --ndf ggx --sigma 0.2,0.1 --ks 1");
	expect_error(1, "a table over theta_h, theta_d and phi_d is isotropic");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_have_axes),
		cmocka_unit_test(an_isotropic_row_has_none),
		cmocka_unit_test(eval_takes_axes),
		cmocka_unit_test(what_has_no_axes_is_refused),
	};

	return cmocka_run_group_tests_name("anisotropic", tests, set_up, leave_directory);
}
