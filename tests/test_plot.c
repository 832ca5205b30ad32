/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots: the numbers behind them, and `stdfit plot`. Runs $STDFIT or build/stdfit. */
#include "fit/plot/error_map.h"
#include "fit/plot/gnuplot.h"
#include "fit/plot/measured_ndf.h"
#include "fit/plot/slice.h"
#include "make_table.h"
#include "run_program.h"

#include <signal.h>

/* A fit that takes a moment. */
#define CHEAP "--ndf ggx,beckmann --sigma 0.2 --ior 1.5 --max-theta 20"
/* A material's name that would do harm in a script, a shell or a page. */
#define ODD "a'b\\\"<i>&\\`touch harm\\`\\n{x}^_"

/* A noisy table that several tests look at, and its model. */
#define NOISE 0.2
static struct measurement measured_table;
static struct cook_torrance table_model;

static void mask_entry(struct measurement *measurement, int i, int j, int k)
{
	for (int c = 0; c < 3; c++)
		measurement->value[c][measurement_at(measurement->n_phi_d, i, j, k)] = NAN;
}

/* The rows of the map add up to E, under each weight, bins and G; a single row is what the model itself says. */
static void the_map_adds_up_to_the_error(void **state)
{
	(void)state;
	static struct metrics_row rows[MERL_ROWS];
	for (int k = 0; k < measured_table.n_phi_d; k++)
		mask_entry(&measured_table, 30, 20, k);
	for (int run = 0; run < 4; run++) {
		struct fit_options options = fit_options_default();
		struct cook_torrance model = make_model("std", 0.19, 2.385, 1.5);
		/* Centres: then the table is of something else, and adds up as well. */
		options.criterion.bins = run == 1 ? BINS_CENTRE : BINS_NODE;
		options.criterion.weight = (enum weight)(run % WEIGHT_COUNT);
		options.criterion.max_theta = run == 2 ? 71 : 90;
		model.gaf = options.criterion.gaf = run == 3 ? GAF_V_GROOVE : GAF_UNCORRELATED;
		struct fit_metrics metrics;
		struct error error;
		double difference = 0, measured = 0;
		size_t n = 0;
		assert_int_equal(fit_eval(&measured_table, &model, &options, &metrics, &error), STATUS_OK);
		assert_int_equal(error_map_make(&measured_table, &model, &options, rows), STATUS_OK);
		for (int r = 0; r < MERL_ROWS; r++) {
			difference += rows[r].difference;
			measured += rows[r].measured;
			n += rows[r].samples;
		}
		check_rel(difference / measured, metrics.error[options.criterion.weight], 1e-12, "sum of the map");
		assert_int_equal(n, metrics.samples);
		assert_int_equal(rows[30 * MERL_THETA_D + 20].samples, 0);
		assert_true(isnan(error_map_error(&rows[30 * MERL_THETA_D + 20])));
	}
}

static void a_row_of_the_map_is_what_the_model_says(void **state)
{
	(void)state;
	static struct metrics_row rows[MERL_ROWS];
	enum { I = 41, J = 55 };
	const struct cook_torrance model = make_model("std", 0.19, 2.385, 1.5);
	const struct fit_options options = fit_options_default();
	double difference = 0, measured = 0;
	for (int k = 0; k < 180; k++) {
		struct vec3 wi, wo;
		double f[3];
		halfdiff_trig_dirs(bins_trig(BINS_NODE, I, J, k), &wi, &wo);
		cook_torrance_f(&model, wi, wo, f);
		for (int c = 0; c < 3 && wi.z > 1e-9 && wo.z > 1e-9; c++) {
			const double m = (double)measured_table.value[c][measurement_at(180, I, J, k)];
			difference += fabs(m - f[c]);
			measured += m;
		}
	}
	assert_int_equal(error_map_make(&measured_table, &model, &options, rows), STATUS_OK);
	check_rel(error_map_error(&rows[I * MERL_THETA_D + J]), difference / measured, 1e-7, "error of a row");
	const struct metrics_row perfect = {0, 0, 3}, black = {2, 2, 3}, dark = {1, 0, 3};
	check_abs(error_map_error(&perfect), 0, 0, "nothing measured, nothing modelled");
	check_abs(error_map_error(&black), 1, 0, "a black model");
	assert_true(isinf(error_map_error(&dark)));
}

/* With the true kd, ks, n and a G that knows no NDF, what is read is the table's D, whatever D the model has. */
static void the_ndf_is_read_off_the_table(void **state)
{
	(void)state;
	for (int bins = 0; bins < BINS_COUNT; bins++) {
		struct cook_torrance truth = make_model("ggx", 0.17, 2, 1.62), model = truth;
		struct measured_ndf ndf;
		truth.gaf = model.gaf = GAF_V_GROOVE;
		model.ndf = make_model("beckmann", 0.4, INFINITY, 1.5).ndf;
		struct measurement measurement = make_table(&truth, 180, (enum bins)bins, 0);
		assert_int_equal(measured_ndf_make(&measurement, &model, (enum bins)bins, &ndf), STATUS_OK);
		for (int i = 0; i < 84; i++) {
			const struct halfdiff_trig h = bins_trig((enum bins)bins, i, 0, 0);
			check_rel(ndf.D[i], ndf_D(&truth.ndf, (struct vec3){h.sin_h, 0, h.cos_h}), 2e-5, "D");
		}
		assert_true(isnan(ndf.D[89])); /* steeper than 80 degrees */
		measured_ndf_free(&ndf);
		measurement_free(&measurement);
	}
}

/* What a model has beside its first lobe is no part of that lobe's D, and F82 has an F for each channel. */
static void other_terms_are_no_part_of_the_ndf(void **state)
{
	(void)state;
	struct cook_torrance truth = make_model("ggx", 0.17, 2, 1.62);
	struct measured_ndf ndf;
	truth.gaf = GAF_V_GROOVE;
	truth.fresnel = FRESNEL_F82;
	truth.second = make_model("ggx", 0.6, 2, 1.62).ndf;
	truth.grazing = 4;
	for (int c = 0; c < 3; c++) {
		truth.kg[c] = 0.3;
		truth.ks_second[c] = 0.4;
		truth.reflectance[c][0] = 0.1 + 0.2 * c;
		truth.reflectance[c][1] = 0.5 + 0.1 * c;
		truth.reflectance[c][2] = 1;
	}
	struct measurement measurement = make_table(&truth, 180, BINS_NODE, 0);
	assert_int_equal(measured_ndf_make(&measurement, &truth, BINS_NODE, &ndf), STATUS_OK);
	for (int i = 0; i < 84; i += 3) {
		const struct halfdiff_trig h = bins_trig(BINS_NODE, i, 0, 0);
		check_rel(ndf.D[i], ndf_D(&truth.ndf, (struct vec3){h.sin_h, 0, h.cos_h}), 1e-4, "D");
	}
	measured_ndf_free(&ndf);
	measurement_free(&measurement);
}

/* A perfect fit: no normalisation is needed, and G1 is the fit's own. */
static void a_perfect_fit_reads_itself(void **state)
{
	(void)state;
	static const enum gaf gaf[] = {GAF_UNCORRELATED, GAF_CORRELATED};
	for (int g = 0; g < 2; g++) {
		struct cook_torrance model = make_model(g ? "ggx" : "std", 0.21, 1.8, 1.5);
		struct measured_ndf ndf;
		model.gaf = gaf[g];
		struct measurement measurement = make_table(&model, 180, BINS_NODE, 0);
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < 180; k++)
				mask_entry(&measurement, 33, j, k);
		assert_int_equal(measured_ndf_make(&measurement, &model, BINS_NODE, &ndf), STATUS_OK);
		assert_true(isnan(ndf.D[33]));
		check_rel(ndf.D[34], ndf_D(&model.ndf, vec3_from_spherical_deg(34 * 34 / 90.0, 0)), 2e-5, "D");
		check_rel(ndf.scale, 1, 2e-3, "scale");
		for (int a = 5; a < 90; a += 7) {
			const struct vec3 w = vec3_from_spherical_deg(a, 0);
			check_abs(pwl_G1(&ndf.pwl, w), ndf_G1(&model.ndf, w), 2e-3, "G1");
		}
		measured_ndf_free(&ndf);
		measurement_free(&measurement);
	}
}

/* A free form with a dip where the readings end: what it has behind that counts as it is. */
static void a_dip_of_a_free_form_raises_no_tail(void **state)
{
	(void)state;
	enum { NODES = MERL_THETA_H + 1 };
	struct cook_torrance truth = make_model("ggx", 0.3, 2, 1.5), model = truth;
	double theta[NODES], value[NODES];
	struct measured_ndf ndf;
	struct pwl pwl;
	truth.gaf = model.gaf = GAF_V_GROOVE;
	for (int i = 0; i < NODES; i++) {
		theta[i] = i < MERL_THETA_H ? i * i / 90.0 * M_PI / 180 : M_PI / 2;
		const bool dip = theta[i] > 1.3 && theta[i] < 1.4;
		value[i] = ndf_D(&truth.ndf, (struct vec3){sin(theta[i]), 0, cos(theta[i])}) / (dip ? 100 : 1);
	}
	assert_int_equal(pwl_init(&pwl, NODES, theta, value, NULL), STATUS_OK);
	ndf_from_pwl(&model.ndf, &pwl);
	struct measurement measurement = make_table(&truth, 180, BINS_NODE, 0);
	assert_int_equal(measured_ndf_make(&measurement, &model, BINS_NODE, &ndf), STATUS_OK);
	for (int a = 5; a < 90; a += 7) {
		const struct vec3 w = vec3_from_spherical_deg(a, 0);
		check_abs(pwl_G1(&ndf.pwl, w), ndf_G1(&truth.ndf, w), 0.02, "G1");
	}
	measured_ndf_free(&ndf);
	measurement_free(&measurement);
	pwl_free(&pwl);
}

static void no_ndf_where_there_is_none(void **state)
{
	(void)state;
	struct cook_torrance model = table_model;
	struct measured_ndf ndf;
	struct measurement measurement;
	for (int c = 0; c < 3; c++)
		model.ks[c] = 0;
	assert_int_equal(measured_ndf_make(&measured_table, &model, BINS_NODE, &ndf), STATUS_NO_DATA);
	/* Nothing is above the diffuse part. */
	for (int c = 0; c < 3; c++) {
		model.ks[c] = 1;
		model.kd[c] = 1e6;
	}
	assert_int_equal(measured_ndf_make(&measured_table, &model, BINS_NODE, &ndf), STATUS_NO_DATA);
	assert_int_equal(measurement_alloc(&measurement, 180), STATUS_OK);
	assert_int_equal(measured_ndf_make(&measurement, &model, BINS_NODE, &ndf), STATUS_NO_DATA);
	measured_ndf_free(&ndf);
	measurement_free(&measurement);
}

static void slices_are_the_table(void **state)
{
	(void)state;
	double m[3], f[3];
	for (int i = 0; i < 90; i += 11) {
		slice_measured(&measured_table, SLICE_ACROSS, i, 45, m);
		slice_model(&table_model, BINS_NODE, SLICE_ACROSS, i, 45, f);
		for (int c = 0; c < 3; c++)
			check_rel(m[c], f[c], NOISE, "slice");
	}
	slice_measured(&measured_table, SLICE_ACROSS, 45, 0, m);
	check_rel(m[1], (double)measured_table.value[1][90 + 180 * 90 * 45], 0, "where a slice lies");
	mask_entry(&measured_table, 3, 45, 90);
	slice_measured(&measured_table, SLICE_ACROSS, 3, 45, m);
	assert_true(isnan(m[0]) && isnan(m[2]));
	/* In the mirror plane, where what is below the horizon has no value. */
	slice_measured(&measured_table, SLICE_IN_PLANE, 45, 30, m);
	check_rel(m[1], (double)measured_table.value[1][180 * (90 * 45 + 30)], 0, "where the other slice lies");
	slice_model(&table_model, BINS_NODE, SLICE_IN_PLANE, 45, 30, f);
	check_rel(m[1], f[1], NOISE, "slice in the mirror plane");
	slice_model(&table_model, BINS_NODE, SLICE_IN_PLANE, 80, 30, f);
	assert_true(isnan(f[0]) && isnan(f[2]));
}

static void names_are_harmless_in_scripts(void **state)
{
	(void)state;
	char *text = NULL;
	size_t size;
	FILE *file = open_memstream(&text, &size);
	gnuplot_string(file, "it's\n\"\\\xff`x`");
	assert_int_equal(fclose(file), 0);
	assert_string_equal(text, "'it'.\"'\".'s\\x0a\"\\\\xff`x`'");
	free(text);
}

/* The program */

static void expect_files(const char *directory, const char *const *name, bool there)
{
	for (; *name; name++) {
		char path[256];
		snprintf(path, sizeof path, "%s/%s", directory, *name);
		if ((access(path, F_OK) == 0) != there)
			fail_msg("%s is %s", path, there ? "missing" : "there");
	}
}

static const char *const sources[] = {"map.csv", "map.gp",    "ndf_D.csv",   "ndf_G1.csv", "slices.csv",
				      "ndf.gp",  "slices.gp", "slices_0.gp", NULL};
static const char *const pictures[] = {"map.png",    "map.svg",      "ndf.png",      "ndf.svg", "slices.png",
				       "slices.svg", "slices_0.png", "slices_0.svg", NULL};
static const char *const errors_sources[] = {"errors.csv", "errors.gp", NULL};
static const char *const errors_pictures[] = {"errors.png", "errors.svg", NULL};

static void expect_nothing_left(void)
{
	shell("find . -name '*.tmp' -o -name '.stdfit*' -o -name harm");
	assert_string_equal(last.out, "");
}

static void a_table_becomes_pictures(void **state)
{
	(void)state;
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	stdfit("plot fits.csv -o out");
	expect_code(0);
	assert_string_equal(last.out, "");
	assert_string_equal(last.err, "");
	expect_files("out", errors_sources, true);
	expect_files("out", errors_pictures, true);
	expect_files("out/a", sources, true);
	expect_files("out/a", pictures, true);
	/* Of the rows beyond --max-theta nothing is known. */
	shell("tail -n 1 out/a/map.csv");
	expect_out("89,89,88.0111111,89,0,NaN,NaN\n");
	/* The odd name has become a plain one; no part of it was run or has become markup. */
	expect_files("out/a_b__i___touch_harm__n_x___", pictures, true);
	shell("grep -c '<i>' out/*/*.svg out/*.svg | grep -v ':0$'");
	assert_string_equal(last.out, "");
	expect_nothing_left();
	/* Whole pictures of the format that their names say. */
	shell("for f in out/*.png out/*/*.png; do head -c 4 $f | tail -c 3; tail -c 8 $f | head -c 4; done; "
	      "tail -qn 1 out/*.svg out/*/*.svg");
	expect_out("PNGIENDPNGIEND");
	shell("for f in out/*.svg out/*/*.svg; do grep -q '</svg>' $f || echo $f; done");
	assert_string_equal(last.out, "");
	/* The script draws again, by itself and in its place. In a locale that has no degree sign gnuplot warns of that. */
	shell("cd out/a && rm *.png *.svg && for f in *.gp; do LC_ALL=C.UTF-8 gnuplot $f; done");
	expect_code(0);
	assert_string_equal(last.err, "");
	expect_files("out/a", pictures, true);
}

/* What the table lacks does not keep the rest from being drawn. */
static void what_is_missing_is_told(void **state)
{
	(void)state;
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	shell("mkdir -p gone; cp a.binary gone/b.binary; \"$STDFIT\" fit a.binary gone/b.binary " CHEAP
	      " -q -o two.csv; rm gone/b.binary");
	stdfit("plot two.csv -o two");
	expect_error(1, "cannot read 'gone/b.binary'");
	expect_files("two/a", pictures, true);
	expect_files("two", errors_pictures, true);
	/* Other bytes under the same name. */
	shell("\"$STDFIT\" synth gone/b.binary --kd 0.1");
	stdfit("plot two.csv -o two");
	expect_error(1, "'gone/b.binary': it is not the file any more that was fitted");
}

static void without_gnuplot_one_line_says_so(void **state)
{
	(void)state;
	shell("PATH=/nowhere exec \"$STDFIT\" plot fits.csv -o bare");
	expect_error(1, "gnuplot is not installed");
	expect_files("bare", errors_sources, true);
	expect_files("bare", errors_pictures, false);
	expect_files("bare/a", sources, true);
	expect_files("bare/a", pictures, false);
	/* One that fails is quoted, and what it began is gone. */
	write_text("gnuplot", "#!/bin/sh\nfor last; do :; done\ntouch ${last%.gp}.png$(echo \"$*\" | cut -d\\' -f2)\n"
			      "echo 'no such terminal' >&2\nexit 3\n");
	shell("mkdir fake; chmod +x gnuplot; mv gnuplot fake; head -n 3 fits.csv >one.csv; PATH=$PWD/fake:$PATH exec "
	      "\"$STDFIT\" plot one.csv -o faked");
	expect_code(1);
	assert_int_equal(count_lines(last.err), 2);
	assert_non_null(strstr(last.err, "gnuplot cannot draw in 'faked/a': no such terminal"));
	expect_files("faked/a", sources, true);
	expect_files("faked/a", pictures, false);
	expect_nothing_left();
}

static void wrong_input_is_refused(void **state)
{
	(void)state;
	write_text("other.csv", "name,value\nx,1\n");
	write_text("empty.csv", "");
	write_text("bad_trace.csv",
		   "material,ndf,algorithm,stage,evaluations,seconds,error\na,ggx,x,full,1,soon,0.5\n");
	write_text("no_trace.csv", "material,ndf,algorithm,stage,evaluations,seconds,error\n");
	shell("head -n 1 fits.csv >rowless.csv; sed 's/,ggx,/,phong,/' fits.csv >phong.csv; sed "
	      "'2,$s/converged/failed: x/' "
	      "fits.csv >failed.csv; touch file; mkdir own; cp fits.csv own/errors.csv; cp no_trace.csv own/trace.csv");
	static const struct {
		const char *arguments, *message;
		int code;
	} wrong[] = {
		{"plot fits.csv", "expected -o DIR", 2},
		{"plot -o out", "expected PATH", 2},
		{"plot fits.csv a.binary -o x", "expected one table and nothing beside it", 2},
		{"plot fits.csv -o x --ndf ggx", "--ndf means nothing", 2},
		{"plot fits.csv -o x --json", "'--json'", 2},
		{"plot a.binary -o x --no-diffuse --no-specular", "leave nothing", 2},
		{"plot other.csv -o x", "'other.csv' line 1: expected a header with column material", 1},
		{"plot empty.csv -o x", "'empty.csv'", 1},
		{"plot none.csv -o x", "cannot read 'none.csv'", 1},
		{"plot rowless.csv -o x", "'rowless.csv' has no rows", 1},
		{"plot bad_trace.csv -o x", "'bad_trace.csv' line 2: expected a number in column seconds", 1},
		{"plot no_trace.csv -o x", "no points", 1},
		{"plot own/trace.csv -o own", "expected another directory: trace.csv in this one", 2},
		{"plot own/errors.csv -o ./own/", "expected another directory: errors.csv in this one", 2},
		{"plot none.binary -o x", "none.binary", 1},
		{"plot fits.csv -o file", "cannot write to directory 'file': Not a directory", 1},
		{"plot fits.csv -o no/such", "cannot write to directory 'no/such'", 1},
	};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		stdfit(wrong[i].arguments);
		if (!strstr(wrong[i].arguments, "none.binary"))
			expect_error(wrong[i].code, wrong[i].message);
		expect_code(wrong[i].code);
		assert_string_equal(last.out, "");
	}
	stdfit("plot phong.csv -o x");
	expect_code(1);
	assert_non_null(strstr(last.err, "'phong'"));
	stdfit("plot failed.csv -o x");
	expect_code(1);
	assert_non_null(strstr(last.err, "it has no fit"));
	expect_nothing_left();
}

static void a_trace_becomes_a_picture(void **state)
{
	(void)state;
	write_text("t.csv", "material,ndf,algorithm,stage,evaluations,seconds,error\n"
			    "\"x,y\",std,default,full,1,0.1,0.9\n\"x,y\",std,default,full,9,1,0.3\n"
			    "\"x,y\",std,crs2,full,1,0.1,0.9\n\"x,y\",std,crs2,full,9,2,0.35\n"
			    "\"x,y\",std,crs2-joint,full,9,2,0.31\n");
	shell("PATH=/nowhere exec \"$STDFIT\" plot t.csv -o traces");
	expect_error(1, "gnuplot is not installed");
	char *text = slurp("traces/trace.csv");
	/* The curve that ended early goes on flat. */
	assert_string_equal(text,
			    "\"default\",error\n0.1,0.9\n1,0.3\n2,0.3\n\n\n\"crs2\",error\n0.1,0.9\n2,0.35\n2,0.35\n"
			    "\n\n\"crs2-joint\",error\n2,0.31\n2,0.31\n");
	free(text);
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	stdfit("plot t.csv -o traces");
	expect_code(0);
	assert_string_equal(last.err, "");
	shell("grep -c crs2-joint traces/trace.svg; head -c 4 traces/trace.png | tail -c 3");
	expect_out("2\nPNG");
	/* A fall over many powers of ten, as of a table without noise, is shown whole. */
	write_text("deep.csv", "material,ndf,algorithm,stage,evaluations,seconds,error\n"
			       "m,std,default,scan,1,0.001,0.3\nm,std,default,full,2,0.01,2e-6\n");
	shell("PATH=/nowhere exec \"$STDFIT\" plot deep.csv -o deep");
	shell("grep -x 'set logscale xy' deep/trace.gp && grep -x 'set yrange \\[1e-06:1\\]' deep/trace.gp");
	expect_code(0);
}

/* A fit searches an NDF more than once: on one clock, and what thinned tables say is no news behind a full one. */
static void searches_of_a_fit_become_one_curve(void **state)
{
	(void)state;
	static const char restarts[] = "NR > 1 && $2 == ndf && ($5 < n || $6 < s) {print \"back\"}\n"
				       "$2 == ndf && was == \"full\" && $4 ~ /thin/ {print \"again\"}\n"
				       "{ndf = $2; was = $4; n = $5; s = $6}\n";
	write_text("restarts.awk", restarts);
	stdfit("fit a.binary --ndf std,ggx --ior 1.5 --max-theta 20 --trace course.csv -o course-fits.csv");
	expect_code(0);
	shell("awk -F, -f restarts.awk course.csv");
	assert_string_equal(last.out, "again\n");
	write_text("t.csv", "material,ndf,algorithm,stage,evaluations,seconds,error\n"
			    "m,std,default,thin-1,1,0.1,0.2\nm,std,default,full,9,1,0.3\n"
			    "m,std,default,thin-1,10,1.5,0.2\nm,std,default,full,11,2,0.31\n"
			    "m,std,default,full,12,3,0.29\nm,ggx,default,full,1,4,0.5\n"
			    "k,ggx,default,full,1,4,0.4\n");
	shell("PATH=/nowhere exec \"$STDFIT\" plot t.csv -o course");
	expect_error(1, "gnuplot is not installed");
	char *text = slurp("course/trace.csv");
	assert_string_equal(text, "\"m, std\",error\n0.1,0.2\n1,0.3\n3,0.29\n4,0.29\n"
				  "\n\n\"m, ggx\",error\n4,0.5\n4,0.5\n\n\n\"k, ggx\",error\n4,0.4\n4,0.4\n");
	free(text);
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	stdfit("plot t.csv -o course");
	expect_code(0);
	shell("grep -c 'm, std' course/trace.svg");
	assert_string_equal(last.out, "2\n");
}

static void errors_are_sorted(void **state)
{
	(void)state;
	shell("head -n 1 fits.csv >many.csv; r=$(sed -n 2p fits.csv | cut -d, -f4- | sed s,a.binary,gone,); for m in "
	      "'p,std,0.3' 'p,ggx,0.35' "
	      "'q,std,0.1' 'q,ggx,0.5' 'r,std,0.2'; do echo \"$m,$r\" >>many.csv; done; "
	      "PATH=/nowhere \"$STDFIT\" plot many.csv -o many");
	expect_code(1);
	char *text = slurp("many/errors.csv");
	assert_string_equal(text, "material,\"std\",\"ggx\"\n\"q\",0.1,0.5\n\"r\",0.2,NaN\n\"p\",0.3,0.35\n");
	free(text);
}

/* Files are fitted first; the odd names of two that become one are told apart. */
static void files_are_fitted_first(void **state)
{
	(void)state;
	shell("mkdir -p fresh; cp a.binary 'fresh/x y.binary'; cp a.binary fresh/x_y.binary; PATH=/nowhere exec "
	      "\"$STDFIT\" "
	      "plot fresh -q -o new " CHEAP);
	expect_error(1, "gnuplot is not installed");
	expect_files("new/x_y", sources, true);
	expect_files("new/x_y-2", sources, true);
	/* No line joins materials; curves differ in their dashes, too. */
	shell("grep -c 'with points' new/errors.gp; grep -c 'with lines' new/errors.gp");
	assert_string_equal(last.out, "1\n0\n");
	shell("grep -c 'dt 2 .*\"\\?.ggx.*dt 3 .*beckmann' new/x_y/slices.gp new/x_y/slices_0.gp");
	assert_string_equal(last.out, "new/x_y/slices.gp:18\nnew/x_y/slices_0.gp:18\n");
	/* Why one has no fit is told once. */
	write_text("text.binary", "text\n");
	stdfit("plot text.binary -o none " CHEAP);
	expect_error(1, "cannot read 'text.binary'");
}

static void it_can_be_interrupted(void **state)
{
	(void)state;
	shell("mkdir -p slow; printf '#!/bin/sh\\ntouch ../../begun ../begun\\nexec sleep 100\\n' >slow/gnuplot; chmod "
	      "+x "
	      "slow/gnuplot; mkdir -p held; PATH=$PWD/slow:$PATH \"$STDFIT\" plot fits.csv -o held/out & pid=$!; until "
	      "[ -e "
	      "held/begun ]; do sleep 0.02; kill -0 $pid || exit 1; done; kill -INT $pid; wait $pid");
	expect_code(130);
	assert_string_equal(last.err, "");
	expect_files("held/out", errors_sources, true);
	expect_nothing_left();
}

static int set_up(void **state)
{
	if (enter_directory(state))
		return -1;
	table_model = make_model("ggx", 0.23, 2, 1.62);
	measured_table = make_table(&table_model, 180, BINS_NODE, NOISE);
	shell("\"$STDFIT\" synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5 && ln a.binary "
	      "\"" ODD ".binary\" && \"$STDFIT\" fit *.binary -q -o fits.csv " CHEAP);
	return last.code;
}

static int tear_down(void **state)
{
	measurement_free(&measured_table);
	return leave_directory(state);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_map_adds_up_to_the_error),
		cmocka_unit_test(a_row_of_the_map_is_what_the_model_says),
		cmocka_unit_test(the_ndf_is_read_off_the_table),
		cmocka_unit_test(other_terms_are_no_part_of_the_ndf),
		cmocka_unit_test(a_perfect_fit_reads_itself),
		cmocka_unit_test(a_dip_of_a_free_form_raises_no_tail),
		cmocka_unit_test(no_ndf_where_there_is_none),
		cmocka_unit_test(slices_are_the_table),
		cmocka_unit_test(names_are_harmless_in_scripts),
		cmocka_unit_test(a_table_becomes_pictures),
		cmocka_unit_test(what_is_missing_is_told),
		cmocka_unit_test(without_gnuplot_one_line_says_so),
		cmocka_unit_test(wrong_input_is_refused),
		cmocka_unit_test(a_trace_becomes_a_picture),
		cmocka_unit_test(searches_of_a_fit_become_one_curve),
		cmocka_unit_test(errors_are_sorted),
		cmocka_unit_test(files_are_fitted_first),
		cmocka_unit_test(it_can_be_interrupted),
	};
	return cmocka_run_group_tests_name("plot", tests, set_up, tear_down);
}
