// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/field_file.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <new>
#include <sstream>

#include "interface/atomic_file.h"
#include "lighting/field/field_sparsity.h"
#include "lighting/field_error.h"

namespace lightwell {
namespace {

constexpr const char* kSchema = "lightwell.field/1";
constexpr float kMostHalf = 65504;
constexpr float kFinestHalf = 6.1e-5f;  // below it a half float loses digits

std::string name_of(int harmonic) {
  char name[16];
  std::snprintf(name, sizeof name, "sh_%02d", harmonic);
  return name;
}

// A power of two that brings the largest number into the range of half floats, 1 where it is there already.
float scale_for(const LightField& field) {
  float most = 0;
  for (const float value : field.radiance) most = std::max(most, std::abs(value));
  if (!(most > 0) || (most <= kMostHalf && most >= 1000 * kFinestHalf)) return 1;
  return std::exp2(std::ceil(std::log2(most / 32768)));
}

template <class Visit>
void visit_points(const FieldGrid& grid, const Visit& visit) {
  std::size_t index = 0;
  for (int z = 0; z < grid.size[2]; ++z)
    for (int y = 0; y < grid.size[1]; ++y)
      for (int x = 0; x < grid.size[0]; ++x, ++index)
        visit(openvdb::Coord(x, y, z), z, static_cast<std::size_t>(y * grid.size[0] + x), index);
}

openvdb::math::Transform::Ptr transform_of(const FieldGrid& grid) {
  auto transform = openvdb::math::Transform::createLinearTransform();
  const Vec3d cell = grid.cell();
  transform->postScale(openvdb::Vec3d(cell.x(), cell.y(), cell.z()));
  transform->postTranslate(openvdb::Vec3d(grid.low.x(), grid.low.y(), grid.low.z()));
  return transform;
}

openvdb::GridPtrVec grids_of(const LightField& field, const std::vector<std::uint8_t>& stored, float scale) {
  openvdb::GridPtrVec grids;
  const auto add = [&](const openvdb::GridBase::Ptr& grid, const std::string& name) {
    grid->setName(name);
    grid->setSaveFloatAsHalf(true);
    grid->setTransform(transform_of(field.grid));
    grids.push_back(grid);
  };
  for (int h = 0; h < field.harmonics(); ++h) {
    const auto grid = openvdb::Vec3SGrid::create(openvdb::Vec3s(0));
    auto accessor = grid->getAccessor();
    visit_points(field.grid, [&](const openvdb::Coord& at, int z, std::size_t in_slab, std::size_t index) {
      if (stored[index] == 0) return;
      accessor.setValueOn(at, openvdb::Vec3s(field.plane(z, h, 0)[in_slab], field.plane(z, h, 1)[in_slab],
                                             field.plane(z, h, 2)[in_slab]) /
                                  scale);
    });
    add(grid, name_of(h));
  }
  const auto grid = openvdb::FloatGrid::create(0);
  auto accessor = grid->getAccessor();
  visit_points(field.grid, [&](const openvdb::Coord& at, int, std::size_t, std::size_t index) {
    accessor.setValueOn(at, field.confidence[index]);
  });
  add(grid, "confidence");
  return grids;
}

openvdb::MetaMap metadata_of(const LightField& field, const FieldFileOptions& options, float scale) {
  const auto vector = [](const Vec3d& v) { return openvdb::Vec3DMetadata({v.x(), v.y(), v.z()}); };
  openvdb::MetaMap meta;
  meta.insertMeta("lightwell_schema", openvdb::StringMetadata(kSchema));
  meta.insertMeta("lightwell_degree", openvdb::Int32Metadata(field.degree));
  meta.insertMeta("lightwell_size",
                  openvdb::Vec3IMetadata({field.grid.size[0], field.grid.size[1], field.grid.size[2]}));
  meta.insertMeta("lightwell_low", vector(field.grid.low));
  meta.insertMeta("lightwell_high", vector(field.grid.high));
  meta.insertMeta("lightwell_method", openvdb::StringMetadata(options.method));
  meta.insertMeta("lightwell_max_error", openvdb::DoubleMetadata(options.max_error));
  meta.insertMeta("lightwell_scale", openvdb::FloatMetadata(scale));
  return meta;
}

// What a reader gets of it: half floats, and points filled in.
LightField as_read(const LightField& field, const std::vector<std::uint8_t>& stored, float scale) {
  LightField read = field;
  for (float& value : read.radiance) value = static_cast<float>(openvdb::math::half(value / scale)) * scale;
  fill_left_out(read, stored);
  return read;
}

void measure(const LightField& field, const LightField& read, FieldFileReport& report) {
  double square = 0, error = 0, most = 0;
  visit_points(field.grid, [&](const openvdb::Coord&, int z, std::size_t in_slab, std::size_t) {
    double here = 0;
    for (int h = 0; h < field.harmonics(); ++h)
      for (int c = 0; c < 3; ++c) {
        const auto value = static_cast<double>(field.plane(z, h, c)[in_slab]);
        const double difference = static_cast<double>(read.plane(z, h, c)[in_slab]) - value;
        square += value * value;
        here += difference * difference;
      }
    error += here;
    most = std::max(most, here);
  });
  if (!(square > 0)) return;
  report.rms_error = std::sqrt(error / square);
  report.most_error = std::sqrt(most * static_cast<double>(field.grid.points()) / square);
}

Error bad(const std::filesystem::path& file, const std::string& what) {
  return {ErrorKind::bad_input, file.string() + ": " + what};
}

// The file's own numbers, checked before memory is asked for.
Result<FieldFile> header_of(const openvdb::MetaMap& meta, float& scale) {
  FieldFile result;
  const auto size = meta.metaValue<openvdb::Vec3i>("lightwell_size");
  const auto low = meta.metaValue<openvdb::Vec3d>("lightwell_low");
  const auto high = meta.metaValue<openvdb::Vec3d>("lightwell_high");
  FieldGrid& grid = result.field.grid;
  for (int a = 0; a < 3; ++a) {
    if (size[a] < 2 || size[a] > kMostFieldSide) return field_error("lightwell_size", size[a], "2 to 4096");
    if (!std::isfinite(low[a]) || !(high[a] > low[a]) || !std::isfinite(high[a]))
      return field_error("lightwell_high", high[a], "finite, above lightwell_low");
    grid.size[static_cast<std::size_t>(a)] = size[a];
    grid.low[a] = low[a];
    grid.high[a] = high[a];
  }
  result.field.degree = meta.metaValue<int>("lightwell_degree");
  if (result.field.degree < 1 || result.field.degree > kMostFieldDegree)
    return field_error("lightwell_degree", result.field.degree, "1 to 8");
  if (grid.points() > kMostFieldPoints)
    return field_error("lightwell_size: points", static_cast<double>(grid.points()), "up to 512 cubed");
  scale = meta.metaValue<float>("lightwell_scale");
  if (!(scale > 0) || !std::isfinite(scale))
    return field_error("lightwell_scale", static_cast<double>(scale), "above 0");
  result.method = meta.metaValue<std::string>("lightwell_method");
  result.max_error = meta.metaValue<double>("lightwell_max_error");
  return result;
}

openvdb::GridBase::Ptr grid_named(const openvdb::GridPtrVec& grids, const std::string& name) {
  for (const auto& grid : grids)
    if (grid->getName() == name) return grid;
  return nullptr;
}

Result<FieldFile> parse(const openvdb::MetaMap::Ptr& meta, const openvdb::GridPtrVec& grids) {
  if (!meta || !(*meta)["lightwell_schema"])
    return Error{ErrorKind::bad_input, "is not a light field of lightwell"};
  const auto schema = meta->metaValue<std::string>("lightwell_schema");
  if (schema != kSchema)
    return Error{ErrorKind::bad_input, "lightwell_schema = " + schema + ": allowed " + kSchema};
  float scale = 1;
  auto result = header_of(*meta, scale);
  if (!result) return result;
  LightField& field = result->field;
  field.radiance.assign(field.grid.points() * 3 * static_cast<std::size_t>(field.harmonics()), 0.0f);
  field.confidence.assign(field.grid.points(), 0.0f);
  std::vector<std::uint8_t> stored(field.grid.points(), 1);
  for (int h = 0; h < field.harmonics(); ++h) {
    const auto grid = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid_named(grids, name_of(h)));
    if (!grid) return Error{ErrorKind::bad_input, name_of(h) + " is missing, or no grid of vectors"};
    auto accessor = grid->getConstAccessor();
    bool finite = true;
    visit_points(field.grid, [&](const openvdb::Coord& at, int z, std::size_t in_slab, std::size_t index) {
      openvdb::Vec3s value;
      if (!accessor.probeValue(at, value)) {
        stored[index] = 0;
        return;
      }
      finite = finite && std::isfinite(value[0]) && std::isfinite(value[1]) && std::isfinite(value[2]);
      for (int c = 0; c < 3; ++c) field.plane(z, h, c)[in_slab] = scale * value[c];
    });
    if (!finite) return Error{ErrorKind::bad_input, name_of(h) + " has a value that is not finite"};
  }
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(grid_named(grids, "confidence"));
  if (!grid) return Error{ErrorKind::bad_input, "confidence is missing, or no grid of numbers"};
  auto accessor = grid->getConstAccessor();
  visit_points(field.grid, [&](const openvdb::Coord& at, int, std::size_t, std::size_t index) {
    field.confidence[index] = std::clamp(accessor.getValue(at), 0.0f, 1.0f);
  });
  fill_left_out(field, stored);
  return result;
}

}  // namespace

Result<FieldFileReport> write_field(const std::filesystem::path& file, const LightField& field,
                                    const FieldFileOptions& options) {
  openvdb::initialize();
  const float scale = scale_for(field);
  const auto stored = stored_points(field, options.max_error);
  FieldFileReport report;
  report.stored_points = static_cast<std::size_t>(std::count(stored.begin(), stored.end(), 1));
  measure(field, as_read(field, stored, scale), report);
  std::ostringstream bytes;
  openvdb::io::Stream(bytes).write(grids_of(field, stored, scale), metadata_of(field, options, scale));
  report.bytes = bytes.view().size();
  if (const Status written = write_file_atomically(file, bytes.view()); !written) return written.error();
  return report;
}

Result<FieldFile> read_field(const std::filesystem::path& file) {
  std::ifstream input(file, std::ios::binary);
  if (!input) return bad(file, std::string("cannot read: ") + std::strerror(errno));
  std::error_code unknown;
  if (std::filesystem::is_directory(file, unknown)) return bad(file, "is a directory, expected a file");
  try {
    openvdb::initialize();
    // Past a file's end OpenVDB would go on with numbers that are none.
    input.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::Stream stream(input, false);
    auto result = parse(stream.getMetadata(), *stream.getGrids());
    if (!result) return bad(file, result.error().message);
    return result;
  } catch (const std::bad_alloc&) {
    return bad(file, "is larger than memory, or damaged");
  } catch (const std::exception& error) {
    return bad(file, std::string("is not a whole OpenVDB light field: ") + error.what());
  }
}

}  // namespace lightwell
