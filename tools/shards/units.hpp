// SPDX-License-Identifier: Apache-2.0
/// A program whose work is units that do not depend on each other (seeds, worlds): all here, some
/// of them here, or all from what shards left. What follows from the units is the same code each
/// time, so it comes to the same bits.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/state_archive.hpp"
#include "tools/shards/shard_folder.hpp"

namespace strata::shards {

class Units {
 public:
  /// Computes all.
  Units() = default;
  /// Computes every N-th from the I-th on; of the others comes a value as it is made.
  explicit Units(const Shard& shard) : shard_(shard) {}
  /// Takes all from these shards. Throws as read_all_shards and read_shard_results.
  explicit Units(const std::vector<ShardFolder>& shards);

  /// The value of the next unit. name: as no other's. Throws DamageError where shards lack it.
  template <typename T, typename Compute>
  T of(const std::string& name, Compute compute) {
    const int owner = static_cast<int>(count_++ % static_cast<std::size_t>(shard_.count)) + 1;
    T value{};
    if (is_merged_) {
      const auto found = kept_.find(name);
      if (found == kept_.end()) fail_without(name);
      StateReader read(found->second, name);
      read(value);
      read.expect_end();
      return value;
    }
    if (owner != shard_.index) return value;
    value = compute();
    ++own_;
    if (shard_.count == 1) return value;
    StateWriter write;
    write(value);
    kept_[name] = write.take();
    return value;
  }

  /// False for a shard: what follows from some of the units is no result.
  [[nodiscard]] bool is_whole() const { return shard_.count == 1; }
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Of them, computed here.
  [[nodiscard]] std::size_t own() const { return own_; }
  /// What write_shard is given.
  [[nodiscard]] log::Bytes results() const;

 private:
  [[noreturn]] static void fail_without(const std::string& name);
  Shard shard_;
  bool is_merged_ = false;
  std::size_t count_ = 0;
  std::size_t own_ = 0;
  std::map<std::string, log::Bytes> kept_;
};

}  // namespace strata::shards
