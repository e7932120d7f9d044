// SPDX-License-Identifier: Apache-2.0
/// A parameter file for a composition, as ROS 2 or we write them, and --set on top of it.
#include "components/localizer/amcl_parameters.hpp"
#include "components/runtime/composition.hpp"
#include "components/runtime/composition_settings.hpp"
#include "components/settings/yaml_document.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

/// Names of components in several places, of which parameters are for one, some or all.
constexpr const char* kComposition =
    "version: 1\n"
    "namespace: /robot1\n"
    "processes:\n"
    "  - name: mapping\n"
    "    components:\n"
    "      - {type: strata::BeamFilter, name: filter, parameters: {window: {scans: 5}}}\n"
    "      - {type: strata::Localizer, name: localizer, namespace: /other}\n"
    "  - name: more\n"
    "    components:\n"
    "      - {type: strata::Localizer, name: localizer, parameters: {model: patch}}\n";

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  static const fuzz::ScratchFolder scratch;
  static const runtime::StandIns stand_ins = {localizer::amcl_stand_in()};
  return fuzz::expect_value_or_error([&] {
    const auto [parameters, option] = fuzz::split({data, size});
    YAML::Node document = settings::parse_document(kComposition, "fuzz.yaml");
    (void)runtime::apply_composition_settings(
        document, scratch.write("parameters.yaml", parameters), stand_ins);
    if (!option.empty()) runtime::apply_composition_override(document, fuzz::text_of(option));
    runtime::Composition composition = runtime::read_composition(document, "fuzz.yaml");
    runtime::translate_stand_ins(composition, stand_ins, "parameters.yaml");
  });
}
