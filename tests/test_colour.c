/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sRGB, CIELAB, CIEDE2000, SSIM and the false colours, against published values and by their properties. */
#include "chi_square.h"
#include "fit/render/colour.h"
#include "fit/render/ssim.h"

static void srgb_is_the_standards(void **state)
{
	(void)state;
	/* The standard's formula by hand, and values that tables of sRGB give for 8 bits. */
	check_abs(srgb_encode(0.0031308), 0.0031308 * 12.92, 1e-15, "end of the straight piece");
	check_abs(srgb_decode(128.0 / 255.0), 0.21586050011389926, 1e-15, "128");
	check_abs(srgb_decode(10.0 / 255.0), 0.0030352698354883752, 1e-15, "10");
	check_abs(srgb_encode(0.5), 0.73535698305244300, 1e-14, "half");
	check_abs(srgb_encode(0.18), 0.46135612950044164, 1e-14, "middle grey");
	for (int i = 0; i <= 255; i++)
		check_abs(srgb_encode(srgb_decode(i / 255.0)), i / 255.0, 5e-8, "there and back");
	/* The pieces join to what the header says. */
	check_abs(srgb_encode(nextafter(0.0031308, 1)), srgb_encode(0.0031308), 3e-8, "join");
	assert_true(srgb_encode(-1) == 0 && srgb_encode(2) == 1 && srgb_encode(NAN) == 0);
	assert_true(srgb_decode(-1) == 0 && srgb_decode(2) == 1 && srgb_decode(NAN) == 0);
}

static void lab_of_known_colours(void **state)
{
	(void)state;
	/* sRGB's primaries in CIELAB under D65, as colour tables give them (two decimals, from
	 * matrices of more digits than the standard's four). */
	static const struct {
		double rgb[3], lab[3];
	} known[] = {
		{{1, 0, 0}, {53.24, 80.09, 67.20}},      {{0, 1, 0}, {87.73, -86.18, 83.18}},
		{{0, 0, 1}, {32.30, 79.19, -107.86}},    {{1, 1, 0}, {97.14, -21.55, 94.48}},
		{{0, 1, 1}, {91.11, -48.09, -14.13}},    {{1, 0, 1}, {60.32, 98.23, -60.82}},
		{{0.18, 0.18, 0.18}, {49.50, 0.0, 0.0}}, {{0, 0, 0}, {0, 0, 0}},
	};
	double lab[3];
	for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
		colour_lab(known[i].rgb, lab);
		for (int c = 0; c < 3; c++)
			check_abs(lab[c], known[i].lab[c], 0.05, "lab");
	}
	colour_lab((const double[]){1, 1, 1}, lab);
	check_abs(lab[0], 100, 1e-12, "white L");
	check_abs(lab[1], 0, 1e-12, "white a");
	check_abs(lab[2], 0, 1e-12, "white b");
	check_abs(colour_luminance((const double[]){1, 1, 1}), 1, 1e-12, "white Y");
	/* The cube root and its tangent meet. */
	double below[3], above[3];
	const double join = pow(6.0 / 29.0, 3);
	colour_lab((const double[]){join * (1 - 1e-9), join, join}, below);
	colour_lab((const double[]){join * (1 + 1e-9), join, join}, above);
	for (int c = 0; c < 3; c++)
		check_abs(below[c], above[c], 1e-6, "join");
}

static void ciede2000_of_the_published_pairs(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/ciede2000.csv", "L1,a1,b1,L2,a2,b2,delta_e");
	while (golden_next(&golden)) {
		const double *p = golden.value, *q = golden.value + 3;
		check_abs(delta_e_2000(p, q), golden.value[6], 5e-5, golden.label);
		check_abs(delta_e_2000(q, p), delta_e_2000(p, q), 1e-12, golden.label);
		assert_true(delta_e_2000(p, p) == 0);
	}
	assert_int_equal(golden.rows, 34);
}

static void false_colours_rise_in_lightness(void **state)
{
	(void)state;
	for (int i = 0; i <= 200; i++) {
		double rgb[3], lab[3];
		false_colour(i / 200.0, rgb);
		colour_lab(rgb, lab);
		check_abs(lab[0], 5 + 90 * i / 200.0, 1e-9, "lightness");
		for (int c = 0; c < 3; c++)
			check_between(rgb[c], 0, 1, "component");
	}
	double low[3], high[3], rgb[3];
	false_colour(0, low);
	false_colour(1, high);
	false_colour(NAN, rgb);
	assert_memory_equal(rgb, low, sizeof rgb);
	false_colour(-3, rgb);
	assert_memory_equal(rgb, low, sizeof rgb);
	false_colour(INFINITY, rgb);
	assert_memory_equal(rgb, high, sizeof rgb);
}

enum { WIDTH = 24, HEIGHT = 17, N = WIDTH * HEIGHT };

static void fill(double x[N], double amplitude, uint64_t seed)
{
	for (int i = 0; i < N; i++)
		x[i] = 0.5 + amplitude * (uniform(&seed) - 0.5);
}

static void ssim_of_simple_pictures(void **state)
{
	(void)state;
	double x[N], y[N];
	bool inside[N];
	for (int i = 0; i < N; i++)
		inside[i] = true;
	fill(x, 0.6, 1);
	assert_true(ssim(x, x, inside, WIDTH, HEIGHT) == 1);
	/* Of two flat pictures only the first factor is left. */
	for (int i = 0; i < N; i++) {
		x[i] = 0.25;
		y[i] = 0.5;
	}
	const double c1 = 1e-4;
	check_rel(ssim(x, y, inside, WIDTH, HEIGHT), (2 * 0.125 + c1) / (0.0625 + 0.25 + c1), 1e-10, "flat");
	/* A picture and its negative around the same mean differ in structure. */
	fill(x, 0.6, 1);
	for (int i = 0; i < N; i++)
		y[i] = 1 - x[i];
	check_between(ssim(x, y, inside, WIDTH, HEIGHT), -1, -0.8, "negative");
	/* Noise costs the more, the stronger it is. */
	double last = 1;
	for (int k = 1; k <= 4; k++) {
		double noise[N];
		fill(noise, 0.15 * k, 7);
		for (int i = 0; i < N; i++)
			y[i] = x[i] + noise[i] - 0.5;
		const double value = ssim(x, y, inside, WIDTH, HEIGHT);
		check_between(value, 0, last - 0.01, "noise");
		last = value;
	}
}

/* One window by hand, from the definition. */
static void ssim_of_one_pixel(void **state)
{
	(void)state;
	double x[N], y[N];
	bool inside[N] = {false};
	const int at_x = 3, at_y = 14; /* the window is cut by two edges */
	fill(x, 0.7, 3);
	fill(y, 0.5, 4);
	inside[at_x + WIDTH * at_y] = true;
	double w = 0, mx = 0, my = 0, sxx = 0, syy = 0, sxy = 0;
	for (int pass = 0; pass < 2; pass++) {
		for (int r = 0; r < HEIGHT; r++)
			for (int c = 0; c < WIDTH; c++) {
				if (abs(r - at_y) > 5 || abs(c - at_x) > 5)
					continue;
				const double g = exp(-((r - at_y) * (r - at_y) + (c - at_x) * (c - at_x)) / 4.5);
				const double p = x[c + WIDTH * r], q = y[c + WIDTH * r];
				if (pass == 0) {
					w += g;
					mx += g * p;
					my += g * q;
				} else {
					sxx += g * (p - mx) * (p - mx) / w;
					syy += g * (q - my) * (q - my) / w;
					sxy += g * (p - mx) * (q - my) / w;
				}
			}
		if (pass == 0) {
			mx /= w;
			my /= w;
		}
	}
	const double c1 = 1e-4, c2 = 9e-4;
	const double want = (2 * mx * my + c1) * (2 * sxy + c2) / ((mx * mx + my * my + c1) * (sxx + syy + c2));
	check_rel(ssim(x, y, inside, WIDTH, HEIGHT), want, 1e-11, "one window");
	inside[at_x + WIDTH * at_y] = false;
	assert_true(isnan(ssim(x, y, inside, WIDTH, HEIGHT)));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(srgb_is_the_standards),
		cmocka_unit_test(lab_of_known_colours),
		cmocka_unit_test(ciede2000_of_the_published_pairs),
		cmocka_unit_test(false_colours_rise_in_lightness),
		cmocka_unit_test(ssim_of_simple_pictures),
		cmocka_unit_test(ssim_of_one_pixel),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
