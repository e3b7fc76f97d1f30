#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "render/recording/picture_plan.h"
#include "render/scene/scene_renderer.h"
#include "sim/plan/plan.h"
#include "sim/simulator/simulator.h"
#include "tools/command.h"

namespace condyle {

/// Progress on standard error: a bar on a terminal, elsewhere occasional lines during long work;
/// nothing with --quiet.
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
  void print_line(std::string_view what, double fraction);

  bool quiet_, terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point last_line_ = std::chrono::steady_clock::now();
};

/// The case in the folder, the built-in patient if it is empty, or a head by its name, such as
/// built-in:class-iii; see parse_head_name(). `progress`, if given, is called
/// instead of the bar.
Case open_patient(const std::filesystem::path& folder, const CommonOptions& common,
                  ProgressBar& bar, const Progress& progress = {});

/// The case that is given, or else the built-in head that a plan was made for.
std::filesystem::path case_of(const std::filesystem::path& given, const std::optional<Plan>& plan);

/// Prints notes on a scene before the computation: surfaces that overlap or are open, and
/// simplifications of the soft tissue. Those of the built-in patient (no folder) are
/// printed with --verbose alone; report.json has them.
void print_notes(const Scene& scene, const std::filesystem::path& folder,
                 const CommonOptions& common, ProgressBar& bar);

/// Model name of the machine's processor.
std::string processor();

/// "1280x720". throws: InputError unless both are between 16 and 8192.
std::pair<int, int> parse_size(const std::string& text);

/// The roles in the groups "bones", "teeth", "skin" and so on.
const std::map<std::string, std::set<Role>>& part_groups();

/// Fills opacities from a list such as "bones,teeth,skin:0.4"; "all" shows every part.
/// Returns the colour map in the list, if there is one. `option`: the list's, for messages.
/// throws: InputError for an unknown name, listing the known ones.
SurfaceMap apply_show_list(const std::string& list, std::span<const Part> parts,
                           PictureSettings& settings, const std::string& option = "--show");

}  // namespace condyle
