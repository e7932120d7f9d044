// SPDX-License-Identifier: Apache-2.0
/// How much memory a piece of work holds at most.
#pragma once

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <optional>
#include <string>

#include <malloc.h>

namespace strata::test {

/// A line of /proc/self/status in bytes; 0 where it is missing.
inline std::size_t status_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != key + ":") continue;
    std::size_t kilobytes = 0;
    status >> kilobytes;
    return kilobytes * 1024;
  }
  return 0;
}

/// By how much the process' resident memory grows above what it is before [bytes]; nothing where
/// the system does not let the peak be forgotten, or where a sanitizer holds what is freed.
template <typename Work>
std::optional<std::size_t> peak_growth_bytes(Work&& work) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  work();
  return std::nullopt;
#else
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;
  const std::size_t before = status_bytes("VmRSS");
  const bool is_forgotten = status_bytes("VmHWM") < before + (1U << 20U);
  work();
  const std::size_t peak = status_bytes("VmHWM");
  if (!is_forgotten || before == 0) return std::nullopt;
  return peak - std::min(peak, before);
#endif
}

}  // namespace strata::test
