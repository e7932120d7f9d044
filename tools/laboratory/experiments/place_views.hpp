// SPDX-License-Identifier: Apache-2.0
/// What was really seen from one place on two occasions: the material of the experiments of
/// [kessler2010what, section 5] on real logs.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"
#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"
#include "memory/levels/polar_bins.hpp"
#include "memory/levels/virtual_scan.hpp"

namespace strata::experiments {

/// Part of a log, at the poses of a file.
struct Occasion {
  std::string log;
  std::string poses;
  double from_s = 0.0;  ///< seconds from the log's first scan
  double to_s = 1e9;
};

/// The scans that have a pose. Throws InputError.
[[nodiscard]] std::vector<PosedScan> posed_scans(const Occasion& occasion);

/// What a node at a place would have seen with the scans taken within radius_m of it; those in
/// which it does not lie are left out. `error`: the robot believes to stand there instead of in its
/// own frame's origin, as after a wrong localization. O(scans + near scans x beams).
[[nodiscard]] std::vector<memory::VirtualScan> views_from(std::span<const PosedScan> scans,
                                                          const Eigen::Vector2d& node_m,
                                                          double radius_m,
                                                          const memory::PolarBins& bins,
                                                          const Pose2& error = {});

/// Two states of a place: views of each, and the angle bins in which they differ.
struct TwoStates {
  std::vector<memory::VirtualScan> before;
  std::vector<memory::VirtualScan> after;
  std::vector<float>
      before_m;  ///< lower median of each angle bin; NaN where fewer than five see it
  std::vector<float> after_m;
  std::vector<std::size_t> bins;  ///< one object: neighbours, in order of the angle

  /// Whether a range of that angle bin is nearer to what was seen after.
  [[nodiscard]] bool shows_after(float range_m, std::size_t angle_bin) const;
  /// Share of `which` (indices of angle bins) that do; unknown ranges do not.
  [[nodiscard]] double share_after(std::span<const float> range_m,
                                   std::span<const std::size_t> which) const;
};

/// The longest run of angle bins (gaps of up to two) whose medians differ by more than
/// min_difference_m, each state shown
/// by at least 85% of its views; views that do not know at least two thirds of it are left out.
/// `bins` is empty where there is none, or where fewer than five views of a state are left. With
/// all_bins all bins that differ, not one run. Ranges beyond the outermost bin count as
/// max_range_m.
[[nodiscard]] TwoStates tell_apart(std::vector<memory::VirtualScan> before,
                                   std::vector<memory::VirtualScan> after,
                                   const memory::PolarBins& bins, double min_difference_m,
                                   bool all_bins = false);

/// Takes out bins that fewer than two thirds as many of the views before know as of those after. A
/// bin that is mostly seen on the second occasion shows that one more often than its share of the
/// views is.
void keep_bins_seen_as_often(TwoStates& states);

/// One of them at random. Requires some.
[[nodiscard]] const memory::VirtualScan& draw(std::span<const memory::VirtualScan> views,
                                              RandomStream& random);

/// Of places 0.5 m apart along the second occasion's way, the one whose object covers the most
/// angle bins on both occasions. Throws InputError when nothing changed anywhere.
struct ChangedPlace {
  Eigen::Vector2d node_m;
  TwoStates states;
};
[[nodiscard]] ChangedPlace find_changed_place(std::span<const PosedScan> before,
                                              std::span<const PosedScan> after, double radius_m,
                                              const memory::PolarBins& bins,
                                              double min_difference_m);

}  // namespace strata::experiments
