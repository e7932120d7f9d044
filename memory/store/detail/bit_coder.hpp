// SPDX-License-Identifier: Apache-2.0
/// Adaptive arithmetic coding of bits. One class writes and reads, so that both sides take the same
/// course: who reads passes any wish, and is told what was written.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace strata::memory::detail {

/// How likely a kind of bit is, told by several contexts at once: each counts for itself, and
/// weights learn which of them to believe (logistic mixing, as PAQ has it [mahoney2005adaptive]).
class BitModel {
 public:
  static constexpr std::size_t kMostContexts = 8;
  /// sizes: of each context, how many values it has. sets: of weights.
  explicit BitModel(const std::vector<std::size_t>& sizes, std::size_t sets = 1);

  /// P(bit is set) in 1/65536, 32 to 65504. contexts: one a size, below it.
  [[nodiscard]] std::uint32_t probability(std::span<const std::uint32_t> contexts,
                                          std::size_t set = 0);
  /// What the bit was that probability() was asked for last.
  void learn(bool bit);

 private:
  struct Count {
    float share = 0.5F;
    std::uint32_t seen = 0;
  };
  std::vector<std::vector<Count>> counts_;
  std::vector<double> weights_;
  // Of the bit that was asked for last.
  std::array<Count*, kMostContexts> asked_{};
  std::array<double, kMostContexts> logit_{};
  std::size_t first_weight_ = 0;
  double mixed_ = 0.5;
};

class BitCoder {
 public:
  /// One that writes.
  BitCoder() = default;
  /// One that reads; place: for errors.
  BitCoder(std::span<const std::byte> bytes, std::string place);

  [[nodiscard]] bool is_reading() const { return is_reading_; }
  /// Returns the bit that is written: `wish`, or what was. Reading throws DamageError behind the
  /// end.
  bool code(BitModel& model, std::span<const std::uint32_t> contexts, bool wish,
            std::size_t set = 0);
  /// So many bits, 1 to 64, of which nothing is known.
  std::uint64_t raw(std::uint64_t wish, int bits);
  /// What was written. Once.
  [[nodiscard]] std::vector<std::byte> finish();
  [[noreturn]] void throw_damaged() const;

 private:
  bool code(std::uint32_t set_of_65536, bool wish);
  std::uint32_t next_byte();

  bool is_reading_ = false;
  std::uint32_t low_ = 0;
  std::uint32_t high_ = 0xFFFFFFFFU;
  std::vector<std::byte> written_;
  std::span<const std::byte> rest_;
  std::uint32_t value_ = 0;
  std::size_t behind_ = 0;  ///< bytes that were read behind the end
  std::string place_;
};

/// Whole numbers, small ones in few bits: how many binary digits, then the digits.
class NumberModel {
 public:
  explicit NumberModel(std::size_t contexts = 1);
  /// 0 to 2^40.
  std::uint64_t code(BitCoder& coder, std::uint64_t wish, std::uint32_t context = 0);
  /// -2^39 to 2^39.
  std::int64_t code_signed(BitCoder& coder, std::int64_t wish, std::uint32_t context = 0);

 private:
  bool bit(BitCoder& coder, std::uint32_t node, std::uint32_t context, bool wish);

  std::uint32_t contexts_;
  BitModel model_;
};

}  // namespace strata::memory::detail
