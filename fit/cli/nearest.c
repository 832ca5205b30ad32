/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/nearest.h"
#include <ctype.h>
#include <limits.h>
#include <string.h>

enum { LETTERS_MAX = 40 };

static int smaller(int a, int b)
{
	return a < b ? a : b;
}

static int lower(const char *text, int i)
{
	return tolower((unsigned char)text[i]);
}

/* The number of slips between two words [Damerau 1964, Levenshtein 1966; no letter is moved twice]. */
static int distance(const char *a, int n_a, const char *b, int n_b)
{
	int d[LETTERS_MAX + 1][LETTERS_MAX + 1];

	for (int i = 0; i <= n_a; i++)
		for (int j = 0; j <= n_b; j++) {
			if (i == 0 || j == 0) {
				d[i][j] = i + j;
				continue;
			}
			const int change = lower(a, i - 1) != lower(b, j - 1);
			d[i][j] = smaller(d[i - 1][j - 1] + change, smaller(d[i - 1][j], d[i][j - 1]) + 1);
			if (i > 1 && j > 1 && lower(a, i - 1) == lower(b, j - 2) && lower(a, i - 2) == lower(b, j - 1))
				d[i][j] = smaller(d[i][j], d[i - 2][j - 2] + 1);
		}
	return d[n_a][n_b];
}

int nearest_word(const char *typed, const char *(*word)(const void *data, int i), const void *data)
{
	const size_t length = strlen(typed);
	int best = -1, fewest = length <= 4 ? 2 : 3;

	if (length < 2 || length > LETTERS_MAX)
		return -1;
	for (int i = 0; word(data, i); i++) {
		const size_t n = strlen(word(data, i));
		const int slips = n <= LETTERS_MAX ? distance(typed, (int)length, word(data, i), (int)n) : INT_MAX;

		if (slips < fewest) {
			fewest = slips;
			best = i;
		}
	}
	return best;
}
