// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/free_memory.hpp"

#include <fstream>

#include <malloc.h>
#include <unistd.h>

namespace strata::runtime {

std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t total = 0;
  std::size_t resident = 0;
  if (!(statm >> total >> resident)) return 0;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

void return_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

bool FreeMemoryTurn::take(std::chrono::steady_clock::time_point now) {
  if (now < next_) return false;
  if (resident_bytes() < resident_after_ + kGrowth_bytes) return false;
  return_free_memory();
  resident_after_ = resident_bytes();
  next_ = now + kRest;
  return true;
}

}  // namespace strata::runtime
