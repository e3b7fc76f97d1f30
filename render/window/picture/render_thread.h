#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "render/image/image.h"
#include "render/window/picture/render_request.h"

namespace condyle {

/// Makes an OpenGL 3.3 core context current on the calling thread for the lifetime of the result.
/// throws: MachineError.
using ContextMaker = std::function<std::shared_ptr<void>()>;

/// Draws the patient on a separate thread with its own OpenGL context, so that the window's panels
/// never wait for a picture: neither for the first one of a patient, for which everything is
/// prepared and uploaded, nor for a large one. Pixels are returned through memory: two contexts of
/// one software driver would wait for each other.
class RenderThread {
 public:
  /// `notify`: called from that thread when there is news. Draws off-screen, through EGL.
  explicit RenderThread(std::function<void()> notify);
  ~RenderThread();
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  /// Requests the next picture; replaces an earlier request that was not begun.
  void request(RenderRequest request);
  /// The newest picture, if it has not been taken yet.
  /// Rethrows the error of a failed picture: MachineError.
  std::optional<DrawnPicture> take();
  /// Whether the last picture failed for lack of a context.
  bool lacks_context() const;
  /// Sets the source of the context for the next picture, if there is none yet.
  void use_context(ContextMaker maker);
  /// Waits until every request is drawn and everything is saved.
  void finish();

  /// Draws the last request in full quality and saves it as PNG under a free name in the folder; or
  /// saves an image.
  void save_picture(std::filesystem::path folder);
  void save(Image image, std::filesystem::path folder);

  struct Saved {
    std::filesystem::path file;
    std::string trouble;  // reason of a failure; empty: saved
  };
  /// Pictures saved since the last call, one at a time.
  std::optional<Saved> take_saved();

 private:
  struct Drawing;  // data with the lifetime of the context
  struct SaveRequest {
    std::filesystem::path folder;
    std::optional<Image> image;  // none: the view
  };
  void work();
  void draw(std::optional<Drawing>& drawing, const RenderRequest& request);
  void save(std::optional<Drawing>& drawing, const RenderRequest& shown, SaveRequest request);
  bool given_up() const;

  std::function<void()> notify_;
  mutable std::mutex mutex_;
  std::condition_variable changed_, finished_;
  std::optional<RenderRequest> requested_;
  std::deque<SaveRequest> saves_;
  std::optional<DrawnPicture> newest_;
  std::deque<Saved> saved_;
  std::exception_ptr failure_;
  ContextMaker make_context_;
  bool lacks_context_ = false;
  bool busy_ = false, stop_ = false;
  std::thread thread_;
};

}  // namespace condyle
