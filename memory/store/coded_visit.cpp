// SPDX-License-Identifier: Apache-2.0
#include "memory/store/coded_visit.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "core/base/damage.hpp"
#include "memory/store/detail/beam_coder.hpp"
#include "memory/store/detail/bit_coder.hpp"
#include "memory/store/detail/plain_math.hpp"
#include "memory/store/detail/scan_header.hpp"

namespace strata::memory {
namespace {

using detail::BitCoder;
using detail::NumberModel;
using detail::ScanHeader;

constexpr std::size_t kHashBytes = 32;
constexpr double kMostPlace_m = 1e6;
constexpr double kMostAngle_rad = 1e3;
constexpr double kLeastResolution_m = 0.005;
constexpr double kMostResolution_m = 1.0;
constexpr std::uint32_t kMostRanges = 1U << 16U;
/// Whoever may push must not make others take all of their memory, nor compute for hours.
constexpr std::size_t kMostBeams = std::size_t{1} << 27U;
constexpr std::size_t kScanInBeams = 100;  ///< what a scan takes besides

/// ... and not for long because of a few bytes: a beam that is expected takes next to none.
std::size_t most_beams(std::size_t bytes) {
  constexpr std::size_t kMostOfNone = std::size_t{1} << 20U;
  constexpr std::size_t kMostAByte = 256;
  return bytes < kMostBeams / kMostAByte ? std::min(kMostBeams, kMostOfNone + bytes * kMostAByte)
                                         : kMostBeams;
}
constexpr std::int64_t kTick_ns = 10'000'000;
constexpr std::int64_t kMostTicks = std::int64_t{1} << 33U;
constexpr std::int64_t kMostStamp_ns = std::int64_t{1} << 62U;
constexpr std::int64_t kTurn = 4096;
constexpr double kStepsAMetre = 100.0;

bool is_codable(const ScanHeader& header) {
  const auto is_place = [](double metres) { return std::abs(metres) <= kMostPlace_m; };
  const double last_rad = static_cast<double>(header.angle_min_rad) +
                          static_cast<double>(header.angle_increment_rad) * header.ranges;
  return is_place(header.map_from_robot[0]) && is_place(header.map_from_robot[1]) &&
         std::abs(header.map_from_robot[2]) <= kMostAngle_rad &&
         is_place(header.robot_from_laser[0]) && is_place(header.robot_from_laser[1]) &&
         std::abs(header.robot_from_laser[2]) <= kMostAngle_rad &&
         std::abs(static_cast<double>(header.angle_min_rad)) <= kMostAngle_rad &&
         std::abs(last_rad) <= kMostAngle_rad && header.stamp_ns <= kMostStamp_ns &&
         header.stamp_ns >= -kMostStamp_ns && header.ranges <= kMostRanges;
}

bool is_codable(const ReflectionGrid& map) {
  return map.resolution_m() >= kLeastResolution_m && map.resolution_m() <= kMostResolution_m;
}

/// In steps.
struct Place {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t turn = 0;
};

std::int64_t wrapped(std::int64_t turn) {
  const std::int64_t rest = ((turn % kTurn) + kTurn) % kTurn;
  return rest > kTurn / 2 ? rest - kTurn : rest;
}

Place place_of(const Pose2& pose) {
  return {std::lround(pose.x * kStepsAMetre), std::lround(pose.y * kStepsAMetre),
          wrapped(std::lround(pose.theta / (2.0 * std::numbers::pi) * static_cast<double>(kTurn)))};
}

double heading_of(std::int64_t turn) {
  return static_cast<double>(turn) * (2.0 * std::numbers::pi / static_cast<double>(kTurn));
}

Pose2 pose_of(const Place& place) {
  return {static_cast<double>(place.x) / kStepsAMetre, static_cast<double>(place.y) / kStepsAMetre,
          heading_of(place.turn)};
}

/// One scan after the other, in either direction: what is written is put in its place as it is
/// read.
class VisitCoder {
 public:
  VisitCoder(BitCoder& bits, const ReflectionGrid& map, double tolerance_m, std::size_t most_beams)
      : bits_(bits), beams_(bits, map, tolerance_m), same_setup_({1}), most_beams_(most_beams) {}

  void code(PosedScan& posed) {
    code_setup(posed);
    code_stamp(posed.scan.stamp);
    code_pose(posed.map_from_robot);
    beams_.code(posed);
  }

 private:
  /// All that the next scan mostly has in common with the last one. How long a sweep takes goes
  /// along to a tenth: some drivers measure it anew each time.
  void code_setup(PosedScan& posed) {
    ScanHeader header = detail::header_of(posed, 0);
    header.stamp_ns = 0;
    std::fill(std::begin(header.map_from_robot), std::end(header.map_from_robot), 0.0);
    const auto keep = [](float& now, float last) {
      if (std::isfinite(last) && std::abs(now - last) <= 0.1F * std::abs(last)) now = last;
    };
    keep(header.time_increment_s, setup_.time_increment_s);
    keep(header.scan_time_s, setup_.scan_time_s);
    const std::array<std::uint32_t, 1> context{0};
    const bool is_same = std::memcmp(&header, &setup_, sizeof(header)) == 0;
    if (!bits_.code(same_setup_, context, is_same)) {
      for (std::size_t i = 0; i < 3; ++i) raw(header.robot_from_laser[i]);
      for (float* value :
           {&header.angle_min_rad, &header.angle_increment_rad, &header.time_increment_s,
            &header.scan_time_s, &header.range_min_m, &header.range_max_m}) {
        raw(*value);
      }
      header.ranges = static_cast<std::uint32_t>(bits_.raw(header.ranges, 32));
      setup_ = header;
    }
    if (!is_codable(setup_)) bits_.throw_damaged();
    beams_so_far_ += kScanInBeams + setup_.ranges;
    if (beams_so_far_ > most_beams_) bits_.throw_damaged();
    PosedScan read = detail::scan_of(setup_, posed.run);
    if (!bits_.is_reading()) read.scan.ranges_m = std::move(posed.scan.ranges_m);
    read.scan.stamp = posed.scan.stamp;
    read.map_from_robot = posed.map_from_robot;
    posed = std::move(read);
  }
  void raw(double& value) {
    value = std::bit_cast<double>(bits_.raw(std::bit_cast<std::uint64_t>(value), 64));
  }
  void raw(float& value) {
    value = std::bit_cast<float>(
        static_cast<std::uint32_t>(bits_.raw(std::bit_cast<std::uint32_t>(value), 32)));
  }

  void code_stamp(Stamp& stamp) {
    if (is_first_) {
      first_ns_ = static_cast<std::int64_t>(bits_.raw(static_cast<std::uint64_t>(stamp.ns), 64));
      if (first_ns_ > kMostStamp_ns || first_ns_ < -kMostStamp_ns) bits_.throw_damaged();
    } else {
      const std::int64_t now = (stamp.ns - first_ns_ + kTick_ns / 2) / kTick_ns;
      // Stamps stay different where they were, and the order stays.
      const std::int64_t wish = std::max(now, ticks_ + 1) - ticks_ - ticks_between_;
      ticks_between_ += ticks_model_.code_signed(bits_, wish);
      if (std::abs(ticks_between_) > kMostTicks) bits_.throw_damaged();
      ticks_ += ticks_between_;
      if (std::abs(ticks_) > kMostTicks) bits_.throw_damaged();
    }
    stamp.ns = first_ns_ + ticks_ * kTick_ns;
  }

  /// Relative to going on as before.
  void code_pose(Pose2& pose) {
    const Place wish = bits_.is_reading() ? Place{} : place_of(pose);
    const detail::PlainDirection heading = detail::plain_direction(heading_of(last_.turn));
    const auto ahead = static_cast<double>(step_.x);
    const auto aside = static_cast<double>(step_.y);
    const std::int64_t x = last_.x + std::lround(ahead * heading.cosine - aside * heading.sine);
    const std::int64_t y = last_.y + std::lround(ahead * heading.sine + aside * heading.cosine);
    const auto turning =
        static_cast<std::uint32_t>(std::min<std::int64_t>(3, std::abs(step_.turn) / 10));
    Place now;
    now.x = x + x_model_.code_signed(bits_, wish.x - x, turning > 1 ? 1 : 0);
    now.y = y + y_model_.code_signed(bits_, wish.y - y, turning > 1 ? 1 : 0);
    step_.turn = turn_model_.code_signed(bits_, wrapped(wish.turn - last_.turn), turning);
    now.turn = wrapped(last_.turn + step_.turn);
    const auto dx = static_cast<double>(now.x - last_.x);
    const auto dy = static_cast<double>(now.y - last_.y);
    step_.x = is_first_ ? 0 : std::lround(dx * heading.cosine + dy * heading.sine);
    step_.y = is_first_ ? 0 : std::lround(dy * heading.cosine - dx * heading.sine);
    last_ = now;
    is_first_ = false;
    pose = pose_of(now);
    if (std::max(std::abs(pose.x), std::abs(pose.y)) > kMostPlace_m + 1.0) bits_.throw_damaged();
  }

  BitCoder& bits_;
  detail::BeamCoder beams_;
  detail::BitModel same_setup_;
  NumberModel ticks_model_;
  NumberModel x_model_{2};
  NumberModel y_model_{2};
  NumberModel turn_model_{4};
  ScanHeader setup_{};
  std::size_t most_beams_;
  std::size_t beams_so_far_ = 0;
  bool is_first_ = true;
  std::int64_t first_ns_ = 0;
  std::int64_t ticks_ = 0;
  std::int64_t ticks_between_ = 0;
  Place last_;
  Place step_;  ///< ahead and aside, in the heading before
};

/// Scans that come faster than ticks would be told later and later.
bool keep_their_stamps(std::span<const PosedScan> told, std::span<const PosedScan> scans) {
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (std::abs(told[i].scan.stamp.ns - scans[i].scan.stamp.ns) > 2 * kTick_ns) return false;
  }
  return true;
}

std::size_t beams_of(std::span<const PosedScan> scans) {
  std::size_t beams = 0;
  for (const PosedScan& posed : scans) beams += kScanInBeams + posed.scan.size();
  return beams;
}

bool are_codable(std::span<const PosedScan> scans, const ReflectionGrid& map) {
  if (scans.empty() || !is_codable(map) || beams_of(scans) > kMostBeams) return false;
  for (const PosedScan& posed : scans) {
    const std::int64_t since_first_ns = posed.scan.stamp.ns / 2 - scans.front().scan.stamp.ns / 2;
    if (!is_codable(detail::header_of(posed, 0)) ||
        std::abs(since_first_ns) > kMostTicks * (kTick_ns / 8)) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::optional<CodedVisit> code_visit(std::span<const PosedScan> scans, const ReflectionGrid& map,
                                     const std::string& map_hash, double tolerance_m) {
  if (!are_codable(scans, map) || map_hash.size() != 2 * kHashBytes) return std::nullopt;
  CodedVisit coded;
  coded.scans.assign(scans.begin(), scans.end());
  BitCoder bits;
  (void)bits.raw(scans.size(), 32);
  VisitCoder visit(bits, map, tolerance_m, kMostBeams);
  for (PosedScan& posed : coded.scans) visit.code(posed);
  for (std::size_t i = 0; i < kHashBytes; ++i) {
    coded.bytes.push_back(
        static_cast<std::byte>(std::stoi(map_hash.substr(2 * i, 2), nullptr, 16)));
  }
  const std::vector<std::byte> rest = bits.finish();
  coded.bytes.insert(coded.bytes.end(), rest.begin(), rest.end());
  if (beams_of(scans) > most_beams(coded.bytes.size())) return std::nullopt;
  if (!keep_their_stamps(coded.scans, scans)) return std::nullopt;
  return coded;
}

std::string map_of_coded_visit(std::span<const std::byte> bytes, const std::string& place) {
  if (bytes.size() < kHashBytes) BitCoder({}, place).throw_damaged();
  std::string hash;
  for (const std::byte byte : bytes.first(kHashBytes)) {
    constexpr const char* kDigits = "0123456789abcdef";
    hash += kDigits[static_cast<unsigned>(byte) >> 4U];
    hash += kDigits[static_cast<unsigned>(byte) & 15U];
  }
  return hash;
}

std::vector<PosedScan> scans_of_coded_visit(std::span<const std::byte> bytes,
                                            const ReflectionGrid& map, int run,
                                            const std::string& place) {
  (void)map_of_coded_visit(bytes, place);  // it is there
  BitCoder bits(bytes.subspan(kHashBytes), place);
  if (!is_codable(map)) bits.throw_damaged();
  const std::uint64_t count = bits.raw(0, 32);
  VisitCoder visit(bits, map, 0.0, most_beams(bytes.size()));
  std::vector<PosedScan> scans;
  for (std::uint64_t i = 0; i < count; ++i) {
    PosedScan& posed = scans.emplace_back();
    posed.run = run;
    visit.code(posed);
  }
  return scans;
}

}  // namespace strata::memory
