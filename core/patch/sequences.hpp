// SPDX-License-Identifier: Apache-2.0
/// Observation sequences (1.16)-(1.17) of [stachniss2003chapter]: which scans belong to one stay at
/// a sub-map, and what they saw of it (docs/theory/patch_maps.md, "Sequences").
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/config.hpp"
#include "core/base/progress.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/grid.hpp"
#include "core/patch/patch_map.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch {

enum class SequenceMode : std::uint8_t {
  kVisibility,  ///< open while enough beams touch the sub-map, from wherever
  kEntered,     ///< open while the robot is inside [stachniss2005patch]
};

}  // namespace strata::patch

template <>
struct strata::EnumNames<strata::patch::SequenceMode> {
  static constexpr std::array<std::pair<patch::SequenceMode, const char*>, 2> values{
      {{patch::SequenceMode::kVisibility, "visibility"},
       {patch::SequenceMode::kEntered, "entered"}}};
};

namespace strata::patch {

struct SequenceConfig {
  SequenceMode mode = SequenceMode::kVisibility;
  int min_beams_per_scan = 5;
  double entry_margin_m = kEntryMargin_m;
  double hysteresis_s = 1.0;
  double max_duration_s = 30.0;
  int min_scans = 5;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("mode", c.mode,
            {.doc = "visibility: a sequence is open while enough beams touch the sub-map; entered: "
                    "while the robot is inside it, as in the paper",
             .preset = {"paper-patch", "entered"}});
    v.field("min_beams_per_scan", c.min_beams_per_scan,
            {.doc = "visibility: beams that must touch the sub-map", .unit = "beams", .min = 1});
    v.field("entry_margin_m", c.entry_margin_m,
            {.doc = "entered: the sub-map counts as this much larger", .unit = "m", .min = 0.0});
    v.field("hysteresis_s", c.hysteresis_s,
            {.doc = "a sequence outlives pauses up to this", .unit = "s", .min = 0.0});
    v.field("max_duration_s", c.max_duration_s,
            {.doc = "a longer stay is cut into several sequences", .unit = "s", .min = 0.1});
    v.field("min_scans", c.min_scans,
            {.doc = "sequences with fewer scans are dropped", .unit = "scans", .min = 1});
  }
};

/// The scans of one stay, by their place in the sequence of all scans; ascending.
struct Sequence {
  std::vector<std::uint32_t> scans;
};

/// Cuts the scans that belong to one sub-map into sequences while they come. Between two scans of
/// a slow scanner nobody left: those that follow each other may be three periods apart, so that
/// logs of which scans were left out have sequences, too. O(1) a call.
class SequenceBuilder {
 public:
  explicit SequenceBuilder(const SequenceConfig& config) : config_(&config) {}

  /// Scan number `scan` belongs to the sub-map. Gives the sequence that ended before it, unless it
  /// was too short.
  std::optional<Sequence> take(std::uint32_t scan, int run, Stamp stamp);
  /// A scan that does not belong passed by. Gives the sequence that has ended by then.
  std::optional<Sequence> pass(int run, Stamp stamp);
  /// Nothing more comes.
  std::optional<Sequence> finish();
  /// The sequence that is still open; empty when none is.
  [[nodiscard]] const Sequence& open() const { return open_; }

  /// For core/base/state_archive.hpp.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.open_.scans);
    archive(self.run_);
    archive(self.first_);
    archive(self.last_);
  }

 private:
  [[nodiscard]] double longest_pause_s(bool is_next) const;
  [[nodiscard]] bool must_close(int run, Stamp stamp, bool is_next) const;

  const SequenceConfig* config_;
  Sequence open_;
  int run_ = 0;
  Stamp first_;
  Stamp last_;
};

/// Which sub-maps a scan belongs to; rays are found once for all of them.
class SequenceMembership {
 public:
  SequenceMembership(const SequenceConfig& config, const CountingOptions& counting,
                     double resolution_m)
      : config_(&config), counting_(&counting), resolution_m_(resolution_m) {}

  /// The scan that is asked about next. O(beams).
  void set_scan(const PosedScan& scan);
  /// Whether it belongs to the sub-map of that rectangle. O(beams) for those in range.
  [[nodiscard]] bool belongs_to(const CellRect& rect) const;
  /// How far its longest beam goes; 0 where sub-maps have to be entered.
  [[nodiscard]] double reach_m() const { return reach_m_; }

 private:
  const SequenceConfig* config_;
  const CountingOptions* counting_;
  double resolution_m_;
  Eigen::Vector2d robot_m_;
  Eigen::Vector2d laser_m_;
  std::vector<Ray> rays_;
  double reach_m_ = 0.0;
};

/// The sequences of each rectangle. Scans are ordered by run, then time; sequences never span two
/// runs. O(scans x rectangles in range x beams).
[[nodiscard]] std::vector<std::vector<Sequence>> find_sequences(
    std::span<const PosedScan> scans, std::span<const CellRect> rects, double resolution_m,
    const SequenceConfig& config, const CountingOptions& counting, Progress* progress = nullptr);

/// Raw counts of the scans of one sequence within the rectangle (no static probability: the beam
/// filter runs per sequence, on these counts). O(beams x cells crossed inside).
[[nodiscard]] Grid<CellCounts> count_sequence(std::span<const PosedScan> scans,
                                              const Sequence& sequence, const CellRect& rect,
                                              double resolution_m, const CountingOptions& counting);

/// Distance from a point to a rectangle, 0 inside. O(1).
[[nodiscard]] double distance_m(const Eigen::Vector2d& point_m, const CellRect& rect,
                                double resolution_m);

/// The part of the segment from + t (to - from), t in [0, 1], inside the rectangle; false when
/// there is none. Requires resolution_m > 0. O(1).
[[nodiscard]] bool clip_to_rect(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                                const CellRect& rect, double resolution_m, double& t_enter,
                                double& t_leave);

}  // namespace strata::patch
