/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/text_quote.h"
#include "fit/plot/error_map.h"
#include "fit/plot/gnuplot.h"
#include "fit/plot/measured_ndf.h"
#include "fit/plot/plot_common.h"
#include "fit/plot/plot_files.h"
#include "fit/plot/slice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const plot_material_names[] = {"ndf", "slices", "slices_0", "map"};
const char *const plot_material_tables[] = {"ndf_D.csv", "ndf_G1.csv", "slices.csv", "map.csv"};

/* Room for the axes and one panel of a grid of them. */
enum { PANEL_WIDTH = 360, PANEL_HEIGHT = 300 };

static double degrees(double radians)
{
	return radians * 180 / M_PI;
}

static double theta_h_deg(enum bins bins, int i)
{
	return degrees(bins_angles(bins, i, 0, 0).theta_h);
}

static double theta_d_deg(enum bins bins, int j)
{
	return degrees(bins_angles(bins, 0, j, 0).theta_d);
}

static double phi_d_deg(enum bins bins, enum slice_phi_d k)
{
	return degrees(bins_angles(bins, 0, 0, (int)k).phi_d);
}

static enum bins bins_of(const struct material_data *data)
{
	return data->fit[0].options.criterion.bins;
}

/* theta_h in the table's own spacing, which gives the peak room. */
static void put_theta_h_axis(FILE *file)
{
	fputs("set nonlinear x via sqrt(x) inverse x*x\nset xrange [0:90]\nset xtics (0, 1, 5, 10, 20, 40, 60, 90)\n"
	      "set xlabel \"θ_h (degrees)\"\n",
	      file);
}

static void put_grid(FILE *file, int n, int columns, const char *margins, const char *what, const char *material)
{
	char title[TEXT_QUOTE_SIZE + 128], shown[TEXT_QUOTE_SIZE];
	text_quote(material, shown, sizeof shown);
	snprintf(title, sizeof title, "%s: %s", shown, what);
	fprintf(file, "set multiplot layout %d,%d %s title ", (n + columns - 1) / columns, columns, margins);
	gnuplot_string(file, title);
	fputs(" noenhanced\n", file);
}

/* ndf */

/* What was read off the data with each fit; readings without a specular term are empty. */
struct readings {
	struct measured_ndf ndf[FIT_NDFS_MAX];
	bool made[FIT_NDFS_MAX];
};

static enum status read_ndfs(const struct material_data *data, struct readings *readings, struct error *error)
{
	*readings = (struct readings){.made = {false}};
	for (int f = 0; f < data->n; f++) {
		const struct fitted *fit = &data->fit[f];
		const enum status status = measured_ndf_make(&data->measurement, &fit->model,
							     fit->options.criterion.bins, &readings->ndf[f]);
		if (status == STATUS_NO_MEMORY)
			return error_set(error, status, "out of memory");
		readings->made[f] = status == STATUS_OK;
	}
	return STATUS_OK;
}

static void readings_free(struct readings *readings)
{
	for (int f = 0; f < FIT_NDFS_MAX; f++)
		measured_ndf_free(&readings->ndf[f]);
}

static void put_header(FILE *file, const char *first, const struct material_data *data, const char *const *what, int n)
{
	fputs(first, file);
	for (int f = 0; f < data->n; f++)
		for (int w = 0; w < n; w++)
			fprintf(file, ",%s_%s", data->fit[f].ndf, what[w]);
	fputc('\n', file);
}

static enum status write_D(const char *directory, const struct material_data *data, const struct readings *readings,
			   struct plot_range *range, struct error *error)
{
	static const char *const what[] = {"D", "D_measured"};
	struct atomic_file file;
	const enum status status = plot_open(&file, directory, "ndf_D.csv", error);
	if (status != STATUS_OK)
		return status;
	put_header(file.stream, "theta_h_deg", data, what, 2);
	for (int i = 0; i < MERL_THETA_H; i++) {
		fprintf(file.stream, "%.9g", theta_h_deg(bins_of(data), i));
		const struct halfdiff_trig h = bins_trig(bins_of(data), i, 0, 0);
		for (int f = 0; f < data->n; f++) {
			const double D = ndf_D(&data->fit[f].model.ndf, (struct vec3){h.sin_h, 0, h.cos_h});
			const double measured = readings->made[f] ? readings->ndf[f].D[i] : NAN;
			plot_number(file.stream, readings->made[f] ? D : NAN);
			plot_number(file.stream, measured);
			plot_range_add(range, measured);
		}
		fputc('\n', file.stream);
	}
	return atomic_file_commit(&file, error);
}

static enum status write_G1(const char *directory, const struct material_data *data, const struct readings *readings,
			    struct error *error)
{
	static const char *const what[] = {"G1", "G1_measured"};
	struct atomic_file file;
	const enum status status = plot_open(&file, directory, "ndf_G1.csv", error);
	if (status != STATUS_OK)
		return status;
	put_header(file.stream, "theta_deg", data, what, 2);
	for (int a = 0; a <= 90; a++) {
		const struct vec3 w = {sin(a * M_PI / 180), 0, a < 90 ? cos(a * M_PI / 180) : 0};
		fprintf(file.stream, "%d", a);
		for (int f = 0; f < data->n; f++) {
			plot_number(file.stream, readings->made[f] ? ndf_G1(&data->fit[f].model.ndf, w) : NAN);
			plot_number(file.stream, readings->made[f] ? pwl_G1(&readings->ndf[f].pwl, w) : NAN);
		}
		fputc('\n', file.stream);
	}
	return atomic_file_commit(&file, error);
}

static void put_D_panel(FILE *file, const struct material_data *data, int f)
{
	fputs("set title ", file);
	gnuplot_string(file, data->fit[f].ndf);
	fprintf(file,
		"\nplot \"ndf_D.csv\" skip 1 using 1:%d with lines lw 5 lc rgb \"#c0c0c0\" title \"read off "
		"the "
		"data\", \"\" skip 1 using 1:%d with lines lw 2 dt %d lc rgb \"%s\" title \"D of the fit\"\n",
		2 * f + 3, 2 * f + 2, plot_dash(data->fit[f].ndf, f), plot_colour(data->fit[f].ndf, f));
}

static void put_G1_panel(FILE *file, const struct material_data *data)
{
	fputs("set title \"G_1; thin: of the D read off the data\" enhanced\n"
	      "unset logscale y\nset ytics 0.2\nset format y \"%g\"\nset yrange [0:1.05]\nunset nonlinear x\nset xtics "
	      "15\n"
	      "set xlabel \"θ (degrees)\"\nset ylabel \"\"\nset key left bottom\nplot ",
	      file);
	for (int f = 0; f < data->n; f++) {
		fprintf(file, "%s\"ndf_G1.csv\" skip 1 using 1:%d with lines lw 2.5 dt %d lc rgb \"%s\" title ",
			f ? ", " : "", 2 * f + 2, plot_dash(data->fit[f].ndf, f), plot_colour(data->fit[f].ndf, f));
		gnuplot_string(file, data->fit[f].ndf);
		fprintf(file, ", \"\" skip 1 using 1:%d with lines lw 1 dt %d lc rgb \"%s\" notitle", 2 * f + 3,
			plot_dash(data->fit[f].ndf, f), plot_colour(data->fit[f].ndf, f));
	}
	fputc('\n', file);
}

static enum status write_ndf_script(const char *directory, const struct material_data *data,
				    const struct plot_range *range, struct error *error)
{
	struct atomic_file file;
	const int n = data->n + 1, columns = n <= 4 ? 2 : 3;
	const enum status status = plot_open(&file, directory, "ndf.gp", error);
	if (status != STATUS_OK)
		return status;
	gnuplot_begin(file.stream, "ndf", columns * 450, 40 + (n + columns - 1) / columns * PANEL_HEIGHT);
	put_grid(file.stream, n, columns, "",
		 "D of each fit, and as that fit reads it off the data at small difference angles", data->name);
	put_theta_h_axis(file.stream);
	plot_log_range(file.stream, range, 100, 10);
	fputs("set ylabel \"D (1/sr)\"\nset key right top\n", file.stream);
	for (int f = 0; f < data->n; f++)
		put_D_panel(file.stream, data, f);
	put_G1_panel(file.stream, data);
	fputs("unset multiplot\n", file.stream);
	gnuplot_end(file.stream);
	return atomic_file_commit(&file, error);
}

enum status plot_ndf(const char *directory, const struct material_data *data, struct error *error)
{
	struct readings *readings = calloc(1, sizeof(*readings));
	struct plot_range range = {0, 0};
	if (!readings)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	enum status status = read_ndfs(data, readings, error);
	if (status == STATUS_OK)
		status = write_D(directory, data, readings, &range, error);
	if (status == STATUS_OK)
		status = write_G1(directory, data, readings, error);
	if (status == STATUS_OK)
		status = write_ndf_script(directory, data, &range, error);
	readings_free(readings);
	free(readings);
	return status;
}

/* slices */

static const int slice_theta_d[] = {0, 15, 30, 45, 60, 75};
enum {
	SLICES = sizeof slice_theta_d / sizeof *slice_theta_d,
	SLICE_FIRST = 5, /* column of the first measured channel, behind that of their mean */
	SLICE_WIDTH = 205,
	SLICE_HEIGHT = 200
};

/* Both planes have their lines in the file, one after the other. */
static const struct {
	enum slice_phi_d phi_d;
	const char *name, *what;
} slice_planes[] = {
	{SLICE_ACROSS, "slices", "measured and fitted at right angles to the mirror plane"},
	{SLICE_IN_PLANE, "slices_0", "measured and fitted in the mirror plane"},
};
enum { SLICE_PLANES = sizeof slice_planes / sizeof *slice_planes };

/* Mean of the three channels, and these. */
static void put_channels(FILE *file, const double f[MERL_CHANNELS], struct plot_range *range)
{
	plot_number(file, (f[0] + f[1] + f[2]) / MERL_CHANNELS);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		plot_number(file, f[c]);
		if (range)
			plot_range_add(range, f[c]);
	}
}

static void put_slice(FILE *file, const struct material_data *data, enum slice_phi_d phi_d, int j,
		      struct plot_range *range)
{
	for (int i = 0; i < MERL_THETA_H; i++) {
		double f[MERL_CHANNELS];
		fprintf(file, "%.9g,%.9g,%.9g", phi_d_deg(bins_of(data), phi_d), theta_d_deg(bins_of(data), j),
			theta_h_deg(bins_of(data), i));
		slice_measured(&data->measurement, phi_d, i, j, f);
		put_channels(file, f, range);
		for (int n = 0; n < data->n; n++) {
			slice_model(&data->fit[n].model, data->fit[n].options.criterion.bins, phi_d, i, j, f);
			put_channels(file, f, NULL);
		}
		fputc('\n', file);
	}
}

static enum status write_slices(const char *directory, const struct material_data *data, struct plot_range *range,
				struct error *error)
{
	static const char *const what[] = {"mean", "r", "g", "b"};
	struct atomic_file file;
	const enum status status = plot_open(&file, directory, "slices.csv", error);
	if (status != STATUS_OK)
		return status;
	put_header(file.stream, "phi_d_deg,theta_d_deg,theta_h_deg,measured_mean,measured_r,measured_g,measured_b",
		   data, what, 4);
	for (int p = 0; p < SLICE_PLANES; p++)
		for (int s = 0; s < SLICES; s++)
			put_slice(file.stream, data, slice_planes[p].phi_d, slice_theta_d[s], range);
	return atomic_file_commit(&file, error);
}

/* The lines of one panel are next to each other in the file. */
static void put_slice_panel(FILE *file, const struct material_data *data, int plane, int channel, int s)
{
	static const char *const name[] = {"red", "green", "blue"};
	const int from = 1 + (plane * SLICES + s) * MERL_THETA_H, to = from + MERL_THETA_H - 1;
	const bool left = s == 0, top = channel == 0, bottom = channel == MERL_CHANNELS - 1;
	if (top)
		fprintf(file, "set title \"θ_d = %g°, φ_d = %g°\"\n", theta_d_deg(bins_of(data), slice_theta_d[s]),
			phi_d_deg(bins_of(data), slice_planes[plane].phi_d));
	else
		fputs("unset title\n", file);
	fputs(left && top ? "set key at screen 0.99,0.957 right top maxrows 1\n" : "unset key\n", file);
	/* All panels have the same axes. */
	fprintf(file, "set ylabel \"%s%s\"\nset format y \"%s\"\n", left ? name[channel] : "", left ? " (1/sr)" : "",
		left ? "10^{%T}" : "");
	fprintf(file, "set xlabel \"%s\"\nset format x \"%s\"\n", bottom ? "θ_h (degrees)" : "", bottom ? "%g" : "");
	fprintf(file,
		"plot \"slices.csv\" every ::%d::%d using 3:%d with lines lw 5 lc rgb \"#c0c0c0\" title \"measured\"",
		from, to, SLICE_FIRST + channel);
	for (int f = 0; f < data->n; f++) {
		fprintf(file, ", \"\" every ::%d::%d using 3:%d with lines lw 1.8 dt %d lc rgb \"%s\" title ", from, to,
			SLICE_FIRST + channel + 4 * (f + 1), plot_dash(data->fit[f].ndf, f),
			plot_colour(data->fit[f].ndf, f));
		gnuplot_string(file, data->fit[f].ndf);
	}
	fputc('\n', file);
}

static enum status write_slices_script(const char *directory, const struct material_data *data, int plane,
				       const struct plot_range *range, struct error *error)
{
	enum { LEFT = 80, RIGHT = 20, TOP = 112, BOTTOM = 60 };
	const int width = LEFT + SLICES * SLICE_WIDTH + RIGHT, height = TOP + MERL_CHANNELS * SLICE_HEIGHT + BOTTOM;
	char name[32], margins[96];
	struct atomic_file file;
	snprintf(name, sizeof name, "%s.gp", slice_planes[plane].name);
	const enum status status = plot_open(&file, directory, name, error);
	if (status != STATUS_OK)
		return status;
	snprintf(margins, sizeof margins, "margins %.4g,%.4g,%.4g,%.4g spacing 0.01,0.02", (double)LEFT / width,
		 1 - (double)RIGHT / width, (double)BOTTOM / height, 1 - (double)TOP / height);
	gnuplot_begin(file.stream, slice_planes[plane].name, width, height);
	put_grid(file.stream, MERL_CHANNELS * SLICES, SLICES, margins, slice_planes[plane].what, data->name);
	put_theta_h_axis(file.stream);
	fputs("set xtics (0, 5, 20, 40, 60, \"\" 90)\n", file.stream);
	plot_log_range(file.stream, range, 5, 5);
	for (int c = 0; c < MERL_CHANNELS; c++)
		for (int s = 0; s < SLICES; s++)
			put_slice_panel(file.stream, data, plane, c, s);
	fputs("unset multiplot\n", file.stream);
	gnuplot_end(file.stream);
	return atomic_file_commit(&file, error);
}

enum status plot_slices(const char *directory, const struct material_data *data, struct error *error)
{
	struct plot_range range = {0, 0};
	enum status status = write_slices(directory, data, &range, error);
	for (int p = 0; p < SLICE_PLANES && status == STATUS_OK; p++)
		status = write_slices_script(directory, data, p, &range, error);
	return status;
}

/* map */

static enum status make_maps(const struct material_data *data, struct metrics_row *rows, struct error *error)
{
	for (int f = 0; f < data->n; f++) {
		const struct fitted *fit = &data->fit[f];
		const enum status status =
			error_map_make(&data->measurement, &fit->model, &fit->options, rows + (size_t)f * MERL_ROWS);
		if (status != STATUS_OK)
			return error_set(error, status, "%s", status_str(status));
	}
	return STATUS_OK;
}

static enum status write_maps(const char *directory, const struct material_data *data, const struct metrics_row *rows,
			      struct error *error)
{
	static const char *const what[] = {"error"};
	struct atomic_file file;
	const enum status status = plot_open(&file, directory, "map.csv", error);
	if (status != STATUS_OK)
		return status;
	put_header(file.stream, "theta_h_index,theta_d_index,theta_h_deg,theta_d_deg,samples", data, what, 1);
	for (int n = 0; n < MERL_ROWS; n++) {
		const int i = n / MERL_THETA_D, j = n % MERL_THETA_D;
		fprintf(file.stream, "%d,%d,%.9g,%.9g,%zu", i, j, theta_h_deg(bins_of(data), i),
			theta_d_deg(bins_of(data), j), rows[n].samples);
		for (int f = 0; f < data->n; f++) {
			const double e = error_map_error(&rows[(size_t)f * MERL_ROWS + (size_t)n]);
			plot_number(file.stream, isinf(e) ? 1e9 : e); /* gnuplot has no colour for infinity */
		}
		fputc('\n', file.stream);
	}
	return atomic_file_commit(&file, error);
}

/* The axes count rows of the table; their tics say degrees. */
static void put_map_axes(FILE *file, enum bins bins)
{
	static const double theta_h[] = {0, 1, 5, 10, 20, 40, 60, 90};
	const double shift = bins == BINS_CENTRE ? 0.5 : 0;
	fputs("set xtics (", file);
	for (size_t t = 0; t < sizeof theta_h / sizeof *theta_h; t++)
		fprintf(file, "%s\"%g\" %.9g", t ? ", " : "", theta_h[t], sqrt(90 * theta_h[t]) - shift);
	fputs(")\nset ytics (", file);
	for (int t = 0; t <= 90; t += 15)
		fprintf(file, "%s\"%d\" %g", t ? ", " : "", t, t - shift);
	fputs(")\nset xrange [-0.5:89.5]\nset yrange [-0.5:89.5]\nset xlabel \"θ_h (degrees)\"\n", file);
}

/* Sequential, from the colour of paper: what is good fades. */
static const char palette[] =
	"set palette defined (0 \"#ffffff\", 0.125 \"#fee8c8\", 0.25 \"#fdd49e\", 0.375 \"#fdbb84\","
	" 0.5 \"#fc8d59\", 0.625 \"#ef6548\", 0.75 \"#d7301f\", 0.875 \"#b30000\", 1 \"#5f0000\")\n";

enum { MAP_LEFT = 60, MAP_RIGHT = 130, MAP_PANEL = 300, MAP_GAP = 45, MAP_TOP = 70, MAP_BOTTOM = 100 };

static void put_map_panel(FILE *file, const struct material_data *data, int f)
{
	char title[64];
	snprintf(title, sizeof title, "%.32s, E = %.4g", data->fit[f].ndf, data->fit[f].error);
	fputs("set title ", file);
	gnuplot_string(file, title);
	fprintf(file,
		" noenhanced\nset ylabel \"%s\"\n%s colorbox\nplot \"map.csv\" skip 1 using 1:2:(low(column(%d))) with "
		"image "
		"notitle\n",
		f % 3 == 0 ? "θ_d (degrees)" : "", f + 1 == data->n ? "set" : "unset", 6 + f);
}

static enum status write_map_script(const char *directory, const struct material_data *data, struct error *error)
{
	struct atomic_file file;
	const int columns = data->n < 3 ? data->n : 3, lines = (data->n + columns - 1) / columns;
	const int width = MAP_LEFT + MAP_RIGHT + columns * MAP_PANEL + (columns - 1) * MAP_GAP;
	const int height = lines * (MAP_PANEL + MAP_BOTTOM) + MAP_TOP;
	const enum status status = plot_open(&file, directory, "map.gp", error);
	if (status != STATUS_OK)
		return status;
	gnuplot_begin(file.stream, "map", width, height);
	put_grid(file.stream, data->n, columns, "",
		 data->n == 1 ? "where the fit errs (gray: nothing measured)"
			      : "where each fit errs, over half and difference angle (gray: nothing measured)",
		 data->name);
	fprintf(file.stream,
		"set margins 0,0,0,0\n%sset logscale cb\nset cbrange [0.03:10]\nset cblabel \"Σ|m − f| / Σm of the "
		"row\"\n",
		palette);
	fputs("set cbtics (\"≤ 0.03\" 0.03, \"0.1\" 0.1, \"0.3\" 0.3, \"1\" 1, \"3\" 3, \"≥ 10\" 10)\n"
	      "low(e) = e < 0.03 ? 0.03 : e\n"
	      "set object rectangle from graph 0,0 to graph 1,1 behind fillstyle solid noborder fillcolor rgb "
	      "\"#b4bcc4\"\nunset grid\nset border 15\nset tics out\n",
	      file.stream);
	put_map_axes(file.stream, bins_of(data));
	for (int f = 0; f < data->n; f++) {
		const int x = MAP_LEFT + f % columns * (MAP_PANEL + MAP_GAP);
		const int y = height - MAP_TOP - f / columns * (MAP_PANEL + MAP_BOTTOM);
		fprintf(file.stream,
			"set lmargin at screen %.6g\nset rmargin at screen %.6g\nset tmargin at screen %.6g\nset "
			"bmargin at "
			"screen %.6g\n",
			(double)x / width, (double)(x + MAP_PANEL) / width, (double)y / height,
			(double)(y - MAP_PANEL) / height);
		put_map_panel(file.stream, data, f);
	}
	fputs("unset multiplot\n", file.stream);
	gnuplot_end(file.stream);
	return atomic_file_commit(&file, error);
}

enum status plot_map(const char *directory, const struct material_data *data, struct error *error)
{
	struct metrics_row *rows = calloc((size_t)data->n * MERL_ROWS, sizeof(*rows));
	if (!rows)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	enum status status = make_maps(data, rows, error);
	if (status == STATUS_OK)
		status = write_maps(directory, data, rows, error);
	if (status == STATUS_OK)
		status = write_map_script(directory, data, error);
	free(rows);
	return status;
}

enum status plot_material(const char *directory, const struct material_data *data, struct error *error)
{
	enum status status = plot_ndf(directory, data, error);
	if (status == STATUS_OK)
		status = plot_slices(directory, data, error);
	return status != STATUS_OK ? status : plot_map(directory, data, error);
}
