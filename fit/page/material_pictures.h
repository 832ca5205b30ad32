/* SPDX-License-Identifier: GPL-3.0-or-later */
/* material_pictures - which pictures the page has of a material, and what is written about them. */
#ifndef MATERIAL_PICTURES_H
#define MATERIAL_PICTURES_H

#include "fit/page/page.h"
#include "fit/render/picture_error.h"

/* In the order of the page. */
enum material_picture { PICTURE_SPHERES, PICTURE_SLICES, PICTURE_SLICES_0, PICTURE_MAP, PICTURE_NDF, PICTURES };

/* Without paths; the spheres have no caption yet. */
extern const struct page_picture material_pictures[PICTURES];

/* material_spheres_caption - what the spheres show, in which light, and how far each fit's is from the measured one,
 * difference[f] being that of fit f. Newly allocated; NULL: out of memory. */
char *material_spheres_caption(const struct options *options, const struct material_data *data,
			       const struct picture_error *difference);

#endif
