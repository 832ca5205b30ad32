/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/tensor_file.h"
#include <endian.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char magic[12] = "tensor_file"; /* the zero at its end included */

bool tensor_file_is(const unsigned char *bytes, size_t size)
{
	return size >= sizeof magic && memcmp(bytes, magic, sizeof magic) == 0;
}

/* struct cursor - where reading has come to. Past the end, zeros are read and `short_of_bytes` is set. */
struct cursor {
	const unsigned char *bytes;
	size_t size, at;
	bool short_of_bytes;
};

static const unsigned char *take(struct cursor *cursor, size_t size)
{
	const unsigned char *bytes = cursor->bytes + cursor->at;

	if (size > cursor->size - cursor->at) {
		cursor->short_of_bytes = true;
		return NULL;
	}
	cursor->at += size;
	return bytes;
}

static uint64_t take_number(struct cursor *cursor, size_t size)
{
	const unsigned char *bytes = take(cursor, size);
	uint64_t number = 0;

	if (bytes)
		memcpy(&number, bytes, size);
	return le64toh(number);
}

/* Bytes of an element of each type: 1 to 8 are integers of 8 to 64 bits, 9 to 11 floats of 16 to 64. */
static size_t size_of_type(uint64_t type)
{
	static const size_t size[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};

	return type < sizeof size / sizeof *size ? size[type] : 0;
}

static enum status take_shape(struct cursor *cursor, struct tensor *tensor, size_t *bytes, struct error *why)
{
	*bytes = size_of_type((uint64_t)tensor->type);
	tensor->count = 1;
	for (int d = 0; d < tensor->dims; d++) {
		tensor->shape[d] = take_number(cursor, 8);
		if (cursor->short_of_bytes)
			return STATUS_OK; /* told by the caller */
		if (tensor->shape[d] == 0)
			return error_set(why, STATUS_FORMAT, "field '%s': a dimension of 0 is impossible",
					 tensor->name);
		if (tensor->shape[d] > cursor->size / *bytes)
			return error_set(why, STATUS_FORMAT,
					 "field '%s': a dimension of %" PRIu64 " does not fit into a file of %zu bytes",
					 tensor->name, tensor->shape[d], cursor->size);
		*bytes *= tensor->shape[d]; /* at most the file's size */
		tensor->count *= tensor->shape[d];
	}
	return STATUS_OK;
}

static bool copy_name(const unsigned char *from, size_t length, char *name)
{
	if (length == 0 || length >= TENSOR_NAME_SIZE)
		return false;
	for (size_t i = 0; i < length; i++)
		if (from[i] <= ' ' || from[i] > '~')
			return false;
	memcpy(name, from, length);
	name[length] = '\0';
	return true;
}

static enum status take_field(struct cursor *cursor, struct tensor *tensor, struct error *why)
{
	const size_t length = take_number(cursor, 2);
	const unsigned char *name = take(cursor, length);

	*tensor = (struct tensor){.dims = 0};
	if (name && !copy_name(name, length, tensor->name))
		return error_set(why, STATUS_FORMAT, "expected field names of 1 to %d printable characters",
				 TENSOR_NAME_SIZE - 1);
	const uint64_t dims = take_number(cursor, 2);
	tensor->type = (int)take_number(cursor, 1);
	const uint64_t offset = take_number(cursor, 8);
	size_t bytes;
	if (cursor->short_of_bytes)
		return error_set(why, STATUS_FORMAT, "the file ends within its header");
	if (dims > TENSOR_DIMS_MAX)
		return error_set(why, STATUS_FORMAT, "field '%s': expected at most %d dimensions, found %" PRIu64,
				 tensor->name, TENSOR_DIMS_MAX, dims);
	if (size_of_type((uint64_t)tensor->type) == 0)
		return error_set(why, STATUS_FORMAT, "field '%s': expected a type from 1 to 11, found %d", tensor->name,
				 tensor->type);
	tensor->dims = (int)dims;
	const enum status status = take_shape(cursor, tensor, &bytes, why);
	if (status != STATUS_OK)
		return status;
	if (cursor->short_of_bytes)
		return error_set(why, STATUS_FORMAT, "the file ends within its header");
	if (offset > cursor->size || bytes > cursor->size - offset)
		return error_set(why, STATUS_FORMAT,
				 "field '%s': expected bytes %" PRIu64 " to %" PRIu64 ", the file has %zu",
				 tensor->name, offset, offset + bytes, cursor->size);
	tensor->data = cursor->bytes + offset;
	return STATUS_OK;
}

static const unsigned char *end_of(const struct tensor *tensor)
{
	return tensor->data + tensor->count * size_of_type((uint64_t)tensor->type);
}

static enum status check_apart(const struct tensor_file *file, const unsigned char *bytes,
			       const unsigned char *header_end, struct error *why)
{
	for (int a = 0; a < file->n; a++) {
		const struct tensor *one = &file->field[a];

		if (one->data < header_end)
			return error_set(why, STATUS_FORMAT, "field '%s' overlaps the header, at byte %zu", one->name,
					 (size_t)(one->data - bytes));
		for (int b = 0; b < a; b++) {
			const struct tensor *other = &file->field[b];

			if (strcmp(one->name, other->name) == 0)
				return error_set(why, STATUS_FORMAT, "two fields are called '%s'", one->name);
			if (one->data < end_of(other) && other->data < end_of(one))
				return error_set(why, STATUS_FORMAT,
						 "fields '%s' and '%s' overlap, at bytes %zu and %zu", other->name,
						 one->name, (size_t)(other->data - bytes), (size_t)(one->data - bytes));
		}
	}
	return STATUS_OK;
}

enum status tensor_file_parse(const unsigned char *bytes, size_t size, struct tensor_file *file, struct error *why)
{
	struct cursor cursor = {bytes, size, 0, false};
	enum status status = STATUS_OK;

	file->n = 0;
	if (!tensor_file_is(bytes, size))
		return error_set(why, STATUS_FORMAT, "expected 'tensor_file' at its beginning");
	take(&cursor, sizeof magic);
	const unsigned major = (unsigned)take_number(&cursor, 1), minor = (unsigned)take_number(&cursor, 1);
	const uint64_t n = take_number(&cursor, 4);
	if (cursor.short_of_bytes)
		return error_set(why, STATUS_FORMAT, "the file ends within its header");
	if (major != 1)
		return error_set(why, STATUS_FORMAT, "expected version 1 of the format, found %u.%u", major, minor);
	if (n > TENSOR_FIELDS_MAX)
		return error_set(why, STATUS_FORMAT, "expected at most %d fields, found %" PRIu64, TENSOR_FIELDS_MAX,
				 n);
	while (status == STATUS_OK && file->n < (int)n) {
		status = take_field(&cursor, &file->field[file->n], why);
		file->n++;
	}
	return status == STATUS_OK ? check_apart(file, bytes, bytes + cursor.at, why) : status;
}

const struct tensor *tensor_file_find(const struct tensor_file *file, const char *name)
{
	for (int f = 0; f < file->n; f++)
		if (strcmp(file->field[f].name, name) == 0)
			return &file->field[f];
	return NULL;
}

static double number_at(const struct tensor *tensor, size_t at)
{
	if (tensor->type == TENSOR_FLOAT64) {
		uint64_t bits;
		double value;

		memcpy(&bits, tensor->data + at * sizeof bits, sizeof bits);
		bits = le64toh(bits);
		memcpy(&value, &bits, sizeof value);
		return value;
	}
	uint32_t bits;
	float value;

	memcpy(&bits, tensor->data + at * sizeof bits, sizeof bits);
	bits = le32toh(bits);
	memcpy(&value, &bits, sizeof value);
	return (double)value;
}

enum status tensor_floats(const struct tensor *tensor, float **values, struct error *why)
{
	*values = NULL;
	if (tensor->type != TENSOR_FLOAT32 && tensor->type != TENSOR_FLOAT64)
		return error_set(why, STATUS_FORMAT, "field '%s': expected floats, type 10 or 11, found type %d",
				 tensor->name, tensor->type);
	float *all = malloc(tensor->count * sizeof *all);
	if (!all)
		return error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	for (size_t at = 0; at < tensor->count; at++) {
		all[at] = (float)number_at(tensor, at);
		if (!isfinite(all[at])) {
			free(all);
			return error_set(why, STATUS_FORMAT, "field '%s': element %zu is not a finite number",
					 tensor->name, at);
		}
	}
	*values = all;
	return STATUS_OK;
}

/* ---- Writing ---- */

void tensor_file_add(struct tensor_file *file, const char *name, enum tensor_type type, int dims, const size_t shape[],
		     const void *data)
{
	struct tensor *tensor = &file->field[file->n++];

	*tensor = (struct tensor){.dims = dims, .type = (int)type, .count = 1, .data = data};
	memcpy(tensor->name, name, strlen(name) + 1);
	for (int d = 0; d < dims; d++) {
		tensor->shape[d] = shape[d];
		tensor->count *= shape[d];
	}
}

static unsigned char *put_number(unsigned char *to, uint64_t number, size_t size)
{
	const uint64_t little = htole64(number);

	memcpy(to, &little, size);
	return to + size;
}

static void put_data(unsigned char *to, const struct tensor *tensor)
{
	const size_t size = size_of_type((uint64_t)tensor->type);

	if (size == 1) {
		memcpy(to, tensor->data, tensor->count);
		return;
	}
	for (size_t at = 0; at < tensor->count; at++) {
		uint32_t number;

		memcpy(&number, tensor->data + at * size, sizeof number);
		to = put_number(to, number, size);
	}
}

static size_t data_after(size_t offset, const struct tensor *tensor)
{
	return (offset + tensor->count * size_of_type((uint64_t)tensor->type) + 7) & ~(size_t)7;
}

enum status tensor_file_encode(const struct tensor_file *file, unsigned char **bytes, size_t *size)
{
	size_t header = sizeof magic + 2 + 4;

	for (int n = 0; n < file->n; n++)
		header += 2 + strlen(file->field[n].name) + 2 + 1 + 8 + 8 * (size_t)file->field[n].dims;
	const size_t first = (header + 7) & ~(size_t)7;
	*size = first;
	for (int n = 0; n < file->n; n++)
		*size = data_after(*size, &file->field[n]);
	*bytes = calloc(*size, 1);
	if (!*bytes)
		return STATUS_NO_MEMORY;
	unsigned char *to = *bytes;
	memcpy(to, magic, sizeof magic);
	to = put_number(to + sizeof magic, 1, 2);
	to = put_number(to, (uint64_t)file->n, 4);
	size_t offset = first;
	for (int n = 0; n < file->n; n++) {
		const struct tensor *tensor = &file->field[n];
		const size_t length = strlen(tensor->name);

		to = put_number(to, length, 2);
		memcpy(to, tensor->name, length);
		to = put_number(to + length, (uint64_t)tensor->dims, 2);
		to = put_number(to, (uint64_t)tensor->type, 1);
		to = put_number(to, offset, 8);
		for (int d = 0; d < tensor->dims; d++)
			to = put_number(to, tensor->shape[d], 8);
		put_data(*bytes + offset, tensor);
		offset = data_after(offset, tensor);
	}
	return STATUS_OK;
}
