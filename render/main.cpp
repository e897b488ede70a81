// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <cstdio>
#include <exception>

#include "interface/printable.h"
#include "render/options.h"
#include "render/session.h"

namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, [](int) { stop = true; });
  std::signal(SIGTERM, [](int) { stop = true; });
  try {
    const auto parsed = lightwell::render::parse_options(argc, argv);
    if (!parsed.options) return parsed.exit_code;
    const auto status = lightwell::render::run_session(*parsed.options, stop);
    if (status) return 0;
    std::fprintf(stderr, "lightwell-render: %s\n", lightwell::printable(status.error().message).c_str());
    return static_cast<int>(status.error().kind);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwell-render: %s\n", lightwell::printable(error.what()).c_str());
    return static_cast<int>(lightwell::ErrorKind::failed);
  }
}
