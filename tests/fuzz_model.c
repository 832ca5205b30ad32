/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes are a model as JSON. What is read can be evaluated, and is finite and not negative. */
#include "fit/export/model_json.h"
#include "fuzz.h"

int fuzz_model(const uint8_t *data, size_t size)
{
	static const struct vec3 wi = {0.6, 0, 0.8}, wo = {0, 0.6, 0.8};
	char path[FUZZ_PATH], message[1024];
	struct fit_options fit = fit_options_default();
	struct error error = {""};
	struct model_json json;
	const int fd = fuzz_file(data, size, path);
	const enum status status = model_json_read(path, &json, &fit, &error);

	close(fd);
	snprintf(message, sizeof message, "stdfit: %s\n", error.text);
	if (status != STATUS_OK) {
		PROMISE(is_message(message));
		return 0;
	}
	double f[3];

	cook_torrance_f(&json.model, wi, wo, f);
	for (int c = 0; c < 3; c++)
		PROMISE(f[c] >= 0);
	model_json_free(&json);
	return 0;
}
