// SPDX-License-Identifier: Apache-2.0
/// Random damage to documents and options: every outcome is a struct or a strata error.
#include <gtest/gtest.h>

#include "components/settings/settings.hpp"
#include "core/base/error.hpp"
#include "core/random/stream.hpp"
#include "tests/components/settings/sample_config.hpp"

namespace strata::settings {
namespace {

using test::CartConfig;

std::string damaged(std::string text, RandomStream& random) {
  static const std::string kAlphabet = "abm_:.,[]{}&*!|>'\"%@`#-+0123456789\n\t ~?\\=\x80\x01";
  for (std::uint32_t edits = 1 + random.below(6); edits > 0 && !text.empty(); --edits) {
    const std::size_t at = random.below(static_cast<std::uint32_t>(text.size()));
    const char c = kAlphabet[random.below(static_cast<std::uint32_t>(kAlphabet.size()))];
    switch (random.below(4)) {
      case 0:
        text[at] = c;
        break;
      case 1:
        text.insert(at, 1, c);
        break;
      case 2:
        text.erase(at, 1 + random.below(5));
        break;
      default:
        text += text.substr(at, 12);
    }
  }
  return text;
}

TEST(SettingsFuzz, DamagedDocumentsGiveAStructOrAStrataError) {
  CartConfig sample;
  sample.wheels.resize(2);
  const std::string text = write_yaml(sample, {.with_comments = true});
  RandomStream random(11, StreamId::kTest);
  int read = 0;
  int refused = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::string input = damaged(text, random);
    try {
      const auto cart = read_config<CartConfig>(parse_document(input, "f"), "f");
      EXPECT_TRUE(validate(cart).empty());
      ++read;
    } catch (const Error& error) {
      EXPECT_FALSE(error.place().empty());
      EXPECT_FALSE(error.remedy().empty());
      ++refused;
    } catch (const std::exception& error) {
      FAIL() << error.what() << "\n" << input;
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 100);
}

TEST(SettingsFuzz, DamagedOptionsGiveADocumentOrAStrataError) {
  RandomStream random(12, StreamId::kTest);
  for (int i = 0; i < 4000; ++i) {
    const std::string option = damaged("wheels[0].spare.radius_m=[0.1, {a: b}]", random);
    YAML::Node node = YAML::Load("wheels: [{spare: {radius_m: 1}}]");
    try {
      apply_override(node, option);
      EXPECT_TRUE(node.IsMap());
    } catch (const Error& error) {
      EXPECT_FALSE(error.remedy().empty());
    } catch (const std::exception& error) {
      FAIL() << error.what() << "\n" << option;
    }
  }
}

}  // namespace
}  // namespace strata::settings
