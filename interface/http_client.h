// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "lighting/result.h"

namespace lightwell {

struct HttpRequest {
  std::string method = "GET";  // GET, HEAD, POST, PUT, DELETE, OPTIONS or PATCH
  std::string path = "/";      // with its query
  std::string body{};
  std::string content_type = "application/json";               // of the body
  std::vector<std::pair<std::string, std::string>> headers{};  // beside Host, Content-Length, Content-Type
  std::chrono::milliseconds timeout{5000};                     // of the whole exchange
  std::size_t body_limit_bytes = 64u << 20;                    // of the answer
};

struct HttpResponse {
  int status = 0;  // 200, 404, …
  std::string content_type;
  std::string body{};
};

// One request over one connection; returns when the whole answer is here. Any status is an answer.
// address: "127.0.0.1:8650". usage: malformed address or method; failed: nobody answers, timeout, answer too
// large.
Result<HttpResponse> http_request(const std::string& address, const HttpRequest& request);

}  // namespace lightwell
