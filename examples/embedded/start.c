/* start.c - what a Cortex-M7 needs before main, and its output: see heat.c

   Text goes to whoever debugs the board, by semihosting: QEMU prints it. The stack is painted before main, so
   that its deepest use can be seen. */

#include <stddef.h>
#include <stdint.h>

extern uint32_t code_end[], data_load[], data_begin[], data_end[], bss_begin[], bss_end[];
extern uint32_t stack_end[], stack_begin[];      /* stack_end is the lower one */

int main(void);
void reset(void);
void fault(void);
void board_write(const char *text);
size_t board_code_bytes(void);
size_t board_stack_bytes(void);

#define PAINT 0x5ca1ab1eu

enum { SEMI_WRITE0 = 0x04, SEMI_EXIT = 0x20, SEMI_EXITED = 0x20026, SEMI_FAULT = 0x20023 };

static void semihosting(uint32_t operation, const void *argument) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

static void leave(uint32_t reason, uint32_t status) {
    const uint32_t why[2] = {reason, status};
    semihosting(SEMI_EXIT, why);
    for (;;) { }
}

void board_write(const char *text) { semihosting(SEMI_WRITE0, text); }

size_t board_code_bytes(void) {
    return (size_t)code_end + (size_t)((char *)data_end - (char *)data_begin);
}

size_t board_stack_bytes(void) {
    const uint32_t *p = stack_end;
    while (p < stack_begin && *p == PAINT) p++;
    return (size_t)((const char *)stack_begin - (const char *)p);
}

void reset(void) {
    volatile uint32_t *const cpacr = (volatile uint32_t *)0xe000ed88;    /* who may use the FPU */
    uint32_t *p, *q;
    *cpacr |= 0xfu << 20;
    __asm__ volatile("dsb\n isb");
    for (p = data_begin, q = data_load; p < data_end; ) *p++ = *q++;
    for (p = bss_begin; p < bss_end; ) *p++ = 0;
    for (p = stack_end; p < (uint32_t *)__builtin_frame_address(0) - 16; ) *p++ = PAINT;
    leave(SEMI_EXITED, (uint32_t)main());
}

void fault(void) {
    board_write("fault\n");
    leave(SEMI_FAULT, 1);
}

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    stack_begin, (const void *)reset, (const void *)fault, (const void *)fault, (const void *)fault,
    (const void *)fault, (const void *)fault, 0, 0, 0, 0, (const void *)fault, (const void *)fault, 0,
    (const void *)fault, (const void *)fault};
