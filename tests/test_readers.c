/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Readers of text formats, and what they are made of, on files written here. */
#include "check.h"
#include "data_readers/measurement_read.h"
#include "data_readers/solid_angle.h"
#include "data_readers/spectrum.h"
#include "data_readers/text_number.h"

#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

static char directory[] = "/tmp/stdfit-readers-XXXXXX";

static int make_directory(void **state)
{
	(void)state;
	return mkdtemp(directory) && chdir(directory) == 0 ? 0 : -1;
}

static int remove_directory(void **state)
{
	(void)state;
	return chdir("/") || rmdir(directory);
}

static void write_file(const char *name, const char *text, size_t size)
{
	FILE *file = fopen(name, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(text, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

/* Reads a text under a name; the file is gone afterwards. */
static enum status read_as(const char *name, const char *text, enum quantity quantity, struct measurement *measurement,
			   struct error *error)
{
	const struct read_options options = {.threads = 1, .quantity = quantity};
	write_file(name, text, strlen(text));
	const enum status status = measurement_read(name, &options, measurement, error);
	unlink(name);
	return status;
}

static struct measurement read_text(const char *name, const char *text)
{
	struct measurement measurement;
	struct error error;
	if (read_as(name, text, QUANTITY_FROM_FILE, &measurement, &error) != STATUS_OK)
		fail_msg("%s: %s", text, error.text);
	assert_non_null(measurement.scattered);
	return measurement;
}

static void check_entry(const struct scattered *s, size_t e, struct vec3 wi, struct vec3 wo, double r, double g,
			double b)
{
	const double got[] = {s->wi[e].x,
			      s->wi[e].y,
			      s->wi[e].z,
			      s->wo[e].x,
			      s->wo[e].y,
			      s->wo[e].z,
			      (double)s->value[0][e],
			      (double)s->value[1][e],
			      (double)s->value[2][e]};
	const double want[] = {wi.x, wi.y, wi.z, wo.x, wo.y, wo.z, r, g, b};
	for (int i = 0; i < 9; i++)
		check_abs(got[i], want[i], i < 6 ? 1e-14 : 1e-6 * fabs(want[i]), "a part of an entry");
}

/* Numbers */

static void numbers_are_those_of_strtod(void **state)
{
	(void)state;
	static const char *const text[] = {"0",
					   "-0",
					   "1",
					   "+1.5",
					   "0.1",
					   ".5",
					   "5.",
					   "1e3",
					   "1E-3",
					   "123456789012345678901234567890",
					   "0.00000000000000019236706937217898",
					   "1e22",
					   "1e-22",
					   "4.35e308",
					   "2.2e-308",
					   "1e400",
					   "1e-400",
					   "-3.25e+2",
					   "1e99999999999999999999",
					   "0.30000000000000004441",
					   "9007199254740993",
					   "5e-324",
					   "inf",
					   "-Infinity",
					   "00000000000000000000000000012.5",
					   "0.000000000000000000000000000000000125e30"};
	for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
		const char *at = text[i];
		double got;
		assert_true(text_number(&at, &got));
		assert_int_equal(*at, '\0');
		check_rel(got, strtod(text[i], NULL), 3e-16, text[i]);
		assert_int_equal(signbit(got) != 0, signbit(strtod(text[i], NULL)) != 0);
	}
	const char *nan = "NaN";
	double got;
	assert_true(text_number(&nan, &got) && isnan(got));
}

static void what_is_no_number_is_refused(void **state)
{
	(void)state;
	static const char *const text[] = {"", "e5", ".", "-", "+.", "x1", "- 1", ",", " 1", "n", "in"};
	for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
		const char *at = text[i];
		double value = 7;
		if (text_number(&at, &value) || at != text[i] || value != 7)
			fail_msg("taken for a number: '%s'", text[i]);
	}
}

static void a_number_ends_where_its_text_does(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		double value;
		const char *rest;
	} cases[] = {{"1e", 1, "e"},   {"1e+", 1, "e+"},     {"2.5.6", 2.5, ".6"},
		     {"3,4", 3, ",4"}, {"550nm", 550, "nm"}, {"0x10", 0, "x10"}};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const char *at = cases[i].text;
		double value;
		assert_true(text_number(&at, &value));
		check_abs(value, cases[i].value, 0, cases[i].text);
		assert_string_equal(at, cases[i].rest);
	}
}

/* Spectra */

static void a_white_spectrum_is_white(void **state)
{
	(void)state;
	static const double nm[][5] = {
		{400, 475, 550, 625, 700}, {300, 301, 555, 900, 1000}, {381.5, 443.3, 590, 605, 776}};
	const double ones[] = {1, 1, 1, 1, 1};
	double weight[15], rgb[3];
	for (size_t i = 0; i < sizeof nm / sizeof *nm; i++) {
		assert_true(spectrum_has_colour(nm[i], 5));
		assert_int_equal(spectrum_weights(nm[i], 5, weight), STATUS_OK);
		spectrum_rgb(weight, ones, 5, rgb);
		for (int c = 0; c < 3; c++)
			check_rel(rgb[c], 1, 1e-14, "white");
	}
}

/* Computed by another program, from the tables of CIE 15. */
static void spectra_have_their_colours(void **state)
{
	(void)state;
	static const double nm[2][4] = {{400, 500, 600, 700}, {440, 445, 560, 661}};
	static const double value[2][4] = {{.1, .4, .2, .8}, {.9, .05, .3, .02}};
	static const double want[2][3] = {{0.27097757117002197, 0.3206382875969409, 0.25656248760976397},
					  {0.1839488700870416, 0.21987477088299026, 0.3545878909306377}};
	double weight[12], rgb[3];
	for (int i = 0; i < 2; i++) {
		assert_int_equal(spectrum_weights(nm[i], 4, weight), STATUS_OK);
		spectrum_rgb(weight, value[i], 4, rgb);
		for (int c = 0; c < 3; c++)
			check_rel(rgb[c], want[i][c], 1e-12, "a channel");
	}
	const double white[3] = {0.95047, 1, 1.08883}; /* of D65 */
	spectrum_xyz_to_rgb(white, rgb);
	for (int c = 0; c < 3; c++)
		check_abs(rgb[c], 1, 1e-4, "white of D65");
}

static void wavelengths_that_do_not_reach_far_are_gray(void **state)
{
	(void)state;
	static const double nm[] = {800, 900, 1000, 1100};
	const double value[] = {1, 2, 3, 6};
	double weight[12], rgb[3];
	assert_false(spectrum_has_colour(nm, 4));
	assert_int_equal(spectrum_weights(nm, 4, weight), STATUS_OK);
	spectrum_rgb(weight, value, 4, rgb);
	for (int c = 0; c < 3; c++)
		check_rel(rgb[c], 3, 1e-15, "the mean");
}

static void wavelengths_must_rise(void **state)
{
	(void)state;
	static const double wrong[][2] = {{500, 400}, {500, 500}, {-1, 500}, {400, NAN}, {400, INFINITY}};
	double weight[6];
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
		assert_int_equal(spectrum_weights(wrong[i], 2, weight), STATUS_DOMAIN);
}

/* Solid angles */

static struct vec3 at_degrees(double theta, double phi)
{
	const double radian = M_PI / 180;
	return (struct vec3){sin(theta * radian) * cos(phi * radian), sin(theta * radian) * sin(phi * radian),
			     cos(theta * radian)};
}

static struct scattered *alone(struct measurement *m, size_t n, enum symmetry symmetry)
{
	assert_int_equal(measurement_scattered(m, n), STATUS_OK);
	m->scattered->symmetry = symmetry;
	return m->scattered;
}

/* On a grid of middles the cells are those of the grid, and fill both hemispheres. */
static void a_grid_has_its_own_cells(void **state)
{
	(void)state;
	struct measurement m;
	struct scattered *s = alone(&m, 9 * 9 * 12, SYMMETRY_ISOTROPIC);
	size_t e = 0;
	double sum = 0;
	for (int i = 5; i < 90; i += 10)
		for (int o = 5; o < 90; o += 10)
			for (int k = 15; k < 360; k += 30, e++) {
				s->wi[e] = at_degrees(i, 40);
				s->wo[e] = at_degrees(o, 40 + k);
			}
	assert_int_equal(solid_angle_estimate(s), STATUS_OK);
	for (e = 0; e < s->n; e++) {
		const double i = acos(s->wi[e].z), o = acos(s->wo[e].z), half = 5 * M_PI / 180;
		/* k and 360 - k are one to an isotropic sample. */
		const double cell =
			(cos(i - half) - cos(i + half)) * (cos(o - half) - cos(o + half)) * 2 * M_PI * M_PI / 6;
		check_rel((double)s->solid_angle[e], cell, 1e-4, "a cell");
		sum += (double)s->solid_angle[e];
	}
	check_rel(sum, 4 * M_PI * M_PI, 1e-4, "all cells");
	measurement_free(&m);
}

static void turned_samples_have_cells_of_four_angles(void **state)
{
	(void)state;
	struct measurement m;
	struct scattered *s = alone(&m, 3 * 4 * 3 * 6, SYMMETRY_ANISOTROPIC);
	size_t e = 0;
	double sum = 0;
	for (int i = 15; i < 90; i += 30)
		for (int turn = -135; turn < 180; turn += 90)
			for (int o = 15; o < 90; o += 30)
				for (int k = -150; k < 180; k += 60, e++) {
					s->wi[e] = at_degrees(i, turn);
					s->wo[e] = at_degrees(o, turn + k);
				}
	assert_int_equal(solid_angle_estimate(s), STATUS_OK);
	for (e = 0; e < s->n; e++)
		sum += (double)s->solid_angle[e];
	check_rel(sum, 4 * M_PI * M_PI, 1e-4, "all cells");
	measurement_free(&m);
}

static void equal_entries_share_their_cell(void **state)
{
	(void)state;
	struct measurement m;
	struct scattered *s = alone(&m, 5, SYMMETRY_ISOTROPIC);
	for (size_t e = 0; e < 5; e++) {
		s->wi[e] = at_degrees(30, 0);
		s->wo[e] = at_degrees(20, 100);
	}
	assert_int_equal(solid_angle_estimate(s), STATUS_OK);
	for (size_t e = 0; e < 5; e++)
		check_rel((double)s->solid_angle[e], 4 * M_PI * M_PI / 5, 1e-6, "a fifth of all");
	measurement_free(&m);
}

/* The mean of a function by these weights is its integral, wherever the entries lie. */
static void scattered_cells_integrate(void **state)
{
	(void)state;
	enum { N = 20000 };
	struct measurement m;
	struct scattered *s = alone(&m, N, SYMMETRY_ISOTROPIC);
	unsigned seed = 5;
	double sum = 0;
	for (size_t e = 0; e < N; e++) {
		double u[4];
		for (int i = 0; i < 4; i++) {
			seed = seed * 1664525u + 1013904223u;
			u[i] = (seed >> 8) / (double)(1 << 24);
		}
		/* More of them near the normal. */
		s->wi[e] = at_degrees(90 * u[0] * u[0], 0);
		s->wo[e] = at_degrees(90 * u[1] * u[1], 360 * u[2]);
	}
	assert_int_equal(solid_angle_estimate(s), STATUS_OK);
	for (size_t e = 0; e < N; e++)
		sum += (double)s->solid_angle[e] * s->wi[e].z * s->wo[e].z;
	check_rel(sum, M_PI * M_PI, 0.04, "the cosines over both hemispheres");
	measurement_free(&m);
}

/* Samples as CSV */

static void directions_may_be_given_in_every_way(void **state)
{
	(void)state;
	static const char *const same[] = {
		"theta_i,phi_i,theta_o,phi_o,r,g,b\n30,10,60,190,.1,.2,.3\n",
		"b,g,r,phi_o,theta_o,phi_i,theta_i\n.3,.2,.1,190,60,10,30\n",
		"theta_i_rad;phi_i_rad;theta_o_deg;phi_o;r;g;b\n0.52359877559829882;0.17453292519943295;60;190;.1;.2;."
		"3\n",
		"THETA_I\tphi_i\ttheta_o\tphi_o\tR\tG\tB\n  30 10\t60   190  .1 .2 .3\t\n",
		"# a comment\r\n\r\n\"theta_i\", \"phi_i\", theta_o ,phi_o,r,g,b\r\n 30 , 10 , 60 ,190, .1, .2, .3\r\n",
		"\xef\xbb\xbftheta_i,phi_i,theta_o,phi_o,r,g,b\n30,10,60,190,.1,.2,.3",
		"wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b\n0.49240387650610395,0.08682408883346515,0.86602540378443871,"
		"-0.85286853195244317,-0.15038373318043533,0.5,.1,.2,.3\n",
	};
	for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
		struct measurement m = read_text("x", same[i]);
		assert_int_equal(m.scattered->n, 1);
		check_entry(m.scattered, 0, at_degrees(30, 10), at_degrees(60, 190), .1, .2, .3);
		assert_string_equal(m.format, "csv");
		assert_false(m.scattered->gray);
		measurement_free(&m);
	}
}

static void in_the_plane_a_positive_angle_is_the_mirror_side(void **state)
{
	(void)state;
	struct measurement m = read_text("x.csv", "theta_i,theta_o,value\n30,30,1\n30,-30,2\n");
	assert_int_equal(m.scattered->symmetry, SYMMETRY_ISOTROPIC);
	assert_true(m.scattered->gray);
	assert_int_equal(m.n_channels, 1);
	check_entry(m.scattered, 0, at_degrees(30, 0), at_degrees(30, 180), 1, 1, 1);
	check_entry(m.scattered, 1, at_degrees(30, 0), at_degrees(30, 0), 2, 2, 2);
	measurement_free(&m);
	m = read_text("x.csv", "theta_i,theta_o,phi_o,value\n30,40,50,1\n");
	check_entry(m.scattered, 0, at_degrees(30, 0), at_degrees(40, 50), 1, 1, 1);
	measurement_free(&m);
}

static void the_quantity_is_that_of_option_or_file(void **state)
{
	(void)state;
	static const char plain[] = "theta_i,theta_o,value\n10,60,1\n",
			  said[] = "# quantity: brdf_cos\ntheta_i,theta_o,value\n10,60,1\n";
	static const char goniometer[] = "Incident angle,Measure_angle,400,500 nm,600.0,700nm\n10,60,1,1,1,1\n";
	static const struct {
		const char *text;
		enum quantity option;
		double value;
	} cases[] = {{plain, QUANTITY_FROM_FILE, 1},
		     {plain, QUANTITY_BRDF_COS, 2},
		     {plain, QUANTITY_REFLECTANCE_FACTOR, M_1_PI},
		     {said, QUANTITY_FROM_FILE, 2},
		     {said, QUANTITY_BRDF, 1},
		     {goniometer, QUANTITY_FROM_FILE, M_1_PI},
		     {goniometer, QUANTITY_BRDF, 1}};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct measurement m;
		struct error error;
		assert_int_equal(read_as("x.csv", cases[i].text, cases[i].option, &m, &error), STATUS_OK);
		for (int c = 0; c < 3; c++)
			check_rel((double)m.scattered->value[c][0], cases[i].value, 1e-6, "a channel");
		measurement_free(&m);
	}
}

static void what_cannot_be_used_is_counted(void **state)
{
	(void)state;
	struct measurement m = read_text("x.csv", "theta_i,phi_i,theta_o,phi_o,r,g,b\n"
						  "10,0,20,0,1,1,1\n"
						  "10,0,90,0,1,1,1\n"
						  "95,0,20,0,1,1,1\n"
						  "10,0,20,0,-1,1,1\n"
						  "10,0,20,0,1,nan,1\n"
						  "10,0,20,0,1,1,1e39\n"
						  "10,0,20,0,1,,1\n"
						  "10,0,,0,1,1,1\n"
						  "10,0,30,0,1e-40,0,0\n");
	assert_int_equal(m.scattered->n, 2);
	assert_int_equal(m.n_below_horizon, 2);
	assert_int_equal(m.n_negative, 1);
	assert_int_equal(m.n_nonfinite, 2);
	assert_int_equal(m.n_missing, 2);
	check_abs((double)m.scattered->value[0][1], 0, 0, "a value too small for a normal float");
	measurement_free(&m);
}

static void spectra_are_masked_as_a_whole(void **state)
{
	(void)state;
	static const char text[] = "theta_i,theta_o,400nm,500nm,520 nm,540nm,650nm\n"
				   "10,20,1,1,1,1,1\n"
				   "10,21,0,0,0,0,0\n"
				   "10,22,1,1,-0.1,1,1\n"
				   "10,23,0,0,1,0,0\n"; /* green beyond sRGB */
	struct read_options options = {.threads = 1};
	struct measurement m;
	for (int g = 0; g < GAMUT_COUNT; g++) {
		options.gamut = (enum gamut)g;
		write_file("x.csv", text, strlen(text));
		assert_int_equal(measurement_read("x.csv", &options, &m, NULL), STATUS_OK);
		assert_int_equal(m.scattered->n, g == GAMUT_CLIP ? 2 : 1);
		assert_int_equal(m.n_out_of_gamut, 1);
		assert_int_equal(m.n_missing, 1);
		assert_int_equal(m.n_negative, 1);
		assert_int_equal(m.n_channels, 5);
		for (int c = 0; c < 3; c++)
			check_rel((double)m.scattered->value[c][0], 1, 1e-6, "white");
		if (g == GAMUT_CLIP)
			assert_true(m.scattered->value[0][1] == 0 && m.scattered->value[1][1] > 0);
		measurement_free(&m);
	}
	unlink("x.csv");
}

static void several_azimuths_mean_anisotropic_unless_said(void **state)
{
	(void)state;
	/* Half a turn is none. */
	static const char rows[] = "theta_i,phi_i,theta_o,phi_o,value\n10,0,20,0,1\n0,77,20,0,1\n10,%d,20,0,1\n";
	static const char *const said[] = {"", "# symmetry: isotropic\n", "# symmetry: plane\n"};
	static const enum symmetry turned[] = {SYMMETRY_ANISOTROPIC, SYMMETRY_ISOTROPIC, SYMMETRY_PLANE};
	static const enum symmetry same[] = {SYMMETRY_ISOTROPIC, SYMMETRY_ISOTROPIC, SYMMETRY_PLANE};
	for (int i = 0; i < 3; i++)
		for (int angle = 0; angle <= 360; angle += 30) {
			char text[256];
			const int n = snprintf(text, sizeof text, "%s", said[i]);
			snprintf(text + n, sizeof text - (size_t)n, rows, angle);
			struct measurement m = read_text("x.csv", text);
			assert_int_equal(m.scattered->symmetry, angle % 180 ? turned[i] : same[i]);
			measurement_free(&m);
		}
}

/* Refusals */

struct refusal {
	const char *text, *words;
};

static void expect_refusals(const char *name, const struct refusal *refusals, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		struct measurement m;
		struct error error = {""};
		char begin[64];
		const enum status status = read_as(name, refusals[i].text, QUANTITY_FROM_FILE, &m, &error);
		snprintf(begin, sizeof begin, "cannot read '%s': ", name);
		if (status == STATUS_OK || m.value[0] || m.scattered)
			fail_msg("read: %s", refusals[i].text);
		if (strncmp(error.text, begin, strlen(begin)) != 0 || !strstr(error.text, refusals[i].words) ||
		    strchr(error.text, '\n'))
			fail_msg("expected '%s', found '%s'", refusals[i].words, error.text);
	}
}

static void bad_csv_is_refused_with_its_line(void **state)
{
	(void)state;
	static const struct refusal refusals[] = {
		{"theta_i,theta_o,gloss\n1,2,3\n", "line 1: column 'gloss' is not understood: expected theta_i, phi_i"},
		{"theta_i,theta_o,value,value\n", "line 1: two columns are 'value'"},
		{"theta_i,value\n1,2\n", "line 1: the columns do not give both directions"},
		{"theta_i,phi_i,theta_o,value\n1,2\n", "line 1: the columns do not give both directions"},
		{"theta_i,theta_o,wi_x,value\n", "line 1: the columns do not give both directions"},
		{"wi_x,wi_y,wi_z,wo_x,wo_y,value\n", "line 1: the columns do not give both directions"},
		{"theta_i,theta_o\n1,2\n", "line 1: the columns do not give values in one way"},
		{"theta_i,theta_o,r,g\n1,2,3,4\n", "line 1: the columns do not give values in one way"},
		{"theta_i,theta_o,value,500nm\n", "line 1: the columns do not give values in one way"},
		{"theta_i,theta_o,500nm,400nm\n1,2,3,4\n", "line 1: expected wavelengths that rise"},
		{"theta_i,theta_o,value\n1,2,3\n1,2\n", "line 3: expected 3 values, found 2"},
		{"theta_i,theta_o,value\n1,2,3,4\n", "line 2: expected 3 values, found more"},
		{"theta_i theta_o value\n1 2 3 4\n", "line 2: expected 3 values, found more"},
		{"theta_i,theta_o,value\n\n# x\n1,2,three\n", "line 4: expected a number for value, found 'three'"},
		{"theta_i,theta_o,50nm\n1,2,3\n", "line 1: column '50nm' is not understood"},
		{"theta_i,theta_o,500nm\n1,2,3x\n", "line 2: expected a number for 500nm"},
		{"theta_i,theta_o,value\n1,2,3;4\n", "line 2: expected a number for value"},
		{"theta_i,theta_o,value\n91,2,3\n1,2,-3\n",
		 "no sample can be used: 1 at or below the horizon, 1 negative"},
		{"theta_i,theta_o,value\n", "no sample can be used: there is none"},
		{"# quantity: radiance\ntheta_i,theta_o,value\n1,2,3\n",
		 "line 1: expected the quantity brdf, brdf_cos"},
		{"# symmetry: odd\ntheta_i,theta_o,value\n1,2,3\n", "line 1: expected the symmetry isotropic"},
		{"wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,value\n0,0,1,0,0,2,1\n", "line 2: expected directions of length 1"},
		{"theta_i,theta_o,value,solid_angle\n1,2,3,-1\n", "line 2: expected a solid_angle"},
		{"# only\n# comments\n", "there is no line of names"},
	};
	expect_refusals("x.csv", refusals, sizeof refusals / sizeof *refusals);
}

static void odd_bytes_are_refused_with_their_line(void **state)
{
	(void)state;
	enum { LONG = (1 << 20) + 10 };
	static const char head[] = "theta_i,theta_o,value\n1,2,3\n";
	char *text = malloc(sizeof head + LONG);
	struct measurement m;
	struct error error;
	assert_non_null(text);
	memset(text, ' ', sizeof head + LONG);
	memcpy(text, head, sizeof head - 1);
	write_file("x.csv", text, sizeof head + LONG);
	assert_int_equal(measurement_read("x.csv", NULL, &m, &error), STATUS_FORMAT);
	assert_non_null(strstr(error.text, "line 3: expected at most 1048576 bytes in a line"));
	write_file("x.csv", "theta_i,theta_o,value\n1,\0,3\n", 28);
	assert_int_equal(measurement_read("x.csv", NULL, &m, &error), STATUS_FORMAT);
	assert_non_null(strstr(error.text, "line 2: expected text, found a zero byte"));
	unlink("x.csv");
	free(text);
}

/* Long lines and blocks that end anywhere make no difference. */
static void many_lines_are_read(void **state)
{
	(void)state;
	enum { N = 60000 };
	FILE *file = fopen("x.csv", "wb");
	struct measurement m;
	assert_non_null(file);
	fputs("theta_i,theta_o,value\n", file);
	for (int i = 0; i < N; i++)
		fprintf(file, "%d,%d.%*d,%d%s", i % 89, i % 80, 1 + i % 60, 5, i, i % 3 ? "\n" : "\r\n");
	assert_int_equal(fclose(file), 0);
	assert_int_equal(measurement_read("x.csv", NULL, &m, NULL),
			 STATUS_FORMAT); /* "12.  5": a blank within a number */
	file = fopen("x.csv", "wb");
	assert_non_null(file);
	fputs("theta_i,theta_o,value\n", file);
	for (int i = 0; i < N; i++)
		fprintf(file, "%d,%*d.5,%d%s", i % 89, 1 + i % 70, i % 80, i, i % 3 ? "\n" : "\r\n");
	assert_int_equal(fclose(file), 0);
	assert_int_equal(measurement_read("x.csv", NULL, &m, NULL), STATUS_OK);
	assert_int_equal(m.scattered->n, N);
	for (int i = 0; i < N; i++)
		if (m.scattered->value[0][i] != (float)i)
			fail_msg("entry %d: got %g", i, (double)m.scattered->value[0][i]);
	struct stat st;
	assert_int_equal(stat("x.csv", &st), 0);
	assert_int_equal(m.file_size, st.st_size);
	measurement_free(&m);
	unlink("x.csv");
}

/* ALTA */

static void alta_coordinates_are_one_pair_of_directions(void **state)
{
	(void)state;
	static const char *const same[] = {
		"#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n#PARAM_OUT INV_STERADIAN\n0.3 0 0.5 2 0.25\n",
		"#DIM 3 1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n#PARAM_OUT INV_STERADIAN\n0.5 0.3 2 0.25\n",
		"#SAMPLE a\n#DIM 3 1\n#VS 2\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n#PARAM_OUT INV_STERADIAN\n"
		"0.3 -0.20807341827357119 0.45464871341284085 0.25 9 9\n",
		"#DIM 6 3\n#VS 1 0 0\n#PARAM_IN CARTESIAN\n#PARAM_OUT RGB_COLOR\n"
		"-0.19951142125004898 0.4359404086073183 0.8775825618903728 0.29552020666133955 0 "
		"0.95533648912560598 .25 .25 .25 9\n",
	};
	for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
		struct measurement m = read_text("x.dat", same[i]);
		check_entry(m.scattered, 0, at_degrees(0.3 * 180 / M_PI, 0),
			    at_degrees(0.5 * 180 / M_PI, 2 * 180 / M_PI), .25, .25, .25);
		assert_string_equal(m.format, "alta");
		assert_int_equal(m.scattered->gray, i != 3);
		measurement_free(&m);
	}
}

static void alta_half_and_difference_angles_are_understood(void **state)
{
	(void)state;
	const struct halfdiff a = {0.2, 0.4, 1.1};
	struct vec3 wi, wo;
	halfdiff_to_dirs(a, &wi, &wo);
	struct measurement m =
		read_text("x.dat", "#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n0.2 0.4 1.1 1\n");
	check_entry(m.scattered, 0, wi, wo, 1, 1, 1);
	assert_int_equal(m.scattered->symmetry, SYMMETRY_ISOTROPIC);
	measurement_free(&m);
	m = read_text("x.dat", "#DIM 4 1\n#PARAM_IN RUSIN_TH_PH_TD_PD\n#PARAM_OUT INV_STERADIAN\n0.2 0 0.4 1.1 1\n0.2 "
			       "1.5707963267948966 "
			       "0.4 1.1 1\n");
	check_entry(m.scattered, 1, (struct vec3){-wi.y, wi.x, wi.z}, (struct vec3){-wo.y, wo.x, wo.z}, 1, 1, 1);
	assert_int_equal(m.scattered->symmetry, SYMMETRY_ANISOTROPIC);
	measurement_free(&m);
}

/* Each row has the cosines with the normal and between the half vector and wi that its name says. */
static void alta_cosines_and_fewer_angles_are_understood(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		double theta_h, theta_d, wo_z;
		enum symmetry symmetry;
	} rows[] = {
		{"#DIM 1 1\n#PARAM_IN COS_TH\n#PARAM_OUT INV_STERADIAN\n0.8 1\n", 0.6435011087932844, 0, 0.8,
		 SYMMETRY_ISOTROPIC},
		{"#DIM 2 1\n#PARAM_IN COS_TH_TD\n#PARAM_OUT INV_STERADIAN\n0.8 0.96 1\n", 0.6435011087932844,
		 0.2837941092083278, NAN, SYMMETRY_ISOTROPIC},
		{"#DIM 2 1\n#PARAM_IN RUSIN_TH_TD\n#PARAM_OUT INV_STERADIAN\n0.3 0.7 1\n", 0.3, 0.7, 0.7306816499355124,
		 SYMMETRY_ISOTROPIC},
		{"#DIM 3 1\n#PARAM_IN RUSIN_TH_PH_TD\n#PARAM_OUT INV_STERADIAN\n0.3 0 0.4 1\n0.3 2 0.4 1\n", 0.3, 0.4,
		 NAN, SYMMETRY_ANISOTROPIC},
		{"#DIM 2 1\n#PARAM_IN ISOTROPIC_TV_PROJ_DPHI\n#PARAM_OUT INV_STERADIAN\n0.3 0.4 1\n", 0.25, 0.25,
		 0.8775825618903728, SYMMETRY_ISOTROPIC},
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct measurement m = read_text("x.dat", rows[i].text);
		const struct vec3 wi = m.scattered->wi[0], wo = m.scattered->wo[0], h = vec3_unit(vec3_add(wi, wo));

		check_abs(h.z, cos(rows[i].theta_h), 1e-9, rows[i].text);
		check_abs(vec3_dot(h, wi), cos(rows[i].theta_d), 1e-9, rows[i].text);
		if (!isnan(rows[i].wo_z))
			check_abs(wo.z, rows[i].wo_z, 1e-9, rows[i].text);
		assert_int_equal(m.scattered->symmetry, rows[i].symmetry);
		measurement_free(&m);
	}
}

static void alta_values_are_divided_by_the_cosine_of_the_view(void **state)
{
	(void)state;
	struct measurement m =
		read_text("x.dat", "#DIM 3 1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n"
				   "1.0471975511965976 0.1 2 0.25\n");
	check_rel((double)m.scattered->value[0][0], 0.5, 1e-6, "the BRDF");
	measurement_free(&m);
	m = read_text("x.dat",
		      "#DIM 3 3\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n#PARAM_OUT XYZ_COLOR\n0.2 0.1 2 0.95047 1 1.08883\n");
	for (int c = 0; c < 3; c++)
		check_rel((double)m.scattered->value[c][0], 1, 1e-4, "white");
	measurement_free(&m);
}

/* What is no number, or below the horizon, is counted in every format; equal directions stay two samples. */
static void every_format_counts_what_it_leaves_out(void **state)
{
	(void)state;
	static const struct {
		const char *name, *text;
	} files[] = {
		{"x.csv", "theta_i,theta_o,value\n10,20,1\n10,20,3\n10,20,nan\n10,20,inf\n10,nan,1\n10,95,1\n"
			  "10,20,-1\n"},
		{"x.dat", "#DIM 3 1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n#PARAM_OUT INV_STERADIAN\n.2 .1 2 1\n.2 .1 2 3\n"
			  ".2 .1 2 nan\n.2 .1 2 inf\n.2 .1 nan 1\n1.6 .1 2 1\n.2 .1 2 -1\n"},
		{"x.brdf", "3\n400 500 700\n.1 0 .2 0 1 1 1\n.1 0 .2 0 3 3 3\n.1 0 .2 0 1 nan 1\n.1 0 .2 0 1 inf 1\n"
			   ".1 nan .2 0 1 1 1\n.1 0 1.6 0 1 1 1\n.1 0 .2 0 1 -1 1\n"}};
	for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
		struct measurement m = read_text(files[i].name, files[i].text);
		assert_int_equal(m.scattered->n, 2);
		check_abs((double)m.scattered->value[1][0], 1, 1e-6, files[i].name);
		check_abs((double)m.scattered->value[1][1], 3, 1e-6, files[i].name);
		assert_true(m.scattered->solid_angle[0] == m.scattered->solid_angle[1]);
		assert_int_equal(m.n_nonfinite, 3);
		assert_int_equal(m.n_below_horizon, 1);
		assert_int_equal(m.n_negative, 1);
		measurement_free(&m);
	}
}

static void bad_alta_is_refused_with_its_line(void **state)
{
	(void)state;
	static const struct refusal refusals[] = {
		{"#DIM 2 1\n#PARAM_IN STARK_2D\n",
		 "line 2: expected PARAM_IN SPHERICAL_TL_PL_TV_PV, ISOTROPIC_TV_TL_DPHI, ISOTROPIC_TL_TV_PROJ_DPHI, "
		 "RUSIN_TH_TD_PD, RUSIN_TH_PH_TD_PD, CARTESIAN, COS_TH, COS_TH_TD, RUSIN_TH_TD, RUSIN_TH_PH_TD, "
		 "ISOTROPIC_TV_PROJ_DPHI, found 'STARK_2D'"},
		{"#DIM 3 1\n#PARAM_IN CARTESIAN\n#PARAM_OUT INV_STERADIAN\n1 2 3 4\n",
		 "line 4: expected DIM 6 for CARTESIAN, found 3"},
		{"#DIM 7 1\n", "line 1: expected DIM with 1 to 6 coordinates"},
		{"#DIM 3 2\n", "line 1: expected DIM with 1 to 6 coordinates and 1 or 3 values"},
		{"#DIM 3 1\n#VS 3\n", "line 2: expected VS with 0, 1 or 2"},
		{"#PARAM_IN CARTESIAN\n1 2 3\n", "line 2: expected DIM and PARAM_IN"},
		{"#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT ENERGY\n.1 .2 .3 1\n",
		 "line 4: expected PARAM_OUT INV_STERADIAN"},
		{"#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT XYZ_COLOR\n.1 .2 .3 1\n",
		 "line 4: expected three values for XYZ_COLOR"},
		{"#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n.1 .2 .3\n",
		 "line 4: expected 4 values, found 3"},
		{"#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n.1 .2 x 3\n",
		 "line 4: expected a number, found 'x'"},
		{"#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#FORMAT binary\n", "line 3: binary files of ALTA are not read"},
		{"#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n",
		 "no sample can be used: there is none"},
	};
	expect_refusals("x.dat", refusals, sizeof refusals / sizeof *refusals);
}

/* Cornell */

static void cornell_rows_are_spectra(void **state)
{
	(void)state;
	struct measurement m =
		read_text("x.brdf", "# a paint\r\n4\r\n# nm\r\n400 500\r\n600 700\r\n\r\n"
				    "0.3 0 0.5 2 0.1 0.1 0.1 0.1\r\n0.3 0 1.6 2 1 1 1 1\r\n0.3 0 0.5 2 0 0 0 0\r\n");
	assert_string_equal(m.format, "cornell");
	assert_int_equal(m.n_channels, 4);
	assert_int_equal(m.n_missing, 1);
	assert_int_equal(m.n_below_horizon, 1);
	check_entry(m.scattered, 0, at_degrees(0.3 * 180 / M_PI, 0), at_degrees(0.5 * 180 / M_PI, 2 * 180 / M_PI), .1,
		    .1, .1);
	measurement_free(&m);
}

static void bad_cornell_is_refused_with_its_line(void **state)
{
	(void)state;
	static const struct refusal refusals[] = {
		{"0\n400\n", "line 1: expected the number of wavelengths, 1 to 4096, alone"},
		{"2.5\n400 500\n", "line 1: expected the number of wavelengths"},
		{"5000\n400 500\n", "line 1: expected the number of wavelengths"},
		{"3\n400 500\n", "expected 3 wavelengths, found fewer"},
		{"3\n400 500\n600 700\n", "line 3: expected 3 wavelengths, found more"},
		{"2\n500 400\n.1 0 .2 0 1 1\n", "line 2: expected wavelengths that rise"},
		{"2\n400 500\n.1 0 .2 0 1\n", "line 3: expected 6 values, found 5"},
		{"2\n400 500\n.1 0 .2 0 1 1 1\n", "line 3: expected 6 values, found 7"},
		{"2\n400 500\n.1 0 .2 0 1 1.2.3\n", "line 3: expected a number, found '1.2.3'"},
		{"2\n400 500\n", "no sample can be used: there is none"},
	};
	expect_refusals("x.brdf", refusals, sizeof refusals / sizeof *refusals);
}

/* Zemax */

#define ZEMAX_HEAD                                                                                                     \
	"#by hand\nSource  Measured\nSymmetry  PlaneSymmetrical\nSpectralContent  Monochrome\nScatterType  BRDF\n"     \
	"SampleRotation  1\n0\nAngleOfIncidence  2\n20\t40\t\nScatterAzimuth 3\n0\t90\t180\nScatterRadial "            \
	"3\n0\t10\t60\n\n"                                                                                             \
	"Monochrome\nDataBegin\n"

static void zemax_angles_are_about_the_mirror_direction(void **state)
{
	(void)state;
	struct measurement m = read_text("x.bsdf", ZEMAX_HEAD
					 "TIS 0.1\n1 2 3\n1 4 5\n1 6 0\nTIS 0.2\n7 8 9\n7 10 11\n7 12 13\nDataEnd\n");
	const struct scattered *s = m.scattered;
	/* Radial 0 counts once. At 20 degrees, radial 60 away from the normal is 80, at 40 below the horizon. */
	assert_int_equal(s->n, 12);
	assert_int_equal(m.n_missing, 1);
	assert_int_equal(m.n_below_horizon, 1);
	assert_true(s->gray && s->symmetry == SYMMETRY_ISOTROPIC);
	check_entry(s, 0, at_degrees(20, 0), at_degrees(20, 180), 1, 1, 1);
	check_entry(s, 1, at_degrees(20, 0), at_degrees(10, 180), 2, 2, 2);
	check_entry(s, 2, at_degrees(20, 0), at_degrees(40, 0), 3, 3, 3);
	check_entry(s, 5, at_degrees(20, 0), at_degrees(30, 180), 6, 6, 6);
	for (int e = 3; e < 5; e++)
		check_abs(s->wo[e].x * -sin(M_PI / 9) + s->wo[e].z * cos(M_PI / 9),
			  cos((e == 3 ? 10 : 60) * M_PI / 180), 1e-14, "the angle to the mirror direction");
	/* Cells from 10 to 30 degrees of incidence, radial 0 to 5, all round. */
	check_rel((double)s->solid_angle[0],
		  2 * M_PI * (cos(M_PI / 18) - cos(M_PI / 6)) * 2 * M_PI * (1 - cos(M_PI / 36)), 1e-6, "a solid angle");
	measurement_free(&m);
}

static void zemax_leaves_out_what_is_no_number(void **state)
{
	(void)state;
	struct measurement m =
		read_text("x.bsdf", ZEMAX_HEAD "1 2 nan\n1 4 5\n1 6 7\n7 inf 9\n7 -1 11\n7 12 13\nDataEnd\n");
	assert_int_equal(m.n_nonfinite, 2);
	assert_int_equal(m.n_negative, 1);
	measurement_free(&m);
}

static void zemax_tristimulus_values_become_rgb(void **state)
{
	(void)state;
	char text[2048];
	static const char *const block[] = {"0.95047", "1", "1.08883"};
	int n = snprintf(text, sizeof text,
			 "Source Measured\nSymmetry Asymmetrical\nSpectralContent XYZ\nScatterType "
			 "BRDF\nSampleRotation 2\n0 45\n"
			 "AngleOfIncidence 1\n20\nScatterAzimuth 1\n0\nScatterRadial 1\n10\n");
	for (int c = 0; c < 3; c++)
		n += snprintf(text + n, sizeof text - (size_t)n, "Tristimulus%c\nDataBegin\nTIS 1\n%s\n%s\nDataEnd\n",
			      "XYZ"[c], block[c], block[c]);
	struct measurement m = read_text("x.bsdf", text);
	assert_int_equal(m.scattered->n, 2);
	assert_int_equal(m.scattered->symmetry, SYMMETRY_ANISOTROPIC);
	for (int c = 0; c < 3; c++)
		check_rel((double)m.scattered->value[c][1], 1, 1e-4, "white");
	measurement_free(&m);
}

static void bad_zemax_is_refused_with_its_line(void **state)
{
	(void)state;
	static const struct refusal refusals[] = {
		{"Source Measured\nScatterType BTDF\n", "line 2: expected ScatterType BRDF, found BTDF"},
		{"SampleRotation 1\n0\nAngleOfIncidence 0\n", "line 3: expected a number of angles"},
		{"SampleRotation 1\n0\nAngleOfIncidence 1000000000\n",
		 "line 3: expected a number of angles that the file can hold"},
		{"SampleRotation 2\n0\n", "expected 2 angles of SampleRotation, found fewer"},
		{"SampleRotation 2\n0 1 2\n", "line 2: expected 2 angles of SampleRotation, found more"},
		{"SampleRotation 2\n1 0\n", "line 2: expected angles of SampleRotation that rise"},
		{"SampleRotation 1\n0\nSampleRotation 1\n0\n", "line 3: SampleRotation comes twice"},
		{"SampleRotation 1\n0\nDataBegin\n", "line 3: expected AngleOfIncidence before DataBegin"},
		{"SampleRotation 1\n0\nSpectralContent RGB\n",
		 "line 3: expected SpectralContent Monochrome or XYZ, found 'RGB'"},
		{"SampleRotation 1\n0\n", "expected DataBegin, found the end of the file"},
		{"#Measured on a sunny day\nIt was wh", "line 2: expected DataBegin, found the end of the file"},
		{ZEMAX_HEAD "1 2 3\n", "line 17: expected a row of values, found the end of the file"},
		{ZEMAX_HEAD "1 2\n", "line 17: expected 3 values, found 2"},
		{ZEMAX_HEAD "1 2 3 4\n", "line 17: expected 3 values, found 4"},
		{ZEMAX_HEAD "1 2 3\nDataEnd\n", "line 18: expected 6 rows of values, found 1"},
		{ZEMAX_HEAD "1 2 3\n1 2 3\n1 2 3\n1 2 3\n1 2 3\n1 2 3\n1 2 3\n",
		 "line 23: expected DataEnd behind 6 rows"},
		{ZEMAX_HEAD "0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\nDataEnd\n", "no sample can be used"},
	};
	expect_refusals("x.bsdf", refusals, sizeof refusals / sizeof *refusals);
}

/* The door */

static void the_content_tells_the_format(void **state)
{
	(void)state;
	static const struct {
		const char *text, *format;
	} cases[] = {{"theta_i,theta_o,value\n1,2,3\n", "csv"},
		     {"#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n.1 .2 .3 1\n", "alta"},
		     {"2\n400 500\n.1 0 .2 0 1 1\n", "cornell"},
		     {ZEMAX_HEAD "1 2 3\n1 2 3\n1 2 3\n1 2 3\n1 2 3\n1 2 3\nDataEnd\n", "zemax"}};
	static const char *const names[] = {"x", "x.binary", "x.csv", "x.dat", "x.brdf", "x.bsdf", "x.txt"};
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
		for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
			struct measurement m = read_text(names[i], cases[c].text);
			assert_string_equal(m.format, cases[c].format);
			measurement_free(&m);
		}
}

static void a_file_of_no_known_format_is_refused(void **state)
{
	(void)state;
	struct measurement m;
	struct error error;
	assert_int_equal(read_as("x.txt", "Dear reader,\nhello.\n", QUANTITY_FROM_FILE, &m, &error), STATUS_FORMAT);
	assert_non_null(strstr(error.text, "its format is not known: expected MERL table"));
	assert_int_equal(measurement_read("none.csv", NULL, &m, &error), STATUS_IO);
	assert_int_equal(measurement_read(".", NULL, &m, &error), STATUS_FORMAT);
	assert_non_null(strstr(error.text, "found a directory"));
	assert_int_equal(read_as("x.csv", "", QUANTITY_FROM_FILE, &m, &error), STATUS_FORMAT);
	assert_non_null(strstr(error.text, "the file is empty"));
}

static void in_a_directory_name_and_content_count(void **state)
{
	(void)state;
	static const struct {
		const char *name, *text;
		bool known;
	} cases[] = {{"a.csv", "theta_i,theta_o,value\n1,2,3\n", true},
		     {"a.CSV", "theta_i,theta_o,value\n1,2,3\n", true},
		     {"a.txt", "theta_i,theta_o,value\n1,2,3\n", false},
		     {"a.csv", "file,theta_i,theta_o,value\n1,2,3\n", false},
		     {"a.csv", "material,ndf,error\n", false},
		     {"a.brdf", "analytic\n::begin parameters\n", false},
		     {"a.brdf", "2\n400 500\n", true},
		     {"a.dat", "1 2 3\n", false},
		     {"a.binary", "anything", true},
		     {".csv", "theta_i,theta_o,value\n1,2,3\n", false}};
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
		write_file(cases[c].name, cases[c].text, strlen(cases[c].text));
		if (measurement_is_known(cases[c].name) != cases[c].known)
			fail_msg("%s: %s", cases[c].name, cases[c].text);
		unlink(cases[c].name);
	}
	assert_int_equal(measurement_extension("a.b.csv"), 4);
	assert_int_equal(measurement_extension("a.binary"), 7);
	assert_int_equal(measurement_extension("dir/.csv"), 0);
	assert_int_equal(measurement_extension("csv"), 0);
	assert_false(measurement_is_known("none.csv"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_are_those_of_strtod),
		cmocka_unit_test(what_is_no_number_is_refused),
		cmocka_unit_test(a_number_ends_where_its_text_does),
		cmocka_unit_test(a_white_spectrum_is_white),
		cmocka_unit_test(spectra_have_their_colours),
		cmocka_unit_test(wavelengths_that_do_not_reach_far_are_gray),
		cmocka_unit_test(wavelengths_must_rise),
		cmocka_unit_test(a_grid_has_its_own_cells),
		cmocka_unit_test(turned_samples_have_cells_of_four_angles),
		cmocka_unit_test(equal_entries_share_their_cell),
		cmocka_unit_test(scattered_cells_integrate),
		cmocka_unit_test(directions_may_be_given_in_every_way),
		cmocka_unit_test(in_the_plane_a_positive_angle_is_the_mirror_side),
		cmocka_unit_test(the_quantity_is_that_of_option_or_file),
		cmocka_unit_test(what_cannot_be_used_is_counted),
		cmocka_unit_test(spectra_are_masked_as_a_whole),
		cmocka_unit_test(several_azimuths_mean_anisotropic_unless_said),
		cmocka_unit_test(bad_csv_is_refused_with_its_line),
		cmocka_unit_test(odd_bytes_are_refused_with_their_line),
		cmocka_unit_test(many_lines_are_read),
		cmocka_unit_test(alta_coordinates_are_one_pair_of_directions),
		cmocka_unit_test(alta_half_and_difference_angles_are_understood),
		cmocka_unit_test(alta_cosines_and_fewer_angles_are_understood),
		cmocka_unit_test(alta_values_are_divided_by_the_cosine_of_the_view),
		cmocka_unit_test(every_format_counts_what_it_leaves_out),
		cmocka_unit_test(bad_alta_is_refused_with_its_line),
		cmocka_unit_test(cornell_rows_are_spectra),
		cmocka_unit_test(bad_cornell_is_refused_with_its_line),
		cmocka_unit_test(zemax_angles_are_about_the_mirror_direction),
		cmocka_unit_test(zemax_leaves_out_what_is_no_number),
		cmocka_unit_test(zemax_tristimulus_values_become_rgb),
		cmocka_unit_test(bad_zemax_is_refused_with_its_line),
		cmocka_unit_test(the_content_tells_the_format),
		cmocka_unit_test(a_file_of_no_known_format_is_refused),
		cmocka_unit_test(in_a_directory_name_and_content_count),
	};
	return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
