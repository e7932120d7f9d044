// SPDX-License-Identifier: Apache-2.0
#include "tools/shards/units.hpp"

#include "core/base/damage.hpp"

namespace strata::shards {

Units::Units(const std::vector<ShardFolder>& shards) : is_merged_(true) {
  for (const ShardFolder& shard : shards) {
    const log::Bytes bytes = read_shard_results(shard.path);
    StateReader read(bytes, (shard.path / kShardResults).string());
    const std::size_t units = read.length(sizeof(std::uint32_t));
    for (std::size_t i = 0; i < units; ++i) {
      std::string name;
      read(name);
      read(kept_[name]);
    }
    read.expect_end();
  }
}

log::Bytes Units::results() const {
  StateWriter write;
  write(static_cast<std::uint64_t>(kept_.size()));
  for (const auto& [name, bytes] : kept_) {
    write(name);
    write(bytes);
  }
  return write.take();
}

void Units::fail_without(const std::string& name) {
  throw DamageError("--merge", "the shards lack " + name, "run all of them again");
}

}  // namespace strata::shards
