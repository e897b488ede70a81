// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the sync board and the daemon say to each other; C11, shared with the firmware. The same bytes on UART
// and USB: over USB bulk a transfer is a piece of the stream, its borders mean nothing.
//
// A frame on the wire: COBS(header, payload, CRC) and a zero byte (interface/sync_frame.h). All integers
// little-endian, no padding, no floating point.
//   offset 0  u8   protocol version, SYNC_PROTOCOL_VERSION
//   offset 1  u8   message type, sync_type
//   offset 2  u16  sequence, counts the sender's frames and wraps
//   offset 4  …    payload: the message's fields in the order of its struct, at most SYNC_MAX_PAYLOAD bytes
//   last two  u16  CRC-16/CCITT-FALSE (polynomial 0x1021, start 0xFFFF) over all before it
//
// Times ending in _board_ns are nanoseconds since the board's start, 64 bits, never wrapping. Nanoseconds, not
// microseconds: the servo holds 1 µs and the timer counts 11.9 ns; a microsecond on the wire would hide both.
// A sender never sends a message before HELLO has shown equal schema hashes, HELLO_REQUEST and PING apart.

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SYNC_PROTOCOL_VERSION 2u
#define SYNC_HEADER_SIZE 4u
#define SYNC_CRC_SIZE 2u
#define SYNC_MAX_PAYLOAD 240u
#define SYNC_MAX_FRAME (SYNC_HEADER_SIZE + SYNC_MAX_PAYLOAD + SYNC_CRC_SIZE)
// COBS adds one byte a started block of 254, and the zero that ends the frame.
#define SYNC_MAX_WIRE (SYNC_MAX_FRAME + SYNC_MAX_FRAME / 254u + 2u)

// FNV-1a over every message's number, and every field's name, kind and count (sync_schema_hash): both ends
// compare it in HELLO. A unit test holds the constant against the tables.
#define SYNC_SCHEMA_HASH 0xf8f2872au

typedef enum {
  // host to board
  SYNC_HELLO_REQUEST = 0x01,          // answered with HELLO
  SYNC_PING = 0x03,                   // answered with PONG
  SYNC_CONFIGURE = 0x05,              // whole or not at all: answered with CONFIGURATION or FAULT
  SYNC_CONFIGURATION_REQUEST = 0x07,  // answered with CONFIGURATION
  SYNC_STATUS_REQUEST = 0x09,         // answered with STATUS
  SYNC_HOST_STATE = 0x0b,    // what the LED shows; answered with nothing. Every good frame is a heartbeat
  SYNC_UPDATE_BEGIN = 0x0d,  // these three are answered with UPDATE_STATE or FAULT
  SYNC_UPDATE_BLOCK = 0x0f,
  SYNC_UPDATE_FINISH = 0x11,
  // board to host
  SYNC_HELLO = 0x02,
  SYNC_PONG = 0x04,
  SYNC_CONFIGURATION = 0x06,
  SYNC_STATUS = 0x0a,  // also once a second
  SYNC_UPDATE_STATE = 0x0e,
  SYNC_TRIGGER = 0x20,
  SYNC_STROBE = 0x21,
  SYNC_PHOTODIODE = 0x22,
  SYNC_IMU = 0x23,
  SYNC_TEMPERATURE = 0x24,
  SYNC_BUTTON = 0x25,
  SYNC_TIMECODE = 0x26,
  SYNC_FAULT = 0x7f
} sync_type;

// Bits of sync_hello.capabilities: what this board has wired and this image drives.
enum {
  SYNC_CAN_TRIGGER = 1 << 0,
  SYNC_CAN_STROBE = 1 << 1,
  SYNC_CAN_REFERENCE = 1 << 2,  // PPS or genlock input
  SYNC_CAN_TIMECODE = 1 << 3,
  SYNC_CAN_PHOTODIODE = 1 << 4,
  SYNC_CAN_IMU = 1 << 5,
  SYNC_CAN_TEMPERATURE = 1 << 6,
  SYNC_CAN_BUTTON = 1 << 7,
  SYNC_CAN_CAMERA_POWER = 1 << 8,
  SYNC_CAN_STORE = 1 << 9,   // settings in flash
  SYNC_CAN_UPDATE = 1 << 10  // and a verifier: without one no image is ever accepted
};

typedef struct {
  uint32_t schema_hash;
  uint32_t capabilities;
  uint8_t version[3];  // of the firmware: major, minor, patch
  uint8_t slot;        // which of the two images runs
  uint32_t tick_hz;    // nominal rate of the timer that stamps edges
  uint32_t serial[3];  // the chip's own number
} sync_hello;

typedef struct {
  uint64_t t_host_ns;  // t1: the host's clock, whichever it likes; comes back as it was
} sync_ping;

typedef struct {
  uint64_t t_host_ns;            // t1
  uint64_t t_received_board_ns;  // t2: when the frame's last byte was taken in
  uint64_t t_sent_board_ns;      // t3: when the answer was handed to the link; t4 is the host's
} sync_pong;

typedef enum {
  SYNC_REFERENCE_NONE = 0,
  SYNC_REFERENCE_PULSE = 1,
  SYNC_REFERENCE_TIMECODE = 2
} sync_reference;

// Limits: firmware/core/settings.c. A refused value is answered with FAULT naming field and range.
typedef struct {
  uint32_t rate_numerator;  // triggers a second are numerator / denominator, exactly; 1 to 1000
  uint32_t rate_denominator;
  int32_t phase_ns;   // trigger after the reference's edge (negative: before)
  uint32_t pulse_ns;  // length of the trigger pulse
  uint8_t trigger_on;
  uint8_t reference;             // sync_reference
  uint32_t reference_numerator;  // edges (timecode: frames) a second; PPS is 1/1
  uint32_t reference_denominator;
  uint32_t strobe_window_ns;  // a strobe rises at most so long after its trigger
  uint8_t strobe_active_low;
  uint32_t exposure_ns;         // what the camera was told: the flicker advice starts from it
  uint32_t photodiode_dark;     // ADC codes × 16 in darkness
  uint32_t photodiode_ulx;      // microlux a code
  uint32_t heartbeat_ms;        // host silent for so long: safe defaults; 0: never
  uint8_t camera_on;            // power
  uint32_t camera_watchdog_ms;  // triggers unanswered for so long: power cycle; 0: never
  uint32_t camera_off_ms;       // length of that power cycle's pause
  uint8_t store;                // CONFIGURE: keep in flash. CONFIGURATION: it is in flash
} sync_configuration;

typedef enum {
  SYNC_LOCK_FREE = 0,       // no reference set
  SYNC_LOCK_ACQUIRING = 1,  // reference set, not yet followed
  SYNC_LOCK_LOCKED = 2,
  SYNC_LOCK_HOLDOVER = 3  // reference lost: its last known rate goes on
} sync_lock;

typedef struct {
  uint64_t t_board_ns;
  uint8_t lock;                  // sync_lock
  int32_t phase_error_ns;        // last edge less its prediction
  uint32_t phase_rms_ns;         // of such errors, over about the last 16 edges
  int32_t frequency_ppb;         // reference against the board's clock: positive, the reference is faster
  uint32_t holdover_s;           // since the reference's last edge
  uint32_t triggers;             // pulses sent
  uint32_t late_triggers;        // programmed after their time had come, and so left out
  uint32_t strobes;              // paired with a trigger
  uint32_t unanswered_triggers;  // triggers without a strobe
  uint32_t stray_strobes;        // strobes without a trigger
  uint32_t double_edges;         // edges of a strobe that had been seen already
  uint32_t reference_edges;      // taken
  uint32_t refused_edges;        // too far from where the reference must be
  uint32_t overruns;             // captures, samples or bytes lost because nobody fetched them in time
  uint32_t link_good;            // frames received
  uint32_t link_damaged;         // frames refused: COBS, size or CRC
  uint32_t link_dropped;         // frames not sent for want of room
  uint32_t power_cycles;         // of the camera, by the watchdog
  uint8_t camera_on;
  uint8_t safe;  // 1: the host fell silent and safe defaults rule
} sync_status;

typedef enum {
  SYNC_HOST_IDLE = 0,
  SYNC_HOST_LIVE = 1,
  SYNC_HOST_RECORDING = 2,
  SYNC_HOST_TROUBLE = 3
} sync_host;

typedef struct {
  uint8_t state;  // sync_host; while recording, updates are refused
} sync_host_state;

enum {
  SYNC_TRIGGER_LOCKED = 1 << 0,  // follows the reference
  SYNC_TRIGGER_HOLDOVER = 1 << 1,
  SYNC_TRIGGER_SLEWING = 1 << 2,  // on its way to the phase asked for
  SYNC_TRIGGER_SKIPPED = 1 << 3   // some before this one were left out: late
};

typedef struct {
  uint32_t n;           // counts from 0 at the board's start; wraps
  uint64_t t_board_ns;  // the pulse's leading edge, as the timer made it
  int32_t phase_ns;     // that edge less where reference and phase setting wanted it
  uint16_t flags;
} sync_trigger;

enum {
  SYNC_STROBE_PAIRED = 1 << 0,   // n is valid
  SYNC_STROBE_NO_FALL = 1 << 1,  // the end was not seen: t_fall_board_ns is 0
  SYNC_STROBE_DOUBLE = 1 << 2    // edges too many within it: the first rise and last fall count
};

typedef struct {
  uint32_t n;  // the trigger it answers
  uint64_t t_rise_board_ns;
  uint64_t t_fall_board_ns;
  uint8_t flags;
} sync_strobe;

enum { SYNC_MAX_FREQUENCIES = 4 };
enum {
  SYNC_PHOTODIODE_CLIPPED = 1 << 0,  // samples at the converter's end: level is a lower bound, depths unsure
  SYNC_PHOTODIODE_ADVICE = 1 << 1    // rate and exposure are valid
};

typedef struct {
  uint64_t t_board_ns;  // end of what was measured
  uint32_t span_us;     // its length
  uint32_t level_mlx;   // mean illuminance, millilux
  uint8_t flags;
  uint8_t frequencies;                           // how many of the following, strongest first
  uint32_t frequency_mhz[SYNC_MAX_FREQUENCIES];  // millihertz
  uint32_t depth_ppm[SYNC_MAX_FREQUENCIES];      // amplitude of that frequency over the mean
  uint32_t rate_mhz;                             // advice: the trigger rate and
  uint32_t exposure_ns;                          // exposure nearest to those set that do not beat
  uint32_t beat_ppm;                             // what still beats with them
} sync_photodiode;

enum { SYNC_IMU_STEADY = 1 << 0 };  // at rest: gravity is trustworthy, the gyroscope's bias is being learned

typedef struct {
  uint64_t t_board_ns;
  int32_t up_um_s2[3];     // the zenith as an accelerometer at rest reads it, board axes, µm/s²
  int32_t rate_urad_s[3];  // less the learned bias
  uint8_t flags;
} sync_imu;

enum { SYNC_SENSOR_BOARD = 0, SYNC_SENSOR_CAMERA = 1 };

typedef struct {
  uint64_t t_board_ns;
  uint8_t sensor;
  int32_t temperature_mc;  // thousandths of a degree Celsius
} sync_temperature;

typedef enum { SYNC_BUTTON_SHORT = 1, SYNC_BUTTON_LONG = 2 } sync_press;

typedef struct {
  uint64_t t_board_ns;  // when it was pressed
  uint8_t press;        // sync_press: SHORT on release, LONG while still held
} sync_button;

enum { SYNC_TIMECODE_DROP_FRAME = 1 << 0, SYNC_TIMECODE_COLOUR_FRAME = 1 << 1 };

typedef struct {
  uint64_t t_board_ns;  // start of the frame that it names
  uint8_t hours, minutes, seconds, frames;
  uint8_t flags;
  uint32_t user_bits;
} sync_timecode;

typedef enum {
  SYNC_FAULT_UNKNOWN_TYPE = 1,
  SYNC_FAULT_PAYLOAD_SIZE = 2,
  SYNC_FAULT_VERSION = 3,
  SYNC_FAULT_RANGE = 4,       // field and its range
  SYNC_FAULT_RECORDING = 5,   // not while recording
  SYNC_FAULT_FLASH = 6,       // write or erase failed
  SYNC_FAULT_SEQUENCE = 7,    // an update step out of order; minimum = maximum = the offset awaited
  SYNC_FAULT_SIGNATURE = 8,   // the image is not ours; or this board has no verifier
  SYNC_FAULT_UNSUPPORTED = 9  // not wired or not built in
} sync_fault_code;

typedef struct {
  uint8_t code;   // sync_fault_code
  uint8_t type;   // of the message it answers
  uint8_t field;  // index into that message's fields (sync_fields); names the value refused
  int64_t minimum, maximum;
} sync_fault;

typedef struct {
  uint32_t size;  // bytes of the image
  uint8_t version[3];
} sync_update_begin;

enum { SYNC_UPDATE_BLOCK_BYTES = 128 };

typedef struct {
  uint32_t offset;  // a multiple of SYNC_UPDATE_BLOCK_BYTES, in order; a repeat of the last one is welcome
  uint8_t bytes[SYNC_UPDATE_BLOCK_BYTES];  // beyond the image's size: 0xFF
} sync_update_block;

enum { SYNC_SIGNATURE_BYTES = 64 };

typedef struct {
  uint8_t signature[SYNC_SIGNATURE_BYTES];
} sync_update_finish;

typedef enum {
  SYNC_UPDATE_NONE = 0,
  SYNC_UPDATE_RECEIVING = 1,  // next_offset is awaited
  SYNC_UPDATE_PENDING = 2     // verified; the next start tries it
} sync_update_step;

typedef struct {
  uint8_t step;  // sync_update_step
  uint32_t next_offset;
} sync_update_state;

// One message of any type.
typedef struct {
  uint8_t type;  // sync_type
  union {
    sync_hello hello;
    sync_ping ping;
    sync_pong pong;
    sync_configuration configuration;  // CONFIGURE too
    sync_status status;
    sync_host_state host_state;
    sync_trigger trigger;
    sync_strobe strobe;
    sync_photodiode photodiode;
    sync_imu imu;
    sync_temperature temperature;
    sync_button button;
    sync_timecode timecode;
    sync_fault fault;
    sync_update_begin update_begin;
    sync_update_block update_block;
    sync_update_finish update_finish;
    sync_update_state update_state;
  };
} sync_message;

typedef enum { SYNC_U8, SYNC_U16, SYNC_U32, SYNC_U64, SYNC_I32, SYNC_I64 } sync_kind;

// How one field travels.
typedef struct {
  const char* name;
  uint16_t offset;  // in sync_message
  uint8_t kind;     // sync_kind
  uint8_t count;    // 1, or the length of an array
} sync_field;

typedef struct {
  const sync_field* fields;
  size_t count;
} sync_field_list;

// Fields of a message, in wire order. False: no such type.
bool sync_fields(uint8_t type, sync_field_list* list);

// Payload size of a type; SIZE_MAX: no such type.
size_t sync_payload_size(uint8_t type);

// Writes message's payload (SYNC_MAX_PAYLOAD bytes at most); returns its size, SIZE_MAX if there is no such type.
size_t sync_pack(const sync_message* message, uint8_t* payload);

// Reads a payload. False, and message untouched: no such type, or another size than the type has.
bool sync_unpack(uint8_t type, const uint8_t* payload, size_t size, sync_message* message);

// What SYNC_SCHEMA_HASH must be.
uint32_t sync_schema_hash(void);

#ifdef __cplusplus
}
#endif
