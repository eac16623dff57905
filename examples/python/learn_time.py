"""learn_time.py - finds diffusion times by gradient descent, through the factors of heatdiff.h

    pip install ./examples/python && python3 examples/python/learn_time.py

Learned diffusion (Sharp, Attaiki, Crane, Ovsjanikov, DiffusionNet, 2022) gives each channel of a network a time of its
own, which is trained. Here two channels are diffused for times that are kept secret, and are to be found from the
result. With PyTorch the class Diffuse below is a layer whose gradients PyTorch uses; without it, or with --numpy, the
same gradients serve a few lines of NumPy. Poles of one kind and degree make the layer and its gradients exact transposes
of each other, and let them share factors.
"""
import sys

import numpy as np

import heatdiff as hd

try:
    import torch
except ImportError:
    torch = None


def surface(n=24):
    """A wavy sheet of n x n vertices."""
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    xyz = np.stack([x, y, 0.1 * np.sin(9 * x) * np.cos(6 * y)], axis=-1).reshape(-1, 3)
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij"))
    a, b, c, d = i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1
    return xyz, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def diffuse(plans, t, f):
    """K_t f, each channel (column) by its own time."""
    return np.stack([plan.apply(f[:, c], s) for c, (plan, s) in enumerate(zip(plans, t))], axis=1)


def gradients(plans, t, f, g):
    """By t and by f, from the gradient g by the result."""
    parts = [plan.vjp(f[:, c], s, g[:, c]) for c, (plan, s) in enumerate(zip(plans, t))]
    return np.array([p[0] for p in parts]), np.stack([p[1] for p in parts], axis=1)


if torch:
    class Diffuse(torch.autograd.Function):
        """diffuse(plans, t, f) for double tensors: Diffuse.apply(plans, t, f)."""

        @staticmethod
        def forward(ctx, plans, t, f):
            ctx.plans = plans
            ctx.save_for_backward(t, f)
            return torch.from_numpy(diffuse(plans, t.detach().numpy(), f.detach().numpy()))

        @staticmethod
        def backward(ctx, g):
            t, f = (x.detach().numpy() for x in ctx.saved_tensors)
            by_t, by_f = gradients(ctx.plans, t, f, g.numpy())
            return None, torch.from_numpy(by_t), torch.from_numpy(by_f)


def by_torch(plans, f, target, start, steps):
    log_t = torch.tensor(np.log(start), requires_grad=True)
    f, target = torch.from_numpy(f), torch.from_numpy(target)
    optimizer = torch.optim.LBFGS([log_t], max_iter=steps, tolerance_grad=1e-14, tolerance_change=0, line_search_fn="strong_wolfe")

    def loss():
        optimizer.zero_grad()
        value = torch.sum((Diffuse.apply(plans, torch.exp(log_t), f) - target) ** 2) / torch.sum(target ** 2)
        value.backward()
        return value

    optimizer.step(loss)
    return np.exp(log_t.detach().numpy())


def by_numpy(plans, f, target, start, steps):
    """Gradient descent in log t; a channel's step comes from its last two gradients (Barzilai, Borwein 1988)."""
    x, before, rate = np.log(start), None, 1.0
    for _ in range(steps):
        t = np.exp(x)
        g = 2 * (diffuse(plans, t, f) - target) / np.sum(target ** 2)
        slope = gradients(plans, t, f, g)[0] * t                # d/d log t = t d/dt
        if before is not None:
            change = slope - before[1]
            rate = np.where(change != 0, np.abs((x - before[0]) / np.where(change != 0, change, 1)), rate)
        before = x, slope
        x = x - np.clip(rate * slope, -1, 1)
    return np.exp(x)


def main():
    xyz, tri = surface()
    lap = hd.Laplacian.from_mesh(xyz, tri)
    secret = np.array([30, 4]) * lap.h ** 2
    f = np.random.default_rng(0).standard_normal((lap.n, 2))
    # a plan for each channel keeps the factors of its own time
    plans = [hd.Heat(lap, method="direct", poles="kernel", degree=10) for _ in secret]
    target = diffuse(plans, secret, f)
    use_torch = torch is not None and "--numpy" not in sys.argv[1:]
    t = (by_torch if use_torch else by_numpy)(plans, f, target, np.full(2, 12.0) * lap.h ** 2, 40)
    print("times made with %s h^2, found by %s: %s h^2, off by %.1e" % (
        secret / lap.h ** 2, "PyTorch" if use_torch else "NumPy", t / lap.h ** 2, max(abs(t / secret - 1))))


if __name__ == "__main__":
    main()
