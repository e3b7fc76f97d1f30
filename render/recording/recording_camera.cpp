#include "render/recording/recording_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/text_list.h"

namespace condyle {
namespace {

constexpr const char* turntable = "spin";

/// One view as a JSON object; `where`: its location in messages.
class ViewReader {
 public:
  ViewReader(const std::string& file, const nlohmann::json& json, std::string where, bool has_time)
      : file_(file), json_(json), where_(std::move(where)) {
    if (!json.is_object()) throw InputError(file_, where_, "is not a JSON object");
    static const std::set<std::string> known = {"view", "target",      "direction",
                                                "up",   "distance_mm", "field_of_view_deg"};
    for (const auto& [key, value] : json.items())
      if (!known.contains(key) && !(has_time && key == "at"))
        throw InputError(file_, where_ + key,
                         "is unknown; valid are view, target, direction, up, distance_mm and "
                         "field_of_view_deg" +
                             std::string(has_time ? ", and at" : ", or path alone"));
  }

  Camera read(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double aspect) const {
    std::string view = "front";
    if (json_.contains("view")) {
      if (!json_["view"].is_string()) throw InputError(file_, where_ + "view", "must be a name");
      view = json_["view"].get<std::string>();
      const auto& names = camera_names();
      if (std::find(names.begin(), names.end(), view) == names.end())
        throw InputError(file_, where_ + "view",
                         "is " + view + "; known are " + fmt::format("{}", fmt::join(names, ", ")));
    }
    Camera camera = standard_camera(view, low, high, aspect);
    vector("target", camera.target);
    vector("direction", camera.direction);
    vector("up", camera.up);
    number("distance_mm", camera.distance_mm, 10, 10000);
    number("field_of_view_deg", camera.field_of_view_deg, 1, 120);
    if (camera.direction.norm() < 1e-9)
      throw InputError(file_, where_ + "direction", "must not be zero");
    camera.direction.normalize();
    if (camera.direction.cross(camera.up).norm() < 1e-6)
      throw InputError(file_, where_ + "up", "must not be zero or along the direction");
    return camera;
  }

  void number(const char* name, double& value, double least, double most) const {
    if (!json_.contains(name)) return;
    if (!json_[name].is_number()) throw InputError(file_, where_ + name, "must be a number");
    value = json_[name].get<double>();
    if (!(value >= least && value <= most))
      throw InputError(file_, where_ + name,
                       fmt::format("is {}; must be {} to {}", value, least, most));
  }

 private:
  void vector(const char* name, Eigen::Vector3d& value) const {
    if (!json_.contains(name)) return;
    const auto& list = json_[name];
    if (!list.is_array() || list.size() != 3 || !list[0].is_number() || !list[1].is_number() ||
        !list[2].is_number())
      throw InputError(file_, where_ + name, "must be three numbers");
    value = {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
  }

  const std::string& file_;
  const nlohmann::json& json_;
  std::string where_;
};

CameraPath read_path(const std::string& file, const Eigen::Vector3d& low,
                     const Eigen::Vector3d& high, double aspect) {
  const nlohmann::json json = nlohmann::json::parse(read_file(file, 1 << 20), nullptr, false);
  if (!json.is_object()) throw InputError(file, "", "is not a JSON object");
  CameraPath path;
  if (!json.contains("path")) {
    path.keys.push_back({0, ViewReader(file, json, "", false).read(low, high, aspect)});
    return path;
  }
  if (json.size() > 1) throw InputError(file, "path", "must be the only key");
  const auto& list = json["path"];
  if (!list.is_array() || list.empty())
    throw InputError(file, "path", "must be a list of at least one view");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string where = fmt::format("path[{}].", i);
    const ViewReader reader(file, list[i], where, true);
    CameraPath::Key key;
    key.at = list.size() == 1 ? 0 : static_cast<double>(i) / static_cast<double>(list.size() - 1);
    reader.number("at", key.at, 0, 1);
    key.camera = reader.read(low, high, aspect);
    if (i > 0 && !(key.at > path.keys.back().at))
      throw InputError(file, where + "at",
                       fmt::format("is {}; must be later than {}, that of the previous view",
                                   key.at, path.keys.back().at));
    path.keys.push_back(key);
  }
  return path;
}

std::string view_text(const Camera& camera) {
  const auto& t = camera.target;
  const auto& d = camera.direction;
  const auto& u = camera.up;
  return fmt::format("{} {} {} / {} {} {} / {} {} {} / {} {}", t.x(), t.y(), t.z(), d.x(), d.y(),
                     d.z(), u.x(), u.y(), u.z(), camera.distance_mm, camera.field_of_view_deg);
}

}  // namespace

std::vector<std::string> split_cameras(const std::string& list) {
  std::vector<std::string> cameras = split_list(list);
  check_cameras(cameras);
  for (const auto& camera : cameras)  // without a window
    if (camera == own_camera || camera == turning_camera) standard_camera(camera, {}, {}, 1);
  return cameras;
}

void check_cameras(const std::vector<std::string>& cameras) {
  std::set<std::string> folders;
  for (const auto& camera : cameras) {
    const Eigen::Vector3d one = Eigen::Vector3d::Ones();
    if (camera.ends_with(".json"))
      read_path(camera, -one, one, 1);
    else if (camera != turntable && camera != own_camera && camera != turning_camera &&
             !ArchView::names(camera))
      standard_camera(camera, -one, one, 1);
    if (!folders.insert(std::filesystem::path(camera).stem().string()).second)
      throw InputError(fmt::format("--camera {}: two cameras are named {}", fmt::join(cameras, ","),
                                   std::filesystem::path(camera).stem().string()));
  }
}

RecordingCamera::RecordingCamera(const std::string& text, const Case& patient,
                                 const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                                 double aspect)
    : name_(std::filesystem::path(text).stem().string()),
      turning_(text == turntable ? Turning::once : Turning::no) {
  if (ArchView::names(text)) {
    arch_.emplace(text, patient.parts, patient.bodies, patient.jaw, aspect);
    path_.keys = {{0, arch_->at_rest()}};
  } else if (text.ends_with(".json")) {
    path_ = read_path(text, low, high, aspect);
  } else {
    path_.keys = {{0, standard_camera(text == turntable ? "front" : text, low, high, aspect)}};
  }
}

RecordingCamera::RecordingCamera(const std::string& name, const Camera& camera, Turning turning,
                                 const Eigen::Vector3d& upright)
    : name_(name), turning_(turning), upright_(upright), path_{.keys = {{0, camera}}} {}

Camera RecordingCamera::at(double fraction, const FrameState& frame) const {
  if (arch_) return arch_->at(frame);
  const Camera camera = path_.at(fraction);
  return turning_ == Turning::once ? turned(camera, 2 * std::numbers::pi * fraction, upright_)
                                   : camera;
}

std::string RecordingCamera::description() const {
  std::string text = arch_ ? name_ + " " : turning_ == Turning::once ? "spin " : "";
  for (std::size_t i = 0; i < path_.keys.size(); ++i)
    text += fmt::format("{}{}{}", i ? "; " : "",
                        path_.keys.size() > 1 ? fmt::format("{}: ", path_.keys[i].at) : "",
                        view_text(path_.keys[i].camera));
  return text;
}

}  // namespace condyle
