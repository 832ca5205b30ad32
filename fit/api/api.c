/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/api/api.h"
#include "data_readers/text_quote.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

_Static_assert((int)STDFIT_OK == STATUS_OK && (int)STDFIT_DOMAIN == STATUS_DOMAIN &&
		       (int)STDFIT_NO_MEMORY == STATUS_NO_MEMORY && (int)STDFIT_IO == STATUS_IO &&
		       (int)STDFIT_FORMAT == STATUS_FORMAT && (int)STDFIT_NO_DATA == STATUS_NO_DATA &&
		       (int)STDFIT_UNSUPPORTED == STATUS_UNSUPPORTED && (int)STDFIT_INTERRUPTED == STATUS_INTERRUPTED,
	       "the public status is the internal one");

const char *stdfit_version(void)
{
	return STDFIT_VERSION;
}

const char *stdfit_status_text(int status)
{
	return status < STDFIT_OK || status > STDFIT_INTERRUPTED ? "unknown status" : status_str((enum status)status);
}

void api_explain(struct stdfit_error *error, const char *format, ...)
{
	va_list list;

	if (!error)
		return;
	va_start(list, format);
	vsnprintf(error->text, sizeof error->text, format, list);
	va_end(list);
}

enum stdfit_status api_end(struct stdfit_error *error, enum status status, const struct error *why)
{
	if (status == STATUS_OK)
		return STDFIT_OK;
	return api_fail(error, status, "%s", why && why->text[0] ? why->text : status_str(status));
}

enum stdfit_status api_unknown(struct stdfit_error *error, const char *what, const char *name)
{
	char quoted[TEXT_QUOTE_SIZE]; /* any bytes may be in it: the text stays one line */

	text_quote(name, quoted, sizeof quoted);
	return api_fail(error, STATUS_DOMAIN, "%s: there is none called '%s'", what, quoted);
}

enum stdfit_status api_gaf(const char *name, enum gaf *gaf, struct stdfit_error *error)
{
	*gaf = GAF_UNCORRELATED;
	return name && gaf_find(name, gaf) != STATUS_OK ? api_unknown(error, "gaf", name) : STDFIT_OK;
}

enum stdfit_status api_model_fresnel(const char *name, enum fresnel *fresnel, struct stdfit_error *error)
{
	*fresnel = FRESNEL_DIELECTRIC;
	return name && fresnel_find(name, fresnel) != STATUS_OK ? api_unknown(error, "fresnel", name) : STDFIT_OK;
}

enum stdfit_status api_fresnel(const char *name, enum fresnel *fresnel, struct stdfit_error *error)
{
	const enum stdfit_status status = api_model_fresnel(name, fresnel, error);

	return status == STDFIT_OK && *fresnel == FRESNEL_F82 ? api_unknown(error, "fresnel", name) : status;
}

enum stdfit_status api_bins(const char *name, enum bins *bins, struct stdfit_error *error)
{
	*bins = BINS_NODE;
	return name && bins_find(name, bins) != STATUS_OK ? api_unknown(error, "bins", name) : STDFIT_OK;
}

enum stdfit_status api_directions(const char *what, size_t n, const double *directions, struct stdfit_error *error)
{
	if (!directions && n > 0)
		return api_fail(error, STATUS_DOMAIN, "%s is NULL", what);
	for (size_t i = 0; i < n; i++)
		if (!(fabs(vec3_length(api_vec(directions + 3 * i)) - 1) <= 1e-6))
			return api_fail(error, STATUS_DOMAIN, "%s number %zu is no unit vector", what, i);
	return STDFIT_OK;
}

enum stdfit_status api_pairs(size_t n, const double *wi, const double *wo, const double *out, const char *name,
			     struct stdfit_error *error)
{
	enum stdfit_status status = api_directions("wi", n, wi, error);

	if (status == STDFIT_OK)
		status = api_directions("wo", n, wo, error);
	if (status == STDFIT_OK && n > 0 && !out)
		status = api_fail(error, STATUS_DOMAIN, "%s is NULL", name);
	return status;
}
