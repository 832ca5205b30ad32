/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/quadrature.h"
#include <math.h>

enum { HALVINGS = 40 };

/* Abscissae of the 15-point rule; those of odd index are the 7-point rule's. */
static const double node[] = {0.99145537112081264, 0.94910791234275852, 0.86486442335976907, 0.74153118559939444,
			      0.58608723546769113, 0.40584515137739717, 0.20778495500789847, 0.0};
static const double weight15[] = {0.022935322010529225, 0.063092092629978553, 0.10479001032225018, 0.14065325971552592,
				  0.16900472663926790,  0.19035057806478541,  0.20443294007529889, 0.20948214108472783};
static const double weight7[] = {0.12948496616886969, 0.27970539148927667, 0.38183005050511894, 0.41795918367346939};

struct integrand {
	double (*f)(double x, void *params);
	void *params;
};

static double integrate(const struct integrand *g, double a, double b, double tolerance, int halvings)
{
	const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
	const double centre = g->f(middle, g->params);
	double sum15 = weight15[7] * centre, sum7 = weight7[3] * centre;
	for (int i = 0; i < 7; i++) {
		const double pair = g->f(middle - half * node[i], g->params) + g->f(middle + half * node[i], g->params);
		sum15 += weight15[i] * pair;
		if (i % 2 == 1)
			sum7 += weight7[i / 2] * pair;
	}
	if (!(half * fabs(sum15 - sum7) > tolerance) || halvings == 0)
		return half * sum15;
	return integrate(g, a, middle, 0.5 * tolerance, halvings - 1) +
	       integrate(g, middle, b, 0.5 * tolerance, halvings - 1);
}

double quadrature_adaptive(double (*f)(double x, void *params), void *params, double a, double b, double tolerance)
{
	const struct integrand g = {f, params};
	return a < b ? integrate(&g, a, b, tolerance, HALVINGS) : 0.0;
}
