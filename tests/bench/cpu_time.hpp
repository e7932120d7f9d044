// SPDX-License-Identifier: Apache-2.0
/// What other processes have cost so far.
#pragma once

#include <fstream>
#include <string>

#include <unistd.h>

#include "tests/support/child_process.hpp"

namespace strata::bench {

/// CPU time of a process so far.
inline double cpu_s(pid_t pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/stat");
  std::string field;
  std::getline(in, field, ')');  // the name may hold blanks
  double ticks = 0.0;
  for (int i = 3; in >> field && i <= 15; ++i) {
    if (i >= 14) ticks += std::stod(field);  // utime, stime [proc(5)]
  }
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// ... of a program with the processes that it started.
inline double cpu_s(const test::ChildProcess& child) {
  double sum = cpu_s(child.pid());
  for (const pid_t pid : child.children()) sum += cpu_s(pid);
  return sum;
}

}  // namespace strata::bench
