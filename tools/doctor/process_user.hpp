// SPDX-License-Identifier: Apache-2.0
/// Who runs a process that is known by what its participant announces only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace strata::doctor {

/// Where Linux tells what runs here; another place for tests.
struct SystemFolders {
  std::filesystem::path processes = "/proc";
  std::filesystem::path shared_memory = "/dev/shm";
};

/// The name, or where it has none the number, of the user that runs the one process whose id has
/// these lower 16 bits, if that user also listens at one of these ports (UDP, or Fast DDS' shared
/// memory). Else empty, which is "not known": in a container ids are counted anew, so that a
/// process here with the same id may be anybody's.
[[nodiscard]] std::string user_of_process(std::uint16_t id_bits,
                                          const std::vector<std::uint16_t>& ports,
                                          const SystemFolders& folders = {});

/// Of this very process.
[[nodiscard]] std::string own_user();

}  // namespace strata::doctor
