// SPDX-License-Identifier: Apache-2.0
#include "components/log/background_file.hpp"

#include <utility>

#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace strata::log {

BackgroundFile::BackgroundFile(std::filesystem::path file, Write write)
    : file_(std::move(file)),
      write_(std::move(write)),
      work_([this](const Bytes& content) { put_into_file(content); }) {}

void BackgroundFile::write(Bytes content) {
  work_.put([&](std::optional<Bytes>& waiting) { waiting = std::move(content); });
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
  work_.wait();
  check();
}

void BackgroundFile::put_into_file(const Bytes& content) {
  std::string error;
  try {
    return write_(file_, content);
  } catch (const Error& reason) {
    error = reason.problem();
  } catch (const std::exception& reason) {  // too little memory to compress
    error = reason.what();
  }
  const std::lock_guard lock(mutex_);
  error_ = std::move(error);
}

void write_whole_file(const std::filesystem::path& file, View content) {
  WholeFile whole(file);
  whole.stream().write(reinterpret_cast<const char*>(content.data()),
                       static_cast<std::streamsize>(content.size()));
  whole.commit();
}

}  // namespace strata::log
