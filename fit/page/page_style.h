/* SPDX-License-Identifier: GPL-3.0-or-later */
/* page_style - how the page of a report looks (CSS), and what it does beyond HTML (a script that it can do without). */
#ifndef PAGE_STYLE_H
#define PAGE_STYLE_H

extern const char page_style[];
extern const char page_script[];

#endif
