// SPDX-License-Identifier: Apache-2.0
/// A folder for what comes from a server, which goes with it.
#pragma once

#include <filesystem>
#include <system_error>

#include "components/log/disk.hpp"

namespace strata::fleet {

/// Of this process, beside `name`, and not made yet; what killed processes left there goes first.
class Scratch {
 public:
  explicit Scratch(const std::filesystem::path& name) : folder_(log::staged_name(name)) {
    log::remove_left_over(name);
  }
  ~Scratch() {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace strata::fleet
