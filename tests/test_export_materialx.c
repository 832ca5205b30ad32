/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit export --format materialx, against the specification of MaterialX 1.39: each element and input is in a table of its
 * node definitions, and the nodes, evaluated by its formulas, are the model. Runs $STDFIT or build/stdfit. */
#include "make_table.h"
#include "run_program.h"
#include "xml.h"

#define LOBE "--kd 0.31,0.12,0.047 --ks 0.42,0.53,0.6 "
#define SMALL "--max-theta 12 --threads 1 "

/* The nodes that may occur [PBR nodes 1.39; surfacematerial: standard nodes 1.39]. */
struct input {
	const char *name, *type;
};
static const struct definition {
	const char *element, *type;
	struct input input[14];
} definitions[] = {
	{"oren_nayar_diffuse_bsdf",
	 "BSDF",
	 {{"weight", "float"},
	  {"color", "color3"},
	  {"roughness", "float"},
	  {"normal", "vector3"},
	  {"energy_compensation", "boolean"}}},
	{"dielectric_bsdf",
	 "BSDF",
	 {{"weight", "float"},
	  {"tint", "color3"},
	  {"ior", "float"},
	  {"roughness", "vector2"},
	  {"retroreflective", "boolean"},
	  {"thinfilm_thickness", "float"},
	  {"thinfilm_ior", "float"},
	  {"normal", "vector3"},
	  {"tangent", "vector3"},
	  {"distribution", "string"},
	  {"scatter_mode", "string"}}},
	{"conductor_bsdf",
	 "BSDF",
	 {{"weight", "float"},
	  {"ior", "color3"},
	  {"extinction", "color3"},
	  {"roughness", "vector2"},
	  {"retroreflective", "boolean"},
	  {"thinfilm_thickness", "float"},
	  {"thinfilm_ior", "float"},
	  {"normal", "vector3"},
	  {"tangent", "vector3"},
	  {"distribution", "string"}}},
	{"generalized_schlick_bsdf",
	 "BSDF",
	 {{"weight", "float"},
	  {"color0", "color3"},
	  {"color82", "color3"},
	  {"color90", "color3"},
	  {"exponent", "float"},
	  {"roughness", "vector2"},
	  {"retroreflective", "boolean"},
	  {"thinfilm_thickness", "float"},
	  {"thinfilm_ior", "float"},
	  {"normal", "vector3"},
	  {"tangent", "vector3"},
	  {"distribution", "string"},
	  {"scatter_mode", "string"}}},
	{"add", "BSDF", {{"in1", "BSDF"}, {"in2", "BSDF"}}},
	{"multiply", "BSDF", {{"in1", "BSDF"}, {"in2", "color3"}}},
	{"surface",
	 "surfaceshader",
	 {{"bsdf", "BSDF"}, {"edf", "EDF"}, {"opacity", "float"}, {"thin_walled", "boolean"}}},
	{"surfacematerial",
	 "material",
	 {{"surfaceshader", "surfaceshader"},
	  {"backsurfaceshader", "surfaceshader"},
	  {"displacementshader", "displacementshader"}}},
};

static int numbers_of(const char *type)
{
	return !strcmp(type, "float") ? 1 : !strcmp(type, "vector2") ? 2 : !strcmp(type, "color3") ? 3 : 0;
}

/* The numbers of an input, as many as its type has and nothing else. */
static void read_numbers(const struct xml *input, double x[3])
{
	const char *at = xml_get(input, "value");
	const int n = numbers_of(xml_get(input, "type"));

	assert_true(n > 0);
	for (int i = 0; i < 3; i++)
		x[i] = NAN;
	for (int i = 0; i < n; i++) {
		char *end;
		x[i] = strtod(at, &end);
		assert_true(end != at && isfinite(x[i]));
		at = end;
		if (i + 1 < n) {
			assert_memory_equal(at, ", ", 2);
			at += 2;
		}
	}
	assert_string_equal(at, "");
}

static void check_input(const struct xml *document, const struct definition *definition, const struct xml *input)
{
	const struct input *known = definition->input;

	while (known->name && strcmp(known->name, xml_get(input, "name")) != 0)
		known++;
	if (!known->name)
		fail_msg("%s has no input %s", definition->element, xml_get(input, "name"));
	assert_string_equal(input->tag, "input");
	assert_string_equal(xml_get(input, "type"), known->type);
	assert_int_equal(input->n_attributes, 3);
	if (numbers_of(known->type)) {
		double x[3];

		read_numbers(input, x);
		return;
	}
	const struct xml *node = xml_named(document, xml_get(input, "nodename"));
	if (!node) {
		fail_msg("no node '%s'", xml_get(input, "nodename"));
		return;
	}
	assert_string_equal(xml_get(node, "type"), known->type);
}

static void check_node(const struct xml *document, const struct xml *node)
{
	const struct definition *definition = NULL;
	const char *name = xml_get(node, "name");

	for (size_t i = 0; i < sizeof definitions / sizeof *definitions; i++)
		if (!strcmp(definitions[i].element, node->tag))
			definition = &definitions[i];
	if (!definition)
		fail_msg("no node definition of %s", node->tag);
	assert_string_equal(xml_get(node, "type"), definition->type);
	assert_true(*name && !(*name >= '0' && *name <= '9'));
	assert_ptr_equal(xml_named(document, name), node); /* no other has this name */
	for (int i = 0; i < node->n_children; i++) {
		check_input(document, definition, node->child[i]);
		assert_ptr_equal(xml_named(node, xml_get(node->child[i], "name")), node->child[i]);
	}
}

/* The document in last.out, checked. */
static struct xml *read_document(void)
{
	struct xml *document = xml_parse(last.out);

	assert_string_equal(document->tag, "materialx");
	assert_string_equal(xml_get(document, "version"), "1.39");
	assert_string_equal(xml_get(document, "colorspace"), "lin_rec709");
	for (int i = 0; i < document->n_children; i++)
		check_node(document, document->child[i]);
	return document;
}

static void input_numbers(const struct xml *node, const char *name, double x[3])
{
	const struct xml *input = xml_named(node, name);

	if (!input)
		fail_msg("%s has no %s", node->tag, name);
	read_numbers(input, x);
}

static double input_number(const struct xml *node, const char *name)
{
	double x[3];

	input_numbers(node, name, x);
	return x[0];
}

static const struct xml *linked(const struct xml *document, const struct xml *node, const char *name)
{
	return xml_named(document, xml_get(xml_named(node, name), "nodename"));
}

/* The formulas of the specification. */

static double spec_dielectric(double c, double ior)
{
	const double g = sqrt(ior * ior + c * c - 1), s = (g - c) / (g + c);
	const double p = (c * (g + c) - 1) / (c * (g - c) + 1);

	return 0.5 * s * s * (1 + p * p);
}

static double spec_conductor(double c, double n, double k)
{
	const double s2 = 1 - c * c, re = n * n - k * k - s2;
	const double a2b2 = sqrt(re * re + 4 * n * n * k * k), a = sqrt(fmax(0, 0.5 * (a2b2 + re)));
	const double Rs = (a2b2 - 2 * a * c + c * c) / (a2b2 + 2 * a * c + c * c);
	const double Rp = Rs * (c * c * a2b2 - 2 * a * c * s2 + s2 * s2) / (c * c * a2b2 + 2 * a * c * s2 + s2 * s2);

	return 0.5 * (Rs + Rp);
}

static double spec_schlick(double c, double r0, double t, double r90, double q)
{
	const double c_max = 1.0 / 7;
	const double a = (r0 + (r90 - r0) * pow(1 - c_max, q)) * (1 - t) / (c_max * pow(1 - c_max, 6));

	return r0 + (r90 - r0) * pow(1 - c, q) - a * c * pow(1 - c, 6);
}

static void spec_fresnel(const struct xml *node, double c, double F[3])
{
	double n[3], k[3], t[3];

	if (!strcmp(node->tag, "dielectric_bsdf")) {
		input_numbers(node, "tint", t);
		for (int i = 0; i < 3; i++)
			F[i] = t[i] * spec_dielectric(c, input_number(node, "ior"));
	} else if (!strcmp(node->tag, "conductor_bsdf")) {
		input_numbers(node, "ior", n);
		input_numbers(node, "extinction", k);
		for (int i = 0; i < 3; i++)
			F[i] = spec_conductor(c, n[i], k[i]);
	} else {
		assert_string_equal(node->tag, "generalized_schlick_bsdf");
		input_numbers(node, "color0", n);
		input_numbers(node, "color82", t);
		input_numbers(node, "color90", k);
		for (int i = 0; i < 3; i++)
			F[i] = spec_schlick(c, n[i], t[i], k[i], input_number(node, "exponent"));
	}
}

static void spec_lobe(const struct xml *node, struct vec3 wi, struct vec3 wo, double f[3])
{
	const struct vec3 sum = vec3_add(wi, wo);
	const double size = vec3_length(sum), hx = sum.x / size, hy = sum.y / size, hz = sum.z / size;
	double alpha[3], F[3];

	input_numbers(node, "roughness", alpha);
	check_between(alpha[0], 0, 1, "alpha");
	check_between(alpha[1], 0, 1, "alpha");
	const double e = hx * hx / (alpha[0] * alpha[0]) + hy * hy / (alpha[1] * alpha[1]) + hz * hz;
	const double D = 1 / (M_PI * alpha[0] * alpha[1] * e * e), a2 = alpha[0] * alpha[1];
	const double lambda_i = sqrt(a2 + (1 - a2) * wi.z * wi.z), lambda_o = sqrt(a2 + (1 - a2) * wo.z * wo.z);
	const double G = 2 * wi.z * wo.z / (lambda_o * wi.z + lambda_i * wo.z);
	spec_fresnel(node, size / 2, F);
	for (int c = 0; c < 3; c++)
		f[c] = D * F[c] * G / (4 * wi.z * wo.z);
}

static void spec_bsdf(const struct xml *document, const struct xml *node, struct vec3 wi, struct vec3 wo, double f[3])
{
	double other[3];

	assert_non_null(node);
	if (!strcmp(node->tag, "oren_nayar_diffuse_bsdf")) {
		assert_true(input_number(node, "roughness") == 0); /* Lambert */
		input_numbers(node, "color", f);
		for (int c = 0; c < 3; c++) {
			check_between(f[c], 0, 1, "albedo");
			f[c] /= M_PI;
		}
	} else if (!strcmp(node->tag, "add")) {
		spec_bsdf(document, linked(document, node, "in1"), wi, wo, f);
		spec_bsdf(document, linked(document, node, "in2"), wi, wo, other);
		for (int c = 0; c < 3; c++)
			f[c] += other[c];
	} else if (!strcmp(node->tag, "multiply")) {
		spec_bsdf(document, linked(document, node, "in1"), wi, wo, f);
		input_numbers(node, "in2", other);
		for (int c = 0; c < 3; c++)
			f[c] *= other[c];
	} else {
		spec_lobe(node, wi, wo, f);
	}
}

/* What the document's only material is. */
static const struct xml *material_bsdf(const struct xml *document)
{
	const struct xml *material = NULL;

	for (int i = 0; i < document->n_children; i++)
		if (!strcmp(document->child[i]->tag, "surfacematerial")) {
			assert_null(material);
			material = document->child[i];
		}
	assert_non_null(material);
	return linked(document, linked(document, material, "surfaceshader"), "bsdf");
}

static void export_it(const char *arguments)
{
	char *command;

	assert_true(asprintf(&command, "export --format materialx %s", arguments) > 0);
	stdfit(command);
	free(command);
	expect_code(0);
}

static struct cook_torrance given(double sigma, enum fresnel fresnel)
{
	struct cook_torrance model = make_model("ggx", sigma, 2, 1.61);

	memcpy(model.ks, (double[]){0.42, 0.53, 0.6}, sizeof model.ks);
	model.gaf = GAF_CORRELATED;
	model.fresnel = fresnel;
	model.k = 3.25;
	for (int c = 0; c < 3 && fresnel == FRESNEL_F82; c++)
		memcpy(model.reflectance[c], (double[]){0.2 + 0.1 * c, 0.5 - 0.05 * c, 0.9},
		       sizeof model.reflectance[c]);
	return model;
}

static void expect_nodes(const struct cook_torrance *want)
{
	struct xml *document = read_document();
	unsigned seed = 5;

	for (int i = 0; i < 100; i++) {
		const double theta_i = 1.5 * random_unit(&seed), theta_o = 1.5 * random_unit(&seed);
		const double phi = 3.1 + 0.3 * random_unit(&seed) * (i % 8);
		const struct vec3 wi = {sin(theta_i), 0, cos(theta_i)};
		const struct vec3 wo = {sin(theta_o) * cos(phi), sin(theta_o) * sin(phi), cos(theta_o)};
		double f[3], g[3];

		cook_torrance_f(want, wi, wo, f);
		spec_bsdf(document, material_bsdf(document), wi, wo, g);
		for (int c = 0; c < 3; c++)
			check_rel(g[c], f[c], 1e-11, "value");
	}
	xml_free(document);
}

static void nodes_are_the_model(void **state)
{
	(void)state;
	for (enum fresnel fresnel = 0; fresnel < FRESNEL_COUNT; fresnel++) {
		struct cook_torrance model = given(0.23, fresnel);
		char arguments[200];

		snprintf(arguments, sizeof arguments, LOBE "--ndf ggx --sigma 0.23 --gaf correlated --fresnel %s %s %s",
			 fresnel_name(fresnel), fresnel_has_ior(fresnel) ? "--ior 1.61" : "",
			 fresnel == FRESNEL_CONDUCTOR ? "--k 3.25"
			 : fresnel == FRESNEL_F82     ? "--f0 0.2,0.3,0.4 --f82 0.5,0.45,0.4 --f90 0.9"
						      : "");
		export_it(arguments);
		assert_memory_equal(last.out, "<!-- exact: the model itself", 28);
		expect_nodes(&model);
	}
	struct cook_torrance model = given(0.23, FRESNEL_DIELECTRIC);
	memset(model.kd, 0, sizeof model.kd);
	export_it("--ks 0.42,0.53,0.6 --ndf ggx --sigma 0.23 --gaf correlated --ior 1.61");
	expect_nodes(&model);
	model = given(0.23, FRESNEL_DIELECTRIC);
	memset(model.ks, 0, sizeof model.ks);
	export_it("--kd 0.31,0.12,0.047");
	expect_nodes(&model);
}

/* The factor of the specification, its albedo by quadrature. */
static void an_index_for_each_channel_is_in_the_node(void **state)
{
	struct cook_torrance model = given(0.23, FRESNEL_CONDUCTOR);

	(void)state;
	model.per_channel_ior = true;
	memcpy(model.channel_n, (double[]){0.16, 0.42, 1.38}, sizeof model.channel_n);
	memcpy(model.channel_k, (double[]){3.6, 2.47, 1.92}, sizeof model.channel_k);
	export_it(LOBE "--ndf ggx --sigma 0.23 --gaf correlated --fresnel conductor --ior 0.16,0.42,1.38 "
		       "--k 3.6,2.47,1.92");
	expect_nodes(&model);
}

static void further_reflections_are_stated(void **state)
{
	const struct cook_torrance model = given(0.7, FRESNEL_NONE);
	double albedo = 0;

	(void)state;
	for (int i = 0; i < 4000; i++) {
		const double theta = (i + 0.5) / 4000 * M_PI_2;
		const struct vec3 n = {0, 0, 1}, w = {sin(theta), 0, cos(theta)};
		albedo += 2 * M_PI * sin(theta) * cos(theta) * cook_torrance_lobe(&model, n, w) * M_PI_2 / 4000;
	}
	export_it(LOBE "--ndf ggx --sigma 0.7 --gaf correlated --fresnel none");
	const char *at = strstr(last.out, "shows ");
	assert_non_null(at);
	check_abs(strtod(at + 6, NULL), 100 * (1 - albedo) / albedo, 0.6, "percent more"); /* two digits are stated */
}

static void others_get_a_substitute(void **state)
{
	(void)state;
	export_it(SMALL LOBE "--ndf std --gamma 1.7 --sigma 0.2");
	expect_out("approximate: MaterialX has no NDF std of gamma 1.7, no uncorrelated G; ggx (gamma 2) was fitted");
	expect_out("error of the model 0, of what stands here");
	xml_free(read_document());
	export_it(SMALL "--kd 0.2 --ks 0.5 --ndf ggx --sigma 1.2 --gaf correlated");
	expect_out("MaterialX has no roughness of 1.2");
	struct xml *document = read_document();
	double f[3];
	spec_bsdf(document, material_bsdf(document), (struct vec3){0, 0, 1}, (struct vec3){0, 0, 1}, f);
	xml_free(document);
	stdfit("export --format materialx --kd 1.2");
	expect_error(1, "no reflectance above 1");
}

/* D of the two roughnesses in the frame of the axes; G is of their mean. */
static void axes_are_those_of_the_roughness(void **state)
{
	const struct vec3 wi = {0.3, 0.1, sqrt(0.9)}, wo = {-0.1, -0.2, sqrt(0.95)};
	struct cook_torrance model = given(0.2, FRESNEL_DIELECTRIC), mean = given(sqrt(0.2 * 0.4), FRESNEL_DIELECTRIC);
	double f[3], g[3];

	(void)state;
	assert_int_equal(ndf_init(&model.ndf, ndf_find("ggx"), 0.2, 0.4, 2), STATUS_OK);
	export_it(LOBE "--ndf ggx --sigma 0.2,0.4 --angle 20 --gaf correlated --ior 1.61");
	expect_out("approximate: the model itself, but MaterialX computes G");
	expect_out("along the tangent Tworld, which has to lie at azimuth 20 degrees");
	struct xml *document = read_document();
	spec_bsdf(document, material_bsdf(document), wi, wo, f);
	xml_free(document);
	const double change = gaf_G(mean.gaf, &mean.ndf, wi, wo) / gaf_G(model.gaf, &model.ndf, wi, wo);
	cook_torrance_f(&model, wi, wo, g);
	for (int c = 0; c < 3; c++)
		check_rel(f[c], model.kd[c] / M_PI + change * (g[c] - model.kd[c] / M_PI), 1e-11, "value");
}

/* A name that begins with a digit is none. */
static void names_are_valid(void **state)
{
	(void)state;
	shell("\"$STDFIT\" export --kd 0.2 --ks 0.3 --sigma 0.2 --ndf ggx --gaf correlated --format json | "
	      "sed 's/\"material\": null/\"material\": \"2-k\"/' >2-k.json");
	export_it("--from 2-k.json");
	struct xml *document = read_document();
	assert_non_null(xml_named(document, "_2_k"));
	xml_free(document);
}

static void xmllint_takes_it(void **state)
{
	(void)state;
	if (system("command -v xmllint >/dev/null") != 0)
		skip_for_want_of("libxml2-utils");
	shell("\"$STDFIT\" export --format materialx --kd 0.2 --ks 0.3 --sigma 0.2 --ndf ggx --gaf correlated | "
	      "xmllint --noout -");
	expect_code(0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nodes_are_the_model),
		cmocka_unit_test(an_index_for_each_channel_is_in_the_node),
		cmocka_unit_test(further_reflections_are_stated),
		cmocka_unit_test(others_get_a_substitute),
		cmocka_unit_test(names_are_valid),
		cmocka_unit_test(xmllint_takes_it),
		cmocka_unit_test(axes_are_those_of_the_roughness),
	};

	return cmocka_run_group_tests(tests, enter_directory, leave_directory);
}
