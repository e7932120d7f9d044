// SPDX-License-Identifier: Apache-2.0
#include "core/periodic/periodic_shares.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace strata::periodic {
namespace {

constexpr std::int64_t kHour_ns = 3'600'000'000'000;
constexpr std::int64_t kWeek_ns = kHoursAWeek * kHour_ns;

/// Rounded down, of negative ones too.
std::int64_t quotient(std::int64_t value, std::int64_t by) {
  return value / by - (value % by < 0 ? 1 : 0);
}

std::int64_t within_week_ns(Stamp stamp) {
  const std::int64_t rest = stamp.ns % kWeek_ns;
  return rest < 0 ? rest + kWeek_ns : rest;
}

bool are_finite(const std::vector<double>& values, std::size_t count) {
  return values.size() == count && std::all_of(values.begin(), values.end(),
                                               [](double value) { return std::isfinite(value); });
}

}  // namespace

double part_of_week(Stamp stamp) {
  return static_cast<double>(within_week_ns(stamp)) / static_cast<double>(kWeek_ns);
}

std::int64_t day_of(Stamp stamp) { return quotient(stamp.ns, 24 * kHour_ns); }

std::int64_t week_of_day(std::int64_t day) { return quotient(day, kDaysAWeek); }

int hour_of_week(Stamp stamp) { return static_cast<int>(within_week_ns(stamp) / kHour_ns); }

void shares_at(const PeriodicShares& periodic, double part_of_week, std::span<double> shares) {
  std::copy(periodic.logit.begin(), periodic.logit.end(), shares.begin());
  for (const Harmonic& wave : periodic.harmonics) {
    const double phase = 2.0 * std::numbers::pi * wave.cycles_a_week * part_of_week;
    const double cosine = std::cos(phase);
    const double sine = std::sin(phase);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      shares[k] += wave.cosine[k] * cosine + wave.sine[k] * sine;
    }
  }
  const double most = *std::max_element(shares.begin(), shares.end());
  double sum = 0.0;
  for (double& share : shares) sum += share = std::exp(share - most);
  for (double& share : shares) share /= sum;
}

bool is_sound(const PeriodicShares& periodic) {
  const std::size_t states = periodic.logit.size();
  return are_finite(periodic.logit, states) && (states > 0 || periodic.harmonics.empty()) &&
         std::all_of(periodic.harmonics.begin(), periodic.harmonics.end(), [&](const auto& wave) {
           return wave.cycles_a_week > 0 && wave.cycles_a_week <= kHoursAWeek &&
                  are_finite(wave.cosine, states) && are_finite(wave.sine, states);
         });
}

}  // namespace strata::periodic
