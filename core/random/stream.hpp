// SPDX-License-Identifier: Apache-2.0
/// Reproducible random numbers: a counter-based generator and our own distributions.
///
/// Philox4x32-10 [salmon2011parallel] keyed by (seed, stream, step, index): the numbers that
/// particle 17 draws at step 42 depend on nothing else, so neither the schedule nor the number of
/// threads can change a run. The standard library's distributions differ between implementations
/// and are never used.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace strata {

/// What a stream is for, so that two uses of one seed never share numbers. Append, never reorder.
enum class StreamId : std::uint32_t {
  kTest = 0,
  kMotion = 1,
  kResample = 2,
  kPatchTransition = 3,
  kInitialize = 4,
  kRecovery = 5,
  kTimescale = 6,
  kClustering = 7,
  kSimulatorWorld = 8,
  kSimulatorSensor = 9,
  kSimulatorOdometry = 10,
  kBootstrap = 11,
  kTopology = 12,
  kRoughening = 13,
  kHistory = 14,
};

/// One stream of random numbers. Cheap to make (no state table), cheap to copy.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, StreamId stream, std::uint64_t step = 0,
               std::uint32_t index = 0);

  /// 32 uniform random bits.
  std::uint32_t next_u32();
  /// 64 uniform random bits.
  std::uint64_t next_u64();
  /// Uniform in [0, 1), 53 bits.
  double uniform();
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal (Box-Muller, both values used).
  double normal();
  double normal(double mean, double stddev) { return mean + stddev * normal(); }
  /// Uniform integer in [0, bound), without bias. Requires bound > 0.
  std::uint32_t below(std::uint32_t bound);
  /// True with probability p.
  bool bernoulli(double p) { return uniform() < p; }
  /// Exponential with the given rate. Requires rate > 0.
  double exponential(double rate);
  /// Index i with probability weights[i] / sum. Requires a positive finite sum; O(n).
  std::size_t categorical(std::span<const double> weights);

 private:
  void refill();

  std::array<std::uint32_t, 4> counter_{};
  std::array<std::uint32_t, 2> key_{};
  std::array<std::uint32_t, 4> block_{};
  int used_ = 4;
  bool has_spare_normal_ = false;
  double spare_normal_ = 0.0;
};

/// The Philox4x32-10 block function, public for tests against the published vectors.
[[nodiscard]] std::array<std::uint32_t, 4> philox4x32_10(std::array<std::uint32_t, 4> counter,
                                                         std::array<std::uint32_t, 2> key);

}  // namespace strata
