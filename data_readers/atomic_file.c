/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Opens file->stream; 0 or errno. */
static int open_stream(struct atomic_file *file)
{
	const bool in_order = file->output.in_order;
	const int fd = in_order ? file->output.fd : output_new_file(&file->output, &file->temp);
	if (fd < 0)
		return errno;
	file->stream = fdopen(fd, "w");
	if (!file->stream) {
		const int errnum = errno;
		if (!in_order)
			close(fd);
		return errnum;
	}
	if (in_order)
		file->output.fd = -1; /* the stream's now */
	return 0;
}

enum status atomic_file_take(struct atomic_file *file, struct output *output, struct error *error)
{
	*file = (struct atomic_file){.output = *output};
	*output = (struct output){.fd = -1};
	const int errnum = open_stream(file);
	if (!errnum)
		return STATUS_OK;
	const enum status status = output_failed(&file->output, errnum, error);
	atomic_file_abort(file);
	return status;
}

enum status atomic_file_open(struct atomic_file *file, const char *path, struct error *error)
{
	struct output output;
	*file = (struct atomic_file){0};
	enum status status = output_find(&output, path, error);
	if (status == STATUS_OK)
		status = output_open(&output, OUTPUT_REPLACE, error);
	return status == STATUS_OK ? atomic_file_take(file, &output, error) : status;
}

/* Flushes and closes the stream; 0 or the first errno. Pipes and terminals cannot be synced: no error. */
static int finish_stream(struct atomic_file *file)
{
	int errnum = file->errnum;

	if (fflush(file->stream) != 0 && errnum == 0)
		errnum = errno;
	if (ferror(file->stream) && errnum == 0)
		errnum = EIO; /* something written earlier was lost */
	while (errnum == 0 && file->temp && fsync(fileno(file->stream)) != 0)
		if (errno != EINTR)
			errnum = errno;
	if (fclose(file->stream) != 0 && errnum == 0)
		errnum = errno;
	file->stream = NULL;
	return errnum;
}

/* Makes the rename last through a power cut, where the file system can. The output is complete either way. */
static void sync_directory(const char *target)
{
	const char *slash = strrchr(target, '/');
	char *directory = slash ? strndup(target, (size_t)(slash - target) + 1) : strdup(".");
	const int fd = directory ? open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;

	if (fd >= 0) {
		fsync(fd);
		close(fd);
	}
	free(directory);
}

enum status atomic_file_commit(struct atomic_file *file, struct error *error)
{
	enum status status = STATUS_OK;
	int errnum = finish_stream(file);

	/* Only what is complete and on the disk may replace what is there. */
	if (errnum == 0 && file->temp && file->keeps)
		status = output_back_up(&file->output, error);
	if (errnum == 0 && file->temp && status == STATUS_OK) {
		errnum = output_replace(&file->output, file->temp, -1);
		if (errnum == 0) {
			sync_directory(file->output.target);
			free(file->temp);
			file->temp = NULL;
		}
	}
	if (errnum != 0)
		status = output_failed(&file->output, errnum, error);
	atomic_file_abort(file);
	return status;
}

void atomic_file_abort(struct atomic_file *file)
{
	if (file->stream)
		fclose(file->stream);
	if (file->temp)
		unlink(file->temp);
	free(file->temp);
	output_close(&file->output);
	*file = (struct atomic_file){.output = {.fd = -1}};
}
