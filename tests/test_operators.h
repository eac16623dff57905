/* test_operators.h - the pair (L, B): by hand on single triangles, by its properties on meshes, and with bad input */

#ifndef TEST_OPERATORS_H
#define TEST_OPERATORS_H

static const hd_laplacian_kind op_kinds[3] = {HD_LAPLACIAN_FEM, HD_LAPLACIAN_VORONOI_COT, HD_LAPLACIAN_COT};

/* Where (i, j) stands in L, or -1. */
static int64_t op_find(const hd_csr *a, int32_t i, int32_t j) {
    int64_t p;
    for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++)
        if (a->col[p] == j) return p;
    return -1;
}

/* L between two vertices of the caller; 0 where there is no entry. */
static double op_l(const hd_laplacian *lap, int32_t u, int32_t v) {
    const int64_t p = lap->row[u] < 0 || lap->row[v] < 0 ? -1 : op_find(&lap->L, lap->row[u], lap->row[v]);
    return p < 0 ? 0 : lap->L.val[p];
}

static double op_b(const hd_laplacian *lap, int32_t u, int32_t v) {
    const int64_t p = lap->row[u] < 0 || lap->row[v] < 0 ? -1 : op_find(&lap->L, lap->row[u], lap->row[v]);
    if (p < 0) return 0;
    if (lap->B) return lap->B[p];
    return u == v ? lap->mass[lap->row[u]] : 0;
}

static hd_laplacian *op_make(const double *xyz, int32_t n, const int32_t *tri, int32_t m, hd_laplacian_kind kind) {
    hd_laplacian_opts opts;
    hd_laplacian *lap = NULL;
    hd_error e;
    memset(&opts, 0, sizeof opts);
    opts.kind = kind;
    CHECK_MSG(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, n, tri, m), &opts, &e) == HD_OK, "%s", e.text);
    return kit_own_laplacian(lap);
}

/* Area by Heron's formula: not how the library does it. */
static double op_area(const shape *s) {
    double sum = 0;
    int32_t f;
    for (f = 0; f < s->n_tri; f++) {
        const double *p[3];
        double a, b, c, q;
        int k;
        for (k = 0; k < 3; k++) p[k] = s->xyz + 3 * (size_t)s->tri[3 * f + k];
        a = shape_distance(p[0], p[1]);
        b = shape_distance(p[1], p[2]);
        c = shape_distance(p[2], p[0]);
        q = (a + b + c) / 2;
        sum += sqrt(fmax(0, q * (q - a) * (q - b) * (q - c)));
    }
    return sum;
}

/* ---- properties ---- */

static void op_properties(const shape *s, hd_laplacian_kind kind, const char *what) {
    hd_laplacian *lap = kit_triangles(s, kind);
    const double area = op_area(s);
    double b_sum = 0, mass_sum = 0, comp_sum = 0, worst_row = 0;
    int64_t p, asymmetric = 0, no_diagonal = 0;
    int32_t i;
    if (!lap) return;
    CHECK_MSG(!test_csr_fault(&lap->L, 1), "%s: %s", what, test_csr_fault(&lap->L, 1));
    CHECK(lap->kind == kind && lap->conserves == 1 && (kind == HD_LAPLACIAN_FEM) == (lap->B != NULL));
    CHECK(lap->b_ratio == (kind == HD_LAPLACIAN_FEM ? 0.5 : 1));
    CHECK(lap->B ? lap->b_diag != lap->mass : lap->b_diag == lap->mass);
    for (i = 0; i < lap->n_active; i++) {
        double sum = 0, size = 0, b = 0;
        no_diagonal += op_find(&lap->L, i, i) < 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const int64_t q = op_find(&lap->L, lap->L.col[p], i);
            asymmetric += q < 0 || lap->L.val[p] != lap->L.val[q] || (lap->B && lap->B[p] != lap->B[q]);
            sum += lap->L.val[p];
            size += fabs(lap->L.val[p]);
            b += lap->B ? lap->B[p] : 0;
        }
        worst_row = fmax(worst_row, fabs(sum) / size);
        if (lap->B) CHECK_MSG(fabs(b - lap->mass[i]) <= 1e-14 * b && lap->b_diag[i] == lap->B[op_find(&lap->L, i, i)], "%s: row %d", what, i);
        b_sum += lap->B ? b : lap->mass[i];
        mass_sum += lap->mass[i];
        CHECK(lap->mass[i] > 0 && lap->b_diag[i] > 0);
    }
    for (i = 0; i < lap->n_components; i++) comp_sum += lap->component_mass[i];
    CHECK_MSG(asymmetric == 0, "%s: %lld entries differ from their mirror", what, (long long)asymmetric);
    CHECK_MSG(no_diagonal == 0, "%s: diagonal missing", what);
    CHECK_MSG(worst_row < 1e-15, "%s: row sum %g", what, worst_row);
    CHECK_MSG(fabs(lap->area - area) <= 1e-12 * area, "%s: area %.17g not %.17g", what, lap->area, area);
    CHECK_MSG(fabs(b_sum - (kind == HD_LAPLACIAN_COT ? lap->n_active : area)) <= 1e-12 * b_sum, "%s: sum of B %g", what, b_sum);
    CHECK(fabs(mass_sum - b_sum) <= 1e-12 * b_sum && fabs(comp_sum - b_sum) <= 1e-12 * b_sum);
}

/* Positive semi-definite, with one zero eigenvalue per component; and B >= b_ratio diag(B). */
static void op_spectrum(const shape *s, hd_laplacian_kind kind, int32_t components) {
    hd_laplacian *lap = kit_triangles(s, kind);
    const int32_t n = lap->n_active;
    double *L = test_dense(&lap->L, NULL), *B = test_dense_mass(lap), *D = DENSE_NEW(double, (int64_t)n * n), *one = DENSE_NEW(double, (int64_t)n * n), top;
    int32_t i, zeros = 0, negative = 0;
    double least = DBL_MAX;
    dense_pair p, q;
    for (i = 0; i < n; i++) {
        one[(size_t)i * (size_t)n + (size_t)i] = 1;
        D[(size_t)i * (size_t)n + (size_t)i] = B[(size_t)i * (size_t)n + (size_t)i];
    }
    CHECK(dense_pair_solve(&p, L, one, n));
    top = dense_max_abs(p.lambda, n);
    for (i = 0; i < n; i++) {
        negative += p.lambda[i] < -1e-12 * top;
        zeros += fabs(p.lambda[i]) < 1e-12 * top;
    }
    CHECK_MSG(negative == 0 && zeros == components, "%d negative and %d zero eigenvalues", negative, zeros);
    CHECK(lap->n_components == components);
    CHECK(dense_pair_solve(&q, B, D, n));
    for (i = 0; i < n; i++) least = fmin(least, q.lambda[i]);
    CHECK_MSG(least >= lap->b_ratio * (1 - 1e-12), "B >= %g diag(B), not %g", least, lap->b_ratio);
    dense_pair_free(&p);
    dense_pair_free(&q);
}

static void op_all_properties(void) {
    const double far_away[3] = {5, 0, 0};
    shape s[6];
    int k, q;
    s[0] = shape_icosphere(2);
    s[1] = shape_bumpy(2, 4);
    s[2] = shape_grid(11, 9, 0.4);
    s[3] = shape_cylinder(12, 6, 1, 2);
    s[4] = shape_torus(14, 9, 2, 0.7);
    s[5] = shape_disjoint(s + 1, s + 2, far_away);
    for (k = 0; k < 6; k++) {
        for (q = 0; q < 3; q++) op_properties(s + k, op_kinds[q], "property");
        op_spectrum(s + k, HD_LAPLACIAN_FEM, k == 5 ? 2 : 1);
    }
    for (k = 0; k < 6; k++) shape_free(s + k);
}

/* ---- by hand ---- */

static void op_single_fem(void) {
    /* right angle at 0, legs 3 and 4: cotangents 0, 3/4, 4/3; area 6 */
    const double xyz[9] = {0, 0, 0, 3, 0, 0, 0, 4, 0};
    const int32_t tri[3] = {0, 1, 2};
    const double want[3][3] = {{2.0 / 3 + 3.0 / 8, -2.0 / 3, -3.0 / 8}, {-2.0 / 3, 2.0 / 3, 0}, {-3.0 / 8, 0, 3.0 / 8}};
    hd_laplacian *lap = op_make(xyz, 3, tri, 1, HD_LAPLACIAN_FEM);
    int i, j;
    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) {
            CHECK_MSG(fabs(op_l(lap, i, j) - want[i][j]) < 1e-15, "L(%d,%d) = %.17g", i, j, op_l(lap, i, j));
            CHECK_MSG(fabs(op_b(lap, i, j) - (i == j ? 1 : 0.5)) < 1e-15, "B(%d,%d) = %.17g", i, j, op_b(lap, i, j));
        }
        CHECK(fabs(lap->mass[i] - 2) < 1e-15);
    }
    CHECK(fabs(lap->area - 6) < 1e-15 && fabs(lap->h - 4) < 1e-15);
    CHECK(lap->mesh.n_edges == 3 && lap->mesh.n_boundary_edges == 3 && lap->mesh.n_boundary_loops == 1);
    CHECK(fabs(lap->mesh.smallest_angle - atan2(3, 4)) < 1e-15);
    CHECK(lap->mesh.n_faces == 1 && lap->mesh.n_faces_used == 1 && lap->mesh.n_inert == 0);
}

static void op_single_mixed(void) {
    static const double xyz[4][9] = {
        {0, 0, 0, 4, 0, 0, 1, 3, 0},             /* acute: cotangents 1/3, 1, 1/2 */
        {0, 0, 0, 3, 0, 0, 0, 4, 0},             /* right */
        {0, 0, 0, 4, 0, 0, -1, 1, 0},            /* obtuse at 0, area 2 */
        {0, 0, 0, 2, 0, 0, 1, 1.7320508075688772, 0},
    };
    static const double want[4][3] = {{2.25, 1.75, 2}, {3, 1.5, 1.5}, {1, 0.5, 0.5}, {0.57735026918962573, 0.57735026918962573, 0.57735026918962573}};
    int k, i, turn;
    for (k = 0; k < 4; k++) {
        for (turn = 0; turn < 6; turn++) {       /* the corners in any order */
            const int32_t a = turn % 3, b = (a + (turn < 3 ? 1 : 2)) % 3, tri[3] = {a, b, 3 - a - b};
            hd_laplacian *lap = op_make(xyz[k], 3, tri, 1, HD_LAPLACIAN_VORONOI_COT);
            for (i = 0; i < 3; i++) CHECK_MSG(fabs(lap->mass[i] - want[k][i]) < 1e-14, "triangle %d, corner %d: %.17g", k, i, lap->mass[i]);
            CHECK(lap->mesh.n_negative_weights == (k == 2));
        }
    }
}

/* Unit square cells with parallel diagonals: the five-point stencil, whatever the cell's size; half weights along the border. */
static void op_grid_stencil(void) {
    shape s = kit_own_shape(shape_grid(7, 6, 0));
    const double h = 1.0 / 6;
    int k;
    int32_t i, j;
    for (k = 0; k < 3; k++) {
        hd_laplacian *lap = kit_triangles(&s, op_kinds[k]);
        double worst = fabs(lap->h - (71 + 30 * sqrt(2)) / 101 * h);    /* 36 + 35 sides, 30 diagonals */
        CHECK(lap->mesh.n_edges == 101);
        for (j = 0; j < 6; j++) {
            for (i = 0; i < 7; i++) {
                const int32_t v = j * 7 + i;
                const double edge_x = i == 0 || i == 6 ? 0.5 : 1, edge_y = j == 0 || j == 5 ? 0.5 : 1;
                if (i < 6) worst = fmax(worst, fabs(op_l(lap, v, v + 1) + edge_y));
                if (j < 5) worst = fmax(worst, fabs(op_l(lap, v, v + 7) + edge_x));
                if (i < 6 && j < 5) worst = fmax(worst, fabs(op_l(lap, v, v + 8)));
                if (edge_x * edge_y == 1) worst = fmax(worst, fabs(op_l(lap, v, v) - 4));
                if (k == 1) worst = fmax(worst, fabs(op_b(lap, v, v) / (h * h) - edge_x * edge_y));
            }
        }
        CHECK_MSG(worst < 1e-13, "stencil off by %g", worst);
    }
}

/* ---- invariance ---- */

static void op_rotate(double *p, double scale) {
    const double c = 0.36, s = 0.93295230317524811, x = p[0];    /* c^2 + s^2 = 1, about two axes */
    const double y = c * p[1] - s * p[2], z = s * p[1] + c * p[2];
    p[0] = scale * (c * x - s * y) + 0.7;
    p[1] = scale * (s * x + c * y) - 1.2;
    p[2] = scale * z + 0.3;
}

static void op_rigid(void) {
    const double scales[3] = {1, 1e-3, 250};
    shape s = kit_own_shape(shape_bumpy(2, 8)), r;
    int k, q;
    int64_t p;
    int32_t i;
    for (k = 0; k < 3; k++) {
        r = kit_own_shape(shape_bumpy(2, 8));
        for (i = 0; i < r.n; i++) op_rotate(r.xyz + 3 * i, scales[k]);
        for (q = 0; q < 3; q++) {
            hd_laplacian *a = kit_triangles(&s, op_kinds[q]), *b = kit_triangles(&r, op_kinds[q]);
            const double unit = q == 2 ? 1 : scales[k] * scales[k], tol = k == 1 ? 1e-9 : 1e-11;    /* the shift costs digits of small meshes */
            double worst = 0;
            CHECK(a->L.nnz == b->L.nnz && memcmp(a->L.col, b->L.col, (size_t)a->L.nnz * sizeof *a->L.col) == 0);
            for (p = 0; p < a->L.nnz; p++) {
                worst = fmax(worst, fabs(a->L.val[p] - b->L.val[p]));
                if (a->B) worst = fmax(worst, fabs(a->B[p] * unit - b->B[p]) / (unit * a->area / a->n));
            }
            for (i = 0; i < a->n_active; i++) worst = fmax(worst, fabs(a->mass[i] * unit - b->mass[i]) / (a->mass[i] * unit));
            worst = fmax(worst, fabs(a->h * scales[k] - b->h) / b->h);
            CHECK_MSG(worst < tol, "kind %d, scale %g: off by %g", q, scales[k], worst);
        }
    }
}

/* The same shape with its vertices, faces and corners renumbered. to[new] = old. */
static shape op_renumbered(const shape *s, uint64_t seed, int32_t *to) {
    shape r = shape_make(s->n, s->n_tri);
    int32_t *from = KIT_NEW(int32_t, s->n), *order = KIT_NEW(int32_t, s->n_tri), i;
    dense_shuffle(to, s->n, &seed);
    dense_shuffle(order, s->n_tri, &seed);
    for (i = 0; i < s->n; i++) {
        from[to[i]] = i;
        memcpy(r.xyz + 3 * i, s->xyz + 3 * to[i], 3 * sizeof(double));
    }
    for (i = 0; i < s->n_tri; i++) {
        const int32_t *v = s->tri + 3 * order[i];
        const int turn = (int)(dense_random(&seed) % 3);
        shape_put_triangle(&r, i, from[v[turn]], from[v[(turn + 1) % 3]], from[v[(turn + 2) % 3]]);
    }
    return r;
}

static void op_permutation(void) {
    shape s = kit_own_shape(shape_grid(9, 8, 0.35)), r;
    int32_t *to = KIT_NEW(int32_t, s.n), i;
    int64_t p;
    int q;
    r = kit_own_shape(op_renumbered(&s, 77, to));
    for (q = 0; q < 3; q++) {
        hd_laplacian *a = kit_triangles(&s, op_kinds[q]), *b = kit_triangles(&r, op_kinds[q]);
        double worst = fabs(a->h - b->h);
        CHECK(a->L.nnz == b->L.nnz && a->mesh.n_edges == b->mesh.n_edges && a->mesh.n_boundary_edges == b->mesh.n_boundary_edges);
        CHECK(a->mesh.n_boundary_loops == b->mesh.n_boundary_loops && a->mesh.n_misoriented_edges == b->mesh.n_misoriented_edges);
        CHECK(a->mesh.n_negative_weights == b->mesh.n_negative_weights && a->mesh.smallest_angle > 0);
        for (i = 0; i < b->n_active; i++) {
            for (p = b->L.row_ptr[i]; p < b->L.row_ptr[i + 1]; p++) {
                const int32_t u = to[i], v = to[b->L.col[p]];
                worst = fmax(worst, fabs(b->L.val[p] - op_l(a, u, v)));
                if (b->B) worst = fmax(worst, fabs(b->B[p] - op_b(a, u, v)));
            }
            worst = fmax(worst, fabs(b->mass[i] - a->mass[to[i]]));
        }
        CHECK_MSG(worst < 1e-13, "kind %d: off by %g", q, worst);
    }
}

/* ---- meshes that are not nice ---- */

/* A good mesh with every kind of face that is left out mixed in; the pair stays that of the good mesh. */
static void op_left_out(void) {
    shape s = kit_own_shape(shape_grid(5, 4, 0)), t;
    int32_t i, n = s.n, m = 0;
    int q;
    t = kit_own_shape(shape_make(n + 5, s.n_tri + 8));
    memcpy(t.xyz, s.xyz, 3 * (size_t)n * sizeof(double));
    shape_put_vertex(&t, n, 9, 9, 9);                                        /* in no face */
    shape_put_vertex(&t, n + 1, 0.5, 7, 0);                                  /* only in faces without area */
    shape_put_vertex(&t, n + 2, 1.0, 7, 0);
    shape_put_vertex(&t, n + 3, 2.5, 7, 0);
    shape_put_vertex(&t, n + 4, 0.5, 7, 0);                                  /* in the same place as n + 1 */
    shape_put_triangle(&t, m++, 3, 3, 7);                                    /* repeated corners */
    shape_put_triangle(&t, m++, n + 1, n + 2, n + 3);                        /* collinear */
    for (i = 0; i < s.n_tri; i++) shape_put_triangle(&t, m++, s.tri[3 * i], s.tri[3 * i + 1], s.tri[3 * i + 2]);
    shape_put_triangle(&t, m++, s.tri[4], s.tri[5], s.tri[3]);               /* face 1, turned */
    shape_put_triangle(&t, m++, s.tri[5], s.tri[4], s.tri[3]);               /* and over again, flipped */
    shape_put_triangle(&t, m++, s.tri[0], s.tri[1], s.tri[2]);
    shape_put_triangle(&t, m++, n + 1, n + 4, 6);                            /* two corners in one place */
    shape_put_triangle(&t, m++, 2, 8, 8);
    shape_put_triangle(&t, m++, 0, 1, 2);                                    /* along the border: collinear */
    CHECK(m == t.n_tri);
    for (q = 0; q < 3; q++) {
        hd_laplacian *a = kit_triangles(&s, op_kinds[q]), *b = kit_triangles(&t, op_kinds[q]);
        CHECK(b->n == n + 5 && b->n_active == n && b->mesh.n_inert == 5);
        CHECK_MSG(b->mesh.n_repeated_corner == 2 && b->mesh.n_zero_area == 3 && b->mesh.n_repeated_face == 3, "%d %d %d",
                  b->mesh.n_repeated_corner, b->mesh.n_zero_area, b->mesh.n_repeated_face);
        CHECK(b->mesh.n_faces == m && b->mesh.n_faces_used == s.n_tri);
        CHECK(b->row[n] == -1 && b->row[n + 1] == -1 && b->row[n + 4] == -1 && b->row[n - 1] == n - 1 && b->vertex[3] == 3);
        CHECK(a->L.nnz == b->L.nnz && a->mesh.n_edges == b->mesh.n_edges && a->h == b->h);
        CHECK(memcmp(a->L.val, b->L.val, (size_t)a->L.nnz * sizeof(double)) == 0);
        CHECK(memcmp(a->mass, b->mass, (size_t)a->n_active * sizeof(double)) == 0);
        CHECK(a->mesh.n_boundary_loops == b->mesh.n_boundary_loops && b->mesh.n_nonmanifold_edges == 0);
    }
}

/* Vertices without mass in the middle of the numbering. */
static void op_inert_rows(void) {
    const double xyz[15] = {9, 9, 9, 0, 0, 0, 8, 8, 8, 3, 0, 0, 0, 4, 0};
    const int32_t tri[3] = {1, 3, 4};
    const int32_t rows[5] = {-1, 0, -1, 1, 2}, vertices[3] = {1, 3, 4};
    double x[5] = {100, 1, 100, 2, 4}, y[5];
    hd_laplacian *lap = op_make(xyz, 5, tri, 1, HD_LAPLACIAN_FEM);
    CHECK(memcmp(lap->row, rows, sizeof rows) == 0 && memcmp(lap->vertex, vertices, sizeof vertices) == 0);
    CHECK(hd_laplacian_apply(lap, 2, 3, x, y, NULL) == HD_OK);    /* L x = (-2/3 - 9/8, 2/3, 9/8), B x = (4, 4.5, 5.5) */
    CHECK(y[0] == 0 && y[2] == 0);
    CHECK(fabs(y[1] - (2 * (-2.0 / 3 - 9.0 / 8) + 12)) < 1e-14 && fabs(y[3] - (4.0 / 3 + 13.5)) < 1e-14 && fabs(y[4] - (9.0 / 4 + 16.5)) < 1e-14);
}

static void op_nonmanifold(void) {
    /* three triangles on the edge (0, 1), opposite corners with cotangents 0, 0 and 3/4 */
    const double xyz[15] = {0, 0, 0, 2, 0, 0, 1, 1, 0, 1, -1, 0, 1, 0, 2};
    const int32_t tri[9] = {0, 1, 2, 1, 0, 3, 0, 1, 4};
    hd_laplacian *lap = op_make(xyz, 5, tri, 3, HD_LAPLACIAN_FEM);
    const double cot4 = 3.0 / 4;                 /* (-1,0,-2).(1,0,-2) = 3, cross = 4 */
    CHECK_MSG(fabs(op_l(lap, 0, 1) + cot4 / 2) < 1e-14, "%.17g", op_l(lap, 0, 1));
    CHECK(fabs(op_b(lap, 0, 1) - (1 + 1 + 2) / 12.0) < 1e-14);
    CHECK(lap->mesh.n_nonmanifold_edges == 1 && lap->mesh.n_edges == 7 && lap->mesh.n_boundary_edges == 6);
    CHECK(lap->n_components == 1);
}

static void op_borders(void) {
    shape cylinder = kit_own_shape(shape_cylinder(9, 4, 1, 1)), grid = kit_own_shape(shape_grid(4, 4, 0.2)), ball = kit_own_shape(shape_icosphere(1));
    hd_laplacian *lap = kit_triangles(&cylinder, HD_LAPLACIAN_FEM);
    int32_t keep;
    CHECK(lap->mesh.n_boundary_loops == 2 && lap->mesh.n_boundary_edges == 18 && lap->mesh.n_misoriented_edges == 0);
    CHECK(lap->mesh.n_edges == (3 * 54 + 18) / 2);
    lap = kit_triangles(&grid, HD_LAPLACIAN_FEM);
    CHECK(lap->mesh.n_boundary_loops == 1 && lap->mesh.n_boundary_edges == 12);
    lap = kit_triangles(&ball, HD_LAPLACIAN_FEM);
    CHECK(lap->mesh.n_boundary_loops == 0 && lap->mesh.n_boundary_edges == 0 && lap->mesh.n_misoriented_edges == 0 && lap->mesh.n_edges == 120);
    keep = ball.tri[0];
    ball.tri[0] = ball.tri[1];
    ball.tri[1] = keep;
    lap = kit_triangles(&ball, HD_LAPLACIAN_FEM);
    CHECK(lap->mesh.n_misoriented_edges == 3 && lap->mesh.n_boundary_edges == 0);
    ball.n_tri--;                                /* a hole of one triangle */
    lap = kit_triangles(&ball, HD_LAPLACIAN_FEM);
    CHECK(lap->mesh.n_boundary_loops == 1 && lap->mesh.n_boundary_edges == 3);
}

/* One vertex with 100 000 faces: nothing may be quadratic in its degree. */
static void op_star(void) {
    enum { RIM = 100000 };
    shape s = kit_own_shape(shape_make(RIM + 1, RIM));
    const clock_t start = clock();
    double seconds, *u = KIT_NEW(double, RIM + 1), sum = 0, want = 0;
    hd_heat *heat;
    hd_report rep;
    hd_laplacian *lap;
    int32_t i;
    int q;
    for (i = 0; i < RIM; i++) {                  /* hub in the middle of the numbering */
        const int32_t a = i + (i >= RIM / 2), j = (i + 1) % RIM, b = j + (j >= RIM / 2);
        const double turn = 6.283185307179586 * i / RIM;
        shape_put_vertex(&s, a, cos(turn), sin(turn), 0);
        shape_put_triangle(&s, i, RIM / 2, a, b);
    }
    shape_put_vertex(&s, RIM / 2, 0, 0, 0);
    for (q = 0; q < 3; q++) {
        lap = kit_triangles(&s, op_kinds[q]);
        CHECK(lap->mesh.n_edges == 2 * (int64_t)RIM && lap->mesh.n_boundary_loops == 1 && lap->mesh.n_repeated_face == 0);
        CHECK(fabs(lap->area - 3.14159265358979) < 1e-8);
    }
    heat = kit_heat(lap, "poles=kernel degree=4 tol=1e-4");
    CHECK(heat_column(heat, 1e-6, RIM / 2, u, &rep) >= 0);
    for (i = 0; i <= RIM; i++) sum += u[i];
    want = 1;                                    /* B = I: the heat of the column is that of its source */
    CHECK_MSG(fabs(sum - want) < 1e-9, "star: %.17g", sum);
    seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    CHECK_MSG(seconds < 60, "star: %.1f s", seconds);    /* far above what it takes, far below a square of the degree */
}

/* What is beyond the range of coordinates and areas is refused, with the vertex, the face and the value. Two faces 0 1 2 and 2 1 1. */
static void op_range(double *xyz, const int32_t *tri) {
    static const struct { double x1, y2, value; int vertex, face; } rows[] = {
        {-1e101, 1, -1e101, 1, -1}, {1, DBL_MAX, DBL_MAX, 2, -1},            /* a coordinate */
        {4e50, 1e50, 2e100, 0, 0}, {1e-50, 1e-51, 5e-102, 0, 0},             /* an area */
        {1e-60, 1e-41, 5e-102, 0, 0}, {-1e100, 1e-10, 5e89, 0, 0},           /* the latter by its cotangent */
        {0, 1e-101, 0, 0, -2}, {1e50, 1.9e50, 0, 0, -2}, {1e-49, 1e-50, 0, 0, -2}, {1, 1e-99, 0, 0, -2}};
    size_t k;
    for (k = 0; k < sizeof rows / sizeof *rows; k++) {
        hd_laplacian *lap = NULL;
        hd_error e;
        hd_status st;
        memset(xyz, 0, 12 * sizeof *xyz);
        xyz[3] = rows[k].x1;
        xyz[7] = rows[k].y2;
        st = hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, tri, 2), NULL, &e);
        if (rows[k].face > -2)
            CHECK_MSG(st == HD_ERR_ARGUMENT && e.vertex == rows[k].vertex && e.face == rows[k].face && fabs(e.value / rows[k].value - 1) < 1e-15 && !lap,
                      "range %d: %s, vertex %d, face %d, %g", (int)k, e.text, (int)e.vertex, (int)e.face, e.value);
        else if (rows[k].x1 != 0) CHECK_MSG(st == HD_OK, "range %d: %s", (int)k, e.text);
        else CHECK(st == HD_ERR_ARGUMENT && e.vertex == 2 && e.face == -1 && e.value == rows[k].y2);
        hd_laplacian_free(lap);
    }
}

static void op_errors(void) {
    double xyz[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    int32_t tri[6] = {0, 1, 2, 2, 1, 3};
    hd_laplacian *lap = NULL;
    hd_error e;
    tri[4] = 4;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, tri, 2), NULL, &e) == HD_ERR_INDEX && e.face == 1 && e.value == 4 && e.vertex == -1);
    tri[4] = -7;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, tri, 2), NULL, &e) == HD_ERR_INDEX && e.face == 1 && e.value == -7);
    tri[4] = 1;
    xyz[10] = (double)NAN;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, tri, 2), NULL, &e) == HD_ERR_NOT_FINITE && e.vertex == 3 && e.face == -1 && e.value != e.value);
    xyz[10] = -(double)INFINITY;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, tri, 2), NULL, &e) == HD_ERR_NOT_FINITE && e.vertex == 3 && e.value < 0);
    xyz[10] = 1;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, tri, -1), NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, -1, tri, 2), NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(NULL, 0, NULL, 0), NULL, &e) == HD_ERR_EMPTY);
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, NULL, 0), NULL, &e) == HD_ERR_EMPTY);
    xyz[7] = 0;                                  /* only faces without area: 0 1 2 on a line, 2 1 3 with a corner less */
    xyz[6] = 2;
    tri[5] = 1;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, tri, 2), NULL, &e) == HD_ERR_EMPTY);
    xyz[6] = xyz[7] = 1e99;
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, 4, tri, 2), NULL, &e) == HD_OK);      /* long, but its area is in range */
    hd_laplacian_free(lap);
    lap = NULL;
    op_range(xyz, tri);
}

/* A mesh near the largest areas, and one far from the origin: weights are those of the mesh at its own size and place, bit for
 * bit, since sizes are a power of two apart; far from the origin lengths of normals take another way. */
static void op_largest(void) {
    int i, kind;
    for (kind = 0; kind < 4; kind++) {
        const int far_off = kind > 1;
        shape s = kit_own_shape(shape_icosphere(1));
        hd_laplacian *lap, *big;
        int64_t p;
        for (i = 0; i < 3 * s.n && far_off; i++) s.xyz[i] = floor(ldexp(s.xyz[i], 20));       /* exact after the move */
        lap = kit_triangles(&s, kind % 2 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        for (i = 0; i < 3 * s.n; i++) s.xyz[i] = far_off ? ldexp(s.xyz[i] + (i % 3 == 1 ? ldexp(1, 40) : 0), 120) : ldexp(s.xyz[i], 164);
        big = kit_triangles(&s, kind % 2 ? HD_LAPLACIAN_VORONOI_COT : HD_LAPLACIAN_FEM);
        CHECK(big->L.nnz == lap->L.nnz && big->mesh.n_zero_area == 0 && big->mesh.n_faces_used == s.n_tri);
        for (p = 0; p < lap->L.nnz; p++) CHECK_MSG(fabs(big->L.val[p] - lap->L.val[p]) <= (far_off ? 1e-14 : 0), "kind %d: %.17g, not %.17g", kind, big->L.val[p], lap->L.val[p]);
        CHECK(fabs(big->area / ldexp(lap->area, far_off ? 240 : 328) - 1) <= 1e-15);
    }
}

/* Heat on a small ball of a given size. What the library says it is, or an error. */
static hd_status op_scaled_heat(double scale, hd_laplacian_kind kind, hd_solver solver, double *u, hd_report *rep) {
    shape s = kit_own_shape(shape_icosphere(1));
    hd_laplacian_opts lo;
    hd_heat_opts ho;
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    hd_status st;
    int32_t i;
    memset(&lo, 0, sizeof lo);
    memset(&ho, 0, sizeof ho);
    memset(rep, 0, sizeof *rep);
    lo.kind = kind;
    ho.solver = solver;
    for (i = 0; i < 3 * s.n; i++) s.xyz[i] *= scale;
    st = hd_laplacian_create(&lap, MESH_TRIANGLES(s.xyz, s.n, s.tri, s.n_tri), &lo, &rep->error);
    if (st >= 0) st = hd_heat_create(&heat, lap, &ho, &rep->error);
    if (st >= 0) st = heat_column(heat, 0.1 * scale * scale, 3, u, rep);
    CHECK(st >= 0 || (rep->error.status == st && rep->error.text[0]));
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return st;
}

/* Tiny and huge coordinates: a right answer or a clear error, never a wrong answer in silence. */
static void op_extreme_scale(void) {
    enum { N = 42 };
    const double scales[6] = {1e-100, 1e-80, 1e-30, 1e30, 1e80, 1e100};
    static const hd_solver solvers[4] = {HD_SOLVER_AUTO, HD_SOLVER_COCG, HD_SOLVER_MINRES, HD_SOLVER_LANCZOS};
    double want[N], u[N];
    hd_report rep;
    int k, q, v;
    for (q = 0; q < 2; q++) {
        for (v = 0; v < 4; v++) {
            CHECK(op_scaled_heat(1, op_kinds[q], solvers[v], want, &rep) == HD_OK);
            for (k = 0; k < 6; k++) {
                const hd_status st = op_scaled_heat(scales[k], op_kinds[q], solvers[v], u, &rep);
                const double off = st < 0 ? 0 : dense_max_diff(u, want, N) / dense_max_abs(want, N);
                CHECK_MSG(off < 1e-7 || rep.error_bound >= off, "scale %g, kind %d, solver %d: off by %g in silence (bound %g)", scales[k], q,
                          (int)solvers[v], off, rep.error_bound);
                if (fabs(log10(scales[k])) < 50) CHECK_MSG(st >= 0 && off < 1e-7, "scale %g, kind %d, solver %d: %s", scales[k], q, (int)solvers[v], hd_status_name(st));
            }
        }
    }
}

/* ---- the caller's own matrices ---- */

static void op_matrices_good(void) {
    enum { N = 6 };
    hd_csr L = kit_own_csr(test_path_csr(N, 0)), B = kit_own_csr(test_diagonal_csr(N, NULL)), full;
    int32_t i[40] = {0, 1, 2, 3, 4, 5, 0, 1}, j[40] = {0, 1, 2, 3, 4, 5, 3, 4};
    double v[40] = {4, 5, 6, 7, 8, 9, 1, -0.5};
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 2.5, NULL, &e) == HD_OK);
    CHECK(lap->kind == HD_LAPLACIAN_MATRICES && lap->h == 2.5 && lap->n == N && lap->n_active == N && !lap->B && lap->conserves == 1);
    CHECK(lap->area == N && lap->b_ratio == 1 && lap->n_components == 1 && lap->mesh.n_edges == 0);
    hd_laplacian_free(lap);
    full = test_symmetric_csr(N, 8, i, j, v);    /* another pattern than L's */
    CHECK(hd_laplacian_matrices(&lap, &L, &full, 0, NULL, &e) == HD_OK);
    CHECK(lap->B != NULL && lap->L.nnz == L.nnz + 4);
    CHECK(op_b(lap, 0, 3) == 1 && op_b(lap, 3, 0) == 1 && op_b(lap, 4, 1) == -0.5 && op_b(lap, 0, 1) == 0 && op_b(lap, 5, 5) == 9);
    CHECK(op_l(lap, 0, 3) == 0 && op_l(lap, 0, 1) == -1 && op_l(lap, 2, 2) == 2);
    CHECK(lap->mass[0] == 5 && lap->mass[1] == 4.5 && lap->b_diag[1] == 5 && lap->area == 40);
    CHECK(fabs(lap->b_ratio - 0.75) < 1e-15);
    CHECK(!test_csr_fault(&lap->L, 1));
    hd_laplacian_free(lap);
    hd_csr_free(&full, NULL);
}

/* Rows of B without a non-zero carry no mass, whatever L says there; the rest is one component less connected. */
static void op_matrices_inert(void) {
    const double d[5] = {1, 2, 0, 3, 4};
    hd_csr L = kit_own_csr(test_path_csr(5, 0)), B = kit_own_csr(test_diagonal_csr(5, d));
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_OK);
    CHECK(lap->n == 5 && lap->n_active == 4 && lap->row[2] == -1 && lap->row[3] == 2 && lap->vertex[2] == 3 && lap->mesh.n_inert == 1);
    CHECK(lap->n_components == 2 && lap->conserves == 0);        /* rows 1 and 3 lost a neighbour */
    CHECK(lap->area == 10);
    hd_laplacian_free(lap);
}

/* Explicit zeros, one without its mirror entry in L or in B, one whose mirror entry the other matrix stores: the
 * pattern of the pair is symmetric, and no method reads beside it. */
static void op_matrices_zeros(void) {
    int64_t ptr[6] = {0, 1, 2, 3, 4, 5}, ptr_one[6] = {0, 2, 3, 4, 5, 6}, ptr_two[6] = {0, 1, 3, 4, 5, 6};
    int32_t col[5] = {0, 1, 2, 3, 4}, col_one[6] = {0, 2, 1, 2, 3, 4}, col_two[6] = {0, 1, 4, 2, 3, 4}, v;
    double val[5] = {3, 3, 3, 3, 3}, one[6] = {3, 0, 3, 3, 3, 3}, two[6] = {3, 3, 0, 3, 3, 3}, u[5];
    static const hd_method methods[4] = {HD_METHOD_AUTO, HD_METHOD_ITERATIVE, HD_METHOD_DIRECT, HD_METHOD_KRYLOV};
    hd_csr plain = {5, 5, 5, ptr, col, val}, lone = {5, 5, 6, ptr_one, col_one, one}, other = {5, 5, 6, ptr_two, col_two, two};
    hd_csr *L[4] = {&plain, &lone, &lone, &other}, *B[4] = {&lone, &plain, &lone, &lone};
    hd_laplacian *lap = NULL;
    hd_heat_opts o;
    hd_heat *heat;
    hd_error e;
    int q, m;
    memset(&o, 0, sizeof o);
    for (q = 0; q < 4; q++) {
        hd_csr pattern;
        if (!CHECK(hd_laplacian_matrices(&lap, L[q], B[q], 0, NULL, &e) == HD_OK)) continue;
        pattern = lap->L;
        pattern.val = NULL;
        CHECK_MSG(!test_csr_fault(&pattern, 1) && lap->L.nnz == 5 && !lap->B, "pair %d", q);
        for (m = 0; m < 4; m++) {
            o.method = methods[m];
            if (!CHECK(hd_heat_create(&heat, lap, &o, NULL) == HD_OK)) continue;
            CHECK(heat_column(heat, 1, 2, u, NULL) == HD_OK);
            for (v = 0; v < 5; v++) CHECK_MSG(fabs(u[v] - (v == 2) * exp(-1.0)) < 1e-7, "pair %d, method %d: %g", q, m, u[v]);
            hd_heat_free(heat);
        }
        hd_laplacian_free(lap);
    }
    col_two[1] = 0;                              /* L stores (1,0) where B stores (0,1): both zero, both kept */
    col_two[2] = 1;
    two[1] = 0;
    two[2] = 3;
    col_one[1] = 1;
    CHECK(hd_laplacian_matrices(&lap, &other, &lone, 0, NULL, &e) == HD_OK && lap->L.nnz == 7);
    hd_laplacian_free(lap);
}

static void op_matrices_bad(void) {
    enum { N = 4 };
    double d[N] = {1, 2, 3, 4};
    hd_csr L = kit_own_csr(test_path_csr(N, 0)), B = kit_own_csr(test_diagonal_csr(N, d)), small = kit_own_csr(test_diagonal_csr(3, d)), indefinite;
    int32_t i[10] = {0, 1, 2, 3, 0}, j[10] = {0, 1, 2, 3, 1};
    double v[10] = {1, 1, 1, 1, 2}, u[N], keep;
    hd_laplacian *lap = NULL;
    hd_error e;
    hd_status st;
    int k;
    CHECK(hd_laplacian_matrices(&lap, &L, &small, 0, NULL, &e) == HD_ERR_ARGUMENT && e.row == N && e.column == 3);
    CHECK(hd_laplacian_matrices(&lap, &L, &B, -1, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(hd_laplacian_matrices(&lap, &L, &B, (double)NAN, NULL, &e) == HD_ERR_ARGUMENT);
    keep = L.val[1];
    L.val[1] = -1.5;                             /* (0, 1) but not (1, 0) */
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_ERR_NOT_SYMMETRIC && e.row == 0 && e.column == 1);
    L.val[1] = (double)NAN;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_ERR_NOT_FINITE && e.row == 0 && e.column == 1);
    L.val[1] = keep;
    L.col[0] = 9;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_ERR_INDEX && e.row == 0 && e.column == 9);
    L.col[0] = 0;
    B.val[2] = -3;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_ERR_NOT_POSITIVE && e.row == 2 && e.value == -3);
    memset(B.val, 0, N * sizeof *B.val);
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_ERR_EMPTY);
    indefinite = test_symmetric_csr(N, 5, i, j, v);    /* [1 2; 2 1] in the corner: diagonal positive, matrix not */
    st = hd_laplacian_matrices(&lap, &L, &indefinite, 0, NULL, &e);
    if (st >= 0) {                               /* where a solver meets it is soon enough */
        hd_heat *heat = NULL;
        CHECK(hd_heat_create(&heat, lap, NULL, &e) == HD_OK);
        st = heat_columns(heat, 1, HD_KERNEL_SYMMETRIC, 1, i, u, 0, NULL);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
    CHECK_MSG(st == HD_ERR_NOT_POSITIVE, "indefinite B: %s", hd_status_name(st));
    for (k = 0; k < indefinite.nnz; k++) indefinite.val[k] = DBL_MAX;    /* the sum of the first row overflows */
    CHECK(hd_laplacian_matrices(&lap, &L, &indefinite, 0, NULL, &e) == HD_ERR_NOT_FINITE && e.row == 0 && e.value > DBL_MAX);
    for (k = 0; k < N; k++) B.val[k] = 1e100;    /* the most that is taken */
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) >= 0);
    hd_laplacian_free(lap);
    B.val[2] = 1.0001e100;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_ERR_NOT_FINITE && e.row == 2 && e.value == B.val[2] && e.text[0] == 'B');
    B.val[2] = 1;
    L.val[0] = 1.0001e100;                       /* the corner of the path */
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_ERR_NOT_FINITE && e.row == 0 && e.value > 1e100 && e.text[0] == 'L');
    hd_csr_free(&indefinite, NULL);
}

/* A pair on 4 vertices with B = I and single entries of the path's L changed, both of a pair. */
static hd_status op_changed(const int32_t *i, const int32_t *j, const double *v, int32_t count, hd_error *e) {
    hd_csr L = kit_own_csr(test_path_csr(4, 0)), B = kit_own_csr(test_diagonal_csr(4, NULL));
    hd_laplacian *lap = NULL;
    hd_status st;
    int32_t k, side;
    for (k = 0; k < 2 * count; k++) {
        const int32_t at = k / 2, row = k & 1 ? j[at] : i[at], column = k & 1 ? i[at] : j[at];
        for (side = (int32_t)L.row_ptr[row]; side < L.row_ptr[row + 1]; side++)
            if (L.col[side] == column) L.val[side] = v[at];
    }
    st = hd_laplacian_matrices(&lap, &L, &B, 0, NULL, e);
    if (st >= 0) hd_laplacian_free(lap);
    return st;
}

/* Matrices that cannot be positive semi-definite say so, and where: libigl's sign, zeros and entries too large. */
static void op_matrices_sign(void) {
    const int32_t two[1] = {2}, both[2] = {2, 2}, one_two[1] = {1}, ends[2] = {0, 0}, next[2] = {0, 1};
    const double zero[1] = {0}, negative[1] = {-0.5}, large[1] = {-2.1}, most[1] = {-2}, tiny[2] = {1e-30, -1}, fine[2] = {1e-30, -1e-15};
    shape ball = kit_own_shape(shape_bumpy(2, 5));
    hd_laplacian *mesh = kit_triangles(&ball, HD_LAPLACIAN_VORONOI_COT), *lap = NULL;
    hd_csr L = mesh->L, B = kit_own_csr(test_diagonal_csr(L.n_rows, mesh->mass));
    hd_error e;
    int64_t p;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_OK && lap->conserves);
    hd_laplacian_free(lap);
    for (p = 0; p < L.nnz; p++) L.val[p] = -L.val[p];
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_ERR_NOT_POSITIVE && strstr(e.text, "libigl"));
    CHECK(e.row == 0 && e.column == 0 && e.value < 0);
    CHECK(op_changed(two, two, negative, 1, &e) == HD_ERR_NOT_POSITIVE && e.row == 2 && e.column == 2 && e.value == -0.5 && strstr(e.text, "libigl"));
    CHECK(op_changed(both, both, zero, 1, &e) == HD_ERR_NOT_POSITIVE && e.row == 1 && e.column == 2 && e.value == -1);
    CHECK(op_changed(one_two, two, large, 1, &e) == HD_ERR_NOT_POSITIVE && e.row == 1 && e.column == 2 && e.value == -2.1);
    CHECK(op_changed(one_two, two, most, 1, &e) == HD_OK);       /* singular, but not yet negative by this test */
    CHECK(op_changed(ends, next, tiny, 2, &e) == HD_ERR_NOT_POSITIVE && e.row == 0 && e.column == 1 && e.value == -1);
    CHECK(op_changed(ends, next, fine, 2, &e) == HD_OK);
}

/* Cotangent weights summed corner by corner in any order: rows are off zero by rounding, and heat is conserved. */
static void op_matrices_assembled(void) {
    shape s = kit_own_shape(shape_bumpy(4, 3));
    const int32_t room = 12 * s.n_tri;
    int32_t *i = KIT_NEW(int32_t, room), *j = KIT_NEW(int32_t, room), f, k, order;
    double *v = KIT_NEW(double, room);
    hd_csr B = kit_own_csr(test_diagonal_csr(s.n, NULL));
    uint64_t seed = 8;
    for (f = 0; f < s.n; f++) s.xyz[3 * f + 2] *= 0.03;          /* slivers among them */
    for (order = 0; order < 2; order++) {
        hd_laplacian *lap = NULL;
        hd_csr L;
        int32_t c = 0, off = 0;
        for (f = 0; f < s.n_tri; f++) {
            for (k = 0; k < 3; k++) {
                const int32_t a = s.tri[3 * f + (k + 1) % 3], b = s.tri[3 * f + (k + 2) % 3], o = s.tri[3 * f + k];
                double u[3], w[3], dot = 0, uu = 0, ww = 0, weight;
                int q;
                for (q = 0; q < 3; q++) {
                    u[q] = s.xyz[3 * a + q] - s.xyz[3 * o + q];
                    w[q] = s.xyz[3 * b + q] - s.xyz[3 * o + q];
                    dot += u[q] * w[q];
                    uu += u[q] * u[q];
                    ww += w[q] * w[q];
                }
                weight = 0.5 * dot / sqrt(uu * ww - dot * dot);
                i[c] = a; j[c] = b; v[c++] = -weight;
                i[c] = b; j[c] = a; v[c++] = -weight;
                i[c] = j[c] = a; v[c++] = weight;
                i[c] = j[c] = b; v[c++] = weight;
            }
        }
        for (k = c - 1; order && k > 0; k--) {
            const int32_t r = (int32_t)(dense_random(&seed) % (uint64_t)(k + 1)), ti = i[k], tj = j[k];
            const double tv = v[k];
            i[k] = i[r]; j[k] = j[r]; v[k] = v[r];
            i[r] = ti; j[r] = tj; v[r] = tv;
        }
        CHECK(hd_csr_from_triplets(&L, s.n, s.n, c, i, j, v, NULL, NULL) == HD_OK);
        for (k = 0; k < s.n; k++) {
            int64_t p;
            double sum = 0;
            for (p = L.row_ptr[k]; p < L.row_ptr[k + 1]; p++) sum += L.val[p];
            off += sum != 0;
        }
        CHECK(off > s.n / 2);
        if (CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, NULL) == HD_OK)) {
            CHECK(lap->conserves == 1);
            hd_laplacian_free(lap);
        }
        hd_csr_free(&L, NULL);
    }
}

/* A leak of 4e-12 is one, whatever the rows' largest entries hide of it. */
static void op_matrices_leak(void) {
    hd_csr L = kit_own_csr(test_path_csr(64, 1)), B = kit_own_csr(test_diagonal_csr(64, NULL));
    hd_laplacian *lap = NULL;
    int32_t i;
    int64_t p;
    for (i = 0; i < 64; i++)
        for (p = L.row_ptr[i]; p < L.row_ptr[i + 1]; p++)
            if (L.col[p] == i) L.val[p] = 2 + 4e-12;
    if (CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, NULL) == HD_OK)) {
        CHECK(lap->conserves == 0);
        hd_laplacian_free(lap);
    }
}

/* b_ratio for B of 3 x 3 blocks I - (1 - mu) w w', w = (2, 1, 1)/sqrt 6, count of them, whose rows their diagonal does not dominate. */
static hd_status op_block_ratio(int32_t count, double mu, hd_laplacian **lap, hd_error *e) {
    const double w[3] = {2 / sqrt(6), 1 / sqrt(6), 1 / sqrt(6)};
    const int32_t n = 3 * count;
    int32_t *i = KIT_NEW(int32_t, 9 * count), *j = KIT_NEW(int32_t, 9 * count), k;
    double *v = KIT_NEW(double, 9 * count);
    hd_csr L = kit_own_csr(test_path_csr(n, 0)), B;
    hd_status st;
    for (k = 0; k < 9 * count; k++) {
        i[k] = k / 9 * 3 + k % 9 / 3;
        j[k] = k / 9 * 3 + k % 3;
        v[k] = (i[k] == j[k]) - (1 - mu) * w[k % 9 / 3] * w[k % 3];
    }
    CHECK(hd_csr_from_triplets(&B, n, n, 9 * count, i, j, v, NULL, NULL) == HD_OK);
    st = hd_laplacian_matrices(lap, &L, &B, 0, NULL, e);
    hd_csr_free(&B, NULL);
    return st;
}

/* b_ratio is a lower bound, and where it can be a good one. */
static void op_matrices_ratio(void) {
    enum { N = 20000 };
    static const double mus[4] = {1e-3, 1e-6, 1e-9, 1e-10};
    hd_csr L = kit_own_csr(test_path_csr(N, 0)), B = kit_own_csr(test_path_csr(N, 0));
    hd_laplacian *lap = NULL;
    hd_heat *heat;
    hd_report rep;
    hd_error e;
    double *u = KIT_NEW(double, 3 * 2000), exact;
    int32_t i, q;
    int64_t p;
    for (i = 0; i < N; i++)
        for (p = B.row_ptr[i]; p < B.row_ptr[i + 1]; p++) B.val[p] = B.col[p] == i ? 1 + 1e-9 : 0.5;
    exact = (1e-9 + 2 * pow(sin(1.5707963267948966 / (N + 1)), 2)) / (1 + 1e-9);
    if (CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_OK)) {
        CHECK_MSG(lap->b_ratio >= 9.9e-10 && lap->b_ratio <= exact, "%g, exact %g", lap->b_ratio, exact);
        hd_laplacian_free(lap);
    }
    for (i = 0; i < N; i++)                      /* just below zero */
        for (p = B.row_ptr[i]; p < B.row_ptr[i + 1]; p++) B.val[p] = B.col[p] == i ? 1 - 1e-7 : 0.5;
    CHECK(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_ERR_NOT_POSITIVE);
    for (i = 0; i < N; i++)                      /* nearly singular, but Gershgorin says not quite */
        for (p = B.row_ptr[i]; p < B.row_ptr[i + 1]; p++)
            B.val[p] = B.col[p] == i ? 1 + 1e-13 : i < N - 2 || i + B.col[p] < 2 * N - 3 ? 0 : 1;
    if (CHECK_MSG(hd_laplacian_matrices(&lap, &L, &B, 0, NULL, &e) == HD_OK, "%s", e.text)) {
        CHECK_MSG(lap->b_ratio > 9e-14 && lap->b_ratio < 1.1e-13, "%g", lap->b_ratio);
        hd_laplacian_free(lap);
    }
    for (q = 0; q < 4; q++) {                    /* in the scaling by diag(B) the least eigenvalue of a block is about 2 mu */
        if (!CHECK_MSG(op_block_ratio(100, mus[q], &lap, &e) == HD_OK, "%s", e.text)) continue;
        CHECK_MSG(lap->b_ratio > 0.1 * mus[q] && lap->b_ratio <= 2.1 * mus[q], "%g for mu %g", lap->b_ratio, mus[q]);
        hd_laplacian_free(lap);
    }
    CHECK(op_block_ratio(100, -1e-9, &lap, &e) == HD_ERR_NOT_POSITIVE && op_block_ratio(100, 0, &lap, &e) == HD_ERR_NOT_POSITIVE);
    if (CHECK(op_block_ratio(2000, 2e-12, &lap, &e) == HD_OK)) {   /* beyond what a factorisation can tell: not known, no bound */
        CHECK(lap->b_ratio == 0 && hd_heat_create(&heat, lap, NULL, &e) == HD_OK);
        CHECK(heat_column(heat, 1e-3, 5, u, &rep) >= 0 && rep.error_bound == HUGE_VAL);
        hd_heat_free(heat);
        hd_laplacian_free(lap);
    }
}

static void test_operators(void) {
    op_all_properties();
    op_single_fem();
    op_single_mixed();
    op_grid_stencil();
    op_rigid();
    op_permutation();
    op_left_out();
    op_inert_rows();
    op_nonmanifold();
    op_borders();
    op_star();
    op_errors();
    op_extreme_scale();
    op_largest();
    op_matrices_good();
    op_matrices_inert();
    op_matrices_zeros();
    op_matrices_bad();
    op_matrices_sign();
    op_matrices_assembled();
    op_matrices_leak();
    op_matrices_ratio();
}

#endif
