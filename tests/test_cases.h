/* test_cases.h - what every query answers on every kind of shape, by every method, held against the truth

   Cases that once found a fault are in tools/bounds.c, with truths of 113 bits. */

#ifndef TEST_CASES_H
#define TEST_CASES_H

static const case_row cases_queries[] = {
    {"shape=sphere/2 op=fem|vor|cot|poly|fem+id|vor+tuft query=column|apply|from method=auto|direct|krylov|iterative th=0.1|10", 1e-5, 0, 0},
    {"shape=sphere/2 op=fem|vor|cot|poly|fem+id|vor+tuft query=entries method=auto|direct|krylov|iterative th=0.1|10", 2e-4, 0, 0},
    {"shape=sphere/2 op=fem+held|vor query=pairs|diagonal|distance|distance_from method=auto|direct kernel=operator|symmetric th=0.1|10", 2e-5, 0, 0},
    {"shape=points/40/0/1 op=vexp|exp|tuft query=column|apply|diagonal|distance th=1", 1e-5, 0, 0},
    {"shape=cycle/20 op=I|diag|tri|near query=column|derivative|adjoint|filter th=1", 1e-4, 0, 1},
};

static void test_cases(void) {
    CASES(cases_queries);
}

#endif
