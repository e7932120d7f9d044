// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/floor_plans.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "components/maps/map_model.hpp"
#include "core/geometry/angle.hpp"
#include "core/plan/plan_map.hpp"
#include "core/plan/plan_registration.hpp"
#include "tools/laboratory/experiments/drawn_plan.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/pipeline/localization_metrics.hpp"
#include "tools/pipeline/localize.hpp"
#include "tools/simulate/random_floor.hpp"
#include "tools/simulate/random_office.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {
namespace {

constexpr int kDrivenDays = 3;
constexpr double kGood_m = 0.05;
constexpr double kGood_deg = 0.3;
constexpr double kPlanCell_m = 0.05;

using Building = simulate::ScenarioConfig (*)(std::uint64_t);

simulate::ScenarioConfig office(std::uint64_t seed) {
  return simulate::random_office(seed, {kDrivenDays});
}
simulate::ScenarioConfig floor_of_rooms(std::uint64_t seed) {
  return simulate::random_floor(seed, {kDrivenDays});
}

bool is_right(const PlanOutcome& one) {
  return one.error_m <= kGood_m && one.error_deg <= kGood_deg;
}

const char* name_of(plan::PlanVerdict verdict) {
  constexpr std::array kNames{"good",        "nothing drawn", "nothing seen",
                              "fits poorly", "wrong scale",   "ambiguous"};
  return kNames.at(static_cast<std::size_t>(verdict));
}

void compare(const simulate::Simulation& building, const DrawnPlan& drawn,
             const plan::SiteFromPlan& found, PlanOutcome& outcome) {
  const plan::SiteFromPlan& truth = drawn.site_from_plan;
  double sum_m = 0.0;
  double ends = 0.0;
  for (const simulate::Segment& wall : building.walls) {
    for (const Eigen::Vector2d& at : {wall.a, wall.b}) {
      const Eigen::Vector2d in_plan = inverse(truth.pose) * at / truth.scale;
      const double off_m = (found * in_plan - at).norm();
      sum_m += off_m;
      ends += 1.0;
      outcome.worst_m = std::max(outcome.worst_m, off_m);
    }
  }
  outcome.error_m = sum_m / ends;
  outcome.error_deg =
      radians_to_degrees(std::abs(angle_difference(found.pose.theta, truth.pose.theta)));
  outcome.said_scale_error = std::abs(truth.scale - 1.0);
  outcome.scale_error = std::abs(found.scale / truth.scale - 1.0);
}

/// The last day in a map of the plan, whose frame is the site's as long as there is no map. The
/// robot measures in true metres, the plan says others.
void drive(const simulate::Simulation& building, const DrawnPlan& drawn, std::uint64_t seed,
           PlanOutcome& outcome) {
  maps::Maps maps;
  maps.filtered = plan::map_of_plan(drawn.drawing, {}, kPlanCell_m);
  maps.occupancy = maps.filtered;
  const maps::MapModel model = maps::make_likelihood_field_model(maps, "filtered", {});
  localization::LocalizerConfig config;
  config.global_search.watch.is_used = false;  // furniture that no plan has is no reason to search
  std::vector<Observation> observations;
  std::vector<std::optional<Pose2>> truths;
  const Pose2 plan_from_site = inverse(drawn.site_from_plan.pose);
  for (const simulate::SimulatedScan& scan : building.days.back().scans) {
    observations.push_back(scan.observation);
    Pose2 pose = plan_from_site * scan.map_from_robot;
    pose.x /= drawn.site_from_plan.scale;
    pose.y /= drawn.site_from_plan.scale;
    truths.emplace_back(pose);
  }
  const Eigen::Matrix3d start = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
  for (const bool is_searched : {false, true}) {
    pipeline::LocalizationStart from;
    if (!is_searched) from.map_from_robot = Pose2Gaussian{*truths.front(), start};
    const auto run = pipeline::localize(observations, truths, model, maps.filtered, config, from,
                                        seed, 1, nullptr);
    const pipeline::LocalizationMetrics metrics = pipeline::evaluate_run(run.errors);
    (is_searched ? outcome.searched_m : outcome.localized_m) = metrics.error_m.mean;
    (is_searched ? outcome.searched_lost : outcome.lost) = metrics.lost ? 1.0 : 0.0;
  }
}

void print(const std::string& unit, const PlanOutcome& one) {
  std::printf(
      "%s (walls %.2f m%s): %s, %.3f m (worst %.3f), %.3f degrees, scale %.2f%% of %.2f%% off; "
      "score %.2f (map %.2f, "
      "plan %.2f), rival %.2f, another building's %.2f; on the plan alone %.3f m%s, searched %.3f "
      "m%s\n",
      unit.c_str(), one.thick_m, one.is_cut > 0.0 ? ", a part" : "",
      name_of(static_cast<plan::PlanVerdict>(static_cast<int>(one.verdict))), one.error_m,
      one.worst_m, one.error_deg, 100.0 * one.scale_error, 100.0 * one.said_scale_error, one.score,
      one.map_share, one.plan_share, one.rival_score, one.foreign_score, one.localized_m,
      one.lost > 0.0 ? ", lost" : "", one.searched_m, one.searched_lost > 0.0 ? ", lost" : "");
  std::fflush(stdout);
}

/// Sums over the buildings of one kind.
void print_sums(const std::string& kind, const std::vector<PlanOutcome>& all) {
  const auto count = [&](const auto& holds) {
    return static_cast<int>(std::count_if(all.begin(), all.end(), holds));
  };
  const auto has = [](plan::PlanVerdict verdict) {
    return
        [verdict](const PlanOutcome& one) { return one.verdict == static_cast<double>(verdict); };
  };
  const auto is_good = has(plan::PlanVerdict::kGood);
  const auto mean = [&](double PlanOutcome::*part) {
    double sum = 0.0;
    for (const PlanOutcome& one : all) sum += one.*part;
    return all.empty() ? 0.0 : sum / static_cast<double>(all.size());
  };
  std::printf(
      "%s: of %zu plans %d taken and within 5 cm and 0.3 degrees, %d taken and not, %d ambiguous, "
      "%d refused for another reason; the best place was right for %d; plans of another building: "
      "%d taken; on the plan alone %.3f m in "
      "the mean, lost %.0f, searched %.3f m, lost %.0f\n",
      kind.c_str(), all.size(),
      count([&](const PlanOutcome& one) { return is_good(one) && is_right(one); }),
      count([&](const PlanOutcome& one) { return is_good(one) && !is_right(one); }),
      count(has(plan::PlanVerdict::kAmbiguous)), count([&](const PlanOutcome& one) {
        return !is_good(one) && !has(plan::PlanVerdict::kAmbiguous)(one);
      }),
      count(is_right), count([&](const PlanOutcome& one) {
        return one.foreign_verdict == static_cast<double>(plan::PlanVerdict::kGood);
      }),
      mean(&PlanOutcome::localized_m), mean(&PlanOutcome::lost) * static_cast<double>(all.size()),
      mean(&PlanOutcome::searched_m),
      mean(&PlanOutcome::searched_lost) * static_cast<double>(all.size()));
}

}  // namespace

PlanOutcome try_plan(const simulate::ScenarioConfig& scenario,
                     const simulate::ScenarioConfig& other, std::uint64_t seed) {
  const simulate::Simulation building = simulate::simulate(scenario, seed);
  const DrawnPlan drawn = draw_plan(building, seed);
  const ReflectionGrid map =
      static_maps(noisy_scans(building, kGoodPoses, seed, 1, scenario.days - 1)).filtered;
  const plan::PlanRegistration found = plan::register_plan(drawn.drawing, map);
  PlanOutcome outcome;
  outcome.verdict = static_cast<double>(found.verdict);
  outcome.thick_m = drawn.thick_m;
  outcome.is_cut = drawn.is_cut ? 1.0 : 0.0;
  outcome.score = found.best.score;
  outcome.map_share = found.best.map_share;
  outcome.plan_share = found.best.plan_share;
  outcome.rival_score = found.rival ? found.rival->score : 0.0;
  compare(building, drawn, found.best.site_from_plan, outcome);
  simulate::ScenarioConfig without_days = other;
  without_days.days = 1;
  const DrawnPlan foreign = draw_plan(simulate::simulate(without_days, seed), seed);
  const plan::PlanRegistration mistaken = plan::register_plan(foreign.drawing, map);
  outcome.foreign_verdict = static_cast<double>(mistaken.verdict);
  outcome.foreign_score = mistaken.best.score;
  drive(building, drawn, seed, outcome);
  return outcome;
}

void report_floor_plans(const Seeds& seeds, shards::Units& units) {
  const std::array<std::pair<const char*, Building>, 2> kinds{
      {{"office", office}, {"floor", floor_of_rooms}}};
  for (const auto& [kind, building] : kinds) {
    std::vector<PlanOutcome> all;
    for (int i = 0; i < seeds.count; ++i) {
      const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
      const std::string unit = std::string(kind) + " " + std::to_string(seed);
      const Building& one = building;
      all.push_back(
          units.of<PlanOutcome>(unit, [&] { return try_plan(one(seed), one(seed + 1000), seed); }));
      print(unit, all.back());
    }
    print_sums(kind, all);
  }
}

}  // namespace strata::experiments
