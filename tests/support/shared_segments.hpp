// SPDX-License-Identifier: Apache-2.0
/// The shared memory segments of Fast DDS that a process holds.
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace strata::test {

/// process: its number, or "self". The lock files of its segments, those of ports left out.
inline std::set<std::filesystem::path> segment_locks_of(const std::string& process) {
  std::set<std::filesystem::path> locks;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/" + process + "/fd")) {
    std::error_code error;
    const std::string file = std::filesystem::read_symlink(entry.path(), error).string();
    if (!error && file.rfind("/dev/shm/fastrtps_", 0) == 0 && file.ends_with("_el") &&
        file.find("port") == std::string::npos) {
      locks.insert(file);
    }
  }
  return locks;
}

inline std::filesystem::path segment_of_lock(const std::filesystem::path& lock) {
  const std::string text = lock.string();
  return text.substr(0, text.size() - 3);
}

}  // namespace strata::test
