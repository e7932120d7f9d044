// SPDX-License-Identifier: Apache-2.0
/// Configuration files, and --set on top of them.
#include "components/settings/config_reader.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/patch/patch_learner.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  return fuzz::expect_value_or_error([&] {
    const auto [document, option] = fuzz::split({data, size});
    YAML::Node node = settings::parse_document(fuzz::text_of(document), "fuzz.yaml");
    if (!option.empty()) settings::apply_override(node, fuzz::text_of(option));
    (void)settings::read_config<patch::PatchLearnerConfig>(node, "fuzz.yaml");
  });
}
