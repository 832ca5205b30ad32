/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shares of a batch, and their tables joined: the result is what one run writes, or one line says why there is none. */
#include "fit/cli/files.h"
#include "run_program.h"

/* A fit that takes a moment: few free parameters, few entries. */
#define SHAPE "--sigma 0.2 --ior 1.5 --max-theta 20"
#define CHEAP "--ndf ggx,beckmann " SHAPE

/* Seven good files, one of them with a difficult name, and a bad one; whole.csv, the table of one run. */
static int set_up(void **state)
{
	if (enter_directory(state))
		return -1;
	shell("mkdir all; for s in 1 2; do \"$STDFIT\" synth $s.binary --ndf ggx --sigma 0.$s --ior 1.5 --kd 0.3 --ks "
	      "0.5;"
	      "done; for f in a b c 'd,\"q\"'; do ln 1.binary \"all/$f.binary\"; done; for f in B e f; do ln 2.binary "
	      "all/$f.binary; done; head -c 1000 1.binary >all/short.binary; exec \"$STDFIT\" all " CHEAP
	      " -o whole.csv");
	return last.code == 1 ? 0 : -1;
}

/* Fits all shares of the directory into NAME-1.csv ... NAME-n.csv. */
static void fit_shards(const char *name, int n, const char *options)
{
	for (int i = 1; i <= n; i++) {
		char arguments[256];
		snprintf(arguments, sizeof arguments, "all %s --shard %d/%d -o %s-%d.csv", options, i, n, name, i);
		stdfit(arguments);
		assert_in_range(last.code, 0, 1); /* 1: the one with the bad file */
	}
}

static void expect_whole(const char *path)
{
	char *whole = without_seconds("whole.csv"), *found = without_seconds(path);
	assert_string_equal(found, whole);
	free(whole);
	free(found);
}

static struct files files_of(const char *const *name, size_t n)
{
	struct files files = {.path = calloc(n, sizeof(char *)), .n = n, .capacity = n};
	for (size_t i = 0; i < n; i++)
		files.path[i] = strdup(name[i]);
	return files;
}

static void shares_are_a_partition(void **state)
{
	(void)state;
	static const char *const forth[] = {"a", "b", "Z", "z/b", "z", "\xc3\xa9", "a.binary", "-x"};
	static const char *const back[] = {"-x", "a.binary", "\xc3\xa9", "z", "z/b", "Z", "b", "a"};
	enum { N = sizeof forth / sizeof *forth };
	for (int n = 1; n <= N + 2; n++) {
		int times[N] = {0};
		for (int i = 1; i <= n; i++) {
			struct files share = files_of(forth, N), other = files_of(back, N);
			files_keep_shard(&share, (struct shard){i, n});
			files_keep_shard(&other, (struct shard){i, n});
			assert_int_equal(share.n, other.n);
			assert_in_range(share.n, N / n, N / n + (N % n != 0));
			for (size_t k = 0; k < share.n; k++) {
				assert_string_equal(share.path[k], other.path[k]);
				for (int f = 0; f < N; f++)
					times[f] += !strcmp(share.path[k], forth[f]);
			}
			files_free(&share);
			files_free(&other);
		}
		for (int f = 0; f < N; f++)
			assert_int_equal(times[f], 1);
	}
}

static void the_shares_make_the_whole(void **state)
{
	(void)state;
	fit_shards("p", 3, CHEAP);
	stdfit("merge p-1.csv p-2.csv p-3.csv all -o merged.csv");
	expect_code(0);
	assert_string_equal(last.out, "");
	assert_string_equal(last.err, "");
	expect_whole("merged.csv");
	/* To the byte as one run leaves it: with nothing to do, --resume writes the same again. */
	shell("cp merged.csv again.csv; \"$STDFIT\" all " CHEAP " -o again.csv --resume; cmp merged.csv again.csv");
	expect_code(0);
	/* The order of the tables matters to nothing. */
	shell("\"$STDFIT\" merge p-3.csv p-1.csv p-2.csv >other.csv && cmp merged.csv other.csv");
	expect_code(0);
	stdfit("merge p-3.csv p-1.csv p-2.csv --json");
	expect_code(0);
	assert_int_equal(last.out[0], '[');
	stdfit("merge p-3.csv p-1.csv p-2.csv --table");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 17);
	/* An older table moves out of the way. */
	shell("cp merged.csv kept.csv; \"$STDFIT\" merge p-1.csv p-2.csv -o merged.csv && cmp merged.csv~ kept.csv");
	expect_code(0);
	/* But not one of the inputs. */
	shell("cp merged.csv kept.csv; exec \"$STDFIT\" merge merged.csv p-3.csv -o merged.csv");
	expect_error(2, "--output names a file that is to be read");
	shell("cmp merged.csv kept.csv");
	expect_code(0);
}

static void rows_that_agree_may_stand_twice(void **state)
{
	(void)state;
	fit_shards("two", 2, CHEAP);
	stdfit("merge p-1.csv p-2.csv p-3.csv two-1.csv two-2.csv whole.csv all -o twice.csv");
	expect_code(0);
	expect_whole("twice.csv");
	/* The seconds are those of the first table. */
	shell("\"$STDFIT\" merge whole.csv p-1.csv p-2.csv p-3.csv >first.csv && cmp first.csv whole.csv");
	expect_code(0);
}

static void a_share_goes_on_where_it_stopped(void **state)
{
	(void)state;
	shell("head -n 2 p-2.csv >cut.csv; cp cut.csv before; printf 'e,ggx,0.1,\"to' >>cut.csv;"
	      "exec \"$STDFIT\" all " CHEAP " --shard 2/3 --resume -o cut.csv");
	assert_in_range(last.code, 0, 1);
	shell("grep -qxF \"$(tail -n 1 before)\" cut.csv && \"$STDFIT\" merge p-1.csv cut.csv p-3.csv all -o "
	      "resumed.csv");
	expect_code(0);
	expect_whole("resumed.csv");
}

static void a_share_may_be_empty(void **state)
{
	(void)state;
	stdfit("all " CHEAP " --shard 9/9 -o empty.csv");
	expect_code(0);
	assert_string_equal(last.err, "");
	shell("head -n 1 whole.csv | cmp - empty.csv");
	expect_code(0);
	stdfit("all " CHEAP " --shard 10/10 --resume -o empty.csv");
	expect_code(0);
	stdfit("merge empty.csv p-1.csv p-2.csv p-3.csv all -o with_empty.csv");
	expect_code(0);
	expect_whole("with_empty.csv");
	stdfit("merge empty.csv -o none.csv");
	expect_error(1, "no rows to merge");
	stdfit("all " CHEAP " --shard 9/9 -o /nowhere/x.csv");
	expect_error(1, "cannot write '/nowhere/x.csv'");
	/* A list that is not whole has no shares. */
	stdfit("all nowhere " CHEAP " --shard 1/1");
	expect_error(1, "cannot read 'nowhere'");
	assert_string_equal(last.out, "");
	shell("ln -s nowhere gone; exec \"$STDFIT\" all gone " CHEAP " --shard 1/1");
	expect_error(1, "cannot read 'gone': No such file");
	assert_string_equal(last.out, "");
	shell("mkdir bare; exec \"$STDFIT\" all bare " CHEAP " --shard 1/1");
	expect_error(1, "cannot read 'bare'");
	assert_string_equal(last.out, "");
}

/* What is wrong gets one line and code 1; what stood there before stands there still, and nothing beside it. */
static void refuse(const char *arguments, const char *message)
{
	char whole[512];
	write_text("out.csv", "what was there\n");
	snprintf(whole, sizeof whole, "merge %s -o out.csv", arguments);
	stdfit(whole);
	expect_error(1, message);
	assert_string_equal(last.out, "");
	char *out = slurp("out.csv");
	assert_string_equal(out, "what was there\n");
	free(out);
	shell("ls -a | grep -e 'out.csv~' -e '[.]tmp$'");
	assert_string_equal(last.out, "");
}

static void tables_that_do_not_go_together_are_refused(void **state)
{
	(void)state;
	fit_shards("gray", 3, CHEAP " --gray");
	refuse("p-1.csv gray-2.csv p-3.csv",
	       "'gray-2.csv' row 1: made with other options than 'p-1.csv' row 1: with 'gray=yes'");
	shell("sed 's/ seed=0//' p-2.csv >less.csv");
	refuse("p-1.csv less.csv", "made with other options than 'p-1.csv' row 1: without 'seed=0'");
	fit_shards("ggx", 3, "--ndf ggx " SHAPE);
	refuse("ggx-1.csv p-2.csv", " for beckmann, as in 'p-2.csv' row 1: another --ndf");
	refuse("p-2.csv ggx-1.csv", " for beckmann, as in 'p-2.csv' row 1: another --ndf");
	shell("sed 's/," STDFIT_VERSION ",/,9.8.7,/' p-2.csv >future.csv");
	refuse("p-1.csv future.csv",
	       "'future.csv' row 1: made by version '9.8.7', but 'p-1.csv' row 1 by '" STDFIT_VERSION "'");
	shell("sed 's/converged/limit/' p-2.csv >limit.csv");
	refuse("p-1.csv p-2.csv limit.csv", "'limit.csv' row 1: differs in status from 'p-2.csv' row 1");
	shell("sed '2s/:[0-9a-f]\\{16\\},/:0000000000000000,/' p-1.csv >bytes.csv");
	refuse("bytes.csv p-2.csv", "made from other bytes than 'bytes.csv' row 1");
	refuse("p-1.csv p-3.csv all", "its share is missing or did not end");
	shell("sed '$d' p-2.csv >short.csv");
	refuse("p-1.csv short.csv", "or a share that did not end");
	shell("head -c -9 p-2.csv >torn.csv");
	refuse("p-1.csv torn.csv", "torn.csv");
	refuse("p-1.csv p-2.csv p-3.csv all/a.binary all/b.binary", "which is not among the files given");
	refuse("p-1.csv missing.csv", "cannot read 'missing.csv': No such file or directory");
	refuse("p-1.csv p-2.csv p-3.csv all elsewhere", "no row of 'elsewhere'");
	refuse("p-1.csv p-2.csv p-3.csv ./all", "is of 'all/B.binary': expected the paths that were fitted");
	write_text("foreign.csv", "name,height\nme,180\n");
	refuse("p-1.csv foreign.csv", "cannot merge 'foreign.csv': expected the columns of stdfit");
	shell("sed 's/$/,x/' p-2.csv >wider.csv");
	refuse("p-1.csv wider.csv", "cannot merge 'wider.csv': expected the columns of stdfit");
	write_text("void.csv", "");
	refuse("p-1.csv void.csv", "cannot merge 'void.csv': expected the columns of stdfit");
	shell("mkdir folder.csv");
	refuse("p-1.csv folder.csv", "cannot read 'folder.csv'");
}

static void failed_writes_are_reported(void **state)
{
	(void)state;
	stdfit("merge p-1.csv p-2.csv -o /nowhere/x.csv");
	expect_error(1, "cannot write '/nowhere/x.csv'");
	stdfit("merge p-1.csv p-2.csv -o all");
	expect_error(1, "cannot write 'all': Is a directory");
	stdfit("merge p-1.csv p-2.csv >/dev/full");
	expect_error(1, "cannot write standard output: No space left on device");
	stdfit("merge p-1.csv p-2.csv -o /dev/full");
	expect_error(1, "cannot write '/dev/full': No space left on device");
	/* Through a symbolic link: the link stays, what it leads to is replaced, and kept beside that. */
	shell("mkdir far; cp whole.csv far/real.csv; ln -s far/real.csv link.csv;"
	      "\"$STDFIT\" merge p-1.csv p-2.csv -o link.csv && test -L link.csv && cmp far/real.csv~ whole.csv && ! "
	      "cmp "
	      "-s "
	      "far/real.csv whole.csv");
	expect_code(0);
	if (THREAD_SANITIZER)
		return;
	shell("cp whole.csv stays.csv; ulimit -f 1; exec \"$STDFIT\" merge p-1.csv p-2.csv p-3.csv -o stays.csv");
	expect_error(1, "cannot write 'stays.csv': File too large");
	shell("cmp whole.csv stays.csv && ! ls -a | grep -e 'stays.csv~' -e '[.]tmp$'");
	expect_code(0);
}

static void wrong_usage_is_refused(void **state)
{
	(void)state;
	static const struct {
		const char *arguments, *message;
	} wrong[] = {
		{"merge", "expected CSV"},
		{"merge all", "expected tables FILE.csv"},
		{"merge p-1.csv -r", "--recursive means nothing"},
		{"merge p-1.csv --shard 1/2", "'--shard'"},
		{"compare all --shard 1/2", "'--shard'"},
		{"all --shard 0/2", "bad value '0/2' for --shard: expected I/N"},
		{"all --shard 3/2", "bad value '3/2' for --shard"},
		{"all --shard 2", "bad value '2' for --shard"},
		{"all --shard /2", "bad value '/2' for --shard"},
		{"all --shard 1/", "bad value '1/' for --shard"},
		{"all --shard 1/2/3", "bad value '1/2/3' for --shard"},
		{"all --shard -1/2", "bad value '-1/2' for --shard"},
		{"all --shard 1/100001", "for --shard"},
		{"all --shard 00000000000000000000000000000000001/2", "for --shard"},
		{"all --shard 99999999999999999999/99999999999999999999", "for --shard"},
	};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		stdfit(wrong[i].arguments);
		expect_error(2, wrong[i].message);
		assert_string_equal(last.out, "");
	}
}

/* Of --within a file has one row, of whichever NDF. */
static void shares_with_within_make_the_whole(void **state)
{
	(void)state;
	stdfit("all " CHEAP " --within 1% -o whole_within.csv");
	expect_code(1);
	fit_shards("within", 2, CHEAP " --within 1%");
	shell("\"$STDFIT\" merge within-1.csv within-2.csv all -o merged_within.csv");
	expect_code(0);
	char *whole = without_seconds("whole_within.csv"), *merged = without_seconds("merged_within.csv");
	assert_string_equal(merged, whole);
	free(whole);
	free(merged);
	shell("sed 's/,ggx,/,std,/' within-2.csv >rival.csv");
	refuse("within-1.csv within-2.csv rival.csv", "differs in ndf from 'within-2.csv' row");
	refuse("within-1.csv p-2.csv", "made with other options");
	/* Under several weights it has one of each; a file that failed has a row of each NDF. */
	stdfit("all " CHEAP " --within 1% --weight none,cosine -q -o weights.csv");
	expect_code(1);
	shell("\"$STDFIT\" merge weights.csv all -o merged_weights.csv && cut -d, -f1,2,3,17 merged_weights.csv >a && "
	      "cut -d, -f1,2,3,17 weights.csv >b && cmp a b");
	expect_code(0);
	static const char *const without[] = {"B", "f", "short"};
	for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
		char command[128];
		snprintf(command, sizeof command, "grep -v '^%s,.*,cosine,' weights.csv >lacks.csv", without[i]);
		shell(command);
		refuse("lacks.csv", "for cosine, as in 'lacks.csv' row");
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shares_are_a_partition),
		cmocka_unit_test(the_shares_make_the_whole),
		cmocka_unit_test(rows_that_agree_may_stand_twice),
		cmocka_unit_test(a_share_goes_on_where_it_stopped),
		cmocka_unit_test(a_share_may_be_empty),
		cmocka_unit_test(tables_that_do_not_go_together_are_refused),
		cmocka_unit_test(failed_writes_are_reported),
		cmocka_unit_test(wrong_usage_is_refused),
		cmocka_unit_test(shares_with_within_make_the_whole),
	};
	return cmocka_run_group_tests(tests, set_up, leave_directory);
}
