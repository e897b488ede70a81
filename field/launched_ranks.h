// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "field/field_ranks.h"
#include "lighting/result.h"

namespace lightwell {

// This process's number among those that mpirun, or srun with PMIx, started, as its environment says; 0 without one. For
// who speaks before MPI has begun.
int launched_rank();

// The ranks of that launcher, by a module beside the program that alone needs MPI; without a launcher one rank and no
// module. failed where the module or Open MPI is not there. Once a process.
Result<std::unique_ptr<FieldRanks>> launched_ranks();

}  // namespace lightwell

// What the module (field/mpi/) has: begins MPI, which ends with the object.
extern "C" lightwell::FieldRanks* lightwell_mpi_ranks();
