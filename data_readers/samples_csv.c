/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/samples_csv.h"
#include "data_readers/atomic_file.h"
#include "data_readers/text_number.h"
#include "data_readers/text_quote.h"
#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define RADIAN (M_PI / 180)

enum {
	COLUMNS_MAX = 4096,
	NAME_MAX_SIZE = 32,
};

/* What a column can be; wavelengths come after these. */
enum field {
	THETA_I,
	PHI_I,
	THETA_O,
	PHI_O,
	WI_X,
	WI_Y,
	WI_Z,
	WO_X,
	WO_Y,
	WO_Z,
	SOLID_ANGLE,
	VALUE,
	RED,
	GREEN,
	BLUE,
	FIELDS
};

static const char *const field_names[FIELDS] = {"theta_i",     "phi_i", "theta_o", "phi_o", "wi_x",
						"wi_y",        "wi_z",  "wo_x",    "wo_y",  "wo_z",
						"solid_angle", "value", "r",       "g",     "b"};

/* The line of names, understood. */
struct layout {
	char separator; /* ' ': blanks and tabs */
	size_t n;       /* columns */
	int *target;    /* of a column: a field, or FIELDS + number of the wavelength */
	bool has[FIELDS];
	double unit[FIELDS]; /* radians per number, of angles */
	double *nm;
	size_t n_nm;
	bool goniometer; /* named as goniometers do */
	/* What the comments said. */
	enum quantity quantity;
	bool has_symmetry;
	enum symmetry symmetry;
};

static void layout_free(struct layout *layout)
{
	free(layout->target);
	free(layout->nm);
	*layout = (struct layout){0};
}

static const char understood[] = "expected theta_i, phi_i, theta_o, phi_o (degrees, or _rad), or wi_x ... wo_z; r, g, "
				 "b, or value, or wavelengths "
				 "such as 550nm; solid_angle";

/* "# key: value" */
static enum status read_comment(const char *text, struct layout *layout, struct error *why)
{
	char key[NAME_MAX_SIZE], value[NAME_MAX_SIZE];
	if (sscanf(text, "# %31[a-z] %*[:=] %31[a-z_]", key, value) != 2 &&
	    sscanf(text, "# %31[a-z]: %31[a-z_]", key, value) != 2)
		return STATUS_OK;
	if (!strcmp(key, "quantity") && quantity_find(value, &layout->quantity) != STATUS_OK)
		return error_set(why, STATUS_FORMAT,
				 "expected the quantity brdf, brdf_cos or reflectance_factor, found '%s'", value);
	if (strcmp(key, "symmetry") != 0)
		return STATUS_OK;
	if (symmetry_find(value, &layout->symmetry) != STATUS_OK)
		return error_set(why, STATUS_FORMAT,
				 "expected the symmetry isotropic, plane or anisotropic, found '%s'", value);
	layout->has_symmetry = true;
	return STATUS_OK;
}

/* Whether the name is a number of nanometres, with nm behind it or not. */
static bool is_wavelength(const char *name, double *nm)
{
	const double least = 100, most = 100000;
	if (!isdigit((unsigned char)*name) || !text_number(&name, nm) || !(*nm >= least && *nm <= most))
		return false;
	name = line_skip_space((char *)name);
	return !*name || !strcasecmp(name, "nm");
}

/* The field of a name, or FIELDS. */
static int field_of(const char *name, struct layout *layout, double *unit)
{
	char plain[NAME_MAX_SIZE];
	*unit = 1;
	if (!strcasecmp(name, "incident_angle") || !strcasecmp(name, "incident angle") ||
	    !strcasecmp(name, "measure_angle") || !strcasecmp(name, "measure angle")) {
		layout->goniometer = true;
		*unit = RADIAN;
		return tolower((unsigned char)*name) == 'i' ? THETA_I : THETA_O;
	}
	snprintf(plain, sizeof plain, "%s", name);
	const size_t length = strlen(plain);
	const bool radians = length > 4 && !strcasecmp(plain + length - 4, "_rad");
	const bool degrees = length > 4 && !strcasecmp(plain + length - 4, "_deg");
	if (radians || degrees)
		plain[length - 4] = '\0';
	for (int f = 0; f < FIELDS; f++) {
		if (strcasecmp(field_names[f], plain) != 0 || strlen(name) >= sizeof plain)
			continue;
		*unit = f <= PHI_O && !radians ? RADIAN : 1;
		return f > PHI_O && (radians || degrees) ? FIELDS : f;
	}
	return FIELDS;
}

static enum status take_column(struct layout *layout, const char *name, struct error *why)
{
	char shown[TEXT_QUOTE_SIZE / 2];
	double unit, nm;
	text_quote(name, shown, sizeof shown);
	if (is_wavelength(name, &nm)) {
		layout->target[layout->n++] = FIELDS + (int)layout->n_nm;
		layout->nm[layout->n_nm++] = nm;
		return STATUS_OK;
	}
	const int field = field_of(name, layout, &unit);
	if (field == FIELDS)
		return error_set(why, STATUS_FORMAT, "column '%s' is not understood: %s", shown, understood);
	if (layout->has[field])
		return error_set(why, STATUS_FORMAT, "two columns are '%s'", shown);
	layout->has[field] = true;
	layout->unit[field] = unit;
	layout->target[layout->n++] = field;
	return STATUS_OK;
}

static bool has_all(const struct layout *layout, int first, int last)
{
	int n = 0;
	for (int f = first; f <= last; f++)
		n += layout->has[f];
	return n == last - first + 1;
}

static bool has_any(const struct layout *layout, int first, int last)
{
	int n = 0;
	for (int f = first; f <= last; f++)
		n += layout->has[f];
	return n > 0;
}

/* The columns must give directions in one way, and values in one. */
static enum status check_layout(const struct layout *layout, struct error *why)
{
	const bool angles = has_any(layout, THETA_I, PHI_O), vectors = has_any(layout, WI_X, WO_Z);
	const bool whole =
		angles ? layout->has[THETA_I] && layout->has[THETA_O] && (layout->has[PHI_O] || !layout->has[PHI_I])
		       : has_all(layout, WI_X, WO_Z);
	const int ways = layout->has[VALUE] + has_any(layout, RED, BLUE) + (layout->n_nm > 0);
	if (angles == vectors || !whole)
		return error_set(why, STATUS_FORMAT, "the columns do not give both directions: %s", understood);
	if (ways != 1 || has_any(layout, RED, BLUE) != has_all(layout, RED, BLUE))
		return error_set(why, STATUS_FORMAT, "the columns do not give values in one way: %s", understood);
	return STATUS_OK;
}

static char separator_of(const char *line)
{
	if (strchr(line, ','))
		return ',';
	return strchr(line, ';') ? ';' : ' ';
}

/* Cuts the next name off, without blanks and quotes around it. */
static char *next_name(char **text, char separator)
{
	char *name = line_skip_space(*text);
	const char stops[] = {separator, separator == ' ' ? '\t' : '\0', '\0'};
	size_t length = strcspn(name, stops);
	*text = name + length + (name[length] != '\0');
	while (length > 0 && (name[length - 1] == ' ' || name[length - 1] == '\t'))
		length--;
	const bool quoted = length >= 2 && name[0] == '"' && name[length - 1] == '"';
	name[length - quoted] = '\0';
	return name + quoted;
}

/* Understands the line of names, which it takes apart. */
static enum status read_names(char *line, struct layout *layout, struct error *why)
{
	layout->separator = separator_of(line);
	layout->target = calloc(COLUMNS_MAX, sizeof *layout->target);
	layout->nm = calloc(COLUMNS_MAX, sizeof *layout->nm);
	if (!layout->target || !layout->nm)
		return error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	char *rest = line;
	while (*line_skip_space(rest)) {
		if (layout->n == COLUMNS_MAX)
			return error_set(why, STATUS_FORMAT, "expected at most %d columns", COLUMNS_MAX);
		const enum status status = take_column(layout, next_name(&rest, layout->separator), why);
		if (status != STATUS_OK)
			return status;
	}
	return check_layout(layout, why);
}

static bool is_blank(const char *line)
{
	return !*line_skip_space((char *)line);
}

static enum match detect(const char *text)
{
	enum { LINE = 1 << 15 };
	char *line = malloc(LINE);
	struct layout layout = {0};
	struct error why;
	enum match match = MATCH_NONE;
	while (line && text_line(&text, line, LINE)) {
		if (line[0] == '#' || is_blank(line))
			continue;
		if (read_names(line, &layout, &why) == STATUS_OK)
			match = MATCH_SURE;
		else if (has_any(&layout, THETA_I, WO_Z))
			match = MATCH_MAYBE;
		break;
	}
	layout_free(&layout);
	free(line);
	return match;
}

/* Rows */

static enum status bad_field(const struct line_reader *lines, const struct layout *layout, size_t column,
			     const char *found, struct error *why)
{
	const int target = layout->target[column];
	char word[NAME_MAX_SIZE], shown[2 * NAME_MAX_SIZE];
	snprintf(word, sizeof word, "%.*s", (int)strcspn(found, ",; \t"), found);
	text_quote(word, shown, sizeof shown);
	if (target < FIELDS)
		return line_error(lines, why, "expected a number for %s, found '%s'", field_names[target], shown);
	return line_error(lines, why, "expected a number for %gnm, found '%s'", layout->nm[target - FIELDS], shown);
}

/* Reads the fields of a row into value[target]. *empty: one of them has nothing in it. */
static enum status read_row(const struct line_reader *lines, const struct layout *layout, const char *line,
			    double *value, bool *empty, struct error *why)
{
	const char separator = layout->separator, *at = line;
	size_t n = 0;
	*empty = false;
	for (bool more = true; more; n++) {
		double number = NAN;
		at = line_skip_space((char *)at);
		if (n == layout->n) {
			if (!*at && separator == ' ')
				break;
			return line_error(lines, why, "expected %zu values, found more", layout->n);
		}
		if (separator == ' ' && !*at)
			break;
		if (*at == separator || !*at)
			*empty = true;
		else if (!text_number(&at, &number))
			return bad_field(lines, layout, n, at, why);
		value[layout->target[n]] = number;
		const char *end = line_skip_space((char *)at);
		if (*end && separator != ' ' && *end != separator)
			return bad_field(lines, layout, n, at, why);
		if (*end && separator == ' ' && end == at)
			return bad_field(lines, layout, n, at, why);
		more = *end;
		at = end + (*end == separator);
	}
	if (n != layout->n)
		return line_error(lines, why, "expected %zu values, found %zu", layout->n, n);
	return STATUS_OK;
}

/* The directions of a row. False: a vector that has not the length 1. */
static bool directions(const struct layout *layout, const double *v, struct vec3 *wi, struct vec3 *wo)
{
	const double bad_length = 0.01;
	if (layout->has[THETA_I]) {
		const double phi_i = layout->has[PHI_I] ? v[PHI_I] * layout->unit[PHI_I] : 0;
		const double phi_o = layout->has[PHI_O] ? v[PHI_O] * layout->unit[PHI_O] : M_PI;
		*wi = direction(v[THETA_I] * layout->unit[THETA_I], phi_i);
		*wo = direction(v[THETA_O] * layout->unit[THETA_O], phi_o);
		return true;
	}
	*wi = (struct vec3){v[WI_X], v[WI_Y], v[WI_Z]};
	*wo = (struct vec3){v[WO_X], v[WO_Y], v[WO_Z]};
	const double i = vec3_length(*wi), o = vec3_length(*wo);
	*wi = vec3_scale(*wi, 1 / i);
	*wo = vec3_scale(*wo, 1 / o);
	return !(fabs(i - 1) > bad_length || fabs(o - 1) > bad_length);
}

struct rows {
	const struct layout *layout;
	struct channels channels;
	enum quantity quantity;
	double *value; /* FIELDS and the wavelengths */
};

static enum status add_row(struct rows *rows, const struct line_reader *lines, const char *line,
			   struct entry_list *list, struct error *why)
{
	const struct layout *layout = rows->layout;
	struct vec3 wi, wo;
	bool empty;
	const enum status status = read_row(lines, layout, line, rows->value, &empty, why);
	if (status != STATUS_OK)
		return status;
	if (empty) {
		list->n_missing++;
		return STATUS_OK;
	}
	if (!directions(layout, rows->value, &wi, &wo))
		return line_error(lines, why, "expected directions of length 1");
	const double solid_angle = layout->has[SOLID_ANGLE] ? rows->value[SOLID_ANGLE] : 0;
	if (!(solid_angle >= 0 && solid_angle <= 4 * M_PI * M_PI))
		return line_error(lines, why, "expected a solid_angle of 0 to 4 pi^2 sr^2");
	const double *value = rows->value + (layout->n_nm ? FIELDS : layout->has[VALUE] ? VALUE : RED);
	if (channels_add(&rows->channels, rows->quantity, wi, wo, value, solid_angle, list) != STATUS_OK)
		return error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	return STATUS_OK;
}

static enum quantity choose_quantity(const struct layout *layout, const struct read_options *options)
{
	if (options->quantity != QUANTITY_FROM_FILE)
		return options->quantity;
	if (layout->quantity != QUANTITY_FROM_FILE)
		return layout->quantity;
	return layout->goniometer ? QUANTITY_REFLECTANCE_FACTOR : QUANTITY_BRDF;
}

static enum status prepare_rows(struct rows *rows, struct layout *layout, const struct line_reader *lines,
				const struct read_options *options, struct entry_list *list, struct error *why)
{
	enum status status = STATUS_OK;
	*rows = (struct rows){.layout = layout, .channels = {.n = layout->has[VALUE] ? 1 : 3}};
	rows->quantity = choose_quantity(layout, options);
	rows->value = calloc(FIELDS + layout->n_nm, sizeof *rows->value);
	if (layout->n_nm) {
		status = channels_spectrum(&rows->channels, layout->nm, layout->n_nm);
		layout->nm = rows->value && status == STATUS_OK ? rows->channels.nm : NULL;
	}
	if (status == STATUS_DOMAIN)
		return line_error(lines, why, "expected wavelengths that rise from column to column");
	if (status != STATUS_OK || !rows->value)
		return error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	list->from_grid = layout->has[SOLID_ANGLE];
	list->has_symmetry = layout->has_symmetry;
	list->symmetry = layout->symmetry;
	channels_note(&rows->channels, list);
	return STATUS_OK;
}

/* The comments and the line of names. */
static enum status read_head(struct line_reader *lines, struct layout *layout, struct error *why)
{
	for (char *line;;) {
		struct error said;
		enum status status = line_reader_next(lines, &line, why);
		if (status != STATUS_OK)
			return status;
		if (!line)
			return error_set(why, STATUS_FORMAT, "there is no line of names: %s", understood);
		if (is_blank(line))
			continue;
		const bool comment = line[0] == '#';
		status = comment ? read_comment(line, layout, &said) : read_names(line, layout, &said);
		if (status == STATUS_NO_MEMORY)
			return error_set(why, status, "%s", said.text);
		if (status != STATUS_OK)
			return line_error(lines, why, "%s", said.text);
		if (!comment)
			return STATUS_OK;
	}
}

static enum status parse(struct line_reader *lines, const struct read_options *options, struct entry_list *list,
			 struct error *why)
{
	struct layout layout = {0};
	struct rows rows = {0};
	enum status status = read_head(lines, &layout, why);
	if (status == STATUS_OK)
		status = prepare_rows(&rows, &layout, lines, options, list, why);
	for (char *line = ""; status == STATUS_OK && line;) {
		status = line_reader_next(lines, &line, why);
		if (status == STATUS_OK && line && line[0] != '#' && !is_blank(line))
			status = add_row(&rows, lines, line, list, why);
	}
	if (rows.channels.nm == layout.nm)
		layout.nm = NULL;
	channels_free(&rows.channels);
	free(rows.value);
	layout_free(&layout);
	return status;
}

const struct text_format samples_csv = {detect, parse};

/* Writing */

struct writing {
	FILE *stream;
	bool gray;
	size_t n;
};

static double degrees_of(double angle)
{
	return angle / RADIAN;
}

static double polar_degrees(struct vec3 v)
{
	return degrees_of(atan2(hypot(v.x, v.y), v.z));
}

static double azimuth_degrees(struct vec3 v)
{
	return v.x == 0 && v.y == 0 ? 0 : degrees_of(atan2(v.y, v.x));
}

static void write_row(struct writing *w, struct vec3 wi, struct vec3 wo, const float value[MERL_CHANNELS],
		      double solid_angle)
{
	fprintf(w->stream, "%.15g,%.15g,%.15g,%.15g", polar_degrees(wi), azimuth_degrees(wi), polar_degrees(wo),
		azimuth_degrees(wo));
	for (int c = 0; c < (w->gray ? 1 : MERL_CHANNELS); c++)
		fprintf(w->stream, ",%.9g", (double)value[c]);
	fprintf(w->stream, ",%.9g\n", solid_angle);
	w->n++;
}

static void write_scattered(struct writing *w, const struct scattered *s)
{
	for (size_t e = 0; e < s->n; e++)
		write_row(w, s->wi[e], s->wo[e], (float[]){s->value[0][e], s->value[1][e], s->value[2][e]},
			  (double)s->solid_angle[e]);
}

static void write_table(struct writing *w, const struct measurement *m, enum bins bins)
{
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < m->n_phi_d; k++) {
				const size_t at = measurement_at(m->n_phi_d, i, j, k);
				struct vec3 wi, wo;
				if (isnan(m->value[0][at]))
					continue;
				halfdiff_trig_dirs(bins_trig(bins, i, j, k), &wi, &wo);
				if (wi.z > ENTRY_HORIZON && wo.z > ENTRY_HORIZON)
					write_row(w, wi, wo,
						  (float[]){m->value[0][at], m->value[1][at], m->value[2][at]},
						  cell_measure(i, j) * 360 / m->n_phi_d);
			}
}

enum status samples_csv_write(const char *path, const struct measurement *measurement, enum bins bins, size_t *n,
			      struct error *error)
{
	struct atomic_file file;
	const struct scattered *s = measurement->scattered;
	enum status status = atomic_file_open(&file, path, error);
	if (status != STATUS_OK)
		return status;
	struct writing w = {.stream = file.stream, .gray = s && s->gray};
	fprintf(w.stream, "# quantity: brdf\n# symmetry: %s\ntheta_i,phi_i,theta_o,phi_o,%s,solid_angle\n",
		symmetry_name(s ? s->symmetry : SYMMETRY_ISOTROPIC), w.gray ? "value" : "r,g,b");
	if (s)
		write_scattered(&w, s);
	else
		write_table(&w, measurement, bins);
	*n = w.n;
	if (w.n)
		return atomic_file_commit(&file, error);
	atomic_file_abort(&file);
	return error_set(error, STATUS_NO_DATA, "there is no valid entry above the horizon");
}
