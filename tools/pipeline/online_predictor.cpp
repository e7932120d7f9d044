// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/online_predictor.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "tools/pipeline/known_pose_predictor.hpp"

namespace strata::pipeline {
namespace {

/// A grid that stays, or sub-maps that are believed.
class BeliefWatcher final : public OnlinePredictor {
 public:
  BeliefWatcher(const maps::Maps& maps, const maps::MapModel& model)
      : predictor_(model), states_(model.sensor->patch_states()) {
    const ReflectionGrid* grid = maps::grid_of(*model.descriptor, maps);
    if (grid != nullptr) map_ = std::make_shared<const ReflectionGrid>(*grid);
  }
  void go_to(const Pose2& map_from_robot, Stamp stamp) override {
    predictor_.go_to(map_from_robot, stamp);
  }
  maps::RangeFunction expected_range() override { return predictor_.expected_range(); }
  void learn(const Observation& observation, const Pose2& /*map_from_robot*/) override {
    predictor_.learn(observation.scan);
  }
  std::shared_ptr<const ReflectionGrid> map() override {
    if (states_ == nullptr) return map_;
    std::vector<int> chosen;
    for (const localization::SubmapBelief& belief : predictor_.beliefs()) {
      const auto best = std::max_element(belief.probability.begin(), belief.probability.end());
      chosen.push_back(static_cast<int>(best - belief.probability.begin()));
    }
    if (!map_ || chosen != chosen_) {
      map_ = std::make_shared<const ReflectionGrid>(patch::compose(states_->map(), chosen));
      chosen_ = std::move(chosen);
    }
    return map_;
  }

 private:
  KnownPosePredictor predictor_;
  const localization::PatchStates* states_;  // the predictor's model has them
  std::vector<int> chosen_;
  std::shared_ptr<const ReflectionGrid> map_;
};

/// Cells that most levels that know them expect to be occupied.
ReflectionGrid vote(const memory::NodeMap& nodes, double resolution_m) {
  std::vector<ReflectionGrid> levels;
  CellRect rect;
  for (std::size_t level = 0; level < nodes.level_names().size(); ++level) {
    levels.push_back(nodes.level_map(static_cast<int>(level), resolution_m));
    rect = rect.united(levels.back().rect());
  }
  ReflectionGrid map = make_reflection_grid(resolution_m, rect);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.cell(i);
    std::size_t known = 0;
    std::size_t occupied = 0;
    for (const ReflectionGrid& level : levels) {
      known += is_known(level.get(cell)) ? 1 : 0;
      occupied += is_occupied(level.get(cell)) ? 1 : 0;
    }
    if (known > 0) map.values()[i] = 2 * occupied > known ? 1.0F : 0.0F;
  }
  return map;
}

class MemoryWatcher final : public OnlinePredictor {
 public:
  MemoryWatcher(const maps::Maps& maps, const maps::MapModel& model,
                const patch_beams::PatchBeamModelConfig& sensor)
      : model_(model),
        sensor_(sensor),
        memory_(std::make_shared<memory::TimescaleMemory>(*maps.timescale)),
        resolution_m_(maps.filtered.resolution_m()) {
    now_.timescale = memory_;
    now_.decoding = maps.decoding;
    now_.timescale_use = maps.timescale_use;
    now_.filtered = maps.filtered;
    now_.filtered_caster = maps.filtered_caster;
  }
  void go_to(const Pose2& /*map_from_robot*/, Stamp /*stamp*/) override {}
  maps::RangeFunction expected_range() override {
    decode();
    return maps::make_map_model(now_, model_, sensor_).best_prediction({});
  }
  void learn(const Observation& observation, const Pose2& map_from_robot) override {
    if (model_.descriptor->learns != maps::MapLearning::kMemory) return;
    memory_->observe({observation.run, observation.scan, map_from_robot, {}});
    is_decoded_ = false;
  }
  std::shared_ptr<const ReflectionGrid> map() override {
    decode();
    if (map_ && mapped_ == now_.nodes) return map_;
    mapped_ = now_.nodes;
    const auto& names = now_.nodes->level_names();
    const auto level = std::find_if(names.begin(), names.end(), [&](const std::string& level_name) {
      return model_.name == model_.descriptor->name + level_name;
    });
    map_ = std::make_shared<const ReflectionGrid>(
        level == names.end()
            ? vote(*now_.nodes, resolution_m_)
            : now_.nodes->level_map(static_cast<int>(level - names.begin()), resolution_m_));
    return map_;
  }

 private:
  void decode() {
    if (!is_decoded_) now_.nodes = memory_->decode(now_.decoding, now_.nodes.get());
    is_decoded_ = true;
  }

  maps::MapModel model_;
  patch_beams::PatchBeamModelConfig sensor_;
  std::shared_ptr<memory::TimescaleMemory> memory_;
  double resolution_m_;
  maps::Maps now_;
  bool is_decoded_ = false;
  std::shared_ptr<const memory::NodeMap> mapped_;
  std::shared_ptr<const ReflectionGrid> map_;
};

}  // namespace

std::unique_ptr<OnlinePredictor> make_online_predictor(
    const maps::Maps& maps, const maps::MapModel& model,
    const patch_beams::PatchBeamModelConfig& sensor) {
  if (model.descriptor->needs_part(maps::MapPart::kTimescale) && maps.timescale) {
    return std::make_unique<MemoryWatcher>(maps, model, sensor);
  }
  return std::make_unique<BeliefWatcher>(maps, model);
}

}  // namespace strata::pipeline
