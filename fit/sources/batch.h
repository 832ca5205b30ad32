/* SPDX-License-Identifier: GPL-3.0-or-later */
/* batch - fits many files, one per thread, while the next file is read ahead from the disk. */
#ifndef BATCH_H
#define BATCH_H

#include "fit/cli/files.h"
#include "fit/cli/options.h"
#include "fit/error/suspects.h"
#include "fit/results/store.h"
#include "fit/results/trace.h"

/* struct batch_file - one file and its result. */
struct batch_file {
	const char *path;
	char input[RESULT_INPUT_SIZE];       /* "" until it is read */
	struct suspects suspects;            /* what looks wrong with it; of a file that is fitted */
	char left_out[MEASUREMENT_LEFT_OUT]; /* samples of a file that is fitted which are not compared */
	char words[SUSPECTS_WORDS];          /* the same as a cell of its rows */
	bool unread;                         /* it could not be read at all: its bytes are unknown */
	struct csv_table rows;               /* new rows: none for NDFs that the store has, a failure's row per NDF */
	struct trace trace;                  /* if the options want one */
	bool done;                           /* false: not begun, or interrupted */
	bool kept;                           /* the store had all its rows */
	bool failed;
	struct error error; /* why it failed */
};

struct batch {
	const struct options *options;
	int n_weights; /* each file is fitted under each of them */
	enum weight weight[WEIGHT_COUNT];
	char *options_text[WEIGHT_COUNT]; /* of each weight, as in the rows */
	const struct store *store;        /* rows that need not be made again; may be NULL */
	struct batch_file *file;
	size_t n;
	/* Called in the thread of batch_run, once per file that is done, in the order in which they end; false stops
	 * all. */
	bool (*done)(void *user, struct batch_file *file);
	void *user;
};

/* batch_init - prepares the files of a command; batch_free releases them and their rows. STATUS_NO_MEMORY,
 * reported on standard error. */
MUST_CHECK enum status batch_init(struct batch *batch, const struct options *options, const struct files *files);
void batch_free(struct batch *batch);

/* batch_run - fits every file. A file that fails is reported on standard error. Returns the exit code: EXIT_DONE,
 * EXIT_FAILED (a file failed, done() returned false, no thread could be started), EXIT_INTERRUPTED. */
int batch_run(struct batch *batch);

/* batch_sources - the columns that identify a file in its rows, for each weight. */
void batch_sources(const struct batch *batch, const struct batch_file *file, struct result_source source[WEIGHT_COUNT]);

#endif
