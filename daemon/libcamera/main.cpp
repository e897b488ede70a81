// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// lightwell-libcamera: a camera of libcamera, for the program that starts this one and holds the other end of the socket
// that is its standard input (daemon/capture/libcamera_wire.h). libcamera 0.0.3 cannot let go of a camera whose device has
// vanished without failing an assertion of its own: this process can.
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <exception>
#include <nlohmann/json.hpp>

#include "daemon/libcamera/camera.h"
#include "daemon/libcamera/list.h"

namespace lightwell {
namespace {

constexpr int kHost = STDIN_FILENO;
constexpr int kLookMs = 300;   // for nodes that have vanished
constexpr unsigned kEndS = 3;  // a camera that does not stop in this time is left to the kernel

int tell(const CaptureFault& fault) {
  LibcameraMessage message{};
  message.kind = LibcameraMessage::Kind::fault;
  message.fault = {};
  message.fault.state = fault.state;
  put_text(message.fault.message, fault.message);
  send_message(kHost, message);
  return 0;
}

// What would speak to the device is never ended.
[[noreturn]] void leave_gone() {
  tell({SourceState::no_device, "is gone; looking for it"});
  ::_exit(0);
}

int serve(const nlohmann::json& wish) {
  CaptureOptions options;
  options.width = wish.at("width");
  options.height = wish.at("height");
  options.pixel_format = wish.at("pixel_format");
  options.rate_hz = wish.at("rate_hz");
  options.exposure_us = wish.at("exposure_us");
  options.controls = wish.at("controls");
  options.trigger = wish.at("trigger");
  options.buffers = wish.at("buffers");
  const auto on_frame = [](const LibcameraMessage::Frame& frame) {
    LibcameraMessage message{};
    message.kind = LibcameraMessage::Kind::frame;
    message.frame = frame;
    send_message(kHost, message);
  };
  LibcameraCamera camera(wish.at("id"), options, on_frame, leave_gone);
  if (const auto fault = camera.open()) return tell(*fault);
  std::vector<int> descriptors;
  const LibcameraMessage ready = camera.ready(descriptors);
  if (!send_message(kHost, ready, descriptors)) return 1;
  for (;;) {
    pollfd host{kHost, POLLIN, 0};
    if (::poll(&host, 1, kLookMs) <= 0) {
      if (camera.has_vanished()) leave_gone();
      continue;
    }
    LibcameraMessage message{};
    if (!receive_message(kHost, message)) break;
    if (message.kind == LibcameraMessage::Kind::give_back) camera.queue(message.buffer);
    if (message.kind != LibcameraMessage::Kind::go) continue;
    if (const auto fault = camera.start()) return tell(*fault);
  }
  if (camera.has_vanished()) ::_exit(0);
  ::alarm(kEndS);
  return 0;
}

bool is_socket(int fd) {
  int type = 0;
  socklen_t size = sizeof type;
  return ::getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_SEQPACKET;
}

}  // namespace
}  // namespace lightwell

int main(int argc, char** argv) {
  // The host ends it, by hanging up, when it has been told to end itself.
  ::signal(SIGINT, SIG_IGN);
  ::signal(SIGTERM, SIG_IGN);
  try {
    if (argc == 2 && std::strcmp(argv[1], "--list") == 0) {
      std::puts(lightwell::list_cameras().c_str());
      return 0;
    }
    if (argc == 2 && lightwell::is_socket(lightwell::kHost))
      return lightwell::serve(nlohmann::json::parse(argv[1]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell-libcamera: %s\n", error.what());
    return 1;
  }
  std::fputs(
      "lightwell-libcamera: lightwelld starts it for libcamera:ID; lightwell-libcamera --list lists "
      "cameras\n",
      stderr);
  return 2;
}
