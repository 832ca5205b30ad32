/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "data_readers/measurement.h"
#include "src/halfdiff.h"

static struct vec3 turned_about_z(struct vec3 v, double angle)
{
	const double c = cos(angle), s = sin(angle);
	return (struct vec3){c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

static void angles_and_directions_are_inverse(void **state)
{
	(void)state;
	for (double theta_h = 0.013; theta_h < M_PI_2; theta_h += 0.07) {
		for (double theta_d = 0.011; theta_d < M_PI_2; theta_d += 0.07) {
			for (double phi_d = 0.017; phi_d < 2.0 * M_PI; phi_d += 0.13) {
				struct vec3 wi, wo;
				halfdiff_to_dirs((struct halfdiff){theta_h, theta_d, phi_d}, &wi, &wo);
				check_abs(vec3_length(wi), 1.0, 4e-16, "length of wi");
				check_abs(vec3_length(wo), 1.0, 4e-16, "length of wo");
				const double product = cos(theta_h) * cos(theta_d);
				const double swing = sin(theta_h) * sin(theta_d) * cos(phi_d);
				check_abs(wi.z, product - swing, 3e-16, "cos_i");
				check_abs(wo.z, product + swing, 3e-16, "cos_o");
				for (double turn = 0.0; turn < 6.0; turn += 1.9) {
					const struct halfdiff back =
						halfdiff_from_dirs(turned_about_z(wi, turn), turned_about_z(wo, turn));
					/* The sum of the directions has length 2 cos(theta_d). */
					check_abs(back.theta_h, theta_h, 1e-15 / cos(theta_d), "theta_h");
					check_abs(back.theta_d, theta_d, 2e-15, "theta_d");
					/* phi_d is the angle between the planes of theta_h and theta_d. */
					const double sines = sin(theta_h) * sin(theta_d) * cos(theta_d);
					check_abs(back.phi_d, phi_d, 2e-15 / sines, "phi_d");
				}
			}
		}
	}
}

/* The light and the view change places: phi_d turns by pi, the rest stays. */
static void swapping_directions_turns_phi_d_by_pi(void **state)
{
	(void)state;
	struct vec3 wi, wo;
	halfdiff_to_dirs((struct halfdiff){0.7, 0.4, 1.1}, &wi, &wo);
	const struct halfdiff swapped = halfdiff_from_dirs(wo, wi);
	check_abs(swapped.theta_h, 0.7, 1e-15, "theta_h");
	check_abs(swapped.theta_d, 0.4, 1e-15, "theta_d");
	check_abs(swapped.phi_d, 1.1 + M_PI, 1e-15, "phi_d");
}

static void edges_give_their_limits(void **state)
{
	(void)state;
	struct vec3 wi, wo;
	const struct vec3 tilted = vec3_from_spherical_deg(37.0, 21.0);
	struct halfdiff a = halfdiff_from_dirs(tilted, tilted);
	check_abs(a.theta_h, 37.0 * M_PI / 180.0, 2e-16, "theta_h of equal directions");
	check_abs(a.theta_d, 0.0, 0.0, "theta_d of equal directions");
	check_abs(a.phi_d, 0.0, 0.0, "phi_d of equal directions");

	halfdiff_to_dirs((struct halfdiff){0.0, 0.0, 0.3}, &wi, &wo);
	check_abs(wi.z, 1.0, 0.0, "normal incidence");
	check_abs(wo.z, 1.0, 0.0, "normal incidence");

	a = halfdiff_from_dirs((struct vec3){1.0, 0.0, 0.0}, (struct vec3){-1.0, 0.0, 0.0});
	check_abs(a.theta_h, 0.0, 0.0, "theta_h of opposite directions");
	check_abs(a.theta_d, M_PI_2, 1e-16, "theta_d of opposite directions");

	/* Small angles are not lost in cosines close to 1. */
	halfdiff_to_dirs((struct halfdiff){1e-9, 2e-9, 0.8}, &wi, &wo);
	a = halfdiff_from_dirs(wi, wo);
	check_rel(a.theta_h, 1e-9, 1e-15, "small theta_h");
	check_rel(a.theta_d, 2e-9, 1e-15, "small theta_d");
	check_rel(a.phi_d, 0.8, 1e-15, "phi_d of small angles");

	/* Grazing mirror reflection: both directions 1e-9 above the horizon. */
	halfdiff_to_dirs((struct halfdiff){0.0, M_PI_2 - 1e-9, 0.0}, &wi, &wo);
	check_rel(wi.z, 1e-9, 1e-6, "cos_i at grazing incidence");
	check_rel(wo.z, 1e-9, 1e-6, "cos_o at grazing incidence");
	a = halfdiff_from_dirs(wi, wo);
	check_abs(a.theta_h, 0.0, 0.0, "theta_h at grazing incidence");
	check_rel(M_PI_2 - a.theta_d, 1e-9, 1e-6, "theta_d at grazing incidence");
}

/* Sine and cosine of exactly as many degrees as the double holds, to 20 digits. */
static void sincos_of_degrees_is_exact_to_the_last_bits(void **state)
{
	(void)state;
	static const struct {
		double deg, s, c;
	} rows[] = {
		{0.0, 0.0, 1.0},
		{30.0, 0.5, 0.86602540378443864676},
		{45.0, 0.70710678118654752440, 0.70710678118654752440},
		{60.0, 0.86602540378443864676, 0.5},
		{90.0, 1.0, 0.0},
		{120.0, 0.86602540378443864676, -0.5},
		{180.0, 0.0, -1.0},
		{225.0, -0.70710678118654752440, -0.70710678118654752440},
		{270.0, -1.0, 0.0},
		{300.0, -0.86602540378443864676, 0.5},
		{360.0, 0.0, 1.0},
		{1e-300, 1.7453292519943296207e-302, 1.0},
		{0.01, 0.00017453292431333680697, 0.99999998476912904933},
		{0.011111111111111112, 0.00019392547122831899464, 0.99999998119645562765},
		{0.17777777777777778, 0.0031028025804342175254, 0.99999518629648755463},
		{16.9, 0.29070219359825244259, 0.95681358405760740777},
		{44.9, 0.70587157067868097351, 0.70833983772452886863},
		{45.51111111111111, 0.71338635990191277007, 0.70077093369081639146},
		{61.03, 0.8748734329603796155, 0.48435160400283609942},
		{75.0, 0.96592582628906828675, 0.25881904510252076235},
		{89.0, 0.99984769515639123916, 0.017452406437283512819},
		{88.0111111111111, 0.99939757612834962925, 0.034705688709195892903},
		{89.999999, 0.99999999999999984769, 1.7453292475877967322e-8},
		{102.3, 0.97704557443526363481, -0.21303038627497652825},
		{179.5, 0.0087265354983739349649, -0.99996192306417128874},
		{203.7, -0.40194777665595997976, -0.91566259333956113812},
		{359.5, -0.0087265354983739349649, 0.99996192306417128874},
	};
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		double s, c;
		sincos_deg(rows[i].deg, &s, &c);
		check_rel(s, rows[i].s, 2.3e-16, "sine");
		check_rel(c, rows[i].c, 2.3e-16, "cosine");
		assert_false(signbit(s) && s == 0.0);
		assert_false(signbit(c) && c == 0.0);
		sincos_deg(-rows[i].deg, &s, &c);
		check_rel(s, -rows[i].s, 2.3e-16, "sine of the negative angle");
		check_rel(c, rows[i].c, 2.3e-16, "cosine of the negative angle");
	}
	double s, c;
	sincos_deg(NAN, &s, &c);
	assert_true(isnan(s) && isnan(c));
	sincos_deg(INFINITY, &s, &c);
	assert_true(isnan(s) && isnan(c));
}

static void spherical_directions_have_unit_length(void **state)
{
	(void)state;
	const struct vec3 up = vec3_from_spherical_deg(0.0, 77.0);
	assert_true(up.x == 0.0 && up.y == 0.0 && up.z == 1.0);
	const struct vec3 side = vec3_from_spherical_deg(90.0, 90.0);
	assert_true(side.x == 0.0 && side.y == 1.0 && side.z == 0.0);
	const struct vec3 down = vec3_from_spherical_deg(180.0, 10.0);
	assert_true(down.x == 0.0 && down.y == 0.0 && down.z == -1.0);
	for (double theta = 0.0; theta <= 180.0; theta += 1.37) {
		for (double phi = 0.0; phi < 360.0; phi += 7.9) {
			const struct vec3 v = vec3_from_spherical_deg(theta, phi);
			const double t = theta * M_PI / 180.0, p = phi * M_PI / 180.0;
			check_abs(v.x, sin(t) * cos(p), 2e-15, "x");
			check_abs(v.y, sin(t) * sin(p), 2e-15, "y");
			check_abs(v.z, cos(t), 1e-15, "z");
			check_abs(vec3_length(v), 1.0, 4e-16, "length");
		}
	}
	/* The slope x/z keeps one rounding, not two. (Closer to 90 degrees the radians are too coarse a reference.) */
	for (double theta = 0.37; theta < 89.0 && long_double_is_wide(); theta += 0.37) {
		const struct vec3 v = vec3_from_spherical_deg(theta, 0.0);
		const long double angle = theta * (3.14159265358979323846264338327950288L / 180.0L);
		const long double excess = v.x * cosl(angle) / (v.z * sinl(angle)) - 1.0L;
		check_abs((double)excess, 0.0, 1.25e-16, "slope");
	}
	assert_true(isnan(vec3_from_spherical_deg(NAN, 0.0).z));
	assert_true(isnan(vec3_from_spherical_deg(30.0, INFINITY).x));
}

static void indices_and_angles_of_entries_are_inverse(void **state)
{
	(void)state;
	for (enum bins bins = 0; bins < BINS_COUNT; bins++)
		for (int i = 0; i < 90; i++) {
			const struct bins_indices at = bins_indices(bins, bins_angles(bins, i, 89 - i, 3 * i));
			check_abs(at.i, i, 1e-12, "i");
			check_abs(at.j, 89 - i, 1e-12, "j");
			check_abs(at.k, 3 * i, 1e-12, "k");
			const double phi = bins_angles(bins, 0, 0, i).phi_d;
			const double mirrored = bins_angles(bins, 0, 0, bins_mirror(bins, i)).phi_d;
			check_abs(phi + mirrored, M_PI, 1e-14, "mirror");
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(angles_and_directions_are_inverse),
		cmocka_unit_test(swapping_directions_turns_phi_d_by_pi),
		cmocka_unit_test(edges_give_their_limits),
		cmocka_unit_test(sincos_of_degrees_is_exact_to_the_last_bits),
		cmocka_unit_test(spherical_directions_have_unit_length),
		cmocka_unit_test(indices_and_angles_of_entries_are_inverse),
	};
	return cmocka_run_group_tests_name("halfdiff", tests, NULL, NULL);
}
