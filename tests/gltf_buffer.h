/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gltf_buffer - the bytes behind a glTF file of ours. */
#ifndef GLTF_BUFFER_H
#define GLTF_BUFFER_H

#include "check.h"
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

/* The bytes of the one buffer, decoded. */
static inline unsigned char *gltf_buffer(const json_t *gltf, size_t *size)
{
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	const json_t *buffer = json_array_get(json_object_get(gltf, "buffers"), 0);
	const char *at = strchr(json_string_value(json_object_get(buffer, "uri")), ',') + 1;
	unsigned char *bytes = malloc(strlen(at));
	unsigned bits = 0;

	assert_non_null(bytes);
	*size = 0;
	for (int n = 1; *at; at++, n++) {
		assert_non_null(strchr(digits, *at));
		bits = bits << 6 | (unsigned)(strchr(digits, *at) - digits);
		for (int shift = 16; n % 4 == 0 && shift >= 0; shift -= 8)
			bytes[(*size)++] = (unsigned char)(bits >> shift & 255);
	}
	assert_int_equal(*size, json_integer_value(json_object_get(buffer, "byteLength")));
	return bytes;
}

/* Where the attribute of the mesh begins, of so many floats a vertex. */
static inline size_t gltf_attribute(const json_t *gltf, const char *name, json_int_t floats)
{
	const json_t *mesh = json_array_get(json_object_get(gltf, "meshes"), 0);
	const json_t *attributes =
		json_object_get(json_array_get(json_object_get(mesh, "primitives"), 0), "attributes");
	const json_t *accessor = json_array_get(json_object_get(gltf, "accessors"),
						(size_t)json_integer_value(json_object_get(attributes, name)));
	const json_t *view = json_array_get(json_object_get(gltf, "bufferViews"),
					    (size_t)json_integer_value(json_object_get(accessor, "bufferView")));
	const json_int_t offset = json_integer_value(json_object_get(view, "byteOffset"));

	assert_non_null(json_object_get(attributes, name));
	assert_int_equal(json_string_value(json_object_get(accessor, "type"))[3] - '0', floats);
	assert_int_equal(offset % 4, 0);
	assert_int_equal(json_integer_value(json_object_get(view, "byteLength")),
			 4 * floats * json_integer_value(json_object_get(accessor, "count")));
	return (size_t)offset;
}

#endif
