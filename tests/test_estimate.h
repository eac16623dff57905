/* What a query will take is told before it runs: bytes against what is allocated, and the end at once where they do not fit. */

typedef struct est_case {
    hd_query query;
    hd_method method;
    int32_t n_times, k;
    double from, ratio;                          /* times in units of h^2: the first, and the last over the first */
    int large;                                   /* for a large mesh */
} est_case;

static const est_case EST_CASES[] = {
    {HD_QUERY_COLUMNS, HD_METHOD_DIRECT, 1, 1, 10, 1, 0},
    {HD_QUERY_COLUMNS, HD_METHOD_DIRECT, 1, 100, 10, 1, 0},
    {HD_QUERY_COLUMNS, HD_METHOD_DIRECT, 3, 5, 10, 100, 0},
    {HD_QUERY_PAIRS, HD_METHOD_DIRECT, 1, 10, 10, 1, 0},
    {HD_QUERY_DIAGONAL, HD_METHOD_AUTO, 1, 0, 5, 1, 0},
    {HD_QUERY_DIAGONAL, HD_METHOD_DIRECT, 16, 0, 1, 1000, 0},
    {HD_QUERY_DIAGONAL, HD_METHOD_AUTO, 2, 0, 1, 3, 0},
    {HD_QUERY_DIAGONAL_OPERATOR, HD_METHOD_AUTO, 1, 0, 5, 1, 0},
    {HD_QUERY_TRACE, HD_METHOD_AUTO, 1, 0, 5, 1, 0},
    {HD_QUERY_TRACE, HD_METHOD_DIRECT, 16, 0, 1, 1000, 0},
    {HD_QUERY_TRACE, HD_METHOD_AUTO, 2, 0, 1, 3, 0},
    {HD_QUERY_TRACE, HD_METHOD_AUTO, 1, 1, 5, 1, 0},                /* with the diagonals */
    {HD_QUERY_TRACE, HD_METHOD_AUTO, 16, 1, 1, 1000, 0},
    {HD_QUERY_DISTANCE, HD_METHOD_AUTO, 1, 3, 5, 1, 0},
    {HD_QUERY_DISTANCE, HD_METHOD_AUTO, 1, 1, 100, 1, 1},
    {HD_QUERY_DISTANCE, HD_METHOD_AUTO, 1, 50, 5, 1, 0},
    {HD_QUERY_DISTANCE, HD_METHOD_AUTO, 16, 2, 1, 1000, 1},
    {HD_QUERY_DISTANCE_WEIGHTED, HD_METHOD_AUTO, 1, 2, 5, 1, 1},
    {HD_QUERY_DISTANCE_WEIGHTED, HD_METHOD_AUTO, 16, 2, 1, 1000, 1},
    {HD_QUERY_DISTANCE_COMMUTE, HD_METHOD_AUTO, 0, 2, 0, 1, 0},
    {HD_QUERY_DISTANCE_BIHARMONIC, HD_METHOD_AUTO, 0, 2, 0, 1, 0},
};
enum { EST_N_CASES = sizeof EST_CASES / sizeof EST_CASES[0], EST_MOST_TIMES = 16, EST_MOST_K = 100 };

static int64_t est_values(const hd_laplacian *lap, const est_case *c) {
    const int64_t rows = lap->n;
    return rows * (c->k > 0 ? c->k : 1) * (c->n_times > 0 ? c->n_times : 1);
}

static void est_times(const hd_laplacian *lap, const est_case *c, double *t) {
    int32_t i;
    for (i = 0; i < c->n_times; i++)
        t[i] = c->from * lap->h * lap->h * pow(c->ratio, c->n_times > 1 ? i / (c->n_times - 1.0) : 0);
}

static hd_status est_run(hd_heat *heat, const hd_laplacian *lap, const est_case *c, double *U, hd_report *rep) {
    double t[EST_MOST_TIMES], Z[EST_MOST_TIMES];
    int32_t source[EST_MOST_K], i;
    hd_status st;
    est_times(lap, c, t);
    for (i = 0; i < EST_MOST_TIMES; i++) Z[i] = 77;
    for (i = 0; i < EST_MOST_K; i++) source[i] = lap->vertex[i * 7919 % lap->n_active];
    for (i = 0; c->query == HD_QUERY_FIELDS && i < lap->n * c->k; i++) U[lap->n * c->k * c->n_times + i] = sin(1.3 * i) + 0.1;
    switch (c->query) {
        case HD_QUERY_FIELDS: return hd_heat_apply(heat, c->n_times, t, c->k, U + lap->n * c->k * c->n_times, 0, U, 0, rep, NULL);
        case HD_QUERY_COLUMNS: return hd_heat_columns(heat, HD_KERNEL_OPERATOR, c->n_times, t, VERTICES(c->k, source), U, 0, rep, NULL);
        case HD_QUERY_PAIRS:
            return hd_heat_distance_pairs(heat, HD_DISTANCE_CLASSICAL, c->n_times, t, c->k / 2, source, source + c->k / 2, U, rep, NULL);
        case HD_QUERY_DIAGONAL: return hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, c->n_times, t, U, 0, NULL, NULL, rep, NULL);
        case HD_QUERY_DIAGONAL_OPERATOR: return hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, c->n_times, t, U, 0, NULL, NULL, rep, NULL);
        case HD_QUERY_TRACE:
            if (!c->k) return hd_heat_diagonal(heat, HD_KERNEL_OPERATOR, c->n_times, t, NULL, 0, U, NULL, rep, NULL);
            st = hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, c->n_times, t, U, 0, Z, NULL, rep, NULL);
            for (i = 0; st < 0 && i < c->n_times; i++) CHECK(Z[i] == 77);
            return st;
        default:                                 /* queries of distances are in the order of their kinds */
            return hd_heat_distance(heat, (hd_distance_kind)(c->query - HD_QUERY_DISTANCE), c->n_times, t, VERTICES(c->k, source), U,
                                    0, rep, NULL);
    }
}

/* Calls of the stages that an early end must not reach. */
static hd_progress est_on_progress(void *user, const char *stage, double done) {
    int64_t *calls = (int64_t *)user;
    (void)done;
    *calls += strcmp(stage, "factor") == 0 || strcmp(stage, "invert") == 0 || strcmp(stage, "solve") == 0;
    return HD_PROGRESS_CONTINUE;
}

/* Within a limit below its need a query ends before any work and writes nothing; its error says the need, within which it runs. */
static void est_early(const hd_laplacian *lap, const est_case *c, uint64_t before, uint64_t truth, const char *what) {
    const int64_t n_values = est_values(lap, c);
    double *U = KIT_NEW(double, n_values);
    int64_t calls = 0, i, tries;
    hd_context ctx;
    hd_heat_opts o = eng_opts(c->method);
    hd_heat *heat;
    hd_report rep;
    hd_status st;
    memset(&ctx, 0, sizeof ctx);
    ctx.n_threads = 1;
    ctx.progress = est_on_progress;
    ctx.progress_user = &calls;
    o.context = &ctx;
    for (i = 0; i < n_values; i++) U[i] = 77;
    /* The later ones of several times, and degree 9 instead of 14, have needs of their own: no times here that need both. */
    ctx.byte_limit = before + truth / 4;
    heat = eng_create(lap, &o);
    st = est_run(heat, lap, c, U, &rep);
    CHECK_MSG(st == HD_ERR_MEMORY_LIMIT && rep.error.status == st && rep.error.value > (double)ctx.byte_limit && strstr(rep.error.text, "MB") != NULL,
              "%s: %s: %s", what, hd_status_name(st), rep.error.text);
    CHECK_MSG(calls == 0, "%s: %d calls of long stages", what, (int)calls);
    for (i = 0; i < n_values && U[i] == 77; i++) {}
    CHECK_MSG(i == n_values, "%s: something is written", what);
    for (tries = 0; tries < 4 && st == HD_ERR_MEMORY_LIMIT; tries++) {
        ctx.byte_limit = (uint64_t)rep.error.value;
        st = est_run(heat, lap, c, U, &rep);
    }
    CHECK_MSG(st >= 0 && ctx.byte_limit <= before + truth, "%s: a limit of %g of %g: %s", what, (double)ctx.byte_limit, (double)(before + truth), rep.error.text);
    hd_heat_free(heat);
    CHECK(ctx.bytes_in_use == 0);
}

static void est_compare(const hd_laplacian *lap, const est_case *c, const char *shape_name) {
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    hd_heat_opts o = eng_opts(c->method);
    double *U = KIT_NEW(double, est_values(lap, c)), t[EST_MOST_TIMES], truth;
    hd_heat *heat;
    hd_estimate e;
    hd_report rep;
    hd_error err;
    uint64_t before;
    char what[80];
    snprintf(what, sizeof what, "%s, query %d, %d times, k = %d", shape_name, (int)c->query, (int)c->n_times, (int)c->k);
    ctx.n_threads = 1;
    o.context = &ctx;
    heat = eng_create(lap, &o);
    est_times(lap, c, t);
    if (CHECK_MSG(hd_heat_estimate(heat, c->query, c->n_times, t, c->k, &e, &err) == HD_OK, "%s: %s", what, err.text)) {
        before = ctx.bytes_in_use;
        CHECK(e.bytes_in_use == (double)before && e.bytes_left > 1e300 && e.analysed && e.method == HD_METHOD_DIRECT && e.reason && e.cost[0].fits);
        CHECK(memcmp(&e.cost[0], &e.cost[HD_METHOD_DIRECT], sizeof e.cost[0]) == 0 && e.cost[0].possible);
        CHECK(e.cost[0].flops > 0 && e.cost[0].seconds > 0 && e.cost[0].bytes_most >= e.cost[0].bytes);
        ctx.bytes_peak = before;
        CHECK(eng_ok(est_run(heat, lap, c, U, &rep), &rep, what));
        truth = (double)(ctx.bytes_peak - before);
        CHECK_MSG(rep.method == e.method, "%s: %s, and %s was expected", what, eng_name(rep.method), eng_name(e.method));
        CHECK_MSG(e.cost[0].bytes >= truth || e.cost[0].bytes_most >= truth, "%s: %.0f bytes, estimated %.0f to %.0f", what, truth, e.cost[0].bytes, e.cost[0].bytes_most);
        /* where degree 14 took over the need is the larger one */
        if (e.cost[0].bytes >= truth) CHECK_MSG(e.cost[0].bytes <= 1.3 * truth, "%s: %.0f bytes, estimated %.0f", what, truth, e.cost[0].bytes);
        else CHECK_MSG(rep.degree == 14 && e.cost[0].bytes_most <= 1.3 * truth, "%s: degree %d", what, (int)rep.degree);
        if (c->n_times <= 1 && e.cost[0].bytes >= truth && rep.degree != 14) est_early(lap, c, before, (uint64_t)truth, what);
        /* all is there: the same again takes next to nothing */
        if (c->query == HD_QUERY_COLUMNS && c->n_times == 1) {
            CHECK(hd_heat_estimate(heat, c->query, c->n_times, t, c->k, &e, &err) == HD_OK);
            CHECK_MSG(e.cost[0].bytes < 0.5 * truth, "%s: %.0f after %.0f", what, e.cost[0].bytes, truth);
        }
    }
    hd_heat_free(heat);
    test_memory_done(&m, &ctx, what);
}

/* Columns by each method: estimates of the other two are estimates. */
static void est_methods(const hd_laplacian *lap) {
    static const hd_method methods[4] = {HD_METHOD_AUTO, HD_METHOD_ITERATIVE, HD_METHOD_DIRECT, HD_METHOD_KRYLOV};
    static const int32_t ks[3] = {1, 4, 20};
    double *U = KIT_NEW(double, 20 * lap->n);
    int q, w;
    for (q = 0; q < 4; q++) {
        for (w = 0; w < 3; w++) {
            const est_case c = {HD_QUERY_COLUMNS, methods[q], 1, ks[w], 20, 1, 0};
            hd_context ctx;
            hd_heat_opts o = eng_opts(methods[q]);
            hd_heat *heat;
            hd_estimate e;
            hd_report rep;
            uint64_t before;
            double t[1], truth;
            memset(&ctx, 0, sizeof ctx);
            o.context = &ctx;
            heat = eng_create(lap, &o);
            est_times(lap, &c, t);
            CHECK(hd_heat_estimate(heat, c.query, 1, t, c.k, &e, NULL) == HD_OK);
            before = ctx.bytes_in_use;
            ctx.bytes_peak = before;
            CHECK(eng_ok(est_run(heat, lap, &c, U, &rep), &rep, "methods"));
            truth = (double)(ctx.bytes_peak - before);
            CHECK_MSG(rep.method == e.method && strcmp(rep.reason, e.reason) == 0, "%s: %s, not %s", eng_name(methods[q]), rep.reason, e.reason);
            CHECK_MSG(e.cost[0].bytes > 0.7 * truth && e.cost[0].bytes < 1.5 * truth, "%s, %d: %.0f bytes, estimated %.0f", eng_name(methods[q]), (int)c.k, truth, e.cost[0].bytes);
            CHECK(e.cost[1].possible && e.cost[2].possible && e.cost[3].possible);
            hd_heat_free(heat);
        }
    }
}

/* A limit: what fits and what does not, and that the query agrees. */
static void est_limits(const hd_laplacian *lap) {
    const double t = 10 * lap->h * lap->h;
    double *U = KIT_NEW(double, 20 * lap->n);
    const est_case c = {HD_QUERY_COLUMNS, HD_METHOD_AUTO, 1, 20, 10, 1, 0};
    hd_context ctx;
    hd_heat_opts o = eng_opts(HD_METHOD_AUTO);
    hd_heat *heat;
    hd_estimate all, e;
    hd_report rep;
    uint64_t limit;
    char text[80];
    int fit = 0, not_fit = 0, told = 0;
    memset(&ctx, 0, sizeof ctx);
    o.context = &ctx;
    heat = eng_create(lap, &o);
    CHECK(hd_heat_estimate(heat, HD_QUERY_DIAGONAL, 1, &t, 0, &all, NULL) == HD_OK);
    for (limit = ctx.bytes_in_use / 2; limit < 2 * (uint64_t)(all.bytes_in_use + all.cost[0].bytes); limit += limit / 5) {
        hd_status st;
        hd_heat_free(heat);
        ctx.byte_limit = limit;
        heat = eng_create(lap, &o);
        CHECK(hd_heat_estimate(heat, HD_QUERY_DIAGONAL, 1, &t, 0, &e, NULL) == HD_OK && e.method == HD_METHOD_DIRECT);
        CHECK(e.bytes_left == (double)limit - e.bytes_in_use && e.cost[0].fits == (e.cost[0].bytes <= e.bytes_left));
        st = hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, U, 0, NULL, NULL, &rep, NULL);
        if (e.cost[0].fits) CHECK_MSG(st >= 0, "%llu: %s", (unsigned long long)limit, rep.error.text);
        else if (e.analysed && e.cost[0].bytes > 1.1 * e.bytes_left) CHECK_MSG(st == HD_ERR_MEMORY_LIMIT, "%llu", (unsigned long long)limit);
        if (st < 0 && strstr(rep.error.text, " would bring ")) {      /* told before it begins, with both numbers */
            snprintf(text, sizeof text, "in use to %.1f MB, and the byte limit is %.1f MB", ceil(rep.error.value / 1e5) / 10, ceil((double)limit / 1e5) / 10);
            CHECK_MSG(strstr(rep.error.text, text) && rep.error.value > (double)limit, "%s", rep.error.text);
            told++;
        }
        fit += e.cost[0].fits;
        not_fit += !e.cost[0].fits;
        CHECK(hd_heat_estimate(heat, HD_QUERY_COLUMNS, 1, &t, 20, &e, NULL) == HD_OK);
        if (e.cost[0].fits) CHECK_MSG(est_run(heat, lap, &c, U, &rep) >= 0, "%llu, %s: %s", (unsigned long long)limit, eng_name(e.method), rep.error.text);
    }
    CHECK(fit > 2 && not_fit > 2 && told > 2);
    hd_heat_free(heat);
}

/* Within what the estimate says a query finds a way; within bytes_most it is the way, to the bit, that it takes without a limit. */
static void est_room(const hd_laplacian *lap, const est_case *c, const char *what) {
    const size_t n = (size_t)est_values(lap, c), extra = (size_t)(lap->n * c->k);
    double *U[3], t[EST_MOST_TIMES], most = 0;
    hd_estimate e = {HD_METHOD_AUTO, NULL, 0, {{0, 0, 0, 0, 0, 0}}, 0, 0};
    hd_report rep[3];
    size_t q;
    int pass;
    est_times(lap, c, t);
    for (pass = 0; pass < 3; pass++) {
        hd_heat_opts o = eng_opts(c->method);
        hd_context ctx;
        hd_heat *heat;
        hd_status st;
        U[pass] = DENSE_NEW(double, n + extra);
        memset(&ctx, 0, sizeof ctx);
        ctx.n_threads = 1;
        o.context = &ctx;
        heat = eng_create(lap, &o);
        CHECK(hd_heat_estimate(heat, c->query, c->n_times, t, c->k, &e, NULL) == HD_OK);
        if (pass > 0) ctx.byte_limit = ctx.bytes_in_use + 1 + (uint64_t)(pass == 1 ? e.cost[0].bytes : e.cost[0].bytes_most);
        ctx.bytes_peak = ctx.bytes_in_use;
        st = est_run(heat, lap, c, U[pass], rep + pass);
        CHECK_MSG(st >= 0 && (!ctx.byte_limit || ctx.bytes_peak <= ctx.byte_limit), "%s: within %g of %g bytes: %s: %s", what,
                  pass == 1 ? e.cost[0].bytes : e.cost[0].bytes_most, e.cost[0].bytes_most, hd_status_name(st), rep[pass].error.text);
        hd_heat_free(heat);
        CHECK(ctx.bytes_in_use == 0);
    }
    for (q = 0; q < n; q++) most = fmax(most, fabs(U[0][q]));
    for (q = 0; q < n && fabs(U[0][q] - U[1][q]) <= (rep[0].error_bound + rep[1].error_bound) * most * 1.001; q++) {}
    CHECK_MSG(q == n || !isfinite(rep[1].error_bound), "%s: %g, not %g, with bounds %g and %g", what, U[1][q % n], U[0][q % n], rep[1].error_bound, rep[0].error_bound);
    CHECK_MSG(e.method != HD_METHOD_DIRECT || (memcmp(U[0], U[2], n * sizeof **U) == 0 && rep[0].error_bound == rep[2].error_bound),
              "%s: other bits, bounds %g and %g", what, rep[0].error_bound, rep[2].error_bound);
    for (pass = 0; pass < 3; pass++) free(U[pass]);
}

/* Fair triangles and slivers, at ordinary times and where the plan asks whether only the means are left; with heat that fades. */
static void est_rooms(void) {
    static const hd_laplacian_kind kinds[2] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT};
    char what[100];
    hd_laplacian_opts o;
    int thin, kind, held, large, n_times, query, both, method, i;
    for (thin = 0; thin < 2; thin++) {
        for (kind = 0; kind < (thin ? 2 : 4); kind++) {   /* in slivers heat fades at once */
            const shape *s = kit_shape(kind < 2 ? "flat/9/8/0.3" : "flat/11/10/0.3");
            hd_laplacian *lap = NULL;
            for (i = 0; thin && i < s->n; i++) s->xyz[3 * i + 1] *= 1e-4;
            held = kind / 2;
            memset(&o, 0, sizeof o);
            o.kind = kinds[kind % 2];
            if (held) o.border = HD_BORDER_DIRICHLET;
            CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, NULL) == HD_OK);
            for (method = kind % 2; method < 2; method++) for (large = 0; large < 2; large++) for (n_times = 1; n_times <= 4; n_times += 3)
                for (query = HD_QUERY_FIELDS; query <= HD_QUERY_DISTANCE_WEIGHTED; query++) for (both = 0; both < (query == HD_QUERY_TRACE ? 2 : 1); both++) {
                    const double h2 = lap->h * lap->h, from = !large ? 5 : held ? 40 : 3e8 / lap->lambda_max / h2;
                    est_case c = {HD_QUERY_FIELDS, HD_METHOD_AUTO, n_times, query <= HD_QUERY_PAIRS || query >= HD_QUERY_DISTANCE ? 6 : both, from, 8, 0};
                    c.query = (hd_query)query;
                    if (query == HD_QUERY_PAIRS && n_times > 1) continue;
                    if (method) c.method = HD_METHOD_DIRECT;
                    snprintf(what, sizeof what, "thin %d, kind %d, held %d, method %d, query %d (%d), %d times from %g h^2", thin, kind % 2, held, (int)c.method, query, both, n_times, from);
                    est_room(lap, &c, what);
                }
            hd_laplacian_free(lap);
        }
    }
}

static void est_bad(const hd_laplacian *lap) {
    hd_heat *heat = kit_heat(lap, "method=iterative");
    const double t = 1, none = 0;
    hd_estimate e;
    hd_error err;
    CHECK(hd_heat_estimate(heat, HD_QUERY_DIAGONAL, 1, &t, 1, &e, &err) == HD_ERR_ARGUMENT && err.text[0]);   /* iterations have none */
    CHECK(hd_heat_estimate(heat, HD_QUERY_COLUMNS, 1, &none, 1, &e, &err) == HD_OK && e.cost[0].seconds == 0 && strcmp(e.reason, "t = 0") == 0);
    CHECK(hd_heat_estimate(heat, HD_QUERY_FIELDS, 1, &t, 3, &e, NULL) == HD_OK && e.method == HD_METHOD_ITERATIVE && !e.analysed && e.cost[0].flops > 0);
}

/* Work for one more column by the model, over the steps that one takes, with this solver and preconditioner, for t from h^2 to
 * 1000 h^2: the same within `spread`. */
static void est_steps(const hd_laplacian *lap, hd_solver solver, hd_precond precond, double spread, const char *what) {
    static const double tau[] = {1, 10, 100, 1000};
    double *u = KIT_NEW(double, lap->n), least = HUGE_VAL, most = 0;
    int q;
    for (q = 0; q < 4; q++) {
        hd_heat_opts o = eng_opts(HD_METHOD_ITERATIVE);
        const double t = tau[q] * lap->h * lap->h;
        hd_estimate one, two;
        hd_heat *heat;
        hd_report rep;
        double each;
        o.solver = solver;
        o.precond = precond;
        heat = eng_create(lap, &o);
        CHECK(hd_heat_estimate(heat, HD_QUERY_COLUMNS, 1, &t, 1, &one, NULL) == HD_OK);
        CHECK(hd_heat_estimate(heat, HD_QUERY_COLUMNS, 1, &t, 2, &two, NULL) == HD_OK);
        CHECK(eng_ok(heat_column(heat, t, lap->vertex[lap->n_active / 3], u, &rep), &rep, what));
        each = (two.cost[HD_METHOD_ITERATIVE].flops - one.cost[HD_METHOD_ITERATIVE].flops) / (double)rep.iterations;
        least = fmin(least, each);
        most = fmax(most, each);
        hd_heat_free(heat);
    }
    CHECK_MSG(most <= spread * least, "%s: %g to %g flops a step", what, least / lap->n, most / lap->n);
}

/* The model of steps: fair triangles, points, other preconditioners, thin triangles made Delaunay, and a fine patch. */
static void est_model(void) {
    static const struct { const char *pair; hd_solver solver; hd_precond precond; double spread; } rows[] = {
        {"bumpy/3/3 fem", HD_SOLVER_COCG, HD_PRECOND_AUTO, 2.83}, {"bumpy/3/3 vor", HD_SOLVER_COCG, HD_PRECOND_AUTO, 2.83},
        {"bumpy/3/3 vor", HD_SOLVER_LANCZOS, HD_PRECOND_AUTO, 3.17}, {"bumpy/3/3 vor", HD_SOLVER_COCG, HD_PRECOND_JACOBI, 4},
        {"bumpy/3/3 vor", HD_SOLVER_COCG, HD_PRECOND_SSOR, 4}, {"bumpy/3/3 vor", HD_SOLVER_COCG, HD_PRECOND_ILDL, 4},
        {"flat/30/30/0.35 fem", HD_SOLVER_COCG, HD_PRECOND_AUTO, 2.83}, {"flat/30/30/0.35 vor", HD_SOLVER_COCG, HD_PRECOND_AUTO, 2.83},
        {"flat/30/30/0.35 vor", HD_SOLVER_LANCZOS, HD_PRECOND_AUTO, 3.17}, {"torus/60/20 fem", HD_SOLVER_COCG, HD_PRECOND_AUTO, 2.83},
        {"torus/60/20 vor", HD_SOLVER_COCG, HD_PRECOND_AUTO, 2.83}, {"torus/60/20 vor", HD_SOLVER_LANCZOS, HD_PRECOND_AUTO, 3.17},
    };
    const shape *ball = kit_shape("bumpy/3/3"), *sheet = kit_shape("flat/30/30/0.35");
    hd_laplacian_opts o;
    hd_laplacian *points = NULL, *thin = NULL;
    size_t k;
    int i;
    for (k = 0; k < sizeof rows / sizeof *rows; k++)
        est_steps(kit_pair(rows[k].pair), rows[k].solver, rows[k].precond, rows[k].spread, rows[k].pair);
    CHECK(hd_laplacian_create(&points, MESH_POINTS(ball->xyz, ball->n), NULL, NULL) >= 0);
    est_steps(points, HD_SOLVER_COCG, HD_PRECOND_AUTO, 4, "cocg, points");
    est_steps(points, HD_SOLVER_LANCZOS, HD_PRECOND_AUTO, 2.83, "lanczos, points");
    for (i = 0; i < sheet->n; i++) sheet->xyz[3 * i] *= 10;
    memset(&o, 0, sizeof o);
    o.kind = HD_LAPLACIAN_VORONOI_COT;
    o.triangulation = HD_TRIANGULATION_DELAUNAY;
    CHECK(hd_laplacian_create(&thin, MESH_TRIANGLES(sheet->xyz, sheet->n, sheet->tri, sheet->n_tri), &o, NULL) >= 0);
    est_steps(thin, HD_SOLVER_COCG, HD_PRECOND_AUTO, 6.25, "cocg, thin triangles");
    hd_laplacian_free(points);
    hd_laplacian_free(thin);
}

/* Eigenpairs: bytes against those of hd_spectrum_create, whatever the plan's method. */
static void est_spectrum(const hd_laplacian *lap) {
    static const int32_t counts[] = {1, 20, 150};
    int q;
    for (q = 0; q < 6; q++) {
        const int32_t count = counts[q / 2];
        hd_context plan, own;
        hd_heat_opts o = eng_opts(q % 2 ? HD_METHOD_ITERATIVE : HD_METHOD_AUTO);
        hd_spectrum_opts so;
        hd_spectrum *s = NULL;
        hd_estimate e;
        hd_error err;
        hd_heat *heat;
        memset(&plan, 0, sizeof plan);
        memset(&own, 0, sizeof own);
        memset(&so, 0, sizeof so);
        o.context = &plan;
        heat = eng_create(lap, &o);
        CHECK_MSG(hd_heat_estimate(heat, HD_QUERY_SPECTRUM, 0, NULL, count, &e, &err) == HD_OK, "%s", err.text);
        CHECK(e.method == HD_METHOD_DIRECT && e.analysed && e.cost[0].possible && e.cost[0].fits && e.cost[0].seconds > 0 && !e.cost[1].possible);
        so.count = count;
        so.context = &own;
        CHECK(hd_spectrum_create(&s, lap, &so, NULL) >= 0);
        CHECK_MSG(e.bytes_in_use + e.cost[0].bytes >= 0.95 * (double)own.bytes_peak && e.bytes_in_use + e.cost[0].bytes <= 1.5 * (double)own.bytes_peak,
                  "%d pairs: %.0f bytes, estimated %.0f", (int)count, (double)own.bytes_peak, e.bytes_in_use + e.cost[0].bytes);
        hd_spectrum_free(s);
        hd_heat_free(heat);
    }
}

/* What biharmonic distances take besides commute ones, to a few bytes for each array. */
static void est_ground(void) {
    const hd_laplacian *lap = kit_pair("flat/27/21/0.3 fem");
    double *u = KIT_NEW(double, lap->n), bytes[2], peak[2];
    int k;
    for (k = 0; k < 2; k++) {
        const est_case c = {k ? HD_QUERY_DISTANCE_BIHARMONIC : HD_QUERY_DISTANCE_COMMUTE, HD_METHOD_DIRECT, 0, 1, 0, 1, 0};
        hd_heat_opts o = eng_opts(c.method);
        hd_context ctx;
        hd_heat *heat;
        hd_estimate e;
        hd_report rep;
        memset(&ctx, 0, sizeof ctx);
        o.context = &ctx;
        heat = eng_create(lap, &o);
        CHECK(heat_column(heat, 1, lap->vertex[0], u, NULL) >= 0);         /* the order is analysed */
        CHECK(hd_heat_estimate(heat, c.query, 0, NULL, 1, &e, NULL) == HD_OK);
        ctx.bytes_peak = ctx.bytes_in_use;
        CHECK(est_run(heat, lap, &c, u, &rep) >= 0);
        bytes[k] = e.cost[0].bytes;
        peak[k] = (double)ctx.bytes_peak - e.bytes_in_use;
        hd_heat_free(heat);
    }
    CHECK_MSG(fabs(bytes[1] - bytes[0] - (peak[1] - peak[0])) <= 1024, "%.0f bytes more, estimated %.0f", peak[1] - peak[0], bytes[1] - bytes[0]);
}

/* Each query of each plan, with few times and many, small and large: what may be asked is answered, in figures that make sense and grow
   with the work; what this plan cannot answer is refused. Then once more, when some of it has been done. */
static void est_sweep_one(hd_heat *heat, const hd_heat_opts *o, hd_query query, int32_t n_times, const double *t, int limited, const char *what) {
    static const int32_t ks[3] = {1, 5, 40};
    const int direct = query > HD_QUERY_PAIRS && query < HD_QUERY_SPECTRUM;
    const int timeless = query == HD_QUERY_DISTANCE_COMMUTE || query == HD_QUERY_DISTANCE_BIHARMONIC || query == HD_QUERY_SPECTRUM;
    const int refused = (direct && (o->method == HD_METHOD_ITERATIVE || o->method == HD_METHOD_KRYLOV)) ||
                        (query > HD_QUERY_PAIRS && !timeless && t[0] == 0);
    double flops = 0;
    hd_estimate e;
    hd_error err;
    int q;
    for (q = 0; q < 3; q++) {
        const hd_status st = hd_heat_estimate(heat, query, n_times, t, ks[q], &e, &err);
        if (refused) {
            CHECK_MSG(st == HD_ERR_ARGUMENT && err.status == st && err.text[0], "%s, query %d: %s", what, (int)query, hd_status_name(st));
            continue;
        }
        if (!CHECK_MSG(st == HD_OK, "%s, query %d: %s: %s", what, (int)query, hd_status_name(st), err.text)) continue;
        CHECK_MSG(e.method >= HD_METHOD_ITERATIVE && e.method <= HD_METHOD_KRYLOV && memcmp(&e.cost[0], &e.cost[e.method], sizeof e.cost[0]) == 0,
                  "%s, query %d: method %d", what, (int)query, (int)e.method);
        CHECK_MSG(o->method == HD_METHOD_AUTO || query == HD_QUERY_SPECTRUM || e.method == o->method, "%s, query %d: %s", what, (int)query, e.reason);
        CHECK_MSG(e.cost[0].flops >= 0 && e.cost[0].flops < 1e15 && e.cost[0].seconds >= 0 && e.cost[0].seconds < 1e6 && e.cost[0].bytes >= 0 &&
                  e.cost[0].bytes_most >= e.cost[0].bytes && e.cost[0].bytes_most < 1e12 && e.reason && e.reason[0],
                  "%s, query %d: %g flops, %g s, %g to %g bytes", what, (int)query, e.cost[0].flops, e.cost[0].seconds, e.cost[0].bytes, e.cost[0].bytes_most);
        CHECK(e.cost[0].fits == (e.cost[0].bytes <= e.bytes_left) && (limited || e.cost[0].fits));
        CHECK_MSG(o->method == HD_METHOD_AUTO || e.cost[0].flops >= flops * (1 - 1e-12), "%s, query %d, k = %d: %g flops after %g", what, (int)query,
                  (int)ks[q], e.cost[0].flops, flops);
        flops = e.cost[0].flops;
    }
}

/* The plans of the sweep, in words of tools/trials.h; the last has a set of its own. */
static const char *const est_plans[] = {
    "", "method=direct", "method=iterative", "method=krylov", "tol=1e-8", "poles=uniform", "poles=kernel degree=6",
    "degree=7 method=direct", "method=iterative precond=none", "method=iterative precond=jacobi solver=minres",
    "method=iterative solver=lanczos", "tol=1e-6 method=direct", "",
};
enum { EST_PLANS = sizeof est_plans / sizeof *est_plans };

static void est_sweep(const hd_laplacian *lap, uint64_t limit, const char *name) {
    double t[4][EST_MOST_TIMES] = {{1}, {0, 1, 2}, {1}, {1e7}}, *u = KIT_NEW(double, lap->n);
    static const int32_t n_times[4] = {1, 3, EST_MOST_TIMES, 1};
    hd_rational set;
    int which, w, pass, query, q;
    CHECK(hd_rational_exp(&set, HD_POLES_UNIFORM, 5, NULL) == HD_OK);
    for (q = 0; q < EST_MOST_TIMES; q++) t[2][q] = pow(10, 0.3 * q);
    for (w = 0; w < 4; w++) for (q = 0; q < n_times[w]; q++) t[w][q] *= lap->h * lap->h;
    for (which = 0; which < EST_PLANS; which++) {
        const trial words = trial_parse(est_plans[which]);
        hd_heat_opts o = trial_options(&words);
        hd_context ctx;
        hd_heat *heat = NULL;
        char what[80];
        memset(&ctx, 0, sizeof ctx);
        o.context = &ctx;
        o.max_iterations = 0;
        o.rational = which == EST_PLANS - 1 ? &set : NULL;
        ctx.byte_limit = limit;
        if (!CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK)) continue;
        for (pass = 0; pass < 2; pass++) {
            snprintf(what, sizeof what, "%s, plan %d, pass %d", name, which, pass);
            for (query = HD_QUERY_FIELDS; query <= HD_QUERY_SPECTRUM; query++)
                for (w = 0; w < 4; w++) est_sweep_one(heat, &o, (hd_query)query, n_times[w], t[w], limit > 0, what);
            CHECK(limit || heat_column(heat, t[0][0], lap->vertex[3], u, NULL) >= 0);
        }
        hd_heat_free(heat);
        CHECK(ctx.bytes_in_use == 0);
    }
}

static void est_sweeps(void) {
    est_sweep(kit_pair("ico/1 fem"), 0, "ball");
    est_sweep(kit_pair("ico/1 fem"), 30000, "ball with little room");
    est_sweep(kit_pair("flat/9/8/0.2 vor+held"), 0, "held grid");
}

/* Work by iterations is a sum over the times. */
static void est_flops(void) {
    const hd_laplacian *lap = kit_pair("ico/2 fem");
    hd_heat *heat = kit_heat(lap, "method=iterative");
    const double t[2] = {3 * lap->h * lap->h, 9 * lap->h * lap->h};
    double flops[3];
    int q;
    for (q = 0; q < 3; q++) {
        hd_estimate e;
        CHECK(hd_heat_estimate(heat, HD_QUERY_COLUMNS, 1 + q / 2, t + q % 2, 1, &e, NULL) == HD_OK);
        flops[q] = e.cost[HD_METHOD_ITERATIVE].flops;
    }
    CHECK_MSG(flops[0] > 0 && fabs(flops[2] - flops[0] - flops[1]) <= 1e-12 * flops[2], "%g and %g, together %g", flops[0], flops[1], flops[2]);
}

/* Times over more decades never cost less. */
static void est_decades(void) {
    enum { TIMES = 20 };
    const hd_laplacian *lap = kit_pair("flat/31/31/0.2 fem");
    double before = 0, flops = 0, t[TIMES];
    int decades, q;
    for (decades = 2; decades <= 290; decades += 24) {
        hd_heat *heat = kit_plan(lap, NULL);
        hd_estimate to;
        for (q = 0; q < TIMES; q++) t[q] = lap->h * lap->h * pow(10, decades * q / (TIMES - 1.0));
        CHECK(hd_heat_estimate(heat, HD_QUERY_COLUMNS, TIMES, t, 1, &to, NULL) == HD_OK);
        CHECK_MSG(to.cost[HD_METHOD_KRYLOV].seconds >= before && to.cost[HD_METHOD_KRYLOV].flops >= flops, "%d decades: %g seconds after %g, %g flops after %g", decades,
                  to.cost[HD_METHOD_KRYLOV].seconds, before, to.cost[HD_METHOD_KRYLOV].flops, flops);
        before = to.cost[HD_METHOD_KRYLOV].seconds;
        flops = to.cost[HD_METHOD_KRYLOV].flops;
    }
}

/* Work grows with the number of items up to the largest there is. */
static void est_many(void) {
    const hd_laplacian *lap = kit_pair("flat/6/5/0.2 fem");
    const double t = 10 * lap->h * lap->h;
    int q;
    for (q = HD_QUERY_FIELDS; q <= HD_QUERY_DISTANCE_BIHARMONIC; q++) {
        hd_heat *heat = kit_heat(lap, "method=direct");
        const hd_query query = (hd_query)q;
        const int each = q <= HD_QUERY_PAIRS || q >= HD_QUERY_DISTANCE;
        hd_estimate half, all;
        CHECK(hd_heat_estimate(heat, query, 1, &t, INT32_MAX / 2, &half, NULL) == HD_OK);
        CHECK(hd_heat_estimate(heat, query, 1, &t, INT32_MAX, &all, NULL) == HD_OK);
        CHECK_MSG(half.cost[HD_METHOD_AUTO].flops > 0 && (!each || fabs(all.cost[HD_METHOD_AUTO].flops / half.cost[HD_METHOD_AUTO].flops - 2) < 1e-3),
                  "query %d: %g and %g flops", q, half.cost[HD_METHOD_AUTO].flops, all.cost[HD_METHOD_AUTO].flops);
    }
}

/* Every query on small shapes; those whose need depends on how much of the heat is left on a larger one. */
/* Patches: what is asked for, what auto takes where heat stays near, and what it turns to where the whole does not fit. */
static void est_patches(void) {
    static const hd_query queries[3] = {HD_QUERY_DIAGONAL, HD_QUERY_TRACE, HD_QUERY_DISTANCE};
    int32_t k;
    for (k = 0; k < 9; k += k == 0 ? 3 : 1) {
        const est_case c = {queries[k % 3], HD_METHOD_AUTO, 1, k % 3 == 2, k / 3 == 2 ? 5 : 0.5, 1, 0};
        const hd_laplacian *lap = kit_pair(k == 0 ? "flat/240/240/0.2 vor" : "flat/100/100/0.2 vor");
        hd_context *ctx = lap->context;
        const int32_t mark = kit_mark();
        double *U = KIT_NEW(double, lap->n);
        hd_heat *heat = kit_heat(lap, k / 3 == 1 ? "method=local" : "");
        const uint64_t before = ctx->bytes_in_use;
        hd_estimate e;
        hd_report rep;
        double t, peak;
        est_times(lap, &c, &t);
        ctx->byte_limit = k / 3 == 2 ? before + 58000000 : 0;
        CHECK(hd_heat_estimate(heat, c.query, 1, &t, c.k, &e, NULL) == HD_OK);
        CHECK_MSG(e.method == HD_METHOD_LOCAL && e.cost[e.method].possible && e.cost[e.method].fits, "query %d: %s", (int)k, e.reason);
        CHECK(e.cost[HD_METHOD_DIRECT].possible == (k / 3 != 1) && e.cost[e.method].seconds > 0 && e.cost[e.method].flops > 0);
        kit_release(mark);
        U = KIT_NEW(double, lap->n);
        heat = kit_heat(lap, k / 3 == 1 ? "method=local" : "");
        ctx->bytes_peak = ctx->bytes_in_use;
        CHECK_MSG(est_run(heat, lap, &c, U, &rep) >= 0 && rep.method == e.method && strcmp(rep.reason, e.reason) == 0, "query %d: %s, %s, %s", (int)k, rep.error.text, rep.reason, e.reason);
        peak = (double)(ctx->bytes_peak - before);
        CHECK_MSG(e.cost[e.method].bytes > peak / 2.5 && e.cost[e.method].bytes < 2.5 * peak, "query %d: %g of %g bytes", (int)k, e.cost[e.method].bytes, peak);
        ctx->byte_limit = 0;
        kit_release(mark);
    }
}

static void est_queries(void) {
    static const char *const pairs[4] = {"bumpy/4/5 fem", "bumpy/3/5 fem", "bumpy/3/5 vor", "flat/27/21/0.3 fem"};
    const shape *cloud = kit_shape("bumpy/2/5");
    hd_laplacian *points = NULL;
    int q, c;
    CHECK(hd_laplacian_create(&points, MESH_POINTS(cloud->xyz, cloud->n), NULL, NULL) >= 0);
    for (q = 0; q < 5; q++) {
        const hd_laplacian *lap = q == 4 ? points : kit_pair(pairs[q]);
        for (c = 0; c < EST_N_CASES; c++)
            if (EST_CASES[c].large == (q == 0)) est_compare(lap, EST_CASES + c, q == 4 ? "points" : pairs[q]);
        if (q == 1 || q == 2) est_methods(lap);
        if (q != 1) continue;
        est_limits(lap);
        est_bad(lap);
        est_spectrum(lap);
    }
    hd_laplacian_free(points);
}

static void test_estimate(void) {
    est_flops();
    est_queries();
    est_patches();
    est_ground();
    est_model();
    est_rooms();
    est_sweeps();
    est_many();
    est_decades();
}
