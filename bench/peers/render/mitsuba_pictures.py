# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
"""Peer of `lightwell bench --suite render`: the judged scenes by Mitsuba 3, stratified samples of the environment.

python3 mitsuba_pictures.py FOLDER, see README.md one folder up. Needs the package `mitsuba`.
"""
import json
import pathlib
import sys
import time

try:
    from judged_scenes import direct_light, load
except ImportError as missing:
    sys.exit(f"{pathlib.Path(__file__).name}: {missing}")


def main():
    folder = pathlib.Path(sys.argv[1])
    asked = json.loads((folder / "pictures.json").read_text())
    width, height = asked["size"]
    for name in asked["scenes"]:
        scene = load(folder, name)
        for side in asked["sides"]:
            direct_light(*scene, width, height, side, 1)  # kernels are compiled
            wall, cpu = time.perf_counter(), time.process_time()
            picture = direct_light(*scene, width, height, side, 2)
            line = {"peer": "Mitsuba", "scene": name, "samples": side * side,
                    "cpu_ms": 1000 * (time.process_time() - cpu), "ms": 1000 * (time.perf_counter() - wall),
                    "file": f"{name}_{side}.f32"}
            picture.astype("float32").tofile(folder / line["file"])
            print(json.dumps(line), flush=True)


main()
