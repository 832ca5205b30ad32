/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/sampling.h"
#include "src/names.h"

static const char *const sampling_names[SAMPLING_COUNT] = {"visible", "ndf"};

const char *sampling_name(enum sampling sampling)
{
	return names_at(sampling_names, SAMPLING_COUNT, (int)sampling);
}

enum status sampling_find(const char *name, enum sampling *sampling)
{
	const int i = names_find(sampling_names, SAMPLING_COUNT, name);
	if (i < 0)
		return STATUS_DOMAIN;
	*sampling = (enum sampling)i;
	return STATUS_OK;
}
