/* SPDX-License-Identifier: GPL-3.0-or-later */
/* check - what the test programs share: comparisons that say what was wrong, and rows of reference values.
 * Programs run from the top of the repository. */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* What cmocka does not say: a failure leaves the test. */
void _fail(const char *file, int line) __attribute__((noreturn));

/* check_rel - fails unless |got - want| <= tol |want|. Two NaNs, or two equal infinities, are equal. */
static inline void check_rel(double got, double want, double tol, const char *label)
{
	if (got == want || (isnan(got) && isnan(want)))
		return;
	const double error = fabs(got - want) / fabs(want);
	if (!(error <= tol))
		fail_msg("%s: got %.17g, expected %.17g, relative error %.3g > %.3g", label, got, want, error, tol);
}

/* check_abs - fails unless |got - want| <= tol. Two NaNs, or two equal infinities, are equal. */
static inline void check_abs(double got, double want, double tol, const char *label)
{
	if (got == want || (isnan(got) && isnan(want)))
		return;
	const double error = fabs(got - want);
	if (!(error <= tol))
		fail_msg("%s: got %.17g, expected %.17g, error %.3g > %.3g", label, got, want, error, tol);
}

/* long_double_is_wide - whether long double holds more digits than double here and now: not so on some machines,
 * nor under valgrind. */
static inline bool long_double_is_wide(void)
{
	volatile long double one = 1.0L;
	return one + 0x1p-60L > one;
}

/* check_between - fails unless low <= got <= high. */
static inline void check_between(double got, double low, double high, const char *label)
{
	if (!(got >= low && got <= high))
		fail_msg("%s: got %.17g, expected a value in [%.17g, %.17g]", label, got, low, high);
}

/* skip_for_want_of - ends a test that cannot run without a Debian package which the machine lacks; skip_because - or for
 * another reason. run_tests.sh counts these lines: a test that is skipped without one is a failure. */
static inline void skip_for_want_of(const char *package)
{
	print_message("skipped for want of %s\n", package);
	skip();
}

static inline void skip_because(const char *reason)
{
	print_message("skipped because %s\n", reason);
	skip();
}

/* case_step - for a test that goes through many cases of one kind: 1, to take all of them, when `make check-long` is running;
 * else `step`, to take every step-th. */
static inline size_t case_step(size_t step)
{
	const char *set = getenv("STDFIT_LONG");

	return set && *set == '1' ? 1 : step;
}

enum { GOLDEN_FIELDS = 16 };

/* struct golden - a CSV of reference values: lines of comment starting with '#', a line of names, rows. */
struct golden {
	FILE *file;
	const char *path;
	int line_number, rows, n_fields;
	char line[1024];
	const char *text[GOLDEN_FIELDS]; /* fields of the current row, */
	double value[GOLDEN_FIELDS];     /* and as numbers; NaN where it is none */
	char label[256];                 /* "path:line", for messages */
};

static inline bool golden_line(struct golden *golden)
{
	do {
		if (!fgets(golden->line, sizeof(golden->line), golden->file))
			return false;
		golden->line_number++;
	} while (golden->line[0] == '#');
	golden->line[strcspn(golden->line, "\r\n")] = '\0';
	return true;
}

/* golden_open - opens a table, whose line of names has to be `names`. */
static inline struct golden golden_open(const char *path, const char *names)
{
	struct golden golden = {.file = fopen(path, "r"), .path = path};
	if (!golden.file)
		fail_msg("%s: cannot be opened: run this from the top of the repository", path);
	if (!golden_line(&golden) || strcmp(golden.line, names) != 0)
		fail_msg("%s: names are '%s', expected '%s'", path, golden.line, names);
	for (const char *c = names; *c; c++)
		golden.n_fields += *c == ',';
	golden.n_fields++;
	assert_in_range(golden.n_fields, 1, GOLDEN_FIELDS);
	return golden;
}

/* golden_next - reads the next row; at the end closes the file and returns false. A table without rows fails. */
static inline bool golden_next(struct golden *golden)
{
	if (!golden_line(golden)) {
		fclose(golden->file);
		if (golden->rows == 0)
			fail_msg("%s: no rows", golden->path);
		return false;
	}
	golden->rows++;
	snprintf(golden->label, sizeof(golden->label), "%s:%d", golden->path, golden->line_number);
	char *field = golden->line;
	for (int i = 0; i < golden->n_fields; i++) {
		if (!field)
			fail_msg("%s: %d fields, expected %d", golden->label, i, golden->n_fields);
		char *comma = strchr(field, ',');
		if (comma)
			*comma = '\0';
		char *rest;
		golden->text[i] = field;
		golden->value[i] = strtod(field, &rest);
		if (rest == field || *rest)
			golden->value[i] = NAN;
		field = comma ? comma + 1 : NULL;
	}
	return true;
}

#endif
