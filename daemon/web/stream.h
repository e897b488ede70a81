// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <string>

struct evhttp_request;
struct evhttp_connection;

namespace lightwell {

// One frame as a server-sent event; shared by all clients.
struct StreamEvent {
  std::uint64_t number = 0;  // the snapshot's
  std::shared_ptr<const std::string> text;
};

// The open event streams. A client that does not read fast enough misses events instead of making the server
// remember them: at most kMaxPending bytes wait for a client, and the newest event follows as soon as it has
// caught up. Belongs to the server's thread.
class StreamClients {
 public:
  static constexpr std::size_t kMaxClients = 256;
  static constexpr std::size_t kMaxPending = 256 << 10;  // bytes; 20 frames of 72 lights

  StreamClients() = default;
  StreamClients(const StreamClients&) = delete;
  StreamClients& operator=(const StreamClients&) = delete;

  [[nodiscard]] bool full() const { return clients_.size() >= kMaxClients; }
  [[nodiscard]] std::size_t count() const { return clients_.size(); }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  // Answers the request with a stream that begins with `first`, where there is one.
  void add(evhttp_request* request, const StreamEvent& first);
  void push(const StreamEvent& event);
  // Comments that keep the connections alive and show the dead ones; sends the newest event to whoever missed
  // it.
  void heartbeat();

 private:
  struct Client {
    StreamClients* owner = nullptr;
    evhttp_request* request = nullptr;
    evhttp_connection* connection = nullptr;
    std::uint64_t last_number = 0;
  };
  void send(Client& client, const StreamEvent& event);
  [[nodiscard]] static std::size_t pending(const Client& client);
  static void on_close(evhttp_connection* connection, void* context);

  std::list<Client> clients_;  // addresses are given to libevent
  StreamEvent newest_;
  std::uint64_t dropped_ = 0;
};

}  // namespace lightwell
