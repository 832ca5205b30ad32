/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PFM, Radiance and PNG files: there and back, known bytes, and files that are none. */
#include "check.h"
#include "fit/render/colour.h"
#include "fit/render/image.h"
#include <sys/stat.h>
#include <unistd.h>

static char directory[] = "/tmp/stdfit-image-XXXXXX";

static void write_file(const char *name, const void *bytes, size_t size)
{
	FILE *file = fopen(name, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

static struct image read_back(const char *name)
{
	struct image image;
	struct error error = {""};
	if (image_read(name, &image, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	return image;
}

/* The file is refused with one line that has `part`. */
static void expect_refusal(const char *name, const char *part)
{
	struct image image = {1, 1, NULL};
	struct error error = {""};
	if (image_read(name, &image, &error) == STATUS_OK)
		fail_msg("%s: read without complaint, expected '%s'", name, part);
	assert_null(image.rgb);
	if (!strstr(error.text, part) || !strstr(error.text, name) || strchr(error.text, '\n'))
		fail_msg("%s: expected '%s' in: %s", name, part, error.text);
}

static void expect_bytes_refused(const void *bytes, size_t size, const char *part)
{
	write_file("bad", bytes, size);
	expect_refusal("bad", part);
}
#define REFUSED(text, part) expect_bytes_refused(text, sizeof(text) - 1, part)

static struct image make_image(int width, int height)
{
	struct image image;
	assert_int_equal(image_alloc(&image, width, height), STATUS_OK);
	for (int i = 0; i < 3 * width * height; i++)
		image.rgb[i] = ldexpf(1 + (float)(i * 7 % 13) / 13, i * 5 % 30 - 15);
	return image;
}

static void pfm_there_and_back(void **state)
{
	(void)state;
	struct image image = make_image(7, 5);
	image.rgb[4] = -0.0F;
	image.rgb[5] = INFINITY;
	image.rgb[6] = -1e-42F;
	struct error error = {""};
	assert_int_equal(image_write_pfm("a.pfm", &image, &error), STATUS_OK);
	struct image back = read_back("a.pfm");
	assert_int_equal(back.width, 7);
	assert_int_equal(back.height, 5);
	assert_memory_equal(back.rgb, image.rgb, 7 * 5 * 3 * sizeof(float));
	image_free(&back);
	image_free(&image);
}

static void pfm_of_known_bytes(void **state)
{
	(void)state;
	/* Big-endian, grey, bottom row first: 1 below 2. */
	write_file("grey.pfm", "Pf 1 2\n1.0\n\x3f\x80\0\0\x40\0\0\0", 19);
	struct image image = read_back("grey.pfm");
	for (int c = 0; c < 3; c++) {
		assert_true(image_at(&image, 0, 0)[c] == 2.0F);
		assert_true(image_at(&image, 0, 1)[c] == 1.0F);
	}
	image_free(&image);
	/* Little-endian; the digit behind the header is a byte of the first pixel. */
	write_file("colour.pfm", "PF\r\n1\r\n1\r\n-2.5\n4\0\x80\x3f\0\0\0\x40\0\0\x40\x40", 28);
	image = read_back("colour.pfm");
	assert_true(fabsf(image.rgb[0] - 1) < 1e-5F && image.rgb[1] == 2 && image.rgb[2] == 3);
	image_free(&image);
}

static const char header[] = "#?RADIANCE\n# by hand\nFORMAT=32-bit_rle_rgbe\n";

/* A Radiance file with these lines of header and rows behind it. */
static void write_hdr(const char *name, const char *more, const void *rows, size_t size)
{
	char bytes[4096];
	const int n = snprintf(bytes, sizeof bytes, "%s%s", header, more);
	memcpy(bytes + n, rows, size);
	write_file(name, bytes, (size_t)n + size);
}

static void hdr_of_known_bytes(void **state)
{
	(void)state;
	/* Two flat pixels: (m + 1/2) 2^(e - 136); an exponent of 0 is black. */
	write_hdr("flat.hdr", "\n-Y 1 +X 2\n", "\x80\x40\x20\x81\xff\xff\xff\x00", 8);
	struct image image = read_back("flat.hdr");
	assert_true(image.rgb[0] == 128.5F / 128 && image.rgb[1] == 64.5F / 128 && image.rgb[2] == 32.5F / 128);
	assert_true(image.rgb[3] == 0 && image.rgb[4] == 0 && image.rgb[5] == 0);
	image_free(&image);
	/* Exposures are divided out. */
	write_hdr("exposed.hdr", "EXPOSURE=4\nEXPOSURE= 0.5\n\n-Y 1 +X 1\n", "\x80\x40\x20\x81", 4);
	image = read_back("exposed.hdr");
	assert_true(image.rgb[0] == 128.5F / 256);
	image_free(&image);
	/* Run-length encoded: a run of 8 reds, 3 + 5 greens, 8 literal blues, a run of exponents; then one like the
	 * old form: a pixel, repeated 2 + 256 * 0 times ... */
	static const char rle[] = "\x02\x02\x00\x08"
				  "\x88\x0a"
				  "\x83\x01\x85\x02"
				  "\x08\x00\x01\x02\x03\x04\x05\x06\x07"
				  "\x88\x88";
	write_hdr("rle.hdr", "\n-Y 1 +X 8\n", rle, sizeof rle - 1);
	image = read_back("rle.hdr");
	for (int x = 0; x < 8; x++) {
		assert_true(image_at(&image, x, 0)[0] == 10.5F);
		assert_true(image_at(&image, x, 0)[1] == (x < 3 ? 1.5F : 2.5F));
		assert_true(image_at(&image, x, 0)[2] == (float)x + 0.5F);
	}
	image_free(&image);
	write_hdr("old.hdr", "\n-Y 2 +X 3\n",
		  "\x05\x06\x07\x88\x01\x01\x01\x02\x05\x06\x07\x88\x01\x01\x01\x01\x08\x06\x07\x88", 20);
	image = read_back("old.hdr");
	assert_true(image_at(&image, 2, 0)[0] == 5.5F && image_at(&image, 1, 1)[2] == 7.5F);
	assert_true(image_at(&image, 2, 1)[0] == 8.5F);
	image_free(&image);
}

static void broken_files_are_refused(void **state)
{
	(void)state;
	expect_refusal("no-such-file", "No such file");
	assert_int_equal(mkdir("a-directory", 0700), 0);
	expect_refusal("a-directory", "found a directory");
	assert_int_equal(rmdir("a-directory"), 0);
	assert_int_equal(mkfifo("a-pipe", 0600), 0);
	expect_refusal("a-pipe", "pipe or device");
	REFUSED("", "empty");
	REFUSED("material,ndf,error\n", "expected a PFM or Radiance .hdr picture");
	REFUSED("PF", "expected a PFM or Radiance");
	REFUSED("PF\n", "expected width, height and scale");
	REFUSED("PF\n2 two -1\n", "expected width, height and scale");
	REFUSED("PF\n2.5 2 -1\n", "expected width, height and scale");
	REFUSED("PF\n2 2 0\n", "expected width, height and scale");
	REFUSED("PF\n1 1 -1\n", "expected 12 bytes of pixels, found 0");
	REFUSED("PF\n1 1 -1\n12345678901", "expected 12 bytes of pixels, found 11");
	REFUSED("PF\n0 5 -1\n", "found 0 x 5");
	REFUSED("PF\n-3 -5 -1\n", "found -3 x -5");
	REFUSED("PF\n1e300 1 -1\n", "found 1e+300 x 1");
	REFUSED("PF\n111111111111111111111111111111111111111111 1 -1\n", "expected width, height and scale");
	REFUSED("#?RADIANCE\n", "expected a header");
	REFUSED("#?RADIANCE\n\n-Y 1 +X 1\n1234", "expected a header with FORMAT");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n1234", "found another format");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=0\n\n-Y 1 +X 1\n1234", "EXPOSURE above 0");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+Y 1 +X 1\n1234", "'-Y height +X width'");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 1\n1234", "found 1 x 0");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32000 +X 32000\n1234", "at most 2^27 pixels");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 1\n1234", "row 2 of 2");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10000 +X 10000\n12341112",
		"10000 x 10000 pixels, more than 8 bytes");
	/* A run that repeats nothing; one that is too long; an encoded row of another width; a run past its end. */
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\1\1\1\2", "row 1 of 1");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\3\1\1\2\1\1\1\2", "row 1 of 1");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\2\2\0\7\x87\1\x87\1\x87\1\x87\1", "row 1 of 1");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\2\2\0\x08\x89\1\x88\1\x88\1\x88\1", "row 1 of 1");
	REFUSED("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\2\2\0\x08\0\1\x88\1\x88\1\x88\1", "row 1 of 1");
}

/* Every beginning of a good file is refused or, once whole, read. */
static void cut_short_anywhere(void **state)
{
	(void)state;
	char bytes[256];
	const int n = snprintf(bytes, sizeof bytes, "%s\n-Y 1 +X 8\n", header);
	static const char row[] =
		"\x02\x02\x00\x08\x88\x0a\x83\x01\x85\x02\x08\x00\x01\x02\x03\x04\x05\x06\x07\x88\x88";
	memcpy(bytes + n, row, sizeof row - 1);
	const size_t size = (size_t)n + sizeof row - 1;
	for (size_t length = 0; length < size; length++) {
		write_file("cut", bytes, length);
		expect_refusal("cut", "cannot read");
	}
	write_file("cut", bytes, size);
	struct image image = read_back("cut");
	image_free(&image);
}

static void png_is_what_was_drawn(void **state)
{
	(void)state;
	struct image image;
	struct error error = {""};
	assert_int_equal(image_alloc(&image, 5, 3), STATUS_OK);
	for (int i = 0; i < 45; i++)
		image.rgb[i] = (float)srgb_decode(i / 44.0);
	image.rgb[0] = -1;
	image.rgb[1] = NAN;
	image.rgb[44] = 1e30F;
	const enum status status = image_write_png("a.png", &image, &error);
	image_free(&image);
	if (!image_has_png()) {
		assert_int_equal(status, STATUS_UNSUPPORTED);
		assert_non_null(strstr(error.text, "libpng"));
		assert_int_not_equal(access("a.png", F_OK), 0);
		skip_for_want_of("libpng-dev");
	}
	assert_int_equal(status, STATUS_OK);
	FILE *file = fopen("a.png", "rb");
	unsigned char bytes[33];
	assert_non_null(file);
	assert_int_equal(fread(bytes, 1, sizeof bytes, file), sizeof bytes);
	fclose(file);
	/* Signature and header: 5 x 3, 8 bits, RGB. */
	assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\5\0\0\0\3\x08\2", 26);
}

static void a_picture_that_cannot_be_written(void **state)
{
	(void)state;
	struct image image = make_image(2, 2);
	struct error error = {""};
	assert_int_equal(image_write_pfm("no/such/place.pfm", &image, &error), STATUS_IO);
	assert_non_null(strstr(error.text, "cannot write 'no/such/place.pfm'"));
	if (image_has_png())
		assert_int_equal(image_write_png("no/such/place.png", &image, &error), STATUS_IO);
	image_free(&image);
	assert_int_equal(image_alloc(&image, 0, 5), STATUS_DOMAIN);
	assert_int_equal(image_alloc(&image, 5, IMAGE_SIZE_MAX + 1), STATUS_DOMAIN);
}

static int enter(void **state)
{
	(void)state;
	return mkdtemp(directory) && !chdir(directory) ? 0 : -1;
}

static int leave(void **state)
{
	(void)state;
	static const char *const files[] = {"a.pfm",   "grey.pfm", "colour.pfm", "flat.hdr", "exposed.hdr", "rle.hdr",
					    "old.hdr", "bad",      "a-pipe",     "cut",      "a.png"};
	for (size_t i = 0; i < sizeof files / sizeof *files; i++)
		unlink(files[i]);
	return chdir("/") || rmdir(directory);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pfm_there_and_back),
		cmocka_unit_test(pfm_of_known_bytes),
		cmocka_unit_test(hdr_of_known_bytes),
		cmocka_unit_test(broken_files_are_refused),
		cmocka_unit_test(cut_short_anywhere),
		cmocka_unit_test(png_is_what_was_drawn),
		cmocka_unit_test(a_picture_that_cannot_be_written),
	};
	return cmocka_run_group_tests(tests, enter, leave);
}
