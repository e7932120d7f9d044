// SPDX-License-Identifier: Apache-2.0
/// Saved states (core/base/state_archive.hpp) in files: zstd with a checksum, whole or not at all.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "components/log/background_file.hpp"
#include "components/log/compression.hpp"
#include "components/log/disk.hpp"
#include "core/base/config.hpp"
#include "core/base/time.hpp"

namespace strata::log {

/// Makes the folder, where there is none. Throws OutputError, and leaves the file of before.
void write_state_file(const std::filesystem::path& file, View state,
                      const Disk& disk = real_disk());

/// Throws InputError for a file that cannot be read, DamageError for one that is damaged.
[[nodiscard]] Bytes read_state_file(const std::filesystem::path& file);

/// What a component that was stopped goes on with.
struct StateStoreConfig {
  std::string file;
  double period_s = 30.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("file", c.file,
            {.doc = "live: keep what was learned in this file, and go on from it when it exists; "
                    "empty: in RAM only",
             .when = "learning shall go on after a restart"});
    v.field("period_s", c.period_s,
            {.doc = "written this often, by the stamps of the scans, and when the component is "
                    "deactivated; what a crash may lose at most",
             .unit = "s",
             .min = 0.0});
  }
};

/// The state of a component in a file, written behind its back: it must not wait for compression
/// and disk.
class StateStore {
 public:
  /// config.file: not empty.
  explicit StateStore(const StateStoreConfig& config);

  [[nodiscard]] std::string file() const { return file_.path().string(); }
  /// Nothing when there is no file yet. Throws as read_state_file.
  [[nodiscard]] std::optional<Bytes> load() const;
  /// Whether a period of scans has passed since it was last true, or it is the first time. A clock
  /// that was set back is a reason to write, too.
  [[nodiscard]] bool is_due(Stamp now);
  /// Returns at once. A state that waits to be written gives way to a newer one.
  void write(Bytes state) { file_.write(std::move(state)); }
  /// Throws OutputError when a state could not be written: once for each.
  void check() { file_.check(); }
  /// Waits until what was handed over is written; throws as check.
  void flush() { file_.flush(); }

 private:
  double period_s_;
  std::optional<Stamp> last_due_;
  BackgroundFile file_;
};

}  // namespace strata::log
