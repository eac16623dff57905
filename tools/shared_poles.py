#!/usr/bin/python3
"""Pole sets of heatdiff.h that serve many times at once, computed from nothing and checked.

    exp(-t y) ~ c_t(y) = sum_i 2 Re a_i(t)/(y + theta_i)    for all t in [1, Lambda] and all y >= 0

The poles theta_i (one of each conjugate pair, Im theta > 0) do not depend on t, the weights a_i do: t0 L + theta_i B is
factorised once for all times in [t0, Lambda t0]. Always c_t(0) = 1 exactly and no constant term; wanted are the poles with
the smallest

    max over t and y of (1 + t y) |exp(-t y) - c_t(y)|,    the weights being the best for each t.

This is the measure of the kernel sets of poles.py, which are the case Lambda = 1.

Usage
    shared_poles.py                      print the C table for heatdiff.h (about 15 minutes)
    shared_poles.py --check [heatdiff.h] verify the table in the header (default: the one in the folder above this script):
                                         order, position of the poles, errors as recorded (seconds)
    shared_poles.py --check --recompute  the same, and every set once more from nothing, to see that the table is as good
    --pairs N, --lambda LAMBDA           only these sets

Needs Python 3 and numpy.

Method
    Weights. For given poles and t the weighted error is linear in the 2N real numbers a_i. One linear condition c_t(0) = 1
    goes by a Householder reflection of the unknowns, after which one of them is known. The rest is a least squares problem
    on log-spaced y, with a row for y = infinity, and a few steps of Lawson's iteration (weights times a power of the
    error) bring it near the smallest maximum. heatdiff.h does the same at run time (hdi_shared_fit).
    Poles. Variable projection: the residual of the least squares problems over a grid of (t, y) is a function of the poles
    alone, and its Jacobian is that of the problem with fixed weights, projected (Kaufman's form). Levenberg-Marquardt in
    log theta, then Lawson steps over the whole grid. The problem has many local minima, and a hyperbola ends in poor ones
    for large Lambda. So each number of pairs starts at the smallest Lambda and is carried to larger ones, the arc of poles
    being stretched in log |theta|; back again from larger to smaller ones; and perturbed.

Sources
    G. H. Golub, V. Pereyra, The differentiation of pseudo-inverses and nonlinear least squares problems whose variables
      separate, SIAM J. Numer. Anal. 10, 1973. Variable projection.
    L. Kaufman, A variable projection method for solving separable nonlinear least squares problems, BIT 15, 1975.
    C. L. Lawson, Contributions to the theory of linear least maximum approximation, thesis, UCLA, 1961.
    J. A. C. Weideman, L. N. Trefethen, Parabolic and hyperbolic contours for computing the Bromwich integral, Math. Comp.
      76, 2007. The hyperbola that starts it all, for a whole interval of times.
    M. Lopez-Fernandez, C. Palencia, A. Schaedle, A spectral order method for inverting sectorial Laplace transforms, SIAM
      J. Numer. Anal. 44, 2006. One contour for t in [t0, Lambda t0].
    The sets are ours.
"""
import argparse
import os
import re
import sys
import textwrap
import time
from collections import namedtuple

try:
    import numpy as np
except ImportError:
    sys.exit('shared_poles.py needs numpy (Debian: apt install python3-numpy)')

QUARTERS = [1.8, 3.2, 5.6, 10, 18, 32, 56, 100, 180, 320, 560, 1000, 1800, 3200, 5600, 10000, 18000, 32000]
# pairs: smallest and largest Lambda tried. Four lanes of the direct solver cost the same: pairs come in fours.
RANGE = {8: (1.8, 32), 12: (3.2, 560), 16: (10, 5600), 20: (32, 32000), 24: (180, 32000)}
# Those that are printed: about every second one, with the widest of each number of pairs for the two errors that
# heatdiff.h asks for itself (1.6e-10, 2e-8). For other errors and times a set has 0.4 pairs more on average than with all.
PRINTED = {8: (1.8, 3.2, 10), 12: (5.6, 18, 32, 100), 16: (18, 32, 180, 560, 1800),
           20: (100, 180, 1000, 1800, 18000), 24: (560, 1000, 3200, 10000, 32000)}
LARGEST_ERROR = 1.2e-5                 # sets beyond are of no use
DIGITS = 9                             # of the poles, at most; the weights adapt to what is printed
LAWSON_STEPS = 3                       # HDI_SHARED_LAWSON in heatdiff.h
EPS = 2.0**-52
BEGIN, END = '/* shared_poles.py: begin */', '/* shared_poles.py: end */'
DECLARATION = 'static const double hdi_shared_table[] = {'

# error: the largest weighted error over t and y, with what rounding may add
SharedSet = namedtuple('SharedSet', 'lam pairs error theta')


# ---- weights for given poles -------------------------------------------------------------------------------------------

def rows_of_fit(pairs):
    """Points of the least squares problem, without the one at infinity."""
    return 8*pairs + 96


def fit_points(theta):
    """Log-spaced points around the moduli of the poles, as in hdi_shared_fit."""
    size = np.abs(theta)
    k = np.arange(rows_of_fit(len(theta)))/(rows_of_fit(len(theta)) - 1)
    first, last = 0.02*size.min(), 15*size.max()
    return first*(last/first)**k


def basis(theta, y):
    """Columns 2/(y + theta), real parts for Re a and minus imaginary parts for Im a, without the weight 1 + t y."""
    p = 2/(y[:, None] + theta)
    return np.concatenate([p.real, -p.imag], 1)


def condition_row(theta):
    """The row of the condition c(0) = 1."""
    return basis(theta, np.zeros(1))[0]


def infinity_row(pairs):
    """lim y times the basis: the weighted row for y = infinity is t times it, its goal 0."""
    return np.concatenate([np.full(pairs, 2.0), np.zeros(pairs)])


def weighted_problem(theta, y, t):
    """Matrices and goals of the weighted fits for all t: (T, K + 1, 2N) and (T, K + 1)."""
    weight = 1 + np.outer(t, y)
    last = t[:, None, None]*infinity_row(len(theta))
    a = np.concatenate([weight[:, :, None]*basis(theta, y), last], 1)
    b = np.concatenate([weight*np.exp(-np.outer(t, y)), np.zeros((len(t), 1))], 1)
    return a, b


def reflection(row):
    """Unit v so that (1 - 2 v v') row has only its first entry, and that entry."""
    v = row.copy()
    head = -np.copysign(np.linalg.norm(row), row[0])
    v[0] -= head
    return v/np.linalg.norm(v), head


def reflect(a, v):
    return a - 2*(a @ v)[..., None]*v


def solve_fits(a, b, w, v, first):
    """Least squares with row weights w; the unknowns are reflected by v, the first of them is known. Slightly regularised
    towards small unknowns, as rounding demands."""
    m = a.shape[2]
    aw = w[:, :, None]*a
    bw = w*b - aw[:, :, 0]*first
    damping = np.broadcast_to(2*EPS*np.eye(m - 1), (len(a), m - 1, m - 1))
    q, r = np.linalg.qr(np.concatenate([aw[:, :, 1:], damping], 1))
    x = np.linalg.solve(r, np.einsum('tkj,tk->tj', q[:, :a.shape[1]], bw)[:, :, None])[:, :, 0]
    return reflect(np.concatenate([np.full((len(a), 1), first), x], 1), v)


def fit(theta, t):
    """Weights a (T, N) for all times."""
    n = len(theta)
    a, b = weighted_problem(theta, fit_points(theta), t)
    scale = np.linalg.norm(a, axis=1)
    scale = np.sqrt(scale[:, :n]**2 + scale[:, n:]**2)
    scale = np.concatenate([scale, scale], 1)
    a /= scale[:, None, :]
    x = np.empty((len(t), 2*n))
    for k in range(len(t)):            # the condition is scaled differently for each t
        v, head = reflection(condition_row(theta)/scale[k])
        ak, bk, w = a[k:k + 1], b[k:k + 1], np.ones((1, a.shape[1]))
        reflected = reflect(ak, v)
        lowest = np.inf
        for step in range(LAWSON_STEPS + 1):
            xk = solve_fits(reflected, bk, w, v, 1/head)
            e = np.abs(np.einsum('tkj,tj->tk', ak, xk) - bk)
            if e.max() < lowest:
                lowest, x[k] = e.max(), xk[0]/scale[k]
            w = w*np.sqrt(e/e.max() + 1e-3)
            w /= w.max()
    return x[:, :n] + 1j*x[:, n:]


def pole_distance(theta):
    """Distance of -theta to y >= 0."""
    return np.where(theta.real >= 0, np.abs(theta), np.abs(theta.imag))


def measure(theta, t, points=2500):
    """The largest weighted error and the largest sum of 2 |a_i|/distance of -theta_i to y >= 0 over the times t, on dense y."""
    y = np.geomspace(1e-3*np.abs(theta).min(), 1e3*np.abs(theta).max(), points)
    a = fit(theta, t)
    matrix = basis(theta, y)
    worst = 0.0
    for ak, tk in zip(a, t):
        c = matrix @ np.concatenate([ak.real, ak.imag])
        at_end = tk*abs(2*ak.real.sum())
        worst = max(worst, at_end, np.abs((1 + tk*y)*(np.exp(-tk*y) - c)).max())
    return worst, (2*np.abs(a)/pole_distance(theta)).sum(1).max()


def rounding(theta, t):
    """What the bound of heatdiff.h allows for rounding: four units in the last place of all terms, weighted."""
    y = np.geomspace(1e-2*np.abs(theta).min(), 1e3*np.abs(theta).max(), 300)
    sizes = np.abs(fit(theta, t)) @ (2/np.abs(y[:, None] + theta)).T
    return 4*EPS*((1 + np.outer(t, y))*sizes).max()


def times_of(lam, count):
    """Times in [1, lam], log-spaced but closer towards the ends, where the error changes fastest."""
    u = np.arange(count)/(count - 1)
    return lam**(0.2*u + 0.4*(1 - np.cos(np.pi*u)))


# ---- poles -------------------------------------------------------------------------------------------------------------

class Projection:
    """The weighted residual over a grid of (t, y) as a function of p = (log |theta|, arg theta)."""

    def __init__(self, lam, pairs):
        self.y = np.geomspace(0.03/lam, 200, 150 + 7*pairs)
        self.t = times_of(lam, int(14 + pairs/2 + 6*np.log10(lam)))
        self.w = np.ones((len(self.t), len(self.y) + 1))

    def residual(self, p, jacobian=False):
        n = len(p)//2
        theta = np.exp(p[:n] + 1j*p[n:])
        a, b = weighted_problem(theta, self.y, self.t)
        a *= self.w[:, :, None]
        scale = np.linalg.norm(a, axis=(0, 1))
        v, head = reflection(condition_row(theta)/scale)
        a = reflect(a/scale, v)
        q, r = np.linalg.qr(a[:, :, 1:])
        goal = self.w*b - a[:, :, 0]/head
        qb = np.einsum('tkj,tk->tj', q, goal)
        res = goal - np.einsum('tkj,tj->tk', q, qb)
        if not jacobian:
            return res.ravel()
        x = np.linalg.solve(r, qb[:, :, None])[:, :, 0]
        x = reflect(np.concatenate([np.full((len(self.t), 1), 1/head), x], 1), v)/scale
        weights = x[:, :n] + 1j*x[:, n:]
        # d/dlog theta of 2 a/(y + theta) is -2 a theta/(y + theta)^2, at y = 0 -2 a/theta; at infinity it vanishes. A change
        # of c(0) is undone along the first column, up to what the projection removes.
        slope = -2*theta/(self.y[:, None] + theta)**2
        slope = (1 + np.outer(self.t, self.y))[:, :, None]*weights[:, None, :]*slope
        slope = np.concatenate([slope, np.zeros((len(self.t), 1, n))], 1)*self.w[:, :, None]
        at_zero = -2*weights/theta
        m = np.concatenate([slope.real, -slope.imag], 2)
        m -= (a[:, :, 0]/head)[:, :, None]*np.concatenate([at_zero.real, -at_zero.imag], 1)[:, None, :]
        m -= q @ (np.swapaxes(q, 1, 2) @ m)
        return res.ravel(), -m.reshape(-1, 2*n)

    def descend(self, p, steps, enough):
        """Levenberg-Marquardt until a step gains less than the share enough."""
        n = len(p)//2
        damping = 1e-3
        res, jac = self.residual(p, True)
        for _ in range(steps):
            gram, gradient = jac.T @ jac, jac.T @ res
            diagonal = np.diag(gram) + 1e-12*np.diag(gram).max()
            for _ in range(8):
                step = -np.linalg.solve(gram + damping*np.diag(diagonal), gradient)
                step *= min(1, 0.5/np.abs(step).max())
                q = p + step
                if (q[n:] > 0.005).all() and (q[n:] < 2.55).all():     # sec^2(phi/2) <= 11.6
                    new = self.residual(q)
                    if new @ new < res @ res:
                        break
                damping *= 6
            else:
                return p
            gain = 1 - (new @ new)/(res @ res)
            p, damping = q, max(damping/5, 1e-9)
            if gain < enough:
                return p
            res, jac = self.residual(p, True)
        return p

    def lawson(self, p, power):
        """Larger weights where the error is large."""
        e = np.abs(self.residual(p)).reshape(self.w.shape)/self.w
        self.w *= (e/e.max() + 0.1)**power
        self.w /= self.w.max()


def as_parameters(theta):
    return np.concatenate([np.log(np.abs(theta)), np.angle(theta)])


def as_poles(p):
    n = len(p)//2
    theta = np.exp(p[:n] + 1j*p[n:])
    return theta[np.argsort(np.abs(theta))]


def hyperbola(pairs, lam):
    """Nodes of the trapezoidal rule on the best hyperbola for t in [1, lam]."""
    lam = max(lam, 1.5)
    al = np.linspace(np.pi/4 + 1e-4, np.pi/2 - 1e-4, 2000)
    height = np.arccosh(((np.pi - 2*al)*lam + 4*al - np.pi)/((4*al - np.pi)*np.sin(al)))
    best = np.argmax((np.pi**2 - 2*np.pi*al)/height)
    al, height = al[best], height[best]
    mu = (4*np.pi*al - np.pi**2)/height*pairs/lam
    s = mu*(1 + np.sin(1j*(np.arange(pairs) + 0.5)*height/pairs - al))
    return np.where(s.imag < 0, s.conj(), s)


def stretched(theta, ratio):
    """The arc of poles for lam ratio instead of lam: the largest stays, the smallest is divided by ratio."""
    size = np.log(np.abs(theta))
    factor = 1 + np.log(ratio)/(size.max() - size.min())
    return np.exp(size.max() - (size.max() - size)*factor + 1j*np.angle(theta))


def polished(theta, lam, rounds=8):
    """From the least squares optimum towards the smallest maximum; the best poles seen, and their error."""
    problem = Projection(lam, len(theta))
    p = as_parameters(theta)
    t = times_of(lam, 41)
    best = (np.inf, theta)
    for k in range(rounds):
        error = measure(as_poles(p), t, 800)[0]
        if error < best[0]:
            best = (error, as_poles(p))
        problem.lawson(p, 0.5/(1 + k/10))
        p = problem.descend(p, 4, 1e-3)
    return best


def least_squares_optimum(theta, lam):
    problem = Projection(lam, len(theta))
    p = problem.descend(as_parameters(theta), 60, 1e-4)
    return np.linalg.norm(problem.residual(p)), as_poles(p)


def from_starts(starts, lam):
    """The best of several starts: (error, poles)."""
    found = []
    for theta in starts:
        try:
            found.append(least_squares_optimum(theta, lam))
        except np.linalg.LinAlgError:
            pass
    return polished(min(found, key=lambda one: one[0])[1], lam)


def perturbed(theta, rng):
    """All poles moved a little, smoothly along the arc and each by itself."""
    n = len(theta)
    wave = np.cos(np.pi*np.arange(n)/n*rng.integers(1, 5) + rng.uniform(0, 6))
    size = 0.15*rng.normal()*wave + 0.04*rng.normal(size=n)
    return theta*np.exp(size + 0.03j*rng.normal(size=n))


def compute_pairs(pairs, lams, hops, say):
    """All sets of this many pairs, as {lam: (error, poles)}."""
    best = {}

    def offer(lam, starts, what):
        try:
            new = from_starts(starts, lam)
        except (np.linalg.LinAlgError, ValueError):
            return
        better = lam not in best or new[0] < 0.995*best[lam][0]
        if better:
            best[lam] = new
        say('%2d pairs, lambda %7g: %.3e %s%s' % (pairs, lam, new[0], what, '' if better else ' (no gain)'))

    for k, lam in enumerate(lams):
        starts = [hyperbola(pairs, lam)] if k < 3 else []
        if k:
            starts.append(stretched(best[lams[k - 1]][1], lam/lams[k - 1]))
        offer(lam, starts, 'upwards')
    rng = np.random.default_rng(pairs)
    for _ in range(hops):
        for lam in lams:
            offer(lam, [perturbed(best[lam][1], rng) for _ in range(2)], 'perturbed')
        for small, large in list(zip(lams, lams[1:]))[::-1]:
            offer(small, [stretched(best[large][1], small/large)], 'downwards')
        for small, large in zip(lams, lams[1:]):
            offer(large, [stretched(best[small][1], large/small)], 'upwards')
    return best


def rounded(theta, digits):
    text = '%%.%dg' % digits
    return np.array([float(text % z.real) + 1j*float(text % z.imag) for z in theta])


def finished(theta, lam):
    """A set as it will be printed, measured at many times: with as few digits as do not show in its error."""
    t = times_of(lam, 401)
    least = measure(rounded(theta, DIGITS), t)[0]
    for digits in range(4, DIGITS + 1):
        short = rounded(theta, digits)
        error = measure(short, t)[0]
        if error <= 1.003*least:
            break
    return SharedSet(lam, len(theta), error + rounding(short, t), short)


def worth_it(one):
    """Small enough an error, and no more than two thirds of it rounding: which is the worst case, and mostly a tenth of that."""
    return one.error < LARGEST_ERROR and 1.5*rounding(one.theta, times_of(one.lam, 41)) < one.error


# ---- the C table -------------------------------------------------------------------------------------------------------

def table_text(sets):
    lines = [BEGIN,
             '/* Computed by tools/shared_poles.py, which also checks it. Each set begins with the largest ratio of',
             ' * times, the number of pairs and the largest weighted error over all times (with rounding). Then come Re',
             ' * theta, Im theta of one pole of each pair, by ascending |theta|. Sets ascend by the number of pairs, then by',
             ' * the ratio. */',
             DECLARATION]
    for one in sets:
        lines.append('    %g, %d, %.3g,' % (one.lam, one.pairs, one.error))
        numbers = ['%.*g,\xa0%.*g' % (DIGITS, z.real, DIGITS, z.imag) for z in one.theta]
        rows = textwrap.wrap(', '.join(numbers) + ',', 110, initial_indent=' '*6, subsequent_indent=' '*6)
        lines += [row.replace('\xa0', ' ') for row in rows]      # a pole stays on one line
    return '\n'.join(lines + ['};', END])


def parse_table(path):
    """The sets between the marker lines of a header."""
    with open(path, encoding='utf-8') as source:
        text = source.read()
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        raise ValueError('%s: the lines %s and %s must occur once each' % (path, BEGIN, END))
    body = re.sub(r'/\*.*?\*/', ' ', text[text.index(BEGIN) + len(BEGIN):text.index(END)], flags=re.S)
    if body.count(DECLARATION) != 1:
        raise ValueError('%s: no "%s" between the markers' % (path, DECLARATION))
    body = body[body.index(DECLARATION) + len(DECLARATION):]
    numbers = [float(word) for word in body[:body.index('}')].replace(',', ' ').split()]
    sets, k = [], 0
    while k < len(numbers):
        n = int(numbers[k + 1])
        part = np.array(numbers[k + 3:k + 3 + 2*n])
        if len(part) != 2*n:
            raise ValueError('%s: the table ends within a set' % path)
        sets.append(SharedSet(numbers[k], n, numbers[k + 2], part[0::2] + 1j*part[1::2]))
        k += 3 + 2*n
    return sets


# ---- checks ------------------------------------------------------------------------------------------------------------

def complaints_about(one):
    """What is wrong with a recorded set, by measuring it at times that the table was not made with."""
    t = times_of(one.lam, 97)
    error, amplification = measure(one.theta, t, 4001)
    error += rounding(one.theta, t)
    growth = 1/np.cos(np.angle(one.theta).max()/2)**2
    wrong = []
    if not (one.theta.imag > 0).all() or (np.diff(np.abs(one.theta)) < 0).any():
        wrong.append('poles out of order')
    if not 0.8*one.error < error < 1.08*one.error:
        wrong.append('error %.3g is not as recorded' % error)
    if not worth_it(one):
        wrong.append('error too large, or below rounding')
    print('lambda %7g, %2d pairs: error %.3e (%.3e) amplification %6.1f growth %.1f %s' %
          (one.lam, one.pairs, one.error, error, amplification, growth, '; '.join(wrong) or 'ok'))
    sys.stdout.flush()
    return wrong


def check(header, arguments):
    """Verify the table; True if all is well."""
    try:
        sets = parse_table(header)
    except (OSError, ValueError) as trouble:
        print(trouble)
        return False
    bad = [(a.pairs, a.lam) >= (b.pairs, b.lam) for a, b in zip(sets, sets[1:])].count(True)
    bad += [a.pairs == b.pairs and a.error > b.error for a, b in zip(sets, sets[1:])].count(True)
    print('%d sets, %d out of order' % (len(sets), bad))
    for one in wanted(sets, arguments):
        bad += len(complaints_about(one))
    if arguments.recompute:
        known = {(one.pairs, one.lam): one.error for one in sets}
        for one in compute(arguments):
            old = known.get((one.pairs, one.lam), np.inf)
            worse = one.error < 0.8*old
            bad += worse
            print('lambda %7g, %2d pairs: recomputed %.3e, table %.3e %s' % (one.lam, one.pairs, one.error, old, 'WORSE' if worse else 'ok'))
    print('%d failed' % bad)
    return bad == 0


def wanted(sets, arguments):
    return [one for one in sets if arguments.pairs in (None, one.pairs) and arguments.lam in (None, one.lam)]


# ---- command line ------------------------------------------------------------------------------------------------------

def compute(arguments):
    start = time.time()

    def say(text):
        print('%7.1f s  %s' % (time.time() - start, text), file=sys.stderr, flush=True)

    sets = []
    for pairs, (first, last) in RANGE.items():
        if arguments.pairs not in (None, pairs):
            continue
        best = compute_pairs(pairs, [lam for lam in QUARTERS if first <= lam <= last], arguments.hops, say)
        sets += [one for one in (finished(best[lam][1], lam) for lam in PRINTED[pairs]) if worth_it(one)]
    return wanted(sets, arguments)


def main():
    parser = argparse.ArgumentParser(description='Pole sets for many times in heatdiff.h: without options the C table, with --check a verification of it.')
    default = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, 'heatdiff.h'))
    parser.add_argument('--check', nargs='?', const=default, metavar='heatdiff.h', help='verify the table in this header')
    parser.add_argument('--recompute', action='store_true', help='with --check: also compute all sets again and compare')
    parser.add_argument('--hops', type=int, default=1, metavar='K', help='rounds of perturbations (default %(default)s)')
    parser.add_argument('--pairs', type=int, choices=sorted(RANGE), help='only sets of this many pairs')
    parser.add_argument('--lambda', type=float, dest='lam', metavar='LAMBDA', help='only sets of this ratio')
    arguments = parser.parse_args()
    if arguments.check:
        sys.exit(0 if check(arguments.check, arguments) else 1)
    print(table_text(compute(arguments)))


if __name__ == '__main__':
    main()
