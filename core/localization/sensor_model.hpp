// SPDX-License-Identifier: Apache-2.0
/// What a scan says about each particle: the one place where map models differ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/localization/inlier_shares.hpp"
#include "core/localization/particle_set.hpp"
#include "core/scan/scan.hpp"

namespace strata::localization {

class PatchStates;
struct SubmapBelief;

/// How a scan is weighed.
struct Weighing {
  double tempering = 1.0;  ///< divides the log-likelihood; > 0
  /// Of the beams that a model looks at: less than 1 where several scanners share them.
  double share = 1.0;
  /// One place is left, and was told or confirmed. Only there may changeable areas show something
  /// that nobody saw: it would excuse a wrong place for what that lacks.
  bool is_place_sure = true;
};

/// How far a pose is to be believed that somebody learns from.
struct PoseTrust {
  double score = 1.0;        ///< 0 to 1, of PoseScore
  bool is_in_doubt = false;  ///< lost, about to be, one of several places, or beyond the map
};

/// A map and how beams behave in it. Const and without hidden state, so that several localizers may
/// share one; what a model remembers of a run lies in the particles, or in a copy for one run.
class SensorModel {
 public:
  SensorModel() = default;
  SensorModel(const SensorModel&) = delete;
  SensorModel& operator=(const SensorModel&) = delete;
  virtual ~SensorModel() = default;

  /// log_likelihood[i] = ln p(z | particle i) / weighing.tempering, up to a constant that is the
  /// same for all particles [nats]. May read and, with a memory of sub-maps, update the beliefs
  /// that the particles carry; nothing else of them. One virtual call a scan. The result does not
  /// depend on the number of threads. Returns how many beams spoke. Requires log_likelihood.size()
  /// == particles.size().
  virtual std::size_t log_likelihoods(const Scan& scan, const Weighing& weighing,
                                      ParticleSet& particles, std::span<double> log_likelihood,
                                      WorkerPool& pool) const = 0;

  /// The temperature for tracking: the log-likelihood is divided by it, as neighbouring beams, and
  /// scans, are not independent (docs/theory/patch_localization.md, "Beam model").
  [[nodiscard]] virtual double tempering() const = 0;

  /// How many of the beams in use are inliers of the map from this pose. `particles` gives what the
  /// filter believes of the sub-maps.
  [[nodiscard]] virtual InlierShares inlier_shares(const Scan& scan, const Pose2& map_from_robot,
                                                   const ParticleSet& particles) const = 0;
  /// The same for a filter that has pooled the beliefs of these particles already: what
  /// patch_states()->posterior() says of them, for models with sub-maps.
  [[nodiscard]] virtual InlierShares inlier_shares_given(
      const std::vector<SubmapBelief>& /*posterior*/, const Scan& scan, const Pose2& map_from_robot,
      const ParticleSet& particles) const {
    return inlier_shares(scan, map_from_robot, particles);
  }

  /// Marks (1) the beams of which the map says nothing from this pose (unjudged_beams.hpp).
  /// is_unjudged: one a beam of the scan; all 0 from models that do not know where their map ends.
  virtual void find_unjudged(const Scan& scan, const Pose2& /*map_from_robot*/,
                             std::vector<std::uint8_t>& is_unjudged) const {
    is_unjudged.assign(scan.size(), 0);
  }

  /// A copy of its own for each localizer, from a model that goes on learning while it localizes;
  /// null from one that may be shared.
  [[nodiscard]] virtual std::unique_ptr<SensorModel> for_one_run() const { return nullptr; }
  /// A scan was weighed, and this is where the robot is believed to be. Called on such a copy only,
  /// after log_likelihoods. Must not depend on the number of threads.
  virtual void learn(const Observation& /*observation*/, const Pose2Gaussian& /*map_from_robot*/,
                     const PoseTrust& /*trust*/) {}
  /// This copy takes the place of `before` in the middle of a run: what that one has learned about
  /// the scans, and still fits this map, goes on.
  virtual void adopt(const SensorModel& /*before*/) {}
  /// What this copy has learned; nothing when that is more than max_bytes, or is not saved. What is
  /// derived from it to be fast is made anew, as restore_learned() does, so that both go on alike.
  [[nodiscard]] virtual std::optional<std::vector<std::uint8_t>> save_learned(
      std::size_t /*max_bytes*/) {
    return std::nullopt;
  }
  /// Goes on from there, in a copy of the same model. place: of the bytes, for errors. Throws
  /// DamageError.
  virtual void restore_learned(std::span<const std::uint8_t> /*bytes*/,
                               const std::string& /*place*/) {}

  /// The states of the sub-maps, for a model that has any; null otherwise.
  [[nodiscard]] virtual const PatchStates* patch_states() const { return nullptr; }
};

}  // namespace strata::localization
