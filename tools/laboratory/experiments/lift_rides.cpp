// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/lift_rides.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "components/maps/map_model.hpp"
#include "core/random/stream.hpp"
#include "tools/pipeline/compare_config.hpp"

namespace strata::experiments {
namespace {

constexpr double kDifferentShare = 0.05;
constexpr double kSoonAfterRide_s = 3.0;
constexpr double kOut_m = 0.6;  // in front of the lift
constexpr int kRides = 10;
constexpr std::array<const char*, 2> kRideModels{"filtered", "patch"};

using RideRows = std::array<RidesOutcome, 2 * kRideModels.size()>;  // rides and starts of each

std::unique_ptr<localization::LevelLocalizer> localizer_of(const LiftBuilding& building,
                                                           const std::string& model,
                                                           std::uint64_t seed) {
  std::vector<localization::LevelMaps> levels;
  for (const LiftFloor& floor : building.floors) {
    levels.push_back(
        {maps::make_map_model(floor.maps, model, pipeline::CompareConfig{}.sensor).sensor,
         std::make_shared<const ReflectionGrid>(floor.maps.filtered)});
  }
  auto localizer = std::make_unique<localization::LevelLocalizer>(
      pipeline::CompareConfig{}.localizer, localization::LevelChoiceConfig{}, std::move(levels),
      seed);
  localizer->set_lifts({lift_of(building)});
  return localizer;
}

bool has_twin(const LiftBuilding& building, std::size_t level) {
  for (std::size_t other = 0; other < building.floors.size(); ++other) {
    if (other != level && building.are_twins(level, other)) return true;
  }
  return false;
}

/// Follows a ride's scans from `first` on.
RidesOutcome follow(localization::LevelLocalizer& localizer, const Ride& ride, std::size_t first,
                    bool is_start, bool has_twin) {
  static const bool is_verbose = std::getenv("STRATA_RIDES_VERBOSE") != nullptr;
  std::optional<double> differ_s;
  double right_s = 0.0;
  bool was_right = false;
  std::size_t wrong = 0;
  bool is_sure = false;
  bool is_right = false;
  double error_m = 0.0;
  for (std::size_t i = first; i < ride.scans.size(); ++i) {
    const RideScan& scan = ride.scans[i];
    const double s = scan.observation.scan.stamp.seconds();
    const auto& result = localizer.update(scan.observation);
    if (is_verbose) {
      std::printf(
          "%.1f true %zu told %zu%s lead %.2f score %.2f differ %.2f opening %d lift %d "
          "ambiguous %d off %.2f\n",
          s, scan.level, localizer.level(), localizer.is_level_sure() ? " sure" : "",
          localizer.lead_nats(), result.score, scan.least_difference, scan.is_opening,
          localizer.is_in_lift(), result.is_ambiguous,
          translation_distance(result.pose.mean, scan.truth));
    }
    is_sure = localizer.is_level_sure() && (!is_start || !result.is_ambiguous);
    is_right = localizer.level() == scan.level;
    if (is_sure && !is_right) ++wrong;
    if (!scan.is_opening) continue;
    if (!differ_s && scan.least_difference >= kDifferentShare) differ_s = s;
    error_m = translation_distance(result.pose.mean, scan.truth);
    if (is_sure && is_right && !was_right) right_s = s;
    was_right = is_sure && is_right;
  }
  if (is_verbose) {
    std::printf("= %zu to %zu%s%s: end %s %s, wrong %zu\n", ride.from, ride.to,
                is_start ? " start" : "", has_twin ? " twin" : "", is_sure ? "sure" : "unsure",
                is_right ? "right" : "wrong", wrong);
  }
  RidesOutcome outcome;
  outcome.rides = 1.0;
  outcome.end_wrong = is_sure && !is_right ? 1.0 : 0.0;
  outcome.ever_wrong = wrong > 0 ? 1.0 : 0.0;
  outcome.wrong_scans = static_cast<double>(wrong);
  if (!differ_s || has_twin) {
    outcome.untold = is_sure ? 0.0 : 1.0;
    outcome.guessed = is_sure && is_right ? 1.0 : 0.0;
    return outcome;
  }
  outcome.tellable = 1.0;
  if (!was_right) return outcome;
  outcome.right = 1.0;
  outcome.error_m = error_m;
  outcome.slowest_s = outcome.after_s = std::max(0.0, right_s - *differ_s);
  outcome.soon = outcome.after_s <= kSoonAfterRide_s ? 1.0 : 0.0;
  return outcome;
}

void print(const char* what, const char* model, const RidesOutcome& o) {
  const double right = std::max(1.0, o.right);
  std::printf(
      "%s, %s: %.0f, tellable %.0f, right %.0f, within 3 s %.0f, after %.2f s, slowest %.2f s, "
      "error %.3f m; not tellable and told so %.0f, right all the same %.0f; sure of a wrong level "
      "at the end %.0f, ever %.0f (%.0f scans)\n",
      what, model, o.rides, o.tellable, o.right, o.soon, o.after_s / right, o.slowest_s,
      o.error_m / right, o.untold, o.guessed, o.end_wrong, o.ever_wrong, o.wrong_scans);
}

RideRows rows_of(std::uint64_t seed) {
  const LiftBuilding building = lift_building(seed);
  const std::size_t count = building.floors.size();
  RideRows rows{};
  for (std::size_t m = 0; m < kRideModels.size(); ++m) {
    RandomStream random(seed, StreamId::kTest, 7);
    for (int i = 0; i < kRides; ++i) {
      const std::size_t from = random.below(static_cast<std::uint32_t>(count));
      const std::size_t by =
          i % 5 == 4 ? 0 : 1 + random.below(static_cast<std::uint32_t>(count - 1));
      const std::uint64_t own = 1000 * seed + static_cast<std::uint64_t>(i);
      rows[2 * m] += one_ride(building, kRideModels[m], from, (from + by) % count, own);
      rows[2 * m + 1] += one_start(building, kRideModels[m], from, own);
    }
  }
  return rows;
}

}  // namespace

RidesOutcome& RidesOutcome::operator+=(const RidesOutcome& other) {
  const double slowest = std::max(slowest_s, other.slowest_s);
  for (double RidesOutcome::*part :
       {&RidesOutcome::rides, &RidesOutcome::tellable, &RidesOutcome::right, &RidesOutcome::soon,
        &RidesOutcome::after_s, &RidesOutcome::untold, &RidesOutcome::guessed,
        &RidesOutcome::end_wrong, &RidesOutcome::ever_wrong, &RidesOutcome::wrong_scans,
        &RidesOutcome::error_m}) {
    this->*part += other.*part;
  }
  slowest_s = slowest;
  return *this;
}

RidesOutcome one_ride(const LiftBuilding& building, const std::string& model, std::size_t from,
                      std::size_t to, std::uint64_t seed) {
  const Ride driven = ride(building, from, to, seed);
  const auto localizer = localizer_of(building, model, seed);
  localizer->initialize({driven.scans.front().truth, pose_covariance(0.1, 0.05)}, from);
  return follow(*localizer, driven, 0, false, has_twin(building, to));
}

RidesOutcome one_start(const LiftBuilding& building, const std::string& model, std::size_t level,
                       std::uint64_t seed) {
  const Ride driven = ride(building, level, level, seed);
  const auto localizer = localizer_of(building, model, seed);
  localizer->initialize_global();
  std::size_t first = 0;
  while (!driven.scans[first].is_opening || driven.scans[first].truth.y < kOut_m) ++first;
  return follow(*localizer, driven, first, true, has_twin(building, level));
}

void report_lift_rides(const Seeds& seeds, shards::Units& units) {
  RideRows sums{};
  for (int i = 0; i < seeds.count; ++i) {
    const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
    const RideRows rows =
        units.of<RideRows>("building " + std::to_string(seed), [&] { return rows_of(seed); });
    for (std::size_t r = 0; r < rows.size(); ++r) sums[r] += rows[r];
  }
  if (!units.is_whole()) return;
  for (std::size_t r = 0; r < sums.size(); ++r) {
    print(r % 2 == 0 ? "rides" : "starts", kRideModels[r / 2], sums[r]);
  }
}

}  // namespace strata::experiments
