// SPDX-License-Identifier: Apache-2.0
#include "components/bus/shared_memory.hpp"

#include <algorithm>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace strata::bus {
namespace {

namespace fs = std::filesystem;

/// Of "fastrtps_974d27f10541dd8f_el": the segment; empty for anything else.
std::string segment_of(const std::string& lock_name) {
  constexpr std::string_view kPrefix = "fastrtps_";
  constexpr std::string_view kSuffix = "_el";
  constexpr std::size_t kDigits = 16;
  if (lock_name.size() != kPrefix.size() + kDigits + kSuffix.size()) return {};
  const std::string_view digits = std::string_view(lock_name).substr(kPrefix.size(), kDigits);
  const bool is_segment =
      lock_name.rfind(kPrefix, 0) == 0 && std::string_view(lock_name).ends_with(kSuffix) &&
      std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isxdigit(c); });
  return is_segment ? lock_name.substr(0, kPrefix.size() + kDigits) : std::string();
}

/// Removes segment and lock file unless somebody holds the lock.
std::uintmax_t remove_unless_held(const fs::path& lock, const fs::path& segment) {
  const int file = ::open(lock.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0) return 0;
  std::uintmax_t bytes = 0;
  if (::flock(file, LOCK_EX | LOCK_NB) == 0) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(segment, error);
    if (!error && fs::remove(segment, error)) bytes = size;
    if (!error) fs::remove(lock, error);
  }
  ::close(file);
  return bytes;
}

}  // namespace

SweptMemory remove_orphaned_segments(const fs::path& folder,
                                     std::chrono::seconds min_age) noexcept {
  SweptMemory swept;
  try {
    const auto now = fs::file_time_type::clock::now();
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string segment = segment_of(entry.path().filename().string());
      std::error_code error;
      if (segment.empty() || now - entry.last_write_time(error) < min_age || error) continue;
      const std::uintmax_t bytes = remove_unless_held(entry.path(), folder / segment);
      swept.segments += bytes > 0 ? 1 : 0;
      swept.bytes += bytes;
    }
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): tidying must not stop a robot
  }
  return swept;
}

}  // namespace strata::bus
