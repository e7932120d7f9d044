// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/process_user.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <set>
#include <sstream>
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

/// Those with a process whose id has these lower 16 bits.
std::set<uid_t> users_of_id(std::uint16_t id_bits, const std::filesystem::path& processes) {
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
  return users;
}

/// Adds the users of the sockets that proc(5) lists in net/udp and net/udp6.
void add_users_of_sockets(const std::filesystem::path& list,
                          const std::vector<std::uint16_t>& ports, std::set<uid_t>& users) {
  std::ifstream in(list);
  std::string line;
  std::getline(in, line);  // its heading
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string number, address, other, state, queues, timer, retries;
    uid_t user = 0;
    if (!(words >> number >> address >> other >> state >> queues >> timer >> retries >> user)) {
      continue;
    }
    const std::size_t colon = address.find(':');
    unsigned port = 0;
    if (colon == std::string::npos ||
        std::from_chars(address.data() + colon + 1, address.data() + address.size(), port, 16).ec !=
            std::errc()) {
      continue;
    }
    if (std::find(ports.begin(), ports.end(), port) != ports.end()) users.insert(user);
  }
}

std::set<uid_t> users_of_ports(const std::vector<std::uint16_t>& ports,
                               const SystemFolders& folders) {
  std::set<uid_t> users;
  for (const char* list : {"net/udp", "net/udp6"}) {
    add_users_of_sockets(folders.processes / list, ports, users);
  }
  for (const std::uint16_t port : ports) {
    const auto file = folders.shared_memory / ("fastrtps_port" + std::to_string(port));
    struct stat status {};
    if (stat(file.c_str(), &status) == 0) users.insert(status.st_uid);
  }
  return users;
}

}  // namespace

std::string user_of_process(std::uint16_t id_bits, const std::vector<std::uint16_t>& ports,
                            const SystemFolders& folders) {
  const std::set<uid_t> users = users_of_id(id_bits, folders.processes);
  if (users.size() != 1 || users_of_ports(ports, folders).count(*users.begin()) == 0) return {};
  return name_of(*users.begin());
}

std::string own_user() { return name_of(getuid()); }

}  // namespace strata::doctor
