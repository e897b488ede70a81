// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

// Speed against error, with peers in the same run. A suite is one function that returns rows;
// bench/suites.cpp lists them. Numbers are for people and for bench/results/; no test asserts them.
namespace lightwell::bench {

struct Options {
  double seconds_per_case = 1;  // time spent on each case, at least Turns::least_runs
  std::string
      data_folder;  // reference data that is not part of the project; empty: what needs it is left out
  std::string peers_folder;       // scripts of peers in Python (bench/peers); empty: left out
  std::string references_folder;  // stored references (bench/references); empty: traced anew, coarser
  std::string only_setting;       // coherence, render: only settings whose name contains this; empty: all
  std::string only_name;          // coherence: only rows whose name contains this; empty: all
  int lights = 64;                // coherence: lights of each set
};

// How cases take turns.
struct Turns {
  std::size_t in_a_row = 5;  // after a run that warms up and is not counted
  std::size_t least_runs = 20;
};

struct Timing {
  double p10_ms = 0;  // NaN where a suite does not keep it
  double p50_ms = 0;
  double p99_ms = 0;
  std::size_t runs = 0;
};

// One measured thing. Values stand beside the time, named with their unit: {"max_relative_error", 4e-4}.
struct Row {
  std::string setting;  // what cases are compared in: "2048x2048"
  std::string name;     // "Lightwell avx2"
  Timing timing;
  std::vector<std::pair<std::string, double>> values;
};

// Something to time: called with 0, 1, 2 … so that it can take another input each time.
struct Case {
  std::string name;
  std::function<void(std::size_t)> run;
  std::vector<std::pair<std::string, double>> values;
};

// Times cases in turns, so that what else the machine does falls on all of them alike. With a baseline (the
// first case's name), every row gets `ratio_of_p50_to_<baseline>`.
std::vector<Row> time_in_turns(const std::string& setting, std::vector<Case> cases, const Options& options,
                               const std::string& baseline = "", const Turns& turns = {});

// Percentiles of times in ms, at least one.
Timing timing_of(std::vector<double> ms);

// A plot: <name>.svg.
struct Figure {
  std::string name;
  std::string svg;
};

struct Suite {
  std::string name;
  std::vector<Row> (*run)(const Options&);
  // Plots of its rows; null: one of bars (to_svg).
  std::vector<Figure> (*figures)(const std::vector<Row>&) = nullptr;
};
const std::vector<Suite>& suites();

std::vector<Row> frame_suite(const Options& options);
std::vector<Row> fit_suite(const Options& options);
std::vector<Figure> fit_figures(const std::vector<Row>& rows);
std::vector<Row> field_suite(const Options& options);
std::vector<Row> luminaire_suite(const Options& options);
std::vector<Figure> luminaire_figures(const std::vector<Row>& rows);
std::vector<Row> lens_suite(const Options& options);
std::vector<Row> response_suite(const Options& options);
std::vector<Row> sync_suite(const Options& options);

// CPU, compiler, flags, commit, date and all rows: schema "lightwell.bench/1".
std::string to_json(const std::vector<std::pair<std::string, std::vector<Row>>>& results);
// Bars of the medians, one group a setting, with the first value of each row beside it.
std::string to_svg(const std::string& suite, const std::vector<Row>& rows);
// A table for the terminal.
std::string to_text(const std::string& suite, const std::vector<Row>& rows);

}  // namespace lightwell::bench
