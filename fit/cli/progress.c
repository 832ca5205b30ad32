/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/progress.h"
#include "fit/search/search.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

struct progress progress_start(size_t n, const char *unit, bool quiet)
{
	const double now = search_clock();
	return (struct progress){.shown = !quiet && n > 0 && isatty(STDERR_FILENO), .n = n, .unit = unit, .start = now};
}

void progress_draw(struct progress *progress)
{
	const double now = search_clock();
	if (!progress->shown || now - progress->drawn < 1.0 / 6)
		return;
	progress->drawn = now;
	const size_t worked = progress->done - progress->kept;
	fprintf(stderr, "\r%zu of %zu %s", progress->done, progress->n, progress->unit);
	if (progress->kept)
		fprintf(stderr, " (%zu kept)", progress->kept);
	if (!worked) {
		fprintf(stderr, ", %.0f s", now - progress->start);
	} else {
		const double each = (now - progress->start) / (double)worked;
		const long left = lrint(each * (double)(progress->n - progress->done));
		fprintf(stderr, ", %ld:%02ld left", left / 60, left % 60);
	}
	fputs("\033[K", stderr);
}

void progress_erase(struct progress *progress)
{
	if (!progress->shown || progress->drawn <= 0)
		return;
	fputs("\r\033[K", stderr);
	progress->drawn = 0;
}
