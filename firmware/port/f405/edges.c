// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// TIM2, 32 bits, free-running: compare channel 1 makes the trigger's edges, channels 2 to 4 stamp the inputs'. The
// interrupt only moves values: an edge is where the timer put it, however late the interrupt comes.
#include "firmware/hal/hal.h"
#include "firmware/port/f405/port.h"
#include "firmware/port/f405/registers.h"

// A pulse is reported at its rise, and another given for it, while it is still high.
enum { kEdges = 64, kDone = 8, kWaiting = PULSES_AHEAD + 1 };
enum { kActiveOnMatch = 1, kInactiveOnMatch = 2, kForcedInactive = 4 };
enum { kCompare1 = 1 << 1, kCapture2 = 1 << 2, kCapture3 = 1 << 3, kCapture4 = 1 << 4 };
static const uint32_t kOvercaptures = 7u << 10;  // of channels 2 to 4

// Written by the interrupt, read by the loop; the pulses also by the loop with interrupts off.
static hal_edge_event edges[kEdges];
static volatile uint32_t edges_head;
static uint32_t edges_tail;
static struct { uint32_t rise, fall; } waiting[kWaiting];
static volatile unsigned waiting_count;
static volatile bool high;
static volatile bool done[kDone];
static volatile uint32_t done_head;
static uint32_t done_tail;
static volatile uint32_t lost;

void edge_interrupt(void);

static void output(uint32_t mode) {
  EDGE_TIMER->compare_mode[0] = (EDGE_TIMER->compare_mode[0] & ~(7u << 4)) | mode << 4;
}

static bool passed(uint32_t tick) {
  return (int32_t)(tick - EDGE_TIMER->count) <= 0;
}

static void report(bool made) {
  done[done_head++ % (uint32_t)kDone] = made;
}

static void drop_first(void) {
  for (unsigned i = 1; i < waiting_count; ++i) waiting[i - 1u] = waiting[i];
  --waiting_count;
}

// Arms the first pulse whose time has not come; with none left the line rests.
static void arm(void) {
  output(kForcedInactive);
  high = false;
  while (waiting_count > 0u) {
    EDGE_TIMER->compare[0] = waiting[0].rise;
    EDGE_TIMER->status = ~(uint32_t)kCompare1;
    output(kActiveOnMatch);
    // Passed while it was being armed, and not made: the timer would come back to it after a wrap.
    if (!passed(waiting[0].rise) || (EDGE_TIMER->status & (uint32_t)kCompare1) != 0u) {
      EDGE_TIMER->interrupts |= kCompare1;
      return;
    }
    output(kForcedInactive);
    report(false);
    drop_first();
  }
  EDGE_TIMER->interrupts &= ~(uint32_t)kCompare1;
}

static void next_pulse_edge(void) {
  if (!high) {
    report(true);
    high = true;
    EDGE_TIMER->compare[0] = waiting[0].fall;
    output(kInactiveOnMatch);
    if (!passed(waiting[0].fall) || (EDGE_TIMER->status & (uint32_t)kCompare1) != 0u) return;
  }
  drop_first();
  arm();
}

static void capture(board_input input, uint32_t stamp) {
  if (edges_head - edges_tail == (uint32_t)kEdges) {
    ++lost;
    return;
  }
  edges[edges_head % (uint32_t)kEdges] = (hal_edge_event){input, stamp};
  ++edges_head;
}

void edge_interrupt(void) {
  const uint32_t status = EDGE_TIMER->status;
  if ((status & kOvercaptures) != 0u) {
    EDGE_TIMER->status = ~kOvercaptures;
    ++lost;
  }
  if ((status & EDGE_TIMER->interrupts & (uint32_t)kCompare1) != 0u) {
    EDGE_TIMER->status = ~(uint32_t)kCompare1;
    if (waiting_count > 0u) next_pulse_edge();
  }
  // Reading a capture clears its flag.
  if ((status & (uint32_t)kCapture2) != 0u) {
    const uint32_t stamp = EDGE_TIMER->compare[1];
    capture((GPIO_A->input & 2u) != 0u ? BOARD_STROBE_RISE : BOARD_STROBE_FALL, stamp);
  }
  if ((status & (uint32_t)kCapture3) != 0u) capture(BOARD_REFERENCE, EDGE_TIMER->compare[2]);
  if ((status & (uint32_t)kCapture4) != 0u) capture(BOARD_TIMECODE, EDGE_TIMER->compare[3]);
}

void edges_start(void) {
  EDGE_TIMER->prescaler = 0;
  EDGE_TIMER->reload = 0xFFFFFFFFu;
  EDGE_TIMER->event = 1;  // take both over
  // Channel 1 compares; 2 to 4 capture their own pin, each edge held for eight timer clocks against glitches.
  EDGE_TIMER->compare_mode[0] = (uint32_t)kForcedInactive << 4 | 1u << 8 | 3u << 12;
  EDGE_TIMER->compare_mode[1] = 1u | 3u << 4 | 1u << 8 | 3u << 12;
  EDGE_TIMER->compare_enable = 1u | 1u << 4 | 5u << 5 | 1u << 8 | 1u << 12 | 5u << 13;  // 2 and 4: both edges
  EDGE_TIMER->status = 0;
  EDGE_TIMER->interrupts = kCapture2 | kCapture3 | kCapture4;
  EDGE_TIMER->control1 = 1;
}

uint32_t edges_overruns(void) {
  return lost;
}

uint32_t hal_ticks(void) {
  return EDGE_TIMER->count;
}

void hal_pulse(uint32_t rise, uint32_t fall) {
  interrupts_off();
  if (waiting_count < (unsigned)kWaiting) {
    waiting[waiting_count].rise = rise;
    waiting[waiting_count].fall = fall;
    if (++waiting_count == 1u) arm();
  }
  interrupts_on();
}

bool hal_pulse_done(bool* made) {
  if (done_tail == done_head) return false;
  *made = done[done_tail++ % (uint32_t)kDone];
  return true;
}

void hal_pulses_forget(void) {
  interrupts_off();
  waiting_count = 0;
  arm();
  done_tail = done_head;
  interrupts_on();
}

bool hal_edge(hal_edge_event* event) {
  if (edges_tail == edges_head) return false;
  *event = edges[edges_tail % (uint32_t)kEdges];
  ++edges_tail;
  return true;
}
