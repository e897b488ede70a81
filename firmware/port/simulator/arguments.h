// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "firmware/port/simulator/world.h"

namespace lightwell::sync_simulator {

// What every program with a simulated board understands: its world, and how long it runs. Both outlive the parsing.
void add_arguments(CLI::App& app, WorldOptions& world, double& seconds);

}  // namespace lightwell::sync_simulator
