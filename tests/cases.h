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
    trial_subject subject;       /* of the last shape, operator and scale */
    trial last;
    int asked, refused, warned;
} case_run;

static int64_t cases_wrong(void) {
    int64_t sum = 0;
    int k;
    for (k = 0; k < trial_n_rows; k++) sum += trial_rows[k].below + trial_rows[k].below_b + trial_rows[k].below_relative + trial_rows[k].bad + trial_rows[k].useless;
    return sum;
}

static int64_t cases_warned(void) {
    int64_t sum = 0;
    int k;
    for (k = 0; k < trial_n_rows; k++) sum += trial_rows[k].warned;
    for (k = 0; k < QUERY_COUNT; k++) sum += trial_counts[k].unbounded;
    return sum;
}

static void cases_one(case_run *run, const char *text) {
    trial c = trial_parse(text);
    const int64_t wrong = cases_wrong(), warned = cases_warned();
    int64_t refused, compared;
    run->asked++;
    if (!run->subject.lap || strcmp(c.shape, run->last.shape) != 0 || strcmp(c.op, run->last.op) != 0 || c.scale < run->last.scale || c.scale > run->last.scale) {
        trial_subject_free(&run->subject);
        if (!trial_subject_make(&run->subject, &c, 0)) {
            run->refused++;
            if (!run->row->refused) CHECK_MSG(0, "%s: there is no such pair", text);
            return;
        }
    }
    run->last = c;
    refused = trial_counts[c.query].refused;
    compared = trial_counts[c.query].compared;
    trial_largest = 0;
    trial_run(&run->subject, &c, 0);
    run->refused += trial_counts[c.query].refused > refused;
    run->warned += cases_warned() > warned;
    if (!CHECK_MSG(cases_wrong() == wrong, "%s: not within its bounds", text) ||
        !CHECK_MSG(trial_counts[c.query].refused == refused || run->refused <= run->row->refused, "%s: no answer", text) ||
        !CHECK_MSG(trial_counts[c.query].refused > refused || trial_counts[c.query].compared > compared, "%s: nothing compared", text) ||
        !CHECK_MSG(cases_warned() == warned || run->warned <= run->row->warned, "%s: a warning, bound %g", text, trial_largest) ||
        !CHECK_MSG(cases_warned() > warned || trial_largest <= (run->row->bound > 0 ? run->row->bound : 0.01), "%s: bound %g", text, trial_largest)) {
        trial_verbose = 1;
        trial_run(&run->subject, &c, 0);
        trial_verbose = 0;
    }
}

/* The first choice a|b|c of the text is taken in turn, then the next. */
static void cases_expand(case_run *run, const char *text) {
    const char *bar = strchr(text, '|'), *from = bar, *to = text, *end;
    char one[400];
    if (!bar) {
        cases_one(run, text);
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
    for (k = 0; k < n; k++) {
        case_run run;
        memset(&run, 0, sizeof run);
        run.row = rows + k;
        cases_expand(&run, rows[k].cases);
        trial_subject_free(&run.subject);
        CHECK_MSG(run.refused <= run.row->refused && run.warned <= run.row->warned, "%s: of %d, %d refused, %d without a good bound", rows[k].cases,
                  run.asked, run.refused, run.warned);
    }
}

#define CASES(rows) cases_run(rows, (int)(sizeof(rows) / sizeof *(rows)))

#endif
