// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stop_notice.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>

#include "interface/printable.h"

namespace lightwell::cli {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};
// Written before the handler is there, for it may not allocate.
std::string marker, text;

extern "C" void say_and_stop(int number) {
  const int fd = ::open(marker.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd >= 0 && ::write(STDERR_FILENO, text.data(), text.size()) < 0) ::_exit(128 + number);
  std::signal(number, SIG_DFL);
  std::raise(number);
}

}  // namespace

StopNotice::StopNotice(const std::filesystem::path& folder) {
  marker = (folder / "stopped").string();
  text = std::string(::isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "") +
         "lightwell: stopped; what is done stands in " + printable(folder.string()) +
         ": the same command goes on from there\n";
  for (const int number : kSignals) {
    struct sigaction before {};
    // What a parent had ignored (nohup) stays so.
    if (::sigaction(number, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
      std::signal(number, say_and_stop);
  }
}

StopNotice::~StopNotice() {
  for (const int number : kSignals) {
    struct sigaction now {};
    if (::sigaction(number, nullptr, &now) == 0 && now.sa_handler == say_and_stop)
      std::signal(number, SIG_DFL);
  }
}

}  // namespace lightwell::cli
