// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// rig.toml of lamps' rigs: what reads can be measured with.
#include <string_view>

#include "interface/rig_file.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto rig = parse_rig({reinterpret_cast<const char*>(data), size}, "lamp");
  if (!rig) {
    fuzz::expect_one_line(rig.error(), "lamp");
    return 0;
  }
  verify_bug(rig->spacing_m > 0 && rig->distance_m > 0, "a rig without size");
  verify_bug((rig->high_m - rig->low_m).minCoeff() > 0, "a measurement plane without size");
  verify_bug(rig->marks.size() >= 4 || rig->edges.has_value(), "a screen that nothing fixes");
  verify_bug(rig->unit != Rig::Unit::relative || rig->reference.has_value(), "light without a scale");
  return 0;
}
