"""The ctypes face of heatdiff.h: made by bind.py, changed by nobody."""
from ctypes import (CFUNCTYPE, POINTER, Structure, c_char, c_char_p, c_double, c_float, c_int, c_int32, c_int64, c_size_t,
                    c_uint16, c_uint64, c_void_p)

VERSION = '2.0.0'
STATUS = {
    0: ('HD_OK', 'done'),
    1: ('HD_WARN_ACCURACY', 'done, but the bound on the error is above the tolerance, or says little'),
    -1: ('HD_ERR_ARGUMENT', 'an argument or option is out of its range'),
    -2: ('HD_ERR_MEMORY', 'out of memory'),
    -3: ('HD_ERR_MEMORY_LIMIT', 'the byte or allocation limit of the context is reached'),
    -4: ('HD_ERR_TOO_LARGE', 'a size does not fit its integer type'),
    -5: ('HD_ERR_CANCELLED', 'cancelled by the progress callback'),
    -6: ('HD_ERR_NOT_CONVERGED', 'the iteration did not reach the tolerance'),
    -7: ('HD_ERR_INDEX', 'an index is out of range'),
    -8: ('HD_ERR_NOT_FINITE', 'a value is not finite'),
    -9: ('HD_ERR_NOT_SYMMETRIC', 'a matrix is not symmetric'),
    -10: ('HD_ERR_NOT_POSITIVE', 'L is not positive semi-definite, or B is not positive definite'),
    -11: ('HD_ERR_STRUCTURE', 'a sparse matrix is not well formed'),
    -12: ('HD_ERR_EMPTY', 'nothing is left to compute on: no vertex has mass'),
    -13: ('HD_ERR_BREAKDOWN', 'the iteration broke down'),
    -14: ('HD_ERR_NOT_BUILT', 'this build of the library leaves it out'),
}

CHOICES = {
    'hd_progress': {'continue': 256, 'cancel': 512},
    'hd_simd': {'auto': 0, 'none': 1, 'avx2': 2, 'avx512': 3},
    'hd_laplacian_kind': {'default': 0, 'fem': 1, 'voronoi-cot': 2, 'cot': 3, 'polygon': 4, 'voronoi-exp': 5, 'exp': 6, 'matrices': 7},
    'hd_border': {'natural': 0, 'dirichlet': 1},
    'hd_triangulation': {'given': 0, 'delaunay': 1, 'tufted': 2},
    'hd_shape': {'triangles': 0, 'polygons': 1, 'points': 2},
    'hd_pole_kind': {'default': 0, 'uniform': 1, 'kernel': 2, 'own': 3},
    'hd_filter_kind': {'own': 0, 'heat': 1, 'wave': 2, 'mexican-hat': 3, 'resolvent': 4, 'fractional': 5, 'band': 6, 'biharmonic': 7},
    'hd_method': {'auto': 0, 'iterative': 1, 'direct': 2, 'krylov': 3, 'local': 4},
    'hd_ordering': {'auto': 0, 'minimum-degree': 1, 'nested-dissection': 2, 'own': 3},
    'hd_solver': {'auto': 0, 'cocg': 1, 'minres': 3, 'lanczos': 4},
    'hd_precond': {'auto': 0, 'none': 1, 'jacobi': 2, 'ssor': 3, 'ildl': 4, 'mildl': 5},
    'hd_kernel': {'operator': 0, 'symmetric': 1},
    'hd_distance_kind': {'classical': 0, 'weighted': 1, 'commute': 2, 'biharmonic': 3},
    'hd_evidence': {'none': 0, 'proven': 1, 'measured': 2, 'estimated': 3},
    'hd_query': {'fields': 0, 'columns': 1, 'pairs': 2, 'diagonal': 3, 'diagonal-operator': 4, 'trace': 5, 'distance': 6, 'distance-weighted': 7, 'distance-commute': 8, 'distance-biharmonic': 9, 'spectrum': 10},
    'hd_geodesic_mass': {'barycentric': 0, 'voronoi': 1},
    'hd_geodesic_border': {'natural': 0, 'mean': 1, 'dirichlet': 2},
}

hd_task = CFUNCTYPE(None, c_void_p, c_int64, c_int32)
hd_threads = type('hd_threads', (Structure,), {})
hd_moving = type('hd_moving', (Structure,), {})
hd_holding = type('hd_holding', (Structure,), {})
hd_ldl = type('hd_ldl', (Structure,), {})
hd_heat = type('hd_heat', (Structure,), {})
hd_geodesic = type('hd_geodesic', (Structure,), {})


class hd_c64(Structure):
    choices: dict = {}


class hd_error(Structure):
    choices = {'status': 'hd_status'}


class hd_allocator(Structure):
    choices: dict = {}


class hd_context(Structure):
    choices = {'simd': 'hd_simd'}


class hd_csr(Structure):
    choices: dict = {}


class hd_laplacian_opts(Structure):
    choices = {'kind': 'hd_laplacian_kind', 'triangulation': 'hd_triangulation', 'border': 'hd_border'}


class hd_mesh(Structure):
    choices = {'shape': 'hd_shape'}


class hd_mesh_report(Structure):
    choices: dict = {}


class hd_point_report(Structure):
    choices: dict = {}


class hd_laplacian(Structure):
    choices = {'kind': 'hd_laplacian_kind'}


class hd_rational(Structure):
    choices = {'kind': 'hd_pole_kind'}


class hd_filter(Structure):
    choices = {'kind': 'hd_filter_kind'}


class hd_heat_opts(Structure):
    choices = {'method': 'hd_method', 'solver': 'hd_solver', 'precond': 'hd_precond', 'poles': 'hd_pole_kind', 'ordering': 'hd_ordering'}


class hd_sources(Structure):
    choices: dict = {}


class hd_report(Structure):
    choices = {'status': 'hd_status', 'method': 'hd_method', 'solver': 'hd_solver', 'precond': 'hd_precond', 'poles': 'hd_pole_kind', 'ordering': 'hd_ordering', 'evidence_rational': 'hd_evidence', 'evidence_solver': 'hd_evidence', 'evidence_rounding': 'hd_evidence', 'evidence_local': 'hd_evidence', 'evidence_b': 'hd_evidence'}


class hd_spectrum_opts(Structure):
    choices = {'ordering': 'hd_ordering'}


class hd_spectrum(Structure):
    choices = {'ordering': 'hd_ordering'}


class hd_cost(Structure):
    choices: dict = {}


class hd_estimate(Structure):
    choices = {'method': 'hd_method'}


class hd_geodesic_opts(Structure):
    choices = {'mass': 'hd_geodesic_mass', 'ordering': 'hd_ordering', 'border': 'hd_geodesic_border', 'triangulation': 'hd_triangulation'}


class hd_geodesic_report(Structure):
    choices = {'status': 'hd_status', 'ordering': 'hd_ordering'}


class hd_solve_opts(Structure):
    choices = {'solver': 'hd_solver', 'precond': 'hd_precond'}


class hd_solve_report(Structure):
    choices: dict = {}


class hd_ldl_opts(Structure):
    choices = {'ordering': 'hd_ordering'}


class hd_ldl_report(Structure):
    choices = {'ordering': 'hd_ordering'}


hd_c64._fields_ = [
    ('re', c_double),
    ('im', c_double),
]

hd_error._fields_ = [
    ('status', c_int),
    ('text', c_char * 160),
    ('face', c_int64),
    ('vertex', c_int64),
    ('row', c_int64),
    ('column', c_int64),
    ('pole', c_int64),
    ('value', c_double),
]

hd_allocator._fields_ = [
    ('alloc', CFUNCTYPE(c_void_p, c_void_p, c_size_t)),
    ('free', CFUNCTYPE(None, c_void_p, c_void_p, c_size_t)),
    ('user', c_void_p),
]

hd_context._fields_ = [
    ('allocator', hd_allocator),
    ('byte_limit', c_uint64),
    ('allocation_limit', c_uint64),
    ('progress', CFUNCTYPE(c_int, c_void_p, c_char_p, c_double)),
    ('progress_user', c_void_p),
    ('parallel_for', CFUNCTYPE(None, c_void_p, c_int64, hd_task, c_void_p)),
    ('parallel_user', c_void_p),
    ('n_threads', c_int32),
    ('simd', c_int),
    ('bytes_in_use', c_uint64),
    ('bytes_peak', c_uint64),
    ('allocations', c_uint64),
    ('regions', c_uint64),
    ('helped', c_uint64),
    ('waits', c_uint64),
    ('threads', POINTER(hd_threads)),
    ('n_holders', c_int32),
]

hd_csr._fields_ = [
    ('n_rows', c_int32),
    ('n_cols', c_int32),
    ('nnz', c_int64),
    ('row_ptr', POINTER(c_int64)),
    ('col', POINTER(c_int32)),
    ('val', POINTER(c_double)),
]

hd_laplacian_opts._fields_ = [
    ('begin_zero', c_int32),
    ('kind', c_int),
    ('context', POINTER(hd_context)),
    ('triangulation', c_int),
    ('stiffening', c_double),
    ('bandwidth2', c_double),
    ('weight_cut', c_double),
    ('mollify', c_double),
    ('neighbours', c_int32),
    ('updatable', c_int32),
    ('border', c_int),
    ('n_held', c_int32),
    ('held', POINTER(c_int32)),
    ('end_zero', c_int32),
]

hd_mesh._fields_ = [
    ('begin_zero', c_int32),
    ('shape', c_int),
    ('n', c_int32),
    ('xyz', POINTER(c_double)),
    ('xyz_float', POINTER(c_float)),
    ('stride', c_size_t),
    ('lengths', POINTER(c_double)),
    ('n_faces', c_int32),
    ('face_ptr', POINTER(c_int64)),
    ('corner', POINTER(c_int32)),
    ('corner_u16', POINTER(c_uint16)),
    ('nbr_ptr', POINTER(c_int64)),
    ('nbr', POINTER(c_int32)),
    ('end_zero', c_int32),
]

hd_mesh_report._fields_ = [
    ('n_faces', c_int32),
    ('n_faces_used', c_int32),
    ('n_repeated_corner', c_int32),
    ('n_zero_area', c_int32),
    ('n_repeated_face', c_int32),
    ('n_edges', c_int64),
    ('n_boundary_edges', c_int64),
    ('n_nonmanifold_edges', c_int64),
    ('n_misoriented_edges', c_int64),
    ('n_boundary_loops', c_int32),
    ('n_inert', c_int32),
    ('n_negative_weights', c_int64),
    ('smallest_angle', c_double),
    ('n_sheets', c_int32),
    ('n_mollified', c_int32),
    ('mollify_epsilon', c_double),
    ('n_flips', c_int64),
    ('n_not_delaunay', c_int64),
    ('n_self_edges', c_int64),
    ('smallest_intrinsic_angle', c_double),
]

hd_point_report._fields_ = [
    ('bandwidth2', c_double),
    ('weight_cut', c_double),
    ('cut_radius', c_double),
    ('neighbours', c_int32),
    ('n_coincident', c_int32),
    ('n_isolated', c_int32),
    ('n_no_area', c_int32),
    ('n_border', c_int32),
    ('most_in_row', c_int32),
    ('n_not_flat', c_int32),
]

hd_laplacian._fields_ = [
    ('n', c_int32),
    ('n_active', c_int32),
    ('n_held', c_int32),
    ('n_components', c_int32),
    ('kind', c_int),
    ('lambda_max', c_double),
    ('h', c_double),
    ('area', c_double),
    ('L', hd_csr),
    ('B', POINTER(c_double)),
    ('mass', POINTER(c_double)),
    ('b_diag', POINTER(c_double)),
    ('vertex', POINTER(c_int32)),
    ('row', POINTER(c_int32)),
    ('component', POINTER(c_int32)),
    ('xyz', POINTER(c_double)),
    ('component_mass', POINTER(c_double)),
    ('b_ratio', c_double),
    ('conserves', c_int32),
    ('mesh', hd_mesh_report),
    ('points', hd_point_report),
    ('context', POINTER(hd_context)),
    ('version', c_int64),
    ('moving', POINTER(hd_moving)),
    ('holding', POINTER(hd_holding)),
]

hd_rational._fields_ = [
    ('kind', c_int),
    ('degree', c_int32),
    ('n_poles', c_int32),
    ('a0', c_double),
    ('theta', hd_c64 * 32),
    ('a', hd_c64 * 32),
    ('max_error', c_double),
    ('max_weighted_error', c_double),
    ('t', c_double),
    ('lambda_max', c_double),
    ('largest', c_double),
]

hd_filter._fields_ = [
    ('begin_zero', c_int32),
    ('kind', c_int),
    ('a', c_double),
    ('b', c_double),
    ('f', CFUNCTYPE(c_double, c_double, c_void_p)),
    ('user', c_void_p),
    ('tol', c_double),
    ('weight', c_double),
    ('max_degree', c_int32),
    ('lambda_min', c_double),
    ('constant', c_int32),
    ('end_zero', c_int32),
]

hd_heat_opts._fields_ = [
    ('begin_zero', c_int32),
    ('method', c_int),
    ('solver', c_int),
    ('precond', c_int),
    ('poles', c_int),
    ('degree', c_int32),
    ('rational', POINTER(hd_rational)),
    ('tol', c_double),
    ('max_iterations', c_int32),
    ('cut', c_double),
    ('ordering', c_int),
    ('perm', POINTER(c_int32)),
    ('context', POINTER(hd_context)),
    ('end_zero', c_int32),
]

hd_sources._fields_ = [
    ('begin_zero', c_int32),
    ('count', c_int32),
    ('first', POINTER(c_int64)),
    ('corners', c_int32),
    ('curve', c_int32),
    ('vertex', POINTER(c_int32)),
    ('bary', POINTER(c_double)),
    ('weight', POINTER(c_double)),
    ('length', POINTER(c_double)),
    ('end_zero', c_int32),
]

hd_report._fields_ = [
    ('status', c_int),
    ('error', hd_error),
    ('method', c_int),
    ('reason', c_char_p),
    ('solver', c_int),
    ('precond', c_int),
    ('poles', c_int),
    ('degree', c_int32),
    ('n_poles', c_int32),
    ('iterations', c_int64),
    ('pole_iterations', c_int64 * 32),
    ('ordering', c_int),
    ('factor_nnz', c_int64),
    ('factor_flops', c_double),
    ('growth', c_double),
    ('residual', c_double),
    ('error_bound', c_double),
    ('error_rational', c_double),
    ('error_solver', c_double),
    ('error_rounding', c_double),
    ('error_local', c_double),
    ('evidence_rational', c_int),
    ('evidence_solver', c_int),
    ('evidence_rounding', c_int),
    ('evidence_local', c_int),
    ('error_bound_b', c_double),
    ('evidence_b', c_int),
    ('error_relative', c_double),
    ('smallest', c_double),
    ('n_lost', c_int64),
    ('n_touched', c_int32),
    ('n_patches', c_int32),
    ('mass_drift', c_double),
]

hd_spectrum_opts._fields_ = [
    ('begin_zero', c_int32),
    ('count', c_int32),
    ('below', c_double),
    ('tol', c_double),
    ('ordering', c_int),
    ('perm', POINTER(c_int32)),
    ('context', POINTER(hd_context)),
    ('end_zero', c_int32),
]

hd_spectrum._fields_ = [
    ('n', c_int32),
    ('count', c_int32),
    ('value', POINTER(c_double)),
    ('vector', POINTER(c_double)),
    ('residual', POINTER(c_double)),
    ('largest_residual', c_double),
    ('n_poor', c_int32),
    ('n_constant', c_int32),
    ('proven', c_int32),
    ('shift', c_double),
    ('shift_margin', c_double),
    ('next', c_double),
    ('left', POINTER(c_double)),
    ('left_mass', POINTER(c_double)),
    ('n_factors', c_int32),
    ('n_runs', c_int32),
    ('n_solves', c_int64),
    ('ordering', c_int),
    ('factor_nnz', c_int64),
    ('factor_flops', c_double),
    ('lap', POINTER(hd_laplacian)),
    ('context', POINTER(hd_context)),
]

hd_cost._fields_ = [
    ('possible', c_int32),
    ('fits', c_int32),
    ('flops', c_double),
    ('seconds', c_double),
    ('bytes', c_double),
    ('bytes_most', c_double),
]

hd_estimate._fields_ = [
    ('method', c_int),
    ('reason', c_char_p),
    ('analysed', c_int32),
    ('cost', hd_cost * 5),
    ('bytes_in_use', c_double),
    ('bytes_left', c_double),
]

hd_geodesic_opts._fields_ = [
    ('begin_zero', c_int32),
    ('t', c_double),
    ('mass', c_int),
    ('ordering', c_int),
    ('perm', POINTER(c_int32)),
    ('context', POINTER(hd_context)),
    ('updatable', c_int32),
    ('border', c_int),
    ('triangulation', c_int),
    ('mollify', c_double),
    ('stiffening', c_double),
    ('neighbours', c_int32),
    ('t_in_h2', c_double),
    ('end_zero', c_int32),
]

hd_geodesic_report._fields_ = [
    ('status', c_int),
    ('error', hd_error),
    ('t', c_double),
    ('h', c_double),
    ('n_components', c_int32),
    ('n_stages', c_int32),
    ('ordering', c_int),
    ('factor_nnz', c_int64),
    ('factor_flops', c_double),
    ('residual_heat', c_double),
    ('residual_distance', c_double),
]

hd_solve_opts._fields_ = [
    ('begin_zero', c_int32),
    ('solver', c_int),
    ('precond', c_int),
    ('tol', c_double),
    ('max_iterations', c_int32),
    ('context', POINTER(hd_context)),
    ('end_zero', c_int32),
]

hd_solve_report._fields_ = [
    ('iterations', c_int64),
    ('residual', c_double),
    ('error_b', c_double),
]

hd_ldl_opts._fields_ = [
    ('begin_zero', c_int32),
    ('ordering', c_int),
    ('perm', POINTER(c_int32)),
    ('xyz', POINTER(c_double)),
    ('context', POINTER(hd_context)),
    ('end_zero', c_int32),
]

hd_ldl_report._fields_ = [
    ('ordering', c_int),
    ('n_supernodes', c_int32),
    ('n_matrices', c_int32),
    ('factor_nnz', c_int64),
    ('stored', c_int64),
    ('factor_flops', c_double),
    ('growth', c_double),
    ('smallest_pivot', c_double),
    ('n_negative', c_int32),
]

# name: result, arguments
FUNCTIONS = {
    'hd_context_threads': (c_int32, POINTER(hd_context)),
    'hd_status_name': (c_char_p, c_int),
    'hd_status_text': (c_char_p, c_int),
    'hd_csr_from_triplets': (c_int, POINTER(hd_csr), c_int32, c_int32, c_int64, POINTER(c_int32), POINTER(c_int32),
        POINTER(c_double), POINTER(hd_context), POINTER(hd_error)),
    'hd_csr_free': (None, POINTER(hd_csr), POINTER(hd_context)),
    'hd_triangles': (hd_mesh, POINTER(c_double), c_int32, POINTER(c_int32), c_int32),
    'hd_vertices': (hd_sources, c_int32, POINTER(c_int32)),
    'hd_laplacian_create': (c_int, POINTER(POINTER(hd_laplacian)), POINTER(hd_mesh), POINTER(hd_laplacian_opts),
        POINTER(hd_error)),
    'hd_laplacian_matrices': (c_int, POINTER(POINTER(hd_laplacian)), POINTER(hd_csr), POINTER(hd_csr), c_double,
        POINTER(hd_laplacian_opts), POINTER(hd_error)),
    'hd_laplacian_apply': (c_int, POINTER(hd_laplacian), c_double, c_double, POINTER(c_double), POINTER(c_double),
        POINTER(hd_error)),
    'hd_laplacian_update': (c_int, POINTER(hd_laplacian), POINTER(hd_mesh), POINTER(hd_error)),
    'hd_laplacian_update_matrices': (c_int, POINTER(hd_laplacian), POINTER(hd_csr), POINTER(hd_csr), c_double,
        POINTER(hd_error)),
    'hd_laplacian_free': (None, POINTER(hd_laplacian)),
    'hd_neighbours_nearest': (c_int, POINTER(c_double), c_int32, POINTER(c_double), c_int32, c_int32,
        POINTER(c_int32), POINTER(c_double), POINTER(hd_context), POINTER(hd_error)),
    'hd_rational_exp': (c_int, POINTER(hd_rational), c_int, c_int32, POINTER(hd_error)),
    'hd_rational_shared': (c_int, POINTER(hd_rational), c_int32, POINTER(c_double), c_double, POINTER(hd_context),
        POINTER(hd_error)),
    'hd_rational_eval': (c_double, POINTER(hd_rational), c_double),
    'hd_rational_fit': (c_int, POINTER(hd_rational), c_int32, POINTER(hd_filter), c_double, POINTER(hd_context),
        POINTER(hd_error)),
    'hd_filter_eval': (c_double, POINTER(hd_filter), c_double),
    'hd_shifted_solve': (c_int, POINTER(hd_laplacian), c_double, hd_c64, POINTER(hd_c64), POINTER(hd_c64),
        POINTER(hd_solve_opts), POINTER(hd_solve_report), POINTER(hd_error)),
    'hd_ldl_analyse': (c_int, POINTER(POINTER(hd_ldl)), POINTER(hd_csr), POINTER(hd_ldl_opts), POINTER(hd_ldl_report),
        POINTER(hd_error)),
    'hd_ldl_factor': (c_int, POINTER(hd_ldl), POINTER(c_double), POINTER(hd_ldl_report), POINTER(hd_error)),
    'hd_ldl_factor_complex': (c_int, POINTER(hd_ldl), c_int32, POINTER(hd_c64), POINTER(hd_ldl_report),
        POINTER(hd_error)),
    'hd_ldl_solve': (c_int, POINTER(hd_ldl), c_int32, POINTER(c_double), c_size_t, POINTER(c_double), c_size_t,
        POINTER(hd_error)),
    'hd_ldl_solve_complex': (c_int, POINTER(hd_ldl), POINTER(hd_c64), c_size_t, POINTER(hd_c64), c_size_t,
        POINTER(hd_error)),
    'hd_ldl_inverse': (c_int, POINTER(hd_ldl), POINTER(c_double), POINTER(c_double), POINTER(hd_error)),
    'hd_ldl_inverse_complex': (c_int, POINTER(hd_ldl), POINTER(hd_c64), POINTER(hd_c64), POINTER(hd_error)),
    'hd_ldl_free': (None, POINTER(hd_ldl)),
    'hd_heat_create': (c_int, POINTER(POINTER(hd_heat)), POINTER(hd_laplacian), POINTER(hd_heat_opts),
        POINTER(hd_error)),
    'hd_heat_free': (None, POINTER(hd_heat)),
    'hd_heat_set_rational': (c_int, POINTER(hd_heat), c_int32, POINTER(hd_rational), POINTER(hd_error)),
    'hd_heat_apply': (c_int, POINTER(hd_heat), c_int32, POINTER(c_double), c_int32, POINTER(c_double), c_size_t,
        POINTER(c_double), c_size_t, POINTER(hd_report), POINTER(hd_error)),
    'hd_heat_derivative': (c_int, POINTER(hd_heat), c_int32, POINTER(c_double), c_int32, POINTER(c_double), c_size_t,
        POINTER(c_double), c_size_t, POINTER(hd_report), POINTER(hd_error)),
    'hd_heat_adjoint': (c_int, POINTER(hd_heat), c_int32, POINTER(c_double), c_int32, POINTER(c_double), c_size_t,
        POINTER(c_double), c_size_t, POINTER(hd_report), POINTER(hd_error)),
    'hd_heat_columns': (c_int, POINTER(hd_heat), c_int, c_int32, POINTER(c_double), POINTER(hd_sources),
        POINTER(c_double), c_size_t, POINTER(hd_report), POINTER(hd_error)),
    'hd_heat_columns_sparse': (c_int, POINTER(hd_heat), c_int, c_int32, POINTER(c_double), POINTER(hd_sources),
        POINTER(hd_csr), POINTER(hd_report), POINTER(hd_error)),
    'hd_heat_column': (c_int, POINTER(hd_heat), c_int, c_double, c_int32, POINTER(c_double), POINTER(hd_report),
        POINTER(hd_error)),
    'hd_heat_diagonal': (c_int, POINTER(hd_heat), c_int, c_int32, POINTER(c_double), POINTER(c_double), c_size_t,
        POINTER(c_double), POINTER(c_double), POINTER(hd_report), POINTER(hd_error)),
    'hd_times_auto': (c_int, POINTER(hd_laplacian), c_int32, POINTER(c_double), POINTER(hd_error)),
    'hd_heat_distance': (c_int, POINTER(hd_heat), c_int, c_int32, POINTER(c_double), POINTER(hd_sources),
        POINTER(c_double), c_size_t, POINTER(hd_report), POINTER(hd_error)),
    'hd_heat_distance_pairs': (c_int, POINTER(hd_heat), c_int, c_int32, POINTER(c_double), c_int64, POINTER(c_int32),
        POINTER(c_int32), POINTER(c_double), POINTER(hd_report), POINTER(hd_error)),
    'hd_heat_sample': (c_int, POINTER(hd_heat), c_int, c_double, POINTER(hd_sources), c_int32, POINTER(c_int32),
        POINTER(c_double), POINTER(hd_report), POINTER(hd_error)),
    'hd_heat_entries': (c_int, POINTER(hd_heat), c_int, c_int32, POINTER(c_double), c_int64, POINTER(c_int32),
        POINTER(c_int32), POINTER(c_double), POINTER(hd_report), POINTER(hd_error)),
    'hd_spectrum_create': (c_int, POINTER(POINTER(hd_spectrum)), POINTER(hd_laplacian), POINTER(hd_spectrum_opts),
        POINTER(hd_error)),
    'hd_spectrum_free': (None, POINTER(hd_spectrum)),
    'hd_spectrum_columns': (c_int, POINTER(hd_spectrum), c_int, c_int32, POINTER(c_double), POINTER(hd_sources),
        POINTER(c_double), POINTER(c_double), c_size_t, POINTER(hd_error)),
    'hd_spectrum_diagonal': (c_int, POINTER(hd_spectrum), c_int, c_int32, POINTER(c_double), POINTER(c_double),
        POINTER(c_double), c_size_t, POINTER(hd_error)),
    'hd_spectrum_distance': (c_int, POINTER(hd_spectrum), c_int, c_int32, POINTER(c_double), POINTER(hd_sources),
        POINTER(c_double), POINTER(c_double), c_size_t, POINTER(hd_error)),
    'hd_heat_estimate': (c_int, POINTER(hd_heat), c_int, c_int32, POINTER(c_double), c_int32, POINTER(hd_estimate),
        POINTER(hd_error)),
    'hd_geodesic_create': (c_int, POINTER(POINTER(hd_geodesic)), POINTER(hd_mesh), POINTER(hd_geodesic_opts),
        POINTER(hd_error)),
    'hd_geodesic_update': (c_int, POINTER(hd_geodesic), POINTER(hd_mesh), POINTER(hd_error)),
    'hd_geodesic_free': (None, POINTER(hd_geodesic)),
    'hd_geodesic_distance': (c_int, POINTER(hd_geodesic), POINTER(hd_sources), POINTER(c_double), c_size_t,
        POINTER(hd_geodesic_report), POINTER(hd_error)),
}
