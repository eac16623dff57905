/* traps.h - the first invalid operation, division by zero or overflow ends the run with SIGFPE (glibc, x86)

   The library does not compute with NaN, divide by zero or overflow: it tests its input first. With --traps each of these
   ends the run. Tests that compare with NaN or infinity themselves, and the calls whose sums overflow and are checked
   afterwards, stand between TRAPS_OFF and TRAPS_ON. Threads have the traps of the thread that starts them. */

#ifndef TRAPS_H
#define TRAPS_H

#include <stdlib.h>                          /* it says which library of C this is */

#if defined(__GLIBC__) && defined(__x86_64__) && !defined(__cplusplus)
#include <fenv.h>
extern int feenableexcept(int excepts);     /* glibc declares them under _GNU_SOURCE only */
extern int fedisableexcept(int excepts);
#define TEST_TRAPS (FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW)

static int test_traps, test_traps_off;      /* asked for; how often TRAPS_OFF without TRAPS_ON */

static void test_trap(int on) {
    test_traps_off += on ? -1 : 1;
    if (!test_traps || test_traps_off != !on) return;
    if (!on) fedisableexcept(TEST_TRAPS);
    feclearexcept(TEST_TRAPS);
    if (on) feenableexcept(TEST_TRAPS);
}

static int test_traps_start(void) {
    test_traps = 1;
    return feenableexcept(TEST_TRAPS) != -1;
}
#else
static void test_trap(int on) { (void)on; }
static int test_traps_start(void) { return 0; }
#endif

#define TRAPS_OFF test_trap(0)
#define TRAPS_ON test_trap(1)

#endif
