/* module.c - what core.js calls: surfaces behind functions of numbers and pointers

   build.py makes a WASM module of it, and tests/test_web.py a native library, to compare the two. Functions return
   hd_status, or NULL. After a failure module_text() says what is wrong and module_facts() where. After an answer
   module_facts() says how it was computed and how large its error can be. core.js reads both by the order of the names
   here. Nothing else is shared by two surfaces. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(__wasm__)
#define MODULE_EXPORT(name) __attribute__((export_name(#name))) name
__attribute__((import_module("heatdiff"), import_name("progress")))
int32_t module_progress(const char *stage, double done);                     /* not 0: cancel */
#else
#define MODULE_EXPORT(name) name
static int32_t module_progress(const char *stage, double done) { (void)stage; (void)done; return 0; }
#endif

#define HEATDIFF_IMPLEMENTATION
#define HEATDIFF_STATIC
#include "../../heatdiff.h"

/* A copy of what the user gave, and what was made of it. */
typedef struct module_surface {
    hd_context ctx;
    hd_mesh mesh;
    void *xyz, *corner;
    hd_triangulation triangulation;
    hd_laplacian *lap;
    hd_heat *plan[HD_METHOD_LOCAL + 1];    /* by hd_method, made at their first use */
    hd_geodesic *geodesic;
} module_surface;

static struct {
    double facts[24];
    const char *text;
    hd_error error;
} last;

/* ---- memory and messages ---- */

void *MODULE_EXPORT(module_alloc)(size_t size) { return malloc(size ? size : 1); }
void MODULE_EXPORT(module_free)(void *block) { free(block); }
const double *MODULE_EXPORT(module_facts)(void) { return last.facts; }
const char *MODULE_EXPORT(module_text)(void) { return last.text; }
const char *MODULE_EXPORT(module_status_name)(int32_t status) { return hd_status_name((hd_status)status); }
int32_t MODULE_EXPORT(module_version)(void) { return HD_VERSION; }
double MODULE_EXPORT(module_bytes)(const module_surface *s) { return (double)s->ctx.bytes_in_use; }

static hd_status fail(const hd_error *e) {
    if (e != &last.error) last.error = *e;
    last.text = last.error.text;
    last.facts[0] = (double)last.error.status;
    last.facts[1] = (double)last.error.face;
    last.facts[2] = (double)last.error.vertex;
    last.facts[3] = (double)last.error.row;
    last.facts[4] = (double)last.error.column;
    last.facts[5] = last.error.value;
    return last.error.status;
}

static hd_progress tick(void *user, const char *stage, double done) {
    (void)user;
    return module_progress(stage, done) ? HD_PROGRESS_CANCEL : HD_PROGRESS_CONTINUE;
}

/* ---- surfaces ---- */

void MODULE_EXPORT(module_dispose)(module_surface *s) {
    int i;
    if (!s) return;
    for (i = 0; i <= HD_METHOD_LOCAL; i++) hd_heat_free(s->plan[i]);
    hd_geodesic_free(s->geodesic);
    hd_laplacian_free(s->lap);
    free(s->xyz);
    free(s->corner);
    free(s);
}

static void describe(const module_surface *s) {
    const hd_laplacian *lap = s->lap;
    const hd_mesh_report *m = &lap->mesh;
    const double facts[] = {
        lap->n, lap->n_active, lap->n_components, lap->n_held, lap->h, lap->area, lap->kind, m->n_faces, m->n_faces_used,
        m->n_repeated_corner, m->n_zero_area, m->n_repeated_face, (double)m->n_edges, (double)m->n_boundary_edges,
        (double)m->n_nonmanifold_edges, (double)m->n_misoriented_edges, m->n_boundary_loops, m->n_inert,
        (double)m->n_negative_weights, m->smallest_angle, lap->points.n_coincident, lap->points.n_not_flat};
    memcpy(last.facts, facts, sizeof facts);
}

/* Takes xyz and corner over, blocks of module_alloc. float_bits: 32 or 64. stride: in bytes. corner NULL: points.
 * corner_bits: 16 or 32. byte_limit 0: none. */
module_surface *MODULE_EXPORT(module_create)(int32_t n, void *xyz, int32_t float_bits, size_t stride, int32_t n_faces,
                                             void *corner, int32_t corner_bits, int32_t kind, int32_t triangulation,
                                             int32_t border, int32_t n_held, const int32_t *held, double byte_limit) {
    module_surface *s = (module_surface *)calloc(1, sizeof *s);
    hd_laplacian_opts o;
    if (!s) {
        free(xyz);
        free(corner);
        memset(&last.error, 0xff, sizeof last.error);       /* no place */
        last.error.status = HD_ERR_MEMORY;
        strcpy(last.error.text, "not enough memory for the surface");
        last.error.value = 0;
        fail(&last.error);
        return NULL;
    }
    s->xyz = xyz;
    s->corner = corner;
    s->triangulation = (hd_triangulation)triangulation;
    s->ctx.progress = tick;
    s->ctx.byte_limit = (uint64_t)byte_limit;
    s->mesh.shape = corner ? HD_TRIANGLES : HD_POINTS;
    s->mesh.n = n;
    s->mesh.stride = stride;
    s->mesh.n_faces = n_faces;
    if (float_bits == 32) s->mesh.xyz_float = (const float *)xyz;
    else s->mesh.xyz = (const double *)xyz;
    if (corner_bits == 16) s->mesh.corner_u16 = (const uint16_t *)corner;
    else s->mesh.corner = (const int32_t *)corner;
    memset(&o, 0, sizeof o);
    o.context = &s->ctx;
    o.kind = (hd_laplacian_kind)kind;
    o.triangulation = s->triangulation;
    o.border = (hd_border)border;
    o.n_held = n_held;
    o.held = held;
    if (hd_laplacian_create(&s->lap, &s->mesh, &o, &last.error) < 0) {
        fail(&last.error);
        module_dispose(s);
        return NULL;
    }
    describe(s);
    return s;
}

/* The coordinates: out [3 n], x of all vertices, then y, then z. */
void MODULE_EXPORT(module_coordinates)(const module_surface *s, double *out) {
    const size_t n = (size_t)s->mesh.n;
    size_t i, c;
    for (i = 0; i < n; i++) for (c = 0; c < 3; c++) {
        const char *at = (const char *)s->xyz + i * s->mesh.stride;
        float single;
        if (s->mesh.xyz_float) {
            memcpy(&single, at + c * sizeof single, sizeof single);
            out[c * n + i] = (double)single;
        } else memcpy(out + c * n + i, at + c * sizeof *out, sizeof *out);
    }
}

/* The component of each vertex: out [n]; -1 for vertices without mass and held ones. */
void MODULE_EXPORT(module_components)(const module_surface *s, int32_t *out) {
    int32_t i;
    for (i = 0; i < s->lap->n; i++) out[i] = s->lap->row[i] < 0 ? -1 : s->lap->component[s->lap->row[i]];
}

hd_status MODULE_EXPORT(module_times)(const module_surface *s, int32_t n_times, double *t) {
    return hd_times_auto(s->lap, n_times, t, &last.error) < 0 ? fail(&last.error) : HD_OK;
}

/* ---- queries ---- */

static hd_heat *plan(module_surface *s, int32_t method) {
    hd_heat_opts o;
    memset(&o, 0, sizeof o);
    o.method = (hd_method)method;
    if (!s->plan[method] && hd_heat_create(&s->plan[method], s->lap, &o, &last.error) < 0) fail(&last.error);
    return s->plan[method];
}

static hd_status end(const hd_report *r) {
    const double facts[] = {
        r->error_bound, r->error_rational, r->error_solver, r->error_rounding, r->error_local, r->evidence_rational,
        r->evidence_solver, r->evidence_rounding, r->evidence_local, r->error_relative, (double)r->n_lost, r->smallest,
        r->mass_drift, r->residual, r->method, r->degree, (double)r->iterations, (double)r->factor_nnz, r->factor_flops,
        r->n_touched};
    if (r->status < 0) return fail(&r->error);
    memcpy(last.facts, facts, sizeof facts);
    last.text = r->reason;
    return r->status;
}

/* Columns of K_t or k_t: out [n n_times n_sources]. */
hd_status MODULE_EXPORT(module_columns)(module_surface *s, int32_t method, int32_t kernel, int32_t n_times, const double *t,
                                        int32_t n_sources, const int32_t *source, double *out) {
    const hd_sources from = hd_vertices(n_sources, source);
    hd_heat *heat = plan(s, method);
    hd_report r;
    if (!heat) return last.error.status;
    hd_heat_columns(heat, (hd_kernel)kernel, n_times, t, &from, out, 0, &r, NULL);
    return end(&r);
}

/* K_t F: F [n k], out [n n_times k]. */
hd_status MODULE_EXPORT(module_apply)(module_surface *s, int32_t method, int32_t n_times, const double *t, int32_t k,
                                      const double *F, double *out) {
    hd_heat *heat = plan(s, method);
    hd_report r;
    if (!heat) return last.error.status;
    hd_heat_apply(heat, n_times, t, k, F, 0, out, 0, &r, NULL);
    return end(&r);
}

/* k_t(x,x): out [n n_times], trace [n_times]. */
hd_status MODULE_EXPORT(module_signature)(module_surface *s, int32_t kernel, int32_t n_times, const double *t, double *out,
                                          double *trace) {
    hd_heat *heat = plan(s, HD_METHOD_DIRECT);
    hd_report r;
    if (!heat) return last.error.status;
    hd_heat_diagonal(heat, (hd_kernel)kernel, n_times, t, out, 0, trace, NULL, &r, NULL);
    return end(&r);
}

/* Diffusion distances: out [n max(1, n_times) n_sources]. */
hd_status MODULE_EXPORT(module_distance)(module_surface *s, int32_t kind, int32_t n_times, const double *t,
                                         int32_t n_sources, const int32_t *source, double *out) {
    const hd_sources from = hd_vertices(n_sources, source);
    hd_heat *heat = plan(s, HD_METHOD_DIRECT);
    hd_report r;
    if (!heat) return last.error.status;
    hd_heat_distance(heat, (hd_distance_kind)kind, n_times, t, &from, out, 0, &r, NULL);
    return end(&r);
}

/* Farthest points after those given: vertex, distance [count]. */
hd_status MODULE_EXPORT(module_sample)(module_surface *s, int32_t kind, double t, int32_t n_given, const int32_t *given,
                                       int32_t count, int32_t *vertex, double *distance) {
    const hd_sources from = hd_vertices(n_given, given);
    hd_heat *heat = plan(s, HD_METHOD_DIRECT);
    hd_report r;
    if (!heat) return last.error.status;
    hd_heat_sample(heat, (hd_distance_kind)kind, t, n_given ? &from : NULL, count, vertex, distance, &r, NULL);
    return end(&r);
}

/* Distances along the surface: out [n n_sources], or [n] to the nearest source. */
hd_status MODULE_EXPORT(module_geodesic)(module_surface *s, int32_t nearest, int32_t n_sources, const int32_t *source,
                                         double *out) {
    const int64_t first[2] = {0, n_sources};
    hd_sources from = hd_vertices(n_sources, source);
    hd_geodesic_report r;
    hd_geodesic_opts o;
    memset(&o, 0, sizeof o);
    o.context = &s->ctx;
    o.triangulation = s->mesh.shape == HD_POINTS ? HD_TRIANGULATION_TUFTED : s->triangulation;
    if (nearest) {
        from.count = 1;
        from.first = first;
    }
    if (!s->geodesic && hd_geodesic_create(&s->geodesic, &s->mesh, &o, &last.error) < 0) return fail(&last.error);
    if (hd_geodesic_distance(s->geodesic, &from, out, 0, &r, &last.error) < 0) return fail(&last.error);
    last.facts[0] = r.t;
    last.facts[1] = r.h;
    last.facts[2] = r.residual_heat;
    last.facts[3] = r.residual_distance;
    last.facts[4] = r.n_stages;
    last.facts[5] = (double)r.factor_nnz;
    return r.status;
}

/* What a query would take: facts of the method that would be chosen. */
hd_status MODULE_EXPORT(module_estimate)(module_surface *s, int32_t query, int32_t method, int32_t n_times, const double *t,
                                         int32_t k) {
    hd_heat *heat = plan(s, method);
    hd_estimate e;
    const hd_cost *c = &e.cost[HD_METHOD_AUTO];
    if (!heat) return last.error.status;
    if (hd_heat_estimate(heat, (hd_query)query, n_times, t, k, &e, &last.error) < 0) return fail(&last.error);
    last.facts[0] = e.method;
    last.facts[1] = c->fits;
    last.facts[2] = c->seconds;
    last.facts[3] = c->bytes;
    last.facts[4] = c->bytes_most;
    last.facts[5] = c->flops;
    last.facts[6] = e.analysed;
    last.text = e.reason;
    return HD_OK;
}
