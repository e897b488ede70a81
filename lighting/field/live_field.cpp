// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/field/live_field.h"

#include <algorithm>
#include <cmath>

#include "lighting/field/near_lamp.h"
#include "lighting/result.h"

namespace lightwell {
namespace {

constexpr float kMeasured = 0.5f;  // of a cell: less says too little of it

Eigen::MatrixXd columns(std::span<const Vec3d> positions) {
  Eigen::MatrixXd matrix(3, static_cast<Eigen::Index>(positions.size()));
  for (std::size_t n = 0; n < positions.size(); ++n) matrix.col(static_cast<Eigen::Index>(n)) = positions[n];
  return matrix;
}

// ∫ Y_lm over the bins of each cell: [25][cells].
Eigen::MatrixXd bin_harmonics(const PolarCells& cells, int count) {
  const PolarGrid& grid = cells.grid();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(harmonic_count(kRadianceDegree), count);
  Eigen::VectorXd y(sums.rows());
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int sector = 0; sector < grid.sectors; ++sector) {
      harmonics(grid.bin_direction(ring, sector), kRadianceDegree, y.data());
      sums.col(cells.cell_of(static_cast<std::size_t>(ring * grid.sectors + sector))) +=
          grid.bin_solid_angle_sr(ring) * y;
    }
  return sums;
}

}  // namespace

// What is known of a probe's newest map.
struct LiveField::Probe {
  // Of the map's grid; behind pointers, for the finder keeps the cells' address.
  std::unique_ptr<PolarCells> cells;
  std::unique_ptr<LampFinder> finder;
  std::unique_ptr<MapHarmonics> projection;
  std::vector<Rgb> radiance;       // [cells]
  std::vector<float> finite;       // [cells], part of what its grid shows of it
  Eigen::MatrixXd cell_harmonics;  // [25][cells], integrals of Y_lm over its bins
  RadianceHarmonics harmonics = RadianceHarmonics::Zero();
  std::vector<LampSighting> lamps;
  std::optional<double> time_s;  // of the map

  // Part of a cell that was measured.
  [[nodiscard]] float measured(std::size_t cell, float solid_angle_sr) const {
    return cells ? finite[cell] * cells->solid_angle_sr()[cell] / solid_angle_sr : 0;
  }
};

// A cell that some probe sees.
struct LiveField::Direction {
  std::size_t cell = 0;
  Vec3d centre = Vec3d::UnitY();
  float solid_angle_sr = 0;
  std::optional<Kriging> kriging;
  ShearPlane plane;
  std::vector<std::uint64_t> near;  // [pixels], a bit for each probe whose ray passes within kNearCells
  Eigen::VectorXd shares;           // [probes], 0 where it was not measured; `completion` is made for them
  Eigen::MatrixXd completion;
};

LiveField::LiveField(const LiveFieldOptions& options, std::vector<Vec3d> positions)
    : options_(options),
      positions_(std::move(positions)),
      partition_(options.cells),
      probes_(positions_.size()),
      weights_(positions_.size(), 0.0),
      shares_(positions_.size(), 0.0),
      places_(columns(positions_)) {
  verify_bug(!positions_.empty() && positions_.size() <= kMostProbes, "a live field has 1 to 64 probes");
  const auto count = static_cast<Eigen::Index>(positions_.size());
  place_weights_.resize(static_cast<Eigen::Index>(options.grid.points()), count);
  Eigen::Index point = 0;
  for (int k = 0; k < options.grid.size[2]; ++k)
    for (int j = 0; j < options.grid.size[1]; ++j)
      for (int i = 0; i < options.grid.size[0]; ++i)
        place_weights_.row(point++) =
            places_.weights(options.grid.position(i, j, k)).transpose().cast<float>();
  place_completion_ = Eigen::MatrixXd::Identity(count, count);
  field_.grid = options.grid;
  field_.degree = kRadianceDegree;
  field_.radiance.assign(options.grid.points() * 3 * static_cast<std::size_t>(field_.harmonics()), 0.0f);
  field_.confidence.assign(options.grid.points(), 0.0f);
}

LiveField::~LiveField() = default;

// Directions that a map of this grid shows, and the weights of all probes for them.
void LiveField::prepare(const PolarGrid& widest) {
  widest_ = widest;
  const PolarCells cells(widest, partition_);
  const auto count = static_cast<std::size_t>(partition_.cells());
  std::vector<Vec3d> moments(count, Vec3d::Zero());
  const Eigen::MatrixXd all = bin_harmonics(cells, partition_.cells());
  for (int ring = 0; ring < widest.rings; ++ring)
    for (int sector = 0; sector < widest.sectors; ++sector) {
      const std::uint32_t cell = cells.cell_of(static_cast<std::size_t>(ring * widest.sectors + sector));
      moments[cell] += widest.bin_solid_angle_sr(ring) * widest.bin_direction(ring, sector);
    }
  directions_.clear();
  std::vector<RayKriging> rays;
  std::vector<Eigen::Index> shown;
  for (std::size_t cell = 0; cell < count; ++cell) {
    if (!(moments[cell].norm() > 0)) continue;
    RayKriging ray(options_.grid, moments[cell].normalized(), positions_);
    Direction direction{
        cell, moments[cell].normalized(), cells.solid_angle_sr()[cell], ray.kriging, ray.plane, {}, {}, {}};
    direction.near.assign(static_cast<std::size_t>(ray.square_cells.rows()), 0);
    for (Eigen::Index n = 0; n < ray.square_cells.cols(); ++n)
      for (Eigen::Index p = 0; p < ray.square_cells.rows(); ++p)
        if (static_cast<double>(ray.square_cells(p, n)) <= kNearCells * kNearCells)
          direction.near[static_cast<std::size_t>(p)] |= std::uint64_t{1} << n;
    shown.push_back(static_cast<Eigen::Index>(cell));
    directions_.push_back(std::move(direction));
    rays.push_back(std::move(ray));
  }
  cell_harmonics_.resize(all.rows(), static_cast<Eigen::Index>(shown.size()));
  for (std::size_t d = 0; d < shown.size(); ++d)
    cell_harmonics_.col(static_cast<Eigen::Index>(d)) = all.col(shown[d]);
  sums_.emplace(options_.grid, kRadianceDegree, rays, cell_harmonics_);
  radiance_.assign(3 * directions_.size() * positions_.size(), 0.0f);
}

void LiveField::update(std::size_t index, const PolarMap& map, double time_s) {
  Probe& probe = probes_[index];
  if (!probe.cells || probe.cells->grid() != map.grid) {
    probe.cells = std::make_unique<PolarCells>(map.grid, partition_);
    probe.finder = std::make_unique<LampFinder>(*probe.cells);
    probe.projection = std::make_unique<MapHarmonics>(map.grid);
    probe.radiance.resize(static_cast<std::size_t>(partition_.cells()));
    probe.finite.resize(probe.radiance.size());
    probe.cell_harmonics = bin_harmonics(*probe.cells, partition_.cells());
  }
  if (!widest_ || map.grid.theta_max_rad > widest_->theta_max_rad) prepare(map.grid);
  probe.cells->gather(map, probe.radiance, probe.finite);
  probe.harmonics = probe.projection->project(map);
  probe.lamps.clear();
  if (options_.lamps) probe.finder->find(map, probe.lamps);
  probe.time_s = time_s;
}

// Weights move toward 1 while maps are new and toward 0 while they are not. So do shares, unless no map is new: then the mix
// stays as it is, and whoever is back first takes over from the last light as slowly as from any probe.
void LiveField::age(double time_s) {
  const double step = last_s_ ? std::max(0.0, time_s - *last_s_) / std::max(options_.fade_s, 1e-3) : 1;
  const auto fresh = [&](const Probe& probe) {
    return probe.time_s && time_s - *probe.time_s <= options_.hold_s;
  };
  const auto move = [&](std::vector<double>& parts) {
    const bool none = *std::max_element(parts.begin(), parts.end()) == 0;
    for (std::size_t n = 0; n < parts.size(); ++n) {
      const double rise = none ? 1 : step;  // the first are not waited for
      parts[n] = std::clamp(parts[n] + (fresh(probes_[n]) ? rise : -step), 0.0, 1.0);
    }
  };
  move(weights_);
  if (std::any_of(probes_.begin(), probes_.end(), fresh)) move(shares_);
}

const LightField& LiveField::make(double time_s) {
  const double elapsed_s = last_s_ ? std::max(0.0, time_s - *last_s_) : 0;
  const std::vector<double> before = weights_;
  age(time_s);
  last_s_ = time_s;
  if (!sums_) return field_;  // no map yet: dark, confidence 0
  if (*std::max_element(weights_.begin(), weights_.end()) == 0) {
    std::fill(field_.confidence.begin(), field_.confidence.end(), 0.0f);
    return field_;
  }
  std::vector<ProbeSightings> sightings(probes_.size());
  for (std::size_t n = 0; n < probes_.size(); ++n)
    sightings[n] = {positions_[n], shares_[n] > 0,
                    probes_[n].cells ? probes_[n].cells->grid().theta_max_rad : 0.0, probes_[n].lamps};
  tracks_.update(sightings, elapsed_s);

  // What is left of each probe's light without the lamps whose places are known.
  std::vector<std::vector<Rgb>> rest(probes_.size());
  std::vector<RadianceHarmonics> harmonics(probes_.size(), RadianceHarmonics::Zero());
  for (std::size_t n = 0; n < probes_.size(); ++n) {
    rest[n] = probes_[n].radiance;
    rest[n].resize(static_cast<std::size_t>(partition_.cells()), Rgb::Zero());
    harmonics[n] = probes_[n].harmonics;
    for (const LampTrack& lamp : tracks_.lamps()) {
      const LampTrack::Link& link = lamp.links[n];
      if (link.sighting < 0) continue;
      const LampSighting& sighting = probes_[n].lamps[static_cast<std::size_t>(link.sighting)];
      const double taken = lamp.weight * link.share;
      for (const LampSighting::Share& share : sighting.shares)
        rest[n][share.cell] = (rest[n][share.cell] - static_cast<float>(taken) * share.radiance).max(0.0f);
      harmonics[n] -= taken * sighting.harmonics;
    }
    // What the cells cut from the probe's own harmonics is what remains of them.
    if (probes_[n].cells)
      for (std::size_t cell = 0; cell < rest[n].size(); ++cell)
        harmonics[n] -= (probes_[n].cell_harmonics.col(static_cast<Eigen::Index>(cell)) *
                         (static_cast<double>(probes_[n].finite[cell]) *
                          rest[n][cell].cast<double>().matrix().transpose()))
                            .array();
  }
  const auto count = static_cast<Eigen::Index>(probes_.size());
  Eigen::VectorXd shares(count);
  Eigen::MatrixXd values(count, 3);
  bool changed = false;
  for (std::size_t d = 0; d < directions_.size(); ++d) {
    Direction& direction = directions_[d];
    for (std::size_t n = 0; n < probes_.size(); ++n) {
      const auto row = static_cast<Eigen::Index>(n);
      const bool measured = probes_[n].measured(direction.cell, direction.solid_angle_sr) >= kMeasured;
      shares[row] = measured ? shares_[n] : 0;
      values.row(row) = rest[n][direction.cell].cast<double>().matrix().transpose();
    }
    if (direction.shares.size() != count || direction.shares != shares) {
      // Where nobody sees the direction any more its last light stays as well.
      if (shares.maxCoeff() > 0 || direction.completion.size() == 0)
        direction.completion = direction.kriging->completion(shares);
      direction.shares = shares;
      changed = true;
    }
    const Eigen::MatrixXd completed = direction.completion * values;
    for (int c = 0; c < 3; ++c)
      for (Eigen::Index n = 0; n < count; ++n)
        radiance_[(3 * d + static_cast<std::size_t>(c)) * probes_.size() + static_cast<std::size_t>(n)] =
            static_cast<float>(std::max(completed(n, c), 0.0));
  }
  std::fill(field_.radiance.begin(), field_.radiance.end(), 0.0f);
  sums_->add(radiance_, field_);
  add_own_harmonics(harmonics, changed);
  for (const LampTrack& lamp : tracks_.lamps()) add_near_lamp(lamp, positions_, shares_, field_);
  if (changed || weights_ != before) find_confidence();
  return field_;
}

// Remainders of the probes' harmonics, by place.
void LiveField::add_own_harmonics(const std::vector<RadianceHarmonics>& remainders, bool changed) {
  const auto count = static_cast<Eigen::Index>(probes_.size());
  if (changed)
    place_completion_ = places_.completion(Eigen::Map<const Eigen::VectorXd>(shares_.data(), count));
  Eigen::MatrixXd all(count, 3 * field_.harmonics());
  for (Eigen::Index n = 0; n < count; ++n)
    for (int h = 0; h < field_.harmonics(); ++h)
      for (int c = 0; c < 3; ++c) all(n, 3 * h + c) = remainders[static_cast<std::size_t>(n)](h, c);
  const Eigen::MatrixXf completed = (place_completion_ * all).cast<float>();
  const std::size_t points = field_.slab_points();
  for (int z = 0; z < options_.grid.size[2]; ++z)
    for (int h = 0; h < field_.harmonics(); ++h)
      for (int c = 0; c < 3; ++c) {
        float* out = field_.plane(z, h, c);
        for (Eigen::Index n = 0; n < count; ++n) {
          const float* weight = place_weights_.col(n).data() + static_cast<std::size_t>(z) * points;
          const float value = completed(n, 3 * h + c);
          for (std::size_t i = 0; i < points; ++i) out[i] += value * weight[i];
        }
      }
}

void LiveField::find_confidence() {
  std::fill(field_.confidence.begin(), field_.confidence.end(), 0.0f);
  std::vector<float> known;
  for (const Direction& direction : directions_) {
    const ShearPlane& plane = direction.plane;
    known.assign(direction.near.size(), 0.0f);
    for (std::size_t p = 0; p < known.size(); ++p)
      for (std::size_t n = 0; n < probes_.size(); ++n)
        if ((direction.near[p] >> n & 1) != 0 && direction.shares[static_cast<Eigen::Index>(n)] > 0)
          known[p] = std::max(known[p], static_cast<float>(weights_[n]));
    const float share = direction.solid_angle_sr / static_cast<float>(4 * kPi);
    const auto& axes = plane.axes();
    std::size_t point = 0;
    const std::array<int, 3> size = options_.grid.size;
    for (int k = 0; k < size[2]; ++k)
      for (int j = 0; j < size[1]; ++j)
        for (int i = 0; i < size[0]; ++i, ++point) {
          const std::array<int, 3> index = {i, j, k};
          const Vec2d at =
              plane.slice_origin(index[static_cast<std::size_t>(axes[2])]).cwiseMax(0.0) +
              Vec2d(index[static_cast<std::size_t>(axes[0])], index[static_cast<std::size_t>(axes[1])]);
          const auto x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
          const int pixel = std::min(y, plane.height() - 1) * plane.width() + std::min(x, plane.width() - 1);
          field_.confidence[point] += share * known[static_cast<std::size_t>(pixel)];
        }
  }
  for (float& part : field_.confidence) part = std::min(part, 1.0f);
}

}  // namespace lightwell
