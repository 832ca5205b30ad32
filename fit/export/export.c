/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/text_quote.h"
#include "fit/error/model_table.h"
#include "fit/export/export_format.h"
#include "fit/results/csv_number.h"

#include <string.h>

static const struct export_target *const targets[EXPORT_FORMATS] = {
	[EXPORT_BRDF] = &export_brdf, [EXPORT_MERL] = &export_merl,         [EXPORT_MITSUBA] = &export_mitsuba,
	[EXPORT_PBRT] = &export_pbrt, [EXPORT_GLTF] = &export_gltf,         [EXPORT_JSON] = &export_json,
	[EXPORT_BSDF] = &export_bsdf, [EXPORT_BSDF_RGB] = &export_bsdf_rgb, [EXPORT_MATERIALX] = &export_materialx,
};

const char *export_format_name(enum export_format format)
{
	return format < EXPORT_FORMATS ? targets[format]->name : "unknown";
}

enum status export_format_find(const char *name, enum export_format *format)
{
	for (enum export_format f = 0; f < EXPORT_FORMATS; f++)
		if (!strcmp(name, targets[f]->name)) {
			*format = f;
			return STATUS_OK;
		}
	return STATUS_DOMAIN;
}

bool export_wants_samples(enum export_format format, const struct cook_torrance *model)
{
	return targets[format]->replaces && targets[format]->replaces(model);
}

bool export_has_substitutes(enum export_format format)
{
	return targets[format]->replaces != NULL;
}

bool export_is_binary(enum export_format format)
{
	return format == EXPORT_MERL || format == EXPORT_BSDF || format == EXPORT_BSDF_RGB;
}

enum status export_prepare(struct export *export, enum export_format format, const struct export_source *source,
			   struct error *error)
{
	*export = (struct export){.format = format, .source = *source, .model = *source->model};
	return targets[format]->prepare(export, error);
}

enum status export_write(const struct export *export, FILE *file, struct error *error)
{
	return targets[export->format]->write(export, file, error);
}

enum status export_table(const struct export *export, struct measurement *measurement)
{
	return model_table(&export->model, export->source.fit->criterion.bins, 180, 90, export->source.fit->threads,
			   measurement);
}

bool export_shows_model(const struct export *export)
{
	return !targets[export->format]->shows;
}

void export_shown_f(const void *export, struct vec3 wi, struct vec3 wo, double f[3])
{
	const struct export *shown = export;
	if (export_shows_model(shown))
		cook_torrance_f(&shown->model, wi, wo, f);
	else
		targets[shown->format]->shows(shown, wi, wo, f);
}

bool export_has_axes(const struct cook_torrance *model)
{
	return export_max(model->ks) > 0 && ndf_is_anisotropic(&model->ndf);
}

enum status export_as_it_is(struct export *export, const char *text)
{
	snprintf(export->why, sizeof export->why, "exact: %.480s", text);
	return STATUS_OK;
}

static enum status merl_prepare(struct export *export, struct error *error)
{
	char text[EXPORT_TEXT];
	if (export_has_axes(&export->model))
		return error_set(error, STATUS_UNSUPPORTED,
				 "a MERL file is isotropic, the model is not (--format bsdf has every model)");
	snprintf(text, sizeof text, "the model at the entries of the table (%s bins), to the 24 bits of a float",
		 bins_name(export->source.fit->criterion.bins));
	return export_as_it_is(export, text);
}

const struct export_target export_merl = {.name = "merl", .prepare = merl_prepare};

/* Text that the formats share */

void export_describe(const struct export *export, char text[EXPORT_TEXT])
{
	const struct cook_torrance *model = &export->model;
	char name[TEXT_QUOTE_SIZE] = "a model", number[CSV_NUMBER_SIZE], k[CSV_NUMBER_SIZE];
	int used;
	if (export->source.material)
		text_quote(export->source.material, name, sizeof name);
	if (!(export_max(model->ks) > 0)) {
		snprintf(text, EXPORT_TEXT, "%s: Lambert alone, no specular term", name);
		return;
	}
	used = snprintf(text, EXPORT_TEXT, "%s: %s", name, ndf_name(model->ndf.class));
	const bool axes = export_has_axes(model);
	for (int i = axes; ndf_param_at(model->ndf.class, i); i++)
		used += snprintf(text + used, (size_t)(EXPORT_TEXT - used), " %s %s",
				 ndf_param_at(model->ndf.class, i)->name, csv_number(number, model->ndf.param[i]));
	if (axes && ndf_is_tabulated(model->ndf.class)) {
		used += snprintf(text + used, (size_t)(EXPORT_TEXT - used), " of two tables, angle %s",
				 csv_number(number, model->ndf.angle));
	} else if (axes) {
		char sigma_y[CSV_NUMBER_SIZE], angle[CSV_NUMBER_SIZE];
		used += snprintf(text + used, (size_t)(EXPORT_TEXT - used), " sigma_x %s sigma_y %s angle %s",
				 csv_number(number, model->ndf.sigma_x), csv_number(sigma_y, model->ndf.sigma_y),
				 csv_number(angle, model->ndf.angle));
	}
	if (axes && ndf_is_tilted(&model->ndf)) {
		char tilt_y[CSV_NUMBER_SIZE];
		used += snprintf(text + used, (size_t)(EXPORT_TEXT - used), " tilt %s,%s",
				 csv_number(number, model->ndf.tilt_x), csv_number(tilt_y, model->ndf.tilt_y));
	}
	used += snprintf(text + used, (size_t)(EXPORT_TEXT - used), ", %s G, %s F", gaf_name(model->gaf),
			 fresnel_name(model->fresnel));
	for (int c = 0; c < MERL_CHANNELS && model->per_channel_ior; c++)
		used += snprintf(text + used, (size_t)(EXPORT_TEXT - used), ", %c: n %s k %s", "RGB"[c],
				 csv_number(number, model->channel_n[c]), csv_number(k, model->channel_k[c]));
	if (fresnel_has_ior(model->fresnel) && !model->per_channel_ior)
		used += snprintf(text + used, (size_t)(EXPORT_TEXT - used), ", n %s", csv_number(number, model->n));
	if (model->fresnel == FRESNEL_CONDUCTOR && !model->per_channel_ior)
		used += snprintf(text + used, (size_t)(EXPORT_TEXT - used), ", k %s", csv_number(number, model->k));
	if (cook_torrance_has_second(model))
		snprintf(text + used, (size_t)(EXPORT_TEXT - used), ", and a second lobe, sigma %s",
			 csv_number(number, model->second.sigma_x));
}

static void comment_line(FILE *file, const char *before, const char *text, const char *after)
{
	fputs(before, file);
	for (const char *at = text; *at; at++)
		fputc((*at == '-' && at[1] == '-') || *at == '\\' || *at == '"' ? '_' : *at, file);
	fprintf(file, "%s\n", after);
}

void export_comment(const struct export *export, FILE *file, const char *before, const char *after)
{
	char text[EXPORT_TEXT];
	comment_line(file, before, export->why, after);
	if (*export->cost)
		comment_line(file, before, export->cost, after);
	if (*export->pictures)
		comment_line(file, before, export->pictures, after);
	export_describe(export, text);
	comment_line(file, before, text, after);
	snprintf(text, sizeof text, "written by stdfit %s", STDFIT_VERSION);
	comment_line(file, before, text, after);
}

void export_comment_axes(const struct export *export, FILE *file, const char *before, const char *along,
			 const char *after)
{
	char text[EXPORT_TEXT], angle[CSV_NUMBER_SIZE];
	if (!export_has_axes(&export->model))
		return;
	snprintf(text, sizeof text, "%.200s, which has to lie at azimuth %s degrees of the sample", along,
		 csv_number(angle, export->model.ndf.angle));
	comment_line(file, before, text, after);
}

void export_identifier(const struct export *export, char name[EXPORT_NAME])
{
	const char *from = export->source.material && *export->source.material ? export->source.material : "material";
	int n = 0;
	for (; *from && n < EXPORT_NAME - 1; from++) {
		const bool plain = (*from >= '0' && *from <= '9') || (*from >= 'a' && *from <= 'z') ||
				   (*from >= 'A' && *from <= 'Z');
		name[n++] = (char)(plain ? *from : '_');
	}
	name[n] = '\0';
}
