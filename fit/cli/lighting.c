/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/lighting.h"
#include "data_readers/text_quote.h"

#include <stdlib.h>
#include <string.h>

static enum status bad_light(const char *text, struct error *error)
{
	char shown[TEXT_QUOTE_SIZE];
	text_quote(text, shown, sizeof shown);
	return error_set(error, STATUS_DOMAIN,
			 "bad value '%s' for --light: expected X,Y,Z or X,Y,Z,E, with ; between up to %d of them",
			 shown, ENVIRONMENT_LIGHTS_MAX);
}

/* X,Y,Z or X,Y,Z,E at *text, which moves behind it. */
static bool parse_light(const char **text, struct light *light)
{
	double number[4] = {0, 0, 0, M_PI};
	int n = 0;
	for (bool more = true; more && n < 4; n++) {
		char *end;
		number[n] = strtod(*text, &end);
		if (end == *text || !isfinite(number[n]) || fabs(number[n]) > 1e9)
			return false;
		more = *end == ',';
		*text = end + more;
	}
	const struct vec3 to = {number[0], number[1], number[2]};
	if (n < 3 || !(vec3_length(to) > 1e-9) || number[3] < 0)
		return false;
	*light = (struct light){vec3_unit(to), {number[3], number[3], number[3]}};
	return true;
}

static enum status add_lights(const char *text, struct environment *environment, struct error *error)
{
	const char *at = text;
	for (bool more = true; more; at += more) {
		if (environment->n_lights == ENVIRONMENT_LIGHTS_MAX ||
		    !parse_light(&at, &environment->light[environment->n_lights]))
			return bad_light(text, error);
		environment->n_lights++;
		more = *at == ';';
	}
	return *at ? bad_light(text, error) : STATUS_OK;
}

static enum status read_map(const char *path, struct environment *environment, struct error *error)
{
	struct image map;
	struct error why;
	enum status status = image_read(path, &map, error);
	if (status != STATUS_OK)
		return status;
	status = environment_from_map(environment, &map, &why);
	image_free(&map);
	if (status == STATUS_OK)
		return STATUS_OK;
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	return error_set(error, status, "cannot light with '%s': %.200s", name, why.text);
}

enum status lighting_make(const struct options *options, struct environment *environment, struct error *error)
{
	enum status status = STATUS_OK;
	*environment = (struct environment){0};
	/* Lights without --environment replace the default environment. */
	if (options_given(options, "environment") || !options->light)
		status = environment_named(options->environment, environment);
	if (status == STATUS_DOMAIN)
		status = read_map(options->environment, environment, error);
	else if (status != STATUS_OK)
		error_set(error, status, "%s", status_str(status));
	if (status == STATUS_OK && options->light)
		status = add_lights(options->light, environment, error);
	if (status != STATUS_OK)
		environment_free(environment);
	else
		environment_scale(environment, exp2(options->exposure));
	return status;
}
