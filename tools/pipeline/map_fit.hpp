// SPDX-License-Identifier: Apache-2.0
/// How well a map explains a log that was localized in it
/// (docs/theory/evaluation.md, "Map and log").
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "components/log/trajectory_file.hpp"
#include "core/base/config.hpp"
#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/scan/scan.hpp"

namespace strata::pipeline {

/// What the map says of a scan and those just before it, from where the robot was taken to be.
enum class FitState {
  kExplained,     ///< most beams end where the map has them end
  kContradicted,  ///< they do not
  kUnknown,       ///< the map knows too little there to say
};

struct FittedScan {
  Stamp stamp;
  Pose2 map_from_robot;
  double score = 0.0;  ///< share of the beams that end where expected, of these scans; 0 to 1
  FitState fit = FitState::kUnknown;
  bool is_ambiguous = false;  ///< several places were possible: map_from_robot is the likeliest
};

/// Of the scans that were weighed: a robot that stands says nothing new.
struct LogFit {
  std::vector<FittedScan> scans;
  std::vector<Pose2> places;  ///< that are still possible after the last scan, if it is ambiguous
  /// Share of the scans; 0 when there is none.
  [[nodiscard]] double share(FitState fit) const;
  /// Whether the map explains the log at the poses found: in at least kMinExplained of the scans.
  /// True when there is no scan, which says nothing.
  [[nodiscard]] bool is_explained() const;
};

/// Scans that are looked at together: one alone may see little but a group of people.
inline constexpr std::size_t kFitWindow = 10;
/// Explained when so many of the beams that the map can judge end where expected ...
inline constexpr double kMinInliers = 0.65;
/// ... of the scans of a log, so many.
inline constexpr double kMinExplained = 0.65;

/// Judges each weighed scan in a map, whichever model the robot was localized with, so that one
/// threshold holds for all.
class MapFit {
 public:
  explicit MapFit(const ReflectionGrid& map) : judge_(localization::make_grid_beam_model(map)) {}

  /// Takes up a scan and what the localizer made of it. O(beams times cells on their way).
  void add(const Observation& observation, const localization::LocalizationResult& result,
           const localization::ParticleSet& particles);
  [[nodiscard]] const LogFit& fit() const { return fit_; }

 private:
  std::shared_ptr<const localization::GridBeamModel> judge_;
  std::array<localization::InlierShares, kFitWindow> window_;  ///< the last ones, in any order
  LogFit fit_;
};

/// The same of a log that was localized elsewhere, from the poses that it left; scans without one
/// are left out. O(scans x beams x cells on their way).
[[nodiscard]] LogFit fit_of_trajectory(const ReflectionGrid& map,
                                       std::span<const Observation> observations,
                                       std::span<const log::StampedPose> trajectory);

}  // namespace strata::pipeline

template <>
struct strata::EnumNames<strata::pipeline::FitState> {
  static constexpr std::array<std::pair<strata::pipeline::FitState, const char*>, 3> values{
      {{strata::pipeline::FitState::kExplained, "explained"},
       {strata::pipeline::FitState::kContradicted, "contradicted"},
       {strata::pipeline::FitState::kUnknown, "unknown"}}};
};
