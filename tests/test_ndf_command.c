/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit ndf and stdfit sample, through their CSV: golden rows from standard input, the numbers of the library to the
 * bit, samples against their density and their weights against the albedo. Runs $STDFIT or build/stdfit. */
#include "chi_square.h"
#include "fit/search/free_form.h"
#include "run_program.h"
#include "src/energy.h"
#include "src/ndf_cdf.h"
#include "src/ndf_slopes.h"
#include "src/pwl.h"
#include "src/sampling.h"
#include "src/vndf.h"
#include <jansson.h>

enum {
	IN_NAME,
	IN_D,
	IN_P22,
	IN_P2,
	IN_LAMBDA,
	IN_G1,
	IN_PDF,
	IN_VISIBLE,
	IN_WEIGHT,
	IN_THETA,
	IN_CDF,
	IN_CDF_PHI,
	IN_CDF_THETA,
	IN_VISIBLE_CDF,
	IN_ACROSS_CDF,
	IN_MOMENT_2,
	IN_MOMENT_4,
	IN_KURTOSIS,
	IN_COLUMNS
};

static const struct csv_column ndf_columns[IN_COLUMNS] = {
	{"ndf", false},           {"D", true},           {"P22", true},        {"P2", true},
	{"Lambda", true},         {"G1", true},          {"pdf", true},        {"visible_pdf", true},
	{"visible_weight", true}, {"theta", true},       {"cdf", true},        {"cdf_phi", true},
	{"cdf_theta", true},      {"visible_cdf", true}, {"across_cdf", true}, {"moment_2", true},
	{"moment_4", true},       {"kurtosis", true},
};

static char *top; /* of the repository */

/* How many values there are in JSON that is one array. */
static size_t json_array_length(const char *text)
{
	json_error_t error;
	json_t *array = json_loads(text, JSON_REJECT_DUPLICATES, &error);

	if (!json_is_array(array))
		fail_msg("line %d: %s", error.line, error.text);
	const size_t n = json_array_size(array);
	json_decref(array);
	return n;
}

/* What the program wrote, as a table. */
static struct csv_table output(const struct csv_column *columns, int n)
{
	struct csv_table table = csv_table_make(columns, n);
	struct error error;

	if (csv_table_read(&table, "stdout", n, NULL, &error))
		fail_msg("%s; %s", error.text, last.err);
	return table;
}

static struct csv_table ndf_output(void)
{
	return output(ndf_columns, IN_COLUMNS);
}

static double cell(const struct csv_table *table, size_t row, int column)
{
	double x = NAN;

	assert_true(row < table->n_rows);
	assert_true(csv_parse_number(table->row[row][column], &x));
	return x;
}

/* Rows of a golden table, as the columns `header`, of an NDF; then the columns D, Lambda, G1 of the answer. */
static void golden_rows(const char *ndf, const char *file, const char *names, const char *header, int n_given, int at_D,
			int at_lambda, int at_G1)
{
	char path[4096], *want[3] = {"D", "Lambda", "G1"};
	const int at[3] = {at_D, at_lambda, at_G1}, column[3] = {IN_D, IN_LAMBDA, IN_G1};
	size_t i = 0;
	FILE *in = fopen("in.csv", "w");

	snprintf(path, sizeof path, "%s/tests/golden/%s", top, file);
	struct golden golden = golden_open(path, names);
	assert_non_null(in);
	fprintf(in, "ndf,%s\n", header);
	while (golden_next(&golden)) {
		fputs(ndf, in);
		for (int k = 0; k < n_given; k++)
			fprintf(in, ",%s", golden.text[k]);
		fputc('\n', in);
	}
	assert_int_equal(fclose(in), 0);
	shell("exec \"$STDFIT\" ndf - <in.csv");
	expect_code(0);
	struct csv_table table = ndf_output();
	golden = golden_open(path, names);
	for (; golden_next(&golden); i++)
		for (int k = 0; k < 3; k++) {
			char label[400];
			snprintf(label, sizeof label, "%s of %s", want[k], golden.label);
			if (at[k] < 0 || !(golden.value[at[k]] > 1e-290))
				continue;
			const double x = golden.value[at[k]];
			/* The angle is rounded on its way into a direction. */
			check_rel(cell(&table, i, column[k]), x, 1e-13 + 3e-16 * fabs(log(x)), label);
		}
	assert_int_equal(table.n_rows, i);
	csv_table_free(&table);
}

static void values_match_golden_rows(void **state)
{
	(void)state;
	golden_rows("std", "std_D.csv", "gamma,sigma,theta_deg,D", "gamma,sigma,theta", 3, 3, -1, -1);
	golden_rows("std", "aniso_std.csv", "gamma,sigma_x,sigma_y,theta_deg,phi_deg,D,Lambda,G1",
		    "gamma,sigma,sigma_y,theta,phi", 5, 5, 6, 7);
	golden_rows("gtr", "gtr_D.csv", "gamma,sigma,theta_deg,D", "gamma,sigma,theta", 3, 3, -1, -1);
}

static void same(const struct csv_table *table, size_t row, int column, double want)
{
	char text[CSV_NUMBER_SIZE];

	assert_string_equal(table->row[row][column], csv_number(text, want));
}

/* Every distribution and form, over all angles. */
static void printed_values_are_those_of_the_library(void **state)
{
	static const struct {
		const char *arguments, *ndf;
		double sigma_x, sigma_y, gamma;
		enum lambda_form form;
	} cases[] = {
		{"std --sigma 0.2,0.3 --gamma 1.7", "std", 0.2, 0.3, 1.7, LAMBDA_EXACT},
		{"std --sigma 0.2 --gamma 3 --lambda integer", "std", 0.2, 0.2, 3, LAMBDA_INTEGER},
		{"std --sigma 0.2 --gamma 3.5 --lambda half-integer", "std", 0.2, 0.2, 3.5, LAMBDA_HALF_INTEGER},
		{"std --sigma 0.2 --gamma 3.3 --lambda 2f1", "std", 0.2, 0.2, 3.3, LAMBDA_2F1},
		{"std --sigma 0.2 --gamma inf --lambda rational", "std", 0.2, 0.2, INFINITY, LAMBDA_RATIONAL},
		{"ggx --sigma 0.2,0.1", "ggx", 0.2, 0.1, 2, LAMBDA_EXACT},
		{"beckmann --sigma 0.4", "beckmann", 0.4, 0.4, INFINITY, LAMBDA_EXACT},
		{"gtr --sigma 0.4 --gamma 1.1", "gtr", 0.4, 0.4, 1.1, LAMBDA_EXACT},
		{"hyper-cauchy --sigma 0.4 --gamma 2.1", "hyper-cauchy", 0.4, 0.4, 2.1, LAMBDA_EXACT},
		{"t-family --sigma 0.4 --gamma 2.1", "t-family", 0.4, 0.4, 2.1, LAMBDA_EXACT},
		{"low --sigma 0.4 --gamma 0.8", "low", 0.4, 0.4, 0.8, LAMBDA_EXACT},
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const struct vec3 wi = vec3_from_spherical_deg(35, 0);
		struct ndf ndf;
		char *command;

		assert_int_equal(
			ndf_init(&ndf, ndf_find(cases[i].ndf), cases[i].sigma_x, cases[i].sigma_y, cases[i].gamma), 0);
		if (cases[i].form != LAMBDA_EXACT)
			assert_int_equal(ndf_set_lambda_form(&ndf, cases[i].form), STATUS_OK);
		assert_true(asprintf(&command, "ndf %s --theta 0:90:1 --phi 33 --theta-i 35", cases[i].arguments) > 0);
		stdfit(command);
		free(command);
		expect_code(0);
		struct csv_table table = ndf_output();
		assert_int_equal(table.n_rows, 91);
		for (size_t row = 0; row < 91; row++) {
			const struct vec3 m = vec3_from_spherical_deg((double)row, 33);
			const double pdf = vndf_pdf(&ndf, wi, m);

			assert_string_equal(table.row[row][IN_NAME], cases[i].ndf);
			same(&table, row, IN_THETA, (double)row);
			same(&table, row, IN_D, ndf_D(&ndf, m));
			same(&table, row, IN_LAMBDA, ndf_lambda(&ndf, m));
			same(&table, row, IN_G1, ndf_G1(&ndf, m));
			same(&table, row, IN_PDF, ndf_pdf(&ndf, m));
			same(&table, row, IN_VISIBLE, pdf);
			same(&table, row, IN_WEIGHT, pdf > 0 ? vndf_weight(&ndf, GAF_UNCORRELATED, wi, m, pdf) : 0);
			if (row == 90)
				continue;
			same(&table, row, IN_P22, ndf_P22(&ndf, -m.x / m.z, -m.y / m.z));
			same(&table, row, IN_P2, ndf_P2(&ndf, 33 * M_PI / 180, hypot(m.x, m.y) / m.z));
		}
		csv_table_free(&table);
	}
}

/* CDFs and moments, of the azimuth of incidence that was asked for. */
static void cumulative_values_are_those_of_the_library(void **state)
{
	const struct vec3 wi = vec3_from_spherical_deg(35, -70);
	struct ndf ndf;

	(void)state;
	assert_int_equal(ndf_init(&ndf, ndf_find("std"), 0.2, 0.5, 4), STATUS_OK);
	stdfit("ndf std --sigma 0.2,0.5 --gamma 4 --theta 0:90:5 --phi 33 --theta-i 35 --phi-i -70");
	expect_code(0);
	struct csv_table table = ndf_output();
	for (size_t row = 0; row < table.n_rows; row++) {
		const double radians = M_PI / 180, theta = 5 * (double)row * radians, phi = 33 * radians;
		const struct vec3 m = vec3_from_spherical_deg(5 * (double)row, 33);
		double along, across, moment;

		same(&table, row, IN_VISIBLE, vndf_pdf(&ndf, wi, m));
		same(&table, row, IN_CDF, ndf_cdf(&ndf, theta, phi));
		same(&table, row, IN_CDF_PHI, ndf_cdf_phi(&ndf, phi));
		same(&table, row, IN_CDF_THETA, ndf_cdf_theta(&ndf, theta, phi));
		vndf_cdf(&ndf, wi, m, &along, &across);
		same(&table, row, IN_VISIBLE_CDF, along);
		same(&table, row, IN_ACROSS_CDF, across);
		assert_int_equal(ndf_moment(&ndf, phi, 2, &moment), STATUS_OK);
		same(&table, row, IN_MOMENT_2, moment);
		assert_int_equal(ndf_moment(&ndf, phi, 4, &moment), STATUS_OK);
		same(&table, row, IN_MOMENT_4, moment);
		same(&table, row, IN_KURTOSIS, 3);
	}
	csv_table_free(&table);
	/* Of gamma 2.5 there is a variance, and no more. */
	stdfit("ndf std --sigma 0.2 --gamma 2.5 --theta 20");
	expect_code(0);
	table = ndf_output();
	check_rel(cell(&table, 0, IN_MOMENT_2), 0.5 * 0.04 * 1.5 / 0.5, 1e-14, "variance");
	assert_string_equal(table.row[0][IN_MOMENT_4], "");
	assert_string_equal(table.row[0][IN_KURTOSIS], "");
	assert_string_equal(table.row[0][IN_VISIBLE_CDF], "");
	csv_table_free(&table);
}

/* Golden moments: B = 1/(sigma^2 (gamma-1)), C = gamma. */
static void moments_match_golden_rows(void **state)
{
	char path[4096];
	size_t i = 0;
	FILE *in = fopen("in.csv", "w");

	(void)state;
	snprintf(path, sizeof path, "%s/tests/golden/moments.csv", top);
	struct golden golden = golden_open(path, "B,C,nu0,nu2,nu4,nu6,nu8,excess_kurtosis");
	assert_non_null(in);
	fputs("ndf,sigma,gamma,theta\n", in);
	while (golden_next(&golden)) {
		const double B = golden.value[0], C = golden.value[1];

		fprintf(in, "std,%.17g,%.17g,0\n", sqrt(1 / (B * (C - 1))), C);
	}
	assert_int_equal(fclose(in), 0);
	shell("exec \"$STDFIT\" ndf - <in.csv");
	expect_code(0);
	struct csv_table table = ndf_output();
	golden = golden_open(path, "B,C,nu0,nu2,nu4,nu6,nu8,excess_kurtosis");
	for (; golden_next(&golden); i++) {
		check_rel(cell(&table, i, IN_MOMENT_2), golden.value[3], 1e-13, golden.label);
		check_rel(cell(&table, i, IN_MOMENT_4), golden.value[4], 1e-13, golden.label);
		check_rel(cell(&table, i, IN_KURTOSIS), golden.value[7], 1e-13, golden.label);
	}
	assert_int_equal(table.n_rows, i);
	csv_table_free(&table);
}

/* At 90 degrees stands what the values tend to. */
static void grazing_incidence_is_a_limit(void **state)
{
	static const char *const cases[] = {
		"std --sigma 0.2,0.5 --gamma 1.7",
		"ggx --sigma 0.5",
		"beckmann --sigma 0.3,0.6",
		"gtr --sigma 0.4 --gamma 1.3",
		"low --sigma 0.4 --gamma 1.5",
		"t-family --sigma 0.4,0.2 --gamma 3 --params x=0.5",
		"ellipsoid --params 'alpha_x=0.3;alpha_y=0.5;theta_x=8'",
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct csv_table table[2];

		for (int k = 0; k < 2; k++) {
			char *command;

			assert_true(asprintf(&command, "ndf %s --theta 10:80:10 --phi 20 --phi-i 40 --theta-i %s",
					     cases[i], k ? "90" : "89.9999999") > 0);
			stdfit(command);
			free(command);
			expect_code(0);
			table[k] = ndf_output();
		}
		for (size_t row = 0; row < 8; row++) {
			const double near = cell(&table[0], row, IN_VISIBLE);

			assert_true(near > 0);
			check_rel(cell(&table[1], row, IN_VISIBLE), near, 1e-6, cases[i]);
			check_rel(cell(&table[1], row, IN_WEIGHT), cell(&table[0], row, IN_WEIGHT), 1e-6, cases[i]);
		}
		csv_table_free(&table[0]);
		csv_table_free(&table[1]);
	}
}

/* S1's own evaluation, through its G1 and through G. */
static void pl_takes_trapezoids(void **state)
{
	(void)state;
	FILE *in = fopen("in.csv", "w");
	assert_non_null(in);
	fputs("ndf,theta,lambda,params\n", in);
	for (int form = 0; form < 2; form++) {
		fprintf(in, "pl,70,%s,\"", form ? "trapezoid" : "exact");
		for (int i = 0; i <= 90; i++)
			fprintf(in, "%sD%d=%.17g", i ? ";" : "", i, exp(-i * i / 900.0));
		fputs("\"\n", in);
	}
	assert_int_equal(fclose(in), 0);
	shell("exec \"$STDFIT\" ndf - <in.csv");
	expect_code(0);
	struct csv_table table = ndf_output();
	double D[FREE_FORM_VALUES];
	struct pwl pwl;
	for (int i = 0; i <= 90; i++)
		D[i] = exp(-i * i / 900.0);
	assert_int_equal(free_form_pwl(BINS_NODE, D, &pwl), STATUS_OK);
	const struct vec3 w = vec3_from_spherical_deg(70, 0);
	check_rel(cell(&table, 0, IN_G1), pwl_G1(&pwl, w), 1e-14, "exact");
	check_rel(cell(&table, 1, IN_G1), pwl_G1_trapezoid(&pwl, w), 1e-14, "trapezoid");
	check_between(fabs(cell(&table, 1, IN_G1) / cell(&table, 0, IN_G1) - 1), 1e-7, 1e-3, "error of the trapezoids");
	pwl_free(&pwl);
	csv_table_free(&table);
}

/* params say what sigma and gamma cannot. */
static void own_parameters_are_taken(void **state)
{
	struct csv_table table;
	struct ndf ndf;

	(void)state;
	stdfit("ndf low --params 'B=40;C=1.3' --theta 10,20");
	expect_code(0);
	table = ndf_output();
	assert_int_equal(ndf_init_params(&ndf, ndf_find("low"), (double[]){40, 1.3}), STATUS_OK);
	same(&table, 1, IN_D, ndf_D(&ndf, vec3_from_spherical_deg(20, 0)));
	csv_table_free(&table);
	stdfit("ndf t-family --sigma 0.3 --gamma 4 --params x=3 --theta 10");
	expect_code(0);
	table = ndf_output();
	assert_int_equal(ndf_init_params(&ndf, ndf_find("t-family"), (double[]){0.3, 4, 3}), STATUS_OK);
	same(&table, 0, IN_G1, ndf_G1(&ndf, vec3_from_spherical_deg(10, 0)));
	csv_table_free(&table);
	stdfit("ndf t-family --sigma 0.3,0.7 --gamma 4 --params x=3 --theta 10 --phi 60");
	expect_code(0);
	table = ndf_output();
	assert_int_equal(ndf_init_params_anisotropic(&ndf, ndf_find("t-family"), (double[]){0.3, 4, 3}, 0.7),
			 STATUS_OK);
	same(&table, 0, IN_D, ndf_D(&ndf, vec3_from_spherical_deg(10, 60)));
	csv_table_free(&table);
	/* Without rotation the ellipsoid is anisotropic GGX. */
	stdfit("ndf ellipsoid --params 'alpha_x=0.2;alpha_y=0.5' --theta 5:85:5 --phi 20 --theta-i 40");
	expect_code(0);
	table = ndf_output();
	assert_int_equal(ndf_init(&ndf, ndf_find("ggx"), 0.2, 0.5, 2), STATUS_OK);
	for (size_t i = 0; i < table.n_rows; i++) {
		const struct vec3 m = vec3_from_spherical_deg(5 + 5 * (double)i, 20),
				  wi = vec3_from_spherical_deg(40, 0);

		check_rel(cell(&table, i, IN_D), ndf_D(&ndf, m), 1e-13, "ellipsoid D");
		check_rel(cell(&table, i, IN_P22), ndf_D(&ndf, m) * pow(m.z, 4), 1e-13, "ellipsoid P22");
		check_rel(cell(&table, i, IN_G1), ndf_G1(&ndf, m), 1e-13, "ellipsoid G1");
		check_rel(cell(&table, i, IN_LAMBDA), ndf_lambda(&ndf, m), 1e-10, "ellipsoid Lambda");
		check_rel(cell(&table, i, IN_VISIBLE), vndf_pdf(&ndf, wi, m), 1e-12, "ellipsoid visible pdf");
	}
	csv_table_free(&table);
}

/* pl from its values, which are normalised. */
static void nodes_of_pl_are_normalised(void **state)
{
	char *command = NULL;
	size_t size;
	FILE *file = open_memstream(&command, &size);

	(void)state;
	assert_non_null(file);
	fprintf(file, "ndf pl --theta 0,10,40,89 --params 'D0=2");
	for (int i = 1; i <= 90; i++)
		fprintf(file, ";D%d=%.17g", i, 2 * exp(-i * i / 900.0));
	fprintf(file, "'");
	assert_int_equal(fclose(file), 0);
	stdfit(command);
	free(command);
	expect_code(0);
	struct csv_table table = ndf_output();
	const double scale = cell(&table, 0, IN_D) / 2;
	/* Node 30 stands at 10 degrees, node 60 at 40. */
	check_rel(cell(&table, 1, IN_D), 2 * scale * exp(-1), 1e-12, "node 30");
	check_rel(cell(&table, 2, IN_D), 2 * scale * exp(-4), 1e-12, "node 60");
	check_between(cell(&table, 0, IN_P2), 1, 3, "P2 at the normal");
	check_between(cell(&table, 3, IN_G1), 0, 0.2, "G1 at grazing incidence");
	csv_table_free(&table);
}

static void rows_are_chosen_and_bad_rows_refused(void **state)
{
	(void)state;
	write_text("in.csv", "theta,ndf,sigma,gamma,theta_i\n"
			     "30,std,0.2,1.7,\n"
			     "30,std,0.2,1.5,\n"
			     "30,nix,0.2,1.7,\n"
			     "30,ggx,abc,,\n"
			     ",ggx,0.2,,\n"
			     "95,ggx,0.2,,\n"
			     "30,ggx,0.2,1.7,\n"
			     "30,ggx,0.2,,20\n");
	shell("exec \"$STDFIT\" ndf - <in.csv");
	expect_code(1);
	struct csv_table table = ndf_output();
	assert_int_equal(table.n_rows, 8);
	for (size_t i = 0; i < 8; i++)
		assert_int_equal(*table.row[i][IN_D] != '\0', i == 0 || i == 7);
	assert_true(cell(&table, 7, IN_VISIBLE) > 0);
	csv_table_free(&table);
	assert_int_equal(count_lines(last.err), 6);
	static const char *const parts[] = {"stdfit: row 2: bad gamma 1.5: std takes one above 1.5, up to inf\n",
					    "stdfit: row 3: there is no NDF 'nix'\n",
					    "stdfit: row 4: bad sigma 'abc': expected a number\n",
					    "stdfit: row 5: theta is empty\n",
					    "stdfit: row 6: bad theta: expected degrees from 0 to 90\n",
					    "stdfit: row 7: ggx has no gamma\n"};
	for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
		expect_part(last.err, parts[i], __LINE__);
	shell("exec \"$STDFIT\" ndf - --json <in.csv");
	expect_code(1);
	assert_int_equal(json_array_length(last.out), 8);
	shell("exec \"$STDFIT\" ndf - </dev/null");
	expect_code(1);
}

static void distributions_come_from_result_tables(void **state)
{
	(void)state;
	stdfit("synth m.binary --kd 0.2 --ks 0.5 --sigma 0.2 --ndf ggx");
	expect_code(0);
	stdfit("fit m.binary --ndf ggx,beckmann --sigma 0.2 --ior 1.5 --max-theta 20 -q -o fits.csv");
	expect_code(0);
	stdfit("ndf --from fits.csv --theta 20");
	expect_code(0);
	struct csv_table table = ndf_output();
	assert_int_equal(table.n_rows, 2);
	assert_string_equal(table.row[1][IN_NAME], "ggx");
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find("ggx"), 0.2, 0.2, 2), STATUS_OK);
	same(&table, 1, IN_D, ndf_D(&ndf, vec3_from_spherical_deg(20, 0)));
	csv_table_free(&table);
	/* What is written describes the distribution again. */
	stdfit("fit m.binary --ndf std,low,t-family --max-theta 12 --ior 1.5 -q -o forms.csv");
	expect_code(0);
	shell("\"$STDFIT\" ndf --from forms.csv --theta 0:80:20 --theta-i 10 >first.csv && \"$STDFIT\" ndf - "
	      "<first.csv | "
	      "cmp - first.csv");
	if (last.code)
		fail_msg("%s%s", last.out, last.err);
	stdfit("sample --from fits.csv --row 2 --count 3");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 4);
	stdfit("sample --from fits.csv --count 3");
	expect_error(1, "2 rows are meant");
}

/* sample */

enum { MX, MY, MZ, PDF, OX, OY, OZ, PDF_O, WEIGHT, SAMPLE_COLUMNS };

static const struct csv_column sample_columns[SAMPLE_COLUMNS] = {{"m_x", true},  {"m_y", true},    {"m_z", true},
								 {"pdf", true},  {"wo_x", true},   {"wo_y", true},
								 {"wo_z", true}, {"pdf_wo", true}, {"weight", true}};

enum { TILTS = 10, TURNS = 12, PART = 24, COUNT = 20000 };

/* The normals of the table, in bins of cos(theta) and phi, against the integral of a density over each. */
static void expect_density(const struct csv_table *table, double (*pdf)(struct vec3 m, const void *context),
			   const void *context, int tests, const char *label)
{
	static int count[TILTS * TURNS];
	static double expected[TILTS * TURNS];

	memset(count, 0, sizeof count);
	memset(expected, 0, sizeof expected);
	for (size_t i = 0; i < table->n_rows; i++) {
		const double z = cell(table, i, MZ), phi = atan2(cell(table, i, MY), cell(table, i, MX)) + M_PI;
		const int tilt = (int)fmin(z * TILTS, TILTS - 1), turn = (int)fmin(phi / (2 * M_PI) * TURNS, TURNS - 1);
		count[tilt * TURNS + turn]++;
	}
	for (int i = 0; i < TILTS * PART; i++)
		for (int j = 0; j < TURNS * PART; j++) {
			const double z = (i + 0.5) / (TILTS * PART), phi = (j + 0.5) / (TURNS * PART) * 2 * M_PI - M_PI;
			const double s = sqrt(1 - z * z);
			expected[i / PART * TURNS + j / PART] +=
				(double)table->n_rows / (TILTS * PART) * 2 * M_PI / (TURNS * PART) *
				pdf((struct vec3){s * cos(phi), s * sin(phi), z}, context);
		}
	check_counts(TILTS * TURNS, count, expected, tests, label);
}

struct drawn {
	struct sampler sampler;
	struct vec3 wi;
};

static double density(struct vec3 m, const void *context)
{
	const struct drawn *drawn = context;
	return sampler_pdf(&drawn->sampler, drawn->wi, m);
}

static void samples_follow_their_density(void **state)
{
	static const struct {
		const char *arguments, *ndf;
		double sigma_x, sigma_y, gamma, theta_i, phi_i;
		enum sampling sampling;
	} cases[] = {
		{"std --sigma 0.6 --gamma 2.4 --theta-i 50", "std", 0.6, 0.6, 2.4, 50, 0, SAMPLING_VISIBLE},
		{"std --sigma 0.6,0.9 --gamma 2.4 --theta-i 50 --phi-i 70", "std", 0.6, 0.9, 2.4, 50, 70,
		 SAMPLING_VISIBLE},
		{"beckmann --sigma 0.6,0.9 --theta-i 90 --phi-i -20", "beckmann", 0.6, 0.9, 0, 90, -20,
		 SAMPLING_VISIBLE},
		{"std --sigma 0.6 --gamma 2.4 --theta-i 50 --sampling ndf", "std", 0.6, 0.6, 2.4, 50, 0, SAMPLING_NDF},
		{"std --sigma 0.6,0.4 --gamma 2.4 --theta-i 50 --phi-i 20 --sampling pseudo", "std", 0.6, 0.4, 2.4, 50,
		 20, SAMPLING_PSEUDO},
		{"ggx --sigma 0.7,0.5 --theta-i 50 --phi-i 30 --sampling rational", "ggx", 0.7, 0.5, 2, 50, 30,
		 SAMPLING_RATIONAL},
		{"low --sigma 0.7 --gamma 2 --theta-i 50", "low", 0.7, 0.7, 2, 50, 0, SAMPLING_NDF},
		{"gtr --sigma 0.7 --gamma 1.5", "gtr", 0.7, 0.7, 1.5, 0, 0, SAMPLING_NDF},
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct drawn drawn = {.wi = vec3_from_spherical_deg(cases[i].theta_i, cases[i].phi_i)};
		if (cases[i].theta_i == 90)
			drawn.wi.z = 1e-100;
		struct ndf ndf;
		char *command;

		assert_int_equal(
			ndf_init(&ndf, ndf_find(cases[i].ndf), cases[i].sigma_x, cases[i].sigma_y, cases[i].gamma), 0);
		assert_int_equal(sampler_init(&drawn.sampler, &ndf, cases[i].sampling), STATUS_OK);
		assert_true(asprintf(&command, "sample %s --count %d --seed 3", cases[i].arguments, COUNT) > 0);
		stdfit(command);
		free(command);
		expect_code(0);
		struct csv_table table = output(sample_columns, SAMPLE_COLUMNS);
		assert_int_equal(table.n_rows, COUNT);
		expect_density(&table, density, &drawn, (int)(sizeof cases / sizeof *cases), cases[i].arguments);
		for (size_t k = 0; k < 50; k++) {
			const struct vec3 m = {cell(&table, k, MX), cell(&table, k, MY), cell(&table, k, MZ)};
			check_unit(m.x, m.y, m.z, cases[i].arguments);
			same(&table, k, PDF, density(m, &drawn));
		}
		csv_table_free(&table);
	}
}

static void weights_add_up_to_the_albedo(void **state)
{
	static const struct {
		const char *arguments, *ndf;
		double gamma;
		enum gaf gaf;
	} cases[] = {
		{"std --sigma 0.5 --gamma 2.4", "std", 2.4, GAF_UNCORRELATED},
		{"beckmann --sigma 0.5 --gaf correlated", "beckmann", INFINITY, GAF_CORRELATED},
		{"ggx --sigma 0.5 --gaf v-groove --sampling ndf", "ggx", 2, GAF_V_GROOVE},
		{"gtr --sigma 0.5 --gamma 2.2", "gtr", 2.2, GAF_UNCORRELATED},
		{"std --sigma 0.5 --gamma 2.4 --sampling pseudo --phi-i 50", "std", 2.4, GAF_UNCORRELATED},
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct cook_torrance model = {.gaf = cases[i].gaf, .fresnel = FRESNEL_NONE};
		double albedo, sum = 0, squares = 0;
		char *command;

		assert_int_equal(ndf_init(&model.ndf, ndf_find(cases[i].ndf), 0.5, 0.5, cases[i].gamma), STATUS_OK);
		assert_int_equal(energy_lobe(&model, cos(40 * M_PI / 180), &albedo), STATUS_OK);
		assert_true(asprintf(&command, "sample %s --theta-i 40 --count %d", cases[i].arguments, COUNT) > 0);
		stdfit(command);
		free(command);
		expect_code(0);
		struct csv_table table = output(sample_columns, SAMPLE_COLUMNS);
		for (size_t k = 0; k < table.n_rows; k++) {
			const double w = cell(&table, k, WEIGHT);
			sum += w / COUNT;
			squares += w * w / COUNT;
			if (*table.row[k][OX]) {
				const struct vec3 m = {cell(&table, k, MX), cell(&table, k, MY), cell(&table, k, MZ)};
				const double cos_d = vec3_dot(
					m, vec3_from_spherical_deg(40, strstr(cases[i].arguments, "--phi-i") ? 50 : 0));
				check_rel(cell(&table, k, PDF_O), cell(&table, k, PDF) / (4 * cos_d), 1e-14,
					  "pdf of wo");
			}
		}
		csv_table_free(&table);
		check_mean(sum, sqrt((squares - sum * sum) / COUNT), albedo, cases[i].arguments);
	}
}

static void samples_follow_the_seed(void **state)
{
	(void)state;
	stdfit("sample std --sigma 0.2 --gamma 1.7 --theta-i 30 --count 20 --seed 5");
	char *first = strdup(last.out);
	stdfit("sample std --sigma 0.2 --gamma 1.7 --theta-i 30 --count 20 --seed 5");
	assert_string_equal(first, last.out);
	stdfit("sample std --sigma 0.2 --gamma 1.7 --theta-i 30 --count 20 --seed 6");
	assert_string_not_equal(first, last.out);
	free(first);
	stdfit("sample ellipsoid --params 'alpha_x=0.2;alpha_y=0.5;theta_x=10' --theta-i 30 --count 5 --json");
	expect_code(0);
	assert_int_equal(json_array_length(last.out), 5);
}

/* Normals are drawn by the exact Lambda, so their density has it, too; the weight has the form that is asked for. */
static void the_density_is_that_of_what_is_drawn(void **state)
{
	const struct vec3 wi = vec3_from_spherical_deg(60, 0);
	struct ndf ndf;

	(void)state;
	stdfit("sample std --sigma 0.6 --gamma 2.2 --theta-i 60 --count 50 --lambda rational");
	expect_code(0);
	struct csv_table table = output(sample_columns, SAMPLE_COLUMNS);
	assert_int_equal(ndf_init(&ndf, ndf_find("std"), 0.6, 0.6, 2.2), STATUS_OK);
	struct ndf rational = ndf;
	assert_int_equal(ndf_set_lambda_form(&rational, LAMBDA_RATIONAL), STATUS_OK);
	check_between(fabs(ndf_G1(&rational, wi) / ndf_G1(&ndf, wi) - 1), 1e-3, 1e-2, "error of the form");
	for (size_t k = 0; k < table.n_rows; k++) {
		const struct vec3 m = {cell(&table, k, MX), cell(&table, k, MY), cell(&table, k, MZ)};
		const double pdf = vndf_pdf(&ndf, wi, m);

		same(&table, k, PDF, pdf);
		same(&table, k, WEIGHT, vndf_weight(&rational, GAF_UNCORRELATED, wi, m, pdf));
	}
	csv_table_free(&table);
}

static void wrong_usage_is_refused(void **state)
{
	static const struct {
		const char *arguments;
		int code;
		const char *part;
	} bad[] = {
		{"ndf", 2, "expected one NAME"},
		{"ndf std ggx --theta 1", 2, "expected one NAME"},
		{"ndf std --sigma 0.2 --gamma 2", 2, "expected --theta"},
		{"ndf std --sigma 0.2 --gamma 2 --theta 1:2", 2, "bad angles '1:2'"},
		{"ndf std --sigma 0.2 --gamma 2 --theta 0:91:1", 2, "bad angles"},
		{"ndf std --sigma 0.2 --gamma 2 --theta 0:90:1e-9", 2, "bad angles"},
		{"ndf std --sigma 0.2 --gamma 2 --theta 1,,2", 2, "bad angles"},
		{"ndf ggx --sigma 0.2 --theta 0:90:0.1 --phi 0:360:0.2", 2, "901 angles theta and 1801 phi: expected"},
		{"ndf nix --sigma 0.2 --theta 1", 2, "no NDF 'nix'"},

		{"ndf std --sigma 0.2 --theta 1", 2, "std needs gamma"},
		{"ndf gtr --sigma 0.2,0.3 --gamma 2 --theta 1", 2, "gtr takes one sigma"},
		{"ndf std --sigma 0.2 --gamma 1.5 --theta 1", 2, "bad gamma 1.5: std takes one above 1.5, up to inf"},
		{"ndf ggx --sigma 0.2,0 --theta 1", 2, "bad sigma 0: ggx takes one from 1e-50, up to 1e+50"},
		{"ndf low --sigma 0.2 --gamma 0 --theta 1", 2, "bad C 0: low takes one above 0"},
		{"ndf low --params 'B=-1;C=2' --theta 1", 2, "bad B -1: low takes one above 0"},
		{"ndf gtr --sigma 1e40 --gamma 900 --theta 1", 2, "gtr does not take these parameters"},
		{"ndf std --sigma 0.2 --gamma 1.7 --lambda integer --theta 1", 2, "no Lambda integer"},
		{"ndf low --params 'B=1;Q=2' --theta 1", 2, "bad parameter 'Q=2'"},
		{"ndf std --params '\n=1' --theta 1", 2, "bad parameter '\\x0a=1'"},
		{"ndf low --params B=1 --theta 1", 2, "low needs C"},
		{"ndf ellipsoid --theta 1", 2, "alpha_x"},
		{"ndf pl --params D0=1 --theta 1", 2, "D1 is missing"},
		{"ndf - --theta 1", 2, "--theta means nothing"},
		{"ndf --from x.csv --sigma 0.2 --theta 1", 2, "--sigma and --from"},
		{"ndf --from none.csv --theta 1", 1, "none.csv"},
		{"sample gtr --sigma 0.2 --gamma 2 --theta-i 3 --sampling visible", 2, "gtr has no --sampling visible"},
		{"sample std --sigma 0.2 --gamma 2 --sampling visible", 2, "need --theta-i"},
		{"sample std --sigma 0.2 --gamma 2 --sampling pseudo", 2, "need --theta-i"},
		{"sample std --sigma 0.2 --gamma 3 --theta-i 3 --sampling rational", 2,
		 "no --sampling rational: that is for"},
		{"sample gtr --sigma 0.2 --gamma 3 --theta-i 3 --sampling pseudo", 2, "gtr has no --sampling pseudo"},
		{"sample std --sigma 0.2 --gamma 2 --phi-i 3", 2, "--phi-i means nothing without --theta-i"},
		{"ndf std --sigma 0.2 --gamma 2 --theta 3 --phi-i 3", 2, "--phi-i means nothing without --theta-i"},
		{"ndf std --sigma 0.2 --gamma 2 --theta 3 --theta-i 90.1", 2, "expected a number from 0 to 90"},
		{"ndf std --sigma 0.2 --gamma 3 --theta 1 --lambda trapezoid", 2, "std has no Lambda trapezoid"},
		{"ndf low --sigma 0.2,0.3 --params 'B=1;C=2' --theta 1", 2, "low takes one sigma"},
		{"ndf t-family --sigma 0.2,0 --gamma 3 --params x=1 --theta 1", 2, "bad sigma 0: t-family takes"},
		{"sample ellipsoid --sigma 0.2 --params tilt_x=0.1 --theta-i 3 --sampling pseudo", 2,
		 "ellipsoid has no --sampling pseudo"},
		{"sample std --sigma 0.2 --gamma 2 --count 0", 2, "--count"},
	};

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		stdfit(bad[i].arguments);
		expect_error(bad[i].code, bad[i].part);
		assert_string_equal(last.out, "");
	}
}

static int set_up(void **state)
{
	top = getcwd(NULL, 0);
	return top ? enter_directory(state) : -1;
}

static int tear_down(void **state)
{
	free(top);
	return leave_directory(state);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(values_match_golden_rows),
		cmocka_unit_test(printed_values_are_those_of_the_library),
		cmocka_unit_test(cumulative_values_are_those_of_the_library),
		cmocka_unit_test(moments_match_golden_rows),
		cmocka_unit_test(grazing_incidence_is_a_limit),
		cmocka_unit_test(pl_takes_trapezoids),
		cmocka_unit_test(own_parameters_are_taken),
		cmocka_unit_test(nodes_of_pl_are_normalised),
		cmocka_unit_test(rows_are_chosen_and_bad_rows_refused),
		cmocka_unit_test(distributions_come_from_result_tables),
		cmocka_unit_test(samples_follow_their_density),
		cmocka_unit_test(weights_add_up_to_the_albedo),
		cmocka_unit_test(samples_follow_the_seed),
		cmocka_unit_test(the_density_is_that_of_what_is_drawn),
		cmocka_unit_test(wrong_usage_is_refused),
	};

	return cmocka_run_group_tests(tests, set_up, tear_down);
}
