// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/suite.h"
#include "field/field_builder.h"

// Parts of the suite `field`.
namespace lightwell::bench {

FieldGrid unit_cube(int side);
// A row of one run, whose time stands in p50 and p99.
Row row_of_one_run(const std::string& setting, const std::string& name, double ms);

// A take whose pictures cost nothing to make, so that the time is that of the build, which does not depend on what they
// show: even ones, brighter along x.
ProbeTake even_take(std::size_t probes, int width, int height);

// A tenth of 2009's first scene from pictures to field: the paper's own pipeline on one thread beside ours on one and two.
std::vector<Row> pipeline_rows(const Options& options);
// Time and peak memory against probes, against grid points, and 2009's first scene whole where minutes are given for it.
std::vector<Row> field_growth_rows(const Options& options);
// The file's size against its error, and irradiance of degree 4 against exact integrals.
std::vector<Row> field_precision_rows();

// Bars, and curves of growth.
std::vector<Figure> field_figures(const std::vector<Row>& rows);

}  // namespace lightwell::bench
