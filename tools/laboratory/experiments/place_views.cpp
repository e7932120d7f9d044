// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/place_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/error.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace strata::experiments {
namespace {

using memory::PolarBins;
using memory::VirtualScan;

constexpr std::size_t kLongestGap = 2;
constexpr std::size_t kFewestViews = 5;
/// Views of one state that show the other: more, and the bin has no state (seen past an edge).
constexpr double kOdd = 0.15;
constexpr double kPlaceSpacing_m = 0.5;

std::vector<float> medians(std::span<const VirtualScan> views, std::size_t bins) {
  std::vector<float> result;
  std::vector<float> seen;
  for (std::size_t a = 0; a < bins; ++a) {
    seen.clear();
    for (const VirtualScan& view : views) {
      if (!std::isnan(view[a])) seen.push_back(view[a]);
    }
    if (seen.size() < kFewestViews) {
      result.push_back(std::numeric_limits<float>::quiet_NaN());
      continue;
    }
    const auto middle = seen.begin() + static_cast<std::ptrdiff_t>((seen.size() - 1) / 2);
    std::nth_element(seen.begin(), middle, seen.end());
    result.push_back(*middle);
  }
  return result;
}

double within(float range_m, const PolarBins& bins) {
  return std::min(static_cast<double>(range_m), bins.max_range_m);
}

/// The longest run of marked bins around the circle, gaps of up to kLongestGap left out of it.
std::vector<std::size_t> longest_run(const std::vector<bool>& marked) {
  const std::size_t count = marked.size();
  std::vector<std::size_t> best;
  for (std::size_t begin = 0; begin < count; ++begin) {
    if (!marked[begin]) continue;
    std::vector<std::size_t> run;
    std::size_t gap = 0;
    for (std::size_t i = 0; i < count && gap <= kLongestGap; ++i) {
      const std::size_t bin = (begin + i) % count;
      gap = marked[bin] ? 0 : gap + 1;
      if (marked[bin]) run.push_back(bin);
    }
    if (run.size() > best.size()) best = std::move(run);
  }
  return best;
}

/// Share of the views that know the angle bin and show there what was seen after.
double share_showing(const TwoStates& states, std::span<const VirtualScan> views, std::size_t bin) {
  double known = 0.0;
  double shown = 0.0;
  for (const VirtualScan& view : views) {
    if (std::isnan(view[bin])) continue;
    known += 1.0;
    shown += states.shows_after(view[bin], bin) ? 1.0 : 0.0;
  }
  return shown / known;
}

void keep_whole_views(std::vector<VirtualScan>& views, std::span<const std::size_t> bins) {
  std::erase_if(views, [&](const VirtualScan& view) {
    const auto known = std::count_if(bins.begin(), bins.end(),
                                     [&](std::size_t bin) { return !std::isnan(view[bin]); });
    return 3 * static_cast<std::size_t>(known) < 2 * bins.size();
  });
}

}  // namespace

std::vector<PosedScan> posed_scans(const Occasion& occasion) {
  pipeline::RunsInput input;
  input.logs = {occasion.log};
  input.poses = {occasion.poses};
  input.from_s = occasion.from_s;
  input.to_s = occasion.to_s;
  pipeline::Runs runs = pipeline::read_runs(input, nullptr);
  std::vector<PosedScan> scans;
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    if (!runs.poses[i]) continue;
    Observation& observation = runs.observations[i];
    scans.push_back({observation.run, std::move(observation.scan), *runs.poses[i], {}});
  }
  return scans;
}

std::vector<VirtualScan> views_from(std::span<const PosedScan> scans, const Eigen::Vector2d& node_m,
                                    double radius_m, const PolarBins& bins, const Pose2& error) {
  memory::VirtualScanner scanner(bins, {});
  std::vector<VirtualScan> views;
  for (const PosedScan& scan : scans) {
    if ((scan.map_from_laser().translation() - node_m).norm() > radius_m) continue;
    PosedScan believed = scan;
    believed.map_from_robot = scan.map_from_robot * error;
    VirtualScan view;
    if (scanner.transform(believed, node_m, view)) views.push_back(std::move(view));
  }
  return views;
}

bool TwoStates::shows_after(float range_m, std::size_t angle_bin) const {
  // Infinite ranges lie beyond any median.
  constexpr float kFar_m = 1e6F;
  const auto off = [&](float median_m) {
    return std::abs(std::min(range_m, kFar_m) - std::min(median_m, kFar_m));
  };
  return off(after_m[angle_bin]) < off(before_m[angle_bin]);
}

double TwoStates::share_after(std::span<const float> range_m,
                              std::span<const std::size_t> which) const {
  const auto shown = std::count_if(which.begin(), which.end(),
                                   [&](std::size_t bin) { return shows_after(range_m[bin], bin); });
  return static_cast<double>(shown) / static_cast<double>(which.size());
}

TwoStates tell_apart(std::vector<VirtualScan> before, std::vector<VirtualScan> after,
                     const PolarBins& bins, double min_difference_m, bool all_bins) {
  TwoStates result{std::move(before), std::move(after), {}, {}, {}};
  const auto count = static_cast<std::size_t>(bins.angle_bins);
  if (result.before.size() < kFewestViews || result.after.size() < kFewestViews) return result;
  result.before_m = medians(result.before, count);
  result.after_m = medians(result.after, count);
  std::vector<bool> differs;
  for (std::size_t a = 0; a < count; ++a) {
    const double apart = within(result.before_m[a], bins) - within(result.after_m[a], bins);
    differs.push_back(std::abs(apart) > min_difference_m &&  // false for NaN
                      share_showing(result, result.before, a) <= kOdd &&
                      share_showing(result, result.after, a) >= 1.0 - kOdd);
  }
  if (all_bins) {
    for (std::size_t a = 0; a < count; ++a) {
      if (differs[a]) result.bins.push_back(a);
    }
    return result;
  }
  result.bins = longest_run(differs);
  keep_whole_views(result.before, result.bins);
  keep_whole_views(result.after, result.bins);
  if (std::min(result.before.size(), result.after.size()) < kFewestViews) result.bins.clear();
  return result;
}

void keep_bins_seen_as_often(TwoStates& states) {
  const auto known = [](std::span<const VirtualScan> views, std::size_t bin) {
    const auto count = std::count_if(views.begin(), views.end(), [bin](const VirtualScan& view) {
      return !std::isnan(view[bin]);
    });
    return static_cast<double>(count) / static_cast<double>(views.size());
  };
  std::erase_if(states.bins, [&](std::size_t bin) {
    return 3.0 * known(states.before, bin) < 2.0 * known(states.after, bin);
  });
}

const VirtualScan& draw(std::span<const VirtualScan> views, RandomStream& random) {
  return views[random.below(static_cast<std::uint32_t>(views.size()))];
}

ChangedPlace find_changed_place(std::span<const PosedScan> before, std::span<const PosedScan> after,
                                double radius_m, const PolarBins& bins, double min_difference_m) {
  std::vector<Eigen::Vector2d> tried;
  ChangedPlace best;
  for (const PosedScan& scan : after) {
    const Eigen::Vector2d node_m = scan.map_from_laser().translation();
    if (std::any_of(tried.begin(), tried.end(), [&](const Eigen::Vector2d& other) {
          return (other - node_m).norm() < kPlaceSpacing_m;
        })) {
      continue;
    }
    tried.push_back(node_m);
    TwoStates states =
        tell_apart(views_from(before, node_m, radius_m, bins),
                   views_from(after, node_m, radius_m, bins), bins, min_difference_m);
    if (states.bins.size() > best.states.bins.size()) best = {node_m, std::move(states)};
  }
  if (best.states.bins.empty()) {
    throw InputError("the two occasions", "show no place that changed", "choose others");
  }
  return best;
}

}  // namespace strata::experiments
