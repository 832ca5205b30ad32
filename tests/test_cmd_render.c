/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit render, and the pictures of compare: what comes out, what is refused, Ctrl-C. */
#include "fit/render/image.h"
#include "run_program.h"

#include <signal.h>
#include <sys/stat.h>

/* A material, and a quick picture of it with the parameters it was made with. */
#define MODEL "--ndf std --sigma 0.25 --gamma 1.8 --kd 0.3,0.2,0.1 --ks 0.5"
#define QUICK "--size 24 --samples 8"
/* A fit that takes a moment: few free parameters, few entries. */
#define CHEAP "--ndf ggx,beckmann --sigma 0.2 --ior 1.5 --max-theta 20"

/* The middle of the first sphere of 24 pixels: left of it a gap, above it two lines of labels. */
enum { MIDDLE_X = 4 + 12, MIDDLE_Y = 2 * 13 + 12 };

static bool is_there(const char *path)
{
	return access(path, F_OK) == 0;
}

static struct image read_picture(const char *path)
{
	struct image image;
	struct error error = {""};
	if (image_read(path, &image, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	return image;
}

/* A number of the first row of the CSV on standard output, by column. */
static double number_at(int column)
{
	const char *at = strchr(last.out, '\n');
	assert_non_null(at);
	for (at++; column > 0; column--) {
		at = strchr(at, ',');
		assert_non_null(at);
		at++;
	}
	return strtod(at, NULL);
}

static void a_material_beside_its_own_model_shows_no_difference(void **state)
{
	(void)state;
	stdfit("render m.binary " MODEL " " QUICK " -o own.pfm");
	expect_code(0);
	expect_out("material,ndf,weight,error,rmse,delta_e,ssim\nm,std,,,");
	assert_int_equal(count_lines(last.out), 2);
	check_between(number_at(5), 0, 0.2, "delta E");
	check_between(number_at(6), 0.999, 1, "SSIM");
	assert_string_equal(last.err, "");
	/* Two spheres, and below them the legend and the difference. */
	struct image image = read_picture("own.pfm");
	check_between(image.width, 2 * 24, 3 * 24, "width");
	check_between(image.height, 2 * 24, 5 * 24, "height");
	float most = 0;
	for (int i = 0; i < 3 * image.width * image.height; i++) {
		assert_true(image.rgb[i] >= 0);
		most = fmaxf(most, image.rgb[i]);
	}
	assert_true(most > 0.2F);
	image_free(&image);
	/* Another model is another picture. */
	stdfit("render m.binary --kd 0.3,0.2,0.1 " QUICK);
	expect_code(0);
	assert_true(number_at(5) > 1);
}

static void the_same_bits_for_seed_and_threads(void **state)
{
	(void)state;
	stdfit("render m.binary " MODEL " " QUICK " --seed 5 --threads 1 -o one.pfm");
	expect_code(0);
	stdfit("render m.binary " MODEL " " QUICK " --seed 5 --threads 3 -o three.pfm");
	expect_code(0);
	stdfit("render m.binary " MODEL " " QUICK " --seed 6 -o other.pfm");
	expect_code(0);
	shell("cmp one.pfm three.pfm && ! cmp -s one.pfm other.pfm");
	expect_code(0);
	/* One stop is twice the light. */
	stdfit("render m.binary " MODEL " " QUICK " --seed 5 --exposure 1 -o bright.pfm");
	expect_code(0);
	struct image one = read_picture("one.pfm"), bright = read_picture("bright.pfm");
	check_rel((double)image_at(&bright, MIDDLE_X, MIDDLE_Y)[1], 2 * (double)image_at(&one, MIDDLE_X, MIDDLE_Y)[1],
		  1e-6, "one stop");
	image_free(&one);
	image_free(&bright);
}

static void the_extension_decides_the_format(void **state)
{
	(void)state;
	stdfit("render m.binary " MODEL " " QUICK " -o picture.png");
	expect_code(0);
	if (!image_has_png()) {
		expect_error(0, "the picture goes to 'picture.pfm'");
		struct image image = read_picture("picture.pfm");
		image_free(&image);
		assert_false(is_there("picture.png"));
		skip_for_want_of("libpng-dev");
	}
	shell("head -c 8 picture.png | od -An -c | tr -d ' \\n'");
	expect_out("211PNG\\r\\n032\\n");
}

static void fits_and_tables_make_sheets(void **state)
{
	(void)state;
	stdfit("fit m.binary n.binary " CHEAP " -o fits.csv");
	expect_code(0);
	stdfit("render fits.csv " QUICK " -o sheet.pfm");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 5);
	expect_out("\nm,beckmann,none,");
	expect_out("\nn,ggx,none,");
	struct image sheet = read_picture("sheet.pfm");
	check_between(sheet.width, 3 * 24, 4 * 24, "three columns");
	check_between(sheet.height, 2 * 24, 4 * 24, "two rows");
	/* The same from the files and their rows; one NDF of them; with the differences. */
	char *all = strdup(last.out);
	stdfit("render m.binary n.binary --from fits.csv " QUICK);
	expect_code(0);
	assert_string_equal(last.out, all);
	free(all);
	stdfit("render . --from fits.csv --ndf ggx --difference " QUICK " -o more.pfm");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 3);
	struct image more = read_picture("more.pfm");
	assert_true(more.width < sheet.width && more.height > sheet.height + 24);
	image_free(&more);
	image_free(&sheet);
	/* And from fits made for the picture. Without -o the numbers alone. */
	stdfit("render m.binary " CHEAP " " QUICK);
	expect_code(0);
	expect_out("material,ndf,weight,error,rmse,delta_e,ssim\n");
	expect_out("\nm,ggx,");
	assert_true(number_at(5) > 0);
	/* These have the weight that pictures agree with best, which is told; who names a weight gets that. */
	char *own = strdup(last.out);
	stdfit("render m.binary " CHEAP " " QUICK);
	expect_error(0, "fitted under --weight solid-angle");
	assert_string_equal(last.out, own);
	stdfit("render m.binary --weight solid-angle " CHEAP " " QUICK);
	assert_string_equal(last.err, "");
	assert_string_equal(last.out, own);
	stdfit("render m.binary --weight none " CHEAP " " QUICK);
	assert_string_equal(last.err, "");
	assert_string_not_equal(last.out, own);
	stdfit("render fits.csv " QUICK);
	assert_string_equal(last.err, "");
	free(own);
	/* compare shows the same errors beside its own. */
	stdfit("compare fits.csv --pictures");
	expect_code(0);
	expect_out("gain_over_beckmann,delta_e_beckmann,delta_e_ggx,ssim_beckmann,ssim_ggx\n");
	assert_int_equal(count_lines(last.out), 7);
	stdfit("compare fits.csv");
	expect_code(0);
	assert_null(strstr(last.out, "delta_e"));
}

static void light_comes_from_names_maps_and_points(void **state)
{
	(void)state;
	/* A grey map of light: Lambert alone stays below it. */
	shell("{ printf 'PF\\n8 4\\n-1\\n'; for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 "
	      "26 27 "
	      "28 29 30 31 32; do printf '\\0\\0\\200?\\0\\0\\200?\\0\\0\\200?'; done; } >grey.pfm");
	expect_code(0);
	stdfit("render m.binary " MODEL " " QUICK " -e grey.pfm -o grey_light.pfm");
	expect_code(0);
	struct image image = read_picture("grey_light.pfm");
	float *middle = image_at(&image, MIDDLE_X, MIDDLE_Y);
	check_between((double)middle[0], 0.25, 1, "red");
	assert_true(middle[0] > middle[1] && middle[1] > middle[2]);
	image_free(&image);
	stdfit("render m.binary " MODEL " " QUICK " -e sky");
	expect_code(0);
	stdfit("render m.binary " MODEL " " QUICK " --light '0,0,1;-1,1,1,0.5' --sampling ndf");
	expect_code(0);
	stdfit("render m.binary " MODEL " " QUICK " -e studio --light 0,0,1");
	expect_code(0);
}

static void wrong_usage_is_refused(void **state)
{
	(void)state;
	shell("printf 'material,value\\nm,1\\n' >other.csv; printf 'PF\\n3 "
	      "2\\n-1\\n0123456789012345678901234567890123456789"
	      "01234567890123456789012345678901' >square.pfm; echo text >text.hdr");
	stdfit("render m.binary " MODEL " -e other.csv -o no.pfm");
	expect_error(1, "cannot read 'other.csv': expected a PFM or Radiance .hdr picture");
	stdfit("render m.binary " MODEL " -e text.hdr -o no.pfm");
	expect_error(1, "'text.hdr'");
	stdfit("render m.binary " MODEL " -e square.pfm -o no.pfm");
	expect_error(1, "cannot light with 'square.pfm': expected a map of latitude and longitude");
	stdfit("render m.binary " MODEL " -e no-such.hdr -o no.pfm");
	expect_error(1, "'no-such.hdr': No such file");
	stdfit("render other.csv -o no.pfm");
	expect_error(1, "'other.csv'");
	stdfit("render m.binary " MODEL " " QUICK " -o no/such/place.pfm");
	expect_error(1, "cannot write 'no/such/place.pfm'");
	stdfit("render m.binary " MODEL " -o no.jpg");
	expect_error(2, "expected -o FILE.png, -o FILE.pfm or -o -");
	stdfit("render m.binary " MODEL " " QUICK " --difference");
	expect_error(2, "--difference needs -o FILE");
	assert_string_equal(last.out, "");
	stdfit("render m.binary " MODEL " --light 0,0,0");
	expect_error(2, "bad value '0,0,0' for --light");
	stdfit("render m.binary " MODEL " --light 1,2,3,4,5");
	expect_error(2, "for --light");
	stdfit("render m.binary " MODEL " --size 7");
	expect_error(2, "--size");
	stdfit("render m.binary --from fits.csv --kd 0.5");
	expect_error(2, "--kd and --from exclude each other");
	stdfit("render fits.csv m.binary");
	expect_error(2, "expected one table and nothing beside it");
	shell("for n in 1 2 3 4 5 6 7 8; do : >no$n.binary; done");
	stdfit("render m.binary " MODEL
	       " --size 4096 --samples 1 --light 0,0,1 -o no.pfm no1.binary no2.binary no3.binary "
	       "no4.binary no5.binary no6.binary no7.binary no8.binary");
	expect_error(1, "the picture would be too large");
	assert_false(is_there("no.pfm"));
	shell("{ printf 'PF\\n2 1\\n-1\\n'; printf '\\0\\0\\200?\\0\\0\\200?\\0\\0\\200?'; printf "
	      "'\\0\\0\\200?\\0\\0\\200?\\0\\0\\200?'; } "
	      ">light.pfm; cp light.pfm light.bak");
	stdfit("render m.binary " MODEL " " QUICK " -e light.pfm -o ./light.pfm");
	expect_error(2, "--output names a file that is to be read");
	shell("cmp light.pfm light.bak");
	expect_code(0);
	stdfit("render");
	expect_error(2, "expected PATH..., found nothing; or a model");
	stdfit("render " MODEL);
	expect_error(2, "a model without a measurement needs -o FILE.png");
	stdfit("render " MODEL " --table -o no.pfm");
	expect_error(2, "--table means nothing without a measurement");
	stdfit("render " MODEL " --difference -o no.pfm");
	expect_error(2, "--difference means nothing without a measurement");
	stdfit("render --from fits.csv -o no.pfm");
	expect_error(2, "or --from FILE.json");
	stdfit("render " MODEL " " QUICK " -o no/such/place.pfm");
	expect_error(1, "no/such/place.pfm");
	stdfit("render " MODEL " --light 0,0,0 -o no.pfm");
	expect_error(2, "--light");
	assert_false(is_there("no.pfm"));
}

/* The sphere alone is the one that stands beside the table's. */
static void a_model_needs_no_measurement(void **state)
{
	(void)state;
	stdfit("render m.binary " MODEL " " QUICK " -o beside.pfm");
	expect_code(0);
	stdfit("render " MODEL " " QUICK " -o alone.pfm");
	expect_code(0);
	assert_string_equal(last.out, "");
	assert_string_equal(last.err, "");
	struct image beside = read_picture("beside.pfm"), alone = read_picture("alone.pfm");
	check_between(alone.width, 24, 2 * 24, "width");
	check_between(alone.height, 24, 3 * 24, "height");
	for (int y = -8; y < 8; y++)
		for (int x = -8; x < 8; x++)
			for (int c = 0; c < 3; c++)
				check_abs((double)image_at(&alone, MIDDLE_X + x, MIDDLE_Y + y)[c],
					  (double)image_at(&beside, MIDDLE_X + 24 + 4 + x, MIDDLE_Y + y)[c], 0,
					  "pixel");
	check_between((double)image_at(&alone, MIDDLE_X, MIDDLE_Y)[0], 0.05, 5, "light");
	image_free(&beside);
	image_free(&alone);
	/* Of an exported model, and one that differs along x and y. */
	stdfit("export " MODEL " --format json -o model.json");
	expect_code(0);
	stdfit("render --from model.json " QUICK " -o json.pfm");
	expect_code(0);
	shell("cmp alone.pfm json.pfm");
	expect_code(0);
	stdfit("render --ndf ggx --sigma 0.1,0.5 --angle 20 --kd 0.1 --ks 1 " QUICK " -o brushed.pfm");
	expect_code(0);
	assert_true(is_there("brushed.pfm"));
}

static void one_bad_file_costs_only_itself(void **state)
{
	(void)state;
	shell(": >bad.binary");
	stdfit("render bad.binary m.binary " MODEL " " QUICK " -o rest.pfm");
	expect_error(1, "bad.binary");
	assert_int_equal(count_lines(last.out), 2);
	assert_true(is_there("rest.pfm"));
	/* It leaves no gap either. */
	stdfit("render m.binary n.binary " MODEL " " QUICK " -o both.pfm");
	expect_code(0);
	stdfit("render m.binary bad.binary n.binary " MODEL " " QUICK " -o gap.pfm");
	expect_error(1, "bad.binary");
	shell("cmp both.pfm gap.pfm");
	expect_code(0);
	stdfit("render bad.binary " MODEL " " QUICK " -o none.pfm");
	expect_error(1, "bad.binary");
	assert_false(is_there("none.pfm"));
}

/* A picture beside a fit of something else would be no comparison. */
static void files_are_those_that_were_fitted(void **state)
{
	(void)state;
	shell("mkdir moved; cp m.binary moved/a.binary; cp n.binary moved/b.binary");
	stdfit("fit moved " CHEAP " -o moved.csv");
	expect_code(0);
	shell("cp n.binary moved/a.binary");
	stdfit("render moved.csv " QUICK " -o moved.pfm");
	expect_error(1, "'moved/a.binary': it is not the file any more that was fitted");
	assert_int_equal(count_lines(last.out), 3);
	expect_out("\nb,ggx,");
	stdfit("compare moved.csv --pictures");
	expect_error(1, "'moved/a.binary': it is not the file any more that was fitted");
	assert_int_equal(count_lines(last.out), 7);
	const char *end = strstr(strstr(last.out, "\na,") + 1, "\n");
	assert_memory_equal(end - 4, ",,,,", 4);
	/* Who names the file wants to see it beside these models. */
	stdfit("render moved/a.binary --from moved.csv " QUICK);
	expect_code(0);
	stdfit("render moved/a.binary n.binary --from moved.csv " QUICK);
	expect_error(1, "'moved.csv' has no such row: expected one of material 'n'");
	/* Two of one name: each beside its own. */
	shell("mkdir -p same/one same/two; cp m.binary same/one/x.binary; cp n.binary same/two/x.binary");
	stdfit("fit -r same --ndf ggx --sigma 0.2 --ior 1.5 --max-theta 20 -o same.csv");
	stdfit("render -r same --from same.csv " QUICK);
	expect_code(0);
	assert_int_equal(count_lines(last.out), 3);
	/* A table that does not say where its files are. */
	shell("sed 's,moved/b.binary,,' moved.csv >nowhere.csv; cp m.binary moved/a.binary");
	stdfit("compare nowhere.csv --pictures");
	expect_error(1, "cannot render 'b': the table has no path of its file");
}

static void an_interrupt_leaves_no_picture(void **state)
{
	(void)state;
	const pid_t pid =
		start("exec \"$STDFIT\" render m.binary " MODEL " --size 2048 --samples 65536 -o never.pfm 2>stderr");
	nanosleep(&(struct timespec){.tv_nsec = 600000000}, NULL);
	assert_int_equal(kill(pid, SIGINT), 0);
	assert_int_equal(end(pid), 130);
	assert_false(is_there("never.pfm"));
}

/* Glass of each NDF in a row; with all orders of scattering it is brighter. */
static void glass_is_shown_without_a_file(void **state)
{
	(void)state;
#define TWO_SPHERES "render --transmission --ndf std,ggx --sigma 1 --gamma 2.4 " QUICK " -e sky -o glass.pfm"
	double sum[2] = {0, 0};
	for (int multiple = 0; multiple < 2; multiple++) {
		if (multiple)
			stdfit(TWO_SPHERES " --multiple");
		else
			stdfit(TWO_SPHERES);
		expect_code(0);
		assert_string_equal(last.out, "");
		assert_string_equal(last.err, "");
		struct image image = read_picture("glass.pfm");
		check_between(image.width, 2 * 24, 3 * 24, "width");
		check_between(image.height, 2 * 24, 3 * 24, "height");
		for (int y = -4; y < 4; y++)
			for (int x = -4; x < 4; x++)
				sum[multiple] += image_at(&image, MIDDLE_X + x, MIDDLE_Y + y)[1] / 64;
		image_free(&image);
	}
	check_between(sum[0], 0.01, 10, "single");
	check_between(sum[1] / sum[0], 1.1, 20, "multiple over single");
}

static void glass_takes_its_own_options(void **state)
{
	(void)state;
#define GLASS "render --transmission --sigma 0.3 "
	static const struct {
		const char *arguments, *text;
	} wrong[] = {
		{"render --multiple m.binary", "--multiple means nothing without --transmission"},
		{GLASS "--gamma 2", "--transmission needs -o"},
		{GLASS "--gamma 2 -o no.pfm m.binary", "--transmission shows no files, found 1"},
		{GLASS "-o no.pfm", "--ndf std needs --gamma"},
		{GLASS "--ndf ggx --gamma 2 -o no.pfm", "--ndf ggx has no --gamma"},
		{"render --transmission --ndf ggx -o no.pfm", "--transmission needs --sigma"},
		{GLASS "--ndf ggx --ks 1 -o no.pfm", "--ks means nothing with --transmission"},
		{GLASS "--ndf ggx --multiple --gaf correlated -o no.pfm", "--gaf means nothing with --multiple"},
		{GLASS "--ndf ggx --multiple --sampling ndf -o no.pfm", "--sampling means nothing with --multiple"},
		{GLASS "--ndf ggx --gaf v-groove -o no.pfm", "v-groove is of reflection alone"},
		{GLASS "--ndf ggx -o no.jpg", "expected -o FILE.png"},
		{GLASS "--ndf ggx --light 0,0,0 -o no.pfm", "for --light"},
	};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		stdfit(wrong[i].arguments);
		expect_error(2, wrong[i].text);
	}
	stdfit(GLASS "--ndf gtr --gamma 2 --multiple -o no.pfm " QUICK);
	expect_error(1, "there is no glass of --ndf gtr with these options");
	stdfit(GLASS "--ndf pl -o no.pfm");
	expect_error(1, "--ndf pl does not allow these parameters");
	stdfit(GLASS "--ndf gtr --gamma 2 " QUICK " -o no/such/place.pfm");
	expect_error(1, "cannot write 'no/such/place.pfm'");
	assert_false(is_there("no.pfm"));
}

static int set_up(void **state)
{
	if (enter_directory(state))
		return -1;
	stdfit("synth m.binary " MODEL);
	expect_code(0);
	stdfit("synth n.binary --ndf ggx --sigma 0.1 --kd 0.05 --ks 1");
	expect_code(0);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_material_beside_its_own_model_shows_no_difference),
		cmocka_unit_test(the_same_bits_for_seed_and_threads),
		cmocka_unit_test(the_extension_decides_the_format),
		cmocka_unit_test(fits_and_tables_make_sheets),
		cmocka_unit_test(light_comes_from_names_maps_and_points),
		cmocka_unit_test(wrong_usage_is_refused),
		cmocka_unit_test(a_model_needs_no_measurement),
		cmocka_unit_test(one_bad_file_costs_only_itself),
		cmocka_unit_test(files_are_those_that_were_fitted),
		cmocka_unit_test(glass_is_shown_without_a_file),
		cmocka_unit_test(glass_takes_its_own_options),
		cmocka_unit_test(an_interrupt_leaves_no_picture),
	};
	return cmocka_run_group_tests(tests, set_up, leave_directory);
}
