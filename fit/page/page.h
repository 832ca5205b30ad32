/* SPDX-License-Identifier: GPL-3.0-or-later */
/* page - the HTML of a report: files that need no network and nothing but each other. page_begin(), page_material() for each
 * material in order, page_end(). Up to PAGE_MATERIALS_MAX materials stand in one file; of more, each has a file of its own,
 * PAGE_DIRECTORY/NAME.html beside the first file, begun with page_of_material() and ended with page_end() like that.
 * Failures to write show in ferror(). */
#ifndef PAGE_H
#define PAGE_H

#include "fit/sources/error_grid.h"

/* struct page_picture - a picture in a file. */
struct page_picture {
	char *path;                         /* NULL: no picture, nothing is shown */
	int parts;                          /* > 0: so many pictures side by side, page_part_path() of `path` */
	const char *part[FIT_NDFS_MAX + 1]; /* what each shows, behind `alt` */
	const char *type;                   /* "image/png", "image/svg+xml" */
	bool plot;                          /* drawn on white: turned over where the reader's system is dark */
	const char *alt, *caption;          /* `alt` follows the name of the material, if there is one */
};

/* page_part_path - the file of a part, newly allocated; NULL: out of memory. */
char *page_part_path(const char *path, int part);

enum { PAGE_MATERIALS_MAX = 50 };
#define PAGE_DIRECTORY "materials"

/* struct page - a page being written. */
struct page {
	FILE *file; /* borrowed */
	const struct materials *materials;
	struct error_grid grid;
	bool divided; /* each material has a file of its own */
};

/* page_begin - head, summary, and the sortable table of all materials. errors: the picture of the sorted errors;
 * missing: why it is missing, NULL if none is expected. STATUS_NO_MEMORY; STATUS_IO: the picture cannot be read. Call
 * page_free() in any case. */
MUST_CHECK enum status page_begin(struct page *page, FILE *file, const struct materials *materials,
				  const struct page_picture *errors, const char *missing, struct error *error);

/* page_of_material - begins the file of material m, where the page is divided. *own borrows from *page: it is not to be
 * freed. */
void page_of_material(const struct page *page, size_t m, FILE *file, struct page *own);

/* page_material - of material m: its pictures, parameters, certainty, options. missing: why pictures are missing; NULL if
 * none is. */
MUST_CHECK enum status page_material(const struct page *page, size_t m, const struct page_picture *picture,
				     int n_pictures, const char *missing, struct error *error);

void page_end(const struct page *page);
void page_free(struct page *page);

#endif
