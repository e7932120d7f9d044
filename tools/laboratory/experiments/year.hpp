// SPDX-License-Identifier: Apache-2.0
/// A simulated year: does a memory that goes on learning from its own poses keep the robot
/// localized, and does it stay bounded?
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "memory/decoding/decoding_config.hpp"

namespace strata::experiments {

struct YearOptions {
  std::string scenario;
  std::uint64_t seed = 1;
  int days = 365;
  int particles = 150;  ///< always
  /// timescale: all levels, mixed; timescale_LEVEL: one.
  std::string memory_model = "timescale";
  memory::DecodingConfig decoding;     ///< of the memory's levels
  bool with_patches = true;            ///< false: without the robot with the patch map
  std::vector<std::string> overrides;  ///< key.path=value of the scenario
  std::filesystem::path out;           ///< strata.db of the memory is made there
};

/// One way of remembering on one day.
struct YearTrack {
  std::string name;
  double error_m = 0.0;  ///< mean over the scans
  double worst_m = 0.0;
  std::size_t scans = 0;
  std::size_t failures = 0;  ///< scans further than 0.5 m from the truth
  double cpu_s = 0.0;
};

struct YearDay {
  int day = 0;
  double path_m = 0.0;
  std::vector<YearTrack> tracks;
  std::size_t nodes = 0;
  double store_mb = 0.0;
  double rss_mb = 0.0;
  std::size_t submaps = 0;
  double patch_mb = 0.0;
  double wall_s = 0.0;
};

/// Day 1 is mapped at its true poses with errors of 2 cm and 0.3 degrees. From day 2 on three
/// robots with the same odometry, scans and particle filter start where the first stood, each on
/// its own, and are never helped: `frozen` in the beam-filtered map of day 1; `memory` in the time
/// levels, mixed, of a memory that takes in what it sees at its own poses, is saved as it runs and
/// decoded every ten seconds; `patches` in the patch map of an online learner fed in the same way,
/// taken over every night. `each_day` is called after each day. Two threads. Throws ConfigError,
/// OutputError.
void run_year(const YearOptions& options, const std::function<void(const YearDay&)>& each_day);

}  // namespace strata::experiments
