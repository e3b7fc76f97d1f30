#include "render/session/preview_session.h"

#include <utility>

namespace condyle {
namespace {

LineSet path_lines(const MotionPreview& preview) {
  const std::array<Eigen::Vector3f, 3> colours = {
      {{0.94f, 0.89f, 0.26f}, {0.34f, 0.71f, 0.91f}, {0.90f, 0.62f, 0.0f}}};
  LineSet lines;
  lines.width_px = 2.5f;
  lines.through = 0.75f;
  for (std::size_t k = 0; k < colours.size(); ++k) {
    const std::size_t before = lines.ends.size();
    add_run(lines, preview.paths[k]);
    lines.colors.insert(lines.colors.end(), (lines.ends.size() - before) / 2, colours[k]);
  }
  return lines;
}

}  // namespace

void PreviewSession::restart() {
  job_.drop();
  state_.front_end.show_plots({});
  due_ = true;
}

void PreviewSession::forget() {
  job_.drop();
  paths_.reset();
}

void PreviewSession::start() {
  due_ = false;
  post_ = std::make_shared<Post>();
  job_.start([patient = state_.patient, motion = state_.motion, settings = state_.settings,
              post = post_](const Progress& progress) {
    const auto partly = [&post](MotionPreview preview) {
      const std::lock_guard lock(post->mutex);
      post->preview = std::move(preview);
    };
    return preview_motion(*patient, motion->motion, settings.simulator, settings.respect_contact,
                          partly, progress);
  });
}

void PreviewSession::update(bool may_start) {
  if (due_ && may_start && state_.motion) start();
  if (!job_.active()) return;
  if (job_.done())
    return state_.try_or_report("Cannot draw the plots", [&] {
      if (auto preview = job_.take()) show(std::move(*preview));
    });
  const std::lock_guard lock(post_->mutex);
  if (post_->preview) show(std::move(*post_->preview));
  post_->preview.reset();
}

void PreviewSession::show(MotionPreview preview) {
  paths_ = std::make_shared<LineSet>(path_lines(preview));
  state_.front_end.show_plots(std::move(preview.plots));
}

}  // namespace condyle
