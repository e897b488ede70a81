// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/sync_protocol.h"

// One table a message says how it travels, once for both directions. Members are read and written as what they
// are; no struct is ever laid over the wire.
#define FIELD(member, name, kind, count) \
  { #name, (uint16_t)offsetof(sync_message, member.name), kind, count }

static const sync_field kHello[] = {
    FIELD(hello, schema_hash, SYNC_U32, 1), FIELD(hello, capabilities, SYNC_U32, 1),
    FIELD(hello, version, SYNC_U8, 3),      FIELD(hello, slot, SYNC_U8, 1),
    FIELD(hello, tick_hz, SYNC_U32, 1),     FIELD(hello, serial, SYNC_U32, 3),
};

static const sync_field kPing[] = {FIELD(ping, t_host_ns, SYNC_U64, 1)};

static const sync_field kPong[] = {
    FIELD(pong, t_host_ns, SYNC_U64, 1),
    FIELD(pong, t_received_board_ns, SYNC_U64, 1),
    FIELD(pong, t_sent_board_ns, SYNC_U64, 1),
};

static const sync_field kConfiguration[] = {
    FIELD(configuration, rate_numerator, SYNC_U32, 1),
    FIELD(configuration, rate_denominator, SYNC_U32, 1),
    FIELD(configuration, phase_ns, SYNC_I32, 1),
    FIELD(configuration, pulse_ns, SYNC_U32, 1),
    FIELD(configuration, trigger_on, SYNC_U8, 1),
    FIELD(configuration, reference, SYNC_U8, 1),
    FIELD(configuration, reference_numerator, SYNC_U32, 1),
    FIELD(configuration, reference_denominator, SYNC_U32, 1),
    FIELD(configuration, strobe_window_ns, SYNC_U32, 1),
    FIELD(configuration, strobe_active_low, SYNC_U8, 1),
    FIELD(configuration, exposure_ns, SYNC_U32, 1),
    FIELD(configuration, photodiode_dark, SYNC_U32, 1),
    FIELD(configuration, photodiode_ulx, SYNC_U32, 1),
    FIELD(configuration, heartbeat_ms, SYNC_U32, 1),
    FIELD(configuration, camera_on, SYNC_U8, 1),
    FIELD(configuration, camera_watchdog_ms, SYNC_U32, 1),
    FIELD(configuration, camera_off_ms, SYNC_U32, 1),
    FIELD(configuration, store, SYNC_U8, 1),
};

static const sync_field kStatus[] = {
    FIELD(status, t_board_ns, SYNC_U64, 1),
    FIELD(status, lock, SYNC_U8, 1),
    FIELD(status, phase_error_ns, SYNC_I32, 1),
    FIELD(status, phase_rms_ns, SYNC_U32, 1),
    FIELD(status, frequency_ppb, SYNC_I32, 1),
    FIELD(status, holdover_s, SYNC_U32, 1),
    FIELD(status, triggers, SYNC_U32, 1),
    FIELD(status, late_triggers, SYNC_U32, 1),
    FIELD(status, strobes, SYNC_U32, 1),
    FIELD(status, unanswered_triggers, SYNC_U32, 1),
    FIELD(status, stray_strobes, SYNC_U32, 1),
    FIELD(status, double_edges, SYNC_U32, 1),
    FIELD(status, reference_edges, SYNC_U32, 1),
    FIELD(status, refused_edges, SYNC_U32, 1),
    FIELD(status, overruns, SYNC_U32, 1),
    FIELD(status, link_good, SYNC_U32, 1),
    FIELD(status, link_damaged, SYNC_U32, 1),
    FIELD(status, link_dropped, SYNC_U32, 1),
    FIELD(status, power_cycles, SYNC_U32, 1),
    FIELD(status, camera_on, SYNC_U8, 1),
    FIELD(status, safe, SYNC_U8, 1),
};

static const sync_field kHostState[] = {FIELD(host_state, state, SYNC_U8, 1)};

static const sync_field kTrigger[] = {
    FIELD(trigger, n, SYNC_U32, 1),
    FIELD(trigger, t_board_ns, SYNC_U64, 1),
    FIELD(trigger, phase_ns, SYNC_I32, 1),
    FIELD(trigger, flags, SYNC_U16, 1),
};

static const sync_field kStrobe[] = {
    FIELD(strobe, n, SYNC_U32, 1),
    FIELD(strobe, t_rise_board_ns, SYNC_U64, 1),
    FIELD(strobe, t_fall_board_ns, SYNC_U64, 1),
    FIELD(strobe, flags, SYNC_U8, 1),
};

static const sync_field kPhotodiode[] = {
    FIELD(photodiode, t_board_ns, SYNC_U64, 1),
    FIELD(photodiode, span_us, SYNC_U32, 1),
    FIELD(photodiode, level_mlx, SYNC_U32, 1),
    FIELD(photodiode, flags, SYNC_U8, 1),
    FIELD(photodiode, frequencies, SYNC_U8, 1),
    FIELD(photodiode, frequency_mhz, SYNC_U32, SYNC_MAX_FREQUENCIES),
    FIELD(photodiode, depth_ppm, SYNC_U32, SYNC_MAX_FREQUENCIES),
    FIELD(photodiode, rate_mhz, SYNC_U32, 1),
    FIELD(photodiode, exposure_ns, SYNC_U32, 1),
    FIELD(photodiode, beat_ppm, SYNC_U32, 1),
};

static const sync_field kImu[] = {
    FIELD(imu, t_board_ns, SYNC_U64, 1),
    FIELD(imu, up_um_s2, SYNC_I32, 3),
    FIELD(imu, rate_urad_s, SYNC_I32, 3),
    FIELD(imu, flags, SYNC_U8, 1),
};

static const sync_field kTemperature[] = {
    FIELD(temperature, t_board_ns, SYNC_U64, 1),
    FIELD(temperature, sensor, SYNC_U8, 1),
    FIELD(temperature, temperature_mc, SYNC_I32, 1),
};

static const sync_field kButton[] = {
    FIELD(button, t_board_ns, SYNC_U64, 1),
    FIELD(button, press, SYNC_U8, 1),
};

static const sync_field kTimecode[] = {
    FIELD(timecode, t_board_ns, SYNC_U64, 1), FIELD(timecode, hours, SYNC_U8, 1),
    FIELD(timecode, minutes, SYNC_U8, 1),     FIELD(timecode, seconds, SYNC_U8, 1),
    FIELD(timecode, frames, SYNC_U8, 1),      FIELD(timecode, flags, SYNC_U8, 1),
    FIELD(timecode, user_bits, SYNC_U32, 1),
};

static const sync_field kFault[] = {
    FIELD(fault, code, SYNC_U8, 1),     FIELD(fault, type, SYNC_U8, 1),     FIELD(fault, field, SYNC_U8, 1),
    FIELD(fault, minimum, SYNC_I64, 1), FIELD(fault, maximum, SYNC_I64, 1),
};

static const sync_field kUpdateBegin[] = {
    FIELD(update_begin, size, SYNC_U32, 1),
    FIELD(update_begin, version, SYNC_U8, 3),
};

static const sync_field kUpdateBlock[] = {
    FIELD(update_block, offset, SYNC_U32, 1),
    FIELD(update_block, bytes, SYNC_U8, SYNC_UPDATE_BLOCK_BYTES),
};

static const sync_field kUpdateFinish[] = {FIELD(update_finish, signature, SYNC_U8, SYNC_SIGNATURE_BYTES)};

static const sync_field kUpdateState[] = {
    FIELD(update_state, step, SYNC_U8, 1),
    FIELD(update_state, next_offset, SYNC_U32, 1),
};

typedef struct {
  uint8_t type;
  uint8_t count;
  const sync_field* fields;
} message_row;

#define ROW(type, fields) \
  { type, (uint8_t)(sizeof(fields) / sizeof((fields)[0])), fields }

static const message_row kMessages[] = {
    {SYNC_HELLO_REQUEST, 0, NULL},
    ROW(SYNC_HELLO, kHello),
    ROW(SYNC_PING, kPing),
    ROW(SYNC_PONG, kPong),
    ROW(SYNC_CONFIGURE, kConfiguration),
    ROW(SYNC_CONFIGURATION, kConfiguration),
    {SYNC_CONFIGURATION_REQUEST, 0, NULL},
    {SYNC_STATUS_REQUEST, 0, NULL},
    ROW(SYNC_STATUS, kStatus),
    ROW(SYNC_HOST_STATE, kHostState),
    ROW(SYNC_UPDATE_BEGIN, kUpdateBegin),
    ROW(SYNC_UPDATE_STATE, kUpdateState),
    ROW(SYNC_UPDATE_BLOCK, kUpdateBlock),
    ROW(SYNC_UPDATE_FINISH, kUpdateFinish),
    ROW(SYNC_TRIGGER, kTrigger),
    ROW(SYNC_STROBE, kStrobe),
    ROW(SYNC_PHOTODIODE, kPhotodiode),
    ROW(SYNC_IMU, kImu),
    ROW(SYNC_TEMPERATURE, kTemperature),
    ROW(SYNC_BUTTON, kButton),
    ROW(SYNC_TIMECODE, kTimecode),
    ROW(SYNC_FAULT, kFault),
};
enum { kMessageCount = sizeof kMessages / sizeof kMessages[0] };

static size_t kind_size(uint8_t kind) {
  switch (kind) {
    case SYNC_U8:
      return 1;
    case SYNC_U16:
      return 2;
    case SYNC_U32:
    case SYNC_I32:
      return 4;
    default:
      return 8;
  }
}

bool sync_fields(uint8_t type, sync_field_list* list) {
  for (size_t i = 0; i < (size_t)kMessageCount; ++i) {
    if (kMessages[i].type == type) {
      list->fields = kMessages[i].fields;
      list->count = kMessages[i].count;
      return true;
    }
  }
  return false;
}

size_t sync_payload_size(uint8_t type) {
  sync_field_list list;
  if (!sync_fields(type, &list)) return SIZE_MAX;
  size_t size = 0;
  for (size_t i = 0; i < list.count; ++i) size += kind_size(list.fields[i].kind) * list.fields[i].count;
  return size;
}

// The member at from, of size bytes.
static uint64_t load(const void* from, size_t size) {
  switch (size) {
    case 1:
      return *(const uint8_t*)from;
    case 2:
      return *(const uint16_t*)from;
    case 4:
      return *(const uint32_t*)from;  // an int32_t may be read so: C11 6.5 paragraph 7
    default:
      return *(const uint64_t*)from;
  }
}

static void store(uint64_t value, void* to, size_t size) {
  switch (size) {
    case 1:
      *(uint8_t*)to = (uint8_t)value;
      break;
    case 2:
      *(uint16_t*)to = (uint16_t)value;
      break;
    case 4:
      *(uint32_t*)to = (uint32_t)value;
      break;
    default:
      *(uint64_t*)to = value;
      break;
  }
}

size_t sync_pack(const sync_message* message, uint8_t* payload) {
  sync_field_list list;
  if (!sync_fields(message->type, &list)) return SIZE_MAX;
  size_t at = 0;
  for (size_t i = 0; i < list.count; ++i) {
    const size_t size = kind_size(list.fields[i].kind);
    const uint8_t* from = (const uint8_t*)message + list.fields[i].offset;
    for (size_t k = 0; k < list.fields[i].count; ++k) {
      const uint64_t value = load(from + k * size, size);
      for (size_t byte = 0; byte < size; ++byte) payload[at++] = (uint8_t)(value >> (8u * byte));
    }
  }
  return at;
}

bool sync_unpack(uint8_t type, const uint8_t* payload, size_t size, sync_message* message) {
  sync_field_list list;
  if (!sync_fields(type, &list) || size != sync_payload_size(type)) return false;
  message->type = type;
  for (size_t i = 0; i < list.count; ++i) {
    const size_t width = kind_size(list.fields[i].kind);
    uint8_t* to = (uint8_t*)message + list.fields[i].offset;
    for (size_t k = 0; k < list.fields[i].count; ++k) {
      uint64_t value = 0;
      for (size_t byte = 0; byte < width; ++byte) value |= (uint64_t)*payload++ << (8u * byte);
      store(value, to + k * width, width);
    }
  }
  return true;
}

static uint32_t fnv1a(uint32_t hash, uint8_t byte) {
  return (hash ^ byte) * 16777619u;
}

uint32_t sync_schema_hash(void) {
  uint32_t hash = 2166136261u;
  hash = fnv1a(hash, SYNC_PROTOCOL_VERSION);
  for (size_t i = 0; i < (size_t)kMessageCount; ++i) {
    hash = fnv1a(hash, kMessages[i].type);
    for (size_t k = 0; k < kMessages[i].count; ++k) {
      const sync_field* field = &kMessages[i].fields[k];
      for (const char* letter = field->name; *letter != '\0'; ++letter) hash = fnv1a(hash, (uint8_t)*letter);
      hash = fnv1a(hash, 0);
      hash = fnv1a(hash, field->kind);
      hash = fnv1a(hash, field->count);
    }
  }
  return hash;
}
