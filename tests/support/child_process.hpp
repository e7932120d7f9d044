// SPDX-License-Identifier: Apache-2.0
/// Another program, run from a test.
#pragma once

#include <chrono>
#include <set>
#include <string>
#include <vector>

#include <sys/types.h>

namespace strata::test {

class ChildProcess {
 public:
  enum class Errors { kPassedOn, kMerged };  ///< kMerged: its lines on stderr are read as well

  /// command: the program, by its path or found in PATH, and its arguments. environment:
  /// "NAME=value" besides ours. Throws OutputError when it cannot be started.
  explicit ChildProcess(std::vector<std::string> command, std::vector<std::string> environment = {},
                        Errors errors = Errors::kPassedOn);
  /// Kills it, unless it has ended.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Reads its lines until one begins with `start`; that line, or "" when its output ends first or
  /// patience does.
  [[nodiscard]] std::string wait_for_line(
      const std::string& start, std::chrono::milliseconds patience = std::chrono::seconds(20));
  /// Everything it still says until it closes its output.
  [[nodiscard]] std::string rest();
  /// Writes a line to its input, which it has to have open. Throws OutputError.
  void tell(const std::string& line) const;
  void close_input();
  void send(int signal_number) const;
  void kill_hard();
  /// Waits for its end: its exit code, or 128 and the signal that ended it.
  int wait();
  [[nodiscard]] bool runs();
  [[nodiscard]] pid_t pid() const { return pid_; }
  /// The processes that it started.
  [[nodiscard]] std::set<pid_t> children() const;
  /// The one of them with this word on its command line; 0 when there is none.
  [[nodiscard]] pid_t child_with(const std::string& word) const;

 private:
  /// False when nothing more comes until `deadline`.
  bool read_more(std::chrono::steady_clock::time_point deadline);

  pid_t pid_ = -1;
  int code_ = -1;  // once it has ended
  bool ended_ = false;
  int input_ = -1;
  int output_ = -1;
  std::string unread_;
};

}  // namespace strata::test
