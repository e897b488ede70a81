// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "daemon/configuration.h"
#include "daemon/pipeline/status.h"
#include "interface/sync_protocol.h"
#include "lighting/calibration.h"
#include "lighting/result.h"

namespace lightwell {

// The whole daemon in one process: capture → frame path → {DDS, HTTP, recorder}. Made from a configuration,
// ends with stop. All methods may be called from any thread.
class Daemon final : public DaemonControl {
 public:
  // What --check checks: addresses, calibration and whether the frames fit it, record
  // directory; nothing is opened or started.
  static Status check(const Configuration& configuration);

  static Result<std::unique_ptr<Daemon>> start(const Configuration& configuration);
  ~Daemon() override;

  // Lights, map, calibration and source change between two frames. What needs new sockets ([http], [dds],
  // [probe]) is refused, naming the key; nothing has changed then.
  Status reload(const Configuration& configuration);
  void close_take();
  // Closes the take, then everything else. Idempotent.
  void stop();

  [[nodiscard]] DaemonStatus status() const override;
  [[nodiscard]] std::optional<FitSnapshot> newest_fit() const override;
  Status start_recording(const std::string& file) override;
  Status stop_recording() override;

  [[nodiscard]] std::string url() const;  // of the page, with the real port where 0 was asked for
  // Advances while the frame path's loop turns.
  [[nodiscard]] std::uint64_t heartbeat() const;
  // Logs that the calibration no longer fits the frames, or fits again: once each. Looked at from one thread, now and
  // then, so that the frame path never waits for a log.
  void log_changes();
  // Shows on the sync board's LED how the daemon does; looked at as log_changes is.
  void tell_board();
  // To gravity, temperature and lamps (daemon/adaptation.h); about once a second, by the thread that reloads.
  void adapt();
  // A recording as source that is not looped has come to its end.
  [[nodiscard]] bool ended() const;

 private:
  void take_button(sync_press press);
  struct Parts;
  explicit Daemon(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace lightwell
