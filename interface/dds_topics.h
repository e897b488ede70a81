// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "interface/dds_domain.h"
#include "interface/probe_messages.h"

namespace lightwell {

// Writers and readers of the topics of interface/lightwell.idl. Quality of service, and why:
//
//   LightFrame        best effort, keep last 1, volatile. Only the newest frame matters: a lost one is not
//   sent again,
//                     and a newer one never waits for it, as it would behind a reliable reader's gap. The
//                     writer keeps nothing for anybody, so that a reader that is slow, stopped or dead costs
//                     it nothing.
//   EnvironmentFrame  reliable, keep last 1, transient local, never blocking. A map is many packets, too many
//   for a small
//                     socket buffer: lost ones are repaired. A late joiner gets the newest map at once.
//   FitFrame          as EnvironmentFrame: small, and a late joiner gets the newest at once.
//   FieldFrame        as EnvironmentFrame.
//   ProbeStatus       reliable, keep last 1, transient local, never blocking. A late joiner gets the state at
//   once.
//
// All: keyed by probe, so that several probes share a domain; automatic liveliness with a lease of
// kLiveliness, after which a crashed or cut-off writer counts as gone (one that ends is gone at once); a
// write never waits: where a reliable reader holds the writer up, the message is dropped and write says so.
inline constexpr std::chrono::milliseconds kLiveliness{2000};

template <class Message>
class DdsWriter {
 public:
  // probe: 1 to 63 printable ASCII characters. usage: the name; failed: DDS.
  static Result<std::unique_ptr<DdsWriter>> create(std::shared_ptr<DdsDomain> domain,
                                                   const std::string& probe);
  ~DdsWriter();
  DdsWriter(const DdsWriter&) = delete;
  DdsWriter& operator=(const DdsWriter&) = delete;

  // Sends a copy. Text longer than the wire allows is cut. One thread at a time.
  // bad_input: more lights or bins than the wire allows, or an inconsistent map; failed: dropped.
  Status write(const Message& message);
  // Readers that are matched now.
  [[nodiscard]] int readers() const;

 private:
  struct Impl;
  explicit DdsWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

struct DdsReaderOptions {
  std::string probe{};  // empty: the first that is heard, until it is gone
  // All of them, whatever `probe` says: each take gives one message, its header says whose.
  bool every_probe = false;
};

// Gives the newest message that was not given yet; older ones are skipped. What a stranger sends wrong (NaN,
// directions that are not unit, counts that do not fit, parents that lead nowhere) is refused and counted.
// One thread at a time.
template <class Message>
class DdsReader {
 public:
  static Result<std::unique_ptr<DdsReader>> create(std::shared_ptr<DdsDomain> domain,
                                                   const DdsReaderOptions& options = {});
  ~DdsReader();
  DdsReader(const DdsReader&) = delete;
  DdsReader& operator=(const DdsReader&) = delete;

  // Waits up to timeout (zero: only what is there) for a message; reuses the memory of `message`, which is
  // unchanged where false is returned.
  bool take(Message& message, std::chrono::milliseconds timeout);
  // Writers of the topic that are alive now, of any probe; 0: nobody publishes.
  [[nodiscard]] int writers() const;
  // Time since the last message that was taken arrived; empty before the first.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> age() const;
  // Names under which more than one publishes (interface/followed_writers.h): one is followed, what the others send is
  // left out.
  [[nodiscard]] const std::set<std::string, std::less<>>& contested() const;
  // The probe that is listened to; empty before the first message where none was asked for.
  [[nodiscard]] const std::string& probe() const;
  // Malformed messages so far, and what was wrong with the last, in words.
  [[nodiscard]] std::uint64_t refused() const;
  [[nodiscard]] const std::string& refusal() const;

 private:
  struct Impl;
  explicit DdsReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

extern template class DdsWriter<LightFrame>;
extern template class DdsWriter<FitFrame>;
extern template class DdsWriter<EnvironmentFrame>;
extern template class DdsWriter<FieldFrame>;
extern template class DdsWriter<ProbeStatus>;
extern template class DdsReader<LightFrame>;
extern template class DdsReader<FitFrame>;
extern template class DdsReader<EnvironmentFrame>;
extern template class DdsReader<FieldFrame>;
extern template class DdsReader<ProbeStatus>;

using LightWriter = DdsWriter<LightFrame>;
using FitWriter = DdsWriter<FitFrame>;
using EnvironmentWriter = DdsWriter<EnvironmentFrame>;
using FieldWriter = DdsWriter<FieldFrame>;
using StatusWriter = DdsWriter<ProbeStatus>;
using LightReader = DdsReader<LightFrame>;
using FitReader = DdsReader<FitFrame>;
using EnvironmentReader = DdsReader<EnvironmentFrame>;
using FieldReader = DdsReader<FieldFrame>;
using StatusReader = DdsReader<ProbeStatus>;

}  // namespace lightwell
