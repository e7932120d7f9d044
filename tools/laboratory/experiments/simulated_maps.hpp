// SPDX-License-Identifier: Apache-2.0
/// Maps learned from a simulation at its true poses with errors put on top.
#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/reflection_grid.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/scan/scan.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {

/// Errors of the poses that maps are learned at: they wander with a memory of about 50 scans, and
/// begin anew each day. Standard deviations.
struct PoseNoise {
  double stddev_m = 0.0;
  double stddev_rad = 0.0;
};

/// 2 cm and 0.3 degrees, what SLAM leaves in a good building.
inline constexpr PoseNoise kGoodPoses{0.02, 0.3 * 3.14159265358979 / 180.0};
/// 5 cm and 1 degree.
inline constexpr PoseNoise kPoorPoses{0.05, 1.0 * 3.14159265358979 / 180.0};

/// The scans of the days [first_day, last_day] (from 1) at noisy poses, in order.
[[nodiscard]] std::vector<PosedScan> noisy_scans(const simulate::Simulation& simulation,
                                                 const PoseNoise& noise, std::uint64_t seed,
                                                 int first_day, int last_day);

/// The occupancy map (all beams count) and the beam-filtered map at fixed poses.
struct StaticMaps {
  ReflectionGrid occupancy;
  ReflectionGrid filtered;
};
[[nodiscard]] StaticMaps static_maps(const std::vector<PosedScan>& scans);

/// The patch map of the scans over the filtered map.
[[nodiscard]] patch::PatchMap learn_patches(const std::vector<PosedScan>& scans,
                                            const ReflectionGrid& filtered,
                                            const patch::PatchLearnerConfig& config = {});

/// Whether an object, in any state that it takes in the simulation, touches the sub-map's
/// contradictory cells (within 0.2 m).
[[nodiscard]] bool covers(const patch::Submap& submap, double resolution_m,
                          const simulate::ChangeableObject& object);

/// The state of an object in the middle of a sequence.
[[nodiscard]] std::size_t state_during(const simulate::Simulation& simulation,
                                       const simulate::ChangeableObject& object,
                                       const patch::SequenceInfo& sequence);

/// States of the objects that a sub-map covers, one an object.
using JointState = std::vector<std::size_t>;
/// The objects that change and that the sub-map covers.
[[nodiscard]] std::vector<const simulate::ChangeableObject*> covered_objects(
    const simulate::Simulation& simulation, const patch::Submap& submap, double resolution_m);
/// What each configuration stands for: the joint state that was true in most of the sequences that
/// chose it; empty for one that none chose.
[[nodiscard]] std::vector<JointState> meanings(
    const simulate::Simulation& simulation, const patch::Submap& submap,
    const std::vector<const simulate::ChangeableObject*>& objects);

/// What a patch map says about the objects of a world, against the truth.
struct Judgement {
  int changed_objects = 0;  ///< seen in more than one state
  int found_objects = 0;    ///< of those, covered by a sub-map
  int submaps = 0;          ///< learned
  int false_submaps = 0;    ///< cover no changed object
  int right_submaps = 0;    ///< one configuration a joint state of their objects, none extra
  int extra_configurations = 0;
  int missing_configurations = 0;
  int sequences = 0;        ///< of the true sub-maps
  int right_sequences = 0;  ///< whose configuration stands mainly for the state that was true

  Judgement& operator+=(const Judgement& other);
};
[[nodiscard]] Judgement judge(const simulate::Simulation& simulation, const patch::PatchMap& map);

}  // namespace strata::experiments
