// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/overlay.h"

#include <imgui.h>

#include <algorithm>
#include <cstddef>

namespace lightwell::render {
namespace {

static_assert(sizeof(ImDrawIdx) == 2, "indices are drawn as GL_UNSIGNED_SHORT");

void text_window(const char* name, const std::vector<std::string>& lines, const ImVec2& place,
                 const ImVec2& pivot) {
  if (lines.empty()) return;
  ImGui::SetNextWindowPos(place, ImGuiCond_Always, pivot);
  ImGui::SetNextWindowBgAlpha(0.6f);
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing);
  for (const std::string& line : lines) ImGui::TextUnformatted(line.c_str());
  ImGui::End();
}

// OpenGL ES 3.1 draws without a base vertex: the attributes begin at it instead.
void set_attributes(std::size_t first_vertex) {
  const auto attribute = [=](GLuint index, GLint components, GLenum type, GLboolean normalised,
                             std::size_t offset) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, components, type, normalised, sizeof(ImDrawVert),
                          reinterpret_cast<const void*>(first_vertex * sizeof(ImDrawVert) + offset));
  };
  attribute(0, 2, GL_FLOAT, GL_FALSE, offsetof(ImDrawVert, pos));
  attribute(1, 2, GL_FLOAT, GL_FALSE, offsetof(ImDrawVert, uv));
  attribute(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(ImDrawVert, col));
}

void draw_dome(const Overlay::Content& content) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  std::vector<ImVec2> points;
  for (const auto& line : content.lines) {
    points.clear();
    for (const Vec2f& p : line) points.emplace_back(p.x(), p.y());
    list.AddPolyline(points.data(), static_cast<int>(points.size()), IM_COL32(255, 255, 255, 70), 0, 1);
  }
  for (const DomeMarker& m : content.markers) {
    const ImVec2 place(m.place.x(), m.place.y());
    const float radius = std::max(m.radius_px, 2.0f);
    list.AddCircleFilled(place, radius,
                         ImColor(m.colour[0], m.colour[1], m.colour[2], m.in_front ? 0.9f : 0.45f));
    list.AddCircle(place, radius, IM_COL32(0, 0, 0, 160));
  }
}

}  // namespace

Result<Overlay> Overlay::create() {
  Overlay o;
  auto program = gl::make_program("overlay_vertex", "overlay_fragment");
  if (!program) return program.error();
  o.program_ = std::move(program).value();
  o.context_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(o.context_);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // no files
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  unsigned char* pixels = nullptr;
  int width = 0;
  int height = 0;
  io.Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
  o.font_ = gl::make_texture(GL_R8, width, height);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RED, GL_UNSIGNED_BYTE, pixels);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  o.vertex_array_ = gl::make_vertex_array();
  glBindVertexArray(o.vertex_array_.id());
  o.vertices_ = gl::make_buffer(GL_ARRAY_BUFFER, nullptr, 0, GL_STREAM_DRAW);
  o.indices_ = gl::make_buffer(GL_ELEMENT_ARRAY_BUFFER, nullptr, 0, GL_STREAM_DRAW);
  glBindVertexArray(0);
  return o;
}

Overlay::Overlay(Overlay&& other) noexcept
    : context_(std::exchange(other.context_, nullptr)),
      program_(std::move(other.program_)),
      font_(std::move(other.font_)),
      vertex_array_(std::move(other.vertex_array_)),
      vertices_(std::move(other.vertices_)),
      indices_(std::move(other.indices_)) {}

Overlay::~Overlay() {
  if (context_ != nullptr) ImGui::DestroyContext(context_);
}

void Overlay::draw(const Content& content, int width, int height) {
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
  io.DeltaTime = 0.04f;  // nothing here moves by itself
  // A window is hidden until its size is known, from a first layout.
  for (int layout = 0; layout < 2; ++layout) {
    if (layout > 0) ImGui::EndFrame();
    ImGui::NewFrame();
    draw_dome(content);
    text_window("numbers", content.numbers, ImVec2(8, 8), ImVec2(0, 0));
    text_window("help", content.help, ImVec2(io.DisplaySize.x / 2, io.DisplaySize.y / 2), ImVec2(0.5f, 0.5f));
  }
  ImGui::Render();
  draw(*ImGui::GetDrawData(), width, height);
}

void Overlay::draw(const ImDrawData& data, int width, int height) const {
  glViewport(0, 0, width, height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glEnable(GL_SCISSOR_TEST);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glUseProgram(program_.id());
  glUniform2f(gl::uniform(program_, "size"), static_cast<float>(width), static_cast<float>(height));
  glUniform1i(gl::uniform(program_, "font"), 0);
  gl::bind_texture(0, font_.id());
  glBindVertexArray(vertex_array_.id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  for (int i = 0; i < data.CmdListsCount; ++i) {
    const ImDrawList& list = *data.CmdLists[i];
    glBufferData(GL_ARRAY_BUFFER, list.VtxBuffer.size_in_bytes(), list.VtxBuffer.Data, GL_STREAM_DRAW);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, list.IdxBuffer.size_in_bytes(), list.IdxBuffer.Data,
                 GL_STREAM_DRAW);
    for (const ImDrawCmd& command : list.CmdBuffer) {
      const ImVec4& c = command.ClipRect;
      if (c.z <= c.x || c.w <= c.y) continue;
      glScissor(static_cast<GLint>(c.x), static_cast<GLint>(static_cast<float>(height) - c.w),
                static_cast<GLsizei>(c.z - c.x), static_cast<GLsizei>(c.w - c.y));
      set_attributes(command.VtxOffset);
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount), GL_UNSIGNED_SHORT,
                     reinterpret_cast<const void*>(command.IdxOffset * sizeof(ImDrawIdx)));
    }
  }
  glBindVertexArray(0);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
}

}  // namespace lightwell::render
