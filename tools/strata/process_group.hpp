// SPDX-License-Identifier: Apache-2.0
/// The processes of a composition, as children of this one.
#pragma once

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

  /// Throws OutputError. The child dies when this process does, given `run --child`.
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
  /// SIGTERM to all, and SIGKILL to those that are still there after 1.5 s.
  void stop() noexcept;

 private:
  struct Child {
    std::string name;
    pid_t pid = 0;
  };
  std::vector<Child> children_;
};

}  // namespace strata::tools
