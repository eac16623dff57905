#!/usr/bin/python3
"""Poles and residues of the rational functions behind heatdiff.h, computed from nothing and checked.

    exp(x) ~ c(x) = a0 + sum_i a_i/(x - theta_i)    for x in (-inf, 0],    e(x) = exp(x) - c(x)

Two families, each with r poles (a real one for odd r, the others in conjugate pairs):

    uniform  r = 1..14   numerator of degree r; minimises max |e(x)|
    kernel   r = 2..14   a0 = 0 and c(0) = 1 exactly; minimises max (1 + |x|) |e(x)|

Usage
    poles.py                      print the C table for heatdiff.h
    poles.py --check [heatdiff.h] recompute everything, compare with published values and with the table in the
                                  header (default: the one in the folder above this script), digit by digit
    --kind uniform|kernel, --max-degree R    only these sets, for quick runs

Needs Python 3 and mpmath (Debian: python3-mpmath). The full run takes about a minute.

Method
    x = -scale (1 - s)/(1 + s) takes s in [-1, 1] to the half line; s = 1 is x = 0 and s = -1 is x = -inf. Both families
    then read: find polynomials p, q in s so that the weighted error

        E(s) = F(s) - g(s) p(s)/q(s),     F = W exp,   W = 1 (uniform) or 1 + |x| (kernel)

    alternates as often as it can. g is 1 for uniform sets. For kernel sets c = (1 + s) p/q, which vanishes at -inf and so
    has no a0, and g = W (1 + s) is a polynomial of degree 1. Remez' second algorithm:
      1. on a reference s_0 > ... > s_(n-1) solve  F - g p/q = sign_k lambda  (level_reference);
      2. move each reference point to the extremum of E in its own sign run (alternation_of);
      3. repeat until all extrema have the same height.
    Step 1 is nonlinear in lambda, but it is an eigenproblem in disguise: divided differences over n points kill every
    polynomial of degree n - 2, hence also p v for any v of degree r, and what remains is

        V' D F V q = lambda V' D S V q,    V the Chebyshev-Vandermonde matrix, D = diag(d_k/g_k), S = diag(sign_k),

    symmetric, with a positive definite right-hand matrix because d_k alternates exactly as sign_k does. The wanted lambda
    is the one whose denominator q keeps its sign. No guess for lambda, no safeguards, and plain Chebyshev points start it.
    About 15 of the 90 digits are lost on the way for r = 14, measured against a run with 130.

Sources
    E. Ya. Remez, Sur le calcul effectif des polynomes d'approximation de Tchebychef, C. R. Acad. Sci. Paris 199, 1934.
    W. J. Cody, G. Meinardus, R. S. Varga, Chebyshev rational approximations to exp(-x) in [0, inf) and applications to
      heat-conduction problems, J. Approx. Theory 2, 1969. The uniform sets.
    A. J. Carpenter, A. Ruttan, R. S. Varga, Extended numerical computations on the "1/9" conjecture in rational
      approximation theory, in Rational Approximation and Interpolation, Springer, 1984. The reference values of sigma_r.
    L. N. Trefethen, J. A. C. Weideman, T. Schmelzer, Talbot quadratures and rational approximations, BIT 46, 2006. How
      these sets compare with contour integrals.
    M. Pusa, Correction to partial fraction decomposition coefficients for Chebyshev rational approximation on the negative
      real axis, arXiv:1206.2880, 2012. The reference values of theta and a for r = 14.
    The kernel sets are ours.
"""
import argparse
import os
import re
import sys
from collections import namedtuple

try:
    import mpmath as mp
except ImportError:
    sys.exit('poles.py needs mpmath (Debian: apt install python3-mpmath)')

DIGITS = 90                            # working precision
MAX_DEGREE = 14                        # in double precision rounding takes over at 15
CELLS_PER_EXTREMUM = 12                # grid cells between two neighbouring extrema of the error
BEGIN, END = '/* poles.py: begin */', '/* poles.py: end */'
DECLARATION = 'static const double hdi_rat_table[] = {'


# ---- the two problems --------------------------------------------------------------------------------------------------

class Uniform:
    """max |e(x)|: c = p/q with p and q of degree r, 2r + 2 alternation points, x = 0 and -inf among them."""
    name = 'uniform'
    min_degree = 1
    anchored = False                   # no interpolation at x = 0

    @staticmethod
    def numerator_degree(r):
        return r

    @staticmethod
    def n_alternation(r):
        return 2*r + 2

    @staticmethod
    def weight(x):
        """W and dW/dx."""
        return mp.mpf(1), mp.mpf(0)

    @staticmethod
    def fixed_factor(s):
        """h and dh/ds in c = h p/q."""
        return mp.mpf(1), mp.mpf(0)

    @staticmethod
    def weighted_factor(s, scale):
        """g = W h and dg/ds, finite at s = -1 too."""
        return mp.mpf(1), mp.mpf(0)

    @staticmethod
    def error_at_infinity(c):
        """lim W e for x -> -inf."""
        return -c.a0


class Kernel:
    """max (1 + |x|)|e(x)|: c = (1 + s) p/q, p of degree r - 1, c(0) = 1; 2r alternation points, -inf among them."""
    name = 'kernel'
    rise = 0                           # of the weight against 1 + |x|, far out
    min_degree = 2
    anchored = True                    # s = 1 joins the reference with sign 0: e(0) = 0

    @staticmethod
    def numerator_degree(r):
        return r - 1

    @staticmethod
    def n_alternation(r):
        return 2*r

    @staticmethod
    def weight(x):
        return 1 - x, mp.mpf(-1)

    @staticmethod
    def fixed_factor(s):
        return 1 + s, mp.mpf(1)

    @staticmethod
    def weighted_factor(s, scale):
        return 1 + s + scale*(1 - s), 1 - scale

    @staticmethod
    def error_at_infinity(c):
        """e ~ -sum a_i/x and W ~ -x, so W e -> sum a_i (poles with their conjugates)."""
        return mp.fsum(p.multiplicity*mp.re(p.residue) for p in c.poles)


PROBLEMS = (Uniform, Kernel)

# multiplicity: 1 for a real pole, 2 for a pole that stands for itself and its conjugate (Im theta > 0)
Pole = namedtuple('Pole', 'theta residue multiplicity')
PartialFractions = namedtuple('PartialFractions', 'a0 poles')
# one finished set: scale is that of the map, sigma the levelled weighted error, sup the maximum of |e| without weight
RationalSet = namedtuple('RationalSet', 'problem degree scale c sigma sup')


# ---- polynomials in the Chebyshev basis and the map --------------------------------------------------------------------

def map_scale(r):
    """Scale of the map for degree r, tuned so that the extrema lie nearly equally spaced in arccos(s)."""
    return mp.mpf(r)*9/10 + 1


def x_of_s(s, scale):
    """x and dx/ds; s > -1."""
    return -scale*(1 - s)/(1 + s), 2*scale/(1 + s)**2


def chebyshev_row(s, degree):
    """[T_0(s), ..., T_degree(s)]"""
    row = [mp.mpf(1), s]
    while len(row) <= degree:
        row.append(2*s*row[-1] - row[-2])
    return row[:degree + 1]


def chebyshev_value(coeffs, s):
    """Sum of coeffs[k] T_k(s) and its derivative, by Clenshaw's recurrence; s may be complex."""
    b1 = b2 = d1 = d2 = mp.mpf(0)
    for ck in reversed(coeffs[1:]):
        b1, b2, d1, d2 = 2*s*b1 - b2 + ck, b1, 2*s*d1 - d2 + 2*b1, d1
    return s*b1 - b2 + coeffs[0], b1 + s*d1 - d2


def chebyshev_to_powers(coeffs):
    """Coefficients of the same polynomial in powers of s, lowest first."""
    n = len(coeffs)
    older, old = [mp.mpf(1)], [mp.mpf(0), mp.mpf(1)]
    powers = [mp.mpf(0)]*n
    for k in range(n):
        if k == 0:
            basis = older
        elif k == 1:
            basis = old
        else:                          # T_k = 2 s T_(k-1) - T_(k-2)
            basis = [mp.mpf(0)] + [2*v for v in old]
            for i, v in enumerate(older):
                basis[i] -= v
            older, old = old, basis
        for i, v in enumerate(basis):
            powers[i] += coeffs[k]*v
    return powers


# ---- Remez -------------------------------------------------------------------------------------------------------------

def weighted_target(problem, s, scale):
    """F = W exp and dF/ds. Both vanish at s = -1."""
    if s <= -1:
        return mp.mpf(0), mp.mpf(0)
    x, dx = x_of_s(s, scale)
    w, dw = problem.weight(x)
    ex = mp.exp(x)
    return w*ex, (dw + w)*ex*dx


def weighted_error(problem, p, q, s, scale):
    """E = F - g p/q and dE/ds."""
    f, df = weighted_target(problem, s, scale)
    g, dg = problem.weighted_factor(s, scale)
    pv, dp = chebyshev_value(p, s)
    qv, dq = chebyshev_value(q, s)
    ratio = g*pv/qv
    return f - ratio, df - (dg*pv + g*dp - ratio*dq)/qv


def divided_difference_weights(points):
    """d_k with sum d_k u(points_k) = 0 for every polynomial u of degree <= n - 2, scaled by a common factor."""
    weights = []
    for k, sk in enumerate(points):
        product = mp.mpf(1)
        for j, sj in enumerate(points):
            if j != k:
                product *= 2*(sk - sj)
        weights.append(1/product)
    return weights


def reference_signs(problem, n):
    """Signs of the levelled error along the reference; 0 at an interpolation point."""
    signs = [(-1)**k for k in range(n)]
    if problem.anchored:
        signs[0] = 0
    return signs


def gram(rows, weights):
    """The symmetric matrix sum_k weights_k rows_k rows_k'."""
    m = len(rows[0])
    out = mp.matrix(m)
    for a in range(m):
        for b in range(a + 1):
            out[a, b] = out[b, a] = mp.fsum(w*v[a]*v[b] for w, v in zip(weights, rows))
    return out


def definite_eigenpairs(a, b):
    """Eigenpairs of a q = lambda b q, a symmetric, b symmetric positive definite; smallest |lambda| first."""
    inv = mp.inverse(mp.cholesky(b))
    reduced = inv*a*inv.T
    values, vectors = mp.eigsy((reduced + reduced.T)/2)
    vectors = inv.T*vectors
    for i in sorted(range(len(values)), key=lambda i: abs(values[i])):
        yield values[i], list(vectors[:, i])


def level_reference(problem, r, reference, scale):
    """Solve F - g p/q = sign_k lambda on the reference: (lambda, p, q), Chebyshev coefficients, q(1) = 1."""
    n = len(reference)
    rows = [chebyshev_row(s, r) for s in reference]
    f = [weighted_target(problem, s, scale)[0] for s in reference]
    g = [problem.weighted_factor(s, scale)[0] for s in reference]
    signs = reference_signs(problem, n)
    d = [dk/gk for dk, gk in zip(divided_difference_weights(reference), g)]
    if d[1]*signs[1] < 0:              # a common sign makes the right-hand matrix positive definite
        d = [-dk for dk in d]
    left = gram(rows, [dk*fk for dk, fk in zip(d, f)])
    right = gram(rows, [dk*sk for dk, sk in zip(d, signs)])
    for lam, q in definite_eigenpairs(left, right):
        at_one = mp.fsum(q)            # every T_k(1) is 1
        q = [v/at_one for v in q]
        values = [chebyshev_value(q, s)[0] for s in reference]
        if min(values) > 0:
            goal = [(fk - sk*lam)*qk/gk for fk, sk, qk, gk in zip(f, signs, values, g)]
            return lam, interpolate(reference, goal, problem.numerator_degree(r)), q
    raise ArithmeticError('no denominator without a sign change')


def interpolate(points, values, degree):
    """Chebyshev coefficients of the polynomial through every second point, the first one among them.

    The levelled equations hold on all points, so any degree + 1 of them will do; the first is x = 0, where kernel sets must
    be exact."""
    m = degree + 1
    matrix = mp.matrix([chebyshev_row(points[2*k], degree) for k in range(m)])
    return list(mp.lu_solve(matrix, mp.matrix(values[0:2*m:2])))


def bracketed_root(slope, lo, hi, at_lo, at_hi):
    """Zero of slope between lo and hi, where it has the signs of at_lo and at_hi: Illinois variant of false position.

    Half the working digits are enough, because extrema are flat: an offset d changes the height by O(d^2)."""
    width = (hi - lo)*mp.mpf(10)**(-DIGITS//2)
    for _ in range(200):
        mid = (lo*at_hi - hi*at_lo)/(at_hi - at_lo)
        at_mid = slope(mid)
        if at_mid == 0 or abs(mid - hi) < width:
            return mid
        if at_mid*at_hi < 0:
            lo, at_lo = hi, at_hi
        else:
            at_lo /= 2
        hi, at_hi = mid, at_mid
    raise ArithmeticError('an extremum would not settle')


def angle_grid(problem, r):
    """Angles phi of s = cos(phi), equally spaced from x = 0 (left out where it is interpolated) to x = -inf."""
    cells = CELLS_PER_EXTREMUM*(2*r + 2)
    first = 1 if problem.anchored else 0
    return [mp.pi*k/cells for k in range(first, cells + 1)]


def extrema_by_sign(error, grid):
    """The highest point of |error| in every run of one sign, as a list of (angle, value).

    error(phi) returns value and slope; the slope may be in any variable that is monotone in phi. The grid finds the runs,
    false position on the slope then refines what is not an end of the grid."""
    samples = [error(phi) for phi in grid]
    runs = [[0]]
    for i in range(1, len(grid)):
        if samples[i][0]*samples[runs[-1][-1]][0] >= 0:
            runs[-1].append(i)
        else:
            runs.append([i])
    found = []
    for run in runs:
        i = max(run, key=lambda j: abs(samples[j][0]))
        phi = grid[i]
        if 0 < i < len(grid) - 1:
            lo, hi = (i, i + 1) if samples[i][1]*samples[i + 1][1] < 0 else (i - 1, i)
            if samples[lo][1]*samples[hi][1] < 0:
                phi = bracketed_root(lambda t: error(t)[1], grid[lo], grid[hi], samples[lo][1], samples[hi][1])
        found.append((phi, error(phi)[0]))
    return found


def relative_spread(values):
    """(largest - smallest)/largest magnitude: zero for a levelled error."""
    sizes = [abs(v) for v in values]
    return (max(sizes) - min(sizes))/max(sizes)


def cos_exact(phi):
    """cos with its end points exact: s = 1 and s = -1 are x = 0 and x = -inf."""
    if phi == 0:
        return mp.mpf(1)
    if phi == mp.pi:
        return mp.mpf(-1)
    return mp.cos(phi)


def remez(problem, r):
    """The best approximation of degree r: (lambda, p, q, scale)."""
    scale = map_scale(r)
    n = problem.n_alternation(r)
    anchor = [mp.mpf(1)] if problem.anchored else []
    total = n + len(anchor)
    reference = [cos_exact(mp.pi*k/(total - 1)) for k in range(total)]
    grid = angle_grid(problem, r)
    for _ in range(40):
        lam, p, q = level_reference(problem, r, reference, scale)
        extrema = extrema_by_sign(lambda phi: weighted_error(problem, p, q, cos_exact(phi), scale), grid)
        if len(extrema) != n:
            raise ArithmeticError('%s r = %d: %d extrema instead of %d' % (problem.name, r, len(extrema), n))
        if relative_spread([v for _, v in extrema]) < mp.mpf(10)**(-DIGITS//2):
            return abs(lam), p, q, scale
        reference = anchor + [cos_exact(phi) for phi, _ in extrema]
    raise ArithmeticError('%s r = %d: no convergence' % (problem.name, r))


# ---- partial fractions -------------------------------------------------------------------------------------------------

def partial_fractions(problem, p, q, scale):
    """a0, poles and residues in x of c = h p/q. A real pole comes first, then pairs by ascending imaginary part."""
    tiny = mp.mpf(10)**(-DIGITS//3)
    powers = chebyshev_to_powers(q)
    poles = []
    for s in mp.polyroots(powers[::-1], maxsteps=500, extraprec=4*DIGITS):
        for _ in range(2):             # polish in the Chebyshev basis
            value, slope = chebyshev_value(q, s)
            s -= value/slope
        x, dx = x_of_s(s, scale)
        # near the pole c = h p/(q' (s - s0)) and x - x0 = x' (s - s0)
        a = problem.fixed_factor(s)[0]*chebyshev_value(p, s)[0]/chebyshev_value(q, s)[1]*dx
        if abs(mp.im(x)) < tiny:
            poles.append(Pole(mp.mpc(mp.re(x), 0), mp.mpc(mp.re(a), 0), 1))
        elif mp.im(x) > 0:
            poles.append(Pole(x, a, 2))
    poles.sort(key=lambda pole: mp.im(pole.theta))
    at_end = mp.mpf(-1)
    a0 = problem.fixed_factor(at_end)[0]*chebyshev_value(p, at_end)[0]/chebyshev_value(q, at_end)[0]
    return PartialFractions(a0, poles)


def evaluate(c, x):
    """c(x) and c'(x) for real x."""
    value, slope = c.a0, mp.mpf(0)
    for theta, a, multiplicity in c.poles:
        inv = 1/(x - theta)
        term = a*inv
        value += multiplicity*mp.re(term)
        slope -= multiplicity*mp.re(term*inv)
    return value, slope


def partial_fraction_error(problem, c, phi, scale):
    """W e and its slope in x at the angle phi, from the partial fractions alone."""
    if phi == mp.pi:
        return problem.error_at_infinity(c), mp.mpf(0)
    x = -scale*mp.tan(phi/2)**2
    value, slope = evaluate(c, x)
    ex = mp.exp(x)
    w, dw = problem.weight(x)
    return w*(ex - value), w*(ex - slope) + dw*(ex - value)


def alternation(problem, r, c, scale):
    """Extrema of the weighted error of c, one per sign run, as (angle, value)."""
    return extrema_by_sign(lambda phi: partial_fraction_error(problem, c, phi, scale), angle_grid(problem, r))


def unweighted_sup(problem, r, c, scale):
    """max |e(x)|, whatever the problem's own weight is."""
    grid = angle_grid(problem, r)
    found = extrema_by_sign(lambda phi: partial_fraction_error(Uniform, c, phi, scale), grid)
    at_zero = abs(1 - evaluate(c, mp.mpf(0))[0])
    return max([at_zero] + [abs(v) for _, v in found])


def compute_set(problem, r):
    """One set, from Remez to partial fractions, in full precision."""
    sigma, p, q, scale = remez(problem, r)
    c = partial_fractions(problem, p, q, scale)
    sup = unweighted_sup(problem, r, c, scale) if problem.anchored else sigma
    return RationalSet(problem, r, scale, c, sigma, sup)


# ---- the C table -------------------------------------------------------------------------------------------------------

def to_double(value):
    """Nearest double of a multiprecision number (by way of a long decimal string, whose conversion is correctly rounded)."""
    return float(mp.nstr(value, 50))


def set_rows(rational_set):
    """The numbers of a set as doubles, row by row: a0, max |e|, max W|e|; then Re, Im of theta and of a per pole."""
    kernel = rational_set.problem.anchored
    c = rational_set.c
    rows = [[0.0 if kernel else to_double(c.a0), to_double(rational_set.sup), to_double(rational_set.sigma) if kernel else 0.0]]
    for theta, a, multiplicity in c.poles:
        rows.append([to_double(part) for part in (mp.re(theta), mp.im(theta), mp.re(a), mp.im(a))])
        if multiplicity == 1:
            rows[-1][1] = rows[-1][3] = 0.0
    return rows


def set_size(r):
    """How many doubles the table spends on degree r."""
    return 3 + 4*((r + 1)//2)


def table_text(sets):
    """The table as C source, with its marker lines."""
    lines = [BEGIN,
             '/* Computed by tools/poles.py, which also checks these digits. Each set begins with a0, max |e| and max',
             ' * W|e| (0 for uniform sets, where it would be the same). Then come Re theta, Im theta, Re a, Im a of each',
             ' * pole: the real pole first (odd r), then one of each conjugate pair by ascending Im theta. */',
             DECLARATION]
    for one in sets:
        rows = ['    ' + ', '.join('%.17g' % v for v in row) + ',' for row in set_rows(one)]
        lines += ['%s   /* %s r = %d */' % (rows[0], one.problem.name, one.degree)] + rows[1:]
    return '\n'.join(lines + ['};', END])


def parse_table(path):
    """The doubles between the marker lines of a header."""
    with open(path, encoding='utf-8') as source:
        text = source.read()
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        raise ValueError('%s: the lines %s and %s must occur once each' % (path, BEGIN, END))
    body = text[text.index(BEGIN) + len(BEGIN):text.index(END)]
    body = re.sub(r'/\*.*?\*/', ' ', body, flags=re.S)
    if body.count(DECLARATION) != 1:
        raise ValueError('%s: no "%s" between the markers' % (path, DECLARATION))
    body = body[body.index(DECLARATION) + len(DECLARATION):]
    return [float(word) for word in body[:body.index('}')].replace(',', ' ').split()]


def table_slice(table, problem, r):
    """The part of the table that belongs to one set."""
    start = 0
    for each in PROBLEMS:
        for degree in range(each.min_degree, MAX_DEGREE + 1):
            if each is problem and degree == r:
                return table[start:start + set_size(r)]
            start += set_size(degree)
    raise KeyError((problem.name, r))


def table_length():
    """Number of doubles in the complete table."""
    return sum(set_size(r) for problem in PROBLEMS for r in range(problem.min_degree, MAX_DEGREE + 1))


def from_doubles(numbers):
    """Partial fractions of one slice of the table, exactly as its doubles say."""
    poles = []
    for k in range(3, len(numbers), 4):
        theta, a = mp.mpc(numbers[k], numbers[k + 1]), mp.mpc(numbers[k + 2], numbers[k + 3])
        poles.append(Pole(theta, a, 1 if numbers[k + 1] == 0 else 2))
    return PartialFractions(mp.mpf(numbers[0]), poles)


# ---- published and settled values --------------------------------------------------------------------------------------

# sigma_r of the uniform sets: Carpenter, Ruttan & Varga 1984, here to 16 digits
PUBLISHED_SIGMA = {
    1: '6.683104216185046e-2', 2: '7.358670169580529e-3', 3: '7.993806363356878e-4', 4: '8.652240695288852e-5',
    5: '9.345713153026646e-6', 6: '1.008454374899671e-6', 7: '1.087497491375248e-7', 8: '1.172265211633491e-8',
    9: '1.263292483322314e-9', 10: '1.361120523345448e-10', 11: '1.466311194937487e-11', 12: '1.579456837051239e-12',
    13: '1.701187076340353e-13', 14: '1.832174378254041e-14'}

# weighted sigma_r of the kernel sets: the values this project settled on
KERNEL_SIGMA = {6: '1.79e-5', 7: '2.17e-6', 8: '2.59e-7', 10: '3.59e-9', 12: '4.83e-11', 14: '6.36e-13'}

# theta as (Re, Im). Uniform 14: Pusa 2012, here to 14 digits; its residues likewise. The other two: settled values.
THETA = {
    ('uniform', 7): [('2.94109692', '0'), ('2.42319635', '2.39302931'), ('0.757608634', '4.84361851'),
                     ('-2.57572609', '7.48097743')],
    ('kernel', 8): [('2.5778411129', '1.0959438169'), ('1.6292171157', '3.3086435835'), ('-0.4298346048', '5.5940888506'),
                    ('-4.1592354425', '8.0717415744')],
    ('uniform', 14): [('5.6231425727460', '1.1940690463440'), ('5.0893450605806', '3.5888240290270'),
                      ('3.9933697105786', '6.0048316422350'), ('2.2697838292311', '8.4617379730402'),
                      ('-0.20875863825013', '10.991260561901'), ('-3.7032750494234', '13.656371871483'),
                      ('-8.8977731864689', '16.630982619902')]}
RESIDUES = {
    ('uniform', 14): [('-27.875161940146', '-102.14733999056'), ('46.933274488831', '45.643649768828'),
                      ('-23.498232091083', '-5.8083591297142'), ('4.8071120988325', '-1.3209793837429'),
                      ('-0.37636003878227', '0.33518347029450'), ('0.0094390253107362', '-0.017184791958483'),
                      ('-7.1542880635891e-5', '1.4361043349542e-4')]}
A0 = {('uniform', 7): '-1.0874975e-7', ('uniform', 14): '1.832174378254e-14'}


def agrees(value, printed):
    """Is printed the value rounded to the digits it shows? One unit of slack, for values rounded twice or cut off."""
    if printed == '0':
        return value == 0
    mantissa, _, exponent = printed.partition('e')
    decimals = len(mantissa.partition('.')[2])
    return abs(value - mp.mpf(printed)) <= mp.mpf(10)**(int(exponent or 0) - decimals)


# ---- checks ------------------------------------------------------------------------------------------------------------

class Checker:
    """Counts checks and remembers what the failed ones of the current set were."""

    def __init__(self):
        self.passed = self.failed = 0
        self.complaints = []

    def check(self, good, what):
        if good:
            self.passed += 1
        else:
            self.failed += 1
            self.complaints.append(what)

    def finish_line(self, line):
        print(line + ('  ok' if not self.complaints else '  FAILED'))
        for what in self.complaints:
            print('    failed: ' + what)
        sys.stdout.flush()
        self.complaints = []


def check_optimality(checker, one):
    """Alternation of the right length, signs and height proves a best approximation (de la Vallee Poussin). Text."""
    expected = one.problem.n_alternation(one.degree)
    values = [v for _, v in alternation(one.problem, one.degree, one.c, one.scale)]
    spread = relative_spread(values)
    checker.check(len(values) == expected, '%d alternation points instead of %d' % (len(values), expected))
    checker.check(all(u*v < 0 for u, v in zip(values, values[1:])), 'the error does not alternate in sign')
    checker.check(spread < mp.mpf(10)**-30, 'not levelled: relative spread %s' % mp.nstr(spread, 3))
    checker.check(abs(max(map(abs, values))/one.sigma - 1) < mp.mpf(10)**-30, 'height and lambda differ')
    return 'alternation %2d/%d spread %s' % (len(values), expected, mp.nstr(spread, 1))


def check_structure(checker, one):
    """Number of poles, none of them on the half line, and the exact side conditions of the family."""
    poles = one.c.poles
    checker.check(sum(pole.multiplicity for pole in poles) == one.degree, 'poles and degree do not match')
    checker.check(sum(pole.multiplicity == 1 for pole in poles) == one.degree % 2, 'wrong number of real poles')
    checker.check(all(mp.im(pole.theta) > 0 or mp.re(pole.theta) > 0 for pole in poles), 'a pole on the half line')
    at_zero = evaluate(one.c, mp.mpf(0))[0]
    if one.problem.anchored:
        checker.check(one.c.a0 == 0, 'a0 is not zero')
        checker.check(abs(at_zero - 1) < mp.mpf(10)**-50, 'c(0) is not 1')
    else:
        checker.check(abs(abs(one.c.a0)/one.sigma - 1) < mp.mpf(10)**-30, '|a0| is not sigma')
        checker.check(abs(abs(at_zero - 1)/one.sigma - 1) < mp.mpf(10)**-30, '|c(0) - 1| is not sigma')


def check_published(checker, one):
    """Everything we know from print about this set."""
    key = (one.problem.name, one.degree)
    sigma = {'uniform': PUBLISHED_SIGMA, 'kernel': KERNEL_SIGMA}.get(one.problem.name, {}).get(one.degree)
    if sigma:
        checker.check(agrees(one.sigma, sigma), 'sigma %s, published %s' % (mp.nstr(one.sigma, 17), sigma))
    if key in A0:
        checker.check(agrees(one.c.a0, A0[key]), 'a0 %s, published %s' % (mp.nstr(one.c.a0, 17), A0[key]))
    for name, known, ours in (('theta', THETA, [pole.theta for pole in one.c.poles]),
                              ('a', RESIDUES, [pole.residue for pole in one.c.poles])):
        for value, (real, imag) in zip(ours, known.get(key, [])):
            good = agrees(mp.re(value), real) and agrees(mp.im(value), imag)
            checker.check(good, '%s %s, published %s %s' % (name, mp.nstr(value, 17), real, imag))


def rounding_bound(problem, c, phi, scale):
    """Largest possible |W (c - rounded c)| at the angle phi, to first order, when every number is off by half an ulp."""
    u = mp.mpf(2)**-53
    if phi == mp.pi:
        if problem is Uniform:
            return u*abs(c.a0)
        return u*(1 + problem.rise)*mp.fsum(pole.multiplicity*abs(mp.re(pole.residue)) for pole in c.poles)
    x = -scale*mp.tan(phi/2)**2
    total = abs(c.a0)
    for theta, a, multiplicity in c.poles:
        distance = abs(x - theta)
        total += multiplicity*abs(a)/distance*(1 + abs(theta)/distance)
    return u*problem.weight(x)[0]*total


def check_digits(checker, one, table):
    """The header's digits: equal to ours, and how far the function of exactly these doubles is from exp. Text."""
    ours = [v for row in set_rows(one) for v in row]
    wrong = [k for k in range(len(ours)) if table[k] != ours[k]]
    shown = ', '.join('number %d: table %r, computed %r' % (k, table[k], ours[k]) for k in wrong[:3])
    checker.check(not wrong, '%d of %d numbers differ; %s' % (len(wrong), len(ours), shown))
    rounded = from_doubles(table)
    slack = 1 + mp.mpf(10)**-6         # the bound is of first order
    found = alternation(one.problem, one.degree, rounded, one.scale)
    good = all(abs(v) <= one.sigma + slack*rounding_bound(one.problem, one.c, phi, one.scale) for phi, v in found)
    checker.check(good, 'the error of the printed digits exceeds sigma by more than rounding explains')
    defect = evaluate(rounded, mp.mpf(0))[0] - 1
    text = 'table %d/%d equal, as printed:' % (len(ours) - len(wrong), len(ours))
    sup = unweighted_sup(one.problem, one.degree, rounded, one.scale)
    text += ' sup|e| %s' % mp.nstr(sup, 5)
    if one.problem.anchored:
        weighted = max(abs(v) for _, v in found)
        text += ' weighted %s c(0)-1 %s' % (mp.nstr(weighted, 5), mp.nstr(defect, 2))
        checker.check(abs(defect) <= slack*rounding_bound(one.problem, one.c, mp.mpf(0), one.scale),
                      'c(0) - 1 = %s is more than rounding' % mp.nstr(defect, 3))
    return text


def check_all(problems, max_degree, header):
    """Recompute and verify; True if all is well."""
    checker = Checker()
    table = []
    try:
        table = parse_table(header)
    except (OSError, ValueError) as trouble:
        checker.check(False, str(trouble))
    complete = len(table) == table_length()
    checker.check(complete, 'the table has %d numbers instead of %d' % (len(table), table_length()))
    checker.finish_line('table: %d numbers' % len(table))
    for problem in problems:
        for r in range(problem.min_degree, max_degree + 1):
            try:
                one = compute_set(problem, r)
                text = check_optimality(checker, one)
                check_structure(checker, one)
                check_published(checker, one)
                text += '  sigma %s' % mp.nstr(one.sigma, 17, min_fixed=0, max_fixed=0)
                if complete:           # otherwise the first line has failed already
                    text += '  ' + check_digits(checker, one, table_slice(table, problem, r))
            except ArithmeticError as trouble:
                checker.check(False, str(trouble))
                text = 'not computed'
            checker.finish_line('%-7s r = %2d: %s' % (problem.name, r, text))
    print('%d passed, %d failed' % (checker.passed, checker.failed))
    return checker.failed == 0


# ---- command line ------------------------------------------------------------------------------------------------------

def parse_arguments():
    parser = argparse.ArgumentParser(description='Poles and residues of the rational functions in heatdiff.h: '
                                     'without options the C table, with --check a verification of it.')
    default = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, 'heatdiff.h')
    parser.add_argument('--check', nargs='?', const=os.path.normpath(default), metavar='heatdiff.h',
                        help='recompute, verify, compare with the table in this header')
    parser.add_argument('--kind', choices=[problem.name for problem in PROBLEMS], help='only this family')
    parser.add_argument('--max-degree', type=int, default=MAX_DEGREE, metavar='R', help='up to this degree (default %(default)s)')
    arguments = parser.parse_args()
    if not 1 <= arguments.max_degree <= MAX_DEGREE:
        parser.error('--max-degree must be within 1..%d' % MAX_DEGREE)
    return arguments


def main():
    arguments = parse_arguments()
    mp.mp.dps = DIGITS
    problems = [problem for problem in PROBLEMS if arguments.kind in (None, problem.name)]
    if arguments.check:
        return 0 if check_all(problems, arguments.max_degree, arguments.check) else 1
    print(table_text([compute_set(problem, r) for problem in problems
                      for r in range(problem.min_degree, arguments.max_degree + 1)]))
    return 0


if __name__ == '__main__':
    sys.exit(main())
