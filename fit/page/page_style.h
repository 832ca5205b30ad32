/* SPDX-License-Identifier: GPL-3.0-or-later */
/* page_style - the style sheet of a report's page, and a script that the page also works without. */
#ifndef PAGE_STYLE_H
#define PAGE_STYLE_H

extern const char page_style[];
extern const char page_script[];

#endif
