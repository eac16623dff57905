/* bounds.c - the error bounds that heatdiff.h reports, held against the true errors

   Build and run from the project's folder:

       gcc -O2 tools/bounds.c -o bounds -lquadmath -lm && ./bounds --count 100000

   Small shapes, good and bad, are asked everything that the library answers, by every method. The truth is
   that of the exact doubles in the pair (L, B): all eigenpairs by dense elimination and QL in numbers of 192
   bits, then sums in numbers of 113 bits. Where the library defines the rows of L to sum to zero, so do we:
   the diagonal is minus the sum of the others, exactly. (A caller's own L whose rows sum to more than their
   rounding is taken as it is.)

   bounds [--quick] [--count N] [--seed S] [--query NAME] [--shape NAME] [--method NAME] [--op NAME]
          [--table ROWS:COLUMNS] [--csv FILE]
   bounds --case "shape=grid/9/6 op=fem query=column t=1e-3 ..."
   bounds --self

   --quick    the small version: the fixed cases and some thousand comparisons on the smaller shapes
   --count    comparisons, in all; default 1000000
   --seed     of the cases that are drawn; default 1
   --query, --shape, --method, --op   only cases whose query, shape, method or operator contains this
   --table    also prints a Markdown table with these rows and columns, each shape, op, t, query or method.
              A cell says how many answers were compared, the largest true error / bound and its median. May
              be given several times
   --csv      a line for every comparison goes to this file
   --case     one case, as the table's footnotes and the lines of the file name it; what is left out is the
              default. Everything about it is printed
   --shrink   bounds are multiplied by this before the comparison: below one, the comparison must find fault
   --self     only the checks of this program itself, which every run begins with

   A comparison is one column of an answer (or one list of entries or pairs) against the bounds
   reported for it. The table's columns:
     compared   comparisons made
     errors     calls that ended with an honest error (status < 0), not compared
     warned     comparisons whose status was HD_WARN_ACCURACY
     below      how often error_bound was smaller than the truth by more than the truth's own error: must be 0
     below B    the same of error_bound_b, in the norm of B
     below rel  the same of error_relative, of each value relative to itself
     useless    HD_OK together with a bound above 0.01 or not finite: must be 0
     bad        a value or a bound that is not a number where the truth is one: must be 0
     worst      the largest true error / bound, of the three, without what the truth itself may be wrong by
     median     of true error / error_bound, and of true error / error_bound_b
     stored     for every eighth case on a shape with rows that sum to zero: how often error_bound is below
   the truth of L as it is stored, rounded diagonal included (only told, not a fault) The exit status is 1
   when any count that must be 0 is not, or when fewer cases are answered, or have finite bounds, than the floors of
   a query say.

   The truth's own error: eigenvalues are good to n 2^-178 of the largest, terms to 2^-104 of themselves; what
   that makes of each value is summed up beside it and allowed for. It matters where a bound is zero or next
   to nothing is left of the answer; the last line says how often. */

#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wunused-function"    /* headers of helpers: not all are used here */
#pragma GCC diagnostic ignored "-Wpedantic"           /* constants of 113 bits */
#endif

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#define TRUTH_QUAD
#include "trials.h"

#include <time.h>

/* The programs that once found bounds too small, as far as shapes of this size show them. */
static const char *const fixed_cases[] = {
    /* heat that steps of an iteration do not bring to the heaviest vertices */
    "shape=tree/12/13 op=mass16 query=adjoint kernel=symmetric tol=1e-06 t=1.0671480976020037e-13 field=delta seed=969656",
    "shape=tree/12/14 op=mass16 query=adjoint kernel=symmetric method=krylov tol=1e-13 t=2.1931916859483007e-20 field=delta seed=505400",
    "shape=tree/12/15 op=mass16 query=adjoint method=iterative solver=lanczos tol=1e-06 t=1.1041697244236753e-07 field=delta seed=1967",
    "shape=tree/12/16 op=mass2 query=adjoint method=iterative t=1.7184737090578872e-13 field=delta seed=551821",
    /* constants with a ripple, which have next to no derivative */
    "shape=sphere/2 op=fem query=derivative method=iterative th=1 field=level seed=20",
    "shape=sphere/2 op=fem query=derivative method=iterative solver=minres th=1 field=level seed=30",
    "shape=bump/5/1 op=cot query=derivative th=0.1 field=level seed=42",
    /* adjoints without diffusion, derivatives in extreme units and of what has faded, several sources with a
       full B, a filter whose peak is far below lambda_max */
    "shape=none/3 op=I scale=1e-05 query=adjoint kernel=symmetric poles=uniform t=6278.213696441455 field=nearly seed=306889",
    "shape=none/4 op=diag query=adjoint method=direct t=123627245.05210805 field=smooth seed=199966",
    "shape=weak/66/43/6 op=I scale=1e+40 query=derivative kernel=symmetric t=5e-324 field=smooth seed=940513",
    "shape=leak/40/1e-9 op=diag scale=1e+05 query=derivative kernel=symmetric method=krylov tol=1e-06 t=5604461452.496679 field=mode seed=772598",
    "shape=graph/30/1 op=near query=filter kernel=symmetric method=direct t=1240.377498234705 seed=380473",
    "shape=two/2/8 op=fem query=filter method=direct t=4.501707098294611 seed=461665",
    /* commute time and biharmonic beside a small component, and with a sliver */
    "shape=two/2/3/5 query=distance kind=commute",
    "shape=two/2/6/5 query=distance kind=commute",
    "shape=two/2/8/5 query=distance kind=commute",
    "shape=two/2/3/5 query=distance kind=biharmonic",
    "shape=two/2/6/5 query=distance kind=biharmonic",
    "shape=two/2/8/5 query=distance kind=biharmonic",
    "shape=sliver/2/7 query=distance kind=commute",
    "shape=sliver/2/10 query=distance kind=commute",
    "shape=sliver/2/13 query=distance kind=commute",
    "shape=sliver/2/7 query=distance kind=biharmonic",
    "shape=sliver/2/10 query=distance kind=biharmonic",
    "shape=sliver/2/13 query=distance kind=biharmonic",
    /* the sign of libigl */
    "shape=turned/40 op=I query=column t=1",
    "shape=turned/40 op=I query=column t=10",
    "shape=turned/40 op=I query=column t=10 method=krylov",
    "shape=turned/40 op=I query=column t=10 method=iterative",
    "shape=turned/40 op=I query=diagonal kernel=symmetric t=10",
    "shape=turned/40 op=I query=distance t=1",
    /* one entry far from the source */
    "shape=sphere/3 query=entries kernel=symmetric th=0.05 k=1 seed=3",
    "shape=sphere/3 query=entries kernel=symmetric th=0.2 k=1 seed=4",
    "shape=cycle/60 op=I query=entries th=1 k=1 seed=1",
    "shape=cycle/60 op=I query=pairs th=0.5 k=3 seed=2",
    /* eigenvalues of two parts, nothing between 5 and 1e11: shifts must get there */
    "shape=two/1/5 op=fem query=pairs kernel=symmetric kind=weighted t=5.88162318566344 k=10 seed=175710",
    "shape=two/1/5 op=fem query=distance th=20 k=10 seed=175710",
    /* rows that almost sum to zero */
    "shape=leak/64/4e-12 op=I query=apply t=1e11 field=linear method=krylov",
    "shape=leak/64/4e-12 op=I query=apply t=1e11 field=linear method=direct",
    "shape=leak/64/4e-12 op=I query=apply t=1e11 field=linear",
    "shape=leak/64/4e-12 op=I query=apply t=1e11 field=linear method=iterative",
    "shape=leak/64/4e-12 op=I query=column t=1e11 method=krylov",
    "shape=leak/64/4e-12 op=I query=column t=1e11 method=direct",
    /* rounding of the factor in long times */
    "shape=path/80 op=I query=apply t=100 field=mode seed=1 method=krylov",
    "shape=path/80 op=I query=apply t=1000 field=mode seed=1 method=krylov",
    "shape=path/80 op=I query=apply t=1000 field=mode seed=1 method=direct",
    "shape=path/80 op=I query=apply t=1e4 field=random method=krylov tol=1e-13",
    /* poles of one's own: a loose weighted error, next to the spectrum */
    "shape=sphere/3 query=distance own=loose degree=8 th=1",
    "shape=sphere/3 query=distance own=loose degree=8 th=10",
    "shape=sphere/3 query=distance own=loose degree=8 th=100",
    "shape=sphere/3 query=distance own=copy0 degree=8 th=10",
    "shape=cycle/60 op=I query=diagonal kernel=symmetric own=near x=3 method=direct t=1 seed=13",
    "shape=cycle/60 op=I query=diagonal kernel=symmetric own=near x=5 method=direct t=1 seed=13",
    "shape=cycle/60 op=I query=diagonal kernel=symmetric own=near x=7 method=direct t=1 seed=13",
    "shape=cycle/60 op=I query=column own=near x=5 method=direct t=1 seed=13",
    "shape=cycle/60 op=I query=column own=near x=7 method=direct t=1 seed=13",
    "shape=grid/6/2 op=fem+id query=diagonal degree=11 own=near x=7 tol=1e-11 t=417.9347234573265 seed=20079",
    "shape=leak/40/1e-3 op=I scale=1e-05 query=distance method=direct degree=4 own=near x=5 "
    "t=8.874288504572718 span=22.899661973943026 times=3 seed=849640",
    "shape=weak/66/35/6 op=I query=column poles=kernel degree=3 t=252134.45926565715 k=4 seed=122858",
    "shape=graph/30/12 op=near scale=1e-40 query=times kernel=symmetric tol=1e-13 t=7.701053733488825e-173 "
    "span=322.49545416235975 times=7 field=nearly seed=466076",
    "shape=path/71 op=diag query=distance kind=biharmonic t=0.010021720690390704 seed=586095",
    "shape=weak/60/45 op=diag query=distance kind=biharmonic tol=1e-13 t=2.187386761734381e-05 seed=631770",
    "shape=weak/66/46/6 op=I query=distance kind=biharmonic t=4999.9999999999945 seed=341872",
    "shape=penalty/60/4 op=tri scale=1e-40 query=column kernel=symmetric degree=2 own=a0 x=3 t=1e+100 k=40 seed=19214",
    /* a mass matrix that is nearly singular, and a field along it */
    "shape=path/80 op=near query=apply t=1 field=alternate",
    "shape=path/80 op=near query=apply t=1 field=alternate poles=uniform degree=4 method=direct",
    "shape=path/80 op=near query=apply t=1 field=alternate poles=uniform degree=8 method=direct",
    "shape=path/80 op=near query=apply t=1 field=alternate method=krylov",
    "shape=path/80 op=near query=diagonal kernel=symmetric t=1",
    "shape=path/80 op=near query=column t=1 method=direct",
    /* many times at once on graded meshes */
    "shape=grid/9/4 query=distance times=16 span=100 th=1",
    "shape=grid/9/6 query=distance times=16 span=100 th=1",
    "shape=grid/9/10 query=distance times=16 span=100 th=1",
    "shape=grid/9/6 query=distance kind=weighted times=16 span=100 th=1",
    "shape=grid/9/10 query=diagonal kernel=symmetric times=16 span=1000 th=1",
    /* weak edges, stiff penalties */
    "shape=penalty/60/6 op=I query=column kernel=symmetric t=10 method=iterative solver=lanczos",
    "shape=penalty/60/6 op=I query=column kernel=symmetric t=1000 method=iterative solver=lanczos",
    "shape=penalty/60/6 op=I query=column t=100 method=krylov",
    "shape=penalty/60/9 op=I query=column t=100 method=direct",
    "shape=weak/60/20 op=I query=apply field=step t=3145728 method=iterative solver=lanczos",
    "shape=weak/60/30 op=I query=apply field=step t=3221225472 method=iterative solver=lanczos",
    "shape=weak/60/20 op=I query=apply field=step t=3145728 method=krylov",
    "shape=weak/60/30 op=I query=apply field=step t=3221225472 method=krylov",
    "shape=weak/60/40 op=I query=apply field=step t=3298534883328 method=krylov",
    "shape=weak/60/40 op=I query=apply field=step t=3298534883328 method=direct",
    "shape=weak/60/30 op=I query=apply field=step t=3221225472 method=direct",
    "shape=weak/60/30 op=I query=apply field=step t=3221225472",
    /* huge and tiny fields, forty columns, tiny and huge times */
    "shape=sphere/2 query=apply t=0.1 field=tiny",
    "shape=sphere/2 query=apply t=0.1 field=tiny method=direct",
    "shape=sphere/2 query=apply t=0.1 field=tiny method=krylov",
    "shape=sphere/2 query=apply t=0.1 field=huge",
    "shape=sphere/2 query=apply t=0.1 field=huge method=direct",
    "shape=sphere/2 query=apply t=0.1 field=huge method=krylov",
    "shape=sphere/2 query=apply t=0.1 field=huge method=iterative",
    "shape=sphere/2 query=apply t=0.1 k=40 method=direct",
    "shape=sphere/2 query=apply t=0.1 k=40",
    "shape=none/5 op=I query=distance kind=commute",
    "shape=none/1 op=I query=distance kind=commute",
    "shape=none/5 op=I query=column t=1",
    "shape=sphere/2 op=vor query=column t=5e-324 method=krylov",
    "shape=sphere/2 op=vor query=diagonal kernel=symmetric t=1e16",
    "shape=cycle/60 op=I query=times t=5e-324 span=2e323 times=2 method=krylov",
    "shape=five query=column t=1e-310 method=direct",
    "shape=five query=column t=1e-310 method=krylov",
    "shape=five query=column t=1e300 method=direct",
    "shape=five query=column t=1e300 method=krylov",
    "shape=five query=column t=1e300 method=iterative",
    "shape=five query=diagonal kernel=symmetric t=1e300",
    "shape=five query=diagonal kernel=symmetric t=1e-310",
    "shape=five query=distance th=1e4",
    "shape=five query=distance th=1e10",
    "shape=five query=distance kind=weighted th=1e10",
    /* heat that fades, at t lambda_1 of about 1 to 600 */
    "shape=grid/9/1 op=fem+held query=column th=4 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=4",
    "shape=grid/9/1 op=fem+held query=column th=15 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=15",
    "shape=grid/9/1 op=fem+held query=column th=30 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=30",
    "shape=grid/9/1 op=fem+held query=column th=60 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=60",
    "shape=grid/9/1 op=fem+held query=column th=110 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=110",
    "shape=grid/9/1 op=fem+held query=column th=370 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=370",
    "shape=grid/9/1 op=fem+held query=column th=2200 k=6",
    "shape=grid/9/1 op=vor+held query=diagonal kernel=symmetric th=2200",
    "shape=grid/9/1 op=fem+held query=apply field=random k=3 th=30",
    "shape=grid/9/1 op=fem+held query=apply field=random k=3 th=370",
    "shape=grid/9/1 op=fem+held query=entries k=20 th=30",
    "shape=grid/9/1 op=fem+held query=entries k=20 th=370",
    "shape=grid/9/1 op=fem+held query=diagonal kernel=operator th=30",
    "shape=grid/9/1 op=fem+held query=diagonal kernel=operator th=370",
    "shape=grid/9/1 op=fem+held query=pairs k=10 th=30",
    "shape=grid/9/1 op=fem+held query=pairs k=10 th=370",
    "shape=grid/9/1 op=fem+held query=distance th=30",
    "shape=grid/9/1 op=fem+held query=distance th=370",
    "shape=grid/9/1 op=fem+held query=column method=direct k=4 th=30",
    "shape=grid/9/1 op=fem+held query=column method=direct k=4 th=370",
    "shape=grid/9/1 op=fem+held query=times th=1 span=1000 times=16",
    "shape=grid/9/1 op=fem+held query=diagonal kernel=symmetric th=1 span=1000 times=16",
    "shape=sphere/2 op=fem+held query=column th=1000 k=6",
    "shape=sliver/2/6 op=fem+held query=column th=1e4",
    "shape=two/2/3 op=fem+held query=column th=100 k=6",
    "shape=points/60/1/1 op=exp+held scale=1e+40 query=derivative method=local t=1e-310 field=level seed=225545",
    "shape=leak/64/4e-12 op=I query=diagonal kernel=symmetric t=1e13",
    "shape=leak/64/4e-12 op=I query=column t=1e13 k=4"};

enum { FIXED = sizeof fixed_cases / sizeof *fixed_cases };

/* ---- drawing ---- */


/* What an index is drawn with these odds, in parts. */
static int among(uint64_t *seed, const int *parts, int n) {
    int sum = 0, i, r;
    for (i = 0; i < n; i++) sum += parts[i];
    r = trial_below(seed, sum);
    for (i = 0; i + 1 < n && r >= parts[i]; i++) r -= parts[i];
    return i;
}

static double draw_time(uint64_t *seed, double unit) {
    static const double odd[] = {1e-300, 1e30, 1e300, 1e-310, 5e-324, 1e100};
    const double u = shape_uniform(seed);
    if (u < 0.03) return odd[trial_below(seed, 6)];
    if (u < 0.10) return unit * trial_power10(seed, -12, -2);
    if (u < 0.15) return unit * trial_power10(seed, 6, 12);
    if (u < 0.20) return unit * pow(10, trial_below(seed, 5));
    return unit * trial_power10(seed, -2, 6);
}

static trial trial_draw(uint64_t *seed, const trial *from, double unit) {
    static const int queries[] = {8, 8, 4, 4, 4, 4, 3, 6, 6, 8, 2, 10, 4}, methods[] = {5, 6, 5, 5, 4},
                     fields[] = {6, 4, 3, 1, 1, 2, 2, 2, 1, 2, 1, 1, 3};
    static const double tols[] = {0, 0, 0, 1e-6, 1e-11, 1e-13};
    trial c = *from;
    int direct;
    c.query = among(seed, queries, QUERY_COUNT);
    c.kernel = trial_below(seed, 2);
    c.seed = (int64_t)(shape_random(seed) >> 44);
    c.t = draw_time(seed, unit);
    c.tol = tols[trial_below(seed, 6)];
    c.kind = c.query == QUERY_DISTANCE || c.query == QUERY_DISTANCE_FROM ? trial_below(seed, 4) : c.query == QUERY_PAIRS ? trial_below(seed, 8) % 5 : 0;
    if (c.kind == 4) c.kind = 0;
    direct = c.query >= QUERY_DIAGONAL || (c.query == QUERY_PAIRS && c.kind >= 2);
    c.method = direct ? 2 * trial_below(seed, c.kind < 2 ? 3 : 2)    /* auto, direct or local */
                      : among(seed, methods, c.query == QUERY_FILTER ? 3 : 5);
    if (c.method == HD_METHOD_ITERATIVE) {
        c.solver = trial_below(seed, c.query == QUERY_FILTER ? 4 : 5);
        if (c.solver == 2) c.solver = HD_SOLVER_COCG;    /* no solver has this number */
        if (c.solver != HD_SOLVER_LANCZOS) c.precond = trial_below(seed, 5);
    }
    if ((c.method < HD_METHOD_KRYLOV || (c.method == HD_METHOD_LOCAL && c.query >= QUERY_DIAGONAL)) &&
        c.solver != HD_SOLVER_LANCZOS && c.kind < 2) {
        static const int which[] = {10, 3, 6};
        c.poles = c.method == HD_METHOD_LOCAL ? 0 : among(seed, which, 3);
        if (c.method != HD_METHOD_LOCAL && trial_chance(seed, c.poles ? 0.6 : 0.1)) c.degree = 2 + trial_below(seed, 13);
        if (c.query == QUERY_DERIVATIVE) c.poles = c.degree = 0;
        if (c.query != QUERY_DERIVATIVE && trial_chance(seed, 0.1)) {   /* sets of one's own have none */
            c.poles = 0;
            c.own = 1 + trial_below(seed, OWN_A0);
            c.degree = 2 + trial_below(seed, 13);
            c.own_x = 1 + trial_below(seed, 7);
        }
    }
    if (c.query == QUERY_FILTER) c.poles = c.degree = c.own = 0;
    c.field = c.query == QUERY_APPLY || c.query == QUERY_DERIVATIVE || c.query == QUERY_ADJOINT || (c.query == QUERY_TIMES && trial_chance(seed, 0.5))
                  ? among(seed, fields, FIELD_COUNT)
                  : 0;
    if (c.query == QUERY_ADJOINT && trial_chance(seed, 0.3)) c.field = FIELD_DELTA;
    /* rounding of huge fields over tiny times leaves the range of doubles */
    if (c.query == QUERY_DERIVATIVE && c.field == FIELD_HUGE) c.field = FIELD_RANDOM;
    if (c.query == QUERY_TIMES) c.kind = trial_chance(seed, 0.5);   /* a field or a column */
    c.k = c.query == QUERY_ENTRIES || c.query == QUERY_PAIRS  ? 1 + trial_below(seed, trial_chance(seed, 0.5) ? 2 : 20)
          : c.query == QUERY_APPLY || c.query == QUERY_COLUMN ? (trial_chance(seed, 0.05) ? 40 : 1 + trial_below(seed, 6))
          : c.query == QUERY_DISTANCE                         ? 1 + trial_below(seed, 3)
                                                              : 1;
    if (c.query == QUERY_TIMES ||
        ((c.query == QUERY_DIAGONAL || (c.query == QUERY_DISTANCE && c.kind < 2)) && trial_chance(seed, 0.4))) {
        c.n_times = trial_chance(seed, 0.6) ? 16 : 2 + trial_below(seed, 8);
        c.span = trial_power10(seed, 0, 3);
        if (c.t > 1e290) c.t = 1e290;
    }
    if (c.query == QUERY_FROM || c.query == QUERY_FILTER || c.query == QUERY_DISTANCE_FROM)
        c.corners = trial_chance(seed, 0.4) ? 3 : 1;
    return c;
}

/* ---- tables by any two properties of a case ---- */

enum { AXIS_SHAPE, AXIS_OP, AXIS_T, AXIS_QUERY, AXIS_METHOD, AXES };
static const char *const axis_names[] = {"shape", "op", "t", "query", "method", NULL};
enum { VALUES = 64, VALUE_SIZE = 24 };
static char axis_values[AXES][VALUES][VALUE_SIZE];
static int n_axis_values[AXES];

typedef struct record { unsigned char value[AXES]; float ratio; } record;
static record *records;
static int64_t n_records, most_records;

static unsigned char axis_value(int axis, const char *text) {
    int i;
    for (i = 0; i < n_axis_values[axis]; i++)
        if (strcmp(axis_values[axis][i], text) == 0) return (unsigned char)i;
    if (i == VALUES) truth_stop("a table has too many rows or columns");
    snprintf(axis_values[axis][i], VALUE_SIZE, "%s", text);
    n_axis_values[axis]++;
    return (unsigned char)i;
}

/* A letter before a range of times sorts it. */
static void keep_record(const trial *c, double unit, double ratio) {
    static const char *const ranges[] = {"a below 1e-2", "b 1e-2 to 1", "c 1 to 1e2", "d 1e2 to 1e4",
                                         "e 1e4 to 1e6", "f above 1e6"};
    static const double limits[] = {1e-2, 1, 1e2, 1e4, 1e6};
    const int timeless = c->query >= QUERY_PAIRS && trial_timeless(c->kind);
    char shape[VALUE_SIZE];
    record r;
    int range = 0;
    while (range < 5 && !(c->t / unit < limits[range])) range++;
    snprintf(shape, sizeof shape, "%.*s", (int)strcspn(c->shape, "/"), c->shape);
    r.value[AXIS_SHAPE] = axis_value(AXIS_SHAPE, shape);
    r.value[AXIS_OP] = axis_value(AXIS_OP, c->op);
    r.value[AXIS_T] = axis_value(AXIS_T, timeless ? "g no time" : ranges[range]);
    r.value[AXIS_QUERY] = axis_value(AXIS_QUERY, trial_queries[c->query]);
    r.value[AXIS_METHOD] = axis_value(AXIS_METHOD, trial_methods[c->method]);
    r.ratio = (float)ratio;
    if (n_records == most_records) {
        most_records = most_records ? 2 * most_records : 1024;
        records = (record *)realloc(records, (size_t)most_records * sizeof *records);
        if (!records) truth_stop("out of memory");
    }
    records[n_records++] = r;
}

/* ==== [7] checks of this program ==== */

static void check(int ok, const char *what) {
    if (ok) return;
    fprintf(stderr, "bounds: this program is wrong: %s\n", what);
    exit(2);
}

/* K_t of a truth against a closed form for the row i, column j. */
typedef quad (*closed_form)(int n, int i, int j, quad t);

static quad closed_cycle(int n, int i, int j, quad t) {
    quad sum = 0;
    int k;
    for (k = 0; k < n; k++)
        sum += expq(-t * (2 - 2 * cosq(2 * M_PIq * k / n))) * cosq(2 * M_PIq * k * (i - j) / n);
    return sum / n;
}

static quad closed_path(int n, int i, int j, quad t) {
    quad sum = 0;
    int k;
    for (k = 0; k < n; k++)
        sum += expq(-t * (2 - 2 * cosq(M_PIq * k / n))) * cosq(M_PIq * k * (i + 0.5Q) / n) *
               cosq(M_PIq * k * (j + 0.5Q) / n) * (k ? 2 : 1);
    return sum / n;
}

static void check_closed(const char *spec, closed_form f, int n) {
    trial c = trial_default();
    trial_subject s;
    static const double ts[] = {1e-3, 1, 30, 1000};
    quad worst = 0;
    int q, i, j;
    strcpy(c.shape, spec);
    strcpy(c.op, "I");
    check(trial_subject_make(&s, &c, 0), "a graph has no truth");
    for (q = 0; q < 4; q++) {
        truth_filter_fill(&s.f, &s.exact, FORM_HEAT, ts[q], NULL, 0);
        for (i = 0; i < n; i++)
            for (j = 0; j < n; j++) {
                quad sum = 0, e;
                int l;
                for (l = 0; l < s.f.last[0]; l++)
                    sum += s.exact.x[i * n + l] * s.f.g[l] * s.exact.y[j * n + l];
                e = fabsq(sum - f(n, i, j, (quad)ts[q]));
                if (e > worst) worst = e;
            }
    }
    check(worst < 1e-31Q, "eigenpairs of a graph with a closed form");
    trial_subject_free(&s);
}

/* |L x - lambda B x| and |x' B x - 1| of all pairs, and all of them there: for pairs without a closed form.
 */
static void check_residuals(const char *spec, const char *op) {
    trial c = trial_default();
    trial_subject s;
    quad worst = 0, unit = 0;
    int i, k, l, n;
    int64_t p;
    snprintf(c.shape, sizeof c.shape, "%s", spec);
    snprintf(c.op, sizeof c.op, "%s", op);
    check(trial_subject_make(&s, &c, 0), "a shape has no truth");
    n = s.lap->n_active;
    for (k = 0; k < n; k++) {
        for (i = 0; i < n; i++) {
            quad lx = 0, bx = 0, size = 0, sum = 0;
            for (p = s.lap->L.row_ptr[i]; p < s.lap->L.row_ptr[i + 1]; p++) {
                const int j = s.lap->L.col[p];
                const quad x = s.exact.x[j * n + k], v = s.lap->L.val[p];
                bx += truth_mass(s.lap, i, p) * x;
                size += fabsq(v * x) + fabsq(s.exact.lambda[k] * truth_mass(s.lap, i, p) * x);
                if (s.exact.conserves && j == i) continue;
                lx += v * x;
                sum += v;
            }
            if (s.exact.conserves) lx -= sum * s.exact.x[i * n + k];
            size += fabsq(sum * s.exact.x[i * n + k]) +
                    1e-15Q * s.exact.top * (quad)s.lap->mass[i] * (quad)s.exact.x_most;
            if (fabsq(lx - s.exact.lambda[k] * bx) > worst * size)
                worst = fabsq(lx - s.exact.lambda[k] * bx) / size;
            if (size > 0 && fabsq(bx - s.exact.y[i * n + k]) > worst * (fabsq(bx) + (quad)s.exact.y_most))
                worst = fabsq(bx - s.exact.y[i * n + k]) / (fabsq(bx) + (quad)s.exact.y_most);
        }
        for (l = 0; l < n; l++) {
            quad sum = l == k ? -1 : 0;
            for (i = 0; i < n; i++) sum += s.exact.x[i * n + k] * s.exact.y[i * n + l];
            if (fabsq(sum) > unit) unit = fabsq(sum);
        }
    }
    if (trial_verbose)
        printf("  %s %s: eigenvalues %g .. %g, residual %.2g, orthonormal to %.2g\n", spec, op, s.exact.edge,
               s.exact.top, (double)worst, (double)unit);
    check(worst < 1e-29Q, "residuals of eigenpairs");
    check(unit < 1e-30Q, "eigenvectors are not orthonormal");
    trial_subject_free(&s);
}

/* Numbers of 192 bits: identities that fail when a carry is lost. */
static void check_wide(void) {
    uint64_t seed = 12;
    int i;
    for (i = 0; i < 2000; i++) {
        const w_wide a =
            w_mul(w_double(shape_signed(&seed) * trial_power10(&seed, -30, 30)), w_double(shape_signed(&seed)));
        const w_wide b = w_mul(w_double(shape_signed(&seed) * trial_power10(&seed, -30, 30)),
                             w_double(1 + shape_uniform(&seed)));
        w_wide e = w_sub(w_mul(w_add(a, b), w_sub(a, b)), w_sub(w_mul(a, a), w_mul(b, b))),
             size = w_add(w_mul(a, a), w_mul(b, b));
        check(!e.sign || e.e < size.e - (WIDE_BITS - 11), "(a + b)(a - b)");
        e = w_sub(w_mul(w_div(a, b), b), a);
        check(!e.sign || e.e < a.e - (WIDE_BITS - 8), "a/b b");
        size = w_mul(a, a);
        e = w_sqrt(size);
        e = w_sub(w_mul(e, e), size);
        check(!e.sign || e.e < size.e - (WIDE_BITS - 8), "the square of a root");
        check(w_sub(w_add(a, b), w_add(b, a)).sign == 0, "a + b and b + a");
        check(w_quad(w_double(1.0 / 3)) == (quad)(1.0 / 3), "a double there and back");
    }
}

/* A bound that is far too small must be found to be so, and no other. */
static void check_comparison(void) {
    trial c = trial_parse("shape=sphere/2 query=column th=10 poles=kernel degree=6 method=direct k=2 seed=5");
    trial_subject s;
    int64_t below;
    check(trial_subject_make(&s, &c, 0), "a sphere has no truth");
    trial_run(&s, &c, 0);
    below = trial_rows[0].below;
    check(trial_n_rows == 1 && trial_rows[0].compared == 2, "comparisons are not counted");
    trial_shrink = 1e-9;
    trial_run(&s, &c, 0);
    trial_shrink = 1;
    check(trial_rows[0].below == below + 2 && trial_rows[0].below_b == 2, "a bound that is too small "
                                                                                "is not found");
    check(below == 0, "a bound that should hold does not");
    free(trial_rows[0].ratio);
    free(trial_rows[0].ratio_b);
    memset(trial_rows, 0, sizeof *trial_rows);
    trial_n_rows = 0;
    n_records = 0;
    trial_subject_free(&s);
}

static void check_all(void) {
    FILE *const keep = trial_csv;
    const double factor = trial_shrink;
    trial_csv = NULL;
    trial_shrink = 1;
    check_wide();
    check_closed("cycle/12", closed_cycle, 12);
    check_closed("path/15", closed_path, 15);
    check_residuals("sphere/1", "fem");
    check_residuals("grid/4/10", "fem");
    check_residuals("two/1/8", "vor");
    check_residuals("penalty/9/12", "diag");
    check_residuals("weak/12/40", "tri");
    check_comparison();
    trial_csv = keep;
    trial_shrink = factor;
}

/* ==== [8] the run ==== */

/* What is drawn from: a shape with the operators it suits. */
typedef struct family { const char *pattern; int from, to; const char *ops; } family;

/* A %d in a pattern runs from .. to. */
static const family large[] = {{"grid/9/%d", 1, 10, "fem vor cot poly"},
                               {"grid/6/%d", 1, 10, "fem vor fem+id"},
                               {"strip/8/%d", 2, 8, "fem vor vor+tuft"},
                               {"sphere/%d", 1, 3, "fem vor cot poly fem+id vor+tuft"},
                               {"sliver/2/%d", 3, 13, "fem vor cot fem+id"},
                               {"sliver/3/%d/4", 3, 13, "fem vor"},
                               {"bump/8/%d", 1, 3, "fem vor cot poly fem+id vor+id"},
                               {"two/2/%d", 0, 8, "fem vor"},
                               {"two/1/%d/5", 1, 8, "fem vor"},
                               {"cone/%d/6", 5, 14, "fem vor"},
                               {"split/%d/2", 6, 8, "fem vor cot"},
                               {"soup/%d/1", 1, 12, "fem vor"},
                               {"inert/%d/1", 5, 7, "fem vor"},
                               {"fan/20/%d", 0, 6, "fem vor cot"},
                               {"five", 0, 0, "fem vor poly"},
                               {"points/60/%d/1", 0, 2, "vexp exp tuft"},
                               {"points/90/%d/0", 0, 2, "vexp exp tuft"},
                               {"graph/60/%d", 0, 12, "I diag tri"},
                               {"graph/30/%d", 0, 12, "I diag near"},
                               {"lattice/8/%d", 0, 12, "I diag tri"},
                               {"cycle/%d", 58, 61, "I diag tri near"},
                               {"path/%d", 70, 72, "I diag tri near"},
                               {"weak/60/%d", 8, 46, "I diag"},
                               {"weak/66/%d/6", 8, 46, "I"},
                               {"penalty/60/%d", 0, 12, "I diag tri"},
                               {"leak/40/1e-%d", 1, 14, "I diag"},
                               {"turned/24", 0, 0, "I"},
                               {"star/40", 0, 0, "I diag near"},
                               {"none/%d", 1, 5, "I diag"},
                               {"tree/12/%d", 1, 20, "mass2 mass8 mass16"},
                               {"tree/24/%d", 21, 40, "mass2 mass8 mass16"},
                               {"grid/9/%d", 1, 10, "fem+held vor+held poly+held"},
                               {"strip/8/%d", 2, 8, "vor+tuft+held"},
                               {"bump/8/%d", 1, 3, "fem+held cot+held fem+id+held"},
                               {"sphere/%d", 1, 3, "fem+held vor+held"},
                               {"sliver/2/%d", 3, 13, "fem+held"},
                               {"two/2/%d", 0, 8, "fem+held vor+held"},
                               {"split/%d/2", 6, 8, "fem+held"},
                               {"inert/%d/1", 5, 7, "fem+held vor+held"},
                               {"points/60/%d/1", 0, 2, "vexp+held exp+held tuft+held"}};
static const family small[] = {{"grid/5/%d", 2, 10, "fem vor"},
                               {"grid/5/3", 0, 0, "poly cot"},
                               {"sphere/%d", 1, 2, "fem vor"},
                               {"sliver/1/%d", 5, 13, "fem"},
                               {"bump/5/1", 0, 0, "fem vor cot poly vor+id"},
                               {"two/1/%d", 3, 7, "fem"},
                               {"cone/6/4", 0, 0, "fem vor"},
                               {"split/5/2", 0, 0, "vor"},
                               {"soup/5/1", 0, 0, "fem"},
                               {"inert/5/1", 0, 0, "fem"},
                               {"fan/12/3", 0, 0, "vor"},
                               {"points/40/0/1", 0, 0, "vexp exp tuft"},
                               {"graph/24/%d", 3, 11, "I diag"},
                               {"lattice/5/6", 0, 0, "I tri"},
                               {"path/30", 0, 0, "I near"},
                               {"weak/24/%d", 12, 40, "I"},
                               {"penalty/24/%d", 3, 9, "I"},
                               {"leak/24/1e-%d", 4, 12, "I"},
                               {"tree/12/%d", 1, 20, "mass8 mass16"},
                               {"bump/6/1", 0, 0, "fem+held vor+held"},
                               {"two/1/%d", 0, 7, "fem+held"},
                               {"inert/5/1", 0, 0, "vor+held"}};

typedef struct settings {
    int quick;
    int64_t count;
    uint64_t seed;
    const char *query, *shape, *method, *op;
} settings;

static int64_t compared_in_all(void) {
    int64_t sum = 0;
    int i;
    for (i = 0; i < trial_n_rows; i++) sum += trial_rows[i].compared;
    return sum;
}

static int wanted(const settings *o, const trial *c) {
    const char *method =
        c->method == HD_METHOD_ITERATIVE && c->solver ? trial_solvers[c->solver] : trial_methods[c->method];
    return (!o->query || strstr(trial_queries[c->query], o->query)) &&
           (!o->shape || strstr(c->shape, o->shape)) && (!o->op || strstr(c->op, o->op)) &&
           (!o->method || strstr(method, o->method));
}

/* Fixed cases without an answer; shapes of families without a pair, or with hardly a comparison. */
static int fixed_refused, shapes_refused, shapes_dry;
enum { FIXED_REFUSED = 8, SHAPES_REFUSED = 1 };      /* the sign of libigl, filters whose poles cannot be had */

static void run_fixed(const settings *o) {
    trial_subject *made = TRUTH_NEW(trial_subject, FIXED);        /* each shape once */
    trial *of = TRUTH_NEW(trial, FIXED);
    int i, k;
    for (i = 0; i < FIXED; i++) {
        of[i] = trial_parse(fixed_cases[i]);
        for (k = 0; strcmp(of[k].shape, of[i].shape) != 0 || strcmp(of[k].op, of[i].op) != 0; k++) {}
        if (!wanted(o, of + i)) continue;
        if ((!made[k].lap && !trial_subject_make(made + k, of + i, 0)) || !trial_run(made + k, of + i, 0)) fixed_refused++;
    }
    for (i = 0; i < FIXED; i++) trial_subject_free(made + i);
    free(made);
    free(of);
}

/* Every member of the families in turn, as many comparisons on each. list NULL: they are counted. */
static int64_t run_families(const settings *o, const family *list, int n_list, int64_t each) {
    static const double scales[] = {1, 1, 1e-5, 1e5, 1, 1e40, 1, 1e-40};
    int64_t members = 0;
    int f, x, step;
    for (f = 0; f < n_list; f++) {
        step = o->quick && list[f].to > list[f].from ? (list[f].to - list[f].from + 3) / 4 : 1;
        if (step < 1) step = 1;
        for (x = list[f].from; x <= list[f].to; x += step) {
            const char *op = list[f].ops;
            char spec[32];
            snprintf(spec, sizeof spec, list[f].pattern, x);
            while (*op) {
                trial c = trial_default();
                uint64_t seed = o->seed * 1000003 + (uint64_t)members;
                const int64_t before = compared_in_all();
                trial_subject s;
                int64_t q;
                snprintf(c.shape, sizeof c.shape, "%s", spec);
                snprintf(c.op, sizeof c.op, "%.*s", (int)strcspn(op, " "), op);
                op += strcspn(op, " ");
                op += *op == ' ';
                members++;
                if (each == 0 || (o->shape && !strstr(spec, o->shape))) continue;
                c.scale = scales[shape_random(&seed) % 8];
                if (!trial_subject_make(&s, &c, !o->quick)) {
                    shapes_refused++;
                    continue;
                }
                for (q = 0; compared_in_all() - before < each && q < 2 * each; q++) {
                    trial one = trial_draw(&seed, &c, s.unit);
                    if (wanted(o, &one)) trial_run(&s, &one, q % 8 == 0);
                }
                shapes_dry += 2 * (compared_in_all() - before) < each;
                trial_subject_free(&s);
            }
        }
    }
    return members;
}

static int by_size(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double median(float *list, int64_t n) {
    if (n == 0) return 0;
    qsort(list, (size_t)n, sizeof *list, by_size);
    return list[n / 2];
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const trial_tally *)a)->name, ((const trial_tally *)b)->name);
}

static int print_table(void) {
    int64_t wrong = 0, sum = 0, errors = 0, useless = 0;
    int i;
    qsort(trial_rows, (size_t)trial_n_rows, sizeof *trial_rows, by_name);
    printf("%-28s %9s %7s %8s %6s %8s %9s %7s %5s %9s %9s %9s %12s\n", "query and method", "compared",
           "errors", "warned", "below", "below B", "below rel", "useless", "bad", "worst", "median",
           "median B", "stored");
    for (i = 0; i < trial_n_rows; i++) {
        trial_tally *r = trial_rows + i;
        char stored[32], b[32];
        snprintf(stored, sizeof stored, r->stored ? "%lld/%lld" : "-", (long long)r->stored_below,
                 (long long)r->stored);
        snprintf(b, sizeof b, r->n_ratio_b ? "%.2g" : "-", median(r->ratio_b, r->n_ratio_b));
        printf("%-28s %9lld %7lld %8lld %6lld %8lld %9lld %7lld %5lld %9.2g %9.2g %9s %12s\n", r->name,
               (long long)r->compared, (long long)r->errors, (long long)r->warned, (long long)r->below,
               (long long)r->below_b, (long long)r->below_relative, (long long)r->useless, (long long)r->bad,
               r->worst, median(r->ratio, r->n_ratio), b, stored);
        wrong += r->below + r->below_b + r->below_relative + r->bad;
        useless += r->useless;
        sum += r->compared;
        errors += r->errors;
    }
    for (i = 0; i < trial_n_rows; i++)
        if (trial_rows[i].worst > 1)
            printf("worst of %s: %.3g\n    --case \"%s\"\n", trial_rows[i].name, trial_rows[i].worst,
                   trial_rows[i].worst_case);
    printf("%lld comparisons, %lld honest errors; below the truth or not finite: %lld; useless without a "
           "warning: %lld\n",
           (long long)sum, (long long)errors, (long long)wrong, (long long)useless);
    printf("the truth's own error was above a hundredth of the bound in %lld comparisons\n",
           (long long)trial_unsure);
    return wrong + useless > 0;
}

/* By query: how many of a hundred cases are answered, and how many of a hundred comparisons have finite bounds; some shapes, sets
 * of poles and times are such that the rest have none. */
static const struct { int answered, bounded; } floors[QUERY_COUNT] = {
    {93, 85}, {95, 85}, {93, 90}, {92, 55}, {92, 88}, {93, 88}, {58, 45}, {92, 88}, {95, 75}, {96, 90}, {96, 75}, {96, 85}};

/* Whether too much was refused, or left without a bound: that would pass all comparisons. */
static int below_floors(void) {
    enum { ENOUGH = 36 };        /* cases; of fewer nothing can be said */
    int found = 0, q;
    for (q = 0; q < QUERY_COUNT; q++) {
        const trial_count *c = trial_counts + q;
        const int64_t answered = c->asked - c->refused, bounded = c->compared - c->unbounded;
        if (c->asked < ENOUGH || (100 * answered >= floors[q].answered * c->asked && 100 * bounded >= floors[q].bounded * c->compared)) continue;
        printf("%s: %lld of %lld answered, %lld of %lld bounds finite: too few\n", trial_queries[q], (long long)answered, (long long)c->asked,
               (long long)bounded, (long long)c->compared);
        found = 1;
    }
    if (fixed_refused <= FIXED_REFUSED && shapes_refused <= SHAPES_REFUSED && shapes_dry == 0) return found;
    printf("%d fixed cases are refused, %d expected; %d shapes have no pair, %d expected; on %d shapes hardly anything is answered\n",
           fixed_refused, FIXED_REFUSED, shapes_refused, SHAPES_REFUSED, shapes_dry);
    return 1;
}

static int by_text(const void *a, const void *b) { return strcmp((const char *)a, (const char *)b); }

/* "2599; 0.91; 2e-4" of the records with these two values; "" if there are none */
static void print_cell(int rows, int row, int columns, int column, float *list) {
    int64_t i, n = 0;
    for (i = 0; i < n_records; i++)
        if (records[i].value[rows] == row && records[i].value[columns] == column) list[n++] = records[i].ratio;
    printf(" |");
    if (n == 0) return;
    median(list, n);      /* sorts them */
    printf(" %lld; %.2g; %.1g", (long long)n, list[n - 1], list[n / 2]);
}

static void print_axes(int rows, int columns) {
    char head[VALUES][VALUE_SIZE], side[VALUES][VALUE_SIZE];
    float *list = TRUTH_NEW(float, n_records);
    const int n = n_axis_values[columns], m = n_axis_values[rows];
    int i, k;
    memcpy(head, axis_values[columns], sizeof head);
    memcpy(side, axis_values[rows], sizeof side);
    qsort(head, (size_t)n, VALUE_SIZE, by_text);
    qsort(side, (size_t)m, VALUE_SIZE, by_text);
    printf("\n| %s", axis_names[rows]);
    for (k = 0; k < n; k++) printf(" | %s", head[k] + (columns == AXIS_T ? 2 : 0));
    printf(" |\n|");
    for (k = 0; k <= n; k++) printf("---|");
    for (i = 0; i < m; i++) {
        printf("\n| %s", side[i] + (rows == AXIS_T ? 2 : 0));
        for (k = 0; k < n; k++) print_cell(rows, axis_value(rows, side[i]), columns, axis_value(columns, head[k]), list);
        printf(" |");
    }
    printf("\n");
    free(list);
}

/* The two axes of ROWS:COLUMNS; 0 if the text is something else. */
static int parse_axes(const char *text, int *axes) {
    int k, i;
    for (k = 0; k < 2; k++) {
        const size_t size = strcspn(text, ":");
        for (i = 0; i < AXES && (strlen(axis_names[i]) != size || strncmp(axis_names[i], text, size) != 0);) i++;
        if (i == AXES || (text[size] == ':') != (k == 0)) return 0;
        axes[k] = i;
        text += size + (k == 0);
    }
    return 1;
}

static const char *argument(int argc, char **argv, int *i) {
    if (*i + 1 >= argc) {
        fprintf(stderr, "bounds: %s takes a value\n", argv[*i]);
        exit(2);
    }
    return argv[++*i];
}

int main(int argc, char **argv) {
    settings o;
    const char *only = NULL;
    int i, self = 0, axes[8][2], n_tables = 0, wrong;
    memset(&o, 0, sizeof o);
    o.count = 1000000;
    o.seed = 1;
    trial_serial.n_threads = 1;
    for (i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--quick") == 0) o.quick = 1;
        else if (strcmp(argv[i], "--self") == 0) self = 1;
        else if (strcmp(argv[i], "--count") == 0) o.count = strtoll(argument(argc, argv, &i), NULL, 10);
        else if (strcmp(argv[i], "--seed") == 0) o.seed = strtoull(argument(argc, argv, &i), NULL, 10);
        else if (strcmp(argv[i], "--query") == 0) o.query = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--shape") == 0) o.shape = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--method") == 0) o.method = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--op") == 0) o.op = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--case") == 0) only = argument(argc, argv, &i);
        else if (strcmp(argv[i], "--shrink") == 0) trial_shrink = strtod(argument(argc, argv, &i), NULL);
        else if (strcmp(argv[i], "--table") == 0) {
            if (n_tables == 8 || !parse_axes(argument(argc, argv, &i), axes[n_tables++])) {
                fprintf(stderr, "bounds: --table takes two of shape, op, t, query, method, as in shape:t\n");
                return 2;
            }
        } else if (strcmp(argv[i], "--csv") == 0) {
            trial_csv = fopen(argument(argc, argv, &i), "w");
            if (!trial_csv) truth_stop("the csv file cannot be written");
            fprintf(trial_csv, "row,case,column,status,true,error_bound,true_b,error_bound_b,error_relative,below,"
                         "below_b,below_relative,useless,bad\n");
        } else {
            fprintf(stderr, "usage: bounds [--quick] [--count N] [--seed S] [--query NAME] [--shape NAME] "
                            "[--method NAME] [--op NAME] [--table ROWS:COLUMNS] [--csv FILE]\n"
                            "              [--case CASE] [--shrink F] [--self]\n");
            return 2;
        }
    }
    trial_verbose = self;
    check_all();
    trial_seen = keep_record;
    if (self) return 0;
    if (only) {
        trial c = trial_parse(only);
        trial_subject s;
        trial_verbose = 1;
        if (!trial_subject_make(&s, &c, 1)) return 2;
        trial_run(&s, &c, 1);
        trial_subject_free(&s);
        return print_table();
    }
    run_fixed(&o);
    if (o.quick) {
        const int n = sizeof small / sizeof *small;
        run_families(&o, small, n, 1 + 4000 / run_families(&o, small, n, 0));
    } else {
        const int n = sizeof large / sizeof *large;
        const int64_t members = run_families(&o, large, n, 0);
        run_families(&o, large, n, (o.count + members - 1) / members);
    }
    if (trial_csv) fclose(trial_csv);
    wrong = print_table();
    if (!o.query && !o.shape && !o.op && !o.method) wrong |= below_floors();
    for (i = 0; i < n_tables; i++) print_axes(axes[i][0], axes[i][1]);
    return wrong;
}
