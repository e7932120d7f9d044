// SPDX-License-Identifier: Apache-2.0
/// The built program, run from a test.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <sys/wait.h>

namespace strata::test {

struct Outcome {
  int code = -1;
  std::string out;
};

/// Runs `PREFIX strata ARGUMENTS`; the shell may merge stderr into the output.
inline Outcome run_strata_under(const std::string& prefix, const std::string& arguments) {
  const std::string command = prefix + " '" STRATA_PROGRAM "' " + arguments;
  Outcome outcome;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return outcome;
  char buffer[4096];
  for (std::size_t got = 0; (got = fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
    outcome.out.append(buffer, got);
  }
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

inline Outcome run_strata(const std::string& arguments) { return run_strata_under("", arguments); }

/// What a file holds.
inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

inline std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

}  // namespace strata::test
