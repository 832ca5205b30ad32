/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stability - every function of the mathematics over the extremes of its domain: how far from high precision, NaN,
 * infinities, values out of bounds, breaks of monotony, floating-point exceptions. `make stability` runs it.
 *     stability FILE.csv      writes one row per quantity and distribution, prints the summary; exit 1 where something
 *                             is not as the headers say */
#include "extremes.h"
#include "fit/error/kernel.h"
#include "fit/error/objective.h"
#include "high_precision.h"
#include "src/cook_torrance.h"
#include "src/dielectric.h"
#include "src/ellipsoid.h"
#include "src/energy.h"
#include "src/ndf_cdf.h"
#include "src/ndf_slopes.h"
#include "src/pwl.h"
#include "src/random_walk.h"
#include "src/vndf.h"
#include <fenv.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define TRAPS (FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW)

struct row {
	char quantity[32], of[32];
	long points, refused, nan, inf, bounds, monotony, traps;
	double worst, allowed; /* error, and what the header allows there, at the point where they are closest */
	char where[160];
	char what[240]; /* the first finding */
};

enum { ROWS_MAX = 512 };
static struct row rows[ROWS_MAX];
static int n_rows;
static char at_hand[160]; /* the parameters at hand */

static struct row *row_of(const char *quantity, const char *of)
{
	for (int i = 0; i < n_rows; i++) {
		if (strcmp(rows[i].quantity, quantity) == 0 && strcmp(rows[i].of, of) == 0)
			return &rows[i];
	}
	if (n_rows == ROWS_MAX)
		abort();
	struct row *row = &rows[n_rows++];
	snprintf(row->quantity, sizeof(row->quantity), "%s", quantity);
	snprintf(row->of, sizeof(row->of), "%s", of);
	return row;
}

__attribute__((format(printf, 1, 2))) static void set_case(const char *format, ...)
{
	va_list args;
	va_start(args, format);
	vsnprintf(at_hand, sizeof(at_hand), format, args);
	va_end(args);
}

static void finding(struct row *row, long *count, const char *what, double value)
{
	if (row->what[0] == '\0')
		snprintf(row->what, sizeof(row->what), "%s %.17g: %s", what, value, at_hand);
	(*count)++;
}

/* What may come out of a call. */
struct expected {
	double low, high;      /* bounds */
	bool inf;              /* +infinity may, and then overflow and division by zero are no surprise */
	long double reference; /* NaN: none */
	double allowed;        /* relative error; of values below 1e-300 none is asked */
};

static void check_flags(struct row *row, int flags, double value)
{
	if (flags & FE_INVALID)
		finding(row, &row->traps, "invalid operation, result", value);
	else if (flags & FE_DIVBYZERO)
		finding(row, &row->traps, "division by zero, result", value);
	else if (flags & FE_OVERFLOW)
		finding(row, &row->traps, "overflow, result", value);
}

static void check(struct row *row, double value, int flags, struct expected expected)
{
	row->points++;
	const bool inf_expected =
		expected.inf || (isfinite(expected.reference) && expected.reference > (long double)DBL_MAX);
	check_flags(row, inf_expected && isinf(value) ? flags & FE_INVALID : flags, value);
	if (isnan(value)) {
		finding(row, &row->nan, "NaN", value);
		return;
	}
	if (isinf(value)) {
		if (!inf_expected)
			finding(row, &row->inf, "infinity", value);
		return;
	}
	if (!(value >= expected.low && value <= expected.high))
		finding(row, &row->bounds, "out of bounds", value);
	if (isnan(expected.reference) || fabsl(expected.reference) < 1e-300L)
		return;
	const double error = (double)(fabsl((long double)value - expected.reference) / fabsl(expected.reference));
	if (error * row->allowed >= row->worst * expected.allowed) {
		row->worst = error;
		row->allowed = expected.allowed;
		snprintf(row->where, sizeof(row->where), "%s", at_hand);
	}
}

static void check_order(struct row *row, double before, double after, double slack)
{
	if (after > before + slack)
		finding(row, &row->monotony, "not monotonic", after);
}

/* In the second run the exceptions below really trap: the handler tells where and ends it. */
static bool armed;
static int trapping = TRAPS;

/* Sets `value` to an expression of calls into the library and `flags` to the exceptions that it raised. */
#define OBSERVE(value, flags, expression)                                                                              \
	do {                                                                                                           \
		feclearexcept(FE_ALL_EXCEPT);                                                                          \
		if (armed)                                                                                             \
			feenableexcept(trapping);                                                                      \
		(value) = expression;                                                                                  \
		if (armed)                                                                                             \
			fedisableexcept(TRAPS);                                                                        \
		(flags) = fetestexcept(TRAPS);                                                                         \
	} while (0)

static const double eps = 2.220446049250313e-16;
static const double uniform[] = {0.0, 0x1p-53, 1e-9, 0.1, 0.25, 0.5, 0.77, 0.999, 1.0 - 0x1p-53};

/* One distribution with parameters, and what is known of it. */
struct subject {
	struct ndf ndf;
	const char *name;
	bool quadrature; /* gtr and low: Lambda without a closed form */
	double a;        /* else: as in student_t.h */
	long double A;   /* low */
	struct vec3 w[EXTREME_DIRECTIONS];
	long double lambda[EXTREME_DIRECTIONS]; /* of w, reference */
};

static bool is(const struct subject *s, const char *name)
{
	return strcmp(s->name, name) == 0;
}

static long double reference_D(const void *context, struct vec3_long m)
{
	const struct subject *s = context;
	const struct ndf *ndf = &s->ndf;
	if (is(s, "gtr"))
		return reference_D_gtr(ndf->sigma_x, ndf->gamma, m);
	if (is(s, "low"))
		return reference_D_low(ndf->param[0], ndf->param[1], s->A, m);
	return reference_D_student(ndf->gamma, s->a, ndf->sigma_x, ndf->sigma_y, m);
}

static long double reference_lambda(const struct subject *s, struct vec3 w)
{
	const struct ndf *ndf = &s->ndf;
	if (w.x == 0.0 && w.y == 0.0)
		return 0.0L;
	if (w.z < 1e-290 || armed) /* denormal numbers on the way */
		return NAN;
	if (s->quadrature) {
		const long double mu = (long double)w.z / hypotl((long double)w.x, (long double)w.y);
		const long double lambda =
			mu >= 1e-10L && mu <= 1e10L ? reference_lambda_quadrature(reference_D, s, ndf->gamma, mu) : NAN;
		return lambda > 1e-280L ? lambda : NAN; /* D is denormal */
	}
	if (isinf(ndf->gamma))
		return reference_lambda_beckmann(ndf->sigma_x, ndf->sigma_y, w);
	return reference_lambda_student(ndf->gamma, s->a, ndf->sigma_x, ndf->sigma_y, w);
}

/* Fills in what follows from s->ndf. */
static void complete(struct subject *s)
{
	const struct ndf *ndf = &s->ndf;
	s->name = ndf_name(ndf->class);
	s->quadrature = is(s, "gtr") || is(s, "low");
	s->A = is(s, "low") && !armed ? reference_low_A(ndf->param[0], ndf->param[1]) : NAN;
	s->a = ndf->gamma - 1.0;
	if (is(s, "hyper-cauchy") || isinf(ndf->gamma))
		s->a = 1.0;
	if (is(s, "t-family") && !isinf(ndf->gamma))
		s->a = ndf->gamma - ndf->param[2];
	extreme_directions(ndf->sigma_x, s->w);
	for (int i = 0; i < EXTREME_DIRECTIONS; i++)
		s->lambda[i] = reference_lambda(s, s->w[i]);
}

/* What the factor of hyper-cauchy and t-family adds to errors, and the powers of gtr and low. */
static double allowed_more(const struct subject *s)
{
	const double gamma = fmin(s->ndf.gamma, 1e18);
	if (s->quadrature)
		return 1e-15 * gamma;
	return is(s, "hyper-cauchy") || is(s, "t-family") ? 2e-16 * (1.0 + gamma) : 0.0;
}

static double allowed_lambda(const struct subject *s, double lambda)
{
	if (s->quadrature)
		return fmin(2e-8, 1e-12 * (1.0 + lambda) / lambda);
	return (lambda > 1e-20 ? 3e-14 : 1e-12) + allowed_more(s);
}

static double allowed_G1(const struct subject *s)
{
	return s->quadrature ? 1e-12 : 1e-15 + allowed_more(s);
}

static void at_direction(const struct subject *s, const char *name, struct vec3 w)
{
	set_case("sigma %g gamma %.17g %s (%g, %g, %g)", s->ndf.sigma_x, s->ndf.gamma, name, w.x, w.y, w.z);
}

static void sweep_D(const struct subject *s)
{
	struct row *D_row = row_of("D", s->name), *pdf_row = row_of("pdf", s->name), *P22_row = row_of("P22", s->name);
	for (int i = 0; i < EXTREME_DIRECTIONS; i++) {
		const struct vec3 m = s->w[i];
		/* Closer to the horizon than 1e-100 counts as that close. */
		const long double D = m.z == 0.0 ? 0.0L : m.z >= 1e-100 ? reference_D(s, lengthen(m)) : NAN;
		double value;
		int flags;
		at_direction(s, "m", m);
		OBSERVE(value, flags, ndf_D(&s->ndf, m));
		check(D_row, value, flags, (struct expected){0.0, INFINITY, false, D, 2e-15 + allowed_more(s)});
		OBSERVE(value, flags, ndf_pdf(&s->ndf, m));
		check(pdf_row, value, flags,
		      (struct expected){0.0, INFINITY, false, D * (long double)m.z, 2.3e-15 + allowed_more(s)});
		OBSERVE(value, flags, ndf_P22(&s->ndf, m.x / fmax(m.z, 1e-150), 0.0));
		check(P22_row, value, flags, (struct expected){0.0, INFINITY, false, NAN, 1.0});
	}
}

/* Lambda overflows where K/z does. */
static bool lambda_may_overflow(const struct subject *s, struct vec3 w)
{
	return w.z == 0.0 || w.z < 1e-275 * fmax(1.0, s->ndf.sigma_x);
}

static void sweep_lambda(const struct subject *s)
{
	struct row *lambda_row = row_of("Lambda", s->name), *G1_row = row_of("G1", s->name);
	double before_lambda = 0.0, before_G1 = 1.0;
	for (int i = 0; i < EXTREME_DIRECTIONS; i++) {
		const struct vec3 w = s->w[i];
		const long double lambda = s->lambda[i];
		const bool inf = lambda_may_overflow(s, w);
		double value;
		int flags;
		at_direction(s, "w", w);
		trapping = inf ? FE_INVALID : TRAPS;
		OBSERVE(value, flags, ndf_lambda(&s->ndf, w));
		check(lambda_row, value, flags,
		      (struct expected){0.0, INFINITY, inf, lambda, allowed_lambda(s, (double)lambda)});
		check_order(lambda_row, -before_lambda, -value,
			    s->quadrature ? 2e-12 * (1.0 + value) : 1e-13 * before_lambda);
		before_lambda = value;
		OBSERVE(value, flags, ndf_G1(&s->ndf, w));
		check(G1_row, value, inf ? flags & FE_INVALID : flags,
		      (struct expected){0.0, 1.0, false, 1.0L / (1.0L + lambda), allowed_G1(s)});
		check_order(G1_row, before_G1, value, s->quadrature ? 2e-12 : 4e-16);
		before_G1 = value;
		trapping = TRAPS;
	}
}

/* Along x and y, and between them, with another roughness along y. */
static void sweep_anisotropic(const struct subject *s)
{
	struct subject a = *s;
	if (!ndf_has_anisotropy(s->ndf.class) ||
	    ndf_init(&a.ndf, s->ndf.class, s->ndf.sigma_x, sqrt(s->ndf.sigma_x), s->ndf.gamma) != STATUS_OK)
		return;
	struct row *D_row = row_of("D anisotropic", s->name), *lambda_row = row_of("Lambda anisotropic", s->name);
	for (int i = 0; i < EXTREME_DIRECTIONS; i += 3) {
		for (double phi = 0.0; phi < 1.7; phi += 0.25 * M_PI) {
			const struct vec3 w = turned(s->w[i], phi);
			const bool inf = lambda_may_overflow(s, w) || w.z < 1e-270;
			const long double D = w.z == 0.0 ? 0.0L : w.z >= 1e-100 ? reference_D(&a, lengthen(w)) : NAN;
			const long double lambda = reference_lambda(&a, w);
			double value;
			int flags;
			at_direction(s, "along", w);
			OBSERVE(value, flags, ndf_D(&a.ndf, w));
			check(D_row, value, flags, (struct expected){0.0, INFINITY, false, D, 2e-15 + allowed_more(s)});
			trapping = inf ? FE_INVALID : TRAPS;
			OBSERVE(value, flags, ndf_lambda(&a.ndf, w));
			check(lambda_row, value, flags,
			      (struct expected){0.0, INFINITY, inf, lambda, allowed_lambda(s, (double)lambda)});
			trapping = TRAPS;
		}
	}
}

static void sweep_P2(const struct subject *s)
{
	struct row *row = row_of("P2", s->name);
	const struct ndf *ndf = &s->ndf;
	const long double K = s->quadrature || armed ? NAN
			      : isinf(ndf->gamma)    ? 1 / sqrtl(pi_l)
						     : reference_K(ndf->gamma);
	double before = INFINITY;
	for (int i = 0; i < EXTREME_DIRECTIONS; i++) { /* steeper and steeper */
		const double q = s->w[i].x / fmax(s->w[i].z, 1e-150);
		const long double t = (long double)q / (long double)ndf->sigma_x;
		const long double power =
			isinf(ndf->gamma) ? -t * t
					  : (0.5L - (long double)ndf->gamma) * log1pl(t * t / (long double)s->a);
		const long double sP2 = K * expl(power) / sqrtl((long double)s->a);
		double value;
		int flags;
		set_case("sigma %g gamma %.17g slope %g", ndf->sigma_x, ndf->gamma, q);
		OBSERVE(value, flags, ndf_P2(ndf, 0.0, q));
		check(row, value, flags,
		      (struct expected){0.0, INFINITY, false, sP2 / (long double)ndf->sigma_x,
					2e-15 + 1e-15 * fabs((double)logl(sP2)) + allowed_more(s)});
		if (!is(s, "gtr") || ndf->sigma_x <= 1.0) /* else the horizon is where most normals are */
			check_order(row, before, value, s->quadrature ? 1e-11 * value : 0.0);
		before = value;
	}
	struct row *moments = row_of("moments", s->name);
	for (int order = 0; order < 40; order += 3) {
		double value = 0.0;
		int flags;
		enum status status;
		set_case("sigma %g gamma %.17g order %d", ndf->sigma_x, ndf->gamma, order);
		OBSERVE(status, flags, ndf_moment(ndf, 0.3, order, &value));
		if (status == STATUS_OK)
			check(moments, value, flags, (struct expected){0.0, INFINITY, false, NAN, 1.0});
	}
}

/* The slope below which the share u of normals lies. */
static long double reference_slope(const struct subject *s, double u)
{
	const struct ndf *ndf = &s->ndf;
	if (s->quadrature)
		return NAN;
	const long double less = -log1pl(-(long double)u);
	const long double t2 =
		isinf(ndf->gamma) ? less : (long double)s->a * expm1l(less / ((long double)ndf->gamma - 1));
	return (long double)ndf->sigma_x * sqrtl(t2);
}

static void sweep_sample(const struct subject *s)
{
	struct row *row = row_of("sample", s->name);
	double before = 0.0;
	for (int i = 0; i < COUNT(uniform); i++) {
		for (int j = 0; j < COUNT(uniform); j++) {
			struct vec3 m;
			int flags;
			set_case("sigma %g gamma %.17g u %g %g", s->ndf.sigma_x, s->ndf.gamma, uniform[j], uniform[i]);
			OBSERVE(m, flags, ndf_sample(&s->ndf, uniform[j], uniform[i]));
			const double slope = hypot(m.x, m.y) / m.z;
			const bool known = m.z > 1e-6; /* as ndf.h has it */
			check(row, m.z, flags, (struct expected){0.0, 1.0, false, NAN, 1.0});
			check(row, vec3_length(m), 0,
			      (struct expected){1.0 - 4.0 * eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
			check(row, known ? slope : 0.0, 0,
			      (struct expected){0.0, INFINITY, false, known ? reference_slope(s, uniform[i]) : NAN,
						1e-14});
			check_order(row, -before, -slope, 1e-14 * before);
			if (j == COUNT(uniform) - 1)
				before = slope * (1.0 - 1e-14);
		}
	}
}

/* The share of normals below theta, reference. */
static long double reference_share(const struct subject *s, double theta)
{
	const struct ndf *ndf = &s->ndf;
	const long double t = tanl((long double)theta) / (long double)ndf->sigma_x, q = t * t;
	if (s->quadrature || theta == 0.5 * M_PI)
		return NAN;
	return isinf(ndf->gamma) ? -expm1l(-q) : -expm1l((1 - (long double)ndf->gamma) * log1pl(q / (long double)s->a));
}

/* The shares of normals below theta and in (0, phi). */
static void sweep_cdfs(const struct subject *s)
{
	struct row *row = row_of("CDF of theta", s->name), *joint_row = row_of("CDF", s->name);
	struct ndf flat = s->ndf;
	double before = 0.0;
	if (ndf_has_anisotropy(flat.class) &&
	    ndf_init(&flat, s->ndf.class, s->ndf.sigma_x, sqrt(s->ndf.sigma_x), s->ndf.gamma) != STATUS_OK)
		abort();
	for (int i = 0; i < EXTREME_DIRECTIONS; i++) { /* from the normal down */
		const double theta = atan2(s->w[i].x, s->w[i].z), phi = 0.7 * (i % 9);
		const long double share = reference_share(s, theta);
		double value;
		int flags;
		set_case("sigma %g gamma %.17g theta %.17g phi %g", s->ndf.sigma_x, s->ndf.gamma, theta, phi);
		OBSERVE(value, flags, ndf_cdf_theta(&s->ndf, theta, phi));
		check(row, value, flags, (struct expected){0.0, 1.0, false, share, 1e-14 / (double)share});
		check_order(row, -before, -value, 1e-14);
		before = value;
		OBSERVE(value, flags, ndf_cdf_phi(&flat, phi));
		check(row_of("CDF of phi", s->name), value, flags, (struct expected){0.0, 1.0, false, NAN, 1.0});
		if (i % 4 != 0) /* it is slow */
			continue;
		OBSERVE(value, flags, ndf_cdf(&flat, theta, phi));
		check(joint_row, value, flags, (struct expected){0.0, 1.0 + 1e-12, false, NAN, 1.0});
	}
}

/* A normal drawn by one of the samplers: a unit vector above the horizon, with a density. */
static void check_drawn(const struct sampler *sampler, struct vec3 wi, double u1, double u2, struct row *row)
{
	struct vec3 m;
	double pdf;
	int flags;
	OBSERVE(m, flags, sampler_sample(sampler, wi, u1, u2));
	check(row, m.z, flags, (struct expected){0.0, 1.0, false, NAN, 1.0});
	check(row, vec3_length(m), 0, (struct expected){1.0 - 4.0 * eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
	trapping = wi.z < 1e-270 ? FE_INVALID : TRAPS;
	OBSERVE(pdf, flags, sampler_pdf(sampler, wi, m));
	check(row, pdf, flags & trapping, (struct expected){0.0, INFINITY, false, NAN, 1.0});
	trapping = TRAPS;
}

/* The samplers of the papers: the substitute for visible normals, and the rational fit. And where what is drawn stands among
 * the visible normals. */
static void sweep_samplers(const struct subject *s)
{
	for (int k = 0; k < SAMPLING_COUNT; k++) {
		struct sampler sampler;
		char name[64];
		if (sampler_init(&sampler, &s->ndf, (enum sampling)k) != STATUS_OK)
			continue;
		snprintf(name, sizeof(name), "sampler %s", sampling_name((enum sampling)k));
		for (int i = 0; i < EXTREME_DIRECTIONS; i += 3)
			for (int j = i % 4; j < COUNT(uniform) * COUNT(uniform); j += 4) {
				const struct vec3 wi = turned(s->w[i], 0.4 * i);
				const double u1 = uniform[j % COUNT(uniform)], u2 = uniform[j / COUNT(uniform)];
				set_case("sigma %g gamma %.17g wi (%g, %g, %g) u %g %g", s->ndf.sigma_x, s->ndf.gamma,
					 wi.x, wi.y, wi.z, u1, u2);
				check_drawn(&sampler, wi, u1, u2, row_of(name, s->name));
			}
	}
	for (int i = 0; i < EXTREME_DIRECTIONS && vndf_supports(&s->ndf); i += 3)
		for (int j = 0; j < EXTREME_DIRECTIONS; j += 2) {
			const struct vec3 m = turned(s->w[j], 0.7);
			double along, across;
			int flags;
			set_case("sigma %g gamma %.17g wi (%g, 0, %g) m (%g, %g, %g)", s->ndf.sigma_x, s->ndf.gamma,
				 s->w[i].x, s->w[i].z, m.x, m.y, m.z);
			OBSERVE(along, flags, (vndf_cdf(&s->ndf, s->w[i], m, &along, &across), along));
			check(row_of("visible CDF", s->name), along, flags,
			      (struct expected){0.0, 1.0, false, NAN, 1.0});
			check(row_of("visible CDF", s->name), across, 0, (struct expected){0.0, 1.0, false, NAN, 1.0});
		}
}

static void sweep_visible(const struct subject *s)
{
	struct row *pdf_row = row_of("visible pdf", s->name), *sample_row = row_of("visible sample", s->name);
	for (int i = 0; i < EXTREME_DIRECTIONS; i += s->quadrature ? 4 : 2) {
		for (int j = 0; j < EXTREME_DIRECTIONS; j += 2) {
			const struct vec3 wi = s->w[i], m = turned(s->w[j], 0.7);
			const long double cos_d =
				(long double)wi.x * (long double)m.x + (long double)wi.z * (long double)m.z;
			const long double pdf =
				wi.z > 0.0 && m.z >= 1e-100
					? cos_d / (1 + s->lambda[i]) / (long double)wi.z * reference_D(s, lengthen(m))
					: NAN;
			double value;
			int flags;
			set_case("sigma %g gamma %.17g wi (%g, 0, %g) m (%g, %g, %g)", s->ndf.sigma_x, s->ndf.gamma,
				 wi.x, wi.z, m.x, m.y, m.z);
			trapping = wi.z < 1e-270 ? FE_INVALID : TRAPS;
			OBSERVE(value, flags, vndf_pdf(&s->ndf, wi, m));
			check(pdf_row, value, wi.z < 1e-270 ? flags & FE_INVALID : flags,
			      (struct expected){0.0, INFINITY, false, wi.z > 1e-290 ? pdf : NAN,
						4e-15 + allowed_more(s) + allowed_G1(s) + eps / (double)cos_d});
			trapping = TRAPS;
		}
		if (!vndf_supports(&s->ndf))
			continue;
		for (int j = i % 4; j < COUNT(uniform) * COUNT(uniform); j += 4) {
			const struct vec3 wi = s->w[i];
			const double u1 = uniform[j % COUNT(uniform)], u2 = uniform[j / COUNT(uniform)];
			struct vec3 m;
			int flags;
			set_case("sigma %g gamma %.17g wi (%g, 0, %g) u %g %g", s->ndf.sigma_x, s->ndf.gamma, wi.x,
				 wi.z, u1, u2);
			OBSERVE(m, flags, vndf_sample(&s->ndf, wi, u1, u2));
			check(sample_row, m.z, flags, (struct expected){DBL_MIN, 1.0, false, NAN, 1.0});
			check(sample_row, vec3_length(m), 0,
			      (struct expected){1.0 - 4.0 * eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
			check(sample_row, vec3_dot(wi, m), 0,
			      (struct expected){-eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
		}
	}
}

/* Visible normals from below the horizon. Where hardly any facet faces wi, no more is known of the sample than that it is
 * one. */
static void sweep_inside(const struct subject *s)
{
	struct row *area_row = row_of("area from below", s->name), *row = row_of("sample from below", s->name);
	for (int i = 0; i < EXTREME_DIRECTIONS && vndf_supports(&s->ndf); i += 2) {
		const struct vec3 wi = {s->w[i].x, 0.0, -s->w[i].z};
		double area;
		int flags;
		if (!(wi.z < -1e-90))
			continue;
		set_case("sigma %g gamma %.17g wi (%g, 0, %g)", s->ndf.sigma_x, s->ndf.gamma, wi.x, wi.z);
		OBSERVE(area, flags, vndf_area(&s->ndf, wi));
		check(area_row, area, flags,
		      (struct expected){0.0, INFINITY, false, -(long double)wi.z * s->lambda[i], 1e-12});
		for (int j = i % 4; j < COUNT(uniform) * COUNT(uniform) && area > 1e-280; j += 4) {
			const double u1 = uniform[j % COUNT(uniform)], u2 = uniform[j / COUNT(uniform)];
			struct vec3 m;
			set_case("sigma %g gamma %.17g wi (%g, 0, %g) u %g %g", s->ndf.sigma_x, s->ndf.gamma, wi.x,
				 wi.z, u1, u2);
			OBSERVE(m, flags, vndf_sample_inside(&s->ndf, wi, u1, u2));
			check(row, m.z, flags, (struct expected){DBL_MIN, 1.0, false, NAN, 1.0});
			check(row, vec3_length(m), 0,
			      (struct expected){1.0 - 4.0 * eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
			check(row, vec3_dot(wi, m), 0, (struct expected){-eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
		}
	}
}

/* The next of a fixed sequence of numbers, with the ends of the range among them. */
static double next_number(void *state)
{
	int *i = state;
	const double u = fmod(0.5 + 0.6180339887498949 * ++*i, 1.0);
	return *i % 16 ? u : uniform[*i / 16 % COUNT(uniform)];
}

/* Rough dielectrics, and walks between the facets: nothing but directions and weights of their range comes out. */
static void sweep_transmission(const struct subject *s)
{
	static const double indices[] = {1e-50, 0.3, 1.0 - 1e-9, 1.5, 1e9};
	struct row *f_row = row_of("dielectric f", s->name), *row = row_of("dielectric sample", s->name);
	const enum sampling sampling = vndf_supports(&s->ndf) ? SAMPLING_VISIBLE : SAMPLING_NDF;
	for (int i = 0; i < EXTREME_DIRECTIONS; i += s->quadrature ? 6 : 3) {
		const struct vec3 wi = i % 2 ? s->w[i] : vec3_opposite(s->w[i]);
		struct dielectric dielectric;
		int flags;
		if (!(s->w[i].z > 1e-90) || dielectric_init(&dielectric, &s->ndf, (enum gaf)(i % 2),
							    indices[i / 3 % COUNT(indices)]) != STATUS_OK)
			continue;
		trapping = FE_INVALID;
		for (int j = 0; j < EXTREME_DIRECTIONS; j++) {
			const struct vec3 across = turned(s->w[j], j % 2 ? M_PI : 0.7);
			const struct vec3 wo = j % 3 ? vec3_opposite(across) : across;
			double f;
			set_case("sigma %g gamma %.17g n %g wi (%g, 0, %g) wo (%g, %g, %g)", s->ndf.sigma_x,
				 s->ndf.gamma, dielectric.side[0].n, wi.x, wi.z, wo.x, wo.y, wo.z);
			OBSERVE(f, flags, dielectric_f(&dielectric, wi, wo));
			check(f_row, f, flags & trapping, (struct expected){0.0, INFINITY, true, NAN, 1.0});
			OBSERVE(f, flags, dielectric_pdf(&dielectric, sampling, wi, wo));
			check(f_row, f, flags & trapping, (struct expected){0.0, INFINITY, true, NAN, 1.0});
		}
		for (int j = 0; j < COUNT(uniform) * COUNT(uniform); j += 2) {
			const double u[3] = {uniform[j % COUNT(uniform)], uniform[j / COUNT(uniform)],
					     uniform[(i + j) % COUNT(uniform)]};
			struct dielectric_sample sample;
			set_case("sigma %g gamma %.17g n %g wi (%g, 0, %g) u %g %g %g", s->ndf.sigma_x, s->ndf.gamma,
				 dielectric.side[0].n, wi.x, wi.z, u[0], u[1], u[2]);
			OBSERVE(sample, flags, dielectric_sample(&dielectric, sampling, wi, u));
			check(row, vec3_length(sample.wo), flags & trapping,
			      (struct expected){1.0 - 4.0 * eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
			check(row, sample.weight, 0,
			      (struct expected){0.0, sampling == SAMPLING_VISIBLE ? 1.0 + 1e-9 : INFINITY, true, NAN,
						1.0});
		}
		trapping = TRAPS;
	}
}

static double walk_f(const struct random_walk *walk, struct vec3 wi, struct vec3 wo,
		     const struct random_numbers *numbers)
{
	double f[3];
	random_walk_f(walk, wi, wo, 50, numbers, f);
	return f[0];
}

/* Between mirrors of metal, which keep a part of the light. */
static void sweep_mirror_walk(const struct subject *s, struct vec3 wi, const struct random_numbers *numbers,
			      struct row *row)
{
	static const double n[3] = {0.143, 1.0, 1e3}, k[3] = {3.98, 1e-3, 1e3};
	struct random_walk walk;
	struct random_walk_exit out;
	double f;
	int flags;
	if (random_walk_init_mirror(&walk, &s->ndf, FRESNEL_CONDUCTOR, n, k) != STATUS_OK)
		abort();
	OBSERVE(out, flags, random_walk_sample(&walk, wi, numbers));
	check(row, vec3_length(out.wo), flags & trapping,
	      (struct expected){1.0 - 4.0 * eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
	for (int c = 0; c < 3; c++)
		check(row, out.weight[c], 0, (struct expected){0.0, 1.0 + 1e-12, false, NAN, 1.0});
	OBSERVE(f, flags, walk_f(&walk, wi, out.wo, numbers));
	check(row, f, flags & trapping, (struct expected){0.0, INFINITY, true, NAN, 1.0});
}

static void sweep_walks(const struct subject *s)
{
	struct row *row = row_of("random walk", s->name);
	int count = 0;
	const struct random_numbers numbers = {next_number, &count};
	/* Nearer to gamma = 1.5, or rougher, a walk takes its time. */
	if (!vndf_supports(&s->ndf) || s->ndf.gamma < 1.51 || s->ndf.sigma_x > 1e3)
		return;
	for (int i = 0; i < EXTREME_DIRECTIONS; i++) {
		const struct vec3 wi = i % 2 ? s->w[i] : vec3_opposite(s->w[i]);
		struct random_walk walk;
		struct random_walk_exit out;
		double f;
		int flags;
		if (!(s->w[i].z > 1e-90) ||
		    random_walk_init_dielectric(&walk, &s->ndf, i % 4 < 2 ? 1.5 : 0.4) != STATUS_OK)
			continue;
		trapping = FE_INVALID;
		set_case("sigma %g gamma %.17g wi (%g, 0, %g) n %g, after %d numbers", s->ndf.sigma_x, s->ndf.gamma,
			 wi.x, wi.z, walk.n[0], count);
		OBSERVE(out, flags, random_walk_sample(&walk, wi, &numbers));
		check(row, vec3_length(out.wo), flags & trapping,
		      (struct expected){1.0 - 4.0 * eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
		check(row, out.weight[0], 0, (struct expected){1.0, 1.0, false, NAN, 1.0});
		OBSERVE(f, flags, walk_f(&walk, wi, out.wo, &numbers));
		check(row, f, flags & trapping, (struct expected){0.0, INFINITY, true, NAN, 1.0});
		sweep_mirror_walk(s, s->w[i], &numbers, row_of("walk of a metal", s->name));
		trapping = TRAPS;
	}
}

/* |d ln D/d ln q| at a normal: what the rounding of h does to D. */
static double sharpness(const struct subject *s, struct vec3_long h)
{
	const struct ndf *ndf = &s->ndf;
	const double t2 = (double)((h.x * h.x + h.y * h.y) / (h.z * h.z)), sigma2 = ndf->sigma_x * ndf->sigma_x;
	if (s->quadrature)
		return ndf->gamma;
	const double q = t2 / sigma2;
	return isinf(ndf->gamma) ? q : ndf->gamma * (q / s->a) / (1.0 + q / s->a);
}

static long double reference_G_over(enum gaf gaf, const struct subject *s, int i, int j, struct vec3_long sum)
{
	const long double zi = (long double)s->w[i].z, zo = (long double)s->w[j].z;
	const long double length = sqrtl(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
	if (gaf == GAF_UNCORRELATED)
		return 1 / (zi * (1 + s->lambda[i])) / (zo * (1 + s->lambda[j]));
	if (gaf == GAF_CORRELATED)
		return 1 / (1 + s->lambda[i] + s->lambda[j]) / zi / zo;
	return fminl(1, 4 * sum.z / length * (fminl(zi, zo) / length)) / zi / zo;
}

static long double dielectric(long double c, long double n)
{
	const long double g = sqrtl(n * n - 1 + c * c);
	const long double r_s = (c - g) / (c + g), r_p = (n * n * c - g) / (n * n * c + g);
	return (r_s * r_s + r_p * r_p) / 2;
}

/* G and the whole specular term: all pairs of directions, in one plane on one side and on both, and across. */
static void sweep_pairs(const struct subject *s)
{
	static const double azimuth[] = {0.0, M_PI, 1.1};
	for (int gaf = 0; gaf < GAF_COUNT; gaf++) {
		char name[64];
		snprintf(name, sizeof(name), "G %s", gaf_name((enum gaf)gaf));
		struct row *G_row = row_of(name, s->name);
		snprintf(name, sizeof(name), "f %s", gaf_name((enum gaf)gaf));
		struct row *f_row = row_of(name, s->name);
		const struct cook_torrance model = {.ndf = s->ndf,
						    .gaf = (enum gaf)gaf,
						    .fresnel = FRESNEL_DIELECTRIC,
						    .n = 1.5,
						    .ks = {1.0, 1.0, 1.0}};
		const int stride = s->quadrature ? 11 : 5;
		for (int p = 0; p < EXTREME_DIRECTIONS * EXTREME_DIRECTIONS * COUNT(azimuth); p += stride) {
			const int i = p % EXTREME_DIRECTIONS, j = p / EXTREME_DIRECTIONS % EXTREME_DIRECTIONS;
			const double phi = azimuth[p / EXTREME_DIRECTIONS / EXTREME_DIRECTIONS];
			const struct vec3 wi = s->w[i];
			struct vec3 wo = turned(s->w[j], phi);
			if (phi == M_PI)
				wo.y = 0.0;
			const struct vec3_long sum = {(long double)wi.x + (long double)wo.x,
						      (long double)wi.y + (long double)wo.y,
						      (long double)wi.z + (long double)wo.z};
			const bool above = wi.z > 0.0 && wo.z > 0.0, denormal = wi.z < 1e-270 || wo.z < 1e-270;
			const long double over = above && !armed ? reference_G_over((enum gaf)gaf, s, i, j, sum) : NAN;
			const long double length = sqrtl(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
			const struct vec3_long h = {sum.x / length, sum.y / length, sum.z / length};
			const bool known = above && !denormal && h.z > 1e-90L;
			double value, f[3];
			int flags;
			set_case("sigma %g gamma %.17g wi (%g, 0, %g) wo (%g, %g, %g)", s->ndf.sigma_x, s->ndf.gamma,
				 wi.x, wi.z, wo.x, wo.y, wo.z);
			trapping = denormal ? FE_INVALID : TRAPS;
			OBSERVE(value, flags, gaf_G((enum gaf)gaf, &s->ndf, wi, wo));
			check(G_row, value, flags & trapping,
			      (struct expected){0.0, 1.0, false,
						known   ? over * (long double)wi.z * (long double)wo.z
						: above ? NAN
							: 0.0L,
						2e-15 + 2.0 * allowed_G1(s)});
			OBSERVE(f[0], flags, (cook_torrance_f(&model, wi, wo, f), f[0]));
			const long double lobe = known   ? dielectric(length / 2, 1.5L) * reference_D(s, h) * over / 4
						 : above ? NAN
							 : 0.0L;
			check(f_row, f[0], flags & trapping,
			      (struct expected){0.0, INFINITY, denormal, lobe,
						1e-14 + allowed_more(s) + 2.0 * allowed_G1(s) +
							2e-15 * sharpness(s, h)});
			trapping = TRAPS;
		}
	}
}

static void sweep_opposite(const struct subject *s)
{
	const struct cook_torrance model = {
		.ndf = s->ndf, .fresnel = FRESNEL_CONDUCTOR, .n = 1.5, .k = 1e3, .ks = {1, 1, 1}};
	for (int i = 0; i < EXTREME_DIRECTIONS; i++) {
		const struct vec3 wi = s->w[i];
		double f[3];
		int flags;
		at_direction(s, "wo = -wi, wi", wi);
		OBSERVE(f[0], flags, (cook_torrance_f(&model, wi, vec3_scale(wi, -1.0), f), f[0]));
		check(row_of("f opposite", s->name), f[0], flags, (struct expected){0.0, 0.0, false, NAN, 1.0});
	}
}

static void sweep_energy(const struct subject *s)
{
	static const double cos_i[] = {1.0, 0.7, 0.01, 1.7453292e-4, 1e-10, 1e-300, 0.0};
	for (int gaf = 0; gaf < GAF_COUNT && !armed; gaf++) {
		const struct cook_torrance mirror = {.ndf = s->ndf, .gaf = (enum gaf)gaf, .fresnel = FRESNEL_NONE};
		for (int i = 0; i < COUNT(cos_i); i++) {
			double albedo = NAN;
			set_case("sigma %g gamma %.17g %s cos_i %g", s->ndf.sigma_x, s->ndf.gamma,
				 gaf_name((enum gaf)gaf), cos_i[i]);
			if (energy_lobe(&mirror, cos_i[i], &albedo) == STATUS_OK)
				check(row_of("albedo", s->name), albedo, 0,
				      (struct expected){0.0, 1.0 + 1e-7, false, NAN, 1.0});
		}
	}
}

static void sweep_subject(struct subject *s, bool few)
{
	complete(s);
	sweep_D(s);
	sweep_lambda(s);
	sweep_anisotropic(s);
	sweep_P2(s);
	sweep_sample(s);
	sweep_opposite(s);
	sweep_cdfs(s);
	sweep_visible(s);
	sweep_samplers(s);
	sweep_inside(s);
	sweep_transmission(s);
	sweep_walks(s);
	sweep_pairs(s);
	if (few && s->ndf.sigma_x < 5.0)
		sweep_energy(s);
}

static void sweep_distributions(void)
{
	for (int d = 0; ndf_at(d); d++) {
		if (ndf_is_tabulated(ndf_at(d)))
			continue;
		for (int i = 0; i < COUNT(extreme_sigma); i++)
			for (int j = 0; j < COUNT(extreme_gamma); j++) {
				struct subject subject;
				if (!ndf_has_gamma(ndf_at(d)) && j > 0)
					break;
				if (j % 3 != 1 && ndf_has_gamma(ndf_at(d)) &&
				    ndf_at(d) != ndf_find("std")) /* they share its formulas, or are slow */
					continue;
				if (ndf_init(&subject.ndf, ndf_at(d), extreme_sigma[i], extreme_sigma[i],
					     extreme_gamma[j]) != STATUS_OK) {
					row_of("D", ndf_name(ndf_at(d)))->refused++;
					continue;
				}
				sweep_subject(&subject, j % 5 == 1);
			}
	}
}

/* What lambda_form.h says of G1 in one of the forms. */
static double allowed_form(enum lambda_form form, double gamma)
{
	if (form == LAMBDA_RATIONAL)
		return 0.0072;
	if (form != LAMBDA_2F1)
		return 1e-13;
	return gamma < 40.0 ? 2e-14 : gamma <= 1e3 ? 2e-13 : 2e-12;
}

static void sweep_forms(void)
{
	static const double more[] = {4.0, 7.0, 12.0, 15.0, 3.5, 4.5, 8.5, 14.5};
	for (int f = LAMBDA_2F1; f < LAMBDA_FORM_COUNT; f++)
		for (int j = 0; j < COUNT(extreme_gamma) + COUNT(more); j++) {
			const enum lambda_form form = (enum lambda_form)f;
			struct subject s;
			struct row *lambda_row = row_of("Lambda by form", lambda_form_name(form));
			struct row *row = row_of("G1 by form", lambda_form_name(form));
			const double gamma =
				j < COUNT(extreme_gamma) ? extreme_gamma[j] : more[j - COUNT(extreme_gamma)];
			const double sigma = extreme_sigma[j % COUNT(extreme_sigma)];
			if (ndf_init(&s.ndf, ndf_find("std"), sigma, sigma, gamma) != STATUS_OK)
				abort();
			complete(&s);
			if (ndf_set_lambda_form(&s.ndf, form) != STATUS_OK) {
				row->refused++;
				continue;
			}
			for (int i = 0; i < EXTREME_DIRECTIONS; i++) {
				const bool inf = lambda_may_overflow(&s, s.w[i]);
				double value;
				int flags;
				at_direction(&s, "w", s.w[i]);
				trapping = inf ? FE_INVALID : TRAPS;
				OBSERVE(value, flags, ndf_lambda(&s.ndf, s.w[i]));
				check(lambda_row, value, flags, (struct expected){0.0, INFINITY, inf, NAN, 1.0});
				OBSERVE(value, flags, ndf_G1(&s.ndf, s.w[i]));
				check(row, value, flags & trapping,
				      (struct expected){0.0, 1.0, false, 1.0L / (1.0L + s.lambda[i]),
							allowed_form(form, gamma)});
				trapping = TRAPS;
			}
		}
}

static void sweep_fresnel(void)
{
	static const double cosines[] = {
		0.0, 4.9406564584124654e-324, 1e-300, 1e-160,  1e-30,         1e-8, 1e-3, 0.1, 0.5,
		0.7, 0.70710678118654757,     0.9,    0.99999, 1.0 - 0x1p-53, 1.0};
	static const double index[] = {1.0, 1.0 + 0x1p-52, 1.0000001, 1.0001, 1.5,  3.0,  100.0,
				       1e3, 1e10,          1e75,      0.3,    1e-3, 1e-20};
	static const double absorption[] = {
		0.0, 4.9406564584124654e-324, 1e-300, 1e-170, 1e-100, 1e-20, 1e-8, 1e-3, 0.5, 3.0, 1e3, 1e8, 1e75};
	for (int i = 0; i < COUNT(cosines); i++)
		for (int j = 0; j < COUNT(index); j++) {
			const double c = cosines[i], n = index[j];
			double value;
			int flags;
			set_case("cos_d %.17g n %.17g", c, n);
			/* Close to the critical angle the value itself is as ill-conditioned as a square root at 0. */
			const long double g2 = (long double)n * (long double)n - 1 + (long double)c * (long double)c;
			const double critical = n < 1.0 ? (double)(1 / sqrtl(fabsl(g2) + 1e-30L)) : 1.0;
			OBSERVE(value, flags, fresnel_F(FRESNEL_DIELECTRIC, c, n, 0.0));
			check(row_of("Fresnel", "dielectric"), value, flags,
			      (struct expected){0.0, 1.0, false, armed ? NAN : reference_fresnel(c, n, 0.0),
						2e-15 * fmax(1.0, critical)});
			const long double root = ((long double)n - 1) / ((long double)n + 1), F0 = root * root;
			OBSERVE(value, flags, fresnel_F(FRESNEL_SCHLICK, c, n, 0.0));
			check(row_of("Fresnel", "schlick"), value, flags,
			      (struct expected){0.0, 1.0, false, F0 + (1 - F0) * powl(1 - (long double)c, 5), 2e-15});
			for (int k = 0; k < COUNT(absorption); k++) {
				set_case("cos_d %.17g n %.17g k %g", c, n, absorption[k]);
				OBSERVE(value, flags, fresnel_F(FRESNEL_CONDUCTOR, c, n, absorption[k]));
				check(row_of("Fresnel", "conductor"), value, flags,
				      (struct expected){
					      0.0, 1.0, false, armed ? NAN : reference_fresnel(c, n, absorption[k]),
					      absorption[k] > 0.0 && absorption[k] < 1e-150
						      ? 1.0
						      : 2e-15 * fmax(1.0, absorption[k] < 1e-3 ? critical : 1.0)});
			}
		}
}

static void sweep_one_ellipsoid(const struct ellipsoid *e, const char *name, const char *matrix)
{
	struct vec3 w[EXTREME_DIRECTIONS];
	extreme_directions(0.1, w);
	for (int i = 0; i < EXTREME_DIRECTIONS; i++)
		for (double phi = 0.0; phi < 6.0; phi += 1.3) {
			const struct vec3 v = turned(w[i], phi);
			double value;
			int flags;
			set_case("%s w (%g, %g, %g)", matrix, v.x, v.y, v.z);
			OBSERVE(value, flags, ellipsoid_D(e, v));
			check(row_of("D", name), value, flags, (struct expected){0.0, INFINITY, false, NAN, 1.0});
			OBSERVE(value, flags, ellipsoid_G1(e, v));
			check(row_of("G1", name), value, flags, (struct expected){0.0, 1.0, false, NAN, 1.0});
			OBSERVE(value, flags, ellipsoid_smith(e, v));
			check(row_of("Smith", name), value, flags, (struct expected){0.0, INFINITY, false, NAN, 1.0});
			for (int j = i % 5; j < COUNT(uniform) * COUNT(uniform); j += 5) {
				struct vec3 m;
				OBSERVE(m, flags,
					ellipsoid_sample(e, v, uniform[j % COUNT(uniform)],
							 uniform[j / COUNT(uniform)]));
				check(row_of("visible sample", name), m.z, flags,
				      (struct expected){DBL_MIN, 1.0, false, NAN, 1.0});
				check(row_of("visible sample", name), vec3_dot(v, m), 0,
				      (struct expected){-eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
				trapping = v.z < 1e-270 ? FE_INVALID : TRAPS;
				OBSERVE(value, flags, ellipsoid_pdf(e, v, m));
				check(row_of("visible pdf", name), value, flags & trapping,
				      (struct expected){0.0, INFINITY, false, NAN, 1.0});
				trapping = TRAPS;
			}
		}
}

/* The same as one of the distributions. */
static void sweep_one_tilted(const struct ndf *ndf, const char *matrix)
{
	static const char name[] = "tilted";
	struct vec3 w[EXTREME_DIRECTIONS];
	extreme_directions(0.1, w);
	for (int i = 0; i < EXTREME_DIRECTIONS; i++)
		for (double phi = 0.0; phi < 6.0; phi += 1.3) {
			const struct vec3 v = turned(w[i], phi);
			double value;
			int flags;
			set_case("%s w (%g, %g, %g)", matrix, v.x, v.y, v.z);
			trapping = v.z < 1e-270 ? FE_INVALID : TRAPS;
			OBSERVE(value, flags, ndf_D(ndf, v));
			check(row_of("D", name), value, flags & trapping,
			      (struct expected){0.0, INFINITY, false, NAN, 1.0});
			OBSERVE(value, flags, ndf_G1(ndf, v));
			check(row_of("G1", name), value, flags & trapping,
			      (struct expected){0.0, 1.0, false, NAN, 1.0});
			for (int j = i % 5; j < COUNT(uniform) * COUNT(uniform); j += 5) {
				const double u1 = uniform[j % COUNT(uniform)], u2 = uniform[j / COUNT(uniform)];
				struct vec3 m;
				OBSERVE(m, flags, vndf_sample(ndf, v, u1, u2));
				check(row_of("visible sample", name), m.z, flags & trapping,
				      (struct expected){DBL_MIN, 1.0, false, NAN, 1.0});
				check(row_of("visible sample", name), vec3_dot(v, m), 0,
				      (struct expected){-eps, 1.0 + 4.0 * eps, false, NAN, 1.0});
				OBSERVE(value, flags, vndf_pdf(ndf, v, m));
				check(row_of("visible pdf", name), value, flags & trapping,
				      (struct expected){0.0, INFINITY, false, NAN, 1.0});
			}
			trapping = TRAPS;
		}
}

static void sweep_tilted(const struct ellipsoid *e, const char *matrix)
{
	struct ndf ndf;
	if (ndf_from_ellipsoid(&ndf, e) == STATUS_OK)
		sweep_one_tilted(&ndf, matrix);
	else
		row_of("D", "tilted")->refused++;
}

static void sweep_ellipsoid(void)
{
	for (int i = 0; i < COUNT(extreme_sigma); i++)
		for (int j = 0; j < COUNT(extreme_sigma); j++)
			for (int turn = (i + j) % 2; turn < 3; turn += 2) {
				struct ellipsoid e;
				char matrix[64];
				snprintf(matrix, sizeof(matrix), "alpha %g %g turn %d", extreme_sigma[i],
					 extreme_sigma[j], turn);
				if (ellipsoid_init_angles(&e, extreme_sigma[i], extreme_sigma[j], 0.4 * turn,
							  -0.7 * turn, 1.0 * turn) != STATUS_OK) {
					row_of("D", "ellipsoid")->refused++;
					continue;
				}
				sweep_one_ellipsoid(&e, "ellipsoid", matrix);
				sweep_tilted(&e, matrix);
			}
}

static void sweep_table(const char *name, const struct pwl *pwl)
{
	struct ndf ndf;
	struct vec3 w[EXTREME_DIRECTIONS];
	double before = 0.0;
	ndf_from_pwl(&ndf, pwl);
	extreme_directions(0.1, w);
	for (int i = 0; i < EXTREME_DIRECTIONS; i++) {
		double value;
		int flags;
		set_case("%s w (%g, 0, %g)", name, w[i].x, w[i].z);
		OBSERVE(value, flags, ndf_D(&ndf, w[i]));
		check(row_of("D", "pl"), value, flags, (struct expected){0.0, INFINITY, false, NAN, 1.0});
		trapping = w[i].z < 1e-250 ? FE_INVALID : TRAPS;
		OBSERVE(value, flags, ndf_lambda(&ndf, w[i]));
		check(row_of("Lambda", "pl"), value, flags,
		      (struct expected){0.0, INFINITY, w[i].z < 1e-250, NAN, 1.0});
		check_order(row_of("Lambda", "pl"), -before, -value, 1e-11 * before);
		before = value;
		OBSERVE(value, flags, ndf_G1(&ndf, w[i]));
		check(row_of("G1", "pl"), value, flags & trapping, (struct expected){0.0, 1.0, false, NAN, 1.0});
		trapping = TRAPS;
	}
	struct ndf rough = ndf;
	if (ndf_set_lambda_form(&rough, LAMBDA_TRAPEZOID) != STATUS_OK)
		abort();
	before = 0.0;
	for (int i = 0; i < EXTREME_DIRECTIONS; i++) {
		const double theta = fmin(atan2(w[i].x, w[i].z), 0.5 * M_PI), phi = 0.7 * (i % 9);
		double value;
		int flags;
		set_case("%s w (%g, 0, %g) phi %g", name, w[i].x, w[i].z, phi);
		trapping = w[i].z < 1e-250 ? FE_INVALID : TRAPS;
		OBSERVE(value, flags, ndf_G1(&rough, turned(w[i], phi)));
		check(row_of("G1 by trapezoids", "pl"), value, flags & trapping,
		      (struct expected){0.0, 1.0, false, NAN, 1.0});
		trapping = TRAPS;
		OBSERVE(value, flags, ndf_cdf_theta(&ndf, theta, 0.3));
		check(row_of("CDF of theta", "pl"), value, flags, (struct expected){0.0, 1.0, false, NAN, 1.0});
		check_order(row_of("CDF of theta", "pl"), -before, -value, 1e-14);
		before = value;
		OBSERVE(value, flags, ndf_cdf_phi(&ndf, phi));
		check(row_of("CDF of phi", "pl"), value, flags, (struct expected){0.0, 1.0, false, NAN, 1.0});
		OBSERVE(value, flags, ndf_cdf(&ndf, theta, phi));
		check(row_of("CDF", "pl"), value, flags, (struct expected){0.0, 1.0 + 1e-12, false, NAN, 1.0});
	}
	for (int j = 0; j < COUNT(uniform) * COUNT(uniform); j++) {
		struct vec3 m;
		int flags;
		set_case("%s u %g %g", name, uniform[j % COUNT(uniform)], uniform[j / COUNT(uniform)]);
		OBSERVE(m, flags, ndf_sample(&ndf, uniform[j % COUNT(uniform)], uniform[j / COUNT(uniform)]));
		check(row_of("sample", "pl"), m.z, flags, (struct expected){0.0, 1.0, false, NAN, 1.0});
	}
}

enum { NODES = 91 };

static void sweep_values(const char *name, const double *theta, const double *Dx, const double *Dy)
{
	struct pwl pwl;
	if (pwl_init(&pwl, NODES, theta, Dx, Dy) != STATUS_OK) {
		row_of("D", "pl")->refused++;
		return;
	}
	sweep_table(name, &pwl);
	pwl_free(&pwl);
}

static void sweep_pwl(void)
{
	double theta[NODES], spike[NODES] = {0}, wild[NODES], tiny[NODES], hole[NODES];
	for (int i = 0; i < NODES; i++) {
		theta[i] = 0.5 * M_PI * i * i / ((NODES - 1.0) * (NODES - 1.0));
		wild[i] = i % 3 == 0 ? 0.0 : pow(10.0, 300.0 * sin(i));
		tiny[i] = 5e-324 * (1 + i % 2);
		hole[i] = i < 10 || i > 60;
	}
	spike[0] = DBL_MAX;
	sweep_values("spike", theta, spike, NULL);
	sweep_values("wild", theta, wild, NULL);
	sweep_values("tiny", theta, tiny, NULL);
	sweep_values("hole", theta, hole, NULL);
	sweep_values("hole and tiny", theta, hole, tiny);
	for (int i = 0; i < COUNT(extreme_sigma); i++) {
		struct ndf ndf;
		struct pwl pwl;
		if (ndf_init(&ndf, ndf_find("std"), extreme_sigma[i], extreme_sigma[i], 1.5001) != STATUS_OK ||
		    pwl_from_ndf(&pwl, NODES, theta, &ndf) != STATUS_OK) {
			row_of("D", "pl")->refused++;
			continue;
		}
		sweep_table("std 1.5001", &pwl);
		pwl_free(&pwl);
	}
}

/* Where the finite sums lose their digits: the first gamma at which G1 is off by more than 1e-13. */
static double sums_end(enum lambda_form form, double gamma)
{
	for (; gamma < 60.0; gamma++) {
		const double K = (double)reference_K(gamma);
		for (double z = 0.01; z < 100.0; z *= 1.2) {
			const struct vec3 w = {1.0, 0.0, z};
			const long double G1 = 1 / (1 + reference_lambda_student(gamma, gamma - 1.0, 1.0, 1.0, w));
			const double got = 1.0 / (1.0 + lambda_form_lambda(form, gamma, K, z));
			if (fabsl(got / G1 - 1) > 1e-13L)
				return gamma;
		}
	}
	return gamma;
}

static void sweep_scalars(void)
{
	sweep_distributions();
	sweep_forms();
	sweep_fresnel();
	sweep_ellipsoid();
	sweep_pwl();
}

/* One shape of the float pipeline: the specular term of some blocks of the table's slots, in each kernel, against
 * the scalar reference in double; the kernels are alike to the bit. */
static void sweep_lobe(struct objective *o, const struct geometry *g, const struct cook_torrance *model, double allowed,
		       const char *density)
{
	static float s[KERNEL_BLOCK], plain[KERNEL_BLOCK];
	const struct kernel_g1 g1 = masking_kernel(&o->lobe[0].masking);
	static const enum kernel_gaf gaf[] = {KERNEL_SEPARABLE, KERNEL_CORRELATED, KERNEL_STATIC};
	char name[32];
	snprintf(name, sizeof(name), "%s %s", gaf_name(model->gaf), density);
	struct row *row = row_of("float f", name), *alike = row_of("float kernels", gaf_name(model->gaf));
	const int stride = ndf_has_anisotropy(model->ndf.class) ? 61 : 199; /* the others' reference is slow */
	for (int block = 0; (block + 1) * KERNEL_BLOCK < g->n_samples; block += stride) {
		const int at = block * KERNEL_BLOCK;
		const struct kernel_samples slots = {g->q_i + at, g->q_o + at, g->geometric_factor + at, g->row + at};
		kernel_plain.lobe(gaf[model->gaf], &g1, o->row[1], &slots, plain);
		kernel_pick()->lobe(gaf[model->gaf], &g1, o->row[1], &slots, s);
		for (int n = 0; n < KERNEL_BLOCK; n++) {
			const int i = slots.row[n] / MERL_THETA_D, j = slots.row[n] % MERL_THETA_D, k = g->k[at + n];
			struct vec3 wi, wo;
			entries_dirs(&g->entries, i, j, k, &wi, &wo);
			/* Smaller ones than a float's D has digits for are known from 0 only. */
			const double f =
				cook_torrance_lobe(model, wi, wo) * weight_at(g->criterion.weight, i, j, wi.z, wo.z);
			const bool known = o->row[1][slots.row[n]] > 1e-36f && f > 1e-36;
			set_case("%s sigma %g gamma %g entry %d %d %d", ndf_name(model->ndf.class), model->ndf.sigma_x,
				 model->ndf.gamma, i, j, k);
			check(row, (double)plain[n], 0,
			      (struct expected){0.0, INFINITY, false, known ? (long double)f : NAN, allowed});
			check(alike, (double)s[n], 0,
			      (struct expected){(double)plain[n], (double)plain[n], false, NAN, 0.0});
		}
	}
}

static void sweep_shapes(const struct geometry *g, const struct sample_set *table, const struct fit_options *options)
{
	static const double sigma[] = {1e-30, 1e-7, 1e-4, 0.05, 0.7, 4.0, 1e4};
	static const double gamma[] = {1.5001, 2.0, 7.3, 1000.0, INFINITY};
	static const char *const names[] = {"std", "ggx", "beckmann", "gtr", "low", "hyper-cauchy", "t-family"};
	for (int d = 0; d < COUNT(names); d++)
		for (int density = MASKING_COARSE; density <= MASKING_FINE; density++) {
			struct objective o;
			if (objective_init(&o, table, options, ndf_find(names[d]), 1, (enum masking_density)density) !=
			    STATUS_OK)
				abort();
			for (int i = 0; i < COUNT(sigma) * COUNT(gamma); i += d == 0 ? 1 : 4) {
				const struct shape shape = {
					.sigma = sigma[i % COUNT(sigma)], .gamma = gamma[i / COUNT(sigma)], .ior = 1.5};
				struct cook_torrance model = {
					.gaf = options->criterion.gaf, .fresnel = options->fresnel, .n = 1.5};
				if (shape_ndf(&shape, o.class, LAMBDA_EXACT, &model.ndf) != STATUS_OK ||
				    objective_lobe(&o, &shape) != STATUS_OK)
					continue;
				/* Beyond the float's range of D only finite values are asked for. */
				const double allowed = shape.sigma < 1e-10       ? INFINITY
						       : density == MASKING_FINE ? 5e-7
										 : 2e-5;
				sweep_lobe(&o, g, &model, allowed, density == MASKING_FINE ? "fine" : "coarse");
			}
			objective_free(&o);
		}
}

/* The error of tables from the smallest floats to the largest: finite, and that of the same table of moderate size. */
static void sweep_scales(const struct geometry *g, const struct fit_options *options, struct measurement *measurement)
{
	static const float scale[] = {1e-45f, 1e-41f, 1e-30f, 1.0f, 1e25f, 1e38f, FLT_MAX};
	for (int i = 0; i < COUNT(scale); i++) {
		struct sample_set table;
		struct objective o;
		struct linear linear;
		const struct shape shape = {.sigma = 0.1, .gamma = 3.0, .ior = 1.5};
		for (size_t e = 0; e < measurement_count(measurement); e++)
			for (int c = 0; c < MERL_CHANNELS; c++)
				measurement->value[c][e] = scale[i];
		set_case("all %g, weight %s", (double)scale[i], weight_name(options->criterion.weight));
		if (sample_set_init(&table, g, measurement, 1) != STATUS_OK) {
			row_of("float error", "E")->refused++;
			continue;
		}
		if (objective_init(&o, &table, options, ndf_find("std"), 1, MASKING_FINE) != STATUS_OK)
			abort();
		/* Far too dark or too bright for kd and ks: nothing, or nearly nothing, can be fitted. */
		const double E = objective_eval(&o, &shape, 1e-6, true, &linear);
		check(row_of("float error", "E"), E, 0, (struct expected){0.0, 1.0 + 1e-6, false, NAN, 1.0});
		for (int c = 0; c < MERL_CHANNELS; c++)
			check(row_of("float error", "kd, ks"), linear.kd[c] + linear.coefficient[c][1], 0,
			      (struct expected){0.0, 2.0, false, NAN, 1.0});
		objective_free(&o);
		sample_set_free(&table);
	}
}

static void sweep_float(void)
{
	struct measurement measurement;
	if (measurement_alloc(&measurement, 180) != STATUS_OK)
		abort();
	for (int gaf = 0; gaf < GAF_COUNT; gaf++) {
		struct fit_options options = fit_options_default();
		struct geometry geometry;
		struct sample_set table;
		options.criterion.gaf = (enum gaf)gaf;
		options.criterion.bins = gaf == GAF_CORRELATED ? BINS_CENTRE : BINS_NODE;
		options.criterion.weight = (enum weight)(gaf % WEIGHT_COUNT);
		options.threads = 1;
		for (size_t e = 0; e < measurement_count(&measurement); e++)
			for (int c = 0; c < MERL_CHANNELS; c++)
				measurement.value[c][e] = 0.1f;
		if (geometry_init(&geometry, 180, &options) != STATUS_OK ||
		    sample_set_init(&table, &geometry, &measurement, 1) != STATUS_OK)
			abort();
		sweep_shapes(&geometry, &table, &options);
		sweep_scales(&geometry, &options, &measurement);
		sample_set_free(&table);
		geometry_free(&geometry);
	}
	measurement_free(&measurement);
}

static bool too_far(const struct row *row)
{
	return row->worst > row->allowed;
}

static bool found(const struct row *row)
{
	return row->nan || row->inf || row->bounds || row->monotony || row->traps || too_far(row);
}

static void write_rows(FILE *csv)
{
	fprintf(csv,
		"quantity,of,points,refused,worst_error,allowed,where,nan,inf,bounds,monotony,traps,first_finding\n");
	for (int i = 0; i < n_rows; i++) {
		const struct row *r = &rows[i];
		fprintf(csv, "%s,%s,%ld,%ld,", r->quantity, r->of, r->points, r->refused);
		if (r->allowed > 0.0)
			fprintf(csv, "%.3g,%.3g,\"%s\",", r->worst, r->allowed, r->where);
		else
			fprintf(csv, ",,,");
		fprintf(csv, "%ld,%ld,%ld,%ld,%ld,\"%s\"\n", r->nan, r->inf, r->bounds, r->monotony, r->traps, r->what);
	}
}

/* Per quantity the distribution that comes closest to what is allowed, then every finding. */
static int print_summary(void)
{
	int findings = 0;
	long points = 0;
	printf("%-22s %-14s %9s %9s %9s  %s\n", "quantity", "worst of", "points", "error", "allowed", "at");
	for (int i = 0; i < n_rows; i++) {
		const struct row *worst = &rows[i];
		long here = 0;
		bool first = true;
		for (int k = 0; k < n_rows; k++) {
			if (strcmp(rows[k].quantity, rows[i].quantity) != 0)
				continue;
			first = first && k >= i;
			here += rows[k].points;
			if (rows[k].worst * worst->allowed > worst->worst * rows[k].allowed || worst->allowed == 0.0)
				worst = &rows[k];
		}
		findings += found(&rows[i]);
		points += rows[i].points;
		if (first && worst->allowed > 0.0)
			printf("%-22s %-14s %9ld %9.2g %9.2g  %s\n", worst->quantity, worst->of, here, worst->worst,
			       worst->allowed, worst->where);
		else if (first)
			printf("%-22s %-14s %9ld %9s %9s\n", worst->quantity, "", here, "", "");
	}
	for (int i = 0; i < n_rows; i++) {
		const struct row *r = &rows[i];
		if (found(r))
			printf("FOUND %s of %s: NaN %ld, infinite %ld, out of bounds %ld, not monotonic %ld, "
			       "exceptions %ld%s; %s\n",
			       r->quantity, r->of, r->nan, r->inf, r->bounds, r->monotony, r->traps,
			       too_far(r) ? ", error larger than stated" : "", r->what);
	}
	printf("%ld points, %d findings\n", points, findings);
	return findings;
}

static void on_trap(int signal)
{
	static const char text[] = "FOUND a trap at: ";
	(void)signal;
	if (write(STDOUT_FILENO, text, sizeof(text) - 1) < 0 || write(STDOUT_FILENO, at_hand, strlen(at_hand)) < 0 ||
	    write(STDOUT_FILENO, "\n", 1) < 0)
		_exit(3);
	_exit(1);
}

/* The scalar sweeps once more in a process in which the exceptions trap. Returns whether it came through. */
static bool survives_traps(void)
{
	fflush(stdout);
	const pid_t child = fork();
	if (child == 0) {
		armed = true;
		signal(SIGFPE, on_trap);
		sweep_scalars();
		_exit(0);
	}
	int status = 1;
	return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

int main(int argc, char **argv)
{
	if (argc != 2) {
		fprintf(stderr, "usage: stability FILE.csv\n");
		return 2;
	}
	if (!have_mpfr)
		printf("built without MPFR: Lambda, G1, P2, Fresnel are not held against high precision\n");
	setvbuf(stdout, NULL, _IOLBF, 0);
	const bool survived = survives_traps();
	sweep_scalars();
	sweep_float();
	FILE *csv = fopen(argv[1], "w");
	if (!csv) {
		fprintf(stderr, "stability: %s cannot be written\n", argv[1]);
		return 1;
	}
	write_rows(csv);
	if (fclose(csv) != 0)
		return 1;
	const int findings = print_summary();
	if (have_mpfr)
		printf("finite sums keep G1 to 1e-13 up to gamma %g (integer), %g (half-integer)\n",
		       sums_end(LAMBDA_INTEGER, 2.0) - 1.0, sums_end(LAMBDA_HALF_INTEGER, 2.5) - 1.0);
	printf("with traps for invalid operations, divisions by zero and overflows: %s\n",
	       survived ? "none" : "trapped");
	return findings > 0 || !survived;
}
