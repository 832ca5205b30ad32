/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/scattered_lobe.h"
#include <math.h>

/* Nodes and entries an octave, as powers of two. */
static const struct {
	int P22_nodes, P22_entries, G1_nodes, G1_entries, F_nodes, F_entries;
} bits[] = {[MASKING_COARSE] = {2, 7, 1, 6, 2, 7}, [MASKING_FINE] = {4, 11, 3, 11, 4, 11}};

enum status scattered_lobe_init(struct scattered_lobe *lobe, enum masking_density density)
{
	*lobe = (struct scattered_lobe){.density = density};
	if (octave_table_init(&lobe->P22, bits[density].P22_nodes, bits[density].P22_entries) == STATUS_OK &&
	    octave_table_init(&lobe->G1, bits[density].G1_nodes, bits[density].G1_entries) == STATUS_OK &&
	    octave_table_init(&lobe->F, bits[density].F_nodes, bits[density].F_entries) == STATUS_OK)
		return STATUS_OK;
	scattered_lobe_free(lobe);
	return STATUS_NO_MEMORY;
}

void scattered_lobe_free(struct scattered_lobe *lobe)
{
	octave_table_free(&lobe->P22);
	octave_table_free(&lobe->G1);
	octave_table_free(&lobe->F);
}

/* A direction of squared tan theta x. */
static struct vec3 direction(double x)
{
	const double z = 1 / sqrt(1 + x);

	return (struct vec3){sqrt(x) * z, 0, z};
}

static double P22_at(const void *ndf, double x)
{
	const struct vec3 m = direction(x);

	return ndf_D(ndf, m) * (m.z * m.z) * (m.z * m.z);
}

static double G1_at(const void *ndf, double x)
{
	return ndf_G1(ndf, direction(x));
}

/* The distribution at a roughness of 1, in terms of std where the slopes are Student-t. Returns: false where there is none that
 * all shapes of this gamma share. */
static bool unit_ndf(const struct ndf *ndf, struct ndf *unit)
{
	const bool student_t = ndf_is_student_t(ndf->class);

	if (!ndf_has_anisotropy(ndf->class))
		return false;
	if (ndf_init(unit, student_t ? ndf_find("std") : ndf->class, 1, 1, ndf->gamma) != STATUS_OK)
		return false;
	return ndf->lambda_form == LAMBDA_EXACT || ndf_set_lambda_form(unit, ndf->lambda_form) == STATUS_OK;
}

/* x -> a x along the axis of `angle`, b x across. */
static struct kernel_form form_of(const struct ndf *ndf, double a, double b)
{
	const double c = ndf->angle == 0 ? 1 : ndf->turn_cos, s = ndf->angle == 0 ? 0 : ndf->turn_sin;

	return (struct kernel_form){(float)(a * c), (float)(a * s), (float)(-b * s), (float)(b * c)};
}

/* P22 is hardly other than at the normal below this squared slope: of most a share of their own roughness, of a table 1/90 of a
 * degree, where its nodes begin. A power of two. */
static double flat_below(const struct ndf *ndf)
{
	return ndf_is_tabulated(ndf->class) ? 0x1p-27 : exp2(floor(log2(ndf->sigma_x * ndf->sigma_x)) - 3);
}

/* tan theta squared of a direction that counts as the normal itself, as in a table. */
#define NORMAL_BELOW 0x1p-28

/* Whether tables for these are there already. */
static bool is_filled(const struct scattered_tables *have, const struct scattered_tables *want)
{
	return have->class == want->class && have->gamma == want->gamma && have->form == want->form &&
	       have->h_min <= want->h_min && have->h_max >= want->h_max && have->w_min <= want->w_min &&
	       have->w_max >= want->w_max;
}

static void fill(struct scattered_lobe *lobe, const struct ndf *ndf, bool with_masking)
{
	const struct scattered_tables *f = &lobe->filled;
	const enum octave_kind kind = ndf_is_tabulated(ndf->class) ? OCTAVES_EXACT : OCTAVES_LOG;
	const double flat = flat_below(ndf);

	octave_table_fill(&lobe->P22, kind, flat, flat + f->h_min, flat + f->h_max, P22_at, ndf);
	if (with_masking) {
		octave_table_fill(&lobe->G1, OCTAVES_PLAIN, 0, f->w_min, f->w_max, G1_at, ndf);
		if (f->to_normal)
			lobe->G1.entry[0] = 1;
	}
}

void scattered_lobe_ndf(struct scattered_lobe *lobe, const struct sample_range *range, const struct ndf *ndf,
			bool with_masking)
{
	struct ndf unit = *ndf;
	const bool shared = unit_ndf(ndf, &unit);
	const double sigma_x = shared ? ndf->sigma_x / ndf->stretch : 1,
		     sigma_y = shared ? ndf->sigma_y / ndf->stretch : 1;
	const double wide = fmax(sigma_x, sigma_y), narrow = fmin(sigma_x, sigma_y);
	struct scattered_tables want = {
		.class = unit.class,
		.gamma = unit.gamma,
		.form = unit.lambda_form,
		.to_normal = range->w_min < NORMAL_BELOW,
		.h_min = range->h_min / (wide * wide),
		.h_max = range->h_max / (narrow * narrow),
		.w_min = fmax(range->w_min, NORMAL_BELOW) * narrow * narrow,
	};

	want.w_max = fmax(range->w_max * wide * wide, want.w_min);
	if (!shared || !is_filled(&lobe->filled, &want)) {
		lobe->filled = want;
		fill(lobe, &unit, with_masking);
	}
	lobe->shape.slopes = form_of(ndf, 1 / sigma_x, 1 / sigma_y);
	lobe->shape.masking = form_of(ndf, sigma_x, sigma_y);
	lobe->shape.scale = (float)fmin(1 / (sigma_x * sigma_y), 1e20);
	lobe->shape.P22 = octave_table_kernel(&lobe->P22);
	lobe->shape.G1 = octave_table_kernel(&lobe->G1);
}

void scattered_lobe_F(struct scattered_lobe *lobe, const struct sample_range *range,
		      double (*F)(const void *data, double cos_d), const void *data)
{
	octave_table_fill(&lobe->F, OCTAVES_ENDED, 0, range->cos_d_min, 1, F, data);
	lobe->shape.F = octave_table_kernel(&lobe->F);
}
