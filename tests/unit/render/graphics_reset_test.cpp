// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/graphics_reset.h"

#include <GLES2/gl2ext.h>

#include "tests/unit/render/render_fixture.h"

namespace lightwell::render {
namespace {

GLenum good() {
  return GL_NO_ERROR;
}
template <GLenum Code>
GLenum always() {
  return Code;
}

void expect_failure(const GraphicsReset& reset, const std::string& why) {
  const Status status = reset.check();
  ASSERT_FALSE(status.ok()) << why;
  EXPECT_EQ(status.error().kind, ErrorKind::failed);
  EXPECT_NE(status.error().message.find(why), std::string::npos) << status.error().message;
  EXPECT_EQ(status.error().message.find('\n'), std::string::npos);
}

TEST(GraphicsReset, SaysThatTheContextIsLostAndWhoLostIt) {
  expect_failure({always<GL_GUILTY_CONTEXT_RESET_EXT>, good}, "because of this program");
  expect_failure({always<GL_INNOCENT_CONTEXT_RESET_EXT>, good}, "another program");
  expect_failure({always<GL_UNKNOWN_CONTEXT_RESET_EXT>, good}, "context is lost");
  // A driver that cannot be asked says it as an error.
  expect_failure({nullptr, always<GL_CONTEXT_LOST_KHR>}, "context is lost");
}

TEST(GraphicsReset, OtherErrorsAreNoLoss) {
  expect_failure({good, always<GL_OUT_OF_MEMORY>}, "out of memory");
  EXPECT_TRUE(GraphicsReset(good, good).check());
  EXPECT_TRUE(GraphicsReset(nullptr, good).check());
}

class LivingContext : public test::Rendering {};

TEST_F(LivingContext, IsGoodAndItsErrorsAreTold) {
  const GraphicsReset reset;
  EXPECT_TRUE(reset.check());
  glEnable(0xFFFF);
  EXPECT_FALSE(reset.check());
  EXPECT_TRUE(reset.check());
}

}  // namespace
}  // namespace lightwell::render
