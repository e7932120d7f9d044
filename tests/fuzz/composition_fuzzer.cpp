// SPDX-License-Identifier: Apache-2.0
/// Composition files.
#include "components/runtime/composition.hpp"
#include "components/settings/yaml_document.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  return fuzz::expect_value_or_error([&] {
    const YAML::Node node = settings::parse_document(fuzz::text_of({data, size}), "fuzz.yaml");
    (void)runtime::read_composition(node, "fuzz.yaml");
  });
}
