// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/process_group.hpp"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace strata::tools {

namespace {

/// This very program with these arguments; it inherits `descriptor` alone. Returns an errno.
int spawn(pid_t& pid, const std::vector<char*>& argv, int descriptor) {
  posix_spawn_file_actions_t actions;
  int error = posix_spawn_file_actions_init(&actions);
  if (error != 0) return error;
  // Onto itself: that alone makes this child, and no other, inherit it.
  error = posix_spawn_file_actions_adddup2(&actions, descriptor, descriptor);
  if (error == 0) {
    error = posix_spawn(&pid, "/proc/self/exe", &actions, nullptr, argv.data(), environ);
  }
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

}  // namespace

std::string processes(const std::vector<std::string>& names) {
  std::string text = (names.size() == 1 ? "process " : "processes ") + names.front();
  for (std::size_t i = 1; i < names.size(); ++i) text += ", " + names[i];
  return text;
}

ProcessGroup::~ProcessGroup() { (void)end_all(patience_); }

void ProcessGroup::start(const std::string& name, const std::vector<std::string>& arguments) {
  const auto check = [&](int error) {
    if (error == 0) return;
    throw OutputError("process " + name, std::string("cannot be started: ") + std::strerror(error),
                      "check the limits on processes, open files and memory");
  };
  int ends[2] = {-1, -1};
  check(pipe2(ends, O_CLOEXEC | O_NONBLOCK) == 0 ? 0 : errno);
  Child child{name, 0, ends[0]};
  std::vector<std::string> words = {"strata"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  words.insert(words.end(), {"--ready-pipe", std::to_string(ends[1])});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int error = spawn(child.pid, argv, ends[1]);
  close(ends[1]);
  if (error != 0) close_pipe(child);
  check(error);
  children_.push_back(std::move(child));
}

std::vector<ProcessGroup::Ended> ProcessGroup::take_ended() {
  std::vector<Ended> ended;
  std::erase_if(children_, [&](const Child& child) {
    int status = 0;
    if (waitpid(child.pid, &status, WNOHANG) != child.pid) return false;
    close_pipe(child);
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

bool ProcessGroup::all_ready() {
  bool all = true;
  for (Child& child : children_) {
    char told = 0;
    if (child.ready_pipe >= 0 && read(child.ready_pipe, &told, 1) == 1) {
      child.is_ready = true;
      close_pipe(child);
      child.ready_pipe = -1;
    }
    all = all && child.is_ready;
  }
  return all;
}

void ProcessGroup::close_pipe(const Child& child) noexcept {
  if (child.ready_pipe >= 0) close(child.ready_pipe);
}

void ProcessGroup::stop(const Patience& patience) {
  const Losses losses = end_all(patience);
  const char* may_be_lost = "; what was not yet written may be lost";
  if (!losses.killed.empty()) {
    const bool is_hurried = patience.is_hurried && patience.is_hurried();
    std::string what = is_hurried ? "killed in a hurry" : "did not end in time, killed";
    if (!losses.failed.empty()) what += " (and " + processes(losses.failed) + " failed)";
    throw Error(processes(losses.killed), what + may_be_lost,
                is_hurried ? "wait for the end next time"
                           : "look for a slow disk or a component that hangs");
  }
  if (!losses.failed.empty()) {
    throw Error(processes(losses.failed), std::string("did not end well") + may_be_lost,
                "see above what each said");
  }
}

ProcessGroup::Losses ProcessGroup::end_all(const Patience& patience) noexcept {
  Losses losses;
  (void)all_ready();  // what never worked has nothing to lose
  for (const Child& child : children_) kill(child.pid, SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + patience.longest;
  for (const Child& child : children_) {
    int status = 0;
    while (waitpid(child.pid, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > deadline ||
          (patience.is_hurried && patience.is_hurried())) {
        kill(child.pid, SIGKILL);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    close_pipe(child);
    if (!child.is_ready || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) continue;
    const bool is_killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    (is_killed ? losses.killed : losses.failed).push_back(child.name);
  }
  children_.clear();
  return losses;
}

void keep_ready_pipe(int ready_pipe) { fcntl(ready_pipe, F_SETFD, FD_CLOEXEC); }

void tell_ready(int ready_pipe) {
  // Whether anybody still reads makes no difference to this process: its parent's end ends it.
  [[maybe_unused]] const auto written = write(ready_pipe, "1", 1);
  close(ready_pipe);
}

}  // namespace strata::tools
