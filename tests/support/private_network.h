// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace lightwell::test {

// Moves the test program into a network of its own, where 127.0.0.1 with all its ports is nobody else's. GigE
// Vision has one fixed port, so that two test programs on one address would meet. Before any thread is
// started. Returns why it was not possible, empty where it was.
std::string enter_private_network();

// Registered once in a test program (AddGlobalTestEnvironment); reason() says why the tests have to be
// skipped.
class PrivateNetwork : public testing::Environment {
 public:
  void SetUp() override { reason() = enter_private_network(); }
  static std::string& reason() {
    static std::string why = "no private network was asked for";
    return why;
  }
};

}  // namespace lightwell::test
