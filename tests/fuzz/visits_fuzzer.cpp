// SPDX-License-Identifier: Apache-2.0
/// Visits that robots of a fleet push: packed, and what is in them.
#include "memory/store/visit_content.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  const auto bytes = std::as_bytes(std::span(data, size));
  (void)fuzz::expect_value_or_error([&] { (void)memory::unpack_visit(bytes, "visit"); });
  return fuzz::expect_value_or_error([&] {
    const auto content = memory::visit_content(memory::scans_of_visit(bytes, 1, "visit"));
    if (memory::visit_content(memory::scans_of_visit(content, 1, "again")) != content) {
      __builtin_trap();
    }
  });
}
