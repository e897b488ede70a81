// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "daemon/capture/capture_session.h"

namespace lightwell {

// One connection to a GigE Vision or USB3 Vision camera through Aravis: camera, stream and buffers, made and torn down
// together. Aravis fills our own buffers: frames are handed on without a copy. Threads beside the session's own: Aravis's
// stream thread, which stamps what has come and queues it; one that asks the camera once a second what frames do not
// tell, since a camera that has died takes seconds not to answer.
class AravisSession final : public CaptureSession {
 public:
  // address: as make_aravis_source has it
  AravisSession(std::string address, const CaptureOptions& options);
  ~AravisSession() override;
  AravisSession(const AravisSession&) = delete;
  AravisSession& operator=(const AravisSession&) = delete;

  std::optional<CaptureFault> find() override;
  std::optional<CaptureFault> open() override;
  std::optional<CaptureFault> start() override;
  Event next(std::chrono::milliseconds timeout, SessionFrame& frame) noexcept override;  // allocates nothing
  [[nodiscard]] CaptureFault fault() const override;
  std::string refresh() override;
  [[nodiscard]] bool sets_exposure() const override { return has_exposure_; }
  Status set_exposure_us(double exposure_us) override;
  [[nodiscard]] const SessionSettings& settings() const override { return settings_; }
  void give_back(std::size_t buffer) noexcept override;
  void wake() noexcept override;
  void close() noexcept override;
  [[nodiscard]] bool all_returned() const noexcept override;

 private:
  struct Handles;  // everything Aravis
  Event describe(std::size_t buffer, SessionFrame& frame) noexcept;

  const std::string address_;
  const CaptureOptions options_;
  SessionSettings settings_;
  bool has_exposure_ = false;  // from open on
  double gain_db_ = 0;
  float temperature_c_ = 0;
  std::unique_ptr<Handles> handles_;
};

}  // namespace lightwell
