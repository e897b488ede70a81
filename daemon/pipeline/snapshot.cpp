// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/snapshot.h"

#include <utility>

#include "lighting/result.h"

namespace lightwell {

// One slot for the writer, one for the newest, one for every lease: a free slot always exists.
SnapshotChannel::SnapshotChannel(const Snapshot& prototype)
    : slots_(kMaxReaders + 2, prototype), leases_(kMaxReaders + 2, 0) {
  // Copying a vector copies its size, not its capacity.
  for (Snapshot& slot : slots_) slot.lights.reserve(prototype.lights.capacity());
}

Snapshot& SnapshotChannel::begin_write() noexcept {
  const std::scoped_lock lock(mutex_);
  writing_ = slots_.size();
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (leases_[i] == 0 && (!any_ || i != latest_)) writing_ = i;
  verify_bug(writing_ < slots_.size(), "more snapshot leases than kMaxReaders");
  return slots_[writing_];
}

void SnapshotChannel::end_write() noexcept {
  {
    const std::scoped_lock lock(mutex_);
    latest_ = writing_;
    any_ = true;
  }
  newer_.notify_all();
}

SnapshotChannel::Lease SnapshotChannel::wait_newer(std::uint64_t after, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  const auto ready = [&] { return closed_ || (any_ && slots_[latest_].number > after); };
  if (!newer_.wait_for(lock, timeout, ready) || closed_) return {};
  ++leases_[latest_];
  return {this, &slots_[latest_], latest_};
}

void SnapshotChannel::close() noexcept {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
  }
  newer_.notify_all();
}

SnapshotChannel::Lease::Lease(Lease&& other) noexcept
    : channel_(std::exchange(other.channel_, nullptr)),
      snapshot_(std::exchange(other.snapshot_, nullptr)),
      slot_(other.slot_) {}

SnapshotChannel::Lease& SnapshotChannel::Lease::operator=(Lease&& other) noexcept {
  Lease taken(std::move(other));
  std::swap(channel_, taken.channel_);
  std::swap(snapshot_, taken.snapshot_);
  std::swap(slot_, taken.slot_);
  return *this;
}

SnapshotChannel::Lease::~Lease() {
  if (channel_ == nullptr) return;
  const std::scoped_lock lock(channel_->mutex_);
  --channel_->leases_[slot_];
}

}  // namespace lightwell
