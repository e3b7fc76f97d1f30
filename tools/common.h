#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

#include "render/scene_renderer.h"
#include "sim/simulator/simulator.h"
#include "tools/commands.h"

namespace condyle {

/// A bar on standard error while it is a terminal; silent elsewhere and with --quiet.
class ProgressBar {
 public:
  explicit ProgressBar(const CommonOptions& common);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::string_view what, double fraction);
  void clear();
  Progress callback();

 private:
  bool terminal_;
  bool drawn_ = false;
};

/// The case in the folder, or the built-in patient when it is empty.
/// `progress` is told instead of the bar when it is given.
Case open_patient(const std::filesystem::path& folder, const CommonOptions& common,
                  ProgressBar& bar, const Progress& progress = {});

SimulatorSettings simulator_settings(const MotionOptions& options, const CommonOptions& common);

/// What is told of a scene before the long work: surfaces that overlap or are open, and what the
/// soft tissue had to leave out.
void tell_notes(const Scene& scene, const CommonOptions& common, ProgressBar& bar);

/// The motion that the command line asks for.
Motion motion_of(const MotionOptions& options, const Scene& scene, int threads);

/// The machine's processor, by its own name.
std::string processor();

/// "1280x720". throws: InputError unless both are between 16 and 8192.
std::pair<int, int> parse_size(const std::string& text);

/// What "bones", "teeth", "skin" and so on mean.
const std::map<std::string, std::set<Role>>& part_groups();

/// Fills opacities from a list such as "bones,teeth,skin:0.4"; "all" shows every part.
/// gives: the map of numbers on the surfaces that is in the list, if one is. throws: InputError for
/// an unknown name, listing the known ones.
enum class SurfaceMap { none, distance, displacement };
SurfaceMap apply_show_list(const std::string& list, std::span<const Part> parts,
                           PictureSettings& settings);

}  // namespace condyle
