# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
"""The lens adjustment's test problem, solved by SciPy: a second opinion on parameters and covariance.

python3 tests/reference/lens_least_squares.py      (numpy, scipy)

Prints fx, fy, cx, cy, k1..k4, the noise of a coordinate, and the covariance's upper triangle, which
tests/unit/calibration/lens_least_squares_test.cpp holds.
"""
import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

LENS = np.array([300.0, 300.9, 411.0, 387.0, -0.02, 0.004, -0.001, 0.0001])
VIEWS, COLUMNS, ROWS, PITCH_MM = 10, 7, 6, 40.0


def pose(view):
    """Angle-axis and translation: boards around the field, each with a tilt of its own."""
    azimuth, off_axis = 2.4 * view, 0.15 + 0.09 * view
    sight = np.array([np.sin(off_axis) * np.cos(azimuth), np.sin(off_axis) * np.sin(azimuth), np.cos(off_axis)])
    rotation = np.array([0.5 * np.sin(1.7 * view), 0.5 * np.cos(2.3 * view), 0.3 * view])
    return rotation, 350.0 * sight - Rotation.from_rotvec(rotation).apply([120.0, 100.0, 0.0])


def project(lens, points):
    fx, fy, cx, cy, k1, k2, k3, k4 = lens
    h = np.hypot(points[:, 0], points[:, 1])
    t = np.arctan2(h, points[:, 2])
    d = t * (1 + k1 * t**2 + k2 * t**4 + k3 * t**6 + k4 * t**8)
    return np.column_stack([cx + fx * d * points[:, 0] / h, cy + fy * d * points[:, 1] / h])


def board():
    return np.array([[PITCH_MM * c, PITCH_MM * r, 0.0] for r in range(ROWS) for c in range(COLUMNS)])


def noise(count):
    """Uniform in ±0.25 px, by the generator of Numerical Recipes."""
    state, out = 1, []
    for _ in range(count):
        state = (1664525 * state + 1013904223) % 2**32
        out.append(0.5 * (state / 2**32 - 0.5))
    return np.array(out)


def main():
    target = board()
    poses = [pose(v) for v in range(VIEWS)]
    pixels = [project(LENS, Rotation.from_rotvec(r).apply(target) + t) for r, t in poses]
    errors = noise(2 * VIEWS * len(target)).reshape(VIEWS, -1, 2)
    measured = [p + e for p, e in zip(pixels, errors)]

    def residuals(x):
        out = []
        for v in range(VIEWS):
            r, t = x[8 + 6 * v:11 + 6 * v], x[11 + 6 * v:14 + 6 * v]
            out.append(project(x[:8], Rotation.from_rotvec(r).apply(target) + t) - measured[v])
        return np.concatenate(out).ravel()

    start = np.concatenate([LENS] + [np.concatenate(p) for p in poses])
    solved = least_squares(residuals, start, method="lm", jac="3-point", x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15)
    noise2 = 2 * solved.cost / (len(solved.fun) - len(start))
    covariance = noise2 * np.linalg.inv(solved.jac.T @ solved.jac)[:8, :8]
    print("parameters", ", ".join(f"{v:.10g}" for v in solved.x[:8]))
    print(f"noise_px {np.sqrt(noise2):.10g}")
    for row in range(8):
        print("covariance", row, ", ".join(f"{v:.8g}" for v in covariance[row, row:]))


if __name__ == "__main__":
    main()
