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

TEST(Alarm, ACameraThatDoesNotOpenIsSaidAfterAWhile) {
  DaemonStatus status = well();
  status.source_state = SourceState::opening;
  status.source_description = "/dev/video0 is in use";
  status.published = 0;
  status.uptime_s = 1;
  EXPECT_EQ(alarm_for(status), "");
  status.uptime_s = 8;
  EXPECT_THAT(alarm_for(status), HasSubstr("is in use"));
}

TEST(Alarm, ABoardThatDoesNotDoWhatItIsToldIsSaid) {
  DaemonStatus status = well();
  status.board.state = BoardState::connected;
  status.board.status = sync_status{};
  EXPECT_EQ(alarm_for(status), "");
  status.board.acquiring_s = 9;
  EXPECT_THAT(alarm_for(status), HasSubstr("no lock"));
  status.board.acquiring_s = 0;
  status.board.status->lock = SYNC_LOCK_HOLDOVER;
  status.board.status->holdover_s = 1;
  EXPECT_EQ(alarm_for(status), "") << "an edge may come late";
  status.board.status->holdover_s = 7;
  EXPECT_THAT(alarm_for(status), HasSubstr("since 7 s"));
  status.board.status = sync_status{};
  status.board.status->safe = 1;
  EXPECT_THAT(alarm_for(status), HasSubstr("safe defaults"));
  status.board.refused = "rate_numerator: allowed 1 to 1000";
  EXPECT_THAT(alarm_for(status), HasSubstr("1 to 1000"));
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
