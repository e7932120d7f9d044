// SPDX-License-Identifier: Apache-2.0
#include "components/bus/shared_ports.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace strata::bus {
namespace {

namespace fs = std::filesystem;

constexpr int kDomainGain = 250;

/// Of "fastrtps_port7362", "fastrtps_port7362_el", "sem.fastrtps_port7362_mutex"; nothing else.
std::optional<int> port_of(std::string_view name) {
  constexpr std::string_view kSemaphore = "sem.";
  constexpr std::string_view kPort = "fastrtps_port";
  if (name.starts_with(kSemaphore)) name.remove_prefix(kSemaphore.size());
  if (!name.starts_with(kPort)) return std::nullopt;
  name.remove_prefix(kPort.size());
  int port = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), port);
  const bool ends_well = end == name.data() + name.size() || *end == '_';
  return error == std::errc() && ends_well ? std::optional(port) : std::nullopt;
}

/// False where it has just gone: processes of ours make and remove files as they start.
bool is_of_another(const fs::path& file) {
  struct stat status {};
  return ::lstat(file.c_str(), &status) == 0 && status.st_uid != ::geteuid();
}

[[noreturn]] void refuse(const fs::path& file, int domain) {
  throw OutputError(file.string(),
                    "belongs to another user: shared memory on domain " + std::to_string(domain) +
                        " is not safe to use",
                    "run all processes of transport shared_memory as one user, remove what is left "
                    "of another's, or use transport: default");
}

std::vector<fs::path> port_files(int domain, const fs::path& folder) {
  const int first = kSharedPorts.base + kDomainGain * domain + kSharedPorts.discovery;
  const int last = kSharedPorts.base + kDomainGain * domain + kSharedPorts.all_user;
  std::vector<fs::path> files;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const auto port = port_of(entry->path().filename().string());
    if (port && *port >= first && *port <= last) files.push_back(entry->path());
  }
  return files;
}

}  // namespace

SharedPortClaim::SharedPortClaim(int domain, const fs::path& folder) {
  const fs::path file = folder / ("strata_shared_ports_" + std::to_string(domain));
  lock_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock_ < 0 && (errno == EACCES || errno == ELOOP)) refuse(file, domain);
  if (lock_ < 0) {
    throw OutputError(file.string(), std::strerror(errno),
                      "make shared memory writable, or use transport: default");
  }
  try {
    if (is_of_another(file)) refuse(file, domain);
    const bool is_first = ::flock(lock_, LOCK_EX | LOCK_NB) == 0;
    for (const fs::path& port : port_files(domain, folder)) {
      if (is_of_another(port)) refuse(port, domain);
      std::error_code error;
      if (is_first) fs::remove(port, error);
    }
    // Who takes it between the two finds no file of ours yet.
    while (::flock(lock_, LOCK_SH) != 0 && errno == EINTR) {
    }
  } catch (...) {
    ::close(lock_);
    throw;
  }
}

SharedPortClaim::~SharedPortClaim() { ::close(lock_); }

}  // namespace strata::bus
