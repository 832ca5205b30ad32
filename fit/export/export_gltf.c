/* SPDX-License-Identifier: GPL-3.0-or-later */
/* glTF 2.0 with KHR_materials_ior and KHR_materials_specular. Its dielectric is no sum but a layer,
 *     f_c = (1 - max F) baseColor_c / pi + F_c D G / (4 cos_i cos_o),
 *     F_c = s (F0_c + (1 - F0_c) (1 - cos_d)^5),  F0_c = min(1, ((n-1)/(n+1))^2 specularColor_c),
 * D of GGX with sigma = roughness^2, G height-correlated. So every export with a lobe is approximate, and is fitted in
 * these terms [gltf_fit.h]. specularFactor s is 1 (0 without a lobe), since not every importer reads it; ks is specularColor.
 *
 * KHR_materials_anisotropy: along the tangent, turned counter-clockwise by anisotropyRotation, the roughness is
 * mix(sigma, 1, anisotropyStrength^2), the larger one; across it is sigma. */
#include "fit/export/export_format.h"
#include "fit/export/gltf_fit.h"
#include "fit/export/substitute.h"
#include "fit/results/csv_number.h"

#include <string.h>

static const struct target target = {
	.name = "glTF",
	.gaf = GAF_CORRELATED,
	.fresnel = 1u << FRESNEL_SCHLICK,
	.instead = FRESNEL_SCHLICK,
	.sigma_max = 1,
};

/* The model as a material, and back: F0_c = F0(n) ks_c. */
static double reflectance(double n)
{
	return (n - 1) / (n + 1) * ((n - 1) / (n + 1));
}

static struct gltf_material material_of(const struct cook_torrance *model)
{
	struct gltf_material material = {.ndf = model->ndf, .specular = export_max(model->ks) > 0};
	for (int c = 0; c < 3; c++) {
		material.base[c] = model->kd[c];
		material.F0[c] = fmin(reflectance(model->n) * model->ks[c], 1);
	}
	return material;
}

static void set_material(struct cook_torrance *model, const struct gltf_material *material)
{
	const double F0 = export_max(material->F0), root = sqrt(fmin(F0, 0.99));
	model->ndf = material->ndf;
	model->n = (1 + root) / (1 - root);
	for (int c = 0; c < 3; c++) {
		model->kd[c] = material->base[c];
		model->ks[c] = F0 > 0 ? material->F0[c] / (root * root) : 1;
	}
}

/* What a viewer makes of the model. */
static void gltf_f(const struct export *export, struct vec3 wi, struct vec3 wo, double f[3])
{
	const struct gltf_material material = material_of(&export->model);
	gltf_material_f(&material, wi, wo, f);
}

static bool is_gray(const double x[3])
{
	return x[0] == x[1] && x[1] == x[2];
}

/* Fits the material in its own terms, from the model on. */
static enum status fit_material(struct export *export, const struct measurement *measurement, struct error *error)
{
	const struct fit_options *fit = export->source.fit;
	const struct cook_torrance *model = export->source.model;
	struct criterion criterion = fit->criterion;
	struct gltf_material material = material_of(&export->model);
	criterion.weight = export->source.weight;
	if (material.specular && gltf_fit(measurement, &criterion, fit->threads,
					  is_gray(model->kd) && is_gray(model->ks), &material) != STATUS_OK)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	if (material.specular)
		set_material(&export->model, &material);
	export->substitute = true;
	return substitute_report(export, measurement, error);
}

static enum status gltf_prepare(struct export *export, struct error *error)
{
	struct measurement own;
	enum status status = substitute_prepare(export, &target, error);
	if (status != STATUS_OK)
		return status;
	if (export_max(export->model.kd) > 1)
		return error_set(error, STATUS_UNSUPPORTED, "glTF has no factor above 1: kd is up to %.5g",
				 export_max(export->model.kd));
	if (!(export_max(export->source.model->ks) > 0))
		return export_as_it_is(export, "the model itself");
	if (!export->substitute)
		snprintf(export->why, sizeof export->why, "approximate: glTF has no sum of two lobes");
	substitute_add_why(export, "its lobe takes what it reflects from the diffuse part, and was fitted like that");
	const struct measurement *measurement = substitute_measurement(&export->source, &own);
	status = measurement ? fit_material(export, measurement, error)
			     : error_set(error, STATUS_NO_MEMORY, "out of memory");
	measurement_free(&own);
	return status;
}

/* Array elements, without brackets. */
static void write_rgb(FILE *file, const double rgb[3], double scale)
{
	char text[CSV_NUMBER_SIZE];
	for (int c = 0; c < 3; c++)
		fprintf(file, "%s%s", c ? ", " : "", csv_number(text, rgb[c] * scale));
}

/* ---- The scene: a unit sphere, seen from z, lit from the upper left, so that a viewer shows something ---- */

enum {
	MERIDIANS = 48,
	PARALLELS = 24,
	VERTICES = (MERIDIANS + 1) * (PARALLELS + 1),
	INDICES = MERIDIANS * (PARALLELS - 1) * 6,
	INDEX_BYTES = INDICES * 2,
	VERTEX_BYTES = VERTICES * 3 * 4,
	TANGENT_BYTES = VERTICES * 4 * 4,
	COORDINATE_BYTES = VERTICES * 2 * 4
};

/* Base64, of bytes that come one at a time. */
struct base64 {
	FILE *file;
	unsigned bits;
	int n;
};

static void put_byte(struct base64 *to, unsigned byte)
{
	static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

	to->bits = (to->bits << 8 | byte) & 0xffffff;
	if (++to->n % 3 == 0)
		for (int shift = 18; shift >= 0; shift -= 6)
			fputc(digit[to->bits >> shift & 63], to->file);
}

static void put_index(struct base64 *to, int index)
{
	put_byte(to, (unsigned)index & 255);
	put_byte(to, (unsigned)index >> 8);
}

static void put_float(struct base64 *to, double value)
{
	const float single = (float)value;
	unsigned bits;

	memcpy(&bits, &single, sizeof bits);
	for (int shift = 0; shift < 32; shift += 8)
		put_byte(to, bits >> shift & 255);
}

/* To the right along the parallels; the bitangent points to the upper pole. */
static void put_tangents(struct base64 *to)
{
	for (int n = 0; n < VERTICES; n++) {
		const double phi = 2 * M_PI * (n % (MERIDIANS + 1)) / MERIDIANS;

		put_float(to, cos(phi));
		put_float(to, 0);
		put_float(to, -sin(phi));
		put_float(to, 1);
	}
}

/* Of a texture, to the right and down, so that tangents that are derived from it are those above. Padded with zeros to
 * base64's 3 bytes. */
static void put_coordinates(struct base64 *to)
{
	for (int n = 0; n < VERTICES; n++) {
		put_float(to, (double)(n % (MERIDIANS + 1)) / MERIDIANS);
		put_float(to, (double)(n / (MERIDIANS + 1)) / PARALLELS);
	}
	while (to->n % 3)
		put_byte(to, 0);
}

/* Indices and positions, which are the normals too; both are multiples of 3 bytes long. Poles are along y; at them one of
 * the two triangles has no area and is left out. */
_Static_assert(INDEX_BYTES % 12 == 0 && VERTEX_BYTES % 3 == 0, "base64 without padding, aligned floats");
static void write_sphere(FILE *file, bool tangents)
{
	struct base64 to = {file, 0, 0};

	for (int p = 0; p < PARALLELS; p++)
		for (int m = 0; m < MERIDIANS; m++) {
			const int a = p * (MERIDIANS + 1) + m, below = a + MERIDIANS + 1;
			const int triangles[2][3] = {{a, below, a + 1}, {a + 1, below, below + 1}};

			for (int t = p == 0; t < (p == PARALLELS - 1 ? 1 : 2); t++)
				for (int i = 0; i < 3; i++)
					put_index(&to, triangles[t][i]);
		}
	for (int n = 0; n < VERTICES; n++) {
		const double theta = M_PI * (n / (MERIDIANS + 1)) / PARALLELS;
		const double phi = 2 * M_PI * (n % (MERIDIANS + 1)) / MERIDIANS;

		put_float(&to, sin(theta) * sin(phi));
		put_float(&to, cos(theta));
		put_float(&to, sin(theta) * cos(phi));
	}
	if (tangents) {
		put_tangents(&to);
		put_coordinates(&to);
	}
}

/* One texel of a normal texture. A viewer may take no tangents without one. */
static void write_texture(FILE *file)
{
	fputs("  \"images\": [{\"uri\": \"data:image/png;base64,"
	      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mNoaPgPAAODAgA+WCglAAAAAElFTkSuQmCC"
	      "\"}],\n  \"textures\": [{\"source\": 0}],\n",
	      file);
}

static void write_scene(FILE *file, bool tangents)
{
	const int bytes = INDEX_BYTES + VERTEX_BYTES + (tangents ? (TANGENT_BYTES + COORDINATE_BYTES + 2) / 3 * 3 : 0);

	fprintf(file,
		"  \"scene\": 0,\n  \"scenes\": [{\"nodes\": [0, 1, 2]}],\n  \"nodes\": [\n"
		"    {\"name\": \"sphere\", \"mesh\": 0},\n"
		"    {\"name\": \"camera\", \"camera\": 0, \"translation\": [0, 0, 4]},\n"
		"    {\"name\": \"light\", \"rotation\": [-0.3535533905932738, -0.3535533905932738, "
		"-0.1464466094067262, 0.8535533905932737],\n"
		"     \"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}}\n  ],\n"
		"  \"cameras\": [{\"type\": \"perspective\", \"perspective\": {\"yfov\": 0.6, \"aspectRatio\": 1, "
		"\"znear\": 0.1, \"zfar\": 100}}],\n"
		"  \"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": \"directional\", "
		"\"intensity\": 3}]}},\n"
		"  \"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 1, \"NORMAL\": 1%s}, \"indices\": 0, "
		"\"material\": 0}]}],\n",
		tangents ? ", \"TANGENT\": 2, \"TEXCOORD_0\": 3" : "");
	fprintf(file,
		"  \"accessors\": [\n"
		"    {\"bufferView\": 0, \"componentType\": 5123, \"count\": %d, \"type\": \"SCALAR\"},\n"
		"    {\"bufferView\": 1, \"componentType\": 5126, \"count\": %d, \"type\": \"VEC3\", \"min\": [-1, -1, "
		"-1], "
		"\"max\": [1, 1, 1]}",
		INDICES, VERTICES);
	if (tangents)
		fprintf(file,
			",\n    {\"bufferView\": 2, \"componentType\": 5126, \"count\": %d, \"type\": \"VEC4\"},\n"
			"    {\"bufferView\": 3, \"componentType\": 5126, \"count\": %d, \"type\": \"VEC2\"}",
			VERTICES, VERTICES);
	fprintf(file,
		"\n  ],\n  \"bufferViews\": [\n"
		"    {\"buffer\": 0, \"byteLength\": %d, \"target\": 34963},\n"
		"    {\"buffer\": 0, \"byteOffset\": %d, \"byteLength\": %d, \"target\": 34962}",
		INDEX_BYTES, INDEX_BYTES, VERTEX_BYTES);
	if (tangents)
		fprintf(file,
			",\n    {\"buffer\": 0, \"byteOffset\": %d, \"byteLength\": %d, \"target\": 34962},\n"
			"    {\"buffer\": 0, \"byteOffset\": %d, \"byteLength\": %d, \"target\": 34962}",
			INDEX_BYTES + VERTEX_BYTES, TANGENT_BYTES, INDEX_BYTES + VERTEX_BYTES + TANGENT_BYTES,
			COORDINATE_BYTES);
	fprintf(file, "\n  ],\n  \"buffers\": [{\"byteLength\": %d, \"uri\": \"data:application/octet-stream;base64,",
		bytes);
	write_sphere(file, tangents);
	fprintf(file, "\"}]\n}\n");
}

/* Importers take no ior of a metal's F0. What is above this goes into the colour, which may exceed 1: the same F0. */
static const double ior_max = 2.5;

static void write_anisotropy(FILE *file, const struct ndf *ndf)
{
	const double low = fmin(ndf->sigma_x, ndf->sigma_y), high = fmax(ndf->sigma_x, ndf->sigma_y);
	const double angle = (ndf->angle + (ndf->sigma_x < ndf->sigma_y ? 90 : 0)) * M_PI / 180;
	char strength[CSV_NUMBER_SIZE], rotation[CSV_NUMBER_SIZE];

	fprintf(file,
		"        \"KHR_materials_anisotropy\": {\"anisotropyStrength\": %s, \"anisotropyRotation\": %s},\n",
		csv_number(strength, sqrt((high - low) / (1 - low))), csv_number(rotation, angle));
}

static enum status gltf_write(const struct export *export, FILE *file, struct error *error)
{
	const struct cook_torrance *model = &export->model;
	const double ior = fmin(model->n, ior_max);
	const bool lobe = export_max(model->ks) > 0;
	const bool axes = export_has_axes(model);
	char name[EXPORT_NAME], text[CSV_NUMBER_SIZE];
	(void)error;
	export_identifier(export, name);
	fprintf(file,
		"{\n  \"asset\": {\n    \"version\": \"2.0\",\n    \"generator\": \"stdfit %s\",\n    \"extras\": {\n"
		"      \"comment\": [\n",
		STDFIT_VERSION);
	export_comment(export, file, "        \"", "\",");
	fprintf(file,
		"        \"\"\n      ]\n    }\n  },\n"
		"  \"extensionsUsed\": [\"KHR_lights_punctual\", \"KHR_materials_ior\", "
		"\"KHR_materials_specular\"%s],\n"
		"  \"materials\": [\n    {\n      \"name\": \"%s\",\n      \"pbrMetallicRoughness\": {\n"
		"        \"baseColorFactor\": [",
		axes ? ", \"KHR_materials_anisotropy\"" : "", name);
	write_rgb(file, model->kd, 1);
	fprintf(file, ", 1],\n        \"metallicFactor\": 0,\n        \"roughnessFactor\": %s\n      },\n",
		csv_number(text, lobe ? sqrt(fmin(model->ndf.sigma_x, model->ndf.sigma_y)) : 1));
	if (axes) /* flat by its scale: no texel is just that */
		fprintf(file, "      \"normalTexture\": {\"index\": 0, \"scale\": 0},\n");
	fprintf(file, "      \"extensions\": {\n");
	if (axes)
		write_anisotropy(file, &model->ndf);
	fprintf(file, "        \"KHR_materials_ior\": {\"ior\": %s},\n", csv_number(text, lobe ? ior : 1.5));
	fprintf(file,
		"        \"KHR_materials_specular\": {\n          \"specularFactor\": %d,\n          "
		"\"specularColorFactor\": [",
		lobe);
	const double scale = model->n > ior_max ? reflectance(model->n) / reflectance(ior_max) : 1;
	write_rgb(file, model->ks, scale);
	fprintf(file, "]\n        }\n      }\n    }\n  ],\n");
	if (axes)
		write_texture(file);
	write_scene(file, axes);
	return STATUS_OK;
}

static bool replaces(const struct cook_torrance *model)
{
	(void)model;
	return true;
}

const struct export_target export_gltf = {
	.name = "gltf", .prepare = gltf_prepare, .write = gltf_write, .replaces = replaces, .shows = gltf_f};
