// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "interface/dds_domain.h"
#include "render/light_source.h"

namespace lightwell::render {

// The newest lightwell/FieldFrame, as `lightwell field live` publishes it: of the first field that is heard, until it is gone.
// Says on stderr, once each time, that it waits, that the field stopped (the last one is kept), that it came back, and once of
// each kind what was wrong with a message that was refused. failed: the network.
Result<std::unique_ptr<LightSource>> live_field_light(const DdsOptions& options);

}  // namespace lightwell::render
