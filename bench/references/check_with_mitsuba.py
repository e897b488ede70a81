#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
"""check_with_mitsuba.py FOLDER REFERENCES [SIDE]: the stored references against Mitsuba 3.

FOLDER holds the judged scenes and their light (make_references scenes FOLDER). Mitsuba intersects, samples the
environment and finds the shadows; one ray goes through each pixel's centre, as in the references. Two halves A and B of
SIDE × SIDE stratified samples each are independent, so the mean of (A − R)(B − R) is the squared difference without
Mitsuba's noise. Left out are pixels on whose centre two surfaces meet, and those whose shading normal is turned away from the eye:
they are black in Mitsuba. Exits with 1 where the rest differs by more than 0.3 %. Needs the package `mitsuba`; minutes.
"""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "peers" / "render"))
from judged_scenes import direct_light, dr, load, mi, rays_of


def sure(scene, camera, width, height):
    """Pixels that show the same, turned to the eye, when looked at a twentieth of a pixel beside their centres."""
    def seen(offset):
        ray = rays_of(camera, width, height, offset)
        hit = scene.ray_intersect(ray)
        return np.array(hit.t), np.array(hit.sh_frame.n).T, np.array(dr.dot(hit.sh_frame.n, ray.d)) < 0
    distance, normal, same = seen((0, 0))
    for offset in ((0.05, 0), (-0.05, 0), (0, 0.05), (0, -0.05)):
        moved, turned, facing = seen(offset)
        same &= facing
        with np.errstate(invalid="ignore"):
            same &= (np.abs(moved - distance) < 0.01 * distance) & ((turned * normal).sum(1) > 0.99)
    return same.reshape(height, width)


def main():
    folder, references = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    side = int(sys.argv[3]) if len(sys.argv) > 3 else 16
    agree = True
    for file in sorted(references.glob("*.exr")):
        reference = np.array(mi.Bitmap(str(file)).convert(mi.Bitmap.PixelFormat.RGBA, mi.Struct.Type.Float32))
        mask = reference[:, :, 3] > 0.5
        reference = reference[:, :, :3].astype(np.float64)
        height, width = mask.shape
        scene, camera, gloss = load(folder, file.stem)
        mask &= sure(scene, camera, width, height)
        halves = [direct_light(scene, camera, gloss, width, height, side, seed) for seed in (1, 2)]
        size = (reference[mask] ** 2).sum()
        noise = np.sqrt(((halves[0] - halves[1])[mask] ** 2).sum() / size / 2)
        square = ((halves[0] - reference) * (halves[1] - reference))[mask].sum() / size
        difference = np.sqrt(max(0, square))
        bias = ((halves[0] + halves[1]) / 2 - reference)[mask].sum() / reference[mask].sum()
        print(f"{file.stem}: relative RMSE beyond noise {difference:.5f}, noise of {side ** 2} samples {noise:.5f}, "
              f"bias {bias:+.6f}", flush=True)
        agree = agree and difference < 3e-3
    sys.exit(0 if agree else 1)


main()
