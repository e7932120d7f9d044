// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/starts.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>

#include "tools/laboratory/experiments/spliced_drive.hpp"
#include "tools/laboratory/experiments/world_kinds.hpp"

namespace strata::experiments {
namespace {

constexpr int kStarts = 5;
constexpr std::size_t kScans = 300;
constexpr std::size_t kMinScansLeft = 100;  // of the drive, at a start
constexpr double kWrongPlace_m = 1.0;
constexpr double kWrongStart_m = 0.5;
constexpr double kHighScore = 0.9;
constexpr int kFirmly = 10;  // weighed scans on end

constexpr std::array<const char*, 2> kStartModels{"filtered", "patch"};
/// Each model without and with the search, as shards keep it.
using Rows = std::array<StartsOutcome, 2 * kStartModels.size()>;

StartsOutcome start_at(const VerdictWorld& world, SplicedDrive& drive, std::size_t from,
                       std::size_t scans) {
  StartsOutcome outcome;
  outcome.starts = 1.0;
  bool is_right = false;
  bool is_wrong = false;
  int wrong_on_end = 0;
  double right_since_s = 0.0;
  Stamp begin;
  drive.localizer().initialize_global(world.maps.filtered);
  drive.drive(from, from + scans, [&](const auto& result, double error_m, Stamp now) {
    if (outcome.scans == 0.0) begin = now;
    outcome.scans += 1.0;
    const bool was_right = is_right;
    is_right = is_sure(result) && error_m <= kWrongPlace_m;
    is_wrong = is_sure(result) && error_m > kWrongPlace_m;
    if (is_right && !was_right) right_since_s = (now - begin).seconds();
    wrong_on_end = is_wrong ? wrong_on_end + 1 : 0;
    if (wrong_on_end == kFirmly) outcome.ever_wrong = 1.0;
    if (result.score >= kHighScore) {
      outcome.high_scored += 1.0;
      outcome.high_scored_wrong += error_m > kWrongStart_m ? 1.0 : 0.0;
    }
    return true;
  });
  outcome.right = is_right ? 1.0 : 0.0;
  outcome.wrong = is_wrong ? 1.0 : 0.0;
  outcome.right_after_s = is_right ? right_since_s : 0.0;
  return outcome;
}

Rows rows_of(const VerdictWorld& world, int starts) {
  Rows rows{};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r] = start_anywhere(world, kStartModels[r / 2], r % 2 == 1, starts, kScans);
  }
  return rows;
}

void print(const std::string& name, const Rows& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const StartsOutcome& o = rows[i];
    std::printf(
        "%s, %s, %s: %.0f starts, right %.0f, wrong %.0f, unsure %.0f, once firmly wrong %.0f; "
        "right after %.1f s; score >= 0.9: %.0f of %.0f scans, %.2f%% wrong\n",
        name.c_str(), kStartModels[i / 2], i % 2 == 0 ? "particles anywhere" : "search", o.starts,
        o.right, o.wrong, o.starts - o.right - o.wrong, o.ever_wrong,
        o.right_after_s / std::max(1.0, o.right), o.high_scored, o.scans,
        100.0 * o.high_scored_wrong / std::max(1.0, o.high_scored));
  }
  std::fflush(stdout);
}

void report_world(const WorldKind& kind, const Seeds& seeds, shards::Units& units) {
  Rows sums{};
  for (int i = 0; i < seeds.count; ++i) {
    const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
    const std::string unit = kind.name + ", seed " + std::to_string(seed);
    const auto rows = units.of<Rows>(
        unit, [&] { return rows_of(world_of_scenario(unit, kind.scenario(seed), seed), kStarts); });
    for (std::size_t r = 0; r < rows.size(); ++r) sums[r] += rows[r];
  }
  print(kind.name, sums);
}

}  // namespace

StartsOutcome& StartsOutcome::operator+=(const StartsOutcome& other) {
  starts += other.starts;
  right += other.right;
  wrong += other.wrong;
  ever_wrong += other.ever_wrong;
  right_after_s += other.right_after_s;
  scans += other.scans;
  high_scored += other.high_scored;
  high_scored_wrong += other.high_scored_wrong;
  return *this;
}

StartsOutcome start_anywhere(const VerdictWorld& world, const std::string& model, bool has_search,
                             int starts, std::size_t scans) {
  localization::LocalizerConfig config = pipeline::CompareConfig{}.localizer;
  config.global_search.is_used = has_search;
  const auto sensor = sensor_of(world, model);
  const std::size_t n = world.observations.size();
  const std::size_t last = n > kMinScansLeft ? n - kMinScansLeft : 0;
  StartsOutcome sum;
  for (int i = 0; i < starts; ++i) {
    const auto at = static_cast<std::size_t>(i) * last / static_cast<std::size_t>(starts);
    const std::size_t from = known_from(world, at);
    if (from >= n) continue;
    SplicedDrive drive(world, sensor, static_cast<std::uint64_t>(i) + 1, config);
    sum += start_at(world, drive, from, scans);
  }
  return sum;
}

void report_starts(const std::string& scenarios, const Seeds& seeds, shards::Units& units) {
  for (const WorldKind& kind : kinds_of_worlds(scenarios)) report_world(kind, seeds, units);
}

void report_starts_of_logs(const std::vector<std::string>& logs,
                           const std::vector<std::string>& poses) {
  constexpr int kStartsOfLog = 40;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const VerdictWorld world = world_of_log(logs[i], poses[i]);
    print(world.name, rows_of(world, kStartsOfLog));
  }
}

}  // namespace strata::experiments
