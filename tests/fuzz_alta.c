/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/alta.h"
#include "fuzz_text.h"

int fuzz_alta(const uint8_t *data, size_t size)
{
	return fuzz_text(&alta, data, size);
}
