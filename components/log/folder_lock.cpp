// SPDX-License-Identifier: Apache-2.0
#include "components/log/folder_lock.hpp"

#include <array>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "components/log/folder_name.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

/// Whether the open file is still the one of that name: who held it before has removed it.
bool is_still(int file, const fs::path& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(file, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

std::string holder_of(int file) {
  std::array<char, 32> text{};
  const ssize_t size = pread(file, text.data(), text.size(), 0);
  return size > 0 ? "process " + std::string(text.data(), static_cast<std::size_t>(size))
                  : "another process";
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder,
                       const std::function<bool(const std::string&)>& wait) {
  const fs::path whole = without_slash(fs::weakly_canonical(fs::absolute(folder)));
  path_ = whole.parent_path() / ("." + whole.filename().string() + ".lock");
  const auto fail = [this](int error) {
    throw OutputError(path_.string(), "cannot be made: " + std::generic_category().message(error),
                      "check the permissions of its folder");
  };
  for (;;) {
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file_ < 0) fail(errno);
    const bool is_free = flock(file_, LOCK_EX | LOCK_NB) == 0;
    if (!is_free && errno != EWOULDBLOCK) {
      const int error = errno;
      close(file_);
      fail(error);
    }
    if (is_free && is_still(file_, path_)) break;
    const std::string holder = holder_of(file_);
    close(file_);
    if (!is_free && !wait(holder)) throw Cancelled(folder.string());
  }
  const std::string self = std::to_string(getpid());
  if (ftruncate(file_, 0) != 0 || pwrite(file_, self.data(), self.size(), 0) < 0) {
    // A full disk: then nobody can say who holds it, but it is held.
  }
}

FolderLock::~FolderLock() {
  std::error_code ignored;
  fs::remove(path_, ignored);  // before it is free: who waits looks whether it is still there
  close(file_);
}

}  // namespace strata::log
