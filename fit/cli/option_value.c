/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/option_value.h"
#include "data_readers/text_quote.h"
#include "fit/cli/nearest.h"
#include "fit/results/csv.h"
#include "src/names.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define FIT (1u << COMMAND_FIT)
#define COMPARE (1u << COMMAND_COMPARE)
#define MERGE (1u << COMMAND_MERGE)
#define BENCH (1u << COMMAND_BENCH)
#define EVAL (1u << COMMAND_EVAL)
#define INFO (1u << COMMAND_INFO)
#define SYNTH (1u << COMMAND_SYNTH)
#define EXPORT (1u << COMMAND_EXPORT)
#define CONVERT (1u << COMMAND_CONVERT)
#define NDF (1u << COMMAND_NDF)
#define SAMPLE (1u << COMMAND_SAMPLE)
#define PLOT (1u << COMMAND_PLOT)
#define RENDER (1u << COMMAND_RENDER)
#define REPORT (1u << COMMAND_REPORT)
#define DRAWS (PLOT | REPORT)
#define FITS (FIT | COMPARE | DRAWS)
#define SEARCHES (FITS | BENCH)
#define TABLES (FIT | COMPARE | BENCH)
#define MODEL (EVAL | SYNTH)
#define AXES (FIT | COMPARE)
#define SOURCES (EXPORT | RENDER) /* a fit, a row or given parameters: model_source.h */
#define AT(member) offsetof(struct options, member)

const struct option_spec option_specs[] = {
	{"output", 'o', KIND_TEXT, FIT, NOT_RECORDED, "FILE",
	 "write the table there, - for standard output; an older FILE becomes FILE~, with --resume only if it has rows "
	 "to redo",
	 AT(output), 0, 0},
	{"output", 'o', KIND_TEXT, COMPARE | MERGE, NOT_RECORDED, "FILE",
	 "write the table there, - for standard output; an older FILE becomes FILE~", AT(output), 0, 0},
	{"output", 'o', KIND_TEXT, EXPORT, NOT_RECORDED, "FILE", "write it there, not to standard output (-)",
	 AT(output), 0, 0},
	{"format", 0, KIND_FORMAT, EXPORT, NOT_RECORDED, "NAME", "what to write", AT(format), 0, 0},
	{"accuracy", 0, KIND_PERCENT, EXPORT, NOT_RECORDED, "P%",
	 "bsdf, bsdf-rgb: refine until the error, L1 weighted by cosines, is at most this", AT(accuracy), 1e-3, 100},
	{"size", 0, KIND_NUMBER, EXPORT, NOT_RECORDED, "BYTES", "bsdf, bsdf-rgb: no larger than this", AT(file_size),
	 1e4, 1e9},
	{"output", 'o', KIND_TEXT, DRAWS, NOT_RECORDED, "DIR", "the directory to write to; made if it is not there",
	 AT(output), 0, 0},
	{"json", 0, KIND_ON, TABLES | MERGE | EVAL | INFO | NDF | SAMPLE | RENDER, NOT_RECORDED, NULL,
	 "JSON instead of CSV", AT(json), 0, 0},
	{"table", 0, KIND_ON, TABLES | MERGE | EVAL | INFO | NDF | SAMPLE | RENDER, NOT_RECORDED, NULL,
	 "a readable table on standard output even if that is no terminal", AT(readable), 0, 0},
	{"resume", 0, KIND_ON, FIT, NOT_RECORDED, NULL,
	 "keep the rows of -o FILE that were made from the same bytes with the same options", AT(resume), 0, 0},
	{"shard", 0, KIND_SHARD, FIT, NOT_RECORDED, "I/N",
	 "fit only share I of N of the files: of their sorted list every N-th, beginning with the I-th", AT(shard), 1,
	 100000},
	{"recursive", 'r', KIND_ON, FITS | MERGE | RENDER | INFO, NOT_RECORDED, NULL,
	 "directories: take the files below them too", AT(recursive), 0, 0},
	{"quiet", 'q', KIND_ON, SEARCHES | RENDER, NOT_RECORDED, NULL, "no progress line, no summary", AT(quiet), 0, 0},
	{"quiet", 'q', KIND_ON, EXPORT | CONVERT, NOT_RECORDED, NULL, "no words but errors", AT(quiet), 0, 0},
	{"threads", 0, KIND_INT, SEARCHES | MODEL | SOURCES | CONVERT, NOT_RECORDED, "N", "threads; changes no result",
	 AT(fit.threads), 1, FIT_THREADS_MAX},
	{"ndf", 0, KIND_NDFS, FITS | RENDER, RECORDED_WITHIN, "LIST", "NDFs to fit, separated by commas", AT(fit.ndf),
	 0, 0},
	{"ndf", 0, KIND_NDFS, MODEL | BENCH | EXPORT, NOT_RECORDED, "NAME", "NDF of the model", AT(fit.ndf), 0, 0},
	{"gaf", 0, KIND_GAF, SEARCHES | MODEL | SOURCES | NDF | SAMPLE, RECORDED, "NAME", "masking and shadowing G",
	 AT(fit.criterion.gaf), 0, 0},
	{"lambda", 0, KIND_LAMBDA, SEARCHES | MODEL | SOURCES, RECORDED, "FORM",
	 "form of Lambda of STD and its family; other NDFs have the exact one only", AT(fit.lambda), 0, 0},
	{"lambda", 0, KIND_LAMBDA_OF_ANY, NDF | SAMPLE, NOT_RECORDED, "FORM",
	 "form of Lambda of STD and its family; trapezoid is for pl, other NDFs have the exact one only",
	 AT(fit.lambda), 0, 0},
	{"fresnel", 0, KIND_FRESNEL, SEARCHES | MODEL | SOURCES, RECORDED, "NAME", "Fresnel term F", AT(fit.fresnel), 0,
	 0},
	{"weight", 0, KIND_WEIGHTS, FIT, RECORDED, "LIST",
	 "how an entry counts in the error; of several, separated by commas, each has fits of its own",
	 AT(fit.criterion.weight), 0, 0},
	{"weight", 0, KIND_WEIGHT, COMPARE | BENCH | DRAWS, NOT_RECORDED, "NAME", "how an entry counts in the error",
	 AT(fit.criterion.weight), 0, 0},
	{"weight", 0, KIND_WEIGHT, RENDER, NOT_RECORDED, "NAME",
	 "how an entry counts in the error of a fit; with --from FILE.csv: only rows fitted so",
	 AT(fit.criterion.weight), 0, 0},
	{"weight", 0, KIND_WEIGHT, EXPORT, NOT_RECORDED, "NAME",
	 "how an entry counts in the error of a fit, also of one in the place of a given model or row",
	 AT(fit.criterion.weight), 0, 0},
	{"bins", 0, KIND_BINS, COMPARE | PLOT | BENCH | MODEL | SOURCES | INFO | CONVERT, NOT_RECORDED, "NAME",
	 "where the entries of a table stand", AT(fit.criterion.bins), 0, 0},
	{"bins", 0, KIND_BINS_OR_BOTH, FIT | REPORT, RECORDED, "NAME",
	 "where the entries of a table stand; both: at the nodes, and how far a fit at the centres moves each "
	 "parameter",
	 AT(fit.criterion.bins), 0, 0},
	{"quantity", 0, KIND_QUANTITY, SEARCHES | EVAL | SOURCES | INFO | CONVERT, RECORDED_GIVEN, "NAME",
	 "what the numbers of the file are, whatever it says: the BRDF (1/sr), times cos theta_o, or times pi",
	 AT(quantity), 0, 0},
	{"gamut", 0, KIND_GAMUT, SEARCHES | EVAL | SOURCES | INFO | CONVERT, RECORDED_GIVEN, "NAME",
	 "a colour of a spectrum that has a negative part in linear sRGB: set that to 0, or leave the entry out",
	 AT(gamut), 0, 0},
	{"max-theta", 0, KIND_NUMBER, SEARCHES | EVAL | SOURCES, RECORDED, "DEG",
	 "leave out entries whose theta_i or theta_o exceeds this", AT(fit.criterion.max_theta), 1, 90},
	{"zero-is-missing", 0, KIND_ON, SEARCHES | EVAL | SOURCES, RECORDED_GIVEN, NULL,
	 "leave out entries that are 0 in all channels: holes that were stored as 0 instead of -1",
	 AT(fit.criterion.zero_is_missing), 0, 0},
	{"unbounded", 0, KIND_ON, SEARCHES | SOURCES, RECORDED, NULL, "kd and ks may exceed 1", AT(fit.unbounded), 0,
	 0},
	{"diffuse", 0, KIND_DIFFUSE, SEARCHES | SOURCES, RECORDED_GIVEN, "NAME",
	 "the diffuse term: Lambert's alone, or with one of grazing directions beside it, as Burley's has",
	 AT(fit.grazing), 0, 0},
	{"exponent", 0, KIND_NUMBER, SEARCHES, RECORDED_GIVEN, "P",
	 "with --diffuse burley: fix its exponent (Burley: 5)", AT(fit.grazing_exponent), FIT_GRAZING_MIN,
	 FIT_GRAZING_MAX},
	{"lobes", 0, KIND_INT, SEARCHES | SOURCES, RECORDED_GIVEN, "1|2",
	 "specular lobes: 2 has a second one of the same NDF and index, with ks, sigma and gamma of its own",
	 AT(fit.lobes), 1, 2},
	{"no-diffuse", 0, KIND_OFF, SEARCHES | SOURCES, RECORDED, NULL, "kd = 0", AT(fit.diffuse), 0, 0},
	{"no-specular", 0, KIND_OFF, SEARCHES | SOURCES, RECORDED, NULL, "ks = 0", AT(fit.specular), 0, 0},
	{"gray", 0, KIND_ON, SEARCHES | SOURCES, RECORDED, NULL, "one kd and one ks for the three channels",
	 AT(fit.gray), 0, 0},
	{"ior", 0, KIND_NUMBER, SEARCHES, RECORDED, "N", "fix the index of refraction", AT(fit.ior),
	 FIT_CONDUCTOR_IOR_MIN, FIT_IOR_MAX},
	{"per-channel-ior", 0, KIND_ON, SEARCHES | SOURCES, RECORDED_GIVEN, NULL,
	 "with --fresnel conductor: each channel has an n and k of its own", AT(fit.per_channel_ior), 0, 0},
	{"gamma", 0, KIND_GAMMA, SEARCHES, RECORDED, "G", "fix the shape gamma (STD: above 1.5; inf is Beckmann)",
	 AT(fit.gamma), 1e-3, FIT_GAMMA_MAX},
	{"sigma", 0, KIND_SIGMA, SEARCHES, RECORDED, "S|SX,SY", "fix the roughness; with --anisotropic along both axes",
	 AT(fit.sigma), FIT_SIGMA_MIN, FIT_SIGMA_MAX},
	{"anisotropic", 0, KIND_ON, AXES | SOURCES, RECORDED_ANISOTROPIC, NULL,
	 "scattered entries: search sigma_x, sigma_y and the angle of their axes, too, from the isotropic fit on; of "
	 "the ellipsoid also its tilt",
	 AT(fit.anisotropic), 0, 0},
	{"angle", 0, KIND_NUMBER, AXES, RECORDED_ANISOTROPIC, "DEG",
	 "with --anisotropic: fix the azimuth of the axis of sigma_x", AT(fit.angle), -360, 360},
	{"algorithm", 0, KIND_ALGORITHM, FIT, RECORDED_ALGORITHM, "NAME",
	 "the search; others than the default search the full table with nlopt until --time is up, kd and ks solved "
	 "for "
	 "inside or (-joint) searched as well",
	 AT(fit.algorithm), 0, 0},
	{"algorithm", 0, KIND_ALGORITHMS, BENCH, NOT_RECORDED, "LIST",
	 "searches to run, separated by commas; all if not given", AT(algorithm), 0, 0},
	{"forms", 0, KIND_ON, BENCH, NOT_RECORDED, NULL,
	 "the forms of Lambda instead of algorithms: one fit each by the default search", AT(forms), 0, 0},
	{"time", 0, KIND_NUMBER, FIT, RECORDED_ALGORITHM, "SECONDS",
	 "for each fit by another --algorithm than the default; its results then depend on the machine", AT(fit.time_s),
	 1e-3, 1e6},
	{"time", 0, KIND_NUMBER, BENCH, NOT_RECORDED, "SECONDS", "for each algorithm", AT(fit.time_s), 1e-3, 1e6},
	{"trace", 0, KIND_TEXT, FIT, NOT_RECORDED, "FILE.csv",
	 "write there how the best error of each search fell with evaluations and seconds; the default's stages scan "
	 "and "
	 "thin-N tell the error of a sample of the table, an estimate",
	 AT(trace), 0, 0},
	{"trace", 0, KIND_TEXT, BENCH, NOT_RECORDED, "FILE.csv",
	 "write the curves there: how the error of each algorithm fell with evaluations and seconds", AT(trace), 0, 0},
	{"starts", 0, KIND_INT, FITS, RECORDED, "N", "more searches, from random shapes", AT(fit.starts), 0, 100000},
	{"seed", 0, KIND_SEED, SEARCHES, RECORDED, "N", "seed of the random shapes", AT(fit.seed), 0, 0},
	{"within", 0, KIND_PERCENT, FIT, RECORDED_WITHIN, "P%",
	 "per material only the simplest model whose error is within P% of the best, from a gray Lambert term to two "
	 "coloured lobes; --lobes, --diffuse or --fresnel given keeps out what is richer in that",
	 AT(within), 0, 1000},
	{"intervals", 0, KIND_PERCENT, FIT | REPORT, RECORDED_GIVEN, "P%",
	 "how certain the shape is: between which values sigma, gamma, n ... each may lie, the others refitted, while "
	 "the error stays within P% of the best; 1 is a good choice",
	 AT(intervals), 0.01, 1000},
	{"sigma", 0, KIND_SIGMA, MODEL, NOT_RECORDED, "S|SX,SY", "roughness, along both axes if two", AT(fit.sigma),
	 FIT_SIGMA_MIN, FIT_SIGMA_MAX},
	{"angle", 0, KIND_NUMBER, MODEL, NOT_RECORDED, "DEG", "azimuth of the axis of SX; 0 if not given",
	 AT(fit.angle), -360, 360},
	{"gamma", 0, KIND_GAMMA, MODEL, NOT_RECORDED, "G", "shape gamma (STD: above 1.5; inf is Beckmann)",
	 AT(fit.gamma), 1e-3, FIT_GAMMA_MAX},
	{"ior", 0, KIND_INDEX, MODEL, NOT_RECORDED, "N|R,G,B",
	 "index of refraction; below 1.0001, or one for each channel, with --fresnel conductor", AT(fit.ior),
	 FIT_CONDUCTOR_IOR_MIN, FIT_IOR_MAX},
	{"sigma", 0, KIND_SIGMA, SOURCES, NOT_RECORDED, "S|SX,SY",
	 "roughness, along both axes if two: given with --ks, else fixed in the fit", AT(fit.sigma), FIT_SIGMA_MIN,
	 FIT_SIGMA_MAX},
	{"angle", 0, KIND_NUMBER, SOURCES, NOT_RECORDED, "DEG", "azimuth of the axis of SX, likewise", AT(fit.angle),
	 -360, 360},
	{"gamma", 0, KIND_GAMMA, SOURCES, NOT_RECORDED, "G", "shape gamma (STD: above 1.5; inf is Beckmann), likewise",
	 AT(fit.gamma), 1e-3, FIT_GAMMA_MAX},
	{"ior", 0, KIND_INDEX, SOURCES, NOT_RECORDED, "N|R,G,B",
	 "index of refraction, likewise; with --ks 1.5 if not given; one for each channel with --ks only", AT(fit.ior),
	 FIT_CONDUCTOR_IOR_MIN, FIT_IOR_MAX},
	{"k", 0, KIND_RGB, MODEL | SOURCES, NOT_RECORDED, "K|R,G,B", "imaginary part of a conductor's index", AT(k), 0,
	 FIT_K_MAX},
	{"kd", 0, KIND_RGB, MODEL | SOURCES, NOT_RECORDED, "R,G,B", "diffuse factors", AT(kd), 0, FIT_FACTOR_MAX},
	{"ks", 0, KIND_RGB, MODEL | SOURCES, NOT_RECORDED, "R,G,B", "specular factors", AT(ks), 0, FIT_FACTOR_MAX},
	{"f0", 0, KIND_RGB, MODEL | SOURCES, NOT_RECORDED, "R,G,B", "with --fresnel f82: F along the normal",
	 AT(f82[0]), 0, 1},
	{"f82", 0, KIND_RGB, MODEL | SOURCES, NOT_RECORDED, "R,G,B", "F where cos theta_d is 1/7, at about 82 degrees",
	 AT(f82[1]), 0, 1},
	{"f90", 0, KIND_RGB, MODEL | SOURCES, NOT_RECORDED, "R,G,B", "F at grazing incidence; 1 if not given",
	 AT(f82[2]), 0, 1},
	{"kg", 0, KIND_RGB, MODEL | SOURCES, NOT_RECORDED, "R,G,B",
	 "factors of a diffuse term of grazing directions, as Burley's has", AT(kg), 0, FIT_FACTOR_MAX},
	{"exponent", 0, KIND_NUMBER, MODEL | SOURCES, NOT_RECORDED, "P",
	 "its exponent: given with --kg, 5 if not given, or fixed in a fit with --diffuse burley",
	 AT(fit.grazing_exponent), FIT_GRAZING_MIN, FIT_GRAZING_MAX},
	{"ks2", 0, KIND_RGB, MODEL | SOURCES, NOT_RECORDED, "R,G,B", "factors of a second lobe of the same NDF and F",
	 AT(ks2), 0, FIT_FACTOR_MAX},
	{"sigma2", 0, KIND_NUMBER, MODEL | SOURCES, NOT_RECORDED, "S", "its roughness", AT(sigma2), FIT_SIGMA_MIN,
	 FIT_SIGMA_MAX},
	{"gamma2", 0, KIND_GAMMA, MODEL | SOURCES, NOT_RECORDED, "G", "its gamma", AT(gamma2), 1e-3, FIT_GAMMA_MAX},
	{"from", 0, KIND_TEXT, EVAL | SOURCES | NDF | SAMPLE, NOT_RECORDED, "FILE.csv",
	 "take the model from the row of this material (and --ndf, if given); FILE.json: from a model's JSON", AT(from),
	 0, 0},
	{"row", 0, KIND_INT, EVAL | SOURCES | NDF | SAMPLE, NOT_RECORDED, "N", "take row N of --from, counted from 1",
	 AT(row), 1, INT_MAX},
	{"phi", 0, KIND_PHI, SYNTH | CONVERT, NOT_RECORDED, "180|360", "entries along phi_d", AT(n_phi_d), 0, 0},
	{"noise", 0, KIND_NUMBER, SYNTH, NOT_RECORDED, "REL", "standard deviation of a factor 1 + noise on each value",
	 AT(noise), 0, 10},
	{"seed", 0, KIND_SEED, SYNTH, NOT_RECORDED, "N", "seed of the noise", AT(fit.seed), 0, 0},
	{"sigma", 0, KIND_WORD, NDF | SAMPLE, NOT_RECORDED, "SX[,SY]", "roughness, along x and y if the NDF has two",
	 AT(sigma_words), 0, 0},
	{"angle", 0, KIND_NUMBER, NDF | SAMPLE, NOT_RECORDED, "DEG", "azimuth of the first axis; 0 if not given",
	 AT(fit.angle), -360, 360},
	{"gamma", 0, KIND_WORD, NDF | SAMPLE, NOT_RECORDED, "G", "shape gamma (STD: above 1.5; inf is Beckmann)",
	 AT(gamma_words), 0, 0},
	{"params", 0, KIND_WORD, NDF | SAMPLE | MODEL | SOURCES, NOT_RECORDED, "P",
	 "other parameters, name=value;...: x of t-family, B and C of low, D0 to D90 of pl; of the ellipsoid tilt_x "
	 "and tilt_y, or theta_x, theta_y, theta_z (degrees), or its matrix A11 to A33",
	 AT(params), 0, 0},
	{"nodes", 0, KIND_TEXT, NDF | SAMPLE | MODEL | SOURCES, NOT_RECORDED, "FILE.csv",
	 "the nodes of pl: columns theta, degrees from 0 to 90, and D, or Dx and Dy along x and y", AT(nodes), 0, 0},
	{"theta", 0, KIND_WORD, NDF, NOT_RECORDED, "LIST", "polar angles, degrees: START:END:STEP or A,B,...",
	 AT(theta), 0, 0},
	{"phi", 0, KIND_WORD, NDF, NOT_RECORDED, "LIST", "azimuths, degrees, likewise; 0 if not given", AT(phi), 0, 0},
	{"theta-i", 0, KIND_NUMBER, NDF | SAMPLE, NOT_RECORDED, "DEG",
	 "direction from which normals are seen; 90 is the limit of grazing incidence", AT(theta_i), 0, 90},
	{"phi-i", 0, KIND_NUMBER, NDF | SAMPLE, NOT_RECORDED, "DEG", "azimuth of that direction", AT(phi_i), -360, 360},
	{"sampling", 0, KIND_SAMPLING, SAMPLE, NOT_RECORDED, "NAME",
	 "which normals; with --theta-i the visible ones where the NDF can, else all. pseudo: those of GGX or Beckmann "
	 "where gamma is near enough; rational: visible ones of GGX by a rational fit",
	 AT(sampling), 0, 0},
	{"count", 0, KIND_INT, SAMPLE, NOT_RECORDED, "N", "how many", AT(count), 1, 1000000},
	{"seed", 0, KIND_SEED, SAMPLE, NOT_RECORDED, "N", "seed of the random numbers", AT(fit.seed), 0, 0},
	{"pictures", 0, KIND_ON, COMPARE, NOT_RECORDED, NULL,
	 "render each model and its measured table, too, and show delta E and SSIM of the pictures", AT(pictures), 0,
	 0},
	{"models", 0, KIND_ON, COMPARE, NOT_RECORDED, NULL,
	 "instead of NDFs compare models of the first NDF, std if none is named, from a gray Lambert term to two "
	 "coloured lobes: parameters, error, gain over the paper's model in %, delta E, SSIM and seconds of each",
	 AT(models), 0, 0},
	{"sort", 0, KIND_SORT, COMPARE, NOT_RECORDED, "ORDER",
	 "materials by name, or by how much STD gains over GGX, with --models the best model over the paper's",
	 AT(sort_by_gain), 0, 0},
	{"output", 'o', KIND_TEXT, RENDER, NOT_RECORDED, "FILE",
	 "the picture: FILE.png (sRGB) or FILE.pfm (linear), - for standard output", AT(picture), 0, 0},
	{"environment", 'e', KIND_TEXT, RENDER | REPORT, NOT_RECORDED, "NAME",
	 "studio, sky or lights, or a map of latitude and longitude, FILE.hdr or FILE.pfm (default: studio)",
	 AT(environment), 0, 0},
	{"light", 0, KIND_TEXT, RENDER | REPORT, NOT_RECORDED, "X,Y,Z[,E][;...]",
	 "point lights in these directions (x right, y up, z to the viewer), of irradiance E (pi), instead of the "
	 "default "
	 "environment or beside the one that is given",
	 AT(light), 0, 0},
	{"exposure", 0, KIND_NUMBER, RENDER | REPORT, NOT_RECORDED, "STOPS", "the light times 2^STOPS", AT(exposure),
	 -20, 20},
	{"size", 0, KIND_INT, RENDER | REPORT, NOT_RECORDED, "N", "width and height of a sphere's picture, pixels",
	 AT(size), 8, 4096},
	{"samples", 0, KIND_INT, RENDER | REPORT, NOT_RECORDED, "N", "samples per pixel, best a power of two",
	 AT(pixel_samples), 1, 65536},
	{"sampling", 0, KIND_SAMPLING, RENDER, NOT_RECORDED, "NAME",
	 "normals by which directions are sampled; visible ones, or all, where the NDF has none such", AT(sampling), 0,
	 0},
	{"seed", 0, KIND_SEED, RENDER, NOT_RECORDED, "N", "seed of the samples", AT(fit.seed), 0, 0},
	{"difference", 0, KIND_ON, RENDER, NOT_RECORDED, NULL,
	 "show differences in false colours for several materials, too", AT(difference), 0, 0},
	{"transmission", 0, KIND_ON, RENDER, NOT_RECORDED, NULL,
	 "instead of files a solid sphere of glass (--ior) with a rough surface (--sigma, --gamma), of each NDF",
	 AT(transmission), 0, 0},
	{"multiple", 0, KIND_ON, RENDER, NOT_RECORDED, NULL,
	 "with --transmission: light also meets several facets of the surface", AT(multiple), 0, 0},
	{NULL, 0, KIND_ON, 0, NOT_RECORDED, NULL, NULL, 0, 0, 0},
};

_Static_assert(sizeof option_specs / sizeof *option_specs <= OPTIONS_MAX,
	       "struct options.given has an entry per option");

/* Of values that are false and true. */
static const char *const diffuse_name[] = {"lambert", "burley"};
static const char both_bins[] = "both";
static const char *const sort_name[] = {"name", "gain"};

const char *option_choice(enum option_kind kind, int i)
{
	switch (kind) {
	case KIND_NDFS:
		return ndf_at(i) ? ndf_name(ndf_at(i)) : NULL;
	case KIND_GAF:
		return i < GAF_COUNT ? gaf_name((enum gaf)i) : NULL;
	case KIND_LAMBDA:
		return i < LAMBDA_FORM_COUNT ? lambda_form_name((enum lambda_form)i) : NULL;
	case KIND_LAMBDA_OF_ANY:
		return i <= LAMBDA_FORM_COUNT
			       ? lambda_form_name(i < LAMBDA_FORM_COUNT ? (enum lambda_form)i : LAMBDA_TRAPEZOID)
			       : NULL;
	case KIND_FRESNEL:
		return i < FRESNEL_COUNT ? fresnel_name((enum fresnel)i) : NULL;
	case KIND_DIFFUSE:
		return i < 2 ? diffuse_name[i] : NULL;
	case KIND_SORT:
		return i < 2 ? sort_name[i] : NULL;
	case KIND_WEIGHT:
	case KIND_WEIGHTS:
		return i < WEIGHT_COUNT ? weight_name((enum weight)i) : NULL;
	case KIND_BINS_OR_BOTH:
		return i == BINS_COUNT ? both_bins : option_choice(KIND_BINS, i);
	case KIND_BINS:
		return i < BINS_COUNT ? bins_name((enum bins)i) : NULL;
	case KIND_QUANTITY:
		return i < QUANTITY_COUNT ? quantity_name((enum quantity)i) : NULL;
	case KIND_GAMUT:
		return i < GAMUT_COUNT ? gamut_name((enum gamut)i) : NULL;
	case KIND_PHI:
		return i < 2 ? (i ? "360" : "180") : NULL;
	case KIND_SAMPLING:
		return i < SAMPLING_COUNT ? sampling_name((enum sampling)i) : NULL;
	case KIND_FORMAT:
		return i < EXPORT_FORMATS ? export_format_name((enum export_format)i) : NULL;
	case KIND_ALGORITHM:
	case KIND_ALGORITHMS:
		return i < ALGORITHM_COUNT ? algorithm_name(algorithm_at(i)) : NULL;
	default:
		return NULL;
	}
}

static enum status either_find(const char *const names[2], const char *text, bool *second)
{
	const int i = names_find(names, 2, text);
	if (i < 0)
		return STATUS_DOMAIN;
	*second = i == 1;
	return STATUS_OK;
}

static enum status lambda_form_of_student_t(const char *text, enum lambda_form *form)
{
	enum lambda_form found;
	if (lambda_form_find(text, &found) != STATUS_OK || found >= LAMBDA_FORM_COUNT)
		return STATUS_DOMAIN;
	*form = found;
	return STATUS_OK;
}

static enum status choice_find(enum option_kind kind, const char *text, void *value)
{
	switch (kind) {
	case KIND_GAF:
		return gaf_find(text, value);
	case KIND_LAMBDA:
		return lambda_form_of_student_t(text, value);
	case KIND_LAMBDA_OF_ANY:
		return lambda_form_find(text, value);
	case KIND_FRESNEL:
		return fresnel_find(text, value);
	case KIND_DIFFUSE:
		return either_find(diffuse_name, text, value);
	case KIND_SORT:
		return either_find(sort_name, text, value);
	case KIND_WEIGHT:
		return weight_find(text, value);
	case KIND_QUANTITY:
		return quantity_find(text, value);
	case KIND_GAMUT:
		return gamut_find(text, value);
	case KIND_SAMPLING:
		return sampling_find(text, value);
	case KIND_FORMAT:
		return export_format_find(text, value);
	case KIND_ALGORITHM:
		return algorithm_find(text, value);
	default:
		return bins_find(text, value);
	}
}

/* Values from text. Each returns STATUS_DOMAIN, with what was expected, when the text is none. */

static enum status expected_range(const struct option_spec *spec, struct error *error)
{
	char min[CSV_NUMBER_SIZE], max[CSV_NUMBER_SIZE];
	return error_set(error, STATUS_DOMAIN, "expected a%s number from %s to %s%s",
			 spec->kind == KIND_INT ? " whole" : "", csv_number(min, spec->min), csv_number(max, spec->max),
			 spec->kind == KIND_GAMMA ? ", or inf" : "");
}

static bool in_range(const struct option_spec *spec, double x)
{
	return (x >= spec->min && x <= spec->max) || (spec->kind == KIND_GAMMA && x == INFINITY);
}

static enum status parse_number(const struct option_spec *spec, const char *text, double *value, struct error *error)
{
	double x;
	if (!*text || !csv_parse_number(text, &x) || !in_range(spec, x))
		return expected_range(spec, error);
	*value = x;
	return STATUS_OK;
}

static enum status parse_sigma(const struct option_spec *spec, const char *text, struct fit_options *fit,
			       struct error *error)
{
	char first[CSV_NUMBER_SIZE];
	const size_t length = strcspn(text, ",");
	if (length >= sizeof first)
		return expected_range(spec, error);
	memcpy(first, text, length);
	first[length] = '\0';
	double sigma, sigma_y = NAN;
	enum status status = parse_number(spec, first, &sigma, error);
	if (status == STATUS_OK && text[length])
		status = parse_number(spec, text + length + 1, &sigma_y, error);
	if (status != STATUS_OK)
		return status;
	fit->sigma = sigma;
	fit->sigma_y = sigma_y;
	return STATUS_OK;
}

static enum status parse_percent(const struct option_spec *spec, const char *text, double *value, struct error *error)
{
	char number[CSV_NUMBER_SIZE];
	const size_t length = strlen(text), percent = length && text[length - 1] == '%';
	if (length >= sizeof number)
		return expected_range(spec, error);
	memcpy(number, text, length - percent);
	number[length - percent] = '\0';
	return parse_number(spec, number, value, error);
}

static enum status parse_int(const struct option_spec *spec, const char *text, int *value, struct error *error)
{
	char *end;
	errno = 0;
	const long x = strtol(text, &end, 10);
	if (end == text || isspace((unsigned char)*text) || *end || errno || !in_range(spec, (double)x))
		return expected_range(spec, error);
	*value = (int)x;
	return STATUS_OK;
}

static enum status parse_seed(const char *text, uint64_t *value, struct error *error)
{
	char *end;
	errno = 0;
	const unsigned long long x = strtoull(text, &end, 10);
	if (text[strspn(text, "0123456789")] || end == text || errno)
		return error_set(error, STATUS_DOMAIN, "expected a whole number from 0 to %" PRIu64, UINT64_MAX);
	*value = x;
	return STATUS_OK;
}

static enum status parse_shard(const struct option_spec *spec, const char *text, struct shard *shard,
			       struct error *error)
{
	char number[CSV_NUMBER_SIZE];
	struct shard found = {0};
	const size_t length = strcspn(text, "/");
	snprintf(number, sizeof number, "%.*s", (int)(length % sizeof number), text);
	if (length >= sizeof number || !text[length] || parse_int(spec, number, &found.i, NULL) != STATUS_OK ||
	    parse_int(spec, text + length + 1, &found.n, NULL) != STATUS_OK || found.i > found.n)
		return error_set(error, STATUS_DOMAIN, "expected I/N, share I of N, as 1/4 to 4/4; N at most %g",
				 spec->max);
	*shard = found;
	return STATUS_OK;
}

static enum status parse_phi(const char *text, int *value, struct error *error)
{
	if (strcmp(text, "180") && strcmp(text, "360"))
		return error_set(error, STATUS_DOMAIN, "expected 180 or 360");
	*value = strcmp(text, "180") ? 360 : 180;
	return STATUS_OK;
}

/* Copies the part of a list before the next comma; returns what follows it, NULL at the end. A part that does not fit is
 * no item of any list and gives "". */
static const char *next_item(const char *text, char *item, size_t size)
{
	const size_t length = strcspn(text, ",");
	snprintf(item, size, "%.*s", length < size ? (int)length : 0, text);
	return text[length] ? text + length + 1 : NULL;
}

static enum status parse_rgb(const struct option_spec *spec, const char *text, double value[3], struct error *error)
{
	char item[CSV_NUMBER_SIZE];
	double rgb[3] = {0, 0, 0};
	int n = 0;
	for (const char *rest = text; rest; n++) {
		rest = next_item(rest, item, sizeof item);
		if (n == 3 || parse_number(spec, item, &rgb[n], NULL) != STATUS_OK)
			return error_set(error, STATUS_DOMAIN, "expected R,G,B or one number, each from %g to %g",
					 spec->min, spec->max);
	}
	if (n == 2)
		return error_set(error, STATUS_DOMAIN, "expected three numbers R,G,B or one, found two");
	for (int c = 0; c < 3; c++)
		value[c] = rgb[n == 3 ? c : 0];
	return STATUS_OK;
}

static enum status parse_index(const struct option_spec *spec, const char *text, struct options *options,
			       struct error *error)
{
	const enum status status = parse_rgb(spec, text, options->ior, error);
	const double *n = options->ior;
	if (status == STATUS_OK)
		options->fit.ior = n[0] == n[1] && n[1] == n[2] ? n[0] : NAN;
	return status;
}

static enum status expected_choice(enum option_kind kind, struct error *error)
{
	char names[256] = "";
	for (int i = 0; option_choice(kind, i); i++) {
		strncat(names, i ? ", " : "", sizeof names - strlen(names) - 1);
		strncat(names, option_choice(kind, i), sizeof names - strlen(names) - 1);
	}
	return error_set(error, STATUS_DOMAIN, "expected one of %s", names);
}

static enum status unknown_ndf(const char *name, struct error *error)
{
	struct error choice;
	const int near = nearest_word(name, distribution_name_at, NULL);
	const enum status status = expected_choice(KIND_NDFS, &choice);
	if (near < 0)
		return error_set(error, status, "%s", choice.text);
	return error_set(error, status, "%s; did you mean %s?", choice.text, distribution_name_at(NULL, near));
}

static enum status parse_ndfs(const char *text, struct fit_options *fit, struct error *error)
{
	char name[64], shown[TEXT_QUOTE_SIZE];
	int n = 0;
	for (const char *rest = text; rest; n++) {
		rest = next_item(rest, name, sizeof name);
		const struct ndf_class *ndf = ndf_find(name);
		if (!ndf)
			return unknown_ndf(name, error);
		text_quote(name, shown, sizeof shown);
		for (int i = 0; i < n; i++)
			if (fit->ndf[i] == ndf)
				return error_set(error, STATUS_DOMAIN, "'%s' stands there twice", shown);
		if (n == FIT_NDFS_MAX)
			return error_set(error, STATUS_DOMAIN, "expected at most %d names", FIT_NDFS_MAX);
		fit->ndf[n] = ndf;
	}
	fit->n_ndf = n;
	return STATUS_OK;
}

static enum status parse_weights(const char *text, struct options *options, struct error *error)
{
	char name[64];
	int n = 0;
	for (const char *rest = text; rest; n++) {
		enum weight weight;
		rest = next_item(rest, name, sizeof name);
		if (weight_find(name, &weight) != STATUS_OK)
			return expected_choice(KIND_WEIGHTS, error);
		for (int i = 0; i < n; i++)
			if (options->weight[i] == weight)
				return error_set(error, STATUS_DOMAIN, "'%s' stands there twice", name);
		options->weight[n] = weight;
	}
	options->n_weights = n;
	options->fit.criterion.weight = options->weight[0];
	return STATUS_OK;
}

static enum status parse_bins(const char *text, struct options *options, struct error *error)
{
	options->both_bins = !strcmp(text, both_bins);
	options->fit.criterion.bins = BINS_NODE;
	if (options->both_bins || bins_find(text, &options->fit.criterion.bins) == STATUS_OK)
		return STATUS_OK;
	return expected_choice(KIND_BINS_OR_BOTH, error);
}

static enum status parse_algorithms(const char *text, struct options *options, struct error *error)
{
	char name[64];
	int n = 0;
	for (const char *rest = text; rest; n++) {
		const struct algorithm *algorithm;
		rest = next_item(rest, name, sizeof name);
		if (algorithm_find(name, &algorithm) != STATUS_OK)
			return expected_choice(KIND_ALGORITHMS, error);
		for (int i = 0; i < n; i++)
			if (options->algorithm[i] == algorithm)
				return error_set(error, STATUS_DOMAIN, "'%s' stands there twice", name);
		options->algorithm[n] = algorithm;
	}
	options->n_algorithms = n;
	return STATUS_OK;
}

enum status option_parse(struct options *options, const struct option_spec *spec, const char *text, struct error *error)
{
	void *value = (char *)options + spec->offset;
	switch (spec->kind) {
	case KIND_ON:
	case KIND_OFF:
		*(bool *)value = spec->kind == KIND_ON;
		return STATUS_OK;
	case KIND_TEXT:
	case KIND_WORD:
		*(const char **)value = text;
		return *text ? STATUS_OK : error_set(error, STATUS_DOMAIN, "expected a name");
	case KIND_INT:
		return parse_int(spec, text, value, error);
	case KIND_SEED:
		return parse_seed(text, value, error);
	case KIND_NUMBER:
	case KIND_GAMMA:
		return parse_number(spec, text, value, error);
	case KIND_SIGMA:
		return parse_sigma(spec, text, &options->fit, error);
	case KIND_PERCENT:
		return parse_percent(spec, text, value, error);
	case KIND_RGB:
		return parse_rgb(spec, text, value, error);
	case KIND_INDEX:
		return parse_index(spec, text, options, error);
	case KIND_SHARD:
		return parse_shard(spec, text, value, error);
	case KIND_PHI:
		return parse_phi(text, value, error);
	case KIND_NDFS:
		return parse_ndfs(text, &options->fit, error);
	case KIND_WEIGHTS:
		return parse_weights(text, options, error);
	case KIND_BINS_OR_BOTH:
		return parse_bins(text, options, error);
	case KIND_ALGORITHMS:
		return parse_algorithms(text, options, error);
	default:
		return choice_find(spec->kind, text, value) != STATUS_OK ? expected_choice(spec->kind, error)
									 : STATUS_OK;
	}
}

/* Values as text */

static void write_ndfs(FILE *file, const struct fit_options *fit)
{
	for (int i = 0; i < fit->n_ndf; i++)
		fprintf(file, "%s%s", i ? "," : "", ndf_name(fit->ndf[i]));
}

static void write_weights(FILE *file, const struct options *options)
{
	fputs(weight_name(options->fit.criterion.weight), file);
	for (int i = 1; i < options->n_weights; i++)
		fprintf(file, ",%s", weight_name(options->weight[i]));
}

static void write_algorithms(FILE *file, const struct options *options)
{
	for (int i = 0; i < options->n_algorithms; i++)
		fprintf(file, "%s%s", i ? "," : "", algorithm_name(options->algorithm[i]));
}

void option_write(FILE *file, const struct options *options, const struct option_spec *spec)
{
	const void *value = (const char *)options + spec->offset;
	char number[CSV_NUMBER_SIZE];
	switch (spec->kind) {
	case KIND_ON:
	case KIND_OFF:
		fputs(*(const bool *)value == (spec->kind == KIND_ON) ? "yes" : "no", file);
		break;
	case KIND_TEXT:
	case KIND_WORD:
		fputs(*(const char *const *)value ? *(const char *const *)value : "", file);
		break;
	case KIND_INT:
	case KIND_PHI:
		fprintf(file, "%d", *(const int *)value);
		break;
	case KIND_SHARD:
		fprintf(file, "%d/%d", ((const struct shard *)value)->i, ((const struct shard *)value)->n);
		break;
	case KIND_SEED:
		fprintf(file, "%" PRIu64, *(const uint64_t *)value);
		break;
	case KIND_SIGMA:
		fputs(isnan(options->fit.sigma) ? "free" : csv_number(number, options->fit.sigma), file);
		if (!isnan(options->fit.sigma_y))
			fprintf(file, ",%s", csv_number(number, options->fit.sigma_y));
		break;
	case KIND_NUMBER:
	case KIND_GAMMA:
	case KIND_PERCENT:
	case KIND_RGB:
	case KIND_INDEX:
		fputs(isnan(*(const double *)value) ? "free" : csv_number(number, *(const double *)value), file);
		break;
	case KIND_NDFS:
		write_ndfs(file, &options->fit);
		break;
	case KIND_GAF:
		fputs(gaf_name(*(const enum gaf *)value), file);
		break;
	case KIND_LAMBDA:
	case KIND_LAMBDA_OF_ANY:
		fputs(lambda_form_name(*(const enum lambda_form *)value), file);
		break;
	case KIND_FRESNEL:
		fputs(fresnel_name(*(const enum fresnel *)value), file);
		break;
	case KIND_DIFFUSE:
		fputs(diffuse_name[*(const bool *)value], file);
		break;
	case KIND_SORT:
		fputs(sort_name[*(const bool *)value], file);
		break;
	case KIND_WEIGHT:
		fputs(weight_name(*(const enum weight *)value), file);
		break;
	case KIND_WEIGHTS:
		write_weights(file, options);
		break;
	case KIND_BINS_OR_BOTH:
		fputs(options->both_bins ? both_bins : bins_name(options->fit.criterion.bins), file);
		break;
	case KIND_BINS:
		fputs(bins_name(*(const enum bins *)value), file);
		break;
	case KIND_QUANTITY:
		fputs(quantity_name(*(const enum quantity *)value), file);
		break;
	case KIND_GAMUT:
		fputs(gamut_name(*(const enum gamut *)value), file);
		break;
	case KIND_SAMPLING:
		fputs(sampling_name(*(const enum sampling *)value), file);
		break;
	case KIND_FORMAT:
		fputs(export_format_name(*(const enum export_format *)value), file);
		break;
	case KIND_ALGORITHM:
		fputs(algorithm_name(*(const struct algorithm *const *)value), file);
		break;
	case KIND_ALGORITHMS:
		write_algorithms(file, options);
		break;
	}
}

bool option_applies(const struct option_spec *spec, enum command command)
{
	return spec->commands & 1u << command;
}

static bool has_default(const struct options *defaults, const struct option_spec *spec)
{
	if (!spec->argument || spec->kind == KIND_TEXT || spec->kind == KIND_WORD || spec->kind == KIND_SAMPLING ||
	    spec->kind == KIND_PERCENT || spec->kind == KIND_ALGORITHMS || spec->kind == KIND_SHARD ||
	    spec->kind == KIND_FORMAT)
		return false;
	const void *value = (const char *)defaults + spec->offset;
	if (spec->kind == KIND_INT)
		return *(const int *)value >= spec->min;
	/* A free number is a default of a fit; a model needs one. */
	return spec->recorded != NOT_RECORDED ||
	       (spec->kind != KIND_NUMBER && spec->kind != KIND_GAMMA && spec->kind != KIND_SIGMA &&
		spec->kind != KIND_INDEX) ||
	       !isnan(*(const double *)value);
}

void option_describe(FILE *file, const struct options *defaults, const struct option_spec *spec)
{
	fputs(spec->help, file);
	for (int i = 0; option_choice(spec->kind, i); i++)
		fprintf(file, "%s%s", i ? ", " : ": ", option_choice(spec->kind, i));
	if (has_default(defaults, spec)) {
		fputs(" (default: ", file);
		option_write(file, defaults, spec);
		fputs(")", file);
	}
}

const char *option_comma_hint(const char *text)
{
	const size_t before = strspn(text, "0123456789"), after = text[before] == ',' ? before + 1 : 0;
	const bool one = before && after && text[after] && text[after + strspn(text + after, "0123456789")] == '\0';
	return one ? " (a comma parts two numbers: 0.2 is written with a point)" : "";
}
