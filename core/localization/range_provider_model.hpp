// SPDX-License-Identifier: Apache-2.0
/// The beam model for any map that can say how far a beam should go.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/config.hpp"
#include "core/localization/laser_columns.hpp"
#include "core/localization/object_pool.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/localization/unjudged_beams.hpp"
#include "core/rays/beam_mixture.hpp"
#include "core/rays/bundle_kernel.hpp"
#include "core/rays/column_math.hpp"
#include "core/rays/ray_caster.hpp"
#include "core/rays/scan_beams.hpp"
#include "core/rays/scan_mixture.hpp"

namespace strata::localization {

/// Whatever predicts ranges: metres along the beam from a laser at that pose, +infinity for no
/// obstacle; and says where it knows anything. Called from several threads at once.
template <typename T>
concept RangeProvider = LimitedMap<T> && requires(const T& provider, const Pose2& map_from_laser) {
  { provider.expected_range_m(map_from_laser, 0.0) } -> std::convertible_to<double>;
};

struct BeamModelConfig {
  rays::BeamMixtureConfig mixture;
  rays::BeamSelectionConfig beams;
  double tempering = 2.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("mixture", c.mixture, "what a beam measures given its expected range");
    v.group("beams", c.beams, "which beams are in use");
    v.field("tempering", c.tempering,
            {.doc = "the log-likelihood is divided by this, as beams are not independent",
             .unit = "1",
             .min = 0.1});
  }
};

/// A provider that predicts many beams at once, from a table that kernels read.
template <typename T>
concept BundleProvider = requires(const T& provider, const rays::BeamBundle& bundle,
                                  double* range_m, std::int32_t* cell) {
  provider.expected_ranges_m(bundle, range_m, cell);
  { provider.table() } -> std::convertible_to<rays::RayTable>;
  { provider.max_range_m() } -> std::convertible_to<double>;
};

/// ln p(z | x) = 1/tau sum over beams ln p(z_n | expected range). All map models have the same
/// mixture, beams and tau; only the provider differs (docs/theory/evaluation.md, "Same filter").
template <RangeProvider Provider>
class RangeProviderModel final : public SensorModel {
 public:
  explicit RangeProviderModel(std::shared_ptr<const Provider> provider,
                              const BeamModelConfig& config = {})
      : provider_(std::move(provider)), config_(config), mixture_(config.mixture, 1.0) {
    require_valid(config, "beam_model");
  }

  std::size_t log_likelihoods(const Scan& scan, const Weighing& weighing, ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool& pool) const override {
    const auto scratch = scratch_.acquire();
    prepare(scan, *scratch);
    constexpr std::size_t kChunk = 64;
    const auto weigh = [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
      const auto chunk = chunk_scratch_.acquire();
      weigh_chunk(*scratch, particles, begin, end, *chunk);
      for (std::size_t i = begin; i < end; ++i) {
        log_likelihood[i] = chunk->sums[i - begin] / weighing.tempering;
      }
    };
    pool.for_chunks(particles.size(), kChunk, std::cref(weigh));
    return scratch->beams.size();
  }

  [[nodiscard]] double tempering() const override { return config_.tempering; }

  void find_unjudged(const Scan& scan, const Pose2& map_from_robot,
                     std::vector<std::uint8_t>& is_unjudged) const override {
    const Pose2 laser = map_from_robot * scan.robot_from_laser;
    const auto expected_m = [&](std::size_t beam, const Eigen::Vector2d& /*direction*/, double) {
      return provider_->expected_range_m(laser, scan.bearing_rad(beam));
    };
    mark_unjudged(*provider_, scan, laser, mixture_.tolerance_m(), expected_m, is_unjudged);
  }

  [[nodiscard]] InlierShares inlier_shares(const Scan& scan, const Pose2& map_from_robot,
                                           const ParticleSet& /*particles*/) const override {
    const auto scratch = scratch_.acquire();
    rays::select_beams(scan, config_.beams, scratch->beams);
    const rays::ScanBeams& beams = scratch->beams;
    if (beams.size() == 0) return {};
    const rays::BeamMixture mixture = mixture_.limited_to(beams.r_max_m);
    const Pose2 laser = map_from_robot * beams.robot_from_laser;
    InlierShares said;
    const bool is_known_here = provider_->knows(laser.translation());
    std::array<double, kBlock> expected;
    for (std::size_t begin = 0; begin < beams.size(); begin += kBlock) {
      const std::size_t count = std::min(kBlock, beams.size() - begin);
      expect(laser, beams, begin, count, expected.data());
      for (std::size_t k = 0; k < count; ++k) {
        // From where the map knows nothing, it would expect nothing of any beam.
        if (beams.is_hit[begin + k] == 0 && !(expected[k] < beams.r_max_m) && !is_known_here) {
          continue;
        }
        judge_beam(laser, beams, begin + k, expected[k], mixture, said);
      }
    }
    said.met = said.inlier;
    said.divide_by(static_cast<double>(beams.size()));
    return said;
  }

 private:
  static constexpr std::size_t kBlock = 256;
  struct Scratch {
    rays::ScanBeams beams;
    rays::ScanMixture mixture;
  };
  /// Of a chunk of particles; rows of one entry a particle.
  struct ChunkScratch {
    LaserColumns lasers;
    std::vector<double> expected_m;  // a row for each beam
    std::vector<double> logs;        // the same
    std::vector<double> sums;
  };

  /// Adds one beam to the sums, but to `met`, which is `inlier` here.
  void judge_beam(const Pose2& laser, const rays::ScanBeams& beams, std::size_t beam,
                  double expected_m, const rays::BeamMixture& mixture, InlierShares& said) const {
    const bool is_hit = beams.is_hit[beam] != 0;
    const double range_m = beams.range_m[beam];
    const Eigen::Vector2d end_m = beams.end_m(laser, beam);
    const bool is_met = mixture.is_inlier(is_hit, range_m, expected_m);
    if (!is_met && !(expected_m < range_m) &&
        !knows_end(*provider_, laser.translation(), end_m, mixture.tolerance_m())) {
      return;
    }
    bool is_at_surface = is_met;
    if constexpr (SurfaceMap<Provider>) {
      is_at_surface =
          is_met || (is_hit && provider_->is_near_surface(end_m, mixture.surface_tolerance_m()));
    }
    said.judged += 1.0;
    said.inlier += is_met ? 1.0 : 0.0;
    said.at_surface += is_at_surface ? 1.0 : 0.0;
    said.stopped += !is_at_surface && range_m < expected_m ? 1.0 : 0.0;
  }

  void prepare(const Scan& scan, Scratch& scratch) const {
    rays::select_beams(scan, config_.beams, scratch.beams);
    scratch.mixture.prepare(mixture_.limited_to(scratch.beams.r_max_m), scratch.beams);
  }

  /// Expected ranges of beams begin, begin + 1, ... count <= kBlock of them.
  void expect(const Pose2& laser, const rays::ScanBeams& beams, std::size_t begin,
              std::size_t count, double* expected) const {
    if constexpr (BundleProvider<Provider>) {
      std::array<std::int32_t, kBlock> cells;
      provider_->expected_ranges_m(
          {laser.x, laser.y, std::cos(laser.theta), std::sin(laser.theta),
           beams.cosine.data() + begin, beams.sine.data() + begin, count, beams.r_max_m},
          expected, cells.data());
    } else {
      for (std::size_t k = 0; k < count; ++k) {
        expected[k] = provider_->expected_range_m(laser, beams.bearing_rad[begin + k]);
      }
    }
  }

  /// Sums of ln p over all beams, for particles [begin, end).
  void weigh_chunk(const Scratch& scratch, const ParticleSet& particles, std::size_t begin,
                   std::size_t end, ChunkScratch& chunk) const {
    const rays::ScanBeams& beams = scratch.beams;
    chunk.lasers.take(particles, begin, end, beams.robot_from_laser);
    const std::size_t row = chunk.lasers.padded();
    chunk.expected_m.resize(beams.size() * row);
    if constexpr (BundleProvider<Provider>) {
      const double limit_m = std::min(beams.r_max_m, provider_->max_range_m());
      const rays::RayTable table = provider_->table();
      rays::cast_bundles(table, chunk.lasers.bundles(table, beams, limit_m),
                         chunk.expected_m.data());
    } else {
      for (std::size_t n = 0; n < row; ++n) {
        const Pose2 laser = particles.pose(std::min(begin + n, end - 1)) * beams.robot_from_laser;
        for (std::size_t beam = 0; beam < beams.size(); ++beam) {
          chunk.expected_m[beam * row + n] =
              provider_->expected_range_m(laser, beams.bearing_rad[beam]);
        }
      }
    }
    chunk.logs.resize(beams.size() * row);
    scratch.mixture.log_likelihoods_of_bundles(row, chunk.expected_m.data(), chunk.logs.data());
    chunk.sums.resize(row);
    rays::sum_rows(chunk.logs.data(), beams.size(), row, chunk.sums.data());
  }

  std::shared_ptr<const Provider> provider_;
  BeamModelConfig config_;
  rays::BeamMixture mixture_;  // its limit is set for every scan
  ObjectPool<Scratch> scratch_;
  ObjectPool<ChunkScratch> chunk_scratch_;
};

/// Ray casting in one map: occupied means is_occupied, unknown is transparent.
using GridBeamModel = RangeProviderModel<rays::RayCaster>;

[[nodiscard]] inline std::shared_ptr<const GridBeamModel> make_grid_beam_model(
    const ReflectionGrid& map, const BeamModelConfig& config = {}) {
  return std::make_shared<const GridBeamModel>(std::make_shared<const rays::RayCaster>(map),
                                               config);
}

}  // namespace strata::localization
