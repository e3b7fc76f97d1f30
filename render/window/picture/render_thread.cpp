#include "render/window/picture/render_thread.h"

#include <utility>

#include "render/gl/gl_context.h"
#include "render/scene/displacement_drawing.h"
#include "render/window/picture/picture_files.h"
#include "render/window/picture/view_picture.h"

namespace condyle {

struct RenderThread::Drawing {
  explicit Drawing(std::shared_ptr<void> made) : context(std::move(made)) {}

  std::shared_ptr<void> context;
  ViewPicture view;
  std::optional<SceneRenderer> renderer;
  OverlaySender overlays;
  std::optional<DisplacementDrawing> displacement;
  RenderRequest applied;  // state of the renderer

  /// Sends the renderer the changes since the last request.
  void apply(const RenderRequest& request) {
    const bool other = request.parts != applied.parts;
    if (other) {
      renderer.reset();
      displacement.reset();
      overlays = {};
      applied = {.parts = request.parts};  // also if the upload fails: it is tried once
      if (request.parts) {
        renderer.emplace(request.parts->parts, request.parts->operation);
        if (request.parts->colours) renderer->set_colour_map(*request.parts->colours);
      }
    }
    if (!renderer) return;
    const auto name = [&](const MapSurface& surface) {
      return request.parts->parts[surface.part].name;
    };
    if (request.map && request.map != applied.map)
      for (const auto& surface : request.map->surfaces)
        renderer->set_finer(name(surface), *surface.mesh, surface.normals);
    const bool moved = request.frame != applied.frame || applied.beside;
    const bool tinted = request.map != applied.map || request.values != applied.values ||
                        request.displacement != applied.displacement ||
                        (request.displacement && moved) || applied.beside;
    if (request.frame && moved) renderer->update(*request.frame);
    if (tinted) tint(request, request.frame.get(), request.values.get());
    if (request.overlays != applied.overlays)
      overlays.send(*renderer, request.overlays ? *request.overlays : Overlays{});
    applied = request;
  }

  /// Switches to the state beside, or to the request's own.
  void turn_to(const RenderRequest& request, bool beside) {
    const FrameState& frame = beside ? *request.beside : *request.frame;
    renderer->update(frame);
    tint(request, &frame, beside ? request.beside_values.get() : request.values.get());
    if (!request.overlays) return;
    // Lines and sheets belong to the request's own state; paths to the whole motion.
    Overlays lasting;
    if (const auto paths = request.overlays->lines.find("paths");
        paths != request.overlays->lines.end())
      lasting.lines.insert(*paths);
    overlays.send(*renderer, beside ? lasting : *request.overlays);
  }

 private:
  /// Colours by values, of a frame (none: at rest).
  void tint(const RenderRequest& request, const FrameState* frame, const MapValues* values) {
    if (request.map)
      for (std::size_t i = 0; i < request.map->surfaces.size(); ++i)
        renderer->color_part(request.parts->parts[request.map->surfaces[i].part].name,
                             values && i < values->size() ? (*values)[i] : std::vector<float>{});
    if (request.displacement) {
      if (!displacement) displacement.emplace(request.parts->parts);
      displacement->color(*renderer, frame ? *frame : FrameState{});
    } else if (displacement) {
      displacement->clear(*renderer);
      displacement.reset();
      if (request.parts->colours) renderer->set_colour_map(*request.parts->colours);
    }
  }
};

RenderThread::RenderThread(std::function<void()> notify)
    : notify_(std::move(notify)),
      make_context_([] { return std::make_shared<OffscreenContext>(); }),
      thread_([this] { work(); }) {}

RenderThread::~RenderThread() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void RenderThread::request(RenderRequest request) {
  {
    const std::lock_guard lock(mutex_);
    requested_ = std::move(request);
  }
  changed_.notify_all();
}

std::optional<DrawnPicture> RenderThread::take() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(newest_, std::nullopt);
}

bool RenderThread::lacks_context() const {
  const std::lock_guard lock(mutex_);
  return lacks_context_;
}

void RenderThread::use_context(ContextMaker maker) {
  const std::lock_guard lock(mutex_);
  make_context_ = std::move(maker);
}

void RenderThread::finish() {
  std::unique_lock lock(mutex_);
  finished_.wait(lock, [this] { return !busy_ && !requested_ && saves_.empty(); });
}

void RenderThread::save_picture(std::filesystem::path folder) {
  {
    const std::lock_guard lock(mutex_);
    saves_.push_back({std::move(folder), std::nullopt});
  }
  changed_.notify_all();
}

void RenderThread::save(Image image, std::filesystem::path folder) {
  {
    const std::lock_guard lock(mutex_);
    saves_.push_back({std::move(folder), std::move(image)});
  }
  changed_.notify_all();
}

std::optional<RenderThread::Saved> RenderThread::take_saved() {
  const std::lock_guard lock(mutex_);
  if (saved_.empty()) return std::nullopt;
  Saved first = std::move(saved_.front());
  saved_.pop_front();
  return first;
}

bool RenderThread::given_up() const {
  const std::lock_guard lock(mutex_);
  return stop_ || requested_;
}

void RenderThread::work() {
  std::optional<Drawing> drawing;
  RenderRequest last;
  while (true) {
    std::optional<SaveRequest> save_order;
    bool requested = false;
    {
      std::unique_lock lock(mutex_);
      busy_ = false;
      finished_.notify_all();
      changed_.wait(lock, [this] { return stop_ || requested_ || !saves_.empty(); });
      if (stop_) return;
      busy_ = true;
      requested = requested_.has_value();
      if (requested) {
        last = *std::exchange(requested_, std::nullopt);
      } else {
        save_order = std::move(saves_.front());
        saves_.pop_front();
      }
    }
    if (requested)
      draw(drawing, last);
    else
      save(drawing, last, std::move(*save_order));
    if (notify_) notify_();
  }
}

void RenderThread::draw(std::optional<Drawing>& drawing, const RenderRequest& request) {
  try {
    if (!drawing) {
      ContextMaker maker;
      {
        const std::lock_guard lock(mutex_);
        lacks_context_ = true;
        maker = make_context_;
      }
      drawing.emplace(maker());
      const std::lock_guard lock(mutex_);
      lacks_context_ = false;
    }
    drawing->apply(request);
    if (!drawing->renderer) return;
    auto picture = drawing->view.draw(
        *drawing->renderer, request, [&](bool beside) { drawing->turn_to(request, beside); },
        [this] { return given_up(); });
    const std::lock_guard lock(mutex_);
    if (picture) newest_ = std::move(picture);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

void RenderThread::save(std::optional<Drawing>& drawing, const RenderRequest& shown,
                        SaveRequest request) {
  Saved saved;
  try {
    if (!request.image) {
      if (!drawing || !drawing->renderer) return;
      request.image = drawing->renderer->picture(shown.camera, shown.settings);
    }
    saved.file = next_picture_file(request.folder);
    write_png(saved.file, *request.image);
  } catch (const std::exception& error) {
    saved.trouble = error.what();
  }
  const std::lock_guard lock(mutex_);
  saved_.push_back(std::move(saved));
}

}  // namespace condyle
