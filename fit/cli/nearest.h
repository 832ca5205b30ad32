/* SPDX-License-Identifier: GPL-3.0-or-later */
/* nearest - the known word that a mistyped one was probably meant to be. */
#ifndef NEAREST_H
#define NEAREST_H

/* nearest_word - the number i of the word(i) with the fewest letters added, left out, changed or swapped with the next; NULL
 * ends the words. One of four letters or less may have one such slip, others two. Letter case does not count. -1: none. */
int nearest_word(const char *typed, const char *(*word)(const void *data, int i), const void *data);

#endif
