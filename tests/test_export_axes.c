/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit export of anisotropic models, read back: where each target has its axes, which way they turn, and the errors that
 * are told. The GLSL is in test_export_brdf. Runs $STDFIT or build/stdfit. */
#include "data_readers/measurement_read.h"
#include "data_readers/rgl.h"
#include "fit/export/model_json.h"
#include "gltf_buffer.h"
#include "make_table.h"
#include "run_program.h"
#include "xml.h"
#include <jansson.h>

#define AXES "--sigma 0.3,0.1 --angle 20 "
#define LOBE "--kd 0.31,0.12,0.047 --ks 0.42 "

static struct cook_torrance model_with_axes(const char *ndf, double gamma, enum gaf gaf, enum fresnel fresnel)
{
	struct cook_torrance model = make_model(ndf, 0.2, gamma, 1.5);

	model.gaf = gaf;
	model.fresnel = fresnel;
	model.ks[0] = model.ks[1] = model.ks[2] = 0.42;
	if (ndf_init(&model.ndf, ndf_find(ndf), 0.3, 0.1, gamma) != STATUS_OK || ndf_turn(&model.ndf, 20) != STATUS_OK)
		abort();
	return model;
}

static void export_it(const char *arguments)
{
	char *command;

	assert_true(asprintf(&command, "export --threads 1 %s", arguments) > 0);
	stdfit(command);
	free(command);
	expect_code(0);
}

static double number_behind(const char *text, const char *words)
{
	const char *at = strstr(text, words);

	if (!at)
		fail_msg("no '%s' in %.1000s", words, text);
	return strtod(at + strlen(words), NULL);
}

static struct vec3 any_direction(unsigned *seed)
{
	const double z = 0.05 + 0.95 * random_unit(seed), phi = 2 * M_PI * random_unit(seed), r = sqrt(1 - z * z);

	return (struct vec3){r * cos(phi), r * sin(phi), z};
}

static void json_keeps_axes_to_the_bit(void **state)
{
	(void)state;
	struct fit_options fit = fit_options_default();
	const struct cook_torrance want = model_with_axes("std", 1.7, GAF_UNCORRELATED, FRESNEL_DIELECTRIC);
	struct model_json json;
	struct error error = {""};

	export_it("--format json -o axes.json " LOBE AXES "--gamma 1.7");
	if (model_json_read("axes.json", &json, &fit, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	assert_true(json.model.ndf.sigma_x == want.ndf.sigma_x && json.model.ndf.sigma_y == want.ndf.sigma_y);
	assert_true(json.model.ndf.angle == want.ndf.angle && json.model.ndf.turn_sin == want.ndf.turn_sin);
	model_json_free(&json);
	/* Other commands take it. */
	stdfit("synth some.csv " LOBE AXES "--gamma 1.7");
	stdfit("eval some.csv --from axes.json --json");
	expect_code(0);
	expect_out("e-08, \"error_cosine\":");
	shell("sed 's/\"sigma_y\": 0.1/\"sigma_y\": -1/' axes.json >bad.json");
	stdfit("eval some.csv --from bad.json");
	expect_error(1, "the member \"parameters\" should be sigma, sigma_y and angle");
	shell("sed 's/\"angle\": 20/\"angle\": \"east\"/' axes.json >bad.json");
	stdfit("eval some.csv --from bad.json");
	expect_error(1, "the member \"parameters\" should be sigma, sigma_y and angle");
}

static void renderers_have_u_and_v(void **state)
{
	(void)state;
	export_it("--format mitsuba " LOBE AXES "--ndf ggx");
	expect_out("<!-- exact: the model itself");
	expect_out(
		"<!-- alpha_u is the roughness along the shape's dp/du, which has to lie at azimuth 20 degrees of the "
		"sample -->");
	struct xml *scene = xml_parse(last.out);
	const struct xml *lobe = xml_named(scene->child[0], "bsdf_1");
	assert_string_equal(xml_get(xml_named(lobe, "alpha_u"), "value"), "0.3");
	assert_string_equal(xml_get(xml_named(lobe, "alpha_v"), "value"), "0.1");
	assert_null(xml_named(lobe, "alpha"));
	xml_free(scene);

	export_it("--format pbrt " LOBE AXES "--ndf ggx --gaf correlated");
	expect_out("# exact: the model itself");
	expect_out("# uroughness is that along the shape's dp/du, which has to lie at azimuth 20 degrees");
	expect_out("\"float uroughness\" 0.3 \"float vroughness\" 0.1 \"bool remaproughness\" false");
	assert_null(strstr(last.out, "float roughness"));
	stdfit("export --format merl -o axes.binary " LOBE AXES "--ndf ggx");
	expect_error(1, "a MERL file is isotropic, the model is not");
	assert_true(access("axes.binary", F_OK) != 0);
}

/* E of what stands in the scene, GGX of other axes, against samples of the model: by its definition. */
static void a_substitute_has_axes_too(void **state)
{
	(void)state;
	struct cook_torrance got = model_with_axes("ggx", 2, GAF_UNCORRELATED, FRESNEL_CONDUCTOR);
	struct measurement m;
	struct error error;
	double difference = 0, sum = 0;

	export_it("--format mitsuba " LOBE AXES "--gamma 1.7");
	expect_out("Mitsuba 3 has no NDF std of gamma 1.7; ggx (gamma 2) was fitted in its place");
	const double angle = number_behind(last.out, "at azimuth ");
	struct xml *scene = xml_parse(last.out);
	const struct xml *blend = scene->child[0], *lobe = xml_named(blend, "bsdf_1");
	const double weight = strtod(xml_get(xml_named(blend, "weight"), "value"), NULL);
	assert_int_equal(ndf_init(&got.ndf, ndf_find("ggx"), strtod(xml_get(xml_named(lobe, "alpha_u"), "value"), NULL),
				  strtod(xml_get(xml_named(lobe, "alpha_v"), "value"), NULL), 2),
			 STATUS_OK);
	assert_int_equal(ndf_turn(&got.ndf, angle), STATUS_OK);
	check_abs(angle, 20, 0.1, "azimuth");
	got.n = strtod(xml_get(xml_named(lobe, "eta"), "value"), NULL);
	const struct xml *kd = xml_named(xml_named(blend, "bsdf_0"), "reflectance");
	assert_int_equal(sscanf(xml_get(kd, "value"), "%lf, %lf, %lf", &got.kd[0], &got.kd[1], &got.kd[2]), 3);
	const struct xml *ks = xml_named(lobe, "specular_reflectance");
	assert_int_equal(sscanf(xml_get(ks, "value"), "%lf, %lf, %lf", &got.ks[0], &got.ks[1], &got.ks[2]), 3);
	xml_free(scene);
	char *text = strdup(last.out);
	stdfit("synth truth.csv " LOBE AXES "--gamma 1.7");
	assert_int_equal(measurement_read("truth.csv", NULL, &m, &error), STATUS_OK);
	for (size_t e = 0; e < m.scattered->n; e++) {
		double f[3];

		for (int c = 0; c < 3 && e == 0; c++) {
			got.kd[c] *= 1 - weight;
			got.ks[c] *= weight;
		}
		cook_torrance_f(&got, m.scattered->wi[e], m.scattered->wo[e], f);
		for (int c = 0; c < 3; c++) {
			difference += fabs((double)m.scattered->value[c][e] - f[c]);
			sum += (double)m.scattered->value[c][e];
		}
	}
	check_rel(number_behind(text, "weight none: 0, "), difference / sum, 1e-3, "the error that is told");
	check_between(difference / sum, 1e-3, 0.2, "the error");
	free(text);
	measurement_free(&m);
}

/* The lobe without F, as the extension's specification has it: axes t and b, roughness at and ab along them. */
static double khronos_lobe(double at, double ab, struct vec3 t, struct vec3 b, struct vec3 l, struct vec3 v)
{
	const struct vec3 h = vec3_unit(vec3_add(l, v));
	const double a2 = at * ab, f[3] = {ab * vec3_dot(t, h), at * vec3_dot(b, h), a2 * h.z};
	const double w2 = a2 / (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
	const double view = l.z * sqrt(pow(at * vec3_dot(t, v), 2) + pow(ab * vec3_dot(b, v), 2) + v.z * v.z);
	const double light = v.z * sqrt(pow(at * vec3_dot(t, l), 2) + pow(ab * vec3_dot(b, l), 2) + l.z * l.z);

	return a2 * w2 * w2 / M_PI * 0.5 / (view + light);
}

static void expect_gltf(const char *sigma, double sigma_x, double sigma_y, double angle)
{
	char arguments[160];
	struct cook_torrance model = model_with_axes("ggx", 2, GAF_CORRELATED, FRESNEL_NONE);
	unsigned seed = 5;

	snprintf(arguments, sizeof arguments,
		 "--format gltf " LOBE "--ndf ggx --gaf correlated --fresnel schlick --sigma %s --angle %g", sigma,
		 angle);
	export_it(arguments);
	json_t *json = json_loads(last.out, 0, NULL);
	assert_non_null(json);
	const json_t *material = json_array_get(json_object_get(json, "materials"), 0);
	const json_t *axes = json_object_get(json_object_get(material, "extensions"), "KHR_materials_anisotropy");
	assert_non_null(axes);
	const double roughness = json_number_value(
		json_object_get(json_object_get(material, "pbrMetallicRoughness"), "roughnessFactor"));
	const double strength = json_number_value(json_object_get(axes, "anisotropyStrength"));
	const double rotation = json_number_value(json_object_get(axes, "anisotropyRotation"));
	const double ab = roughness * roughness, at = ab + (1 - ab) * strength * strength;
	const struct vec3 t = {cos(rotation), sin(rotation), 0}, b = {-sin(rotation), cos(rotation), 0};

	/* The lobe is fitted again in glTF's own layers: both roughnesses by one factor, the axes stay. */
	const double factor = ab / fmin(sigma_x, sigma_y);

	check_between(factor, 0.7, 1.5, "factor of both roughnesses");
	if (ndf_init(&model.ndf, ndf_find("ggx"), factor * sigma_x, factor * sigma_y, 2) || ndf_turn(&model.ndf, angle))
		abort();
	for (int n = 0; n < 100; n++) {
		const struct vec3 l = any_direction(&seed), v = any_direction(&seed);

		check_rel(khronos_lobe(at, ab, t, b, l, v), cook_torrance_lobe(&model, l, v), 1e-9, sigma);
	}
	json_decref(json);
}

/* The sphere has unit tangents across its normals, along which the first texture coordinate grows, as the second one
 * does against the bitangent: a viewer that derives tangents finds the same. */
static void expect_tangents(const json_t *gltf)
{
	enum { AROUND = 48, ROW = AROUND + 1 };
	size_t size;
	unsigned char *bytes = gltf_buffer(gltf, &size);
	const unsigned char *position = bytes + gltf_attribute(gltf, "POSITION", 3);
	const unsigned char *tangent = bytes + gltf_attribute(gltf, "TANGENT", 4);
	const unsigned char *texture = bytes + gltf_attribute(gltf, "TEXCOORD_0", 2);

	for (size_t n = ROW; n < (size_t)ROW * 24; n++) { /* but the poles */
		const size_t right = n % ROW == AROUND ? n - AROUND + 1 : n + 1;
		float p[3], next[3], below[3], t[4], uv[2], uv_right[2], uv_below[2];

		memcpy(p, position + 12 * n, sizeof p);
		memcpy(next, position + 12 * right, sizeof next);
		memcpy(below, position + 12 * (n + ROW), sizeof below);
		memcpy(t, tangent + 16 * n, sizeof t);
		memcpy(uv, texture + 8 * n, sizeof uv);
		memcpy(uv_right, texture + 8 * right, sizeof uv_right);
		memcpy(uv_below, texture + 8 * (n + ROW), sizeof uv_below);
		const struct vec3 normal = {(double)p[0], (double)p[1], (double)p[2]};
		const struct vec3 along = {(double)t[0], (double)t[1], (double)t[2]};
		const struct vec3 to = vec3_unit(
			(struct vec3){(double)(next[0] - p[0]), (double)(next[1] - p[1]), (double)(next[2] - p[2])});
		const struct vec3 down = {(double)(below[0] - p[0]), (double)(below[1] - p[1]),
					  (double)(below[2] - p[2])};
		const struct vec3 up = {normal.y * along.z - normal.z * along.y,
					normal.z * along.x - normal.x * along.z,
					normal.x * along.y - normal.y * along.x};

		check_abs(vec3_dot(along, normal), 0, 1e-6, "tangent across the normal");
		check_abs(vec3_length(along), 1, 1e-6, "length");
		check_abs(vec3_dot(along, to), cos(M_PI / AROUND), 1e-3, "tangent along the parallel");
		assert_true(t[3] == 1.0F);
		assert_true(vec3_dot(up, down) < 0);
		assert_true(uv_below[1] > uv[1] && uv_below[0] == uv[0]);
		assert_true(n % ROW == AROUND || (uv_right[0] > uv[0] && uv_right[1] == uv[1]));
	}
	free(bytes);
}

static void gltf_turns_the_tangent(void **state)
{
	(void)state;
	expect_gltf("0.3,0.1", 0.3, 0.1, 20);
	/* Its sphere has the axes: without them it would look twice as different. */
	check_between(number_behind(last.out, "delta E of the model 0.00, of what stands here "), 0.05, 0.75,
		      "delta E");
	expect_gltf("0.1,0.3", 0.1, 0.3, 20);
	expect_gltf("0.2,0.9", 0.2, 0.9, -70);
	json_t *json = json_loads(last.out, 0, NULL);
	expect_tangents(json);
	json_decref(json);
}

/* The text of a measured substitute of scattered samples has an error of what a viewer shows, which is a number. */
static void samples_have_their_errors_told(void **state)
{
	(void)state;
	stdfit("synth plain.csv --ndf ggx --sigma 0.3 " LOBE);
	export_it("plain.csv --ndf ggx --format gltf");
	check_between(number_behind(last.out, "of what stands here "), 1e-3, 0.3, "error");
	export_it("plain.csv --ndf ggx --gaf correlated --gray --format pbrt");
	check_between(number_behind(last.out, "\"rgb reflectance\" [ "), 0.1, 1, "a kd of red");
}

/* At the nodes the values are the model's; between them the L1 distance is what is told. */
static void expect_bsdf(const char *path, const struct cook_torrance *model, double told)
{
	struct measurement m;
	struct error error = {""};
	unsigned seed = 5;
	double difference = 0, norm = 0;

	if (measurement_read(path, NULL, &m, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	assert_int_equal(m.scattered->symmetry, SYMMETRY_ANISOTROPIC);
	for (size_t n = 0; n < m.scattered->n; n += 7) {
		double f[3];

		cook_torrance_f(model, m.scattered->wi[n], m.scattered->wo[n], f);
		for (int c = 0; c < 3; c++)
			check_abs((double)m.scattered->value[c][n], f[c], 2e-4 * (f[0] + f[1] + f[2]), "entry");
	}
	for (int n = 0; n < 100000; n++) {
		struct vec3 w[2];
		double f[3], g[3];

		for (int i = 0; i < 2; i++) { /* cos dw is even over the disc */
			const double r = sqrt(random_unit(&seed)), phi = 2 * M_PI * random_unit(&seed);

			w[i] = (struct vec3){r * cos(phi), r * sin(phi), sqrt(fmax(0, 1 - r * r))};
		}
		if (!rgl_f(m.rgl, w[0], w[1], g))
			continue;
		cook_torrance_f(model, w[0], w[1], f);
		for (int c = 0; c < 3; c++) {
			difference += fabs(f[c] - g[c]);
			norm += f[c];
		}
	}
	check_rel(100 * difference / norm, told, 0.15, path);
	measurement_free(&m);
}

static void bsdf_has_the_azimuths(void **state)
{
	(void)state;
	const struct cook_torrance model = model_with_axes("std", 1.7, GAF_UNCORRELATED, FRESNEL_DIELECTRIC);

	export_it("--format bsdf-rgb -o half.bsdf --accuracy 8 " LOBE AXES "--gamma 1.7");
	expect_bsdf("half.bsdf", &model, number_behind(last.err, "error against the model "));
	/* pbrt-v4 takes the whole circle only. */
	export_it("--format bsdf -o whole.bsdf --accuracy 12 " LOBE AXES "--gamma 1.7");
	expect_bsdf("whole.bsdf", &model, number_behind(last.err, "error against the model "));
	expect_part(last.err, "a table of the model at 17 phi_i, 6 theta_i and 16 x 16 half vectors", __LINE__);
}

/* A fit and its row make one file. */
static void fitted_axes_are_exported(void **state)
{
	(void)state;
	stdfit("synth fitted.csv --ndf ggx --noise 0.05 " LOBE AXES);
	stdfit("fit fitted.csv --ndf ggx --anisotropic --weight solid-angle -q -o fits.csv");
	expect_code(0);
	export_it("fitted.csv --from fits.csv --format json -o row.json");
	export_it("fitted.csv --ndf ggx --anisotropic --format json -o fit.json");
	shell("cmp row.json fit.json && grep -c '\"angle\": 20.0' fit.json");
	expect_code(0);
	stdfit("export --format json " LOBE AXES "--gamma 2 --anisotropic");
	expect_error(2, "--anisotropic means nothing without a fit");
	stdfit("export fitted.csv --format json --sigma 0.3,0.1");
	expect_error(2, "--sigma SX,SY needs --anisotropic");
	stdfit("export fitted.csv --from fits.csv --format json --angle 3");
	expect_error(2, "--angle and --from exclude each other");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(json_keeps_axes_to_the_bit),     cmocka_unit_test(renderers_have_u_and_v),
		cmocka_unit_test(a_substitute_has_axes_too),      cmocka_unit_test(gltf_turns_the_tangent),
		cmocka_unit_test(samples_have_their_errors_told), cmocka_unit_test(bsdf_has_the_azimuths),
		cmocka_unit_test(fitted_axes_are_exported),
	};
	return cmocka_run_group_tests_name("export_axes", tests, enter_directory, leave_directory);
}
