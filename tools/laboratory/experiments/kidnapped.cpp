// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/kidnapped.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>

#include "core/base/error.hpp"
#include "tools/laboratory/experiments/spliced_drive.hpp"
#include "tools/laboratory/experiments/world_kinds.hpp"
#include "tools/pipeline/localization_metrics.hpp"

namespace strata::experiments {
namespace {

constexpr double kRight_m = pipeline::kFailureDistance_m;
constexpr double kWrong_m = 1.0;
constexpr double kSoon_s = 10.0;
constexpr double kMinCarried_m = 2.0;
constexpr int kFirmly = 10;  // weighed scans on end
constexpr std::size_t kTracked = 150;
constexpr std::size_t kAfter = 300;
constexpr int kTimes = 5;

constexpr std::array<const char*, 2> kModels{"filtered", "patch"};
/// Each model without and with the watch, as shards keep it.
using Rows = std::array<KidnappedOutcome, 2 * kModels.size()>;

void stay(const VerdictWorld& world, SplicedDrive drive, KidnappedOutcome& sum) {
  const std::size_t begin = known_from(world, 0);
  if (begin == world.truths.size()) {
    throw InputError(world.name, "has no scan whose truth is known", "give poses of that time");
  }
  drive.start(*world.truths[begin]);
  std::vector<pipeline::ScanError> errors;
  drive.drive(begin, world.observations.size(), [&](const auto& result, double error_m, Stamp now) {
    sum.scans += 1.0;
    sum.error_m += error_m;
    sum.off += error_m > kRight_m ? 1.0 : 0.0;
    sum.ambiguous += result.is_ambiguous ? 1.0 : 0.0;
    errors.push_back({now, error_m});
    return true;
  });
  sum.drives += 1.0;
  sum.lost_drives += pipeline::evaluate_run(errors).lost ? 1.0 : 0.0;
}

void carry(const VerdictWorld& world, SplicedDrive drive, std::size_t from, std::size_t to,
           KidnappedOutcome& sum) {
  drive.start(*world.truths[from]);
  drive.drive(from, from + kTracked, [](const auto&, double, Stamp) { return true; });
  std::optional<Stamp> begin;
  std::optional<double> right_since_s;
  int right_on_end = 0;
  int wrong_on_end = 0;
  bool is_found = false;
  bool is_sure_wrong = false;
  bool is_sure_right = false;
  double found_s = 0.0;
  drive.drive(to, to + kAfter, [&](const auto& result, double error_m, Stamp now) {
    if (!begin) begin = now;
    const double s = (now - *begin).seconds();
    right_on_end = error_m <= kRight_m ? right_on_end + 1 : 0;
    if (right_on_end == 1) right_since_s = s;
    if (right_on_end == kFirmly && !is_found) {
      is_found = true;
      found_s = *right_since_s;
    }
    is_sure_right = is_sure(result) && error_m <= kRight_m;
    wrong_on_end = s > kSoon_s && is_sure(result) && error_m > kWrong_m ? wrong_on_end + 1 : 0;
    is_sure_wrong |= wrong_on_end == kFirmly;
    return true;
  });
  sum.times += 1.0;
  if (is_found) {
    sum.found += 1.0;
    sum.found_after_s += found_s;
    sum.found_soon += found_s <= kSoon_s ? 1.0 : 0.0;
  }
  sum.sure += is_sure_right ? 1.0 : 0.0;
  sum.sure_wrong += is_sure_wrong ? 1.0 : 0.0;
}

Rows rows_of(const VerdictWorld& world, int times, std::uint64_t seed) {
  Rows rows{};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r] = carry_away(world, kModels[r / 2], r % 2 == 1, times, seed);
  }
  return rows;
}

void add(const Rows& more, Rows& sums) {
  for (std::size_t r = 0; r < sums.size(); ++r) sums[r] += more[r];
}

void print(const std::string& name, const Rows& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const KidnappedOutcome& o = rows[i];
    const double scans = std::max(1.0, o.scans);
    std::printf(
        "%s, %s, %s: carried away %.0f times, found %.0f, within 10 s %.0f, after %.1f s; sure in "
        "the end %.0f, once sure of a wrong place %.0f; not carried: lost %.0f of %.0f, mean %.3f "
        "m, off %.2f%%, ambiguous %.2f%%\n",
        name.c_str(), kModels[i / 2], i % 2 == 0 ? "tracked" : "watched", o.times, o.found,
        o.found_soon, o.found_after_s / std::max(1.0, o.found), o.sure, o.sure_wrong, o.lost_drives,
        o.drives, o.error_m / scans, 100.0 * o.off / scans, 100.0 * o.ambiguous / scans);
  }
  std::fflush(stdout);
}

}  // namespace

KidnappedOutcome& KidnappedOutcome::operator+=(const KidnappedOutcome& other) {
  for (double KidnappedOutcome::*part :
       {&KidnappedOutcome::times, &KidnappedOutcome::found, &KidnappedOutcome::found_soon,
        &KidnappedOutcome::found_after_s, &KidnappedOutcome::sure, &KidnappedOutcome::sure_wrong,
        &KidnappedOutcome::drives, &KidnappedOutcome::lost_drives, &KidnappedOutcome::scans,
        &KidnappedOutcome::error_m, &KidnappedOutcome::off, &KidnappedOutcome::ambiguous}) {
    this->*part += other.*part;
  }
  return *this;
}

KidnappedOutcome carry_away(const VerdictWorld& world, const std::string& model, bool watches,
                            int times, std::uint64_t seed) {
  localization::LocalizerConfig config = pipeline::CompareConfig{}.localizer;
  config.global_search.watch.is_used = watches;
  const auto sensor = sensor_of(world, model);
  const auto make = [&](std::uint64_t s) {
    SplicedDrive drive(world, sensor, s, config);
    drive.localizer().set_free_space(world.maps.filtered);
    return drive;
  };
  KidnappedOutcome sum;
  stay(world, make(seed), sum);
  const std::size_t n = world.observations.size();
  if (n <= kAfter) return sum;
  const auto parts = static_cast<std::size_t>(times);
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t from = known_from(world, k * n / parts);
    // Elsewhere, and not always as far along the drive.
    const std::size_t to = known_from(world, (from + 5 * n / 12 + 37 * k) % (n - kAfter));
    const std::size_t left = from + kTracked;
    if (left >= n || to >= n || !world.truths[left]) continue;
    if (translation_distance(*world.truths[left], *world.truths[to]) < kMinCarried_m) continue;
    carry(world, make(seed + k + 1), from, to, sum);
  }
  return sum;
}

void report_kidnapped(const std::string& scenarios, const Seeds& seeds, shards::Units& units) {
  for (const WorldKind& kind : kinds_of_worlds(scenarios)) {
    Rows sums{};
    for (int i = 0; i < seeds.count; ++i) {
      const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
      const std::string unit = kind.name + ", seed " + std::to_string(seed);
      add(units.of<Rows>(unit,
                         [&] {
                           return rows_of(world_of_scenario(unit, kind.scenario(seed), seed),
                                          kTimes, seed);
                         }),
          sums);
    }
    print(kind.name, sums);
  }
}

void report_kidnapped_logs(const std::vector<std::string>& logs,
                           const std::vector<std::string>& poses, const Seeds& seeds) {
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const VerdictWorld world = world_of_log(logs[i], poses[i]);
    Rows sums{};
    for (int s = 0; s < seeds.count; ++s) {
      add(rows_of(world, kTimes, seeds.first + static_cast<std::uint64_t>(s) * kTimes), sums);
    }
    print(world.name, sums);
  }
}

}  // namespace strata::experiments
