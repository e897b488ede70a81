#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
"""check_with_mitsuba.py FOLDER REFERENCES [SIDE]: the stored references against Mitsuba 3.

FOLDER holds the judged scenes and their light (make_references scenes FOLDER). Mitsuba intersects, samples the
environment and finds the shadows; one ray goes through each pixel's centre, as in the references. Two halves A and B of
SIDE × SIDE stratified samples each are independent, so the mean of (A − R)(B − R) is the squared difference without
Mitsuba's noise. Exits with 1 where that is more than 0.3 % of the picture. Needs the package `mitsuba`; minutes.
"""
import base64
import json
import pathlib
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
ENLARGED = 4  # copies of a pixel a side: the environment's bilinear interpolation then only rounds its pixels' edges


def array_of(gltf, data, index):
    accessor = gltf["accessors"][index]
    begin = gltf["bufferViews"][accessor["bufferView"]]["byteOffset"]
    kind = {5126: np.float32, 5125: np.uint32}[accessor["componentType"]]
    width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
    values = np.frombuffer(data, kind, accessor["count"] * width, begin)
    return values.reshape(-1, width) if width > 1 else values


def mesh_of(positions, normals, indices, material):
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict({"type": "diffuse",
                                       "reflectance": {"type": "rgb", "value": material["diffuse"]}})
    mesh = mi.Mesh("mesh", len(positions), len(indices) // 3, has_vertex_normals=True, props=properties)
    values = mi.traverse(mesh)
    values["vertex_positions"] = np.ravel(positions)
    values["vertex_normals"] = np.ravel(normals)
    values["faces"] = np.ravel(indices)
    values.update()
    return mesh


def load(folder, name):
    """The scene, its camera, and the gloss of each mesh."""
    gltf = json.loads((folder / f"{name}.gltf").read_text())
    data = base64.b64decode(gltf["buffers"][0]["uri"].split(",", 1)[1])
    light = np.array(mi.Bitmap(str(folder / f"{name}_light.exr")))[:, :, :3]
    light[light.shape[0] // 2:] = 0
    light = light.repeat(ENLARGED, 0).repeat(ENLARGED, 1)
    scene = {"type": "scene", "light": {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(light))}}
    gloss = []
    for mesh in gltf["meshes"]:
        primitive = mesh["primitives"][0]
        material = gltf["materials"][primitive["material"]]["extras"]["phong"]
        scene[f"mesh{len(gloss)}"] = mesh_of(array_of(gltf, data, primitive["attributes"]["POSITION"]),
                                             array_of(gltf, data, primitive["attributes"]["NORMAL"]),
                                             array_of(gltf, data, primitive["indices"]), material)
        gloss.append(material)
    node = next(node for node in gltf["nodes"] if "camera" in node)
    camera = (np.array(node["matrix"]).reshape(4, 4).T, gltf["cameras"][0]["perspective"]["yfov"])
    return mi.load_dict(scene), camera, gloss


def rays_of(camera, width, height):
    matrix, yfov = camera
    y, x = np.mgrid[0:height, 0:width]
    tangent = np.tan(yfov / 2)
    local = np.stack([(2 * (x + 0.5) / width - 1) * tangent * width / height,
                      (1 - 2 * (y + 0.5) / height) * tangent, -np.ones_like(x, float)], -1).reshape(-1, 3)
    world = local @ matrix[:3, :3].T
    world /= np.linalg.norm(world, axis=1, keepdims=True)
    origin = np.broadcast_to(matrix[:3, 3], world.shape)
    return mi.Ray3f(mi.Point3f(origin.T.astype(np.float32)), mi.Vector3f(world.T.astype(np.float32)))


def direct_light(scene, camera, gloss, width, height, side, seed):
    """Mean over stratified samples of the environment: f · cos · radiance / pdf."""
    ray = rays_of(camera, width, height)
    hit = scene.ray_intersect(ray)
    shapes = scene.shapes_dr()
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, width * height)
    mirrored = 2 * dr.dot(hit.sh_frame.n, -ray.d) * hit.sh_frame.n + ray.d
    kinds = []  # normalised Phong lobes, which Mitsuba has none of
    for index, material in enumerate(gloss):
        if any(material["specular"]):
            kinds.append((hit.shape == shapes[index], mi.Color3f(material["specular"]), material["exponent"]))
    total = mi.Color3f(0)
    context = mi.BSDFContext()
    bsdf = hit.bsdf(ray)
    for stratum in range(side * side):
        point = (sampler.next_2d() + mi.Point2f(stratum % side, stratum // side)) / side
        sample, weight = scene.sample_emitter_direction(hit, point, True, hit.is_valid())
        cosine = dr.maximum(0, dr.dot(hit.sh_frame.n, sample.d))
        value = bsdf.eval(context, hit, hit.to_local(sample.d), hit.is_valid())
        for active, specular, exponent in kinds:
            lobe = dr.power(dr.maximum(1e-8, dr.dot(mirrored, sample.d)), exponent) * (exponent + 2) / (2 * dr.pi)
            value += dr.select(active, specular * lobe * cosine, 0)
        total += dr.select(hit.is_valid(), value * weight, 0)
        dr.eval(total, sampler)
    return np.array(total).T.reshape(height, width, 3).astype(np.float64) / side ** 2


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
