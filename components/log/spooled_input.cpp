// SPDX-License-Identifier: Apache-2.0
#include "components/log/spooled_input.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

/// A file that no folder names: nothing is left of it after a kill.
int open_temporary(const fs::path& pipe) {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  std::string name = (folder / "strata-spooled-XXXXXX").string();
  const int file = error ? -1 : mkostemp(name.data(), O_CLOEXEC);
  if (file >= 0 && unlink(name.c_str()) == 0) return file;
  if (file >= 0) close(file);
  throw InputError(pipe.string(), "is a pipe, and cannot be copied into " + folder.string(),
                   "free some space there, or set TMPDIR to another folder");
}

ssize_t read_some(int file, std::array<char, 1 << 16>& bytes) {
  ssize_t got = 0;
  do {
    got = read(file, bytes.data(), bytes.size());
  } while (got < 0 && errno == EINTR);
  return got;
}

bool write_all(int file, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t put = write(file, bytes, size);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes += put;
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

void copy(int from, int to, const fs::path& pipe) {
  std::array<char, 1 << 16> bytes{};
  for (;;) {
    const ssize_t got = read_some(from, bytes);
    if (got == 0) return;
    if (got < 0) throw InputError(pipe.string(), "cannot be read", "check what writes into it");
    if (!write_all(to, bytes.data(), static_cast<std::size_t>(got))) {
      throw InputError(
          pipe.string(),
          "is a pipe, and its content does not fit into " + fs::temp_directory_path().string(),
          "free some space there, or set TMPDIR to another folder");
    }
  }
}

/// The pipes that were read, by what they are: one may have several names.
class Spools {
 public:
  fs::path path_of(const fs::path& pipe, const struct stat& status) {
    const std::lock_guard lock(mutex_);
    const auto key = std::pair(status.st_dev, status.st_ino);
    auto found = files_.find(key);
    if (found == files_.end()) found = files_.emplace(key, spool(pipe)).first;
    return "/proc/self/fd/" + std::to_string(found->second);
  }

 private:
  static int spool(const fs::path& pipe) {
    // Stays open, so that no other pipe can be taken for this one.
    const int from = open(pipe.c_str(), O_RDONLY | O_CLOEXEC);
    if (from < 0) throw InputError(pipe.string(), "cannot be opened", "check its permissions");
    const int to = open_temporary(pipe);
    copy(from, to, pipe);
    return to;
  }

  std::mutex mutex_;
  std::map<std::pair<dev_t, ino_t>, int> files_;
};

}  // namespace

fs::path readable_path(const fs::path& path) {
  static Spools spools;
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return path;
  if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) {
    throw InputError(path.string(), "is a device, not a file", "give a file or a pipe");
  }
  return S_ISFIFO(status.st_mode) ? spools.path_of(path, status) : path;
}

void require_reachable(const fs::path& path) {
  if (path.empty()) throw InputError("''", "is an empty name", "name a file or a folder");
  std::error_code error;
  if (fs::exists(path, error)) return;
  if (!error) throw InputError(path.string(), "does not exist", "check the path");
  throw InputError(path.string(), "cannot be reached: " + error.message(),
                   "check the path and the permissions of its folders");
}

bool is_pipe(const fs::path& path) {
  std::error_code error;
  return fs::is_fifo(path, error);
}

}  // namespace strata::log
