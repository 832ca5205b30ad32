/* SPDX-License-Identifier: GPL-3.0-or-later */
/* export_format - one target each. Private to fit/export/. */
#ifndef EXPORT_FORMAT_H
#define EXPORT_FORMAT_H

#include "fit/export/export.h"

/* struct export_target - what a format supplies. */
struct export_target {
	const char *name;
	/* Fills model, substitute, why and cost of *export, whose source is set. Errors as export_prepare(). */
	enum status (*prepare)(struct export *export, struct error *error);
	/* As export_write(); NULL: EXPORT_MERL. */
	enum status (*write)(const struct export *export, FILE *file, struct error *error);
	/* Whether the model would be replaced; NULL: never. */
	bool (*replaces)(const struct cook_torrance *model);
	/* What the target makes of export->model in two directions above the horizon; NULL: cook_torrance_f(). */
	void (*shows)(const struct export *export, struct vec3 wi, struct vec3 wo, double f[3]);
};

extern const struct export_target export_brdf, export_merl, export_mitsuba, export_pbrt, export_gltf, export_json,
	export_bsdf, export_bsdf_rgb, export_materialx;

/* export_max - the largest of three channels. */
static inline double export_max(const double x[3])
{
	return fmax(x[0], fmax(x[1], x[2]));
}

/* export_has_axes - whether the model has a lobe and that is anisotropic. */
bool export_has_axes(const struct cook_torrance *model);

/* export_as_it_is - a prepare() for targets that take every model: why = "exact: " and the text. */
enum status export_as_it_is(struct export *export, const char *text);

/* export_describe - the model in one line, for people: material, NDF with its parameters, G, F. */
void export_describe(const struct export *export, char text[EXPORT_TEXT]);

/* export_comment - the lines that begin every text: why, cost, description; each between the two strings, in which
 * `--`, `"` and backslashes, for the sake of the formats' own comments, are replaced. */
void export_comment(const struct export *export, FILE *file, const char *before, const char *after);

/* export_comment_axes - of an anisotropic model one line more: along what the target has its first roughness. */
void export_comment_axes(const struct export *export, FILE *file, const char *before, const char *along,
			 const char *after);

/* export_identifier - the material's name of letters, digits and _ only; "material" if there is none. */
enum { EXPORT_NAME = 64 };
void export_identifier(const struct export *export, char name[EXPORT_NAME]);

#endif
