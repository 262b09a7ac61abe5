"""Independent reference for the transverse eigenvalues of the linearised Cosserat rod (mpmath only, no mesh).

Units L = k3 = gamma2 = 1.  For exp(w t) the state x = (y, theta, s, m = theta') obeys x' = A x with
    y' = nu theta + c2 s,   theta' = m,   s' = w y + F m,   m' = gamma3 w theta - p s,
    c1 = 1/k1,  c2 = 1/k2,  nu = 1 - F c1,  p = nu + F c2        (k1 or k2 = inf: the compliance is 0),
y = theta = 0 at u = 0 and s = m = 0 at u = 1.  The eigenvalues are exactly the zeros of the entire function
    D(w) = det [exp(A)]_{(s,m),(s,m)},        D(0) = 1.
Two evaluations that share nothing but A: `D` (propagator from its Taylor series) and `D_wedge` (closed
form of the
second compound).  Parameters may be int, float, str ('inf' allowed) or mpf; floats are exact.
"""

import mpmath as mp


def coefficients(F, k1, k2, gamma3):
    """F, c2, gamma3, nu, p at the working precision."""
    F, k1, k2, g = (mp.mpf(x) for x in (F, k1, k2, gamma3))
    c1, c2 = (mp.mpf(0) if mp.isinf(k) else 1 / k for k in (k1, k2))
    nu = 1 - F * c1
    return F, c2, g, nu, nu + F * c2


def wavenumbers(w, F, c2, g, nu, p):
    """-a and b of the characteristic polynomial q^4 + a q^2 + b of A."""
    return (c2 + g) * w - F * p, w * (c2 * g * w + nu * p)


def largest_q(w, *c):
    t, b = wavenumbers(w, *c)
    r = mp.sqrt(t * t - 4 * b)
    return float(mp.sqrt(max(abs(t + r), abs(t - r)) / 2))


def D(w, F, k1, k2, gamma3, digits=40):
    """D(w), absolute error below 10^-digits times the size exp(Re q1 + Re q2) of its terms.

    exp(A) = C + A S with C = cosh A, S = sinh(A)/A even in A; their series live in span(1, B), B = A^2,
    because
    B^2 = t B - b (Cayley-Hamilton), so only scalars are summed and nothing branches."""
    with mp.workdps(15):
        q = largest_q(mp.mpmathify(w), *coefficients(F, k1, k2, gamma3))
    with mp.workdps(digits + 15 + int(1.8 * q)):  # terms grow like exp(q), the determinant cancels exp(2 q)
        F, c2, g, nu, p = c = coefficients(F, k1, k2, gamma3)
        w = mp.mpmathify(w)
        t, b = wavenumbers(w, *c)
        u, v, n, f = mp.mpf(1), mp.mpf(0), 0, mp.mpf(1)  # B^n / (2n)! = u + v B
        C0 = C1 = S0 = S1 = mp.mpf(0)
        tiny = mp.mpf(10) ** (-mp.mp.dps - 5)
        while n <= q or abs(u) + abs(v) > tiny:
            C0 += u
            C1 += v
            S0 += u / (2 * n + 1)
            S1 += v / (2 * n + 1)
            n += 1
            f = 2 * n * (2 * n - 1)
            u, v = -b * v / f, (u + t * v) / f
        # rows s and m of A, A^2 and A^3, columns s and m
        a33, a44 = c2 * w - p * F, g * w - p * F
        ss, mm = C0 + C1 * a33, C0 + C1 * a44
        sm = S0 * F + S1 * (p * w + F * a44)
        ms = -S0 * p - S1 * p * (g * w + a33)
        return ss * mm - sm * ms


def D_wedge(w, F, k1, k2, gamma3, digits=40):
    """The same number from derivatives of D at u = 0 and the compound's eigenvalues 0, 0, +-q1 +- q2."""
    with mp.workdps(2 * digits + 20):
        F, c2, g, nu, p = c = coefficients(F, k1, k2, gamma3)
        w = mp.mpmathify(w)
        if w == 0:
            return mp.mpf(1)
        t, b = wavenumbers(w, *c)
        root = 2 * mp.sqrt(b)
        S, Z = t + root, t - root  # (q1 + q2)^2, (q1 - q2)^2
        a33, a44 = c2 * w - p * F, g * w - p * F
        d1 = (c2 + g) * w
        d2 = (
            a33**2
            + a44**2
            - p * w * (nu + F * g + p)
            + 6 * a33 * a44
            + 4 * (F * p * ((g + c2) * w - F * p) + p * (p * w + F * a44))
        )

        def phi(z):
            return 2 * mp.sinh(mp.sqrt(z) / 2) ** 2 / z if z else mp.mpf(1) / 2

        return 1 + ((d2 - d1 * Z) * phi(S) + (d1 * S - d2) * phi(Z)) / (S - Z)


def refine(w, F, k1, k2, gamma3, digits=30, det=D):
    """The zero of D next to w to `digits` digits: secant steps in doubled precision, for close pairs."""
    work = 2 * digits + 10
    with mp.workdps(work):
        w0 = mp.mpmathify(w)
        real = mp.im(w0) == 0
        w1 = w0 * (1 + mp.mpf(10) ** -8)
        d0, d1 = (det(x, F, k1, k2, gamma3, work) for x in (w0, w1))
        for _ in range(60):
            if d1 == d0:
                break
            w0, d0, w1 = w1, d1, w1 - d1 * (w1 - w0) / (d1 - d0)
            if abs(w1 - w0) < abs(w1) * mp.mpf(10) ** -(digits + 5):
                break
            d1 = det(w1, F, k1, k2, gamma3, work)
        else:
            raise ArithmeticError(f"no convergence from {w}")
        w1 = mp.re(w1) if real else w1
    with mp.workdps(digits):
        return +w1
