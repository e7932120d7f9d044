// SPDX-License-Identifier: Apache-2.0
#include "components/log/state_store.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <system_error>
#include <utility>

#include "components/log/whole_file.hpp"
#include "core/base/damage.hpp"

namespace strata::log {

void write_state_file(const std::filesystem::path& file, View state, const Disk& disk) {
  const Bytes packed = compress(state, BagCompression::kZstd);
  std::error_code error;  // without the folder the file says what is wrong
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  WholeFile whole(file, disk);
  whole.stream().write(reinterpret_cast<const char*>(packed.data()),
                       static_cast<std::streamsize>(packed.size()));
  whole.commit();
}

Bytes read_state_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const bool is_open = in.is_open();
  const Bytes packed{std::istreambuf_iterator<char>(in), {}};
  if (!is_open || in.bad() || std::filesystem::is_directory(file)) {
    throw InputError(file.string(), "cannot be read", "check the file and its permissions");
  }
  std::string damage;
  Bytes state =
      decompress(packed, BagCompression::kZstd, std::numeric_limits<std::uint32_t>::max(), damage);
  if (!damage.empty()) {
    throw DamageError(file.string(), "is damaged: " + damage,
                      "take it from a backup, or remove it to begin anew");
  }
  return state;
}

StateStore::StateStore(const StateStoreConfig& config)
    : period_s_(config.period_s),
      file_(config.file,
            [](const std::filesystem::path& file, View state) { write_state_file(file, state); }) {}

std::optional<Bytes> StateStore::load() const {
  std::error_code error;
  if (!std::filesystem::exists(file_.path(), error)) return std::nullopt;
  return read_state_file(file_.path());
}

bool StateStore::is_due(Stamp now) {
  if (last_due_ && std::abs((now - *last_due_).seconds()) < period_s_) return false;
  last_due_ = now;
  return true;
}

}  // namespace strata::log
