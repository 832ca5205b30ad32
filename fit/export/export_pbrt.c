/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pbrt-v4: `mix` of `diffuse` and `conductor`, of which it takes the second with probability `amount`: the sum in
 * expectation,
 *     kd = (1 - w) reflectance,  ks = w.
 * The conductor is F D G / (4 cos_i cos_o) of GGX with the height-correlated G. Its eta and k are spectra: flat for a
 * gray ks; for a coloured one, of which w is the largest, they are those of three bands [spectrum_bands()], of which
 * each reflects at normal incidence what it has of ks F. Towards grazing incidence all reflect w. */
#include "fit/export/export_format.h"
#include "fit/export/substitute.h"
#include "fit/results/csv_number.h"

static const struct target target = {
	.name = "pbrt-v4",
	.gaf = GAF_CORRELATED,
	.fresnel = 1u << FRESNEL_DIELECTRIC | 1u << FRESNEL_CONDUCTOR,
	.instead = FRESNEL_DIELECTRIC,
	.sigma_min = 1e-3,
	.blend = true,
	.itself = "bsdf",
};

static bool is_gray(const double x[3])
{
	return x[0] == x[1] && x[1] == x[2];
}

/* The index with this reflectance at normal incidence: k of a conductor's n, or n of a dielectric. */
static void index_of(double reflectance, double *n, double *k)
{
	const double square = reflectance * (*n + 1) * (*n + 1) - (*n - 1) * (*n - 1), root = sqrt(reflectance);
	if (*k > 0 && square >= 0) {
		*k = sqrt(square / (1 - reflectance));
		return;
	}
	*n = (1 + root) / (1 - root);
	*k = 0;
}

static double complex_k(const struct cook_torrance *model)
{
	return model->fresnel == FRESNEL_CONDUCTOR ? model->k : 0;
}

static enum status find_bands(struct export *export, struct error *error)
{
	const struct cook_torrance *model = &export->model;
	struct export_bands *bands = &export->bands;
	const double k = complex_k(model), F0 = fresnel_conductor(1, model->n, k), w = export_max(model->ks);
	const enum status status = spectrum_bands(&bands->colour);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	bands->used = true;
	for (int b = 0; b < SPECTRUM_BANDS; b++) {
		double reflectance = 0;
		for (int c = 0; c < 3; c++)
			reflectance += bands->colour.from_rgb[b][c] * model->ks[c] / w * F0;
		bands->n[b] = model->n;
		bands->k[b] = k;
		index_of(fmin(fmax(reflectance, 0), 0.99), &bands->n[b], &bands->k[b]);
	}
	return STATUS_OK;
}

static void pbrt_f(const struct export *export, struct vec3 wi, struct vec3 wo, double f[3])
{
	struct cook_torrance model = export->model;
	const struct export_bands *bands = &export->bands;
	double cos_d;
	if (!bands->used || !(export_max(model.ks) > 0)) {
		cook_torrance_f(&model, wi, wo, f);
		return;
	}
	const double facets = export_max(model.ks) * cook_torrance_facets(&model.ndf, model.gaf, wi, wo, &cos_d);
	for (int c = 0; c < 3; c++) {
		f[c] = model.kd[c] * M_1_PI;
		for (int b = 0; b < SPECTRUM_BANDS; b++)
			f[c] += facets * bands->colour.to_rgb[c][b] *
				fresnel_conductor(cos_d, bands->n[b], bands->k[b]);
	}
}

/* A coloured ks, in bands. */
static enum status colour_lobe(struct export *export, struct error *error)
{
	struct measurement own;
	enum status status = find_bands(export, error);
	if (status != STATUS_OK)
		return status;
	if (!export->substitute)
		snprintf(export->why, sizeof export->why,
			 "approximate: pbrt-v4 has no ks of its own for each channel (format %s has the model itself)",
			 target.itself);
	export->substitute = true;
	substitute_add_why(export, "the colour of its ks is in the index of refraction");
	const struct measurement *measurement = substitute_measurement(&export->source, &own);
	status = measurement ? substitute_report(export, measurement, error)
			     : error_set(error, STATUS_NO_MEMORY, "out of memory");
	measurement_free(&own);
	return status;
}

/* With w = ks the diffuse reflectance kd / (1 - w) has to be at most 1, and without kd the rest reflects nothing. */
static enum status pbrt_prepare(struct export *export, struct error *error)
{
	const enum status status = substitute_prepare(export, &target, error);
	if (status != STATUS_OK)
		return status;
	if (export_max(export->model.kd) > 1)
		return error_set(error, STATUS_UNSUPPORTED, "pbrt-v4 has no reflectance above 1: kd is up to %.5g",
				 export_max(export->model.kd));
	if (!is_gray(export->model.ks))
		return colour_lobe(export, error);
	if (export->substitute)
		return STATUS_OK;
	if (!(export_max(export->model.ks) > 0))
		return export_as_it_is(export, "the model itself");
	return export_as_it_is(export,
			       "the model itself, in expectation: pbrt-v4 takes one of the two lobes at random");
}

static void write_diffuse(FILE *file, const double kd[3], double weight)
{
	char text[3][CSV_NUMBER_SIZE];
	const double scale = weight < 1 ? 1 / (1 - weight) : 0;
	fprintf(file, "\"string type\" \"diffuse\" \"rgb reflectance\" [ %s %s %s ]\n",
		csv_number(text[0], fmin(kd[0] * scale, 1)), csv_number(text[1], fmin(kd[1] * scale, 1)),
		csv_number(text[2], fmin(kd[2] * scale, 1)));
}

/* "spectrum NAME" with its value at all wavelengths, or in each band. */
static void write_spectrum(FILE *file, const char *name, const struct export_bands *bands, const double *band,
			   double flat)
{
	char text[CSV_NUMBER_SIZE];
	fprintf(file, " \"spectrum %s\" [ 200 %s", name, csv_number(text, bands->used ? band[0] : flat));
	for (int i = 1; i < 2 * SPECTRUM_BANDS - 1 && bands->used; i++)
		fprintf(file, " %g %s", spectrum_band_nm[i], csv_number(text, band[i / 2]));
	fprintf(file, " 1000 %s ]", csv_number(text, bands->used ? band[SPECTRUM_BANDS - 1] : flat));
}

static void write_lobe(FILE *file, const struct export *export)
{
	const struct cook_torrance *model = &export->model;
	char text[CSV_NUMBER_SIZE];
	fputs("\"string type\" \"conductor\"", file);
	write_spectrum(file, "eta", &export->bands, export->bands.n, model->n);
	write_spectrum(file, "k", &export->bands, export->bands.k, complex_k(model));
	fprintf(file, "\n    \"float %s\" %s", export_has_axes(model) ? "uroughness" : "roughness",
		csv_number(text, model->ndf.sigma_x));
	if (export_has_axes(model))
		fprintf(file, " \"float vroughness\" %s", csv_number(text, model->ndf.sigma_y));
	fprintf(file, " \"bool remaproughness\" false\n");
}

static enum status pbrt_write(const struct export *export, FILE *file, struct error *error)
{
	const struct cook_torrance *model = &export->model;
	char name[EXPORT_NAME], amount[CSV_NUMBER_SIZE];
	(void)error;
	export_identifier(export, name);
	export_comment(export, file, "# ", "");
	export_comment_axes(export, file, "# ", "uroughness is that along the shape's dp/du", "");
	fprintf(file, "MakeNamedMaterial \"%s_diffuse\" ", name);
	write_diffuse(file, model->kd, export_max(model->ks));
	if (!(export_max(model->ks) > 0)) {
		fprintf(file, "NamedMaterial \"%s_diffuse\"\n", name);
		return STATUS_OK;
	}
	fprintf(file, "MakeNamedMaterial \"%s_lobe\" ", name);
	write_lobe(file, export);
	fprintf(file,
		"MakeNamedMaterial \"%s\" \"string type\" \"mix\" \"string materials\" [ \"%s_diffuse\" \"%s_lobe\" "
		"]\n",
		name, name, name);
	fprintf(file, "    \"float amount\" %s\nNamedMaterial \"%s\"\n", csv_number(amount, export_max(model->ks)),
		name);
	return STATUS_OK;
}

static bool replaces(const struct cook_torrance *model)
{
	return substitute_needed(&target, model, NULL) || !is_gray(model->ks) ||
	       export_max(model->kd) + export_max(model->ks) > 1;
}

const struct export_target export_pbrt = {
	.name = "pbrt", .prepare = pbrt_prepare, .write = pbrt_write, .replaces = replaces, .shows = pbrt_f};
