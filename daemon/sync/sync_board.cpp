// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/sync_board.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "daemon/clock.h"

namespace lightwell {
namespace {

constexpr std::int64_t kPingNs =
    25'000'000;  // BoardClockMap: a few µs with a millisecond of scheduling noise
constexpr std::int64_t kStateNs = 500'000'000;     // LED
constexpr std::int64_t kHelloNs = 500'000'000;     // until a question is answered
constexpr std::int64_t kSilentNs = 1'000'000'000;  // 40 pings unanswered
// While the clocks may be further apart than that, a frame is better stamped by its camera.
constexpr double kGoodEnoughUs = 2000;
constexpr auto kTurn = std::chrono::milliseconds(10);

sync_message message_of(sync_type type) {
  sync_message message{};
  message.type = static_cast<std::uint8_t>(type);
  return message;
}

bool is_request(std::uint8_t type) {
  return type % 2 == 1 && type <= SYNC_UPDATE_FINISH;
}

// But for where it is kept.
bool same(const sync_configuration& a, const sync_configuration& b) {
  std::array<std::uint8_t, SYNC_MAX_PAYLOAD> packed_a{}, packed_b{};
  sync_message message = message_of(SYNC_CONFIGURE);
  message.configuration = a;
  message.configuration.store = 0;
  const std::size_t size = sync_pack(&message, packed_a.data());
  message.configuration = b;
  message.configuration.store = 0;
  sync_pack(&message, packed_b.data());
  return std::equal(packed_a.begin(), packed_a.begin() + static_cast<std::ptrdiff_t>(size), packed_b.begin());
}

std::string hello_text(const sync_hello& hello) {
  return fmt::format("firmware {}.{}.{}, serial {:08x}{:08x}{:08x}", hello.version[0], hello.version[1],
                     hello.version[2], hello.serial[0], hello.serial[1], hello.serial[2]);
}

}  // namespace

SyncBoard::SyncBoard(BoardOptions options, StrobeRing& strobes, TimecodeStamper& timecodes)
    : options_(std::move(options)),
      port_(options_.open ? make_polled_port(options_.open) : make_sync_port(options_.address)),
      strobes_(strobes),
      timecodes_(timecodes),
      trigger_(options_.trigger) {
  set_state(BoardState::no_device, "not looked for yet");
  started_ = true;
  thread_ = std::thread([this] { run(); });
}

SyncBoard::~SyncBoard() {
  stop();
}

void SyncBoard::stop() noexcept {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

BoardView SyncBoard::view() const {
  const std::scoped_lock lock(mutex_);
  return view_;
}

// What another board, or none, does not say any more is forgotten.
void SyncBoard::set_state(BoardState state, const std::string& description) {
  if (started_) {  // what is so is logged once, not at every try
    const std::string line = std::string(name(state)) + ": " + description;
    if (std::exchange(logged_, line) != line)
      spdlog::log(state == BoardState::connected ? spdlog::level::info : spdlog::level::warn,
                  "sync board: {}", line);
  }
  const std::scoped_lock lock(mutex_);
  const std::uint64_t reconnects = view_.reconnects, lost = view_.lost_frames;
  if (state != BoardState::connected) view_ = {};
  view_.state = state;
  view_.description = description;
  view_.reconnects = reconnects;
  view_.lost_frames = lost;
}

void SyncBoard::run() {
  pthread_setname_np(pthread_self(), "sync-board");
  while (!stopping_) {
    const Status ended = meet();
    agreed_ = false;
    if (!ended) set_state(BoardState::no_device, ended.error().message);
    while (!stopping_ && !port_->wait(kTurn)) continue;
  }
}

Status SyncBoard::meet() {
  const auto link = port_->open();
  if (!link) return link.error();
  const Status ended = converse(**link);
  // What a board of another version said stays to be read, while it is there.
  return view().state == BoardState::wrong_firmware ? Status() : ended;
}

Status SyncBoard::converse(SyncLink& link) {
  frame_receiver_init(&receiver_);
  clock_.reset();
  last_sequence_.reset();
  forget_configuration();
  last_board_ns_ = 0;
  next_hello_ns_ = next_ping_ns_ = next_state_ns_ = 0;
  last_heard_ns_ = mono_now_ns();
  std::array<std::uint8_t, 1024> bytes{};
  while (!stopping_) {
    if (Status sent = send_due(link); !sent) return sent;
    const auto size = link.read(bytes, kTurn);
    if (!size) return size.error();
    const std::int64_t received_ns = mono_now_ns();
    for (std::size_t i = 0; i < *size; ++i) {
      frame_view frame{};
      if (!frame_receive(&receiver_, bytes[i], &frame)) continue;
      sync_message message{};
      const bool understood = frame_message(&frame, &message);
      if (understood && is_request(message.type)) continue;  // a line that echoes is no board
      last_heard_ns_ = received_ns;
      if (understood) {
        if (last_sequence_) {
          const auto gap = static_cast<std::uint16_t>(frame.sequence - *last_sequence_ - 1);
          const std::scoped_lock lock(mutex_);
          view_.lost_frames += gap;
        }
        last_sequence_ = frame.sequence;
        take(message, received_ns);
      } else if (frame.version != SYNC_PROTOCOL_VERSION) {
        set_state(
            BoardState::wrong_firmware,
            fmt::format("the board speaks version {} of the protocol, this program {}; update the board",
                        frame.version, SYNC_PROTOCOL_VERSION));
      }
    }
    if (Status sent = configure(link); !sent) return sent;
    if (received_ns - last_heard_ns_ > kSilentNs)
      return Error{ErrorKind::failed, "the board is silent; is it powered, is it a Lightwell board?"};
  }
  return {};
}

Status SyncBoard::send(SyncLink& link, const sync_message& message) {
  std::array<std::uint8_t, SYNC_MAX_WIRE> wire{};
  const std::size_t size = frame_encode_message(&message, sequence_++, wire.data());
  return link.write(std::span(wire).first(size));
}

Status SyncBoard::send_due(SyncLink& link) {
  const std::int64_t now_ns = mono_now_ns();
  if (!agreed_ && now_ns >= next_hello_ns_) {
    next_hello_ns_ = now_ns + kHelloNs;
    if (Status sent = send(link, message_of(SYNC_HELLO_REQUEST)); !sent) return sent;
  }
  if (!agreed_) return {};
  if (!has_ && now_ns >= next_question_ns_) {
    next_question_ns_ = now_ns + kHelloNs;
    if (Status sent = send(link, message_of(SYNC_CONFIGURATION_REQUEST)); !sent) return sent;
  }
  if (now_ns >= next_state_ns_) {
    next_state_ns_ = now_ns + kStateNs;
    sync_message message = message_of(SYNC_HOST_STATE);
    message.host_state.state = static_cast<std::uint8_t>(host_state_.load());
    if (Status sent = send(link, message); !sent) return sent;
  }
  if (now_ns >= next_ping_ns_) {
    next_ping_ns_ = now_ns + kPingNs;
    sync_message message = message_of(SYNC_PING);
    message.ping.t_host_ns = static_cast<std::uint64_t>(mono_now_ns());  // as late as can be
    if (Status sent = send(link, message); !sent) return sent;
  }
  return {};
}

// The board's settings with what was asked for in them: the camera that it feeds on, and the trigger.
sync_configuration SyncBoard::wanted() const {
  sync_configuration c = *has_;
  c.camera_on = 1;
  c.store = 0;  // the host says it at every start; flash wears
  if (!trigger_) return c;
  const BoardOptions::Trigger& asked = *trigger_;
  c.trigger_on = 1;
  c.rate_numerator = asked.rate_numerator;
  c.rate_denominator = asked.rate_denominator;
  if (asked.pulse_ns > 0) c.pulse_ns = asked.pulse_ns;
  if (asked.exposure_ns > 0) c.exposure_ns = asked.exposure_ns;
  c.reference = static_cast<std::uint8_t>(asked.reference);
  c.reference_numerator = asked.reference_numerator;
  c.reference_denominator = asked.reference_denominator;
  return c;
}

// Until the board has what is wanted, or refuses it; and again when it has gone back to safe defaults by itself, having
// heard nothing of us for a while: a daemon that was stopped, a machine that slept.
Status SyncBoard::configure(SyncLink& link) {
  {
    const std::scoped_lock lock(mutex_);
    if (next_trigger_) trigger_ = std::exchange(next_trigger_, std::nullopt), next_question_ns_ = 0;
  }
  const std::int64_t now_ns = mono_now_ns();
  if (!agreed_ || !has_ || now_ns < next_question_ns_) return {};
  const sync_configuration want = wanted();
  if (same(want, *has_) && !safe_) return {};
  if (refused_ && same(want, *refused_)) return {};
  next_question_ns_ = now_ns + kHelloNs;
  asked_ = want;
  sync_message message = message_of(SYNC_CONFIGURE);
  message.configuration = want;
  return send(link, message);
}

void SyncBoard::forget_configuration() {
  has_.reset();
  asked_.reset();
  refused_.reset();
  safe_ = false;
  next_question_ns_ = 0;
}

void SyncBoard::set_trigger(double rate_hz, double exposure_us) {
  if (!options_.trigger) return;
  BoardOptions::Trigger next = *options_.trigger;
  constexpr double kMilli = 1000;
  next.rate_numerator = static_cast<std::uint32_t>(std::lround(rate_hz * kMilli));
  next.rate_denominator = static_cast<std::uint32_t>(kMilli);
  const auto& asked = *options_.trigger;
  // The rate that was asked for is an exact fraction.
  if (std::abs(rate_hz * asked.rate_denominator - asked.rate_numerator) < 1e-4 * asked.rate_numerator) {
    next.rate_numerator = asked.rate_numerator;
    next.rate_denominator = asked.rate_denominator;
  }
  next.exposure_ns = static_cast<std::uint32_t>(std::lround(exposure_us * 1e3));
  const std::scoped_lock lock(mutex_);
  next_trigger_ = next;
}

// The board has started again: it may be another firmware, and has forgotten what it was told.
void SyncBoard::begin_anew() {
  agreed_ = false;
  next_hello_ns_ = 0;
  forget_configuration();
  clock_.reset();
  last_sequence_.reset();
  const std::scoped_lock lock(mutex_);
  view_.configuration.reset();
}

void SyncBoard::take_strobe(const sync_strobe& strobe) {
  if ((strobe.flags & SYNC_STROBE_PAIRED) == 0 || (strobe.flags & SYNC_STROBE_NO_FALL) != 0) return;
  const auto begin = clock_.mono_ns(static_cast<std::int64_t>(strobe.t_rise_board_ns));
  const auto end = clock_.mono_ns(static_cast<std::int64_t>(strobe.t_fall_board_ns));
  if (begin && end && clock_.bound_us() < kGoodEnoughUs) strobes_.push({strobe.n, *begin, *end});
}

void SyncBoard::take_timecode(const sync_timecode& timecode) {
  const auto start = clock_.mono_ns(static_cast<std::int64_t>(timecode.t_board_ns));
  if (start && clock_.bound_us() < kGoodEnoughUs) timecodes_.word(timecode_of(timecode), *start);
}

// Under the view's lock.
void SyncBoard::see_status(const sync_status& status) {
  view_.status = status;
  const bool acquiring = status.lock == SYNC_LOCK_ACQUIRING;
  if (!acquiring) acquiring_since_ns_ = 0;
  if (acquiring && acquiring_since_ns_ == 0) acquiring_since_ns_ = mono_now_ns();
  view_.acquiring_s = acquiring ? static_cast<double>(mono_now_ns() - acquiring_since_ns_) * 1e-9 : 0;
  constexpr std::uint64_t kWordNs = 2'000'000'000;  // without another the timecode has stopped
  if (view_.timecode && status.t_board_ns > view_.timecode->t_board_ns + kWordNs) view_.timecode.reset();
}

void SyncBoard::take(const sync_message& message, std::int64_t received_mono_ns) {
  if (message.type == SYNC_HELLO) {
    if (message.hello.schema_hash != SYNC_SCHEMA_HASH) {
      set_state(BoardState::wrong_firmware,
                fmt::format("{} speaks another protocol ({:08x}, this program {:08x}); update the board",
                            hello_text(message.hello), message.hello.schema_hash, SYNC_SCHEMA_HASH));
      return;
    }
    agreed_ = true;
    set_state(BoardState::connected, hello_text(message.hello));
    if (std::exchange(connected_before_, true)) {
      const std::scoped_lock lock(mutex_);
      ++view_.reconnects;
    }
  }
  if (!agreed_) return;
  if (message.type == SYNC_PONG &&
      message.pong.t_received_board_ns < std::exchange(last_board_ns_, message.pong.t_received_board_ns)) {
    begin_anew();
    return;
  }
  if (message.type == SYNC_PONG)
    clock_.add({static_cast<std::int64_t>(message.pong.t_host_ns),
                static_cast<std::int64_t>(message.pong.t_received_board_ns),
                static_cast<std::int64_t>(message.pong.t_sent_board_ns), received_mono_ns});
  if (message.type == SYNC_CONFIGURATION) has_ = message.configuration, safe_ = false, next_question_ns_ = 0;
  if (message.type == SYNC_STATUS) safe_ = message.status.safe != 0;
  if (message.type == SYNC_FAULT && message.fault.type == SYNC_CONFIGURE) refused_ = asked_;
  if (message.type == SYNC_STROBE) take_strobe(message.strobe);
  if (message.type == SYNC_TIMECODE) take_timecode(message.timecode);
  if (message.type == SYNC_BUTTON && options_.on_button)
    options_.on_button(static_cast<sync_press>(message.button.press));
  const std::scoped_lock lock(mutex_);
  switch (message.type) {
    case SYNC_HELLO:
      view_.hello = message.hello;
      break;
    case SYNC_PONG:
      view_.clock_bound_us = clock_.bound_us();
      view_.drift_ppm = clock_.drift_ppm();
      break;
    case SYNC_CONFIGURATION:
      view_.configuration = message.configuration;
      if (asked_ && same(*asked_, message.configuration)) view_.refused.clear();
      break;
    case SYNC_STATUS:
      see_status(message.status);
      break;
    case SYNC_PHOTODIODE:
      view_.photodiode = message.photodiode;
      break;
    case SYNC_IMU:
      view_.imu = message.imu;
      break;
    case SYNC_TEMPERATURE:
      if (message.temperature.sensor < view_.temperature.size())
        view_.temperature[message.temperature.sensor] = message.temperature;
      break;
    case SYNC_TIMECODE:
      view_.timecode = message.timecode;
      break;
    case SYNC_FAULT:
      view_.refused = fault_text(message.fault);
      spdlog::warn("sync board: refuses {}", view_.refused);
      break;
    default:
      break;
  }
}

}  // namespace lightwell
