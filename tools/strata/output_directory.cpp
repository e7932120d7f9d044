// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/output_directory.hpp"

#include <algorithm>
#include <cerrno>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "components/log/folder_name.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::tools {

void StagedPaths::add(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  paths_.insert(path);
}

void StagedPaths::forget(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  paths_.erase(path);
}

void StagedPaths::put_in_place(const fs::path& path, const std::function<void()>& put) {
  const std::lock_guard lock(mutex_);
  put();
  paths_.erase(path);
}

void StagedPaths::remove_all() noexcept {
  const std::lock_guard lock(mutex_);
  std::error_code ignored;
  for (const fs::path& path : paths_) fs::remove_all(path, ignored);
  paths_.clear();
}

namespace {

/// More in a folder that is not ours is not carried into another.
constexpr std::size_t kMaxCarried = 1000;

fs::path without_links(const fs::path& target) {
  fs::path whole = fs::weakly_canonical(fs::absolute(target));
  return log::without_slash(whole);
}

/// Whether this program, and so the one that called it, works in the folder or below.
bool stands_in(const fs::path& folder) {
  std::error_code error;
  const fs::path here = fs::weakly_canonical(fs::current_path(error), error);
  return !error && std::mismatch(folder.begin(), folder.end(), here.begin(), here.end()).first ==
                       folder.end();
}

/// How much of `old` the new folder does not bring; nothing when there is what cannot be carried.
std::optional<std::size_t> count_others(const fs::path& old, const fs::path& fresh) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(old)) {
    if (fs::exists(fresh / entry.path().filename())) continue;
    if (!entry.is_symlink() && !entry.is_directory() && !entry.is_regular_file()) {
      return std::nullopt;
    }
    ++count;
    if (entry.is_symlink() || !entry.is_directory()) continue;
    for (const auto& below : fs::recursive_directory_iterator(entry.path())) {
      const bool is_plain = below.is_symlink() || below.is_directory() || below.is_regular_file();
      if (!is_plain || ++count > kMaxCarried) return std::nullopt;
    }
  }
  return count <= kMaxCarried ? std::optional(count) : std::nullopt;
}

/// The same files under another name; where they cannot have two names, copies.
void link_or_copy(const fs::path& from, const fs::path& to) {
  if (fs::is_symlink(from)) {
    fs::copy_symlink(from, to);
  } else if (fs::is_directory(from)) {
    fs::create_directory(to, from);
    for (const auto& entry : fs::directory_iterator(from)) {
      link_or_copy(entry.path(), to / entry.path().filename());
    }
  } else {
    std::error_code error;
    fs::create_hard_link(from, to, error);
    if (error) fs::copy_file(from, to);
  }
}

[[noreturn]] void refuse(const fs::path& target, const std::error_code& error) {
  throw OutputError(target.string(), "cannot be written: " + error.message(),
                    "choose another --out or mend its permissions");
}

}  // namespace

OutputDirectory::OutputDirectory(fs::path target, StagedPaths& staged, const log::Disk& disk)
    : disk_(disk), target_(std::move(target)), staged_(staged) {
  if (target_.empty()) throw OutputError("--out", "is empty", "name a folder");
  target_ = log::without_slash(target_);
  try {
    find_place();
  } catch (const fs::filesystem_error& error) {
    refuse(target_, error.code());
  }
  make_folder();
}

void OutputDirectory::find_place() {
  put_back(target_, disk_);
  if (fs::exists(target_) && !fs::is_directory(target_)) {
    throw OutputError(target_.string(), "exists and is not a folder", "choose another --out");
  }
  // "." and ".." have no usable name of their own to stand beside.
  whole_ = without_links(target_);
  if (fs::exists(whole_) && access(whole_.c_str(), W_OK | X_OK) != 0) {
    refuse(target_, {errno, std::generic_category()});
  }
  log::remove_left_over(whole_);
  path_ = log::staged_name(whole_);
}

void OutputDirectory::make_folder() {
  std::error_code error;
  for (fs::path above = path_.parent_path(); !fs::exists(above, error) && above.has_filename();
       above = above.parent_path()) {
    made_ = above;
  }
  staged_.add(path_);
  fs::remove_all(path_, error);
  fs::create_directories(path_, error);
  if (!error) return;
  remove_what_was_made();
  refuse(target_, error);
}

OutputDirectory::~OutputDirectory() {
  if (!committed_) remove_what_was_made();
}

void OutputDirectory::remove_what_was_made() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  staged_.forget(path_);
  if (made_.empty()) return;
  // Only while they are empty: somebody else may have put something there.
  for (fs::path above = path_.parent_path(); fs::remove(above, ignored) && above != made_;) {
    above = above.parent_path();
  }
}

void OutputDirectory::commit() {
  staged_.put_in_place(path_, [this] { put_in_place(); });
  committed_ = true;
}

void OutputDirectory::put_back(const fs::path& target, const log::Disk& disk) {
  log::put_back(disk, without_links(target));
}

void OutputDirectory::put_in_place() const {
  try {
    if (!fs::exists(whole_)) {
      log::put_in_place(disk_, path_, whole_);
    } else if (stands_in(whole_) || !count_others(whole_, path_)) {
      replace_entries();
    } else {
      replace_folder();
    }
  } catch (const fs::filesystem_error& error) {
    throw OutputError(target_.string(), "cannot be put in place: " + error.code().message(),
                      "choose another --out or mend its permissions");
  }
}

void OutputDirectory::replace_entries() const {
  log::sync_tree(disk_, path_);
  for (const auto& entry : fs::directory_iterator(path_)) {
    const fs::path to = whole_ / entry.path().filename();
    if (fs::is_directory(to)) disk_.remove(to);
    disk_.rename(entry.path(), to);
  }
  disk_.sync(whole_);
  disk_.remove(path_);
}

void OutputDirectory::replace_folder() const {
  for (const auto& entry : fs::directory_iterator(whole_)) {
    const fs::path to = path_ / entry.path().filename();
    if (!fs::exists(to)) link_or_copy(entry.path(), to);
  }
  fs::permissions(path_, fs::status(whole_).permissions());
  log::replace_folder(disk_, path_, whole_);
}

}  // namespace strata::tools
