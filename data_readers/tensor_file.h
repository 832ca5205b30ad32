/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tensor_file - the container of the RGL material database: named arrays of numbers, little-endian.
 *
 *     "tensor_file\0", uint8 version 1 and 0, uint32 number of fields; per field: uint16 length and name, uint16 number
 *     of dimensions, uint8 type, uint64 offset of the data, uint64 size of each dimension, the last running fastest. */
#ifndef TENSOR_FILE_H
#define TENSOR_FILE_H

#include "src/status.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TENSOR_DIMS_MAX = 8, TENSOR_FIELDS_MAX = 64, TENSOR_NAME_SIZE = 64 };

enum tensor_type { TENSOR_UINT8 = 1, TENSOR_FLOAT32 = 10, TENSOR_FLOAT64 = 11 };

/* struct tensor - one field; its data belong to the file's bytes. */
struct tensor {
	char name[TENSOR_NAME_SIZE];
	int dims;
	uint64_t shape[TENSOR_DIMS_MAX];
	int type;
	size_t count; /* of elements, the product of the shape */
	const unsigned char *data;
};

struct tensor_file {
	int n;
	struct tensor field[TENSOR_FIELDS_MAX];
};

/* tensor_file_is - whether bytes begin as such a file does. */
bool tensor_file_is(const unsigned char *bytes, size_t size);

/* tensor_file_parse - the fields of a file in memory, which has to outlive *file. Every field lies within the file,
 * after the header, and apart from all others. STATUS_FORMAT with a text that does not name the file. */
MUST_CHECK enum status tensor_file_parse(const unsigned char *bytes, size_t size, struct tensor_file *file,
					 struct error *why);

/* tensor_file_find - the field of this name, or NULL. */
const struct tensor *tensor_file_find(const struct tensor_file *file, const char *name);

/* tensor_floats - the elements of a float32 or float64 field, newly allocated. STATUS_FORMAT: another type, or a number
 * that is not finite; STATUS_NO_MEMORY. */
MUST_CHECK enum status tensor_floats(const struct tensor *tensor, float **values, struct error *why);

/* tensor_file_add - one more field; its data are borrowed: count numbers of this machine, float32, or bytes, uint8.
 * count is set from the shape. At most TENSOR_FIELDS_MAX fields, TENSOR_DIMS_MAX dimensions, names below
 * TENSOR_NAME_SIZE. */
void tensor_file_add(struct tensor_file *file, const char *name, enum tensor_type type, int dims, const size_t shape[],
		     const void *data);

/* tensor_file_encode - the bytes of a file with the fields that were added, newly allocated. Data begin at multiples of
 * 8. STATUS_NO_MEMORY. */
MUST_CHECK enum status tensor_file_encode(const struct tensor_file *file, unsigned char **bytes, size_t *size);

#endif
