#include "render/scene/picture_target.h"

#include <algorithm>
#include <cstring>

#include "render/image/smoothing.h"

namespace condyle {

void PictureTarget::fit(int width, int height, int samples, bool smooth) {
  const bool other = !drawn_ || drawn_->width() != width || drawn_->height() != height;
  if (other || samples != samples_asked_) {
    drawn_.reset();  // frees the old memory first
    if (other) finished_.reset();
    drawn_.emplace(width, height, samples);
    samples_asked_ = samples;
  }
  smooth_ = smooth;
  if (drawn_->samples() > 0 && !finished_) finished_.emplace(width, height, 1);
}

void PictureTarget::read(const DrawnBox& drawn, std::optional<Backdrop> backdrop, bool from_the_top,
                         std::vector<std::uint8_t>& rgba) {
  const int width = drawn_->width(), height = drawn_->height();
  const DrawnBox all = {0, 0, width, height};
  DrawnBox box = all.both(drawn);
  const Framebuffer* last = &*drawn_;
  if (!box.empty() && drawn_->samples() > 0) {
    drawn_->resolve_to(finished_->name(), box);
    last = &*finished_;
  }
  const auto bytes = [](int pixels) { return std::size_t{4} * static_cast<std::size_t>(pixels); };
  const auto row = [&](int y) {
    return rgba.data() + bytes(width) * static_cast<std::size_t>(from_the_top ? height - 1 - y : y);
  };
  rgba.resize(bytes(width) * static_cast<std::size_t>(height));
  if (box != all && !backdrop) {
    std::fill(rgba.begin(), rgba.end(), std::uint8_t{0});
  } else if (box != all) {
    if (!background_) background_.emplace();
    const auto& empty = background_->picture(width, height, *backdrop);
    for (int y = 0; y < height; ++y)
      std::memcpy(row(y), empty.data() + bytes(width) * static_cast<std::size_t>(y), bytes(width));
  }
  if (box.empty()) return;
  last->bind();
  read_.resize(bytes(box.width()) * static_cast<std::size_t>(box.height()));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(box.x0, box.y0, box.width(), box.height(), GL_RGBA, GL_UNSIGNED_BYTE, read_.data());
  if (backdrop)
    for (std::size_t i = 3; i < read_.size(); i += 4) read_[i] = 255;
  const std::vector<std::uint8_t>* pixels = &read_;
  if (smooth_) {
    // The smoothing filter reads a few pixels around; the background is unchanged.
    constexpr int reach = drawn_air / 2;
    const DrawnBox all_read = box;
    if (box.x0 > 0) box.x0 += reach;
    if (box.y0 > 0) box.y0 += reach;
    if (box.x1 < width) box.x1 -= reach;
    if (box.y1 < height) box.y1 -= reach;
    const DrawnBox within = {box.x0 - all_read.x0, box.y0 - all_read.y0, box.x1 - all_read.x0,
                             box.y1 - all_read.y0};
    smooth_edges(read_, all_read.width(), all_read.height(), within, smoothed_);
    pixels = &smoothed_;
  }
  for (int y = box.y0; y < box.y1; ++y)
    std::memcpy(row(y) + bytes(box.x0),
                pixels->data() + bytes(box.width()) * static_cast<std::size_t>(y - box.y0),
                bytes(box.width()));
}

}  // namespace condyle
