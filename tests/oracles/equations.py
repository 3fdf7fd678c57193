"""Expected equations for tests/it/equations.rs, by SymPy: python3 equations.py > equations.json

The chains of the three papers are multiplied out with SymPy's matrices, nothing of the program is used,
and compared with the formulas of the papers as corrected in docs/misprints.md. Every polynomial is
written as a list of [coefficient, {symbol: power}].
"""

import json
import sys

from sympy import Matrix, Poly, Rational, cos, diff, expand, eye, sin, symbols, sympify, zeros

t = symbols("t")


def trans(x, y, z):
    m = eye(4)
    m[0, 3], m[1, 3], m[2, 3] = x, y, z
    return m


def hat(a, b, c):
    return Matrix([[0, -c, b], [c, 0, -a], [-b, a, 0]])


def small(d, e):
    """The linearised matrix of six errors, as large as t."""
    m = eye(4)
    m[:3, :3] = eye(3) + t * hat(*e)
    m[:3, 3] = t * Matrix(d)
    return m


def rot(axis, s, c):
    m = eye(4)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    m[i, i] = m[j, j] = c
    m[i, j], m[j, i] = -s, s
    return m


def iso(axis, zero=""):
    names = [symbols(f"E{d}{zero}{axis}") for d in "XYZABC"]
    return small(names[:3], names[3:])


def order(expression, n):
    """The coefficient of t^n."""
    return expand(diff(expression, t, n).subs(t, 0)) / sympify(1 if n < 2 else 2)


def terms(expression):
    expression = expand(expression)
    if expression == 0:
        return []
    free = sorted(expression.free_symbols, key=str)
    if not free:
        return [[float(expression), {}]]
    poly = Poly(expression, *free)
    name = lambda s: str(s).replace("sin_", "sin(").replace("cos_", "cos(") + (")" if "_" in str(s) else "")
    power = lambda powers: {name(s): p for s, p in zip(free, powers) if p}
    return [[float(c), power(powers)] for powers, c in poly.terms()]


def matrix_terms(m):
    """First order: the ideal matrix and the part of order 1."""
    return [[terms(order(m[i, j], 0) + order(m[i, j], 1)) for j in range(4)] for i in range(3)]


# The formulas of the 2015 paper: (component, order).
PRINTED = {
    (0, 1): "a*x + L*(f1*x + g3*y + h3*z) + z*(f1*x + g3*y) + Syz*z*(f2*x + g2*y) - f2*x*y - f2*x + g2*y**2/2 - g2*y"
    " + h2*z**2/2 - h2*z",
    (1, 1): "b*y + f1*x**2/2 - Sxz*z*(f2*x + g2*y) - f2*Sxy*x*y + f2*x - L*(f3*x + g1*y + h1*z) - z*(f3*x + g1*y)"
    " + g2*y + h1*z**2/2 + h2*z",
    (2, 1): "c*z + Sxz*z*(f1*x + g3*y) + f1*Sxy*x*y - f1*x + f2*x**2/2 - Syz*z*(f3*x + g1*y) + f3*x*y + f3*x"
    " + g1*y**2/2 + g1*y - g3*y + h1*z - h3*z",
}
RIGHT = {
    (0, 0): "-Sxy*y - Sxz*z",
    (1, 0): "-Syz*z",
    (2, 0): "0",
    (0, 1): "a*x + L*(f1*x + g3*y + h3*z) + z*(f1*x + g3*y) + Syz*z*(f2*x + g2*y) - f2*x*y - g2*y**2/2 + h3*z**2/2",
    (1, 1): "b*y + f2*x**2/2 - Sxz*z*(f2*x + g2*y) - f2*Sxy*x*y - L*(f3*x + g1*y + h1*z) - z*(f3*x + g1*y)"
    " - h1*z**2/2",
    (2, 1): "c*z + Sxz*z*(f1*x + g3*y) + f1*Sxy*x*y - f1*x**2/2 - Syz*z*(f3*x + g1*y) + f3*x*y + g1*y**2/2",
    (0, 2): "L*(f2*g1*x*y + f2*h1*x*z + g2*h1*y*z) - b*f2*x*y + f1*g1*x*y**2/2 + z**2*(f2*h1*x + g2*h1*y)/2"
    " + z*(Sxz*f1*g3*x*y + Sxz*f2*g2*x*y - Syz*f1*g1*x*y + c*f1*x + c*g3*y + f2*g1*x*y)",
    (1, 2): "L*(f2*g3*x*y + f2*h3*x*z + g2*h3*y*z) - c*z*(f3*x + g1*y) - (f2*g2 + f3*g1)*x*y**2/2"
    " + z**2*(f2*h3*x + g2*h3*y)/2 + z*(Syz*f2*g2*x*y + Syz*f3*g1*x*y - Sxz*f3*g3*x*y + f2*g3*x*y)",
    (2, 2): "-L*(f1*g3*x*y + f3*g1*x*y + f1*h3*x*z + f3*h1*x*z + g3*h3*y*z + g1*h1*y*z) + b*f3*x*y + f1*g2*x*y**2/2"
    " - z**2*(f1*h3*x + f3*h1*x + g3*h3*y + g1*h1*y)/2"
    " - z*(Sxz*f3*g2*x*y + Syz*f1*g2*x*y + f1*g3*x*y + f3*g1*x*y)",
}


def holub(printed):
    x, y, z, L = symbols("x y z L")
    a, b, c, f1, f2, f3, g1, g2, g3, h1, h2, h3 = symbols("a b c f1 f2 f3 g1 g2 g3 h1 h2 h3")
    sxy, sxz, syz = symbols("Sxy Sxz Syz")
    half = Rational(1, 2)
    if printed:
        straight = (f1 * x**2, f2 * x**2, g1 * y**2, g2 * y**2, h1 * z**2, h2 * z**2)
        tip = Matrix([1, 1, L, 1])
    else:
        straight = (f2 * x**2, -f1 * x**2, g1 * y**2, -g2 * y**2, -h1 * z**2, h3 * z**2)
        tip = Matrix([0, 0, L, 1])
    dyx, dzx, dzy, dxy, dyz, dxz = (half * s for s in straight)
    ex = small((a * x, dyx, dzx), (f3 * x, f1 * x, f2 * x))
    ey = small((dxy, b * y, dzy), (g1 * y, g3 * y, g2 * y))
    ez = small((dxz, dyz, c * z), (h1 * z, h3 * z, h2 * z))
    ey[0, 3] -= sxy * y
    ez[0, 3] -= sxz * z
    ez[1, 3] -= syz * z
    real = trans(x, 0, 0) * ex * trans(0, y, 0) * ey * trans(0, 0, z) * ez * tip
    d = (real - trans(x, y, z) * tip).applyfunc(expand)
    for (i, n), formula in (PRINTED if printed else RIGHT).items():
        assert expand(order(d[i], n) - sympify(formula)) == 0, (printed, i, n)
    return {f"D{'xyz'[i]}": [terms(order(d[i], n)) for n in range(3)] for i in range(3)}


def inverse_to_first_order(m):
    """Of a motion whose real part is a rotation."""
    real, part = m.subs(t, 0), diff(m, t).subs(t, 0)
    back = eye(4)
    back[:3, :3] = real[:3, :3].T
    back[:3, 3] = -real[:3, :3].T * real[:3, 3]
    return back - t * back * part * back


def circle(expression, names):
    for name in names:
        s, c = symbols(f"sin_{name} cos_{name}")
        expression = expand(expand(expression).subs(s**2, 1 - c**2))
    return expression


def kimm():
    X, Y, Z = symbols("X Y Z")
    angle = {n: symbols(f"sin_{n} cos_{n}") for n in "ABC"}
    way = {"X": trans(X, 0, 0), "Y": trans(0, Y, 0), "Z": trans(0, 0, Z)}
    turn = {n: rot("xyz"["ABC".index(n)], *angle[n]) for n in "ABC"}
    motion = {**{n: way[n] * iso(n) for n in way}, **{n: iso(n) * turn[n] for n in turn}}
    placed = {n: iso(n, "0") * {**way, **turn}[n] for n in motion}
    whole = {n: iso(n, "0") * motion[n] for n in motion}
    tool = (whole["X"] * whole["Z"]).applyfunc(lambda e: order(e, 0) + t * order(e, 1))
    work = (whole["Y"] * whole["A"] * whole["C"]).applyfunc(lambda e: order(e, 0) + t * order(e, 1))
    e_ve = (inverse_to_first_order(tool) * work).applyfunc(lambda e: circle(order(e, 1), "AC"))
    # Equation (3): R(theta + eps_own) to first order is the stationary error on the left.
    theta, own = symbols("theta own")
    assert diff(cos(theta + t * own), t).subs(t, 0) == -own * sin(theta)
    return {
        "motion": {n: matrix_terms(m) for n, m in motion.items()},
        "placed": {n: matrix_terms(m) for n, m in placed.items()},
        "e_ve": [[terms(e_ve[i, j]) for j in range(4)] for i in range(3)],
    }


def hrdina():
    X, Y, Z = symbols("X Y Z")
    s, c = symbols("sin_A cos_A")
    squared = {"X": iso("X"), "Y": iso("Y"), "Z": iso("Z")}
    squared["Y"][0, 3] -= t * symbols("EC0Y") * Y
    squared["Z"][0, 3] += t * symbols("EB0Z") * Z
    squared["Z"][1, 3] -= t * symbols("EA0Z") * Z
    one = {"X": trans(X, 0, 0) * squared["X"], "Y": trans(0, Y, 0) * squared["Y"], "Z": trans(0, 0, Z) * squared["Z"]}
    two = iso("A") * rot("x", s, c)
    five = iso("X") * trans(X, 0, 0) * iso("Y") * trans(0, Y, 0)
    # (5), corrected: x1 + x2 - (a1 + a2) ybar, and the usual sign of gamma throughout.
    a1, a2, g1, g2, b1 = symbols("ECX ECY EAX EAY EBX")
    assert expand(order(five[0, 3], 1) - (symbols("EXX") + symbols("EXY") - (a1 + a2) * Y)) == 0
    assert expand(order(five[2, 3], 1) - (symbols("EZX") + symbols("EZY") - b1 * X + (g1 + g2) * Y)) == 0
    chain = trans(0, Y, 0) * iso("Y") * two
    # (36), corrected: k tan(phi) is EAA sin(phi), k is EAA cos(phi), beta = -EB.
    a, b, k, gamma = symbols("ECY") + symbols("ECA"), -symbols("EBY") - symbols("EBA"), symbols("EAA"), symbols("EAY")
    rows = [
        [1, -(a * c + b * s) * t, (a * s - b * c) * t, (symbols("EXY") + symbols("EXA")) * t],
        [a * t, c - (k * s + gamma * s) * t, -s - (k * c + gamma * c) * t, Y + (symbols("EYY") + symbols("EYA")) * t],
        [b * t, s + (k * c + gamma * c) * t, c - (k * s + gamma * s) * t, (symbols("EZY") + symbols("EZA")) * t],
    ]
    for i in range(3):
        for j in range(4):
            gap = order(chain[i, j], 0) + order(chain[i, j], 1) - sympify(rows[i][j]).subs(t, 1)
            assert expand(gap) == 0, (i, j, gap)
    return {
        "1": {n: matrix_terms(m) for n, m in one.items()},
        "2": matrix_terms(two),
        "5": matrix_terms(five),
        "36": matrix_terms(chain),
    }


json.dump({"holub_right": holub(False), "holub_printed": holub(True), "kimm": kimm(), "hrdina": hrdina()}, sys.stdout, indent=None, separators=(",", ":"))
sys.stdout.write("\n")
