// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/server.h"

#include <arpa/inet.h>
#include <event2/buffer.h>
#include <event2/event.h>
#include <event2/http.h>
#include <event2/keyvalq_struct.h>
#include <event2/util.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <deque>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>

#include "daemon/web/answers.h"
#include "daemon/web/json.h"
#include "daemon/web/listen_address.h"
#include "daemon/web/metrics.h"
#include "daemon/web/stream.h"
#include "interface/host_port.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMaxBody = 64 << 10;  // the largest request is a file name
// Up to here a body is read before it is refused, so that the answer arrives; beyond, libevent answers 413
// and closes while the client still sends, which may cost it the answer.
constexpr ev_ssize_t kMaxReadBody = 1 << 20;
constexpr ev_ssize_t kMaxHeaders = 16 << 10;
constexpr int kIdleTimeout_s = 30;
constexpr std::size_t kMaxQueued = 64;  // events between the two threads
constexpr auto kStopCheck = 100ms;      // how long the watcher may wait before it looks whether to stop
constexpr timeval kHeartbeat{1, 0};

const char* reason(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 409:
      return "Conflict";
    case 413:
      return "Content Too Large";
    case 503:
      return "Service Unavailable";
    default:
      return "Internal Server Error";
  }
}

std::string header(evhttp_request* request, const char* name) {
  const char* value = evhttp_find_header(evhttp_request_get_input_headers(request), name);
  return value == nullptr ? std::string() : value;
}

std::string body_of(evhttp_request* request) {
  evbuffer* input = evhttp_request_get_input_buffer(request);
  std::string body(evbuffer_get_length(input), '\0');
  evbuffer_copyout(input, body.data(), body.size());
  return body;
}

// Everything here is this machine's, now: nothing is cached, framed or mixed with foreign scripts.
void add_common_headers(evhttp_request* request) {
  evkeyvalq* headers = evhttp_request_get_output_headers(request);
  evhttp_add_header(headers, "Cache-Control", "no-store");
  evhttp_add_header(headers, "X-Content-Type-Options", "nosniff");
  evhttp_add_header(headers, "Cross-Origin-Resource-Policy", "same-origin");
  evhttp_add_header(headers, "Content-Security-Policy",
                    "default-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'");
}

bool is_head(evhttp_request* request) {
  return evhttp_request_get_command(request) == EVHTTP_REQ_HEAD;
}

std::size_t host_headers(evhttp_request* request) {
  std::size_t count = 0;
  for (const evkeyval* h = evhttp_request_get_input_headers(request)->tqh_first; h != nullptr;
       h = h->next.tqe_next)
    count += evutil_ascii_strcasecmp(h->key, "Host") == 0 ? 1 : 0;
  return count;
}

// libevent takes what follows "//" for a host, but a request line that begins with '/' is a path (RFC 9112, 3.2.1).
bool has_doubled_root(evhttp_request* request) {
  const char* given = evhttp_request_get_uri(request);
  return given != nullptr && std::string_view(given).starts_with("//");
}

// A HEAD gets the headers of the same GET (RFC 9110, 9.3.2).
void send(evhttp_request* request, const WebAnswer& answer) {
  add_common_headers(request);
  evkeyvalq* headers = evhttp_request_get_output_headers(request);
  evhttp_add_header(headers, "Content-Type", answer.type);
  evbuffer* buffer = evbuffer_new();
  if (is_head(request))
    evhttp_add_header(headers, "Content-Length", std::to_string(answer.body.size()).c_str());
  else
    evbuffer_add(buffer, answer.body.data(), answer.body.size());
  evhttp_send_reply(request, answer.status, reason(answer.status), buffer);
  evbuffer_free(buffer);
}

// A stream has no length to tell.
void send_stream_head(evhttp_request* request) {
  add_common_headers(request);
  evhttp_add_header(evhttp_request_get_output_headers(request), "Content-Type", "text/event-stream");
  evhttp_send_reply(request, 200, reason(200), nullptr);
}

}  // namespace

struct WebServer::Impl {
  Impl(WebServerOptions o, SnapshotChannel& s, DaemonControl& c)
      : options(std::move(o)), snapshots(s), answers(s, c, counters) {}
  ~Impl();
  Status listen(const HostPort& address);
  Status run();

  // The watcher's thread: turns snapshots into events and wakes the server's.
  void watch();
  // The server's thread.
  void serve();
  void on_wake();
  void handle(evhttp_request* request);
  std::optional<WebAnswer> refuse(evhttp_request* request);
  void open_stream(evhttp_request* request);

  WebServerOptions options;
  SnapshotChannel& snapshots;

  event_base* base = nullptr;
  evhttp* http = nullptr;
  event* wake = nullptr;
  event* heartbeat = nullptr;
  int wake_fd = -1;
  int port = 0;
  std::string host;

  StreamClients streams;
  WebCounters counters;
  WebAnswers answers;

  std::mutex mutex;
  std::deque<StreamEvent> queue;          // guarded by mutex
  std::atomic<std::size_t> listeners{0};  // events are made only while somebody listens
  std::atomic<bool> stopping{false};
  std::thread server_thread, watcher_thread;
};

WebServer::WebServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WebServer::~WebServer() = default;
int WebServer::port() const {
  return impl_->port;
}
std::string WebServer::url() const {
  const bool v6 = impl_->host.find(':') != std::string::npos;
  return "http://" + (v6 ? "[" + impl_->host + "]" : impl_->host) + ":" + std::to_string(impl_->port) + "/";
}

Result<std::unique_ptr<WebServer>> WebServer::start(const WebServerOptions& options,
                                                    SnapshotChannel& snapshots, DaemonControl& control) {
  if (const Status checked = check_listen_address(options.listen); !checked) return checked.error();
  auto impl = std::make_unique<Impl>(options, snapshots, control);
  if (const Status listening = impl->listen(*parse_host_port(options.listen)); !listening)
    return listening.error();
  if (const Status running = impl->run(); !running) return running.error();
  return std::unique_ptr<WebServer>(new WebServer(std::move(impl)));
}

WebServer::Impl::~Impl() {
  stopping = true;
  if (watcher_thread.joinable()) watcher_thread.join();
  if (server_thread.joinable()) {
    const std::uint64_t one = 1;
    verify_bug(::write(wake_fd, &one, sizeof one) == sizeof one, "an eventfd takes a count");
    server_thread.join();
  }
  if (http != nullptr) evhttp_free(http);
  if (heartbeat != nullptr) event_free(heartbeat);
  if (wake != nullptr) event_free(wake);
  if (base != nullptr) event_base_free(base);
  if (wake_fd >= 0) ::close(wake_fd);
}

Status WebServer::Impl::listen(const HostPort& address) {
  base = event_base_new();
  if (base != nullptr) http = evhttp_new(base);
  if (http == nullptr) return Error{ErrorKind::failed, "web server: no memory or no way to wait for sockets"};
  // libevent answers 413 and 400 beyond these.
  evhttp_set_max_body_size(http, kMaxReadBody);
  evhttp_set_max_headers_size(http, kMaxHeaders);
  evhttp_set_timeout(http, kIdleTimeout_s);
  // All that libevent knows come to handle(), which answers 405 itself.
  evhttp_set_allowed_methods(http, EVHTTP_REQ_GET | EVHTTP_REQ_POST | EVHTTP_REQ_HEAD | EVHTTP_REQ_PUT |
                                       EVHTTP_REQ_DELETE | EVHTTP_REQ_OPTIONS | EVHTTP_REQ_PATCH);
  evhttp_set_gencb(
      http, [](evhttp_request* request, void* self) { static_cast<Impl*>(self)->handle(request); }, this);
  evhttp_bound_socket* bound = evhttp_bind_socket_with_handle(http, address.host.c_str(), address.port);
  if (bound == nullptr)
    return Error{ErrorKind::failed, "[http] listen = \"" + options.listen + "\": " + std::strerror(errno) +
                                        "; another daemon may run, choose another port"};
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  ::getsockname(evhttp_bound_socket_get_fd(bound), reinterpret_cast<sockaddr*>(&name), &size);
  port = ntohs(name.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6*>(&name)->sin6_port
                                          : reinterpret_cast<sockaddr_in*>(&name)->sin_port);
  host = address.host;
  return {};
}

Status WebServer::Impl::run() {
  wake_fd = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake_fd < 0)
    return Error{ErrorKind::failed, std::string("web server: eventfd: ") + std::strerror(errno)};
  wake = event_new(
      base, wake_fd, EV_READ | EV_PERSIST,
      [](evutil_socket_t, short, void* self) { static_cast<Impl*>(self)->on_wake(); }, this);
  heartbeat = event_new(
      base, -1, EV_PERSIST,
      [](evutil_socket_t, short, void* self) { static_cast<Impl*>(self)->streams.heartbeat(); }, this);
  if (wake == nullptr || heartbeat == nullptr || event_add(wake, nullptr) != 0 ||
      event_add(heartbeat, &kHeartbeat) != 0)
    return Error{ErrorKind::failed, "web server: no memory for its events"};
  server_thread = std::thread([this] { serve(); });
  watcher_thread = std::thread([this] { watch(); });
  return {};
}

void WebServer::Impl::serve() {
  // A browser that closes while it is written to is no reason to end the process.
  sigset_t pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  ::pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
  event_base_dispatch(base);
}

void WebServer::Impl::watch() {
  std::uint64_t last = 0;
  while (!stopping) {
    std::string text;
    const auto asked_at = std::chrono::steady_clock::now();
    {
      const auto lease = snapshots.wait_newer(last, kStopCheck);
      if (lease) {
        last = lease->number;
        if (listeners > 0) write_stream_event(*lease, text);
      } else if (std::chrono::steady_clock::now() - asked_at < kStopCheck / 2) {
        std::this_thread::sleep_for(kStopCheck);  // a closed channel answers at once
      }
    }
    if (text.empty()) continue;
    {
      const std::scoped_lock lock(mutex);
      if (queue.size() >= kMaxQueued) queue.pop_front();
      queue.push_back({last, std::make_shared<const std::string>(std::move(text))});
    }
    const std::uint64_t one = 1;
    verify_bug(::write(wake_fd, &one, sizeof one) == sizeof one, "an eventfd takes a count");
  }
}

void WebServer::Impl::on_wake() {
  std::uint64_t count = 0;
  while (::read(wake_fd, &count, sizeof count) > 0) {
  }
  if (stopping) {
    event_base_loopbreak(base);
    return;
  }
  std::deque<StreamEvent> events;
  {
    const std::scoped_lock lock(mutex);
    events.swap(queue);
  }
  for (const StreamEvent& event : events) streams.push(event);
  listeners = streams.count();
}

std::optional<WebAnswer> WebServer::Impl::refuse(evhttp_request* request) {
  if (host_headers(request) > 1) return error_answer(400, "more than one Host header");
  const std::string request_host = header(request, "Host");
  const std::string origin = header(request, "Origin");
  const evhttp_uri* uri = evhttp_request_get_evhttp_uri(request);
  const bool foreign =
      !is_loopback_host_header(request_host) ||
      (uri != nullptr && evhttp_uri_get_host(uri) != nullptr && !has_doubled_root(request)) ||
      (!origin.empty() && !is_own_origin(origin, request_host));
  if (!foreign) return std::nullopt;
  ++counters.refused;
  return error_answer(403, "only pages of this server on this machine may ask (Host and Origin)");
}

void WebServer::Impl::handle(evhttp_request* request) {
  ++counters.requests;
  if (const auto refused = refuse(request)) return send(request, *refused);
  if (evbuffer_get_length(evhttp_request_get_input_buffer(request)) > kMaxBody)
    return send(request, error_answer(413, "the request's body is larger than 64 KiB"));
  const evhttp_uri* uri = evhttp_request_get_evhttp_uri(request);
  const char* given = uri == nullptr ? nullptr : evhttp_uri_get_path(uri);
  const std::string path = given == nullptr ? "" : given;
  const bool is_record = path == "/api/v1/record";
  const bool is_stream = path == "/api/v1/stream";
  const auto page = answers.find(path);
  if (has_doubled_root(request) || (!is_record && !is_stream && !page))
    return send(request, error_answer(404, "there is nothing at this path"));
  const evhttp_cmd_type method = evhttp_request_get_command(request);
  if (is_record ? method != EVHTTP_REQ_POST : method != EVHTTP_REQ_GET && method != EVHTTP_REQ_HEAD) {
    const char* allowed = is_record ? "POST" : "GET, HEAD";
    evhttp_add_header(evhttp_request_get_output_headers(request), "Allow", allowed);
    return send(request, error_answer(405, std::string("this path takes ") + allowed));
  }
  if (is_record) return send(request, answers.record(body_of(request)));
  if (is_stream && is_head(request)) return send_stream_head(request);
  if (is_stream) return open_stream(request);
  counters.stream_clients = streams.count();
  counters.stream_dropped = streams.dropped();
  send(request, page());
}

void WebServer::Impl::open_stream(evhttp_request* request) {
  if (streams.full()) return send(request, error_answer(503, "too many event streams are open"));
  add_common_headers(request);
  listeners = streams.count() + 1;  // before looking: what is published after this comes as an event
  StreamEvent first;
  if (const auto lease = snapshots.wait_newer(0, 0ms)) {
    std::string text;
    write_stream_event(*lease, text);
    first = {lease->number, std::make_shared<const std::string>(std::move(text))};
  }
  streams.add(request, first);
}

}  // namespace lightwell
