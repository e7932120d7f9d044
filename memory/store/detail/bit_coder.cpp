// SPDX-License-Identifier: Apache-2.0
#include "memory/store/detail/bit_coder.hpp"

#include <algorithm>
#include <utility>

#include "core/base/damage.hpp"
#include "memory/store/detail/plain_math.hpp"

namespace strata::memory::detail {
namespace {

constexpr double kFirstWeight = 0.3;
constexpr double kWeightRate = 0.02;
/// From 1 / this on, a count forgets as fast as it learns.
constexpr double kSlowestRate = 0.004;
constexpr double kLeastShare = 0.0005;
constexpr double kLeastMixed = 32.0 / 65536.0;

// A number is told by its digits' count, then by the digits; the first three of them by what
// stands before them, the others by their place.
constexpr std::uint32_t kMostDigits = 40;
constexpr std::uint32_t kNodesOfDigits = 8 + kMostDigits;
constexpr std::uint32_t kNodes = kMostDigits + 1 + (kMostDigits + 1) * kNodesOfDigits;

}  // namespace

BitModel::BitModel(const std::vector<std::size_t>& sizes, std::size_t sets)
    : weights_(sizes.size() * sets, kFirstWeight) {
  counts_.reserve(sizes.size());
  for (const std::size_t size : sizes) counts_.emplace_back(size);
}

std::uint32_t BitModel::probability(std::span<const std::uint32_t> contexts, std::size_t set) {
  first_weight_ = set * counts_.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    asked_[i] = &counts_[i][contexts[i]];
    const double share =
        std::clamp(static_cast<double>(asked_[i]->share), kLeastShare, 1.0 - kLeastShare);
    logit_[i] = plain_ln(share / (1.0 - share));
    sum += weights_[first_weight_ + i] * logit_[i];
  }
  mixed_ = 1.0 / (1.0 + plain_exp(-std::clamp(sum, -20.0, 20.0)));
  mixed_ = std::clamp(mixed_, kLeastMixed, 1.0 - kLeastMixed);
  return static_cast<std::uint32_t>(mixed_ * 65536.0);
}

void BitModel::learn(bool bit) {
  const double target = bit ? 1.0 : 0.0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    weights_[first_weight_ + i] += kWeightRate * (target - mixed_) * logit_[i];
    Count& count = *asked_[i];
    const double rate = std::max(1.0 / (count.seen + 1.5), kSlowestRate);
    const auto share = static_cast<double>(count.share);
    count.share = static_cast<float>(share + rate * (target - share));
    ++count.seen;
  }
}

BitCoder::BitCoder(std::span<const std::byte> bytes, std::string place)
    : is_reading_(true), rest_(bytes), place_(std::move(place)) {
  for (int i = 0; i < 4; ++i) value_ = (value_ << 8U) | next_byte();
}

std::uint32_t BitCoder::next_byte() {
  // finish() leaves out what reads as zeros.
  constexpr std::size_t kMostBehind = 4;
  if (rest_.empty()) {
    if (++behind_ > kMostBehind) throw_damaged();
    return 0;
  }
  const auto byte = static_cast<std::uint32_t>(rest_.front());
  rest_ = rest_.subspan(1);
  return byte;
}

bool BitCoder::code(std::uint32_t set_of_65536, bool wish) {
  const std::uint32_t width = high_ - low_;
  const std::uint32_t middle =
      low_ + static_cast<std::uint32_t>((std::uint64_t{width} * set_of_65536) >> 16U);
  const bool bit = is_reading_ ? value_ <= middle : wish;
  if (bit) {
    high_ = middle;
  } else {
    low_ = middle + 1;
  }
  while (((low_ ^ high_) >> 24U) == 0) {
    if (is_reading_) {
      value_ = (value_ << 8U) | next_byte();
    } else {
      written_.push_back(static_cast<std::byte>(high_ >> 24U));
    }
    low_ <<= 8U;
    high_ = (high_ << 8U) | 0xFFU;
  }
  return bit;
}

bool BitCoder::code(BitModel& model, std::span<const std::uint32_t> contexts, bool wish,
                    std::size_t set) {
  const bool bit = code(model.probability(contexts, set), wish);
  model.learn(bit);
  return bit;
}

std::uint64_t BitCoder::raw(std::uint64_t wish, int bits) {
  constexpr std::uint32_t kEven = 32768;
  std::uint64_t value = 0;
  for (int i = bits - 1; i >= 0; --i) {
    value =
        (value << 1U) | (code(kEven, ((wish >> static_cast<unsigned>(i)) & 1U) != 0U) ? 1U : 0U);
  }
  return value;
}

std::vector<std::byte> BitCoder::finish() {
  // Their first bytes differ, so that this one with zeros behind lies between low_ and high_.
  written_.push_back(static_cast<std::byte>(high_ >> 24U));
  return std::move(written_);
}

void BitCoder::throw_damaged() const {
  throw DamageError(place_, "is damaged: its scans are not whole",
                    "push the visit again from the robot that drove it");
}

NumberModel::NumberModel(std::size_t contexts)
    : contexts_(static_cast<std::uint32_t>(contexts)),
      model_({kNodes, std::size_t{kNodes} * contexts}) {}

bool NumberModel::bit(BitCoder& coder, std::uint32_t node, std::uint32_t context, bool wish) {
  const std::array<std::uint32_t, 2> contexts{node, node * contexts_ + context};
  return coder.code(model_, contexts, wish);
}

std::uint64_t NumberModel::code(BitCoder& coder, std::uint64_t wish, std::uint32_t context) {
  const std::uint64_t wanted = wish + 1;  // at least one digit, the first of which is 1
  std::uint32_t digits = 0;
  while (digits < kMostDigits && bit(coder, digits, context, (wanted >> (digits + 1)) != 0)) {
    ++digits;
  }
  const std::uint32_t first = kMostDigits + 1 + digits * kNodesOfDigits;
  std::uint64_t value = 1;
  for (std::uint32_t done = 0; done < digits; ++done) {
    const std::uint32_t node = done < 3 ? static_cast<std::uint32_t>(value) : 8 + done;
    const bool is_set =
        bit(coder, first + node, context, ((wanted >> (digits - done - 1)) & 1U) != 0);
    value = (value << 1U) | (is_set ? 1U : 0U);
  }
  return value - 1;
}

std::int64_t NumberModel::code_signed(BitCoder& coder, std::int64_t wish, std::uint32_t context) {
  const auto code_of =
      wish > 0 ? 2 * static_cast<std::uint64_t>(wish) - 1 : 2 * static_cast<std::uint64_t>(-wish);
  const std::uint64_t coded = code(coder, code_of, context);
  const auto half = static_cast<std::int64_t>((coded + 1) / 2);
  return coded % 2 == 1 ? half : -half;
}

}  // namespace strata::memory::detail
