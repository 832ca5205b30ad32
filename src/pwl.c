/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/pwl.h"
#include <stdlib.h>

/* Gauss-Legendre abscissae and weights, the positive half. */
enum { FINE = 8, COARSE = 4 };
static const double fine_x[] = {0.1834346424956498049, 0.5255324099163289858, 0.7966664774136267396,
				0.9602898564975362317};
static const double fine_w[] = {0.3626837833783619830, 0.3137066458778872873, 0.2223810344533744706,
				0.1012285362903762592};
static const double coarse_x[] = {0.3399810435848562648, 0.8611363115940525752};
static const double coarse_w[] = {0.6521451548625461426, 0.3478548451374538574};

/* Longer segments are divided: on cells this short 8 points give all digits. */
#define CELL_MAX 0.13
/* Distance from E, in cells, from which the rules of 8 and of 4 points give all digits in spite of the square root
 * at E: errors (r + sqrt(r^2 - 1))^(-2 points), r = 1 + 2 distance. */
#define FINE_FROM 2.0
#define COARSE_FROM 16.0

static double abscissa(const double *x, int points, int i)
{
	return i < points / 2 ? -x[points / 2 - 1 - i] : x[i - points / 2];
}

static double weight(const double *w, int points, int i)
{
	return i < points / 2 ? w[points / 2 - 1 - i] : w[i - points / 2];
}

/* x - sin(x) */
static double minus_sin(double x)
{
	if (fabs(x) > 1.0)
		return x - sin(x);
	double sum = 0.0;
	for (int n = 17; n >= 3; n -= 2)
		sum = x * x / (n * (n - 1)) * (1.0 - sum);
	return x * sum;
}

/* int_0^t (F + slope v) cos(theta + v) sin(theta + v) dv, with all digits also for short t. */
static double cos_sin_integral(double theta, double F, double slope, double t)
{
	const double sin_t = sin(t), sin_2 = sin(2.0 * theta), cos_2 = cos(2.0 * theta);
	const double whole = 0.5 * sin_t * sin(2.0 * theta + t); /* of cos sin itself */
	const double inner = 0.25 * (0.5 * cos_2 * minus_sin(2.0 * t) + sin_2 * sin_t * sin_t);
	return F * whole + slope * (t * whole - inner);
}

/* int_0^t (F + slope v) sin^2(theta + v) dv */
static double sine2_integral(double theta, double F, double slope, double t)
{
	const double mean = F + 0.5 * slope * t, end = F + slope * t;
	return 0.5 * mean * t - 0.25 * (end * sin(2.0 * (theta + t)) - F * sin(2.0 * theta)) -
	       0.125 * slope * (cos(2.0 * (theta + t)) - cos(2.0 * theta));
}

static double node_mass_x(const struct pwl_node *node, double t)
{
	return 2.0 * M_PI * cos_sin_integral(node->theta, node->Fx, node->slope_x, t);
}

static double node_mass_y(const struct pwl_node *node, double t)
{
	return 2.0 * M_PI * cos_sin_integral(node->theta, node->Fy, node->slope_y, t);
}

static bool table_valid(int n, const double *D)
{
	bool positive = false;
	for (int i = 0; i < n; i++) {
		if (!(D[i] >= 0.0 && isfinite(D[i])))
			return false;
		positive = positive || D[i] > 0.0;
	}
	return positive;
}

static bool nodes_valid(int n, const double *theta)
{
	if (n < 2 || n > PWL_NODES_MAX || !theta || theta[0] != 0.0 || !(fabs(theta[n - 1] - M_PI_2) <= 1e-12))
		return false;
	for (int i = 1; i < n; i++) {
		if (!(theta[i] > theta[i - 1] && theta[i - 1] < M_PI_2))
			return false;
	}
	return true;
}

static int cells_of(double length)
{
	return (int)ceil(length / CELL_MAX);
}

static enum status allocate(struct pwl *pwl, int n_nodes, const double *theta)
{
	int n_cells = 0;
	for (int i = 1; i < n_nodes; i++)
		n_cells += cells_of(theta[i] - theta[i - 1]);
	*pwl = (struct pwl){.n_nodes = n_nodes, .n_cells = n_cells};
	const size_t cells = (size_t)n_cells;
	pwl->nodes = calloc((size_t)n_nodes, sizeof(*pwl->nodes));
	pwl->cells = calloc(cells + 1, sizeof(*pwl->cells));
	pwl->cell_node = calloc(cells, sizeof(*pwl->cell_node));
	pwl->fine = calloc(FINE * cells, sizeof(*pwl->fine));
	pwl->coarse = calloc(COARSE * cells, sizeof(*pwl->coarse));
	if (pwl->nodes && pwl->cells && pwl->cell_node && pwl->fine && pwl->coarse)
		return STATUS_OK;
	pwl_free(pwl);
	return STATUS_NO_MEMORY;
}

void pwl_free(struct pwl *pwl)
{
	free(pwl->nodes);
	free(pwl->cells);
	free(pwl->cell_node);
	free(pwl->fine);
	free(pwl->coarse);
	*pwl = (struct pwl){0};
}

/* Values divided by their largest, which keeps everything in range. */
static void fill_values(struct pwl *pwl, const double *theta, const double *Dx, const double *Dy)
{
	double max_x = 0.0, max_y = 0.0;
	for (int i = 0; i < pwl->n_nodes; i++) {
		max_x = fmax(max_x, Dx[i]);
		max_y = fmax(max_y, Dy[i]);
	}
	for (int i = 0; i < pwl->n_nodes; i++) {
		const bool last = i == pwl->n_nodes - 1;
		pwl->nodes[i].theta = last ? M_PI_2 : theta[i];
		pwl->nodes[i].Fx = Dx[i] / max_x;
		pwl->nodes[i].Fy = Dy[i] / max_y;
	}
}

static void fill_slopes(struct pwl *pwl)
{
	for (int i = 0; i + 1 < pwl->n_nodes; i++) {
		struct pwl_node *node = &pwl->nodes[i], *next = node + 1;
		const double length = next->theta - node->theta;
		node->slope_x = (next->Fx - node->Fx) / length;
		node->slope_y = (next->Fy - node->Fy) / length;
		next->mass_x = node->mass_x + node_mass_x(node, length);
		next->mass_y = node->mass_y + node_mass_y(node, length);
		next->sine2_x = node->sine2_x + sine2_integral(node->theta, node->Fx, node->slope_x, length);
		next->sine2_y = node->sine2_y + sine2_integral(node->theta, node->Fy, node->slope_y, length);
	}
}

/* Normalises Dx and Dy and works in the factors of Eq. 1. */
static bool scale_values(struct pwl *pwl)
{
	const struct pwl_node *last = &pwl->nodes[pwl->n_nodes - 1];
	const double c_x = last->mass_x, c_y = last->mass_y;
	if (!(c_x > 0.0 && c_y > 0.0))
		return false;
	const double Dx0 = pwl->nodes[0].Fx / c_x, Dy0 = pwl->nodes[0].Fy / c_y;
	const double c = 0.5 * (Dx0 + Dy0);
	const double by_x = (c > 0.0 ? Dy0 / c : 1.0) / c_x, by_y = (c > 0.0 ? Dx0 / c : 1.0) / c_y;
	pwl->blend = c > 0.0 ? 0.5 * (Dy0 - Dx0) / c : 0.0;
	for (int i = 0; i < pwl->n_nodes; i++) {
		struct pwl_node *node = &pwl->nodes[i];
		node->Fx *= by_x;
		node->Fy *= by_y;
		node->mass_x = node->mass_y = node->sine2_x = node->sine2_y = 0.0;
	}
	return true;
}

/* Fx and Fy in the segment above a node. */
struct values {
	double x, y;
};

/* A sum of positive terms: where D falls to a small fraction over the segment its digits stay. */
static struct values values_at(const struct pwl_node *node, double theta)
{
	const struct pwl_node *next = node + 1;
	const double length = next->theta - node->theta;
	const double up = (theta - node->theta) / length, down = (next->theta - theta) / length;
	return (struct values){node->Fx * down + next->Fx * up, node->Fy * down + next->Fy * up};
}

static struct pwl_point point_at(const struct pwl_node *node, double theta, double w)
{
	const struct values F = values_at(node, theta);
	const double s = sin(theta), c = cos(theta);
	return (struct pwl_point){c / s, w * s * s * (F.x + F.y), w * s * s * (F.x - F.y) / 3.0};
}

static void fill_cells(struct pwl *pwl)
{
	int cell = 0;
	for (int i = 0; i + 1 < pwl->n_nodes; i++) {
		const struct pwl_node *node = &pwl->nodes[i];
		const double length = node[1].theta - node->theta;
		const int parts = cells_of(length);
		for (int j = 0; j < parts; j++, cell++) {
			pwl->cells[cell] = node->theta + length * j / parts;
			pwl->cell_node[cell] = i;
		}
	}
	pwl->cells[cell] = M_PI_2;
	for (cell = 0; cell < pwl->n_cells; cell++) {
		const struct pwl_node *node = &pwl->nodes[pwl->cell_node[cell]];
		const double half = 0.5 * (pwl->cells[cell + 1] - pwl->cells[cell]), mid = pwl->cells[cell] + half;
		for (int i = 0; i < FINE; i++)
			pwl->fine[FINE * cell + i] =
				point_at(node, mid + half * abscissa(fine_x, FINE, i), half * weight(fine_w, FINE, i));
		for (int i = 0; i < COARSE; i++)
			pwl->coarse[COARSE * cell + i] = point_at(node, mid + half * abscissa(coarse_x, COARSE, i),
								  half * weight(coarse_w, COARSE, i));
	}
}

enum status pwl_init(struct pwl *pwl, int n_nodes, const double *theta, const double *Dx, const double *Dy)
{
	*pwl = (struct pwl){0};
	if (!Dy)
		Dy = Dx;
	if (!nodes_valid(n_nodes, theta) || !Dx || !table_valid(n_nodes, Dx) || !table_valid(n_nodes, Dy))
		return STATUS_DOMAIN;
	const enum status status = allocate(pwl, n_nodes, theta);
	if (status != STATUS_OK)
		return status;
	fill_values(pwl, theta, Dx, Dy);
	fill_slopes(pwl);
	if (!scale_values(pwl)) {
		pwl_free(pwl);
		return STATUS_DOMAIN;
	}
	fill_slopes(pwl);
	fill_cells(pwl);
	for (int i = 0; i < n_nodes; i++)
		pwl->anisotropic = pwl->anisotropic || pwl->nodes[i].Fx != pwl->nodes[i].Fy;
	return STATUS_OK;
}

/* The function along one axis. */
static void tabulate(int n_nodes, const double *theta, bool along_y, double (*D)(struct vec3 m, const void *context),
		     const void *context, double *values)
{
	for (int i = 0; i < n_nodes; i++) {
		const double s = sin(theta[i]), c = i == n_nodes - 1 ? 0.0 : cos(theta[i]);
		values[i] = D((struct vec3){along_y ? 0.0 : s, along_y ? s : 0.0, c}, context);
	}
	if (!isfinite(values[n_nodes - 1]))
		values[n_nodes - 1] = values[n_nodes - 2];
}

enum status pwl_from_function(struct pwl *pwl, int n_nodes, const double *theta,
			      double (*D)(struct vec3 m, const void *context), const void *context)
{
	*pwl = (struct pwl){0};
	if (!nodes_valid(n_nodes, theta))
		return STATUS_DOMAIN;
	double *values = calloc(2 * (size_t)n_nodes, sizeof(*values));
	if (!values)
		return STATUS_NO_MEMORY;
	tabulate(n_nodes, theta, false, D, context, values);
	tabulate(n_nodes, theta, true, D, context, values + n_nodes);
	const enum status status = pwl_init(pwl, n_nodes, theta, values, values + n_nodes);
	free(values);
	return status;
}

/* Just above the horizon, for the limit there; one that keeps growing is none. */
static double ndf_D_or_limit(struct vec3 m, const void *context)
{
	if (m.z > 0.0)
		return ndf_D(context, m);
	const double near = ndf_D(context, (struct vec3){m.x, m.y, 1e-30});
	const double nearer = ndf_D(context, (struct vec3){m.x, m.y, 1e-60});
	return nearer > 2.0 * near ? INFINITY : nearer;
}

enum status pwl_from_ndf(struct pwl *pwl, int n_nodes, const double *theta, const struct ndf *ndf)
{
	return pwl_from_function(pwl, n_nodes, theta, ndf_D_or_limit, ndf);
}

/* Index of the segment that contains theta: the last node, but one, that is not above it. */
static int find_node(const struct pwl *pwl, double theta)
{
	int low = 0, high = pwl->n_nodes - 1;
	while (high - low > 1) {
		const int mid = (low + high) / 2;
		if (pwl->nodes[mid].theta <= theta)
			low = mid;
		else
			high = mid;
	}
	return low;
}

double pwl_D(const struct pwl *pwl, struct vec3 m)
{
	if (m.z < 0.0)
		return 0.0;
	const double r2 = m.x * m.x + m.y * m.y;
	const double theta = atan2(sqrt(r2), m.z);
	const struct values F = values_at(&pwl->nodes[find_node(pwl, theta)], theta);
	return r2 > 0.0 ? (m.x * m.x * F.x + m.y * m.y * F.y) / r2 : F.x;
}

/* Direction o as the integrals need it. */
struct view {
	double cos_o, sin_o, cos_2phi;
	double E; /* pi/2 - theta_o */
};

static struct view view_of(struct vec3 o)
{
	const double r2 = o.x * o.x + o.y * o.y, r = sqrt(r2);
	const double cos_2phi = r2 > 0.0 ? (o.x - o.y) * (o.x + o.y) / r2 : 1.0;
	return (struct view){o.z, r, cos_2phi, atan2(o.z, r)};
}

/* Part of the integral over far cells: cos b = cot(theta_o) cot(theta) stays away from 1. */
static double tabled(const struct view *view, const struct pwl_point *points, int n)
{
	const double cot_o = view->cos_o / view->sin_o;
	double sum = 0.0;
	for (int i = 0; i < n; i++) {
		const double cos_b = cot_o * points[i].cot;
		const double sin2_b = (1.0 - cos_b) * (1.0 + cos_b), sin_b = sqrt(sin2_b);
		sum += points[i].sum * (sin_b - cos_b * acos(cos_b)) +
		       points[i].difference * view->cos_2phi * sin2_b * sin_b;
	}
	return sum;
}

/* The same for one angle, given b itself. */
static double integrand(const struct view *view, const struct pwl_node *node, double theta, double b, double w)
{
	const struct pwl_point point = point_at(node, theta, w);
	const double sin_b = sin(b);
	return point.sum * (sin_b - b * cos(b)) + point.difference * view->cos_2phi * sin_b * sin_b * sin_b;
}

/* b at theta >= E: 1 - cos b = sin(theta - E)/(sin(theta) sin(theta_o)). */
static double angle_b(const struct view *view, double theta, double above)
{
	return 2.0 * asin(fmin(sqrt(0.5 * sin(above) / (sin(theta) * view->sin_o)), 1.0));
}

/* Near E, theta_o <= 45 deg: b itself as the variable, theta = acot(tan(theta_o) cos b). */
static double panel_by_angle(const struct view *view, const struct pwl_node *node, double b_low, double b_high)
{
	const double tan_o = view->sin_o / view->cos_o;
	const double half = 0.5 * (b_high - b_low), mid = 0.5 * (b_high + b_low);
	double sum = 0.0;
	for (int i = 0; i < FINE; i++) {
		const double b = mid + half * abscissa(fine_x, FINE, i);
		const double cot = tan_o * cos(b);
		const double jacobian = tan_o * sin(b) / (1.0 + cot * cot);
		const double w = half * weight(fine_w, FINE, i) * jacobian;
		sum += integrand(view, node, M_PI_2 - atan(cot), b, w);
	}
	return sum;
}

static double near_by_angle(const struct view *view, const struct pwl_node *node, double low, double high)
{
	const double b_low = low > view->E ? angle_b(view, low, low - view->E) : 0.0;
	const double b_high = high < M_PI_2 ? angle_b(view, high, high - view->E) : M_PI_2;
	if (b_high - b_low < M_PI_4) /* 8 points give all digits of sin^4 b over an eighth of a turn */
		return panel_by_angle(view, node, b_low, b_high);
	const double middle = 0.5 * (b_low + b_high);
	return panel_by_angle(view, node, b_low, middle) + panel_by_angle(view, node, middle, b_high);
}

/* Near E, theta_o > 45 deg: theta = E + s^2. */
static double near_by_root(const struct view *view, const struct pwl_node *node, double low, double high)
{
	const double s_low = sqrt(low - view->E), s_high = sqrt(high - view->E);
	const double half = 0.5 * (s_high - s_low), mid = 0.5 * (s_high + s_low);
	double sum = 0.0;
	for (int i = 0; i < FINE; i++) {
		const double s = mid + half * abscissa(fine_x, FINE, i);
		const double theta = view->E + s * s;
		const double w = half * weight(fine_w, FINE, i) * 2.0 * s;
		sum += integrand(view, node, theta, angle_b(view, theta, s * s), w);
	}
	return sum;
}

static double cell_integral(const struct pwl *pwl, const struct view *view, int cell)
{
	const double low = pwl->cells[cell], high = pwl->cells[cell + 1];
	const double distance = (low - view->E) / (high - low);
	if (distance >= COARSE_FROM)
		return tabled(view, &pwl->coarse[COARSE * cell], COARSE);
	if (distance >= FINE_FROM)
		return tabled(view, &pwl->fine[FINE * cell], FINE);
	const struct pwl_node *node = &pwl->nodes[pwl->cell_node[cell]];
	const double start = fmax(low, view->E);
	return view->sin_o <= view->cos_o ? near_by_angle(view, node, start, high)
					  : near_by_root(view, node, start, high);
}

double pwl_lambda(const struct pwl *pwl, struct vec3 o)
{
	if (o.z <= 0.0)
		return INFINITY;
	const struct view view = view_of(o);
	if (view.sin_o == 0.0)
		return 0.0;
	double sum = 0.0;
	for (int cell = pwl->n_cells - 1; cell >= 0 && !(pwl->cells[cell + 1] <= view.E); cell--)
		sum += cell_integral(pwl, &view, cell);
	return view.sin_o / view.cos_o * sum;
}

double pwl_G1(const struct pwl *pwl, struct vec3 o)
{
	return 1.0 / (1.0 + pwl_lambda(pwl, o));
}

/* Facets towards o, and those beside it that are still seen whole, in closed form; the rest by trapezoids over
 * [E, theta_{k+1}] and the segments above. */
static double trapezoid_part(const struct view *view, const struct pwl_node *node, double theta)
{
	const struct values F = values_at(node, theta);
	const double s = sin(theta), c = cos(theta);
	const double cot = theta == M_PI_2 ? 0.0 : c / s; /* C is pi at E and pi/2 at the horizon, exactly */
	const double C = theta == view->E ? M_PI : acos(fmax(-view->cos_o / view->sin_o * cot, -1.0));
	const double turn = view->cos_2phi * (cos(2.0 * C) - 2.0 * sin(C)), wing = 0.5 * sin(2.0 * C) * view->cos_2phi;
	const double part1 = s * s * (sin(C) - 1.0) * (F.x * (3.0 + turn) + F.y * (3.0 - turn));
	const double part2 = c * s * (F.x * (C + wing) + F.y * (C - wing));
	return view->sin_o / 3.0 * part1 + view->cos_o * part2;
}

static double trapezoids(const struct pwl *pwl, const struct view *view, int k)
{
	double low = view->E, sum = 0.0;
	for (int i = k; i + 1 < pwl->n_nodes; i++) {
		const struct pwl_node *node = &pwl->nodes[i];
		const double high = node[1].theta;
		sum += 0.5 * (high - low) * (trapezoid_part(view, node, low) + trapezoid_part(view, node, high));
		low = high;
	}
	return sum;
}

double pwl_G1_trapezoid(const struct pwl *pwl, struct vec3 o)
{
	if (o.z <= 0.0)
		return 0.0;
	const struct view view = view_of(o);
	if (view.sin_o == 0.0)
		return 1.0;
	const int k = find_node(pwl, view.E);
	const struct pwl_node *node = &pwl->nodes[k], *last = &pwl->nodes[pwl->n_nodes - 1];
	const double t = view.E - node->theta;
	const double above_x = last->sine2_x - node->sine2_x - sine2_integral(node->theta, node->Fx, node->slope_x, t);
	const double above_y = last->sine2_y - node->sine2_y - sine2_integral(node->theta, node->Fy, node->slope_y, t);
	const double below = node->mass_x + node->mass_y + node_mass_x(node, t) + node_mass_y(node, t);
	const double above = last->mass_x + last->mass_y - below;
	const double sides = view.sin_o / 3.0 * (above_x * (3.0 + view.cos_2phi) + above_y * (3.0 - view.cos_2phi));
	const double seen = sides + 0.5 * view.cos_o + 0.25 * view.cos_o * (below - above) + trapezoids(pwl, &view, k);
	return view.cos_o / seen;
}

/* x - e sin(x) = M in [0, pi], 0 <= e <= 1: Kepler's equation. Convex, so Newton from above comes down steadily. */
static double kepler(double e, double M)
{
	double x = M < M_PI * (1.0 - e) ? M / (1.0 - e) : M_PI;
	if (e > 0.01)
		x = fmin(x, 1.3 * cbrt(6.0 * M / e));
	for (int i = 0; i < 100; i++) {
		const double half = sin(0.5 * x);
		const double f = (1.0 - e) * x + e * minus_sin(x) - M;
		const double step = f / ((1.0 - e) + 2.0 * e * half * half);
		if (!(step > 1e-16 * x))
			break;
		x -= step;
	}
	return x;
}

/* 2 phi + blend sin(2 phi) = 4 pi u, in the quadrant of u; odd quadrants are mirror images of even ones. */
static double sample_phi(const struct pwl *pwl, double u)
{
	const double quadrant = floor(4.0 * u), v = 4.0 * u - quadrant;
	const bool mirrored = fmod(quadrant, 2.0) == 1.0;
	const double M = M_PI * (mirrored ? 1.0 - v : v);
	const double x = pwl->blend < 0.0 ? kepler(-pwl->blend, M) : M_PI - kepler(pwl->blend, M_PI - M);
	return M_PI_2 * quadrant + (mirrored ? M_PI_2 - 0.5 * x : 0.5 * x);
}

/* The blend of the two axes at one phi. */
struct blend {
	double x, y;
};

static double blend_mass(const struct blend *blend, const struct pwl_node *node)
{
	return blend->x * node->mass_x + blend->y * node->mass_y;
}

static struct blend blend_at(const struct pwl *pwl, double phi)
{
	const struct blend blend = {cos(phi) * cos(phi), sin(phi) * sin(phi)};
	const bool empty = !(blend_mass(&blend, &pwl->nodes[pwl->n_nodes - 1]) > 0.0);
	return empty ? (struct blend){1.0, 1.0} : blend; /* phi at which nothing is, hit by rounding */
}

/* Last segment that begins at or below this mass and is not empty. */
static int find_mass(const struct pwl *pwl, const struct blend *blend, double mass)
{
	int low = 0, high = pwl->n_nodes - 1;
	while (high - low > 1) {
		const int mid = (low + high) / 2;
		if (blend_mass(blend, &pwl->nodes[mid]) <= mass)
			low = mid;
		else
			high = mid;
	}
	while (low > 0 && blend_mass(blend, &pwl->nodes[low + 1]) <= blend_mass(blend, &pwl->nodes[low]))
		low--;
	return low;
}

/* t in [0, length] with int_0^t (F + slope v) cos sin dv = part of the whole, Newton inside a bracket; starts as if the
 * density were linear. */
static double solve_segment(double theta, double length, double F, double slope, double part)
{
	const double target = part * cos_sin_integral(theta, F, slope, length);
	const double p0 = 0.5 * F * sin(2.0 * theta), p1 = 0.5 * (F + slope * length) * sin(2.0 * (theta + length));
	const double goal = part * (p0 + p1);
	double low = 0.0, high = length;
	if (!(target > 0.0))
		return 0.0;
	const double below = p0 + sqrt(fmax(p0 * p0 + (p1 - p0) * goal, 0.0));
	double t = below > 0.0 ? length * goal / below : 0.5 * length;
	for (int i = 0; i < 100; i++) {
		if (!(t >= low && t <= high))
			t = 0.5 * (low + high);
		const double f = cos_sin_integral(theta, F, slope, t) - target;
		if (f > 0.0)
			high = t;
		else
			low = t;
		const double density = 0.5 * (F + slope * t) * sin(2.0 * (theta + t));
		const double step = density > 0.0 ? f / density : INFINITY;
		if (fabs(step) <= 1e-15 * length || high - low <= 1e-16 * length)
			break;
		t -= step;
	}
	return t;
}

static double sample_theta(const struct pwl *pwl, double phi, double u)
{
	const struct blend blend = blend_at(pwl, phi);
	const double mass = u * blend_mass(&blend, &pwl->nodes[pwl->n_nodes - 1]);
	const struct pwl_node *node = &pwl->nodes[find_mass(pwl, &blend, mass)];
	const double start = blend_mass(&blend, node);
	const double part = (mass - start) / (blend_mass(&blend, node + 1) - start);
	const double F = blend.x * node->Fx + blend.y * node->Fy;
	const double slope = blend.x * node->slope_x + blend.y * node->slope_y;
	return node->theta + solve_segment(node->theta, node[1].theta - node->theta, F, slope, part);
}

struct vec3 pwl_sample(const struct pwl *pwl, double u1, double u2)
{
	const double phi = sample_phi(pwl, u1);
	const double theta = sample_theta(pwl, phi, u2);
	return (struct vec3){sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
}

double pwl_cdf_phi(const struct pwl *pwl, double phi)
{
	return (2.0 * phi + pwl->blend * sin(2.0 * phi)) / (4.0 * M_PI);
}

double pwl_cdf_theta(const struct pwl *pwl, double theta, double phi)
{
	const struct blend blend = blend_at(pwl, phi);
	const struct pwl_node *node = &pwl->nodes[find_node(pwl, theta)];
	const double t = theta - node->theta;
	const double mass = blend_mass(&blend, node) + blend.x * node_mass_x(node, t) + blend.y * node_mass_y(node, t);
	return fmin(fmax(mass / blend_mass(&blend, &pwl->nodes[pwl->n_nodes - 1]), 0.0), 1.0);
}
