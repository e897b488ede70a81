// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <variant>

namespace lightwell {

// What went wrong decides the exit code of a command (docs/conventions.md).
enum class ErrorKind {
  failed = 1,     // the machine: folder missing, disk full, device gone
  usage = 2,      // wrong option, or a value out of range
  bad_input = 3,  // the data: missing, truncated, malformed
};

// One line for a person: names file, field, value and allowed range, whichever apply.
struct Error {
  ErrorKind kind = ErrorKind::failed;
  std::string message;
};

// A check that is always on. For bugs only, never for input.
// The builtins rather than std::source_location, which Clang 14 lacks; both compilers have them.
inline void verify_bug(bool condition, const char* what, const char* file = __builtin_FILE(),
                       int line = __builtin_LINE()) {
  if (condition) return;
  std::fprintf(stderr, "lightwell: bug: %s (%s:%d)\n", what, file, line);
  std::abort();
}

// Value or Error, for what can be expected to fail. Taking the value of a failure is a bug and aborts.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value)
      : state_(std::in_place_index<0>, std::move(value)) {}  // NOLINT(google-explicit-constructor)
  Result(Error error)
      : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const noexcept { return state_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }

  [[nodiscard]] T& value() & {
    verify_bug(ok(), "value of a failed Result");
    return *std::get_if<0>(&state_);
  }
  [[nodiscard]] const T& value() const& {
    verify_bug(ok(), "value of a failed Result");
    return *std::get_if<0>(&state_);
  }
  [[nodiscard]] T&& value() && {
    verify_bug(ok(), "value of a failed Result");
    return std::move(*std::get_if<0>(&state_));
  }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }

  [[nodiscard]] const Error& error() const {
    verify_bug(!ok(), "error of a good Result");
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Error> state_;
};

// A Result without a value.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Error error) : error_(std::move(error)), ok_(false) {}  // NOLINT(google-explicit-constructor)
  [[nodiscard]] bool ok() const noexcept { return ok_; }
  explicit operator bool() const noexcept { return ok_; }
  [[nodiscard]] const Error& error() const {
    verify_bug(!ok_, "error of a good Status");
    return error_;
  }

 private:
  Error error_;
  bool ok_ = true;
};

}  // namespace lightwell
