/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mitsuba 3, XML: a blendbsdf of `diffuse` and `roughconductor`, which computes F D G / (4 cos_i cos_o) with Smith's G of
 * each direction apart, times specular_reflectance. Blend weights add up to 1 and reflectances must not exceed 1, so
 *     kd = (1 - w) reflectance,  ks = w specular_reflectance,  w = max ks / (max kd + max ks)
 * says every model with max kd + max ks <= 1. A conductor with k = 0 is the exact dielectric reflectance; without eta and
 * k it is a mirror, F = 1. */
#include "fit/export/export_format.h"
#include "fit/export/substitute.h"
#include "fit/results/csv_number.h"

static const struct target target = {
	.name = "Mitsuba 3",
	.beckmann = true,
	.gaf = GAF_UNCORRELATED,
	.fresnel = 1u << FRESNEL_DIELECTRIC | 1u << FRESNEL_CONDUCTOR | 1u << FRESNEL_NONE,
	.instead = FRESNEL_DIELECTRIC,
	.sigma_min = 1e-4,
	.blend = true,
	.itself = "bsdf-rgb",
};

static enum status mitsuba_prepare(struct export *export, struct error *error)
{
	const enum status status = substitute_prepare(export, &target, error);
	if (status != STATUS_OK)
		return status;
	if (export_max(export->model.kd) > 1)
		return error_set(error, STATUS_UNSUPPORTED, "Mitsuba 3 has no reflectance above 1: kd is up to %.5g",
				 export_max(export->model.kd));
	if (export->substitute)
		return STATUS_OK;
	if (export_max(export->model.ks) > 0 && isinf(export->model.ndf.gamma)) {
		snprintf(export->why, sizeof export->why,
			 "approximate: the model itself, but Mitsuba 3 computes Beckmann's G1 to 0.35 %%");
		return STATUS_OK;
	}
	return export_as_it_is(export, "the model itself, in the rgb variants of Mitsuba 3");
}

static void write_rgb(FILE *file, const char *indent, const char *name, const double rgb[3], double scale)
{
	char text[3][CSV_NUMBER_SIZE];
	fprintf(file, "%s<rgb name=\"%s\" value=\"%s, %s, %s\"/>\n", indent, name,
		csv_number(text[0], fmin(rgb[0] * scale, 1)), csv_number(text[1], fmin(rgb[1] * scale, 1)),
		csv_number(text[2], fmin(rgb[2] * scale, 1)));
}

static void write_value(FILE *file, const char *indent, const char *type, const char *name, double value)
{
	char text[CSV_NUMBER_SIZE];
	fprintf(file, "%s<%s name=\"%s\" value=\"%s\"/>\n", indent, type, name, csv_number(text, value));
}

/* id: the attribute, with its space; "" for none */
static void write_diffuse(FILE *file, const char *indent, const char *id, const double kd[3], double scale)
{
	char inner[16];
	snprintf(inner, sizeof inner, "%s\t", indent);
	fprintf(file, "%s<bsdf type=\"diffuse\"%s>\n", indent, id);
	write_rgb(file, inner, "reflectance", kd, scale);
	fprintf(file, "%s</bsdf>\n", indent);
}

static void write_lobe(FILE *file, const char *indent, const char *id, const struct cook_torrance *model, double scale)
{
	char inner[16];
	snprintf(inner, sizeof inner, "%s\t", indent);
	fprintf(file, "%s<bsdf type=\"roughconductor\"%s>\n", indent, id);
	fprintf(file, "%s<string name=\"distribution\" value=\"%s\"/>\n", inner, ndf_name(model->ndf.class));
	if (export_has_axes(model)) {
		write_value(file, inner, "float", "alpha_u", model->ndf.sigma_x);
		write_value(file, inner, "float", "alpha_v", model->ndf.sigma_y);
	} else {
		write_value(file, inner, "float", "alpha", model->ndf.sigma_x);
	}
	if (model->fresnel == FRESNEL_NONE) {
		fprintf(file, "%s<string name=\"material\" value=\"none\"/>\n", inner);
	} else {
		write_value(file, inner, "spectrum", "eta", model->n);
		write_value(file, inner, "spectrum", "k", model->fresnel == FRESNEL_CONDUCTOR ? model->k : 0);
	}
	write_rgb(file, inner, "specular_reflectance", model->ks, scale);
	fprintf(file, "%s</bsdf>\n", indent);
}

static enum status mitsuba_write(const struct export *export, FILE *file, struct error *error)
{
	const struct cook_torrance *model = &export->model;
	const double kd = export_max(model->kd), ks = export_max(model->ks), weight = ks / (kd + ks);
	char name[EXPORT_NAME], id[EXPORT_NAME + 8];
	(void)error;
	export_identifier(export, name);
	snprintf(id, sizeof id, " id=\"%s\"", name);
	export_comment(export, file, "<!-- ", " -->");
	export_comment_axes(export, file, "<!-- ", "alpha_u is the roughness along the shape's dp/du", " -->");
	fprintf(file, "<scene version=\"3.0.0\">\n");
	if (!(ks > 0)) {
		write_diffuse(file, "\t", id, model->kd, 1);
	} else if (!(kd > 0)) {
		write_lobe(file, "\t", id, model, 1);
	} else {
		/* The nested ones are taken in the order of their identifiers. */
		fprintf(file, "\t<bsdf type=\"blendbsdf\"%s>\n", id);
		write_value(file, "\t\t", "float", "weight", weight);
		write_diffuse(file, "\t\t", " name=\"bsdf_0\"", model->kd, 1 / (1 - weight));
		write_lobe(file, "\t\t", " name=\"bsdf_1\"", model, 1 / weight);
		fprintf(file, "\t</bsdf>\n");
	}
	fprintf(file, "</scene>\n");
	return STATUS_OK;
}

static bool replaces(const struct cook_torrance *model)
{
	return substitute_needed(&target, model, NULL) || export_max(model->kd) + export_max(model->ks) > 1;
}

const struct export_target export_mitsuba = {
	.name = "mitsuba", .prepare = mitsuba_prepare, .write = mitsuba_write, .replaces = replaces};
