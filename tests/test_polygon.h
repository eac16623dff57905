/* test_polygon.h - the Laplacian of polygon meshes: against a dense reference that takes its definition at its word, against triangles, by its
 * properties, on the sphere, and with bad input */

#ifndef TEST_POLYGON_H
#define TEST_POLYGON_H

static hd_status poly_try(hd_laplacian **lap, const shape_poly *s, hd_laplacian_kind kind, double lambda, hd_error *e) {
    hd_laplacian_opts o;
    memset(&o, 0, sizeof o);
    o.kind = kind;
    o.stiffening = lambda;
    return hd_laplacian_create(lap, MESH_POLYGONS(s->xyz, s->n, s->face_ptr, s->face_idx, s->n_faces), &o, e);
}

static hd_laplacian *poly_make(const shape_poly *s, double lambda) {
    hd_laplacian *lap = NULL;
    hd_error e;
    CHECK(s->xyz != NULL);
    CHECK_MSG(poly_try(&lap, s, HD_LAPLACIAN_DEFAULT, lambda, &e) == HD_OK, "%s", e.text);
    return kit_own_laplacian(lap);
}

static shape_poly poly_copy(const shape_poly *s) {
    shape_poly c = shape_poly_make(s->n, s->n_faces, s->face_ptr[s->n_faces]);
    memcpy(c.xyz, s->xyz, 3 * (size_t)s->n * sizeof *s->xyz);
    memcpy(c.face_ptr, s->face_ptr, ((size_t)s->n_faces + 1) * sizeof *s->face_ptr);
    memcpy(c.face_idx, s->face_idx, (size_t)s->face_ptr[s->n_faces] * sizeof *s->face_idx);
    c.n_faces = s->n_faces;
    return c;
}

/* Moves every vertex by up to so much in each direction. */
static void poly_shake(shape_poly *s, double much, uint64_t seed) {
    int32_t i;
    for (i = 0; i < 3 * s->n; i++) s->xyz[i] += much * dense_signed(&seed);
}

/* One face of k corners on a wavy, star-shaped curve, a flower; in a plane when rise is 0. */
static shape_poly poly_flower(int32_t k, double rise) {
    shape_poly s = shape_poly_make(k, 1, k);
    int32_t *v = KIT_NEW(int32_t, k), i;
    for (i = 0; i < k; i++) {
        const double a = 6.283185307179586 * i / k, r = 1 + 0.4 * sin(7 * a + 0.3);
        v[i] = i;
        s.xyz[3 * i] = r * cos(a);
        s.xyz[3 * i + 1] = r * sin(a);
        s.xyz[3 * i + 2] = rise * sin(3 * a);
    }
    shape_put_face(&s, k, v);
    return s;
}

/* Faces of 3, 4, 5 and 6 corners, some of them not convex and none but the triangles planar, open; and a piece apart. */
static shape_poly poly_mixed(void) {
    static const double xyz[16][3] = {{0, 0, 0}, {2, 0, 0.2}, {4, 0, 0}, {5, 2, 0.3}, {3, 1.5, -0.2}, {2, 3, 0.4}, {0, 2.5, 0}, {1, 1, 0.1},
                                      {4, 4, 0}, {2, 5, 0.5}, {0, 4.5, -0.3}, {9, 9, 9}, {10, 0, 0}, {11, 0, 0.5}, {11, 1, 0}, {10, 1, 0.3}};
    static const int32_t faces[6][6] = {{0, 1, 7, 6, -1, -1}, {1, 2, 3, 4, 5, 7}, {7, 5, 6, -1, -1, -1}, {5, 4, 3, 8, 9, -1}, {6, 5, 9, 10, -1, -1},
                                        {12, 13, 14, 15, -1, -1}};
    shape_poly s = shape_poly_make(16, 6, 27);
    int32_t f, k;
    memcpy(s.xyz, xyz, sizeof xyz);
    for (f = 0; f < 6; f++) {
        for (k = 0; k < 6 && faces[f][k] >= 0; k++) {}
        shape_put_face(&s, k, faces[f]);
    }
    return s;
}

/* ---- the definition, dense ---- */

/* L_f [k x k] of one face: D'(B B'/|f| + lambda C C') D with the matrices made as they are written. Returns |f|. */
static double poly_dense_face(const shape_poly *s, int32_t f, double lambda, double *out) {
    const int32_t k = (int32_t)(s->face_ptr[f + 1] - s->face_ptr[f]), *v = s->face_idx + s->face_ptr[f];
    double *E = KIT_NEW(double, 3 * k), *B = KIT_NEW(double, 3 * k), *M = KIT_NEW(double, k * k), *EE = KIT_NEW(double, k * k);
    double *Q = KIT_NEW(double, k * k), *d = KIT_NEW(double, k), a[3] = {0, 0, 0}, size, top;
    int32_t p, q, r, c;
    for (p = 0; p < k; p++) {
        const double *x = s->xyz + 3 * v[p], *y = s->xyz + 3 * v[(p + 1) % k];
        for (c = 0; c < 3; c++) {
            E[3 * p + c] = y[c] - x[c];
            B[3 * p + c] = (x[c] + y[c]) / 2;
            a[c] += (x[(c + 1) % 3] * y[(c + 2) % 3] - x[(c + 2) % 3] * y[(c + 1) % 3]) / 2;
        }
    }
    size = sqrt(dense_dot(a, a, 3));
    for (p = 0; p < k; p++) {
        const double along = dense_dot(E + 3 * p, a, 3) / (size * size);
        for (c = 0; c < 3; c++) E[3 * p + c] -= along * a[c];
    }
    for (p = 0; p < k; p++)
        for (q = 0; q < k; q++) EE[p * k + q] = dense_dot(E + 3 * p, E + 3 * q, 3);
    CHECK(dense_symmetric_eigen(EE, Q, d, k));    /* the kernel of the transposed edges is that of E E' */
    top = dense_max_abs(d, k);
    for (p = 0; p < k; p++) {
        for (q = 0; q < k; q++) {
            M[p * k + q] = dense_dot(B + 3 * p, B + 3 * q, 3) / size;
            for (r = 0; r < k; r++)
                if (d[r] < 1e-10 * top) M[p * k + q] += lambda * Q[r * k + p] * Q[r * k + q];
        }
    }
    for (p = 0; p < k; p++) {                     /* (D u)_p = u_(p+1) - u_p */
        for (q = 0; q < k; q++) {
            const int32_t pb = (p + k - 1) % k, qb = (q + k - 1) % k;
            out[p * k + q] = M[pb * k + qb] - M[pb * k + q] - M[p * k + qb] + M[p * k + q];
        }
    }
    return size;
}

/* L [n x n] and mass [n] on all vertices. */
static double *poly_dense(const shape_poly *s, double lambda, double *mass) {
    double *L = DENSE_NEW(double, (int64_t)s->n * s->n);
    int32_t f, p, q;
    for (p = 0; p < s->n; p++) mass[p] = 0;
    for (f = 0; f < s->n_faces; f++) {
        const int32_t k = (int32_t)(s->face_ptr[f + 1] - s->face_ptr[f]), *v = s->face_idx + s->face_ptr[f];
        double *local = KIT_NEW(double, k * k);
        const double size = poly_dense_face(s, f, lambda, local);
        for (p = 0; p < k; p++) {
            mass[v[p]] += size / k;
            for (q = 0; q < k; q++) L[(size_t)v[p] * (size_t)s->n + (size_t)v[q]] += local[p * k + q];
        }
    }
    return L;
}

static void poly_compare(const shape_poly *s, double lambda, double tol, const char *what) {
    hd_laplacian *lap = poly_make(s, lambda);
    double *mass = KIT_NEW(double, s->n), *L = poly_dense(s, lambda ? lambda : 1, mass), worst = 0, off = 0, area = 0;
    const double top = dense_max_abs(L, (int64_t)s->n * s->n);
    int64_t p;
    int32_t i, j;
    for (i = 0; i < s->n; i++) {
        area += mass[i];
        CHECK((lap->row[i] >= 0) == (mass[i] > 0));
        if (lap->row[i] >= 0) worst = fmax(worst, fabs(lap->mass[lap->row[i]] / mass[i] - 1));
    }
    for (i = 0; i < lap->n_active; i++) {
        double *row = L + (size_t)lap->vertex[i] * (size_t)s->n;
        for (p = lap->L.row_ptr[i]; p < lap->L.row_ptr[i + 1]; p++) {
            off = fmax(off, fabs(lap->L.val[p] - row[lap->vertex[lap->L.col[p]]]));
            row[lap->vertex[lap->L.col[p]]] = 0;
        }
        for (j = 0; j < s->n; j++) off = fmax(off, fabs(row[j]));     /* nothing outside the pattern */
    }
    CHECK_MSG(off <= tol * top && worst <= tol, "%s: L off by %.1e, mass by %.1e", what, off / top, worst);
    CHECK(fabs(lap->area - area) <= tol * area && lap->kind == HD_LAPLACIAN_POLYGON && !lap->B && lap->b_diag == lap->mass && lap->b_ratio == 1);
    free(L);
}

static void poly_definition(void) {
    static const double lambdas[4] = {0, 0.1, 1, 10};
    shape_poly s[6];
    int k, q;
    s[0] = shape_quad_torus(12, 8, 2, 0.7);
    s[1] = shape_quad_sphere(4);
    s[2] = shape_hex_sphere(1);
    s[3] = poly_mixed();
    s[4] = poly_flower(60, 0.3);
    s[5] = shape_trominoes(3, 3, 0.3);
    poly_shake(s, 0.05, 3);
    poly_shake(s + 1, 0.05, 4);
    poly_shake(s + 2, 0.05, 5);
    poly_shake(s + 5, 0.1, 6);
    for (k = 0; k < 6; k++)
        for (q = 0; q < 4; q++) poly_compare(s + k, lambdas[q], 2e-13, "definition");
    for (k = 0; k < 6; k++) shape_poly_free(s + k);
}

/* A unit square: M has the two parts 1/2 (of the diagonals) and the alternating vector. */
static void poly_square(void) {
    static const double lambdas[3] = {0, 0.25, 3};
    shape_poly s = kit_own_poly(shape_poly_make(4, 1, 4));
    int k, i, j;
    const double xyz[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    memcpy(s.xyz, xyz, sizeof xyz);
    shape_put_quad(&s, 0, 1, 2, 3);
    for (k = 0; k < 3; k++) {
        hd_laplacian *lap = poly_make(&s, lambdas[k]);
        const double l = lambdas[k] != 0 ? lambdas[k] : 1;
        for (i = 0; i < 4; i++)
            for (j = 0; j < 4; j++) {
                const double want = i == j ? 0.5 + l : (i - j) % 2 ? -l : l - 0.5;
                CHECK_MSG(fabs(op_l(lap, i, j) - want) < 1e-15 * (1 + l), "L(%d,%d) = %.17g, not %g", i, j, op_l(lap, i, j), want);
            }
        CHECK(lap->mass[0] == 0.25 && lap->area == 1 && lap->h == 1 && lap->mesh.n_edges == 4 && lap->mesh.n_boundary_edges == 4);
        CHECK(lap->mesh.n_boundary_loops == 1 && lap->mesh.n_negative_weights == (l > 0.5 ? 2 : 0));
        CHECK(fabs(lap->mesh.smallest_angle - 1.5707963267948966) < 1e-15);
    }
}

/* ---- triangles ---- */

static void poly_equals_triangles(void) {
    static const double lambdas[3] = {0.1, 1, 10};
    const double far_away[3] = {5, 0, 0};
    shape s[4];
    int k, q;
    s[0] = shape_grid(9, 7, 0.4);
    s[1] = shape_bumpy(2, 9);
    s[2] = shape_torus(11, 8, 2, 0.6);
    for (k = 0; k < 3 * s[2].n; k++) s[2].xyz[k] += 0.02 * sin(k);    /* no weights that are zero but for rounding */
    s[3] = shape_disjoint(s, s + 1, far_away);
    for (k = 0; k < 4; k++) {
        shape_poly p = kit_own_poly(shape_poly_of(s + k));
        hd_laplacian *a = kit_triangles(s + k, HD_LAPLACIAN_FEM);
        for (q = 0; q < 3; q++) {
            hd_laplacian *b = poly_make(&p, lambdas[q]);
            const double top = dense_max_abs(a->L.val, a->L.nnz);
            CHECK(a->L.nnz == b->L.nnz && memcmp(a->L.col, b->L.col, (size_t)a->L.nnz * sizeof *a->L.col) == 0);
            CHECK_MSG(dense_max_diff(a->L.val, b->L.val, a->L.nnz) < 1e-14 * top, "lambda %g: %g", lambdas[q], dense_max_diff(a->L.val, b->L.val, a->L.nnz) / top);
            CHECK(dense_max_diff(a->mass, b->mass, a->n_active) < 1e-14 * a->mass[0]);
            CHECK(fabs(a->h / b->h - 1) < 1e-14 && fabs(a->area / b->area - 1) < 1e-14 && a->n_components == b->n_components);
            CHECK(fabs(a->mesh.smallest_angle - b->mesh.smallest_angle) < 1e-13);
            b->mesh.smallest_angle = a->mesh.smallest_angle;
            CHECK(memcmp(&a->mesh, &b->mesh, sizeof a->mesh) == 0);
        }
    }
    for (k = 0; k < 4; k++) shape_free(s + k);
}

/* With the kinds of triangles every face is a fan. */
static void poly_fans(void) {
    shape_poly s = kit_own_poly(poly_mixed());
    int32_t tri[3 * 14], m = 0, f;
    int64_t c;
    int q;
    for (f = 0; f < s.n_faces; f++)
        for (c = s.face_ptr[f] + 1; c + 1 < s.face_ptr[f + 1]; c++, m++) {
            tri[3 * m] = s.face_idx[s.face_ptr[f]];
            tri[3 * m + 1] = s.face_idx[c];
            tri[3 * m + 2] = s.face_idx[c + 1];
        }
    CHECK(m == 14);
    for (q = 0; q < 3; q++) {
        hd_laplacian *a = op_make(s.xyz, s.n, tri, m, op_kinds[q]), *b = NULL;
        hd_error e;
        CHECK(poly_try(&b, &s, op_kinds[q], 0, &e) == HD_OK);
        CHECK(a->L.nnz == b->L.nnz && memcmp(a->L.val, b->L.val, (size_t)a->L.nnz * sizeof(double)) == 0 && a->kind == b->kind && a->h == b->h);
        CHECK(memcmp(a->mass, b->mass, (size_t)a->n_active * sizeof(double)) == 0 && memcmp(&a->mesh, &b->mesh, sizeof a->mesh) == 0);
        hd_laplacian_free(b);
    }
}

/* ---- properties ---- */

/* Symmetric to the last bit, rows sum to zero, no eigenvalue below zero, as many zeros as components. */
static void poly_spectrum(const shape_poly *s, double lambda, int32_t components, const char *what) {
    hd_laplacian *lap = poly_make(s, lambda);
    const int32_t n = lap->n_active;
    double *L = test_dense(&lap->L, NULL), *B = test_dense_mass(lap), *keep = KIT_NEW(double, (int64_t)n * n), worst = 0, top;
    int32_t i, j, zeros = 0, negative = 0, asymmetric = 0;
    dense_pair p;
    memcpy(keep, L, (size_t)n * (size_t)n * sizeof *L);
    CHECK_MSG(!test_csr_fault(&lap->L, 1), "%s: %s", what, test_csr_fault(&lap->L, 1));
    for (i = 0; i < n; i++) {
        double sum = 0, size = 0;
        for (j = 0; j < n; j++) {
            const double x = L[(size_t)i * (size_t)n + (size_t)j];
            asymmetric += x != L[(size_t)j * (size_t)n + (size_t)i];
            sum += x;
            size += fabs(x);
        }
        worst = fmax(worst, fabs(sum) / size);
    }
    CHECK_MSG(asymmetric == 0 && worst < 1e-15, "%s: %d entries differ from their mirror, row sum %g", what, asymmetric, worst);
    CHECK(dense_pair_solve(&p, L, B, n));
    top = dense_max_abs(p.lambda, n);
    for (i = 0; i < n; i++) {
        negative += p.lambda[i] < -1e-12 * top;
        zeros += fabs(p.lambda[i]) < 1e-10 * top;
    }
    CHECK_MSG(negative == 0 && zeros == components && lap->n_components == components, "%s: %d negative, %d zero eigenvalues, %d components", what, negative,
              zeros, (int)lap->n_components);
    CHECK(lap->conserves == 1);
    dense_pair_free(&p);
}

static void poly_properties(void) {
    shape_poly s[6];
    int k;
    s[0] = shape_quad_torus(12, 8, 2, 0.7);
    s[1] = shape_quad_sphere(4);
    s[2] = shape_hex_sphere(1);
    s[3] = poly_mixed();
    s[4] = poly_flower(60, 0.3);
    s[5] = shape_trominoes(4, 5, 0.3);
    poly_shake(s, 0.1, 13);
    for (k = 0; k < 6; k++) {
        poly_spectrum(s + k, 1, k == 3 ? 2 : 1, "property");
        poly_spectrum(s + k, k % 2 ? 0.01 : 100, k == 3 ? 2 : 1, "property, other lambda");
        shape_poly_free(s + k);
    }
}

/* On a planar mesh linear functions are harmonic inside, and have the Dirichlet energy that they should, whatever the faces' shape. */
static void poly_linear(void) {
    int k;
    for (k = 0; k < 4; k++) {
        shape_poly s = k < 2 ? shape_trominoes(6, 7, k ? 0.3 : 0) : poly_flower(k == 2 ? 300 : 37, 0);
        hd_laplacian *lap;
        double *u = KIT_NEW(double, s.n), *y = KIT_NEW(double, s.n), inner = 0, area = 0;
        int32_t i, q;
        for (i = 0; i < s.n_faces; i++) {        /* the shoelace formula */
            int64_t c;
            const int64_t b = s.face_ptr[i], end = s.face_ptr[i + 1];
            for (c = b; c < end; c++) {
                const double *x = s.xyz + 3 * s.face_idx[c], *z = s.xyz + 3 * s.face_idx[c + 1 < end ? c + 1 : b];
                area += (x[0] * z[1] - x[1] * z[0]) / 2;
            }
        }
        for (i = 0; i < s.n; i++) op_rotate(s.xyz + 3 * i, 2);
        lap = poly_make(&s, k % 2 ? 7 : 0);
        CHECK(fabs(lap->area / (4 * area) - 1) < 1e-13);
        for (q = 0; q < 3; q++) {                /* coordinate q, whose gradient in the plane has the length sin(angle to the normal) */
            double energy, slope2;
            const double *a = s.xyz, e1[3] = {1, 0, 0}, e2[3] = {0, 1, 0}, o[3] = {0, 0, 0};
            double p0[3], p1[3], p2[3];
            memcpy(p0, o, sizeof o);
            memcpy(p1, e1, sizeof e1);
            memcpy(p2, e2, sizeof e2);
            op_rotate(p0, 1);
            op_rotate(p1, 1);
            op_rotate(p2, 1);
            slope2 = (p1[q] - p0[q]) * (p1[q] - p0[q]) + (p2[q] - p0[q]) * (p2[q] - p0[q]);
            for (i = 0; i < s.n; i++) u[i] = a[3 * i + q];
            CHECK(hd_laplacian_apply(lap, 1, 0, u, y, NULL) == HD_OK);
            energy = dense_dot(u, y, s.n);
            CHECK_MSG(fabs(energy / (lap->area * slope2) - 1) < 1e-11, "mesh %d, coordinate %d: energy %.17g, not %.17g", k, (int)q, energy, lap->area * slope2);
            for (i = 0; k < 2 && i < s.n; i++)
                if (i % 19 > 0 && i % 19 < 18 && i / 19 > 0 && i / 19 < 14) inner = fmax(inner, fabs(y[i]));
        }
        CHECK_MSG(inner < 1e-11, "mesh %d: L x = %g inside", k, inner);
        shape_poly_free(&s);
    }
}

static void poly_rigid(void) {
    static const double scales[4] = {1, 1e-3, 250, 1e45};
    shape_poly s = kit_own_poly(poly_mixed());
    int k;
    for (k = 0; k < 4; k++) {
        shape_poly r = kit_own_poly(poly_copy(&s));
        hd_laplacian *a, *b;
        double worst;
        int32_t i;
        for (i = 0; i < r.n; i++) op_rotate(r.xyz + 3 * i, scales[k]);
        a = poly_make(&s, 2);
        b = poly_make(&r, 2);
        CHECK(a->L.nnz == b->L.nnz && a->mesh.n_edges == b->mesh.n_edges && a->mesh.n_negative_weights == b->mesh.n_negative_weights);
        worst = dense_max_diff(a->L.val, b->L.val, a->L.nnz);
        for (i = 0; i < a->n_active; i++) worst = fmax(worst, fabs(a->mass[i] * scales[k] * scales[k] / b->mass[i] - 1));
        worst = fmax(worst, fabs(a->h * scales[k] / b->h - 1));
        worst = fmax(worst, fabs(a->mesh.smallest_angle - b->mesh.smallest_angle));
        CHECK_MSG(worst < (k == 1 ? 1e-11 : 1e-13), "scale %g: off by %g", scales[k], worst);
    }
}

/* Where a face begins and which way round it runs says nothing about it, nor does the order of the faces. */
static void poly_turned(void) {
    shape_poly s[3];
    int k, turn, back;
    s[0] = poly_mixed();
    s[1] = shape_trominoes(2, 3, 0.3);
    s[2] = poly_flower(25, 0.2);
    for (k = 0; k < 3; k++) {
        hd_laplacian *a = poly_make(s + k, 0.7);
        for (turn = 0; turn < 5; turn++)
            for (back = 0; back < 2; back++) {
                shape_poly r = kit_own_poly(poly_copy(s + k));
                hd_laplacian *b;
                int32_t f, p;
                r.n_faces = 0;
                for (f = s[k].n_faces - 1; f >= 0; f--) {
                    const int32_t m = (int32_t)(s[k].face_ptr[f + 1] - s[k].face_ptr[f]), *v = s[k].face_idx + s[k].face_ptr[f];
                    int32_t w[64];
                    for (p = 0; p < m; p++) w[p] = v[back ? (2 * m + turn - p) % m : (p + turn) % m];
                    shape_put_face(&r, m, w);
                }
                b = poly_make(&r, 0.7);
                CHECK(a->L.nnz == b->L.nnz && memcmp(a->L.col, b->L.col, (size_t)a->L.nnz * sizeof *a->L.col) == 0);
                CHECK_MSG(dense_max_diff(a->L.val, b->L.val, a->L.nnz) < 2e-14 * dense_max_abs(a->L.val, a->L.nnz), "off by %g",
                          dense_max_diff(a->L.val, b->L.val, a->L.nnz));
                CHECK(dense_max_diff(a->mass, b->mass, a->n_active) < 1e-14 * a->area);
                CHECK(a->mesh.n_edges == b->mesh.n_edges && a->mesh.n_boundary_edges == b->mesh.n_boundary_edges);
                CHECK(a->mesh.n_misoriented_edges == b->mesh.n_misoriented_edges);
            }
        shape_poly_free(s + k);
    }
}

/* Faces of hundreds and thousands of corners: against the definition, and by what must hold. */
static void poly_large_face(void) {
    shape_poly s = poly_flower(300, 0.25);
    hd_laplacian *lap;
    double sum = 0;
    int64_t p;
    poly_compare(&s, 1, 1e-11, "300 corners");
    shape_poly_free(&s);
    s = poly_flower(2000, 0.25);
    lap = poly_make(&s, 0);
    CHECK(lap->L.nnz == 4000000 && lap->mesh.n_edges == 2000 && lap->mesh.n_boundary_loops == 1);
    for (p = 0; p < 4000000; p += 2001) sum += lap->L.val[p];    /* trace: |x_(p-1) - x_(p+1)|^2 / (4 |f|), and of two k - |D'Q|^2 */
    CHECK_MSG(sum > 3996 && sum < 4000.1, "trace %.17g", sum);
    CHECK(lap->context->bytes_peak < 80e6);
    shape_poly_free(&s);
}

/* ---- meshes that are not nice ---- */

/* Good faces with every kind that is left out among them; the pair stays that of the good ones, to the last bit. */
static void poly_left_out(void) {
    static const int32_t bad[][7] = {{4, 0, 1, 1, 7}, {5, 3, 4, 5, 3, 8}, {3, 2, 2, 2},        /* a corner twice */
                                     {4, 16, 17, 18, 19}, {3, 16, 18, 19}, {4, 20, 22, 21, 23},   /* on a line; bow ties */
                                     {4, 24, 26, 25, 27}, {2, 0, 1}, {1, 4}, {0, 0},             /* too few corners */
                                     {4, 1, 7, 6, 0}, {4, 6, 7, 1, 0}, {6, 4, 3, 2, 1, 7, 5}, {3, 5, 6, 7}};   /* repeated, turned, reversed */
    enum { N_BAD = sizeof bad / sizeof *bad };
    shape_poly s = kit_own_poly(poly_mixed()), t = shape_poly_make(16 + 12, 6 + N_BAD, 200);
    hd_laplacian *a = poly_make(&s, 0), *b;
    int32_t f, i;
    memcpy(t.xyz, s.xyz, 3 * (size_t)s.n * sizeof *s.xyz);
    for (i = 0; i < 4; i++) {
        t.xyz[3 * (16 + i)] = i == 3 ? 7 : i;                     /* a line along (1, 2, -1) */
        t.xyz[3 * (16 + i) + 1] = 2 * t.xyz[3 * (16 + i)] + 30;
        t.xyz[3 * (16 + i) + 2] = -t.xyz[3 * (16 + i)];
        t.xyz[3 * (20 + i)] = 20 + (i == 1 || i == 2);            /* a square; 20 22 21 23 is a bow tie of exact numbers */
        t.xyz[3 * (20 + i) + 1] = i > 1;
        t.xyz[3 * (20 + i) + 2] = 0;
        t.xyz[3 * (24 + i)] = 0.1 * (i == 1 || i == 2) - 0.7 * (i > 1);    /* and another where products are rounded */
        t.xyz[3 * (24 + i) + 1] = 0.7 * (i == 1 || i == 2) + 0.1 * (i > 1);
        t.xyz[3 * (24 + i) + 2] = 0.3 * (i == 1 || i == 2);
    }
    for (f = 0; f < 2; f++) shape_put_face(&t, (int32_t)(s.face_ptr[f + 1] - s.face_ptr[f]), s.face_idx + s.face_ptr[f]);
    for (f = 0; f < N_BAD - 4; f++) shape_put_face(&t, bad[f][0], bad[f] + 1);
    for (f = 2; f < 6; f++) shape_put_face(&t, (int32_t)(s.face_ptr[f + 1] - s.face_ptr[f]), s.face_idx + s.face_ptr[f]);
    for (f = N_BAD - 4; f < N_BAD; f++) shape_put_face(&t, bad[f][0], bad[f] + 1);
    b = poly_make(&t, 0);
    CHECK(b->mesh.n_faces == 6 + N_BAD && b->mesh.n_faces_used == 6 && b->mesh.n_repeated_corner == 3);
    CHECK_MSG(b->mesh.n_zero_area == 7 && b->mesh.n_repeated_face == 4, "%d of zero area, %d repeated", b->mesh.n_zero_area, b->mesh.n_repeated_face);
    CHECK(b->mesh.n_inert == 13 && a->mesh.n_inert == 1 && a->row[11] == -1 && b->n == 28 && b->n_active == 15);
    CHECK(a->L.nnz == b->L.nnz && memcmp(a->L.val, b->L.val, (size_t)a->L.nnz * sizeof(double)) == 0 && a->h == b->h);
    CHECK(memcmp(a->mass, b->mass, (size_t)a->n_active * sizeof(double)) == 0 && fabs(a->area - b->area) < 1e-14);
    CHECK(a->mesh.n_edges == b->mesh.n_edges && a->mesh.smallest_angle == b->mesh.smallest_angle);
    shape_poly_free(&t);
    t = shape_poly_make(4, 2, 8);                 /* the same corners in another order are another face */
    memcpy(t.xyz, s.xyz, 12 * sizeof(double));
    shape_put_quad(&t, 0, 1, 2, 3);
    shape_put_quad(&t, 0, 2, 1, 3);
    b = poly_make(&t, 0);
    CHECK(b->mesh.n_repeated_face == 0 && b->mesh.n_faces_used == 2);
    shape_poly_free(&t);
}

static void poly_edges(void) {
    shape_poly s = kit_own_poly(shape_quad_torus(6, 5, 2, 0.7)), t;
    hd_laplacian *lap = poly_make(&s, 0);
    int32_t keep;
    CHECK(lap->mesh.n_edges == 60 && lap->mesh.n_boundary_edges == 0 && lap->mesh.n_misoriented_edges == 0 && lap->L.nnz == 30 * 9);
    keep = s.face_idx[1];                         /* a face turned over */
    s.face_idx[1] = s.face_idx[3];
    s.face_idx[3] = keep;
    lap = poly_make(&s, 0);
    CHECK(lap->mesh.n_misoriented_edges == 4 && lap->mesh.n_nonmanifold_edges == 0);
    s.n_faces--;                                  /* a hole */
    lap = poly_make(&s, 0);
    CHECK(lap->mesh.n_boundary_loops == 1 && lap->mesh.n_boundary_edges == 4 && lap->mesh.n_edges == 60);
    t = kit_own_poly(shape_poly_make(8, 3, 12));                /* three leaves of a book */
    for (keep = 0; keep < 24; keep++) t.xyz[keep] = cos(1.7 * keep);
    shape_put_quad(&t, 0, 1, 2, 3);
    shape_put_quad(&t, 0, 1, 4, 5);
    shape_put_quad(&t, 1, 0, 6, 7);
    lap = poly_make(&t, 0);
    CHECK(lap->mesh.n_nonmanifold_edges == 1 && lap->mesh.n_edges == 10 && lap->mesh.n_boundary_edges == 9 && lap->n_components == 1);
}

static void poly_errors(void) {
    shape_poly s = kit_own_poly(poly_mixed());
    hd_laplacian_opts o;
    hd_laplacian *lap = NULL;
    hd_error e;
    int k;
    static const double bad_lambda[4] = {-1, (double)INFINITY, (double)NAN, 1e101};
    memset(&o, 0, sizeof o);
    s.face_idx[11] = 16;
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_INDEX && e.face == 2 && e.value == 16 && e.vertex == -1);
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_FEM, 0, &e) == HD_ERR_INDEX && e.face == 2 && e.value == 16);
    s.face_idx[11] = -3;
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_INDEX && e.face == 2 && e.value == -3);
    s.face_idx[11] = 5;
    s.face_ptr[3] = 9;
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_STRUCTURE && e.face == 2 && e.value == 9);
    s.face_ptr[3] = 13;
    s.face_ptr[0] = 1;
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_STRUCTURE && e.face == 0);
    s.face_ptr[0] = 0;
    s.face_ptr[6] = (int64_t)1 << 31;
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_TOO_LARGE);
    s.face_ptr[6] = 26;
    s.xyz[7] = (double)NAN;
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_NOT_FINITE && e.vertex == 2 && e.face == -1);
    s.xyz[7] = 0;
    for (k = 0; k < 4; k++) CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, bad_lambda[k], &e) == HD_ERR_ARGUMENT && strstr(e.text, "stiffening"));
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_MATRICES, 0, &e) == HD_ERR_ARGUMENT && poly_try(&lap, &s, (hd_laplacian_kind)99, 0, &e) == HD_ERR_ARGUMENT);
    o.kind = HD_LAPLACIAN_POLYGON;               /* is not for the other function */
    CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(s.xyz, s.n, s.face_idx, 1), &o, &e) == HD_ERR_ARGUMENT && lap == NULL);
    for (k = 0; k < 3 * s.n; k++) s.xyz[k] *= 1e90;     /* no area in range, in any face; the first is named */
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_ARGUMENT && e.face == 0 && e.vertex == s.face_idx[0] && e.value > 1e100);
    for (k = 0; k < 3 * s.n; k++) s.xyz[k] *= 1e-90;
    for (k = 0; k < 9; k++) s.xyz[24 + k] *= 1e90;      /* vertices 8 to 10: faces 3 and 4 */
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_ARGUMENT && e.face == 3);
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_FEM, 0, &e) == HD_ERR_ARGUMENT && e.face == 3 && lap == NULL);
    for (k = 0; k < 9; k++) s.xyz[24 + k] *= 1e-90;
    for (k = 0; k < 3 * s.n; k++) s.xyz[k] *= 1e-70;
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_ARGUMENT && e.face == 0 && e.value < 1e-100);
    for (k = 0; k < 3 * s.n; k++) s.xyz[k] *= 1e-100;
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_ARGUMENT && e.face == -1 && e.vertex >= 0 && e.value < 1e-160);
}

/* Slivers: the entries are finite, rows sum to zero, and nothing is lost in silence; too narrow ones are refused. */
static void poly_slivers(void) {
    static const int32_t sliver[3] = {0, 1, 5};
    double width;
    for (width = 1e-3; width > 1e-200; width *= 1e-9) {
        shape_poly s = kit_own_poly(shape_poly_make(6, 4, 15));
        hd_laplacian *lap = NULL;
        hd_error e;
        int64_t p;
        hd_status st;
        const double xyz[18] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0.3, width * width, 0, 0, 1, 0, 1, width, 0};
        memcpy(s.xyz, xyz, sizeof xyz);
        shape_put_quad(&s, 0, 1, 2, 4);
        shape_put_face(&s, 3, sliver);           /* as wide as said */
        shape_put_quad(&s, 0, 1, 5, 3);          /* about as wide */
        shape_put_quad(&s, 1, 0, 5, 3);          /* crosses itself */
        st = poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e);
        CHECK_MSG(width > 1e-100 ? st == HD_OK : st == HD_ERR_ARGUMENT && e.face == 1, "width %g: %s, face %d", width, e.text, (int)e.face);
        if (st < 0) continue;
        CHECK(lap->mesh.n_faces_used + lap->mesh.n_zero_area == 4);
        for (p = 0; p < lap->L.nnz; p++) CHECK_MSG(fabs(lap->L.val[p]) <= DBL_MAX, "width %g: L = %g", width, lap->L.val[p]);
        hd_laplacian_free(lap);
    }
}

/* A face too thin, and a deep notch, whose tip bends outwards. */
static void poly_long_and_notched(void) {
    static const double notch[21] = {0, 0, 0, 4, 0, 0, 4, 4, 0, 2.2, 4, 0, 2, 0.5, 0, 1.8, 4, 0, 0, 4, 0};
    static const int32_t corner[7] = {0, 1, 2, 3, 4, 5, 6};
    shape_poly s = kit_own_poly(shape_poly_make(11, 2, 11));
    hd_laplacian *lap;
    hd_error e;
    double area;
    int32_t i;
    memcpy(s.xyz, notch, sizeof notch);
    for (i = 7; i < 11; i++) {
        s.xyz[3 * i] = i == 8 || i == 9 ? 1e60 : 0;
        s.xyz[3 * i + 1] = 0;
        s.xyz[3 * i + 2] = 0;
    }
    shape_put_face(&s, 7, corner);
    shape_put_quad(&s, 7, 8, 9, 10);
    lap = poly_make(&s, 0);
    CHECK(lap->mesh.n_zero_area == 1 && lap->mesh.n_inert == 4 && lap->mesh.n_faces_used == 1);
    CHECK_MSG(fabs(lap->mesh.smallest_angle - 1.5707963267948966) < 1e-15, "%.17g", lap->mesh.smallest_angle);
    area = lap->area;
    for (i = 0; i < 21; i++) s.xyz[i] = ldexp(s.xyz[i], 160);
    lap = poly_make(&s, 0);                      /* the notch near the largest areas */
    CHECK(lap->mesh.n_zero_area == 1 && fabs(area - 15.3) < 1e-13 && lap->area == ldexp(area, 320));
    CHECK_MSG(fabs(lap->mesh.smallest_angle - 1.5707963267948966) < 1e-15, "%.17g", lap->mesh.smallest_angle);
    for (i = 8; i < 11; i++) s.xyz[3 * i + 1] = i > 8 ? 1e-50 : 0;
    s.xyz[28] = s.xyz[31] = 1e-50;
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_ARGUMENT && e.face == 1 && fabs(e.value / 1e10 - 1) < 1e-14);
    s.xyz[3] = -(s.xyz[6] = DBL_MAX);            /* nor are differences of corners doubles */
    CHECK(poly_try(&lap, &s, HD_LAPLACIAN_POLYGON, 0, &e) == HD_ERR_ARGUMENT && e.face == -1 && e.vertex == 1 && e.value == -DBL_MAX);
}

/* ---- memory and cancelling ---- */

/* ---- heat ---- */

/* By every method, against the dense eigensolution. */
static void poly_heat(void) {
    static const char *const methods[3] = {"method=direct", "method=krylov", "method=iterative"};
    shape_poly s = kit_own_poly(shape_hex_sphere(2));
    hd_laplacian *lap;
    double *L, *B, *f, *u, *want, t;
    dense_pair p;
    int k;
    poly_shake(&s, 0.03, 21);
    lap = poly_make(&s, 0);
    L = test_dense(&lap->L, NULL);
    B = test_dense_mass(lap);
    f = KIT_NEW(double, s.n);
    u = KIT_NEW(double, s.n);
    want = KIT_NEW(double, s.n);
    t = 5 * lap->h * lap->h;
    f[7] = lap->mass[7];
    CHECK(dense_pair_solve(&p, L, B, s.n));
    dense_pair_heat(&p, t, f, want);
    for (k = 0; k < 3; k++) {
        hd_heat *heat = kit_heat(lap, methods[k]);
        hd_report rep;
        CHECK(heat_column(heat, t, 7, u, &rep) == HD_OK);
        CHECK_MSG(dense_max_diff(u, want, s.n) < 1e-7 * dense_max_abs(want, s.n) && rep.mass_drift < 1e-12, "method %d: %g, drift %g", k,
                  dense_max_diff(u, want, s.n) / dense_max_abs(want, s.n), rep.mass_drift);
    }
    dense_pair_free(&p);
}

static int poly_ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Largest relative error of the eigenvalues 2 (three times), 6 (five times) and 12 (seven times). */
static double poly_sphere_error(shape_poly *s) {
    hd_laplacian *lap = poly_make(s, 0);
    double *L = test_dense(&lap->L, NULL), *B = test_dense_mass(lap), worst = 0;
    dense_pair p;
    int k;
    CHECK(lap->mesh.n_misoriented_edges == 0 && lap->mesh.n_boundary_edges == 0 && lap->n_components == 1);
    CHECK(dense_pair_solve(&p, L, B, lap->n_active));
    qsort(p.lambda, (size_t)lap->n_active, sizeof *p.lambda, poly_ascending);
    for (k = 1; k < 16; k++) worst = fmax(worst, fabs(p.lambda[k] / (k < 4 ? 2 : k < 9 ? 6 : 12) - 1));
    dense_pair_free(&p);
    shape_poly_free(s);
    return worst;
}

static void poly_sphere(void) {
    shape_poly coarse = shape_quad_sphere(4), fine = shape_quad_sphere(8);
    double a = poly_sphere_error(&coarse), b = poly_sphere_error(&fine);
    CHECK_MSG(b < 0.06 && a / b > 3.3, "quads: %g, %g", a, b);
    coarse = shape_hex_sphere(1);
    fine = shape_hex_sphere(2);
    a = poly_sphere_error(&coarse);
    b = poly_sphere_error(&fine);
    CHECK_MSG(b < 0.06 && a / b > 3.3, "hexagons: %g, %g", a, b);
}

static void test_polygon(void) {
    poly_definition();
    poly_square();
    poly_equals_triangles();
    poly_fans();
    poly_properties();
    poly_linear();
    poly_rigid();
    poly_turned();
    poly_large_face();
    poly_left_out();
    poly_edges();
    poly_errors();
    poly_slivers();
    poly_long_and_notched();
    poly_heat();
    poly_sphere();
}

#endif
