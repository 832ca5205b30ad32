/* SPDX-License-Identifier: GPL-3.0-or-later */
/* compare - the fits of several NDFs side by side: a line per material, then mean, median, worst and wins of all. */
#ifndef COMPARE_H
#define COMPARE_H

#include "fit/results/result.h"

/* Value columns: one error per NDF; two gains, or one distance above the floor per NDF; delta E and SSIM per NDF. */
enum { COMPARE_VALUES_MAX = 4 * FIT_NDFS_MAX + 2, COMPARE_NAME_SIZE = 64 };

/* struct compare_relation - a column that follows from two errors, in percent of the error of `over`: how much lower the
 * error of `of` is; where `above`, how much higher. */
struct compare_relation {
	const char *of, *over;
	bool above;
};

/* struct compare_picture - how a fit's picture differs from the measured one; NaN: no picture. */
struct compare_picture {
	double delta_e, ssim;
};

struct comparison {
	struct csv_table table;        /* what comes out: material, values with the winner behind the errors */
	int n_ndf;                     /* NDFs, in the order in which they come first */
	const char *ndf[FIT_NDFS_MAX]; /* names, borrowed from the rows */
	int n_relations;
	struct compare_relation relation[FIT_NDFS_MAX + 2];
	bool pictures;
	bool weights; /* rows of several weights: a column names that of the line, and each weight has its own summary */
	const char *weight; /* of the lines added last, borrowed from the rows; NULL: none yet */
	int n_values;       /* value columns */
	char name[COMPARE_VALUES_MAX][COMPARE_NAME_SIZE];
	struct csv_column column[COMPARE_VALUES_MAX + 3];
	double *value[COMPARE_VALUES_MAX]; /* column by column; one value per material, NaN: none */
	bool by_gain;      /* lines of a weight in the order of what STD gains over GGX, the most first, not of names */
	size_t first_line; /* of the weight whose lines are added */
	size_t n_materials;
	int wins[FIT_NDFS_MAX], ties;
};

/* comparison_init - finds the NDFs of the rows of a result table, which must outlive *c, and from them the columns. The rows
 * get reordered: those of one weight, material and path follow one another.
 * pictures: whether there are columns of picture errors. by_gain: of each weight, lines go by how much STD gains over GGX, not by
 * name; those without are last.
 * Errors: STATUS_UNSUPPORTED: more than FIT_NDFS_MAX NDFs; STATUS_NO_MEMORY. Call comparison_free() in any case. */
MUST_CHECK enum status comparison_init(struct comparison *c, struct csv_table *rows, bool pictures, bool by_gain,
				       struct error *error);
void comparison_free(struct comparison *c);

/* comparison_material_end - the row behind those that have the weight, the material and the path of row `start`. */
size_t comparison_material_end(const struct csv_table *rows, size_t start);

/* comparison_add - adds the line of n >= 1 rows of one material. Of several rows of one NDF the last counts.
 * picture: one per row; not read unless the comparison has pictures.
 * The winner is the NDF of the lowest error; "tie" when another has the same, "" when there is no error. The piecewise-linear
 * NDF wins only alone: it is no rival but the floor, what any isotropic NDF could reach.
 * STATUS_NO_MEMORY. At most one call per row given to comparison_init(). */
MUST_CHECK enum status comparison_add(struct comparison *c, char **const *rows, size_t n,
				      const struct compare_picture *picture);

/* comparison_end - adds mean, median, worst and wins of what was added, under the last weight: comparison_add() has added those
 * of the others when their lines ended. Values that are not there are left out; the worst of
 * gains and of SSIM is the least. To be called once, last. STATUS_NO_MEMORY. */
MUST_CHECK enum status comparison_end(struct comparison *c);

#endif
