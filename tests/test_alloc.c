/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory runs out at one allocation after the other, whoever asks for it: the program, nlopt, GSL, xxhash or the C
 * library. Each run ends with what it would have given anyhow, or with a message, exit code 1, and nothing lost that
 * was there. The program runs in a child of this one, whose own malloc() decides.
 * Left out are allocations of OpenMP's runtime, libgomp, which ends the process by itself ("libgomp: Out of memory").
 * The first allocations of a run are tried, and as many of the others, evenly spread; STDFIT_ALLOC=N in the environment
 * says how many, STDFIT_SCENARIO names the only command to be tried. */
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define OWN_ALLOCATOR 0 /* its malloc() is needed before anything is ready for another */
#endif
#endif
#if defined(__SANITIZE_THREAD__)
#define OWN_ALLOCATOR 0
#endif
#ifndef OWN_ALLOCATOR
#define OWN_ALLOCATOR 1
#endif

#include "data_readers/merl.h"
#include "fit/commands/commands.h"
#include "fit/render/image.h"
#include "json_check.h"
#include "run_program.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/stat.h>

/* The program's own main(), which is not in what tests are linked with. */
int stdfit_main(int argc, char **argv);
#define main stdfit_main
#include "fit/commands/main.c"
#undef main

/* --- the allocator ----------------------------------------------------------------------------------------------- */

/* What a run is to do, and did; shared with the child. */
static struct control {
	atomic_long count;  /* allocations so far */
	long fail_at;       /* the one to fail, from 1; 0: none */
	bool all_after;     /* and every later one */
	atomic_long failed; /* how many did */
} * control;

static bool armed; /* in the child, while the program runs */
static _Thread_local bool inside;

static bool is_in(const char *file, const char *name)
{
	return file && strstr(file, name);
}

/* Whether it is a runtime that asks, perhaps through the C library, and ends the process if it gets nothing: OpenMP's, or
 * that of a sanitizer. caller: where the allocator was called from. */
static bool asked_by_runtime(const void *caller)
{
	static const char *const runtime[] = {"libgomp", "libomp", "libasan", "libubsan", "libtsan"};
	void *frame[32];
	Dl_info info;
	const int n = backtrace(frame, 32);
	int i = 0;
	while (i < n && frame[i] != caller)
		i++;
	for (; i < n; i++) {
		if (!dladdr(frame[i], &info))
			return false;
		if (is_in(info.dli_fname, "libc.so") || is_in(info.dli_fname, "ld-linux"))
			continue;
		for (size_t r = 0; r < sizeof runtime / sizeof *runtime; r++)
			if (is_in(info.dli_fname, runtime[r]))
				return true;
		return false;
	}
	return false;
}

static __attribute__((noinline, unused)) bool refuse(const void *caller)
{
	if (!armed || inside)
		return false;
	const long n = ++control->count;
	if (!control->fail_at || n < control->fail_at || (n > control->fail_at && !control->all_after))
		return false;
	inside = true;
	const bool refused = !asked_by_runtime(caller);
	inside = false;
	if (refused) {
		control->failed++;
		errno = ENOMEM;
	}
	return refused;
}

/* glibc's own functions, or the sanitizer's. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t n, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
__attribute__((weak)) void __lsan_disable(void);
__attribute__((weak)) void __lsan_enable(void);
__attribute__((weak)) void *__interceptor_malloc(size_t size);
__attribute__((weak)) void *__interceptor_calloc(size_t n, size_t size);
__attribute__((weak)) void *__interceptor_realloc(void *old, size_t size);
__attribute__((weak)) void *__interceptor_memalign(size_t alignment, size_t size);

/* nlopt's CRS forgets its tree when a node of it cannot be had. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
	return "leak:libnlopt\n";
}

const char *__lsan_default_options(void);
const char *__lsan_default_options(void)
{
	return "print_suppressions=0";
}

#if OWN_ALLOCATOR

void *malloc(size_t size)
{
	return refuse(__builtin_return_address(0)) ? NULL
	       : __interceptor_malloc              ? __interceptor_malloc(size)
						   : __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
	return refuse(__builtin_return_address(0)) ? NULL
	       : __interceptor_calloc              ? __interceptor_calloc(n, size)
						   : __libc_calloc(n, size);
}

void *realloc(void *old, size_t size)
{
	return refuse(__builtin_return_address(0)) ? NULL
	       : __interceptor_realloc             ? __interceptor_realloc(old, size)
						   : __libc_realloc(old, size);
}

static void *get_aligned(size_t alignment, size_t size, const void *caller)
{
	return refuse(caller)           ? NULL
	       : __interceptor_memalign ? __interceptor_memalign(alignment, size)
					: __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
	return get_aligned(alignment, size, __builtin_return_address(0));
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
	void *got = get_aligned(alignment, size, __builtin_return_address(0));
	if (!got)
		return ENOMEM;
	*memory = got;
	return 0;
}

#endif

/* --- runs -------------------------------------------------------------------------------------------------------- */

enum { OUTPUTS_MAX = 20 };

struct scenario {
	const char *name, *arguments;
	const char *output[OUTPUTS_MAX]; /* what it writes besides standard output */
	const char *before;              /* a file that is there before under the first name; NULL: none */
	bool binary;                     /* the output is a MERL file */
	bool heavy;                      /* it reads or writes a whole MERL file */
	bool partial;                    /* pictures of a material that failed may be missing */
	bool varies;                     /* what it gives depends on time */
};

enum { ARGUMENTS_MAX = 32 };

/* Runs in the child: the program with these arguments, and never returns. */
static void run_child(const struct scenario *scenario)
{
	static char name[] = "stdfit", text[512];
	char *argv[ARGUMENTS_MAX] = {name};
	int argc = 1;
	snprintf(text, sizeof text, "%s", scenario->arguments);
	for (char *word = strtok(text, " "); word; word = strtok(NULL, " "))
		argv[argc++] = word;
	/* Opened anew, the streams have to ask for their buffers. */
	if (!freopen("../out", "w", stdout) || !freopen("../err", "w", stderr))
		_exit(99);
	/* cmocka's handlers would go on with the tests. */
	static const int deadly[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGABRT};
	for (size_t i = 0; i < sizeof deadly / sizeof *deadly; i++)
		signal(deadly[i], SIG_DFL);
	alarm(120); /* a hang ends */
	armed = true;
	const int code = stdfit_main(argc, argv);
	armed = false;
	exit(code);
}

/* The directory in which a run begins. */
static void prepare(const struct scenario *scenario)
{
	char command[512];
	snprintf(command, sizeof command,
		 "rm -rf run; mkdir run run/d run/d/e; ln a.binary run/a.binary; ln a.binary run/d/e/b.binary;"
		 "cp table.csv two.csv shard.csv model.json trace.csv map.pfm samples.csv paint.brdf half.dat "
		 "sphere.bsdf "
		 "run; %s%s%s%s",
		 scenario->before ? "cp " : "", scenario->before ? scenario->before : "",
		 scenario->before ? " run/" : "", scenario->before ? scenario->output[0] : "");
	assert_int_equal(end(start(command)), 0);
}

static int run(const struct scenario *scenario, long fail_at, bool all_after)
{
	prepare(scenario);
	control->count = control->failed = 0;
	control->fail_at = fail_at;
	control->all_after = all_after;
	assert_int_equal(chdir("run"), 0);
	fflush(stdout);
	const pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0)
		run_child(scenario);
	const int code = end(pid);
	assert_int_equal(chdir(".."), 0);
	return code;
}

static bool is_result_table(const char *text)
{
	return !strncmp(text, "material,ndf,error,kd_r", strlen("material,ndf,error,kd_r"));
}

/* What a file holds as a string, although there may be zero bytes in it. */
static char *slurp_bytes(const char *path)
{
	struct stat info;
	char *text = slurp(path);
	assert_int_equal(stat(path, &info), 0);
	for (off_t i = 0; i < info.st_size; i++)
		if (!text[i])
			text[i] = '\1';
	return text;
}

/* What a file holds, without seconds; NULL if it is not there. */
static char *content(const char *path, bool binary)
{
	if (access(path, F_OK))
		return NULL;
	if (binary) {
		struct measurement measurement;
		char text[RESULT_INPUT_SIZE];
		if (merl_read(path, 1, &measurement, NULL))
			return strdup("broken");
		result_input(text, &measurement);
		measurement_free(&measurement);
		return strdup(text);
	}
	char *text = slurp_bytes(path);
	/* In JSON the number is cut out where it stands. */
	static const char name[] = "\"seconds\": ";
	for (char *at = text; (at = strstr(at, name));) {
		at += strlen(name);
		memmove(at, at + strcspn(at, ","), strlen(at + strcspn(at, ",")) + 1);
	}
	if (!is_result_table(text))
		return text;
	free(text);
	return without_seconds(path);
}

static bool same(const char *a, const char *b)
{
	return a == b || (a && b && !strcmp(a, b));
}

/* Each row of a table that was left behind tells why it failed, or is one that the whole run gives, or was there. */
static void check_rows(const char *left, const char *whole, const char *before)
{
	char *copy = strdup(left);
	if (!copy || !whole)
		fail_msg("nothing to compare");
	for (char *line = strtok(copy, "\n"); line; line = strtok(NULL, "\n"))
		if (!strstr(line, ",failed: ") && !strstr(line, ",\"failed: ") && !(whole && strstr(whole, line)) &&
		    !(before && strstr(before, line)))
			fail_msg("a row that should not be there: %s", line);
	free(copy);
}

static bool ends_with(const char *text, const char *end)
{
	const size_t length = strlen(text), n = strlen(end);
	return length >= n && !strcmp(text + length - n, end);
}

/* Output that says itself what it lacks. */
static bool tells(const char *text)
{
	return (json_is_valid(text) && strstr(text, "\"failed: ")) ||
	       (ends_with(text, "</html>\n") && strstr(text, "<p>Pictures are missing: "));
}

/* Whether the lines of a comparison are the same up to the columns that come from pictures. */
static bool same_but_pictures(const char *a, const char *b)
{
	enum { COLUMNS = 5 };
	for (; a && b && *a && *b; a = strchr(a, '\n') + 1, b = strchr(b, '\n') + 1) {
		size_t length = 0;
		for (int c = 0; c < COLUMNS && a[length] != '\n'; c++)
			length += strcspn(a + length, ",\n") + 1;
		if (strncmp(a, b, length) || !strchr(a, '\n') || !strchr(b, '\n'))
			return false;
	}
	return a && b && *a == *b;
}

static bool is_picture(const char *path)
{
	struct image image;
	if (image_read(path, &image, NULL))
		return false;
	image_free(&image);
	return true;
}

/* What a run that failed may leave of an output: nothing, what was there, or rows of the whole. */
static void check_output(const struct scenario *scenario, int i, const char *whole)
{
	const char *name = scenario->output[i], *before_path = i ? NULL : scenario->before;
	const bool binary = scenario->binary;
	char path[64], back_path[64];
	snprintf(path, sizeof path, "run/%s", name);
	snprintf(back_path, sizeof back_path, "run/%s~", name);
	char *before = before_path ? content(before_path, binary) : NULL;
	char *left = content(path, binary), *back = content(back_path, binary);
	if (left && !same(left, before) && !same(left, whole)) {
		char *text = binary ? strdup("") : slurp(path);
		const bool table = is_result_table(text);
		if (!table && !tells(text) &&
		    !(scenario->partial && (is_picture(path) || same_but_pictures(left, whole))))
			fail_msg("%s is neither whole nor as it was: %.300s", path, left);
		free(text);
		if (table)
			check_rows(left, whole, before);
	}
	/* Nothing is lost that was there: as a file, or row by row. */
	if (before && !same(left, before) && !same(back, before)) {
		char *copy = strdup(before);
		for (char *line = strtok(copy, "\n"); line; line = strtok(NULL, "\n"))
			if (!(left && strstr(left, line)) && !(back && strstr(back, line)))
				fail_msg("%s has lost a row: %s", path, line);
		free(copy);
	}
	free(back);
	free(left);
	free(before);
}

static void check_messages(const char *text)
{
	if (!*text)
		fail_msg("it failed without a word");
	for (const char *line = text; *line; line = strchr(line, '\n') + 1)
		if (strncmp(line, "stdfit: ", 8) != 0 || !strchr(line, '\n'))
			fail_msg("unexpected message in: %s", text);
}

struct outcome {
	char *out, *output[OUTPUTS_MAX];
};

static struct outcome outcome_read(const struct scenario *scenario)
{
	struct outcome outcome = {.out = content("out", false)};
	for (int i = 0; i < OUTPUTS_MAX && scenario->output[i]; i++) {
		char path[64];
		snprintf(path, sizeof path, "run/%s", scenario->output[i]);
		outcome.output[i] = content(path, scenario->binary);
	}
	return outcome;
}

static void outcome_free(struct outcome *outcome)
{
	free(outcome->out);
	for (int i = 0; i < OUTPUTS_MAX; i++)
		free(outcome->output[i]);
}

static void check_success(const struct scenario *scenario, const struct outcome *whole, const char *when)
{
	struct outcome outcome = outcome_read(scenario);
	if (!same(outcome.out, whole->out))
		fail_msg("%s: exit code 0, but not the same on standard output: %.600s", when, outcome.out);
	for (int i = 0; i < OUTPUTS_MAX; i++)
		if (!same(outcome.output[i], whole->output[i]))
			fail_msg("%s: exit code 0, but %s is not the same: %.600s", when, scenario->output[i],
				 outcome.output[i]);
	outcome_free(&outcome);
}

/* One run with a failure; what went wrong is told with the scenario and the number of the allocation. */
static void check_failure(const struct scenario *scenario, const struct outcome *whole, long n, bool all_after)
{
	const int code = run(scenario, n, all_after);
	char when[128], *err = slurp("err");
	snprintf(when, sizeof when, "%s, allocation %ld%s", scenario->name, n, all_after ? " and all later ones" : "");
	if (code != EXIT_DONE && code != EXIT_FAILED)
		fail_msg("%s: exit code %d; standard error: %s", when, code, err);
	if (code == EXIT_DONE && !scenario->varies)
		check_success(scenario, whole, when);
	if (code == EXIT_FAILED) {
		printf("%s\n", when);
		check_messages(err);
		for (int i = 0; i < OUTPUTS_MAX && scenario->output[i]; i++)
			check_output(scenario, i, whole->output[i]);
	}
	free(err);
	shell("find run -name '.stdfit-*' -o -name '*.stdfit-*'");
	assert_string_equal(last.out, "");
}

/* How many of the first allocations are tried, and of the others. */
static long tries(const struct scenario *scenario)
{
	const char *wish = getenv("STDFIT_ALLOC");
	return wish ? atol(wish) : scenario->heavy ? 2 : 50;
}

static void check_scenario(const struct scenario *scenario)
{
	if (run(scenario, 0, false) != EXIT_DONE)
		fail_msg("%s: %s", scenario->name, slurp("err"));
	const long total = control->count, most = tries(scenario);
	const long first = most < total ? most : total, others = most < total - first ? most : total - first;
	struct outcome whole = outcome_read(scenario);
	for (int i = 0; i < OUTPUTS_MAX && scenario->output[i]; i++)
		if (!whole.output[i])
			fail_msg("%s: there is no %s", scenario->name, scenario->output[i]);
	for (long n = 1; n <= first; n++)
		check_failure(scenario, &whole, n, n % 2);
	for (long i = 0; i < others; i++)
		check_failure(scenario, &whole, first + 1 + i * (total - first) / others, i % 2);
	/* With many wished for, each both ways. */
	for (long n = 1; n <= first && most > 50; n++)
		check_failure(scenario, &whole, n, n % 2 == 0);
	printf("%s: %ld allocations, %ld tried\n", scenario->name, total, first + others);
	outcome_free(&whole);
}

#define MODEL "--kd 0.3 --ks 0.5 --ndf std --gamma 2.5 --sigma 0.2"
#define DRAWN(name) name ".csv", name ".gp", name ".png", name ".svg"
#define QUICK "--threads 1 --size 16 --samples 1"
#define FIT_CHEAP "--ndf ggx --sigma 0.2 --ior 1.5 --max-theta 5"
#define CHEAP "--threads 1 " FIT_CHEAP

static const struct scenario scenarios[] = {
	{.name = "version", .arguments = "--version"},
	{.name = "help", .arguments = "fit --help"},
	{.name = "compare a table",
	 .arguments = "compare table.csv -o summary.csv",
	 .output = {"summary.csv"},
	 .before = "old.csv"},
	{.name = "compare as JSON", .arguments = "compare table.csv --json"},
	{.name = "info of samples", .arguments = "info samples.csv paint.brdf half.dat sphere.bsdf"},
	{.name = "convert to CSV", .arguments = "convert paint.brdf new.csv", .output = {"new.csv"}},
	{.name = "convert to a table",
	 .arguments = "convert --threads 1 samples.csv new.binary",
	 .output = {"new.binary"},
	 .binary = true,
	 .heavy = true},
	{.name = "merge", .arguments = "merge table.csv shard.csv -o merged.csv", .output = {"merged.csv"}},
	{.name = "export", .arguments = "export " MODEL " --format json -o new.json", .output = {"new.json"}},
	{.name = "export of JSON",
	 .arguments = "export --from model.json --format json -o new.json",
	 .output = {"new.json"}},
	{.name = "export to mitsuba",
	 .arguments = "export --kd 0.3 --ks 0.5 --ndf ggx --sigma 0.2 --format mitsuba -o new.xml",
	 .output = {"new.xml"}},
	{.name = "export to pbrt, on standard output",
	 .arguments = "export --kd 0.3 --ks 0.5 --ndf ggx --sigma 0.2 --gaf correlated --format pbrt"},
	{.name = "export of a substitute",
	 .arguments = "export --threads 1 --from table.csv --row 1 --format pbrt -o new.pbrt",
	 .output = {"new.pbrt"},
	 .heavy = true},
	{.name = "export of a blend",
	 .arguments =
		 "export --threads 1 --max-theta 5 --kd 0.3 --ks 0.9 --ndf ggx --sigma 0.3 --fresnel none --format "
		 "mitsuba -o new.xml",
	 .output = {"new.xml"},
	 .heavy = true},
	{.name = "export to merl",
	 .arguments = "export --from table.csv --row 1 --format merl -o new.binary",
	 .output = {"new.binary"},
	 .binary = true,
	 .heavy = true},
	{.name = "export a row",
	 .arguments = "export --from table.csv --row 1 --format brdf -o a.brdf",
	 .output = {"a.brdf"}},
	{.name = "ndf", .arguments = "ndf std --sigma 0.3 --gamma 2.5 --theta 0:90:15 --json"},
	{.name = "ndf of a row", .arguments = "ndf --from table.csv --row 1 --theta 10,20"},
	{.name = "sample", .arguments = "sample ggx --sigma 0.3 --count 10"},
	{.name = "info", .arguments = "info a.binary --json", .heavy = true},
	{.name = "eval",
	 .arguments = "eval a.binary --threads 1 --kd 0.3 --ks 0.5 --ndf std --sigma 0.2 --gamma 2.5 --ior 1.5",
	 .heavy = true},
	{.name = "eval --from", .arguments = "eval a.binary --threads 1 --from table.csv", .heavy = true},
	{.name = "synth",
	 .arguments = "synth new.binary --threads 1 --kd 0.4 --noise 0.1",
	 .output = {"new.binary"},
	 .binary = true,
	 .heavy = true},
	{.name = "render",
	 .arguments = "render a.binary --from model.json " QUICK " --difference -o new.png",
	 .output = {"new.png"},
	 .before = "table.csv",
	 .heavy = true},
	{.name = "render a table",
	 .arguments = "render two.csv " QUICK " --json -o new.pfm",
	 .output = {"new.pfm"},
	 .partial = true,
	 .heavy = true},
	{.name = "render a fit", .arguments = "render a.binary " CHEAP " --size 16 --samples 1", .heavy = true},
	{.name = "render in the light of a map",
	 .arguments = "render a.binary " MODEL " " QUICK " -e map.pfm --light 0,1,1;1,0,1,2",
	 .heavy = true},
	{.name = "compare --pictures",
	 .arguments = "compare two.csv --pictures --threads 1 -o new.csv",
	 .output = {"new.csv"},
	 .partial = true,
	 .heavy = true},
	{.name = "plot",
	 .arguments = "plot two.csv --threads 1 -o plots",
	 .output = {DRAWN("plots/errors"), "plots/a/ndf_D.csv", "plots/a/ndf_G1.csv", "plots/a/ndf.gp",
		    "plots/a/ndf.svg", DRAWN("plots/a/map"), DRAWN("plots/a/slices"), "plots/a/slices_0.gp",
		    "plots/a/slices_0.svg"},
	 .heavy = true},
	{.name = "plot a fit",
	 .arguments = "plot a.binary " CHEAP " -o plots",
	 .output = {"plots/fits.csv", DRAWN("plots/a/map")},
	 .heavy = true},
	{.name = "plot a trace", .arguments = "plot trace.csv -o plots", .output = {DRAWN("plots/trace")}},
	{.name = "report",
	 .arguments = "report two.csv " QUICK " -o page",
	 .output = {"page/index.html"},
	 .heavy = true},
	{.name = "report of a fit",
	 .arguments = "report a.binary " CHEAP " --size 16 --samples 1 -o page",
	 .output = {"page/index.html", "page/fits.csv"},
	 .heavy = true},
	{.name = "fit a directory",
	 .arguments = "-r d a.binary " CHEAP " -o new.csv",
	 .output = {"new.csv"},
	 .before = "old.csv",
	 .heavy = true},
	{.name = "fit --resume",
	 .arguments = "a.binary d/e/b.binary " CHEAP " --resume -o new.csv",
	 .output = {"new.csv"},
	 .before = "half.csv",
	 .heavy = true},
	{.name = "fit --json",
	 .arguments = "a.binary --threads 1 --ndf std,ggx --max-theta 5 --no-specular --json -o new.json",
	 .output = {"new.json"},
	 .heavy = true},
	{.name = "fit --trace",
	 .arguments = "a.binary " CHEAP " --trace trace.csv -o new.csv",
	 .output = {"new.csv"},
	 .heavy = true},
	{.name = "fit --within", .arguments = "a.binary " CHEAP " --within 1%", .heavy = true},
	{.name = "fit in two threads", .arguments = "a.binary d/e/b.binary " FIT_CHEAP " --threads 2", .heavy = true},
	{.name = "search", .arguments = "a.binary --threads 1 --ndf std --max-theta 3", .heavy = true},
	{.name = "search of pl", .arguments = "a.binary --threads 1 --ndf pl --max-theta 2", .heavy = true},
	{.name = "crs2",
	 .arguments = "a.binary --threads 1 --ndf ggx --max-theta 3 --time 0.05 --algorithm crs2",
	 .heavy = true,
	 .varies = true},
	{.name = "mlsl",
	 .arguments = "a.binary --threads 1 --ndf ggx --max-theta 3 --time 0.05 --algorithm mlsl",
	 .heavy = true,
	 .varies = true},
	{.name = "direct-l",
	 .arguments = "a.binary --threads 1 --ndf ggx --max-theta 3 --time 0.05 --algorithm direct-l",
	 .heavy = true,
	 .varies = true},
	{.name = "esch-joint",
	 .arguments = "a.binary --threads 1 --ndf ggx --max-theta 3 --time 0.05 --algorithm esch-joint",
	 .heavy = true,
	 .varies = true},
	{.name = "isres",
	 .arguments = "a.binary --threads 1 --ndf ggx --max-theta 3 --time 0.05 --algorithm isres",
	 .heavy = true,
	 .varies = true},
};

/* STDFIT_SCENARIO may name the only one to be tried. */
static bool is_wanted(const struct scenario *scenario)
{
	const char *name = getenv("STDFIT_SCENARIO");
	return !name || !strcmp(name, scenario->name);
}

/* What stands for gnuplot, whose allocations are its own: each picture is the script and the data. */
static const char gnuplot[] = "#!/bin/sh\n"
			      "part=${3#*\\'}\n"
			      "part=${part%\\'}\n"
			      "shift 3\n"
			      "for script; do\n"
			      "\tname=${script%.gp}\n"
			      "\t{ cat $script $name*.csv; printf 'IEND\\256B`\\202'; } >$name.png$part || exit\n"
			      "\t{ cat $script $name*.csv; echo '</svg>'; } >$name.svg$part || exit\n"
			      "done\n";

/* Further files that scenarios read. */
static void make_files(void)
{
	char *path;
	assert_true(asprintf(&path, "%s/bin:%s", test_directory, getenv("PATH")) > 0);
	assert_int_equal(setenv("PATH", path, 1), 0);
	free(path);
	shell("mkdir -p bin");
	write_text("bin/gnuplot", gnuplot);
	write_text("samples.csv", "theta_i,theta_o,value\n10,20,1\n10,30,2\n20,-5,3\n30,30,4\n");
	write_text("paint.brdf", "3\n400 550 700\n0.1 0 0.2 3 1 2 3\n0.2 0 0.2 3 3 2 1\n");
	write_text("half.dat", "#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n.1 .2 .3 1\n");
	write_text(
		"sphere.bsdf",
		"Source Measured\nScatterType BRDF\nSampleRotation 1\n0\nAngleOfIncidence 1\n20\nScatterAzimuth 1\n0\n"
		"ScatterRadial 2\n0 10\nDataBegin\n1 2\nDataEnd\n");
	shell("chmod +x bin/gnuplot && \"$STDFIT\" export " MODEL " --format json -o model.json"
	      " && { cat table.csv; tail -n +2 shard.csv | sed s/b[.]bin/d.e.b.bin/ | sed s,d.e.b.bin,d/e/b.bin,; } "
	      ">two.csv"
	      " && \"$STDFIT\" a.binary " CHEAP " --trace trace.csv -o traced.csv"
	      " && { printf 'PF\\n8 4\\n-1\\n'; head -c $((8 * 4 * 12)) /dev/zero | tr '\\0' '?'; } >map.pfm");
	expect_code(0);
}

static void a_failed_allocation_is_an_error_in_short_commands(void **state)
{
	(void)state;
	if (!OWN_ALLOCATOR)
		skip_because("ThreadSanitizer lets no other malloc() be");
	make_files();
	for (size_t i = 0; i < sizeof scenarios / sizeof *scenarios; i++)
		if (!scenarios[i].heavy && is_wanted(&scenarios[i]))
			check_scenario(&scenarios[i]);
}

static void a_failed_allocation_is_an_error_in_long_commands(void **state)
{
	(void)state;
	if (!OWN_ALLOCATOR)
		skip_because("ThreadSanitizer lets no other malloc() be");
	make_files();
	for (size_t i = 0; i < sizeof scenarios / sizeof *scenarios; i++)
		if (scenarios[i].heavy && is_wanted(&scenarios[i]))
			check_scenario(&scenarios[i]);
}

static int set_up(void **state)
{
	void *frame[4];
	/* What it loads at first, and keeps, is there before the forks. */
	if (__lsan_disable)
		__lsan_disable();
	backtrace(frame, 4);
	if (__lsan_enable)
		__lsan_enable();
	control = mmap(NULL, sizeof *control, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (control == MAP_FAILED || enter_directory(state))
		return -1;
	alarm(getenv("STDFIT_ALLOC") ? 0 : 300);
	shell("\"$STDFIT\" synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5 && ln a.binary "
	      "b.binary"
	      " && \"$STDFIT\" a.binary " CHEAP " -o table.csv && \"$STDFIT\" b.binary " CHEAP " -o shard.csv"
	      " && cp table.csv half.csv && \"$STDFIT\" b.binary --threads 1 --no-specular --max-theta 5 -o old.csv");
	return last.code;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_failed_allocation_is_an_error_in_short_commands),
		cmocka_unit_test(a_failed_allocation_is_an_error_in_long_commands),
	};
	return cmocka_run_group_tests(tests, set_up, leave_directory);
}
