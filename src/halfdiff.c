/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/halfdiff.h"

void halfdiff_trig_dirs(struct halfdiff_trig a, struct vec3 *wi, struct vec3 *wo)
{
	/* The light seen from the half vector; the view direction is its mirror image (-x, -y, z). */
	const double x = a.sin_d * a.cos_phi;
	const double y = a.sin_d * a.sin_phi;
	const double z = a.cos_d;

	*wi = (struct vec3){a.sin_h * z + a.cos_h * x, y, a.cos_h * z - a.sin_h * x};
	*wo = (struct vec3){a.sin_h * z - a.cos_h * x, -y, a.cos_h * z + a.sin_h * x};
}

void halfdiff_to_dirs(struct halfdiff a, struct vec3 *wi, struct vec3 *wo)
{
	const struct halfdiff_trig trig = {sin(a.theta_h), cos(a.theta_h), sin(a.theta_d),
					   cos(a.theta_d), sin(a.phi_d),   cos(a.phi_d)};

	halfdiff_trig_dirs(trig, wi, wo);
}

struct halfdiff halfdiff_from_dirs(struct vec3 wi, struct vec3 wo)
{
	const struct vec3 h = vec3_add(wi, wo);
	const struct vec3 d = vec3_sub(wi, wo);
	const double h_xy = hypot(h.x, h.y);
	const double cos_phi = h_xy > 0.0 ? h.x / h_xy : 1.0;
	const double sin_phi = h_xy > 0.0 ? h.y / h_xy : 0.0;
	const double theta_h = atan2(h_xy, h.z);
	/* d is perpendicular to h: turned by -phi_h about z and -theta_h about y it lies in the xy plane. */
	const double x = (d.x * cos_phi + d.y * sin_phi) * cos(theta_h) - d.z * sin(theta_h);
	const double y = d.y * cos_phi - d.x * sin_phi;
	const double phi_d = atan2(y, x);
	return (struct halfdiff){
		.theta_h = theta_h,
		.theta_d = atan2(vec3_length(d), vec3_length(h)),
		.phi_d = phi_d < 0.0 ? phi_d + 2.0 * M_PI : phi_d,
	};
}
