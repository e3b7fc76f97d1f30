#include "tests/support/file_drop.h"

#include <X11/Xatom.h>

#include <array>
#include <chrono>
#include <thread>

#include "tests/support/x11_windows.h"

namespace condyle::test {
namespace {

class DropSource {
 public:
  explicit DropSource(const std::string& list) : list_(list), display_(XOpenDisplay(nullptr)) {
    if (!display_) return;
    source_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
    XSetSelectionOwner(display_, atom("XdndSelection"), source_, CurrentTime);
  }
  ~DropSource() {
    if (display_) XCloseDisplay(display_);
  }
  DropSource(const DropSource&) = delete;
  DropSource& operator=(const DropSource&) = delete;

  bool drop_on(const std::string& title) {
    if (!display_) return false;
    const Window target = window_called(display_, DefaultRootWindow(display_), title);
    if (!target) return false;
    constexpr long version = 5;
    const long middle = 400L << 16 | 300;  // of the screen, where the mouse is said to be
    send(target, "XdndEnter", {version << 24, static_cast<long>(atom("text/uri-list")), 0, 0});
    send(target, "XdndPosition",
         {0, middle, CurrentTime, static_cast<long>(atom("XdndActionCopy"))});
    send(target, "XdndDrop", {0, CurrentTime, 0, 0});
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < std::chrono::seconds(20)) {
      while (XPending(display_)) {
        XEvent event;
        XNextEvent(display_, &event);
        if (event.type == SelectionRequest) answer(event.xselectionrequest);
        if (event.type == ClientMessage && event.xclient.message_type == atom("XdndFinished"))
          return event.xclient.data.l[1] != 0;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

 private:
  Atom atom(const char* name) { return XInternAtom(display_, name, False); }
  void send(Window target, const char* what, const std::array<long, 4>& data) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = target;
    event.xclient.message_type = atom(what);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(source_);
    for (std::size_t i = 0; i < data.size(); ++i) event.xclient.data.l[i + 1] = data[i];
    XSendEvent(display_, target, False, NoEventMask, &event);
    XFlush(display_);
  }
  void answer(const XSelectionRequestEvent& request) {
    XChangeProperty(display_, request.requestor, request.property, request.target, 8,
                    PropModeReplace, reinterpret_cast<const unsigned char*>(list_.data()),
                    static_cast<int>(list_.size()));
    XEvent event{};
    event.xselection.type = SelectionNotify;
    event.xselection.requestor = request.requestor;
    event.xselection.selection = request.selection;
    event.xselection.target = request.target;
    event.xselection.property = request.property;
    event.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &event);
    XFlush(display_);
  }

  std::string list_;
  Display* display_;
  Window source_ = 0;
};

}  // namespace

bool drop_files(const std::string& window_title, const std::vector<std::filesystem::path>& files) {
  std::string list;
  for (const auto& file : files) list += "file://" + file.string() + "\r\n";
  return DropSource(list).drop_on(window_title);
}

}  // namespace condyle::test
