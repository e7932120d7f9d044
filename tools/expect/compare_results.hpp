// SPDX-License-Identifier: Apache-2.0
/// Where results differ from what was expected, and by more than was allowed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/config.hpp"
#include "core/base/time.hpp"
#include "tools/expect/results.hpp"

namespace strata::expect {

/// Beside the expected results: what may differ, and by how much.
inline constexpr const char* kTolerancesFile = "tolerances.yaml";

/// More room for some values.
struct ToleranceRule {
  std::string match;
  double absolute = 0.0;
  double relative = 0.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("match", c.match,
            {.doc = "NAME:FIELD with * and ?, as trajectory.tum:* or /amcl_pose:pose.pose.*"});
    v.require(!c.match.empty(), "match", "is missing", "name values, as match: trajectory.tum:*");
    v.field("absolute", c.absolute, {.doc = "may differ by this", .min = 0.0});
    v.field("relative", c.relative,
            {.doc = "... or by this share of the expected value", .min = 0.0});
  }
};

/// A value may differ by absolute + relative * |expected|; the last rule that matches holds.
/// Replays are exact, so the default is no difference at all, but for what clocks say.
struct Tolerances {
  double absolute = 0.0;
  double relative = 0.0;
  std::vector<ToleranceRule> rules;
  std::vector<std::string> ignore = {"*.json:cost*", "*summary.json:log",
                                     "*localization_health:update_time"};
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("absolute", c.absolute, {.doc = "every value may differ by this", .min = 0.0});
    v.field("relative", c.relative,
            {.doc = "... and by this share of the expected value", .min = 0.0});
    v.list("rules", c.rules, "values with tolerances of their own; the last match holds");
    v.field("ignore", c.ignore, {.doc = "NAME:FIELD patterns that are not compared"});
  }
};

/// The first difference in one file or topic.
struct Difference {
  std::string name;            ///< of the file or topic
  std::optional<Stamp> stamp;  ///< of the line or message
  std::string field;
  std::string problem;        ///< "is 1.25, expected 1.2 (tolerance 0.01)"
  std::size_t differing = 0;  ///< entries of this file or topic that differ
  std::size_t entries = 0;    ///< of what was expected
};

/// One a file or topic that differs, the earliest first, those without time last. Empty: all is as
/// expected. What only `got` has is no difference. Messages of one topic and stamp are compared in
/// the order of their bytes, since writers in several processes have no order among themselves.
[[nodiscard]] std::vector<Difference> compare_results(Results expected, Results got,
                                                      const Tolerances& tolerances);

/// "trajectory.tum at 12.300000000 s: x is 1.25, expected 1.2 (tolerance 0.01); 14 of 213 differ".
[[nodiscard]] std::string describe(const Difference& difference);

/// tolerances.yaml of a folder of expected results; the defaults without one. Throws ConfigError.
[[nodiscard]] Tolerances load_tolerances(const std::filesystem::path& folder);

/// Replaces what is expected by `results`: the comparable files and the recorded topics, not
/// strata.db. An existing tolerances.yaml stays; in a new folder the defaults are written. Throws
/// OutputError, also for a folder that has things in it but no tolerances.yaml, so that a mistyped
/// path wipes nothing.
void accept_results(const std::filesystem::path& results, const std::filesystem::path& expected);

}  // namespace strata::expect
