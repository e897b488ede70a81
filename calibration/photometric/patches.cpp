// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/patches.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>

#include "interface/csv_table.h"

namespace lightwell::calibration {
namespace {

constexpr std::size_t kFewestPatches =
    4;                              // a logarithm has three parameters, and one patch has to check them
constexpr double kNoiseSigmas = 3;  // codes may fall by so many standard deviations from patch to patch
constexpr double kForetoldSigmas =
    30;  // a rise that large does not hide in noise, nor in a knee of ten to one
constexpr double kSameExposure = 1e-3;

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

Result<Patch> patch_of(const CsvTable& table, std::size_t row) {
  Patch patch;
  const auto luminance = table.luminance(row, "luminance_cd_m2");
  if (!luminance) return luminance.error();
  const auto code = table.number(row, "code", 0, 65535, "a number from 0 to 65535");
  if (!code) return code.error();
  patch.luminance_cd_m2 = *luminance;
  patch.code = *code;
  if (table.has("code_sigma") && !table.text(row, "code_sigma").empty()) {
    const auto sigma = table.number(row, "code_sigma", 0, 65535, "a number from 0 to 65535");
    if (!sigma) return sigma.error();
    patch.code_sigma = *sigma;
  }
  if (table.has("exposure_us")) {
    const auto exposure = table.number(row, "exposure_us", 1e-3, 1e9, "a number from 0.001 to 1e9");
    if (!exposure) return exposure.error();
    patch.exposure_us = *exposure;
  }
  const std::string channel = table.text(row, "channel");
  const bool monochrome = table.text(0, "channel").empty();
  const auto named = monochrome && channel.empty() ? std::optional<std::string>("") : channel_named(channel);
  if (!named || (monochrome && !named->empty()))
    return Error{ErrorKind::bad_input,
                 table.place(row) + ": channel = " + (channel.empty() ? "nothing" : channel.substr(0, 40)) +
                     ": allowed " + (monochrome ? "nothing, as in the first line" : kChannelNames)};
  patch.channel = *named;
  patch.name = table.text(row, "name");
  if (patch.name.empty()) patch.name = "line " + std::to_string(table.line(row));
  return patch;
}

Error bad_patch(const PatchSet& set, const Patch& patch, const std::string& what) {
  return {ErrorKind::bad_input, set.file + ": " + patch.name + ": " + what};
}

Status check_clipping(const PatchSet& set, double clip_code) {
  for (const auto* patches : {&set.fit, &set.check})
    for (const Patch& patch : *patches)
      if (patch.code <= 0 || patch.code >= clip_code)
        return bad_patch(set, patch,
                         "code = " + shown(patch.code) + " is clipped: allowed above 0 and below " +
                             shown(clip_code) + "; leave the patch out");
  return {};
}

Status check_order(const PatchSet& set, double code_sigma) {
  const auto sigma = [=](const Patch& p) { return p.code_sigma > 0 ? p.code_sigma : code_sigma; };
  for (std::size_t i = 1; i < set.fit.size(); ++i) {
    const Patch &before = set.fit[i - 1], &patch = set.fit[i];
    if (patch.luminance_cd_m2 == before.luminance_cd_m2)
      return bad_patch(set, patch,
                       "luminance_cd_m2 = " + shown(patch.luminance_cd_m2) + " stands in " + before.name +
                           " too: allowed once, with the mean of its codes");
    const double noise = kNoiseSigmas * std::hypot(sigma(patch), sigma(before));
    if (patch.code < before.code - noise)
      return bad_patch(set, patch,
                       "code = " + shown(patch.code) + " at " + shown(patch.luminance_cd_m2) +
                           " cd/m2 lies below the " + shown(before.code) + " of " + before.name + " at " +
                           shown(before.luminance_cd_m2) +
                           " cd/m2: codes are not monotone, allowed are codes that rise with luminance");
  }
  return {};
}

// Of three patches at the end, the steps in code against those in ln luminance, the flattest scale on which a response
// still rises: a knee makes the second step smaller, clipping makes it nothing.
Status check_top(const PatchSet& set, double code_sigma) {
  const std::size_t n = set.fit.size();
  const Patch &a = set.fit[n - 3], &b = set.fit[n - 2], &c = set.fit[n - 1];
  if (!(a.luminance_cd_m2 > 0)) return {};
  const double slope = (b.code - a.code) / std::log(b.luminance_cd_m2 / a.luminance_cd_m2);
  const double foretold = slope * std::log(c.luminance_cd_m2 / b.luminance_cd_m2);
  const auto sigma = [=](const Patch& p) { return p.code_sigma > 0 ? p.code_sigma : code_sigma; };
  const double noise = std::hypot(sigma(b), sigma(c));
  if (foretold < kForetoldSigmas * noise || c.code - b.code > kNoiseSigmas * noise) return {};
  return bad_patch(set, c,
                   "code = " + shown(c.code) + " at " + shown(c.luminance_cd_m2) +
                       " cd/m2 is no more than the " + shown(b.code) + " of " + b.name + " at " +
                       shown(b.luminance_cd_m2) +
                       " cd/m2: the sensor clips there; state it with --clip-code and leave the patch out");
}

// Luminances nearer to each other than their errors would ask the codes for an order that nobody knows.
std::vector<Patch> with_neighbours_joined(std::vector<Patch> patches) {
  std::stable_sort(patches.begin(), patches.end(),
                   [](const Patch& a, const Patch& b) { return a.luminance_cd_m2 < b.luminance_cd_m2; });
  std::vector<Patch> out;
  double count = 0;  // readings in out.back()
  for (const Patch& patch : patches) {
    const double reach = kNoiseSigmas * std::hypot(1.0, 1.0) * patch.luminance_error;
    if (out.empty() || patch.luminance_cd_m2 > out.back().luminance_cd_m2 * (1 + reach)) {
      out.push_back(patch);
      count = 1;
      continue;
    }
    Patch& joined = out.back();
    const double part = 1 / (count + 1);
    joined.luminance_cd_m2 += part * (patch.luminance_cd_m2 - joined.luminance_cd_m2);
    joined.code += part * (patch.code - joined.code);
    joined.code_sigma = std::max(joined.code_sigma, patch.code_sigma);
    joined.luminance_error = std::max(joined.luminance_error, patch.luminance_error);
    joined.name += " + " + patch.name;
    ++count;
  }
  return out;
}

}  // namespace

std::optional<std::string> channel_named(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const auto& [letter, word] : {std::pair("r", "red"), std::pair("g", "green"), std::pair("b", "blue")})
    if (text == letter || text == word) return std::string(1, static_cast<char>(std::toupper(*letter)));
  return std::nullopt;
}

Result<PatchSet> read_patches(const std::filesystem::path& file) {
  const auto table = CsvTable::read(file);
  if (!table) return table.error();
  if (const Status status = table->require({"luminance_cd_m2", "code"}); !status) return status.error();
  PatchSet set;
  set.file = file.string();
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const auto patch = patch_of(*table, row);
    if (!patch) return patch.error();
    const std::string use = table->text(row, "use");
    if (use == "check")
      set.check.push_back(*patch);
    else if (use.empty() || use == "fit")
      set.fit.push_back(*patch);
    else
      return Error{ErrorKind::bad_input,
                   table->place(row) + ": use = " + use.substr(0, 40) + ": allowed fit, check"};
  }
  return set;
}

PatchSet of_channel(const PatchSet& set, const std::string& channel) {
  PatchSet out = set;
  out.fit.clear();
  out.check.clear();
  const auto same = [&](const Patch& patch) { return patch.channel == channel; };
  std::copy_if(set.fit.begin(), set.fit.end(), std::back_inserter(out.fit), same);
  std::copy_if(set.check.begin(), set.check.end(), std::back_inserter(out.check), same);
  return out;
}

bool several_exposures(const PatchSet& set) {
  double least = 1e300, most = 0;
  for (const auto* patches : {&set.fit, &set.check})
    for (const Patch& patch : *patches) {
      least = std::min(least, patch.exposure_us);
      most = std::max(most, patch.exposure_us);
    }
  return least > 0 && most > least * (1 + kSameExposure);
}

PatchSet at_exposure(PatchSet set, double reference_us, double luminance_error) {
  const bool several = several_exposures(set);
  for (auto* patches : {&set.fit, &set.check}) {
    std::map<std::string, double> readings;
    for (const Patch& patch : *patches) ++readings[patch.name];
    for (Patch& patch : *patches) {
      if (patch.exposure_us > 0) patch.luminance_cd_m2 *= patch.exposure_us / reference_us;
      if (several) patch.luminance_error = luminance_error * std::sqrt(readings[patch.name]);
    }
    if (several) *patches = with_neighbours_joined(std::move(*patches));
  }
  return set;
}

std::vector<std::string> channels_of(const PatchSet& set) {
  std::vector<std::string> channels;
  for (const auto* patches : {&set.fit, &set.check})
    for (const Patch& patch : *patches)
      if (std::find(channels.begin(), channels.end(), patch.channel) == channels.end())
        channels.push_back(patch.channel);
  return channels;
}

Result<PatchSet> ordered_and_checked(PatchSet set, double clip_code, double code_sigma) {
  const auto darker = [](const Patch& a, const Patch& b) { return a.luminance_cd_m2 < b.luminance_cd_m2; };
  std::stable_sort(set.fit.begin(), set.fit.end(), darker);
  std::stable_sort(set.check.begin(), set.check.end(), darker);
  if (set.fit.size() < kFewestPatches)
    return Error{ErrorKind::bad_input, set.file +
                                           ": number of patches to fit = " + std::to_string(set.fit.size()) +
                                           ": allowed at least " + std::to_string(kFewestPatches) +
                                           "; six over the whole range are good"};
  if (set.fit.size() > kMostPatches)
    return Error{ErrorKind::bad_input,
                 set.file + ": number of patches to fit = " + std::to_string(set.fit.size()) +
                     ": allowed at most " + std::to_string(kMostPatches) + "; take the mean of neighbours"};
  if (const Status status = check_clipping(set, clip_code); !status) return status.error();
  if (const Status status = check_order(set, code_sigma); !status) return status.error();
  if (const Status status = check_top(set, code_sigma); !status) return status.error();
  return set;
}

}  // namespace lightwell::calibration
