// SPDX-License-Identifier: Apache-2.0
/// A line of the shell, run to its end.
#pragma once

#include <filesystem>
#include <string>

namespace strata::test {

struct Outcome {
  int code = -1;
  std::string out;
};

/// The command may merge stderr into the output.
[[nodiscard]] Outcome run_command(const std::string& command);

/// For the shell.
[[nodiscard]] std::string quoted(const std::filesystem::path& path);

}  // namespace strata::test
