// SPDX-License-Identifier: Apache-2.0
/// The program cyclone_peer, run from a test on 127.0.0.1 and the test's domain.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include <sys/types.h>

namespace strata::test {

class CycloneProcess {
 public:
  /// arguments: what comes after the domain. Throws OutputError when it cannot be started.
  explicit CycloneProcess(const std::vector<std::string>& arguments);
  /// Closes its input, which ends it, and waits for that.
  ~CycloneProcess();
  CycloneProcess(const CycloneProcess&) = delete;
  CycloneProcess& operator=(const CycloneProcess&) = delete;

  /// Reads its lines until one begins with `start`; that line, or "" when its output ends first or
  /// 20 s pass.
  [[nodiscard]] std::string wait_for_line(const std::string& start);

 private:
  pid_t pid_ = -1;
  int input_ = -1;
  int output_ = -1;
  std::string rest_;
};

}  // namespace strata::test
