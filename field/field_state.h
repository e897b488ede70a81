// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "field/field_ranks.h"
#include "lighting/field/field_sums.h"
#include "lighting/result.h"

namespace lightwell {

// Hash of a text, that goes on from another.
// source: Fowler, Noll, Vo, FNV-1a of 64 bits
std::uint64_t fnv1a(std::string_view text, std::uint64_t hash = 0xcbf29ce484222325u);

// What a build comes from, as text.
struct FieldOrigin {
  std::string program;  // one line: a program that has another one may give the same take other numbers
  std::string take;     // pictures, places and options
  [[nodiscard]] std::string text() const;
};

// What a build has done so far, in a folder that the next build of the same take goes on with: sorted samples
// (field/sample_store.h) and, from time to time, the running sums. Every file carries the mark of what it comes from
// and checksums; what does not fit or is not whole counts as not there.
class FieldState {
 public:
  enum class Found { nothing, same, other_take, other_program };

  // folder/name, made where absent, emptied where it comes from anything else than made_from, locked by rank 0 against
  // another build at the same time (failed) while this lives. What is there and was not left by a build, or is a link, is
  // not touched (failed). An empty name: a new folder that goes with this object. folder: exists.
  static Result<FieldState> open(const std::filesystem::path& folder, const std::string& name,
                                 const FieldOrigin& made_from, FieldRanks& ranks);
  FieldState(FieldState&& other) noexcept;
  FieldState& operator=(FieldState&&) = delete;
  ~FieldState();

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::uint64_t mark() const { return mark_; }
  [[nodiscard]] Found found() const { return found_; }
  [[nodiscard]] bool is_kept() const { return kept_; }

  // Where the sums stand: parts added, what `best` chose, and what was seen by any probe so far.
  struct Progress {
    std::uint64_t parts = 0;
    std::int64_t support = 0;
    double held_out_error = 0;
    std::uint64_t seen_directions = 0;
    std::uint64_t seen_psr =
        0;  // solid angle, picosteradians: whole, so that the order of adding does not matter
  };
  Status save(const Progress& progress, const FieldSums& sums) const;
  // Into sums of the same size; nullopt, and sums as they were, where there are none to be trusted.
  [[nodiscard]] std::optional<Progress> load(FieldSums& sums) const;

  // Removes the folder and gives up the lock: on rank 0, who has it. Nothing is left to do the second time.
  void remove();

 private:
  FieldState(std::filesystem::path folder, bool kept) : folder_(std::move(folder)), kept_(kept) {}
  Status prepare(const FieldOrigin& made_from);
  std::filesystem::path folder_;
  bool kept_;
  std::uint64_t mark_ = 0;
  Found found_ = Found::nothing;
  int lock_ = -1;
};

}  // namespace lightwell
