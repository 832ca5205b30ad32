/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reader of RGL files, on files of known BRDFs. */
#include "check.h"
#include "data_readers/rgl.h"
#include "data_readers/spectrum.h"
#include "rgl_file.h"
#include <float.h>
#include <sys/mman.h>
#include <unistd.h>

static const double pi = 3.14159265358979323846;

/* Smooth, reciprocal, and the same for mirrored directions; coloured. */
static double smooth(struct vec3 wi, struct vec3 wo, int channel)
{
	const struct vec3 h = vec3_unit(vec3_add(wi, wo));

	return 0.1 * (channel + 1) + 0.3 * h.z * h.z + 0.2 * vec3_dot(wi, h);
}

/* Depends on the azimuth; equal to its mirror images in both planes. */
static double brushed(struct vec3 wi, struct vec3 wo, int channel)
{
	const struct vec3 h = vec3_unit(vec3_add(wi, wo));

	return 0.2 + 0.1 * channel + 0.5 * h.x * h.x + 0.2 * wi.y * wi.y * wo.z;
}

/* The same after half a turn, without a mirror plane. */
static double twisted(struct vec3 wi, struct vec3 wo, int channel)
{
	const struct vec3 h = vec3_unit(vec3_add(wi, wo));

	return 1 + 0.1 * channel + h.x * h.y + 0.3 * wi.x * wi.y;
}

static double rising_spectrum(struct vec3 wi, struct vec3 wo, int channel)
{
	return smooth(wi, wo, 0) * (0.2 + 0.05 * channel);
}

static const struct rgl_spec isotropic = {1, 9, 33, 3, 0, 0, 1.5, false, true, smooth};

static enum status read_bytes(const struct rgl_bytes *file, struct measurement *measurement, struct error *error)
{
	const int fd = memfd_create("rgl", MFD_CLOEXEC);
	char path[64];

	assert_true(fd >= 0 && write(fd, file->bytes, file->size) == (ssize_t)file->size);
	snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
	const enum status status = rgl_read(path, GAMUT_MASK, measurement, error);
	close(fd);
	return status;
}

static void read_spec(const struct rgl_spec *spec, struct measurement *measurement)
{
	struct rgl_bytes file = rgl_make(spec);
	struct error error = {""};

	if (read_bytes(&file, measurement, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	free(file.bytes);
}

/* Every entry has the value of the BRDF at its directions. */
static void check_entries(const struct rgl_spec *spec, double tolerance)
{
	struct measurement m;
	read_spec(spec, &m);
	const struct scattered *s = m.scattered;
	assert_true(s->n > 1000);
	for (size_t n = 0; n < s->n; n++) {
		check_abs(vec3_length(s->wi[n]), 1, 1e-12, "length of wi");
		check_abs(vec3_length(s->wo[n]), 1, 1e-12, "length of wo");
		/* Stored is f cos: a direction that is off by d changes f by d/cos. */
		for (int c = 0; c < 3; c++)
			check_abs((double)s->value[c][n], spec->f(s->wi[n], s->wo[n], c), tolerance / s->wo[n].z,
				  "entry");
	}
	measurement_free(&m);
}

static void entries_of_an_isotropic_file_have_the_values_of_its_BRDF(void **state)
{
	(void)state;
	check_entries(&isotropic, 2e-6);
}

static void entries_of_an_anisotropic_file_have_the_values_of_its_BRDF(void **state)
{
	(void)state;
	const struct rgl_spec spec = {9, 6, 17, 3, -pi, pi, 1.5, false, true, twisted};
	check_entries(&spec, 2e-6);
}

static void a_file_that_is_not_divided_by_its_distribution_gives_the_same_BRDF(void **state)
{
	(void)state;
	struct rgl_spec spec = isotropic;
	spec.divided = false;
	check_entries(&spec, 2e-6);
}

static struct vec3 direction(double theta, double phi)
{
	return (struct vec3){sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
}

/* The mean relative error of the interpolant between nodes, at any azimuth of incidence. */
static double interpolant_error(const struct rgl_spec *spec)
{
	struct measurement m;
	double sum = 0;
	read_spec(spec, &m);
	for (int n = 0; n < 500; n++) {
		const struct vec3 wi = direction(1.2 * fmod(n * 0.618, 1), 6.28 * fmod(n * 0.414, 1));
		const struct vec3 wo = direction(1.2 * fmod(n * 0.732, 1), 6.28 * fmod(n * 0.236, 1));
		double f[3];
		assert_true(rgl_f(m.rgl, wi, wo, f));
		for (int c = 0; c < 3; c++)
			sum += fabs(f[c] / spec->f(wi, wo, c) - 1) / 1500;
	}
	measurement_free(&m);
	return sum;
}

static void between_nodes_the_interpolant_converges_to_the_BRDF(void **state)
{
	(void)state;
	const struct rgl_spec coarse = {1, 13, 65, 3, 0, 0, 1.5, false, true, smooth};
	const struct rgl_spec fine = {1, 25, 129, 3, 0, 0, 1.5, false, true, smooth};
	const double error = interpolant_error(&fine);
	/* The order is two but for the cells that the horizon cuts. */
	check_between(error, 0, 0.003, "mean error");
	check_between(error, 0, interpolant_error(&coarse) / 2.5, "mean error with half as many nodes, over 2.5");
}

/* The files are so coarse that how one interpolates is most of the value. */
static void values_match_golden_rows(void **state)
{
	(void)state;
	const struct rgl_spec spec[] = {{1, 5, 9, 3, 0, 0, 1.5, false, true, smooth},
					{9, 4, 7, 3, -pi, pi, 1.5, false, true, twisted}};
	struct measurement m[2];
	struct golden golden =
		golden_open("tests/golden/rgl_values.csv", "file,theta_i,phi_i,theta_o,phi_o,f_r,f_g,f_b");
	for (int k = 0; k < 2; k++)
		read_spec(&spec[k], &m[k]);
	while (golden_next(&golden)) {
		const double *v = golden.value;
		double f[3];
		const struct rgl *rgl = m[!strcmp(golden.text[0], "anisotropic")].rgl;
		assert_true(rgl_f(rgl, direction(v[1], v[2]), direction(v[3], v[4]), f));
		for (int c = 0; c < 3; c++)
			check_rel(f[c], v[5 + c], 2e-6, golden.label);
	}
	assert_int_equal(golden.rows, 24);
	for (int k = 0; k < 2; k++)
		measurement_free(&m[k]);
}

static void azimuths_of_a_half_and_a_quarter_stand_for_the_whole_circle(void **state)
{
	(void)state;
	const struct rgl_spec whole = {49, 17, 65, 3, -pi, pi, 1.5, false, true, twisted};
	const struct rgl_spec half = {25, 17, 65, 3, -pi, 0, 1.5, false, true, twisted};
	const struct rgl_spec quarter = {13, 17, 65, 3, -pi, -pi / 2, 1.5, false, true, brushed};
	check_between(interpolant_error(&whole), 0, 0.006, "mean error, whole circle");
	check_between(interpolant_error(&half), 0, 0.006, "mean error, half");
	check_between(interpolant_error(&quarter), 0, 0.006, "mean error, quarter");
}

static void symmetry_is_that_of_the_azimuths(void **state)
{
	(void)state;
	const struct {
		struct rgl_spec spec;
		enum symmetry symmetry;
	} known[] = {{isotropic, SYMMETRY_ISOTROPIC},
		     {{9, 3, 5, 3, -pi, pi, 1.5, false, true, twisted}, SYMMETRY_ANISOTROPIC},
		     {{5, 3, 5, 3, -pi, 0, 1.5, false, true, twisted}, SYMMETRY_ANISOTROPIC},
		     {{3, 3, 5, 3, -pi, -pi / 2, 1.5, false, true, brushed}, SYMMETRY_PLANE}};
	for (size_t n = 0; n < sizeof known / sizeof *known; n++) {
		struct measurement m;
		read_spec(&known[n].spec, &m);
		assert_int_equal(m.scattered->symmetry, known[n].symmetry);
		measurement_free(&m);
	}
}

/* The integral of cos_i cos_o over both hemispheres is pi^2. */
static void solid_angles_add_up_to_the_hemispheres(void **state)
{
	(void)state;
	const struct rgl_spec spec[] = {{1, 33, 65, 3, 0, 0, pi / 2, false, true, smooth},
					{17, 17, 33, 3, -pi, pi, pi / 2, false, true, twisted},
					{5, 17, 33, 3, -pi, -pi / 2, pi / 2, false, true, brushed}};
	for (size_t k = 0; k < sizeof spec / sizeof *spec; k++) {
		struct measurement m;
		double sum = 0;
		read_spec(&spec[k], &m);
		for (size_t n = 0; n < m.scattered->n; n++)
			sum += (double)m.scattered->solid_angle[n] * m.scattered->wi[n].z * m.scattered->wo[n].z;
		check_rel(sum, pi * pi, 0.02, "sum of cos_i cos_o");
		measurement_free(&m);
	}
}

static void spectra_become_the_RGB_that_spectrum_makes_of_them(void **state)
{
	(void)state;
	const struct rgl_spec spec = {1, 5, 17, 13, 0, 0, 1.5, true, true, rising_spectrum};
	double nm[13], weight[3 * 13], value[13], rgb[3];
	struct measurement m;
	read_spec(&spec, &m);
	for (int j = 0; j < 13; j++)
		nm[j] = 400 + 25 * j;
	assert_int_equal(spectrum_weights(nm, 13, weight), STATUS_OK);
	assert_false(m.scattered->gray);
	for (size_t n = 0; n < m.scattered->n; n++) {
		const struct vec3 wi = m.scattered->wi[n], wo = m.scattered->wo[n];
		for (int j = 0; j < 13; j++)
			value[j] = rising_spectrum(wi, wo, j);
		spectrum_rgb(weight, value, 13, rgb);
		for (int c = 0; c < 3; c++)
			check_abs((double)m.scattered->value[c][n], rgb[c], 3e-6 / wo.z, "RGB of a spectrum");
	}
	measurement_free(&m);
}

static double out_of_gamut(struct vec3 wi, struct vec3 wo, int channel)
{
	return channel == 1 && wo.x > 0 ? -0.1 : smooth(wi, wo, channel);
}

static void what_is_out_of_gamut_is_left_out_and_counted(void **state)
{
	(void)state;
	struct rgl_spec spec = isotropic;
	struct measurement all, some;
	read_spec(&spec, &all);
	spec.f = out_of_gamut;
	read_spec(&spec, &some);
	assert_true(some.n_out_of_gamut > 1000);
	assert_int_equal(some.n_out_of_gamut + some.scattered->n, all.scattered->n);
	for (size_t n = 0; n < some.scattered->n; n++)
		assert_true(some.scattered->wo[n].x <= 0);
	measurement_free(&all);
	measurement_free(&some);
}

static void below_the_horizon_there_is_no_value(void **state)
{
	(void)state;
	struct measurement m;
	double f[3] = {7, 7, 7};
	read_spec(&isotropic, &m);
	assert_false(rgl_f(m.rgl, direction(0.3, 0), direction(1.6, 0), f));
	assert_false(rgl_f(m.rgl, direction(1.6, 0), direction(0.3, 0), f));
	assert_true(f[0] == 7 && f[2] == 7);
	measurement_free(&m);
}

/* ---- Bad files ---- */

static const struct rgl_spec small = {1, 3, 4, 3, 0, 0, 1.5, false, true, smooth};

static void refuse(const struct rgl_bytes *file, const char *words)
{
	struct measurement m;
	struct error error = {""};
	const enum status status = read_bytes(file, &m, &error);
	if (status != STATUS_FORMAT && status != STATUS_NO_DATA)
		fail_msg("status %d instead of a refusal with '%s'", (int)status, words);
	assert_null(m.scattered);
	if (!strstr(error.text, words))
		fail_msg("'%s' does not say '%s'", error.text, words);
}

static void a_file_cut_anywhere_is_refused(void **state)
{
	(void)state;
	struct rgl_bytes file = rgl_make(&small);
	const size_t whole = file.size;
	for (file.size = 1; file.size < whole; file.size++)
		refuse(&file, "cannot read '");
	free(file.bytes);
}

/* Where a field's record stands in the header. */
static unsigned char *record_of(const struct rgl_bytes *file, const char *name)
{
	unsigned char *found = memmem(file->bytes, file->size, name, strlen(name));
	assert_non_null(found);
	return found + strlen(name);
}

enum { DIMS = 0, TYPE = 2, OFFSET = 3, SHAPE = 11 };

static void set_64(unsigned char *at, uint64_t value)
{
	memcpy(at, &value, sizeof value);
}

static uint64_t get_64(const unsigned char *at)
{
	uint64_t value;
	memcpy(&value, at, sizeof value);
	return value;
}

static void set_float(const struct rgl_bytes *file, const char *field, size_t n, float value)
{
	memcpy(file->bytes + get_64(record_of(file, field) + OFFSET) + n * sizeof value, &value, sizeof value);
}

static void wrong_fields_are_refused_by_name(void **state)
{
	(void)state;
	for (int fault = 0; fault < 14; fault++) {
		struct rgl_bytes file = rgl_make(&small);
		const char *words = "";
		switch (fault) {
		case 0:
			set_64(record_of(&file, "sigma") + OFFSET, get_64(record_of(&file, "ndf") + OFFSET) + 4);
			words = "fields 'ndf' and 'sigma' overlap, at bytes ";
			break;
		case 1:
			set_64(record_of(&file, "ndf") + OFFSET, 20);
			words = "field 'ndf' overlaps the header, at byte 20";
			break;
		case 2:
			set_64(record_of(&file, "vndf") + SHAPE + 8, UINT64_MAX / 8);
			words = "field 'vndf': a dimension of 2305843009213693951 does not fit into a file of";
			break;
		case 3:
			set_64(record_of(&file, "vndf") + SHAPE + 8, 0);
			words = "field 'vndf': a dimension of 0 is impossible";
			break;
		case 4:
			set_64(record_of(&file, "rgb") + OFFSET, UINT64_MAX - 3);
			words = "field 'rgb': expected bytes";
			break;
		case 5:
			record_of(&file, "theta_i")[TYPE] = 12;
			words = "field 'theta_i': expected a type from 1 to 11, found 12";
			break;
		case 6:
			record_of(&file, "theta_i")[TYPE] = 5;
			words = "field 'theta_i': expected floats, type 10 or 11, found type 5";
			break;
		case 7:
			set_float(&file, "theta_i", 1, 1.5F);
			words = "field 'theta_i': expected ascending numbers in 0 .. 1.57";
			break;
		case 8:
			set_float(&file, "rgb", 7, NAN);
			words = "field 'rgb': element 7 is not a finite number";
			break;
		case 9:
			set_float(&file, "vndf", 20, -1);
			words = "field 'vndf': a density is negative";
			break;
		case 10:
			for (size_t n = 16; n < 32; n++)
				set_float(&file, "vndf", n, 0);
			words = "field 'vndf': a density is zero everywhere";
			break;
		case 11:
			memcpy(record_of(&file, "sigma") - 5, "sigmA", 5);
			words = "expected a field 'sigma', found none";
			break;
		case 12:
			for (size_t n = 0; n < 3 * 3 * 16; n++)
				set_float(&file, "rgb", n, -1);
			words = "no sample can be used";
			break;
		default:
			file.bytes[12] = 2;
			words = "expected version 1 of the format, found 2.0";
		}
		refuse(&file, words);
		free(file.bytes);
	}
}

static void azimuths_that_stand_for_no_circle_are_refused(void **state)
{
	(void)state;
	const double last[] = {-pi + 1e-6, -pi + 2};
	for (int n = 0; n < 2; n++) {
		struct rgl_spec spec = {5, 3, 4, 3, -pi, last[n], 1.5, false, true, twisted};
		struct rgl_bytes file = rgl_make(&spec);
		refuse(&file, "field 'phi_i': expected the whole circle, a half or a quarter, found -3.14159 to");
		free(file.bytes);
	}
}

/* Deterministic damage: the reader comes back, and what it gives is sound. */
static void damaged_files_never_give_unsound_entries(void **state)
{
	(void)state;
	uint32_t random = 12345;
	for (int run = 0; run < 600; run++) {
		struct rgl_bytes file = rgl_make(&small);
		struct measurement m;
		for (int n = 0; n < 1 + run % 4; n++) {
			random = random * 1664525u + 1013904223u;
			/* Half of the damage is done to the header. */
			const size_t reach = run % 2 ? 300 : file.size;
			file.bytes[(random >> 8) % reach] = (unsigned char)(random >> 24);
		}
		if (read_bytes(&file, &m, NULL) == STATUS_OK) {
			const struct scattered *s = m.scattered;
			for (size_t n = 0; n < s->n; n++) {
				check_abs(vec3_length(s->wo[n]), 1, 1e-9, "length of wo");
				assert_true(s->wi[n].z > 0 && s->wo[n].z > 0);
				for (int c = 0; c < 3; c++)
					assert_true(s->value[c][n] >= 0 && s->value[c][n] <= FLT_MAX);
				assert_true(s->solid_angle[n] >= 0 && s->solid_angle[n] <= FLT_MAX);
			}
			measurement_free(&m);
		}
		free(file.bytes);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(entries_of_an_isotropic_file_have_the_values_of_its_BRDF),
		cmocka_unit_test(entries_of_an_anisotropic_file_have_the_values_of_its_BRDF),
		cmocka_unit_test(a_file_that_is_not_divided_by_its_distribution_gives_the_same_BRDF),
		cmocka_unit_test(between_nodes_the_interpolant_converges_to_the_BRDF),
		cmocka_unit_test(values_match_golden_rows),
		cmocka_unit_test(azimuths_of_a_half_and_a_quarter_stand_for_the_whole_circle),
		cmocka_unit_test(symmetry_is_that_of_the_azimuths),
		cmocka_unit_test(solid_angles_add_up_to_the_hemispheres),
		cmocka_unit_test(spectra_become_the_RGB_that_spectrum_makes_of_them),
		cmocka_unit_test(what_is_out_of_gamut_is_left_out_and_counted),
		cmocka_unit_test(below_the_horizon_there_is_no_value),
		cmocka_unit_test(a_file_cut_anywhere_is_refused),
		cmocka_unit_test(wrong_fields_are_refused_by_name),
		cmocka_unit_test(azimuths_that_stand_for_no_circle_are_refused),
		cmocka_unit_test(damaged_files_never_give_unsound_entries),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
