// SPDX-License-Identifier: Apache-2.0
/// Where a drawn floor plan lies in the frame of a map (docs/site.md, "Floor plans").
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/grid/surface_layer.hpp"

namespace strata::plan {

/// Takes a point of the plan to where it is in the site's frame: turned and shifted by the pose
/// after the plan was scaled.
struct SiteFromPlan {
  Pose2 pose;
  double scale = 1.0;  ///< metres that a metre of the plan truly is
  [[nodiscard]] Eigen::Vector2d operator*(const Eigen::Vector2d& plan_m) const {
    return pose * Eigen::Vector2d(scale * plan_m);
  }
};

struct PlanConfig {
  bool keeps_scale = false;       ///< what the plan says of its scale holds
  double max_scale_error = 0.02;  ///< what is more is refused
  double min_score = 0.7;         ///< what fits less is refused
  double max_rival_share = 0.9;   ///< another place may score so much of the best at most
  std::optional<Pose2> near;      ///< site_from_plan as somebody guesses it
  double near_m = 3.0;            ///< ... to so much at the origin of the plan
  double near_rad = 0.5;
};

/// A place of the plan, and how well it fits.
struct PlanPlace {
  SiteFromPlan site_from_plan;
  /// Walls are built thicker than they are drawn by so much; below 0: thinner.
  double thicker_m = 0.0;
  double map_share = 0.0;   ///< of the map's wall faces, those that the plan has
  double plan_share = 0.0;  ///< of the drawn faces before which the map is free, those that it has
  double score = 0.0;       ///< harmonic mean of both
  double residual_m = 0.0;  ///< root mean square, across the walls that fit
};

enum class PlanVerdict {
  kGood,
  kNothingDrawn,  ///< no line in the plan
  kNothingSeen,   ///< no wall in the map
  kPoor,          ///< fits nowhere well enough
  kWrongScale,    ///< fits best at the end of what its scale may be wrong by
  kAmbiguous,     ///< fits elsewhere, too
};

struct PlanRegistration {
  PlanVerdict verdict = PlanVerdict::kNothingSeen;
  PlanPlace best;
  std::optional<PlanPlace> rival;  ///< the next best that is another place
};

/// Looks everywhere (or, with `near`, there) for the turn and shift at which walls of the map lie
/// on drawn ones, refines the best places by robust least squares over turn, shift, scale and one
/// offset between drawn and built faces, and says whether one of them is right. plan: occupied
/// where something is drawn, in the plan's own frame and metres. Furniture in the map that the plan
/// lacks, and parts of the plan that the map lacks, are outliers. Deterministic. O(what
/// coarse_places takes).
[[nodiscard]] PlanRegistration register_plan(const ReflectionGrid& plan, const ReflectionGrid& map,
                                             const SurfaceLayer& surfaces = {},
                                             const PlanConfig& config = {});

}  // namespace strata::plan
