/* SPDX-License-Identifier: GPL-3.0-or-later */
/* BRDF Explorer: GLSL of the whole model. GLSL has 32-bit floats and neither the Gamma function nor erf; so Gamma ratios
 * and normalisations are constants, and each formula is the one of src/ that loses the fewest digits, with as many terms
 * as a float can tell. Lambda without a closed form is a table (lambda_table.h).
 *
 * The parameters are sliders. BRDF Explorer keeps six digits of them, so the shader has the fitted values with all their
 * digits, too, and what follows from them, and uses those until a slider is moved. Sliders are floats: a `color` would be
 * rounded to 16 bits and cut at 1. A Lambda in a table belongs to one shape, which has no sliders then. `gamma` is a name
 * that BRDF Explorer's own shaders have. The format has a section for importance sampling, isFunc, but nothing of BRDF
 * Explorer calls it, and a file with one is shown in plain green where it would be: there is none. */
#include "fit/export/export_format.h"
#include "fit/export/lambda_table.h"
#include "fit/results/csv_number.h"
#include "src/pwl.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* Which Lambda is written. */
enum lambda_kind { LAMBDA_OF_GGX, LAMBDA_OF_BECKMANN, LAMBDA_OF_STUDENT_T, LAMBDA_OF_EQ_22, LAMBDA_OF_TABLE };

struct glsl {
	FILE *file;
	const struct cook_torrance *model;
	bool out_of_range; /* a number was no float */
};

static bool is_named(const struct ndf *ndf, const char *name)
{
	return strcmp(ndf_name(ndf->class), name) == 0;
}

static bool is_student_t(const struct ndf *ndf)
{
	return ndf_is_student_t(ndf->class);
}

static enum lambda_kind lambda_kind(const struct ndf *ndf)
{
	if (ndf->lambda_form == LAMBDA_RATIONAL)
		return LAMBDA_OF_EQ_22;
	if (is_named(ndf, "ggx"))
		return LAMBDA_OF_GGX;
	if (isinf(ndf->gamma) && (is_named(ndf, "beckmann") || is_student_t(ndf)))
		return LAMBDA_OF_BECKMANN;
	return is_student_t(ndf) ? LAMBDA_OF_STUDENT_T : LAMBDA_OF_TABLE;
}

/* A literal: with a point or an exponent, or it would be an integer. */
static const char *literal(struct glsl *glsl, char text[CSV_NUMBER_SIZE], double x)
{
	if (!(fabs(x) <= FLT_MAX) || (x != 0 && fabs(x) < FLT_MIN))
		glsl->out_of_range = true;
	csv_number(text, x);
	if (!strpbrk(text, ".e"))
		strcat(text, ".0");
	return text;
}

static void constant(struct glsl *glsl, const char *name, double x)
{
	char text[CSV_NUMBER_SIZE];
	fprintf(glsl->file, "const float %s = %s;\n", name, literal(glsl, text, x));
}

static void constant_array(struct glsl *glsl, const char *name, const double *x, int n)
{
	char text[CSV_NUMBER_SIZE];
	fprintf(glsl->file, "const float %s[%d] = float[%d](", name, n, n);
	for (int i = 0; i < n; i++)
		fprintf(glsl->file, "%s%s", i % 6 ? ", " : i ? ",\n\t" : "\n\t", literal(glsl, text, x[i]));
	fprintf(glsl->file, ");\n");
}

static void lines(struct glsl *glsl, const char *text)
{
	fputs(text, glsl->file);
}

static bool has_first(const struct cook_torrance *model)
{
	return export_max(model->ks) > 0;
}

/* ---- Sliders ---- */

/* Whether the shape can be changed: sigma, and gamma. */
static bool slides_sigma(const struct ndf *ndf)
{
	return is_named(ndf, "ggx") || is_named(ndf, "beckmann") || is_student_t(ndf);
}

static bool slides_gamma(const struct ndf *ndf)
{
	return is_student_t(ndf) && isfinite(ndf->gamma) && ndf->lambda_form != LAMBDA_RATIONAL;
}

/* From a little below the value, if need be, to the first of the ends that is not below it. */
static void slider(struct glsl *glsl, const char *name, double value, double min, double usual, double max)
{
	char text[3][CSV_NUMBER_SIZE];
	const double end = value <= usual ? usual : value <= max ? max : 2 * value;
	fprintf(glsl->file, "float %s %s %s %s\n", name, literal(glsl, text[0], fmin(min, value)),
		literal(glsl, text[1], end), literal(glsl, text[2], value));
}

static void sliders_rgb(struct glsl *glsl, const char *name, const double rgb[3])
{
	for (int c = 0; c < 3; c++) {
		char channel[16];
		snprintf(channel, sizeof channel, "%s_%c", name, "rgb"[c]);
		slider(glsl, channel, rgb[c], 0, 1, 1);
	}
}

/* Of one lobe, but for its F. */
static void write_lobe_sliders(struct glsl *glsl)
{
	const struct cook_torrance *model = glsl->model;
	const struct ndf *ndf = &model->ndf;
	sliders_rgb(glsl, "ks", model->ks);
	if (slides_sigma(ndf) && export_has_axes(model)) {
		slider(glsl, "sigma_x", ndf->sigma_x, 1e-4, 1, 4);
		slider(glsl, "sigma_y", ndf->sigma_y, 1e-4, 1, 4);
	} else if (slides_sigma(ndf)) {
		slider(glsl, "sigma", ndf->sigma_x, 1e-4, 1, 4);
	}
	if (slides_gamma(ndf))
		slider(glsl, "gamma_shape", ndf->gamma, is_named(ndf, "t-family") ? ndf->param[2] + 1e-4 : 1.5001, 10,
		       1000);
}

/* F0, F82 or F90 of the channels. */
static void reflectances(const struct cook_torrance *model, int part, double rgb[3])
{
	for (int c = 0; c < 3; c++)
		rgb[c] = model->reflectance[c][part];
}

static const char *const part_name[F82_PARTS] = {"f0", "f82", "f90"};

static void write_fresnel_sliders(struct glsl *glsl)
{
	const struct cook_torrance *model = glsl->model;
	if (fresnel_has_ior(model->fresnel))
		slider(glsl, "n", model->n, fit_ior_min(model->fresnel), 3, 100);
	if (model->fresnel == FRESNEL_CONDUCTOR)
		slider(glsl, "k", model->k, 0, 10, 100);
	for (int part = 0; part < F82_PARTS && model->fresnel == FRESNEL_F82; part++) {
		double rgb[3];
		reflectances(model, part, rgb);
		sliders_rgb(glsl, part_name[part], rgb);
	}
}

/* ---- The second lobe: written as the first one, to a text in which names are changed then ---- */

static struct cook_torrance second_lobe(const struct cook_torrance *model)
{
	struct cook_torrance second = *model;
	second.ndf = model->second;
	memcpy(second.ks, model->ks_second, sizeof second.ks);
	return second;
}

static bool is_word(char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/* A word of the text, of so many characters, with 2 behind its first part: mf2_D, sigma2, ks2_r. */
static void write_second_word(FILE *file, const char *word, size_t length)
{
	static const char *const shared[] = {"mf_moved", "mf_F", "MF_PI"};
	static const char *const prefixes[] = {"mf", "MF", "sigma", "ks"};
	for (size_t i = 0; i < sizeof shared / sizeof *shared; i++)
		if (length == strlen(shared[i]) && !strncmp(word, shared[i], length)) {
			fwrite(word, 1, length, file);
			return;
		}
	if (length == 11 && !strncmp(word, "gamma_shape", length)) {
		fputs("gamma2", file);
		return;
	}
	for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
		const size_t n = strlen(prefixes[i]);
		if (length >= n && !strncmp(word, prefixes[i], n) && (length == n || word[n] == '_')) {
			fprintf(file, "%s2%.*s", prefixes[i], (int)(length - n), word + n);
			return;
		}
	}
	fwrite(word, 1, length, file);
}

static void write_second(FILE *file, const char *text)
{
	while (*text) {
		size_t length = 0;
		while (is_word(text[length]))
			length++;
		if (length > 0)
			write_second_word(file, text, length);
		else
			fputc(text[length++], file);
		text += length;
	}
}

static void write_sliders(struct glsl *glsl)
{
	const struct cook_torrance *model = glsl->model;
	sliders_rgb(glsl, "kd", model->kd);
	if (cook_torrance_has_grazing(model)) {
		sliders_rgb(glsl, "kg", model->kg);
		slider(glsl, "exponent", model->grazing, 1, 10, 100);
	}
	if (has_first(model))
		write_lobe_sliders(glsl);
	if (has_first(model) || cook_torrance_has_second(model))
		write_fresnel_sliders(glsl);
}

/* A function that says whether one of two sliders, or the only one (`other` NULL), was moved. */
static void write_moved(struct glsl *glsl, const char *function, const char *name, double value, const char *other,
			double other_value)
{
	char text[CSV_NUMBER_SIZE];
	fprintf(glsl->file, "bool %s()\n{\n\treturn mf_moved(%s, %s)", function, name, literal(glsl, text, value));
	if (other)
		fprintf(glsl->file, " || mf_moved(%s, %s)", other, literal(glsl, text, other_value));
	lines(glsl, ";\n}\n\n");
}

static const char moved[] = "bool mf_moved(float slider, float value)\n{\n"
			    "\treturn abs(slider - value) > 1e-5 * value;\n}\n\n";

/* A number that follows from sliders: its value, until one was moved, after which it is the expression. */
static void derived(struct glsl *glsl, const char *name, double value, const char *moved_function,
		    const char *expression)
{
	char text[CSV_NUMBER_SIZE];
	fprintf(glsl->file, "float %s()\n{\n\treturn %s() ? %s : %s;\n}\n\n", name, moved_function, expression,
		literal(glsl, text, value));
}

static void derived_rgb(struct glsl *glsl, const char *name, const double rgb[3])
{
	char text[CSV_NUMBER_SIZE];
	fprintf(glsl->file, "vec3 mf_%s()\n{\n\treturn vec3(", name);
	for (int c = 0; c < 3; c++) {
		const char channel = "rgb"[c];
		literal(glsl, text, rgb[c]);
		fprintf(glsl->file, "%smf_moved(%s_%c, %s) ? %s_%c : %s", c ? ",\n\t\t" : "", name, channel, text, name,
			channel, text);
	}
	lines(glsl, ");\n}\n\n");
}

/* F */

/* fresnel_f82() of src/fresnel.c. */
static void write_f82(struct glsl *glsl)
{
	const double x = 6.0 / 7, five = x * x * x * x * x;
	for (int part = 0; part < F82_PARTS; part++) {
		double rgb[3];
		reflectances(glsl->model, part, rgb);
		derived_rgb(glsl, part_name[part], rgb);
	}
	constant(glsl, "MF_FIVE", five);
	constant(glsl, "MF_PEAK", five * x / 7);
	lines(glsl, "\nfloat mf_f82_of(float c, float a, float b, float e)\n{\n"
		    "\tfloat x = 1.0 - c;\n"
		    "\tfloat five = (x * x) * (x * x) * x;\n"
		    "\tfloat bump = c * five * x / MF_PEAK;\n"
		    "\tfloat F = a * (1.0 - five - (1.0 - MF_FIVE) * bump) + b * bump + e * (five - MF_FIVE * bump);\n"
		    "\treturn min(max(F, 0.0), 1.0);\n}\n\n"
		    "vec3 mf_F(float c)\n{\n"
		    "\tvec3 a = mf_f0();\n\tvec3 b = mf_f82();\n\tvec3 e = mf_f90();\n"
		    "\treturn vec3(mf_f82_of(c, a.x, b.x, e.x), mf_f82_of(c, a.y, b.y, e.y),\n"
		    "\t\tmf_f82_of(c, a.z, b.z, e.z));\n}\n\n");
}

static void write_fresnel(struct glsl *glsl)
{
	const struct cook_torrance *model = glsl->model;
	const double n = model->n, k = model->fresnel == FRESNEL_CONDUCTOR ? model->k : 0;
	const double m2 = (n - k) * (n + k), m2_1 = (n - 1) * (n + 1) - k * k;
	if (model->fresnel == FRESNEL_F82) {
		write_f82(glsl);
		return;
	}
	if (model->fresnel == FRESNEL_NONE) {
		lines(glsl, "float mf_F(float c)\n{\n\treturn 1.0;\n}\n\n");
		return;
	}
	if (model->fresnel == FRESNEL_SCHLICK) {
		const double root = (n - 1) / (n + 1);
		write_moved(glsl, "mf_index_moved", "n", n, NULL, 0);
		derived(glsl, "mf_F0", root * root, "mf_index_moved",
			"(n - 1.0) / (n + 1.0) * ((n - 1.0) / (n + 1.0))");
		lines(glsl, "float mf_F(float c)\n{\n\tfloat x = 1.0 - c;\n"
			    "\treturn mf_F0() + (1.0 - mf_F0()) * (x * x) * (x * x) * x;\n}\n\n");
		return;
	}
	/* The index m = n + i k; m^2 - 1 without its cancellation. */
	if (model->fresnel == FRESNEL_DIELECTRIC) {
		write_moved(glsl, "mf_index_moved", "n", n, NULL, 0);
		derived(glsl, "mf_m2", m2, "mf_index_moved", "n * n");
		derived(glsl, "mf_m2_1", m2_1, "mf_index_moved", "(n - 1.0) * (n + 1.0)");
		lines(glsl, "float mf_F(float c)\n{\n"
			    "\tfloat m2 = mf_m2();\n"
			    "\tfloat m2_1 = mf_m2_1();\n"
			    "\tfloat s2 = (1.0 - c) * (1.0 + c);\n"
			    "\tfloat g2 = c * c < 0.5 ? m2_1 + c * c : m2 - s2;\n"
			    "\tif (c <= 0.0 || g2 < 0.0)\n\t\treturn 1.0;\n"
			    "\tfloat g = sqrt(g2);\n"
			    "\tfloat r_s = m2_1 / (c + g) / (c + g);\n"
			    "\tfloat r_p = m2_1 / (m2 * c + g) * ((m2 * c * c - s2) / (m2 * c + g));\n"
			    "\treturn min(0.5 * (r_s * r_s + r_p * r_p), 1.0);\n}\n\n");
		return;
	}
	write_moved(glsl, "mf_index_moved", "n", n, "k", k);
	derived(glsl, "mf_m2", m2, "mf_index_moved", "(n - k) * (n + k)");
	derived(glsl, "mf_m2_1", m2_1, "mf_index_moved", "(n - 1.0) * (n + 1.0) - k * k");
	derived(glsl, "mf_m2_i", 2 * n * k, "mf_index_moved", "2.0 * n * k"); /* imaginary part of m^2 */
	lines(glsl, "float mf_F(float c)\n{\n"
		    "\tif (c <= 0.0)\n\t\treturn 1.0;\n"
		    "\tfloat m2 = mf_m2();\n"
		    "\tfloat m2_1 = mf_m2_1();\n"
		    "\tfloat m2_i = mf_m2_i();\n"
		    "\tfloat front2 = m2_1 * m2_1 + m2_i * m2_i;\n"
		    "\tfloat s2 = (1.0 - c) * (1.0 + c);\n"
		    "\tfloat re = c * c < 0.5 ? m2_1 + c * c : m2 - s2;\n"
		    "\tfloat root = sqrt(0.5 * (sqrt(re * re + m2_i * m2_i) + abs(re)));\n"
		    "\tfloat other = root > 0.0 ? 0.5 * m2_i / root : 0.0;\n"
		    "\tfloat a = re >= 0.0 ? root : other;\n" /* sqrt(m^2 - s^2) = a + i b */
		    "\tfloat b = re >= 0.0 ? other : root;\n"
		    "\tfloat s_sum = (c + a) * (c + a) + b * b;\n"
		    "\tfloat p_re = m2 * c + a;\n"
		    "\tfloat p_im = m2_i * c + b;\n"
		    "\tfloat p_sum = p_re * p_re + p_im * p_im;\n"
		    "\tfloat q_re = m2 * c * c - s2;\n"
		    "\tfloat q_im = m2_i * c * c;\n"
		    "\tfloat R_s = front2 / s_sum / s_sum;\n"
		    "\tfloat R_p = front2 / p_sum * ((q_re * q_re + q_im * q_im) / p_sum);\n"
		    "\treturn min(0.5 * (R_s + R_p), 1.0);\n}\n\n");
}

/* D; h is the half vector, h.z > 0 */

static const char log_1p[] =
	"float mf_log_1p(float x)\n{\n"
	"\tif (x > 0.5)\n\t\treturn log(1.0 + x);\n"
	"\tfloat s = x / (2.0 + x);\n"
	"\tfloat t = s * s;\n"
	"\treturn 2.0 * s * (1.0 + t * (1.0 / 3.0 + t * (1.0 / 5.0 + t * (1.0 / 7.0 + t * (1.0 / 9.0"
	" + t * (1.0 / 11.0 + t * (1.0 / 13.0)))))));\n}\n\n";

/* The roughness of the formulas: of an anisotropic distribution the geometric mean; lengths in x and y are scaled then. */
static double roughness(const struct ndf *ndf)
{
	return ndf->sigma_x == ndf->sigma_y ? ndf->sigma_x : sqrt(ndf->sigma_x * ndf->sigma_y);
}

/* The roughness in terms of STD, and gamma - 1 where gamma has a slider. */
static void write_shape(struct glsl *glsl)
{
	const struct ndf *ndf = &glsl->model->ndf;
	const bool axes = export_has_axes(glsl->model), with_gamma = slides_gamma(ndf);
	const char *sigma = axes ? "sqrt(sigma_x * sigma_y)" : "sigma", *moved_function = "mf_sigma_moved";
	char expression[120], number[CSV_NUMBER_SIZE];
	if (axes)
		write_moved(glsl, "mf_sigma_moved", "sigma_x", ndf->sigma_x, "sigma_y", ndf->sigma_y);
	else
		write_moved(glsl, "mf_sigma_moved", "sigma", ndf->sigma_x, NULL, 0);
	if (with_gamma) {
		write_moved(glsl, "mf_gamma_moved", "gamma_shape", ndf->gamma, NULL, 0);
		derived(glsl, "mf_gamma", ndf->gamma, "mf_gamma_moved", "gamma_shape");
		derived(glsl, "mf_a", ndf->gamma - 1, "mf_gamma_moved", "gamma_shape - 1.0");
	}
	snprintf(expression, sizeof expression, "%s", sigma);
	if (with_gamma && is_named(ndf, "hyper-cauchy"))
		snprintf(expression, sizeof expression, "%s / sqrt(mf_a())", sigma);
	else if (with_gamma && is_named(ndf, "t-family"))
		snprintf(expression, sizeof expression, "%s * sqrt((mf_gamma() - %s) / mf_a())", sigma,
			 literal(glsl, number, ndf->param[2]));
	else if (ndf->stretch != 1)
		snprintf(expression, sizeof expression, "%s / %s", sigma, literal(glsl, number, ndf->stretch));
	if (with_gamma && !is_named(ndf, "std")) {
		lines(glsl, "bool mf_shape_moved()\n{\n\treturn mf_sigma_moved() || mf_gamma_moved();\n}\n\n");
		moved_function = "mf_shape_moved";
	}
	derived(glsl, "mf_sigma", roughness(ndf) / ndf->stretch, moved_function, expression);
}

static void write_D_tan(struct glsl *glsl, const char *returned)
{
	lines(glsl, "float mf_D(vec3 h)\n{\n"
		    "\tfloat z = max(h.z, 1e-9);\n"
		    "\tfloat t = length(h.xy) / (mf_sigma() * z);\n"
		    "\tfloat w = 1.0 / (mf_sigma() * z * z);\n");
	fprintf(glsl->file, "\treturn %s;\n}\n\n", returned);
}

/* Node values; Fx is D itself where the distribution is isotropic. */
static enum status write_D_pl(struct glsl *glsl, struct error *error)
{
	const struct pwl *pwl = glsl->model->ndf.pwl;
	const int n = pwl->n_nodes;
	double *x = calloc((size_t)n, sizeof *x);
	if (!x)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	for (int i = 0; i < n; i++)
		x[i] = pwl->nodes[i].theta;
	constant_array(glsl, "MF_THETA", x, n);
	for (int i = 0; i < n; i++)
		x[i] = pwl->nodes[i].Fx;
	constant_array(glsl, "MF_D", x, n);
	free(x);
	fprintf(glsl->file,
		"\nfloat mf_D(vec3 h)\n{\n"
		"\tfloat theta = atan(length(h.xy), h.z);\n"
		"\tint low = 0;\n"
		"\tint high = %d;\n"
		"\tfor (int i = 0; i < 32; i++) {\n"
		"\t\tif (high - low <= 1)\n\t\t\tbreak;\n"
		"\t\tint middle = (low + high) / 2;\n"
		"\t\tif (MF_THETA[middle] <= theta)\n\t\t\tlow = middle;\n"
		"\t\telse\n\t\t\thigh = middle;\n\t}\n"
		"\tfloat x = (theta - MF_THETA[low]) / (MF_THETA[high] - MF_THETA[low]);\n"
		"\treturn MF_D[low] + min(x, 1.0) * (MF_D[high] - MF_D[low]);\n}\n\n",
		n - 1);
	return STATUS_OK;
}

static void write_D_gtr(struct glsl *glsl)
{
	const struct ndf *ndf = &glsl->model->ndf;
	const double sigma = ndf->sigma_x;
	constant(glsl, "MF_A", ndf->A);
	constant(glsl, "MF_GAMMA", ndf->gamma);
	constant(glsl, "MF_S", sigma > 1 ? (sigma - 1) * (sigma + 1) : (1 - sigma) * (1 + sigma) / sigma / sigma);
	fprintf(glsl->file, "\nfloat mf_D(vec3 h)\n{\n\treturn MF_A * exp(-MF_GAMMA * mf_log_1p(MF_S * %s));\n}\n\n",
		sigma > 1 ? "h.z * h.z" : "dot(h.xy, h.xy)");
}

static void write_D_low(struct glsl *glsl)
{
	const struct ndf *ndf = &glsl->model->ndf;
	constant(glsl, "MF_A", ndf->A);
	constant(glsl, "MF_B", ndf->param[0]);
	constant(glsl, "MF_C", ndf->param[1]);
	lines(glsl, "\nfloat mf_D(vec3 h)\n{\n"
		    "\treturn MF_A * exp(-MF_C * mf_log_1p(MF_B * (dot(h.xy, h.xy) / (1.0 + h.z))));\n}\n\n");
}

/* Of GGX, Beckmann and the Student-t family. */
static void write_D_of_shape(struct glsl *glsl)
{
	const struct ndf *ndf = &glsl->model->ndf;
	write_shape(glsl);
	if (isinf(ndf->gamma)) {
		write_D_tan(glsl, "exp(-t * t) * w * w / MF_PI");
		return;
	}
	if (ndf->gamma == 2.0 && !slides_gamma(ndf)) {
		lines(glsl, "float mf_D(vec3 h)\n{\n"
			    "\tfloat s = mf_sigma() * h.z * h.z + dot(h.xy, h.xy) / mf_sigma();\n"
			    "\treturn 1.0 / (MF_PI * s * s);\n}\n\n");
		return;
	}
	if (!slides_gamma(ndf)) {
		constant(glsl, "MF_GAMMA", ndf->gamma);
		lines(glsl, "\nfloat mf_gamma()\n{\n\treturn MF_GAMMA;\n}\n\n"
			    "float mf_a()\n{\n\treturn MF_GAMMA - 1.0;\n}\n\n");
	}
	write_D_tan(glsl, "exp(-mf_gamma() * mf_log_1p(t * t / mf_a())) * w * w / MF_PI");
}

static enum status write_D(struct glsl *glsl, struct error *error)
{
	const struct ndf *ndf = &glsl->model->ndf;
	if (ndf_is_tabulated(ndf->class))
		return write_D_pl(glsl, error);
	lines(glsl, log_1p);
	if (is_named(ndf, "gtr"))
		write_D_gtr(glsl);
	else if (is_named(ndf, "low"))
		write_D_low(glsl);
	else
		write_D_of_shape(glsl);
	return STATUS_OK;
}

/* Lambda; z = cos(theta) > 0 and s = sin(theta) >= 0 of a direction */

/* Steps of the continued fractions below for 1e-8, z >= 0.8. */
#define FRACTION_STEPS "4 + int(24.0 / (z * z))"

static void write_lambda_beckmann(struct glsl *glsl)
{
	lines(glsl, "float mf_lambda(float c, float s)\n{\n"
		    "\tif (s * mf_sigma() * 8.0 < c)\n\t\treturn 0.0;\n"
		    "\tfloat z = c / (s * mf_sigma());\n"
		    "\tfloat e = exp(-z * z) / 1.7724538509055160273;\n"
		    "\tif (z < 0.8) {\n"
		    "\t\tfloat term = z;\n\t\tfloat sum = z;\n"
		    "\t\tfor (int i = 0; i < 32; i++) {\n"
		    "\t\t\tterm *= z * z / (1.5 + float(i));\n\t\t\tsum += term;\n"
		    "\t\t\tif (term < 1e-9)\n\t\t\t\tbreak;\n\t\t}\n"
		    "\t\treturn max(0.5 * e / z - 0.5 + e * sum, 0.0);\n\t}\n"
		    "\tfloat tail = 0.0;\n"
		    "\tfor (int m = " FRACTION_STEPS "; m > 0; m--)\n"
		    "\t\ttail = float(m) * (float(m) + 0.5) / (1.5 + 2.0 * float(m) + z * z - tail);\n"
		    "\treturn 0.25 * e / z / (1.5 + z * z - tail);\n}\n\n");
}

/* student_t_lambda() of src/student_t.c, where the forms are explained. */
static void write_lambda_student_t(struct glsl *glsl)
{
	const struct ndf *ndf = &glsl->model->ndf;
	/* Gamma(x + 1/2) / Gamma(x), from 8.5 on by its asymptotic series. */
	lines(glsl, "float mf_gamma_ratio(float x)\n{\n"
		    "\tfloat front = 1.0;\n"
		    "\tfloat y = x;\n"
		    "\tfor (int i = 0; i < 8; i++) {\n"
		    "\t\tfront *= y / (y + 0.5);\n\t\ty += 1.0;\n\t}\n"
		    "\tfloat r = 1.0 / y;\n"
		    "\treturn front * sqrt(y) * (1.0 - r * (1.0 / 8.0 - r * (1.0 / 128.0"
		    " + r * (5.0 / 1024.0 - r * 21.0 / 32768.0))));\n}\n\n");
	/* Gamma(gamma - 1/2) / (sqrt(pi) Gamma(gamma - 1)); of GGX not kept. */
	derived(glsl, "mf_K", ndf->gamma == 2.0 ? 0.5 : ndf->K, "mf_gamma_moved",
		"mf_gamma_ratio(gamma_shape - 1.0) / 1.7724538509055160273");
	derived(glsl, "mf_2g_3", 2 * ndf->gamma - 3, "mf_gamma_moved", "2.0 * gamma_shape - 3.0");
	lines(glsl, "float mf_lambda(float c, float s)\n{\n"
		    "\tif (s * mf_sigma() * 1e12 < c)\n\t\treturn 0.0;\n"
		    "\tfloat K = mf_K();\n"
		    "\tfloat a = mf_a();\n"
		    "\tfloat g3 = mf_2g_3();\n"
		    "\tfloat z = c / (s * mf_sigma());\n"
		    "\tfloat u = z / sqrt(a);\n"
		    "\tfloat x = 1.0 / (1.0 + u * u);\n"
		    "\tfloat y = u * u * x;\n"
		    "\tfloat e = exp(-0.5 * g3 * mf_log_1p(u * u));\n"
		    "\tfloat front = K * e / (g3 * u);\n"
		    "\tif (z < 0.8) {\n"
		    "\t\tfloat term = 1.0;\n\t\tfloat sum = 1.0;\n"
		    "\t\tfor (int i = 0; i < 64; i++) {\n"
		    "\t\t\tterm *= y * (a + 0.5 + float(i)) / (1.5 + float(i));\n\t\t\tsum += term;\n"
		    "\t\t\tif (term < 1e-9 * sum)\n\t\t\t\tbreak;\n\t\t}\n"
		    "\t\treturn max((front - 0.5) + K * u * e * x * sum, 0.0);\n\t}\n"
		    "\tfloat tail = 0.0;\n"
		    "\tfor (int i = " FRACTION_STEPS "; i > 0; i--) {\n"
		    "\t\tfloat m = float(i);\n"
		    "\t\tfloat A = a + 2.0 * m;\n"
		    "\t\tfloat b = (a * (2.0 * m + 1.5) + 2.0 * m * m - 1.5) / ((A - 1.0) * (A + 1.0))\n"
		    "\t\t\t+ y * (m * (m + 0.5) / ((A - 1.0) * A) + (a + m) * (a + m - 0.5) / (A * (A + 1.0)));\n"
		    "\t\tfloat p = (a + m - 1.0) / (A - 1.0) * ((a + m - 1.5) / (A - 1.0))\n"
		    "\t\t\t* (m / (A - 2.0)) * ((m + 0.5) / A) * (x * x);\n"
		    "\t\ttail = p / (b - tail);\n\t}\n"
		    "\tfloat fraction = 1.0 / ((1.5 + (a - 0.5) * y) / (a + 1.0) - tail);\n"
		    "\treturn front / (2.0 * a) * fraction;\n}\n\n");
}

/* A cubic in z, as GLSL. */
static void write_cubic(struct glsl *glsl, const char *name, const double p[4])
{
	char text[4][CSV_NUMBER_SIZE];
	fprintf(glsl->file, "\tfloat %s = %s + z * (%s + z * (%s + z * %s));\n", name, literal(glsl, text[0], p[0]),
		literal(glsl, text[1], p[1]), literal(glsl, text[2], p[2]), literal(glsl, text[3], p[3]));
}

/* Eq. 22 of the STD paper; what depends on gamma alone is a constant. */
static void write_lambda_rational(struct glsl *glsl, const struct ndf *ndf)
{
	const struct lambda_rational r = lambda_form_rational(ndf->gamma, ndf->lambda_K);
	constant(glsl, "MF_FACTOR", r.factor);
	constant(glsl, "MF_S1", r.S1);
	constant(glsl, "MF_S22", r.S22);
	constant(glsl, "MF_S23", r.S23);
	if (!isinf(ndf->gamma))
		constant(glsl, "MF_a", ndf->gamma - 1);
	lines(glsl, "\nfloat mf_lambda(float c, float s)\n{\n"
		    "\tfloat z = min(c / max(s * mf_sigma(), 1e-12), 1e9);\n");
	write_cubic(glsl, "p21", lambda_form_p21);
	write_cubic(glsl, "q21", lambda_form_q21);
	write_cubic(glsl, "p24", lambda_form_p24);
	write_cubic(glsl, "q24", lambda_form_q24);
	fprintf(glsl->file,
		"\tfloat S1 = MF_S1 * exp(-%s) / z;\n"
		"\treturn max(MF_FACTOR * (S1 + p21 / q21 * (MF_S22 + MF_S23 * (p24 / q24))) - 0.5, 0.0);\n}\n\n",
		isinf(ndf->gamma) ? "z * z" : "(MF_a - 0.5) * mf_log_1p(z * z / MF_a)");
}

static void write_lambda_table(struct glsl *glsl, const struct lambda_table *table)
{
	constant(glsl, "MF_L0", table->L0);
	constant_array(glsl, "MF_L", table->L, table->n);
	fprintf(glsl->file,
		"\nfloat mf_lambda(float c, float s)\n{\n"
		"\tfloat mu = c / max(s, 1e-12);\n"
		"\tfloat x = (log2(mu) - %.1f) * %d.0;\n"
		"\tif (x <= 0.0)\n\t\treturn (MF_L0 - 0.5 * mu) / mu;\n"
		"\tif (x >= %d.0)\n\t\treturn MF_L[%d] / mu;\n"
		"\tint i = int(min(max(floor(x), 2.0), %d.0));\n"
		"\tfloat t = x - float(i);\n"
		"\tfloat a = (t + 2.0) * (t + 1.0);\n"
		"\tfloat b = t * (t - 1.0);\n"
		"\tfloat d = (t - 2.0) * (t - 3.0);\n"
		"\tfloat L = -MF_L[i - 2] * (t + 1.0) * b * d / 120.0 + MF_L[i - 1] * (t + 2.0) * b * d / 24.0\n"
		"\t\t- MF_L[i] * a * (t - 1.0) * d / 12.0 + MF_L[i + 1] * a * t * d / 12.0\n"
		"\t\t- MF_L[i + 2] * a * b * (t - 3.0) / 24.0 + MF_L[i + 3] * a * b * (t - 2.0) / 120.0;\n"
		"\treturn max(L, 0.0) / mu;\n}\n\n",
		table->log2_first, table->per_octave, table->n - 1, table->n - 1, table->n - 4);
}

static void write_lambda(struct glsl *glsl, const struct lambda_table *table)
{
	const struct ndf *ndf = &glsl->model->ndf;
	switch (lambda_kind(ndf)) {
	case LAMBDA_OF_GGX:
		lines(glsl, "float mf_lambda(float c, float s)\n{\n"
			    "\tfloat r = mf_sigma() * s;\n"
			    "\treturn 0.5 * r * (r / (c + sqrt(c * c + r * r))) / c;\n}\n\n");
		break;
	case LAMBDA_OF_BECKMANN:
		write_lambda_beckmann(glsl);
		break;
	case LAMBDA_OF_STUDENT_T:
		write_lambda_student_t(glsl);
		break;
	case LAMBDA_OF_EQ_22:
		write_lambda_rational(glsl, ndf);
		break;
	case LAMBDA_OF_TABLE:
		write_lambda_table(glsl, table);
		break;
	}
}

/* G, and the whole */

/* With axes D is that of a normal, Lambda that of a direction, whose x and y are scaled. */
static void write_lobe(struct glsl *glsl, bool axes)
{
	lines(glsl, glsl->model->fresnel == FRESNEL_F82 ? "vec3" : "float");
	lines(glsl, " mf_lobe(vec3 wi, vec3 wo)\n{\n"
		    "\tfloat size = length(wi + wo);\n"
		    "\tvec3 h = (wi + wo) / size;\n"
		    "\tfloat G = ");
	if (glsl->model->gaf == GAF_V_GROOVE)
		lines(glsl, "min(1.0, 4.0 * h.z * (min(wi.z, wo.z) / size))");
	else
		fprintf(glsl->file,
			glsl->model->gaf == GAF_CORRELATED
				? "1.0 / (1.0 + mf_lambda(wi.z, length(%s)) + mf_lambda(wo.z, length(%s)))"
				: "1.0 / ((1.0 + mf_lambda(wi.z, length(%s))) * (1.0 + mf_lambda(wo.z, length(%s))))",
			axes ? "(mf_turn(wi) * mf_stretch()).xy" : "wi.xy",
			axes ? "(mf_turn(wo) * mf_stretch()).xy" : "wo.xy");
	fprintf(glsl->file, ";\n\treturn mf_F(min(0.5 * size, 1.0)) * mf_D(%s) * G / (4.0 * wi.z) / wo.z;\n}\n\n",
		axes ? "mf_turn(h) / mf_stretch()" : "h");
}

/* Directions as the axes of the roughness see them, and how much longer each axis is than their mean. The half vector is
 * turned, not the directions that it is the sum of: that would cost it digits. */
static void write_axes(struct glsl *glsl)
{
	const struct ndf *ndf = &glsl->model->ndf;
	const double mean = roughness(ndf);
	const double c = ndf->angle == 0 ? 1 : ndf->turn_cos, s = ndf->angle == 0 ? 0 : ndf->turn_sin;
	char text[2][CSV_NUMBER_SIZE];
	fprintf(glsl->file,
		"vec3 mf_stretch()\n{\n\treturn mf_sigma_moved() ? vec3(sqrt(sigma_x / sigma_y), sqrt(sigma_y / "
		"sigma_x), 1.0) : vec3(%s, %s, 1.0);\n}\n\n",
		literal(glsl, text[0], ndf->sigma_x / mean), literal(glsl, text[1], ndf->sigma_y / mean));
	constant(glsl, "MF_COS", fabs(c) < 1e-30 ? 0 : c);
	constant(glsl, "MF_SIN", fabs(s) < 1e-30 ? 0 : s);
	lines(glsl, "\nvec3 mf_turn(vec3 w)\n{\n"
		    "\treturn vec3(MF_COS * w.x + MF_SIN * w.y, MF_COS * w.y - MF_SIN * w.x, w.z);\n}\n\n");
}

/* cook_torrance_grazing(). */
static void write_grazing(struct glsl *glsl)
{
	const double exponent = glsl->model->grazing;
	derived_rgb(glsl, "kg", glsl->model->kg);
	write_moved(glsl, "mf_exponent_moved", "exponent", exponent, NULL, 0);
	derived(glsl, "mf_exponent", exponent, "mf_exponent_moved", "exponent");
	lines(glsl, "float mf_power(float c)\n{\n"
		    "\treturn exp(mf_exponent() * log(max(1.0 - c, 1e-30)));\n}\n\n"
		    "float mf_grazing(vec3 wi, vec3 wo)\n{\n"
		    "\tfloat c = min(0.5 * length(wi + wo), 1.0);\n"
		    "\treturn c * c * (mf_power(wi.z) + mf_power(wo.z)) / MF_PI;\n}\n\n");
}

static void write_model(struct glsl *glsl)
{
	const struct cook_torrance *model = glsl->model;
	derived_rgb(glsl, "kd", model->kd);
	if (has_first(model))
		derived_rgb(glsl, "ks", model->ks);
	lines(glsl, "vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)\n{\n"
		    "\tvec3 wi = vec3(dot(L, X), dot(L, Y), dot(L, N));\n"
		    "\tvec3 wo = vec3(dot(V, X), dot(V, Y), dot(V, N));\n"
		    "\tif (wi.z <= 0.0 || wo.z <= 0.0)\n\t\treturn vec3(0.0);\n"
		    "\tvec3 f = vec3(0.0);\n"
		    "\tif (diffuse)\n\t\tf += mf_kd() / MF_PI;\n");
	if (cook_torrance_has_grazing(model))
		lines(glsl, "\tif (diffuse)\n\t\tf += mf_kg() * mf_grazing(wi, wo);\n");
	if (has_first(model))
		lines(glsl, "\tif (specular)\n\t\tf += mf_ks() * mf_lobe(wi, wo);\n");
	if (cook_torrance_has_second(model))
		lines(glsl, "\tif (specular)\n\t\tf += mf2_ks() * mf2_lobe(wi, wo);\n");
	lines(glsl, "\treturn f;\n}\n");
}

/* What the shader of one lobe is made of. */
struct lobe {
	struct cook_torrance model;
	struct lambda_table table; /* n = 0: none */
};

static enum status lobe_init(struct lobe *lobe, const struct cook_torrance *model)
{
	*lobe = (struct lobe){.model = *model};
	if (!has_first(model) || model->gaf == GAF_V_GROOVE || lambda_kind(&model->ndf) != LAMBDA_OF_TABLE)
		return STATUS_OK;
	return lambda_table_init(&lobe->table, &model->ndf);
}

static void write_table_error(FILE *file, const struct lambda_table *table)
{
	if (table->n)
		fprintf(file,
			"# Smith's Lambda is interpolated in a table of %d values; between them the error of G1 is at "
			"most %.1e\n",
			table->n, table->G1_error);
}

/* D, G and their product with F. */
static enum status write_lobe_functions(struct glsl *glsl, const struct lambda_table *table, struct error *error)
{
	const enum status status = write_D(glsl, error);
	if (glsl->model->gaf != GAF_V_GROOVE)
		write_lambda(glsl, table);
	if (export_has_axes(glsl->model))
		write_axes(glsl);
	write_lobe(glsl, export_has_axes(glsl->model));
	return status;
}

/* The sliders of the second lobe, or its functions. */
static enum status write_second_part(struct glsl *glsl, const struct lobe *second, bool sliders, struct error *error)
{
	char *text = NULL;
	size_t size;
	struct glsl part = {.file = open_memstream(&text, &size), .model = &second->model};
	enum status status = STATUS_OK;
	if (!part.file)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	if (sliders) {
		write_lobe_sliders(&part);
	} else {
		status = write_lobe_functions(&part, &second->table, error);
		derived_rgb(&part, "ks", second->model.ks);
	}
	const bool failed = ferror(part.file) != 0;
	if ((fclose(part.file) != 0 || failed) && status == STATUS_OK)
		status = error_set(error, STATUS_NO_MEMORY, "out of memory");
	if (status == STATUS_OK)
		write_second(glsl->file, text);
	glsl->out_of_range = glsl->out_of_range || part.out_of_range;
	free(text);
	return status;
}

static enum status write_shader(struct glsl *glsl, const struct export *export, const struct lobe *lobe,
				struct error *error)
{
	const struct cook_torrance *model = glsl->model;
	const bool two = cook_torrance_has_second(model);
	enum status status = STATUS_OK;
	lines(glsl, "analytic\n");
	export_comment(export, glsl->file, "# ", "");
	write_table_error(glsl->file, &lobe[0].table);
	write_table_error(glsl->file, &lobe[1].table);
	lines(glsl, "\n::begin parameters\nbool diffuse 1\nbool specular 1\n");
	write_sliders(glsl);
	if (two)
		status = write_second_part(glsl, &lobe[1], true, error);
	lines(glsl, "::end parameters\n\n::begin shader\n\nconst float MF_PI = 3.1415926535897932385;\n\n");
	lines(glsl, moved);
	if (has_first(model) || two)
		write_fresnel(glsl);
	if (has_first(model) && status == STATUS_OK)
		status = write_lobe_functions(glsl, &lobe[0].table, error);
	if (two && status == STATUS_OK)
		status = write_second_part(glsl, &lobe[1], false, error);
	if (cook_torrance_has_grazing(model))
		write_grazing(glsl);
	write_model(glsl);
	lines(glsl, "\n::end shader\n");
	if (status == STATUS_OK && glsl->out_of_range)
		status = error_set(error, STATUS_UNSUPPORTED,
				   "a constant of the model is out of the range of a shader's float");
	return status;
}

static enum status brdf_write(const struct export *export, FILE *file, struct error *error)
{
	const struct cook_torrance *model = &export->model, second = second_lobe(model);
	struct glsl glsl = {.file = file, .model = model};
	struct lobe lobe[2] = {{.table = {0}}, {.table = {0}}};
	enum status status = lobe_init(&lobe[0], model);
	if (status == STATUS_OK && cook_torrance_has_second(model))
		status = lobe_init(&lobe[1], &second);
	status = status == STATUS_OK ? write_shader(&glsl, export, lobe, error)
				     : error_set(error, status, "%s", status_str(status));
	lambda_table_free(&lobe[0].table);
	lambda_table_free(&lobe[1].table);
	return status;
}

static enum status brdf_prepare(struct export *export, struct error *error)
{
	if (export_max(export->model.ks) > 0 && ndf_is_tabulated(export->model.ndf.class) &&
	    export_has_axes(&export->model))
		return error_set(error, STATUS_UNSUPPORTED,
				 "the shader has no anisotropic table (--format bsdf and json have every model)");
	if (export_max(export->model.ks) > 0 && ndf_is_tilted(&export->model.ndf))
		return error_set(error, STATUS_UNSUPPORTED,
				 "the shader has no tilted facets (--format bsdf and json have every model)");
	if (export_max(export->model.ks) > 0 && export->model.per_channel_ior)
		return error_set(error, STATUS_UNSUPPORTED,
				 "the shader has no index for each channel (--format bsdf, merl and json have every "
				 "model)");
	if (cook_torrance_has_second(&export->model) &&
	    (ndf_is_tabulated(export->model.second.class) || ndf_has_tilt(export->model.second.class)))
		return error_set(error, STATUS_UNSUPPORTED,
				 "the shader has no second lobe of %s (--format bsdf and json have every model)",
				 ndf_name(export->model.second.class));
	if (ndf_has_tilt(export->model.ndf.class) && !ndf_plain(&export->model.ndf, &export->model.ndf))
		return error_set(error, STATUS_UNSUPPORTED, "the shader has no such ellipsoid");
	return export_as_it_is(
		export, "the model itself, in 32-bit floats (relative error 3e-6, in a tail where D is 1e-5 of its "
			"peak 4e-5)");
}

const struct export_target export_brdf = {.name = "brdf", .prepare = brdf_prepare, .write = brdf_write};
