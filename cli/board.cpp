// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "cli/progress.h"
#include "daemon/sync/firmware_update.h"
#include "daemon/sync/sync_conversation.h"
#include "interface/firmware_file.h"

namespace lightwell::cli {
namespace {

struct Options {
  std::string address = "usb";
  std::string file;
  bool json = false;
};

std::string version_text(const std::uint8_t (&version)[3]) {
  return std::to_string(version[0]) + "." + std::to_string(version[1]) + "." + std::to_string(version[2]);
}

std::string serial_text(const sync_hello& hello) {
  char text[32];
  std::snprintf(text, sizeof text, "%08x%08x%08x", hello.serial[0], hello.serial[1], hello.serial[2]);
  return text;
}

nlohmann::json abilities(std::uint32_t bits) {
  constexpr const char* kNames[] = {"trigger",     "strobe", "reference",    "timecode", "photodiode", "imu",
                                    "temperature", "button", "camera power", "store",    "update"};
  auto names = nlohmann::json::array();
  for (std::size_t i = 0; i < std::size(kNames); ++i)
    if ((bits >> i & 1) != 0) names.push_back(kNames[i]);
  return names;
}

Result<std::unique_ptr<SyncLink>> open_link(const Options& o) {
  const auto address = parse_sync_address(o.address);
  if (!address) return address.error();
  return open_sync_link(*address);
}

int show(const Options& o) {
  const auto link = open_link(o);
  if (!link) return fail(link.error());
  SyncConversation board(**link);
  const auto hello = board.greet();
  if (!hello) return fail(hello.error());
  const nlohmann::json can = abilities(hello->capabilities);
  if (o.json) {
    std::printf("%s\n", nlohmann::json{{"schema", "lightwell.board/1"},
                                       {"serial", serial_text(*hello)},
                                       {"firmware", version_text(hello->version)},
                                       {"slot", hello->slot},
                                       {"abilities", can}}
                            .dump(2)
                            .c_str());
    return 0;
  }
  std::string list;
  for (const auto& name : can) list += (list.empty() ? "" : ", ") + name.get<std::string>();
  std::printf("serial     %s\nfirmware   %s, in slot %d\nabilities  %s\n", serial_text(*hello).c_str(),
              version_text(hello->version).c_str(), hello->slot, list.c_str());
  return 0;
}

int update(const Options& o) {
  const auto firmware = read_firmware_file(o.file);
  if (!firmware) return fail(firmware.error());
  const auto link = open_link(o);
  if (!link) return fail(link.error());
  constexpr std::size_t kSteps = 1000;
  Progress progress(kSteps);
  const auto before = update_firmware(**link, *firmware, [&](double share) {
    progress.done(static_cast<std::size_t>(share * static_cast<double>(kSteps)));
  });
  if (!before) return fail(before.error());
  const std::uint8_t version[3] = {firmware->version[0], firmware->version[1], firmware->version[2]};
  if (o.json)
    std::printf("%s\n", nlohmann::json{{"before", version_text(before->version)},
                                       {"written", version_text(version)},
                                       {"slot", 1 - before->slot}}
                            .dump()
                            .c_str());
  else
    std::printf("firmware %s is written and verified; it runs from the board's next start (before: %s)\n",
                version_text(version).c_str(), version_text(before->version).c_str());
  return 0;
}

}  // namespace

Command add_board(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("board", "Ask the sync board what it is, or give it new firmware");
  command->footer(
      "Examples: lightwell board --address usb\n"
      "          lightwell board update firmware.json --address serial:/dev/ttyACM0\n"
      "A board that lightwelld uses is busy: end the daemon first.");
  command->require_subcommand(0, 1);
  const auto common = [&](CLI::App* of) {
    of->add_option("--address", o->address, "usb, usb:SERIAL or serial:/dev/DEVICE")->capture_default_str();
    of->add_flag("--json", o->json, "Machine-readable result on stdout");
  };
  common(command);
  CLI::App* renew = command->add_subcommand("update", "Write a signed image into the slot that does not run");
  renew->add_option("file", o->file, "Firmware file (lightwell.firmware/1)")->required();
  common(renew);
  return {command, [o, renew] { return renew->parsed() ? update(*o) : show(*o); }};
}

}  // namespace lightwell::cli
