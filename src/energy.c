/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The integral runs over the half vector h, at the slope tan(theta_h) = exp(v) and the azimuth phi from the plane of
 * incidence: d wo = 4 (wi.h) dh, and D, the only sharp factor, depends on v alone, with about the same width for all
 * sigma. wo lies above the horizon where sin_i sin(2 theta_h) cos(phi) + cos_i cos(2 theta_h) > 0. */
#include "src/energy.h"
#include "src/energy_axes.h"
#include "src/quadrature.h"
#include "src/smith_table.h"

/* exp(v) down to exp(-18) of the median slope: 1e-15 of the normals lie below. */
#define V_BELOW 18.0
/* At this cosine, in units of the median slope, all is as at grazing incidence. */
#define GRAZING 1e-20
/* Aimed at for one direction; where many are compared. */
#define TOLERANCE 1e-8
#define TOLERANCE_MANY 3e-6

enum { REFINEMENTS = 8 };

struct ring {
	const struct cook_torrance *model;
	const struct ndf *ndf; /* of one of its lobes */
	int channel;           /* whose F it is */
	struct smith_table *G1;
	double tolerance; /* absolute, of the outer integral; the inner ones have a share of it */
	struct vec3 wi;
	double lambda_i;
	double sin_h, cos_h;
	double front; /* what all azimuths have in common: D/cos_i dh/(dv dphi), dh = sin_h^2 cos_h dv dphi */
};

/* G of a facet from cos_d and cos_o. */
static double G_at(const struct ring *ring, double cos_d, struct vec3 wo)
{
	const enum gaf gaf = ring->model->gaf;
	if (gaf == GAF_V_GROOVE)
		return fmin(1.0, 2.0 * ring->cos_h * fmin(ring->wi.z, wo.z) / cos_d);
	return gaf_smith(gaf, ring->lambda_i, 1.0 / smith_table_G1(ring->G1, wo) - 1.0);
}

/* f cos_o d wo / (dv dphi) = F G (wi.h) D/cos_i dh/(dv dphi) */
static double at_azimuth(double phi, void *params)
{
	const struct ring *ring = params;
	const struct vec3 h = {ring->sin_h * cos(phi), ring->sin_h * sin(phi), ring->cos_h};
	const double cos_d = vec3_dot(ring->wi, h);
	const struct vec3 wo = vec3_sub(vec3_scale(h, 2.0 * cos_d), ring->wi);
	if (!(wo.z > 0.0))
		return 0.0;
	return cook_torrance_F(ring->model, ring->channel, cos_d) * G_at(ring, cos_d, wo) * cos_d * ring->front;
}

/* The azimuth at which wi.h is cos_d, as a bound of [0, end]. */
static double azimuth_of(const struct ring *ring, double cos_d, double end)
{
	const double part = (cos_d - ring->wi.z * ring->cos_h) / (ring->wi.x * ring->sin_h);
	return part < 1.0 ? fmin(acos(fmax(part, -1.0)), end) : 0.0;
}

/* Over [0, end]; where the V-groove's G has kinks, piece by piece: it is 1, or cos_o or cos_i decides, by wi.h. */
static double over_azimuths(struct ring *ring, double end)
{
	const double cos_h = ring->cos_h, share = 0.02 * ring->tolerance;
	double at[4] = {0.0, 0.0, 0.0, end};
	if (ring->model->gaf == GAF_V_GROOVE && ring->wi.x > 0.0) {
		const bool wide = cos_h * cos_h > 0.5; /* then between the two bounds neither decides */
		const double by_i = wide ? 2.0 * cos_h * ring->wi.z : ring->wi.z / cos_h;
		const double by_o = wide ? by_i / (4.0 * cos_h * cos_h - 1.0) : by_i;
		at[1] = azimuth_of(ring, by_i, end);
		at[2] = azimuth_of(ring, by_o, end);
	}
	double sum = 0.0;
	for (int i = 0; i < 3; i++)
		sum += quadrature_adaptive(at_azimuth, ring, at[i], at[i + 1], share);
	return sum;
}

static double at_slope(double v, void *params)
{
	struct ring *ring = params;
	const struct vec3 wi = ring->wi;
	const double tangent = exp(v), cos_h = 1.0 / sqrt(1.0 + tangent * tangent), sin_h = tangent * cos_h;
	const double sin_2h = 2.0 * sin_h * cos_h, cos_2h = (cos_h - sin_h) * (cos_h + sin_h);
	const double end = wi.x > 0.0 ? acos(fmax(-1.0, fmin(1.0, -wi.z * cos_2h / (wi.x * sin_2h)))) : M_PI;
	const double D = ndf_D(ring->ndf, (struct vec3){sin_h, 0.0, cos_h});
	ring->sin_h = sin_h;
	ring->cos_h = cos_h;
	ring->front = D * sin_h * sin_h * cos_h / wi.z;
	return 2.0 * over_azimuths(ring, end);
}

/* tan(theta_h) that half of the normals exceed. */
static double median_slope(const struct ndf *ndf)
{
	const struct vec3 m = ndf_sample(ndf, 0.0, 0.5);
	return hypot(m.x, m.y) / m.z;
}

/* Inserts x into the ascending at[0..n-1], kept inside its ends. */
static void insert(double at[], int n, double x)
{
	x = fmin(fmax(x, at[0]), at[n - 1]);
	for (; at[n - 1] > x; n--)
		at[n] = at[n - 1];
	at[n] = x;
}

/* Piece by piece, between the middle of D and the theta_h at which all azimuths begin to fail to reach above the horizon;
 * with the V-groove also where the azimuths of its kinks begin or end. */
static double integrate_slopes(struct ring *ring, double middle)
{
	const double above = atan2(ring->wi.z, ring->wi.x), theta_i = atan2(ring->wi.x, ring->wi.z);
	const double last = log(tan(0.5 * (0.5 * M_PI + theta_i)));
	const double kinks[] = {0.5 * above, above, above / 3.0, (0.5 * M_PI + theta_i) / 3.0, 0.25 * M_PI};
	const int n_kinks = ring->model->gaf == GAF_V_GROOVE ? 5 : 1;
	double at[8] = {fmin(middle, last) - V_BELOW, last}, sum = 0.0;
	insert(at, 2, middle);
	for (int i = 0; i < n_kinks; i++)
		insert(at, 3 + i, log(tan(kinks[i])));
	for (int i = 0; i < 2 + n_kinks; i++)
		sum += quadrature_adaptive(at_slope, ring, at[i], at[i + 1], ring->tolerance);
	return sum;
}

/* struct surface - what one lobe of a model has in common for all directions. */
struct surface {
	const struct cook_torrance *model;
	const struct ndf *ndf;
	int channel; /* whose F it is: that of FRESNEL_F82 differs */
	double median;
	struct smith_table G1;
	bool has_axes;
	struct energy_axes axes; /* then, instead of G1 */
};

static bool has_axes(const struct ndf *ndf)
{
	return ndf_is_anisotropic(ndf);
}

static enum status surface_init(struct surface *surface, const struct cook_torrance *model, const struct ndf *ndf)
{
	surface->model = model;
	surface->ndf = ndf;
	surface->channel = 0;
	surface->has_axes = has_axes(ndf);
	if (surface->has_axes) {
		const double mean = sqrt(ndf->sigma_x * ndf->sigma_y);
		/* At u1 = 0 the slope lies along x. */
		surface->median = median_slope(ndf) * (mean / ndf->sigma_x);
		return energy_axes_init(&surface->axes, model, surface->median);
	}
	surface->median = median_slope(ndf);
	smith_table_init(&surface->G1, ndf, surface->median);
	return STATUS_OK;
}

/* Of an anisotropic lobe the larger one of both axes' planes. */
static double lobe_albedo(struct surface *surface, double cos_i, double tolerance)
{
	const double z = fmax(cos_i, GRAZING * fmin(surface->median, 1.0));
	if (surface->has_axes) {
		surface->axes.channel = surface->channel;
		return fmax(energy_axes_lobe(&surface->axes, 0, z, tolerance),
			    energy_axes_lobe(&surface->axes, 1, z, tolerance));
	}
	struct ring ring = {.model = surface->model,
			    .ndf = surface->ndf,
			    .channel = surface->channel,
			    .G1 = &surface->G1,
			    .tolerance = tolerance,
			    .wi = {sqrt((1.0 - z) * (1.0 + z)), 0.0, z}};
	ring.lambda_i = ndf_lambda(surface->ndf, ring.wi);
	return integrate_slopes(&ring, log(surface->median));
}

/* What a single direction asks for. */
static enum status check(const struct cook_torrance *model, double cos_i)
{
	if (!(cos_i >= 0.0 && cos_i <= 1.0))
		return STATUS_DOMAIN;
	return has_axes(&model->ndf) ? STATUS_UNSUPPORTED : STATUS_OK;
}

enum status energy_lobe(const struct cook_torrance *model, double cos_i, double *albedo)
{
	struct surface surface;
	enum status status = check(model, cos_i);
	if (status == STATUS_OK)
		status = surface_init(&surface, model, &model->ndf);
	if (status == STATUS_OK)
		*albedo = lobe_albedo(&surface, cos_i, TOLERANCE);
	return status;
}

double energy_grazing(double exponent, double cos_i)
{
	/* cos_d^2 is (1 + wi.wo)/2, the mean of which over the azimuths (1 + cos_i cos_o)/2. What is left are beta functions. */
	const double p = exponent, all = 1.0 / ((p + 1.0) * (p + 2.0));
	return pow(1.0 - cos_i, p) * (0.5 + cos_i / 3.0) + all + cos_i * all * 2.0 / (p + 3.0);
}

/* struct balance - the lobes of a model, and whose albedo is asked for. */
struct balance {
	const struct cook_torrance *model;
	struct surface first, second;
	int channel; /* -1: the first lobe alone, for ks = 1 */
};

static enum status balance_init(struct balance *balance, const struct cook_torrance *model)
{
	balance->model = model;
	balance->channel = -1;
	const enum status status = surface_init(&balance->first, model, &model->ndf);
	return status == STATUS_OK && cook_torrance_has_second(model)
		       ? surface_init(&balance->second, model, &model->second)
		       : status;
}

static double balance_albedo(struct balance *balance, double cos_i, double tolerance)
{
	const struct cook_torrance *model = balance->model;
	const int c = balance->channel;
	if (c < 0)
		return lobe_albedo(&balance->first, cos_i, tolerance);
	balance->first.channel = balance->second.channel = c;
	double albedo = model->kd[c];
	if (model->kg[c] > 0.0)
		albedo += model->kg[c] * energy_grazing(model->grazing, cos_i);
	if (model->ks[c] > 0.0)
		albedo += model->ks[c] * lobe_albedo(&balance->first, cos_i, tolerance);
	if (model->ks_second[c] > 0.0)
		albedo += model->ks_second[c] * lobe_albedo(&balance->second, cos_i, tolerance);
	return albedo;
}

/* kd + ks lobe */
static void whole(const struct cook_torrance *model, double lobe, double albedo[3])
{
	for (int c = 0; c < 3; c++)
		albedo[c] = model->kd[c] + model->ks[c] * lobe;
}

enum status energy_albedo(const struct cook_torrance *model, double cos_i, double albedo[3])
{
	struct balance balance;
	enum status status = check(model, cos_i);
	if (status == STATUS_OK)
		status = balance_init(&balance, model);
	if (status != STATUS_OK)
		return status;
	if (!cook_torrance_is_rich(model)) {
		whole(model, balance_albedo(&balance, cos_i, TOLERANCE), albedo);
		return STATUS_OK;
	}
	for (balance.channel = 0; balance.channel < 3; balance.channel++)
		albedo[balance.channel] = balance_albedo(&balance, cos_i, TOLERANCE);
	return STATUS_OK;
}

/* A direction by x = -log2 cot(theta_i). */
struct direction {
	double x, albedo;
};

static double cos_at(double x)
{
	const double cot = exp2(-x);
	return cot / sqrt(1.0 + cot * cot);
}

static struct direction evaluate(struct balance *balance, double x)
{
	return (struct direction){x, balance_albedo(balance, cos_at(x), TOLERANCE_MANY)};
}

/* Golden sections of the octaves on either side of a maximum of the coarse evaluations. */
static struct direction refine(struct balance *balance, struct direction best)
{
	const double golden = 0.38196601125010515;
	double low = best.x - 1.0, high = best.x + 1.0;
	for (int i = 0; i < REFINEMENTS; i++) {
		const bool right = high - best.x > best.x - low;
		const struct direction next = evaluate(balance, best.x + golden * ((right ? high : low) - best.x));
		if (next.albedo > best.albedo) {
			*(right ? &low : &high) = best.x;
			best = next;
		} else {
			*(right ? &high : &low) = next.x;
		}
	}
	return best;
}

/* The largest over all directions, and where that is. */
static double largest(struct balance *balance, double *theta_i)
{
	const double first = log2(balance->first.median);
	const double second = cook_torrance_has_second(balance->model) ? log2(balance->second.median) : first;
	/* From the normal to where all is as at grazing incidence, which for a sharp lobe is close to the horizon only. */
	const double end = 10.0 - fmin(fmin(first, second), 0.0);
	const double normal = balance_albedo(balance, 1.0, TOLERANCE_MANY);
	const double grazing = balance_albedo(balance, 0.0, TOLERANCE_MANY);
	struct direction best = {0.0, -1.0}, before = {0.0, normal}, at = evaluate(balance, -3.0);
	/* There may be several maxima: one inside and one at either end. */
	for (double x = -2.0; x < end; x++) {
		const struct direction next = evaluate(balance, x);
		if (at.albedo >= fmax(before.albedo, next.albedo)) {
			const struct direction top = refine(balance, at);
			best = top.albedo > best.albedo ? top : best;
		}
		before = at;
		at = next;
	}
	const bool inside = best.albedo > fmax(normal, grazing);
	*theta_i = inside ? atan(exp2(best.x)) : normal >= grazing ? 0.0 : 0.5 * M_PI;
	return inside ? best.albedo : fmax(normal, grazing);
}

enum status energy_albedo_max(const struct cook_torrance *model, double albedo[3], double *theta_i)
{
	struct balance balance;
	const enum status status = balance_init(&balance, model);
	if (status != STATUS_OK)
		return status;
	if (!cook_torrance_is_rich(model)) {
		whole(model, largest(&balance, theta_i), albedo);
		return STATUS_OK;
	}
	double most = -1.0;
	for (int c = 0; c < 3; c++) {
		double at;
		balance.channel = c;
		albedo[c] = largest(&balance, &at);
		if (albedo[c] > most) {
			most = albedo[c];
			*theta_i = at;
		}
	}
	return STATUS_OK;
}

static double furnace_at(double theta_i, void *params)
{
	return lobe_albedo(params, cos(theta_i), TOLERANCE_MANY) * sin(2.0 * theta_i);
}

enum status energy_furnace(const struct cook_torrance *model, double *balance)
{
	struct cook_torrance mirror = *model;
	mirror.fresnel = FRESNEL_NONE;
	if (has_axes(&model->ndf))
		return STATUS_UNSUPPORTED;
	struct surface surface;
	const enum status status = surface_init(&surface, &mirror, &mirror.ndf);
	if (status == STATUS_OK)
		*balance = quadrature_adaptive(furnace_at, &surface, 0.0, 0.5 * M_PI, TOLERANCE_MANY);
	return status;
}
