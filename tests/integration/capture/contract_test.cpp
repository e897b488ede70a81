// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/integration/capture/fake_camera.h"
#include "tests/support/capture_contract.h"
#include "tests/support/private_network.h"

namespace lightwell::test {
namespace {

const auto* const kNetwork = testing::AddGlobalTestEnvironment(new PrivateNetwork);

std::unique_ptr<CaptureSource> made(const std::string& source, const CaptureOptions& options = {}) {
  auto result = make_capture_source(source, options);
  if (result.ok()) return std::move(result).value();
  ADD_FAILURE() << result.error().message;
  return nullptr;
}

struct AravisSubject {
  FakeCamera camera{64, 48, 100};
  std::string missing() {
    if (!PrivateNetwork::reason().empty()) return PrivateNetwork::reason();
    return camera.ready() ? std::string() : "the fake camera does not start";
  }
  std::unique_ptr<CaptureSource> make() { return made("aravis:127.0.0.1"); }
  std::unique_ptr<CaptureSource> make_silent() { return made("aravis:127.0.0.2"); }  // nobody there
};
INSTANTIATE_TYPED_TEST_SUITE_P(Aravis, CaptureContract, AravisSubject);

}  // namespace
}  // namespace lightwell::test
