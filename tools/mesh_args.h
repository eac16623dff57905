/* mesh_args.h - meshes of heatdiff.h as arguments, in C: hd_laplacian_create(&lap, MESH_TRIANGLES(xyz, n, tri, m), NULL, NULL).
 * Positions alone, for updates: MESH_POINTS. */

#ifndef MESH_ARGS_H
#define MESH_ARGS_H

#define MESH_TRIANGLES(xyz, n, tri, n_tri) ((const hd_mesh[]){hd_triangles(xyz, n, tri, n_tri)})
#define MESH_LENGTHS(len, nv, tri, m) ((const hd_mesh[]){{.n = nv, .lengths = len, .corner = tri, .n_faces = m}})
#define MESH_POLYGONS(p, nv, ptr, idx, m) \
    ((const hd_mesh[]){{.shape = HD_POLYGONS, .n = nv, .xyz = p, .face_ptr = ptr, .corner = idx, .n_faces = m}})
#define MESH_POINTS(p, nv) ((const hd_mesh[]){{.shape = HD_POINTS, .n = nv, .xyz = p}})
#define MESH_STARS(p, nv, ptr, ids) ((const hd_mesh[]){{.shape = HD_POINTS, .n = nv, .xyz = p, .nbr_ptr = ptr, .nbr = ids}})

#endif
