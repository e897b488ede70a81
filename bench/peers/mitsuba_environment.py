# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
"""Peer of `lightwell bench --suite lights`: Mitsuba 3's own importance sampling of an environment map.

python3 mitsuba_environment.py FOLDER, see README.md beside it. Needs the package `mitsuba`.
"""
import json
import pathlib
import sys
import time

try:
    import mitsuba
    import numpy
except ImportError as missing:
    sys.exit(f"{pathlib.Path(__file__).name}: {missing}")

mitsuba.set_variant("scalar_rgb")


def radical_inverse(base, index):
    value, digit = 0.0, 1.0 / base
    while index:
        value += digit * (index % base)
        index //= base
        digit /= base
    return value


def points(kind, count):
    if kind == "random":
        return numpy.random.default_rng(7).random((count, 2))
    return numpy.array([[radical_inverse(2, i + 1), radical_inverse(3, i + 1)] for i in range(count)])


def emitter_of(folder, entry):
    pixels = numpy.fromfile(folder / entry["file"], numpy.float32)
    pixels = pixels.reshape(entry["height"], entry["width"], 3)
    return mitsuba.load_dict({"type": "envmap", "bitmap": mitsuba.Bitmap(pixels)})


def main():
    folder = pathlib.Path(sys.argv[1])
    index = json.loads((folder / "maps.json").read_text())
    reference = mitsuba.Interaction3f()
    reference.p = [0, 0, 0]
    for number, entry in enumerate(index["maps"]):
        emitter = emitter_of(folder, entry)
        # The emitter knows how large the scene is once it stands in one.
        mitsuba.load_dict({"type": "scene", "emitter": emitter, "shape": {"type": "sphere"}})
        for kind in ("random", "Halton"):
            for count in index["counts"]:
                square = points(kind, count)
                begin = time.perf_counter()
                drawn = [emitter.sample_direction(reference, mitsuba.Point2f(*p)) for p in square]
                milliseconds = 1000 * (time.perf_counter() - begin)
                print(json.dumps({
                    "peer": f"Mitsuba, {kind}", "map": number, "lights": count, "ms": milliseconds,
                    "direction": [[float(sample.d[i]) for i in range(3)] for sample, _ in drawn],
                    "illuminance": [[max(0.0, float(weight[i])) / count for i in range(3)] for _, weight in drawn],
                }))


main()
