/* SPDX-License-Identifier: GPL-3.0-or-later */
/* row_options - the model of a result row as options of a command line. */
#ifndef ROW_OPTIONS_H
#define ROW_OPTIONS_H

/* row_options - newly allocated: "--ndf std --gaf uncorrelated --fresnel dielectric --lambda exact --sigma ... --kd
 * R,G,B --ks R,G,B" and what else it has, which eval, export, render and synth take. NULL: out of memory, or a row that no options describe:
 * a failed one, one without a lobe, or one of another NDF than std, ggx and beckmann. */
char *row_options(char *const *row);

#endif
