/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample_set - measured entries and their geometry, laid out for the kernel. */
#ifndef SAMPLE_SET_H
#define SAMPLE_SET_H

#include "fit/error/entries.h"
#include "fit/error/kernel.h"
#include "fit/error/options.h"
#include <math.h>
#include <stddef.h>

enum { MERL_ROWS = MERL_THETA_H * MERL_THETA_D };

/* struct geometry - everything about a kind of measurement that no material changes. Of scattered entries, n_phi_d = 0, that is
 * the criterion alone; of a table also its samples, row by row.
 * Sample n stands for the entries k of row (i, j) with the same model value: k, half - k, half + k, 2 half - k. */
struct geometry {
	int n_phi_d;
	struct criterion criterion; /* that it was made for */
	int n_samples;
	int32_t *q_i, *q_o;          /* masking_q() of wi and wo */
	float *geometric_factor;     /* w / (4 cos_i cos_o), times G for GAF_V_GROOVE */
	float *w;                    /* weight of an entry */
	uint16_t *row;               /* theta_d index + 90 theta_h index: j of measurement_at() for i = 0 */
	uint16_t *k;                 /* phi_d index of the first entry of the sample */
	int first[MERL_THETA_H + 1]; /* samples of theta_h index i are first[i] .. first[i + 1] - 1 */
	int32_t q_min;               /* smallest q of all samples */
	struct entries entries;
};

/* geometry_init - n_phi_d = 0, 180 or 360: the samples above the horizon and within max_theta, under the options' weight, bins and G. */
MUST_CHECK enum status geometry_init(struct geometry *geometry, int n_phi_d, const struct fit_options *options);
void geometry_free(struct geometry *geometry);
/* geometry_members - entries k of sample n, two or four of them (equal ones once), into k[]. Returns how many. */
int geometry_members(const struct geometry *geometry, int n, int k[4]);

/* struct sample_range - what the directions of scattered samples come to: the least and the greatest squared tan theta of h, and of
 * wi and wo; the least cos theta_d. */
struct sample_range {
	double h_min, h_max, w_min, w_max, cos_d_min;
};

/* struct sample_set - the valid entries of one material, or a weighted sample of them. */
struct sample_set {
	const struct geometry *geometry;
	const struct scattered *scattered; /* where the samples come from; borrowed; NULL: a table */
	int n_blocks, n_pair_blocks;       /* blocks of pairs stand first, then blocks of singles */
	int n_samples;                     /* samples in use, padding left out */
	int32_t *q_i, *q_o;                /* n_blocks * KERNEL_BLOCK of each */
	float *geometric_factor, *w;
	uint16_t *row;
	/* In place of q_i, q_o and row, where they are scattered: */
	float *plane[KERNEL_PLANES]; /* one block of memory */
	uint32_t *entry;             /* of *scattered */
	struct sample_range range;
	float *value;              /* unit w m; per block: channel by channel, first members, then second ones */
	double unit;               /* a power of two: 1 but for data so faint that floats would be denormal */
	double sum[MERL_CHANNELS]; /* sum of w m per channel */
	double sum_w;              /* sum of w over the entries of one channel */
	size_t n_entries;          /* entries of three channels */
};

/* sample_set_init - takes the valid entries out of a measurement; scattered ones, in order of theta_h, are those within the
 * criterion's max_theta, and *measurement has to outlive the table then. STATUS_NO_DATA when there is none or all are zero. */
MUST_CHECK enum status sample_set_init(struct sample_set *table, const struct geometry *geometry,
				       const struct measurement *measurement, int threads);
/* sample_set_is_faint - whether the mean measurement asks for another unit: arithmetic on what is too small for a normal float is
 * a hundred times slower, and inexact. */
bool sample_set_is_faint(const struct sample_set *table);
/* The unit of such data: far above what that takes, and far below where the lobe of the largest D and geometric factor, 1e25,
 * overflows. */
#define SAMPLE_SET_FAINT_UNIT 0x1p40
/* sample_set_scattered - the part of sample_set_init() that does the scattered ones, less what is common to both. */
MUST_CHECK enum status sample_set_scattered(struct sample_set *table, const struct geometry *geometry,
					    const struct scattered *scattered);
/* sample_set_alloc - room for a table of samples with unset members; STATUS_NO_MEMORY. */
MUST_CHECK enum status sample_set_alloc(struct sample_set *table, const struct geometry *geometry,
					const struct scattered *scattered, int n_pairs, int n_singles);
/* sample_set_thin - a weighted sample of about n_samples samples whose sums estimate those of `full`.
 * Samples are selected systematically with probability p, three parts by what is measured there to one part evenly, and
 * weigh 1/p: a sample where the measurement is large, and so may be the error, is hardly ever missed. */
MUST_CHECK enum status sample_set_thin(struct sample_set *table, const struct sample_set *full, int n_samples);
void sample_set_free(struct sample_set *table);

static inline struct kernel_samples sample_set_block(const struct sample_set *table, int block)
{
	const size_t at = (size_t)block * KERNEL_BLOCK;

	return (struct kernel_samples){table->q_i + at, table->q_o + at, table->geometric_factor + at, table->row + at};
}

static inline struct kernel_scattered sample_set_scattered_block(const struct sample_set *table, int block)
{
	const size_t at = (size_t)block * KERNEL_BLOCK;
	struct kernel_scattered samples = {.geometric_factor = table->geometric_factor + at};

	for (int p = 0; p < KERNEL_PLANES; p++)
		samples.plane[p] = table->plane[p] + at;
	return samples;
}

/* sample_set_value - first members of channel c in a block. */
static inline float *sample_set_value(const struct sample_set *table, int block, int c)
{
	const int pairs = block < table->n_pair_blocks ? block : table->n_pair_blocks;
	const int members = block < table->n_pair_blocks ? 2 : 1;

	return table->value + (size_t)KERNEL_BLOCK * (size_t)(MERL_CHANNELS * (pairs + block) + members * c);
}

/* weight_at - w of entry (i, j, .) of a table, given its cosines; wants none of them for WEIGHT_NONE. */
double weight_at(enum weight weight, int i, int j, double cos_i, double cos_o);
/* weight_of_entry - the same of a scattered entry, whose solid angle it has itself. */
double weight_of_entry(enum weight weight, double solid_angle, double cos_i, double cos_o);

/* max_theta_cos - the smallest cosine that `max_theta` degrees allow; entry_in_range - whether an entry takes part. */
double max_theta_cos(double max_theta);
bool entry_in_range(struct vec3 wi, struct vec3 wo, double min_cos);

/* entry_is_missing - whether the entry at this index of a plane is not measured: masked, or, where zeros count so, 0 in all
 * channels. */
static inline bool entry_is_missing(const struct measurement *measurement, const struct criterion *criterion, size_t at)
{
	if (isnan(measurement->value[0][at]))
		return true;
	return criterion->zero_is_missing && measurement->value[0][at] == 0 && measurement->value[1][at] == 0 &&
	       measurement->value[2][at] == 0;
}

/* scattered_takes_part - whether entry n is in range and not missing. min_cos: of the criterion's max_theta. */
static inline bool scattered_takes_part(const struct scattered *s, const struct criterion *criterion, double min_cos,
					size_t n)
{
	if (criterion->zero_is_missing && s->value[0][n] == 0 && s->value[1][n] == 0 && s->value[2][n] == 0)
		return false;
	return entry_in_range(s->wi[n], s->wo[n], min_cos);
}

#endif
