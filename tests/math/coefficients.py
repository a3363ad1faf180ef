#!/usr/bin/env python3
"""Prints the coefficients of the polynomials in pipeline/math.

Each polynomial P approximates g on an interval so that the largest weight(t) * |P(t) - g(t)| is nearly the smallest there is.
The weight turns P's error into the relative error of the function it serves. Coefficients are rounded to binary32 one
after another, lowest power first, and the rest is fitted again to what that rounding left: better than rounding all at once.

Needs mpmath.
"""
import struct
from mpmath import mp, mpf, matrix, lu_solve, log, exp, sin, cos, asin, atan, atanh, sqrt, pi

mp.dps = 40


def to_float(value):
    """The nearest binary32."""
    return mpf(struct.unpack('f', struct.pack('f', float(value)))[0])


def to_hex(value):
    """A C hexadecimal literal for a binary32 value."""
    mantissa, exponent = float(value).hex().split('p')
    mantissa = mantissa.rstrip('0').rstrip('.') if '.' in mantissa else mantissa
    return f'{mantissa}p{int(exponent)}f'


def minimax(samples, powers, rounds=80):
    """Coefficients of sum c[i] t^powers[i] with nearly the smallest weighted maximum error over (t, g(t), weight(t)) samples.

    Lawson's algorithm: least squares, again and again, with each sample weighted more the larger its error was.
    """
    n = len(powers)
    rows = [[w * t**p for p in powers] + [w * v] for t, v, w in samples]
    importance = [mpf(1) / len(rows)] * len(rows)
    best, least = None, mpf('inf')
    for _ in range(rounds):
        system, right = matrix(n, n), matrix(n, 1)
        for i in range(n):
            for j in range(i, n):
                system[i, j] = system[j, i] = sum(u * row[i] * row[j] for u, row in zip(importance, rows))
            right[i] = sum(u * row[i] * row[n] for u, row in zip(importance, rows))
        solution = lu_solve(system, right)
        errors = [abs(sum(solution[i] * row[i] for i in range(n)) - row[n]) for row in rows]
        if max(errors) < least:
            best, least = [solution[i] for i in range(n)], max(errors)
        importance = [u * e for u, e in zip(importance, errors)]
        total = sum(importance)
        importance = [u / total for u in importance]
    return best


def fit(name, g, weight, low, high, count):
    low, high = mpf(low), mpf(high)
    grid = [(low + high) / 2 - (high - low) / 2 * cos(pi * (i + mpf(1) / 2) / 100) for i in range(100)] + [low, high]
    exact = [(t, g(t), weight(t)) for t in grid]
    fixed = []
    for first in range(count):
        rest = [(t, v - sum(c * t**i for i, c in enumerate(fixed)), w) for t, v, w in exact]
        fixed.append(to_float(minimax(rest, range(first, count))[0]))
    points = [low + (high - low) * i / 2001 for i in range(2002)]
    worst = max(abs(weight(t) * (sum(c * t**i for i, c in enumerate(fixed)) - g(t))) for t in points)
    print(f'{name}: relative error 2^{float(log(worst, 2)):.2f}')
    print('    ' + ', '.join(to_hex(c) for c in fixed), flush=True)


def near_zero(formula, series, radius=mpf('1e-12')):
    """Formulas of the kind (f(t) - t) / t^3 at 0."""
    return lambda t: series if abs(t) < radius else formula(t)


ln2, root2 = log(mpf(2)), sqrt(mpf(2))
# The reductions' rounding lets arguments stray a little beyond the exact ends.
half_ln2, half, quarter_pi = ln2 / 2 * mpf('1.0002'), mpf('0.5001'), pi / 4 * mpf('1.0005')


def odd(function, name, third, end, count):
    """For functions that are x + x^3 P(x^2)."""
    fit(f'{name}(x) = x + x^3 P(z), z = x^2', near_zero(lambda z: (function(sqrt(z)) / sqrt(z) - 1) / z, third),
        lambda z: z * sqrt(z) / function(sqrt(z)) if z else mpf(0), 0, end**2, count)


fit('exp(r) = 1 + r + r^2 P(r)', near_zero(lambda r: (exp(r) - 1 - r) / r**2, mpf(1) / 2), lambda r: r**2 / exp(r), -half_ln2, half_ln2, 5)
fit('exp2(f) = 1 + f / 2 + f P(f)', near_zero(lambda f: (exp(f * ln2) - 1) / f - mpf(1) / 2, ln2 - mpf(1) / 2),
    lambda f: f / exp(f * ln2), -half, half, 6)
fit('log(1 + f) = f - f^2 / 2 + f^3 P(f)', near_zero(lambda f: (log(1 + f) - f + f**2 / 2) / f**3, mpf(1) / 3),
    lambda f: f**3 / log(1 + f) if f else mpf(0), 1 / root2 - 1, root2 - 1, 9)
fit('3 atanh(s) / s = 3 + z + z^2 P(z), z = s^2 (in pow)', near_zero(lambda z: (3 * atanh(sqrt(z)) / sqrt(z) - 3 - z) / z**2, mpf(3) / 5),
    lambda z: z**2 / 3, 0, mpf('0.02945'), 4)
odd(sin, 'sin', -mpf(1) / 6, quarter_pi, 3)
fit('cos(x) = 1 - z / 2 + z^2 P(z), z = x^2', near_zero(lambda z: (cos(sqrt(z)) - 1 + z / 2) / z**2, mpf(1) / 24),
    lambda z: z**2 / cos(sqrt(z)), 0, quarter_pi**2, 3)
odd(asin, 'asin', mpf(1) / 6, mpf(1) / 2, 5)
odd(atan, 'atan', -mpf(1) / 3, mpf(1) / 2, 6)
