// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "lighting/result.h"
#include "lighting/vector.h"

namespace lightwell {

// Radiance of every probe in every direction on disk: written by chunks of neighbouring probes, a file each, and read by
// buckets of neighbouring directions, which lie together in every file. How a take is cut depends on its size alone, so
// that any process may write or read any part; no two write one file, for network file systems do not keep apart what
// several machines write to one. A file carries a mark and a checksum: one that was not written whole is not taken.
class SampleStore {
 public:
  // folder: exists. mark: of all that the samples come from.
  SampleStore(std::filesystem::path folder, std::uint64_t mark, std::size_t probes, std::size_t directions);

  [[nodiscard]] std::size_t chunks() const { return (probes_ + chunk_probes_ - 1) / chunk_probes_; }
  // Probes of a chunk: first and one past the last.
  [[nodiscard]] std::size_t first_probe(std::size_t chunk) const { return chunk * chunk_probes_; }
  [[nodiscard]] std::size_t last_probe(std::size_t chunk) const;
  [[nodiscard]] std::size_t buckets() const { return (directions_ + width_ - 1) / width_; }
  // Directions of a bucket.
  [[nodiscard]] std::size_t first(std::size_t bucket) const { return bucket * width_; }
  [[nodiscard]] std::size_t last(std::size_t bucket) const;

  // Whether a chunk is there and whole: reads all of it.
  [[nodiscard]] bool holds(std::size_t chunk) const;
  // failed, with what is needed, where the disk has no room for so many chunks.
  [[nodiscard]] Status check_room(std::size_t chunks) const;
  // radiance: [probes of the chunk][directions].
  Status write(std::size_t chunk, std::span<const Rgb> radiance) const;
  // radiance: [probes][directions of the bucket]. All chunks have been written.
  Status read(std::size_t bucket, std::span<Rgb> radiance) const;

 private:
  struct Header;
  [[nodiscard]] std::filesystem::path file(std::size_t chunk) const;
  [[nodiscard]] Header header(std::size_t chunk) const;
  [[nodiscard]] std::size_t samples(std::size_t chunk) const;
  std::filesystem::path folder_;
  std::uint64_t mark_;
  std::size_t probes_, directions_, chunk_probes_, width_;
};

// Into so many parts are a take's directions cut, each summed by itself and the sums added in order: the result is the
// same to the last bit however many processes share them out.
inline constexpr std::size_t kFieldParts = 32;

}  // namespace lightwell
