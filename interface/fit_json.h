// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lighting/fit/few_lights.h"

namespace lightwell {

// A fit as a light set, lightwell.lights/1, that also says how good it is (docs/conventions.md): `residual`,
// `confidence`, `remarks`. Readers of light sets pass these by.
std::string fit_to_json(const FewLightsFit& fit, bool one_line = false);

}  // namespace lightwell
