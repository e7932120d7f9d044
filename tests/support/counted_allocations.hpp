// SPDX-License-Identifier: Apache-2.0
/// Counts every call of operator new in a program, and can let one fail. To be included by one file
/// of a program of its own, since it replaces the operators for all of it.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

namespace strata::test {

inline std::size_t allocations = 0;  // for programs of one thread
/// The call that fails, as where memory has run out; 0: none.
inline std::size_t failing_allocation = 0;

inline void* allocate(std::size_t bytes) {
  ++allocations;
  if (allocations == failing_allocation) throw std::bad_alloc();
  if (void* place = std::malloc(bytes == 0 ? 1 : bytes)) return place;
  throw std::bad_alloc();
}

}  // namespace strata::test

// Not inlined: a compiler that sees `malloc` or `free` within one of them but not within the other
// takes them for strangers.
[[gnu::noinline]] void* operator new(std::size_t bytes) { return strata::test::allocate(bytes); }
[[gnu::noinline]] void* operator new[](std::size_t bytes) { return strata::test::allocate(bytes); }
[[gnu::noinline]] void operator delete(void* place) noexcept { std::free(place); }
[[gnu::noinline]] void operator delete[](void* place) noexcept { std::free(place); }
[[gnu::noinline]] void operator delete(void* place, std::size_t /*bytes*/) noexcept {
  std::free(place);
}
[[gnu::noinline]] void operator delete[](void* place, std::size_t /*bytes*/) noexcept {
  std::free(place);
}
