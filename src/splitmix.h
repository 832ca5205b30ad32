/* SPDX-License-Identifier: GPL-3.0-or-later */
/* splitmix - random numbers by Splitmix64 [Steele et al. 2014]: a state of 64 bits, any of them a start, and no two of its
 * 2^64 states alike. Good enough for starts and samples, not for secrets. */
#ifndef SPLITMIX_H
#define SPLITMIX_H

#include <stdint.h>

/* splitmix_bits - the next 64 bits. */
static inline uint64_t splitmix_bits(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

/* splitmix_uniform - the next number in [0, 1), a multiple of 2^-53. */
static inline double splitmix_uniform(uint64_t *state)
{
	return (double)(splitmix_bits(state) >> 11) * 0x1p-53;
}

#endif
