/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ellipsoid NDF [Walter et al. 2014] as one of the distributions. Normals of the ellipsoid |A p| = 1 are along A^T s, s on
 * the unit sphere, and A may be turned from the left until its last column is (0, 0, g). Then m.x/m.z and m.y/m.z are those of
 * anisotropic GGX moved by the last row over g, the tilt t: with m' = (m.x - t.x m.z, m.y - t.y m.z, m.z), for which
 * w.m = w'.m' where w' = (w.x, w.y, w.z + t.w),
 *     D(m) = D_ggx(m'),   int max(0, w.m) D dm = that of GGX for w',
 * D_ggx being homogeneous of degree -4. Neither m' nor w' is of length 1, and w' may lie below the horizon. */
#include "src/ellipsoid.h"
#include "src/ndf_class.h"
#include "src/ndf_formulas.h"

static double ellipsoid_ndf_D(const struct ndf *ndf, struct vec3 m)
{
	return ggx_D(ndf, ndf_untilted_normal(ndf, m));
}

/* int max(0, w.m) D dm less w.z, a sum of what it is without tilt for the level direction and the change of that */
static double ellipsoid_ndf_lambda(const struct ndf *ndf, struct vec3 w)
{
	const double z = ndf_untilted_direction(ndf, w).z, r = ndf_r(ndf, w);
	const double length = sqrt(z * z + r * r);
	const double hidden = 0.5 * (z > 0.0 ? r * (r / (length + z)) : length - z);
	const double lambda = (hidden + (z - w.z)) / w.z;
	return lambda < 0.0 ? 0.0 : lambda;
}

static double ellipsoid_ndf_area(const struct ndf *ndf, struct vec3 w)
{
	const double z = ndf_untilted_direction(ndf, w).z, r = ndf_r(ndf, w);
	const double length = sqrt(z * z + r * r);
	return 0.5 * (z < 0.0 ? r * (r / (length - z)) : length + z);
}

static double ellipsoid_ndf_P2(const struct ndf *ndf, double phi, double q)
{
	const double c = cos(phi), s = sin(phi);
	return ggx_P2(ndf, hypot(ndf->sigma_x * c, ndf->sigma_y * s), q + ndf->lean_x * c + ndf->lean_y * s);
}

const struct ndf_class ndf_class_ellipsoid = {
	.name = "ellipsoid",
	.n_params = 1,
	.param = {NDF_PARAM_SIGMA},
	.gamma = 2.0,
	.ggx_at_2 = true,
	.tilts = true,
	.D = ellipsoid_ndf_D,
	.lambda = ellipsoid_ndf_lambda,
	.area = ellipsoid_ndf_area,
	.P2_along = ellipsoid_ndf_P2,
	.tilt = ggx_tilt,
	.share = ggx_share,
};

/* The rotation, degrees in [-45, 45], after which x.x y.y is least and x.y = 0. */
static double axes_of(struct vec3 x, struct vec3 y)
{
	const double both = vec3_dot(x, y), difference = vec3_dot(vec3_sub(x, y), vec3_add(x, y));
	if (difference == 0.0)
		return both == 0.0 ? 0.0 : copysign(45.0, both);
	return 0.5 * atan(2.0 * both / difference) * (180.0 / M_PI);
}

enum status ndf_from_ellipsoid(struct ndf *ndf, const struct ellipsoid *ellipsoid)
{
	const struct vec3 *A = ellipsoid->A, An = vec3_scale(ellipsoid->An, 1.0 / ellipsoid->length_An);
	struct vec3 x = {A[0].x, A[1].x, A[2].x}, y = {A[0].y, A[1].y, A[2].y};
	const double along_x = vec3_dot(x, An), along_y = vec3_dot(y, An);
	x = vec3_sub(x, vec3_scale(An, along_x));
	y = vec3_sub(y, vec3_scale(An, along_y));
	const double angle = axes_of(x, y), c = cos(angle * (M_PI / 180.0)), s = sin(angle * (M_PI / 180.0));
	const double sigma_x = vec3_length(vec3_add(vec3_scale(x, c), vec3_scale(y, s))) / ellipsoid->length_An;
	const double sigma_y = vec3_length(vec3_sub(vec3_scale(y, c), vec3_scale(x, s))) / ellipsoid->length_An;
	struct ndf made;
	enum status status = ndf_init(&made, &ndf_class_ellipsoid, sigma_x, sigma_y, NAN);
	if (status == STATUS_OK)
		status = ndf_turn(&made, angle);
	if (status == STATUS_OK)
		status = ndf_tilt(&made, along_x / ellipsoid->length_An, along_y / ellipsoid->length_An);
	if (status == STATUS_OK)
		*ndf = made;
	return status;
}
