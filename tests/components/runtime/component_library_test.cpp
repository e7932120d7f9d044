// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/component_library.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/map_server/register.hpp"
#include "components/runtime/host.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/test_data.hpp"

namespace strata::runtime {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Where the libraries of this folder were built.
const std::filesystem::path kFolder = STRATA_TEST_LIBRARIES;

Composition naming(const std::string& library, const std::string& place = "c.yaml",
                   const std::string& component = "{type: counting::Counter, name: counter}") {
  const std::string text = "libraries:\n  - " + library + "\nprocesses:\n  - name: p\n" +
                           "    components: [" + component + "]\n";
  return read_composition(settings::parse_yaml(text, place), place);
}

std::string complaint_about_library(const std::string& library) {
  Registry registry;
  map_server::register_component(registry);
  try {
    load_component_libraries(naming(library), registry);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no complaint";
}

std::string built(const std::string& name) { return (kFolder / ("lib" + name + ".so")).string(); }

/// STRATA_LIBRARY_PATH while it lives.
class LibraryPath {
 public:
  explicit LibraryPath(const std::string& path) { setenv(kLibraryPathVariable, path.c_str(), 1); }
  ~LibraryPath() { unsetenv(kLibraryPathVariable); }
  LibraryPath(const LibraryPath&) = delete;
  LibraryPath& operator=(const LibraryPath&) = delete;
};

TEST(ComponentLibrary, BringsComponentsThatRunAsOurOwn) {
  Registry registry;
  const Composition composition = naming(built("counting"));
  load_component_libraries(composition, registry);
  const Host host(composition, composition.processes[0], registry, test::make_participant(), {});
  ASSERT_EQ(host.components().size(), 1U);
  EXPECT_EQ(host.components()[0]->state(), LifecycleState::kInactive);
  ASSERT_EQ(host.components()[0]->topics().size(), 1U);
  EXPECT_EQ(host.components()[0]->topics()[0].topic, "/scan");
}

TEST(ComponentLibrary, ItsParametersAreCheckedAsOurs) {
  Registry registry;
  const Composition composition =
      naming(built("counting"), "c.yaml",
             "{type: counting::Counter, name: counter, parameters: {step: 11}}");
  load_component_libraries(composition, registry);
  try {
    const Host host(composition, composition.processes[0], registry, test::make_participant(), {});
    FAIL() << "11 is out of range";
  } catch (const ConfigError& error) {  // thrown in the library, caught here
    EXPECT_THAT(error.what(), AllOf(HasSubstr("parameters of counter"), HasSubstr("step")));
  }
}

TEST(ComponentLibrary, IsFoundByNameInTheFoldersOfTheVariable) {
  const LibraryPath path("/no/such/folder::" + kFolder.string());
  for (const char* name : {"counting", "libcounting.so"}) {
    Registry registry;
    const auto files = load_component_libraries(naming(name), registry);
    ASSERT_EQ(files.size(), 1U);
    EXPECT_EQ(files[0], kFolder / "libcounting.so");
    EXPECT_EQ(registry.factories().count("counting::Counter"), 1U);
  }
}

TEST(ComponentLibrary, IsFoundBesideTheCompositionBeforeAnywhereElse) {
  const test::TemporaryDirectory folder;
  std::filesystem::create_directory(folder.path() / "lib");
  for (const char* below : {"libcounting.so", "lib/libcounting.so"}) {
    std::filesystem::copy_file(built("counting"), folder.path() / below);
  }
  const LibraryPath path(kFolder.string());
  const std::string place = (folder.path() / "c.yaml").string();
  Registry beside;
  EXPECT_EQ(load_component_libraries(naming("counting", place), beside).at(0),
            folder.path() / "libcounting.so");
  Registry below;
  EXPECT_EQ(load_component_libraries(naming("lib/libcounting.so", place), below).at(0),
            folder.path() / "lib/libcounting.so");
}

TEST(ComponentLibrary, NamesTheLineAndTheReasonWhenItDoesNotLoad) {
  EXPECT_THAT(complaint_about_library("no_such_library"),
              AllOf(HasSubstr("c.yaml:2"), HasSubstr("libno_such_library.so"),
                    HasSubstr("STRATA_LIBRARY_PATH")));
  const test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "libbroken.so") << "not a library";
  EXPECT_THAT(complaint_about_library((folder.path() / "libbroken.so").string()),
              AllOf(HasSubstr("does not load"), HasSubstr("c.yaml:2")));
}

TEST(ComponentLibrary, IsRefusedWhenItHasNoComponentsOrOthersNames) {
  EXPECT_THAT(complaint_about_library(built("foreign")),
              AllOf(HasSubstr("has no components"), HasSubstr("STRATA_COMPONENT_LIBRARY")));
  EXPECT_THAT(complaint_about_library(built("doubled")),
              HasSubstr("a second component type 'strata::MapServer'"));
  EXPECT_THAT(complaint_about_library(built("throwing")),
              HasSubstr("does not register: no licence file"));
}

TEST(ComponentLibrary, OfAnotherVersionIsRefusedBeforeAnythingInItRuns) {
  EXPECT_THAT(complaint_about_library(built("stale")),
              AllOf(HasSubstr("was built for strata 0.0.1"), HasSubstr(library_interface())));
}

TEST(ComponentLibrary, ItsEntryInTheCompositionMustBeAName) {
  EXPECT_THROW((void)naming("''"), ConfigError);
  EXPECT_THROW((void)naming("[a, b]"), ConfigError);
}

}  // namespace
}  // namespace strata::runtime
