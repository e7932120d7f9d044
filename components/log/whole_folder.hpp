// SPDX-License-Identifier: Apache-2.0
/// A folder that appears whole or not at all.
#pragma once

#include <filesystem>

#include "components/log/disk.hpp"

namespace strata::log {

/// Fill `aside()`, then `commit`; without it everything goes away again.
class WholeFolder {
 public:
  enum class Existing { kRefuse, kReplace };
  /// existing: what to do with a folder of that name that is not empty; where it is replaced, what
  /// the new one does not have itself is taken over. Throws OutputError when it is to be refused,
  /// or when the name is another thing's.
  explicit WholeFolder(const std::filesystem::path& folder, const Disk& disk = real_disk(),
                       Existing existing = Existing::kRefuse);
  ~WholeFolder();
  WholeFolder(const WholeFolder&) = delete;
  WholeFolder& operator=(const WholeFolder&) = delete;
  /// Beside the folder, ".NAME.partial-PID"; does not exist yet.
  [[nodiscard]] const std::filesystem::path& aside() const { return aside_; }
  /// Syncs everything in it and renames it, in the place of the one that is to be replaced (see
  /// replace_folder). Throws OutputError.
  void commit();

 private:
  void take_over_others() const;
  const Disk& disk_;
  std::filesystem::path folder_;
  std::filesystem::path aside_;
  bool committed_ = false;
};

}  // namespace strata::log
