// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "lighting/result.h"
#include "render/options.h"

namespace lightwell::render {

// One run of lightwell-render: reads, renders until its frames, its time or the window end, writes. stop: set
// from outside (a signal) to end early and in order, with the last picture and the statistics written.
Status run_session(const Options& options, const std::atomic<bool>& stop);

}  // namespace lightwell::render
