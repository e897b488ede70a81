// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/dds_topics.h"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include "interface/dds_wire.h"
#include "interface/followed_writers.h"

namespace lightwell {
namespace {

using Clock = std::chrono::steady_clock;

struct QosFree {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosFree>;

// An entity that is deleted with its owner.
class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  Entity(const Entity&) = delete;
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  [[nodiscard]] dds_entity_t get() const { return handle_; }
  [[nodiscard]] bool ok() const { return handle_ > 0; }

 private:
  dds_entity_t handle_ = 0;
};

template <class Message>
Qos make_qos() {
  Qos qos(dds_create_qos());
  constexpr bool reliable = Wire<Message>::kReliable;
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(qos.get(), reliable ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
  dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC,
                      std::chrono::duration_cast<std::chrono::nanoseconds>(kLiveliness).count());
  // A stranger's type that cannot be read as ours is never matched.
  dds_qset_type_consistency(qos.get(), DDS_TYPE_CONSISTENCY_ALLOW_TYPE_COERCION, true, true, false, false,
                            true);
  return qos;
}

Error failure(const char* topic, const char* what, dds_return_t code) {
  return {ErrorKind::failed, std::string("DDS topic ") + topic + ": " + what + ": " + dds_strretcode(-code)};
}

template <class Message>
dds_entity_t make_topic(const DdsDomain& domain) {
  return dds_create_topic(domain.participant(), &Wire<Message>::descriptor(), Wire<Message>::kTopic, nullptr,
                          nullptr);
}

}  // namespace

template <class Message>
struct DdsWriter<Message>::Impl {
  std::shared_ptr<DdsDomain> domain;  // outlives the entities below
  Entity topic;
  Entity writer;
  typename Wire<Message>::Type wire{};
  typename Wire<Message>::Buffer buffer;
};

template <class Message>
DdsWriter<Message>::DdsWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
template <class Message>
DdsWriter<Message>::~DdsWriter() = default;

template <class Message>
Result<std::unique_ptr<DdsWriter<Message>>> DdsWriter<Message>::create(std::shared_ptr<DdsDomain> domain,
                                                                       const std::string& probe) {
  auto impl = std::make_unique<Impl>();
  const bool printable =
      std::all_of(probe.begin(), probe.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
  if (probe.empty() || probe.size() >= sizeof impl->wire.probe || !printable)
    return Error{ErrorKind::usage, "probe name '" + probe + "' must be 1 to 63 printable ASCII characters"};
  std::memcpy(impl->wire.probe, probe.data(), probe.size());
  impl->domain = std::move(domain);
  impl->topic = Entity(make_topic<Message>(*impl->domain));
  if (!impl->topic.ok()) return failure(Wire<Message>::kTopic, "cannot create", impl->topic.get());
  impl->writer = Entity(
      dds_create_writer(impl->domain->participant(), impl->topic.get(), make_qos<Message>().get(), nullptr));
  if (!impl->writer.ok()) return failure(Wire<Message>::kTopic, "cannot write", impl->writer.get());
  return std::unique_ptr<DdsWriter>(new DdsWriter(std::move(impl)));
}

template <class Message>
Status DdsWriter<Message>::write(const Message& message) {
  if (const auto wrong = to_wire(message, impl_->wire, impl_->buffer); !wrong.empty())
    return Error{ErrorKind::bad_input, std::string("DDS topic ") + Wire<Message>::kTopic + ": " + wrong};
  const dds_return_t code = dds_write(impl_->writer.get(), &impl_->wire);
  if (code == DDS_RETCODE_TIMEOUT)
    return Error{ErrorKind::failed, std::string("DDS topic ") + Wire<Message>::kTopic +
                                        ": a reader is too slow, message dropped"};
  if (code != DDS_RETCODE_OK) return failure(Wire<Message>::kTopic, "cannot send", code);
  return {};
}

template <class Message>
int DdsWriter<Message>::readers() const {
  dds_publication_matched_status_t status{};
  return dds_get_publication_matched_status(impl_->writer.get(), &status) == DDS_RETCODE_OK
             ? static_cast<int>(status.current_count)
             : 0;
}

template <class Message>
struct DdsReader<Message>::Impl {
  std::shared_ptr<DdsDomain> domain;  // outlives the entities below
  bool any_probe = true;
  bool every_probe = false;
  std::string probe;
  Entity topic;
  Entity reader;
  Entity condition;
  Entity waitset;
  bool any_taken = false;
  // What was taken last, a probe.
  struct Last {
    std::uint64_t number = 0;
    std::int64_t capture_ns = 0;
  };
  std::map<std::string, Last, std::less<>> last;
  Clock::time_point arrived;
  std::uint64_t refused = 0;
  std::string refusal;

  FollowedWriters writers{kLiveliness};

  bool take_available(Message& message);
  bool follows(std::string_view from, const dds_sample_info_t& info);
  bool accept(const typename Wire<Message>::Type& wire, const dds_sample_info_t& info, Message& message);
  bool is_repeat(const typename Wire<Message>::Type& wire, std::string_view from) const;
};

// The publisher repeats the last lights for late joiners; whoever has them does not get them again.
template <class Message>
bool DdsReader<Message>::Impl::is_repeat(const typename Wire<Message>::Type& wire,
                                         std::string_view from) const {
  if constexpr (std::is_same_v<Message, ProbeStatus>) {
    static_cast<void>(wire);
    static_cast<void>(from);
    return false;
  } else {
    const auto found = last.find(from);
    return found != last.end() && wire.header.number == found->second.number &&
           wire.header.capture_mono_ns == found->second.capture_ns;
  }
}

template <class Message>
bool DdsReader<Message>::Impl::follows(std::string_view from, const dds_sample_info_t& info) {
  return writers.follows(from, info.publication_handle, Clock::now(), [this](std::uint64_t writer) {
    std::array<dds_instance_handle_t, 64> there{};
    const auto count = dds_get_matched_publications(reader.get(), there.data(), there.size());
    const auto end = there.begin() + std::clamp<std::ptrdiff_t>(count, 0, std::ssize(there));
    return std::find(there.begin(), end, writer) != end;
  });
}

template <class Message>
bool DdsReader<Message>::Impl::accept(const typename Wire<Message>::Type& wire, const dds_sample_info_t& info,
                                      Message& message) {
  const std::string_view from(wire.probe, ::strnlen(wire.probe, sizeof wire.probe));
  // A probe that is gone makes room for another; its samples without data carry the key alone.
  if (info.instance_state != DDS_IST_ALIVE && any_probe && from == probe) probe.clear();
  if (!info.valid_data || (!every_probe && !probe.empty() && from != probe)) return false;
  if (!follows(from, info) || is_repeat(wire, from)) return false;
  if (std::string wrong = from_wire(wire, message); !wrong.empty()) {
    ++refused;
    refusal = std::move(wrong);
    return false;
  }
  if (info.instance_state == DDS_IST_ALIVE) probe = from;
  any_taken = true;
  arrived = Clock::now();
  if constexpr (!std::is_same_v<Message, ProbeStatus>) {
    last.insert_or_assign(std::string(from), Last{wire.header.number, wire.header.capture_mono_ns});
  }
  return true;
}

// Everything that is there, in batches; a later sample of the same probe replaces an earlier one. Of every probe: one
// message, the others wait for the next call.
template <class Message>
bool DdsReader<Message>::Impl::take_available(Message& message) {
  constexpr std::uint32_t kBatch = 8;
  bool taken = false;
  for (;;) {
    std::array<void*, kBatch> samples{};
    std::array<dds_sample_info_t, kBatch> infos{};
    const auto count = dds_take_wl(reader.get(), samples.data(), infos.data(), every_probe ? 1 : kBatch);
    if (count <= 0) return taken;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      taken |= accept(*static_cast<const typename Wire<Message>::Type*>(samples[i]), infos[i], message);
    dds_return_loan(reader.get(), samples.data(), count);
    if (taken && every_probe) return true;
  }
}

template <class Message>
DdsReader<Message>::DdsReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
template <class Message>
DdsReader<Message>::~DdsReader() = default;

template <class Message>
Result<std::unique_ptr<DdsReader<Message>>> DdsReader<Message>::create(std::shared_ptr<DdsDomain> domain,
                                                                       const DdsReaderOptions& options) {
  auto impl = std::make_unique<Impl>();
  impl->domain = std::move(domain);
  impl->every_probe = options.every_probe;
  impl->any_probe = options.probe.empty();
  impl->probe = options.probe;
  const dds_entity_t participant = impl->domain->participant();
  impl->topic = Entity(make_topic<Message>(*impl->domain));
  if (!impl->topic.ok()) return failure(Wire<Message>::kTopic, "cannot create", impl->topic.get());
  impl->reader =
      Entity(dds_create_reader(participant, impl->topic.get(), make_qos<Message>().get(), nullptr));
  if (!impl->reader.ok()) return failure(Wire<Message>::kTopic, "cannot read", impl->reader.get());
  impl->condition = Entity(dds_create_readcondition(impl->reader.get(), DDS_ANY_STATE));
  impl->waitset = Entity(dds_create_waitset(participant));
  const dds_return_t attached = dds_waitset_attach(impl->waitset.get(), impl->condition.get(), 0);
  if (attached != DDS_RETCODE_OK) return failure(Wire<Message>::kTopic, "cannot wait", attached);
  return std::unique_ptr<DdsReader>(new DdsReader(std::move(impl)));
}

template <class Message>
bool DdsReader<Message>::take(Message& message, std::chrono::milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  for (;;) {
    if (impl_->take_available(message)) return true;
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(deadline - Clock::now());
    if (left.count() <= 0) return false;
    if (dds_waitset_wait(impl_->waitset.get(), nullptr, 0, left.count()) <= 0) return false;
  }
}

template <class Message>
int DdsReader<Message>::writers() const {
  dds_liveliness_changed_status_t status{};
  return dds_get_liveliness_changed_status(impl_->reader.get(), &status) == DDS_RETCODE_OK
             ? static_cast<int>(status.alive_count)
             : 0;
}

template <class Message>
std::optional<std::chrono::nanoseconds> DdsReader<Message>::age() const {
  if (!impl_->any_taken) return std::nullopt;
  return Clock::now() - impl_->arrived;
}

template <class Message>
const std::set<std::string, std::less<>>& DdsReader<Message>::contested() const {
  return impl_->writers.contested();
}
template <class Message>
const std::string& DdsReader<Message>::probe() const {
  return impl_->probe;
}
template <class Message>
std::uint64_t DdsReader<Message>::refused() const {
  return impl_->refused;
}
template <class Message>
const std::string& DdsReader<Message>::refusal() const {
  return impl_->refusal;
}

template class DdsWriter<LightFrame>;
template class DdsWriter<FitFrame>;
template class DdsWriter<EnvironmentFrame>;
template class DdsWriter<FieldFrame>;
template class DdsWriter<ProbeStatus>;
template class DdsReader<LightFrame>;
template class DdsReader<FitFrame>;
template class DdsReader<EnvironmentFrame>;
template class DdsReader<FieldFrame>;
template class DdsReader<ProbeStatus>;

}  // namespace lightwell
