// SPDX-License-Identifier: Apache-2.0
/// The particles of a filter as structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"
#include "core/geometry/pose2_gaussian.hpp"

namespace strata::localization {

/// N weighted samples of the robot's pose, with the patch state (s, k) of
/// docs/theory/patch_localization.md, "State". All columns have size() entries; poses are
/// map_from_robot. Weights sum to 1 whenever the localizer hands the set out.
struct ParticleSet {
  std::vector<double> x_m;
  std::vector<double> y_m;
  std::vector<double> theta_rad;  ///< in (-pi, pi]
  std::vector<double> weight;
  std::vector<std::int32_t> submap;         ///< the sub-map that the particle is in; -1: none
  std::vector<std::int32_t> configuration;  ///< its configuration there; -1: none, or not sampled
  /// size() rows of belief_columns numbers: what each particle believes of every configuration of
  /// every sub-map, one after the other. No columns unless the memory of sub-maps asks for them.
  std::vector<float> beliefs;
  std::size_t belief_columns = 0;
  /// The same for the set as a whole (memory = shared); empty otherwise.
  std::vector<float> shared_belief;
  /// The time that PatchStates::tell_time() was told last, and the belief then of a particle that
  /// saw nothing; empty where that does not depend on the time.
  std::optional<Stamp> time;
  std::vector<float> usual;

  [[nodiscard]] std::size_t size() const { return x_m.size(); }
  [[nodiscard]] bool empty() const { return x_m.empty(); }
  [[nodiscard]] Pose2 pose(std::size_t i) const { return {x_m[i], y_m[i], theta_rad[i]}; }
  [[nodiscard]] std::span<float> belief(std::size_t i) {
    return {beliefs.data() + i * belief_columns, belief_columns};
  }
  [[nodiscard]] std::span<const float> belief(std::size_t i) const {
    return {beliefs.data() + i * belief_columns, belief_columns};
  }

  /// Sets the number of particles; new ones are at the origin with weight 0 and no configuration.
  /// Keeps memory when it shrinks.
  void resize(std::size_t count);
  void set_pose(std::size_t i, const Pose2& pose);
  /// Takes over what all particles share, which copy_from() leaves out.
  void share(const ParticleSet& other);
  /// Copies particle `from` of another set (same belief_columns) to place `to`, weight included.
  void copy_from(const ParticleSet& other, std::size_t from, std::size_t to);
};

/// 1 / sum w^2, for weights that sum to 1. 0 for an empty set.
[[nodiscard]] double effective_sample_size(const ParticleSet& particles);

/// Makes all weights 1 / N.
void set_uniform_weights(ParticleSet& particles);

/// Multiplies the weights with exp(log_likelihood) and normalizes; returns the log of the sum
/// before normalizing, ln sum_i w_i p_i. When nothing finite remains, the weights stay as they are
/// and the result is -infinity. Requires one entry a particle.
double reweigh(ParticleSet& particles, std::span<const double> log_likelihood);

/// Weighted mean (circular in heading) and covariance of all particles. O(N).
[[nodiscard]] Pose2Gaussian estimate(const ParticleSet& particles);

/// The error of a scan as [stachniss2005patch, experiments] defines it: sum_i w_i |x_i - x_true| in
/// metres.
[[nodiscard]] double weighted_error(const ParticleSet& particles, const Pose2& truth);
/// The same for the heading: sum_i w_i |theta_i - theta_true| in radians, differences wrapped.
[[nodiscard]] double weighted_heading_error(const ParticleSet& particles, const Pose2& truth);

}  // namespace strata::localization
