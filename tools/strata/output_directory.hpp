// SPDX-License-Identifier: Apache-2.0
/// A folder of results that appears whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <set>

namespace strata::tools {

/// Folders and files under way, so that a hard end of the program can remove them.
class StagedPaths {
 public:
  void add(const std::filesystem::path& path);
  void forget(const std::filesystem::path& path);
  /// Runs `put`, which moves `path` to where it belongs, and forgets the path when it succeeded;
  /// meanwhile remove_all waits, so that a hard end cannot come between two renames.
  void put_in_place(const std::filesystem::path& path, const std::function<void()>& put);
  /// Removes everything under way; errors are ignored.
  void remove_all() noexcept;

 private:
  std::mutex mutex_;
  std::set<std::filesystem::path> paths_;
};

/// Write into `path()`, then `commit()`. The folder lies beside the target and is renamed to it;
/// when the target exists already, its entries of the same names are replaced one by one and others
/// are left alone (`--out .` must not wipe a home directory). Without commit it is removed.
class OutputDirectory {
 public:
  /// Throws OutputError when the folder cannot be made or the target is not a folder.
  OutputDirectory(std::filesystem::path target, StagedPaths& staged);
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// Throws OutputError.
  void commit();

 private:
  void put_in_place() const;
  std::filesystem::path target_;
  std::filesystem::path path_;
  StagedPaths& staged_;
  bool committed_ = false;
};

}  // namespace strata::tools
