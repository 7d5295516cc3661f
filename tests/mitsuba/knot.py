"""Writes scenes/knot.obj: a torus knot of flat triangles."""

from math import cos, pi, sin
from pathlib import Path

import numpy as np

STEPS, SIDES = 64, 8
RADIUS = 0.26


def center(turn):
    """A point of the curve that winds twice around the axis while it goes three times around the torus."""
    reach = 0.85 + 0.35 * cos(3 * turn)
    return np.array([reach * cos(2 * turn), reach * sin(2 * turn), 0.45 * sin(3 * turn)])


def ring(turn):
    along = center(turn + 1e-4) - center(turn - 1e-4)
    across = np.cross(along, [0, 0, 1])
    across /= np.linalg.norm(across)
    up = np.cross(across, along)
    up /= np.linalg.norm(up)
    angles = [2 * pi * side / SIDES for side in range(SIDES)]
    return [center(turn) + RADIUS * (cos(a) * across + sin(a) * up) for a in angles]


def main():
    lines = ["# A torus knot of flat triangles, its front outside; written by knot.py."]
    for step in range(STEPS):
        lines += ["v %.4f %.4f %.4f" % tuple(p) for p in ring(2 * pi * step / STEPS)]
    for step in range(STEPS):
        for side in range(SIDES):
            here, there = step, (step + 1) % STEPS
            next_side = (side + 1) % SIDES
            a, b = here * SIDES + side + 1, here * SIDES + next_side + 1
            c, d = there * SIDES + side + 1, there * SIDES + next_side + 1
            lines += [f"f {a} {b} {d}", f"f {a} {d} {c}"]
    path = Path(__file__).parent / "scenes" / "knot.obj"
    path.write_text("\n".join(lines) + "\n")


main()
