#include "render/output/recorder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "render/output/film.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t waiting_most = 3;  // pictures held for the writer: 25 MB at 1080p

// Fields of the sheet that are reported, but whose differences do not make it another recording.
constexpr const char* driver_entry = "driver";

std::string frame_name(int frame) { return fmt::format("{:06d}.png", frame); }

bool is_frame_name(const std::string& name) {
  return name.size() >= 10 && name.ends_with(".png") &&
         std::all_of(name.begin(), name.end() - 4, [](char c) { return c >= '0' && c <= '9'; });
}

/// Files left by a killed run: .000012.png.4711.part, .film.mp4.4711.part, …
bool is_leftover(const std::string& name) {
  if (!name.starts_with('.') || !name.ends_with(".part")) return false;
  const std::string inner = name.substr(1, name.size() - 6);
  const std::string target = inner.substr(0, inner.rfind('.'));
  return is_frame_name(target) || target == "film.mp4" || target == "recording.json" ||
         target == "hashes.csv";
}

template <class Matches>
void remove_files(const fs::path& folder, const Matches& matches) {
  std::error_code error;
  std::vector<fs::path> found;
  for (auto it = fs::directory_iterator(folder, error); !error && it != fs::directory_iterator();
       it.increment(error))
    if (matches(it->path().filename().string()) && !it->is_directory()) found.push_back(it->path());
  for (const auto& file : found)
    if (!fs::remove(file, error) && error)
      throw MachineError(file.string() + ": cannot be removed: " + error.message());
}

RecordingSheet sheet_of(const RecorderSettings& settings) {
  RecordingSheet sheet = settings.identity;
  sheet["width"] = std::to_string(settings.width);
  sheet["height"] = std::to_string(settings.height);
  sheet["frames"] = std::to_string(settings.frames);
  sheet["frames_per_second"] = fmt::format("{:.6g}", settings.frames_per_second);
  return sheet;
}

/// Only frames: other files in the folder are left alone.
void move_frames(const fs::path& from, const fs::path& to) {
  if (!fs::is_directory(from)) return;
  make_folder(to);
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(from))
    if (is_frame_name(entry.path().filename().string())) found.push_back(entry.path());
  for (const auto& frame : found) fs::rename(frame, to / frame.filename());
}

}  // namespace

RecordingThere recording_there(const RecorderSettings& settings) {
  const fs::path frames = settings.folder / "frames";
  RecordingThere there;
  std::error_code error;
  for (fs::directory_iterator one(frames, error), end; !error && one != end; one.increment(error))
    if (is_frame_name(one->path().filename().string())) ++there.pictures;
  auto before = read_recording_sheet(settings.folder / "recording.json");
  if (before) before->erase(driver_entry);
  if (there.pictures > 0 || before)
    there.differs = differing(before.value_or(RecordingSheet{}), sheet_of(settings));
  if (!before || !there.differs.empty()) return there;
  there.pictures = 0;
  for (int frame = 0; frame < settings.frames; ++frame)
    if (is_whole_png(frames / frame_name(frame), settings.width, settings.height)) ++there.pictures;
  return there;
}

struct Recorder::State {
  RecorderSettings settings;
  RecordingSheet sheet;
  std::vector<char> present;
  bool begun = false;  // the folder belongs to this recording
  std::string driver;  // of frames that are added
  bool sheet_due = false;

  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::pair<int, Image>> waiting;
  bool busy = false, ending = false;
  std::exception_ptr trouble;
  std::thread writer;

  // Used by the writer while it runs, and by others once it is idle:
  std::optional<Film> film;
  int film_frames = 0;       // the film has the frames before this
  std::string film_trouble;  // frames continue without a film
  std::map<int, std::uint64_t> hashes;

  fs::path frames() const { return settings.folder / "frames"; }
  fs::path frame_file(int frame) const { return frames() / frame_name(frame); }
  fs::path sheet_file() const { return settings.folder / "recording.json"; }
  fs::path film_file() const { return settings.folder / "film.mp4"; }
  fs::path hash_file() const { return settings.folder / "hashes.csv"; }

  void clean() {
    for (const auto& folder : {settings.folder, frames()})
      if (fs::is_directory(folder)) remove_files(folder, is_leftover);
  }

  /// Replaces an earlier recording by this one. In this order, so that a kill at any moment leaves
  /// no frame under another recording's sheet.
  fs::path earlier() const { return settings.folder / ".earlier"; }

  void remove_results() {
    std::error_code error;
    fs::remove(sheet_file(), error);
    fs::remove(film_file(), error);
    fs::remove(hash_file(), error);
    if (fs::is_directory(frames())) remove_files(frames(), is_frame_name);
  }

  /// Records that a frame of this driver is added.
  void note_driver() {
    std::string& drivers = sheet[driver_entry];
    if (driver.empty() || ("; " + drivers + "; ").find("; " + driver + "; ") != std::string::npos)
      return;
    drivers += (drivers.empty() ? "" : "; ") + driver;
    sheet_due = true;
  }
  /// Updates the sheet after frames were added.
  void renew_sheet() {
    RecordingSheet now;
    {
      const std::lock_guard lock(mutex);
      if (!std::exchange(sheet_due, false)) return;
      now = sheet;
    }
    write_recording_sheet(sheet_file(), now);
  }

  /// Sets the existing recording aside until this one is complete. An incomplete recording on top
  /// of one set aside before is dropped.
  void begin() {
    if (begun) return;
    if (fs::exists(earlier())) {
      remove_results();
    } else if (fs::exists(sheet_file())) {
      make_folder(earlier());
      for (const auto& result : {sheet_file(), film_file(), hash_file()})
        if (fs::exists(result)) fs::rename(result, earlier() / result.filename());
      move_frames(frames(), earlier() / "frames");
    } else {
      remove_results();
    }
    make_folder(frames());
    {
      const std::lock_guard lock(mutex);
      sheet_due = true;
    }
    renew_sheet();
    begun = true;
  }

  /// After an error: restores the earlier recording.
  void bring_back_earlier() noexcept {
    try {
      if (!fs::exists(earlier())) return;
      remove_results();
      move_frames(earlier() / "frames", frames());
      for (const auto& result : {film_file(), hash_file(), sheet_file()})
        if (fs::exists(earlier() / result.filename()))
          fs::rename(earlier() / result.filename(), result);
      fs::remove_all(earlier());
    } catch (const std::exception&) {
      // What cannot be moved back stays complete in the folder set aside.
    }
  }

  bool is_present(int frame) {
    const std::lock_guard lock(mutex);
    return frame < settings.frames && present[static_cast<std::size_t>(frame)];
  }

  /// Passes all frames that are ready to the film: the picture in memory, and stored ones.
  void feed_film(int frame = -1, const Image* picture = nullptr) {
    if (!settings.film || !film_trouble.empty()) return;
    try {
      if (!film)
        film.emplace(film_file(), settings.width, settings.height, settings.frames_per_second);
      for (;; ++film_frames) {
        if (film_frames == frame)
          film->add(*picture);
        else if (is_present(film_frames))
          film->add(read_png(frame_file(film_frames)));
        else
          break;
      }
    } catch (const std::exception& error) {
      film_trouble = error.what();
      film.reset();
    }
  }

  void finish_film() {
    feed_film();
    if (film_trouble.empty()) {
      try {
        film->finish();
      } catch (const MachineError& error) {
        film_trouble = error.what();
      }
    }
    film.reset();
    if (!film_trouble.empty())
      throw MachineError(
          film_file().string() + ": no film was made: " + film_trouble + "; the frames in " +
          frames().string() +
          " are complete: install ffmpeg ('apt-get install ffmpeg') or remove the cause, "
          "then continue with --resume");
  }

  /// A hash of each picture's file, for comparing recordings.
  void write_hashes() {
    std::string text = "frame,hash\n";
    for (int frame = 0; frame < settings.frames; ++frame) {
      if (!hashes.contains(frame)) {
        const std::string bytes = read_file(frame_file(frame));
        hashes[frame] = hash_bytes(bytes.data(), bytes.size());
      }
      text += fmt::format("{},{:016x}\n", frame, hashes[frame]);
    }
    write_file(hash_file(), text);
  }

  void write_all() {
    for (;;) {
      std::pair<int, Image> next;
      {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return ending || !waiting.empty(); });
        if (waiting.empty()) return;
        next = std::move(waiting.front());
        waiting.pop_front();
        busy = true;
        changed.notify_all();  // there is space for one more
      }
      std::exception_ptr failed;
      try {
        const std::string bytes = encode_png(next.second);
        begin();
        renew_sheet();
        write_file(frame_file(next.first), bytes);
        hashes[next.first] = hash_bytes(bytes.data(), bytes.size());
        feed_film(next.first, &next.second);
      } catch (...) {
        failed = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      busy = false;
      if (failed) {
        if (!trouble) trouble = failed;
        waiting.clear();
      } else {
        present[static_cast<std::size_t>(next.first)] = 1;
      }
      changed.notify_all();
    }
  }

  void rethrow() const {
    if (trouble) std::rethrow_exception(trouble);
  }
};

Recorder::Recorder(const RecorderSettings& settings) : state_(std::make_unique<State>()) {
  auto& s = *state_;
  s.settings = settings;
  s.settings.folder = fs::absolute(settings.folder);
  s.sheet = sheet_of(settings);
  s.present.assign(static_cast<std::size_t>(std::max(settings.frames, 0)), 0);
  make_folder(s.settings.folder);
  if (::access(s.settings.folder.c_str(), W_OK | X_OK) != 0)
    throw MachineError(s.settings.folder.string() + ": the folder cannot be written");
  std::string earlier_driver = "an unrecorded driver";
  auto before = settings.resume ? read_recording_sheet(s.sheet_file()) : std::nullopt;
  if (before) {
    if (const auto noted = before->extract(driver_entry)) earlier_driver = noted.mapped();
    const std::string differs = difference(*before, s.sheet);
    if (!differs.empty())
      throw InputError(s.sheet_file(), "",
                       "holds another recording (" + differs +
                           "); give the same options, another --out, or omit --resume");
  }
  s.clean();
  if (before) {
    s.begun = true;
    s.sheet[driver_entry] = earlier_driver;
    make_folder(s.frames());
    for (int frame = 0; frame < settings.frames; ++frame)
      s.present[static_cast<std::size_t>(frame)] =
          is_whole_png(s.frame_file(frame), settings.width, settings.height);
  }
  s.writer = std::thread([&s] { s.write_all(); });
}

Recorder::~Recorder() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->ending = true;
  }
  state_->changed.notify_all();
  state_->writer.join();
  if (state_->trouble) state_->bring_back_earlier();
}

bool Recorder::has(int frame) const {
  const std::lock_guard lock(state_->mutex);
  return frame >= 0 && frame < static_cast<int>(state_->present.size()) &&
         state_->present[static_cast<std::size_t>(frame)];
}

int Recorder::kept_frames() const {
  const std::lock_guard lock(state_->mutex);
  return static_cast<int>(std::count(state_->present.begin(), state_->present.end(), 1));
}

void Recorder::add(int frame, Image picture) {
  auto& s = *state_;
  if (frame < 0 || frame >= s.settings.frames || picture.width != s.settings.width ||
      picture.height != s.settings.height)
    throw MachineError(fmt::format(
        "frame {} of {}x{} does not belong to this recording ({} frames, {}x{})", frame,
        picture.width, picture.height, s.settings.frames, s.settings.width, s.settings.height));
  std::unique_lock lock(s.mutex);
  s.changed.wait(lock, [&] { return s.trouble || s.waiting.size() < waiting_most; });
  s.rethrow();
  s.note_driver();
  s.waiting.emplace_back(frame, std::move(picture));
  s.changed.notify_all();
}

void Recorder::finish() {
  auto& s = *state_;
  {
    std::unique_lock lock(s.mutex);
    s.changed.wait(lock, [&] { return s.trouble || (s.waiting.empty() && !s.busy); });
    s.rethrow();
  }
  const auto missing = std::find(s.present.begin(), s.present.end(), 0);
  if (missing != s.present.end())
    throw MachineError(s.frame_file(static_cast<int>(missing - s.present.begin())).string() +
                       ": this frame was never drawn; continue with --resume");
  s.write_hashes();
  if (s.settings.film) s.finish_film();
  std::error_code error;
  fs::remove_all(s.earlier(), error);
}

void Recorder::set_driver(const std::string& driver) {
  const std::lock_guard lock(state_->mutex);
  state_->driver = driver;
}

std::string Recorder::drivers() const {
  const std::lock_guard lock(state_->mutex);
  const auto noted = state_->sheet.find(driver_entry);
  return noted == state_->sheet.end() ? "" : noted->second;
}

std::filesystem::path Recorder::frame_file(int frame) const { return state_->frame_file(frame); }
std::filesystem::path Recorder::film_file() const { return state_->film_file(); }

}  // namespace condyle
