// SPDX-License-Identifier: Apache-2.0
/// The program cyclone_peer, run from a test on 127.0.0.1 and the test's domain.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"

namespace strata::test {

class CycloneProcess : public ChildProcess {
 public:
  /// arguments: what comes after the domain. enclave: folder of its certificate and permissions;
  /// empty: without security. Throws OutputError when it cannot be started.
  explicit CycloneProcess(const std::vector<std::string>& arguments,
                          const std::filesystem::path& enclave = {});
  /// Closes its input, which ends it, and waits for that.
  ~CycloneProcess();
};

}  // namespace strata::test
