// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Which trigger a strobe answers. A rise belongs to the last trigger before it, if it comes within the window (always
// shorter than the trigger's period); a fall to the rise before it, if the exposure then is shorter than the period. A
// fall behind the next trigger could be that one's own, its rise lost: it counts only if that rise then comes.
// So a lost trigger, strobe or edge costs its own frame and never shifts another. Edges that bounce are one edge: the
// first rise and the last fall count. 64-bit times: no wrap.

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { STROBE_TRIGGERS = 8 };  // some of them still to come

typedef struct {
  uint32_t n;  // trigger
  bool paired, no_fall, bounced;
  uint64_t rise, fall;  // ticks; fall 0 where it was not seen
} strobe_report;

typedef struct {
  uint64_t window, longest, bounce;  // ticks
  struct {
    uint32_t n;
    uint64_t tick;
    bool valid, answered;
  } triggers[STROBE_TRIGGERS];
  unsigned newest;
  bool pending, open;  // a rise was seen, and its fall is awaited
  bool doubtful;       // the fall came behind the trigger doubt_n
  uint32_t doubt_n;
  uint64_t doubt_end;  // when that trigger's rise is overdue
  uint64_t last_edge;
  strobe_report report;  // what is pending
  uint32_t paired, stray, doubled, unanswered;
} strobe;

// period: of the triggers, ticks. The window is held below 7/8 of it.
void strobe_init(strobe* self, uint64_t window, uint64_t period, uint64_t bounce);

// A trigger will be sent, or was; call before edges that may answer it.
void strobe_trigger(strobe* self, uint32_t n, uint64_t tick);

// It was not sent after all.
void strobe_no_trigger(strobe* self, uint32_t n);

// An edge. True: *report holds a strobe that this edge has ended.
bool strobe_edge(strobe* self, uint64_t tick, bool rise, strobe_report* report);

// True: *report holds a strobe that no more edges can change, or whose fall is overdue.
bool strobe_poll(strobe* self, uint64_t now, strobe_report* report);

#ifdef __cplusplus
}
#endif
