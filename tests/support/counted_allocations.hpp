// SPDX-License-Identifier: Apache-2.0
/// Counts every call of operator new in a program and the bytes that it holds, and can let a call
/// fail. To be included by one file of a program of its own, since it replaces the operators for
/// all of it.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

#include <malloc.h>

namespace strata::test {

inline std::size_t allocations = 0;  // for programs of one thread
/// The call that fails, as where memory has run out; 0: none.
inline std::size_t failing_allocation = 0;
/// What is held now, and the most that was: of the program's own doing, where the pages of a
/// process follow where its heap has holes.
inline std::size_t held_bytes = 0;
inline std::size_t most_held_bytes = 0;

inline void* allocate(std::size_t bytes) {
  ++allocations;
  if (allocations == failing_allocation) throw std::bad_alloc();
  void* place = std::malloc(bytes == 0 ? 1 : bytes);
  if (place == nullptr) throw std::bad_alloc();
  held_bytes += malloc_usable_size(place);
  if (held_bytes > most_held_bytes) most_held_bytes = held_bytes;
  return place;
}

inline void release(void* place) {
  held_bytes -= malloc_usable_size(place);
  std::free(place);
}

}  // namespace strata::test

// Not inlined: a compiler that sees `malloc` or `free` within one of them but not within the other
// takes them for strangers.
[[gnu::noinline]] void* operator new(std::size_t bytes) { return strata::test::allocate(bytes); }
[[gnu::noinline]] void* operator new[](std::size_t bytes) { return strata::test::allocate(bytes); }
[[gnu::noinline]] void operator delete(void* place) noexcept { strata::test::release(place); }
[[gnu::noinline]] void operator delete[](void* place) noexcept { strata::test::release(place); }
[[gnu::noinline]] void operator delete(void* place, std::size_t /*bytes*/) noexcept {
  strata::test::release(place);
}
[[gnu::noinline]] void operator delete[](void* place, std::size_t /*bytes*/) noexcept {
  strata::test::release(place);
}
