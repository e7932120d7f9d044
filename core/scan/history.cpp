// SPDX-License-Identifier: Apache-2.0
#include "core/scan/history.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/random/stream.hpp"

namespace strata {
namespace {

constexpr double kSecondsADay = 86'400.0;
constexpr int kHeadings = 4;

using HeadedPlace = std::tuple<std::int64_t, std::int64_t, int>;  // square and quarter
using Pass = std::pair<int, std::int64_t>;                        // run, negative, and span

HeadedPlace place_of(const Pose2& pose, double place_m) {
  const double quarter = std::floor(pose.theta * kHeadings / (2.0 * std::numbers::pi) + 0.5);
  const int heading = static_cast<int>(std::fmod(quarter, kHeadings) + kHeadings) % kHeadings;
  return {static_cast<std::int64_t>(std::floor(pose.x / place_m)),
          static_cast<std::int64_t>(std::floor(pose.y / place_m)), heading};
}

/// Smallest first: of weights 2^(age / -half-life) the draws -ln(u) / weight, as their logarithm,
/// less what all share.
double draw_of(const Pass& pass, const HistoryConfig& config) {
  RandomStream random(0, StreamId::kHistory, static_cast<std::uint64_t>(pass.second));
  const double days = static_cast<double>(pass.second) * config.pass_s / kSecondsADay;
  return std::log(random.exponential(1.0)) - days * std::numbers::ln2 / config.half_life_days;
}

}  // namespace

std::vector<bool> scans_to_keep(std::span<const PosedScan> scans, int first_new_run,
                                const HistoryConfig& config) {
  std::vector<bool> keeps(scans.size(), true);
  if (config.passes_per_place == 0) return keeps;
  std::map<HeadedPlace, std::map<Pass, std::vector<std::size_t>>> places;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (scans[i].run >= first_new_run) continue;
    const double span = std::floor(scans[i].scan.stamp.seconds() / config.pass_s);
    places[place_of(scans[i].map_from_robot, config.place_m)]
          [{-scans[i].run, static_cast<std::int64_t>(span)}]
              .push_back(i);
  }
  const auto kept = static_cast<std::size_t>(config.passes_per_place);
  for (const auto& [place, passes] : places) {
    if (passes.size() <= kept) continue;
    std::vector<std::tuple<double, Pass>> draws;
    for (const auto& [pass, members] : passes) draws.emplace_back(draw_of(pass, config), pass);
    std::sort(draws.begin(), draws.end());
    for (std::size_t d = kept; d < draws.size(); ++d) {
      for (const std::size_t i : passes.at(std::get<Pass>(draws[d]))) keeps[i] = false;
    }
  }
  return keeps;
}

}  // namespace strata
