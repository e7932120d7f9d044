// SPDX-License-Identifier: Apache-2.0
/// What the program does where the system gives it little: memory, address space or threads.
#pragma once

#include <cstddef>
#include <exception>
#include <string>
#include <string_view>

namespace strata::tools {

/// What the program was at when something ran out.
struct Work {
  std::string verb;
  std::string stage;  ///< as Progress calls it; empty: before the first
};

/// What was lacking, what for, and what to do about it, on one line: of std::bad_alloc, and of the
/// std::system_error of a thread that could not be made. Empty for all else.
[[nodiscard]] std::string describe_shortage(const std::exception& error, const Work& work = {});

/// An error that the component `name` of that type told, with what the system says of a shortage
/// put into words: what was asked for, and which settings take less. Any other as it is.
[[nodiscard]] std::string shortage_in_words(std::string told, std::string_view type,
                                            std::string_view name);

/// That so much was asked for and is not there; what is in use then is noted with it. Needs no
/// memory. Thread safe.
void note_failed_allocation(std::size_t bytes) noexcept;

/// Before other threads are made. Where address space is limited (`ulimit -v`), threads share what
/// they allocate from: with 64 MB reserved for each, as glibc has it, a limit of 500 MB is used up
/// by a process that holds 40. And where memory runs out where nothing can catch it (a thread of
/// the middleware, a destructor), the process says so on a line before it ends.
void prepare_for_shortage();

}  // namespace strata::tools
