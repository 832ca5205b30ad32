/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/cornell.h"
#include "fuzz_text.h"

int fuzz_cornell(const uint8_t *data, size_t size)
{
	return fuzz_text(&cornell, data, size);
}
