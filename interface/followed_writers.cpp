// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/followed_writers.h"

namespace lightwell {

bool FollowedWriters::follows(std::string_view name, std::uint64_t writer, Time now,
                              const std::function<bool(std::uint64_t)>& is_there) {
  const auto found = followed_.find(name);
  if (found == followed_.end()) {
    if (followed_.size() < kMostNames) followed_.emplace(name, Followed{writer, now});
    return true;
  }
  Followed& followed = found->second;
  if (followed.writer != writer) {
    if (now - followed.heard <= patience_ && is_there(followed.writer)) {
      if (!contested_.contains(name)) contested_.emplace(name);
      return false;
    }
    followed.writer = writer;
  }
  followed.heard = now;
  return true;
}

}  // namespace lightwell
