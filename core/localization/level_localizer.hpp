// SPDX-License-Identifier: Apache-2.0
/// A robot in a building of several levels: the level is one more thing to find, above the filter
/// (docs/theory/levels.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/grid/metric_polygon.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/localization/level_choice.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/place_ranking.hpp"
#include "core/localization/sensor_model.hpp"

namespace strata::localization {

/// The maps of one level, in the frame that all levels share; both null while it has none.
struct LevelMaps {
  std::shared_ptr<const SensorModel> sensor;
  std::shared_ptr<const ReflectionGrid> map;  ///< where the robot may be
};

/// What takes robots from level to level.
struct Lift {
  std::vector<MetricPolygon> shape;
  std::vector<std::size_t> levels;  ///< that it serves
};

struct LevelBelief {
  std::size_t level = 0;
  double probability = 0.0;
};

/// Finds pose and level. Where the level is known there is one filter, the Localizer's, and nothing
/// else is weighed. A search of all levels has a filter on each. In a lift, and until one level has
/// refuted the others, the other levels it serves have a pose each, which is moved to where the
/// scan fits on that level. Bit-identical for the same input at any number of threads.
class LevelLocalizer {
 public:
  /// Throws ConfigError as Localizer, and std::invalid_argument where no level has maps.
  LevelLocalizer(const LocalizerConfig& config, const LevelChoiceConfig& choice,
                 std::vector<LevelMaps> levels, std::uint64_t seed, int threads = 1);

  void set_lifts(std::vector<Lift> lifts) { lifts_ = std::move(lifts); }
  /// Other maps of a level, in the middle of a run, or its first ones.
  void set_maps(std::size_t level, LevelMaps maps);

  /// Throws InputError where the level has no maps. Without a level any may be it.
  void initialize(const Pose2Gaussian& map_from_robot, std::optional<std::size_t> level);
  /// Anywhere on that level, or on any.
  void initialize_global(std::optional<std::size_t> level = std::nullopt);
  /// The robot may as well be on a level without maps: none is believed until tell_level(), or
  /// until a lift tells.
  void doubt_level();
  /// Somebody says on which level the robot is: its pose stays. Throws InputError as initialize.
  void tell_level(std::size_t level);

  /// The pose is ambiguous while the level is, but for one that stands in a lift. The result is
  /// overwritten by the next call. Costs what one Localizer costs where the level is known; in a
  /// search as many as there are levels; besides, O(levels^2 x beams) where several are possible.
  const LocalizationResult& update(const Observation& observation);

  /// Of the level that is likeliest; another one after an update that changed the level.
  [[nodiscard]] const std::shared_ptr<Localizer>& filter() const;
  [[nodiscard]] std::size_t level() const { return hypotheses_[choice_.leading()].level; }
  [[nodiscard]] bool is_level_sure() const { return is_sure_; }
  [[nodiscard]] bool is_in_lift() const { return lift_.has_value(); }
  /// The levels that are possible, the likeliest first.
  [[nodiscard]] std::vector<LevelBelief> beliefs() const;
  /// By how much the level is ahead [nats]; for experiments.
  [[nodiscard]] double lead_nats() const { return choice_.lead_nats(); }

 private:
  struct Hypothesis {
    std::size_t level = 0;
    Pose2 map_from_robot;
    std::shared_ptr<Localizer> filter;  ///< of the leading one, and of all in a search
  };
  [[nodiscard]] std::shared_ptr<Localizer> make_filter(std::size_t level) const;
  void require_maps(std::size_t level) const;
  void begin(std::vector<Hypothesis> hypotheses, bool is_search, bool is_sure);
  void follow(const Observation& observation);
  void look_for_lift();
  void weigh(const Observation& observation);
  [[nodiscard]] std::vector<PlaceCandidate> candidates_of(const Hypothesis& hypothesis) const;
  void take_leading(const Observation& observation, std::size_t before);
  void judge();
  void make_result();

  LocalizerConfig config_;
  LevelChoiceConfig choice_config_;
  std::vector<LevelMaps> levels_;
  std::vector<Lift> lifts_;
  std::uint64_t seed_;
  int threads_;
  mutable WorkerPool pool_;

  std::vector<Hypothesis> hypotheses_;  ///< one where the level is known
  LevelChoice choice_;
  bool is_search_ = false;
  bool is_sure_ = false;
  std::optional<std::size_t> lift_;  ///< that the robot stands in
  double since_lift_m_ = 0.0;
  std::optional<Observation> last_;  ///< without its scan's ranges
  std::optional<Stamp> weighed_;
  LocalizationResult result_;
};

}  // namespace strata::localization
