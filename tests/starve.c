/* starve.c - a library to preload: one allocation of a program fails, and all others succeed (glibc only)

   STARVE_AT=K       allocation number K, counted from 1, finds no memory
   STARVE_LIST=FILE  none does; FILE gets a line for each, with the places in the program that it was called from */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);

enum { DEPTH = 7, OWN = 2 };         /* of the calls that are listed; the first are of this file */

static long count, starve_at;
static int counting, list = -1;

/* For coverage.py, which counts on memory at the end. */
void starve_end(void);
void starve_end(void) { counting = 0; }

__attribute__((constructor)) static void starve_begin(void)
{
    const char *at = getenv("STARVE_AT"), *file = getenv("STARVE_LIST");
    if (file) list = open(file, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (at) starve_at = atol(at);
    counting = at || list >= 0;
}

/* Addresses are listed from where the program or library begins, which changes from run to run. */
static void starve_list(void)
{
    void *stack[DEPTH];
    Dl_info where;
    const int n = backtrace(stack, DEPTH);
    int i;
    for (i = OWN; i < n; i++)
        if (dladdr(stack[i], &where)) dprintf(list, "%lx ", (long)((char *)stack[i] - (char *)where.dli_fbase));
    dprintf(list, "\n");
}

static int starve(void)
{
    if (!counting) return 0;
    count++;
    if (list >= 0) {
        counting = 0;                /* what allocates here is not counted */
        starve_list();
        counting = 1;
    }
    if (count != starve_at) return 0;
    errno = ENOMEM;
    return 1;
}

void *malloc(size_t size) { return starve() ? NULL : __libc_malloc(size); }
void *calloc(size_t n, size_t size) { return starve() ? NULL : __libc_calloc(n, size); }
void *realloc(void *block, size_t size) { return starve() ? NULL : __libc_realloc(block, size); }
