/* SPDX-License-Identifier: GPL-3.0-or-later */
/* figures - what the figures of the papers show and no command of the program computes, as CSV, and what it comes to
 * beside what the papers say. usage: figures DIRECTORY. scripts/figures.sh makes the other figures, and draws all.
 * Of the STD paper Figs 4, 5, 9 and 10, isotropic, gamma = inf standing for Beckmann; of the visible normals 1 to 3. */
#include "data_readers/atomic_file.h"
#include "fit/search/search.h"
#include "make_table.h"
#include "src/energy.h"
#include "src/random_walk.h"
#include "src/splitmix.h"
#include "src/vndf.h"
#include <gsl/gsl_cdf.h>
#include <string.h>

enum { DIRECTIONS = 4096, REPEATS = 7 };

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* The values of gamma of the paper's Fig. 9. */
static const double shapes[] = {1.51, 1.65, 2, 4, 10, 40, INFINITY};
/* Those of Fig. 10. */
static const double near_beckmann[] = {30, 40, 50, 100};

static const char *directory;
static struct atomic_file summary;

static FILE *begin(struct atomic_file *file, const char *name, const char *header)
{
	char path[4096];
	struct error error;

	snprintf(path, sizeof path, "%s/%s", directory, name);
	if (atomic_file_open(file, path, &error) != STATUS_OK) {
		fprintf(stderr, "figures: %s\n", error.text);
		exit(EXIT_FAILURE);
	}
	fprintf(file->stream, "%s\n", header);
	return file->stream;
}

static void commit(struct atomic_file *file)
{
	struct error error;

	if (atomic_file_commit(file, &error) != STATUS_OK) {
		fprintf(stderr, "figures: %s\n", error.text);
		exit(EXIT_FAILURE);
	}
}

static void found(const char *figure, const char *quantity, double value, const char *paper)
{
	fprintf(summary.stream, "%s,%s,%.4g,%s\n", figure, quantity, value, paper);
}

static struct ndf std_ndf(double sigma, double gamma, enum lambda_form form)
{
	struct ndf ndf;

	if (ndf_init(&ndf, ndf_find("std"), sigma, sigma, gamma) != STATUS_OK ||
	    (form != LAMBDA_EXACT && ndf_set_lambda_form(&ndf, form) != STATUS_OK))
		abort();
	return ndf;
}

/* What is timed, for a direction w and two uniform numbers. */
typedef double timed_function(const struct ndf *ndf, struct vec3 w, double u1, double u2);

static double timed_D(const struct ndf *ndf, struct vec3 w, double u1, double u2)
{
	(void)u1, (void)u2;
	return ndf_D(ndf, w);
}

static double timed_lambda(const struct ndf *ndf, struct vec3 w, double u1, double u2)
{
	(void)u1, (void)u2;
	return ndf_lambda(ndf, w);
}

static double timed_sample(const struct ndf *ndf, struct vec3 w, double u1, double u2)
{
	(void)w;
	return ndf_sample(ndf, u1, u2).z;
}

static double timed_visible(const struct ndf *ndf, struct vec3 w, double u1, double u2)
{
	return vndf_sample(ndf, w, u1, u2).z;
}

/* Nanoseconds a call: the least of a few runs over random directions, the others having been disturbed. */
static double time_ns(timed_function *f, const struct ndf *ndf)
{
	static struct vec3 w[DIRECTIONS];
	static double u[DIRECTIONS][2];
	static volatile double sink; /* keeps results alive */
	unsigned seed = 1;
	double best = INFINITY;

	for (int i = 0; i < DIRECTIONS; i++) {
		const double cosine = 1 - random_unit(&seed), phi = 2 * M_PI * random_unit(&seed);
		const double sine = sqrt((1 - cosine) * (1 + cosine));

		w[i] = (struct vec3){sine * cos(phi), sine * sin(phi), cosine};
		u[i][0] = random_unit(&seed);
		u[i][1] = random_unit(&seed);
	}
	for (int r = 0; r < REPEATS; r++) {
		const double start = search_clock();
		double sum = 0;

		for (int i = 0; i < DIRECTIONS; i++)
			sum += f(ndf, w[i], u[i][0], u[i][1]);
		best = fmin(best, search_clock() - start);
		sink = sum;
	}
	(void)sink;
	return 1e9 * best / DIRECTIONS;
}

/* One point of D and of sampling, against gamma or sigma, whose value is x. */
static void time_density(FILE *csv, const char *against, double x, const char *name, const struct ndf *ndf)
{
	fprintf(csv, "%s,%g,D,%s,%.4g\n", against, x, name, time_ns(timed_D, ndf));
	fprintf(csv, "%s,%g,sample,%s,%.4g\n", against, x, name, time_ns(timed_sample, ndf));
	fprintf(csv, "%s,%g,visible,%s,%.4g\n", against, x, name, time_ns(timed_visible, ndf));
}

/* All curves of Fig. 4 that exist at this gamma, at x. */
static void time_std(FILE *csv, const char *against, double x, double sigma, double gamma)
{
	const struct ndf exact = std_ndf(sigma, gamma, LAMBDA_EXACT);

	time_density(csv, against, x, "std", &exact);
	for (int form = LAMBDA_EXACT; form < LAMBDA_FORM_COUNT; form++) {
		if (!lambda_form_takes((enum lambda_form)form, gamma))
			continue;
		const struct ndf ndf = std_ndf(sigma, gamma, (enum lambda_form)form);

		fprintf(csv, "%s,%g,lambda,%s,%.4g\n", against, x, lambda_form_name((enum lambda_form)form),
			time_ns(timed_lambda, &ndf));
	}
}

static void time_beckmann(FILE *csv, const char *against, double x, double sigma)
{
	const struct ndf ndf = std_ndf(sigma, INFINITY, LAMBDA_EXACT);

	time_density(csv, against, x, "beckmann", &ndf);
	fprintf(csv, "%s,%g,lambda,beckmann,%.4g\n", against, x, time_ns(timed_lambda, &ndf));
}

/* Fig. 4, first row: time against gamma at sigma 0.5, and against sigma at gamma 5 (half-integer: 5.5). */
static void figure_4(void)
{
	struct atomic_file file;
	FILE *csv = begin(&file, "s3_fig4.csv", "against,x,quantity,form,ns");

	for (double gamma = 2; gamma <= 15.5; gamma += 0.5) {
		time_std(csv, "gamma", gamma, 0.5, gamma);
		time_beckmann(csv, "gamma", gamma, 0.5);
	}
	for (double sigma = 0.1; sigma < 1.55; sigma += 0.1) {
		const struct ndf half = std_ndf(sigma, 5.5, LAMBDA_HALF_INTEGER);

		time_std(csv, "sigma", sigma, sigma, 5);
		fprintf(csv, "sigma,%g,lambda,half-integer,%.4g\n", sigma, time_ns(timed_lambda, &half));
		time_beckmann(csv, "sigma", sigma, sigma);
	}
	commit(&file);
}

/* The integral of |value of a - value of b| over the hemisphere by that of b, by the trapezoid rule in ln tan(theta).
 */
static double relative_difference(double (*value)(const struct ndf *ndf, struct vec3 w), const struct ndf *a,
				  const struct ndf *b)
{
	double difference = 0, whole = 0;

	for (double v = -9; v < 9; v += 0.01) {
		const double tangent = exp(v), cosine = 1 / sqrt(1 + tangent * tangent), sine = tangent * cosine;
		const struct vec3 w = {sine, 0, cosine};
		const double in_b = value(b, w), measure = sine * sine * cosine; /* sin(theta) dtheta/dv */

		difference += fabs(value(a, w) - in_b) * measure;
		whole += in_b * measure;
	}
	return difference / whole;
}

/* The largest relative error of the rational G1 for any direction and roughness, which count as cot(theta)/sigma. */
static double pointwise_error(double gamma)
{
	const struct ndf exact = std_ndf(1, gamma, LAMBDA_EXACT), rational = std_ndf(1, gamma, LAMBDA_RATIONAL);
	double most = 0;

	for (double v = -7; v < 9; v += 0.01) {
		const struct vec3 w = vec3_unit((struct vec3){1, 0, exp(v)});

		most = fmax(most, fabs(ndf_G1(&rational, w) / ndf_G1(&exact, w) - 1));
	}
	return most;
}

static double hemispherical_error(double sigma, double gamma)
{
	const struct ndf exact = std_ndf(sigma, gamma, LAMBDA_EXACT), rational = std_ndf(sigma, gamma, LAMBDA_RATIONAL);

	return relative_difference(ndf_G1, &rational, &exact);
}

/* Fig. 5: the error of the rational approximation of G1. */
static void figure_5(void)
{
	static const double gammas[] = {1.6, 2, 2.2, 2.5, 3, 5, 10, 40, 100};
	struct atomic_file file;
	FILE *csv = begin(&file, "s3_fig5.csv", "sigma,gamma,hemispherical_percent");
	double worst = 0, worst_pointwise = 0;

	for (size_t g = 0; g < COUNT(gammas); g++)
		for (int i = 1; i <= 40; i++)
			fprintf(csv, "%g,%g,%.6g\n", 0.05 * i, gammas[g],
				100 * hemispherical_error(0.05 * i, gammas[g]));
	commit(&file);

	csv = begin(&file, "s3_fig5_worst.csv", "gamma,hemispherical_percent,pointwise_percent");
	for (double gamma = 1.51; gamma < 120; gamma *= gamma < 4 ? 1.02 : 1.1) {
		double hemispherical = 0;
		const double pointwise = pointwise_error(gamma);

		for (int i = 1; i <= 40; i++)
			hemispherical = fmax(hemispherical, hemispherical_error(0.05 * i, gamma));
		fprintf(csv, "%.6g,%.6g,%.6g\n", gamma, 100 * hemispherical, 100 * pointwise);
		worst = fmax(worst, hemispherical);
		worst_pointwise = fmax(worst_pointwise, pointwise);
	}
	commit(&file);
	found("S3 5", "largest hemispherical error of the rational G1 in %", 100 * worst, "below 0.7");
	found("S3 5", "largest pointwise error of the rational G1 in %", 100 * worst_pointwise, "");
}

static double albedo_at(double sigma, double gamma, enum gaf gaf, double cos_i)
{
	const struct cook_torrance mirror = {
		.ndf = std_ndf(sigma, gamma, LAMBDA_EXACT), .gaf = gaf, .fresnel = FRESNEL_NONE};
	double albedo;

	if (energy_lobe(&mirror, cos_i, &albedo) != STATUS_OK)
		abort();
	return albedo;
}

static double balance(double sigma, double gamma, enum gaf gaf)
{
	const struct cook_torrance mirror = {.ndf = std_ndf(sigma, gamma, LAMBDA_EXACT), .gaf = gaf};
	double share;

	if (energy_furnace(&mirror, &share) != STATUS_OK)
		abort();
	return share;
}

/* Fig. 9: the light that single scattering sends back, in all and per direction. */
static void figure_9(void)
{
	enum { SIGMAS = 15, THETAS = 18, GAFS = 2 };
	static double in_all[SIGMAS][COUNT(shapes)][GAFS], at[THETAS][COUNT(shapes)][GAFS];
	struct atomic_file file;

#pragma omp parallel for collapse(2) schedule(dynamic)
	for (int i = 0; i < SIGMAS; i++)
		for (size_t g = 0; g < COUNT(shapes); g++)
			for (int gaf = 0; gaf < GAFS; gaf++)
				in_all[i][g][gaf] = balance(0.1 * (i + 1), shapes[g], (enum gaf)gaf);
#pragma omp parallel for collapse(2) schedule(dynamic)
	for (int i = 0; i < THETAS; i++)
		for (size_t g = 0; g < COUNT(shapes); g++)
			for (int gaf = 0; gaf < GAFS; gaf++)
				at[i][g][gaf] =
					albedo_at(0.5, shapes[g], (enum gaf)gaf, vec3_from_spherical_deg(5 * i, 0).z);

	FILE *csv = begin(&file, "s3_fig9.csv", "sigma,gamma,uncorrelated_percent,correlated_percent");
	for (size_t g = 0; g < COUNT(shapes); g++)
		for (int i = 0; i < SIGMAS; i++)
			fprintf(csv, "%g,%g,%.6g,%.6g\n", 0.1 * (i + 1), shapes[g], 100 * in_all[i][g][0],
				100 * in_all[i][g][1]);
	commit(&file);
	csv = begin(&file, "s3_fig9_direction.csv", "theta_i_deg,gamma,uncorrelated_percent,correlated_percent");
	for (size_t g = 0; g < COUNT(shapes); g++)
		for (int i = 0; i < THETAS; i++)
			fprintf(csv, "%d,%g,%.6g,%.6g\n", 5 * i, shapes[g], 100 * at[i][g][0], 100 * at[i][g][1]);
	commit(&file);
	found("S3 9", "energy balance at gamma 5 and sigma 0.1 in %", 100 * balance(0.1, 5, GAF_UNCORRELATED), "");
	found("S3 9", "energy balance at gamma 2 and sigma 1 in %", in_all[9][2][0] * 100, "");
	found("S3 9", "energy balance at gamma 1.51 and sigma 1 in %", in_all[9][0][0] * 100, "");
	found("S3 9", "energy balance of Beckmann at sigma 1 in %", in_all[9][COUNT(shapes) - 1][0] * 100, "");
}

/* Light that meets several facets, beside Fig. 9 */

static double next_uniform(void *state)
{
	return splitmix_uniform(state);
}

/* A direction whose density is its cosine over pi: all of them together are light from everywhere. */
static struct vec3 even_direction(uint64_t *state)
{
	const double phi = 2 * M_PI * splitmix_uniform(state), square = 1 - splitmix_uniform(state);

	return (struct vec3){sqrt(1 - square) * cos(phi), sqrt(1 - square) * sin(phi), sqrt(square)};
}

/* What has left after at most so many facets, the first of several; the last is all of them. */
static const int most_events[] = {1, 2, 3, 5, 10, RANDOM_WALK_EVENTS_MAX};

enum { WALKS = 20000, MOST_EVENTS = 6, ALL = MOST_EVENTS - 1 };

struct walked {
	double left[MOST_EVENTS]; /* shares of the light */
	double estimate, error;   /* of all of it, by random_walk_f(), and the standard deviation of that */
};

static struct walked walk(double sigma, double gamma)
{
	const struct ndf ndf = std_ndf(sigma, gamma, LAMBDA_EXACT);
	const double unread[3] = {0};
	struct random_walk walk;
	struct walked walked = {0};
	double squares = 0;
	uint64_t state = (uint64_t)lrint(1000 * sigma) * 7919;
	const struct random_numbers numbers = {next_uniform, &state};

	if (random_walk_init_mirror(&walk, &ndf, FRESNEL_NONE, unread, unread) != STATUS_OK)
		abort();
	for (int i = 0; i < WALKS; i++) {
		const struct random_walk_exit out = random_walk_sample(&walk, even_direction(&state), &numbers);
		const struct vec3 wi = even_direction(&state), wo = even_direction(&state);
		double f[3];

		for (int k = 0; k < MOST_EVENTS; k++)
			walked.left[k] += (out.events <= most_events[k]) * out.weight[0] / WALKS;
		random_walk_f(&walk, wi, wo, 0, &numbers, f);
		walked.estimate += M_PI * f[0] / WALKS;
		squares += M_PI * f[0] * M_PI * f[0] / WALKS;
	}
	walked.error = sqrt((squares - walked.estimate * walked.estimate) / WALKS);
	return walked;
}

static void figure_9_walks(void)
{
	enum { SIGMAS = 20 };
	static struct walked walked[COUNT(shapes)][SIGMAS];
	struct atomic_file file;
	FILE *csv = begin(&file, "s3_fig9_walks.csv",
			  "sigma,gamma,left_after_1,after_2,after_3,after_5,after_10,all,estimate_of_all,its_error");
	double least = 1, farthest = 0, from_single = 0;

#pragma omp parallel for collapse(2) schedule(dynamic)
	for (size_t g = 0; g < COUNT(shapes); g++)
		for (int i = 0; i < SIGMAS; i++)
			walked[g][i] = walk(0.1 * (i + 1), shapes[g]);
	for (size_t g = 0; g < COUNT(shapes); g++)
		for (int i = 0; i < SIGMAS; i++) {
			const struct walked *w = &walked[g][i];
			const double single = balance(0.1 * (i + 1), shapes[g], GAF_CORRELATED);

			fprintf(csv, "%g,%g", 0.1 * (i + 1), shapes[g]);
			for (int k = 0; k < MOST_EVENTS; k++)
				fprintf(csv, ",%.6g", 100 * w->left[k]);
			fprintf(csv, ",%.6g,%.6g\n", 100 * w->estimate, 100 * w->error);
			least = fmin(least, w->left[ALL]);
			if (shapes[g] > 1.75)
				farthest = fmax(farthest, fabs(w->estimate - 1) / w->error);
			from_single =
				fmax(from_single, fabs(w->left[0] - single) / sqrt(single * (1 - single) / WALKS));
		}
	commit(&file);
	found("S3 9", "least share of light that comes back with multiple scattering for any sigma and gamma in %",
	      100 * least, "should be handled");
	found("S3 9",
	      "largest distance of its estimate by f from all of it in standard deviations for gamma above 1.75",
	      farthest, "");
	found("S3 9", "largest distance of its first facet from single scattering with correlated G in the same",
	      from_single, "");
}

/* Fig. 10: how far STD is from Beckmann. */
static void figure_10(void)
{
	enum { SIGMAS = 15, AT_1_2 = 11 };
	static double energy[SIGMAS][COUNT(near_beckmann)];
	struct atomic_file file;
	FILE *csv = begin(&file, "s3_fig10.csv", "sigma,gamma,d_cos_percent,d_percent,g1_percent,energy_percent");

#pragma omp parallel for schedule(dynamic)
	for (int i = 0; i < SIGMAS; i++) {
		const double beckmann = balance(0.1 * (i + 1), INFINITY, GAF_UNCORRELATED);

		for (size_t g = 0; g < COUNT(near_beckmann); g++)
			energy[i][g] = balance(0.1 * (i + 1), near_beckmann[g], GAF_UNCORRELATED) / beckmann - 1;
	}
	for (size_t g = 0; g < COUNT(near_beckmann); g++)
		for (int i = 0; i < SIGMAS; i++) {
			const double sigma = 0.1 * (i + 1);
			const struct ndf std = std_ndf(sigma, near_beckmann[g], LAMBDA_EXACT);
			const struct ndf beckmann = std_ndf(sigma, INFINITY, LAMBDA_EXACT);
			const double d_cos = 100 * relative_difference(ndf_pdf, &std, &beckmann);
			const double d = 100 * relative_difference(ndf_D, &std, &beckmann);
			const double g1 = 100 * relative_difference(ndf_G1, &std, &beckmann);

			fprintf(csv, "%g,%g,%.6g,%.6g,%.6g,%.6g\n", sigma, near_beckmann[g], d_cos, d, g1,
				100 * fabs(energy[i][g]));
			if (near_beckmann[g] != 40 || i != AT_1_2)
				continue;
			found("S3 10", "D cos of gamma 40 against Beckmann in % at any sigma", d_cos,
			      "below 1 in the text and 0.5 in the caption");
			found("S3 10", "the same without the cosine in % at sigma 1.2", d, "");
			found("S3 10", "G1 of gamma 40 against Beckmann in % at sigma 1.2", g1, "below 0.3");
			found("S3 10", "energy balance of gamma 40 against Beckmann in % at sigma 1.2",
			      100 * fabs(energy[i][g]), "");
		}
	commit(&file);
}

/* Visible normals, Figs 1 and 3: densities of the slopes within SLOPE_MAX, as counted and as they are. */

enum { CELLS = 100, COUNTS = 3 };
#define SLOPE_MAX 5.0
#define CELL (2 * SLOPE_MAX / CELLS)

static const int counts[COUNTS] = {1000, 100000, 10000000};

static void count_slopes(const struct ndf *ndf, struct vec3 wi, int n, double *density)
{
	uint64_t state = 3;

	memset(density, 0, CELLS * CELLS * sizeof *density);
	for (int i = 0; i < n; i++) {
		const double u1 = splitmix_uniform(&state), u2 = splitmix_uniform(&state);
		const struct vec3 m = vndf_sample(ndf, wi, u1, u2);
		const double x = (SLOPE_MAX - m.x / m.z) / CELL, y = (SLOPE_MAX - m.y / m.z) / CELL;

		if (x >= 0 && x < CELLS && y >= 0 && y < CELLS)
			density[(int)y * CELLS + (int)x] += 1 / (n * CELL * CELL);
	}
}

/* The mean over a cell, by points of it. */
static double slope_density(const struct ndf *ndf, struct vec3 wi, int column, int row)
{
	enum { POINTS = 4 };
	double sum = 0;

	for (int k = 0; k < POINTS * POINTS; k++) {
		const double x = SLOPE_MAX - CELL * (column + (k % POINTS + 0.5) / POINTS);
		const double y = SLOPE_MAX - CELL * (row + (k / POINTS + 0.5) / POINTS);
		const struct vec3 m = vec3_unit((struct vec3){x, y, 1});

		sum += vndf_pdf(ndf, wi, m) * m.z * m.z * m.z;
	}
	return sum / (POINTS * POINTS);
}

static void visible_slopes(const char *name, const char *file_name, const char *figure)
{
	static double density[COUNTS][CELLS * CELLS];
	struct atomic_file file;
	FILE *csv = begin(&file, file_name, "theta_i_deg,slope_x,slope_y,of_1e3,of_1e5,of_1e7,density");
	double farthest = 0, by_chance = 0;
	struct ndf ndf;

	if (ndf_init(&ndf, ndf_find(name), 2, 1, NAN) != STATUS_OK)
		abort();
	for (int theta_i = 0; theta_i <= 90; theta_i += 30) {
		struct vec3 wi = vec3_from_spherical_deg(theta_i, 45);
		double distance = 0, chance = 0;

		wi.z = fmax(wi.z, 1e-100);
#pragma omp parallel for schedule(dynamic)
		for (int i = COUNTS - 1; i >= 0; i--)
			count_slopes(&ndf, wi, counts[i], density[i]);
		for (int k = 0; k < CELLS * CELLS; k++) {
			const double expected = slope_density(&ndf, wi, k % CELLS, k / CELLS);

			fprintf(csv, "%d,%g,%g,%.5g,%.5g,%.5g,%.5g\n", theta_i, CELL * (k % CELLS + 0.5) - SLOPE_MAX,
				CELL * (k / CELLS + 0.5) - SLOPE_MAX, density[0][k], density[1][k], density[2][k],
				expected);
			distance += fabs(expected - density[2][k]) * CELL * CELL;
			/* What the count of a cell is off by: the mean of a normal number's size is sqrt(2/pi). */
			chance += sqrt(M_2_PI * expected * CELL * CELL / counts[2]);
		}
		farthest = fmax(farthest, distance);
		by_chance = fmax(by_chance, distance / chance);
	}
	commit(&file);
	found(figure, "largest distance of 1e7 counted slopes from their density in %", 100 * farthest,
	      "the same picture");
	found(figure, "the same by what chance makes of 1e7", by_chance, "");
}

/* Visible normals, Fig. 2: the rational fit of the slope across, and how far its density is from theirs. */
static void rational_fit(void)
{
	enum { SAMPLES = 200000 };
	struct atomic_file file;
	FILE *csv = begin(&file, "s2_fig2.csv", "U,exact,fit");
	double worst = 0, mean = 0;
	uint64_t state = 1;
	struct ndf ndf;

	for (int i = 1; i < 1000; i++) {
		const double exact = vndf_ggx_slopes(1, 0, 0.5, i / 1000., VNDF_GGX_EXACT).y;
		const double fit = vndf_ggx_slopes(1, 0, 0.5, i / 1000., VNDF_GGX_FIT).y;

		fprintf(csv, "%g,%.9g,%.9g\n", i / 1000., exact, fit);
		worst = fmax(worst, fabs(gsl_cdf_tdist_P(sqrt(3) * fit, 3) - i / 1000.));
	}
	commit(&file);
	if (ndf_init(&ndf, ndf_find("ggx"), 0.5, 0.5, NAN) != STATUS_OK)
		abort();
	for (int i = 0; i < SAMPLES; i++) {
		const struct vec3 wi = vec3_from_spherical_deg(60, 0);
		const double u1 = splitmix_uniform(&state), u2 = splitmix_uniform(&state);
		const struct vec3 m = vndf_sample(&ndf, wi, u1, u2);

		mean += fabs(vndf_rational_pdf(&ndf, wi, m) / vndf_pdf(&ndf, wi, m) - 1) / SAMPLES;
	}
	found("S2 2", "largest error of the fit's CDF", worst, "");
	found("S2 2", "mean relative error of its density over visible normals in %", 100 * mean, "0.4 in S4");
	found("S4", "share of the normals that it draws elsewhere in % (half of that mean)", 50 * mean, "0.4");
}

int main(int argc, char **argv)
{
	if (argc != 2) {
		fprintf(stderr, "usage: figures DIRECTORY\n");
		return 2;
	}
	directory = argv[1];
	begin(&summary, "summary.csv", "figure,quantity,found,paper");
	figure_4();
	figure_5();
	figure_9();
	figure_9_walks();
	figure_10();
	rational_fit();
	visible_slopes("beckmann", "s2_fig1.csv", "S2 1");
	visible_slopes("ggx", "s2_fig3.csv", "S2 3");
	commit(&summary);
	return 0;
}
