// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ltc.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace lightwell::test {

struct LtcSignal {
  std::vector<double> edges;   // seconds
  std::vector<double> starts;  // of the frames, seconds
  std::vector<SMPTETimecode> codes;
};

// Frames as libltc, an independent encoder, makes them, at 192 kHz; speed 1 is as it says.
inline LtcSignal encode_ltc(double fps, SMPTETimecode first, int frames, double speed = 1) {
  constexpr double kRate = 192'000;
  const bool drop = std::abs(fps - 30000.0 / 1001) < 1e-6;
  LTCEncoder* encoder = ltc_encoder_create(kRate, fps,
                                           fps == 25   ? LTC_TV_625_50
                                           : fps == 24 ? LTC_TV_FILM_24
                                                       : LTC_TV_525_60,
                                           LTC_USE_DATE);
  ltc_encoder_set_filter(encoder, 0);  // square
  ltc_encoder_set_timecode(encoder, &first);
  ltc_encoder_set_user_bits(encoder, 0x12345678);
  if (drop) {
    LTCFrame frame;
    ltc_encoder_get_frame(encoder, &frame);
    frame.dfbit = 1;
    ltc_encoder_set_frame(encoder, &frame);
  }
  LtcSignal signal;
  std::vector<ltcsnd_sample_t> buffer(ltc_encoder_get_buffersize(encoder));
  std::size_t at = 0;
  int level = -1;
  for (int i = 0; i < frames; ++i) {
    SMPTETimecode code;
    ltc_encoder_get_timecode(encoder, &code);
    signal.codes.push_back(code);
    signal.starts.push_back(static_cast<double>(at) / kRate / speed);
    ltc_encoder_encode_frame(encoder);
    const int count = ltc_encoder_copy_buffer(encoder, buffer.data());
    for (int k = 0; k < count; ++k, ++at) {
      const int now = buffer[static_cast<std::size_t>(k)] > 128;
      if (now != level) signal.edges.push_back(static_cast<double>(at) / kRate / speed);
      level = now;
    }
    ltc_encoder_inc_timecode(encoder);
  }
  ltc_encoder_free(encoder);
  return signal;
}

}  // namespace lightwell::test
