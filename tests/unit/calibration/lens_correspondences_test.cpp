// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/lens/correspondences.h"
#include "interface/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::calibration {
namespace {

using testing::HasSubstr;

class CorrespondencesFile : public testing::Test {
 protected:
  Result<TargetViews> read(const std::string& text) {
    EXPECT_TRUE(write_file_atomically(file_, text));
    return read_target_views(file_);
  }
  // Refused as bad input, in one line that names the file and what it must.
  void expect_refused(const std::string& text, const std::string& names) {
    const auto views = read(text);
    ASSERT_FALSE(views.ok()) << text;
    EXPECT_EQ(views.error().kind, ErrorKind::bad_input);
    EXPECT_THAT(views.error().message, HasSubstr("corners.json"));
    EXPECT_THAT(views.error().message, HasSubstr(names));
    EXPECT_EQ(views.error().message.find('\n'), std::string::npos);
  }

 private:
  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "corners.json";
};

TEST_F(CorrespondencesFile, ReadsBackWhatWasWritten) {
  const TargetViews written{{640, 480},
                            {{"a", {{{0, 0, 0}, {1.25, 2.5}}, {{30, 0, -1}, {-3, 480}}}}, {"b", {}}}};
  const auto read_back = read(to_json(written));
  ASSERT_TRUE(read_back.ok()) << read_back.error().message;
  EXPECT_EQ(read_back->image_size, written.image_size);
  ASSERT_EQ(read_back->views.size(), 2u);
  EXPECT_EQ(read_back->views[0].name, "a");
  ASSERT_EQ(read_back->views[0].points.size(), 2u);
  EXPECT_EQ(read_back->views[0].points[1].target_mm, written.views[0].points[1].target_mm);
  EXPECT_EQ(read_back->views[0].points[1].pixel, written.views[0].points[1].pixel);
  EXPECT_TRUE(read_back->views[1].points.empty());
}

TEST_F(CorrespondencesFile, ANameThatIsNotUtf8IsWrittenAllTheSame) {
  const auto read_back = read(to_json({{640, 480}, {{"a\xff", {}}}}));
  ASSERT_TRUE(read_back.ok()) << read_back.error().message;
  EXPECT_EQ(read_back->views[0].name, "a\xEF\xBF\xBD");  // U+FFFD
}

TEST_F(CorrespondencesFile, NamesTheFieldThatIsWrong) {
  const std::string head = R"({"image_size":[640,480],"views":[{"name":"a","points":[)";
  expect_refused("{", "JSON");
  expect_refused("[]", "array");
  expect_refused("{}", "image_size");
  expect_refused(R"({"image_size":[640,0],"views":[]})", "image_size[1]");
  expect_refused(R"({"image_size":[640,480]})", "views");
  expect_refused(R"({"image_size":[640,480],"views":[7]})", "views[0]");
  expect_refused(R"({"image_size":[640,480],"views":[{}]})", "views[0].points");
  expect_refused(head + "[1,2,3,4]]}]}", "views[0].points[0]");
  expect_refused(head + "[1,2,3,NaN,5]]}]}", "JSON");
  expect_refused(head + "[1,2,3,1e999,5]]}]}", "1e999");
  expect_refused(head + "[1e300,2,3,4,5]]}]}", "views[0].points[0][0] = 1e+300: allowed -1e+09 to 1e+09 mm");
  expect_refused(head + "[1,2,-2e9,4,5]]}]}", "views[0].points[0][2] = -2e+09");
  expect_refused(head + "[1,2,3,1e300,5]]}]}", "views[0].points[0][3] = 1e+300: allowed -640 to 1280 px");
  expect_refused(head + "[1,2,3,null,5]]}]}", "views[0].points[0][3]");
  expect_refused(head + "[1,2,3,4,961]]}]}", "views[0].points[0][4]");
  expect_refused(head + "[1,2,3,4,5],[1,2,3,6,7]]}]}", "views[0].points[1]");
  expect_refused(R"({"image_size":[6,4],"views":[{"name":"a","points":[]},{"name":"a","points":[]}]})",
                 "views[1].name");
  expect_refused(R"({"image_size":[6,4],"views":[{"name":"a","points":[[0,0,0,1,2]]},)"
                 R"({"name":"b","points":[[0,0,0,1,2]]}]})",
                 "views[1].points");
}

TEST_F(CorrespondencesFile, MoreThanAnybodyPhotographsIsRefused) {
  const auto views = [](std::size_t n) {
    TargetViews out{{640, 480}, {}};
    for (std::size_t i = 0; i < n; ++i) out.views.push_back({std::to_string(i), {}});
    return to_json(out);
  };
  EXPECT_TRUE(read(views(2000)));
  expect_refused(views(2001), "views has 2001: allowed at most 2000");
  const auto points = [](std::size_t n) {
    TargetViews out{{640, 480}, {{"a", {}}}};
    for (std::size_t i = 0; i < n; ++i)
      out.views[0].points.push_back({{static_cast<double>(i), 0, 0}, {1, 2}});
    return to_json(out);
  };
  EXPECT_TRUE(read(points(100000)));
  expect_refused(points(100001), "views[0].points has 100001: allowed at most 100000");
}

}  // namespace
}  // namespace lightwell::calibration
