// SPDX-License-Identifier: Apache-2.0
/// Whether maps may take the place of those that robots localize in (docs/site.md, "The gate").
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "core/base/config.hpp"
#include "core/base/progress.hpp"
#include "core/base/time.hpp"
#include "core/localization/localizer_config.hpp"
#include "tools/pipeline/map_fit.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/site/map_shift.hpp"

namespace strata::site {

/// What a candidate may lack.
struct GateLimits {
  double max_shift_m = 0.03;
  double max_turn_rad = 0.0035;
  double max_drift_m = 0.02;
  double min_common_walls = 0.5;
  double min_common_area = 0.8;
  double min_explained = 0.65;
  double max_explained_drop = 0.03;
  double max_contradicted_rise = 0.03;
  double max_new_contradicted = 0.5;
  double max_score_drop = 0.05;
  double max_lost_rise = 0.01;
  double max_error_rise_m = 0.02;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("max_shift_m", c.max_shift_m,
            {.doc = "so far the frame may lie from the active version's, in the middle of the map",
             .unit = "m",
             .min = 0.0});
    v.field("max_turn_rad", c.max_turn_rad,
            {.doc = "... and so far be turned against it", .unit = "rad", .min = 0.0});
    v.field("max_drift_m", c.max_drift_m,
            {.doc = "so far the frame may lie from the first version's that still has these walls, "
                    "over all updates",
             .unit = "m",
             .min = 0.0});
    v.field("min_common_walls", c.min_common_walls,
            {.doc = "least share of the active version's walls that the candidate has, where it "
                    "knows anything",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("min_common_area", c.min_common_area,
            {.doc = "least share of what the active version knows that the candidate knows as well",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("min_explained", c.min_explained,
            {.doc = "without an active version: least share of a recording's scans that fit",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_explained_drop", c.max_explained_drop,
            {.doc = "so many fewer of the scans may fit than in the active version",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_contradicted_rise", c.max_contradicted_rise,
            {.doc = "so many more of the scans may contradict the map",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_new_contradicted", c.max_new_contradicted,
            {.doc = "so many of the scans of a run that the candidate learned anew may contradict "
                    "the active version",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_score_drop", c.max_score_drop,
            {.doc = "so much lower the mean score may be", .unit = "1", .min = 0.0, .max = 1.0});
    v.field("max_lost_rise", c.max_lost_rise,
            {.doc = "in so many more of the scans the robot may be lost",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_error_rise_m", c.max_error_rise_m,
            {.doc = "so much greater the mean error may be, where --truth tells it",
             .unit = "m",
             .min = 0.0});
  }
};

struct GateConfig : GateLimits {
  localization::LocalizerConfig localizer;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    GateLimits::describe(c, v);
    v.group("localizer", c.localizer, "the particle filter");
  }
};

/// One thing that was looked at.
struct GateCheck {
  std::string name;  ///< "frame", "walls", "fold", "losses", ...
  std::string log;   ///< of a recording: which; else empty
  bool passed = true;
  std::string text;  ///< what was found, and against what
};

/// How well a robot did on a recording in one map.
struct Drive {
  double explained = 0.0;         ///< shares of the weighed scans
  double contradicted = 0.0;      ///< ...
  double lost = 0.0;              ///< share of all scans
  double score = 0.0;             ///< mean
  std::optional<double> error_m;  ///< mean, where the truth is known
  pipeline::LogFit fit;
};

/// From the first to the last stamp of a drive.
struct Period {
  std::optional<Stamp> begin;
  std::optional<Stamp> end;
  void add(Stamp stamp) {
    begin = begin ? std::min(*begin, stamp) : stamp;
    end = end ? std::max(*end, stamp) : stamp;
  }
  [[nodiscard]] bool overlaps(const Period& other) const {
    return begin && other.begin && *begin <= *other.end && *other.begin <= *end;
  }
};

struct GateLog {
  std::string log;
  Period period;
  std::string passed_over;  ///< why it says nothing; empty: it was driven
  std::optional<Drive> active;
  Drive candidate;
};

struct GateReport {
  std::string model;
  std::optional<MapShift> shift;  ///< from the active version's frame to the candidate's
  std::optional<MapShift> drift;  ///< ... from that of the first version that has these walls
  std::vector<GateCheck> checks;
  std::vector<GateLog> logs;
  [[nodiscard]] bool passed() const;
};

struct GateTask {
  std::filesystem::path candidate;              ///< MAPS folders
  std::optional<std::filesystem::path> active;  ///< nothing: the first version of a site
  /// MAPS folders that were active before, the oldest first: none may be lost sight of bit by bit.
  std::vector<std::filesystem::path> earlier;
  /// Asked of each of them before it is read; none: all are.
  std::function<bool(const std::filesystem::path&)> is_whole;
  pipeline::RunsInput input;  ///< recordings, and their truths where known
  std::string model;          ///< empty: patch where both have one, else filtered
  std::uint64_t seed = 1;
  int threads = 1;
};

/// From which scan on a robot that began from nowhere counts as found: its score
/// (LocalizationResult::score) is high; where fewer than ten scans are left then, or none is, since
/// several places fit to the end, its score as if no other place fitted: both versions are judged
/// at the likeliest. Nothing where neither is ever high. One value a scan each.
[[nodiscard]] std::optional<std::size_t> found_at(std::span<const double> scores,
                                                  std::span<const double> place_scores);

/// Looks whether the candidate is folded, whether its walls lie where the active version's do and
/// where those of the first version did that still has them, and
/// drives every recording through both. A recording on which the robot is not found in the active
/// version says nothing and is passed over. Deterministic. Throws InputError.
[[nodiscard]] GateReport run_gate(const GateTask& task, const GateConfig& config,
                                  Progress* progress);

}  // namespace strata::site
