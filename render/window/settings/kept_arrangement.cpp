#include "render/window/settings/kept_arrangement.h"

#include <array>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/files.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

constexpr std::size_t largest_file = std::size_t{1} << 16;
constexpr std::chrono::milliseconds calm{500};

constexpr std::array left_tabs = {"parts", "look"};
constexpr std::array edges = {"msaa", "fxaa", "none"};
constexpr std::array side_tabs = {"readings", "motion", "plan", "record", "face"};

json json_of(const RecordChoice& r) {
  return {{"width", r.width},
          {"height", r.height},
          {"frames_per_second", r.frames_per_second},
          {"supersampling", r.supersampling},
          {"edges", edges.at(static_cast<std::size_t>(r.edges))},
          {"film", r.film},
          {"transparent", r.transparent},
          {"cameras", r.cameras}};
}

json json_of(const Arrangement& a) {
  const PanelChoice& panels = a.panels;
  return {{"light", a.light},
          {"ui_scale", a.ui_scale ? json(*a.ui_scale) : json()},
          {"width", a.width},
          {"height", a.height},
          {"maximized", a.maximized},
          {"left_column", a.sizes.left},
          {"right_column", a.sizes.right},
          {"plots_height", a.sizes.plots},
          {"left_tab", left_tabs.at(static_cast<std::size_t>(panels.left_tab))},
          {"right_tab", side_tabs.at(static_cast<std::size_t>(panels.tab))},
          {"plots", panels.plots},
          {"plot_set", panels.plot_set},
          {"open_groups", a.open_groups},
          {"recording", json_of(a.record)}};
}

/// Fields of the file; a missing one leaves the value unchanged.
class FieldReader {
 public:
  FieldReader(const fs::path& file, const json& all) : file_(file), all_(all) {
    if (!all.is_object()) throw InputError(file, "", "is no list of settings");
  }

  void read(const char* name, bool& value) const {
    const json* field = find(name);
    if (!field) return;
    if (!field->is_boolean()) throw InputError(file_, name, "is neither true nor false");
    value = field->get<bool>();
  }
  template <class Number>
  void read(const char* name, Number& value, double least, double most) const {
    const json* field = find(name);
    if (!field) return;
    const double number = field->is_number() ? field->get<double>() : most + 1;
    if (!(number >= least && number <= most))
      throw InputError(file_, name, "is " + text_of(*field) + ", which it cannot be");
    value = static_cast<Number>(number);
  }
  template <class Choice, std::size_t n>
  void read(const char* name, Choice& value, const std::array<const char*, n>& known) const {
    const json* field = find(name);
    if (!field) return;
    for (std::size_t i = 0; i < n; ++i)
      if (*field == known[i]) {
        value = static_cast<Choice>(i);
        return;
      }
    throw InputError(file_, name, "is " + text_of(*field) + ", which is unknown");
  }
  void read(const char* name, std::vector<std::string>& names) const {
    const json* field = find(name);
    if (!field) return;
    names.clear();
    const auto is_name = [](const json& one) { return one.is_string(); };
    if (!field->is_array() || !std::all_of(field->begin(), field->end(), is_name))
      throw InputError(file_, name, "is no list of names");
    for (const json& one : *field) {
      names.push_back(one.get<std::string>());
    }
  }

 private:
  static std::string text_of(const json& field) {
    constexpr std::size_t longest = 60;
    const std::string all = field.dump(-1, ' ', false, json::error_handler_t::replace);
    return all.size() > longest ? all.substr(0, longest) + "..." : all;
  }
  const json* find(const char* name) const {
    const auto found = all_.find(name);
    return found == all_.end() || found->is_null() ? nullptr : &*found;
  }
  const fs::path& file_;
  const json& all_;
};

RecordChoice record_in(const fs::path& file, const json& all) {
  const FieldReader fields(file, all);
  RecordChoice r;
  fields.read("width", r.width, min_picture_px, max_picture_px);
  fields.read("height", r.height, min_picture_px, max_picture_px);
  fields.read("frames_per_second", r.frames_per_second, 1, 240);
  fields.read("supersampling", r.supersampling, 1, 4);
  fields.read("edges", r.edges, edges);
  fields.read("film", r.film);
  fields.read("transparent", r.transparent);
  std::vector<std::string> cameras(r.cameras.begin(), r.cameras.end());
  fields.read("cameras", cameras);
  r.cameras = {cameras.begin(), cameras.end()};
  return r;
}

Arrangement arrangement_in(const fs::path& file, const std::string& text) {
  const json all = json::parse(text, nullptr, false);
  const FieldReader fields(file, all);
  Arrangement a;
  fields.read("light", a.light);
  if (all.contains("ui_scale") && !all["ui_scale"].is_null()) {
    a.ui_scale = 1;
    fields.read("ui_scale", *a.ui_scale, 0.05, 8);
  }
  fields.read("width", a.width, 1, 16384);
  fields.read("height", a.height, 1, 16384);
  fields.read("maximized", a.maximized);
  fields.read("left_column", a.sizes.left, 0, 4096);
  fields.read("right_column", a.sizes.right, 0, 4096);
  fields.read("plots_height", a.sizes.plots, 0, 4096);
  fields.read("left_tab", a.panels.left_tab, left_tabs);
  fields.read("right_tab", a.panels.tab, side_tabs);
  fields.read("plots", a.panels.plots);
  fields.read("plot_set", a.panels.plot_set, 0, 100);
  fields.read("open_groups", a.open_groups);
  if (all.contains("recording")) a.record = record_in(file, all["recording"]);
  return a;
}

/// Copies the fields that differ between the window before and now into those to be stored.
void merge(Arrangement& kept, const Arrangement& before, const Arrangement& now) {
  const auto take = [](auto& into, const auto& was, const auto& is) {
    if (!(was == is)) into = is;
  };
  take(kept.light, before.light, now.light);
  take(kept.ui_scale, before.ui_scale, now.ui_scale);
  take(kept.width, before.width, now.width);
  take(kept.height, before.height, now.height);
  take(kept.maximized, before.maximized, now.maximized);
  take(kept.sizes, before.sizes, now.sizes);
  take(kept.panels, before.panels, now.panels);
  take(kept.record, before.record, now.record);
  take(kept.open_groups, before.open_groups, now.open_groups);
}

}  // namespace

KeptArrangement::KeptArrangement(fs::path file) : file_(std::move(file)) {
  std::error_code ignored;
  if (file_.empty() || !fs::exists(file_, ignored)) return;
  bool is_read = false;
  try {
    const std::string text = read_file(file_, largest_file);
    is_read = true;
    kept_ = arrangement_in(file_, text);
  } catch (const std::exception& error) {
    trouble_ =
        std::string("The settings of the window could not be read, so it opens as at first: ") +
        error.what();
    // A readable file replaces an invalid one, but not one that is only inaccessible.
    if (is_read)
      due_ = true;
    else
      file_.clear();
  }
}

void KeptArrangement::update(const Arrangement& now, bool at_once) {
  const auto time = std::chrono::steady_clock::now();
  if (!(now == before_)) {
    merge(kept_, before_, now);
    before_ = now;
    changed_ = time;
    due_ = true;
  }
  if (!due_ || file_.empty() || (!at_once && time - changed_ < calm)) return;
  due_ = false;
  try {
    make_folder(file_.parent_path());
    write_file(file_, json_of(kept_).dump(2) + "\n");
  } catch (const MachineError&) {
    // The arrangement then lasts only as long as the window.
  }
}

}  // namespace condyle
