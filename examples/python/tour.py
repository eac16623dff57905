"""tour.py - a first walk through heatdiff.h from Python: kernel, signature, distances, accuracy, each with a picture

    pip install ./examples/python && python3 examples/python/tour.py [FOLDER [LEVELS]]

Editors that know cells (# %%) run it piece by piece and show the pictures. As a script it writes them to FOLDER, by
default heatdiff-tour. It needs NumPy, SciPy and matplotlib.
"""
# %% The surface: a sphere drawn out into five arms, as arrays of vertices and triangles. Any mesh will do.
import os
import sys
import warnings

import matplotlib
interactive = "ipykernel" in sys.modules
if not interactive:
    matplotlib.use("Agg")               # files only, no window
import matplotlib.pyplot as plt
import numpy as np
import scipy.linalg
import scipy.sparse.linalg

import heatdiff as hd

folder = sys.argv[1] if len(sys.argv) > 1 and not interactive else "heatdiff-tour"


def save(name):
    """Shows the figure in a notebook, or writes it."""
    if interactive:
        plt.show()
        return
    os.makedirs(folder, exist_ok=True)
    plt.savefig(os.path.join(folder, name), dpi=110)
    plt.close()
    print("wrote", os.path.join(folder, name))


def sphere(levels):
    """An icosahedron whose triangles are split in four several times."""
    g = (1 + 5 ** 0.5) / 2
    xyz = np.array([[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g], [0, -1, -g], [0, 1, -g],
                    [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]])
    tri = np.array([[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2],
                    [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5],
                    [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]])
    for _ in range(levels):
        edges = np.sort(np.concatenate([tri[:, [0, 1]], tri[:, [1, 2]], tri[:, [2, 0]]]), axis=1)
        edges, which = np.unique(edges, axis=0, return_inverse=True)
        ab, bc, ca = (len(xyz) + which.reshape(3, -1))
        a, b, c = tri.T
        xyz = np.concatenate([xyz, xyz[edges].mean(axis=1)])
        tri = np.concatenate([np.stack(f, 1) for f in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        xyz /= np.linalg.norm(xyz, axis=1, keepdims=True)
    return xyz, tri


def star(levels):
    xyz, tri = sphere(levels)
    angle = 2 * np.pi * np.arange(5) / 5
    toward = xyz @ np.stack([np.cos(angle), np.sin(angle), 0 * angle])
    reach = 1 + (1.6 * np.exp((toward - 1) / 0.10)).sum(axis=1)
    return xyz * reach[:, None] * [1, 1, 0.7], tri


xyz, tri = star(int(sys.argv[2]) if len(sys.argv) > 2 and not interactive else 5)
lap = hd.Laplacian.from_mesh(xyz, tri)  # the matrices L and B
print(f"{lap.n} vertices, mean edge {lap.h:.4f}, area {lap.area:.3f}")

tip = int(np.argmax(xyz[:, 0]))
top = int(np.argmax(xyz[:, 2]))
between = int(np.argmin(np.linalg.norm(xyz - 1.05 * np.array([np.cos(np.pi / 5), np.sin(np.pi / 5), 0]), axis=1)))


def draw(axes, values, title, most=None, colours="YlOrRd"):
    """The surface seen from above, coloured by a field."""
    light = matplotlib.colors.LightSource(azdeg=300, altdeg=60)
    picture = axes.plot_trisurf(*xyz.T, triangles=tri, linewidth=0, antialiased=False, shade=False)
    normal = np.cross(xyz[tri[:, 1]] - xyz[tri[:, 0]], xyz[tri[:, 2]] - xyz[tri[:, 0]])
    shade = light.shade_normals(normal / np.linalg.norm(normal, axis=1, keepdims=True), fraction=1.0)
    colour = matplotlib.colormaps[colours](values[tri].mean(axis=1) / (most or values.max()))
    picture.set_facecolor(np.clip(colour[:, :3] * (0.65 + 0.35 * shade[:, None]), 0, 1))
    axes.set_box_aspect(np.ptp(xyz, axis=0), zoom=1.3)
    axes.view_init(elev=58, azim=-70)
    axes.set_axis_off()
    axes.set_title(title, fontsize=11)


# %% The heat kernel: one unit of heat starts at the tip of an arm. Times are areas, and h^2 is the finest sensible one.
heat = hd.Heat(lap)
times = [10, 100, 300, 1000]
kernel = heat.column(tip, [f"{t}h2" for t in times], symmetric=True)    # a column for each time
print(f"kernel: error at most {kernel.report.error_bound:.0e} of the largest value ({kernel.report.reason})")

figure = plt.figure(figsize=(11, 3.2))
for k, t in enumerate(times):
    axes = figure.add_subplot(1, 4, k + 1, projection="3d")
    draw(axes, kernel[:, k], f"t = {t} h²\nlargest {kernel[:, k].max():.3g}")
figure.suptitle("Heat kernel of the tip of one arm, each relative to its largest value")
figure.subplots_adjust(left=0, right=1, bottom=0, top=0.76, wspace=0)
save("kernel.png")

# %% The heat kernel signature k_t(x, x): the heat that stays. Small t sees the place, large t the whole.
times = np.geomspace(1, 1500, 40) * lap.h ** 2
signature = heat.hks(times)                             # of all vertices; the times share their factors
lower, vectors = scipy.sparse.linalg.eigsh(lap.L, 100, lap.B, sigma=-1e-3)
flat = 4 * np.pi * times                                # a plane keeps 1/(4 pi t)
places = {"tip of an arm": tip, "between two arms": between, "middle": top}

figure, axes = plt.subplots(figsize=(7, 4.6), constrained_layout=True)
for colour, (name, v) in zip(("C3", "C0", "C2"), places.items()):
    axes.semilogx(times / lap.h ** 2, flat * signature[v], color=colour, label=name)
    axes.semilogx(times / lap.h ** 2, flat * (np.exp(-np.outer(times, lower)) @ vectors[v] ** 2), ":", color=colour)
axes.plot([], [], "k:", label="the same from 100 eigenvectors")
axes.semilogx(times / lap.h ** 2, flat / lap.area, "--", color="0.6", label="all heat spread evenly: 1/area")
axes.axhline(1, color="0.8", linewidth=0.8, zorder=0)
axes.text(1.1, 0.9, "flat", color="0.5")
axes.set(xlabel="t / h²", ylabel="4πt k_t(x, x)", title="Heat kernel signature, relative to a plane's", xlim=(1, 1500),
         ylim=(0, 3.2))
axes.legend(loc="upper left")
save("signature.png")

# %% Distances from the tip: diffusion distance knows all ways from x to y, geodesic distance the shortest.
geodesic = hd.geodesic_distance(xyz, tri, tip)
times = [30, 300, 3000]
diffusion = heat.distance(tip, [f"{t}h2" for t in times])

figure = plt.figure(figsize=(11, 3.9))
for k, (field, title) in enumerate(((geodesic, "geodesic distance"), (diffusion[:, 1], "diffusion distance, t = 300 h²"))):
    draw(figure.add_axes((0.01 + 0.28 * k, 0.02, 0.28, 0.84), projection="3d"), field, title, colours="viridis")
axes = figure.add_axes((0.64, 0.14, 0.34, 0.74))
for k, t in enumerate(times):
    axes.plot(geodesic, diffusion[:, k] / diffusion[:, k].max(), ".", markersize=1.2, color=f"C{k}")
    axes.plot([], [], "o", color=f"C{k}", label=f"t = {t} h²")
axes.set(xlabel="geodesic distance", ylabel="diffusion distance / its largest value", title="Every vertex, at three times")
axes.legend(loc="lower right")
save("distance.png")

# %% Accuracy: the error of a column against the degree of the rational function, with all eigenvectors as the truth.
small = hd.Laplacian.from_mesh(*star(3))
t = "20h2"
values, vectors = scipy.linalg.eigh(small.L.toarray(), small.B.toarray())
truth = vectors @ (np.exp(-small.times(t) * np.maximum(values, 0)) * vectors[0])
degrees = np.arange(2, 15)
warnings.simplefilter("ignore", hd.AccuracyWarning)     # of the lowest degrees, which is what the picture shows

figure, axes = plt.subplots(figsize=(7, 4.6), constrained_layout=True)
for poles, colour in (("uniform", "C0"), ("kernel", "C1")):
    error, bound = [], []
    for degree in degrees:
        column = hd.Heat(small, method="direct", poles=poles, degree=degree).column(0, t, symmetric=True)
        error.append(abs(column - truth).max() / truth.max())
        bound.append(column.report.error_bound)
    axes.semilogy(degrees, error, "o-", color=colour, label=f"{poles} poles: true error")
    axes.semilogy(degrees, bound, "--", color=colour, label=f"{poles} poles: reported bound")
axes.set(xlabel="degree of the rational function", ylabel="largest error / largest value", xticks=degrees,
         title=f"A column of k_t, t = 20 h², {small.n} vertices")
axes.grid(color="0.9")
axes.legend()
save("accuracy.png")
