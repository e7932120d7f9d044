// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/grid/counting_map.hpp"
#include "tests/support/decoded_png.hpp"
#include "tests/support/test_data.hpp"
#include "tools/report/html_report.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::report {
namespace {

using test::decode;

TEST(Png, CarriesEveryPixel) {
  Image image(7, 3, {1, 2, 3});
  image.set(6, 2, {250, 0, 9});
  image.set(-1, 0, {9, 9, 9});  // outside: ignored
  const Image read = decode(encode_png(image));
  ASSERT_EQ(read.width(), 7);
  ASSERT_EQ(read.height(), 3);
  EXPECT_EQ(read.at(6, 2), (Color{250, 0, 9}));
  EXPECT_EQ(read.at(0, 0), (Color{1, 2, 3}));
}

TEST(MapPicture, PutsNorthUpAndPointsOnTheirCells) {
  ReflectionGrid map = make_reflection_grid(0.5, {{-2, -2}, {4, 2}});
  map.at({3, 1}) = 1.0F;  // north-east corner
  map.at({0, 0}) = 0.0F;
  const MapPicture picture = draw_map(map, map.rect(), 60);
  EXPECT_EQ(picture.pixels_per_cell, 10);
  const Eigen::Vector2i corner = picture.pixel(map.center({3, 1}));
  EXPECT_EQ(picture.image.at(corner.x(), corner.y()), (Color{0, 0, 0}));
  EXPECT_LT(corner.y(), 10);
  EXPECT_GE(corner.x(), 50);
  const Eigen::Vector2i middle = picture.pixel(map.center({0, 0}));
  EXPECT_EQ(picture.image.at(middle.x(), middle.y()), (Color{255, 255, 255}));
}

TEST(MapPicture, MarksOnlyBeamsJudgedDynamic) {
  const ReflectionGrid map = make_reflection_grid(1.0, {{0, -2}, {10, 2}});
  PosedScan scan;
  scan.scan.angle_increment_rad = 0.1F;
  scan.scan.range_max_m = 20.0F;
  scan.scan.ranges_m = {5.5F, 5.5F};
  scan.static_probability = {0.9F, 0.1F};
  MapPicture picture = draw_map(map, map.rect(), 1000);
  const Color red{255, 0, 0};
  mark_dynamic_beams(picture, std::vector{scan}, red);
  const Eigen::Vector2i kept = picture.pixel({5.5, 0.0});
  const Eigen::Vector2i marked = picture.pixel({5.5 * std::cos(0.1), 5.5 * std::sin(0.1)});
  EXPECT_FALSE(picture.image.at(kept.x(), kept.y()) == red);
  EXPECT_TRUE(picture.image.at(marked.x(), marked.y()) == red);
}

TEST(Ticks, AreRoundAndInside) {
  const std::vector<double> marks = ticks(-0.3, 9.7, 5);
  EXPECT_EQ(marks, (std::vector<double>{0.0, 2.0, 4.0, 6.0, 8.0}));
}

TEST(LinePlot, RendersItsLinesInTheirColours) {
  LinePlot plot;
  plot.title = "a <b> & c";
  plot.series = {{"one", {0, 1, 2}, {0, 1, 0}}, {"two", {0, 1, 2}, {1, 0, 1}}};
  const Image image = decode(render_svg_to_png(to_svg(plot, true), 1.0));
  EXPECT_EQ(image.width(), plot.width);
  int blue = 0;
  int orange = 0;
  for (const Color& pixel : image.pixels()) {
    blue += pixel == Color{0x00, 0x72, 0xb2} ? 1 : 0;
    orange += pixel == Color{0xd5, 0x5e, 0x00} ? 1 : 0;
  }
  EXPECT_GT(blue, 200);
  EXPECT_GT(orange, 200);
}

TEST(LinePlot, ShowsEachOfThreeLinesThatLieOnEachOther) {
  LinePlot plot;
  for (const char* name : {"one", "two", "three"}) {
    plot.series.push_back({name, {0, 1, 2}, {0, 1, 0.5}});
  }
  const Image image = decode(render_svg_to_png(to_svg(plot, true), 1.5));
  // Below the legend; the edges of a line, a pixel or less, are blended with what lies below.
  std::map<std::string, int> seen;
  for (int y = image.height() / 2; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Color c = image.at(x, y);
      if (c.b > c.r + 60) ++seen["blue"];
      if (c.r > c.g + 60 && c.r > c.b + 60) ++seen["orange"];
      if (c.g > c.r + 60 && c.g > c.b) ++seen["green"];
    }
  }
  for (const char* color : {"blue", "orange", "green"}) EXPECT_GT(seen[color], 100) << color;
}

TEST(LinePlot, IsSavedAsAPictureOrSaysThatItCannotBe) {
  LinePlot plot;
  plot.series = {{"one", {0, 1, 2}, {0, 1, 0}}};
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "plot.png";
  save_png(plot, file);
  EXPECT_EQ(decode(test::bytes_of(file)).width(), plot.width * 3 / 2);
  EXPECT_THROW(save_png(plot, folder.path() / "missing" / "plot.png"), OutputError);
}

TEST(LinePlot, DrawsLonelyPointsAsDots) {
  LinePlot plot;
  plot.points = true;
  plot.series = {{"one", {3.0}, {1.0}}, {"two", {5.0}, {2.0}}};
  const Image image = decode(render_svg_to_png(to_svg(plot, true), 1.0));
  const auto blue =
      std::count(image.pixels().begin(), image.pixels().end(), Color{0x00, 0x72, 0xb2});
  plot.points = false;
  const Image lines = decode(render_svg_to_png(to_svg(plot, true), 1.0));
  const auto legend_only =
      std::count(lines.pixels().begin(), lines.pixels().end(), Color{0x00, 0x72, 0xb2});
  EXPECT_GT(blue, legend_only);
}

TEST(LinePlot, NamesEachKindOfEventOnceHoweverOftenItHappens) {
  LinePlot plot{.title = "errors", .x_label = "t [s]", .y_label = "e [m]"};
  plot.series.push_back({"alone", {0.0, 100.0}, {0.0, 1.0}});
  for (double x = 1.0; x < 60.0; x += 2.0) plot.events.push_back({x, "new & old"});
  plot.events.push_back({99.0, "box"});
  plot.events.push_back({101.0, "box"});  // beyond the axis
  const std::string svg = to_svg(plot, false);
  const auto count = [&](const std::string& text) {
    std::size_t found = 0;
    for (std::size_t at = svg.find(text); at != std::string::npos; at = svg.find(text, at + 1)) {
      ++found;
    }
    return found;
  };
  EXPECT_EQ(count(">new &amp; old</text>"), 1U);
  EXPECT_EQ(count(">box</text>"), 1U);
  EXPECT_EQ(count(">alone</text>"), 0U);
  EXPECT_EQ(count("class='event e0'"), 31U);  // 30 and the legend's
  EXPECT_EQ(count("class='event e1'"), 2U);
}

TEST(LinePlot, CsvHoldsEveryPoint) {
  LinePlot plot;
  plot.series = {{"s", {1, 2}, {0.5, 0.25}}};
  EXPECT_EQ(to_csv(plot), "series,x,y\ns,1,0.5\ns,2,0.25\n");
}

TEST(Base64, MatchesTheExamplesOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(HtmlReport, IsOneFileWithEveryPictureInside) {
  const test::TemporaryDirectory folder;
  HtmlReport report(folder.path(), "A <report>");
  report.verdict("no difference");
  report.picture("map", Image(4, 4), "an empty map", "caption");
  LinePlot plot;
  plot.title = "error";
  plot.series = {{"s", {0, 1}, {0, 1}}};
  report.plot("error", plot, "caption");
  report.write();
  for (const char* name : {"report.html", "map.png", "error.png", "error.svg", "error.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / name)) << name;
  }
  const std::string html = report.html();
  EXPECT_NE(html.find("A &lt;report&gt;"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,"), std::string::npos);
  EXPECT_EQ(html.find("src=\"map.png\""), std::string::npos);
  EXPECT_EQ(html.find("https://"), std::string::npos);
}

TEST(HtmlReport, TakesPicturesThatAreEncodedAsTheyAre) {
  const test::TemporaryDirectory folder;
  HtmlReport report(folder.path(), "r");
  report.png("map", "foobar", "no \"picture\"", "a < b");
  EXPECT_EQ(test::bytes_of(folder.path() / "map.png"), "foobar");
  EXPECT_NE(report.body().find("<img src=\"data:image/png;base64,Zm9vYmFy\" "
                               "alt=\"no &quot;picture&quot;\">"
                               "<figcaption>a &lt; b</figcaption>"),
            std::string::npos)
      << report.body();
}

TEST(HtmlReport, ExplainsTheWordsOfATableBelowIt) {
  HtmlReport report(".", "r");
  report.table({{"a", "b"}, {{"1", "2"}}, "plain"});
  EXPECT_EQ(report.body().find("<dl"), std::string::npos);
  report.table({{"a", "b"}, {{"1", "2"}}, "with words", {{"b", "less < more"}}});
  const std::size_t words = report.body().find("<dt>b</dt> <dd>less &lt; more</dd>");
  ASSERT_NE(words, std::string::npos);
  EXPECT_GT(words, report.body().rfind("</table>"));
}

TEST(HtmlReport, LinksToFilesBesideItWhateverTheirNames) {
  HtmlReport report(".", "r");
  report.link("replay.html", "Play <the> drive");
  report.link("1_a b#c:\"d/report.html", "building");
  EXPECT_NE(report.body().find("<a href=\"replay.html\">Play &lt;the&gt; drive</a>"),
            std::string::npos);
  EXPECT_NE(report.body().find("href=\"1_a%20b%23c%3A%22d/report.html\""), std::string::npos);
}

TEST(HtmlReport, SaysWhereItCannotWrite) {
  HtmlReport report("/nonexistent/folder", "r");
  EXPECT_THROW(report.write(), OutputError);
}

}  // namespace
}  // namespace strata::report
