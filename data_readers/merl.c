/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/merl.h"
#include "data_readers/atomic_file.h"
#include "data_readers/foreign_file.h"
#include "data_readers/regular_file.h"
#include "data_readers/text_quote.h"
#include <endian.h>
#include <errno.h>
#include <float.h>
#include <inttypes.h>
#include <omp.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

/* A block is what one thread reads, converts and hashes at a time, about 1 MB: large enough for system calls and
 * waiting for turns not to matter, small enough to be in cache still for the second and third of these. */
enum { BLOCKS_PER_PLANE = 10, N_BLOCKS = MERL_CHANNELS * BLOCKS_PER_PLANE };

enum { FILE_SHORT = -1 }; /* beside errno values: the file ended too early */

struct header {
	uint32_t n[3]; /* little-endian */
};

/* The header that a table with this n_phi_d has. */
static struct header header_for(int n_phi_d)
{
	return (struct header){{htole32(MERL_THETA_H), htole32(MERL_THETA_D), htole32((uint32_t)n_phi_d)}};
}

/* Bytes of a whole file with this n_phi_d. */
static uint64_t file_size_for(int n_phi_d)
{
	const uint64_t numbers = (uint64_t)MERL_CHANNELS * MERL_THETA_H * MERL_THETA_D * (uint64_t)n_phi_d;

	return sizeof(struct header) + numbers * sizeof(uint64_t);
}

/* What the numbers in a file are multiplied by. */
static double scale_of(int channel)
{
	static const double scale[MERL_CHANNELS] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

	return scale[channel];
}

static double from_file(uint64_t bits)
{
	double value;

	bits = le64toh(bits);
	memcpy(&value, &bits, sizeof value);
	return value;
}

static uint64_t to_file(double value)
{
	uint64_t bits;

	memcpy(&bits, &value, sizeof bits);
	return htole64(bits);
}

/* Reads exactly `size` bytes at `offset`; 0, errno or FILE_SHORT. */
static int read_fully(int fd, void *buffer, size_t size, size_t offset)
{
	char *to = buffer;

	while (size > 0) {
		const ssize_t got = pread(fd, to, size, (off_t)offset);
		if (got == 0)
			return FILE_SHORT;
		if (got < 0 && errno != EINTR)
			return errno;
		if (got > 0) {
			to += got;
			offset += (size_t)got;
			size -= (size_t)got;
		}
	}
	return 0;
}

static enum status read_failed(struct error *why, int problem)
{
	return error_set(why, STATUS_IO, "%s",
			 problem == FILE_SHORT ? "it shrank while being read" : strerror(problem));
}

static bool looks_like_text(const unsigned char *s, size_t length)
{
	if (length >= 3 && memcmp(s, "\xef\xbb\xbf", 3) == 0) { /* the mark some programs put before UTF-8 */
		s += 3;
		length -= 3;
	}
	for (size_t i = 0; i < length; i++)
		if ((s[i] < 0x20 && !(s[i] >= '\t' && s[i] <= '\r')) || s[i] > 0x7e)
			return false;
	return true;
}

/* Reads and judges the header; gives n_phi_d. `size` is the file's. */
static enum status read_header(int fd, size_t size, int *n_phi_d, struct header *header, struct error *why)
{
	const size_t length = size < sizeof *header ? size : sizeof *header;
	const int problem = read_fully(fd, header, length, 0);

	if (problem)
		return read_failed(why, problem);
	const char *foreign = foreign_file(header, length);
	if (foreign)
		return error_set(why, STATUS_FORMAT, "it %s", foreign);
	if (looks_like_text((const unsigned char *)header, length))
		return error_set(why, STATUS_FORMAT, "expected a binary MERL table, found what looks like text");
	if (length < sizeof *header)
		return error_set(why, STATUS_FORMAT, "expected a header of %zu bytes, found %zu", sizeof *header, size);
	for (*n_phi_d = 180; *n_phi_d <= 360; *n_phi_d += 180) {
		const struct header wanted = header_for(*n_phi_d);
		if (memcmp(header, &wanted, sizeof wanted) == 0)
			return STATUS_OK;
	}
	return error_set(why, STATUS_FORMAT,
			 "expected a 90 x 90 x 180 or 90 x 90 x 360 table, found %" PRId32 " x %" PRId32 " x %" PRId32,
			 (int32_t)le32toh(header->n[0]), (int32_t)le32toh(header->n[1]),
			 (int32_t)le32toh(header->n[2]));
}

/* Scales numbers of the file to 1/sr. Adding zero turns -0 into 0 and leaves the rest as it is: a sign bit in the
 * result then means that the number was negative, were it too small for a float. */
static void convert(const uint64_t *restrict raw, float *restrict value, size_t count, double scale)
{
#pragma omp simd
	for (size_t e = 0; e < count; e++)
		value[e] = (float)((from_file(raw[e]) + 0.0) * scale);
}

static uint32_t sign_of(float value)
{
	uint32_t bits;

	memcpy(&bits, &value, sizeof bits);
	return bits >> 31;
}

static uint32_t is_nonfinite(float value)
{
	return fabsf(value) <= FLT_MAX ? 0u : 1u;
}

struct masked {
	uint32_t negative, nonfinite; /* entries */
};

/* Masks converted entries in all channels where one is negative or not finite, counts them, and flushes denormals. */
static struct masked mask(const struct measurement *measurement, size_t first, size_t count)
{
	float *restrict r = measurement->value[0] + first;
	float *restrict g = measurement->value[1] + first;
	float *restrict b = measurement->value[2] + first;
	uint32_t n_negative = 0, n_nonfinite = 0;

#pragma omp simd reduction(+ : n_negative, n_nonfinite)
	for (size_t e = 0; e < count; e++) {
		const uint32_t nonfinite = is_nonfinite(r[e]) | is_nonfinite(g[e]) | is_nonfinite(b[e]);
		const uint32_t negative = sign_of(r[e]) | sign_of(g[e]) | sign_of(b[e]);
		const float hidden = (nonfinite | negative) ? NAN : 0.0f;
		n_nonfinite += nonfinite;
		n_negative += negative & ~nonfinite;
		r[e] = (r[e] < FLT_MIN ? 0.0f : r[e]) + hidden;
		g[e] = (g[e] < FLT_MIN ? 0.0f : g[e]) + hidden;
		b[e] = (b[e] < FLT_MIN ? 0.0f : b[e]) + hidden;
	}
	return (struct masked){n_negative, n_nonfinite};
}

/* struct turns - lets threads do something one after the other. Unlike OpenMP's `ordered`, a waiting thread sleeps. On
 * a busy machine a spinning thread competes with the one it waits for, and reading takes ten times as long. */
struct turns {
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	int now;
};

static void turns_await(struct turns *turns, int turn)
{
	pthread_mutex_lock(&turns->mutex);
	while (turns->now != turn)
		pthread_cond_wait(&turns->changed, &turns->mutex);
	pthread_mutex_unlock(&turns->mutex);
}

static void turns_next(struct turns *turns)
{
	pthread_mutex_lock(&turns->mutex);
	turns->now++;
	pthread_cond_broadcast(&turns->changed);
	pthread_mutex_unlock(&turns->mutex);
}

/* Reads, converts, masks and hashes everything after the header, in one pass over the file: while one thread hashes its
 * block, which goes in file order, the others read and convert theirs. */
static enum status read_planes(int fd, int threads, XXH3_state_t *hash, uint64_t *buffers,
			       struct measurement *measurement, struct error *why)
{
	const size_t count = measurement_count(measurement) / BLOCKS_PER_PLANE;
	const size_t size = count * sizeof *buffers;
	struct turns turns = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, 0};
	size_t n_negative = 0, n_nonfinite = 0;
	atomic_int next = 0, failed = 0;

#pragma omp parallel num_threads(threads) reduction(+ : n_negative, n_nonfinite)
	/* Blocks are handed out in file order, so the thread that has the next block never waits for a later one. */
	for (int block; (block = next++) < N_BLOCKS;) {
		const int channel = block / BLOCKS_PER_PLANE;
		const size_t first = (size_t)(block % BLOCKS_PER_PLANE) * count;
		uint64_t *raw = buffers + (size_t)omp_get_thread_num() * count;
		int problem = failed;

		if (!problem)
			problem = read_fully(fd, raw, size, sizeof(struct header) + (size_t)block * size);
		if (!problem)
			convert(raw, measurement->value[channel] + first, count, scale_of(channel));
		turns_await(&turns, block);
		if (!failed)
			failed = problem;
		problem = failed;
		if (!problem)
			XXH3_64bits_update(hash, raw, size);
		turns_next(&turns);
		/* All earlier blocks are converted by now, those of the other two planes among them. */
		if (channel == MERL_CHANNELS - 1 && !problem) {
			const struct masked masked = mask(measurement, first, count);
			n_negative += masked.negative;
			n_nonfinite += masked.nonfinite;
		}
	}
	if (failed)
		return read_failed(why, failed);
	measurement->n_negative = n_negative;
	measurement->n_nonfinite = n_nonfinite;
	measurement->file_hash = XXH3_64bits_digest(hash);
	return STATUS_OK;
}

/* read_planes() with the memory that it needs. */
static enum status read_table(int fd, const struct header *header, int threads, struct measurement *measurement,
			      struct error *why)
{
	const int team = threads < 1 ? 1 : threads < N_BLOCKS ? threads : N_BLOCKS;
	const size_t count = measurement_count(measurement) / BLOCKS_PER_PLANE;
	uint64_t *buffers = malloc((size_t)team * count * sizeof *buffers);
	XXH3_state_t *hash = XXH3_createState();
	enum status status = STATUS_NO_MEMORY;

	if (buffers && hash) {
		XXH3_64bits_reset(hash);
		XXH3_64bits_update(hash, header, sizeof *header);
		status = read_planes(fd, team, hash, buffers, measurement, why);
	}
	XXH3_freeState(hash);
	free(buffers);
	return status;
}

/* If another program writes the file meanwhile, what was read may mix two versions. */
static enum status check_unchanged(int fd, const struct stat *before, struct error *why)
{
	struct stat now;

	if (fstat(fd, &now) != 0)
		return error_set(why, STATUS_IO, "%s", strerror(errno));
	if (now.st_size != before->st_size || now.st_mtim.tv_sec != before->st_mtim.tv_sec ||
	    now.st_mtim.tv_nsec != before->st_mtim.tv_nsec)
		return error_set(why, STATUS_IO, "it changed while being read");
	return STATUS_OK;
}

static enum status read_open(int fd, const struct stat *st, int threads, struct measurement *measurement,
			     struct error *why)
{
	struct header header;
	int n_phi_d = 0;
	enum status status = read_header(fd, (size_t)st->st_size, &n_phi_d, &header, why);

	if (status != STATUS_OK)
		return status;
	const uint64_t size = file_size_for(n_phi_d);
	/* Half the size of the larger table is that of the smaller one. */
	if (n_phi_d == 180 && (uint64_t)st->st_size == sizeof header + (size - sizeof header) / 2)
		return error_set(
			why, STATUS_FORMAT,
			"it has the size of a MERL table with numbers of 4 bytes: write them as 8 bytes (double)");
	if ((uint64_t)st->st_size != size)
		return error_set(why, STATUS_FORMAT, "expected %" PRIu64 " bytes for a 90 x 90 x %d table, found %jd",
				 size, n_phi_d, (intmax_t)st->st_size);
	status = measurement_reserve(measurement, n_phi_d);
	if (status != STATUS_OK)
		return status;
	measurement->file_size = size;
	status = read_table(fd, &header, threads, measurement, why);
	return status == STATUS_OK ? check_unchanged(fd, st, why) : status;
}

enum status merl_read(const char *path, int threads, struct measurement *measurement, struct error *error)
{
	struct error why = {{0}};
	struct stat st = {0};
	int fd;

	*measurement = (struct measurement){0};
	enum status status = regular_file_open(path, "a MERL file", &fd, &st, &why);
	if (status == STATUS_OK)
		status = read_open(fd, &st, threads, measurement, &why);
	if (fd >= 0)
		close(fd);
	if (status != STATUS_OK) {
		char name[TEXT_QUOTE_SIZE];
		text_quote(path, name, sizeof name);
		measurement_free(measurement);
		return error_set(error, status, "cannot read '%s': %s", name,
				 why.text[0] ? why.text : status_str(status));
	}
	return STATUS_OK;
}

/* Writes a plane; false and errno on failure. */
static bool write_plane(FILE *stream, const float *value, size_t count, double scale)
{
	uint64_t raw[512];

	for (size_t first = 0; first < count; first += 512) {
		const size_t n = count - first < 512 ? count - first : 512;
		for (size_t e = 0; e < n; e++)
			raw[e] = to_file(isnan(value[first + e]) ? -1.0 : value[first + e] / scale);
		if (fwrite(raw, sizeof *raw, n, stream) != n)
			return false;
	}
	return true;
}

enum status merl_write(const char *path, const struct measurement *measurement, struct error *error)
{
	const struct header header = header_for(measurement->n_phi_d);
	struct atomic_file file;
	enum status status = measurement_require_table(measurement, "a MERL file", error);

	if (status == STATUS_OK)
		status = atomic_file_open(&file, path, error);

	if (status != STATUS_OK)
		return status;
	bool written = fwrite(&header, sizeof header, 1, file.stream) == 1;
	for (int c = 0; c < MERL_CHANNELS && written; c++)
		written = write_plane(file.stream, measurement->value[c], measurement_count(measurement), scale_of(c));
	if (!written)
		file.errnum = errno;
	return atomic_file_commit(&file, error);
}
