// SPDX-License-Identifier: Apache-2.0
#include "components/log/carmen.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "components/log/carmen_scan.hpp"
#include "components/log/equal_stamps.hpp"
#include "components/log/odometry_track.hpp"
#include "components/log/set_back_clock.hpp"
#include "components/log/text.hpp"
#include "core/base/error.hpp"
#include "core/geometry/angle.hpp"
#include "core/scan/range_limit.hpp"

namespace strata::log {
namespace {

constexpr std::size_t kMaxBeams = 100'000;

/// Different first words that are counted apart; no log has as many.
constexpr std::size_t kMaxKeywords = 1000;

/// The words of one line with a cursor; the first failure is remembered, not thrown.
class Fields {
 public:
  explicit Fields(const std::vector<std::string_view>& words) : words_(words) {}
  [[nodiscard]] std::size_t left() const { return words_.size() - at_; }
  double number() {
    const auto value = at_ < words_.size() ? parse_double(words_[at_++]) : std::nullopt;
    if (!value || !std::isfinite(*value)) fail("is no number that can be used");
    return value.value_or(0.0);
  }
  float range() {
    const auto value = at_ < words_.size() ? parse_float(words_[at_++]) : std::nullopt;
    if (!value) fail("is no number that can be used");
    return value.value_or(0.0F);
  }
  std::size_t count() {
    const auto value = at_ < words_.size() ? parse_integer(words_[at_++]) : std::nullopt;
    if (!value || *value < 0 || *value > static_cast<long long>(kMaxBeams)) {
      fail("is no number of readings from 0 to " + std::to_string(kMaxBeams));
      return 0;
    }
    return static_cast<std::size_t>(*value);
  }
  Pose2 pose() {
    const double x = number();
    const double y = number();
    return {x, y, wrap_angle(number())};
  }
  Stamp stamp() {
    const auto value = at_ < words_.size() ? parse_stamp(words_[at_++]) : std::nullopt;
    if (!value) fail("is no stamp in seconds");
    return value.value_or(Stamp{});
  }
  [[nodiscard]] bool ok() const { return problem_.empty(); }
  /// Of the first field that could not be read; empty when there is none.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  /// Of the field before the cursor.
  void fail(const std::string& why) {
    if (!problem_.empty()) return;
    if (at_ > words_.size()) {
      problem_ = "the line is too short";
      return;
    }
    constexpr std::size_t kShown = 40;
    problem_ = "field " + std::to_string(at_) + ", '" +
               std::string(words_[at_ - 1].substr(0, kShown)) + "', " + why;
  }

  const std::vector<std::string_view>& words_;
  std::size_t at_ = 1;
  std::string problem_;
};

class CarmenParser {
 public:
  CarmenParser(const std::filesystem::path& path, const ReadOptions& options, ReadReport& report)
      : path_(path), options_(options), report_(report) {}

  LogContent read() {
    read_lines();
    if (scans_.empty()) throw_no_scans();
    for (std::size_t i = 1; i < scans_.size(); ++i) {
      if (stamp(scans_[i]) < stamp(scans_[i - 1])) ++report_.scans_out_of_order;
    }
    mend_clock();
    std::stable_sort(scans_.begin(), scans_.end(),
                     [](const CarmenScan& a, const CarmenScan& b) { return stamp(a) < stamp(b); });
    note_equal_stamps(scans_, stamp, "", report_);
    mark_no_returns(scans_, options_, report_);
    find_mounting(scans_, front_laser_offset_, report_);
    std::stable_sort(content_.odometry.begin(), content_.odometry.end(),
                     [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
    for (CarmenScan& scan : scans_) content_.observations.push_back(std::move(scan.observation));
    report_.odometry_source = "scan";
    return std::move(content_);
  }

 private:
  static Stamp stamp(const CarmenScan& scan) { return scan.observation.scan.stamp; }

  void mend_clock() {
    std::vector<Stamp> stamps;
    for (const CarmenScan& scan : scans_) stamps.push_back(stamp(scan));
    const auto same_scan = [&](std::size_t i, std::size_t j) {
      return scans_[i].observation.scan.ranges_m == scans_[j].observation.scan.ranges_m;
    };
    const SetBackClock clock = mend_set_back_clock(stamps, same_scan);
    if (clock.times == 0) return;
    report_.warnings.push_back(clock.sentence());
    for (std::size_t i = 0; i < scans_.size(); ++i) scans_[i].observation.scan.stamp = stamps[i];
    mend_odometry_clock(content_.odometry);
  }

  [[noreturn]] void throw_no_scans() const {
    if (report_.scans_without_beams > 0) {
      throw InputError(path_.string(),
                       "none of its " + std::to_string(report_.scans_without_beams) +
                           " readable scans has a range that is a number",
                       "check the scanner and what recorded it");
    }
    throw InputError(report_.bad_lines > 0 ? report_.first_bad : path_.string(),
                     report_.bad_lines > 0 ? "no line with a laser scan can be read"
                                           : "holds no FLASER or ROBOTLASER1 line",
                     "check that it is a CARMEN log of a laser scanner");
  }

  void bad(const std::string& place, const std::string& why) {
    if (report_.bad_lines++ == 0) report_.first_bad = place + ": " + why;
  }

  void read_lines() {
    LineReader lines(path_);
    std::string line;
    std::vector<std::string_view> words;
    while (lines.next(line)) {
      split(line, words);
      if (words.empty() || words[0].front() == '#') continue;
      const bool cut = lines.ended_without_newline();
      if (words[0] == "FLASER") {
        flaser(words, cut, lines);
      } else if (words[0] == "ROBOTLASER1") {
        robot_laser(words, cut, lines);
      } else if (words[0] == "ODOM") {
        odometry(words, cut, lines);
      } else if (words[0] == "PARAM" && words.size() > 2 && words[1] == "robot_frontlaser_offset") {
        front_laser_offset_ = parse_double(words[2]);
      }
      count(words[0]);
      if (lines.line_number() % 1000 == 0) {
        report_progress(options_.progress, "read log", lines.line_number(), 0);
      }
    }
    if (lines.damage().empty()) return;
    if (scans_.empty()) throw lines.damage_error();
    report_.warnings.push_back(lines.damage_error().what());
  }

  void count(std::string_view keyword) {
    // Binary rubbish must not make a key of its own for each line.
    const bool is_word =
        keyword.size() <= 40 && std::all_of(keyword.begin(), keyword.end(), [](char c) {
          return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        });
    const std::string key = is_word ? std::string(keyword) : std::string("(not a message)");
    const bool is_known = report_.messages.size() < kMaxKeywords || report_.messages.contains(key);
    ++report_.messages[is_known ? key : std::string("(others)")];
  }

  void flaser(const std::vector<std::string_view>& words, bool cut, const LineReader& lines) {
    Fields fields(words);
    CarmenScan raw;
    Scan& scan = raw.observation.scan;
    const std::size_t beams = fields.count();
    // Behind the beams: two poses and the ipc stamp; host and logger stamp may be missing, but not
    // where the file is cut.
    const std::size_t least = beams + (cut ? 9 : 7);
    if (!fields.ok()) return bad(lines.place(), fields.problem());
    if (fields.left() < least) return bad(lines.place(), "the line is too short");
    scan.ranges_m.reserve(beams);
    for (std::size_t i = 0; i < beams; ++i) scan.ranges_m.push_back(fields.range());
    raw.laser_pose = fields.pose();
    raw.observation.odom_from_robot = fields.pose();
    scan.stamp = fields.stamp();
    if (!fields.ok()) return bad(lines.place(), fields.problem());
    set_flaser_geometry(scan, options_.flaser_field_of_view_deg);
    keep(std::move(raw));
  }

  void robot_laser(const std::vector<std::string_view>& words, bool cut, const LineReader& lines) {
    Fields fields(words);
    CarmenScan raw;
    Scan& scan = raw.observation.scan;
    fields.number();  // laser type
    scan.angle_min_rad = fields.range();
    fields.number();  // field of view
    scan.angle_increment_rad = fields.range();
    scan.range_max_m = fields.range();
    fields.number();  // accuracy
    fields.number();  // remission mode
    const std::size_t beams = fields.count();
    if (!fields.ok()) return bad(lines.place(), fields.problem());
    if (fields.left() < beams + 1) return bad(lines.place(), "the line is too short");
    for (std::size_t i = 0; i < beams; ++i) scan.ranges_m.push_back(fields.range());
    const std::size_t remissions = fields.count();
    if (!fields.ok()) return bad(lines.place(), fields.problem());
    if (fields.left() < remissions + (cut ? 14 : 12)) {
      return bad(lines.place(), "the line is too short");
    }
    for (std::size_t i = 0; i < remissions; ++i) fields.range();
    raw.laser_pose = fields.pose();
    raw.observation.odom_from_robot = fields.pose();
    for (int i = 0; i < 5; ++i) fields.number();  // velocities, safety distances, turn axis
    scan.stamp = fields.stamp();
    if (!fields.ok()) return bad(lines.place(), fields.problem());
    // 0 is what a log writes that does not know it.
    raw.states_maximum = tells_reach(scan.range_max_m);
    if (!(scan.range_max_m >= 0.0F) || !std::isfinite(scan.angle_min_rad) ||
        !std::isfinite(scan.angle_increment_rad)) {
      return bad(lines.place(), "its angles or its greatest range make no sense");
    }
    keep(std::move(raw));
  }

  void odometry(const std::vector<std::string_view>& words, bool cut, const LineReader& lines) {
    Fields fields(words);
    if (fields.left() < (cut ? 9U : 7U)) return bad(lines.place(), "the line is too short");
    OdometrySample sample;
    sample.odom_from_robot = fields.pose();
    for (int i = 0; i < 3; ++i) fields.number();
    sample.stamp = fields.stamp();
    if (!fields.ok()) return bad(lines.place(), fields.problem());
    content_.odometry.push_back(sample);
  }

  void keep(CarmenScan raw) {
    raw.observation.run = options_.run;
    const auto& ranges = raw.observation.scan.ranges_m;
    if (std::all_of(ranges.begin(), ranges.end(), [](float r) { return std::isnan(r); })) {
      ++report_.scans_without_beams;
      return;
    }
    scans_.push_back(std::move(raw));
  }

  std::filesystem::path path_;
  const ReadOptions& options_;
  ReadReport& report_;
  std::vector<CarmenScan> scans_;
  LogContent content_;
  std::optional<double> front_laser_offset_;
};

}  // namespace

void set_flaser_geometry(Scan& scan, double field_of_view_deg) {
  // The format states no angles. n odd (181, 361): the first and last beam are the ends of the
  // field and one looks ahead; n even: half a step inside, 180 beams at -89.5 ... +89.5, as
  // CARMEN's robots had one a degree. Either way the scan is symmetric.
  const auto n = static_cast<double>(scan.size());
  const bool odd = scan.size() % 2 == 1;
  const double step_deg =
      odd ? (n > 1 ? field_of_view_deg / (n - 1.0) : 0.0) : field_of_view_deg / n;
  const double first_deg = -field_of_view_deg / 2.0 + (odd ? 0.0 : step_deg / 2.0);
  scan.angle_min_rad = static_cast<float>(degrees_to_radians(first_deg));
  scan.angle_increment_rad = static_cast<float>(degrees_to_radians(step_deg));
  scan.range_min_m = 0.0F;
  scan.range_max_m = kSickMaximum;
}

LogContent read_carmen(const std::filesystem::path& path, const ReadOptions& options,
                       ReadReport& report) {
  report.format = LogFormat::kCarmen;
  return CarmenParser(path, options, report).read();
}

}  // namespace strata::log
