/* mesh_args.h - meshes and sources of heatdiff.h as arguments: hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, n, tri, m), NULL, NULL).
 * They last until the end of the full expression. Positions alone, for updates: MESH_POINTS. Vertices, a source each: VERTICES; one
 * source of several: TOGETHER. In C and C++. */

#ifndef MESH_ARGS_H
#define MESH_ARGS_H

#include <string.h>

static inline hd_mesh mesh_of(hd_shape shape, const double *xyz, int32_t n) {
    hd_mesh m;
    memset(&m, 0, sizeof m);
    m.shape = shape;
    m.xyz = xyz;
    m.n = n;
    return m;
}

static inline hd_mesh mesh_of_lengths(const double *lengths, int32_t n, const int32_t *tri, int32_t n_tri) {
    hd_mesh m = mesh_of(HD_TRIANGLES, NULL, n);
    m.lengths = lengths;
    m.corner = tri;
    m.n_faces = n_tri;
    return m;
}

static inline hd_mesh mesh_of_polygons(const double *xyz, int32_t n, const int64_t *ptr, const int32_t *corner, int32_t n_faces) {
    hd_mesh m = mesh_of(HD_POLYGONS, xyz, n);
    m.face_ptr = ptr;
    m.corner = corner;
    m.n_faces = n_faces;
    return m;
}

static inline hd_mesh mesh_of_stars(const double *xyz, int32_t n, const int64_t *ptr, const int32_t *nbr) {
    hd_mesh m = mesh_of(HD_POINTS, xyz, n);
    m.nbr_ptr = ptr;
    m.nbr = nbr;
    return m;
}

#ifdef __cplusplus
struct mesh_here {
    hd_mesh mesh;
    operator const hd_mesh *() const { return &mesh; }
};
#define MESH_HERE(m) (mesh_here{m})

struct sources_here {
    hd_sources sources;
    int64_t first[2];
    sources_here(int32_t count, const int32_t *ids) : sources(hd_vertices(count, ids)) {}
    sources_here(int32_t n, const int32_t *ids, int64_t begin) : sources(hd_vertices(1, ids)) {
        first[0] = begin;
        first[1] = n;
        sources.first = first;
    }
    operator const hd_sources *() const { return &sources; }
};
#define VERTICES(count, ids) (sources_here(count, ids))
#define TOGETHER(n, ids) (sources_here(n, ids, 0))
#else
#define MESH_HERE(m) ((const hd_mesh[]){m})

static inline hd_sources sources_together(const int32_t *ids, const int64_t *first) {
    hd_sources s = hd_vertices(1, ids);
    s.first = first;
    return s;
}
#define VERTICES(count, ids) ((const hd_sources[]){hd_vertices(count, ids)})
#define TOGETHER(n, ids) ((const hd_sources[]){sources_together(ids, (const int64_t[]){0, n})})
#endif

#define MESH_TRIANGLES(xyz, n, tri, n_tri) MESH_HERE(hd_triangles(xyz, n, tri, n_tri))
#define MESH_LENGTHS(lengths, n, tri, n_tri) MESH_HERE(mesh_of_lengths(lengths, n, tri, n_tri))
#define MESH_POLYGONS(xyz, n, ptr, corner, n_faces) MESH_HERE(mesh_of_polygons(xyz, n, ptr, corner, n_faces))
#define MESH_POINTS(xyz, n) MESH_HERE(mesh_of(HD_POINTS, xyz, n))
#define MESH_STARS(xyz, n, ptr, nbr) MESH_HERE(mesh_of_stars(xyz, n, ptr, nbr))

#endif
