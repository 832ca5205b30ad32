/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measurement - a measured BRDF, independent of the file format: a table over (theta_h, theta_d, phi_d), isotropic, or
 * scattered entries that lie anywhere. */
#ifndef MEASUREMENT_H
#define MEASUREMENT_H

#include "src/halfdiff.h"
#include "src/status.h"
#include "src/vec3.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The angles that entry (i, j, k) stands for. Programs of the field disagree, so this is an option, and every result
 * records it. */
enum bins {
	BINS_NODE,   /* theta_h = i^2/90 deg, theta_d = j deg, phi_d = k deg */
	BINS_CENTRE, /* theta_h = (i + 1/2)^2/90 deg, theta_d = j + 1/2 deg, phi_d = k + 1/2 deg */
	BINS_COUNT
};

enum { MERL_THETA_H = 90, MERL_THETA_D = 90, MERL_CHANNELS = 3 };

/* How a sample may be turned without changing what is measured. */
enum symmetry {
	SYMMETRY_ISOTROPIC,   /* by any angle about its normal */
	SYMMETRY_PLANE,       /* not, but it is its own mirror image in the plane y = 0 */
	SYMMETRY_ANISOTROPIC, /* not at all */
	SYMMETRY_COUNT
};

/* struct scattered - entries that lie anywhere. What could not be used is not among them, only counted. */
struct scattered {
	size_t n; /* at least 1 */
	enum symmetry symmetry;
	bool gray;                   /* one channel was measured: the three values of an entry are equal */
	struct vec3 *wi, *wo;        /* n unit vectors each, z > 0; x is the sample's own axis of azimuth 0 */
	float *value[MERL_CHANNELS]; /* n each, 1/sr, finite and >= 0; one block of memory */
	float *solid_angle;          /* n: the part of the two hemispheres that the entry stands for, sr^2, >= 0 */
};

struct measurement {
	int n_phi_d; /* 180 or 360: phi_d of entry k is k (or k + 1/2) degrees either way; 0: scattered */
	float *value[MERL_CHANNELS]; /* 1/sr; in the order of measurement_at; NaN in all three channels = masked */
	struct scattered *scattered; /* owned; NULL for a table */
	struct rgl *rgl;             /* owned: the interpolant of a file that has its own (rgl.h); else NULL */
	size_t n_negative;           /* entries masked for a negative value in some channel, all three being finite */
	size_t n_nonfinite;          /* entries masked for NaN, Inf or a value beyond float in some channel */
	size_t n_below_horizon;      /* scattered: entries left out for a direction at or below the horizon */
	uint64_t file_size;          /* bytes of the file read; 0 for a table that was made */
	uint64_t file_hash;          /* XXH3, 64 bits, of all those bytes, as `xxhsum -H3` prints it */
	const char *format;          /* name of the file's format, static; NULL for what was made */
	int n_channels;              /* scattered: values of an entry in the file: 1, 3 or the number of wavelengths */
	size_t n_missing;            /* scattered: entries left out because the file has no value there */
	size_t n_out_of_gamut;       /* scattered: entries whose colour has a negative part in linear sRGB */
};

/* measurement_turns - whether the sample's azimuth counts: scattered entries that are not isotropic. */
static inline bool measurement_turns(const struct measurement *measurement)
{
	return measurement->scattered && measurement->scattered->symmetry != SYMMETRY_ISOTROPIC;
}

/* symmetry_name - "isotropic", "plane", "anisotropic". */
const char *symmetry_name(enum symmetry symmetry);
/* symmetry_find - the reverse; STATUS_DOMAIN, *symmetry untouched, for another name. */
MUST_CHECK enum status symmetry_find(const char *name, enum symmetry *symmetry);

/* bins_name - "node" or "centre". */
const char *bins_name(enum bins bins);
/* bins_find - the reverse; STATUS_DOMAIN, *bins untouched, for another name. */
MUST_CHECK enum status bins_find(const char *name, enum bins *bins);

/* measurement_alloc - a table of the given n_phi_d (180 or 360), every entry masked (NaN). Free with
 * measurement_free. */
MUST_CHECK enum status measurement_alloc(struct measurement *measurement, int n_phi_d);
/* measurement_reserve - the same with unset values, for a reader that sets every one: it saves a pass over the memory.
 * Both return STATUS_DOMAIN for another n_phi_d, STATUS_NO_MEMORY; *measurement is then cleared. */
MUST_CHECK enum status measurement_reserve(struct measurement *measurement, int n_phi_d);
/* measurement_scattered - room for n >= 1 scattered entries, all values unset, isotropic. STATUS_NO_MEMORY;
 * *measurement is then cleared. A reader that finds fewer lowers scattered->n. */
MUST_CHECK enum status measurement_scattered(struct measurement *measurement, size_t n);
/* measurement_require_table - STATUS_UNSUPPORTED, and that `what` ("fit", ...) needs a table, for scattered entries. */
MUST_CHECK enum status measurement_require_table(const struct measurement *measurement, const char *what,
						 struct error *why);
enum { MEASUREMENT_LEFT_OUT = 160 };
/* What of the entries that are not among those that count has to be told. */
enum left_out {
	LEFT_OUT_VALUES,   /* those of a file of samples that have values */
	LEFT_OUT_ALL,      /* those that were not measured, too */
	LEFT_OUT_OF_TABLE, /* all, and of a table those that are masked */
};
/* measurement_left_out - how many entries of the file are not among those of the measurement, and why, "3 negative; 1
 * at or below the horizon"; of those out of gamut only if `masked`. Returns text. */
const char *measurement_left_out(const struct measurement *measurement, enum left_out which, bool masked,
				 char text[MEASUREMENT_LEFT_OUT]);
/* measurement_free - releases the planes and clears the struct; harmless on a zeroed one. */
void measurement_free(struct measurement *measurement);

/* measurement_count - entries of one channel, masked ones included. */
static inline size_t measurement_count(const struct measurement *measurement)
{
	return measurement->scattered ? measurement->scattered->n
				      : (size_t)MERL_THETA_H * MERL_THETA_D * (size_t)measurement->n_phi_d;
}

/* measurement_at - the index of entry (i, j, k) of theta_h, theta_d, phi_d in a plane with this n_phi_d, in the order
 * of the file. */
static inline size_t measurement_at(int n_phi_d, int i, int j, int k)
{
	return (size_t)k + (size_t)n_phi_d * ((size_t)j + MERL_THETA_D * (size_t)i);
}

/* bins_angles - theta_h, theta_d, phi_d (radians) of entry (i, j, k); 0 <= i, j < 90, 0 <= k < n_phi_d. */
struct halfdiff bins_angles(enum bins bins, int i, int j, int k);

/* bins_indices - the inverse: where angles lie between the entries, as real i, j, k, unbounded. */
struct bins_indices {
	double i, j, k;
};
struct bins_indices bins_indices(enum bins bins, struct halfdiff angles);

/* bins_mirror - the k of 180 degrees - phi_d of entry k; an entry with the same model value. May be n_phi_d or more. */
int bins_mirror(enum bins bins, int k);

/* bins_trig - sines and cosines of theta_h, theta_d and phi_d of entry (i, j, k), to the last ulp or two:
 * above 45 degrees computed from the complement, and exactly 0 or 1 where they should be. */
struct halfdiff_trig bins_trig(enum bins bins, int i, int j, int k);

/* cell_measure - solid angle of a cell in wi and wo, the integral of 4 cos_d dw_h dw_d over all phi_h and
 * [i, i+1) x [j, j+1) x [k, k+1): sr^2. */
double cell_measure(int i, int j);

#endif
