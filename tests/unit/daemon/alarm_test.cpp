// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/alarm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lightwell {
namespace {

using testing::HasSubstr;

DaemonStatus well() {
  DaemonStatus status;
  status.source_state = SourceState::streaming;
  status.published = 100;
  status.frame_age_ms = 20;
  return status;
}

TEST(Alarm, NothingWrongIsEmpty) {
  EXPECT_EQ(alarm_for(well()), "");
}

TEST(Alarm, ADeadCameraComesBeforeEverythingElse) {
  DaemonStatus status = well();
  status.source_state = SourceState::no_device;
  status.source_description = "nothing answers at 127.0.0.1";
  status.recording.error = "disk full";
  EXPECT_THAT(alarm_for(status), HasSubstr("nothing answers at 127.0.0.1"));
}

TEST(Alarm, StaleLightAndFailedRecordingAreSaid) {
  DaemonStatus status = well();
  status.frame_age_ms = 2500;
  EXPECT_THAT(alarm_for(status), HasSubstr("2.5 s old"));
  status = well();
  status.recording.error = "disk full";
  EXPECT_THAT(alarm_for(status), HasSubstr("disk full"));
  status = well();
  status.recording.active = true;
  status.recording.dropped = 3;
  EXPECT_THAT(alarm_for(status), HasSubstr("3 frames"));
}

TEST(Alarm, ARecordingThatEndedIsNoAlarm) {
  DaemonStatus status = well();
  status.source_state = SourceState::ended;
  status.frame_age_ms = 60000;
  EXPECT_EQ(alarm_for(status), "");
}

TEST(CalibrationChange, IsSaidWhenItBeginsAndWhenItEndsAndNotBetween) {
  const std::string wrong = "frame width = 320: allowed 640, the lens's image_size";
  EXPECT_EQ(calibration_change("", ""), "");
  EXPECT_THAT(calibration_change("", wrong), HasSubstr(wrong));
  EXPECT_EQ(calibration_change(wrong, wrong), "");
  EXPECT_THAT(calibration_change(wrong, "response.bits = 8"),
              HasSubstr("response.bits = 8"));  // another reason
  EXPECT_THAT(calibration_change(wrong, ""), HasSubstr("fits the frames again"));
}

}  // namespace
}  // namespace lightwell
