/* SPDX-License-Identifier: GPL-3.0-or-later */
/* version - of the program and of the libraries that it runs with. */
#ifndef VERSION_H
#define VERSION_H

/* version_print - one line on standard output. */
void version_print(void);

#endif
