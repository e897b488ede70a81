// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <linux/capability.h>
#include <malloc.h>
#include <poll.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <system_error>
#include <thread>

#include "daemon/clock.h"
#include "daemon/configuration.h"
#include "daemon/daemon.h"
#include "interface/printable.h"

// lightwelld: reads its configuration, runs the daemon, and turns signals into what they ask for.
namespace {

using namespace lightwell;

struct Arguments {
  std::string config, calibration, record_dir, source;
  bool print_config = false;
  bool check = false;

  [[nodiscard]] Overrides overrides() const {
    Overrides given;
    if (!calibration.empty()) given.emplace_back("calibration.directory", calibration);
    if (!record_dir.empty()) given.emplace_back("record.directory", record_dir);
    if (!source.empty()) given.emplace_back("source.address", source);
    return given;
  }
};

void add_options(CLI::App& app, Arguments& a) {
  app.add_option("--config", a.config, "TOML file; --print-config shows every key");
  app.add_option("--calibration", a.calibration, "folder with response.json, lens.json, flat.json");
  app.add_option("--record-dir", a.record_dir, "folder for takes");
  app.add_option("--source", a.source,
                 "aravis:ADDRESS, v4l2:/dev/videoN, libcamera:ID, recording:FILE or simulated:NAME");
  app.add_flag("--print-config", a.print_config, "print the configuration with the origin of every value");
  app.add_flag("--check", a.check, "check configuration and calibration, then end");
  app.footer("Example: lightwelld --source aravis:192.168.1.20 --calibration probe-07/ --record-dir takes/");
}

int fail(const Error& error) {
  std::fprintf(stderr, "lightwelld: %s\n", printable(error.message).c_str());
  return static_cast<int>(error.kind);
}

// The log's messages as a terminal may have them.
class PrintableMessage final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    const std::string text = printable({message.payload.data(), message.payload.size()});
    out.append(text.data(), text.data() + text.size());
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<PrintableMessage>();
  }
};

void set_up_log() {
  spdlog::set_default_logger(spdlog::stderr_logger_mt("lightwelld"));
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PrintableMessage>('*').set_pattern("lightwelld: %l: %*");
  spdlog::set_formatter(std::move(formatter));
}

int block_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int s : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, s);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signalfd(-1, &signals, SFD_CLOEXEC);
}

void reload(Daemon& daemon, const Arguments& arguments) {
  sd_notifyf(0, "RELOADING=1\nMONOTONIC_USEC=%lld", static_cast<long long>(mono_now_ns() / 1000));
  const auto loaded = load_configuration(arguments.config, arguments.overrides());
  Status done = loaded ? Status() : Status(loaded.error());
  try {
    if (done) done = daemon.reload(loaded->configuration);
  } catch (const std::exception& thrown) {  // a live set is not ended by what it was to change to
    done = Error{ErrorKind::failed, thrown.what()};
  }
  if (done) {
    spdlog::set_level(spdlog::level::from_str(loaded->configuration.log.level));
    spdlog::info("configuration reloaded");
  } else {
    spdlog::error("configuration not reloaded, the old one goes on: {}", done.error().message);
  }
  sd_notify(0, "READY=1");
}

bool may_hold_any_memory() {
  rlimit limit{};
  if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY) return true;
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[2] = {};
  return syscall(SYS_capget, &header, data) == 0 && (data[0].effective & (1u << CAP_IPC_LOCK)) != 0;
}

// A page that the disk has to bring back costs a frame. Only what is in use is held, so that threads' stacks stay small.
// Under a limit of locked memory allocations would fail later on, which is worse.
void stay_in_memory() {
  if (!may_hold_any_memory()) return;
  if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0)
    spdlog::warn("memory may be paged out: {}", std::generic_category().message(errno));
}

// The watchdog is fed only while the frame path's loop turns.
void serve(Daemon& daemon, const Arguments& arguments, int signals) {
  std::uint64_t watchdog_us = 0;
  const bool watched = sd_watchdog_enabled(0, &watchdog_us) > 0;
  const int interval_ms = watched ? std::max(1, static_cast<int>(watchdog_us / 3000)) : 1000;
  std::uint64_t last_heartbeat = 0;
  for (;;) {
    pollfd wait{signals, POLLIN, 0};
    if (poll(&wait, 1, interval_ms) > 0) {
      signalfd_siginfo info{};
      if (read(signals, &info, sizeof info) != sizeof info) continue;
      if (info.ssi_signo != SIGHUP) return;
      reload(daemon, arguments);
    }
    daemon.log_changes();
    daemon.tell_board();
    daemon.adapt();
    const std::uint64_t heartbeat = daemon.heartbeat();
    if (watched && heartbeat != last_heartbeat) sd_notify(0, "WATCHDOG=1");
    last_heartbeat = heartbeat;
  }
}

// The take is closed first. A camera that died may keep Aravis busy for longer than a second, and nothing is lost by
// leaving it; a disk that cannot close the take in that time loses its last half second, which is a failure.
void stop(Daemon& daemon) {
  sd_notify(0, "STOPPING=1");
  static std::atomic<bool> take_closed{false};
  std::thread([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    if (!take_closed)
      std::fputs("lightwelld: the disk is too slow to close the take; `lightwell repair` mends it\n", stderr);
    std::_Exit(take_closed ? 0 : static_cast<int>(ErrorKind::failed));
  }).detach();
  daemon.close_take();
  take_closed = true;
  daemon.stop();
}

int run(const Arguments& arguments) {
  const auto loaded = load_configuration(arguments.config, arguments.overrides());
  if (!loaded) return fail(loaded.error());
  if (arguments.print_config) {
    std::fputs(print_configuration(*loaded).c_str(), stdout);
    return 0;
  }
  const Status checked = Daemon::check(loaded->configuration);
  if (!checked) return fail(checked.error());
  if (arguments.check) {
    std::fprintf(stderr, "lightwelld: configuration and calibration are good\n");
    return 0;
  }
  spdlog::set_level(spdlog::level::from_str(loaded->configuration.log.level));
  const int signals = block_signals();
  auto daemon = Daemon::start(loaded->configuration);
  if (!daemon) return fail(daemon.error());
  stay_in_memory();
  malloc_trim(0);  // calibration files are read as text, many times their tables
  spdlog::info("page: {}", (*daemon)->url());
  sd_notify(0, "READY=1");
  serve(**daemon, arguments, signals);
  stop(**daemon);
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app{"lightwelld: camera frames to lights, live", "lightwelld"};
  app.set_version_flag("--version", "lightwelld 0.1.0");
  app.failure_message(CLI::FailureMessage::simple);
  Arguments arguments;
  add_options(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ErrorKind::usage);
  }
  mallopt(M_ARENA_MAX, 2);  // a dozen threads that allocate little need no heap each
  set_up_log();
  return run(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lightwelld: %s\n", printable(error.what()).c_str());
    return static_cast<int>(ErrorKind::failed);
  }
}
