// SPDX-License-Identifier: Apache-2.0
/// Who runs a process that is known by its GUID only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace strata::doctor {

/// The name, or where it has none the number, of the user that runs the processes whose id has
/// these lower 16 bits. Empty where there is no such process, or several of different users.
/// processes: where Linux lists them.
[[nodiscard]] std::string user_of_process(std::uint16_t id_bits,
                                          const std::filesystem::path& processes = "/proc");

}  // namespace strata::doctor
