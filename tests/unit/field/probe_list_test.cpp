// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/probe_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/analytic_fields.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ProbeListTest : public testing::Test {
 protected:
  Result<ProbeList> read(const std::string& text) {
    const auto file = folder_.path() / "probes.csv";
    std::ofstream(file) << text;
    return read_probe_list(file);
  }
  std::string refusal(const std::string& text) {
    const auto list = read(text);
    EXPECT_FALSE(list) << text;
    if (list) return "";
    EXPECT_EQ(list.error().kind, ErrorKind::bad_input);
    return list.error().message;
  }
  test::TemporaryFolder folder_;
};

TEST_F(ProbeListTest, FilesAreBesideTheList) {
  const auto list = read("x,y,z,file\n1,2,3,a.exr\n-1.5,0,2e-1,/b/c.hdr\n");
  ASSERT_TRUE(list);
  EXPECT_EQ(list->positions[1], Vec3d(-1.5, 0, 0.2));
  EXPECT_EQ(list->files[0], folder_.path() / "a.exr");
  EXPECT_EQ(list->files[1], "/b/c.hdr");
}

TEST_F(ProbeListTest, RefusesPosesThatAreNone) {
  EXPECT_THAT(refusal("x,y,z,file\n1,nan,3,a.exr\n"), HasSubstr("probes.csv: line 2"));
  EXPECT_THAT(refusal("x,y,z,file\n1,2,inf,a.exr\n"), HasSubstr("z"));
  EXPECT_THAT(refusal("x,y,z,file\n1,,3,a.exr\n"), HasSubstr("y"));
  EXPECT_THAT(refusal("x,y,z,file\n1,2e9,3,a.exr\n"), HasSubstr("-100000 to 100000 metres"));
  EXPECT_THAT(refusal("x,y,file\n1,2,a.exr\n"), HasSubstr("z"));
  EXPECT_THAT(refusal("x,y,z,file\n"), HasSubstr("no probes"));
  EXPECT_THAT(refusal("x,y,z,file\n1,2,3,\n"), HasSubstr("file is empty"));
}

TEST(RemarksOnPlaces, SayWhatIsNotDetermined) {
  const FieldGrid grid{{5, 5, 5}, Vec3d::Zero(), Vec3d::Ones()};
  EXPECT_THAT(remarks_on_places(test::random_positions(20, 1), grid), IsEmpty());
  std::vector<Vec3d> places(9, Vec3d(0.5, 0.5, 0.5));
  EXPECT_THAT(remarks_on_places(places, grid), ElementsAre(HasSubstr("in one place")));
  for (std::size_t i = 0; i < places.size(); ++i) places[i].x() = 0.1 * static_cast<double>(i);
  EXPECT_THAT(remarks_on_places(places, grid), ElementsAre(HasSubstr("on a line along (1.00, 0.00, 0.00)")));
  places = test::random_positions(20, 1);
  for (Vec3d& p : places) p.y() = 0.3;
  EXPECT_THAT(remarks_on_places(places, grid),
              ElementsAre(HasSubstr("in a plane across (0.00, 1.00, 0.00)")));
  places = test::random_positions(20, 1);
  for (Vec3d& p : places) p.z() += 4;
  EXPECT_THAT(remarks_on_places(places, grid), ElementsAre(HasSubstr("no probe is inside --bounds")));
}

}  // namespace
}  // namespace lightwell
