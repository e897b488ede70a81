// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace lightwell::sync_gadget {

struct GadgetOptions {
  std::string name = "lightwell-sync";  // of the gadget in configfs; one program a name
  std::string serial;
  // pid.codes' number for what is not sold: the board is found by its interface's class.
  unsigned vendor = 0x1209, product = 0x0001;
  bool full_speed = false;  // else as fast as the controller goes
};

// A USB device of configfs with one FunctionFS function, which is mounted in a folder of its own. All of it goes with the
// object, and what a killed program of the same name left behind is cleared away first.
// https://docs.kernel.org/usb/gadget_configfs.html
class Gadget {
 public:
  // Throws std::runtime_error, naming path and reason.
  explicit Gadget(const GadgetOptions& options);
  ~Gadget();
  Gadget(const Gadget&) = delete;
  Gadget& operator=(const Gadget&) = delete;

  const std::filesystem::path& functionfs() const { return mount_; }
  // Plugs it in. Controller: a name in /sys/class/udc; empty: the first that is free. Returns its name.
  std::string bind(const std::string& controller);

 private:
  void make(const GadgetOptions& options) const;
  void clear() const;

  std::string function_;  // "ffs.NAME"
  std::filesystem::path root_, mount_;
  int lock_ = -1;
};

}  // namespace lightwell::sync_gadget
