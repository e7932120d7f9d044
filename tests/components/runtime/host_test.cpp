// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/host.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/map_server/register.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"
#include "tests/components/bus/domain.hpp"

namespace strata::runtime {
namespace {

using ::testing::HasSubstr;

/// What making the components of this one process complains about.
std::string complaint_about(const std::string& component) {
  const std::string text = "processes:\n  - name: p\n    components:\n      - " + component + "\n";
  Composition composition = read_composition(settings::parse_yaml(text, "c.yaml"), "c.yaml");
  Registry registry;
  map_server::register_component(registry);
  try {
    const Host host(composition, composition.processes[0], registry, test::make_participant(), {});
  } catch (const Error& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(Host, NamesAnUnknownTypeItsPlaceAndTheLikelyOne) {
  const std::string complaint = complaint_about("{type: strata::MapSever, name: m}");
  EXPECT_THAT(complaint, HasSubstr("c.yaml:4: unknown component type 'strata::MapSever'"));
  EXPECT_THAT(complaint, HasSubstr("did you mean 'strata::MapServer'?"));
}

TEST(Host, NamesTheComponentAndTheLineOfABadParameter) {
  const std::string unknown =
      complaint_about("{type: strata::MapServer, name: m, parameters: {mapp: a.yaml}}");
  EXPECT_THAT(unknown, HasSubstr("c.yaml (parameters of m):4"));
  EXPECT_THAT(unknown, HasSubstr("did you mean 'map'"));
  EXPECT_THAT(complaint_about("{type: strata::MapServer, name: m, parameters: {map: [1]}}"),
              HasSubstr("parameters of m"));
  EXPECT_THAT(
      complaint_about("{type: strata::MapServer, name: m, parameters: {map: /no/map.yaml}}"),
      HasSubstr("/no/map.yaml"));
}

}  // namespace
}  // namespace strata::runtime
