/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spheres: environments and their sampling, surfaces and theirs, white furnaces, estimators against each other, the
 * same model from its formula and from its table, errors of pictures. */
#include "chi_square.h"
#include "fit/render/pictures.h"
#include "make_table.h"
#include "src/energy.h"

/* A map with this radiance everywhere. */
static struct environment constant_light(double radiance)
{
	struct image map;
	struct environment environment;
	struct error why = {""};
	assert_int_equal(image_alloc(&map, 16, 8), STATUS_OK);
	for (int i = 0; i < 3 * 16 * 8; i++)
		map.rgb[i] = (float)radiance;
	if (environment_from_map(&environment, &map, &why) != STATUS_OK)
		fail_msg("%s", why.text);
	return environment;
}

/* A rough map with bright, dark and black texels, bright ones at a pole and across the seam. */
static struct environment spotted_light(void)
{
	struct image map;
	struct environment environment;
	uint64_t seed = 5;
	assert_int_equal(image_alloc(&map, 32, 16), STATUS_OK);
	for (int i = 0; i < 32 * 16; i++) {
		const double u = uniform(&seed);
		for (int c = 0; c < 3; c++)
			map.rgb[3 * i + c] = u < 0.5 ? 0 : (float)(pow(u, 12) * (1 + c));
	}
	image_at(&map, 31, 7)[0] = image_at(&map, 0, 7)[1] = image_at(&map, 3, 0)[2] = 9;
	assert_int_equal(environment_from_map(&environment, &map, NULL), STATUS_OK);
	return environment;
}

/* Direction of the place (u, v) of a map, both in [0, 1]. */
static struct vec3 direction(double u, double v)
{
	const double turn = 2 * M_PI * (u - 0.5), up = M_PI * v;
	return (struct vec3){sin(up) * sin(turn), cos(up), -sin(up) * cos(turn)};
}

static void the_density_of_light_samples_integrates_to_1(void **state)
{
	(void)state;
	for (int i = 0; i < 3; i++) {
		struct environment e;
		if (i < 2)
			assert_int_equal(environment_named(environment_name(i), &e), STATUS_OK);
		else
			e = spotted_light();
		/* The density is constant in a texel; its measure is known. */
		double sum = 0;
		for (int y = 0; y < e.map.height; y++)
			for (int x = 0; x < e.map.width; x++) {
				const struct vec3 to = direction((x + 0.5) / e.map.width, (y + 0.5) / e.map.height);
				const double measure =
					2 * M_PI / e.map.width *
					(cos(M_PI * y / e.map.height) - cos(M_PI * (y + 1) / e.map.height));
				sum += environment_at(&e, to).pdf * measure;
			}
		check_abs(sum, 1, 1e-9, "integral");
		environment_free(&e);
	}
}

static void light_samples_follow_their_density(void **state)
{
	(void)state;
	struct environment e = spotted_light();
	enum { N = 40000, CELLS = 32 * 16 };
	static int count[CELLS];
	static double expected[CELLS];
	uint64_t seed = 11;
	for (int i = 0; i < N; i++) {
		const struct vec3 to = environment_sample(&e, uniform(&seed), uniform(&seed));
		check_abs(vec3_length(to), 1, 1e-14, "unit");
		const double u = 0.5 + atan2(to.x, -to.z) / (2 * M_PI), v = acos(to.y) / M_PI;
		count[(int)fmin(u * 32, 31) + 32 * (int)fmin(v * 16, 15)]++;
		assert_true(environment_at(&e, to).pdf > 0);
	}
	for (int y = 0; y < 16; y++)
		for (int x = 0; x < 32; x++)
			expected[x + 32 * y] = N * environment_at(&e, direction((x + 0.5) / 32, (y + 0.5) / 16)).pdf *
					       2 * M_PI / 32 * (cos(M_PI * y / 16) - cos(M_PI * (y + 1) / 16));
	check_counts(CELLS, count, expected, 1, "texels");
	/* Where there is light, there is density, and the integral of radiance comes out right by either. */
	double by_samples[3] = {0}, by_rule[3] = {0};
	enum { GRID = 512 };
	for (int i = 0; i < GRID * GRID; i++) {
		const struct vec3 to = environment_sample(&e, (i / GRID + 0.5) / GRID, (i % GRID + 0.5) / GRID);
		const struct arriving light = environment_at(&e, to);
		const double v = (i / GRID + 0.5) / GRID;
		const struct arriving there = environment_at(&e, direction((i % GRID + 0.5) / GRID, v));
		for (int c = 0; c < 3; c++) {
			by_samples[c] += light.rgb[c] / light.pdf / (GRID * GRID);
			by_rule[c] += there.rgb[c] * sin(M_PI * v) * 2 * M_PI * M_PI / (GRID * GRID);
			assert_true(there.rgb[c] == 0 || there.pdf > 0);
		}
	}
	for (int c = 0; c < 3; c++)
		check_rel(by_samples[c], by_rule[c], 5e-3, "integral of radiance");
	environment_free(&e);
}

static void maps_lie_as_documented(void **state)
{
	(void)state;
	struct image map;
	struct environment e;
	assert_int_equal(image_alloc(&map, 64, 32), STATUS_OK);
	image_at(&map, 32, 16)[0] = image_at(&map, 31, 16)[0] = 1; /* the middle */
	image_at(&map, 48, 16)[1] = 1;                             /* the right half's middle */
	image_at(&map, 5, 0)[2] = 1;                               /* the top */
	assert_int_equal(environment_from_map(&e, &map, NULL), STATUS_OK);
	assert_null(map.rgb);
	assert_true(environment_at(&e, (struct vec3){0, -0.02, -1}).rgb[0] > 0.4);
	assert_true(environment_at(&e, vec3_unit((struct vec3){1, -0.05, 0.05})).rgb[1] > 0.5);
	const struct arriving top = environment_at(&e, direction(5.5 / 64, 0.5 / 32));
	check_rel(top.rgb[2], 1, 1e-6, "top");
	environment_scale(&e, 0.25);
	check_rel(environment_at(&e, direction(5.5 / 64, 0.5 / 32)).rgb[2], 0.25, 1e-6, "scaled");
	environment_free(&e);
}

static void what_is_no_map_is_refused(void **state)
{
	(void)state;
	static const struct {
		int width, height;
		float value;
		const char *part;
	} bad[] = {{8, 8, 1, "twice as wide as high, found 8 x 8"},
		   {8, 4, 0, "expected some light"},
		   {8, 4, -1, "found -1 in column 3 of row 2"},
		   {8, 4, NAN, "found nan"},
		   {8, 4, INFINITY, "found inf"}};
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct image map;
		struct environment e = {0};
		struct error why = {""};
		assert_int_equal(image_alloc(&map, bad[i].width, bad[i].height), STATUS_OK);
		image_at(&map, 2, 1)[1] = bad[i].value;
		assert_int_equal(environment_from_map(&e, &map, &why), STATUS_FORMAT);
		if (!strstr(why.text, bad[i].part))
			fail_msg("expected '%s' in '%s'", bad[i].part, why.text);
		image_free(&map);
	}
	struct environment e = {0};
	assert_int_equal(environment_named("no-such", &e), STATUS_DOMAIN);
	assert_null(environment_name(3));
}

/* Models of every kind of lobe that a picture has to cope with. */
enum { PLAIN = 8 };
static struct cook_torrance model_number(int i)
{
	static const struct {
		const char *ndf;
		double sigma, gamma, n;
		enum gaf gaf;
	} kind[] = {{"std", 0.3, 1.8, 1.5, GAF_UNCORRELATED},
		    {"ggx", 0.05, 2, 8, GAF_CORRELATED},
		    {"beckmann", 0.6, 2, 1.4, GAF_V_GROOVE},
		    {"gtr", 0.2, 1.4, 2, GAF_UNCORRELATED},
		    {"low", 0.15, 1.6, 1.7, GAF_UNCORRELATED},
		    {"beckmann", 1e-4, 2, 1.5, GAF_UNCORRELATED},
		    {"std", 1.5, 1.51, 30, GAF_CORRELATED},
		    {"hyper-cauchy", 0.1, 2.6, 1.3, GAF_UNCORRELATED},
		    /* Richer: three reflectances; two lobes. Both with a grazing term. */
		    {"std", 0.2, 1.7, 1, GAF_CORRELATED},
		    {"std", 0.25, 2.5, 1.6, GAF_UNCORRELATED}};
	struct cook_torrance model = make_model(kind[i].ndf, kind[i].sigma, kind[i].gamma, kind[i].n);
	model.gaf = kind[i].gaf;
	if (i >= PLAIN) {
		const double reflectance[F82_PARTS] = {0.3, 0.8, 0.9}, kg[3] = {0.2, 0.1, 0.3},
			     second[3] = {0.3, 0.5, 0.1};
		memcpy(model.reflectance[1], reflectance, sizeof reflectance);
		memcpy(model.kg, kg, sizeof kg);
		model.grazing = 4;
		model.fresnel = i == PLAIN ? FRESNEL_F82 : model.fresnel;
		if (i > PLAIN)
			memcpy(model.ks_second, second, sizeof second);
		assert_int_equal(ndf_init(&model.second, model.ndf.class, 0.7, 0.7, 2.2), STATUS_OK);
	}
	return model;
}
enum { MODELS = PLAIN + 2 };

static struct vec3 view_at(double degrees)
{
	return (struct vec3){sin(degrees * M_PI / 180), 0, cos(degrees * M_PI / 180)};
}

static struct surface make_surface(const struct cook_torrance *model, enum sampling sampling)
{
	struct surface surface;
	assert_int_equal(surface_init(&surface, model, NULL, sampling), STATUS_OK);
	return surface;
}

/* Whether an earlier value of `sampling` has shown this way to sample. */
static bool is_known(const struct surface *surface, enum sampling sampling)
{
	return sampling > SAMPLING_NDF && surface->lobe[0].own;
}

static void surfaces_reflect_as_their_model(void **state)
{
	(void)state;
	uint64_t seed = 3;
	for (int i = 0; i < MODELS; i++) {
		const struct cook_torrance model = model_number(i);
		struct surface surface = make_surface(&model, SAMPLING_VISIBLE);
		for (int n = 0; n < 300; n++) {
			const struct vec3 wo = view_at(89.9 * uniform(&seed));
			const struct view view = surface_view(&surface, wo);
			const double z = uniform(&seed), turn = 2 * M_PI * uniform(&seed), r = sqrt(1 - z * z);
			const struct vec3 wi = {r * cos(turn), r * sin(turn), z};
			double f[3], want[3];
			surface_f(&surface, &view, wi, f);
			cook_torrance_f(&model, wi, wo, want);
			for (int c = 0; c < 3; c++)
				check_rel(f[c], want[c], 1e-7, ndf_name(model.ndf.class));
		}
		surface_free(&surface);
	}
}

/* Directions drawn by surface_sample() against the density that surface_f() returns, in cells of equal solid angle. */
static void surface_samples_follow_their_density(void **state)
{
	(void)state;
	enum { N = 8000, RINGS = 12, SECTORS = 16, CELLS = RINGS * SECTORS, FINE = 12 };
	static const double angles[] = {0, 50, 85};
	for (int i = 0; i < MODELS; i++)
		for (int sampling = 0; sampling < SAMPLING_COUNT; sampling++)
			for (size_t a = 0; a < sizeof angles / sizeof *angles; a++) {
				const struct cook_torrance model = model_number(i);
				if (model.ndf.sigma_x < 0.2)
					continue; /* too narrow for these cells: the next test has them */
				struct surface surface = make_surface(&model, (enum sampling)sampling);
				if (is_known(&surface, (enum sampling)sampling)) {
					surface_free(&surface);
					continue;
				}
				const struct view view = surface_view(&surface, view_at(angles[a]));
				int count[CELLS] = {0};
				double expected[CELLS] = {0}, f[3];
				uint64_t seed = 17;
				for (int n = 0; n < N; n++) {
					const double u[2] = {uniform(&seed), uniform(&seed)};
					struct vec3 wi;
					if (!surface_sample(&surface, &view, u, &wi))
						continue;
					const double turn = 0.5 + atan2(wi.y, wi.x) / (2 * M_PI);
					count[(int)fmin(wi.z * RINGS, RINGS - 1) * SECTORS +
					      (int)fmin(turn * SECTORS, SECTORS - 1)]++;
				}
				for (int cell = 0; cell < CELLS * FINE * FINE; cell++) {
					const int ring = cell / (SECTORS * FINE * FINE),
						  in_ring = cell % (SECTORS * FINE * FINE);
					const int sector = in_ring / (FINE * FINE), fine = in_ring % (FINE * FINE);
					const double z = (ring + (fine / FINE + 0.5) / FINE) / RINGS;
					const double turn =
						2 * M_PI * ((sector + (fine % FINE + 0.5) / FINE) / SECTORS - 0.5);
					const double r = sqrt(1 - z * z);
					expected[ring * SECTORS + sector] +=
						N *
						surface_f(&surface, &view,
							  (struct vec3){r * cos(turn), r * sin(turn), z}, f) *
						2 * M_PI / (CELLS * FINE * FINE);
				}
				char label[64];
				snprintf(label, sizeof label, "model %d, %s, %g deg", i,
					 sampling_name((enum sampling)sampling), angles[a]);
				check_counts(CELLS, count, expected, 5 * 2 * 3, label);
				surface_free(&surface);
			}
}

/* The white furnace: what samples of the surface find of its albedo is what quadrature finds. */
static void sampled_albedo_is_the_energy(void **state)
{
	(void)state;
	static const double angles[] = {0, 40, 75};
	for (int i = 0; i < MODELS; i++)
		for (size_t a = 0; a < sizeof angles / sizeof *angles; a++) {
			const struct cook_torrance model = model_number(i);
			const struct vec3 wo = view_at(angles[a]);
			double albedo[3];
			assert_int_equal(energy_albedo(&model, wo.z, albedo), STATUS_OK);
			for (int sampling = 0; sampling < SAMPLING_COUNT; sampling++) {
				struct surface surface = make_surface(&model, (enum sampling)sampling);
				if (is_known(&surface, (enum sampling)sampling)) {
					surface_free(&surface);
					continue;
				}
				const struct view view = surface_view(&surface, wo);
				uint64_t seed = 23;
				double sum = 0, squares = 0;
				enum { N = 4000 };
				for (int n = 0; n < N; n++) {
					const double u[2] = {uniform(&seed), uniform(&seed)};
					struct vec3 wi;
					double f[3];
					if (!surface_sample(&surface, &view, u, &wi))
						continue;
					const double pdf = surface_f(&surface, &view, wi, f);
					const double x = f[1] * wi.z / pdf;
					sum += x;
					squares += x * x;
				}
				const double mean = sum / N, variance = (squares / N - mean * mean) / N;
				char label[64];
				snprintf(label, sizeof label, "model %d, %s, %g deg", i,
					 sampling_name((enum sampling)sampling), angles[a]);
				check_mean(mean, sqrt(variance), albedo[1], label);
				surface_free(&surface);
			}
		}
}

static struct sphere render_with(const struct surface *surface, const struct environment *environment,
				 struct sphere_options options)
{
	struct sphere sphere;
	assert_int_equal(sphere_render(surface, environment, &options, &sphere), STATUS_OK);
	return sphere;
}

static void a_white_sphere_in_white_light_is_white(void **state)
{
	(void)state;
	struct environment light = constant_light(1);
	const struct cook_torrance white = {.kd = {1, 1, 1}};
	struct surface surface = make_surface(&white, SAMPLING_VISIBLE);
	for (int estimator = ESTIMATE_BOTH; estimator <= ESTIMATE_SURFACE; estimator++) {
		struct sphere sphere = render_with(
			&surface, &light,
			(struct sphere_options){
				.size = 16, .samples = 256, .estimator = (enum estimator)estimator, .threads = 2});
		double sum = 0;
		int n = 0;
		for (int i = 0; i < 256; i++) {
			if (sphere.coverage[i] < 1)
				continue;
			/* Sampled by its cosine it is white to the bit of a float. */
			check_abs((double)sphere.light.rgb[3 * i], 1, estimator == ESTIMATE_SURFACE ? 1e-6 : 0.1,
				  "a pixel");
			sum += (double)sphere.light.rgb[3 * i];
			n++;
		}
		assert_true(n > 100);
		check_abs(sum / n, 1, 2e-3, "mean");
		sphere_free(&sphere);
	}
	/* The corner shows no sphere, the middle nothing else. */
	struct sphere sphere =
		render_with(&surface, &light, (struct sphere_options){.size = 16, .samples = 4, .threads = 1});
	assert_true(sphere.coverage[0] == 0 && sphere.light.rgb[0] == 0);
	assert_true(sphere.coverage[8 * 16 + 8] == 1);
	sphere_free(&sphere);
	surface_free(&surface);
	environment_free(&light);
}

/* The mean radiance of a picture, with what several seeds scatter around it. */
static void mean_light(const struct surface *surface, const struct environment *light, enum estimator estimator,
		       double *mean, double *error)
{
	enum { SEEDS = 8, SIZE = 12 };
	double value[SEEDS], sum = 0, squares = 0;
	for (int s = 0; s < SEEDS; s++) {
		struct sphere sphere = render_with(surface, light,
						   (struct sphere_options){.size = SIZE,
									   .samples = 32,
									   .seed = (uint64_t)(100 + s),
									   .estimator = estimator,
									   .threads = 2});
		value[s] = 0;
		for (int i = 0; i < SIZE * SIZE; i++)
			value[s] += (double)(sphere.light.rgb[3 * i + 1] * sphere.coverage[i]);
		sphere_free(&sphere);
		sum += value[s];
	}
	*mean = sum / SEEDS;
	for (int s = 0; s < SEEDS; s++)
		squares += (value[s] - *mean) * (value[s] - *mean);
	*error = sqrt(squares / (SEEDS * (SEEDS - 1.0)));
}

/* Light alone, surface alone, both weighted; all normals, visible normals: the same picture in the mean. */
static void estimators_agree_in_the_mean(void **state)
{
	(void)state;
	struct environment light;
	assert_int_equal(environment_named("studio", &light), STATUS_OK);
	for (int i = 0; i < MODELS; i++) {
		const struct cook_torrance model = model_number(i);
		double want, want_error;
		struct surface surface = make_surface(&model, SAMPLING_VISIBLE);
		mean_light(&surface, &light, ESTIMATE_BOTH, &want, &want_error);
		assert_true(want_error < 0.05 * want);
		for (int sampling = 0; sampling < SAMPLING_COUNT; sampling++) {
			struct surface other = make_surface(&model, (enum sampling)sampling);
			for (int estimator = ESTIMATE_BOTH; estimator <= ESTIMATE_SURFACE; estimator++) {
				if (sampling > SAMPLING_NDF && (other.lobe[0].own || estimator != ESTIMATE_SURFACE))
					continue;
				double mean, error;
				char label[64];
				if (estimator == ESTIMATE_LIGHT && model.ndf.sigma_x < 0.1)
					continue; /* no light sample ever hits such a lobe */
				mean_light(&other, &light, (enum estimator)estimator, &mean, &error);
				snprintf(label, sizeof label, "model %d, %s, estimator %d", i,
					 sampling_name((enum sampling)sampling), estimator);
				/* Eight seeds give the error itself to a quarter only. */
				check_mean(mean, 1.5 * hypot(error, want_error), want, label);
			}
			surface_free(&other);
		}
		surface_free(&surface);
	}
	environment_free(&light);
}

static void the_same_bits_for_any_number_of_threads(void **state)
{
	(void)state;
	struct environment light;
	assert_int_equal(environment_named("sky", &light), STATUS_OK);
	const struct cook_torrance model = model_number(0);
	struct surface surface = make_surface(&model, SAMPLING_VISIBLE);
	struct sphere_options options = {.size = 20, .samples = 5, .seed = 9, .threads = 1};
	struct sphere one = render_with(&surface, &light, options);
	for (int threads = 2; threads <= 5; threads++) {
		options.threads = threads;
		struct sphere other = render_with(&surface, &light, options);
		assert_memory_equal(one.light.rgb, other.light.rgb, 3 * 20 * 20 * sizeof(float));
		assert_memory_equal(one.coverage, other.coverage, 20 * 20 * sizeof(float));
		sphere_free(&other);
	}
	options.seed = 10;
	struct sphere other = render_with(&surface, &light, options);
	assert_memory_not_equal(one.light.rgb, other.light.rgb, 3 * 20 * 20 * sizeof(float));
	sphere_free(&other);
	const atomic_bool stop = true;
	options.cancel = &stop;
	assert_int_equal(sphere_render(&surface, &light, &options, &other), STATUS_INTERRUPTED);
	assert_null(other.light.rgb);
	sphere_free(&one);
	surface_free(&surface);
	environment_free(&light);
}

/* A Lambertian sphere under one point light: kd/pi E cos_i, in every pixel. */
static void a_point_light_follows_the_cosine(void **state)
{
	(void)state;
	struct environment light;
	const struct vec3 to = vec3_unit((struct vec3){0.3, -0.5, 0.8});
	environment_from_lights(&light, &(struct light){to, {M_PI, 2 * M_PI, 0}}, 1);
	const struct cook_torrance matte = {.kd = {0.5, 0.25, 1}};
	struct surface surface = make_surface(&matte, SAMPLING_VISIBLE);
	enum { SIZE = 64 };
	struct sphere sphere =
		render_with(&surface, &light, (struct sphere_options){.size = SIZE, .samples = 16, .threads = 2});
	int lit = 0, dark = 0;
	for (int y = 0; y < SIZE; y++)
		for (int x = 0; x < SIZE; x++) {
			const double radius = 0.48 * SIZE;
			const double right = (x + 0.5 - 0.5 * SIZE) / radius, up = (0.5 * SIZE - y - 0.5) / radius;
			const double z2 = 1 - right * right - up * up;
			if (z2 < 0.1)
				continue;
			const double cos_i = right * to.x + up * to.y + sqrt(z2) * to.z;
			const float *rgb = image_at(&sphere.light, x, y);
			/* Over a pixel the cosine changes by up to 0.1. */
			check_abs((double)rgb[0], 0.5 * fmax(cos_i, 0), 0.03, "red");
			assert_true(rgb[1] == rgb[0] && rgb[2] == 0);
			lit += cos_i > 0.1;
			dark += cos_i < -0.1;
		}
	assert_true(lit > 2000 && dark > 50);
	sphere_free(&sphere);
	surface_free(&surface);
	environment_free(&light);
}

/* Something smooth of the angles, reciprocal, to put into a table. */
static double smooth_value(struct halfdiff a)
{
	return exp(-a.theta_h) * (2 + cos(a.theta_d)) * (3 + cos(2 * a.phi_d));
}

/* At an entry the table gives what was put in, between entries what belongs there, at the seams of phi_d too. */
static void tables_are_interpolated(void **state)
{
	(void)state;
	for (int b = 0; b < BINS_COUNT; b++)
		for (int n_phi = 180; n_phi <= 360; n_phi += 180) {
			struct measurement measurement;
			struct measured measured;
			assert_int_equal(measurement_alloc(&measurement, n_phi), STATUS_OK);
			for (int e = 0; e < 90 * 90 * n_phi; e++)
				measurement.value[1][e] = measurement.value[0][e] = measurement.value[2][e] =
					(float)smooth_value(
						bins_angles((enum bins)b, e / n_phi / 90, e / n_phi % 90, e % n_phi));
			assert_int_equal(measured_init(&measured, &measurement, (enum bins)b, 1), STATUS_OK);
			uint64_t seed = 1;
			for (int n = 0; n < 3000; n++) {
				const bool at_entry = n % 2;
				const int i = 2 + (int)(50 * uniform(&seed)), j = 1 + (int)(50 * uniform(&seed));
				struct halfdiff a = bins_angles((enum bins)b, i, j, (int)(n_phi * uniform(&seed)));
				if (!at_entry)
					a = (struct halfdiff){0.6 * uniform(&seed) + 0.01, 0.9 * uniform(&seed) + 0.01,
							      2 * M_PI * uniform(&seed)};
				if (n % 10 == 0)
					a.phi_d = M_PI * (n / 10 % 3) + 0.02 * (uniform(&seed) - 0.5);
				struct vec3 wi, wo;
				double f[3], back[3];
				halfdiff_to_dirs(a, &wi, &wo);
				measured_f(&measured, wi, wo, f);
				if (wi.z <= 0 || wo.z <= 0) {
					assert_true(f[0] == 0);
					continue;
				}
				check_rel(f[1], smooth_value(a), at_entry ? 1e-6 : 2e-3, "value");
				/* Swapping the directions turns phi_d by 180 degrees. */
				measured_f(&measured, wo, wi, back);
				check_rel(back[1], f[1], 1e-6, "reciprocal");
			}
			measured_free(&measured);
			measurement_free(&measurement);
		}
}

static void gaps_take_their_neighbours_value(void **state)
{
	(void)state;
	struct measurement measurement;
	struct measured measured;
	assert_int_equal(measurement_alloc(&measurement, 180), STATUS_OK);
	/* Only theta_d index 3 and below is measured, nothing at theta_h index 5 and k = 7. */
	for (int i = 0; i < 90; i++)
		for (int j = 0; j < 4; j++)
			for (int k = 0; k < 180; k++)
				for (int c = 0; c < 3 && !(i == 5 && k == 7); c++)
					measurement.value[c][measurement_at(180, i, j, k)] = (float)(1 + j + 10 * i);
	assert_int_equal(measured_init(&measured, &measurement, BINS_NODE, 1), STATUS_OK);
	assert_true(measured.value[3 * measurement_at(180, 20, 40, 100)] == 204.0F);
	assert_true(measured.value[3 * measurement_at(180, 5, 2, 7) + 1] == 41.0F);
	measured_free(&measured);
	measurement_free(&measurement);
	/* Below the horizon there is nothing. */
	assert_int_equal(measurement_alloc(&measurement, 180), STATUS_OK);
	assert_int_equal(measured_init(&measured, &measurement, BINS_NODE, 1), STATUS_OK);
	double f[3] = {1, 1, 1};
	measured_f(&measured, (struct vec3){0, 0, 1}, (struct vec3){1, 0, -1e-9}, f);
	assert_true(f[0] == 0 && f[1] == 0 && f[2] == 0);
	measured_free(&measured);
	measurement_free(&measurement);
}

/* The same model from its formula and from its table: the picture is the same to the table's resolution. */
static void formula_and_table_make_one_picture(void **state)
{
	(void)state;
	static const struct {
		const char *ndf;
		double sigma, gamma, delta_e, ssim;
	} kind[] = {
		{"std", 0.3, 1.8, 0.01, 0.9999}, {"ggx", 0.05, 2, 0.03, 0.9999}, {"beckmann", 0.15, 2, 0.02, 0.9999}};
	struct environment light;
	assert_int_equal(environment_named("studio", &light), STATUS_OK);
	for (size_t i = 0; i < sizeof kind / sizeof *kind; i++)
		for (int b = 0; b < (i ? 1 : BINS_COUNT); b++) {
			const struct cook_torrance model = make_model(kind[i].ndf, kind[i].sigma, kind[i].gamma, 1.6);
			struct measurement measurement = make_table(&model, 180, (enum bins)b, 0);
			struct pictures pictures;
			const struct sphere_options options = {.size = 48, .samples = 32, .threads = 2};
			assert_int_equal(pictures_render(&measurement, (enum bins)b,
							 &(struct pictures_model){&model, NAN}, 1, SAMPLING_VISIBLE,
							 &light, &options, &pictures),
					 STATUS_OK);
			check_between(pictures.error[0].delta_e, 0, kind[i].delta_e, "delta E");
			check_between(pictures.error[0].ssim, kind[i].ssim, 1, "SSIM");
			pictures_free(&pictures);
			measurement_free(&measurement);
		}
	environment_free(&light);
}

/* The light of a pixel of a sphere that a lamp lights, from its normal: x to the right, y to the upper pole. */
static double lit(const struct cook_torrance *model, int size, int px, int py, struct vec3 to)
{
	const double radius = size * 0.48, right = (px + 0.5 - size * 0.5) / radius,
		     up = (size * 0.5 - py - 0.5) / radius;
	const struct vec3 n = {right, up, sqrt(1 - right * right - up * up)};
	const struct vec3 pole = {0, 1, 0}, y = vec3_unit(vec3_sub(pole, vec3_scale(n, n.y))), eye = {0, 0, 1};
	const struct vec3 x = {y.y * n.z - y.z * n.y, y.z * n.x - y.x * n.z, y.x * n.y - y.y * n.x};
	const struct vec3 wi = {vec3_dot(x, to), vec3_dot(y, to), vec3_dot(n, to)};
	const struct vec3 wo = {vec3_dot(x, eye), vec3_dot(y, eye), vec3_dot(n, eye)};
	double f[3];
	assert_true(x.x > 0);
	cook_torrance_f(model, wi, wo, f);
	return f[1] * wi.z;
}

static void tangents_point_to_the_right_and_up(void **state)
{
	(void)state;
	enum { SIZE = 100 };
	static const int pixel[][2] = {{50, 50}, {70, 40}, {30, 45}, {60, 75}, {52, 10}, {85, 50}};
	const struct light lamp = {.to = vec3_unit((struct vec3){0.5, 0.3, 0.8}), .irradiance = {1, 1, 1}};
	struct environment light;
	struct cook_torrance model = make_model("ggx", 0.3, 2, 1.5);
	assert_int_equal(ndf_init(&model.ndf, ndf_find("ggx"), 0.6, 0.2, 2), STATUS_OK);
	assert_int_equal(ndf_turn(&model.ndf, 30), STATUS_OK);
	environment_from_lights(&light, &lamp, 1);
	struct surface surface = make_surface(&model, SAMPLING_VISIBLE);
	struct sphere sphere = render_with(
		&surface, &light, (struct sphere_options){.size = SIZE, .samples = 64, .tangents = true, .threads = 2});
	for (size_t i = 0; i < sizeof pixel / sizeof *pixel; i++) {
		const int x = pixel[i][0], y = pixel[i][1];
		check_rel((double)image_at(&sphere.light, x, y)[1], lit(&model, SIZE, x, y, lamp.to), 0.01, "a pixel");
	}
	sphere_free(&sphere);
	surface_free(&surface);
	environment_free(&light);
}

static void errors_of_pictures(void **state)
{
	(void)state;
	struct environment light = constant_light(1);
	const struct cook_torrance grey = {.kd = {0.5, 0.5, 0.5}}, lighter = {.kd = {0.6, 0.6, 0.6}};
	struct surface a = make_surface(&grey, SAMPLING_VISIBLE), b = make_surface(&lighter, SAMPLING_VISIBLE);
	const struct sphere_options options = {.size = 24, .samples = 16, .estimator = ESTIMATE_SURFACE, .threads = 2};
	struct sphere p = render_with(&a, &light, options), q = render_with(&b, &light, options);
	struct picture_error error;
	assert_int_equal(picture_error_compute(&p, &p, &error), STATUS_OK);
	assert_true(error.rmse == 0 && error.delta_e == 0 && error.ssim == 1);
	assert_int_equal(picture_error_compute(&p, &q, &error), STATUS_OK);
	check_rel(error.rmse, 0.1, 1e-5, "rmse");
	const float lab_a[] = {0.5F, 0.5F, 0.5F}, lab_b[] = {0.6F, 0.6F, 0.6F};
	check_rel(error.delta_e, picture_delta_e(lab_a, lab_b), 1e-5, "delta E");
	check_between(error.ssim, 0.9, 0.9999, "SSIM");
	/* A screen shows no difference beyond its white. */
	assert_true(picture_delta_e((const float[]){1, 1, 1}, (const float[]){30, 2, 1}) == 0);
	sphere_free(&p);
	sphere_free(&q);
	surface_free(&a);
	surface_free(&b);
	environment_free(&light);
}

/* What the header says of the built-in light: the brightest point of a white sphere has about radiance 1. */
static void built_in_light_is_of_one_brightness(void **state)
{
	(void)state;
	const struct cook_torrance white = {.kd = {1, 1, 1}};
	struct surface surface = make_surface(&white, SAMPLING_VISIBLE);
	for (int i = 0; environment_name(i); i++) {
		struct environment light;
		assert_int_equal(environment_named(environment_name(i), &light), STATUS_OK);
		struct sphere sphere = render_with(&surface, &light,
						   (struct sphere_options){.size = 24, .samples = 256, .threads = 2});
		double most = 0;
		for (int p = 0; p < 24 * 24; p++)
			most = fmax(most, sphere.coverage[p] == 1 ? (double)sphere.light.rgb[3 * p + 1] : 0);
		check_between(most, 0.9, 1.1, environment_name(i));
		sphere_free(&sphere);
		environment_free(&light);
	}
	surface_free(&surface);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_density_of_light_samples_integrates_to_1),
		cmocka_unit_test(light_samples_follow_their_density),
		cmocka_unit_test(maps_lie_as_documented),
		cmocka_unit_test(what_is_no_map_is_refused),
		cmocka_unit_test(surfaces_reflect_as_their_model),
		cmocka_unit_test(surface_samples_follow_their_density),
		cmocka_unit_test(sampled_albedo_is_the_energy),
		cmocka_unit_test(a_white_sphere_in_white_light_is_white),
		cmocka_unit_test(estimators_agree_in_the_mean),
		cmocka_unit_test(the_same_bits_for_any_number_of_threads),
		cmocka_unit_test(a_point_light_follows_the_cosine),
		cmocka_unit_test(tables_are_interpolated),
		cmocka_unit_test(gaps_take_their_neighbours_value),
		cmocka_unit_test(formula_and_table_make_one_picture),
		cmocka_unit_test(tangents_point_to_the_right_and_up),
		cmocka_unit_test(errors_of_pictures),
		cmocka_unit_test(built_in_light_is_of_one_brightness),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
