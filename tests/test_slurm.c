/* SPDX-License-Identifier: GPL-3.0-or-later */
/* More than one machine: scripts/slurm_fit.sh on a Slurm of one node that this program starts and ends, and shares by
 * GNU parallel over what stands for ssh. Slurm, munge and parallel may be absent. */
#include "run_program.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>

/* A fit that takes a moment: few free parameters, few entries. */
#define CHEAP "--ndf ggx,beckmann --sigma 0.2 --ior 1.5 --max-theta 20"

enum { DAEMONS = 3 };
static pid_t daemons[DAEMONS]; /* 0: not started */

/* Starts a daemon that stays in the foreground; it dies with this program. */
static pid_t start_daemon(const char *command)
{
	const pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		execl("/bin/sh", "sh", "-c", command, (char *)NULL);
		_exit(127);
	}
	return pid;
}

static int free_port(void)
{
	struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	socklen_t size = sizeof address;
	const int fd = socket(AF_INET, SOCK_STREAM, 0);
	assert_true(fd >= 0);
	assert_int_equal(bind(fd, (struct sockaddr *)&address, sizeof address), 0);
	assert_int_equal(getsockname(fd, (struct sockaddr *)&address, &size), 0);
	close(fd);
	return ntohs(address.sin_port);
}

/* Everything of this Slurm lies in the test's directory and listens on 127.0.0.1. */
static void write_configuration(void)
{
	char host[256], user[64], *text;
	shell("id -un");
	snprintf(user, sizeof user, "%.*s", (int)strcspn(last.out, "\n"), last.out);
	assert_int_equal(gethostname(host, sizeof host), 0);
	host[strcspn(host, ".")] = '\0';
	assert_true(
		asprintf(
			&text,
			"ClusterName=stdfit_test\n"
			"SlurmctldHost=%s(127.0.0.1)\n"
			"NodeName=n1 NodeHostname=%s NodeAddr=127.0.0.1 Port=%d CPUs=2 State=UNKNOWN\n"
			"PartitionName=all Nodes=n1 Default=YES MaxTime=INFINITE State=UP\n"
			"SlurmUser=%s\nSlurmdUser=%s\nSlurmctldPort=%d\n"
			"CommunicationParameters=NoCtldInAddrAny,NoInAddrAny\n"
			"AuthType=auth/munge\nAuthInfo=socket=%s/munge.socket\n"
			"StateSaveLocation=%s/state\nSlurmdSpoolDir=%s/spool\n"
			"SlurmctldPidFile=%s/slurmctld.pid\nSlurmdPidFile=%s/slurmd.pid\n"
			"ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n"
			"SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n"
			"SwitchType=switch/none\nMpiDefault=none\nJobAcctGatherType=jobacct_gather/none\n"
			"AccountingStorageType=accounting_storage/none\nPropagateResourceLimits=NONE\n"
			"ReturnToService=2\nKillWait=2\nSlurmdParameters=config_overrides\n"
			"SchedulerParameters=sched_interval=1,sched_min_interval=0,bf_interval=1,batch_sched_delay=0\n",
			host, host, free_port(), user, user, free_port(), test_directory, test_directory,
			test_directory, test_directory, test_directory) > 0);
	write_text("slurm.conf", text);
	free(text);
}

static bool slurm_is_installed(void)
{
	shell("for c in sbatch sinfo squeue scancel slurmctld slurmd munged; do command -v $c || exit 1; done");
	return last.code == 0;
}

static void start_slurm(void)
{
	write_configuration();
	shell("umask 077; mkdir state spool; head -c 1024 /dev/urandom >munge.key");
	expect_code(0);
	daemons[0] = start_daemon("exec munged -F --key-file=$PWD/munge.key --socket=$PWD/munge.socket "
				  "--pid-file=$PWD/munge.pid --log-file=$PWD/munge.log --seed-file=$PWD/munge.seed "
				  ">munged.out 2>&1");
	shell("i=0; until test -S munge.socket; do i=$((i + 1)); test $i -lt 600 || exit 1; sleep 0.1; done");
	if (last.code) {
		shell("cat munged.out");
		fail_msg("munged did not start: %s", last.out);
	}
	daemons[1] = start_daemon("exec slurmctld -D >slurmctld.log 2>&1");
	daemons[2] = start_daemon("exec slurmd -D -N n1 >slurmd.log 2>&1");
	shell("i=0; until sinfo -h -o %T 2>/dev/null | grep -q idle; do i=$((i + 1)); test $i -lt 600 || exit 1; sleep "
	      "0.1; "
	      "done");
	if (last.code) {
		shell("sinfo 2>&1; tail -n 5 slurmctld.log slurmd.log");
		fail_msg("Slurm did not start: %s", last.out);
	}
}

/* Ends whatever still has this program for its parent; returns how many that were. */
static int end_children(void)
{
	int n = 0;
	DIR *proc = opendir("/proc");
	for (struct dirent *entry; proc && (entry = readdir(proc));) {
		char path[300], line[512] = "";
		snprintf(path, sizeof path, "/proc/%s/stat", entry->d_name);
		FILE *file = entry->d_name[0] >= '1' && entry->d_name[0] <= '9' ? fopen(path, "r") : NULL;
		const bool read = file && fgets(line, sizeof line, file);
		if (file)
			fclose(file);
		/* pid (name) state parent ... */
		const char *behind = read ? strrchr(line, ')') : NULL;
		int parent = 0;
		if (!behind || sscanf(behind, ") %*c %d", &parent) != 1 || parent != getpid())
			continue;
		const pid_t pid = (pid_t)atol(entry->d_name);
		kill(pid, SIGKILL);
		while (waitpid(pid, NULL, 0) < 0 && errno == EINTR)
			;
		n++;
	}
	if (proc)
		closedir(proc);
	return n;
}

static void stop_slurm(void)
{
	if (daemons[2])
		shell("scancel -u \"$(id -un)\"; i=0; until test -z \"$(squeue -h)\"; do i=$((i + 1)); test $i -lt 100 "
		      "|| exit "
		      "1; sleep 0.1; done");
	for (int i = DAEMONS - 1; i >= 0; i--)
		if (daemons[i])
			kill(daemons[i], SIGTERM);
	for (int i = 0; i < 100; i++) {
		bool running = false;
		for (int d = 0; d < DAEMONS; d++) {
			if (daemons[d] && waitpid(daemons[d], NULL, WNOHANG) != 0)
				daemons[d] = 0;
			running |= daemons[d] != 0;
		}
		if (!running)
			break;
		nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
	}
	/* What they left behind came to us. */
	while (end_children() > 0)
		;
}

static int set_up(void **state)
{
	char *top = realpath(".", NULL), *path;
	if (!top || setenv("TOP", top, 1) || asprintf(&path, "%s:/usr/sbin:/sbin", getenv("PATH")) < 0 ||
	    setenv("PATH", path, 1))
		return -1;
	free(top);
	free(path);
	/* Processes that lose their parent get us for one: none is left when we end. */
	prctl(PR_SET_CHILD_SUBREAPER, 1);
	if (enter_directory(state) || setenv("HOME", test_directory, 1) || chmod(test_directory, 0755))
		return -1;
	char configuration[256];
	snprintf(configuration, sizeof configuration, "%s/slurm.conf", test_directory);
	setenv("SLURM_CONF", configuration, 1);
	shell("\"$STDFIT\" synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3 --ks 0.5 && mkdir all && for f in a "
	      "b c "
	      "'d e' f; do ln a.binary \"all/$f.binary\" || exit; done; echo text >all/bad.binary; exec \"$STDFIT\" "
	      "all " CHEAP " -o whole.csv");
	return last.code == 1 ? 0 : -1;
}

static int tear_down(void **state)
{
	stop_slurm();
	return leave_directory(state);
}

static void expect_whole(const char *path)
{
	char *whole = without_seconds("whole.csv"), *found = without_seconds(path);
	assert_string_equal(found, whole);
	free(whole);
	free(found);
}

static void an_array_and_a_merge_make_the_whole(void **state)
{
	(void)state;
	if (!slurm_is_installed())
		skip_for_want_of("slurm-wlm or munge");
	start_slurm();
	/* The task with the bad file fails; the table is whole all the same. */
	shell("timeout 250 \"$TOP\"/scripts/slurm_fit.sh -n 3 -w -o fits.csv all " CHEAP);
	expect_code(0);
	expect_part(last.err, "job 1 fits 3 shares", __LINE__);
	expect_whole("fits.csv");
	shell("grep -l 'cannot read' fits.csv.parts/*.log && cat fits.csv.parts/merge.log");
	assert_string_equal(last.out, "fits.csv.parts/3-of-3.log\n");

	/* A task that dies: no table, and words on what is missing. Once more: only that share is fitted. */
	write_text("flaky", "#!/bin/sh\ncase \" $* \" in\n*' --shard 2/2 '*) test ! -e down || exit 9 ;;\nesac\n"
			    "echo \"$*\" >>calls\nexec \"$REAL\" \"$@\"\n");
	shell("chmod +x flaky; touch down; REAL=$STDFIT STDFIT=$PWD/flaky timeout 250 "
	      "\"$TOP\"/scripts/slurm_fit.sh -n 2 -c 2 -w -o again.csv all " CHEAP);
	expect_code(1);
	shell("cat again.csv.parts/merge.log; ls again.csv; grep -c -- '--threads 2 --resume' calls");
	expect_out("cannot read 'again.csv.parts/2-of-2.csv'");
	expect_out("\n1\n");
	assert_int_equal(access("again.csv", F_OK), -1);
	shell("cp again.csv.parts/1-of-2.csv before; rm down; REAL=$STDFIT STDFIT=$PWD/flaky timeout 250 "
	      "\"$TOP\"/scripts/slurm_fit.sh -n 2 -c 2 -w -o again.csv all " CHEAP);
	expect_code(0);
	shell("grep -v failed before >kept; n=$(wc -l <kept); test $n -gt 1 && test $(grep -cxFf kept "
	      "again.csv.parts/1-of-2.csv) -eq $n && test $(grep -cxFf kept again.csv) -eq $n");
	expect_code(0);
	expect_whole("again.csv");
}

static void slurm_fit_refuses_wrong_usage(void **state)
{
	(void)state;
	static const struct {
		const char *arguments, *message;
	} wrong[] = {
		{"all", "expected -o OUT.csv"},
		{"-o x.csv", "expected files or directories"},
		{"-o x.csv --ndf ggx all", "unknown option --"},
		{"-o x.csv -- --gray all", "expected files or directories before '--gray'"},
		{"-n 0 -o x.csv all", "expected a number of shares behind -n, found '0'"},
		{"-n x -o x.csv all", "found 'x'"},
		{"-c 1.5 -o x.csv all", "expected a number of processors behind -c"},
		{"-n", "expected an argument behind -n"},
	};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		char command[256];
		snprintf(command, sizeof command, "exec \"$TOP\"/scripts/slurm_fit.sh %s", wrong[i].arguments);
		shell(command);
		expect_code(2);
		expect_part(last.err, wrong[i].message, __LINE__);
		assert_int_equal(count_lines(last.err), 1);
	}
	shell("mkdir bare; PATH=$PWD/bare; exec /bin/sh \"$TOP\"/scripts/slurm_fit.sh -o x.csv all");
	expect_code(1);
	assert_string_equal(last.err, "slurm_fit.sh: sbatch is not installed here\n");
	shell("mkdir fake; printf '#!/bin/sh\\nexit 1\\n' >fake/sbatch; chmod +x fake/sbatch; PATH=$PWD/fake:$PATH "
	      "STDFIT=nothing "
	      "exec \"$TOP\"/scripts/slurm_fit.sh -o x.csv all");
	expect_code(1);
	expect_part(last.err, "cannot find the program 'nothing'", __LINE__);
	assert_int_equal(access("x.csv.parts", F_OK), -1);
}

/* As docs/robustness.md has it, but for the way to the other machines. */
static void parallel_over_ssh_makes_the_whole(void **state)
{
	(void)state;
	shell("command -v parallel && parallel --version | grep -q GNU");
	if (last.code)
		skip_for_want_of("parallel");
	/* A login sets SHELL, which parallel's far end runs its jobs with; here it may be unset. */
	write_text("ssh", "#!/bin/sh\necho \"$1\" >>hosts\nshift\ntest \"$1\" != -- || shift\n"
			  "SHELL=/bin/sh exec sh -c \"$*\"\n");
	shell("chmod +x ssh; PATH=$(dirname \"$STDFIT\"):$PATH PARALLEL_SSH=$PWD/ssh parallel -S one,two -j1 --wd "
	      "\"$PWD\" "
	      "'stdfit all " CHEAP " --shard {}/4 --resume -q -o part-{}.csv' ::: 1 2 3 4 </dev/null; test $? -eq 1 && "
	      "\"$STDFIT\" merge part-?.csv all -o parallel.csv");
	expect_code(0);
	expect_whole("parallel.csv");
	shell("sort -u hosts");
	assert_string_equal(last.out, "one\ntwo\n");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_array_and_a_merge_make_the_whole),
		cmocka_unit_test(slurm_fit_refuses_wrong_usage),
		cmocka_unit_test(parallel_over_ssh_makes_the_whole),
	};
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
