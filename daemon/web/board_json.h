// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "daemon/sync/board_view.h"

namespace lightwell {

// The sync board as /api/v1/status tells it (openapi.yaml, Board): what it has not said is null.
nlohmann::ordered_json board_json(const BoardView& board);

}  // namespace lightwell
