/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/stack.h"
#include "data_readers/text_quote.h"
#include "fit/cli/command.h"
#include "fit/cli/messages.h"

#include <ctype.h>
#include <errno.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

bool stack_parse_size(const char *text, size_t *bytes)
{
	static const char units[] = "bkmg";
	char *rest;
	errno = 0;
	const unsigned long long number = strtoull(text, &rest, 10);
	if (rest == text || errno || strchr(text, '-'))
		return false;
	while (isspace((unsigned char)*rest))
		rest++;
	const char *unit = *rest ? strchr(units, tolower((unsigned char)*rest)) : units + 1;
	if (*rest)
		rest++;
	while (isspace((unsigned char)*rest))
		rest++;
	if (!unit || *rest)
		return false;
	const int shift = 10 * (int)(unit - units);
	if (number > SIZE_MAX >> shift)
		return false;
	*bytes = (size_t)number << shift;
	return true;
}

/* The stack of the calling thread grows as far as the limit that holds when it does. */
static int prepare_own(void)
{
	struct rlimit limit;
	if (getrlimit(RLIMIT_STACK, &limit) || limit.rlim_cur >= STACK_BYTES)
		return -1;
	limit.rlim_cur = limit.rlim_max < STACK_BYTES ? limit.rlim_max : STACK_BYTES;
	if ((!setrlimit(RLIMIT_STACK, &limit) || !getrlimit(RLIMIT_STACK, &limit)) && limit.rlim_cur >= STACK_LEAST)
		return -1;
	report_error("the stack may not grow beyond %llu kB: expected %d or more (ulimit -s)",
		     (unsigned long long)limit.rlim_cur >> 10, STACK_LEAST >> 10);
	return EXIT_FAILED;
}

/* Threads have what the limit was when the program began, if nothing else is said. OpenMP's have it too, but with
 * OMP_STACKSIZE, which has been read already. */
static int prepare_threads(void)
{
	static const char *const names[] = {"OMP_STACKSIZE", "GOMP_STACKSIZE"};
	pthread_attr_t attributes;
	size_t size;
	if (!pthread_getattr_default_np(&attributes)) {
		if (!pthread_attr_getstacksize(&attributes, &size) && size < STACK_BYTES &&
		    !pthread_attr_setstacksize(&attributes, STACK_BYTES))
			pthread_setattr_default_np(&attributes);
		pthread_attr_destroy(&attributes);
	}
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		const char *text = getenv(names[i]);
		char shown[TEXT_QUOTE_SIZE];
		if (!text || !stack_parse_size(text, &size) || size >= STACK_LEAST)
			continue;
		text_quote(text, shown, sizeof shown);
		report_error("%s=%s is too small: expected %dK or more, or none", names[i], shown, STACK_LEAST >> 10);
		return EXIT_FAILED;
	}
	return -1;
}

int stack_prepare(void)
{
	const int code = prepare_own();
	return code >= 0 ? code : prepare_threads();
}
