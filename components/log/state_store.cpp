// SPDX-License-Identifier: Apache-2.0
#include "components/log/state_store.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <utility>

#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace strata::log {

void write_state_file(const std::filesystem::path& file, View state) {
  const Bytes packed = compress(state, BagCompression::kZstd);
  WholeFile whole(file);
  whole.stream().write(reinterpret_cast<const char*>(packed.data()),
                       static_cast<std::streamsize>(packed.size()));
  whole.commit();
}

Bytes read_state_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const Bytes packed{std::istreambuf_iterator<char>(in), {}};
  std::string damage;
  Bytes state =
      decompress(packed, BagCompression::kZstd, std::numeric_limits<std::uint32_t>::max(), damage);
  if (in.bad()) damage = "cannot be read";
  if (!damage.empty()) {
    throw InputError(file.string(), "is damaged: " + damage,
                     "take it from a backup, or remove it to begin anew");
  }
  return state;
}

StateStore::StateStore(StateStoreConfig config)
    : config_(std::move(config)), thread_([this] { work(); }) {}

StateStore::~StateStore() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::optional<Bytes> StateStore::load() const {
  std::error_code error;
  if (!std::filesystem::exists(config_.file, error)) return std::nullopt;
  return read_state_file(config_.file);
}

bool StateStore::is_due(Stamp now) {
  if (last_due_ && std::abs((now - *last_due_).seconds()) < config_.period_s) return false;
  last_due_ = now;
  return true;
}

void StateStore::write(Bytes state) {
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(state);
  }
  changed_.notify_all();
}

void StateStore::check() {
  std::optional<std::string> error;
  {
    const std::lock_guard lock(mutex_);
    error = std::exchange(error_, std::nullopt);
  }
  if (error) {
    throw OutputError(config_.file, "the state could not be written: " + *error,
                      "make room on the disk; it is tried again when the next state is due");
  }
}

void StateStore::flush() {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !waiting_ && !writes_; });
  }
  check();
}

void StateStore::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return waiting_ || ends_; });
    if (!waiting_) return;
    const Bytes state = std::move(*std::exchange(waiting_, std::nullopt));
    writes_ = true;
    lock.unlock();
    std::optional<std::string> error;
    try {
      write_state_file(config_.file, state);
    } catch (const Error& reason) {
      error = reason.problem();
    } catch (const std::exception& reason) {  // too little memory to compress
      error = reason.what();
    }
    lock.lock();
    writes_ = false;
    if (error) error_ = std::move(error);
    changed_.notify_all();
  }
}

}  // namespace strata::log
