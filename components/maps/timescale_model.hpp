// SPDX-License-Identifier: Apache-2.0
/// Timescale levels as sensor models.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/maps/timescale_use.hpp"
#include "core/localization/object_pool.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/rays/beam_mixture.hpp"
#include "core/rays/ray_caster.hpp"
#include "core/rays/scan_mixture.hpp"
#include "memory/nodes/level_mixture.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::maps {

/// What a timescale memory is used for while it localizes.
struct TimescaleUse {
  /// Index of the level to believe; nothing: all of them, mixed.
  std::optional<int> level;
  /// The memory takes in the scans that it localizes.
  bool goes_on_learning = true;
  /// ... whose pose has at least this score, and is not in doubt.
  double min_score = 0.0;
  /// What it took in counts for localizing only after this, or the robot would pull the map along
  /// with the errors of its own pose.
  double unsettled_s = 20.0;
  /// Levels that hold less of the belief than this are not asked: they would cost as much as the
  /// others. The forgetting alone leaves each level of three 0.0067.
  double min_weight = 0.01;
  memory::LevelMixtureConfig mixture;
};

/// ln p(z | x) = 1/tau ln sum over levels w_l product over beams p(z_n | what level l expects),
/// with the mixture, beams and tau of the grid models (docs/theory/timescale_memory.md,
/// "Localization").
///
/// The weights w_l are those of the node that the robot was last believed to be at, the same for
/// all particles, and follow how well each level explains the scans there. Where a level knows only
/// that a beam's way is free up to some range, or nothing, the beam goes on in the base map, the
/// "previously given, static map" of [kessler2010what, abstract]; without one it may end anywhere
/// beyond.
class TimescaleModel final : public localization::SensorModel {
 public:
  /// base: null for none.
  TimescaleModel(std::shared_ptr<const memory::TimescaleMemory> memory,
                 std::shared_ptr<const memory::NodeMap> map,
                 const localization::BeamModelConfig& config, const TimescaleUse& use,
                 std::shared_ptr<const rays::RayCaster> base = nullptr);

  std::size_t log_likelihoods(const Scan& scan, const localization::Weighing& weighing,
                              localization::ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool& pool) const override;
  [[nodiscard]] double tempering() const override { return config_.tempering; }
  [[nodiscard]] localization::InlierShares inlier_shares(
      const Scan& scan, const Pose2& map_from_robot,
      const localization::ParticleSet& particles) const override;
  /// By the base map; nothing without one.
  void find_unjudged(const Scan& scan, const Pose2& map_from_robot,
                     std::vector<std::uint8_t>& is_unjudged) const override;
  [[nodiscard]] std::unique_ptr<SensorModel> for_one_run() const override;
  void learn(const Observation& observation, const Pose2Gaussian& map_from_robot,
             const localization::PoseTrust& trust) override;
  void adopt(const SensorModel& before) override;
  /// Weights, and of its own memory what differs from the one that it began with. O(nodes).
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> save_learned(
      std::size_t max_bytes) override;
  void restore_learned(std::span<const std::uint8_t> bytes, const std::string& place) override;

  /// Metres that the most trusted level expects, or the next one where it knows nothing; +infinity
  /// where none expects anything.
  [[nodiscard]] double expected_range_m(const Pose2& map_from_laser, double bearing_rad) const;
  /// Levels in use, the most trusted first, with their weights.
  struct Believed {
    int level = 0;
    double weight = 1.0;
  };
  class BelievedLevels {
   public:
    /// Keeps the order; what no longer fits, the least trusted, is left out.
    void add(const Believed& level);
    [[nodiscard]] const Believed* begin() const { return levels_.data(); }
    [[nodiscard]] const Believed* end() const { return levels_.data() + size_; }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] const Believed& operator[](std::size_t i) const { return levels_[i]; }
    static constexpr std::size_t kMax = 16;

   private:
    std::array<Believed, kMax> levels_;
    std::size_t size_ = 0;
  };
  [[nodiscard]] BelievedLevels believed() const;
  [[nodiscard]] const memory::NodeMap& map() const { return *map_; }

 private:
  static constexpr std::size_t kBlock = 64;
  struct Scratch {
    rays::ScanBeams beams;
    rays::ScanMixture mixture;
    /// ln p of a hit within a way that is free, and nothing is known beyond: the same however far
    /// the way is free.
    std::vector<double> log_within_free;
    std::vector<double> log_p_a_beam;
  };
  void prepare(const Scan& scan, Scratch& scratch) const;
  /// Up to kBlock beams of a scan from one place, and how far each goes in the base map.
  struct Beams {
    Eigen::Vector2d laser_m;
    std::size_t begin = 0;
    std::size_t count = 0;
    std::array<Eigen::Vector2d, kBlock> direction;
    std::array<double, kBlock> base_m;
    bool is_cast = false;
  };
  [[nodiscard]] bool has_base_at(const Eigen::Vector2d& laser_m) const {
    return base_ != nullptr && base_->knows(laser_m);
  }
  /// How far a beam goes whose way the nodes know to be free up to free_m, and which goes base_m in
  /// the base map; +infinity for no obstacle within r_max_m.
  [[nodiscard]] double beyond_m(const Eigen::Vector2d& laser_m, const Eigen::Vector2d& direction,
                                double free_m, double base_m, double r_max_m) const;
  void cast_in_base(const Pose2& laser, const Scratch& scratch, Beams& beams) const;
  /// log_p[k] = ln p(beam begin + k | one level) for k < count <= kBlock.
  void weigh(const Pose2& laser, const memory::NodeMap::View& view, const Scratch& scratch,
             Beams& beams, double* log_p) const;
  /// What a level expects of one beam, the base map where it says nothing.
  [[nodiscard]] memory::NodeOutline::Reach reach_at(int level, const Eigen::Vector2d& laser_m,
                                                    const Eigen::Vector2d& direction,
                                                    double r_max_m) const;
  /// One entry a believed level.
  using OfLevels = std::array<double, BelievedLevels::kMax>;
  /// ln p of the scan from there under each level alone.
  [[nodiscard]] OfLevels log_p_of_levels(const Pose2& laser, const BelievedLevels& levels,
                                         const Scratch& scratch) const;
  /// ln sum_l w_l p_l.
  [[nodiscard]] static double mixed(const BelievedLevels& levels, OfLevels log_p);
  /// How well each level, alone, explains the scan from there: the weights learn from it.
  void weigh_levels(const Scan& scan, const Pose2& laser);

  std::shared_ptr<const memory::TimescaleMemory> memory_;
  std::shared_ptr<const memory::NodeMap> map_;
  std::shared_ptr<const memory::NodeMap> first_map_;  ///< that it began with
  std::shared_ptr<const rays::RayCaster> base_;
  localization::BeamModelConfig config_;
  rays::BeamMixture beam_mixture_;
  TimescaleUse use_;
  memory::LevelMixture mixture_;
  int node_ = -1;                                      ///< where the robot was last believed to be
  std::optional<memory::TimescaleMemory> own_memory_;  ///< of a copy for one run that learns
  PosedScan posed_;                                    ///< kept for its memory
  localization::ObjectPool<Scratch> scratch_;
};

}  // namespace strata::maps
