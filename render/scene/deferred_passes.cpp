#include <algorithm>
#include <vector>

#include "render/scene/passes.h"

// Deferred shading, in pictures of one sample per pixel and of several.
namespace condyle {
namespace {

void bind_texture(GLenum unit, GLuint texture) {
  glActiveTexture(unit);
  glBindTexture(GL_TEXTURE_2D, texture);
}

/// A box with a margin of one pixel, since edge filters read a pixel's neighbours, in whole tiles:
/// Mesa's rasteriser has one program for whole tiles and another for partial ones, with different
/// rounding.
DrawnBox whole_tiles(const DrawnBox& box, const PictureView& view) {
  constexpr int tile = 64;
  const auto down = [](int x) { return x / tile * tile; };
  return DrawnBox{down(std::max(0, box.x0 - 1)), down(std::max(0, box.y0 - 1)), down(box.x1 + tile),
                  down(box.y1 + tile)}
      .both({0, 0, view.width, view.height});
}

/// The pixels that a part may cover.
DrawnBox box_of(const DrawItem& item, const PictureView& view) {
  PictureBounds bounds(view.width, view.height, view.view_projection);
  bounds.add(item.surface(view.coarse).box, item.model);
  return bounds.box(1);
}

/// Lit pixels of opaque surfaces store the number of their surface in place of their opacity.
float number_of(std::size_t item) { return static_cast<float>(item + 1) / 255; }

}  // namespace

void Passes::store(const DrawItem& item, int number, std::span<const Eigen::Vector3i> triangles,
                   const PictureView& view) {
  buffer_.number_surface(number);
  GlProgram& program = kept_.of({.skin = item.role() == Role::face});
  program.use();
  place(program, item, view);
  item.mesh().draw(triangles);
  end_cut();
}

void Passes::light_stored(const DrawItem& item, int number, float alpha, const DrawnBox& box,
                          const PictureView& view) {
  GlProgram& program = begin(item.role() == Role::face ? skins_ : surfaces_, item, view, true);
  see_stored(program);
  program.set("opacity", alpha);
  view.set_rays_in(program);
  glBindVertexArray(no_attributes_);
  buffer_.light(number, box);
  end_cut();
}

void Passes::deferred(std::span<const DrawItem> items, const PictureView& view) {
  GLint target = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  const DrawnBox around = whole_tiles(view.box, view);
  buffer_.fit(view.width, view.height);
  buffer_.begin_surfaces(around);
  std::vector<char> seen(items.size(), 0);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const auto& chosen = seen_of(items[i], view);
    seen[i] = !chosen.empty();
    if (seen[i]) store(items[i], static_cast<int>(i) + 1, chosen, view);
  }
  glFlush();

  buffer_.begin_light();
  for (std::size_t i = 0; i < items.size(); ++i) {
    const DrawnBox box = whole_tiles(box_of(items[i], view), view).both(around);
    if (seen[i] && !box.empty())
      light_stored(items[i], static_cast<int>(i) + 1, number_of(i), box, view);
  }
  buffer_.end();

  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
  glScissor(view.box.x0, view.box.y0, view.box.width(), view.box.height());
  if (view.one_sample)
    place_all(view);
  else
    place_sampled(items, seen, view, static_cast<GLuint>(target));
}

void Passes::see_stored(GlProgram& program) {
  bind_texture(GL_TEXTURE5, buffer_.words());
  bind_texture(GL_TEXTURE6, buffer_.away());
  program.set("kept_words", 5);
  program.set("kept_away", 6);
}

void Passes::see_lit(GlProgram& program, const PictureView& view) {
  see_stored(program);
  bind_texture(GL_TEXTURE7, buffer_.lit());
  bind_texture(GL_TEXTURE8, buffer_.depth());
  program.set("lit", 7);
  program.set("kept_depth", 8);
  program.set("last_pixel", Eigen::Vector2i(view.width - 1, view.height - 1));
}

void Passes::place_all(const PictureView& view) {
  place_.use();
  see_lit(place_, view);
  Background::set_in(place_, view.width, view.height, view.backdrop.value_or(Backdrop::dark));
  place_.set("behind", view.backdrop ? 1.f : 0.f);
  glBindVertexArray(no_attributes_);
  glDisable(GL_CULL_FACE);
  glDepthFunc(GL_ALWAYS);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthFunc(GL_LESS);
  has_backdrop_ = true;
}

void Passes::find_edges(const PictureView& view) {
  buffer_.begin_edges();
  edges_.use();
  see_lit(edges_, view);
  glDisable(GL_DEPTH_TEST);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
  if (!software_) return;  // a card draws all triangles sooner than it sends the marks
  const DrawnBox& box = view.box;
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(box.x0, box.y0, box.width(), box.height(), GL_RED, GL_UNSIGNED_BYTE,
               edge_pixels_.marks_within(box).data());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
}

void Passes::place_sampled(std::span<const DrawItem> items, const std::vector<char>& seen,
                           const PictureView& view, GLuint target) {
  glBindVertexArray(no_attributes_);
  glDisable(GL_CULL_FACE);
  find_edges(view);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  // Pixels without edges come first; the stencil keeps them from being drawn again.
  glEnable(GL_STENCIL_TEST);
  glStencilFunc(GL_ALWAYS, 1, 0xff);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  inner_.use();
  see_lit(inner_, view);
  bind_texture(GL_TEXTURE9, buffer_.edges());
  inner_.set("edges", 9);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glStencilFunc(GL_EQUAL, 0, 0xff);
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  carry_.use();
  see_lit(carry_, view);
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!seen[i]) continue;
    place(carry_, items[i], view);
    carry_.set("number", number_of(i));
    const auto& mesh = items[i].mesh();
    const auto& triangles = seen_of(items[i], view);
    const float widened = items[i].drawable->behind_lashes ? lash_pixels : 0;
    mesh.draw(software_ ? edge_pixels_.touching(mesh.points(), triangles,
                                                view.view_projection * items[i].model, view.width,
                                                view.height, widened)
                        : triangles);
    end_cut();
  }
  glDisable(GL_STENCIL_TEST);
}

void Passes::deferred_front(const DrawItem& item, const PictureView& view) {
  GLint target = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  const DrawnBox around = whole_tiles(box_of(item, view), view).both(whole_tiles(view.box, view));
  const auto& chosen = seen_of(item, view);
  if (chosen.empty() || around.empty()) return;
  buffer_.fit(view.width, view.height);
  buffer_.begin_surfaces(around);
  store(item, 1, chosen, view);
  if (item.role() == Role::face && !item.drawable->closed) {
    // Where its inner side is nearer, the front is hidden.
    buffer_.number_surface(0);
    depth_only(item, view, Sides::back);
  }
  glFlush();

  buffer_.begin_light();
  buffer_.clear_light(around);
  light_stored(item, 1, static_cast<float>(item.opacity), around, view);
  buffer_.end();

  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
  const DrawnBox box = around.both(view.box);
  glScissor(box.x0, box.y0, box.width(), box.height());
  blend_.use();
  see_lit(blend_, view);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  glScissor(view.box.x0, view.box.y0, view.box.width(), view.box.height());
}

}  // namespace condyle
