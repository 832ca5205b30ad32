/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/samples_csv.h"
#include "fuzz_text.h"

int fuzz_csv(const uint8_t *data, size_t size)
{
	return fuzz_text(&samples_csv, data, size);
}
