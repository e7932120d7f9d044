// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/decoded_png.hpp"
#include "tools/report/image.hpp"

namespace strata::report {
namespace {

std::string picture_of(const std::string& content) {
  return R"(<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20">)" + content + "</svg>";
}

std::string what_is_wrong(const std::string& svg) {
  try {
    (void)render_svg_to_png(svg, 1.0);
  } catch (const OutputError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(SvgRendering, ScalesAndPutsWhiteBehind) {
  const Image image = test::decode(render_svg_to_png(
      picture_of(R"(<rect x="10" y="5" width="10" height="5" fill="#0072b2"/>)"), 1.5));
  ASSERT_EQ(image.width(), 60);
  ASSERT_EQ(image.height(), 30);
  const Color blue{0x00, 0x72, 0xb2};
  EXPECT_EQ(image.at(16, 8), blue);
  EXPECT_EQ(image.at(28, 13), blue);
  EXPECT_EQ(image.at(13, 8), (Color{255, 255, 255}));
  EXPECT_EQ(image.at(32, 13), (Color{255, 255, 255}));
}

TEST(SvgRendering, DrawsLetters) {
  const Image image = test::decode(render_svg_to_png(
      picture_of(R"(<text x="2" y="15" font-size="14" font-family="sans-serif">Wm</text>)"), 1.0));
  int dark = 0;
  for (const Color& pixel : image.pixels()) dark += pixel.r < 64 ? 1 : 0;
  EXPECT_GT(dark, 20);
}

TEST(SvgRendering, SaysWhatIsWrongWithTheDocument) {
  EXPECT_THAT(what_is_wrong("<svg"),
              testing::HasSubstr("rsvg-convert ended with 1 and says: Error reading SVG"));
  EXPECT_THAT(what_is_wrong(""),
              testing::HasSubstr("rsvg-convert ended with 1 and says: Error reading SVG"));
}

TEST(SvgRendering, SaysWhatToInstallWhereTheProgramIsMissing) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const std::string said = what_is_wrong(picture_of(""));
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(said, testing::HasSubstr("install librsvg2-bin"));
}

// A document of more bytes than a pipe holds, both ways.
TEST(SvgRendering, DrawsLargeDocuments) {
  std::string content;
  while (content.size() < 12'000'000) {
    content += R"(<rect x="10" y="5" width="10" height="5" fill="#0072b2" stroke="none"/>)";
  }
  EXPECT_EQ(test::decode(render_svg_to_png(picture_of(content), 1.0)).width(), 40);
}

}  // namespace
}  // namespace strata::report
