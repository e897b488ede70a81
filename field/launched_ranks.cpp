// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/launched_ranks.h"

#include <dlfcn.h>

#include <cstdlib>
#include <string>

#include "interface/companion.h"

namespace lightwell {
namespace {

// Open MPI's mpirun; srun and others through PMIx.
constexpr const char* kRankVariables[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK"};

const char* rank_variable() {
  for (const char* name : kRankVariables)
    if (const char* value = std::getenv(name)) return value;
  return nullptr;
}

}  // namespace

int launched_rank() {
  const char* value = rank_variable();
  return value == nullptr ? 0 : std::atoi(value);
}

Result<std::unique_ptr<FieldRanks>> launched_ranks() {
  if (rank_variable() == nullptr) return std::make_unique<FieldRanks>();
  const auto module = companion("lightwell-mpi.so");
  // Never closed: MPI has threads and handlers of its own. Global: its plugins look for its symbols.
  void* library = ::dlopen(module.c_str(), RTLD_NOW | RTLD_GLOBAL);
  const char* why = library == nullptr ? ::dlerror() : nullptr;
  void* begin = library == nullptr ? nullptr : ::dlsym(library, "lightwell_mpi_ranks");
  if (begin == nullptr)
    return Error{ErrorKind::failed, std::string("started by mpirun, but cannot join it: ") +
                                        (why != nullptr ? why : module.string() + " is of another version")};
  return std::unique_ptr<FieldRanks>(reinterpret_cast<decltype(&lightwell_mpi_ranks)>(begin)());
}

}  // namespace lightwell
