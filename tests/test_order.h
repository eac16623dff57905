/* test_order.h - elimination orders, by the fill that hd_ldl_analyse reports: against all orders, minimum degree by its
 * definition, closed forms, limits. That they are permutations, and sound on the way, is asserted in the library with HEATDIFF_AUDIT. */

#ifndef TEST_ORDER_H
#define TEST_ORDER_H

/* Fill and work of an order of a. */
static hd_ldl_report order_of(const hd_csr *a, hd_ordering ordering, const double *xyz) {
    const hd_ldl_opts o = ldl_opts_of(ordering, NULL, xyz, NULL);
    hd_ldl_report rep;
    hd_ldl *f = NULL;
    memset(&rep, 0, sizeof rep);
    CHECK(hd_ldl_analyse(&f, a, &o, &rep, NULL) == HD_OK && rep.ordering == ordering);
    CHECK(rep.factor_nnz >= a->n_rows + (a->nnz - a->n_rows) / 2);
    hd_ldl_free(f);
    return rep;
}

static int64_t order_least(const hd_csr *a) { return order_of(a, HD_ORDERING_MINIMUM_DEGREE, NULL).factor_nnz; }

/* A box of vertices one apart, joined as `joins` says; hubs are joined to all. Rows are numbered at random when seed is not 0. */
enum { ORDER_X = 1, ORDER_YZ = 2, ORDER_DIAGONALS = 4, ORDER_GRID = 3, ORDER_CELLS = 7, ORDER_FAR = 8 };
typedef struct order_box { int32_t w, h, d; int joins; int32_t hubs; uint64_t seed; } order_box;

static int32_t order_rows(order_box b) { return b.w * b.h * b.d + b.hubs; }

/* xyz [3 n]: the places of the rows. */
static hd_csr order_graph(order_box b, double *xyz) {
    const int32_t n = order_rows(b);
    int32_t *row = DENSE_NEW(int32_t, n), v, u, k, q;
    uint64_t seed = 11;
    ldl_edges g = ldl_edges_of(n);
    for (v = 0; v < n; v++) row[v] = v;
    if (b.seed) dense_shuffle(row, n, &b.seed);
    for (v = 0; v < n; v++) {
        const int32_t at[3] = {v % b.w, v / b.w % b.h, v / b.w / b.h};
        for (k = 0; k < 3; k++) xyz[3 * row[v] + k] = at[k];
        for (u = 0; v >= n - b.hubs && u < v; u++) ldl_join(&g, row[v], row[u]);
        for (k = 0; v < n - b.hubs && k < 13; k++) {         /* the neighbours before v */
            const int32_t x = at[0] + k % 3 - 1, y = at[1] + k / 3 % 3 - 1, z = at[2] + k / 9 - 1;
            q = k == 12 ? ORDER_X : k == 10 || k == 4 ? ORDER_YZ : ORDER_DIAGONALS;
            if (!(b.joins & q) || x < 0 || x >= b.w || y < 0 || y >= b.h || z < 0) continue;
            ldl_join(&g, row[v], row[x + b.w * (y + b.h * z)]);
        }
        for (k = 0; k < 2 && (b.joins & ORDER_FAR); k++) ldl_join(&g, row[v], row[ldl_below(&seed, n)]);
    }
    free(row);
    return ldl_pattern(&g, 1);
}

/* ---- small patterns ---- */

/* Non-zeros of the factor in the best of all orders. least[s]: those of the columns in s, when they are eliminated first. */
static int64_t order_best(const hd_csr *a) {
    const int32_t n = a->n_rows;
    int32_t *near = DENSE_NEW(int32_t, n), *least = DENSE_NEW(int32_t, 1 << n), s, v, u;
    int64_t p, best;
    for (v = 0; v < n; v++)
        for (p = a->row_ptr[v]; p < a->row_ptr[v + 1]; p++) near[v] |= 1 << a->col[p];
    for (s = 1; s < 1 << n; s++) {
        least[s] = n * n;
        for (v = 0; v < n; v++) {
            const int32_t before = s & ~(1 << v);
            int32_t reached = 1 << v, grown = 0, count;
            if (before == s) continue;
            while (grown != reached) {           /* what v is joined to by then: by paths through those before it */
                grown = reached;
                for (u = 0; u < n; u++)
                    if (u == v || (before & grown) >> u & 1) reached |= near[u];
            }
            for (count = least[before], u = 0; u < n; u++) count += (reached & ~before) >> u & 1;
            if (count < least[s]) least[s] = count;
        }
    }
    best = least[(1 << n) - 1];
    free(near);
    free(least);
    return best;
}

static void order_all_orders(void) {
    int64_t found = 0, best = 0;
    int32_t n, k;
    for (n = 1; n < 10; n++)
        for (k = 0; k < 12; k++) {
            hd_csr a = k < 6 ? ldl_random_pattern(n, 1 + 0.5 * k, (uint64_t)(7 * n + k)) : ldl_shape(LDL_CYCLE + k - 6, n, 1, 1);
            const int64_t m = order_least(&a), b = order_best(&a);
            CHECK_MSG(m >= b, "%d rows: %d non-zeros, at least %d", (int)n, (int)m, (int)b);
            found += m;
            best += b;
            hd_csr_free(&a, NULL);
        }
    CHECK_MSG(found <= best + best / 500, "%d non-zeros, the best orders have %d", (int)found, (int)best);
}

/* Eliminates a vertex of least degree, the last of several, until none is left. */
static int64_t order_by_definition(const hd_csr *a) {
    const int32_t n = a->n_rows;
    char *m = DENSE_NEW(char, (int64_t)n * n), *gone = DENSE_NEW(char, n);
    int32_t i, j, k, step;
    int64_t p, nnz = 0;
    for (i = 0; i < n; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++) m[i * n + a->col[p]] = 1;
    for (step = 0; step < n; step++) {
        int32_t least = n + 1, degree;
        for (k = i = 0; i < n; i++) {
            for (degree = j = 0; j < n; j++) degree += m[i * n + j] && !gone[j];
            if (gone[i] || degree > least) continue;
            least = degree;
            k = i;
        }
        nnz += least;                            /* with the diagonal */
        gone[k] = 1;
        for (i = 0; i < n; i++)
            for (j = 0; m[k * n + i] && j < n; j++) m[i * n + j] |= m[k * n + j];
    }
    free(m);
    free(gone);
    return nnz;
}

/* Degrees that are bounds lead to about as much fill as true ones, on each pattern and in all. Not on the bipartite
 * one, where those that the library counts, without twins, lead to more. */
static void order_definition(void) {
    int64_t found = 0, want = 0;
    int32_t k, s;
    for (s = 0; s < 4; s++)
        for (k = 0; k < 24; k++) {
            const int32_t n = 30 + 20 * s + k;
            hd_csr a = k < LDL_SHAPES ? ldl_shape(k, n, 1, (uint64_t)k + 1)
                                      : ldl_random_pattern(n, 2 + s + 0.5 * (k - LDL_SHAPES), (uint64_t)n);
            const int64_t m = order_least(&a), b = k == LDL_BIPARTITE ? m : order_by_definition(&a);
            CHECK_MSG(k <= LDL_TREES ? m == b : (double)m <= 1.1 * (double)b, "%d of %d rows: %d non-zeros, by definition %d", (int)k,
                      (int)n, (int)m, (int)b);
            found += m;
            want += b;
            hd_csr_free(&a, NULL);
        }
    CHECK_MSG((double)found <= 1.005 * (double)want, "%d non-zeros, by definition %d", (int)found, (int)want);
}

/* ---- grids ---- */

/* k by k grids with diagonals. Dissection by their middle lines makes 31/4 k^2 log2 k non-zeros and 829/84 k^3 operations, a
 * multiplication and an addition each, to leading order (A. George, J. Liu, Computer Solution of Large Sparse Positive Definite Systems,
 * 1981, chapter 8). The next terms are negative for the first. Minimum degree does about as well; without diagonals both have less. */
static void order_grids(void) {
    int32_t k, wide, way;
    for (k = 45; k <= 90; k += 45)
        for (wide = 0; wide < 2; wide++) {
            const order_box b = {k, k, 1, wide ? ORDER_CELLS : ORDER_GRID, 0, 0};
            double *xyz = DENSE_NEW(double, 3 * k * k), work[2];
            hd_csr a = order_graph(b, xyz);
            for (way = 0; way < 2; way++) {
                const hd_ldl_report r = order_of(&a, ldl_orderings[1 + way], xyz);
                work[way] = r.factor_flops / pow(k, 3);
                CHECK_MSG((double)r.factor_nnz < 0.7 * 31 / 4 * k * k * log2(k) && work[way] < 1.1 * 2 * 829 / 84,
                          "%d by %d: %lld non-zeros, %g k^3 flops", (int)k, (int)k, (long long)r.factor_nnz, work[way]);
            }
            CHECK_MSG(work[0] < 1.2 * work[1] && work[1] < 1.2 * work[0], "%g and %g k^3 flops", work[0], work[1]);
            hd_csr_free(&a, NULL);
            free(xyz);
        }
}

/* Rows joined to all others come last: below them the order is as good as without them. */
static void order_dense_rows(void) {
    const order_box box = {50, 50, 1, ORDER_CELLS, 0, 0};
    order_box hubs = box;
    double *xyz = DENSE_NEW(double, 3 * 2503);
    hd_csr a = order_graph(box, xyz), b;
    int way;
    hubs.hubs = 3;
    b = order_graph(hubs, xyz);
    for (way = 1; way < 3; way++) {
        const int64_t alone = order_of(&a, ldl_orderings[way], xyz).factor_nnz;
        const int64_t all = order_of(&b, ldl_orderings[way], xyz).factor_nnz;
        CHECK_MSG(all <= alone + alone / 50 + 3 * 2500 + 6, "%d non-zeros, %d without dense rows", (int)all, (int)alone);
    }
    hd_csr_free(&a, NULL);
    hd_csr_free(&b, NULL);
    free(xyz);
}

/* ---- limits ---- */

/* Places: the true ones, on a line, at random, all the same. */
enum { ORDER_TRUE, ORDER_LINE, ORDER_ANYWHERE, ORDER_POINT };

/* most: non-zeros and flops for a row, by minimum degree and by dissection: what they were in November 2026, and 2 and 4 % more. */
typedef struct order_case { order_box box; int places; double most[4]; } order_case;

static void order_limits(void) {
    static const order_case table[] = {
        {{100, 100, 1, ORDER_GRID, 0, 0}, ORDER_TRUE, {20.633, 1208.8, 20.28, 1196.8}},
        {{100, 100, 1, ORDER_CELLS, 0, 0}, ORDER_TRUE, {30.619, 1956.8, 31.949, 2081.2}},
        {{160, 160, 1, ORDER_CELLS, 1, 0}, ORDER_TRUE, {37.495, 3638.7, 37.068, 3237.1}},
        {{70, 70, 1, ORDER_CELLS, 0, 5}, ORDER_TRUE, {32.012, 1947.7, 28.002, 1363.3}},
        {{50, 50, 1, ORDER_CELLS, 0, 0}, ORDER_TRUE, {23.252, 865.08, 23.336, 854.12}},
        {{40, 40, 1, ORDER_CELLS, 0, 0}, ORDER_TRUE, {21.596, 724.86, 21.681, 714.63}},
        {{300, 30, 1, ORDER_CELLS, 0, 0}, ORDER_TRUE, {23.048, 785.53, 24.808, 1015.9}},
        {{1000, 6, 1, ORDER_CELLS, 0, 1}, ORDER_TRUE, {8.8915, 82.103, 10.769, 129.69}},
        {{60, 60, 2, ORDER_CELLS, 0, 0}, ORDER_TRUE, {49.556, 4146.7, 49.944, 4274.1}},
        {{18, 18, 18, ORDER_GRID, 0, 0}, ORDER_TRUE, {83.723, 23052, 90.512, 22955}},
        {{14, 14, 14, ORDER_CELLS, 0, 9}, ORDER_TRUE, {155.47, 42161, 129.36, 28052}},
        {{60, 60, 1, ORDER_CELLS, 0, 0}, ORDER_LINE, {25.028, 1049.1, 24.655, 995.08}},
        {{60, 60, 1, ORDER_GRID, 0, 0}, ORDER_ANYWHERE, {16.601, 647.4, 16.843, 624.83}},
        {{60, 60, 1, ORDER_CELLS, 0, 0}, ORDER_POINT, {25.028, 1049.1, 24.745, 995.48}},
        {{50, 50, 1, ORDER_X, 0, 5}, ORDER_TRUE, {1.98, 3.94, 1.98, 3.94}},
        {{5000, 1, 1, ORDER_X, 0, 3}, ORDER_LINE, {1.9998, 3.9994, 2.4982, 6.4914}},
        {{30, 60, 1, ORDER_FAR, 0, 0}, ORDER_ANYWHERE, {61.263, 15965, 77.601, 23196}},
        {{20, 80, 1, ORDER_GRID | ORDER_FAR, 0, 0}, ORDER_TRUE, {201.94, 98835, 332.55, 2.1067e+05}},
        {{40, 30, 1, ORDER_FAR, 2, 0}, ORDER_TRUE, {43.981, 7122.4, 44.242, 7215.1}},
    };
    size_t c;
    int k;
    for (c = 0; c < sizeof table / sizeof *table; c++) {
        const order_box b = table[c].box;
        const int32_t n = order_rows(b);
        double *xyz = DENSE_NEW(double, 3 * n), got[4];
        hd_csr a = order_graph(b, xyz);
        uint64_t seed = 3;
        for (k = 0; k < 3 * n; k++) {
            if (table[c].places == ORDER_ANYWHERE) xyz[k] = dense_signed(&seed);
            else if (table[c].places == ORDER_POINT || (table[c].places == ORDER_LINE && k % 3)) xyz[k] = 7;
        }
        for (k = 0; k < 4; k += 2) {
            const hd_ldl_report r = order_of(&a, ldl_orderings[1 + k / 2], xyz);
            got[k] = (double)r.factor_nnz / n;
            got[k + 1] = r.factor_flops / n;
        }
        for (k = 0; k < 4; k++)
            CHECK_MSG(got[k] <= (k % 2 ? 1.04 : 1.02) * table[c].most[k], "case %d: %.5g, %.5g; %.5g, %.5g", (int)c, got[0], got[1],
                      got[2], got[3]);
        hd_csr_free(&a, NULL);
        free(xyz);
    }
}

static void test_order(void) {
    order_all_orders();
    order_definition();
    order_grids();
    order_dense_rows();
    order_limits();
}

#endif
