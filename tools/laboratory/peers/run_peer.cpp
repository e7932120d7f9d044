// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>
#include <string>

#include <spawn.h>
#include <sys/wait.h>

#include "core/base/error.hpp"
#include "tools/laboratory/peers/peer_job.hpp"

extern char** environ;

namespace strata::peers {

PeerResult run_peer(const std::filesystem::path& program, const PeerJob& job,
                    const std::filesystem::path& folder) {
  const std::string given = (folder / "job.json").string();
  const std::string answer = (folder / "result.json").string();
  {
    std::ofstream out(given);
    out << to_json(job);
    if (!out.flush()) throw OutputError(given, "cannot be written", "free some space");
  }
  std::string name = program.string();
  std::string first = given;
  std::string second = answer;
  char* arguments[] = {name.data(), first.data(), second.data(), nullptr};
  pid_t pid = 0;
  if (posix_spawn(&pid, name.c_str(), nullptr, nullptr, arguments, environ) != 0) {
    throw Error(name, "cannot be started", "build strata again");
  }
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw Error(name, "failed", "see what it printed above");
  }
  std::ifstream in(answer);
  return result_from_json(nlohmann::json::parse(in, nullptr, false), job.scans.size());
}

}  // namespace strata::peers
