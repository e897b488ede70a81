// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/aravis_session.h"

#include <arpa/inet.h>
#include <arv.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <mutex>
#include <vector>

#include "daemon/capture/buffer_pool.h"
#include "daemon/capture/glib_error.h"
#include "daemon/capture/socket_buffer.h"
#include "daemon/clock.h"

namespace lightwell {
namespace {

Error camera_error(const char* what, const GlibError& error) {
  return {ErrorKind::failed, std::string(what) + ": " + error.text()};
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

// Largest IP packet of the interface that has this address, 0 where it is not found.
int interface_mtu(const std::string& address) {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return 0;
  ifreq request{};
  for (const ifaddrs* it = list; it != nullptr; it = it->ifa_next) {
    if (it->ifa_addr == nullptr || it->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in at{};
    std::memcpy(&at, it->ifa_addr, sizeof at);
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &at.sin_addr, text.data(), text.size());
    if (address != text.data()) continue;
    std::strncpy(request.ifr_name, it->ifa_name, IFNAMSIZ - 1);
    break;
  }
  ::freeifaddrs(list);
  if (request.ifr_name[0] == '\0') return 0;
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool ok = fd >= 0 && ::ioctl(fd, SIOCGIFMTU, &request) == 0;
  if (fd >= 0) ::close(fd);
  return ok ? request.ifr_mtu : 0;
}

std::string interface_address(ArvCamera* camera) {
  GSocketAddress* at = arv_gv_device_get_interface_address(ARV_GV_DEVICE(arv_camera_get_device(camera)));
  if (!G_IS_INET_SOCKET_ADDRESS(at)) return {};
  char* text = g_inet_address_to_string(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(at)));
  std::string out = text;
  g_free(text);
  return out;
}

std::string supported_formats() {
  std::string list;
  for (int i = 0; i <= static_cast<int>(PixelFormat::bayer_rg16); ++i) {
    if (i > 0) list += ", ";
    list += name(static_cast<PixelFormat>(i));
  }
  return list;
}

}  // namespace

struct AravisSession::Handles {
  AravisSession* session = nullptr;
  ArvCamera* camera = nullptr;
  gulong control_lost_handler = 0;
  std::atomic<ArvStream*> stream{nullptr};
  ArvPixelFormat pixel_format = 0;
  std::unique_ptr<BufferPool> pool;
  std::atomic<int> live_buffers{0};  // ArvBuffers that exist
  std::mutex mutex;                  // guards what follows, and pushing into the stream against its end
  bool closed = false;
  // Aravis's queues allocate now and then, and the end of a lease must not: buffers wait here for the
  // stream's thread.
  std::vector<ArvBuffer*> returned;  // never more than the pool has

  // On the stream's thread. The buffer was queued just before; taking it here keeps the queue empty, so that
  // a consumer that does not come for a while still finds the freshest frame and the camera never runs out of
  // buffers.
  static void on_stream(void* context, ArvStreamCallbackType type, ArvBuffer*) noexcept {
    auto* self = static_cast<Handles*>(context);
    ArvStream* stream = self->stream.load(std::memory_order_acquire);
    if (type != ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE || stream == nullptr) return;
    const std::int64_t now_ns = mono_now_ns();
    while (ArvBuffer* buffer = arv_stream_try_pop_buffer(stream))
      self->session->listener_.frame_done(*self->session, self->describe(buffer, now_ns));
    self->session->recycle();
  }
  static void on_control_lost(ArvDevice*, gpointer context) noexcept {
    auto* self = static_cast<Handles*>(context);
    self->session->listener_.control_lost(*self->session);
  }
  static void on_buffer_freed(void* context) noexcept {
    static_cast<Handles*>(context)->live_buffers.fetch_sub(1);
  }

  [[nodiscard]] ReceivedFrame describe(ArvBuffer* buffer, std::int64_t now_ns) const noexcept {
    using Outcome = ReceivedFrame::Outcome;
    const FrameFormat& format = session->settings_.format;
    ReceivedFrame frame;
    frame.buffer = buffer;
    frame.frame_id = arv_buffer_get_frame_id(buffer);
    frame.received_mono_ns = now_ns;
    const ArvBufferStatus status = arv_buffer_get_status(buffer);
    if (status == ARV_BUFFER_STATUS_SIZE_MISMATCH) frame.outcome = Outcome::wrong_format;
    if (status != ARV_BUFFER_STATUS_SUCCESS) return frame;
    frame.outcome = Outcome::wrong_format;
    const ArvBufferPayloadType payload = arv_buffer_get_payload_type(buffer);
    if (payload != ARV_BUFFER_PAYLOAD_TYPE_IMAGE && payload != ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA)
      return frame;
    gint x_padding = 0, y_padding = 0;
    arv_buffer_get_image_padding(buffer, &x_padding, &y_padding);
    std::size_t size = 0;
    const void* data = arv_buffer_get_data(buffer, &size);
    if (arv_buffer_get_image_width(buffer) != format.width ||
        arv_buffer_get_image_height(buffer) != format.height ||
        arv_buffer_get_image_pixel_format(buffer) != pixel_format || x_padding != 0 || size < format.bytes())
      return frame;
    frame.outcome = Outcome::complete;
    frame.t_device_ns = arv_buffer_get_timestamp(buffer);
    frame.bytes = {static_cast<const std::byte*>(data), format.bytes()};
    return frame;
  }
};

AravisSession::AravisSession(const CaptureOptions& options, Listener& listener)
    : options_(options), listener_(listener), handles_(std::make_unique<Handles>()) {
  handles_->session = this;
}

AravisSession::~AravisSession() {
  close(false);
  verify_bug(all_returned(), "a frame lease outlived its capture source");
}

Status AravisSession::open(const std::string& address) {
  Status status = connect(address);
  if (status) status = configure();
  if (status) status = read_back();
  return status;
}

Status AravisSession::connect(const std::string& address) {
  GlibError error;
  Handles& h = *handles_;
  h.camera = arv_camera_new(address.c_str(), error.out());
  if (h.camera == nullptr || error) return camera_error("cannot be opened", error);
  if (!arv_camera_is_gv_device(h.camera)) return Error{ErrorKind::failed, "is not a GigE Vision camera"};
  ArvDevice* device = arv_camera_get_device(h.camera);
  if (!arv_gv_device_is_controller(ARV_GV_DEVICE(device)))
    return Error{ErrorKind::failed, "another program has control of the camera; it can serve only one"};
  h.control_lost_handler = g_signal_connect(device, "control-lost", G_CALLBACK(Handles::on_control_lost), &h);
  // Off by default, and then a value out of range is accepted without a word.
  arv_camera_set_range_check_policy(h.camera, ARV_RANGE_CHECK_POLICY_ENABLE);
  arv_camera_set_access_check_policy(h.camera, ARV_ACCESS_CHECK_POLICY_ENABLE);
  // A camera whose last client died still streams to it, and refuses new settings meanwhile.
  arv_camera_stop_acquisition(h.camera, error.out());
  if (error) return camera_error("AcquisitionStop", error);
  return {};
}

Status AravisSession::configure() {
  GlibError error;
  ArvCamera* camera = handles_->camera;
  if (!options_.pixel_format.empty()) {
    arv_camera_set_pixel_format_from_string(camera, options_.pixel_format.c_str(), error.out());
    if (error) return camera_error(("PixelFormat " + options_.pixel_format).c_str(), error);
  }
  if (options_.width > 0 || options_.height > 0) {
    // From the sensor's corner, so that pixel coordinates stay those of the lens calibration.
    arv_camera_set_region(camera, 0, 0, options_.width > 0 ? options_.width : -1,
                          options_.height > 0 ? options_.height : -1, error.out());
    if (error) return camera_error("Width, Height", error);
  }
  if (options_.rate_hz > 0) {  // also ends triggering
    arv_camera_set_frame_rate(camera, options_.rate_hz, error.out());
    if (error) return camera_error(("frame rate " + number(options_.rate_hz) + " Hz").c_str(), error);
  }
  if (options_.exposure_us > 0) {
    if (arv_camera_is_exposure_auto_available(camera, nullptr))
      arv_camera_set_exposure_time_auto(camera, ARV_AUTO_OFF, error.out());
    if (!error) arv_camera_set_exposure_time(camera, options_.exposure_us, error.out());
    if (error) return camera_error(("exposure " + number(options_.exposure_us) + " µs").c_str(), error);
  }
  arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  const int mtu = interface_mtu(interface_address(camera));
  const int packet = mtu > 0 ? std::min(options_.packet_size, mtu) : options_.packet_size;
  arv_camera_gv_set_packet_size(camera, packet, error.out());
  if (error) return camera_error(("packet size " + std::to_string(packet)).c_str(), error);
  return {};
}

Status AravisSession::read_back() {
  GlibError error;
  ArvCamera* camera = handles_->camera;
  const auto text = [&](const char* (*get)(ArvCamera*, GError**)) {
    const char* value = get(camera, nullptr);
    return std::string(value != nullptr ? value : "?");
  };
  settings_.name = text(arv_camera_get_vendor_name) + " " + text(arv_camera_get_model_name) + " (" +
                   text(arv_camera_get_device_serial_number) + ")";
  const char* format = arv_camera_get_pixel_format_as_string(camera, error.out());
  if (error || format == nullptr) return camera_error("PixelFormat", error);
  const auto known = pixel_format_from_name(format);
  if (!known) {
    return Error{ErrorKind::failed,
                 std::string("PixelFormat ") + format + " is not supported; " + supported_formats() + " are"};
  }
  handles_->pixel_format = arv_camera_get_pixel_format(camera, error.out());
  if (error) return camera_error("PixelFormat", error);
  gint x = 0, y = 0, width = 0, height = 0;
  arv_camera_get_region(camera, &x, &y, &width, &height, error.out());
  if (error) return camera_error("Width, Height", error);
  settings_.format = {width, height, *known};
  settings_.rate_hz = arv_camera_is_frame_rate_available(camera, nullptr)
                          ? arv_camera_get_frame_rate(camera, error.out())
                          : 0;
  if (error) return camera_error("frame rate", error);
  settings_.packet_size = static_cast<int>(arv_camera_gv_get_packet_size(camera, error.out()));
  if (error) return camera_error("packet size", error);
  if (arv_camera_is_feature_available(camera, "TriggerMode", nullptr)) {
    const char* mode = arv_camera_get_string(camera, "TriggerMode", nullptr);
    settings_.free_running = mode == nullptr || std::strcmp(mode, "On") != 0;
  }
  if (!refresh()) return Error{ErrorKind::failed, "exposure and gain cannot be read"};
  // A rate off by more than a per cent was clamped, not rounded.
  if (options_.rate_hz > 0 && std::abs(settings_.rate_hz - options_.rate_hz) > 0.01 * options_.rate_hz)
    settings_.remark =
        "asked for " + number(options_.rate_hz) + " Hz, the camera grants " + number(settings_.rate_hz);
  const std::string buffer = has_packet_socket()
                                 ? std::string()
                                 : socket_buffer_remark(settings_.format.bytes(),
                                                        granted_socket_buffer(options_.socket_buffer_bytes));
  if (!buffer.empty()) settings_.remark += (settings_.remark.empty() ? "" : "; ") + buffer;
  return {};
}

bool AravisSession::refresh() {
  ArvCamera* camera = handles_->camera;
  bool answered = true;
  // A camera that does not answer must not pass for one without the feature.
  const auto read = [&](auto is_available, double absent, auto get) {
    GlibError error;
    const bool available = is_available(error.out());
    const double value = available && !error ? get(error.out()) : absent;
    answered = answered && !error;
    return value;
  };
  const double exposure_us =
      read([&](GError** e) { return arv_camera_is_exposure_time_available(camera, e); }, 0,
           [&](GError** e) { return arv_camera_get_exposure_time(camera, e); });
  const double gain_db = read([&](GError** e) { return arv_camera_is_gain_available(camera, e); }, 0,
                              [&](GError** e) { return arv_camera_get_gain(camera, e); });
  const double temperature_c =
      read([&](GError** e) { return arv_camera_is_feature_available(camera, "DeviceTemperature", e); },
           std::numeric_limits<double>::quiet_NaN(),
           [&](GError** e) { return arv_camera_get_float(camera, "DeviceTemperature", e); });
  if (!answered) return false;
  settings_.exposure_us = exposure_us;
  settings_.gain_db = gain_db;
  settings_.temperature_c = static_cast<float>(temperature_c);
  return true;
}

Status AravisSession::start() {
  GlibError error;
  Handles& h = *handles_;
  const std::size_t payload = arv_camera_get_payload(h.camera, error.out());
  if (error) return camera_error("PayloadSize", error);
  if (payload < settings_.format.bytes()) {
    return Error{ErrorKind::failed, "PayloadSize " + std::to_string(payload) +
                                        " is smaller than a frame of " +
                                        std::to_string(settings_.format.bytes()) + " bytes"};
  }
  ArvStream* stream = arv_camera_create_stream(h.camera, Handles::on_stream, &h, error.out());
  if (stream == nullptr || error) return camera_error("stream", error);
  g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
               options_.socket_buffer_bytes, nullptr);
  // A frame that waits for packets sent again holds up those after it: two periods, within what a network
  // needs.
  if (settings_.rate_hz > 0) {
    const double retention_us = std::clamp(2e6 / settings_.rate_hz, 30e3, 200e3);
    g_object_set(stream, "frame-retention", static_cast<guint>(retention_us), nullptr);
  }
  h.stream.store(stream, std::memory_order_release);
  h.pool = BufferPool::create(payload, static_cast<std::size_t>(options_.buffers));
  if (h.pool == nullptr) {
    return Error{ErrorKind::failed, "no memory for " + std::to_string(options_.buffers) + " frames of " +
                                        std::to_string(payload) + " bytes"};
  }
  h.returned.reserve(h.pool->count());
  for (std::size_t i = 0; i < h.pool->count(); ++i) {
    h.live_buffers.fetch_add(1);
    arv_stream_push_buffer(
        stream, arv_buffer_new_full(payload, h.pool->buffer(i).data(), &h, Handles::on_buffer_freed));
  }
  arv_camera_start_acquisition(h.camera, error.out());
  if (error) return camera_error("AcquisitionStart", error);
  return {};
}

void AravisSession::give_back(void* buffer) noexcept {
  Handles& h = *handles_;
  const std::lock_guard lock(h.mutex);
  if (h.closed)
    g_object_unref(buffer);
  else
    h.returned.push_back(static_cast<ArvBuffer*>(buffer));
}

void AravisSession::recycle() noexcept {
  Handles& h = *handles_;
  const std::lock_guard lock(h.mutex);
  if (h.closed) return;
  for (ArvBuffer* buffer : h.returned)
    arv_stream_push_buffer(h.stream.load(std::memory_order_relaxed), buffer);
  h.returned.clear();
}

void AravisSession::close(bool stop_camera) noexcept {
  Handles& h = *handles_;
  {
    const std::lock_guard lock(h.mutex);
    h.closed = true;
    for (ArvBuffer* buffer : h.returned) g_object_unref(buffer);
    h.returned.clear();
  }
  if (h.camera != nullptr && stop_camera) arv_camera_stop_acquisition(h.camera, nullptr);
  if (h.camera != nullptr && h.control_lost_handler != 0)
    g_signal_handler_disconnect(arv_camera_get_device(h.camera), h.control_lost_handler);
  h.control_lost_handler = 0;
  // The stream's thread ends in here; the pointer must stay readable for it until then.
  if (ArvStream* stream = h.stream.load()) g_object_unref(stream);
  h.stream.store(nullptr);
  g_clear_object(&h.camera);
}

bool AravisSession::all_returned() const noexcept {
  return handles_->live_buffers.load() == 0;
}

}  // namespace lightwell
