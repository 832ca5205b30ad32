/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit - the public interface of libstdfit, whole: it fits Cook-Torrance models to measured isotropic BRDFs, and
 * evaluates and samples the models and their normal distributions (NDFs).
 *
 *     f_c = kd_c/pi + ks_c F(cos_d) D(h) G(wi, wo)/(4 cos_i cos_o)          c = red, green, blue; 1/sr
 *
 * Conventions. The surface normal is +z. A direction is three doubles x, y, z, a unit vector to within 1e-6; wi points to
 * the light, wo to the viewer, h = (wi + wo)/|wi + wo|. Arrays of n directions are 3 n doubles. Angles are in radians
 * unless a name says degrees. Choices of few values are strings: a name that is not known is a domain error, and NULL
 * stands for the default.
 *
 * Errors. Every function that can fail returns an enum stdfit_status. Unless that is STDFIT_OK, what it should have made
 * is NULL or unchanged, and *error, which may be NULL, holds a line of text that says what was expected and what was
 * found. All arguments are checked: NULL where an object is needed, NaN, and values out of range are STDFIT_DOMAIN.
 * A handle that has been freed cannot be told from a good one.
 *
 * Threads. There is no global state. A handle may be read by many threads at once; one may free it once none reads it.
 * A fit wants 256 kB of its caller's stack; the threads that it starts itself are OpenMP's (OMP_STACKSIZE).
 * After fork(), a child of a process that has fitted with more threads may use threads = 1 only: with GNU OpenMP it would
 * wait for ever for threads that the child does not have.
 *
 * C11, C++11 and cffi (preprocess with STDFIT_CFFI defined) read this header, and it includes standard headers only. */
#ifndef STDFIT_H
#define STDFIT_H

#ifndef STDFIT_CFFI
#include <stddef.h>
#include <stdint.h>
#endif

#if defined(__GNUC__) && !defined(STDFIT_CFFI)
#define STDFIT_MUST_CHECK __attribute__((warn_unused_result))
#else
#define STDFIT_MUST_CHECK
#endif

#ifdef __cplusplus
extern "C" {
#endif

enum stdfit_status {
	STDFIT_OK = 0,
	STDFIT_DOMAIN = 1,      /* an argument lies outside its documented range */
	STDFIT_NO_MEMORY = 2,   /* an allocation failed */
	STDFIT_IO = 3,          /* the operating system refused to open, read or write */
	STDFIT_FORMAT = 4,      /* a file is not what it should be */
	STDFIT_NO_DATA = 5,     /* nothing to work on: every entry masked, or all zero */
	STDFIT_UNSUPPORTED = 6, /* valid, but this combination cannot be done */
	STDFIT_INTERRUPTED = 7  /* stopped by the caller */
};

/* struct stdfit_error - the text of a failure: one line without newline. */
struct stdfit_error {
	char text[512];
};

/* stdfit_version - "0.2.0". stdfit_status_text - a short phrase for a status; "unknown status" for any other number. */
const char *stdfit_version(void);
const char *stdfit_status_text(int status);

/* ---- Distributions of normals ---- */

typedef struct stdfit_ndf stdfit_ndf;

/* stdfit_ndf_new - a distribution by its name, roughness and shape, to be freed with stdfit_ndf_free().
 *     "std"           Student-t slopes [Ribardiere et al. 2017]; gamma in (1.5, inf]
 *     "ggx", "beckmann"   gamma is not read
 *     "hyper-cauchy", "t-family"   the same slopes under other roughness; gamma in (1.5, 1e6], at least 2 + 1e-6
 *     "ellipsoid"     as "ggx"; stdfit_ndf_new_ellipsoid() makes all of them
 *     "gtr"           generalised Trowbridge-Reitz, isotropic; gamma in (0, 1000]
 *     "low"           Low et al.'s ABC, isotropic; gamma is C, in (0, 1000]
 * sigma_x, sigma_y in [1e-50, 1e50], equal where the distribution is isotropic only.
 * lambda is the form in which Smith's Lambda is computed: "exact" (NULL), and for Student-t slopes the paper's "2f1",
 * "integer", "half-integer", "rational". STDFIT_UNSUPPORTED: a form that this distribution has not. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_new(stdfit_ndf **ndf, const char *name, double sigma_x, double sigma_y,
						    double gamma, const char *lambda, struct stdfit_error *error);

/* stdfit_ndf_new_piecewise - D linear in theta between nodes; the values are normalised here [Ribardiere et al. 2019].
 * Given: n_nodes in 2 .. 1048576; theta increasing strictly from 0 to pi/2 (to 1e-12); Dx >= 0 along phi = 0, and Dy along
 * phi = 90 degrees in the same manner; Dy NULL: isotropic. No visible normals, no moments; an anisotropic one has no albedo. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_new_piecewise(stdfit_ndf **ndf, int n_nodes, const double *theta,
							      const double *Dx, const double *Dy,
							      struct stdfit_error *error);

/* stdfit_ndf_new_ellipsoid - the normals of the half ellipsoid |A p| = 1, A regular, in rows [Walter et al. 2014]:
 * "ggx" whose facets lean on average, where A has an axis askew. Then Smith's masking would exceed 1 from some directions, and is 1
 * there; and there are no albedo, transmission or multiple scattering. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_new_ellipsoid(stdfit_ndf **ndf, const double A[9],
							      struct stdfit_error *error);

/* stdfit_ndf_free - NULL is left alone. */
void stdfit_ndf_free(stdfit_ndf *ndf);

/* What stdfit_ndf_evaluate() computes of each direction m (or w). */
enum stdfit_ndf_quantity {
	STDFIT_D,      /* density of normals, 1/sr; 0 below the horizon; D cos integrates to 1 */
	STDFIT_LAMBDA, /* Smith's Lambda; infinity at and below the horizon */
	STDFIT_G1,     /* 1/(1 + Lambda), in [0, 1] */
	STDFIT_PDF     /* D cos, 1/sr: the density of stdfit_ndf_sample() */
};

/* stdfit_ndf_evaluate - `quantity` at n directions into value[n]. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_evaluate(const stdfit_ndf *ndf, enum stdfit_ndf_quantity quantity,
							 size_t n, const double *directions, double *value,
							 struct stdfit_error *error);

/* stdfit_ndf_G - masking and shadowing of n pairs, in [0, 1]; 0 where one of them is at or below the horizon.
 * gaf: "uncorrelated" (NULL), "correlated" or "v-groove", which reads no NDF. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_G(const stdfit_ndf *ndf, const char *gaf, size_t n, const double *wi,
						  const double *wo, double *G, struct stdfit_error *error);

/* stdfit_ndf_sample - n normals of density STDFIT_PDF from 2 n numbers u in [0, 1). */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_sample(const stdfit_ndf *ndf, size_t n, const double *u,
						       double *normals, struct stdfit_error *error);

/* stdfit_ndf_sample_visible - n of the normals that are seen from wi, wi.z > 0 [Heitz and d'Eon 2014];
 * stdfit_ndf_pdf_visible - their density at n normals, 1/sr: G1(wi) max(0, wi.m) D(m)/cos_i.
 * STDFIT_UNSUPPORTED: sampling of gtr and low. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_sample_visible(const stdfit_ndf *ndf, const double wi[3], size_t n,
							       const double *u, double *normals,
							       struct stdfit_error *error);
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_pdf_visible(const stdfit_ndf *ndf, const double wi[3], size_t n,
							    const double *normals, double *pdf,
							    struct stdfit_error *error);

/* stdfit_ndf_weight - what each of n normals, drawn with density pdf[i] > 0, adds to the integral of f cos_o over wo for
 * ks F = 1: their mean is the directional albedo. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_weight(const stdfit_ndf *ndf, const char *gaf, const double wi[3],
						       size_t n, const double *normals, const double *pdf,
						       double *weight, struct stdfit_error *error);

/* stdfit_ndf_P22 - density of the slopes (p, q) along x and y; stdfit_ndf_P2 - of the slope q along azimuth phi;
 * stdfit_ndf_moment - integral of q^order P2, order even and >= 0: STDFIT_DOMAIN where it does not exist;
 * stdfit_ndf_excess_kurtosis - of P2, how heavy its tail is: 0 for beckmann, else STDFIT_DOMAIN unless gamma > 3. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_P22(const stdfit_ndf *ndf, double p, double q, double *density,
						    struct stdfit_error *error);
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_P2(const stdfit_ndf *ndf, double phi, double q, double *density,
						   struct stdfit_error *error);
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_moment(const stdfit_ndf *ndf, double phi, int order, double *moment,
						       struct stdfit_error *error);
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_excess_kurtosis(const stdfit_ndf *ndf, double *kurtosis,
								struct stdfit_error *error);

/* stdfit_ndf_furnace - the share of light from everywhere that comes back after one reflection on facets that lose
 * nothing; 1 for a lossless surface, to 1e-5. gaf as above. STDFIT_DOMAIN where sigma_x and sigma_y differ. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_ndf_furnace(const stdfit_ndf *ndf, const char *gaf, double *balance,
							struct stdfit_error *error);

/* ---- Models ---- */

/* struct stdfit_model - a model but for its NDF. gaf: as above; fresnel: "dielectric" (NULL), "schlick", "conductor",
 * "none", "f82". Ranges: n in (0, 1e75], k in [0, 1e75], read by the conductor only; kd, ks, kg, ks2 in [0, 1e6]. What richer
 * models have besides may be left 0:
 *    f0, f82, f90      of "f82" only: F along the normal, at cos_d = 1/7 and at grazing incidence, in [0, 1]
 *    kg, exponent      kg cos_d^2 ((1 - cos_i)^p + (1 - cos_o)^p)/pi is added; p in [1, 20], read where some kg is not 0
 *    ks2, sigma2, gamma2   a second lobe of the same kind of NDF, isotropic, with the same F and G; the last two, gamma2 of
 *                      NDFs that have a gamma, are read where some ks2 is not 0; of a class of stdfit_ndf_new() only */
struct stdfit_model {
	const char *gaf, *fresnel;
	double n, k;
	double kd[3], ks[3];
	double f0[3], f82[3], f90[3];
	double kg[3];
	double exponent;
	double ks2[3];
	double sigma2, gamma2;
};

/* stdfit_model_default - uncorrelated G, a dielectric of n = 1.5, kd = 0, ks = 1. */
struct stdfit_model stdfit_model_default(void);

/* stdfit_model_evaluate - f in three channels, 1/sr, of n pairs of directions into f[3 n]; 0 where one is at or below the
 * horizon. The NDF is one of stdfit_ndf_new() or an isotropic piecewise one; else STDFIT_UNSUPPORTED. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_model_evaluate(const struct stdfit_model *model, const stdfit_ndf *ndf,
							   size_t n, const double *wi, const double *wo, double *f,
							   struct stdfit_error *error);

/* stdfit_model_albedo - the share of the light from a direction of cosine cos_i in [0, 1] that is sent back, three
 * channels, to 1e-7 for kd, ks up to 1. STDFIT_DOMAIN where sigma_x and sigma_y of the NDF differ. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_model_albedo(const struct stdfit_model *model, const stdfit_ndf *ndf,
							 double cos_i, double albedo[3], struct stdfit_error *error);

/* stdfit_model_albedo_max - the largest albedo of any direction, to 1e-5 for kd, ks up to 1, and at *theta_i, radians, that
 * direction. More than 1 is more light than comes in. STDFIT_DOMAIN as above. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_model_albedo_max(const struct stdfit_model *model, const stdfit_ndf *ndf,
							     double albedo[3], double *theta_i,
							     struct stdfit_error *error);

/* stdfit_fresnel - reflectance F in [0, 1] at cos_d in [0, 1], ranges of n and k as above. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_fresnel(const char *fresnel, double cos_d, double n, double k, double *F,
						    struct stdfit_error *error);

/* ---- Rough dielectrics, and light that meets several facets ---- */

/* A rough interface between two transparent media: `index` is that of the medium below over that of the medium above, in
 * [1e-50, 1e50] but not 1. wi and wo may lie above or below; f_t = (1 - F) D G index^2 |wi.m wo.m|/(|cos_i cos_o| |wi + index
 * wo|^2) for wi above [Walter et al. 2007]. f is a ratio of radiances: f(wi, wo)/n_o^2 = f(wo, wi)/n_i^2 with the indices on
 * the sides of wi and wo. The NDF is one of stdfit_ndf_new() or an isotropic piecewise one; else STDFIT_UNSUPPORTED. gaf:
 * "uncorrelated" (NULL) or "correlated", of transmissions Euler's B(1 + Lambda(wi), 1 + Lambda(-wo)). */

/* stdfit_dielectric_evaluate - f of n pairs of directions, 1/sr, one channel: reflection on one side, transmission else. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_dielectric_evaluate(const stdfit_ndf *ndf, const char *gaf, double index,
								size_t n, const double *wi, const double *wo, double *f,
								struct stdfit_error *error);

/* stdfit_dielectric_sample - where light from wi goes, wi not in the horizon: n directions wo from 3 n numbers u in [0, 1), and
 * weight[n], f |cos_o| over the density of wo, 0 where wo is lost to further facets. Their mean is the light that is sent on.
 * stdfit_dielectric_pdf - that density, 1/sr. sampling: of "visible" normals (NULL), or by "ndf", of all, which gtr, low and a
 * piecewise one need. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_dielectric_sample(const stdfit_ndf *ndf, const char *gaf, double index,
							      const char *sampling, const double wi[3], size_t n,
							      const double *u, double *wo, double *weight,
							      struct stdfit_error *error);
STDFIT_MUST_CHECK enum stdfit_status stdfit_dielectric_pdf(const stdfit_ndf *ndf, double index, const char *sampling,
							   const double wi[3], size_t n, const double *wo, double *pdf,
							   struct stdfit_error *error);

/* struct stdfit_facets - what facets do with light that is followed until it leaves: they reflect F of it, by index n and
 * k of each channel, and absorb the rest; or, with transmits, refract it: a dielectric of index n[0] as above. fresnel and
 * ranges as in struct stdfit_model; "dielectric" or NULL with transmits. */
struct stdfit_facets {
	const char *fresnel;
	double n[3], k[3];
	int transmits;
};

/* stdfit_facets_default - fresnel "none", a surface that loses nothing. */
struct stdfit_facets stdfit_facets_default(void);

/* stdfit_scatter_evaluate - estimates the BSDF of a Smith surface with light that meets several facets, by a random walk
 * [Heitz et al. 2016], of n pairs into f[3 n], 1/sr. The mean over calls is the BSDF, whose first order is exact, with
 * correlated G. events: at most so many facets; 0: all. The NDF is one of stdfit_ndf_new() but gtr and low; its Lambda is
 * taken as exact. *random is the state of the random numbers: any to begin with, and it is moved on. For gamma <= 1.75 the
 * variance is infinite.
 * stdfit_scatter_sample - n directions wo in which light from wi leaves, weight[3 n] in three channels, 0 where it has been
 * absorbed, whose mean is the light that comes back (and on), and the facets met in events[n], or NULL. wi.z > 0, or of
 * facets that transmit other than 0. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_scatter_evaluate(const struct stdfit_facets *facets, const stdfit_ndf *ndf,
							     int events, size_t n, const double *wi, const double *wo,
							     uint64_t *random, double *f, struct stdfit_error *error);
STDFIT_MUST_CHECK enum stdfit_status stdfit_scatter_sample(const struct stdfit_facets *facets, const stdfit_ndf *ndf,
							   const double wi[3], size_t n, uint64_t *random, double *wo,
							   double *weight, int *events, struct stdfit_error *error);

/* ---- Half and difference angles ---- */

/* stdfit_angles_to_directions - wi and wo of n triples theta_h, theta_d, phi_d, with h in the xz plane; z <= 0 where a
 * direction lies below the horizon. Given: theta_h, theta_d in [0, pi/2], phi_d in [-2 pi, 2 pi].
 * stdfit_angles_from_directions - the reverse, for any azimuth of the pair: theta_h in [0, pi], theta_d in [0, pi/2],
 * phi_d in [0, 2 pi); an angle without meaning is 0, as phi_d for wi = wo and theta_h for wi = -wo. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_angles_to_directions(size_t n, const double *angles, double *wi, double *wo,
								 struct stdfit_error *error);
STDFIT_MUST_CHECK enum stdfit_status stdfit_angles_from_directions(size_t n, const double *wi, const double *wo,
								   double *angles, struct stdfit_error *error);

/* ---- Measurements ---- */

typedef struct stdfit_measurement stdfit_measurement;

/* A measurement is a grid of 90 x 90 x n_phi_d entries of (theta_h, theta_d, phi_d), n_phi_d 180 or 360. In arrays entry
 * (i, j, k) is number k + n_phi_d (j + 90 i) of a plane, and the three planes of red, green and blue follow one another:
 * 3 * 8100 * n_phi_d values, 1/sr. An entry that is negative or not finite in a channel is masked in all three. */

/* stdfit_measurement_read - reads a measurement of any format that the program knows: STDFIT_IO, STDFIT_FORMAT, STDFIT_NO_DATA,
 * STDFIT_UNSUPPORTED. Samples that lie anywhere are no grid: their n_phi_d is 0. stdfit_measurement_write - writes a MERL file: beside
 * `path` first, which is replaced when all is written; STDFIT_UNSUPPORTED for samples. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_measurement_read(stdfit_measurement **measurement, const char *path,
							     struct stdfit_error *error);
STDFIT_MUST_CHECK enum stdfit_status stdfit_measurement_write(const stdfit_measurement *measurement, const char *path,
							      struct stdfit_error *error);
/* stdfit_measurement_from_values - from 3 * 8100 * n_phi_d doubles, kept as floats; what is beyond float is masked. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_measurement_from_values(stdfit_measurement **measurement, int n_phi_d,
								    const double *values, struct stdfit_error *error);
/* stdfit_measurement_from_samples - of n entries that lie anywhere: directions wi and wo, values in 1/sr, red, green, blue of
 * each entry in turn. solid_angles: what each stands for in the two hemispheres, sr^2, or NULL: estimated. Entries with a
 * direction at or below the horizon, or a value that is negative or not finite, are left out; STDFIT_NO_DATA if all are.
 * Where wi has more than one azimuth, the sample counts as anisotropic. Its n_phi_d is 0. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_measurement_from_samples(stdfit_measurement **measurement, size_t n,
								     const double *wi, const double *wo,
								     const double *values, const double *solid_angles,
								     struct stdfit_error *error);
/* stdfit_measurement_from_model - an ideal measurement of an isotropic model. bins: "node" (NULL), entries at whole degrees, or
 * "centre", half a degree on. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_measurement_from_model(stdfit_measurement **measurement,
								   const struct stdfit_model *model,
								   const stdfit_ndf *ndf, const char *bins, int n_phi_d,
								   struct stdfit_error *error);
/* stdfit_measurement_values - the values, NaN where masked, into 3 * 8100 * n_phi_d doubles. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_measurement_values(const stdfit_measurement *measurement, double *values,
							       struct stdfit_error *error);
/* stdfit_measurement_n_phi_d - 180 or 360; 0 for NULL. */
int stdfit_measurement_n_phi_d(const stdfit_measurement *measurement);
void stdfit_measurement_free(stdfit_measurement *measurement);

/* ---- Fits ---- */

/* struct stdfit_step - what a trace is told: a better shape on a sample of the measurement ("scan", "thin-1" .. "thin-3")
 * or on all of it ("full"). Parameters that the model has not are NaN. */
struct stdfit_step {
	const char *ndf, *stage;
	double sigma, gamma, n, k;
	double error;
	long evaluations;
	double seconds;
};

/* struct stdfit_options - of a fit; from stdfit_options_default(). NaN = free. Strings are borrowed. */
struct stdfit_options {
	const char *ndfs;    /* names separated by commas, 1 to 16: "std,ggx,beckmann" (NULL); "pl": piecewise linear */
	const char *gaf;     /* as above */
	const char *fresnel; /* as above */
	const char *lambda;  /* as above, of std and its family */
	const char *weight;  /* of an entry in the error: "none" (NULL), "cosine", "solid-angle" */
	const char *bins;    /* as above */
	const char *algorithm; /* "default" (NULL), or nlopt's "crs2", "sbplx", "crs2-joint", ... until time_s is up */
	double max_theta;      /* degrees, in (0, 90]: entries with theta_i or theta_o above it are left out */
	double sigma;          /* fixed, in [1e-4, 4], or NaN */
	double gamma;          /* fixed, in the NDF's range, or NaN */
	double n;              /* fixed, in [1.0001, 100], or NaN */
	double time_s;         /* in (0, 1e6]; read for other algorithms only */
	double blend;          /* 0, or in (0, 1): kd <= 1 - blend, ks <= blend */
	int unbounded;         /* kd, ks may exceed 1; not with blend */
	int diffuse, specular; /* whether the model has the terms: one at least */
	int zero_is_missing;   /* entries that are 0 in all channels count as not measured */
	int gray;              /* one kd and one ks for all channels */
	int anisotropic;       /* of samples: two roughnesses and the angle of their axes, all searched */
	int burley;            /* the model has kg, too; needs the diffuse term */
	double exponent;       /* of that term: fixed, in [1, 20], or NaN */
	int lobes;             /* 1, or 2: with ks2, sigma2 and gamma2, too; not with "f82" */
	int starts;            /* 0 .. 100000 extra random starts */
	int threads;           /* 1 .. 1024; changes no result */
	uint64_t seed;         /* of random starts */
	/* Called at better shapes by one thread at a time, not always the caller's; NULL: never. */
	void (*trace)(void *data, const struct stdfit_step *step);
	void *trace_data;
	/* The fit stops soon after this has become other than 0; NULL: never. May be set by a signal handler, another
	 * thread or the trace, which runs beside threads that read it: those two store it atomically. */
	const volatile int *cancel;
};

struct stdfit_options stdfit_options_default(void);

/* struct stdfit_metrics - how far a model is from a measurement. */
struct stdfit_metrics {
	double error[3];      /* E = sum w |m - f|/sum w m under the weights none, cosine, solid-angle */
	double rms_cosine;    /* RMS of c (m - f), c = cos_i cos_o */
	double rms_cube_root; /* RMS of cbrt(c m) - cbrt(c f) */
	double log_error;     /* mean |ln((c m + 1e-3)/(c f + 1e-3))| */
	size_t entries;       /* of three channels, compared */
};

/* Parameters, as bits of stdfit_result.at_bound and .undetermined. */
enum stdfit_parameter {
	STDFIT_PARAMETER_SIGMA = 1,
	STDFIT_PARAMETER_GAMMA = 2,
	STDFIT_PARAMETER_N = 4,
	STDFIT_PARAMETER_KD = 8,  /* red; green and blue are the two next bits */
	STDFIT_PARAMETER_KS = 64, /* likewise */
	STDFIT_PARAMETER_K = 512,
	STDFIT_PARAMETER_ANGLE = 1024,
	STDFIT_PARAMETER_EXPONENT = 2048,
	STDFIT_PARAMETER_SIGMA2 = 4096,
	STDFIT_PARAMETER_GAMMA2 = 8192
};

/* stdfit_parameter_name - "sigma", "gamma", "n", "kd_r", ..., "ks_b", "k", "angle", "exponent", "sigma2", "gamma2" of one such bit; NULL for any other number. */
const char *stdfit_parameter_name(unsigned bit);

/* struct stdfit_result - of one NDF. */
struct stdfit_result {
	const char *ndf; /* its name */
	struct stdfit_model model;
	double sigma,
		gamma; /* of the NDF; NaN where it has none; of an anisotropic one sigma = sqrt(sigma_x sigma_y) */
	double sigma_x, sigma_y; /* along its axes; NaN where it has none */
	double angle;            /* degrees: azimuth of the axis of sigma_x, (-90, 90]; 0 if isotropic */
	double error;            /* E under the fit's own weight */
	double error_isotropic;  /* of an anisotropic fit: of the best isotropic model; else NaN */
	double lower_bound;      /* certified: no kd, ks of this shape goes below it */
	struct stdfit_metrics metrics;
	int converged; /* 0: a limit on evaluations or time ended the search */
	int starts, starts_agreeing;
	unsigned at_bound;     /* bits: parameters at an end of their range */
	unsigned undetermined; /* bits: parameters that the data leave open */
	long evaluations, passes;
	double seconds;
	stdfit_ndf *distribution; /* the NDF, owned by the result */
};

/* stdfit_result_clear - frees what a result owns. */
void stdfit_result_clear(struct stdfit_result *result);

typedef struct stdfit_context stdfit_context;

/* stdfit_context_new - what fits of measurements with this n_phi_d, 0 for scattered entries, share under the options' gaf,
 * weight, bins, max_theta and zero_is_missing. A fit with others is STDFIT_DOMAIN. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_context_new(stdfit_context **context, int n_phi_d,
							const struct stdfit_options *options,
							struct stdfit_error *error);
void stdfit_context_free(stdfit_context *context);

/* stdfit_fit - fits each NDF of the options into results[0 ..], in their order; n_results must be their number. On success
 * each is to be cleared with stdfit_result_clear(). STDFIT_NO_DATA, STDFIT_INTERRUPTED. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_fit(const stdfit_context *context, const stdfit_measurement *measurement,
						const struct stdfit_options *options, int n_results,
						struct stdfit_result *results, struct stdfit_error *error);

/* stdfit_estimate - about the least error that any of the NDFs will end with, within 0.3 % as a rule, for a fraction of the
 * work; infinity where one of them has no shape to search. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_estimate(const stdfit_context *context,
						     const stdfit_measurement *measurement,
						     const struct stdfit_options *options, double *estimate,
						     struct stdfit_error *error);

/* stdfit_compare - the metrics of a model against a measurement, without a fit. Of the options bins, max_theta,
 * zero_is_missing and threads are read. */
STDFIT_MUST_CHECK enum stdfit_status stdfit_compare(const stdfit_measurement *measurement,
						    const struct stdfit_model *model, const stdfit_ndf *ndf,
						    const struct stdfit_options *options,
						    struct stdfit_metrics *metrics, struct stdfit_error *error);

#ifdef __cplusplus
}
#endif

#endif
