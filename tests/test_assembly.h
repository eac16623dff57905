/* Assembly: the order of faces, corners and points is nobody's business. Included by runner.c. */

/* The same triangles in another order, each turned by some corners. */
static void asm_shuffle(int32_t *tri, int32_t m, uint64_t seed) {
    int32_t f, k;
    for (f = m; f-- > 1;) {
        const int32_t g = (int32_t)((shape_signed(&seed) + 1) / 2 * f), turns = (int32_t)((shape_signed(&seed) + 1) * 1.5);
        for (k = 0; k < 3; k++) {
            const int32_t swap = tri[3 * f + k];
            tri[3 * f + k] = tri[3 * g + k];
            tri[3 * g + k] = swap;
        }
        for (k = 0; k < turns; k++) {
            const int32_t first = tri[3 * f];
            tri[3 * f] = tri[3 * f + 1];
            tri[3 * f + 1] = tri[3 * f + 2];
            tri[3 * f + 2] = first;
        }
    }
}

/* Largest difference of two arrays, relative to the largest entry. */
static double asm_difference(const double *a, const double *b, int64_t n) {
    double worst = 0, most = 0;
    int64_t i;
    for (i = 0; i < n; i++) {
        worst = fmax(worst, fabs(a[i] - b[i]));
        most = fmax(most, fabs(b[i]));
    }
    return worst / most;
}

/* Entries by a dense sum over the faces that count: nothing is sorted, nothing gathered. */
static void asm_dense(const shape *s, const int *counts, double *L, double *B) {
    const int32_t n = s->n;
    int32_t f, k, q;
    for (f = 0; f < s->n_tri; f++) {
        const int32_t *v = s->tri + 3 * f;
        double e[3][3], cross[3], twice;
        if (!counts[f]) continue;
        for (k = 0; k < 3; k++)
            for (q = 0; q < 3; q++) e[k][q] = s->xyz[3 * v[(k + 2) % 3] + q] - s->xyz[3 * v[(k + 1) % 3] + q];
        for (q = 0; q < 3; q++) cross[q] = e[0][(q + 1) % 3] * e[1][(q + 2) % 3] - e[0][(q + 2) % 3] * e[1][(q + 1) % 3];
        twice = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
        for (k = 0; k < 3; k++) {
            const int32_t i = v[(k + 1) % 3], j = v[(k + 2) % 3];
            const double w = -(e[(k + 1) % 3][0] * e[(k + 2) % 3][0] + e[(k + 1) % 3][1] * e[(k + 2) % 3][1] + e[(k + 1) % 3][2] * e[(k + 2) % 3][2]) / twice / 2;
            L[i * n + j] -= w;
            L[j * n + i] -= w;
            L[i * n + i] += w;
            L[j * n + j] += w;
            for (q = 0; q < 3; q++) B[v[k] * n + v[q]] += twice / (q == k ? 12 : 24);
        }
    }
}

/* A crumpled grid with fins, needles, faces that come twice and faces that are none, a hub with many faces; in several orders. */
static void asm_orders(void) {
    enum { EXTRA = 80 };
    shape grid = kit_own_shape(shape_grid(13, 11, 0.45)), s = kit_own_shape(shape_make(grid.n, grid.n_tri + 2 * EXTRA));
    const int32_t n = s.n;
    hd_laplacian *first = NULL;
    uint64_t seed = 11;
    int round, *counts = KIT_NEW(int, s.n_tri);
    double *L = KIT_NEW(double, (size_t)n * (size_t)n), *B = KIT_NEW(double, (size_t)n * (size_t)n);
    int32_t f, k, i;
    memcpy(s.xyz, grid.xyz, 3 * (size_t)n * sizeof(double));
    memcpy(s.tri, grid.tri, 3 * (size_t)grid.n_tri * sizeof(int32_t));
    for (i = 0; i < n; i++) s.xyz[3 * i + 2] = 0.02 * shape_signed(&seed);
    for (f = 0; f < 2 * EXTRA; f++) {
        int32_t *v = s.tri + 3 * (grid.n_tri + f);
        v[0] = 3;                                                            /* the hub, and fins on its edges */
        v[1] = 4 + (f < EXTRA ? f : f - EXTRA) / 2;
        v[2] = f % 7 == 0 ? v[1] : 4 + (int32_t)((shape_signed(&seed) + 1) / 2 * (n - 5));
        if (f >= EXTRA && f % 3 == 0) memcpy(v, s.tri + 3 * (grid.n_tri + f - EXTRA), 3 * sizeof *v);     /* an earlier one once more */
    }
    for (f = 0; f < s.n_tri; f++) {
        const int32_t *v = s.tri + 3 * f;
        counts[f] = v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
        for (k = 0; k < f && counts[f]; k++) {
            const int32_t *w = s.tri + 3 * k;
            int same = 0, a, b;
            for (a = 0; a < 3; a++)
                for (b = 0; b < 3; b++) same += v[a] == w[b];
            counts[f] = !(counts[k] && same == 3);
        }
    }
    asm_dense(&s, counts, L, B);
    for (round = 0; round < 4; round++) {
        hd_laplacian *lap = NULL;
        double worst[2] = {0, 0}, most[2] = {0, 0};
        int64_t p, entries = 0;
        CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s.xyz, n, s.tri, s.n_tri), NULL, NULL) == HD_OK);
        if (!lap) break;
        for (i = 0; i < lap->n_active; i++) {
            for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
                const int64_t at = (int64_t)lap->vertex[i] * n + lap->vertex[lap->L.col[p]];
                worst[0] = fmax(worst[0], fabs(lap->L.val[p] - L[at]));
                worst[1] = fmax(worst[1], fabs(lap->B[p] - B[at]));
                most[0] = fmax(most[0], fabs(L[at]));
                most[1] = fmax(most[1], B[at]);
            }
        }
        for (p = 0; p < (int64_t)n * n; p++) entries += B[p] > 0;
        CHECK_MSG(worst[0] < 1e-12 * most[0] && worst[1] < 1e-13 * most[1], "round %d: L %g of %g, B %g of %g", round, worst[0], most[0], worst[1], most[1]);
        CHECK(lap->L.nnz == entries);
        if (!first) {
            first = lap;
            CHECK(lap->mesh.n_nonmanifold_edges > 20 && lap->mesh.n_repeated_face > 20 && lap->mesh.n_repeated_corner > 20 && lap->mesh.n_boundary_edges > 20);
        } else {
            const hd_mesh_report *a = &first->mesh, *b = &lap->mesh;
            CHECK(a->n_faces_used == b->n_faces_used && a->n_repeated_corner == b->n_repeated_corner && a->n_repeated_face == b->n_repeated_face &&
                  a->n_zero_area == b->n_zero_area && a->n_edges == b->n_edges && a->n_boundary_edges == b->n_boundary_edges && a->n_inert == b->n_inert &&
                  a->n_nonmanifold_edges == b->n_nonmanifold_edges && a->n_boundary_loops == b->n_boundary_loops &&
                  a->n_negative_weights == b->n_negative_weights && fabs(a->smallest_angle - b->smallest_angle) < 1e-12);
            CHECK(fabs(lap->h / first->h - 1) < 1e-14 && fabs(lap->area / first->area - 1) < 1e-14 && lap->n_components == first->n_components);
            CHECK(asm_difference(lap->mass, first->mass, lap->n_active) < 1e-14);
            hd_laplacian_free(lap);
        }
        asm_shuffle(s.tri, s.n_tri, 5u + (uint64_t)round);
    }
    hd_laplacian_free(first);
}

/* Three spheres whose points come in turns, some of them twice: rows, components and matrices are in the order of the caller, whatever order the points are
 * worked on in. */
static void asm_points(void) {
    enum { N = 900 };
    double *xyz = KIT_NEW(double, 3 * N), mass[3] = {0, 0, 0};
    hd_laplacian *lap = NULL, *turned = NULL;
    hd_context ctx;
    hd_laplacian_opts o;
    uint64_t seed = 3;
    int32_t i, k;
    int64_t p;
    int wrong = 0;
    memset(&ctx, 0, sizeof ctx);
    memset(&o, 0, sizeof o);
    ctx.n_threads = 1;
    o.context = &ctx;
    for (i = 0; i < N; i++) {
        double r = 0;
        for (k = 0; k < 3; k++) {
            xyz[3 * i + k] = shape_signed(&seed);
            r += xyz[3 * i + k] * xyz[3 * i + k];
        }
        for (k = 0; k < 3; k++) xyz[3 * i + k] = xyz[3 * i + k] / sqrt(r) * (1 + i % 3) + (k == 0 ? 20 - 10 * (i % 3) : 0);
    }
    memcpy(xyz + 3 * 31, xyz + 3 * 1, 3 * sizeof *xyz);      /* both of the second sphere */
    CHECK(at_tufted(&lap, xyz, N, NULL, NULL, NULL, NULL) == HD_OK);
    CHECK(at_tufted(&turned, xyz, N, NULL, NULL, &o, NULL) == HD_OK);
    if (lap && turned) {
        CHECK(lap->n_active == N - 1 && lap->row[31] == -1 && lap->n_components == 3 && lap->points.n_coincident == 1);
        for (i = 0; i < lap->n_active; i++) {
            const int32_t v = lap->vertex[i];
            int diagonal = 0;
            wrong += lap->row[v] != i || lap->component[i] != v % 3 || (i > 0 && v <= lap->vertex[i - 1]) || memcmp(lap->xyz + 3 * i, xyz + 3 * v, 3 * sizeof *xyz);
            mass[v % 3] += lap->mass[i];
            for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
                wrong += lap->vertex[lap->L.col[p]] % 3 != v % 3 || (p > lap->L.row_ptr[i] && lap->L.col[p] <= lap->L.col[p - 1]);
                if (lap->L.col[p] != i) continue;
                diagonal = 1;
                wrong += lap->b_diag[i] != lap->B[p] || !(lap->L.val[p] > 0);
            }
            wrong += !diagonal;
        }
        CHECK_MSG(wrong == 0, "%d things wrong", wrong);
        for (k = 0; k < 3; k++) {
            const double want = 4 * 3.141592653589793 * (k + 1) * (k + 1);
            CHECK_MSG(fabs(lap->component_mass[k] / mass[k] - 1) < 1e-13 && fabs(mass[k] / want - 1) < 0.1, "sphere %d: %g, %g, not %g", (int)k,
                      lap->component_mass[k], mass[k], want);
        }
        CHECK(lap->L.nnz == turned->L.nnz && memcmp(lap->L.val, turned->L.val, (size_t)lap->L.nnz * sizeof(double)) == 0 &&
              memcmp(lap->B, turned->B, (size_t)lap->L.nnz * sizeof(double)) == 0);
    }
    hd_laplacian_free(lap);
    hd_laplacian_free(turned);
    CHECK(ctx.bytes_in_use == 0);
}

/* A grid of several blocks with fins from anywhere to anywhere, holes and faces that come twice. */
static shape asm_blocks_shape(void) {
    enum { EXTRA = 900 };
    shape grid = kit_own_shape(shape_grid(331, 163, 0.45)), s = shape_make(grid.n, grid.n_tri + EXTRA);
    uint64_t seed = 17;
    int32_t f, k;
    memcpy(s.xyz, grid.xyz, 3 * (size_t)grid.n * sizeof(double));
    memcpy(s.tri, grid.tri, 3 * (size_t)grid.n_tri * sizeof(int32_t));
    for (f = 0; f < s.n; f++) s.xyz[3 * f + 2] = 0.001 * shape_signed(&seed);
    for (f = 0; f < EXTRA; f++) {
        int32_t *v = s.tri + 3 * (grid.n_tri + f);
        for (k = 0; k < 3; k++) v[k] = (int32_t)((shape_signed(&seed) + 1) / 2 * (s.n - 1));
        if (f % 5 == 0) v[2] = v[0] < s.n - 1 ? v[0] + 1 : 0;                                    /* on an edge of the grid */
        if (f % 7 == 0) memcpy(v, s.tri + 3 * ((int64_t)f * (grid.n_tri / EXTRA)), 3 * sizeof *v); /* once more, some of them across blocks */
        if (f % 11 == 0 && f > 5) memcpy(v, v - 15, 3 * sizeof *v);
    }
    for (f = 0; f < grid.n_tri; f += 97) s.tri[3 * f] = s.tri[3 * f + 1];                        /* holes */
    for (f = 0; f < 2 * 330 && f < grid.n_tri; f++) memcpy(s.tri + 3 * (50 * 660 + f), s.tri, 3 * sizeof *s.tri);    /* a cut, near where a block ends */
    asm_shuffle(s.tri, s.n_tri, 23);
    return s;
}

static int asm_same(const void *a, const void *b, int64_t n, size_t size) { return (!a && !b) || (a && b && memcmp(a, b, (size_t)n * size) == 0); }

/* The same numbers to the last bit, as promised where arithmetic is that of doubles; on x87 registers up to rounding. */
static int asm_same_values(const double *a, const double *b, int64_t n) {
    if (TEST_EXACT || !a || !b) return asm_same(a, b, n, sizeof *a);
    return dense_max_diff(a, b, n) <= 1e-13 * dense_max_abs(b, n);
}

static void asm_compare(const hd_laplacian *a, const hd_laplacian *b) {
    const int64_t n = a->n_active, nnz = a->L.nnz;
    CHECK(n == b->n_active && nnz == b->L.nnz && a->n_components == b->n_components && a->h == b->h && a->area == b->area);
    CHECK(memcmp(&a->mesh, &b->mesh, sizeof a->mesh) == 0);
    if (n != b->n_active || nnz != b->L.nnz || a->n_components != b->n_components) return;
    CHECK(asm_same(a->L.row_ptr, b->L.row_ptr, n + 1, sizeof(int64_t)) && asm_same(a->L.col, b->L.col, nnz, sizeof(int32_t)));
    CHECK(asm_same_values(a->L.val, b->L.val, nnz) && asm_same_values(a->B, b->B, nnz));
    CHECK(asm_same_values(a->mass, b->mass, n) && asm_same_values(a->b_diag, b->b_diag, n));
    CHECK(asm_same(a->component, b->component, n, sizeof(int32_t)) && asm_same(a->vertex, b->vertex, n, sizeof(int32_t)));
    CHECK(asm_same_values(a->component_mass, b->component_mass, a->n_components));
}

/* The same bits, however many blocks are worked on, in whatever order; the same complaint; no memory kept when there is too little. */
static void asm_blocks(void) {
    static const hd_laplacian_kind kinds[3] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};
    enum { WAYS = 4 };
    shape s = kit_own_shape(asm_blocks_shape());
    hd_error bad[WAYS];
    int64_t calls = 0;
    int k, way, limit;
    for (k = 0; k < 3; k++) {
        hd_context ctx[WAYS];
        hd_laplacian *lap[WAYS];
        hd_laplacian_opts o;
        hd_status st = HD_ERR_MEMORY_LIMIT;
        memset(&o, 0, sizeof o);
        memset(ctx, 0, sizeof ctx);
        o.kind = kinds[k];
        for (way = 0; way < WAYS; way++) {
            ctx[way].n_threads = way == 1 ? 2 : 1;
            if (way == 2) ctx[way].parallel_for = sparse_reverse_for;
            if (way == 3) ctx[way].parallel_for = heat_shuffled_for;
            ctx[way].parallel_user = &calls;
            o.context = ctx + way;
            lap[way] = NULL;
            CHECK(hd_laplacian_create(lap + way, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, NULL) == HD_OK);
            if (lap[0] && lap[way]) asm_compare(lap[way], lap[0]);
        }
        if (lap[0]) {
            const hd_mesh_report *r = &lap[0]->mesh;
            CHECK(r->n_repeated_face > 50 && r->n_nonmanifold_edges > 20 && r->n_boundary_edges > 500 && r->n_repeated_corner > 500 && r->n_boundary_loops > 10);
        }
        for (way = 0; way < WAYS; way++) {
            hd_laplacian_free(lap[way]);
            CHECK(ctx[way].bytes_in_use == 0);
        }
        for (limit = 1; k == 0 && limit < 100 && st < 0; limit++) {
            hd_laplacian *none = NULL;
            ctx[2].allocations = 0;
            ctx[2].allocation_limit = (uint64_t)limit;
            o.context = ctx + 2;
            st = hd_laplacian_create(&none, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, NULL);
            CHECK(st == HD_OK || (st == HD_ERR_MEMORY_LIMIT && !none));
            hd_laplacian_free(none);
            CHECK(ctx[2].bytes_in_use == 0);
        }
        CHECK(k > 0 || st == HD_OK);
    }
    s.xyz[3 * 40000] = s.xyz[3 * 40001 + 1] = s.xyz[3 * 16400] = s.xyz[3 * 16401 + 1] = 1e90;         /* edges of two blocks */
    for (way = 0; way < WAYS; way += 2) {
        hd_context ctx;
        hd_laplacian *lap = NULL;
        hd_laplacian_opts o;
        memset(&ctx, 0, sizeof ctx);
        memset(&o, 0, sizeof o);
        ctx.n_threads = 1;
        if (way) ctx.parallel_for = sparse_reverse_for;
        ctx.parallel_user = &calls;
        o.context = &ctx;
        CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &o, bad + way) == HD_ERR_ARGUMENT && !lap && ctx.bytes_in_use == 0);
    }
    CHECK(bad[0].face >= 0 && bad[0].face == bad[2].face && bad[0].vertex == bad[2].vertex);
    CHECK(calls > 0);
}

/* Faces of a large mesh in random order are sorted first: the same pair to rounding, and errors name the caller's faces. */
static void asm_jumps(void) {
    enum { SPOILT = 5000 };
    shape s = kit_own_shape(shape_grid(99, 99, 0.3)), r = kit_own_shape(shape_grid(99, 99, 0.3));
    hd_laplacian_opts o;
    hd_laplacian *a = kit_triangles(&s, HD_LAPLACIAN_FEM), *b = NULL, *none = NULL;
    hd_error e, e2;
    int64_t p;
    int32_t f;
    memset(&o, 0, sizeof o);
    o.updatable = 1;
    asm_shuffle(r.tri, r.n_tri, 3);
    CHECK(hd_laplacian_create(&b, MESH_TRIANGLES(r.xyz, r.n, r.tri, r.n_tri), &o, &e) == HD_OK && b->L.nnz == a->L.nnz);
    CHECK(memcmp(a->L.col, b->L.col, (size_t)a->L.nnz * sizeof *a->L.col) == 0);
    CHECK(asm_difference(a->L.val, b->L.val, a->L.nnz) < 1e-12 && asm_difference(a->mass, b->mass, a->n_active) < 1e-12);
    for (p = 0; p < a->L.nnz; p++) if (!CHECK(fabs(a->B[p] - b->B[p]) <= 1e-14 * a->b_diag[0])) break;
    r.xyz[3 * SPOILT] = 1e100;
    r.xyz[3 * SPOILT + 1] = 3e99;
    for (f = 0; r.tri[3 * f] != SPOILT && r.tri[3 * f + 2] != SPOILT; f++) {}  /* from corner 1 two equal edges: no area */
    CHECK_MSG(hd_laplacian_create(&none, MESH_TRIANGLES(r.xyz, r.n, r.tri, r.n_tri), &o, &e) == HD_ERR_ARGUMENT && !none && e.face == f, "%s, face %d, not %d", e.text, (int)e.face, (int)f);
    CHECK(hd_laplacian_update(b, MESH_POINTS(r.xyz, b->n), &e2) == HD_ERR_ARGUMENT && e2.face == f && e2.vertex == e.vertex && e2.value == e.value);
    hd_laplacian_free(b);
}

static void test_assembly(void) {
    asm_jumps();
    asm_blocks();
    asm_orders();
    asm_points();
}
