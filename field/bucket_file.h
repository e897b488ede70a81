// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell {

// Radiance of every probe in every direction, sorted into buckets of neighbouring directions on disk: what is written
// probe by probe is read bucket by bucket. The file has no name, so that nothing is left of it however the program ends;
// its space is taken at once, so that a full disk shows before the work and not after it.
class BucketFile {
 public:
  // In this folder. failed where there is no room for it: says how much is needed.
  static Result<BucketFile> create(const std::filesystem::path& folder, std::size_t probes,
                                   std::size_t directions);
  BucketFile(BucketFile&& other) noexcept;
  BucketFile& operator=(BucketFile&&) = delete;
  ~BucketFile();

  [[nodiscard]] std::size_t buckets() const { return (directions_ + width_ - 1) / width_; }
  // Directions of a bucket: first and one past the last.
  [[nodiscard]] std::size_t first(std::size_t bucket) const { return bucket * width_; }
  [[nodiscard]] std::size_t last(std::size_t bucket) const;

  // Radiance of `count` probes from `first_probe` on, [count][directions]. Threads may write different probes.
  Status write(std::size_t first_probe, std::size_t count, std::span<const Rgb> radiance);
  // [probes][directions of the bucket].
  Status read(std::size_t bucket, std::span<Rgb> radiance) const;

 private:
  BucketFile(int fd, std::filesystem::path folder, std::size_t probes, std::size_t directions);
  [[nodiscard]] std::size_t offset(std::size_t bucket, std::size_t probe) const;
  int fd_;
  std::filesystem::path folder_;
  std::size_t probes_, directions_, width_;
};

}  // namespace lightwell
