// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/diagnosis.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <pthread.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "daemon/capture/gvcp.h"
#include "daemon/capture/inspect_camera.h"
#include "daemon/capture/socket_buffer.h"
#include "interface/host_port.h"
#include "interface/http_client.h"
#include "lighting/frame_format.h"
#include "lighting/instruction_set.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr int kSocketBufferWish = 8 << 20;  // CaptureOptions' own

std::string megabytes(double bytes) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), bytes < 10e6 ? "%.1f MB" : "%.0f MB", bytes / 1e6);
  return text.data();
}

// Frame size of the largest camera that can be asked goes into largest_frame_bytes.
Finding cameras(std::size_t& largest_frame_bytes) {
  const auto devices = gvcp_discover(500ms);
  if (devices.empty()) {
    return {"cameras", Verdict::warn, "no GigE Vision camera answers on any interface",
            "check cable, power and that the camera's address is in the interface's subnet; or start "
            "lightwell-camera"};
  }
  std::string list;
  for (const GvcpDevice& device : devices) {
    list += (list.empty() ? "" : ", ") + device.model + " at " + device.address;
    const auto camera = inspect_camera(device.address);
    if (!camera) {
      list += " (in use)";
      continue;
    }
    const auto format = pixel_format_from_name(camera->pixel_format).value_or(PixelFormat::mono16);
    largest_frame_bytes =
        std::max(largest_frame_bytes, FrameFormat{camera->width, camera->height, format}.bytes());
  }
  return {"cameras", Verdict::ok, list, ""};
}

Finding receive_buffer(std::size_t frame_bytes) {
  if (has_packet_socket())
    return {"receive buffer", Verdict::ok,
            "packet sockets are allowed, frames do not pass the receive buffer", ""};
  const std::size_t granted = granted_socket_buffer(kSocketBufferWish);
  const std::string remark = socket_buffer_remark(frame_bytes, granted);
  if (remark.empty())
    return {"receive buffer", Verdict::ok,
            megabytes(static_cast<double>(granted)) + " hold a frame of " +
                megabytes(static_cast<double>(frame_bytes)),
            ""};
  const std::size_t colon = remark.rfind(": ");
  return {"receive buffer", Verdict::warn, remark.substr(0, colon), remark.substr(colon + 2)};
}

// GigE Vision has one port; a simulated camera needs it on the loopback interface.
Finding camera_port() {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(kGvcpPort);
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool is_free = fd >= 0 && ::bind(fd, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0;
  if (fd >= 0) ::close(fd);
  const std::string port = "UDP port " + std::to_string(kGvcpPort) + " of 127.0.0.1 ";
  if (is_free) return {"camera port", Verdict::ok, port + "is free for a simulated camera", ""};
  if (gvcp_probe("127.0.0.1", 300ms))
    return {"camera port", Verdict::ok, port + "belongs to a camera that answers", ""};
  return {"camera port", Verdict::warn, port + "belongs to a program that does not answer",
          "end it (ss -lunp shows it), or lightwell-camera cannot start there"};
}

// Somebody accepts connections there; IPv4 addresses only, a name would have to be looked up.
bool somebody_listens(const HostPort& where) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(where.port);
  if (::inet_pton(AF_INET, where.host.c_str(), &to.sin_addr) != 1 || !is_loopback(where.host)) return false;
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool accepted = fd >= 0 && ::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  if (fd >= 0) ::close(fd);
  return accepted;
}

Finding daemon(const std::string& address, const HostPort& where) {
  HttpRequest request;
  request.path = "/api/v1/status";
  request.timeout = 1000ms;
  const auto answer = http_request(address, request);
  if (!answer && !somebody_listens(where)) {
    return {"daemon", Verdict::warn, "no daemon answers at http://" + address,
            "start it: lightwelld --config lightwell.toml"};
  }
  const auto status = answer ? nlohmann::json::parse(answer->body, nullptr, false)
                             : nlohmann::json(nlohmann::json::value_t::discarded);
  if (!answer || answer->status != 200 || !status.is_object()) {
    return {"daemon", Verdict::fail, "another program listens at http://" + address,
            "stop it, or give the daemon another address: [http] listen = \"ADDRESS:PORT\""};
  }
  const std::string alarm =
      status.contains("alarm") && status["alarm"].is_string() ? status["alarm"].get<std::string>() : "";
  if (!alarm.empty())
    return {"daemon", Verdict::warn, "runs at http://" + address + ": " + alarm, "lightwell status"};
  return {"daemon", Verdict::ok, "runs at http://" + address, ""};
}

Finding rendering() {
  void* library = ::dlopen("libEGL.so.1", RTLD_LAZY | RTLD_LOCAL);
  const bool usable = library != nullptr && ::dlsym(library, "eglGetPlatformDisplay") != nullptr;
  if (library != nullptr) ::dlclose(library);
  if (usable) return {"rendering", Verdict::ok, "EGL is installed", ""};
  return {"rendering", Verdict::warn, "EGL is missing, lightwell-render cannot draw",
          "apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri"};
}

Finding disk(const std::filesystem::path& directory) {
  const std::string where = directory.string();
  struct statvfs space {};
  if (::statvfs(where.c_str(), &space) != 0)
    return {"disk", Verdict::fail, where + ": " + std::strerror(errno),
            "create the folder, or name another with --record-dir"};
  if (::access(where.c_str(), W_OK | X_OK) != 0)
    return {"disk", Verdict::fail, where + " cannot be written to",
            "change its owner, or name another with --record-dir"};
  const double bytes = static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize);
  // 640×480 of 16 bit at 60 Hz, uncompressed.
  const double minutes = bytes / (640.0 * 480 * 2 * 60) / 60;
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.1f GB free in ", bytes / 1e9);
  const std::string message = text.data() + where;
  std::snprintf(text.data(), text.size(), ", %.0f minutes of 640×480 at 60 Hz", minutes);
  if (minutes < 5)
    return {"disk", Verdict::warn, message + text.data(),
            "make room, or name another folder with --record-dir"};
  return {"disk", Verdict::ok, message + text.data(), ""};
}

Finding real_time() {
  // On a thread of its own: what is granted ends with it.
  int error = 0;
  std::thread([&error] {
    sched_param priority{};
    priority.sched_priority = 1;
    error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &priority);
  }).join();
  if (error == 0) return {"real time", Verdict::ok, "this user may run real-time threads", ""};
  return {"real time", Verdict::warn,
          "this user may not run real-time threads, frames may be late on a busy machine",
          "run the daemon by its systemd unit, or give the user an rtprio limit in /etc/security/limits.d"};
}

Finding processor() {
  const std::string cores = std::to_string(std::thread::hardware_concurrency()) + " cores, ";
#if defined(__x86_64__)
  if (processor_has(InstructionSet::avx2)) return {"processor", Verdict::ok, cores + "AVX2", ""};
  return {"processor", Verdict::warn, cores + "no AVX2: frames take about twice as long",
          "use a processor from 2013 or later"};
#elif defined(__aarch64__)
  return {"processor", Verdict::ok, cores + "NEON", ""};
#else
  return {"processor", Verdict::warn, cores + "no vector instructions that Lightwell uses",
          "use an x86-64 or ARM64 machine"};
#endif
}

Finding clock() {
  std::string source;
  std::ifstream("/sys/devices/system/clocksource/clocksource0/current_clocksource") >> source;
  if (source == "hpet" || source == "acpi_pm" || source == "jiffies") {
    return {"clock", Verdict::warn, "the kernel's clock source is " + source + ", reading the time is slow",
            "boot with tsc=reliable where the processor's counter is sound"};
  }
  timex state{};
  const int status = ::adjtimex(&state);
  const std::string name = source.empty() ? std::string("monotonic clock") : "clock source " + source;
  if (status == TIME_ERROR || (state.status & STA_UNSYNC) != 0) {
    return {"clock", Verdict::warn, name + "; UTC is not synchronised, time labels of takes may be off",
            "run a time service: apt-get install systemd-timesyncd, or chrony, or linuxptp"};
  }
  return {"clock", Verdict::ok, name + ", UTC synchronised", ""};
}

}  // namespace

const char* name(Verdict verdict) {
  switch (verdict) {
    case Verdict::ok:
      return "ok";
    case Verdict::warn:
      return "warn";
    case Verdict::fail:
      return "fail";
  }
  return "unknown";
}

Result<std::vector<Finding>> diagnose(const DiagnosisOptions& options) {
  const auto where = parse_host_port(options.http);
  if (!where) return where.error();
  std::vector<Finding> findings;
  std::size_t frame_bytes = options.frame_bytes;
  std::size_t found_bytes = 0;
  findings.push_back(cameras(found_bytes));
  if (frame_bytes == 0) frame_bytes = found_bytes;
  if (frame_bytes == 0) frame_bytes = FrameFormat{1024, 1024, PixelFormat::mono16}.bytes();
  findings.push_back(receive_buffer(frame_bytes));
  findings.push_back(camera_port());
  findings.push_back(daemon(options.http, *where));
  findings.push_back(rendering());
  findings.push_back(disk(options.record_directory));
  findings.push_back(real_time());
  findings.push_back(processor());
  findings.push_back(clock());
  return findings;
}

}  // namespace lightwell
