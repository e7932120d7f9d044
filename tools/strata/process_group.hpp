// SPDX-License-Identifier: Apache-2.0
/// The processes of a composition, as children of this one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <sys/types.h>

namespace strata::tools {

/// Starts this very program again with other arguments; ends what it started.
class ProcessGroup {
 public:
  ProcessGroup() = default;
  /// As stop().
  ~ProcessGroup();
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;

  /// Throws OutputError. The child dies when this process does, given `run --child`; it is given
  /// `--ready-pipe` besides, to tell by that it works.
  void start(const std::string& name, const std::vector<std::string>& arguments);
  /// A child that has ended by itself.
  struct Ended {
    std::string name;
    bool failed = false;  ///< an exit code other than 0, or a signal
  };
  /// Those since the last call.
  [[nodiscard]] std::vector<Ended> take_ended();
  /// Throws Error when a child has ended by itself with a failure; says whether all still run.
  [[nodiscard]] bool all_run();
  /// How many run, as far as take_ended() has told.
  [[nodiscard]] std::size_t size() const { return children_.size(); }
  /// Whether each of them has told that it works.
  [[nodiscard]] bool all_ready();
  /// SIGTERM to all, and SIGKILL to those that are still there after 1.5 s.
  void stop() noexcept;

 private:
  struct Child {
    std::string name;
    pid_t pid = 0;
    int ready_pipe = -1;  ///< -1 once it has told
    bool is_ready = false;
  };
  static void close_pipe(const Child& child) noexcept;

  std::vector<Child> children_;
};

/// A child's end: tells the group, by the descriptor of `--ready-pipe`, that this process works,
/// and closes it.
void tell_ready(int ready_pipe);

}  // namespace strata::tools
