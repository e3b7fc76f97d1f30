#include "render/picture_target.h"

#include <algorithm>
#include <cstring>

namespace condyle {

PictureTarget::Canvas::Canvas(int width, int height) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  glBindTexture(GL_TEXTURE_2D, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
}

void PictureTarget::fit(int width, int height, int samples, bool smooth) {
  const bool other = !drawn_ || drawn_->width() != width || drawn_->height() != height;
  if (other || samples != samples_asked_) {
    drawn_.reset();  // the old memory first
    if (other) finished_.reset();
    if (other) raw_.reset();
    drawn_.emplace(width, height, samples);
    samples_asked_ = samples;
  }
  if (smooth && !raw_) raw_.emplace(width, height);
  if (!smooth) raw_.reset();
  if ((smooth || drawn_->samples() > 0) && !finished_) finished_.emplace(width, height, 1);
}

void PictureTarget::read(const DrawnBox& drawn, bool transparent, bool from_the_top,
                         std::vector<std::uint8_t>& rgba) {
  const int width = drawn_->width(), height = drawn_->height();
  const DrawnBox all = {0, 0, width, height};
  DrawnBox box = all.both(drawn);
  const Framebuffer* last = &*drawn_;
  if (!box.empty() && raw_) {
    drawn_->resolve_to(raw_->framebuffer, box);
    // What is made smooth looks a few pixels around; the background stays as it is.
    constexpr int reach = drawn_air / 2;
    if (box.x0 > 0) box.x0 += reach;
    if (box.y0 > 0) box.y0 += reach;
    if (box.x1 < width) box.x1 -= reach;
    if (box.y1 < height) box.y1 -= reach;
    if (!smoothing_) smoothing_.emplace();
    finished_->bind();
    smoothing_->draw(raw_->texture, width, height, box);
    last = &*finished_;
  } else if (!box.empty() && drawn_->samples() > 0) {
    drawn_->resolve_to(finished_->name(), box);
    last = &*finished_;
  }
  const auto bytes = [](int pixels) { return std::size_t{4} * static_cast<std::size_t>(pixels); };
  const auto row = [&](int y) {
    return rgba.data() + bytes(width) * static_cast<std::size_t>(from_the_top ? height - 1 - y : y);
  };
  rgba.resize(bytes(width) * static_cast<std::size_t>(height));
  if (box != all && transparent) {
    std::fill(rgba.begin(), rgba.end(), std::uint8_t{0});
  } else if (box != all) {
    if (!background_) background_.emplace();
    const auto& behind = background_->picture(width, height);
    for (int y = 0; y < height; ++y)
      std::memcpy(row(y), behind.data() + bytes(width) * static_cast<std::size_t>(y), bytes(width));
  }
  if (box.empty()) return;
  last->bind();
  read_.resize(bytes(box.width()) * static_cast<std::size_t>(box.height()));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(box.x0, box.y0, box.width(), box.height(), GL_RGBA, GL_UNSIGNED_BYTE, read_.data());
  if (!transparent)
    for (std::size_t i = 3; i < read_.size(); i += 4) read_[i] = 255;
  for (int y = box.y0; y < box.y1; ++y)
    std::memcpy(row(y) + bytes(box.x0),
                read_.data() + bytes(box.width()) * static_cast<std::size_t>(y - box.y0),
                bytes(box.width()));
}

}  // namespace condyle
