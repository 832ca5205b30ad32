/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit export --format bsdf and bsdf-rgb: the fields that renderers ask for, the values read back by our reader, the error
 * that is told, and the limits of accuracy and size. Runs $STDFIT or build/stdfit. */
#include "data_readers/regular_file.h"
#include "data_readers/rgl.h"
#include "data_readers/tensor_file.h"
#include "make_table.h"
#include "run_program.h"

/* Of saturated colours, each channel its own. */
#define FACTORS "--kd 0.3,0.02,0 --ks 0.02,0,0.5 "

static const double kd[3] = {0.3, 0.02, 0}, ks[3] = {0.02, 0, 0.5};

static struct cook_torrance given(const char *ndf, double sigma, double gamma)
{
	struct cook_torrance model = make_model(ndf, sigma, gamma, 1.5);

	memcpy(model.kd, kd, sizeof kd);
	memcpy(model.ks, ks, sizeof ks);
	return model;
}

struct loaded {
	unsigned char *bytes;
	size_t size;
	struct tensor_file file;
};

static struct loaded load(const char *path)
{
	struct loaded loaded;
	struct error why = {""};

	if (regular_file_read(path, "a file", 1 << 30, &loaded.bytes, &loaded.size, &why) != STATUS_OK ||
	    tensor_file_parse(loaded.bytes, loaded.size, &loaded.file, &why) != STATUS_OK)
		fail_msg("%s: %s", path, why.text);
	return loaded;
}

static const struct tensor *field(const struct loaded *loaded, const char *name, int type, int dims)
{
	const struct tensor *tensor = tensor_file_find(&loaded->file, name);

	if (!tensor)
		fail_msg("no field %s", name);
	assert_int_equal(tensor->type, type);
	assert_int_equal(tensor->dims, dims);
	return tensor;
}

/* What pbrt-v4 and Mitsuba 3 check before they take a file. */
static void expect_fields(const char *path, const char *colours, uint64_t n_colours)
{
	const struct loaded loaded = load(path);
	const uint64_t n_theta = field(&loaded, "theta_i", TENSOR_FLOAT32, 1)->shape[0];
	const struct tensor *vndf = field(&loaded, "vndf", TENSOR_FLOAT32, 4);
	const struct tensor *luminance = field(&loaded, "luminance", TENSOR_FLOAT32, 4);
	const struct tensor *colour = field(&loaded, colours, TENSOR_FLOAT32, 5);
	float *value;
	struct error why;

	assert_int_equal(field(&loaded, "phi_i", TENSOR_FLOAT32, 1)->shape[0], 1);
	field(&loaded, "ndf", TENSOR_FLOAT32, 2);
	field(&loaded, "sigma", TENSOR_FLOAT32, 2);
	assert_int_equal(field(&loaded, "version", TENSOR_UINT8, 1)->shape[0], 3);
	assert_int_equal(field(&loaded, "jacobian", TENSOR_UINT8, 1)->data[0], 1);
	const struct tensor *text = field(&loaded, "description", TENSOR_UINT8, 1);
	assert_non_null(memmem(text->data, text->count, "std sigma 0.2 gamma 1.7", 23));
	assert_non_null(memmem(text->data, text->count, "error against the model", 23));
	assert_int_equal(vndf->shape[0], 1);
	assert_int_equal(vndf->shape[1], n_theta);
	assert_int_equal(luminance->shape[0], 1);
	assert_int_equal(luminance->shape[1], n_theta);
	assert_int_equal(colour->shape[0], 1);
	assert_int_equal(colour->shape[1], n_theta);
	assert_int_equal(colour->shape[2], n_colours);
	assert_int_equal(colour->shape[3], luminance->shape[2]);
	assert_int_equal(colour->shape[4], luminance->shape[3]);
	assert_int_equal(colour->shape[3], colour->shape[4]);
	assert_true(((uintptr_t)colour->data - (uintptr_t)loaded.bytes) % sizeof(float) == 0);
	/* pbrt-v4 sets what is negative to 0. */
	assert_int_equal(tensor_floats(colour, &value, &why), STATUS_OK);
	for (size_t n = 0; n < colour->count; n++)
		if (!((double)value[n] >= 0))
			fail_msg("%s: value %zu is %g", path, n, (double)value[n]);
	free(value);
	free(loaded.bytes);
}

/* At the nodes the values are the model's, in every channel. */
static void expect_entries(const char *path, const struct cook_torrance *model)
{
	struct measurement m;
	struct error error = {""};

	if (rgl_read(path, GAMUT_CLIP, &m, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	assert_true(m.scattered->n > 500);
	for (size_t n = 0; n < m.scattered->n; n++) {
		double f[3];

		cook_torrance_f(model, m.scattered->wi[n], m.scattered->wo[n], f);
		for (int c = 0; c < 3; c++)
			check_abs((double)m.scattered->value[c][n], f[c], 1e-4 * (f[0] + f[1] + f[2]), "entry");
	}
	measurement_free(&m);
}

/* The L1 distance between the file and the model, weighted by cosines, in percent, over directions that are drawn. */
static double error_of(const char *path, const struct cook_torrance *model)
{
	const struct loaded loaded = load(path);
	unsigned seed = 5;
	double difference = 0, norm = 0;
	struct rgl *rgl;
	struct error why = {""};

	if (rgl_parse(loaded.bytes, loaded.size, &rgl, &why) != STATUS_OK)
		fail_msg("%s", why.text);
	for (int n = 0; n < 100000; n++) {
		/* cos dw is even over the disc. */
		double f[3], g[3] = {0};
		struct vec3 w[2];

		for (int i = 0; i < 2; i++) {
			const double r = sqrt(random_unit(&seed)), phi = 2 * M_PI * random_unit(&seed);

			w[i] = (struct vec3){r * cos(phi), r * sin(phi), sqrt(fmax(0, 1 - r * r))};
		}
		if (!rgl_f(rgl, w[0], w[1], g))
			continue;
		cook_torrance_f(model, w[0], w[1], f);
		for (int c = 0; c < 3; c++) {
			difference += fabs(f[c] - g[c]);
			norm += f[c];
		}
	}
	rgl_free(rgl);
	free(loaded.bytes);
	return 100 * difference / norm;
}

static double stated(const char *text)
{
	const char *words = "error against the model ", *at = strstr(text, words);

	if (!at)
		fail_msg("no error in %s", text);
	return strtod(at + strlen(words), NULL);
}

static void colours_and_spectra_are_the_model(void **state)
{
	const struct cook_torrance model = given("std", 0.2, 1.7);
	(void)state;

	stdfit("export --format bsdf-rgb -o rgb.bsdf --accuracy 2 --threads 1 " FACTORS "--sigma 0.2 --gamma 1.7");
	expect_code(0);
	const double told = stated(last.err);
	assert_null(strstr(last.err, "the least of this size"));
	expect_fields("rgb.bsdf", "rgb", 3);
	expect_entries("rgb.bsdf", &model);
	check_between(told, 0.02, 2, "the error");
	check_rel(error_of("rgb.bsdf", &model), told, 0.15, "the error that is told");

	stdfit("export --format bsdf -o spectra.bsdf --accuracy 2 --threads 1 " FACTORS "--sigma 0.2 --gamma 1.7");
	expect_code(0);
	expect_fields("spectra.bsdf", "spectra", 6);
	expect_entries("spectra.bsdf", &model);
	check_rel(error_of("spectra.bsdf", &model), told, 0.15, "the error of spectra");
}

static void every_model_is_within_the_accuracy(void **state)
{
	static const struct {
		const char *options, *ndf;
		double sigma, gamma;
		enum gaf gaf;
		enum fresnel fresnel;
	} models[] = {
		{"--sigma 0.02 --gamma 1.6", "std", 0.02, 1.6, GAF_UNCORRELATED, FRESNEL_DIELECTRIC},
		{"--ndf ggx --sigma 0.4 --gaf correlated --fresnel schlick", "ggx", 0.4, 2, GAF_CORRELATED,
		 FRESNEL_SCHLICK},
		{"--ndf beckmann --sigma 0.1 --gaf v-groove --fresnel none", "beckmann", 0.1, 0, GAF_V_GROOVE,
		 FRESNEL_NONE},
		{"--ndf hyper-cauchy --sigma 0.3 --gamma 2", "hyper-cauchy", 0.3, 2, GAF_UNCORRELATED,
		 FRESNEL_DIELECTRIC},
	};
	(void)state;

	for (size_t n = 0; n < sizeof models / sizeof *models; n++) {
		struct cook_torrance model = given(models[n].ndf, models[n].sigma, models[n].gamma);
		char *command;

		model.gaf = models[n].gaf;
		model.fresnel = models[n].fresnel;
		assert_true(asprintf(&command,
				     "export --format bsdf-rgb -o m.bsdf --accuracy 5 --threads 1 " FACTORS "%s",
				     models[n].options) > 0);
		stdfit(command);
		free(command);
		expect_code(0);
		check_between(stated(last.err), 0, 5, models[n].options);
		expect_entries("m.bsdf", &model);
	}
}

static void size_is_a_limit(void **state)
{
	const char *file =
		"export --format bsdf -o s.bsdf --threads 1 --kd 0.2 --ks 0.3 --sigma 0.2 --gamma 1.7 --size ";
	char *command;
	struct stat st;
	(void)state;

	assert_true(asprintf(&command, "%s100000", file) > 0);
	stdfit(command);
	free(command);
	expect_code(0);
	assert_int_equal(stat("s.bsdf", &st), 0);
	check_between((double)st.st_size, 50000, 100000, "size");
	assert_true(stated(last.err) > 0.2);
	assert_non_null(strstr(last.err, "the least of this size"));
	assert_true(asprintf(&command, "%s20000", file) > 0);
	stdfit(command);
	free(command);
	expect_error(1, "the smallest file has");
	stdfit("export --format bsdf --kd 0.2");
	expect_error(2, "needs -o FILE");
}

static void a_matt_model_is_written(void **state)
{
	struct cook_torrance model = given("std", 0.2, 1.7);
	(void)state;

	stdfit("export --format bsdf -o matt.bsdf --accuracy 3 --threads 1 --kd 0.3,0.02,0");
	expect_code(0);
	memset(model.ks, 0, sizeof model.ks);
	expect_entries("matt.bsdf", &model);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(colours_and_spectra_are_the_model),
		cmocka_unit_test(every_model_is_within_the_accuracy),
		cmocka_unit_test(size_is_a_limit),
		cmocka_unit_test(a_matt_model_is_written),
	};
	return cmocka_run_group_tests(tests, enter_directory, leave_directory);
}
