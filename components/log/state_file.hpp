// SPDX-License-Identifier: Apache-2.0
/// Saved states (core/base/state_archive.hpp) in files: zstd with a checksum, whole or not at all.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "components/log/compression.hpp"
#include "core/base/time.hpp"

namespace strata::log {

/// Throws OutputError, and leaves the file of before.
void write_state_file(const std::filesystem::path& file, View state);

/// Throws InputError for a file that cannot be read or is damaged.
[[nodiscard]] Bytes read_state_file(const std::filesystem::path& file);

/// Writes states behind the back of a component that must not wait for compression and disk.
class StateFileWriter {
 public:
  explicit StateFileWriter(std::filesystem::path file, double period_s = 0.0);
  /// As flush.
  ~StateFileWriter();
  StateFileWriter(const StateFileWriter&) = delete;
  StateFileWriter& operator=(const StateFileWriter&) = delete;

  /// Whether a period of scans has passed since it was last true, or it is the first time. A clock
  /// that was set back is a reason to write, too.
  [[nodiscard]] bool is_due(Stamp now);
  /// Returns at once. A state that waits to be written gives way to a newer one.
  void write(Bytes state);
  /// Waits until what was handed over is written, or could not be.
  void flush();
  /// Why the last state could not be written: once for each.
  [[nodiscard]] std::optional<std::string> take_error();

 private:
  void work();

  std::filesystem::path file_;
  double period_s_;
  std::optional<Stamp> last_due_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Bytes> waiting_;      // under mutex_
  bool writes_ = false;               // under mutex_
  bool ends_ = false;                 // under mutex_
  std::optional<std::string> error_;  // under mutex_
  std::thread thread_;                // last: it uses the others
};

}  // namespace strata::log
