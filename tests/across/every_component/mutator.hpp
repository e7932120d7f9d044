// SPDX-License-Identifier: Apache-2.0
/// Messages as a broken or hostile node sends them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace strata::test {

/// The same seed gives the same messages.
class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  /// `good` with one to three of these done to it: bits flipped, cut, lengthened, a length made
  /// absurd, a number made not one, swapped byte order, nothing but a header, nothing but noise,
  /// another encapsulation. Never shorter than a header of 4 bytes. One in ten stays good.
  [[nodiscard]] std::vector<std::uint8_t> mutate(std::vector<std::uint8_t> good) {
    if (below(10) == 0) return good;
    for (std::size_t times = 1 + below(3); times > 0; --times) change(good);
    if (good.size() < 4) good.resize(4);
    return good;
  }

 private:
  using Bytes = std::vector<std::uint8_t>;

  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_() & 0xFFU); }

  void change(Bytes& bytes) {
    switch (below(9)) {
      case 0:
        for (std::size_t flips = 1 + below(8); flips > 0 && !bytes.empty(); --flips) {
          bytes[below(bytes.size())] ^= static_cast<std::uint8_t>(1U << below(8));
        }
        break;
      case 1:
        bytes.resize(below(bytes.size() + 1));
        break;
      case 2:
        for (std::size_t more = 1 + below(64); more > 0; --more) bytes.push_back(byte());
        break;
      case 3:
        put(bytes, kLengths[below(kLengths.size())]);
        break;
      case 4:
        put(bytes, kFloats[below(kFloats.size())]);
        break;
      case 5:
        put(bytes, static_cast<double>(kFloats[below(kFloats.size())]));
        break;
      case 6:
        if (bytes.size() > 1) bytes[1] ^= 1U;  // the other byte order
        break;
      case 7:
        bytes.resize(4 + below(200));
        for (std::size_t i = 4; i < bytes.size(); ++i) bytes[i] = byte();
        break;
      default:
        if (below(2) == 0) {
          bytes.resize(4);
        } else if (bytes.size() > 1) {
          bytes[1] = static_cast<std::uint8_t>(below(12));  // PL_CDR, XCDR2, ...
        }
    }
  }

  /// Somewhere where a number of that size may be, most of them near the beginning, where the
  /// lengths are.
  template <typename T>
  void put(Bytes& bytes, T value) {
    if (bytes.size() < 4 + sizeof value) return;
    std::size_t places = (bytes.size() - 4) / sizeof value;
    if (below(2) == 0) places = std::min<std::size_t>(places, 32);
    std::memcpy(bytes.data() + 4 + sizeof value * below(places), &value, sizeof value);
  }

  static constexpr std::array<std::uint32_t, 8> kLengths = {
      0, 1, 0xFF, 0xFFFF, 0x01000000, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF};
  static constexpr std::array<float, 10> kFloats = {std::numeric_limits<float>::quiet_NaN(),
                                                    std::numeric_limits<float>::infinity(),
                                                    -std::numeric_limits<float>::infinity(),
                                                    std::numeric_limits<float>::max(),
                                                    std::numeric_limits<float>::denorm_min(),
                                                    -1.0F,
                                                    0.0F,
                                                    1e9F,
                                                    -1e-3F,
                                                    1e4F};
  std::mt19937_64 random_;
};

}  // namespace strata::test
