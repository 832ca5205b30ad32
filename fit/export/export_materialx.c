/* SPDX-License-Identifier: GPL-3.0-or-later */
/* MaterialX 1.39: the sum, by `add`, of a diffuse BSDF of roughness 0, which is Lambert, and a microfacet BSDF of GGX with the
 * height-correlated G [PBR nodes of the specification]. Its roughness is (alpha_x, alpha_y): our sigma, not its root. F is in
 *     dielectric_bsdf           the exact dielectric form; ks is the tint
 *     conductor_bsdf            the exact conductor form, times ks by `multiply`
 *     generalized_schlick_bsdf  color0 + (color90 - color0) (1 - c)^exponent - a c (1 - c)^6,
 *                               a such that color82 is what this curve is multiplied by at c = 1/7; c = cos_d
 * The last says schlick (color0 = ks F0, color90 = ks, color82 = 1) and none (color0 = color90 = ks).
 *
 * OpenPBR's node has the same microfacet BSDFs, but lays them over the diffuse part, which loses what they reflect: our sum is
 * nearer to the nodes. Colours are linear with the primaries of sRGB. */
#include "fit/export/export_format.h"
#include "fit/export/substitute.h"
#include "fit/results/csv_number.h"
#include "src/energy.h"

#include <string.h>

static const struct target target = {
	.name = "MaterialX",
	.gaf = GAF_CORRELATED,
	.fresnel = 1u << FRESNEL_DIELECTRIC | 1u << FRESNEL_CONDUCTOR | 1u << FRESNEL_SCHLICK | 1u << FRESNEL_NONE |
		   1u << FRESNEL_F82,
	.instead = FRESNEL_DIELECTRIC,
	.sigma_max = 1,
	.channel_ior = true,
};

/* Cosine-weighted mean of F over the hemisphere. */
static double mean_fresnel(const struct cook_torrance *model)
{
	enum { N = 256 };
	double sum = 0;
	for (int i = 0; i < N; i++) {
		const double c = (i + 0.5) / N;
		for (int channel = 0; channel < 3; channel++)
			sum += 2 * c * cook_torrance_F(model, channel, c) / N;
	}
	return sum / 3;
}

/* Implementations are expected to give rough surfaces back what facets reflect more than once, by a factor on the lobe: by how
 * much, seen along the normal, with the specification's formula; 0 for none, and of anisotropic lobes. */
static double compensation(const struct cook_torrance *model)
{
	struct cook_torrance mirror = *model;
	double albedo = 1;
	mirror.fresnel = FRESNEL_NONE;
	if (!(export_max(model->ks) > 0) || energy_lobe(&mirror, 1, &albedo) != STATUS_OK)
		return 0;
	return mean_fresnel(model) * (1 - albedo) / albedo;
}

static enum status materialx_prepare(struct export *export, struct error *error)
{
	const enum status status = substitute_prepare(export, &target, error);
	if (status != STATUS_OK)
		return status;
	if (export_max(export->model.kd) > 1)
		return error_set(error, STATUS_UNSUPPORTED, "MaterialX has no reflectance above 1: kd is up to %.5g",
				 export_max(export->model.kd));
	if (!export->substitute && export_has_axes(&export->model))
		snprintf(export->why, sizeof export->why,
			 "approximate: the model itself, but MaterialX computes G of an anisotropic lobe from the mean "
			 "roughness");
	else if (!export->substitute)
		export_as_it_is(export, "the model itself");
	const size_t used = strlen(export->why);
	const double more = compensation(&export->model);
	if (more > 0)
		snprintf(export->why + used, sizeof export->why - used,
			 "; a renderer that makes up for further reflections between facets shows %.2g %% more of the "
			 "lobe along the normal",
			 100 * more);
	return STATUS_OK;
}

/* An input with a value of one number or three. */
static void write_number(FILE *file, const char *name, double x)
{
	char text[CSV_NUMBER_SIZE];
	fprintf(file, "\t\t<input name=\"%s\" type=\"float\" value=\"%s\"/>\n", name, csv_number(text, x));
}

static void write_color(FILE *file, const char *name, const double rgb[3], double scale)
{
	char text[3][CSV_NUMBER_SIZE];
	fprintf(file, "\t\t<input name=\"%s\" type=\"color3\" value=\"%s, %s, %s\"/>\n", name,
		csv_number(text[0], rgb[0] * scale), csv_number(text[1], rgb[1] * scale),
		csv_number(text[2], rgb[2] * scale));
}

/* An input that is another node of this material. */
static void write_link(FILE *file, const char *name, const char *type, const char *material, const char *node)
{
	fprintf(file, "\t\t<input name=\"%s\" type=\"%s\" nodename=\"%s%s\"/>\n", name, type, material, node);
}

static void begin_node(FILE *file, const char *element, const char *type, const char *material, const char *node)
{
	fprintf(file, "\t<%s name=\"%s%s\" type=\"%s\">\n", element, material, node, type);
}

static void end_node(FILE *file, const char *element)
{
	fprintf(file, "\t</%s>\n", element);
}

static const char *lobe_element(enum fresnel fresnel)
{
	switch (fresnel) {
	case FRESNEL_DIELECTRIC:
		return "dielectric_bsdf";
	case FRESNEL_CONDUCTOR:
		return "conductor_bsdf";
	default:
		return "generalized_schlick_bsdf";
	}
}

/* The node has the reflectance at c = 1/7 as a factor of what Schlick's form has there. */
static void write_f82(FILE *file, const struct cook_torrance *model)
{
	double color0[3], color82[3], color90[3];
	for (int c = 0; c < 3; c++) {
		const double *F = model->reflectance[c], schlick = F[0] + (F[2] - F[0]) * pow(6.0 / 7, 5);
		color0[c] = model->ks[c] * F[0];
		color82[c] = schlick > 0 ? F[1] / schlick : 1;
		color90[c] = model->ks[c] * F[2];
	}
	write_color(file, "color0", color0, 1);
	write_color(file, "color82", color82, 1);
	write_color(file, "color90", color90, 1);
	write_number(file, "exponent", 5);
}

static void write_schlick(FILE *file, const struct cook_torrance *model)
{
	static const double white[3] = {1, 1, 1};
	const double F0 = fresnel_F(model->fresnel, 1, model->n, model->k);
	write_color(file, "color0", model->ks, F0);
	write_color(file, "color82", white, 1);
	write_color(file, "color90", model->ks, 1);
	write_number(file, "exponent", 5);
}

/* The lobe with its ks, as the node `_lobe`. */
static void write_lobe(FILE *file, const struct cook_torrance *model, const char *material)
{
	static const double white[3] = {1, 1, 1};
	const bool conductor = model->fresnel == FRESNEL_CONDUCTOR;
	const char *element = lobe_element(model->fresnel);
	char text[2][CSV_NUMBER_SIZE];
	begin_node(file, element, "BSDF", material, conductor ? "_metal" : "_lobe");
	if (conductor) {
		write_color(file, "ior", model->per_channel_ior ? model->channel_n : white,
			    model->per_channel_ior ? 1 : model->n);
		write_color(file, "extinction", model->per_channel_ior ? model->channel_k : white,
			    model->per_channel_ior ? 1 : model->k);
	} else if (model->fresnel == FRESNEL_DIELECTRIC) {
		write_color(file, "tint", model->ks, 1);
		write_number(file, "ior", model->n);
	} else if (model->fresnel == FRESNEL_F82) {
		write_f82(file, model);
	} else {
		write_schlick(file, model);
	}
	fprintf(file, "\t\t<input name=\"roughness\" type=\"vector2\" value=\"%s, %s\"/>\n",
		csv_number(text[0], model->ndf.sigma_x), csv_number(text[1], model->ndf.sigma_y));
	end_node(file, element);
	if (!conductor)
		return;
	begin_node(file, "multiply", "BSDF", material, "_lobe");
	write_link(file, "in1", "BSDF", material, "_metal");
	write_color(file, "in2", model->ks, 1);
	end_node(file, "multiply");
}

static void write_diffuse(FILE *file, const struct cook_torrance *model, const char *material)
{
	begin_node(file, "oren_nayar_diffuse_bsdf", "BSDF", material, "_diffuse");
	write_color(file, "color", model->kd, 1);
	write_number(file, "roughness", 0);
	end_node(file, "oren_nayar_diffuse_bsdf");
}

/* The nodes of the BSDF; returns what the name of the last one ends with. */
static const char *write_bsdf(FILE *file, const struct cook_torrance *model, const char *material)
{
	const bool diffuse = export_max(model->kd) > 0, lobe = export_max(model->ks) > 0;
	if (diffuse || !lobe)
		write_diffuse(file, model, material);
	if (!lobe)
		return "_diffuse";
	write_lobe(file, model, material);
	if (!diffuse)
		return "_lobe";
	begin_node(file, "add", "BSDF", material, "_sum");
	write_link(file, "in1", "BSDF", material, "_diffuse");
	write_link(file, "in2", "BSDF", material, "_lobe");
	end_node(file, "add");
	return "_sum";
}

static enum status materialx_write(const struct export *export, FILE *file, struct error *error)
{
	char identifier[EXPORT_NAME], material[EXPORT_NAME + 1];
	(void)error;
	export_identifier(export, identifier);
	/* A name does not begin with a digit. */
	snprintf(material, sizeof material, "%s%s", *identifier >= '0' && *identifier <= '9' ? "_" : "", identifier);
	export_comment(export, file, "<!-- ", " -->");
	export_comment_axes(export, file, "<!-- ", "the first roughness is that along the tangent Tworld", " -->");
	fprintf(file, "<materialx version=\"1.39\" colorspace=\"lin_rec709\">\n");
	const char *bsdf = write_bsdf(file, &export->model, material);
	begin_node(file, "surface", "surfaceshader", material, "_surface");
	write_link(file, "bsdf", "BSDF", material, bsdf);
	end_node(file, "surface");
	begin_node(file, "surfacematerial", "material", material, "");
	write_link(file, "surfaceshader", "surfaceshader", material, "_surface");
	end_node(file, "surfacematerial");
	fprintf(file, "</materialx>\n");
	return STATUS_OK;
}

static bool replaces(const struct cook_torrance *model)
{
	return substitute_needed(&target, model, NULL);
}

const struct export_target export_materialx = {
	.name = "materialx", .prepare = materialx_prepare, .write = materialx_write, .replaces = replaces};
