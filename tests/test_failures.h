/* test_failures.h - every public call with every allocation failing in turn, with failures at random, cancelled at every progress
 * call, and with limits to the byte. Each time the right status, nothing left behind, and the same objects asked again
 * give the same bits. test_robust.h does the same for calls from nothing; here objects are made first and survive. */

#ifndef TEST_FAILURES_H
#define TEST_FAILURES_H

/* What a call may do under a byte limit: nothing but say so; go on in another way; besides, the way may depend on what was
 * asked before. Where an allocation fails, or the call is cancelled, each must say so. */
enum { FAIL_TELLS = 0, FAIL_GOES_ON, FAIL_DEPENDS };

typedef struct fail_case { const char *script; int goes_on; } fail_case;

/* How many failures there were. */
static struct { int64_t memory, random, cancelled, limited; } fail_count;

static const fail_case fail_cases[] = {
    {"triangles", 0}, {"voronoi updatable triangles", 0}, {"held border updatable triangles", 0}, {"held border triangles", 0},
    {"delaunay triangles", 0}, {"delaunay held border voronoi triangles", 0}, {"tufted triangles", 0},
    {"tufted held triangles", 0}, {"view", 0}, {"held updatable view", 0}, {"polygons", 0}, {"held border updatable polygons", 0},
    {"fem updatable polygons", 0}, {"fem delaunay polygons", 0}, {"points", 0}, {"held points", 0}, {"exp points", 0},
    {"held tufted_points", 0}, {"nbr_ptr=own_ptr nbr=own_nbr tufted_points", 0}, {"lengths", 0},
    {"held border voronoi lengths", 0}, {"delaunay lengths", 0}, {"tufted lengths", 0}, {"updatable matrices", 0},
    {"b=whole held lo.n_held=1 matrices", 0}, {"update", 0}, {"held border update", 0}, {"update_view", 0},
    {"updatable b=whole matrices | L.val=val2 update_matrices", 0}, {"lap_apply", 0}, {"lambda_max", 0},
    {"cocg mildl time=0.5 zb=z shifted", 0}, {"cocg ssor time=0.5 shifted", 0}, {"held minres ildl time=0.5 shifted", 0},
    {"plan", 0}, {"held direct plan", 0}, {"direct | set_rational time=set_time column", 0},
    {"iterative cocg set=set2 time=set2_time | set_rational column", FAIL_GOES_ON},
    {"direct set_rational time=set_time column set=set2 time=set2_time | set_rational column", FAIL_GOES_ON},
    {"direct set_rational time=set_time column k=6 | n_sets=0 set=NULL set_rational columns", FAIL_GOES_ON},
    {"local set_rational time=set_time column | set=set2 time=set2_time set_rational column", FAIL_GOES_ON},
    {"direct n_sets=2 set=both | set_rational n_times=0 diagonal", 0}, {"direct t=set_t set_rational diagonal", 0},
    {"direct set=both n_sets=2 set_rational n_times=0 operator u=NULL diagonal", 0}, {"n_times=3 times_auto", 0}, {"eigenpairs", 0},
    {"voronoi so.count=21 eigenpairs", 0}, {"held so.count=5 eigenpairs", 0}, {"so.count=0 so.below=8 eigenpairs", 0},
    {"n_times=2 eigen_columns", 0}, {"n_times=2 eigen_diagonal", 0}, {"operator n_times=2 eigen_diagonal", 0},
    {"held n_times=2 eigen_distance", 0}, {"weighted n_times=2 eigen_distance", 0}, {"commute eigen_distance", 0},
    {"voronoi biharmonic eigen_distance", 0}, {"n_times=2 eigen_columns_from", 0}, {"n_times=2 eigen_distance_from", 0},
    {"sources=curve eigen_columns_from", 0}, {"sources=curve eigen_distance_from", 0},
    {"geodesic", 0}, {"updatable voronoi geodesic", 0}, {"geodesic_view", 0}, {"mean geodesic_lengths", 0},
    {"geodesic_polygons", 0}, {"delaunay geodesic_polygons", 0}, {"geodesic_points", 0}, {"geodesic_from", 0},
    {"mean sources=curve geodesic_from", 0}, {"delaunay geodesic_lengths | sources=curve geodesic_from", 0},
    {"geodesic_polygons k=6 | geodesic_each", 0}, {"geodesic_points k=4 | geodesic_set", 0}, {"k=4 geodesic_set", 0},
    {"voronoi k=6 geodesic_each", 0}, {"updatable k=6 geodesic | geodesic_update geodesic_each", 0},
    {"updatable k=6 geodesic | geodesic_update_view geodesic_each", 0}, {"analyse", 0}, {"dissection analyse", 0},
    {"own analyse", 0}, {"factor", 0}, {"factor_c | factor", 0}, {"dissection factor_c", 0}, {"solve", 0}, {"inverse", 0},
    {"dissection inverse", 0}, {"solve_c", 0}, {"inverse_c", 0}, {"dissection inverse_c", 0}, {"triplets", 0}, {"k=4 nearest", 0},
    {"n_times=3 shared_poles", 0}, {"wave fit", 0}, {"n_filters=2 fit", 0},
    {"k=2 columns_sparse", FAIL_DEPENDS}, {"held border krylov n_times=3 k=2 columns_sparse", 0}, {"local k=2 columns", 0},
    {"held local n_times=3 k=2 columns_sparse", 0}, {"local n_times=2 operator entries", 0}, {"local k=2 f=u apply", 0},
    {"held local n_times=2 distance", 0}, {"weighted local k=1 distance_from", 0}, {"voronoi local sample", 0},
    {"held border local n_times=3 k=1 derivative", 0}, {"voronoi local columns_from", 0},
    {"updatable local k=1 columns update | columns", FAIL_GOES_ON}, {"local k=100 estimate", FAIL_GOES_ON},
};

enum { FAIL_CASES = sizeof fail_cases / sizeof *fail_cases };

/* ---- one case ---- */

typedef struct fail_world { call_world w; hd_context ctx; test_memory m; rob_progress p; } fail_world;

/* What a clean call does. */
typedef struct fail_want {
    double *out, *again;        /* again: by a second call, which may use what the first one kept */
    int64_t calls, progress;
    uint64_t before, after, peak, after_again;
    double bound;
} fail_want;

static call_data fail_data;

static void fail_begin(fail_world *f, const fail_case *c) {
    f->ctx = test_memory_context(&f->m);
    f->ctx.n_threads = 1;
    memset(&f->p, 0, sizeof f->p);
    call_open(&f->w, &fail_data, &f->ctx);
    f->w.what = c->script;
    CHECK_MSG(call_prepare(&f->w, c->script) >= 0, "%s: %s", c->script, f->w.e.text);
    f->ctx.bytes_peak = f->ctx.bytes_in_use;
}

static void fail_end(fail_world *f, const fail_case *c) {
    f->ctx.progress = NULL;
    call_close(&f->w);
    test_memory_done(&f->m, &f->ctx, c->script);
}

static void fail_clean(fail_world *f, const fail_case *c, fail_want *want) {
    fail_begin(f, c);
    want->out = (double *)dense_alloc((int64_t)f->w.out_size, 1);
    want->again = (double *)dense_alloc((int64_t)f->w.out_size, 1);
    want->before = f->ctx.bytes_in_use;
    want->calls = f->m.calls;
    rob_watch(&f->p, &f->ctx, 0);
    CHECK_MSG(call_test(&f->w, c->script) >= 0, "%s: %s", c->script, f->w.e.text);
    CHECK_MSG(f->ctx.bytes_in_use == f->m.bytes && f->ctx.allocations == (uint64_t)f->m.calls, "%s: other books", c->script);
    want->calls = f->m.calls - want->calls;
    want->progress = f->p.calls;
    want->after = f->ctx.bytes_in_use;
    want->peak = f->ctx.bytes_peak;
    want->bound = f->w.rep.error_bound;
    memcpy(want->out, f->w.out, f->w.out_size);
    CHECK_MSG(call_test(&f->w, c->script) >= 0 && (c->goes_on == FAIL_DEPENDS || memcmp(f->w.out, want->out, f->w.out_size) == 0),
              "%s: the second time other bits", c->script);
    memcpy(want->again, f->w.out, f->w.out_size);
    want->after_again = f->ctx.bytes_in_use;
    fail_end(f, c);
}

/* Do they agree within their bounds, each relative to its largest value? */
static int fail_agree(const double *a, const double *b, size_t n, double bound_a, double bound_b) {
    double room = bound_a * dense_max_abs(a, (int64_t)n) + bound_b * dense_max_abs(b, (int64_t)n);
    size_t k;
    int ok = 1;
    if (isnan(room)) room = HUGE_VAL;            /* an infinite bound of zeros */
    for (k = 0; k < n; k++) ok &= a[k] == b[k] || fabs(a[k] - b[k]) <= room;         /* both may be infinite */
    return ok;
}

/* After a failure: what is in use is not more than an answer leaves; asked again, the same bits and bytes. */
static void fail_recover(fail_world *f, const fail_case *c, const fail_want *want, const char *how, int64_t k) {
    const call_world *const w = &f->w;
    hd_status st;
    f->m.fail_at = 0;
    f->m.fail_one_in = 0;
    f->ctx.progress = NULL;
    f->ctx.byte_limit = 0;
    CHECK_MSG(f->ctx.n_holders > 0 || f->ctx.bytes_in_use == want->before, "%s: %s %lld leaves %llu bytes", c->script, how,
              (long long)k, (unsigned long long)(f->ctx.bytes_in_use - want->before));
    st = call_test(&f->w, c->script);
    CHECK_MSG(st >= 0, "%s: after %s %lld: %s %s", c->script, how, (long long)k, hd_status_name(st), w->e.text);
    if (memcmp(w->out, want->out, w->out_size) == 0 || memcmp(w->out, want->again, w->out_size) == 0) {
        CHECK_MSG(c->goes_on || f->ctx.bytes_in_use == want->after || f->ctx.bytes_in_use == want->after_again,
                  "%s: after %s %lld: %llu bytes in use, not %llu", c->script, how, (long long)k,
                  (unsigned long long)f->ctx.bytes_in_use, (unsigned long long)want->after);
    } else {
        CHECK_MSG(c->goes_on == FAIL_DEPENDS && w->has_report &&
                      fail_agree(w->out, want->out, w->out_size / sizeof(double), w->rep.error_bound, want->bound),
                  "%s: after %s %lld: other bits, where bounds are %g and %g", c->script, how, (long long)k, w->rep.error_bound,
                  want->bound);
        /* bounds above 1 say no more than infinite ones */
        CHECK_MSG(w->rep.error_bound <= fmax(2 * want->bound, 1e-6) || want->bound > 1, "%s: after %s %lld: bound %g, not %g",
                  c->script, how, (long long)k, w->rep.error_bound, want->bound);
    }
    fail_end(f, c);
}

/* 3: only each third allocation fails, and of the next case those after them. */
static int64_t fail_step = 1;

static void fail_each_allocation(fail_world *f, const fail_case *c, const fail_want *want) {
    static int64_t first;
    int64_t k;
    hd_status st;
    first = first % fail_step + 1;
    for (k = first; k <= want->calls; k += fail_step) {
        fail_begin(f, c);
        f->m.fail_at = f->m.calls + k;
        st = call_test(&f->w, c->script);
        CHECK_MSG(st == HD_ERR_MEMORY, "%s: allocation %lld failed, but %s", c->script, (long long)k, hd_status_name(st));
        fail_count.memory++;
        fail_recover(f, c, want, "failed allocation", k);
    }
}

/* Draws of failures at random for each case. */
enum { FAIL_DRAWS = CASES_FEW ? 4 : 12 };

static void fail_at_random(fail_world *f, const fail_case *c, const fail_want *want) {
    int64_t k;
    hd_status st;
    for (k = 1; k <= FAIL_DRAWS; k++) {
        fail_begin(f, c);
        f->m.random = (uint32_t)k * 2654435761u;
        f->m.fail_one_in = 2 + (want->calls >> (k % 4));
        st = call_test(&f->w, c->script);
        CHECK_MSG(st == HD_ERR_MEMORY || (st >= 0 && f->m.failed == 0), "%s: at random %lld, but %s", c->script, (long long)k,
                  hd_status_name(st));
        fail_count.random += f->m.failed;
        fail_recover(f, c, want, "failures at random", k);
    }
}

static void fail_each_progress(fail_world *f, const fail_case *c, const fail_want *want) {
    int64_t k;
    hd_status st;
    for (k = 1; k <= want->progress; k++) {
        fail_begin(f, c);
        rob_watch(&f->p, &f->ctx, k);
        st = call_test(&f->w, c->script);
        CHECK_MSG(st == HD_ERR_CANCELLED, "%s: cancelled at %lld, but %s", c->script, (long long)k, hd_status_name(st));
        CHECK_MSG(f->p.calls == k, "%s: cancelled at %lld, but asked %lld times", c->script, (long long)k, (long long)f->p.calls);
        fail_count.cancelled++;
        fail_recover(f, c, want, "cancelling", k);
    }
}

/* Limits to the byte: what it took suffices; a byte less does not, or leads another way that keeps to the limit. */
static void fail_limits(fail_world *f, const fail_case *c, const fail_want *want) {
    uint64_t limit;
    hd_status st;
    int k;
    for (k = 0; k < 8; k++) {
        const uint64_t part = (want->peak - want->before) * (uint64_t)(8 - k) / 7;
        limit = k == 0 ? want->peak : k == 1 ? want->peak - 1 : want->before + part;
        if (want->peak == want->before || limit <= want->before) continue;
        fail_begin(f, c);
        f->ctx.byte_limit = limit;
        st = call_test(&f->w, c->script);
        CHECK_MSG(f->ctx.bytes_peak <= limit, "%s: %llu bytes under a limit of %llu", c->script,
                  (unsigned long long)f->ctx.bytes_peak, (unsigned long long)limit);
        if (k == 0) CHECK_MSG(st >= 0, "%s: a limit of its own peak: %s", c->script, f->w.e.text);
        else if (limit < want->peak)
            CHECK_MSG(st == HD_ERR_MEMORY_LIMIT || (c->goes_on && st >= 0), "%s: limit %llu of %llu, but %s", c->script,
                      (unsigned long long)limit, (unsigned long long)want->peak, hd_status_name(st));
        if (st < 0)
            CHECK_MSG(f->w.e.value > (double)limit && strstr(f->w.e.text, "byte limit"), "%s: limit %llu: %s, value %g",
                      c->script, (unsigned long long)limit, f->w.e.text, f->w.e.value);
        fail_count.limited += st < 0;
        fail_recover(f, c, want, "limit", (int64_t)limit);
    }
}

static void fail_run(const fail_case *c) {
    static fail_world f;
    fail_want want;
    fail_clean(&f, c, &want);
    fail_each_allocation(&f, c, &want);
    fail_at_random(&f, c, &want);
    fail_each_progress(&f, c, &want);
    fail_limits(&f, c, &want);
    free(want.out);
    free(want.again);
}

/* ---- every query by every method that answers it ---- */

/* Who answers: any method; any but the poles' other solvers, to which what these add is the same; the direct method. */
enum { FAIL_ANY, FAIL_ONCE, FAIL_DIRECT };

/* depends: documented that under a byte limit an estimate guesses where the analysis does not fit, and that distances may
 * come from eigenpairs or from poles, by what the plan has. */
static const struct { const char *words; int who, depends; } fail_asked[] = {
    {"k=1 apply", FAIL_ANY, 0}, {"k=6 columns", FAIL_ANY, 0}, {"operator column", FAIL_ANY, 0}, {"operator entries", FAIL_ANY, 0},
    {"k=1 derivative", FAIL_ONCE, 0}, {"k=1 adjoint", FAIL_ONCE, 0}, {"columns_from", FAIL_ONCE, 0},
    {"sources=curve columns_from", FAIL_ONCE, 0}, {"v=NULL diagonal", FAIL_DIRECT, 0},
    {"operator v=NULL diagonal", FAIL_DIRECT, 0}, {"distance", FAIL_DIRECT, 1},
    {"k=1 weighted distance", FAIL_DIRECT, 1}, {"commute k=2 distance", FAIL_DIRECT, 0},
    {"biharmonic k=2 distance", FAIL_DIRECT, 0}, {"pairs", FAIL_ANY, 1}, {"weighted pairs", FAIL_DIRECT, 1},
    {"commute pairs", FAIL_DIRECT, 0}, {"biharmonic pairs", FAIL_DIRECT, 0}, {"count=1 sample", FAIL_DIRECT, 1},
    {"commute sample", FAIL_DIRECT, 0}, {"sample_from", FAIL_DIRECT, 1},
    {"sources=NULL sample_from", FAIL_DIRECT, 1}, {"t=late distance", FAIL_DIRECT, 1},
    {"t=late pairs", FAIL_DIRECT, 1}, {"u=NULL diagonal", FAIL_DIRECT, 0}, {"diagonal", FAIL_DIRECT, 0},
    {"operator diagonal", FAIL_DIRECT, 0}, {"distance_from", FAIL_DIRECT, 1},
    {"sources=curve distance_from", FAIL_DIRECT, 1}, {"k=100 estimate", FAIL_ANY, 1},
};

enum { FAIL_QUERIES = sizeof fail_asked / sizeof *fail_asked };

static const char *const fail_laplacians[3] = {"", "voronoi", "held border"};

/* At one time and at many, at endless times, and after the plan has answered and the surface has moved. */
static void fail_query(const char *method, int way, int q) {
    const char *const words = fail_asked[q].words;
    const char *const last = strrchr(words, ' ');
    const int direct = way == 0 || way == 4, brief = CASES_FEW && way == 2;      /* which allocates as way 1 does */
    char text[200];
    fail_case c;
    int many;
    c.script = text;
    for (many = 0; many < (brief ? 1 : 2); many++) {
        const char *const times = many && !strstr(words, "commute") && !strstr(words, "biharmonic") ? "n_times=3" : "";
        const int turn = q + many * FAIL_QUERIES + way;
        /* under a limit preconditioners are made in turns, also for derivatives of plans with Lanczos; auto takes iterations, times do
         * without shared poles; where heat fades, eigenpairs may serve if the plan has them */
        const int depends = way <= 2 || fail_asked[q].depends || turn % 3 == 2 || (way == 3 && strstr(words, "derivative"));
        c.goes_on = depends ? FAIL_DEPENDS : way == 4 ? FAIL_GOES_ON : FAIL_TELLS;
        snprintf(text, sizeof text, "%s %s %s %s", fail_laplacians[turn % 3], method, times, words);
        fail_run(&c);
        snprintf(text, sizeof text, "%s %s t=endless %s %s", fail_laplacians[turn % 2], method, times, words);
        if (direct && !strstr(words, "estimate") && !strstr(words, "t=late")) fail_run(&c);
    }
    snprintf(text, sizeof text, "updatable %s %s update | %s", method, words, last ? last + 1 : words);
    if (!brief && !strstr(words, "estimate")) fail_run(&c);
}

static void fail_methods(void) {
    static const char *const methods[6] = {"auto", "iterative cocg", "iterative minres", "iterative lanczos",
                                           "direct", "krylov"};
    int way, q;
    for (way = 0; way < 6; way++)
        for (q = 0; q < FAIL_QUERIES; q++) {
            const int direct = way == 0 || way == 4;
            if (fail_asked[q].who == FAIL_DIRECT && !direct) continue;
            if (fail_asked[q].who == FAIL_ONCE && way == 2) continue;
            fail_query(methods[way], way, q);
        }
}

/* What few eigenpairs serve where heat fades. */
static void fail_fading(void) {
    static const char *const words[7] = {"n_times=1 k=1 f=u apply", "k=6 columns", "operator entries", "diagonal",
                                         "operator diagonal", "u=NULL diagonal", "query=3 estimate"};
    char text[200];
    fail_case c;
    int q, w;
    c.script = text;
    c.goes_on = FAIL_DEPENDS;                    /* with poles */
    for (q = 0; q < 7; q++)
        for (w = 0; w < 2; w++) {
            snprintf(text, sizeof text, "%s t=fading n_times=3 %s", w ? "held border voronoi" : "held", words[q]);
            fail_run(&c);
        }
}

/* ---- single cases ---- */

/* What the allocation limit says is what suffices, one more each time. */
static void fail_allocation_limit(void) {
    hd_context ctx;
    call_world w;
    hd_status st = HD_ERR_MEMORY_LIMIT;
    uint64_t count = 0;
    memset(&ctx, 0, sizeof ctx);
    memset(&w, 0, sizeof w);
    call_open(&w, &fail_data, &ctx);
    w.what = "allocation limit";
    for (ctx.allocation_limit = 1; st == HD_ERR_MEMORY_LIMIT && count < 1000; count++) {
        ctx.allocations = 0;
        st = call_test(&w, "triangles");
        if (st >= 0) break;
        CHECK_MSG(w.e.value == (double)(ctx.allocation_limit + 1) && strstr(w.e.text, "allocation"), "%s: %g", w.e.text,
                  w.e.value);
        ctx.allocation_limit = (uint64_t)w.e.value;
    }
    CHECK_MSG(st == HD_OK && count + 1 == ctx.allocations, "%s after %d", hd_status_name(st), (int)count);
    call_world_free(&w);
}

/* All eigenpairs, no time and endless times: neither a value nor a bound is NaN (0 times infinity), and the values are
 * those in closed form. */
static void fail_spectrum_ends(void) {
    static const double times[4] = {0, 1, 1e300, DBL_MAX};
    static const int32_t id[2] = {0, 13};
    call_world w;
    double u[21 * 8], b[21 * 8];
    const hd_spectrum *s;
    hd_context ctx;
    int32_t k;
    memset(&w, 0, sizeof w);
    memset(&ctx, 0, sizeof ctx);
    call_open(&w, &fail_data, &ctx);
    CHECK(call_prepare(&w, "voronoi so.count=21 eigen_diagonal") == HD_OK);
    s = w.a.spectrum;
    CHECK(s->count == s->lap->n_active && s->next >= HUGE_VAL);
    CHECK(hd_spectrum_columns(s, HD_KERNEL_OPERATOR, 4, times, VERTICES(2, id), u, b, 0, NULL) == HD_OK);
    for (k = 0; k < 21 * 8; k++)
        CHECK_MSG(fabs(u[k]) <= 1.0001 && b[k] >= 0 && b[k] < 1e-6, "%d: %g, bound %g", (int)k, u[k], b[k]);
    for (k = 0; k < 21; k++)
        CHECK_MSG(fabs(u[k] - (k == 0)) < 1e-9 && fabs(u[84 + k] - (k == 13)) < 1e-9, "t = 0, vertex %d: %g, %g", (int)k, u[k],
                  u[84 + k]);
    CHECK(hd_spectrum_diagonal(s, HD_KERNEL_OPERATOR, 4, times, u, b, 0, NULL) == HD_OK);
    for (k = 0; k < 21 * 4; k++)
        CHECK_MSG(u[k] >= 0 && u[k] <= 1.0001 && b[k] >= 0 && b[k] < 1e-6, "%d: %g, bound %g", (int)k, u[k], b[k]);
    CHECK(hd_spectrum_distance(s, HD_DISTANCE_CLASSICAL, 3, times + 1, VERTICES(2, id), u, b, 0, NULL) == HD_OK);
    for (k = 0; k < 21 * 6; k++) CHECK_MSG(u[k] >= 0 && u[k] < 100 && b[k] >= 0, "%d: %g, bound %g", (int)k, u[k], b[k]);
    for (k = 0; k < 12; k++) CHECK_MSG(u[42 + k] < 1e-9, "one value on the component, at vertex %d: %g", (int)k, u[42 + k]);
    CHECK(hd_spectrum_distance(s, HD_DISTANCE_BIHARMONIC, 0, NULL, VERTICES(2, id), u, b, 0, NULL) == HD_OK);
    for (k = 0; k < 21 * 2; k++) CHECK_MSG(u[k] >= 0 && b[k] >= 0, "%d: %g, bound %g", (int)k, u[k], b[k]);
    call_close(&w);
    call_world_free(&w);
}

/* Points so far apart that squares of distances overflow have no neighbours: an error or an answer, and no harm. */
static void fail_far_points(void) {
    double xyz[3 * 9];
    int32_t k;
    for (k = 0; k < 27; k++) xyz[k] = (k % 7 - 3) * 1e200 + (k % 4) * 1e199;
    for (k = 0; k < 2; k++) {
        hd_laplacian *lap = NULL;
        const hd_status st = k ? hd_laplacian_create(&lap, MESH_POINTS(xyz, 9), NULL, NULL)
                               : at_tufted(&lap, xyz, 9, NULL, NULL, NULL, NULL);
        CHECK(st < 0 ? !lap : lap != NULL);
        hd_laplacian_free(lap);
    }
}

/* Areas of faces beyond what is taken. */
static void fail_large_area(void) {
    static const double xyz[12] = {0, 0, 0, 1.5e50, 0, 0, 0, 1.5e50, 0, 1.5e50, 1.5e50, 0};
    static const int32_t tri[6] = {0, 1, 2, 2, 1, 3};
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, tri, 2), NULL, &e) == HD_ERR_ARGUMENT && !lap);
    CHECK(strstr(e.text, "area") != NULL);
}

/* A time of -0 is 0. */
static void fail_minus_zero(void) {
    static const int32_t i[2] = {0, 3}, j[2] = {5, 3};
    static const double t = -0.0;
    double K[2], d[2];
    hd_laplacian *lap = kit_triangles(&fail_data.s, HD_LAPLACIAN_VORONOI_COT);
    hd_heat *heat = kit_plan(lap, NULL);
    CHECK(hd_heat_distance_pairs(heat, HD_DISTANCE_CLASSICAL, 1, &t, 2, i, j, d, NULL, NULL) == HD_OK);
    CHECK(hd_heat_entries(heat, HD_KERNEL_OPERATOR, 1, &t, 2, i, j, K, NULL, NULL) == HD_OK);
    CHECK(K[0] == 0 && K[1] == 1 && d[0] > 0 && d[1] == 0);
}

static void fail_open(void) {
    call_data_make(&fail_data, call_pair_of_shapes());
    memset(&fail_count, 0, sizeof fail_count);
}

/* At least so many failures there were. */
static void fail_close(const char *what, int64_t memory, int64_t random, int64_t cancelled, int64_t limited) {
    call_data_free(&fail_data);
    printf("failures, %s: %lld allocations in turn, %lld at random, %lld cancelled, %lld by limits\n", what,
           (long long)fail_count.memory, (long long)fail_count.random, (long long)fail_count.cancelled,
           (long long)fail_count.limited);
    CHECK(fail_count.memory >= memory && fail_count.random >= random * FAIL_DRAWS / 12);
    CHECK(fail_count.cancelled >= cancelled && fail_count.limited >= limited);
}

static void fail_single(void) {
    fail_open();
    fail_minus_zero();
    fail_allocation_limit();
    fail_far_points();
    fail_large_area();
    fail_spectrum_ends();
    fail_close("single", 0, 0, 0, 0);
}

static void fail_calls(void) {
    int k;
    fail_open();
    for (k = 0; k < FAIL_CASES; k++) fail_run(fail_cases + k);
    fail_close("calls", 1000, 500, 200, 300);
}

static void fail_queries(void) {
    fail_open();
    fail_step = CASES_FEW ? 11 : 1;
    fail_methods();
    fail_close("queries", 15000 / fail_step, 2000, 5000, 1500);
    fail_step = 1;
}

static void fail_held(void) {
    fail_open();
    fail_fading();
    fail_close("held vertices", 100, 50, 50, 50);
}

static void test_failures(void) {
    fail_single();
    fail_calls();
    fail_queries();
    fail_held();
}

#endif
