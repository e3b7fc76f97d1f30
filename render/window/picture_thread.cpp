#include "render/window/picture_thread.h"

#include <utility>

#include "render/displacement_drawing.h"
#include "render/gl_context.h"
#include "render/window/picture_files.h"
#include "render/window/view_picture.h"

namespace condyle {

struct PictureThread::Drawing {
  explicit Drawing(std::shared_ptr<void> made) : context(std::move(made)) {}

  std::shared_ptr<void> context;
  ViewPicture view;
  std::optional<SceneRenderer> renderer;
  OverlaySender overlays;
  std::optional<DisplacementDrawing> displacement;
  PictureOrder applied;  // what the renderer has

  /// Gives the renderer what the order has otherwise than the last one.
  void apply(const PictureOrder& wanted) {
    const bool other = wanted.parts != applied.parts;
    if (other) {
      renderer.reset();
      displacement.reset();
      overlays = {};
      applied = {.parts = wanted.parts};  // also where it cannot be uploaded: once is enough
      if (wanted.parts) {
        renderer.emplace(wanted.parts->parts);
        if (wanted.parts->colours) renderer->set_colour_map(*wanted.parts->colours);
      }
    }
    if (!renderer) return;
    const auto name = [&](const MapSurface& surface) {
      return wanted.parts->parts[surface.part].name;
    };
    if (wanted.map && wanted.map != applied.map)
      for (const auto& surface : wanted.map->surfaces)
        renderer->set_finer(name(surface), *surface.mesh, surface.normals);
    const bool moved = wanted.frame != applied.frame || applied.beside;
    const bool tinted = wanted.map != applied.map || wanted.values != applied.values ||
                        wanted.displacement != applied.displacement ||
                        (wanted.displacement && moved) || applied.beside;
    if (wanted.frame && moved) renderer->update(*wanted.frame);
    if (tinted) tint(wanted, wanted.frame.get(), wanted.values.get());
    if (wanted.overlays != applied.overlays)
      overlays.send(*renderer, wanted.overlays ? *wanted.overlays : Overlays{});
    applied = wanted;
  }

  /// Shows the state beside, or the order's own.
  void turn_to(const PictureOrder& wanted, bool beside) {
    const FrameState& frame = beside ? *wanted.beside : *wanted.frame;
    renderer->update(frame);
    tint(wanted, &frame, beside ? wanted.beside_values.get() : wanted.values.get());
    if (!wanted.overlays) return;
    // Lines and sheets are of the order's own state; paths are of the whole motion.
    Overlays lasting;
    if (const auto paths = wanted.overlays->lines.find("paths");
        paths != wanted.overlays->lines.end())
      lasting.lines.insert(*paths);
    overlays.send(*renderer, beside ? lasting : *wanted.overlays);
  }

 private:
  /// Colours by values, of a frame (none: at rest).
  void tint(const PictureOrder& wanted, const FrameState* frame, const MapValues* values) {
    if (wanted.map)
      for (std::size_t i = 0; i < wanted.map->surfaces.size(); ++i)
        renderer->color_part(wanted.parts->parts[wanted.map->surfaces[i].part].name,
                             values && i < values->size() ? (*values)[i] : std::vector<float>{});
    if (wanted.displacement) {
      if (!displacement) displacement.emplace(wanted.parts->parts);
      displacement->color(*renderer, frame ? *frame : FrameState{});
    } else if (displacement) {
      displacement->clear(*renderer);
      displacement.reset();
      if (wanted.parts->colours) renderer->set_colour_map(*wanted.parts->colours);
    }
  }
};

PictureThread::PictureThread(std::function<void()> told)
    : told_(std::move(told)),
      make_context_([] { return std::make_shared<OffscreenContext>(); }),
      thread_([this] { work(); }) {}

PictureThread::~PictureThread() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PictureThread::order(PictureOrder wanted) {
  {
    const std::lock_guard lock(mutex_);
    ordered_ = std::move(wanted);
  }
  changed_.notify_all();
}

std::optional<DrawnPicture> PictureThread::take() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(newest_, std::nullopt);
}

bool PictureThread::lacks_context() const {
  const std::lock_guard lock(mutex_);
  return lacks_context_;
}

void PictureThread::use_context(ContextMaker maker) {
  const std::lock_guard lock(mutex_);
  make_context_ = std::move(maker);
}

void PictureThread::finish() {
  std::unique_lock lock(mutex_);
  finished_.wait(lock, [this] { return !busy_ && !ordered_ && saves_.empty(); });
}

void PictureThread::save_picture(std::filesystem::path folder) {
  {
    const std::lock_guard lock(mutex_);
    saves_.push_back({std::move(folder), std::nullopt});
  }
  changed_.notify_all();
}

void PictureThread::save(Image image, std::filesystem::path folder) {
  {
    const std::lock_guard lock(mutex_);
    saves_.push_back({std::move(folder), std::move(image)});
  }
  changed_.notify_all();
}

std::optional<PictureThread::Saved> PictureThread::take_saved() {
  const std::lock_guard lock(mutex_);
  if (saved_.empty()) return std::nullopt;
  Saved first = std::move(saved_.front());
  saved_.pop_front();
  return first;
}

bool PictureThread::given_up() const {
  const std::lock_guard lock(mutex_);
  return stop_ || ordered_;
}

void PictureThread::work() {
  std::optional<Drawing> drawing;
  PictureOrder last;
  while (true) {
    std::optional<SaveOrder> save_order;
    bool ordered = false;
    {
      std::unique_lock lock(mutex_);
      busy_ = false;
      finished_.notify_all();
      changed_.wait(lock, [this] { return stop_ || ordered_ || !saves_.empty(); });
      if (stop_) return;
      busy_ = true;
      ordered = ordered_.has_value();
      if (ordered) {
        last = *std::exchange(ordered_, std::nullopt);
      } else {
        save_order = std::move(saves_.front());
        saves_.pop_front();
      }
    }
    if (ordered)
      draw(drawing, last);
    else
      save(drawing, last, std::move(*save_order));
    if (told_) told_();
  }
}

void PictureThread::draw(std::optional<Drawing>& drawing, const PictureOrder& wanted) {
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
    drawing->apply(wanted);
    if (!drawing->renderer) return;
    auto picture = drawing->view.draw(
        *drawing->renderer, wanted, [&](bool beside) { drawing->turn_to(wanted, beside); },
        [this] { return given_up(); });
    const std::lock_guard lock(mutex_);
    if (picture) newest_ = std::move(picture);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

void PictureThread::save(std::optional<Drawing>& drawing, const PictureOrder& shown,
                         SaveOrder wanted) {
  Saved saved;
  try {
    if (!wanted.image) {
      if (!drawing || !drawing->renderer) return;
      wanted.image = drawing->renderer->picture(shown.camera, shown.settings);
    }
    saved.file = next_picture_file(wanted.folder);
    write_png(saved.file, *wanted.image);
  } catch (const std::exception& error) {
    saved.trouble = error.what();
  }
  const std::lock_guard lock(mutex_);
  saved_.push_back(std::move(saved));
}

}  // namespace condyle
