/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/text_quote.h"
#include "fit/export/export_format.h"
#include "fit/export/model_json.h"
#include "fit/results/csv_number.h"

#include <string.h>

static void write_number(FILE *file, double x)
{
	char text[CSV_NUMBER_SIZE];
	csv_number(text, x);
	fputs(isnan(x) ? "null" : isinf(x) ? (x > 0 ? "\"inf\"" : "\"-inf\"") : text, file);
}

/* What is no UTF-8 becomes U+FFFD. */
static void write_string(FILE *file, const char *text)
{
	if (!text) {
		fputs("null", file);
		return;
	}
	fputc('"', file);
	while (*text) {
		uint32_t code;
		const size_t length = text_character(text, &code);
		if (*text == '"' || *text == '\\')
			fputc('\\', file);
		if (text_printable(text))
			fwrite(text, 1, length, file);
		else if (length)
			fprintf(file, "\\u%04x", (unsigned)code);
		else
			fputs("\xef\xbf\xbd", file);
		text += length ? length : 1;
	}
	fputc('"', file);
}

static void write_rgb(FILE *file, const char *name, const double rgb[3])
{
	fprintf(file, "  \"%s\": [", name);
	for (int c = 0; c < 3; c++) {
		fputs(c ? ", " : "", file);
		write_number(file, rgb[c]);
	}
	fputs("],\n", file);
}

static void write_parameter(FILE *file, const char *before, const char *name, double value)
{
	fprintf(file, "%s\"%s\": ", before, name);
	write_number(file, value);
}

static double node_theta(const struct pwl_node *node)
{
	return node->theta;
}

/* D itself where the distribution is isotropic; else what is normalised again. */
static double node_x(const struct pwl_node *node)
{
	return node->Fx;
}

static double node_y(const struct pwl_node *node)
{
	return node->Fy;
}

/* Where D of one axis plays no part, any will do that is not 0 at the normal. */
static double node_any(const struct pwl_node *node)
{
	(void)node;
	return 1;
}

static void write_array(FILE *file, const char *before, const struct pwl *pwl,
			double (*value)(const struct pwl_node *node))
{
	fputs(before, file);
	for (int i = 0; i < pwl->n_nodes; i++) {
		fputs(i ? ", " : "", file);
		write_number(file, value(&pwl->nodes[i]));
	}
	fputs("]", file);
}

static void write_nodes(FILE *file, const struct ndf *ndf)
{
	const struct pwl *pwl = ndf->pwl;
	const struct pwl_node *last = &pwl->nodes[pwl->n_nodes - 1];
	write_array(file, "  \"nodes\": {\n    \"theta\": [", pwl, node_theta);
	write_array(file, ",\n    \"D\": [", pwl, last->mass_x > 0 ? node_x : node_any);
	if (pwl->anisotropic) {
		write_array(file, ",\n    \"Dy\": [", pwl, last->mass_y > 0 ? node_y : node_any);
		write_parameter(file, ",\n    ", "angle", ndf->angle);
	}
	fputs("\n  },\n", file);
}

static void write_parameters(FILE *file, const struct ndf *ndf)
{
	fputs("\"parameters\": {", file);
	for (int i = 0; ndf_param_at(ndf->class, i); i++)
		write_parameter(file, i ? ", " : "", ndf_param_at(ndf->class, i)->name, ndf->param[i]);
	if (ndf_is_anisotropic(ndf)) {
		write_parameter(file, ", ", "sigma_y", ndf->sigma_y);
		write_parameter(file, ", ", "angle", ndf->angle);
	}
	if (ndf_is_tilted(ndf)) {
		write_parameter(file, ", ", "tilt_x", ndf->tilt_x);
		write_parameter(file, ", ", "tilt_y", ndf->tilt_y);
	}
	fputs("}", file);
}

static void write_ndf(FILE *file, const struct ndf *ndf)
{
	fprintf(file, "  \"ndf\": \"%s\",\n", ndf_name(ndf->class));
	if (ndf_is_tabulated(ndf->class)) {
		write_nodes(file, ndf);
	} else {
		fputs("  ", file);
		write_parameters(file, ndf);
		fputs(",\n", file);
	}
	fprintf(file, "  \"lambda\": \"%s\",\n", lambda_form_name(ndf->lambda_form));
}

/* What richer models have besides. */
static void write_terms(FILE *file, const struct cook_torrance *model)
{
	static const char *const name[F82_PARTS] = {"f0", "f82", "f90"};
	for (int i = 0; i < F82_PARTS && model->fresnel == FRESNEL_F82; i++) {
		const double part[3] = {model->reflectance[0][i], model->reflectance[1][i], model->reflectance[2][i]};
		write_rgb(file, name[i], part);
	}
	if (cook_torrance_has_grazing(model)) {
		write_rgb(file, "kg", model->kg);
		write_parameter(file, "  ", "exponent", model->grazing);
		fputs(",\n", file);
	}
	if (cook_torrance_has_second(model)) {
		write_rgb(file, "ks2", model->ks_second);
		fputs("  \"second\": {", file);
		write_parameters(file, &model->second);
		fputs("},\n", file);
	}
}

static void write_index(FILE *file, const struct cook_torrance *model)
{
	if (model->per_channel_ior) {
		write_rgb(file, "ior", model->channel_n);
		write_rgb(file, "k", model->channel_k);
		return;
	}
	write_parameter(file, "  ", "ior", model->n);
	write_parameter(file, ",\n  ", "k", model->k);
	fputs(",\n", file);
}

static void write_fitted(FILE *file, const struct export_source *source)
{
	fputs("  \"fitted\": {\"path\": ", file);
	write_string(file, source->path);
	fprintf(file,
		", \"weight\": \"%s\", \"bins\": \"%s\", \"max_theta\": ", weight_name(source->fit->criterion.weight),
		bins_name(source->fit->criterion.bins));
	write_number(file, source->fit->criterion.max_theta);
	if (source->fit->criterion.zero_is_missing)
		fputs(", \"zero_is_missing\": true", file);
	fputs(", \"error\": ", file);
	write_number(file, source->error);
	fputs("}\n", file);
}

static enum status json_write(const struct export *export, FILE *file, struct error *error)
{
	const struct cook_torrance *model = &export->model;
	(void)error;
	fputs("{\n  \"format\": \"stdfit-model-1\",\n  \"comment\": [\n", file);
	export_comment(export, file, "    \"", "\",");
	fputs("    \"\"\n  ],\n  \"material\": ", file);
	write_string(file, export->source.material);
	fputs(",\n", file);
	write_rgb(file, "kd", model->kd);
	write_rgb(file, "ks", model->ks);
	write_ndf(file, &model->ndf);
	fprintf(file, "  \"gaf\": \"%s\",\n  \"fresnel\": \"%s\",\n", gaf_name(model->gaf),
		fresnel_name(model->fresnel));
	write_index(file, model);
	write_terms(file, model);
	write_fitted(file, &export->source);
	fputs("}\n", file);
	return STATUS_OK;
}

static enum status json_prepare(struct export *export, struct error *error)
{
	(void)error;
	return export_as_it_is(export, "all parameters, in digits that read back to the bit");
}

const struct export_target export_json = {.name = "json", .prepare = json_prepare, .write = json_write};
