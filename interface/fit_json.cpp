// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/fit_json.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "interface/light_set_io.h"

namespace lightwell {
namespace {

using Json = nlohmann::ordered_json;

// What is not finite is written as null; dump does so.
Json confidence_of(const FewLightsFit& fit) {
  Json lights = Json::array();
  for (int k = 0; k < fit.count; ++k) {
    const FittedLight& light = fit.lights[static_cast<std::size_t>(k)];
    const Rgbd& sigma = light.illuminance_sigma;
    lights.push_back({{"direction_sigma_deg", light.direction_sigma_rad * 180 / kPi},
                      {"illuminance_sigma", {sigma[0], sigma[1], sigma[2]}}});
  }
  Json confidence = {{"lights", std::move(lights)}};
  if (fit.bounded) {
    confidence["fewest"] = fit.confidence;
    confidence["residual_of_fewer"] = fit.residual_of_fewer;
  }
  return confidence;
}

}  // namespace

std::string fit_to_json(const FewLightsFit& fit, bool one_line) {
  Json more = {{"residual", fit.residual}};
  if (fit.with_shadow) more["shadow_residual"] = fit.shadow_residual;
  more["confidence"] = confidence_of(fit);
  more["remarks"] = remarks(fit);
  // The light set writes its own numbers, shortest and exact: join the two objects as text.
  std::string text = light_set_to_json(light_set(fit), one_line);
  text.resize(text.rfind('}'));
  return text + "," + (one_line ? "" : "\n") + more.dump().substr(1) + "\n";
}

}  // namespace lightwell
