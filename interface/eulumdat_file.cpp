// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "interface/atomic_file.h"
#include "interface/photometric_table.h"

namespace lightwell {
namespace {

constexpr double kMillimetre_m = 1e-3;

// One field a line.
class Lines {
 public:
  Lines(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  Result<std::string> text(const std::string& field) {
    if (text_.empty())
      return Error{ErrorKind::bad_input, file_ + ": ends at line " + std::to_string(line_) + ", " + field +
                                             " is missing: the file is cut short"};
    const auto end = text_.find_first_of("\r\n");
    std::string out(text_.substr(0, end));
    text_.remove_prefix(std::min(end, text_.size()));
    if (text_.starts_with("\r\n"))
      text_.remove_prefix(2);
    else if (!text_.empty())
      text_.remove_prefix(1);
    ++line_;
    return out;
  }
  Result<double> number(const std::string& field, double lowest, double highest, const std::string& allowed) {
    const auto line = text(field);
    if (!line) return line.error();
    const auto value = photometric_number(*line);
    if (!value || *value < lowest || *value > highest)
      return fail(field + " is " + line->substr(0, 40) + ", allowed: " + allowed);
    return *value;
  }
  // What no light depends on: an empty or odd line is 0.
  Result<double> length(const std::string& field) {
    const auto line = text(field);
    if (!line) return line.error();
    const double value = photometric_number(*line).value_or(0);
    return value >= 0 && value <= 1e6 ? value : 0.0;
  }
  Result<int> whole(const std::string& field, int lowest, int highest) {
    const std::string allowed = std::to_string(lowest) + " to " + std::to_string(highest);
    const auto value = number(field, lowest, highest, allowed);
    if (!value) return value.error();
    if (*value != std::floor(*value)) return fail(field + " is not whole, allowed: " + allowed);
    return static_cast<int>(*value);
  }
  Status skip(int count, const std::string& field) {
    for (int i = 0; i < count; ++i)
      if (const auto line = text(field); !line) return line.error();
    return {};
  }
  [[nodiscard]] Error fail(const std::string& what) const {
    return {ErrorKind::bad_input, file_ + ": line " + std::to_string(line_) + ": " + what};
  }

 private:
  std::string_view text_;
  std::string file_;
  int line_ = 0;
};

// The planes that a file of this symmetry holds, as places in its list of all C angles.
std::vector<int> stored_planes(int symmetry, int planes) {
  const auto run = [&](int first, int count) {
    std::vector<int> out;
    for (int i = 0; i < count; ++i) out.push_back((first + i) % planes);
    return out;
  };
  switch (symmetry) {
    case 1:
      return run(0, 1);
    case 2:
      return run(0, planes / 2 + 1);
    case 3:
      return run(3 * planes / 4, planes / 2 + 1);
    case 4:
      return run(0, planes / 4 + 1);
    default:
      return run(0, planes);
  }
}

FarField unfold(const FarField& file, int symmetry) {
  switch (symmetry) {
    case 1: {
      FarField round = file;
      round.horizontal_deg = {0};
      return round;
    }
    case 2:
      return unfold_planes(file, [](double c) { return std::vector<double>{360 - c}; });
    case 3:
      return unfold_planes(file, [](double c) { return std::vector<double>{180 - c}; });
    case 4:
      return unfold_planes(file, [](double c) { return std::vector<double>{180 - c, 180 + c, 360 - c}; });
    default:
      return unfold_planes(file, [](double) { return std::vector<double>{}; });
  }
}

// Flux of the first set of lamps, lm; skips the others.
Result<double> read_lamps(Lines& lines, PhotometricFile& out) {
  const auto sets = lines.whole("number of sets of lamps", 1, 20);
  if (!sets) return sets.error();
  double flux = 0;
  for (int set = 0; set < *sets; ++set) {
    const auto count = lines.number("number of lamps", -1e6, 1e6, "a number; negative: absolute photometry");
    if (!count) return count.error();
    if (const auto type = lines.text("type of lamps"); !type) return type.error();
    const auto lumens = lines.number("total flux of lamps", 1e-9, 1e12, "above 0 to 1e12 lm");
    if (!lumens) return lumens.error();
    if (const Status skipped = lines.skip(2, "colour of lamps"); !skipped) return skipped.error();
    const auto watts = lines.length("wattage");
    if (!watts) return watts.error();
    if (set > 0) continue;
    flux = *lumens;
    out.input_power_w = *watts;
  }
  if (*sets > 1) out.remarks.push_back("the first of " + std::to_string(*sets) + " sets of lamps is taken");
  return flux;
}

// Some files contradict themselves: what they tabulate is what is kept.
void remark_on_flux(PhotometricFile& out) {
  constexpr double kFar = 0.01;
  const double flux = luminous_flux(out.lamp);
  if (!out.stated_flux_lm || std::abs(flux / *out.stated_flux_lm - 1) <= kFar) return;
  char what[160];
  std::snprintf(what, sizeof what,
                "the intensities sum up to %.6g lm where lamps and light output ratio say %.6g", flux,
                *out.stated_flux_lm);
  out.remarks.emplace_back(what);
}

Result<std::vector<double>> read_angles(Lines& lines, int count, const std::string& field, double highest) {
  std::vector<double> angles;
  for (int i = 0; i < count; ++i) {
    const auto angle = lines.number(field + " " + std::to_string(i + 1), 0, highest,
                                    "0 to " + std::to_string(static_cast<int>(highest)) + " degrees");
    if (!angle) return angle.error();
    if (!angles.empty() && !(*angle > angles.back()))
      return lines.fail(field + " " + std::to_string(i + 1) +
                        " does not increase, allowed: increasing angles");
    angles.push_back(*angle);
  }
  return angles;
}

}  // namespace

Result<PhotometricFile> parse_eulumdat(std::string_view text, const std::string& file) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  Lines lines(text, file);
  PhotometricFile out;
  const auto company = lines.text("company");
  if (!company) return company.error();
  const auto type = lines.whole("type indicator", 0, 3);
  if (!type) return type.error();
  const auto symmetry = lines.whole("symmetry indicator", 0, 4);
  if (!symmetry) return symmetry.error();
  const auto planes = lines.whole("number of C planes", 1, kMostPhotometricAngles);
  if (!planes) return planes.error();
  if ((*symmetry == 2 && *planes % 2 != 0) || (*symmetry >= 3 && *planes % 4 != 0))
    return lines.fail("number of C planes is " + std::to_string(*planes) + ", allowed with symmetry " +
                      std::to_string(*symmetry) + ": multiples of " + (*symmetry == 2 ? "2" : "4"));
  if (const auto step = lines.length("distance of C planes"); !step) return step.error();
  const auto gammas = lines.whole("number of gamma angles", 2, kMostPhotometricAngles);
  if (!gammas) return gammas.error();
  if (const Status skipped = lines.skip(2, "report number"); !skipped) return skipped.error();
  auto name = lines.text("luminaire name");
  if (!name) return name.error();
  out.name = *std::move(name);
  if (const Status skipped = lines.skip(3, "luminaire number, file, date"); !skipped) return skipped.error();
  std::array<double, 9> lengths{};  // of the luminaire (3), of its luminous area (2 and 4 heights)
  for (double& value : lengths) {
    const auto read = lines.length("length");
    if (!read) return read.error();
    value = *read * kMillimetre_m;
  }
  // The area's length lies along C90, its width along C0; no width: round.
  out.round_opening = lengths[3] > 0 && lengths[4] == 0;
  out.opening_m = Vec3d(out.round_opening ? lengths[3] : lengths[4], lengths[3],
                        *std::max_element(lengths.begin() + 5, lengths.end()));
  if (const auto downward = lines.length("downward flux fraction"); !downward) return downward.error();
  const auto output_ratio = lines.number("light output ratio", 0, 1000, "0 to 1000 percent");
  if (!output_ratio) return output_ratio.error();
  const auto conversion = lines.number("conversion factor", 1e-9, 1e9, "above 0 to 1e9");
  if (!conversion) return conversion.error();
  if (const auto tilt = lines.length("tilt"); !tilt) return tilt.error();
  const auto flux = read_lamps(lines, out);
  if (!flux) return flux.error();
  if (*output_ratio > 0) out.stated_flux_lm = *flux * *output_ratio / 100;
  if (const Status skipped = lines.skip(10, "direct ratios"); !skipped) return skipped.error();

  const auto all_planes = read_angles(lines, *planes, "C angle", 360);
  if (!all_planes) return all_planes.error();
  auto vertical = read_angles(lines, *gammas, "gamma angle", 180);
  if (!vertical) return vertical.error();
  FarField stored;
  stored.vertical_deg = *std::move(vertical);
  stored.horizontal_deg.clear();
  const double candela_a_unit = *flux / 1000 * *conversion;
  for (const int plane : stored_planes(*symmetry, *planes)) {
    const double c = (*all_planes)[static_cast<std::size_t>(plane)];
    stored.horizontal_deg.push_back(c);
    for (int g = 0; g < *gammas; ++g) {
      char field[80];
      std::snprintf(field, sizeof field, "intensity at C %g, gamma %g", c,
                    stored.vertical_deg[static_cast<std::size_t>(g)]);
      const auto value = lines.number(field, -1e9, 1e9, "a number up to 1e9 cd/klm");
      if (!value) return value.error();
      stored.candela.push_back(*value * candela_a_unit);
    }
  }
  out.lamp = unfold(stored, *symmetry);
  clear_negative(out.lamp, out.remarks);
  remark_on_flux(out);
  return out;
}

Result<PhotometricFile> read_eulumdat(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return parse_eulumdat(*text, file.string());
}

Result<PhotometricFile> read_photometric_file(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (ending == ".ies") return read_ies(file);
  if (ending == ".ldt" || ending == ".eulumdat") return read_eulumdat(file);
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return text->find("TILT=") != std::string::npos ? parse_ies(*text, file)
                                                  : parse_eulumdat(*text, file.string());
}

}  // namespace lightwell
