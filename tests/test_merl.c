/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The MERL reader and writer, the table they fill, and output that is there whole or not at all. */
#include "check.h"
#include "data_readers/atomic_file.h"
#include "data_readers/measurement_read.h"
#include "data_readers/merl.h"
#include "data_readers/text_quote.h"
#include <dirent.h>
#include <endian.h>
#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>
#include <xxhash.h>

static const double pi = 3.14159265358979323846;
static const double scale[] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

enum { HEADER = 12, ENTRIES_180 = 90 * 90 * 180, SIZE_180 = HEADER + 3 * 8 * ENTRIES_180 };

/* What happens to the reader's calls of pread(), which this program replaces. */
static struct {
	atomic_int calls;
	int at_call; /* from this call on, 0 = never: */
	int errnum;  /* fail so, or */
	bool end;    /* report the end of the file, or */
	bool grow;   /* let the file grow, unnoticed so far */
	bool pieces; /* always: give a piece at a time, and be interrupted in between */
	const char *grow_path;
} meddle;

ssize_t pread(int fd, void *buffer, size_t size, off_t offset)
{
	const int call = ++meddle.calls;
	const bool now = meddle.at_call > 0 && call >= meddle.at_call;

	if ((now && meddle.errnum) || (meddle.pieces && call % 3 == 0)) {
		errno = meddle.errnum ? meddle.errnum : EINTR;
		return -1;
	}
	if (now && meddle.end)
		return 0;
	if (now && meddle.grow)
		assert_int_equal(truncate(meddle.grow_path, SIZE_180 + 1), 0);
	struct iovec piece = {buffer, meddle.pieces && size > 100001 ? 100001 : size};
	return preadv(fd, &piece, 1, offset);
}

/* A directory of its own for every test, removed with what is in it. */
struct directory {
	char dir[512];
	char path[PATH_MAX]; /* of the file named last */
};

static int directory_make(void **state)
{
	static struct directory directory;
	const char *tmp = getenv("TMPDIR");

	snprintf(directory.dir, sizeof directory.dir, "%s/test_merl_XXXXXX", tmp && *tmp ? tmp : "/tmp");
	memset(&meddle, 0, sizeof meddle);
	*state = &directory;
	return mkdtemp(directory.dir) ? 0 : -1;
}

static const char *in(struct directory *directory, const char *name)
{
	snprintf(directory->path, sizeof directory->path, "%s/%s", directory->dir, name);
	return directory->path;
}

/* Number of files in the directory; with `remove_them`, removes them too. */
static int directory_files(struct directory *directory, bool remove_them)
{
	DIR *dir = opendir(directory->dir);
	int n = 0;

	assert_non_null(dir);
	for (const struct dirent *entry; (entry = readdir(dir));) {
		if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
			continue;
		n++;
		if (remove_them)
			assert_int_equal(remove(in(directory, entry->d_name)), 0);
	}
	closedir(dir);
	return n;
}

static int directory_remove(void **state)
{
	directory_files(*state, true);
	return rmdir(((struct directory *)*state)->dir);
}

/* Makes a file of `size` bytes that starts with `start`; the rest is zero and takes no room on the disk. */
static const char *make_file(struct directory *directory, const char *name, const void *start, size_t length,
			     off_t size)
{
	const int fd = open(in(directory, name), O_WRONLY | O_CREAT | O_TRUNC, 0666);

	assert_true(fd >= 0);
	assert_int_equal(write(fd, start, length), length);
	const int result = ftruncate(fd, size);
	close(fd);
	return result == 0 ? directory->path : NULL;
}

static const char *make_table(struct directory *directory, const char *name, int32_t n0, int32_t n1, int32_t n2,
			      off_t size)
{
	const uint32_t header[3] = {htole32((uint32_t)n0), htole32((uint32_t)n1), htole32((uint32_t)n2)};

	return make_file(directory, name, header, sizeof header, size);
}

static char *slurp(const char *path, size_t *size)
{
	struct stat st;
	FILE *file = fopen(path, "rb");

	assert_non_null(file);
	assert_int_equal(fstat(fileno(file), &st), 0);
	*size = (size_t)st.st_size;
	char *bytes = malloc(*size + 1);
	assert_non_null(bytes);
	assert_int_equal(fread(bytes, 1, *size, file), *size);
	bytes[*size] = '\0';
	fclose(file);
	return bytes;
}

static mode_t mode_of(const char *path)
{
	struct stat st;

	assert_int_equal(stat(path, &st), 0);
	return st.st_mode & 07777;
}

static void check_content(const char *path, const char *want)
{
	size_t size;
	char *got = slurp(path, &size);

	assert_string_equal(got, want);
	free(got);
}

/* Overwrites one number of a table file. */
static void poke(const char *path, int channel, size_t entry, double value)
{
	const int fd = open(path, O_WRONLY);
	uint64_t bits;

	memcpy(&bits, &value, sizeof bits);
	bits = htole64(bits);
	assert_int_equal(pwrite(fd, &bits, 8, (off_t)(HEADER + 8 * ((size_t)channel * ENTRIES_180 + entry))), 8);
	close(fd);
}

static void check_one_line(const char *text)
{
	for (const char *c = text; *c; c++)
		assert_true((unsigned char)*c >= 0x20);
}

/* --- bins ------------------------------------------------------------------------------------------------------- */

static void names_and_bins_are_inverse(void **state)
{
	enum bins bins = BINS_COUNT;

	(void)state;
	for (int b = 0; b < BINS_COUNT; b++) {
		assert_int_equal(bins_find(bins_name((enum bins)b), &bins), STATUS_OK);
		assert_int_equal(bins, b);
	}
	assert_string_equal(bins_name(BINS_NODE), "node");
	assert_string_equal(bins_name(BINS_CENTRE), "centre");
	bins = BINS_NODE;
	assert_int_equal(bins_find("center", &bins), STATUS_DOMAIN);
	assert_int_equal(bins, BINS_NODE);
}

static void angles_of_bins_are_as_documented(void **state)
{
	const struct halfdiff node = bins_angles(BINS_NODE, 30, 17, 359);
	const struct halfdiff centre = bins_angles(BINS_CENTRE, 30, 17, 359);
	const struct halfdiff origin = bins_angles(BINS_NODE, 0, 0, 0);

	(void)state;
	check_rel(node.theta_h, 10.0 / 180.0 * pi, 4e-16, "node theta_h");
	check_rel(node.theta_d, 17.0 / 180.0 * pi, 4e-16, "node theta_d");
	check_rel(node.phi_d, 359.0 / 180.0 * pi, 4e-16, "node phi_d");
	check_rel(centre.theta_h, 30.5 * 30.5 / 90.0 / 180.0 * pi, 4e-16, "centre theta_h");
	check_rel(centre.theta_d, 17.5 / 180.0 * pi, 4e-16, "centre theta_d");
	check_rel(centre.phi_d, 359.5 / 180.0 * pi, 4e-16, "centre phi_d");
	assert_true(origin.theta_h == 0.0 && origin.theta_d == 0.0 && origin.phi_d == 0.0);
}

/* Against long double, where that is wider than double; cosines near 90 degrees are where naive ones go wrong. */
static void sines_and_cosines_of_bins_are_exact_at_the_ends(void **state)
{
	const long double radian = acosl(-1.0L) / 180.0L;
	const double tol = LDBL_MANT_DIG >= 64 ? 3.0 * DBL_EPSILON : 1e-12;

	(void)state;
	for (int b = 0; b < BINS_COUNT; b++) {
		const long double shift = b == BINS_CENTRE ? 0.5L : 0.0L;
		for (int n = 0; n < 90; n++) {
			const struct halfdiff_trig t = bins_trig((enum bins)b, n, n, n);
			const long double h = (n + shift) * (n + shift) / 90.0L, d = n + shift;
			check_rel(t.sin_h, (double)sinl(h * radian), tol, "sin_h");
			check_rel(t.cos_h, (double)sinl((90.0L - h) * radian), tol, "cos_h");
			check_rel(t.sin_d, (double)sinl(d * radian), tol, "sin_d");
			check_rel(t.cos_d, (double)sinl((90.0L - d) * radian), tol, "cos_d");
			check_rel(t.sin_phi, (double)sinl(d * radian), tol, "sin_phi");
			check_rel(t.cos_phi, (double)sinl((90.0L - d) * radian), tol, "cos_phi");
		}
	}
	const struct halfdiff_trig right = bins_trig(BINS_NODE, 0, 30, 90), back = bins_trig(BINS_NODE, 0, 60, 270);
	assert_true(right.sin_h == 0.0 && right.cos_h == 1.0 && right.sin_d == 0.5);
	assert_true(right.sin_phi == 1.0 && right.cos_phi == 0.0);
	assert_true(back.cos_d == 0.5 && back.sin_phi == -1.0 && back.cos_phi == 0.0);
}

static int count_above_horizon(enum bins bins)
{
	double cos_phi[180];
	int count = 0;

	for (int k = 0; k < 180; k++)
		cos_phi[k] = bins_trig(bins, 0, 0, k).cos_phi;
	for (int i = 0; i < MERL_THETA_H; i++) {
		for (int j = 0; j < MERL_THETA_D; j++) {
			const struct halfdiff_trig t = bins_trig(bins, i, j, 0);
			for (int k = 0; k < 180; k++) {
				const double even = t.cos_h * t.cos_d, odd = t.sin_h * t.sin_d * cos_phi[k];
				count += even - odd > 1e-9 && even + odd > 1e-9;
			}
		}
	}
	return count;
}

static void entries_above_the_horizon_are_counted(void **state)
{
	(void)state;
	assert_int_equal(count_above_horizon(BINS_NODE), 1111430);
	assert_int_equal(count_above_horizon(BINS_CENTRE), 1096216);
}

/* --- table ------------------------------------------------------------------------------------------------------ */

static void a_new_table_is_masked(void **state)
{
	struct measurement measurement;

	(void)state;
	for (int n = 180; n <= 360; n += 180) {
		assert_int_equal(measurement_alloc(&measurement, n), STATUS_OK);
		assert_int_equal(measurement_count(&measurement), 8100 * n);
		for (int c = 0; c < MERL_CHANNELS; c++) {
			assert_true(isnan(measurement.value[c][0]));
			assert_true(isnan(measurement.value[c][measurement_count(&measurement) - 1]));
		}
		measurement_free(&measurement);
		assert_null(measurement.value[0]);
		measurement_free(&measurement);
	}
	static const int bad[] = {0, -180, 90, 181, 720, INT_MAX};
	for (size_t b = 0; b < sizeof bad / sizeof *bad; b++) {
		assert_int_equal(measurement_alloc(&measurement, bad[b]), STATUS_DOMAIN);
		assert_null(measurement.value[0]);
	}
}

/* A table with many magnitudes, the largest and smallest floats among them, and masked entries. Returns how many. */
static size_t fill(struct measurement *measurement)
{
	uint32_t random = 2385;
	size_t masked = 0;

	for (size_t e = 0; e < measurement_count(measurement); e++) {
		for (int c = 0; c < MERL_CHANNELS; c++) {
			random = random * 1664525u + 1013904223u;
			measurement->value[c][e] = ldexpf((float)(random >> 8), (int)(random >> 24) % 60 - 50);
		}
		if (e % 11 == 3) {
			masked++;
			for (int c = 0; c < MERL_CHANNELS; c++)
				measurement->value[c][e] = NAN;
		}
	}
	for (int c = 0; c < MERL_CHANNELS; c++) {
		measurement->value[c][0] = 0.0f;
		measurement->value[c][1] = FLT_MAX;
		measurement->value[c][2] = FLT_MIN;
	}
	return masked;
}

static void check_same(const struct measurement *got, const struct measurement *want)
{
	assert_int_equal(got->n_phi_d, want->n_phi_d);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		for (size_t e = 0; e < measurement_count(want); e++) {
			const float g = got->value[c][e], w = want->value[c][e];
			if (!(g == w || (isnan(g) && isnan(w))))
				fail_msg("channel %d, entry %zu: got %.9g, expected %.9g", c, e, (double)g, (double)w);
		}
	}
}

static void round_trip(struct directory *directory, int n_phi_d)
{
	struct measurement made, got = {0};
	struct error error = {{0}};
	size_t size;

	assert_int_equal(measurement_alloc(&made, n_phi_d), STATUS_OK);
	const size_t masked = fill(&made);
	const char *path = in(directory, "table.binary");
	if (merl_write(path, &made, &error) != STATUS_OK || merl_read(path, 2, &got, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	check_same(&got, &made);
	assert_int_equal(got.n_negative, masked);
	assert_int_equal(got.n_nonfinite, 0);
	char *bytes = slurp(path, &size);
	assert_int_equal(size, HEADER + 3 * 8 * measurement_count(&made));
	assert_int_equal(got.file_size, size);
	assert_int_equal(got.file_hash, XXH3_64bits(bytes, size));
	assert_int_equal(directory_files(directory, false), 1);
	free(bytes);
	measurement_free(&got);
	measurement_free(&made);
}

static void a_180_table_comes_back(void **state)
{
	round_trip(*state, 180);
}

static void a_360_table_comes_back(void **state)
{
	round_trip(*state, 360);
}

/* The hash of tables of zeros, as other programs give it. */
static void the_hash_is_that_of_the_bytes(void **state)
{
	struct measurement measurement;
	const char *path = make_table(*state, "zero.binary", 90, 90, 180, SIZE_180);

	assert_int_equal(merl_read(path, 2, &measurement, NULL), STATUS_OK);
	assert_int_equal(measurement.file_hash, 0xcf6267e3a70330ca);
	assert_true(measurement.value[0][0] == 0.0f && measurement.value[2][ENTRIES_180 - 1] == 0.0f);
	measurement_free(&measurement);
	path = make_table(*state, "zero.binary", 90, 90, 360, HEADER + 2 * (SIZE_180 - HEADER));
	assert_int_equal(merl_read(path, 1, &measurement, NULL), STATUS_OK);
	assert_int_equal(measurement.n_phi_d, 360);
	assert_int_equal(measurement.file_hash, 0x8e5ba5d4edf94254);
	measurement_free(&measurement);
}

/* Where numbers go and what they are multiplied by. */
static void planes_lie_as_the_format_has_them(void **state)
{
	struct measurement measurement;
	const char *path = make_table(*state, "layout.binary", 90, 90, 180, SIZE_180);
	const size_t entry = 7 + 180 * (12 + 90 * (size_t)61); /* phi_d 7, theta_d 12, theta_h 61 */

	for (int c = 0; c < MERL_CHANNELS; c++)
		poke(path, c, entry, 2385.0 + c);
	assert_int_equal(merl_read(path, 2, &measurement, NULL), STATUS_OK);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		check_rel(measurement.value[c][entry], (2385.0 + c) * scale[c], FLT_EPSILON, "scaled");
		assert_true(measurement.value[c][entry - 1] == 0.0f && measurement.value[c][entry + 1] == 0.0f);
	}
	measurement_free(&measurement);
}

enum verdict { VALID, NEGATIVE, NONFINITE };

static const struct mask_case {
	double number[MERL_CHANNELS];
	enum verdict verdict;
} mask_cases[] = {
	{{0.0, 0.0, 0.0}, VALID},
	{{-0.0, 1.0, -0.0}, VALID},
	{{1.0, -1.0, 1.0}, NEGATIVE},
	{{-1.0, -1.0, -1.0}, NEGATIVE},
	{{1.0, 1.0, -1e-30}, NEGATIVE},
	{{-1e-300, 1.0, 1.0}, NEGATIVE},   /* too small for a float, */
	{{-4.9e-324, 1.0, 1.0}, NEGATIVE}, /* and for a double once scaled */
	{{4.9e-324, 1e-300, 1e-40}, VALID},
	{{1e-36, 1e-36, 1e-36}, VALID}, /* denormal once scaled */
	{{NAN, 1.0, 1.0}, NONFINITE},
	{{1.0, -NAN, 1.0}, NONFINITE},
	{{1.0, 1.0, INFINITY}, NONFINITE},
	{{1.0, -INFINITY, 1.0}, NONFINITE},
	{{-1.0, NAN, 1.0}, NONFINITE}, /* both: counted once */
	{{-1.0, -1.0, INFINITY}, NONFINITE},
	{{1e42, 1.0, 1.0}, NONFINITE}, /* finite, but not as a float */
	{{-1e300, 1.0, 1.0}, NONFINITE},
	{{FLT_MAX, FLT_MAX, FLT_MAX}, VALID},
};

enum { N_MASK_CASES = sizeof mask_cases / sizeof *mask_cases };

/* An entry for each case, spread over the table with its first and last among them. */
static size_t mask_entry(int n)
{
	return (size_t)n * (ENTRIES_180 - 1) / (N_MASK_CASES - 1);
}

static const char *make_masked(struct directory *directory)
{
	const char *path = make_table(directory, "masked.binary", 90, 90, 180, SIZE_180);

	for (int n = 0; n < N_MASK_CASES; n++)
		for (int c = 0; c < MERL_CHANNELS; c++)
			poke(path, c, mask_entry(n), mask_cases[n].number[c]);
	return path;
}

static void negative_and_nonfinite_entries_are_masked_and_counted(void **state)
{
	struct measurement measurement;
	size_t count[3] = {0};

	assert_int_equal(merl_read(make_masked(*state), 2, &measurement, NULL), STATUS_OK);
	for (int n = 0; n < N_MASK_CASES; n++) {
		count[mask_cases[n].verdict]++;
		for (int c = 0; c < MERL_CHANNELS; c++) {
			const float got = measurement.value[c][mask_entry(n)];
			const double want = mask_cases[n].number[c] * scale[c];
			if (isnan(got) != (mask_cases[n].verdict != VALID))
				fail_msg("case %d, channel %d: got %g", n, c, (double)got);
			if (isnan(got))
				continue;
			check_rel(got, fabs(want) < FLT_MIN ? 0.0 : want, FLT_EPSILON, "valid value");
			assert_true(got == 0.0f || isnormal(got));
			assert_false(signbit(got));
		}
	}
	assert_int_equal(measurement.n_negative, count[NEGATIVE]);
	assert_int_equal(measurement.n_nonfinite, count[NONFINITE]);
	for (int n = 0; n + 1 < N_MASK_CASES; n++) /* and nothing else */
		assert_true(measurement.value[1][mask_entry(n) + 1] == 0.0f);
	measurement_free(&measurement);
}

static void threads_change_nothing(void **state)
{
	static const int threads[] = {2, 3, 8, 1000, 0, -5};
	struct measurement one, got;
	struct directory *directory = *state;

	assert_int_equal(measurement_alloc(&one, 180), STATUS_OK);
	fill(&one);
	assert_int_equal(merl_write(in(directory, "table.binary"), &one, NULL), STATUS_OK);
	measurement_free(&one);
	for (int c = 0; c < MERL_CHANNELS; c++)
		for (size_t e = 0; e < 20; e++)
			poke(directory->path, c, e * 72899 + (size_t)c, e % 2 ? INFINITY : -1.0);
	assert_int_equal(merl_read(directory->path, 1, &one, NULL), STATUS_OK);
	assert_true(one.n_nonfinite > 0 && one.n_negative > one.n_nonfinite);
	for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
		assert_int_equal(merl_read(directory->path, threads[t], &got, NULL), STATUS_OK);
		check_same(&got, &one);
		assert_int_equal(got.n_negative, one.n_negative);
		assert_int_equal(got.n_nonfinite, one.n_nonfinite);
		assert_int_equal(got.file_hash, one.file_hash);
		measurement_free(&got);
	}
	measurement_free(&one);
}

/* --- bad input -------------------------------------------------------------------------------------------------- */

/* Reading has to fail with this status, in one line that has `words` in it, and leave no table. */
static void check_refused(const char *path, enum status status, const char *words)
{
	struct measurement measurement = {.n_phi_d = 7};
	struct error error = {{0}};

	assert_non_null(path);
	const enum status got = merl_read(path, 2, &measurement, &error);
	if (got == STATUS_OK)
		measurement_free(&measurement);
	if (got != status || strncmp(error.text, "cannot read '", 13) != 0 || !strstr(error.text, words))
		fail_msg("%s: got status %d '%s', expected %d and '%s'", path, got, error.text, status, words);
	check_one_line(error.text);
	assert_int_equal(measurement.n_phi_d, 0);
	assert_null(measurement.value[0]);
	assert_int_equal(merl_read(path, 1, &measurement, NULL), status);
}

static void what_is_no_file_is_refused(void **state)
{
	struct directory *directory = *state;

	check_refused(in(directory, "missing.binary"), STATUS_IO, strerror(ENOENT));
	check_refused(in(directory, "missing/x.binary"), STATUS_IO, strerror(ENOENT));
	check_refused("", STATUS_IO, strerror(ENOENT));
	check_refused(directory->dir, STATUS_FORMAT, "found a directory");
	check_refused("/dev/null", STATUS_FORMAT, "expected a regular file");
	assert_int_equal(mkfifo(in(directory, "fifo"), 0666), 0);
	alarm(60); /* a reader that waits for a writer is ended, and with it the test */
	check_refused(directory->path, STATUS_FORMAT, "expected a regular file");
	alarm(0);
	assert_int_equal(symlink("loop", in(directory, "loop")), 0);
	check_refused(directory->path, STATUS_IO, strerror(ELOOP));
}

static void wrong_sizes_are_refused(void **state)
{
	static const off_t wrong[] = {
		HEADER,       HEADER + 1,   4096,         SIZE_180 / 2, SIZE_180 - 8,
		SIZE_180 - 1, SIZE_180 + 1, SIZE_180 + 8, 69984012,
	};
	struct directory *directory = *state;
	char words[128];

	check_refused(make_file(directory, "x", "", 0, 0), STATUS_FORMAT, "the file is empty");
	check_refused(make_table(directory, "x", 90, 90, 180, 5), STATUS_FORMAT, "header of 12 bytes, found 5");
	check_refused(make_table(directory, "x", 90, 90, 180, 11), STATUS_FORMAT, "header of 12 bytes, found 11");
	for (size_t w = 0; w < sizeof wrong / sizeof *wrong; w++) {
		snprintf(words, sizeof words, "expected 34992012 bytes for a 90 x 90 x 180 table, found %jd",
			 (intmax_t)wrong[w]);
		check_refused(make_table(directory, "x", 90, 90, 180, wrong[w]), STATUS_FORMAT, words);
	}
	check_refused(make_table(directory, "x", 90, 90, 360, SIZE_180), STATUS_FORMAT,
		      "expected 69984012 bytes for a 90 x 90 x 360 table, found 34992012");
}

static void wrong_dimensions_are_refused(void **state)
{
	static const int32_t wrong[][3] = {
		{0, 0, 0},
		{90, 90, 0},
		{90, 90, 181},
		{180, 90, 90},
		{90, 180, 90}, /* the right product */
		{90, 90, -180},
		{-90, -90, 180},
		{1 << 30, 1 << 30, 1 << 30},
		{65536, 65536, 1},
		{INT32_MAX, INT32_MAX, INT32_MAX},
		{INT32_MIN, INT32_MIN, INT32_MIN},
		{90, 90, 720},
	};
	char words[128];

	for (size_t w = 0; w < sizeof wrong / sizeof *wrong; w++) {
		snprintf(words, sizeof words, "90 x 90 x 180 or 90 x 90 x 360 table, found %d x %d x %d", wrong[w][0],
			 wrong[w][1], wrong[w][2]);
		check_refused(make_table(*state, "x", wrong[w][0], wrong[w][1], wrong[w][2], SIZE_180), STATUS_FORMAT,
			      words);
	}
}

static void text_is_refused(void **state)
{
	static const char *const texts[] = {
		"material,ndf,error,kd_r,kd_g,kd_b\nchrome,std,0.25,0,0,0\n",
		"\xef\xbb\xbfmaterial;ndf;error\r\n",
		"a\n",
	};

	for (size_t t = 0; t < sizeof texts / sizeof *texts; t++) {
		const size_t length = strlen(texts[t]);
		check_refused(make_file(*state, "x.csv", texts[t], length, (off_t)length), STATUS_FORMAT,
			      "looks like text");
	}
}

static void foreign_files_are_named(void **state)
{
	static const struct {
		const char *head;
		size_t size;
		const char *words;
	} kinds[] = {
		{"\x1f\x8b\x08\0\0\0\0\0\0\x03xx", 12, "gzip: expand it with gunzip"},
		{"\xfd"
		 "7zXZ\0\0\4xxxx",
		 12, "xz: expand it with unxz"},
		{"\x28\xb5\x2f\xfdxxxxxxxx", 12, "zstd: expand it with unzstd"},
		{"BZh91AY&SYxx", 12, "bzip2: expand it with bunzip2"},
		{"PK\3\4xxxxxxxx", 12, "zip archive: unpack it with unzip"},
		{"\0\0\0\x5a\0\0\0\x5a\0\0\0\xb4", 12, "big-endian"},
		{"\0\0\0\x5a\0\0\0\x5a\0\0\1\x68", 12, "big-endian"},
	};

	/* By the reader of MERL files, and by the one that finds the format of a file. */
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
		const char *path = make_file(*state, "x.binary", kinds[k].head, kinds[k].size, SIZE_180);
		struct measurement measurement;
		struct error error;

		check_refused(path, STATUS_FORMAT, kinds[k].words);
		assert_int_equal(measurement_read(path, NULL, &measurement, &error), STATUS_FORMAT);
		assert_non_null(strstr(error.text, kinds[k].words));
	}
	check_refused(make_file(*state, "x.binary", "\x1f\x8b\x08", 3, 3), STATUS_FORMAT, "gunzip");
	check_refused(make_table(*state, "x", 90, 90, 180, 12 + (SIZE_180 - 12) / 2), STATUS_FORMAT,
		      "numbers of 4 bytes");
}

static void a_huge_file_is_refused(void **state)
{
	const char *path = make_table(*state, "huge.binary", 90, 90, 180, (off_t)1 << 40);

	if (!path)
		skip_because("this file system cannot hold a sparse file of 1 TB");
	check_refused(path, STATUS_FORMAT, "found 1099511627776");
}

/* Runs `body` as somebody without root's rights; skips the test where that cannot be. */
static void unprivileged(struct directory *directory, void (*body)(struct directory *directory))
{
	const uid_t uid = geteuid();

	if (uid != 0) {
		body(directory);
		return;
	}
	assert_int_equal(chmod(directory->dir, mode_of(directory->dir) | 0111), 0);
	if (seteuid(65534) != 0)
		skip_because("root is refused nothing, and cannot become somebody else here");
	const bool reachable = faccessat(AT_FDCWD, directory->dir, X_OK, AT_EACCESS) == 0;
	if (reachable)
		body(directory);
	assert_int_equal(seteuid(uid), 0);
	if (!reachable)
		skip_because("the temporary directory is closed to others than root");
}

static void read_unreadable(struct directory *directory)
{
	check_refused(in(directory, "x.binary"), STATUS_IO, strerror(EACCES));
}

static void an_unreadable_file_is_refused(void **state)
{
	make_table(*state, "x.binary", 90, 90, 180, SIZE_180);
	assert_int_equal(chmod(in(*state, "x.binary"), 0), 0);
	unprivileged(*state, read_unreadable);
}

/* The first call reads the header; later ones belong to the planes. */
static void errors_while_reading_are_reported(void **state)
{
	struct directory *directory = *state;
	const char *path = make_table(directory, "x.binary", 90, 90, 180, SIZE_180);

	for (int call = 1; call <= 23; call += 11) {
		memset(&meddle, 0, sizeof meddle);
		meddle.at_call = call;
		meddle.end = true;
		check_refused(path, STATUS_IO, "it shrank while being read");
		meddle.end = false;
		meddle.calls = 0;
		meddle.errnum = EIO;
		check_refused(path, STATUS_IO, strerror(EIO));
	}
	memset(&meddle, 0, sizeof meddle);
	meddle.at_call = 5;
	meddle.grow = true;
	meddle.grow_path = path;
	struct measurement measurement;
	struct error error;
	assert_int_equal(merl_read(path, 2, &measurement, &error), STATUS_IO);
	assert_non_null(strstr(error.text, "it changed while being read"));
}

static void reading_in_pieces_gives_the_same(void **state)
{
	struct measurement measurement;
	const char *path = make_table(*state, "x.binary", 90, 90, 180, SIZE_180);

	meddle.pieces = true;
	assert_int_equal(merl_read(path, 2, &measurement, NULL), STATUS_OK);
	assert_true(meddle.calls > 400);
	assert_int_equal(measurement.file_hash, 0xcf6267e3a70330ca);
	measurement_free(&measurement);
}

static void odd_names_are_quoted(void **state)
{
	struct directory *directory = *state;
	char name[256];

	check_refused(in(directory, "a\nb\x1b[31m\xff.binary"), STATUS_IO, "a\\x0ab\\x1b[31m\\xff.binary'");
	check_refused(in(directory, "h\xc3\xa4rte.binary"), STATUS_IO, "h\xc3\xa4rte.binary'");
	memset(name, 'n', sizeof name - 1);
	name[sizeof name - 1] = '\0';
	memcpy(name + sizeof name - 5, ".bin", 4);
	check_refused(make_table(directory, name, 90, 90, 180, 4096), STATUS_FORMAT,
		      "nn.bin': expected 34992012 bytes");
	make_table(directory, name, 90, 90, 180, SIZE_180);
	struct measurement measurement;
	assert_int_equal(merl_read(directory->path, 1, &measurement, NULL), STATUS_OK);
	assert_int_equal(merl_write(directory->path, &measurement, NULL), STATUS_OK);
	measurement_free(&measurement);
}

static void quoted_text_is_one_printable_line(void **state)
{
	char out[16];

	(void)state;
	static const char *const cases[][2] = {
		{"", ""},
		{"plain name", "plain name"},
		{"tab\there", "tab\\x09here"},
		{"\x7f", "\\x7f"},
		{"\xc2\x85", "\\xc2\\x85"},          /* a control character, beyond ASCII */
		{"\xe2\x82\xac", "\xe2\x82\xac"},    /* a euro sign */
		{"\xe2\x80\xae", "\\xe2\\x80\\xae"}, /* from here on from right to left */
		{"\xe2\x81\xa9", "\\xe2\\x81\\xa9"},
		{"\xd8\x9c", "\\xd8\\x9c"},
		{"\xe2\x82", "\\xe2\\x82"},          /* cut short */
		{"\xc0\xaf", "\\xc0\\xaf"},          /* overlong */
		{"\xed\xa0\x80", "\\xed\\xa0\\x80"}, /* a surrogate */
		{"\xf0\x9f\x98\x80", "\xf0\x9f\x98\x80"},
		{"123456789012345", "123456789012345"},
		{"1234567890123456", "...567890123456"},
		{"abcdefghijkl\n", "...efghijkl\\x0a"},
		{"abcdef\nhijklmnop", "...hijklmnop"}, /* no escape is cut in two */
		{"abcdefgh\n\n\n", "...\\x0a\\x0a\\x0a"},
	};
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
		text_quote(cases[c][0], out, sizeof out);
		assert_string_equal(out, cases[c][1]);
	}
}

/* --- output ----------------------------------------------------------------------------------------------------- */

static void write_text(const char *path, const char *text)
{
	struct atomic_file file;
	struct error error;

	if (atomic_file_open(&file, path, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	fputs(text, file.stream);
	if (atomic_file_commit(&file, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	assert_null(file.stream);
	assert_null(file.temp);
}

static void a_commit_replaces_the_file(void **state)
{
	struct directory *directory = *state;
	const mode_t old_mask = umask(027);
	const char *path = in(directory, "out.csv");

	write_text(path, "first\n");
	umask(old_mask);
	check_content(path, "first\n");
	assert_int_equal(mode_of(path), 0640);
	assert_int_equal(chmod(path, 0604), 0);
	write_text(path, "second\n");
	check_content(path, "second\n");
	assert_int_equal(mode_of(path), 0604);
	assert_int_equal(directory_files(directory, false), 1);
}

static void an_abort_leaves_the_file(void **state)
{
	struct directory *directory = *state;
	struct atomic_file file;
	const char *path = in(directory, "out.csv");

	write_text(path, "old\n");
	assert_int_equal(atomic_file_open(&file, path, NULL), STATUS_OK);
	fputs("new\n", file.stream);
	fflush(file.stream);
	check_content(path, "old\n"); /* nothing shows before the commit */
	assert_int_equal(directory_files(directory, false), 2);
	atomic_file_abort(&file);
	atomic_file_abort(&file);
	check_content(in(directory, "out.csv"), "old\n");
	assert_int_equal(directory_files(directory, false), 1);

	assert_int_equal(atomic_file_open(&file, in(directory, "never"), NULL), STATUS_OK);
	atomic_file_abort(&file);
	assert_int_equal(directory_files(directory, false), 1);
}

/* Two outputs of one process in one directory, and a left-over with the name the next would take. */
static void temporary_names_do_not_clash(void **state)
{
	struct directory *directory = *state;
	struct atomic_file one, two;

	assert_int_equal(atomic_file_open(&one, in(directory, "one"), NULL), STATUS_OK);
	assert_int_equal(atomic_file_open(&two, in(directory, "two"), NULL), STATUS_OK);
	assert_string_not_equal(one.temp, two.temp);
	fputs("1", one.stream);
	fputs("2", two.stream);
	assert_int_equal(atomic_file_commit(&two, NULL), STATUS_OK);
	assert_int_equal(atomic_file_commit(&one, NULL), STATUS_OK);
	check_content(in(directory, "one"), "1");
	check_content(in(directory, "two"), "2");
	assert_int_equal(directory_files(directory, false), 2);
}

static void links_are_followed(void **state)
{
	struct directory *directory = *state;
	struct stat st;

	assert_int_equal(mkdir(in(directory, "sub"), 0777), 0);
	assert_int_equal(symlink("sub/middle", in(directory, "link")), 0);
	assert_int_equal(symlink("real", in(directory, "sub/middle")), 0);
	write_text(in(directory, "link"), "made\n"); /* what it points to is yet to be made */
	check_content(in(directory, "sub/real"), "made\n");
	write_text(in(directory, "link"), "made again\n");
	check_content(in(directory, "sub/real"), "made again\n");
	assert_int_equal(lstat(in(directory, "link"), &st), 0);
	assert_true(S_ISLNK(st.st_mode));
	assert_int_equal(lstat(in(directory, "sub/middle"), &st), 0);
	assert_true(S_ISLNK(st.st_mode));
	assert_int_equal(remove(in(directory, "sub/middle")), 0);
	assert_int_equal(remove(in(directory, "sub/real")), 0);

	struct atomic_file file;
	struct error error;
	assert_int_equal(symlink("loop", in(directory, "loop")), 0);
	assert_int_equal(atomic_file_open(&file, in(directory, "loop"), &error), STATUS_IO);
	assert_non_null(strstr(error.text, strerror(ELOOP)));
}

static void special_files_are_left(void **state)
{
	struct directory *directory = *state;
	struct stat st;
	char got[16] = "", name[64];

	const char *path = in(directory, "fifo");
	assert_int_equal(mkfifo(path, 0666), 0);
	const int fifo = open(path, O_RDWR | O_NONBLOCK);
	write_text(path, "through\n");
	assert_int_equal(read(fifo, got, sizeof got - 1), 8);
	assert_string_equal(got, "through\n");
	close(fifo);
	assert_int_equal(stat(path, &st), 0);
	assert_true(S_ISFIFO(st.st_mode));

	write_text("/dev/null", "gone\n");
	assert_int_equal(stat("/dev/null", &st), 0);
	assert_true(S_ISCHR(st.st_mode));

	path = in(directory, "log"); /* as with '-o /dev/stdout >> log' */
	const int log = open(path, O_WRONLY | O_CREAT | O_APPEND, 0666);
	assert_int_equal(write(log, "before\n", 7), 7);
	snprintf(name, sizeof name, "/dev/fd/%d", log);
	write_text(name, "added\n");
	assert_int_equal(write(log, "after\n", 6), 6);
	close(log);
	check_content(path, "before\nadded\nafter\n");
	assert_int_equal(directory_files(directory, false), 2);
}

/* Writing a table there has to fail with STATUS_IO and these words. */
static void check_not_written(const char *path, const struct measurement *measurement, const char *words)
{
	struct error error = {{0}};
	const enum status status = merl_write(path, measurement, &error);

	if (status != STATUS_IO || strncmp(error.text, "cannot write '", 14) != 0 || !strstr(error.text, words))
		fail_msg("%s: got status %d '%s', expected '%s'", path, status, error.text, words);
	check_one_line(error.text);
}

static struct measurement zero_table(void)
{
	struct measurement measurement;

	assert_int_equal(measurement_alloc(&measurement, 180), STATUS_OK);
	for (int c = 0; c < MERL_CHANNELS; c++)
		memset(measurement.value[c], 0, measurement_count(&measurement) * sizeof *measurement.value[c]);
	return measurement;
}

static void writing_where_nothing_can_be_is_refused(void **state)
{
	struct directory *directory = *state;
	struct measurement measurement = zero_table();

	check_not_written(in(directory, "missing/x.binary"), &measurement, strerror(ENOENT));
	check_not_written(in(directory, "missing\n/x.binary"), &measurement, "missing\\x0a/x.binary': ");
	check_not_written(in(directory, "new/"), &measurement, strerror(EISDIR));
	check_not_written(directory->dir, &measurement, strerror(EISDIR));
	check_not_written("", &measurement, strerror(ENOENT));
	make_file(directory, "file", "x", 1, 1);
	check_not_written(in(directory, "file/x.binary"), &measurement, strerror(ENOTDIR));
	assert_int_equal(directory_files(directory, false), 1);
	if (access("/dev/full", W_OK) == 0)
		check_not_written("/dev/full", &measurement, strerror(ENOSPC));
	measurement_free(&measurement);
}

static void write_without_permission(struct directory *directory)
{
	struct measurement measurement = zero_table();

	check_not_written(in(directory, "new.binary"), &measurement, strerror(EACCES));
	check_not_written(in(directory, "old.binary"), &measurement, strerror(EACCES));
	measurement_free(&measurement);
}

static void writing_without_permission_is_refused(void **state)
{
	struct directory *directory = *state;

	make_file(directory, "old.binary", "old", 3, 3);
	assert_int_equal(chmod(in(directory, "old.binary"), 0444), 0);
	assert_int_equal(chmod(directory->dir, 0555), 0);
	unprivileged(directory, write_without_permission);
	assert_int_equal(chmod(directory->dir, 0755), 0);
	check_content(in(directory, "old.binary"), "old");
	assert_int_equal(directory_files(directory, false), 1);
}

static void write_read_only(struct directory *directory)
{
	struct measurement measurement = zero_table();

	check_not_written(in(directory, "old.binary"), &measurement, strerror(EACCES));
	measurement_free(&measurement);
}

/* The directory would allow to replace it: a read-only file is meant to stay. */
static void a_read_only_file_is_replaced_or_refused(void **state)
{
	struct directory *directory = *state;

	make_file(directory, "old.binary", "old", 3, 3);
	assert_int_equal(chmod(in(directory, "old.binary"), 0444), 0);
	assert_int_equal(chmod(directory->dir, 0777), 0);
	unprivileged(directory, write_read_only);
	check_content(in(directory, "old.binary"), "old");
}

/* A limit on the size of files stands for a full disk: it, too, strikes half way. */
static void a_full_disk_leaves_the_old_file(void **state)
{
	struct directory *directory = *state;
	struct measurement measurement = zero_table();
	struct rlimit old, low;
	struct atomic_file file;
	struct error error;

	make_file(directory, "old.binary", "old", 3, 3);
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
	low = old;
	low.rlim_cur = 1000000;
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
	check_not_written(in(directory, "old.binary"), &measurement, strerror(EFBIG));

	/* The same for one who leaves all checking to the commit: lines lost in the middle, the stream fine at the end.
	 */
	assert_int_equal(atomic_file_open(&file, in(directory, "old.binary"), NULL), STATUS_OK);
	for (int line = 0; line < 300000; line++)
		fprintf(file.stream, "%d\n", line);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
	assert_int_equal(atomic_file_commit(&file, &error), STATUS_IO);
	signal(SIGXFSZ, SIG_DFL);
	assert_non_null(strstr(error.text, "cannot write '"));
	check_content(in(directory, "old.binary"), "old");
	assert_int_equal(directory_files(directory, false), 1);
	measurement_free(&measurement);
}

static void a_failed_rename_leaves_the_old_file(void **state)
{
	struct directory *directory = *state;
	struct atomic_file file;
	struct error error;

	assert_int_equal(atomic_file_open(&file, in(directory, "out"), NULL), STATUS_OK);
	fputs("text", file.stream);
	assert_int_equal(mkdir(in(directory, "out"), 0777), 0);
	assert_int_equal(atomic_file_commit(&file, &error), STATUS_IO);
	assert_non_null(strstr(error.text, strerror(EISDIR)));
	assert_int_equal(directory_files(directory, false), 1);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, directory_make, directory_remove)

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(names_and_bins_are_inverse),
		cmocka_unit_test(angles_of_bins_are_as_documented),
		cmocka_unit_test(sines_and_cosines_of_bins_are_exact_at_the_ends),
		cmocka_unit_test(entries_above_the_horizon_are_counted),
		cmocka_unit_test(a_new_table_is_masked),
		cmocka_unit_test(quoted_text_is_one_printable_line),
		TEST(a_180_table_comes_back),
		TEST(a_360_table_comes_back),
		TEST(the_hash_is_that_of_the_bytes),
		TEST(planes_lie_as_the_format_has_them),
		TEST(negative_and_nonfinite_entries_are_masked_and_counted),
		TEST(threads_change_nothing),
		TEST(what_is_no_file_is_refused),
		TEST(wrong_sizes_are_refused),
		TEST(wrong_dimensions_are_refused),
		TEST(text_is_refused),
		TEST(foreign_files_are_named),
		TEST(a_huge_file_is_refused),
		TEST(an_unreadable_file_is_refused),
		TEST(errors_while_reading_are_reported),
		TEST(reading_in_pieces_gives_the_same),
		TEST(odd_names_are_quoted),
		TEST(a_commit_replaces_the_file),
		TEST(an_abort_leaves_the_file),
		TEST(temporary_names_do_not_clash),
		TEST(links_are_followed),
		TEST(special_files_are_left),
		TEST(writing_where_nothing_can_be_is_refused),
		TEST(writing_without_permission_is_refused),
		TEST(a_read_only_file_is_replaced_or_refused),
		TEST(a_full_disk_leaves_the_old_file),
		TEST(a_failed_rename_leaves_the_old_file),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
