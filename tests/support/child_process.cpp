// SPDX-License-Identifier: Apache-2.0
#include "tests/support/child_process.hpp"

#include <csignal>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace strata::test {
namespace {

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> result;
  for (std::string& word : words) result.push_back(word.data());
  result.push_back(nullptr);
  return result;
}

/// Ours, with these in place of those of the same name.
std::vector<std::string> environment_with(std::vector<std::string> own) {
  const std::size_t given = own.size();
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::string name = text.substr(0, text.find('=') + 1);
    bool is_replaced = false;
    for (std::size_t i = 0; i < given; ++i) is_replaced |= own[i].rfind(name, 0) == 0;
    if (!is_replaced) own.push_back(text);
  }
  return own;
}

int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> command, std::vector<std::string> environment,
                           Errors errors) {
  int to_child[2];
  int from_child[2];
  if (pipe2(to_child, O_CLOEXEC) != 0 || pipe2(from_child, O_CLOEXEC) != 0) {
    throw OutputError(command.front(), "no pipe", "close some files");
  }
  environment = environment_with(std::move(environment));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to_child[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, from_child[1], STDOUT_FILENO);
  if (errors == Errors::kMerged) {
    posix_spawn_file_actions_adddup2(&actions, from_child[1], STDERR_FILENO);
  }
  const int result = posix_spawnp(&pid_, command.front().c_str(), &actions, nullptr,
                                  pointers(command).data(), pointers(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  close(to_child[0]);
  close(from_child[1]);
  input_ = to_child[1];
  output_ = from_child[0];
  if (result != 0) {
    close(input_);
    close(output_);
    throw OutputError(command.front(), "cannot be started", "build or install it");
  }
}

ChildProcess::~ChildProcess() {
  close_input();
  kill_hard();
  close(output_);
}

void ChildProcess::tell(const std::string& line) const {
  const std::string text = line + "\n";
  if (write(input_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
    throw OutputError(line, "a child's input takes no more", "look why it ended");
  }
}

void ChildProcess::close_input() {
  if (input_ >= 0) close(input_);
  input_ = -1;
}

void ChildProcess::send(int signal_number) const {
  if (!ended_) kill(pid_, signal_number);
}

void ChildProcess::kill_hard() {
  send(SIGKILL);
  wait();
}

int ChildProcess::wait() {
  if (ended_) return code_;
  int status = 0;
  waitpid(pid_, &status, 0);
  ended_ = true;
  code_ = code_of(status);
  return code_;
}

bool ChildProcess::runs() {
  int status = 0;
  if (ended_ || waitpid(pid_, &status, WNOHANG) == 0) return !ended_;
  ended_ = true;
  code_ = code_of(status);
  return false;
}

std::set<pid_t> ChildProcess::children() const {
  const std::string pid = std::to_string(pid_);
  std::ifstream in("/proc/" + pid + "/task/" + pid + "/children");
  return {std::istream_iterator<pid_t>(in), {}};
}

pid_t ChildProcess::child_with(const std::string& word) const {
  for (const pid_t child : children()) {
    std::ifstream in("/proc/" + std::to_string(child) + "/cmdline");
    for (std::string argument; std::getline(in, argument, '\0');) {
      if (argument == word) return child;
    }
  }
  return 0;
}

bool ChildProcess::read_more(std::chrono::steady_clock::time_point deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
      deadline - std::chrono::steady_clock::now());
  pollfd wait{output_, POLLIN, 0};
  if (left.count() <= 0 || poll(&wait, 1, static_cast<int>(left.count())) <= 0) return false;
  char buffer[4096];
  const ssize_t got = read(output_, buffer, sizeof buffer);
  if (got <= 0) return false;
  unread_.append(buffer, static_cast<std::size_t>(got));
  return true;
}

std::string ChildProcess::wait_for_line(const std::string& start,
                                        std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  do {
    for (std::size_t end = 0; (end = unread_.find('\n')) != std::string::npos;) {
      const std::string line = unread_.substr(0, end);
      unread_.erase(0, end + 1);
      if (line.rfind(start, 0) == 0) return line;
    }
  } while (read_more(deadline));
  return "";
}

std::string ChildProcess::rest() {
  while (read_more(std::chrono::steady_clock::now() + std::chrono::minutes(5))) {
  }
  return std::move(unread_);
}

}  // namespace strata::test
