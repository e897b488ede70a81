// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// SCENE.gltf and .glb of lightwell-render, and a second of their animation.
#include "render/gltf_scene.h"
#include "render/scene_motion.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file({data, size});
  auto scene = render::read_gltf(file.path());
  if (!scene) fuzz::expect_one_line(scene.error(), file.path().string());
  if (!scene) return 0;
  for (const std::uint32_t i : scene->indices)
    verify_bug(i < scene->vertices.size(), "an index beyond the vertices");
  render::SceneMotion motion(*scene);
  for (const double time_s : {0.3, 1.0})
    if (!motion.move_to(time_s)) break;
  return 0;
}
