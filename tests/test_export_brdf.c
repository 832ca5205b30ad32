/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The GLSL of BRDF Explorer files, run: the same values as cook_torrance_f() for every NDF, G, F and form of Lambda, in
 * double and in float arithmetic, at the defaults of the sliders and where they are moved to; and glslangValidator takes it
 * inside the uniforms of BRDF Explorer, where that is installed. */
#include "check.h"
#include "fit/export/export.h"
#include "glsl.h"
#include "make_table.h"
#include "src/pwl.h"

#include <unistd.h>

/* What the header of an export promises: the formulas in double arithmetic, relative; and in float, relative, growing
 * with the depth of the tail. */
#define TOLERANCE_DOUBLE 2e-7
#define TOLERANCE_FLOAT 3e-6
#define TOLERANCE_TAIL 3e-6

static char *export_text(const struct cook_torrance *model)
{
	const struct fit_options fit = fit_options_default();
	const struct export_source source = {.model = model, .fit = &fit, .error = NAN, .material = "a-b"};
	struct export export;
	struct error error = {""};
	char *text = NULL;
	size_t size;
	FILE *file = open_memstream(&text, &size);

	assert_non_null(file);
	if (export_prepare(&export, EXPORT_BRDF, &source, &error) || export_write(&export, file, &error))
		fail_msg("%s", error.text);
	assert_false(export.substitute);
	assert_int_equal(fclose(file), 0);
	return text;
}

/* The text between the lines ::begin NAME and ::end NAME, newly allocated. */
static char *section(const char *text, const char *name)
{
	char begin[64], end[64];

	snprintf(begin, sizeof begin, "\n::begin %s\n", name);
	snprintf(end, sizeof end, "\n::end %s\n", name);
	const char *from = strstr(text, begin), *to = strstr(text, end);
	if (!from || !to)
		fail_msg("no section '%s'", name);
	from += strlen(begin);
	return strndup(from, (size_t)(to - from) + 1);
}

/* A parameter of a file, as BRDF Explorer reads its line. */
struct parameter {
	char name[32];
	bool is_float;
	double min, max, value;
};

/* The next one; NULL when there is none. BRDF Explorer shows six digits of a float, and takes the value from there. */
static const char *next_parameter(const char *at, struct parameter *parameter)
{
	char shown[32];
	int used, on;

	if (sscanf(at, "bool %31s %d\n%n", parameter->name, &on, &used) == 2) {
		parameter->is_float = false;
		parameter->value = on;
		return at + used;
	}
	if (sscanf(at, "float %31s %lf %lf %lf\n%n", parameter->name, &parameter->min, &parameter->max,
		   &parameter->value, &used) != 4) {
		assert_string_equal(at, "");
		return NULL;
	}
	assert_true(parameter->min < parameter->max);
	check_between(parameter->value, parameter->min, parameter->max, parameter->name);
	parameter->is_float = true;
	snprintf(shown, sizeof shown, "%g", parameter->value);
	parameter->value = strtod(shown, NULL);
	return at + used;
}

/* Where sliders are moved to; an empty name ends the list. */
struct move {
	const char *name;
	double to;
};

/* The shader of an export, with its parameters as uniforms at their defaults, but for those of `moves` (may be NULL), each
 * of which the file has to have. */
static struct glsl *open_shader(const char *text, bool rounds, const struct move *moves)
{
	char *parameters = section(text, "parameters"), *shader = section(text, "shader");
	struct glsl *glsl = glsl_open(shader, rounds);
	struct parameter parameter;
	int n_moved = 0, n_moves = 0;

	for (const char *at = parameters; (at = next_parameter(at, &parameter));) {
		double value = parameter.value;
		for (n_moves = 0; moves && *moves[n_moves].name; n_moves++)
			if (!strcmp(moves[n_moves].name, parameter.name)) {
				check_between(moves[n_moves].to, parameter.min, parameter.max, parameter.name);
				value = moves[n_moves].to;
				n_moved++;
			}
		glsl_declare(glsl, parameter.name, parameter.is_float ? glsl_float(glsl, value) : glsl_bool(value > 0),
			     true);
	}
	assert_int_equal(n_moved, n_moves);
	glsl_parse(glsl);
	free(parameters);
	free(shader);
	return glsl;
}

static struct glsl_value vector(struct vec3 v)
{
	return (struct glsl_value){.type = GLSL_VEC3, .v = {v.x, v.y, v.z}};
}

static struct vec3 as_floats(struct vec3 v)
{
	return (struct vec3){glsl_to_float(v.x), glsl_to_float(v.y), glsl_to_float(v.z)};
}

static void shader_f(struct glsl *glsl, struct vec3 wi, struct vec3 wo, double f[3])
{
	const struct glsl_value argument[] = {vector(wi), vector(wo), vector((struct vec3){0, 0, 1}),
					      vector((struct vec3){1, 0, 0}), vector((struct vec3){0, 1, 0})};
	const struct glsl_value value = glsl_function(glsl, "BRDF", argument, 5);

	assert_int_equal(value.type, GLSL_VEC3);
	memcpy(f, value.v, sizeof value.v);
}

static struct vec3 direction(double theta, double phi)
{
	return (struct vec3){sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
}

/* Pairs of directions: around the mirror direction, anywhere, grazing, along the normal. */
static void pick(int i, double sigma, unsigned *seed, struct vec3 *wi, struct vec3 *wo)
{
	const double theta = i % 4 ? 1.5 * random_unit(seed) : 1.5707963267 - exp(-12 * random_unit(seed));
	const double spread = i % 2 ? sigma * 4 : 3;

	*wi = i % 16 == 7 ? (struct vec3){0, 0, 1} : direction(theta, 6.28 * random_unit(seed));
	const struct vec3 mirror = {-wi->x, -wi->y, wi->z};
	struct vec3 off;
	off.x = spread * (random_unit(seed) - 0.5);
	off.y = spread * (random_unit(seed) - 0.5);
	off.z = spread * (random_unit(seed) - 0.5);
	*wo = vec3_unit(vec3_add(mirror, off));
	if (wo->z <= 0)
		wo->z = -wo->z + 1e-9;
	*wo = vec3_unit(*wo);
}

enum { PAIRS = 48 };

/* The file of one model, with sliders moved, is another. */
static void compare_moved(const struct cook_torrance *from, const struct move *moves, const struct cook_torrance *model,
			  const char *what)
{
	char *text = export_text(from), label[200];
	struct glsl *exact = open_shader(text, false, moves), *rounded = open_shader(text, true, moves);
	const double D0 = ndf_D(&model->ndf, (struct vec3){0, 0, 1});
	unsigned seed = 7;

	assert_memory_equal(text, "analytic\n# exact: ", 18);
	for (int i = 0; i < PAIRS; i++) {
		struct vec3 wi, wo;
		double want[3], got[3];

		pick(i, model->ndf.class == ndf_find("pl") ? 0.2 : model->ndf.sigma_x, &seed, &wi, &wo);
		snprintf(label, sizeof label, "%s, pair %d", what, i);
		cook_torrance_f(model, wi, wo, want);
		shader_f(exact, wi, wo, got);
		for (int c = 0; c < 3; c++)
			check_rel(got[c], want[c], TOLERANCE_DOUBLE, label);

		wi = as_floats(wi);
		wo = as_floats(wo);
		cook_torrance_f(model, wi, wo, want);
		shader_f(rounded, wi, wo, got);
		const double D = ndf_D(&model->ndf, vec3_unit(vec3_add(wi, wo)));
		const double tail = D > 0 && D0 > 0 ? fabs(log(D / D0)) : 0;
		for (int c = 0; c < 3; c++)
			check_rel(got[c], want[c], TOLERANCE_FLOAT + TOLERANCE_TAIL * tail, label);
	}
	glsl_free(exact);
	glsl_free(rounded);
	free(text);
}

static void compare(const struct cook_torrance *model, const char *what)
{
	compare_moved(model, NULL, model, what);
}

/* Values of a model below a float's range, far out in a Gaussian tail, are lost: kd is there to stay above. */
static struct cook_torrance model_of(const struct ndf *ndf)
{
	return (struct cook_torrance){.ndf = *ndf,
				      .gaf = GAF_UNCORRELATED,
				      .fresnel = FRESNEL_DIELECTRIC,
				      .n = 1.48,
				      .k = 2.3,
				      .kd = {0.31, 0.12, 0.047},
				      .ks = {0.42, 0.63, 0.77}};
}

static const struct {
	const char *ndf;
	double sigma, gamma;
} shapes[] = {
	{"ggx", 0.013, 2},           {"ggx", 0.7, 2},        {"beckmann", 0.021, INFINITY},
	{"beckmann", 1.3, INFINITY}, {"std", 0.31, 1.5001},  {"std", 0.09, 1.61},
	{"std", 0.002, 1.8},         {"std", 0.4, 2},        {"std", 1.9, 2.4},
	{"std", 0.15, 7.7},          {"std", 0.3, 40},       {"std", 0.2, 1000},
	{"std", 0.11, INFINITY},     {"gtr", 0.17, 1.3},     {"gtr", 0.05, 2.9},
	{"gtr", 1.7, 0.6},           {"gtr", 0.3, 1},        {"hyper-cauchy", 0.2, 2},
	{"hyper-cauchy", 0.14, 1.8}, {"t-family", 0.2, 3.1}, {"low", 0.23, 1.2},
	{"low", 0.03, 0.4},          {"low", 0.1, 900},
};

static void shader_is_the_model_for_every_shape(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
		struct ndf ndf;
		char label[100];

		assert_int_equal(
			ndf_init(&ndf, ndf_find(shapes[i].ndf), shapes[i].sigma, shapes[i].sigma, shapes[i].gamma), 0);
		snprintf(label, sizeof label, "%s %g %g", shapes[i].ndf, shapes[i].sigma, shapes[i].gamma);
		const struct cook_torrance model = model_of(&ndf);
		compare(&model, label);
	}
}

static void make_pwl(struct pwl *pwl)
{
	double theta[94], D[94];

	for (int i = 0; i < 94; i++) {
		theta[i] = i < 93 ? M_PI_2 * i * i / (93.0 * 93) : M_PI_2;
		D[i] = exp(-theta[i] / 0.1) + 0.01 * (1 + sin(40 * theta[i]));
	}
	assert_int_equal(pwl_init(pwl, 94, theta, D, NULL), STATUS_OK);
}

/* One shape of each NDF, with every G and F. */
static void shader_is_the_model_for_every_G_and_F(void **state)
{
	static const struct {
		const char *ndf;
		double gamma;
	} kinds[] = {{"ggx", 2},        {"beckmann", INFINITY}, {"std", 1.7}, {"gtr", 1.6}, {"hyper-cauchy", 2.3},
		     {"t-family", 2.7}, {"low", 1.4},           {"pl", 0}};
	struct pwl pwl;

	(void)state;
	make_pwl(&pwl);
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		for (enum gaf gaf = 0; gaf < GAF_COUNT; gaf++)
			for (enum fresnel fresnel = 0; fresnel < FRESNEL_F82; fresnel++) {
				struct ndf ndf;
				char label[100];

				if (!strcmp(kinds[i].ndf, "pl"))
					ndf_from_pwl(&ndf, &pwl);
				else
					assert_int_equal(
						ndf_init(&ndf, ndf_find(kinds[i].ndf), 0.2, 0.2, kinds[i].gamma), 0);
				struct cook_torrance model = model_of(&ndf);
				model.gaf = gaf;
				model.fresnel = fresnel;
				snprintf(label, sizeof label, "%s, %s, %s", kinds[i].ndf, gaf_name(gaf),
					 fresnel_name(fresnel));
				compare(&model, label);
			}
	pwl_free(&pwl);
}

static void shader_is_the_model_for_every_form_of_Lambda(void **state)
{
	static const struct {
		enum lambda_form form;
		double gamma;
	} forms[] = {{LAMBDA_2F1, 1.9},     {LAMBDA_INTEGER, 3},  {LAMBDA_HALF_INTEGER, 4.5}, {LAMBDA_RATIONAL, 1.6},
		     {LAMBDA_RATIONAL, 40}, {LAMBDA_RATIONAL, 2}, {LAMBDA_RATIONAL, INFINITY}};

	(void)state;
	for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
		struct ndf ndf;
		char label[100];

		assert_int_equal(ndf_init(&ndf, ndf_find("std"), 0.3, 0.3, forms[i].gamma), STATUS_OK);
		assert_int_equal(ndf_set_lambda_form(&ndf, forms[i].form), STATUS_OK);
		const struct cook_torrance model = model_of(&ndf);
		snprintf(label, sizeof label, "%s of gamma %g", lambda_form_name(forms[i].form), forms[i].gamma);
		compare(&model, label);
	}
}

static void shader_is_the_model_with_axes(void **state)
{
	static const struct {
		const char *ndf;
		double sigma_x, sigma_y, gamma, angle;
	} axes[] = {{"ggx", 0.3, 0.1, 2, 20},
		    {"ggx", 0.1, 0.3, 2, 20},
		    {"std", 0.05, 0.2, 1.7, -65},
		    {"std", 0.4, 0.2, 5, 90},
		    {"beckmann", 0.5, 0.3, INFINITY, 1e-40},
		    {"hyper-cauchy", 0.3, 0.2, 2.3, 45}};

	(void)state;
	for (size_t i = 0; i < sizeof axes / sizeof *axes; i++)
		for (enum gaf gaf = 0; gaf < GAF_COUNT; gaf++) {
			struct ndf ndf;
			char label[100];

			assert_int_equal(
				ndf_init(&ndf, ndf_find(axes[i].ndf), axes[i].sigma_x, axes[i].sigma_y, axes[i].gamma),
				STATUS_OK);
			assert_int_equal(ndf_turn(&ndf, axes[i].angle), STATUS_OK);
			struct cook_torrance model = model_of(&ndf);
			model.gaf = gaf;
			snprintf(label, sizeof label, "%s, %s, axes at %g", axes[i].ndf, gaf_name(gaf), axes[i].angle);
			compare(&model, label);
		}
}

static void shader_is_the_model_for_indices_near_1_and_far(void **state)
{
	static const double n[] = {1.0001, 1.01, 3, 38.575, 100, 0.04, 0.6}, k[] = {0, 1e-3, 0.5, 8, 100};

	(void)state;
	for (int i = 0; i < 7; i++)
		for (int j = i < 5 ? 0 : 1; j < 5; j++) {
			struct cook_torrance model = make_model("ggx", 0.4, 2, n[i]);
			char label[100];

			model.fresnel = j ? FRESNEL_CONDUCTOR : FRESNEL_DIELECTRIC;
			model.k = k[j];
			snprintf(label, sizeof label, "n %g, k %g", n[i], k[j]);
			compare(&model, label);
		}
}

static void shader_is_the_model_with_one_term_only(void **state)
{
	struct cook_torrance model = make_model("std", 0.2, 1.8, 1.5);

	(void)state;
	memset(model.ks, 0, sizeof model.ks);
	compare(&model, "no lobe");
	model = make_model("ggx", 0.6, 2, 1.5);
	memset(model.kd, 0, sizeof model.kd);
	compare(&model, "no diffuse term");
}

static struct cook_torrance shaped(const char *ndf, double sigma, double gamma)
{
	struct ndf shape;

	assert_int_equal(ndf_init(&shape, ndf_find(ndf), sigma, sigma, gamma), STATUS_OK);
	return model_of(&shape);
}

/* Every slider, each alone and all at once. gamma_shape from GGX to sharper and to longer tails. */
static void sliders_give_the_other_model(void **state)
{
	static const struct {
		const char *ndf;
		double sigma, gamma, to_sigma, to_gamma;
	} shapes_moved[] = {
		{"std", 0.1234567891, 1.8, 0.31, 2.7},
		{"std", 0.02, 2, 0.5, 1.56},
		{"std", 0.2, 9.5, 0.11, 4},
		{"std", 0.3, 1.7, 0.2, 2},
		{"hyper-cauchy", 0.2, 2.3, 0.4, 3.1},
		{"t-family", 0.2, 3.1, 0.3, 2.4},
	};

	(void)state;
	for (size_t i = 0; i < sizeof shapes_moved / sizeof *shapes_moved; i++) {
		const char *ndf = shapes_moved[i].ndf;
		const double sigma = shapes_moved[i].to_sigma, gamma = shapes_moved[i].to_gamma;
		const struct cook_torrance from = shaped(ndf, shapes_moved[i].sigma, shapes_moved[i].gamma);
		struct cook_torrance to = shaped(ndf, sigma, from.ndf.gamma);
		compare_moved(&from, (struct move[]){{"sigma", sigma}, {"", 0}}, &to, "sigma moved");
		to = shaped(ndf, from.ndf.sigma_x, gamma);
		compare_moved(&from, (struct move[]){{"gamma_shape", gamma}, {"", 0}}, &to, "gamma moved");
		to = shaped(ndf, sigma, gamma);
		to.n = 1.7;
		to.kd[1] = 0.3;
		to.ks[2] = 0.11;
		compare_moved(&from,
			      (struct move[]){{"sigma", sigma},
					      {"gamma_shape", gamma},
					      {"n", 1.7},
					      {"kd_g", 0.3},
					      {"ks_b", 0.11},
					      {"", 0}},
			      &to, "all moved");
	}
	struct cook_torrance from = shaped("ggx", 0.2, 2), to = shaped("ggx", 0.35, 2);
	compare_moved(&from, (struct move[]){{"sigma", 0.35}, {"", 0}}, &to, "ggx moved");
	from = shaped("beckmann", 0.2, INFINITY);
	to = shaped("beckmann", 0.35, INFINITY);
	compare_moved(&from, (struct move[]){{"sigma", 0.35}, {"", 0}}, &to, "beckmann moved");
	for (enum fresnel fresnel = FRESNEL_SCHLICK; fresnel <= FRESNEL_CONDUCTOR; fresnel++) {
		from = shaped("gtr", 0.2, 1.4);
		from.fresnel = fresnel;
		to = from;
		to.n = 2.25;
		to.k = fresnel == FRESNEL_CONDUCTOR ? 1.5 : to.k;
		compare_moved(&from,
			      (struct move[]){{"n", 2.25}, {fresnel == FRESNEL_CONDUCTOR ? "k" : "", 1.5}, {"", 0}},
			      &to, "index moved");
	}
	from = to = shaped("ggx", 0.2, 2);
	assert_int_equal(ndf_init(&from.ndf, from.ndf.class, 0.2, 0.5, 2), STATUS_OK);
	assert_int_equal(ndf_init(&to.ndf, to.ndf.class, 0.3, 0.4, 2), STATUS_OK);
	compare_moved(&from, (struct move[]){{"sigma_x", 0.3}, {"sigma_y", 0.4}, {"", 0}}, &to, "axes moved");
}

/* A slider reaches the value, whatever that is. */
static void ranges_hold_the_value(void **state)
{
	struct cook_torrance model = shaped("std", 5e-5, 1200);

	(void)state;
	model.n = 120;
	model.kd[0] = 3;
	compare(&model, "values beyond the usual");
}

/* Three reflectances for F, a diffuse term of grazing directions, two lobes; each channel of its own. */
static struct cook_torrance rich_model(const char *ndf, double gamma)
{
	struct cook_torrance model = shaped(ndf, 0.2, gamma);
	static const double reflectance[3][F82_PARTS] = {{0.2, 0.3, 0.9}, {0.6, 0.4, 1}, {0.04, 0.05, 0.3}};

	model.fresnel = FRESNEL_F82;
	memcpy(model.reflectance, reflectance, sizeof reflectance);
	memcpy(model.kg, (double[]){0.2, 0.05, 0.4}, sizeof model.kg);
	model.grazing = 3.7;
	memcpy(model.ks_second, (double[]){0.3, 0.8, 0.1}, sizeof model.ks_second);
	assert_int_equal(ndf_init(&model.second, model.ndf.class, 0.37, 0.37, gamma > 2 ? 2.2 : gamma + 0.2),
			 STATUS_OK);
	return model;
}

static void shader_is_the_model_of_more_terms(void **state)
{
	static const struct {
		const char *ndf;
		double gamma;
	} lobes[] = {{"ggx", 2}, {"beckmann", INFINITY}, {"std", 1.7}, {"std", 3}, {"gtr", 2.4}, {"low", 1.5}};

	(void)state;
	for (size_t i = 0; i < sizeof lobes / sizeof *lobes; i++) {
		struct cook_torrance model = rich_model(lobes[i].ndf, lobes[i].gamma);
		compare(&model, lobes[i].ndf);
		model.gaf = GAF_V_GROOVE;
		model.fresnel = FRESNEL_DIELECTRIC;
		memset(model.kg, 0, sizeof model.kg);
		compare(&model, lobes[i].ndf);
		memset(model.ks, 0, sizeof model.ks);
		compare(&model, "the second lobe alone");
	}
	/* The second one may have axes of its own. */
	struct cook_torrance model = rich_model("ggx", 2);
	if (ndf_init(&model.second, model.ndf.class, 0.4, 0.2, 2) || ndf_turn(&model.second, 20))
		abort();
	compare(&model, "a second lobe with axes");
}

static void sliders_give_another_model_of_more_terms(void **state)
{
	const struct cook_torrance from = rich_model("std", 1.7);
	struct cook_torrance to = from;

	(void)state;
	to.reflectance[0][0] = 0.5;
	to.reflectance[1][1] = 0.1;
	to.reflectance[2][2] = 0.9;
	to.kg[1] = 0.6;
	to.grazing = 5;
	to.ks_second[2] = 0.7;
	assert_int_equal(ndf_init(&to.second, to.ndf.class, 0.5, 0.5, 2.5), STATUS_OK);
	compare_moved(&from,
		      (struct move[]){{"f0_r", 0.5},
				      {"f82_g", 0.1},
				      {"f90_b", 0.9},
				      {"kg_g", 0.6},
				      {"exponent", 5},
				      {"ks2_b", 0.7},
				      {"sigma2", 0.5},
				      {"gamma2", 2.5},
				      {"", 0}},
		      &to, "moved");
}

/* Constants that no float holds are refused, and nothing promised. */
static void out_of_range_is_refused(void **state)
{
	const struct fit_options fit = fit_options_default();
	struct cook_torrance model = make_model("ggx", 1e-44, 2, 1.5);
	const struct export_source source = {.model = &model, .fit = &fit, .error = NAN};
	struct export export;
	struct error error = {""};
	FILE *file = fopen("/dev/null", "w");

	(void)state;
	assert_int_equal(export_prepare(&export, EXPORT_BRDF, &source, &error), STATUS_OK);
	assert_int_equal(export_write(&export, file, &error), STATUS_UNSUPPORTED);
	assert_non_null(strstr(error.text, "out of the range"));
	fclose(file);
}

/* The shader as BRDF Explorer wraps it: uniforms before it, its own among them, and a main() behind it. */
static void write_fragment_shader(const char *path, const char *text)
{
	static const char *const own[] = {
		"vec3 incidentVector", "float incidentTheta", "float incidentPhi",   "float brightness",
		"float gamma",         "float exposure",      "float useNDotL",      "int totalSamples",
		"float phiD",          "float thetaH",        "float thetaD",        "float useLogPlot",
		"vec3 colorMask",      "vec3 drawColor",      "float renderWithIBL", "float thickness",
		"int nSamples",        "int samplingMode",    "float phiV",          "int stepSize"};
	char *parameters = section(text, "parameters"), *shader = section(text, "shader");
	FILE *file = fopen(path, "w");
	struct parameter parameter;

	assert_non_null(file);
	fprintf(file, "#version 410\nin vec3 L;\nin vec3 V;\nout vec4 color;\n");
	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		fprintf(file, "uniform %s;\n", own[i]);
	for (const char *at = parameters; (at = next_parameter(at, &parameter));)
		fprintf(file, "uniform %s %s;\n", parameter.is_float ? "float" : "bool", parameter.name);
	fprintf(file,
		"%s\nvoid main()\n{\n\tcolor = vec4(BRDF(L, V, vec3(0, 0, 1), vec3(1, 0, 0), vec3(0, 1, 0)), 1);\n}\n",
		shader);
	assert_int_equal(fclose(file), 0);
	free(parameters);
	free(shader);
}

static void glslang_takes_it(void **state)
{
	static const char *const names[] = {"ggx", "beckmann", "std", "gtr", "low"};
	char path[64] = "/tmp/stdfit-glsl-XXXXXX.frag", command[200];

	(void)state;
	if (system("command -v glslangValidator >/dev/null") != 0)
		skip_for_want_of("glslang-tools");
	const int fd = mkstemps(path, 5);
	assert_true(fd >= 0);
	close(fd);
	snprintf(command, sizeof command, "glslangValidator -S frag %s >%s.out", path, path);
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		for (enum fresnel fresnel = 0; fresnel < FRESNEL_F82; fresnel++) {
			struct cook_torrance model = make_model(names[i], 0.2, 1.7, 1.5);
			model.fresnel = fresnel;
			model.gaf = (enum gaf)(fresnel % GAF_COUNT);
			char *text = export_text(&model);
			write_fragment_shader(path, text);
			free(text);
			if (system(command) != 0)
				fail_msg("glslangValidator refuses %s", names[i]);
		}
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		const struct cook_torrance rich = rich_model(names[i], 1.7);
		char *rich_text = export_text(&rich);
		write_fragment_shader(path, rich_text);
		free(rich_text);
		if (system(command) != 0)
			fail_msg("glslangValidator refuses a model of more terms, %s", names[i]);
	}
	struct pwl pwl;
	struct cook_torrance model = make_model("ggx", 0.2, 2, 1.5);
	make_pwl(&pwl);
	ndf_from_pwl(&model.ndf, &pwl);
	char *text = export_text(&model);
	write_fragment_shader(path, text);
	free(text);
	pwl_free(&pwl);
	if (system(command) != 0)
		fail_msg("glslangValidator refuses pl");
	unlink(path);
	strcat(path, ".out");
	unlink(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shader_is_the_model_for_every_shape),
		cmocka_unit_test(shader_is_the_model_for_every_G_and_F),
		cmocka_unit_test(shader_is_the_model_for_every_form_of_Lambda),
		cmocka_unit_test(shader_is_the_model_with_axes),
		cmocka_unit_test(shader_is_the_model_for_indices_near_1_and_far),
		cmocka_unit_test(shader_is_the_model_with_one_term_only),
		cmocka_unit_test(sliders_give_the_other_model),
		cmocka_unit_test(ranges_hold_the_value),
		cmocka_unit_test(shader_is_the_model_of_more_terms),
		cmocka_unit_test(sliders_give_another_model_of_more_terms),
		cmocka_unit_test(out_of_range_is_refused),
		cmocka_unit_test(glslang_takes_it),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
