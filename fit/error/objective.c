/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/objective.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status objective_init(struct objective *o, const struct sample_set *table, const struct fit_options *options,
			   const struct ndf_class *class, int threads, enum masking_density density)
{
	*o = (struct objective){
		.table = table, .options = options, .class = class, .kernel = kernel_pick(), .threads = threads};
	o->tabulated.sigma = NAN;
	objective_forget(o);
	objective_unfix(o);
	o->s = aligned_alloc(64, (size_t)table->n_blocks * KERNEL_BLOCK * sizeof *o->s);
	o->sums = malloc((size_t)table->n_blocks * sizeof *o->sums);
	o->is_exact = table->scattered && density == MASKING_FINE && table->n_samples <= OBJECTIVE_EXACT_SAMPLES;
	const enum status status = table->scattered ? scattered_lobe_init(&o->scattered, density)
						    : masking_init(&o->masking, table->geometry->q_min, density);

	if (!o->s || !o->sums || status != STATUS_OK) {
		objective_free(o);
		return STATUS_NO_MEMORY;
	}
	return STATUS_OK;
}

void objective_forget(struct objective *o)
{
	o->start.kd[0] = NAN;
}

void objective_begin(struct objective *o, const struct linear *linear)
{
	o->start = *linear;
	if (linear->error == 0)
		objective_forget(o);
}

void objective_free(struct objective *o)
{
	masking_free(&o->masking);
	scattered_lobe_free(&o->scattered);
	free(o->s);
	free(o->sums);
	o->s = NULL;
	o->sums = NULL;
}

struct shape shape_of(const struct cook_torrance *model)
{
	const struct ndf *ndf = &model->ndf;
	struct shape shape = {.sigma = ndf->sigma_x, .gamma = ndf->gamma, .ior = model->n, .k = model->k};

	if (ndf->sigma_x != ndf->sigma_y) {
		shape.sigma = sqrt(ndf->sigma_x * ndf->sigma_y);
		shape.stretch = log(ndf->sigma_x / ndf->sigma_y);
		shape.angle = ndf->angle;
	}
	return shape;
}

enum status shape_ndf(const struct shape *shape, const struct ndf_class *class, enum lambda_form lambda,
		      struct ndf *ndf)
{
	const double half = shape->stretch == 0 ? 1 : exp(0.5 * shape->stretch);
	enum status status = ndf_init(ndf, class, shape->sigma * half, shape->sigma / half, shape->gamma);

	if (status == STATUS_OK && shape->stretch != 0)
		status = ndf_turn(ndf, shape->angle);
	if (status == STATUS_OK && lambda != LAMBDA_EXACT)
		status = ndf_set_lambda_form(ndf, lambda);
	return status == STATUS_UNSUPPORTED ? STATUS_OK : status;
}

static void tabulate_ndf(struct objective *o, const struct ndf *ndf)
{
	const struct geometry *g = o->table->geometry;
	const bool with_masking = o->options->criterion.gaf != GAF_V_GROOVE;

	if (o->table->scattered && o->is_exact && !o->given)
		o->exact.ndf = *ndf;
	else if (o->table->scattered)
		scattered_lobe_ndf(&o->scattered, &o->table->range, ndf, with_masking);
	if (o->table->scattered && !o->given)
		return;
	for (int i = 0; i < MERL_THETA_H; i++)
		o->D[i] = ndf_D(ndf, (struct vec3){g->entries.theta[i].sin_h, 0, g->entries.theta[i].cos_h});
	if (with_masking && !o->table->scattered)
		masking_fill(&o->masking, ndf);
}

void objective_use(struct objective *o, const struct ndf *ndf)
{
	o->given = true;
	tabulate_ndf(o, ndf);
}

static enum status tabulate(struct objective *o, const struct shape *shape)
{
	struct ndf ndf;

	const bool same_gamma = shape->gamma == o->tabulated.gamma || !ndf_has_gamma(o->class);

	if (o->given || (shape->sigma == o->tabulated.sigma && same_gamma && shape->stretch == o->tabulated.stretch &&
			 shape->angle == o->tabulated.angle))
		return STATUS_OK;
	const enum status status = shape_ndf(shape, o->class, o->options->lambda, &ndf);

	if (status != STATUS_OK)
		return status;
	tabulate_ndf(o, &ndf);
	o->tabulated = *shape;
	return STATUS_OK;
}

/* D F beyond this, a sigma below 1e-10, counts as this: times the largest geometric_factor, 1/(4 1e-9 1e-9), it is still a float. */
#define ROW_MAX 1e20

static void fill_rows(struct objective *o, const struct shape *shape)
{
	float F[MERL_THETA_D];

	if (o->table->scattered) {
		o->exact.gaf = o->options->criterion.gaf;
		o->exact.fresnel = o->options->fresnel;
		o->exact.n = shape->ior;
		o->exact.k = shape->k;
		if (!o->is_exact || o->given)
			scattered_lobe_fresnel(&o->scattered, &o->table->range, o->options->fresnel, shape->ior,
					       shape->k);
		return;
	}

	for (int j = 0; j < MERL_THETA_D; j++)
		F[j] = (float)fresnel_F(o->options->fresnel, o->table->geometry->entries.theta[j].cos_d, shape->ior,
					shape->k);
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			o->row[j + MERL_THETA_D * i] = (float)fmin(o->D[i], ROW_MAX) * F[j];
}

/* The lobe at the samples of a block, no table involved. */
static void exact_block(struct objective *o, int block)
{
	const struct sample_set *t = o->table;
	const struct scattered *scattered = t->scattered;
	const size_t from = (size_t)block * KERNEL_BLOCK;

	for (size_t n = from; n < from + KERNEL_BLOCK; n++) {
		const struct vec3 wi = scattered->wi[t->entry[n]], wo = scattered->wo[t->entry[n]];

		o->s[n] = t->w[n] > 0 ? (float)fmin((double)t->w[n] * cook_torrance_lobe(&o->exact, wi, wo), 1e30) : 0;
	}
}

static void lobe_block(struct objective *o, int block)
{
	static const enum kernel_gaf gaf[GAF_COUNT] = {[GAF_UNCORRELATED] = KERNEL_SEPARABLE,
						       [GAF_CORRELATED] = KERNEL_CORRELATED,
						       [GAF_V_GROOVE] = KERNEL_STATIC};

	if (o->is_exact && !o->given) {
		exact_block(o, block);
		return;
	}
	if (o->table->scattered) {
		const struct kernel_scattered samples = sample_set_scattered_block(o->table, block);

		o->kernel->lobe_scattered(gaf[o->options->criterion.gaf], &o->scattered.shape, &samples,
					  o->s + (size_t)block * KERNEL_BLOCK);
		return;
	}
	const struct kernel_g1 g1 = masking_kernel(&o->masking);
	const struct kernel_samples samples = sample_set_block(o->table, block);

	o->kernel->lobe(gaf[o->options->criterion.gaf], &g1, o->row, &samples, o->s + (size_t)block * KERNEL_BLOCK);
}

/* What a pass is asked by each of the problems, one a channel or one for all of them. */
struct evaluation {
	int n_problems;
	bool wanted[MERL_CHANNELS];
	struct kernel_evaluation at[MERL_CHANNELS];
};

static void pass_block(struct objective *o, const struct evaluation *asked, int block)
{
	const struct sample_set *t = o->table;
	const size_t at = (size_t)block * KERNEL_BLOCK;
	const int members = (block < t->n_pair_blocks ? 2 : 1) * MERL_CHANNELS / asked->n_problems;

	for (int p = 0; p < asked->n_problems; p++)
		if (asked->wanted[p])
			o->kernel->pass(members, sample_set_value(t, block, p), t->w + at, o->s + at, &asked->at[p],
					&o->sums[block][p]);
}

/* The same of values that stand in the unit of a sample set. */
static struct evaluation in_unit(const struct evaluation *asked, double unit)
{
	struct evaluation own = *asked;

	for (int p = 0; p < own.n_problems; p++) {
		own.at[p].d *= unit;
		own.at[p].ks *= unit;
		own.at[p].floor *= unit;
	}
	return own;
}

/* One pass over the table; with `lobe`, s is computed on the way, while each block is in cache. The blocks' sums are
 * added in their order: the result is the same to the bit for any number of threads. Tasks, not a parallel loop: on a
 * busy machine this thread then does what the others do not come to, and never waits for one that has not begun. */
static void pass(struct objective *o, const struct evaluation *wanted, bool lobe, struct kernel_sums total[])
{
	enum { CHUNK = 8 };
	const size_t n_blocks = (size_t)o->table->n_blocks;
	const struct evaluation own = in_unit(wanted, o->table->unit), *asked = &own;

	o->passes++;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion" /* clang finds some in what it makes of the loop */
#pragma omp taskloop grainsize(CHUNK) default(shared) if (o->threads > 1)
	for (size_t block = 0; block < n_blocks; block++) {
		if (lobe)
			lobe_block(o, (int)block);
		pass_block(o, asked, (int)block);
	}
#pragma GCC diagnostic pop
	for (int p = 0; p < asked->n_problems; p++) {
		total[p] = (struct kernel_sums){0};
		for (size_t block = 0; asked->wanted[p] && block < n_blocks; block++) {
			const struct kernel_sums *sums = &o->sums[block][p];

			total[p].error += sums->error;
			for (int a = 0; a < 2; a++)
				total[p].slope[a] += sums->slope[a];
			for (int a = 0; a < 3; a++)
				total[p].curvature[a] += sums->curvature[a];
		}
		total[p].error /= o->table->unit;
		for (int a = 0; a < 3; a++)
			total[p].curvature[a] *= o->table->unit;
	}
}

enum status objective_lobe(struct objective *o, const struct shape *shape)
{
	const enum status status = tabulate(o, shape);

	if (status != STATUS_OK)
		return status;
	fill_rows(o, shape);
	for (int block = 0; block < o->table->n_blocks; block++)
		lobe_block(o, block);
	return STATUS_OK;
}

double objective_upper_bound(const struct fit_options *options, bool specular)
{
	if (options->blend > 0)
		return specular ? options->blend : 1 - options->blend;
	return options->unbounded ? FIT_FACTOR_MAX : 1;
}

/* The table is evaluated in float: kd/pi is one. */
static double diffuse_value(double kd)
{
	return (double)(float)(kd / M_PI);
}

void objective_unfix(struct objective *o)
{
	const struct fit_options *options = o->options;
	const double kd = options->diffuse ? diffuse_value(objective_upper_bound(options, false)) : 0;
	const double ks = options->specular ? objective_upper_bound(options, true) : 0;

	for (int c = 0; c < MERL_CHANNELS; c++)
		o->box[c] = (struct objective_box){{0, 0}, {kd, ks}};
}

void objective_fix(struct objective *o, int channel, bool specular, double value)
{
	const double at = specular ? (double)(float)value : diffuse_value(value);

	for (int c = 0; c < MERL_CHANNELS; c++)
		if (c == channel || o->options->gray)
			o->box[c].lo[specular] = o->box[c].hi[specular] = at;
}

static bool within_twice(double a, double b)
{
	return !(a > 2 * b) && !(b > 2 * a); /* NaN: a parameter that the model lacks */
}

/* Whether the inner solve of one shape helps that of another. Second derivatives go with the square of the lobe: handed on
 * to a lobe far smaller, they make a Newton step that is far too short look like the last one. And the ks of a low lobe is
 * no place to begin where the lobe is so high that its own is 1e-8: the way there is too long for a quadratic model. */
static bool helps(const struct shape *a, const struct shape *b)
{
	return within_twice(a->sigma, b->sigma) && within_twice(a->ior - 1, b->ior - 1) && within_twice(a->k, b->k);
}

/* The mean measurement of a problem. */
static double mean_measured(const struct objective *o, int p)
{
	const struct sample_set *t = o->table;

	return (o->options->gray ? (t->sum[0] + t->sum[1] + t->sum[2]) / MERL_CHANNELS : t->sum[p]) / t->sum_w;
}

/* A solve that is to be this precise is one of a small step, relative: what the last one has learnt holds for it too. */
#define PRECISE 1e-5

/* With one kd and ks for all channels there is one problem, their sum; else one a channel. */
static void start(const struct objective *o, const struct shape *shape, struct l1 problem[], int n_problems,
		  double tolerance, bool certify)
{
	const bool precise = tolerance < PRECISE;
	const bool afresh = isnan(o->start.kd[0]) || (precise && !helps(&o->start.shape, shape));
	const double *sum = o->table->sum;

	for (int p = 0; p < n_problems; p++) {
		const struct objective_box *box = &o->box[p];
		const double scale = n_problems == 1 ? sum[0] + sum[1] + sum[2] : sum[p];
		const double known[2] = {o->start.kd[p] / M_PI, o->start.ks[p]};
		const bool faint = sum[p] > 0 && mean_measured(o, p) < L1_FAR * fmax(box->hi[0], box->hi[1]);
		const bool cold = afresh || faint, at_zero = box->lo[0] == 0 && box->lo[1] == 0;

		l1_start(&problem[p], box->lo, box->hi,
			 !cold     ? known
			 : at_zero ? NULL
				   : box->lo,
			 !cold && precise ? o->start.h[p] : NULL, scale, tolerance, certify);
	}
}

/* On the bound to the last bit: kd is then the bound itself. */
static double kd_of(const struct objective *o, double diffuse)
{
	const double maximum = objective_upper_bound(o->options, false);

	return diffuse < diffuse_value(maximum) ? diffuse * M_PI : maximum;
}

static void finish(const struct objective *o, const struct l1 problem[], int n_problems, struct linear *linear)
{
	double sum = 0;

	*linear = (struct linear){.error = 0};
	for (int c = 0; c < MERL_CHANNELS; c++) {
		const struct l1 *p = &problem[n_problems == 1 ? 0 : c];

		linear->kd[c] = kd_of(o, p->best[0]);
		linear->ks[c] = p->best[1];
		sum += o->table->sum[c];
	}
	for (int p = 0; p < n_problems; p++) {
		linear->channel[p] = problem[p].error / sum;
		linear->error += linear->channel[p];
		memcpy(linear->h[p], problem[p].h, sizeof linear->h[p]);
		if (problem[p].certify)
			linear->lower_bound += l1_lower_bound(&problem[p]) / sum;
	}
}

/* A fiftieth of the mean measurement: below it, how near a residual is to 0 is decided by the data, not by the model. */
static double window_floor(const struct objective *o, int p)
{
	return 0.02 * mean_measured(o, p);
}

double objective_eval(struct objective *o, const struct shape *shape, double tolerance, bool certify,
		      struct linear *linear)
{
	const int n_problems = o->options->gray ? 1 : MERL_CHANNELS;
	struct l1 problem[MERL_CHANNELS];
	struct kernel_sums total[MERL_CHANNELS];
	bool lobe = true, going = true;

	if (tabulate(o, shape) != STATUS_OK) {
		*linear = (struct linear){.error = OBJECTIVE_NO_FIT};
		return OBJECTIVE_NO_FIT;
	}
	fill_rows(o, shape);
	start(o, shape, problem, n_problems, tolerance, certify);
	while (going) {
		struct evaluation asked = {.n_problems = n_problems};

		for (int p = 0; p < n_problems; p++) {
			asked.wanted[p] = !problem[p].done;
			asked.at[p] = (struct kernel_evaluation){problem[p].x[0], problem[p].x[1], problem[p].tau,
								 window_floor(o, p)};
		}
		pass(o, &asked, lobe, total);
		lobe = going = false;
		for (int p = 0; p < n_problems; p++) {
			if (!problem[p].done)
				l1_update(&problem[p], total[p].error, total[p].slope, total[p].curvature);
			going |= !problem[p].done;
		}
	}
	finish(o, problem, n_problems, linear);
	linear->shape = *shape;
	o->start = *linear;
	return linear->error;
}

double objective_error(struct objective *o, const struct shape *shape, const double kd[], const double ks[])
{
	double error = 0, sum = 0;
	struct kernel_sums total[MERL_CHANNELS];
	struct evaluation asked = {.n_problems = MERL_CHANNELS};

	if (tabulate(o, shape) != STATUS_OK)
		return OBJECTIVE_NO_FIT;
	fill_rows(o, shape);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		asked.wanted[c] = true;
		asked.at[c] = (struct kernel_evaluation){.d = kd[c] / M_PI, .ks = ks[c]};
	}
	pass(o, &asked, true, total);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		error += total[c].error;
		sum += o->table->sum[c];
	}
	return error / sum;
}
