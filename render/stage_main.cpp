// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "interface/atomic_file.h"
#include "render/stage.h"

// lightwell-stage FILE: writes the demo stage. Part of the build only.
int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: lightwell-stage FILE.gltf\n");
    return 2;
  }
  const auto written = lightwell::write_file_atomically(argv[1], lightwell::render::stage_gltf());
  if (written) return 0;
  std::fprintf(stderr, "lightwell-stage: %s\n", written.error().message.c_str());
  return static_cast<int>(written.error().kind);
}
