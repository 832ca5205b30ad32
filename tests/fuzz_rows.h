/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_rows - result tables under attack, as files: any bytes, or sound rows with changed cells. */
#ifndef FUZZ_ROWS_H
#define FUZZ_ROWS_H

#include "fit/results/result.h"
#include "fuzz.h"

#include <unistd.h>

/* Makes an empty directory, in memory where that is to be had: what is written there may be synced. */
static inline void fuzz_make_directory(char directory[64])
{
	snprintf(directory, 64, "%s/stdfit-fuzz-XXXXXX", access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm");
	if (!mkdtemp(directory))
		abort();
}

static inline void fuzz_write_file(const char *path, const void *bytes, size_t size)
{
	FILE *file = fopen(path, "wb");
	if (!file || fwrite(bytes, 1, size, file) != size || fclose(file))
		abort();
}

/* Writes a table of sound rows with the changes that `text` describes: lines that each change a cell, the first byte is
 * the column, what follows is the new content; an empty line begins the next row. The text is cut up. */
static inline void fuzz_write_rows(const char *path, char *text)
{
	static char empty[] = "";
	char *cell[RESULT_COLUMNS];
	FILE *file = fopen(path, "wb");
	if (!file)
		abort();
	csv_write_header(file, result_columns, RESULT_COLUMNS);
	for (char *line = text, *next; line; line = next) {
		static const char *const sound[RESULT_COLUMNS] = {[RESULT_MATERIAL] = "a",
								  [RESULT_NDF] = "ggx",
								  [RESULT_ERROR] = "0.25",
								  [RESULT_KD_R] = "0.5",
								  [RESULT_KS_G] = "0.5",
								  [RESULT_SIGMA] = "0.125",
								  [RESULT_GAMMA] = "2",
								  [RESULT_IOR] = "1.5",
								  [RESULT_GAF] = "uncorrelated",
								  [RESULT_LAMBDA] = "exact",
								  [RESULT_FRESNEL] = "dielectric",
								  [RESULT_WEIGHT] = "none",
								  [RESULT_BINS] = "node",
								  [RESULT_MAX_THETA] = "90",
								  [RESULT_STATUS] = "converged",
								  [RESULT_PATH] = "a.binary",
								  [RESULT_INPUT] = "1:0",
								  [RESULT_OPTIONS] = "o=1",
								  [RESULT_VERSION] = STDFIT_VERSION};
		for (int c = 0; c < RESULT_COLUMNS; c++)
			cell[c] = sound[c] ? (char *)sound[c] : empty; /* only read */
		do {
			next = strchr(line, '\n');
			if (next)
				*next++ = '\0';
			if (!*line)
				break;
			cell[(uint8_t)*line % RESULT_COLUMNS] = line + 1;
			line = next;
		} while (next);
		csv_write_row(file, cell, RESULT_COLUMNS);
	}
	if (fclose(file))
		abort();
}

/* The file that the bytes describe: the first says whether the rest is the file (below 128) or changes of rows. */
static inline void fuzz_write_table(const char *path, const uint8_t *data, size_t size)
{
	char *text = calloc(size, 1);
	if (!text)
		abort();
	memcpy(text, data + 1, size - 1);
	if (data[0] < 128)
		fuzz_write_file(path, text, size - 1);
	else
		fuzz_write_rows(path, text);
	free(text);
}

#endif
