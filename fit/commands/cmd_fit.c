/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit fit - MERL files to a result table. */
#include "data_readers/atomic_file.h"
#include "data_readers/text_quote.h"
#include "fit/cli/messages.h"
#include "fit/cli/outputs.h"
#include "fit/cli/report.h"
#include "fit/cli/terminal.h"
#include "fit/commands/commands.h"
#include "fit/sources/batch.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct sink {
	const struct options *options;
	struct batch *batch;
	enum show show;
	bool stored; /* rows go to the store, too */
	struct store store;
	struct csv_table rows; /* all new rows, in order of the files */
	size_t next;           /* the file whose rows are shown next */
	bool headed;           /* standard output has its heading */
	bool broken;           /* writing failed */
	struct error error;    /* why */
};

static void show_rows(struct sink *sink, const struct csv_table *rows)
{
	if (sink->show == SHOW_READABLE) {
		report_fits(stdout, rows, !sink->headed && rows->n_rows, sink->batch->n_weights > 1);
		sink->headed |= rows->n_rows > 0;
	} else if (sink->show == SHOW_CSV) {
		for (size_t i = 0; i < rows->n_rows; i++)
			csv_write_row(stdout, rows->row[i], rows->n_columns);
	}
}

/* Shows and keeps the rows of all files that are done, up to the first that is not; `all`: past it, too. */
static bool advance(struct sink *sink, bool all)
{
	errno = 0;
	for (; sink->next < sink->batch->n; sink->next++) {
		struct batch_file *file = &sink->batch->file[sink->next];
		if (!file->done && !all)
			break;
		show_rows(sink, &file->rows);
		if (csv_table_move(&sink->rows, &file->rows) != STATUS_OK) {
			error_set(&sink->error, STATUS_NO_MEMORY, "out of memory");
			return false;
		}
	}
	if (!fflush(stdout) && !ferror(stdout))
		return true;
	/* A reader that has seen enough is told nothing. */
	if (terminal_reader_is_gone())
		sink->error.text[0] = '\0';
	else
		error_set(&sink->error, STATUS_IO, "cannot write standard output: %s", strerror(errno));
	return false;
}

static bool file_done(void *user, struct batch_file *file)
{
	struct sink *sink = user;
	if (sink->stored) {
		struct result_source source[WEIGHT_COUNT];
		batch_sources(sink->batch, file, source);
		store_drop_stale(&sink->store, source, sink->batch->n_weights);
		sink->broken = store_append(&sink->store, &file->rows, &sink->error) != STATUS_OK;
	}
	if (!sink->broken)
		sink->broken = !advance(sink, false);
	return !sink->broken;
}

/* The best of the rows of one file and weight, which begin at `start`; *end: the row behind them. */
static char *const *best_row(const struct csv_table *rows, size_t start, size_t *end)
{
	size_t best = start, i = start + 1;
	for (; i < rows->n_rows && !strcmp(rows->row[i][RESULT_PATH], rows->row[start][RESULT_PATH]) &&
	       !strcmp(rows->row[i][RESULT_WEIGHT], rows->row[start][RESULT_WEIGHT]);
	     i++)
		if (result_number(rows->row[i], RESULT_ERROR) < result_number(rows->row[best], RESULT_ERROR))
			best = i;
	*end = i;
	return rows->row[best];
}

/* Tells whoever sits before a terminal that the fits are likely to look wrong. */
static void hint_at_weight(const struct sink *sink)
{
	const struct csv_table *rows = &sink->rows;
	size_t n = 0, n_materials = 0;
	const char *first = NULL;
	for (int w = 0; w < sink->batch->n_weights; w++)
		if (sink->batch->weight[w] == WEIGHT_SOLID_ANGLE)
			return;
	for (size_t i = 0; i < rows->n_rows; n_materials++) {
		char *const *best = best_row(rows, i, &i);
		if (!result_looks_wrong(best))
			continue;
		first = first ? first : best[RESULT_MATERIAL];
		n++;
	}
	char name[TEXT_QUOTE_SIZE], others[64] = "";
	text_quote(first ? first : "", name, sizeof name);
	if (n > 1)
		snprintf(others, sizeof others, " and %zu more of %zu", n - 1, n_materials);
	if (n)
		report_error(
			"hint: with --weight solid-angle the pictures of '%s'%s would most likely look much more like "
			"the measured ones",
			name, others);
}

/* What is written when all files are done, or what could be done of them. */
static enum status finish(struct sink *sink, bool complete)
{
	if (!advance(sink, true))
		return STATUS_IO;
	if (sink->show == SHOW_JSON)
		report_json(stdout, &sink->rows);
	if (sink->options->json && sink->options->output && (sink->rows.n_rows || !sink->batch->n))
		return store_write(sink->options->output, &sink->rows, report_json, &sink->error);
	if (sink->stored && complete)
		return store_rewrite(&sink->store, &sink->rows, &sink->error);
	return STATUS_OK;
}

static int run(struct sink *sink, struct batch *batch)
{
	if (sink->options->json && sink->options->output &&
	    store_probe(sink->options->output, &sink->error) != STATUS_OK) {
		report_error("%s", sink->error.text);
		return EXIT_FAILED;
	}
	if (sink->stored &&
	    store_open(&sink->store, sink->options->output, sink->options->resume, &sink->error) != STATUS_OK) {
		report_error("%s", sink->error.text);
		return EXIT_FAILED;
	}
	if (sink->stored)
		batch->store = &sink->store;
	if (sink->stored && *sink->store.doubt.text)
		report_error("%s", sink->store.doubt.text);
	if (sink->show == SHOW_CSV)
		csv_write_header(stdout, result_columns, RESULT_COLUMNS);
	batch->done = file_done;
	batch->user = sink;
	int code = batch_run(batch);
	/* The table of an empty share is one, too. */
	if (!batch->n && sink->stored && store_begin(&sink->store, &sink->error) != STATUS_OK) {
		sink->broken = true;
		code = EXIT_FAILED;
	}
	if (!sink->broken && finish(sink, code != EXIT_INTERRUPTED) != STATUS_OK) {
		sink->broken = true;
		code = EXIT_FAILED;
	}
	if (sink->broken && sink->error.text[0])
		report_error("%s", sink->error.text);
	if (code != EXIT_INTERRUPTED && !sink->broken && !sink->options->quiet && isatty(STDERR_FILENO))
		hint_at_weight(sink);
	return code;
}

/* The courses of all searches, in the order of the files. When nothing was searched an older file stays as it is. */
static enum status write_trace(const struct batch *batch, struct atomic_file *file, struct error *error)
{
	const char *algorithm = algorithm_name(batch->options->fit.algorithm);
	bool any = false, incomplete = false;
	csv_write_header(file->stream, trace_columns, TRACE_COLUMNS);
	for (size_t i = 0; i < batch->n; i++) {
		char *material = result_material(batch->file[i].path);
		if (material)
			trace_write(file->stream, material, algorithm, &batch->file[i].trace);
		incomplete |= !material || batch->file[i].trace.incomplete;
		any |= batch->file[i].trace.n > 0;
		free(material);
	}
	if (any && !incomplete)
		return atomic_file_commit(file, error);
	atomic_file_abort(file);
	return incomplete ? error_set(error, STATUS_NO_MEMORY, "out of memory") : STATUS_OK;
}

static int run_traced(struct sink *sink, struct batch *batch)
{
	struct atomic_file file;
	struct error error;
	if (atomic_file_open(&file, sink->options->trace, &error) != STATUS_OK) {
		report_error("%s", error.text);
		return EXIT_FAILED;
	}
	const int code = run(sink, batch);
	if (write_trace(batch, &file, &error) == STATUS_OK)
		return code;
	report_error("%s", error.text);
	return code == EXIT_DONE ? EXIT_FAILED : code;
}

/* As files_collect(). Where a directory cannot be read, the list and so the shares would not be those that the others fit:
 * then there are none. */
static int collect(const struct options *options, struct files *files)
{
	const int bad = files_collect(files, options->path, options->n_paths, options->recursive, options->cancel);
	if (options->shard.n > 0 && bad > 0)
		files_free(files);
	return bad;
}

int cmd_fit(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	int code = options_parse(&options, COMMAND_FIT, argc, argv, cancel);
	if (code >= 0)
		return code;
	struct files files;
	const int bad = collect(&options, &files);
	struct batch batch;
	code = bad < 0 ? EXIT_FAILED : outputs_check(&options, files.path, files.n);
	if (options.shard.n && !bad)
		files_keep_shard(&files, options.shard);
	if (code >= 0 || batch_init(&batch, &options, &files) != STATUS_OK) {
		files_free(&files);
		return code >= 0 ? code : EXIT_FAILED;
	}
	struct sink sink = {.options = &options,
			    .batch = &batch,
			    .show = options_show(&options),
			    .stored = options.output && !options.json,
			    .rows = csv_table_make(result_columns, RESULT_COLUMNS)};
	const bool nothing = !files.n && (bad || !options.shard.n);
	code = *cancel         ? EXIT_INTERRUPTED
	       : nothing       ? EXIT_FAILED
	       : options.trace ? run_traced(&sink, &batch)
			       : run(&sink, &batch);
	if (code == EXIT_INTERRUPTED && sink.stored && !options.quiet)
		report_error("interrupted: the same command with --resume goes on");
	csv_table_free(&sink.rows);
	if (sink.stored)
		store_close(&sink.store);
	batch_free(&batch);
	files_free(&files);
	return code == EXIT_DONE && bad ? EXIT_FAILED : code;
}
