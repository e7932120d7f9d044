// SPDX-License-Identifier: Apache-2.0
#include "core/slam/log_checks.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

namespace strata::slam {
namespace {

constexpr double kLongGapS = 10.0;
/// Matches that stay this much behind odometry, or go against it, contradict it.
constexpr double kMinAgreement = 0.3;
constexpr double kEnoughTravelM2 = 0.05;
constexpr double kEnoughTurnRad2 = 0.05;
/// Odometry that moves so far while the scan stays the same to the bit: the scanner is stuck.
constexpr double kStuckM = 0.02;
/// Odometry that moves so far in a scan while the scan moves back by this share of it counts the
/// wrong way; now and then a match alone may be off.
constexpr double kReversedM = 0.03;
constexpr double kReversedShare = 0.3;
constexpr std::size_t kEnoughReversed = 5;
/// Share of a log from which ambiguity and failure are worth a word.
constexpr double kWorthAWord = 0.05;

template <class Value>
std::string sentence(std::size_t count, const char* what, const char* detail, Value value,
                     const char* end) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << count << what << detail << value << end;
  return text.str();
}

double percent(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

std::optional<LogChecks::Skip> LogChecks::reason_to_skip(const Observation& observation,
                                                         const Pose2* given_pose) {
  const Scan& scan = observation.scan;
  if (count_beams(scan).invalid == scan.size()) return Skip::kNothing;
  const bool finite = (!observation.has_odometry || is_finite(observation.odom_from_robot)) &&
                      is_finite(scan.robot_from_laser) &&
                      (given_pose == nullptr || is_finite(*given_pose));
  if (!finite) return Skip::kNotFinite;
  return std::nullopt;
}

bool LogChecks::are_same_readings(std::span<const float> a, std::span<const float> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](float left, float right) {
    return left == right || (std::isnan(left) && std::isnan(right));
  });
}

void LogChecks::add(const Scan& scan, bool new_run, const ScanFindings& findings) {
  ++scans_;
  if (new_run) {
    run_begin_ = scan.stamp;
    last_ranges_.clear();
  }
  const double at_s = (scan.stamp - run_begin_).seconds();
  const double gap_s = new_run ? 0.0 : (scan.stamp - last_).seconds();
  last_ = scan.stamp;
  if (gap_s > kLongGapS) {
    gaps_.add(at_s);
    longest_gap_s_ = std::max(longest_gap_s_, gap_s);
  }
  const double moved_m = std::hypot(findings.odometry_step.x, findings.odometry_step.y);
  if (moved_m > kStuckM && !findings.empty && are_same_readings(scan.ranges_m, last_ranges_)) {
    stuck_.add(at_s);
  }
  last_ranges_ = scan.ranges_m;
  if (findings.odometry_jumped) jumps_.add(at_s);
  if (new_run || findings.odometry_jumped) return;
  if (!findings.matched) (findings.empty ? empty_ : findings.few ? few_ : unmatched_).add(at_s);
  if (findings.ambiguous) ambiguous_.add(at_s);
  if (findings.heading_open) heading_open_.add(at_s);
  if (!findings.matched || findings.ambiguous) return;
  const double forward = findings.odometry_step.x * findings.matched_step.x +
                         findings.odometry_step.y * findings.matched_step.y;
  forward_match_ += forward;
  if (moved_m > kReversedM && forward < -kReversedShare * moved_m * moved_m) reversed_.add(at_s);
  forward_odometry_ += moved_m * moved_m;
  if (findings.heading_open) return;
  turn_match_ += findings.odometry_step.theta * findings.matched_step.theta;
  turn_odometry_ += findings.odometry_step.theta * findings.odometry_step.theta;
}

std::size_t LogChecks::skipped() const { return skips_[0] + skips_[1] + skips_[2] + skips_[3]; }

std::vector<std::string> LogChecks::warnings() const {
  std::vector<std::string> all;
  const char* const skipped[4] = {" scans older than the one before were skipped",
                                  " scans that repeat the one before were skipped",
                                  " scans without a single valid reading were skipped",
                                  " scans with a pose that is not a number were skipped"};
  for (std::size_t i = 0; i < 4; ++i) {
    if (skips_[i] > 0) all.push_back(std::to_string(skips_[i]) + skipped[i]);
  }
  if (gaps_.count > 0) {
    const char* const gaps =
        gaps_.count == 1 ? " gap in time of " : " gaps in time, the longest of ";
    all.push_back(sentence(gaps_.count, gaps, "", longest_gap_s_,
                           " s: the way in between rests on odometry"));
  }
  if (jumps_.count > 0) {
    const bool is_one = jumps_.count == 1;
    all.push_back(sentence(jumps_.count, is_one ? " jump of odometry, " : " jumps of odometry, ",
                           is_one ? "at " : "the first at ", jumps_.first_s,
                           is_one ? " s, was not believed; the scans decide there"
                                  : " s, were not believed; the scans decide there"));
  }
  if (stuck_.count > 0) {
    all.push_back(sentence(stuck_.count, " scans repeat the one before to the bit while odometry ",
                           "moves, the first at ", stuck_.first_s,
                           " s: is the scanner stuck or its messages repeated?"));
  }
  if (forward_odometry_ > kEnoughTravelM2 && forward_match_ < kMinAgreement * forward_odometry_) {
    all.push_back(
        "the scans move against odometry: is the scanner mounted the way round that the log says?");
  } else if (reversed_.count >= kEnoughReversed) {
    all.push_back(sentence(reversed_.count, " scans move against odometry, ", "the first at ",
                           reversed_.first_s,
                           " s; the scans are believed there: does the base count backwards as "
                           "forwards?"));
  }
  if (turn_odometry_ > kEnoughTurnRad2 && turn_match_ < kMinAgreement * turn_odometry_) {
    all.push_back(
        "the scans turn against odometry: is the scanner upside down, and does the log say so?");
  }
  for (const auto& [seen, what] :
       {std::pair(ambiguous_,
                  "leave the position open in one direction (a bare corridor or hall): "
                  "odometry or given poses rule there"),
        std::pair(heading_open_,
                  "leave the heading open (a round hall): odometry or given poses rule there; "
                  "without them the map is not to be trusted"),
        std::pair(few_, "hit too little to be matched: their poses are odometry's"),
        std::pair(empty_, "hit nothing within reach (an open hall?): their poses are odometry's"),
        std::pair(unmatched_, "fit no map: their poses are odometry's")}) {
    if (percent(seen.count, scans_) <= 100.0 * kWorthAWord) continue;
    std::ostringstream text;
    text << std::fixed << std::setprecision(0) << percent(seen.count, scans_)
         << "% of the scans, the first at " << seen.first_s << " s, " << what;
    all.push_back(text.str());
  }
  return all;
}

}  // namespace strata::slam
