// SPDX-License-Identifier: Apache-2.0
/// A file that is written behind the back of who fills it: a robot must not wait for its disk.
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "components/log/compression.hpp"
#include "components/log/newest_work.hpp"

namespace strata::log {

/// The newest content in a file, whole or not at all; what waits is written before it goes. One
/// thread at a time may call it.
class BackgroundFile {
 public:
  using Write = std::function<void(const std::filesystem::path&, View)>;

  /// write: puts the bytes into the file; what it throws is kept for `check`.
  BackgroundFile(std::filesystem::path file, Write write);
  [[nodiscard]] const std::filesystem::path& path() const { return file_; }
  /// Returns at once. What waits to be written gives way to something newer.
  void write(Bytes content);
  /// Throws OutputError when something could not be written: once for each.
  void check();
  /// Waits until what was handed over is written; throws as check.
  void flush();

 private:
  void put_into_file(const Bytes& content);

  std::filesystem::path file_;
  Write write_;
  std::mutex mutex_;
  std::optional<std::string> error_;  // under mutex_
  NewestWork<Bytes> work_;            // last: it uses the others
};

/// A Write: the bytes as they are.
void write_whole_file(const std::filesystem::path& file, View content);

}  // namespace strata::log
