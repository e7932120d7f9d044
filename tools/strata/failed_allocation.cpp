// SPDX-License-Identifier: Apache-2.0
/// `new` as the library has it, and a note of what it could not give. Of the program only: whoever
/// links our libraries keeps their own.
#include <cstdlib>
#include <new>

#include "tools/strata/shortage.hpp"

// A sanitizer has its own.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

void* operator new(std::size_t bytes) {
  void* memory = std::malloc(bytes > 0 ? bytes : 1);
  if (memory != nullptr) return memory;
  strata::tools::note_failed_allocation(bytes);
  throw std::bad_alloc();
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*bytes*/) noexcept { std::free(memory); }

#endif
