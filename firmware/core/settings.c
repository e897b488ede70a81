// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/settings.h"

#include "firmware/core/trigger.h"

// Places of the fields in SYNC_CONFIGURE; a unit test holds them against the protocol's table.
enum {
  kRateNumerator,
  kRateDenominator,
  kPhase,
  kPulse,
  kTriggerOn,
  kReference,
  kReferenceNumerator,
  kReferenceDenominator,
  kStrobeWindow,
  kStrobeActiveLow,
  kExposure,
  kPhotodiodeDark,
  kPhotodiodeScale,
  kHeartbeat,
  kCameraOn,
  kCameraWatchdog,
  kCameraOff,
  kStore
};

enum {
  kHighestRateHz = 1000,  // a trigger's interrupt, and its messages on a UART of 1 Mbit/s
  kHighestReferenceHz = 240,
  kMostNumerator = 1000000,
  kMostDenominator = 10000,
  kMostPhaseNs = 500000000,
  kLeastPulseNs = 10000,  // what an interrupt needs to program the pulse's end
  kMostPulseNs = 100000000,
  kLeastWindowNs = 1000,
  kMostWindowNs = 1000000000,
  kMostExposureNs = 1000000000,
  kMostDark = 65535,        // 4095.9 codes
  kMostScale = 1000000000,  // 1000 lx a code
  kLeastHeartbeatMs = 100,
  kMostHeartbeatMs = 60000,
  kLeastWatchdogMs = 500,
  kMostWatchdogMs = 600000,
  kLeastOffMs = 200,  // a camera's capacitors
  kMostOffMs = 60000
};

sync_configuration settings_default(void) {
  const sync_configuration safe = {.rate_numerator = 60,
                                   .rate_denominator = 1,
                                   .pulse_ns = 100000,
                                   .reference_numerator = 1,
                                   .reference_denominator = 1,
                                   .strobe_window_ns = 10000000,
                                   .exposure_ns = 8000000,
                                   .photodiode_ulx = 1000000,
                                   .heartbeat_ms = 5000,
                                   .camera_off_ms = 2000};
  return safe;
}

static bool within(int64_t value, int64_t minimum, int64_t maximum, uint8_t field,
                   settings_refusal* refusal) {
  if (value >= minimum && value <= maximum) return true;
  refusal->field = field;
  refusal->minimum = minimum;
  refusal->maximum = maximum;
  return false;
}

// 0 switches off; else within.
static bool off_or_within(int64_t value, int64_t minimum, int64_t maximum, uint8_t field,
                          settings_refusal* refusal) {
  return value == 0 || within(value, minimum, maximum, field, refusal);
}

static bool rate_valid(uint32_t numerator, uint32_t denominator, int64_t highest, uint8_t field,
                       settings_refusal* refusal) {
  const int64_t most = (int64_t)denominator * highest;
  return within(denominator, 1, kMostDenominator, (uint8_t)(field + 1u), refusal) &&
         within(numerator, denominator, most < kMostNumerator ? most : (int64_t)kMostNumerator, field,
                refusal);
}

static bool rates_valid(const sync_configuration* s, settings_refusal* refusal) {
  uint64_t step;
  uint32_t parts;
  if (!rate_valid(s->rate_numerator, s->rate_denominator, kHighestRateHz, kRateNumerator, refusal) ||
      !rate_valid(s->reference_numerator, s->reference_denominator, kHighestReferenceHz, kReferenceNumerator,
                  refusal))
    return false;
  if (s->reference == SYNC_REFERENCE_NONE ||
      trigger_ratio(s->rate_numerator, s->rate_denominator, s->reference_numerator, s->reference_denominator,
                    &step, &parts))
    return true;
  // These two rates meet too rarely. Whole numbers of hertz always do.
  return within(s->rate_denominator, 1, 1, kRateDenominator, refusal);
}

bool settings_valid(const sync_configuration* s, settings_refusal* refusal) {
  if (!rates_valid(s, refusal)) return false;
  const int64_t period_ns = (int64_t)1000000000 * s->rate_denominator / s->rate_numerator;
  // Half the period stays low, or pulses would join.
  const int64_t pulse_ns = period_ns / 2 < kMostPulseNs ? period_ns / 2 : (int64_t)kMostPulseNs;
  return within(s->phase_ns, -kMostPhaseNs, kMostPhaseNs, kPhase, refusal) &&
         within(s->pulse_ns, kLeastPulseNs, pulse_ns, kPulse, refusal) &&
         within(s->trigger_on, 0, 1, kTriggerOn, refusal) &&
         within(s->reference, SYNC_REFERENCE_NONE, SYNC_REFERENCE_TIMECODE, kReference, refusal) &&
         within(s->strobe_window_ns, kLeastWindowNs, kMostWindowNs, kStrobeWindow, refusal) &&
         within(s->strobe_active_low, 0, 1, kStrobeActiveLow, refusal) &&
         within(s->exposure_ns, 1, kMostExposureNs, kExposure, refusal) &&
         within(s->photodiode_dark, 0, kMostDark, kPhotodiodeDark, refusal) &&
         within(s->photodiode_ulx, 1, kMostScale, kPhotodiodeScale, refusal) &&
         off_or_within(s->heartbeat_ms, kLeastHeartbeatMs, kMostHeartbeatMs, kHeartbeat, refusal) &&
         within(s->camera_on, 0, 1, kCameraOn, refusal) &&
         off_or_within(s->camera_watchdog_ms, kLeastWatchdogMs, kMostWatchdogMs, kCameraWatchdog, refusal) &&
         within(s->camera_off_ms, kLeastOffMs, kMostOffMs, kCameraOff, refusal) &&
         within(s->store, 0, 1, kStore, refusal);
}

sync_configuration settings_safe(const sync_configuration* settings) {
  sync_configuration safe = *settings;
  safe.trigger_on = 0;
  return safe;
}
