// SPDX-License-Identifier: Apache-2.0
/// The steps by which something new takes the place of something old on a disk that may lose its
/// power at any moment.
#pragma once

#include <filesystem>

#include "core/base/interface.hpp"

namespace strata::log {

/// Virtual, so that a test sees the order of the steps and can stop between two. Thread-safe.
class Disk : public Interface {
 public:
  /// Afterwards the file's content, or the names in the folder, outlast a power cut. Throws
  /// OutputError.
  virtual void sync(const std::filesystem::path& path) const;
  /// Replaces `to`. Throws OutputError.
  virtual void rename(const std::filesystem::path& from, const std::filesystem::path& to) const;
  /// Lets two names change places, at once. False, and nothing is done, where the file system
  /// cannot. Throws OutputError.
  [[nodiscard]] virtual bool exchange(const std::filesystem::path& a,
                                      const std::filesystem::path& b) const;
  /// A file, or a folder with what is in it. Throws OutputError.
  virtual void remove(const std::filesystem::path& path) const;
};

[[nodiscard]] const Disk& real_disk();

/// Syncs every file and folder below, and the folder itself. O(files).
void sync_tree(const Disk& disk, const std::filesystem::path& folder);

/// Syncs what lies at `from`, gives it the name `to`, and syncs the folder of that.
void put_in_place(const Disk& disk, const std::filesystem::path& from,
                  const std::filesystem::path& to);

/// Syncs the folder `fresh`, which takes the name of the folder `old`, and that one goes: both
/// change places at once, so that a kill or a power cut leaves the old folder or the new one. Where
/// the file system cannot exchange two names, the old one is called ".NAME.before" for a moment.
/// Both lie in one folder and are not links. Throws OutputError.
void replace_folder(const Disk& disk, const std::filesystem::path& fresh,
                    const std::filesystem::path& old);
/// Mends what a kill within replace_folder left of the name `old`. Throws OutputError.
void put_back(const Disk& disk, const std::filesystem::path& old);

/// The name under which something is written until it is whole: beside `path`, ".NAME.partial-PID".
[[nodiscard]] std::filesystem::path staged_name(const std::filesystem::path& path);
/// Removes what processes that are gone left beside `path` under such names: those killed while
/// they saved. One of another machine or container that shares the folder counts as gone.
void remove_left_over(const std::filesystem::path& path);
/// Whether the path lies in a folder that is still under such a name: that is synced as a whole.
[[nodiscard]] bool is_staged(const std::filesystem::path& path);

}  // namespace strata::log
