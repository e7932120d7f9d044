// SPDX-License-Identifier: Apache-2.0
/// A bag file of pieces, chunks and messages outside of them, that is read as its messages are
/// asked for: what the readers of MCAP and of ROS 1 share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "components/log/bag.hpp"
#include "components/log/compression.hpp"
#include "components/log/messages_in_order.hpp"

namespace strata::log {

/// No honest chunk is larger; a damaged length must not take the machine's memory.
constexpr std::uint64_t kLargestChunk = 512ULL << 20;

class PiecewiseBagReader : public BagReader {
 public:
  /// shown: the file's name in messages. Throws InputError when the file cannot be opened.
  PiecewiseBagReader(const std::filesystem::path& file, const std::filesystem::path& shown);

  /// Before anything else: finds the pieces. Throws InputError for what is no such bag, and for a
  /// damaged one without a topic; a whole one without a topic is a recording of nothing.
  void start();
  const BagDamage& damage() const override { return damage_; }
  bool next(BagMessage& message) override;

 protected:
  /// Tells every piece of the file (`pieces`), and the topics that are known without its chunks.
  virtual void find_pieces() = 0;
  /// Hands over the messages of a piece (add_message).
  virtual void load(const BagPiece& piece) = 0;

  void add_message(BagMessage message) { messages_.add(std::move(message)); }
  [[nodiscard]] std::vector<BagPiece>& pieces() { return pieces_; }  ///< until all are found
  void note_damage(std::uint64_t offset, const std::string& why) {
    damage_.add(place(offset) + ": " + why);
  }
  void note_damage(const std::string& place_and_reason) { damage_.add(place_and_reason); }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t file_size() const { return size_; }
  /// "bag.mcap: byte 12".
  [[nodiscard]] std::string place(std::uint64_t offset) const {
    return name_ + ": byte " + std::to_string(offset);
  }
  /// Fewer bytes where the file ends.
  [[nodiscard]] Bytes read(std::uint64_t offset, std::uint64_t size);

 private:
  std::string name_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
  std::vector<BagPiece> pieces_;
  MessagesInOrder messages_;
  BagDamage damage_;
};

/// A reader that has started.
template <typename Reader>
[[nodiscard]] std::unique_ptr<BagReader> start_reader(const std::filesystem::path& file,
                                                      const std::filesystem::path& shown) {
  auto reader = std::make_unique<Reader>(file, shown);
  reader->start();
  return reader;
}

}  // namespace strata::log
