/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/zemax.h"
#include "fuzz_text.h"

int fuzz_zemax(const uint8_t *data, size_t size)
{
	return fuzz_text(&zemax, data, size);
}
