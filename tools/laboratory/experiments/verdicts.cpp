// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/verdicts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "core/base/error.hpp"
#include "core/localization/localizer.hpp"
#include "tools/laboratory/experiments/spliced_drive.hpp"

namespace strata::experiments {
namespace {

constexpr double kRight_m = 0.5;
constexpr double kWrong_m = 1.0;
constexpr int kSoon = 20;
constexpr int kAWhile = 10;
constexpr std::size_t kTracked = 150;
constexpr std::size_t kKidnapped = 150;
constexpr std::uint64_t kOffices = 10;

void count_tracked(const VerdictWorld& world, SplicedDrive splicer, VerdictCounts& counts) {
  const std::size_t begin = known_from(world, 0);
  if (begin == world.truths.size()) {
    throw InputError(world.name, "has no scan whose truth is known", "give poses of that time");
  }
  splicer.start(*world.truths[begin]);
  splicer.drive(begin, world.observations.size(), [&](const auto& result, double error_m, Stamp) {
    if (error_m >= kRight_m) return true;
    ++counts.scans;
    counts.doubtful += result.health.is_in_doubt ? 1 : 0;
    counts.lost += result.health.state == localization::HealthState::kLost ? 1 : 0;
    return true;
  });
}

void count_kidnapped(const VerdictWorld& world, SplicedDrive splicer, std::size_t from,
                     std::size_t to, VerdictCounts& counts) {
  splicer.start(*world.truths[from]);
  splicer.drive(from, from + kTracked, [](const auto&, double, Stamp) { return true; });
  int scans = 0;
  std::optional<int> doubtful;
  std::optional<int> lost;
  splicer.drive(to, to + kKidnapped, [&](const auto& result, double error_m, Stamp) {
    if (error_m < kWrong_m) return false;
    if (!doubtful && result.health.is_in_doubt) doubtful = scans;
    if (!lost && result.health.state == localization::HealthState::kLost) lost = scans;
    ++scans;
    return true;
  });
  if (scans < kAWhile) return;
  ++counts.kidnapped;
  counts.doubtful_soon += doubtful && *doubtful < kSoon ? 1 : 0;
  counts.lost_soon += lost && *lost < kSoon ? 1 : 0;
  counts.doubtful_ever += doubtful ? 1 : 0;
  counts.lost_ever += lost ? 1 : 0;
}

void print(const std::string& name, const VerdictCounts& c) {
  std::printf(
      "%s: right pose: doubtful %zu, lost %zu of %zu scans; kidnapped: doubtful within %d scans "
      "%zu, ever %zu, lost within %d scans %zu, ever %zu, of %zu\n",
      name.c_str(), c.doubtful, c.lost, c.scans, kSoon, c.doubtful_soon, c.doubtful_ever, kSoon,
      c.lost_soon, c.lost_ever, c.kidnapped);
  std::fflush(stdout);
}

constexpr const char* kModels[] = {"patch", "filtered", "field"};

void report(const VerdictWorld& world, int times, std::uint64_t seed) {
  for (const char* model : kModels) {
    print(world.name + ", " + model, count_verdicts(world, model, times, seed));
  }
}

}  // namespace

VerdictCounts& VerdictCounts::operator+=(const VerdictCounts& other) {
  for (std::size_t VerdictCounts::*count :
       {&VerdictCounts::scans, &VerdictCounts::doubtful, &VerdictCounts::lost,
        &VerdictCounts::kidnapped, &VerdictCounts::doubtful_soon, &VerdictCounts::lost_soon,
        &VerdictCounts::doubtful_ever, &VerdictCounts::lost_ever}) {
    this->*count += other.*count;
  }
  return *this;
}

VerdictCounts count_verdicts(const VerdictWorld& world, const std::string& model, int times,
                             std::uint64_t seed) {
  const auto sensor = sensor_of(world, model);
  VerdictCounts counts;
  count_tracked(world, SplicedDrive(world, sensor, seed), counts);
  const std::size_t n = world.observations.size();
  const auto parts = static_cast<std::size_t>(times);
  if (n <= kKidnapped) return counts;
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t from = known_from(world, k * n / parts);
    // Elsewhere, and not always as far along the drive.
    const std::size_t to = (from + 5 * n / 12 + 37 * k) % (n - kKidnapped);
    if (from + kTracked >= n) continue;
    count_kidnapped(world, SplicedDrive(world, sensor, seed + k + 1), from, to, counts);
  }
  return counts;
}

void report_verdicts(const std::filesystem::path& runs, const std::vector<std::string>& logs,
                     const std::vector<std::string>& poses, std::uint64_t seed) {
  for (std::size_t i = 0; i < logs.size(); ++i) report(world_of_log(logs[i], poses[i]), 10, seed);
  if (!runs.empty()) {
    for (const VerdictWorld& world : worlds_of_runs(runs)) report(world, 12, seed);
  }
  std::vector<VerdictWorld> offices;
  for (std::uint64_t n = 0; n < kOffices; ++n) offices.push_back(world_of_office(seed + n));
  for (const char* model : kModels) {
    VerdictCounts sum;
    for (const VerdictWorld& office : offices) sum += count_verdicts(office, model, 8, seed);
    print(std::string("ten random offices, ") + model, sum);
  }
}

}  // namespace strata::experiments
