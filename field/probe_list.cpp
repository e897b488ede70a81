// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/probe_list.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdio>

#include "interface/csv_table.h"

namespace lightwell {
namespace {

constexpr double kFarthest_m = 1e5;

std::filesystem::path resolved(const std::string& name, const std::filesystem::path& list) {
  const std::filesystem::path file(name);
  if (file.is_absolute()) return file;
  std::error_code ignored;
  const std::filesystem::path beside = list.parent_path() / file;
  return std::filesystem::exists(beside, ignored) || !std::filesystem::exists(file, ignored) ? beside : file;
}

// An axis has no sign: its largest part is positive, and what prints as 0 has none.
Vec3d as_axis(Vec3d v) {
  int largest = 0;
  v.cwiseAbs().maxCoeff(&largest);
  if (v[largest] < 0) v = -v;
  return (v.cwiseAbs().array() < 0.005).select(Vec3d::Zero(), v);
}

}  // namespace

Result<ProbeList> read_probe_list(const std::filesystem::path& file) {
  const auto table = CsvTable::read(file);
  if (!table) return table.error();
  if (const Status required = table->require({"x", "y", "z", "file"}); !required) return required.error();
  if (table->rows() == 0)
    return Error{ErrorKind::bad_input,
                 file.string() + ": has no probes: allowed 1 line or more of x,y,z,file"};
  ProbeList list;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    Vec3d position;
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = table->number(row, std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1),
                                       -kFarthest_m, kFarthest_m, "-100000 to 100000 metres");
      if (!value) return value.error();
      position[axis] = *value;
    }
    const std::string name = table->text(row, "file");
    if (name.empty())
      return Error{ErrorKind::bad_input, table->place(row) + ": file is empty: allowed the name of an image"};
    list.positions.push_back(position);
    list.files.push_back(resolved(name, file));
  }
  return list;
}

std::vector<std::string> remarks_on_places(const std::vector<Vec3d>& positions, const FieldGrid& grid) {
  std::vector<std::string> remarks;
  Vec3d mean = Vec3d::Zero();
  for (const Vec3d& p : positions) mean += p / static_cast<double>(positions.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3d& p : positions) spread += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);  // from the narrowest
  int thin = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3d axis = axes.eigenvectors().col(i);
    double low = 0, high = 0;
    for (const Vec3d& p : positions) {
      low = std::min(low, axis.dot(p - mean));
      high = std::max(high, axis.dot(p - mean));
    }
    thin += high - low < grid.cell().minCoeff() / 2 ? 1 : 0;
  }
  char text[200] = "";
  const Vec3d normal = as_axis(axes.eigenvectors().col(0)), line = as_axis(axes.eigenvectors().col(2));
  if (thin == 3)
    std::snprintf(text, sizeof text,
                  "all probes are in one place: how light changes from place to place is not determined");
  else if (thin == 2)
    std::snprintf(
        text, sizeof text,
        "all probes are on a line along (%.2f, %.2f, %.2f): how light changes across it is not determined",
        line.x(), line.y(), line.z());
  else if (thin == 1)
    std::snprintf(
        text, sizeof text,
        "all probes are in a plane across (%.2f, %.2f, %.2f): how light changes across it is not determined "
        "for rays that run in it",
        normal.x(), normal.y(), normal.z());
  if (text[0] != '\0') remarks.emplace_back(text);
  if (std::none_of(positions.begin(), positions.end(), [&](const Vec3d& p) { return grid.contains(p); }))
    remarks.emplace_back("no probe is inside --bounds: all light there is taken from rays measured outside");
  return remarks;
}

}  // namespace lightwell
