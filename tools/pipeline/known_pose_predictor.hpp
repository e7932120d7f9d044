// SPDX-License-Identifier: Apache-2.0
/// The predictions of one map model at known poses: what it expects, how likely a scan is, and
/// what it believes of the sub-maps after the scans so far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "components/maps/map_model.hpp"
#include "core/base/parallel.hpp"
#include "core/localization/patch_states.hpp"
#include "core/scan/scan.hpp"

namespace strata::pipeline {

/// The belief side of a localizer, without its doubts about the pose. Deterministic.
class KnownPosePredictor {
 public:
  explicit KnownPosePredictor(const maps::MapModel& model);

  /// Goes to a pose; configurations may have changed since the last stamp.
  void go_to(const Pose2& map_from_robot, Stamp stamp);
  /// The single best prediction from what is believed now.
  [[nodiscard]] maps::RangeFunction expected_range() const;
  struct Likelihood {
    double nats = 0.0;  ///< ln p of all beams in use, not tempered
    std::size_t beams = 0;
  };
  /// Changes nothing. A model without memory draws configurations: the mean over its draws.
  [[nodiscard]] Likelihood likelihood(const Scan& scan) const;
  /// Learns the states of sub-maps from a scan, as a localizer at this pose would.
  void learn(const Scan& scan);
  /// One entry a sub-map; empty for models without.
  [[nodiscard]] std::vector<localization::SubmapBelief> beliefs() const;

 private:
  void resample();

  const maps::MapModel& model_;
  const localization::PatchStates* states_;
  localization::ParticleSet particles_;
  mutable WorkerPool pool_{1};
  std::optional<Stamp> last_;
  std::uint64_t step_ = 0;
};

}  // namespace strata::pipeline
