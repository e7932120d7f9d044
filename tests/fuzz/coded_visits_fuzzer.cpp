// SPDX-License-Identifier: Apache-2.0
/// Visits that robots of a fleet tell relative to a map.
#include "memory/store/coded_visit.hpp"
#include "memory/store/visit_content.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

strata::ReflectionGrid room() {
  strata::ReflectionGrid map = strata::make_reflection_grid(0.05, {{-40, -40}, {40, 40}});
  for (std::size_t i = 0; i < map.size(); ++i) {
    const strata::Cell cell = map.cell(i);
    map.values()[i] = cell.x == -40 || cell.y == 39 || cell.x == 17 ? 0.9F : 0.0F;
  }
  return map;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  static const ReflectionGrid kMap = room();
  return fuzz::expect_value_or_error([&] {
    const auto bytes = std::as_bytes(std::span(data, size));
    const auto scans = memory::scans_of_coded_visit(bytes, kMap, 1, "visit");
    const auto again =
        memory::code_visit(scans, kMap, memory::map_of_coded_visit(bytes, "visit"), 0.05);
    if (!again) return;  // none, or a pose at the very edge
    if (memory::visit_content(memory::scans_of_coded_visit(again->bytes, kMap, 1, "again")) !=
        memory::visit_content(again->scans)) {
      __builtin_trap();
    }
  });
}
