/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz - targets for a fuzzer. A target hands any bytes to the code under test and aborts when that breaks a promise
 * that it makes; a sanitizer finds what is worse. `make fuzz` has libFuzzer call them; test_corpus calls each with
 * every file below tests/corpus/. They return 0. */
#ifndef FUZZ_H
#define FUZZ_H

#include "data_readers/text_quote.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int fuzz_merl(const uint8_t *data, size_t size);         /* the MERL reader */
int fuzz_rgl(const uint8_t *data, size_t size);          /* that of RGL files */
int fuzz_table(const uint8_t *data, size_t size);        /* result tables: eval --from, compare, --resume */
int fuzz_csv(const uint8_t *data, size_t size);          /* samples as CSV */
int fuzz_alta(const uint8_t *data, size_t size);         /* ALTA texts */
int fuzz_cornell(const uint8_t *data, size_t size);      /* Cornell texts */
int fuzz_zemax(const uint8_t *data, size_t size);        /* Zemax texts */
int fuzz_model(const uint8_t *data, size_t size);        /* models as JSON */
int fuzz_image(const uint8_t *data, size_t size);        /* pictures: HDR, PFM */
int fuzz_ndf(const uint8_t *data, size_t size);          /* ndf -: distributions on standard input */
int fuzz_merge(const uint8_t *data, size_t size);        /* merge of two result tables */
int fuzz_command_line(const uint8_t *data, size_t size); /* arguments */

#define PROMISE(kept) ((kept) ? (void)0 : fuzz_broken(__FILE__, __LINE__, #kept))

static int fuzz_stderr = STDERR_FILENO; /* where a broken promise is told, even while a capture is under way */

_Noreturn static inline void fuzz_broken(const char *file, int line, const char *promise)
{
	dprintf(fuzz_stderr, "%s:%d: broken promise: %s\n", file, line, promise);
	abort();
}

enum { FUZZ_PATH = 64 };

/* A file in memory with these bytes, and the path by which it can be read; to be closed. */
static inline int fuzz_file(const uint8_t *data, size_t size, char path[FUZZ_PATH])
{
	const int fd = memfd_create("fuzz", MFD_CLOEXEC);

	if (fd < 0 || write(fd, data, size) != (ssize_t)size)
		abort();
	snprintf(path, FUZZ_PATH, "/proc/self/fd/%d", fd);
	return fd;
}

/* What the code under test writes to a standard stream goes to a file in memory meanwhile. */
struct capture {
	int fd, real; /* the stream's descriptor, and a copy of what it was */
	int memory;
	size_t size;
	char *text; /* after the end */
};

static inline struct capture capture_begin(FILE *stream)
{
	struct capture capture = {.fd = fileno(stream)};
	fflush(stream);
	capture.real = dup(capture.fd);
	capture.memory = memfd_create("capture", 0);
	if (capture.real < 0 || capture.memory < 0 || dup2(capture.memory, capture.fd) < 0)
		abort();
	if (capture.fd == STDERR_FILENO)
		fuzz_stderr = capture.real;
	return capture;
}

static inline void capture_end(struct capture *capture, FILE *stream)
{
	fflush(stream);
	capture->size = (size_t)lseek(capture->memory, 0, SEEK_END);
	capture->text = calloc(capture->size + 1, 1);
	if (!capture->text || pread(capture->memory, capture->text, capture->size, 0) != (ssize_t)capture->size ||
	    dup2(capture->real, capture->fd) < 0)
		abort();
	if (capture->fd == STDERR_FILENO)
		fuzz_stderr = STDERR_FILENO;
	close(capture->real);
	close(capture->memory);
}

/* Whether the text is one line of printable UTF-8 that begins as messages of the program do. */
static inline bool is_message(const char *text)
{
	static const char begin[] = "stdfit: ";
	if (strncmp(text, begin, strlen(begin)) != 0)
		return false;
	while (*text && *text != '\n') {
		const size_t length = text_printable(text);
		if (length == 0)
			return false;
		text += length;
	}
	return strcmp(text, "\n") == 0;
}

#endif
