// SPDX-License-Identifier: Apache-2.0
/// The beam filter while the robot drives: labels for each scan as it comes, by all that was seen
/// until then.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/beam_filter/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/drop_out_watch.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/scanner_turns.hpp"

namespace strata::beam_filter {

/// What of a running robot's scans is kept.
struct WindowConfig {
  int scans = 200;
  double key_distance_m = 0.1;
  double key_turn_rad = 0.0873;
  double fade_scans = 200.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("scans", c.scans,
            {.doc = "the latest scans, which all count; of older ones only those that the robot "
                    "took somewhere else than the one before stay in the map",
             .unit = "scans",
             .min = 1.0});
    v.field("key_distance_m", c.key_distance_m,
            {.doc = "a scan stays in the map after this much driving", .unit = "m", .min = 0.0});
    v.field("key_turn_rad", c.key_turn_rad,
            {.doc = "... or after this much turning", .unit = "rad", .min = 0.0});
    v.field(
        "fade_scans", c.fade_scans,
        {.doc = "what a place was like fades with this many scans that stay and look at it: with "
                "less, what was put up is part of the map sooner, and so are people who wait",
         .unit = "scans",
         .min = 2.0});
  }
};

/// Counts of a window of scans and of key scans before it (docs/theory/beam_filter.md, "Online
/// filter"): a robot standing before a standing person would else hold her static for good. What it
/// saw standing still goes with the window; key scans fade as newer ones look at the same place, or
/// a cabinet that was put up would be dynamic until as many beams met it as once passed there.
/// Memory: the window, the map's cells. Not thread-safe.
class OnlineFilter {
 public:
  /// Throws ConfigError.
  explicit OnlineFilter(const BeamFilterConfig& filter = {}, const WindowConfig& window = {},
                        const NoReturnConfig& no_return = {});

  /// Takes the scan in, and returns e(t, n) of its beams, eq. (1.10) of [stachniss2003chapter], by
  /// the limit of EM on the counts so far, whatever `mode` says: it costs a cell only where it is
  /// asked. With endpoint_tolerance the most reflecting cell of the 3 x 3 around the end decides.
  /// Labels that the scan came with are not used.
  /// O(beams x cells a beam crosses).
  std::vector<float> add(PosedScan scan);

  /// The filtered map of what is counted now. O(cells).
  [[nodiscard]] ReflectionGrid map() const;

  /// What a process goes on with after it was stopped: restored into a new filter with the same
  /// config, it goes on to the same bits as this one.
  [[nodiscard]] std::vector<std::uint8_t> save_state() const;
  /// Throws InputError for bytes that are no state or of another resolution; the filter is then of
  /// no more use. place: of the bytes, for errors.
  void restore_state(std::span<const std::uint8_t> bytes, const std::string& place);

  /// Of the window and what is left of the key scans. O(cells).
  [[nodiscard]] CountingMap counts() const;
  [[nodiscard]] std::size_t scans_in_window() const { return window_.size(); }
  /// Stamp of the newest scan in the window; requires one.
  [[nodiscard]] Stamp newest() const { return window_.back().scan.scan.stamp; }

 private:
  struct Entry {
    PosedScan scan;
    bool key = false;
    template <class Self, class Archive>
    static void state(Self& self, Archive& archive) {
      archive(self.scan);
      archive(self.key);
    }
  };

  void count_in_window(const PosedScan& scan, double weight);

  BeamFilterConfig filter_;
  WindowConfig config_;
  CountingMap window_counts_;  ///< of the window's scans that are no key scans
  CountingMap key_counts_;
  std::deque<Entry> window_;
  std::optional<Pose2> last_key_;
  DropOutWatch drop_outs_;
  ScannerTurns turns_;  ///< several scanners take turns at the key scans
};

}  // namespace strata::beam_filter
