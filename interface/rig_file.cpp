// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/rig_file.h"

#include <utility>

#include "interface/atomic_file.h"
#include "interface/csv_table.h"
#include "interface/printable.h"
#include "interface/toml_fields.h"

namespace lightwell {
namespace {

constexpr const char* kSchema = "lightwell.rig/1";
// Lamps and their rigs: from a tenth of a millimetre to a kilometre.
constexpr double kLeast_m = 1e-4, kMost_m = 1000;
constexpr const char* kLengths = "0.0001 to 1000 metres";
constexpr const char* kPlaces = "-1000 to 1000 metres";
constexpr double kMostExposure_us = 1e9;
constexpr const char* kExposures = "above 0 to 1e9 microseconds";
constexpr double kTiny = 1e-9;
constexpr int kMostPixels = 4096;

Vec2d place_of(TomlFields& fields, const char* key) {
  Vec2d place;
  fields.numbers(key, {place.data(), 2}, -kMost_m, kMost_m, kPlaces);
  return place;
}
Vec3d place_in_space(TomlFields& fields, const char* key) {
  Vec3d place;
  fields.numbers(key, {place.data(), 3}, -kMost_m, kMost_m, kPlaces);
  return place;
}

void read_sampling(TomlFields fields, Rig& rig) {
  rig.spacing_m = fields.number("spacing_m", kLeast_m, kMost_m, kLengths);
  rig.z_m = fields.number_or("z_m", 0, -kMost_m, kMost_m, kPlaces);
  rig.filter = fields.word("filter", {"finite", "canonical"}) == 0 ? BellDual::finite : BellDual::canonical;
  rig.peak_transmission = fields.number_or("peak_transmission", 1, kTiny, 1, "above 0 to 1");
  rig.moves = fields.word("moves", {"lamp", "filter"}) == 0 ? Rig::Moves::lamp : Rig::Moves::filter;
  fields.expect_no_more();
}

void read_measurement(TomlFields fields, Rig& rig) {
  rig.distance_m = fields.number("distance_m", kLeast_m, kMost_m, kLengths);
  rig.low_m = place_of(fields, "low_m");
  rig.high_m = place_of(fields, "high_m");
  if (!((rig.high_m - rig.low_m).array() >= kLeast_m).all())
    fields.fail("high_m", "is not above low_m by 0.0001 metres or more");
  std::array<double, 2> pixels{};
  fields.numbers("pixels", pixels, 4, kMostPixels, "4 to 4096");
  for (std::size_t i = 0; i < 2; ++i) {
    rig.pixels[i] = static_cast<int>(pixels[i]);
    if (rig.pixels[i] != pixels[i]) fields.fail("pixels", "is not whole, allowed: 4 to 4096");
  }
  fields.expect_no_more();
}

double read_camera(TomlFields fields, Rig& rig) {
  constexpr std::array kUnits = {Rig::Unit::lux, Rig::Unit::luminance, Rig::Unit::codes, Rig::Unit::relative};
  rig.unit = kUnits[fields.word("unit", {"lux", "cd/m2", "codes", "relative"})];
  rig.calibration = fields.text_or("calibration", "");
  if (rig.unit == Rig::Unit::codes && rig.calibration.empty())
    fields.fail("calibration", "is missing, unit codes needs a folder with response.json and lens.json");
  rig.screen_reflectance = fields.number_or("screen_reflectance", 1, 0.01, 1, "0.01 to 1");
  const double exposure_us = fields.number_or("exposure_us", 0, kTiny, kMostExposure_us, kExposures);
  if (fields.has("saturation")) rig.saturation = fields.number("saturation", kTiny, 1e12, "above 0 to 1e12");
  rig.most_saturated = fields.number_or("most_saturated", rig.most_saturated, 0, 1, "0 to 1");
  rig.most_negative = fields.number_or("most_negative", rig.most_negative, 0, 1, "0 to 1");
  rig.dark = fields.text_or("dark", "");
  rig.dark_exposure_us =
      fields.number_or("dark_exposure_us", exposure_us, kTiny, kMostExposure_us, kExposures);
  rig.most_mark_error_px =
      fields.number_or("most_mark_error_px", rig.most_mark_error_px, 0, 1000, "0 to 1000 pixels");
  fields.expect_no_more();
  return exposure_us;
}

void read_screen(TomlFields& root, Rig& rig) {
  if (root.has("marks") == root.has("picture"))
    root.fail(root.has("picture") ? "picture" : "marks",
              "and [[marks]]: one of them is needed, allowed: [[marks]], four or more, or [picture]");
  if (root.has("marks")) {
    for (TomlFields& mark : root.tables("marks")) {
      constexpr double kMostPixel = 1e6;
      rig.marks.emplace_back();
      mark.numbers("pixel", {rig.marks.back().pixel.data(), 2}, -kMostPixel, kMostPixel, "-1e6 to 1e6");
      rig.marks.back().screen_m = place_of(mark, "screen_m");
      mark.expect_no_more();
    }
    if (rig.marks.size() < 4)
      root.fail("marks", "are " + std::to_string(rig.marks.size()) + ", allowed: four or more");
    return;
  }
  TomlFields picture = root.table("picture");
  rig.edges = Rig::Edges{place_of(picture, "first_m"), place_of(picture, "last_m")};
  if (!((rig.edges->last_m - rig.edges->first_m).cwiseAbs().array() >= kLeast_m).all())
    picture.fail("last_m", "is first_m along x or y, allowed: 0.0001 metres from it or more");
  picture.expect_no_more();
}

void read_reference(TomlFields& root, Rig& rig) {
  if (!root.has("reference")) {
    if (rig.unit == Rig::Unit::relative)
      root.fail("reference", "is missing, unit relative needs what a lux meter read");
    return;
  }
  TomlFields fields = root.table("reference");
  Rig::Reference reference;
  reference.at_m = place_in_space(fields, "at_m");
  if (!(reference.at_m.z() < rig.z_m))
    fields.fail("at_m", "does not lie before the lamp, allowed: z below sampling.z_m");
  reference.toward = place_in_space(fields, "toward");
  if (!(reference.toward.norm() > kTiny)) fields.fail("toward", "is 0, allowed: any length but 0");
  reference.toward.normalize();
  reference.lux = fields.number("lux", kTiny, 1e12, "above 0 to 1e12");
  fields.expect_no_more();
  rig.reference = reference;
}

Rig rig_from(const toml::table& table, const std::string& file, double* exposure_us) {
  TomlFields root(table, file);
  if (root.text("schema") != kSchema) root.fail("schema", "is not known, allowed: " + std::string(kSchema));
  Rig rig;
  rig.name = root.text_or("name", "");
  read_sampling(root.table("sampling"), rig);
  read_measurement(root.table("measurement"), rig);
  const double exposure = read_camera(root.table("camera"), rig);
  if (exposure_us != nullptr) *exposure_us = exposure;
  read_screen(root, rig);
  read_reference(root, rig);
  root.expect_no_more();
  return rig;
}

Result<Rig::Picture> picture_from(const CsvTable& table, std::size_t row, const Rig& rig) {
  Rig::Picture picture;
  picture.place = table.place(row);
  picture.file = table.text(row, "file");
  if (picture.file.empty())
    return Error{ErrorKind::bad_input, picture.place + ": file is empty, allowed: a picture's name"};
  for (const int axis : {0, 1}) {
    const auto at = table.number(row, axis == 0 ? "x" : "y", -kMost_m, kMost_m, kPlaces);
    if (!at) return at.error();
    picture.position_m[axis] = rig.moves == Rig::Moves::lamp ? -*at : *at;
  }
  const std::string part = table.text(row, "part");
  if (part == "positive")
    picture.part = Rig::Part::positive;
  else if (part == "negative")
    picture.part = Rig::Part::negative;
  else if (!part.empty() && part != "whole")
    return Error{ErrorKind::bad_input,
                 picture.place + ": part is " + part + ", allowed: whole, positive, negative"};
  if (table.has("exposure_us")) {
    const auto exposure = table.number(row, "exposure_us", kTiny, kMostExposure_us, kExposures);
    if (!exposure) return exposure.error();
    picture.exposure_us = *exposure;
  }
  return picture;
}

}  // namespace

Result<Rig> parse_rig(std::string_view text, const std::string& file, double* exposure_us) {
  try {
    return rig_from(toml::parse(text, file), file, exposure_us);
  } catch (const toml::parse_error& error) {
    return Error{ErrorKind::bad_input,
                 printable(file + ": line " + std::to_string(error.source().begin.line) + ": " +
                           std::string(error.description()))};
  } catch (const FieldFailure& failure) {
    return failure.error;
  }
}

Result<Rig> read_rig(const std::filesystem::path& folder) {
  const auto text = read_text_file(folder / "rig.toml");
  if (!text) return text.error();
  double exposure_us = 0;
  auto rig = parse_rig(*text, (folder / "rig.toml").string(), &exposure_us);
  if (!rig) return rig;
  const auto table = CsvTable::read(folder / "positions.csv");
  if (!table) return table.error();
  if (const Status all = table->require({"file", "x", "y"}); !all) return all.error();
  if (table->rows() == 0)
    return Error{ErrorKind::bad_input, (folder / "positions.csv").string() + ": lists no picture"};
  for (std::size_t row = 0; row < table->rows(); ++row) {
    auto picture = picture_from(*table, row, *rig);
    if (!picture) return picture.error();
    if (!(picture->exposure_us > 0)) picture->exposure_us = exposure_us;
    rig->pictures.push_back(*std::move(picture));
  }
  return rig;
}

}  // namespace lightwell
