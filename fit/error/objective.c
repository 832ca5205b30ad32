/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/objective.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct term_list term_list_of(const struct fit_options *options)
{
	struct term_list list = {.n = 2, .term = {TERM_DIFFUSE, TERM_LOBE}};
	const int lobes = !options->specular ? 0 : options->fresnel == FRESNEL_F82 ? F82_PARTS : 1;
	const int extra =
		(lobes > 1 ? lobes - 1 : 0) + (lobes > 0 && options->lobes > 1 ? lobes : 0) + options->grazing;

	if (2 + extra > KERNEL_TERMS || (options->gray_specular && MERL_CHANNELS + 1 + extra > BUNDLE_VARIABLES))
		return (struct term_list){.n = 0};
	if (lobes > 1) {
		list.term[list.n++] = TERM_F82;
		list.term[list.n++] = TERM_F90;
	}
	if (lobes > 0 && options->lobes > 1)
		list.term[list.n++] = TERM_SECOND;
	if (options->grazing)
		list.term[list.n++] = TERM_GRAZING;
	return list;
}

static bool has_term(const struct objective *o, enum term term)
{
	for (int t = 0; t < o->terms.n; t++)
		if (o->terms.term[t] == term)
			return true;
	return false;
}

/* The term that an array is of, and the channel whose F it has. */
static enum term term_of(const struct objective *o, int array)
{
	return array < o->terms.n ? o->terms.term[array] : TERM_LOBE;
}

static int channel_of(const struct objective *o, int array)
{
	return array < o->terms.n ? 0 : 1 + array - o->terms.n;
}

int objective_array(const struct objective *o, int term, int channel)
{
	return o->terms.term[term] == TERM_LOBE && channel > 0 && o->n_arrays > o->terms.n ? o->terms.n + channel - 1
											   : term;
}

static enum status init_tables(struct objective *o, enum masking_density density)
{
	const int32_t q_min = o->table->geometry->q_min;
	enum status status = STATUS_OK;

	if (o->table->scattered) {
		o->scattered = calloc(OBJECTIVE_ARRAYS, sizeof *o->scattered);
		status = o->scattered ? STATUS_OK : STATUS_NO_MEMORY;
		for (int a = 1; a < o->n_arrays && status == STATUS_OK; a++)
			status = scattered_lobe_init(&o->scattered[a], density);
		return status;
	}
	status = masking_init(&o->lobe[0].masking, q_min, density);
	if (status == STATUS_OK && has_term(o, TERM_SECOND))
		status = masking_init(&o->lobe[1].masking, q_min, density);
	if (status == STATUS_OK && has_term(o, TERM_GRAZING))
		status = masking_init(&o->grazing, q_min, density);
	return status;
}

enum status objective_init(struct objective *o, const struct sample_set *table, const struct fit_options *options,
			   const struct ndf_class *class, int threads, enum masking_density density)
{
	const size_t n = (size_t)table->n_blocks * KERNEL_BLOCK;
	bool complete = true;

	*o = (struct objective){.table = table,
				.options = options,
				.class = class,
				.kernel = kernel_pick(),
				.threads = threads,
				.density = density,
				.terms = term_list_of(options)};
	o->lobe[0].tabulated.sigma = o->lobe[1].tabulated.sigma = o->grazing_exponent = NAN;
	objective_forget(o);
	objective_unfix(o);
	o->n_arrays = o->terms.n + (options->per_channel_ior && options->specular ? MERL_CHANNELS - 1 : 0);
	for (int a = 1; a < o->n_arrays; a++) {
		o->term[a] = aligned_alloc(64, n * sizeof *o->term[a]);
		complete &= o->term[a] != NULL;
	}
	o->row = malloc((size_t)o->n_arrays * sizeof *o->row);
	o->sums = malloc((size_t)table->n_blocks * sizeof *o->sums);
	/* Of tilted facets G1 is no function of one number. */
	o->is_exact = table->scattered && ((density == MASKING_FINE && table->n_samples <= OBJECTIVE_EXACT_SAMPLES) ||
					   (options->anisotropic && ndf_has_tilt(class)));
	if (!complete || !o->row || !o->sums || init_tables(o, density) != STATUS_OK) {
		objective_free(o);
		return STATUS_NO_MEMORY;
	}
	return STATUS_OK;
}

void objective_forget(struct objective *o)
{
	o->start.error = 0;
}

void objective_begin(struct objective *o, const struct linear *linear)
{
	o->start = *linear;
}

void objective_free(struct objective *o)
{
	for (int l = 0; l < OBJECTIVE_LOBES; l++)
		masking_free(&o->lobe[l].masking);
	masking_free(&o->grazing);
	for (int a = 0; a < OBJECTIVE_ARRAYS; a++) {
		if (o->scattered)
			scattered_lobe_free(&o->scattered[a]);
		free(o->term[a]);
		o->term[a] = NULL;
	}
	free(o->scattered);
	free(o->row);
	free(o->sums);
	o->scattered = NULL;
	o->row = NULL;
	o->sums = NULL;
}

struct shape shape_of(const struct cook_torrance *model)
{
	const struct ndf *ndf = &model->ndf;
	struct shape shape = {.sigma = ndf->sigma_x,
			      .gamma = ndf->gamma,
			      .ior = model->n,
			      .k = model->k,
			      .second_sigma = model->second.sigma_x,
			      .second_gamma = model->second.gamma,
			      .tilt_x = ndf->tilt_x,
			      .tilt_y = ndf->tilt_y,
			      .grazing = model->grazing};

	if (model->per_channel_ior) {
		shape.ior = NAN;
		memcpy(shape.channel_ior, model->channel_n, sizeof shape.channel_ior);
		memcpy(shape.channel_k, model->channel_k, sizeof shape.channel_k);
	}
	if (ndf->sigma_x != ndf->sigma_y) {
		shape.sigma = sqrt(ndf->sigma_x * ndf->sigma_y);
		shape.stretch = log(ndf->sigma_x / ndf->sigma_y);
		shape.angle = ndf->angle;
	}
	return shape;
}

void shape_spread_index(struct shape *shape)
{
	for (int c = 0; c < MERL_CHANNELS; c++) {
		shape->channel_ior[c] = shape->ior;
		shape->channel_k[c] = shape->k;
	}
	shape->ior = NAN;
	shape->k = 0;
}

enum status shape_ndf(const struct shape *shape, const struct ndf_class *class, enum lambda_form lambda,
		      struct ndf *ndf)
{
	const double half = shape->stretch == 0 ? 1 : exp(0.5 * shape->stretch);
	enum status status = ndf_init(ndf, class, shape->sigma * half, shape->sigma / half, shape->gamma);

	if (status == STATUS_OK && shape->stretch != 0)
		status = ndf_turn(ndf, shape->angle);
	if (status == STATUS_OK && (shape->tilt_x != 0 || shape->tilt_y != 0))
		status = ndf_tilt(ndf, shape->tilt_x, shape->tilt_y);
	if (status == STATUS_OK && lambda != LAMBDA_EXACT)
		status = ndf_set_lambda_form(ndf, lambda);
	return status == STATUS_UNSUPPORTED ? STATUS_OK : status;
}

struct shape shape_second(const struct shape *shape)
{
	struct shape second = *shape;

	second.sigma = shape->second_sigma;
	second.gamma = shape->second_gamma;
	return second;
}

static bool is_of_facets(enum term term)
{
	return term != TERM_DIFFUSE && term != TERM_GRAZING;
}

static int lobe_of(enum term term)
{
	return term == TERM_SECOND;
}

static void tabulate_ndf(struct objective *o, int which, const struct ndf *ndf)
{
	const struct geometry *g = o->table->geometry;
	const bool with_masking = o->options->criterion.gaf != GAF_V_GROOVE;
	struct objective_lobe *lobe = &o->lobe[which];

	if (o->table->scattered && o->is_exact && !lobe->given)
		lobe->exact = *ndf;
	else if (o->table->scattered)
		for (int a = 1; a < o->n_arrays; a++)
			if (is_of_facets(term_of(o, a)) && lobe_of(term_of(o, a)) == which)
				scattered_lobe_ndf(&o->scattered[a], &o->table->range, ndf, with_masking);
	if (o->table->scattered && !lobe->given)
		return;
	for (int i = 0; i < MERL_THETA_H; i++)
		lobe->D[i] = ndf_D(ndf, (struct vec3){g->entries.theta[i].sin_h, 0, g->entries.theta[i].cos_h});
	if (with_masking && !o->table->scattered)
		masking_fill(&lobe->masking, ndf);
}

void objective_use(struct objective *o, const struct ndf *ndf)
{
	o->lobe[0].given = true;
	tabulate_ndf(o, 0, ndf);
}

static enum status tabulate_lobe(struct objective *o, int which, const struct shape *shape)
{
	struct objective_lobe *lobe = &o->lobe[which];
	const struct shape *have = &lobe->tabulated;
	const bool same_gamma = shape->gamma == have->gamma || !ndf_has_gamma(o->class);
	struct ndf ndf;

	if (lobe->given ||
	    (shape->sigma == have->sigma && same_gamma && shape->stretch == have->stretch &&
	     shape->angle == have->angle && shape->tilt_x == have->tilt_x && shape->tilt_y == have->tilt_y))
		return STATUS_OK;
	const enum status status = shape_ndf(shape, o->class, o->options->lambda, &ndf);

	if (status != STATUS_OK)
		return status;
	tabulate_ndf(o, which, &ndf);
	lobe->tabulated = *shape;
	return STATUS_OK;
}

/* (1 - cos theta)^exponent, without cancellation where cot is large. */
static double grazing_of(double cot, const void *exponent)
{
	const double root = sqrt(1 + cot * cot);

	return pow(1 / (root * (root + cot)), *(const double *)exponent);
}

static enum status tabulate(struct objective *o, const struct shape *shape)
{
	enum status status = tabulate_lobe(o, 0, shape);

	if (status == STATUS_OK && has_term(o, TERM_SECOND)) {
		const struct shape second = shape_second(shape);

		status = tabulate_lobe(o, 1, &second);
	}
	if (has_term(o, TERM_GRAZING) && !o->table->scattered && shape->grazing != o->grazing_exponent) {
		masking_fill_function(&o->grazing, grazing_of, &shape->grazing, 0);
		o->grazing_exponent = shape->grazing;
	}
	return status;
}

/* F of a term: that of the shape, or the part that one of the three reflectances is the coefficient of. */
static double F_of_term(const struct objective *o, enum term term, int channel, double cos_d)
{
	double part[F82_PARTS];

	if (o->options->fresnel != FRESNEL_F82)
		return cook_torrance_F(&o->optics, channel, cos_d);
	fresnel_f82_parts(cos_d, part);
	return part[term - TERM_LOBE];
}

struct term_F {
	const struct objective *objective;
	enum term term;
	int channel;
};

static double F_at(const void *data, double cos_d)
{
	const struct term_F *of = data;

	return F_of_term(of->objective, of->term, of->channel, cos_d);
}

/* D F beyond this, a sigma below 1e-10, counts as this: times the largest geometric_factor, 1/(4 1e-9 1e-9), it is still a float. */
#define ROW_MAX 1e20

static void fill_row(const struct objective *o, enum term term, int channel, float row[MERL_ROWS])
{
	const struct halfdiff_trig *theta = o->table->geometry->entries.theta;
	const double *D = o->lobe[lobe_of(term)].D;
	float F[MERL_THETA_D];

	for (int j = 0; j < MERL_THETA_D; j++)
		F[j] = (float)(term == TERM_GRAZING ? theta[j].cos_d * theta[j].cos_d / M_PI
						    : F_of_term(o, term, channel, theta[j].cos_d));
	for (int i = 0; i < MERL_THETA_H; i++) {
		const float D_i = term == TERM_GRAZING ? 1 : (float)fmin(D[i], ROW_MAX);

		for (int j = 0; j < MERL_THETA_D; j++)
			row[j + MERL_THETA_D * i] = D_i * F[j];
	}
}

static void fill_rows(struct objective *o, const struct shape *shape)
{
	o->optics.gaf = o->options->criterion.gaf;
	o->optics.n = shape->ior;
	o->optics.k = shape->k;
	o->optics.fresnel = o->options->fresnel;
	o->optics.per_channel_ior = o->options->per_channel_ior;
	memcpy(o->optics.channel_n, shape->channel_ior, sizeof shape->channel_ior);
	memcpy(o->optics.channel_k, shape->channel_k, sizeof shape->channel_k);
	o->optics.grazing = shape->grazing;
	for (int a = 1; a < o->n_arrays; a++) {
		const struct term_F of = {o, term_of(o, a), channel_of(o, a)};

		if (!o->table->scattered)
			fill_row(o, of.term, of.channel, o->row[a]);
		else if ((!o->is_exact || o->lobe[0].given) && is_of_facets(of.term))
			scattered_lobe_F(&o->scattered[a], &o->table->range, F_at, &of);
	}
}

/* Beyond it a float would overflow. */
#define TERM_MAX 1e30

/* A term at a pair of directions, no table involved. */
static double exact_term(const struct objective *o, int array, struct vec3 wi, struct vec3 wo)
{
	const enum term term = term_of(o, array);
	double cos_d;

	if (term == TERM_GRAZING)
		return cook_torrance_grazing(o->optics.grazing, wi.z, wo.z,
					     fmin(0.5 * vec3_length(vec3_add(wi, wo)), 1));
	const double facets = cook_torrance_facets(&o->lobe[lobe_of(term)].exact, o->optics.gaf, wi, wo, &cos_d);

	return facets == 0 ? 0 : F_of_term(o, term, channel_of(o, array), cos_d) * facets;
}

static void exact_block(const struct objective *o, int array, int block, float *term)
{
	const struct sample_set *table = o->table;
	const struct scattered *scattered = table->scattered;
	const size_t from = (size_t)block * KERNEL_BLOCK;

	for (size_t n = from; n < from + KERNEL_BLOCK; n++) {
		const struct vec3 wi = scattered->wi[table->entry[n]], wo = scattered->wo[table->entry[n]];
		const double w = (double)table->w[n];

		term[n - from] = w > 0 ? (float)fmin(w * exact_term(o, array, wi, wo), TERM_MAX) : 0;
	}
}

static enum kernel_gaf kernel_gaf(const struct objective *o)
{
	static const enum kernel_gaf gaf[GAF_COUNT] = {[GAF_UNCORRELATED] = KERNEL_SEPARABLE,
						       [GAF_CORRELATED] = KERNEL_CORRELATED,
						       [GAF_V_GROOVE] = KERNEL_STATIC};

	return gaf[o->options->criterion.gaf];
}

static void table_block(const struct objective *o, int array, int block, float *s)
{
	const size_t at = (size_t)block * KERNEL_BLOCK;
	const enum term term = term_of(o, array);
	const bool grazing = term == TERM_GRAZING;
	const struct kernel_g1 g1 = masking_kernel(grazing ? &o->grazing : &o->lobe[lobe_of(term)].masking);
	struct kernel_samples samples = sample_set_block(o->table, block);

	if (grazing)
		samples.geometric_factor = o->table->w + at;
	o->kernel->lobe(grazing ? KERNEL_SUM : kernel_gaf(o), &g1, o->row[array], &samples, s);
}

void objective_term_block(const struct objective *o, int array, int block, float *term)
{
	if (!o->table->scattered) {
		table_block(o, array, block, term);
	} else if ((o->is_exact && !o->lobe[0].given) || term_of(o, array) == TERM_GRAZING) {
		exact_block(o, array, block, term);
	} else {
		const struct kernel_scattered samples = sample_set_scattered_block(o->table, block);

		o->kernel->lobe_scattered(kernel_gaf(o), &o->scattered[array].shape, &samples, term);
	}
}

static void lobe_block(const struct objective *o, int block)
{
	for (int a = 1; a < o->n_arrays; a++)
		objective_term_block(o, a, block, o->term[a] + (size_t)block * KERNEL_BLOCK);
}

int objective_slices(const struct objective *o)
{
	return o->options->gray ? 1 : MERL_CHANNELS;
}

/* What a pass is asked for each slice. */
struct evaluation {
	bool wanted[MERL_CHANNELS];
	struct kernel_evaluation at[MERL_CHANNELS];
};

static void pass_block(struct objective *o, const struct evaluation *asked, int block)
{
	const struct sample_set *t = o->table;
	const size_t at = (size_t)block * KERNEL_BLOCK;
	const int members = (block < t->n_pair_blocks ? 2 : 1) * MERL_CHANNELS / objective_slices(o);
	const float *term[KERNEL_TERMS] = {t->w + at};

	for (int c = 0; c < objective_slices(o); c++) {
		if (!asked->wanted[c])
			continue;
		for (int n = 1; n < o->terms.n; n++)
			term[n] = o->term[objective_array(o, n, c)] + at;
		o->kernel->pass(o->terms.n, members, sample_set_value(t, block, c), term, &asked->at[c],
				&o->sums[block][c]);
	}
}

/* The same of values that stand in the unit of a sample set. */
static struct evaluation in_unit(const struct objective *o, const struct evaluation *asked)
{
	struct evaluation own = *asked;

	for (int c = 0; c < objective_slices(o); c++) {
		for (int t = 0; t < o->terms.n; t++)
			own.at[c].x[t] *= o->table->unit;
		own.at[c].floor *= o->table->unit;
	}
	return own;
}

/* The sums of all blocks for one slice, added in their order: the result is the same to the bit for any number of threads. */
static struct kernel_sums add_blocks(const struct objective *o, int slice)
{
	const int second = o->terms.n * (o->terms.n + 1) / 2;
	struct kernel_sums total = {0};

	for (int block = 0; block < o->table->n_blocks; block++) {
		const struct kernel_sums *sums = &o->sums[block][slice];

		total.error += sums->error;
		for (int a = 0; a < o->terms.n; a++)
			total.slope[a] += sums->slope[a];
		for (int a = 0; a < second; a++)
			total.curvature[a] += sums->curvature[a];
	}
	total.error /= o->table->unit;
	for (int a = 0; a < second; a++)
		total.curvature[a] *= o->table->unit;
	return total;
}

/* One pass over the table; with `lobe`, the terms are computed on the way, while each block is in cache. Tasks, not a
 * parallel loop: on a busy machine this thread then does what the others do not come to, and never waits for one that
 * has not begun. */
static void pass(struct objective *o, const struct evaluation *wanted, bool lobe, struct kernel_sums total[])
{
	enum { CHUNK = 8 };
	const size_t n_blocks = (size_t)o->table->n_blocks;
	const struct evaluation own = in_unit(o, wanted), *asked = &own;

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
	for (int c = 0; c < objective_slices(o); c++)
		if (asked->wanted[c])
			total[c] = add_blocks(o, c);
}

enum status objective_tabulate(struct objective *o, const struct shape *shape)
{
	const enum status status = tabulate(o, shape);

	if (status == STATUS_OK)
		fill_rows(o, shape);
	return status;
}

enum status objective_lobe(struct objective *o, const struct shape *shape)
{
	const enum status status = objective_tabulate(o, shape);

	if (status != STATUS_OK)
		return status;
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

static double largest_coefficient(const struct fit_options *options, enum term term)
{
	if (term == TERM_DIFFUSE)
		return options->diffuse ? diffuse_value(objective_upper_bound(options, false)) : 0;
	if (term == TERM_GRAZING)
		return objective_upper_bound(options, false);
	return options->specular ? objective_upper_bound(options, true) : 0;
}

void objective_unfix(struct objective *o)
{
	for (int c = 0; c < MERL_CHANNELS; c++)
		for (int t = 0; t < o->terms.n; t++) {
			o->box[c].lo[t] = 0;
			o->box[c].hi[t] = largest_coefficient(o->options, o->terms.term[t]);
		}
}

static bool is_joint(const struct objective *o)
{
	return o->options->gray_specular;
}

void objective_fix(struct objective *o, int channel, bool specular, double value)
{
	const double at = specular ? (double)(float)value : diffuse_value(value);

	for (int c = 0; c < MERL_CHANNELS; c++)
		if (c == channel || o->options->gray || (specular && is_joint(o)))
			o->box[c].lo[specular] = o->box[c].hi[specular] = at;
}

static bool within_twice(double a, double b)
{
	return !(a > 2 * b) && !(b > 2 * a); /* NaN: a parameter that the model lacks */
}

static bool index_within_twice(double n_a, double k_a, double n_b, double k_b)
{
	return within_twice(hypot(n_a - 1, k_a), hypot(n_b - 1, k_b));
}

/* Whether the inner solve of one shape helps that of another. Second derivatives go with the square of the lobe: handed on
 * to a lobe far smaller, they make a Newton step that is far too short look like the last one. And the ks of a low lobe is
 * no place to begin where the lobe is so high that its own is 1e-8: the way there is too long for a quadratic model. */
static bool helps(const struct shape *a, const struct shape *b)
{
	bool near = within_twice(a->sigma, b->sigma) && within_twice(a->second_sigma, b->second_sigma) &&
		    index_within_twice(a->ior, a->k, b->ior, b->k);

	for (int c = 0; c < MERL_CHANNELS; c++)
		near &= index_within_twice(a->channel_ior[c], a->channel_k[c], b->channel_ior[c], b->channel_k[c]);
	return near;
}

/* The problems that a solve falls into: one a slice, or one for all where the slices share coefficients. */
static int n_problems(const struct objective *o)
{
	return is_joint(o) ? 1 : objective_slices(o);
}

/* The unknown of a problem that a slice's coefficient is. Where they share, kd of each channel comes first. */
static int unknown_of(const struct objective *o, int slice, int t)
{
	return !is_joint(o) ? t : t == 0 ? slice : MERL_CHANNELS - 1 + t;
}

static int n_unknowns(const struct objective *o)
{
	return o->terms.n + (is_joint(o) ? MERL_CHANNELS - 1 : 0);
}

/* The slices of a problem. */
static int first_slice(const struct objective *o, int p)
{
	return is_joint(o) ? 0 : p;
}

static int end_slice(const struct objective *o, int p)
{
	return is_joint(o) ? objective_slices(o) : p + 1;
}

static double sum_measured(const struct objective *o, int p)
{
	const double *sum = o->table->sum;

	return n_problems(o) == 1 ? sum[0] + sum[1] + sum[2] : sum[p];
}

/* The mean measurement of a problem. */
static double mean_measured(const struct objective *o, int p)
{
	return sum_measured(o, p) / (n_problems(o) == 1 ? MERL_CHANNELS : 1) / o->table->sum_w;
}

/* 0 <= F <= 1 where three reflectances in [0, 1] do not say so themselves, on either side of cos_d = 1/7. */
static void constrain_F(const struct objective *o, struct bundle_domain *domain, int first)
{
	static const double cos_d[] = {0.01, 0.03, 0.06, 0.1, 0.19, 0.25, 0.32, 0.42};

	for (size_t a = 0; a < sizeof cos_d / sizeof *cos_d; a++) {
		double part[F82_PARTS];

		fresnel_f82_parts(cos_d[a], part);
		for (int side = 0; side < 2; side++) {
			double *normal = domain->normal[domain->n_linear];

			memset(normal, 0, sizeof domain->normal[0]);
			for (int i = 0; i < F82_PARTS; i++)
				normal[first + i] = side ? part[i] : -part[i];
			domain->level[domain->n_linear++] = side ? objective_upper_bound(o->options, true) : 0;
		}
	}
}

/* Two lobes send back no more than one may. */
static void constrain_lobes(const struct objective *o, struct bundle_domain *domain, int first)
{
	double *normal = domain->normal[domain->n_linear];

	memset(normal, 0, sizeof domain->normal[0]);
	for (int t = 1; t < o->terms.n; t++)
		normal[first + t - 1] = o->terms.term[t] == TERM_LOBE || o->terms.term[t] == TERM_SECOND;
	domain->level[domain->n_linear++] = objective_upper_bound(o->options, true);
}

static struct bundle_domain domain_of(const struct objective *o, int p)
{
	struct bundle_domain domain = {.n = n_unknowns(o)};

	for (int c = first_slice(o, p); c < end_slice(o, p); c++)
		for (int t = 0; t < o->terms.n; t++) {
			domain.lo[unknown_of(o, c, t)] = o->box[c].lo[t];
			domain.hi[unknown_of(o, c, t)] = o->box[c].hi[t];
		}
	const int first = unknown_of(o, first_slice(o, p), 1);

	if (o->options->fresnel == FRESNEL_F82 && domain.hi[first + 1] > 0)
		constrain_F(o, &domain, first);
	if (has_term(o, TERM_SECOND) && !o->options->unbounded)
		constrain_lobes(o, &domain, first);
	return domain;
}

/* A solve that is to be this precise is one of a small step, relative: what the last one has learnt holds for it too. */
#define PRECISE 1e-5

static void start(const struct objective *o, const struct shape *shape, struct bundle problem[], double tolerance,
		  bool certify)
{
	const bool precise = tolerance < PRECISE;
	const bool afresh = o->start.error == 0 || (precise && !helps(&o->start.shape, shape));

	for (int p = 0; p < n_problems(o); p++) {
		const struct bundle_domain domain = domain_of(o, p);
		double known[BUNDLE_VARIABLES], largest = 0;
		bool at_zero = true;

		for (int c = first_slice(o, p); c < end_slice(o, p); c++)
			for (int t = 0; t < o->terms.n; t++)
				known[unknown_of(o, c, t)] = o->start.coefficient[c][t];
		for (int i = 0; i < domain.n; i++) {
			largest = fmax(largest, domain.hi[i]);
			at_zero &= domain.lo[i] == 0;
		}
		const double sum = sum_measured(o, p);
		const bool faint = sum > 0 && mean_measured(o, p) < BUNDLE_FAR * largest, cold = afresh || faint;

		bundle_start(&problem[p], &domain,
			     !cold     ? known
			     : at_zero ? NULL
				       : domain.lo,
			     !cold && precise ? o->start.h[p] : NULL, sum, tolerance, certify);
	}
}

/* On the bound to the last bit: kd is then the bound itself. */
static double kd_of(const struct objective *o, double diffuse)
{
	const double maximum = objective_upper_bound(o->options, false);

	return diffuse < diffuse_value(maximum) ? diffuse * M_PI : maximum;
}

static void finish(const struct objective *o, const struct bundle problem[], struct linear *linear)
{
	const double sum = o->table->sum[0] + o->table->sum[1] + o->table->sum[2];

	*linear = (struct linear){.error = 0};
	for (int c = 0; c < MERL_CHANNELS; c++) {
		const int slice = c < objective_slices(o) ? c : 0;
		const struct bundle *p = &problem[is_joint(o) ? 0 : slice];

		for (int t = 0; t < o->terms.n; t++)
			linear->coefficient[c][t] = p->best[unknown_of(o, slice, t)];
		linear->kd[c] = kd_of(o, linear->coefficient[c][0]);
	}
	for (int p = 0; p < n_problems(o); p++) {
		linear->channel[p] = problem[p].error / sum;
		linear->error += linear->channel[p];
		bundle_second(&problem[p], linear->h[p]);
		linear->lower_bound += problem[p].certify ? problem[p].lower_bound / sum : 0;
	}
}

/* A fiftieth of the mean measurement: below it, how near a residual is to 0 is decided by the data, not by the model. */
static double window_floor(const struct objective *o, int p)
{
	return 0.02 * mean_measured(o, p);
}

static void ask(const struct objective *o, const struct bundle problem[], struct evaluation *asked)
{
	for (int p = 0; p < n_problems(o); p++)
		for (int c = first_slice(o, p); c < end_slice(o, p); c++) {
			struct kernel_evaluation *at = &asked->at[c];

			asked->wanted[c] = !problem[p].done;
			at->tau = problem[p].tau;
			at->floor = window_floor(o, p);
			for (int t = 0; t < o->terms.n; t++)
				at->x[t] = problem[p].x[unknown_of(o, c, t)];
		}
}

/* The place of a second derivative, i <= j, among those of n unknowns. */
static int second_at(int n, int i, int j)
{
	return i * n - i * (i - 1) / 2 + j - i;
}

/* Hands a problem what its slices came to. */
static void update(const struct objective *o, int p, const struct kernel_sums total[], struct bundle *problem)
{
	double error = 0, slope[BUNDLE_VARIABLES] = {0}, second[BUNDLE_SECOND] = {0};

	for (int c = first_slice(o, p); c < end_slice(o, p); c++) {
		const double *curvature = total[c].curvature;

		error += total[c].error;
		for (int t = 0; t < o->terms.n; t++) {
			const int i = unknown_of(o, c, t);

			slope[i] += total[c].slope[t];
			for (int u = t; u < o->terms.n; u++)
				second[second_at(n_unknowns(o), i, unknown_of(o, c, u))] += *curvature++;
		}
	}
	bundle_update(problem, error, slope, second);
}

double objective_eval(struct objective *o, const struct shape *shape, double tolerance, bool certify,
		      struct linear *linear)
{
	struct bundle problem[MERL_CHANNELS];
	struct kernel_sums total[MERL_CHANNELS];
	bool lobe = true, going = true;

	if (objective_tabulate(o, shape) != STATUS_OK) {
		*linear = (struct linear){.error = OBJECTIVE_NO_FIT};
		return OBJECTIVE_NO_FIT;
	}
	start(o, shape, problem, tolerance, certify);
	while (going) {
		struct evaluation asked = {.wanted = {false}};

		ask(o, problem, &asked);
		pass(o, &asked, lobe, total);
		lobe = going = false;
		for (int p = 0; p < n_problems(o); p++) {
			if (!problem[p].done)
				update(o, p, total, &problem[p]);
			going |= !problem[p].done;
		}
	}
	finish(o, problem, linear);
	linear->shape = *shape;
	o->start = *linear;
	return linear->error;
}

double objective_error(struct objective *o, const struct shape *shape, const struct linear *linear)
{
	double error = 0, sum = 0;
	struct kernel_sums total[MERL_CHANNELS];
	struct evaluation asked = {.wanted = {false}};

	if (objective_tabulate(o, shape) != STATUS_OK)
		return OBJECTIVE_NO_FIT;
	for (int c = 0; c < objective_slices(o); c++) {
		asked.wanted[c] = true;
		memcpy(asked.at[c].x, linear->coefficient[c], sizeof asked.at[c].x);
	}
	pass(o, &asked, true, total);
	for (int c = 0; c < objective_slices(o); c++)
		error += total[c].error;
	for (int c = 0; c < MERL_CHANNELS; c++)
		sum += o->table->sum[c];
	return error / sum;
}

void linear_set_model(const struct linear *linear, const struct fit_options *options, struct cook_torrance *model)
{
	const struct term_list list = term_list_of(options);
	const bool f82 = options->specular && options->fresnel == FRESNEL_F82;

	for (int c = 0; c < MERL_CHANNELS; c++) {
		double value[TERM_COUNT] = {0};

		for (int t = 0; t < list.n; t++)
			value[list.term[t]] = linear->coefficient[c][t];
		model->kd[c] = linear->kd[c];
		model->kg[c] = value[TERM_GRAZING];
		model->ks_second[c] = value[TERM_SECOND];
		/* The three reflectances in units of the largest that F may be. */
		model->ks[c] = !f82 ? value[TERM_LOBE]
			       : options->unbounded
				       ? fmax(fmax(value[TERM_LOBE], value[TERM_F82]), fmax(value[TERM_F90], 1))
				       : objective_upper_bound(options, true);
		for (int i = 0; i < F82_PARTS && f82; i++)
			model->reflectance[c][i] = value[TERM_LOBE + i] / model->ks[c];
	}
}
