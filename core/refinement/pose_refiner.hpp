// SPDX-License-Identifier: Apache-2.0
/// A pose to a centimetre, beside the filter's mean: the scan registered with the surfaces of the
/// map, where the filter is sure (docs/theory/patch_localization.md, "Refined pose").
#pragma once

#include <optional>

#include "core/base/config.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/localization/localizer.hpp"
#include "core/refinement/surface_field.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/scan/scan.hpp"

namespace strata::refinement {

struct RefinementConfig {
  double min_score = 0.5;
  int max_beams = 360;
  double hit_stddev_m = 0.03;
  double min_inlier_share = 0.35;
  double max_shift_m = 0.15;
  double min_configuration = 0.9;
  double map_stddev_m = 0.005;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("min_score", c.min_score,
            {.doc = "only poses with at least this score are refined", .min = 0.0, .max = 1.0});
    v.field("max_beams", c.max_beams,
            {.doc = "hits in use, spread evenly over the scan", .unit = "beams", .min = 20});
    v.field("hit_stddev_m", c.hit_stddev_m,
            {.doc = "spread of hits about a surface", .unit = "m", .min = 0.005, .max = 0.2});
    v.field("min_inlier_share", c.min_inlier_share,
            {.doc = "least share of the hits that must lie at surfaces", .min = 0.0, .max = 1.0});
    v.field("max_shift_m", c.max_shift_m,
            {.doc = "a pose that would move farther stays as it is", .unit = "m", .min = 0.0});
    v.field("min_configuration", c.min_configuration,
            {.doc = "what is in a changeable area counts where it is at least so probable",
             .min = 0.5,
             .max = 1.0});
    v.field("map_stddev_m", c.map_stddev_m,
            {.doc = "what the map's own surfaces may be off, added to the covariance",
             .unit = "m",
             .min = 0.0});
  }
};

/// Refines poses of one robot in one map. Remembers nothing of a scan: the same scan and result
/// give the same bits. Not thread-safe.
class PoseRefiner {
 public:
  /// As SurfaceField. Throws ConfigError.
  PoseRefiner(const ReflectionGrid& map, const SurfaceLayer& layer, const patch::PatchMap* patches,
              const RefinementConfig& config = {});

  /// map_from_robot at the scan's stamp, beside `result.pose` of the same scan; nothing where the
  /// filter is in doubt or ambiguous, the score is low, or the refined pose is not shown to be
  /// better. It is found twice, from every other hit, and what the hits that it was not made of say
  /// must not speak against it and for the filter's mean; their mean is the result, and how far
  /// they disagree is in its covariance. Directions that the surfaces leave open stay as the filter
  /// has them. O(beams).
  [[nodiscard]] std::optional<Pose2Gaussian> refine(const Scan& scan,
                                                    const localization::LocalizationResult& result);

 private:
  [[nodiscard]] std::optional<Pose2Gaussian> registered(const Endpoints& used,
                                                        const Endpoints& others,
                                                        const Pose2Gaussian& filtered) const;
  RefinementConfig config_;
  SurfaceField surfaces_;
};

}  // namespace strata::refinement
