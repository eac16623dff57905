/* guard.h - memory for heatdiff.h that notices what is written beside a block, in any build, by any compiler

   Included before the implementation. A block ends where the library's own array ends, but for a byte: it aligns its arrays, and rounds up what
   it asks for. A new block and what stands behind it hold numbers so large that an answer made of them is wrong, or the program crashes.
   Sanitizers see more; with them this stays out of the way. */

#ifndef GUARD_H
#define GUARD_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer)
#define GUARD_OFF 1
#endif
#endif

#if !defined(__SANITIZE_ADDRESS__) && !defined(GUARD_OFF)

enum {
    GUARD_BYTES = 64,            /* after each block */
    GUARD_FILL = 0x7E,           /* in them, and in a new block: numbers above 1e300, indices above 2e9 */
    GUARD_ALIGN = 64,            /* HDI_ALIGN: the library's arrays begin at multiples of this, ... */
    GUARD_HEADER = 16            /* ... HDI_HEADER: after so many bytes of its own */
};

typedef struct guard_head { char *raw; size_t size; } guard_head;

/* The size of the library's threads, which are no array: they stand where malloc would put them. */
static size_t guard_threads;
#define GUARD_THREADS(size) (guard_threads = (size))

/* How many of them are in use, where threads can share a counter. */
static int guard_in_use;
#define GUARD_IN_USE guard_in_use
#if defined(__GNUC__) || defined(__clang__)
#define GUARD_COUNT(by) ((void)__atomic_add_fetch(&guard_in_use, by, __ATOMIC_ACQ_REL))
#else
#define GUARD_COUNT(by) ((void)(by))
#endif

/* At an address for which the library leaves the most room before its array, and with that a byte behind it. */
static void *guard_malloc(size_t size) {
    const size_t before = 2 * GUARD_ALIGN;
    guard_head head;
    char *p;
    if (size > (size_t)-1 - before - GUARD_BYTES) return NULL;
    head.raw = (char *)malloc(size + before + GUARD_BYTES);
    head.size = size;
    if (!head.raw) return NULL;
    p = head.raw + before - ((size_t)head.raw + GUARD_HEADER) % GUARD_ALIGN + 1 - GUARD_ALIGN;
    if (p < head.raw + (int)sizeof head) p += GUARD_ALIGN;
    if (size == guard_threads) {
        p = head.raw + before;
        GUARD_COUNT(1);
    }
    memcpy(p - sizeof head, &head, sizeof head);
    memset(p, GUARD_FILL, size + GUARD_BYTES);
    return p;
}

static void guard_free(void *block) {
    guard_head head;
    char *p = (char *)block;
    int i;
    if (!p) return;
    memcpy(&head, p - sizeof head, sizeof head);
    for (i = 0; i < GUARD_BYTES; i++) {
        if ((unsigned char)p[head.size + (size_t)i] == GUARD_FILL) continue;
        fprintf(stderr, "guard.h: byte %d behind a block of %lu bytes was written to\n", i, (unsigned long)head.size);
        abort();
    }
    if (head.size == guard_threads) GUARD_COUNT(-1);
    free(head.raw);
}

#define HEATDIFF_MALLOC(size) guard_malloc(size)
#define HEATDIFF_FREE(p) guard_free(p)

#else
#define GUARD_THREADS(size) ((void)(size))
#define GUARD_IN_USE 0
#endif

#endif
