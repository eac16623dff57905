/* cases.h - rows of cases for the groups, in the words of tools/trials.h

   "shape=sphere/2 op=fem|vor query=column method=auto|direct th=0.1|10" is eight cases: what stands between | is taken in turn. Each answer is
   held against the truth by its own bounds, as in tools/bounds.c; long double takes the place of numbers of 113 bits. A row also says how good
   the answers must be, how many of the cases may be refused, and how many may come with a warning or without a finite bound: none, unless it says so. */

#ifndef CASES_H
#define CASES_H

typedef struct case_row {
    const char *cases;
    double bound;                /* no reported bound is larger; 0: 0.01 */
    int refused, warned;
} case_row;

/* What has come of a row so far. */
typedef struct case_run {
    const case_row *row;
    int seen, asked, refused, warned;
    double largest;              /* bound of an answer without a warning */
} case_run;

/* The last subjects, for the next rows of the same table: of a shape, an operator and a scale. */
enum { CASE_SUBJECTS = 6 };
typedef struct case_subject { trial of; trial_subject s; } case_subject;
static case_subject case_subjects[CASE_SUBJECTS];
static int case_oldest;

static trial_subject *cases_subject(const trial *c) {
    case_subject *x;
    int k;
    for (k = 0; k < CASE_SUBJECTS; k++) {
        x = case_subjects + k;
        if (x->s.lap && strcmp(c->shape, x->of.shape) == 0 && strcmp(c->op, x->of.op) == 0 && !(c->scale < x->of.scale || c->scale > x->of.scale)) return &x->s;
    }
    x = case_subjects + case_oldest;
    case_oldest = (case_oldest + 1) % CASE_SUBJECTS;
    trial_subject_free(&x->s);
    x->of = *c;
    return trial_subject_make(&x->s, c, 0) ? &x->s : NULL;
}

static int64_t cases_wrong(void) {
    int64_t sum = 0;
    int k;
    for (k = 0; k < trial_n_rows; k++) sum += trial_rows[k].below + trial_rows[k].below_b + trial_rows[k].below_relative + trial_rows[k].bad + trial_rows[k].useless;
    return sum;
}

static int64_t cases_statuses(void) {
    int64_t sum = 0;
    int k;
    for (k = 0; k < trial_n_rows; k++) sum += trial_rows[k].warned;
    return sum;
}

static int64_t cases_warned(void) {
    int64_t sum = cases_statuses();
    int k;
    for (k = 0; k < QUERY_COUNT; k++) sum += trial_counts[k].unbounded;
    return sum;
}

/* One case in so many, where each takes long: under sanitizers, which look at each access and not at values, and for tools/mutate.py. */
#if defined(__SANITIZE_ADDRESS__) || defined(GUARD_OFF) || defined(CASES_SPARSE)
enum { CASES_STRIDE = 7, CASES_FEW = 1 };
#else
enum { CASES_STRIDE = 1, CASES_FEW = 0 };
#endif

static void cases_one(case_run *run, const char *text) {
    trial c = trial_parse(text);
    const int64_t wrong = cases_wrong(), warned = cases_warned(), statuses = cases_statuses();
    trial_subject *subject = cases_subject(&c);
    int64_t refused, compared;
    int bounded;
    run->asked++;
    if (!subject) {
        run->refused++;
        if (!run->row->refused) CHECK_MSG(0, "%s: there is no such pair", text);
        return;
    }
    refused = trial_counts[c.query].refused;
    compared = trial_counts[c.query].compared;
    trial_largest = 0;
    trial_run(subject, &c, 0);
    run->refused += trial_counts[c.query].refused > refused;
    run->warned += cases_warned() > warned;
    bounded = cases_statuses() == statuses && trial_largest <= DBL_MAX;    /* no warning; the bound of single values may be infinite */
    if (bounded) run->largest = fmax(run->largest, trial_largest);
    if (!CHECK_MSG(cases_wrong() == wrong, "%s: not within its bounds", text) ||
        !CHECK_MSG(trial_counts[c.query].refused == refused || run->refused <= run->row->refused, "%s: no answer", text) ||
        !CHECK_MSG(trial_counts[c.query].refused > refused || trial_counts[c.query].compared > compared, "%s: nothing compared", text) ||
        !CHECK_MSG(cases_warned() == warned || run->warned <= run->row->warned, "%s: a warning, bound %g", text, trial_largest) ||
        !CHECK_MSG(!bounded || trial_largest <= (run->row->bound > 0 ? run->row->bound : 0.01), "%s: bound %g", text, trial_largest)) {
        trial_verbose = 1;
        trial_run(subject, &c, 0);
        trial_verbose = 0;
    }
}

/* The first choice a|b|c of the text is taken in turn, then the next. */
static void cases_expand(case_run *run, const char *text) {
    const char *bar = strchr(text, '|'), *from = bar, *to = text, *end;
    char one[400];
    if (!bar) {
        if (run->seen++ % CASES_STRIDE == 0) cases_one(run, text);
        return;
    }
    while (from > text && from[-1] != '=') from--;
    end = from + strcspn(from, " ");
    for (to = from; to < end; to += *to == '|') {
        const size_t size = strcspn(to, "| ");
        snprintf(one, sizeof one, "%.*s%.*s%s", (int)(from - text), text, (int)size, to, end);
        cases_expand(run, one);
        to += size;
    }
}

static void cases_run(const case_row *rows, int n) {
    int k;
    trial_serial.n_threads = 1;
    for (k = 0; k < n; k++) {
        case_run run;
#ifdef CASES_SHOW
        const clock_t start = clock();
#endif
        memset(&run, 0, sizeof run);
        run.row = rows + k;
        cases_expand(&run, rows[k].cases);
        CHECK_MSG(run.refused <= run.row->refused && run.warned <= run.row->warned, "%s: of %d, %d refused, %d without a good bound", rows[k].cases,
                  run.asked, run.refused, run.warned);
#ifdef CASES_SHOW                                /* what a new row comes to */
        printf("%s: of %d, %d refused, %d without a good bound; bounds up to %g; %.2f s\n", rows[k].cases, run.asked, run.refused, run.warned, run.largest,
               (double)(clock() - start) / CLOCKS_PER_SEC);
#endif
    }
    for (k = 0; k < CASE_SUBJECTS; k++) trial_subject_free(&case_subjects[k].s);
}

/* ---- the truth for what no query of a case asks ---- */

/* A pair with its truth, and room for answers. */
typedef struct case_truth { trial c; trial_subject s; trial_work w; } case_truth;

static void case_truth_free(void *p) {
    case_truth *x = (case_truth *)p;
    free(x->w.want);
    free(x->w.off);
    free(x->w.gw);
    free(x->w.gw_off);
    trial_subject_free(&x->s);
    free(x);
}

/* Of a shape and an operator: want, as truth_filter_fill or trial_filter_for and then trial_want_... fill it. Freed with the rest. */
static trial_work *case_truth_of(const char *text) {
    case_truth *x = KIT_NEW(case_truth, 1);
    int64_t most;
    kit_list[kit_count - 1].destroy = case_truth_free;
    x->c = trial_parse(text);
    if (!trial_subject_make(&x->s, &x->c, 0)) truth_stop(text);
    most = (x->s.lap->L.nnz > x->s.lap->n ? x->s.lap->L.nnz : x->s.lap->n) + 64;
    x->w.s = &x->s;
    x->w.c = &x->c;
    x->w.T = &x->s.exact;
    x->w.text = text;
    x->w.want = TRUTH_NEW(quad, most);
    x->w.off = TRUTH_NEW(double, most);
    x->w.gw = TRUTH_NEW(quad, x->s.lap->n_active);
    x->w.gw_off = TRUTH_NEW(double, x->s.lap->n_active);
    return &x->w;
}

#define CASES(rows) cases_run(rows, (int)(sizeof(rows) / sizeof *(rows)))

#endif
