/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models whose NDF is given beyond sigma and gamma: a table of nodes, along one axis or two; an ellipsoid. */
#include "chi_square.h"
#include "fit/export/model_json.h"
#include "fit/render/surface.h"
#include "run_program.h"
#include "src/energy.h"
#include "src/ndf_cdf.h"
#include "src/ndf_slopes.h"
#include "src/quadrature.h"
#include "src/sampling.h"

#define DEGREE (M_PI / 180)

/* Two marginals that no formula has. */
enum { NODES = 7 };
static const double node_theta[NODES] = {0, 8, 17, 30, 45, 70, 90};
static const double node_x[NODES] = {3, 2.5, 2.2, 0.7, 0.2, 0.05, 0.01}, node_y[NODES] = {3, 1.4, 0.4, 0.3, 0.15, 0, 0};

static struct pwl two_tables(void)
{
	struct pwl pwl;
	double theta[NODES];
	for (int i = 0; i < NODES; i++)
		theta[i] = node_theta[i] * DEGREE;
	assert_int_equal(pwl_init(&pwl, NODES, theta, node_x, node_y), STATUS_OK);
	return pwl;
}

static void write_nodes(const char *path)
{
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs("Dx,theta,note,Dy\n", file);
	for (int i = 0; i < NODES; i++)
		fprintf(file, "%.17g,%.17g,any,%.17g\n", node_x[i], node_theta[i], node_y[i]);
	assert_int_equal(fclose(file), 0);
}

/* Nodes of GGX along two azimuths. */
static void write_ggx(const char *path, double sigma_x, double sigma_y)
{
	struct ndf ggx;
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	assert_int_equal(ndf_init(&ggx, ndf_find("ggx"), sigma_x, sigma_y, NAN), STATUS_OK);
	fputs(sigma_x == sigma_y ? "theta,D\n" : "theta,Dx,Dy\n", file);
	for (int i = 0; i <= 360; i++) {
		fprintf(file, "%.17g,%.17g", 0.25 * i, ndf_D(&ggx, vec3_from_spherical_deg(0.25 * i, 0)));
		if (sigma_x != sigma_y)
			fprintf(file, ",%.17g", ndf_D(&ggx, vec3_from_spherical_deg(0.25 * i, 90)));
		fputs("\n", file);
	}
	assert_int_equal(fclose(file), 0);
}

/* A number of the last run's JSON. */
static double json_number(const char *name)
{
	char key[64];
	snprintf(key, sizeof key, "\"%s\": ", name);
	const char *at = strstr(last.out, key);
	if (!at)
		fail_msg("no %s in: %s", name, last.out);
	return strtod(at + strlen(key), NULL);
}

/* The slopes */

struct slope_line {
	double phi, q;
	const struct ndf *ndf;
};

/* At the slope tan(t) across phi. */
static double P22_across(double t, void *data)
{
	const struct slope_line *line = data;
	const double c = cos(line->phi), s = sin(line->phi), p = tan(t);
	return ndf_P22(line->ndf, line->q * c - p * s, line->q * s + p * c) * (1 + p * p);
}

static void P2_is_the_integral_of_P22_across(void **state)
{
	(void)state;
	struct pwl pwl = two_tables();
	struct ndf ndf;
	ndf_from_pwl(&ndf, &pwl);
	assert_true(ndf_is_anisotropic(&ndf));
	assert_int_equal(ndf_turn(&ndf, 25), STATUS_OK);
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 5; j++) {
			struct slope_line line = {0.5 * i, 0.35 * j, &ndf};
			double sum = 0;
			for (int k = -40; k < 40; k++)
				sum += quadrature_adaptive(P22_across, &line, M_PI / 80 * k, M_PI / 80 * (k + 1),
							   1e-10);
			check_rel(ndf_P2(&ndf, line.phi, line.q), sum, 1e-5, "P2 of two tables");
		}
	pwl_free(&pwl);
}

/* int_mu^inf (q - mu) P2(q) dq / mu, q = mu + tan(t) */
struct beyond {
	const struct ndf *ndf;
	double phi, mu;
};

static double beyond_at(double t, void *data)
{
	const struct beyond *beyond = data;
	const double tangent = tan(t);
	return tangent * ndf_P2(beyond->ndf, beyond->phi, beyond->mu + tangent) * (1 + tangent * tangent);
}

static void Lambda_follows_from_P2(void **state)
{
	(void)state;
	struct pwl pwl = two_tables();
	struct ndf ndf;
	ndf_from_pwl(&ndf, &pwl);
	assert_int_equal(ndf_turn(&ndf, -40), STATUS_OK);
	for (int i = 0; i < 4; i++) {
		const double theta = 35 + 14 * i, phi = 47 * i;
		struct beyond beyond = {&ndf, phi * DEGREE, 1 / tan(theta * DEGREE)};
		double sum = 0;
		for (int k = 0; k < 12; k++)
			sum += quadrature_adaptive(beyond_at, &beyond, M_PI / 24 * k, fmin(M_PI / 24 * (k + 1), 1.5707),
						   1e-8);
		/* Facets all but vertical: D = 0.01/c at most over a slope of 1e4. */
		check_abs(ndf_lambda(&ndf, vec3_from_spherical_deg(theta, phi)), sum / beyond.mu, 2e-4, "Lambda");
	}
	pwl_free(&pwl);
}

enum { RINGS = 6, SECTORS = 12, DRAWN = 40000 };

static void turned_normals_are_distributed_as_their_CDF(void **state)
{
	(void)state;
	struct pwl pwl = two_tables();
	struct ndf ndf;
	struct sampler sampler;
	int count[RINGS * SECTORS] = {0};
	double expected[RINGS * SECTORS];
	uint64_t random = 5;
	ndf_from_pwl(&ndf, &pwl);
	assert_int_equal(ndf_turn(&ndf, 65), STATUS_OK);
	assert_int_equal(sampler_init(&sampler, &ndf, SAMPLING_NDF), STATUS_OK);
	for (int i = 0; i < DRAWN; i++) {
		const double u1 = uniform(&random), u2 = uniform(&random);
		const struct vec3 m = sampler_sample(&sampler, (struct vec3){0, 0, 1}, u1, u2);
		const double turn = atan2(m.y, m.x) / (2 * M_PI);
		const int ring = (int)(acos(m.z) / (M_PI / 2) * RINGS), sector = (int)((turn + (turn < 0)) * SECTORS);
		count[(ring < RINGS ? ring : RINGS - 1) * SECTORS + sector % SECTORS]++;
	}
	for (int r = 0; r < RINGS; r++)
		for (int s = 0; s < SECTORS; s++) {
			double sum = 0;
			for (int corner = 0; corner < 4; corner++) {
				const double theta = M_PI / 2 * (r + corner % 2) / RINGS,
					     phi = 2 * M_PI * (s + corner / 2) / SECTORS;
				sum += (corner % 2 == corner / 2 ? 1 : -1) * ndf_cdf(&ndf, theta, phi);
			}
			/* The joint CDF is that of the density D cos: the middle of the cell is near enough. */
			const double theta = M_PI / 2 * (r + 0.5) / RINGS, phi = 360.0 * (s + 0.5) / SECTORS;
			const struct vec3 m = vec3_from_spherical_deg(theta / DEGREE, phi);
			const double about = ndf_pdf(&ndf, m) * sin(theta) * (M_PI / 2 / RINGS) * (2 * M_PI / SECTORS);
			check_between(sum, 0.5 * about, 1.7 * about + 1e-3, "cell");
			expected[r * SECTORS + s] = DRAWN * sum;
		}
	check_counts(RINGS * SECTORS, count, expected, 1, "two tables, turned");
	pwl_free(&pwl);
}

/* What a sphere is made of: G1 changes with the azimuth. */
static void a_sphere_is_made_of_the_model(void **state)
{
	(void)state;
	struct pwl pwl = two_tables();
	struct cook_torrance model[2] = {{.n = 1.5, .kd = {0.1, 0.2, 0.3}, .ks = {1, 1, 1}}};
	ndf_from_pwl(&model[0].ndf, &pwl);
	model[1] = model[0];
	assert_int_equal(ndf_init(&model[1].ndf, ndf_find("std"), 0.4, 0.1, 2.5), STATUS_OK);
	assert_int_equal(ndf_turn(&model[1].ndf, 30), STATUS_OK);
	for (int i = 0; i < 2; i++) {
		struct surface surface;
		uint64_t random = 9;
		assert_int_equal(surface_init(&surface, &model[i], NULL, SAMPLING_VISIBLE), STATUS_OK);
		for (int n = 0; n < 300; n++) {
			const double a = 85 * uniform(&random), b = 360 * uniform(&random);
			const struct vec3 wo = vec3_from_spherical_deg(a, b);
			const double c = 85 * uniform(&random), d = 360 * uniform(&random);
			const struct vec3 wi = vec3_from_spherical_deg(c, d);
			const struct view view = surface_view(&surface, wo);
			double f[3], want[3];
			(void)surface_f(&surface, &view, wi, f);
			cook_torrance_f(&model[i], wi, wo, want);
			check_rel(f[1], want[1], 1e-7, "BRDF of the sphere");
		}
		surface_free(&surface);
	}
	pwl_free(&pwl);
}

/* Commands */

static void nodes_of_GGX_are_nearly_GGX(void **state)
{
	(void)state;
	write_ggx("round.csv", 0.3, 0.3);
	stdfit("synth ggx.csv --kd 0.1 --ks 1 --ndf ggx --sigma 0.3");
	expect_code(0);
	stdfit("eval ggx.csv --kd 0.1 --ks 1 --ndf pl --nodes round.csv --json");
	expect_code(0);
	check_between(json_number("error_none"), 1e-6, 2e-3, "E of nodes beside GGX");
	const double albedo = json_number("albedo_r"), furnace = json_number("furnace");
	stdfit("eval ggx.csv --kd 0.1 --ks 1 --ndf ggx --sigma 0.3 --json");
	check_rel(albedo, json_number("albedo_r"), 2e-3, "albedo");
	check_rel(furnace, json_number("furnace"), 2e-3, "furnace");
	/* A table of `stdfit ndf` has the columns. */
	stdfit("ndf ggx --sigma 0.3 --theta 0:90:0.25 > piped.csv");
	stdfit("ndf pl --nodes piped.csv --theta 20");
	expect_code(0);
	stdfit("sample pl --nodes piped.csv --theta-i 30 --count 3");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 4);
}

static void the_measurement_of_two_tables_is_of_them(void **state)
{
	(void)state;
	write_nodes("two.csv");
	stdfit("synth own.csv --kd 0.1 --ks 1 --ndf pl --nodes two.csv --angle 20");
	expect_code(0);
	stdfit("eval own.csv --kd 0.1 --ks 1 --ndf pl --nodes two.csv --angle 20 --json");
	expect_code(0);
	check_between(json_number("error_none"), 0, 1e-7, "E");
	stdfit("eval own.csv --kd 0.1 --ks 1 --ndf pl --nodes two.csv --angle 30 --json");
	check_between(json_number("error_none"), 1e-2, 1, "E of another angle");
	/* As JSON, and back. */
	stdfit("export --kd 0.1 --ks 1 --ndf pl --nodes two.csv --angle 20 --format json -o two.json");
	expect_code(0);
	stdfit("eval own.csv --from two.json --json");
	expect_code(0);
	check_between(json_number("error_none"), 0, 1e-7, "E of the JSON");
	stdfit("export --from two.json --format bsdf-rgb --size 2e6 -q -o two.bsdf");
	expect_code(0);
	stdfit("eval two.bsdf --from two.json --json");
	expect_code(0);
	check_between(json_number("error_solid_angle"), 0, 0.03, "E of the tensor file");
	stdfit("render --from two.json -q --size 16 --samples 4 -o two.pfm");
	expect_code(0);
}

/* Where D of one axis is 0 at the normal the other's plays no part. */
static void an_axis_that_plays_no_part_stays_so(void **state)
{
	(void)state;
	FILE *file = fopen("one.csv", "w");
	assert_non_null(file);
	fputs("theta,Dx,Dy\n0,0,1\n40,2,1\n90,0,1\n", file);
	assert_int_equal(fclose(file), 0);
	stdfit("synth one_own.csv --kd 0.1 --ks 1 --ndf pl --nodes one.csv");
	expect_code(0);
	stdfit("export --kd 0.1 --ks 1 --ndf pl --nodes one.csv --format json -o one.json");
	expect_code(0);
	stdfit("eval one_own.csv --from one.json --json");
	expect_code(0);
	check_between(json_number("error_none"), 0, 1e-7, "E of the JSON");
}

static void what_is_no_table_of_nodes_is_told(void **state)
{
	(void)state;
	static const struct {
		const char *text, *why;
	} bad[] = {{"theta\n0\n90\n", "has no nodes"},        {"theta,D\n0,1\n80,1\n", "has no nodes"},
		   {"theta,D\n0,1\n90,-1\n", "has no nodes"}, {"theta,D\n0,1\n45,\n90,1\n", "has no nodes"},
		   {"theta,Dx\n0,1\n90,1\n", "has no nodes"}, {"theta,D,Dx,Dy\n0,1,1,1\n90,1,1,1\n", "has no nodes"},
		   {"angle,D\n0,1\n90,1\n", "column theta"}};
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		FILE *file = fopen("bad.csv", "w");
		assert_non_null(file);
		fputs(bad[i].text, file);
		assert_int_equal(fclose(file), 0);
		stdfit("synth no.csv --ks 1 --ndf pl --nodes bad.csv");
		expect_error(1, bad[i].why);
	}
	write_nodes("two.csv");
	static const struct {
		const char *line, *why;
		int code;
	} wrong[] = {{"synth no.csv --ks 1 --ndf pl", "pl needs --nodes", 2},
		     {"synth no.csv --ks 1 --ndf pl --nodes none.csv", "none.csv", 1},
		     {"synth no.csv --ks 1 --ndf pl --nodes two.csv --sigma 0.1", "--sigma means nothing for pl", 2},
		     {"synth no.csv --ks 1 --ndf ggx --sigma 0.1 --nodes two.csv", "nodes are for pl", 2},
		     {"synth no.csv --ks 1 --ndf pl --nodes two.csv --params D0=1", "not both", 2},
		     {"synth no.csv --kd 1 --nodes two.csv", "--nodes means nothing without --ks", 2},
		     {"synth two.csv --ks 1 --ndf pl --nodes two.csv", "OUT names a file that is to be read", 2},
		     {"synth no.binary --ks 1 --ndf pl --nodes two.csv", "a MERL file is isotropic", 2},
		     {"export --ks 1 --ndf pl --nodes two.csv --format brdf", "--format bsdf", 1},
		     {"export --ks 1 --ndf pl --nodes two.csv --format merl -o no.binary", "--format bsdf", 1}};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		stdfit(wrong[i].line);
		expect_error(wrong[i].code, wrong[i].why);
	}
	/* Not the largest albedo: it is found for isotropic and for stretched lobes. */
	struct pwl pwl = two_tables();
	struct cook_torrance model = {.n = 1.5, .ks = {1, 1, 1}};
	double albedo[3], theta;
	ndf_from_pwl(&model.ndf, &pwl);
	assert_int_equal(energy_albedo_max(&model, albedo, &theta), STATUS_UNSUPPORTED);
	pwl_free(&pwl);
}

/* Tilted GGX by its tilt, by angles and by its matrix. */
#define TILTED "--kd 0.1 --ks 1 --ndf ellipsoid --sigma 0.3,0.1 --angle 20 --params 'tilt_x=0.15;tilt_y=-0.05' "

static void an_ellipsoid_is_a_model(void **state)
{
	(void)state;
	/* An angle turns what ndf and sample show, too. */
	stdfit("ndf std --sigma 0.3,0.1 --gamma 3 --angle 30 --theta 20 --phi 50 --json");
	expect_code(0);
	const double D = json_number("D");
	stdfit("ndf std --sigma 0.3,0.1 --gamma 3 --theta 20 --phi 20 --json");
	check_rel(D, json_number("D"), 1e-13, "D of turned axes");
	stdfit("synth tilted.csv " TILTED);
	expect_code(0);
	stdfit("eval tilted.csv --json " TILTED);
	expect_code(0);
	check_between(json_number("error_none"), 0, 1e-7, "E");
	stdfit("eval tilted.csv --json --kd 0.1 --ks 1 --ndf ggx --sigma 0.3,0.1 --angle 20");
	expect_code(0);
	check_between(json_number("error_none"), 0.1, 5, "E of GGX, which is level");
	stdfit("export " TILTED "--format json -o tilted.json");
	expect_code(0);
	stdfit("export --from tilted.json --format json -o again.json");
	expect_code(0);
	shell("cmp tilted.json again.json");
	expect_code(0);
	stdfit("eval tilted.csv --from tilted.json --json");
	check_between(json_number("error_none"), 0, 1e-7, "E of the JSON");
	stdfit("export --from tilted.json --format brdf");
	expect_error(1, "no tilted facets (--format bsdf");
	stdfit("export --from tilted.json --format merl -o no.binary");
	expect_error(1, "--format bsdf");
	stdfit("synth no.binary " TILTED);
	expect_error(2, "a MERL file is isotropic");
	stdfit("eval tilted.csv --from tilted.json --angle 3");
	expect_error(2, "--angle and --from exclude each other");
}

/* In the tensor file of either format, all round. */
static void tilted_facets_are_in_the_tensor_file(void **state)
{
	(void)state;
	stdfit("synth tilted.csv " TILTED);
	for (int i = 0; i < 2; i++) {
		stdfit(i ? "export " TILTED "--format bsdf --size 8e6 -q -o tilted.bsdf"
			 : "export " TILTED "--format bsdf-rgb --size 8e6 -q -o tilted.bsdf");
		expect_code(0);
		stdfit("eval tilted.bsdf --json " TILTED);
		expect_code(0);
		check_between(json_number("error_solid_angle"), 0, 0.03, "E of the tensor file");
	}
	stdfit("render tilted.csv -q --size 16 --samples 16 --json " TILTED);
	expect_code(0);
	check_between(json_number("delta_e"), 0, 3, "delta E of the sphere of its samples");
	stdfit("render -q --size 16 --samples 4 -o tilted.pfm " TILTED);
	expect_code(0);
	/* A substitute is level. */
	stdfit("export " TILTED "--format pbrt -q");
	expect_code(0);
	expect_out("no NDF ellipsoid");
}

static void it_has_several_descriptions(void **state)
{
	(void)state;
	static const char *const same[] = {
		"--ndf ggx --sigma 0.3,0.1",
		"--ndf ellipsoid --sigma 0.3,0.1",
		"--ndf ellipsoid --params 'alpha_x=0.3;alpha_y=0.1'",
		"--ndf ellipsoid --params 'A11=-0.6;A12=0;A13=0;A21=0;A22=0.2;A23=0;A31=0;A32=0;A33=2'",
		"--ndf ellipsoid --sigma 0.1,0.3 --angle 90",
		"--ndf ellipsoid --sigma 0.1,0.3 --params theta_z=-90",
	};
	stdfit("synth level.csv --ks 1 --ndf ggx --sigma 0.3,0.1");
	for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
		char line[256];
		snprintf(line, sizeof line, "eval level.csv --ks 1 --json %s", same[i]);
		stdfit(line);
		expect_code(0);
		check_between(json_number("error_none"), 0, 1e-7, same[i]);
	}
	static const struct {
		const char *params, *why;
	} bad[] = {{"--params A11=1", "A11 to A33, all nine"},
		   {"--sigma 0.1 --params 'theta_x=3;tilt_x=1'", "theta_x, theta_y and theta_z, or"},
		   {"--sigma 0.1,0.2 --angle 5 --params theta_x=3", "theta_x, theta_y and theta_z, or"},
		   {"--params tilt_x=1", "needs alpha_x and alpha_y, or sigma, or a matrix"},
		   {"--sigma 0.1 --params tilt_z=1", "no such name"},
		   {"--sigma 0.1 --gamma 3", "has no --gamma"},
		   {"--sigma 0.1 --gamma 3 --params tilt_x=1", "ellipsoid has no gamma"},
		   {"--params 'A11=1;A12=2;A13=3;A21=4;A22=5;A23=6;A31=7;A32=8;A33=9'", "does not take"}};
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		char line[256];
		snprintf(line, sizeof line, "synth no.csv --ks 1 --ndf ellipsoid %s", bad[i].params);
		stdfit(line);
		expect_error(2, bad[i].why);
	}
}

/* Parameters by name: x of t-family, B and C of low. */
static void params_are_those_of_ndf_and_sample(void **state)
{
	(void)state;
	stdfit("synth t.csv --ks 1 --ndf t-family --sigma 0.3 --gamma 4 --params x=3");
	expect_code(0);
	stdfit("eval t.csv --ks 1 --ndf t-family --params 'x=3;sigma=0.3;gamma=4' --json");
	expect_code(0);
	check_between(json_number("error_none"), 0, 1e-7, "E");
	stdfit("synth low.csv --ks 1 --ndf low --params 'B=40;C=1.4'");
	expect_code(0);
	stdfit("eval low.csv --ks 1 --ndf low --params 'B=40' --json");
	expect_error(2, "low needs C");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(Lambda_follows_from_P2),
		cmocka_unit_test(a_sphere_is_made_of_the_model),
		cmocka_unit_test(an_axis_that_plays_no_part_stays_so),
		cmocka_unit_test(what_is_no_table_of_nodes_is_told),
		cmocka_unit_test(an_ellipsoid_is_a_model),
	};
	const struct CMUnitTest long_tests[] = {
		cmocka_unit_test(P2_is_the_integral_of_P22_across),
		cmocka_unit_test(turned_normals_are_distributed_as_their_CDF),
		cmocka_unit_test(nodes_of_GGX_are_nearly_GGX),
		cmocka_unit_test(the_measurement_of_two_tables_is_of_them),
		cmocka_unit_test(params_are_those_of_ndf_and_sample),
		cmocka_unit_test(tilted_facets_are_in_the_tensor_file),
		cmocka_unit_test(it_has_several_descriptions),
	};
	const int failed = cmocka_run_group_tests_name("given_ndf", tests, enter_directory, NULL);

	if (failed || case_step(2) > 1) {
		(void)leave_directory(NULL);
		return failed;
	}
	return cmocka_run_group_tests_name("given_ndf_long", long_tests, NULL, leave_directory);
}
