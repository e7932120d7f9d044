// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/process_group.hpp"

#include <chrono>
#include <cstring>
#include <thread>

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace strata::tools {

ProcessGroup::~ProcessGroup() { stop(); }

void ProcessGroup::start(const std::string& name, const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {"strata"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  const int error = posix_spawn(&pid, "/proc/self/exe", nullptr, nullptr, argv.data(), environ);
  if (error != 0) {
    throw OutputError("process " + name, std::string("cannot be started: ") + std::strerror(error),
                      "check the limits on processes and memory");
  }
  children_.push_back({name, pid});
}

std::vector<ProcessGroup::Ended> ProcessGroup::take_ended() {
  std::vector<Ended> ended;
  std::erase_if(children_, [&](const Child& child) {
    int status = 0;
    if (waitpid(child.pid, &status, WNOHANG) != child.pid) return false;
    ended.push_back({child.name, !WIFEXITED(status) || WEXITSTATUS(status) != 0});
    return true;
  });
  return ended;
}

bool ProcessGroup::all_run() {
  const std::vector<Ended> ended = take_ended();
  for (const Ended& child : ended) {
    if (child.failed) throw Error("process " + child.name, "ended early", "see its message above");
  }
  return ended.empty();
}

void ProcessGroup::stop() noexcept {
  for (const Child& child : children_) kill(child.pid, SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(1500);
  for (const Child& child : children_) {
    int status = 0;
    while (waitpid(child.pid, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > deadline) kill(child.pid, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  children_.clear();
}

}  // namespace strata::tools
