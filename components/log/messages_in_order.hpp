// SPDX-License-Identifier: Apache-2.0
/// The messages of a file in order of their stamps, though it is read piece by piece.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "components/log/bag.hpp"

namespace strata::log {

/// A chunk of a file, or a message outside of chunks.
struct BagPiece {
  std::uint64_t begin_ns = 0;  ///< stamp of its oldest message
  std::uint64_t offset = 0;    ///< in the file
  std::uint64_t size = 0;
  std::uint8_t kind = 0;  ///< opcode of its record
};

/// Loads no piece before a message of it may be the next one. Messages of one stamp come in the
/// order in which they were added.
class MessagesInOrder {
 public:
  /// All pieces, before the first `next`. O(pieces log pieces).
  void set_pieces(std::vector<BagPiece> pieces) {
    pieces_ = std::move(pieces);
    std::stable_sort(pieces_.begin(), pieces_.end(),
                     [](const BagPiece& a, const BagPiece& b) { return a.begin_ns < b.begin_ns; });
  }
  void add(BagMessage message) {
    waiting_.push_back({std::move(message), order_++});
    std::push_heap(waiting_.begin(), waiting_.end(), later);
  }
  /// Loads what the next message may lie in: load(piece) adds its messages.
  template <typename Load>
  void prefetch(Load&& load) {
    while (
        next_ < pieces_.size() &&
        (waiting_.empty() || pieces_[next_].begin_ns <=
                                 static_cast<std::uint64_t>(waiting_.front().message.stamp.ns))) {
      load(pieces_[next_++]);
    }
  }
  /// False at the end.
  template <typename Load>
  bool next(BagMessage& message, Load&& load) {
    prefetch(load);
    if (waiting_.empty()) return false;
    std::pop_heap(waiting_.begin(), waiting_.end(), later);
    message = std::move(waiting_.back().message);
    waiting_.pop_back();
    return true;
  }

 private:
  struct Waiting {
    BagMessage message;
    std::uint64_t order;
  };
  static bool later(const Waiting& a, const Waiting& b) {
    return std::pair(a.message.stamp, a.order) > std::pair(b.message.stamp, b.order);
  }

  std::vector<BagPiece> pieces_;
  std::size_t next_ = 0;
  std::vector<Waiting> waiting_;
  std::uint64_t order_ = 0;
};

}  // namespace strata::log
