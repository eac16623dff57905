/* test_view.h - meshes in vertex and index buffers: the same answers to the bit, and the same errors; test_doors.h has sizes that
 * cannot be */

#ifndef TEST_VIEW_H
#define TEST_VIEW_H

/* The shape as a buffer: positions of one type, stride bytes apart from byte offset on, and indices of one type, offset of them later. */
typedef struct view_buffers {
    char *vertices, *indices;
    shape s;                             /* the same numbers as they come out of the buffer */
    hd_mesh view;
} view_buffers;

enum view_index { VIEW_U16, VIEW_I32, VIEW_TYPES };

static void view_put_index(char *to, enum view_index type, int64_t value) {
    const uint16_t half = (uint16_t)value;
    const uint32_t full = (uint32_t)value;
    if (type == VIEW_U16) memcpy(to, &half, sizeof half);
    else memcpy(to, &full, sizeof full);
}

static void view_put_position(char *to, int floats, const double *p) {
    float f[3];
    int q;
    for (q = 0; q < 3; q++) f[q] = (float)p[q];
    if (floats) memcpy(to, f, sizeof f);
    else memcpy(to, p, 3 * sizeof *p);
}

static view_buffers view_make(const shape *s, int floats, size_t stride, enum view_index type, size_t offset) {
    const size_t wide = floats ? 12 : 24, step = stride ? stride : wide, size = type == VIEW_U16 ? 2 : 4;
    view_buffers b;
    const void *xyz, *tri;
    int32_t i;
    memset(&b, 0, sizeof b);
    b.vertices = DENSE_NEW(char, offset + (size_t)s->n * step + wide);
    b.indices = DENSE_NEW(char, (offset + 3 * (size_t)s->n_tri) * size);
    memset(b.vertices, 0x7f, offset + (size_t)s->n * step + wide);
    b.s.n = s->n;
    b.s.n_tri = s->n_tri;
    b.s.xyz = DENSE_NEW(double, 3 * s->n);
    b.s.tri = DENSE_NEW(int32_t, 3 * s->n_tri);
    memcpy(b.s.tri, s->tri, 3 * (size_t)s->n_tri * sizeof *s->tri);
    for (i = 0; i < 3 * s->n; i++) b.s.xyz[i] = floats ? (double)(float)s->xyz[i] : s->xyz[i];
    for (i = 0; i < s->n; i++) view_put_position(b.vertices + offset + (size_t)i * step, floats, s->xyz + 3 * i);
    for (i = 0; i < 3 * s->n_tri; i++) view_put_index(b.indices + (offset + (size_t)i) * size, type, s->tri[i]);
    xyz = b.vertices + offset;
    tri = b.indices + offset * size;
    if (floats) b.view.xyz_float = (const float *)xyz;
    else b.view.xyz = (const double *)xyz;
    if (type == VIEW_U16) b.view.corner_u16 = (const uint16_t *)tri;
    else b.view.corner = (const int32_t *)tri;
    b.view.stride = stride;
    b.view.n = s->n;
    b.view.n_faces = s->n_tri;
    return b;
}

static void view_free(view_buffers *b) {
    free(b->vertices);
    free(b->indices);
    shape_free(&b->s);
}

static int view_same_laplacian(const hd_laplacian *a, const hd_laplacian *b) {
    const size_t bytes = (size_t)a->L.nnz * sizeof(double);
    return a->n == b->n && a->n_active == b->n_active && a->L.nnz == b->L.nnz && memcmp(a->L.col, b->L.col, bytes / 2) == 0 &&
           memcmp(a->L.val, b->L.val, bytes) == 0 && memcmp(a->B, b->B, bytes) == 0 && a->h == b->h && a->area == b->area &&
           memcmp(a->xyz, b->xyz, 3 * (size_t)a->n_active * sizeof(double)) == 0;
}

/* Every door with one form of the buffers, and the same numbers as doubles. */
static void view_answers(const shape *s, const shape *moved, int floats, size_t stride, enum view_index type, size_t offset) {
    view_buffers b = view_make(s, floats, stride, type, offset), b2 = view_make(moved, floats, stride, type, offset);
    double *d = KIT_NEW(double, s->n), *want = KIT_NEW(double, s->n);
    const int32_t source = s->tri[0];
    hd_laplacian_opts lo = {0};
    hd_geodesic_opts go = {0};
    hd_laplacian *lap = NULL, *other = NULL;
    hd_geodesic *g = NULL, *other_g = NULL;
    hd_error e;
    test_memory m;
    hd_context ctx = test_memory_context(&m);
    int frame;
    lo.updatable = go.updatable = 1;
    lo.context = go.context = &ctx;
    CHECK(hd_laplacian_create(&lap, &b.view, &lo, &e) == HD_OK && hd_geodesic_create(&g, &b.view, &go, &e) == HD_OK);
    CHECK(hd_laplacian_create(&other, MESH_TRIANGLES(b.s.xyz, s->n, b.s.tri, s->n_tri), &lo, &e) == HD_OK);
    CHECK(hd_geodesic_create(&other_g, MESH_TRIANGLES(b.s.xyz, s->n, b.s.tri, s->n_tri), &go, &e) == HD_OK);
    for (frame = 0; frame < 2; frame++) {
        CHECK_MSG(view_same_laplacian(lap, other), "%d %d %d %d, frame %d", floats, (int)stride, (int)type, (int)offset, frame);
        CHECK(hd_geodesic_distance(g, VERTICES(1, &source), d, 0, NULL, &e) >= 0 &&
            hd_geodesic_distance(other_g, VERTICES(1, &source), want, 0, NULL, &e) >= 0);
        CHECK_MSG(memcmp(d, want, (size_t)s->n * sizeof *d) == 0, "%d %d %d %d, frame %d", floats, (int)stride, (int)type, (int)offset, frame);
        CHECK(hd_laplacian_update(lap, &b2.view, &e) == HD_OK && hd_laplacian_update(other, MESH_POINTS(b2.s.xyz, other->n), &e) == HD_OK);
        CHECK(hd_geodesic_update(g, &b2.view, &e) == HD_OK && hd_geodesic_update(other_g, MESH_POINTS(b2.s.xyz, s->n), &e) == HD_OK);
    }
    hd_laplacian_free(lap);
    hd_laplacian_free(other);
    hd_geodesic_free(g);
    hd_geodesic_free(other_g);
    test_memory_done(&m, &ctx, "views");
    view_free(&b);
    view_free(&b2);
}

static void view_forms(void) {
    shape s = kit_own_shape(shape_bumpy(2, 5)), moved = kit_own_shape(shape_bumpy(2, 6));
    static const size_t strides[5] = {0, 12, 13, 14, 32}, wide_strides[4] = {0, 24, 25, 40};
    size_t k, offset;
    for (offset = 0; offset < 2; offset++) {
        for (k = 0; k < 5; k++) view_answers(&s, &moved, 1, strides[k], (enum view_index)(k % VIEW_TYPES), offset);
        for (k = 0; k < 4; k++) view_answers(&s, &moved, 0, wide_strides[k], (enum view_index)(k % VIEW_TYPES), offset);
    }
}

/* The two doors that make something refuse alike. Returns the error of the first. */
static hd_error view_refused(const hd_mesh *v) {
    hd_laplacian *lap = NULL;
    hd_geodesic *g = NULL;
    hd_error e, e2;
    CHECK(hd_laplacian_create(&lap, v, NULL, &e) < 0 && lap == NULL);
    CHECK(hd_geodesic_create(&g, v, NULL, &e2) < 0 && g == NULL);
    CHECK_MSG(e.status == e2.status && e.face == e2.face && e.vertex == e2.vertex && memcmp(&e.value, &e2.value, sizeof e.value) == 0 && strcmp(e.text, e2.text) == 0,
              "%d %s %lld %lld %g, %d %s %lld %lld %g", (int)e.status, e.text, (long long)e.face, (long long)e.vertex, e.value, (int)e2.status, e2.text,
              (long long)e2.face, (long long)e2.vertex, e2.value);
    return e;
}

/* Data that cannot be: the error of packed arrays, and the value as its type has it. */
static void view_bad_data(void) {
    static const double values[VIEW_TYPES] = {65535, -1};
    shape s = kit_own_shape(shape_grid(6, 5, 0));
    hd_laplacian *lap = NULL;
    hd_error e, want;
    int k;
    for (k = 0; k < VIEW_TYPES; k++) {
        const enum view_index type = (enum view_index)k;
        view_buffers b = view_make(&s, 1, 20, type, 1);
        const size_t size = k ? 4 : 2;
        float *broken;
        char *at = b.vertices + 1 + 20 * 7 + 4;
        view_put_index(b.indices + 12 * size, type, -1);
        e = view_refused(&b.view);
        b.s.tri[11] = -1;
        CHECK(hd_laplacian_create(&lap, MESH_TRIANGLES(b.s.xyz, s.n, b.s.tri, s.n_tri), NULL, &want) < 0);
        CHECK_MSG(e.status == HD_ERR_INDEX && e.face == 3 && e.vertex == want.vertex && e.value == values[k] && strcmp(e.text, want.text) == 0,
                  "type %d: %s, face %lld, value %g", k, e.text, (long long)e.face, e.value);
        broken = DENSE_NEW(float, 1);                        /* a coordinate comes before an index */
        *broken = (float)NAN;
        memcpy(at, broken, sizeof *broken);
        e = view_refused(&b.view);
        CHECK(e.status == HD_ERR_NOT_FINITE && e.vertex == 7 && e.face == -1);
        view_put_index(b.indices + 12 * size, type, s.tri[11]);
        e = view_refused(&b.view);
        CHECK(e.status == HD_ERR_NOT_FINITE && e.vertex == 7 && e.face == -1);
        free(broken);
        b.view.corner_u16 = k ? NULL : (const uint16_t *)(const void *)(b.indices + 1);
        b.view.corner = k ? (const int32_t *)(const void *)(b.indices + 2) : NULL;
        e = view_refused(&b.view);
        CHECK(e.status == HD_ERR_ARGUMENT && strstr(e.text, "not aligned"));
        view_free(&b);
    }
}

static void test_view(void) {
    view_forms();
    view_bad_data();
}

#endif
