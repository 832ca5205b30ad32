/* SPDX-License-Identifier: GPL-3.0-or-later */
/* row_pictures - picture errors of the models in a result table against their measured table. */
#ifndef ROW_PICTURES_H
#define ROW_PICTURES_H

#include "fit/render/pictures.h"
#include "fit/results/result.h"

/* row_pictures_errors - reads the file of rows[0 .. n-1], which all have the same one, renders it and every model in
 * the built-in studio light, 64 pixels wide, and puts the errors of the pictures into error[0 .. n-1]; NaN for rows of
 * failed fits. Returns STATUS_OK; STATUS_IO, STATUS_FORMAT, STATUS_NO_MEMORY, STATUS_INTERRUPTED with the reason, every
 * error then being NaN. */
MUST_CHECK enum status row_pictures_errors(char **const *rows, size_t n, const struct fit_options *options,
					   const struct environment *light, struct picture_error *errors,
					   struct error *error);

#endif
