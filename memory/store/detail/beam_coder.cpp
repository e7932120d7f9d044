// SPDX-License-Identifier: Apache-2.0
#include "memory/store/detail/beam_coder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "core/scan/range_limit.hpp"

namespace strata::memory::detail {
namespace {

constexpr int kLeast_cm = 6;        ///< nearer surfaces are the robot's own
constexpr int kMost_cm = 6000;      ///< further ones are told by value
constexpr double kSlack_cm = 30.0;  ///< at most between a beam and those beside it
constexpr std::int64_t kNear = 8;   ///< steps within which a value goes on from those before
constexpr std::uint32_t kReaches = 16;

/// How far, in 16 classes.
std::uint32_t reach_of(const RayAhead& ahead) {
  constexpr int kClass_cm = 100;
  if (ahead.first_cm == kNothing_cm) return kReaches - 1;
  return static_cast<std::uint32_t>(std::min(ahead.first_cm / kClass_cm, 14));
}

/// In which of the classes that these limits part, from 0 on.
template <std::size_t n>
std::uint32_t class_of(int value, const std::array<int, n>& limits) {
  return static_cast<std::uint32_t>(std::upper_bound(limits.begin(), limits.end(), value) -
                                    limits.begin());
}

int step_between(const RayAhead& a, const RayAhead& b) {
  constexpr int kEdge_cm = 900;
  if (a.first_cm == kNothing_cm || b.first_cm == kNothing_cm) return kEdge_cm;
  return std::abs(a.first_cm - b.first_cm);
}

float metres(std::int64_t range_cm) {
  return static_cast<float>(static_cast<double>(range_cm) / 100.0);
}

}  // namespace

/// What a beam measured; nothing where one reads.
struct BeamCoder::Wish {
  BeamKind kind = BeamKind::kInvalid;
  double range_cm = 0.0;
};

BeamCoder::BeamCoder(BitCoder& bits, const ReflectionGrid& map, double tolerance_m)
    : bits_(bits),
      map_(map),
      tolerance_cm_(100.0 * tolerance_m),
      step_cm_(std::max(1, static_cast<int>(std::lround(100.0 * map.resolution_m())))),
      first_({36, 6 * 5 * 4, kReaches * 6 * 6, 4 * 6 * 6, 7 * 36, 7 * 36 * 8, 6 * 5 * kReaches},
             kTold),
      second_({6, 36 * 6, kReaches * 5}),
      no_return_({6, 36 * kReaches, 7 * 6}),
      says_nothing_({6, 36}),
      too_close_({6}),
      shorter_({6, kReaches * 6, 6 * 4}),
      goes_on_({3, 3 * 20, 7 * 3}),
      change_(18),
      jump_(2 * kReaches) {}

/// What the scanner measures, strictly within: a range that is read is one that it measures.
void BeamCoder::set_limits(const Scan& scan) {
  // Of format 2 for ever; as range_limit_m() has it.
  constexpr float kLongest_m = 1000.0F;
  const bool is_told = scan.range_max_m > 0.0F && scan.range_max_m < kLongest_m;
  const double most_cm = 100.0 * static_cast<double>(is_told ? scan.range_max_m : kLongest_m);
  double least_cm = 100.0 * static_cast<double>(scan.range_min_m);
  if (!(least_cm > 0.0)) least_cm = 0.0;
  least_cm = std::min(least_cm, most_cm);
  least_cm_ = std::max(kLeast_cm, static_cast<int>(least_cm) + 1);
  most_cm_ = std::min(kMost_cm, static_cast<int>(most_cm) - 1);
  least_value_ = static_cast<std::int64_t>(least_cm / step_cm_) + 1;
  most_value_ = static_cast<std::int64_t>(std::ceil(most_cm / step_cm_)) - 1;
}

void BeamCoder::look(const PosedScan& posed) {
  const Scan& scan = posed.scan;
  const Pose2& robot = posed.map_from_robot;
  const PlainDirection heading = plain_direction(robot.theta);
  const Pose2& laser = scan.robot_from_laser;
  const Eigen::Vector2d from_m{robot.x + heading.cosine * laser.x - heading.sine * laser.y,
                               robot.y + heading.sine * laser.x + heading.cosine * laser.y};
  const double turn_rad = robot.theta + laser.theta;
  set_limits(scan);
  rays_.resize(scan.size());
  ahead_.resize(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    rays_[i] = {from_m, plain_direction(turn_rad + scan.bearing_rad(i)), least_cm_, most_cm_};
    ahead_[i] = most_cm_ > least_cm_ ? map_.look(rays_[i]) : RayAhead{};
    if (ahead_[i].first_cm > most_cm_) ahead_[i] = {};
    if (ahead_[i].second_cm > most_cm_) ahead_[i].second_cm = kNothing_cm;
  }
}

bool BeamCoder::fits(const Wish& wish, std::size_t beam, int RayAhead::*surface_cm) const {
  const int expected_cm = ahead_[beam].*surface_cm;
  if (expected_cm == kNothing_cm) return wish.kind == BeamKind::kNoReturn;
  if (wish.kind != BeamKind::kHit) return false;
  double low_cm = expected_cm;
  double high_cm = expected_cm;
  const auto widen = [&](std::size_t other) {
    const int other_cm = ahead_[other].*surface_cm;
    if (other_cm == kNothing_cm) return;
    const double slack_cm = std::clamp<double>(other_cm - expected_cm, -kSlack_cm, kSlack_cm);
    low_cm = std::min(low_cm, expected_cm + slack_cm);
    high_cm = std::max(high_cm, expected_cm + slack_cm);
  };
  if (beam > 0) widen(beam - 1);
  if (beam + 1 < ahead_.size()) widen(beam + 1);
  return wish.range_cm >= low_cm - tolerance_cm_ && wish.range_cm <= high_cm + tolerance_cm_;
}

/// Of the beam of the scan before that pointed the same way: how it was told, from 1 on; 0: none.
std::uint32_t BeamCoder::told_there_before(const PosedScan& posed, std::size_t beam) const {
  const double turned =
      std::remainder(posed.map_from_robot.theta - heading_before_rad_, 2.0 * std::numbers::pi) /
      static_cast<double>(posed.scan.angle_increment_rad);
  if (!(std::abs(turned) < 1e6)) return 0;
  const std::int64_t other = static_cast<std::int64_t>(beam) + std::lround(turned);
  if (other < 0 || other >= static_cast<std::int64_t>(told_before_.size())) return 0;
  return 1 + static_cast<std::uint32_t>(told_before_[static_cast<std::size_t>(other)]);
}

BeamCoder::Told BeamCoder::code_told(const PosedScan& posed, std::size_t beam, const Wish& wish,
                                     const Before& before) {
  constexpr std::array<int, 4> kSlopes_cm{3, 8, 20, 50};
  constexpr std::array<int, 3> kUnknown{1, 5, 30};
  const RayAhead& ahead = ahead_[beam];
  const int back_cm = beam > 0 ? step_between(ahead, ahead_[beam - 1]) : 900;
  const int on_cm = beam + 1 < ahead_.size() ? step_between(ahead, ahead_[beam + 1]) : 0;
  const std::uint32_t slope = class_of(std::max(beam > 0 ? back_cm : 0, on_cm), kSlopes_cm);
  const auto jump = static_cast<std::uint32_t>(std::min(back_cm / 30, 3));
  const std::uint32_t reach = reach_of(ahead);
  const std::uint32_t unknown = class_of(ahead.unknown, kUnknown);
  const auto certainty = static_cast<std::uint32_t>(ahead.certainty);
  const std::uint32_t last = before.last;
  const std::uint32_t two = last * 6 + before.second_last;
  const std::uint32_t there = told_there_before(posed, beam);
  const std::array<std::uint32_t, 7> of_first{
      two,
      (last * 5 + slope) * 4 + jump,
      (reach * 6 + certainty) * 6 + last,
      (unknown * 6 + certainty) * 6 + last,
      there * 36 + two,
      ((there * 36 + two) * 2 + (slope > 2 ? 1 : 0)) * 4 + unknown,
      (certainty * 5 + slope) * kReaches + reach};
  if (bits_.code(first_, of_first, fits(wish, beam, &RayAhead::first_cm), last)) {
    return Told::kFirst;
  }
  if (ahead.second_cm != kNothing_cm) {
    const std::array<std::uint32_t, 3> of_second{last, two * 6 + certainty, reach * 5 + slope};
    if (bits_.code(second_, of_second, fits(wish, beam, &RayAhead::second_cm))) {
      return Told::kSecond;
    }
  }
  const std::array<std::uint32_t, 3> of_none{last, two * kReaches + reach, there * 6 + last};
  if (bits_.code(no_return_, of_none, wish.kind == BeamKind::kNoReturn)) return Told::kNoReturn;
  const bool is_close = wish.kind == BeamKind::kTooClose;
  const bool has_value = wish.kind == BeamKind::kHit && value_of(wish) > 0;
  const std::array<std::uint32_t, 2> of_nothing{last, two};
  if (!bits_.code(says_nothing_, of_nothing, !has_value)) return Told::kValue;
  const std::array<std::uint32_t, 1> of_close{last};
  return bits_.code(too_close_, of_close, is_close) ? Told::kTooClose : Told::kSaysNothing;
}

/// In steps, such that it is read as a range that the scanner measures; 0: there is none.
std::int64_t BeamCoder::value_of(const Wish& wish) const {
  if (least_value_ > most_value_) return 0;
  const auto nearest = static_cast<std::int64_t>(std::lround(wish.range_cm / step_cm_));
  return std::clamp(nearest, least_value_, most_value_);
}

std::int64_t BeamCoder::code_value(std::size_t beam, std::int64_t wish, const Before& before) {
  const RayAhead& ahead = ahead_[beam];
  if (before.values > 0) {
    const std::int64_t goes_to =
        before.values > 1 ? 2 * before.last_value - before.second_last_value : before.last_value;
    const auto runs = static_cast<std::uint32_t>(before.values);
    const std::int64_t last_cm = before.last_value * step_cm_;
    const auto reach = static_cast<std::uint32_t>(std::min<std::int64_t>(19, last_cm / 100));
    const std::array<std::uint32_t, 3> contexts{runs, runs * 20 + reach,
                                                before.second_last * 3 + runs};
    if (bits_.code(goes_on_, contexts, std::abs(wish - goes_to) <= kNear)) {
      const std::uint32_t context = (runs - 1) * 6 + std::min(5U, reach / 2);
      return goes_to + change_.code_signed(bits_, wish - goes_to, context);
    }
  }
  if (ahead.first_cm == kNothing_cm) {
    return static_cast<std::int64_t>(
        jump_.code(bits_, static_cast<std::uint64_t>(wish), kReaches - 1));
  }
  const std::uint32_t reach = reach_of(ahead);
  const std::int64_t expected = ahead.first_cm / step_cm_;
  const auto certainty = static_cast<std::uint32_t>(ahead.certainty);
  const std::array<std::uint32_t, 3> contexts{
      before.last, reach * 6 + before.last,
      certainty * 4 + std::min(3U, static_cast<std::uint32_t>(ahead.unknown))};
  if (bits_.code(shorter_, contexts, wish < expected)) {
    const auto less = static_cast<std::uint64_t>(std::max<std::int64_t>(0, expected - wish - 1));
    return expected - 1 - static_cast<std::int64_t>(jump_.code(bits_, less, reach));
  }
  const auto more = static_cast<std::uint64_t>(std::max<std::int64_t>(0, wish - expected));
  return expected + static_cast<std::int64_t>(jump_.code(bits_, more, kReaches + reach));
}

void BeamCoder::code(PosedScan& posed) {
  look(posed);
  Scan& scan = posed.scan;
  std::vector<Told> told(scan.size());
  std::vector<int> range_cm(scan.size(), kNothing_cm);
  Before before;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    Wish wish;
    if (!bits_.is_reading()) {
      wish.kind = scan.kind(i);
      if (wish.kind == BeamKind::kHit)
        wish.range_cm = 100.0 * static_cast<double>(scan.ranges_m[i]);
    }
    told[i] = code_told(posed, i, wish, before);
    std::int64_t value = 0;
    switch (told[i]) {
      case Told::kFirst:
        range_cm[i] = ahead_[i].first_cm;
        break;
      case Told::kSecond:
        range_cm[i] = ahead_[i].second_cm;
        break;
      case Told::kValue:
        value = code_value(i, value_of(wish), before);
        if (value < least_value_ || value > most_value_) bits_.throw_damaged();
        range_cm[i] = static_cast<int>(value) * step_cm_;
        break;
      default:
        break;
    }
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    scan.ranges_m[i] = range_cm[i] != kNothing_cm      ? metres(range_cm[i])
                       : told[i] == Told::kTooClose    ? -kInfinity
                       : told[i] == Told::kSaysNothing ? std::numeric_limits<float>::quiet_NaN()
                                                       : kInfinity;
    before.second_last_value = before.last_value;
    before.last_value = value;
    before.values = told[i] == Told::kValue ? std::min(2, before.values + 1) : 0;
    before.second_last = before.last;
    before.last = static_cast<std::uint32_t>(told[i]);
  }
  remember(posed, told, range_cm);
}

void BeamCoder::remember(const PosedScan& posed, const std::vector<Told>& told,
                         const std::vector<int>& range_cm) {
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (told[i] == Told::kFirst) {
      map_.confirm(ahead_[i]);
    } else if (told[i] == Told::kNoReturn) {
      map_.weaken(ahead_[i]);
    } else if (range_cm[i] != kNothing_cm) {
      map_.see(rays_[i], range_cm[i]);
    }
  }
  told_before_ = told;
  heading_before_rad_ = posed.map_from_robot.theta;
}

}  // namespace strata::memory::detail
