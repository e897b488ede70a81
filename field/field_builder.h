// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "field/field_ranks.h"
#include "field/field_state.h"
#include "lighting/field/direction_estimator.h"
#include "lighting/field/light_field.h"
#include "lighting/lat_long_image.h"
#include "lighting/result.h"

namespace lightwell {

// Pictures of one size from known places. picture and name are called by several threads at once.
struct ProbeTake {
  std::vector<Vec3d> positions;  // world, metres; at least one
  std::function<Result<LatLongImage>(std::size_t)> picture;
  std::function<std::string(std::size_t)> name;  // of a picture, for errors
};

struct FieldBuildOptions {
  FieldGrid grid;
  int degree = 4;
  FieldMethod method = FieldMethod::best;
  ProbeProjection projection = LatLongProbe{};
  int directions = 0;                    // cells of the sphere; 0: direction_count_for the grid
  unsigned threads = 1;                  // the result is the same to the last bit for any number
  std::filesystem::path scratch_folder;  // for sorted samples, probes × directions × 12 bytes while it runs

  // A folder in scratch_folder where an interrupted build stands and the next goes on, to the same bits. It stays until
  // it is removed (FieldBuild::state), but where a build fails for its pictures' sake. Empty: nothing stays.
  std::string state_name;
  std::string made_from;  // one line: the pictures and their projection, so that others are told from them
  std::chrono::seconds save_every{30};             // of the running sums
  std::function<void(const std::string&)> remark;  // a line to say on the way; on rank 0

  FieldRanks* ranks = nullptr;  // that share the work; the result is the same to the last bit for any number
};

struct FieldBuild {
  LightField field;           // on rank 0 alone
  int directions = 0;         // that a probe saw: in its picture, and not NaN
  double coverage = 0;        // part of the sphere that they are, 0 to 1
  int support = 0;            // rays of a fit, of best
  double held_out_error = 0;  // SupportChoice::held_out_error, of best; NaN: nothing can be foretold
  // Of best, on rank 0: RayConsistency.
  std::vector<DoubtfulProbe> doubtful;
  double close_difference = 0;
  // With a state_name: what has been done, locked against other builds while this lives. Rank 0 removes it when the field
  // is written.
  std::unique_ptr<FieldState> state;
};

// done of total: pictures first, then directions; called from one thread at a time, of rank 0.
using FieldProgress = std::function<void(std::size_t done, std::size_t total)>;

// Resamples a take to a field: pictures are cut into directions and sorted into buckets on disk, then each bucket is read
// once and added to the running sums. Memory: the field twice, a bucket, and a few pictures, however long the take.
// Fails where a picture cannot be read or is not of the first one's size, or ranks have not the same take (bad_input), or
// the disk is full (failed).
// source: Löw et al. 2009, section 3
Result<FieldBuild> build_field(const ProbeTake& take, const FieldBuildOptions& options,
                               const FieldProgress& progress = {});

}  // namespace lightwell
