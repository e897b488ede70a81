// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/flicker.h"

#include "firmware/core/real.h"

static const float kLowestHz = 80.0f;
static const float kHighestHz = 2000.0f;
// Of a mean of eight half overlapping windows' power, noise is above 5 × its mean less than once in 10^7 bins.
static const float kOutOfNoise = 5.0f;
static const float kLeastDepth = 0.0005f;  // what no camera of ours can tell from none
enum { kFloorPasses = 5, kGrid = 50, kSkirt = 12, kRefinements = 12 };

static void restart(flicker* self) {
  self->block = 0;
  self->candidates = 0;
  self->clipped = false;
  self->sum = 0.0f;
  for (unsigned i = 0; i < (unsigned)FLICKER_BINS; ++i) self->power[i] = 0.0f;
}

void flicker_init(flicker* self, float sample_hz, float dark, uint16_t highest) {
  self->sample_hz = sample_hz;
  self->dark = dark;
  self->highest = highest;
  self->filled = 0;
  restart(self);
}

// Windowed (Hann) and without its mean, which would leak into the lowest bins.
static void transform_block(flicker* self) {
  float mean = 0.0f;
  for (unsigned i = 0; i < (unsigned)FOURIER_SIZE; ++i) {
    if (self->samples[i] >= self->highest) self->clipped = true;
    mean += (float)self->samples[i];
  }
  mean /= (float)FOURIER_SIZE;
  self->sum += mean - self->dark;
  for (unsigned i = 0; i < (unsigned)FOURIER_SIZE; ++i) {
    float sine;
    float cosine;
    turn_sine_cosine((float)i / (float)FOURIER_SIZE, &sine, &cosine);
    self->work[i] = ((float)self->samples[i] - mean) * 0.5f * (1.0f - cosine);
  }
  fourier_transform(self->work);
}

static unsigned bin_of(const flicker* self, float hz) {
  return (unsigned)(hz * (float)FOURIER_SIZE / self->sample_hz);
}

// Mean power of the bins that no tone is in: what is far above the mean is left out, a few times over.
static float noise_floor(const flicker* self, unsigned first, unsigned last) {
  float limit = 3.4e38f;
  float floor = 0.0f;
  for (unsigned pass = 0; pass < (unsigned)kFloorPasses; ++pass) {
    float sum = 0.0f;
    unsigned count = 0;
    for (unsigned i = first; i <= last; ++i) {
      if (self->power[i] <= limit) {
        sum += self->power[i];
        ++count;
      }
    }
    floor = count > 0u ? sum / (float)count : 0.0f;
    limit = 3.0f * floor;
  }
  return floor;
}

// The Hann window's transform, offset bins off its centre, over that at its centre.
static float window_gain(float offset) {
  const float rest = 1.0f - offset * offset;
  return real_magnitude(rest) < 1e-3f ? 0.5f : normalized_sinc(offset) / rest;
}

// Takes a tone's own power, and three tenths more for what this model of it errs, out of the bins around it, so that a
// weaker lamp beside a strong one shows: 120 Hz beside 100.
static void take_out(flicker* self, unsigned bin) {
  // Amplitudes at offset and 1 - offset of a Hann window are as (1 + offset) to (2 - offset).
  const bool above = self->power[bin + 1u] > self->power[bin - 1u];
  const float ratio = real_root(self->power[above ? bin + 1u : bin - 1u] / self->power[bin]);
  const float offset = (2.0f * ratio - 1.0f) / (ratio + 1.0f) * (above ? 1.0f : -1.0f);
  const float peak = self->power[bin] / (window_gain(offset) * window_gain(offset));
  for (unsigned i = bin > (unsigned)kSkirt ? bin - (unsigned)kSkirt : 0u;
       i <= bin + (unsigned)kSkirt && i < (unsigned)FLICKER_BINS; ++i) {
    const float gain = window_gain((float)i - (float)bin - offset);
    const float rest = self->power[i] - 1.3f * peak * gain * gain;
    self->power[i] = rest > 0.0f ? rest : 0.0f;
  }
}

// The strongest bins that stand out, no two of one tone.
static void find_candidates(flicker* self) {
  const unsigned first = bin_of(self, kLowestHz) - 1u;
  const unsigned last = bin_of(self, kHighestHz) + 2u;
  const float floor = noise_floor(self, first, last);
  // A tone of the least depth: amplitude · 1024 / 4 in its bin, a Hann window's gain being a half.
  const float amplitude = kLeastDepth * self->sum / (float)FLICKER_SEARCH_BLOCKS * (float)FOURIER_SIZE / 4.0f;
  const float least = amplitude * amplitude * (float)FLICKER_SEARCH_BLOCKS;
  const float threshold = kOutOfNoise * floor > least ? kOutOfNoise * floor : least;
  while (self->candidates < (unsigned)FLICKER_TONES) {
    unsigned best = 0;
    for (unsigned i = first; i <= last; ++i) {
      if (self->power[i] <= threshold || self->power[i] < self->power[i - 1u] ||
          self->power[i] < self->power[i + 1u])
        continue;
      bool taken = false;
      for (unsigned k = 0; k < self->candidates; ++k)
        taken = taken || (i + 1u >= self->bin[k] && i <= self->bin[k] + 1u);
      if (!taken && (best == 0u || self->power[i] > self->power[best])) best = i;
    }
    if (best == 0u) return;
    self->bin[self->candidates++] = (uint16_t)best;
    take_out(self, best);
  }
}

// |sum of the tone's values turned back by offset bins|, over their number. A hop is half a window, so a bin's centre
// turns half a turn a hop.
static float coherence(const flicker* self, unsigned tone, float offset) {
  float step_sine;
  float step_cosine;
  turn_sine_cosine(-0.5f * ((float)(self->bin[tone] & 1u) + offset), &step_sine, &step_cosine);
  float turn_real = 1.0f;
  float turn_imaginary = 0.0f;
  float sum_real = 0.0f;
  float sum_imaginary = 0.0f;
  for (unsigned i = 0; i < (unsigned)FLICKER_PHASE_BLOCKS; ++i) {
    sum_real += self->real[tone][i] * turn_real - self->imaginary[tone][i] * turn_imaginary;
    sum_imaginary += self->real[tone][i] * turn_imaginary + self->imaginary[tone][i] * turn_real;
    const float real = turn_real * step_cosine - turn_imaginary * step_sine;
    turn_imaginary = turn_real * step_sine + turn_imaginary * step_cosine;
    turn_real = real;
  }
  return real_root(sum_real * sum_real + sum_imaginary * sum_imaginary) / (float)FLICKER_PHASE_BLOCKS;
}

// Offset in bins at which the tone's values agree best: a grid finer than a lobe (1/11 bin), then by thirds.
static float best_offset(const flicker* self, unsigned tone) {
  const float step = 1.5f / (float)kGrid;
  float best = 0.0f;
  float most = -1.0f;
  for (unsigned i = 0; i <= (unsigned)kGrid; ++i) {
    const float offset = -0.75f + step * (float)i;
    const float value = coherence(self, tone, offset);
    if (value > most) {
      most = value;
      best = offset;
    }
  }
  float low = best - step;
  float high = best + step;
  for (unsigned i = 0; i < (unsigned)kRefinements; ++i) {
    const float third = (high - low) / 3.0f;
    if (coherence(self, tone, low + third) < coherence(self, tone, high - third))
      low += third;
    else
      high -= third;
  }
  return 0.5f * (low + high);
}

static void insert(flicker_result* result, flicker_tone tone) {
  unsigned at = result->tones++;
  for (; at > 0u && result->tone[at - 1u].depth < tone.depth; --at) result->tone[at] = result->tone[at - 1u];
  result->tone[at] = tone;
}

static void conclude(const flicker* self, flicker_result* result) {
  result->level = self->sum / (float)(FLICKER_SEARCH_BLOCKS + FLICKER_PHASE_BLOCKS);
  result->clipped = self->clipped;
  result->tones = 0;
  for (unsigned k = 0; k < self->candidates; ++k) {
    const float offset = best_offset(self, k);
    const float amplitude = coherence(self, k, offset) * 4.0f / ((float)FOURIER_SIZE * window_gain(offset));
    const flicker_tone tone = {((float)self->bin[k] + offset) * self->sample_hz / (float)FOURIER_SIZE,
                               amplitude / result->level};
    if (tone.hz >= kLowestHz && tone.hz <= kHighestHz && tone.depth >= kLeastDepth) insert(result, tone);
  }
}

static bool end_block(flicker* self, flicker_result* result) {
  transform_block(self);
  if (self->block < (unsigned)FLICKER_SEARCH_BLOCKS) {
    for (unsigned i = 1; i < (unsigned)FLICKER_BINS; ++i)
      self->power[i] +=
          self->work[2u * i] * self->work[2u * i] + self->work[2u * i + 1u] * self->work[2u * i + 1u];
    if (++self->block == (unsigned)FLICKER_SEARCH_BLOCKS && self->sum > 0.0f) find_candidates(self);
    return false;
  }
  const unsigned at = self->block - (unsigned)FLICKER_SEARCH_BLOCKS;
  for (unsigned k = 0; k < self->candidates; ++k) {
    self->real[k][at] = self->work[2u * self->bin[k]];
    self->imaginary[k][at] = self->work[2u * self->bin[k] + 1u];
  }
  if (++self->block < (unsigned)(FLICKER_SEARCH_BLOCKS + FLICKER_PHASE_BLOCKS)) return false;
  conclude(self, result);
  restart(self);
  return true;
}

bool flicker_sample(flicker* self, uint16_t code, flicker_result* result) {
  self->samples[self->filled++] = code;
  if (self->filled < (unsigned)FOURIER_SIZE) return false;
  const bool done = end_block(self, result);
  for (unsigned i = 0; i < (unsigned)FLICKER_HOP; ++i)
    self->samples[i] = self->samples[i + (unsigned)FLICKER_HOP];
  self->filled = FLICKER_HOP;
  return done;
}
