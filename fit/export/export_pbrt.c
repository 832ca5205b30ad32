/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pbrt-v4: `mix` of `diffuse` and `conductor`, of which it takes the second with probability `amount`: the sum in
 * expectation,
 *     kd = (1 - w) reflectance,  ks = w.
 * The conductor is F D G / (4 cos_i cos_o) of GGX with the height-correlated G; its eta and k are spectra, here flat. */
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
	.gray = true,
};

/* With w = ks the diffuse reflectance kd / (1 - w) has to be at most 1, and without kd the rest reflects nothing. */
static enum status pbrt_prepare(struct export *export, struct error *error)
{
	const enum status status = substitute_prepare(export, &target, error);
	if (status != STATUS_OK)
		return status;
	if (export_max(export->model.kd) > 1)
		return error_set(error, STATUS_UNSUPPORTED, "pbrt-v4 has no reflectance above 1: kd is up to %.5g",
				 export_max(export->model.kd));
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

static void write_lobe(FILE *file, const struct cook_torrance *model)
{
	char n[CSV_NUMBER_SIZE], k[CSV_NUMBER_SIZE], sigma[CSV_NUMBER_SIZE];
	csv_number(n, model->n);
	csv_number(k, model->fresnel == FRESNEL_CONDUCTOR ? model->k : 0);
	csv_number(sigma, model->ndf.sigma_x);
	fprintf(file,
		"\"string type\" \"conductor\" \"spectrum eta\" [ 200 %s 1000 %s ] \"spectrum k\" [ 200 %s 1000 %s ]\n",
		n, n, k, k);
	if (export_has_axes(model)) {
		char sigma_y[CSV_NUMBER_SIZE];

		fprintf(file, "    \"float uroughness\" %s \"float vroughness\" %s", sigma,
			csv_number(sigma_y, model->ndf.sigma_y));
	} else {
		fprintf(file, "    \"float roughness\" %s", sigma);
	}
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
	write_diffuse(file, model->kd, model->ks[0]);
	if (!(model->ks[0] > 0)) {
		fprintf(file, "NamedMaterial \"%s_diffuse\"\n", name);
		return STATUS_OK;
	}
	fprintf(file, "MakeNamedMaterial \"%s_lobe\" ", name);
	write_lobe(file, model);
	fprintf(file,
		"MakeNamedMaterial \"%s\" \"string type\" \"mix\" \"string materials\" [ \"%s_diffuse\" \"%s_lobe\" "
		"]\n",
		name, name, name);
	fprintf(file, "    \"float amount\" %s\nNamedMaterial \"%s\"\n", csv_number(amount, model->ks[0]), name);
	return STATUS_OK;
}

static bool replaces(const struct cook_torrance *model)
{
	return substitute_needed(&target, model, NULL) || export_max(model->kd) + export_max(model->ks) > 1;
}

const struct export_target export_pbrt = {
	.name = "pbrt", .prepare = pbrt_prepare, .write = pbrt_write, .replaces = replaces};
