"""demo.py - kernel, signature and distances of a torus from Python; with matplotlib also a picture

    cmake -S . -B build -DHEATDIFF_BUILD_SHARED=ON && cmake --build build --target heatdiff_shared
    HEATDIFF_LIBRARY=build/libheatdiff.so python3 examples/python/demo.py [picture.png]
"""
import sys

import numpy as np

import heatdiff as hd

nu, nv = 96, 40
u, v = np.meshgrid(2 * np.pi * np.arange(nu) / nu, 2 * np.pi * np.arange(nv) / nv, indexing="ij")
xyz = np.stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)], axis=-1).reshape(-1, 3)
i, j = np.meshgrid(np.arange(nu), np.arange(nv), indexing="ij")
a, b, c, d = (k.ravel() for k in (i * nv + j, (i + 1) % nu * nv + j, (i + 1) % nu * nv + (j + 1) % nv, i * nv + (j + 1) % nv))
tri = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])

lap = hd.triangles(xyz, tri)
heat = hd.Heat(lap)
t = 30 * lap.h ** 2

kernel = heat.columns(t, [0], symmetric=True)[:, 0]
print(f"{lap.n} vertices, area {lap.area:.3f}; heat at the source {kernel[0]:.6f}, error at most "
      f"{heat.report['error_bound']:.0e} of the largest ({heat.report['reason']})")
signature = heat.diagonal([t, 10 * t])
print(f"signature: inside {signature[nv // 2, 0]:.6f}, outside {signature[0, 0]:.6f}")
print(f"diffusion distance to the far side: {heat.distance(t, [0])[nu // 2 * nv, 0]:.6f}")
far = hd.Geodesic(xyz, tri).distance([0])
print(f"along the surface: {far[nv // 2]:.4f} around the tube (exact: {np.pi:.4f})")

if len(sys.argv) > 1:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    axes = plt.figure(figsize=(8, 6)).add_subplot(projection="3d")
    picture = axes.plot_trisurf(*xyz.T, triangles=tri)
    picture.set_array(np.log10(np.maximum(kernel, 1e-6 * kernel.max()))[tri].mean(axis=1))
    axes.set_box_aspect(np.ptp(xyz, axis=0))
    axes.set_axis_off()
    plt.savefig(sys.argv[1], dpi=120)
