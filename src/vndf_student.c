/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/vndf_student.h"
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdbool.h>

/* Powers of x = 1/(1 + X^2) = exp(-w^2) at one |w|. */
struct point {
	double t;              /* |w| */
	double x, y;           /* y = 1 - x */
	double root_x, root_y; /* |X| = root_y / root_x */
	double power;          /* x^(p-1) */
};

static struct point point_at(double p, double t)
{
	const double root_x = exp(-0.5 * t * t);
	const double y = -expm1(-t * t);
	return (struct point){t, root_x * root_x, y, root_x, sqrt(y), exp(-(p - 1.0) * t * t)};
}

/* 2F1(1, p; 3/2; y), all terms positive. */
static double body_series(double p, double y)
{
	double term = 1.0, sum = 1.0;
	for (int i = 0; term > 0x1p-54 * sum; i++) {
		term *= y * (p + i) / (1.5 + i);
		sum += term;
	}
	return sum;
}

/* 2F1(q, 1/2; q + 1; x), all terms positive. */
static double tail_series(double q, double x)
{
	double power = 1.0, term = 1.0, sum = 1.0;
	for (int i = 1; term > 0x1p-54 * sum; i++) {
		power *= x * (i - 0.5) / i;
		term = power * q / (q + i);
		sum += term;
	}
	return sum;
}

/* 2F1(1, q + 1/2; q + 1; x), the even part of Gauss's continued fraction, from the tail forward. */
static double tail_fraction(double q, double x, double y, int steps)
{
	double tail = 0.0;
	for (int i = steps; i > 0; i--) {
		const double m = i;
		const double A = q + 2.0 * m;
		const double b = (q * (2.0 * m + 0.5) + 2.0 * m * m - 0.5) / ((A - 1.0) * (A + 1.0)) +
				 y * (m * (m - 0.5) / ((A - 1.0) * A) + (q + m) * (q + m + 0.5) / (A * (A + 1.0)));
		const double r = (q + m - 1.0) * (q + m - 0.5) * m * (m - 0.5) * (x * x) /
				 ((A - 2.0) * (A - 1.0) * (A - 1.0) * A);
		tail = r / (b - tail);
	}
	return 1.0 / ((0.5 + (q + 0.5) * y) / (q + 1.0) - tail);
}

/* Q = int over t > |X| of k (1 + t^2)^-p dt, by whichever of three expansions is short there. */
static double upper_tail(const struct student *student, const struct point *at)
{
	const double q = student->p - 0.5;
	const double front = student->k * at->power * at->root_x; /* k x^q */
	if (at->x < 0.5)
		return 0.5 * front / q * tail_series(q, at->x);
	const double z2 = q * at->y / at->x;
	if (z2 < 4.0)
		return 0.5 - front * at->root_y * body_series(student->p, at->y);
	return 0.5 * front * at->root_y / q * tail_fraction(q, at->x, at->y, 6 + (int)(90.0 / z2));
}

/* int over t > |X| of t k (1 + t^2)^-p dt */
static double upper_moment(const struct student *student, const struct point *at)
{
	return 0.5 * student->k * at->power / (student->p - 1.0);
}

/* The half of the distribution on one side of X = 0, as a function of t = |w|. */
struct side {
	const struct student *student;
	double sign;      /* of s in the weight: +1 for X < 0, -1 for X > 0 */
	double excess;    /* 0 for X < 0; else int over X > c/s of (s X - c) k (1 + X^2)^-p dX */
	double slope_max; /* X at which the weight ends; infinite for X < 0 */
	double t_max;     /* and its t */
	double t_min;     /* where the weight begins: 0 but for c < 0 */
	double target;    /* mass to be left beyond t, not normalised */
};

/* Seen mass beyond t. Close to the end of the weight, where the terms cancel, that of a linear weight. */
static double side_mass(const struct side *side, const struct point *at)
{
	const struct student *s = side->student;
	if (isfinite(side->slope_max)) {
		const double X = at->root_y / at->root_x;
		const double left = side->slope_max - X;
		if (left * (sqrt(s->p) + 2.0 * s->p * X * at->x) < 1e-6)
			return left > 0.0 ? 0.5 * s->s * left * left * s->k * at->power * at->x : 0.0;
	}
	const double moment = s->s > 0.0 ? s->s * upper_moment(s, at) : 0.0;
	return s->c * upper_tail(s, at) + side->sign * moment + side->excess;
}

/* One step of Halley's method for ln(mass beyond t) = ln(target), which is concave in t: Newton's iterates would come
 * from above after the first. *error has the sign of that step. */
static double side_step(const struct side *side, double t, double *error)
{
	const struct student *s = side->student;
	const struct point at = point_at(s->p, t);
	const double weight = s->c * at.root_x + side->sign * s->s * at.root_y;
	const double mass = side_mass(side, &at);
	const double t_over_y = t > 0.0 ? t / at.root_y : 1.0;
	const double density = s->k * t_over_y * at.power * weight;
	*error = mass > 0.0 ? log(mass / side->target) : -INFINITY;
	if (!(mass > 0.0 && density > 0.0))
		return INFINITY; /* nowhere: halve the interval */
	const double newton = *error * mass / density;
	const double curvature = (t < 0.03 ? 0.5 * t : 1.0 / t - t * at.x / at.y) - 2.0 * (s->p - 1.0) * t +
				 t_over_y * at.root_x * (side->sign * s->s * at.root_x - s->c * at.root_y) / weight +
				 density / mass;
	const double halley = 1.0 + 0.5 * newton * curvature;
	return halley > 0.5 && halley < 2.0 ? newton / halley : newton;
}

/* Cubic convergence: after a step of 1e-5 standard deviations the next would be some 1e-16. */
static double side_solve(const struct side *side, double t)
{
	const double done = 1e-5 / sqrt(side->student->p);
	double low = side->t_min, high = side->t_max;
	for (int i = 0; i < 100; i++) {
		double error;
		const double step = side_step(side, t, &error);
		if (error > 0.0)
			low = t;
		else
			high = t; /* also where there is no mass: error is -infinity */
		const double next = t + step;
		if (next >= low && next <= high && fabs(step) <= done)
			return next;
		t = next >= low && next <= high ? next : isinf(high) ? 2.0 * low + 1.0 : 0.5 * (low + high);
	}
	return t;
}

/* |w| of the plain distribution beyond which the mass is m < 1/2: w is nearly a normal deviate n. Its density
 * k exp(-(p - 3/4) w^2 - w^4/48 + ...) gives n = r w (1 + b w^2 + ...), r = k sqrt(2 pi). */
static double plain_guess(const struct student *student, double m)
{
	if (!(m < 0.5))
		return 0.0;
	const double p = student->p;
	const double r = student->k * sqrt(2.0 * M_PI);
	const double b = (0.5 * r * r - p + 0.75) / 3.0;
	const double w = gsl_cdf_ugaussian_Qinv(m) / r;
	return w / (1.0 + b * w * w);
}

static double left_quantile(const struct student *student, double target, double moment)
{
	const struct side side = {student, 1.0, 0.0, INFINITY, INFINITY, 0.0, target};
	/* Either part of the mass alone gives a lower bound. */
	const double by_tail = plain_guess(student, target / student->c);
	const double by_moment = target < moment ? sqrt(log(moment / target) / (student->p - 1.0)) : 0.0;
	return side_solve(&side, fmax(by_tail, by_moment));
}

static double right_quantile(const struct student *student, struct side *side, double rest)
{
	const double by_end = side->t_max * (1.0 - sqrt(rest));
	return side_solve(side, fmin(by_end, plain_guess(student, side->target / student->c)));
}

static double t_of_slope(double slope)
{
	return slope < 1e150 ? sqrt(log1p(slope * slope)) : sqrt(2.0 * log(slope));
}

/* c < 0: only X < c/s is seen. */
static double quantile_below(const struct student *student, double u)
{
	const double t_min = t_of_slope(-student->c / student->s);
	struct side side = {student, 1.0, 0.0, INFINITY, INFINITY, t_min, 0.0};
	const struct point end = point_at(student->p, t_min);
	const double total = side_mass(&side, &end);
	if (!(total > 0.0))
		return t_min;
	side.target = u * total;
	/* Lower bounds: all of the tail falls as the moment; the density begins as a straight line. */
	const double by_moment = sqrt(t_min * t_min - log(u) / (student->p - 1.0));
	const double t_over_y = t_min / end.root_y;
	const double by_line =
		t_min + sqrt(2.0 * (1.0 - u) * total / (student->k * student->s * t_over_y * t_over_y * end.power));
	return side_solve(&side, fmax(by_moment, by_line));
}

/* What is seen on the right, moment, total: the masses of the whole. */
struct masses {
	struct side right;
	double moment, total;
};

static struct masses masses_of(const struct student *student)
{
	const double slope_max = student->s > 0.0 ? student->c / student->s : INFINITY;
	const double t_max = t_of_slope(slope_max);
	struct masses masses = {.right = {student, -1.0, 0.0, slope_max, t_max, 0.0, 0.0}};
	if (student->s > 0.0) {
		const struct point end = point_at(student->p, t_max);
		masses.moment = 0.5 * student->s * student->k / (student->p - 1.0);
		masses.right.excess = student->s * upper_moment(student, &end) - student->c * upper_tail(student, &end);
	}
	masses.total = student->c + masses.right.excess;
	return masses;
}

double student_quantile(const struct student *student, double u)
{
	if (student->c < 0.0)
		return -quantile_below(student, u);
	struct masses masses = masses_of(student);
	const double total = masses.total, middle = 0.5 * student->c + masses.moment;
	if (u * total <= middle)
		return -left_quantile(student, u * total, masses.moment);
	masses.right.target = (1.0 - u) * total;
	/* Of a weight that ends close to 0 rounding leaves nothing on that side. */
	const double half = total - middle;
	return right_quantile(student, &masses.right, masses.right.target < half ? masses.right.target / half : 1.0);
}

double student_cdf(const struct student *student, double X)
{
	const struct masses masses = masses_of(student);
	const struct point at = point_at(student->p, t_of_slope(fabs(X)));
	if (X > 0.0)
		return X < masses.right.slope_max ? 1.0 - side_mass(&masses.right, &at) / masses.total : 1.0;
	const struct side left = {student, 1.0, 0.0, INFINITY, INFINITY, 0.0, 0.0};
	return side_mass(&left, &at) / masses.total;
}
