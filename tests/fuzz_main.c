/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libFuzzer's entry; FUZZ_TARGET names what it leads to. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	return FUZZ_TARGET(data, size);
}
