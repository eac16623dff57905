/* runner.c - the tests of heatdiff.h and of the tools' headers, in one program

       cc -std=c99 tests/runner.c -I. -lm -o runner && ./runner

   runner [FILTER...]   the group of that name, else groups whose name contains one of the filters; none: all
   runner --shard N     groups of part N of 6; the sixth is memory that fails
   runner --list        names of the groups
   runner --traps       the first invalid operation, division by zero or overflow ends the run with SIGFPE (glibc, x86)
   runner --tmp DIR     an existing directory for files that tests write; default: one made here and removed at the end

   A failed check says file, line and what it saw, and the run goes on. Exit status 1 when any check failed. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"    /* headers of helpers: not all are used here */
#endif

#include <errno.h>
#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <sys/stat.h>
#include <sys/types.h>
#ifdef _WIN32
#include <direct.h>
#include <io.h>
#include <process.h>
#else
#include <dirent.h>
#include <unistd.h>
#endif

#include "traps.h"
#ifndef TEST_LINKED                 /* the implementation is in another file of the program */
#include "guard.h"
#define HEATDIFF_IMPLEMENTATION
#endif
#include "../heatdiff.h"
#ifdef _WIN32
#undef near                          /* windows.h has them as macros */
#undef far
#endif

/* ---- checks ---- */

static int64_t test_passed, test_failed, test_failed_in_group;
static int test_holds;
enum { TEST_MOST_MESSAGES = 40 };

static void test_count(int ok) {
    if (ok) test_passed++;
    else {
        test_failed++;
        test_failed_in_group++;
    }
}

#if defined(__GNUC__) || defined(__clang__)
__attribute__((format(printf, 5, 6)))
#endif
static int test_check_msg(int ok, const char *file, int line, const char *what, const char *fmt, ...) {
    va_list args;
    TRAPS_ON;                                    /* what follows cond in CHECK_MSG may be no number */
    test_count(ok);
    if (ok || test_failed_in_group > TEST_MOST_MESSAGES) return ok;
    printf("%s:%d: %s\n    ", file, line, what);
    va_start(args, fmt);
    vprintf(fmt, args);
    va_end(args);
    printf("\n");
    if (test_failed_in_group == TEST_MOST_MESSAGES) printf("    (further failures of this group are counted only)\n");
    fflush(stdout);
    return ok;
}

static int test_check(int ok, const char *file, int line, const char *what) {
    test_count(ok);
    if (!ok && test_failed_in_group <= TEST_MOST_MESSAGES) printf("%s:%d: %s\n", file, line, what);
    fflush(stdout);
    return ok;
}

/* Both are expressions that say whether the check held. */
#define CHECK(cond) test_check((cond) != 0, __FILE__, __LINE__, #cond)
#define CHECK_MSG(cond, ...) \
    (test_holds = (cond) != 0, TRAPS_OFF, test_check_msg(test_holds, __FILE__, __LINE__, #cond, __VA_ARGS__))

/* Arithmetic is that of doubles. Not so on x87 registers, which keep more digits for as long as they hold a number: sums that round in a
 * way of their own, and the same bits in another order, are not promised there (see Limits in heatdiff.h). */
#if !defined(FLT_EVAL_METHOD) || FLT_EVAL_METHOD == 0
#define TEST_EXACT 1
#else
#define TEST_EXACT 0
#endif

/* ---- a directory for files ---- */

/* Bytes of the longest file names. Windows limits whole paths, to 259, with the folder of the tests among them. */
#ifdef _WIN32
enum { TEST_LONGEST_NAME = 110 };
#else
enum { TEST_LONGEST_NAME = 255 };
#endif

static char test_tmp_path[512];
static int test_tmp_made;

static int test_make_dir(const char *path) {
#ifdef _WIN32
    return _mkdir(path) == 0;
#else
    return mkdir(path, 0700) == 0;
#endif
}

static const char *test_tmp_dir(void) {
    int i;
#ifdef _WIN32
    const int pid = _getpid();
#else
    const int pid = (int)getpid();
#endif
    for (i = 0; !test_tmp_path[0] && i < 100; i++) {
        snprintf(test_tmp_path, sizeof test_tmp_path, "./heatdiff-test-tmp-%d-%d", pid, i);
        test_tmp_made = test_make_dir(test_tmp_path);
        if (!test_tmp_made) test_tmp_path[0] = 0;
    }
    if (!test_tmp_path[0]) {
        fprintf(stderr, "runner: no directory for files can be made here; give one with --tmp\n");
        exit(2);
    }
    return test_tmp_path;
}

/* What tests left behind goes with the directory, but only if it was made here. */
static void test_tmp_remove(void) {
#ifdef _WIN32
    if (test_tmp_made) _rmdir(test_tmp_path);
#else
    DIR *dir = test_tmp_made ? opendir(test_tmp_path) : NULL;
    struct dirent *entry;
    char path[1024];
    while (dir && (entry = readdir(dir)) != NULL) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        if (snprintf(path, sizeof path, "%s/%s", test_tmp_path, entry->d_name) < (int)sizeof path) remove(path);
    }
    if (dir) closedir(dir);
    if (test_tmp_made) rmdir(test_tmp_path);
#endif
}

/* ---- groups ---- */

#include "dense.h"
#include "../tools/shapes.h"
#include "at.h"
#include "../tools/trials.h"
#include "kit.h"
#include "cases.h"
#include "test_meshio.h"
#include "test_base.h"
#include "calls.h"
#include "test_sparse.h"
#include "test_operators.h"
#include "test_rational.h"
#include "test_shared.h"
#include "test_krylov.h"
#include "test_platform.h"
#ifndef TEST_CORE                   /* nothing but a core, as tools/portability.sh runs on slow processors */
#include "test_intrinsic.h"
#include "test_heat.h"
#include "test_points.h"
#include "test_assembly.h"
#include "test_doors.h"
#include "test_robust.h"
#include "test_polygon.h"
#include "test_ldl.h"
#include "test_order.h"
#include "test_engines.h"
#include "test_threads.h"
#include "test_geodesic.h"
#include "test_diagonal.h"
#include "test_operators_all.h"
#include "test_picture.h"
#include "test_bounds.h"
#include "test_moving.h"
#include "test_view.h"
#include "test_estimate.h"
#include "test_spectrum.h"
#include "test_borders.h"
#include "test_large_t.h"
#include "test_adjoints.h"
#include "test_signatures.h"
#include "test_filters.h"
#include "test_sources.h"
#include "test_geodesic_all.h"
#include "test_lengths.h"
#include "test_deep.h"
#include "test_failures.h"
#include "test_cases.h"
#include "test_local.h"
#endif

/* shard: groups that ctest runs together. Two of them CI runs under sanitizers alone: groups whose cases are all the same there, and memory
 * that fails. TEST_BRIEF: without groups that take long under sanitizers, and whose code the others run as well. */
enum { TEST_SAME = 5, TEST_MEMORY = 6 };
typedef struct test_group { const char *name; void (*run)(void); int shard; } test_group;

static const test_group test_groups[] = {
    {"platform", test_platform, TEST_SAME}, {"rational", test_rational, TEST_SAME}, {"krylov", test_krylov, TEST_SAME},
    {"base", test_base, TEST_SAME}, {"sparse", test_sparse, TEST_SAME}, {"meshio", test_meshio, TEST_SAME},
#ifndef TEST_CORE
    {"lengths", test_lengths, TEST_SAME}, {"view", test_view, TEST_SAME}, {"moving", test_moving, TEST_SAME},
    {"doors", test_doors, TEST_SAME}, {"shared", test_shared, TEST_SAME}, {"order", test_order, TEST_SAME},
    {"picture", test_picture, TEST_SAME}, {"intrinsic", test_intrinsic, TEST_SAME}, {"operators", test_operators, TEST_SAME},
    {"polygon", test_polygon, TEST_SAME}, {"assembly", test_assembly, TEST_SAME},
    {"heat", test_heat, 1}, {"cases", test_cases, 1}, {"adjoints", test_adjoints, 1}, {"everywhere", test_operators_all, 1},
    {"borders", test_borders, 1}, {"threads", test_threads, 1}, {"local", test_local, 2},
    {"failures", test_failures, TEST_MEMORY}, {"robust", test_robust, TEST_MEMORY},
#ifndef TEST_BRIEF
    {"bounds", test_bounds, 1}, {"signatures", test_signatures, 1}, {"filters", test_filters, 1}, {"engines", test_engines, 2},
    {"estimate", test_estimate, 2}, {"points", test_points, 3}, {"diagonal", test_diagonal, 3}, {"spectrum", test_spectrum, 3},
    {"large_t", test_large_t, 3}, {"deep", test_deep, 4}, {"geodesic", test_geodesic_all, 4}, {"ldl", test_ldl, 4},
    {"sources", test_sources, 4},
#endif
#endif
};

enum { TEST_GROUPS = sizeof test_groups / sizeof *test_groups };

/* `order` is a group, and borders is not meant. */
static int test_is_meant(const test_group *group, const char *filter) {
    int k;
    for (k = 0; k < TEST_GROUPS; k++)
        if (strcmp(test_groups[k].name, filter) == 0) return group == test_groups + k;
    return strstr(group->name, filter) != NULL;
}

static void test_run(const test_group *group) {
    const int64_t passed = test_passed, failed = test_failed;
    const clock_t start = clock();
    test_failed_in_group = 0;
    group->run();
    kit_release(0);
    printf("%-12s %8lld passed %6lld failed %8.2f s\n", group->name, (long long)(test_passed - passed), (long long)(test_failed - failed),
           (double)(clock() - start) / CLOCKS_PER_SEC);
    fflush(stdout);
}

int main(int argc, char **argv) {
    int i, k, filters = 0, ran = 0, shard = 0;
#if defined(HEATDIFF_IMPLEMENTATION) && HDI_THREADS
    GUARD_THREADS(sizeof(hd_threads));
#endif
    for (i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--list") == 0) {
            for (k = 0; k < TEST_GROUPS; k++) printf("%s\n", test_groups[k].name);
            return 0;
        }
        if (strcmp(argv[i], "--traps") == 0) {
            if (!test_traps_start()) {
                fprintf(stderr, "runner: there are no traps here\n");
                return 2;
            }
            argv[i] = NULL;
        } else if (strcmp(argv[i], "--tmp") == 0 && i + 1 < argc) {
            if (strlen(argv[i + 1]) >= sizeof test_tmp_path) {
                fprintf(stderr, "runner: the name of the directory is too long\n");
                return 2;
            }
            strcpy(test_tmp_path, argv[i + 1]);
            argv[i] = argv[i + 1] = NULL;
            i++;
        } else if (strcmp(argv[i], "--shard") == 0 && i + 1 < argc && atoi(argv[i + 1]) >= 1 && atoi(argv[i + 1]) <= TEST_MEMORY) {
            shard = atoi(argv[i + 1]);
            argv[i] = argv[i + 1] = NULL;
            i++;
        } else if (argv[i][0] == '-') {
            fprintf(stderr, "usage: runner [--list] [--traps] [--tmp DIR] [--shard N] [FILTER...]\n");
            return 2;
        } else {
            filters++;
        }
    }
    for (k = 0; k < TEST_GROUPS; k++) {
        int wanted = filters == 0;
        for (i = 1; i < argc; i++) wanted |= argv[i] && test_is_meant(test_groups + k, argv[i]);
        if (!wanted || (shard && test_groups[k].shard != shard)) continue;
        test_run(test_groups + k);
        ran++;
    }
    test_tmp_remove();
    if (!TEST_EXACT) printf("arithmetic is not that of doubles (FLT_EVAL_METHOD): bits are compared up to rounding\n");
    if (!ran) {
        fprintf(stderr, "runner: no group has such a name\n");
        return 2;
    }
    printf("%lld passed, %lld failed\n", (long long)test_passed, (long long)test_failed);
    return test_failed > 0;
}
