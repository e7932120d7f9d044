// SPDX-License-Identifier: Apache-2.0
#include "components/log/background_file.hpp"

#include <utility>

#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace strata::log {

BackgroundFile::BackgroundFile(std::filesystem::path file, Write write)
    : file_(std::move(file)), write_(std::move(write)) {}

BackgroundFile::~BackgroundFile() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void BackgroundFile::write(Bytes content) {
  // First: what waits without a thread would be waited for without end.
  if (!thread_.joinable()) thread_ = std::thread([this] { work(); });
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(content);
  }
  changed_.notify_all();
}

void BackgroundFile::check() {
  std::optional<std::string> error;
  {
    const std::lock_guard lock(mutex_);
    error = std::exchange(error_, std::nullopt);
  }
  if (error) {
    throw OutputError(file_.string(), "the state could not be written: " + *error,
                      "make room on the disk; it is tried again when the next state is due");
  }
}

void BackgroundFile::flush() {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !waiting_ && !writes_; });
  }
  check();
}

void BackgroundFile::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return waiting_ || ends_; });
    if (!waiting_) return;
    const Bytes content = std::move(*std::exchange(waiting_, std::nullopt));
    writes_ = true;
    lock.unlock();
    std::optional<std::string> error;
    try {
      write_(file_, content);
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

void write_whole_file(const std::filesystem::path& file, View content) {
  WholeFile whole(file);
  whole.stream().write(reinterpret_cast<const char*>(content.data()),
                       static_cast<std::streamsize>(content.size()));
  whole.commit();
}

}  // namespace strata::log
