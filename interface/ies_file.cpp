// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "interface/atomic_file.h"
#include "interface/photometric_table.h"

namespace lightwell {
namespace {

constexpr double kFoot_m = 0.3048;
constexpr double kMostCandela = 1e12;

std::string shown(std::string_view text) {
  constexpr std::size_t kShown = 40;
  return std::string(text.substr(0, kShown));
}

// Lines, then numbers that stand between blanks, commas and line ends; says where it is.
class Reader {
 public:
  Reader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  std::optional<std::string_view> line() {
    if (text_.empty()) return std::nullopt;
    const auto end = text_.find_first_of("\r\n");
    const std::string_view out = text_.substr(0, end);
    text_.remove_prefix(std::min(end, text_.size()));
    if (text_.starts_with("\r\n"))
      text_.remove_prefix(2);
    else if (!text_.empty())
      text_.remove_prefix(1);
    ++line_;
    return out;
  }

  // Errors name the field.
  Result<double> number(const std::string& field, double lowest, double highest, const std::string& allowed) {
    skip_blanks();
    if (text_.empty())
      return Error{ErrorKind::bad_input, file_ + ": ends at line " + std::to_string(line_ + 1) + ", " +
                                             field + " is missing: the file is cut short"};
    const std::string_view word = text_.substr(0, text_.find_first_of(" \t,\r\n"));
    text_.remove_prefix(word.size());
    const auto value = photometric_number(word);
    if (!value || *value < lowest || *value > highest)
      return fail(field + " is " + shown(word) + ", allowed: " + allowed);
    return *value;
  }
  Result<int> whole(const std::string& field, int lowest, int highest) {
    const std::string allowed = std::to_string(lowest) + " to " + std::to_string(highest);
    const auto value = number(field, lowest, highest, allowed);
    if (!value) return value.error();
    if (*value != std::floor(*value))
      return fail(field + " is " + std::to_string(*value) + ", allowed: " + allowed);
    return static_cast<int>(*value);
  }
  Result<std::vector<double>> numbers(int count, const std::string& field, double lowest, double highest,
                                      const std::string& allowed) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) {
      const auto value = number(field + " " + std::to_string(i + 1) + " of " + std::to_string(count), lowest,
                                highest, allowed);
      if (!value) return value.error();
      values.push_back(*value);
    }
    return values;
  }

  [[nodiscard]] Error fail(const std::string& what) const {
    return {ErrorKind::bad_input, file_ + ": line " + std::to_string(line_ + 1) + ": " + what};
  }

 private:
  void skip_blanks() {
    while (!text_.empty() && std::string_view(" \t,\r\n").find(text_.front()) != std::string_view::npos) {
      if (text_.front() == '\n' || (text_.front() == '\r' && !text_.starts_with("\r\n"))) ++line_;
      text_.remove_prefix(1);
    }
  }

  std::string_view text_;
  std::string file_;
  int line_ = 0;  // that ended
};

// Increasing, and from where to where the system counts.
Status check_angles(const Reader& reader, const std::vector<double>& angles, const std::string& field) {
  for (std::size_t i = 1; i < angles.size(); ++i)
    if (!(angles[i] > angles[i - 1])) {
      char what[160];
      std::snprintf(what, sizeof what, "%s %zu is %g after %g, allowed: increasing angles", field.c_str(),
                    i + 1, angles[i], angles[i - 1]);
      return reader.fail(what);
    }
  return {};
}

// Symmetry is told by where the planes end (LM-63-2002, 5.15).
Status unfold_type_c(const Reader& reader, FarField& lamp, std::vector<std::string>& remarks) {
  const double first = lamp.horizontal_deg.front(), last = lamp.horizontal_deg.back();
  if (first == 0 && (last == 0 || last == 360)) {
    if (last == 360) {  // the first plane once more
      lamp.horizontal_deg.pop_back();
      lamp.candela.resize(lamp.horizontal_deg.size() * lamp.vertical_deg.size());
    }
    return {};
  }
  if (first == 0 && last == 90) {
    lamp = unfold_planes(lamp, [](double c) { return std::vector<double>{180 - c, 180 + c, 360 - c}; });
    return {};
  }
  if (first == 0 && last == 180) {
    lamp = unfold_planes(lamp, [](double c) { return std::vector<double>{360 - c}; });
    return {};
  }
  if (first == 90 && last == 270) {
    lamp = unfold_planes(lamp, [](double c) { return std::vector<double>{180 - c}; });
    return {};
  }
  if (first == 0 && last > 180 &&
      lamp.horizontal_deg.size() > 2) {  // all around, but for the repeated first plane
    remarks.push_back("the planes end before 360 degrees: taken as the whole circle");
    return {};
  }
  char what[160];
  std::snprintf(what, sizeof what,
                "horizontal angles go from %g to %g, allowed: from 0 to 0, 90, 180 or 360, or from 90 to 270",
                first, last);
  return reader.fail(what);
}

// From 0 on: the other half is alike.
void mirror_axis(std::vector<double>& angles, std::vector<std::size_t>& source) {
  source.clear();
  std::vector<double> full;
  if (angles.front() == 0)
    for (std::size_t i = angles.size(); i-- > 1;) {
      full.push_back(-angles[i]);
      source.push_back(i);
    }
  for (std::size_t i = 0; i < angles.size(); ++i) {
    full.push_back(angles[i]);
    source.push_back(i);
  }
  angles = full;
}

void unfold_type_ab(FarField& lamp) {
  const FarField file = lamp;
  std::vector<std::size_t> horizontal, vertical;
  mirror_axis(lamp.horizontal_deg, horizontal);
  mirror_axis(lamp.vertical_deg, vertical);
  lamp.candela.clear();
  for (const std::size_t h : horizontal)
    for (const std::size_t v : vertical) lamp.candela.push_back(file.at(h, v));
}

// Opening: width along Y, length along X, height along Z; negative ones are round (LM-63-2002, 5.11).
void set_opening(PhotometricFile& out, double width, double length, double height, double unit_m) {
  out.opening_m = Vec3d(std::abs(length), std::abs(width), std::abs(height)) * unit_m;
  out.round_opening = width < 0 || length < 0;
  if (out.round_opening && !(out.opening_m.x() > 0)) out.opening_m.x() = out.opening_m.y();
  if (out.round_opening && !(out.opening_m.y() > 0)) out.opening_m.y() = out.opening_m.x();
}

Status read_tilt(Reader& reader, PhotometricFile& out) {
  const auto geometry = reader.whole("TILT: lamp to luminaire geometry", 1, 3);
  if (!geometry) return geometry.error();
  const auto count = reader.whole("TILT: number of angles", 1, 1000);
  if (!count) return count.error();
  auto angles = reader.numbers(*count, "TILT: angle", -180, 360, "-180 to 360 degrees");
  if (!angles) return angles.error();
  auto factors = reader.numbers(*count, "TILT: factor", 0, 100, "0 to 100");
  if (!factors) return factors.error();
  if (const Status increasing = check_angles(reader, *angles, "TILT: angle"); !increasing) return increasing;
  out.tilt_deg = *std::move(angles);
  out.tilt_factor = *std::move(factors);
  return {};
}

// "mW/sr" where a label's words speak of a unit of radiant intensity; else empty.
std::string radiometric_unit(std::string_view line) {
  const auto at = line.find("W/sr");
  if (at == std::string_view::npos || !line.starts_with("[")) return {};
  const auto begin = line.find_last_of(" \t([:=,", at);
  return std::string(line.substr(begin + 1, at + 4 - begin - 1));
}

// Labels, down to TILT=.
Status read_labels(Reader& reader, PhotometricFile& out, const std::filesystem::path& file) {
  std::string manufacturer, product;
  for (;;) {
    const auto line = reader.line();
    if (!line)
      return Error{ErrorKind::bad_input,
                   file.string() + ": has no line TILT=: not a file of LM-63, or cut short"};
    const auto keyword = [&](std::string_view word) -> std::optional<std::string> {
      if (!line->starts_with(word)) return std::nullopt;
      const auto text = line->substr(word.size());
      const auto begin = text.find_first_not_of(" \t");
      if (begin == std::string_view::npos) return std::string();
      return std::string(text.substr(begin, text.find_last_not_of(" \t") - begin + 1));
    };
    if (const auto text = keyword("[MANUFAC]")) manufacturer = *text;
    if (const auto text = keyword("[LUMINAIRE]")) product = *text;
    if (const auto text = keyword("[_INTENSITYUNITS]"); text && *text != "cd")
      out.remarks.push_back("intensities are in " + *text + ", taken as candela");
    if (const std::string unit = radiometric_unit(*line); !unit.empty())
      out.remarks.push_back("speaks of " + unit + ": its intensities are taken as candela");
    if (const auto tilt = keyword("TILT=")) {
      out.name = manufacturer + (manufacturer.empty() || product.empty() ? "" : " ") + product;
      if (*tilt == "NONE") return {};
      if (*tilt == "INCLUDE") return read_tilt(reader, out);
      const auto beside = file.parent_path() / *tilt;
      const auto text = read_text_file(beside);
      if (!text)
        return Error{ErrorKind::bad_input, file.string() + ": TILT names a file: " + text.error().message};
      Reader other(*text, beside.string());
      return read_tilt(other, out);
    }
  }
}

}  // namespace

double tilt_factor(const PhotometricFile& file, double angle_deg) {
  const auto& angles = file.tilt_deg;
  if (angles.empty()) return 1;
  if (angle_deg <= angles.front()) return file.tilt_factor.front();
  if (angle_deg >= angles.back()) return file.tilt_factor.back();
  const auto above =
      static_cast<std::size_t>(std::upper_bound(angles.begin(), angles.end(), angle_deg) - angles.begin());
  const double part = (angle_deg - angles[above - 1]) / (angles[above] - angles[above - 1]);
  return (1 - part) * file.tilt_factor[above - 1] + part * file.tilt_factor[above];
}

Result<PhotometricFile> parse_ies(std::string_view text, const std::filesystem::path& file) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  Reader reader(text, file.string());
  PhotometricFile out;
  if (const Status labels = read_labels(reader, out, file); !labels) return labels.error();

  constexpr double kMost = 1e9;
  const std::string finite = "a number up to 1e9";
  const auto lamps = reader.number("number of lamps", -kMost, kMost, finite);
  if (!lamps) return lamps.error();
  const auto lumens = reader.number("lumens per lamp", -kMost, kMost, finite);
  if (!lumens) return lumens.error();
  const auto multiplier = reader.number("candela multiplier", 1e-9, kMost, "above 0 to 1e9");
  if (!multiplier) return multiplier.error();
  const auto verticals = reader.whole("number of vertical angles", 2, kMostPhotometricAngles);
  if (!verticals) return verticals.error();
  const auto horizontals = reader.whole("number of horizontal angles", 1, kMostPhotometricAngles);
  if (!horizontals) return horizontals.error();
  const auto type = reader.whole("photometric type", 1, 3);
  if (!type) return type.error();
  const auto units = reader.whole("units type", 1, 2);
  if (!units) return units.error();
  std::array<double, 3> size{};
  const std::array<std::string, 3> names = {"luminous width", "luminous length", "luminous height"};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto value = reader.number(names[i], -1000, 1000, "-1000 to 1000");
    if (!value) return value.error();
    size[i] = *value;
  }
  set_opening(out, size[0], size[1], size[2], *units == 1 ? kFoot_m : 1);
  const auto ballast = reader.number("ballast factor", 1e-9, 1000, "above 0 to 1000");
  if (!ballast) return ballast.error();
  const auto ballast_lamp = reader.number("ballast-lamp photometric factor", 1e-9, 1000, "above 0 to 1000");
  if (!ballast_lamp) return ballast_lamp.error();
  const auto watts = reader.number("input watts", 0, kMost, "0 to 1e9");
  if (!watts) return watts.error();
  out.input_power_w = *watts;

  FarField& lamp = out.lamp;
  lamp.system = *type == 1 ? PhotometricSystem::c : *type == 2 ? PhotometricSystem::b : PhotometricSystem::a;
  const bool c = lamp.system == PhotometricSystem::c;
  auto vertical = reader.numbers(*verticals, "vertical angle", c ? 0 : -90, c ? 180 : 90,
                                 c ? "0 to 180 degrees" : "-90 to 90 degrees");
  if (!vertical) return vertical.error();
  if (const Status increasing = check_angles(reader, *vertical, "vertical angle"); !increasing)
    return increasing.error();
  auto horizontal = reader.numbers(*horizontals, "horizontal angle", c ? 0 : -90, c ? 360 : 90,
                                   c ? "0 to 360 degrees" : "-90 to 90 degrees");
  if (!horizontal) return horizontal.error();
  if (const Status increasing = check_angles(reader, *horizontal, "horizontal angle"); !increasing)
    return increasing.error();
  lamp.vertical_deg = *std::move(vertical);
  lamp.horizontal_deg = *std::move(horizontal);
  const double factor = *multiplier * *ballast * *ballast_lamp;
  for (int h = 0; h < *horizontals; ++h) {
    const auto plane = reader.numbers(*verticals, "plane " + std::to_string(h + 1) + ": candela",
                                      -kMostCandela, kMostCandela, "up to 1e12");
    if (!plane) return plane.error();
    for (const double candela : *plane) lamp.candela.push_back(candela * factor);
  }
  clear_negative(lamp, out.remarks);
  if (c) {
    if (const Status unfolded = unfold_type_c(reader, lamp, out.remarks); !unfolded) return unfolded.error();
  } else {
    unfold_type_ab(lamp);
  }
  return out;
}

Result<PhotometricFile> read_ies(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return parse_ies(*text, file);
}

Status write_ies(const std::filesystem::path& file, const PhotometricFile& lamp) {
  const FarField& table = lamp.lamp;
  const bool c = table.system == PhotometricSystem::c;
  const bool closes = c && table.horizontal_deg.size() > 1;  // the first plane stands at 360 once more
  std::string out =
      "IESNA:LM-63-2002\n[TEST] Exported by Lightwell\n[TESTLAB]\n[ISSUEDATE]\n[MANUFAC]\n[LUMINAIRE] ";
  for (const char letter : lamp.name) out += letter < ' ' ? ' ' : letter;
  out += "\nTILT=NONE\n";
  char number[64];
  const auto put = [&](double value, char after) {
    std::snprintf(number, sizeof number, "%.9g%c", value, after);
    out += number;
  };
  const double round = lamp.round_opening ? -1 : 1;
  std::snprintf(number, sizeof number, "1 -1 1 %zu %zu %d 2 ", table.vertical_deg.size(),
                table.horizontal_deg.size() + (closes ? 1 : 0),
                c                                      ? 1
                : table.system == PhotometricSystem::b ? 2
                                                       : 3);
  out += number;
  put(round * lamp.opening_m.y(), ' ');
  put(round * lamp.opening_m.x(), ' ');
  put(lamp.opening_m.z(), '\n');
  out += "1 1 ";
  put(lamp.input_power_w, '\n');
  for (std::size_t i = 0; i < table.vertical_deg.size(); ++i)
    put(table.vertical_deg[i], i + 1 == table.vertical_deg.size() ? '\n' : ' ');
  for (const double h : table.horizontal_deg) put(h, ' ');
  if (closes) put(360, ' ');
  out.back() = '\n';
  const std::size_t planes = table.horizontal_deg.size();
  for (std::size_t h = 0; h < planes + (closes ? 1 : 0); ++h)
    for (std::size_t v = 0; v < table.vertical_deg.size(); ++v)
      put(table.at(h % planes, v), v + 1 == table.vertical_deg.size() ? '\n' : ' ');
  return write_file_atomically(file, out);
}

}  // namespace lightwell
