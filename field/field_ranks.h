// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "lighting/result.h"

namespace lightwell {

// The processes that make a field together, numbered from 0; this one stands for a process alone. field/mpi/ has those
// that mpirun started. Every rank makes the same calls in the same order; calls wait for each other.
class FieldRanks {
 public:
  FieldRanks() = default;
  virtual ~FieldRanks() = default;
  FieldRanks(const FieldRanks&) = delete;
  FieldRanks& operator=(const FieldRanks&) = delete;

  [[nodiscard]] virtual int rank() const { return 0; }
  [[nodiscard]] virtual int count() const { return 1; }
  // How many of them share this machine's cores and memory.
  [[nodiscard]] virtual int on_this_machine() const { return 1; }

  // Good where all are; else on every rank the error of the lowest that has one.
  virtual Status agree(const Status& own) { return own; }
  [[nodiscard]] virtual bool any(bool own) { return own; }
  // Every number is the sum of all ranks'.
  virtual void sum(std::span<std::uint64_t> numbers) { (void)numbers; }
  // From rank 0 to all.
  virtual void broadcast(std::span<std::byte> bytes) { (void)bytes; }
  // From a rank to rank 0.
  virtual void send(std::span<const float> numbers) { (void)numbers; }
  virtual void receive(int rank, std::span<float> numbers) { (void)rank, (void)numbers; }
  // Ends all ranks, now: for what no other rank can know of.
  virtual void abort(int exit_code) { std::_Exit(exit_code); }
};

}  // namespace lightwell
