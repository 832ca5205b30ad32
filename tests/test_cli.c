/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program itself: exit codes, both streams, bad input, batches, kill and resume. Runs $STDFIT or build/stdfit. */
#include "fit/cli/options.h"
#include "fit/cli/stack.h"
#include "run_program.h"
#include "src/energy.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>

enum { MERL_SIZE = 34992012 };

/* A fit that takes a moment: few free parameters, few entries. */
#define CHEAP "--ndf ggx,beckmann --sigma 0.2 --ior 1.5 --max-theta 20"
/* One that never ends by itself. */
#define ENDLESS "--ndf ggx --starts 100000"

/* A file of this header and size, whose other bytes are zero (and take no room). */
static void make_file(const char *path, const int32_t n[3], off_t size)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(n, sizeof *n, 3, file), 3);
	assert_int_equal(fflush(file), 0);
	assert_int_equal(ftruncate(fileno(file), size), 0);
	assert_int_equal(fclose(file), 0);
}

static void put_double(const char *path, long entry, double x)
{
	const int fd = open(path, O_WRONLY);
	assert_true(fd >= 0);
	assert_int_equal(pwrite(fd, &x, sizeof x, 12 + 8 * entry), sizeof x);
	assert_int_equal(close(fd), 0);
}

static void fill_minus_one(const char *path)
{
	static double ones[90 * 180];
	FILE *file = fopen(path, "r+b");
	assert_non_null(file);
	assert_int_equal(fseek(file, 12, SEEK_SET), 0);
	for (int i = 0; i < 90 * 180; i++)
		ones[i] = -1;
	for (int i = 0; i < 3 * 90; i++)
		assert_int_equal(fwrite(ones, sizeof ones, 1, file), 1);
	assert_int_equal(fclose(file), 0);
}

static const int32_t sound[3] = {90, 90, 180};

static int set_up(void **state)
{
	if (enter_directory(state))
		return -1;
	shell("exec \"$STDFIT\" synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5\n");
	if (last.code)
		return -1;
	shell("mkdir good bad mixed; for f in good/x good/y good/z mixed/a; do ln a.binary $f.binary; done;"
	      "echo text >mixed/README; head -c 1000 a.binary >mixed/short.binary; ln a.binary mixed/z.binary");
	return last.code;
}

static void help_and_version_are_printed(void **state)
{
	(void)state;
	static const char *const commands[] = {"fit", "compare", "eval", "info", "synth"};
	stdfit("--help");
	expect_code(0);
	assert_string_equal(last.err, "");
	char *overview = strdup(last.out);
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
		char arguments[32], usage[32];
		snprintf(arguments, sizeof arguments, "%s --help", commands[i]);
		snprintf(usage, sizeof usage, i ? "usage: stdfit %s" : "usage: stdfit [%s]", commands[i]);
		expect_part(overview, commands[i], __LINE__);
		stdfit(arguments);
		expect_code(0);
		assert_string_equal(last.err, "");
		assert_ptr_equal(strstr(last.out, usage), last.out);
	}
	free(overview);
	stdfit("fit --help");
	expect_out("(default: std,ggx,beckmann)");
	expect_out("(default: uncorrelated)");
	expect_out("(default: 90)");
	stdfit("--version");
	expect_code(0);
	expect_out("stdfit " STDFIT_VERSION);
	expect_out("nlopt");
	expect_out("GSL");
	expect_out("xxhash");
}

static void wrong_usage_is_refused(void **state)
{
	(void)state;
	static const struct {
		const char *arguments, *message;
	} wrong[] = {
		{"fit", "expected PATH"},
		{"compare", "expected PATH"},
		{"info", "expected PATH"},
		{"--nonsense a.binary", "'--nonsense'"},
		{"a.binary -z", "'-z'"},
		{"a.binary -o", "'-o'"},
		{"a.binary --ndf", "'--ndf'"},
		{"a.binary --quiet=yes", "'--quiet=yes'"},
		{"a.binary --ndf phong", "bad value 'phong' for --ndf: expected one of std, ggx, beckmann"},
		{"a.binary --ndf ggx,", "bad value 'ggx,' for --ndf"},
		{"a.binary --ndf ggx,ggx", "twice"},
		{"a.binary --ndf std --ndf ggx", "--ndf stands there twice"},
		{"compare a.binary -o x.csv --output y.csv", "--output stands there twice"},
		{"synth x.binary --kd 1 --kd=1", "--kd stands there twice"},
		{"a.binary --gaf none",
		 "bad value 'none' for --gaf: expected one of uncorrelated, correlated, v-groove"},
		{"a.binary --fresnel x", "for --fresnel"},
		{"a.binary --weight ''", "bad value '' for --weight"},
		{"a.binary --bins corner", "for --bins: expected one of node, centre"},
		{"a.binary --max-theta 90.5", "for --max-theta: expected a number from 1 to 90"},
		{"a.binary --max-theta 9O", "bad value '9O' for --max-theta"},
		{"a.binary --max-theta nan", "for --max-theta"},
		{"a.binary --max-theta ''", "for --max-theta"},
		{"a.binary --threads 0", "for --threads: expected a whole number from 1"},
		{"a.binary --threads 2.5", "for --threads"},
		{"a.binary --threads 99999999999999999999", "for --threads"},
		{"a.binary --seed -1", "for --seed"},
		{"a.binary --seed 3", "--seed means nothing without --starts"},
		{"compare a.binary --seed 3", "--seed means nothing without --starts"},
		{"a.binary --seed 18446744073709551616", "for --seed"},
		{"a.binary --ior 1", "for --ior"},
		{"a.binary --ior 1e400", "for --ior"},
		{"a.binary --gamma 1.5", "for --gamma"},
		{"a.binary --sigma -0.1", "for --sigma"},
		{"a.binary --within 5%%", "for --within"},
		{"a.binary --no-diffuse --no-specular", "leave nothing to fit"},
		{"a.binary --no-specular --sigma 0.1", "--sigma means nothing"},
		{"a.binary --no-specular --gaf correlated", "--gaf means nothing with --no-specular"},
		{"a.binary --no-specular --fresnel schlick", "--fresnel means nothing with --no-specular"},
		{"a.binary --no-specular --lambda 2f1", "--lambda means nothing with --no-specular"},
		{"a.binary --no-specular --starts 3", "--starts means nothing with --no-specular"},
		{"a.binary --ndf ggx,beckmann --lambda rational", "--lambda means nothing for these NDFs"},
		{"a.binary --gaf v-groove --lambda rational", "--lambda means nothing with --gaf v-groove"},
		{"a.binary --fresnel none --ior 1.5", "--ior means nothing"},
		{"a.binary --ndf ggx,beckmann --gamma 3", "--gamma means nothing"},
		{"a.binary --resume", "--resume needs -o"},
		{"a.binary --resume --json -o x.json", "--resume needs a CSV"},
		{"compare a.binary --resume", "'--resume'"},
		{"info a.binary --ndf ggx", "'--ndf'"},
		{"eval a.binary --weight none --kd 1", "'--weight'"},
		{"eval a.binary", "expected --kd or --ks"},
		{"eval a.binary good/x.binary --kd 1", "expected one FILE, found 2"},
		{"eval a.binary --ks 1", "--ks needs --sigma"},
		{"eval a.binary --ks 1 --sigma 0.1", "--ndf std needs --gamma"},
		{"eval a.binary --ks 1 --sigma 0.1 --ndf ggx --gamma 3", "--ndf ggx has no --gamma"},
		{"eval a.binary --kd 1 --lambda rational", "--lambda means nothing without --ks"},
		{"eval a.binary --ks 1 --sigma 0.1 --ndf ggx --lambda rational", "--lambda means nothing for"},
		{"eval a.binary --kd 1,2", "bad value '1,2' for --kd"},
		{"eval a.binary --kd 1,2,3,4", "for --kd"},
		{"eval a.binary --kd 1,,3", "for --kd"},
		{"eval a.binary --kd 1 --sigma 0.1", "--sigma means nothing without --ks"},
		{"eval a.binary --ks 1 --sigma 0.1 --ndf ggx --k 2", "--k means nothing"},
		{"eval a.binary --row 1 --kd 1", "--row means nothing"},
		{"eval a.binary --from x.csv --sigma 0.1", "--sigma and --from exclude each other"},
		{"synth x.binary --kd 1 --phi 90", "expected 180 or 360"},
		{"synth x.binary --kd 1 --seed 3", "--seed means nothing"},
		{"synth x.binary --kd 1 --noise -1", "for --noise"},
	};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		stdfit(wrong[i].arguments);
		expect_error(2, wrong[i].message);
		assert_string_equal(last.out, "");
	}
	assert_int_equal(access("x.binary", F_OK), -1);
}

/* One file through fit: exit code 1, one line that names it, and failed rows without numbers. */
static void expect_bad_file(const char *path, const char *message)
{
	char arguments[256];
	snprintf(arguments, sizeof arguments, "'%s' " CHEAP, path);
	stdfit(arguments);
	expect_error(1, message);
	expect_part(last.err, path, __LINE__);
	struct csv_table table = read_table("stdout");
	assert_int_equal(table.n_rows, 2);
	for (size_t i = 0; i < table.n_rows; i++) {
		assert_true(result_failed(table.row[i]));
		assert_string_equal(table.row[i][RESULT_ERROR], "");
		assert_string_equal(table.row[i][RESULT_SIGMA], "");
		assert_string_equal(table.row[i][RESULT_PATH], path);
	}
	csv_table_free(&table);
}

static void bad_files_are_refused(void **state)
{
	(void)state;
	/* What was typed and is not there costs no time and leaves no row. */
	stdfit("a.binary bad/missing.binary " CHEAP);
	expect_error(1, "cannot read 'bad/missing.binary': No such file or directory");
	assert_string_equal(last.out, "");
	stdfit("a.binary/under.binary " CHEAP);
	expect_error(1, "cannot read 'a.binary/under.binary': Not a directory");
	assert_string_equal(last.out, "");
	shell("ln -s nowhere bad/link.binary; ln -s round.binary bad/round.binary");
	stdfit("a.binary bad/link.binary " CHEAP);
	expect_error(1, "cannot read 'bad/link.binary': No such file or directory");
	assert_string_equal(last.out, "");
	stdfit("info bad/round.binary");
	expect_error(1, "cannot read 'bad/round.binary': Too many levels");
	assert_string_equal(last.out, "");
	make_file("bad/empty.binary", sound, 0);
	expect_bad_file("bad/empty.binary", "cannot read");
	make_file("bad/seven-bytes.binary", sound, 7);
	expect_bad_file("bad/seven-bytes.binary", "cannot read");
	make_file("bad/header.binary", sound, 12);
	expect_bad_file("bad/header.binary", "cannot read");
	make_file("bad/truncated.binary", sound, MERL_SIZE - 8);
	expect_bad_file("bad/truncated.binary", "34992012");
	make_file("bad/longer.binary", sound, MERL_SIZE + 1);
	expect_bad_file("bad/longer.binary", "34992012");
	make_file("bad/wrong.binary", (const int32_t[]){90, 180, 90}, MERL_SIZE);
	expect_bad_file("bad/wrong.binary", "cannot read");
	make_file("bad/negative.binary", (const int32_t[]){-90, -90, 180}, MERL_SIZE);
	expect_bad_file("bad/negative.binary", "cannot read");
	make_file("bad/huge.binary", (const int32_t[]){INT32_MAX, INT32_MAX, INT32_MAX}, MERL_SIZE);
	expect_bad_file("bad/huge.binary", "cannot read");
	make_file("bad/zero.binary", sound, MERL_SIZE);
	expect_bad_file("bad/zero.binary", "cannot fit");
	make_file("bad/invalid.binary", sound, MERL_SIZE);
	fill_minus_one("bad/invalid.binary");
	expect_bad_file("bad/invalid.binary", "cannot fit");
	shell("echo 'material,ndf,error' >bad/table.csv");
	expect_bad_file("bad/table.csv", "cannot read");
	if (geteuid() != 0) {
		make_file("bad/unreadable.binary", sound, MERL_SIZE);
		assert_int_equal(chmod("bad/unreadable.binary", 0), 0);
		expect_bad_file("bad/unreadable.binary", "Permission denied");
	}
	stdfit("eval good --kd 1");
	expect_error(1, "cannot read 'good'");
	stdfit("eval bad/zero.binary --kd 1");
	expect_error(1, "cannot compare with 'bad/zero.binary'");
	shell("mkdir empty; exec \"$STDFIT\" empty");
	expect_error(1, "cannot read 'empty'");
	stdfit("\"$(printf 'two\\nlines')\" --ndf ggx");
	expect_error(1, "two\\x0alines");
}

static void mistyped_words_name_the_nearest(void **state)
{
	(void)state;
	static const struct {
		const char *arguments, *message;
	} typed[] = {
		{"comprae a.binary", "there is no command or file 'comprae': did you mean stdfit compare?"},
		{"help comprae", "did you mean stdfit compare?"},
		{"-q compare a.binary", "there is no file 'compare', and a command comes first: stdfit compare ..."},
		{"fit a.binary --sgima 2", "unknown option '--sgima': did you mean --sigma?"},
		{"fit a.binary --n 2", "ambiguous option '--n': --ndf, --no-diffuse, --no-specular"},
		{"fit a.binary --xyzzy", "unknown option '--xyzzy' (see"},
		{"fit a.binary -y", "unknown option '-y' (see"},
		{"fit a.binary --ndf ggx,bekmann", "did you mean beckmann?"},
		{"fit a.binary --sigma 0,2", "a comma parts two numbers"},
		{"ndf ggx --sigma 0,2 --theta 10", "a comma parts two numbers"},
		{"ndf bekmann --theta 10 --sigma 1", "there is no NDF 'bekmann': did you mean beckmann?"},
	};
	for (size_t i = 0; i < sizeof typed / sizeof *typed; i++) {
		stdfit(typed[i].arguments);
		expect_error(2, typed[i].message);
		assert_string_equal(last.out, "");
	}
}

/* What a fit cannot use is said; -q leaves that out. */
static void left_out_samples_are_counted(void **state)
{
	(void)state;
	shell("printf "
	      "'theta_i,phi_i,theta_o,phi_o,value\\n10,0,20,180,.1\\n10,0,30,180,.2\\n40,0,50,180,.3\\n10,0,95,0,."
	      "1\\n10,0,20,0,-1"
	      "\\n' >samples.csv; \"$STDFIT\" samples.csv --ndf ggx --no-specular");
	expect_error(0, "'samples.csv': left out: 1 negative; 1 at or below the horizon");
	stdfit("samples.csv --ndf ggx --no-specular -q");
	expect_code(0);
	assert_string_equal(last.err, "");
}

/* Each has its answer on standard output; a bare call is wrong usage all the same. */
static void first_words_are_answered(void **state)
{
	(void)state;
	static const struct {
		const char *arguments, *answer;
		int code;
	} words[] = {{"", "stdfit compare", 2},
		     {"help", "stdfit compare", 0},
		     {"version", "stdfit 0.", 0},
		     {"-V", "stdfit 0.", 0},
		     {"eval --version", "stdfit 0.", 0},
		     {"eval -V", "stdfit 0.", 0},
		     {"help eval", "usage: stdfit eval", 0}};
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		stdfit(words[i].arguments);
		expect_code(words[i].code);
		expect_out(words[i].answer);
		assert_string_equal(last.err, "");
	}
	/* A file of that name is meant. */
	shell("cp a.binary help && exec \"$STDFIT\" help " CHEAP);
	expect_code(0);
	expect_out("material,ndf");
	assert_int_equal(unlink("help"), 0);
}

static void helps_fit_80_columns(void **state)
{
	(void)state;
	for (enum command c = 0; c <= COMMAND_COUNT; c++) {
		char arguments[64] = "--help";
		if (c < COMMAND_COUNT)
			snprintf(arguments, sizeof arguments, "%s --help", options_command(c)->name);
		stdfit(arguments);
		expect_code(0);
		for (char *line = strtok(last.out, "\n"); line; line = strtok(NULL, "\n"))
			if (strlen(line) > 80)
				fail_msg("%s: a line of %zu: %s", arguments, strlen(line), line);
	}
}

static void nan_and_inf_are_masked_and_counted(void **state)
{
	(void)state;
	shell("cp a.binary nan.binary");
	put_double("nan.binary", 5, NAN);
	put_double("nan.binary", 90 * 90 * 180 + 6, INFINITY);
	put_double("nan.binary", 2 * 90 * 90 * 180 + 7, -INFINITY);
	stdfit("info nan.binary --json");
	expect_code(0);
	expect_out("\"non_finite\": 3");
	expect_out("\"above_horizon\": 1111430");
	expect_out("\"valid_above_horizon\": 1111427");
	expect_out("non-finite: 3");
	stdfit("nan.binary " CHEAP);
	expect_code(0);
	struct csv_table table = read_table("stdout");
	assert_int_equal(table.n_rows, 2);
	check_between(result_number(table.row[0], RESULT_ERROR), 0, 0.01, "error beside three masked entries");
	csv_table_free(&table);
	stdfit("info a.binary --bins centre --json");
	expect_code(0);
	expect_out("\"above_horizon\": 1096216");
}

static void a_fit_reports_what_it_did(void **state)
{
	(void)state;
	stdfit("--max-theta 20 a.binary --sigma 0.2 --ior 1.5 --ndf ggx,beckmann -o one.csv");
	expect_code(0);
	assert_string_equal(last.out, "");
	assert_string_equal(last.err, "");
	struct csv_table table = read_table("one.csv");
	assert_int_equal(table.n_rows, 2);
	char *const *row = table.row[1];
	assert_string_equal(table.row[0][RESULT_NDF], "beckmann");
	assert_string_equal(table.row[0][RESULT_GAMMA], "inf");
	assert_string_equal(row[RESULT_MATERIAL], "a");
	assert_string_equal(row[RESULT_NDF], "ggx");
	assert_string_equal(row[RESULT_GAMMA], "2");
	assert_string_equal(row[RESULT_SIGMA], "0.2");
	assert_string_equal(row[RESULT_IOR], "1.5");
	assert_string_equal(row[RESULT_LAMBDA], "exact");
	assert_string_equal(row[RESULT_STATUS], "converged");
	assert_string_equal(row[RESULT_MAX_THETA], "20");
	assert_string_equal(row[RESULT_PATH], "a.binary");
	assert_string_equal(row[RESULT_VERSION], STDFIT_VERSION);
	assert_string_equal(row[RESULT_OPTIONS], "gaf=uncorrelated lambda=exact fresnel=dielectric weight=none "
						 "bins=node max-theta=20 unbounded=no no-diffuse=no "
						 "no-specular=no gray=no ior=1.5 gamma=free sigma=0.2 starts=0 seed=0");
	assert_int_equal(strlen(row[RESULT_INPUT]), strlen("34992012:") + 16);
	check_rel(result_number(row, RESULT_KD_R), 0.3, 1e-3, "kd_r");
	check_rel(result_number(row, RESULT_KD_B), 0.1, 1e-3, "kd_b");
	check_rel(result_number(row, RESULT_KS_G), 0.5, 1e-3, "ks_g");
	assert_string_equal(row[RESULT_ERROR], row[RESULT_ERROR_NONE]);
	char *error = strdup(row[RESULT_ERROR]), *metric = strdup(row[RESULT_LOG_ERROR]);
	csv_table_free(&table);

	/* The row's parameters give the row's errors, to the last digit. */
	stdfit("eval a.binary --from one.csv --ndf ggx");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 2);
	expect_out(error);
	expect_out(metric);
	stdfit("eval a.binary --from one.csv");
	assert_int_equal(count_lines(last.out), 3);
	stdfit("eval a.binary --from one.csv --row 3");
	expect_error(1, "'one.csv' has no such row");
	stdfit("eval good/x.binary --from one.csv");
	expect_error(1, "'one.csv' has no such row");
	free(error);
	free(metric);
	stdfit("eval a.binary --ndf ggx --sigma 0.2 --kd 0.3,0.2,0.1 --ks 0.5 --json");
	expect_code(0);
	expect_out("\"error_none\": ");
}

static void fits_print_JSON_and_tables(void **state)
{
	(void)state;
	stdfit("a.binary " CHEAP " --json");
	expect_code(0);
	assert_int_equal(last.out[0], '[');
	expect_out("\"gamma\": \"inf\"");
	expect_out("\"params\": null");
	stdfit("a.binary " CHEAP " --table -o table.csv");
	expect_code(0);
	assert_ptr_equal(strstr(last.out, "material "), last.out);
	assert_int_equal(count_lines(last.out), 3);
	struct csv_table table = read_table("table.csv");
	assert_int_equal(table.n_rows, 2);
	csv_table_free(&table);
}

static void a_batch_survives_a_bad_file(void **state)
{
	(void)state;
	stdfit("mixed " CHEAP " -o mixed.csv");
	expect_error(1, "mixed/short.binary");
	struct csv_table table = read_table("mixed.csv");
	assert_int_equal(table.n_rows, 6);
	static const char *const materials[] = {"a", "a", "short", "short", "z", "z"};
	for (size_t i = 0; i < table.n_rows; i++) {
		assert_string_equal(table.row[i][RESULT_MATERIAL], materials[i]);
		assert_string_equal(table.row[i][RESULT_NDF], i % 2 ? "ggx" : "beckmann");
		assert_true(result_failed(table.row[i]) == (i / 2 == 1));
	}
	csv_table_free(&table);
	/* Once given, once found in the directory, once more given: one fit. */
	stdfit("mixed/a.binary mixed mixed/a.binary " CHEAP);
	expect_code(1);
	table = read_table("stdout");
	assert_int_equal(table.n_rows, 6);
	csv_table_free(&table);
}

static void directories_below_are_searched_if_asked(void **state)
{
	(void)state;
	shell("mkdir -p tree/b/c tree/.hidden; ln a.binary tree/b/c/deep.binary; ln a.binary tree/.hidden/x.binary;"
	      "ln -s .. tree/b/up; ln a.binary tree/.x.binary; ln a.binary tree/top.binary");
	stdfit("tree " CHEAP);
	expect_code(0);
	struct csv_table table = read_table("stdout");
	assert_int_equal(table.n_rows, 2);
	assert_string_equal(table.row[0][RESULT_PATH], "tree/top.binary");
	csv_table_free(&table);
	/* Where there is nothing but below, -r is mentioned; capitals count. */
	shell("mkdir upper; ln a.binary upper/A.BINARY");
	stdfit("tree/b " CHEAP);
	expect_error(1, "-r takes those in the directories below");
	shell("mkdir -p hollow/x; exec \"$STDFIT\" hollow");
	expect_error(1, "no measurement of a known format in this directory\n");
	stdfit("upper --ndf ggx --no-specular");
	expect_code(0);
	table = read_table("stdout");
	assert_string_equal(table.row[0][RESULT_MATERIAL], "A");
	csv_table_free(&table);
	stdfit("-r tree/ " CHEAP);
	expect_code(0);
	table = read_table("stdout");
	assert_int_equal(table.n_rows, 4);
	assert_string_equal(table.row[0][RESULT_PATH], "tree/b/c/deep.binary");
	csv_table_free(&table);
}

static void threads_change_nothing(void **state)
{
	(void)state;
	char *first = NULL;
	for (int threads = 1; threads <= 3; threads++) {
		char arguments[160];
		snprintf(arguments, sizeof arguments, "mixed a.binary " CHEAP " --threads %d", threads);
		stdfit(arguments);
		expect_error(1, "short.binary");
		char *text = without_seconds("stdout");
		if (first)
			assert_string_equal(text, first);
		else
			first = strdup(text);
		free(text);
		snprintf(arguments, sizeof arguments, "a.binary " CHEAP " --threads %d", threads);
		stdfit(arguments);
		text = without_seconds("stdout");
		if (!strstr(first, text))
			fail_msg("%d threads, alone: %s\nin a batch: %s", threads, text, first);
		free(text);
	}
	free(first);
}

static void a_killed_batch_resumes_to_the_same_table(void **state)
{
	(void)state;
	stdfit("good " CHEAP " -o whole.csv");
	expect_code(0);
	char *whole = without_seconds("whole.csv");
	const pid_t pid = start("exec \"$STDFIT\" good " CHEAP " --threads 1 -o cut.csv 2>/dev/null");
	wait_for_lines("cut.csv", 2);
	kill(pid, SIGKILL);
	end(pid);
	char *before = slurp("cut.csv");
	assert_true(count_lines(before) >= 2);
	/* Each line that is whole is a row; whatever stands behind the last of them goes. */
	FILE *file = fopen("cut.csv", "ab");
	assert_non_null(file);
	fputs("y,ggx,0.1,\"torn\nin the mid", file);
	assert_int_equal(fclose(file), 0);
	stdfit("good " CHEAP " --resume -o cut.csv");
	expect_code(0);
	assert_string_equal(last.err, "");
	char *after = slurp("cut.csv"), *resumed = without_seconds("cut.csv");
	assert_string_equal(resumed, whole);
	/* What was there, `seconds` included, is there still: it was not made again. */
	char *line = strtok(before, "\n");
	for (size_t i = 0; line && i < 2; i++, line = strtok(NULL, "\n"))
		expect_part(after, line, __LINE__);
	free(before);
	free(after);
	free(resumed);
	free(whole);
}

static void resume_redoes_what_differs(void **state)
{
	(void)state;
	shell("mkdir again; ln a.binary again/p.binary; ln a.binary again/q.binary; ln mixed/short.binary "
	      "again/s.binary");
	stdfit("again " CHEAP " -o again.csv");
	expect_code(1);
	/* The bad file is a good one now, another holds other bytes, a third is gone from the command line. */
	shell("ln -f a.binary again/s.binary; cp a.binary again/q2; mv again/q2 again/q.binary");
	put_double("again/q.binary", 5, -1);
	struct csv_table old = read_table("again.csv");
	stdfit("again/s.binary again/q.binary " CHEAP " --resume -o again.csv");
	expect_code(0);
	struct csv_table new = read_table("again.csv");
	assert_int_equal(new.n_rows, 6);
	for (size_t i = 0; i < 6; i++) {
		assert_false(result_failed(new.row[i]));
		assert_string_equal(new.row[i][RESULT_PATH], old.row[i][RESULT_PATH]);
	}
	assert_string_equal(new.row[0][RESULT_SECONDS], old.row[0][RESULT_SECONDS]);
	assert_string_not_equal(new.row[2][RESULT_INPUT], old.row[2][RESULT_INPUT]);
	csv_table_free(&old);
	csv_table_free(&new);
	/* Other options: made again. */
	stdfit("again " CHEAP " --gray --resume -o again.csv");
	expect_code(0);
	new = read_table("again.csv");
	assert_int_equal(new.n_rows, 6);
	for (size_t i = 0; i < 6; i++)
		expect_part(new.row[i][RESULT_OPTIONS], "gray=yes", __LINE__);
	csv_table_free(&new);
	/* What was replaced is not lost. */
	old = read_table("again.csv~");
	assert_int_equal(old.n_rows, 12);
	csv_table_free(&old);
	/* Another file than a result table stays as it is. */
	shell("echo 'dear diary' >diary.csv");
	stdfit("again " CHEAP " --resume -o diary.csv");
	expect_error(1, "cannot resume 'diary.csv'");
	char *diary = slurp("diary.csv");
	assert_string_equal(diary, "dear diary\n");
	free(diary);
	/* Without --resume it moves out of the way. */
	stdfit("a.binary " CHEAP " -o diary.csv");
	expect_code(0);
	diary = slurp("diary.csv~");
	assert_string_equal(diary, "dear diary\n");
	free(diary);
}

/* A cell that a model needs is missing, or holds what no model has: no number is made up for it. */
static void rows_that_are_no_models_are_refused(void **state)
{
	static const struct {
		int column;
		const char *value, *name;
	} bad[] = {{10, "", "sigma"},    {10, "1e300", "sigma"}, {10, "1e-300", "sigma"}, {11, "", "gamma"},
		   {11, "1.5", "gamma"}, {12, "", "ior"},        {12, "0", "ior"},        {5, "", "kd_g"},
		   {8, "", "ks_g"},      {4, "1e300", "kd_r"}};

	(void)state;
	stdfit("a.binary --ndf std --sigma 0.2 --ior 1.5 --max-theta 20 -o whole.csv");
	expect_code(0);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		char command[160], part[96];
		snprintf(command, sizeof command, "awk -F, -v OFS=, 'NR == 2 { $%d = \"%s\" } 1' whole.csv >bad.csv",
			 bad[i].column, bad[i].value);
		shell(command);
		stdfit("eval a.binary --from bad.csv");
		snprintf(part, sizeof part, "'bad.csv' row 1: the row's column %s does not describe a model: '%s'",
			 bad[i].name, bad[i].value);
		expect_error(1, part);
	}
}

/* A table without the latest columns gives models, but takes no rows. */
static void older_tables_are_taken(void **state)
{
	(void)state;
	stdfit("a.binary " CHEAP " -o newer.csv");
	expect_code(0);
	shell("cut -d, -f1-36 newer.csv >older.csv; cp older.csv older.copy");
	stdfit("eval a.binary --from older.csv --ndf ggx");
	expect_code(0);
	stdfit("compare older.csv");
	expect_code(0);
	stdfit("a.binary " CHEAP " --resume -o older.csv");
	expect_error(1, "cannot resume 'older.csv': expected the columns of stdfit " STDFIT_VERSION);
	shell("cmp older.csv older.copy && ! test -e older.csv~");
}

static void the_energy_is_accounted_for(void **state)
{
	struct cook_torrance model;
	struct fit_options fit;
	struct error error;
	struct pwl *pwl;
	double albedo[3], theta_i;
	(void)state;
	stdfit("a.binary " CHEAP " -o energy.csv");
	expect_code(0);
	struct csv_table table = read_table("energy.csv");
	for (size_t i = 0; i < table.n_rows; i++) {
		assert_int_equal(result_model(table.row[i], &model, &fit, &pwl, &error), STATUS_OK);
		assert_int_equal(energy_albedo_max(&model, albedo, &theta_i), STATUS_OK);
		for (int c = 0; c < 3; c++)
			check_rel(result_number(table.row[i], RESULT_ALBEDO_R + (enum result_column)c), albedo[c],
				  1e-12, "albedo");
		assert_string_equal(table.row[i][RESULT_ENERGY], "ok");
		/* Grazing light finds F = 1 and G = 1. */
		check_between(albedo[0], model.kd[0], 1, "albedo_r");
	}
	csv_table_free(&table);
	/* Lambert's term and a lossless lobe: kd + ks at most, and, since kd is 0.9, more than 1. */
	stdfit("synth bright.binary --ndf ggx --sigma 0.2 --fresnel none --kd 0.9 --ks 0.8,0.8,0.05");
	expect_code(0);
	stdfit("bright.binary --ndf ggx --sigma 0.2 --fresnel none --max-theta 40 --table -o bright.csv");
	expect_code(0);
	expect_out("(sends back more light than it gets)");
	table = read_table("bright.csv");
	assert_string_equal(table.row[0][RESULT_ENERGY], "gain");
	check_between(result_number(table.row[0], RESULT_ALBEDO_R), 1.6, 1.701, "bright red");
	check_between(result_number(table.row[0], RESULT_ALBEDO_B), 0.9, 0.951, "bright blue");
	csv_table_free(&table);
	stdfit("eval bright.binary --kd 0.9 --ks 0.8,0.8,0.05 --ndf ggx --sigma 0.2 --fresnel none --table");
	expect_code(0);
	expect_out("energy               gain");
	expect_out("furnace              0.9");
	stdfit("eval bright.binary --kd 0.25");
	expect_code(0);
	expect_out(",0.25,0.25,0.25,");
	expect_out(",ok\n");
}

/* Interrupts a batch whose first file fails at once and whose second one takes for ever. */
static void interrupt(int number)
{
	unlink("stopped.csv");
	const pid_t pid =
		start("exec \"$STDFIT\" mixed/short.binary a.binary " ENDLESS " --threads 1 -o stopped.csv 2>stderr");
	wait_for_lines("stopped.csv", 2);
	kill(pid, number);
	assert_int_equal(end(pid), 130);
	struct csv_table table = read_table("stopped.csv");
	assert_int_equal(table.n_rows, 1);
	assert_string_equal(table.row[0][RESULT_MATERIAL], "short");
	csv_table_free(&table);
	/* One on the short file, one on how to go on. */
	char *err = slurp("stderr");
	assert_int_equal(count_lines(err), 2);
	expect_part(err, "stdfit: interrupted: the same command with --resume goes on\n", __LINE__);
	free(err);
}

static void an_interrupt_keeps_what_is_done(void **state)
{
	(void)state;
	interrupt(SIGINT);
	interrupt(SIGTERM);
}

static void outputs_that_cannot_be_written_are_reported(void **state)
{
	(void)state;
	stdfit("a.binary " CHEAP " -o /nowhere/x.csv");
	expect_error(1, "cannot write '/nowhere/x.csv'");
	stdfit("a.binary " CHEAP " -o good");
	expect_error(1, "cannot write 'good': Is a directory");
	stdfit("a.binary " CHEAP " -o /dev/full");
	expect_error(1, "cannot write '/dev/full': No space left on device");
	stdfit("a.binary " CHEAP " --json -o /dev/full");
	expect_error(1, "No space left on device");
	stdfit("a.binary " CHEAP " >/dev/full");
	expect_error(1, "cannot write standard output: No space left on device");
	stdfit("--help >/dev/full");
	expect_error(1, "cannot write standard output");
	stdfit("info a.binary >&-");
	expect_error(1, "cannot write standard output");
	stdfit("a.binary " CHEAP " >&-");
	expect_error(1, "cannot write standard output");
	stdfit("a.binary " CHEAP " -o closed.csv >&- 2>stderr <&-");
	expect_code(0);
	struct csv_table table = read_table("closed.csv");
	assert_int_equal(table.n_rows, 2);
	csv_table_free(&table);
	stdfit("synth /nowhere/x.binary --kd 1");
	expect_error(1, "cannot write '/nowhere/x.binary'");
	/* Told before anything is fitted: not a word on the input. */
	stdfit("compare bad/empty.binary " CHEAP " -o /nowhere/x.csv");
	expect_error(1, "cannot write '/nowhere/x.csv'");
	stdfit("bad/empty.binary " CHEAP " --json -o /nowhere/x.json");
	expect_error(1, "cannot write '/nowhere/x.json'");
	if (THREAD_SANITIZER)
		return;
	shell("ulimit -f 1; exec \"$STDFIT\" synth limit.binary --kd 1");
	expect_error(1, "cannot write 'limit.binary': File too large");
	assert_int_equal(access("limit.binary", F_OK), -1);
}

static void a_reader_that_is_gone_ends_it_quietly(void **state)
{
	(void)state;
	int ends[2];
	assert_int_equal(pipe(ends), 0);
	assert_int_equal(close(ends[0]), 0);
	const pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0) {
		dup2(ends[1], STDOUT_FILENO);
		close(ends[1]);
		execl("/bin/sh", "sh", "-c", "exec \"$STDFIT\" fit a.binary " CHEAP " 2>stderr", (char *)NULL);
		_exit(127);
	}
	close(ends[1]);
	assert_int_equal(end(pid), 1);
	char *err = slurp("stderr");
	assert_string_equal(err, "");
	free(err);
}

/* head has seen enough: nobody is told, whatever the command. */
static void output_into_head_ends_silently(void **state)
{
	(void)state;
	static const char *const commands[] = {("a.binary a.binary " CHEAP), "ndf ggx --sigma 0.1 --theta 0:90:0.01",
					       "--help", "sample ggx --sigma 0.1 --count 20000"};
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
		char *whole;
		assert_true(asprintf(&whole, "{ \"$STDFIT\" %s; } 2>told | head -n 1 >first; cat told", commands[i]) >
			    0);
		shell(whole);
		expect_code(0);
		assert_string_equal(last.out, "");
		free(whole);
	}
}

static void compare_summarises_tables(void **state)
{
	(void)state;
	write_text("four.csv", "ndf,material,error,options,extra\n"
			       "std,a,0.125,o,1\nggx,a,0.25,o,1\nbeckmann,a,0.625,o,1\n"
			       "std,b,0.375,o,1\nggx,b,0.375,o,1\nbeckmann,b,0.75,o,1\n"
			       "std,\"c,d\",0.25,o,1\nbeckmann,\"c,d\",0.125,o,1\n"
			       "ggx,e,,o,1\n");
	stdfit("compare four.csv");
	expect_code(0);
	assert_string_equal(last.out,
			    "material,error_std,error_ggx,error_beckmann,winner,gain_over_ggx,gain_over_beckmann\n"
			    "a,0.125,0.25,0.625,std,50,80\n"
			    "b,0.375,0.375,0.75,tie,0,50\n"
			    "\"c,d\",0.25,,0.125,beckmann,,-100\n"
			    "e,,,,,,\n"
			    "(mean),0.25,0.3125,0.5,,25,10\n"
			    "(median),0.25,0.3125,0.625,,25,50\n"
			    "(worst),0.375,0.375,0.75,,0,-100\n"
			    "(wins),1,0,1,1 tie,,\n");
	stdfit("compare four.csv --ndf ggx");
	expect_error(2, "--ndf means nothing");
	stdfit("compare four.csv --threads 2");
	expect_error(2, "--threads means nothing");
	stdfit("compare a.binary four.csv");
	expect_error(2, "expected one table");
	/* An older output moves out of the way, were it no table at all; the input does not. */
	shell("cp four.csv five.csv; echo old >six.csv; \"$STDFIT\" compare four.csv -o six.csv && cat six.csv~");
	expect_code(0);
	assert_string_equal(last.out, "old\n");
	stdfit("compare five.csv -o five.csv");
	expect_error(2, "--output names a file that is to be read");
	shell("cmp four.csv five.csv && ! test -e five.csv~");
	expect_code(0);
	write_text("mixed-options.csv", "material,ndf,error,options\na,std,0.1,weight=none\na,ggx,0.2,weight=cosine\n");
	stdfit("compare mixed-options.csv");
	expect_error(1, "row 2: made with other options");
	write_text("broken.csv", "material,ndf,error\na,std\n");
	stdfit("compare broken.csv");
	expect_error(1, "'broken.csv' line 2: expected 3 fields, found 2");
	/* Where nothing could be fitted there is a line on it and no table; one file beside others is an empty line of theirs. */
	write_text("failed.csv", "material,ndf,error,options,status\na,std,,o,failed: so it was\n");
	stdfit("compare failed.csv");
	expect_error(1, "'failed.csv' has no fits to compare");
	assert_string_equal(last.out, "");
	stdfit("compare bad/empty.binary " CHEAP " -o nothing.csv");
	expect_error(1, "cannot read 'bad/empty.binary'");
	assert_string_equal(last.out, "");
	assert_int_equal(access("nothing.csv", F_OK), -1);
	stdfit("compare a.binary bad/empty.binary " CHEAP);
	expect_error(1, "cannot read 'bad/empty.binary'");
	expect_out("\nempty,,,,,\n");
	stdfit("compare a.binary " CHEAP);
	expect_code(0);
	expect_out("material,error_ggx,error_beckmann,winner,gain_over_ggx,gain_over_beckmann\na,");
	expect_out(",ggx,,\n(mean)");
}

/* A fit under each weight, a row each, the same as alone; the rows of one weight are never taken for those of another. */
static void weights_stand_side_by_side(void **state)
{
	(void)state;
	shell("\"$STDFIT\" synth w.binary --ndf ggx --sigma 0.2 --kd 0.3 --ks 0.5 --noise 0.3; for w in none "
	      "solid-angle; do "
	      "\"$STDFIT\" w.binary " CHEAP " --weight $w -o w-$w.csv; done; exec \"$STDFIT\" w.binary " CHEAP
	      " --weight none,solid-angle -o both.csv");
	expect_code(0);
	shell("\"$STDFIT\" merge w-none.csv w-solid-angle.csv -o joined.csv");
	expect_code(0);
	char *both = without_seconds("both.csv"), *joined = without_seconds("joined.csv");
	assert_string_equal(both, joined);
	free(joined);
	assert_int_equal(count_lines(both), 4);
	assert_non_null(strstr(both, ",solid-angle,"));
	/* Resumed: nothing is made again; only what is missing; and what is asked for no more goes. */
	shell("cp both.csv again.csv; \"$STDFIT\" w.binary " CHEAP
	      " --weight none,solid-angle -o again.csv --resume && cmp both.csv "
	      "again.csv && grep -F weight=none both.csv >kept; { head -n 1 both.csv; cat kept; } >half.csv; "
	      "\"$STDFIT\" w.binary " CHEAP
	      " --weight solid-angle,none -o half.csv --resume && grep -xFf kept half.csv | wc -l");
	expect_code(0);
	assert_int_equal(atoi(last.out), 2);
	char *half = without_seconds("half.csv");
	assert_string_equal(half, both);
	free(half);
	free(both);
	shell("exec \"$STDFIT\" w.binary " CHEAP " --weight solid-angle -o half.csv --resume -q");
	expect_code(0);
	char *one = without_seconds("half.csv"), *alone = without_seconds("w-solid-angle.csv");
	assert_string_equal(one, alone);
	free(one);
	free(alone);
	/* compare has a line and a summary for each; a share of one weight is told from one of both. */
	stdfit("compare both.csv");
	expect_code(0);
	expect_out("material,weight,error_");
	expect_out("\nw,none,");
	expect_out("\n(wins),none,");
	expect_out("\nw,solid-angle,");
	expect_out("\n(wins),solid-angle,");
	assert_int_equal(count_lines(last.out), 11);
	stdfit("compare w-none.csv");
	expect_out("material,error_");
	shell("sed 's/w[.]binary/v.binary/g' w-none.csv >share.csv; exec \"$STDFIT\" merge both.csv share.csv");
	expect_error(1, "another --ndf or --weight");
	/* Rows are picked by their weight; an export's weight is that of a substitute. */
	stdfit("export w.binary --from both.csv --ndf ggx --format json");
	expect_error(1, "choose one with --ndf or --row");
	stdfit("export w.binary --from both.csv --ndf ggx --weight solid-angle --format json");
	expect_error(2, "--format json has every model");
	stdfit("render w.binary --from both.csv --ndf ggx --weight solid-angle --size 16 --samples 4");
	expect_code(0);
	expect_out("\nw,ggx,solid-angle,");
	stdfit("render w.binary --from both.csv --ndf ggx --row 1 --weight none --size 16 --samples 4");
	expect_error(2, "exclude each other");
	stdfit("w.binary " CHEAP " --weight none,cosine --table");
	expect_out("beckmann  cosine ");
	stdfit("w.binary --weight none,none");
	expect_error(2, "'none' stands there twice");
	stdfit("w.binary --weight none,cosine --trace t.csv");
	expect_error(2, "--trace takes one --weight");
}

/* The row is that of the nodes; the other fit is told to the last digit, and what is certain besides. */
static void how_certain_a_fit_is_stands_in_its_row(void **state)
{
	static const enum result_column told[] = {RESULT_ERROR, RESULT_KD_R, RESULT_KS_B, RESULT_SIGMA};
	double value;
	(void)state;
	shell("\"$STDFIT\" synth c.binary --ndf ggx --sigma 0.2 --kd 0.3 --ks 0.5 --noise 0.1; for b in node centre "
	      "both; do "
	      "\"$STDFIT\" c.binary --ndf ggx --ior 1.5 --max-theta 20 -q --bins $b --intervals 5% -o c-$b.csv; done");
	expect_code(0);
	struct csv_table node = read_table("c-node.csv"), centre = read_table("c-centre.csv"),
			 both = read_table("c-both.csv");
	char *const *row = both.row[0];
	assert_string_equal(node.row[0][RESULT_OTHER_BINS], "");
	for (enum result_column c = 0; c < RESULT_COLUMNS; c++)
		if (c != RESULT_SECONDS && c != RESULT_EVALUATIONS && c != RESULT_OPTIONS && c != RESULT_OTHER_BINS)
			assert_string_equal(row[c], node.row[0][c]);
	for (size_t t = 0; t < sizeof told / sizeof *told; t++) {
		assert_true(result_param(row[RESULT_OTHER_BINS], result_columns[told[t]].name, &value));
		assert_true(value == result_number(centre.row[0], told[t]));
		assert_true(value != result_number(row, told[t]));
	}
	assert_true(result_number(row, RESULT_SIGMA_LO) < result_number(row, RESULT_SIGMA));
	assert_true(result_number(row, RESULT_SIGMA_HI) > result_number(row, RESULT_SIGMA));
	assert_string_equal(row[RESULT_IOR_LO], "");
	assert_non_null(strstr(row[RESULT_OPTIONS], " bins=both "));
	csv_table_free(&node);
	csv_table_free(&centre);
	csv_table_free(&both);
	stdfit("c.binary --ndf ggx --ior 1.5 --max-theta 20 -q --bins both --intervals 5% --table");
	expect_out("\n    sigma 0.1");
	expect_out("\n    at bin centres E 0.");
	expect_out(", sigma +");
	stdfit("c.binary --bins nodes");
	expect_error(2, "node, centre, both");
	stdfit("compare c.binary --bins both");
	expect_error(2, "node, centre");
	stdfit("c.binary --no-specular --intervals 1%");
	expect_error(2, "--intervals means nothing with --no-specular");
}

static void within_takes_the_simplest(void **state)
{
	(void)state;
	/* A gray Lambert surface needs one parameter, whatever else the whole model does to the noise. */
	stdfit("synth gray.binary --kd 0.4 --noise 0.02");
	expect_code(0);
	stdfit("gray.binary --ndf ggx --sigma 0.3 --ior 1.5 --max-theta 20 --within 1%");
	expect_code(0);
	struct csv_table table = read_table("stdout");
	assert_int_equal(table.n_rows, 1);
	assert_string_equal(table.row[0][RESULT_KS_R], "");
	assert_string_equal(table.row[0][RESULT_SIGMA], "");
	check_rel(result_number(table.row[0], RESULT_KD_R), 0.4, 1e-3, "kd_r");
	assert_string_equal(table.row[0][RESULT_KD_R], table.row[0][RESULT_KD_B]);
	expect_part(table.row[0][RESULT_OPTIONS], "within=1 chosen=gray+no-specular", __LINE__);
	csv_table_free(&table);
	/* What was chosen is no other request: the row is kept. */
	shell("\"$STDFIT\" gray.binary --ndf ggx --sigma 0.3 --ior 1.5 --max-theta 20 --within 1% -q -o w.csv && cp "
	      "w.csv v.csv &&"
	      " \"$STDFIT\" gray.binary --ndf ggx --sigma 0.3 --ior 1.5 --max-theta 20 --within 1% -q --resume -o "
	      "w.csv && cmp w.csv v.csv");
	expect_code(0);
	/* A coloured plastic has one ks. */
	stdfit("synth plastic.binary --ndf ggx --sigma 0.3 --ior 1.5 --kd 0.4,0.1,0.05 --ks 0.6 --noise 0.05");
	expect_code(0);
	stdfit("plastic.binary --ndf ggx --sigma 0.3 --ior 1.5 --max-theta 20 --within 0.5%");
	expect_code(0);
	table = read_table("stdout");
	assert_int_equal(table.n_rows, 1);
	expect_part(table.row[0][RESULT_OPTIONS], "chosen=gray-specular", __LINE__);
	check_rel(result_number(table.row[0], RESULT_KD_R), 0.4, 1e-2, "kd_r");
	check_rel(result_number(table.row[0], RESULT_KD_B), 0.05, 1e-2, "kd_b");
	check_rel(result_number(table.row[0], RESULT_KS_G), 0.6, 2e-2, "ks_g");
	assert_string_equal(table.row[0][RESULT_KS_R], table.row[0][RESULT_KS_B]);
	csv_table_free(&table);
	stdfit("a.binary " CHEAP " --within 1%");
	expect_code(0);
	table = read_table("stdout");
	assert_int_equal(table.n_rows, 1);
	assert_string_equal(table.row[0][RESULT_NDF], "ggx");
	check_rel(result_number(table.row[0], RESULT_KD_B), 0.1, 1e-2, "kd_b");
	csv_table_free(&table);
}

/* Zeros at theta_d of 20 to 49 degrees of the rows 30 to 44 of theta_h. */
static void dig_a_hole(const char *path)
{
	static const double zeros[30 * 180];
	const int fd = open(path, O_WRONLY);
	assert_true(fd >= 0);
	for (int c = 0; c < 3; c++)
		for (int i = 30; i < 45; i++)
			assert_int_equal(pwrite(fd, zeros, sizeof zeros, 12 + 8L * 180 * ((c * 90 + i) * 90 + 20)),
					 sizeof zeros);
	assert_int_equal(close(fd), 0);
}

static void faults_of_the_data_are_told(void **state)
{
	(void)state;
	shell("mkdir holes; cp a.binary holes/h.binary");
	dig_a_hole("holes/h.binary");
	stdfit("info holes/h.binary a.binary --json");
	expect_code(0);
	expect_out("exact zeros beside bright values: --zero-is-missing leaves them out");
	expect_out("\"suspects\": null");
	expect_out("\"measured_0\": 1,");
	stdfit("holes/h.binary a.binary --ndf ggx --no-specular -o holes.csv");
	expect_code(0);
	expect_part(last.err, "stdfit: 'holes/h.binary' looks wrong: ", __LINE__);
	expect_part(last.err, "--zero-is-missing", __LINE__);
	assert_null(strstr(last.err, "a.binary'"));
	struct csv_table table = read_table("holes.csv");
	assert_string_equal(table.row[0][RESULT_SUSPECTS], "");
	assert_string_equal(table.row[1][RESULT_SUSPECTS], "zeros");
	csv_table_free(&table);
	/* The row says that zeros were left out: so resume, merge, compare and eval know. */
	stdfit("holes/h.binary a.binary --ndf ggx --no-specular --zero-is-missing --resume -o holes.csv");
	expect_code(0);
	assert_string_equal(last.err, "");
	table = read_table("holes.csv");
	expect_part(table.row[1][RESULT_OPTIONS], " max-theta=90 zero-is-missing=yes unbounded=no", __LINE__);
	assert_string_equal(table.row[1][RESULT_SUSPECTS], "");
	assert_true(result_number(table.row[1], RESULT_SAMPLES) < result_number(table.row[0], RESULT_SAMPLES));
	char *error = strdup(table.row[1][RESULT_ERROR_COSINE]);
	csv_table_free(&table);
	stdfit("eval holes/h.binary --from holes.csv");
	expect_out(error);
	free(error);
	shell("mv holes.csv~ before.csv");
	stdfit("merge holes.csv before.csv -o all.csv");
	expect_error(1, "zero-is-missing");
}

static void another_G_is_told(void **state)
{
	static const char *const truth[] = {"uncorrelated", "correlated"};

	(void)state;
	for (int n = 0; n < 2; n++) {
		char arguments[256];

		snprintf(arguments, sizeof arguments,
			 "synth g.binary --kd 0.1 --ks 0.3 --ndf ggx --sigma 0.3 --ior 1.6 --noise 0.1 --gaf %s",
			 truth[n]);
		stdfit(arguments);
		expect_code(0);
		stdfit("g.binary --ndf ggx -o g.csv");
		expect_code(0);
		struct csv_table table = read_table("g.csv");
		assert_string_equal(table.row[0][RESULT_SUSPECTS], n ? "correlated" : "");
		assert_true(n == (strstr(last.err, "--gaf correlated") != NULL));
		csv_table_free(&table);
	}
}

static void small_stacks_are_made_larger_or_told(void **state)
{
	static const struct {
		const char *text;
		size_t bytes; /* 0: no size */
	} sizes[] = {{"16k", 16384},
		     {" 16 K ", 16384},
		     {"16", 16384},
		     {"1024B", 1024},
		     {"2M", 2 << 20},
		     {"1g", 1 << 30},
		     {"", 0},
		     {"k", 0},
		     {"-1", 0},
		     {"1kk", 0},
		     {"1x", 0},
		     {"1 2", 0},
		     {"99999999999999999999", 0},
		     {"99999999999G", 0}};
	(void)state;
	for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
		size_t bytes = 0;
		assert_int_equal(stack_parse_size(sizes[s].text, &bytes), sizes[s].bytes > 0);
		assert_int_equal(bytes, sizes[s].bytes);
	}
	shell("ulimit -S -s 128; exec \"$STDFIT\" a.binary --threads 2 -q " CHEAP);
	expect_code(0);
	shell("ulimit -s 128; exec \"$STDFIT\" a.binary --threads 2 -q " CHEAP);
	expect_error(1, "the stack may not grow beyond 128 kB: expected 256 or more (ulimit -s)");
	shell("OMP_STACKSIZE=16k exec \"$STDFIT\" a.binary --threads 2 -q " CHEAP);
	expect_error(1, "OMP_STACKSIZE=16k is too small: expected 256K or more, or none");
	shell("OMP_NUM_THREADS=99999 exec \"$STDFIT\" eval a.binary --kd 0.5");
	expect_code(0);
	stdfit("a.binary --threads 99999");
	expect_error(2, "bad value '99999' for --threads: expected a whole number from 1 to 1024");
}

/* Cells of a table that would colour the terminal, ring its bell or turn the order of letters round. */
#define EVIL                                                                                                           \
	"\x1b[31m\xe2\x80\xae"                                                                                         \
	"evil\xe2\x81\xa6\x07\xc2\x9b"

static void expect_tame(const char *text, int line)
{
	static const char *const evil[] = {"\x1b", "\xe2\x80\xae", "\xe2\x81\xa6", "\x07", "\xc2\x9b"};
	for (size_t e = 0; e < sizeof evil / sizeof *evil; e++)
		if (strstr(text, evil[e]))
			fail_msg("line %d: control characters in: %s", line, text);
}

static void cells_leave_the_terminal_alone(void **state)
{
	static const enum result_column evil[] = {RESULT_MATERIAL, RESULT_NDF, RESULT_AT_BOUND, RESULT_OPTIONS};
	(void)state;
	stdfit("a.binary --ndf ggx --no-specular -q -o tame.csv");
	expect_code(0);
	for (size_t e = 0; e < sizeof evil / sizeof *evil; e++) {
		struct csv_table table = read_table("tame.csv");
		char *cells[RESULT_COLUMNS];
		memcpy(cells, table.row[0], sizeof cells);
		cells[evil[e]] = EVIL;
		FILE *file = fopen("evil.csv", "w");
		assert_non_null(file);
		csv_write_header(file, result_columns, RESULT_COLUMNS);
		csv_write_row(file, cells, RESULT_COLUMNS);
		assert_int_equal(fclose(file), 0);
		csv_table_free(&table);
		static const char *const commands[] = {"merge evil.csv --table",
						       "compare evil.csv --table",
						       "merge evil.csv tame.csv --table",
						       "compare evil.csv --json",
						       "report evil.csv -o evil --size 8 --samples 1 -q",
						       "eval a.binary --from evil.csv --row 1 --table"};
		for (size_t c = 0; c < sizeof commands / sizeof *commands; c++) {
			stdfit(commands[c]);
			expect_tame(last.out, __LINE__);
			expect_tame(last.err, __LINE__);
		}
		char *page = slurp("evil/index.html");
		expect_tame(page, __LINE__);
		free(page);
	}
	/* JSON keeps them, escaped. */
	shell("sed \"s/^a,/$(printf 'a\\033\\342\\200\\256'),/\" tame.csv >evil.csv; exec \"$STDFIT\" merge evil.csv "
	      "--json");
	expect_out("\"material\": \"a\\u001b\\u202e\"");
}

static void noise_follows_the_seed(void **state)
{
	(void)state;
	stdfit("synth n1.binary --kd 0.5 --noise 0.1 --seed 5 --threads 1");
	expect_code(0);
	stdfit("synth n2.binary --kd 0.5 --noise 0.1 --seed 5 --threads 3");
	expect_code(0);
	shell("cmp n1.binary n2.binary");
	expect_code(0);
	stdfit("n1.binary --no-specular --ndf ggx");
	expect_code(0);
	/* The mean of |g|, g normally distributed with standard deviation 0.1. */
	struct csv_table table = read_table("stdout");
	check_abs(result_number(table.row[0], RESULT_ERROR), 0.1 * sqrt(2 / 3.14159265358979), 5e-4, "error");
	csv_table_free(&table);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(help_and_version_are_printed),
		cmocka_unit_test(wrong_usage_is_refused),
		cmocka_unit_test(bad_files_are_refused),
		cmocka_unit_test(mistyped_words_name_the_nearest),
		cmocka_unit_test(left_out_samples_are_counted),
		cmocka_unit_test(first_words_are_answered),
		cmocka_unit_test(helps_fit_80_columns),
		cmocka_unit_test(nan_and_inf_are_masked_and_counted),
		cmocka_unit_test(a_fit_reports_what_it_did),
		cmocka_unit_test(fits_print_JSON_and_tables),
		cmocka_unit_test(a_batch_survives_a_bad_file),
		cmocka_unit_test(directories_below_are_searched_if_asked),
		cmocka_unit_test(threads_change_nothing),
		cmocka_unit_test(a_killed_batch_resumes_to_the_same_table),
		cmocka_unit_test(resume_redoes_what_differs),
		cmocka_unit_test(older_tables_are_taken),
		cmocka_unit_test(rows_that_are_no_models_are_refused),
		cmocka_unit_test(the_energy_is_accounted_for),
		cmocka_unit_test(an_interrupt_keeps_what_is_done),
		cmocka_unit_test(outputs_that_cannot_be_written_are_reported),
		cmocka_unit_test(a_reader_that_is_gone_ends_it_quietly),
		cmocka_unit_test(output_into_head_ends_silently),
		cmocka_unit_test(compare_summarises_tables),
		cmocka_unit_test(weights_stand_side_by_side),
		cmocka_unit_test(how_certain_a_fit_is_stands_in_its_row),
		cmocka_unit_test(within_takes_the_simplest),
		cmocka_unit_test(faults_of_the_data_are_told),
		cmocka_unit_test(another_G_is_told),
		cmocka_unit_test(small_stacks_are_made_larger_or_told),
		cmocka_unit_test(cells_leave_the_terminal_alone),
		cmocka_unit_test(noise_follows_the_seed),
	};
	return cmocka_run_group_tests(tests, set_up, leave_directory);
}
