// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/process_user.hpp"

#include <array>
#include <charconv>
#include <set>
#include <system_error>

#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

namespace strata::doctor {
namespace {

std::string name_of(uid_t user) {
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  getpwuid_r(user, &entry, buffer.data(), buffer.size(), &found);
  return found != nullptr ? found->pw_name : std::to_string(user);
}

}  // namespace

std::string user_of_process(std::uint16_t id_bits, const std::filesystem::path& processes) {
  std::set<uid_t> users;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(processes, error)) {
    const std::string name = entry.path().filename().string();
    std::uint32_t id = 0;
    const auto [end, wrong] = std::from_chars(name.data(), name.data() + name.size(), id);
    if (wrong != std::errc() || end != name.data() + name.size()) continue;
    struct stat status {};
    if ((id & 0xFFFFU) != id_bits || stat(entry.path().c_str(), &status) != 0) continue;
    users.insert(status.st_uid);
  }
  return users.size() == 1 ? name_of(*users.begin()) : std::string();
}

}  // namespace strata::doctor
