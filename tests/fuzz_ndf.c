/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit ndf -: the first byte chooses the form of the output, the second the angle of the light; the rest is the table
 * of distributions on standard input. */
#include "fit/cli/command.h"
#include "fit/commands/commands.h"
#include "fit/sources/distribution_table.h"
#include "fuzz.h"
#include "json_check.h"

#include <math.h>

/* Each line is a message: one a row that describes nothing. */
static void check_messages(char *text)
{
	for (char *line = text, *end; *line; line = end) {
		end = strchr(line, '\n');
		PROMISE(end != NULL);
		const char first = *++end;
		*end = '\0';
		PROMISE(is_message(line));
		*end = first;
	}
}

static double number(const struct csv_table *table, size_t row, enum distribution_column column)
{
	double x = NAN;
	PROMISE(csv_parse_number(table->row[row][column], &x));
	return x;
}

/* A value that may be left out, and else is from 0 to `most`. */
static bool is_within(double x, double most)
{
	return isnan(x) || (x >= 0 && x <= most);
}

/* The table that was written is one, and its values are what their names promise. */
static void check_values(const uint8_t *bytes, size_t size)
{
	struct csv_table back = csv_table_make(distribution_columns, DISTRIBUTION_COLUMNS);
	struct error error;
	char path[FUZZ_PATH];
	const int fd = fuzz_file(bytes, size, path);
	PROMISE(csv_table_read(&back, path, DISTRIBUTION_COLUMNS, NULL, &error) == STATUS_OK);
	for (size_t i = 0; i < back.n_rows; i++) {
		PROMISE(is_within(number(&back, i, DISTRIBUTION_D), INFINITY));
		PROMISE(is_within(number(&back, i, DISTRIBUTION_P22), INFINITY));
		PROMISE(is_within(number(&back, i, DISTRIBUTION_P2), INFINITY));
		PROMISE(is_within(number(&back, i, DISTRIBUTION_G1), 1));
		PROMISE(is_within(number(&back, i, DISTRIBUTION_VISIBLE_PDF), INFINITY));
		PROMISE(is_within(number(&back, i, DISTRIBUTION_WEIGHT), INFINITY));
	}
	csv_table_free(&back);
	close(fd);
}

static void run(int argc, char **argv)
{
	atomic_bool cancel = false;
	struct capture out = capture_begin(stdout), err = capture_begin(stderr);
	const int code = cmd_ndf(argc, argv, &cancel);
	capture_end(&err, stderr);
	capture_end(&out, stdout);
	PROMISE(code == EXIT_DONE || code == EXIT_FAILED);
	PROMISE((code == EXIT_DONE) == (err.size == 0));
	check_messages(err.text);
	if (out.size > 0 && argc == 4)
		check_values((const uint8_t *)out.text, out.size);
	else if (out.size > 0 && !strcmp(argv[argc - 1], "--json"))
		PROMISE(json_is_valid(out.text));
	free(out.text);
	free(err.text);
}

int fuzz_ndf(const uint8_t *data, size_t size)
{
	static char name[] = "ndf", input[] = "-", light[] = "--theta-i", json[] = "--json", table[] = "--table";
	char angle[16], path[FUZZ_PATH];
	if (size < 2)
		return 0;
	snprintf(angle, sizeof angle, "%d", data[1] % 90);
	char *argv[] = {name, input, light, angle, data[0] % 4 == 1 ? json : data[0] % 4 == 2 ? table : NULL, NULL};
	const int fd = fuzz_file(data + 2, size - 2, path);
	const int real = dup(STDIN_FILENO);
	if (dup2(fd, STDIN_FILENO) < 0)
		abort();
	run(argv[4] ? 5 : 4, argv);
	if (real < 0 || dup2(real, STDIN_FILENO) < 0)
		close(STDIN_FILENO);
	if (real >= 0)
		close(real);
	close(fd);
	return 0;
}
