// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/gadget/gadget.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace lightwell::sync_gadget {
namespace {

namespace fs = std::filesystem;

const fs::path kGadgets = "/sys/kernel/config/usb_gadget";
const fs::path kControllers = "/sys/class/udc";
constexpr unsigned kVendorCode = 0x57;  // 'W': the request by which Windows asks for Microsoft's descriptors

std::runtime_error failure(const fs::path& path, int number) {
  return std::runtime_error(path.string() + ": " + std::strerror(number));
}

// 0, or errno. One write, without a buffer: an attribute takes its value at once or not at all.
int try_set(const fs::path& attribute, const std::string& value) {
  const int file = open(attribute.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return errno;
  const ssize_t size = write(file, value.data(), value.size());
  const int number = size < 0 ? errno : 0;
  close(file);
  return number;
}
void set(const fs::path& attribute, const std::string& value) {
  if (const int number = try_set(attribute, value); number != 0) throw failure(attribute, number);
}

std::string hexadecimal(unsigned value) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%04x", value);
  return text.data();
}

}  // namespace

Gadget::Gadget(const GadgetOptions& options)
    : function_("ffs." + options.name),
      root_(kGadgets / options.name),
      mount_("/run/lightwell/gadget-" + options.name) {
  if (!fs::is_directory(kGadgets))
    throw std::runtime_error(
        kGadgets.string() +
        " is not there: mount configfs on /sys/kernel/config, load libcomposite, be root");
  try {
    fs::create_directories(mount_.parent_path());
    const fs::path lock = mount_.string() + ".lock";
    lock_ = open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (lock_ < 0) throw failure(lock, errno);
    if (flock(lock_, LOCK_EX | LOCK_NB) != 0)
      throw std::runtime_error("another program is the gadget " + options.name);
  } catch (...) {
    if (lock_ >= 0) close(lock_);
    throw;
  }
  clear();
  try {
    make(options);
  } catch (...) {
    clear();
    close(lock_);
    throw;
  }
}

Gadget::~Gadget() {
  clear();
  close(lock_);
}

void Gadget::make(const GadgetOptions& options) const {
  fs::create_directory(root_);
  set(root_ / "idVendor", hexadecimal(options.vendor));
  set(root_ / "idProduct", hexadecimal(options.product));
  if (options.full_speed) set(root_ / "max_speed", "full-speed");
  const fs::path strings = root_ / "strings/0x409";
  fs::create_directory(strings);
  set(strings / "manufacturer", "Lightwell");
  set(strings / "product", "Lightwell sync board");
  set(strings / "serialnumber", options.serial);
  const fs::path configuration = root_ / "configs/c.1";
  fs::create_directory(configuration);
  fs::create_directory(root_ / "functions" / function_);
  fs::create_symlink(root_ / "functions" / function_, configuration / function_);
  set(root_ / "os_desc/use", "1");
  set(root_ / "os_desc/b_vendor_code", hexadecimal(kVendorCode));
  set(root_ / "os_desc/qw_sign", "MSFT100");
  fs::create_symlink(configuration, root_ / "os_desc/c.1");
  fs::create_directories(mount_);
  if (mount(options.name.c_str(), mount_.c_str(), "functionfs", 0, nullptr) != 0)
    throw failure(mount_, errno);
}

std::string Gadget::bind(const std::string& controller) {
  std::vector<std::string> candidates;
  if (!controller.empty())
    candidates.push_back(controller);
  else if (fs::is_directory(kControllers))
    for (const auto& entry : fs::directory_iterator(kControllers))
      candidates.push_back(entry.path().filename().string());
  if (candidates.empty())
    throw std::runtime_error(kControllers.string() +
                             " is empty: this machine has no USB controller that can be a device");
  std::sort(candidates.begin(), candidates.end());
  int number = 0;
  for (const std::string& candidate : candidates) {
    number = try_set(root_ / "UDC", candidate);
    if (number == 0) return candidate;
  }
  if (number == ENODEV) throw std::runtime_error("no USB device controller " + candidates.back());
  if (number == EBUSY) throw std::runtime_error(candidates.back() + ": another gadget is on it");
  throw failure(root_ / "UDC", number);
}

// In the order that configfs allows; what is not there is passed by.
void Gadget::clear() const {
  try_set(root_ / "UDC", "\n");
  while (umount2(mount_.c_str(), MNT_DETACH) == 0) continue;
  std::error_code ignored;
  for (const fs::path& path :
       {root_ / "os_desc/c.1", root_ / "configs/c.1" / function_, root_ / "configs/c.1",
        root_ / "functions" / function_, root_ / "strings/0x409", root_, mount_})
    fs::remove(path, ignored);
}

}  // namespace lightwell::sync_gadget
