// SPDX-License-Identifier: Apache-2.0
/// How fast one time level of a node forgets (docs/theory/timescale_memory.md, "Levels").
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace strata::memory {

/// A level keeps at most N = `samples` ranges an angle bin, takes an observation in with
/// probability q and then replaces a random sample, so that a sample survives one observation with
/// probability 1 - u, u = q / N, and half of them live longer than
///     t = ln 2 / lambda observations, lambda = -ln(1 - u).
/// [kessler2010what, section 3] prints u = e^lambda - 1, which contradicts its own lambda; the
/// inverse is u = 1 - e^-lambda.
///
/// A slow level (`half_life_days` > 0) learns by days instead: what a node saw in a day is gathered
/// evenly, and at its end every sample makes way for one of that day with probability
/// 1 - 2^(-days / half_life_days). However long the robot stayed, a day is a day.
struct LevelConfig {
  std::string name;
  int samples = 20;
  /// In seconds of presence at a node; see TimescaleConfig::period_s.
  double half_life_s = 27.0;
  /// In days of the calendar; 0: half_life_s holds.
  double half_life_days = 0.0;

  friend bool operator==(const LevelConfig&, const LevelConfig&) = default;

  [[nodiscard]] bool learns_by_days() const { return half_life_days > 0.0; }
  /// Share of the samples that a day at the end of `days` replaces.
  [[nodiscard]] double replaced_after(double days) const {
    return -std::expm1(-std::numbers::ln2 * days / half_life_days);
  }
  /// For lists and pictures: seconds of presence, or of the calendar for a level that learns by
  /// days.
  [[nodiscard]] double nominal_half_life_s() const {
    return learns_by_days() ? 86400.0 * half_life_days : half_life_s;
  }

  /// u for this half-life when observations come every period_s.
  [[nodiscard]] double replacement_rate(double period_s) const {
    return -std::expm1(-std::numbers::ln2 * period_s / half_life_s);
  }
  /// q = u N; above 1 the half-life is out of reach.
  [[nodiscard]] double insertion_probability(double period_s) const {
    return replacement_rate(period_s) * samples;
  }

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("name", c.name, {.doc = "name of the level, e.g. in /expected_scan/NAME"});
    v.field("samples", c.samples,
            {.doc = "most range samples and most pairs an angle bin", .min = 1, .max = 10000});
    v.field("half_life_s", c.half_life_s,
            {.doc = "time at a node after which half of the samples are replaced",
             .unit = "s",
             .min = 1e-3});
    v.field("half_life_days", c.half_life_days,
            {.doc = "or: days of the calendar after which half of them are replaced; learns at the "
                    "end of each day; 0: half_life_s holds",
             .unit = "d",
             .min = 0.0});
    v.require(c.name != "mixture" && c.name != "frozen", "name",
              "is the name of another model of localization", "choose another");
    v.require(!c.name.empty(), "name", "is empty", "give the level a name");
  }
};

/// Half-life in observations of a set of `samples` that takes one in with probability q.
[[nodiscard]] inline double half_life_observations(int samples, double insertion_probability) {
  return std::numbers::ln2 / -std::log1p(-insertion_probability / samples);
}

}  // namespace strata::memory
