// SPDX-License-Identifier: Apache-2.0
/// A folder of results that appears whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <set>

#include "components/log/disk.hpp"

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
/// when the target exists already, its entries of the same names are replaced and others stay. Both
/// change places at once, after what stays was linked into the new one, so that a kill or a power
/// cut leaves the old folder or the new one. Where the file system cannot exchange two names, the
/// old one is called ".NAME.before" for a moment; the next OutputDirectory, or `put_back`, gives it
/// its name again. A folder that programs stand in (`--out .`), or with much that is not ours
/// (`--out ~`), is kept, and its entries are replaced one by one. Without commit the new folder is
/// removed, and the folders above it that had to be made. What a process that was killed left of
/// its own goes, too. Made before the work, so that one that cannot be written is told at once.
class OutputDirectory {
 public:
  /// Throws OutputError when the folder cannot be made, the target is not a folder, or may not be
  /// written.
  OutputDirectory(std::filesystem::path target, StagedPaths& staged,
                  const log::Disk& disk = log::real_disk());
  ~OutputDirectory();
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// Throws OutputError.
  void commit();
  /// Mends what a kill left of a folder's name, as said above. Throws OutputError.
  static void put_back(const std::filesystem::path& target,
                       const log::Disk& disk = log::real_disk());

 private:
  void find_place();
  void make_folder();
  void remove_what_was_made();
  void put_in_place() const;
  void replace_entries() const;
  void replace_folder() const;
  const log::Disk& disk_;
  std::filesystem::path target_;
  std::filesystem::path whole_;  ///< the target without links
  std::filesystem::path path_;
  std::filesystem::path made_;  ///< the uppermost folder above it that had to be made, or empty
  StagedPaths& staged_;
  bool committed_ = false;
};

}  // namespace strata::tools
