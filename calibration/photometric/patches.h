// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lighting/result.h"

namespace lightwell::calibration {

// A grey patch of known luminance and the code that the camera gave for it.
struct Patch {
  std::string name;  // where it stands: "line 7", or the patch's own name
  double luminance_cd_m2 = 0;
  double code = 0;
  double code_sigma = 0;       // standard deviation of code; 0: not known
  std::string channel;         // R, G, B; empty: there is one only
  double exposure_us = 0;      // under which code was read; 0: not known
  double luminance_error = 0;  // relative standard deviation of luminance_cd_m2; 0: the same for all
};

struct PatchSet {
  std::string file;
  std::vector<Patch> fit, check;
  // What frames tell beside the patches; 0: nothing.
  int bits = 0;              // of a code
  double largest_code = 0;   // anywhere in them
  double still_at_code = 0;  // where pixels do not move though the others are noisy: the sensor clips there
};

inline constexpr const char* kChannelNames = "R, G, B, or red, green, blue";
// "R", "G" or "B" of any of these names, in capitals or not; nothing for others.
std::optional<std::string> channel_named(std::string text);

// Columns luminance_cd_m2, code [, code_sigma] [, channel] [, use] [, name] [, exposure_us]; use: fit (the default) or
// check; channel: of kChannelNames.
// bad_input: columns missing, values that are not numbers or out of range.
Result<PatchSet> read_patches(const std::filesystem::path& file);

// The patches of one channel.
PatchSet of_channel(const PatchSet& set, const std::string& channel);
// Whether patches were read under different exposures (more than 0.1 % apart).
bool several_exposures(const PatchSet& set);
// The luminances that would give the same codes at one exposure: luminance · exposure / reference. Under several
// exposures a patch (of one name) shares its luminance's error among its n readings: each counts as √n times worse, so
// that together they say no more than the meter did. Readings closer than that error become one.
PatchSet at_exposure(PatchSet set, double reference_us, double luminance_error);
// In order of appearance.
std::vector<std::string> channels_of(const PatchSet& set);

inline constexpr std::size_t kMostPatches = 4000;  // the time of a fit grows with their square

// Sorted by luminance, and fit to be fitted: 4 to kMostPatches of them, no luminance twice, none clipped (code ≤ 0 or
// ≥ clip_code), codes that rise with luminance, or fall by no more than noise does: code_sigma where a patch says none.
// The brightest must not stand still where its neighbours foretell a rise of many times the noise: that is clipping below
// clip_code.
// bad_input names the patch.
Result<PatchSet> ordered_and_checked(PatchSet set, double clip_code, double code_sigma);

}  // namespace lightwell::calibration
