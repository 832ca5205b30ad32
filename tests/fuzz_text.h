/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_text - a text format of measurements under attack. The first byte chooses the quantity and what becomes of
 * colours out of gamut; the rest is the file. */
#ifndef FUZZ_TEXT_H
#define FUZZ_TEXT_H

#include "data_readers/measurement_read.h"
#include "data_readers/text_format.h"
#include "fuzz.h"

#include <float.h>
#include <math.h>
#include <sys/mman.h>
#include <unistd.h>

static inline void fuzz_text_message(enum status status, const struct error *error)
{
	char message[1024];
	snprintf(message, sizeof message, "stdfit: %s\n", error->text);
	PROMISE(status == STATUS_OK || is_message(message));
}

static inline void fuzz_text_entries(const struct scattered *s, bool estimated)
{
	double sum = 0;
	PROMISE(s->n > 0);
	for (size_t e = 0; e < s->n; e++) {
		PROMISE(fabs(vec3_length(s->wi[e]) - 1) < 1e-9 && s->wi[e].z > 0);
		PROMISE(fabs(vec3_length(s->wo[e]) - 1) < 1e-9 && s->wo[e].z > 0);
		for (int c = 0; c < MERL_CHANNELS; c++) {
			PROMISE(s->value[c][e] >= 0 && s->value[c][e] <= FLT_MAX);
			PROMISE(!s->gray || s->value[c][e] == s->value[0][e]);
		}
		PROMISE(s->solid_angle[e] >= 0 && s->solid_angle[e] <= 40);
		sum += (double)s->solid_angle[e];
	}
	PROMISE(!estimated || sum <= 4 * M_PI * M_PI * (1 + 1e-5));
}

/* Through the reader of the format, whatever the content looks like. */
static inline void fuzz_text_parse(const struct text_format *format, const char *path,
				   const struct read_options *options)
{
	struct line_reader lines;
	struct entry_list list = {.gamut = options->gamut};
	struct measurement measurement = {0};
	struct error error = {""};
	enum status status = line_reader_open(&lines, path, "a file", &error);
	if (status == STATUS_OK)
		status = format->parse(&lines, options, &list, &error);
	line_reader_close(&lines);
	const bool estimated = !list.from_grid;
	if (status == STATUS_OK)
		status = entry_list_finish(&list, &measurement, &error);
	entry_list_free(&list);
	fuzz_text_message(status, &error);
	if (status == STATUS_OK)
		fuzz_text_entries(measurement.scattered, estimated);
	measurement_free(&measurement);
}

/* As the commands read it. */
static inline void fuzz_text_read(const char *path, const struct read_options *options, size_t size)
{
	struct measurement measurement;
	struct error error = {""};
	const enum status status = measurement_read(path, options, &measurement, &error);
	fuzz_text_message(status, &error);
	if (status == STATUS_OK) {
		PROMISE(measurement.file_size == size && measurement.format);
		if (measurement.scattered)
			fuzz_text_entries(measurement.scattered, false);
	}
	measurement_free(&measurement);
}

static inline int fuzz_text(const struct text_format *format, const uint8_t *data, size_t size)
{
	char path[FUZZ_PATH];
	if (size == 0)
		return 0;
	const struct read_options options = {.threads = 1,
					     .quantity = (enum quantity)(data[0] % QUANTITY_COUNT),
					     .gamut = (enum gamut)(data[0] / QUANTITY_COUNT % GAMUT_COUNT)};
	const int fd = fuzz_file(data + 1, size - 1, path);
	fuzz_text_parse(format, path, &options);
	fuzz_text_read(path, &options, size - 1);
	close(fd);
	return 0;
}

#endif
