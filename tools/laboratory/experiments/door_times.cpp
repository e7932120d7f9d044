// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/door_times.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <optional>
#include <vector>

#include "core/patch/chain_in_time.hpp"
#include "core/random/stream.hpp"

namespace strata::experiments {
namespace {

constexpr double kHour_s = 3600.0;
constexpr double kDay_s = 24.0 * kHour_s;
constexpr int kLearnedDays = 30;
constexpr int kDays = 60;
constexpr double kMisread = 0.05;

struct Door {
  bool has_hours = false;
  double opens_h = 0.0;
  double closes_h = 0.0;
  double follows = 0.0;
  int free_day = -1;  ///< closed on this day of the week and the next; -1: on none
  double share = 0.0;
  double mean_s = 0.0;  ///< between draws

  [[nodiscard]] double open_share(double t_s) const {
    if (!has_hours) return share;
    const auto day = static_cast<int>(t_s / kDay_s) % 7;
    const double hour = std::fmod(t_s, kDay_s) / kHour_s;
    const bool is_free = free_day >= 0 && (day == free_day || day == (free_day + 1) % 7);
    return !is_free && hour >= opens_h && hour < closes_h ? follows : 1.0 - follows;
  }
};

Door random_door(bool has_hours, RandomStream& random) {
  Door door;
  door.has_hours = has_hours;
  door.opens_h = random.uniform(6.0, 10.0);
  door.closes_h = random.uniform(15.0, 22.0);
  door.follows = random.uniform(0.85, 0.99);
  if (random.bernoulli(0.5)) door.free_day = static_cast<int>(random.below(7));
  door.share = random.uniform(0.03, 0.97);
  door.mean_s = 120.0 * std::pow(120.0, random.uniform());
  return door;
}

struct Look {
  double t_s = 0.0;
  bool is_open = false;
  bool is_first = false;
  std::vector<double> membership;
};

std::vector<Look> looks_at(const Door& door, RandomStream& random) {
  std::vector<double> hours(2 + random.below(11));
  for (double& hour : hours) hour = random.uniform(0.5, 23.0);
  std::sort(hours.begin(), hours.end());
  std::vector<Look> looks;
  bool is_open = random.bernoulli(door.open_share(0.0));
  double drawn_s = 0.0;
  for (int day = 0; day < kDays; ++day) {
    for (std::size_t h = 0; h < hours.size(); ++h) {
      const double t_s = kDay_s * day + kHour_s * hours[h] + random.uniform(0.0, 600.0);
      if (!looks.empty() && t_s <= looks.back().t_s + 60.0) continue;
      while (true) {
        const double next_s = drawn_s + random.exponential(1.0 / door.mean_s);
        if (next_s > t_s) break;  // forgets when the last draw was: gaps have no memory
        drawn_s = next_s;
        is_open = random.bernoulli(door.open_share(drawn_s));
      }
      drawn_s = t_s;
      const bool seen_open = random.bernoulli(kMisread) ? !is_open : is_open;
      looks.push_back(
          {t_s,
           is_open,
           h == 0,
           {seen_open ? kMisread : 1.0 - kMisread, seen_open ? 1.0 - kMisread : kMisread}});
    }
  }
  return looks;
}

double squared(double value) { return value * value; }

}  // namespace

DoorTimes door_times(std::uint64_t seed, bool has_hours) {
  RandomStream random(seed, StreamId::kTest, has_hours ? 1 : 0);
  const Door door = random_door(has_hours, random);
  const std::vector<Look> looks = looks_at(door, random);
  patch::SequenceHistory history;
  std::vector<std::vector<double>> memberships;
  std::size_t known = 0;
  for (; looks[known].t_s < kDay_s * kLearnedDays; ++known) {
    history.append(known == 0 ? 0.0 : looks[known].t_s - looks[known - 1].t_s,
                   Stamp::from_seconds(looks[known].t_s));
    memberships.push_back(looks[known].membership);
  }
  const patch::Chain chain = patch::learn_chain(memberships, history, {});
  const std::optional<patch::ChainInTime> in_time =
      patch::learn_chain_in_time(memberships, history, chain, {});
  DoorTimes sums;
  sums.doors = 1;
  sums.followed = in_time ? 1 : 0;
  std::vector<double> shares(2);
  for (std::size_t i = known; i < looks.size(); ++i) {
    if (!looks[i].is_first) continue;
    const auto foretold = [&](double rate_per_s, double usual) {
      const double kept = std::exp(-rate_per_s * (looks[i].t_s - looks[i - 1].t_s));
      return kept * looks[i - 1].membership[1] + (1.0 - kept) * usual;
    };
    const double truth = looks[i].is_open ? 1.0 : 0.0;
    const double constant = foretold(chain.rate_per_s, chain.usual[1]);
    double by_time = constant;
    if (in_time) {
      periodic::shares_at(in_time->usual, periodic::part_of_week(Stamp::from_seconds(looks[i].t_s)),
                          shares);
      by_time = foretold(in_time->rate_per_s, shares[1]);
    }
    sums.in_time += squared(by_time - truth);
    sums.constant += squared(constant - truth);
    sums.oracle += squared(foretold(1.0 / door.mean_s, door.open_share(looks[i].t_s)) - truth);
    ++sums.mornings;
  }
  return sums;
}

void report_door_times(std::uint64_t first_seed, int seeds) {
  for (const bool has_hours : {true, false}) {
    DoorTimes sum;
    for (int i = 0; i < seeds; ++i) {
      const DoorTimes one = door_times(first_seed + static_cast<std::uint64_t>(i), has_hours);
      sum.doors += one.doors;
      sum.followed += one.followed;
      sum.mornings += one.mornings;
      sum.in_time += one.in_time;
      sum.constant += one.constant;
      sum.oracle += one.oracle;
    }
    const double mornings = std::max(1, sum.mornings);
    std::cout << (has_hours ? "doors with opening hours: " : "doors without: ") << sum.followed
              << " of " << sum.doors << " follow the time; Brier score of the first look of a day "
              << sum.in_time / mornings << ", without the time " << sum.constant / mornings
              << ", with the true shares " << sum.oracle / mornings << "\n";
  }
}

}  // namespace strata::experiments
