/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A distribution with turned axes is the one without, seen from directions turned the other way. */
#include "check.h"
#include "src/ndf_slopes.h"
#include "src/vndf.h"

static struct vec3 about_normal(struct vec3 v, double degrees)
{
	const double a = degrees * M_PI / 180;
	return (struct vec3){cos(a) * v.x - sin(a) * v.y, sin(a) * v.x + cos(a) * v.y, v.z};
}

static void close_to(struct vec3 a, struct vec3 b, const char *label)
{
	check_abs(a.x, b.x, 1e-13, label);
	check_abs(a.y, b.y, 1e-13, label);
	check_abs(a.z, b.z, 1e-13, label);
}

static void turned_axes(void **state)
{
	static const struct {
		const char *name;
		double gamma;
	} of[] = {{"std", 2.5}, {"ggx", NAN}, {"beckmann", NAN}, {"hyper-cauchy", 1.8}, {"t-family", 3}};
	const double degrees[] = {20, -75, 90, 45};
	(void)state;
	for (size_t n = 0; n < sizeof of / sizeof *of; n++)
		for (size_t d = 0; d < sizeof degrees / sizeof *degrees; d++)
			for (double theta = 5; theta < 90; theta += 20)
				for (double phi = 0; phi < 360; phi += 35) {
					struct ndf plain, turned;
					struct vndf_pseudo pseudo, pseudo_turned;
					assert_int_equal(ndf_init(&plain, ndf_find(of[n].name), 0.3, 0.1, of[n].gamma),
							 STATUS_OK);
					turned = plain;
					assert_int_equal(ndf_turn(&turned, degrees[d]), STATUS_OK);
					const struct vec3 v = vec3_from_spherical_deg(theta, phi),
							  w = about_normal(v, -degrees[d]);
					check_rel(ndf_D(&turned, v), ndf_D(&plain, w), 1e-11, of[n].name);
					check_rel(ndf_G1(&turned, v), ndf_G1(&plain, w), 1e-12, of[n].name);
					check_rel(ndf_P2(&turned, phi * M_PI / 180, 0.4),
						  ndf_P2(&plain, (phi - degrees[d]) * M_PI / 180, 0.4), 1e-12,
						  of[n].name);
					close_to(ndf_sample(&turned, phi / 360, theta / 90),
						 about_normal(ndf_sample(&plain, phi / 360, theta / 90), degrees[d]),
						 of[n].name);
					close_to(
						vndf_sample(&turned, v, phi / 360, theta / 90),
						about_normal(vndf_sample(&plain, w, phi / 360, theta / 90), degrees[d]),
						of[n].name);
					assert_int_equal(vndf_pseudo_init(&pseudo, &plain), STATUS_OK);
					assert_int_equal(vndf_pseudo_init(&pseudo_turned, &turned), STATUS_OK);
					check_rel(vndf_pseudo_pdf(&pseudo_turned, v, vec3_from_spherical_deg(10, 0)),
						  vndf_pseudo_pdf(
							  &pseudo, w,
							  about_normal(vec3_from_spherical_deg(10, 0), -degrees[d])),
						  1e-11, of[n].name);
				}
}

static void the_angle_of_an_axis(void **state)
{
	static const double in[] = {0, 20, 90, -90, 110, 180, 250, -200}, out[] = {0, 20, 90, 90, -70, 0, 70, -20};
	struct ndf ndf;
	(void)state;
	assert_int_equal(ndf_init(&ndf, ndf_find("ggx"), 0.3, 0.1, NAN), STATUS_OK);
	for (size_t n = 0; n < sizeof in / sizeof *in; n++) {
		assert_int_equal(ndf_turn(&ndf, in[n]), STATUS_OK);
		assert_true(ndf.angle == out[n]);
	}
	assert_int_equal(ndf_turn(&ndf, NAN), STATUS_DOMAIN);
	assert_int_equal(ndf_turn(&ndf, INFINITY), STATUS_DOMAIN);
	assert_true(ndf.angle == -20);
	/* Along the axes nothing is rounded. */
	const struct vec3 x = {0.6, 0, 0.8}, y = {0, 0.6, 0.8};
	struct ndf turned = ndf;
	assert_int_equal(ndf_turn(&ndf, 0), STATUS_OK);
	assert_int_equal(ndf_turn(&turned, 90), STATUS_OK);
	assert_true(ndf_D(&turned, y) == ndf_D(&ndf, x) && ndf_D(&turned, x) == ndf_D(&ndf, y));
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(turned_axes), cmocka_unit_test(the_angle_of_an_axis)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
