/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first byte says what kind of file this is. 0 to 127: the rest is all of it. From 128 on: the next 12 bytes are
 * its header, and it is zero behind that, but for records of 11 bytes each, which put a number (8) at an index (3). Its
 * size is the one that the header asks for, the same and a byte, the same without the last byte, or 1 TB. The file is
 * kept in memory, and zeroed again by overwriting the records: each of many runs costs no more than reading it. */
#include "data_readers/merl.h"
#include "fuzz.h"

#include <float.h>
#include <math.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { HEADER = 12, RECORD = 11, RECORDS_MAX = 64, WHOLE_FILE = 128 };

static const double scale[MERL_CHANNELS] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

static size_t entries(int n_phi_d)
{
	return (size_t)MERL_THETA_H * MERL_THETA_D * (size_t)n_phi_d;
}

static size_t index_of(const uint8_t *record, int n_phi_d)
{
	return (record[0] | (size_t)record[1] << 8 | (size_t)record[2] << 16) % (MERL_CHANNELS * entries(n_phi_d));
}

static double number_at(int fd, size_t index)
{
	double x;
	if (pread(fd, &x, sizeof x, (off_t)(HEADER + 8 * index)) != sizeof x)
		abort();
	return x;
}

static bool is_finite(double x, int channel)
{
	return fabsf((float)(x * scale[channel])) <= FLT_MAX;
}

/* The three values of an entry are what its numbers in the file make them. Returns whether it is masked. */
static bool check_entry(int fd, const struct measurement *measurement, size_t entry)
{
	bool masked = false;
	double x[MERL_CHANNELS];
	for (int c = 0; c < MERL_CHANNELS; c++) {
		x[c] = number_at(fd, (size_t)c * entries(measurement->n_phi_d) + entry);
		masked |= !is_finite(x[c], c) || x[c] < 0;
	}
	for (int c = 0; c < MERL_CHANNELS; c++) {
		const float got = measurement->value[c][entry], want = (float)(x[c] * scale[c]);
		PROMISE(isnan(got) == masked);
		PROMISE(masked || got == want || (want < FLT_MIN && got == 0));
	}
	return masked;
}

static size_t count_masked(const struct measurement *measurement)
{
	size_t masked = 0;
	for (size_t e = 0; e < entries(measurement->n_phi_d); e++)
		masked += isnan(measurement->value[0][e]) != 0;
	return masked;
}

static void check_samples(int fd, const struct measurement *measurement, const uint8_t *record, size_t n)
{
	bool seen[RECORDS_MAX] = {false}; /* the entry of an earlier record */
	size_t masked = 0;
	for (size_t i = 0; i < n; i++) {
		const size_t entry =
			index_of(record + i * RECORD, measurement->n_phi_d) % entries(measurement->n_phi_d);
		for (size_t j = 0; j < i; j++)
			seen[i] |=
				index_of(record + j * RECORD, measurement->n_phi_d) % entries(measurement->n_phi_d) ==
				entry;
		masked += check_entry(fd, measurement, entry) && !seen[i];
	}
	PROMISE(measurement->n_negative + measurement->n_nonfinite == masked);
	PROMISE(count_masked(measurement) == masked);
}

static void write_at(int fd, const void *bytes, size_t size, off_t offset)
{
	if (pwrite(fd, bytes, size, offset) != (ssize_t)size)
		abort();
}

static int memory_file(void)
{
	const int fd = memfd_create("fuzz", MFD_CLOEXEC);
	if (fd < 0)
		abort();
	return fd;
}

/* Reads the file; what cannot be read is told in one line. Returns whether it could be. */
static bool read_file(int fd, struct measurement *measurement)
{
	char path[64], message[1024];
	struct error error = {""};
	snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
	const enum status status = merl_read(path, 1, measurement, &error);
	snprintf(message, sizeof message, "stdfit: %s\n", error.text);
	PROMISE(status == STATUS_OK || (measurement->value[0] == NULL && is_message(message)));
	return status == STATUS_OK;
}

static int small_file(const uint8_t *data, size_t size)
{
	struct measurement measurement;
	const int fd = memory_file();
	write_at(fd, data, size, 0);
	PROMISE(!read_file(fd, &measurement));
	close(fd);
	return 0;
}

/* The size that the file is given, by the kind. */
static off_t size_for(uint8_t kind, int n_phi_d)
{
	const off_t asked = (off_t)(HEADER + MERL_CHANNELS * sizeof(double) * entries(n_phi_d));
	const off_t sizes[] = {asked, asked, asked, asked, asked, asked + 1, asked - 1, (off_t)1 << 40};
	return sizes[kind % 8];
}

int fuzz_merl(const uint8_t *data, size_t size)
{
	static int fd = -1;
	struct measurement measurement;
	if (size == 0)
		return 0;
	if (data[0] < WHOLE_FILE || size < 1 + HEADER)
		return small_file(data + 1, size - 1);
	if (fd < 0)
		fd = memory_file();
	const uint8_t *record = data + 1 + HEADER;
	const size_t left = (size - 1 - HEADER) / RECORD, n = left < RECORDS_MAX ? left : RECORDS_MAX;
	uint32_t header[3];
	memcpy(header, data + 1, sizeof header);
	const int n_phi_d = header[2] == 360 ? 360 : 180;
	const off_t length = size_for(data[0], n_phi_d);
	if (ftruncate(fd, length) != 0)
		abort();
	write_at(fd, header, sizeof header, 0);
	for (size_t i = 0; i < n; i++)
		write_at(fd, record + i * RECORD + 3, 8, (off_t)(HEADER + 8 * index_of(record + i * RECORD, n_phi_d)));
	if (read_file(fd, &measurement)) {
		PROMISE(measurement.n_phi_d == n_phi_d && measurement.file_size == (uint64_t)length);
		check_samples(fd, &measurement, record, n);
		measurement_free(&measurement);
	}
	for (size_t i = 0; i < n; i++)
		write_at(fd, &(double){0}, 8, (off_t)(HEADER + 8 * index_of(record + i * RECORD, n_phi_d)));
	return 0;
}
