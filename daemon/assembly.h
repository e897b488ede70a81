// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "daemon/adaptation.h"
#include "daemon/capture/capture_source.h"
#include "daemon/configuration.h"
#include "daemon/pipeline/frame_path.h"
#include "daemon/sync/gpio_sync.h"
#include "daemon/sync/sync_board.h"
#include "lighting/calibration.h"
#include "lighting/fit/few_lights.h"
#include "lighting/result.h"

namespace lightwell {

// From the configuration's words to the parts they ask for. Nothing here starts anything.

CaptureOptions capture_options(const Configuration& configuration);

FramePathOptions frame_path_options(const Configuration& configuration);

// Empty where nothing is to be fitted.
std::optional<FewLightsOptions> fit_options(const Configuration& configuration);

// What is adapted to. usage: axes that are none, naming key, value and what is allowed; bad_input: a fixed
// pattern of the folder that cannot be read.
Result<Adaptation::Options> adaptation_options(const Configuration& configuration,
                                               const Calibration& calibration);
// Empty where the address is none of GPIO lines. usage: lines, a rate or a pulse that do not go together, naming key, value
// and what is allowed.
Result<std::optional<GpioOptions>> gpio_options(const Configuration& configuration);
// Empty where no board is configured. usage: an address or a rate that is none, naming key, value and what is allowed.
Result<std::optional<BoardOptions>> board_options(const Configuration& configuration);

// The configured folder's calibration; without one, the recording's own or the simulation's own; else usage,
// saying what to do. bad_input as the readers of the files say.
Result<Calibration> choose_calibration(const Configuration& configuration);

// Whether the frames fit calibration and map, where they are known before they come: of takes and simulations.
// bad_input, in the words that the status has for it.
Status check_frames_fit(const Configuration& configuration, const Calibration& calibration);

}  // namespace lightwell
