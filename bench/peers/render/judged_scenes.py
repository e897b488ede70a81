# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
"""The judged scenes in Mitsuba 3, and their direct light at pixels' centres. Needs the package `mitsuba`."""
import base64
import json

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


def rays_of(camera, width, height, offset=(0, 0)):
    """Through the pixels' centres, or beside them by a part of a pixel."""
    matrix, yfov = camera
    y, x = np.mgrid[0:height, 0:width] + np.reshape(offset, (2, 1, 1))
    tangent = np.tan(yfov / 2)
    local = np.stack([(2 * (x + 0.5) / width - 1) * tangent * width / height,
                      (1 - 2 * (y + 0.5) / height) * tangent, -np.ones_like(x, float)], -1).reshape(-1, 3)
    world = local @ matrix[:3, :3].T
    world /= np.linalg.norm(world, axis=1, keepdims=True)
    origin = np.broadcast_to(matrix[:3, 3], world.shape)
    return mi.Ray3f(mi.Point3f(origin.T.astype(np.float32)), mi.Vector3f(world.T.astype(np.float32)))


def direct_light(scene, camera, gloss, width, height, side, seed):
    """Mean over side × side stratified samples of the environment: f · cos · radiance / pdf."""
    most = 64  # samples a pixel at once, for memory
    samples = side * side
    total = np.zeros((3, width * height))
    for first in range(0, samples, most):
        count = min(most, samples - first)
        lane = dr.arange(mi.UInt32, width * height * count)
        pixel = lane // count
        stratum = first + lane % count
        rays = rays_of(camera, width, height)
        ray = mi.Ray3f(dr.gather(mi.Point3f, rays.o, pixel), dr.gather(mi.Vector3f, rays.d, pixel))
        hit = scene.ray_intersect(ray)
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed * 1000 + first, width * height * count)
        point = (sampler.next_2d() + mi.Point2f(stratum % side, stratum // side)) / side
        sample, weight = scene.sample_emitter_direction(hit, point, True, hit.is_valid())
        value = hit.bsdf(ray).eval(mi.BSDFContext(), hit, hit.to_local(sample.d), hit.is_valid())
        cosine = dr.maximum(0, dr.dot(hit.sh_frame.n, sample.d))
        mirrored = 2 * dr.dot(hit.sh_frame.n, -ray.d) * hit.sh_frame.n + ray.d
        shapes = scene.shapes_dr()
        for index, material in enumerate(gloss):  # normalised Phong lobes, which Mitsuba has none of
            if any(material["specular"]):
                lobe = dr.power(dr.maximum(1e-8, dr.dot(mirrored, sample.d)), material["exponent"])
                lobe *= (material["exponent"] + 2) / (2 * dr.pi) * cosine
                value += dr.select(hit.shape == dr.gather(mi.ShapePtr, shapes, index),
                                   mi.Color3f(material["specular"]) * lobe, 0)
        lit = dr.select(hit.is_valid(), value * weight, 0)
        total += np.array([np.array(dr.block_sum(lit[i], count)) for i in range(3)])
    return total.T.reshape(height, width, 3) / samples
