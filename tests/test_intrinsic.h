/* test_intrinsic.h - intrinsic Delaunay triangulations, mollification, the tufted cover of meshes and of points. Held against the planar Delaunay
 * triangulation by empty circumcircles, against refined meshes, closed forms by hand, and the plain operators where they must agree */

#ifndef TEST_INTRINSIC_H
#define TEST_INTRINSIC_H

enum { TRI_PLAIN, TRI_DELAUNAY, TRI_TUFTED };

static hd_status tri_try(hd_laplacian **out, const shape *s, hd_laplacian_kind kind, int mode, double mollify, hd_context *ctx, hd_error *e) {
    hd_laplacian_opts o;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.triangulation = mode == TRI_DELAUNAY ? HD_TRIANGULATION_DELAUNAY : mode == TRI_TUFTED ? HD_TRIANGULATION_TUFTED : HD_TRIANGULATION_GIVEN;
    o.mollify = o.triangulation ? mollify : 0;
    o.context = ctx;
    return hd_laplacian_create(out, MESH_TRIANGLES(s->xyz, s->n, s->tri, s->n_tri), &o, e);
}

static hd_laplacian *tri_make(const shape *s, hd_laplacian_kind kind, int mode) {
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK_MSG(tri_try(&lap, s, kind, mode, 0, NULL, &e) == HD_OK, "%s", e.text);
    return kit_own_laplacian(lap);
}

/* Stretched along x, so that its triangles become slivers. */
static void tri_stretch(shape *s, double factor) {
    int32_t i;
    for (i = 0; i < s->n; i++) s->xyz[3 * i] *= factor;
}

static double tri_sum(const double *x, int32_t n) {
    double sum = 0;
    int32_t i;
    for (i = 0; i < n; i++) sum += x[i];
    return sum;
}

static int tri_compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void tri_sort(double *x, int32_t n) { qsort(x, (size_t)n, sizeof *x, tri_compare); }

/* Largest difference of L, B and mass; b may be a with vertices renumbered, to[vertex of b] = vertex of a, or have more vertices. */
static double tri_differ(const hd_laplacian *a, const hd_laplacian *b, const int32_t *to) {
    const double unit = a->area / a->n_active;
    double worst = 0;
    int32_t i;
    int64_t p;
    int turn;
    for (turn = 0; turn < 2; turn++) {           /* entries of either must be found in the other */
        const hd_laplacian *x = turn ? b : a;
        for (i = 0; i < x->n_active; i++) {
            for (p = x->L.row_ptr[i]; p < x->L.row_ptr[i + 1]; p++) {
                int32_t u = x->vertex[i], v = x->vertex[x->L.col[p]], w;
                const int32_t u0 = u, v0 = v;
                if (u >= a->n || v >= a->n) continue;
                if (to && !turn) {
                    for (w = 0; w < a->n; w++) {
                        if (to[w] == u0) u = w;
                        if (to[w] == v0) v = w;
                    }
                } else if (to) {
                    u = to[u];
                    v = to[v];
                }
                worst = fmax(worst, fabs(x->L.val[p] - op_l(turn ? a : b, u, v)));
                worst = fmax(worst, fabs(op_b(x, u0, v0) - op_b(turn ? a : b, u, v)) / (a->kind == HD_LAPLACIAN_COT ? 1 : unit));
            }
        }
    }
    return worst;
}

static double tri_worst_sign(const hd_laplacian *lap) {
    double worst = -DBL_MAX;
    int64_t p;
    int32_t i;
    for (i = 0; i < lap->n_active; i++)
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++)
            if (lap->L.col[p] != i) worst = fmax(worst, lap->L.val[p]);
    return worst;
}

/* Symmetric, rows sum to zero, masses positive and summing to the area; no entry above zero where closed. */
static void tri_properties(const hd_laplacian *lap, int signs, double area_tol, const char *what) {
    const double want = lap->kind == HD_LAPLACIAN_COT ? lap->n_active : lap->area;
    double worst = 0;
    int64_t p, asymmetric = 0;
    int32_t i;
    CHECK_MSG(!test_csr_fault(&lap->L, 1), "%s: %s", what, test_csr_fault(&lap->L, 1));
    for (i = 0; i < lap->n_active; i++) {
        double sum = 0, size = 0, b = 0;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            const int64_t q = op_find(&lap->L, lap->L.col[p], i);
            asymmetric += q < 0 || lap->L.val[p] != lap->L.val[q] || (lap->B && lap->B[p] != lap->B[q]);
            sum += lap->L.val[p];
            size += fabs(lap->L.val[p]);
            b += lap->B ? lap->B[p] : lap->mass[i];
            if (lap->B && lap->L.col[p] == i) CHECK(lap->b_diag[i] == lap->B[p]);
        }
        worst = fmax(worst, fabs(sum) / size);
        CHECK(lap->mass[i] > 0);
        if (lap->B) CHECK_MSG(fabs(b - lap->mass[i]) <= 1e-13 * b, "%s: row %d of B sums to %g not %g", what, i, b, lap->mass[i]);
    }
    CHECK_MSG(asymmetric == 0 && worst < 1e-15, "%s: %lld asymmetric, row sum %g", what, (long long)asymmetric, worst);
    CHECK_MSG(fabs(tri_sum(lap->mass, lap->n_active) - want) <= area_tol * want, "%s: masses sum to %g not %g", what, tri_sum(lap->mass, lap->n_active), want);
    CHECK_MSG(lap->mesh.n_not_delaunay == 0, "%s: %lld edges not Delaunay", what, (long long)lap->mesh.n_not_delaunay);
    if (signs) CHECK_MSG(tri_worst_sign(lap) <= 0 && lap->mesh.n_negative_weights == 0, "%s: an entry of %g", what, tri_worst_sign(lap));
}

/* ---- the plane: empty circumcircles ---- */

/* d is within the circumcircle of a, b, c (counterclockwise). */
static int tri_in_circle(const double *a, const double *b, const double *c, const double *d) {
    double m[3][3];
    int k;
    for (k = 0; k < 3; k++) {
        const double *p = k == 0 ? a : k == 1 ? b : c;
        m[k][0] = p[0] - d[0];
        m[k][1] = p[1] - d[1];
        m[k][2] = m[k][0] * m[k][0] + m[k][1] * m[k][1];
    }
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) > 0;
}

/* The Delaunay triangulation of n points in the plane z = 0, by trying all triples. */
static shape tri_planar_delaunay(const double *xyz, int32_t n) {
    shape s = shape_make(n, 2 * n);
    int32_t a, b, c, d, m = 0;
    memcpy(s.xyz, xyz, 3 * (size_t)n * sizeof(double));
    for (a = 0; a < n; a++) {
        for (b = a + 1; b < n; b++) {
            for (c = a + 1; c < n; c++) {
                const double *p = xyz + 3 * a, *q = xyz + 3 * b, *r = xyz + 3 * c;
                if (c == b || !((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) > 1e-12)) continue;
                for (d = 0; d < n; d++)
                    if (d != a && d != b && d != c && tri_in_circle(p, q, r, xyz + 3 * d)) break;
                if (d == n && CHECK(m < s.n_tri)) shape_put_triangle(&s, m++, a, b, c);
            }
        }
    }
    s.n_tri = m;
    return s;
}

static void tri_plane(void) {
    static const double factors[3] = {1, 4, 0.15};
    int k, q;
    for (k = 0; k < 3; k++) {
        shape s = kit_own_shape(shape_grid(11, 9, 0.4)), d;
        tri_stretch(&s, factors[k]);
        d = kit_own_shape(tri_planar_delaunay(s.xyz, s.n));
        CHECK(d.n_tri == s.n_tri);
        for (q = 0; q < 3; q++) {
            hd_laplacian *plain = tri_make(&d, op_kinds[q], TRI_PLAIN), *lap = tri_make(&s, op_kinds[q], TRI_DELAUNAY);
            const double worst = tri_differ(plain, lap, NULL);
            CHECK_MSG(worst < 1e-12, "stretched by %g, kind %d: off by %g", factors[k], q, worst);
            CHECK(lap->mesh.n_sheets == 1 && lap->mesh.n_self_edges == 0 && lap->mesh.n_mollified == 0 && lap->mesh.mollify_epsilon == 0);
            CHECK(fabs(lap->mesh.smallest_intrinsic_angle - plain->mesh.smallest_angle) < 1e-12 && lap->mesh.n_flips > 0);
            CHECK(lap->mesh.n_negative_weights == plain->mesh.n_negative_weights);
        }
    }
}

/* ---- closed surfaces ---- */

static void tri_closed(void) {
    static const double factors[3] = {1, 10, 0.03};
    int k, q, mode;
    for (k = 0; k < 3; k++) {
        shape s = kit_own_shape(shape_bumpy(3, 5));
        int64_t negative;
        tri_stretch(&s, factors[k]);
        for (q = 0; q < 3; q++) {
            hd_laplacian *plain = tri_make(&s, op_kinds[q], TRI_PLAIN), *lap[3];
            negative = plain->mesh.n_negative_weights;
            for (mode = TRI_DELAUNAY; mode <= TRI_TUFTED; mode++) {
                const hd_mesh_report *r, *p = &plain->mesh;
                lap[mode] = tri_make(&s, op_kinds[q], mode);
                r = &lap[mode]->mesh;
                tri_properties(lap[mode], 1, 1e-12, "closed");
                CHECK(lap[mode]->h == plain->h || fabs(lap[mode]->h / plain->h - 1) < 1e-13);
                CHECK(lap[mode]->area == plain->area && r->smallest_angle == p->smallest_angle && r->n_edges == p->n_edges);
                CHECK(r->n_faces == s.n_tri && r->n_faces_used == s.n_tri && r->n_boundary_edges == 0 && r->n_boundary_loops == 0);
                CHECK(r->n_sheets == 1 && r->smallest_intrinsic_angle > r->smallest_angle && r->n_flips >= negative && negative > 0);
            }
            CHECK(tri_differ(lap[TRI_DELAUNAY], lap[TRI_TUFTED], NULL) == 0);
        }
    }
}

/* The statistics of the faces are those of the plain operator, also where the surface is open, broken, or inside out in places. */
static void tri_same_report(void) {
    const double offset[3] = {2, 0, 0};
    shape a = kit_own_shape(shape_cylinder(9, 4, 1, 2)), b = kit_own_shape(shape_grid(5, 4, 0.3)), s = kit_own_shape(shape_disjoint(&a, &b, offset)), t = kit_own_shape(shape_make(s.n + 1, s.n_tri + 3));
    int32_t f, m = 0;
    int mode;
    memcpy(t.xyz, s.xyz, 3 * (size_t)s.n * sizeof(double));
    shape_put_vertex(&t, s.n, 0.2, 0.1, 3);
    for (f = 0; f < s.n_tri; f++) {
        const int32_t *v = s.tri + 3 * f;
        if (f == 7) continue;                                    /* a hole */
        if (f % 5) shape_put_triangle(&t, m++, v[0], v[1], v[2]);
        else shape_put_triangle(&t, m++, v[0], v[2], v[1]);      /* turned over */
    }
    shape_put_triangle(&t, m++, s.tri[60], s.tri[61], s.n);      /* a fin */
    shape_put_triangle(&t, m++, s.tri[2], s.tri[0], s.tri[1]);   /* repeated */
    shape_put_triangle(&t, m++, 3, 3, 4);
    t.n_tri = m;
    for (mode = TRI_DELAUNAY; mode <= TRI_TUFTED; mode++) {
        hd_laplacian *plain = tri_make(&t, HD_LAPLACIAN_FEM, TRI_PLAIN), *lap = tri_make(&t, HD_LAPLACIAN_FEM, mode);
        const hd_mesh_report *p = &plain->mesh, *r = &lap->mesh;
        CHECK(p->n_faces == r->n_faces && p->n_faces_used == r->n_faces_used && p->n_repeated_corner == r->n_repeated_corner);
        CHECK(p->n_zero_area == r->n_zero_area && p->n_repeated_face == r->n_repeated_face && p->n_edges == r->n_edges);
        CHECK(p->n_boundary_edges == r->n_boundary_edges && p->n_nonmanifold_edges == r->n_nonmanifold_edges && p->n_nonmanifold_edges == 1);
        CHECK(p->n_misoriented_edges == r->n_misoriented_edges && p->n_misoriented_edges > 9);
        CHECK_MSG(p->n_boundary_loops == r->n_boundary_loops, "%d loops, not %d", r->n_boundary_loops, p->n_boundary_loops);
        CHECK(p->n_inert == r->n_inert && p->smallest_angle == r->smallest_angle && fabs(plain->h - lap->h) < 1e-14 && plain->area == lap->area);
        CHECK(plain->n_components == 2 && lap->n_components == 2);
    }
}

/* A surface and its subdivision have the same geometry. The eigenvalues of the finer mesh are nearer to the surface's own; those of the coarse Delaunay
 * triangulation must be nearer to them, on the whole, than those of the coarse slivers. */
static void tri_eigenvalues(void) {
    shape s = kit_own_shape(shape_bumpy(1, 3)), mid, fine;
    hd_laplacian *lap[3];
    dense_pair pair[3];
    double off[2] = {0, 0};
    int k;
    tri_stretch(&s, 0.12);
    mid = kit_own_shape(shape_subdivide(&s));
    fine = kit_own_shape(shape_subdivide(&mid));
    lap[0] = tri_make(&s, HD_LAPLACIAN_FEM, TRI_PLAIN);
    lap[1] = tri_make(&s, HD_LAPLACIAN_FEM, TRI_DELAUNAY);
    lap[2] = tri_make(&fine, HD_LAPLACIAN_FEM, TRI_DELAUNAY);
    for (k = 0; k < 3; k++) {
        CHECK(dense_pair_solve(pair + k, test_dense(&lap[k]->L, NULL), test_dense_mass(lap[k]), lap[k]->n_active));
        tri_sort(pair[k].lambda, lap[k]->n_active);
    }
    CHECK(fabs(pair[1].lambda[0]) < 1e-10 * pair[1].lambda[5]);
    for (k = 1; k <= 6; k++) {
        const double plain = pair[0].lambda[k], delaunay = pair[1].lambda[k], best = pair[2].lambda[k];
        off[0] += fabs(plain / best - 1);
        off[1] += fabs(delaunay / best - 1);
        CHECK_MSG(fabs(delaunay / best - 1) < 0.25, "eigenvalue %d: %g, refined %g, plain %g", k, delaunay, best, plain);
    }
    CHECK_MSG(off[1] < 0.9 * off[0], "relative errors of the eigenvalues sum to %g, those of the slivers to %g", off[1], off[0]);
    for (k = 0; k < 3; k++) dense_pair_free(pair + k);
}

/* ---- the cover ---- */

/* n pages around a spine along z, at the angles given, of cells x cells squares of the size given, split at random and shaken within their page. */
static shape tri_book(int pages, const double *angle, int32_t cells, double jitter, double stretch) {
    shape page = kit_own_shape(shape_grid(cells + 1, cells + 1, jitter)), s = shape_make((cells + 1) + pages * cells * (cells + 1), pages * page.n_tri);
    int32_t i, j, f, m = 0;
    int k, q;
    for (k = 0; k < pages; k++) {
        for (j = 0; j <= cells; j++) {
            for (i = 0; i <= cells; i++) {
                const double *p = page.xyz + 3 * (j * (cells + 1) + i), x = stretch * p[0];
                const int32_t v = i == 0 ? j : (cells + 1) + (k * cells + i - 1) * (cells + 1) + j;
                shape_put_vertex(&s, v, x * cos(angle[k]), x * sin(angle[k]), p[1]);
            }
        }
        for (f = 0; f < page.n_tri; f++) {
            int32_t v[3];
            for (q = 0; q < 3; q++) {
                i = page.tri[3 * f + q] % (cells + 1);
                j = page.tri[3 * f + q] / (cells + 1);
                v[q] = i == 0 ? j : (cells + 1) + (k * cells + i - 1) * (cells + 1) + j;
            }
            shape_put_triangle(&s, m++, v[0], v[1], v[2]);
        }
    }
    return s;
}

/* Nothing to flip in right-angled cells, and so the cover has the plain operators; else weights become non-negative. */
static void tri_books(void) {
    static const double angle[5] = {0.3, 1.1, 2.9, 4.0, 5.5};
    int pages, q;
    for (pages = 3; pages <= 5; pages++) {
        shape good = kit_own_shape(tri_book(pages, angle, 4, 0, 1)), bad = kit_own_shape(tri_book(pages, angle, 5, 0.35, 4)), r;
        int32_t *to = KIT_NEW(int32_t, bad.n);
        r = kit_own_shape(op_renumbered(&bad, 12, to));
        for (q = 0; q < 3; q++) {
            hd_laplacian *plain = tri_make(&good, op_kinds[q], TRI_PLAIN), *lap = tri_make(&good, op_kinds[q], TRI_TUFTED), *b;
            CHECK(lap->mesh.n_sheets == 2 && lap->mesh.n_nonmanifold_edges == 4 && lap->mesh.n_flips == 0);
            CHECK_MSG(tri_differ(plain, lap, NULL) < 1e-13, "%d pages: off by %g", pages, tri_differ(plain, lap, NULL));
            lap = tri_make(&bad, op_kinds[q], TRI_TUFTED);
            b = tri_make(&r, op_kinds[q], TRI_TUFTED);
            tri_properties(lap, 1, 1e-12, "book");
            CHECK(lap->mesh.n_nonmanifold_edges == 5 && lap->mesh.n_flips > 0 && lap->n_components == 1);
            CHECK_MSG(tri_differ(lap, b, to) < 1e-11, "%d pages renumbered: off by %g", pages, tri_differ(lap, b, to));
            lap = tri_make(&bad, op_kinds[q], TRI_DELAUNAY);
            tri_properties(lap, 0, 1e-12, "book with a boundary");
            CHECK(lap->mesh.n_sheets == 2 && lap->mesh.n_negative_weights > 0);    /* of open edges */
        }
    }
}

/* A closed ball beside a book is covered twice, and keeps the operators it has alone. */
static void tri_cover_of_closed(void) {
    static const double angle[3] = {0, 2, 4}, offset[3] = {9, 0, 0};
    shape ball = kit_own_shape(shape_bumpy(2, 4)), book = kit_own_shape(tri_book(3, angle, 2, 0, 1)), both;
    int q, mode;
    tri_stretch(&ball, 5);
    both = kit_own_shape(shape_disjoint(&ball, &book, offset));
    for (q = 0; q < 3; q++) {
        for (mode = TRI_DELAUNAY; mode <= TRI_TUFTED; mode++) {
            hd_laplacian *alone = tri_make(&ball, op_kinds[q], mode), *lap = tri_make(&both, op_kinds[q], mode);
            CHECK(alone->mesh.n_sheets == 1 && lap->mesh.n_sheets == 2 && lap->mesh.n_flips > alone->mesh.n_flips && alone->mesh.n_flips > 0);
            CHECK_MSG(tri_differ(alone, lap, NULL) < 1e-12, "kind %d, mode %d: off by %g", q, mode, tri_differ(alone, lap, NULL));
        }
    }
}

/* An obtuse triangle and its back: the long edge goes, an edge from the obtuse corner to itself comes. By hand, with the angles a, b at its ends:
 * weights tan(a)/2, tan(b)/2 and none between the ends. */
static void tri_obtuse(void) {
    const double xyz[9] = {0, 0, 0, 5, 0, 0, 2, 1, 0}, tan_a = 1.0 / 2, tan_b = 1.0 / 3, ik2 = 5, jk2 = 10;
    const double a_area = 0.25 * ik2 * 2 * tan_a / (1 + tan_a * tan_a), b_area = 0.25 * jk2 * 2 * tan_b / (1 + tan_b * tan_b);
    const int32_t tri[3] = {0, 1, 2};
    shape s = kit_own_shape(shape_make(3, 1));
    int q;
    memcpy(s.xyz, xyz, sizeof xyz);
    memcpy(s.tri, tri, sizeof tri);
    for (q = 0; q < 3; q++) {
        hd_laplacian *lap = tri_make(&s, op_kinds[q], TRI_TUFTED), *open = tri_make(&s, op_kinds[q], TRI_DELAUNAY), *plain = tri_make(&s, op_kinds[q], TRI_PLAIN);
        CHECK(lap->mesh.n_self_edges == 1 && lap->mesh.n_flips == 1 && lap->mesh.n_sheets == 2);
        CHECK(fabs(op_l(lap, 0, 2) + tan_a / 2) < 1e-15 && fabs(op_l(lap, 1, 2) + tan_b / 2) < 1e-15 && op_l(lap, 0, 1) == 0);
        CHECK(open->mesh.n_flips == 0 && tri_differ(open, plain, NULL) < 1e-15 && open->mesh.n_negative_weights == 1);
        if (q == 0) {                            /* areas of the two halves; corners k, k, i */
            CHECK(fabs(op_b(lap, 0, 0) - a_area / 6) < 1e-15 && fabs(op_b(lap, 0, 2) - a_area / 6) < 1e-15);
            CHECK(fabs(op_b(lap, 1, 1) - b_area / 6) < 1e-15 && fabs(op_b(lap, 2, 2) - (a_area + b_area) / 2) < 1e-15 && op_b(lap, 0, 1) == 0);
            CHECK(fabs(a_area + b_area - 2.5) < 1e-15 && lap->b_ratio < 0.43 && open->b_ratio == 0.5);
        }
    }
}

/* B >= b_ratio diag(B), where edges from a vertex to itself make it worst. */
static void tri_b_ratio(void) {
    shape s = kit_own_shape(shape_grid(5, 2, 0));
    hd_laplacian *lap;
    dense_pair pair;
    double *D, *B;
    int32_t i, n;
    tri_stretch(&s, 0.1);
    for (i = 0; i < s.n; i++) s.xyz[3 * i] += 0.4 * s.xyz[3 * i + 1];
    lap = tri_make(&s, HD_LAPLACIAN_FEM, TRI_TUFTED);
    n = lap->n_active;
    B = test_dense_mass(lap);
    D = DENSE_NEW(double, (int64_t)n * n);
    for (i = 0; i < n; i++) D[(size_t)i * (size_t)n + (size_t)i] = B[(size_t)i * (size_t)n + (size_t)i];
    CHECK(lap->mesh.n_self_edges > 0);
    CHECK(dense_pair_solve(&pair, B, D, n));
    for (i = 0; i < n; i++) CHECK_MSG(pair.lambda[i] >= lap->b_ratio * (1 - 1e-12), "%g below %g", pair.lambda[i], lap->b_ratio);
    dense_pair_free(&pair);
}

/* A strip of n x 3 cells, glued after half a turn, or (two_sided) after a whole one. */
static shape tri_strip(int32_t n, int two_sided, double jitter) {
    shape s = shape_make(4 * n, 6 * n);
    uint64_t seed = 99;
    int32_t i, j, m = 0;
    for (i = 0; i < n; i++) {
        for (j = 0; j < 4; j++) {
            const double x = 6.283185307179586 * (i + jitter * shape_signed(&seed)) / n, w = 0.3 * (j - 1.5), twist = two_sided ? x : x / 2;
            shape_put_vertex(&s, 4 * i + j, cos(x) * (1 + w * cos(twist)), sin(x) * (1 + w * cos(twist)), w * sin(twist));
        }
    }
    for (i = 0; i < n; i++) {
        for (j = 0; j < 3; j++) {
            const int turn = i + 1 == n && !two_sided, other = shape_random(&seed) & 1u;
            const int32_t a = 4 * i + j, b = a + 1, c = turn ? 3 - j : 4 * ((i + 1) % n) + j, d = turn ? 2 - j : c + 1;
            shape_put_triangle(&s, m++, a, b, other ? c : d);
            shape_put_triangle(&s, m++, other ? b : a, d, c);
        }
    }
    return s;
}

/* Of all triangulations of a surface the Delaunay one has the least Dirichlet energy, whatever the values on the vertices (Rippa 1990): the plain L minus
 * the intrinsic one is positive semi-definite. */
static void tri_energy_of(const shape *s, int mode, const char *what) {
    hd_laplacian *plain = tri_make(s, HD_LAPLACIAN_VORONOI_COT, TRI_PLAIN), *lap = tri_make(s, HD_LAPLACIAN_VORONOI_COT, mode);
    const int32_t n = plain->n_active;
    double *a = test_dense(&plain->L, NULL), *b = test_dense(&lap->L, NULL), *one = DENSE_NEW(double, (int64_t)n * n), top;
    dense_pair pair;
    int32_t i;
    for (i = 0; i < n * n; i++) a[i] -= b[i];
    for (i = 0; i < n; i++) one[(size_t)i * (size_t)n + (size_t)i] = 1;
    CHECK(dense_pair_solve(&pair, a, one, n));
    tri_sort(pair.lambda, n);
    top = pair.lambda[n - 1];
    CHECK_MSG(pair.lambda[0] > -1e-12 * top && top > 0.1, "%s: the energies differ by %g to %g", what, pair.lambda[0], top);
    dense_pair_free(&pair);
    free(b);
}

static void tri_energy(void) {
    static const double angle[3] = {0.5, 2, 4.4};
    shape s = kit_own_shape(shape_bumpy(2, 9)), open = kit_own_shape(shape_grid(9, 8, 0.4)), strip = kit_own_shape(tri_strip(14, 0, 0.3)), book;
    tri_stretch(&s, 7);
    tri_stretch(&open, 5);
    book = kit_own_shape(tri_book(3, angle, 5, 0.3, 3));
    tri_energy_of(&s, TRI_DELAUNAY, "ball");
    tri_energy_of(&open, TRI_DELAUNAY, "rectangle");
    tri_energy_of(&open, TRI_TUFTED, "rectangle, tufted");
    tri_energy_of(&strip, TRI_DELAUNAY, "Moebius");
    tri_energy_of(&strip, TRI_TUFTED, "Moebius, tufted");
    tri_energy_of(&book, TRI_DELAUNAY, "book");
    tri_energy_of(&book, TRI_TUFTED, "book, tufted");
}

static void tri_moebius(void) {
    int q, mode;
    for (q = 0; q < 3; q++) {
        for (mode = TRI_DELAUNAY; mode <= TRI_TUFTED; mode++) {
            shape s = kit_own_shape(tri_strip(14, 0, 0.3)), two = kit_own_shape(tri_strip(14, 1, 0.3)), turned = kit_own_shape(tri_strip(14, 1, 0.3));
            hd_laplacian *a = tri_make(&s, op_kinds[q], mode), *b, *c;
            int32_t f;
            CHECK(a->mesh.n_boundary_loops == 1 && a->mesh.n_sheets == 2 && a->mesh.n_nonmanifold_edges == 0 && a->mesh.n_flips > 0 && a->n_components == 1);
            tri_properties(a, mode == TRI_TUFTED, 1e-12, "Moebius");
            for (f = 0; f < turned.n_tri; f += 3) {              /* two sides, but faces disagree which is which */
                const int32_t v = turned.tri[3 * f];
                turned.tri[3 * f] = turned.tri[3 * f + 1];
                turned.tri[3 * f + 1] = v;
            }
            b = tri_make(&two, op_kinds[q], mode);
            c = tri_make(&turned, op_kinds[q], mode);
            CHECK(b->mesh.n_boundary_loops == 2 && b->mesh.n_sheets == (mode == TRI_TUFTED ? 2 : 1) && c->mesh.n_sheets == 2);
            CHECK(b->mesh.n_misoriented_edges == 0 && c->mesh.n_misoriented_edges > 10 && tri_differ(b, c, NULL) < 1e-12);
            tri_properties(b, mode == TRI_TUFTED, 1e-12, "strip");
        }
    }
}

/* ---- invariance ---- */

static void tri_invariance(void) {
    const double scales[3] = {1, 1e-3, 250};
    int k, q, mode;
    for (mode = TRI_DELAUNAY; mode <= TRI_TUFTED; mode++) {
        shape s = kit_own_shape(shape_bumpy(2, 8)), open = kit_own_shape(shape_grid(9, 8, 0.4)), r;
        int32_t *to = KIT_NEW(int32_t, open.n), i;
        tri_stretch(&s, 4);
        tri_stretch(&open, 3);
        for (q = 0; q < 3; q++) {
            hd_laplacian *a = tri_make(&s, op_kinds[q], mode), *b;
            for (k = 0; k < 3; k++) {
                const double unit = q == 2 ? 1 : scales[k] * scales[k], tol = k == 1 ? 1e-9 : 1e-11;
                double worst = 0;
                int64_t p;
                r = shape_bumpy(2, 8);
                tri_stretch(&r, 4);
                for (i = 0; i < r.n; i++) op_rotate(r.xyz + 3 * i, scales[k]);
                b = tri_make(&r, op_kinds[q], mode);
                CHECK(a->L.nnz == b->L.nnz && memcmp(a->L.col, b->L.col, (size_t)a->L.nnz * sizeof *a->L.col) == 0 && a->mesh.n_flips == b->mesh.n_flips);
                for (p = 0; a->L.nnz == b->L.nnz && p < a->L.nnz; p++) worst = fmax(worst, fabs(a->L.val[p] - b->L.val[p]));
                for (i = 0; i < a->n_active; i++) worst = fmax(worst, fabs(a->mass[i] * unit - b->mass[i]) / (a->mass[i] * unit));
                CHECK_MSG(worst < tol, "mode %d, kind %d, scale %g: off by %g", mode, q, scales[k], worst);
                shape_free(&r);
            }
            r = op_renumbered(&open, 31, to);
            a = tri_make(&open, op_kinds[q], mode);
            b = tri_make(&r, op_kinds[q], mode);
            CHECK_MSG(tri_differ(a, b, to) < 1e-12, "mode %d, kind %d renumbered: off by %g", mode, q, tri_differ(a, b, to));
            shape_free(&r);
        }
    }
}

/* Powers of two change no digit, and neither very small nor very large coordinates do harm. */
static void tri_units(void) {
    static const double angle[3] = {0.5, 2, 4.4}, exponents[4] = {-155, -3, 40, 155};
    int k, mode;
    for (k = 0; k < 4; k++) {
        for (mode = TRI_DELAUNAY; mode <= TRI_TUFTED; mode++) {
            shape s = kit_own_shape(tri_book(3, angle, 4, 0.3, 3));
            hd_laplacian *a = tri_make(&s, HD_LAPLACIAN_FEM, mode), *b;
            const double scale = ldexp(1, (int)exponents[k]);
            int32_t i;
            for (i = 0; i < 3 * s.n; i++) s.xyz[i] *= scale;
            b = tri_make(&s, HD_LAPLACIAN_FEM, mode);
            if (!a || !b) continue;
            CHECK(a->L.nnz == b->L.nnz && memcmp(a->L.val, b->L.val, (size_t)a->L.nnz * sizeof(double)) == 0 && b->h == a->h * scale);
            for (i = 0; i < a->n_active; i++) CHECK(b->mass[i] == a->mass[i] * scale * scale);
        }
    }
}

/* ---- meshes that are not nice ---- */

/* Faces that are left out change nothing. */
static void tri_left_out(void) {
    shape s = kit_own_shape(shape_grid(6, 5, 0.3)), t = kit_own_shape(shape_make(s.n + 3, s.n_tri + 5));
    int32_t m = 0, f;
    int q, mode;
    memcpy(t.xyz, s.xyz, 3 * (size_t)s.n * sizeof(double));
    shape_put_vertex(&t, s.n, 4, 4, 0);
    shape_put_vertex(&t, s.n + 1, 4, 4, 0);
    shape_put_vertex(&t, s.n + 2, 5, 4, 0);
    shape_put_triangle(&t, m++, s.n, s.n + 1, s.n + 2);          /* an edge of length zero */
    for (f = 0; f < s.n_tri; f++) shape_put_triangle(&t, m++, s.tri[3 * f], s.tri[3 * f + 1], s.tri[3 * f + 2]);
    shape_put_triangle(&t, m++, s.tri[4], s.tri[3], s.tri[5]);   /* repeated, turned over */
    shape_put_triangle(&t, m++, s.tri[3], s.tri[4], s.tri[5]);
    shape_put_triangle(&t, m++, 2, 2, 9);
    shape_put_triangle(&t, m++, 0, 1, 2);                        /* collinear */
    for (q = 0; q < 3; q++) {
        for (mode = TRI_DELAUNAY; mode <= TRI_TUFTED; mode++) {
            hd_laplacian *a = tri_make(&s, op_kinds[q], mode), *b = tri_make(&t, op_kinds[q], mode);
            CHECK(b->mesh.n_repeated_face == 2 && b->mesh.n_zero_area == 2 && b->mesh.n_repeated_corner == 1 && b->mesh.n_inert == 3);
            CHECK(b->n_active == s.n && tri_differ(a, b, NULL) == 0 && a->h == b->h);
        }
    }
}

/* Needles and caps down to heights of 1e-17: rounding breaks the triangle inequality of lengths, mollification repairs it. */
static void tri_slivers(void) {
    static const double heights[4] = {1e-3, 1e-6, 1e-9, 1e-17};
    int k, q, mode, off;
    for (k = 0; k < 4; k++) {
        shape s = kit_own_shape(shape_grid(8, 8, 0.4));
        int32_t i;
        for (i = 0; i < s.n; i++) {              /* a band of the square pressed flat, so that there are needles beside it */
            double *p = s.xyz + 3 * i;
            p[2] = 0.1 * sin(9 * p[0]);
            p[1] = p[1] < 0.5 ? p[1] * heights[k] : 0.5 * heights[k] + p[1] - 0.5;
        }
        for (q = 0; q < 3; q++) {
            for (mode = TRI_DELAUNAY; mode <= TRI_TUFTED; mode++) {
                for (off = 0; off < 2; off++) {
                    hd_laplacian *lap = NULL;
                    hd_error e;
                    CHECK_MSG(tri_try(&lap, &s, op_kinds[q], mode, off ? -1 : 0, NULL, &e) == HD_OK, "%s", e.text);
                    if (!lap) continue;
                    CHECK(lap->mesh.n_faces_used > 90 && (off || k < 1 || lap->mesh.n_mollified > 5));
                    CHECK(!off || (lap->mesh.n_mollified == 0 && lap->mesh.mollify_epsilon == 0));
                    CHECK(lap->mesh.mollify_epsilon <= 1.001e-5 * lap->h);
                    CHECK(isfinite(tri_worst_sign(lap)) && isfinite(tri_sum(lap->mass, lap->n_active)));
                    if (!off) tri_properties(lap, mode == TRI_TUFTED, 1e-3, "slivers");
                    hd_laplacian_free(lap);
                }
            }
        }
    }
}

/* The Voronoi area at the tip of a needle, whose cotangents are huge: still a quarter of the triangle. */
static void tri_needle_mass(void) {
    const double xyz[15] = {0, 0, 0, 0, 1e-99, 0, 1, 0, 0, -1, 0, 0, -1, 1, 0};
    const int32_t tri[9] = {0, 1, 2, 0, 3, 4, 1, 4, 3};
    shape s = kit_own_shape(shape_make(5, 3));
    int mode;
    memcpy(s.xyz, xyz, sizeof xyz);
    memcpy(s.tri, tri, sizeof tri);
    for (mode = TRI_PLAIN; mode <= TRI_TUFTED; mode++) {
        hd_laplacian *lap = NULL;
        hd_error e;
        CHECK_MSG(tri_try(&lap, &s, HD_LAPLACIAN_VORONOI_COT, mode, -1, NULL, &e) == HD_OK, "%s", e.text);
        if (!lap) continue;
        CHECK(mode != TRI_PLAIN || (lap->n_active == 5 && fabs(lap->mass[2] / 1.25e-100 - 1) < 1e-12));
        CHECK(fabs(tri_sum(lap->mass, lap->n_active) - lap->area) < 1e-12);
        hd_laplacian_free(lap);
    }
}

/* delta is what it says: a cap of height 0 in lengths has nothing to spare, so delta h is added to all sides. */
static void tri_mollify_amount(void) {
    const double xyz[12] = {-1, 0, 0, 1, 0, 0, 0, 1e-10, 0, 0, -1, 0};
    const int32_t tri[6] = {0, 1, 2, 1, 0, 3};
    static const double deltas[4] = {0, 1e-5, 1e-3, 0.1};
    shape s = kit_own_shape(shape_make(4, 2));
    hd_laplacian *lap = NULL;
    int k;
    hd_error e;
    memcpy(s.xyz, xyz, sizeof xyz);
    memcpy(s.tri, tri, sizeof tri);
    for (k = 0; k < 4; k++) {
        CHECK(tri_try(&lap, &s, HD_LAPLACIAN_FEM, TRI_TUFTED, deltas[k], NULL, &e) == HD_OK);
        CHECK_MSG(fabs(lap->mesh.mollify_epsilon / ((k ? deltas[k] : 1e-5) * lap->h) - 1) < 1e-9, "%g", lap->mesh.mollify_epsilon / lap->h);
        CHECK(lap->mesh.n_mollified == 1);
        tri_properties(lap, 1, 1, "cap");
        hd_laplacian_free(lap);
        lap = NULL;
    }
    CHECK(tri_try(&lap, &s, HD_LAPLACIAN_FEM, TRI_TUFTED, (double)NAN, NULL, &e) == HD_ERR_ARGUMENT && !lap);
    CHECK(tri_try(&lap, &s, HD_LAPLACIAN_FEM, TRI_DELAUNAY, 1.5, NULL, &e) == HD_ERR_ARGUMENT && !lap);
    s.n_tri = 0;
    CHECK(tri_try(&lap, &s, HD_LAPLACIAN_FEM, TRI_DELAUNAY, 0, NULL, &e) == HD_ERR_EMPTY && !lap);
}

/* ---- the maximum principle ---- */

/* Smallest value of K_t e_i over some i, relative to the largest of its column; adds the error bound that came with it. */
static double tri_smallest_heat(const hd_laplacian *lap, double t, int32_t columns, double *bound) {
    hd_heat *heat = NULL;
    hd_report rep;
    hd_error e;
    double *u = KIT_NEW(double, lap->n), least = 0;
    int32_t q, i;
    *bound = 0;
    CHECK_MSG(hd_heat_create(&heat, lap, NULL, &e) == HD_OK, "%s", e.text);
    for (q = 0; heat && q < columns; q++) {
        const int32_t source = lap->vertex[(int32_t)((int64_t)lap->n_active * q / columns)];
        double low = 0, high = 0;
        CHECK(heat_column(heat, t, source, u, &rep) >= 0);
        for (i = 0; i < lap->n; i++) {
            low = fmin(low, u[i]);
            high = fmax(high, u[i]);
        }
        least = fmin(least, low / high);
        *bound = fmax(*bound, rep.error_bound);
    }
    hd_heat_free(heat);
    return least;
}

static void tri_principle_of(const shape *s, int mode, double h2, int32_t columns, int plain_fails, const char *what) {
    hd_laplacian *plain = tri_make(s, HD_LAPLACIAN_VORONOI_COT, TRI_PLAIN), *lap = tri_make(s, HD_LAPLACIAN_VORONOI_COT, mode);
    const double t = h2 * plain->h * plain->h;
    double bound, bound_plain, least, least_plain;
    least = tri_smallest_heat(lap, t, columns, &bound);
    least_plain = tri_smallest_heat(plain, t, columns, &bound_plain);
    CHECK_MSG(least >= -bound && bound < 1e-3, "%s, t = %g h^2: smallest value %g of the largest, bound %g", what, h2, least, bound);
    if (plain_fails) CHECK_MSG(least_plain < -100 * bound_plain, "%s, t = %g h^2: plain weights give %g, bound %g", what, h2, least_plain, bound_plain);
}

/* A mesh of triangles from a file beside the project, if there is one. */
static shape tri_file(const char *name) {
    char path[200];
    shape s;
    mio_mesh mesh;
    mio_error e;
    FILE *f;
    int64_t k, m = 0;
    int32_t i;
    memset(&s, 0, sizeof s);
    snprintf(path, sizeof path, "../shared/meshes/%s", name);
    f = fopen(path, "rb");
    if (!f) return s;
    fclose(f);
    if (!CHECK_MSG(mio_load(&mesh, path, NULL, &e) == 0, "%s", e.text)) return s;
    for (i = 0; i < mesh.n_faces; i++) m += mesh.face_ptr[i + 1] - mesh.face_ptr[i] - 2;
    s = shape_make(mesh.n, m);
    memcpy(s.xyz, mesh.xyz, 3 * (size_t)mesh.n * sizeof(double));
    for (i = 0, m = 0; i < mesh.n_faces; i++)
        for (k = mesh.face_ptr[i] + 1; k + 1 < mesh.face_ptr[i + 1]; k++)
            shape_put_triangle(&s, (int32_t)m++, mesh.face_idx[mesh.face_ptr[i]], mesh.face_idx[k], mesh.face_idx[k + 1]);
    mio_free(&mesh);
    return s;
}

static void tri_maximum_principle(void) {
    static const char *const names[2] = {"fandisk.obj", "truck.obj"};
    static const double times[3] = {0.1, 3, 30};
    int k, q;
    shape s = shape_bumpy(2, 6), open = kit_own_shape(shape_grid(12, 12, 0.4));
    tri_stretch(&s, 6);
    tri_stretch(&open, 5);
    for (k = 0; k < 3; k++) {
        tri_principle_of(&s, TRI_DELAUNAY, times[k], 8, k < 2, "ball");
        tri_principle_of(&open, TRI_TUFTED, times[k], 8, k < 1, "rectangle");
    }
    shape_free(&s);
    for (q = 0; q < 2; q++) {
        s = tri_file(names[q]);
        for (k = 0; s.xyz && k < 3; k++) tri_principle_of(&s, q ? TRI_TUFTED : TRI_DELAUNAY, times[k], 6, k == 0 && q, names[q]);
        if (s.xyz) {
            hd_laplacian *lap = tri_make(&s, HD_LAPLACIAN_FEM, TRI_TUFTED);
            tri_properties(lap, 1, 1e-4, names[q]);
        }
        shape_free(&s);
    }
}

/* ---- points ---- */

/* The k nearest others of each point, by comparing all. */
static void tri_neighbours(const double *xyz, int32_t n, int32_t k, int64_t *ptr, int32_t *nbr) {
    double *d = KIT_NEW(double, n);
    int32_t i, j, q;
    if (k > n - 1) k = n - 1;
    for (i = 0; i < n; i++) {
        ptr[i] = (int64_t)i * k;
        for (j = 0; j < n; j++) d[j] = j == i ? HUGE_VAL : shape_distance(xyz + 3 * i, xyz + 3 * j);
        for (q = 0; q < k; q++) {
            int32_t best = 0;
            for (j = 1; j < n; j++)
                if (d[j] < d[best]) best = j;
            d[best] = HUGE_VAL;
            nbr[ptr[i] + q] = best;
        }
    }
    ptr[n] = (int64_t)n * k;
}

static hd_status tri_points_try(hd_laplacian **out, const double *xyz, int32_t n, hd_laplacian_kind kind, hd_context *ctx, hd_error *e) {
    int64_t *ptr = KIT_NEW(int64_t, n + 1);
    int32_t *nbr = KIT_NEW(int32_t, 30 * n);
    hd_laplacian_opts o;
    hd_status st;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.context = ctx;
    tri_neighbours(xyz, n, 30, ptr, nbr);
    st = at_tufted(out, xyz, n, ptr, nbr, &o, e);
    return st;
}

static hd_laplacian *tri_points(const double *xyz, int32_t n, hd_laplacian_kind kind) {
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK_MSG(tri_points_try(&lap, xyz, n, kind, NULL, &e) == HD_OK, "%s", e.text);
    return kit_own_laplacian(lap);
}

/* Points of a plane, tilted in space: away from the border all stars agree with the Delaunay triangulation of all points. */
static void tri_points_plane(void) {
    enum { NX = 15, NY = 13 };
    double jitter;
    int q;
    for (jitter = 0; jitter < 0.5; jitter += 0.4) {
        shape s = kit_own_shape(shape_grid(NX, NY, jitter)), d = jitter > 0 ? tri_planar_delaunay(s.xyz, s.n) : shape_grid(NX, NY, 0);
        int32_t i;
        for (i = 0; i < s.n; i++) {
            op_rotate(s.xyz + 3 * i, 2);
            op_rotate(d.xyz + 3 * i, 2);
        }
        for (q = 0; q < 3; q++) {
            hd_laplacian *want = tri_make(&d, op_kinds[q], TRI_PLAIN), *lap = tri_points(s.xyz, s.n, op_kinds[q]);
            double worst = 0;
            int64_t p;
            CHECK(lap->n_active == s.n && lap->mesh.n_sheets == 2 && lap->n_components == 1);
            for (i = 0; i < s.n; i++) {
                if (i % NX < 3 || i % NX > NX - 4 || i / NX < 3 || i / NX > NY - 4) continue;
                for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
                    worst = fmax(worst, fabs(lap->L.val[p] - op_l(want, i, lap->L.col[p])));
                    if (jitter > 0) worst = fmax(worst, fabs(op_b(lap, i, lap->L.col[p]) - op_b(want, i, lap->L.col[p])) / want->mass[i]);
                }
                if (q == 1) worst = fmax(worst, fabs(lap->mass[i] / want->mass[i] - 1));
            }
            CHECK_MSG(worst < 1e-11, "jitter %g, kind %d: off by %g", jitter, q, worst);
            CHECK(tri_worst_sign(lap) <= 0 && lap->mesh.n_negative_weights == 0 && lap->mesh.n_not_delaunay == 0);
        }
        shape_free(&d);
    }
}

static double tri_spacing(const double *xyz, int32_t n) {
    double sum = 0;
    int32_t i, j;
    for (i = 0; i < n; i++) {
        double least = HUGE_VAL;
        for (j = 0; j < n; j++)
            if (j != i) least = fmin(least, shape_distance(xyz + 3 * i, xyz + 3 * j));
        sum += least;
    }
    return sum / n;
}

/* The unit sphere: area 4 pi, the first eigenvalues 2, 2, 2, 6 (five times). */
static void tri_points_sphere(void) {
    shape s = kit_own_shape(shape_icosphere(2)), r;
    int32_t *to = KIT_NEW(int32_t, s.n), i;
    hd_laplacian *lap, *other;
    dense_pair pair;
    uint64_t seed = 3;
    int k;
    for (i = 0; i < s.n; i++) {                  /* no ties */
        double *p = s.xyz + 3 * i, norm;
        for (k = 0; k < 3; k++) p[k] += 0.05 * shape_signed(&seed);
        norm = sqrt(shape_dot(p, p));
        for (k = 0; k < 3; k++) p[k] /= norm;
    }
    lap = tri_points(s.xyz, s.n, HD_LAPLACIAN_VORONOI_COT);
    tri_properties(lap, 1, 1e-4, "points of a sphere");
    CHECK(fabs(lap->area / (16 * atan(1)) - 1) < 0.06 && fabs(lap->h - tri_spacing(s.xyz, s.n)) < 1e-14);
    CHECK(dense_pair_solve(&pair, test_dense(&lap->L, NULL), test_dense_mass(lap), lap->n_active));
    tri_sort(pair.lambda, lap->n_active);
    for (k = 1; k <= 8; k++) CHECK_MSG(fabs(pair.lambda[k] / (k <= 3 ? 2 : 6) - 1) < 0.06, "eigenvalue %d: %g", k, pair.lambda[k]);
    r = kit_own_shape(op_renumbered(&s, 5, to));
    other = tri_points(r.xyz, r.n, HD_LAPLACIAN_VORONOI_COT);
    {   /* which of the copies of a face meet is told by their numbers, where neighbours do not agree; so this is not to the last digits */
        double *u = KIT_NEW(double, s.n), *v = KIT_NEW(double, s.n), *x = KIT_NEW(double, s.n), worst = 0;
        for (i = 0; i < s.n; i++) x[i] = s.xyz[3 * i] + s.xyz[3 * i + 1] * s.xyz[3 * i + 2];
        CHECK(hd_laplacian_apply(lap, 1, 0, x, u, NULL) == HD_OK);
        for (i = 0; i < s.n; i++) v[i] = x[to[i]];
        CHECK(hd_laplacian_apply(other, 1, 0, v, x, NULL) == HD_OK);
        for (i = 0; i < s.n; i++) worst = fmax(worst, fabs(x[i] - u[to[i]]));
        CHECK_MSG(worst < 1e-3, "renumbered: off by %g", worst);
    }
    dense_pair_free(&pair);
}

/* Points in one place, on a line, too few; noise; a plane seen edge on. */
static void tri_points_odd(void) {
    double xyz[3 * 60];
    hd_laplacian *lap = NULL;
    uint64_t seed = 11;
    int32_t i;
    hd_error e;
    memset(xyz, 0, sizeof xyz);
    CHECK(tri_points_try(&lap, xyz, 40, HD_LAPLACIAN_FEM, NULL, &e) == HD_ERR_EMPTY && !lap);    /* all in one place */
    for (i = 0; i < 40; i++) xyz[3 * i + 1] = i;
    CHECK(tri_points_try(&lap, xyz, 40, HD_LAPLACIAN_FEM, NULL, &e) == HD_ERR_EMPTY && !lap);    /* on a line */
    CHECK(tri_points_try(&lap, xyz, 2, HD_LAPLACIAN_FEM, NULL, &e) == HD_ERR_EMPTY && !lap);
    CHECK(tri_points_try(&lap, xyz, 1, HD_LAPLACIAN_FEM, NULL, &e) == HD_ERR_EMPTY && !lap);
    for (i = 0; i < 180; i++) xyz[i] = shape_signed(&seed);                                      /* no surface at all */
    for (i = 0; i < 30; i++) xyz[90 + i] = xyz[i];                                               /* and ten points twice */
    CHECK(tri_points_try(&lap, xyz, 60, HD_LAPLACIAN_VORONOI_COT, NULL, &e) == HD_OK);
    if (lap) {
        tri_properties(lap, 1, 0.01, "noise");
        CHECK(lap->n_active > 50);
    }
    hd_laplacian_free(lap);
}

static void tri_points_bad_input(void) {
    const double xyz[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.1};
    const int32_t nbr[12] = {1, 2, 3, 0, 2, 3, 0, 1, 3, 0, 1, 2}, bad[12] = {1, 2, 3, 0, 2, 3, 0, 1, 4, 0, 1, 2};
    const int64_t ptr[5] = {0, 3, 6, 9, 12}, shifted[5] = {1, 3, 6, 9, 12}, falling[5] = {0, 3, 2, 9, 12};
    int64_t many[5] = {0, 257, 257, 257, 257};
    int32_t *lots = KIT_NEW(int32_t, 257);
    double nan_xyz[12];
    hd_laplacian *lap = NULL;
    hd_error e;
    memcpy(nan_xyz, xyz, sizeof xyz);
    nan_xyz[7] = (double)NAN;
    CHECK(at_tufted(&lap, xyz, 4, shifted, nbr, NULL, &e) == HD_ERR_STRUCTURE && e.row == 0);
    CHECK(at_tufted(&lap, xyz, 4, falling, nbr, NULL, &e) == HD_ERR_STRUCTURE && e.row == 1);
    CHECK(at_tufted(&lap, xyz, 4, ptr, bad, NULL, &e) == HD_ERR_INDEX && e.row == 2 && e.value == 4);
    CHECK(at_tufted(&lap, xyz, 4, many, lots, NULL, &e) == HD_ERR_TOO_LARGE && e.row == 0);
    CHECK(at_tufted(&lap, nan_xyz, 4, ptr, nbr, NULL, &e) == HD_ERR_NOT_FINITE && e.vertex == 2);
    CHECK(at_tufted(&lap, xyz, 4, NULL, nbr, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(at_tufted(NULL, xyz, 4, ptr, nbr, NULL, &e) == HD_ERR_ARGUMENT);
    CHECK(at_tufted(&lap, xyz, -1, ptr, nbr, NULL, &e) == HD_ERR_ARGUMENT && !lap);
    CHECK(at_tufted(&lap, xyz, 4, ptr, nbr, NULL, &e) == HD_OK);
    hd_laplacian_free(lap);
}

/* ---- memory, cancelling, threads ---- */

/* 0, 1: Delaunay and tufted of an open book with slivers; 2: points. */
static hd_status tri_job(hd_context *ctx, int variant, hd_laplacian **out) {
    static const double angle[3] = {0, 2, 4};
    shape s = kit_own_shape(tri_book(3, angle, 3, 0.3, 3));
    hd_error e;
    hd_status st;
    if (variant < 2) st = tri_try(out, &s, HD_LAPLACIAN_FEM, variant ? TRI_TUFTED : TRI_DELAUNAY, 0, ctx, &e);
    else st = tri_points_try(out, s.xyz, s.n, HD_LAPLACIAN_FEM, ctx, &e);
    CHECK(e.status == st);
    return st;
}

typedef struct tri_stop { int64_t calls, stop_at; } tri_stop;

static hd_progress tri_stop_progress(void *user, const char *stage, double done) {
    tri_stop *s = (tri_stop *)user;
    CHECK(stage && stage[0] && done >= 0 && done <= 1);
    return ++s->calls == s->stop_at ? HD_PROGRESS_CANCEL : HD_PROGRESS_CONTINUE;
}

static void tri_failures(void) {
    int variant;
    int64_t k;
    for (variant = 0; variant < 3; variant++) {
        hd_status st = HD_ERR_MEMORY;
        for (k = 1; st < 0 && k < 200; k++) {
            test_memory m;
            hd_context ctx = test_memory_context(&m);
            hd_laplacian *lap = NULL;
            m.fail_at = k;
            st = tri_job(&ctx, variant, &lap);
            CHECK((st == HD_ERR_MEMORY && !lap) || (st == HD_OK && lap));
            hd_laplacian_free(lap);
            test_memory_done(&m, &ctx, "intrinsic");
        }
        CHECK(k > 20 && st == HD_OK);
        for (k = 1, st = HD_ERR_CANCELLED; st < 0 && k < 200; k++) {
            test_memory m;
            hd_context ctx = test_memory_context(&m);
            hd_laplacian *lap = NULL;
            tri_stop stop;
            stop.calls = 0;
            stop.stop_at = k;
            ctx.progress = tri_stop_progress;
            ctx.progress_user = &stop;
            st = tri_job(&ctx, variant, &lap);
            CHECK((st == HD_ERR_CANCELLED && !lap) || (st == HD_OK && lap));
            hd_laplacian_free(lap);
            test_memory_done(&m, &ctx, "intrinsic, cancelled");
        }
        CHECK(k > 4 && st == HD_OK);
    }
}

/* Tasks from the last to the first. */
static void tri_backwards(void *user, int64_t n_tasks, hd_task task, void *arg) {
    (void)user;
    while (n_tasks-- > 0) task(arg, n_tasks, 0);
}

/* The same to the last bit, whoever runs the tasks and in which order. More points than a task takes. */
static void tri_deterministic(void) {
    enum { N = 2500, K = 12 };
    double *xyz = KIT_NEW(double, 3 * N);
    int64_t *ptr = KIT_NEW(int64_t, N + 1);
    int32_t *nbr = KIT_NEW(int32_t, K * N), i;
    hd_laplacian *lap[2] = {NULL, NULL};
    hd_laplacian_opts o;
    hd_context ctx[2];
    uint64_t seed = 77;
    int k;
    for (i = 0; i < N; i++) {
        xyz[3 * i] = i % 50 + 0.3 * shape_signed(&seed);
        xyz[3 * i + 1] = i / 50 + 0.3 * shape_signed(&seed);
        xyz[3 * i + 2] = sin(0.2 * xyz[3 * i]);
    }
    tri_neighbours(xyz, N, K, ptr, nbr);
    for (k = 0; k < 2; k++) {
        memset(&o, 0, sizeof o);
        memset(ctx + k, 0, sizeof *ctx);
        if (k) ctx[k].parallel_for = tri_backwards;
        o.context = ctx + k;
        CHECK(at_tufted(lap + k, xyz, N, ptr, nbr, &o, NULL) == HD_OK);
    }
    if (CHECK(lap[0] && lap[1] && lap[0]->L.nnz == lap[1]->L.nnz)) {
        const size_t size = (size_t)lap[0]->L.nnz * sizeof(double);
        CHECK(memcmp(lap[0]->L.val, lap[1]->L.val, size) == 0 && memcmp(lap[0]->B, lap[1]->B, size) == 0);
        CHECK(lap[0]->h == lap[1]->h && lap[0]->area == lap[1]->area && fabs(lap[0]->area / 2401 - 1) < 0.1);
    }
    for (k = 0; k < 2; k++) hd_laplacian_free(lap[k]);
}

static void test_intrinsic(void) {
    tri_plane();
    tri_closed();
    tri_same_report();
    tri_eigenvalues();
    tri_energy();
    tri_books();
    tri_cover_of_closed();
    tri_obtuse();
    tri_b_ratio();
    tri_moebius();
    tri_invariance();
    tri_units();
    tri_left_out();
    tri_slivers();
    tri_needle_mass();
    tri_mollify_amount();
    tri_maximum_principle();
    tri_points_plane();
    tri_points_sphere();
    tri_points_odd();
    tri_points_bad_input();
    tri_failures();
    tri_deterministic();
}

#endif /* TEST_INTRINSIC_H */
