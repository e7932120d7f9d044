// SPDX-License-Identifier: Apache-2.0
#include "components/log/state_file.hpp"

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

StateFileWriter::StateFileWriter(std::filesystem::path file, double period_s)
    : file_(std::move(file)), period_s_(period_s), thread_([this] { work(); }) {}

bool StateFileWriter::is_due(Stamp now) {
  if (last_due_ && std::abs((now - *last_due_).seconds()) < period_s_) return false;
  last_due_ = now;
  return true;
}

StateFileWriter::~StateFileWriter() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void StateFileWriter::write(Bytes state) {
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(state);
  }
  changed_.notify_all();
}

void StateFileWriter::flush() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !waiting_ && !writes_; });
}

std::optional<std::string> StateFileWriter::take_error() {
  const std::lock_guard lock(mutex_);
  return std::exchange(error_, std::nullopt);
}

void StateFileWriter::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return waiting_ || ends_; });
    if (!waiting_) return;
    const Bytes state = std::move(*std::exchange(waiting_, std::nullopt));
    writes_ = true;
    lock.unlock();
    std::optional<std::string> error;
    try {
      write_state_file(file_, state);
    } catch (const std::exception& reason) {  // too little memory to compress, too
      error = reason.what();
    }
    lock.lock();
    writes_ = false;
    if (error) error_ = std::move(error);
    changed_.notify_all();
  }
}

}  // namespace strata::log
