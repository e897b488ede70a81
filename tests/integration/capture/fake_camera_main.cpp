// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// A GigE Vision camera for tests, in a process of its own so that it can die: Aravis's fake camera on
// 127.0.0.1. fake-camera WIDTH HEIGHT RATE_HZ SERIAL; "ready" on stdout when it listens. Every byte of a
// frame is the frame's number modulo 256. Commands on stdin, one a line: silent | resume | stop | slow MS |
// loss RATIO | exposure US.
#include <arv.h>
#include <signal.h>
#include <sys/prctl.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <sstream>
#include <string>
#include <thread>

namespace {

std::atomic<int> slow_ms{0};
std::atomic<bool> silent{false};
std::atomic<unsigned char> number{0};

void fill(ArvBuffer* buffer, void*, guint32, guint32, ArvPixelFormat format) {
  std::size_t received = 0;  // 0 here; the size follows from the format
  void* data = const_cast<void*>(arv_buffer_get_data(buffer, &received));
  const auto pixels = static_cast<std::size_t>(arv_buffer_get_image_width(buffer)) *
                      static_cast<std::size_t>(arv_buffer_get_image_height(buffer));
  std::memset(data, number++, pixels * ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8);
  if (slow_ms > 0) g_usleep(static_cast<gulong>(slow_ms) * 1000);
}

void obey(ArvGvFakeCamera* server, const std::string& line) {
  ArvFakeCamera* camera = arv_gv_fake_camera_get_fake_camera(server);
  std::istringstream words(line);
  std::string command;
  double value = 0;
  words >> command >> value;
  if (command == "silent") silent = true;
  if (command == "resume") {
    silent = false;
    arv_fake_camera_write_register(camera, ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 1);
  }
  if (command == "stop") arv_fake_camera_write_register(camera, ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 0);
  if (command == "slow") slow_ms = static_cast<int>(value);
  if (command == "loss") g_object_set(server, "gvsp-lost-ratio", value, nullptr);
  if (command == "exposure")
    arv_fake_camera_write_register(camera, ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US,
                                   static_cast<guint32>(value));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  auto* server = static_cast<ArvGvFakeCamera*>(g_object_new(ARV_TYPE_GV_FAKE_CAMERA, "interface-name",
                                                            "127.0.0.1", "serial-number", argv[4], nullptr));
  if (!arv_gv_fake_camera_is_running(server)) return 1;
  ArvFakeCamera* camera = arv_gv_fake_camera_get_fake_camera(server);
  const auto set = [&](guint32 address, double value) {
    arv_fake_camera_write_register(camera, address, static_cast<guint32>(value));
  };
  set(ARV_FAKE_CAMERA_REGISTER_WIDTH, std::atof(argv[1]));
  set(ARV_FAKE_CAMERA_REGISTER_HEIGHT, std::atof(argv[2]));
  set(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, 1e6 / std::atof(argv[3]));
  set(ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US, 1000);
  arv_fake_camera_set_fill_pattern(camera, fill, nullptr);
  // A camera that answers but sends nothing, however often it is told to start.
  std::thread([camera] {
    for (;; g_usleep(1000))
      if (silent) arv_fake_camera_write_register(camera, ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 0);
  }).detach();
  std::cout << "ready" << std::endl;
  for (std::string line; std::getline(std::cin, line);) obey(server, line);
  std::_Exit(0);
}
