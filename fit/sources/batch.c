/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/batch.h"
#include "data_readers/measurement_read.h"
#include "data_readers/text_quote.h"
#include "fit/cli/messages.h"
#include "fit/cli/progress.h"
#include "fit/cli/text_stream.h"
#include "fit/search/within.h"

#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum {
	TICK_MS = 150, /* how often the progress line is drawn and Ctrl-C checked for, while nothing else happens */
	CONTEXTS = 3,  /* scattered entries, 180 and 360 along phi_d */
	CONTEXT_PHI = 180,
};

/* What the threads of a run share. */
struct run {
	const struct batch *batch;
	int threads_per_fit;
	pthread_mutex_t lock;         /* of all below */
	pthread_cond_t ended;         /* a file or a thread did */
	size_t next;                  /* the next file to fit */
	size_t *finished, n_finished; /* files in the order in which they ended */
	int running;                  /* threads */
	struct fit_context *context[WEIGHT_COUNT][BINS_COUNT][CONTEXTS];
};

enum status batch_init(struct batch *batch, const struct options *options, const struct files *files)
{
	*batch = (struct batch){.options = options,
				.n = files->n,
				.n_weights = options->n_weights ? options->n_weights : 1,
				.weight = {options->fit.criterion.weight}};
	batch->file = calloc(files->n + 1, sizeof(*batch->file));
	bool texts = true;
	for (int w = 0; w < batch->n_weights; w++) {
		if (options->n_weights)
			batch->weight[w] = options->weight[w];
		batch->options_text[w] = options_text(options, batch->weight[w]);
		texts &= batch->options_text[w] != NULL;
	}
	if (!batch->file || !texts) {
		report_error("out of memory");
		batch_free(batch);
		return STATUS_NO_MEMORY;
	}
	for (size_t i = 0; i < files->n; i++) {
		batch->file[i].path = files->path[i];
		batch->file[i].rows = csv_table_make(result_columns, RESULT_COLUMNS);
	}
	return STATUS_OK;
}

void batch_free(struct batch *batch)
{
	for (size_t i = 0; batch->file && i < batch->n; i++) {
		csv_table_free(&batch->file[i].rows);
		trace_free(&batch->file[i].trace);
	}
	free(batch->file);
	for (int w = 0; w < batch->n_weights; w++)
		free(batch->options_text[w]);
	*batch = (struct batch){0};
}

static struct result_source batch_source(const struct batch *batch, const struct batch_file *file, int weight)
{
	return (struct result_source){.path = file->path,
				      .input = file->unread ? NULL : file->input,
				      .options = batch->options_text[weight],
				      .suspects = file->words};
}

void batch_sources(const struct batch *batch, const struct batch_file *file, struct result_source source[WEIGHT_COUNT])
{
	for (int w = 0; w < batch->n_weights; w++)
		source[w] = batch_source(batch, file, w);
}

/* The context for this weight, these bins and this kind of table, made by the first thread that needs it. */
static enum status get_context(struct run *run, int n_phi_d, const struct fit_options *fit,
			       const struct fit_context **context)
{
	struct fit_context **shared = &run->context[fit->criterion.weight][fit->criterion.bins][n_phi_d / CONTEXT_PHI];
	enum status status = STATUS_OK;
	pthread_mutex_lock(&run->lock);
	if (!*shared)
		status = fit_context_new(shared, n_phi_d, fit);
	*context = *shared;
	pthread_mutex_unlock(&run->lock);
	return status;
}

/* Leaves only the NDFs for which the store has no row. With --within it has a row of one of them. */
static void drop_known(const struct batch *batch, const struct result_source *source, struct fit_options *fit)
{
	const bool within = !isnan(batch->options->within);
	int kept = 0;
	for (int i = 0; i < fit->n_ndf; i++)
		if (!store_has(batch->store, source, within ? NULL : ndf_name(fit->ndf[i])))
			fit->ndf[kept++] = fit->ndf[i];
	fit->n_ndf = kept;
}

/* The options as asked for, and which terms --within has left out or put in. Owned; NULL when out of memory. */
static char *chosen_text(const char *asked, const struct fit_options *all, const struct fit_options *chosen)
{
	const struct {
		bool is;
		const char *word;
	} change[] = {
		{chosen->gray && !all->gray, "gray"},
		{chosen->gray_specular && !all->gray_specular, "gray-specular"},
		{!chosen->diffuse && all->diffuse, "no-diffuse"},
		{!chosen->specular && all->specular, "no-specular"},
		{chosen->specular && chosen->fresnel != all->fresnel && chosen->fresnel == FRESNEL_NONE, "no-fresnel"},
		{chosen->specular && chosen->fresnel != all->fresnel && chosen->fresnel == FRESNEL_F82, "f82"},
		{chosen->grazing && !all->grazing, "burley"},
		{!chosen->grazing && all->grazing, "lambert"},
		{chosen->specular && chosen->lobes > all->lobes, "two-lobes"},
		{chosen->specular && chosen->lobes < all->lobes, "one-lobe"},
		{chosen->specular && !chosen->anisotropic && all->anisotropic, "isotropic"}};
	struct text_stream stream;
	const char *between = RESULT_CHOSEN;
	if (!text_stream_open(&stream))
		return NULL;
	fputs(asked, stream.file);
	for (size_t i = 0; i < sizeof change / sizeof *change; i++)
		if (change[i].is) {
			fprintf(stream.file, "%s%s", between, change[i].word);
			between = "+";
		}
	return text_stream_close(&stream);
}

/* within_run(), and in *source the options that say what it chose: *text, to be freed. */
static enum status fit_within(const struct fit_context *context, const struct measurement *measurement,
			      const struct options *options, struct fit_options *fit, struct fit_result *result,
			      struct result_source *source, char **text, struct error *error)
{
	const struct fit_options all = *fit;
	const unsigned richer = (options_given(options, "diffuse") ? 0u : WITHIN_BURLEY) |
				(options_given(options, "fresnel") ? 0u : WITHIN_F82) |
				(options_given(options, "lobes") ? 0u : WITHIN_TWO_LOBES);
	const enum status status = within_run(context, measurement, fit, richer, options->within, fit, result, error);
	if (status != STATUS_OK)
		return status;
	*text = chosen_text(source->options, &all, fit);
	if (*text) {
		source->options = *text;
		return STATUS_OK;
	}
	for (int i = 0; i < fit->n_ndf; i++)
		fit_result_free(&result[i]);
	return error_set(error, STATUS_NO_MEMORY, "out of memory");
}

/* The same fits with entries at the centres of the bins. */
static enum status fit_centres(struct run *run, const struct measurement *measurement, const struct fit_options *fit,
			       struct fit_result *result, struct fit_result *centre, struct error *error)
{
	const struct fit_context *context;
	struct fit_options other = *fit;
	other.criterion.bins = BINS_CENTRE;
	other.trace = NULL;
	enum status status = get_context(run, measurement->n_phi_d, &other, &context);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	status = fit_run(context, measurement, &other, centre, error);
	for (int i = 0; i < fit->n_ndf && status == STATUS_OK; i++) {
		result[i].other_bins = &centre[i];
		result[i].evaluations += centre[i].evaluations;
		result[i].seconds += centre[i].seconds;
	}
	return status;
}

/* What only the fits can tell of the data. */
static void note_correlated(struct batch_file *file, const struct fit_result result[], int n)
{
	for (int i = 0; i < n; i++)
		if (!isnan(result[i].error_correlated)) {
			file->suspects.found |= SUSPECT_CORRELATED;
			file->suspects.correlated = result[i].error_correlated;
			suspects_words(&file->suspects, file->words);
		}
}

/* Fits what *fit asks for under weight w. */
static enum status fit_samples(struct run *run, struct batch_file *file, const struct measurement *measurement, int w,
			       struct fit_options *fit)
{
	const struct options *options = run->batch->options;
	struct result_source source = batch_source(run->batch, file, w);
	const struct fit_context *context;
	struct fit_result result[FIT_NDFS_MAX], centre[FIT_NDFS_MAX];
	char *text = NULL;
	enum status status = get_context(run, measurement->n_phi_d, fit, &context);
	if (status != STATUS_OK)
		return error_set(&file->error, status, "%s", status_str(status));
	if (!isnan(options->within))
		status = fit_within(context, measurement, options, fit, result, &source, &text, &file->error);
	else
		status = fit_run(context, measurement, fit, result, &file->error);
	if (status != STATUS_OK)
		return status;
	note_correlated(file, result, fit->n_ndf);
	if (!isnan(options->intervals) && fit->specular)
		status = fit_intervals(context, measurement, fit, options->intervals, result, &file->error);
	if (status == STATUS_OK && options->both_bins && !measurement->scattered)
		status = fit_centres(run, measurement, fit, result, centre, &file->error);
	for (int i = 0; i < fit->n_ndf; i++) {
		if (status == STATUS_OK && result_add(&file->rows, &source, fit, &result[i]) != STATUS_OK)
			status = error_set(&file->error, STATUS_NO_MEMORY, "out of memory");
		if (result[i].other_bins)
			fit_result_free(&centre[i]);
		fit_result_free(&result[i]);
	}
	free(text);
	return status;
}

/* The fit of a file under weight w, without the NDFs that the store has. */
static struct fit_options options_under(const struct run *run, const struct batch_file *file, int w)
{
	struct fit_options fit = run->batch->options->fit;
	const struct result_source source = batch_source(run->batch, file, w);
	fit.criterion.weight = run->batch->weight[w];
	fit.threads = run->threads_per_fit;
	if (run->batch->store)
		drop_known(run->batch, &source, &fit);
	return fit;
}

/* What looks wrong with a file is found where there is something to fit. */
static enum status look_at(const struct run *run, struct batch_file *file, const struct measurement *measurement)
{
	const struct options *options = run->batch->options;
	const enum status status = suspects_find(measurement, &options->fit.criterion, &file->suspects);
	if (status != STATUS_OK)
		return error_set(&file->error, status, "%s", status_str(status));
	suspects_words(&file->suspects, file->words);
	measurement_left_out(measurement, LEFT_OUT_VALUES, options->gamut == GAMUT_MASK, file->left_out);
	return STATUS_OK;
}

/* Fits a file that has been read under each weight, as far as the store has no rows. */
static enum status fit_measurement(struct run *run, struct batch_file *file, const struct measurement *measurement)
{
	const struct batch *batch = run->batch;
	enum status status = STATUS_OK;
	file->kept = true;
	for (int w = 0; w < batch->n_weights && status == STATUS_OK; w++) {
		struct fit_options fit = options_under(run, file, w);
		if (fit.n_ndf == 0)
			continue;
		if (file->kept)
			status = look_at(run, file, measurement);
		file->kept = false;
		if (status != STATUS_OK)
			break;
		if (batch->options->trace) {
			fit.trace = trace_note;
			fit.trace_data = &file->trace;
		}
		status = fit_samples(run, file, measurement, w, &fit);
	}
	return status;
}

/* Rows that say why there is no fit. A disk that is unavailable for a while must not replace earlier fits. */
static void add_failures(const struct run *run, struct batch_file *file)
{
	enum status status = STATUS_OK;
	csv_table_free(&file->rows);
	for (int w = 0; w < run->batch->n_weights && status == STATUS_OK; w++) {
		const struct fit_options fit = options_under(run, file, w);
		const struct result_source source = batch_source(run->batch, file, w);
		status = result_add_failure(&file->rows, &source, &fit, file->error.text);
	}
	if (status != STATUS_OK)
		csv_table_free(&file->rows); /* no memory for a row; the message is still reported */
}

/* Reads and fits one file. Returns STATUS_INTERRUPTED or, with everything in *file, STATUS_OK. */
static enum status process(struct run *run, struct batch_file *file)
{
	struct measurement measurement;
	const struct read_options reading = options_reading(run->batch->options, run->threads_per_fit);
	enum status status = measurement_read(file->path, &reading, &measurement, &file->error);
	file->unread = status == STATUS_IO || status == STATUS_NO_MEMORY;
	if (status == STATUS_OK) {
		result_input(file->input, &measurement);
		status = fit_measurement(run, file, &measurement);
		measurement_free(&measurement);
		if (status != STATUS_OK && status != STATUS_INTERRUPTED) {
			char name[TEXT_QUOTE_SIZE];
			const struct error why = file->error;
			text_quote(file->path, name, sizeof name);
			error_set(&file->error, status, "cannot fit '%s': %.200s", name, why.text);
		}
	}
	if (status == STATUS_INTERRUPTED)
		return status;
	file->failed = status != STATUS_OK;
	if (file->failed)
		add_failures(run, file);
	return STATUS_OK;
}

/* Has the system read the file that comes next while this one is fitted. */
static void read_ahead(const char *path)
{
	const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
	if (fd < 0)
		return;
	posix_fadvise(fd, 0, 0, POSIX_FADV_WILLNEED);
	close(fd);
}

static void *work(void *argument)
{
	struct run *run = argument;
	const struct batch *batch = run->batch;
	pthread_mutex_lock(&run->lock);
	while (run->next < batch->n && !*batch->options->cancel) {
		const size_t i = run->next++;
		const char *upcoming = run->next < batch->n ? batch->file[run->next].path : NULL;
		pthread_mutex_unlock(&run->lock);
		if (upcoming)
			read_ahead(upcoming);
		const enum status status = process(run, &batch->file[i]);
		pthread_mutex_lock(&run->lock);
		if (status == STATUS_OK)
			run->finished[run->n_finished++] = i;
		pthread_cond_signal(&run->ended);
	}
	run->running--;
	pthread_cond_signal(&run->ended);
	pthread_mutex_unlock(&run->lock);
	return NULL;
}

/* What the file has that the fit cannot use, and what looks wrong with the rest. */
static void report_suspects(const struct batch_file *file, bool quiet)
{
	char name[TEXT_QUOTE_SIZE];
	text_quote(file->path, name, sizeof name);
	if (file->left_out[0] && !quiet)
		report_error("'%s': left out: %s", name, file->left_out);
	if (file->suspects.found) {
		char text[SUSPECTS_TEXT];
		report_error("'%s' looks wrong: %s", name, suspects_explain(&file->suspects, text));
	}
}

static void wait_a_tick(struct run *run)
{
	struct timespec until;
	clock_gettime(CLOCK_REALTIME, &until);
	until.tv_nsec += TICK_MS * 1000000L;
	until.tv_sec += until.tv_nsec / 1000000000L;
	until.tv_nsec %= 1000000000L;
	pthread_cond_timedwait(&run->ended, &run->lock, &until);
}

/* Passes finished files to done() until all threads have ended. Returns whether done() stopped the run. */
static bool hand_on(struct run *run, size_t *n_failed)
{
	const struct batch *batch = run->batch;
	struct progress progress = progress_start(batch->n, "files", batch->options->quiet);
	bool stopped = false;
	size_t next = 0, kept = 0;
	pthread_mutex_lock(&run->lock);
	while (run->running > 0 || next < run->n_finished) {
		if (next == run->n_finished) {
			wait_a_tick(run);
			progress_draw(&progress);
			continue;
		}
		struct batch_file *file = &batch->file[run->finished[next++]];
		pthread_mutex_unlock(&run->lock);
		progress_erase(&progress);
		kept += file->kept;
		progress.done = next;
		progress.kept = kept;
		file->done = true;
		*n_failed += file->failed;
		report_suspects(file, batch->options->quiet);
		if (file->failed)
			report_error("%s", file->error.text);
		if (!stopped && batch->done && !batch->done(batch->user, file)) {
			stopped = true;
			*batch->options->cancel = true;
		}
		pthread_mutex_lock(&run->lock);
	}
	pthread_mutex_unlock(&run->lock);
	progress_erase(&progress);
	if (progress.shown && batch->n > 1)
		fprintf(stderr, "%zu of %zu files in %.1f s, %zu kept, %zu failed\n", next, batch->n,
			search_clock() - progress.start, kept, *n_failed);
	return stopped;
}

/* Starts up to n threads; returns how many there are. */
static int start_threads(struct run *run, pthread_t *thread, int n)
{
	int started = 0;
	pthread_mutex_lock(&run->lock);
	while (started < n && !pthread_create(&thread[started], NULL, work, run))
		started++;
	run->running = started;
	pthread_mutex_unlock(&run->lock);
	return started;
}

int batch_run(struct batch *batch)
{
	const int threads = batch->options->fit.threads > 0 ? batch->options->fit.threads : 1;
	const int n_workers = batch->n < (size_t)threads ? (int)batch->n : threads;
	struct run run = {.batch = batch,
			  .threads_per_fit = batch->n > 1 ? 1 : threads,
			  .lock = PTHREAD_MUTEX_INITIALIZER,
			  .ended = PTHREAD_COND_INITIALIZER};
	pthread_t *thread = calloc((size_t)n_workers + 1, sizeof(*thread));
	run.finished = calloc(batch->n + 1, sizeof(*run.finished));
	size_t n_failed = 0;
	bool stopped = batch->n > 0;
	const int started = thread && run.finished ? start_threads(&run, thread, n_workers) : 0;
	if (started)
		stopped = hand_on(&run, &n_failed);
	else if (batch->n)
		report_error("cannot start a thread");
	for (int i = 0; i < started; i++)
		pthread_join(thread[i], NULL);
	for (int w = 0; w < WEIGHT_COUNT; w++)
		for (int i = 0; i < BINS_COUNT * CONTEXTS; i++)
			fit_context_free(run.context[w][i / CONTEXTS][i % CONTEXTS]);
	free(run.finished);
	free(thread);
	if (!stopped && *batch->options->cancel)
		return EXIT_INTERRUPTED;
	return stopped || n_failed ? EXIT_FAILED : EXIT_DONE;
}
