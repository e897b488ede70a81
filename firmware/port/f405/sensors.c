// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// On I2C1 at 400 kHz: an LSM6DSO (accelerometer and gyroscope, ST data sheet DS12140) and TMP102s on the board and at the
// camera. Waits are bounded: a bus that hangs costs 0.2 ms a try and is tried again once a second.
#include "firmware/hal/hal.h"
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"

enum { kImu = 0x6A, kBoardTemperature = 0x48, kCameraTemperature = 0x49 };
enum {
  kWhoAmI = 0x0F,
  kAccelerometer = 0x10,
  kGyroscope = 0x11,
  kControl3 = 0x12,
  kData = 0x22,
  kLsm6dso = 0x6C
};
enum { kImuHz = 208, kTemperatureHz = 4, kPatience = 2000 };
enum { kStart = 1 << 8, kStop = 1 << 9, kAcknowledge = 1 << 10 };
enum {
  kStarted = 1,
  kAddressed = 1 << 1,
  kFinished = 1 << 2,
  kFull = 1 << 6,
  kFree = 1 << 7,
  kRefused = 1 << 10
};

static const float kAccelerationScale = 0.122e-3f * 9.80665f;     // m/s² a code at ±4 g
static const float kRateScale = 17.5e-3f * 3.14159265f / 180.0f;  // rad/s a code at ±500 °/s

static uint32_t tick_hz;
static bool imu_there;
static uint32_t last_imu, last_temperature, last_try;
static uint8_t sensor;

static bool wait_for(uint32_t flag) {
  for (uint32_t i = 0; i < (uint32_t)kPatience; ++i) {
    const uint32_t status = SENSOR_I2C->status1;
    if ((status & (uint32_t)kRefused) != 0u) return false;
    if ((status & flag) != 0u) return true;
  }
  return false;
}

static bool address(uint8_t device, bool reading) {
  SENSOR_I2C->control1 |= (uint32_t)kStart | (uint32_t)kAcknowledge;
  if (!wait_for(kStarted)) return false;
  SENSOR_I2C->data = (uint32_t)device << 1 | (reading ? 1u : 0u);
  if (!wait_for(kAddressed)) return false;
  (void)SENSOR_I2C->status2;  // with status1 before it: clears the flag
  return true;
}

static bool send_bytes(uint8_t device, const uint8_t* bytes, uint32_t count) {
  if (!address(device, false)) return false;
  for (uint32_t i = 0; i < count; ++i) {
    if (!wait_for(kFree)) return false;
    SENSOR_I2C->data = bytes[i];
  }
  return wait_for(kFinished);
}

static bool receive(uint8_t device, uint8_t from, uint8_t* bytes, uint32_t count) {
  bool good = send_bytes(device, &from, 1) && address(device, true);
  for (uint32_t i = 0; i < count && good; ++i) {
    // The last byte is not acknowledged, and STOP is asked for before it has come.
    if (i + 1u == count) {
      SENSOR_I2C->control1 &= ~(uint32_t)kAcknowledge;
      SENSOR_I2C->control1 |= kStop;
    }
    good = wait_for(kFull);
    bytes[i] = (uint8_t)SENSOR_I2C->data;
  }
  if (!good) {
    SENSOR_I2C->status1 = 0;
    SENSOR_I2C->control1 |= kStop;
  }
  return good;
}

static bool set(uint8_t device, uint8_t where, uint8_t value) {
  const uint8_t bytes[2] = {where, value};
  const bool good = send_bytes(device, bytes, 2);
  SENSOR_I2C->status1 = 0;
  SENSOR_I2C->control1 |= kStop;
  return good;
}

static void find_imu(void) {
  uint8_t who = 0;
  imu_there = receive(kImu, kWhoAmI, &who, 1) && who == (uint8_t)kLsm6dso && set(kImu, kControl3, 0x44) &&
              set(kImu, kAccelerometer, 0x58) && set(kImu, kGyroscope, 0x54);  // 208 Hz, ±4 g, ±500 °/s
}

void sensors_start(uint32_t clock_hz) {
  const uint32_t mhz = clock_hz / 1000000u;
  const uint32_t bus_mhz = mhz > 42u ? mhz / 2u : mhz;  // APB1: half the timers' rate where it is divided
  tick_hz = clock_hz;
  SENSOR_I2C->control1 = 0;
  SENSOR_I2C->control2 = bus_mhz;
  SENSOR_I2C->clock = 1u << 15 | bus_mhz * 1000u / (3u * 400u);  // fast: low twice as long as high
  SENSOR_I2C->rise = bus_mhz * 3u / 10u + 1u;
  SENSOR_I2C->control1 = 1u;
  find_imu();
}

static int16_t word(const uint8_t* at) {
  return (int16_t)(uint16_t)(at[0] | (uint16_t)((uint16_t)at[1] << 8));
}

bool hal_imu(float acceleration[3], float rate[3], uint32_t* stamp) {
  const uint32_t now = hal_ticks();
  if (!imu_there) {
    if (now - last_try < tick_hz) return false;
    last_try = now;
    find_imu();
    return false;
  }
  if (now - last_imu < tick_hz / (uint32_t)kImuHz) return false;
  last_imu = now;
  uint8_t bytes[12];
  if (!receive(kImu, kData, bytes, sizeof bytes)) {
    imu_there = false;
    return false;
  }
  for (unsigned i = 0; i < 3u; ++i) {
    rate[i] = (float)word(bytes + 2u * i) * kRateScale;
    acceleration[i] = (float)word(bytes + 6u + 2u * i) * kAccelerationScale;
  }
  *stamp = now;
  return true;
}

bool hal_temperature(uint8_t* which, int32_t* reading_mc) {
  const uint32_t now = hal_ticks();
  if (now - last_temperature < tick_hz / (2u * (uint32_t)kTemperatureHz)) return false;
  last_temperature = now;
  sensor = sensor == (uint8_t)SYNC_SENSOR_BOARD ? SYNC_SENSOR_CAMERA : SYNC_SENSOR_BOARD;
  uint8_t bytes[2];
  if (!receive(sensor == (uint8_t)SYNC_SENSOR_BOARD ? kBoardTemperature : kCameraTemperature, 0, bytes, 2))
    return false;
  *which = sensor;
  *reading_mc = temperature_of_tmp105((uint16_t)((uint16_t)((uint16_t)bytes[0] << 8) | bytes[1]));
  return true;
}
