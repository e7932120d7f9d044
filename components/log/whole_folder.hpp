// SPDX-License-Identifier: Apache-2.0
/// A folder that appears whole or not at all.
#pragma once

#include <filesystem>

#include "components/log/disk.hpp"

namespace strata::log {

/// Fill `aside()`, then `commit`; without it everything goes away again.
class WholeFolder {
 public:
  /// Throws OutputError when the folder exists and is not empty.
  explicit WholeFolder(const std::filesystem::path& folder, const Disk& disk = real_disk());
  ~WholeFolder();
  WholeFolder(const WholeFolder&) = delete;
  WholeFolder& operator=(const WholeFolder&) = delete;
  /// Beside the folder, ".NAME.partial-PID"; does not exist yet.
  [[nodiscard]] const std::filesystem::path& aside() const { return aside_; }
  /// Syncs everything in it and renames it. Throws OutputError.
  void commit();

 private:
  const Disk& disk_;
  std::filesystem::path folder_;
  std::filesystem::path aside_;
  bool committed_ = false;
};

}  // namespace strata::log
