// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/pictures/judged_scenes.h"
#include "bench/suite.h"
#include "render/renderer.h"

// `lightwell bench --suite render`: error against time, growth, steadiness; its parts and what they share.
namespace lightwell::bench {

std::vector<Row> render_suite(const Options& options);
std::vector<Figure> render_figures(const std::vector<Row>& rows);

// Cost against lights, triangles and pixels.
std::vector<Row> render_growth_rows(const Options& options);
// How much a picture changes from frame to frame beyond what the light makes it.
std::vector<Row> render_steadiness_rows(const Options& options);
// The error on each glossy object beside that on the same object made matte.
std::vector<Row> render_gloss_rows();
// A light field against harmonics that are the same everywhere.
std::vector<Row> render_field_rows(const Options& options);
// A lamp nearby, every position and fewer, against rays to each.
std::vector<Row> render_lamp_rows(const Options& options);
// Mitsuba 3 on the same scenes, by the script in options.peers_folder.
std::vector<Row> mitsuba_rows(const std::vector<pictures::JudgedPicture>& judged, const Options& options);

// Processor time of the whole program, a driver's threads included.
double process_cpu_ms();

// Runs a frame once to warm up, then for the seconds a case has, at least three times: wall times, and the median of
// processor time as the row's first value, cpu_ms.
Row timed_frames(const std::string& setting, const std::string& name, const Options& options,
                 const std::function<void(std::size_t)>& frame);

// relative_rmse, flip and bias as values of a row.
void add_error(Row& row, const pictures::PictureError& error);
double value_of(const Row& row, const std::string& name);  // NaN: not there

// A renderer of a scene; says why on stderr where there is none.
std::optional<render::Renderer> renderer_of(const render::Scene& scene,
                                            const render::RendererOptions& options);
// The same at its defaults, at the judged size.
std::optional<render::Renderer> renderer_of(const render::Scene& scene, int shadow_size,
                                            int width = pictures::kPictureWidth,
                                            int height = pictures::kPictureHeight);

}  // namespace lightwell::bench
