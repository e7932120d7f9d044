// SPDX-License-Identifier: Apache-2.0
/// One program at a time goes on from a folder of results and replaces it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace strata::log {

/// Held until its end, also that by a kill. The lock is a file ".NAME.lock" beside the folder,
/// since the folder itself is replaced; it goes with the lock.
class FolderLock {
 public:
  /// Waits while another program holds it: `wait` is called again and again with who that is, as
  /// "process 123", and returns false to give up. Throws OutputError when the file cannot be made,
  /// and Cancelled when `wait` gave up.
  FolderLock(const std::filesystem::path& folder,
             const std::function<bool(const std::string& holder)>& wait);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace strata::log
