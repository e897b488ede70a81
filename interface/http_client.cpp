// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/http_client.h"

#include <event2/buffer.h>
#include <event2/event.h>
#include <event2/http.h>
#include <signal.h>
#include <sys/time.h>

#include <array>
#include <memory>
#include <optional>

#include "interface/host_port.h"

namespace lightwell {
namespace {

struct BaseFree {
  void operator()(event_base* base) const { event_base_free(base); }
};
struct ConnectionFree {
  void operator()(evhttp_connection* connection) const { evhttp_connection_free(connection); }
};

std::optional<evhttp_cmd_type> command_of(const std::string& method) {
  using Entry = std::pair<const char*, evhttp_cmd_type>;
  static constexpr std::array<Entry, 7> kMethods{{{"GET", EVHTTP_REQ_GET},
                                                  {"HEAD", EVHTTP_REQ_HEAD},
                                                  {"POST", EVHTTP_REQ_POST},
                                                  {"PUT", EVHTTP_REQ_PUT},
                                                  {"DELETE", EVHTTP_REQ_DELETE},
                                                  {"OPTIONS", EVHTTP_REQ_OPTIONS},
                                                  {"PATCH", EVHTTP_REQ_PATCH}}};
  for (const auto& [name, command] : kMethods)
    if (method == name) return command;
  return std::nullopt;
}

// A server that closes while it is written to is an error to report, not a signal to die of.
class NoSigpipe {
 public:
  NoSigpipe() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoSigpipe() {
    const timespec now{};
    if (sigismember(&before_, SIGPIPE) == 0) ::sigtimedwait(&pipe_, nullptr, &now);
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoSigpipe(const NoSigpipe&) = delete;
  NoSigpipe& operator=(const NoSigpipe&) = delete;

 private:
  sigset_t pipe_{}, before_{};
};

// What the callbacks leave behind. status 0: no answer, with the reason.
struct Exchange {
  event_base* base = nullptr;
  HttpResponse response;
  std::string reason = "the connection was refused or broken";
};

void on_answer(evhttp_request* request, void* context) {
  auto& exchange = *static_cast<Exchange*>(context);
  if (request != nullptr && evhttp_request_get_response_code(request) != 0) {
    exchange.response.status = evhttp_request_get_response_code(request);
    const char* type = evhttp_find_header(evhttp_request_get_input_headers(request), "Content-Type");
    if (type != nullptr) exchange.response.content_type = type;
    evbuffer* input = evhttp_request_get_input_buffer(request);
    exchange.response.body.resize(evbuffer_get_length(input));
    evbuffer_copyout(input, exchange.response.body.data(), exchange.response.body.size());
  }
  event_base_loopbreak(exchange.base);
}

void on_error(evhttp_request_error error, void* context) {
  auto& exchange = *static_cast<Exchange*>(context);
  if (error == EVREQ_HTTP_TIMEOUT) exchange.reason = "no answer in time";
  if (error == EVREQ_HTTP_INVALID_HEADER) exchange.reason = "the answer is not HTTP";
  if (error == EVREQ_HTTP_DATA_TOO_LONG) exchange.reason = "the answer is too large";
}

void on_deadline(evutil_socket_t, short, void* context) {
  auto& exchange = *static_cast<Exchange*>(context);
  exchange.reason = "no answer in time";
  event_base_loopbreak(exchange.base);
}

void add_headers(evhttp_request* out, const std::string& address, const HttpRequest& request) {
  evkeyvalq* headers = evhttp_request_get_output_headers(out);
  evhttp_add_header(headers, "Connection", "close");
  if (!request.body.empty()) evhttp_add_header(headers, "Content-Type", request.content_type.c_str());
  bool own_host = false;
  for (const auto& [name, value] : request.headers) {
    own_host = own_host || name == "Host";
    evhttp_add_header(headers, name.c_str(), value.c_str());
  }
  if (!own_host) evhttp_add_header(headers, "Host", address.c_str());
}

}  // namespace

Result<HttpResponse> http_request(const std::string& address, const HttpRequest& request) {
  const auto target = parse_host_port(address);
  if (!target) return target.error();
  const auto command = command_of(request.method);
  if (!command) return Error{ErrorKind::usage, "HTTP method '" + request.method + "' is not known"};

  const NoSigpipe no_sigpipe;
  const std::unique_ptr<event_base, BaseFree> base(event_base_new());
  if (!base) return Error{ErrorKind::failed, "cannot make an event loop"};
  Exchange exchange;
  exchange.base = base.get();
  const std::unique_ptr<evhttp_connection, ConnectionFree> connection(
      evhttp_connection_base_new(base.get(), nullptr, target->host.c_str(), target->port));
  const auto failed = [&] {
    return Error{ErrorKind::failed, "http://" + address + request.path + ": " + exchange.reason};
  };
  if (!connection) return failed();
  evhttp_connection_set_max_body_size(connection.get(), static_cast<ev_ssize_t>(request.body_limit_bytes));

  // The request belongs to the connection once it is made; a failing make frees it too.
  evhttp_request* out = evhttp_request_new(on_answer, &exchange);
  evhttp_request_set_error_cb(out, on_error);
  add_headers(out, address, request);
  evbuffer_add(evhttp_request_get_output_buffer(out), request.body.data(), request.body.size());
  if (evhttp_make_request(connection.get(), out, *command, request.path.c_str()) != 0) return failed();

  // One deadline over name, connection and every byte: libevent's own timeouts start anew with each.
  const timeval deadline{request.timeout.count() / 1000,
                         static_cast<suseconds_t>(request.timeout.count() % 1000 * 1000)};
  event_base_once(base.get(), -1, EV_TIMEOUT, on_deadline, &exchange, &deadline);
  event_base_dispatch(base.get());
  if (exchange.response.status == 0) return failed();
  return std::move(exchange.response);
}

}  // namespace lightwell
