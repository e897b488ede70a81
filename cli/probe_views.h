// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "lighting/field/light_sightings.h"
#include "lighting/lat_long_image.h"
#include "lighting/result.h"

namespace lightwell::cli {

// What one probe has seen: a picture of all around it, or the lights of one; and the lamps in it.
struct ProbeView {
  std::variant<LatLongImage, LightSet> content;
  std::vector<LampSighting> lamps;
  std::vector<LightSighting> sets;  // of lights: [lamps]
  double theta_max_rad = kPi;       // zenith angle to which it saw anything
  std::string remark;               // of the reader, one line; empty: none
};

// A light set (.json), else a latitude–longitude picture. bad_input as their readers say it.
Result<ProbeView> read_probe_view(const std::filesystem::path& file);

// The view without lamps: `removed` are indices into view.lamps. Of a picture what stood around each goes on in its place.
Status write_without(const ProbeView& view, const std::vector<int>& removed,
                     const std::filesystem::path& file);

}  // namespace lightwell::cli
