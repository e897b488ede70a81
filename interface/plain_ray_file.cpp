// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/plain_ray_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "interface/atomic_file.h"
#include "interface/printable.h"

namespace lightwell {
namespace {

constexpr std::size_t kLargestFile = std::size_t{4} << 30;
constexpr double kFarthest_m = 1000;
constexpr double kMostFlux = 1e12;
constexpr std::array<std::string_view, 7> kFields = {"x", "y", "z", "u", "v", "w", "flux"};

// Lines with something in them that is no remark, in fields.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  // Empty at the end.
  const std::vector<std::string_view>& next() {
    fields_.clear();
    while (!text_.empty() && fields_.empty()) {
      const auto end = std::min(text_.find_first_of("\r\n"), text_.size());
      std::string_view line = text_.substr(0, end);
      const bool pair = text_.substr(end, 2) == "\r\n";
      text_.remove_prefix(std::min(end + (pair ? 2 : 1), text_.size()));
      ++line_;
      while (!line.empty()) {
        const auto begin = line.find_first_not_of(" \t,");
        if (begin == std::string_view::npos) break;
        line.remove_prefix(begin);
        if (fields_.empty() && std::string_view("#!;").find(line.front()) != std::string_view::npos) break;
        const auto length = std::min(line.find_first_of(" \t,"), line.size());
        fields_.push_back(line.substr(0, length));
        line.remove_prefix(length);
      }
    }
    return fields_;
  }
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  std::string_view text_;
  std::vector<std::string_view> fields_;
  std::size_t line_ = 0;
};

std::optional<double> number_in(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

struct Form {
  std::array<std::size_t, 7> column = {0, 1, 2, 3, 4, 5, 6};  // of x, y, z, u, v, w, flux
  std::optional<std::size_t> columns;                         // of every line, where the file says
  std::optional<std::uint64_t> rays;
  double unit_m = 1;
  bool aimed_along_z = false;  // else the lamp's frame
};

Error bad(const std::string& file, std::size_t line, const std::string& what) {
  return {ErrorKind::bad_input, printable(file + ": line " + std::to_string(line) + ": " + what)};
}

std::string shown(std::string_view text) {
  constexpr std::size_t kShown = 40;
  return std::string(text.substr(0, kShown));
}

Result<Form> form_of(const std::vector<std::string_view>& fields, std::size_t line, const std::string& file) {
  Form form;
  if (fields.empty()) return Error{ErrorKind::bad_input, file + ": holds no rays"};
  if (!number_in(fields[0])) {
    form.columns = fields.size();
    for (std::size_t i = 0; i < kFields.size(); ++i) {
      const auto at = std::find(fields.begin(), fields.end(), kFields[i]);
      if (at == fields.end())
        return bad(file, line,
                   "column " + std::string(kFields[i]) +
                       " is missing, allowed: x, y, z, u, v, w, flux, or number of rays and unit");
      form.column[i] = static_cast<std::size_t>(at - fields.begin());
    }
    return form;
  }
  constexpr std::array<double, 5> kUnits_m = {1, 0.0254, 0.01, 0.3048, 0.001};
  const auto whole = [](std::string_view text, double most) -> std::optional<std::uint64_t> {
    const auto value = number_in(text);
    if (!value || !(*value >= 0 && *value <= most) || *value != std::floor(*value)) return std::nullopt;
    return static_cast<std::uint64_t>(*value);
  };
  constexpr double kMostRays = 1e10;
  if (fields.size() != 2)
    return bad(file, line,
               "begins with " + std::to_string(fields.size()) +
                   " numbers, allowed: names of columns, x, y, z, u, v, w, flux, or number of rays "
                   "and unit");
  form.rays = whole(fields[0], kMostRays);
  if (!form.rays || *form.rays == 0)
    return bad(file, line, "number of rays is " + shown(fields[0]) + ", allowed: 1 to 1e10");
  const auto unit = whole(fields[1], kUnits_m.size() - 1.0);
  if (!unit)
    return bad(file, line,
               "unit is " + shown(fields[1]) + ", allowed: 0 (m), 1 (in), 2 (cm), 3 (ft), 4 (mm)");
  form.unit_m = kUnits_m[*unit];
  form.aimed_along_z = true;
  return form;
}

Result<LampRay> ray_of(const std::vector<std::string_view>& fields, const Form& form, std::size_t line,
                       const std::string& file) {
  if (form.columns ? fields.size() != *form.columns : fields.size() < kFields.size())
    return bad(file, line,
               "has " + std::to_string(fields.size()) + " numbers, allowed: " +
                   (form.columns ? std::to_string(*form.columns) : std::string("7 or more")) +
                   "; the file may be cut short");
  std::array<double, 7> value{};
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::string_view text = fields[form.column[i]];
    const auto wrong = [&](const char* allowed) {
      return bad(file, line, std::string(kFields[i]) + " is " + shown(text) + ", allowed: " + allowed);
    };
    const auto read = number_in(text);
    if (i < 3 && (!read || !(std::abs(*read) * form.unit_m <= kFarthest_m)))
      return wrong("within 1000 metres");
    if (i >= 3 && i < 6 && (!read || !(std::abs(*read) <= 2))) return wrong("a part of a unit vector");
    if (i == 6 && (!read || !(*read >= 0 && *read <= kMostFlux))) return wrong("0 to 1e12");
    value[i] = *read;
  }
  const double side = form.aimed_along_z ? -1 : 1;
  const Vec3d origin(value[0], side * value[1], side * value[2]);
  const Vec3d direction(value[3], side * value[4], side * value[5]);
  constexpr double kNearUnit = 1e-2;
  if (!(std::abs(direction.norm() - 1) <= kNearUnit))
    return bad(
        file, line,
        "the direction u, v, w is " + std::to_string(direction.norm()) + " long, allowed: 1 within 0.01");
  return LampRay{origin * form.unit_m, direction.normalized(), value[6]};
}

}  // namespace

Result<RayFile> parse_plain_rays(std::string_view text, const std::string& file) {
  if (text.find('\0') != std::string_view::npos)
    return Error{ErrorKind::bad_input, file + ": is no text, allowed: rays as text, or TM-25"};
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  Lines lines(text);
  const auto& first = lines.next();
  const auto form = form_of(first, lines.line(), file);
  if (!form) return form.error();
  RayFile out;
  out.name = std::filesystem::path(file).stem().string();
  std::uint64_t count = 0;
  for (const auto* fields = &lines.next(); !fields->empty(); fields = &lines.next()) {
    const auto ray = ray_of(*fields, *form, lines.line(), file);
    if (!ray) return ray.error();
    ++count;
    if (ray->flux_lm > 0) out.rays.push_back(*ray);
  }
  if (form->rays && count != *form->rays)
    return Error{ErrorKind::bad_input, file + ": has " + std::to_string(count) +
                                           " rays where its first line says " + std::to_string(*form->rays) +
                                           (count < *form->rays ? ": the file is cut short" : "")};
  if (out.rays.empty()) return Error{ErrorKind::bad_input, file + ": no ray has any flux"};
  if (out.rays.size() < count)
    out.remarks.push_back(std::to_string(count - out.rays.size()) + " rays have no flux");
  if (form->aimed_along_z) out.remarks.emplace_back("the unit of flux is not said: taken as lumens");
  if (text.back() != '\n' && text.back() != '\r')
    out.remarks.emplace_back("the last line does not end: its ray may be cut short");
  return out;
}

Result<RayFile> read_plain_rays(const std::filesystem::path& file) {
  const auto text = read_text_file(file, kLargestFile);
  if (!text) return text.error();
  return parse_plain_rays(*text, file.string());
}

}  // namespace lightwell
