// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/gpio_trigger.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <vector>

#include "daemon/clock.h"
#include "tests/support/eventually.h"

namespace lightwell {
namespace {

struct Wire {
  struct Change {
    bool high;
    std::int64_t mono_ns;
  };
  std::mutex mutex;
  std::vector<Change> changes;
  bool gone = false;
};

class WireOutput final : public GpioOutput {
 public:
  explicit WireOutput(Wire& wire) : wire_(wire) {}
  bool set(bool high) noexcept override {
    const std::scoped_lock lock(wire_.mutex);
    if (wire_.gone) return false;
    wire_.changes.push_back({high, mono_now_ns()});
    return true;
  }

 private:
  Wire& wire_;
};

TEST(TriggerPulses, AreDueAtExactFractionsHoweverManyThereWere) {
  const TriggerPulses ntsc{30000, 1001, 0};
  EXPECT_EQ(ntsc.period_ns(), 33'366'666);
  EXPECT_EQ(ntsc.due_ns(30'000), 1'001'000'000'000);
  EXPECT_EQ(ntsc.due_ns(3'000'000'000), 100'100'000'000'000'000);  // three years
}

TEST(GpioTrigger, PulsesAreMadeWhenTheyAreDueAndTold) {
  Wire wire;
  std::vector<GpioTrigger::Made> made;
  GpioTrigger::View view;
  const TriggerPulses pulses{200, 1, 1'000'000};
  const std::int64_t begin_ns = mono_now_ns();
  {
    GpioTrigger trigger(std::make_unique<WireOutput>(wire), pulses);
    ASSERT_TRUE(test::eventually([&] {
      while (const auto next = trigger.next()) made.push_back(*next);
      return made.size() >= 100;
    }));
    view = trigger.view();
  }
  EXPECT_FALSE(view.failed);
  // A busy machine leaves pulses out, with their numbers: those that are made are never early, and do not drift.
  std::vector<std::int64_t> late_ns;
  for (std::size_t i = 0; i < made.size(); ++i) {
    late_ns.push_back(made[i].mono_ns - pulses.due_ns(made[i].n) - begin_ns);
    EXPECT_GE(late_ns.back(), 0) << made[i].n;
    EXPECT_TRUE(i == 0 || made[i].n > made[i - 1].n);
  }
  const auto half = late_ns.begin() + static_cast<std::ptrdiff_t>(late_ns.size() / 2);
  const std::int64_t drift_ns =
      *std::min_element(half, late_ns.end()) - *std::min_element(late_ns.begin(), half);
  EXPECT_LT(std::abs(drift_ns), 20 * pulses.period_ns());
  const std::scoped_lock lock(wire.mutex);
  ASSERT_GE(wire.changes.size(), 2 * made.size());
  EXPECT_FALSE(wire.changes.back().high) << "low at the end";
  for (std::size_t i = 0; i < made.size(); ++i) {
    EXPECT_TRUE(wire.changes[2 * i].high);
    EXPECT_FALSE(wire.changes[2 * i + 1].high);
    EXPECT_GE(wire.changes[2 * i].mono_ns, made[i].mono_ns);
    EXPECT_GE(wire.changes[2 * i + 1].mono_ns - made[i].mono_ns, pulses.pulse_ns);
  }
}

TEST(GpioTrigger, ALineThatIsGoneEndsIt) {
  Wire wire;
  GpioTrigger trigger(std::make_unique<WireOutput>(wire), {100, 1, 1'000'000});
  ASSERT_TRUE(test::eventually([&] { return trigger.view().made > 3; }));
  {
    const std::scoped_lock lock(wire.mutex);
    wire.gone = true;
  }
  EXPECT_TRUE(test::eventually([&] { return trigger.view().failed; }));
}

}  // namespace
}  // namespace lightwell
