/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/text_number.h"
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

enum { DIGITS_MAX = 19, EXPONENT_MAX = 100000 };

static bool is_digit(char c)
{
	return c >= '0' && c <= '9';
}

/* The digits of a number as an integer times a power of ten. */
struct decimal {
	uint64_t digits;
	int n; /* digits that count: leading zeros do not */
	long exponent;
	bool any;
};

static const char *take_digits(const char *s, struct decimal *d, bool behind_point)
{
	for (; is_digit(*s); s++) {
		d->any = true;
		if (d->n < DIGITS_MAX) {
			d->digits = 10 * d->digits + (uint64_t)(*s - '0');
			d->n += d->digits != 0;
			d->exponent -= behind_point;
		} else {
			d->exponent += !behind_point;
		}
	}
	return s;
}

/* The exponent, if there is one: an "e" without digits is not part of the number. */
static const char *take_exponent(const char *s, struct decimal *d)
{
	const char *at = s + 1;
	long exponent = 0;
	if (*s != 'e' && *s != 'E')
		return s;
	const bool negative = *at == '-';
	at += *at == '-' || *at == '+';
	if (!is_digit(*at))
		return s;
	for (; is_digit(*at); at++)
		if (exponent < EXPONENT_MAX)
			exponent = 10 * exponent + (*at - '0');
	d->exponent += negative ? -exponent : exponent;
	return at;
}

static double scaled(const struct decimal *d)
{
	static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
				       1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
	const long last = sizeof power / sizeof *power - 1;
	const double digits = (double)d->digits;
	if (d->digits == 0)
		return 0;
	if (d->exponent >= 0 && d->exponent <= last)
		return digits * power[d->exponent];
	if (d->exponent < 0 && -d->exponent <= last)
		return digits / power[-d->exponent];
	/* In two steps: a power of its own may be out of range where the number is not. */
	return (double)((long double)digits * powl(10, (long double)(d->exponent / 2)) *
			powl(10, (long double)(d->exponent - d->exponent / 2)));
}

static bool take_word(const char **s, double *value)
{
	static const struct {
		const char *word;
		double value;
	} words[] = {{"nan", NAN}, {"infinity", INFINITY}, {"inf", INFINITY}};
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		const size_t length = strlen(words[i].word);
		if (strncasecmp(*s, words[i].word, length))
			continue;
		*s += length;
		*value = words[i].value;
		return true;
	}
	return false;
}

bool text_number(const char **text, double *value)
{
	const char *s = *text;
	const bool negative = *s == '-';
	struct decimal d = {0};
	double size;
	s += *s == '-' || *s == '+';
	if (is_digit(*s) || *s == '.') {
		s = take_digits(s, &d, false);
		if (*s == '.')
			s = take_digits(s + 1, &d, true);
		if (!d.any)
			return false;
		s = take_exponent(s, &d);
		size = scaled(&d);
	} else if (!take_word(&s, &size)) {
		return false;
	}
	*text = s;
	*value = negative ? -size : size;
	return true;
}
