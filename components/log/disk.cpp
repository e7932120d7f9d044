// SPDX-License-Identifier: Apache-2.0
#include "components/log/disk.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr const char* kPartialMark = ".partial-";

[[noreturn]] void fail(const fs::path& path, int error) {
  throw OutputError(path.string(), "cannot be written: " + std::generic_category().message(error),
                    "check the folder's permissions and free space");
}

/// Of a name without folder: the current one.
fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Has ended and was not asked how, as what is killed in a container whose first process asks
/// nobody.
bool is_zombie(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(in, text);
  const std::size_t name_end = text.rfind(')');  // a name may hold anything
  return name_end != std::string::npos && text.compare(name_end, 3, ") Z") == 0;
}

bool is_gone(pid_t process) {
  return (kill(process, 0) != 0 && errno == ESRCH) || is_zombie(process);
}

fs::path before_name(const fs::path& path) {
  return path.parent_path() / ("." + path.filename().string() + ".before");
}

}  // namespace

void Disk::sync(const fs::path& path) const {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail(path, errno);
  const int error = fsync(file) == 0 ? 0 : errno;
  close(file);
  // Some file systems have nothing to sync, above all for folders.
  if (error != 0 && error != EINVAL && error != ENOTSUP && error != EROFS) fail(path, error);
}

void Disk::rename(const fs::path& from, const fs::path& to) const {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) fail(to, error.value());
}

bool Disk::exchange(const fs::path& a, const fs::path& b) const {
  if (renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return true;
  if (errno == EINVAL || errno == ENOSYS || errno == ENOTSUP) return false;
  fail(b, errno);
}

void Disk::remove(const fs::path& path) const {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) fail(path, error.value());
}

const Disk& real_disk() {
  static const Disk disk;
  return disk;
}

void sync_tree(const Disk& disk, const fs::path& folder) {
  // Sorted: the same order everywhere.
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_symlink()) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  for (const fs::path& path : paths) disk.sync(path);
  disk.sync(folder);
}

void put_in_place(const Disk& disk, const fs::path& from, const fs::path& to) {
  if (fs::is_directory(from)) {
    sync_tree(disk, from);
  } else {
    disk.sync(from);
  }
  disk.rename(from, to);
  disk.sync(folder_of(to));
}

void replace_folder(const Disk& disk, const fs::path& fresh, const fs::path& old) {
  sync_tree(disk, fresh);
  if (disk.exchange(fresh, old)) {
    disk.sync(folder_of(old));
    disk.remove(fresh);
    return;
  }
  const fs::path before = before_name(old);
  disk.rename(old, before);
  disk.rename(fresh, old);
  disk.sync(folder_of(old));
  disk.remove(before);
}

void put_back(const Disk& disk, const fs::path& old) {
  const fs::path before = before_name(old);
  std::error_code ignored;
  if (!fs::is_directory(before, ignored)) return;
  if (fs::exists(old, ignored)) {
    disk.remove(before);  // the new one has the name already
  } else {
    disk.rename(before, old);
  }
}

fs::path staged_name(const fs::path& path) {
  return path.parent_path() /
         ("." + path.filename().string() + kPartialMark + std::to_string(getpid()));
}

void remove_left_over(const fs::path& path) {
  if (is_staged(path)) return;  // its folder is new
  const std::string prefix = "." + path.filename().string() + kPartialMark;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_of(path), error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const char* const end = name.data() + name.size();
    pid_t process = 0;
    const auto parsed = std::from_chars(name.data() + prefix.size(), end, process);
    if (parsed.ec != std::errc{} || parsed.ptr != end || process <= 0) continue;
    std::error_code ignored;
    if (is_gone(process)) fs::remove_all(entry.path(), ignored);
  }
}

bool is_staged(const fs::path& path) {
  const fs::path folder = path.parent_path();
  return std::any_of(folder.begin(), folder.end(), [](const fs::path& part) {
    const std::string name = part.string();
    return name.starts_with('.') && name.find(kPartialMark) != std::string::npos;
  });
}

}  // namespace strata::log
