// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/simulated_maps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/beam_filter/beam_model.hpp"
#include "core/grid/count_scans.hpp"
#include "core/random/stream.hpp"
#include "core/scan/drop_outs.hpp"
#include "tools/simulate/truth.hpp"

namespace strata::experiments {
namespace {

constexpr double kMemory = 0.98;  // of one scan's error in the next
constexpr double kPrior = 0.9;
constexpr double kMinEvidence = 0.5;
constexpr int kTouchCells = 4;

std::set<std::size_t> states_of(const simulate::Simulation& simulation,
                                const simulate::ChangeableObject& object) {
  std::set<std::size_t> states;
  for (const auto& entry : simulate::timeline(simulation, object)) states.insert(entry.second);
  return states;
}

std::size_t likeliest(const std::vector<double>& membership) {
  const auto best = std::max_element(membership.begin(), membership.end());
  return static_cast<std::size_t>(best - membership.begin());
}

JointState joint_state(const simulate::Simulation& simulation,
                       const std::vector<const simulate::ChangeableObject*>& objects,
                       const patch::SequenceInfo& sequence) {
  JointState joint;
  for (const auto* object : objects) joint.push_back(state_during(simulation, *object, sequence));
  return joint;
}

/// One sub-map that covers changed objects.
void judge_submap(const simulate::Simulation& simulation, const patch::Submap& submap,
                  const std::vector<const simulate::ChangeableObject*>& objects,
                  Judgement& result) {
  const std::vector<JointState> meaning = meanings(simulation, submap, objects);
  std::set<JointState> told(meaning.begin(), meaning.end());
  told.erase(JointState{});
  std::set<JointState> occurred;
  for (const patch::SequenceInfo& sequence : submap.sequences) {
    const JointState joint = joint_state(simulation, objects, sequence);
    occurred.insert(joint);
    ++result.sequences;
    if (meaning[likeliest(sequence.membership)] == joint) ++result.right_sequences;
  }
  const int extra = static_cast<int>(submap.configurations.size()) - static_cast<int>(told.size());
  const int missing = static_cast<int>(occurred.size()) - static_cast<int>(told.size());
  result.extra_configurations += extra;
  result.missing_configurations += missing;
  if (extra == 0 && missing == 0) ++result.right_submaps;
}

}  // namespace

std::vector<PosedScan> noisy_scans(const simulate::Simulation& simulation, const PoseNoise& noise,
                                   std::uint64_t seed, int first_day, int last_day) {
  std::vector<PosedScan> scans;
  RandomStream random(seed, StreamId::kTest, 77);
  const double fresh = std::sqrt(1.0 - kMemory * kMemory);
  for (int day = first_day; day <= last_day; ++day) {
    double x = random.normal();
    double y = random.normal();
    double theta = random.normal();
    for (const auto& scan : simulation.days[static_cast<std::size_t>(day - 1)].scans) {
      x = kMemory * x + fresh * random.normal();
      y = kMemory * y + fresh * random.normal();
      theta = kMemory * theta + fresh * random.normal();
      const Pose2& truth = scan.map_from_robot;
      scans.push_back({scan.observation.run,
                       scan.observation.scan,
                       {truth.x + noise.stddev_m * x, truth.y + noise.stddev_m * y,
                        truth.theta + noise.stddev_rad * theta},
                       {}});
    }
  }
  WorkerPool pool(1);
  (void)find_drop_outs(scans, {}, pool);  // as SLAM does
  return scans;
}

StaticMaps static_maps(const std::vector<PosedScan>& scans) {
  WorkerPool pool(1);
  const CountingMap counts = count_scans(scans, 0.05, {}, BeamWeights::kAllStatic, pool);
  StaticMaps maps;
  maps.occupancy = counts.reflection(kMinEvidence);
  maps.filtered = make_reflection_grid(0.05, counts.cells().rect());
  for (std::size_t i = 0; i < counts.cells().size(); ++i) {
    maps.filtered.values()[i] = static_cast<float>(
        beam_filter::closed_form(counts.cells().get(counts.cells().cell(i)), kPrior, kMinEvidence));
  }
  return maps;
}

patch::PatchMap learn_patches(const std::vector<PosedScan>& scans, const ReflectionGrid& filtered,
                              const patch::PatchLearnerConfig& config) {
  patch::PatchLearner learner(config, 2);
  for (const PosedScan& scan : scans) learner.add(scan);
  return learner.finish(filtered);
}

bool covers(const patch::Submap& submap, double resolution_m,
            const simulate::ChangeableObject& object) {
  for (const auto& shape : object.shapes) {
    for (const simulate::Segment& segment : shape) {
      for (int i = 0; i <= 8; ++i) {
        const Cell cell = cell_at(segment.a + i / 8.0 * (segment.b - segment.a), resolution_m);
        for (int dy = -kTouchCells; dy <= kTouchCells; ++dy) {
          for (int dx = -kTouchCells; dx <= kTouchCells; ++dx) {
            if (submap.contradictory.get({cell.x + dx, cell.y + dy}) != 0) return true;
          }
        }
      }
    }
  }
  return false;
}

std::size_t state_during(const simulate::Simulation& simulation,
                         const simulate::ChangeableObject& object,
                         const patch::SequenceInfo& sequence) {
  const Duration half = Duration::from_seconds(0.5 * (sequence.end - sequence.begin).seconds());
  const Stamp middle = sequence.begin + half;
  const int day = sequence.run + 1;
  return object.state_at(day, (middle - simulate::stamp_at(simulation, day, 0.0)).seconds());
}

std::vector<const simulate::ChangeableObject*> covered_objects(
    const simulate::Simulation& simulation, const patch::Submap& submap, double resolution_m) {
  std::vector<const simulate::ChangeableObject*> objects;
  for (const simulate::ChangeableObject& object : simulation.objects) {
    if (states_of(simulation, object).size() > 1 && covers(submap, resolution_m, object)) {
      objects.push_back(&object);
    }
  }
  return objects;
}

std::vector<JointState> meanings(const simulate::Simulation& simulation,
                                 const patch::Submap& submap,
                                 const std::vector<const simulate::ChangeableObject*>& objects) {
  std::vector<std::map<JointState, int>> votes(submap.configurations.size());
  for (const patch::SequenceInfo& sequence : submap.sequences) {
    ++votes[likeliest(sequence.membership)][joint_state(simulation, objects, sequence)];
  }
  std::vector<JointState> meaning(votes.size());
  for (std::size_t k = 0; k < votes.size(); ++k) {
    int most = 0;
    for (const auto& [joint, count] : votes[k]) {
      if (count <= most) continue;
      most = count;
      meaning[k] = joint;
    }
  }
  return meaning;
}

Judgement& Judgement::operator+=(const Judgement& other) {
  changed_objects += other.changed_objects;
  found_objects += other.found_objects;
  submaps += other.submaps;
  false_submaps += other.false_submaps;
  right_submaps += other.right_submaps;
  extra_configurations += other.extra_configurations;
  missing_configurations += other.missing_configurations;
  sequences += other.sequences;
  right_sequences += other.right_sequences;
  return *this;
}

Judgement judge(const simulate::Simulation& simulation, const patch::PatchMap& map) {
  Judgement result;
  result.submaps = static_cast<int>(map.submaps.size());
  std::set<const simulate::ChangeableObject*> found;
  for (const patch::Submap& submap : map.submaps) {
    const auto objects = covered_objects(simulation, submap, map.base.resolution_m());
    found.insert(objects.begin(), objects.end());
    if (objects.empty()) {
      ++result.false_submaps;
    } else {
      judge_submap(simulation, submap, objects, result);
    }
  }
  for (const simulate::ChangeableObject& object : simulation.objects) {
    if (states_of(simulation, object).size() > 1) ++result.changed_objects;
  }
  result.found_objects = static_cast<int>(found.size());
  return result;
}

}  // namespace strata::experiments
