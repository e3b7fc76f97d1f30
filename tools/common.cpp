#include "tools/common.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/case/case_io.h"
#include "sim/phantom/phantom.h"

namespace condyle {

ProgressBar::ProgressBar(const CommonOptions& common)
    : quiet_(common.quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::show(std::string_view what, double fraction) {
  if (quiet_) return;
  if (!terminal_) return print_line(what, fraction);
  constexpr int width = 30;
  const int full = static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * width));
  fmt::print(stderr, "\r\033[K[{}{}] {:3.0f} %  {}",
             std::string(static_cast<std::size_t>(full), '#'),
             std::string(static_cast<std::size_t>(width - full), '.'), fraction * 100, what);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::print_line(std::string_view what, double fraction) {
  constexpr std::chrono::seconds between(10);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_line_ < between) return;
  last_line_ = now;
  fmt::print(stderr, "{:3.0f} %  {}\n", fraction * 100, what);
}

void ProgressBar::clear() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
  drawn_ = false;
}

Progress ProgressBar::callback() {
  return [this](std::string_view what, double fraction) { show(what, fraction); };
}

Case open_patient(const std::filesystem::path& folder, const CommonOptions& common,
                  ProgressBar& bar, const Progress& progress) {
  HeadChoice choice;
  if (is_head_name(folder.string()))
    choice = parse_head_name(folder.string());
  else if (!folder.empty())
    return load_case(folder);
  // Generating the patient takes some seconds once; a log should say so.
  bool announced = false;
  return builtin_patient(choice, [&](std::string_view what, double fraction) {
    if (!announced && !common.quiet)
      fmt::print(stderr, "making the built-in patient (once; then it is cached)\n");
    announced = true;
    if (progress)
      progress(what, fraction);
    else
      bar.show(what, fraction);
  });
}

std::filesystem::path case_of(const std::filesystem::path& given, const std::optional<Plan>& plan) {
  if (!given.empty() || !plan || !is_head_name(plan->geometry.name)) return given;
  return plan->geometry.name;
}

void print_notes(const Scene& scene, const std::filesystem::path& folder,
                 const CommonOptions& common, ProgressBar& bar) {
  if (!common.prints_summary() || (folder.empty() && !common.verbose)) return;
  bar.clear();
  for (const auto& note : scene.contacts.notes()) fmt::print(stderr, "note: {}\n", note);
  if (!scene.tissue) return;
  for (const auto& note : summary(*scene.tissue).notes)
    fmt::print(stderr, "note: soft tissue: {}\n", note);
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::pair<int, int> parse_size(const std::string& text) {
  int width = 0, height = 0, used = 0;
  const bool parsed = std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &used) == 2 &&
                      used == static_cast<int>(text.size());
  if (!parsed || width < 16 || height < 16 || width > 8192 || height > 8192)
    throw InputError("--size " + text + ": must be WIDTHxHEIGHT, each 16 to 8192, e.g. 1280x720");
  return {width, height};
}

const std::map<std::string, std::set<Role>>& part_groups() {
  static const std::map<std::string, std::set<Role>> groups = {
      {"bones", {Role::skull, Role::maxilla, Role::mandible, Role::segment, Role::transplant}},
      {"teeth", {Role::upper_teeth, Role::lower_teeth}},
      {"segments", {Role::segment}},
      {"transplants", {Role::transplant}},
      {"skin", {Role::face, Role::eyes}},
      {"mouth", {Role::upper_gums, Role::lower_gums, Role::tongue}},
  };
  return groups;
}

SurfaceMap apply_show_list(const std::string& list, std::span<const Part> parts,
                           PictureSettings& settings, const std::string& option) {
  const auto& groups = part_groups();
  const auto known = [&] {
    std::string names = "all, contacts, distance, displacement";
    for (const auto& [name, roles] : groups) names += ", " + name;
    for (const auto& part : parts) names += ", " + part.name;
    return names;
  };
  std::map<std::string, double> opacity;
  for (const auto& part : parts) opacity[part.name] = 0;
  settings.contacts = false;
  SurfaceMap map = SurfaceMap::none;
  std::size_t start = 0;
  while (start <= list.size()) {
    const auto end = std::min(list.find(',', start), list.size());
    std::string item = list.substr(start, end - start);
    start = end + 1;
    double value = 1;
    if (const auto colon = item.find(':'); colon != std::string::npos) {
      char* rest = nullptr;
      const std::string number = item.substr(colon + 1);
      value = std::strtod(number.c_str(), &rest);
      if (number.empty() || *rest != '\0' || !(value >= 0 && value <= 1))
        throw InputError(option + " " + item + ": the opacity must be a number from 0 to 1");
      item.resize(colon);
    }
    bool found = item == "all" || item == "contacts";
    if (found) settings.contacts = true;
    for (const auto& [name, kind] : {std::pair{"distance", SurfaceMap::distance},
                                     std::pair{"displacement", SurfaceMap::displacement}})
      if (item == name) {
        map = kind;
        found = true;
      }
    for (const auto& part : parts) {
      const auto group = groups.find(item);
      const bool chosen = item == "all" || item == part.name ||
                          (group != groups.end() && group->second.contains(part.role));
      if (chosen) opacity[part.name] = value;
      found |= chosen || group != groups.end();
    }
    if (!found) throw InputError(option + " " + item + ": unknown; known are " + known());
  }
  for (const auto& part : parts)
    if (part.role == Role::face) settings.skin_opacity = opacity[part.name];
  settings.part_opacity = std::move(opacity);
  return map;
}

}  // namespace condyle
