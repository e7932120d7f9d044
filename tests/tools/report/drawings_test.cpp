// SPDX-License-Identifier: Apache-2.0
#include "tools/report/drawings.hpp"

#include <filesystem>
#include <new>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tools/report/html_report.hpp"

namespace fs = std::filesystem;

namespace strata::report {
namespace {

TEST(Drawings, ThatFailAreNamedRemovedAndCostNoOther) {
  const test::TemporaryDirectory folder;
  Drawings drawings;
  EXPECT_EQ(drawings.what_is_missing(), "");
  drawings.add(folder.path() / "half.png", [&] {
    write_file(folder.path() / "half.png", "half a picture");
    throw OutputError("/somewhere", "no room is left", "free some");
  });
  drawings.add(folder.path() / "large.png", [] { throw std::bad_alloc(); });
  drawings.add(folder.path() / "odd.png", [] { throw std::length_error("vector"); });
  drawings.add(folder.path() / "whole.png",
               [&] { write_file(folder.path() / "whole.png", "all"); });
  EXPECT_EQ(drawings.what_is_missing(),
            "all results are there but for pictures (half.png, large.png, odd.png): no room is "
            "left; free some");
  EXPECT_FALSE(fs::exists(folder.path() / "half.png"));
  EXPECT_EQ(test::bytes_of(folder.path() / "whole.png"), "all");
}

TEST(Drawings, AreGivenUpWhenTheUserAsks) {
  Drawings drawings;
  EXPECT_THROW(drawings.add("any.png", [] { throw Cancelled("drawing"); }), Cancelled);
}

TEST(Drawings, AreManyWithoutALineForEach) {
  Drawings drawings;
  for (int i = 0; i < 9; ++i) {
    drawings.add(std::to_string(i), [] { throw OutputError("a", "fails", "mend"); });
  }
  EXPECT_THAT(drawings.what_is_missing(), testing::HasSubstr("(0, 1, 2, 3 and 5 more): fails"));
}

TEST(Drawings, LeaveAReportThatLacksThemWhole) {
  const test::TemporaryDirectory folder;
  fs::create_directory(folder.path() / "a.png");  // in the way
  write_file(folder.path() / "a.png" / "x", "mine");
  Drawings drawings;
  HtmlReport page(folder.path(), "Title", &drawings);
  EXPECT_NO_THROW(page.picture("a", Image(3, 2), "what it shows", "caption"));
  page.write();
  EXPECT_THAT(drawings.what_is_missing(), testing::HasSubstr("a.png"));
  EXPECT_THAT(test::bytes_of(folder.path() / "report.html"), testing::HasSubstr("caption"));
  HtmlReport strict(folder.path() / "absent", "Title");
  EXPECT_THROW(strict.picture("a", Image(3, 2), "", ""), OutputError);
}

}  // namespace
}  // namespace strata::report
