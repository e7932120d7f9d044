// SPDX-License-Identifier: Apache-2.0
/// The processes of a composition, as children of this one.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace strata::tools {

/// How long a process may take to write what it holds once it is asked to end: a few seconds less
/// than TimeoutStopSec in packaging/strata.service.
constexpr std::chrono::seconds kStopPatience{25};

/// "process NAME", or "processes NAME, NAME". Requires a name.
[[nodiscard]] std::string processes(const std::vector<std::string>& names);

/// Starts this very program again with other arguments; ends what it started.
class ProcessGroup {
 public:
  struct Patience {
    std::chrono::milliseconds longest{};    ///< from being asked to end to being killed
    std::function<bool()> is_hurried = {};  ///< asked meanwhile; true: kill now. Empty: never
  };
  /// A child that has ended.
  struct Ended {
    std::string name;
    bool failed = false;  ///< an exit code other than 0, or a signal
  };

  /// patience: with children that are still there when the group is destroyed.
  explicit ProcessGroup(Patience patience) : patience_(std::move(patience)) {}
  /// As stop(), with the group's own patience.
  ~ProcessGroup();
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;

  /// Throws OutputError. The child ends when this process does, given `run --child`; it is given
  /// `--ready-pipe` besides, to tell by that it works.
  void start(const std::string& name, const std::vector<std::string>& arguments);
  /// Those that have ended by themselves since the last call.
  [[nodiscard]] std::vector<Ended> take_ended();
  /// Throws Error when a child has ended by itself with a failure; says whether all still run.
  [[nodiscard]] bool all_run();
  /// How many run, as far as take_ended() has told.
  [[nodiscard]] std::size_t size() const { return children_.size(); }
  /// Whether each of them has told that it works.
  [[nodiscard]] bool all_ready();
  /// SIGTERM to all, and SIGKILL to those that are still there when patience ends. Throws Error
  /// that names those that were killed or failed meanwhile; all have ended then as well.
  void stop(const Patience& patience);
  void stop() { stop(patience_); }

 private:
  struct Child {
    std::string name;
    pid_t pid = 0;
    int ready_pipe = -1;  ///< -1 once it has told
    bool is_ready = false;
  };
  static void close_pipe(const Child& child) noexcept;
  /// Of those that had told that they work.
  struct Losses {
    std::vector<std::string> failed;  ///< by themselves
    std::vector<std::string> killed;  ///< by us; they could not say anything
  };
  Losses end_all(const Patience& patience) noexcept;

  Patience patience_;
  std::vector<Child> children_;
};

/// A child's end: keeps the descriptor of `--ready-pipe` from processes that it starts itself.
void keep_ready_pipe(int ready_pipe);

/// Tells the group by it that this process works, and closes it.
void tell_ready(int ready_pipe);

}  // namespace strata::tools
