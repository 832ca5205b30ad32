/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scattered_lobe - the tables with which the kernel computes the lobe of one shape at scattered entries.
 *
 * Where D is f(tan theta/sigma)/cos^4 (all but gtr, low and pl), also anisotropic, it is a function of one number of an entry, the
 * squared slope of h in units of the roughness along its own direction; and so is G1 of the squared tan theta of wi, or wo, times
 * the squared roughness projected on it [section 3.3 of the STD paper]. Their tables depend on gamma alone: roughness and axes are in
 * the quadratic forms that the kernel takes of the slopes. The other distributions have tables of the shape itself. */
#ifndef SCATTERED_LOBE_H
#define SCATTERED_LOBE_H

#include "fit/error/masking.h"
#include "fit/error/octave_table.h"
#include "fit/error/sample_set.h"

struct scattered_lobe {
	enum masking_density density;
	struct octave_table P22, G1, F;
	struct scattered_tables { /* what P22 and G1 have been filled for */
		const struct ndf_class *class;
		double gamma;
		enum lambda_form form;
		double h_min, h_max, w_min, w_max; /* their ranges, */
		bool to_normal;                    /* the last of which goes on to wi or wo along the normal */
	} filled;
	struct kernel_shape shape;
};

/* scattered_lobe_init - nothing in it yet. Largest relative error of the lobe, where it is above 1e-3 of its peak: coarse
 * 1e-4, fine 1e-6; that of sums over many entries is less (tests/test_scattered.c). STATUS_NO_MEMORY. */
MUST_CHECK enum status scattered_lobe_init(struct scattered_lobe *lobe, enum masking_density density);
void scattered_lobe_free(struct scattered_lobe *lobe);

/* scattered_lobe_ndf - prepares D and G1 of a distribution for the samples of a range; with_masking: G1 is wanted. */
void scattered_lobe_ndf(struct scattered_lobe *lobe, const struct sample_range *range, const struct ndf *ndf,
			bool with_masking);
/* scattered_lobe_F - prepares F, a function of cos_d. */
void scattered_lobe_F(struct scattered_lobe *lobe, const struct sample_range *range,
		      double (*F)(const void *data, double cos_d), const void *data);

#endif
