// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The emulated board. QEMU's machine has no pins that capture and no converter: edges, samples and sensors come in over a
// second UART, the stimulus, as records of eight bytes; pulses go out of it as they were made, stamped.
//   in:  u8 kind, u8 index, u16 0, u32 value, little-endian
//        'E' edge: index a board_input, value its stamp    'S' sample: value its code
//        'I' inertial: index 0 to 5, value a float's bits (three of acceleration, three of rate; the sixth ends a sample)
//        'C', 'H' timecode's cells: value the stamp of the next half cell's start; the length of one, ticks × 2^16
//        'L' of the next index half cells (32 at most), value tells from its lowest bit which begin with an edge
//        'T' temperature: index the sensor, value m°C      'B' button: value its level
//   out: 'P', u8 0, u16 0, u32 stamp of a pulse's rise, by the clock that board time counts

#include "firmware/hal/hal.h"

#include "firmware/port/mps2/memory.h"
#include "firmware/port/mps2/registers.h"

enum { kClockHz = 25000000, kRing = 256, kRecord = 8, kEdges = 64, kCells = 32, kSoonTicks = 50 };
static const uint32_t kTimer32 = 1u << 1, kTimerInterrupt = 1u << 5, kTimerPeriodic = 1u << 6,
                      kTimerEnabled = 1u << 7;

// One writer (the interrupt), one reader (the loop); indices wrap with their type.
static uint8_t ring[kRing];
static volatile uint8_t ring_head;
static volatile uint8_t ring_tail;
static volatile uint32_t lost;

// Pulses: the first is armed, the second waits. Written by the loop with interrupts off, and by the interrupt.
static uint32_t rises[PULSES_AHEAD];
static uint32_t lengths[PULSES_AHEAD];
static volatile unsigned pulses_count;
static volatile uint32_t stamps[kRing];
static volatile uint8_t made_head;
static uint8_t made_tail;
static uint8_t reported;
static unsigned missed;

static uint8_t record[kRecord];
static unsigned record_size;
static bool have_sample, have_imu, have_temperature, pressed;
static uint16_t sample_code;
static float inertial[6];
static uint8_t sensor_index;
static int32_t sensor_mc;
static hal_edge_event edges[kEdges];
static unsigned edges_head, edges_tail;
static uint64_t cell_q16;  // stamp of the next half cell, × 2^16
static uint32_t cell_length_q16;
static uint8_t report[kRecord];
static unsigned report_left;

static const board_facts kFacts = {.tick_hz = kClockHz,
                                   .capabilities = SYNC_CAN_TRIGGER | SYNC_CAN_STROBE | SYNC_CAN_REFERENCE |
                                                   SYNC_CAN_TIMECODE | SYNC_CAN_PHOTODIODE | SYNC_CAN_IMU |
                                                   SYNC_CAN_TEMPERATURE | SYNC_CAN_BUTTON |
                                                   SYNC_CAN_CAMERA_POWER | SYNC_CAN_STORE,
                                   .serial = {0x4D505332u, 386u, 0u},
                                   .sample_hz = 8000,
                                   .highest_code = 4095,
                                   .memory = &ram_flash,
                                   .verifier = 0};

void uart0_receive_interrupt(void);
void rise_interrupt(void);
void fall_interrupt(void);

static void interrupts_off(void) {
  __asm volatile("cpsid i" ::: "memory");
}
static void interrupts_on(void) {
  __asm volatile("cpsie i" ::: "memory");
}

void uart0_receive_interrupt(void) {
  LINK_UART->interrupt = 2u;
  while ((LINK_UART->state & 2u) != 0u) {
    const uint8_t byte = (uint8_t)LINK_UART->data;
    if ((uint8_t)(ring_head + 1u) == ring_tail)
      ++lost;
    else
      ring[ring_head++] = byte;
  }
}

uint32_t hal_ticks(void) {
  return 0xFFFFFFFFu - CLOCK_TIMER->value;
}

// The rise timer has begun anew from its next load already, which was set to the distance of the pulse after this one: the
// distance between two edges is counted by the timer, not by this program.
void rise_interrupt(void) {
  const uint32_t now = hal_ticks();
  RISE_TIMER->interrupt = 1u;
  FPGA_LEDS |= 2u;
  FALL_TIMER->value = lengths[0];
  FALL_TIMER->control = 1u | 8u;
  stamps[made_head++] = now;
  const unsigned left = --pulses_count;
  if (left == 0u) {
    RISE_TIMER->control = kTimer32;
    return;
  }
  rises[0] = rises[1];
  lengths[0] = lengths[1];
  RISE_TIMER->next_load = 0xFFFFFFFFu;  // until another is given
}

void fall_interrupt(void) {
  FALL_TIMER->control = 0;
  FALL_TIMER->interrupt = 1u;
  FPGA_LEDS &= ~2u;
}

void hal_pulse(uint32_t rise, uint32_t fall) {
  interrupts_off();
  const unsigned at = pulses_count;
  const uint32_t away = rise - hal_ticks();
  if (at == 0u && (away < (uint32_t)kSoonTicks || away >= 0x80000000u)) {
    ++missed;
  } else {
    rises[at] = rise;
    lengths[at] = fall - rise;
    if (at == 0u) {
      RISE_TIMER->control = kTimer32;
      RISE_TIMER->load = away;
      RISE_TIMER->next_load = 0xFFFFFFFFu;
      RISE_TIMER->control = kTimer32 | kTimerInterrupt | kTimerPeriodic | kTimerEnabled;
    } else {
      RISE_TIMER->next_load = rise - rises[0] - 1u;
    }
    pulses_count = at + 1u;
  }
  interrupts_on();
}

bool hal_pulse_done(bool* made) {
  if (reported != made_head) {
    ++reported;
    *made = true;
    return true;
  }
  if (missed == 0u) return false;
  --missed;
  *made = false;
  return true;
}

void hal_pulses_forget(void) {
  interrupts_off();
  RISE_TIMER->control = kTimer32;
  RISE_TIMER->interrupt = 1u;
  pulses_count = 0;
  reported = made_head;
  missed = 0;
  interrupts_on();
}

const board_facts* hal_init(void) {
  COPROCESSOR_ACCESS |= 0xFu << 20;
  NVIC_PRIORITY_0 = 0x80808080u;  // UARTs below the timers
  LINK_UART->divider = 16u;
  LINK_UART->control = 1u | 2u | 8u;
  STIMULUS_UART->divider = 16u;
  STIMULUS_UART->control = 1u | 2u;
  CLOCK_TIMER->load = 0xFFFFFFFFu;
  CLOCK_TIMER->control = 0x80u | 0x02u;
  NVIC_ENABLE = (1u << LINK_INTERRUPT) | (1u << RISE_INTERRUPT) | (1u << FALL_INTERRUPT);
  return &kFacts;
}

bool hal_link_read(uint8_t link, uint8_t* byte) {
  if (link != 0u || ring_head == ring_tail) return false;
  *byte = ring[ring_tail++];
  return true;
}

bool hal_link_ready(uint8_t link) {
  return link == 0u && (LINK_UART->state & 1u) == 0u;
}

void hal_link_write(uint8_t link, uint8_t byte) {
  (void)link;
  LINK_UART->data = byte;
}

static void take_edge(board_input input, uint32_t stamp) {
  if (edges_head - edges_tail == (unsigned)kEdges) {
    ++lost;
    return;
  }
  edges[edges_head++ % (unsigned)kEdges] = (hal_edge_event){input, stamp};
}

static void take_cells(unsigned count, uint32_t changes) {
  for (unsigned i = 0; i < count && i < (unsigned)kCells; ++i) {
    if ((changes >> i & 1u) != 0u) take_edge(BOARD_TIMECODE, (uint32_t)(cell_q16 >> 16));
    cell_q16 += cell_length_q16;
  }
}

static void take_record(void) {
  const uint32_t value =
      (uint32_t)record[4] | (uint32_t)record[5] << 8 | (uint32_t)record[6] << 16 | (uint32_t)record[7] << 24;
  const union {
    uint32_t bits;
    float number;
  } pun = {.bits = value};
  switch (record[0]) {
    case 'E':
      take_edge((board_input)record[1], value);
      break;
    case 'C':
      cell_q16 = (uint64_t)value << 16 | 0x8000u;  // rounded to the nearest tick
      break;
    case 'H':
      cell_length_q16 = value;
      break;
    case 'L':
      take_cells(record[1], value);
      break;
    case 'S':
      sample_code = (uint16_t)value;
      have_sample = true;
      break;
    case 'I':
      inertial[record[1] % 6u] = pun.number;
      have_imu = record[1] == 5u;
      break;
    case 'T':
      sensor_index = record[1];
      sensor_mc = (int32_t)value;
      have_temperature = true;
      break;
    default:
      pressed = value != 0u;
      break;
  }
}

// The model's UART holds its sender back while a byte waits: nothing is lost by asking. What was taken must have been
// fetched before the next record is.
static void listen(void) {
  while (!have_sample && !have_imu && !have_temperature &&
         edges_head - edges_tail <= (unsigned)kEdges - (unsigned)kCells &&
         (STIMULUS_UART->state & 2u) != 0u) {
    record[record_size++] = (uint8_t)STIMULUS_UART->data;
    if (record_size == (unsigned)kRecord) {
      record_size = 0;
      take_record();
    }
  }
}

bool hal_edge(hal_edge_event* event) {
  listen();
  if (edges_head == edges_tail) return false;
  *event = edges[edges_tail++ % (unsigned)kEdges];
  return true;
}

bool hal_sample(uint16_t* code) {
  listen();
  if (!have_sample) return false;
  have_sample = false;
  *code = sample_code;
  return true;
}

bool hal_imu(float acceleration[3], float rate[3], uint32_t* stamp) {
  if (!have_imu) return false;
  have_imu = false;
  for (unsigned i = 0; i < 3u; ++i) {
    acceleration[i] = inertial[i];
    rate[i] = inertial[i + 3u];
  }
  *stamp = hal_ticks();
  return true;
}

bool hal_temperature(uint8_t* sensor, int32_t* reading_mc) {
  if (!have_temperature) return false;
  have_temperature = false;
  *sensor = sensor_index;
  *reading_mc = sensor_mc;
  return true;
}

bool hal_button(void) {
  return pressed;
}

void hal_led(bool lit) {
  FPGA_LEDS = (FPGA_LEDS & ~1u) | (lit ? 1u : 0u);
}

// There is no camera; the loop's turn serves to report pulses.
void hal_camera_power(bool on) {
  (void)on;
  if (report_left == 0u && made_tail != made_head) {
    const uint32_t stamp = stamps[made_tail++];
    report[0] = 'P';
    report[1] = report[2] = report[3] = 0;
    for (unsigned i = 0; i < 4u; ++i) report[4u + i] = (uint8_t)(stamp >> (8u * i));
    report_left = (unsigned)kRecord;
  }
  while (report_left > 0u && (STIMULUS_UART->state & 1u) == 0u)
    STIMULUS_UART->data = report[(unsigned)kRecord - report_left--];
}

uint32_t hal_overruns(void) {
  return lost;
}

void hal_watchdog(void) {}  // an emulator that stands still is seen by its test
