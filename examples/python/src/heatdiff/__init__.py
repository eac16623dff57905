"""heatdiff - heat kernels, signatures and distances on triangles, polygons and points, without eigenvectors

    import heatdiff as hd
    signature = hd.hks(V, F, t="auto:16")               # (n, 16), k_t(x, x)
    d = hd.diffusion_distance(V, F, 0, t="10h2")        # (n,), from vertex 0
    far = hd.geodesic_distance(V, F, [0, 5])            # (n,), along the surface
    flat = hd.smooth(V, F, t="2h2")                     # (n, 3), smoothed coordinates
    d.report.error_bound                                # how large an error can be

    lap = hd.Laplacian.from_mesh(V, F)                  # or from_polygons, from_points, from_lengths, from_matrices
    heat = hd.Heat(lap, method="direct")                # keeps its factors
    u = heat.column(0, "100h2")                         # K_t e_0
    u = heat.apply(fields, [0.1, 1.0])                  # (n, k, 2)

V is (n, 3), F is (m, 3), ids begin at 0. Times are lengths squared. L is positive semi-definite. The answers are arrays
with a report. What is wrong with an argument is said by its name: ValueError, TypeError, and for what the library refuses
InputError, a ValueError with status, face, vertex and row. Doubtful accuracy is an AccuracyWarning. Ctrl-C cancels.
"""
from ._bindings import VERSION as __version__
from ._library import AccuracyWarning, CancelledError, Error, InputError, OutOfMemoryError
from .answers import Answer, Estimate, GeodesicReport, Report
from .geodesic import Geodesic
from .heat import Heat, Sources, Spectrum
from .laplacian import CSR, Laplacian
from .simple import (DiffusionNetOperators, diffusion_distance, diffusion_net, geodesic_distance, heat_kernel, hks, laplacian,
                     neighbourhoods, smooth, wks)

__all__ = ["AccuracyWarning", "Answer", "CSR", "CancelledError", "DiffusionNetOperators", "Error", "Estimate", "Geodesic",
           "GeodesicReport", "Heat", "InputError", "Laplacian", "OutOfMemoryError", "Report", "Sources", "Spectrum",
           "__version__", "diffusion_distance", "diffusion_net", "geodesic_distance", "heat_kernel", "hks", "laplacian",
           "neighbourhoods", "smooth", "wks"]
