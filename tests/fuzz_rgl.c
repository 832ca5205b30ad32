/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes are an RGL file. */
#include "data_readers/rgl.h"
#include "fuzz.h"
#include <float.h>

static void check_entry(const struct measurement *m, size_t n)
{
	const struct scattered *s = m->scattered;
	double f[MERL_CHANNELS];

	PROMISE(fabs(vec3_length(s->wi[n]) - 1) < 1e-9 && fabs(vec3_length(s->wo[n]) - 1) < 1e-9);
	PROMISE(s->solid_angle[n] >= 0 && s->solid_angle[n] <= FLT_MAX);
	for (int c = 0; c < MERL_CHANNELS; c++)
		PROMISE(s->value[c][n] >= 0 && s->value[c][n] <= FLT_MAX);
	PROMISE(rgl_f(m->rgl, s->wi[n], s->wo[n], f));
}

int fuzz_rgl(const uint8_t *data, size_t size)
{
	struct measurement measurement;
	struct error error = {""};
	char path[FUZZ_PATH], message[1024];
	const int fd = fuzz_file(data, size, path);
	const enum status status = rgl_read(path, GAMUT_MASK, &measurement, &error);
	snprintf(message, sizeof message, "stdfit: %s\n", error.text);
	PROMISE(status == STATUS_OK || (measurement.scattered == NULL && is_message(message)));
	for (size_t n = 0; status == STATUS_OK && n < measurement.scattered->n; n++)
		check_entry(&measurement, n);
	measurement_free(&measurement);
	close(fd);
	return 0;
}
