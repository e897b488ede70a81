// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <mpi.h>

#include <algorithm>
#include <climits>
#include <exception>
#include <string>

#include "field/field_ranks.h"
#include "field/launched_ranks.h"

namespace lightwell {
namespace {

// Ranks of an MPI job. MPI's own errors end the job, with MPI's message.
class MpiRanks final : public FieldRanks {
 public:
  MpiRanks() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
    MPI_Comm machine = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    MPI_Comm_size(machine, &on_this_machine_);
    MPI_Comm_free(&machine);
  }
  ~MpiRanks() override {
    // The others wait for what an exception has kept this one from.
    if (std::uncaught_exceptions() > 0) MPI_Abort(MPI_COMM_WORLD, static_cast<int>(ErrorKind::failed));
    MPI_Finalize();
  }

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int count() const override { return count_; }
  [[nodiscard]] int on_this_machine() const override { return on_this_machine_; }

  Status agree(const Status& own) override {
    int lowest = own ? count_ : rank_;
    MPI_Allreduce(MPI_IN_PLACE, &lowest, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (lowest == count_) return {};
    Error error;
    if (lowest == rank_) error = own.error();
    if (lowest == rank_ && rank_ > 0 && error.kind == ErrorKind::failed)
      error.message = who() + error.message;
    int kind = static_cast<int>(error.kind), length = static_cast<int>(error.message.size());
    MPI_Bcast(&kind, 1, MPI_INT, lowest, MPI_COMM_WORLD);
    MPI_Bcast(&length, 1, MPI_INT, lowest, MPI_COMM_WORLD);
    error.message.resize(static_cast<std::size_t>(length));
    MPI_Bcast(error.message.data(), length, MPI_CHAR, lowest, MPI_COMM_WORLD);
    error.kind = static_cast<ErrorKind>(kind);
    return error;
  }

  [[nodiscard]] bool any(bool own) override {
    int all = own ? 1 : 0;
    MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    return all != 0;
  }

  void sum(std::span<std::uint64_t> numbers) override {
    MPI_Allreduce(MPI_IN_PLACE, numbers.data(), count_of(numbers.size()), MPI_UINT64_T, MPI_SUM,
                  MPI_COMM_WORLD);
  }

  void broadcast(std::span<std::byte> bytes) override {
    MPI_Bcast(bytes.data(), count_of(bytes.size()), MPI_BYTE, 0, MPI_COMM_WORLD);
  }
  void send(std::span<const float> numbers) override {
    for (; !numbers.empty(); numbers = numbers.subspan(piece_of(numbers.size())))
      MPI_Send(numbers.data(), count_of(piece_of(numbers.size())), MPI_FLOAT, 0, 0, MPI_COMM_WORLD);
  }
  void receive(int rank, std::span<float> numbers) override {
    for (; !numbers.empty(); numbers = numbers.subspan(piece_of(numbers.size())))
      MPI_Recv(numbers.data(), count_of(piece_of(numbers.size())), MPI_FLOAT, rank, 0, MPI_COMM_WORLD,
               MPI_STATUS_IGNORE);
  }
  void abort(int exit_code) override { MPI_Abort(MPI_COMM_WORLD, exit_code); }

 private:
  // Which machine is to be looked at.
  [[nodiscard]] std::string who() const {
    char name[MPI_MAX_PROCESSOR_NAME] = {};
    int length = 0;
    MPI_Get_processor_name(name, &length);
    return "rank " + std::to_string(rank_) + " on " + name + ": ";
  }
  // A slab of the largest grid has more numbers than MPI counts.
  static std::size_t piece_of(std::size_t size) { return std::min(size, std::size_t{1} << 16); }
  static int count_of(std::size_t size) {
    verify_bug(size <= INT_MAX, "a message of MPI's size");
    return static_cast<int>(size);
  }
  int rank_ = 0, count_ = 1, on_this_machine_ = 1;
};

}  // namespace
}  // namespace lightwell

extern "C" __attribute__((visibility("default"))) lightwell::FieldRanks* lightwell_mpi_ranks() {
  return new lightwell::MpiRanks;  // NOLINT(cppcoreguidelines-owning-memory): the caller's unique_ptr
}
