// SPDX-License-Identifier: Apache-2.0
/// Which of the candidates of a global search a sensor model believes in, and by how much.
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/geometry/pose2.hpp"
#include "core/localization/global_search.hpp"
#include "core/localization/particle_set.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/scan/scan.hpp"

namespace strata::localization {

struct PlaceRankingConfig {
  int rounds = 4;
  double step_m = 0.1;
  double step_rad = 0.02;
  double hopeless_nats = 100.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "rounds", c.rounds,
        {.doc = "times that each place is moved to where the scan fits better; every other time "
                "by half as much",
         .min = 0});
    v.field("step_m", c.step_m, {.doc = "by so much at first", .unit = "m", .min = 0.0});
    v.field("step_rad", c.step_rad, {.doc = "and turned", .unit = "rad", .min = 0.0});
    v.field(
        "hopeless_nats", c.hopeless_nats,
        {.doc = "places so far below the best one are moved no more", .unit = "nats", .min = 0.0});
  }
};

/// A candidate as a sensor model sees it.
struct RankedPlace {
  Pose2 map_from_robot;
  double log_likelihood = 0.0;  ///< of the scan, up to a constant that all share [nats]
};

/// The candidates, each moved to where the model likes the scan best nearby, the likeliest first.
/// What the model says of beams that pass a mapped wall, or end before one, tells places apart that
/// end points alone do not. In a map with sub-maps a place counts with the configurations that
/// explain the scan best there, less what they are improbable (the bound ln p(z | q) - KL(q |
/// prior), q the beliefs after the scan): a closed door does not refute the right place, and at a
/// cost invents none. O(candidates x rounds) weighings.
[[nodiscard]] std::vector<RankedPlace> rank_places(std::span<const PlaceCandidate> candidates,
                                                   const Scan& scan, const SensorModel& model,
                                                   const PlaceRankingConfig& config,
                                                   WorkerPool& pool);

/// By how much the first of ranked places leads the likeliest of those that are further from it
/// than `distance_m` or turned by more than `turn_rad` [nats]; +infinity when there is none, and 0
/// without any place.
[[nodiscard]] double margin_of(std::span<const RankedPlace> places, double distance_m,
                               double turn_rad);

/// One particle a pose, which knows of sub-maps what is usual at that time; equal weights.
[[nodiscard]] ParticleSet particles_at(std::span<const Pose2> poses, const SensorModel& model,
                                       Stamp time);

/// ln p(scan | each particle), for the configurations that explain it best, as above. The
/// particles' beliefs are as after the scan then.
void weigh_places(const Scan& scan, const SensorModel& model, ParticleSet& particles,
                  std::vector<double>& log_likelihood, WorkerPool& pool);

}  // namespace strata::localization
