/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/vec3.h"

/* Sine and cosine of deg, |deg| finite, in the precision of long double. Reduced to 0..45 degrees before pi comes in:
 * the reduction is exact, and near 90 degrees the cosine keeps its digits. */
static void sincos_deg_long(double deg, long double *s, long double *c)
{
	const double r = fmod(fabs(deg), 90.0);
	const int quadrant = (int)fmod((fabs(deg) - r) / 90.0, 4.0);
	const int complement = r > 45.0;
	const long double angle = (complement ? 90.0 - r : r) * (3.14159265358979323846264338327950288L / 180.0L);
	const long double sin_r = complement ? cosl(angle) : sinl(angle);
	const long double cos_r = complement ? sinl(angle) : cosl(angle);
	const long double cycle[] = {sin_r, cos_r, -sin_r, -cos_r, sin_r};
	*s = deg < 0.0 ? -cycle[quadrant] : cycle[quadrant];
	*c = cycle[quadrant + 1];
}

void sincos_deg(double deg, double *s, double *c)
{
	long double sine = NAN, cosine = NAN;
	if (isfinite(deg))
		sincos_deg_long(deg, &sine, &cosine);
	*s = (double)sine + 0.0; /* no negative zeros */
	*c = (double)cosine + 0.0;
}

struct vec3 vec3_from_spherical_deg(double theta_deg, double phi_deg)
{
	if (!isfinite(theta_deg) || !isfinite(phi_deg))
		return (struct vec3){NAN, NAN, NAN};
	long double sin_theta, cos_theta, sin_phi, cos_phi;
	sincos_deg_long(theta_deg, &sin_theta, &cos_theta);
	sincos_deg_long(phi_deg, &sin_phi, &cos_phi);
	const double z = (double)cos_theta + 0.0;
	/* Follow the rounding of z, so that x/z and y/z suffer one rounding instead of two. */
	const long double r = cos_theta != 0.0L ? sin_theta * (z / cos_theta) : sin_theta;
	return (struct vec3){(double)(r * cos_phi) + 0.0, (double)(r * sin_phi) + 0.0, z};
}
