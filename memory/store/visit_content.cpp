// SPDX-License-Identifier: Apache-2.0
#include "memory/store/visit_content.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>

#include <zstd.h>

#include "core/base/damage.hpp"
#include "memory/store/detail/blob.hpp"
#include "memory/store/detail/scan_header.hpp"

namespace strata::memory {
namespace {

using detail::ScanHeader;

// What a header has besides: its ranges are whole steps, so many a metre, or floats.
constexpr std::uint32_t kFloats = 0;
constexpr std::array<std::uint32_t, 2> kSteps{100, 1000};
/// Ranges that are no number of steps.
constexpr std::uint16_t kNothingSeen = 0xFFFF;
constexpr std::uint16_t kTooClose = 0xFFFE;
constexpr std::uint16_t kNan = 0xFFFD;
constexpr double kMostSteps = 0xFFFC;

float range_of(std::uint16_t steps, std::uint32_t steps_a_metre) {
  switch (steps) {
    case kNothingSeen:
      return std::numeric_limits<float>::infinity();
    case kTooClose:
      return -std::numeric_limits<float>::infinity();
    case kNan:
      return std::numeric_limits<float>::quiet_NaN();
    default:
      return static_cast<float>(static_cast<double>(steps) / static_cast<double>(steps_a_metre));
  }
}

std::uint16_t steps_of(float range_m, std::uint32_t steps_a_metre) {
  if (std::isnan(range_m)) return kNan;
  if (std::isinf(range_m)) return range_m > 0.0F ? kNothingSeen : kTooClose;
  const double steps =
      std::round(static_cast<double>(range_m) * static_cast<double>(steps_a_metre));
  return steps >= 0.0 && steps <= kMostSteps ? static_cast<std::uint16_t>(steps) : kNan;
}

bool is_same(float a, float b) {
  return (std::isnan(a) && std::isnan(b)) ||
         std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

bool are_whole(std::span<const float> ranges_m, std::uint32_t steps_a_metre) {
  for (const float range_m : ranges_m) {
    if (!is_same(range_of(steps_of(range_m, steps_a_metre), steps_a_metre), range_m)) return false;
  }
  return true;
}

std::uint32_t steps_a_metre_of(std::span<const float> ranges_m) {
  for (const std::uint32_t steps_a_metre : kSteps) {
    if (are_whole(ranges_m, steps_a_metre)) return steps_a_metre;
  }
  return kFloats;
}

/// What a robot may send and no learner could use.
bool is_sound(const ScanHeader& header) {
  const auto all_finite = [](const auto& values) {
    return std::all_of(std::begin(values), std::end(values),
                       [](double value) { return std::isfinite(value); });
  };
  const bool is_known = header.more == kFloats ||
                        std::find(kSteps.begin(), kSteps.end(), header.more) != kSteps.end();
  return is_known && all_finite(header.map_from_robot) && all_finite(header.robot_from_laser) &&
         std::isfinite(header.angle_min_rad) && std::isfinite(header.angle_increment_rad);
}

/// Small numbers for small differences of either sign.
std::uint16_t zigzag(std::uint16_t difference) {
  const bool is_negative = (difference & 0x8000U) != 0U;
  const auto twice = static_cast<std::uint16_t>(difference << 1U);
  return is_negative ? static_cast<std::uint16_t>(~twice) : twice;
}
std::uint16_t from_zigzag(std::uint16_t code) {
  const auto half = static_cast<std::uint16_t>(code >> 1U);
  return (code & 1U) != 0U ? static_cast<std::uint16_t>(~half) : half;
}

/// The values as planes of their bytes, behind what is there.
template <typename T>
void append(std::vector<std::byte>& bytes, std::span<const T> values) {
  const std::vector<std::byte> planes = detail::to_planes(values);
  bytes.resize(bytes.size() + planes.size());  // inserted, g++ 12 takes it for freed memory
  std::copy(planes.begin(), planes.end(), bytes.end() - static_cast<std::ptrdiff_t>(planes.size()));
}

[[noreturn]] void throw_damaged(const std::string& place) {
  throw DamageError(place, "is damaged: its scans are not whole",
                    "push the visit again from the robot that drove it");
}

/// Takes planes of `count` values off the front of `rest`.
template <typename T>
std::vector<T> take(std::span<const std::byte>& rest, std::size_t count, const std::string& place) {
  if (rest.size() / sizeof(T) < count) throw_damaged(place);
  std::vector<T> values(count);
  detail::from_planes(rest.first(count * sizeof(T)), std::span<T>(values));
  rest = rest.subspan(count * sizeof(T));
  return values;
}

}  // namespace

std::vector<std::byte> visit_content(std::span<const PosedScan> scans) {
  std::vector<ScanHeader> headers;
  std::vector<std::uint16_t> steps;
  std::vector<float> floats;
  for (const PosedScan& posed : scans) {
    const ScanHeader& header =
        headers.emplace_back(detail::header_of(posed, steps_a_metre_of(posed.scan.ranges_m)));
    const std::vector<float>& ranges_m = posed.scan.ranges_m;
    if (header.more == kFloats) {
      for (const float range_m : ranges_m) {
        floats.push_back(std::isnan(range_m) ? std::numeric_limits<float>::quiet_NaN() : range_m);
      }
      continue;
    }
    std::uint16_t last = 0;
    for (const float range_m : ranges_m) {
      const std::uint16_t now = steps_of(range_m, header.more);
      steps.push_back(zigzag(static_cast<std::uint16_t>(now - last)));
      last = now;
    }
  }
  const auto count = static_cast<std::uint32_t>(scans.size());
  std::vector<std::byte> bytes;
  append(bytes, std::span<const std::uint32_t>(&count, 1));
  append(bytes, std::span<const ScanHeader>(headers));
  append(bytes, std::span<const std::uint16_t>(steps));
  append(bytes, std::span<const float>(floats));
  return bytes;
}

std::vector<PosedScan> scans_of_visit(std::span<const std::byte> content, int run,
                                      const std::string& place) {
  std::uint32_t count = 0;
  if (content.size() < sizeof(count)) throw_damaged(place);
  std::memcpy(&count, content.data(), sizeof(count));
  std::span<const std::byte> rest = content.subspan(sizeof(count));
  const auto headers = take<ScanHeader>(rest, count, place);
  std::size_t in_steps = 0;
  std::size_t in_floats = 0;
  for (const ScanHeader& header : headers) {
    if (!is_sound(header)) throw_damaged(place);
    (header.more == kFloats ? in_floats : in_steps) += header.ranges;
  }
  const auto steps = take<std::uint16_t>(rest, in_steps, place);
  const auto floats = take<float>(rest, in_floats, place);
  if (!rest.empty()) throw_damaged(place);

  std::vector<PosedScan> scans;
  scans.reserve(count);
  std::size_t next_step = 0;
  std::size_t next_float = 0;
  for (const ScanHeader& header : headers) {
    PosedScan& posed = scans.emplace_back(detail::scan_of(header, run));
    std::uint16_t last = 0;
    for (float& range_m : posed.scan.ranges_m) {
      if (header.more == kFloats) {
        range_m = floats[next_float++];
        continue;
      }
      last = static_cast<std::uint16_t>(last + from_zigzag(steps[next_step++]));
      range_m = range_of(last, header.more);
    }
  }
  return scans;
}

std::vector<std::byte> pack_visit(std::span<const std::byte> content) {
  constexpr int kLevel = 19;
  return detail::compress(content, kLevel);
}

std::vector<std::byte> unpack_visit(std::span<const std::byte> packed, const std::string& place) {
  // Whoever may push must not make others take all of their memory.
  constexpr unsigned long long kMostBytes = 1ULL << 30U;
  const unsigned long long stated = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (stated > kMostBytes) throw_damaged(place);  // also what zstd says of what is no frame
  return detail::decompress(packed, place);
}

}  // namespace strata::memory
