/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/alta.h"
#include "data_readers/spectrum.h"
#include "data_readers/text_number.h"
#include "data_readers/text_quote.h"
#include <stdio.h>
#include <string.h>

enum {
	COORDINATES_MAX = 6,
	COLUMNS_MAX = 64,
	WORD_SIZE = 64,
};

/* Directions from the coordinates of a row; wi is the light, wo the view. */

static void spherical(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	*wi = direction(x[0], x[1]);
	*wo = direction(x[2], x[3]);
}

static void isotropic(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	*wi = direction(x[1], 0);
	*wo = direction(x[0], x[2]);
}

static void projected(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	*wi = direction(x[0], 0);
	*wo = direction(hypot(x[1], x[2]), atan2(x[2], x[1]));
}

static void half_difference(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	halfdiff_to_dirs((struct halfdiff){x[0], x[1], x[2]}, wi, wo);
}

/* Angles that are not given are ALTA's own: phi_d is 0, or 90 degrees for RUSIN_TH_TD, theta_d is 0. */

static double angle_of(double cosine)
{
	return acos(fmin(cosine, 1)); /* 1 but for rounding */
}

static void half_cosine(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	halfdiff_to_dirs((struct halfdiff){angle_of(x[0]), 0, 0}, wi, wo);
}

static void half_difference_cosines(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	halfdiff_to_dirs((struct halfdiff){angle_of(x[0]), angle_of(x[1]), 0}, wi, wo);
}

static void half_difference_across(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	halfdiff_to_dirs((struct halfdiff){x[0], x[1], M_PI / 2}, wi, wo);
}

/* The light at the normal. */
static void projected_view(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	*wi = (struct vec3){0, 0, 1};
	*wo = direction(hypot(x[0], x[1]), atan2(x[1], x[0]));
}

static struct vec3 turned(struct vec3 v, double phi)
{
	const double c = cos(phi), s = sin(phi);
	return (struct vec3){c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

static void half_difference_turned(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	halfdiff_to_dirs((struct halfdiff){x[0], x[2], x[3]}, wi, wo);
	*wi = turned(*wi, x[1]);
	*wo = turned(*wo, x[1]);
}

static void half_turned_difference(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	half_difference_turned((const double[]){x[0], x[1], x[2], 0}, wi, wo);
}

static void cartesian(const double *x, struct vec3 *wi, struct vec3 *wo)
{
	*wo = vec3_unit((struct vec3){x[0], x[1], x[2]});
	*wi = vec3_unit((struct vec3){x[3], x[4], x[5]});
}

/* Ways to give directions. */
struct input {
	const char *name;
	int n;
	bool isotropic;
	void (*directions)(const double *x, struct vec3 *wi, struct vec3 *wo);
};

static const struct input inputs[] = {
	{"SPHERICAL_TL_PL_TV_PV", 4, false, spherical},
	{"ISOTROPIC_TV_TL_DPHI", 3, true, isotropic},
	{"ISOTROPIC_TL_TV_PROJ_DPHI", 3, true, projected},
	{"RUSIN_TH_TD_PD", 3, true, half_difference},
	{"RUSIN_TH_PH_TD_PD", 4, false, half_difference_turned},
	{"CARTESIAN", 6, false, cartesian},
	{"COS_TH", 1, true, half_cosine},
	{"COS_TH_TD", 2, true, half_difference_cosines},
	{"RUSIN_TH_TD", 2, true, half_difference_across},
	{"RUSIN_TH_PH_TD", 3, false, half_turned_difference},
	{"ISOTROPIC_TV_PROJ_DPHI", 2, true, projected_view},
};

enum { INPUTS = sizeof inputs / sizeof *inputs };

/* What values can be. */
struct output {
	const char *name;
	enum quantity quantity;
	bool xyz;
};

static const struct output outputs[] = {
	{"INV_STERADIAN", QUANTITY_BRDF, false},
	{"INV_STERADIAN_COSINE_FACTOR", QUANTITY_BRDF_COS, false},
	{"RGB_COLOR", QUANTITY_BRDF, false},
	{"XYZ_COLOR", QUANTITY_BRDF, true},
};

enum { OUTPUTS = sizeof outputs / sizeof *outputs };

struct head {
	int n_in, n_out; /* 0: no DIM yet */
	const struct input *input;
	const struct output *output;
	char output_word[WORD_SIZE];
	int n_columns; /* of a row */
};

static enum status take_input(struct head *head, const char *word, const struct line_reader *lines, struct error *why)
{
	char shown[WORD_SIZE], known[TEXT_QUOTE_SIZE] = "";
	for (int i = 0; i < INPUTS; i++) {
		if (!strcmp(word, inputs[i].name))
			head->input = &inputs[i];
		const size_t used = strlen(known);
		snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", inputs[i].name);
	}
	text_quote(word, shown, sizeof shown);
	if (!head->input)
		return line_error(lines, why, "expected PARAM_IN %s, found '%s'", known, shown);
	return STATUS_OK;
}

/* "DIM 3 1" */
static enum status take_dimensions(struct head *head, const char *words, const struct line_reader *lines,
				   struct error *why)
{
	if (sscanf(words, "%9d %9d", &head->n_in, &head->n_out) != 2 || head->n_in < 1 ||
	    head->n_in > COORDINATES_MAX || (head->n_out != 1 && head->n_out != 3))
		return line_error(lines, why, "expected DIM with 1 to %d coordinates and 1 or 3 values",
				  COORDINATES_MAX);
	head->n_columns = head->n_in + head->n_out;
	return STATUS_OK;
}

/* "VS 0", "VS 1 1 1": for each value, or one number for all. */
static enum status take_confidence(struct head *head, const char *words, const struct line_reader *lines,
				   struct error *why)
{
	double number;
	int n = 0, sum = 0;
	for (words = line_skip_space((char *)words); text_number(&words, &number); n++) {
		if (!(number == 0 || number == 1 || number == 2) || n > 2)
			return line_error(lines, why, "expected VS with 0, 1 or 2 for each value");
		sum += (int)number;
		words = line_skip_space((char *)words);
	}
	if (!head->n_out || (n != 1 && n != head->n_out))
		return line_error(lines, why, "expected VS, after DIM, with a number for each value");
	head->n_columns = head->n_in + head->n_out + (n == 1 ? sum * head->n_out : sum);
	return STATUS_OK;
}

/* "#KEY words"; other keys are for people. */
static enum status take_line(struct head *head, const char *line, const struct line_reader *lines, struct error *why)
{
	char key[WORD_SIZE], word[WORD_SIZE] = "";
	int at = 0;
	if (sscanf(line, "#%63s%n %63s", key, &at, word) < 1)
		return STATUS_OK;
	if (!strcmp(key, "DIM"))
		return take_dimensions(head, line + at, lines, why);
	if (!strcmp(key, "VS"))
		return take_confidence(head, line + at, lines, why);
	if (!strcmp(key, "PARAM_IN"))
		return take_input(head, word, lines, why);
	if (!strcmp(key, "PARAM_OUT"))
		snprintf(head->output_word, sizeof head->output_word, "%s", word);
	if (!strcmp(key, "FORMAT") && !strcmp(word, "binary"))
		return error_set(why, STATUS_UNSUPPORTED, "line %zu: binary files of ALTA are not read, only text",
				 lines->number);
	return STATUS_OK;
}

static enum status check_head(struct head *head, const struct line_reader *lines, const struct read_options *options,
			      struct error *why)
{
	char shown[WORD_SIZE];
	for (int i = 0; i < OUTPUTS; i++)
		if (!strcmp(head->output_word, outputs[i].name))
			head->output = &outputs[i];
	text_quote(head->output_word, shown, sizeof shown);
	if (!head->n_out || !head->input)
		return line_error(lines, why, "expected DIM and PARAM_IN before the first row");
	if (head->n_in != head->input->n)
		return line_error(lines, why, "expected DIM %d for %s, found %d", head->input->n, head->input->name,
				  head->n_in);
	if (!head->output && options->quantity == QUANTITY_FROM_FILE)
		return line_error(
			lines, why,
			"expected PARAM_OUT INV_STERADIAN, INV_STERADIAN_COSINE_FACTOR, RGB_COLOR or XYZ_COLOR, "
			"or --quantity, found '%s'",
			shown);
	if (!head->output)
		head->output = &outputs[0];
	if (head->output->xyz && head->n_out != 3)
		return line_error(lines, why, "expected three values for XYZ_COLOR, found %d", head->n_out);
	return STATUS_OK;
}

static enum status add_row(const struct head *head, const struct line_reader *lines, const char *line,
			   enum quantity quantity, struct entry_list *list, struct error *why)
{
	double x[COLUMNS_MAX], rgb[MERL_CHANNELS];
	const struct channels channels = {.n = (size_t)head->n_out, .derived = head->output->xyz};
	struct vec3 wi, wo;
	size_t n;
	const enum status status = line_numbers(lines, line, x, COLUMNS_MAX, &n, why);
	if (status != STATUS_OK)
		return status;
	if (n != (size_t)head->n_columns)
		return line_error(lines, why, "expected %d values, found %zu", head->n_columns, n);
	head->input->directions(x, &wi, &wo);
	const double *value = x + head->n_in;
	if (head->output->xyz) {
		spectrum_xyz_to_rgb(value, rgb);
		value = rgb;
	}
	if (channels_add(&channels, quantity, wi, wo, value, 0, list) != STATUS_OK)
		return error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	return STATUS_OK;
}

static enum status parse(struct line_reader *lines, const struct read_options *options, struct entry_list *list,
			 struct error *why)
{
	struct head head = {0};
	bool began = false;
	for (char *line;;) {
		enum status status = line_reader_next(lines, &line, why);
		if (status != STATUS_OK)
			return status;
		if (!line)
			break;
		if (line[0] == '#') {
			status = began ? STATUS_OK : take_line(&head, line, lines, why);
		} else if (*line_skip_space(line)) {
			if (!began)
				status = check_head(&head, lines, options, why);
			began = true;
			const enum quantity quantity = status != STATUS_OK ? QUANTITY_FROM_FILE
						       : options->quantity != QUANTITY_FROM_FILE
							       ? options->quantity
							       : head.output->quantity;
			if (status == STATUS_OK)
				status = add_row(&head, lines, line, quantity, list, why);
		}
		if (status != STATUS_OK)
			return status;
	}
	list->has_symmetry = head.input && head.input->isotropic;
	list->symmetry = SYMMETRY_ISOTROPIC;
	channels_note(&(struct channels){.n = (size_t)head.n_out}, list);
	return STATUS_OK;
}

static enum match detect(const char *text)
{
	char line[4 * WORD_SIZE];
	while (text_line(&text, line, sizeof line) && (line[0] == '#' || !line[0]))
		if (!strncmp(line, "#DIM ", 5) || !strncmp(line, "#PARAM_IN ", 10))
			return MATCH_SURE;
	return MATCH_NONE;
}

const struct text_format alta = {detect, parse};
