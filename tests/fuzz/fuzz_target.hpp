// SPDX-License-Identifier: Apache-2.0
/// What the fuzz targets share. A target answers any bytes with a value or with an Error; another
/// exception, a crash or a sanitizer's word is a finding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace strata::fuzz {

using Input = std::span<const std::uint8_t>;

/// A folder that goes with the program, in memory where the system has such a place.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  /// Overwrites a file of that name with the bytes.
  std::filesystem::path write(const std::string& name, Input bytes) const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

[[nodiscard]] inline std::string text_of(Input input) { return {input.begin(), input.end()}; }

/// Two inputs in one: cut at the first "\n=====\n"; without it the second is empty.
[[nodiscard]] std::pair<Input, Input> split(Input input);

/// Runs and swallows an Error, which must say where, what and what to do.
template <typename Run>
int expect_value_or_error(Run&& run) {
  try {
    run();
  } catch (const Error& error) {
    if (error.place().empty() || error.remedy().empty()) __builtin_trap();
  }
  return 0;
}

}  // namespace strata::fuzz
