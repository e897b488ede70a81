// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/aravis_session.h"

#include <arv.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "daemon/capture/aravis_camera.h"
#include "daemon/capture/aravis_chunks.h"
#include "daemon/capture/buffer_pool.h"
#include "daemon/capture/device_clock.h"
#include "daemon/capture/glib_error.h"
#include "daemon/capture/gvcp.h"
#include "daemon/capture/ptp_clock.h"
#include "daemon/clock.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr auto kProbeTimeout = 150ms;  // loopback and a switch answer in one
constexpr auto kAsk = 1s;              // exposure, gain, temperature, PTP

}  // namespace

struct AravisSession::Handles {
  // An ArvBuffer knows its own by its user data.
  struct Buffer {
    std::size_t index = 0;
    ArvBuffer* filled = nullptr;  // while it is ours: taken from the stream and not given back
    std::int64_t received_mono_ns = 0;
  };

  CameraHandle camera;
  gulong control_lost_handler = 0;
  std::atomic<ArvStream*> stream{nullptr};
  ArvPixelFormat pixel_format = 0;
  std::unique_ptr<BufferPool> pool;
  std::vector<Buffer> buffers;
  std::atomic<int> out{0};  // frames handed on that have not come back
  AravisChunks chunks;
  DeviceClock device_clock;
  PtpClock ptp_clock;
  std::thread asking;
  std::mutex camera_mutex;  // one thread at a time asks the camera; never taken under the other

  std::mutex
      mutex;  // guards what follows, and pushing into the stream against its end; lists never outgrow the pool
  std::condition_variable news, ending;
  bool lost = false, woken = false, closed = false;
  bool heard = false;               // frames have come since the camera was last asked
  std::vector<std::size_t> filled;  // oldest first
  std::vector<std::size_t> returned;
  std::optional<CameraValues> values;  // newer than those the session has

  // On the stream's thread. The buffer was queued just before; taking it here stamps it when it was whole.
  static void on_stream(void* context, ArvStreamCallbackType type, ArvBuffer*) noexcept {
    auto* self = static_cast<Handles*>(context);
    ArvStream* stream = self->stream.load(std::memory_order_acquire);
    if (type != ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE || stream == nullptr) return;
    const std::int64_t now_ns = mono_now_ns();
    const std::lock_guard lock(self->mutex);
    while (ArvBuffer* buffer = arv_stream_try_pop_buffer(stream)) {
      if (self->closed) {
        g_object_unref(buffer);
        continue;
      }
      auto* record = static_cast<Buffer*>(const_cast<void*>(arv_buffer_get_user_data(buffer)));
      record->filled = buffer;
      record->received_mono_ns = now_ns;
      self->filled.push_back(record->index);
      self->heard = true;
    }
    self->news.notify_one();
  }
  static void on_control_lost(ArvDevice*, gpointer context) noexcept {
    auto* self = static_cast<Handles*>(context);
    const std::lock_guard lock(self->mutex);
    self->lost = true;
    self->news.notify_one();
  }

  // False: it does not answer.
  bool take_values() {
    const std::lock_guard one_at_a_time(camera_mutex);
    auto read = read_values(camera.get());
    const std::lock_guard lock(mutex);
    if (read) values = std::move(read);
    return read.has_value();
  }

  // The asking thread. A camera that sends nothing may be dead, and is left alone.
  void ask() {
    std::unique_lock lock(mutex);
    while (!ending.wait_for(lock, kAsk, [&] { return closed; })) {
      if (!std::exchange(heard, false)) continue;
      lock.unlock();
      take_values();
      lock.lock();
    }
  }

  // Aravis's queues allocate now and then, which the end of a lease must not: buffers wait here for the session's thread.
  void recycle() noexcept {
    const std::lock_guard lock(mutex);
    if (closed) return;
    for (const std::size_t index : returned)
      arv_stream_push_buffer(stream.load(std::memory_order_relaxed),
                             std::exchange(buffers[index].filled, nullptr));
    returned.clear();
  }

  void drop(std::vector<std::size_t>& list) noexcept {
    for (const std::size_t index : list) g_object_unref(std::exchange(buffers[index].filled, nullptr));
    list.clear();
  }
};

AravisSession::AravisSession(std::string address, const CaptureOptions& options)
    : address_(std::move(address)), options_(options), handles_(std::make_unique<Handles>()) {}

AravisSession::~AravisSession() {
  AravisSession::close();
  verify_bug(all_returned(), "a frame lease outlived its capture source");
}

std::optional<CaptureFault> AravisSession::find() {
  if (!is_ipv4_address(address_) || gvcp_probe(address_, kProbeTimeout)) return std::nullopt;
  return CaptureFault{SourceState::no_device,
                      "is not there: no camera answers; check cable, power and address"};
}

std::optional<CaptureFault> AravisSession::open() {
  Handles& h = *handles_;
  if (auto fault = open_camera(address_, h.camera)) return fault;
  h.control_lost_handler = g_signal_connect(arv_camera_get_device(h.camera.get()), "control-lost",
                                            G_CALLBACK(Handles::on_control_lost), &h);
  if (auto fault = configure_camera(h.camera.get(), options_, settings_)) return fault;
  h.chunks.enable(h.camera.get(), settings_);
  h.pixel_format = arv_camera_get_pixel_format(h.camera.get(), nullptr);
  h.values = read_values(h.camera.get());
  if (!h.values) return CaptureFault{SourceState::opening, "does not tell its exposure and gain"};
  refresh();
  has_exposure_ = settings_.exposure_us > 0;
  return std::nullopt;
}

std::optional<CaptureFault> AravisSession::start() {
  const auto fault = [](const std::string& words) { return CaptureFault{SourceState::opening, words}; };
  GlibError error;
  Handles& h = *handles_;
  ArvCamera* camera = h.camera.get();
  const std::size_t payload = arv_camera_get_payload(camera, error.out());
  if (error) return fault(std::string("does not tell its PayloadSize: ") + error.text());
  if (payload < settings_.format.bytes())
    return fault("says that a frame takes " + std::to_string(payload) +
                 " bytes (PayloadSize), where it takes " + std::to_string(settings_.format.bytes()));
  h.pool = BufferPool::create(payload, static_cast<std::size_t>(options_.buffers));
  if (h.pool == nullptr)
    return fault("sends frames of " + std::to_string(payload) + " bytes: no memory for " +
                 std::to_string(options_.buffers));
  h.buffers.resize(h.pool->count());
  for (std::size_t i = 0; i < h.buffers.size(); ++i) h.buffers[i].index = i;
  h.filled.reserve(h.pool->count());
  h.returned.reserve(h.pool->count());
  ArvStream* stream = arv_camera_create_stream(camera, Handles::on_stream, &h, error.out());
  if (stream == nullptr || error) return fault(std::string("has no stream: ") + error.text());
  h.stream.store(stream, std::memory_order_release);
  if (ARV_IS_GV_STREAM(stream)) {
    g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 options_.socket_buffer_bytes, nullptr);
    // A frame that waits for packets sent again holds up those after it: two periods, within what a network needs.
    if (settings_.rate_hz > 0)
      g_object_set(stream, "frame-retention",
                   static_cast<guint>(std::clamp(2e6 / settings_.rate_hz, 30e3, 200e3)), nullptr);
  }
  for (Handles::Buffer& buffer : h.buffers)
    arv_stream_push_buffer(
        stream, arv_buffer_new_full(payload, h.pool->buffer(buffer.index).data(), &buffer, nullptr));
  arv_camera_start_acquisition(camera, error.out());
  if (error) return fault(std::string("does not start: ") + error.text());
  h.asking = std::thread(&Handles::ask, &h);
  return std::nullopt;
}

CaptureSession::Event AravisSession::next(std::chrono::milliseconds timeout, SessionFrame& frame) noexcept {
  Handles& h = *handles_;
  h.recycle();
  std::size_t buffer = 0;
  {
    std::unique_lock lock(h.mutex);
    h.news.wait_for(lock, timeout, [&] { return h.lost || h.woken || !h.filled.empty(); });
    h.woken = false;
    if (h.lost) return Event::broken;
    if (h.filled.empty()) return Event::nothing;
    buffer = h.filled.front();
    h.filled.erase(h.filled.begin());
  }
  ++h.out;
  frame = {};
  const Event event = describe(buffer, frame);
  if (frame.outcome != SessionFrame::Outcome::complete) give_back(buffer);
  return event;
}

CaptureSession::Event AravisSession::describe(std::size_t index, SessionFrame& frame) noexcept {
  Handles& h = *handles_;
  ArvBuffer* buffer = h.buffers[index].filled;
  frame.buffer = index;
  frame.received_mono_ns = h.buffers[index].received_mono_ns;
  frame.frame_id = arv_buffer_get_frame_id(buffer);
  const ArvBufferStatus status = arv_buffer_get_status(buffer);
  if (status == ARV_BUFFER_STATUS_SIZE_MISMATCH) return Event::source_changed;
  if (status != ARV_BUFFER_STATUS_SUCCESS) return Event::frame;
  const ArvBufferPayloadType payload = arv_buffer_get_payload_type(buffer);
  if (payload != ARV_BUFFER_PAYLOAD_TYPE_IMAGE && payload != ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA)
    return Event::source_changed;
  gint x_padding = 0, y_padding = 0;
  arv_buffer_get_image_padding(buffer, &x_padding, &y_padding);
  std::size_t size = 0;
  const void* data = arv_buffer_get_data(buffer, &size);
  if (arv_buffer_get_image_width(buffer) != settings_.format.width ||
      arv_buffer_get_image_height(buffer) != settings_.format.height ||
      arv_buffer_get_image_pixel_format(buffer) != h.pixel_format || x_padding != 0 ||
      size < settings_.format.bytes())
    return Event::source_changed;
  frame.outcome = SessionFrame::Outcome::complete;
  frame.bytes = {static_cast<const std::byte*>(data), settings_.format.bytes()};
  const AravisChunks::Values own = h.chunks.read(buffer);
  frame.exposure_us = own.exposure_us.value_or(settings_.exposure_us);
  frame.gain_db = own.gain_db.value_or(gain_db_);
  frame.temperature_c = temperature_c_;
  std::uint64_t t_device_ns = arv_buffer_get_timestamp(buffer);
  if (t_device_ns == 0) t_device_ns = own.t_device_ns.value_or(0);
  // Frames leave the camera when the exposure ends; read-out and wire are not known and count as nothing.
  frame.stamp = t_device_ns != 0 ? SessionFrame::Stamp::mapped : SessionFrame::Stamp::none;
  frame.t_stamp_mono_ns = h.device_clock.undelayed_mono_ns(t_device_ns, frame.received_mono_ns);
  const std::int64_t now_ns = mono_now_ns();
  h.ptp_clock.saw(t_device_ns, clock_ns(CLOCK_TAI) - (now_ns - frame.received_mono_ns),
                  utc_now_ns() - (now_ns - frame.received_mono_ns));
  return Event::frame;
}

CaptureFault AravisSession::fault() const {
  return {SourceState::no_device, "is gone: control of the camera was lost; looking for it"};
}

// What the asking thread has brought.
std::string AravisSession::refresh() {
  Handles& h = *handles_;
  std::optional<CameraValues> values;
  {
    const std::lock_guard lock(h.mutex);
    values = std::exchange(h.values, std::nullopt);
  }
  if (!values) return {};
  settings_.exposure_us = values->exposure_us;
  gain_db_ = values->gain_db;
  temperature_c_ = values->temperature_c;
  settings_.clock = h.ptp_clock.words(values->ptp, host_clock_is_kept());
  return {};
}

Status AravisSession::set_exposure_us(double exposure_us) {
  Handles& h = *handles_;
  Status set;
  {
    const std::lock_guard one_at_a_time(h.camera_mutex);
    set = set_exposure(h.camera.get(), exposure_us);
  }
  if (h.take_values()) refresh();
  return set;
}

void AravisSession::give_back(std::size_t buffer) noexcept {
  Handles& h = *handles_;
  {
    const std::lock_guard lock(h.mutex);
    if (h.closed)
      g_object_unref(std::exchange(h.buffers[buffer].filled, nullptr));
    else
      h.returned.push_back(buffer);
  }
  --h.out;  // the last that is done here: nothing of the session need be there after it
}

void AravisSession::wake() noexcept {
  const std::lock_guard lock(handles_->mutex);
  handles_->woken = true;
  handles_->news.notify_one();
}

void AravisSession::close() noexcept {
  Handles& h = *handles_;
  bool lost = false;
  {
    const std::lock_guard lock(h.mutex);
    if (std::exchange(h.closed, true)) return;
    h.drop(h.returned);
    h.drop(h.filled);
    lost = h.lost;
    h.ending.notify_one();
  }
  if (h.asking.joinable()) h.asking.join();
  if (h.camera != nullptr && h.control_lost_handler != 0)
    g_signal_handler_disconnect(arv_camera_get_device(h.camera.get()), h.control_lost_handler);
  if (h.camera != nullptr && !lost) arv_camera_stop_acquisition(h.camera.get(), nullptr);
  // The stream's thread ends in here; the pointer must stay readable for it until then.
  if (ArvStream* stream = h.stream.load()) g_object_unref(stream);
  h.stream.store(nullptr);
  h.camera.reset();
}

bool AravisSession::all_returned() const noexcept {
  return handles_->out.load() == 0;
}

}  // namespace lightwell
