/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/suspects.h"
#include "fit/error/entries.h"
#include "fit/error/sample_set.h"
#include "fit/error/scattered_albedo.h"
#include <gsl/gsl_statistics_float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Limits. Twenty tables fitted to MERL materials, and tables of models with noise of 50 %, stay well below: the numbers
 * behind are their worst. */
#define ZERO_SHARE 2e-3      /* of the valid entries; 4e-4 */
#define BRIGHT_ALBEDO 1.05   /* 0.35; above 1 by more than the grid's error of integration */
#define UNSCALED_ALBEDO 30.0 /* more than pi times any albedo: the scale factors of MERL are missing */
#define DARK_ALBEDO 2e-3     /* 0.015 */
#define ASYMMETRY 0.2        /* 0.08 */
#define COSINE_ASYMMETRY 0.1
#define COSINE_LEFT 0.35 /* what is left of the asymmetry when the cosine is taken out */
#define COSINE_SLOPE 0.2 /* of ln value against ln(cos_i cos_o) at a fixed theta_h; 0 for a diffuse table, else below */
#define INTERLEAVED 0.5  /* differences over three entries against those over one; 2.9 */
#define CONSTANT 0.6     /* of the rows */
#define SPIKE 5.0f       /* times each neighbour; none is */

enum {
	SPIKES_MIN = 5,
	CLIPPED_ROWS = 6, /* a smooth table has its maximum in one row or two */
	HALF = 180,       /* entries of half a turn of phi_d */
	STRIDE = 3,       /* of rows, where some are enough */
	CLASSES = 90,     /* degrees of the larger of theta_i and theta_o */
	SAMPLED = 4096,   /* values that the median is of */
	PHI_STEPS = 24,   /* of half a turn of phi_h, in the integral of an albedo */
};

static const double albedo_theta_i[SUSPECTS_ALBEDOS] = {0, M_PI / 6, M_PI / 3};

/* Entries of a row of half a turn, first .. last, are in range. */
struct half_row {
	const float *value[MERL_CHANNELS];
	int i, j, first, last;
	double a, b; /* cos_i, cos_o = a -/+ b cos phi_d */
};

/* What one pass over the measurement counts. */
struct tally {
	const struct measurement *measurement;
	enum bins bins;
	struct entries entries;
	double min_cos;
	bool zero_is_missing;
	size_t n, n_zero, n_masked, n_spikes;
	double lag_1, lag_3, green;          /* sums of differences along phi_d, and of values */
	int32_t max[MERL_CHANNELS];          /* order_of() the largest value */
	int n_rows, max_rows[MERL_CHANNELS]; /* rows of half a turn; those that have the largest value */
	double all[CLASSES], zero[CLASSES], masked[CLASSES]; /* by the larger of theta_i and theta_o */
	float sampled[SAMPLED];                              /* sums over the channels, not 0 */
	size_t n_sampled;
	double asymmetry[3]; /* sums over rows: as it is, without cos theta_i, without cos theta_o */
	int n_asymmetry;
	double slope_xx, slope_xy;
};

/* The row (i, j) from entry `start` of phi_d on. */
static struct half_row half_row_at(const struct tally *t, int i, int j, int start)
{
	const double shift = t->bins == BINS_CENTRE ? 0.5 : 0;
	const struct halfdiff_trig *h = &t->entries.theta[i], *d = &t->entries.theta[j];
	struct half_row row = {.i = i, .j = j, .a = h->cos_h * d->cos_d, .b = h->sin_h * d->sin_d};
	const double cosine = (row.a - t->min_cos) / row.b; /* largest |cos phi_d| in range */

	for (int c = 0; c < MERL_CHANNELS; c++)
		row.value[c] = t->measurement->value[c] + measurement_at(t->measurement->n_phi_d, i, j, start);
	if (!(row.a > t->min_cos))
		row.last = -1;
	else if (!(cosine < 1))
		row.last = HALF - 1;
	else {
		row.first = (int)ceil(acos(cosine) * 180 / M_PI - shift + 1e-9);
		row.last = bins_mirror(t->bins, row.first);
	}
	if (row.last > HALF - 1)
		row.last = HALF - 1;
	return row;
}

/* Floats that are not negative are in the order of their bits, as whole numbers; NaN counts as 0. The largest of whole
 * numbers is found with vectors by any compiler. */
static int32_t order_of(float value)
{
	int32_t bits;

	memcpy(&bits, &value, sizeof bits);
	return isnan(value) ? 0 : bits;
}

static void count_values(struct tally *t, const struct half_row *row)
{
	const float *restrict r = row->value[0], *restrict g = row->value[1], *restrict b = row->value[2];
	int zero = 0, masked = 0;
	int32_t max[MERL_CHANNELS], max_r = 0, max_g = 0, max_b = 0;

#pragma omp simd reduction(+ : zero, masked) reduction(max : max_r, max_g, max_b)
	for (int k = row->first; k <= row->last; k++) {
		zero += r[k] + g[k] + b[k] == 0;
		masked += isnan(r[k]);
		const int32_t order_r = order_of(r[k]), order_g = order_of(g[k]), order_b = order_of(b[k]);

		max_r = order_r > max_r ? order_r : max_r;
		max_g = order_g > max_g ? order_g : max_g;
		max_b = order_b > max_b ? order_b : max_b;
	}
	t->n += (size_t)(row->last - row->first + 1);
	t->n_zero += (size_t)zero;
	t->n_masked += (size_t)masked;
	t->n_rows++;
	max[0] = max_r;
	max[1] = max_g;
	max[2] = max_b;
	for (int c = 0; c < MERL_CHANNELS; c++) {
		if (max[c] > t->max[c]) {
			t->max[c] = max[c];
			t->max_rows[c] = 1;
		} else if (max[c] == t->max[c] && max[c] > 0)
			t->max_rows[c]++;
	}
}

/* Differences to the first and the third entry before, where all are measured. */
static void count_lags(struct tally *t, const struct half_row *row)
{
	const float *restrict g = row->value[1];
	float lag_1 = 0, lag_3 = 0, green = 0;

#pragma omp simd reduction(+ : lag_1, lag_3, green)
	for (int k = row->first + 3; k <= row->last; k++) {
		const float one = fabsf(g[k] - g[k - 1]), three = fabsf(g[k] - g[k - 3]);
		const bool valid = !isnan(one) && !isnan(three);
		lag_1 += valid ? one : 0;
		lag_3 += valid ? three : 0;
		green += valid ? g[k] : 0;
	}
	t->lag_1 += (double)lag_1;
	t->lag_3 += (double)lag_3;
	t->green += (double)green;
}

static bool is_spike(const float *v, ptrdiff_t up, ptrdiff_t over)
{
	const float limit = *v / SPIKE;

	return limit > v[-1] && limit > v[1] && v[-1] > 0 && v[1] > 0 && limit > v[-up] && limit > v[up] &&
	       limit > v[-over] && limit > v[over];
}

/* In one channel of the row: a spike stands out in one as a rule in all. */
static void count_spikes(struct tally *t, const struct half_row *row)
{
	if (row->i == 0 || row->j == 0 || row->i == MERL_THETA_H - 1 || row->j == MERL_THETA_D - 1)
		return;
	const float *v = row->value[(row->i + row->j) % MERL_CHANNELS];
	const ptrdiff_t up = t->measurement->n_phi_d, over = up * MERL_THETA_D;
	const int first = row->first > 1 ? row->first : 1, last = row->last < HALF - 2 ? row->last : HALF - 2;
	int n = 0;

	/* Hardly any row has a candidate. */
#pragma omp simd reduction(+ : n)
	for (int k = first; k <= last; k++)
		n += (v[k] > SPIKE * v[k - 1]) & (v[k] > SPIKE * v[k + 1]);
	for (int k = first; k <= last && n; k++)
		t->n_spikes += is_spike(v + k, up, over);
}

/* By angle, of a row among some. */
static void count_classes(struct tally *t, const struct half_row *row, const unsigned char class_of[])
{
	for (int k = row->first; k <= row->last; k++) {
		const double cosine = row->a - row->b * fabs(t->entries.phi[k].cos_phi);
		const int class = class_of[(int)(cosine * 8191)];
		const float sum = row->value[0][k] + row->value[1][k] + row->value[2][k];

		t->all[class]++;
		t->zero[class] += sum == 0;
		t->masked[class] += isnan(sum);
		if (k % 41 == (row->i + row->j) % 41 && sum > 0 && t->n_sampled < SAMPLED)
			t->sampled[t->n_sampled++] = sum;
	}
}

/* The halves phi_d < 90 and > 90 degrees: an exchange of the directions, with a mirror image where the measurement has
 * only half a turn, maps one onto the other. */
static void count_asymmetry(struct tally *t, const struct half_row *row, const float *partner, int step)
{
	double near[3] = {0, 0, 0}, far[3] = {0, 0, 0};
	int n = 0;

	if (row->b < 0.15)
		return;
	for (int k = row->first; k < HALF / 2; k++) {
		const double c = row->b * t->entries.phi[k].cos_phi, cos_i = row->a - c, cos_o = row->a + c;
		const int other = step > 0 ? k : bins_mirror(t->bins, k);
		const double m = (double)row->value[1][k], p = other < HALF ? (double)partner[other] : NAN;

		if (cos_i < 0.1 || isnan(m) || isnan(p))
			continue;
		near[0] += m;
		far[0] += p;
		near[1] += m / cos_i;
		far[1] += p / cos_o;
		near[2] += m / cos_o;
		far[2] += p / cos_i;
		n++;
	}
	if (n < 10 || !(near[0] + far[0] > 0))
		return;
	for (int a = 0; a < 3; a++)
		t->asymmetry[a] += fabs(near[a] - far[a]) / (near[a] + far[a]);
	t->n_asymmetry++;
}

static void count_row(struct tally *t, int i, int j, const unsigned char class_of[])
{
	const int n_phi_d = t->measurement->n_phi_d;

	for (int start = 0; start < n_phi_d; start += HALF) {
		const struct half_row row = half_row_at(t, i, j, start);

		if (row.last < row.first)
			return;
		count_values(t, &row);
		count_spikes(t, &row);
		if (i % STRIDE || j % STRIDE)
			continue;
		count_lags(t, &row);
		count_classes(t, &row, class_of);
		if (start == 0)
			count_asymmetry(t, &row, row.value[1] + (n_phi_d > HALF ? HALF : 0), n_phi_d > HALF);
	}
}

/* The regression of ln value on ln(cos_i cos_o) within one theta_h: a diffuse table has slope 0, and the lobe, with its
 * 1/(cos_i cos_o) and its Fresnel term, a negative one. */
static void count_slope(struct tally *t, int i)
{
	double x = 0, y = 0, xx = 0, xy = 0;
	int n = 0;

	for (int j = 0; j < 80; j += 5)
		for (int k = 0; k < HALF; k += 20) {
			const double c = t->entries.phi[k].cos_phi;
			const double a = t->entries.theta[i].cos_h * t->entries.theta[j].cos_d;
			const double b = t->entries.theta[i].sin_h * t->entries.theta[j].sin_d;
			const float m = t->measurement->value[1][measurement_at(t->measurement->n_phi_d, i, j, k)];

			if (!(m > 0) || a - b * fabs(c) < 0.1)
				continue;
			const double u = log(a * a - b * b * c * c), v = log((double)m);
			x += u;
			y += v;
			xx += u * u;
			xy += u * v;
			n++;
		}
	if (n < 6)
		return;
	t->slope_xx += xx - x * x / n;
	t->slope_xy += xy - x * y / n;
}

static void count_all(struct tally *t)
{
	unsigned char class_of[8192];

	for (int c = 0; c < 8192; c++) {
		const int class = (int)(acos(c / 8191.0) * 180 / M_PI + 1e-6);
		class_of[c] = (unsigned char)(class < CLASSES ? class : CLASSES - 1);
	}
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			count_row(t, i, j, class_of);
	for (int i = 20; i < 80; i += 6)
		count_slope(t, i);
}

/* The albedo at theta_i by an integral over the half vector, dw_o = 4 cos theta_d dw_h, whose theta_h are the rows of
 * the measurement: so no lobe is too narrow for it. Both halves of phi_h are the same entries or their mirror
 * images. */
static void find_albedo(const struct tally *t, double theta_i, double albedo[MERL_CHANNELS], double *measured)
{
	const struct measurement *m = t->measurement;
	const struct vec3 wi = {sin(theta_i), 0, cos(theta_i)};
	const bool centre = t->bins == BINS_CENTRE;
	double all = 0, low = 0;

	*measured = 0;
	for (int c = 0; c < MERL_CHANNELS; c++)
		albedo[c] = 0;
	for (int i = 0; i < MERL_THETA_H; i++) {
		const double theta_h = bins_angles(t->bins, i, 0, 0).theta_h;
		const double edge = centre ? (i + 1) * (i + 1) : (i * i + (i + 1) * (i + 1)) / 2.0; /* times 90 */
		const double high = i == MERL_THETA_H - 1 ? M_PI / 2 : edge / 90 * M_PI / 180;
		const double ring = 2 * M_PI / PHI_STEPS * (cos(low) - cos(high));

		low = high;
		for (int p = 0; p < PHI_STEPS; p++) {
			const double phi = (p + 0.5) * M_PI / PHI_STEPS;
			const struct vec3 h = {sin(theta_h) * cos(phi), sin(theta_h) * sin(phi), cos(theta_h)};
			const double cos_d = h.x * wi.x + h.z * wi.z;
			const struct vec3 wo = {2 * cos_d * h.x - wi.x, 2 * cos_d * h.y, 2 * cos_d * h.z - wi.z};

			if (cos_d <= 0 || wo.z <= 0)
				continue;
			const double w = 4 * cos_d * wo.z * ring;
			struct halfdiff angles = halfdiff_from_dirs(wi, wo);
			const struct bins_indices at = bins_indices(t->bins, angles);
			angles.phi_d = 2 * M_PI - angles.phi_d;
			const struct bins_indices mirrored = bins_indices(t->bins, angles);
			const int j = (int)fmin(fmax(rint(at.j), 0), MERL_THETA_D - 1);
			const int k = (int)(lrint(at.k) + m->n_phi_d) % m->n_phi_d;
			const int other = (int)(lrint(mirrored.k) + m->n_phi_d) % m->n_phi_d;
			const size_t entry[2] = {measurement_at(m->n_phi_d, i, j, k),
						 measurement_at(m->n_phi_d, i, j, other)};

			all += w;
			for (int e = 0; e < 2; e++) {
				const double r = (double)m->value[0][entry[e]], g = (double)m->value[1][entry[e]];
				const double b = (double)m->value[2][entry[e]];

				if (isnan(r) || (t->zero_is_missing && r + g + b == 0))
					continue;
				*measured += w / 2;
				albedo[0] += w / 2 * r;
				albedo[1] += w / 2 * g;
				albedo[2] += w / 2 * b;
			}
		}
	}
	*measured = fmin(*measured / all, 1); /* but for rounding */
}

/* Whether zeros stand in blocks, next to entries as bright as others are. */
static bool has_holes(const struct tally *t)
{
	const struct measurement *m = t->measurement;
	const int n = m->n_phi_d;
	const ptrdiff_t step[6] = {-1, 1, -n, n, -(ptrdiff_t)n * MERL_THETA_D, (ptrdiff_t)n * MERL_THETA_D};
	float sampled[SAMPLED];
	size_t zeros = 0, crowded = 0, edges = 0, bright = 0;

	if (!t->n_sampled)
		return false;
	memcpy(sampled, t->sampled, sizeof sampled);
	const float level = gsl_stats_float_select(sampled, 1, t->n_sampled, t->n_sampled / 2) / 4;

	for (int i = 1; i < MERL_THETA_H - 1; i++)
		for (int j = 1; j < MERL_THETA_D - 1; j++) {
			const struct half_row row = half_row_at(t, i, j, 0);

			for (int k = row.first > 1 ? row.first : 1; k <= row.last && k < HALF - 1; k++) {
				const size_t at = measurement_at(n, i, j, k);
				int empty = 0;

				if (!(m->value[0][at] + m->value[1][at] + m->value[2][at] == 0))
					continue;
				for (int s = 0; s < 6; s++) {
					const size_t next = (size_t)((ptrdiff_t)at + step[s]);
					const float v = m->value[0][next] + m->value[1][next] + m->value[2][next];

					empty += !(v > 0);
					edges += v > 0;
					bright += v > level;
				}
				zeros++;
				crowded += empty >= 4;
			}
		}
	return 2 * crowded > zeros && 2 * bright > edges;
}

/* The angle beyond which nothing is left, in whole degrees; NaN if there is none, or much is missing before it. */
static double find_end(const struct tally *t, double *zero_share)
{
	double all = 0, zero = 0, lost = 0;
	int end = CLASSES;

	*zero_share = 0;
	while (end > 0 && t->zero[end - 1] + t->masked[end - 1] >= 0.95 * t->all[end - 1])
		end--;
	for (int c = end; c < CLASSES; c++) {
		all += t->all[c];
		zero += t->zero[c];
	}
	if (end > CLASSES - 2 || end == 0 || all < 100)
		return NAN;
	*zero_share = zero / all;
	all = 0;
	for (int c = 0; c < end - 1; c++) {
		all += t->all[c];
		lost += t->zero[c] + t->masked[c];
	}
	return lost <= 0.05 * all ? (double)end : (double)NAN;
}

static unsigned judge_zeros(const struct tally *t, struct suspects *s)
{
	const size_t valid = t->n - t->n_masked;
	double zero_share;
	unsigned found = 0;

	s->zero_share = valid ? (double)t->n_zero / (double)valid : 0;
	s->ends_at = find_end(t, &zero_share);
	if (t->zero_is_missing || t->n_zero == valid)
		return 0;
	if (!isnan(s->ends_at) && zero_share > 0.5)
		found |= SUSPECT_WEDGE;
	if (s->zero_share > ZERO_SHARE && (found || has_holes(t)))
		found |= SUSPECT_ZEROS;
	return found;
}

static double largest_albedo(const struct suspects *s)
{
	double max = 0;

	for (int a = 0; a < SUSPECTS_ALBEDOS; a++)
		for (int c = 0; c < MERL_CHANNELS; c++)
			max = fmax(max, s->albedo[a][c]);
	return max;
}

static unsigned judge_albedo(const struct suspects *s)
{
	const double max = largest_albedo(s);
	double measured = 1;

	for (int a = 0; a < SUSPECTS_ALBEDOS; a++)
		measured = fmin(measured, s->measured[a]);
	return max > BRIGHT_ALBEDO ? SUSPECT_BRIGHT : max > 0 && max < DARK_ALBEDO && measured > 0.5 ? SUSPECT_DARK : 0;
}

static unsigned judge_directions(const struct tally *t, struct suspects *s)
{
	const double rows = t->n_asymmetry ? t->n_asymmetry : 1;
	const double left[3] = {t->asymmetry[0] / rows, t->asymmetry[1] / rows, t->asymmetry[2] / rows};
	const int which = left[1] < left[2] ? 1 : 2;

	s->asymmetry = left[0];
	if (left[0] > COSINE_ASYMMETRY && left[which] < COSINE_LEFT * left[0])
		s->cosine = which;
	else if (t->slope_xy > COSINE_SLOPE * t->slope_xx)
		s->cosine = 3;
	return s->cosine ? SUSPECT_COSINE : left[0] > ASYMMETRY ? SUSPECT_ASYMMETRIC : 0;
}

static unsigned judge_values(const struct tally *t, struct suspects *s)
{
	unsigned found = 0;

	s->n_spikes = t->n_spikes;
	if (t->n_spikes >= SPIKES_MIN)
		found |= SUSPECT_SPIKES;
	if (t->lag_3 < INTERLEAVED * t->lag_1 && t->lag_1 > 0.01 * t->green)
		found |= SUSPECT_INTERLEAVED;
	/* A table that is the same nearly everywhere is not clipped, but diffuse. */
	for (int c = 0; c < MERL_CHANNELS; c++)
		if (t->max_rows[c] > s->n_clipped_rows && t->max_rows[c] < CONSTANT * t->n_rows)
			s->n_clipped_rows = t->max_rows[c];
	if (s->n_clipped_rows >= CLIPPED_ROWS)
		found |= SUSPECT_CLIPPED;
	return found;
}

enum status suspects_find(const struct measurement *measurement, const struct criterion *criterion,
			  struct suspects *suspects)
{
	*suspects = (struct suspects){.ends_at = NAN};
	if (measurement->scattered) {
		const enum status status = scattered_albedo(measurement, albedo_theta_i, suspects);
		suspects->found = status == STATUS_OK ? judge_albedo(suspects) : 0;
		return status;
	}
	struct tally t = {.measurement = measurement,
			  .bins = criterion->bins,
			  .entries = entries_make(criterion->bins, measurement->n_phi_d),
			  .min_cos = fmax(max_theta_cos(criterion->max_theta), 1e-9),
			  .zero_is_missing = criterion->zero_is_missing};

	count_all(&t);
	for (int a = 0; a < SUSPECTS_ALBEDOS; a++)
		find_albedo(&t, albedo_theta_i[a], suspects->albedo[a], &suspects->measured[a]);
	suspects->found = judge_zeros(&t, suspects) | judge_albedo(suspects) | judge_directions(&t, suspects) |
			  judge_values(&t, suspects);
	/* Of values that stand in wrong places nothing else is to be said. */
	if (suspects->found & SUSPECT_INTERLEAVED)
		suspects->found = SUSPECT_INTERLEAVED;
	return STATUS_OK;
}

const char *suspects_words(const struct suspects *suspects, char text[SUSPECTS_WORDS])
{
	static const char *const word[] = {"zeros",       "wedge",      "bright", "dark",    "cosine",
					   "interleaved", "asymmetric", "spikes", "clipped", "correlated"};
	size_t used = 0;

	text[0] = '\0';
	for (size_t b = 0; b < sizeof word / sizeof *word; b++)
		if (suspects->found & 1u << b)
			used += (size_t)snprintf(text + used, SUSPECTS_WORDS - used, "%s%s", used ? "+" : "", word[b]);
	return text;
}

/* Adds one finding to the text. */
static void add(char text[SUSPECTS_TEXT], const char *format, ...) __attribute__((format(printf, 2, 3)));
static void add(char text[SUSPECTS_TEXT], const char *format, ...)
{
	const size_t used = strlen(text);
	const size_t from = used + (size_t)snprintf(text + used, SUSPECTS_TEXT - used, "%s", used ? "; " : "");
	va_list list;

	va_start(list, format);
	vsnprintf(text + from, SUSPECTS_TEXT - from, format, list);
	va_end(list);
}

const char *suspects_explain(const struct suspects *s, char text[SUSPECTS_TEXT])
{
	static const char *const cosine[] = {"", "cos theta_i", "cos theta_o", "cos theta_i cos theta_o"};
	const double max = largest_albedo(s);

	text[0] = '\0';
	if (s->found & SUSPECT_WEDGE)
		add(text, "all 0 beyond %.0f degrees: --zero-is-missing or --max-theta %.0f leaves that out",
		    s->ends_at, s->ends_at);
	else if (s->found & SUSPECT_ZEROS)
		add(text, "%.1f %% exact zeros beside bright values: --zero-is-missing leaves them out",
		    100 * s->zero_share);
	if (s->found & SUSPECT_BRIGHT)
		add(text, "an albedo of %.3g: %s (--unbounded fits it as it is)", max,
		    max > UNSCALED_ALBEDO ? "the scale factors of MERL (1/1500) are missing"
					  : "perhaps a reflectance factor, pi times too bright");
	if (s->found & SUSPECT_DARK)
		add(text,
		    "an albedo of %.2g at most: perhaps 1500 times too dark, the scale factors of MERL applied twice",
		    max);
	if (s->found & SUSPECT_COSINE)
		add(text, "values look multiplied by %s: divide by it", cosine[s->cosine]);
	if (s->found & SUSPECT_INTERLEAVED)
		add(text, "red, green and blue seem to alternate: MERL wants them in three planes");
	if (s->found & SUSPECT_ASYMMETRIC)
		add(text, "exchanging wi and wo changes the values by %.0f %%: no model here can follow",
		    200 * s->asymmetry);
	if (s->found & SUSPECT_SPIKES)
		add(text, "%zu spikes, above 5 times all their neighbours: mask them with -1", s->n_spikes);
	if (s->found & SUSPECT_CLIPPED)
		add(text, "the largest value stands in %d rows of the table: clipped? mask it with -1",
		    s->n_clipped_rows);
	if (s->found & SUSPECT_CORRELATED)
		add(text, "correlated G fits much better, E below %.2g: --gaf correlated", s->correlated);
	return text;
}
