// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/stream.h"

#include <event2/buffer.h>
#include <event2/bufferevent.h>
#include <event2/http.h>
#include <sys/time.h>

namespace lightwell {
namespace {

struct BufferFree {
  void operator()(evbuffer* buffer) const { evbuffer_free(buffer); }
};
using Buffer = std::unique_ptr<evbuffer, BufferFree>;

void release_text(const void*, std::size_t, void* holder) {
  delete static_cast<std::shared_ptr<const std::string>*>(holder);
}

}  // namespace

std::size_t StreamClients::pending(const Client& client) {
  return evbuffer_get_length(bufferevent_get_output(evhttp_connection_get_bufferevent(client.connection)));
}

void StreamClients::on_close(evhttp_connection* connection, void* context) {
  auto& clients = static_cast<Client*>(context)->owner->clients_;
  // Where the client left, libevent takes the unfinished request off the connection and leaves it to us:
  // ending it frees it. Where the server stops, it still belongs to the connection and goes with it.
  evhttp_request* request = static_cast<Client*>(context)->request;
  if (evhttp_request_get_connection(request) == nullptr) evhttp_send_reply_end(request);
  clients.remove_if([connection](const Client& client) { return client.connection == connection; });
}

void StreamClients::add(evhttp_request* request, const StreamEvent& first) {
  clients_.push_back({this, request, evhttp_request_get_connection(request), 0});
  Client& client = clients_.back();
  evhttp_connection_set_closecb(client.connection, on_close, &client);
  // A stream's client says nothing more: only writing may time out, which is how a dead one is noticed.
  const timeval write_timeout{30, 0};
  bufferevent_set_timeouts(evhttp_connection_get_bufferevent(client.connection), nullptr, &write_timeout);
  evkeyvalq* headers = evhttp_request_get_output_headers(request);
  evhttp_add_header(headers, "Content-Type", "text/event-stream");
  evhttp_send_reply_start(request, 200, "OK");
  // A browser that lost us tries again after half a second.
  const Buffer buffer(evbuffer_new());
  evbuffer_add_printf(buffer.get(), "retry: 500\n\n");
  evhttp_send_reply_chunk(request, buffer.get());
  if (first.text) send(client, first);
}

void StreamClients::send(Client& client, const StreamEvent& event) {
  if (client.last_number == event.number) return;
  if (pending(client) + event.text->size() > kMaxPending) {
    ++dropped_;
    return;
  }
  client.last_number = event.number;
  const Buffer buffer(evbuffer_new());
  // All clients share one text, which lives until the last has got it.
  evbuffer_add_reference(buffer.get(), event.text->data(), event.text->size(), release_text,
                         new std::shared_ptr<const std::string>(event.text));
  evhttp_send_reply_chunk(client.request, buffer.get());
}

void StreamClients::push(const StreamEvent& event) {
  newest_ = event;
  for (Client& client : clients_) send(client, event);
}

void StreamClients::heartbeat() {
  for (Client& client : clients_) {
    if (newest_.text && client.last_number != newest_.number) send(client, newest_);
    if (pending(client) > 0) continue;
    const Buffer buffer(evbuffer_new());
    evbuffer_add_printf(buffer.get(), ":\n\n");
    evhttp_send_reply_chunk(client.request, buffer.get());
  }
}

}  // namespace lightwell
