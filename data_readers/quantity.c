/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/quantity.h"
#include "src/names.h"
#include <math.h>

static const char *const names[QUANTITY_COUNT] = {[QUANTITY_FROM_FILE] = "file",
						  [QUANTITY_BRDF] = "brdf",
						  [QUANTITY_BRDF_COS] = "brdf_cos",
						  [QUANTITY_REFLECTANCE_FACTOR] = "reflectance_factor"};

const char *quantity_name(enum quantity quantity)
{
	return names_at(names, QUANTITY_COUNT, (int)quantity);
}

enum status quantity_find(const char *name, enum quantity *quantity)
{
	const int found = names_find(names, QUANTITY_COUNT, name);

	if (found < 0)
		return STATUS_DOMAIN;
	*quantity = (enum quantity)found;
	return STATUS_OK;
}

static const char *const gamut_names[GAMUT_COUNT] = {[GAMUT_CLIP] = "clip", [GAMUT_MASK] = "mask"};

const char *gamut_name(enum gamut gamut)
{
	return names_at(gamut_names, GAMUT_COUNT, (int)gamut);
}

enum status gamut_find(const char *name, enum gamut *gamut)
{
	const int found = names_find(gamut_names, GAMUT_COUNT, name);

	if (found < 0)
		return STATUS_DOMAIN;
	*gamut = (enum gamut)found;
	return STATUS_OK;
}

double quantity_factor(enum quantity quantity, double cos_o)
{
	if (quantity == QUANTITY_BRDF_COS)
		return 1 / cos_o;
	return quantity == QUANTITY_REFLECTANCE_FACTOR ? M_1_PI : 1;
}
