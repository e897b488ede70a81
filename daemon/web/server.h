// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "daemon/pipeline/snapshot.h"
#include "daemon/pipeline/status.h"

namespace lightwell {

struct WebServerOptions {
  std::string listen = "127.0.0.1:8650";  // loopback; port 0: the system chooses
};

// The page, the interface of interface/openapi.yaml, the event stream and the metrics, over HTTP (libevent),
// on two threads of its own: one serves, one waits for snapshots. Holds at most two leases. Every request
// must name loopback as its Host and come from no foreign Origin, or gets 403.
class WebServer {
 public:
  // snapshots and control outlive the server. usage: address malformed or beyond loopback; failed: cannot
  // listen.
  static Result<std::unique_ptr<WebServer>> start(const WebServerOptions& options, SnapshotChannel& snapshots,
                                                  DaemonControl& control);
  ~WebServer();  // within a second; open streams end
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  [[nodiscard]] int port() const;
  // "http://127.0.0.1:8650/"
  [[nodiscard]] std::string url() const;

 private:
  struct Impl;
  explicit WebServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lightwell
