// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/live_news.h"

#include "render/say.h"

namespace lightwell::render {

void LiveNews::tell(std::optional<std::chrono::nanoseconds> age, bool arrived, const std::string& from) {
  using namespace std::chrono_literals;
  const State now = !age ? State::waiting : arrived || *age < 2s ? State::flowing : State::stopped;
  if (now == told_) return;
  if (now == State::waiting) say("waiting for " + what_ + " on DDS domain " + std::to_string(domain_));
  if (now == State::flowing) say(what_ + " from " + from);
  if (now == State::stopped) say("no " + what_ + " for 2 s; keeping the last");
  told_ = now;
}

}  // namespace lightwell::render
