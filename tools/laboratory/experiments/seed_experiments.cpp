// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/seed_experiments.hpp"

#include <vector>

#include "tools/laboratory/experiments/among_people.hpp"
#include "tools/laboratory/experiments/few_beams.hpp"
#include "tools/laboratory/experiments/floor_plans.hpp"
#include "tools/laboratory/experiments/folded_maps.hpp"
#include "tools/laboratory/experiments/half_known.hpp"
#include "tools/laboratory/experiments/kidnapped.hpp"
#include "tools/laboratory/experiments/lift_rides.hpp"
#include "tools/laboratory/experiments/open_gates.hpp"
#include "tools/laboratory/experiments/patch_learning.hpp"
#include "tools/laboratory/experiments/patch_localization.hpp"
#include "tools/laboratory/experiments/refined_poses.hpp"
#include "tools/laboratory/experiments/standing_robot.hpp"
#include "tools/laboratory/experiments/starts.hpp"
#include "tools/laboratory/experiments/topology_odds.hpp"

namespace strata::experiments {
namespace {

std::string file(const SeedOptions& options, const char* name) {
  return options.scenarios + "/" + name;
}

}  // namespace

bool run_seed_experiment(const std::string& name, const SeedOptions& options,
                         shards::Units& units) {
  const Seeds& seeds = options.seeds;
  const PoseNoise& noise = options.noise;
  if (name == "people") {
    report_people(options.scenarios, seeds.first, seeds.count, units);
  } else if (name == "filter") {
    report_filter_against_none(options.scenarios, seeds.first, seeds.count, units);
  } else if (name == "few_beams") {
    report_few_beams(options.scenarios, seeds.first, seeds.count, units);
  } else if (name == "three_doors") {
    report_learning(name, seeds, units, [&](std::uint64_t seed) {
      return three_doors(file(options, "three_doors.yaml"), seed, noise);
    });
  } else if (name == "local_maps") {
    report_learning(name, seeds, units, [&](std::uint64_t seed) {
      return local_maps(file(options, "four_states.yaml"), seed, noise);
    });
  } else if (name == "few_visits" || name == "static_offices") {
    std::vector<int> all_days{2, 3, 4, 5};
    // With more the test for many visits decides.
    if (name == "static_offices") all_days.insert(all_days.end(), {8, 12, 16});
    for (const int days : all_days) {
      report_learning(name + ", " + std::to_string(days) + " days", seeds, units,
                      [&](std::uint64_t seed) {
                        return office_visits(seed, days, name == "few_visits", noise);
                      });
    }
  } else if (name == "standing_robot" || name == "standing_robot_online") {
    const auto one = name == "standing_robot" ? standing_robot : standing_robot_online;
    for (const int toggles : {4, 0}) {
      report_learning(name + ", door moved " + std::to_string(toggles) + " times", seeds, units,
                      [&](std::uint64_t seed) { return one(seed, toggles, noise); });
    }
  } else if (name == "box_in_corridor") {
    for (const int field_of_view_deg : {360, 180}) {
      report_localizing(
          name + ", " + std::to_string(field_of_view_deg) + " degrees,", seeds, units,
          [&](std::uint64_t seed) {
            return box_in_corridor(
                file(options, "corridor_box.yaml"), seed, field_of_view_deg,
                {"occupancy", "filtered", "patch_paper", "patch_shared", "patch", "own_day"});
          });
    }
  } else if (name == "global_start") {
    for (const bool is_open : {false, true}) {
      report_localizing(name + (is_open ? ", door open," : ", door closed,"), seeds, units,
                        [&](std::uint64_t seed) {
                          return global_start(file(options, "side_door.yaml"), seed, is_open,
                                              {"closed", "open", "patch", "patch_paper"});
                        });
    }
  } else if (name == "gates" || name == "glass") {
    const auto hall = name == "gates" ? hall_with_gate : hall_with_glass;
    report_learning(name, seeds, units,
                    [&](std::uint64_t seed) { return learn_hall(hall(seed), seed, noise); });
  } else if (name == "refined_poses") {
    report_refined_poses(options.scenarios, seeds, units);
  } else if (name == "folded_maps") {
    report_folded_maps(seeds, units);
  } else if (name == "floor_plans") {
    report_floor_plans(seeds, units);
  } else if (name == "half_known") {
    report_half_known(seeds, units);
  } else if (name == "starts") {
    report_starts(options.scenarios, seeds, units);
  } else if (name == "kidnapped") {
    report_kidnapped(options.scenarios, seeds, units);
  } else if (name == "lift_rides") {
    report_lift_rides(seeds, units);
  } else if (name == "topologies") {
    report_topologies(seeds, options.out, units);
  } else if (name == "offices") {
    for (std::uint64_t office = 1; office <= 10; ++office) {
      report_localizing("office " + std::to_string(office), seeds, units, [&](std::uint64_t seed) {
        return office_day(office, seed, {"occupancy", "filtered", "patch"});
      });
    }
  } else {
    return false;
  }
  return true;
}

}  // namespace strata::experiments
