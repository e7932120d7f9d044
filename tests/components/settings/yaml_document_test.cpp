// SPDX-License-Identifier: Apache-2.0
#include "components/settings/yaml_document.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::settings {
namespace {

using testing::HasSubstr;

std::string document_error(const std::string& text) {
  try {
    (void)parse_document(text, "f.yaml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

std::string override_error(const std::string& text, const std::string& option) {
  YAML::Node node = YAML::Load(text);
  try {
    apply_override(node, option);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Document, NeedsItsVersion) {
  EXPECT_THAT(document_error("a: 1"), HasSubstr("f.yaml:1: has no version; write 'version: 1'"));
  EXPECT_THAT(document_error("a: 1\nversion: 2"),
              HasSubstr("f.yaml:2: has an unknown version '2'"));
  const YAML::Node node = parse_document("version: 1\na: 3", "f.yaml");
  EXPECT_EQ(node.size(), 1U);
  EXPECT_EQ(node["a"].Scalar(), "3");
}

TEST(Document, NamesTheLineOfASyntaxError) {
  EXPECT_THAT(document_error("version: 1\na: [1\nb: 2\n"), HasSubstr("f.yaml:"));
  EXPECT_THAT(document_error("version: 1\na: [1\nb: 2\n"), HasSubstr("is not YAML"));
  EXPECT_THAT(document_error("- 1\n- 2"), HasSubstr("is not a map of keys"));
  EXPECT_THAT(document_error("version: 1\n---\nversion: 1"), HasSubstr("several YAML documents"));
  // At these yaml-cpp ends documents for ever.
  for (const char* text : {",", "version: 1\na: b\n}", "version: 1\n---\n,", "]"}) {
    EXPECT_NE(document_error(text), "no error") << text;
  }
  EXPECT_EQ(document_error("---\nversion: 1\n...\n"), "no error");
}

TEST(Document, LoadsAFileAndSaysWhenThereIsNone) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "a.yaml";
  std::ofstream(file) << "version: 1\nb: 2\n";
  EXPECT_EQ(load_document(file)["b"].Scalar(), "2");
  EXPECT_THROW((void)load_document(folder.path() / "none.yaml"), InputError);
  EXPECT_THROW((void)load_document(folder.path()), InputError);
}

TEST(Override, SetsNestedKeysAndMakesGroupsOnTheWay) {
  YAML::Node node = YAML::Load("a: {b: 1}\nlist: [{k: 1}, {k: 2}]");
  apply_overrides(node, {"a.b=2", "a.c=[1, 2]", "x.y.z=true", "list[1].k=7", "a.b=3", "t="});
  EXPECT_EQ(node["a"]["b"].Scalar(), "3");
  EXPECT_EQ(node["a"]["c"].size(), 2U);
  EXPECT_EQ(node["x"]["y"]["z"].Scalar(), "true");
  EXPECT_EQ(node["list"][1]["k"].Scalar(), "7");
  EXPECT_EQ(node["list"][0]["k"].Scalar(), "1");
  EXPECT_TRUE(node["t"].IsScalar());
}

TEST(Override, ValueMayContainAnEqualsSign) {
  YAML::Node node;
  apply_override(node, "a=b=c");
  EXPECT_EQ(node["a"].Scalar(), "b=c");
}

TEST(Override, RefusesWhatItCannotPlace) {
  EXPECT_THAT(override_error("a: 1", "a"), HasSubstr("--set a: has no '='"));
  EXPECT_THAT(override_error("a: 1", "=3"), HasSubstr("has an empty key"));
  EXPECT_THAT(override_error("a: 1", "a..b=3"), HasSubstr("has an empty key"));
  EXPECT_THAT(override_error("a: 1", "a.b=3"), HasSubstr("not a group of keys at 'b'"));
  EXPECT_THAT(override_error("a: [1]", "a[4]=3"), HasSubstr("item 4 of a list of 1"));
  EXPECT_THAT(override_error("a: [1]", "a[x]=3"), HasSubstr("not a number in brackets"));
  EXPECT_THAT(override_error("a: [1]", "a[]=3"), HasSubstr("not a number in brackets"));
  EXPECT_THAT(override_error("b: 1", "a[0].k=3"), HasSubstr("does not have"));
  EXPECT_THAT(override_error("b: 1", "a=[1"), HasSubstr("not YAML"));
  EXPECT_THAT(override_error("b: 1", "a=&x [*x]"), HasSubstr("--set"));
}

TEST(YamlDocument, ATagInAFileDoesNotChangeWhereThingsAre) {
  const YAML::Node node = parse_yaml("a: 1\nb: !strata-place:elsewhere 2\n", "f.yaml");
  EXPECT_EQ(place_of(node["b"], "f.yaml", "b"), "f.yaml:2");
  EXPECT_EQ(place_of(copy_with_places(node, "f.yaml")["b"], "other.yaml", "b"), "f.yaml:2");
}

}  // namespace
}  // namespace strata::settings
