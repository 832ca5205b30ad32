/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/zemax.h"
#include "data_readers/solid_angle.h"
#include "data_readers/spectrum.h"
#include "data_readers/text_number.h"
#include "data_readers/text_quote.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RADIAN (M_PI / 180)

enum { WORD_SIZE = 64 };

/* The angles of a file, in the order of its values. */
enum { ROTATION, INCIDENCE, AZIMUTH, RADIAL, AXES };

static const char *const axis_names[AXES] = {"SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial"};

struct axis {
	size_t n;
	double *angle; /* radians, rising */
	double *edge;  /* n + 1, of the cells */
};

struct grid {
	struct axis axis[AXES];
	bool half; /* symmetric to the plane of incidence: azimuths up to 180 degrees stand for both sides */
	bool xyz;
	size_t n;      /* values of a block */
	double *value; /* of all blocks, in the order of the file */
};

static void grid_free(struct grid *grid)
{
	for (int a = 0; a < AXES; a++) {
		free(grid->axis[a].angle);
		free(grid->axis[a].edge);
	}
	free(grid->value);
}

static enum status no_memory(struct error *why)
{
	return error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
}

static enum status ended(const struct line_reader *lines, const char *wanted, struct error *why)
{
	return line_error(lines, why, "expected %s, found the end of the file", wanted);
}

/* A word, and what is behind it, without blanks. */
struct words {
	char first[WORD_SIZE], second[WORD_SIZE];
};

static struct words split(const char *line)
{
	struct words words = {"", ""};
	if (sscanf(line, "%63s %63s", words.first, words.second) < 1)
		words.first[0] = '\0';
	return words;
}

/* The angles of an axis, which are told to be `words->second` many, on the next line or lines. */
static enum status read_axis(struct line_reader *lines, const struct words *words, struct axis *axis, struct error *why)
{
	const char *text = words->second;
	double number = 0;
	if (axis->n)
		return line_error(lines, why, "%s comes twice", words->first);
	/* An angle takes two bytes at least. */
	if (!text_number(&text, &number) || *text || !(number >= 1) || number != floor(number) ||
	    number > (double)lines->st.st_size / 2)
		return line_error(lines, why, "expected a number of angles that the file can hold behind %s",
				  words->first);
	const size_t n = (size_t)number;
	axis->angle = calloc(n, sizeof *axis->angle);
	axis->edge = calloc(n + 1, sizeof *axis->edge);
	if (!axis->angle || !axis->edge)
		return no_memory(why);
	for (size_t got = 0; got < n; got += axis->n) {
		char *line;
		enum status status = line_next_used(lines, &line, why);
		if (status == STATUS_OK && line)
			status = line_numbers(lines, line, axis->angle + got, n - got, &axis->n, why);
		if (status != STATUS_OK)
			return status;
		if (!line || axis->n > n - got)
			return line_error(lines, why, "expected %zu angles of %s, found %s", n, words->first,
					  line ? "more" : "fewer");
	}
	axis->n = n;
	for (size_t i = 0; i < n; i++) {
		axis->angle[i] *= RADIAN;
		if (!isfinite(axis->angle[i]) || (i && axis->angle[i] <= axis->angle[i - 1]))
			return line_error(lines, why, "expected angles of %s that rise", words->first);
	}
	return STATUS_OK;
}

/* A word that must be one of those the format has. */
static enum status take_word(struct grid *grid, const struct words *words, const struct line_reader *lines,
			     struct error *why)
{
	char shown[WORD_SIZE];
	text_quote(words->second, shown, sizeof shown);
	if (!strcmp(words->first, "Symmetry"))
		grid->half = !strcmp(words->second, "PlaneSymmetrical");
	if (!strcmp(words->first, "SpectralContent")) {
		grid->xyz = !strcmp(words->second, "XYZ");
		if (!grid->xyz && strcmp(words->second, "Monochrome") != 0)
			return line_error(lines, why, "expected SpectralContent Monochrome or XYZ, found '%s'", shown);
	}
	if (!strcmp(words->first, "ScatterType") && !strcmp(words->second, "BTDF"))
		return error_set(why, STATUS_UNSUPPORTED, "line %zu: expected ScatterType BRDF, found BTDF",
				 lines->number);
	return STATUS_OK;
}

/* The angles that an axis spans at most, of a grid that is there once. */
static void find_most(const struct grid *grid, double most[AXES])
{
	most[ROTATION] = 2 * M_PI;
	most[INCIDENCE] = M_PI_2;
	most[AZIMUTH] = grid->half ? M_PI : 2 * M_PI;
	most[RADIAL] = M_PI;
}

/* Beyond that, cells would overlap. */
static enum status check_axes(const struct line_reader *lines, const struct grid *grid, struct error *why)
{
	double most[AXES];
	find_most(grid, most);
	for (int a = 0; a < AXES; a++) {
		const struct axis *axis = &grid->axis[a];
		const bool turns = a == ROTATION || a == AZIMUTH;
		const double first = axis->angle ? axis->angle[0] : 0,
			     last = axis->angle ? axis->angle[axis->n - 1] : 0;
		if (last - (turns ? fmin(0, first) : 0) > most[a] * (1 + 1e-9) || (!turns && first < 0))
			return line_error(lines, why, "expected angles of %s %s %g degrees", axis_names[a],
					  turns ? "that span at most" : "from 0 to", most[a] / RADIAN);
	}
	return STATUS_OK;
}

/* Up to the first DataBegin. */
static enum status read_head(struct line_reader *lines, struct grid *grid, struct error *why)
{
	for (char *line;;) {
		enum status status = line_next_used(lines, &line, why);
		if (status != STATUS_OK)
			return status;
		if (!line)
			return ended(lines, "DataBegin", why);
		const struct words words = split(line);
		if (!strcmp(words.first, "DataBegin"))
			break;
		for (int a = 0; a < AXES && status == STATUS_OK; a++)
			if (!strcmp(words.first, axis_names[a]))
				status = read_axis(lines, &words, &grid->axis[a], why);
		if (status == STATUS_OK)
			status = take_word(grid, &words, lines, why);
		if (status != STATUS_OK)
			return status;
	}
	const enum status sound = check_axes(lines, grid, why);
	if (sound != STATUS_OK)
		return sound;
	double n = 1;
	for (int a = 0; a < AXES; a++) {
		if (!grid->axis[a].n)
			return line_error(lines, why, "expected %s before DataBegin", axis_names[a]);
		n *= (double)grid->axis[a].n;
	}
	if (n * (grid->xyz ? MERL_CHANNELS : 1) > (double)lines->st.st_size / 2)
		return line_error(lines, why, "the numbers of angles ask for %.0f values, more than the file can hold",
				  n);
	grid->n = (size_t)n;
	grid->value = calloc(grid->n * (grid->xyz ? MERL_CHANNELS : 1), sizeof *grid->value);
	return grid->value ? STATUS_OK : no_memory(why);
}

/* The rows of a block, and DataEnd. */
static enum status read_block(struct line_reader *lines, const struct grid *grid, double *value, struct error *why)
{
	const size_t n_radial = grid->axis[RADIAL].n;
	if (n_radial == 0)
		return line_error(lines, why, "expected ScatterRadial before the values");
	for (size_t at = 0; at <= grid->n;) {
		char *line;
		size_t n;
		enum status status = line_next_used(lines, &line, why);
		if (status != STATUS_OK)
			return status;
		if (!line)
			return ended(lines, at < grid->n ? "a row of values" : "DataEnd", why);
		const struct words words = split(line);
		if (!strcmp(words.first, "TIS"))
			continue;
		if (!strcmp(words.first, "DataEnd")) {
			if (at == grid->n)
				break;
			return line_error(lines, why, "expected %zu rows of values, found %zu", grid->n / n_radial,
					  at / n_radial);
		}
		if (at == grid->n)
			return line_error(lines, why, "expected DataEnd behind %zu rows of values", grid->n / n_radial);
		status = line_numbers(lines, line, value + at, n_radial, &n, why);
		if (status != STATUS_OK)
			return status;
		if (n != n_radial)
			return line_error(lines, why, "expected %zu values, found %zu", n_radial, n);
		at += n_radial;
	}
	return STATUS_OK;
}

static enum status read_blocks(struct line_reader *lines, const struct grid *grid, struct error *why)
{
	const int n_blocks = grid->xyz ? MERL_CHANNELS : 1;
	enum status status = STATUS_OK;
	for (int block = 0; block < n_blocks && status == STATUS_OK; block++) {
		char *line = "";
		while (block && status == STATUS_OK && strcmp(split(line).first, "DataBegin") != 0) {
			status = line_next_used(lines, &line, why);
			if (status == STATUS_OK && !line)
				status = ended(lines, "DataBegin of the next tristimulus value", why);
		}
		if (status == STATUS_OK)
			status = read_block(lines, grid, grid->value + (size_t)block * grid->n, why);
	}
	return status;
}

static void find_edges(struct grid *grid)
{
	double most[AXES];
	find_most(grid, most);
	for (int a = 0; a < AXES; a++) {
		struct axis *axis = &grid->axis[a];
		if (!axis->angle)
			continue;
		const double shift = a == ROTATION || a == AZIMUTH ? fmin(0, axis->angle[0]) : 0;
		solid_angle_edges(axis->angle, axis->n, shift, shift + most[a], axis->edge);
	}
}

static double band(const struct axis *axis, size_t i)
{
	return cos(axis->edge[i]) - cos(axis->edge[i + 1]);
}

/* Directions and solid angle of index[axis]. At radial 0 the cell has all azimuths. */
static void place(const struct grid *grid, const size_t index[AXES], struct vec3 *wi, struct vec3 *wo,
		  double *solid_angle)
{
	const struct axis *axis = grid->axis;
	const double incidence = axis[INCIDENCE].angle[index[INCIDENCE]], azimuth = axis[AZIMUTH].angle[index[AZIMUTH]];
	const double radial = axis[RADIAL].angle[index[RADIAL]], turn = axis[ROTATION].angle[index[ROTATION]];
	const struct vec3 mirror = direction(incidence, M_PI), to_normal = {cos(incidence), 0, sin(incidence)};
	const struct vec3 side = {0, 1, 0};
	const struct vec3 about = vec3_add(vec3_scale(to_normal, cos(azimuth)), vec3_scale(side, sin(azimuth)));
	const struct vec3 out = vec3_add(vec3_scale(mirror, cos(radial)), vec3_scale(about, sin(radial)));
	const double wide = radial == 0 ? axis[AZIMUTH].edge[axis[AZIMUTH].n] - axis[AZIMUTH].edge[0]
					: axis[AZIMUTH].edge[index[AZIMUTH] + 1] - axis[AZIMUTH].edge[index[AZIMUTH]];
	const double c = cos(turn), s = sin(turn);
	*wi = direction(incidence, -turn);
	*wo = (struct vec3){c * out.x + s * out.y, c * out.y - s * out.x, out.z};
	*solid_angle = 2 * M_PI / (double)axis[ROTATION].n * band(&axis[INCIDENCE], index[INCIDENCE]) *
		       band(&axis[RADIAL], index[RADIAL]) * wide * (grid->half ? 2 : 1);
}

static enum status add_entry(const struct grid *grid, size_t at, enum quantity quantity, struct entry_list *list)
{
	const struct channels channels = {.n = grid->xyz ? MERL_CHANNELS : 1, .derived = grid->xyz};
	double value[MERL_CHANNELS], solid_angle;
	size_t index[AXES], rest = at;
	struct vec3 wi, wo;
	bool zero = true;
	for (int a = AXES - 1; a >= 0; a--) {
		index[a] = rest % grid->axis[a].n;
		rest /= grid->axis[a].n;
	}
	if (grid->axis[RADIAL].angle[index[RADIAL]] == 0 && index[AZIMUTH])
		return STATUS_OK;
	for (size_t c = 0; c < channels.n; c++) {
		value[c] = grid->value[c * grid->n + at];
		zero = zero && value[c] == 0;
	}
	place(grid, index, &wi, &wo, &solid_angle);
	if (zero && wo.z > ENTRY_HORIZON) {
		list->n_missing++;
		return STATUS_OK;
	}
	if (grid->xyz) {
		const double xyz[3] = {value[0], value[1], value[2]};
		spectrum_xyz_to_rgb(xyz, value);
	}
	return channels_add(&channels, quantity, wi, wo, value, solid_angle, list);
}

static enum status parse(struct line_reader *lines, const struct read_options *options, struct entry_list *list,
			 struct error *why)
{
	struct grid grid = {.half = false};
	enum status status = read_head(lines, &grid, why);
	if (status == STATUS_OK)
		status = read_blocks(lines, &grid, why);
	if (status == STATUS_OK) {
		find_edges(&grid);
		channels_note(&(struct channels){.n = grid.xyz ? MERL_CHANNELS : 1}, list);
		list->from_grid = true;
		list->has_symmetry = true;
		list->symmetry = grid.axis[ROTATION].n > 1 ? SYMMETRY_ANISOTROPIC : SYMMETRY_ISOTROPIC;
	}
	for (size_t at = 0; at < grid.n && status == STATUS_OK; at++)
		if (add_entry(&grid, at, options->quantity, list) != STATUS_OK)
			status = no_memory(why);
	grid_free(&grid);
	return status;
}

static enum match detect(const char *text)
{
	char line[4 * WORD_SIZE];
	while (text_line(&text, line, sizeof line)) {
		const struct words words = split(line);
		if (!strcmp(words.first, "AngleOfIncidence") || !strcmp(words.first, "SampleRotation") ||
		    !strcmp(words.first, "ScatterType"))
			return MATCH_SURE;
		if (!line_is_comment(line) && strcmp(words.first, "Source") != 0 &&
		    strcmp(words.first, "Symmetry") != 0 && strcmp(words.first, "SpectralContent") != 0)
			return MATCH_NONE;
	}
	return MATCH_NONE;
}

const struct text_format zemax = {detect, parse};
