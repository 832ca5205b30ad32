/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit export, read back: MERL and JSON to the bit, Mitsuba, pbrt and glTF by what their numbers mean; substitutes and
 * the errors they tell; refusals. The GLSL has a test of its own. Runs $STDFIT or build/stdfit. */
#include "data_readers/merl.h"
#include "data_readers/spectrum.h"
#include "fit/error/model_table.h"
#include "fit/error/sample_set.h"
#include "fit/export/model_json.h"
#include "gltf_buffer.h"
#include "make_table.h"
#include "run_program.h"
#include "xml.h"
#include <jansson.h>

#define LOBE "--kd 0.31,0.12,0.047 --ks 0.42,0.53,0.6"
/* What has to be fitted is fitted to few entries. */
#define SMALL "--max-theta 12 --threads 1"

static struct cook_torrance given(const char *ndf, double sigma, double gamma, double n)
{
	struct cook_torrance model = make_model(ndf, sigma, gamma, n);
	static const double ks[3] = {0.42, 0.53, 0.6};

	memcpy(model.ks, ks, sizeof ks);
	return model;
}

static void export_it(const char *arguments)
{
	char *command;

	assert_true(asprintf(&command, "export %s", arguments) > 0);
	stdfit(command);
	free(command);
	expect_code(0);
}

static void directions(int i, struct vec3 *wi, struct vec3 *wo)
{
	unsigned seed = 77u + 13u * (unsigned)i;
	const double theta_i = 1.57 * random_unit(&seed), theta_o = 1.57 * random_unit(&seed);
	const double phi = 3.1 + 0.3 * random_unit(&seed) * (i % 8);

	*wi = (struct vec3){sin(theta_i), 0, cos(theta_i)};
	*wo = (struct vec3){sin(theta_o) * cos(phi), sin(theta_o) * sin(phi), cos(theta_o)};
}

/* The two models have the same values. */
static void expect_same(const struct cook_torrance *got, const struct cook_torrance *want, double tolerance)
{
	for (int i = 0; i < 200; i++) {
		struct vec3 wi, wo;
		double f[3], g[3];

		directions(i, &wi, &wo);
		cook_torrance_f(got, wi, wo, f);
		cook_torrance_f(want, wi, wo, g);
		for (int c = 0; c < 3; c++)
			check_rel(f[c], g[c], tolerance, "value");
	}
}

/* The error of a model on a table, as the first number behind the words in the header tells it. */
static void expect_stated(const char *words, double error)
{
	const char *at = strstr(last.out, words);

	if (!at)
		fail_msg("no '%s' in %.600s", words, last.out);
	check_rel(strtod(at + strlen(words), NULL), error, 1e-4, words);
}

static double error_weighted(double max_theta, enum weight weight, const struct cook_torrance *truth,
			     const struct cook_torrance *model)
{
	struct fit_options options = fit_options_default();
	struct measurement measurement;
	struct fit_metrics metrics;
	struct error error = {""};

	options.criterion.max_theta = max_theta;
	assert_int_equal(model_table(truth, BINS_NODE, 180, max_theta, 1, &measurement), STATUS_OK);
	assert_int_equal(fit_eval(&measurement, model, &options, &metrics, &error), STATUS_OK);
	measurement_free(&measurement);
	return metrics.error[weight];
}

static double error_within(double max_theta, const struct cook_torrance *truth, const struct cook_torrance *model)
{
	return error_weighted(max_theta, WEIGHT_SOLID_ANGLE, truth, model);
}

static double error_on(const struct cook_torrance *truth, const struct cook_torrance *model)
{
	return error_within(12, truth, model);
}

/* Mitsuba 3 */

static double attribute_number(const struct xml *parent, const char *tag, const char *name)
{
	const struct xml *xml = xml_named(parent, name);
	char *end;

	if (!xml)
		fail_msg("no %s", name);
	assert_string_equal(xml->tag, tag);
	const double x = strtod(xml_get(xml, "value"), &end);
	assert_true(*xml_get(xml, "value") && !*end);
	return x;
}

static void attribute_rgb(const struct xml *parent, const char *name, double scale, double rgb[3])
{
	const struct xml *xml = xml_named(parent, name);
	int used = 0;

	if (!xml || sscanf(xml_get(xml, "value"), "%lf, %lf, %lf%n", &rgb[0], &rgb[1], &rgb[2], &used) != 3)
		fail_msg("no %s", name);
	assert_string_equal(xml->tag, "rgb");
	assert_int_equal(xml_get(xml, "value")[used], '\0');
	for (int c = 0; c < 3; c++) {
		check_between(rgb[c], 0, 1, "a reflectance of Mitsuba's");
		rgb[c] *= scale;
	}
}

static void read_diffuse(const struct xml *bsdf, double weight, struct cook_torrance *model)
{
	assert_string_equal(xml_get(bsdf, "type"), "diffuse");
	attribute_rgb(bsdf, "reflectance", weight, model->kd);
}

static void read_lobe(const struct xml *bsdf, double weight, struct cook_torrance *model)
{
	const struct xml *distribution = xml_named(bsdf, "distribution"), *material = xml_named(bsdf, "material");
	const double alpha = attribute_number(bsdf, "float", "alpha");

	assert_string_equal(xml_get(bsdf, "type"), "roughconductor");
	assert_non_null(distribution);
	assert_int_equal(ndf_init(&model->ndf, ndf_find(xml_get(distribution, "value")), alpha, alpha, NAN), STATUS_OK);
	attribute_rgb(bsdf, "specular_reflectance", weight, model->ks);
	if (material) {
		assert_string_equal(xml_get(material, "value"), "none");
		model->fresnel = FRESNEL_NONE;
		return;
	}
	model->fresnel = FRESNEL_CONDUCTOR; /* of k = 0: the dielectric form */
	model->n = attribute_number(bsdf, "spectrum", "eta");
	model->k = attribute_number(bsdf, "spectrum", "k");
}

/* What the scene in last.out says. */
static struct cook_torrance read_mitsuba(void)
{
	struct xml *scene = xml_parse(last.out);
	struct cook_torrance model = {.gaf = GAF_UNCORRELATED, .n = 1.5};

	assert_int_equal(ndf_init(&model.ndf, ndf_find("ggx"), 1, 1, 2), STATUS_OK);
	assert_string_equal(scene->tag, "scene");
	assert_int_equal(scene->n_children, 1);
	const struct xml *bsdf = scene->child[0];
	if (!strcmp(xml_get(bsdf, "type"), "blendbsdf")) {
		const double weight = attribute_number(bsdf, "float", "weight");
		assert_non_null(xml_named(bsdf, "bsdf_0"));
		assert_non_null(xml_named(bsdf, "bsdf_1"));
		check_between(weight, 0, 1, "weight");
		read_diffuse(xml_named(bsdf, "bsdf_0"), 1 - weight, &model);
		read_lobe(xml_named(bsdf, "bsdf_1"), weight, &model);
	} else if (!strcmp(xml_get(bsdf, "type"), "diffuse")) {
		read_diffuse(bsdf, 1, &model);
	} else {
		read_lobe(bsdf, 1, &model);
	}
	xml_free(scene);
	return model;
}

static void expect_mitsuba(const char *arguments, const char *how, struct cook_torrance want)
{
	char first[64];

	export_it(arguments);
	snprintf(first, sizeof first, "<!-- %s", how);
	assert_memory_equal(last.out, first, strlen(first));
	const struct cook_torrance got = read_mitsuba();
	expect_same(&got, &want, 2e-15);
}

static void mitsuba_says_what_it_can(void **state)
{
	struct cook_torrance model = given("ggx", 0.23, 2, 1.61);

	(void)state;
	memcpy(model.ks, (double[]){0.42, 0.53, 0.6}, sizeof model.ks);
	expect_mitsuba("--format mitsuba " LOBE " --ndf ggx --sigma 0.23 --ior 1.61", "exact: ", model);
	model.fresnel = FRESNEL_NONE;
	expect_mitsuba("--format mitsuba " LOBE " --ndf ggx --sigma 0.23 --fresnel none", "exact: ", model);
	model.fresnel = FRESNEL_CONDUCTOR;
	model.k = 3.25;
	expect_mitsuba("--format mitsuba " LOBE
		       " --ndf std --gamma 2 --sigma 0.23 --ior 1.61 --k 3.25 --fresnel conductor",
		       "exact: ", model);
	/* GGX under other names. */
	model = given("gtr", 0.3, 2, 1.5);
	expect_mitsuba("--format mitsuba " LOBE " --ndf gtr --gamma 2 --sigma 0.3", "exact: ", model);
	model = given("hyper-cauchy", 0.3, 2, 1.5);
	expect_mitsuba("--format mitsuba " LOBE " --ndf hyper-cauchy --gamma 2 --sigma 0.3", "exact: ", model);
	model = given("beckmann", 0.5, INFINITY, 1.5);
	expect_mitsuba("--format mitsuba " LOBE " --ndf std --gamma inf --sigma 0.5", "approximate: the model itself",
		       model);
	model = given("ggx", 0.5, 2, 1.5);
	memset(model.kd, 0, sizeof model.kd);
	expect_mitsuba("--format mitsuba --ks 0.42,0.53,0.6 --ndf ggx --sigma 0.5", "exact: ", model);
	model = given("ggx", 0.5, 2, 1.5);
	memset(model.ks, 0, sizeof model.ks);
	expect_mitsuba("--format mitsuba --kd 0.31,0.12,0.047", "exact: ", model);
}

static void mitsuba_gets_a_substitute(void **state)
{
	const struct cook_torrance truth = given("std", 0.2, 1.7, 1.5);

	(void)state;
	export_it(SMALL " --format mitsuba " LOBE " --ndf std --gamma 1.7 --sigma 0.2");
	expect_out("<!-- approximate: Mitsuba 3 has no NDF std of gamma 1.7; ggx (gamma 2) was fitted in its place "
		   "(format bsdf-rgb has the model itself) -->");
	expect_out("error of the model 0, of what stands here");
	const struct cook_torrance got = read_mitsuba();
	assert_string_equal(ndf_name(got.ndf.class), "ggx");
	expect_stated("of what stands here ", error_on(&truth, &got));
	expect_stated("; weight cosine: 0, ", error_weighted(12, WEIGHT_COSINE, &truth, &got));
	expect_stated("; weight none: 0, ", error_weighted(12, WEIGHT_NONE, &truth, &got));
	/* Another weight is another fit, better under that weight. */
	export_it(SMALL " --weight none --format mitsuba " LOBE " --ndf std --gamma 1.7 --sigma 0.2");
	const struct cook_torrance unweighted = read_mitsuba();
	expect_stated("of what stands here ", error_weighted(12, WEIGHT_NONE, &truth, &unweighted));
	assert_true(error_weighted(12, WEIGHT_NONE, &truth, &unweighted) <
		    error_weighted(12, WEIGHT_NONE, &truth, &got));
	assert_true(error_on(&truth, &unweighted) > error_on(&truth, &got));
	/* It is a fit: dropping gamma alone does worse. */
	struct cook_torrance dropped = given("ggx", 0.2, 2, 1.5);
	assert_true(error_on(&truth, &got) < 0.8 * error_on(&truth, &dropped));
	export_it(SMALL " --format mitsuba " LOBE " --ndf std --gamma 20 --sigma 0.2");
	expect_out("<!-- approximate: Mitsuba 3 has no NDF std of gamma 20; beckmann was fitted in its place");
	const struct cook_torrance nearer = read_mitsuba(), far = given("std", 0.2, 20, 1.5);
	expect_stated("of what stands here ", error_on(&far, &nearer));
}

static void mitsuba_blends_within_one(void **state)
{
	struct cook_torrance truth = make_model("ggx", 0.3, 2, 1.4);

	(void)state;
	for (int c = 0; c < 3; c++) {
		truth.kd[c] = 0.3;
		truth.ks[c] = 0.9;
	}
	export_it(SMALL " --format mitsuba --kd 0.3 --ks 0.9 --ndf ggx --sigma 0.3 --ior 1.4");
	expect_out("no kd + ks of 1.2, more than 1; ggx (gamma 2) was fitted in its place, with kd + ks up to 1 "
		   "(format bsdf-rgb has the model itself) -->");
	struct cook_torrance got = read_mitsuba();
	assert_true(got.kd[0] + got.ks[0] <= 1 + 1e-15);
	assert_true(got.n > 1.4); /* reflects more */
	expect_stated("of what stands here ", error_on(&truth, &got));
	check_between(error_on(&truth, &got), 0, 1e-4, "error of the blend");

	/* Without an index to raise: neither other weights nor another roughness do better. */
	truth = make_model("ggx", 0.3, 2, 1);
	truth.fresnel = FRESNEL_NONE;
	for (int c = 0; c < 3; c++) {
		truth.kd[c] = 0.6;
		truth.ks[c] = 0.9;
	}
	export_it("--max-theta 40 --threads 1 --format mitsuba --kd 0.6 --ks 0.9 --ndf ggx --sigma 0.3 --fresnel none");
	got = read_mitsuba();
	check_rel(got.kd[0] + got.ks[0], 1, 1e-15, "kd + ks");
	const double best = error_within(40, &truth, &got);
	expect_stated("of what stands here ", best);
	for (int side = -1; side <= 1; side += 2) {
		struct cook_torrance weights = got, roughness = got;
		const double sigma = got.ndf.sigma_x * (1 + 0.02 * side);
		for (int c = 0; c < 3; c++) {
			weights.kd[c] += 0.01 * side;
			weights.ks[c] -= 0.01 * side;
		}
		assert_int_equal(ndf_init(&roughness.ndf, got.ndf.class, sigma, sigma, 2), STATUS_OK);
		assert_true(error_within(40, &truth, &weights) > best);
		assert_true(error_within(40, &truth, &roughness) > best);
	}
	stdfit("export --format mitsuba --kd 1.2");
	expect_error(1, "no reflectance above 1");
}

static void xmllint_takes_it(void **state)
{
	(void)state;
	if (system("command -v xmllint >/dev/null") != 0)
		skip_for_want_of("libxml2-utils");
	shell("\"$STDFIT\" export --format mitsuba --kd 0.2 --ks 0.3 --sigma 0.2 --ndf ggx | xmllint --noout -");
	expect_code(0);
}

/* pbrt-v4 */

/* The numbers in brackets, or the one, behind a parameter's name. */
static const char *parameter(const char *text, const char *name)
{
	const char *at = strstr(text, name);

	if (!at)
		fail_msg("no %s in %s", name, text);
	return at + strlen(name);
}

/* The pairs behind the name; n of them. */
static size_t read_spectrum(const char *name, double *nm, double *value)
{
	const char *at = parameter(last.out, name);
	size_t n = 0;
	int used;

	assert_memory_equal(at, " [", 2);
	for (at += 2; sscanf(at, "%lf %lf%n", &nm[n], &value[n], &used) == 2; at += used)
		assert_true(++n < 8);
	assert_memory_equal(at, " ]", 2);
	assert_true(n > 0 && nm[0] <= 360 && nm[n - 1] >= 830);
	return n;
}

/* But for its index of refraction. */
static struct cook_torrance read_pbrt_parts(void)
{
	struct cook_torrance model = {.gaf = GAF_CORRELATED, .fresnel = FRESNEL_CONDUCTOR};

	assert_int_equal(sscanf(parameter(last.out, "\"rgb reflectance\""), " [ %lf %lf %lf ]", &model.kd[0],
				&model.kd[1], &model.kd[2]),
			 3);
	const double sigma = strtod(parameter(last.out, "\"float roughness\""), NULL);
	parameter(last.out, "\"bool remaproughness\" false");
	assert_int_equal(ndf_init(&model.ndf, ndf_find("ggx"), sigma, sigma, 2), STATUS_OK);
	const double amount = strtod(parameter(last.out, "\"float amount\""), NULL);
	check_between(amount, 0, 1, "amount");
	for (int c = 0; c < 3; c++) {
		check_between(model.kd[c], 0, 1, "a reflectance of pbrt's");
		model.kd[c] *= 1 - amount;
		model.ks[c] = amount;
	}
	return model;
}

static struct cook_torrance read_pbrt(void)
{
	struct cook_torrance model = read_pbrt_parts();
	double nm[8], value[8];

	assert_int_equal(read_spectrum("\"spectrum eta\"", nm, value), 2);
	assert_true(value[0] == value[1]);
	model.n = value[0];
	assert_int_equal(read_spectrum("\"spectrum k\"", nm, value), 2);
	assert_true(value[0] == value[1]);
	model.k = value[0];
	return model;
}

static void pbrt_says_what_it_can(void **state)
{
	struct cook_torrance model = given("ggx", 0.23, 2, 1.61);

	(void)state;
	model.gaf = GAF_CORRELATED;
	for (int c = 0; c < 3; c++)
		model.ks[c] = 0.55;
	export_it("--format pbrt --kd 0.31,0.12,0.047 --ks 0.55 --ndf ggx --sigma 0.23 --ior 1.61 --gaf correlated");
	assert_memory_equal(last.out, "# exact: ", 9);
	struct cook_torrance got = read_pbrt();
	expect_same(&got, &model, 2e-15);
	assert_null(strstr(last.out, "--"));

	export_it(SMALL " --format pbrt --kd 0.3 --ks 0.5 --ndf std --gamma 1.8 --sigma 0.23");
	expect_out("# approximate: pbrt-v4 has no NDF std of gamma 1.8, no uncorrelated G; ggx (gamma 2) was fitted");
	got = read_pbrt();
	struct cook_torrance truth = make_model("std", 0.23, 1.8, 1.5);
	for (int c = 0; c < 3; c++) {
		truth.kd[c] = 0.3;
		truth.ks[c] = 0.5;
	}
	expect_stated("of what stands here ", error_on(&truth, &got));

	stdfit("export --format pbrt --ks 0.5 --ndf ggx --sigma 0.0005 --gaf correlated");
	expect_error(1, "for a mirror");
}

/* E of a function of two directions, on the entries of SMALL, weighted by solid angles: by its definition. */
static double error_of_function(void (*shown)(const void *context, struct vec3 wi, struct vec3 wo, double f[3]),
				const void *context, const struct cook_torrance *truth)
{
	double difference = 0, sum = 0;

	/* Beyond theta_h, theta_d = 12 degrees one of the directions is. */
	for (int i = 0; i * i <= 12 * 90; i++)
		for (int j = 0; j <= 12; j++)
			for (int k = 0; k < 180; k++) {
				struct vec3 wi, wo;
				double f[3], m[3];

				halfdiff_trig_dirs(bins_trig(BINS_NODE, i, j, k), &wi, &wo);
				if (!entry_in_range(wi, wo, max_theta_cos(12)))
					continue;
				shown(context, wi, wo, f);
				cook_torrance_f(truth, wi, wo, m);
				const double w = weight_at(WEIGHT_SOLID_ANGLE, i, j, wi.z, wo.z);
				for (int c = 0; c < 3; c++) {
					difference += w * fabs(f[c] - m[c]);
					sum += w * m[c];
				}
			}
	return difference / sum;
}

/* A coloured lobe, whose spectra have their colour under D65. */
struct pbrt {
	struct cook_torrance lobe; /* F = 1, ks = 1 */
	size_t n;
	double kd[3], amount, nm[8], eta[8], k[8], weight[3 * 8];
};

static struct pbrt read_coloured_pbrt(void)
{
	struct pbrt p = {.lobe = read_pbrt_parts()};

	memcpy(p.kd, p.lobe.kd, sizeof p.kd);
	p.amount = p.lobe.ks[0];
	p.lobe.fresnel = FRESNEL_NONE;
	p.n = read_spectrum("\"spectrum eta\"", p.nm, p.eta);
	assert_int_equal(read_spectrum("\"spectrum k\"", p.nm, p.k), p.n);
	assert_int_equal(spectrum_weights(p.nm, p.n, p.weight), STATUS_OK);
	return p;
}

static void pbrt_f(const void *context, struct vec3 wi, struct vec3 wo, double f[3])
{
	const struct pbrt *p = context;
	const double cos_d = vec3_dot(wi, vec3_unit(vec3_add(wi, wo)));
	const double lobe = p->amount * cook_torrance_lobe(&p->lobe, wi, wo);
	double F[8];

	for (size_t j = 0; j < p->n; j++)
		F[j] = fresnel_conductor(cos_d, p->eta[j], p->k[j]);
	spectrum_rgb(p->weight, F, p->n, f);
	for (int c = 0; c < 3; c++)
		f[c] = p->kd[c] / M_PI + lobe * f[c];
}

static void pbrt_has_colours_in_its_index(void **state)
{
	static const struct {
		const char *options;
		enum fresnel fresnel;
		double n, k, most; /* the error */
	} models[] = {
		{LOBE " --ndf ggx --sigma 0.23 --gaf correlated", FRESNEL_DIELECTRIC, 1.5, 0, 1e-4},
		{LOBE " --ndf ggx --sigma 0.23 --gaf correlated --fresnel conductor --ior 1.3 --k 2", FRESNEL_CONDUCTOR,
		 1.3, 2, 1e-4},
		{"--ks 0.42,0.53,0.6 --ndf ggx --sigma 0.23 --gaf correlated --ior 4", FRESNEL_DIELECTRIC, 4, 0, 1e-4},
	};

	(void)state;
	for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
		struct cook_torrance truth = given("ggx", 0.23, 2, models[i].n);
		char arguments[200];
		double f[3], want[3];
		const struct vec3 up = {0, 0, 1};

		truth.gaf = GAF_CORRELATED;
		truth.fresnel = models[i].fresnel;
		truth.k = models[i].k;
		if (!strstr(models[i].options, "--kd"))
			memset(truth.kd, 0, sizeof truth.kd);
		snprintf(arguments, sizeof arguments, SMALL " --format pbrt %s", models[i].options);
		export_it(arguments);
		expect_out("# approximate: pbrt-v4 has no ks of its own for each channel (format bsdf has the model "
			   "itself)");
		const struct pbrt p = read_coloured_pbrt();
		/* Along the normal it is the model, in each channel. */
		pbrt_f(&p, up, up, f);
		cook_torrance_f(&truth, up, up, want);
		for (int c = 0; c < 3; c++)
			check_rel(f[c], want[c], 1e-12, "value along the normal");
		const double error = error_of_function(pbrt_f, &p, &truth);
		/* A table's entries have 24 bits. */
		check_abs(strtod(parameter(last.out, "of what stands here "), NULL), error, 1e-7, "error");
		check_between(error, 0, models[i].most, models[i].options);
	}
	/* Of another distribution and G. */
	const struct cook_torrance truth = given("std", 0.2, 1.7, 1.5);
	export_it(SMALL " --format pbrt " LOBE " --ndf std --gamma 1.7 --sigma 0.2");
	expect_out(
		"pbrt-v4 has no NDF std of gamma 1.7, no uncorrelated G; ggx (gamma 2) was fitted in its place (format "
		"bsdf has the model itself); the colour of its ks is in the index of refraction");
	const struct pbrt p = read_coloured_pbrt();
	expect_stated("of what stands here ", error_of_function(pbrt_f, &p, &truth));
}

/* glTF */

static double member_number(const json_t *json, const char *name)
{
	const json_t *member = json_object_get(json, name);

	if (!json_is_number(member))
		fail_msg("no number '%s'", name);
	return json_number_value(member);
}

static void member_rgb(const json_t *json, const char *name, double rgb[3])
{
	const json_t *member = json_object_get(json, name);

	assert_true(json_array_size(member) >= 3);
	for (size_t c = 0; c < 3; c++)
		rgb[c] = json_number_value(json_array_get(member, c));
}

/* The material model of the glTF specification, from its own numbers. */
struct gltf {
	double base[3], roughness, ior, specular, color[3];
};

static struct gltf read_gltf(void)
{
	json_error_t error;
	json_t *json = json_loads(last.out, JSON_REJECT_DUPLICATES, &error);
	struct gltf g;

	if (!json)
		fail_msg("line %d: %s", error.line, error.text);
	const json_t *material = json_array_get(json_object_get(json, "materials"), 0);
	const json_t *pbr = json_object_get(material, "pbrMetallicRoughness"),
		     *more = json_object_get(material, "extensions");
	const json_t *specular = json_object_get(more, "KHR_materials_specular");
	assert_string_equal(json_string_value(json_object_get(json_object_get(json, "asset"), "version")), "2.0");
	assert_true(member_number(pbr, "metallicFactor") == 0);
	member_rgb(pbr, "baseColorFactor", g.base);
	g.roughness = member_number(pbr, "roughnessFactor");
	g.ior = member_number(json_object_get(more, "KHR_materials_ior"), "ior");
	g.specular = member_number(specular, "specularFactor");
	member_rgb(specular, "specularColorFactor", g.color);
	check_between(g.roughness, 0, 1, "roughness");
	check_between(g.specular, 0, 1, "specular");
	json_decref(json);
	return g;
}

static void gltf_f(const struct gltf *g, struct vec3 l, struct vec3 v, double f[3])
{
	const double alpha = g->roughness * g->roughness, a2 = alpha * alpha;
	const struct vec3 h = vec3_unit(vec3_add(l, v));
	const double s = h.z * h.z * (a2 - 1) + 1, D = a2 / (M_PI * s * s);
	const double V = 0.5 / (l.z * sqrt(a2 + (1 - a2) * v.z * v.z) + v.z * sqrt(a2 + (1 - a2) * l.z * l.z));
	const double x = pow(1 - fabs(vec3_dot(v, h)), 5);
	double fr[3], most = 0;

	for (int c = 0; c < 3; c++) {
		const double f0 = fmin(pow((1 - g->ior) / (1 + g->ior), 2) * g->color[c], 1);
		fr[c] = f0 + (1 - f0) * x;
		most = fmax(most, fr[c]);
	}
	for (int c = 0; c < 3; c++)
		f[c] = (1 - g->specular * most) * g->base[c] / M_PI + g->specular * fr[c] * D * V;
}

static void gltf_shown(const void *context, struct vec3 wi, struct vec3 wo, double f[3])
{
	gltf_f(context, wi, wo, f);
}

static double gltf_error(const struct gltf *g, const struct cook_torrance *truth)
{
	return error_of_function(gltf_shown, g, truth);
}

/* No neighbour is better, beyond what the fit's choice of entries leaves open. */
static void expect_gltf_optimum(const struct gltf *g, const struct cook_torrance *truth)
{
	const double best = gltf_error(g, truth);

	for (int side = -1; side <= 1; side += 2) {
		struct gltf roughness = *g, base = *g, color = *g;
		roughness.roughness *= 1 + 0.01 * side;
		assert_true(gltf_error(&roughness, truth) > best);
		for (int c = 0; c < 3; c++) {
			base.base[c] *= 1 + 0.03 * side;
			color.color[c] *= 1 + 0.03 * side;
		}
		assert_true(gltf_error(&base, truth) > best);
		assert_true(gltf_error(&color, truth) > best);
	}
}

static void gltf_is_fitted_in_its_own_terms(void **state)
{
	struct cook_torrance truth = given("ggx", 0.09, 2, 1.5);

	(void)state;
	truth.gaf = GAF_CORRELATED;
	truth.fresnel = FRESNEL_SCHLICK;
	export_it(SMALL " --format gltf " LOBE " --ndf ggx --sigma 0.09 --gaf correlated --fresnel schlick");
	expect_out(
		"\"approximate: glTF has no sum of two lobes; its lobe takes what it reflects from the diffuse part");
	struct gltf g = read_gltf();
	check_rel(g.roughness, 0.3, 1e-3, "roughness");
	assert_true(g.specular == 1);
	/* F0 is ks F0 of the model, the base makes up for what the lobe takes. */
	const double F0 = pow((g.ior - 1) / (g.ior + 1), 2) * g.color[0];
	check_rel(F0, 0.42 * 0.04, 1e-2, "F0");
	check_rel(g.base[0], 0.31 / (1 - 0.6 * 0.04), 1e-2, "base");
	check_between(gltf_error(&g, &truth), 0, 1e-6, "error where F hardly changes");
	expect_gltf_optimum(&g, &truth);

	truth = given("std", 0.2, 1.7, 1.5);
	export_it(SMALL " --format gltf " LOBE " --sigma 0.2 --gamma 1.7");
	expect_out("no NDF std of gamma 1.7, no uncorrelated G, no Fresnel term dielectric; ggx (gamma 2) was fitted");
	g = read_gltf();
	expect_stated("of what stands here ", gltf_error(&g, &truth));
	expect_gltf_optimum(&g, &truth);
	/* An ior that importers would not take: its F0 is in the colour. */
	truth = given("ggx", 0.09, 2, 40);
	truth.gaf = GAF_CORRELATED;
	truth.fresnel = FRESNEL_SCHLICK;
	export_it(SMALL " --format gltf " LOBE " --ndf ggx --sigma 0.09 --ior 40 --gaf correlated --fresnel schlick");
	g = read_gltf();
	check_rel(g.ior, 2.5, 1e-15, "ior");
	assert_true(g.color[2] > 1);
	check_between(gltf_error(&g, &truth), 0, 1e-6, "error where F hardly changes");
	export_it(SMALL " --format gltf " LOBE " --ndf ggx --sigma 2.5 --gaf correlated --fresnel schlick");
	read_gltf();
	expect_out("no roughness of 2.5");
	assert_null(strstr(last.out, "exact"));
	export_it("--format gltf --kd 0.31,0.12,0.047");
	expect_out("exact: the model itself");
	g = read_gltf();
	assert_true(g.specular == 0);
}

/* MERL */

static void merl_is_the_model(void **state)
{
	const struct cook_torrance model = given("ggx", 0.2, 2, 1.5);
	struct measurement want = make_table(&model, 180, BINS_CENTRE, 0), got;
	struct error error = {""};
	size_t n = 0;

	(void)state;
	stdfit("export --format merl --threads 1 -o made.binary --bins centre " LOBE " --ndf ggx --sigma 0.2");
	expect_code(0);
	assert_string_equal(last.out, "");
	assert_memory_equal(last.err, "exact: ", 7);
	assert_int_equal(merl_read("made.binary", 1, &got, &error), STATUS_OK);
	for (int c = 0; c < 3; c++)
		for (size_t i = 0; i < measurement_count(&want); i++)
			if (!isnan(want.value[c][i])) {
				check_rel((double)got.value[c][i], (double)want.value[c][i], 1.3e-7, "entry");
				n++;
			}
	assert_true(n > 3000000);
	measurement_free(&want);
	measurement_free(&got);
	stdfit("export --format merl -o made.binary -q --kd 1");
	expect_code(0);
	assert_string_equal(last.err, "");
	assert_int_equal(remove("made.binary"), 0);
}

/* Where a target has one index for all channels, what stands there has n and k that all share, and ks the colour. */
static void an_index_for_each_channel_is_replaced(void **state)
{
	(void)state;
	export_it("--format mitsuba --ks 0.9 --ndf ggx --sigma 0.3 --fresnel conductor --ior 0.16,0.42,1.38 "
		  "--k 3.6,2.47,1.92");
	expect_part(last.out, "no index of its own for each channel", __LINE__);
	expect_part(last.out, "roughconductor", __LINE__);
	const char *ks = strstr(last.out, "specular_reflectance\" value=\"");
	double rgb[3];

	assert_int_equal(
		sscanf(ks ? ks : "", "specular_reflectance\" value=\"%lf, %lf, %lf", &rgb[0], &rgb[1], &rgb[2]), 3);
	assert_true(rgb[0] > 1.05 * rgb[1] && rgb[1] > 1.2 * rgb[2]);
	stdfit("export --format brdf --ks 0.9 --ndf ggx --sigma 0.3 --fresnel conductor --ior 0.16,0.42,1.38 --k 3");
	expect_error(1, "no index for each channel");
}

/* JSON */

static void json_is_the_model(void **state)
{
	static const char *const lines[] = {
		LOBE " --sigma 0.2 --gamma 1.7",
		LOBE " --sigma 0.123456789012345678 --ndf beckmann --gaf v-groove --fresnel none",
		LOBE " --sigma 0.2 --ndf ggx --gaf correlated --fresnel schlick --ior 2.2",
		LOBE " --sigma 0.2 --gamma inf --fresnel conductor --ior 1.7 --k 3.3",
		LOBE " --sigma 0.2 --gamma inf --fresnel conductor --ior 0.16,0.42,1.38 --k 3.6,2.47,1.92",
		LOBE " --sigma 0.2 --gamma 1.2 --ndf gtr",
		LOBE " --sigma 0.2 --gamma 0.7 --ndf low --bins centre --max-theta 70",
		LOBE " --sigma 0.2 --gamma 2.3 --ndf hyper-cauchy",
		LOBE " --sigma 0.2 --gamma 2.3 --ndf t-family --lambda rational",
		"--kd 0.25",
	};

	(void)state;
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		char *command;

		assert_true(asprintf(&command, "--format json -o model.json %s", lines[i]) > 0);
		export_it(command);
		free(command);
		export_it("--format json --from model.json");
		char *first = slurp("model.json");
		assert_string_equal(last.out, first);
		free(first);
	}
}

static void json_holds_a_table_of_nodes(void **state)
{
	const struct fit_options fit = fit_options_default();
	struct fit_options read_fit = fit;
	double theta[40], D[40];
	struct pwl pwl;
	struct cook_torrance model = make_model("ggx", 0.2, 2, 1.5);
	struct model_json read;
	struct export export;
	struct error error = {""};

	(void)state;
	for (int i = 0; i < 40; i++) {
		theta[i] = i < 39 ? 0.04 * i : M_PI_2;
		D[i] = exp(-4 * theta[i]) * (1.1 + sin(9 * theta[i]));
	}
	assert_int_equal(pwl_init(&pwl, 40, theta, D, NULL), STATUS_OK);
	ndf_from_pwl(&model.ndf, &pwl);
	const struct export_source source = {
		&model, &fit, 0.123456789012345, WEIGHT_NONE, "name \"quoted\" \\ \xc3\xa9", "a/b.binary", NULL, 0, 0};
	FILE *file = fopen("pl.json", "w");
	assert_non_null(file);
	assert_int_equal(export_prepare(&export, EXPORT_JSON, &source, &error), STATUS_OK);
	assert_int_equal(export_write(&export, file, &error), STATUS_OK);
	assert_int_equal(fclose(file), 0);
	if (model_json_read("pl.json", &read, &read_fit, &error))
		fail_msg("%s", error.text);
	expect_same(&read.model, &model, 1e-14);
	assert_string_equal(read.material, source.material);
	assert_string_equal(read.path, source.path);
	assert_true(read.error == source.error);
	model_json_free(&read);
	pwl_free(&pwl);
}

/* Texts that are no JSON, and what is said of them. */
static const struct {
	const char *text, *part;
} no_json[] = {
	{"", "line 1, column 0: '[' or '{' expected near end of file"},
	{"{", "string or '}' expected"},
	{"[1, 2", "']' expected"},
	{"[1 2]", "']' expected near '2'"},
	{"[01]", "invalid token near '0'"},
	{"[1.]", "invalid token near '1.'"},
	{"[1e999]", "real number overflow"},
	{"{\"a\": 1,}", "string or '}' expected near '}'"},
	{"{\"a\" 1}", "':' expected"},
	{"[\"\\u0000\"]", "\\u0000"},
	{"[\"\\ud800\"]", "invalid Unicode"},
	{"[\"open", "premature end of input"},
	{"[nul]", "invalid token near 'nul'"},
	{"1 2", "'[' or '{' expected"},
	{"[1] 2", "end of file expected"},
	{"\n\n  x", "line 3, column 3: '[' or '{' expected near 'x'"},
	{"{\"ndf\": \"std\", \"ndf\": \"ggx\"}", "duplicate object key near '\"ndf\"'"},
	{"[\"\xff\"]", "unable to decode byte 0xff"},
	{"[1]", "describes no model: the member \"format\""},
};

static void expect_no_model(const char *text, const char *part)
{
	struct fit_options fit = fit_options_default();
	struct model_json read;
	struct error error = {""};

	write_text("bad.json", text);
	assert_int_equal(model_json_read("bad.json", &read, &fit, &error), STATUS_FORMAT);
	if (!strstr(error.text, part) || !strstr(error.text, "'bad.json'"))
		fail_msg("%s: %s", text, error.text);
}

static void bad_json_is_reported(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof no_json / sizeof *no_json; i++)
		expect_no_model(no_json[i].text, no_json[i].part);
	/* Deeper than anybody would write, but closed. */
	enum { DEEP = 4000 };
	char deep[2 * DEEP + 1];
	memset(deep, '[', DEEP);
	memset(deep + DEEP, ']', DEEP);
	deep[2 * DEEP] = '\0';
	expect_no_model(deep, "maximum parsing depth reached");

	export_it("--format json -o good.json " LOBE " --sigma 0.2 --gamma 1.7");
	static const char *const edits[][2] = {
		{"s/stdfit-model-1/x/", "\\\"format\\\""},
		{"s/\"std\"/\"none\"/", "\"ndf\""},
		{"s/\"gamma\": 1.7/\"gamma\": 1/", "parameters"},
		{"s/0.31/-1/", "\"kd\""},
		{"s/uncorrelated/x/", "\"gaf\""},
		{"s/\"k\": 0/\"k\": null/", "\"k\""},
		{"s/\"max_theta\": 90/\"max_theta\": 91/", "\"fitted\""},
	};
	for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
		char *command;

		assert_true(
			asprintf(&command,
				 "sed '%s' good.json >bad.json; exec \"$STDFIT\" export --format brdf --from bad.json",
				 edits[i][0]) > 0);
		shell(command);
		free(command);
		expect_error(1, i ? edits[i][1] : "\"format\"");
	}
}

static void escapes_and_big_numbers_are_read(void **state)
{
	struct fit_options fit = fit_options_default();
	struct model_json read;
	struct error error = {""};

	(void)state;
	write_text(
		"escaped.json",
		"{\"format\": \"stdfit-model-1\", \"material\": \"\\u00e9\\ud83d\\ude00\\n\", \"kd\": [0, 1e-3, 1],\n"
		" \"ks\": [0.5, 0.5, 0.5], \"ndf\": \"std\", \"lambda\": \"exact\", \"unknown\": [true, null, "
		"-1.5e3],\n"
		" \"parameters\": {\"sigma\": 0.25, \"gamma\": 100000000000000000000}, \"gaf\": \"correlated\",\n"
		" \"fresnel\": \"schlick\", \"ior\": 2, \"k\": 0,\n"
		" \"fitted\": {\"weight\": \"none\", \"bins\": \"node\", \"max_theta\": 80, \"error\": null}}\n");
	if (model_json_read("escaped.json", &read, &fit, &error))
		fail_msg("%s", error.text);
	assert_string_equal(read.material, "\xc3\xa9\xf0\x9f\x98\x80\n");
	assert_true(read.model.ndf.gamma == 1e20);
	model_json_free(&read);
}

/* Every prefix, and bytes changed at random: read or refused, never a crash. */
static void damaged_json_is_read_or_refused(void **state)
{
	struct fit_options fit = fit_options_default();
	struct model_json read;
	struct error error;
	unsigned seed = 5;
	size_t refused = 0;

	(void)state;
	export_it("--format json -o good.json " LOBE " --sigma 0.2 --gamma 1.7");
	char *good = slurp("good.json");
	const size_t length = strlen(good);
	for (size_t i = 0; i < 2 * length; i += 5) {
		char *text = strdup(good);
		if (i < length)
			text[i] = '\0';
		else
			for (int k = 0; k < 3; k++)
				text[(size_t)(random_unit(&seed) * (double)length)] =
					(char)(unsigned char)(1 + 254 * random_unit(&seed));
		write_text("damaged.json", text);
		free(text);
		const enum status status = model_json_read("damaged.json", &read, &fit, &error);
		assert_true(status == STATUS_OK || status == STATUS_FORMAT);
		refused += status != STATUS_OK;
		if (!status)
			model_json_free(&read);
	}
	assert_true(refused >= length / 5 - 1);
	free(good);
}

/* From a file and from a table */

static void a_fit_and_its_row_export_alike(void **state)
{
	(void)state;
	stdfit("synth m.binary --kd 0.2,0.1,0.05 --ks 0.5 --sigma 0.2 --gamma 1.8 --noise 0.1 --threads 1");
	expect_code(0);
	stdfit("fit m.binary --ndf std,ggx --max-theta 12 --threads 1 -o fits.csv -q");
	expect_code(0);
	export_it("m.binary --format json --ndf std --weight none --max-theta 12 --threads 1 -o fit.json");
	export_it("m.binary --from fits.csv --ndf std --format json -o row.json");
	char *fit = slurp("fit.json"), *row = slurp("row.json");
	assert_string_equal(fit, row);
	free(fit);
	free(row);
	export_it("--from fits.csv --row 2 --format json");
	assert_string_equal(strstr(last.out, "\"ndf\": \"std\"") ? "std" : "other", "std");
	/* The substitute is fitted to the file that the row is of, and gets the errors of the table. */
	struct csv_table table = read_table("fits.csv");
	export_it("--from fits.csv --row 2 --format mitsuba --weight none");
	expect_out("against m.binary");
	expect_stated("error of the model ", result_number(table.row[1], RESULT_ERROR));
	expect_stated("of what stands here ", result_number(table.row[0], RESULT_ERROR));
	assert_string_equal(table.row[0][RESULT_NDF], "ggx");
	csv_table_free(&table);
	/* Not to one that has changed since. */
	stdfit("synth m.binary --kd 0.9");
	expect_code(0);
	export_it("--from fits.csv --row 2 --format mitsuba");
	expect_out("against a table of the model itself");
}

/* What is exported is to be looked at: a fit made for it is under the weight that pictures agree with, and that is told. */
static void its_own_fit_looks_right(void **state)
{
	(void)state;
	stdfit("synth looks.binary --kd 0.2,0.1,0.05 --ks 0.5 --sigma 0.2 --gamma 1.8 --noise 0.1 --threads 1");
	expect_code(0);
	stdfit("export looks.binary --format json --ndf ggx --max-theta 12 --threads 1");
	expect_error(0, "fitted under --weight solid-angle");
	expect_out("\"weight\": \"solid-angle\"");
	stdfit("export looks.binary --format json --ndf ggx --max-theta 12 --threads 1 -q");
	assert_string_equal(last.err, "");
	expect_out("\"weight\": \"solid-angle\"");
	/* Whoever names a weight gets it, and a row keeps its own: nothing is told. */
	stdfit("export looks.binary --format json --ndf ggx --max-theta 12 --weight cosine --threads 1");
	assert_string_equal(last.err, "");
	expect_out("\"weight\": \"cosine\"");
	stdfit("fit looks.binary --ndf ggx --max-theta 12 --threads 1 -o looks.csv -q");
	expect_code(0);
	stdfit("export looks.binary --from looks.csv --format json");
	assert_string_equal(last.err, "");
	expect_out("\"weight\": \"none\"");
}

/* The model looks as `compare --pictures` finds it, which renders the same row; the substitute as a row of its own does. */
static void headers_tell_how_it_looks(void **state)
{
	double delta_e[2], ssim[2];

	(void)state;
	stdfit("synth look.binary --kd 0.2,0.1,0.05 --ks 0.5 --sigma 0.2 --gamma 1.8 --noise 0.1 --threads 1");
	expect_code(0);
	stdfit("fit look.binary --ndf std,ggx --max-theta 30 --threads 1 -o look.csv -q");
	expect_code(0);
	export_it("--from look.csv --row 2 --format mitsuba --weight none --threads 1");
	const char *at = strstr(last.out, "spheres in studio light: ");
	assert_non_null(at);
	assert_int_equal(
		sscanf(at, "spheres in studio light: delta E of the model %lf, of what stands here %lf; SSIM %lf, %lf",
		       &delta_e[0], &delta_e[1], &ssim[0], &ssim[1]),
		4);
	for (int i = 0; i < 2; i++) {
		static const char *const ndf[] = {"std", "ggx"};
		char *command;

		assert_true(asprintf(&command,
				     "\"$STDFIT\" compare look.csv --pictures --threads 1 | awk -F, "
				     "'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } "
				     "NR == 2 { print $at[\"delta_e_%s\"], $at[\"ssim_%s\"] }'",
				     ndf[i], ndf[i]) > 0);
		shell(command);
		free(command);
		expect_code(0);
		double e, similar;
		assert_int_equal(sscanf(last.out, "%lf %lf", &e, &similar), 2);
		check_abs(delta_e[i], e, 0.0051, "delta E");
		check_abs(ssim[i], similar, 0.000051, "SSIM");
	}
	/* What a glTF viewer shows of nearly this model; without the file, against the model itself. */
	export_it(SMALL
		  " --format gltf --kd 0.2,0.1,0.05 --ks 0.5 --ndf ggx --sigma 0.2 --gaf correlated --fresnel schlick");
	expect_out("(against the model itself)");
	at = strstr(last.out, "spheres in studio light: delta E of the model 0.00, of what stands here ");
	assert_non_null(at);
	check_between(strtod(strstr(at, "here ") + 5, NULL), 0.005, 0.5, "delta E of the layer");
}

static void refusals_are_one_line(void **state)
{
	static const struct {
		const char *arguments;
		int code;
		const char *part;
	} bad[] = {
		{"--kd 1", 2, "expected --format"},
		{"--kd 1 --format xyz", 2,
		 "expected one of brdf, merl, mitsuba, pbrt, gltf, materialx, bsdf, bsdf-rgb, json"},
		{"--format json", 2, "expected FILE to fit"},
		{"a b --format json", 2, "expected one FILE"},
		{"--kd 1 --format merl", 2, "needs -o FILE"},
		{"--kd 1 --format json --accuracy 1", 2, "--accuracy means nothing without --format bsdf"},
		{"--kd 1 --format json --size 1e6", 2, "--size means nothing without --format bsdf"},
		{"--kd 1 --weight none --format json", 2,
		 "--weight means nothing without a fit: --format json has every"},
		{"--from fits.csv --weight none --format merl -o x", 2, "--weight means nothing without a fit"},
		{"--kd 1 --gray --format json", 2, "--gray means nothing"},
		{"--kd 1 --row 1 --format json", 2, "--row means nothing"},
		{"x.binary --ndf std,ggx --format json", 2, "--ndf takes one name"},
		{"--from fits.csv --kd 1 --format json", 2, "--kd and --from exclude"},
		{"--from model.json --row 1 --format json", 2, "neither --row nor --ndf"},
		{"none.binary --format json", 1, "none.binary"},
		{"--from none.csv --format json", 1, "none.csv"},
		{"--from none.json --format json", 1, "none.json"},
		{"--from fits.csv --row 9 --format json", 1, "no such row"},
		{"--from fits.csv --format json", 1, "2 rows are meant"},
		{"--kd 1 --format json -o none/x.json", 1, "none/x.json"},
		{"--kd 1 --format json -o /dev/full", 1, "/dev/full"},
		{"--kd 1 --format merl -o /dev/full", 1, "/dev/full"},
		{"--sigma 0.0005 --ndf ggx --gaf correlated --format pbrt --ks 0.5 -o left.pbrt", 1, "for a mirror"},
	};

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		char *command;

		assert_true(asprintf(&command, "export %s", bad[i].arguments) > 0);
		stdfit(command);
		free(command);
		if (last.code != bad[i].code)
			fail_msg("%s: exit code %d", bad[i].arguments, last.code);
		expect_error(bad[i].code, bad[i].part);
		assert_string_equal(last.out, "");
	}
	assert_int_equal(access("left.pbrt", F_OK), -1);
	shell("exec \"$STDFIT\" export --kd 1 --format json >/dev/full");
	expect_error(1, "cannot write standard output");
	/* An older file stays where the new one cannot be written. */
	write_text("old.json", "old");
	if (THREAD_SANITIZER)
		return;
	shell("ulimit -f 0; exec \"$STDFIT\" export --kd 1 --format json -o old.json 2>/dev/full");
	expect_code(1);
	char *old = slurp("old.json");
	assert_string_equal(old, "old");
	free(old);
	shell("ls -A | grep tmp");
	assert_string_equal(last.out, "");
}

/* The sphere that a viewer shows: a unit sphere, closed, its triangles seen from outside. */
static void gltf_has_a_sphere(void **state)
{
	json_error_t error;
	size_t size;
	double volume = 0;

	(void)state;
	export_it(SMALL " --format gltf " LOBE " --ndf ggx --sigma 0.09 --gaf correlated --fresnel schlick");
	json_t *gltf = json_loads(last.out, JSON_REJECT_DUPLICATES, &error);
	assert_non_null(gltf);
	unsigned char *bytes = gltf_buffer(gltf, &size);
	const json_t *accessors = json_object_get(gltf, "accessors");
	const size_t n = (size_t)member_number(json_array_get(accessors, 0), "count");
	const size_t vertices = (size_t)member_number(json_array_get(accessors, 1), "count");

	assert_int_equal(size, 2 * n + 12 * vertices);
	for (size_t t = 0; t < n; t += 3) {
		struct vec3 v[3];

		for (size_t i = 0; i < 3; i++) {
			uint16_t index;
			float at[3];

			memcpy(&index, bytes + 2 * (t + i), 2);
			assert_true(index < vertices);
			memcpy(at, bytes + 2 * n + (size_t)12 * index, 12);
			v[i] = (struct vec3){(double)at[0], (double)at[1], (double)at[2]};
			check_abs(vec3_length(v[i]), 1, 1e-6, "radius");
		}
		const struct vec3 a = vec3_sub(v[1], v[0]), b = vec3_sub(v[2], v[0]);
		const struct vec3 across = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};

		assert_true(vec3_dot(across, v[0]) > 0);
		volume += vec3_dot(across, v[0]) / 6;
	}
	check_rel(volume, 4 * M_PI / 3, 0.02, "volume");
	assert_int_equal(json_array_size(json_object_get(gltf, "nodes")), 3);
	assert_int_equal(json_array_size(json_object_get(gltf, "cameras")), 1);
	json_decref(gltf);
	free(bytes);
}

/* Where gltf-validator is installed (`make page-tools`, or npm's global packages): no error, warning, information or
 * hint. */
static void gltf_validator_takes_it(void **state)
{
	static const char *const models[] = {
		LOBE " --ndf ggx --sigma 0.09 --ior 40 --gaf correlated --fresnel schlick",
		LOBE " --ndf ggx --sigma 0.3,0.1 --angle 20",
		"--kd 0.31,0.12,0.047",
	};

	(void)state;
	shell("for root in \"$(dirname \"${STDFIT:-build/stdfit}\")/npm/node_modules\" \"$(npm root -g)\"; do "
	      "[ ! -e \"$root/gltf-validator\" ] || { printf %s \"$root\"; exit; }; done; exit 1");
	if (last.code != 0)
		skip_for_want_of("the npm package gltf-validator");
	assert_int_equal(setenv("NODE_PATH", last.out, 1), 0);
	for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
		char arguments[200];

		snprintf(arguments, sizeof arguments, SMALL " --format gltf %s -o v.gltf", models[i]);
		export_it(arguments);
		shell("node -e 'require(\"gltf-validator\").validateBytes(new "
		      "Uint8Array(require(\"fs\").readFileSync(\"v.gltf\")))"
		      ".then(r => console.log(JSON.stringify(r.issues.messages)))'");
		expect_code(0);
		assert_string_equal(last.out, "[]\n");
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gltf_has_a_sphere),
		cmocka_unit_test(gltf_validator_takes_it),
		cmocka_unit_test(mitsuba_says_what_it_can),
		cmocka_unit_test(mitsuba_gets_a_substitute),
		cmocka_unit_test(mitsuba_blends_within_one),
		cmocka_unit_test(xmllint_takes_it),
		cmocka_unit_test(pbrt_says_what_it_can),
		cmocka_unit_test(pbrt_has_colours_in_its_index),
		cmocka_unit_test(gltf_is_fitted_in_its_own_terms),
		cmocka_unit_test(merl_is_the_model),
		cmocka_unit_test(an_index_for_each_channel_is_replaced),
		cmocka_unit_test(json_is_the_model),
		cmocka_unit_test(json_holds_a_table_of_nodes),
		cmocka_unit_test(bad_json_is_reported),
		cmocka_unit_test(escapes_and_big_numbers_are_read),
		cmocka_unit_test(damaged_json_is_read_or_refused),
		cmocka_unit_test(a_fit_and_its_row_export_alike),
		cmocka_unit_test(its_own_fit_looks_right),
		cmocka_unit_test(headers_tell_how_it_looks),
		cmocka_unit_test(refusals_are_one_line),
	};

	return cmocka_run_group_tests(tests, enter_directory, leave_directory);
}
