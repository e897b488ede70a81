// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lighting/result.h"

namespace lightwell {

// The multicast port of a domain is 7400 + 250 × domain + 1 (DDSI-RTPS 2.3, 9.6.1.1) and must fit 16 bits;
// Cyclone DDS opens all up to this one and refuses the next.
inline constexpr int kMaxDdsDomain = 232;

struct DdsOptions {
  int domain = 0;                // 0 to kMaxDdsDomain; programs see each other only inside one domain
  std::string interface = "lo";  // network interface, by name or address; "lo" reaches this machine only
};

// What can be said of the options before anything is opened. usage: domain out of range, no such interface
Status check_dds_options(const DdsOptions& options);

// A participant on a DDS domain, with multicast discovery on one interface. The configuration is made here
// and does not depend on the surroundings, except that a user who sets CYCLONEDDS_URI gets that configuration
// instead. Readers and writers share the object and keep it alive. Opening a domain twice in a process gives
// the same object.
class DdsDomain {
 public:
  // usage: domain out of range, no such interface, or the domain is already open on another one; failed: the
  // network.
  static Result<std::shared_ptr<DdsDomain>> open(const DdsOptions& options);
  ~DdsDomain();
  DdsDomain(const DdsDomain&) = delete;
  DdsDomain& operator=(const DdsDomain&) = delete;

  [[nodiscard]] std::int32_t participant() const { return participant_; }  // Cyclone DDS entity handle
  [[nodiscard]] const DdsOptions& options() const { return options_; }

 private:
  explicit DdsDomain(DdsOptions options) : options_(std::move(options)) {}
  DdsOptions options_;
  std::int32_t domain_ = 0;
  std::int32_t participant_ = 0;
};

}  // namespace lightwell
