/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A few rounds of the kill test; `make killtest` runs 200. */
#include "check.h"

static void killed_at_random_moments(void **state)
{
	(void)state;
	if (!getenv("STDFIT"))
		assert_int_equal(setenv("STDFIT", "build/stdfit", 1), 0);
	assert_int_equal(system("exec scripts/kill_test.sh \"$STDFIT\" 5 1"), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(killed_at_random_moments)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
