/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "chi_square.h"
#include "src/dielectric.h"
#include "src/energy.h"
#include "src/random_walk.h"

static double next_number(void *state)
{
	return uniform(state);
}

static struct random_numbers numbers_of(uint64_t *state)
{
	return (struct random_numbers){next_number, state};
}

static struct ndf facets(const char *name, double sigma_x, double sigma_y, double gamma)
{
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find(name), sigma_x, sigma_y, gamma), STATUS_OK);
	return ndf;
}

static struct random_walk mirror(const struct ndf *ndf)
{
	struct random_walk walk;
	assert_int_equal(random_walk_init_mirror(&walk, ndf, FRESNEL_NONE, (double[3]){0.0}, (double[3]){0.0}),
			 STATUS_OK);
	return walk;
}

static struct random_walk glass(const struct ndf *ndf, double n)
{
	struct random_walk walk;
	assert_int_equal(random_walk_init_dielectric(&walk, ndf, n), STATUS_OK);
	return walk;
}

static const double gammas[] = {1.51, 1.65, 2.0, 4.0, 10.0, 50.0, INFINITY};
static const double sigmas[] = {0.1, 0.7, 2.0};
enum { GAMMAS = sizeof gammas / sizeof gammas[0], SIGMAS = sizeof sigmas / sizeof sigmas[0] };

/* Mirrors and glass lose nothing, whatever their shape and roughness: each walk ends outside. What leaves after one event is
 * the albedo of single scattering, by quadrature. */
static void all_light_comes_back(void **state)
{
	(void)state;
	uint64_t random = 2016;
	const struct random_numbers numbers = numbers_of(&random);
	for (int i = 0; i < GAMMAS * SIGMAS; i++) {
		const double gamma = gammas[i % GAMMAS];
		const struct ndf ndf = facets("std", sigmas[i / GAMMAS], sigmas[i / GAMMAS], gamma);
		const struct random_walk walks[] = {mirror(&ndf), glass(&ndf, 1.5)};
		const struct vec3 wi = vec3_from_spherical_deg(15.0 + 3.3 * i, 20.0);
		const int n = (int)(6000 / case_step(8)), n_walks = gamma < 1.6 ? n / 3 : n;
		int once = 0;
		for (int j = 0; j < 2 * n_walks; j++) {
			const struct random_walk *walk = &walks[j % 2];
			const struct vec3 from = j % 4 == 3 ? vec3_scale(wi, -1.0) : wi;
			const struct random_walk_exit out = random_walk_sample(walk, from, &numbers);
			assert_true(out.weight[0] == 1.0 && out.weight[1] == 1.0 && out.weight[2] == 1.0);
			assert_in_range(out.events, 1, RANDOM_WALK_EVENTS_MAX / 10);
			check_abs(vec3_length(out.wo), 1.0, 1e-14, "a direction");
			assert_true(out.wo.z > 0.0 || (walk->refracts && out.wo.z < 0.0));
			once += j % 2 == 0 && out.events == 1;
		}
		const struct cook_torrance model = {.ndf = ndf, .gaf = GAF_CORRELATED, .fresnel = FRESNEL_NONE};
		double albedo = NAN;
		assert_int_equal(energy_lobe(&model, wi.z, &albedo), STATUS_OK);
		check_mean((double)once / n_walks, sqrt(albedo * (1.0 - albedo) / n_walks) + 0.5 / n_walks, albedo,
			   "one event");
	}
}

static struct vec3 random_direction(uint64_t *random, bool both_sides)
{
	const double u = uniform(random), z = both_sides ? 2.0 * u - 1.0 : u, phi = 2.0 * M_PI * uniform(random);
	const double r = sqrt((1.0 - z) * (1.0 + z));
	return (struct vec3){r * cos(phi), r * sin(phi), z};
}

/* The white furnace of the estimated f: its integral with the cosine, over random directions. */
static void f_adds_up_to_one(void **state)
{
	(void)state;
	const double shapes[] = {1.8, 2.0, 4.0, 10.0, 50.0, INFINITY}, roughnesses[] = {0.4, 2.0};
	uint64_t random = 33;
	const struct random_numbers numbers = numbers_of(&random);
	for (int i = 0; i < 12; i++) {
		const struct ndf ndf = facets("std", roughnesses[i % 2], roughnesses[i % 2], shapes[i / 2]);
		const bool through = i / 2 % 2;
		const struct random_walk walk = through ? glass(&ndf, i % 2 ? 1.5 : 1.0 / 1.5) : mirror(&ndf);
		const struct vec3 wi = vec3_from_spherical_deg(35.0 + 3.0 * i, 80.0);
		const int n = (int)(20000 / case_step(5));
		double sum = 0.0, squares = 0.0;
		for (int j = 0; j < n; j++) {
			const struct vec3 wo = random_direction(&random, through);
			double f[3];
			random_walk_f(&walk, wi, wo, 0, &numbers, f);
			assert_true(f[0] >= 0.0 && f[0] == f[1] && f[1] == f[2]);
			const double value = f[0] * fabs(wo.z) * (through ? 4.0 : 2.0) * M_PI;
			sum += value;
			squares += value * value;
		}
		char label[64];
		snprintf(label, sizeof label, "gamma %g sigma %g %s", shapes[i / 2], roughnesses[i % 2],
			 through ? "glass" : "mirror");
		const double mean = sum / n, error = sqrt((squares / n - mean * mean) / n);
		check_between(error, 0.0, 0.15, label);
		check_mean(mean, error, 1.0, label);
	}
}

/* With one event f is that of single scattering, and needs no luck. */
static void one_event_is_single_scattering(void **state)
{
	(void)state;
	uint64_t random = 8;
	const struct random_numbers numbers = numbers_of(&random);
	const char *const names[] = {"std", "ggx", "beckmann", "hyper-cauchy", "t-family"};
	int seen[2] = {0, 0};
	for (int i = 0; i < 600; i++) {
		struct ndf ndf = facets(names[i % 5], 0.4, 0.9, 2.6);
		assert_int_equal(ndf_turn(&ndf, 40.0), STATUS_OK);
		const double n[3] = {0.2, 0.9, 1.4}, k[3] = {3.9, 2.4, 1.8};
		struct random_walk metal;
		assert_int_equal(random_walk_init_mirror(&metal, &ndf, FRESNEL_CONDUCTOR, n, k), STATUS_OK);
		const struct random_walk walk = glass(&ndf, 1.4);
		struct dielectric single;
		assert_int_equal(dielectric_init(&single, &ndf, GAF_CORRELATED, 1.4), STATUS_OK);
		const struct vec3 wi = random_direction(&random, true), wo = random_direction(&random, true);
		double f[3];
		random_walk_f(&walk, wi, wo, 1, &numbers, f);
		check_rel(f[1], dielectric_f(&single, wi, wo), 1e-11, "glass");
		seen[wo.z * wi.z > 0.0] += f[1] > 0.0;
		random_walk_f(&metal, wi, wo, 1, &numbers, f);
		for (int c = 0; c < 3; c++) {
			const struct cook_torrance model = {
				.ndf = ndf, .gaf = GAF_CORRELATED, .fresnel = FRESNEL_CONDUCTOR, .n = n[c], .k = k[c]};
			check_rel(f[c], cook_torrance_lobe(&model, wi, wo), 1e-11, "metal");
		}
	}
	assert_in_range(seen[0], 30, 600);
	assert_in_range(seen[1], 100, 600);
}

enum { BINS_Z = 6, BINS_PHI = 6, BINS = BINS_Z * BINS_PHI };

/* Bins of cos(theta) from low to 1, and azimuth. */
static int bin_of(struct vec3 w, double low)
{
	const int i = (int)((w.z - low) / (1.0 - low) * BINS_Z);
	const int j = (int)((atan2(w.y, w.x) / (2.0 * M_PI) + 0.5) * BINS_PHI);
	return (i < BINS_Z ? i : BINS_Z - 1) * BINS_PHI + (j < BINS_PHI ? j : BINS_PHI - 1);
}

static double f_cos_of_one(const struct random_walk *walk, struct vec3 wi, struct vec3 wo,
			   const struct random_numbers *numbers)
{
	double f[3];
	random_walk_f(walk, wi, wo, 1, numbers, f);
	return f[0] * fabs(wo.z);
}

/* Directions after one event follow the f of one event: there the height of the facet, the way out and the normals are all
 * drawn, and G is none of them. */
static void single_walks_follow_single_scattering(void **state)
{
	(void)state;
	enum { WALKS = 8000, INNER = 12, TESTS = 8 };
	uint64_t random = 77;
	for (int i = 0; i < TESTS; i++) {
		/* Below gamma = 2 what glass transmits is infinite along a curve. */
		const struct ndf ndf = facets("std", 0.5, 0.8, i % 4 > 1 ? 6.0 : i % 2 ? 2.1 : 1.7);
		const struct random_walk walk = i % 2 ? glass(&ndf, 1.5) : mirror(&ndf);
		const double low = i % 2 ? -1.0 : 0.0;
		const struct vec3 wi = vec3_from_spherical_deg(i < 4 ? 30.0 : 70.0, 15.0);
		const struct random_numbers numbers = numbers_of(&random);
		int count[BINS + 1] = {0};
		double expected[BINS + 1] = {0.0};
		for (int j = 0; j < WALKS; j++) {
			const struct random_walk_exit out = random_walk_sample(&walk, wi, &numbers);
			count[out.events == 1 ? bin_of(out.wo, low) : BINS]++;
		}
		expected[BINS] = WALKS;
		for (int bin = 0; bin < BINS; bin++) {
			for (int k = 0; k < INNER * INNER; k++) {
				const double z =
					low + (1.0 - low) * (bin / BINS_PHI + (k / INNER + 0.5) / INNER) / BINS_Z;
				const double phi =
					2.0 * M_PI * (bin % BINS_PHI + (k % INNER + 0.5) / INNER) / BINS_PHI - M_PI;
				const double r = sqrt((1.0 - z) * (1.0 + z));
				const struct vec3 wo = {r * cos(phi), r * sin(phi), z};
				expected[bin] += f_cos_of_one(&walk, wi, wo, &numbers);
			}
			expected[bin] *= WALKS * 2.0 * M_PI * (1.0 - low) / (BINS * INNER * INNER);
			expected[BINS] -= expected[bin];
		}
		char label[64];
		snprintf(label, sizeof label, "gamma %g n %g theta %d", ndf.gamma, walk.n[0], i < 4 ? 30 : 70);
		check_counts(BINS + 1, count, expected, TESTS, label);
	}
}

/* The mean of f with its standard error. */
struct estimate {
	double mean, error;
};

static struct estimate mean_f(const struct random_walk *walk, struct vec3 wi, struct vec3 wo, int n,
			      const struct random_numbers *numbers)
{
	double sum = 0.0, squares = 0.0;
	for (int i = 0; i < n; i++) {
		double f[3];
		random_walk_f(walk, wi, wo, 0, numbers, f);
		sum += f[1];
		squares += f[1] * f[1];
	}
	const double mean = sum / n;
	return (struct estimate){mean, sqrt(fmax(squares / n - mean * mean, 0.0) / n)};
}

static void mean_f_is_reciprocal(void **state)
{
	(void)state;
	uint64_t random = 12;
	const struct random_numbers numbers = numbers_of(&random);
	for (int i = 0; i < 16; i++) {
		const double gamma = i % 4 == 0 ? 1.8 : i % 4 == 1 ? 2.5 : i % 4 == 2 ? 9.0 : INFINITY;
		const struct ndf ndf = facets("std", 1.2, 0.7, gamma);
		const double colour[3] = {0.3, 0.2, 1.4}, k[3] = {3.0, 3.9, 1.6};
		struct random_walk walk = glass(&ndf, 1.4);
		if (i < 8)
			assert_int_equal(random_walk_init_mirror(&walk, &ndf, FRESNEL_CONDUCTOR, colour, k), STATUS_OK);
		const struct vec3 wi = vec3_from_spherical_deg(20.0 + 3.0 * i, 10.0);
		const bool through = i % 2 && i >= 8;
		const struct vec3 wo =
			vec3_from_spherical_deg(through ? 150.0 - 2.0 * i : 75.0 - 2.0 * i, through ? 200.0 : 130.0);
		const int n = (int)(20000 / case_step(8));
		const struct estimate there = mean_f(&walk, wi, wo, n, &numbers);
		struct estimate back = mean_f(&walk, wo, wi, n, &numbers);
		const double scale = through ? 1.4 * 1.4 : 1.0;
		back.mean *= scale;
		back.error *= scale;
		char label[64];
		snprintf(label, sizeof label, "gamma %g, case %d", gamma, i);
		check_between(there.error / there.mean, 1e-6, 0.3, label);
		check_mean(there.mean, hypot(there.error, back.error), back.mean, label);
	}
}

/* Where light comes in from everywhere, weighted by the cosine and, of glass, n^2, as much goes from one bin to another as
 * back: the joint counts of both are symmetric. It needs no f, and so holds the sampler alone, at any gamma. */
static void walks_go_either_way_alike(void **state)
{
	(void)state;
	enum { SIDES = 8, CELLS = SIDES * SIDES };
	uint64_t random = 91;
	const struct random_numbers numbers = numbers_of(&random);
	for (int i = 0; i < GAMMAS; i++) {
		const struct ndf ndf = facets("std", 0.9, 0.9, gammas[i]);
		const bool through = i % 2;
		const double n = 1.5, above = through ? 1.0 / (1.0 + n * n) : 1.0;
		const struct random_walk walk = through ? glass(&ndf, n) : mirror(&ndf);
		const int walks = (int)(20000 / case_step(5)) / (gammas[i] < 1.6 ? 2 : 1);
		int count[CELLS] = {0}, used = 0;
		double chi2 = 0.0;
		for (int j = 0; j < walks; j++) {
			const double side = uniform(&random) < above ? 1.0 : -1.0;
			const double u = uniform(&random), phi = 2.0 * M_PI * uniform(&random);
			const struct vec3 wi = {sqrt(1.0 - u) * cos(phi), sqrt(1.0 - u) * sin(phi), side * sqrt(u)};
			const struct vec3 wo = random_walk_sample(&walk, wi, &numbers).wo;
			/* Four bins of the cosine squared on either side */
			const int a = (int)(4.0 + 3.999 * wi.z * fabs(wi.z)),
				  b = (int)(4.0 + 3.999 * wo.z * fabs(wo.z));
			count[a * SIDES + b]++;
		}
		for (int a = 0; a < SIDES; a++) {
			for (int b = 0; b < a; b++) {
				const int one = count[a * SIDES + b], other = count[b * SIDES + a];
				if (one + other < 10)
					continue;
				chi2 += (double)(one - other) * (one - other) / (one + other);
				used++;
			}
		}
		assert_in_range(used, 5, CELLS);
		const double p = gsl_cdf_chisq_Q(chi2, used);
		if (!(p > 0.01 / GAMMAS))
			fail_msg("gamma %g: chi^2 %g of %d pairs, p = %.3g", gammas[i], chi2, used, p);
	}
}

/* The energy that walks bring into a bin, and that f sends there, channel by channel. */
static void weights_and_f_agree(void **state)
{
	(void)state;
	enum { ZONES = 4 };
	uint64_t random = 64;
	const struct random_numbers numbers = numbers_of(&random);
	for (int i = 0; i < 5; i++) {
		const double sigma = i < 3 ? 1.1 : 2.0;
		const struct ndf ndf = facets("std", sigma, sigma, i % 2 ? 2.2 : 7.0);
		const double n[3] = {0.2, 1.5, 1.1}, k[3] = {3.9, 0.0, 0.4}, dark[3] = {1.3, 1.5, 1.7};
		struct random_walk walk = glass(&ndf, 1.5);
		if (i < 2)
			assert_int_equal(random_walk_init_mirror(&walk, &ndf, FRESNEL_CONDUCTOR, n, k), STATUS_OK);
		if (i == 2) /* the walks of little light are ended at random */
			assert_int_equal(random_walk_init_mirror(&walk, &ndf, FRESNEL_SCHLICK, dark, k), STATUS_OK);
		const struct vec3 wi = vec3_from_spherical_deg(i < 3 ? 50.0 : i == 3 ? 110.0 : 160.0, 0.0);
		const double size = walk.refracts ? 2.0 : 1.0; /* range of the cosine */
		const int walks = (int)(40000 / case_step(5));
		double sum[2][ZONES][3] = {{{0.0}}}, squares[2][ZONES][3] = {{{0.0}}};
		for (int j = 0; j < 2 * walks; j++) {
			struct random_walk_exit out;
			double *value = out.weight;
			if (j % 2) {
				out.wo = random_direction(&random, walk.refracts);
				random_walk_f(&walk, wi, out.wo, 0, &numbers, value);
				for (int c = 0; c < 3; c++)
					value[c] *= fabs(out.wo.z) * 2.0 * M_PI * size;
			} else {
				out = random_walk_sample(&walk, wi, &numbers);
			}
			const int zone = (int)fmin((out.wo.z + size - 1.0) / size * ZONES, ZONES - 1);
			for (int c = 0; c < 3; c++) {
				sum[j % 2][zone][c] += value[c];
				squares[j % 2][zone][c] += value[c] * value[c];
			}
		}
		for (int z = 0; z < ZONES * 3; z++) {
			double mean[2], variance = 0.0;
			for (int j = 0; j < 2; j++) {
				mean[j] = sum[j][z / 3][z % 3] / walks;
				variance += (squares[j][z / 3][z % 3] / walks - mean[j] * mean[j]) / walks;
			}
			char label[64];
			snprintf(label, sizeof label, "case %d zone %d channel %d", i, z / 3, z % 3);
			check_between(mean[0], 1e-4, 1.0, label);
			check_mean(mean[0], sqrt(variance) + 1e-6, mean[1], label);
		}
	}
}

static void edges_and_refusals(void **state)
{
	(void)state;
	uint64_t random = 6;
	const struct random_numbers numbers = numbers_of(&random);
	const struct ndf ndf = facets("std", 0.5, 0.5, 3.0), low = facets("low", 0.5, 0.5, 3.0);
	const double good[3] = {1.5, 1.5, 1.5}, zero[3] = {0.0, 0.0, 0.0}, bad[3] = {1.5, -1.0, 1.5};
	struct random_walk walk = mirror(&ndf);
	const struct random_walk before = walk;
	assert_int_equal(random_walk_init_mirror(&walk, &low, FRESNEL_NONE, good, zero), STATUS_UNSUPPORTED);
	assert_int_equal(random_walk_init_mirror(&walk, &ndf, FRESNEL_SCHLICK, bad, zero), STATUS_DOMAIN);
	assert_int_equal(random_walk_init_mirror(&walk, &ndf, FRESNEL_CONDUCTOR, good, bad), STATUS_DOMAIN);
	assert_int_equal(random_walk_init_dielectric(&walk, &ndf, 1.0), STATUS_DOMAIN);
	assert_int_equal(random_walk_init_dielectric(&walk, &low, 1.5), STATUS_UNSUPPORTED);
	assert_memory_equal(&walk, &before, sizeof walk);

	const struct vec3 up = {0.0, 0.0, 1.0}, level = {1.0, 0.0, 0.0}, down = {0.0, 0.0, -1.0};
	double f[3] = {7.0, 7.0, 7.0};
	random_walk_f(&walk, up, down, 0, &numbers, f);
	assert_true(f[0] == 0.0 && f[1] == 0.0 && f[2] == 0.0);
	const struct random_walk clear = glass(&ndf, 1.5);
	random_walk_f(&clear, up, level, 0, &numbers, f);
	assert_true(f[0] == 0.0);
	random_walk_f(&clear, level, down, 0, &numbers, f);
	assert_true(f[0] == 0.0);
	/* A roughness far from use, and grazing light */
	const double far[] = {1e-50, 1e-6, 1e3};
	for (int i = 0; i < 3; i++) {
		const struct ndf odd = facets("std", far[i], far[i], 2.3);
		const struct random_walk walks[] = {mirror(&odd), glass(&odd, 1.7)};
		for (int j = 0; j < 400; j++) {
			const struct vec3 wi =
				j % 4 < 2 ? up : vec3_from_spherical_deg(90.0 - pow(10.0, -j % 15), 30.0);
			const struct random_walk_exit out = random_walk_sample(&walks[j % 2], wi, &numbers);
			check_abs(vec3_length(out.wo), 1.0, 1e-14, "a direction");
			assert_true(out.weight[0] == 1.0 && (out.wo.z > 0.0 || j % 2));
		}
	}
	/* The form of Lambda does not matter: the walk has the exact one. */
	struct ndf rational = ndf;
	assert_int_equal(ndf_set_lambda_form(&rational, LAMBDA_RATIONAL), STATUS_OK);
	const struct random_walk exact = mirror(&rational);
	assert_memory_equal(&exact.ndf, &ndf, sizeof ndf);
	/* Facets that reflect nothing end the walk. */
	assert_int_equal(random_walk_init_mirror(&walk, &ndf, FRESNEL_DIELECTRIC, (double[3]){1.0, 1.0, 1.0}, zero),
			 STATUS_OK);
	assert_true(random_walk_sample(&walk, up, &numbers).weight[0] == 0.0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_light_comes_back),
		cmocka_unit_test(f_adds_up_to_one),
		cmocka_unit_test(one_event_is_single_scattering),
		cmocka_unit_test(single_walks_follow_single_scattering),
		cmocka_unit_test(mean_f_is_reciprocal),
		cmocka_unit_test(walks_go_either_way_alike),
		cmocka_unit_test(weights_and_f_agree),
		cmocka_unit_test(edges_and_refusals),
	};
	return cmocka_run_group_tests_name("random walk", tests, NULL, NULL);
}
