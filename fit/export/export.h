/* SPDX-License-Identifier: GPL-3.0-or-later */
/* export - a model as other programs read it.
 *
 * Each target says what it can express. A model that it cannot is not bent to fit: one that it can is fitted in its
 * place (to the measurement, or to the model's own table), and the export says so, and what that costs in error. */
#ifndef EXPORT_H
#define EXPORT_H

#include "data_readers/spectrum.h"
#include "fit/search/fit.h"
#include <stdio.h>

enum export_format {
	EXPORT_BRDF,      /* BRDF Explorer, GLSL: every model */
	EXPORT_MERL,      /* MERL .binary: every model, to the resolution of the table */
	EXPORT_MITSUBA,   /* Mitsuba 3, XML: Lambert and GGX or Beckmann, uncorrelated G */
	EXPORT_PBRT,      /* pbrt-v4: Lambert and GGX, correlated G, one ks for all channels */
	EXPORT_GLTF,      /* glTF 2.0: always approximate */
	EXPORT_MATERIALX, /* MaterialX 1.39: Lambert and GGX, correlated G, every F */
	EXPORT_BSDF,     /* RGL tensor_file with spectra: pbrt-v4 and the spectral variants of Mitsuba 3, every model */
	EXPORT_BSDF_RGB, /* the same with rgb: the rgb variants of Mitsuba 3 */
	EXPORT_JSON,     /* our own (model_json.h): every model */
	EXPORT_FORMATS
};

/* export_format_name - "brdf", "merl", "mitsuba", "pbrt", "gltf", "materialx", "bsdf", "bsdf-rgb", "json"; "unknown" for any other value. */
const char *export_format_name(enum export_format format);
/* export_format_find - the reverse. Returns STATUS_DOMAIN, *format untouched, for another name. */
MUST_CHECK enum status export_format_find(const char *name, enum export_format *format);

/* struct export_source - a model and where it is from; all borrowed. */
struct export_source {
	const struct cook_torrance *model;
	const struct fit_options *fit;         /* weight, bins and max_theta it was fitted under; threads; cancel */
	double error;                          /* E under that weight; NaN: not known */
	enum weight weight;                    /* that of a fit in the model's place */
	const char *material, *path;           /* either may be NULL */
	const struct measurement *measurement; /* what it was fitted to; NULL: not at hand */
	double accuracy;                       /* EXPORT_BSDF: refined until the L1 error is this, percent, */
	double size;                           /* or the file would be larger than this, bytes */
};

enum { EXPORT_TEXT = 512 };

/* struct export_bands - an index of refraction for each band of a spectrum, which stands for a coloured ks. */
struct export_bands {
	bool used;
	double n[SPECTRUM_BANDS], k[SPECTRUM_BANDS];
	struct spectrum_bands colour;
};

/* struct export - what is going to be written. */
struct export
{
	enum export_format format;
	struct export_source source;
	struct cook_torrance model; /* the source's, or the one fitted in its place */
	bool substitute;            /* the latter */
	struct export_bands bands;  /* EXPORT_PBRT */
	char why[EXPORT_TEXT];      /* one line: "exact: ..." or "approximate: ..." */
	size_t nodes;               /* EXPORT_BSDF: half vectors along each side; 0 for others */
	char cost[EXPORT_TEXT];     /* one line: what the substitute costs in error; "" if there is none */
	char pictures[EXPORT_TEXT]; /* one line that the caller may put there: how it looks; "" at first */
};

/* export_wants_samples - whether a model has to be fitted in the place of this one, for which the measurement would be
 * of use. */
bool export_wants_samples(enum export_format format, const struct cook_torrance *model);

/* export_has_substitutes - whether the format has models that cannot be expressed and are replaced. */
bool export_has_substitutes(enum export_format format);

/* export_prepare - decides what is written, and fits it if need be. *source and what it points to have to outlive
 * *export.
 * Errors: STATUS_UNSUPPORTED: the target cannot express the model, nor anything in its place, `error` says why;
 * STATUS_NO_DATA, STATUS_NO_MEMORY, STATUS_INTERRUPTED. */
MUST_CHECK enum status export_prepare(struct export *export, enum export_format format,
				      const struct export_source *source, struct error *error);

/* export_is_binary - whether the format is no text: what it says about itself has to be told elsewhere too. */
bool export_is_binary(enum export_format format);

/* export_write - writes it, in any format but EXPORT_MERL. Errors in writing show in ferror().
 * Returns STATUS_OK, STATUS_UNSUPPORTED (a number of the model is out of the target's range), STATUS_NO_MEMORY. */
MUST_CHECK enum status export_write(const struct export *export, FILE *file, struct error *error);

/* export_table - EXPORT_MERL: the table to write, 180 entries along phi_d, to be freed with measurement_free(). */
MUST_CHECK enum status export_table(const struct export *export, struct measurement *measurement);

/* export_shows_model - whether what the target shows is export->model by cook_torrance_f(). */
bool export_shows_model(const struct export *export);

/* export_shown_f - what the target shows, 1/sr; wi, wo above the horizon. `export` is a struct export. */
void export_shown_f(const void *export, struct vec3 wi, struct vec3 wo, double f[3]);

#endif
